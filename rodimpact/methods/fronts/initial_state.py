"""From the numbers of a member to its clock, and to the fronts at t = 0.

The numbers of a member stand in this order, for n segments:

    wave speed [n], impedance [n], length [n],
    velocity of the frame, scale of velocities, gap [contact],
    and for each body, and for what drives an end, from `Segment.profile` on
        velocities, the places where they jump, strains, the places where these jump.

Places are m from the left end of a body; what drives an end has times, s, instead. All
durations follow the tick rule. The initial state is the history of the waves over one
transit before t = 0.
"""

import math
from typing import Any

from .. import tick_rule as rule
from ..laws import Beyond, Stop
from .records import NONE, Run, Segment, State

TOLERANCE = 2.0**-48
"""Smallest change of a wave that counts as a front, over the scale of velocities (their
spread plus wave speed times strain). The same margin decides whether contacts press or
graze. The error of a wave is at most this, times the number of ends it has passed."""

EXACT = 2.0**-48  # relative change of a transit time that is round-off
WINDOW = 40  # a gap that closes within 2^-40 longest transits of an arrival joins it


def frame_at(n: int) -> int:
    """Place of the velocity of the frame among the numbers of a row of n segments."""
    return 3 * n


def scale_at(n: int) -> int:
    """Place of the scale of velocities."""
    return 3 * n + 1


def gap_at(n: int, contact: int) -> int:
    """Place of a gap."""
    return 3 * n + 2 + contact


# The clock ----------------------------------------------------------------------------


def choose_clock(state: State, numbers: Any) -> None:
    """Choose the frame, the clock, and what counts as zero.

    Where there is no clock, `Run.stop` says why.
    """
    run = state.runs[0]
    pieces = state.pieces
    segments = state.segments
    n = len(segments) - 2
    run.proved = NONE
    run.frame = numbers[frame_at(n)]
    run.scale = numbers[scale_at(n)]
    durations = cut_at_jumps(numbers, pieces, segments)
    run.longest_time = 0.0
    for s in range(1, n + 1):
        run.longest_time = max(run.longest_time, pieces[s - 1].time)
    horizon = default_horizon(state, numbers)
    run.horizon = run.until if run.until >= 0 else horizon
    bits = rule.clock_bits(run.horizon / run.longest_time)
    set_drive_times(run, numbers, pieces, segments)
    for i in range(durations, len(pieces) - run.drive_jumps):
        pieces[i].time = run.longest_time  # fewer jumps inside than there might be
    longest_bits = max(bits, rule.COARSEST)
    same = same_durations(pieces) and run.longest_bits == longest_bits
    run.longest_bits = longest_bits
    if not same:
        run.longest_ticks = rule.assign_ticks(pieces, longest_bits, run.drive_jumps)
    run.tick = run.longest_time / run.longest_ticks
    run.window = max(1, run.longest_ticks >> WINDOW)
    run.tolerance = TOLERANCE * run.scale
    set_transits(run, numbers, pieces, segments)
    run.stop = why_no_clock(run, numbers, segments, bits)


def cut_at_jumps(numbers: Any, pieces: Any, segments: Any) -> int:
    """Cut the segments where a profile jumps; return the number of durations.

    Sets the time of each duration, velocity and strain of each piece, and the first
    piece of each segment. The duration up to the jump that begins piece i of segment s
    is at n + i - s.
    """
    n = len(segments) - 2
    body = segments[1]
    count = 0  # of pieces
    i = 0  # of the velocities of the body
    j = 0  # of its strains
    left = 0.0  # end of the segment, m from the left end of the body
    for s in range(1, n + 1):
        if segments[s].velocity_count > 0:
            body = segments[s]
            i = 0
            j = 0
            left = 0.0
        velocities = body.profile
        velocity_jumps = velocities + body.velocity_count
        strains = velocity_jumps + body.velocity_count - 1
        strain_jumps = strains + body.strain_count
        wave_speed = numbers[s - 1]
        length = numbers[2 * n + s - 1]
        transit_time = length / wave_speed
        pieces[s - 1].time = transit_time
        segments[s].first_piece = count
        right = left + length
        x = left
        inside = True
        while inside:
            while i < body.velocity_count - 1 and numbers[velocity_jumps + i] <= x:
                i += 1
            while j < body.strain_count - 1 and numbers[strain_jumps + j] <= x:
                j += 1
            pieces[count].velocity = numbers[velocities + i]
            pieces[count].strain = numbers[strains + j]
            if x > left:
                pieces[n + count - s].time = (x - left) / length * transit_time
            count += 1
            x = right
            if i < body.velocity_count - 1:
                x = min(x, numbers[velocity_jumps + i])
            if j < body.strain_count - 1:
                x = min(x, numbers[strain_jumps + j])
            inside = x < right
        left = right
    segments[n + 1].first_piece = count
    return count


