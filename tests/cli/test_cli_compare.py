"""rodimpact compare: a record beside the gauges of a case."""

import json

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.cli import main

CASE = """schema = 1
[solve]
until = "3e-4 s"
[[bodies]]
kind = "rod"
length = 0.2
diameter = 0.02
material = "steel"
velocity = 10
[[bodies]]
kind = "rod"
length = 2.0
diameter = 0.02
material = "steel"
"""
GAUGE_OF_CASE = '[[gauges]]\nbody = 1\nfraction = 0.5\nname = "far"\n'
C = ri.materials.steel.wave_speed
DELAY = 33e-6  # of the record, s
STRAIN_PER_VOLT = 4e-3  # of the record
SPEED = 10  # of the striker, m/s
FILES = ["compare", "case.toml", "shot.txt"]
FAR = ["--gauge", "far=1:1.0"]
EARLY = ["--stop", "320 us"]
BRIDGE = ["--gauge-factor", "2", "--excitation", "5"]


def record_of(solution, x, rng):
    """Signal of a gauge at x of the bar, later by `DELAY`, in volts of a half bridge,
    with noise.
    """
    strain = solution.gauge(1, x).signal(1e-7).window(0.0, 2.9e-4).shifted(DELAY)
    noise = ri.Signal(1e-4 * rng.normal(size=len(strain)), strain.times)
    volts = strain / STRAIN_PER_VOLT + noise
    return volts.replace(unit="V")


