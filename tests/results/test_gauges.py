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


@pytest.fixture(scope="module")
def bars():
    rods = [
        ri.Rod(L, area=1e-4, material=STEEL, velocity=v)
        for L, v in ((0.2, 10.0), (1.0, 0.0), (1.0, 0.0))
    ]
    return ri.solve(ri.System(rods))


def read(path):
    """Columns by name; `read_signals` reads more than one row."""
    signals = ri.read_signals(path)
    times = next(iter(signals.values())).times
    return {"time": times, **{name: signal.values for name, signal in signals.items()}}


def test_bars_in_three_columns(tmp_path, bars):
    """The striker of 0.2 m sends a pulse of twice its transit time and of strain v/(2c)."""
    gauges = {"incident": bars.gauge(1, 0.5), "transmitted": bars.gauge(2, 0.5)}
    ri.gauges_to_csv(tmp_path / "bars.csv", gauges, interval=1e-7)
    table = read(tmp_path / "bars.csv")
    assert list(table) == ["time", "incident", "transmitted"]
    np.testing.assert_allclose(np.diff(table["time"]), 1e-7, rtol=1e-6)
    c = STEEL.wave_speed
    inside = table["incident"] < -1e-9
    assert table["incident"].min() == pytest.approx(-10 / (2 * c), rel=1e-12)
    first = table["time"][inside][0]
    assert first == pytest.approx(0.5 / c, abs=1e-7)
    passing = table["incident"][(table["time"] > 0.5 / c) & (table["time"] < 1.2 / c)]
    assert (passing < 0).sum() * 1e-7 == pytest.approx(0.4 / c, abs=2e-7)


@pytest.mark.parametrize(
    "interval",
    [
        0.0,
        -1.0,
        float("nan"),
        float("inf"),
        1e-30,
        5e-324,
        "1 us",
        [1e-6, 2e-6],
        [1e-6],
    ],
    ids=repr,
)
def test_an_interval_must_be_positive(tmp_path, bars, interval):
    with pytest.raises(ri.InvalidModel, match="interval"):
        ri.gauges_to_csv(
            tmp_path / "x.csv", {"a": bars.gauge(0, 0.1)}, interval=interval
        )
    with pytest.raises(ri.InvalidModel, match="gauges"):
        ri.gauges_to_csv(tmp_path / "x.csv", {})
    assert not (tmp_path / "x.csv").exists()


def test_a_record_of_no_time_is_one_row(tmp_path):
    bars = [
        ri.Rod(L, area=1e-4, material=STEEL, velocity=v)
        for L, v in ((0.2, 10.0), (1.0, 0.0))
    ]
    record = ri.solve(ri.System(bars), until=0).gauge(0, 0.1)
    for interval in (None, 1e-6):
        ri.gauges_to_csv(
            tmp_path / "x.csv", {"a": record}, interval=interval, force=True
        )
        assert (tmp_path / "x.csv").read_text() == "time [s],a [1]\n0.0,0.0\n"


@pytest.mark.parametrize(
    "name",
    [
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
    ],
    ids=repr,
)
def test_names_that_break_a_table_are_refused(tmp_path, bars, name):
    with pytest.raises(ri.InvalidModel, match="gauges: a column is named by letters"):
        ri.gauges_to_csv(
            tmp_path / "x.csv", {"good": bars.gauge(0, 0.1), name: bars.gauge(0, 0.1)}
        )
    assert not (tmp_path / "x.csv").exists()


def test_names_of_many_languages_are_columns(tmp_path, bars):
    names = ["Stab 1 (Länge/2)", "入力棒", "ε_T", "2nd bar: x-0.5"]
    ri.gauges_to_csv(tmp_path / "x.csv", {name: bars.gauge(0, 0.1) for name in names})
    head = (tmp_path / "x.csv").read_text(encoding="utf-8").splitlines()[0]
    assert head.split(",") == ["time [s]", *(f"{name} [1]" for name in names)]


