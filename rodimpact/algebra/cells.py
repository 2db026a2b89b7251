"""Where a formula holds: the inequalities on which a run depends.

Between contacts the mechanics is linear, so that the order of events at free ends and at joints
changes no result. What decides are the contacts: when they begin and cease to press, that those
which press go on to, that those which are apart stay so, and why they never meet again. A cell is
the list of the numbers that must be positive for this.

Two waves that come to a contact one after the other, while it presses or is open throughout, may
also come in the other order, if it presses or is open in between then as well: what each wave
sends out and adds to the impulse does not depend on the other. Conditions are for both orders then,
and not for the order itself. What follows is the same in both: sums over the jumps of waves. Only
the levels between two such jumps in a rod differ, see `_apart`.
"""

from __future__ import annotations

from typing import Any

from ..methods.fronts.front_kernel import (
    CHANGES,
    FINALITY,
    FULL,
    OPEN,
    PRESS,
    ROWS,
    deviation_bound,
    finality_time,
    group_motion,
    play,
    quiet,
    side,
)
from ..methods.groups import unilateral
from ..model import Wall
from .numbers import HALF, ZERO, Number
from .rows import ExactRun

Loop = list[tuple[Number, Number]]
"""Levels of the waves that go round in a rod, and when each began to leave its left end."""
ENDLESS = 1 << 62


def conditions(run: ExactRun) -> list[Number]:
    """Numbers that are positive throughout the cell of this run; those that depend on names."""
    contacts = unilateral(run.row.system)
    end, wait = _end(run)
    found: list[Number] = []
    loops = []
    for k in contacts:
        after = _for_ever_after(run, k, end)
        if isinstance(after, tuple):
            loops.append(after)
        else:
            found += after
    longest = max(sum(run.state.transit[s : e + 1]) for s, e in run.row.spans if e)
    # what is under way must not come before the end: let it come
    _go_on(run, end + wait + 2 * longest)
    for k in contacts:
        found += _while_it_lasts(run, k, end, end + wait)
    ordered = {x.value for x in found}
    for left, right in loops:
        found += _apart(left, right, ordered)
    distinct = {x.value: x for x in found if x.made and x.value}
    return list(distinct.values())


def _go_on(run: ExactRun, until: Any) -> None:
    while play(run.state, run.tally, run.log, run.clock, until, ENDLESS, ZERO, 0) == FULL:
        for column in run.log:
            column += [0] * len(column)


def _end(run: ExactRun) -> tuple[Number, Number]:
    """When it is over, and how much longer the run is to be followed.

    That is the instant of the proof, or the next event if the kernel waited for it. Where contacts
    had been open for a while by then it is half of this later, so that the proof has room.
    """
    state, log, clock = run.state, run.log, run.clock
    end: Number = clock[FINALITY] + ZERO
    if not any(end == t for times in (log.tick, log.change_tick) for t in times[: clock[ROWS]]):
        later: Number = state.tree[1]
        _go_on(run, later)
        proved: Any = finality_time(state, log, later, ZERO)  # type: ignore[arg-type]
        end = later if proved == later else end
    last = max((t + ZERO for t in log.change_tick[: clock[CHANGES]]), default=ZERO)
    wait = (end - last) * HALF
    _go_on(run, end + wait)
    return end + wait, wait


