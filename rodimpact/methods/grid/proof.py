"""The proof of finality on a grid.

The present state determines how both sides of a contact can move. On each side is a
group: pieces with joints between them. A semi-infinite bar of impedance Z yields by the
momentum that it has taken, divided by Z. A joint without a spring yields by the change
of momentum divided by the constant of its dashpot.
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
    # Present displacement of its end at the contact from the mean motion, m, positive
    # to the right
    deviation: float
    max_deviation: float  # upper bound of its absolute value at any time, m


def finality_time(run: GridRun) -> float:
    """Time from now after which a proof that no contact closes again can succeed, s.

    It is 0 if the proof succeeds now, also in a row without contacts. It is inf in
    three cases: a drive acts on the row, a contact has an overlap, or the mean motions
    do not open the gap of a contact. Otherwise the longest time among the contacts is
    returned. The run is not changed.
    """
    if abilities.has_external_drive(run.row.system):
        return math.inf
    wait = 0.0
    tolerance = float(run.grid.run["velocity_tolerance"][0])
    # Ends that vibrate by no more than this, m, count as moving with their groups.
    rest_bound = tolerance * run.step
    state = present_motion(run)
    contacts = run.grid.links[run.grid.links["law"] != Law.JOINT]
    for link in contacts:
        gap = float(link["gap"]) * run.step  # m; the grid divides lengths by the step
        if gap < 0:  # an overlap
            return math.inf
        # The group on the left has its right end at the contact.
        left = group_at_contact(run, link["left_node"], right_end=True, state=state)
        right = group_at_contact(run, link["right_node"], right_end=False, state=state)
        opening = right.mean - left.mean  # m/s, positive if the gap grows
        # Least velocity at which the ends themselves part: known only if they hardly
        # vibrate
        least_opening = -math.inf
        vibration = max(left.max_deviation, right.max_deviation)
        if vibration <= rest_bound:
            least_opening = opening
        # Gap that the mean motions would have: deviations are positive to the right.
        mean_gap = gap + left.deviation - right.deviation
        # Distance that vibration can bridge, m
        reach = left.max_deviation + right.max_deviation
        time = finality_kernel.separation_time(
            opening,
            least_opening,
            mean_gap,
            bound_squared=reach * reach,
            tolerance=tolerance,
        )
        wait = max(wait, time)
    return wait


def present_motion(run: GridRun) -> tuple[GridMotion, Array]:
    """The present motion of a run, and the elongation of its cells, m [cell].

    The motion has a single state, the last one that was kept: its arrays are [1, node]
    and [1, cell]. A run always keeps its state at the end of `advance`.
    """
    motion = run.motion(slice(-1, None))  # a slice keeps the axis of states
    elongation = motion.stretches(run.step)[0]
    return motion, elongation


def absorbing_side(run: GridRun, node: int) -> int | None:
    """Side (0 left, 1 right) of the absorbing end at this node; None if it has none."""
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

    A joint is at the cell between two pieces. If it has a spring, its stretch and 1/k
    are entered at this cell. If it has a dashpot only, it shifts the end of the group
    in proportion to a change of momentum.

    Parameters
    ----------
    run : GridRun
    group : (int, int)
        First and last node.
    g, stretch, compliance : array
        For each cell of the group: the mass fraction beyond it, see `mass_beyond`, its
        elongation, m, and its compliance, m/N.
    energy : float
        Energy of the group without joints, J.

    Returns
    -------
    float
        The energy with the springs of joints included, J.
    float
        Largest displacement of the end by dashpots, divided by the largest momentum,
        s/kg.
    """
    first, last = group
    shift_by_momentum = 0.0
    # `link_nodes` has the nodes on both sides of each link with a law, by the number of
    # the link in the row. `grid.links` has one record for each, in the same order.
    for index, (link, nodes) in enumerate(run.mesh.link_nodes.items()):
        _, right_node = nodes
        is_inside = first < right_node <= last
        if is_inside:  # a joint, as groups end at contacts
            # The joint is at the cell on the left of its right node. The first cell of
            # the group is on the left of node first + 1.
            cell = right_node - first - 1
            k = float(run.row.links[link].stiffness)
            if k > 0:
                # The gap of a joint is its stretch, which the grid divides by the step.
                # A dashpot in parallel with the spring carries no lasting force.
                stretch[cell] = run.grid.links["gap"][index] * run.step
                compliance[cell] = 1 / k
                energy += k * stretch[cell] ** 2 / 2
            else:
                # A dashpot c shifts the end by g/c times the change of momentum, which
                # is at most 2 times the largest momentum.
                shift_by_momentum += 2 * g[cell] / float(run.row.links[link].damping)
    return energy, shift_by_momentum


def group_of(mesh: Mesh, node: int) -> tuple[int, int]:
    """First and last node of the group that contains a node.

    A group consists of all nodes between two contacts.
    """
    group = mesh.groups[0]
    for next_group in mesh.groups:  # from left to right
        first, _ = next_group
        if first <= node:  # the last group that begins here or before has the node
            group = next_group
    return group


