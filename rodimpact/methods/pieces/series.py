"""Polynomials on a piece of time, as Chebyshev series in y.

y goes from -1 at the start of the piece to 1 at its end. A piece is known by its values
at its start and at the N points of Radau IIA, the last of which is the end: collocation
there damps what is stiffer than the piece is long (Hairer and Wanner, Solving Ordinary
Differential Equations II, section IV.5).

f are values at the points, c coefficients of a series: sum of c[m] T_m(y), T_m(cos
x) = cos(m x).
"""

import math
from collections.abc import MutableSequence, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.polynomial import chebyshev, legendre

N = 8
"""Degree of a piece, and number of stages of the collocation."""
POINTS = N + 1
"""Points of a piece: its start and the stages."""
SAMPLES = 32
"""Intervals of a piece in which its smallest value is looked for."""
POSITIVE_RTOL = 0.1
"""Smallest over largest value at the points, above which no zero is between them."""
NEXT_INTEGRAL = 0.01
"""Integral of the Chebyshev polynomial of the next degree, about."""
MAX_DECAY = 0.75
"""Largest ratio of coefficients two degrees apart that falls: more is unresolved."""
EXTREMUM_STEPS = 36
"""Steps to an extremum.

Each leaves two thirds of the width: 5e-7 of it at the end.
"""
BISECTIONS = 54
"""Steps to a zero.

Each leaves half of the width: that is below round-off at the end.
"""
EXTREMUM_RTOL = 4 * (2 / 3) ** (2 * EXTREMUM_STEPS)
"""Possible miss of an extremum there, over the rise to it from the lower neighbour.

A parabola whose vertex is in a width w rises to it by r = abs(f'') w^2/8 at least from
the lower end; at a distance of u w from the vertex it is lower by
abs(f'') (u w)^2/2 = 4 u^2 r.
"""

Values: TypeAlias = Sequence[float]
"""Values at the points of a piece, or coefficients of a series."""
MutableValues: TypeAlias = MutableSequence[float]
"""The same, where a function sets them."""
Matrix: TypeAlias = Sequence[MutableSequence[float]]

_LAST = legendre.Legendre.basis(N - 1) - legendre.Legendre.basis(N)
_RADAU = np.append(np.sort(_LAST.roots().real)[:-1], 1.0)
_START_AND_STAGES = np.concatenate(([-1.0], _RADAU))
_STAGES_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_RADAU, N - 1))
_VALUES_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_START_AND_STAGES, N))
_SERIES_AT_START = chebyshev.chebvander([-1.0], N - 1)
_INTEGRALS = [
    chebyshev.Chebyshev(column).integ(lbnd=-1) for column in _STAGES_TO_SERIES.T
]
"""Integrals from -1 on of polynomials that are 1 at one stage, 0 at the others."""

X: list[float] = _START_AND_STAGES.tolist()
"""Places of the points."""
SERIES: list[list[float]] = _VALUES_TO_SERIES.tolist()
"""Matrix from values at the points to coefficients of the Chebyshev series."""
STAGES: list[list[float]] = [[float(each(y)) for each in _INTEGRALS] for y in _RADAU]
"""Matrix from values at the stages to integrals from -1 to each of these."""
TWICE: list[list[float]] = (np.array(STAGES) @ np.array(STAGES)).tolist()
"""Matrix from values at the stages to the integrals of these integrals."""
START: list[float] = (_SERIES_AT_START @ _STAGES_TO_SERIES)[0].tolist()
"""Weights of the stages in the value at the start, extrapolated."""
WEIGHTS: list[float] = STAGES[N - 1][:]
"""Weights of the stages in the integral over the piece; exact up to degree 2N - 2."""


class Maximum(NamedTuple):
    """The largest value of a polynomial on a piece."""

    value: float
    place: float  # y, from -1 at the start of the piece to 1 at its end
    miss: float  # largest amount by which the search may have missed the value


