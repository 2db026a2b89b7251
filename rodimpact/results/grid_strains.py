"""Strains in the cells of a grid, and at the ends of segments.

The stress at an end of a segment, and with it the strain, follows from the momentum of
the node there. So it is 0 at a free end, in balance with the contact force where rods
touch, and gives the same force on both sides of a step.
"""

from typing import NamedTuple

import numpy as np

from ..methods.grid.mesh import GridMotion
from ..methods.signals import Floats
from ..model import Segment
from ..model.profiles import Samples


class CellStates(NamedTuple):
    """State of all cells, [state, cell]."""

    strain: Floats
    rate: Floats  # rate of the strain, 1/s
    tension: Floats  # elastic plus viscous, N; 0 between meshes of bonded bodies


class SegmentStrain(NamedTuple):
    """Strain of a segment at its left end, in its cells, and at its right end."""

    strain: Floats  # [state, point]
    rate: Floats  # 1/s [state, point]


class Moduli(NamedTuple):
    """Numbers of a material that give stress from strain and its rate."""

    youngs_modulus: float  # E, Pa
    viscosity: float  # eta, Pa s


class EndAreas(NamedTuple):
    """Areas at both ends of a segment, m^2."""

    left: float
    right: float


class SegmentEnd(NamedTuple):
    """An end of a segment in the mesh."""

    node: int  # node at the end
    cell: int  # cell of the segment beside the node
    second_cell: int  # next cell inward; `cell` again in a segment of one cell
    inward: int  # 1 at the left end, -1 at the right one
    area: float  # area of the segment there, m^2


def moduli(segment: Segment) -> Moduli:
    """Young's modulus and viscosity of a segment."""
    material = segment.material
    return Moduli(float(material.youngs_modulus), float(material.viscosity))


def end_areas(segment: Segment) -> EndAreas:
    """Areas at both ends of a segment, m^2; for a taper its first and last sample."""
    area = segment.area
    if isinstance(area, Samples):
        return EndAreas(float(area.values[0]), float(area.values[-1]))
    return EndAreas(float(area), float(area))


def cell_strains(motion: GridMotion, step: float) -> Floats:
    """Strains of all cells, [state, cell].

    A strain is the elongation over the width. The time step is in s.
    """
    return np.asarray(motion.stretches(step) / motion.cells.width)


def cell_states(motion: GridMotion, strain: Floats, velocity: Floats) -> CellStates:
    """State of all cells, from their strains and the velocities of the nodes, m/s.

    `strain` is [state, cell] and is returned as it is; `velocity` is [state, node]. The
    strain rate is the difference of the velocities of both nodes over the width of the
    cell. The tension is the elastic force of the motion plus eta A times the rate.
    """
    cells = motion.cells
    rate = np.zeros(motion.force.shape)
    # The first and the last cell lie outside of the row, where the rate is 0.
    rate[:, 1:-1] = np.diff(velocity, axis=1) / cells.width[1:-1]
    # `cells.viscous` is the damping eta A over the width, N s/m.
    viscous_force = cells.viscous * cells.width * rate
    tension = motion.force + viscous_force
    return CellStates(strain, rate, tension)


def segment_strain(
    motion: GridMotion, cells: CellStates, number: int, segment: Segment, step: float
) -> SegmentStrain:
    """Strain and its rate in a segment, the `number`-th of the row counted from 1.

    The points are its left end, its cells and its right end. At the ends, strain and
    rate are extrapolated from the cells. Then corrections d eps and d rate are added,
    so that the stress agrees with the momentum of the node: E d eps + eta d rate =
    missing stress, with d eps = `step` d rate, `step` the time step, s. Nothing is
    added where lateral inertia takes a share of the force.
    """
    E, eta = moduli(segment)
    first_node = motion.first[number]
    last_node = motion.last[number]
    # The cells of the segment are first_node + 1 to last_node. One more column on each
    # side is copied: they are overwritten below by the values at the ends.
    columns = slice(first_node, last_node + 2)
    strain = cells.strain[:, columns].copy()  # [state, point]
    rate = cells.rate[:, columns].copy()
    left = _left_end(motion, number, segment)
    right = _right_end(motion, number, segment)
    for end, column in ((left, 0), (right, -1)):
        end_strain = _extrapolated(cells.strain, end)
        end_rate = _extrapolated(cells.rate, end)
        strain[:, column] = end_strain
        rate[:, column] = end_rate
        if not _has_lateral_inertia(motion, end):
            stress = _end_stress(motion, cells.tension, end)
            missing = stress - E * end_strain - eta * end_rate
            # d eps = step d rate, put into E d eps + eta d rate = missing
            strain[:, column] += missing / (E + eta / step)
            rate[:, column] += missing / (E * step + eta)
    return SegmentStrain(strain, rate)


def _left_end(motion: GridMotion, number: int, segment: Segment) -> SegmentEnd:
    """The left end of a segment, by its number in the row, counted from 1.

    Cell n lies left of node n, so the first cell has the number of the node plus 1.
    """
    node = motion.first[number]
    cell = node + 1
    second_cell = min(cell + 1, motion.last[number])
    return SegmentEnd(node, cell, second_cell, inward=1, area=end_areas(segment).left)


