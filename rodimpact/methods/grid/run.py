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
CELL_TIME = 7e-10
"""Time of an explicit step of a cell in machine code, s."""
STEP_TIME = 3e-7
"""Time of such a step beside that of its cells, with the results made of it, s."""
PLAIN_CELL_TIME = 8e-7
"""Time of an explicit step of a cell in plain Python, s."""
PLAIN_STEP_TIME = 1e-5
"""Time of such a step beside that of its cells, with the results made of it, s."""


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
        """Make the grid in its state at t = 0, which is kept; no step is taken.

        `snapshots` or the memory that states may take decides how many are kept. Memory
        is checked for `expected_steps`, or for four round trips; TooLong is raised if
        it is short. After the state at t = 0 is kept, contacts that close at once slow
        down the velocities of damped rods.
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
        # What this returns is not used: it sets the stride of states, so that few are
        # kept in vain.
        self._choose_states(self.checked_steps)
        self.grid = scheme.grid_of(mesh, step)
        kick = start.begin(mesh, step, self.grid)
        self.history = self._empty_history(steps=0, states=0)
        self.advance(0)  # no step, but the state at t = 0 is kept
        start.slow_down(mesh, step, self.grid, kick)

    def _plan_states(self, snapshots: int | tuple[float, ...] | None) -> None:
        """Set how many states are kept at most, after which steps, and if in threes.

        `snapshots` is the number of all states, 3 at least, or their times, s, beside
        which states are kept at the step ends before and after. Without it (None or 0)
        the number follows from the memory that states may take, and is 64 at least. In
        threes, a state is kept with those one step before and after, to be smoothed:
        states of damped rods are, if there may be `MIN_STATES_IN_THREES` or more.
        `_stride`, `_chosen_steps`, `_max_states` and `_in_threes` are set.
        """
        mesh = self.mesh
        self._stride = 1  # steps between two states, where none are chosen
        # Steps after which states are kept; None where they are not chosen
        self._chosen_steps: Array | None = None
        if snapshots is None or isinstance(snapshots, int):
            # Two numbers of 8 bytes a node and its cell,
            # twice as many with radial strains
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
            self._max_states = 3 * len(self._chosen_steps)  # if they are in threes
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
        """Raise TooLong if a run of so many steps takes too much memory.

        What it takes is estimated in numbers of 8 bytes: records of the steps with the
        results made of them, and states that are kept. `checked_steps` becomes `steps`.
        """
        mesh = self.mesh
        row = self.row
        states = min(steps, self._max_states) + 2.0
        self.checked_steps = steps
        # Numbers of a step that the kernel records: three a link, one an end, a watched
        # node and a cell
        recorded = 3 * len(mesh.touching) + 2 + len(mesh.watched) + len(mesh.pulled)
        # Numbers of a step that are made of them: force, gap, path, rate and power of a
        # contact with their integrals; those of masses; those of ends, and times
        results = 10 * len(row.contact_link) + 5 * len(row.masses) + 26
        # Records are there twice while they are joined.
        in_steps = steps * (2.0 * recorded + results)
        # So are states, while they are joined or fields are made of them.
        per_state = 2 * len(mesh.mass)
        if mesh.has_radial_strain:
            per_state *= 2
        in_states = 2 * states * (per_state + len(mesh.starts) + 3)
        if not kernels.enabled():
            # Lists take four times the memory of arrays, and stand beside them.
            in_steps += 4.0 * steps * recorded
            in_states *= 3
        # The argument that the error names: that of the larger part
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

        They increase, from 0 to `end`, the last state. They are the chosen steps, or a
        stride apart: `_stride` is doubled, for good, until there are no more than
        wanted. In threes each comes with the step before and the step after it.
        """
        if self._chosen_steps is not None:
            wanted = self._chosen_steps[self._chosen_steps <= end].astype(int)
        else:
            while self._bound_states(end) > self._max_states:
                self._stride *= 2
            wanted = np.arange(0, end, self._stride)
        if self._in_threes:
            kept = np.concatenate((wanted - 1, wanted, wanted + 1))
            last = end - np.arange(4)  # a three at the end, too, and one step more
        else:
            kept = wanted
            last = np.array([end])
        steps = np.union1d(kept, last)  # in order, each once
        is_in_run = (steps >= 0) & (steps <= end)
        return np.asarray(steps[is_in_run])

    def _bound_states(self, end: int) -> int:
        """Upper bound of the number of states kept in a run to step `end`.

        It is that with the present stride, where no steps are chosen.
        """
        states = end // self._stride + 2
        # With the stride 1 each step is kept anyway, and threes add none.
        if self._in_threes and self._stride > 1:
            return 3 * states
        return states

    def _empty_history(self, steps: int, states: int) -> StepHistory:
        """Arrays for the records of the kernel over so many steps and states.

        Their numbers are arbitrary. Those of radial strains have 0 columns where no
        cell has its own.
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

        The grid is left in the state at the end, and `history` becomes a new one: the
        records and kept states of the new steps are joined to the old, without the
        states that a wider stride no longer wants. TooLong is raised if memory is
        short, InvalidModel if walls squeeze a rigid mass.
        """
        if end > self.checked_steps:
            self._require_memory(max(end, 2 * self.checked_steps))
        first = self.steps
        when = self._choose_states(end)  # steps of all states, also of those kept
        # Which of the states kept so far are wanted still [state]
        still_wanted = np.isin(self.history.when, when, assume_unique=True)
        all_wanted = bool(still_wanted.all())  # then no copy is needed
        # The states that are still wanted are the first ones of `when`.
        new_states = when[still_wanted.sum() :]
        window = self._empty_history(end - first, len(new_states))
        window.when[:] = new_states
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
        """Take the steps to `end`, and fill the window with their records.

        The steps are taken in machine code if that pays, by the estimated time of plain
        Python. The grid and the window, for the steps from the present one on, are
        changed in place; in plain Python lists are made of them, and copied back.
        `report` is told the steps taken, but not the last.

        Raises
        ------
        InvalidModel
            If walls squeeze a rigid mass.
        """
        first = self.steps
        # Kernels take flat arrays: these share the memory of the window.
        flat_window = StepHistory(*(array.reshape(-1) for array in window))
        records = [*self.grid, *flat_window]  # arrays
        self.grid.run["first_step"] = first
        self.grid.run["kept_states"] = 0
        # Time that the steps take in plain Python, with making and copying lists, s
        numbers = sum(array.nbytes for array in records) // 8
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
        # The kernel goes on to each of these steps in turn, the last one is `end`.
        for until in (*range(first + chunk, end, chunk), end):
            is_solved = is_solved and kernel(grid, history, until)
            if is_solved and report and until < end:
                report(until)
        if not is_compiled:
            # The lists stand in the order of the arrays that they were made of.
            lists = [*grid, *history]
            for array, objects in zip(records, lists, strict=True):
                array[:] = record_lists.as_records(objects, array.dtype)
        if not is_solved:
            # `steps` reads the record in which the kernel has counted.
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

        `states` is an index of states: a slice or a list. `pushes` of the motion, from
        outside pieces, are left empty.
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

        Time is in steps. A bond has no law, and raises ValueError.
        """
        # Number of the link in the grid, or ValueError
        column = list(self.mesh.touching).index(link)
        return np.ascontiguousarray(self.history.signals[:, column][field])

    def contact(self, contact: int) -> tuple[Array, Array]:
        """Force and gap of a contact or a joint; a bond raises ValueError.

        Returns
        -------
        array
            Mean force in each step, N [step].
        array
            Gap, or stretch of a joint, at the ends of steps from t = 0 on, m
            [step + 1].
        """
        link = self.row.contact_link[contact]
        force = self.recorded(link, "force")  # a bond has none: ValueError
        gap = self.recorded(link, "gap") * self.step  # the grid divides lengths by it
        first_gap = float(initial_gap(self.row.links[link]))  # at t = 0, m
        return force, np.append(first_gap, gap)

    def force_intervals(self, contact: int) -> Array:
        """Begin and end of each force of a contact, and the opening after it, s [n, 3].

        A time that does not come is nan, see `contact_intervals`. There are none,
        [0, 3], for a joint or bond, which cannot open. A gap counts as open if it is
        more than `GAP_RESOLUTION` times the way that bodies go in a step.
        """
        if contact not in self.row.unilateral_links:
            return np.zeros((0, 3))
        open_gap = GAP_RESOLUTION * float(self.row.scale) * self.step
        force, gap = self.contact(contact)
        return self.step * contact_intervals(force, gap, open_gap)

    def force_spans(self, intervals: Array) -> tuple[Array, Array]:
        """Times at which forces of a contact begin, and at which they end, s [n] each.

        `intervals` are its `force_intervals`. A force that still acts at the end of the
        run ends with it.
        """
        begins, ends, _ = intervals.T
        return begins, np.nan_to_num(ends, nan=self.times[-1])

    def velocity(self, node: int) -> Array:
        """Velocity of a watched node in the frame at the ends of steps, m/s [step + 1].

        The first one is at t = 0. Other nodes raise ValueError.
        """
        column = self.mesh.watched.index(node)  # ValueError if it is not watched
        velocities = self.history.velocities[:, column]
        return np.concatenate((self.history.velocity[:1, node], velocities))

    def mass_velocity(self, mass: int) -> Array:
        """Velocity of a mass in the frame at the ends of steps, m/s [step + 1].

        The first one is at t = 0. `mass` is a number of the row's masses, or their
        number plus 0 or 1: its left or right wall, which the falling frame passes.
        """
        side = mass - len(self.row.masses)
        if side < 0:
            return self.velocity(self.mesh.node_of_mass[mass])
        _, wall_velocity = self.row.boundaries[side]
        at_start = float(wall_velocity) - self.row.frame
        return np.asarray(at_start - self.row.system.gravity * self.times)

    def bond_force(self, link: int) -> Array:
        """Mean force in a bonded link, whose force is recorded, in each step, N [step].

        A force > 0 presses. It follows from Newton's law for the half cell of the rod
        between the link and a cell. With sign 1 for a rod on the left of the link and
        -1 on its right, F = -tension - sign (m/2 dv/dt - force of the soil).
        """
        mesh = self.mesh
        node, cell = mesh.bonds[link]
        if cell == node:  # cell i lies on the left of node i
            sign = 1
        else:
            sign = -1
        v = self.velocity(node)
        other_v = self.velocity(node - sign)  # at the other node of the cell
        stretch_rate = sign * (v - other_v)  # at the ends of steps, m/s
        # The tension is elastic, viscous by the velocities before the step, and
        # implicit by their change in it: of lateral inertia and half of the viscosity.
        elastic = self.history.tensions[:, mesh.pulled.index(cell)]
        viscous = mesh.viscous[cell] * stretch_rate[:-1]
        coupling = scheme.off_diagonal_of(mesh, self.step)[cell]  # J/h + D/2, kg/s
        implicit = coupling * np.diff(stretch_rate)
        tension = elastic + viscous + implicit
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

        `fields` has the `STATE_FIELDS` of these states, by name. The force is
        -(R + c v), R the static resistance, v the velocity against the ground, and the
        damping c = J abs(R) by Smith's law, else a constant.
        """
        soil = self.grid.soil
        t = fields["when"][:, None] * self.step  # [state, 1]
        in_frame = fields["velocity"][:, soil["node"]]
        # The ground rests in the laboratory, in which the frame moves and falls.
        velocity = in_frame + self.row.frame + self.row.system.gravity * t
        resistance = fields["resistance"]
        by_smith = soil["damping_factor"] * np.abs(resistance)
        damping = np.where(soil["is_smith"], by_smith, soil["damping"])
        return np.asarray(-resistance - damping * velocity)

    def _soil_at_end(self, node: int, sign: int) -> Array:
        """Mean force of the soil on the half cell at an end of a rod, N [step].

        It acts to the right. The end is the right (`sign` = 1) or left (-1) one of the
        rod that has `node` there. It is 0 where no soil holds this rod.
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
        """Overshoot of the peak force of rigid contacts, over this peak.

        The overshoot is the peak of the step means less the peak of the means over
        `OVERSHOOT_STEPS`, 0 at least: beside a jump waves on a grid overshoot by a
        share that no finer mesh makes less; averages over a few steps do not. It and
        the peak are the largest among all rigid contacts, which need not be of one
        contact. 0 without such contacts, or without forces in them.
        """
        largest_peak = 0.0
        largest_excess = 0.0
        for contact, link in self.row.unilateral_links.items():
            if self.row.links[link].law != Law.RIGID:
                continue
            force, _ = self.contact(contact)
            # Means over the last few steps up to each step, [step], the force being 0
            # before t = 0: differences of sums that are so many steps apart
            sums = np.concatenate((np.zeros(OVERSHOOT_STEPS), np.cumsum(force)))
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

        It is twice the `overshoot`, but inf where flat ends of damped rods, or of rods
        with lateral inertia, may meet: any finer mesh finds a larger force.
        """
        mesh = self.mesh
        is_dispersive = mesh.lateral_inertia.any() or mesh.has_radial_strain
        has_flat_ends = any(link.law == Law.RIGID for link in self.row.links)
        if has_flat_ends and (mesh.viscous.any() or is_dispersive):
            return math.inf
        return 2 * float(self.overshoot)


