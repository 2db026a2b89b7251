"""Totals of a finished run by fronts, in SI units: contacts, momenta, energies."""

import math

from ...model import Absorbing, Fixed, Free
from .. import run as runs
from ..clock import Clock
from ..groups import body_velocities, heads
from ..laws import Status
from ..run import ContactTally
from ..status import last_contact
from .records import NONE, Node, Run
from .run import FrontRun


def tally_of(node: Node, tick_duration: float) -> ContactTally:
    """Totals of the contact at a node; the page has this as JavaScript."""
    first = math.nan
    if node.first_force_tick != NONE:
        first = node.first_force_tick * tick_duration
    last = math.nan
    if node.last_force_tick != NONE:
        last = node.last_force_tick * tick_duration
    impulse = node.impulse * tick_duration
    duration = node.force_ticks * tick_duration
    return ContactTally(impulse, node.peak_force, duration, first, last, node.episodes)


def last_contact_end(run: Run, contacts: list[Node], round_trip: float) -> float:
    """When the last contact ended in a proved run, s, as `last_contact` says.

    The page has this as JavaScript.
    """
    ends: list[list[float]] = []
    for node in contacts:
        if node.status < Status.OPEN or node.episodes == 0:
            continue
        force_end = math.nan
        if node.status != Status.PRESS:
            force_end = node.last_force_tick * run.tick_duration
        opening = math.nan
        if node.status < Status.GRAZE:
            opening = node.last_opening_tick * run.tick_duration
        ends.append([force_end, opening])
    return last_contact(ends, run.now * run.tick_duration, round_trip)


def totals_of(run: FrontRun) -> runs.Totals:
    """Totals of a finished run."""
    clock = run.clock
    masses = [clock.mass(i) for i in range(len(clock.spans))]
    segments = run.segments
    before = Motion(
        clock,
        masses,
        velocities=[segment.initial_group_velocity for segment in segments],
        vibrations=[segment.initial_vibration_energy for segment in segments],
        momenta=[segment.initial_momentum for segment in segments],
    )
    after = Motion(
        clock,
        masses,
        velocities=[segment.group_velocity for segment in segments],
        vibrations=[segment.vibration_energy for segment in segments],
        momenta=[segment.momentum for segment in segments],
    )
    boundary = BoundaryAction(run, masses, after.velocities)
    works = {
        "wall_work": boundary.wall_work,
        "drive_work": boundary.drive_work,
        "radiated": boundary.radiated,
    }
    gained = (after.momentum - before.momentum) * clock.tick
    missing_energy = after.energy - before.energy
    missing_energy -= boundary.wall_work
    missing_energy -= boundary.drive_work
    missing_energy += boundary.radiated

    # Errors of velocities are relative to the velocity scale, so those of the balances
    # are relative to the momentum and energy of all masses at that velocity.
    velocity_scale = run.run.velocity_scale
    total_mass = sum(mass for mass in masses if mass < math.inf)
    momentum_scale = total_mass * velocity_scale
    for node in run.nodes:
        momentum_scale += abs(node.impulse) * clock.tick
    energy_scale = before.energy + total_mass * velocity_scale**2 / 2
    for work in works.values():
        energy_scale += abs(work)
    return runs.Totals(
        masses=masses,
        velocities=(before.velocities, after.velocities),
        kinetic=(before.kinetic, after.kinetic),
        vibration=(before.vibration, after.vibration),
        momentum=(gained - boundary.impulse, momentum_scale),
        energy=(missing_energy, energy_scale),
        works=works,
    )


class Motion:
    """Motion of a row at its start or its end, from that of its segments.

    Attributes
    ----------
    velocities : [body]
        Velocities of the centres of mass, m/s.
    vibration : [body]
        Vibration energies about these motions, J.
    kinetic : float
        Kinetic energy of the centres of mass, J.
    energy : float
        Kinetic and vibration energy of all bodies, J.
    momentum : float
        Momentum in the frame, kg m/s, divided by the tick.
    """

    def __init__(
        self,
        clock: Clock,
        masses: list[float],
        velocities: list[float],
        vibrations: list[float],
        momenta: list[float],
    ) -> None:
        of_segments = [velocity + clock.frame for velocity in velocities]
        group_segments = heads(clock.system, clock.spans)
        group_velocities = [of_segments[s] for s in group_segments]
        by_body = body_velocities(clock.system, group_velocities)
        self.velocities = [float(velocity) for velocity in by_body]
        self.vibration: list[float] = []
        self.kinetic = 0.0
        for mass, (first, last) in zip(masses, clock.spans, strict=True):
            if last > 0:  # no wall
                self.kinetic += mass * of_segments[first] ** 2 / 2
            self.vibration.append(math.fsum(vibrations[first : last + 1]) * clock.tick)
        self.energy = self.kinetic + sum(self.vibration)
        self.momentum = math.fsum(momenta)


class BoundaryAction:
    """Effects of walls, drives and semi-infinite bars on the row.

    Attributes
    ----------
    impulse : float
        Impulse to the right, N s.
    wall_work, drive_work : float
        Work of moving walls and of drives, J.
    radiated : float
        Energy that left through absorbing ends, J.
    """

    def __init__(
        self, run: FrontRun, masses: list[float], velocities: list[float]
    ) -> None:
        self.impulse = 0.0
        self.wall_work = 0.0
        self.drive_work = 0.0
        self.radiated = 0.0
        clock = run.clock
        for side in (0, -1):
            sign = 1 if side == 0 else -1
            impulse = sign * run.nodes[side].impulse * clock.tick
            self.impulse += impulse
            end = clock.system.ends[side]
            if masses[side] == math.inf:
                self.wall_work += impulse * velocities[side]
            elif not isinstance(end, Free | Fixed):
                work = sign * run.nodes[side].work * clock.tick + clock.frame * impulse
                if isinstance(end, Absorbing):
                    self.radiated -= work
                else:
                    self.drive_work += work
