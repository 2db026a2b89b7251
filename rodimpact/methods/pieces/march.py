"""The loop over nodes.

Nodes have no common time step. The earliest node goes next, as far as its incoming
waves are known. That is always at least the shortest transit time beside it: the waves
were sent that long ago (conservative simulation, Chandy and Misra, IEEE Trans. Software
Eng. SE-5, 1979). One step of a node finds how far the waves are known, takes their
values at the points of a piece, solves the piece by collocation, cuts it at its first
event, and sends the leaving waves.
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
"""Largest number of changes of status at one instant.

After more of them the contacts chatter: the piece is accepted without an event.
"""
MIN_CHATTER_CHANGES = 8
"""Number of changes of status at the start of a piece after which it is shortened.

The square of the number of links of the node is added.
"""
CUT_OF_CHATTER = 10
"""Factor by which such a piece is shortened."""
MIN_PIECE_TICKS = 16
"""Duration, ticks, up to which a piece is accepted whatever its truncation error.

The points of shorter pieces would be rounded too much.
"""
ROWS_PER_LINK = 4
"""Rows of the log that a link may add in a step: one of a wave, three of history."""
MAX_GROWTH = 4.0
"""Largest ratio of the wanted duration of a piece to that of the piece before it."""
MIN_GROWTH = 0.25
"""Smallest ratio of the wanted duration of a piece to that of the piece before it."""
GROWTH_SAFETY = 0.9
"""Factor on the duration that would just meet the tolerance.

A piece that fails must be solved again.
"""
MAX_SHORTENING = 0.6
"""Largest fraction of a piece that is tried after the whole piece has failed."""
MIN_SHORTENING = 0.1
"""Smallest such fraction where the error falls fast with the duration."""
MIN_SHORTENING_OF_STARTS = 1e-4
"""Smallest such fraction at a start like t^(3/2), where the error falls slowly."""
SLOW_POWER = 4
"""Largest exponent p of an error that falls slowly: like the p-th power of duration.

