"""Derivatives along the log of a run: what each front, force and time does when a number changes.

As long as the order of events stays, the tick of each front is a sum of transit times, that of a
closing gap a quotient of gap and velocity, and the wave behind it a rational function of
impedances. So a run of the front kernel is made first; then its log is gone through once, and each
node is solved again for the derivatives, its decisions by the front kernel's own `resolve_contact`.

Where two events meet that move apart when the number changes, or something just vanishes, the order
of events may change, and the derivatives may differ on both sides: the first such event is told.

Derivatives in P directions stand side by side: that of entry i in direction p is at i * P + p.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ..methods.fronts.front_kernel import (
    BOND,
    CHANGES,
    FINAL,
    FINALITY,
    OPEN,
    PRESS,
    ROWS,
    GroupState,
    Log,
    Results,
    State,
    Tally,
    resolve_contact,
    run_member,
)

SMOOTH, ARRIVALS, CLOSING, FORCE, FRONT, PARTING, BORDER = range(7)  # what may come otherwise
LEAST = 1e-8  # relative size of a derivative that is not round-off


class Begin(NamedTuple):
    """Derivatives at t = 0, in SI units and in rows, one a member."""

    transit: Any  # [member * segments inside * P] relative
    impedance: Any  # [member * segments inside * P] relative
    velocity: Any  # [member * segments inside * P]
    stretching: Any  # [member * segments inside * P] of wave speed times strain
    gap: Any  # [member * nodes * P]
    outside: Any  # [member * 2 * P] waves of walls and endless bars
    least: Any  # [member * P] see `Tangents`


class Tangents(NamedTuple):
    """Work space: derivatives of the front kernel's state, tally and log, in their units."""

    transit: Any  # [segment * P]
    mobility: Any  # [segment * P]
    since: Any  # [node * P]
    gap: Any  # [node * P] when the node was last touched
    rate: Any  # [node * P]
    force: Any  # [node * P]
    impulse: Any  # [node * P]
    pressed: Any  # [node * P]
    arrived: Any  # [line * P]
    sent: Any  # [line * P] wave that left last
    tick: Any  # [row * P]
    value: Any  # [row * P]
    now: Any  # [P] time at which the node at hand is solved
    least: Any  # [P] size up to which the derivative of a wave is round-off


class Derivatives(NamedTuple):
    """What is found out about the members, per unit of what changes; in rows, one a member."""

    impulse: Any  # [member * nodes * P], as is the other
    duration: Any
    event: Any  # [member * P] SMOOTH, or what the first event is that may come otherwise
    when: Any  # [member * P] its time, or if there is none when the collision is over
    where: Any  # [member * P] its node


def note(found: Derivatives, i: int, event: int, t: int, k: int) -> None:
    """Note the first event of direction i that may come otherwise."""
    if found.event[i] == SMOOTH:
        found.event[i], found.when[i], found.where[i] = event, t, k


def begin_tangents(start: Begin, state: State, tick: Any, m: int, x: Tangents) -> None:
    """Set the derivatives at t = 0 of member m, one tick of whose clock is this long."""
    nodes, P = len(state.status), len(x.now)
    for p in range(P):
        for end in range(2):  # an endless bar is of the impedance of what it goes on from
            s, inside = end * nodes, m * (nodes - 1) + end * (nodes - 2)
            x.transit[s * P + p] = 0.0
            x.mobility[s * P + p] = -state.mobility[s] * start.impedance[inside * P + p]
            x.arrived[(2 * s + end) * P + p] = start.outside[(2 * m + end) * P + p]
        x.least[p] = start.least[m * P + p]
    for i in range(P, nodes * P):
        s, j = i // P, (m * (nodes - 1) - 1) * P + i
        x.transit[i] = state.transit[s] * start.transit[j]
        x.mobility[i] = -state.mobility[s] * start.impedance[j]
        x.arrived[i + s * P] = start.velocity[j] - start.stretching[j]
        x.arrived[i + s * P + P] = start.velocity[j] + start.stretching[j]
    for i in range(nodes * P):
        x.gap[i] = start.gap[m * nodes * P + i] / tick
        x.since[i] = x.rate[i] = x.force[i] = x.impulse[i] = x.pressed[i] = 0.0


