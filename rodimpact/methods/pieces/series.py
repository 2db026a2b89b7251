"""Polynomials on a piece of time: Chebyshev series in y, from -1 at its start to 1 at its end.

A piece is known by its values at its start and at the N points of Radau IIA, the last of which is
the end: collocation there damps what is stiffer than the piece is long (Hairer and Wanner, Solving
Ordinary Differential Equations II, section IV.5).
"""

import math
from collections.abc import MutableSequence, Sequence
from typing import TypeAlias

import numpy as np
from numpy.polynomial import chebyshev, legendre

N = 8
"""Degree of a piece, and number of stages of the collocation."""
POINTS = N + 1
"""Points of a piece: its start and the stages."""
SAMPLES = 32
"""Intervals of a piece in which its smallest value is looked for."""
POSITIVE_RTOL = 0.1
"""Smallest over largest value at the points, above which a polynomial has no zero between them."""
NEXT_INTEGRAL = 0.01
"""Integral of the Chebyshev polynomial of the next degree, about."""
THIRDS = 36
"""Steps to an extremum, each of which leaves two thirds of the width: 5e-7 of it at the end."""
EXTREMUM_RTOL = 4 * (2 / 3) ** (2 * THIRDS)
"""By how much the value there may miss the extremum, over the range of the values at the points.

A parabola whose vertex is in the middle of a width w rises to it by r = |f''| w^2/8; at a distance
of u w from the vertex it is lower by |f''| (u w)^2/2 = 4 u^2 r.
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
"""Integrals from -1 on of the polynomials that are 1 at one stage and 0 at the others."""

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


def value(c: Values, y: float) -> float:
    """Return the sum of the series c at y, by Clenshaw's recurrence."""
    b1 = 0.0
    b2 = 0.0
    y2 = 2 * y
    for m in range(N, 0, -1):
        b0 = y2 * b1 - b2 + c[m]
        b2 = b1
        b1 = b0
    return y * b1 - b2 + c[0]


def slope_at_end(c: Values, end: float) -> float:
    """Return the derivative of the series c by y at an end of the piece, -1 or 1."""
    s = 0.0
    sign = end
    for m in range(1, POINTS):
        sign *= end
        s += sign * m * m * c[m]
    return s


def slope(c: Values, y: float) -> float:
    """Return the derivative of the series c at y, by y: the sum of m c_m U_(m-1)(y).

    U are the Chebyshev polynomials of the second kind.
    """
    s = 0.0
    before = 0.0
    u = 1.0
    for m in range(1, POINTS):
        s += m * c[m] * u
        after = 2 * y * u - before
        before = u
        u = after
    return s


def coefficients(f: Values, c: MutableValues) -> None:
    """Set c to the series with the values f at the points."""
    for m in range(POINTS):
        row = SERIES[m]  # taken out of the inner loop: a view costs more than a product
        s = 0.0
        for j in range(POINTS):
            s += row[j] * f[j]
        c[m] = s


def integral(f: Values) -> float:
    """Return the integral over y from -1 to 1 of the polynomial with the values f at the points."""
    s = 0.0
    for j in range(N):
        s += WEIGHTS[j] * f[j + 1]
    return s


def truncation_estimate(f: Values) -> float:
    """Return the size of the last two coefficients of the series with the values f at the points.

    It measures the truncation error.
    """
    before = 0.0
    last = 0.0
    row_before = SERIES[N - 1]
    row_last = SERIES[N]
    for j in range(POINTS):
        before += row_before[j] * f[j]
        last += row_last[j] * f[j]
    return abs(before) + abs(last)


def remainder(f: Values, integrated: bool) -> float:
    """Return an estimate of the error of a piece, against the function that it stands for.

    Coefficients fall by a factor r from degree to degree. The polynomial misses the next one, about
    the tail times r. Integrals of it are about a hundredth of that; and collocation integrates far
    better than it follows values, about as the tail times r^3.
    """
    last = 0.0
    before = 0.0
    for m in range(N - 3, POINTS):
        row = SERIES[m]
        s = 0.0
        for j in range(POINTS):
            s += row[j] * f[j]
        if m < N - 1:
            before += abs(s)
        else:
            last += abs(s)
    square = 0.0  # r^2: the coefficients that are compared are two degrees apart
    if before > 0:
        square = min(1.0, last / before)
    error = last * math.sqrt(square)
    if integrated:
        error *= square + NEXT_INTEGRAL
    return error


def is_constant(f: Values) -> bool:
    """Return whether the values at all points are the same."""
    same = True
    for j in range(1, POINTS):
        same = same and f[j] == f[0]
    return bool(same)


