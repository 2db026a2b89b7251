"""The method "characteristics": end signals averaged over a common time step.

It carries what piecewise constant fronts cannot: rigid masses, compliant contacts, joints, gravity,
driven ends and smooth initial states. The step is chosen so that transit times are whole numbers of
steps where they can be, and divided until the outcome stands still.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

import numpy as np

from ...model.frozen import InvalidModel
from .. import abilities as physics
from ..clock import STEP_TICKS
from ..contact_law_kernel import BOND, RIGID, YIELD
from ..refinement import MEASURES
from ..row import Array, Row
from ..run import GroupTotals, Run, Waves
from ..signals import Pieces
from ..stepped import StepRecord, as_run
from ..stepped_run import SteppedRun, clock_of_steps
from .delays import arriving, edges_of_parts
from .layout import Work
from .level_kernel import FINAL, PARTS, PROOF, REASON, TAKEN
from .machine import Machine
from .step_kernel import State, inside

RTOL = 1e-5
STOPPED_BY = ("final", "until", "max_events")
"""Why a run stopped, in the kernel's order."""


@dataclass(frozen=True, kw_only=True)
class StepRun(SteppedRun):
    """A finished run of this method.

    Attributes
    ----------
    edges_before : array of int
        As `edges`, before t = 0.
    state : State
        The kernel's, at the end, on arrays.
    """

    edges_before: Array
    state: State

    def before(self, line: int) -> int:
        """How many averages a line has from before t = 0."""
        return inside(self.state, line // 2)

    def wave(self, line: int) -> Array:
        """What left an end in each step, those before t = 0 first, in the falling frame."""
        start = int(self.signals.wave_start[line])
        return np.asarray(self.signals.wave[start - self.before(line) : start + self.steps])

    def arriving(self, line: int) -> Array:
        """What arrived at the other end in each step, in the falling frame."""
        return arriving(self.wave(line), self.clock.ticks[line // 2], np.diff(self.edges))

    @property
    def largest_strain(self) -> float:
        """Bound of the strains."""
        waves = [np.abs(self.wave(line)).max(initial=0.0) / self.clock.wave_speed[line // 2]
                 for line in range(2, 2 * len(self.state.steps) - 2)]
        return float(max(waves))

    def place(self, contact: int) -> int:
        """Place in the tally of a contact that is not bonded."""
        return self.row.contact_link[contact]

    def path(self, contact: int) -> Array:
        """How far a contact that is not bonded closes in each step, m."""
        link = self.place(contact)
        if self.row.laws[link] == YIELD:  # its faces move
            left, right = map(self._end_speed, self.row.beside[link], (0, 1))
            return np.asarray((left - right) * self.durations)
        _, gap = self.contact(contact)
        return np.asarray(-np.diff(gap, prepend=float(self.row.gap[link])))

    def _end_speed(self, body: tuple[str, int], right: int) -> Array:
        """Mean velocity in each step of what stands beside a link, in the frame."""
        kind, i = body
        if kind == "mass":
            speed = self.speed(i)
            return (speed[1:] + speed[:-1]) / 2
        if kind == "outside":
            last = len(self.signals.wave_start) - 1
            return self.by_step(self.signals.wave, self.signals.wave_start[last * right])
        out = 2 * i + 1 - right
        return (self.wave(out)[self.before(out) :] + self.arriving(out ^ 1)) / 2

    def bond(self, contact: int) -> Array:
        """Mean force in a bonded contact in each step, N, from the waves of a rod that it joins."""
        for body, side in ((contact, 1), (contact + 1, 0)):
            first, last = self.row.spans[body]
            if last:
                s, out = (last, 2 * last + 1) if side else (first, 2 * first)
                outgoing = self.wave(out)[self.before(out) :]
                incoming = self.arriving(out ^ 1)
                force: Array = (incoming - outgoing) / (2 * self.state.mobility[s])
                return force if side else -force
        raise ValueError(f"contact {contact} joins no rod")

    def outer(self, side: int) -> tuple[Array, Array]:
        """Force of what is outside the left or right end on the row, and its velocity, by steps.

        N and m/s, in the laboratory; positive to the inside, and to the right.
        """
        row, n = self.row, len(self.state.steps) - 2
        kind, link = row.outside[side][0], (0, len(row.laws) - 1)[side]
        s, out = (1, 2) if side == 0 else (n, 2 * n + 1)
        outgoing, incoming = self.wave(out)[self.before(out) :], self.arriving(out ^ 1)
        line = self.signals.wave_start[(2 * n + 3) * side]
        imposed = self.by_step(self.signals.wave, line)
        if row.laws[link] > BOND:
            force, v = self.by_link(self.signals.force, link), imposed
        elif kind == "force" and row.first[1 + side * n] > row.first[side * n]:
            speed = self.speed(0 if side == 0 else len(row.masses) - 1)
            force, v = imposed, (speed[1:] + speed[:-1]) / 2
        else:
            force = (1, -1)[side] * (outgoing - incoming) / (2 * self.state.mobility[s])
            v = (outgoing + incoming) / 2
        value = row.outside[side][1]
        if kind == "velocity" and isinstance(value, float):
            return force, np.full(self.steps, value)
        middles = (self.edges[1:] + self.edges[:-1]) / 2 * self.clock.tick
        return force, v + row.frame + row.gravity * middles

    def speed(self, mass: int) -> Array:
        """Velocity of a mass at `edges`, in the frame."""
        side = mass - len(self.row.masses)
        if side >= 0:
            return self.row.wall_speed(side, self.edges * self.clock.tick)
        initial = self.row.mass_velocity[mass] - self.row.frame
        later = self.by_step(self.signals.speed, self.signals.mass_start[mass])
        return np.concatenate(([initial], later))


LACKS = (physics.DAMPING, physics.LATERAL, physics.TAPER)


def solve(row: Row, until: float | None, max_events: int, **options: Any) -> Run:
    """Run a single collision; arguments as of `follow`."""
    return hand_over(follow(row, until, max_events, **options), until)


def hand_over(run: StepRun, until: float | None) -> Run:
    """What every method hands back, of a run to `until`."""
    def waves(_: StepRecord) -> Waves:
        ticks = np.concatenate((run.edges_before, run.edges[:-1]))
        lines = [run.wave(line) for line in range(2, 2 * len(run.state.steps) - 2)]
        left = [Pieces(ticks[len(ticks) - len(values) :], values) for values in lines]
        return Waves([None, None, *left])

    return as_run(run, "characteristics", until, waves, finer="a smaller dt")


def follow(
    row: Row, until: float | None, max_events: int, dt: float | None, rtol: float | None,
    announce: Callable[[str], None] | None = None,
) -> StepRun:
    """Run a single collision.

    Parameters
    ----------
    row : Row
        Of a single system.
    until : float, optional
        s; by default the run ends a round trip of the longest rod after the proof of finality.
    max_events : int
        Cap on steps times ends, where no end is given.
    dt : float, optional
        Step, s; chosen if not given.
    rtol : float, optional
        Relative accuracy to which the step is divided.
    announce : function, optional
        Called with a sentence where the run takes long.

    Raises
    ------
    TooLong
        If the run takes too much memory.
    """
    row.check_scales()
    check_step(row, dt)
    goal = RTOL if rtol is None else rtol
    machine = Machine(row, until, most_parts(row, max_events))
    machine.search(dt, goal, announce)
    run = finished(machine, goal)
    return run if dt is None else replace(run, estimates={})


def most_parts(row: Row, max_events: int) -> int:
    """Cap on parts of steps, of one on steps times ends."""
    return max(1, max_events // (len(row.segments) + 1))


def finished(machine: Machine, goal: float) -> StepRun:
    """Go on for a round trip of the longest rod after a proof, and hand over."""
    row, at = machine.row, machine.work.level.at
    totals, estimates = totals_of(machine.work), estimates_of(machine.work)
    if at[REASON] == FINAL:
        machine.extend()
    machine.to_arrays()
    level, state, tally, signals = machine.work[4:8]
    taken, ticks = int(level.at[TAKEN]), level.ticks[1:-1].tolist()
    edges = level.edges[: taken + 1].copy()
    earliest = -max(inside(state, s + 1) for s in range(len(ticks)))
    return StepRun(
        clock=_clock(row, ticks, float(level.step[0])), row=row, step=float(level.step[0]),
        edges=edges, end=int(edges[-1]), events=taken * (len(ticks) + 1), tally=tally,
        signals=signals,
        finality_time=int(level.at[PROOF]), stopped_by=STOPPED_BY[level.at[REASON]],
        edges_before=edges_of_parts(level.places[: level.at[PARTS] + 1], earliest, -1),
        state=state, estimates=estimates, rtol=goal, totals=totals,
    )


def longest_step(row: Row) -> Any:
    """Longest step that may be given, s: the shortest transit time, but for round-off."""
    return reduce(np.minimum, [s.transit_time for s in row.segments]) * (1 + 2.0**-36)


def check_step(row: Row, dt: float | None) -> None:
    """Raise InvalidModel where a given step is longer than the shortest transit."""
    if dt is not None and dt > longest_step(row):
        transits = [float(s.transit_time) for s in row.segments]
        path = row.paths[1 + transits.index(min(transits))]
        message = f"must not exceed the shortest transit time, {min(transits):.6g} s of {path}"
        raise InvalidModel([("dt", f"{message}, got {dt!r}")])


def totals_of(work: Work) -> GroupTotals:
    """What the kernel has added up of groups and bodies."""
    search = work.search
    return GroupTotals(
        *(np.array(x) for x in (search.before, search.after, search.vibration, search.peak,
                                search.pressed))
    )


def estimates_of(work: Work) -> dict[str, float]:
    """Estimated errors by the names of the measures."""
    named = zip(("velocity", *MEASURES, "duration", "energy"), work.search.estimates, strict=True)
    found = {name: float(error) for name, error in named}
    if RIGID not in work.make.law:
        del found["energy"]
    return found


def _clock(row: Row, ticks: list[int], step: float) -> Any:
    """Clock of a row whose segments have transit times of so many ticks."""
    errors = [abs(T * (step / STEP_TICKS) / float(s.transit_time) - 1)
              for T, s in zip(ticks, row.segments, strict=True)]
    worst = max(range(len(errors)), key=errors.__getitem__)
    return clock_of_steps(
        row, ticks, step, [float(s.impedance) for s in row.segments],
        transit_error=errors[worst], worst=row.paths[worst + 1],
    )
