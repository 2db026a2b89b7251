"""Where a formula holds: the inequalities on which a run depends.

Between contacts the mechanics is linear, so that the order of events at free ends and at joints
changes no result. What decides are the contacts: in which order waves arrive there, whether those
that touch press, whether those that are apart stay so, and why they never meet again. A cell is the
list of the numbers that must be positive for this.
"""

from __future__ import annotations

from typing import Any

from ..methods.fronts.front_kernel import (
    CHANGES,
    FINALITY,
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
from .numbers import ZERO, Number
from .rows import ExactRun


def conditions(run: ExactRun) -> list[Number]:
    """Numbers that are positive throughout the cell of this run; those that depend on names."""
    contacts = unilateral(run.row.system)
    end = _end(run)
    found = [x for k in contacts for x in _for_ever_after(run, run.nodes[k], end)]
    longest = max(sum(run.state.transit[s : e + 1]) for s, e in run.row.spans if e)
    # what is under way must not come before the end: let it come
    play(run.state, run.tally, run.log, run.clock, -2 * longest, len(run.log.value), ZERO, 0)
    for k in contacts:
        found += _while_it_lasts(run, k, end)
    distinct = {x.value: x for x in found if x.made and x.value}
    return list(distinct.values())


def _end(run: ExactRun) -> Number:
    """When it is over: the instant of the proof, or the next event if the kernel waited for it."""
    state, log, clock = run.state, run.log, run.clock
    end: Number = clock[FINALITY] + ZERO
    if any(end == t for times in (log.tick, log.change_tick) for t in times[: clock[ROWS]]):
        return end
    later: Number = state.tree[1]
    until: Any = end - later
    play(state, run.tally, log, clock, until, len(log.value), ZERO, 0)
    proved: Any = finality_time(state, log, later, ZERO)  # type: ignore[arg-type]
    return later if proved == later else end


def _while_it_lasts(run: ExactRun, contact: int, end: Number) -> list[Number]:
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
    found: list[Number] = []
    gap = run.numbers.gap[contact] * run.rate
    status, rate, before = OPEN if gap > 0 else -1, ZERO, ZERO
    for at in sorted(events):
        t, *waves, new = events[at]
        if at > end.value:
            found.append(t - end)
            continue
        if at > 0:
            found.append(t - before)
        arrived = [old if wave is None else wave for old, wave in zip(arrived, waves, strict=True)]
        status = status if new is None else new
        gap += rate * (t - before)
        closing = arrived[0] - arrived[1]
        if status == PRESS:
            found.append(closing)
        elif status == OPEN:
            found.append(gap if gap.value > 0 else -closing)
        gap, rate = (gap, -closing) if status == OPEN else (ZERO, ZERO)
        before = t
    return found


def _for_ever_after(run: ExactRun, k: int, t: Any) -> list[Number]:
    """Why contact k does not press again after t; see `separation_time` of the kernel."""
    state, log = run.state, run.log
    if state.rate[k] >= 0 and quiet(state, k, False) and quiet(state, k, True):
        return [state.rate[k]]
    vl, _, high, bounded_l = group_motion(state, log, k, False, t)
    vr, low, _, bounded_r = group_motion(state, log, k, True, t)
    if bounded_l and bounded_r and low >= high:
        left, right = ({w.value: w for w in _waves(run, k, there)} for there in (False, True))
        return [r - l for r in right.values() for l in left.values()]
    dl, bl = deviation_bound(state, log, k, False, t, vl)
    dr, br = deviation_bound(state, log, k, True, t, vr)
    gap = state.gap[k] + state.rate[k] * (t - state.since[k]) - dr + dl
    return [vr - vl, gap, gap * gap - 2 * (bl + br)]


def _waves(run: ExactRun, k: int, right: bool) -> list[Number]:
    """What is under way in the bodies bonded together beside contact k."""
    state, log = run.state, run.log
    first, last = side(state, k, right)
    if last == 0:
        return [state.arrived[2 * k + 3 if right else 2 * k]]
    found = []
    for l in range(2 * first, 2 * last + 2):
        r = state.head[l]
        found.append(state.arrived[l])
        while r >= 0:
            found.append(log.value[r])
            r = log.after[r]
    return found
