"""From the values of a member to its clock, and to the fronts at t = 0.

The values of a member stand in this order, for n segments:

    wave speed [n], impedance [n], length [n],
    velocity of the frame, velocity scale, gap [contact],
    and for each body and each drive of an end, from `Segment.profile_offset` on,
        velocities, positions of their jumps, strains, positions of their jumps.

Positions are in m from the left end of the body. For a drive they are times, s, and its
values (velocities, forces or strains) replace the velocities. All durations follow the
tick rule. The initial state is the history of the waves over one transit before t = 0.
"""

import math
from collections.abc import Sequence

from .. import tick_rule as rule
from ..states import BoundaryKind, Stop
from .records import (
    NONE,
    Amplitude,
    CachedDuration,
    InitialPiece,
    Log,
    Run,
    Segment,
    State,
    Values,
)

FRONT_VELOCITY_RTOL = 2.0**-48
"""Smallest change of a wave that counts as a front, relative to the velocity scale.

That scale is the spread of the velocities, plus wave speed times strain, plus force
over impedance, see `scales.scale_of`. The same tolerance decides whether contacts press
or graze. The error of a wave is at most this tolerance times the number of ends that it
has passed.
"""

TRANSIT_RTOL = 2.0**-48  # a smaller relative change of a transit time is round-off
ROUND_OFF_WINDOW_BITS = 40
"""Times that differ by 2^-40 longest transits or less differ by round-off.

If a gap closes so shortly before an arrival, the closing is moved to the arrival.
Otherwise the round-off between both times makes waves one tick wide, which multiply.
"""
MIN_TRANSIT_WINDOWS = 4  # a transit must exceed this number of round-off windows


def frame_index(n: int) -> int:
    """Index of the velocity of the frame among the values of a row of n segments."""
    return 3 * n


def scale_index(n: int) -> int:
    """Index of the velocity scale among the values of a row of n segments."""
    return 3 * n + 1


def gap_index(n: int, contact: int) -> int:
    """Index of the gap of a contact among the values of a row of n segments."""
    return 3 * n + 2 + contact


# Ends of the row: 0 is the left one, 1 the right one ----------------------------------


def segment_outside(n: int, side: int) -> int:
    """Number of the segment outside the left (0) or right (1) end of n segments."""
    return side * (n + 1)


def segment_at_end(n: int, side: int) -> int:
    """Number of the segment at the left (0) or right (1) end of n segments."""
    return 1 + side * (n - 1)


def line_from_outside(n: int, side: int) -> int:
    """Line on which waves come to an end of n segments from outside: 0 or 2 n + 3."""
    # Segment s has the lines 2 s to the right and 2 s + 1 to the left. The lines are
    # the one to the right outside (s = 0), or the one to the left outside (s = n + 1).
    return side * (2 * n + 3)


def line_inward(n: int, side: int) -> int:
    """Line on which an end of n segments sends waves inward: 2 or 2 n + 1."""
    # The line to the right in segment 1, or the line to the left in segment n
    return 2 + side * (2 * n - 1)


# The clock ----------------------------------------------------------------------------


def choose_clock(state: State, values: Values) -> None:
    """Set the frame, the clock and the tolerances of a member from its values.

    Transit and mobility of the segments, all durations and the pieces of the initial
    state are set, too. The clock counts transit times, times to jumps of the initial
    state, and times at which drives jump. If all of them equal those of the previous
    member, its ticks are kept. `Run.stop_reason` becomes NONE; if the member has no
    clock, it becomes OVERFLOW, LONG or SHORT, see `find_clock_fault`.
    """
    run = state.runs[0]
    durations = state.durations
    segments = state.segments
    n = len(segments) - 2
    run.proved_tick = NONE
    run.frame_velocity = values[frame_index(n)]
    run.velocity_scale = values[scale_index(n)]
    segment_durations = split_at_jumps(state, values)  # number of durations set here
    run.longest_transit_time = 0.0
    for s in range(1, n + 1):
        run.longest_transit_time = max(run.longest_transit_time, durations[s - 1].time)
    # This call does not depend on `until`, for speed only: machine code counts the
    # references to an array whose last use is behind a condition, here `values`.
    run.horizon = default_horizon(state, values)
    if run.until >= 0:
        run.horizon = run.until
    # Base-2 logarithm of the longest transit in ticks. If the run is too long for a
    # clock it is below `MIN_TRANSIT_BITS`, and `find_clock_fault` returns LONG.
    bits = rule.clock_bits(run.horizon / run.longest_transit_time)
    set_drive_times(run, values, durations, segments)
    # The entries between segments and drives are unused: other members of the family
    # have more jumps. They get a time that is a duration already.
    for i in range(segment_durations, len(durations) - run.drive_jump_count):
        durations[i].time = run.longest_transit_time
    longest_bits = max(bits, rule.MIN_TRANSIT_BITS)
    # `same_durations` comes first: it also stores the durations for the next member.
    is_unchanged = same_durations(durations) and run.longest_bits == longest_bits
    run.longest_bits = longest_bits
    if not is_unchanged:
        run.longest_ticks = rule.assign_ticks(
            durations, longest_bits, run.drive_jump_count
        )
    run.tick_duration = run.longest_transit_time / run.longest_ticks
    run.round_off_window = max(1, run.longest_ticks >> ROUND_OFF_WINDOW_BITS)
    run.velocity_tolerance = FRONT_VELOCITY_RTOL * run.velocity_scale
    set_transits(run, values, durations, segments)
    run.stop_reason = find_clock_fault(run, values, segments, bits)


