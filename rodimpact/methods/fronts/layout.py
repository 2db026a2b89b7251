"""From the numbers of a collision to its clock: durations in whole ticks, and the waves at t = 0.

The initial state is the history of the waves over one transit before t = 0. A profile jumps at
places that follow the tick rule too, and so do the times at which what drives an end jumps.

The numbers of a member stand in one row of `given`: wave speed, impedance and length of each
segment, the velocity of the frame, the scale of velocities, the gaps, and the profiles of each
body, see `SEGMENT`. What holds or drives an end stands there like a body, with values over time.
"""

import math
from typing import Any

from .. import tick_rule as rule
from ..laws import Beyond, Stop
from .records import NONE

TOLERANCE = 2.0**-48
"""Smallest change of a wave that counts as a front, in units of the velocity scale (the spread of
the velocities plus wave speed times strain); the same margin decides whether contacts press or
graze. The error of a wave is at most this, times the number of ends it has passed."""

FRAME, GAPS = 0, 2  # places of these numbers behind those of the segments
EXACT = 2.0**-48  # relative change of a transit time that is round-off
WINDOW = 40  # a gap that closes within 2^-40 longest transits of an arrival closes with it


def cut(given: Any, row: int, piece: Any, segment: Any) -> int:
    """Cut the segments where a profile jumps; return the number of durations.

    Fills durations, and pieces with their velocity and strain; the duration of the jump that begins
    piece i of segment s is at n + i - s.
    """
    n, count, it, i, j, left = len(segment) - 2, 0, segment[1], 0, 0, 0.0
    for s in range(1, n + 1):
        if segment[s].velocities > 0:  # a body begins
            it, i, j, left = segment[s], 0, 0, 0.0
        v = row + it.profile
        e = v + 2 * it.velocities - 1
        at_v, at_e = v + it.velocities, e + it.strains
        c, L = given[row + s - 1], given[row + 2 * n + s - 1]
        right, x, more = left + L, left, True
        piece[s - 1].time, segment[s].piece = L / c, count
        while more:
            while i < it.velocities - 1 and given[at_v + i] <= x:
                i += 1
            while j < it.strains - 1 and given[at_e + j] <= x:
                j += 1
            piece[count].velocity, piece[count].strain = given[v + i], given[e + j]
            if x > left:
                piece[n + count - s].time = (x - left) / L * piece[s - 1].time
            count += 1
            x = right
            if i < it.velocities - 1:
                x = min(x, given[at_v + i])
            if j < it.strains - 1:
                x = min(x, given[at_e + j])
            more = x < right
        left = right
    segment[n + 1].piece = count
    return count


def room(run: Any, given: Any, piece: Any, node: Any, longest: float) -> float:
    """Time for which a clock without a given end has room: for a share of `HORIZON` at least."""
    n, crossing, flight = len(node) - 1, 0.0, 0.0
    for i in range(n):
        crossing += piece[i].time
    for k in range(n + 1):
        if node[k].contact != NONE and run.scale > 0:
            flight += given[run.row + 3 * n + GAPS + node[k].contact] / run.scale
    horizon: float = max(-run.until * rule.HORIZON * longest, 16 * crossing, 4 * flight)
    return min(horizon, longest * 2.0 ** (rule.CLOCK_BITS - 1 - rule.COARSEST))


def jumps_outside(it: Any) -> int:
    """How often what drives an end jumps."""
    return int(it.velocities - 1) if it.outside != Beyond.STEADY else 0


def drive_times(it: Any, given: Any, piece: Any, segment: Any) -> int:
    """Put the times at which drives jump at the end of the durations; return how many there are.

    For times that are not reached the longest of the others stands there.
    """
    ends = len(segment) - 1
    late = jumps_outside(segment[0]) + jumps_outside(segment[ends])
    place = len(piece) - late
    for side in range(2):
        outside = segment[side * ends]
        for j in range(jumps_outside(outside)):
            at = given[it.row + outside.profile + outside.velocities + j]
            piece[place].time = at if at <= it.until else it.longest
            place += 1
    return late


def drive(
    run: Any, side: int, given: Any, place: int, piece: Any, segment: Any, log: Any
) -> None:
    """Add the fronts of what drives an end of the row to the log.

    They are velocities in the frame, or those that a force gives to the end; or what comes in
    through an endless bar: what left that end last, and the wave of which the strain is given.
    Times of jumps are the durations from `place` on.
    """
    n, sent, j, x1, more, came = len(segment) - 2, run.rows, 0, 0, True, 0.0
    it, end = segment[side * (n + 1)], 1 + side * (n - 1)
    values = run.row + it.profile
    at = values + it.velocities
    for r in range(run.rows):
        if log[r].line == 2 + side * (2 * n - 1):
            came = log[r].value
    while more:
        value, x0 = given[values + j], x1
        if it.outside == Beyond.PUSHED:
            value *= segment[end].mobility
        elif it.outside == Beyond.ENDLESS:
            value = (4 * side - 2) * given[run.row + end - 1] * value + came
        else:
            value -= run.frame
        more = j < it.velocities - 1 and given[at + j] <= run.until
        x1 = max(x0, piece[place + j].ticks) if more else x0 + 1
        if x1 > x0:
            send(run, log, sent, x0, side * (2 * n + 3), value)
        j += 1


def send(run: Any, log: Any, sent: int, tick: int, line: int, value: float) -> None:
    """Add a front to the log, unless it changes nothing after the row `sent`, its line's first."""
    if run.rows == sent or abs(value - log[run.rows - 1].value) > run.tolerance:
        new = log[run.rows]
        new.tick, new.line, new.value = tick, line, value
        run.rows += 1


