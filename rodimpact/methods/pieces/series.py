"""Polynomials on a piece of time, as Chebyshev series in y.

y goes from -1 at the start of the piece to 1 at its end. The polynomial has degree N.
It is given by its values at POINTS = N + 1 points: the start of the piece, and the N
stages of the collocation method Radau IIA, the last of which is the end of the piece.
This method damps motions that are too fast for the piece (Hairer and Wanner, Solving
Ordinary Differential Equations II, section IV.5).

Everywhere f are the values at the points, and c the coefficients of the Chebyshev
series: the sum of c[m] T_m(y), with T_m(cos x) = cos(m x). Integrals are over y.
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
"""Number of equal intervals of a piece at whose ends its smallest value is sought."""
POSITIVE_RTOL = 0.1
"""Ratio of smallest to largest value at the points, above which there is no zero."""
NEXT_INTEGRAL = 0.01
"""Approximate integral of the Chebyshev polynomial of the next degree."""
MAX_DECAY = 0.75
"""Largest ratio that is used of coefficients two degrees apart, later to earlier.

Coefficients with a larger ratio hardly fall: the series does not resolve the function.
"""
EXTREMUM_STEPS = 36
"""Number of steps of the search for an extremum.

Each step reduces the width of the interval to two thirds, all of them to 5e-7.
"""
BISECTIONS = 54
"""Number of steps of the search for a zero.

Each step halves the width of the interval, which is below round-off at the end.
"""
EXTREMUM_RTOL = 4 * (2 / 3) ** (2 * EXTREMUM_STEPS)
"""Error of a maximum that was found, over its rise from the lower end of the interval.