def default_horizon(state: State, numbers: Any) -> float:
    """Time for which a clock without a given end has room, s."""
    run = state.runs[0]
    n = len(state.nodes) - 1
    crossing = 0.0
    for i in range(n):
        crossing += state.pieces[i].time
    flight = 0.0
    for node in state.nodes:
        if node.contact != NONE and run.scale > 0:
            flight += numbers[gap_at(n, node.contact)] / run.scale
    wanted = -run.until * rule.HORIZON * run.longest_time
    horizon: float = max(wanted, 16 * crossing, 4 * flight)
    most = run.longest_time * 2.0 ** (rule.CLOCK_BITS - 1 - rule.COARSEST)
    return min(horizon, most)


def jumps_of(outside: Segment) -> int:
    """How often what drives an end jumps."""
    if outside.outside == Beyond.STEADY:
        return 0
    return int(outside.velocity_count - 1)


def set_drive_times(run: Run, numbers: Any, pieces: Any, segments: Any) -> None:
    """Put the times at which drives jump at the end of the durations.

    For times that are not reached the longest of the others stands there.
    """
    last = len(segments) - 1
    run.drive_jumps = jumps_of(segments[0]) + jumps_of(segments[last])
    place = len(pieces) - run.drive_jumps
    for side in range(2):
        outside = segments[side * last]
        for j in range(jumps_of(outside)):
            time = numbers[outside.profile + outside.velocity_count + j]
            pieces[place].time = time if time <= run.until else run.longest_time
            place += 1


def same_durations(pieces: Any) -> bool:
    """Whether all durations are those of the member before, which are then counted.

    Neighbours in a family often share lengths.
    """
    same = True
    for piece in pieces:
        same = same and piece.known == piece.time
        piece.known = piece.time
    return same


def set_transits(run: Run, numbers: Any, pieces: Any, segments: Any) -> None:
    """Set transit time and mobility of the segments, and find the shortest."""
    n = len(segments) - 2
    run.shortest = 1
    for s in range(1, n + 1):
        segment = segments[s]
        segment.mobility = 1 / numbers[n + s - 1]
        segment.transit = pieces[s - 1].ticks
        if run.other_side:
            error = segment.transit * run.tick / pieces[s - 1].time - 1
            if error > EXACT:
                segment.transit -= 1
            elif error < -EXACT:
                segment.transit += 1
        if segment.transit < segments[run.shortest].transit:
            run.shortest = s


def why_no_clock(run: Run, numbers: Any, segments: Any, bits: int) -> int:
    """Why a member has no clock, as `laws.Stop`; NONE if it has one."""
    n = len(segments) - 2
    largest = 0.0
    for s in range(n):
        largest = max(largest, numbers[n + s])
    energy = run.scale * run.scale * largest * 2.0**rule.CLOCK_BITS
    if not energy < math.inf:
        return Stop.OVERFLOW.value
    if bits < rule.COARSEST:
        return Stop.LONG.value
    if segments[run.shortest].transit <= 4 * run.window:
        return Stop.SHORT.value
    return Stop.NONE.value


# Fronts at t = 0 ----------------------------------------------------------------------


