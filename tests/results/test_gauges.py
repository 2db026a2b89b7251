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
    rods = [ri.Rod(L, area=1e-4, material=STEEL, velocity=v)
            for L, v in ((0.2, 10.0), (1.0, 0.0), (1.0, 0.0))]
    return ri.solve(ri.System(rods))


def read(path):
    return np.genfromtxt(path, delimiter=",", names=True)


def test_bars_in_three_columns(tmp_path, bars):
    """The striker of 0.2 m sends a pulse of twice its transit time and of strain v/(2c)."""
    gauges = {"incident": bars.gauge(1, 0.5), "transmitted": bars.gauge(2, 0.5)}
    ri.gauges_to_csv(tmp_path / "bars.csv", gauges, interval=1e-7)
    table = read(tmp_path / "bars.csv")
    assert table.dtype.names == ("time", "incident", "transmitted")
    np.testing.assert_allclose(np.diff(table["time"]), 1e-7, rtol=1e-6)
    c = STEEL.wave_speed
    inside = table["incident"] < -1e-9
    assert table["incident"].min() == pytest.approx(-10 / (2 * c), rel=1e-12)
    first = table["time"][inside][0]
    assert first == pytest.approx(0.5 / c, abs=1e-7)
    passing = table["incident"][(table["time"] > 0.5 / c) & (table["time"] < 1.2 / c)]
    assert (passing < 0).sum() * 1e-7 == pytest.approx(0.4 / c, abs=2e-7)


def test_the_default_interval(tmp_path, bars):
    ri.gauges_to_csv(tmp_path / "one.csv", {"a": bars.gauge(0, 0.1)})
    assert len(read(tmp_path / "one.csv")) == 10_001


@pytest.mark.parametrize("interval", [0.0, -1.0, float("nan")])
def test_an_interval_must_be_positive(tmp_path, bars, interval):
    with pytest.raises(ri.InvalidModel, match="interval"):
        ri.gauges_to_csv(tmp_path / "x.csv", {"a": bars.gauge(0, 0.1)}, interval=interval)
    with pytest.raises(ri.InvalidModel, match="gauges"):
        ri.gauges_to_csv(tmp_path / "x.csv", {})
    assert not (tmp_path / "x.csv").exists()


def test_on_the_command_line(tmp_path, capsys):
    (tmp_path / "case.toml").write_text(CASE)
    table = tmp_path / "bars.csv"
    call = ["run", str(tmp_path / "case.toml"), "--gauges", str(table), "--gauge", "left=0:0.1"]
    assert main([*call, "--gauge", "right=1:50 cm"]) == 0
    assert read(table).dtype.names == ("time", "left", "right")
    assert main(call) == 2
    assert "exists already" in capsys.readouterr().err


@pytest.mark.parametrize(("options", "said"), [
    (["--gauge", "a=0:0.1"], "goes with --gauge"),
    (["--gauges", "x.csv"], "goes with --gauge"),
    (["--gauges", "x.csv", "--gauge", "0:0.1"], "must be NAME=BODY:X"),
    (["--gauges", "x.csv", "--gauge", "a=2:0.1"], "body 2 is no rod; the rods are 0, 1"),
    (["--gauges", "x.csv", "--gauge", "a=9:0.1"], "body 9 is no rod"),
    (["--gauges", "x.csv", "--gauge", "a=0:1"], "must lie in body 0"),
    (["--gauges", "x.csv", "--gauge", "a=0:1 kg"], "--gauge a"),
])
def test_mistakes_on_the_command_line(tmp_path, capsys, monkeypatch, options, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(CASE)
    assert main(["run", "case.toml", *options]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "x.csv").exists()
