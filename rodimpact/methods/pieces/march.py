"""The loop over nodes: the one furthest behind goes next, up to what is known of its inputs.

A node can always go on by the shortest transit beside it, so there is no common time step
(conservative simulation of Chandy and Misra, IEEE Trans. Software Eng. SE-5, 1979). One step is:
limit of what is known, inputs at the points of a piece, collocation, first event, leaving waves.
"""

import math

from .. import contact_laws
from ..compiling import borrowed
from ..states import Status, Stop
from . import event_errors, events, finality, lines, nodes, series
from .records import HARD, NEVER, NONE, Lines, Log, Node, Nodes, Run, State
from .series import N

MAX_STATUS_CHANGES = 1000
"""Changes of status at one instant; more are chattering, and the piece goes on without an event."""
CUT_OF_CHATTER = 10
"""Factor by which a piece is shortened that has as many events at its start as a graze has."""
MIN_PIECE_TICKS = 16
"""Ticks of a piece that is accepted whatever its truncation error: its points are whole ticks."""
ROWS_PER_LINK = 4
"""Rows of the log of pieces that a link may add in a step: a wave, and three of its history."""
MAX_GROWTH = 4.0
"""Largest duration of a piece over that of the one before it."""
MIN_GROWTH = 0.25
"""Smallest duration of a piece that is wanted, over that of the one before it."""
GROWTH_SAFETY = 0.9
"""Factor on the duration that would just meet the tolerance: a piece that fails costs a step."""
MAX_SHORTENING = 0.6
"""Largest part of a piece that is tried after the whole piece has failed."""
MIN_SHORTENING = 0.1
"""Smallest such part, where the error falls fast with the duration."""
MIN_SHORTENING_OF_STARTS = 1e-4
"""Smallest such part at a start like t^(3/2): there the error falls slowly with the duration."""
SLOW_POWER = 4
"""Exponent of the error by the duration, up to which it falls slowly: a smooth one has N."""
SHORTENING_SAFETY = 0.8
"""Factor on the part that would just meet the tolerance."""


def run_nodes(state: State) -> int:
    """Run to `end_tick`, or to the proof that nothing meets any more and `ticks_after_proof` more.

    All is in the state: a run whose log is full goes on with a longer one.

    Returns
    -------
    int
        A `Stop`: CAP, FULL or STUCK are set here, DONE by `finality.check_finality`.
    """
    run = state.runs[0]
    # Machine code would count references to these arrays in every step: borrowed ones have none.
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
    step_rows = 2 + ROWS_PER_LINK * len(state.links) + len(state.masses)
    step_events = len(state.links) + MAX_STATUS_CHANGES
    run.stop_reason = Stop.NONE.value
    while run.stop_reason == Stop.NONE:
        earliest = state.nodes[earliest_node(state.nodes)]
        check_tick = min(run.end_tick, run.next_proof_tick)
        # `last_proof_tick` is the tick of the last check, whether it proved anything or not. The
        # first one is due at once: it notes the velocities at t = 0.
        is_due = run.last_proof_tick == NONE or earliest.now >= check_tick
        is_full = run.piece_count + step_rows > len(
            state.log
        ) or run.contact_event_count + step_events > len(state.contact_log)
        if not is_due and run.steps >= run.max_steps:
            run.stop_reason = Stop.CAP.value
        elif not is_due and is_full:
            run.stop_reason = Stop.FULL.value
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
    """Return the number of the node that is furthest behind."""
    k = 0
    for i in range(1, len(nodes)):
        if nodes[i].now < nodes[k].now:
            k = i
    return k