def value(c: Values, y: float) -> float:
    """Return the value of the series c at y.

    By Clenshaw's recurrence b_m = 2 y b_(m+1) - b_(m+2) + c_m it is y b_1 - b_2 + c_0.
    """
    b1 = 0.0  # b_(m+1)
    b2 = 0.0  # b_(m+2)
    y2 = 2 * y
    for m in range(N, 0, -1):
        b0 = y2 * b1 - b2 + c[m]
        b2 = b1
        b1 = b0
    return y * b1 - b2 + c[0]


def slope_at_end(c: Values, end: float) -> float:
    """Return the derivative by y of the series c at an end of the piece, -1 or 1.

    That of T_m is end^(m+1) m^2 there.
    """
    s = 0.0
    sign = end  # end^(m+1)
    for m in range(1, POINTS):
        sign *= end
        s += sign * m * m * c[m]
    return s


def slope(c: Values, y: float) -> float:
    """Return the derivative by y of the series c at y: the sum of m c_m U_(m-1)(y).

    U are the Chebyshev polynomials of the second kind, U_m = 2 y U_(m-1) - U_(m-2).
    """
    s = 0.0
    before = 0.0  # U_(m-2)
    u = 1.0  # U_(m-1)
    for m in range(1, POINTS):
        s += m * c[m] * u
        after = 2 * y * u - before
        before = u
        u = after
    return s


def set_series(f: Values, c: MutableValues) -> None:
    """Set c to the coefficients of the series with the values f at the points.

    f and c have POINTS entries each.
    """
    for m in range(POINTS):
        # Coefficient m is the product of row m of SERIES with the values. The row is
        # taken out of the inner loop, as a view costs more than a product.
        row = SERIES[m]
        s = 0.0
        for j in range(POINTS):
            s += row[j] * f[j]
        c[m] = s


def integral(f: Values) -> float:
    """Return the integral over y from -1 to 1 of a polynomial with values f.

    They are those at the points. The value at the start, f[0], is not needed.
    """
    s = 0.0
    for j in range(N):
        s += WEIGHTS[j] * f[j + 1]  # stage j is point j + 1
    return s


def truncation_estimate(f: Values) -> float:
    """Return abs(c[N - 1]) + abs(c[N]) of the series with the values f at the points.

    This tail measures the truncation error.
    """
    before = 0.0  # c[N - 1]
    last = 0.0  # c[N]
    row_before = SERIES[N - 1]
    row_last = SERIES[N]
    for j in range(POINTS):
        before += row_before[j] * f[j]
        last += row_last[j] * f[j]
    return abs(before) + abs(last)


def remainder(f: Values, integrated: bool) -> float:
    """Return an estimate of the error of a polynomial, or of its integral.

    It has the values f at the points. Its error is the coefficients beyond degree N. If
    coefficients fall by a factor r from degree to degree, and `tail` is the sum of the
    last two, these are e = tail r (1 + r^2 + r^4 + ...) = tail r/(1 - r^2) together.

    Of the integral (`integrated`) the error is e (r^2 + 0.01): the integrals of the
    coefficients left out are about a hundredth of them, and collocation integrates far
    better than it follows values, about as tail r^3.
    """
    last = 0.0  # tail: abs(c[N - 1]) + abs(c[N])
    before = 0.0  # abs(c[N - 3]) + abs(c[N - 2])
    for m in range(N - 3, POINTS):  # the last four coefficients, two and two
        row = SERIES[m]  # it gives coefficient m
        s = 0.0
        for j in range(POINTS):
            s += row[j] * f[j]
        if m < N - 1:
            before += abs(s)
        else:
            last += abs(s)
    # The sums that are compared are two degrees apart: their ratio is r^2.
    if last < MAX_DECAY * before:
        square = last / before
    else:  # the coefficients hardly fall
        square = MAX_DECAY
    error = last * math.sqrt(square) / (1 - square)
    if integrated:
        error *= square + NEXT_INTEGRAL
    return error