def restrict(f: MutableValues, y: float, c: MutableValues) -> None:
    """Replace f by the values of the same polynomial at the points of the part up to y."""
    if is_constant(f):
        return
    coefficients(f, c)
    for j in range(POINTS):
        f[j] = value(c, 0.5 * (y + 1) * (X[j] + 1) - 1)


def first_zero(c: Values, low: float, high: float) -> float:
    """Return the place between `low` and `high` at which the series c falls below 0, by bisection.

    It is 0 or more at `low`, and negative at `high`.
    """
    for _ in range(54):
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


def lowest(c: Values, low: float, high: float) -> float:
    """Return the place between two others at which the series c is lowest, if it has one there."""
    for _ in range(THIRDS):
        third = (high - low) / 3
        if value(c, low + third) > value(c, high - third):
            low += third
        else:
            high -= third
    return low


def minimum(c: Values) -> float:
    """Return the smallest value of the series c, found between samples beside the smallest of them.

    A series that cannot be negative, by the sum of its coefficients, is not looked at further: its
    smallest possible value is returned.
    """
    least = c[0]
    for m in range(1, POINTS):
        least -= abs(c[m])
    if least < 0:
        step = 2.0 / SAMPLES
        best = 0
        least = value(c, -1.0)
        for k in range(1, SAMPLES + 1):
            sample = value(c, step * k - 1.0)
            if sample < least:
                least = sample
                best = k
        low = max(-1.0, step * (best - 1) - 1.0)
        high = min(1.0, step * (best + 1) - 1.0)
        low = lowest(c, low, high)
        least = min(least, value(c, low))
    return least


def maximum(f: Values, c: MutableValues, least: float) -> float:
    """Return the largest value of the polynomial with the values f at the points.

    It lies beside the largest of these values. A vertex beside the outermost points counts too: a
    parabola through three points would miss it. If no value between the points can be more than
    `least`, the largest of the values at the points is returned.
    """
    best = 0
    for j in range(POINTS):
        if f[j] > f[best]:
            best = j
    low = X[max(best - 1, 0)]
    high = X[min(best + 1, N)]
    coefficients(f, c)
    reach = c[0]
    for m in range(1, POINTS):
        reach += abs(c[m])
    if reach <= least:
        return f[best]
    for _ in range(THIRDS):
        u = (2 * low + high) / 3
        w = (low + 2 * high) / 3
        if value(c, u) < value(c, w):
            low = u
        else:
            high = w
    return max(f[best], value(c, low))


def set_parabola(f: MutableValues, whole: float, tilt: float, bend: float) -> None:
    """Set f to the parabola with these integrals times P0, P1 and P2 (Legendre)."""
    for j in range(POINTS):
        f[j] = 0.5 * whole + 1.5 * tilt * X[j] + 2.5 * bend * (1.5 * X[j] * X[j] - 0.5)


def flatten(f: MutableValues) -> None:
    """Replace f by the parabola that is nearest to it in mean squares."""
    whole = 0.0
    tilt = 0.0
    bend = 0.0
    for j in range(1, POINTS):
        w = WEIGHTS[j - 1] * f[j]
        whole += w
        tilt += w * X[j]
        bend += w * (1.5 * X[j] * X[j] - 0.5)
    set_parabola(f, whole, tilt, bend)


def eliminate(G: Matrix, n: int, band: int) -> None:
    """Solve n equations by Gauss elimination in place; the right-hand side is column n of G.

    No coefficient is farther than `band` from the diagonal; pivoting fills as much again on the
    right.
    """
    for i in range(n):
        below = min(n, i + band)
        right = min(n, i + 2 * band)
        p = i
        most = abs(G[i][i])
        for j in range(i + 1, below):
            if abs(G[j][i]) > most:
                p = j
                most = abs(G[j][i])
        row = G[i]
        largest = G[p]
        swapped = right
        if p == i:
            swapped = i  # there is nothing to swap
        for q in range(i, swapped):
            row[q], largest[q] = largest[q], row[q]
        row[n], largest[n] = largest[n], row[n]
        pivot = 1 / row[i]
        for j in range(i + 1, below):
            lower = G[j]
            f = lower[i] * pivot
            for q in range(i + 1, right):
                lower[q] -= f * row[q]
            lower[n] -= f * row[n]
    for i in range(n - 1, -1, -1):
        row = G[i]
        s = row[n]
        for q in range(i + 1, min(n, i + 2 * band)):
            s -= row[q] * G[q][n]
        row[n] = s / row[i]
