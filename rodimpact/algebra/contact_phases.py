"""Phases of a contact: times in which it keeps its status, and the conditions for that.

A front that reaches a closed contact, or an open one, is passed on in a way that does
not depend on other fronts. So fronts may come in any order: closing velocity and gap
are sums over those that have come. Floats can evaluate such sums, with unit steps H(t),
anywhere. Polynomials cannot: for formulas the order of the run is kept.

In a contact, a is the wave that comes from the left and b the wave from the right, each
twice its velocity: the velocity of a free face. The closing velocity is a - b; the
contact presses as long as it is positive. The gap of an open contact is the gap at the
start less the integral of the closing velocity.
"""

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, NamedTuple

from ..methods.fronts.records import CHANGE
from ..methods.states import Status
from .exact_run import ExactRun
from .traced_fraction import ZERO, TracedFraction, heaviside_times

UNDECIDED = -1
"""Status of a closed contact that has neither pressed nor opened yet."""


class VelocityJump(NamedTuple):
    """A jump of the closing velocity, as fronts reach a contact."""

    tick: TracedFraction
    size: TracedFraction  # closing velocity after the jump minus before it, m/s


@dataclass
class ContactPhase:
    """A time in which a contact keeps its status."""

    status: int
    start: TracedFraction  # tick
    gap: TracedFraction  # gap at the start, m in the kernel's units
    closing: TracedFraction  # closing velocity at the start, m/s
    jumps: list[VelocityJump] = field(default_factory=list)  # after the start
    end: TracedFraction | None = None  # tick; None for the last phase


class ContactPhases(NamedTuple):
    """Phases of a contact, and the ticks of later events there."""

    phases: list[ContactPhase]
    later_ticks: list[TracedFraction]


@dataclass
class ContactEvent:
    """Everything that happens at a contact at one tick."""

    tick: TracedFraction
    waves: dict[int, TracedFraction] = field(default_factory=dict)  # new ones, by line
    status: int | None = None  # new status of the contact, if it changes


def phases_of_contact(
    run: ExactRun, contact: int, until: TracedFraction
) -> ContactPhases:
    """Phases of a contact up to a tick, and the ticks of the events after it.

    The first phase begins at tick 0: it is open if there is a gap, else `UNDECIDED`. A
    change of status ends a phase and begins the next one, with gap 0. Any other event
    is a jump of the closing velocity a - b within its phase, where a and b are the
    waves that arrive at the contact from the left and from the right.
    """
    simulation = run.simulation
    node = run.nodes[contact]
    left_line = 2 * node  # line of the wave a
    right_line = 2 * node + 3  # line of the wave b
    waves = {left_line: ZERO, right_line: ZERO}
    # The log has no waves from outside the row.
    if node == 0:
        waves[left_line] = simulation.lines[0].incoming_wave
    if node == len(simulation.nodes) - 1:
        waves[right_line] = simulation.lines[-1].incoming_wave

    gap = run.numbers.gaps[contact] * run.tick_rate  # a velocity times ticks
    status = UNDECIDED
    if gap > 0:
        status = Status.OPEN.value
    phases = [ContactPhase(status, ZERO, gap, ZERO)]
    later_ticks = []
    closing = ZERO
    for event in _events_at(run, node):
        waves |= event.waves
        earlier_closing = closing
        closing = waves[left_line] - waves[right_line]
        if event.tick > until:
            later_ticks.append(event.tick)
        elif event.status is not None:
            phases[-1].end = event.tick
            phases.append(ContactPhase(event.status, event.tick, ZERO, closing))
        elif event.tick > 0:
            size = closing - earlier_closing
            phases[-1].jumps.append(VelocityJump(event.tick, size))
        else:  # the initial state: fronts that left before t = 0
            phases[-1].closing = closing
    return ContactPhases(phases, later_ticks)


