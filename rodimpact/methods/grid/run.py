"""A run on a grid: the kernels in plain Python or compiled, and what passed in each step."""

import math
from collections.abc import Callable
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np

from .. import compiling, kernels
from ..clock import Clock, clock_of
from ..link import Law, initial_gap
from ..memory import ask
from ..row import Array, squeezed
from . import grid_kernel, scheme, start
from .measures import largest_force, pressings
from .mesh import STEP_TICKS, GridMotion, Mesh
from .records import SIGNAL, STATE_FIELDS, StepHistory

GAP_RESOLUTION = (
    1.0  # of what bodies cover in a step: dispersed waves open smaller gaps
)
RINGING = 8  # steps in which waves beside a jump swing about their mean
ROUND = 0.25  # s between two looks at the clock
FEWEST_IN_THREES = 12  # kept states, from which they come in threes in damped rods
STATES_BYTES = 64 << 20  # of kept states, where their number is not given
CELL_TIMES = 7e-10, 8e-7
"""Time of a cell and a step, s, compiled and in plain Python, where nothing is implicit."""
STEP_TIMES = 3e-7, 1e-5
"""Time of a step beside that of its cells, with what results take."""


class GridRun:
    """A run on a mesh with a step, s, of so many steps as far as is known.

    Attributes
    ----------
    row : Row
    clock : Clock
        Its tick is the step's `STEP_TICKS`-th part.
    grid : Grid
    history : StepHistory
        What was entered of the steps taken, and of the states kept.
    proved : int
        Step at whose end the collision was proved final, -1 as long as it is not.
    stopped_by : str
        ``"final"``, ``"until"`` or ``"max_events"``.
    estimates : dict of str to float
        Error of each measure of the outcome, relative to its largest value, as `refined` finds it;
        empty where the step was given.
    rtol : float
        What they were to come to.
    coarser : list of (float, GridRun)
        Runs on coarser meshes, with the share of the differences of fields that bounds the error.
    """

    proved = -1
    stopped_by = "until"
    rtol = 0.0
    room: int

    def __init__(
        self,
        mesh: Mesh,
        step: float,
        snapshots: int | tuple[float, ...] | None = None,
        room: int | None = None,
    ) -> None:
        self.mesh, self.step, self.row = mesh, step, mesh.row
        self.clock, self.estimates = clock_on(mesh, step), dict[str, float]()
        self.coarser: list[tuple[float, GridRun]] = []
        self._chosen, self._stride = (
            None,
            1,
        )  # steps after which states are kept, or how many apart
        if snapshots is None or isinstance(snapshots, int):
            fitting = max(
                64, STATES_BYTES // (16 * len(mesh.mass) * (1 + mesh.has_radial_strain))
            )
            self._most = max(snapshots or fitting, 3)
        else:
            at = np.array(snapshots) / step
            self._chosen = np.concatenate((np.floor(at), np.ceil(at), [0.0]))
            self._most = 3 * len(self._chosen)
        # States of damped rods are smoothed with the states one step before and after.
        self._in_threes = bool(mesh.viscous.any()) and self._most >= FEWEST_IN_THREES
        self._ask(room or 4 * self.round_trip)
        self._when(
            self.room
        )  # sets the distance of states, so that few are kept in vain
        self.grid = scheme.grid_of(mesh, step)
        kick = start.begin(mesh, step, self.grid)
        self.history = self._blank(0, 0)
        self.advance(0)
        start.slow_down(mesh, step, self.grid, kick)

    @property
    def steps(self) -> int:
        """Steps taken, between which signals are averages."""
        return int(self.grid.run["step"][0])

    @property
    def round_trip(self) -> int:
        """Steps in which waves cross the longest rod and come back."""
        return 2 * max(1, math.ceil(self.clock.longest / STEP_TICKS))

    # The steps ------------------------------------------------------------------------------------

    def _ask(self, steps: int) -> None:
        """Raise TooLong where so many steps, with states and results, take too much memory."""
        mesh, row, states, self.room = (
            self.mesh,
            self.row,
            min(steps, self._most) + 2.0,
            steps,
        )
        kept = 3 * len(mesh.touching) + 2 + len(mesh.watched) + len(mesh.pulled)
        # what the kernel enters; force, gap, path, rate and power with integrals; ends and times
        record = steps * (
            2.0 * kept + 10 * len(row.contact_link) + 5 * len(row.masses) + 26
        )
        # two of each, while they are joined or fields are made of them
        fields = (
            2
            * states
            * (2 * len(mesh.mass) * (1 + mesh.has_radial_strain) + len(mesh.starts) + 3)
        )
        if (
            not kernels.enabled()
        ):  # lists take four times what arrays take, and stand beside them
            record, fields = record + 4.0 * steps * kept, 3 * fields
        what = (
            f"a run of {steps:.4g} steps of {self.step:.3g} s with {states:.4g} states"
        )
        ask(
            record + fields,
            "until" if record > fields else "snapshots",
            what,
            "stop earlier, keep fewer states, or take fewer cells",
        )

    def _when(self, end: int) -> Array:
        """Steps at whose ends states are kept, of a run to step `end`."""
        if self._chosen is not None:
            steps = self._chosen[self._chosen <= end].astype(int)
        else:
            while self._states(end) > self._most:
                self._stride *= 2
            steps = np.arange(0, end, self._stride)
        last = np.array([end])
        if self._in_threes:
            steps = np.concatenate((steps - 1, steps, steps + 1))
            last = end - np.arange(4)
        steps = np.union1d(steps, last)
        return np.asarray(steps[(steps >= 0) & (steps <= end)])

    def _states(self, end: int) -> int:
        """Upper bound of the number of states that are kept of a run to step `end`."""
        if self._in_threes and self._stride > 1:
            return 3 * (end // self._stride + 2)
        return end // self._stride + 2

    def _blank(self, steps: int, states: int) -> StepHistory:
        """Room for what the kernel enters."""
        grid, n = self.grid, len(self.mesh.mass)
        swollen = states, (n + 1) * self.mesh.has_radial_strain
        return StepHistory(
            np.empty((steps, len(grid.links)), SIGNAL),
            np.empty((steps, 2)),
            np.empty((steps, len(grid.watched))),
            np.empty((steps, len(grid.pulled))),
            np.empty(states, np.int64),
            np.empty(states),
            np.empty((states, n)),
            np.empty((states, n + 1)),
            np.empty((states, len(grid.pieces))),
            np.empty(swollen),
            np.empty(swollen),
        )

    def advance(self, end: int, tell: Callable[[int], None] | None = None) -> None:
        """Run to step `end`; `tell` hears of the steps taken, several times a second."""
        if end > self.room:
            self._ask(max(end, 2 * self.room))
        when, first = self._when(end), self.steps
        left = np.isin(self.history.when, when, assume_unique=True)
        new = when[left.sum() :]  # both increase, and all states left are among them
        window = self._blank(end - first, len(new))
        window.when[:] = new
        for side in (0, 1):
            window.prescribed[:, side] = scheme.boundary_values(
                self.mesh, self.step, side, end
            )[first:]
        self._take(window, end, tell)
        self.history = StepHistory(
            *(
                compiling.joined(old[left] if name in STATE_FIELDS else old, more)
                for name, old, more in zip(
                    StepHistory._fields, self.history, window, strict=True
                )
            )
        )

    def _take(
        self, window: StepHistory, end: int, tell: Callable[[int], None] | None
    ) -> None:
        """Take the steps to `end`, and fill a window with them."""
        first = self.steps
        arrays: list[Any] = [self.grid, StepHistory(*(x.reshape(-1) for x in window))]
        self.grid.run["first_step"], self.grid.run["kept_states"] = first, 0
        numbers = sum(x.nbytes for held in arrays for x in held) // 8
        seconds = (end - first) * cost(
            self.mesh, plain=True
        ) + numbers * kernels.LIST_TIME
        fast = kernels.worth_compiling(seconds, grid_kernel.run_steps)
        go: Any = (
            kernels.compiled(grid_kernel.run_steps) if fast else grid_kernel.run_steps
        )
        given = (
            arrays
            if fast
            else [held._make(map(compiling.as_objects, held)) for held in arrays]
        )
        done = True
        chunk = max(1, int(ROUND / cost(self.mesh, plain=not fast)))
        for taken in (*range(first + chunk, end, chunk), end):
            done = done and go(*given, taken)
            if done and tell and taken < end:
                tell(taken)
        for x, found in zip(chain(*arrays), chain(*given), strict=True):
            if not fast:
                x[:] = compiling.as_records(found, x.dtype)
        if not done:
            raise squeezed(self.steps * self.step)

    # What passed ----------------------------------------------------------------------------------

    @property
    def edges(self) -> Array:
        """Ticks [steps + 1] from 0 on, between which signals are averages."""
        return STEP_TICKS * np.arange(self.steps + 1)

    @property
    def times(self) -> Array:
        """`edges` in s."""
        return np.asarray(self.edges * self.clock.tick)

    def motion(self, states: Any = slice(None)) -> GridMotion:
        """The states that were kept, or some of them, without what pushes."""
        mesh = self.mesh
        kept = {name: getattr(self.history, name)[states] for name in STATE_FIELDS}
        return GridMotion(
            mesh.counts,
            mesh.first,
            mesh.last,
            mesh.starts,
            mesh.mass,
            mesh.shear,
            mesh.cells,
            **kept,
            pushes={},
        )

    def entered(self, link: int, field: str) -> Array:
        """What a link that is not bonded entered in each step."""
        place = list(self.mesh.touching).index(link)
        return np.ascontiguousarray(self.history.signals[:, place][field])

    def contact(self, contact: int) -> tuple[Array, Array]:
        """Mean force in each step, N, and gap at the ends of steps, m; not of a bonded contact."""
        link = self.row.contact_link[contact]
        gap = self.entered(link, "gap") * self.step
        return self.entered(link, "force"), np.append(
            float(initial_gap(self.row.links[link])), gap
        )

    def pressed(self, contact: int) -> Array:
        """[n, 3] as of `pressings`, s; none of a contact that cannot open."""
        if contact not in self.row.opening:
            return np.zeros((0, 3))
        least = GAP_RESOLUTION * float(self.row.scale) * self.step
        return self.step * pressings(*self.contact(contact), least)

    def spans(self, pressed: Array) -> tuple[Array, Array]:
        """When a contact that has `pressed` so begins and ceases to, or the run ends, s."""
        begins, ends, _ = pressed.T
        return begins, np.nan_to_num(ends, nan=self.times[-1])

    def velocity(self, node: int) -> Array:
        """Velocity of a watched node at the ends of the steps, the first at t = 0, in the frame."""
        entered = self.history.velocities[:, self.mesh.watched.index(node)]
        return np.concatenate((self.history.velocity[:1, node], entered))

    def speed(self, mass: int) -> Array:
        """Velocity of a mass at the ends of the steps, in the frame."""
        side = mass - len(self.row.masses)
        if side >= 0:
            wall = float(self.row.outside[side][1]) - self.row.frame
            return np.asarray(wall - self.row.system.gravity * self.times)
        return self.velocity(self.mesh.node_of_mass[mass])

    def bond(self, link: int) -> Array:
        """Mean force in a bonded link in each step, N: Newton's law for the half cell beside it."""
        mesh, (node, cell) = self.mesh, self.mesh.bonds[link]
        sign, v = (1 if cell == node else -1), self.velocity(node)
        stretch = sign * (v - self.velocity(node - sign))
        bound = scheme.off_diagonal_of(mesh, self.step)[cell] * np.diff(stretch)
        force = self.history.tensions[:, mesh.pulled.index(cell)]
        pulled = force + mesh.viscous[cell] * stretch[:-1] + bound
        gained = mesh.cell_mass[cell] / 2 / self.step * np.diff(v)
        return np.asarray(-pulled - sign * gained)

    @property
    def states_bytes(self) -> int:
        """Memory of the states that are kept."""
        return sum(getattr(self.history, name).nbytes for name in STATE_FIELDS)

    @property
    def largest_strain(self) -> float:
        """Largest strain of the states that were kept."""
        return float(np.abs(self.motion().stretches(self.step) / self.mesh.width).max())

    @cached_property
    def overshoot(self) -> float:
        """How much less the peak force of rigid contacts is over a few steps; relative.

        Beside a jump waves on a grid overshoot by a share that no finer mesh makes less; averages
        over a few steps do not.
        """
        peaks, less = [0.0], [0.0]
        for contact, link in self.row.opening.items():
            if self.row.links[link].law == Law.RIGID:
                force = self.contact(contact)[0]
                passed = np.concatenate((np.zeros(RINGING), np.cumsum(force)))
                means = (passed[RINGING:] - passed[:-RINGING]) / RINGING
                peaks.append(largest_force(force))
                less.append(peaks[-1] - float(means.max(initial=0.0)))
        return max(less) / (max(peaks) or 1.0)

    @property
    def peak_error(self) -> float:
        """Error of the peak force that no finer mesh makes less; relative."""
        steep = (
            self.mesh.viscous.any()
            or self.mesh.lateral.any()
            or self.mesh.has_radial_strain
        )
        if steep and any(it.law == Law.RIGID for it in self.row.links):
            return (
                math.inf
            )  # of flat ends that meet, any finer mesh finds a larger force
        return 2 * float(self.overshoot)


def cost(mesh: Mesh, plain: bool) -> float:
    """About how long a step takes, s, in plain Python or compiled."""
    times = 1 + mesh.has_radial_strain + (2 if plain else 6) * mesh.implicit
    return STEP_TIMES[plain] + len(mesh.mass) * times * CELL_TIMES[plain]


def clock_on(mesh: Mesh, step: float) -> Clock:
    """Clock of a mesh; impedances are means, so that Z T is the mass."""
    row, segments, tick = mesh.row, mesh.row.segments, step / STEP_TICKS
    ticks = [max(1, round(float(s.transit_time) / tick)) for s in segments]
    impedance = [
        float(mesh.cell_mass[a + 1 : b + 1].sum()) / (T * tick)
        for a, b, T in zip(mesh.first[1:], mesh.last[1:], ticks, strict=True)
    ]
    return clock_of(
        row,
        ticks,
        tick,
        impedance=[0.0, *impedance, 0.0],
        scale=row.scale,
        is_mesh=True,
    )