def error_at(f: Values, y: float) -> float:
    """Return an estimate of the error of the polynomial with the values f at y.

    The next coefficient, c, is missed by c (T_(N+1)(y) - its polynomial through the
    points). That is c 2^N (y - x_0) (y - x_1) ...: it is 0 at the points, where values
    have the error of collocation.
    """
    share = 1.0  # 2^(N + 1) (y - x_0) (y - x_1) ..., of which half is wanted
    for j in range(POINTS):
        share *= 2 * abs(y - X[j])
    between = 0.5 * share * remainder(f, False)  # that of values
    return between + remainder(f, True)  # that of integrals, as of collocation


def is_constant(f: Values) -> bool:
    """Return whether the values at all points are the same.

    The polynomial is constant then.
    """
    same = True
    for j in range(1, POINTS):
        same = same and f[j] == f[0]
    return bool(same)


def restrict(f: MutableValues, y: float, c: MutableValues) -> None:
    """Replace f by the values of the same polynomial in the part from -1 to y.

    They are those at the points of that part. c is scratch. A constant f stays as it
    is.
    """
    if is_constant(f):
        return
    set_series(f, c)
    for j in range(POINTS):
        # Point j of the part: the part is (y + 1)/2 times as long as the whole piece.
        place = 0.5 * (y + 1) * (X[j] + 1) - 1
        f[j] = value(c, place)


def first_zero(c: Values, low: float, high: float) -> float:
    """Return the place between `low` and `high` at which the series c falls below 0.

    It is found by bisection. The series is 0 or more at `low`, and negative at `high`
    and at the place returned. If it has several zeros there, this is one of them.
    """
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if value(c, middle) >= 0:
            low = middle
        else:
            high = middle
    return high


def largest(f: Values) -> float:
    """Return the largest of the values at the points."""
    most = f[0]
    for j in range(1, POINTS):
        most = max(most, f[j])
    return most


def smallest(f: Values) -> float:
    """Return the smallest of the values at the points."""
    least = f[0]
    for j in range(1, POINTS):
        least = min(least, f[j])
    return least


def place_of_minimum(c: Values, low: float, high: float) -> float:
    """Return the place between `low` and `high` at which the series c has its minimum.

    There is one minimum in between, which may be at an end. Of three thirds, each step
    leaves out the outer one beside the larger of the two values in between.
    """
    for _ in range(EXTREMUM_STEPS):
        third = (high - low) / 3
        if value(c, low + third) > value(c, high - third):
            low += third
        else:
            high -= third
    return low


def minimum(c: Values) -> float:
    """Return the smallest value of the series c from -1 to 1, or a bound of it.

    A series is c[0] - abs(c[1]) - abs(c[2]) - ... or more. If this bound is not
    negative, it is returned. Else the smallest value is searched for beside the
    smallest of samples.
    """
    bound = c[0]  # no value is smaller
    for m in range(1, POINTS):
        bound -= abs(c[m])
    least = bound
    if bound < 0:
        step = 2.0 / SAMPLES
        best = 0  # sample with the smallest value; sample k is at step k - 1
        least = value(c, -1.0)
        for k in range(1, SAMPLES + 1):
            sample = value(c, step * k - 1.0)
            if sample < least:
                least = sample
                best = k
        # The minimum lies between the samples on both sides of that one.
        low = max(-1.0, step * (best - 1) - 1.0)
        high = min(1.0, step * (best + 1) - 1.0)
        y = place_of_minimum(c, low, high)
        least = min(least, value(c, y))
    return least