def group_at_contact(
    run: GridRun, node: int, right_end: bool, state: tuple[GridMotion, Array]
) -> GroupState:
    """Motion of the group whose right end (`right_end`) or left end is this node.

    `state` is that of `present_motion`. With g(x) the mass fraction beyond x as seen
    from this end, see `mass_beyond`, the end deviates from the mean motion by
    integral(g eps dx). With the vibration energy E_vib the deviation is at any time at
    most sqrt(2 E_vib integral(g^2 dx/(E A))). This bound is enlarged by the momentum
    that a semi-infinite bar of impedance Z at the far end and dashpots of joints can
    take, and by the motion of the end in half a step. For a group of one node the
    deviation and its bound are 0.
    """
    mesh = run.mesh
    motion, elongation = state
    first, last = group_of(mesh, node)
    nodes = slice(first, last + 1)
    if right_end:
        far = first  # node at the far end of the group
        outward = 1  # elongation moves this end to the right
    else:
        far = last
        outward = -1  # to the left
    mean, Z = mean_motion(run, motion, nodes, far)
    if first == last:
        return GroupState(mean, deviation=0.0, max_deviation=0.0)
    m = mesh.mass[nodes]
    v = motion.velocity[0, nodes]
    is_held = bool(mesh.is_prescribed[far]) or Z > 0
    g = mass_beyond(m, right_end, is_held)  # [cell of the group]
    # Energies of the vibration about the mean motion, J, in the only state of `motion`
    kinetic, strain = motion.energies(nodes, m, state=0, v=v - mean, step=run.step)
    # Cell i is on the left of node i, so the first cell of the group is first + 1.
    cells = slice(first + 1, last + 1)
    stretch = elongation[cells].copy()
    # The relaxed stiffness, as the strain energy for an elongation is least if radial
    # strains follow it
    compliance = quotient(1.0, mesh.cells.relaxed_stiffness[cells])
    # This also enters the joints in `stretch` and `compliance`.
    energy_with_joints, shift_by_momentum = add_joints(
        run, (first, last), g, stretch, compliance, kinetic + strain
    )
    energy = max(energy_with_joints, 0.0)  # round-off may make it negative
    # The integral of g eps dx, where eps dx is the elongation of a cell
    deviation = float(stretch @ g) * outward
    # The square of the deviation is at most 2 `energy` times this, m/N.
    compliance_integral = float((g * g) @ compliance)
    # The momentum of the vibration is at most sqrt(2 energy mass). The displacement d2
    # that it causes adds to the displacement d1 by the cells:
    # (d1 + d2)^2 <= 2 (d1^2 + d2^2).
    mass = m.sum()
    if Z > 0:
        # This momentum will still move the far end by momentum/Z in its direction, at
        # either end of the row. Now the end is behind its final motion by this
        # distance.
        momentum = float(m @ (v - mean))
        deviation -= momentum / Z
        compliance_integral = 2 * (compliance_integral + mass / (Z * Z))
    if shift_by_momentum > 0:
        by_dashpots = mass * shift_by_momentum * shift_by_momentum
        compliance_integral = 2 * (compliance_integral + by_dashpots)
    # Distance that the end covers in half a step at its largest velocity, that is
    # step/2 sqrt(2 energy/m) with the mass m of its node
    in_half_step = run.step * math.sqrt(energy / (2 * mesh.mass[node]))
    max_deviation = math.sqrt(2 * energy * compliance_integral) + in_half_step
    return GroupState(mean, deviation, max_deviation)


def mean_motion(
    run: GridRun, motion: GridMotion, nodes: slice, far: int
) -> tuple[float, float]:
    """Mean velocity of a group, m/s, and impedance of a bar at its far end, kg/s.

    The mean velocity, in the frame, is that of the centre of mass, with two exceptions:
    if a semi-infinite bar is at the far end, it is the velocity `background_wave` of
    the wave from this bar; if the velocity of the far end is prescribed, as that of a
    wall, it is this velocity. The impedance is 0 without a semi-infinite bar.

    Parameters
    ----------
    run : GridRun
    motion : GridMotion
        Motion in a single state.
    nodes : slice
        Nodes of the group.
    far : int
        Node at the far end of the group.
    """
    side = absorbing_side(run, far)
    if side is not None:
        end = run.grid.ends[side]
        return float(end["background_wave"]), float(end["impedance"])
    if run.mesh.is_prescribed[far]:
        return float(motion.velocity[0, far]), 0.0
    m = run.mesh.mass[nodes]
    v = motion.velocity[0, nodes]
    mass = m.sum() or 1.0  # kg; 1 for a single node without mass, where v - v[0] is 0
    # Relative to the first node, so that round-off makes no vibration in a body whose
    # nodes have equal velocities
    mean = float(v[0] + m @ (v - v[0]) / mass)
    return mean, 0.0


def mass_beyond(m: Array, right_end: bool, is_held: bool) -> Array:
    """Mass fraction of a group beyond each of its cells, as seen from one end, [cell].

    `m` are the masses of its nodes, kg [node]. Seen from the right end (`right_end`),
    the mass beyond a cell is the mass on its left, else the mass on its right. All
    fractions are 1 if the far end is held or a semi-infinite bar is there (`is_held`),
    as for an infinite mass.
    """
    if is_held:
        return np.ones(len(m) - 1)  # one cell less than nodes: those inside the group
    # Sums over the nodes on the left of each cell, from the first to the last cell
    on_left: Array = np.cumsum(m[:-1]) / m.sum()
    if right_end:
        return on_left  # the far end is the left one
    return np.subtract(1, on_left)
