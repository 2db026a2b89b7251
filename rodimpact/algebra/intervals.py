"""Numbers over a box, between bounds that hold whatever is rounded.

A `Range` says what a quantity can be while each of its variables can be anywhere between two
bounds: its value at the middle of this box, its values over all of the box, and its derivatives
there, each between bounds that are rounded outwards. What it can be follows from both: no more than
its values, and no farther from that at the middle than the derivatives allow (the mean value form,
R. E. Moore, Interval Analysis, 1966), so that it is too wide by the square of the box only.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bounds = tuple[float, float]
ROUNDING = 1e-12  # of a quantity: its bounds are not closer
MIDDLE, ALL, SLOPES = 0, 1, 2  # entries of the bounds of a range; then a slope for each variable


class Range:
    """A quantity over a box, or several.

    Attributes
    ----------
    low, high : [..., 2 + variable] array
        Bounds of the value at the middle, of all values, and of each derivative times half the
        width of the box along that variable.
    """

    __slots__ = ("high", "low")

    def __init__(self, low: Floats, high: Floats) -> None:
        # the mean value form: from the middle no farther than the slopes allow
        reach = _total(np.maximum(-low[..., SLOPES:], high[..., SLOPES:]), -1)[1]
        low[..., ALL] = np.maximum(low[..., ALL], _down(low[..., MIDDLE] - reach))
        high[..., ALL] = np.minimum(high[..., ALL], _up(high[..., MIDDLE] + reach))
        self.low, self.high = low, high

    def __add__(self, other: Range) -> Range:
        return Range(_down(self.low + other.low), _up(self.high + other.high))

    def __sub__(self, other: Range) -> Range:
        return Range(_down(self.low - other.high), _up(self.high - other.low))

    def __mul__(self, other: Range) -> Range:
        low, high = _product(self.low, self.high, other.low, other.high)
        ours, theirs = (
            _product(x.low[..., SLOPES:], x.high[..., SLOPES:],
                     y.low[..., ALL, None], y.high[..., ALL, None])
            for x, y in ((self, other), (other, self))
        )
        low[..., SLOPES:] = _down(ours[0] + theirs[0])
        high[..., SLOPES:] = _up(ours[1] + theirs[1])
        return Range(low, high)

    def __truediv__(self, other: Range) -> Range:
        if (other.low[..., ALL] <= 0).any() and (other.high[..., ALL] >= 0).any():
            raise ZeroDivisionError
        low, high = np.empty_like(other.low), np.empty_like(other.high)
        low[..., :SLOPES] = _down(1 / other.high[..., :SLOPES])
        high[..., :SLOPES] = _up(1 / other.low[..., :SLOPES])
        both = low[..., ALL, None], high[..., ALL, None]
        low[..., SLOPES:], high[..., SLOPES:] = _product(
            -other.high[..., SLOPES:], -other.low[..., SLOPES:], *_product(*both, *both))
        return self * Range(low, high)

    def __getitem__(self, which: Any) -> Range:
        return Range(self.low[which], self.high[which])

    def total(self) -> Range:
        """Sum of several, along their first axis."""
        return Range(_total(self.low, 0)[0], _total(self.high, 0)[1])

    @property
    def bounds(self) -> Bounds:
        """Between which all values lie."""
        return float(self.low[ALL]), float(self.high[ALL])

    @property
    def width(self) -> float:
        """Between the bounds."""
        return float(self.high[ALL] - self.low[ALL])

    def is_wider_than(self, times: float) -> bool:
        """Whether bounds are so much wider than those of a quantity that changes evenly."""
        evenly = 2 * float(np.abs(self.slopes).sum())
        return self.width > times * evenly + ROUNDING * max(map(abs, self.bounds))

    @property
    def middle(self) -> float:
        """About the value at the middle of the box."""
        return float(self.low[MIDDLE] + self.high[MIDDLE]) / 2

    @property
    def slopes(self) -> Floats:
        """About the changes from the middle to the ends of the box; [variable]."""
        return (self.low[SLOPES:] + self.high[SLOPES:]) / 2


def together(several: Sequence[Range]) -> Range:
    """Several quantities as one."""
    return Range(*(np.array([getattr(x, side) for x in several]) for side in ("low", "high")))


def constants(several: Iterable[Fraction], variables: int) -> Range:
    """Numbers over any box of so many variables."""
    ends = np.array([around(x) for x in several])
    low, high = (np.zeros((len(ends), SLOPES + variables)) for _ in range(2))
    low[:, :SLOPES], high[:, :SLOPES] = ends[:, :1], ends[:, 1:]
    return Range(low, high)


def constant(x: Fraction, variables: int) -> Range:
    """A number over any box of so many variables."""
    return constants([x], variables)[0]


def variable(i: int, variables: int, middle: Fraction, half: Fraction) -> Range:
    """The variable of this index: what it can be, from the middle of the box and half its width."""
    x = constant(middle, variables)
    x.low[ALL], x.high[ALL] = around(middle - half)[0], around(middle + half)[1]
    x.low[SLOPES + i], x.high[SLOPES + i] = around(half)
    return Range(x.low, x.high)


def around(x: Fraction) -> Bounds:
    """The floats below and above a fraction; twice itself if it is one."""
    near = float(x)
    if near == x:
        return near, near
    return math.nextafter(near, -math.inf), math.nextafter(near, math.inf)


def _down(x: Any) -> Any:
    return np.nextafter(x, -np.inf)


def _up(x: Any) -> Any:
    return np.nextafter(x, np.inf)


def _total(x: Floats, axis: int) -> tuple[Any, Any]:
    """Bounds of a sum of floats: adding n of them errs by less than n roundings of all sizes."""
    total, error = x.sum(axis=axis), 1.2e-16 * x.shape[axis] * np.abs(x).sum(axis=axis)
    return _down(total - error), _up(total + error)


def _product(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, Any]:
    """Bounds of the product of numbers from a to b with numbers from c to d."""
    every = np.array([a * c, a * d, b * c, b * d])
    return _down(every.min(axis=0)), _up(every.max(axis=0))
