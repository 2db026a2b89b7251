"""The loop over nodes.

The one furthest behind goes next, up to what is known of its inputs. A node can always
go on by the shortest transit beside it, so there is no common time step (conservative
simulation of Chandy and Misra, IEEE Trans. Software Eng. SE-5, 1979). One step is:
limit of what is known, inputs at the points of a piece, collocation, first event,
leaving waves.
"""

import math
from typing import NamedTuple

from .. import contact_laws
from ..compiling import borrowed
from ..states import Status, Stop
from . import event_errors, event_location, events, finality, lines, nodes, series
from .event_location import Event
from .records import MAX_HARD_ORDER, NEVER, NONE, Lines, Log, Node, Nodes, Run, State
from .series import N

MAX_STATUS_CHANGES = 1000
"""Changes of status at one instant, at most.

More are chattering, and the piece goes on without an event.
"""
MIN_CHATTER_CHANGES = 8
"""Changes of status at the start of a piece after which it is shortened.

There may be one more for each pair of links of the node.
"""
CUT_OF_CHATTER = 10
"""Factor by which such a piece is shortened."""
MIN_PIECE_TICKS = 16
"""Ticks of a piece that is accepted whatever its truncation error.

Its points are whole ticks.
"""
ROWS_PER_LINK = 4
"""Rows of the log that a link may add in a step: a wave, and three of history."""
MAX_GROWTH = 4.0
"""Largest duration of a piece over that of the one before it."""
MIN_GROWTH = 0.25
"""Smallest duration of a piece that is wanted, over that of the one before it."""
GROWTH_SAFETY = 0.9
"""Factor on the duration that would just meet the tolerance.

A piece that fails costs a step.
"""
MAX_SHORTENING = 0.6
"""Largest part of a piece that is tried after the whole piece has failed."""
MIN_SHORTENING = 0.1
"""Smallest such part, where the error falls fast with the duration."""
MIN_SHORTENING_OF_STARTS = 1e-4
"""Smallest such part at a start like t^(3/2), where the error falls slowly."""
SLOW_POWER = 4
"""Exponent of the error by the duration, up to which it falls slowly.

A smooth one has N.
"""
SHORTENING_SAFETY = 0.8
"""Factor on the part that would just meet the tolerance."""


class PieceResult(NamedTuple):
    """The solution of a node on a piece."""

    ticks: int  # duration of the piece, 0 without a solution
    error: float  # truncation error, m/s
    event: Event  # first event in the piece


def run_nodes(state: State) -> int:
    """Run all nodes to `end_tick`, or to the proof of finality.

    After a proof come `ticks_after_proof` more. All is in the state: a run that has
    stopped with CAP or FULL can be called again, with a higher cap or longer logs, and
    goes on. The motion of its groups is set at each check of finality, and at its end.

    Returns
    -------
    int
        A `Stop`: CAP, FULL or STUCK are set here, DONE by `finality.check_finality`.
    """
    run = state.runs[0]
    # Machine code would count references to these
    # arrays in every step: borrowed ones have none.
    state = State(
        borrowed(state.runs),
        borrowed(state.nodes),
        borrowed(state.links),
        borrowed(state.masses),
        borrowed(state.lines),
        borrowed(state.parts),
        borrowed(state.log),
        borrowed(state.contact_log),
        borrowed(state.matrix),
    )
    # What one step may append to the log of pieces and to that of contacts, at most
    step_rows = 2 + ROWS_PER_LINK * len(state.links) + len(state.masses)
    step_events = len(state.links) + MAX_STATUS_CHANGES
    run.stop_reason = Stop.NONE.value
    while run.stop_reason == Stop.NONE:
        earliest = state.nodes[earliest_node(state.nodes)]
        check_tick = min(run.end_tick, run.next_proof_tick)
        # `last_proof_tick` is the tick of the last check, whether it proved anything or
        # not. The first one is due at once: it notes the velocities at t = 0.
        is_due = run.last_proof_tick == NONE or earliest.now >= check_tick
        rows_after = run.piece_count + step_rows  # of the logs, after one more step
        events_after = run.contact_event_count + step_events
        is_full = rows_after > len(state.log) or events_after > len(state.contact_log)
        if not is_due:
            if run.steps >= run.max_steps:
                run.stop_reason = Stop.CAP.value
            elif is_full:
                run.stop_reason = Stop.FULL.value
        if is_due or run.stop_reason == Stop.CAP:  # a capped run gets its final motion
            finality.check_finality(state, min(earliest.now, run.end_tick))
        elif run.stop_reason == Stop.NONE:
            run.steps += 1
            if earliest.is_free_end:
                earliest.now = lines.reflect(run, state.lines, state.log, earliest)
            elif not advance(state, earliest):
                run.stop_reason = Stop.STUCK.value
    return int(run.stop_reason)


