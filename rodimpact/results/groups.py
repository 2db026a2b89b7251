"""Bodies that are bonded together: their common velocity, and the energy of what moves about it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..model import Bonded, Fixed, RigidMass, Rod, System, Wall
from .fields import Fields
from .signals import Floats, Ints


def groups(system: System) -> list[list[int]]:
    """Bodies that are bonded together, from left to right."""
    found: list[list[int]] = [[0]]
    for i, law in enumerate(system.contacts):
        if isinstance(law, Bonded):
            found[-1].append(i + 1)
        else:
            found.append([i + 1])
    return found


def grounds(system: System, group: list[int]) -> list[Any]:
    """Velocities of the walls and fixed ends that hold a group, from left to right."""
    walls = [b.velocity for i in group if isinstance(b := system.bodies[i], Wall)]
    left = [0.0] if 0 in group and isinstance(system.ends[0], Fixed) else []
    last = len(system.bodies) - 1
    right = [0.0] if last in group and isinstance(system.ends[1], Fixed) else []
    return [*left, *walls, *right]


def velocities_in_group(
    system: System, group: list[int], inside: list[int], own: Any
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
    if not ground:
        return [own] * len(group)
    shared = ground[0]
    if len(ground) == 2:
        shared = np.where(np.equal(*ground), shared, own)[()]
    moving = inside or group
    return [
        ground[0] if i < moving[0] else ground[-1] if i > moving[-1] else shared for i in group
    ]


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


class GroupStates(NamedTuple):
    """Groups of bonded bodies at some times; without walls and what is bonded to them.

    bodies [group]: the bodies that can move against the walls; mass [group] in kg; velocity
    [group, time] of the centre of mass, momentum over mass, in m/s; moving, strained [body, time]:
    kinetic energy relative to that velocity, and strain energy, in J, 0 for a wall.
    """

    ticks: Ints
    bodies: list[list[int]]
    mass: Floats
    velocity: Floats
    moving: Floats
    strained: Floats

    @property
    def momentum(self) -> Floats:
        """Of all groups together, by time, kg m/s."""
        found: Floats = np.sum(self.mass[:, None] * self.velocity, axis=0)
        return found

    @property
    def kinetic(self) -> Floats:
        """Energy of the motion of the centres of mass, by time, J."""
        found: Floats = np.sum(self.mass[:, None] * self.velocity**2, axis=0) / 2
        return found


def group_states(system: System, fields: Fields, ticks: Ints) -> GroupStates:
    """Velocities and energies of the groups at [n] ticks at which the fields know energies."""
    a, free = fields.assembly, movable(system)
    times = ticks * a.tick
    bodies = [inside for group in groups(system) if (inside := [i for i in group if i in free])]
    masses, velocities = [], np.zeros((len(bodies), len(ticks)))
    moving, strained = np.zeros((2, len(system.bodies), len(ticks)))
    for place, inside in enumerate(bodies):
        masses.append(sum(a.mass(i) for i in inside))
        momentum: Any = sum(
            a.mass(i) * fields.mass_velocity(i, times) if i in fields.masses
            else fields.momentum(i, times) for i in inside
        )
        velocities[place] = momentum / masses[-1]
        for i in inside:
            if not isinstance(system.bodies[i], Rod):
                off = fields.mass_velocity(i, times) - velocities[place]
                moving[i] = a.mass(i) * off * off / 2
                continue
            for n, tick in enumerate(ticks.tolist()):
                moving[i, n], strained[i, n] = fields.energy(i, tick, float(velocities[place, n]))
    return GroupStates(ticks, bodies, np.array(masses), velocities, moving, strained)