def advance(state: State, node: Node) -> bool:
    """Take one step of a node; return whether there was a solution."""
    run = state.runs[0]
    links = state.links
    masses = state.masses
    all_lines = state.lines
    log = state.log
    tick = node.now
    for side in range(2):
        lines.advance_to(all_lines, log, node.incoming_lines[side], tick)
    left = lines.order_at(all_lines, log, node.incoming_lines[0], tick)
    right = lines.order_at(all_lines, log, node.incoming_lines[1], tick)
    end = horizon(state, node, left <= HARD or right <= HARD)
    full, error, event_position, event_link, status = solve(state, node, end - tick)
    if full == 0:
        return False
    ticks = full
    if event_link != NONE:
        h = full * run.tick_duration
        link = links[event_link]
        event_errors.record_event(run, link, node, event_position, status, h)
        rounding = 0.5
        if status == Status.PLASTIC:
            rounding = 0.0  # the force stays below that at which the contact yields
        ticks = max(1, int(0.5 * (event_position + 1) * full + rounding))
        is_at_end = full - ticks <= run.event_window
        if is_at_end and links[event_link].status == Status.OPEN:
            ticks = full  # it closes together with the waves that arrive at the end
        if ticks < full and node.is_averaging:
            # Means over the shorter time are needed, or momentum would be lost.
            take_inputs(all_lines, log, node, ticks)
            nodes.collocate(
                run, links, masses, node, ticks * run.tick_duration, state.matrix
            )
        elif ticks < full:
            nodes.restrict_piece(links, masses, node, 2 * ticks / full - 1)
    # A piece is limited if something else than its truncation error sets its duration.
    is_limited = node.is_averaging == 1
    if full == end - tick and full < node.next_ticks:
        is_limited = True
    if node.is_averaging == 0 and full > MIN_PIECE_TICKS:
        run.max_truncation_error = max(run.max_truncation_error, error)
    if node.is_averaging == 0 and is_limited:
        # A run at another tolerance takes the same step, and does not show its error.
        # Values decide when an event is, integrals all else.
        remainder = nodes.remainder(links, node, event_link == NONE)
        share = ticks / run.shortest_transit
        run.shared_error = max(run.shared_error, share * remainder)
    nodes.forbid_pulling(links, node)
    send_outgoing(state, node, ticks, left, right)
    events.record_piece(state, node, ticks)
    if node.is_averaging:
        count_averaged_step(run, tick)
    if event_link != NONE:
        node.halved_until = 0
        for side in range(2):
            node.incoming[side][0] = node.incoming[side][N]
        events.apply_transition(state, node, tick + ticks, event_link, status)
        if status == Status.OPEN and run.next_proof_tick < NEVER:
            # The next proof is tried at a tick that no node has passed.
            run.next_proof_tick = tick + ticks
            for i in range(len(state.nodes)):
                run.next_proof_tick = max(run.next_proof_tick, state.nodes[i].now)
    node.now = tick + ticks
    growth = MAX_GROWTH
    if error > 0:
        growth = min(MAX_GROWTH, GROWTH_SAFETY * (run.tolerance / error) ** (1 / N))
    wanted = int(full * max(MIN_GROWTH, growth)) + 1
    if is_limited:
        wanted = max(node.next_ticks, wanted)
    node.next_ticks = wanted
    return True


def count_averaged_step(run: Run, tick: int) -> None:
    """Count a step that took means of its waves, and note when the first was."""
    run.averaged_steps += 1
    if run.first_averaged_tick == NONE:
        run.first_averaged_tick = tick


