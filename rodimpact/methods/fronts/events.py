"""Wave fronts from end to end: the exact solver, one event after another.

Both waves of a segment are constant between fronts, so the whole motion is a list of
fronts: when each left an end, and the wave behind it. A driven end receives fronts on
its line from outside, with transit time 0: a given velocity V is the wave a = V, and a
given force F is the wave a = F Y. A wall bonded to the row has a constant velocity.

An event happens at a node, at a tick at which waves arrive there or its gap closes. The
log holds all fronts ever sent. The fronts of a line are chained, so that the log also
gives the fronts in flight. A solution needs nothing else later.

Kernels do only + - * /, abs and comparisons with whole constants on amplitudes, so that
they run on floats and, in exact arithmetic, on fractions.
"""

from collections.abc import Sequence

from ..states import Status, Stop
from . import contact, event_queue
from .records import IDLE, NONE, Amplitude, Front, Line, Log, Node, Run, Segment, State

MAX_ROWS_PER_EVENT = 3  # rows of the log: a change of status and two fronts


# Start --------------------------------------------------------------------------------


def start(state: State) -> None:
    """Set lines, nodes, groups, event queue and progress of the run to t = 0.

    No event is solved yet: the nodes are due at t = 0. The following must be set:
    transit and mobility of the segments, closed status and gap of the nodes, the waves
    that arrive from walls, and the first `initial_rows` rows of the log. These rows are
    the fronts that fill each line, in order of time. The first front of a line left one
    transit before t = 0, so that it has just arrived. On a line from outside the first
    front holds from t = 0 on, and later ones arrive at their own tick.
    """
    run = state.runs[0]
    zero = 0 * state.segments[1].mobility  # 0 of the same kind of number
    empty_lines(state.lines, zero)
    chain_initial_fronts(state)
    for node in state.nodes:
        contact.reset_node(node, zero)
    for segment in state.segments:
        segment.group_velocity = zero
        segment.momentum = zero
        segment.vibration_energy = zero
    find_bonded_groups(state.segments, state.nodes)
    schedule_all_nodes(state)
    run.now = 0
    run.log_rows = run.initial_rows
    run.events = 0
    run.next_proof_tick = 0
    run.next_proof_event = 0
    run.proved_tick = NONE


def empty_lines(lines: Sequence[Line], zero: Amplitude) -> None:
    """Take all fronts off the lines.

    `incoming_wave` becomes `zero` on the lines inside the row. On the first two and the
    last two lines, which lie outside, it is kept: it is the wave of a wall.
    """
    for l in range(len(lines)):
        line = lines[l]
        line.first_row = NONE
        line.next_row = NONE
        line.last_row = NONE
        line.arrival_tick = IDLE
        if 2 <= l < len(lines) - 2:  # inside the row
            line.incoming_wave = zero


