"""Fields from states of a grid: velocities of nodes and strains of cells at some times.

Fields are interpolated linearly between nodes, between the middles of cells, and
between two states. `grid_strains` gives the strains at the ends of segments.

Energies are those that the scheme conserves: the kinetic energy is less than that of
the nodes by a term in the square of the time step, see `GridMotion.energies`. Neither
kinetic nor strain energy is negative.
"""

from collections.abc import Iterator
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..methods.grid.measures import largest_force
from ..methods.grid.mesh import STEP_TICKS, GridMotion
from ..methods.grid.soil import shaft_bodies
from ..methods.run import BoundaryAction
from ..methods.signals import Floats, Ints, Pieces, Side
from ..model import Segment, Steps
from .extreme_stress import ExtremeStress, StressPeak, strongest
from .fields import Fields, PassingWaves, Profile, RodEnergy
from .grid_strains import (
    cell_states,
    cell_strains,
    end_areas,
    moduli,
    segment_strain,
)
from .grid_velocities import node_velocities


class Table(NamedTuple):
    """Values of a field of a rod at the states."""

    places: Floats  # m from the left end of the rod [point]; twice where a field jumps
    values: Floats  # [state, point]


class StrainTables(NamedTuple):
    """Strains of the rods, by body."""

    strain: dict[int, Table]
    rate: dict[int, Table]  # 1/s


class Span(NamedTuple):
    """The nodes and the cells of a rod in the mesh of the row."""

    nodes: slice
    cells: slice
    mass: Floats  # masses of the nodes that belong to the rod, kg [node of the rod]


class LoadedEnd(NamedTuple):
    """An end of a rod, and the force on it."""

    segment: Segment
    x: float  # m from the left end of the rod
    area: float  # m^2
    push: Floats | None  # mean force in each step, N [step]; None at a free end


class SoilAtNodes(NamedTuple):
    """Soil along a rod, divided among its nodes, [node of the rod]."""

    places: Floats  # of the nodes, m from the left end of the rod
    ultimate: Floats  # ultimate resistance, N
    mobilised: Floats  # static over ultimate resistance, from -1 to 1


