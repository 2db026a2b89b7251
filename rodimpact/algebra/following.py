"""Follow one collision on numbers with derivatives, and note ties: what a number moves apart."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..methods.fronts import energy, events
from ..methods.fronts.method import run_fronts
from ..methods.fronts.records import IDLE
from ..methods.fronts.simulation import start_simulation
from ..methods.groups import groups, unilateral
from ..methods.laws import Status
from ..methods.row import Array, Row
from ..model import Absorbing, System
from .exact import motion
from .numbers import Dual

EVENTS = (
    "",
    "there is no gap at first",
    "waves from both sides arrive together",
    "a gap closes just as a wave arrives",
    "the contact is closed without force",
    "a front vanishes",
    "the bodies stay together",
)
"""What may come otherwise on one of the sides of a number."""
SMOOTH, BORDER, ARRIVALS, CLOSING, FORCE, FRONT, PARTING = range(len(EVENTS))
NO_TIE = math.nan, -1, SMOOTH
LEAST = 1e-8  # of velocities and times: a smaller derivative is round-off


class Followed:
    """A collision that ends; the front kernel runs on numbers with derivatives as on floats.

    Parameters
    ----------
    system : System
    changes : [number, direction]
        How the numbers of the row change, those of `Plan`, each by about its own size.
    max_events : int

    Attributes
    ----------
    ties : [3, direction]
        Of the first tie of each direction its time, s, its node and its place in `EVENTS`; `NO_TIE`
        where there is none.
    """

    def __init__(self, system: System, changes: Array, max_events: int) -> None:
        self._row = Row(system)
        run, directions = run_fronts(self._row, max_events=max_events), changes.shape[1]
        layout = run.layout
        n, end = len(layout.closed_status) - 1, run.proved_tick
        self._tick, self._frame, self._nodes = (
            run.clock.tick,
            run.clock.frame,
            layout.contacts,
        )
        self.ties: Any = np.outer(NO_TIE, np.ones(directions))
        self._least = LEAST * run.run.velocity_scale
        y: Any = list(map(Dual, layout.values, changes))
        times = [L / c for c, L in zip(y[:n], y[2 * n : 3 * n], strict=True)]
        ticks = [
            Dual(T, T / time.value * time.d)
            for T, time in zip(run.clock.ticks[1:-1], times, strict=True)
        ]
        self._state = state = start_simulation(
            layout, y, ticks, self._tick, self._frame
        )
        state.run.max_events = IDLE
        state.run.next_proof_event = IDLE  # nothing is to be proved on the way
        state.run.velocity_tolerance, state.run.closing_window = (
            run.run.velocity_tolerance,
            run.run.closing_window,
        )
        for k in self._nodes:
            gap = state.nodes[k].gap
            self._note(BORDER, 0, k, gap.d * float(gap.value == 0), 0.0)
        t, nodes, leaves = 0, range(len(state.nodes)), len(state.queue) // 2
        due: Sequence[int] = nodes
        while t <= end:
            before = [self._before(k, t) for k in due]
            state.advance(t)
            for k, known in zip(due, before, strict=True):
                self._compare(k, t, *known)
            t = int(state.queue[1])
            due = [k for k in nodes if state.queue[leaves + k] == t]
        state.run.now = end
        events.advance_totals_to(state, end)
        energy.update_motion(state)
        lasting = ending(system)
        for i in unilateral(system):
            apart = motion(self._row, state, i + 1)[1] - motion(self._row, state, i)[1]
            if {i, i + 1} <= lasting and abs(apart) <= self._least:
                self._note(PARTING, end, self._nodes[i], apart.d, self._least)

    def quantity(self, of: str) -> Any:
        """What `of` names, see `gradient`, as a `Dual`."""
        kind, _, number = of.partition(".")
        i = int(number or unilateral(self._row.system)[0])
        if kind == "velocity_after":
            return motion(self._row, self._state, i)[1] + self._frame
        if kind == "restitution":
            (v, after), (w, beyond) = (
                motion(self._row, self._state, j) for j in (i, i + 1)
            )
            return (beyond - after) / (v - w)
        at = self._state.nodes[self._nodes[i]]
        return (
            at.impulse if kind == "impulse" else at.force_ticks
        ) * self._tick + Dual(0.0)

    def _note(self, event: int, t: int, k: int, apart: Any, least: float) -> None:
        """Note a tie at node k in the directions in which what is equal comes apart."""
        new = (abs(apart) > least) & (self.ties[2] == SMOOTH)
        self.ties[:, new] = [[t * self._tick], [k], [event]]

    def _before(self, k: int, t: int) -> tuple[int, list[Any], Any]:
        """Status of node k, the waves that arrive there at tick t, and its gap then."""
        state, at = self._state, self._state.nodes[k]
        arrivals = [
            state.lines[l].arrival_tick
            for l in (2 * k, 2 * k + 3)
            if state.lines[l].arrival_tick == t
        ]
        now = (arrivals or [state.queue[len(state.queue) // 2 + k] if t else 0])[0]
        return at.status, arrivals, at.gap + at.gap_rate * (now - at.solved_tick)

    def _compare(
        self, k: int, t: int, before: int, arrivals: list[Any], gap: Any
    ) -> None:
        """Note what is tied at node k, which has been solved at tick t."""
        state, at = self._state, self._state.nodes[k]
        Yl, Yr = (it.mobility for it in state.segments[k : k + 2])
        a, b, F = (
            state.lines[2 * k].incoming_wave,
            state.lines[2 * k + 3].incoming_wave,
            at.force,
        )
        if len(arrivals) == 2:
            self._note(ARRIVALS, t, k, (arrivals[0] - arrivals[1]).d, LEAST * t)
        if before == Status.OPEN and at.gap == 0:
            self._note(CLOSING, t, k, gap.d, self._least * t)
        if (
            at.status == Status.OPEN
        ):  # bodies that graze move apart when a number changes
            at.gap_rate = Dual(at.gap_rate.value, (b - a).d)
        elif at.status in (Status.TOUCH, Status.GRAZE):
            self._note(FORCE, t, k, (a - b).d, self._least)
        for l, wave in ((2 * k + 1, a - 2 * F * Yl), (2 * k + 2, b + 2 * F * Yr)):
            if state.lines[l].last_row >= 0:  # what left last
                apart = wave - state.log[state.lines[l].last_row].value
                self._note(FRONT, t, k, apart.d, self._least)


def ending(system: System) -> set[int]:
    """Bodies that have a velocity after: no absorbing end slows them down for ever."""
    last = len(system.bodies) - 1
    radiating = {
        at
        for at, end in zip((0, last), system.ends, strict=True)
        if isinstance(end, Absorbing)
    }
    return {i for group in groups(system) if radiating.isdisjoint(group) for i in group}
