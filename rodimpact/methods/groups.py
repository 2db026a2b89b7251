"""Bodies that are bonded or joined together: which they are, and what their common velocity is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..model import Bonded, Fixed, RigidMass, System, Wall


def groups(system: System) -> list[list[int]]:
    """Bodies that are bonded or joined together, from left to right."""
    return groups_between([law.opens for law in system.contacts])


def groups_between(opens: list[bool]) -> list[list[int]]:
    """The groups, from whether each contact can open; the page has this as JavaScript."""
    found = [[0]]
    for i, able in enumerate(opens):
        if able:
            found.append([])
        found[-1].append(i + 1)
    return found


def unilateral(system: System) -> list[int]:
    """Contacts that can open."""
    return [k for k, law in enumerate(system.contacts) if law.opens]


def grounds(system: System, group: list[int]) -> list[Any]:
    """Velocities of the walls and fixed ends that hold a group, from left to right."""
    held: list[Any] = []
    for at, here in ((0, group[0] == 0), (-1, group[-1] == len(system.bodies) - 1)):
        if here and isinstance(body := system.bodies[at], Wall):
            held.append(body.velocity)
        elif here and isinstance(system.ends[at], Fixed):
            held.append(0.0)
    return held


def velocities_in_group(system: System, group: list[int], inside: list[int], own: Any) -> list[Any]:
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
    return velocities_on_ground(grounds(system, group), group, inside, own)


def velocities_on_ground(
    ground: list[Any], group: list[int], inside: list[int], own: Any
) -> list[Any]:
    """As `velocities_in_group`, from the `grounds`; the page has this as JavaScript."""
    if len(ground) == 0:
        return [own for _ in group]
    shared, moving = ground[0], inside if len(inside) > 0 else group
    if len(ground) == 2:
        shared = np.where(ground[0] == ground[1], ground[0], own) + 0.0  # a number, where one is
    return [ground[0] if i < moving[0] else ground[-1] if i > moving[-1] else shared for i in group]


def movable(system: System) -> list[int]:
    """Bodies that can move against the walls: all but the walls and the masses bonded to them."""
    count, held = len(system.bodies), set()
    for start, step in ((0, 1), (count - 1, -1)):
        i, bonded = start, isinstance(system.bodies[start], Wall)
        while bonded:
            held.add(i)
            i += step
            bonded = (
                0 <= i < count
                and isinstance(system.bodies[i], RigidMass)
                and isinstance(system.contacts[min(i, i - step)], Bonded)
            )
    return [i for i in range(count) if i not in held]


def body_velocities(
    system: System, first: Sequence[int], frame: Any, *stocks: Sequence[Any]
) -> list[list[Any]]:
    """Velocities of the bodies at some times, m/s: of their group, or of its wall.

    Parameters
    ----------
    system : System
    first : sequence of int
        First segment of each body.
    frame : float or array
    *stocks : sequence of float or array
        Velocities by segment, in the frame, at each of the times; for a family, one array of its
        shape a segment.
    """
    velocities: list[list[Any]] = [[] for _ in stocks]
    for group in groups(system):
        inside = [i for i in group if not isinstance(system.bodies[i], Wall)]
        s = first[(inside or group)[0]]
        for found, stock in zip(velocities, stocks, strict=True):
            found += velocities_in_group(system, group, inside, stock[s] + frame)
    return velocities


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
    held = rigid.index(False) if isinstance(system.bodies[0], Wall) and False in rigid else 0
    for k in range(held - 1, -1, -1):
        whole[k] = whole[k + 1] + spent(k + 1)
    for k in range(held, len(whole)):
        if rigid[k]:
            whole[k] = (whole[k - 1] if k else pushed) - spent(k)
    return whole