A parabola with its vertex in an interval of width w rises by r >= abs(f'') w^2/8 from
the lower end to the vertex. At a distance of u w from the vertex it is lower than the
vertex by abs(f'') (u w)^2/2 <= 4 u^2 r. After the search u is at most
(2/3)^EXTREMUM_STEPS.
"""

Values: TypeAlias = Sequence[float]
"""Values at the points of a piece, or coefficients of a series."""
MutableValues: TypeAlias = MutableSequence[float]
"""Values or coefficients that a function sets."""
Matrix: TypeAlias = Sequence[MutableSequence[float]]
"""Rows of a matrix, which a function may set."""

# The stages of Radau IIA are the zeros of P_(N-1) - P_N, P the Legendre polynomials.
_LAST = legendre.Legendre.basis(N - 1) - legendre.Legendre.basis(N)
_RADAU = np.append(np.sort(_LAST.roots().real)[:-1], 1.0)  # the last one is exactly 1
_START_AND_STAGES = np.concatenate(([-1.0], _RADAU))
_STAGES_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_RADAU, N - 1))
_VALUES_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_START_AND_STAGES, N))
_SERIES_AT_START = chebyshev.chebvander([-1.0], N - 1)
_INTEGRALS = [
    chebyshev.Chebyshev(column).integ(lbnd=-1) for column in _STAGES_TO_SERIES.T
]
"""Integrals from -1 on of the polynomials that are 1 at one stage, 0 at the others."""

X: list[float] = _START_AND_STAGES.tolist()
"""The points: X[j] is the y of point j."""
SERIES: list[list[float]] = _VALUES_TO_SERIES.tolist()
"""Matrix from values at the points to coefficients of the Chebyshev series."""
STAGES: list[list[float]] = [[float(each(y)) for each in _INTEGRALS] for y in _RADAU]
"""Matrix from values at the stages to the integrals from -1 to each stage."""
TWICE: list[list[float]] = (np.array(STAGES) @ np.array(STAGES)).tolist()
"""Matrix from values at the stages to the second integrals from -1 to each stage."""
START: list[float] = (_SERIES_AT_START @ _STAGES_TO_SERIES)[0].tolist()
"""Weights of the stages in the value extrapolated to the start."""
WEIGHTS: list[float] = STAGES[N - 1][:]
"""Weights of the stages in the integral from -1 to 1; exact up to degree 2N - 2."""


class Maximum(NamedTuple):
    """The largest value of a polynomial on a piece."""

    value: float
    position: float  # y, from -1 at the start of the piece to 1 at its end
    miss: float  # largest amount by which the true maximum may be above `value`


def value(c: Values, y: float) -> float:
    """Return the value of the series c at y.

    Clenshaw's recurrence b_m = 2 y b_(m+1) - b_(m+2) + c_m runs from m = N down to 1.
    The value is y b_1 - b_2 + c_0.
    """
    b1 = 0.0  # b_(m+1)
    b2 = 0.0  # b_(m+2)
    y2 = 2 * y
    for m in range(N, 0, -1):
        b0 = y2 * b1 - b2 + c[m]
        b2 = b1
        b1 = b0
    return y * b1 - b2 + c[0]  # b1 and b2 are b_1 and b_2 now


def slope_at_end(c: Values, end: float) -> float:
    """Return the derivative by y of the series c at an end of the piece.

    `end` is the y of this end, -1 or 1. The derivative of T_m is end^(m+1) m^2 there.
    """
    s = 0.0
    sign = end  # end^(m+1) for m = 0
    for m in range(1, POINTS):
        sign *= end
        s += sign * m * m * c[m]
    return s


def slope(c: Values, y: float) -> float:
    """Return the derivative by y of the series c at y: the sum of m c_m U_(m-1)(y).

    U_m are the Chebyshev polynomials of the second kind, with the recurrence
    U_m = 2 y U_(m-1) - U_(m-2).
    """
    s = 0.0
    u_before = 0.0  # U_(m-2)
    u = 1.0  # U_(m-1)
    for m in range(1, POINTS):
        s += m * c[m] * u
        u_after = 2 * y * u - u_before
        u_before = u
        u = u_after
    return s


def set_series(f: Values, c: MutableValues) -> None:
    """Set c to the coefficients of the series with the values f at the points.

    f and c have POINTS entries each.
    """
    for m in range(POINTS):
        # Coefficient m is the product of row m of SERIES with the values. To take a row
        # of the matrix costs more than a multiplication: it is done before the loop.
        row = SERIES[m]
        s = 0.0
        for j in range(POINTS):
            s += row[j] * f[j]
        c[m] = s


def integral(f: Values) -> float:
    """Return the integral over y from -1 to 1 of the polynomial with the values f.

    f are the values at the points. The value at the start, f[0], is not used.
    """
    s = 0.0
    for j in range(N):
        s += WEIGHTS[j] * f[j + 1]  # stage j is point j + 1
    return s


def truncation_estimate(f: Values) -> float:
    """Return abs(c[N - 1]) + abs(c[N]) of the series with the values f at the points.

    This sum of the last two coefficients, the tail, measures the truncation error.
    """
    last_but_one = 0.0  # c[N - 1]
    last = 0.0  # c[N]
    row_last_but_one = SERIES[N - 1]
    row_last = SERIES[N]
    for j in range(POINTS):
        last_but_one += row_last_but_one[j] * f[j]
        last += row_last[j] * f[j]
    return abs(last_but_one) + abs(last)


def remainder(f: Values, integrated: bool) -> float:
    """Return an estimate of the error of a polynomial, or of its integral.

    f are the values of the polynomial at the points. Its error e is the sum of the
    coefficients beyond degree N. If coefficients fall by a factor r from degree to
    degree, and `tail` is the sum of the last two up to N, then
    e = tail r (1 + r^2 + r^4 + ...) = tail r/(1 - r^2).

    The error of the integral (`integrated`) is e (r^2 + 0.01). The second term is for
    the integrals of the missing polynomials, which are about a hundredth of their
    coefficients. The first term is the error of collocation, whose integrals are far
    more precise than its values: about tail r^3.
    """
    tail = 0.0  # abs(c[N - 1]) + abs(c[N])
    tail_before = 0.0  # abs(c[N - 3]) + abs(c[N - 2])
    for m in range(N - 3, POINTS):  # the last four coefficients
        row = SERIES[m]
        s = 0.0  # coefficient m
        for j in range(POINTS):
            s += row[j] * f[j]
        if m < N - 1:
            tail_before += abs(s)
        else:
            tail += abs(s)
    # r^2: the two sums are two degrees apart
    if tail < MAX_DECAY * tail_before:
        r_squared = tail / tail_before
    else:  # the coefficients hardly fall
        r_squared = MAX_DECAY
    error = tail * math.sqrt(r_squared) / (1 - r_squared)
    if integrated:
        error *= r_squared + NEXT_INTEGRAL
    return error


def error_at(f: Values, y: float) -> float:
    """Return an estimate of the error at y of the polynomial with the values f.

    It is the sum of two errors. The error of interpolation is abs(c 2^N (y - x_0)
    (y - x_1) ... (y - x_N)) with the points x and the first missing coefficient c, of
    T_(N+1), for which `remainder` is taken. It is 0 at the points. The values at the
    points have the error of collocation, the `remainder` of the integral.
    """
    product = 1.0  # abs(2^(N+1) (y - x_0) ... (y - x_N)), twice what is wanted
    for j in range(POINTS):
        product *= 2 * abs(y - X[j])
    value_error = remainder(f, False)
    integral_error = remainder(f, True)  # of the integral
    return 0.5 * product * value_error + integral_error


def is_constant(f: Values) -> bool:
    """Return whether the values at all points are equal: the polynomial is constant."""
    same = True
    for j in range(1, POINTS):
        same = same and f[j] == f[0]
    return bool(same)


def restrict(f: MutableValues, y: float, c: MutableValues) -> None:
    """Shorten a piece: keep the polynomial with the values f from -1 to y.

    f becomes the values of the same polynomial at the points of this part. c is
    scratch. A constant f stays as it is.
    """
    if is_constant(f):
        return
    set_series(f, c)
    for j in range(POINTS):
        # y of point j of the part, which is (y + 1)/2 times as long as the whole piece
        y_j = 0.5 * (y + 1) * (X[j] + 1) - 1
        f[j] = value(c, y_j)


def first_zero(c: Values, low: float, high: float) -> float:
    """Return the y between `low` and `high` at which the series c falls below 0.

    The series must be 0 or more at `low`, and negative at `high`. It is negative at the
    y that is returned, which bisection finds. If there are several zeros, it is one of
    them, not always the first.
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


