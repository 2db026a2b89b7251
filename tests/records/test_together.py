"""Several signals in one table or Dataset, and back."""

import numpy as np
import pytest

import rodimpact as ri

RNG = np.random.default_rng(5)
T = np.cumsum(RNG.uniform(0.99e-7, 1.01e-7, 500)) - 2e-5
NAMES = ["bar 1 (mV)", "Länge/2", "入力棒", "2", "b_V", "in a.b:c-d", "x" * 60]
SIGNALS = {name: ri.Signal(RNG.normal(size=500) * 10.0**k, T, unit=unit, name=name)
           for k, (name, unit) in enumerate(zip(NAMES, ["V", "", "N", "Pa", "m/s^2", "m", ""],
                                                strict=True))}


def test_a_table_is_read_as_it_was_written(tmp_path):
    ri.write_signals(tmp_path / "a.csv", SIGNALS)
    assert ri.read_signals(tmp_path / "a.csv") == SIGNALS
    with pytest.raises(FileExistsError):
        ri.write_signals(tmp_path / "a.csv", SIGNALS)
    ri.write_signals(tmp_path / "a.csv", {"2": SIGNALS["2"]}, force=True)
    assert list(ri.read_signals(tmp_path / "a.csv")) == ["2"]


def test_a_dataset_is_read_as_it_was_made():
    pytest.importorskip("xarray")
    data = ri.signals_to_xarray(SIGNALS)
    assert (data["b_V"].attrs["units"], data["time"].attrs["units"]) == ("m/s^2", "s")
    assert ri.signals_from_xarray(data) == SIGNALS
    with pytest.raises(ValueError, match="data: must be an xarray Dataset, got 3"):
        ri.signals_from_xarray(3)


@pytest.mark.parametrize(("signals", "said"), [
    ({}, "signals: must be signals by name"), ([SIGNALS["2"]], "signals: must be signals by name"),
    ({"a": 1.0}, "signals.a: must be a Signal"),
    ({"a": SIGNALS["2"], "b": SIGNALS["2"].shifted(1.0)}, "'b' and 'a' have different times"),
    ({"a,b": SIGNALS["2"]}, "signals: a column is named by"),
    ({"Time 2": SIGNALS["2"]}, "signals: a column is named by"),
    ({"a_": SIGNALS["2"]}, "signals: a column is named by"),
    ({"a  b": SIGNALS["2"]}, "signals: a column is named by"),
    ({"a": SIGNALS["2"].replace(unit="m,s")}, "unit: a unit in a table has no brackets"),
])
def test_what_makes_no_table_is_refused(tmp_path, signals, said):
    with pytest.raises(ri.InvalidModel, match=said):
        ri.write_signals(tmp_path / "a.csv", signals)
    assert not (tmp_path / "a.csv").exists()