@pytest.fixture(autouse=True)
def shot(tmp_path, monkeypatch):
    """A case and a record that is made of it, in the current folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(CASE)
    solution = ri.solve(ri.parse_case(CASE).system, until=3e-4)
    rng = np.random.default_rng(2)
    near = record_of(solution, 0.5, rng)
    far = record_of(solution, 1.0, rng)
    lines = ["t (us);near #1 (mV);far (mV)"]
    for i, time in enumerate(far.times):
        microseconds = time * 1e6
        near_millivolts = near.values[i] * 1e3
        far_millivolts = far.values[i] * 1e3
        line = f"{microseconds:.1f};{near_millivolts:.4f};{far_millivolts:.4f}"
        lines.append(line.replace(".", ","))
    (tmp_path / "shot.txt").write_text("\n".join(lines) + "\n")


@pytest.fixture
def compared(output_of):
    """Function that runs a comparison, and returns the printed text."""

    def call(*options):
        return output_of(*FILES, *options)

    return call


@pytest.fixture
def channels(compared):
    """Function that runs a comparison, and returns its channels by name."""

    def call(*options):
        return json.loads(compared(*options, "--json"))["channels"]

    return call


@pytest.mark.parametrize(("name", "x"), [("near #1", 0.5), ("far", 1.0)])
def test_shift_and_gain_of_the_record_are_found(channels, name, x):
    """`compare` finds the known delay and gain of a record in volts; start, width and
    plateau of the pulse, measured and predicted, are those of the struck rod.
    """
    gauges = ["--gauge", "near #1=1:0.5", "--gauge", "far=1:100 cm"]

    channel = channels(*gauges, *EARLY)[name]

    misfit = channel["misfit"]
    plateau = -SPEED / (2 * C) / STRAIN_PER_VOLT
    assert channel["unit"] == "V"
    assert misfit["shift"] == pytest.approx(DELAY, abs=1e-8)
    assert misfit["scale"] == pytest.approx(1 / STRAIN_PER_VOLT, rel=1e-3)
    assert misfit["rms"] < 1e-2
    for pulse in (channel["measured"], channel["predicted"]):
        assert pulse["start"] == pytest.approx(DELAY + x / C, abs=2e-7)
        assert pulse["width"] == pytest.approx(0.4 / C, abs=2e-7)
        assert pulse["plateau"] == pytest.approx(plateau, rel=1e-3)


def test_the_comparison_is_drawn(compared, tmp_path):
    compared(*FAR, *EARLY, "--save", "shot.svg")

    assert "<svg" in (tmp_path / "shot.svg").read_text()


def test_the_table_names_its_numbers(compared):
    """The table that `rodimpact compare` prints names its signals, the misfit, the
    shift and the factor.
    """
    text = compared(*FAR, *EARLY)

    for words in ("measured", "predicted", "pulse starts", "misfit, root mean"):
        assert words in text
    assert "shift of" in text
    assert "factor of the prediction" in text


def test_a_bridge_makes_strain_and_fixed_numbers_stay(channels):
    """`compare` with a half bridge and a fixed shift and scale: the record is in
    strain, shift and scale are those given, and the misfit is large.
    """
    bridge = ["--bridge", "half", "--gauge-factor", "2", "--excitation", "5 V"]
    fixed = ["--shift", "33us", "--scale", "1"]

    channel = channels(*FAR, *EARLY, *bridge, "--gain", "100", *fixed)["far"]

    misfit = channel["misfit"]
    # A half bridge: 4/(2 x gauge factor x excitation x gain)
    strain_per_volt = 4 / (2 * 2 * 5 * 100)
    strain = -SPEED / (2 * C) * strain_per_volt / STRAIN_PER_VOLT
    assert channel["unit"] == ""
    assert misfit["shift"] == DELAY
    assert misfit["scale"] == 1
    assert channel["measured"]["plateau"] == pytest.approx(strain, rel=1e-3)
    assert misfit["rms"] > 0.2  # the gain of the bridge is not that of the record


def test_a_pulse_near_the_end_is_propagated_to_the_gauge(channels):
    """Long waves run at the wave speed, and the plateau of a pulse is a long wave."""
    carried = ["--carried", "80 cm", "--radius", "1 cm"]

    misfit = channels("--gauge", "far=1:0.2", *carried, *EARLY)["far"]["misfit"]

    assert misfit["shift"] == pytest.approx(DELAY, abs=2e-6)
    assert misfit["scale"] == pytest.approx(1 / STRAIN_PER_VOLT, rel=0.05)
    assert misfit["rms"] < 0.1


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            [],
            "--gauge: is missing; NAME=BODY:X gives a channel and the place",
        ),
        (
            ["--gauge", "fra=1:1"],
            "--gauge fra: the record has no channel 'fra'; perhaps 'far' is",
        ),
        (
            ["--gauge", "far=1:9"],
            "--gauge far: must lie in body 1, 0 to 2.0 m, got '9'",
        ),
        (
            [*FAR, "--gain", "2"],
            "--gain: needs --bridge",
        ),
        (
            [*FAR, "--bridge", "full", *BRIDGE],
            "--poisson-ratio: is missing; a full bridge needs it",
        ),
        (
            [*FAR, "--unit", "N", "--bridge", "half", *BRIDGE],
            "--bridge of far: must be a signal in V, got 'far' in N",
        ),
        (
            [*FAR, "--unit", "fat=N"],
            "--unit: there is no channel 'fat'",
        ),
        (
            [*FAR, "--rate", "1 MHz"],
            "shot.txt: has a column of times, 't'; leave rate",
        ),
        (
            [*FAR, "--radius", "1"],
            "--radius: goes with --carried",
        ),
        (
            [*FAR, "--start", "1 s"],
            "--start, --stop of far: fewer than two samples",
        ),
        (
            [*FAR, "--save", "a.npz"],
            "--save: must end in",
        ),
        (
            [*FAR, "--until", "0"],
            "case.toml: ",
        ),
    ],
)
def test_mistakes_are_named_and_leave_no_file(refuses, tmp_path, options, message):
    refuses([*FILES, *options], message)

    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"case.toml", "shot.txt"}


def test_gauges_of_the_case_serve(compared, tmp_path):
    """`compare` prints the same for a gauge of the case file as for the same gauge
    given as an option.
    """
    by_option = compared(*FAR, *EARLY)
    (tmp_path / "case.toml").write_text(CASE + GAUGE_OF_CASE)

    by_case = compared(*EARLY)

    assert by_case == by_option


def test_a_gauge_of_the_case_without_a_channel_is_refused(refuses, tmp_path):
    misspelt = GAUGE_OF_CASE.replace("far", "fra")
    (tmp_path / "case.toml").write_text(CASE + misspelt)

    refuses(FILES, "the record has no channel 'fra'; perhaps 'far' is meant")


def test_waves_are_carried_along_a_rod_that_has_a_diameter(compared):
    assert "misfit" in compared("--gauge", "far=1:0.5", "--carried", "0.5")


def test_waves_are_not_carried_along_a_rod_without_a_diameter(refuses, tmp_path):
    """`rodimpact compare --carried` refuses a case whose rod is given by its area, and
    asks for its diameter or for --radius.
    """
    by_area = CASE.replace("diameter = 0.02", "area = 1e-4")
    (tmp_path / "case.toml").write_text(by_area)
    carried = ["--gauge", "far=1:0.5", "--carried", "0.5"]

    refuses(
        [*FILES, *carried],
        "give the rod its diameter in place of the area, or --radius",
    )


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("none.csv", "none.csv: cannot be read: No such file"),
        ("case.toml", "case.toml: has no table of numbers"),
    ],
)
def test_records_that_cannot_be_read_are_refused(refuses, name, message):
    refuses(["compare", "case.toml", name, *FAR], message)


@pytest.mark.filterwarnings("always::rodimpact.ClippedSignal")
def test_a_clipped_record_is_announced(capsys, tmp_path):
    """`compare` of a record that stays at 20 V for 21 samples succeeds, and names this
    column on standard error.
    """
    lines = ["t_us,far_V"]
    for i in range(61):
        volts = min(i, 20, 60 - i)
        lines.append(f"{i},{volts}")
    (tmp_path / "clipped.csv").write_text("\n".join(lines) + "\n")

    status = main(["compare", "case.toml", "clipped.csv", "--gauge", "far=1:0.1"])

    assert status == 0
    assert "column 'far' stays at 20 for 21 samples" in capsys.readouterr().err
