"""Velocities of the nodes of a grid, without the oscillation that viscosity leaves.

In damped rods these are the rates at which displacements change over two steps,

    (v[n - 1] + 2 v[n] + v[n + 1])/4.

Viscosity does not damp a motion that changes its sign from node to node and from step
to step, since the mean of this motion over a step is 0. Contacts excite it, and it
would be most of the error at an end. Displacements do not contain it.
"""

import numpy as np

from ..methods.grid.mesh import GridMotion
from ..methods.signals import Floats, Ints


def node_velocities(motion: GridMotion) -> Floats:
    """Velocities of all nodes in the frame, m/s [state, node]; means in damped rods.

    Each node beside a cell with viscosity gets the mean over two steps about each
    state. Other nodes keep their velocities, and so do all nodes if there are fewer
    than three states. The array of the motion is not changed; it is returned itself if
    there are no means.
    """
    velocity = motion.velocity
    viscosity = motion.cells.viscous  # [cell]; cell n lies left of node n
    is_damped = viscosity[:-1] + viscosity[1:] > 0  # [node], by the cells beside it
    if not is_damped.any() or len(motion.when) < 3:
        return velocity
    # Means are computed for all nodes from the first to the last damped one, and copied
    # to the damped nodes only.
    damped_nodes = np.flatnonzero(is_damped)
    first = int(damped_nodes[0])
    last = int(damped_nodes[-1])
    nodes = slice(first, last + 1)
    means = _means_over_two_steps(velocity[:, nodes], motion.when)
    if is_damped.all():
        return means
    velocities = velocity.copy()
    velocities[:, is_damped] = means[:, is_damped[nodes]]
    return velocities


def _means_over_two_steps(velocity: Floats, when: Ints) -> Floats:
    """Means (v[n - 1] + 2 v[n] + v[n + 1])/4 about the states [state, node].

    `when` is the number of the time step of each state. A state whose step before or
    after was not kept keeps its velocity, as does the state at t = 0, which enters no
    mean. The state after t = 0 and the last state have one-sided means,
    v + (second difference two steps away)/4, if the states of the three steps after,
    or before, were kept.
    """
    means = velocity.copy()
    is_next_step = np.diff(when) == 1  # whether neighbouring states are a step apart
    has_both_neighbours = is_next_step[:-1] & is_next_step[1:]
    mean = velocity[:-2] + velocity[2:]
    mean += 2 * velocity[1:-1]
    mean /= 4
    np.copyto(means[1:-1], mean, where=has_both_neighbours[:, None])
    # At t = 0 velocities may jump, so state 0 must enter no mean: state 1 has a mean
    # from one side, of the states 1 to 4. States 0 to 4 must be consecutive steps.
    if when[0] == 0 and len(when) > 1 and is_next_step[0]:
        means[1] = velocity[1]
        if len(when) > 4 and is_next_step[:4].all():
            means[1] = _one_sided_mean(velocity[1:5])
    if len(when) > 3 and when[-4] > 0 and is_next_step[-3:].all():
        means[-1] = _one_sided_mean(velocity[:-5:-1])  # the last four, backwards
    return means


def _one_sided_mean(velocity: Floats) -> Floats:
    """Mean at the first of four states, [state, node], from the states on one side.

    The mean from both sides is v + (second difference at the state)/4. Here the second
    difference is taken two steps later, where motion that changes its sign from step to
    step has the same sign again. Both means have the same error.
    """
    first, second, third, fourth = velocity
    return np.asarray(first + (second - 2 * third + fourth) / 4)
