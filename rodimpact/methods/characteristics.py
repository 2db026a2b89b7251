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
from ..model import (
    Absorbing,
    Bonded,
    Fixed,
    Force,
    Hertz,
    HuntCrossley,
    Rigid,
    RigidMass,
    Rod,
    Samples,
    Spring,
    SpringDashpot,
    Steps,
    System,
    Velocity,
    Wall,
)
from . import kernels
from .abilities import driven, require_end
from .characteristics_kernel import (
    BOND,
    DONE,
    FORCE,
    FREE,
    HERTZ,
    HUNT,
    IMPACT,
    NEVER,
    RIGID,
    SPRING,
    STEP,
    Row,
    Signals,
    Tally,
    Work,
    choose_step,
    run,
    settled,
)
from .clockwork import Clockwork

PARTS = 1 << 16
"""Ticks of a step: fields are looked up between steps, where waves keep their averages."""

TOLERANCE = 2.0**-48  # of the velocities, below which contacts graze
RTOL = 1e-5
FIRST = 64  # fewest steps of the longest transit
FINEST = 1 << 14  # most steps of the longest transit in the search for an accurate step
SHORTEST = 4  # fewest steps of the shortest transit
MOST_STEPS = 1 << 16  # of the longest transit, that the shortest may ask for
LINK_TIME = 3e-6  # s, about what plain Python takes for a link and a step; in a chain 5 times that
MOST_BYTES = 4 << 30  # of the signals
MEASURES = ("impulse", "largest force", "time of 99.9 % of the impulse")

Array = np.ndarray[Any, np.dtype[Any]]


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

    def contact(self, contact: int) -> tuple[Array, Array]:
        """Mean force in each step, N, and gap at its end, m; of a contact that can open."""
        start = int(self.signals.link_start[self.plan.contact_link[contact]])
        span = slice(start, start + self.steps)
        return self.signals.force[span], self.signals.gap[span] * self.step

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
            wall = float(self.plan.outside[side][1]) - self.plan.frame
            return wall - self.plan.gravity * self.step * np.arange(self.steps + 1.0)
        start = int(self.signals.mass_start[mass])
        initial = self.plan.mass_velocity[mass] - self.plan.frame
        return np.concatenate(([initial], self.signals.speed[start : start + self.steps]))


class TooLong(InvalidModel):
    """A run takes more steps than there is memory for."""


