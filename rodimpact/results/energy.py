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
from ..model import System
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
    """Groups of bonded bodies at some times; of walls there is no motion."""

    ticks: Ints  # [time]
    bodies: list[list[int]]  # by group: those that can move; none of a lone wall
    velocity: Floats  # [group, time], m/s, of the centre of mass; 0 of a lone wall
    mass: float  # of all groups together, kg
    momentum: Floats  # [time], of all groups together, kg m/s
    kinetic: Floats  # [time], of the motion of all centres of mass, J
    vibrational_kinetic: Floats  # [body, time], relative to its group, J; 0 of a wall
    strain: Floats  # [body, time], strain energy, J; 0 of a wall

    @property
    def vibration(self) -> Floats:
        """Energy of the motion within the group, and of strain, J, [body, time]."""
        return self.vibrational_kinetic + self.strain


def bonded_groups(fields: Fields, ticks: Ints) -> BondedGroups:
    """Velocities and energies of the groups at [n] ticks at which the fields know energies."""
    clock = fields.clock
    system = clock.system
    times = ticks * clock.tick
    bodies = movable_groups(system)
    mass = np.zeros((len(bodies), 1))
    velocities = np.zeros((len(bodies), len(ticks)))
    vibrational_kinetic = np.zeros((len(system.bodies), len(ticks)))
    strain = np.zeros((len(system.bodies), len(ticks)))
    for g, group in enumerate(bodies):
        momentum: Any = 0.0
        for i in group:
            mass[g] += clock.mass(i)
            momentum = momentum + _momentum(fields, i, times)
        if len(group) > 0:
            velocities[g] = momentum / mass[g]
        for i in group:
            if i in fields.rods:
                for k, tick in enumerate(ticks.tolist()):
                    energy = fields.energy(i, tick, float(velocities[g, k]))
                    vibrational_kinetic[i, k] = energy.kinetic
                    strain[i, k] = energy.strain
            else:
                relative = fields.velocity(i, 0.0, times) - velocities[g]
                vibrational_kinetic[i] = clock.mass(i) * relative * relative / 2
    return BondedGroups(
        ticks=ticks,
        bodies=bodies,
        velocity=velocities,
        mass=float(mass.sum()),
        momentum=np.sum(mass * velocities, axis=0),
        kinetic=np.sum(mass * velocities**2, axis=0) / 2,
        vibrational_kinetic=vibrational_kinetic,
        strain=strain,
    )


def movable_groups(system: System) -> list[list[int]]:
    """Groups of bonded bodies that can move: a group may have none."""
    free = movable(system)
    movable_bodies = []
    for group in groups(system):
        movable_bodies.append([i for i in group if i in free])
    return movable_bodies


def _momentum(fields: Fields, body: int, times: Floats) -> Floats:
    """Momentum of a rod or of a rigid mass, kg m/s."""
    if body in fields.rods:
        return fields.momentum(body, times)
    return fields.clock.mass(body) * fields.velocity(body, 0.0, times)


def stored(law: Any, gap: Floats) -> Floats:
    """Energy in a contact whose gap is minus the indentation, or in a joint, J."""
    compression = -gap
    if law.opens:
        compression = np.maximum(compression, 0.0)
    if not hasattr(law, "stored"):
        return np.zeros(compression.shape)
    return np.asarray(law.stored(compression))


def ledger(
    fields: Fields, contacts: Sequence[ContactHistory], states: BondedGroups
) -> EnergyLedger:
    """Energy ledger at the ticks of the states, the first of which is 0."""
    clock = fields.clock
    ticks = states.ticks
    t = ticks * clock.tick
    works = _works_from_outside(fields, ticks)
    gravity_work = _gravity_work(fields, states)
    contact = np.zeros(t.shape)
    dissipated = np.zeros(t.shape)
    numerical = np.zeros(t.shape)
    for history in contacts:
        energy = stored(history.law, history.gap(t))
        contact += energy
        loss = history.work_until(t) - (energy - energy[0])
        # Without a restitution, rigid contact loses energy to cells of a grid alone.
        if getattr(history.law, "restitution", 0.0) is None:
            numerical += loss
        else:
            dissipated += loss
    damped = fields.damped(ticks)
    vibrational_kinetic = states.vibrational_kinetic.sum(axis=0)
    strain = states.strain.sum(axis=0)
    gained = states.kinetic - states.kinetic[0]
    gained = gained + (vibrational_kinetic - vibrational_kinetic[0])
    gained = gained + (strain - strain[0])
    residual = gained + contact - contact[0]
    residual += dissipated + damped + numerical
    for work in (*works.values(), gravity_work):
        residual = residual - work
    return EnergyLedger(
        kinetic=states.kinetic,
        vibrational_kinetic=vibrational_kinetic,
        strain=strain,
        contact=contact,
        dissipated=dissipated,
        damped=damped,
        numerical=numerical,
        radiated=-works["absorbing"],
        wall_work=works["wall"],
        drive_work=works["drive"],
        gravity_work=gravity_work,
        residual=residual,
    )


