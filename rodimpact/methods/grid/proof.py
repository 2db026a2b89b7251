"""The proof of finality on a grid.

It tells from the present state how each side of a contact moves. On each side stands a
group of pieces with the joints between them. A semi-infinite bar of impedance Z yields
by the momentum that it has taken, over Z. A joint without a spring yields by the change
of momentum over the constant of its dashpot.
"""

import math
from typing import NamedTuple

import numpy as np

from .. import abilities, finality_kernel
from ..link import Law
from ..row import Array
from .mesh import GridMotion, Mesh, quotient
from .run import GridRun


class GroupState(NamedTuple):
    """Motion of the group on one side of a contact."""

    mean: float  # mean velocity, m/s
    deviation: float  # displacement of its end beside the mean motion, m, to the right
    bound: float  # largest deviation of its end at any time, m


def finality_time(run: GridRun) -> float:
    """Time after which the proof that no contact closes again can succeed, s.

    It is 0 if the proof succeeds now, and inf if the mean motions do not open the gaps,
    while a contact presses, and where a drive acts. The longest time of all contacts
    counts.
    """
    if abilities.has_external_drive(run.row.system):
        return math.inf
    wait = 0.0
    tolerance = float(run.grid.run["velocity_tolerance"][0])
    rest_bound = tolerance * run.step  # up to this bound ends move as their groups do
    state = present(run)
    contacts = run.grid.links[run.grid.links["law"] != Law.JOINT]
    for link in contacts:
        gap = float(link["gap"]) * run.step  # m
        if gap < 0:  # it presses
            return math.inf
        left = side_of(run, link["left_node"], right_end=True, state=state)
        right = side_of(run, link["right_node"], right_end=False, state=state)
        reach = left.bound + right.bound
        opening = right.mean - left.mean
        least_opening = -math.inf  # least velocity with which the ends can part
        if max(left.bound, right.bound) <= rest_bound:
            least_opening = opening
        # Gap between the mean motions, beside which the faces are by their deviations
        mean_gap = gap + left.deviation - right.deviation
        time = finality_kernel.separation_time(
            opening, least_opening, mean_gap, reach * reach, tolerance
        )
        wait = max(wait, time)
    return wait


def present(run: GridRun) -> tuple[GridMotion, Array]:
    """The last state of a run, and the elongation of the cells in it, m [cell]."""
    motion = run.motion(slice(-1, None))
    return motion, motion.stretches(run.step)[0]


def absorbing_side(run: GridRun, node: int) -> int | None:
    """Side of the row whose absorbing end is this node; None if it is no such end."""
    for side, (kind, _) in enumerate(run.row.boundaries):
        if kind == "absorbing" and run.mesh.ends[side] == node:
            return side
    return None


def add_joints(
    run: GridRun,
    group: tuple[int, int],
    g: Array,
    stretch: Array,
    compliance: Array,
    energy: float,
) -> tuple[float, float]:
    """Enter the joints of a group in `stretch` and `compliance` of its cells, in place.

    Parameters
    ----------
    run : GridRun
    group : (int, int)
        First and last node.
    g, stretch, compliance : array
        Mass fraction beyond, elongation, m, and compliance, m/N, of each cell of the
        group.
    energy : float
        Energy of the group without joints, J.

    Returns
    -------
    float
        The energy with that of the springs of joints, J.
    float
        Deviation of the end for a momentum, by dashpots, s/kg.
    """
    first, last = group
    shift_by_momentum = 0.0
    # Link `link` of the row is link `column` of the grid;
    # it lies on the left of node `right`.
    for column, (link, (_, right)) in enumerate(run.mesh.touching.items()):
        if first < right <= last:  # a joint
            cell = right - first - 1  # its place among the cells of the group
            k = float(run.row.links[link].stiffness)
            if k > 0:
                # m; the grid divides lengths by the step. A dashpot beside this spring
                # gives way to no force that lasts.
                stretch[cell] = run.grid.links["gap"][column] * run.step
                compliance[cell] = 1 / k
                energy += k * stretch[cell] ** 2 / 2
            else:
                # A dashpot c yields by g/c times the change of momentum, at most twice
                # the largest momentum.
                shift_by_momentum += 2 * g[cell] / float(run.row.links[link].damping)
    return energy, shift_by_momentum


def group_of(mesh: Mesh, node: int) -> tuple[int, int]:
    """First and last node of the group to which a node belongs."""
    group = mesh.groups[0]
    for next_group in mesh.groups:  # they stand from left to right
        first, _ = next_group
        if first <= node:
            group = next_group
    return group


