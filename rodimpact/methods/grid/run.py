"""A run on a grid: its steps, and the results of each step.

Steps are compiled or in plain Python.
"""

import math
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from .. import kernels, record_lists
from ..clock import Clock, clock_of
from ..link import Law, initial_gap
from ..memory import require_memory
from ..row import Array, squeezed
from . import grid_kernel, scheme, start
from .measures import contact_intervals, largest_force
from .mesh import STEP_TICKS, GridMotion, Mesh
from .records import SHAFT_FORCE, SIGNAL, STATE_FIELDS, StepHistory
from .soil import shaft_bodies

GAP_RESOLUTION = 1.0
"""Gap that counts as open, over the distance that bodies cover in a step.

Dispersed waves open smaller gaps.
"""
OVERSHOOT_STEPS = 8
"""Steps in which waves beside a jump oscillate about their mean."""
REPORT_INTERVAL = 0.25
"""Time between two reports of the progress, s."""
MIN_STATES_IN_THREES = 12
"""Number of states to keep, from which on those of damped rods come in threes."""
MAX_STATES_BYTES = 64 << 20
"""Memory of the states that are kept where their number is not given."""
CELL_TIMES = 7e-10, 8e-7
"""Time of an explicit step of a cell, s, compiled and in plain Python."""
STEP_TIMES = 3e-7, 1e-5
"""Time of a step beside that of its cells, with the results made of it, s."""