A smooth piece has the exponent N.
"""
SHORTENING_SAFETY = 0.8
"""Factor on the fraction that would just meet the tolerance."""


class PieceResult(NamedTuple):
    """The solution of a node on a piece."""

    ticks: int  # duration of the piece, 0 without a solution
    error: float  # truncation error, m/s; -1 without a solution
    event: Event  # first event in the piece; its link is NONE if there is none


def run_nodes(state: State) -> int:
    """Run all nodes to `end_tick`, or until the proof of finality.

    After a proof the run goes on for `ticks_after_proof`. It can also stop at the cap
    on steps (CAP), with logs that are full (FULL), or because a node has no solution
    (STUCK). After CAP and FULL it can be called again with a higher cap or longer logs,
    and goes on, as everything is in the state. The motion of the groups is set at each
    check of finality, at the end of the run, and at the cap.

    Returns
    -------
    int
        The `stop_reason` of the run, a `Stop`: CAP, FULL, STUCK or DONE.
    """
    run = state.runs[0]
    # Machine code would count the references to these arrays in every step. References
    # to borrowed arrays are not counted.
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
    # Upper bounds of the rows that one step may append to the logs: two leaving waves,
    # and the rows of links and masses
    step_rows = 2 + ROWS_PER_LINK * len(state.links) + len(state.masses)
    step_events = len(state.links) + MAX_STATUS_CHANGES
    run.stop_reason = Stop.NONE.value
    while run.stop_reason == Stop.NONE:
        earliest = state.nodes[earliest_node(state.nodes)]
        # The next check of finality is due once all nodes have reached this tick.
        check_tick = min(run.end_tick, run.next_proof_tick)
        # The first check is due at once, to record the velocities at t = 0. Until then
        # `last_check_tick`, the tick of the last check, is NONE.
        is_due = run.last_check_tick == NONE or earliest.now >= check_tick
        rows_after = run.piece_count + step_rows  # after one more step
        events_after = run.contact_event_count + step_events
        is_full = rows_after > len(state.log) or events_after > len(state.contact_log)
        if not is_due:
            if run.steps >= run.max_steps:
                run.stop_reason = Stop.CAP.value
            elif is_full:
                run.stop_reason = Stop.FULL.value
        # A run that stops at the cap gets its final motion by a check, too.
        if is_due or run.stop_reason == Stop.CAP:
            finality.check_finality(state, min(earliest.now, run.end_tick))
        elif run.stop_reason == Stop.NONE:
            run.steps += 1
            if earliest.is_free_end:
                earliest.now = lines.reflect(run, state.lines, state.log, earliest)
            elif not advance(state, earliest):
                run.stop_reason = Stop.STUCK.value
    return int(run.stop_reason)


def earliest_node(nodes: Nodes) -> int:
    """Return the number of the node with the earliest `now`, the first if several."""
    earliest = 0
    for k in range(1, len(nodes)):
        if nodes[k].now < nodes[earliest].now:
            earliest = k
    return earliest


def advance(state: State, node: Node) -> bool:
    """Take one step of a node; return whether there was a solution.

    The step solves one piece, up to its first event. It updates the states and totals
    of links and masses, appends the leaving waves to their lines, and sets `now` to the
    end of the piece, and `next_ticks`, the wanted duration of the next piece. At an
    event the status of its link changes. The largest errors of the run are raised, and
    a step of an averaging node is counted. Without a solution the state of the node
    stays at `now`, and False is returned.
    """
    run = state.runs[0]
    all_lines = state.lines
    log = state.log
    tick = node.now
    for side in range(2):
        lines.advance_to(all_lines, log, node.incoming_lines[side], tick)
    left_order = lines.order_at(all_lines, log, node.incoming_lines[0], tick)
    right_order = lines.order_at(all_lines, log, node.incoming_lines[1], tick)
    # A break of low order is hard; without a break the order is high.
    is_after_break = left_order <= MAX_HARD_ORDER or right_order <= MAX_HARD_ORDER
    limit = piece_end(state, node, is_after_break) - tick  # largest duration, ticks
    result = solve(state, node, limit)
    if result.ticks == 0:
        return False
    event = result.event
    ticks = result.ticks  # duration of the part of the piece that is kept
    if event.link != NONE:
        h = result.ticks * run.tick_duration
        event_errors.record_event(run, state.links, node, event, h)
        ticks = event_ticks(run, state.links[event.link].status, result)
        cut_piece(state, node, result.ticks, ticks)
    # The piece is limited if its duration is set by `limit`, below the wanted duration,
    # or by the averaging, but not by its truncation error.
    is_at_limit = result.ticks == limit and limit < node.next_ticks
    is_limited = node.is_averaging == 1 or is_at_limit
    record_error(state, node, result, ticks, is_limited)
    # Forces slightly below 0 are raised before they are sent; their impulses stay.
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
    """Return the time from the start of a piece to its event, ticks, at least 1.

    The piece must have an event. Its time is rounded to the nearest tick. Where the
    contact begins to yield, or reaches a knot of its table, it is rounded down, so that
    the force stays below the yield force. `status` is the status of the link before the
    event: an open contact that closes within `event_window` of the end of the piece
    closes at the end.
    """
    full = result.ticks
    rounding = 0.5  # to the nearest tick
    if result.event.status == Status.PLASTIC:
        rounding = 0.0  # down
    # The position runs from -1 at the start to 1 at the end.
    ticks = max(1, int(0.5 * (result.event.position + 1) * full + rounding))
    is_at_end = full - ticks <= run.event_window
    if is_at_end and status == Status.OPEN:
        ticks = full  # it closes together with the waves that arrive at the end
    return ticks


def cut_piece(state: State, node: Node, full: int, ticks: int) -> None:
    """Shorten the solved piece of a node from `full` to `ticks`, from its start on.

    Its polynomials are restricted to the shorter piece. An averaging node is solved
    anew instead, since the means of its waves over the shorter piece differ: with the
    old ones momentum would be lost. If `ticks` is `full`, nothing changes.
    """
    run = state.runs[0]
    if ticks < full and node.is_averaging:
        take_inputs(state.lines, state.log, node, ticks)
        h = ticks * run.tick_duration
        nodes.collocate(run, state.links, state.masses, node, h, state.matrix)
    elif ticks < full:
        new_end = 2 * ticks / full - 1  # y of the whole piece, from -1 to 1
        nodes.restrict_piece(state.links, state.masses, node, new_end)


def record_error(
    state: State, node: Node, result: PieceResult, ticks: int, is_limited: bool
) -> None:
    """Raise the largest errors of a run to those of a piece, if these are larger.

    `max_truncation_error`, m/s, is raised to the error of the piece, unless the piece
    has MIN_PIECE_TICKS or fewer, which are accepted with any error.

    `shared_error`, m/s, is raised if `is_limited`: if the truncation error did not set
    the duration of the piece. A run at another tolerance then takes the same piece, so
    that a comparison of both does not show its error. That is the remainder of the
    waves, times the share of the shortest transit that is kept, `ticks`.

    Pieces of an averaging node raise neither.
    """
    run = state.runs[0]
    if node.is_averaging == 0 and result.ticks > MIN_PIECE_TICKS:
        run.max_truncation_error = max(run.max_truncation_error, result.error)
    if node.is_averaging == 0 and is_limited:
        # The time of an event depends on the values of the waves, everything else on
        # their integrals, which are more precise.
        takes_integrals = result.event.link == NONE
        remainder = nodes.wave_remainder(state.links, node, takes_integrals)
        share = ticks / run.shortest_transit
        run.shared_error = max(run.shared_error, share * remainder)


def set_state_after_event(state: State, node: Node, event: Event) -> None:
    """Change the status of a link, and its state, at an event at the end of a piece.

    `now` of the node is already the end of that piece. `events.apply_transition` makes
    the change. The incoming waves at point 0, the start of the next piece, become those
    at the end of this one. If the link opens, the next proof of finality is tried as
    soon as all nodes have reached the latest node. `halved_until` becomes 0: a run for
    comparison may halve the next piece again.
    """
    run = state.runs[0]
    node.halved_until = 0
    for side in range(2):
        node.incoming[side][0] = node.incoming[side][N]
    events.apply_transition(state, node, node.now, event.link, event.status)
    tries_proofs = run.next_proof_tick < NEVER
    if event.status == Status.OPEN and tries_proofs:
        # No node has passed the tick of the next proof: it is that of the latest node.
        run.next_proof_tick = node.now
        for i in range(len(state.nodes)):
            run.next_proof_tick = max(run.next_proof_tick, state.nodes[i].now)


def set_next_ticks(run: Run, node: Node, result: PieceResult, is_limited: bool) -> None:
    """Set `next_ticks` of a node, the wanted duration of its next piece.

    The error of a piece is about proportional to the N-th power of its duration. So the
    error of this piece, `result`, gives the duration that meets the tolerance, which is
    kept from MIN_GROWTH to MAX_GROWTH times that of this piece. If something other than
    its error has limited this piece (`is_limited`), `next_ticks` does not become less.
    """
    growth = MAX_GROWTH
    if result.error > 0:
        ratio = run.tolerance / result.error
        growth = min(MAX_GROWTH, GROWTH_SAFETY * ratio ** (1 / N))
    wanted = int(result.ticks * max(MIN_GROWTH, growth)) + 1  # never 0
    if is_limited:
        wanted = max(node.next_ticks, wanted)
    node.next_ticks = wanted


def count_averaged_step(run: Run, tick: int) -> None:
    """Count a step of an averaging node, which begins at `tick`.

    The run keeps the number of these steps, and the tick of the first one.
    """
    run.averaged_steps += 1
    if run.first_averaged_tick == NONE:
        run.first_averaged_tick = tick


def piece_end(state: State, node: Node, is_after_break: bool) -> int:
    """Return the tick at which the next piece of a node must end at the latest.

    This is the earliest of: the end of the wanted duration (`next_ticks`), the tick up
    to which both waves are known, their next hard break, the end of the run, and its
    next proof. If a hard break arrives now (`is_after_break`), the piece lasts at most
    twice as long as the incoming piece that begins with the break.

    Where hard breaks are too dense to end a piece at each one, see `is_dense`, the node
    becomes averaging instead (`is_averaging`): the piece goes across breaks for up to
    `min_break_spacing`, and takes means of its waves.

    A run for comparison (`halves_pieces`) halves its first piece, and each piece that
    something other than the wanted duration limits. `is_averaging` and `halved_until`
    of the node are set.
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
    # The first hard break before `end`, or else `end` itself
    end = lines.next_break(all_lines, log, left, tick, end)
    end = lines.next_break(all_lines, log, right, tick, end)
    averaged_end = min(limit, tick + run.min_break_spacing)
    if end < averaged_end:  # an averaging piece would last longer
        is_left_dense = is_dense(run, all_lines, log, left, tick)
        is_right_dense = is_dense(run, all_lines, log, right, tick)
        if is_left_dense or is_right_dense:
            node.is_averaging = 1
            return int(averaged_end)
    node.is_averaging = 0
    if is_after_break:
        # Each side on which a hard break, one of low order, arrives limits the piece.
        for side in range(2):
            source = node.incoming_lines[side]
            if lines.order_at(all_lines, log, source, tick) <= MAX_HARD_ORDER:
                # `read_piece` arrives from now on: it begins with the break.
                piece = log[all_lines[source].read_piece]
                incoming_ticks = piece.end - piece.start
                end = min(end, tick + 2 * incoming_ticks)
    is_first = tick == 0
    is_limited = is_first or end < wanted_end
    # `halved_until` is the end of the piece that was halved last.
    is_second_half = end <= node.halved_until
    if run.halves_pieces and is_limited and not is_second_half:
        # Such a piece has the same duration at any tolerance. The run for comparison
        # takes it in two halves, so that a comparison shows its error.
        node.halved_until = end
        end = tick + (end - tick + 1) // 2  # the first half, rounded up
    return end