def _while_it_lasts(run: ExactRun, contact: int, end: Number, until: Number) -> list[Number]:
    """Order of what happens at a contact, force while it presses, gap while it is open."""
    log, T, k = run.log, run.state.transit, run.nodes[contact]
    arrived = [run.state.arrived[0] if k == 0 else ZERO,
               run.state.arrived[-1] if k == len(T) - 2 else ZERO]
    events: dict[Any, list[Any]] = {}  # by time: itself, the waves that arrive, the new status
    for r in range(run.clock[ROWS]):
        if log.line[r] in (2 * k, 2 * k + 3):
            t = log.tick[r] + T[log.line[r] // 2]
            event = events.setdefault(t.value, [t, None, None, None])
            event[1 + (log.line[r] != 2 * k)] = log.value[r]
    for i in range(run.clock[CHANGES]):
        if log.change_node[i] == k:
            t = log.change_tick[i] + ZERO
            events.setdefault(t.value, [t, None, None, None])[3] = log.change_status[i]
    history, found = [], []  # time, how fast the contact would close from then on, the new status
    for at in sorted(events):
        t, *waves, new = events[at]
        arrived = [old if wave is None else wave for old, wave in zip(arrived, waves, strict=True)]
        if at > until.value:
            found.append(t - end)
        else:
            history.append((t, arrived[0] - arrived[1], new))
    gap, closing, before = run.numbers.gap[contact] * run.rate, ZERO, [ZERO]
    status, i = OPEN if gap > 0 else -1, 0
    while i < len(history):
        (t, then, new), now = history[i], [history[i][0]]
        if new is None:
            steps, after = _steps(status, gap, closing, before[-1], history[i : i + 1])
        else:
            status, after = new, ZERO
            steps = {PRESS: [then], OPEN: [-then]}.get(new, [])
        if new is None and t > 0 and status in (PRESS, OPEN) and history[i + 1 : i + 2]:
            t2, then2, new2 = history[i + 1]
            swapped = [(t2, closing + then2 - then, None), (t, then2, None)]
            both = [_steps(status, gap, closing, before[-1], pair)
                    for pair in (history[i : i + 2], swapped)]
            if new2 is None and all(x > 0 for way, _ in both for x in way):
                steps, after = [x for way, _ in both for x in way], both[0][1]
                now, then = [t, t2], then2
        found += [later - t for later in now for t in before if later > 0] + steps
        gap, closing, before, i = after, then, now, i + len(now)
    return found


def _steps(
    status: int, gap: Number, closing: Number, before: Number, events: list[Any]
) -> tuple[list[Number], Number]:
    """What is positive as waves come to a contact whose status stays, and the gap thereafter."""
    found = []
    for t, then, _ in events:
        if status == OPEN:
            gap -= closing * (t - before)
            found.append(gap)
        elif status == PRESS:
            found.append(then)
        closing, before = then, t
    return found, gap


def _for_ever_after(run: ExactRun, k: int, t: Any) -> list[Number] | tuple[Loop, Loop]:
    """Why contact k does not press again after t, if the levels beside it do not tell.

    Bodies whose centres go apart do not meet once the gap between these motions is wider than
    vibration can bridge. The bound is that of `separation_time` of the kernel, but for the energy:
    here it is that of all vibration, which follows from the velocities and impulses.
    """
    state, log, node = run.state, run.log, run.nodes[k]
    if state.rate[node] >= 0 and quiet(state, node, False) and quiet(state, node, True):
        return [state.rate[node]]
    vl, _, high, bounded_l = group_motion(state, log, node, False, t)
    vr, low, _, bounded_r = group_motion(state, log, node, True, t)
    if bounded_l and bounded_r and low >= high:
        return _loop(run, node, False), _loop(run, node, True)
    dl, _ = deviation_bound(state, log, node, False, t, vl)
    dr, _ = deviation_bound(state, log, node, True, t, vr)
    gap = state.gap[node] + state.rate[node] * (t - state.since[node]) - dr + dl
    slack = _slack(run, node, False) + _slack(run, node, True)
    return [vr - vl, gap, gap * gap - 2 * _vibration(run) * slack]


def _vibration(run: ExactRun) -> Number:
    """Energy of vibration in the end: what the centres have lost, and what moving walls did."""
    numbers, results, transit = run.numbers, run.results, run.state.transit
    energy, impulses = ZERO, [ZERO, *results.impulses, ZERO]
    for i, ((first, last), v) in enumerate(zip(run.row.spans, numbers.velocity, strict=True)):
        if isinstance(run.row.system.bodies[i], Wall):
            energy += (impulses[i + 1] - impulses[i]) * run.rate * v
        V = results.velocities_after[i]
        for s in range(first, last + 1):
            energy += transit[s] * numbers.impedance[s - 1] * (v * v - V * V) * HALF
    return energy


def _slack(run: ExactRun, k: int, right: bool) -> Number:
    """How far the end at contact k can get from its mean motion: its square over twice the energy.

    It is integral(g^2 dx/(E A)), see `deviation_bound` of the kernel.
    """
    state, total, beyond = run.state, ZERO, ZERO
    first, last = side(state, k, right)
    pieces = range(first, last + 1)
    if last == 0 or quiet(state, k, right):
        return ZERO
    masses = {s: state.transit[s] / state.mobility[s] for s in pieces}
    whole = sum(masses.values(), ZERO)
    for s in reversed(pieces) if right else pieces:
        near, beyond = beyond, beyond + masses[s] / whole
        size = near * near + near * beyond + beyond * beyond
        total += state.mobility[s] * state.transit[s] * size / 3
    return total


def _loop(run: ExactRun, k: int, right: bool) -> Loop:
    """What goes round in the rod beside contact k, in the order in which it left there."""
    state, log = run.state, run.log
    s, last = side(state, k, right)
    if last == 0 or quiet(state, k, right):
        return [(state.arrived[2 * k + 3 if right else 2 * k], ZERO)]
    found = []
    for l, delay in ((2 * s + right, ZERO), (2 * s + 1 - right, state.transit[s])):
        r = state.head[l]
        while r >= 0:
            found.append((log.value[r], log.tick[r] + delay))
            r = log.after[r]
    return found


def _apart(left: Loop, right: Loop, ordered: set[Any]) -> list[Number]:
    """Levels on the right are above those on the left, also where two jumps change places."""
    found = []
    levels = [[level for level, _ in loop] for loop in (left, right)]
    for loop, mine, others, sign in ((left, *levels, 1), (right, *levels[::-1], -1)):
        for i, ((level, t), (then, later)) in enumerate(zip(loop, loop[1:], strict=False)):
            between = loop[i - 1][0] + then - level
            if (later - t).value in ordered:
                continue
            if all((other - between).value * sign > 0 for other in others):
                mine.append(between)
            else:
                found.append(later - t)
    return found + [high - low for high in levels[1] for low in levels[0]]
