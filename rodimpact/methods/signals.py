"""A signal that is constant between jumps at whole ticks, with everything in closed form.

End signals, forces and gauge records are such signals: value, one-sided limits, integral, and the
integral of a product of two need no quadrature. Times here are ticks; whoever holds the signal
knows how long a tick is.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = NDArray[np.floating[Any]]
Ints: TypeAlias = NDArray[np.int64]
Side: TypeAlias = Literal["right", "left"]


class StepSignal:
    """Piecewise constant function of time.

    Parameters
    ----------
    ticks : [n] int
        Jump times, increasing. values[i] holds from ticks[i] on; values[0] before that too.
    values : [n] float

    Examples
    --------
    >>> s = StepSignal([0, 10, 30], [1.0, 2.0, 0.0])
    >>> float(s.at(10)), float(s.at(10, side="left")), float(s.integral(5, 40))
    (2.0, 1.0, 45.0)
    """

    def __init__(self, ticks: ArrayLike, values: ArrayLike) -> None:
        self.ticks: Ints = np.asarray(ticks, dtype=np.int64)
        self.values: Floats = np.asarray(values, dtype=np.float64)

    @cached_property
    def _integral_to_jump(self) -> Floats:
        steps = self.values[:-1] * np.diff(self.ticks)
        return np.concatenate(([0.0], np.cumsum(steps)))

    def _piece(self, ticks: Any, side: Side) -> Any:
        return np.maximum(np.searchsorted(self.ticks, ticks, side) - 1, 0)

    def at(self, ticks: ArrayLike, side: Side = "right") -> Floats:
        """Value at `ticks`: the limit from the right (after a jump) or from the left (before)."""
        value: Floats = self.values[self._piece(np.asarray(ticks), side)]
        return value

    def integral(self, start: ArrayLike, stop: ArrayLike) -> Floats:
        """Integral from `start` to `stop`, value times ticks; arguments broadcast."""
        passed: Floats = self._from_first(stop) - self._from_first(start)
        return passed

    def _from_first(self, ticks: ArrayLike) -> Any:
        ticks = np.asarray(ticks)
        i = self._piece(ticks, "right")
        return self._integral_to_jump[i] + self.values[i] * (ticks - self.ticks[i])

    def integrated_twice(self, stop: ArrayLike) -> Floats:
        """Integral of (stop - t) f(t) over t from 0 to `stop`, value times ticks squared."""
        stop = np.asarray(stop)
        twice: Floats = self._twice(stop) - self._twice(0) - self._from_first(0) * stop
        return twice

    def _twice(self, ticks: Any) -> Any:
        i = self._piece(ticks, "right")
        width = (ticks - self.ticks[i]) * 1.0  # whole ticks overflow when they are squared
        passed = self._integral_to_jump[i] * width + self.values[i] * width * width / 2
        return self._twice_to_jump[i] + passed

    @cached_property
    def _twice_to_jump(self) -> Floats:
        width = np.diff(self.ticks) * 1.0
        passed = self._integral_to_jump[:-1] * width + self.values[:-1] * width * width / 2
        return np.concatenate(([0.0], np.cumsum(passed)))

    def jumps_in(self, start: int, stop: int) -> Ints:
        """Jump times strictly between `start` and `stop`."""
        low, high = np.searchsorted(self.ticks, [start, stop], "right")
        return self.ticks[low : high - (high > low and self.ticks[high - 1] == stop)]


def each_once(*ticks: ArrayLike) -> Ints:
    """All ticks in order, each once: `np.unique` hashes whole numbers, and takes 50 times as long.

    Sorting merges what is in order already.
    """
    merged: Ints = np.sort(np.concatenate(ticks), kind="stable")
    first = np.ones(len(merged), dtype=bool)
    first[1:] = merged[1:] != merged[:-1]
    return merged[first]


def integral_of_product(
    f: StepSignal, g: StepSignal, start: int, stop: int, about: int | None = None
) -> float:
    """Integral of f(t) g(t), or with `about` of f(t) g(about - t), from `start` to `stop`.

    Parameters
    ----------
    f, g : StepSignal
    start, stop : int
        Ticks.
    about : int, optional
        Sum of the two arguments when g runs backwards.

    Returns
    -------
    float
        Product of values times ticks.

    Examples
    --------
    >>> f, g = StepSignal([0, 4], [1.0, 3.0]), StepSignal([0, 6], [2.0, -1.0])
    >>> integral_of_product(f, g, 0, 10), integral_of_product(f, g, 0, 10, about=10)
    (8.0, 32.0)
    """
    if about is None:
        other = g.jumps_in(start, stop)
    else:
        other = about - g.jumps_in(about - stop, about - start)
    knots = each_once(f.jumps_in(start, stop), other)
    edges = np.concatenate(([start], knots, [stop]))
    left, right = edges[:-1], edges[1:]
    partner = g.at(left) if about is None else g.at(about - right)
    with np.errstate(under="ignore"):  # of round-off squared
        return float(np.sum(f.at(left) * partner * (right - left)))
