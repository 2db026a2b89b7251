"""A signal made of pieces that are polynomials of time, with everything in closed form.

Waves that leave an end, forces, gaps and velocities of masses are such signals: value,
one-sided limits, integral, and the integral of a product of two need no time step.
Pieces of degree 0 make what jumps at fronts. Times here are ticks; whoever holds the
signal knows how long a tick is.
"""

from __future__ import annotations

from functools import cache, cached_property
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = NDArray[np.floating[Any]]
Ints: TypeAlias = NDArray[np.int64]
Side: TypeAlias = Literal["right", "left"]

LINE_RTOL = 5e-5  # error of straight lines that stand for a signal, over its range
ROUND_OFF = 1e-12  # error of values over the largest one, where a signal hardly varies


class Pieces:
    """Piecewise polynomial function of time.

    Piece i lasts from ticks[i] to ticks[i + 1], the last one to `end`. It is a sum of
    Chebyshev polynomials of the piece's own variable y, which runs from -1 at its start
    to 1 at its stop. Before the first piece its start value holds, after the last piece
    its end value.

    Parameters
    ----------
    ticks : [n] int
        Starts of the pieces, increasing.
    coefficients : [n] or [n, m] float
        Of the Chebyshev polynomials of degree 0 to m - 1; [n] for constant pieces.
    end : int, optional
        Stop of the last piece; by default its start. Constant pieces do not need it.

    Examples
    --------
    >>> s = Pieces([0, 10, 30], [1.0, 2.0, 0.0])
    >>> float(s.at(10)), float(s.at(10, side="left")), float(s.integral(5, 40))
    (2.0, 1.0, 45.0)
    >>> ramp = Pieces([0], [[5.0, 5.0]], 10)                # from 0 to 10 in ten ticks
    >>> ramp.at([0, 4, 12]).tolist(), float(ramp.integral(0, 20))
    ([0.0, 4.0, 10.0], 150.0)
    >>> force, speed = Pieces([0, 4], [1.0, 3.0]), Pieces([0, 6], [2.0, -1.0])
    >>> (force - speed).values.tolist(), (force * speed).integral(0, [4, 10]).tolist()
    ([-1.0, 1.0, 4.0], [8.0, 8.0])
    """

    def __init__(
        self, ticks: ArrayLike, coefficients: ArrayLike, end: int | None = None
    ) -> None:
        """Keep the arguments as arrays, and set `coefficient_count`.

        Values of constant pieces become a column, [n, 1].
        """
        self.ticks: Ints = np.asarray(ticks, dtype=np.int64)
        columns: Floats = np.asarray(coefficients, dtype=np.float64)
        if columns.ndim == 1:
            columns = columns[:, None]
        self.coefficients = columns
        self.coefficient_count: int = columns.shape[1]  # of each piece
        if end is None:  # constants need none: the last one goes on for ever
            end = self.ticks[-1]
        self.end = int(end)

    @classmethod
    def lines(cls, ticks: ArrayLike, starts: Floats, stops: Floats, end: int) -> Pieces:
        """Straight lines from `starts` to `stops`, both [n].

        Other arguments are as above.
        """
        means = (starts + stops) / 2
        half_rises = (stops - starts) / 2
        return cls(ticks, np.stack((means, half_rises), axis=1), end)

    @classmethod
    def through(cls, ticks: ArrayLike, values: Floats) -> Pieces:
        """The signal of n straight lines through n + 1 values at n + 1 ticks.

        It ends at the last tick. Through one value it is a constant.
        """
        ticks = np.asarray(ticks)
        if len(values) == 1:
            return cls(ticks, values)
        return cls.lines(ticks[:-1], values[:-1], values[1:], ticks[-1])

    @cached_property
    def values(self) -> Floats:
        """Value at the start of each piece, [n]."""
        signs = (-1.0) ** np.arange(self.coefficient_count)  # of T_k at y = -1
        return np.asarray(self.coefficients @ signs)

    @cached_property
    def breaks(self) -> Ints:
        """Ticks at which the polynomial changes.

        The end is included; constants have no end.
        """
        if self.coefficient_count == 1:  # pieces are constant
            return self.ticks
        return each_once(self.ticks, [self.end])

    @cached_property
    def widths(self) -> Ints:
        """Ticks that each piece lasts, 1 at least, [n]."""
        return np.maximum(np.diff(self.ticks, append=self.end), 1)

    @cached_property
    def _primitive(self) -> tuple[Floats, Floats]:
        """Integrals of all pieces, value times ticks, from which `integral` follows.

        Returns
        -------
        [n, m + 1] array
            Chebyshev coefficients of the integral of each piece from its start, as a
            function of the piece's own variable y.
        [n] array
            Integral from the first start to the start of each piece.
        """
        from numpy.polynomial.chebyshev import chebint

        # The integral over y times half of the width is that over ticks.
        half_widths = np.diff(self.ticks, append=self.end)[:, None] / 2
        integral = chebint(self.coefficients, lbnd=-1, axis=1)
        of_pieces = np.asarray(integral * half_widths)
        whole_pieces = of_pieces[:-1].sum(axis=1)  # all polynomials are 1 at y = 1
        return of_pieces, np.concatenate(([0.0], np.cumsum(whole_pieces)))

    @cached_property
    def bends(self) -> Floats:
        """Bound of the second derivative of each piece by its own variable, [n].

        That of the Chebyshev polynomial T_k is k^2 (k^2 - 1)/3 at most.
        """
        k = np.arange(self.coefficient_count)
        return np.asarray(np.abs(self.coefficients) @ (k**2 * (k**2 - 1) / 3))

    @cached_property
    def marks(self) -> Ints:
        """Ticks, increasing, between which straight lines follow the signal.

        They do so to `LINE_RTOL` of its range. They are the starts of the pieces, ticks
        inside of pieces that bend, the end, and a tick just before each jump. A signal
        of constant pieces has their starts alone.
        """
        if self.coefficient_count == 1:  # pieces are constant
            return self.ticks
        middle = self.coefficients[:, 0]
        swing = np.abs(self.coefficients[:, 1:]).sum(axis=1)  # bound of value - middle
        low = float((middle - swing).min())
        high = float((middle + swing).max())
        # Error that the lines may have
        tolerance = max(LINE_RTOL * (high - low), ROUND_OFF * max(high, -low))
        parts_needed = np.ones(len(middle))  # parts of each piece, [n]
        if tolerance > 0:
            # A line over the n-th part of a piece is
            # off by less than (2/n)^2/8 of its bend.
            parts_needed = np.ceil(np.sqrt(self.bends / (2 * tolerance)))
        # Each part begins with a mark, and has a tick at least.
        parts = np.clip(parts_needed, 1, self.widths).astype(np.int64)
        # How many marks the pieces before have, [n]
        marks_before = np.cumsum(parts) - parts
        # Number of each mark in its piece, counted from 0, [mark]
        index_in_piece = np.arange(parts.sum()) - np.repeat(marks_before, parts)
        # Ticks of the part behind each mark, [mark]. They are rounded down: the last
        # part of a piece is longer.
        part_widths = np.repeat(self.widths // parts, parts)
        inside = np.repeat(self.ticks, parts) + part_widths * index_in_piece
        later_starts = self.ticks[1:]
        rises = self.values[1:] - self.at(later_starts, "left")
        jumps = later_starts[np.abs(rises) > tolerance]
        # A tick earlier, and more beyond 2^51, where floats do not tell ticks apart
        before_jumps = jumps - 1 - (jumps >> 51)
        return each_once(inside, before_jumps, [self.end])

    def piece(self, ticks: ArrayLike, side: Side = "right") -> Ints:
        """Index of the piece in which each of these ticks lies.

        It is 0 before the first piece. A tick between two pieces lies in the later one
        ("right") or in the earlier one ("left").
        """
        return np.maximum(self.ticks.searchsorted(ticks, side) - 1, 0)

    def _own_time(self, i: Ints, ticks: Ints) -> Floats:
        """Variable y of pieces i at these ticks; -1 before a piece, 1 after it."""
        return np.clip((ticks - self.ticks[i]) / self.widths[i] * 2 - 1, -1.0, 1.0)

    def at(self, ticks: ArrayLike, side: Side = "right") -> Floats:
        """Value at `ticks`, an array of their shape.

        It is the limit from the right (after a jump) or from the left (before). Before
        the first piece its start value holds, after the last one its end value.
        """
        ticks = np.asarray(ticks)
        i = self.piece(ticks, side)
        if self.coefficient_count == 1:  # pieces are constant
            return self.values[i]
        return _polynomials(self.coefficients, i, self._own_time(i, ticks))

    def at_own_time(self, pieces: Ints, y: Floats) -> Floats:
        """Values of the pieces of these indices at their own variable y.

        Both broadcast.
        """
        return _polynomials(self.coefficients, pieces, y)

    def inside(self, starts: ArrayLike, stops: ArrayLike, shares: Floats) -> Floats:
        """Values in intervals of time, at these shares of the width of each.

        Parameters
        ----------
        starts, stops : [n] int
            Ticks at which intervals begin and end; each is inside of one piece.
        shares : [share] float
            From 0, the start of an interval, to 1, its stop.

        Returns
        -------
        [n, share] array
            [n, 1] if pieces are constant.
        """
        starts = np.asarray(starts)
        lengths = np.asarray(stops) - starts
        i = self.piece(starts + lengths // 2)  # the piece in which the middle lies
        if self.coefficient_count == 1:
            return self.coefficients[i]
        # Ticks from the start of the piece to each share, [interval, share]
        since_start = (starts - self.ticks[i])[:, None] + lengths[:, None] * shares
        y = np.clip(since_start / self.widths[i][:, None] * 2 - 1, -1.0, 1.0)
        return _polynomials(self.coefficients, i[:, None], y)

    def means(self, starts: ArrayLike, stops: ArrayLike) -> Floats:
        """Means over intervals from `starts` to `stops`, [n] each.

        Each lies in one piece.
        """
        shares, weights = quadrature((self.coefficient_count + 1) // 2)
        return np.asarray(self.inside(starts, stops, shares) @ weights)

    def integral(self, start: ArrayLike, stop: ArrayLike) -> Floats:
        """Integral from `start` to `stop`, value times ticks; arguments broadcast."""
        return self._from_first(stop) - self._from_first(start)

    def _from_first(self, ticks: ArrayLike) -> Floats:
        """Integral from the start of the first piece to these ticks, value times ticks.

        It is an array of the shape of `ticks`. Before the first piece and after the
        last one the signal is constant; before the first one the integral of a positive
        signal is negative.
        """
        ticks = np.asarray(ticks)
        i = self.piece(ticks)
        coefficients, up_to_piece = self._primitive
        if self.coefficient_count == 1:  # pieces are constant
            return up_to_piece[i] + self.values[i] * (ticks - self.ticks[i])
        # `_own_time` stops at both ends of a piece: this ends where the pieces do.
        in_piece = _polynomials(coefficients, i, self._own_time(i, ticks))
        # Ticks after the end, or before the start (below 0), where it stays constant
        outside = ticks - np.clip(ticks, self.ticks[0], self.end)
        if np.any(outside):
            in_piece = in_piece + outside * self.at(ticks)
        return up_to_piece[i] + in_piece

    def integrated_twice(self, stop: Any) -> Floats:
        """Integral of the integral of the signal f from 0 on, at `stop`.

        It is that of (stop - t) f(t) over t from 0 to `stop`, value times ticks
        squared; `stop`, ticks, is a number or an array, whose shape the result has.
        """
        # stop integral(f) - integral(t f)
        last = np.max(stop)
        time = Pieces.through([0, last], np.array([0.0, last]))  # the signal t
        twice: Floats = stop * self.integral(0, stop) - (self * time).integral(0, stop)
        return twice

    def breaks_in(self, start: int, stop: int) -> Ints:
        """Those of `breaks` that are after `start` and before `stop`."""
        first = self.breaks.searchsorted(start, "right")
        after_last = self.breaks.searchsorted(stop, "left")
        return self.breaks[first:after_last]

    def within(self, start: int, stop: int) -> Pieces:
        """The signal of those pieces that hold somewhere from `start` to `stop`, ticks.

        They are uncut: it may begin before `start` and end after `stop`, and is
        constant outside. One piece is left at least.
        """
        first = int(self.piece(start))
        after_last = int(self.ticks.searchsorted(stop, "right"))
        after_last = max(after_last, first + 1)  # where `stop` is before all pieces
        end = self.end
        if after_last < len(self.ticks):  # it ends with the last piece that is kept
            end = int(self.ticks[after_last])
        ticks = self.ticks[first:after_last]
        return Pieces(ticks, self.coefficients[first:after_last], end)

    def plus(self, constant: float) -> Pieces:
        """The signal plus a constant."""
        coefficients = self.coefficients.copy()
        coefficients[:, 0] += constant
        return Pieces(self.ticks, coefficients, self.end)

    def __add__(self, other: Pieces) -> Pieces:
        return self._combined(
            other, np.add, max(self.coefficient_count, other.coefficient_count)
        )

    def __sub__(self, other: Pieces) -> Pieces:
        return self._combined(
            other, np.subtract, max(self.coefficient_count, other.coefficient_count)
        )

    def __mul__(self, other: Pieces) -> Pieces:
        return self._combined(
            other, np.multiply, self.coefficient_count + other.coefficient_count - 1
        )

    def _combined(self, other: Pieces, operation: Any, size: int) -> Pieces:
        """The signal operation(self, other), whose pieces have `size` coefficients.

        It is computed at `size` points of each interval between breaks of either
        signal, exactly if its degree is below `size`. The last interval has no length,
        and holds the constant value after both signals. `operation` takes two arrays.
        """
        starts = each_once(self.breaks, other.breaks)
        stops = np.append(starts[1:], starts[-1])  # the last interval is empty
        shares, to_coefficients = _interpolation(size)
        # Values of both, [interval, point]
        left = self.inside(starts, stops, shares)
        right = other.inside(starts, stops, shares)
        return Pieces(starts, operation(left, right) @ to_coefficients)

    def times(self, factor: float) -> Pieces:
        """The signal times a factor."""
        return Pieces(self.ticks, self.coefficients * factor, self.end)

    def later(self, ticks: int) -> Pieces:
        """The signal delayed by so many ticks."""
        return Pieces(self.ticks + ticks, self.coefficients, self.end + ticks)

    def time_reversed(self, about: int) -> Pieces:
        """The signal backwards.

        Its value at tick t is that of this one at `about` - t.
        """
        starts = (about - self.ticks - self.widths)[::-1]
        # T_m(-y) = (-1)^m T_m(y)
        mirrored = self.coefficients * (-1.0) ** np.arange(self.coefficient_count)
        return Pieces(starts, mirrored[::-1], int(about - self.ticks[0]))

    def cut(self, ticks: Ints, end: int) -> Pieces:
        """The same signal from ticks[0] to `end`, in pieces that begin at `ticks`.

        Before and behind it is constant.

        Parameters
        ----------
        ticks : [n] int
            All breaks of the signal from ticks[0] to `end` must be among them.
        end : int
            Tick at which the last piece stops.
        """
        shares, to_coefficients = _interpolation(self.coefficient_count)
        stops = np.append(ticks[1:], end)
        values = self.inside(ticks, stops, shares)
        return Pieces(ticks, values @ to_coefficients, end)


def _polynomials(coefficients: Floats, i: Ints, y: Floats) -> Floats:
    """Values at y of the Chebyshev series in the rows i of `coefficients`.

    i and y broadcast, and the values have their common shape. By Clenshaw's recurrence
    b_k = c_k + 2 y b_(k+1) - b_(k+2) the values are c_0 + y b_1 - b_2.
    """
    before = np.zeros(())  # b_(k + 2)
    last = np.zeros(())  # b_(k + 1)
    for column in coefficients.T[:0:-1]:  # c_k of all rows, from the last k to 1
        following = column[i] + 2 * y * last - before
        before = last
        last = following
    value: Floats = coefficients[i, 0] + y * last - before
    return value


@cache
def _interpolation(size: int) -> tuple[Floats, Floats]:
    """Points from which a series of `size` coefficients follows, and how.

    They are Chebyshev points, at which rounding errors of values are not enlarged.

    Returns
    -------
    [size] array
        Points, as shares of the width of a piece, from 0 to 1.
    [size, size] array
        M, with coefficients = values @ M.
    """
    # Point j is y = cos(angle j), where T_k is
    # cos(k angle): a discrete cosine transform.
    angles = np.pi * (np.arange(size)[::-1] + 0.5) / size
    to_coefficients = np.cos(angles[:, None] * np.arange(size)) * (2 / size)
    to_coefficients[:, 0] /= 2
    return (1 + np.cos(angles)) / 2, to_coefficients


def each_once(*ticks: ArrayLike) -> Ints:
    """All ticks of these arrays, one array or more, in order, each once.

    `np.unique` hashes whole numbers, and takes 50 times as long. Sorting merges what is
    in order already.
    """
    merged: Ints = np.sort(np.concatenate(ticks), kind="stable")
    is_first = np.ones(len(merged), dtype=bool)  # whether no equal tick is before it
    is_first[1:] = merged[1:] != merged[:-1]
    return merged[is_first]


@cache
def quadrature(points: int) -> tuple[Floats, Floats]:
    """Gauss-Legendre quadrature: points from 0 to 1, and weights of a mean.

    It is exact up to degree 2 `points` - 1.
    """
    from numpy.polynomial.legendre import leggauss

    places, weights = leggauss(points)
    return (1 + places) / 2, weights / 2
