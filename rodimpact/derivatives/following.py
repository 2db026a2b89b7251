"""Follow one collision on numbers with derivatives, and note ties: what a number moves apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..methods.fronts import front_kernel as fronts
from ..methods.fronts.assembly import Assembly, Blueprint, assemble, start
from ..methods.fronts.layout_kernel import TOLERANCE
from ..methods.fronts.tracking import track
from ..methods.groups import grounds, groups, unilateral
from ..methods.row import Array, Row
from ..model import Absorbing, System
from .dual import Dual

EVENTS = (
    "", "there is no gap at first", "waves from both sides arrive together",
    "a gap closes just as a wave arrives", "the contact is closed without force",
    "a front vanishes", "the bodies stay together",
)
"""What may come otherwise on one of the sides of a number."""
SMOOTH, BORDER, ARRIVALS, CLOSING, FORCE, FRONT, PARTING = range(len(EVENTS))
LEAST = 1e-8  # of velocities and times: a smaller derivative is round-off


class Followed:
    """A collision whose numbers have derivatives; the front kernel runs on `Dual` as on floats.

    Parameters
    ----------
    system : System
    changes : [number, direction]
        How the numbers of the row change, those of `Blueprint`, each by about its own size.
    max_events : int

    Attributes
    ----------
    event : [direction]
        Place in `EVENTS` of the first tie.
    when : [direction]
        Its time, s; where there is none that of the proof that the collision is over.
    node : [direction]
    final : bool
        Whether there is such a proof; the collision is not followed otherwise.
    """

    def __init__(self, system: System, changes: Array, max_events: int) -> None:
        self._row = Row(system)
        self._a = a = assemble(self._row)
        run, directions = track(a, max_events=max_events), changes.shape[1]
        end, self.final = run.finality_time, run.finality_time >= 0
        self.event, self.node = np.full(directions, SMOOTH), np.full(directions, -1)
        self.when, self._least = np.full(directions, end * a.tick), LEAST * a.tolerance / TOLERANCE
        room = len(run.log.tick) + len(run.log.change_tick) + 2
        state, tally, log, clock = begin(Blueprint(self._row), a, changes, room)
        self._state, self._tally, self._log = state, tally, log
        self._opening, self._closing = (
            fronts.GroupState(*([Dual(0.0)] * len(a.ticks) for _ in range(3))) for _ in range(2))
        fronts.initial_state(state, log, self._opening)
        for k in a.nodes:
            self._note(BORDER, 0, k, state.gap[k].d * float(state.gap[k].v == 0), 0.0)
        clock[fronts.REST] = fronts.IDLE  # nothing is to be proved on the way
        t, nodes, leaves = 0, range(len(state.status)), len(state.tree) // 2
        due: Sequence[int] = nodes
        while t <= end:
            before = [self._before(k, t) for k in due]
            fronts.advance(state, tally, log, clock, t, fronts.IDLE, a.tolerance, a.window)
            for k, known in zip(due, before, strict=True):
                self._compare(k, t, *known)
            t = int(state.tree[1])
            due = [k for k in nodes if state.tree[leaves + k] == t]
        fronts.close_books(state, tally, end, a.window)
        fronts.final_state(state, tally, log, end, self._opening, self._closing)
        lasting = ending(system)
        for i in unilateral(system):
            apart = self._motion(i + 1)[1] - self._motion(i)[1]
            if {i, i + 1} <= lasting and abs(apart) <= self._least:
                self._note(PARTING, end, a.nodes[i], apart.d, self._least)

    def quantity(self, of: str) -> Any:
        """What `of` names, see `gradient`, as a `Dual`."""
        kind, _, number = of.partition(".")
        i = int(number or unilateral(self._row.system)[0])
        if kind == "velocity_after":
            return self._motion(i)[1] + self._a.frame
        if kind == "restitution":
            (v, after), (w, beyond) = self._motion(i), self._motion(i + 1)
            return (beyond - after) / (v - w)
        total = self._tally.impulse if kind == "impulse" else self._tally.pressed
        return total[self._a.nodes[i]] * self._a.tick + Dual(0.0)

    def _motion(self, body: int) -> tuple[Any, Any]:
        """Velocity of a body before and after: that of what holds it, or of its segments."""
        system, arrived = self._row.system, self._state.arrived
        group = next(g for g in groups(system) if body in g)
        if grounds(system, group):
            return (arrived[0 if group[0] == 0 else -1],) * 2
        first, _ = self._row.spans[body]
        return self._opening.velocity[first], self._closing.velocity[first]

    def _note(self, event: int, t: int, k: int, apart: Any, least: float) -> None:
        """Note a tie at node k in the directions in which what is equal comes apart."""
        over = abs(apart) > least
        if over is False:  # a single direction is a float
            return
        new = over & (self.event == SMOOTH)
        self.event[new], self.when[new], self.node[new] = event, t * self._a.tick, k

    def _before(self, k: int, t: int) -> tuple[int, list[Any], Any]:
        """Status of node k, the waves that arrive there at tick t, and its gap then."""
        state, log = self._state, self._log
        rows = [(state.head[l], state.transit[l // 2]) for l in (2 * k, 2 * k + 3)]
        arrivals = [log.tick[r] + T for r, T in rows if r >= 0 and log.tick[r] + T == t]
        now = (arrivals or [state.tree[len(state.tree) // 2 + k] if t else 0])[0]
        return state.status[k], arrivals, state.gap[k] + state.rate[k] * (now - state.since[k])

    def _compare(self, k: int, t: int, before: int, arrivals: list[Any], gap: Any) -> None:
        """Note what is tied at node k, which has been solved at tick t."""
        state, (Yl, Yr) = self._state, self._state.mobility[k : k + 2]
        a, b, F = state.arrived[2 * k], state.arrived[2 * k + 3], state.force[k]
        if len(arrivals) == 2:
            self._note(ARRIVALS, t, k, (arrivals[0] - arrivals[1]).d, LEAST * t)
        if before == fronts.OPEN and state.gap[k] == 0:
            self._note(CLOSING, t, k, gap.d, self._least * t)
        if state.status[k] == fronts.OPEN:  # bodies that graze move apart when a number changes
            state.rate[k] = Dual(state.rate[k].v, (b - a).d)
        elif state.status[k] in (fronts.TOUCH, fronts.GRAZE):
            self._note(FORCE, t, k, (a - b).d, self._least)
        for l, wave in ((2 * k + 1, a - 2 * F * Yl), (2 * k + 2, b + 2 * F * Yr)):
            if state.tail[l] >= 0:  # what left last
                apart = wave - self._log.value[state.tail[l]]
                self._note(FRONT, t, k, apart.d, self._least)


def begin(plan: Blueprint, a: Assembly, changes: Array, room: int) -> tuple[Any, Any, Any, Any]:
    """The kernel's state at t = 0, of numbers with derivatives: floats in a single direction."""
    make, n, zero = plan.make, plan.make.size[0], Dual(0.0)
    rates: Any = changes[:, 0].tolist() if changes.shape[1] == 1 else changes
    y: Any = list(map(Dual, plan.numbers, rates))
    times = [Dual(1.0), *(L / c for c, L in zip(y[:n], y[2 * n : 3 * n], strict=True)), Dual(1.0)]
    ticks = [Dual(T, T / time.v * time.d) for T, time in zip(a.ticks, times, strict=True)]
    give = [1 / Z for Z in y[n : 2 * n]]
    ends = (give[i] if a.impedance[i] else zero for i in (0, -1))
    gaps = list(map(Dual, a.gaps))
    for k, gap in zip(a.nodes, y[3 * n :], strict=False):
        gaps[k].d = gap.d / a.tick
    waves = [zero] * len(a.waves)
    for first, last, v in zip(make.first, make.last, make.profile, strict=True):
        for s in range(first, last + 1):
            stretching = y[s - 1] * y[v + 1]
            waves[2 * s : 2 * s + 2] = y[v] - stretching, y[v] + stretching
    waves[0], waves[-1] = waves[2], waves[-3]  # an endless bar sends what left the row last
    walls = (y[make.profile[i]].d if make.last[i] == 0 else 0.0 for i in (0, -1))
    outside: Any = tuple(map(Dual, a.outside, walls))
    sent: Any = [[(Dual(t, -ticks[l // 2].d), Dual(wave, waves[l].d)) for t, wave in of_line]
                 for l, of_line in enumerate(a.waves)]
    left, right = ends
    return start(
        ticks, [left, *give, right], a.status, gaps,
        outside, sent, room)


def ending(system: System) -> set[int]:
    """Bodies that have a velocity after: no absorbing end slows them down for ever."""
    last = len(system.bodies) - 1
    radiating = {at for at, end in zip((0, last), system.ends, strict=True)
                 if isinstance(end, Absorbing)}
    return {i for group in groups(system) if radiating.isdisjoint(group) for i in group}
