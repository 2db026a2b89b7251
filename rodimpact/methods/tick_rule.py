"""The tick rule: durations in whole ticks of a clock that all of them share.

Waves that took different paths meet at the same instant only if times are integers. Durations in
the ratio of small whole numbers (0.3 m and 0.1 m of one steel) are recognised and keep that ratio
exactly; the others are rounded to the nearest tick.
"""

import math
from typing import Any

import numpy as np

TERMS = 1 << 20  # largest numerator or denominator of a recognised ratio
SLACK = 4.0 * 2.0**-52  # relative error of a ratio of two quotients of floats
MOST_PARTS = 1 << 40  # into how many units the longest duration may be divided
DIVISIBLE = 720720  # least common multiple of 1 to 16
LEAST_UNIT = (
    2.0**40
)  # ticks in the unit of any further class, so that rounding it is harmless

CLOCK_BITS = 62  # ticks end at 2^62
HORIZON = 4096  # longest transits for which the clock has room when no end is given
FINEST, COARSEST = 50, 20  # longest transit in ticks, as a power of two

SPAN = np.dtype(
    [
        ("time", "f8"),
        ("ticks", "i8"),  # s
        ("place", "i8"),  # of the span that comes here by decreasing duration
        ("p", "i8"),
        ("q", "i8"),  # ratio to the longest of its class; q < 0: it has its ticks
    ],
    align=True,
)
"""A duration to be counted in ticks."""


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


def common_parts(span: Any, start: int, most: int) -> int:
    """Gather the class of the longest duration that is left: those in a simple ratio to it.

    Parameters
    ----------
    span : [n] SPAN
        By their places; members of an earlier class have q < 0. Members of this one get their ratio
        p/q to the longest, the others q = 0.
    start : int
        Place of the longest member of the class.
    most : int
        Largest number of parts allowed.

    Returns
    -------
    int
        Number of equal parts of the longest in which all members are whole.
    """
    parts, first = 1, span[span[start].place]
    first.p = first.q = 1
    for i in range(start + 1, len(span)):
        other = span[span[i].place]
        if other.q >= 0:
            other.p, other.q = recognise(other.time / first.time)
            if other.q > 0:
                shared = parts // math.gcd(parts, other.q) * other.q
                if shared <= most:
                    parts = shared
                else:
                    other.q = 0
    return parts


def put_in_order(span: Any, late: int) -> None:
    """Sort spans by decreasing duration, the last `late` of them by themselves."""
    n = len(span)
    for i in range(n):
        j, first = i, 0 if i < n - late else n - late
        while j > first and span[span[j - 1].place].time < span[i].time:
            span[j].place = span[j - 1].place
            j -= 1
        span[j].place = i
        span[i].q = 0


def assign_ticks(span: Any, bits: int, late: int = 0) -> int:
    """Give each duration its whole number of ticks; return that of the longest (about 2^bits).

    A tick is the longest duration divided by the number returned. The class of the longest is
    exact, and simple fractions of its unit are whole ticks too, for gaps that close there. A
    further class is exact while its unit has at least 2^40 ticks; what is left is rounded singly,
    by at most half a tick.

    Parameters
    ----------
    span : [n] SPAN
        Times are positive, in any order and any unit.
    bits : int
    late : int
        So many at the end are times of drives: they may be longer than the longest of the others,
        and lead no class with one of those.
    """
    put_in_order(span, late)
    total, longest = 0, span[span[0].place].time
    for start in range(len(span)):
        lead = span[span[start].place]
        if lead.q < 0:
            continue
        whole, most, unit = lead.time / longest * total, MOST_PARTS, 0
        if start > 0:
            most = int(whole / LEAST_UNIT)
        parts = common_parts(span, start, most) if most > 0 else 0
        if start == 0:
            unit = max(1, ((1 << bits) + parts // 2) // parts)
            if unit > DIVISIBLE * DIVISIBLE:
                unit -= unit % DIVISIBLE
            total = unit * parts
        elif parts > 0:
            unit = int(whole / parts + 0.5)
        if unit == 0:
            lead.ticks, lead.q = int(whole + 0.5), -1
            continue
        for i in range(start, len(span)):
            one = span[span[i].place]
            if one.q > 0:
                one.ticks, one.q = unit * (parts // one.q) * one.p, -1
    return total


def clock_bits(ratio: float) -> int:
    """Ticks of the longest transit, as a power of two, for a run of `ratio` longest transits."""
    if not 0 < ratio < math.inf:
        return FINEST if ratio == 0 else 0
    mantissa, exponent = math.frexp(ratio)
    return min(FINEST, CLOCK_BITS - 1 - (exponent if mantissa > 0.5 else exponent - 1))
