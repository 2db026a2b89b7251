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
    """Time from now after which a proof that no contact closes again can succeed, s.

    It is 0 if the proof succeeds now. It is inf if the mean motions do not open the
    gaps, if a contact presses now, or if a drive acts on the row. The longest time of
    all contacts counts, 0 without contacts. The run is not changed.
    """
    if abilities.has_external_drive(run.row.system):
        return math.inf
    wait = 0.0
    tolerance = float(run.grid.run["velocity_tolerance"][0])
    # Up to this bound, m, ends move with their groups.
    rest_bound = tolerance * run.step
    state = present(run)  # the last state, from which the motion of groups is taken
    contacts = run.grid.links[run.grid.links["law"] != Law.JOINT]
    for link in contacts:
        gap = float(link["gap"]) * run.step  # m; the grid divides lengths by the step
        if gap < 0:  # it presses
            return math.inf
        # Of the groups on both sides: mean velocity, the distance of the end from where
        # the mean motion has it, and a bound of this distance. The group on the left
        # has its right end at the contact.
        left = side_of(run, link["left_node"], right_end=True, state=state)
        right = side_of(run, link["right_node"], right_end=False, state=state)
        reach = left.bound + right.bound  # that both ends together can bridge, m
        opening = right.mean - left.mean
        # Least velocity with which the ends can part, if vibration does not hide it
        least_opening = -math.inf
        if max(left.bound, right.bound) <= rest_bound:
            least_opening = opening
        # Gap between the mean motions: the faces deviate from these.
        mean_gap = gap + left.deviation - right.deviation
        time = finality_kernel.separation_time(
            opening, least_opening, mean_gap, reach * reach, tolerance
        )
        wait = max(wait, time)
    return wait


def present(run: GridRun) -> tuple[GridMotion, Array]:
    """The last state kept of a run, and the elongation of the cells in it, m [cell].

    The motion has this state alone, [1, node] and [1, cell]; it is the present one.
    """
    motion = run.motion(slice(-1, None))
    return motion, motion.stretches(run.step)[0]


