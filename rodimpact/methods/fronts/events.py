"""Wave fronts from end to end: the exact solver, one event after another.

Both waves of a segment are constant between fronts, so the whole motion is a list of
fronts: when each left an end, and the value behind it. What drives an end comes as
fronts on the lines from outside, whose transit takes no time: a velocity, as that of
a wall to which the row is bonded, or a force, as the velocity that it gives.

An event is a node at a tick at which waves arrive there, or its gap closes. The log
holds all fronts ever sent; those of one line are chained, so that the log is also the
list of what is under way, and all that a solution needs later.

Kernels do only + - * / with whole numbers on amplitudes, so that they run on floats
and, for proofs, on fractions, or on numbers with derivatives.
"""

from typing import Any

from ..laws import Status, Stop
from . import contact, event_queue
from .records import IDLE, NONE, Front, Line, Node, Run, State

ROWS_PER_EVENT = 3  # most rows of the log that an event adds


# Start --------------------------------------------------------------------------------


def start(state: State) -> None:
    """Set everything to t = 0.

    Given are transit and mobility of the segments, kind and gap of the nodes, what
    arrives from the walls, and the first `initial_rows` rows of the log. For each line
    in order of time these are the fronts that fill it, the first of them one transit
    ago, so that it has just arrived. Those from outside are yet to come.
    """
    run = state.runs[0]
    zero = 0 * state.segments[1].mobility
    empty_lines(state.lines, zero)
    chain_initial_fronts(state)
    for node in state.nodes:
        contact.reset(node, zero)
    for segment in state.segments:
        segment.velocity = zero
        segment.momentum = zero
        segment.vibration = zero
    find_bonded_groups(state.segments, state.nodes)
    fill_queue(state)
    run.now = 0
    run.rows = run.initial_rows
    run.events = 0
    run.proof_tick = 0
    run.proof_events = 0
    run.proved = NONE


def empty_lines(lines: Any, zero: Any) -> None:
    """Take all fronts off the lines; what arrives from outside stays."""
    last = len(lines) - 1
    for l in range(len(lines)):
        line = lines[l]
        line.first_row = NONE
        line.next_row = NONE
        line.last_row = NONE
        line.due = IDLE
        if 1 < l < last - 1:
            line.arrived = zero