class Plan:
    """A single system as a row of links, masses and segments, in SI, without a step yet.

    Attributes
    ----------
    spans, segments, paths
        As in `Clockwork`; segments in order.
    first : list of int
        Masses left of each node; the links of node k begin at k + first[k].
    masses, mass_velocity : list of float
        Bodies bonded together are one mass.
    mass_of : list of int
        Mass of each body; len(masses) + 0 or 1 if bonded to the left or right wall, -1 for a rod or
        a wall.
    laws, stiffness, damping, gap : list
        By link.
    contact_link : list of int
        Link of each contact, -1 where it joins rigid bodies for good.
    outside : list of (str, value)
        Left and right: ``"none"``, ``"velocity"``, ``"force"`` or ``"absorbing"``.
    frame, scale : float
        Velocity of the frame, and scale of velocities, m/s.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.gravity = float(system.gravity)
        self.laws: list[int] = []
        self.stiffness: list[float] = []
        self.damping: list[float] = []
        self.gap: list[float] = []
        self.contact_link: list[int] = []
        self.masses: list[float] = []
        self.mass_velocity: list[float] = []
        self.mass_of: list[int] = []
        self.first: list[int] = [0]
        self.segments: list[Any] = []
        self.paths = [""]
        spans: list[tuple[int, int]] = []
        self.outside: list[tuple[str, Any]] = [("none", 0.0), ("none", 0.0)]
        last = len(system.bodies) - 1
        for i, body in enumerate(system.bodies):
            joined = i > 0 and isinstance(system.contacts[i - 1], Bonded)
            rigid_before = i > 0 and not isinstance(system.bodies[i - 1], Rod)
            if i == 0 and not isinstance(body, Wall):
                self._end(0, system.ends[0])
            elif i > 0 and joined and rigid_before and not isinstance(body, Rod):
                self.contact_link.append(-1)
                self._merge(body)
                spans.append((1, 0))
                continue
            elif i > 0:
                self.contact_link.append(len(self.laws))
                self._link(system.contacts[i - 1], float(system.gaps[i - 1]))
            if isinstance(body, Rod):
                for j, segment in enumerate(body.segments):
                    if j:
                        self._add(BOND)
                    self.segments.append(segment)
                    stepped = len(body.segments) > 1
                    self.paths.append(f"bodies.{i}.segments.{j}" if stepped else f"bodies.{i}")
                    self.first.append(len(self.masses))
                n = len(self.segments)
                spans.append((n - len(body.segments) + 1, n))
                self.mass_of.append(-1)
                continue
            spans.append((1, 0))
            if isinstance(body, RigidMass):
                self.masses.append(float(body.mass))
                self.mass_velocity.append(float(body.velocity))
                self.mass_of.append(len(self.masses) - 1)
            else:
                self.outside[0 if i == 0 else 1] = ("velocity", float(body.velocity))
                self.mass_of.append(-1)
        if not isinstance(system.bodies[last], Wall):
            self._end(1, system.ends[1])
        self.first.append(len(self.masses))
        for i, m in enumerate(self.mass_of):
            if m < 0 and isinstance(system.bodies[i], RigidMass):
                self.mass_of[i] = len(self.masses) + any(stop for _, stop in spans[:i])
        self.spans = tuple(spans)
        self.frame, self.scale = self._frame_and_scale()

    def _add(
        self, law: int, stiffness: float = 0.0, damping: float = 0.0, gap: float = 0.0
    ) -> None:
        self.laws.append(law)
        self.stiffness.append(stiffness)
        self.damping.append(damping)
        self.gap.append(gap)

    def _link(self, law: Any, gap: float) -> None:
        if isinstance(law, Bonded):
            self._add(BOND)
        elif isinstance(law, Rigid):
            impact = law.restitution is not None
            self._add(IMPACT if impact else RIGID, 0.0, float(law.restitution or 0.0), gap)
        else:
            kind = {Spring: SPRING, SpringDashpot: SPRING, Hertz: HERTZ, HuntCrossley: HUNT}
            damping = float(getattr(law, "damping", 0.0))
            self._add(kind[type(law)], float(law.stiffness), damping, gap)

    def _end(self, side: int, end: Any) -> None:
        kinds = {Fixed: "velocity", Velocity: "velocity", Force: "force", Absorbing: "absorbing"}
        kind = kinds.get(type(end), "none")
        self.outside[side] = (kind, getattr(end, "value", 0.0))
        self._add({"none": FREE, "force": FORCE}.get(kind, BOND))

    def _merge(self, body: Any) -> None:
        """Join a rigid body to the one before it: two masses, or a mass and a wall."""
        if isinstance(body, Wall):
            self.outside[1] = ("velocity", float(body.velocity))
            self.masses.pop()
            self.mass_velocity.pop()
            top = len(self.masses)
            self.mass_of = [-1 if m == top else m for m in self.mass_of]
            self.mass_of.append(-1)
        elif self.mass_of[-1] < 0:  # the wall it is bonded to
            self.mass_of.append(-1)
        else:
            m = self.mass_of[-1]
            M, more = self.masses[m], float(body.mass)
            momentum = M * self.mass_velocity[m] + more * float(body.velocity)
            self.masses[m], self.mass_velocity[m] = M + more, momentum / (M + more)
            self.mass_of.append(m)

    def _frame_and_scale(self) -> tuple[float, float]:
        walls = [float(b.velocity) for b in self.system.bodies if isinstance(b, Wall)]
        velocities, strained, pushed = [*walls, *self.mass_velocity], 0.0, 0.0
        for body, (start, stop) in zip(self.system.bodies, self.spans, strict=True):
            if isinstance(body, Rod):
                velocities += extremes(body.velocity)
                c = max(float(s.wave_speed) for s in self.segments[start - 1 : stop])
                strained = max(strained, *(c * abs(e) for e in extremes(body.strain)))
        weakest = min(float(s.impedance) for s in self.segments)
        for kind, value in self.outside:
            if kind == "velocity":
                velocities += extremes(value)
            elif kind == "force":
                pushed = max(pushed, *(abs(F) for F in extremes(value))) / weakest
        low, high = min(velocities), max(velocities)
        frame = sum(walls) / len(walls) if walls else low / 2 + high / 2
        fall = abs(self.gravity) * max(float(s.transit_time) for s in self.segments)
        return frame, high - low + strained + pushed + fall


def extremes(profile: Any) -> list[float]:
    """Smallest and largest value of a profile."""
    values: Any = profile.values if isinstance(profile, Steps | Samples) else [profile]
    return [float(np.min(values)), float(np.max(values))]


def averages(profile: Any, edges: Array, length: float) -> Array:
    """Mean values of a profile between neighbouring edges.

    Parameters
    ----------
    profile : float, Steps or Samples
    edges : [n + 1] array
        Increasing places or times.
    length : float
        Of the rod, for samples that run from end to end.
    """
    if isinstance(profile, Steps):
        at = np.array([float(x) for x in profile.at])
        values = np.array([float(v) for v in profile.values])
        first, last = np.searchsorted(at, edges[:-1], "right"), np.searchsorted(at, edges[1:])
        found = values[first]
        for i in np.flatnonzero(last > first):
            cuts = np.concatenate(([edges[i]], at[first[i] : last[i]], [edges[i + 1]]))
            found[i] = np.sum(values[first[i] : last[i] + 1] * np.diff(cuts)) / (
                edges[i + 1] - edges[i]
            )
        return found
    if isinstance(profile, Samples):
        values = np.asarray(profile.values, dtype=float)
        width = length / (len(values) - 1) if profile.step is None else float(profile.step)
        knots = width * np.arange(len(values))
        total = np.concatenate(([0.0], np.cumsum((values[1:] + values[:-1]) / 2) * width))
        inside = np.clip(edges, 0.0, knots[-1])
        i = np.clip((inside / width).astype(int), 0, len(values) - 2)
        s = inside - knots[i]
        slope = (values[i + 1] - values[i]) / width
        integral = total[i] + values[i] * s + slope * s * s / 2
        integral += values[-1] * np.maximum(edges - knots[-1], 0.0)
        integral += values[0] * np.minimum(edges, 0.0)
        mean: Array = np.diff(integral) / np.diff(edges)
        return mean
    return np.full(len(edges) - 1, float(profile))


class Machine:
    """The kernel's state on arrays, and the room that it needs."""

    def __init__(self, plan: Plan, counts: list[int], step: float, room: int) -> None:
        self.plan, self.step, self.room = plan, step, room
        n, h, links, masses = len(counts), step, len(plan.laws), len(plan.masses)
        power = {HERTZ: 1.5, HUNT: 1.5}
        stiffness = [k * h ** power.get(law, 1.0)
                     for k, law in zip(plan.stiffness, plan.laws, strict=True)]
        mobility = [0.0, *(1 / float(s.impedance) for s in plan.segments), 0.0]
        for side, s in ((0, 1), (1, n)):
            if plan.outside[side][0] == "absorbing":
                mobility[(n + 1) * side] = mobility[s]
        self.row = Row(
            _whole([0, *counts, 0]), np.array(mobility), _whole(plan.first),
            np.array(plan.masses) / h, _whole(plan.laws), np.array(stiffness),
            np.array(plan.damping), np.array(plan.gap) / h, np.zeros(links), np.zeros(links),
            np.ones(links, np.int64), np.array(plan.mass_velocity) - plan.frame,
        )
        self.tally = Tally(*(np.zeros(links) for _ in range(4)),
                           *(np.full(links, v, np.int64) for v in (-1, -1, 0, 0)))
        self.work = Work(*(np.zeros(masses + 2) for _ in Work._fields))
        self.clock = _whole([0, 0])
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
            np.zeros(size), _whole(starts), np.zeros(len(wanted) * room),
            np.zeros(len(wanted) * room), _whole(link_start), np.zeros(len(plan.masses) * room),
            _whole([m * room for m in range(len(plan.masses))]),
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
                self.row, self.tally, self.signals, self.work, self.clock, end, self.tol
            )
        else:
            parts = (self.row, self.tally, self.signals, self.work)
            lists: Any = [type(x)(*(c.tolist() for c in x)) for x in parts]
            clock = self.clock.tolist()
            flag = run(lists[0], lists[1], lists[2], lists[3], clock, end, self.tol)
            for part, found in zip(parts, lists, strict=True):
                for column, values in zip(part, found, strict=True):
                    column[:] = values
            self.clock[:] = clock
        self.taken = int(self.clock[STEP])
        if flag != DONE:
            message = (
                f"a rigid mass is squeezed between walls that leave it no room, at "
                f"{self.taken * self.step:.6g} s; give a contact there a compliant law"
            )
            raise InvalidModel([("contacts", message)])

    def settled(self) -> int:
        """Steps until it may be proved that the collision is over; NEVER if not as it is."""
        if driven(self.plan.system):
            return NEVER
        return int(settled(self.row, self.signals, self.taken, self.tol))


