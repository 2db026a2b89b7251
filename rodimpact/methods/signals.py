"""Signals: piecewise polynomial functions of time, evaluated in closed form.

Waves that leave an end, forces, gaps and velocities of masses are such signals. Their
values, one-sided limits, integrals, and integrals of products need no time step. A
signal that jumps at fronts has pieces of degree 0. Times are in ticks; the owner of a
signal knows the duration of a tick.
"""

from __future__ import annotations

from functools import cache, cached_property
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = NDArray[np.floating[Any]]
Ints: TypeAlias = NDArray[np.int64]
Side: TypeAlias = Literal["right", "left"]

LINE_RTOL = 5e-5  # error of straight lines that replace a signal, over its range
ROUND_OFF = 1e-12  # the same over the largest value, for a signal that hardly varies


class Pieces:
    """Piecewise polynomial function of time.

    Piece i lasts from ticks[i] to ticks[i + 1], the last one to `end`. It is a sum of
    Chebyshev polynomials of the piece's own variable y, which runs from -1 at its start
    to 1 at its stop. Before the first piece the signal has its first value, after the
    last piece its end value. So a constant last piece goes on for ever, whatever `end`.

    Parameters
    ----------
    ticks : [n] int
        Starts of the pieces, increasing.
    coefficients : [n] or [n, m] float
        Coefficients of the Chebyshev polynomials of degree 0 to m - 1; [n] for constant
        pieces.
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

        Values of constant pieces become a column, [n, 1]. Without an `end`, `end`
        becomes the start of the last piece, whose value holds for ever after it.
        """
        self.ticks: Ints = np.asarray(ticks, dtype=np.int64)
        columns: Floats = np.asarray(coefficients, dtype=np.float64)
        if columns.ndim == 1:
            columns = columns[:, None]
        self.coefficients = columns
        self.coefficient_count: int = columns.shape[1]  # of each piece
        if end is None:
            # The value at the end of the signal, here the last constant, holds for ever
            # after it: the last piece needs no duration.
            end = self.ticks[-1]
        self.end = int(end)

    @classmethod
    def lines(cls, ticks: ArrayLike, starts: Floats, stops: Floats, end: int) -> Pieces:
        """The signal of n straight lines.

        Line i begins at ticks[i] with the value starts[i], and ends at ticks[i + 1], or
        at `end` for the last line, with the value stops[i].
        """
        # The line is mean + half_rise y, with y from -1 to 1.
        means = (starts + stops) / 2
        half_rises = (stops - starts) / 2
        return cls(ticks, np.stack((means, half_rises), axis=1), end)

    @classmethod
    def through(cls, ticks: ArrayLike, values: Floats) -> Pieces:
        """The signal of n straight lines through n + 1 values at n + 1 ticks.

        It ends at the last tick. With a single value it is a constant.
        """
        ticks = np.asarray(ticks)
        if len(values) == 1:
            return cls(ticks, values)
        return cls.lines(ticks[:-1], values[:-1], values[1:], ticks[-1])

    @cached_property
    def values(self) -> Floats:
        """Value at the start of each piece, [n]."""
        signs = (-1.0) ** np.arange(self.coefficient_count)  # T_k(-1) = (-1)^k
        return np.asarray(self.coefficients @ signs)

    @cached_property
    def breaks(self) -> Ints:
        """Starts of the pieces and the end, ticks; constant pieces have no end."""
        if self.coefficient_count == 1:  # pieces are constant
            return self.ticks
        return each_once(self.ticks, [self.end])

    @cached_property
    def widths(self) -> Ints:
        """Duration of each piece, ticks, [n]; 1 for a last piece without a duration."""
        return np.maximum(np.diff(self.ticks, append=self.end), 1)

    @cached_property
    def _primitive(self) -> tuple[Floats, Floats]:
        """Integrals of all pieces, value times ticks, as `integral` needs them.

        Returns
        -------
        [n, m + 1] array
            Chebyshev coefficients of the integral of each piece from its start, as a
            function of the piece's own variable y.
        [n] array
            Integral from the first start to the start of each piece.
        """
        from numpy.polynomial.chebyshev import chebint

        # dt = (width/2) dy. `widths` is not used here, as it is at least 1.
        half_widths = np.diff(self.ticks, append=self.end)[:, None] / 2
        integral = chebint(self.coefficients, lbnd=-1, axis=1)
        of_pieces = np.asarray(integral * half_widths)
        whole_pieces = of_pieces[:-1].sum(axis=1)  # values at the stop, as T_k(1) = 1
        return of_pieces, np.concatenate(([0.0], np.cumsum(whole_pieces)))

    @cached_property
    def bends(self) -> Floats:
        """Bound of the second derivative of each piece with respect to y, [n].

        For the Chebyshev polynomial T_k it is k^2 (k^2 - 1)/3.
        """
        k = np.arange(self.coefficient_count)
        return np.asarray(np.abs(self.coefficients) @ (k**2 * (k**2 - 1) / 3))

    @cached_property
    def marks(self) -> Ints:
        """Ticks, increasing, at which straight lines that approximate the signal meet.

        The error of the lines is about `LINE_RTOL` of the range of the signal. The
        ticks are the starts of the pieces, ticks inside curved pieces, the end, and a
        tick just before each jump. For constant pieces they are the starts only.
        """
        if self.coefficient_count == 1:  # pieces are constant
            return self.ticks
        middle = self.coefficients[:, 0]
        # Bound of abs(value - middle) in each piece, as abs(T_k) <= 1
        swing = np.abs(self.coefficients[:, 1:]).sum(axis=1)
        low = float((middle - swing).min())
        high = float((middle + swing).max())
        # Allowed error of the lines
        tolerance = max(LINE_RTOL * (high - low), ROUND_OFF * max(high, -low))
        parts_needed = np.ones(len(middle))  # parts of each piece, [n]
        if tolerance > 0:
            # y has the range 2, so that a part of n has the width 2/n, and a line over
            # it an error of at most (2/n)^2/8 bends = bends/(2 n^2).
            parts_needed = np.ceil(np.sqrt(self.bends / (2 * tolerance)))
        # Each part begins with a mark, and lasts at least a tick.
        parts = np.clip(parts_needed, 1, self.widths).astype(np.int64)
        # Number of marks in all earlier pieces, [n]
        marks_before = np.cumsum(parts) - parts
        # Index of each mark in its piece, from 0 on, [mark]
        index_in_piece = np.arange(parts.sum()) - np.repeat(marks_before, parts)
        # Ticks of the part after each mark, [mark], rounded down: the last part of a
        # piece takes the rest.
        part_widths = np.repeat(self.widths // parts, parts)
        part_starts = np.repeat(self.ticks, parts) + part_widths * index_in_piece
        later_starts = self.ticks[1:]
        rises = self.values[1:] - self.at(later_starts, side="left")
        jumps = later_starts[np.abs(rises) > tolerance]
        # One tick earlier; more beyond 2^51, where floats cannot resolve a tick
        before_jumps = jumps - 1 - (jumps >> 51)
        return each_once(part_starts, before_jumps, [self.end])

    def piece(self, ticks: ArrayLike, side: Side = "right") -> Ints:
        """Index of the piece in which each of `ticks` lies, an array of their shape.

        Ticks before the first piece count as in the first piece, ticks after the last
        piece as in the last one. The start of a piece counts as in this piece ("right")
        or as in the previous piece ("left").
        """
        return np.maximum(self.ticks.searchsorted(ticks, side) - 1, 0)

    def _own_time(self, i: Ints, ticks: Ints) -> Floats:
        """Variable y of pieces i at these ticks; -1 before a piece, 1 after it."""
        # The time since the start, 0 to the width of the piece, is scaled to -1 to 1.
        return np.clip((ticks - self.ticks[i]) / self.widths[i] * 2 - 1, -1.0, 1.0)

    def at(self, ticks: ArrayLike, side: Side = "right") -> Floats:
        """Value at `ticks`, an array of their shape.

        At a jump it is the value after it, the limit from the right, or with the side
        "left" the value before it. Before the first piece it is the first value, after
        the last piece the end value.
        """
        ticks = np.asarray(ticks)
        i = self.piece(ticks, side)
        if self.coefficient_count == 1:  # pieces are constant
            return self.values[i]
        return _polynomials(self.coefficients, i, self._own_time(i, ticks))

    def at_own_time(self, pieces: Ints, y: Floats) -> Floats:
        """Values of the pieces with the indices `pieces` at their own variable y.

        Both arguments broadcast to the shape of the result.
        """
        return _polynomials(self.coefficients, pieces, y)

    def inside(self, starts: ArrayLike, stops: ArrayLike, shares: Floats) -> Floats:
        """Values inside intervals of time, at the given shares of each interval.

        Parameters
        ----------
        starts, stops : [n] int
            Ticks at which the intervals begin and end. Each interval must lie in one
            piece, or before or after all pieces.
        shares : [share] float
            Positions in an interval, from 0, its start, to 1, its stop.

        Returns
        -------
        [n, share] array
            [n, 1] if pieces are constant.
        """
        starts = np.asarray(starts)
        lengths = np.asarray(stops) - starts
        i = self.piece(starts + lengths // 2)  # index of the piece around the middle
        if self.coefficient_count == 1:  # pieces are constant
            return self.coefficients[i]
        # Ticks from the start of the piece to each position, [interval, share]
        since_start = (starts - self.ticks[i])[:, None] + lengths[:, None] * shares
        y = np.clip(since_start / self.widths[i][:, None] * 2 - 1, -1.0, 1.0)
        return _polynomials(self.coefficients, i[:, None], y)

    def means(self, starts: ArrayLike, stops: ArrayLike) -> Floats:
        """Means over intervals from `starts` to `stops`, ticks, all arrays [n].

        Each interval must lie in one piece.
        """
        # Exact: degree coefficient_count - 1 <= 2 points - 1
        shares, weights = quadrature((self.coefficient_count + 1) // 2)
        return np.asarray(self.inside(starts, stops, shares) @ weights)

    def integral(self, start: ArrayLike, stop: ArrayLike) -> Floats:
        """Integral from `start` to `stop`, ticks, in value times ticks.

        The arguments broadcast. With `stop` before `start`, the sign is reversed.
        """
        return self._from_first(stop) - self._from_first(start)

    def _from_first(self, ticks: ArrayLike) -> Floats:
        """Integral from the start of the first piece to `ticks`, value times ticks.

        It is an array of the shape of `ticks`. Before the first piece and after the
        last piece the signal is constant. For ticks before the first piece the
        integral has the sign opposite to the signal.
        """
        ticks = np.asarray(ticks)
        i = self.piece(ticks)
        coefficients, up_to_piece = self._primitive
        if self.coefficient_count == 1:  # pieces are constant
            return up_to_piece[i] + self.values[i] * (ticks - self.ticks[i])
        # `_own_time` is limited to the piece, so that this is the part in the pieces.
        in_piece = _polynomials(coefficients, i, self._own_time(i, ticks))
        # Ticks after the end (> 0) or before the start (< 0), where it is constant
        outside = ticks - np.clip(ticks, self.ticks[0], self.end)
        if np.any(outside):
            in_piece = in_piece + outside * self.at(ticks)
        return up_to_piece[i] + in_piece

    def integrated_twice(self, stop: Any) -> Floats:
        """Twofold integral of the signal f from 0 to `stop`, value times ticks squared.

        It is integral((stop - t) f(t) dt) from 0 to `stop`. `stop`, ticks, is a number
        or an array; the result has its shape.
        """
        # integral((stop - t) f) = stop integral(f) - integral(t f)
        last = np.max(stop)
        time = Pieces.through([0, last], np.array([0.0, last]))  # the signal t
        twice: Floats = stop * self.integral(0, stop) - (self * time).integral(0, stop)
        return twice

    def breaks_in(self, start: int, stop: int) -> Ints:
        """The entries of `breaks` that are after `start` and before `stop`."""
        first = self.breaks.searchsorted(start, "right")
        after_last = self.breaks.searchsorted(stop, "left")
        return self.breaks[first:after_last]

    def within(self, start: int, stop: int) -> Pieces:
        """The signal with only the pieces that overlap the time from `start` to `stop`.

        These pieces are not cut: the new signal may begin before `start` and end after
        `stop`. Outside of its pieces it is constant. At least one piece is kept. The
        arguments are ticks.
        """
        first = int(self.piece(start))
        after_last = int(self.ticks.searchsorted(stop, "right"))
        after_last = max(after_last, first + 1)  # if `stop` is before all pieces
        end = self.end
        if after_last < len(self.ticks):  # pieces at the end are dropped
            end = int(self.ticks[after_last])
        ticks = self.ticks[first:after_last]
        return Pieces(ticks, self.coefficients[first:after_last], end)

    def plus(self, constant: float) -> Pieces:
        """The signal plus a constant."""
        coefficients = self.coefficients.copy()
        coefficients[:, 0] += constant  # T_0 = 1
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
        # The degrees add up; the number of coefficients is the degree plus 1.
        return self._combined(
            other, np.multiply, self.coefficient_count + other.coefficient_count - 1
        )

    def _combined(self, other: Pieces, operation: Any, size: int) -> Pieces:
        """The signal operation(self, other), whose pieces have `size` coefficients.

        `operation` takes two arrays of values. It is applied at `size` points of each
        interval between the breaks of both signals. The result is exact if its degree
        is below `size`. The last interval has length 0, and holds the constant value
        after both signals.
        """
        starts = each_once(self.breaks, other.breaks)
        stops = np.append(starts[1:], starts[-1])  # the last interval is empty
        shares, to_coefficients = _interpolation(size)
        # Values of both signals, [interval, point]
        left = self.inside(starts, stops, shares)
        right = other.inside(starts, stops, shares)
        return Pieces(starts, operation(left, right) @ to_coefficients)

    def times(self, factor: float) -> Pieces:
        """The signal times a factor."""
        return Pieces(self.ticks, self.coefficients * factor, self.end)

    def delayed(self, ticks: int) -> Pieces:
        """The signal delayed by this number of ticks."""
        return Pieces(self.ticks + ticks, self.coefficients, self.end + ticks)

    def time_reversed(self, about: int) -> Pieces:
        """The signal reversed in time.

        Its value at tick t is the value of this signal at `about` - t.
        """
        # A piece starts where it stopped, at ticks + widths; the order is reversed.
        starts = (about - self.ticks - self.widths)[::-1]
        # T_m(-y) = (-1)^m T_m(y)
        mirrored = self.coefficients * (-1.0) ** np.arange(self.coefficient_count)
        return Pieces(starts, mirrored[::-1], int(about - self.ticks[0]))

    def cut(self, ticks: Ints, end: int) -> Pieces:
        """The same signal from ticks[0] to `end`, in pieces that begin at `ticks`.

        Before ticks[0] and after `end` the new signal is constant.

        Parameters
        ----------
        ticks : [n] int
            Starts of the new pieces, increasing. All breaks of the signal between
            ticks[0] and `end` must be among them.
        end : int
            Tick at which the last piece stops.
        """
        shares, to_coefficients = _interpolation(self.coefficient_count)
        stops = np.append(ticks[1:], end)
        values = self.inside(ticks, stops, shares)
        return Pieces(ticks, values @ to_coefficients, end)


def _polynomials(coefficients: Floats, i: Ints, y: Floats) -> Floats:
    """Values at y of the Chebyshev series in the rows i of `coefficients`.

    i and y broadcast, and the values have their common shape. Clenshaw's recurrence is
    b_k = c_k + 2 y b_(k+1) - b_(k+2), and the values are c_0 + y b_1 - b_2.
    """
    b2 = np.zeros(())  # b_(k+2)
    b1 = np.zeros(())  # b_(k+1)
    for column in coefficients.T[:0:-1]:  # c_k of all rows, from the last k down to 1
        b0 = column[i] + 2 * y * b1 - b2  # b_k
        b2 = b1
        b1 = b0
    value: Floats = coefficients[i, 0] + y * b1 - b2
    return value


@cache
def _interpolation(size: int) -> tuple[Floats, Floats]:
    """Interpolation points and matrix of a Chebyshev series with `size` coefficients.

    The points are Chebyshev points, at which interpolation does not amplify rounding
    errors of the values.

    Returns
    -------
    [size] array
        Points, as shares of the width of a piece, increasing from 0 to 1.
    [size, size] array
        M, with coefficients = values @ M for the values at these points.
    """
    # The points are y = cos(angle), where T_k(y) = cos(k angle), so that M is a
    # discrete cosine transform: c_k = (2/size) sum(value cos(k angle)), half of it for
    # k = 0. Decreasing angles make y increase.
    angles = np.pi * (np.arange(size)[::-1] + 0.5) / size
    to_coefficients = np.cos(angles[:, None] * np.arange(size)) * (2 / size)
    to_coefficients[:, 0] /= 2
    return (1 + np.cos(angles)) / 2, to_coefficients


def each_once(*ticks: ArrayLike) -> Ints:
    """All ticks of these arrays, at least one array, in increasing order, each once.

    `np.unique` hashes whole numbers, and takes 50 times as long. A stable sort is fast
    here, as it merges arrays that are sorted already.
    """
    merged: Ints = np.sort(np.concatenate(ticks), kind="stable")
    is_first = np.ones(len(merged), dtype=bool)  # whether no equal tick is before it
    is_first[1:] = merged[1:] != merged[:-1]
    return merged[is_first]


@cache
def quadrature(points: int) -> tuple[Floats, Floats]:
    """Gauss-Legendre quadrature: points from 0 to 1, and weights of a mean.

    Both are [points] arrays; the weights add up to 1. The mean of a polynomial is exact
    up to degree 2 `points` - 1.
    """
    from numpy.polynomial.legendre import leggauss

    abscissae, weights = leggauss(points)  # from -1 to 1, weights that add up to 2
    return (1 + abscissae) / 2, weights / 2
