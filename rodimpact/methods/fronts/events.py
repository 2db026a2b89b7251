"""Wave fronts from end to end: the exact solver.

In a uniform segment the velocity is v = (a + b)/2 with a travelling right and b travelling left.
Both are constant between fronts, so the whole motion is a list of fronts: when each left an end,
and the value behind it. What drives an end comes as fronts on the lines from outside, whose transit
takes no time: a velocity, as that of a wall to which the row is bonded, or a force, as the velocity
that it gives.

The log is the queue: one append-only list of fronts; the fronts of a line are chained, `head` is
the next to arrive, `tail` the last sent. What a solution needs later is the log itself. The next
tick of every node stands in a winner tree, so that an event costs O(log n).

Kernels: only + - * / and integer literals on the amplitudes, so that they run on floats and, for
proofs, on fractions, or on numbers with derivatives.
"""

import math
from typing import Any

from ..laws import Status, Stop
from .records import CHANGE, IDLE, NEVER, NONE

MOST = 3  # rows that an event may add to the log


def size_of_tree(nodes: int) -> int:
    """Entries of a winner tree: as many leaves as nodes or more, a power of two, and above them."""
    size = 2
    while size < 2 * nodes:
        size *= 2
    return size


def schedule(tree: Any, i: int, tick: int) -> None:
    """Set leaf i of the winner tree."""
    tree[i] = tick
    while i > 1:
        low = min(tree[i], tree[i ^ 1])
        i //= 2
        tree[i] = low


