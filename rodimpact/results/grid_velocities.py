"""Velocities of the nodes of a grid, less the motion that viscosity leaves in its mesh.

In damped rods these are the rates at which displacements change over two steps,

    (v[n - 1] + 2 v[n] + v[n + 1])/4.

Viscosity leaves a motion that changes its sign from node to node and from step to step,
since its mean over a step is 0. Contacts excite it, and it would be most of the error
at an end. It is no part of displacements.
"""

import numpy as np

from ..methods.grid.mesh import GridMotion
from ..methods.signals import Floats, Ints


def node_velocities(motion: GridMotion) -> Floats:
    """Velocities of all nodes in the frame, m/s [state, node]; means in damped rods.

    A node beside a cell with viscosity has the mean over two steps about each state;
    the others have their velocities as they are, and so have all nodes if there are
    fewer than three states. The array of the motion is not changed, and is returned
    itself where there are no means.
    """
    velocity = motion.velocity
    viscosity = motion.cells.viscous  # [cell]; cell n lies left of node n
    is_damped = viscosity[:-1] + viscosity[1:] > 0  # [node], by the cells beside it
    if not is_damped.any() or len(motion.when) < 3:
        return velocity
    # Means are made from the first to the last damped node, undamped nodes between them
    # included, and copied to damped nodes alone.
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

    `when` is the number of the time step of each state. Where the state of the step
    before or after was not kept, the velocity itself stays, as it does at t = 0. The
    state at t = 0 counts in no mean. The state after it and the last one have one-sided
    means, v + (second difference two steps away)/4: of the state after t = 0, if the
    states of the next three steps were kept, and of the last, if those of the three
    steps before were.
    """
    means = velocity.copy()
    is_next_step = np.diff(when) == 1  # whether neighbouring states are a step apart
    has_both_neighbours = is_next_step[:-1] & is_next_step[1:]
    mean = velocity[:-2] + velocity[2:]
    mean += 2 * velocity[1:-1]
    mean /= 4
    np.copyto(means[1:-1], mean, where=has_both_neighbours[:, None])
    # At t = 0 velocities may jump, so that no mean may count the state 0: state 1 has
    # none over both its sides. The states 0 to 4 must be consecutive.
    if when[0] == 0 and len(when) > 1 and is_next_step[0]:
        means[1] = velocity[1]
        if len(when) > 4 and is_next_step[:4].all():
            means[1] = _one_sided_mean(velocity[1:5])
    if len(when) > 3 and when[-4] > 0 and is_next_step[-3:].all():
        means[-1] = _one_sided_mean(velocity[:-5:-1])  # the last four, backwards
    return means


def _one_sided_mean(velocity: Floats) -> Floats:
    """Mean at the first of four states in a row, from one side.

    It has the same error as the mean from both sides. The mean is v + (second
    difference about it)/4. Here that is taken two steps later, where motion that
    changes its sign from step to step has the same sign again.
    """
    first, second, third, fourth = velocity
    return np.asarray(first + (second - 2 * third + fourth) / 4)