def rewind(state: State, log: Log, count: int, members: Any, status: Any, m: int) -> None:
    """Set the nodes and lines of a finished run back to t = 0."""
    nodes = len(state.status)
    for l in range(2 * nodes + 2):
        state.head[l] = state.tail[l] = -1
    for r in range(count):
        l = log.line[r]
        state.arrived[l], state.head[l], state.tail[l] = log.value[r], log.after[r], r
    for k in range(nodes):
        state.status[k], state.gap[k] = status[m * nodes + k], members.gap[m * nodes + k]
        state.since[k], state.rate[k], state.force[k] = 0, 0 * state.gap[k], 0 * state.gap[k]


def take_arrivals(
    state: State, log: Log, x: Tangents, k: int, t: int, found: Derivatives, m: int
) -> bool:
    """Take what arrives at node k up to tick t; whether anything does at t, which then moves so."""
    P, met = len(x.now), False
    for l in (2 * k, 2 * k + 3):
        r, s = state.head[l], l // 2
        while r >= 0 and log.tick[r] + state.transit[s] <= t:
            state.arrived[l], due = log.value[r], log.tick[r] + state.transit[s] == t
            for p in range(P):
                x.arrived[l * P + p] = x.value[r * P + p]
                if due:
                    when, now = x.tick[r * P + p] + x.transit[s * P + p], x.now[p]
                    if met and abs(when - now) > LEAST * (abs(when) + abs(now)):
                        note(found, m * P + p, ARRIVALS, t, k)
                    x.now[p] = when
            met, r = met or due, log.after[r]
        state.head[l] = r
    return met


def pass_node(
    state: State, log: Log, x: Tangents, k: int, t: int, tol: Any, window: int, found: Derivatives,
    m: int,
) -> None:
    """Solve node k again, at tick t, at which something happened there."""
    P, Y, old, rate = len(x.now), state.mobility, state.force[k], state.rate[k]
    dt, before = t - state.since[k], state.status[k]
    for p in range(P):
        x.now[p] = 0 * x.now[p]
    met = take_arrivals(state, log, x, k, t, found, m)
    a, b, Yl, Yr = state.arrived[2 * k], state.arrived[2 * k + 3], Y[k], Y[k + 1]
    status = before
    if before >= OPEN:
        status = resolve_contact(state, k, dt, tol, window)
    closes = before == OPEN and dt > 0 and state.gap[k] == 0
    pressing = status in (PRESS, BOND)
    F = (a - b) / (Yl + Yr) if pressing else 0 * a
    state.status[k], state.since[k], state.force[k] = status, t, F
    for p in range(P):
        i, j = k * P + p, m * P + p
        # when it is, if a gap closes; else how wide the gap is
        gap = x.gap[i] + x.rate[i] * dt - rate * x.since[i]
        if closes and not met:
            x.now[p] = -gap / rate
        now = x.now[p]
        if closes and met and abs(gap + rate * now) > LEAST * (abs(gap) + abs(rate * now)):
            note(found, j, CLOSING, t, k)
        x.gap[i] = gap + rate * now if status == OPEN and not closes else 0 * gap
        # what the force did since the node was last solved
        x.impulse[i] += x.force[i] * dt + old * (now - x.since[i])
        if before == PRESS:
            x.pressed[i] += now - x.since[i]
        # the waves from now on
        da, db = x.arrived[2 * k * P + p], x.arrived[(2 * k + 3) * P + p]
        dYl, dYr = x.mobility[k * P + p], x.mobility[(k + 1) * P + p]
        dF = (da - db - F * (dYl + dYr)) / (Yl + Yr) if pressing else 0 * da
        if status > OPEN and not pressing and abs(da - db) > x.least[p]:
            note(found, j, FORCE, t, k)
        x.since[i], x.force[i], x.rate[i] = now, dF, db - da if status == OPEN else 0 * da
        x.sent[(2 * k + 1) * P + p] = da - 2 * (dF * Yl + F * dYl)
        x.sent[(2 * k + 2) * P + p] = db + 2 * (dF * Yr + F * dYr)
        # a front that is not there, as it vanishes just here
        for l in (2 * k + 1, 2 * k + 2):
            out, q = b + 2 * F * Yr, state.tail[l]
            if l % 2:
                out = a - 2 * F * Yl
            if q >= 0 and abs(out - log.value[q]) <= tol and (
                abs(x.sent[l * P + p] - x.value[q * P + p]) > x.least[p]
            ):
                note(found, j, FRONT, t, k)


