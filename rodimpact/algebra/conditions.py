"""Where a formula holds: the inequalities on which a run depends.

Between contacts the mechanics is linear, so that the order of events at free ends and at joints
changes no result. What decides are the contacts: when they begin and cease to press, that those
which press go on to, that those which are apart stay so, and why they never meet again. A cell is
the list of the numbers that must be positive for this.

What a wave sends out and adds to the impulse does not depend on other waves while the contact
presses or is open throughout. So waves may come in any order, and force and gap are sums over those
that have come, which floats can tell anywhere. Polynomials cannot: for formulas the order is kept.
"""

from itertools import pairwise
from typing import Any, NamedTuple

from ..methods.fronts import finality
from ..methods.fronts.records import CHANGE, NONE
from ..methods.groups import unilateral
from ..methods.laws import Status
from ..model import Wall
from .exact import ExactRun
from .numbers import HALF, ZERO, Number, since

ENDLESS = 1 << 62


class Spell(NamedTuple):
    """A time in which a contact keeps its status."""

    status: int
    gap: Number  # at the start
    # the start, and how fast the contact would close; when waves come, and how much faster then
    waves: list[tuple[Number, Number]]
    end: list[Number]  # when the next spell begins, if one does


def conditions(run: ExactRun, *, in_order: bool) -> list[Number]:
    """Numbers that are positive throughout the cell of this run; those that depend on names.

    If waves may come to contacts in any order, some of these numbers are no rational functions.
    """
    contacts, state = unilateral(run.row.system), run.state
    # it is over with the event of the proof, or the next event if the kernel waited for it
    end: Number = state.run.proved_tick + ZERO
    if all(end != front.tick for front in state.log[: state.run.log_rows]):
        end = state.queue[1]
        state.run_to(end, ENDLESS, ZERO)
    last = max(
        (change.tick + ZERO for change in state.changes if change.tick <= end),
        default=ZERO,
    )
    # where contacts had been open for a while by then half of this later: the proof has room
    wait = (end - last) * HALF
    end += wait
    state.run_to(end, ENDLESS, ZERO)
    proofs = [_for_ever_after(run, k, end) for k in contacts]
    found = [x for proof, _ in proofs for x in proof]
    longest = max(
        sum(it.transit for it in state.segments[s : e + 1])
        for s, e in run.row.spans
        if e
    )
    # what is under way must not come before the end: let it come
    state.run_to(end + wait + 2 * longest, ENDLESS, ZERO)
    for k in contacts:
        spells, later = _spells(run, k, end + wait)
        last, _ = spells[-1].waves[0]
        found += [x for t in later for x in (t - end, t - last)]
        if any(bridged for _, bridged in proofs):
            found.append(
                abs(end - last)
            )  # the energy is that once all have ceased to press
        for spell in spells:
            found += _lasting(spell, in_order)
    if in_order:  # a hair's breadth from the system what is alike is the same
        found = list({x.value: x for x in found}.values())
    return [x for x in found if x.made and x.value]


