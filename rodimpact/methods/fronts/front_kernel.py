"""Wave fronts from end to end: the exact solver.

In a uniform segment the velocity is v = (a + b)/2 with a travelling right and b travelling left.
Both are constant between fronts, so the whole motion is a list of fronts: when each left an end,
and the value behind it. Node k joins the segments k and k + 1; line 2s carries a and line 2s + 1
carries b through segment s. The segments 0 and n + 1 stand for what lies outside: nothing, a wall,
which is a segment of mobility 0, or an endless bar. Waves are velocities in a frame chosen by the
caller. What drives an end comes as fronts on the lines from outside, whose transit takes no time: a
velocity, as that of a wall to which the row is bonded, or a force, as the velocity that it gives.

The log is the queue: one append-only list of fronts; the fronts of a line are chained, `head` is
the next to arrive, `tail` the last sent. What a solution needs later is the log itself. The next
tick of every node stands in a winner tree, so that an event costs O(log n).

Kernels: only + - * / and integer literals on the amplitudes, so that they run on lists of floats,
on NumPy arrays and, for proofs, on lists of fractions, or of numbers with derivatives. Time is an
integer number of ticks, lengths are velocity times ticks, an impulse is velocity times ticks over
mobility.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

FREE, BOND, PUSH, OPEN, TOUCH, GRAZE, PRESS = range(7)  # status of a node, see `resolve_contact`
DONE, FULL, CHECK, CAP, FINAL, CLOCK = range(6)  # why a run stopped
NEVER = 1 << 62  # the clock ends here
IDLE = (1 << 63) - 1  # tick of a node at which nothing is due
NOW, ROWS, CHANGES, EVENTS, PROBE, REST, FINALITY = range(7)  # places in the clock


class State(NamedTuple):
    """State of a row of n segments: lists or arrays, changed in place."""

    transit: Any  # [segment] transit time, ticks
    mobility: Any  # [segment] 1/Z, 0 for a wall
    status: Any  # [node] PUSH: an end under a given force
    since: Any  # [node] tick at which the node was last touched
    gap: Any  # [node]
    rate: Any  # [node] d(gap)/dt
    force: Any  # [node] on the right segment
    speed: Any  # [node] of the left segment's right end
    arrived: Any  # [line] value at the receiving end
    head: Any  # [line] log row of the next front to arrive, -1 if none is under way
    tail: Any  # [line] log row of the last front sent, -1 for lines leading outside
    tree: Any  # [2 * leaves] winner tree of the nodes' next ticks


class Tally(NamedTuple):
    """What has passed through each node, kept as the run goes."""

    impulse: Any  # [node] integral of the force
    work: Any  # [node] integral of force times speed: energy handed from left to right
    peak: Any  # [node] largest force that lasted longer than the window
    first: Any  # [node] tick of the first force, -1 before
    last: Any  # [node] tick at which the last force ended, -1 before
    opened: Any  # [node] tick at which the gap last opened after a force, -1 before
    pressed: Any  # [node] ticks under force
    episodes: Any  # [node] number of times a closed contact began to press


class Log(NamedTuple):
    """Fronts in the order they were sent, and changes of contact status."""

    tick: Any  # [row] when the front left its end
    after: Any  # [row] next front of the same line, -1 if none yet
    line: Any  # [row]
    value: Any  # [row] wave behind the front
    change_tick: Any  # [turn]
    change_node: Any  # [turn]
    change_status: Any  # [turn] the new status


class GroupState(NamedTuple):
    """What the segments hold at one time, in the frame of the waves."""

    velocity: Any  # [segment] of the motion about which it vibrates
    momentum: Any  # [segment]
    vibration: Any  # [segment] energy


class Results(NamedTuple):
    """What became of the members, in the units of their numbers; in rows, one a member."""

    flag: Any  # [member] why the run stopped; FULL if the log was too short, or it was not run
    final: Any  # [member] whether it is proved that no contact can happen again
    before: Any  # [member * segments] velocity of the bonded group's motion
    after: Any  # [member * segments]
    vibration: Any  # [member] energy left
    impulse: Any  # [member * nodes], as are the others; see Tally
    peak_force: Any
    duration: Any
    episodes: Any


def schedule(tree: Any, i: int, tick: int) -> None:
    """Set leaf i of the winner tree."""
    tree[i] = tick
    while i > 1:
        low = min(tree[i], tree[i ^ 1])
        i //= 2
        tree[i] = low


def begin(state: State, tally: Tally, log: Log, clock: Any, count: int) -> None:
    """Set everything to t = 0.

    Given are transit, mobility, status and gap of the row, what arrives from the walls, and the
    first `count` rows of the log: for each line, in order of time, the fronts that fill it, the
    first of them one transit ago, so that it has just arrived. Those from outside are yet to come.
    """
    n = len(state.status)
    zero = 0 * state.mobility[1]
    for l in range(2, 2 * n):
        state.arrived[l], state.head[l], state.tail[l] = zero, -1, -1
    for l in (0, 1, 2 * n, 2 * n + 1):
        state.head[l] = state.tail[l] = -1
    for r in range(count):
        l = log.line[r]
        log.after[r] = -1
        if state.tail[l] < 0:
            state.arrived[l] = log.value[r]
        else:
            log.after[state.tail[l]] = r
            if state.head[l] < 0:
                state.head[l] = r
        state.tail[l] = r
    for k in range(n):
        state.since[k], state.rate[k], state.force[k], state.speed[k] = 0, zero, zero, zero
        tally.impulse[k], tally.work[k], tally.peak[k] = zero, zero, zero
        tally.first[k], tally.last[k], tally.opened[k] = -1, -1, -1
        tally.pressed[k], tally.episodes[k] = 0, 0
    leaves = len(state.tree) // 2
    for k in range(leaves):
        state.tree[leaves + k] = 0 if k < n else IDLE
        if k < n and state.status[k] == FREE:
            l = 3 if k == 0 else 2 * k
            if log.value[state.tail[l ^ 1]] == state.arrived[l]:  # nothing to do before an arrival
                r = state.head[l]
                state.tree[leaves + k] = log.tick[r] + state.transit[l // 2] if r >= 0 else IDLE
    for i in range(leaves - 1, 0, -1):
        state.tree[i] = min(state.tree[2 * i], state.tree[2 * i + 1])
    clock[NOW], clock[ROWS], clock[CHANGES], clock[EVENTS] = 0, count, 0, 0
    clock[PROBE], clock[REST], clock[FINALITY] = 0, 0, -1


def resolve_contact(state: State, k: int, dt: int, tol: Any, window: int) -> int:
    """Decide contact k after its arrivals; return its new status.

    With the gap closed, force = max(0, (a - b)/(Y1 + Y2)) (Signorini). OPEN: a gap, or parting.
    TOUCH: closed, not yet pressed since it closed. PRESS: force > 0. GRAZE: closed, pressed before,
    force 0 now. While a contact is closed its gap rate is exactly 0. Gap and rate change; the gap
    closes now if it would close within `window` ticks.
    """
    closing = state.arrived[2 * k] - state.arrived[2 * k + 3]
    gap = state.gap[k] + state.rate[k] * dt
    status: int = state.status[k]
    if status == OPEN and gap <= max(-state.rate[k], closing) * window:
        gap, status = 0 * gap, TOUCH
    if status != OPEN:
        if closing > tol:
            status = PRESS
        elif closing < -tol:
            status = OPEN
        elif status == PRESS:
            status = GRAZE
    state.gap[k] = gap
    state.rate[k] = -closing if status == OPEN and abs(closing) > tol else 0 * closing
    return status


def record(state: State, tally: Tally, log: Log, clock: Any, k: int, t: int, status: int) -> None:
    """Note that contact k, touching, changes to `status` at tick t (OPEN to OPEN: a mere touch)."""
    before = state.status[k]
    state.status[k] = status
    if status == PRESS:
        if before != GRAZE:
            tally.episodes[k] += 1
        if tally.first[k] < 0:
            tally.first[k] = t
        clock[PROBE] = IDLE  # nothing is proved before the force ends
    else:
        clock[PROBE] = min(clock[PROBE], t)
        if before == PRESS:
            tally.last[k] = t
        if status == OPEN and before >= GRAZE:
            tally.opened[k] = t
    n = clock[CHANGES]
    log.change_tick[n], log.change_node[n], log.change_status[n] = t, k, status
    clock[CHANGES] = n + 1


def advance(
    state: State, tally: Tally, log: Log, clock: Any, horizon: int, limit: int, tol: Any,
    window: int,
) -> int:
    """Run to `horizon`, until the log is full, or until a proof of finality is due.

    All arrivals of one tick at one node are taken together, then the node is solved once. Nothing
    is half done when the function returns: grow the log and call again.
    """
    T, Y, tree = state.transit, state.mobility, state.tree
    arrived, status = state.arrived, state.status
    head, tail, since, force = state.head, state.tail, state.since, state.force
    tick, after, value = log.tick, log.after, log.value
    leaves, n, events = len(tree) // 2, clock[ROWS], clock[EVENTS]
    probe, rest, room, changes = clock[PROBE], clock[REST], len(value) - 2, len(log.change_tick)
    flag = DONE
    while tree[1] <= horizon:
        # the earliest time at which waves arrive somewhere, or a gap closes
        t, i = tree[1], 1
        if t > probe and events >= rest:
            flag = CHECK
            break
        if n > room or clock[CHANGES] >= changes:
            flag = FULL
            break
        if events >= limit and t > clock[NOW]:
            flag = CAP
            break
        while i < leaves:
            i = 2 * i + (tree[2 * i] != t)
        k, t = i - leaves, tree[i]  # as large as at the root; its derivatives are its own
        # waves that arrive at the node from its left and its right side
        for l in (2 * k, 2 * k + 3):
            r = head[l]
            if r >= 0 and tick[r] + T[l // 2] == t:
                arrived[l], head[l] = value[r], after[r]
        a, b, Yl, Yr, dt = arrived[2 * k], arrived[2 * k + 3], Y[k], Y[k + 1], t - since[k]
        # what the force did since the node was last solved
        if force[k] != 0:
            tally.impulse[k] += force[k] * dt
            tally.work[k] += force[k] * state.speed[k] * dt
            if dt > window:
                tally.peak[k] = max(tally.peak[k], force[k])
        # the force from now on: of a contact that presses, a bond, or what is outside
        F, since[k] = 0 * a, t
        if status[k] >= OPEN:
            if status[k] == PRESS:
                tally.pressed[k] += dt
            new = resolve_contact(state, k, dt, tol, window)
            if new != status[k] or (new == OPEN and dt > 0 and state.gap[k] == 0):
                record(state, tally, log, clock, k, t, new)
                probe = clock[PROBE]
            if new == PRESS:
                F = (a - b) / (Yl + Yr)
        elif status[k] != FREE:
            if status[k] == BOND:
                F = (a - b) / (Yl + Yr)
            elif k == 0:
                F, a = a / Yr, a + b
            else:
                F = b / Yl
        force[k], state.speed[k] = F, a - F * Yl
        # waves that leave to the left and to the right: a front where they change
        for l in (2 * k + 1, 2 * k + 2):
            out = b + 2 * F * Yr
            if l % 2:
                out = a - 2 * F * Yl
            q = tail[l]
            if q >= 0 and abs(out - value[q]) > tol:
                tick[n], after[n], log.line[n], value[n] = t, -1, l, out
                after[q] = tail[l] = n
                if head[l] < 0:
                    head[l], j = n, leaves + k - 1 + 2 * (1 - l % 2)
                    if t + T[l // 2] < tree[j]:
                        schedule(tree, j, t + T[l // 2])
                n += 1
        # when the node is to be solved again: at the next arrival, or as its gap closes
        due = IDLE
        for l in (2 * k, 2 * k + 3):
            if head[l] >= 0:
                due = min(due, tick[head[l]] + T[l // 2])
        if status[k] == OPEN and state.gap[k] < -state.rate[k] * (NEVER - t):
            rate = state.rate[k]
            close = t + math.trunc((2 * state.gap[k] - rate) / (-2 * rate))
            if close + window < due:
                due = close
        schedule(tree, leaves + k, due)
        clock[NOW] = t
        events += 1
    clock[ROWS], clock[EVENTS] = n, events
    return flag


def side(state: State, k: int, right: bool) -> tuple[int, int]:
    """First and last segment bonded together on one side of contact k; (1, 0) for a wall."""
    status, n = state.status, len(state.status) - 1
    if (right and k == n) or (not right and k == 0):
        return 1, 0
    first, last = (k + 1, k + 1) if right else (k, k)
    while right and last < n and status[last] == BOND:
        last += 1
    while not right and first > 1 and status[first - 1] == BOND:
        first -= 1
    return first, last


def quiet(state: State, k: int, right: bool) -> bool:
    """Whether no front is under way in the bonded group beside contact k."""
    first, last = side(state, k, right)
    for l in range(2 * first, 2 * last + 2):  # noqa: SIM110
        if state.head[l] >= 0:
            return False
    return True


def group_motion(state: State, log: Log, k: int, right: bool, t: int) -> tuple[Any, Any, Any, bool]:
    """Mean velocity of the bonded group beside contact k, and bounds of its ends' velocities.

    Returns
    -------
    mean, low, high : velocity
        low and high bound the velocity of the end at the contact as long as nothing touches the
        group; they hold for a uniform segment that is free (its waves go round unchanged) or goes
        on for ever, a wall and a group at rest. The mean of what is held, or goes on for ever, is
        that to which it will come.
    bounded : bool
        Whether they hold.
    """
    status, arrived = state.status, state.arrived
    first, last = side(state, k, right)
    if last == 0:
        wall = arrived[2 * k + 3] if right else arrived[2 * k]
        return wall, wall, wall, True
    mass, momentum = 0 * arrived[2 * first], 0 * arrived[2 * first]
    low = high = arrived[2 * first]
    for s in range(first, last + 1):
        Z = 1 / state.mobility[s]
        mass += 2 * Z * state.transit[s]
        for l in (2 * s, 2 * s + 1):
            r, wave, edge = state.head[l], arrived[l], state.transit[s]
            low, high = min(low, wave), max(high, wave)
            while r >= 0:
                momentum += Z * wave * (edge - t + log.tick[r])
                edge, wave = t - log.tick[r], log.value[r]
                low, high = min(low, wave), max(high, wave)
                r = log.after[r]
            momentum += Z * wave * edge
    mean = momentum / mass
    bounded, endless = first == last, False
    if status[first - 1] == BOND:
        mean, endless = arrived[0], state.mobility[0] > 0
        bounded = bounded and endless
    if status[last] == BOND:
        mean, endless = arrived[2 * last + 3], state.mobility[last + 1] > 0
        bounded = bounded and endless
    if quiet(state, k, right) and not (endless and status[k] == PRESS):
        return mean, mean, mean, True
    return mean, low, high, bounded


def deviation_bound(
    state: State, log: Log, k: int, right: bool, t: int, mean: Any
) -> tuple[Any, Any]:
    """How far the group's end at contact k is from its mean motion, and can ever get.

    The end of a free body deviates from the motion of the centre of mass by
    d = integral(strain * g dx), g the mass fraction beyond x as seen from that end, hence by at
    most sqrt(2 E integral(g^2 dx/(E A))), E the energy of vibration. A wall at the far end has all
    the mass. A far endless bar of mobility Y gives way by Y p, p the momentum that it has taken; as
    p <= sqrt(2 m E), m Y^2 adds to the integral.

    Returns
    -------
    d : length
        Deviation now, positive to the right.
    bound2 : length squared
        The bound's square.
    """
    status, arrived, zero = state.status, state.arrived, 0 * mean
    first, last = side(state, k, right)
    if last == 0:
        return zero, zero
    mass = zero
    for s in range(first, last + 1):
        mass += state.transit[s] / state.mobility[s]
    anchored = status[first - 1] == BOND or status[last] == BOND
    give = zero
    if anchored:
        give += state.mobility[len(state.mobility) - 1 if right else 0]
    beyond, d, energy, taken = zero, zero, zero, zero
    slack = mass * give * give
    for i in range(last - first + 1):
        s = first + i if right is False else last - i
        T, Y = state.transit[s], state.mobility[s]
        g0, beyond = beyond, beyond + T / (Y * mass)
        g1 = beyond
        if anchored:
            g0 = g1 = 1 + zero
        slack += Y * T * (g0 * g0 + g0 * g1 + g1 * g1) / 3
        for l in (2 * s, 2 * s + 1):
            outward = (l % 2 == 1) == right  # runs towards the end at the contact
            sign = 1 if l % 2 else -1
            r, wave, edge = state.head[l], arrived[l], T
            more = True
            while more:
                more = r >= 0
                low = t - log.tick[r] if more else 0
                width = edge - low
                energy += (wave - mean) * (wave - mean) * width / (4 * Y)
                taken += (wave - mean) * width / (2 * Y)
                place = (edge + low) / (2 * T) if outward else 1 - (edge + low) / (2 * T)
                d += sign * (wave - mean) * width * (g0 + (g1 - g0) * place) / 2
                if more:
                    edge, wave, r = low, log.value[r], log.after[r]
    if right:
        d = -d
    d -= give * taken
    if quiet(state, k, right) and not (give > 0 and status[k] == PRESS):
        return d, zero
    return d, 2 * energy * slack


def separation_time(state: State, log: Log, k: int, t: int, tol: Any) -> int:
    """When contact k is proved not to close again: t if now, IDLE if not before a new contact."""
    if state.rate[k] >= 0 and quiet(state, k, False) and quiet(state, k, True):
        return t
    vl, _, high, bounded_l = group_motion(state, log, k, False, t)
    vr, low, _, bounded_r = group_motion(state, log, k, True, t)
    if bounded_l and bounded_r and low - high >= -tol:
        return t
    opening = vr - vl
    if opening < -tol:
        return IDLE
    dl, bl = deviation_bound(state, log, k, False, t, vl)
    dr, br = deviation_bound(state, log, k, True, t, vr)
    gap = state.gap[k] + state.rate[k] * (t - state.since[k]) - dr + dl
    if gap > 0 and gap * gap > 2 * (bl + br):
        return t
    if opening <= tol:
        return IDLE
    wait = (math.sqrt(2 * (bl + br)) - gap) / opening
    if wait >= NEVER // 2:
        return IDLE
    return t + int(wait * 1.000001) + 1


def finality_time(state: State, log: Log, t: int, tol: Any) -> int:
    """When the collision can be proved final: t if now, IDLE if not before a new contact.

    For rows whose ends are not driven: no bound holds for a body that is pushed.
    """
    latest = t
    for k in range(len(state.status)):
        if state.status[k] >= OPEN and latest < IDLE:
            latest = max(latest, separation_time(state, log, k, t, tol))
    return latest


def close_books(state: State, tally: Tally, t: int, window: int) -> None:
    """Bring gaps and tallies up to tick t, at which nothing happens."""
    for k in range(len(state.status)):
        dt = t - state.since[k]
        state.since[k] = t
        state.gap[k] += state.rate[k] * dt
        tally.impulse[k] += state.force[k] * dt
        tally.work[k] += state.force[k] * state.speed[k] * dt
        if state.status[k] == PRESS:
            tally.pressed[k] += dt
            if dt > window:
                tally.peak[k] = max(tally.peak[k], state.force[k])


def play(
    state: State, tally: Tally, log: Log, clock: Any, until: int, limit: int, tol: Any, window: int
) -> int:
    """Run to tick `until`, or if it is negative to the proof of finality and -until ticks more.

    Returns DONE (reached `until`), FINAL (proved, and run on), FULL (grow the log and call again),
    CAP (more than `limit` events) or CLOCK (2^62 ticks are over). clock[FINALITY] is the tick of
    the proof, -1 without; at the end clock[NOW] is the tick reached. After a failed proof the next
    one waits for an eighth more events, so that proofs cost no more than the run itself.
    """
    horizon = until
    if until >= 0:
        clock[REST] = IDLE  # nothing is to be proved on the way
    else:
        horizon = NEVER - 1 if clock[FINALITY] < 0 else min(clock[FINALITY] - until, NEVER - 1)
    while True:
        flag = advance(state, tally, log, clock, horizon, limit, tol, window)
        if flag in (FULL, CAP):
            break
        if flag == DONE and (until >= 0 or clock[FINALITY] >= 0):
            clock[NOW] = horizon
            break
        now = clock[NOW]
        if flag == CHECK:
            now = max(now, clock[PROBE])
        when = finality_time(state, log, now, tol)
        if when == now:
            clock[FINALITY], clock[REST] = now, IDLE
            horizon = min(now - until, NEVER - 1)
        elif flag == DONE:
            flag = CLOCK
            break
        else:
            clock[PROBE] = when
            clock[REST] = clock[EVENTS] + len(state.status) + clock[EVENTS] // 8
    if flag != FULL:
        close_books(state, tally, clock[NOW], window)
    if (
        flag in (DONE, CAP) and clock[FINALITY] < 0
        and finality_time(state, log, clock[NOW], tol) == clock[NOW]
    ):
        clock[FINALITY] = clock[NOW]
    if until < 0 and flag == DONE:
        return FINAL
    return flag


def segment_totals(state: State, log: Log, t: int, stock: GroupState) -> None:
    """Take stock at tick t: momentum, and energy of vibration about stock.velocity, by segment.

    Momentum is (Z/2) integral(a + b), energy (Z/4) integral((a - V)^2 + (b - V)^2).
    """
    for s in range(1, len(state.transit) - 1):
        Z, V = 1 / state.mobility[s], stock.velocity[s]
        total, square = 0 * V, 0 * V
        for l in (2 * s, 2 * s + 1):
            r, wave, edge = state.head[l], state.arrived[l], state.transit[s]
            while r >= 0:
                width = edge - t + log.tick[r]
                total += wave * width
                square += (wave - V) * (wave - V) * width
                edge, wave, r = t - log.tick[r], log.value[r], log.after[r]
            total += wave * edge
            square += (wave - V) * (wave - V) * edge
        stock.momentum[s], stock.vibration[s] = Z * total / 2, Z * square / 4


def bonded_from(state: State, first: int) -> tuple[int, Any]:
    """Last segment of the group that begins with this one, and the mass of the group per tick."""
    last, mass = first, state.transit[first] / state.mobility[first]
    while last < len(state.status) - 1 and state.status[last] == BOND:
        last += 1
        mass += state.transit[last] / state.mobility[last]
    return last, mass


def group_velocity(state: State, stock: GroupState) -> None:
    """Set the velocities of bonded groups from their momenta."""
    first = 1
    while first < len(state.status):
        last, mass = bonded_from(state, first)
        momentum = stock.momentum[first]
        for s in range(first + 1, last + 1):
            momentum += stock.momentum[s]
        for s in range(first, last + 1):
            stock.velocity[s] = momentum / mass
        first = last + 1


def initial_state(state: State, log: Log, stock: GroupState) -> None:
    """Take stock at t = 0: momenta, and the velocities that go with them."""
    for s in range(len(stock.velocity)):
        stock.velocity[s] = 0 * state.mobility[1]
    segment_totals(state, log, 0, stock)
    group_velocity(state, stock)


def final_state(
    state: State, tally: Tally, log: Log, t: int, opening: GroupState, stock: GroupState
) -> None:
    """Take stock at the end, tick t: free groups have the velocity that their impulses gave them.

    That is more exact than what the momenta of their waves say, and independent of it; only groups
    bonded to what is outside have no other.
    """
    n = len(state.status) - 1
    for s in range(n + 2):
        stock.velocity[s] = opening.velocity[s]
    if state.status[0] == BOND or state.status[n] == BOND:
        segment_totals(state, log, t, stock)
        group_velocity(state, stock)
    first = 1
    while first <= n:
        last, mass = bonded_from(state, first)
        if state.status[first - 1] != BOND and state.status[last] != BOND:
            pushed = (tally.impulse[first - 1] - tally.impulse[last]) / mass
            for s in range(first, last + 1):
                stock.velocity[s] = opening.velocity[s] + pushed
        first = last + 1
    segment_totals(state, log, t, stock)


def load(
    state: State, tally: Tally, log: Log, clock: Any, members: Any, m: int, status: Any
) -> None:
    """Set everything to t = 0 for member m; arguments as of `family`."""
    nodes, segments = len(state.status), len(state.transit)
    fronts = len(members.tick) // len(members.count)
    for s in range(segments):
        state.transit[s] = members.transit[m * segments + s]
        state.mobility[s] = members.mobility[m * segments + s]
    for k in range(nodes):
        state.status[k] = status[m * nodes + k]
        state.gap[k] = members.gap[m * nodes + k]
    state.arrived[0] = members.outside[2 * m]
    state.arrived[2 * nodes + 1] = members.outside[2 * m + 1]
    for r in range(members.count[m]):
        f = m * fronts + r
        log.tick[r], log.line[r] = members.tick[f], members.line[f]
        log.value[r] = members.value[f]
    begin(state, tally, log, clock, members.count[m])


def run_member(
    state: State, tally: Tally, log: Log, clock: Any, stocks: tuple[GroupState, GroupState],
    members: Any, status: Any, limit: int, results: Results, m: int,
) -> None:
    """Run member m of a family to its target, see `family`."""
    nodes, segments = len(state.status), len(state.transit)
    results.flag[m], results.final[m] = FULL, False
    if members.count[m] == 0 or members.count[m] + 2 > len(log.tick):
        return
    load(state, tally, log, clock, members, m, status)
    initial_state(state, log, stocks[0])
    flag = play(
        state, tally, log, clock, members.target[m], limit, members.tolerance[m],
        members.window[m],
    )
    results.flag[m], results.final[m] = flag, clock[FINALITY] >= 0
    if flag == FULL:
        return
    final_state(state, tally, log, clock[NOW], stocks[0], stocks[1])
    frame, tick, vibration = members.frame[m], members.tick_seconds[m], 0 * state.mobility[1]
    for s in range(segments):
        i = m * segments + s
        results.before[i] = stocks[0].velocity[s] + frame
        results.after[i] = stocks[1].velocity[s] + frame
        vibration += stocks[1].vibration[s]
    results.vibration[m] = vibration * tick
    for k in range(nodes):
        i = m * nodes + k
        results.impulse[i], results.peak_force[i] = tally.impulse[k] * tick, tally.peak[k]
        results.duration[i], results.episodes[i] = tally.pressed[k] * tick, tally.episodes[k]


def family(
    state: State, tally: Tally, log: Log, clock: Any, stocks: tuple[GroupState, GroupState],
    members: Any, status: Any, limit: int, results: Results,
) -> None:
    """Run every member to its target, in the same work space.

    Parameters
    ----------
    state, tally, log, clock, stocks
        Work space of one run.
    members : Layout
        As the layout kernel makes it; those whose `count` is 0 are not run.
    status : [member * nodes]
        At t = 0, before anything is solved.
    limit : int
        Largest number of events of a member.
    results : Results
        Filled in; a member that is not run or that fills the log has its flag only.
    """
    for m in range(len(members.count)):
        run_member(state, tally, log, clock, stocks, members, status, limit, results, m)
