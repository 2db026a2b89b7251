"""The grid of the method "finite-difference" on arrays: laid out, run, and what is kept of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ...model import Rod
from ...model.frozen import InvalidModel
from ...model.profiles import averages
from .. import kernels
from ..abilities import driven
from ..finality_kernel import NEVER
from ..laws import JOINT, RIGID
from ..memory import ask
from ..row import Array, Row, squeezed, whole
from .contact_kernel import Chain, Tally
from .grid_kernel import (
    DONE,
    ENDLESS,
    MOVED,
    NOTHING,
    PUSHED,
    STEP,
    Bonds,
    Ends,
    Grid,
    Groups,
    Implicit,
    Links,
    Signals,
    States,
    factor,
    finality_time,
    run,
    substitute,
)
from .mesh import Mesh
from .radial_kernel import Radial

LEAST = 2.0**-800  # stiffness, where time is counted in steps
TOLERANCE = 2.0**-40  # of the velocities, below which contacts graze: round-off of many steps
GAP_RESOLUTION = 1.0  # of what bodies cover in a step: dispersed waves open smaller gaps
STATES_BYTES = 64 << 20  # of kept states, where their number is not given
CELL_TIMES = {"explicit": (7e-10, 8e-7), "implicit": (6e-9, 2.5e-6), "radial": (7e-10, 8e-7)}
"""Time of a cell and a step, s, compiled and in plain Python; of radial motion beside the other."""
STEP_TIMES = 3e-7, 1e-5
"""Time of a step beside that of its cells, with what results take."""

LITTLE_RETARDATION = 1 / 64  # eta/E in steps, where ends shut with half of the delay
MOST_RETARDATION = 1 / 64  # eta/E over the longest transit, up to which ends shut without delay
PROOF_TIME = 2e-6  # s, about what plain Python takes for a node
ROUND = 0.25  # s between two looks at the clock


def check_memory(mesh: Mesh, step: float, steps: float, states: float) -> None:
    """Raise TooLong where a run, what is kept of it, and its results take too much memory."""
    row = mesh.row
    contacts, masses = len(row.contact_link), sum(m >= 0 for m in row.mass_of)
    ends = sum(kind != "none" for kind, _ in row.outside)
    kept = 3 * len(mesh.touching) + len(mesh.interfaces) + 6 + len(row.masses)
    # what the kernel keeps; force, gap, path, rate and power with integrals; edges and times
    record = steps * (2 * kept + 10 * contacts + 5 * masses + 8 * ends + 10)
    # two of each, while they are made larger or fields are made of them
    fields = 2 * states * (2 * len(mesh.mass) * (1 + mesh.swells) + len(mesh.starts) + 3)
    if not kernels.enabled():  # lists take four times what arrays take, and stand beside them
        record, fields = record + 4 * steps * kept, 3 * fields
    if record > fields:
        field, remedy = "until", "stop earlier, or take fewer cells"
    else:
        field, remedy = "snapshots", "keep fewer, or take fewer cells"
    what = f"a run of {steps:.4g} steps of {step:.3g} s with {states:.4g} states"
    ask(record + fields, field, what, remedy)


class Machine:
    """The kernel's state on arrays, and the room that it needs."""

    def __init__(self, mesh: Mesh, step: float, keep: Keeper, room: int) -> None:
        self.mesh, self.step, self.room = mesh, step, 0
        row, h = mesh.row, step
        self.row = row
        implicit = mesh.implicit
        mass = mesh.mass / h
        for side, (kind, _) in enumerate(row.outside):
            if kind == "absorbing":
                mass[mesh.ends[side]] += self._impedance(side) / 2
        self.implicit = self._implicit(mass, implicit)
        mobility = np.where(mesh.held == 1, 0.0, 1 / np.where(mass > 0, mass, 1.0))
        for a, b, hidden in zip(mesh.starts, mesh.stops, implicit, strict=True):
            if hidden:
                mobility[a : b + 1] = 0.0
        self.grid = self._grid(mobility, implicit)
        self.radial = self._radial()
        self.links, self.chain = self._links(mobility, implicit)
        self.bonds = self._bonds()
        self.ends = Ends(
            whole([self._kind(side) for side in (0, 1)]), whole(mesh.ends),
            np.array([self._impedance(side) for side in (0, 1)]), np.zeros(2), np.zeros(2),
        )
        count = len(mesh.touching)
        self.tally = Tally(np.zeros(count), np.zeros(count), np.zeros(count),
                           np.zeros(count, np.int64))
        self.tol, self.gap_resolution = TOLERANCE * row.scale, GAP_RESOLUTION * row.scale
        self._set_initial_state()
        self.keep = keep
        self.signals = self._allocate(room)
        self.states = keep.make(self, room)
        first, last = (whole(list(ends)) for ends in zip(*mesh.groups, strict=True))
        left, right = (np.searchsorted(first, nodes, "right") - 1
                       for nodes in (self.links.left, self.links.right))
        joint = np.full(len(mesh.mass) + 1, -1)
        for i in np.flatnonzero(self.links.law == JOINT):
            joint[self.links.right[i]] = i
        self.groups = Groups(first, last, mesh.mass / h, mesh.held, mesh.lateral / h,
                             mesh.cells.relaxed * h, left, right, joint)
        self.clock = whole([0, 0, 0])
        self.taken = 0

    # Laying out ---------------------------------------------------------------------------------

    def _kind(self, side: int) -> int:
        return {"none": NOTHING, "force": PUSHED, "velocity": MOVED, "absorbing": ENDLESS}[
            self.row.outside[side][0]
        ]

    def _impedance(self, side: int) -> float:
        """Impedance sqrt(E A rho A) of the rod's last cell at an end."""
        cell = self.mesh.ends[side] + (1 if side == 0 else 0)
        return math.sqrt(float(self.mesh.cells.relaxed[cell] * self.mesh.cell_mass[cell]))

    def _grid(self, mobility: Array, implicit: list[bool]) -> Grid:
        mesh, h = self.mesh, self.step
        stiffness = mesh.stiffness * h
        first, last, kick, stiff = [], [], [], []
        for s in range(1, len(mesh.first)):
            a, b = mesh.first[s], mesh.last[s]
            if implicit[mesh.piece_of(a)]:
                continue
            k, e = stiffness[a + 1 : b + 1], mobility[a + 1 : b]
            alike = np.all(k == k[0]) and np.all(e == e[:1])
            first.append(a)
            last.append(b)
            stiff.append(float(k[0]) if alike else -1.0)
            kick.append(float(e[0]) if alike and len(e) else -1.0)
        n = len(mesh.mass)
        return Grid(
            np.zeros(n), np.zeros(n + 1), mobility, stiffness, whole(first), whole(last),
            np.array(kick), np.array(stiff), whole(sorted({*first, *last})),
            whole(mesh.starts), np.zeros(len(mesh.starts)),
        )

    def _radial(self) -> Radial:
        cells, h = self.mesh.cells, self.step
        n = len(cells.swelling)
        swells = np.append(cells.swelling > 0, False)
        turns = np.flatnonzero(np.diff(swells.astype(int)))
        stiffness = np.where(cells.stiffness > 0, cells.stiffness, 1.0)
        ease = np.divide(h, cells.swelling, out=np.zeros(n), where=swells[:-1])
        return Radial(
            turns[::2] + 1, turns[1::2], np.zeros(n), np.zeros(n), ease, cells.coupling * h,
            (cells.radial - cells.coupling**2 / stiffness) * h, cells.coupling / stiffness,
            self.mesh.shear * h,
        )

    def _implicit(self, mass: Array, implicit: list[bool]) -> Implicit:
        mesh, h = self.mesh, self.step
        n = len(mass)
        bound = mesh.lateral / h + mesh.viscous / 2
        spans = [(a, b) for a, b, hidden in zip(mesh.starts, mesh.stops, implicit, strict=True)
                 if hidden]
        found = Implicit._make([
            whole([a for a, _ in spans]), whole([(a + b) // 2 for a, b in spans]),
            whole([b for _, b in spans]), *np.zeros((2, len(spans))), mesh.viscous, bound,
            *np.zeros((7, n)), np.zeros(n + 1),
        ])
        diagonal = (mass + bound[:-1] + bound[1:]).tolist()
        lists = kernels.as_lists(found)
        for p, (a, b) in enumerate(spans):
            factor(lists, diagonal, mesh.held.tolist(), p)
            for node, answer in ((a, lists.by_first), (b, lists.by_last)):
                if not mesh.held[node]:
                    answer[node] = 1.0
                substitute(lists, answer, p)
        kernels.copy_back(lists, found)
        return found

    def _links(self, mobility: Array, implicit: list[bool]) -> tuple[Links, Chain]:
        mesh, row, h = self.mesh, self.row, self.step
        hidden = [p for p, is_hidden in enumerate(implicit) if is_hidden]
        chosen, nodes = list(mesh.touching), list(mesh.touching.values())
        count = len(chosen)
        sides: list[list[int]] = [[], []]
        own, shared = np.zeros((2, count))
        for q, pair in enumerate(nodes):
            for side, node in enumerate(pair):
                piece = mesh.piece_of(node)
                place = hidden.index(piece) if piece in hidden else -1
                sides[side].append(place)
                answer = (self.implicit.by_last, self.implicit.by_first)[side]
                own[q] += (mobility if place < 0 else answer)[node] / 2
            if q and mesh.piece_of(pair[0]) == mesh.piece_of(nodes[q - 1][1]):
                if sides[0][q] >= 0:
                    shared[q] = self.implicit.by_first[pair[0]] / 2
                elif pair[0] == nodes[q - 1][1]:
                    shared[q] = mobility[pair[0]] / 2
        gap = np.array([row.gap[i] for i in chosen]) / h
        links = Links(
            whole([row.laws[i] for i in chosen]),
            stiffness_in_steps(row, h)[chosen], np.array(row.exponent)[chosen],
            np.array(row.damping)[chosen], np.array(row.strength)[chosen], gap,
            np.zeros(count), np.zeros(count),
            np.ones(count, np.int64), (gap == 0).astype(np.int64),
            whole([pair[0] for pair in nodes]), whole([pair[1] for pair in nodes]),
            whole(sides[0]), whole(sides[1]), own, shared, np.zeros(count),
            whole([]), np.zeros(0), whole([]), np.append(np.flatnonzero(shared == 0), count),
        )
        return links, Chain(*np.zeros((len(Chain._fields), count)))

    def _bonds(self) -> Bonds:
        places = {link: q for q, link in enumerate(self.mesh.touching)}
        found = list(self.mesh.interfaces.values())
        return Bonds(
            whole([x.node for x in found]), np.array([x.mass / self.step for x in found]),
            whole([x.side for x in found]), whole([x.cell for x in found]),
            whole([places.get(x.link, -1) for x in found]), whole([x.end for x in found]),
            np.zeros(len(found)), np.zeros(len(found)),
        )

    def _set_initial_state(self) -> None:
        mesh, row, grid = self.mesh, self.row, self.grid
        v, strain = grid.velocity, np.zeros(len(mesh.mass) + 1)
        for body, (start, stop) in zip(row.system.bodies, row.spans, strict=True):
            if not isinstance(body, Rod):
                continue
            left = 0.0
            for s in range(start, stop + 1):
                a, b, L = mesh.first[s], mesh.last[s], float(row.segments[s - 1].length)
                N = mesh.counts[s - 1]
                halves = averages(body.velocity, left + L * np.arange(2 * N + 1) / (2 * N),
                                  float(body.length))
                m = np.repeat(mesh.cell_mass[a + 1 : b + 1] / 2, 2)
                v[a : b + 1] += np.bincount((np.arange(2 * N) + 1) // 2, m * halves)
                edges = left + L * np.arange(N + 1) / N
                strain[a + 1 : b + 1] = averages(body.strain, edges, float(body.length)) * L / N
                left += L
        for place, node in enumerate(mesh.node_of_mass):
            v[node] += row.masses[place] * row.mass_velocity[place]
        weight = np.where(mesh.mass > 0, mesh.mass, 1.0)
        v[:] = np.where(mesh.mass > 0, v / weight - row.frame, 0.0)
        jump = np.zeros(len(v))
        for side, (kind, value) in enumerate(row.outside):
            if kind == "velocity":
                node = mesh.ends[side]
                jump[node] = self._given(value, np.zeros(1))[0] - v[node]
        v += self._dragged(jump)
        slow = -mesh.cells.coupling / np.where(mesh.cells.radial > 0, mesh.cells.radial, 1.0)
        radial = slow * strain
        self.radial.strain[:] = radial / self.step
        tension = mesh.stiffness * strain + mesh.cells.coupling * radial
        kick = self._first_kick(tension)
        grid.force[:] = tension + grid.stiffness * np.diff(kick - v, prepend=0.0, append=0.0) / 2
        grid.place[:] = kick[mesh.starts] / 2
        for side, sign in ((0, 1), (1, -1)):
            cell = mesh.ends[side] + (1 if side == 0 else 0)
            if row.outside[side][0] == "absorbing":  # v - F/Z, seen from the row
                # carried on to the end itself from means over half a cell and over a cell
                inside, node = cell + sign, mesh.ends[side]
                pull = tension[cell] - (tension[inside] - tension[cell]) / 2
                speed = v[node] - (v[node + sign] - v[node]) / 3
                self.ends.rest[side] = float(speed - sign * pull / self._impedance(side))
        links = self.links
        closing = v[links.left] - v[links.right]
        links.shut[links.gap <= closing / 2] = 1  # closes before the first kick
        self._shut_at_once(closing, kick)

    def _shut_at_once(self, closing: Array, kick: Array) -> None:
        """Put ends apart that shut before the first kick, the lighter one more.

        By half the velocity by which they then close, `kick` with it, where they touch at t = 0; by
        nothing where they meet at the kick, nor where viscosity rules: strain would linger there.
        Without viscosity all follows half a step late, but a sharp front that comes back to a
        contact at a kick, as it left it, opens it as it shut: ends get back what they lost.
        """
        mesh, links = self.mesh, self.links
        parting = kick[links.right] - kick[links.left]
        overlap = (closing - parting) / 2 - links.gap
        ease = np.where(mesh.held == 1, 0.0, 1 / np.where(mesh.mass > 0, mesh.mass, 1.0))
        left, right = ease[links.left], ease[links.right]
        late = (links.law == RIGID) & (links.shut == 1) & (left + right > 0)
        late &= (overlap > self.tol) & (closing > 2 * parting)
        stiffness = np.where(mesh.stiffness > 0, mesh.stiffness, 1.0)
        retardation = (mesh.viscous / stiffness)[[links.left, links.right + 1]].max(axis=0)
        late &= retardation <= MOST_RETARDATION * max(mesh.counts) * self.step
        overlap *= retardation / (retardation + LITTLE_RETARDATION * self.step)
        strained: list[tuple[int, float, int]] = []
        for i in np.flatnonzero(late).tolist():
            share = overlap[i] / (left[i] + right[i])
            for n, shift in ((links.left[i], -left[i] * share), (links.right[i], right[i] * share)):
                self.grid.place[np.array(mesh.starts) == n] += shift
                strained += [(cell, sign * shift, i) for cell, sign in ((n, 1), (n + 1, -1))
                             if mesh.stiffness[cell] > 0]
        cells, stretches, places = zip(*strained, strict=True) if strained else ((), (), ())
        self.links = links._replace(
            strained=whole(list(cells)), stretch=np.array(stretches, float),
            straining=whole(list(places)))

    def _dragged(self, jump: Array) -> Array:
        """Changes of velocity where held ends jump: lateral inertia takes neighbours along."""
        mesh, bound = self.mesh, self.mesh.lateral / self.step
        if not bound.any():
            return jump
        lists = kernels.as_lists(self.implicit._replace(bound=bound))
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
        mesh, links, row = self.mesh, self.links, self.row
        force = np.diff(tension)
        for side, (kind, value) in enumerate(row.outside):
            if kind == "force":
                force[mesh.ends[side]] += (1, -1)[side] * self._pushes(value, 1)[0]
            elif kind == "absorbing":
                wave = row.wave_of_strain(side) * self._pushes(value, 1)[0]
                force[mesh.ends[side]] = self._impedance(side) * wave
        for law, stiffness, gap, left, right in zip(
            links.law, links.stiffness, links.gap, links.left, links.right, strict=True
        ):
            if law == RIGID and gap == 0 and force[left] > force[right]:
                force[left] = force[right] = 0.0
            elif law == JOINT:
                force[left] += stiffness * gap
                force[right] -= stiffness * gap
        found: Array = self.grid.mobility * force / 2
        if len(self.implicit.first):
            lists = kernels.as_lists(self.implicit)
            x = np.where(mesh.held == 1, 0.0, force / 2).tolist()
            for p, (a, b) in enumerate(zip(lists.first, lists.last, strict=True)):
                substitute(lists, x, p)
                found[a : b + 1] = x[a : b + 1]
        return found

    def _pushes(self, value: Any, steps: int) -> Array:
        """What drives an end at each kick: its mean over two steps, which waves can follow."""
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
        result: Array = found - self.row.frame - self.row.gravity * t
        return result

    # Room ---------------------------------------------------------------------------------------

    def _allocate(self, room: int) -> Signals:
        links, bonds = len(self.mesh.touching), len(self.mesh.interfaces)
        masses = len(self.mesh.node_of_mass)
        check_memory(self.mesh, self.step, room, self.keep.count(self.mesh, room))
        given = np.zeros(2 * room)
        for side, (kind, value) in enumerate(self.row.outside):
            span = slice(side * room, (side + 1) * room)
            edges = self.step * np.arange(room + 1)
            if kind == "velocity":
                given[span] = self._given(value, edges[1:])
            elif kind == "force":
                given[span] = self._pushes(value, room)
            elif kind == "absorbing":
                given[span] = self.row.wave_of_strain(side) * self._pushes(value, room)
        self.room = room
        return Signals._make([
            *np.zeros((3, links * room)), whole([i * room for i in range(links)]),
            np.zeros(bonds * room), given, *np.zeros((2, 2 * room)), whole([room]),
            whole(self.mesh.node_of_mass), np.zeros(masses * room),
        ])

    def finality_time(self) -> int:
        """Steps until it may be proved that the collision is over; NEVER if not as it is."""
        if driven(self.row.system):
            return NEVER
        nodes = 2 * len(self.mesh.mass)
        parts: Any = self.groups, self.grid, self.radial, self.links, self.ends
        if kernels.worth_compiling(nodes * PROOF_TIME, finality_time):
            return int(kernels.compiled(finality_time)(*parts, self.tol))
        groups, grid, radial, links, ends = map(kernels.as_lists, parts)
        return finality_time(groups, grid, radial, links, ends, self.tol)

    def _grow(self, room: int) -> None:
        old, was = self.signals, self.room
        self.signals = self._allocate(room)
        for name in ("force", "gap", "closing", "bond", "push", "speed", "mass_speed"):
            source, target = getattr(old, name), getattr(self.signals, name)
            if len(source):
                target.reshape(-1, room)[:, :was] = source.reshape(-1, was)

    # Running ------------------------------------------------------------------------------------

    def advance(
        self, end: int, tell: Callable[[int], None] | None = None, ahead: float = 0.0
    ) -> None:
        """Run to step `end`; `tell` hears of the steps taken, several times a second.

        So many seconds in plain Python, `ahead`, are certain to follow.
        """
        if end > self.room:
            self._grow(max(end, 2 * self.room))
        self.states = self.keep.room_for(self, end)
        parts: tuple[Any, ...] = (
            self.grid, self.implicit, self.radial, self.links, self.chain, self.bonds, self.ends,
            self.tally, self.signals, self.states,
        )
        numbers = sum(len(column) for part in (self.signals, self.states) for column in part)
        fast = kernels.worth_compiling(
            (end - self.taken) * cost(self.mesh, plain=True) + numbers * kernels.LIST_TIME, run,
            ahead=ahead,
        )
        lists = parts if fast else tuple(kernels.as_lists(x) for x in parts)
        go: Callable[..., int] = kernels.compiled(run) if fast else run
        clock: Any = self.clock if fast else self.clock.tolist()
        chunk = max(1, int(ROUND / cost(self.mesh, plain=not fast)))
        while True:
            target = min(end, self.taken + chunk)
            flag = go(*lists, clock, target, self.tol, self.gap_resolution)
            self.taken = int(clock[STEP])
            if flag != DONE or self.taken >= end:
                break
            if tell:
                tell(self.taken)
        if not fast:
            for part, found in zip(parts, lists, strict=True):
                kernels.copy_back(found, part)
            self.clock[:] = clock
        if flag != DONE:
            raise squeezed(self.taken * self.step)


class Keeper:
    """Which states are kept: at chosen times, or so many at equal distances, all if they fit."""

    def __init__(self, snapshots: int | Array | None) -> None:
        self.snapshots, self.stride = snapshots, 1
        self.most = snapshots if isinstance(snapshots, int) else 0

    def count(self, mesh: Mesh, steps: float) -> float:
        """How many states of a run are kept at most."""
        if isinstance(self.snapshots, np.ndarray):
            return 2.0 * len(self.snapshots) + 2
        self.most = self.most or max(
            64, STATES_BYTES // (16 * len(mesh.mass) * (1 + mesh.swells)))
        return min(steps, max(self.most, 3)) + 2

    def make(self, machine: Machine, room: int) -> States:
        """Empty states."""
        when = self._when(machine, room)
        return self._space(machine.mesh, when, len(when))

    def _space(self, mesh: Mesh, when: list[int], count: int) -> States:
        """Room for so many states, of which the first are kept at `when`."""
        nodes, pieces = len(mesh.mass), len(mesh.starts)
        radial = count * (nodes + 1) * mesh.swells
        return States(whole(when), np.zeros(count * nodes), np.zeros(count * (nodes + 1)),
                      np.zeros(count * pieces), np.zeros(count), *np.zeros((2, radial)))

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
        old, have = machine.states, int(machine.clock[1])
        when, room = self._when(machine, end), len(old.lost)
        if when[-1] != end:
            when.append(end)
        kept = np.flatnonzero(np.isin(old.when[:have], when))
        new = old._replace(when=whole(when))
        if len(when) > room:
            enough = min(2 * room, int(self.count(machine.mesh, machine.room)))
            new = self._space(machine.mesh, when, max(len(when), enough))
        if len(when) > room or len(kept) < have:
            for x, y in zip(old[1:], new[1:], strict=True):
                y.reshape(len(new.lost), -1)[: len(kept)] = x.reshape(room, -1)[kept]
        machine.clock[1] = len(kept)
        return new


def cost(mesh: Mesh, plain: bool) -> float:
    """About how long a step takes, s, in plain Python or compiled."""
    return STEP_TIMES[plain] + sum(
        (b - a + 1) * CELL_TIMES["implicit" if hidden else "explicit"][plain]
        for a, b, hidden in zip(mesh.starts, mesh.stops, mesh.implicit, strict=True)
    ) + np.count_nonzero(mesh.cells.swelling) * CELL_TIMES["radial"][plain]


def stiffness_in_steps(row: Row, step: float) -> Array:
    """Stiffness of each link where time is counted in steps, s, and lengths as velocities."""
    scaled = [k * step**p for k, p in zip(row.stiffness, row.exponent, strict=True)]
    for k, p, small in zip(row.stiffness, row.exponent, scaled, strict=True):
        if k > 0 and small < LEAST:
            message = f"a force of {k!r} times the indentation to the {p:g} vanishes in steps"
            raise InvalidModel([("contacts", f"{message} of {step:.3g} s; use a lower power")])
    return np.array(scaled)
