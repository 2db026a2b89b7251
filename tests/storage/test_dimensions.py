"""Dimensions are matched by name, units converted, and labels never dropped in silence."""

import numpy as np
import pytest

import rodimpact as ri

xarray = pytest.importorskip("xarray")


def test_axes_go_by_name_whatever_their_order():
    values = np.arange(6.0).reshape(2, 3)
    first = xarray.DataArray(values, dims=("a", "b"))
    turned = xarray.DataArray(values.T, dims=("b", "a"))
    alone = xarray.DataArray([1.0, 2.0, 3.0, 4.0], dims="c")
    single = xarray.DataArray(7.0)
    found = ri.by_dimension(first, turned, alone, single)
    assert [x.shape for x in found] == [(2, 3, 1), (2, 3, 1), (1, 1, 4), (1, 1, 1)]
    assert np.array_equal(found[0][..., 0], values)
    assert np.array_equal(found[1], found[0])
    assert found[3].item() == 7.0


def test_units_are_converted():
    (length,) = ri.by_dimension(xarray.DataArray([400], dims="x", attrs={"units": "mm"}))
    assert length.tolist() == [0.4]


@pytest.mark.parametrize(("given", "message"), [
    ([np.ones(2)], "arrays: must be xarray DataArrays, got array"),
    ([xarray.DataArray([1.0], dims="x", attrs={"units": "furlong"})], "unknown unit 'furlong'"),
    ([xarray.DataArray(["a"], dims="x")], "must be a number, got"),
    ([xarray.DataArray([1.0, 2.0], {"x": [0, 1]}, "x"),
      xarray.DataArray([1.0, 2.0], {"x": [0, 2]}, "x")], "x"),
    ([xarray.DataArray([1.0], dims="x"), xarray.DataArray([1.0, 2.0], dims="x")], "x"),
])
def test_what_cannot_be_matched_is_refused(given, message):
    with pytest.raises(ValueError, match=message):
        ri.by_dimension(*given)