def step_time(mesh: Mesh, *, plain: bool) -> float:
    """Approximate time that the computer takes for a step of a mesh, s.

    The step is taken in plain Python, or else in machine code.
    """
    if plain:
        of_step = PLAIN_STEP_TIME
        of_cell = PLAIN_CELL_TIME
        of_equations = 2  # times as long as the rest of a cell
    else:
        of_step = STEP_TIME
        of_cell = CELL_TIME
        of_equations = 6
    explicit_steps = 1  # that take as long for a cell
    if mesh.has_radial_strain:  # radial strains take as long as the nodes
        explicit_steps += 1
    if mesh.implicit:
        explicit_steps += of_equations
    return of_step + len(mesh.mass) * explicit_steps * of_cell


def clock_on(mesh: Mesh, step: float) -> Clock:
    """Clock of a mesh with steps of `step`, s, each of which has `STEP_TICKS` ticks.

    Transit times are those of the segments, rounded to ticks, 1 at least; they are not
    those of their cells. Impedances of segments are means: the mass over the transit
    time.
    """
    row = mesh.row
    tick = step / STEP_TICKS  # s
    transits = []  # ticks, by segment
    impedances = [0.0]  # kg/s, by segment; 0 is that of the outside
    for s, segment in enumerate(row.segments, start=1):
        transit = max(1, round(float(segment.transit_time) / tick))
        # Cell i lies on the left of node i: the first one of this segment lies between
        # its first node and the next.
        cells = slice(mesh.first[s] + 1, mesh.last[s] + 1)
        mass = float(mesh.cell_mass[cells].sum())
        transits.append(transit)
        impedances.append(mass / (transit * tick))
    return clock_of(
        row,
        transits,
        tick,
        impedance=[*impedances, 0.0],
        scale=row.scale,
        is_mesh=True,
    )
