"""Where the energy is, and what brought it there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .contacts import ContactHistory
from .fields import Fields
from .model import Bonded, RigidMass, Rod, System, Wall
from .outcome import groups
from .signals import Floats, StepSignal


@dataclass(frozen=True)
class EnergyLedger:
    """Where the energy is at some times; every entry has the shape of the times, J.

    Attributes
    ----------
    kinetic : array
        Of the motion of the centres of mass; walls, and masses bonded to them, not counted.
    vibration : array
        Kinetic energy relative to the centres of mass.
    strain : array
        Strain energy.
    contact : array
        Stored in compliant contacts.
    dissipated : array
        Lost in dashpots and impacts of rigid bodies since t = 0.
    damped : array
        Lost in damped material since t = 0.
    numerical : array
        Lost since t = 0 to the time step: as rigid contacts shut inside of one, where a transit is
        no whole number of them, or by the half cells at the ends on a grid. It goes to zero with
        the step, but for rods with lateral inertia: their ends have mass, and meet inelastically.
    radiated : array
        Gone since t = 0 through absorbing ends.
    wall_work, drive_work, gravity_work : array
        Work done since t = 0 by moving walls, driven ends and gravity.
    residual : array
        What is missing: total minus the initial total minus the works, plus the losses.
    """

    kinetic: Floats
    vibration: Floats
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
    def total(self) -> Floats:
        """All the energy in the bodies and their contacts, J."""
        return self.kinetic + self.vibration + self.strain + self.contact


class Outside(NamedTuple):
    """What acts on one end of the row: its kind, the force on the row, N, and its power, W.

    kind : ``"wall"``, ``"drive"`` or ``"absorbing"``.
    push : pushes to the right at the left end, to the left at the right end
    """

    kind: str
    push: StepSignal
    power: StepSignal


def stored(law: Any, gap: Floats) -> Floats:
    """Energy in a contact whose gap is minus the indentation, J."""
    x = np.maximum(-np.asarray(gap), 0.0)
    energy: Floats = law.stored(x) if hasattr(law, "stored") else np.zeros(x.shape)
    return energy


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


def ledger(
    system: System, fields: Fields, contacts: Sequence[ContactHistory],
    outside: tuple[Outside | None, Outside | None], times: Floats,
) -> EnergyLedger:
    """Energy ledger at times in s; with a time step, at the nearest ends of steps."""
    a = fields.assembly
    ticks = fields.whole(fields.to_ticks(times))
    t = ticks * a.tick
    now, then = (_held(system, fields, x) for x in (ticks, np.zeros(1, np.int64)))
    works = {"wall": np.zeros(t.shape), "drive": np.zeros(t.shape), "absorbing": np.zeros(t.shape)}
    for side in outside:
        if side is not None:
            works[side.kind] += side.power.integral(0, ticks) * a.tick
    free = movable(system)
    total = sum(a.mass(i) for i in free)
    fallen = np.zeros(t.shape)
    if a.gravity:
        momentum: Any = total * a.gravity * t / 2
        momentum = momentum + sum(float(momentum_of(fields, i, np.zeros(1))[0]) for i in free)
        path = momentum * t
        for side, sign in zip(outside, (1, -1), strict=True):
            if side is not None:  # the integral of (t - s) F(s) over s
                edges = np.append(side.push.ticks, fields.end)
                middles = (edges[1:] + edges[:-1]) / 2
                middle = StepSignal(side.push.ticks, side.push.values * middles)
                lever = side.push.integral(0, ticks) * ticks - middle.integral(0, ticks)
                path = path + sign * lever * a.tick * a.tick
        fallen = a.gravity * path
    contact, dissipated, numerical = (np.zeros(t.shape) for _ in range(3))
    for history in contacts:
        kept = stored(history.law, history.gap(t))
        lost = history.work_until(t) - kept
        contact += kept
        if getattr(history.law, "restitution", 0.0) is None:
            numerical += lost
        else:
            dissipated += lost
    damped = fields.damped(ticks)
    numerical += fields.smeared(ticks)
    missing = sum(now) + contact - sum(float(x[0]) for x in then)
    missing = missing + dissipated + damped + numerical
    for work in (*works.values(), fallen):
        missing = missing - work
    return EnergyLedger(
        *now, contact, dissipated, damped, numerical, -works["absorbing"], works["wall"],
        works["drive"], fallen, missing,
    )


def momentum_of(fields: Fields, body: int, times: ArrayLike) -> Floats:
    """Momentum of a rod or a rigid mass, kg m/s, at times in s."""
    if body in fields.masses:
        found: Floats = fields.assembly.mass(body) * fields.mass_velocity(body, times)
        return found
    return fields.momentum(body, times)


def _held(system: System, fields: Fields, ticks: Any) -> tuple[Floats, Floats, Floats]:
    """Kinetic energy of the groups, and vibration and strain in them."""
    a, free = fields.assembly, movable(system)
    times = ticks * a.tick
    kinetic, vibration, strain = (np.zeros(times.shape) for _ in range(3))
    for group in groups(system):
        inside = [i for i in group if i in free]
        if not inside:
            continue
        mass = sum(a.mass(i) for i in inside)
        mean: Any = sum(momentum_of(fields, i, times) for i in inside) / mass
        kinetic += mass * mean * mean / 2
        for i in inside:
            if not isinstance(system.bodies[i], Rod):
                off = fields.mass_velocity(i, times) - mean
                vibration += a.mass(i) * off * off / 2
                continue
            for index in np.ndindex(times.shape):
                moving, strained = fields.energy(i, int(ticks[index]), float(mean[index]))
                vibration[index] += moving
                strain[index] += strained
    return kinetic, vibration, strain
