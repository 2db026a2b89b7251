"""Bodies that are bonded or joined together.

This finds which they are, and their common velocity. The page has `body_velocities` and
what it calls as JavaScript.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..model import System, Wall
from .row_builder import build_row, split_at


def groups(system: Any) -> list[list[int]]:
    """Bodies that are bonded or joined together, from left to right."""
    return split_at([law.opens for law in system.contacts])


def unilateral(system: Any) -> list[int]:
    """Contacts that can open."""
    return [k for k, law in enumerate(system.contacts) if law.opens]


def anchor_velocities(system: Any, group: list[int]) -> list[Any]:
    """Velocities of the walls and fixed ends that hold a group, m/s.

    They come from left to right, two at most, none if nothing holds the group. That of
    a fixed end is 0. `group` has the numbers of its bodies, walls included.
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

    If no wall or fixed end holds the group, all have its mean velocity. Walls, and
    masses bonded to them, have the velocity of their wall. The others have that of what
    holds the group. Where it is held on both sides, at different velocities, they have
    the mean: they swing about neither.

    Parameters
    ----------
    system : System
    group : list of int
        Numbers of its bodies, walls included.
    inside : list of int
        Those of them that can move against the walls: neighbours, and none in a lone
        wall.
    mean : float or array
        Momentum over mass of those inside, m/s.
    """
    anchors = anchor_velocities(system, group)
    if len(anchors) == 0:
        return [mean for _ in group]
    if len(inside) > 0:
        moving = inside
    else:  # walls and what is bonded to them alone
        moving = group
    # Velocity of those that can move
    if len(anchors) == 2:
        # In a family each member decides. Adding 0 makes a number of an array of no
        # dimension.
        shared = np.where(anchors[0] == anchors[1], anchors[0], mean) + 0.0
    else:
        shared = anchors[0]
    velocities = []
    for i in group:
        if i < moving[0]:  # the left wall, or bonded to it
            velocities.append(anchors[0])
        elif i > moving[-1]:  # the right one
            velocities.append(anchors[-1])
        else:
            velocities.append(shared)
    return velocities


def movable(system: System) -> list[int]:
    """Numbers of the bodies that can move against the walls, in order.

    They are all but the walls and the masses bonded to them.
    """
    row = build_row(system)
    bodies = []
    # `mass_of` has -1 for a rod or a wall, and numbers behind those of the masses for
    # what is bonded to a wall.
    for i, mass in enumerate(row.mass_of):
        is_free_mass = 0 <= mass < len(row.masses)
        if system.bodies[i].kind == "rod" or is_free_mass:
            bodies.append(i)
    return bodies


def without_walls(system: Any, group: list[int]) -> list[int]:
    """Numbers of the bodies of a group that are no walls."""
    return [i for i in group if system.bodies[i].kind != "wall"]


def body_velocities(system: Any, means: list[Any]) -> list[Any]:
    """Velocities of all bodies, walls included, m/s.

    Each is the mean of its group, or that of the wall or fixed end that holds the
    group; see `velocities_in_group`. `means` has the mean velocity of each group of
    bonded or joined bodies, m/s.
    """
    velocities = []
    for g, group in enumerate(groups(system)):
        inside = without_walls(system, group)
        velocities.extend(velocities_in_group(system, group, inside, means[g]))
    return velocities


def first_segments_of_groups(system: Any, spans: Any) -> list[int]:
    """The first segment of each group of bonded or joined bodies, counted from 1.

    It is that of its first body that is no wall. A lone wall has no segment: what is
    returned for it, the first entry of its span, has no meaning, and its velocity is
    its own.

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
    """Return the forces of all contacts, also those between bonded rigid bodies.

    By Newton's law the force on the right of a rigid body is that on its left less m
    dv/dt. So an unknown force follows from the one before, the first one from `pushed`.
    In a row with a wall on the left it is not known what pushes the wall: there the
    forces before the first known one follow from the one behind each. If none is known,
    the first one follows from `pushed` all the same. The argument `forces` is not
    changed.

    Parameters
    ----------
    system : System
    forces : list of signals
        By contact, N; None, an unknown force, between bonded rigid bodies.
    inertia_force : function
        Mass times acceleration of the body of this number, a signal, N.
    pushed : signal
        Force of what is outside the left end, N.
    """
    filled = [*forces]
    is_rigid = [force is None for force in forces]  # a bond of rigid bodies
    first = 0  # first contact whose force does not follow from the right
    if isinstance(system.bodies[0], Wall) and False in is_rigid:
        first = is_rigid.index(False)
    # Contact k lies between the bodies k and k + 1.
    for k in range(first - 1, -1, -1):  # from the first known force to the wall
        filled[k] = filled[k + 1] + inertia_force(k + 1)
    for k in range(first, len(filled)):
        if is_rigid[k]:
            from_left = filled[k - 1] if k > 0 else pushed
            filled[k] = from_left - inertia_force(k)
    return filled
