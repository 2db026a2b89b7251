"""rodimpact reduce: what a specimen did, from the record of two bars."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.cli import main
from rodimpact.records import shot

BARS = (
    """
schema = 1
[materials.titanium]
youngs_modulus = "104.563 GPa"
density = 4416
poisson_ratio = 0.33
"""
    + """
[[bodies]]
kind = "rod"
length = "762 mm"
diameter = "9.47 mm"
material = "titanium"
"""
    * 2
)
RECORD = str(Path("validation/records/lanl_titanium_bars.csv").absolute())
BRIDGE = [
    "--bridge",
    "quarter",
    "--gauge-factor",
    "2.061",
    "--excitation",
    "8",
    "--gain",
    "200",
]
GAUGES = ["--gauge", "incident=0:381mm", "--gauge", "transmitted=1:381mm"]
SPECIMEN = ["--length", "3.204mm", "--diameter", "6.34mm"]
ALL = [*GAUGES, *SPECIMEN, *BRIDGE, "--compression", "positive"]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """The present directory, with a file of the bars."""
    (tmp_path / "bars.toml").write_text(BARS)
    monkeypatch.chdir(tmp_path)


@pytest.fixture(autouse=True)
def few_draws(monkeypatch):
    """No test reads error bands: they may take few draws of the noise."""
    monkeypatch.setattr(shot, "NOISE_DRAWS", 4)


def reduce(*options):
    """Exit status of a reduction of the record."""
    return main(["reduce", "bars.toml", RECORD, *options])


@pytest.fixture
def text_of(output_of):
    """Function that reduces the record, and returns the printed text."""

    def call(*options):
        return output_of("reduce", "bars.toml", RECORD, *options)

    return call


def test_json_and_the_table_are_those_of_the_function(text_of):
    """`reduce --json` prints the times and true stresses of `ri.reduce` bit for bit;
    without --incompressible the printed table is that of its result.
    """
    printed = json.loads(text_of(*ALL, "--incompressible", "--json"))

    case = ri.read_case("bars.toml")
    bridge = ri.Bridge("quarter", gauge_factor=2.061, excitation=8.0, gain=200.0)
    gauges = []
    for volts in ri.read_signals(RECORD).values():
        gauges.append(ri.BarGauge(bridge.strain(volts), 0.381))
    specimen = ri.Specimen(3.204e-3, diameter=6.34e-3, incompressible=True)
    bars = case.system.bodies
    result = ri.reduce(*gauges, bars, specimen, compression="positive")
    assert np.array_equal(printed["true_stress"], result.true_stress)
    assert np.array_equal(printed["time"], result.times)
    without_volume = text_of(*ALL)
    assert without_volume.rstrip("\n") == str(result)


def test_a_table_and_a_figure_are_written_and_not_overwritten(refuses):
    """`reduce` writes a table and a figure; a second time each is refused with the
    advice of --force.
    """
    table = ["--csv", "shot.csv"]
    figure = ["--save", "shot.svg"]

    assert reduce(*ALL, *table, *figure) == 0

    assert "stress" in ri.read_signals("shot.csv")
    assert Path("shot.svg").read_text().startswith("<?xml")
    again = ["reduce", "bars.toml", RECORD, *ALL]
    remedy = "--force"  # named by the message
    refuses([*again, *table], "shot.csv", remedy)
    refuses([*again, *figure], "shot.svg", remedy)


@pytest.mark.exhaustive
def test_a_limit_of_alignment_is_an_option(text_of):
    printed = json.loads(text_of(*ALL, "--align-within", "2us", "--json"))
    assert printed["alignment"]["limit"] == 2e-6


# The gauge of the input bar, 762 mm long, is said to lie 200 mm from the specimen.
WRONG_DISTANCE = [
    *["--gauge", "incident=0:562mm", "--gauge", "transmitted=1:381mm"],
    *ALL[len(GAUGES) :],
]


def test_a_doubt_is_told_once_in_the_table_or_in_json(capsys):
    """`reduce` with a wrong distance prints its doubts in the table, the same ones in
    JSON, and nothing on standard error.
    """
    assert reduce(*WRONG_DISTANCE) == 0
    printed = capsys.readouterr()
    assert reduce(*WRONG_DISTANCE, "--json") == 0
    document = json.loads(capsys.readouterr().out)

    assert printed.err == ""
    lines = printed.out.splitlines()
    doubts = [line for line in lines if line.startswith("doubtful: ")]
    first_doubt, *_ = doubts
    assert "the reflected wave arrives 156 us after the incident wave" in first_doubt
    assert "the bar speed, which a shot with the bars together measures" in first_doubt
    doubts_in_json = [f"doubtful: {doubt}" for doubt in document["doubts"]]
    assert doubts_in_json == doubts


def test_a_doubt_is_status_3_with_strict_and_the_help_says_so(capsys, output_of):
    assert reduce(*WRONG_DISTANCE, "--strict") == 3
    assert "doubtful: " in capsys.readouterr().out
    assert reduce(*ALL, "--strict") == 0
    help_text = " ".join(output_of("reduce", "--help").split())  # in one line
    assert "exit status 3" in help_text


def test_the_first_lines_are_the_verdict_and_json_has_it(text_of):
    """The percentage begins with 1, the stress in MPa with 64. Nothing is aligned."""
    first, second, *_ = text_of(*ALL).splitlines()
    assert first.startswith("equilibrium is reached at 1")
    assert second.startswith("peak stress 64")
    printed = json.loads(text_of(*ALL, "--json"))
    verdict = printed["verdict"]
    assert verdict["in_equilibrium"] is True
    assert verdict["peak_stress"] == max(printed["stress"])
    assert printed["alignment"] is None


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ([*GAUGES, *BRIDGE, "--area", "-1"], "are required: --length"),
        ([*GAUGES, *SPECIMEN, *BRIDGE, "--area", "1 mm^2"], "--area: give either"),
        ([*GAUGES[:2], *SPECIMEN, *BRIDGE], "neighbouring rods"),
        ([*GAUGES, *SPECIMEN], "--bridge: is missing; the channel 'incident' is in V"),
        ([*GAUGES, *SPECIMEN, *BRIDGE], "give --compression positive"),
        ([*GAUGES, *SPECIMEN, "--gain", "2"], "--gain: needs --bridge"),
        ([*ALL, "--align-within", "-1us"], "--align-within: must be"),
        (
            ["--gauge", "incdent=0:0.4", *ALL[2:]],
            "no channel 'incdent'; perhaps 'incident'",
        ),
    ],
)
def test_mistakes_are_named_by_option(options, sentence, refuses):
    refuses(["reduce", "bars.toml", RECORD, *options], sentence)


def write_pulses():
    """Write the three pulses of the record as strains; return the names of files."""
    bridge = ri.Bridge("quarter", gauge_factor=2.061, excitation=8.0, gain=200.0)
    record = ri.read_signals(RECORD)
    windows = {
        "incident.csv": ("incident", -20e-6, 120e-6),
        "reflected.csv": ("incident", 130e-6, 270e-6),
        "transmitted.csv": ("transmitted", 130e-6, 270e-6),
    }
    for name, (channel, start, end) in windows.items():
        pulse = record[channel].window(start, end)
        bridge.strain(pulse).to_csv(name)
    return list(windows)


PULSES = [
    *("--incident", "incident=0:381mm"),
    *("--reflected", "reflected=0:381mm"),
    *("--transmitted", "transmitted=1:381mm"),
]


@pytest.mark.exhaustive
def test_three_cut_pulses_have_the_verdict_of_the_whole_record(text_of, output_of):
    """`reduce` of three files of pulses gives the peak stress, to 1 %, and the energy,
    to 3 %, that it gives for the whole record.
    """
    options = [*PULSES, *SPECIMEN, "--compression", "positive"]
    command = ["reduce", "bars.toml", *write_pulses(), *options]

    of_whole = json.loads(text_of(*ALL, "--json"))["verdict"]
    of_pulses = json.loads(output_of(*command, "--json"))["verdict"]

    peak_stress = of_whole["peak_stress"]
    energy = of_whole["energy"]
    assert of_pulses["peak_stress"] == pytest.approx(peak_stress, rel=0.01)
    assert of_pulses["energy"] == pytest.approx(energy, rel=0.03)


def test_cut_pulses_may_have_times_of_their_own(output_of):
    options = [*PULSES, *SPECIMEN, "--compression", "positive", "--clock", "own"]
    text = output_of("reduce", "bars.toml", *write_pulses(), *options)
    assert text.startswith("equilibrium")


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (PULSES[:4], "--transmitted: is missing; give all three pulses"),
        ([*PULSES, *GAUGES], "--gauge: give either gauges or three cut pulses"),
        (
            [*PULSES[:4], "--transmitted", "transmitted=0:381mm"],
            "--transmitted: must be on the body after",
        ),
        (
            [*PULSES[:2], "--reflected", "incident=0:381mm", *PULSES[4:]],
            "--incident: give three different channels",
        ),
        ([*PULSES[:5], "transmitted=1"], "--transmitted: must be NAME=BODY:X"),
    ],
)
def test_mistakes_of_cut_pulses_are_named_by_option(options, sentence, refuses):
    refuses(["reduce", "bars.toml", *write_pulses(), *options, *SPECIMEN], sentence)


DIRECT = """
schema = 1
[materials.plain]
youngs_modulus = "200 GPa"
density = 7850
[[bodies]]
kind = "rod"
length = "0.2 m"
diameter = "12 mm"
material = "plain"
velocity = 10.0
[[bodies]]
kind = "rod"
length = "1.2 m"
diameter = "12 mm"
material = "plain"
[[contacts]]
law = "yielding"
stiffness = 4e8
yield_force = 5e3
hardening = 1e7
"""


def test_files_without_heads_are_channels_by_their_names(text_of, output_of):
    """A scope writes a file for each channel, volts before time."""
    files = []
    for name, signal in ri.read_signals(RECORD).items():
        lines = []
        for volts, time in zip(
            signal.values.tolist(), signal.times.tolist(), strict=True
        ):
            lines.append(f"{volts!r},{time!r}")
        Path(f"{name}.csv").write_text("\n".join(lines))
        files.append(f"{name}.csv")
    units = ["--time-unit", "s", "--unit", "V"]

    text = output_of("reduce", "bars.toml", *files, *ALL, *units)

    assert text == text_of(*ALL)


def test_a_missing_package_names_its_extra(monkeypatch, refuses):
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    Path("shot.xlsx").write_bytes(b"PK")
    refuses(["reduce", "bars.toml", "shot.xlsx", *ALL], "shot.xlsx: openpyxl is not")


@pytest.mark.exhaustive
def test_a_direct_impact_is_reduced_with_its_own_case(output_of):
    """`reduce --direct-impact` of a computed record gives the peak force of the contact
    to 2 %; equilibrium and imbalance are None.
    """
    Path("direct.toml").write_text(DIRECT)
    case = ri.read_case("direct.toml")
    run = ri.solve(case.system, until=3e-4)
    record = run.gauge(1, 0.6).signal(2e-7).extended(before=3e-5)
    ri.write_signals("direct.csv", {"transmitted": record})
    options = ["--gauge", "transmitted=1:0.6", "--length", "4mm", "--diameter", "8mm"]
    command = ["reduce", "direct.toml", "direct.csv", *options]

    printed = json.loads(output_of(*command, "--direct-impact", "--json"))

    force = run.contacts[0].force(np.maximum(printed["time"], 0.0))
    assert max(printed["output_force"]) == pytest.approx(force.max(), rel=0.02)
    assert printed["verdict"]["in_equilibrium"] is None
    assert printed["verdict"]["imbalance"] is None


def test_equal_forces_are_assumed_by_an_option(text_of):
    text = text_of(*ALL, "--equal-forces", "--wave-speed", "3700")
    assert text.startswith("equilibrium is assumed, not measured")
    # 4 x 3.204 mm over 3700 m/s
    assert "it takes some 3.46 us, 4 transit times" in text


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ([*ALL, "--direct-impact"], "--direct-impact: needs --gauge on one bar"),
        (
            [*GAUGES[2:], *ALL[4:], "--direct-impact", "--equal-forces"],
            "--direct-impact: goes with --gauge alone",
        ),
        ([*GAUGES[2:], *ALL[4:], "--direct-impact"], "must have a velocity above 0"),
        ([*ALL, "--equal-forces", "--align-within", "1us"], "--align-within: balances"),
    ],
)
def test_mistakes_of_equal_forces_are_named_by_option(options, sentence, refuses):
    refuses(["reduce", "bars.toml", RECORD, *options], sentence)


@pytest.mark.exhaustive
def test_a_planned_shot_is_reduced_with_its_own_case(capsys):
    """A shot with a yielding specimen is computed, its records are written, and
    `reduce` uses them with the case file of the plan: the largest force is that of the
    contact to 1 %.
    """
    ideal = BARS.replace("poisson_ratio = 0.33\n", "")  # bars that do not disperse
    Path("plan.toml").write_text(
        ideal
        + """
[[contacts]]
law = "yielding"
stiffness = 4e8
yield_force = 5e3
hardening = 1e7
"""
    )
    case = ri.read_case("plan.toml")
    bars = case.system.bodies
    metal = bars[0].segments[0].material
    striker = ri.Rod(0.1, diameter=9.47e-3, material=metal, velocity=15.0)
    contacts = [ri.Rigid(), *case.system.contacts]
    run = ri.solve(ri.System([striker, *bars], contacts=contacts), until=4e-4)
    records = {}
    for name, body in (("incident", 1), ("transmitted", 2)):
        signal = run.gauge(body, 0.381).signal(2e-7).extended(before=3e-5)
        times = signal.times[signal.times <= 4e-4]
        records[name] = signal.resampled(times=times)
    ri.write_signals("plan.csv", records)

    status = main(["reduce", "plan.toml", "plan.csv", *GAUGES, *SPECIMEN, "--json"])

    printed = json.loads(capsys.readouterr().out)
    force = run.contacts[1].force(np.array(printed["time"]))
    assert status == 0
    assert max(printed["output_force"]) == pytest.approx(force.max(), rel=0.01)