def _spells(
    run: ExactRun, contact: int, until: Number
) -> tuple[list[Spell], list[Number]]:
    """Spells of a contact, and when waves come to it later."""
    state, k = run.state, run.nodes[contact]
    arrived = {
        2 * k: state.lines[0].incoming_wave if k == 0 else ZERO,
        2 * k + 3: state.lines[-1].incoming_wave if k == len(state.nodes) - 1 else ZERO,
    }
    events: dict[
        Any, tuple[Number, dict[int, Any]]
    ] = {}  # by time: waves by line, and the status
    for row in state.log[: state.run.log_rows]:
        if row.line in arrived or (row.line == CHANGE and row.next_row == k):
            way = ZERO if row.line == CHANGE else state.segments[row.line // 2].transit
            events.setdefault((row.tick + way).value, (row.tick + way, {}))[1][
                row.line
            ] = row.value
    gap, closing = run.numbers.gap[contact] * run.rate, ZERO
    spells, later = [Spell(Status.OPEN if gap > 0 else -1, gap, [(ZERO, ZERO)], [])], []
    for at in sorted(events):
        t, new = events[at]
        arrived = {line: new.get(line, wave) for line, wave in arrived.items()}
        before, closing = closing, arrived[2 * k] - arrived[2 * k + 3]
        if at > until.value:
            later.append(t)
        elif CHANGE in new:
            spells[-1].end.append(t)
            spells.append(Spell(new[CHANGE], ZERO, [(t, closing)], []))
        elif at > 0:
            spells[-1].waves.append((t, closing - before))
        else:
            spells[-1].waves[0] = ZERO, closing
    return spells, later


def _lasting(spell: Spell, in_order: bool) -> list[Number]:
    """Force while it presses, or gap while it is open, as waves come, and when these come."""
    (start, level), *waves = spell.waves
    apart = spell.gap if spell.gap > 0 else -level
    known: dict[int, list[Number]] = {Status.PRESS: [level], Status.OPEN: [apart]}
    found, times = known.get(spell.status, []), [t for t, _ in waves]
    for t in times if found else ():
        closing, gap = ZERO, spell.gap
        for earlier, jump in spell.waves:
            passed, told = t - earlier, in_order or earlier is start
            closing += since(passed, jump, told)
            gap -= since(passed, jump * passed, told)
        found.append(closing if spell.status == Status.PRESS else gap)
    if in_order:
        return found + [later - t for t, later in pairwise([start, *times, *spell.end])]
    found += [t - start for t in times]
    return found + [end - t for end in spell.end for t in (start, *times)]


def _for_ever_after(run: ExactRun, k: int, t: Any) -> tuple[list[Number], bool]:
    """Why contact k does not press again after t, if the levels beside it do not tell.

    Bodies whose centres go apart do not meet once the gap between these motions is wider than
    vibration can bridge. The bound is that of `separation_time` of the kernel, but for the energy:
    here it is that of all vibration, which follows from the velocities and impulses. Whether this
    is why is told.
    """
    state, node = run.state, run.nodes[k]
    at, left, right = state.nodes[node], state.segments[node], state.segments[node + 1]
    last = max(node, right.group_last)
    if at.gap_rate >= 0 and finality.no_front_in_flight(
        state.lines, left.group_first, last
    ):
        return [at.gap_rate], False
    finality.find_mean_motions(state, node, t)
    if (
        left.is_end_velocity_bounded
        and right.is_end_velocity_bounded
        and right.min_end_velocity >= left.max_end_velocity
    ):
        loops = _loop(run, node, False), _loop(run, node, True)
        in_turn = [later - t for loop in loops for (_, t), (_, later) in pairwise(loop)]
        return in_turn + [
            high - low for high, _ in loops[1] for low, _ in loops[0]
        ], False
    finality.bound_deviations(state, node, t)
    gap = (
        at.gap
        + at.gap_rate * (t - at.solved_tick)
        - right.end_deviation
        + left.end_deviation
    )
    reach = 2 * _vibration(run) * (left.compliance_integral + right.compliance_integral)
    return [right.mean_velocity - left.mean_velocity, gap, gap * gap - reach], True


def _vibration(run: ExactRun) -> Number:
    """Energy of vibration in the end: what the centres have lost, and what moving walls did."""
    numbers, results, segment = run.numbers, run.results, run.state.segments
    energy, impulses = ZERO, [ZERO, *results.impulses, ZERO]
    for i, ((first, last), v) in enumerate(
        zip(run.row.spans, numbers.velocity, strict=True)
    ):
        if isinstance(run.row.system.bodies[i], Wall):
            energy += (impulses[i + 1] - impulses[i]) * run.rate * v
        V = results.velocities_after[i]
        for s in range(first, last + 1):
            energy += (
                segment[s].transit * numbers.impedance[s - 1] * (v * v - V * V) * HALF
            )
    return energy


def _loop(run: ExactRun, k: int, right: bool) -> list[tuple[Number, Number]]:
    """Levels of the waves that go round in the rod beside contact k, and when each left there."""
    line, log, group = run.state.lines, run.state.log, run.state.segments[k + right]
    s = group.group_first
    if group.group_last == 0 or finality.no_front_in_flight(line, s, group.group_last):
        return [(line[2 * k + 3 if right else 2 * k].incoming_wave, ZERO)]
    found = []
    for l, delay in (
        (2 * s + right, ZERO),
        (2 * s + 1 - right, run.state.segments[s].transit),
    ):
        r = line[l].next_row
        while r != NONE:
            found.append((log[r].value, log[r].tick + delay))
            r = log[r].next_row
    return found