def earliest_node(nodes: Nodes) -> int:
    """Return the number of the node that is furthest behind in time.

    Of equal ones it is the first.
    """
    k = 0
    for i in range(1, len(nodes)):
        if nodes[i].now < nodes[k].now:
            k = i
    return k


def advance(state: State, node: Node) -> bool:
    """Take one step of a node; return whether there was a solution.

    The step is a piece, up to its first event. It moves the node on: states and totals
    of its links and masses, leaving waves, `now`, and `next_ticks`, the wanted duration
    of the next piece. At an event the status of its link changes. The run notes errors,
    and steps that took means of dense breaks. Without a solution the node stays where
    it is, and the run is stuck.
    """
    run = state.runs[0]
    all_lines = state.lines
    log = state.log
    tick = node.now
    for side in range(2):
        lines.advance_to(all_lines, log, node.incoming_lines[side], tick)
    left_order = lines.order_at(all_lines, log, node.incoming_lines[0], tick)
    right_order = lines.order_at(all_lines, log, node.incoming_lines[1], tick)
    is_after_break = left_order <= MAX_HARD_ORDER or right_order <= MAX_HARD_ORDER
    limit = piece_end(state, node, is_after_break) - tick  # longest duration, ticks
    result = solve(state, node, limit)
    if result.ticks == 0:
        return False
    event = result.event
    ticks = result.ticks  # duration of the piece that is kept
    if event.link != NONE:
        h = result.ticks * run.tick_duration
        event_errors.record_event(run, state.links, node, event, h)
        ticks = event_ticks(run, state.links[event.link].status, result)
        cut_piece(state, node, result.ticks, ticks)
    # A piece is limited if something else than its truncation error sets its duration.
    is_at_limit = result.ticks == limit and limit < node.next_ticks
    is_limited = node.is_averaging == 1 or is_at_limit
    record_error(state, node, result, ticks, is_limited)
    nodes.forbid_pulling(state.links, node)
    send_outgoing(state, node, ticks, left_order, right_order)
    events.record_piece(state, node, ticks)
    if node.is_averaging:
        count_averaged_step(run, tick)
    node.now = tick + ticks
    if event.link != NONE:
        set_state_after_event(state, node, event)
    set_next_ticks(run, node, result, is_limited)
    return True


def event_ticks(run: Run, status: int, result: PieceResult) -> int:
    """Return the ticks from the start of a piece to its event, 1 or more.

    `status` is that of the link before the event. The place of the event is rounded,
    but down where a contact yields: the force stays below that at which it does. An
    open contact that closes just before the end, within `event_window`, closes at the
    end.
    """
    full = result.ticks
    rounding = 0.5
    if result.event.status == Status.PLASTIC:
        rounding = 0.0
    # The position runs from -1 at the start to 1 at the end.
    ticks = max(1, int(0.5 * (result.event.position + 1) * full + rounding))
    is_at_end = full - ticks <= run.event_window
    if is_at_end and status == Status.OPEN:
        # The contact closes together with the waves that arrive at the end
        ticks = full
    return ticks


def cut_piece(state: State, node: Node, full: int, ticks: int) -> None:
    """Shorten the piece that is solved at a node to its first `ticks`.

    It had `full` ticks; with as many nothing changes. Its polynomials are restricted.
    An averaging node is solved anew: means over the shorter time are needed, or
    momentum would be lost.
    """
    run = state.runs[0]
    if ticks < full and node.is_averaging:
        take_inputs(state.lines, state.log, node, ticks)
        h = ticks * run.tick_duration
        nodes.collocate(run, state.links, state.masses, node, h, state.matrix)
    elif ticks < full:
        new_end = 2 * ticks / full - 1  # place in the piece, which goes from -1 to 1
        nodes.restrict_piece(state.links, state.masses, node, new_end)


