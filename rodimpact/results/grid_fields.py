"""Fields from states of a grid: velocities of nodes and strains of cells at some times.

Between nodes, between the middles of cells, and between two states fields change linearly. At the
ends of a segment the force follows from the momentum of the node there: it is 0 at a free end, the
force of the contact where rods touch, and the same on both sides of a step. Strains follow from it.

Energies are those that the scheme conserves. The kinetic energy is less by the strain energy of
half a step of motion, which keeps both kinetic and strain energy from being negative.
"""

from collections.abc import Iterator
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..methods.grid.measures import largest_force
from ..methods.grid.mesh import STEP_TICKS, GridMotion
from ..methods.signals import Floats, Ints, Pieces, Side
from ..model import Segment
from ..model.profiles import Samples
from .extreme_stress import ExtremeStress, StressPeak, strongest
from .fields import Fields, PassingWaves, Profile, RodEnergy


class Table(NamedTuple):
    """Values of a field of a rod at the states."""

    places: Floats
    """m from the left end of the rod [place]; a place occurs twice where a field jumps."""
    values: Floats
    """[state, place]."""


class CellStates(NamedTuple):
    """State of all cells [state, cell]."""

    strain: Floats
    rate: Floats
    """Rate of the strain, 1/s."""
    tension: Floats
    """Elastic and viscous tension, N; 0 between pieces."""


class SegmentStrain(NamedTuple):
    """Strain of a segment at its left end, in its cells, and at its right end."""

    strain: Floats
    """[state, place]."""
    rate: Floats
    """1/s [state, place]."""


class Span(NamedTuple):
    """The part of the mesh that is a rod."""

    nodes: slice
    cells: slice
    mass: Floats
    """Masses of the nodes that belong to the rod, kg."""