def split_at_jumps(state: State, values: Values) -> int:
    """Split the segments into pieces where a profile jumps; return the piece count.

    Each piece sets one duration, so that the same number of durations is set. The first
    piece of segment s sets the transit time of the segment: duration s - 1. Any other
    piece begins at a jump, and sets the time that a wave takes from the left end of the
    segment to this jump: duration n + p - s for piece p, counted over all segments.
    Velocity and strain of each piece, and `first_piece` of each segment, are set, too.
    """
    durations = state.durations
    pieces = state.initial_pieces
    segments = state.segments
    n = len(segments) - 2
    body = segments[1]  # first segment of the present body
    piece_count = 0
    i = 0  # index of the present velocity among those of the body
    j = 0  # index of the present strain
    left = 0.0  # left end of the segment, m from the left end of the body
    for s in range(1, n + 1):
        if segments[s].velocity_count > 0:  # a body begins
            body = segments[s]
            i = 0
            j = 0
            left = 0.0
        # Indices at which the four lists of the body begin among the values. There is
        # one jump less than velocities or strains.
        velocities = body.profile_offset
        velocity_jumps = velocities + body.velocity_count
        strains = velocity_jumps + body.velocity_count - 1
        strain_jumps = strains + body.strain_count
        wave_speed = values[s - 1]  # wave speeds come first among the values
        length_index = 2 * n + s - 1  # n wave speeds and n impedances come first
        length = values[length_index]
        transit_time = length / wave_speed
        durations[s - 1].time = transit_time
        segments[s].first_piece = piece_count
        right = left + length
        x = left  # left end of the present piece
        is_inside = True
        while is_inside:
            # Go on to the velocity and the strain that hold from x on. Velocity i ends
            # at jump i; the last velocity has no jump. It is the same for strains.
            while i < body.velocity_count - 1 and values[velocity_jumps + i] <= x:
                i += 1
            while j < body.strain_count - 1 and values[strain_jumps + j] <= x:
                j += 1
            pieces[piece_count].velocity = values[velocities + i]
            pieces[piece_count].strain = values[strains + j]
            if x > left:
                time_to_jump = (x - left) / length * transit_time
                # The n transit times come first. Of the `piece_count` pieces before
                # this one, s are the first of a segment, and begin at no jump.
                jump_index = n + piece_count - s
                durations[jump_index].time = time_to_jump
            piece_count += 1
            # The next piece begins at the next jump, if that is inside the segment.
            next_x = right
            if i < body.velocity_count - 1:
                next_x = min(next_x, values[velocity_jumps + i])
            if j < body.strain_count - 1:
                next_x = min(next_x, values[strain_jumps + j])
            x = next_x
            is_inside = x < right
        left = right
    segments[n + 1].first_piece = piece_count
    return piece_count


def default_horizon(state: State, values: Values) -> float:
    """Time that the clock of a run without a given end must be able to count, s.

    `tick_rule.default_horizon` computes it from the longest transit time, the time of a
    wave through the whole row, and the time to cross all gaps at the velocity scale (0
    if that is 0). The transit times must be set. If an end is given (`until` >= 0), the
    result is meaningless. Nothing is changed.
    """
    run = state.runs[0]
    n = len(state.nodes) - 1
    crossing_time = 0.0  # time of a wave through the whole row
    for i in range(n):  # the first n durations are the transit times
        crossing_time += state.durations[i].time
    flight_time = 0.0  # time to cross all gaps at the velocity scale
    for node in state.nodes:
        if node.contact != NONE and run.velocity_scale > 0:
            flight_time += values[gap_index(n, node.contact)] / run.velocity_scale
    longest = run.longest_transit_time
    # Without a given end, `until` is minus the share of `tick_rule.HORIZON` transits.
    share = -run.until
    return rule.default_horizon(longest, crossing_time, flight_time, share)