def record_error(
    state: State, node: Node, result: PieceResult, ticks: int, is_limited: bool
) -> None:
    """Raise the largest errors of a run by those of a piece, of which `ticks` are kept.

    `max_truncation_error` is raised unless the piece is too short to be judged.
    `shared_error` is raised if the piece is limited: something else than the truncation
    error set its duration (`is_limited`). A run at another tolerance takes the same
    step then, and does not show its error. Pieces of an averaging node count for
    neither.
    """
    run = state.runs[0]
    if node.is_averaging == 0 and result.ticks > MIN_PIECE_TICKS:
        run.max_truncation_error = max(run.max_truncation_error, result.error)
    if node.is_averaging == 0 and is_limited:
        has_no_event = result.event.link == NONE
        # Values decide when an event is. All else follows from integrals.
        remainder = nodes.wave_remainder(state.links, node, has_no_event)
        share = ticks / run.shortest_transit
        run.shared_error = max(run.shared_error, share * remainder)


def set_state_after_event(state: State, node: Node, event: Event) -> None:
    """Change the status and state of a link at an event, where the last piece ended.

    `events.apply_transition` does that; no piece is solved. The waves at the start of
    the next piece become those at the end of the last one. If the link opens, the next
    proof of finality is tried as soon as all nodes have come so far. The next piece may
    be halved again for a comparison (`halved_until` is 0).
    """
    run = state.runs[0]
    node.halved_until = 0
    for side in range(2):
        node.incoming[side][0] = node.incoming[side][N]
    events.apply_transition(state, node, node.now, event.link, event.status)
    if event.status == Status.OPEN and run.next_proof_tick < NEVER:
        # The next proof is tried at a tick that no node has passed.
        run.next_proof_tick = node.now
        for i in range(len(state.nodes)):
            run.next_proof_tick = max(run.next_proof_tick, state.nodes[i].now)


def set_next_ticks(run: Run, node: Node, result: PieceResult, is_limited: bool) -> None:
    """Set `next_ticks`, the wanted duration of the next piece.

    The error of a piece is about proportional to the N-th power of its duration: from
    that of this one follows the duration that meets the tolerance, from MIN_GROWTH to
    MAX_GROWTH times this one. A piece whose duration something else has limited
    (`is_limited`) does not make the next one shorter.
    """
    growth = MAX_GROWTH
    if result.error > 0:
        ratio = run.tolerance / result.error
        growth = min(MAX_GROWTH, GROWTH_SAFETY * ratio ** (1 / N))
    wanted = int(result.ticks * max(MIN_GROWTH, growth)) + 1
    if is_limited:
        wanted = max(node.next_ticks, wanted)
    node.next_ticks = wanted


def count_averaged_step(run: Run, tick: int) -> None:
    """Count a step that took means of its waves.

    It begins at `tick`; the tick of the first one is noted.
    """
    run.averaged_steps += 1
    if run.first_averaged_tick == NONE:
        run.first_averaged_tick = tick