def _works_from_outside(fields: Fields, ticks: Ints) -> dict[str, Floats]:
    """Work done on the ends of the row since t = 0, J, by what is outside of them."""
    works: dict[str, Floats] = {}
    for kind in ("wall", "drive", "absorbing"):
        works[kind] = np.zeros(ticks.shape)
    for side, sign in zip(fields.signals.boundary_actions, INWARD, strict=True):
        if side is not None:
            power = side.push * side.speed
            works[side.kind] += sign * power.integral(0, ticks) * fields.clock.tick
    return works


def _gravity_work(fields: Fields, states: BondedGroups) -> Floats:
    """g (integral of the momentum over time): work of gravity since t = 0, J."""
    clock = fields.clock
    ticks = states.ticks
    t = ticks * clock.tick
    if not clock.gravity:
        return np.zeros(t.shape)
    momentum_integral = (states.mass * clock.gravity * t / 2 + states.momentum[0]) * t
    for side, sign in zip(fields.signals.boundary_actions, INWARD, strict=True):
        if side is not None:
            push_integral = side.push.integrated_twice(ticks)
            by_push = sign * push_integral * clock.tick * clock.tick
            momentum_integral = momentum_integral + by_push
    return np.asarray(clock.gravity * momentum_integral)


def totals_of(run: Run, fields: Fields, contacts: Sequence[ContactHistory]) -> Totals:
    """Read the totals off the fields of a finished run: the ledger at its beginning and its end."""
    clock = run.clock
    ticks = np.unique(fields.nearest_known(np.array([0, run.end])))
    states = bonded_groups(fields, ticks)
    book = ledger(fields, contacts, states)
    before = _motion_at(run, states, book, 0)
    after = _motion_at(run, states, book, -1)
    if run.motion is not None:  # the kernel knows better
        first, last = run.motion
        before = before._replace(velocities=first.velocities)
        after = after._replace(velocities=last.velocities, vibration=last.vibration)
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
    gained_momentum = float(states.momentum[-1] - states.momentum[0])
    gravity_impulse = states.mass * clock.gravity * time
    missing_momentum = gained_momentum - impulse - gravity_impulse
    momentum_scale = states.mass * clock.scale
    for tally in run.contacts:
        if not math.isnan(tally.impulse):
            momentum_scale += abs(tally.impulse)
    energy_scale = float(book.total[0]) + states.mass * clock.scale**2 / 2
    energy_scale += abs(works.gravity_work)
    energy_scale += abs(works.wall_work)
    energy_scale += abs(works.drive_work)
    energy_scale += abs(works.radiated)
    return Totals(
        masses=[clock.mass(i) for i in range(len(run.system.bodies))],
        before=before,
        after=after,
        works=works,
        momentum_residual=relative_residual(missing_momentum, momentum_scale),
        energy_residual=relative_residual(float(book.residual[-1]), energy_scale),
    )


def _motion_at(
    run: Run, states: BondedGroups, book: EnergyLedger, instant: int
) -> Motion:
    """Motion of the bodies at one of the instants of the states."""
    velocities = []
    of_groups = states.velocity[:, instant]
    for g, group in enumerate(groups(run.system)):
        bodies = states.bodies[g]
        for velocity in velocities_in_group(run.system, group, bodies, of_groups[g]):
            velocities.append(float(velocity))
    vibration = states.vibration[:, instant]
    return Motion(velocities, vibration.tolist(), float(book.kinetic[instant]))


def _impulse_from_outside(fields: Fields, tick: int) -> float:
    """Impulse to the right that what is outside has given the row since t = 0, N s."""
    impulse = 0.0
    for side, sign in zip(fields.signals.boundary_actions, INWARD, strict=True):
        if side is not None:
            impulse += sign * float(side.push.integral(0, tick)) * fields.clock.tick
    return impulse