def absorbing_side(run: GridRun, node: int) -> int | None:
    """Side (0 left, 1 right) of the row whose absorbing end is this node, else None."""
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

    A joint stands at the cell between two pieces. One with a spring gets its stretch
    and 1/k there; one without is a dashpot, and shifts the end by momentum.

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
        Largest deviation of the end over the largest momentum, by dashpots, s/kg.
    """
    first, last = group
    shift_by_momentum = 0.0
    # `touching` has the nodes on both sides of each link, by the number of the link in
    # the row. Links of the grid are counted in this order, as columns.
    for column, (link, beside) in enumerate(run.mesh.touching.items()):
        _, right = beside
        is_inside = first < right <= last
        if is_inside:  # a joint, as groups end at contacts
            # Its place among the cells of the group, the first of which lies on the
            # left of node first + 1
            cell = right - first - 1
            k = float(run.row.links[link].stiffness)
            if k > 0:
                # The gap of a joint is its stretch, which the grid divides by the step.
                # A dashpot beside this spring gives way to no force that lasts.
                stretch[cell] = run.grid.links["gap"][column] * run.step
                compliance[cell] = 1 / k
                energy += k * stretch[cell] ** 2 / 2
            else:
                # A dashpot c yields by g/c times the change of momentum, at most twice
                # the largest momentum.
                shift_by_momentum += 2 * g[cell] / float(run.row.links[link].damping)
    return energy, shift_by_momentum


def group_of(mesh: Mesh, node: int) -> tuple[int, int]:
    """First and last node of the group of a node: all nodes between two contacts."""
    group = mesh.groups[0]
    for next_group in mesh.groups:  # from left to right
        first, _ = next_group
        if first <= node:  # the last such group has the node
            group = next_group
    return group


def side_of(
    run: GridRun, node: int, right_end: bool, state: tuple[GridMotion, Array]
) -> GroupState:
    """Motion of the group that has this node at its right end, or else at its left end.

    `state` is that of `present`. With g(x) the mass fraction beyond x as seen from this
    end, see `mass_beyond`, the end deviates from the mean motion by
    integral(g eps dx), and at any time by at most
    sqrt(2 E_vib integral(g^2 dx/(E A))). An endless bar of impedance Z at the far end
    and dashpots of joints make this bound larger, by the momentum that they can take,
    and half a step does, by which the end is ahead of the cells. A group of one node
    deviates by nothing.
    """
    mesh = run.mesh
    motion, elongation = state
    first, last = group_of(mesh, node)
    nodes = slice(first, last + 1)
    if right_end:
        far = first  # node at the other end of the group
        outward = 1  # stretching moves this end to the right
    else:
        far = last
        outward = -1
    mean, Z = mean_motion(run, motion, nodes, far)
    if first == last:
        return GroupState(mean, deviation=0.0, bound=0.0)
    m = mesh.mass[nodes]
    v = motion.velocity[0, nodes]
    is_held = bool(mesh.is_prescribed[far]) or Z > 0
    g = mass_beyond(m, right_end, is_held)  # [cell of the group]
    # Vibration about the mean motion, J
    kinetic, strain = motion.energies(nodes, m, state=0, v=v - mean, step=run.step)
    # Cell i is on the left of node i: the first cell of the group on that of its second
    # node.
    cells = slice(first + 1, last + 1)
    stretch = elongation[cells].copy()
    compliance = quotient(1.0, mesh.cells.relaxed_stiffness[cells])
    # This enters joints in `stretch` and `compliance`, too.
    energy_with_joints, shift_by_momentum = add_joints(
        run, (first, last), g, stretch, compliance, kinetic + strain
    )
    energy = max(energy_with_joints, 0.0)  # round-off may be below 0
    deviation = float(stretch @ g) * outward
    # The square of a deviation is at most 2 E times this, m/N.
    compliance_integral = float(g * g @ compliance)
    # A momentum is sqrt(2 E m) at most. Each motion that it makes adds to that of the
    # cells, and (d1 + d2)^2 <= 2 (d1^2 + d2^2) bounds the square of their sum.
    mass = m.sum()
    if Z > 0:
        # The far end yields to the bar by the momentum of the group over Z, in the
        # direction of that momentum, whichever side it is on.
        momentum = float(m @ (v - mean))
        deviation -= momentum / Z
        compliance_integral = 2 * (compliance_integral + mass / (Z * Z))
    if shift_by_momentum > 0:
        by_dashpots = mass * shift_by_momentum * shift_by_momentum
        compliance_integral = 2 * (compliance_integral + by_dashpots)
    # Way of the end in half a step with sqrt(2 E/m), its largest velocity
    half_step = run.step * math.sqrt(energy / (2 * mesh.mass[node]))
    bound = math.sqrt(2 * energy * compliance_integral) + half_step
    return GroupState(mean, deviation, bound)


def mean_motion(
    run: GridRun, motion: GridMotion, nodes: slice, far: int
) -> tuple[float, float]:
    """Mean velocity of a group, m/s, and impedance of an endless bar at its far end.

    The mean velocity, in the frame, is that of the centre of mass; but that of the wave
    from outside where an endless bar is at the far end, and that of the far end where
    its velocity is prescribed. A wall alone has its own. The impedance, kg/s, is 0
    where no such bar is.

    Parameters
    ----------
    run : GridRun
    motion : GridMotion
        That of one time.
    nodes : slice
        Nodes of the group.
    far : int
        Node at its far end.
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
    mean = float(v[0] + m @ (v - v[0]) / mass)
    return mean, 0.0


def mass_beyond(m: Array, right_end: bool, is_held: bool) -> Array:
    """Mass fraction of a group beyond each of its cells, as seen from one end, [cell].

    `m` are the masses of its nodes, kg [node]. Seen from the right end, beyond is on
    the left of a cell, else on its right. All fractions are 1 if the far end is held or
    endless (`is_held`), as if a very large mass were there.
    """
    if is_held:
        return np.ones(len(m) - 1)
    on_left: Array = np.cumsum(m[:-1]) / m.sum()
    if right_end:
        return on_left
    return np.subtract(1, on_left)
