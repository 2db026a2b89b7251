"""The tick rule: durations in whole ticks of a clock that all of them share.

Waves that took different paths meet at the same instant only if times are integers.
Durations in the ratio of small whole numbers (0.3 m and 0.1 m of one steel) are
recognised and keep that ratio exactly; the others are rounded to the nearest tick.

Durations form classes. The leader of a class is the longest duration that is in no
class yet; the other members are the durations in a simple ratio to the leader.
"""

import math
from collections.abc import Sequence

from .record_lists import dtype_of

MAX_TERM = 1 << 20  # largest numerator or denominator of a recognised ratio
RATIO_RTOL = 4.0 * 2.0**-52  # round-off in a ratio of two quotients of floats
MAX_PARTS = 1 << 40  # largest number of equal parts of the longest duration
DIVISIBLE = 720720  # lcm of 1 to 16: its multiples can be divided by each of them
MIN_UNIT = 2.0**40  # least ticks in a part of a further class: rounding is below 2^-41

CLOCK_BITS = 62  # ticks end at 2^62

# Without a given end, the clock of a run counts at least these multiples.
HORIZON = 4096  # longest transits
MIN_ROW_CROSSINGS = 16  # crossings of the whole row by a wave
MIN_FLIGHTS = 4  # crossings of all gaps at the velocity scale

MAX_TRANSIT_BITS = 50  # the longest transit has about 2^50 ticks at most
MIN_TRANSIT_BITS = 20  # and about 2^20 ticks at least


class Duration:
    """A duration to be counted in ticks."""

    time: float  # s
    ticks: int
    sorted_index: int  # of record i: index of the i-th longest duration
    # Ratio p/q to the leader of its class; q = 0: no ratio is found, q < 0: the ticks
    # are set
    p: int
    q: int


DURATION = dtype_of(Duration)


def recognise(x: float) -> tuple[int, int]:
    """Recover x = p/q by its continued fraction x = a0 + 1/(a1 + 1/(a2 + ...)).

    The convergents of the fraction are tried in order; the first one that is close
    enough to x is returned.

    Parameters
    ----------
    x : float
        Positive.

    Returns
    -------
    p, q : int
        Whole numbers up to 2^20 with abs(x - p/q) <= 4 * 2^-52 * x; (0, 0) if no
        convergent is such a ratio.
    """
    # p2/q2 = (a p1 + p0)/(a q1 + q0) is the convergent after p1/q1 and p0/q0. The
    # recurrence begins with 1/0 and 0/1.
    p0 = 0
    q0 = 1
    p1 = 1
    q1 = 0
    y = x  # remainder, from which the next term follows
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
        # abs(x - p/q) <= RATIO_RTOL x, multiplied by q
        if abs(x * q1 - p1) <= RATIO_RTOL * x * q1:
            return p1, q1
        if y == a:  # the fraction ends, without an accurate convergent
            return 0, 0
        y = 1.0 / (y - a)
    return 0, 0