class GridFields(Fields):
    """Fields of a row from its states on a grid.

    Parameters
    ----------
    clock : Clock
    end : int
        Last tick.
    signals : Signals
        Signals with a `GridMotion`.
    """

    motion: GridMotion
    resolution = STEP_TICKS

    @cached_property
    def state_ticks(self) -> Ints:
        """Increasing ticks of the states. Energies are only known at these ticks."""
        return np.asarray(self.motion.when * STEP_TICKS)

    def nearest_energy_ticks(self, ticks: Ints) -> Ints:
        """For each tick, the tick of the nearest state; of two such, the later one."""
        states = self.state_ticks
        # The nearest state changes half way between two states.
        middles = (states[1:] + states[:-1]) / 2
        return states[np.searchsorted(middles, ticks, side="right")]

    # Between states and between nodes -------------------------------------------------

    def _between_states(self, values: Floats, columns: Any, ticks: Ints) -> Floats:
        """Interpolate values [state, column] linearly in time, to ticks.

        `columns`, whole numbers or a slice, selects columns; columns and ticks
        broadcast. The values of the last state are also those of later ticks.
        """
        states = self.state_ticks
        last = len(states) - 1
        if last == 0:  # nothing moves: state 0 is the only one
            return np.asarray(values[np.zeros_like(ticks), columns])
        # Index of the state at or before a tick. It is at most last - 1, so that there
        # is a state after it.
        before = np.searchsorted(states, ticks, side="right") - 1
        before = np.clip(before, 0, last - 1)
        after = before + 1
        duration = states[after] - states[before]
        # Fraction of the time between both states that has passed; 1 after the last one
        share = np.minimum((ticks - states[before]) / duration, 1.0)
        value_before = values[before, columns]
        value_after = values[after, columns]
        return np.asarray(value_before * (1 - share) + value_after * share)

    def _interpolated(self, body: int, x: Floats, ticks: Ints, table: Table) -> Floats:
        """Interpolate a table linearly in space and time, to x of a rod, m, and ticks.

        x and ticks broadcast. At a jump in space the value on the right is returned.
        ValueError if x is outside of the rod, or if the shapes do not broadcast.
        """
        location = self.locate(body, x)  # raises for places outside
        self._broadcast_shape(location.segment, ticks)  # raises for wrong shapes
        places = table.places
        # Index of the table's place at or left of x. At a jump there are two equal
        # places; side="right" takes the second one.
        left = np.searchsorted(places, x, side="right") - 1
        left = np.clip(left, 0, len(places) - 2)
        distance = places[left + 1] - places[left]
        # At most 1, since x may exceed the last place by round-off
        share = np.minimum((x - places[left]) / distance, 1.0)
        value_left = self._between_states(table.values, left, ticks)
        value_right = self._between_states(table.values, left + 1, ticks)
        return np.asarray(value_left * (1 - share) + value_right * share)

    # The mesh of a rod ----------------------------------------------------------------

    def _segment_places(self, body: int) -> list[Floats]:
        """Places of the nodes of a rod by segment, m, [segment][node].

        They are measured from the left end of the rod. The last place of a segment is
        the first one of the next segment, since they share a node.
        """
        first, last = self.clock.spans[body]  # segments in the row, counted from 1
        # Segment 1 has the index 0 in `counts`.
        cell_counts = self.motion.counts[first - 1 : last]
        edges = self.edges(body)
        places = []
        for i, cell_count in enumerate(cell_counts):
            left = edges[i]
            right = edges[i + 1]
            nodes = np.linspace(left, right, cell_count + 1)
            places.append(nodes)
        return places

    def _node_places(self, body: int) -> Floats:
        """Places of the nodes of a rod, m from its left end, [node of the rod].

        A node that two segments share has one entry.
        """
        return np.unique(np.concatenate(self._segment_places(body)))

    def _span(self, body: int) -> Span:
        """The part of the mesh that is a rod: its nodes and cells, and masses of nodes.

        The mass of a node is that of the adjacent halves of the rod's own cells, kg. A
        body that is bonded to an end of the rod adds nothing to it.
        """
        # Segments in the row, counted from 1.
        first_segment, last_segment = self.clock.spans[body]
        # Segment 1 has the index 1 in these lists of the nodes at its ends.
        first_node = self.motion.first[first_segment]
        last_node = self.motion.last[last_segment]
        nodes = slice(first_node, last_node + 1)
        cells = slice(first_node + 1, last_node + 1)  # cell n lies left of node n
        half = self.motion.cells.cell_mass[cells] / 2
        # A node has half of the cell on its right, and half of that on its left.
        mass = np.append(half, 0.0) + np.append(0.0, half)
        return Span(nodes, cells, mass)

    # Tables of fields -----------------------------------------------------------------

    @cached_property
    def _node_velocity(self) -> Floats:
        """Velocities of the nodes in the frame, m/s [state, node]."""
        return node_velocities(self.motion)

    @cached_property
    def _velocity_tables(self) -> dict[int, Table]:
        """Velocities at the nodes of each rod in the frame, m/s, by body."""
        tables = {}
        for body in self.rods:
            velocities = self._node_velocity[:, self._span(body).nodes]
            tables[body] = Table(self._node_places(body), velocities)
        return tables

    @cached_property
    def _cell_strain(self) -> Floats:
        """Strains of all cells [state, cell]."""
        return cell_strains(self.motion, self.step)

    @cached_property
    def _strain_tables(self) -> StrainTables:
        """Strains of each rod, and their rates, 1/s, by body.

        Places are the two ends of each segment and the middles of its cells, so that
        the border of two segments occurs twice. In cells, the rates are differences of
        node velocities over the width, and not derivatives of the strains over time.
        """
        cells = cell_states(self.motion, self._cell_strain, self._node_velocity)
        strains = {}
        rates = {}
        for body, rod in self.rods.items():
            first, _ = self.clock.spans[body]  # segment in the row, counted from 1
            places = []
            strain = []
            rate = []
            for i, nodes in enumerate(self._segment_places(body)):
                middles = (nodes[1:] + nodes[:-1]) / 2
                # The slices are arrays of one entry: the two ends of the segment.
                places += [nodes[:1], middles, nodes[-1:]]
                # [state, point], with the points at these places
                in_segment = segment_strain(
                    self.motion,
                    cells,
                    number=first + i,
                    segment=rod.segments[i],
                    step=self.step,
                )
                strain.append(in_segment.strain)
                rate.append(in_segment.rate)
            all_places = np.concatenate(places)
            strains[body] = Table(all_places, np.concatenate(strain, axis=-1))
            rates[body] = Table(all_places, np.concatenate(rate, axis=-1))
        return StrainTables(strains, rates)

    @cached_property
    def _displacement_tables(self) -> dict[int, Table]:
        """Displacements of the nodes of each rod in the frame, m, by body.

        Displacements are relative to the unstrained rod whose left end is where it is
        at t = 0. With the elongation s of all cells up to a node, node n has
        u(n) = u(l) + s(n) - s(l), where l is the left end of the rod. The left end has
        u(l) = u(f) + growth of (s(l) - s(f)) since t = 0, where f is the first node of
        the bonded bodies to which the rod belongs.
        """
        motion = self.motion
        # Cell n lies left of node n; the cell right of the last node is left out.
        elongation = self._cell_strain[:, :-1] * motion.cells.width[:-1]
        stretch = np.cumsum(elongation, axis=1)  # s, m [state, node]
        tables = {}
        for body in self.rods:
            nodes = self._span(body).nodes
            # A piece is the mesh of bonded bodies, and begins with the node f.
            piece = int(np.searchsorted(motion.starts, nodes.start, side="right")) - 1
            stretch_at_left = stretch[:, nodes.start]
            stretch_in_piece = stretch_at_left - stretch[:, motion.starts[piece]]
            # The motion holds it in m/s times steps; the factor is s per step.
            u_first = motion.displacement[:, piece] * self.step  # u(f), [state]
            # Entry 0 is the state at t = 0.
            u_left = u_first + stretch_in_piece - stretch_in_piece[0]
            u_less_stretch = u_left - stretch_at_left  # u(l) - s(l)
            displacement = stretch[:, nodes] + u_less_stretch[:, None]
            tables[body] = Table(self._node_places(body), displacement)
        return tables

    # Fields ---------------------------------------------------------------------------

    def rod_velocity(
        self,
        body: int,
        x: Floats,
        ticks: Ints,
        side: Side,  # noqa: ARG002
    ) -> Floats:
        """Velocity, m/s: velocity in the frame plus velocity of the frame at t = 0.

        The velocity g t by gravity is left out. x, m, and ticks broadcast. Values have
        no jumps in time, so that both sides are the same.
        """
        in_frame = self._interpolated(body, x, ticks, self._velocity_tables[body])
        return in_frame + self.clock.frame

    def rod_strain(
        self,
        body: int,
        x: Floats,
        ticks: Ints,
        side: Side,  # noqa: ARG002
    ) -> Floats:
        """Strain, positive in tension; x, m, and ticks broadcast.

        The strain has no jumps in time, so that both sides are the same. At the border
        of two segments the strain of the right one is returned.
        """
        return self._interpolated(body, x, ticks, self._strain_tables.strain[body])

    def rod_strain_rate(self, body: int, x: Floats, ticks: Ints) -> Floats:
        """Strain rate, 1/s; x, m, and ticks broadcast."""
        return self._interpolated(body, x, ticks, self._strain_tables.rate[body])

    def rod_displacement(self, body: int, x: Floats, ticks: Ints) -> Floats:
        """Displacement, m: in the frame, plus that of the frame without gravity.

        x, m, and ticks broadcast.
        """
        in_frame = self._interpolated(body, x, ticks, self._displacement_tables[body])
        return in_frame + self.clock.frame * (ticks * self.clock.tick)

    def strain_integral(self, body: int, x: Floats, ticks: Ints) -> Floats:
        """Integral of the strain from t = 0 to each tick, [point, tick], in ticks.

        x, m, is [point], and `ticks` is [tick]. Between states the strain changes
        linearly.
        """
        states = self.state_ticks
        table = self._strain_tables.strain[body]
        strains = self._interpolated(body, x[:, None], states, table)  # [point, state]
        integrals = []
        for at_point in strains:
            lines = Pieces.through(states, at_point)
            integrals.append(lines.integral(0, ticks))
        return np.array(integrals)

    def point_history(self, body: int, x: float) -> PassingWaves:
        """The waves A = v - c strain and B = v + c strain at the point x, m.

        The waves and the velocity v are in m/s, in the frame of the clock. Velocity and
        strain are interpolated to the point in every state, and the waves change
        linearly between states. At the border of two segments the strain and the wave
        speed c are those of the right one.
        """
        segment = int(self.locate(body, x).segment)
        c = self.clock.wave_speed[segment]
        ticks = self.state_ticks
        point = np.asarray(x)
        # Both are [state], at the ticks of the states.
        v = self._interpolated(body, point, ticks, self._velocity_tables[body])
        strain_table = self._strain_tables.strain[body]
        strain = self._interpolated(body, point, ticks, strain_table)
        c_strain = c * strain
        return PassingWaves(
            rightward=Pieces.through(ticks, v - c_strain),
            leftward=Pieces.through(ticks, v + c_strain),
            # This is B - A without the round-off of a difference.
            difference=Pieces.through(ticks, 2 * c_strain),
            wave_speed=c,
        )

    # Integrals over bodies ------------------------------------------------------------

    def momentum(self, body: int, t: ArrayLike) -> Floats:
        """Momentum of a rod at times t in s, kg m/s: sum of m v over its nodes.

        The sum in the frame is interpolated between states. The momentum of the rod's
        mass at the velocity of the frame, gravity included, is added.
        """
        span = self._span(body)
        # Not a matrix product, whose round-off depends on the number of states
        node_momenta = self.motion.velocity[:, span.nodes] * span.mass
        momenta = node_momenta.sum(axis=1)  # [state]
        ticks = self.to_ticks(t)
        only_column = 0
        in_frame = self._between_states(momenta[:, None], only_column, ticks)
        frame_velocity = self.clock.frame + self._fall_velocity(ticks)
        return np.asarray(in_frame + span.mass.sum() * frame_velocity)

    def energy(self, body: int, tick: int, velocity: float) -> RodEnergy:
        """Energy of a rod in the state at `tick`, which must be a tick of a state.

        The kinetic energy is relative to `velocity`, m/s in the laboratory. The sum of
        kinetic and strain energy is the energy that the scheme conserves, see
        `GridMotion.energies`.
        """
        clock = self.clock
        span = self._span(body)
        step_number = tick // STEP_TICKS
        # `when` has the step number of each state, in order.
        state = int(np.searchsorted(self.motion.when, step_number))
        in_frame = self.motion.velocity[state, span.nodes]
        # Velocities in the laboratory, minus the given velocity
        v = in_frame + clock.frame + clock.gravity * tick * clock.tick - velocity
        energies = self.motion.energies(span.nodes, span.mass, state, v, self.step)
        return RodEnergy(*energies)  # kinetic, strain

    def viscous_loss(self, ticks: Ints) -> Floats:
        """Energy lost in damped material from t = 0 to each tick, J.

        The ticks must be those of states.
        """
        step_numbers = ticks // STEP_TICKS
        # `when` has the step number of each state, in order.
        states = np.searchsorted(self.motion.when, step_numbers)
        lost = self.motion.lost[states]  # since t = 0, W times steps; `step` is s
        return np.asarray(lost * self.step)

    def mobilised(self, body: int, tick: int) -> Steps | float:
        """Share of the soil's resistance that is mobilised along a rod, at `tick`.

        The result is `Steps` with one value around each node, from the middle of one
        cell to the middle of the next; the number 0 if the soil has no resistance. The
        rod must have soil along its shaft.
        """
        soil = self.soil_at_nodes(body, tick)
        if not soil.ultimate.any():
            return 0.0
        middles = []  # of the cells, m
        for nodes in self._segment_places(body):
            middles.append((nodes[1:] + nodes[:-1]) / 2)
        return Steps(soil.mobilised.tolist(), np.concatenate(middles).tolist())

    def soil_at_nodes(self, body: int, tick: int) -> SoilAtNodes:
        """Soil around each node of a rod at `tick`, interpolated between states.

        The mobilised share is the static resistance over the ultimate one, from -1 to
        1. Share and ultimate resistance are 0 at a node without soil. ValueError for a
        rod without soil or drag.
        """
        soil = self.motion.soil  # a record for each node of a rod with soil or drag
        nodes = self._span(body).nodes
        shaft = shaft_bodies(self.clock.row).index(body)  # index among these rods
        columns = np.flatnonzero(soil["shaft"] == shaft)  # records of this rod
        held = soil["node"][columns] - nodes.start  # their nodes, by index in the rod
        resistance = self._between_states(
            self.motion.resistance, columns, np.asarray(tick)
        )
        ultimate = np.zeros(nodes.stop - nodes.start)
        ultimate[held] = soil["ultimate"][columns]
        shares = np.zeros(len(ultimate))
        shares[held] = resistance / ultimate[held]
        return SoilAtNodes(
            self._node_places(body), ultimate, np.clip(shares, -1.0, 1.0)
        )

    def profile(self, body: int, tick: int) -> Profile:
        """Velocity and strain of each cell of a rod at `tick`, interpolated in time.

        The velocity of a cell is the mean of those of its two nodes, in the laboratory.
        """
        span = self._span(body)
        at_tick = np.asarray(tick)
        v = self._between_states(self.motion.velocity, span.nodes, at_tick)
        in_cells = (v[1:] + v[:-1]) / 2
        return Profile(
            edges=self._node_places(body),
            velocity=in_cells + self.frame_velocity(tick),
            strain=self._between_states(self._cell_strain, span.cells, at_tick),
        )

    # Extreme stress -------------------------------------------------------------------

    def extreme_stress(self, body: int) -> ExtremeStress:
        """Largest tension and compression in a rod, with place and time.

        They are the extremes of the stress in the stored states, and of the stress by
        the forces on the ends of the rod in all time steps. Tension is `NO_STRESS` if
        there is none; the same holds for compression.
        """
        tensions = []
        compressions = []
        for peak in (*self._state_peaks(body), *self._end_peaks(body)):
            if peak.stress > 0:
                tensions.append(peak)
            elif peak.stress < 0:
                compressions.append(peak)
        return ExtremeStress(strongest(tensions), strongest(compressions))

    def _state_peaks(self, body: int) -> Iterator[StressPeak]:
        """Yield the highest, then the lowest stress in a rod over the stored states.

        The stress is E eps + eta d(eps)/dt. The highest one may be a compression, and
        the lowest one a tension.
        """
        youngs_moduli = []  # of each segment, [point of the strain table]
        viscosities = []
        segments = self.rods[body].segments
        for segment, nodes in zip(segments, self._segment_places(body), strict=True):
            point_count = len(nodes) + 1  # len(nodes) - 1 cells, and both ends
            E, eta = moduli(segment)
            youngs_moduli.append(np.full(point_count, E))
            viscosities.append(np.full(point_count, eta))
        strain = self._strain_tables.strain[body]
        rate = self._strain_tables.rate[body]
        elastic = np.concatenate(youngs_moduli) * strain.values
        stress = elastic + np.concatenate(viscosities) * rate.values
        # The stress is [state, point]; `argmax` and `argmin` are indices in all of it.
        for extreme in (stress.argmax(), stress.argmin()):
            state, point = np.unravel_index(extreme, stress.shape)
            x = float(strain.places[point])
            t = float(self.state_ticks[state]) * self.clock.tick
            yield StressPeak(float(stress[state, point]), x, t)

    def _end_peaks(self, body: int) -> Iterator[StressPeak]:
        """Yield the stress by the largest push, then the largest pull, on each end.

        They are the largest of all time steps, and get the time of the middle of the
        step. The stress is 0 if an end is never pushed, or never pulled. Free ends, and
        ends where lateral inertia takes a share of the force, are left out.
        """
        for end in self._loaded_ends(body):
            if end.push is None or end.segment.lateral_inertia is not None:
                continue
            for sign in (1.0, -1.0):  # pushes, then pulls
                force = sign * end.push  # mean in each step, N
                middle_of_step = int(np.argmax(force)) + 0.5
                t = middle_of_step * self.step
                # `largest_force` estimates the largest force in a step, which exceeds
                # the mean. A push is compression: its stress is negative.
                stress = -sign * largest_force(force) / end.area
                yield StressPeak(stress, end.x, t)

    def _loaded_ends(self, body: int) -> tuple[LoadedEnd, LoadedEnd]:
        """The two ends of a rod, left and right, with the forces on them.

        A contact exerts the force, or at an end of the row a wall, a drive or an
        absorbing end. Forces are means over each time step, N; None at a free end.
        """
        contacts = self.signals.contacts
        # Actions at the ends of the row; any other end of a rod has a contact instead.
        left_action, right_action = self.signals.boundary_actions
        left_push = _push_of(left_action)
        right_push = _push_of(right_action)
        # Contact k lies between the bodies k and k + 1.
        if body > 0:
            left_push = contacts[body - 1].force.values
        if body < len(contacts):
            right_push = contacts[body].force.values
        first = self.rods[body].segments[0]
        last = self.rods[body].segments[-1]
        length = float(self.edges(body)[-1])
        left = LoadedEnd(
            segment=first, x=0.0, area=end_areas(first).left, push=left_push
        )
        right = LoadedEnd(
            segment=last, x=length, area=end_areas(last).right, push=right_push
        )
        return left, right


def _push_of(action: BoundaryAction | None) -> Floats | None:
    """Mean force of an action on an end of the row, N [step]; None for no action."""
    if action is None:
        return None
    return action.push.values