def fill(run: Any, c: float, s: int, piece: Any, segment: Any, log: Any) -> None:
    """Add the fronts that fill segment s with its initial state to the log.

    Waves a = v - c eps and b = v + c eps in the frame; a piece from x0 to x1 ticks left T - x0 ago
    at the right end and x1 ago at the left one.
    """
    n, T, first, end = len(segment) - 2, segment[s].transit, segment[s].piece, segment[s + 1].piece
    for b in range(2):
        sent, sign = run.rows, 2 * b - 1
        for k in range(end - first):
            i = first + k if b else end - 1 - k
            x0 = min(piece[n + i - s].ticks, T) if i > first else 0
            x1 = min(piece[n + i + 1 - s].ticks, T) if i < end - 1 else T
            wave = piece[i].velocity - run.frame + sign * c * piece[i].strain
            if x1 > x0:
                send(run, log, sent, x0 - T if b else -x1, 2 * s + b, wave)


def round_trip(segment: Any) -> int:
    """Ticks in which a wave goes through the longest body and back."""
    longest = span = 0
    for s in range(1, len(segment) - 1):
        span = segment[s].transit + (0 if segment[s].velocities > 0 else span)
        longest = max(longest, span)
    return 2 * longest


def choose_clock(it: Any, given: Any, piece: Any, segment: Any, node: Any) -> None:
    """Choose the frame, the clock and what counts as zero; arguments as of `lay_out`.

    Where there is no clock, `stop` says why.
    """
    n, row, it.proved = len(segment) - 2, it.row, NONE
    it.frame, it.scale = given[row + 3 * n + FRAME], given[row + 3 * n + FRAME + 1]
    durations = cut(given, row, piece, segment)
    largest, it.longest = 0.0, 0.0
    for s in range(1, n + 1):
        largest = max(largest, given[row + n + s - 1])
        it.longest = max(it.longest, piece[s - 1].time)
    spare = room(it, given, piece, node, it.longest)
    it.horizon = it.until if it.until >= 0 else spare
    bits = rule.clock_bits(it.horizon / it.longest)
    taken = max(bits, rule.COARSEST)
    it.late = drive_times(it, given, piece, segment)
    for i in range(durations, len(piece) - it.late):
        piece[i].time = it.longest  # fewer jumps inside than there might be
    known, it.bits = it.bits == taken, taken
    for i in range(len(piece)):  # neighbours in a family often share lengths
        known = known and piece[i].known == piece[i].time
        piece[i].known = piece[i].time
    it.total = it.total if known else rule.assign_ticks(piece, it.bits, it.late)
    it.tick, it.window = it.longest / it.total, max(1, it.total >> WINDOW)
    it.tolerance, it.short = TOLERANCE * it.scale, 1
    for s in range(1, n + 1):
        segment[s].transit, segment[s].mobility = piece[s - 1].ticks, 1 / given[row + n + s - 1]
        if it.beside:  # the next tick on the other side of the true time
            off = segment[s].transit * it.tick / piece[s - 1].time - 1
            if abs(off) > EXACT:
                segment[s].transit += -1 if off > 0 else 1
        if segment[s].transit < segment[it.short].transit:
            it.short = s
    it.stop, shortest = Stop.NONE.value, segment[it.short].transit
    if not it.scale * it.scale * largest * 2.0**rule.CLOCK_BITS < math.inf:
        it.stop = Stop.OVERFLOW.value
    elif bits < rule.COARSEST:
        it.stop = Stop.LONG.value
    elif shortest <= 4 * it.window:
        it.stop = Stop.SHORT.value


def lay_out(
    it: Any, given: Any, piece: Any, segment: Any, node: Any, line: Any, log: Any
) -> None:
    """Lay out a member on its clock, and fill the log with its waves at t = 0.

    Parameters
    ----------
    it : RUN
        With its clock.
    given : [member * numbers]
    piece : [duration] PIECE
        Work space.
    segment : [n + 2] SEGMENT
        Whose profiles are given.
    node : [n + 1] NODE
        Whose `kind` and `contact` are given.
    line : [2 n + 4] LINE
    log : ROW
        With room for all fronts at t = 0.
    """
    n, row, it.rows = len(segment) - 2, it.row, 0
    segment[0].mobility = segment[n + 1].mobility = 0.0
    for k in range(n + 1):
        node[k].gap = 0.0
        if node[k].contact != NONE:
            node[k].gap = given[row + 3 * n + GAPS + node[k].contact] / it.tick
    for side in range(2):
        one, l = segment[side * (n + 1)], side * (2 * n + 3)
        line[l].arrived = 0.0
        if one.velocities > 0 and one.outside == Beyond.STEADY:
            line[l].arrived = given[row + one.profile] - it.frame
    it.target = -1
    if it.until >= 0:
        it.target = round(it.until / it.tick)
    elif it.further or it.lasting:
        it.target = -round_trip(segment)
    for s in range(1, n + 1):
        fill(it, given[row + s - 1], s, piece, segment, log)
    place = len(piece) - it.late
    for side in range(2):
        one = segment[side * (n + 1)]
        if one.outside == Beyond.ENDLESS:
            one.mobility = segment[1 + side * (n - 1)].mobility
        if one.outside != Beyond.STEADY:
            drive(it, side, given, place, piece, segment, log)
            place += jumps_outside(one)
    it.started = it.rows
