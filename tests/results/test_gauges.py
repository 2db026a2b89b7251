"""Gauge records as tables."""

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.cli import main

STEEL = ri.materials.steel
CASE = """schema = 1
bodies = [
    {kind = "rod", length = 0.2, area = 1e-4, material = "steel", velocity = 10},
    {kind = "rod", length = 1.0, area = 1e-4, material = "steel"},
    {kind = "wall"},
]
"""


def striker_and_bar(speed=10.0, bar=1.0, striker=0.2):
    """A striker of steel, of this speed, before a bar: lengths in m."""
    moving = ri.Rod(striker, area=1e-4, material=STEEL, velocity=speed)
    return ri.System([moving, ri.Rod(bar, area=1e-4, material=STEEL)])


@pytest.fixture(scope="module")
def bars():
    """A striker before two bars."""
    output_bar = ri.Rod(1.0, area=1e-4, material=STEEL)
    return ri.solve(ri.System([*striker_and_bar().bodies, output_bar]))


def read(path):
    """Columns of a table by name, that of times as well; it has two rows at least."""
    signals = ri.read_signals(path)
    columns = {"time": next(iter(signals.values())).times}
    for name, signal in signals.items():
        columns[name] = signal.values
    return columns


def test_a_table_of_two_gauges_has_their_pulse_at_its_time(tmp_path, bars):
    """The striker of 0.2 m sends a pulse of twice its transit time and of strain
    v/(2c).
    """
    path = tmp_path / "bars.csv"
    interval = 1e-7  # s
    gauges = {"incident": bars.gauge(1, 0.5), "transmitted": bars.gauge(2, 0.5)}

    ri.gauges_to_csv(path, gauges, interval=interval)

    table = read(path)
    assert list(table) == ["time", "incident", "transmitted"]
    times = table["time"]
    incident = table["incident"]
    np.testing.assert_allclose(np.diff(times), interval, rtol=1e-6)
    c = STEEL.wave_speed
    strain = -10.0 / (2 * c)  # of a striker at 10 m/s
    assert incident.min() == pytest.approx(strain, rel=1e-12)
    begins = 0.5 / c  # the gauge is 0.5 m from the striker
    arrival = times[incident < -1e-9][0]
    assert arrival == pytest.approx(begins, abs=interval)
    before_reflection = (times > begins) & (times < 1.2 / c)
    passing = incident[before_reflection]
    duration = (passing < 0).sum() * interval
    round_trip = 2 * 0.2 / c  # of the striker
    assert duration == pytest.approx(round_trip, abs=2 * interval)


NO_INTERVALS = [
    0.0,
    -1.0,
    float("nan"),
    float("inf"),
    1e-30,
    5e-324,
    "1 us",
    [1e-6, 2e-6],
    [1e-6],
]


@pytest.mark.parametrize("interval", NO_INTERVALS, ids=repr)
def test_an_interval_that_is_no_positive_number_is_refused(tmp_path, bars, interval):
    """`gauges_to_csv` refuses the interval and writes no file."""
    path = tmp_path / "x.csv"
    gauges = {"a": bars.gauge(0, 0.1)}
    with pytest.raises(ri.InvalidModel, match="interval"):
        ri.gauges_to_csv(path, gauges, interval=interval)
    assert not path.exists()


def test_a_table_without_a_gauge_is_refused(tmp_path):
    """`gauges_to_csv` refuses an empty mapping and writes no file."""
    path = tmp_path / "x.csv"
    with pytest.raises(ri.InvalidModel, match="gauges"):
        ri.gauges_to_csv(path, {})
    assert not path.exists()


@pytest.mark.parametrize("interval", [None, 1e-6])
def test_a_record_of_no_time_is_one_row(tmp_path, interval):
    """The gauge of a run until 0 s, written to CSV with any interval, is a head and one
    row of zeros.
    """
    path = tmp_path / "x.csv"
    record = ri.solve(striker_and_bar(), until=0).gauge(0, 0.1)
    ri.gauges_to_csv(path, {"a": record}, interval=interval)
    assert path.read_text() == "time [s],a [1]\n0.0,0.0\n"


NO_NAMES = [
    "",
    "a,b",
    "a\nb",
    "a\r",
    "=1+1",
    "+1",
    "-1",
    "@x",
    "\tx",
    "a=b",
    'a"b',
    "a;b",
    " a",
    "time",
    "\udcff",
    "a\0",
    5,
    None,
]


