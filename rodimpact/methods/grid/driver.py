"""A run on a grid: the kernels in plain Python or compiled, and what is kept of each step."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .. import abilities, compiling, kernels
from ..finality_kernel import NEVER
from ..memory import ask
from ..row import Array, squeezed
from . import grid_kernel, proof_kernel, scheme, start
from .mesh import Mesh
from .records import OUTER, PER_STATE, PER_STEP, SIGNAL, STATE, Track

STATES_BYTES = 64 << 20  # of kept states, where their number is not given
CELL_TIMES = {"explicit": (7e-10, 8e-7), "implicit": (6e-9, 2.5e-6), "radial": (7e-10, 8e-7)}
"""Time of a cell and a step, s, compiled and in plain Python; of radial motion beside the other."""
STEP_TIMES = 3e-7, 1e-5
"""Time of a step beside that of its cells, with what results take."""

WHOLE = ("velocity", "force", "place")  # of states, entered whole: not worth clearing before
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


class Driver:
    """A run on a mesh with a step, s, and with room for so many steps at first.

    Attributes
    ----------
    grid : Grid
    track : Track
        Rows for each step, and for each state; more than there are.
    """

    def __init__(self, mesh: Mesh, step: float, keep: Keeper, room: int) -> None:
        self.mesh, self.step, self.row, self.keep = mesh, step, mesh.row, keep
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
    def taken(self) -> int:
        """Steps so far."""
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
            new = np.empty if name in WHOLE else np.zeros
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

    def finality_time(self) -> int:
        """Steps until it may be proved that the collision is over; NEVER if not as it is."""
        if abilities.driven(self.row.system):
            return NEVER
        parts: tuple[Any, ...] = self.grid, *self.proof
        nodes = 2 * len(self.mesh.mass)
        if kernels.worth_compiling(nodes * PROOF_TIME, proof_kernel.finality_time):
            return int(kernels.compiled(proof_kernel.finality_time)(*parts))
        grid, *proof = as_lists(self.grid), *map(compiling.as_objects, self.proof)
        return proof_kernel.finality_time(grid, *proof)

    def advance(
        self, end: int, tell: Callable[[int], None] | None = None, ahead: float = 0.0
    ) -> None:
        """Run to step `end`; `tell` hears of the steps taken, several times a second.

        So many seconds in plain Python, `ahead`, are certain to follow.
        """
        if not self.taken and end and self._overlaps:
            self.advance(0)
            start.part(self.grid, self._overlaps)
            self._overlaps = []
        if end > self.room:
            self._make_room(max(end, 2 * self.room))
        states, first = self._choose_states(end), self.taken
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
            raise squeezed(self.taken * self.step)


def as_lists(arrays: Any) -> Any:
    """Lists of objects and of numbers."""
    return arrays._make(
        compiling.as_objects(x) if x.dtype.names else x.tolist() for x in arrays)


def _take_over(lists: Any, arrays: Any) -> None:
    """Take over what is in lists of `as_lists`."""
    for x, found in zip(arrays, lists, strict=True):
        x[:] = compiling.as_records(found, x.dtype) if x.dtype.names else found


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

    def when(self, step: float, end: int) -> list[int]:
        """Steps at whose ends states are kept, of a run to step `end`."""
        if isinstance(self.snapshots, np.ndarray):
            steps = self.snapshots / step
            both = np.concatenate((np.floor(steps), np.ceil(steps), [0.0]))
            chosen: list[int] = np.unique(both[both <= end].astype(int)).tolist()
            return chosen
        while end // self.stride + 2 > max(self.most, 3):
            self.stride *= 2
        return list(range(0, end + 1, self.stride))


def cost(mesh: Mesh, plain: bool) -> float:
    """About how long a step takes, s, in plain Python or compiled."""
    return STEP_TIMES[plain] + sum(
        (b - a + 1) * CELL_TIMES["implicit" if hidden else "explicit"][plain]
        for a, b, hidden in zip(mesh.starts, mesh.stops, mesh.implicit, strict=True)
    ) + np.count_nonzero(mesh.cells.swelling) * CELL_TIMES["radial"][plain]
