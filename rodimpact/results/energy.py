"""Where the energy is, and what brought it there: at any times, and over a whole run."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..methods.groups import groups, movable, velocities_in_group
from ..methods.outcome import Motion, Totals, Works, relative_residual
from ..methods.run import INWARD, Run
from ..methods.signals import Floats, Ints
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


class BondedGroups(NamedTuple):
    """Groups of bonded bodies at some times; without walls and what is bonded to them.

    ticks [time]; bodies [group]: the bodies that can move against the walls, none of a lone wall;
    velocity [group, time] of the centre of mass, momentum over mass, in m/s, 0 without such bodies;
    mass of all together, kg; momentum, kg m/s, and kinetic, the energy of the motion of the centres
    of mass, J, of all together [time]; moving, strained [body, time]: kinetic energy relative to
    the velocity of the group, and strain energy, in J, 0 for a wall.
    """

    ticks: Ints
    bodies: list[list[int]]
    velocity: Floats
    mass: float
    momentum: Floats
    kinetic: Floats
    moving: Floats
    strained: Floats


def bonded_groups(fields: Fields, ticks: Ints) -> BondedGroups:
    """Velocities and energies of the groups at [n] ticks at which the fields know energies."""
    a, system, times = fields.clock, fields.clock.system, ticks * fields.clock.tick
    free, rods = movable(system), fields.rods
    bodies = [[i for i in group if i in free] for group in groups(system)]
    mass, velocities = np.zeros((len(bodies), 1)), np.zeros((len(bodies), len(ticks)))
    moving, strained = np.zeros((2, len(system.bodies), len(ticks)))
    for g, (velocity, inside) in enumerate(zip(velocities, bodies, strict=True)):
        mass[g] = sum(a.mass(i) for i in inside)
        velocity[:] = sum(
            fields.momentum(i, times)
            if i in rods
            else a.mass(i) * fields.velocity(i, 0.0, times)
            for i in inside
        ) / (mass[g] or 1.0)
        for i in inside:
            if i in rods:
                known = zip(ticks.tolist(), velocity.tolist(), strict=True)
                moving[i], strained[i] = np.transpose(
                    [fields.energy(i, *at) for at in known]
                )
            else:
                off = fields.velocity(i, 0.0, times) - velocity
                moving[i] = a.mass(i) * off * off / 2
    return BondedGroups(
        ticks,
        bodies,
        velocities,
        float(mass.sum()),
        np.sum(mass * velocities, axis=0),
        np.sum(mass * velocities**2, axis=0) / 2,
        moving,
        strained,
    )


def stored(law: Any, gap: Floats) -> Floats:
    """Energy in a contact whose gap is minus the indentation, or in a joint, J."""
    x = np.maximum(-gap, 0.0) if law.opens else -gap
    return np.asarray(law.stored(x)) if hasattr(law, "stored") else np.zeros(x.shape)


def ledger(
    fields: Fields, contacts: Sequence[ContactHistory], states: BondedGroups
) -> EnergyLedger:
    """Energy ledger at the ticks of the states, the first of which is 0."""
    a, ticks = fields.clock, states.ticks
    t = ticks * a.tick
    works = {kind: np.zeros(t.shape) for kind in ("wall", "drive", "absorbing")}
    path = (states.mass * a.gravity * t / 2 + states.momentum[0]) * t
    for side, sign in zip(fields.signals.outside, INWARD, strict=True):
        if side is not None:
            works[side.kind] += (
                sign * (side.push * side.speed).integral(0, ticks) * a.tick
            )
            path = path + sign * side.push.integrated_twice(ticks) * a.tick * a.tick
    fallen = a.gravity * path if a.gravity else np.zeros(t.shape)
    contact, dissipated, numerical = np.zeros((3, *t.shape))
    for history in contacts:
        energy = stored(history.law, history.gap(t))
        contact += energy
        meets = getattr(history.law, "restitution", 0.0) is None
        lost = numerical if meets else dissipated
        lost += history.work_until(t) - (energy - energy[0])
    damped = fields.damped(ticks)
    in_bodies = states.kinetic, states.moving.sum(axis=0), states.strained.sum(axis=0)
    missing = sum(x - x[0] for x in in_bodies) + contact - contact[0]
    missing += dissipated + damped + numerical
    for work in (*works.values(), fallen):
        missing = missing - work
    return EnergyLedger(
        *in_bodies,
        contact,
        dissipated,
        damped,
        numerical,
        -works["absorbing"],
        works["wall"],
        works["drive"],
        fallen,
        missing,
    )


def totals_of(run: Run, fields: Fields, contacts: Sequence[ContactHistory]) -> Totals:
    """Read the totals off the fields of a finished run: the ledger at its beginning and its end."""
    clock = run.clock
    ticks = np.unique(fields.nearest_known(np.array([0, run.end])))
    states = bonded_groups(fields, ticks)
    book = ledger(fields, contacts, states)
    before = _motion_at(run, states, book, 0)
    after = _motion_at(run, states, book, -1)
    if run.motion is not None:  # the kernel knows better
        before = before._replace(velocities=run.motion[0].velocities)
        after = after._replace(
            velocities=run.motion[1].velocities, vibration=run.motion[1].vibration
        )
    works = Works(
        wall_work=float(book.wall_work[-1]),
        drive_work=float(book.drive_work[-1]),
        gravity_work=float(book.gravity_work[-1]),
        radiated=float(book.radiated[-1]),
        dissipated=float(book.dissipated[-1]),
        damped=float(book.damped[-1]),
        numerical=float(book.numerical[-1]),
        contact_energy=float(book.contact[-1]),
        contact_energy_before=float(book.contact[0]),
    )
    time = float(ticks[-1]) * clock.tick
    impulse = _impulse_from_outside(fields, ticks[-1])
    gained = float(states.momentum[-1] - states.momentum[0])
    missing_momentum = gained - impulse - states.mass * clock.gravity * time
    momentum_scale = states.mass * clock.scale
    for tally in run.contacts:
        if not math.isnan(tally.impulse):
            momentum_scale += abs(tally.impulse)
    energy_scale = float(book.total[0]) + states.mass * clock.scale**2 / 2
    for work in (
        works.gravity_work,
        works.wall_work,
        works.drive_work,
        works.radiated,
    ):
        energy_scale += abs(work)
    return Totals(
        [clock.mass(i) for i in range(len(run.system.bodies))],
        before,
        after,
        works,
        relative_residual(missing_momentum, momentum_scale),
        relative_residual(float(book.residual[-1]), energy_scale),
    )


def _motion_at(
    run: Run, states: BondedGroups, book: EnergyLedger, instant: int
) -> Motion:
    """Motion of the bodies at one of the instants of the states."""
    velocities = []
    for group, inside, own in zip(
        groups(run.system), states.bodies, states.velocity[:, instant], strict=True
    ):
        for velocity in velocities_in_group(run.system, group, inside, own):
            velocities.append(float(velocity))
    vibration = states.moving[:, instant] + states.strained[:, instant]
    return Motion(velocities, vibration.tolist(), float(book.kinetic[instant]))


def _impulse_from_outside(fields: Fields, tick: int) -> float:
    """Impulse to the right that what is outside has given the row since t = 0, N s."""
    impulse = 0.0
    for side, sign in zip(fields.signals.outside, INWARD, strict=True):
        if side is not None:
            impulse += sign * float(side.push.integral(0, tick)) * fields.clock.tick
    return impulse
