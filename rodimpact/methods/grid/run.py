"""A run on a grid: the kernels in plain Python or compiled, and what passed in each step."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from .. import abilities, compiling, kernels
from ..clock import Clock, clock_of
from ..laws import Law
from ..row import Array, squeezed
from . import grid_kernel, proof_kernel, scheme, start
from .keeping import Keeper, check_memory, cost
from .measures import largest_force
from .mesh import STEP_TICKS, Mesh
from .records import OUTER, PER_STATE, PER_STEP, SIGNAL, STATE, Track

RINGING = 8  # steps in which waves beside a jump swing about their mean
WHOLE = ("velocity", "force", "place")  # of states, entered whole: not worth clearing before
PROOF_TIME = 2e-6  # s, about what plain Python takes for a node
ROUND = 0.25  # s between two looks at the clock


class GridRun:
    """A run on a mesh with a step, s, and with room for so many steps at first.

    Attributes
    ----------
    row : Row
    clock : Clock
        Its tick is the step's `STEP_TICKS`-th part.
    grid : Grid
    track : Track
        Rows for each step, and for each state; more than there are.
    proved : int
        Step at whose end the collision was proved final, -1 as long as it is not.
    stopped_by : str
        ``"final"``, ``"until"`` or ``"max_events"``.
    estimates : dict of str to float
        Error of each measure of the outcome, relative to its largest value, as `refined` finds it;
        empty where the step was given.
    rtol : float
        What they were to come to.
    peak_change : float
        Relative change of the peak force from a mesh at most half as fine; nan without one.
    """

    proved = -1
    stopped_by = "until"
    rtol = 0.0
    peak_change = math.nan

    def __init__(self, mesh: Mesh, step: float, keep: Keeper, room: int) -> None:
        self.mesh, self.step, self.row, self.keep = mesh, step, mesh.row, keep
        self.clock, self.estimates = clock_on(mesh, step), dict[str, float]()
        self.grid = scheme.grid_of(mesh, step)
        self._overlaps = start.begin(mesh, step, self.grid)
        self.proof = scheme.cells_of(mesh, step, self.grid)
        self.kept = self.room = 0
        n, swells = len(mesh.mass), (len(mesh.mass) + 1) * mesh.swells
        self._sizes = {
            "signal": (len(self.grid.link), SIGNAL), "outer": (2, OUTER),
            "bonded": (len(self.grid.bond), float), "speed": (len(self.grid.mass), float),
            "state": (1, STATE), "velocity": (n, float), "force": (n + 1, float),
            "place": (len(mesh.starts), float), "radial": (swells, float),
            "radial_rate": (swells, float),
        }
        self.track = Track(*(np.zeros((0, n), kind) for n, kind in self._sizes.values()))
        self._make_room(room)
        self._grow(PER_STATE, len(keep.when(step, room)))

    @property
    def steps(self) -> int:
        """Steps taken, between which signals are averages."""
        return int(self.grid.run["step"][0])

    @property
    def states(self) -> dict[str, Array]:
        """What was kept, a row a state: of nodes, of cells, of pieces, or one number."""
        when, lost = (self.track.state[name][: self.kept, 0] for name in ("when", "lost"))
        others = {name: getattr(self.track, name)[: self.kept] for name in PER_STATE[1:]}
        return {"when": when, "lost": lost, **others}

    def _grow(self, names: tuple[str, ...], room: int) -> None:
        """Make rows, keeping those that are there."""
        grown = {}
        for name in names:
            size, kind = self._sizes[name]
            old = getattr(self.track, name)
            new: Any = np.empty if name in WHOLE else np.zeros
            grown[name] = new((room, size), kind)
            grown[name][: len(old)] = old
        self.track = self.track._replace(**grown)

    def _make_room(self, room: int) -> None:
        """Make room for steps, with what is given in each."""
        check_memory(self.mesh, self.step, room, self.keep.count(self.mesh, room))
        self.room = room
        self._grow(PER_STEP, room)
        for side in (0, 1):
            self.track.outer["given"][:, side] = scheme.driven(self.mesh, self.step, side, room)

    def _choose_states(self, end: int) -> int:
        """Thin the states where there is no room, and enter when others are kept; their number."""
        when = self.keep.when(self.step, end)
        if when[-1] != end:
            when.append(end)
        left = np.flatnonzero(np.isin(self.track.state["when"][: self.kept, 0], when))
        if len(left) < self.kept:
            for name in PER_STATE:
                x = getattr(self.track, name)
                x[: len(left)] = x[left]
            self.kept = len(left)
        room = len(self.track.state)
        if len(when) > room:
            enough = min(2 * room, int(self.keep.count(self.mesh, self.room)))
            self._grow(PER_STATE, max(len(when), enough))
        self.track.state["when"][: len(when), 0] = when
        return len(when)

    def finality_time(self) -> float:
        """Steps until it may be proved that the collision is over; inf if not as it is."""
        if abilities.driven(self.row.system):
            return math.inf
        parts: tuple[Any, ...] = self.grid, *self.proof
        nodes = 2 * len(self.mesh.mass)
        if kernels.worth_compiling(nodes * PROOF_TIME, proof_kernel.finality_time):
            return float(kernels.compiled(proof_kernel.finality_time)(*parts))
        grid, *proof = as_lists(self.grid), *map(compiling.as_objects, self.proof)
        return proof_kernel.finality_time(grid, *proof)

    def advance(
        self, end: int, tell: Callable[[int], None] | None = None, ahead: float = 0.0
    ) -> None:
        """Run to step `end`; `tell` hears of the steps taken, several times a second.

        So many seconds in plain Python, `ahead`, are certain to follow.
        """
        if not self.steps and end and self._overlaps:
            self.advance(0)
            start.part(self.grid, self._overlaps)
            self._overlaps = []
        if end > self.room:
            self._make_room(max(end, 2 * self.room))
        states, first = self._choose_states(end), self.steps
        window = Track(
            *(getattr(self.track, name)[first:end].reshape(-1) for name in PER_STEP),
            *(getattr(self.track, name)[self.kept : states].reshape(-1) for name in PER_STATE),
        )
        self.grid.run["first"], self.grid.run["kept"] = first, 0
        numbers = sum(x.nbytes for x in (*self.grid, *window)) // 8
        seconds = (end - first) * cost(self.mesh, plain=True) + numbers * kernels.LIST_TIME
        fast = kernels.worth_compiling(seconds, grid_kernel.follow, ahead=ahead)
        go: Any = kernels.compiled(grid_kernel.follow) if fast else grid_kernel.follow
        grid, track = (self.grid, window) if fast else (as_lists(self.grid), as_lists(window))
        chunk = max(1, int(ROUND / cost(self.mesh, plain=not fast)))
        for taken in (*range(first + chunk, end, chunk), end):
            done = go(grid, track, taken)
            if not done:
                break
            if tell and taken < end:
                tell(taken)
        if not fast:
            _take_over(grid, self.grid)
            _take_over(track, window)
        self.kept += int(self.grid.run["kept"][0])
        if not done:
            raise squeezed(self.steps * self.step)

    # What passed ----------------------------------------------------------------------------------

    @property
    def resolved(self) -> float:
        """Gap that counts as an opening, m."""
        return scheme.GAP_RESOLUTION * float(self.row.scale) * self.step

    @property
    def edges(self) -> Array:
        """Ticks [steps + 1] from 0 on, between which signals are averages."""
        return STEP_TICKS * np.arange(self.steps + 1)

    @property
    def times(self) -> Array:
        """`edges` in s."""
        return np.asarray(self.edges * self.clock.tick)

    def contact(self, contact: int) -> tuple[Array, Array]:
        """Mean force in each step, N, and gap at its end, m; not of a bonded contact."""
        place = self.place(contact)
        return self._of("signal", place, "force"), self._of("signal", place, "gap") * self.step

    def _of(self, name: str, place: int, field: str = "") -> Array:
        """What was entered of one thing in each step."""
        entered = getattr(self.track, name)[: self.steps, place]
        return np.ascontiguousarray(entered[field] if field else entered)

    @property
    def largest_strain(self) -> float:
        """Largest strain of the states that were kept."""
        inside = self.mesh.stiffness > 0
        yielding = self.mesh.stiffness[inside] * self.mesh.width[inside]
        force = self.states["force"]
        if self.mesh.swells:
            with np.errstate(under="ignore"):  # ahead of the waves strains are next to nothing
                force = force - self.mesh.cells.coupling * self.states["radial"] * self.step
        largest = np.maximum(force.max(axis=0), -force.min(axis=0))[inside]
        return float((largest / yielding).max())

    @property
    def overshoot(self) -> float:
        """How much less the peak force of rigid contacts is over a few steps; relative.

        Beside a jump waves on a grid overshoot by a share that no finer mesh makes less; averages
        over a few steps do not.
        """
        peaks, less, times = [0.0], [0.0], self.times
        for contact, link in self.row.opening.items():
            if self.row.laws[link] == Law.RIGID:
                force = self.contact(contact)[0]
                passed = np.concatenate((np.zeros(RINGING), np.cumsum(force)))
                means = (passed[RINGING:] - passed[:-RINGING]) / RINGING
                peaks.append(largest_force(times, force))
                less.append(peaks[-1] - float(means.max(initial=0.0)))
        return max(less) / (max(peaks) or 1.0)

    @property
    def peak_error(self) -> float:
        """Error of the peak force that no finer mesh makes less; relative."""
        steep = self.mesh.viscous.any() or self.mesh.lateral.any() or self.mesh.swells
        if steep and Law.RIGID in self.row.laws:
            return math.inf  # of flat ends that meet, any finer mesh finds a larger force
        return 2 * float(self.overshoot)

    def path(self, contact: int) -> Array:
        """How far a contact that is not bonded closes in each step, m."""
        return self._of("signal", self.place(contact), "closing") * self.step

    def place(self, contact: int) -> int:
        """Which of the kernel's links a contact is that is not bonded."""
        return list(self.mesh.touching).index(self.row.contact_link[contact])

    def bond(self, link: int) -> Array:
        """Mean force in a bonded link in each step, N."""
        return self._of("bonded", list(self.mesh.interfaces).index(link))

    def outer(self, side: int) -> tuple[Array, Array]:
        """Force of what is outside the left or right end on the row, and its velocity, by steps.

        N and m/s, in the laboratory; positive to the inside, and to the right.
        """
        link = (0, len(self.row.laws) - 1)[side]
        if link in self.mesh.touching:
            force = self._of("signal", list(self.mesh.touching).index(link), "force")
        elif self.row.outside[side][0] == "velocity":
            force = self.bond(link)
        else:
            force = self._of("outer", side, "push")
        fall = self.row.gravity * self.step * (np.arange(self.steps) + 0.5)
        return force, self._of("outer", side, "speed") + self.row.frame + fall

    def speed(self, mass: int) -> Array:
        """Velocity of a mass at the ends of the steps, the first at t = 0, in the frame."""
        side = mass - len(self.row.masses)
        if side >= 0:
            wall = float(self.row.outside[side][1]) - self.row.frame
            return np.asarray(wall - self.row.gravity * self.times)
        initial = self.states["velocity"][0, self.mesh.node_of_mass[mass]]
        return np.concatenate(([initial], self._of("speed", mass)))


def as_lists(arrays: Any) -> Any:
    """Lists of objects and of numbers."""
    return arrays._make(
        compiling.as_objects(x) if x.dtype.names else x.tolist() for x in arrays)


def _take_over(lists: Any, arrays: Any) -> None:
    """Take over what is in lists of `as_lists`."""
    for x, found in zip(arrays, lists, strict=True):
        x[:] = compiling.as_records(found, x.dtype) if x.dtype.names else found


def clock_on(mesh: Mesh, step: float) -> Clock:
    """Clock of a mesh; impedances are means, so that Z T is the mass."""
    row, segments, tick = mesh.row, mesh.row.segments, step / STEP_TICKS
    ticks = [max(1, round(float(s.transit_time) / tick)) for s in segments]
    impedance = [
        float(mesh.cell_mass[a + 1 : b + 1].sum()) / (T * tick)
        for a, b, T in zip(mesh.first[1:], mesh.last[1:], ticks, strict=True)
    ]
    return clock_of(
        row, ticks, tick, impedance=[0.0, *impedance, 0.0], scale=row.scale, transit_error=0.0)
