"""A run on a grid: its steps, and the results of each step.

Steps are taken in machine code or in plain Python.
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
"""Smallest gap that counts as open, over the distance that bodies move in a step.

Dispersion of waves opens smaller false gaps.
"""
OVERSHOOT_STEPS = 8
"""Number of steps over which the oscillation of waves beside a jump averages out."""
REPORT_INTERVAL = 0.25
"""Time between two reports of the progress, s."""
MIN_STATES_IN_THREES = 12
"""Fewest states to keep for which states of damped rods are kept in threes."""
MAX_STATES_BYTES = 64 << 20
"""Memory of the states that are kept if their number is not given."""
CELL_TIME = 7e-10
"""Computing time of an explicit step per cell in machine code, s."""
STEP_TIME = 3e-7
"""Further time per step in machine code, results of the step included, s."""
PLAIN_CELL_TIME = 8e-7
"""Computing time of an explicit step per cell in plain Python, s."""
PLAIN_STEP_TIME = 1e-5
"""Further time per step in plain Python, results of the step included, s."""


class GridRun:
    """A run on a mesh, as far as it has gone.

    Attributes
    ----------
    mesh : Mesh
    step : float
        Time step, s.
    row : Row
    clock : Clock
        Its tick is the step divided by `STEP_TICKS`.
    grid : Grid
    history : StepHistory
        Records of the steps taken, and the states that were kept.
    proved : int
        Number of steps after which the collision was proved final; -1 without a proof.
    checked_steps : int
        Steps for which memory has been checked.
    stopped_by : str
        ``"final"``, ``"until"`` or ``"max_events"``.
    estimates : dict of str to float
        Estimated error of each measure of the outcome, relative to its largest value,
        see `refinement.refined`; empty if the step was given.
    rtol : float
        Largest error that was wanted for them.
    coarser : list of (float, GridRun)
        Runs on coarser meshes, each with its share, see `refinement.comparable_runs`.

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
        """Make the grid in its state at t = 0, and keep this state; no step is taken.

        `snapshots`, or else the memory that states may take, decides how many states
        are kept. Memory is checked for `expected_steps` or, without it (None or 0), for
        four round trips; TooLong is raised if it is short. After the state at t = 0 has
        been kept, damped ends that touch are slowed down, see `start.slow_down`.
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
        # This sets the stride of states for all expected steps, so that few states are
        # kept and then dropped. The steps that it returns are not used.
        self._choose_states(self.checked_steps)
        self.grid = scheme.grid_of(mesh, step)
        half_kick = start.begin(mesh, step, self.grid)
        self.history = self._empty_history(steps=0, states=0)
        self.advance(0)  # no step, but the state at t = 0 is kept
        start.slow_down(mesh, step, self.grid, half_kick)

    def _plan_states(self, snapshots: int | tuple[float, ...] | None) -> None:
        """Set how many states are kept at most, after which steps, and if in threes.

        `snapshots` is the largest number of states, at least 3, or their times, s: for
        each time the states at the step ends before and after it are kept. Without
        `snapshots` (None or 0) the number follows from the memory that states may take,
        and is at least 64. "In threes" means that a state is kept with the states one
        step before and one step after it, so that it can be smoothed. This is done for
        damped rods if there may be `MIN_STATES_IN_THREES` states or more. `_stride`,
        `_chosen_steps`, `_max_states` and `_in_threes` are set.
        """
        mesh = self.mesh
        self._stride = 1  # steps between two states, if their times are not given
        # Steps after which states are kept; None if their times are not given
        self._chosen_steps: Array | None = None
        if snapshots is None or isinstance(snapshots, int):
            # Two numbers of 8 bytes for each node and its cell: velocity and tension.
            # Radial strains and their rates are two more.
            state_bytes = 16 * len(mesh.mass)
            if mesh.has_radial_strain:
                state_bytes *= 2
            count = snapshots
            if not count:
                count = max(64, MAX_STATES_BYTES // state_bytes)
            self._max_states = max(count, 3)
        else:
            times = np.array(snapshots) / self.step  # in steps
            step_before = np.floor(times)
            step_after = np.ceil(times)
            at_start = [0.0]  # the state at t = 0 is always kept
            self._chosen_steps = np.concatenate((step_before, step_after, at_start))
            self._max_states = 3 * len(self._chosen_steps)  # enough for threes
        is_damped = bool(mesh.viscous.any())
        self._in_threes = is_damped and self._max_states >= MIN_STATES_IN_THREES

    @property
    def steps(self) -> int:
        """Number of steps taken so far."""
        return int(self.grid.run["steps_taken"][0])

    @property
    def round_trip(self) -> int:
        """Number of steps in which waves cross the longest rod and come back; even."""
        transit = math.ceil(self.clock.longest_rod / STEP_TICKS)  # ticks to steps
        return 2 * max(1, transit)

    # The steps ------------------------------------------------------------------------

    def _require_memory(self, steps: int) -> None:
        """Raise TooLong if a run of so many steps takes too much memory.

        The memory is estimated in numbers of 8 bytes. They are the records of the steps
        with the results made of them, and the states that are kept. `checked_steps`
        becomes `steps`.
        """
        mesh = self.mesh
        row = self.row
        states = min(steps, self._max_states) + 2.0  # 2: those at the start and the end
        self.checked_steps = steps
        # Numbers that the kernel records in a step: three for each link, one for each
        # of both ends, each recorded node and each recorded cell
        recorded = 3 * len(mesh.link_nodes) + 2
        recorded += len(mesh.recorded_nodes) + len(mesh.recorded_cells)
        # Numbers that are made of them for each step: force, gap, path, rate and power
        # of a contact with their integrals (10), those of a mass (5), and those of both
        # ends with the times (26)
        results = 10 * len(row.contact_link) + 5 * len(row.masses) + 26
        # Records exist twice while new ones are joined to the old.
        in_steps = steps * (2.0 * recorded + results)
        # So do states while they are joined or fields are made of them.
        per_state = 2 * len(mesh.mass)  # velocity and tension, see `_plan_states`
        if mesh.has_radial_strain:
            per_state *= 2
        # A state also has the displacements of pieces, and 3 more numbers: `when`,
        # `lost`, and the tension of the cell that is more than nodes.
        in_states = 2 * states * (per_state + len(mesh.starts) + 3)
        if not kernels.enabled():
            # Plain Python also needs lists, which take four times the memory of arrays.
            # States are counted twice so far, so 4 more are 3 times as much.
            in_steps += 4.0 * steps * recorded
            in_states *= 3
        # The error names the argument that reduces the larger part.
        if in_steps <= in_states:
            argument = "snapshots"
        else:
            argument = "until"
        require_memory(
            in_steps + in_states,
            argument,
            f"a run of {steps:.4g} steps of {self.step:.3g} s with {states:.4g} states",
            "stop earlier, keep fewer states, or take fewer cells",
        )

    def _choose_states(self, end: int) -> Array:
        """Steps after which states are kept in a run to step `end`, [state].

        They increase from 0 to `end`. They are the chosen steps, if states are kept at
        given times, else one stride apart: `_stride` is doubled, for the rest of the
        run, until there are no more than `_max_states`. In threes, the step before and
        the step after each of them are added.
        """
        if self._chosen_steps is not None:
            wanted = self._chosen_steps[self._chosen_steps <= end].astype(int)
        else:
            while self._bound_states(end) > self._max_states:
                self._stride *= 2
            wanted = np.arange(0, end, self._stride)
        if self._in_threes:
            kept = np.concatenate((wanted - 1, wanted, wanted + 1))
            # The mean of the last state takes the last four states, see
            # `results.grid_velocities`.
            at_end = end - np.arange(4)
        else:
            kept = wanted
            at_end = np.array([end])
        steps = np.union1d(kept, at_end)  # in increasing order, each once
        is_in_run = (steps >= 0) & (steps <= end)
        return np.asarray(steps[is_in_run])

    def _bound_states(self, end: int) -> int:
        """Upper bound of the number of states kept in a run to step `end`.

        It is the bound for the present stride; the times of the states are not given.
        """
        states = end // self._stride + 2  # 2: those at the start and the end
        # With the stride 1 every state is kept anyway, and threes add none.
        if self._in_threes and self._stride > 1:
            return 3 * states
        return states

    def _empty_history(self, steps: int, states: int) -> StepHistory:
        """Arrays for the records of the kernel over so many steps and states.

        Their values are not set. The arrays of radial strains have 0 columns if no cell
        has a radial strain.
        """
        grid = self.grid
        n = len(self.mesh.mass)  # nodes; there is one cell more
        radial_columns = 0
        if self.mesh.has_radial_strain:
            radial_columns = n + 1
        radial_shape = (states, radial_columns)
        return StepHistory(
            signals=np.empty((steps, len(grid.links)), SIGNAL),
            prescribed=np.empty((steps, 2)),
            velocities=np.empty((steps, len(grid.recorded_nodes))),
            tensions=np.empty((steps, len(grid.recorded_cells))),
            shafts=np.empty((steps, grid.run["shaft_count"][0]), SHAFT_FORCE),
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
        """Run to step `end`.

        `report` is called with the steps taken, about 4 times a second. The grid is
        left in the state after step `end`. `history` is replaced by a new one, in which
        the records and states of the new steps follow the old ones, without the states
        that a wider stride no longer keeps. TooLong is raised if memory is short,
        InvalidModel if walls squeeze a rigid mass.
        """
        if end > self.checked_steps:
            # At least twice the steps, so that this is rarely checked
            self._require_memory(max(end, 2 * self.checked_steps))
        first = self.steps
        when = self._choose_states(end)  # steps of all states to keep, old and new
        # Whether each state kept so far stays [state]
        stays = np.isin(self.history.when, when, assume_unique=True)
        all_stay = bool(stays.all())  # then no copy is needed
        # The old states that stay are the first ones of `when`.
        new_states = when[stays.sum() :]
        window = self._empty_history(end - first, len(new_states))
        window.when[:] = new_states
        for side in (0, 1):
            values = scheme.boundary_values(self.mesh, self.step, side, end)
            window.prescribed[:, side] = values[first:]  # those of the new steps
        self._run_kernel(window, end, report)
        joined = {}
        for name in StepHistory._fields:
            old = getattr(self.history, name)
            if name in STATE_FIELDS and not all_stay:
                old = old[stays]
            joined[name] = record_lists.joined(old, getattr(window, name))
        self.history = StepHistory(**joined)

    def _run_kernel(
        self, window: StepHistory, end: int, report: Callable[[int], None] | None
    ) -> None:
        """Take the steps up to `end`, and fill the window with their records.

        The steps are taken in machine code if compiling pays, judged by the estimated
        time in plain Python. The grid and the window, which begins with the next step,
        are changed in place; for plain Python they are copied to lists and back.
        `report` is called with the number of steps taken, but not after the last step.

        Raises
        ------
        InvalidModel
            If walls squeeze a rigid mass.
        """
        first = self.steps
        # Kernels take flat arrays; these share the memory of the window.
        flat_window = StepHistory(*(array.reshape(-1) for array in window))
        arrays = [*self.grid, *flat_window]
        self.grid.run["first_step"] = first
        self.grid.run["kept_states"] = 0
        # Estimated time in plain Python, s: the steps, and copying all numbers, of 8
        # bytes each, to lists and back
        numbers = sum(array.nbytes for array in arrays) // 8
        plain_seconds = (end - first) * step_time(self.mesh, plain=True)
        plain_seconds += numbers * kernels.LIST_TIME
        is_compiled = kernels.worth_compiling(plain_seconds, grid_kernel.run_steps)
        kernel: Any
        grid: Any = self.grid
        history: Any = flat_window
        if is_compiled:
            kernel = kernels.compiled(grid_kernel.run_steps)
        else:
            kernel = grid_kernel.run_steps
            grid = grid._make(map(record_lists.as_objects, grid))
            history = history._make(map(record_lists.as_objects, history))
        time_of_step = step_time(self.mesh, plain=not is_compiled)
        chunk = max(1, int(REPORT_INTERVAL / time_of_step))  # steps between two reports
        is_solved = True
        # The kernel runs to each of these steps in turn; the last one is `end`.
        for until in (*range(first + chunk, end, chunk), end):
            # After a step that was not solved no further step is taken.
            is_solved = is_solved and kernel(grid, history, until)
            if is_solved and report and until < end:
                report(until)
        if not is_compiled:
            # The lists are in the same order as the arrays.
            lists = [*grid, *history]
            for array, objects in zip(arrays, lists, strict=True):
                array[:] = record_lists.as_records(objects, array.dtype)
        if not is_solved:
            # The kernel has counted the steps taken before the error.
            raise squeezed(self.steps * self.step)

    # Results --------------------------------------------------------------------------

    @property
    def edges(self) -> Array:
        """Times of the ends of steps, in ticks, from 0 on [steps + 1].

        Signals are averages between neighbouring edges.
        """
        return STEP_TICKS * np.arange(self.steps + 1)

    @property
    def times(self) -> Array:
        """Times of `edges`, s."""
        return np.asarray(self.edges * self.clock.tick)

    def motion(self, states: Any = slice(None)) -> GridMotion:
        """The motion in all states that were kept, or in some of them.

        `states` is an index of the states: a slice or a list. The field `pushes` of the
        motion is left empty.
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
        """Recorded values of a field of `SIGNAL` for a contact or joint, [step].

        `link` is its number in the row. Units are those of `SIGNAL`, with time in
        steps. A bond is not recorded and raises ValueError.
        """
        # Column of the link in the records, or ValueError
        column = list(self.mesh.link_nodes).index(link)
        return np.ascontiguousarray(self.history.signals[:, column][field])

    def contact(self, contact: int) -> tuple[Array, Array]:
        """Force and gap of contact number `contact`, which may be a joint.

        A bond raises ValueError.

        Returns
        -------
        array
            Mean force in each step, N [step].
        array
            Gap, or stretch of a joint, at t = 0 and at the ends of steps, m [step + 1].
        """
        link = self.row.contact_link[contact]
        force = self.recorded(link, "force")  # ValueError for a bond
        # m: the grid divides lengths by the step
        gap = self.recorded(link, "gap") * self.step
        first_gap = float(initial_gap(self.row.links[link]))  # at t = 0, m
        return force, np.append(first_gap, gap)

    def force_intervals(self, contact: int) -> Array:
        """Start and end of each force of a contact, and the opening after it, s [n, 3].

        A time that is not reached is nan, see `contact_intervals`. A joint or bond
        cannot open, and has none, [0, 3]. A gap counts as open if it is more than
        `GAP_RESOLUTION` times the distance that bodies move in a step.
        """
        if contact not in self.row.unilateral_links:
            return np.zeros((0, 3))
        open_gap = GAP_RESOLUTION * float(self.row.scale) * self.step
        force, gap = self.contact(contact)
        return self.step * contact_intervals(force, gap, open_gap)

    def force_spans(self, intervals: Array) -> tuple[Array, Array]:
        """Times at which forces of a contact begin, and at which they end, s [n] each.

        `intervals` are its `force_intervals`. A force that still acts at the end of the
        run ends there.
        """
        begins, ends, _ = intervals.T  # openings are not used
        return begins, np.nan_to_num(ends, nan=self.times[-1])

    def velocity(self, node: int) -> Array:
        """Velocity of a recorded node in the frame at step ends, m/s [step + 1].

        The first value is that at t = 0. Any other node raises ValueError.
        """
        column = self.mesh.recorded_nodes.index(node)  # or ValueError
        velocities = self.history.velocities[:, column]
        at_start = self.history.velocity[:1, node]  # the first state is that at t = 0
        return np.concatenate((at_start, velocities))

    def mass_velocity(self, mass: int) -> Array:
        """Velocity of a mass or wall in the frame at the ends of steps, m/s [step + 1].

        The first value is that at t = 0. `mass` is the index of one of the n rigid
        masses of the row, or n for its left and n + 1 for its right wall. Relative to
        the falling frame, a wall is accelerated.
        """
        side = mass - len(self.row.masses)  # 0 or 1 for a wall, negative for a mass
        if side < 0:
            return self.velocity(self.mesh.node_of_mass[mass])
        _, wall_velocity = self.row.boundaries[side]
        at_start = float(wall_velocity) - self.row.frame
        return np.asarray(at_start - self.row.system.gravity * self.times)

    def bond_force(self, link: int) -> Array:
        """Mean force in a bonded link of `mesh.bonds` in each step, N [step].

        A compressive force is positive. It follows from Newton's law for the half cell
        of the rod next to the link. With sign 1 for a rod on the left of the link and
        -1 for a rod on its right, F = -tension - sign (m/2 dv/dt - force of the soil),
        where m is the mass of the cell, v the velocity of the node of the link, and the
        tension that of the cell. A link that is not in `mesh.bonds` raises KeyError.
        """
        mesh = self.mesh
        node, cell = mesh.bonds[link]
        if cell == node:  # cell i is on the left of node i
            sign = 1
        else:
            sign = -1
        v = self.velocity(node)
        other_v = self.velocity(node - sign)  # at the other node of the cell
        # Velocity of the right node minus that of the left node, m/s [step + 1]: at
        # t = 0 and at the ends of steps. `other_v` is on the left for sign 1.
        stretch_rate = sign * (v - other_v)
        # The mean tension of a step has three parts: an elastic one, a viscous one by
        # the rate before the step, and one by the change of the rate in the step. The
        # factor of this change is J/h + D/2, kg/s, with the lateral inertia J and the
        # viscosity D of the cell, and the step h.
        elastic = self.history.tensions[:, mesh.recorded_cells.index(cell)]
        viscous = mesh.viscous[cell] * stretch_rate[:-1]  # the rates before the steps
        coupling = scheme.off_diagonal_of(mesh, self.step)[cell]
        by_change = coupling * np.diff(stretch_rate)
        tension = elastic + viscous + by_change
        # m/2 dv/dt, for the half of the cell that belongs to the node
        momentum_rate = mesh.cell_mass[cell] / 2 / self.step * np.diff(v)
        soil = self._soil_at_end(node, sign)
        return np.asarray(-tension - sign * (momentum_rate - soil))

    def recorded_soil(self, shaft: int, field: str) -> Array:
        """Recorded values of a field of `SHAFT_FORCE` for a rod in soil, [step].

        `shaft` is the index of the rod in `shaft_bodies`.
        """
        return np.ascontiguousarray(self.history.shafts[:, shaft][field])

    def _soil_forces(self, fields: dict[str, Array]) -> Array:
        """Force of the soil to the right in some states, N [state, node in soil].

        `fields` has the `STATE_FIELDS` of these states, by name. The force is
        -(R + c v) with the static resistance R, the velocity v relative to the ground,
        and the damping c, which is J abs(R) by Smith's law and constant otherwise.
        """
        soil = self.grid.soil
        t = fields["when"][:, None] * self.step  # s [state, 1]
        in_frame = fields["velocity"][:, soil["node"]]
        # The ground rests in the laboratory, in which the frame moves and falls.
        velocity = in_frame + self.row.frame + self.row.system.gravity * t
        resistance = fields["resistance"]
        by_smith = soil["damping_factor"] * np.abs(resistance)
        damping = np.where(soil["is_smith"], by_smith, soil["damping"])
        return np.asarray(-resistance - damping * velocity)

    def _soil_at_end(self, node: int, sign: int) -> Array:
        """Mean force of the soil on the half cell at an end of a rod, N [step].

        A force to the right is positive. With `sign` 1 it is the force at the right end
        of the rod whose last node is `node`, with `sign` -1 that at the left end of the
        rod whose first node is `node`. It is 0 if this rod has no soil.
        """
        for shaft, body in enumerate(shaft_bodies(self.row)):
            first, last = self.row.spans[body]  # segments of the rod
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
        """Overshoot of the peak force of rigid contacts, relative to this peak.

        The overshoot is the peak of the means over one step minus the peak of the means
        over `OVERSHOOT_STEPS` steps, at least 0. Beside a jump waves on a grid
        overshoot by a fraction that no finer mesh reduces; means over several steps do
        not. The largest overshoot and the largest peak among all rigid contacts count,
        even if they belong to two contacts. The result is 0 without rigid contacts, or
        if they have no forces.
        """
        largest_peak = 0.0
        largest_excess = 0.0
        for contact, link in self.row.unilateral_links.items():
            if self.row.links[link].law != Law.RIGID:
                continue
            force, _ = self.contact(contact)
            # Means over the last OVERSHOOT_STEPS steps up to each step, [step]. They
            # are differences of cumulative sums; the zeros are sums before t = 0.
            sums = np.concatenate((np.zeros(OVERSHOOT_STEPS), np.cumsum(force)))
            means = (sums[OVERSHOOT_STEPS:] - sums[:-OVERSHOOT_STEPS]) / OVERSHOOT_STEPS
            peak = largest_force(force)
            excess = peak - float(means.max(initial=0.0))
            largest_peak = max(largest_peak, peak)
            largest_excess = max(largest_excess, excess)
        if largest_peak == 0:
            return largest_excess  # 0, too
        return largest_excess / largest_peak

    @property
    def peak_error(self) -> float:
        """Relative error of the peak force that no finer mesh reduces.

        It is twice the `overshoot`, but inf if the row has contacts of flat ends and
        any rod is damped or has lateral inertia: there any finer mesh finds a larger
        force.
        """
        mesh = self.mesh
        is_damped = bool(mesh.viscous.any())
        is_dispersive = mesh.lateral_inertia.any() or mesh.has_radial_strain
        has_flat_ends = any(link.law == Law.RIGID for link in self.row.links)
        if has_flat_ends and (is_damped or is_dispersive):
            return math.inf
        return 2 * float(self.overshoot)