def chain_initial_fronts(state: State) -> None:
    """Put the fronts of the log at t = 0 on their lines."""
    log = state.log
    for r in range(state.runs[0].initial_rows):
        front = log[r]
        line = state.lines[front.line]
        front.next_row = NONE
        if line.last_row == NONE:
            line.arrived = front.value
            line.first_row = r
        else:
            log[line.last_row].next_row = r
            if line.next_row == NONE:
                line.next_row = r
                line.due = front.tick + state.segments[front.line // 2].transit
        line.last_row = r


def find_bonded_groups(segments: Any, nodes: Any) -> None:
    """Find the first and the last of the segments bonded together, for each of them."""
    n = len(nodes) - 1
    for s in range(n + 2):
        inside = 0 < s <= n
        segments[s].first = s if inside else 1
        segments[s].last = s if inside else 0
    for k in range(1, n):
        if nodes[k].status == Status.BOND:
            segments[k + 1].first = segments[k].first
    for k in range(n - 1, 0, -1):
        if nodes[k].status == Status.BOND:
            segments[k].last = segments[k + 1].last


def fill_queue(state: State) -> None:
    """Schedule all nodes now; a free end at which nothing changes, at its arrival."""
    queue = state.queue
    leaves = len(queue) // 2
    for k in range(leaves):
        queue[leaves + k] = IDLE
    for k in range(len(state.nodes)):
        queue[leaves + k] = 0
        if state.nodes[k].status == Status.FREE:
            incoming = 3 if k == 0 else 2 * k
            outgoing = incoming ^ 1
            arrived = state.lines[incoming].arrived
            if state.log[state.lines[outgoing].last_row].value == arrived:
                queue[leaves + k] = state.lines[incoming].due
    event_queue.build(queue)


# Events -------------------------------------------------------------------------------


def advance(state: State, horizon: int) -> int:
    """Run to tick `horizon`, until the log is full, or until a proof is due.

    All arrivals of one tick at one node are taken together, then the node is solved
    once. Nothing is half done when this returns: grow the log and call again.

    Returns
    -------
    int
        Why it stopped, as `laws.Stop`.
    """
    run = state.runs[0]
    segments = state.segments
    nodes = state.nodes
    lines = state.lines
    log = state.log
    queue = state.queue
    tolerance = run.tolerance
    window = run.window
    leaves = len(queue) // 2
    last_free = len(log) - ROWS_PER_EVENT
    rows = run.rows
    events = run.events
    stop = why_stop(run, queue[1], horizon, rows > last_free, events)
    while stop == Stop.NONE:
        leaf = event_queue.first_leaf(queue)
        t = queue[leaf]  # with derivatives of its own, where it has some
        k = leaf - leaves
        node = nodes[k]
        dt = t - node.solved
        left_mobility = segments[k].mobility
        right_mobility = segments[k + 1].mobility

        # Waves arrive.
        from_left = lines[2 * k]
        from_right = lines[2 * k + 3]
        if from_left.due == t:
            receive(from_left, log, segments[k].transit)
        if from_right.due == t:
            receive(from_right, log, segments[k + 1].transit)
        a = from_left.arrived
        b = from_right.arrived

        # The force from now on, and the velocity of the left face without it.
        contact.accumulate(node, dt, window)
        node.solved = t
        force = 0 * a
        velocity = a
        if node.status >= Status.OPEN:
            closing = a - b
            status = contact.resolve_contact(node, closing, dt, tolerance, window)
            touched = status == Status.OPEN and dt > 0 and node.gap == 0
            if status != node.status or touched:
                contact.record_change(run, node, log[rows], k, t, status)
                rows += 1
            if status == Status.PRESS:
                force = closing / (left_mobility + right_mobility)
        elif node.status == Status.BOND:
            force = (a - b) / (left_mobility + right_mobility)
        elif node.status == Status.PUSH and k == 0:
            force = a / right_mobility
            velocity = a + b
        elif node.status == Status.PUSH:
            force = b / left_mobility
        node.force = force
        node.face_velocity = velocity - force * left_mobility

        # Waves leave: to the left, then to the right. Where one changes, a front does.
        for side in range(2):
            l = 2 * k + 1 + side
            line = lines[l]
            if side == 0:
                wave = velocity - 2 * force * left_mobility
            else:
                wave = b + 2 * force * right_mobility
            last_row = line.last_row
            if last_row != NONE and abs(wave - log[last_row].value) > tolerance:
                send(line, log, rows, t, l, wave)
                if line.next_row == NONE:  # nothing else is under way
                    line.next_row = rows
                    line.due = t + segments[l // 2].transit
                    neighbour = leaf - 1 + 2 * side
                    if line.due < queue[neighbour]:
                        event_queue.schedule(queue, neighbour, line.due)
                rows += 1

        due = min(from_left.due, from_right.due)
        if node.status == Status.OPEN:
            due = contact.closing_tick(node, t, due, window)
        event_queue.schedule(queue, leaf, due)
        run.now = t
        events += 1
        stop = why_stop(run, queue[1], horizon, rows > last_free, events)
    run.rows = rows
    run.events = events
    return stop


def why_stop(run: Run, tick: int, horizon: int, full: bool, events: int) -> int:
    """Why a run stops before its next event, that at `tick`; NONE if it does not."""
    if tick > horizon:
        return Stop.DONE.value
    if tick > run.proof_tick and events >= run.proof_events:
        return Stop.CHECK.value
    if full:
        return Stop.FULL.value
    if events >= run.event_limit and tick > run.now:
        return Stop.CAP.value
    return Stop.NONE.value


def receive(line: Line, log: Any, transit: int) -> None:
    """Take the front that arrives; the one behind it in the line is next."""
    front = log[line.next_row]
    line.arrived = front.value
    line.next_row = front.next_row
    line.due = IDLE
    if line.next_row != NONE:
        line.due = log[line.next_row].tick + transit


def send(line: Line, log: Any, row: int, tick: int, l: int, wave: Any) -> None:
    """Send a front on line l, as a row of the log."""
    front: Front = log[row]
    front.tick = tick
    front.next_row = NONE
    front.line = l
    front.value = wave
    log[line.last_row].next_row = row
    line.last_row = row


def close_books(state: State, tick: int) -> None:
    """Bring gaps and totals of all nodes up to a tick at which nothing happens."""
    run = state.runs[0]
    for k in range(len(state.nodes)):
        node: Node = state.nodes[k]
        dt = tick - node.solved
        contact.accumulate(node, dt, run.window)
        node.gap = node.gap + node.gap_rate * dt
        node.solved = tick
