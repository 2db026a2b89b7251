"""Dimensions are matched by name, units converted, and labels never dropped in silence."""

import numpy as np
import pytest

import rodimpact as ri


@pytest.fixture
def array():
    """DataArray; xarray takes a while to import."""
    return pytest.importorskip("xarray").DataArray


def test_axes_go_by_name_whatever_their_order(array):
    values = np.arange(6.0).reshape(2, 3)
    first = array(values, dims=("a", "b"))
    turned = array(values.T, dims=("b", "a"))
    alone = array([1.0, 2.0, 3.0, 4.0], dims="c")
    single = array(7.0)
    found = ri.by_dimension(first, turned, alone, single)
    assert [x.shape for x in found] == [(2, 3, 1), (2, 3, 1), (1, 1, 4), (1, 1, 1)]
    assert np.array_equal(found[0][..., 0], values)
    assert np.array_equal(found[1], found[0])
    assert found[3].item() == 7.0


def test_units_are_converted(array):
    (length,) = ri.by_dimension(array([400], dims="x", attrs={"units": "mm"}))
    assert length.tolist() == [0.4]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (lambda array: [np.ones(2)], "arrays: must be xarray DataArrays, got array"),
        (
            lambda array: [array([1.0], dims="x", attrs={"units": "furlong"})],
            "unknown unit 'furlong'",
        ),
        (lambda array: [array(["a"], dims="x")], "must be a number, got"),
        (
            lambda array: [array([1.0, 2.0], {"x": [0, last]}, "x") for last in (1, 2)],
            "x",
        ),
        (
            lambda array: [array(values, dims="x") for values in ([1.0], [1.0, 2.0])],
            "x",
        ),
    ],
)
def test_what_cannot_be_matched_is_refused(array, given, message):
    with pytest.raises(ValueError, match=message):
        ri.by_dimension(*given(array))