class GridRun:
    """A run on a mesh, as far as it has gone.

    Attributes
    ----------
    mesh : Mesh
    step : float
        Time step, s.
    row : Row
    clock : Clock
        Its tick is the `STEP_TICKS`-th part of the step.
    grid : Grid
    history : StepHistory
        Records of the steps taken, and the states that were kept.
    proved : int
        Step at whose end the collision was proved final, -1 as long as it is not.
    checked_steps : int
        Steps for which memory has been checked.
    stopped_by : str
        ``"final"``, ``"until"`` or ``"max_events"``.
    estimates : dict of str to float
        Estimated error of each measure of the outcome, relative to its largest value,
        see `refinement.refined`; empty where the step was given.
    rtol : float
        Bound that was wanted for them.
    coarser : list of (float, GridRun)
        Runs on coarser meshes, with the share of the differences of fields that bounds
        the error.

    Parameters
    ----------
    mesh : Mesh
    step : float
        s.
    snapshots : int or tuple of float, optional
        Number of states to keep, or the times of the states, s.
    expected_steps : int, optional
        Number of steps for which memory is checked at the start.
    """

    proved = -1
    stopped_by = "until"
    rtol = 0.0

    def __init__(
        self,
        mesh: Mesh,
        step: float,
        snapshots: int | tuple[float, ...] | None = None,
        expected_steps: int | None = None,
    ) -> None:
        """Make the grid in its state at t = 0, which is kept.

        Raise TooLong if memory is short. How many states are kept at most follows from
        `snapshots`, or from the memory that they may take; states of damped rods are
        kept in threes if there may be enough.
        """
        self.mesh = mesh
        self.step = step
        self.row = mesh.row
        self.clock = clock_on(mesh, step)
        self.estimates: dict[str, float] = {}
        self.coarser: list[tuple[float, GridRun]] = []
        self._plan_states(snapshots)
        self.checked_steps = expected_steps or 4 * self.round_trip
        self._require_memory(self.checked_steps)
        # This sets the stride of states, so that few are kept in vain.
        self._choose_states(self.checked_steps)
        self.grid = scheme.grid_of(mesh, step)
        kick = start.begin(mesh, step, self.grid)
        self.history = self._empty_history(0, 0)
        self.advance(0)  # no step, but the state at t = 0 is kept
        start.slow_down(mesh, step, self.grid, kick)

    def _plan_states(self, snapshots: int | tuple[float, ...] | None) -> None:
        """Set how many states are kept, after which steps, and whether in threes.

        `snapshots` is their number, or their times, s; without it their number follows
        from the memory that they may take. In threes, a state is kept with those one
        step before and after, from which states of damped rods are smoothed.
        """
        mesh = self.mesh
        self._stride = 1  # steps between two states
        self._chosen_steps: Array | None = None  # steps after which states are kept
        if snapshots is None or isinstance(snapshots, int):
            # Two numbers of 8 bytes a node and its cell,
            # twice as many with radial strains
            state_bytes = 16 * len(mesh.mass) * (1 + mesh.has_radial_strain)
            count = snapshots
            if not count:
                count = max(64, MAX_STATES_BYTES // state_bytes)
            self._max_states = max(count, 3)
        else:
            # States at the step ends before and after each time, and at t = 0
            steps = np.array(snapshots) / self.step
            self._chosen_steps = np.concatenate(
                (np.floor(steps), np.ceil(steps), [0.0])
            )
            self._max_states = 3 * len(self._chosen_steps)  # room for threes
        is_damped = bool(mesh.viscous.any())
        self._in_threes = is_damped and self._max_states >= MIN_STATES_IN_THREES

    @property
    def steps(self) -> int:
        """Steps taken, between which signals are averages."""
        return int(self.grid.run["step"][0])

    @property
    def round_trip(self) -> int:
        """Steps in which waves cross the longest rod and come back."""
        return 2 * max(1, math.ceil(self.clock.longest_rod / STEP_TICKS))

    # The steps ------------------------------------------------------------------------

    def _require_memory(self, steps: int) -> None:
        """Raise TooLong where so many steps take too much memory; else note them.

        Their states and results count, in numbers of 8 bytes. They are noted in
        `checked_steps`.
        """
        mesh = self.mesh
        row = self.row
        states = min(steps, self._max_states) + 2.0
        self.checked_steps = steps
        # Numbers of a step that the kernel records: of links, ends, nodes and cells
        recorded = 3 * len(mesh.touching) + 2 + len(mesh.watched) + len(mesh.pulled)
        # Records of the kernel, twice while they are joined; force, gap, path, rate and
        # power of a contact with their integrals; masses; ends and times.
        results = 10 * len(row.contact_link) + 5 * len(row.masses) + 26
        record = steps * (2.0 * recorded + results)
        # Two of each state, while they are joined or fields are made of them.
        numbers = 2 * len(mesh.mass) * (1 + mesh.has_radial_strain)
        fields = 2 * states * (numbers + len(mesh.starts) + 3)
        if not kernels.enabled():
            # Lists take four times the memory of arrays, and stand beside them.
            record = record + 4.0 * steps * recorded
            fields = 3 * fields
        # The argument that is to be changed: that of the larger part
        if record <= fields:
            argument = "snapshots"
        else:
            argument = "until"
        require_memory(
            record + fields,
            argument,
            f"a run of {steps:.4g} steps of {self.step:.3g} s with {states:.4g} states",
            "stop earlier, keep fewer states, or take fewer cells",
        )

    def _choose_states(self, end: int) -> Array:
        """Steps at whose ends states are kept in a run to step `end`, [state].

        The stride of states is doubled until no more are kept than wanted. The last
        state, and with damping those one step before and after each, are kept too.
        """
        if self._chosen_steps is not None:
            steps = self._chosen_steps[self._chosen_steps <= end].astype(int)
        else:
            while self._bound_states(end) > self._max_states:
                self._stride *= 2
            steps = np.arange(0, end, self._stride)
        if self._in_threes:
            steps = np.concatenate((steps - 1, steps, steps + 1))
            last = end - np.arange(4)
        else:
            last = np.array([end])
        steps = np.union1d(steps, last)  # they are in order, each once
        return np.asarray(steps[(steps >= 0) & (steps <= end)])

    def _bound_states(self, end: int) -> int:
        """Upper bound of the number of states kept in a run to step `end`.

        It follows from the stride. Threes of neighbouring states overlap where each
        step is kept.
        """
        if self._in_threes and self._stride > 1:
            return 3 * (end // self._stride + 2)
        return end // self._stride + 2

    def _empty_history(self, steps: int, states: int) -> StepHistory:
        """Arrays for the records of the kernel over some steps, with some states.

        They are not set yet. Radial strains have no columns where cells have none.
        """
        grid = self.grid
        n = len(self.mesh.mass)
        radial_shape = states, (n + 1) * self.mesh.has_radial_strain
        return StepHistory(
            signals=np.empty((steps, len(grid.links)), SIGNAL),
            prescribed=np.empty((steps, 2)),
            velocities=np.empty((steps, len(grid.watched))),
            tensions=np.empty((steps, len(grid.pulled))),
            shafts=np.empty((steps, grid.run["shafts"][0]), SHAFT_FORCE),
            when=np.empty(states, np.int64),
            lost=np.empty(states),
            velocity=np.empty((states, n)),
            force=np.empty((states, n + 1)),
            displacement=np.empty((states, len(grid.pieces))),
            radial=np.empty(radial_shape),
            radial_rate=np.empty(radial_shape),
            resistance=np.empty((states, len(grid.soil))),
        )

    def advance(self, end: int, report: Callable[[int], None] | None = None) -> None:
        """Run to step `end`; `report` is told the steps taken, several times a second.

        The records of the new steps and the states that are kept of them are joined to
        `history`. Kept states that a wider stride no longer wants are dropped.
        """
        if end > self.checked_steps:
            self._require_memory(max(end, 2 * self.checked_steps))
        when = self._choose_states(end)
        first = self.steps
        still_wanted = np.isin(self.history.when, when, assume_unique=True)
        all_wanted = bool(still_wanted.all())  # then no copy is needed
        # Both increase, and all states that are still wanted are among them.
        new = when[still_wanted.sum() :]
        window = self._empty_history(end - first, len(new))
        window.when[:] = new
        for side in (0, 1):
            values = scheme.boundary_values(self.mesh, self.step, side, end)
            window.prescribed[:, side] = values[first:]
        self._run_kernel(window, end, report)
        joined = {}
        for name in StepHistory._fields:
            old = getattr(self.history, name)
            if name in STATE_FIELDS and not all_wanted:
                old = old[still_wanted]
            joined[name] = record_lists.joined(old, getattr(window, name))
        self.history = StepHistory(**joined)

    def _run_kernel(
        self, window: StepHistory, end: int, report: Callable[[int], None] | None
    ) -> None:
        """Take the steps to `end`, and fill a window with them.

        They are compiled or in plain Python. The grid and the window are changed in
        place; in plain Python lists are made of them, and copied back.

        Raises
        ------
        InvalidModel
            If walls squeeze a rigid mass.
        """
        first = self.steps
        # Kernels take flat arrays: these share the memory of the window.
        flat_window = StepHistory(*(array.reshape(-1) for array in window))
        arrays = [*self.grid, *flat_window]
        self.grid.run["first_step"] = first
        self.grid.run["kept_states"] = 0
        numbers = sum(array.nbytes for array in arrays) // 8
        # Time that plain Python takes
        seconds = (end - first) * step_time(self.mesh, plain=True)
        seconds += numbers * kernels.LIST_TIME
        is_compiled = kernels.worth_compiling(seconds, grid_kernel.run_steps)
        kernel: Any
        grid: Any = self.grid
        history: Any = flat_window
        if is_compiled:
            kernel = kernels.compiled(grid_kernel.run_steps)
        else:
            kernel = grid_kernel.run_steps
            grid = grid._make(map(record_lists.as_objects, grid))
            history = history._make(map(record_lists.as_objects, history))
        is_solved = True
        time_of_step = step_time(self.mesh, plain=not is_compiled)
        chunk = max(1, int(REPORT_INTERVAL / time_of_step))  # steps between two reports
        # Numbers of steps after which progress is reported, and that of all steps
        for taken in (*range(first + chunk, end, chunk), end):
            is_solved = is_solved and kernel(grid, history, taken)
            if is_solved and report and taken < end:
                report(taken)
        if not is_compiled:
            for array, objects in zip(arrays, [*grid, *history], strict=True):
                array[:] = record_lists.as_records(objects, array.dtype)
        if not is_solved:
            raise squeezed(self.steps * self.step)

    # Results --------------------------------------------------------------------------

    @property
    def edges(self) -> Array:
        """Ticks at the ends of steps, from 0 on [steps + 1].

        Signals are averages between them.
        """
        return STEP_TICKS * np.arange(self.steps + 1)

    @property
    def times(self) -> Array:
        """Times of `edges`, s."""
        return np.asarray(self.edges * self.clock.tick)

    def motion(self, states: Any = slice(None)) -> GridMotion:
        """The motion in the states that were kept, or in some of them.

        Its `pushes` are empty.
        """
        mesh = self.mesh
        fields = {name: getattr(self.history, name)[states] for name in STATE_FIELDS}
        return GridMotion(
            counts=mesh.counts,
            first=mesh.first,
            last=mesh.last,
            starts=mesh.starts,
            mass=mesh.mass,
            shear_stiffness=mesh.shear_stiffness,
            cells=mesh.cells,
            **fields,
            soil=self.grid.soil,
            soil_force=self._soil_forces(fields),
            pushes={},
        )

    def recorded(self, link: int, field: str) -> Array:
        """Values of a field of `SIGNAL` of a link that has a law, [step].

        Time is in steps.
        """
        column = list(self.mesh.touching).index(link)  # number of the link in the grid
        return np.ascontiguousarray(self.history.signals[:, column][field])

    def contact(self, contact: int) -> tuple[Array, Array]:
        """Force and gap of a contact that is not bonded.

        Returns
        -------
        array
            Mean force in each step, N [steps].
        array
            Gap at the ends of steps, from t = 0 on, m [steps + 1].
        """
        link = self.row.contact_link[contact]
        # m, at the ends of steps; the grid divides lengths by the step.
        gap = self.recorded(link, "gap") * self.step
        first_gap = float(initial_gap(self.row.links[link]))
        return self.recorded(link, "force"), np.append(first_gap, gap)

    def force_intervals(self, contact: int) -> Array:
        """Times of the forces of a contact, s [n, 3].

        They are begin and end of each force, and the opening before the next one; nan
        for what does not come, see `contact_intervals`. There are none for a contact
        that cannot open.
        """
        if contact not in self.row.unilateral_links:
            return np.zeros((0, 3))
        open_gap = GAP_RESOLUTION * float(self.row.scale) * self.step
        force, gap = self.contact(contact)
        return self.step * contact_intervals(force, gap, open_gap)

    def force_spans(self, intervals: Array) -> tuple[Array, Array]:
        """Times at which forces of a contact begin, and end, s [n] each.

        `intervals` are its `force_intervals`. A force that still acts ends with the
        run.
        """
        begins, ends, _ = intervals.T
        return begins, np.nan_to_num(ends, nan=self.times[-1])

    def velocity(self, node: int) -> Array:
        """Velocity of a watched node in the frame at the ends of steps, m/s.

        The first one is at t = 0.
        """
        velocities = self.history.velocities[:, self.mesh.watched.index(node)]
        return np.concatenate((self.history.velocity[:1, node], velocities))

    def mass_velocity(self, mass: int) -> Array:
        """Velocity of a mass in the frame, m/s, at the ends of steps from t = 0 on.

        Indices beyond the masses of the row are its left and right wall.
        """
        side = mass - len(self.row.masses)
        if side >= 0:  # a wall, which the frame falls past
            wall = float(self.row.boundaries[side][1]) - self.row.frame
            return np.asarray(wall - self.row.system.gravity * self.times)
        return self.velocity(self.mesh.node_of_mass[mass])

    def bond_force(self, link: int) -> Array:
        """Mean force in a bonded link in each step, N.

        It follows from Newton's law for the half cell beside it. With sign 1 for a half
        cell on the left of the link and -1 on its right, F = -tension - sign (m/2
        dv/dt - force of the soil).
        """
        mesh = self.mesh
        node, cell = mesh.bonds[link]
        if cell == node:  # cell i lies on the left of node i
            sign = 1
        else:
            sign = -1
        v = self.velocity(node)
        stretch_rate = sign * (v - self.velocity(node - sign))  # that of the cell
        # Tension in the step: elastic, viscous,
        # and what depends on the change of velocities
        # Lateral inertia over the step, and half of the viscous damping
        coupling = scheme.off_diagonal_of(mesh, self.step)[cell]
        implicit = coupling * np.diff(stretch_rate)
        elastic = self.history.tensions[:, mesh.pulled.index(cell)]
        tension = elastic + mesh.viscous[cell] * stretch_rate[:-1] + implicit
        momentum_rate = mesh.cell_mass[cell] / 2 / self.step * np.diff(v)
        soil = self._soil_at_end(node, sign)
        return np.asarray(-tension - sign * (momentum_rate - soil))

    def recorded_soil(self, shaft: int, field: str) -> Array:
        """Values of a field of `SHAFT_FORCE` of a rod that soil holds, [step].

        `shaft` is the place of the rod among the `shaft_bodies`.
        """
        return np.ascontiguousarray(self.history.shafts[:, shaft][field])

    def _soil_forces(self, fields: dict[str, Array]) -> Array:
        """Force of the soil to the right in some states, N [state, node in soil].

        `fields` are those of the states. The force is -(R + c v) with the damping c = J
        abs(R) by Smith's law and a constant one else, v the velocity against the
        ground.
        """
        soil = self.grid.soil
        t = fields["when"][:, None] * self.step
        velocity = fields["velocity"][:, soil["node"]] + self.row.frame
        velocity = velocity + self.row.system.gravity * t
        resistance = fields["resistance"]
        by_smith = soil["damping_factor"] * np.abs(resistance)
        damping = np.where(soil["is_smith"], by_smith, soil["damping"])
        return np.asarray(-resistance - damping * velocity)

    def _soil_at_end(self, node: int, sign: int) -> Array:
        """Force of the soil on the half cell at an end of a rod, N [step].

        It is 0 without soil. The end is the right (`sign` = 1) or left (-1) one of the
        rod that has this node there.
        """
        for shaft, body in enumerate(shaft_bodies(self.row)):
            first, last = self.row.spans[body]
            if sign > 0 and self.mesh.last[last] == node:
                return self.recorded_soil(shaft, "last_node_force")
            if sign < 0 and self.mesh.first[first] == node:
                return self.recorded_soil(shaft, "first_node_force")
        return np.zeros(self.steps)

    @property
    def states_bytes(self) -> int:
        """Memory of the states that are kept, bytes."""
        return sum(getattr(self.history, name).nbytes for name in STATE_FIELDS)

    @property
    def largest_strain(self) -> float:
        """Largest absolute strain of the states that were kept."""
        strains = self.motion().stretches(self.step) / self.mesh.width
        return float(np.abs(strains).max())

    @cached_property
    def overshoot(self) -> float:
        """Relative overshoot of the peak force of rigid contacts.

        It is (peak of the step means - peak of the means over `OVERSHOOT_STEPS`)/peak.
        Beside a jump waves on a grid overshoot by a share that no finer mesh makes
        less; averages over a few steps do not.
        """
        largest_peak = 0.0
        largest_excess = 0.0
        for contact, link in self.row.unilateral_links.items():
            if self.row.links[link].law != Law.RIGID:
                continue
            force = self.contact(contact)[0]
            sums = np.concatenate((np.zeros(OVERSHOOT_STEPS), np.cumsum(force)))
            # Means over the last few steps:
            # differences of sums that are so many steps apart
            means = (sums[OVERSHOOT_STEPS:] - sums[:-OVERSHOOT_STEPS]) / OVERSHOOT_STEPS
            peak = largest_force(force)
            excess = peak - float(means.max(initial=0.0))
            largest_peak = max(largest_peak, peak)
            largest_excess = max(largest_excess, excess)
        if largest_peak == 0:
            return largest_excess
        return largest_excess / largest_peak

    @property
    def peak_error(self) -> float:
        """Relative error of the peak force that no finer mesh makes less.

        It is inf where flat ends of damped rods, or of rods with lateral inertia, meet:
        any finer mesh finds a larger force.
        """
        mesh = self.mesh
        is_dispersive = mesh.lateral_inertia.any() or mesh.has_radial_strain
        has_flat_ends = any(link.law == Law.RIGID for link in self.row.links)
        if has_flat_ends and (mesh.viscous.any() or is_dispersive):
            return math.inf
        return 2 * float(self.overshoot)


def step_time(mesh: Mesh, *, plain: bool) -> float:
    """Approximate time of a step, s, in plain Python or compiled."""
    # Equations to be solved take six,
    # or in plain Python two, times as long as the rest.
    implicit = 6
    if plain:
        implicit = 2
    times = 1 + mesh.has_radial_strain + implicit * mesh.implicit
    # The first time of each pair is that of machine code.
    return STEP_TIMES[plain] + len(mesh.mass) * times * CELL_TIMES[plain]


def clock_on(mesh: Mesh, step: float) -> Clock:
    """Clock of a mesh with steps of `step`, s, each of which has `STEP_TICKS` ticks.

    Transit times are those of the segments, rounded to ticks, not those of their cells.
    Impedances of segments are means, so that impedance times transit time is the mass.
    """
    row = mesh.row
    tick = step / STEP_TICKS
    transits = []
    impedances = [0.0]
    for s, segment in enumerate(row.segments, start=1):
        transit = max(1, round(float(segment.transit_time) / tick))
        # Cell i lies on the left of node i:
        # none of this segment on the left of its first node.
        cells = slice(mesh.first[s] + 1, mesh.last[s] + 1)
        transits.append(transit)
        impedances.append(float(mesh.cell_mass[cells].sum()) / (transit * tick))
    return clock_of(
        row,
        transits,
        tick,
        impedance=[*impedances, 0.0],
        scale=row.scale,
        is_mesh=True,
    )
