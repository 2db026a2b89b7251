"""The tick rule: durations in whole ticks of a clock that all of them share.

Waves that took different paths meet at the same instant only if times are integers. Durations in
the ratio of small whole numbers (0.3 m and 0.1 m of one steel) are recognised and keep that ratio
exactly; the others are rounded to the nearest tick.
"""

from __future__ import annotations

import math
from typing import Any

TERMS = 1 << 20  # largest numerator or denominator of a recognised ratio
SLACK = 4.0 * 2.0**-52  # relative error of a ratio of two quotients of floats
MOST_PARTS = 1 << 40  # into how many units the longest duration may be divided
DIVISIBLE = 720720  # least common multiple of 1 to 16
LEAST_UNIT = 2.0**40  # ticks in the unit of any further class, so that rounding it is harmless

CLOCK_BITS = 62  # ticks end at 2^62
HORIZON = 4096  # longest transits for which the clock has room when no end is given
FINEST, COARSEST = 50, 20  # longest transit in ticks, as a power of two


def recognise(x: float) -> tuple[int, int]:
    """Recover x = p/q by its continued fraction.

    Parameters
    ----------
    x : float
        Positive.

    Returns
    -------
    p, q : int
        With p, q <= 2^20 and abs(x - p/q) <= 4 * 2^-52 * x, or (0, 0) if there are none.
    """
    p0, q0, p1, q1 = 0, 1, 1, 0
    y = x
    while y < TERMS + 1:
        a = int(y)
        p0, q0, p1, q1 = p1, q1, a * p1 + p0, a * q1 + q0
        if p1 > TERMS or q1 > TERMS:
            return 0, 0
        if abs(x * q1 - p1) <= SLACK * x * q1:
            return p1, q1
        if y == a:
            return 0, 0
        y = 1.0 / (y - a)
    return 0, 0


def common_parts(durations: Any, order: Any, start: int, most: int, p: Any, q: Any) -> int:
    """Gather the class of the duration at order[start]: those in a simple ratio to it.

    Parameters
    ----------
    durations : [n] float
    order : [n] int
        Indices by decreasing duration.
    start : int
        Place in `order` of the class's longest member.
    most : int
        Largest number of parts allowed.
    p, q : [n] int
        q < 0 marks a member of an earlier class. Members get their ratio p/q to the longest,
        the others q = 0.

    Returns
    -------
    int
        Number of equal parts of the longest in which all members are whole.
    """
    parts = 1
    longest = durations[order[start]]
    p[order[start]] = q[order[start]] = 1
    for i in range(start + 1, len(order)):
        j = order[i]
        if q[j] >= 0:
            p[j], q[j] = recognise(durations[j] / longest)
            if q[j] > 0:
                shared = parts // math.gcd(parts, q[j]) * q[j]
                if shared <= most:
                    parts = shared
                else:
                    q[j] = 0
    return parts


def assign_ticks(
    durations: Any, bits: int, order: Any, p: Any, q: Any, ticks: Any, late: int = 0
) -> int:
    """Give each duration its whole number of ticks; return that of the longest (about 2^bits).

    A tick is the longest duration divided by the number returned. The class of the longest is
    exact, and simple fractions of its unit are whole ticks too, for gaps that close there. A
    further class is exact while its unit has at least 2^40 ticks; what is left is rounded singly,
    by at most half a tick.

    Parameters
    ----------
    durations : [n] float
        Positive, in any order and any unit.
    bits : int
    order, p, q : [n] int
        Work space.
    ticks : [n] int
        Result.
    late : int
        So many durations at the end are times of drives: they may be longer than the longest of the
        others, and lead no class with one of those.
    """
    n = len(durations)
    for i in range(n):
        j, first = i, 0 if i < n - late else n - late
        while j > first and durations[order[j - 1]] < durations[i]:
            order[j] = order[j - 1]
            j -= 1
        order[j] = i
        q[i] = 0
    longest = durations[order[0]]
    total = 0
    for start in range(n):
        lead = order[start]
        if q[lead] < 0:
            continue
        if start == 0:
            parts = common_parts(durations, order, start, MOST_PARTS, p, q)
            unit = max(1, ((1 << bits) + parts // 2) // parts)
            if unit > DIVISIBLE * DIVISIBLE:
                unit -= unit % DIVISIBLE
            total = unit * parts
        else:
            span = durations[lead] / longest * total
            parts, unit = 0, 0
            if span >= LEAST_UNIT:
                parts = common_parts(durations, order, start, int(span / LEAST_UNIT), p, q)
                unit = int(span / parts + 0.5)
        if unit == 0:
            ticks[lead] = int(span + 0.5)
            q[lead] = -1
            continue
        for i in range(start, n):
            j = order[i]
            if q[j] > 0:
                ticks[j] = unit * (parts // q[j]) * p[j]
                q[j] = -1
    return total


def clock_bits(ratio: float) -> int:
    """Ticks of the longest transit, as a power of two, for a run of `ratio` longest transits."""
    if not 0 < ratio < math.inf:
        return FINEST if ratio == 0 else 0
    mantissa, exponent = math.frexp(ratio)
    return min(FINEST, CLOCK_BITS - 1 - (exponent if mantissa > 0.5 else exponent - 1))