def position_of_minimum(c: Values, low: float, high: float) -> float:
    """Return the y between `low` and `high` at which the series c has its minimum.

    There must be only one minimum between them, which may be at an end. This is a
    ternary search: each step compares the values at one and two thirds of the interval,
    and drops the outer third beside the larger value.
    """
    for _ in range(EXTREMUM_STEPS):
        third = (high - low) / 3
        if value(c, low + third) > value(c, high - third):
            low += third
        else:
            high -= third
    return low


def minimum(c: Values) -> float:
    """Return the smallest value of the series c from -1 to 1, or a lower bound of it.

    No value is below c[0] - abs(c[1]) - abs(c[2]) - ... This bound is returned if it is
    not negative. Otherwise the smallest of SAMPLES + 1 evenly spaced values is found,
    then the minimum near it.
    """
    bound = c[0]  # no value is smaller
    for m in range(1, POINTS):
        bound -= abs(c[m])
    least = bound
    if bound < 0:
        step = 2.0 / SAMPLES
        best = 0  # number of the smallest sample; sample k is at y = step k - 1
        least = value(c, -1.0)
        for k in range(1, SAMPLES + 1):
            sample = value(c, step * k - 1.0)
            if sample < least:
                least = sample
                best = k
        # The minimum lies between the two neighbours of the smallest sample.
        low = max(-1.0, step * (best - 1) - 1.0)
        high = min(1.0, step * (best + 1) - 1.0)
        y = position_of_minimum(c, low, high)
        least = min(least, value(c, y))
    return least