def _whole(values: list[int]) -> Array:
    return np.array(values, dtype=np.int64)


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
    return _refined(plan, counts, max(transits) / number, until, max_events, goal)


def _refined(
    plan: Plan, counts: list[int], step: float, until: float | None, max_events: int, goal: float
) -> StepRun:
    """Halve the step until the outcome stands still, or for as long as cap and memory allow."""
    found = _level(plan, counts, step, until, max_events)
    factor, estimates = 1, dict.fromkeys(MEASURES, math.inf)
    before: dict[str, float] = {}
    while found.stopped_by != "max_events" and max(estimates.values()) > goal:
        factor *= 2
        if factor > 4 and factor * max(counts) > 2 * FINEST:
            break
        try:
            finer = _level(plan, [factor * N for N in counts], step / factor, until, max_events)
        except TooLong:
            break
        if finer.stopped_by == "max_events":
            break
        changes, found = _changes(found, finer), finer
        if before:
            estimates = {name: max(v, before[name] / 2) for name, v in changes.items()}
        before = changes
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


def _changes(coarse: StepRun, fine: StepRun) -> dict[str, float]:
    """Relative change of the measures of an outcome from one step to another."""
    a, b = _measures(coarse), _measures(fine)
    return {name: float(np.max(np.abs(a[name] - b[name]), initial=0.0)) / (
        float(np.max(np.abs(b[name]), initial=0.0)) or 1.0) for name in b}


