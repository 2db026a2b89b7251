"""Groups of bodies that are bonded or joined together, and their common velocities.

The web page has `body_velocities`, and the functions that it calls, as JavaScript.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..model import System, Wall
from .row_builder import build_row, split_at


def groups(system: Any) -> list[list[int]]:
    """Groups of bonded or joined bodies from left to right: lists of body numbers.

    A body that is bonded or joined to no other is a group of one.
    """
    # `opens` says whether the contact with this law can open.
    return split_at([law.opens for law in system.contacts])


def unilateral(system: Any) -> list[int]:
    """Numbers of the contacts that can open."""
    return [k for k, law in enumerate(system.contacts) if law.opens]


def anchor_velocities(system: Any, group: list[int]) -> list[Any]:
    """Velocities of the walls and fixed ends that hold a group, m/s.

    The list, from left to right, has at most two entries, and none if nothing holds the
    group. The velocity of a fixed end is 0. `group` has the numbers of the bodies of
    the group, including walls.
    """
    velocities: list[Any] = []
    for side, i in enumerate([0, len(system.bodies) - 1]):  # first and last body
        if i in group and system.bodies[i].kind == "wall":
            velocities.append(system.bodies[i].velocity)
        elif i in group and system.ends[side].kind == "fixed":
            velocities.append(0.0)
    return velocities


def velocities_in_group(
    system: Any, group: list[int], inside: list[int], mean: Any
) -> list[Any]:
    """Velocities of the bodies of a group, m/s, one a body from left to right.

    If no wall or fixed end (an anchor) holds the group, all bodies have its mean
    velocity. Otherwise walls, and masses bonded to them, have the velocity of their
    wall. The bodies that can move have the velocity of the anchor. If the group has two
    anchors with different velocities, they have the mean velocity of the group, as they
    vibrate about neither anchor.

    Parameters
    ----------
    system : System
    group : list of int
        Numbers of the bodies of the group, including walls.
    inside : list of int
        Numbers of the bodies in the group that can move relative to the walls. They are
        neighbours; empty if the group has only walls and masses bonded to them.
    mean : float or array
        Momentum over mass of the bodies in `inside`, m/s.
    """
    anchors = anchor_velocities(system, group)
    if len(anchors) == 0:
        return [mean for _ in group]
    if len(inside) > 0:
        movable_bodies = inside
    else:  # no body can move: all get the velocity of the anchor
        movable_bodies = group
    if len(anchors) == 2:
        # `np.where` chooses for each member of a family. Adding 0 turns an array
        # without dimensions into a number.
        velocity = np.where(anchors[0] == anchors[1], anchors[0], mean) + 0.0
    else:
        velocity = anchors[0]
    velocities = []
    for i in group:
        if i < movable_bodies[0]:  # the left wall, or a mass bonded to it
            velocities.append(anchors[0])
        elif i > movable_bodies[-1]:  # the right wall, or a mass bonded to it
            velocities.append(anchors[-1])
        else:
            velocities.append(velocity)
    return velocities


def movable(system: System) -> list[int]:
    """Numbers of the bodies that can move relative to the walls, in order.

    They are all bodies except walls and the masses bonded to walls.
    """
    row = build_row(system)
    bodies = []
    # `mass_of` is -1 for a rod or a wall, and len(row.masses) or more for a mass bonded
    # to a wall.
    for i, mass in enumerate(row.mass_of):
        is_free_mass = 0 <= mass < len(row.masses)
        if system.bodies[i].kind == "rod" or is_free_mass:
            bodies.append(i)
    return bodies


def without_walls(system: Any, group: list[int]) -> list[int]:
    """The entries of `group`, body numbers, that are not numbers of walls."""
    return [i for i in group if system.bodies[i].kind != "wall"]


def body_velocities(system: Any, means: list[Any]) -> list[Any]:
    """Velocities of all bodies, including walls, m/s.

    Each is the mean velocity of the group of the body, or the velocity of the wall or
    fixed end that holds the group; see `velocities_in_group`. `means` has the mean
    velocity of each group of bonded or joined bodies, m/s; that of a lone wall is not
    used. In a family velocities may be arrays.
    """
    velocities = []
    for g, group in enumerate(groups(system)):
        inside = without_walls(system, group)
        velocities.extend(velocities_in_group(system, group, inside, means[g]))
    return velocities


def first_segments_of_groups(system: Any, spans: Any) -> list[int]:
    """The first segment of each group of bonded or joined bodies, counted from 1.

    It is the first segment of the first body of the group that is not a wall. A lone
    wall has no segment: its entry is 1, and has no meaning.

    Parameters
    ----------
    system : System
        Of rods and walls.
    spans : list of (int, int)
        First and last segment of each body.
    """
    segments = []
    for group in groups(system):
        inside = without_walls(system, group)
        if len(inside) > 0:
            body = inside[0]
        else:
            body = group[0]
        segments.append(spans[body][0])
    return segments


def fill_bonds(
    system: System,
    forces: list[Any],
    inertia_force: Callable[[int], Any],
    pushed: Any,
) -> list[Any]:
    """Return the forces of all contacts, including bonds between rigid bodies.

    By Newton's law, the force on the right of a rigid body is the force on its left
    minus m dv/dt. So an unknown force follows from the force of the contact on its
    left, and an unknown force of the first contact from `pushed`. But if the first body
    is a wall, the force on its left is unknown: then the unknown forces before the
    first known force follow from their right neighbours. If no force is known, all
    follow from `pushed` even so. The argument `forces` is not changed.

    Parameters
    ----------
    system : System
    forces : list of signals
        Force of each contact, N; None, an unknown force, for a bond between rigid
        bodies.
    inertia_force : function
        Takes the number of a body, and returns the signal of its mass times
        acceleration, N.
    pushed : signal
        Force from outside on the left end, N.
    """
    filled = [*forces]
    is_unknown = [force is None for force in forces]
    first = 0  # first contact whose force does not follow from the right
    if isinstance(system.bodies[0], Wall) and False in is_unknown:
        first = is_unknown.index(False)  # the first known force
    # Contact k lies between the bodies k and k + 1.
    for k in range(first - 1, -1, -1):  # from there back to the wall
        filled[k] = filled[k + 1] + inertia_force(k + 1)
    for k in range(first, len(filled)):
        if is_unknown[k]:
            from_left = filled[k - 1] if k > 0 else pushed
            filled[k] = from_left - inertia_force(k)
    return filled
