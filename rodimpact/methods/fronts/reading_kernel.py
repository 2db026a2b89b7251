"""What is read off the waves of a finished run, besides its totals: displacements and stresses.

It takes a walk through all fronts of a run, so it is done only where it is asked for. The fronts of
a line are chained: `after` is the next one of the same line. Times are ticks.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from .front_kernel import FULL, NOW, GroupState, Log, Results, State, Tally, run_member


class Reading(NamedTuple):
    """What was read of the members, in the units of their numbers; in rows, one a member."""

    time: Any  # [member] at the end, s
    moved: Any  # [member * segments] displacement of the centre of mass at the end
    parted: Any  # [member * segments] largest difference of the two waves that meet anywhere


def time_inside(tick: int, T: int, end: int) -> Any:
    """Time within [0, end] for which waves that left before `tick` are under way, summed over them.

    A wave is under way for T. The unit is T^2: as whole numbers such squares overflow.
    """
    per = 1.0 / T
    most, span = min(T, end) * per, (end + T) * per
    x = (tick + T) * per
    if x <= most:  # waves that left before t = 0, or after end - T, are cut off
        return x * x / 2
    if x <= span - most:
        return most * (x - most / 2)
    return most * (span - most) - (span - x) * (span - x) / 2


def carried(tick: Any, after: Any, value: Any, first: int, T: int, end: int) -> Any:
    """Twice the displacement that the waves of a line, from row `first` on, give to a segment.

    It is that of the centre of mass in [0, end], velocity times ticks: the integral of the wave
    over the segment, over its length, over time.
    """
    total, r = 0 * value[first], first
    while r >= 0:
        stop = end
        if after[r] >= 0:
            stop = min(tick[after[r]], end)
        if stop > tick[r]:
            total += value[r] * (time_inside(stop, T, end) - time_inside(tick[r], T, end)) * T
        r = after[r]
    return total


def largest_difference(
    tick: Any, after: Any, value: Any, firsts: tuple[int, int], T: int, end: int, window: int
) -> Any:
    """Largest absolute difference of two waves where they meet in a segment, between 0 and `end`.

    Waves that leave the two ends at p and q meet at (p + q + T)/2 if abs(p - q) < T.

    Parameters
    ----------
    tick, after, value
        Fronts: when each left its end, the next of its line or -1, and the wave behind it.
    firsts : (int, int)
        First fronts of the two lines.
    T, end : int
        Transit time of the segment, end of the run.
    window : int
        Waves that last no longer come of round-off, and do not count.
    """
    a, b = firsts
    largest = abs(0 * value[a])
    while a >= 0:
        a0, a1 = tick[a], end
        if after[a] >= 0:
            a1 = min(tick[after[a]], end)
        while after[b] >= 0 and tick[after[b]] <= a0 - T:  # has left before this wave sets out
            b = after[b]
        r = b
        while r >= 0 and tick[r] < a1 + T and a1 - a0 > window:
            b0, b1 = tick[r], end
            if after[r] >= 0:
                b1 = min(tick[after[r]], end)
            # the parts of both waves that meet at all, and whether that is not before 0 or after
            # the end; sums of two ticks could overflow
            low_a, low_b = max(a0, b0 - T), max(b0, a0 - T)
            high_a, high_b = min(a1, b1 + T), min(b1, a1 + T)
            meet = low_a < high_a and low_b < high_b and high_a > -T - high_b
            if meet and b1 - b0 > window and low_a - end < end - T - low_b:
                largest = max(largest, abs(value[r] - value[a]))
            r = after[r]
        a = after[a]
    return largest


def read_member(
    state: State, log: Log, clock: Any, members: Any, reading: Reading, m: int
) -> None:
    """Read the waves of member m, whose run is finished; the heads of the lines are lost."""
    head, segments = state.head, len(state.transit)
    fronts = len(members.tick) // len(members.count)
    for l in range(len(head)):
        head[l] = -1
    for r in range(members.count[m] - 1, -1, -1):  # what fills the row at t = 0 stands first
        head[members.line[m * fronts + r]] = r
    end = clock[NOW]
    reading.time[m] = end * members.tick_seconds[m]
    for s in range(1, segments - 1):
        T, a, b = state.transit[s], head[2 * s], head[2 * s + 1]
        moved = carried(log.tick, log.after, log.value, a, T, end)
        moved += carried(log.tick, log.after, log.value, b, T, end)
        reading.moved[m * segments + s] = (
            (moved / 2 + members.frame[m] * end) * members.tick_seconds[m]
        )
        reading.parted[m * segments + s] = largest_difference(
            log.tick, log.after, log.value, (a, b), T, end, members.window[m]
        )


def family_with_reading(
    state: State, tally: Tally, log: Log, clock: Any, stocks: tuple[GroupState, GroupState],
    members: Any, status: Any, limit: int, results: tuple[Results, Reading],
) -> None:
    """Run every member as `family` does, and read its waves."""
    for m in range(len(members.count)):
        run_member(state, tally, log, clock, stocks, members, status, limit, results[0], m)
        if results[0].flag[m] != FULL:
            read_member(state, log, clock, members, results[1], m)