def drive_jumps(outside: Segment) -> int:
    """Number of jumps of the drive of an end; 0 for a wall or an end without a drive.

    `outside` is the segment outside this end.
    """
    if outside.boundary_kind == BoundaryKind.STEADY:
        return 0
    # Between the values of a drive there is one jump less than values.
    return int(outside.velocity_count - 1)


def set_drive_times(
    run: Run,
    values: Values,
    durations: Sequence[CachedDuration],
    segments: Sequence[Segment],
) -> None:
    """Set the last durations: the times at which drives jump, s, left end first.

    A run with drives always has a given end. A jump after that end gets the longest
    transit time instead of its own: this is a duration already, so that such a jump
    does not affect the clock. `drive_jump_count` of the run is set, too.
    """
    last_segment = len(segments) - 1  # it lies outside the row, as segment 0 does
    jumps_left = drive_jumps(segments[0])
    jumps_right = drive_jumps(segments[last_segment])
    run.drive_jump_count = jumps_left + jumps_right
    i = len(durations) - run.drive_jump_count
    for side in range(2):
        outside = segments[side * last_segment]
        for j in range(drive_jumps(outside)):
            # The times of the jumps follow the values of the drive, of which
            # `velocity_count` is the number.
            time = values[outside.profile_offset + outside.velocity_count + j]
            if time > run.until:
                time = run.longest_transit_time
            durations[i].time = time
            i += 1


def same_durations(durations: Sequence[CachedDuration]) -> bool:
    """Whether all durations equal those of the previous member, so that its ticks hold.

    This is common: neighbours in a family often share lengths. `cached_time` of every
    duration becomes its `time`, for the comparison with the next member.
    """
    same = True
    for duration in durations:  # to the last one, as each is stored
        same = same and duration.cached_time == duration.time
        duration.cached_time = duration.time
    return same


def set_transits(
    run: Run,
    values: Values,
    durations: Sequence[CachedDuration],
    segments: Sequence[Segment],
) -> None:
    """Set transit and mobility of the segments, and `shortest_segment` of the run.

    Transits are the ticks of the first n durations, of n segments. If
    `perturb_rounding` of the run is 1, a transit that was rounded by more than
    `TRANSIT_RTOL` is rounded the other way: one that was rounded up becomes a tick
    shorter, one rounded down a tick longer.
    """
    n = len(segments) - 2
    run.shortest_segment = 1
    for s in range(1, n + 1):
        segment = segments[s]
        impedance_index = n + s - 1  # the impedances follow n wave speeds
        segment.mobility = 1 / values[impedance_index]
        segment.transit = durations[s - 1].ticks
        if run.perturb_rounding:
            # Relative change of the transit time by its rounding
            change = segment.transit * run.tick_duration / durations[s - 1].time - 1
            if change > TRANSIT_RTOL:  # rounded up
                segment.transit -= 1
            elif change < -TRANSIT_RTOL:  # rounded down
                segment.transit += 1
        if segment.transit < segments[run.shortest_segment].transit:
            run.shortest_segment = s


def find_clock_fault(
    run: Run, values: Values, segments: Sequence[Segment], bits: int
) -> int:
    """Why a member has no clock, as `states.Stop`; Stop.NONE if it has one.

    The reasons are checked in this order. OVERFLOW: energies could exceed the largest
    float. LONG: the run is too long, so that `bits`, the base-2 logarithm of the
    longest transit in ticks, is below `MIN_TRANSIT_BITS`. SHORT: the shortest transit
    is at most `MIN_TRANSIT_WINDOWS` round-off windows.
    """
    n = len(segments) - 2
    max_impedance = 0.0
    for s in range(n):
        impedance = values[n + s]  # the impedances follow n wave speeds
        max_impedance = max(max_impedance, impedance)
    # Energies are Z v^2 times ticks, with fewer than 2^CLOCK_BITS ticks.
    max_energy = (
        run.velocity_scale * run.velocity_scale * max_impedance * 2.0**rule.CLOCK_BITS
    )
    if not max_energy < math.inf:  # `not <` is true for nan, too
        return Stop.OVERFLOW.value
    if bits < rule.MIN_TRANSIT_BITS:
        return Stop.LONG.value
    shortest_transit = segments[run.shortest_segment].transit
    if shortest_transit <= MIN_TRANSIT_WINDOWS * run.round_off_window:
        return Stop.SHORT.value
    return Stop.NONE.value