def _events_at(run: ExactRun, node: int) -> list[ContactEvent]:
    """Arrivals of fronts at a node and changes of its contact, in order of time.

    All that happens at one tick is one event.
    """
    simulation = run.simulation
    left_line = 2 * node  # line of the wave that arrives from the left
    right_line = 2 * node + 3  # line of the wave that arrives from the right
    incoming_lines = (left_line, right_line)
    events: dict[Any, ContactEvent] = {}  # keys: values of ticks
    for row in simulation.log[: simulation.run.log_rows]:
        is_change = row.line == CHANGE
        changed_node = row.next_row  # the node only in a row of a change
        if is_change and changed_node == node:
            tick = row.tick + ZERO
        elif row.line in incoming_lines:
            # The log has the tick at which a front begins its way along a segment.
            tick = row.tick + simulation.segments[row.line // 2].transit
        else:
            continue
        event = events.setdefault(tick.value, ContactEvent(tick))
        if is_change:
            event.status = row.value
        else:
            event.waves[row.line] = row.value
    return [events[value] for value in sorted(events)]


def phase_conditions(phase: ContactPhase, in_order: bool) -> list[TracedFraction]:
    """Numbers that are positive as long as a contact keeps its status in this phase.

    They are closing velocities or gaps, and differences of ticks: jumps stay between
    start and end of the phase, and with `in_order` also in the order of this run. A
    velocity or a gap at a jump is the sum over the jumps up to it: with `in_order`
    those of this run, otherwise those that unit steps select anew.
    """
    conditions = _status_conditions(phase, in_order)
    ticks = [phase.start]
    for jump in phase.jumps:
        ticks.append(jump.tick)
    if in_order:
        if phase.end is not None:
            ticks.append(phase.end)
        for tick, next_tick in pairwise(ticks):
            conditions.append(next_tick - tick)
        return conditions
    for tick in ticks[1:]:  # ticks of the jumps
        conditions.append(tick - phase.start)
    if phase.end is not None:
        for tick in ticks:  # also the start: the phase lasts longer than 0
            conditions.append(phase.end - tick)
    return conditions


def _status_conditions(phase: ContactPhase, in_order: bool) -> list[TracedFraction]:
    """Closing velocities of a phase in which a contact presses, or gaps of an open one.

    They are those at the start of the phase and at each jump. A gap that is 0 at the
    start is replaced by the velocity with which it opens. Phases of any other status
    have no such conditions. With `in_order` the jumps count in the order of this run;
    otherwise each has a unit step as a factor.
    """
    if phase.status == Status.PRESS:
        conditions = [phase.closing]
        for jump in phase.jumps:
            conditions.append(_closing_at(phase, jump.tick, in_order))
        return conditions
    if phase.status == Status.OPEN:
        conditions = [-phase.closing]
        if phase.gap > 0:
            conditions = [phase.gap]
        for jump in phase.jumps:
            conditions.append(_gap_at(phase, jump.tick, in_order))
        return conditions
    return []


def _closing_at(
    phase: ContactPhase, tick: TracedFraction, in_order: bool
) -> TracedFraction:
    """Closing velocity at a tick of a phase: that at its start plus the jumps up to it.

    With `in_order` they are the jumps up to it in this run; otherwise each jump has a
    unit step as a factor.
    """
    closing = phase.closing
    for jump in phase.jumps:
        elapsed = tick - jump.tick
        closing = closing + _if_elapsed(elapsed, jump.size, in_order)
    return closing


def _gap_at(
    phase: ContactPhase, tick: TracedFraction, in_order: bool
) -> TracedFraction:
    """Gap at a tick of a phase in which the contact is open.

    g(t) = g(t0) - (a - b) (t - t0) - sum(size (t - t_jump)), over the jumps up to t,
    selected as in `_closing_at`.
    """
    gap = phase.gap - phase.closing * (tick - phase.start)
    for jump in phase.jumps:
        elapsed = tick - jump.tick
        gap = gap - _if_elapsed(elapsed, jump.size * elapsed, in_order)
    return gap


def _if_elapsed(
    elapsed: TracedFraction, x: TracedFraction, in_order: bool
) -> TracedFraction:
    """H(elapsed) x: x if the time is not negative, else 0.

    With `in_order` this run decides H; otherwise H stays in the history of the number.
    """
    if not in_order:
        return heaviside_times(elapsed, x)
    if elapsed >= 0:
        return x
    return ZERO