def is_dense(run: Run, all_lines: Lines, log: Log, l: int, tick: int) -> bool:
    """Return whether hard breaks in line l are too dense to end a piece at each one.

    They are too dense if their mean spacing is below half of `min_break_spacing`. The
    mean is taken over the time from `tick` on for which the line is known, or over the
    shortest transit if that is longer: two close breaks in a short known time are not
    yet a dense series.
    """
    known_ticks = lines.known_until(all_lines, log, l) - tick
    duration = max(known_ticks, run.shortest_transit)
    # The mean spacing, duration/unread_breaks, is below min_break_spacing/2.
    return bool(all_lines[l].unread_breaks * run.min_break_spacing > 2 * duration)


def solve(state: State, node: Node, ticks: int) -> PieceResult:
    """Solve a node on a piece of up to `ticks`, shortened until its error is allowed.

    The truncation error must be within the tolerance, except for an averaging node, and
    for pieces of MIN_PIECE_TICKS or fewer. The solution is left in the links and masses
    of the node, and the first event of the piece is found, but does not cut it.

    If an event is at the very start of the piece, the status of its link is changed at
    once, and the piece is solved again: the event that is returned is later. If this
    happens often, the piece is also shortened, and after MAX_STATUS_CHANGES the result
    has no event. If there is no solution even on one tick, the result has 0 ticks.
    """
    run = state.runs[0]
    links = state.links
    masses = state.masses
    changes = 0  # changes of status at the start of the piece
    # Without chatter there is at most about one change for each pair of links.
    changes_of_chatter = MIN_CHATTER_CHANGES + node.link_count * node.link_count
    # Duration and error of the last longer piece that failed; error 0: there is none
    ticks_before = ticks
    error_before = 0.0
    no_status = 0
    no_event = Event(1.0, NONE, no_status)  # position 1 is the end of the piece
    while True:
        h = ticks * run.tick_duration
        take_inputs(state.lines, state.log, node, ticks)
        error = -1.0  # no solution
        if nodes.collocate(run, links, masses, node, h, state.matrix):
            error = nodes.truncation_error(links, masses, node)
        has_solution = error >= 0
        # Without a solution `is_precise` has no meaning.
        is_precise = error <= run.tolerance
        is_accepted = is_precise or node.is_averaging or ticks <= MIN_PIECE_TICKS
        if has_solution and is_accepted:
            event = event_location.next_event(run, links, node, h)
            start_ticks = 0.5  # an earlier event is at the start
            if event.link != NONE and links[event.link].status == Status.OPEN:
                # A contact that closes soon after the start closes at the start,
                # together with the waves that arrive then.
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
                # The contacts chatter: no status holds over such a long piece.
                ticks = max(MIN_PIECE_TICKS, ticks // CUT_OF_CHATTER)
            events.apply_transition(state, node, node.now, event.link, event.status)
        # One tick is below MIN_PIECE_TICKS: any solution would have been accepted.
        elif ticks <= 1:  # there is no solution at all
            no_ticks = 0
            return PieceResult(no_ticks, error, no_event)
        else:
            factor = shortening(run.tolerance, error, ticks_before, ticks, error_before)
            ticks_before = ticks
            error_before = error
            ticks = max(1, int(ticks * factor))


def take_inputs(all_lines: Lines, log: Log, node: Node, ticks: int) -> None:
    """Set `node.incoming` to the waves from both sides, over `ticks` from now.

    These are the values at the points of the piece; if the node is averaging, the
    values of the parabola nearest to each wave. A side of the node without a rod, at an
    end of the row, has a line from outside. Nodes of free ends, which have none, never
    come here: `lines.reflect` handles them.
    """
    # For speed: machine code does not count references to borrowed arrays.
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
    """Return the fraction of a piece, below 1, that is to be tried after it failed.

    The error of the piece, which has `ticks`, falls like a power of its duration: the
    fraction that meets the tolerance is about (tolerance/error)^(1/power). It is kept
    between MIN_SHORTENING, or MIN_SHORTENING_OF_STARTS if the power is low, and
    MAX_SHORTENING.

    The power is N, the degree of the polynomials, for a smooth piece. It is lower where
    a force starts, after a touch, like a power of time, often 3/2, but it counts as 1
    at least. It follows from the errors of two pieces that failed: this one, and a
    longer one of `ticks_before` ticks before it, with `error_before`, which is 0 if
    there was none. If the piece has no solution (`error` not above 0), the result is
    MIN_GROWTH, which also bounds the ratio of successive pieces.
    """
    if error <= 0:  # -1: there is no solution
        return MIN_GROWTH
    power = 1.0 * N  # as a float
    if error_before > error:
        # error_before/error = (ticks_before/ticks)^observed_power
        observed_power = math.log(error_before / error) / math.log(ticks_before / ticks)
        power = max(1.0, min(power, observed_power))
    if power > SLOW_POWER:
        smallest = MIN_SHORTENING
    else:
        smallest = MIN_SHORTENING_OF_STARTS
    fraction = SHORTENING_SAFETY * (tolerance / error) ** (1 / power)
    return max(smallest, min(MAX_SHORTENING, fraction))


def send_outgoing(
    state: State, node: Node, ticks: int, left_order: int, right_order: int
) -> None:
    """Append the waves that leave a node, over `ticks` from now, to their lines.

    `left_order` and `right_order` are the orders of the breaks that arrive from both
    sides at the start of the piece. A leaving wave has a break of the lower of two
    orders: that of the break that arrives on its own side, and that of the break that
    comes through the node from the other side. The latter becomes smoother on its way:
    each compliant link without damping, and each mass, raises its order by one. A side
    without an outgoing line, at an end of the row, is left out.

    The waves of an averaging node are replaced by their nearest parabolas, which may
    jump: their breaks have the order 0.
    """
    run = state.runs[0]
    links = state.links
    # Orders of both breaks on their way through the forces of the links: the break from
    # the left runs to the right, the break from the right runs to the left.
    rightward_order = left_order
    leftward_order = right_order
    for q in range(node.link_count):
        if q > 0:
            # The velocity of the mass before this link is the integral of forces: it is
            # one order smoother.
            rightward_order += 1
            leftward_order += 1
        # The links that both breaks meet after q masses
        link_from_left = links[node.first_link + q]
        link_from_right = links[node.first_link + node.link_count - 1 - q]
        rightward_order = contact_laws.break_order(link_from_left, rightward_order)
        leftward_order = contact_laws.break_order(link_from_right, leftward_order)
    for side in range(2):
        if node.outgoing_lines[side] == NONE:
            continue
        nodes.set_outgoing(links, node, side)
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