# Fronts at t = 0 ----------------------------------------------------------------------


def initialise_member(state: State, values: Values) -> None:
    """Set the gaps, the end of the run, and the fronts that fill the row at t = 0.

    Both segments outside the row get their mobility: that of the outermost segment for
    a semi-infinite bar, else 0. The line from a wall or a fixed end gets its constant
    wave, that from a free end the wave 0; for a driven end, the fronts of the drive are
    appended to the log. The first `initial_rows` rows of the log are set, which must be
    long enough. `choose_clock` comes before, and afterwards `events.start` puts the
    fronts on the lines.
    """
    run = state.runs[0]
    segments = state.segments
    n = len(segments) - 2
    for node in state.nodes:
        node.gap = 0.0
        if node.contact != NONE:  # gaps are in velocity times ticks
            node.gap = values[gap_index(n, node.contact)] / run.tick_duration
    set_end(run, segments)
    run.log_rows = 0
    for s in range(1, n + 1):
        append_initial_fronts(state, s, values[s - 1])  # wave speeds come first
    # The times of all drive jumps are the last durations. This is the index of the
    # first jump of the next drive.
    first_jump = len(state.durations) - run.drive_jump_count
    for side in range(2):
        outside = segments[segment_outside(n, side)]
        line = state.lines[line_from_outside(n, side)]
        line.incoming_wave = 0.0
        # STEADY is a wall, a fixed end, or a free end, which has no values.
        has_values = outside.velocity_count > 0
        if has_values and outside.boundary_kind == BoundaryKind.STEADY:
            # A wall or a fixed end: the only value is its constant velocity.
            line.incoming_wave = values[outside.profile_offset] - run.frame_velocity
        outside.mobility = 0.0
        if outside.boundary_kind == BoundaryKind.ENDLESS:
            outside.mobility = segments[segment_at_end(n, side)].mobility
        if outside.boundary_kind != BoundaryKind.STEADY:
            append_driven_fronts(state, side, values, first_jump)
            first_jump += drive_jumps(outside)
    run.initial_rows = run.log_rows


def set_end(run: Run, segments: Sequence[Segment]) -> None:
    """Set `end_tick`, the tick to run to, and `ticks_after_proof`.

    If an end `until` is given, `end_tick` is the nearest tick. Otherwise it is NONE,
    and the run goes on after the proof for `ticks_after_proof`: the round trip of the
    longest body if the request says `run_past_proof`, or if velocities may still change
    (`settles_after_proof`); else 1 tick.
    """
    run.end_tick = NONE
    run.ticks_after_proof = 1
    if run.until >= 0:
        run.end_tick = round(run.until / run.tick_duration)
    elif run.run_past_proof or run.settles_after_proof:
        run.ticks_after_proof = round_trip(segments)


def round_trip(segments: Sequence[Segment]) -> int:
    """Ticks that a wave takes through the longest body and back.

    The transit of a body is the sum over its segments; the longest body is the one with
    the longest transit. Bonded bodies count one by one.
    """
    longest = 0
    body_transit = 0
    for s in range(1, len(segments) - 1):
        if segments[s].velocity_count > 0:  # a body begins
            body_transit = 0
        body_transit += segments[s].transit
        longest = max(longest, body_transit)
    return 2 * longest


def append_initial_fronts(state: State, s: int, wave_speed: float) -> None:
    """Append the fronts that fill segment s with its initial state to the log.

    The waves are a = v - c eps and b = v + c eps, with v in the frame. At t = 0 the
    piece between x0 and x1, in ticks from the left end, is part of both. As part of a
    it began to leave the left end x1 ticks ago; as part of b it began to leave the
    right end T - x0 ticks ago, T the transit time. First all fronts of a are appended,
    then those of b, each in order of time. The first front of a wave is always
    appended, the others only where the wave changes. `log_rows` of the run grows.

    `s` is counted from 1, and `wave_speed` is its c, m/s.
    """
    run = state.runs[0]
    durations = state.durations
    pieces: Sequence[InitialPiece] = state.initial_pieces
    n = len(state.segments) - 2
    transit = state.segments[s].transit
    first_piece = state.segments[s].first_piece
    last_piece = state.segments[s + 1].first_piece - 1
    for leftward in range(2):  # 0: the wave a to the right, 1: the wave b to the left
        first_row = run.log_rows  # row of the first front of this wave
        sign = 2 * leftward - 1  # sign of c eps: -1 in a, 1 in b
        for k in range(last_piece - first_piece + 1):  # in order of time
            # The piece nearest to the end where the wave arrives was sent first: for b
            # the leftmost one, for a the rightmost one.
            if leftward:
                i = first_piece + k
            else:
                i = last_piece - k
            piece = pieces[i]
            # Duration up to the jump at which piece i begins, see `split_at_jumps`
            jump_index = n + i - s
            # The ends of the piece, ticks. `min` is needed as rounding may move a jump
            # past the end of the segment.
            x0 = 0
            x1 = transit
            if i > first_piece:
                x0 = min(durations[jump_index].ticks, transit)
            if i < last_piece:  # it ends where the next piece begins
                x1 = min(durations[jump_index + 1].ticks, transit)
            velocity = piece.velocity - run.frame_velocity
            wave = velocity + sign * wave_speed * piece.strain
            # Tick at which the piece began to leave, before t = 0
            if leftward:
                tick = x0 - transit
            else:
                tick = -x1
            line = 2 * s + leftward
            if x1 > x0:  # a piece that lasts no tick is left out
                append_front_if_new(run, state.log, first_row, tick, line, wave)


