"""Energies of the bodies and contacts, and works and losses, at any time of a run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_missing
from ..methods.groups import groups, movable, velocities_in_group
from ..methods.outcome import Motion, Totals, Works, relative_residual
from ..methods.run import INWARD, Run
from ..methods.signals import Floats, Ints
from ..model import Drag, Rigid, System
from .contacts import ContactHistory
from .fields import Fields


@explain_missing()
@dataclass(frozen=True)
class EnergyLedger:
    """Energy balance at given times; every entry has the shape of the times, J.

    Attributes
    ----------
    kinetic : array
        Kinetic energy of the centres of mass, without walls and masses bonded to walls.
    vibrational_kinetic : array
        Kinetic energy relative to the centres of mass.
    strain : array
        Strain energy.
    contact : array
        Energy stored in compliant contacts and joints.
    dissipated : array
        Energy lost since t = 0 in dashpots, yielding contacts and impacts of rigid
        bodies.
    damped : array
        Energy lost since t = 0 in damped material.
    numerical : array
        Energy lost to the grid since t = 0, because half cells at ends collide
        inelastically. This loss tends to 0 with the time step, except with
        Rayleigh-Love lateral inertia, for which ends have a mass.
    radiated : array
        Energy that has left through absorbing ends since t = 0, minus the energy that
        entered through them.
    soil_work : array
        Work done since t = 0 on soil along the shafts of rods: the energy lost by
        yielding and damping, and the energy stored in the soil.
    drag_work : array
        Energy lost since t = 0 to drag along the shafts of rods.
    wall_work, drive_work, gravity_work : array
        Work done since t = 0 by moving walls, driven ends and gravity.
    residual : array
        Error of the balance: total minus initial total, minus works, plus losses.

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
    soil_work: Floats
    drag_work: Floats
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
        """Total energy of the bodies and their contacts, J."""
        return self.kinetic + self.vibration + self.contact


class BondedGroups(NamedTuple):
    """Motion and energies of groups of bonded bodies at some times, walls left out."""

    ticks: Ints  # [time]
    movable_bodies: list[list[int]]  # by group, see `movable_groups`
    velocity: Floats  # [group, time], m/s, of the centre of mass; 0 if no body can move
    mass: float  # of all groups together, kg
    momentum: Floats  # [time], of all groups together, kg m/s
    kinetic: Floats  # [time], of the motion of all centres of mass, J
    vibrational_kinetic: Floats  # [body, time], relative to its group, J; 0 of a wall
    strain: Floats  # [body, time], strain energy, J; 0 of a wall

    @property
    def vibration(self) -> Floats:
        """Vibrational kinetic energy plus strain energy, J, [body, time]."""
        return self.vibrational_kinetic + self.strain


class BoundaryWorks(NamedTuple):
    """Work done on the row since t = 0 from outside of its two ends, J [time].

    The fields are named like `BoundaryAction.kind`.
    """

    wall: Floats  # by walls
    drive: Floats  # by driven ends
    absorbing: Floats  # by absorbing ends: incoming minus outgoing energy


class ShaftWorks(NamedTuple):
    """Work done since t = 0 on soil and drag along the shafts of rods, J [time]."""

    soil: Floats
    drag: Floats