@pytest.mark.parametrize("name", NO_NAMES, ids=repr)
def test_names_that_break_a_table_are_refused(tmp_path, bars, name):
    """`gauges_to_csv` refuses a second gauge by its name and writes no file."""
    path = tmp_path / "x.csv"
    gauge = bars.gauge(0, 0.1)
    with pytest.raises(ri.InvalidModel, match="gauges: a column is named by letters"):
        ri.gauges_to_csv(path, {"good": gauge, name: gauge})
    assert not path.exists()


def test_names_of_many_languages_are_columns(tmp_path, bars):
    """Gauges with names in other scripts, or with a comma-free colon, are written to
    CSV: the head is the time and each name with its unit, in order.
    """
    path = tmp_path / "x.csv"
    names = ["Stab 1 (Länge/2)", "入力棒", "ε_T", "2nd bar: x-0.5"]
    gauges = dict.fromkeys(names, bars.gauge(0, 0.1))

    ri.gauges_to_csv(path, gauges)

    head, *_ = path.read_text(encoding="utf-8").splitlines()
    columns = ["time [s]"]
    for name in names:
        columns.append(f"{name} [1]")
    assert head.split(",") == columns


def test_a_gauge_answers_at_both_ends_of_its_record(bars):
    """Strains at the first and the last time are the first and the last one recorded."""
    record = bars.gauge(1, 0.5)
    strains = record.strain_at([0.0, record.end])
    assert strains.tolist() == [record.strain[0], record.strain[-1]]


@pytest.mark.parametrize("share", [-1e-9, np.nan, 1.01, np.inf, -np.inf])
def test_a_gauge_answers_inside_its_record_only(bars, share):
    """Times are given as a share of the length of the record."""
    record = bars.gauge(1, 0.5)
    t = share * record.end
    message = rf"t\[1\]: must be from 0 to .* s, got {t}"
    with pytest.raises(ValueError, match=message):
        record.strain_at([0.0, t])


@pytest.mark.parametrize("x", [-5.0, np.nan, 1.01])
def test_a_gauge_outside_its_body_is_refused(bars, x):
    message = f"x: must lie in body 1, 0 to 1 m, got {x}"
    with pytest.raises(ValueError, match=message):
        bars.gauge(1, x)


def test_the_command_line_writes_a_table_of_gauges_once(tmp_path, capsys):
    """`run --gauges` with two gauges writes a table with time and both; a second run is
    refused, as the file exists.
    """
    case = tmp_path / "case.toml"
    case.write_text(CASE)
    table = tmp_path / "bars.csv"
    command = ["run", str(case), "--gauges", str(table), "--gauge", "left=0:0.1"]
    first = main([*command, "--gauge", "right=1:50 cm"])
    columns = list(read(table))
    again = main(command)
    assert first == 0
    assert columns == ["time", "left", "right"]
    assert again == 2
    assert "exists already" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--gauge", "a=0:0.1"], "goes with --gauge"),
        (["--gauges", "x.csv"], "goes with --gauge"),
        (["--gauges", "x.csv", "--gauge", "0:0.1"], "must be NAME=BODY:X"),
        (
            ["--gauges", "x.csv", "--gauge", "a=2:0.1"],
            "body 2 is no rod; the rods are 0, 1",
        ),
        (["--gauges", "x.csv", "--gauge", "a=9:0.1"], "body 9 is no rod"),
        (["--gauges", "x.csv", "--gauge", "a=0:1"], "must lie in body 0"),
        (["--gauges", "x.csv", "--gauge", "a=0:1 kg"], "--gauge a"),
        (
            ["--gauges", "x.csv", "--gauge", "a,b=0:0.1"],
            "--gauge: a column is named by letters",
        ),
    ],
)
def test_mistakes_on_the_command_line_are_named_and_write_nothing(
    tmp_path, capsys, monkeypatch, options, message
):
    """`rodimpact run` with a wrong --gauge, or with one of --gauge and --gauges alone,
    ends with status 2 and a message, and writes no table.
    """
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(CASE)
    assert main(["run", "case.toml", *options]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "x.csv").exists()


def record_of_struck_rod(law=None, **options):
    """The record in the middle of a rod that is struck by its like, through a law or
    without one.
    """
    striker = ri.Rod(0.2, area=1e-4, material=STEEL, velocity=1.0)
    struck = ri.Rod(0.2, area=1e-4, material=STEEL)
    contacts = None
    if law is not None:
        contacts = [law]
    system = ri.System([striker, struck], contacts=contacts)
    return ri.solve(system, **options).gauge(1, 0.1)


def quadratic_spline(steps):
    """The quadratic B-spline over three steps, whose integral is 1, at places from -1.5
    to 1.5.
    """
    distance = np.abs(steps)
    middle = 0.75 - distance**2
    flank = (1.5 - distance) ** 2 / 2
    return np.where(distance < 0.5, middle, flank)


