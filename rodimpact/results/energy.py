"""Where the energy is, and what brought it there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..methods.run import INWARD, Outside
from ..methods.signals import Floats, product
from .bonded_groups import BondedGroups
from .contacts import ContactHistory
from .fields import Fields


@dataclass(frozen=True)
class EnergyLedger:
    """Where the energy is at some times; every entry has the shape of the times, J.

    Attributes
    ----------
    kinetic : array
        Of the motion of the centres of mass; walls, and masses bonded to them, not counted.
    vibrational_kinetic : array
        Kinetic energy relative to the centres of mass.
    strain : array
        Strain energy.
    contact : array
        Stored in compliant contacts and joints.
    dissipated : array
        Lost in dashpots, in what yields and in impacts of rigid bodies since t = 0.
    damped : array
        Lost in damped material since t = 0.
    numerical : array
        Lost since t = 0 to a grid, by the half cells at ends that meet rigidly. It goes to zero
        with the step, but for lateral inertia by Rayleigh and Love: such ends have mass, and meet
        inelastically.
    radiated : array
        Gone since t = 0 through absorbing ends, less what came in there.
    wall_work, drive_work, gravity_work : array
        Work done since t = 0 by moving walls, driven ends and gravity.
    residual : array
        What is missing: total minus the initial total minus the works, plus the losses.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> ledger = ri.solve(ri.System([left, right])).energy([0.0, 2e-4])
    >>> (ledger.kinetic * 1e3).round(9).tolist()            # mJ
    [157.0, 62.8]
    """

    kinetic: Floats
    vibrational_kinetic: Floats
    strain: Floats
    contact: Floats
    dissipated: Floats
    damped: Floats
    numerical: Floats
    radiated: Floats
    wall_work: Floats
    drive_work: Floats
    gravity_work: Floats
    residual: Floats

    @property
    def vibration(self) -> Floats:
        """Energy of the motion relative to the centres of mass, and of strain, J."""
        return self.vibrational_kinetic + self.strain

    @property
    def total(self) -> Floats:
        """All the energy in the bodies and their contacts, J."""
        return self.kinetic + self.vibration + self.contact


def stored(law: Any, gap: Floats) -> Floats:
    """Energy in a contact whose gap is minus the indentation, or in a joint, J."""
    x = -np.asarray(gap)
    if law.opens:
        x = np.maximum(x, 0.0)
    return np.asarray(law.stored(x)) if hasattr(law, "stored") else np.zeros(x.shape)


def ledger(
    fields: Fields, contacts: Sequence[ContactHistory],
    outside: tuple[Outside | None, Outside | None], states: BondedGroups,
) -> EnergyLedger:
    """Energy ledger at the ticks of the states, the first of which is 0."""
    a, ticks = fields.clock, states.ticks
    t = ticks * a.tick
    works = {kind: np.zeros(t.shape) for kind in ("wall", "drive", "absorbing")}
    path = (states.mass.sum() * a.gravity * t / 2 + states.momentum[0]) * t
    for side, sign in zip(outside, INWARD, strict=True):
        if side is not None:
            power = product(side.push, side.speed)
            works[side.kind] += sign * power.integral(0, ticks) * a.tick
            path = path + sign * side.push.integrated_twice(ticks) * a.tick * a.tick
    fallen = a.gravity * path if a.gravity else np.zeros(t.shape)
    contact, dissipated, numerical = (np.zeros(t.shape) for _ in range(3))
    for history in contacts:
        energy = stored(history.law, history.gap(t))
        lost = history.work_until(t) - (energy - energy[0])
        contact += energy
        if getattr(history.law, "restitution", 0.0) is None:
            numerical += lost
        else:
            dissipated += lost
    damped = fields.damped(ticks)
    in_bodies = states.kinetic, states.moving.sum(axis=0), states.strained.sum(axis=0)
    missing = sum(x - x[0] for x in in_bodies) + contact - contact[0]
    missing += dissipated + damped + numerical
    for work in (*works.values(), fallen):
        missing = missing - work
    return EnergyLedger(
        *in_bodies, contact, dissipated, damped, numerical, -works["absorbing"], works["wall"],
        works["drive"], fallen, missing,
    )