def bonded_groups(fields: Fields, ticks: Ints) -> BondedGroups:
    """Velocities and energies of groups of bonded bodies at ticks [time].

    Energies must be known at these ticks, see `Fields.nearest_energy_ticks`. Only
    bodies that can move count, see `movable_groups`. The velocity of a group is its
    momentum divided by its mass. A group in which no body can move, such as a single
    wall, has the velocity 0, and no mass or energy.
    """
    clock = fields.clock
    times = ticks * clock.tick
    movable_bodies = movable_groups(clock.system)  # by group
    mass = np.zeros((len(movable_bodies), 1))  # kg [group, 1], to broadcast with times
    velocities = np.zeros((len(movable_bodies), len(ticks)))  # m/s [group, time]
    vibrational_kinetic = np.zeros((len(clock.system.bodies), len(ticks)))
    strain = np.zeros(vibrational_kinetic.shape)
    for g, bodies in enumerate(movable_bodies):
        momentum: Any = 0.0  # kg m/s [time]
        for body in bodies:
            mass[g] += clock.mass(body)
            momentum = momentum + _momentum(fields, body, times)
        if len(bodies) > 0:
            velocities[g] = momentum / mass[g]
        # Vibrational kinetic energies are relative to the velocity of the group.
        for body in bodies:
            energies = _energies(fields, body, ticks, velocities[g])
            vibrational_kinetic[body] = energies.kinetic
            strain[body] = energies.strain
    return BondedGroups(
        ticks=ticks,
        movable_bodies=movable_bodies,
        velocity=velocities,
        mass=float(mass.sum()),
        momentum=np.sum(mass * velocities, axis=0),
        kinetic=np.sum(mass * velocities**2, axis=0) / 2,
        vibrational_kinetic=vibrational_kinetic,
        strain=strain,
    )


def movable_groups(system: System) -> list[list[int]]:
    """Indices of the bodies that can move in each group of bonded bodies.

    They are [group][body], from left to right. Walls and masses that are bonded to
    walls cannot move, so the list of a group may be empty.
    """
    free_bodies = movable(system)
    movable_bodies = []
    for group in groups(system):
        movable_bodies.append([body for body in group if body in free_bodies])
    return movable_bodies


def _momentum(fields: Fields, body: int, times: Floats) -> Floats:
    """Momentum of a rod or of a rigid mass at times [time] in s, kg m/s."""
    if body in fields.rods:
        return fields.momentum(body, times)
    # A mass has one point only, at 0.0 from its left end.
    return fields.clock.mass(body) * fields.velocity(body, 0.0, times)


class BodyEnergies(NamedTuple):
    """Energies of a body at some times, J [time]."""

    kinetic: Floats  # of the motion relative to the group of the body
    strain: Floats


def _energies(
    fields: Fields, body: int, ticks: Ints, group_velocity: Floats
) -> BodyEnergies:
    """Energies of a rod or of a rigid mass at ticks [time], each J [time].

    The kinetic energy is relative to the velocity of its group, m/s [time]. The strain
    energy of a rigid mass is 0. Energies must be known at these ticks.
    """
    kinetic = np.zeros(len(ticks))
    strain = np.zeros(len(ticks))
    is_rod = body in fields.rods
    if not is_rod:  # a rigid mass has one point only, at 0.0 from its left end
        times = ticks * fields.clock.tick
        relative_velocity = fields.velocity(body, 0.0, times) - group_velocity
        mass = fields.clock.mass(body)
        kinetic = mass * relative_velocity * relative_velocity / 2
        return BodyEnergies(kinetic, strain)
    for k, tick in enumerate(ticks.tolist()):
        energy = fields.energy(body, tick, float(group_velocity[k]))
        kinetic[k] = energy.kinetic
        strain[k] = energy.strain
    return BodyEnergies(kinetic, strain)


def stored_energy(law: Any, gap: Floats) -> Floats:
    """Energy that a contact or a joint of this law stores at each gap, m, in J.

    Its compression is minus the gap. It is 0 where a contact is open, and everywhere
    for a law without the method `stored`, such as `Rigid`.
    """
    compression = -gap
    if law.opens:  # a joint does not: it stores energy in tension, too
        compression = np.maximum(compression, 0.0)
    if not hasattr(law, "stored"):
        return np.zeros(compression.shape)
    return np.asarray(law.stored(compression))


class ContactEnergies(NamedTuple):
    """Energies of all contacts together at some times, J [time]."""

    stored: Floats  # in compliant contacts and joints
    dissipated: Floats  # lost since t = 0 in contacts themselves
    numerical: Floats  # lost since t = 0 to the cells of a grid