def _right_end(motion: GridMotion, number: int, segment: Segment) -> SegmentEnd:
    """The right end of a segment, by its number in the row, counted from 1.

    Cell n lies left of node n, so the last cell has the number of the node.
    """
    node = motion.last[number]
    cell = node
    first_cell = motion.first[number] + 1
    second_cell = max(cell - 1, first_cell)
    return SegmentEnd(node, cell, second_cell, inward=-1, area=end_areas(segment).right)


def _extrapolated(values: Floats, end: SegmentEnd) -> Floats:
    """Values of cells [state, cell], extrapolated by half a cell to an end: [state]."""
    near = values[:, end.cell]
    behind = values[:, end.second_cell]
    return np.asarray(1.5 * near - 0.5 * behind)  # near + (near - behind)/2


def _has_lateral_inertia(motion: GridMotion, end: SegmentEnd) -> bool:
    """Whether lateral inertia takes a share of the force on the node of an end."""
    cells = motion.cells
    # Cells have lateral inertia in the theory of Rayleigh and Love, and radial inertia
    # in that of Mindlin and Herrmann. Cells n and n + 1 lie left and right of node n.
    beside_node = (cells.lateral_inertia[end.node], cells.lateral_inertia[end.node + 1])
    return any(beside_node) or bool(cells.radial_inertia[end.cell])


def _end_stress(motion: GridMotion, tension: Floats, end: SegmentEnd) -> Floats:
    """Stress at an end, Pa [state], from Newton's law of the half cell there.

    The node of mass m, and with it the half cell of mass m_cell/2, has the acceleration
    a = (force on the node)/m. The forces on the half cell are the tension in the cell,
    the force of the soil on it, and the tension at the end. So the tension at the end
    is (tension in the cell) - inward (a m_cell/2 - force of the soil), with inward = 1
    at a left end and -1 at a right one.
    """
    node = end.node
    # Cell n lies left of node n and pulls it to the left, cell n + 1 to the right.
    force = tension[:, node + 1] - tension[:, node] + _push_on(motion, node)
    soil = _soil_on(motion, end)
    force = force + soil.on_node
    inertia = force * motion.cells.cell_mass[end.cell] / 2 / motion.mass[node]
    by_tensions = inertia - soil.on_half_cell  # the force that both tensions supply
    end_tension = tension[:, end.cell] - end.inward * by_tensions
    return np.asarray(end_tension / end.area)


class SoilForces(NamedTuple):
    """Forces of soil at the end of a segment, N, to the right, [state].

    They are 0 where there is no soil.
    """

    on_node: Floats | float
    on_half_cell: Floats | float  # the part on the half cell of the segment


def _soil_on(motion: GridMotion, end: SegmentEnd) -> SoilForces:
    """Forces of the soil at an end of a segment, N, to the right.

    At an end of the rod, its half cell bears all soil of the rod around the node. At a
    node between two segments, each half cell bears half of the soil. A node that two
    bonded rods share bears the soil of both.
    """
    soil = motion.soil
    # In `soil`, "end_of_rod" is -1 at the left end of a rod, 1 at its right end, and 0
    # between. `inward` has the opposite signs.
    end_of_rod = -end.inward
    on_node: Floats | float = 0.0
    on_half_cell: Floats | float = 0.0
    # There may be one record for each of two bonded rods.
    for i in np.flatnonzero(soil["node"] == end.node):
        force = motion.soil_force[:, i]
        on_node = on_node + force
        if soil["end_of_rod"][i] == 0:  # the node lies between two segments
            on_half_cell = force / 2
        elif soil["end_of_rod"][i] == end_of_rod:  # soil of this rod, not of the other
            on_half_cell = force
    return SoilForces(on_node, on_half_cell)


def _push_on(motion: GridMotion, node: int) -> Floats:
    """Force to the right on a node from outside its piece, N [state]; 0 if none acts.

    A piece is the mesh of bonded bodies. Forces are stored as means over time steps. At
    a state between two steps the force is the mean of both; at t = 0 and at the end it
    is extrapolated by half a step. If there is a single step, its mean is the force at
    all states.
    """
    step_means = motion.pushes.get(node, np.zeros(1))  # 0 where nothing acts
    if len(step_means) == 0:  # nothing moves: there is one state, and no step was made
        return np.zeros(1)
    if len(step_means) == 1:
        return np.repeat(step_means, len(motion.when))
    # Extrapolated by half a step from the first two and from the last two means
    first_and_last = 1.5 * step_means[[0, -1]] - 0.5 * step_means[[1, -2]]
    between = (step_means[1:] + step_means[:-1]) / 2
    # The force after each number of steps, from 0 to all of them
    after_steps = np.concatenate((first_and_last[:1], between, first_and_last[1:]))
    return np.asarray(after_steps[motion.when])