def find_class(durations: Sequence[Duration], start: int, max_parts: int) -> int:
    """Find the class of the longest duration without ticks, which is its leader.

    The leader gets the ratio p/q = 1/1. Each later duration without ticks gets its
    ratio p/q to the leader if it is a member of the class, otherwise q = 0. No ticks
    are set here.

    Parameters
    ----------
    durations : [n] Duration
        In any order. Their field `sorted_index` holds the sorted order, apart from the
        durations themselves: durations[i].sorted_index is the index of the i-th
        longest. A duration with ticks has q < 0.
    start : int
        Position of the leader in the order by decreasing time.
    max_parts : int
        Largest number of parts allowed: a duration that needs more is no member.

    Returns
    -------
    int
        Number of equal parts into which the leader is divided, so that each member is a
        whole number of parts.
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
                # p/q of the leader is whole if the number of parts is a multiple of q.
                common_parts = parts // math.gcd(parts, q) * q  # least common multiple
                if common_parts <= max_parts:
                    parts = common_parts
                else:
                    other.q = 0  # too many parts: it is no member
    return parts


def sort_durations(durations: Sequence[Duration], drive_count: int) -> None:
    """Set `sorted_index`, the order by decreasing time, and reset each class (q = 0).

    No record moves: durations[i].sorted_index becomes the index of the i-th longest.
    Equal times keep their order. The last `drive_count` durations, times of drives, are
    sorted separately and come after all others, even if they are longer.
    """
    n = len(durations)
    for i in range(n):  # insertion sort: the durations before i are in order
        first = 0  # first position that duration i may take
        if i >= n - drive_count:
            first = n - drive_count
        j = i  # position of duration i in the order
        while j > first:
            previous = durations[j - 1].sorted_index
            if durations[previous].time >= durations[i].time:
                break
            durations[j].sorted_index = previous
            j -= 1
        durations[j].sorted_index = i
        durations[i].q = 0


def assign_ticks(durations: Sequence[Duration], bits: int, drive_count: int = 0) -> int:
    """Set `ticks` of each duration; return the ticks of the longest, about 2^bits.

    The longest duration, times of drives excepted, defines the tick: it has the
    returned number of ticks. Durations in simple ratios form a class, whose members are
    whole multiples of a unit. The class of the longest duration is exact, and its unit
    can be divided by 1 to 16, so that gaps that close at simple fractions of it close
    at whole ticks. The unit of any other class is rounded to whole ticks, at least
    2^40. A duration too short to lead such a class is rounded by at most half a tick.

    Parameters
    ----------
    durations : [n] Duration
        One or more. Times are positive, in any order and any unit.
    bits : int
        Base-2 logarithm of the ticks wanted for the longest duration.
    drive_count : int
        Number of durations at the end that are times of drives. They may be longer than
        the longest of the others, and never lead a class that contains a transit.
    """
    sort_durations(durations, drive_count)
    longest_ticks = 0
    longest_time = durations[durations[0].sorted_index].time
    for start in range(len(durations)):  # by decreasing time, drives after all others
        leader = durations[durations[start].sorted_index]
        # q < 0 means that the ticks are set. `find_class` sets p/q of the members of a
        # class, and q = 0 for the other durations without ticks.
        if leader.q < 0:
            continue
        # Ticks of the leader before rounding; not used for the first class
        exact_ticks = leader.time / longest_time * longest_ticks
        if start == 0:
            max_parts = MAX_PARTS
        else:
            max_parts = int(exact_ticks / MIN_UNIT)  # a part has MIN_UNIT ticks or more
        if max_parts == 0:  # too short to lead a class: it is rounded by itself
            leader.ticks = int(exact_ticks + 0.5)  # to the nearest tick
            leader.q = -1
            continue
        parts = find_class(durations, start, max_parts)
        # The unit of the class is the ticks of a part of its leader.
        if start == 0:
            unit = max(1, ((1 << bits) + parts // 2) // parts)  # 2^bits/parts, rounded
            if unit > DIVISIBLE * DIVISIBLE:
                # Round down to a multiple of DIVISIBLE: a relative change of at most
                # 1/DIVISIBLE.
                unit -= unit % DIVISIBLE
            longest_ticks = unit * parts
        else:
            unit = int(exact_ticks / parts + 0.5)  # to the nearest tick
        for i in range(start, len(durations)):
            member = durations[durations[i].sorted_index]
            # A member, like the leader with 1/1, is p/q of the leader: `parts` p/q
            # units.
            if member.q > 0:
                member.ticks = unit * (parts // member.q) * member.p
                member.q = -1
    return longest_ticks


def clock_bits(ratio: float) -> int:
    """Base-2 logarithm of the longest transit in ticks, for a run of `ratio` transits.

    It is at most `MAX_TRANSIT_BITS`, and so small that the run takes no more than
    2^CLOCK_BITS ticks. If it is below `MIN_TRANSIT_BITS`, no clock counts the run. It
    may be negative, and is 0 if the ratio is negative, infinite or nan.
    """
    if ratio == 0:
        return MAX_TRANSIT_BITS
    if not 0 < ratio < math.inf:
        return 0
    # ratio = mantissa 2^exponent, with 1/2 <= mantissa < 1
    mantissa, exponent = math.frexp(ratio)
    ratio_bits = exponent  # base-2 logarithm of the ratio, rounded up
    if mantissa == 0.5:  # a power of two: 2^(exponent - 1)
        ratio_bits = exponent - 1
    # One bit is spare, as the longest transit may have some more than 2^bits ticks.
    return min(MAX_TRANSIT_BITS, CLOCK_BITS - 1 - ratio_bits)


def default_horizon(
    longest: float, crossing_time: float, flight_time: float, share: float
) -> float:
    """Time that the clock of a run without a given end must be able to count, s.

    It is the longest of three times: `share` times `HORIZON` longest transits,
    `MIN_ROW_CROSSINGS` crossings of the row, and `MIN_FLIGHTS` flights; but at most
    `countable_time`.

    Parameters
    ----------
    longest : float
        The longest transit time, s.
    crossing_time : float
        Time to cross the whole row, s.
    flight_time : float
        Time to cross all gaps at the velocity scale, s.
    share : float
        Share of the `HORIZON` longest transits, from 0 to 1: below 1 on the web page,
        whose clock has fewer ticks.
    """
    horizon = max(
        share * HORIZON * longest,
        MIN_ROW_CROSSINGS * crossing_time,
        MIN_FLIGHTS * flight_time,
    )
    return min(horizon, countable_time(longest))


def countable_time(longest: float) -> float:
    """Longest time that a clock can count if the longest transit time is `longest`, s.

    Then the longest transit has the fewest ticks allowed, 2^MIN_TRANSIT_BITS.
    """
    # One bit is spare, see `clock_bits`.
    return longest * 2.0 ** (CLOCK_BITS - 1 - MIN_TRANSIT_BITS)