def append_driven_fronts(
    state: State, side: int, values: Values, first_jump: int
) -> None:
    """Append the fronts of the drive of an end of the row to the log.

    `side` is 0 for the left end and 1 for the right end. The wave from outside is V in
    the frame for a given velocity V, and F Y for a given force F. For a strain eps that
    arrives through a semi-infinite bar it is a0 - 2 c eps at the left end, and
    b0 + 2 c eps at the right end, with a0 or b0 the wave that leaves this end inward at
    t = 0. The first front is at tick 0, the others at the jumps, whose times are the
    durations from `first_jump` on. Jumps after the end of the run, values that last no
    tick, and changes within the velocity tolerance are left out. The fronts of the
    initial state must be in the log. `log_rows` of the run grows.
    """
    run = state.runs[0]
    log = state.log
    n = len(state.segments) - 2
    outside = state.segments[segment_outside(n, side)]
    outside_line = line_from_outside(n, side)
    inward_line = line_inward(n, side)
    end_segment = segment_at_end(n, side)
    wave_speed = values[end_segment - 1]  # wave speeds come first among the values
    wave_by_strain = (4 * side - 2) * wave_speed  # -2 c on the left, 2 c on the right
    # The wave that leaves inward at t = 0 is that of the last front on this line.
    inward_wave = 0.0
    for r in range(run.log_rows):
        if log[r].line == inward_line:
            inward_wave = log[r].value
    value_count = outside.velocity_count  # values of any kind
    first_row = run.log_rows  # row of the first front of this drive
    start_tick = 0  # tick at which value j begins
    j = 0  # number of the value
    is_last = False  # whether value j holds to the end of the run
    while not is_last:
        value = values[outside.profile_offset + j]
        if outside.boundary_kind == BoundaryKind.PUSHED:
            wave = value * state.segments[end_segment].mobility
        elif outside.boundary_kind == BoundaryKind.ENDLESS:
            wave = wave_by_strain * value + inward_wave
        else:  # a given velocity
            wave = value - run.frame_velocity
        if j == value_count - 1:  # no value follows
            is_last = True
        else:  # the times of the jumps follow the values
            jump_time = values[outside.profile_offset + value_count + j]
            is_last = jump_time > run.until
        if is_last:
            # Any later tick does, so that the last value is not left out.
            stop_tick = start_tick + 1
        else:
            jump_tick = state.durations[first_jump + j].ticks
            # Not before `start_tick`, whatever the rounding of close jumps to ticks
            stop_tick = max(start_tick, jump_tick)
        if stop_tick > start_tick:
            append_front_if_new(run, log, first_row, start_tick, outside_line, wave)
        start_tick = stop_tick
        j += 1


def append_front_if_new(
    run: Run, log: Log, first_row: int, tick: int, line: int, wave: Amplitude
) -> None:
    """Append a front to the log, unless its wave equals the wave of the previous front.

    Waves within the velocity tolerance count as equal. `first_row` is the row of the
    first front of the line, which is always appended. The front gets `tick`, `line` and
    `wave`; its `next_row` is not set yet. `log_rows` of the run counts the new row.
    """
    is_first = run.log_rows == first_row
    # The last row in use is the previous front, of the same line.
    if is_first or abs(wave - log[run.log_rows - 1].value) > run.velocity_tolerance:
        front = log[run.log_rows]
        front.tick = tick
        front.line = line
        front.value = wave
        run.log_rows += 1