def pass_log(
    state: State, log: Log, x: Tangents, clock: Any, count: int, tol: Any, window: int,
    found: Derivatives, m: int,
) -> None:
    """Go through the log of a finished run, to the proof that it is over."""
    P, end, rows, changes = len(x.now), clock[FINALITY], clock[ROWS], clock[CHANGES]
    nodes = len(state.status)
    for r in range(count):
        for p in range(P):
            l = log.line[r]
            x.tick[r * P + p], x.value[r * P + p] = -x.transit[l // 2 * P + p], x.arrived[l * P + p]
    for k in range(nodes):
        for p in range(P):
            if state.gap[k] == 0 and x.gap[k * P + p] != 0:
                note(found, m * P + p, BORDER, 0, k)
        pass_node(state, log, x, k, 0, tol, window, found, m)
    r, c = count, 0
    while r < rows or c < changes:
        if c < changes and (r >= rows or log.change_tick[c] <= log.tick[r]):
            t, k, l = log.change_tick[c], log.change_node[c], -1
            c += 1
        else:
            t, l = log.tick[r], log.line[r]
            k = l // 2 - 1 + l % 2
        if t > end:
            break
        if state.since[k] < t:
            pass_node(state, log, x, k, t, tol, window, found, m)
        if l >= 0:
            for p in range(P):
                x.tick[r * P + p], x.value[r * P + p] = x.since[k * P + p], x.sent[l * P + p]
            state.tail[l] = r
            r += 1
    for k in range(nodes):
        dt = end - state.since[k]
        for p in range(P):
            i = k * P + p
            x.impulse[i] += x.force[i] * dt - state.force[k] * x.since[i]
            if state.status[k] == PRESS:
                x.pressed[i] -= x.since[i]


def derive(
    start: Begin, state: State, tally: Tally, log: Log, clock: Any,
    stocks: tuple[GroupState, GroupState], members: Any, status: Any, limit: int,
    results: Results, x: Tangents, found: Derivatives,
) -> None:
    """Run every member, as `family` of the front kernel does, and go through its log.

    Parameters
    ----------
    start, x
        See `begin_tangents`.
    state, tally, log, clock, stocks, members, status, limit, results
        See `family`.
    found : Derivatives
        Filled in, of members that are proved final.
    """
    entries, P = len(x.impulse), len(x.now)
    for m in range(len(members.count)):
        run_member(state, tally, log, clock, stocks, members, status, limit, results, m)
        if results.flag[m] != FINAL:
            continue
        tick = members.tick_seconds[m]
        for i in range(m * P, m * P + P):
            found.event[i], found.when[i] = SMOOTH, clock[FINALITY]
        rewind(state, log, members.count[m], members, status, m)
        begin_tangents(start, state, tick, m, x)
        pass_log(state, log, x, clock, members.count[m], members.tolerance[m], members.window[m],
                 found, m)
        for i in range(entries):
            found.impulse[m * entries + i] = x.impulse[i] * tick
            found.duration[m * entries + i] = x.pressed[i] * tick
        for i in range(m * P, m * P + P):
            found.when[i] *= tick