def maximum(f: Values, c: MutableValues, least: float) -> Maximum:
    """Return the largest value of a polynomial, its position, and a possible miss.

    f are the values of the polynomial at the points. c is scratch: it becomes the
    series. The maximum is searched for between the two neighbours of the largest of f.
    That value itself is returned, with a miss of 0, if the search finds nothing larger,
    or is not needed: if the bound c[0] + abs(c[1]) + abs(c[2]) + ... of all values is
    at most `least`.
    """
    best = 0  # point of the largest of f
    for j in range(POINTS):
        if f[j] > f[best]:
            best = j
    before = max(best - 1, 0)
    after = min(best + 1, N)
    low = X[before]
    high = X[after]
    set_series(f, c)
    bound = c[0]  # no value is larger
    for m in range(1, POINTS):
        bound += abs(c[m])
    no_miss = 0.0
    if bound <= least:
        return Maximum(f[best], X[best], no_miss)
    # Ternary search: each step drops the outer third beside the smaller value. (A
    # parabola through three points would miss a vertex near the start or the end.)
    for _ in range(EXTREMUM_STEPS):
        first_third = (2 * low + high) / 3
        second_third = (low + 2 * high) / 3
        if value(c, first_third) < value(c, second_third):
            low = first_third
        else:
            high = second_third
    most = value(c, low)
    if most <= f[best]:  # no value between the points is larger
        return Maximum(f[best], X[best], no_miss)
    rise = most - min(f[before], f[after])  # from the lower neighbour
    miss = EXTREMUM_RTOL * rise
    return Maximum(most, low, miss)


def set_parabola(f: MutableValues, whole: float, tilt: float, bend: float) -> None:
    """Set f to the values of a parabola p, given by three integrals, at the points.

    `whole`, `tilt` and `bend` are the integrals of p P0, p P1 and p P2 over y from -1
    to 1, with the Legendre polynomials P0 = 1, P1 = y and P2 = 1.5 y^2 - 0.5. Since
    these are orthogonal, p = (1/2) whole P0 + (3/2) tilt P1 + (5/2) bend P2.
    """
    for j in range(POINTS):
        f[j] = 0.5 * whole + 1.5 * tilt * X[j] + 2.5 * bend * (1.5 * X[j] * X[j] - 0.5)


def flatten(f: MutableValues) -> None:
    """Replace f by the parabola nearest to its polynomial by least squares.

    f are values at the points. The parabola has the same integrals of f P0, f P1 and
    f P2 over y, with the Legendre polynomials P0, P1 and P2.
    """
    whole = 0.0  # integral of f P0
    tilt = 0.0  # integral of f P1
    bend = 0.0  # integral of f P2
    for j in range(1, POINTS):
        w = WEIGHTS[j - 1] * f[j]  # share of point j in the integral of f
        whole += w
        tilt += w * X[j]  # P1 = y
        bend += w * (1.5 * X[j] * X[j] - 0.5)  # P2
    set_parabola(f, whole, tilt, bend)


def eliminate(G: Matrix, n: int, band: int) -> None:
    """Solve n linear equations by Gauss elimination in place.

    Column n of G is the right side; it becomes the solution x, and the other columns
    are overwritten. G must be a band matrix: coefficients are 0 from `band` columns
    away from the diagonal on. Row exchanges widen the band to twice as much on the
    right. G must not be singular.
    """
    for i in range(n):
        # Column i is 0 from row `below` on, row i is 0 from column `right` on.
        below = min(n, i + band)
        right = min(n, i + 2 * band)
        # Row of the pivot: the largest coefficient of column i on or below the diagonal
        p = i
        most = abs(G[i][i])
        for j in range(i + 1, below):
            if abs(G[j][i]) > most:
                p = j
                most = abs(G[j][i])
        row = G[i]
        pivot_row = G[p]
        # Swap both rows, from column i on, and in column n.
        if p == i:
            swap_end = i  # nothing is swapped: both are the same row
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
    # Back substitution. Row i is 0 from column i + 2 band on, as above.
    for i in range(n - 1, -1, -1):
        row = G[i]
        s = row[n]
        for q in range(i + 1, min(n, i + 2 * band)):
            s -= row[q] * G[q][n]  # column n of a later row q holds the solution x[q]
        row[n] = s / row[i]