def test_a_gauge_answers_inside_its_record_only(bars):
    record = bars.gauge(1, 0.5)
    assert record.strain_at([0.0, record.end]).tolist() == [
        record.strain[0],
        record.strain[-1],
    ]
    for t in (-1e-9, np.nan, record.end * 1.01, np.inf, -np.inf):
        with pytest.raises(
            ValueError, match=rf"t\[1\]: must be from 0 to .* s, got {t}"
        ):
            record.strain_at([0.0, t])
    for x in (-5.0, np.nan, 1.01):
        with pytest.raises(
            ValueError, match=f"x: must lie in body 1, 0 to 1 m, got {x}"
        ):
            bars.gauge(1, x)


def test_on_the_command_line(tmp_path, capsys):
    (tmp_path / "case.toml").write_text(CASE)
    table = tmp_path / "bars.csv"
    call = [
        "run",
        str(tmp_path / "case.toml"),
        "--gauges",
        str(table),
        "--gauge",
        "left=0:0.1",
    ]
    assert main([*call, "--gauge", "right=1:50 cm"]) == 0
    assert list(read(table)) == ["time", "left", "right"]
    assert main(call) == 2
    assert "exists already" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "said"),
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
def test_mistakes_on_the_command_line(tmp_path, capsys, monkeypatch, options, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(CASE)
    assert main(["run", "case.toml", *options]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "x.csv").exists()


def struck(law=None, **options):
    rods = [ri.Rod(0.2, area=1e-4, material=STEEL, velocity=v) for v in (1.0, 0.0)]
    return ri.solve(ri.System(rods, contacts=[law or ri.Rigid()]), **options).gauge(
        1, 0.1
    )


@pytest.mark.parametrize(
    "options",
    [
        {"until": 2e-4},
        {"until": 4e-5, "method": "finite-difference", "cells": 16, "snapshots": 9},
        {"law": ri.Spring(1e8), "until": 2e-4},
    ],
    ids=["fronts", "grid", "characteristics"],
)
def test_a_signal_is_the_mean_under_a_spline(options):
    """Against the mean over very short pieces of the record."""
    record = struck(**options)
    step = 2.7e-6
    signal = record.signal(step)
    pieces = np.arange(-1.5, 1.5, 1e-4) + 5e-5
    weights = (
        np.where(abs(pieces) < 0.5, 0.75 - pieces**2, (1.5 - abs(pieces)) ** 2 / 2)
        * 1e-4
    )
    for t, value in zip(signal.times[2:-2], signal.values[2:-2], strict=True):
        assert record.strain_at(t + step * pieces) @ weights == pytest.approx(
            value, abs=2e-8
        )
    assert np.ptp(signal.values) > 8e-5
    assert len(record.signal()) == 10_001
    with pytest.raises(
        ri.InvalidModel, match="interval: must not be longer than the record"
    ):
        record.signal(1.0)


def test_a_grid_runs_straight_between_its_states():
    record = struck(until=4e-5, method="finite-difference", cells=16, snapshots=9)
    middles = (record.times[1:] + record.times[:-1]) / 2
    assert np.ptp(record.strain) > 1e-5
    assert record.strain_at(record.times) == pytest.approx(record.strain, abs=1e-18)
    wanted = (record.strain[1:] + record.strain[:-1]) / 2
    assert record.strain_at(middles) == pytest.approx(wanted, abs=1e-18)


@pytest.mark.parametrize(
    ("method", "dt"),
    [
        ("fronts", None),
        ("characteristics", None),
        ("finite-difference", 5e-7),
    ],
)
def test_signals_vary_smoothly_with_the_length_of_a_striker(method, dt):
    def values(length):
        rods = [
            ri.Rod(L, area=1e-4, material=STEEL, velocity=v)
            for L, v in ((length, 10.0), (0.5, 0.0))
        ]
        solution = ri.solve(ri.System(rods), until=1e-4, method=method, dt=dt)
        return solution.gauge(1, 0.2).signal(1e-7).values

    wanted = values(0.128)
    lengths = np.linspace(0.127, 0.1272, 25)
    records = [values(length) for length in lengths]
    assert len({record.tobytes() for record in records}) == 25
    off = np.array([np.sqrt(np.mean((record - wanted) ** 2)) for record in records])
    at = lengths - 0.1271
    assert np.abs(off - np.polyval(np.polyfit(at, off, 2), at)).max() < 0.01 * np.ptp(
        off
    )