def _contact_energies(contacts: Sequence[ContactHistory], t: Floats) -> ContactEnergies:
    """Energies of all contacts together at times t in s, the first of which is 0.

    The loss of a contact is the work that the bodies do on it, minus the growth of its
    stored energy. It is `dissipated`, except at a rigid contact without a restitution:
    such a contact only loses energy to the cells of a grid, and its loss is
    `numerical`.
    """
    stored = np.zeros(t.shape)
    dissipated = np.zeros(t.shape)
    numerical = np.zeros(t.shape)
    for history in contacts:
        law = history.law
        stored_here = stored_energy(law, history.gap(t))
        stored += stored_here
        loss = history.work_until(t) - (stored_here - stored_here[0])
        is_ideal = isinstance(law, Rigid) and law.restitution is None
        if is_ideal:
            numerical += loss
        else:
            dissipated += loss
    return ContactEnergies(stored, dissipated, numerical)


def ledger(
    fields: Fields, contacts: Sequence[ContactHistory], states: BondedGroups
) -> EnergyLedger:
    """Energy ledger at the ticks of `states`, the motion of the bonded groups.

    Each entry is J [time]. The first tick must be 0, since losses and works count from
    it. In the balance, residual = energy gained + energy lost + works on shafts - works
    of boundaries and of gravity.
    """
    ticks = states.ticks
    works = _boundary_works(fields, ticks)
    gravity_work = _gravity_work(fields, states)
    at_contacts = _contact_energies(contacts, ticks * fields.clock.tick)
    damped = fields.viscous_loss(ticks)
    on_shafts = _works_on_shafts(fields, ticks)
    vibrational_kinetic = states.vibrational_kinetic.sum(axis=0)  # of all bodies
    strain = states.strain.sum(axis=0)
    gained = states.kinetic - states.kinetic[0]
    gained = gained + (vibrational_kinetic - vibrational_kinetic[0])
    gained = gained + (strain - strain[0])
    gained = gained + at_contacts.stored - at_contacts.stored[0]
    lost = at_contacts.dissipated + damped + at_contacts.numerical
    # Work on soil and drag is energy that leaves the bodies, as losses are.
    residual = gained + (lost + on_shafts.soil)
    residual = residual + on_shafts.drag
    for work in (*works, gravity_work):  # of walls, drives, absorbing ends and gravity
        residual = residual - work
    return EnergyLedger(
        kinetic=states.kinetic,
        vibrational_kinetic=vibrational_kinetic,
        strain=strain,
        contact=at_contacts.stored,
        dissipated=at_contacts.dissipated,
        damped=damped,
        numerical=at_contacts.numerical,
        radiated=-works.absorbing,  # radiated energy is outgoing, the work incoming
        soil_work=on_shafts.soil,
        drag_work=on_shafts.drag,
        wall_work=works.wall,
        drive_work=works.drive,
        gravity_work=gravity_work,
        residual=residual,
    )


def _boundary_works(fields: Fields, ticks: Ints) -> BoundaryWorks:
    """Works of walls, drives and absorbing ends on the row, from t = 0 to each tick.

    Each is the integral of push times speed, J, over the ends of its kind; 0 without
    such an end. A push is positive into the row, a speed to the right, so the power is
    push times speed at the left end, and its opposite at the right end (`INWARD`).
    """
    # The key is the kind of an end, which is the name of a field of `BoundaryWorks`.
    works: dict[str, Floats] = {}
    for kind in BoundaryWorks._fields:
        works[kind] = np.zeros(ticks.shape)
    for end_action, sign in zip(fields.signals.boundary_actions, INWARD, strict=True):
        if end_action is not None:  # a free end has none
            power = end_action.push * end_action.speed
            power_integral = power.integral(0, ticks)
            works[end_action.kind] += sign * power_integral * fields.clock.tick
    return BoundaryWorks(**works)