class NodeNeighbour(NamedTuple):
    """A segment as seen from the node at one of its ends."""

    node: int
    cell: int  # cell of the segment beside the node
    second_cell: int  # cell behind it, or the same one
    inward: int  # 1 at the left end, -1 at the right one
    area: float  # area of the segment at this end, m^2


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
    def known(self) -> Ints:
        """Increasing ticks of the states; energies are known at these alone."""
        return np.asarray(self.motion.when * STEP_TICKS)

    def nearest_known(self, ticks: Ints) -> Ints:
        middles = (self.known[1:] + self.known[:-1]) / 2
        return self.known[np.searchsorted(middles, ticks, "right")]

    # Between states and between nodes -------------------------------------------------------------

    def _in_time(self, values: Floats, column: Any, ticks: Ints) -> Floats:
        """Interpolate columns of [state, column] at ticks; the two broadcast."""
        when = self.known
        last = len(when) - 1  # 0 where nothing moves: there is one state
        i = np.searchsorted(when, ticks, "right") - 1
        i = np.clip(i, 0, max(last - 1, 0))
        after = np.minimum(i + 1, last)
        lasts = np.maximum(when[after] - when[i], 1)
        share = np.minimum((ticks - when[i]) / lasts, 1.0)
        return np.asarray(
            values[i, column] * (1 - share) + values[after, column] * share
        )

    def _at(self, body: int, x: Floats, ticks: Ints, table: Table) -> Floats:
        """Interpolate a table at places x of a rod, m, and at ticks."""
        self._broadcast_shape(self.locate(body, x)[0], ticks)
        places = table.places
        i = np.clip(np.searchsorted(places, x, "right") - 1, 0, len(places) - 2)
        share = np.minimum((x - places[i]) / (places[i + 1] - places[i]), 1.0)
        before = self._in_time(table.values, i, ticks)
        after = self._in_time(table.values, i + 1, ticks)
        return np.asarray(before * (1 - share) + after * share)

    def _places(self, body: int) -> list[Floats]:
        """Places of the nodes of each segment of a rod, m from its left end."""
        first, last = self.clock.spans[body]
        counts = self.motion.counts[first - 1 : last]
        edges = self.edges(body)
        places = []
        for i, count in enumerate(counts):
            places.append(np.linspace(edges[i], edges[i + 1], count + 1))
        return places

    def _node_places(self, body: int) -> Floats:
        """Places of the nodes of a rod, m from its left end."""
        return np.unique(np.concatenate(self._places(body)))

    @cached_property
    def _velocity(self) -> Floats:
        """Velocities of nodes in the frame [state, node], m/s.

        In damped rods these are the rates at which displacements change over two steps,
        (v[n - 1] + 2 v[n] + v[n + 1])/4. Viscosity leaves a motion of the mesh alone that changes
        its sign from node to node and from step to step, since its mean over a step is 0. Contacts
        excite it, and it would be most of the error at an end. It is no part of displacements.
        """
        velocity = self.motion.velocity
        damped = self.motion.cells.viscous[:-1] + self.motion.cells.viscous[1:] > 0
        when = self.motion.when
        if not damped.any() or len(when) < 3:
            return velocity
        damped_nodes = np.flatnonzero(damped)
        nodes = slice(int(damped_nodes[0]), int(damped_nodes[-1]) + 1)
        raw = velocity[:, nodes]
        smooth = raw.copy()
        follows = np.diff(when) == 1
        inside = follows[:-1] & follows[1:]
        mean = raw[:-2] + raw[2:]
        mean += 2 * raw[1:-1]
        mean /= 4
        np.copyto(smooth[1:-1], mean, where=inside[:, None])
        # From one side, with the same error: after t = 0, where velocities may jump, and at
        # the end.
        sides = []
        if when[0] == 0 and len(when) > 4 and follows[:4].all():
            sides.append((1, 1))
        if len(when) > 3 and follows[-3:].all():
            sides.append((len(when) - 1, -1))
        for state, onward in sides:
            second = raw[state + onward]
            third = raw[state + 2 * onward]
            fourth = raw[state + 3 * onward]
            smooth[state] = raw[state] + (second - 2 * third + fourth) / 4
        if damped.all():
            return smooth
        velocities = velocity.copy()
        velocities[:, damped] = smooth[:, damped[nodes]]
        return velocities

    @cached_property
    def _velocities(self) -> dict[int, Table]:
        """Velocities of the nodes of each rod in the frame, m/s."""
        tables = {}
        for body in self.rods:
            velocities = self._velocity[:, self._span(body).nodes]
            tables[body] = Table(self._node_places(body), velocities)
        return tables

    @cached_property
    def _strain(self) -> Floats:
        """Strains of the cells [state, cell]."""
        return np.asarray(self.motion.stretches(self.step) / self.motion.cells.width)

    def _cell_states(self) -> CellStates:
        """Strains, their rates, and tensions of all cells."""
        cells = self.motion.cells
        rate = np.zeros(self.motion.force.shape)
        rate[:, 1:-1] = np.diff(self._velocity, axis=1) / cells.width[1:-1]
        tension = self.motion.force + cells.viscous * cells.width * rate
        return CellStates(self._strain, rate, tension)

    @cached_property
    def _strains(self) -> tuple[dict[int, Table], dict[int, Table]]:
        """Strains of each rod, and their rates, 1/s.

        Places are the ends of segments, on either side of a step, and the middles of cells.
        """
        cells = self._cell_states()
        strains = {}
        rates = {}
        for body, rod in self.rods.items():
            first = self.clock.spans[body][0]
            places = []
            parts = []
            for i, nodes in enumerate(self._places(body)):
                middles = (nodes[1:] + nodes[:-1]) / 2
                places.append(np.concatenate((nodes[:1], middles, nodes[-1:])))
                parts.append(self._segment_strain(first + i, rod.segments[i], cells))
            all_places = np.concatenate(places)
            strain = np.concatenate([part.strain for part in parts], axis=-1)
            rate = np.concatenate([part.rate for part in parts], axis=-1)
            strains[body] = Table(all_places, strain)
            rates[body] = Table(all_places, rate)
        return strains, rates

    def _segment_strain(
        self, s: int, segment: Segment, cells: CellStates
    ) -> SegmentStrain:
        """Strain of segment s of the row, and its rate.

        At the ends both are extrapolated, and then changed to give the stress that follows from the
        momentum of the node: in a step, viscosity eta resists a change of strain by eta/step. Where
        lateral inertia takes a share of the force they stay.
        """
        E, eta = _moduli(segment)
        a = self.motion.first[s]
        b = self.motion.last[s]
        strain = cells.strain[:, a : b + 2].copy()
        rate = cells.rate[:, a : b + 2].copy()
        inner = b > a + 1
        first_area, last_area = _end_areas(segment)
        left = NodeNeighbour(a, a + 1, a + 1 + inner, 1, first_area)
        right = NodeNeighbour(b, b, b - inner, -1, last_area)
        for neighbour, end in ((left, 0), (right, -1)):
            near = neighbour.cell
            behind = neighbour.second_cell
            end_strain = 1.5 * cells.strain[:, near] - 0.5 * cells.strain[:, behind]
            end_rate = 1.5 * cells.rate[:, near] - 0.5 * cells.rate[:, behind]
            strain[:, end] = end_strain
            rate[:, end] = end_rate
            if not self._has_lateral_inertia(neighbour):
                stress = self._end_stress(neighbour, cells.tension)
                missing = stress - E * end_strain - eta * end_rate
                strain[:, end] += missing / (E + eta / self.step)
                rate[:, end] += missing / (E * self.step + eta)
        return SegmentStrain(strain, rate)

    def _has_lateral_inertia(self, neighbour: NodeNeighbour) -> bool:
        """Whether lateral inertia takes a share of the force on the node of an end."""
        cells = self.motion.cells
        node = neighbour.node
        lateral = cells.lateral[node] or cells.lateral[node + 1]
        return bool(lateral or cells.swelling[neighbour.cell])

    def _end_stress(self, neighbour: NodeNeighbour, tension: Floats) -> Floats:
        """Stress at the end of a segment by the momentum of its half cell, Pa [state]."""
        motion = self.motion
        node = neighbour.node
        cell = neighbour.cell
        pull = tension[:, node + 1] - tension[:, node] + self._push_on(node)
        gained = pull * motion.cells.cell_mass[cell] / 2 / motion.mass[node]
        stress = (tension[:, cell] - neighbour.inward * gained) / neighbour.area
        return np.asarray(stress)

    def _push_on(self, node: int) -> Floats:
        """Force to the right on a node from outside its piece, N [state]."""
        means = self.motion.pushes.get(node, np.zeros(1))
        if len(means) == 0:
            return np.zeros(1)
        if len(means) == 1:
            return np.repeat(means, len(self.motion.when))
        ends = 1.5 * means[[0, -1]] - 0.5 * means[[1, -2]]
        inside = (means[1:] + means[:-1]) / 2
        at_steps = np.concatenate((ends[:1], inside, ends[1:]))
        return np.asarray(at_steps[self.motion.when])

    @cached_property
    def _displacements(self) -> dict[int, Table]:
        """Displacements of the nodes of each rod in the frame, m."""
        motion = self.motion
        elongation = self._strain[:, :-1] * motion.cells.width[:-1]
        # Elongation from the first node of the row to each node
        stretched = np.cumsum(elongation, axis=1)
        tables = {}
        for body in self.rods:
            first, last = self.clock.spans[body]
            a = motion.first[first]
            b = motion.last[last]
            piece = int(np.searchsorted(motion.starts, a, "right")) - 1
            before = stretched[:, a] - stretched[:, motion.starts[piece]]
            left = motion.displacement[:, piece] * self.step + before - before[0]
            moved = stretched[:, a : b + 1] + (left - stretched[:, a])[:, None]
            tables[body] = Table(self._node_places(body), moved)
        return tables

    # Fields ---------------------------------------------------------------------------------------

    def rod_velocity(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:  # noqa: ARG002
        return self._at(body, x, ticks, self._velocities[body]) + self.clock.frame

    def rod_strain(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:  # noqa: ARG002
        return self._at(body, x, ticks, self._strains[0][body])

    def rod_strain_rate(self, body: int, x: Floats, ticks: Ints) -> Floats:
        return self._at(body, x, ticks, self._strains[1][body])

    def rod_displacement(self, body: int, x: Floats, ticks: Ints) -> Floats:
        moved = self._at(body, x, ticks, self._displacements[body])
        return moved + self.clock.frame * (ticks * self.clock.tick)

    def strain_integral(self, body: int, x: Floats, ticks: Ints) -> Floats:
        strains = self._at(body, x[:, None], self.known, self._strains[0][body])
        integrals = []
        for strain in strains:
            integrals.append(Pieces.through(self.known, strain).integral(0, ticks))
        return np.array(integrals)

    def point_history(self, body: int, x: float) -> PassingWaves:
        segment = int(self.locate(body, x)[0])
        c = self.clock.wave_speed[segment]
        ticks = self.known
        place = np.asarray(x)
        v = self._at(body, place, ticks, self._velocities[body])
        stretch = c * self._at(body, place, ticks, self._strains[0][body])
        return PassingWaves(
            Pieces.through(ticks, v - stretch),
            Pieces.through(ticks, v + stretch),
            Pieces.through(ticks, 2 * stretch),
            c,
        )

    # Integrals over bodies ------------------------------------------------------------------------

    def _span(self, body: int) -> Span:
        """The part of the mesh that is a rod."""
        first, last = self.clock.spans[body]
        a = self.motion.first[first]
        b = self.motion.last[last]
        cells = slice(a + 1, b + 1)
        half = self.motion.cells.cell_mass[cells] / 2
        mass = np.append(half, 0.0) + np.append(0.0, half)
        return Span(slice(a, b + 1), cells, mass)

    def momentum(self, body: int, t: ArrayLike) -> Floats:
        span = self._span(body)
        # A product of matrices would give other bits for other numbers of states.
        in_frame = (self.motion.velocity[:, span.nodes] * span.mass).sum(axis=1)
        ticks = self.to_ticks(t)
        moving = self._in_time(in_frame[:, None], 0, ticks)
        frame = self.clock.frame + self._fall_velocity(ticks)
        return np.asarray(moving + span.mass.sum() * frame)

    def energy(self, body: int, tick: int, velocity: float) -> RodEnergy:
        clock = self.clock
        span = self._span(body)
        state = int(np.searchsorted(self.motion.when, tick // STEP_TICKS))
        in_frame = self.motion.velocity[state, span.nodes]
        v = in_frame + clock.frame + clock.gravity * tick * clock.tick - velocity
        energies = self.motion.energies(span.nodes, span.mass, state, v, self.step)
        return RodEnergy(*energies)

    def extreme_stress(self, body: int) -> ExtremeStress:
        peaks = [*self._state_peaks(body), *self._end_peaks(body)]
        tensions = [peak for peak in peaks if peak.stress > 0]
        compressions = [peak for peak in peaks if peak.stress < 0]
        return ExtremeStress(strongest(tensions), strongest(compressions))

    def _state_peaks(self, body: int) -> Iterator[StressPeak]:
        """Highest and lowest stress in a rod at the states that are kept."""
        segments = self.rods[body].segments
        moduli = np.array([_moduli(segment) for segment in segments])
        counts = [len(x) + 1 for x in self._places(body)]
        E, eta = np.repeat(moduli, counts, axis=0).T
        strains, rates = self._strains
        places = strains[body].places
        stress = E * strains[body].values + eta * rates[body].values
        for extreme in (stress.argmax(), stress.argmin()):
            state, place = np.unravel_index(extreme, stress.shape)
            t = float(self.known[state]) * self.clock.tick
            yield StressPeak(float(stress[state, place]), float(places[place]), t)

    def _end_peaks(self, body: int) -> Iterator[StressPeak]:
        """Stress by the largest push and pull on each end of a rod, of all time steps.

        Lateral inertia takes a share of the force on an end.
        """
        segments = self.rods[body].segments
        places = (0.0, float(self.edges(body)[-1]))
        forces = self._forces_on(body)
        for end in (0, -1):
            segment = segments[end]
            force = forces[end]
            if force is None or segment.lateral_inertia is not None:
                continue
            area = _end_areas(segment)[end]
            for sign in (1.0, -1.0):
                means = sign * force
                t = (int(np.argmax(means)) + 0.5) * self.step
                stress = -sign * largest_force(means) / area
                yield StressPeak(stress, places[end], t)

    def _forces_on(self, body: int) -> tuple[Floats | None, Floats | None]:
        """Mean push in each step on the left and on the right end of a rod, N; None if free."""
        left: Pieces | None
        right: Pieces | None
        left, right = self._outside_pushes()
        if body > 0:
            left = self.signals.contacts[body - 1].force
        if body < len(self.signals.contacts):
            right = self.signals.contacts[body].force
        return _values_of(left), _values_of(right)

    def _outside_pushes(self) -> list[Pieces | None]:
        """Forces of what acts on the left and on the right end of the row, N."""
        pushes: list[Pieces | None] = []
        for side in self.signals.boundary_actions:
            if side is None:
                pushes.append(None)
            else:
                pushes.append(side.push)
        return pushes

    def damped(self, ticks: Ints) -> Floats:
        states = np.searchsorted(self.motion.when, ticks // STEP_TICKS)
        return np.asarray(self.motion.lost[states] * self.step)

    def profile(self, body: int, tick: int) -> Profile:
        span = self._span(body)
        v = self._in_time(self.motion.velocity, span.nodes, np.asarray(tick))
        strain = self._in_time(self._strain, span.cells, np.asarray(tick))
        drift = self.clock.frame + self.clock.gravity * tick * self.clock.tick
        return Profile(self._node_places(body), (v[1:] + v[:-1]) / 2 + drift, strain)


def _moduli(segment: Segment) -> tuple[float, float]:
    """Young's modulus and viscosity."""
    return float(segment.material.youngs_modulus), float(segment.material.viscosity)


def _end_areas(segment: Segment) -> tuple[float, float]:
    """Areas at the left and at the right end of a segment, m^2."""
    area = segment.area
    if isinstance(area, Samples):
        return float(area.values[0]), float(area.values[-1])
    return float(area), float(area)


def _values_of(pieces: Pieces | None) -> Floats | None:
    """Values of a signal; None if there is none."""
    if pieces is None:
        return None
    return pieces.values