@pytest.mark.parametrize(
    "options",
    [
        {"until": 2e-4},
        {"until": 4e-5, "method": "finite-difference", "cells": 16, "snapshots": 9},
        pytest.param(
            {"law": ri.Spring(1e8), "until": 2e-4}, marks=pytest.mark.exhaustive
        ),
    ],
    ids=["fronts", "grid", "characteristics"],
)
def test_a_signal_is_the_mean_under_a_spline(options):
    """Each value of the signal of a gauge is the mean of its strain under a quadratic
    spline, here a sum over very short parts, to 2e-8. Both ends of the record are left
    out.
    """
    record = record_of_struck_rod(**options)
    step = 2.7e-6  # s
    width = 1e-4  # of a part, in steps
    middles = np.arange(-1.5, 1.5, width) + width / 2  # of the parts, in steps
    weights = quadratic_spline(middles) * width

    signal = record.signal(step)

    assert np.ptp(signal.values) > 8e-5  # the wave of v/(2 c) = 1e-4 is in the record
    # The spline of the first and last two reaches beyond the record.
    times = signal.times[2:-2]
    values = signal.values[2:-2]
    for t, value in zip(times, values, strict=True):
        strain = record.strain_at(t + step * middles)
        mean = strain @ weights
        assert mean == pytest.approx(value, abs=2e-8)


def test_a_signal_says_that_it_is_strain_and_where_unless_it_gets_a_name(bars):
    """A signal of a gauge is named after its rod and position, or as given, also in
    xarray.
    """
    record = bars.gauge(2, 0.5)

    assert record.signal().name == "strain of rod 3 at 0.5 m"
    assert record.signal(name="transmitted").name == "transmitted"
    pytest.importorskip("xarray")
    attributes = record.signal().to_xarray().attrs
    assert attributes == {"long_name": "strain of rod 3 at 0.5 m", "units": "1"}


def test_an_interval_longer_than_the_record_is_refused():
    """A signal of a gauge has 10,000 intervals by default; an interval longer than the
    record is refused.
    """
    record = record_of_struck_rod(until=2e-4)
    assert len(record.signal()) == 10_001  # by default 10,000 intervals
    message = "interval: must not be longer than the record"
    with pytest.raises(ri.InvalidModel, match=message):
        record.signal(1.0)


def test_strains_of_a_grid_run_straight_between_its_states():
    """The strain of a gauge on a grid is the recorded one at the kept states and the
    mean of two neighbours in the middle between them.
    """
    record = record_of_struck_rod(
        until=4e-5, method="finite-difference", cells=16, snapshots=9
    )
    times = record.times
    strain = record.strain
    middles = (times[1:] + times[:-1]) / 2
    means = (strain[1:] + strain[:-1]) / 2

    at_states = record.strain_at(times)
    between_states = record.strain_at(middles)

    assert np.ptp(strain) > 1e-5  # there is a wave
    assert at_states == pytest.approx(strain, abs=1e-18)
    assert between_states == pytest.approx(means, abs=1e-18)


@pytest.mark.parametrize(
    ("method", "dt"),
    [
        ("fronts", None),
        pytest.param("characteristics", None, marks=pytest.mark.exhaustive),
        ("finite-difference", 5e-7),
    ],
)
def test_the_misfit_of_signals_is_a_parabola_of_the_length_of_a_striker(method, dt):
    """Signals for 13 lengths of a striker, 127 to 127.2 mm, all differ, and their
    misfit against one of 128 mm is a parabola of the length to 1 %, as fits need it.
    """

    def signal_of_striker(length):
        """Strain of a bar that a striker of this length has struck, as sampled."""
        system = striker_and_bar(striker=length, bar=0.5)
        solution = ri.solve(system, until=1e-4, method=method, dt=dt)
        return solution.gauge(1, 0.2).signal(1e-7).values

    measured = signal_of_striker(0.128)
    lengths = np.linspace(0.127, 0.1272, 13)
    signals = np.array([signal_of_striker(length) for length in lengths])
    differences = signals - measured
    misfits = np.sqrt(np.mean(differences**2, axis=1))  # [length]

    different_signals = {values.tobytes() for values in signals}
    assert len(different_signals) == len(lengths)
    changes = lengths - lengths.mean()
    coefficients = np.polyfit(changes, misfits, deg=2)
    parabola = np.polyval(coefficients, changes)
    error = np.abs(misfits - parabola).max()
    assert error < 0.01 * np.ptp(misfits)