def side_of(
    run: GridRun, node: int, right_end: bool, state: tuple[GridMotion, Array]
) -> GroupState:
    """Motion of the group that has this node at its right end, or else at its left end.

    `state` is that of `present`.

    With g(x) the mass fraction beyond x as seen from this end, see `mass_beyond`, the
    end deviates from the mean motion by integral(g eps dx), and by at most sqrt(2 E_vib
    integral(g^2 dx/(E A))). An endless bar of impedance Z at the far end and dashpots
    of joints make the bound larger, by the momentum that they can take. The end is half
    a step ahead of the cells, by no more than the velocity that the energy gives.
    """
    mesh = run.mesh
    motion, elongation = state
    first, last = group_of(mesh, node)
    nodes = slice(first, last + 1)
    far = first if right_end else last
    mean, Z = mean_motion(run, motion, nodes, far)
    if first == last:
        return GroupState(mean, 0.0, 0.0)
    m = mesh.mass[nodes]
    v = motion.velocity[0, nodes]
    is_held = bool(mesh.is_prescribed[far]) or Z > 0
    g = mass_beyond(m, right_end, is_held)
    kinetic, strain = motion.energies(nodes, m, state=0, v=v - mean, step=run.step)
    # Cell i is on the left of node i, so the first node has none of the group.
    cells = slice(first + 1, last + 1)
    stretch = elongation[cells].copy()
    compliance = quotient(1.0, mesh.cells.relaxed_stiffness[cells])
    # Joints are entered in `stretch` and `compliance`, too.
    energy, shift_by_momentum = add_joints(
        run, (first, last), g, stretch, compliance, kinetic + strain
    )
    # Stretching moves a right end to the right, a left end to the left.
    direction = 1 if right_end else -1
    deviation = float(stretch @ g) * direction
    compliance_integral = float(g * g @ compliance)
    # A momentum is sqrt(2 E m) at most. Each motion that it makes adds to that of the
    # cells, and (d1 + d2)^2 <= 2 (d1^2 + d2^2) bounds the square of their sum.
    mass = m.sum()
    if Z > 0:
        # The far end yields to the bar by the momentum of the group over Z, in the
        # direction of that momentum, whichever side it is on.
        deviation -= float(m @ (v - mean)) / Z
        compliance_integral = 2 * (compliance_integral + mass / (Z * Z))
    if shift_by_momentum > 0:
        square_shift = mass * shift_by_momentum * shift_by_momentum
        compliance_integral = 2 * (compliance_integral + square_shift)
    energy = max(energy, 0.0)
    # Half a step times sqrt(2 E/m), the largest velocity of the node
    half_step = run.step * math.sqrt(energy / (2 * mesh.mass[node]))
    bound = math.sqrt(2 * energy * compliance_integral) + half_step
    return GroupState(mean, deviation, bound)


def mean_motion(
    run: GridRun, motion: GridMotion, nodes: slice, far: int
) -> tuple[float, float]:
    """Mean velocity of a group, m/s, and impedance of an endless bar at its far end.

    The mean velocity is that of the centre of mass; of the far end where that is held,
    and that of the wave from outside where an endless bar is there. The impedance,
    kg/s, is 0 where no such bar is.

    Parameters
    ----------
    run : GridRun
    motion : GridMotion
        That of one time.
    nodes : slice
        Nodes of the group.
    far : int
        That at its far end.
    """
    side = absorbing_side(run, far)
    if side is not None:
        end = run.grid.ends[side]
        return float(end["background_wave"]), float(end["impedance"])
    if run.mesh.is_prescribed[far]:
        return float(motion.velocity[0, far]), 0.0
    m = run.mesh.mass[nodes]
    v = motion.velocity[0, nodes]
    mass = m.sum() or 1.0  # kg; a wall has none, and v - v[0] is 0 then
    # Relative to the first node, so that a body without vibration has no deviation.
    return float(v[0] + m @ (v - v[0]) / mass), 0.0


def mass_beyond(m: Array, right_end: bool, is_held: bool) -> Array:
    """Mass fraction of a group beyond each of its cells, as seen from one of its ends.

    It lies on the left of the cell, seen from the right end, and else on the right. It
    is 1 if the far end is held or endless: no mass of the group is needed there.
    """
    if is_held:
        return np.ones(len(m) - 1)
    on_left: Array = np.cumsum(m[:-1]) / m.sum()
    if right_end:
        return on_left
    return np.subtract(1, on_left)
