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
C = ri.materials.steel.wave_speed


@pytest.fixture(autouse=True)
def shot(tmp_path, monkeypatch):
    """A record made of the case: later by 33 us, in volts of a half bridge, with noise."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(CASE)
    solution = ri.solve(ri.parse_case(CASE).system, until=3e-4)
    rng = np.random.default_rng(2)
    bars = {}
    for name, x in (("near #1", 0.5), ("far", 1.0)):
        strain = solution.gauge(1, x).signal(1e-7).window(0.0, 2.9e-4).shifted(33e-6)
        volts = strain / 4e-3 + ri.Signal(
            1e-4 * rng.normal(size=len(strain)), strain.times
        )
        bars[name] = volts.replace(unit="V")
    times = bars["far"].times
    rows = zip(times * 1e6, *(s.values * 1e3 for s in bars.values()), strict=True)
    (tmp_path / "shot.txt").write_text(
        "t (us);near #1 (mV);far (mV)\n"
        + "".join(
            "{:.1f};{:.4f};{:.4f}\n".format(*row).replace(".", ",") for row in rows
        )
    )


@pytest.fixture
def compared(output_of):
    """What a comparison prints."""
    return lambda *options: output_of("compare", "case.toml", "shot.txt", *options)


def test_what_was_done_to_the_record_is_found(compared, tmp_path):
    result = json.loads(
        compared(
            "--gauge",
            "near #1=1:0.5",
            "--gauge",
            "far=1:100 cm",
            "--stop",
            "320 us",
            "--json",
            "--save",
            "shot.svg",
        )
    )["channels"]
    for name, x in (("near #1", 0.5), ("far", 1.0)):
        channel = result[name]
        assert channel["unit"] == "V"
        assert channel["misfit"]["shift"] == pytest.approx(33e-6, abs=1e-8)
        assert channel["misfit"]["scale"] == pytest.approx(250.0, rel=1e-3)
        assert channel["misfit"]["rms"] < 1e-2
        for pulse in (channel["measured"], channel["predicted"]):
            assert pulse["start"] == pytest.approx(33e-6 + x / C, abs=2e-7)
            assert pulse["width"] == pytest.approx(0.4 / C, abs=2e-7)
            assert pulse["plateau"] == pytest.approx(-10 / (2 * C) / 4e-3, rel=1e-3)
    assert "<svg" in (tmp_path / "shot.svg").read_text()
    out = compared("--gauge", "far=1:1.0", "--stop", "320 us")
    for words in (
        "measured",
        "predicted",
        "pulse starts",
        "misfit, root mean",
        "shift of",
        "gain",
    ):
        assert words in out


def test_a_bridge_makes_strain_and_fixed_numbers_stay(compared):
    bridge = [
        "--bridge",
        "half",
        "--gauge-factor",
        "2",
        "--excitation",
        "5 V",
        "--gain",
        "100",
    ]
    options = [
        "--gauge",
        "far=1:1.0",
        "--shift",
        "33us",
        "--scale",
        "1",
        "--stop",
        "320 us",
    ]
    channel = json.loads(compared(*options, *bridge, "--json"))["channels"]["far"]
    misfit = channel["misfit"]
    assert (channel["unit"], misfit["shift"], misfit["scale"]) == ("", 33e-6, 1)
    half = 4 / (2 * 2 * 5 * 100) / 4e-3  # of the strain that the record was made of
    pulse = channel["measured"]
    assert pulse["plateau"] == pytest.approx(-10 / (2 * C) * half, rel=1e-3)
    assert misfit["rms"] > 0.2


def test_what_passes_near_the_end_is_carried_on(compared):
    """Long waves run at the wave speed; the plateau of a pulse is one."""
    carried = ["--carried", "80 cm", "--radius", "1 cm", "--stop", "320 us", "--json"]
    channel = json.loads(compared("--gauge", "far=1:0.2", *carried))["channels"]["far"]
    assert channel["misfit"]["shift"] == pytest.approx(33e-6, abs=2e-6)
    assert channel["misfit"]["scale"] == pytest.approx(250.0, rel=0.05)
    assert channel["misfit"]["rms"] < 0.1


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ([], "--gauge: is missing; NAME=BODY:X gives a channel and the place"),
        (
            ["--gauge", "fra=1:1"],
            "--gauge fra: the record has no channel 'fra'; perhaps 'far' is",
        ),
        (
            ["--gauge", "far=1:9"],
            "--gauge far: must lie in body 1, 0 to 2.0 m, got '9'",
        ),
        (["--gauge", "far=1:1", "--gain", "2"], "--gain: needs --bridge"),
        (
            [
                "--gauge",
                "far=1:1",
                "--bridge",
                "full",
                "--gauge-factor",
                "2",
                "--excitation",
                "5",
            ],
            "--poisson-ratio: is missing; a full bridge needs it",
        ),
        (
            [
                "--gauge",
                "far=1:1",
                "--unit",
                "N",
                "--bridge",
                "half",
                "--gauge-factor",
                "2",
                "--excitation",
                "5",
            ],
            "--bridge of far: must be a signal in V, got 'far' in N",
        ),
        (
            ["--gauge", "far=1:1", "--unit", "fat=N"],
            "--unit: there is no channel 'fat'",
        ),
        (
            ["--gauge", "far=1:1", "--rate", "1 MHz"],
            "shot.txt: has a column of times, 't'; leave rate",
        ),
        (["--gauge", "far=1:1", "--radius", "1"], "--radius: goes with --carried"),
        (
            ["--gauge", "far=1:1", "--start", "1 s"],
            "--start, --stop of far: fewer than two samples",
        ),
        (["--gauge", "far=1:1", "--save", "a.npz"], "--save: must end in"),
        (["--gauge", "far=1:1", "--until", "0"], "case.toml: "),
    ],
)
def test_mistakes(refuses, tmp_path, options, sentence):
    refuses(["compare", "case.toml", "shot.txt", *options], sentence)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml", "shot.txt"]


def test_gauges_of_the_case_serve(compared, refuses, tmp_path):
    gauges = '[[gauges]]\nbody = 1\nfraction = 0.5\nname = "far"\n'
    (tmp_path / "case.toml").write_text(CASE + gauges)
    assert compared("--stop", "320 us") == compared(
        "--gauge", "far=1:1.0", "--stop", "320 us"
    )
    (tmp_path / "case.toml").write_text(CASE + gauges.replace("far", "fra"))
    refuses(
        ["compare", "case.toml", "shot.txt"],
        "the record has no channel 'fra'; perhaps 'far' is meant",
    )


def test_waves_are_carried_along_a_rod_that_has_a_diameter(compared, refuses, tmp_path):
    assert compared("--gauge", "far=1:0.5", "--carried", "0.5")
    (tmp_path / "case.toml").write_text(CASE.replace("diameter = 0.02", "area = 1e-4"))
    refuses(
        [
            "compare",
            "case.toml",
            "shot.txt",
            "--gauge",
            "far=1:0.5",
            "--carried",
            "0.5",
        ],
        "give the rod its diameter in place of the area, or --radius",
    )


@pytest.mark.filterwarnings("always::rodimpact.ClippedSignal")
def test_records_that_cannot_be_read(capsys, refuses, tmp_path):
    for name, sentence in (
        ("none.csv", "none.csv: cannot be read: No such file"),
        ("case.toml", "case.toml: has no table of numbers"),
    ):
        refuses(["compare", "case.toml", name, "--gauge", "far=1:1"], sentence)
    (tmp_path / "clipped.csv").write_text(
        "t_us,far_V\n" + "".join(f"{i},{min(i, 20, 60 - i)}\n" for i in range(61))
    )
    assert main(["compare", "case.toml", "clipped.csv", "--gauge", "far=1:0.1"]) == 0
    assert "column 'far' stays at 20 for 21 samples" in capsys.readouterr().err