def _works_on_shafts(fields: Fields, ticks: Ints) -> ShaftWorks:
    """Works on soil and drag along the shafts of all rods, from t = 0 to each tick, J.

    A work is positive where soil or drag takes energy from the rods.
    """
    on_soil = np.zeros(ticks.shape)
    on_drag = np.zeros(ticks.shape)
    for body, action in fields.signals.shafts.items():
        # The power is that on the rod: it is negative where soil or drag takes energy.
        work_on_rod = action.power.integral(0, ticks) * fields.clock.tick
        if isinstance(fields.rods[body].shaft, Drag):
            on_drag -= work_on_rod
        else:
            on_soil -= work_on_rod
    return ShaftWorks(on_soil, on_drag)


def _gravity_work(fields: Fields, states: BondedGroups) -> Floats:
    """Work of gravity on the row from t = 0 to the ticks of the states, J [time].

    It is g times the integral of the momentum over time. This integral is
    (p0 + m g t/2) t, with the momentum p0 at t = 0, plus the integral over time of the
    impulses from the ends of the row and from shafts. Without gravity it is 0.
    """
    clock = fields.clock
    ticks = states.ticks
    t = ticks * clock.tick
    if not clock.gravity:
        return np.zeros(t.shape)
    p0 = states.momentum[0]  # the first tick is that of t = 0
    momentum_integral = (states.mass * clock.gravity * t / 2 + p0) * t
    for end_action, sign in zip(fields.signals.boundary_actions, INWARD, strict=True):
        if end_action is not None:
            push_integral = end_action.push.integrated_twice(ticks)
            # Both integrals are over ticks: each takes the factor of seconds per tick.
            by_push = sign * push_integral * clock.tick * clock.tick
            momentum_integral = momentum_integral + by_push
    for action in fields.signals.shafts.values():
        # A push on a shaft needs no sign: it is positive to the right, as momentum is.
        by_shaft = action.push.integrated_twice(ticks) * clock.tick * clock.tick
        momentum_integral = momentum_integral + by_shaft
    return np.asarray(clock.gravity * momentum_integral)


def totals_of(run: Run, fields: Fields, contacts: Sequence[ContactHistory]) -> Totals:
    """Totals of a finished run: motion before and after, works, losses and residuals.

    They are computed from the ledger at the first and the last tick at which energies
    are known. If the method itself has found the motion (`run.motion`), its velocities
    before and after and its vibration energies after replace those of the fields. The
    residuals of momentum and energy are relative to their scales.
    """
    clock = run.clock
    first_and_last = np.array([0, run.end])
    ticks = np.unique(fields.nearest_energy_ticks(first_and_last))  # one if end is 0
    states = bonded_groups(fields, ticks)
    energies = ledger(fields, contacts, states)
    before = _motion_at(run.system, states, energies, k=0)
    after = _motion_at(run.system, states, energies, k=-1)
    if run.motion is not None:
        found_before, found_after = run.motion
        before = before._replace(velocities=found_before.velocities)
        after = after._replace(
            velocities=found_after.velocities, vibration=found_after.vibration
        )
    works = Works(
        wall_work=float(energies.wall_work[-1]),
        drive_work=float(energies.drive_work[-1]),
        gravity_work=float(energies.gravity_work[-1]),
        radiated=float(energies.radiated[-1]),
        soil_work=float(energies.soil_work[-1]),
        drag_work=float(energies.drag_work[-1]),
        dissipated=float(energies.dissipated[-1]),
        damped=float(energies.damped[-1]),
        numerical=float(energies.numerical[-1]),
        contact_energy=float(energies.contact[-1]),
        contact_energy_before=float(energies.contact[0]),
    )
    masses = []
    for i in range(len(run.system.bodies)):
        masses.append(clock.mass(i))
    initial_energy = float(energies.total[0])
    velocity_scale = clock.scale  # m/s
    energy_scale = _energy_scale(states.mass, works, velocity_scale, initial_energy)
    missing_energy = float(energies.residual[-1])
    return Totals(
        masses=masses,
        before=before,
        after=after,
        works=works,
        momentum_residual=_momentum_residual(run, fields, states),
        energy_residual=relative_residual(missing_energy, energy_scale),
    )