def _measures(found: StepRun) -> dict[str, Array]:
    """Impulse, largest force, and time of 99.9 % of the impulse, by contact that can open.

    Restitution follows from the impulses.
    """
    plan = found.plan
    contacts = [k for k, i in enumerate(plan.contact_link) if i >= 0 and plan.laws[i] >= RIGID]
    forces = [found.contact(k)[0] for k in contacts]
    found_measures = (
        [float(np.sum(F)) * found.step for F in forces], [peak(F) for F in forces],
        [_most_of(F) * found.step for F in forces],
    )
    return {name: np.array(values) for name, values in zip(MEASURES, found_measures, strict=True)}


def _most_of(force: Array) -> float:
    """Steps in which 99.9 % of the impulse has passed."""
    passed = np.cumsum(force)
    if not len(passed) or passed[-1] <= 0:
        return 0.0
    goal = 0.999 * passed[-1]
    j = int(np.searchsorted(passed, goal))
    before = passed[j - 1] if j else 0.0
    return float(j + (goal - before) / (passed[j] - before))


def peak(force: Array) -> float:
    """Largest force behind step averages.

    At a jump half a step's change beyond the average next to it; at a smooth top that of the
    parabola with the averages of three steps.
    """
    if not len(force) or force.max() <= 0:
        return 0.0
    G = np.concatenate(([0.0, 0.0], force, [0.0, 0.0]))
    j = int(np.argmax(G))
    before, after = float(G[j] - G[j - 1]), float(G[j] - G[j + 1])
    if before > 4 * after:
        return float(G[j]) + (after / 2 if abs(after - (G[j + 1] - G[j + 2])) < after else 0.0)
    if after > 4 * before:
        return float(G[j]) + (before / 2 if abs(before - (G[j - 1] - G[j - 2])) < before else 0.0)
    both = before + after
    if both <= 0:
        return float(G[j])
    return float(G[j]) + both / 24 + (before - after) ** 2 / (8 * both)
