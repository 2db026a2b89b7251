"""The tick rule: durations in whole ticks of a clock that all of them share.

Waves that took different paths meet at the same instant only if times are integers.
Durations in the ratio of small whole numbers (0.3 m and 0.1 m of one steel) are
recognised and keep that ratio exactly; the others are rounded to the nearest tick.

Durations form classes. A class is the longest duration that is in no class yet, its
leader, and all durations in a simple ratio to the leader.
"""

import math
from collections.abc import Sequence

from .record_lists import dtype_of

MAX_TERM = 1 << 20  # largest numerator or denominator of a recognised ratio
RATIO_RTOL = 4.0 * 2.0**-52  # round-off in a ratio of two quotients of floats
MAX_PARTS = 1 << 40  # largest number of equal parts of the longest duration
DIVISIBLE = 720720  # lcm of 1 to 16: fractions of its multiples are whole
MIN_UNIT = 2.0**40  # ticks in a part of a further class: its rounding is below 2^-41

CLOCK_BITS = 62  # ticks end at 2^62

# A clock without a given end can count at least so many times these durations.
HORIZON = 4096  # longest transits
MIN_ROW_CROSSINGS = 16
MIN_FLIGHTS = 4

MAX_TRANSIT_BITS = 50  # the longest transit has at most 2^50 ticks, or a few more
MIN_TRANSIT_BITS = 20  # and at least 2^20


class Duration:
    """A duration to be counted in ticks."""

    time: float  # s
    ticks: int
    sorted_index: int  # index of the i-th longest duration, i the place of this record
    p: int  # ratio p/q to the leader of its class;
    q: int  # q = 0: none is found, q < 0: it has its ticks


DURATION = dtype_of(Duration)


def recognise(x: float) -> tuple[int, int]:
    """Recover x = p/q by its continued fraction x = a0 + 1/(a1 + 1/(a2 + ...)).

    Convergents are tried one after the other: the first that is close enough counts.

    Parameters
    ----------
    x : float
        Positive.

    Returns
    -------
    p, q : int
        With p, q <= 2^20 and abs(x - p/q) <= 4 * 2^-52 * x, or (0, 0) if there are
        none.
    """
    p0 = 0  # the convergent before the last one, p0/q0
    q0 = 1
    p1 = 1  # the last convergent, p1/q1
    q1 = 0
    y = x  # rest of the fraction
    while y < MAX_TERM + 1:  # a larger term makes p or q too large
        a = int(y)  # the next term
        p2 = a * p1 + p0
        q2 = a * q1 + q0
        p0 = p1
        q0 = q1
        p1 = p2
        q1 = q2
        if p1 > MAX_TERM or q1 > MAX_TERM:
            return 0, 0
        if abs(x * q1 - p1) <= RATIO_RTOL * x * q1:
            return p1, q1
        if y == a:  # the fraction ends, and is not accurate
            return 0, 0
        y = 1.0 / (y - a)
    return 0, 0


def find_class(durations: Sequence[Duration], start: int, max_parts: int) -> int:
    """Find the class of the longest duration that has no ticks yet, its leader.

    Of the durations without ticks behind it, members of the class get their ratio p/q
    to the leader, the others q = 0; the leader gets 1/1. Nothing gets its ticks here.

    Parameters
    ----------
    durations : [n] Duration
        With their sorted indices: the i-th longest has the index
        durations[i].sorted_index. Members of an earlier class have q < 0.
    start : int
        Place of the leader in the order by decreasing time.
    max_parts : int
        Largest number of parts allowed: a duration that needs more is no member.

    Returns
    -------
    int
        Number of equal parts of the leader in which all members are whole.
    """
    parts = 1
    leader = durations[durations[start].sorted_index]
    leader.p = 1
    leader.q = 1
    for i in range(start + 1, len(durations)):
        other = durations[durations[i].sorted_index]
        if other.q >= 0:  # it has no ticks yet
            p, q = recognise(other.time / leader.time)
            other.p = p
            other.q = q
            if q > 0:  # the ratio is simple
                common_parts = parts // math.gcd(parts, q) * q  # least common multiple
                if common_parts <= max_parts:
                    parts = common_parts
                else:
                    other.q = 0  # too many parts: it is none of the class
    return parts


def sort_durations(durations: Sequence[Duration], drive_count: int) -> None:
    """Set `sorted_index`, the order by decreasing time, and forget each class (q = 0).

    No record moves: durations[i].sorted_index becomes the index of the i-th longest.
    Equal times keep their order. The last `drive_count` durations are ordered by
    themselves and come last.
    """
    n = len(durations)
    for i in range(n):  # insertion: those before i are in order
        first = 0  # first place that duration i may take
        if i >= n - drive_count:
            first = n - drive_count
        j = i  # place of duration i in the order
        while j > first:
            previous = durations[j - 1].sorted_index
            if durations[previous].time >= durations[i].time:
                break
            durations[j].sorted_index = previous
            j -= 1
        durations[j].sorted_index = i
        durations[i].q = 0