def chain_initial_fronts(state: State) -> None:
    """Put the fronts that the log has at t = 0 on their lines, which must be empty.

    The fronts of a line are chained in the order of the log: `next_row` of a front is
    the row of the front behind it. The first front of a line has just arrived: its
    value is the incoming wave. The second front arrives next: `next_row` of the line is
    its row.
    """
    log = state.log
    for r in range(state.runs[0].initial_rows):
        front = log[r]
        line = state.lines[front.line]
        front.next_row = NONE
        if line.last_row == NONE:  # the first front of its line
            line.incoming_wave = front.value
            line.first_row = r
        else:
            log[line.last_row].next_row = r
            if line.next_row == NONE:  # the second front of its line
                line.next_row = r
                # Segment s has the lines 2 s and 2 s + 1.
                segment = state.segments[front.line // 2]
                line.arrival_tick = front.tick + segment.transit
        line.last_row = r


def find_bonded_groups(segments: Sequence[Segment], nodes: Sequence[Node]) -> None:
    """Set `group_first` and `group_last` of each segment: the ends of its bonded group.

    A segment that is bonded to no other is a group of one. The two segments outside the
    row get the empty range from 1 to 0, even where they are bonded to the row.
    """
    n = len(nodes) - 1
    for s in range(n + 2):
        segments[s].group_first = s
        segments[s].group_last = s
        if s < 1 or s > n:  # outside the row
            segments[s].group_first = 1
            segments[s].group_last = 0
    # Node k joins the segments k and k + 1. Segments of a group get `group_first` from
    # their left neighbours, and `group_last` from their right neighbours.
    for k in range(1, n):
        if nodes[k].status == Status.BOND:
            segments[k + 1].group_first = segments[k].group_first
    for k in range(n - 1, 0, -1):
        if nodes[k].status == Status.BOND:
            segments[k].group_last = segments[k + 1].group_last


def schedule_all_nodes(state: State) -> None:
    """Fill the event queue: every node is due at t = 0, except some free ends.

    A free end whose outgoing wave equals the incoming one has no event at t = 0, but is
    due at its next arrival. Leaves of the queue that have no node are IDLE.
    """
    queue = state.queue
    leaves = len(queue) // 2
    for k in range(leaves):
        queue[leaves + k] = IDLE
    # Segment s has the line 2 s to the right and the line 2 s + 1 to the left.
    for k in range(len(state.nodes)):
        queue[leaves + k] = 0
        if state.nodes[k].status == Status.FREE:
            # Line that arrives here from inside the row: the line to the left in
            # segment 1, or the line to the right in the last segment
            incoming = 3 if k == 0 else 2 * k
            outgoing = incoming ^ 1  # the other line of this segment
            incoming_wave = state.lines[incoming].incoming_wave
            last_row = state.lines[outgoing].last_row
            # A free end reflects the wave that arrives unchanged: if the outgoing wave
            # already equals it, there is no event.
            if state.log[last_row].value == incoming_wave:
                queue[leaves + k] = state.lines[incoming].arrival_tick
    event_queue.build_tree(queue)


# Events -------------------------------------------------------------------------------


def advance(state: State, horizon: int) -> int:
    """Run to tick `horizon`, or to a full log, a proof that is due, or the cap.

    At each event, one node takes its arrivals, finds its status and force, and sends a
    front on each line where the outgoing wave changes. Events at tick `horizon` are
    included. This never stops within an event: if the log is full, grow it and call
    again. The state is changed: nodes, lines, log, queue, and the progress in the run.
    `run.now` is the tick of the last event.

    Returns
    -------
    int
        Why it stopped, as `states.Stop`.
    """
    run = state.runs[0]
    segments = state.segments
    nodes = state.nodes
    lines = state.lines
    log = state.log
    queue = state.queue
    tolerance = run.velocity_tolerance
    window = run.round_off_window
    leaves = len(queue) // 2  # leaf `leaves + k` of the queue is the tick of node k
    # An event fits into the log if its first row is not after this one.
    last_free_row = len(log) - MAX_ROWS_PER_EVENT
    rows = run.log_rows
    events = run.events
    # queue[1] is the earliest tick of all nodes.
    is_full = rows > last_free_row
    stop = find_stop(run, queue[1], horizon, is_full, events)
    while stop == Stop.NONE:
        leaf = event_queue.first_leaf(queue)
        tick = queue[leaf]
        k = leaf - leaves
        node = nodes[k]

        # Arrivals: the wave a from the left, and b from the right
        from_left = lines[2 * k]  # the line to the right in segment k
        from_right = lines[2 * k + 3]  # the line to the left in segment k + 1
        if from_left.arrival_tick == tick:
            receive(from_left, log, segments[k].transit)
        if from_right.arrival_tick == tick:
            receive(from_right, log, segments[k + 1].transit)
        a = from_left.incoming_wave
        b = from_right.incoming_wave
        next_arrival = min(from_left.arrival_tick, from_right.arrival_tick)

        # Totals up to now, before the force changes
        dt = tick - node.solved_tick
        contact.accumulate_contact_totals(node, dt, window)
        node.solved_tick = tick

        # Status and force from now on
        left_mobility = segments[k].mobility
        right_mobility = segments[k + 1].mobility
        if node.status >= Status.OPEN:  # a contact that can open
            status = contact.resolve_contact(node, a - b, dt, tolerance, window)
            # A touch without a force: an open gap has closed and opens again at once.
            # At dt = 0 no gap closes: the contact has just opened.
            is_touch = status == Status.OPEN and dt > 0 and node.gap == 0
            is_change = status != node.status
            if is_change or is_touch:
                mobility = left_mobility + right_mobility
                contact.log_contact_change(
                    run, node, log[rows], k, tick, status, mobility
                )
                rows += 1
        is_left_end = k == 0
        # Velocity of the left face without the force: a, but a + b at a left end under
        # a given force
        force_free_velocity = contact.solve_force(
            node, a, b, left_mobility, right_mobility, is_left_end
        )
        force = node.force

        # A front is sent where the outgoing wave changes: on line 2 k + 1 to the left,
        # or on line 2 k + 2 to the right.
        for side in range(2):
            l = 2 * k + 1 + side
            if side == 0:
                # b' = a - 2 F Y1
                wave = force_free_velocity - 2 * force * left_mobility
            else:
                # a' = b + 2 F Y2
                wave = b + 2 * force * right_mobility
            line = lines[l]
            # Row of the front sent last on this line, whose value is the wave so far;
            # NONE on a line that leads out of the row
            last_row = line.last_row
            if last_row != NONE and abs(wave - log[last_row].value) > tolerance:
                send(line, log, rows, tick, l, wave)
                if line.next_row == NONE:  # no other front is in flight
                    line.next_row = rows
                    line.arrival_tick = tick + segments[k + side].transit
                    # The front arrives at node k - 1 or k + 1.
                    neighbour = leaf - 1 + 2 * side
                    if line.arrival_tick < queue[neighbour]:
                        event_queue.schedule(queue, neighbour, line.arrival_tick)
                rows += 1

        # The next event of this node
        next_tick = next_arrival
        if node.status == Status.OPEN:  # its gap may close before the next arrival
            next_tick = contact.find_closing_tick(node, tick, next_arrival, window)
        event_queue.schedule(queue, leaf, next_tick)
        run.now = tick
        events += 1
        is_full = rows > last_free_row
        stop = find_stop(run, queue[1], horizon, is_full, events)
    run.log_rows = rows
    run.events = events
    return stop


def find_stop(run: Run, tick: int, horizon: int, is_full: bool, events: int) -> int:
    """Why a run stops before its next event, as `states.Stop`; NONE if it goes on.

    `tick` is that of the next event, and `events` the number of events so far. The
    reasons are checked in this order. DONE: the event is after `horizon`. CHECK: a
    proof is due, as the event is after `run.next_proof_tick`, so that all events up to
    that tick have happened, and `events` has reached `run.next_proof_event`. FULL: the
    log has no room for an event, as `is_full` says. CAP: `max_events` of the run is
    reached, and all events at the tick `run.now` of the last one have happened.
    """
    if tick > horizon:
        return Stop.DONE.value
    if tick > run.next_proof_tick and events >= run.next_proof_event:
        return Stop.CHECK.value
    if is_full:
        return Stop.FULL.value
    if events >= run.max_events and tick > run.now:
        return Stop.CAP.value
    return Stop.NONE.value


def receive(line: Line, log: Log, transit: int) -> None:
    """Take the front that arrives off its line; there must be one.

    Its value becomes the incoming wave of the line. The front behind it becomes the
    next to arrive, `transit` ticks after it was sent. If there is none, `next_row`
    becomes NONE and `arrival_tick` IDLE.
    """
    front = log[line.next_row]
    line.incoming_wave = front.value
    line.next_row = front.next_row
    line.arrival_tick = IDLE
    if line.next_row != NONE:
        line.arrival_tick = log[line.next_row].tick + transit


def send(
    line: Line, log: Log, log_row: int, tick: int, l: int, wave: Amplitude
) -> None:
    """Write a front that leaves on line `l` at `tick` into row `log_row` of the log.

    `line` is the record of line `l`, and `wave` the wave behind the front, m/s. The
    front is chained behind the last front of the line, which must have one. If it is
    the next front to arrive, the caller sets `next_row` and `arrival_tick` of the line.
    """
    front: Front = log[log_row]
    front.tick = tick
    front.next_row = NONE
    front.line = l
    front.value = wave
    log[line.last_row].next_row = log_row
    line.last_row = log_row


def advance_totals_to(state: State, tick: int) -> None:
    """Bring gaps and totals of all nodes up to `tick`, which precedes the next event.

    Status, force and gap rate of each node do not change; `solved_tick` becomes `tick`.
    """
    run = state.runs[0]
    for k in range(len(state.nodes)):
        node: Node = state.nodes[k]
        dt = tick - node.solved_tick
        # A force that lasts no longer than the window does not count for the peak.
        contact.accumulate_contact_totals(node, dt, run.round_off_window)
        node.gap = node.gap + node.gap_rate * dt
        node.solved_tick = tick