def lay_out(state: State, numbers: Any) -> None:
    """Set the gaps, the end of the run, and the fronts that fill the row at t = 0.

    The clock is chosen; the log must have room.
    """
    run = state.runs[0]
    segments = state.segments
    n = len(segments) - 2
    for node in state.nodes:
        node.gap = 0.0
        if node.contact != NONE:
            node.gap = numbers[gap_at(n, node.contact)] / run.tick
    run.target = -1
    if run.until >= 0:
        run.target = round(run.until / run.tick)
    elif run.goes_on or run.momenta_change:
        run.target = -round_trip(segments)
    run.rows = 0
    for s in range(1, n + 1):
        add_initial_fronts(state, s, numbers[s - 1])
    place = len(state.pieces) - run.drive_jumps
    for side in range(2):
        outside = segments[side * (n + 1)]
        line = state.lines[side * (2 * n + 3)]
        line.arrived = 0.0
        if outside.velocity_count > 0 and outside.outside == Beyond.STEADY:
            line.arrived = numbers[outside.profile] - run.frame
        outside.mobility = 0.0
        if outside.outside == Beyond.ENDLESS:
            outside.mobility = segments[1 + side * (n - 1)].mobility
        if outside.outside != Beyond.STEADY:
            add_driven_fronts(state, side, numbers, place)
            place += jumps_of(outside)
    run.initial_rows = run.rows


def round_trip(segments: Any) -> int:
    """Ticks in which a wave goes through the longest body and back."""
    longest = 0
    span = 0
    for s in range(1, len(segments) - 1):
        if segments[s].velocity_count > 0:  # a body begins
            span = 0
        span += segments[s].transit
        longest = max(longest, span)
    return 2 * longest


def add_initial_fronts(state: State, s: int, wave_speed: float) -> None:
    """Add the fronts that fill segment s with its initial state to the log.

    The waves are a = v - c eps and b = v + c eps in the frame. What lies between x0 and
    x1, in ticks from the left end, left the right end T - x0 ago and the left one x1
    ago, T the transit time.
    """
    run = state.runs[0]
    pieces = state.pieces
    n = len(state.segments) - 2
    transit = state.segments[s].transit
    first = state.segments[s].first_piece
    end = state.segments[s + 1].first_piece
    for leftward in range(2):
        start = run.rows
        sign = 2 * leftward - 1
        for k in range(end - first):
            i = first + k if leftward else end - 1 - k
            piece = pieces[i]
            x0 = 0
            x1 = transit
            if i > first:
                x0 = min(pieces[n + i - s].ticks, transit)
            if i < end - 1:
                x1 = min(pieces[n + i + 1 - s].ticks, transit)
            wave = piece.velocity - run.frame + sign * wave_speed * piece.strain
            if x1 > x0:
                tick = x0 - transit if leftward else -x1
                append_front(run, state.log, start, tick, 2 * s + leftward, wave)


def add_driven_fronts(state: State, side: int, numbers: Any, place: int) -> None:
    """Add the fronts of what drives an end of the row to the log.

    They are velocities in the frame, or those that a force gives to the end, or what
    comes in through an endless bar: what left that end last, and the wave of which the
    strain is given. Its jumps are the durations from `place` on.
    """
    run = state.runs[0]
    log = state.log
    n = len(state.segments) - 2
    outside = state.segments[side * (n + 1)]
    end = 1 + side * (n - 1)  # segment at this end
    wave_speed = numbers[end - 1]
    left_last = 0.0
    for r in range(run.rows):
        if log[r].line == 2 + side * (2 * n - 1):
            left_last = log[r].value
    start = run.rows
    x1 = 0
    j = 0
    more = True
    while more:
        value = numbers[outside.profile + j]
        if outside.outside == Beyond.PUSHED:
            value *= state.segments[end].mobility
        elif outside.outside == Beyond.ENDLESS:
            value = (4 * side - 2) * wave_speed * value + left_last
        else:
            value -= run.frame
        x0 = x1
        more = False
        if j < outside.velocity_count - 1:
            time = numbers[outside.profile + outside.velocity_count + j]
            more = time <= run.until
        x1 = max(x0, state.pieces[place + j].ticks) if more else x0 + 1
        if x1 > x0:
            append_front(run, log, start, x0, side * (2 * n + 3), value)
        j += 1


def append_front(
    run: Run, log: Any, start: int, tick: int, line: int, value: float
) -> None:
    """Add a front to the log, unless it changes nothing.

    The first front of its line stands in the row `start`.
    """
    first = run.rows == start
    if first or abs(value - log[run.rows - 1].value) > run.tolerance:
        front = log[run.rows]
        front.tick = tick
        front.line = line
        front.value = value
        run.rows += 1
