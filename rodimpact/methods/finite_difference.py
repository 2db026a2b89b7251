"""The method "finite-difference": rods on a staggered grid, for physics that breaks d'Alembert.

It carries everything the other methods carry, and damping, tapers and lateral inertia; it stores
states and rebuilds nothing from signals at the ends. Waves cross all but a cell in a step (Courant
number 0.999) in the segment with the longest transit; every other segment gets as many cells as its
transit has whole steps of this, so that it runs just below: one cell more would be unstable, one
less disperses waves more than it must. At 1 exactly leapfrog has no error, but the even and the odd
nodes do not know of each other: what a contact does between two steps makes them part for good, and
velocities never converge.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..frozen import InvalidModel
from ..model import Rod, System
from ..profiles import averages
from . import kernels
from .abilities import driven, require_end
from .clockwork import PARTS, Clockwork
from .finite_difference_kernel import (
    DONE,
    ENDLESS,
    MOVED,
    NOTHING,
    PUSHED,
    STEP,
    Bonds,
    Ends,
    Grid,
    Implicit,
    Links,
    Signals,
    States,
    factor,
    run,
    substitute,
)
from .link_kernel import HERTZ, HUNT, RIGID, Chain, Tally
from .mesh import Mesh
from .plan import Array, Plan
from .refinement import MEASURES, TooLong, contact_measures, refined

TOLERANCE = 2.0**-40  # of the velocities, below which contacts graze: round-off of many steps
SPECK = 1.0  # of what bodies cover in a step: a smaller gap is no opening, but dispersed waves
RTOL = 1e-3
COURANT = 0.999
FIRST = 100  # fewest cells of the longest transit
FEWEST = 8  # cells of a segment, where nothing else is asked for
FINEST = 1 << 13  # most cells of the longest transit in the search for an accurate mesh
MOST_CELLS = 1 << 20
STABLE = 1 + 2.0**-30  # Courant number up to which a mesh is taken; beyond 1 by round-off only
MOST_BYTES = 4 << 30  # of signals
STATES_BYTES = 64 << 20  # of kept states, where their number is not given
CELL_TIMES = {"explicit": (7e-10, 8e-7), "implicit": (6e-9, 2.5e-6)}
"""Time of a cell and a step, s, compiled and in plain Python."""

LONG = 60.0  # s, from which a run is announced
ROUND = 0.25  # s between two looks at the clock

Progress = Callable[[int, int], None]


@dataclass(frozen=True, kw_only=True)
class GridRun:
    """A finished run.

    Attributes
    ----------
    clockwork : Clockwork
    mesh : Mesh
    step : float
        s.
    steps : int
        Steps taken.
    grid, links, tally, signals
        The kernel's state at the end, on arrays.
    states : States
        What was kept: columns [state, node], [state, cell], [state, piece] and [state].
    settled : int
        Step at which the collision was proved final, -1 without proof.
    stopped_by : str
        ``"final"``, ``"until"`` or ``"max_events"``.
    estimates : dict of str to float
        As in `StepRun`.
    rtol : float
    """

    clockwork: Clockwork
    mesh: Mesh
    step: float
    steps: int
    grid: Grid
    links: Links
    tally: Tally
    signals: Signals
    states: States
    settled: int
    stopped_by: str
    estimates: dict[str, float] = field(default_factory=dict)
    rtol: float = 0.0

    @property
    def plan(self) -> Plan:
        """The row."""
        return self.mesh.plan

    @property
    def events(self) -> int:
        """Steps taken, times contacts and ends."""
        return self.steps * len(self.plan.laws)

    def _signal(self, column: Array, start: int) -> Array:
        return column[start : start + self.steps]

    @property
    def largest_strain(self) -> float:
        """Largest strain of the states that were kept."""
        mesh, found = self.mesh, 0.0
        for a, b, L, N in zip(
            mesh.first[1:], mesh.last[1:], self.clockwork.length[1:-1], mesh.counts, strict=True
        ):
            stretched = self.states.force[:, a + 1 : b + 1] / mesh.stiffness[a + 1 : b + 1]
            found = max(found, float(np.abs(stretched).max()) * N / L)
        return found

    @property
    def resolved(self) -> float:
        """Gap that counts as an opening, m."""
        return SPECK * self.plan.scale * self.step

    def contact(self, contact: int) -> tuple[Array, Array]:
        """Mean force in each step, N, and gap at its end, m; of a contact that can open."""
        start = int(self.signals.link_start[self.place(contact)])
        gap = self._signal(self.signals.gap, start) * self.step
        return self._signal(self.signals.force, start), gap

    def path(self, contact: int) -> Array:
        """How far a contact that can open closes in each step, m."""
        start = int(self.signals.link_start[self.place(contact)])
        return self._signal(self.signals.closing, start) * self.step

    def place(self, contact: int) -> int:
        """Place in the tally of a contact that can open."""
        return list(self.mesh.touching).index(self.plan.contact_link[contact])

    def bond(self, contact: int) -> Array:
        """Mean force in a bonded contact in each step, N."""
        return self._bond(self.plan.contact_link[contact])

    def _bond(self, link: int) -> Array:
        place = list(self.mesh.interfaces).index(link)
        return self._signal(self.signals.bond, place * int(self.signals.room[0]))

    def outer(self, side: int) -> tuple[Array, Array]:
        """Force of what is outside the left or right end on the row, and its velocity, by steps.

        N and m/s, in the laboratory; positive to the inside, and to the right.
        """
        start, link = side * int(self.signals.room[0]), (0, len(self.plan.laws) - 1)[side]
        if link in self.mesh.touching:
            place = int(self.signals.link_start[list(self.mesh.touching).index(link)])
            force = self._signal(self.signals.force, place)
        elif self.plan.outside[side][0] == "velocity":
            force = self._bond(link)
        else:
            force = self._signal(self.signals.push, start)
        fall = self.plan.gravity * self.step * (np.arange(self.steps) + 0.5)
        return force, self._signal(self.signals.speed, start) + self.plan.frame + fall

    def speed(self, mass: int) -> Array:
        """Velocity of a mass at the ends of the steps, the first at t = 0, in the frame."""
        side = mass - len(self.plan.masses)
        if side >= 0:
            wall = float(self.plan.outside[side][1]) - self.plan.frame
            return wall - self.plan.gravity * self.step * np.arange(self.steps + 1.0)
        initial = self.states.velocity[0, self.mesh.node_of_mass[mass]]
        start = mass * int(self.signals.room[0])
        return np.concatenate(([initial], self._signal(self.signals.mass_speed, start)))


class Machine:
    """The kernel's state on arrays, and the room that it needs."""

    def __init__(self, mesh: Mesh, step: float, keep: Keeper, room: int) -> None:
        self.mesh, self.step, self.room = mesh, step, 0
        plan, h = mesh.plan, step
        self.plan = plan
        implicit = mesh.implicit
        mass = mesh.mass / h
        for side, (kind, _) in enumerate(plan.outside):
            if kind == "absorbing":
                mass[mesh.ends[side]] += self._impedance(side) / 2
        self.implicit = self._implicit(mass, implicit)
        ease = np.where(mesh.held == 1, 0.0, 1 / np.where(mass > 0, mass, 1.0))
        for a, b, hidden in zip(mesh.starts, mesh.stops, implicit, strict=True):
            if hidden:
                ease[a : b + 1] = 0.0
        self.grid = self._grid(ease, implicit)
        self.links, self.chain = self._links(ease, implicit)
        self.bonds = self._bonds()
        self.ends = Ends(
            _whole([self._kind(side) for side in (0, 1)]), _whole(mesh.ends),
            np.array([self._impedance(side) for side in (0, 1)]), np.zeros(2), np.zeros(2),
        )
        count = len(mesh.touching)
        self.tally = Tally(*(np.zeros(count) for _ in range(4)),
                           *(np.full(count, v, np.int64) for v in (-1, -1, 0, 0)))
        self._set_initial_state()
        self.signals = self._allocate(room)
        self.keep = keep
        self.states = keep.make(self, room)
        self.clock = _whole([0, 0, 0])
        self.taken = 0
        self.tol, self.speck = TOLERANCE * plan.scale, SPECK * plan.scale

    # Laying out ---------------------------------------------------------------------------------

    def _kind(self, side: int) -> int:
        return {"none": NOTHING, "force": PUSHED, "velocity": MOVED, "absorbing": ENDLESS}[
            self.plan.outside[side][0]
        ]

    def _impedance(self, side: int) -> float:
        """Impedance sqrt(E A rho A) of the rod's last cell at an end."""
        cell = self.mesh.ends[side] + (1 if side == 0 else 0)
        return math.sqrt(float(self.mesh.stiffness[cell] * self.mesh.cell_mass[cell]))

    def _grid(self, ease: Array, implicit: list[bool]) -> Grid:
        mesh, h = self.mesh, self.step
        stiffness = mesh.stiffness * h
        first, last, kick, stiff = [], [], [], []
        for s in range(1, len(mesh.first)):
            a, b = mesh.first[s], mesh.last[s]
            if implicit[mesh.piece_of(a)]:
                continue
            k, e = stiffness[a + 1 : b + 1], ease[a + 1 : b]
            alike = np.all(k == k[0]) and np.all(e == e[:1])
            first.append(a)
            last.append(b)
            stiff.append(float(k[0]) if alike else -1.0)
            kick.append(float(e[0]) if alike and len(e) else -1.0)
        n = len(mesh.mass)
        return Grid(
            np.zeros(n), np.zeros(n + 1), ease, stiffness, _whole(first), _whole(last),
            np.array(kick), np.array(stiff), _whole(sorted({*first, *last})),
            _whole(mesh.starts), np.zeros(len(mesh.starts)),
        )

    def _implicit(self, mass: Array, implicit: list[bool]) -> Implicit:
        mesh, h = self.mesh, self.step
        n = len(mass)
        bound = mesh.lateral / h + mesh.viscous / 2
        spans = [(a, b) for a, b, hidden in zip(mesh.starts, mesh.stops, implicit, strict=True)
                 if hidden]
        found = Implicit._make([
            _whole([a for a, _ in spans]), _whole([(a + b) // 2 for a, b in spans]),
            _whole([b for _, b in spans]), *np.zeros((2, len(spans))), mesh.viscous, bound,
            *np.zeros((7, n)), np.zeros(n + 1),
        ])
        diagonal = (mass + bound[:-1] + bound[1:]).tolist()
        lists = _lists(found)
        for p, (a, b) in enumerate(spans):
            factor(lists, diagonal, mesh.held.tolist(), p)
            for node, answer in ((a, lists.by_first), (b, lists.by_last)):
                if not mesh.held[node]:
                    answer[node] = 1.0
                substitute(lists, answer, p)
        _copy(lists, found)
        return found

    def _links(self, ease: Array, implicit: list[bool]) -> tuple[Links, Chain]:
        mesh, plan, h = self.mesh, self.plan, self.step
        hidden = [p for p, is_hidden in enumerate(implicit) if is_hidden]
        chosen, nodes = list(mesh.touching), list(mesh.touching.values())
        count = len(chosen)
        power = {HERTZ: 1.5, HUNT: 1.5}
        sides: list[list[int]] = [[], []]
        own, shared = np.zeros((2, count))
        for q, pair in enumerate(nodes):
            for side, node in enumerate(pair):
                piece = mesh.piece_of(node)
                place = hidden.index(piece) if piece in hidden else -1
                sides[side].append(place)
                answer = (self.implicit.by_last, self.implicit.by_first)[side]
                own[q] += (ease if place < 0 else answer)[node] / 2
            if q and mesh.piece_of(pair[0]) == mesh.piece_of(nodes[q - 1][1]):
                if sides[0][q] >= 0:
                    shared[q] = self.implicit.by_first[pair[0]] / 2
                elif pair[0] == nodes[q - 1][1]:
                    shared[q] = ease[pair[0]] / 2
        gap = np.array([plan.gap[i] for i in chosen]) / h
        links = Links(
            _whole([plan.laws[i] for i in chosen]),
            np.array([plan.stiffness[i] * h ** power.get(plan.laws[i], 1.0) for i in chosen]),
            np.array([plan.damping[i] for i in chosen]), gap, np.zeros(count), np.zeros(count),
            np.ones(count, np.int64), (gap == 0).astype(np.int64),
            _whole([pair[0] for pair in nodes]), _whole([pair[1] for pair in nodes]),
            _whole(sides[0]), _whole(sides[1]), own, shared, np.zeros(count),
            np.append(np.flatnonzero(shared == 0), count),
        )
        return links, Chain(*np.zeros((len(Chain._fields), count)))

    def _bonds(self) -> Bonds:
        places = {link: q for q, link in enumerate(self.mesh.touching)}
        found = list(self.mesh.interfaces.values())
        return Bonds(
            _whole([x.node for x in found]), np.array([x.mass / self.step for x in found]),
            _whole([x.side for x in found]), _whole([x.cell for x in found]),
            _whole([places.get(x.link, -1) for x in found]), _whole([x.end for x in found]),
            np.zeros(len(found)), np.zeros(len(found)),
        )

    def _set_initial_state(self) -> None:
        mesh, plan, grid = self.mesh, self.plan, self.grid
        v, strain = grid.velocity, np.zeros(len(mesh.mass) + 1)
        for body, (start, stop) in zip(plan.system.bodies, plan.spans, strict=True):
            if not isinstance(body, Rod):
                continue
            left = 0.0
            for s in range(start, stop + 1):
                a, b, L = mesh.first[s], mesh.last[s], float(plan.segments[s - 1].length)
                N = mesh.counts[s - 1]
                halves = averages(body.velocity, left + L * np.arange(2 * N + 1) / (2 * N),
                                  float(body.length))
                m = np.repeat(mesh.cell_mass[a + 1 : b + 1] / 2, 2)
                v[a : b + 1] += np.bincount((np.arange(2 * N) + 1) // 2, m * halves)
                edges = left + L * np.arange(N + 1) / N
                strain[a + 1 : b + 1] = averages(body.strain, edges, float(body.length)) * L / N
                left += L
        for place, node in enumerate(mesh.node_of_mass):
            v[node] += plan.masses[place] * plan.mass_velocity[place]
        weight = np.where(mesh.mass > 0, mesh.mass, 1.0)
        v[:] = np.where(mesh.mass > 0, v / weight - plan.frame, 0.0)
        jump = np.zeros(len(v))
        for side, (kind, value) in enumerate(plan.outside):
            if kind == "velocity":
                node = mesh.ends[side]
                jump[node] = self._given(value, np.zeros(1))[0] - v[node]
        v += self._dragged(jump)
        tension = mesh.stiffness * strain
        kick = self._first_kick(tension)
        grid.force[:] = tension + grid.stiffness * np.diff(kick - v, prepend=0.0, append=0.0) / 2
        grid.place[:] = kick[mesh.starts] / 2
        for side, sign in ((0, 1), (1, -1)):
            cell = mesh.ends[side] + (1 if side == 0 else 0)
            if plan.outside[side][0] == "absorbing":  # v - F/Z, seen from the row
                wave = sign * float(tension[cell]) / self._impedance(side)
                self.ends.rest[side] = v[mesh.ends[side]] - wave
        links = self.links
        closing = v[links.left] - v[links.right]
        links.shut[links.gap <= closing / 2] = 1  # closes before the first kick

    def _dragged(self, jump: Array) -> Array:
        """Changes of velocity where held ends jump: lateral inertia takes neighbours along."""
        mesh, bound = self.mesh, self.mesh.lateral / self.step
        if not bound.any():
            return jump
        lists = _lists(self.implicit._replace(bound=bound))
        diagonal = (mesh.mass / self.step + bound[:-1] + bound[1:]).tolist()
        moved = jump.tolist()
        for p in range(len(lists.first)):
            factor(lists, diagonal, mesh.held.tolist(), p)
            substitute(lists, moved, p)
        return np.array(moved)

    def _first_kick(self, tension: Array) -> Array:
        """Velocities that half a kick by the forces at t = 0 gives.

        In the middle of the first step nodes are where these bring them: a force that begins at
        t = 0 lies between two kicks, and would leave a wave from node to node otherwise.
        """
        mesh, links, plan = self.mesh, self.links, self.plan
        force = np.diff(tension)
        for side, (kind, value) in enumerate(plan.outside):
            if kind == "force":
                force[mesh.ends[side]] += (1, -1)[side] * self._pushes(value, 1)[0]
            elif kind == "absorbing":
                force[mesh.ends[side]] = 0.0
        for law, gap, left, right in zip(
            links.law, links.gap, links.left, links.right, strict=True
        ):
            if law == RIGID and gap == 0 and force[left] > force[right]:
                force[left] = force[right] = 0.0
        found: Array = self.grid.ease * force / 2
        if len(self.implicit.first):
            lists, x = _lists(self.implicit), np.where(mesh.held == 1, 0.0, force / 2).tolist()
            for p, (a, b) in enumerate(zip(lists.first, lists.last, strict=True)):
                substitute(lists, x, p)
                found[a : b + 1] = x[a : b + 1]
        return found

    def _pushes(self, value: Any, steps: int) -> Array:
        """A driving force at each kick, N: its mean over two steps, which waves can follow."""
        halves = averages(value, self.step / 2 * np.arange(2 * steps + 2), 0.0)
        around = np.concatenate((halves[:1], halves))
        mean: Array = (around[:-3:2] + around[1:-2:2] + around[2:-1:2] + around[3::2]) / 4
        return mean

    def _given(self, value: Any, t: Array) -> Array:
        """Velocity of a wall or a driven end, averaged over a step about times t, in the frame."""
        if isinstance(value, float):
            found: Array = np.full(len(t), value)
        else:
            edges = np.append(t - self.step / 2, t[-1:] + self.step / 2)
            found = averages(value, np.maximum(edges, 0.0), 0.0)
        result: Array = found - self.plan.frame - self.plan.gravity * t
        return result

    # Room ---------------------------------------------------------------------------------------

    def _allocate(self, room: int) -> Signals:
        links, bonds = len(self.mesh.touching), len(self.mesh.interfaces)
        masses = len(self.mesh.node_of_mass)
        if 8 * room * (3 * links + bonds + 6 + masses) > MOST_BYTES:
            message = (
                f"a run of {room} steps of {self.step:.3g} s needs more than "
                f"{MOST_BYTES / 1e9:.3g} GB; stop earlier, or take fewer cells"
            )
            raise TooLong([("until", message)])
        given = np.zeros(2 * room)
        for side, (kind, value) in enumerate(self.plan.outside):
            span = slice(side * room, (side + 1) * room)
            edges = self.step * np.arange(room + 1)
            if kind == "velocity":
                given[span] = self._given(value, edges[1:])
            elif kind == "force":
                given[span] = self._pushes(value, room)
        self.room = room
        return Signals._make([
            *np.zeros((3, links * room)), _whole([i * room for i in range(links)]),
            np.zeros(bonds * room), given, *np.zeros((2, 2 * room)), _whole([room]),
            _whole(self.mesh.node_of_mass), np.zeros(masses * room),
        ])

    def _grow(self, room: int) -> None:
        old, was = self.signals, self.room
        self.signals = self._allocate(room)
        for name in ("force", "gap", "closing", "bond", "push", "speed", "mass_speed"):
            source, target = getattr(old, name), getattr(self.signals, name)
            if len(source):
                target.reshape(-1, room)[:, :was] = source.reshape(-1, was)

    # Running ------------------------------------------------------------------------------------

    def advance(self, end: int, tell: Callable[[int], None] | None = None) -> None:
        """Run to step `end`; `tell` hears of the steps taken, several times a second."""
        if end > self.room:
            self._grow(max(end, 2 * self.room))
        self.states = self.keep.room_for(self, end)
        parts: tuple[Any, ...] = (
            self.grid, self.implicit, self.links, self.chain, self.bonds, self.ends, self.tally,
            self.signals, self.states,
        )
        fast = kernels.worth_compiling((end - self.taken) * cost(self.mesh, plain=True))
        lists = parts if fast else tuple(_lists(x) for x in parts)
        go: Callable[..., int] = kernels.compiled(run) if fast else run
        clock: Any = self.clock if fast else self.clock.tolist()
        chunk = max(1, int(ROUND / cost(self.mesh, plain=not fast)))
        while True:
            target = min(end, self.taken + chunk)
            flag = go(*lists, clock, target, self.tol, self.speck)
            self.taken = int(clock[STEP])
            if flag != DONE or self.taken >= end:
                break
            if tell:
                tell(self.taken)
        if not fast:
            for part, found in zip(parts, lists, strict=True):
                _copy(found, part)
            self.clock[:] = clock
        if flag != DONE:
            message = (
                f"a rigid mass is squeezed between walls that leave it no room, at "
                f"{self.taken * self.step:.6g} s; give a contact there a compliant law"
            )
            raise InvalidModel([("contacts", message)])


class Keeper:
    """Which states are kept: at chosen times, or so many at equal distances, all if they fit."""

    def __init__(self, snapshots: int | Array | None) -> None:
        self.snapshots, self.stride = snapshots, 1
        self.most = snapshots if isinstance(snapshots, int) else 0

    def make(self, machine: Machine, room: int) -> States:
        """Empty states."""
        nodes, pieces = len(machine.mesh.mass), len(machine.mesh.starts)
        if self.most == 0:
            self.most = max(64, STATES_BYTES // (16 * nodes))
        when = self._when(machine, room)
        n = len(when)
        return States(_whole(when), np.zeros(n * nodes), np.zeros(n * (nodes + 1)),
                      np.zeros(n * pieces), np.zeros(n))

    def _when(self, machine: Machine, end: int) -> list[int]:
        if isinstance(self.snapshots, np.ndarray):
            steps = self.snapshots / machine.step
            both = np.concatenate((np.floor(steps), np.ceil(steps), [0.0]))
            chosen: list[int] = np.unique(both[both <= end].astype(int)).tolist()
            return chosen
        while end // self.stride + 2 > max(self.most, 3):
            self.stride *= 2
        return list(range(0, end + 1, self.stride))

    def room_for(self, machine: Machine, end: int) -> States:
        """Keep what is kept already, thinned where there is no room, and make room up to `end`."""
        old = machine.states
        new = self.make(machine, end)
        have = int(machine.clock[1])
        if end not in new.when:
            new = States(np.append(new.when, end), *(
                np.append(x, np.zeros(len(x) // len(new.when))) for x in new[1:]
            ))
        kept = np.flatnonzero(np.isin(old.when[:have], new.when))
        for x, y in zip(old[1:], new[1:], strict=True):
            if len(y):
                rows = x.reshape(len(old.when), -1)[kept]
                y.reshape(len(new.when), -1)[: len(kept)] = rows
        machine.clock[1] = len(kept)
        return new


def follow(
    system: System, until: float | None, max_events: int, *, cells: int | None = None,
    dt: float | None = None, rtol: float | None = None, snapshots: int | Array | None = None,
    progress: Progress | None = None, announce: Callable[[str], None] | None = None,
) -> GridRun:
    """Run a single collision.

    Parameters
    ----------
    system : System
        Of shape ().
    until : float, optional
        s; by default the run ends a round trip of the longest rod after the proof of finality.
    max_events : int
        Cap on steps times contacts and ends, where no end is given.
    cells : int, optional
        Of the segment with the longest transit.
    dt : float, optional
        Step, s.
    rtol : float, optional
        Relative accuracy to which cells and step are halved, where neither is given.
    snapshots : int or array, optional
        How many states to keep at most, or the times at which to keep them, s.
    progress : function, optional
        Called during long runs with the steps done, and about how many there will be.
    announce : function, optional
        Called with a sentence before a run that would take over a minute.

    Raises
    ------
    InvalidModel
        If there is no end to run to, the mesh would be unstable, or the run is too long for the
        memory.
    """
    require_end(system, until)
    plan = Plan(system)
    counts, step = _mesh_size(plan, cells, dt)

    def level(factor: int) -> GridRun:
        finer = Mesh(plan, [factor * N for N in counts])
        keep = Keeper(snapshots)
        return _level(finer, step / factor, keep, until, max_events, progress, announce)

    if cells is not None or dt is not None:
        return level(1)
    goal = RTOL if rtol is None else rtol
    found, estimates = refined(level, measures, goal, FINEST // max(counts))
    return replace(found, estimates=estimates, rtol=goal)


def measures(found: GridRun) -> dict[str, Array]:
    """What is to stand still: velocities, impulses, and when 99.9 % of them has passed.

    The largest force is left out: beside a jump waves overshoot, on any mesh. Velocities change
    beside their scale, so that the round-off of bodies at rest is none.
    """
    by_contact = contact_measures(found)
    del by_contact[MEASURES[1]]
    m, v = found.mesh.mass, found.grid.velocity
    free = [
        float(m[a : b + 1] @ v[a : b + 1] / m[a : b + 1].sum())
        for a, b in zip(found.mesh.starts, found.mesh.stops, strict=True)
        if not found.mesh.held[a : b + 1].any()
    ]
    return {"velocity": np.array([*free, found.plan.scale]), **by_contact}


def _mesh_size(plan: Plan, cells: int | None, dt: float | None) -> tuple[list[int], float]:
    """Cells of each segment, and the step, s, that is stable for them."""
    T = np.array([float(s.transit_time) for s in plan.segments])
    longest, shortest = int(np.argmax(T)), int(np.argmin(T))
    if cells is None and dt is None:
        least = max(FIRST, math.ceil(FEWEST * T[longest] / T[shortest]))
        if least > MOST_CELLS:
            message = (
                f"its transit time is so short beside the longest, {T[longest]:.3g} s, that this "
                f"would take {least:.3g} cells of {MOST_CELLS} at most; leave it out"
            )
            raise InvalidModel([(plan.paths[shortest + 1], message)])
        # of the numbers up to twice as many, the first for which all segments run nearest to 1
        numbers = np.arange(least, 2 * least)
        steps = numbers[:, None] * (T / T[longest])
        waste = (1 - np.floor(steps * STABLE) / steps).max(axis=1)
        cells = int(numbers[int(np.argmax(waste <= waste.min() + 2.0**-20))])
    base = float(T[longest]) / cells if cells is not None else dt
    assert base is not None
    counts = np.floor(T / base * STABLE).astype(int)
    step = float((T / np.maximum(counts, 1)).min()) * COURANT if dt is None else dt
    if cells is not None:
        counts[longest] = cells
    if counts.min() < 1:
        name, value = ("cells", cells) if dt is None else ("dt", dt)
        message = (
            f"leaves {plan.paths[shortest + 1]} without a cell, whose transit time is "
            f"{T[shortest]:.3g} s beside {T[longest]:.3g} s; give more cells, or a shorter step"
        )
        raise InvalidModel([(name, f"{message}, got {value!r}")])
    if counts.sum() > MOST_CELLS:
        message = f"asks for {counts.sum()} cells, of {MOST_CELLS} at most"
        raise InvalidModel([("cells" if dt is None else "dt", message)])
    courant = step * counts / T
    if courant.max() > STABLE:
        worst = int(np.argmax(courant))
        message = (
            f"would be unstable: waves would cross {courant.max():.6g} cells of "
            f"{plan.paths[worst + 1]} in a step; at most {T[worst] / counts[worst]:.6g} s"
        )
        raise InvalidModel([("dt", f"{message}, got {dt!r}")])
    return counts.tolist(), step


def _level(
    mesh: Mesh, step: float, keep: Keeper, until: float | None, max_events: int,
    progress: Progress | None, announce: Callable[[str], None] | None,
) -> GridRun:
    """One run on a given mesh."""
    plan = mesh.plan
    work = clockwork(mesh, step)
    longest = max(1, math.ceil(work.longest / PARTS))
    cap = max(1, max_events // len(plan.laws))
    proof, reason = -1, "until"
    room = 8 * longest if until is None else max(1, math.ceil(until / step * (1 - 1e-12)))
    machine = Machine(mesh, step, keep, room)
    size = f"{sum(mesh.counts)} cells"
    per_step = cost(mesh, plain=not kernels.enabled())
    if announce and per_step * room > LONG:
        announce(
            f"the run with {size} takes about {_spell(per_step * room)}, {room} steps; fewer cells "
            "or a larger rtol take less"
        )
    began = time.monotonic()

    def tell(taken: int) -> None:
        if progress and time.monotonic() - began > 1.0:
            progress(taken, max(room, taken))

    last = cap if until is None else room if until > 0 else 0
    machine.advance(0)
    while proof < 0:
        wait = settled(machine)
        if wait == 0:
            proof = machine.taken
        elif machine.taken < last:
            pause = min(wait, 8.0 * longest) if wait < math.inf else longest
            more = max(longest, math.ceil(pause), machine.taken // 8)
            machine.advance(min(last, machine.taken + more), tell)
        else:
            break
    if until is not None:
        machine.advance(last, tell)
    else:
        reason = "final" if proof >= 0 else "max_events"
        if proof >= 0:
            machine.advance(machine.taken + 2 * longest, tell)
    kept = int(machine.clock[1])
    when = machine.states.when
    states = States._make([
        when[:kept], *(x.reshape(len(when), -1)[:kept] for x in machine.states[1:4]),
        machine.states.lost[:kept],
    ])
    return GridRun(
        clockwork=work, mesh=mesh, step=step, steps=machine.taken, grid=machine.grid,
        links=machine.links, tally=machine.tally, signals=machine.signals, states=states,
        settled=proof, stopped_by=reason,
    )


def cost(mesh: Mesh, plain: bool) -> float:
    """About how long a step takes, s, in plain Python or compiled."""
    return sum(
        (b - a + 1) * CELL_TIMES["implicit" if hidden else "explicit"][plain]
        for a, b, hidden in zip(mesh.starts, mesh.stops, mesh.implicit, strict=True)
    )


def _spell(seconds: float) -> str:
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def clockwork(mesh: Mesh, step: float) -> Clockwork:
    """Put a row on the clock of a mesh; impedances are means, so that Z T is the mass."""
    plan, tick = mesh.plan, step / PARTS
    ticks = [max(1, round(float(s.transit_time) / tick)) for s in plan.segments]
    masses = [
        float(mesh.cell_mass[a + 1 : b + 1].sum())
        for a, b in zip(mesh.first[1:], mesh.last[1:], strict=True)
    ]
    return Clockwork(
        system=plan.system, spans=plan.spans,
        wave_speed=[0.0, *(float(s.wave_speed) for s in plan.segments), 0.0],
        impedance=[0.0, *(m / (T * tick) for m, T in zip(masses, ticks, strict=True)), 0.0],
        length=[0.0, *(float(s.length) for s in plan.segments), 0.0],
        ticks=[0, *ticks, 0], tick=tick, frame=plan.frame, gravity=plan.gravity, grain=PARTS,
        transit_error=0.0, worst="",
    )


# Proof of finality ------------------------------------------------------------------------------


def settled(machine: Machine) -> float:
    """Steps until it may be proved that nothing meets again: 0 if it is, inf if not as it is.

    The end of a piece deviates from the motion of its centre of mass, or of the wall that holds it,
    by d = sum(strain g dx), g the mass fraction beyond, hence by at most
    sqrt(2 E sum(g^2 dx/(E A))), E the energy of vibration, which the scheme never lets grow. A far
    endless bar of impedance Z gives way by the momentum it has taken, over Z.
    """
    if driven(machine.plan.system):
        return math.inf
    wait = 0.0
    for i, (left, right) in enumerate(machine.mesh.touching.values()):
        gap = float(machine.links.gap[i])
        if gap < 0:
            return math.inf
        (V, d, bound), (W, e, other) = _sway(machine, left, 1), _sway(machine, right, 0)
        opening, apart, reach = W - V, gap - e + d, bound + other
        if reach <= machine.tol and opening >= -machine.tol:
            continue
        if apart > reach and opening >= -machine.tol:
            continue
        if opening <= machine.tol:
            return math.inf
        wait = max(wait, (reach - apart) / opening + 1)
    return wait


def _sway(machine: Machine, node: int, right_end: int) -> tuple[float, float, float]:
    """Mean velocity of a piece, how far its end is from the mean motion, and can ever get."""
    mesh, grid, h = machine.mesh, machine.grid, machine.step
    p = mesh.piece_of(node)
    a, b = mesh.starts[p], mesh.stops[p]
    v, cells = grid.velocity[a : b + 1], slice(a + 1, b + 1)
    m = mesh.mass[a : b + 1] / h
    far = a if right_end else b
    endless = [s for s in (0, 1) if mesh.ends[s] == far and machine.ends.kind[s] == ENDLESS]
    held = bool(mesh.held[far])
    if held or mesh.held[node]:
        mean = float(grid.velocity[far if held else node])
    elif endless:
        mean = float(machine.ends.rest[endless[0]])
    else:
        mean = float(m @ v / m.sum())
    if a == b:
        return mean, 0.0, 0.0
    k, change = grid.stiffness[cells], np.diff(v)
    now = grid.force[cells] + k * change / 2
    energy = float(m @ (v - mean) ** 2 + (mesh.lateral[cells] / h) @ change**2) / 2
    energy += float(np.sum((now**2 - (k * change / 2) ** 2) / k)) / 2
    energy = max(energy, 0.0)
    g = np.ones(b - a)
    if not held and not endless:
        beyond = np.cumsum(m)[:-1] / m.sum()
        g = beyond if right_end else 1 - beyond
    d = float(now / k @ g) * (1 if right_end else -1)
    slack = float(np.sum(g * g / k))
    if endless:
        Z = float(machine.ends.impedance[endless[0]])
        d -= float(m @ (v - mean)) / Z
        slack = 2 * (slack + float(m.sum()) / Z**2)
    inertia = float(m[-1] if right_end else m[0])
    return mean, d, math.sqrt(2 * energy * slack) + math.sqrt(energy / (2 * inertia))


def _whole(values: list[int]) -> Array:
    return np.array(values, dtype=np.int64)


def _lists(columns: Any) -> Any:
    return type(columns)(*(column.tolist() for column in columns))


def _copy(lists: Any, columns: Any) -> None:
    for column, values in zip(columns, lists, strict=True):
        column[:] = values