def _energy_scale(
    mass: float, works: Works, velocity_scale: float, initial_energy: float
) -> float:
    """Scale of the energy that is missing in the balance, J.

    It is the sum of the initial energy, of m V^2/2 with the `mass` m of all movable
    bodies, kg, and the velocity scale V, m/s, and of the absolute works of gravity,
    walls, drives, absorbing ends, soil and drag.
    """
    scale = initial_energy + mass * velocity_scale**2 / 2
    scale += abs(works.gravity_work)
    scale += abs(works.wall_work)
    scale += abs(works.drive_work)
    scale += abs(works.radiated)
    scale += abs(works.soil_work)
    scale += abs(works.drag_work)
    return scale


def _momentum_residual(run: Run, fields: Fields, states: BondedGroups) -> float:
    """Missing momentum in the balance at the last tick of `states`, over a scale.

    The missing momentum is the gain of momentum, minus the impulse from outside and
    m g t. The scale is the momentum of all masses at the velocity scale, plus the
    absolute impulses of contacts; unknown impulses (nan) are left out. The result is 0
    if the scale is 0.
    """
    clock = run.clock
    last_tick = states.ticks[-1]
    gained = float(states.momentum[-1] - states.momentum[0])
    from_outside = _impulse_from_outside(fields, last_tick)
    of_gravity = states.mass * clock.gravity * (float(last_tick) * clock.tick)
    missing = gained - from_outside - of_gravity
    velocity_scale = clock.scale  # m/s
    scale = states.mass * velocity_scale
    for tally in run.contacts:
        is_known = not math.isnan(tally.impulse)
        if is_known:
            scale += abs(tally.impulse)
    return relative_residual(missing, scale)


def _motion_at(
    system: System, states: BondedGroups, energies: EnergyLedger, k: int
) -> Motion:
    """Motion of all bodies, including walls, at tick number k of `states`.

    Each body has a velocity, m/s, that of its group or of the wall that holds it, and
    its own vibration energy, J, which is 0 for a wall. The kinetic energy, J, is a
    single number, that of all centres of mass together.
    """
    # By body from left to right: each group holds neighbours, and groups are in order.
    velocities = []
    for g, group in enumerate(groups(system)):
        movable_bodies = states.movable_bodies[g]
        group_velocity = states.velocity[g, k]
        body_velocities = velocities_in_group(
            system, group, movable_bodies, group_velocity
        )
        for velocity in body_velocities:
            velocities.append(float(velocity))
    vibration = states.vibration[:, k].tolist()  # from [body, time]
    return Motion(velocities, vibration, float(energies.kinetic[k]))


def _impulse_from_outside(fields: Fields, tick: int) -> float:
    """Impulse to the right on the row from t = 0 to a tick, N s, without gravity.

    It is the impulse of walls, drives and absorbing ends at the two ends of the row,
    plus that of soil and drag along shafts.
    """
    impulse = 0.0
    for end_action, sign in zip(fields.signals.boundary_actions, INWARD, strict=True):
        if end_action is not None:
            push_integral = float(end_action.push.integral(0, tick))
            # A push is positive inward: `sign` is 1 at the left end, -1 at the right.
            # The factor s per tick makes N s of N ticks.
            impulse += sign * push_integral * fields.clock.tick
    for action in fields.signals.shafts.values():
        # A push on a shaft is positive to the right.
        impulse += float(action.push.integral(0, tick)) * fields.clock.tick
    return impulse