def step_time(mesh: Mesh, *, plain: bool) -> float:
    """Approximate computing time of one step of a mesh, s.

    The step is taken in plain Python if `plain`, else in machine code. Its time is that
    of an empty step plus a time for each node and its cell. The latter is doubled by
    radial strains, and is several times as long if equations couple the nodes.
    """
    if plain:
        of_step = PLAIN_STEP_TIME
        of_cell = PLAIN_CELL_TIME
        of_equations = 2  # relative to the time of the explicit part
    else:
        of_step = STEP_TIME
        of_cell = CELL_TIME
        of_equations = 6
    factor = 1  # time of a cell relative to that in an explicit step
    if mesh.has_radial_strain:  # radial strains take as long as the nodes
        factor += 1
    if mesh.couples_nodes:  # equations are solved
        factor += of_equations
    nodes = len(mesh.mass)  # there is one cell more, which does not matter
    return of_step + nodes * factor * of_cell


def clock_on(mesh: Mesh, step: float) -> Clock:
    """Clock of a mesh with steps of `step`, s, each of which has `STEP_TICKS` ticks.

    Transit times are the exact ones of the segments, rounded to ticks and at least 1
    tick; they are not multiples of the step. The impedance of a segment is its mass
    divided by its transit time, a mean over its length.
    """
    row = mesh.row
    tick = step / STEP_TICKS  # s
    transits = []  # ticks, by segment
    impedances = [0.0]  # kg/s, by segment; the first 0 is that of the outside
    for s, segment in enumerate(row.segments, start=1):
        transit = max(1, round(float(segment.transit_time) / tick))
        # Cell i is on the left of node i, so the first cell of the segment has the
        # index of its second node.
        cells = slice(mesh.first[s] + 1, mesh.last[s] + 1)
        mass = float(mesh.cell_mass[cells].sum())
        transits.append(transit)
        impedances.append(mass / (transit * tick))
    return clock_of(
        row,
        transits,
        tick,
        impedance=[*impedances, 0.0],  # the last 0 is that of the outside, too
        scale=row.scale,
        is_mesh=True,
    )