def horizon(state: State, node: Node, is_after_break: bool) -> int:
    """Return the tick at which the next piece ends; set whether hard breaks are too dense there.

    Where they are, see `is_dense`, the piece lasts up to `min_break_spacing` and takes means of its
    waves: cost would grow without end if breaks were followed one by one.
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
    end = min(limit, tick + node.next_ticks)
    end = lines.next_break(all_lines, log, left, tick, end)
    end = lines.next_break(all_lines, log, right, tick, end)
    averaged_end = min(limit, tick + run.min_break_spacing)
    if end < averaged_end:
        is_left_dense = is_dense(run, all_lines, log, left, tick)
        is_right_dense = is_dense(run, all_lines, log, right, tick)
        if is_left_dense or is_right_dense:
            node.is_averaging = 1
            return int(averaged_end)
    node.is_averaging = 0
    if is_after_break:
        # A piece that follows a break is at most twice as long as the incoming piece.
        for side in range(2):
            source = node.incoming_lines[side]
            if lines.order_at(all_lines, log, source, tick) <= HARD:
                piece = log[all_lines[source].read_piece]
                end = min(end, tick + 2 * (piece.end - piece.start))
    is_limited = tick == 0 or end < tick + node.next_ticks
    if run.halves_pieces and is_limited and end > node.halved_until:
        # A first piece, like one that breaks limit, is as long at any tolerance.
        node.halved_until = end
        end = tick + (end - tick + 1) // 2
    return end


def is_dense(run: Run, all_lines: Lines, log: Log, l: int, tick: int) -> bool:
    """Return whether hard breaks in a line are too dense to be followed one by one.

    They are if their mean distance is below half of `min_break_spacing`. The mean is taken over
    the part of the line that is known and not yet read, or over the shortest transit if that is
    longer: two breaks in a short known part are no dense series.
    """
    known_ticks = lines.known_until(all_lines, log, l) - tick
    return bool(
        all_lines[l].unread_breaks * run.min_break_spacing
        > 2 * max(known_ticks, run.shortest_transit)
    )


def solve(state: State, node: Node, ticks: int) -> tuple[int, float, float, int, int]:
    """Solve a node on a piece as long as it turns out smooth; events at its start come first.

    Returns
    -------
    int
        Ticks of the piece, 0 without a solution.
    float
        Its truncation error, m/s.
    float
        Position of its first event, from -1 to 1.
    int
        The link of this event, or NONE.
    int
        The new status of the link.
    """
    run = state.runs[0]
    links = state.links
    masses = state.masses
    changes = 0  # of status, at the start of the piece
    changes_of_graze = 8 + node.link_count * node.link_count
    ticks_before = ticks  # duration of the piece that failed before, and its error
    error_before = 0.0
    while True:
        h = ticks * run.tick_duration
        take_inputs(state.lines, state.log, node, ticks)
        error = -1.0  # no solution
        if nodes.collocate(run, links, masses, node, h, state.matrix):
            error = nodes.truncation_error(links, masses, node)
        is_smooth = error <= run.tolerance
        if error >= 0 and (is_smooth or node.is_averaging or ticks <= MIN_PIECE_TICKS):
            event_position, event_link, status = nodes.next_event(run, links, node, h)
            start = 0.5
            if event_link != NONE and links[event_link].status == Status.OPEN:
                start = run.event_window  # it closes with what arrives at the start
            if event_link == NONE or 0.5 * (event_position + 1) * ticks >= start:
                return ticks, error, event_position, event_link, status
            changes += 1
            if changes > MAX_STATUS_CHANGES:
                return ticks, error, 1.0, NONE, 0
            if changes % changes_of_graze == 0 and ticks > MIN_PIECE_TICKS:
                # No status lasts as long as the piece: contacts graze.
                ticks = max(MIN_PIECE_TICKS, ticks // CUT_OF_CHATTER)
            events.apply_transition(state, node, node.now, event_link, status)
        elif ticks <= 1:
            return 0, error, 1.0, NONE, 0
        else:
            factor = shortening(run.tolerance, error, ticks_before, ticks, error_before)
            ticks_before = ticks
            error_before = error
            ticks = max(1, int(ticks * factor))


def take_inputs(all_lines: Lines, log: Log, node: Node, ticks: int) -> None:
    """Set the waves that come in from both sides over a piece."""
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
    """Return the part of a piece, below 1, that may be smooth enough.

    It follows from the error of the piece, and from that of a longer one of `ticks_before` ticks,
    which failed before. After a touch the force starts like a power of time, often 3/2, and the
    error falls as slowly.

    Without a solution `error` is below 0 and tells nothing: then the part is MIN_GROWTH, as small
    as a piece may be wanted beside the one before it.
    """
    if error <= 0:
        return MIN_GROWTH
    power = (
        1.0 * N
    )  # exponent of the error by the duration; that of a smooth piece is N
    if error_before > error:
        observed = math.log(error_before / error) / math.log(ticks_before / ticks)
        power = max(1.0, min(power, observed))
    smallest = MIN_SHORTENING_OF_STARTS
    if power > SLOW_POWER:
        smallest = MIN_SHORTENING
    part = SHORTENING_SAFETY * (tolerance / error) ** (1 / power)
    return max(smallest, min(MAX_SHORTENING, part))


def send_outgoing(state: State, node: Node, ticks: int, left: int, right: int) -> None:
    """Send the waves that leave a node, with the orders of their breaks.

    Each spring and mass of a chain makes breaks one order smoother. `left` and `right` are the
    orders of the breaks that arrive from both sides.
    """
    run = state.runs[0]
    links = state.links
    over = left  # order of the break from the left, behind the links that it has passed
    back = right
    for q in range(node.link_count):
        over = contact_laws.break_order(links[node.first_link + q], over) + 1
        opposite = links[node.first_link + node.link_count - 1 - q]
        back = contact_laws.break_order(opposite, back) + 1
    for side in range(2):
        if node.outgoing_lines[side] == NONE:
            continue
        nodes.set_outgoing(links, node, side)
        if side == 0:
            order = min(left, back - 1)
        else:
            order = min(right, over - 1)
        if node.is_averaging:
            series.flatten(node.outgoing)
            order = 0
        lines.send(
            run, state.lines, state.log, node.outgoing_lines[side], node, ticks, order
        )