def begin(run: Any, segment: Any, node: Any, line: Any, log: Any, tree: Any) -> None:
    """Set everything to t = 0.

    Given are transit and mobility of the segments, kind and gap of the nodes, what arrives from the
    walls, and the first `started` rows of the log: for each line, in order of time, the fronts that
    fill it, the first of them one transit ago, so that it has just arrived. Those from outside are
    yet to come.
    """
    n, zero = len(node), 0 * segment[1].mobility
    for l in range(2 * n + 2):
        it = line[l]
        it.first = it.head = it.tail = NONE
        it.due = IDLE
        if 1 < l < 2 * n:
            it.arrived = zero
    for r in range(run.started):
        front = log[r]
        it = line[front.line]
        front.after = NONE
        if it.tail == NONE:
            it.arrived, it.first = front.value, r
        else:
            log[it.tail].after = r
            if it.head == NONE:
                it.head, it.due = r, front.tick + segment[front.line // 2].transit
        it.tail = r
    for k in range(n):
        rest(node[k], zero)
    for s in range(len(segment)):
        segment[s].velocity = segment[s].momentum = segment[s].vibration = zero
    gather(segment, node)
    plant(node, line, log, tree)
    run.now, run.rows, run.events = 0, run.started, 0
    run.probe, run.rest, run.proved = 0, 0, NONE


def rest(at: Any, zero: Any) -> None:
    """Set a node to t = 0."""
    at.status = Status.OPEN.value if at.gap > 0 else at.kind
    at.since, at.rate, at.force, at.speed = 0, zero, zero, zero
    at.impulse, at.lever, at.work, at.peak = zero, zero, zero, zero
    at.first = at.last = at.opened = NONE
    at.pressed = at.episodes = 0


def gather(segment: Any, node: Any) -> None:
    """Find the first and the last of the segments bonded together, for each of them."""
    n = len(node) - 1
    for s in range(n + 2):
        segment[s].first, segment[s].last = (s, s) if 0 < s <= n else (1, 0)
    for s in range(1, n):
        if node[s].status == Status.BOND:
            segment[s + 1].first = segment[s].first
    for i in range(1, n):
        if node[n - i].status == Status.BOND:
            segment[n - i].last = segment[n - i + 1].last


def plant(node: Any, line: Any, log: Any, tree: Any) -> None:
    """Schedule all nodes now; free ends with nothing to do before an arrival, then."""
    leaves = len(tree) // 2
    for k in range(leaves):
        tree[leaves + k] = 0 if k < len(node) else IDLE
        if k < len(node) and node[k].status == Status.FREE:
            l = 3 if k == 0 else 2 * k
            if log[line[l ^ 1].tail].value == line[l].arrived:
                tree[leaves + k] = line[l].due
    for i in range(leaves - 1, 0, -1):
        tree[i] = min(tree[2 * i], tree[2 * i + 1])


def arrive(it: Any, log: Any, transit: int) -> None:
    """Take the front that has come to the end of a line; the one behind it is the next."""
    front = log[it.head]
    it.arrived, it.head, it.due = front.value, front.after, IDLE
    if it.head != NONE:
        it.due = log[it.head].tick + transit


def resolve_contact(at: Any, closing: Any, dt: int, tol: Any, window: int) -> int:
    """Decide a contact after arrivals; return its new status.

    With the gap closed, force = max(0, (a - b)/(Y1 + Y2)) (Signorini), `closing` being a - b. While
    a contact is closed its gap rate is exactly 0. Gap and rate change; the gap closes now if it
    would close within `window` ticks.
    """
    gap = at.gap + at.rate * dt
    status: int = at.status
    if status == Status.OPEN and gap <= max(-at.rate, closing) * window:
        gap, status = 0 * gap, Status.TOUCH.value
    if status != Status.OPEN:
        if closing > tol:
            status = Status.PRESS.value
        elif closing < -tol:
            status = Status.OPEN.value
        elif status == Status.PRESS:
            status = Status.GRAZE.value
    at.gap = gap
    at.rate = -closing if status == Status.OPEN and abs(closing) > tol else 0 * closing
    return status


def note(run: Any, at: Any, row: Any, k: int, t: int, status: int) -> None:
    """Note that contact k, touching, changes at tick t (OPEN to OPEN: a mere touch)."""
    before = at.status
    at.status = status
    if status == Status.PRESS:
        if before != Status.GRAZE:
            at.episodes += 1
        if at.first == NONE:
            at.first = t
        run.probe = IDLE  # nothing is proved before the force ends
    else:
        run.probe = min(run.probe, t)
        if before == Status.PRESS:
            at.last = t
        if status == Status.OPEN and before >= Status.GRAZE:
            at.opened = t
    row.tick, row.line, row.after, row.value = t, CHANGE, k, status


def account(at: Any, dt: int, window: int) -> None:
    """Enter what the force did since the node was last solved."""
    if at.force != 0:
        at.impulse += at.force * dt
        at.lever += at.force * dt * (at.since + dt / 2)
        at.work += at.force * at.speed * dt
        if dt > window:
            at.peak = max(at.peak, at.force)
    if at.status == Status.PRESS:
        at.pressed += dt


def outer_force(at: Any, k: int, a: Any, b: Any, Yl: Any, Yr: Any) -> Any:
    """Force of a bond, or of what is outside, and the velocity of the left end without it."""
    if at.status == Status.BOND:
        return (a - b) / (Yl + Yr), a
    if at.status == Status.PUSH and k == 0:
        return a / Yr, a + b
    if at.status == Status.PUSH:
        return b / Yl, a
    return 0 * a, a


def why_stop(run: Any, t: int, horizon: int, full: bool, events: int) -> int:
    """Why a run stops before the next event, that at tick t; NONE if it does not."""
    if t > horizon:
        return Stop.DONE.value
    if t > run.probe and events >= run.rest:
        return Stop.CHECK.value
    if full:
        return Stop.FULL.value
    if events >= run.limit and t > run.now:
        return Stop.CAP.value
    return Stop.NONE.value


def advance(
    run: Any, segment: Any, node: Any, line: Any, log: Any, tree: Any, horizon: int
) -> int:
    """Run to `horizon`, until the log is full, or until a proof of finality is due.

    All arrivals of one tick at one node are taken together, then the node is solved once. Nothing
    is half done when the function returns: grow the log and call again.
    """
    tol, window, leaves = run.tolerance, run.window, len(tree) // 2
    n, events, room = run.rows, run.events, len(log) - MOST
    stop = why_stop(run, tree[1], horizon, n > room, events)
    while stop == Stop.NONE:
        # the earliest time at which waves arrive somewhere, or a gap closes
        t, i = tree[1], 1
        while i < leaves:
            i = 2 * i + (tree[2 * i] != t)
        k, t = i - leaves, tree[i]  # as large as at the root; its derivatives are its own
        at, Yl, Yr, dt = node[k], segment[k].mobility, segment[k + 1].mobility, t - node[k].since
        for l in (2 * k, 2 * k + 3):
            if line[l].due == t:
                arrive(line[l], log, segment[l // 2].transit)
        a, b = line[2 * k].arrived, line[2 * k + 3].arrived
        account(at, dt, window)
        # the force from now on: of a contact that presses, a bond, or what is outside
        F, u, at.since = 0 * a, a, t
        if at.status >= Status.OPEN:
            new = resolve_contact(at, a - b, dt, tol, window)
            if new != at.status or (new == Status.OPEN and dt > 0 and at.gap == 0):
                note(run, at, log[n], k, t, new)
                n += 1
            if new == Status.PRESS:
                F = (a - b) / (Yl + Yr)
        elif at.status != Status.FREE:
            F, u = outer_force(at, k, a, b, Yl, Yr)
        at.force, at.speed = F, u - F * Yl
        # waves that leave to the left and to the right: a front where they change
        for l in range(2 * k + 1, 2 * k + 3):
            out = u - 2 * F * Yl if l % 2 else b + 2 * F * Yr
            q = line[l].tail
            if q != NONE and abs(out - log[q].value) > tol:
                new_front(line[l], log, n, t, l, out)
                if line[l].head == NONE:
                    line[l].head, line[l].due = n, t + segment[l // 2].transit
                    there = leaves + k - 1 + 2 * (1 - l % 2)
                    if line[l].due < tree[there]:
                        schedule(tree, there, line[l].due)
                n += 1
        due = min(line[2 * k].due, line[2 * k + 3].due)
        if at.status == Status.OPEN:
            due = closing_time(at, t, due, window)
        schedule(tree, leaves + k, due)
        run.now = t
        events += 1
        stop = why_stop(run, tree[1], horizon, n > room, events)
    run.rows, run.events = n, events
    return stop


def new_front(it: Any, log: Any, n: int, t: int, l: int, value: Any) -> None:
    """Send a front on a line, as row n of the log."""
    front = log[n]
    front.tick, front.after, front.line, front.value = t, NONE, l, value
    log[it.tail].after = n
    it.tail = n


def closing_time(at: Any, t: int, due: int, window: int) -> int:
    """When an open contact is solved again: as its gap closes, or when a wave arrives."""
    if at.gap < -at.rate * (NEVER - t):
        close: int = t + math.trunc((2 * at.gap - at.rate) / (-2 * at.rate))
        if close + window < due:
            return close
    return due


def close_books(run: Any, node: Any, t: int) -> None:
    """Bring gaps and tallies up to tick t, at which nothing happens."""
    for k in range(len(node)):
        at, dt = node[k], t - node[k].since
        account(at, dt, run.window)
        at.gap, at.since = at.gap + at.rate * dt, t