def piece_end(state: State, node: Node, is_after_break: bool) -> int:
    """Return the last tick to which the next piece of a node may go.

    That is the first of: the wanted duration, what is known of the waves, their next
    hard break, the end or the next proof of the run, and after a hard break twice the
    duration of the incoming piece. `is_after_break` says that a hard break arrives now.

    Where breaks are too dense to be followed one by one, see `is_dense`, the piece is
    averaging instead: it lasts up to `min_break_spacing`, across breaks, and takes
    means of its waves. In a comparison run (`halves_pieces`) the first piece is halved,
    and each that something else than the wanted duration limits. This sets
    `is_averaging` and `halved_until` of the node.
    """
    run = state.runs[0]
    all_lines = state.lines
    log = state.log
    tick = node.now
    left = node.incoming_lines[0]
    right = node.incoming_lines[1]
    limit = min(
        run.end_tick,
        lines.known_until(all_lines, log, left),
        lines.known_until(all_lines, log, right),
    )
    if run.next_proof_tick > tick:
        limit = min(limit, run.next_proof_tick)
    wanted_end = tick + node.next_ticks
    end = min(limit, wanted_end)
    # The first hard break before `end`, or `end` itself
    end = lines.next_break(all_lines, log, left, tick, end)
    end = lines.next_break(all_lines, log, right, tick, end)
    averaged_end = min(limit, tick + run.min_break_spacing)
    if end < averaged_end:  # an averaging piece would be longer
        is_left_dense = is_dense(run, all_lines, log, left, tick)
        is_right_dense = is_dense(run, all_lines, log, right, tick)
        if is_left_dense or is_right_dense:
            node.is_averaging = 1
            return int(averaged_end)
    node.is_averaging = 0
    if is_after_break:
        # On each side with a break: at most twice as long as the incoming piece that
        # begins with it
        for side in range(2):
            source = node.incoming_lines[side]
            if lines.order_at(all_lines, log, source, tick) <= MAX_HARD_ORDER:
                piece = log[all_lines[source].read_piece]
                incoming_ticks = piece.end - piece.start
                end = min(end, tick + 2 * incoming_ticks)
    is_limited = tick == 0 or end < wanted_end
    if run.halves_pieces and is_limited and end > node.halved_until:
        # Such a piece is as long at any tolerance, so that the run that is compared has
        # the same one: half of it shows the error. `halved_until` keeps the second half
        # from being halved again.
        node.halved_until = end
        end = tick + (end - tick + 1) // 2  # the first half, rounded up
    return end


def is_dense(run: Run, all_lines: Lines, log: Log, l: int, tick: int) -> bool:
    """Return whether hard breaks in line l are too dense to be followed one by one.

    They are if their mean distance is below half of `min_break_spacing`. The mean is
    taken over the part of the line that is known and not yet read at `tick`, or over
    the shortest transit if that is longer: two breaks in a short known part are no
    dense series.
    """
    known_ticks = lines.known_until(all_lines, log, l) - tick
    stretch = max(known_ticks, run.shortest_transit)
    # The mean distance is stretch/unread_breaks.
    return bool(all_lines[l].unread_breaks * run.min_break_spacing > 2 * stretch)


