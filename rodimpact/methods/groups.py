"""Bodies that are bonded or joined together: which they are, and what their common velocity is.

The page has `body_velocities` and what it calls as JavaScript.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..model import System, Wall
from .walk import parted, walk


def groups(system: Any) -> list[list[int]]:
    """Bodies that are bonded or joined together, from left to right."""
    return parted([law.opens for law in system.contacts])


def unilateral(system: Any) -> list[int]:
    """Contacts that can open."""
    return [k for k, law in enumerate(system.contacts) if law.opens]


def grounds(system: Any, group: list[int]) -> list[Any]:
    """Velocities of the walls and fixed ends that hold a group, from left to right."""
    held: list[Any] = []
    for side, i in enumerate([0, len(system.bodies) - 1]):
        if i in group and system.bodies[i].kind == "wall":
            held.append(system.bodies[i].velocity)
        elif i in group and system.ends[side].kind == "fixed":
            held.append(0.0)
    return held


def velocities_in_group(
    system: Any, group: list[int], inside: list[int], own: Any
) -> list[Any]:
    """Velocities of bodies bonded together: that of the ground that holds them, or their own.

    Between two grounds of different velocity a group has its own: there is none about which it
    swings.

    Parameters
    ----------
    system : System
    group : list of int
    inside : list of int
        Those of them that can move against their ground; there are none in a lone wall.
    own : float or array
        Momentum over mass of those inside, m/s.
    """
    ground = grounds(system, group)
    if len(ground) == 0:
        return [own for _ in group]
    shared, moving = ground[0], inside if len(inside) > 0 else group
    if len(ground) == 2:
        shared = (
            np.where(ground[0] == ground[1], ground[0], own) + 0.0
        )  # a number, where one is
    return [
        ground[0] if i < moving[0] else ground[-1] if i > moving[-1] else shared
        for i in group
    ]


def movable(system: System) -> list[int]:
    """Bodies that can move against the walls: all but the walls and the masses bonded to them."""
    row = walk(system)
    return [
        i
        for i, m in enumerate(row.mass_of)
        if system.bodies[i].kind == "rod" or 0 <= m < len(row.masses)
    ]


def without_walls(system: Any, group: list[int]) -> list[int]:
    """The bodies of a group that are no walls."""
    return [i for i in group if system.bodies[i].kind != "wall"]


def body_velocities(system: Any, own: list[Any]) -> list[Any]:
    """Velocities of the bodies, m/s: `own` of their group, or that of its wall."""
    return [
        v
        for g, group in enumerate(groups(system))
        for v in velocities_in_group(
            system, group, without_walls(system, group), own[g]
        )
    ]


def heads(system: Any, spans: Any) -> list[int]:
    """A segment of each group of bonded rods, from the first and last one of each body."""
    first = [[*without_walls(system, group), *group][0] for group in groups(system)]
    return [spans[body][0] for body in first]


def fill_bonds(
    system: System, forces: list[Any], spent: Callable[[int], Any], pushed: Any
) -> list[Any]:
    """Fill in the forces between bonded rigid bodies, from Newton's law for one after the other.

    Parameters
    ----------
    system : System
    forces : list of signals
        By contact; None between rigid bodies.
    spent : function
        Mass times acceleration of a body.
    pushed : signal
        Force of what is outside the left end.
    """
    whole, rigid = [*forces], [force is None for force in forces]
    held = (
        rigid.index(False)
        if isinstance(system.bodies[0], Wall) and False in rigid
        else 0
    )
    for k in range(held - 1, -1, -1):
        whole[k] = whole[k + 1] + spent(k + 1)
    for k in range(held, len(whole)):
        if rigid[k]:
            whole[k] = (whole[k - 1] if k else pushed) - spent(k)
    return whole
