"""Ranges hold what they should: values and derivatives of quotients of polynomials."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rodimpact.algebra.intervals import ALL, MIDDLE, SLOPES, constant, together, variable

numbers = st.fractions(-3, 3, max_denominator=50)
spans = st.tuples(numbers, st.fractions(0, 1, max_denominator=50))
shares = st.lists(st.fractions(-1, 1, max_denominator=8), min_size=2, max_size=2)


def expression(x, y, one, forty):
    """A quotient, and its derivatives by x and y."""
    top, below = x * y * y - x + one, x * x + y * y + forty
    dx = ((y * y - one) * below - top * (x + x)) / (below * below)
    dy = ((x * y + x * y) * below - top * (y + y)) / (below * below)
    return top / below, dx, dy


@given(spans, spans, shares)
def test_values_and_derivatives_lie_within(first, second, where):
    boxes = [variable(i, 2, middle, half) for i, (middle, half) in enumerate((first, second))]
    found = expression(*boxes, constant(Fraction(1), 2), constant(Fraction(40), 2))[0]
    point = [middle + share * half for (middle, half), share in
             zip((first, second), where, strict=True)]
    value, *slopes = expression(*point, Fraction(1), 40)
    assert found.low[ALL] <= value <= found.high[ALL]
    at_middle = expression(first[0], second[0], Fraction(1), 40)[0]
    assert found.low[MIDDLE] <= at_middle <= found.high[MIDDLE]
    for i, slope in enumerate(slopes):
        change = slope * (first, second)[i][1]
        assert found.low[SLOPES + i] <= change <= found.high[SLOPES + i]


@given(st.lists(numbers, min_size=1, max_size=30))
def test_sums_of_many(several):
    total = together([constant(x, 1) for x in several]).total()
    assert total.low[ALL] <= sum(several) <= total.high[ALL]
    assert total.width <= 1e-12


def test_bounds_are_too_wide_by_the_square_of_the_box_only():
    widths = []
    for half in (Fraction(1, 100), Fraction(1, 1000)):
        x, y = (variable(i, 2, Fraction(2), half) for i in range(2))
        found = expression(x, y, constant(Fraction(1), 2), constant(Fraction(40), 2))[0]
        ends = [expression(Fraction(2) + a * half, Fraction(2) + b * half, 1, 40)[0]
                for a in (-1, 1) for b in (-1, 1)]
        widths.append(found.width - float(max(ends) - min(ends)))
    assert 0 < widths[1] < widths[0] / 50


def test_numbers_around_zero_divide_nothing():
    x = variable(0, 1, Fraction(0), Fraction(1))
    with pytest.raises(ZeroDivisionError):
        constant(Fraction(1), 1) / x


def test_what_does_not_change_is_not_wide():
    x = variable(0, 1, Fraction(1, 3), Fraction(1, 1000))
    assert not x.is_wider_than(1.01)
    assert (x - x).width < 1e-15 + 2e-3
    assert (x - x).is_wider_than(2)
    assert np.abs((x - x).slopes).max() < 1e-18


@given(*[st.floats(0.1, 10).map(Fraction)] * 2)
def test_rounding_is_outwards(a, b):
    x, y = constant(a, 0), constant(b, 0)
    for found, exact in ((x + y, a + b), (x - y, a - b), (x * y, a * b), (x / y, a / b)):
        assert found.low[MIDDLE] <= exact <= found.high[MIDDLE]
        assert found.low[ALL] <= exact <= found.high[ALL]