def solve(state: State, node: Node, ticks: int) -> PieceResult:
    """Solve a node on a piece of up to `ticks`, shortened until it is smooth.

    The solution is left in the links and masses of the node. Smooth is a truncation
    error within the tolerance; averaging pieces, and those of MIN_PIECE_TICKS, need not
    be. If an event is at the start of the piece, the status of its link is changed, and
    the piece is solved anew, so that the event of the result is after the start. After
    MAX_STATUS_CHANGES of these the result has no event. Without a solution on a piece
    of one tick it has 0 ticks.
    """
    run = state.runs[0]
    links = state.links
    masses = state.masses
    changes = 0  # changes of status at the start of the piece
    # So many changes are more than one for each pair of links: contacts chatter
    changes_of_chatter = MIN_CHATTER_CHANGES + node.link_count * node.link_count
    # Duration and error of the piece that failed before; an error of 0 means none
    ticks_before = ticks
    error_before = 0.0
    no_event = Event(1.0, NONE, 0)
    while True:
        h = ticks * run.tick_duration
        take_inputs(state.lines, state.log, node, ticks)
        error = -1.0  # no solution
        if nodes.collocate(run, links, masses, node, h, state.matrix):
            error = nodes.truncation_error(links, masses, node)
        # A piece that is averaging, or as short as can be, is accepted with any error.
        is_smooth = error <= run.tolerance
        is_accepted = is_smooth or node.is_averaging or ticks <= MIN_PIECE_TICKS
        if error >= 0 and is_accepted:
            event = event_location.next_event(run, links, node, h)
            start_ticks = 0.5  # an event earlier than this is at the start
            if event.link != NONE and links[event.link].status == Status.OPEN:
                # A contact closes together with what arrives at the start
                start_ticks = run.event_window
            # The position of the event runs from -1 at the start to 1 at the end.
            ticks_to_event = 0.5 * (event.position + 1) * ticks
            is_after_start = ticks_to_event >= start_ticks
            if event.link == NONE or is_after_start:
                return PieceResult(ticks, error, event)
            changes += 1
            if changes > MAX_STATUS_CHANGES:
                return PieceResult(ticks, error, no_event)
            if changes % changes_of_chatter == 0 and ticks > MIN_PIECE_TICKS:
                # No status lasts as long as the piece.
                ticks = max(MIN_PIECE_TICKS, ticks // CUT_OF_CHATTER)
            events.apply_transition(state, node, node.now, event.link, event.status)
        elif ticks <= 1:
            return PieceResult(0, error, no_event)
        else:
            factor = shortening(run.tolerance, error, ticks_before, ticks, error_before)
            ticks_before = ticks
            error_before = error
            ticks = max(1, int(ticks * factor))


def take_inputs(all_lines: Lines, log: Log, node: Node, ticks: int) -> None:
    """Set `node.incoming` to the waves from both sides in a piece of `ticks` from now.

    They are the values at the points of the piece, or those of the nearest parabola if
    the node is averaging.
    """
    # Machine code counts no references to borrowed arrays.
    all_lines = borrowed(all_lines)
    log = borrowed(log)
    now = node.now
    for side in range(2):
        source = node.incoming_lines[side]
        if node.is_averaging:
            lines.project(all_lines, log, source, now, ticks, node.incoming[side])
        else:
            lines.sample(all_lines, log, source, now, ticks, node.incoming[side])


def shortening(
    tolerance: float, error: float, ticks_before: int, ticks: int, error_before: float
) -> float:
    """Return the part of a piece, below 1, whose error may be within the tolerance.

    The piece has `ticks`. Its error falls like a power of the duration, so that the
    part is about (tolerance/error)^(1/power), between bounds. The power follows from
    the error of the piece, and from that of a longer one of `ticks_before` ticks, which
    failed before; a smooth piece has N. After a touch the force starts like a power of
    time, often 3/2, and the error falls as slowly.

    Without a solution `error` is below 0 and tells nothing: then the part is
    MIN_GROWTH.
    """
    if error <= 0:
        return MIN_GROWTH
    power = 1.0 * N
    if error_before > error:
        # Exponent of the power law through both errors
        observed = math.log(error_before / error) / math.log(ticks_before / ticks)
        power = max(1.0, min(power, observed))
    if power > SLOW_POWER:
        smallest = MIN_SHORTENING
    else:
        smallest = MIN_SHORTENING_OF_STARTS
    part = SHORTENING_SAFETY * (tolerance / error) ** (1 / power)
    return max(smallest, min(MAX_SHORTENING, part))


def send_outgoing(
    state: State, node: Node, ticks: int, left_order: int, right_order: int
) -> None:
    """Append the waves that leave a node in a piece of `ticks` from now to their lines.

    `left_order` and `right_order` are the orders of the breaks that arrive from both
    sides. A wave that leaves breaks like the one that arrives on its side, or like the
    force of the link there, whichever order is lower. Compliant links without damping,
    and masses between links, make breaks smoother on their way. No wave leaves at an
    end of the row.

    The waves of an averaging node are replaced by their nearest parabolas, and may
    jump.
    """
    run = state.runs[0]
    links = state.links
    # Orders of both breaks on their way through the node: that of the left one in the
    # forces from left to right, that of the right one from right to left
    rightward_order = left_order
    leftward_order = right_order
    for q in range(node.link_count):
        if q > 0:
            # A mass before this link integrates the force of the link before:
            # its velocity is one order smoother than that force.
            rightward_order += 1
            leftward_order += 1
        from_left = links[node.first_link + q]  # the q-th link from the left
        from_right = links[node.first_link + node.link_count - 1 - q]
        rightward_order = contact_laws.break_order(from_left, rightward_order)
        leftward_order = contact_laws.break_order(from_right, leftward_order)
    for side in range(2):
        if node.outgoing_lines[side] == NONE:
            continue
        nodes.set_outgoing(links, node, side)
        # A wave that leaves has the break that arrived on its side, and the one that
        # has come through from the other side: the lower order counts.
        if node.is_averaging:
            series.flatten(node.outgoing)
            order = 0
        elif side == 0:
            order = min(left_order, leftward_order)
        else:
            order = min(right_order, rightward_order)
        lines.send(
            run, state.lines, state.log, node.outgoing_lines[side], node, ticks, order
        )
