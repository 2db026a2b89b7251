"""The method "characteristics": end signals as averages over a common time step.

It carries what piecewise constant fronts cannot: rigid masses, compliant contacts, gravity, driven
ends and smooth initial states. The row is laid out once; the step is chosen so that transit times
are whole numbers of steps as nearly as possible, and halved until the outcome stands still.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..frozen import InvalidModel
from ..model import Rod, System
from ..profiles import averages
from . import kernels
from .abilities import driven, require_end
from .characteristics_kernel import (
    DONE,
    NEVER,
    STEP,
    Points,
    Row,
    Signals,
    choose_step,
    run,
    settled,
)
from .clockwork import PARTS, Clockwork
from .link_kernel import RIGID, SPRING, Chain, Tally
from .plan import Array, Plan, squeezed, whole
from .refinement import TooLong, contact_measures, refined

TOLERANCE = 2.0**-48  # of the velocities, below which contacts graze
RTOL = 1e-5
FIRST = 64  # fewest steps of the longest transit
FINEST = 1 << 14  # most steps of the longest transit in the search for an accurate step
SHORTEST = 4  # fewest steps of the shortest transit
MOST_STEPS = 1 << 16  # of the longest transit, that the shortest may ask for
LINK_TIME = 3e-6  # s, about what plain Python takes for a link and a step; in a chain 5 times that
MOST_BYTES = 4 << 30  # of the signals


@dataclass(frozen=True, kw_only=True)
class StepRun:
    """A finished run.

    Attributes
    ----------
    clockwork : Clockwork
        Its tick is the step's `PARTS`-th part.
    plan : Plan
    step : float
        s.
    steps : int
        Steps taken.
    row, tally, signals
        The kernel's state at the end, on arrays.
    settled : int
        Step at which the collision was proved final, -1 without proof.
    stopped_by : str
        ``"final"``, ``"until"`` or ``"max_events"``.
    estimates : dict of str to float
        Relative change of each measure of the outcome by the last halvings of the step; empty where
        the step was given.
    rtol : float
        What they were to come to.
    """

    clockwork: Clockwork
    plan: Plan
    step: float
    steps: int
    row: Row
    tally: Tally
    signals: Signals
    settled: int
    stopped_by: str
    estimates: dict[str, float] = field(default_factory=dict)
    rtol: float = 0.0

    @property
    def events(self) -> int:
        """Steps taken, times ends solved."""
        return self.steps * (len(self.row.steps) - 1)

    def wave(self, line: int) -> Array:
        """What left an end in each step, those before t = 0 first, in the falling frame."""
        first = int(self.signals.wave_start[line]) - int(self.row.steps[line // 2])
        last = int(self.signals.wave_start[line]) + self.steps
        found: Array = self.signals.wave[first:last]
        return found

    @property
    def largest_strain(self) -> float:
        """Bound of the strains."""
        waves = [np.abs(self.wave(line)).max(initial=0.0) / self.clockwork.wave_speed[line // 2]
                 for line in range(2, 2 * len(self.row.steps) - 2)]
        return float(max(waves))

    @property
    def resolved(self) -> float:
        """Gap that counts as an opening, m."""
        return 0.0

    def place(self, contact: int) -> int:
        """Place in the tally of a contact that can open."""
        return self.plan.contact_link[contact]

    def contact(self, contact: int) -> tuple[Array, Array]:
        """Mean force in each step, N, and gap at its end, m; of a contact that can open."""
        start = int(self.signals.link_start[self.plan.contact_link[contact]])
        span = slice(start, start + self.steps)
        return self.signals.force[span], self.signals.gap[span] * self.step

    def path(self, contact: int) -> Array:
        """How far a contact that can open closes in each step, m."""
        _, gap = self.contact(contact)
        closed: Array = -np.diff(gap, prepend=float(self.plan.system.gaps[contact]))
        return closed

    def bond(self, contact: int) -> Array:
        """Mean force in a bonded contact in each step, N, from the waves of a rod that it joins."""
        for body, side in ((contact, 1), (contact + 1, 0)):
            first, last = self.plan.spans[body]
            if last:
                s, out = (last, 2 * last + 1) if side else (first, 2 * first)
                outgoing = self.wave(out)[self.row.steps[s] :]
                incoming = self.wave(out ^ 1)[: self.steps]
                force: Array = (incoming - outgoing) / (2 * self.row.mobility[s])
                return force if side else -force
        raise ValueError(f"contact {contact} joins no rod")

    def outer(self, side: int) -> tuple[Array, Array]:
        """Force of what is outside the left or right end on the row, and its velocity, by steps.

        N and m/s, in the laboratory; positive to the inside, and to the right.
        """
        plan, n = self.plan, len(self.row.steps) - 2
        kind, link = plan.outside[side][0], (0, len(plan.laws) - 1)[side]
        s, out = (1, 2) if side == 0 else (n, 2 * n + 1)
        T = self.row.steps[s]
        outgoing, incoming = self.wave(out)[T:], self.wave(out ^ 1)[: self.steps]
        line = self.signals.wave_start[(2 * n + 3) * side]
        given = self.signals.wave[line : line + self.steps]
        if plan.laws[link] >= RIGID:
            start = int(self.signals.link_start[link])
            force, v = self.signals.force[start : start + self.steps], given
        elif kind == "force" and plan.first[1 + side * n] > plan.first[side * n]:
            speed = self.speed(0 if side == 0 else len(plan.masses) - 1)
            force, v = given, (speed[1:] + speed[:-1]) / 2
        else:
            force = (1, -1)[side] * (outgoing - incoming) / (2 * self.row.mobility[s])
            v = (outgoing + incoming) / 2
        value = plan.outside[side][1]
        if kind == "velocity" and isinstance(value, float):
            return force, np.full(self.steps, value)
        fall = plan.gravity * self.step * (np.arange(self.steps) + 0.5)
        return force, v + plan.frame + fall

    def speed(self, mass: int) -> Array:
        """Velocity of a mass at the ends of the steps, the first at t = 0, in the frame."""
        side = mass - len(self.plan.masses)
        if side >= 0:
            return self.plan.wall_speed(side, self.step, self.steps)
        start = int(self.signals.mass_start[mass])
        initial = self.plan.mass_velocity[mass] - self.plan.frame
        return np.concatenate(([initial], self.signals.speed[start : start + self.steps]))


class Machine:
    """The kernel's state on arrays, and the room that it needs."""

    def __init__(self, plan: Plan, counts: list[int], step: float, room: int) -> None:
        self.plan, self.step, self.room = plan, step, room
        n, h, links, masses = len(counts), step, len(plan.laws), len(plan.masses)
        mobility = [0.0, *(1 / float(s.impedance) for s in plan.segments), 0.0]
        for side, s in ((0, 1), (1, n)):
            if plan.outside[side][0] == "absorbing":
                mobility[(n + 1) * side] = mobility[s]
        self.row = Row(
            whole([0, *counts, 0]), np.array(mobility), whole(plan.first),
            np.array(plan.masses) / h, whole(plan.laws), plan.stiffness_in_steps(h),
            np.array(plan.damping), np.array(plan.gap) / h, np.zeros(links), np.zeros(links),
            np.ones(links, np.int64), np.array(plan.mass_velocity) - plan.frame,
        )
        self.tally = Tally(*(np.zeros(links) for _ in range(4)),
                           *(np.full(links, v, np.int64) for v in (-1, -1, 0, 0)))
        self.points = Points(*np.zeros((2, masses + 2)))
        self.links = Chain(*np.zeros((len(Chain._fields), masses + 1)))
        self.clock = whole([0, 0])
        self.taken = 0
        self.signals = self._allocate(room)
        self._initial_state(counts)
        self._drive(-1)
        self.tol = TOLERANCE * plan.scale

    def _allocate(self, room: int) -> Signals:
        """Empty signals with room for so many steps."""
        row, plan = self.row, self.plan
        before = [int(row.steps[line // 2]) for line in range(2 * len(row.steps))]
        before[0] = before[-1] = 1
        n = len(row.steps) - 2
        kept = [line for line in range(2 * n + 4) if 2 <= line <= 2 * n + 1]
        kept += [line for side, line in ((0, 0), (1, 2 * n + 3)) if plan.outside[side][0] != "none"]
        starts, size = [-1] * (2 * n + 4), 0
        for line in kept:
            starts[line] = size + before[line]
            size += before[line] + room
        wanted = [i for i, law in enumerate(plan.laws) if law >= RIGID]
        link_start = [-1] * len(plan.laws)
        for place, i in enumerate(wanted):
            link_start[i] = place * room
        bytes_wanted = 8 * (size + room * (2 * len(wanted) + len(plan.masses)))
        if bytes_wanted > MOST_BYTES:
            message = (
                f"a run of {room} steps of {self.step:.3g} s needs {bytes_wanted / 1e9:.3g} GB; "
                "stop earlier, or take a longer step (dt or rtol)"
            )
            raise TooLong([("until", message)])
        return Signals(
            np.zeros(size), whole(starts), np.zeros(len(wanted) * room),
            np.zeros(len(wanted) * room), whole(link_start), np.zeros(len(plan.masses) * room),
            whole([m * room for m in range(len(plan.masses))]),
        )

    def _initial_state(self, counts: list[int]) -> None:
        plan, signals = self.plan, self.signals
        for body, (start, stop) in zip(plan.system.bodies, plan.spans, strict=True):
            if not isinstance(body, Rod):
                continue
            left = 0.0
            for s in range(start, stop + 1):
                N, L = counts[s - 1], float(plan.segments[s - 1].length)
                edges = left + L * np.arange(N + 1) / N
                v = averages(body.velocity, edges, float(body.length)) - plan.frame
                stretch = averages(body.strain, edges, float(body.length))
                stretch *= float(plan.segments[s - 1].wave_speed)
                right, leftward = signals.wave_start[2 * s], signals.wave_start[2 * s + 1]
                signals.wave[right - N : right] = (v - stretch)[::-1]
                signals.wave[leftward - N : leftward] = v + stretch
                left += L

    def _drive(self, since: int) -> None:
        """Fill the lines that come from outside, from step `since` on."""
        n, plan = len(self.row.steps) - 2, self.plan
        edges = self.step * np.arange(since, self.room + 1)
        for side, line, own in ((0, 0, 2), (1, 2 * n + 3, 2 * n + 1)):
            kind, value = plan.outside[side]
            if kind == "none":
                continue
            start = int(self.signals.wave_start[line])
            if kind == "absorbing":  # what left this end just before t = 0
                found: Any = self.signals.wave[self.signals.wave_start[own] - 1]
            else:
                found = averages(value, edges, 0.0)
                if kind == "velocity":
                    found = found - plan.frame - plan.gravity * (edges[1:] + edges[:-1]) / 2
            self.signals.wave[start + since : start + self.room] = found

    def grow(self, room: int) -> None:
        """Make room for more steps."""
        old, was = self.signals, self.room
        self.signals, self.room = self._allocate(room), room
        for name, starts in (("wave", "wave_start"), ("force", "link_start"), ("gap", "link_start"),
                             ("speed", "mass_start")):
            source, target = getattr(old, name), getattr(self.signals, name)
            before = self.row.steps[np.arange(len(getattr(old, starts))) // 2] if (
                name == "wave"
            ) else np.zeros(len(getattr(old, starts)), np.int64)
            if name == "wave":
                before = before.copy()
                before[0] = before[-1] = 1
            for i, start in enumerate(getattr(old, starts)):
                if start >= 0:
                    to = getattr(self.signals, starts)[i]
                    target[to - before[i] : to + was] = source[start - before[i] : start + was]
        self._drive(was)

    def advance(self, end: int) -> None:
        """Run to step `end`."""
        if end > self.room:
            self.grow(max(end, 2 * self.room))
        chains = len(self.plan.masses) + len({*self.plan.first}) - 1
        links = len(self.plan.laws) + 5 * chains
        if kernels.worth_compiling((end - self.taken) * links * LINK_TIME):
            flag = kernels.compiled(run)(
                self.row, self.tally, self.signals, self.points, self.links, self.clock, end,
                self.tol,
            )
        else:
            parts = (self.row, self.tally, self.signals, self.points, self.links)
            lists = [kernels.as_lists(x) for x in parts]
            clock = self.clock.tolist()
            row, tally, signals, points, links = lists
            flag = run(row, tally, signals, points, links, clock, end, self.tol)
            for part, found in zip(parts, lists, strict=True):
                kernels.copy_back(found, part)
            self.clock[:] = clock
        self.taken = int(self.clock[STEP])
        if flag != DONE:
            raise squeezed(self.taken * self.step)

    def settled(self) -> int:
        """Steps until it may be proved that the collision is over; NEVER if not as it is."""
        if driven(self.plan.system):
            return NEVER
        return int(settled(self.row, self.signals, self.taken, self.tol))


def _counts(plan: Plan, step: float) -> list[int]:
    return [max(1, round(float(s.transit_time) / step)) for s in plan.segments]


def follow(
    system: System, until: float | None, max_events: int, dt: float | None, rtol: float | None
) -> StepRun:
    """Run a single collision.

    Parameters
    ----------
    system : System
        Of shape ().
    until : float, optional
        s; by default the run ends a round trip of the longest rod after the proof of finality.
    max_events : int
        Cap on steps times ends, where no end is given.
    dt : float, optional
        Step, s; chosen if not given.
    rtol : float, optional
        Relative accuracy to which the step is halved.

    Raises
    ------
    InvalidModel
        If there is no end to run to, or the run is too long for the memory.
    """
    require_end(system, until)
    plan = Plan(system)
    transits = [float(s.transit_time) for s in plan.segments]
    if dt is not None and dt > min(transits) * (1 + 2.0**-36):
        path = plan.paths[1 + transits.index(min(transits))]
        message = f"must not exceed the shortest transit time, {min(transits):.6g} s of {path}"
        raise InvalidModel([("dt", f"{message}, got {dt!r}")])
    if dt is not None:
        return _level(plan, _counts(plan, dt), dt, until, max_events)
    goal = RTOL if rtol is None else rtol
    least = max(FIRST, math.ceil(SHORTEST * max(transits) / min(transits)),
                math.ceil(max(transits) / _resolving(plan)))
    if least > MOST_STEPS:
        short = min(range(len(transits)), key=transits.__getitem__)
        message = (
            f"its transit time or that of a contact is so short beside the longest, "
            f"{max(transits):.3g} s, that this would take {least:.3g} steps; leave it out, soften "
            "the contact of a mass, or give the step dt"
        )
        raise InvalidModel([(plan.paths[short + 1], message)])
    choose: Callable[..., Any] = choose_step
    if kernels.enabled() and kernels.started():
        choose = kernels.compiled(choose_step)
    number, _ = choose(np.array(transits).tolist() if choose is choose_step else np.array(transits),
                       least, max(10_000, 2 * least), goal / 16)
    counts = _counts(plan, max(transits) / number)
    step = max(transits) / number

    def level(factor: int) -> StepRun:
        finer = [factor * N for N in counts]
        return _level(plan, finer, step / factor, until, max_events)

    found, estimates = refined(level, contact_measures, goal, 2 * FINEST // max(counts))
    return replace(found, estimates=estimates, rtol=goal)


def _resolving(plan: Plan) -> float:
    """Step that resolves the contact of a mass with a stiff neighbour: a twentieth of its time."""
    finest = math.inf
    v = 2 * plan.scale or 1.0
    for k in range(len(plan.first) - 1):
        m0, m1 = plan.first[k], plan.first[k + 1]
        for q in range(m1 - m0 + 1 if m1 > m0 else 0):
            i = k + m0 + q
            around = [plan.masses[m] for m in (m0 + q - 1, m0 + q) if m0 <= m < m1]
            m, stiff = 1 / sum(1 / M for M in around), plan.stiffness[i]
            if plan.laws[i] == SPRING:
                finest = min(finest, math.pi * math.sqrt(m / stiff) / 20)
            elif plan.laws[i] > SPRING:
                finest = min(finest, 2.9432 * (1.25 * m * v * v / stiff) ** 0.4 / v / 20)
    longest = max(float(s.transit_time) for s in plan.segments)
    return max(finest, longest / FINEST * 4)


def _level(
    plan: Plan, counts: list[int], step: float, until: float | None, max_events: int
) -> StepRun:
    """One run with a given step."""
    longest = max(sum(counts[first - 1 : last]) for first, last in plan.spans)
    nodes = len(counts) + 1
    proof, reason = -1, "until"
    cap = max(1, max_events // nodes)
    if until is not None:
        machine = Machine(plan, counts, step, max(1, math.ceil(until / step * (1 - 1e-12))))
        machine.advance(machine.room if until > 0 else 0)
        if machine.settled() == 0:
            proof = machine.taken
    else:
        machine = Machine(plan, counts, step, 8 * longest)
        while proof < 0 and machine.taken < cap:
            wait = machine.settled()
            if wait == 0:
                proof = machine.taken
            else:
                # an eighth more each time, so that proofs and copies cost no more than the run
                pause = min(wait, 8 * longest) if wait < NEVER else longest
                machine.advance(min(cap, machine.taken + max(longest, pause, machine.taken // 8)))
        reason = "final" if proof >= 0 else "max_events"
        if proof >= 0:
            machine.advance(machine.taken + 2 * longest)
    return StepRun(
        clockwork=clockwork(plan, counts, step), plan=plan, step=step, steps=machine.taken,
        row=machine.row, tally=machine.tally, signals=machine.signals, settled=proof,
        stopped_by=reason,
    )


def clockwork(plan: Plan, counts: list[int], step: float) -> Clockwork:
    """Put a row on the clock of a time step; `counts` are the steps of the segments' transits."""
    errors = [abs(N * step / float(s.transit_time) - 1)
              for N, s in zip(counts, plan.segments, strict=True)]
    worst = max(range(len(errors)), key=errors.__getitem__)
    return Clockwork(
        system=plan.system, spans=plan.spans,
        wave_speed=[0.0, *(float(s.wave_speed) for s in plan.segments), 0.0],
        impedance=[0.0, *(float(s.impedance) for s in plan.segments), 0.0],
        length=[0.0, *(float(s.length) for s in plan.segments), 0.0],
        ticks=[0, *(N * PARTS for N in counts), 0], tick=step / PARTS, frame=plan.frame,
        gravity=plan.gravity, grain=PARTS, transit_error=errors[worst],
        worst=plan.paths[worst + 1],
    )