def maximum(f: Values, c: MutableValues, least: float) -> Maximum:
    """Return the largest value of a polynomial, its place, and a possible miss.

    It has the values f at the points. c is scratch: it gets the series. A larger value
    is searched for between the neighbours of the largest of f. If none is found, or
    none can be above `least`, the largest of f is returned, with a miss of 0. No value
    is above c[0] + abs(c[1]) + abs(c[2]) + ...
    """
    best = 0  # point of the largest value
    for j in range(POINTS):
        if f[j] > f[best]:
            best = j
    before = max(best - 1, 0)
    after = min(best + 1, N)
    low = X[before]
    high = X[after]
    set_series(f, c)
    reach = c[0]  # no value is larger
    for m in range(1, POINTS):
        reach += abs(c[m])
    if reach <= least:
        return Maximum(f[best], X[best], 0.0)
    # A search in thirds rather than a parabola through three points: that would miss a
    # vertex beside an outermost point. The third beside the smaller value is left out.
    for _ in range(EXTREMUM_STEPS):
        first_third = (2 * low + high) / 3
        second_third = (low + 2 * high) / 3
        if value(c, first_third) < value(c, second_third):
            low = first_third
        else:
            high = second_third
    most = value(c, low)
    if most <= f[best]:  # no value between the points is larger
        return Maximum(f[best], X[best], 0.0)
    rise = most - min(f[before], f[after])  # from the lower neighbour
    return Maximum(most, low, EXTREMUM_RTOL * rise)


def set_parabola(f: MutableValues, whole: float, tilt: float, bend: float) -> None:
    """Set f to the parabola p with these integrals.

    Those of p P0, p P1 and p P2 are `whole`, `tilt` and `bend`. The integrals are over
    y from -1 to 1. P are the Legendre polynomials, P2 = 1.5 y^2 - 0.5, so p = (1/2)
    whole P0 + (3/2) tilt P1 + (5/2) bend P2.
    """
    for j in range(POINTS):
        f[j] = 0.5 * whole + 1.5 * tilt * X[j] + 2.5 * bend * (1.5 * X[j] * X[j] - 0.5)


def flatten(f: MutableValues) -> None:
    """Replace f by the parabola that is nearest to its polynomial in mean squares.

    That is the parabola with the same integrals times the Legendre polynomials P0, P1
    and P2.
    """
    whole = 0.0  # integral of f P0
    tilt = 0.0  # of f P1
    bend = 0.0  # of f P2
    for j in range(1, POINTS):
        w = WEIGHTS[j - 1] * f[j]  # what point j adds to the integral of f
        whole += w
        tilt += w * X[j]  # P1 = y
        bend += w * (1.5 * X[j] * X[j] - 0.5)  # P2
    set_parabola(f, whole, tilt, bend)


def eliminate(G: Matrix, n: int, band: int) -> None:
    """Solve n equations by Gauss elimination in place.

    Column n of G, the right side, becomes x. All coefficients are less than `band` from
    the diagonal; pivoting fills as much again on the right. The other columns of G are
    spoilt. G is not singular.
    """
    for i in range(n):
        # Column i is 0 from row `below` on, row i from column `right` on.
        below = min(n, i + band)
        right = min(n, i + 2 * band)
        # Row of the pivot, the largest coefficient of column i from the diagonal on
        p = i
        most = abs(G[i][i])
        for j in range(i + 1, below):
            if abs(G[j][i]) > most:
                p = j
                most = abs(G[j][i])
        row = G[i]
        pivot_row = G[p]
        # Columns from i on, and column n, are swapped.
        if p == i:
            swap_end = i  # there is nothing to swap: both are one row
        else:
            swap_end = right
        for q in range(i, swap_end):
            row[q], pivot_row[q] = pivot_row[q], row[q]
        row[n], pivot_row[n] = pivot_row[n], row[n]
        inverse_pivot = 1 / row[i]
        for j in range(i + 1, below):
            lower = G[j]
            factor = lower[i] * inverse_pivot
            for q in range(i + 1, right):
                lower[q] -= factor * row[q]
            lower[n] -= factor * row[n]
    for i in range(n - 1, -1, -1):  # back substitution
        row = G[i]
        s = row[n]
        for q in range(i + 1, min(n, i + 2 * band)):
            s -= row[q] * G[q][n]  # column n holds x of the later rows by now
        row[n] = s / row[i]