def assign_ticks(durations: Sequence[Duration], bits: int, drive_count: int = 0) -> int:
    """Set `ticks` of each duration, and return those of the longest, about 2^bits.

    A tick is the longest duration that is no time of a drive, divided by the number
    returned. Durations in simple ratios are a class, whose members are whole multiples
    of its unit. The class of the longest is exact, and simple fractions of its unit are
    whole ticks too, for gaps that close there. The unit of a further class is rounded
    to whole ticks, at least 2^40. A duration in no class is rounded singly, by at most
    half a tick.

    Parameters
    ----------
    durations : [n] Duration
        One or more. Times are positive, in any order and any unit.
    bits : int
    drive_count : int
        Number of durations at the end that are times of drives. They may be longer than
        the longest of the others, and never lead a class that contains a transit.
    """
    sort_durations(durations, drive_count)
    longest_ticks = 0
    longest_time = durations[durations[0].sorted_index].time
    for start in range(len(durations)):  # by decreasing time, drives after all others
        leader = durations[durations[start].sorted_index]
        # q is below 0 once a duration has its ticks. `find_class` sets p/q of the
        # members of a class, and q = 0 for the others.
        if leader.q < 0:
            continue
        # Ticks of the leader before they are rounded; 0 for the first class
        exact_ticks = leader.time / longest_time * longest_ticks
        if start == 0:
            max_parts = MAX_PARTS
        else:
            max_parts = int(exact_ticks / MIN_UNIT)  # a part has MIN_UNIT ticks or more
        if max_parts == 0:  # it is too short to lead a class: it is rounded singly
            leader.ticks = int(exact_ticks + 0.5)
            leader.q = -1
            continue
        parts = find_class(durations, start, max_parts)
        # Ticks of a part, the unit of the class
        if start == 0:
            unit = max(1, ((1 << bits) + parts // 2) // parts)  # 2^bits/parts, rounded
            if unit > DIVISIBLE * DIVISIBLE:
                # The multiple of DIVISIBLE below is less by 1/DIVISIBLE of it at most.
                unit -= unit % DIVISIBLE
            longest_ticks = unit * parts
        else:
            unit = int(exact_ticks / parts + 0.5)  # rounded
        for i in range(start, len(durations)):
            member = durations[durations[i].sorted_index]
            # A member, the leader with 1/1 too, has p/q of the `parts` parts of the
            # leader.
            if member.q > 0:
                member.ticks = unit * (parts // member.q) * member.p
                member.q = -1
    return longest_ticks


def clock_bits(ratio: float) -> int:
    """Base-2 logarithm of the longest transit in ticks, `MAX_TRANSIT_BITS` at most.

    With it a run of `ratio` longest transits takes no more than 2^CLOCK_BITS ticks. No
    clock counts the run if the result is below `MIN_TRANSIT_BITS`; it may be negative,
    and is 0 for a ratio that is negative, infinite or nan.
    """
    if ratio == 0:
        return MAX_TRANSIT_BITS
    if not 0 < ratio < math.inf:
        return 0
    # The ratio is mantissa times 2^exponent, with a mantissa from 1/2 to below 1.
    mantissa, exponent = math.frexp(ratio)
    ratio_bits = exponent  # base-2 logarithm of the ratio, rounded up
    if mantissa == 0.5:  # a power of two
        ratio_bits = exponent - 1
    # One bit is left free, as the longest transit has about 2^bits ticks only.
    return min(MAX_TRANSIT_BITS, CLOCK_BITS - 1 - ratio_bits)


def default_horizon(
    longest: float, crossing_time: float, flight_time: float, share: float
) -> float:
    """Time that the clock of a run without a given end must be able to count, s.

    It is the largest of three: `HORIZON` times `share` longest transits,
    `MIN_ROW_CROSSINGS` crossings of the row, and `MIN_FLIGHTS` flights; but no more
    than a clock can count beside the longest transit.

    Parameters
    ----------
    longest : float
        The longest transit time, s.
    crossing_time : float
        Time to cross the whole row, s.
    flight_time : float
        Time to cross all gaps at the velocity scale, s.
    share : float
        Share of the `HORIZON` longest transits that is counted.
    """
    horizon = max(
        share * HORIZON * longest,
        MIN_ROW_CROSSINGS * crossing_time,
        MIN_FLIGHTS * flight_time,
    )
    return min(horizon, countable_time(longest))


def countable_time(longest: float) -> float:
    """Longest time that a clock can count beside this longest transit time, s."""
    return longest * 2.0 ** (CLOCK_BITS - 1 - MIN_TRANSIT_BITS)
