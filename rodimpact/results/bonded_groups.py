"""Groups of bonded bodies at any time: their velocity, and the energy of what moves about it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..methods.groups import groups, movable
from ..methods.signals import Floats, Ints
from ..model import Rod, System
from .fields import Fields


class BondedGroups(NamedTuple):
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
        return np.asarray(np.sum(self.mass[:, None] * self.velocity, axis=0))

    @property
    def kinetic(self) -> Floats:
        """Energy of the motion of the centres of mass, by time, J."""
        return np.asarray(np.sum(self.mass[:, None] * self.velocity**2, axis=0) / 2)


def bonded_groups(system: System, fields: Fields, ticks: Ints) -> BondedGroups:
    """Velocities and energies of the groups at [n] ticks at which the fields know energies."""
    a, free = fields.clock, movable(system)
    times = ticks * a.tick
    bodies = [inside for group in groups(system) if (inside := [i for i in group if i in free])]
    masses, velocities = [], np.zeros((len(bodies), len(ticks)))
    moving, strained = np.zeros((2, len(system.bodies), len(ticks)))
    for place, inside in enumerate(bodies):
        masses.append(sum(a.mass(i) for i in inside))
        momentum: Any = sum(
            a.mass(i) * fields.rigid_velocity(i, times) if i in fields.masses
            else fields.momentum(i, times) for i in inside
        )
        velocities[place] = momentum / masses[-1]
        for i in inside:
            if not isinstance(system.bodies[i], Rod):
                off = fields.rigid_velocity(i, times) - velocities[place]
                moving[i] = a.mass(i) * off * off / 2
                continue
            for n, tick in enumerate(ticks.tolist()):
                moving[i, n], strained[i, n] = fields.energy(i, tick, float(velocities[place, n]))
    return BondedGroups(ticks, bodies, np.array(masses), velocities, moving, strained)
