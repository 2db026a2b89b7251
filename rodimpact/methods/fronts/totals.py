"""Totals of a finished run by fronts, in SI units: contacts, momenta, energies."""

import math
from collections.abc import Sequence

from ...model import Absorbing, Fixed, Free
from ..clock import Clock
from ..groups import body_velocities, first_segments_of_groups
from ..outcome import Motion, Totals, Works, relative_residual
from ..run import ContactTally
from ..states import Status
from ..status import last_contact
from .records import NONE, Node, Run, Segment
from .run import FrontRun


def tally_of(node: Node, tick_duration: float) -> ContactTally:
    """Totals of the contact at a node, in SI units.

    `tick_duration` is in s. The time at which the first force began is nan if there was
    no force. The time at which the last force ended is nan if no force has ended. The
    web page has this function as JavaScript.
    """
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
    """Time at which the last contact ended in a proved run, s.

    `status.last_contact` finds it: 0 if no contact pressed, inf if one presses for
    ever, nan if bodies that touch may still part. Bonds do not count. `contacts` are
    the nodes of the contacts; `round_trip` is the time of a wave through the longest
    body and back, s. The web page has this function as JavaScript.
    """
    ends: list[list[float]] = []  # end of the force and opening, of each contact
    for node in contacts:
        is_contact = node.status >= Status.OPEN  # it can open: it is no bond
        if not is_contact or node.episodes == 0:
            continue
        force_end = math.nan  # the contact still presses
        if node.status != Status.PRESS:
            force_end = node.last_force_tick * run.tick_duration
        opening = math.nan  # the contact is closed, and has not opened since it pressed
        if node.status < Status.GRAZE:  # OPEN or TOUCH: it has opened after the force
            opening = node.last_opening_tick * run.tick_duration
        ends.append([force_end, opening])
    return last_contact(ends, run.now * run.tick_duration, round_trip)


def motion_of(
    clock: Clock,
    masses: list[float],
    velocities: list[float],
    energies: list[float],
) -> Motion:
    """Motion of the bodies, from the motion of the segments.

    The result has the mean velocity in the laboratory, m/s, and the vibration energy,
    J, of each body, and the kinetic energy of the mean motions of all rods together, J.
    A wall has its own velocity and the vibration energy 0, and does not add to the
    kinetic energy. The web page has this function as JavaScript.

    Parameters
    ----------
    clock : Clock
    masses : [body] list of float
        kg; for a wall any number.
    velocities : [segment] list of float
        Velocity of the bonded group of each segment in the frame, m/s. The first and
        the last entry belong to the segments outside the row, and are not used.
    energies : [segment] list of float
        Vibration energies about these velocities, J divided by the duration of a tick.
    """
    row = clock.row
    # Velocities in the laboratory
    segment_velocities = [velocity + clock.frame for velocity in velocities]
    group_velocities = [
        segment_velocities[s] for s in first_segments_of_groups(row.system, row.spans)
    ]
    by_body = body_velocities(row.system, group_velocities)
    vibration = []
    kinetic = 0.0
    # First and last segment of each body, counted from 1; (1, 0) for a wall
    for i, (first, last) in enumerate(row.spans):
        if last > 0:  # a rod: all its segments have the velocity of its group
            kinetic += masses[i] * segment_velocities[first] ** 2 / 2
        # For a wall the sum is empty.
        vibration.append(math.fsum(energies[first : last + 1]) * clock.tick)
    return Motion([float(velocity) for velocity in by_body], vibration, kinetic)


def initial_motion(
    clock: Clock, masses: list[float], segments: list[Segment]
) -> Motion:
    """Motion of the bodies at t = 0, see `motion_of`.

    `masses` [body] are the masses of all bodies, kg. The initial velocities of the
    bonded groups and the vibration energies, J divided by the duration of a tick, are
    those stored in the segments, [segment].

    The web page has this function as JavaScript.
    """
    velocities = [segment.initial_group_velocity for segment in segments]
    energies = [segment.initial_vibration_energy for segment in segments]
    return motion_of(clock, masses, velocities, energies)


def final_motion(clock: Clock, masses: list[float], segments: list[Segment]) -> Motion:
    """Motion of the bodies when it was measured last, see `motion_of`.

    The web page has this function as JavaScript.
    """
    velocities = [segment.group_velocity for segment in segments]
    energies = [segment.vibration_energy for segment in segments]
    return motion_of(clock, masses, velocities, energies)


def totals_of(finished: FrontRun) -> Totals:
    """Totals of a finished run in SI units: masses, motions, works, and residuals.

    The motions are those at t = 0 and at the end. The residuals of the balances of
    momentum and energy are relative to scales that include the momentum and the energy
    of all masses at the velocity scale, as errors of velocities are relative to it.
    """
    clock = finished.clock
    masses = [clock.mass(i) for i in range(len(clock.spans))]
    total_mass = sum(mass for mass in masses if mass < math.inf)  # without walls
    before = initial_motion(clock, masses, finished.segments)
    after = final_motion(clock, masses, finished.segments)
    boundary = BoundaryEffects(finished, masses, after.velocities)
    mass_energy = total_mass * finished.run.velocity_scale**2 / 2
    return Totals(
        masses,
        before,
        after,
        Works(
            wall_work=boundary.wall_work,
            drive_work=boundary.drive_work,
            radiated=boundary.radiated,
        ),
        momentum_residual(finished, total_mass, boundary.impulse),
        energy_residual(before, after, boundary, mass_energy),
    )


def momentum_residual(finished: FrontRun, total_mass: float, impulse: float) -> float:
    """Residual of the balance of momentum: gained momentum less impulse, over a scale.

    It is round-off in an exact run. `impulse` is the impulse on the row from outside,
    N s. The scale is the momentum of all masses, `total_mass`, kg, at the velocity
    scale, plus the absolute impulses of all nodes.
    """
    tick = finished.clock.tick
    # Momenta of segments and impulses of nodes are in N ticks: times the duration of a
    # tick they are in N s.
    start_momentum = math.fsum(
        segment.initial_momentum for segment in finished.segments
    )
    end_momentum = math.fsum(segment.momentum for segment in finished.segments)
    gained = (end_momentum - start_momentum) * tick
    scale = total_mass * finished.run.velocity_scale
    for node in finished.nodes:
        scale += abs(node.impulse) * tick
    return relative_residual(gained - impulse, scale)


def energy_residual(
    before: Motion, after: Motion, boundary: "BoundaryEffects", mass_energy: float
) -> float:
    """Residual of the balance of energy, over a scale.

    It is the gained energy, kinetic and vibration, less the works of walls and drives,
    plus the radiated energy: round-off in an exact run. The scale is the energy at
    t = 0, plus `mass_energy`, the kinetic energy of all masses at the velocity scale,
    J, plus the absolute works and the absolute radiated energy.
    """
    start_energy = before.kinetic + sum(before.vibration)
    missing = after.kinetic + sum(after.vibration) - start_energy
    missing -= boundary.wall_work
    missing -= boundary.drive_work
    missing += boundary.radiated
    scale = start_energy + mass_energy
    for work in (boundary.wall_work, boundary.drive_work, boundary.radiated):
        scale += abs(work)
    return relative_residual(missing, scale)


class BoundaryEffects:
    """Effects of walls, drives and semi-infinite bars on the row.

    Attributes
    ----------
    impulse : float
        Impulse on the row from both ends together, positive to the right, N s.
    wall_work, drive_work : float
        Work of moving walls and of drives on the row, J.
    radiated : float
        Energy that left through absorbing ends, less that of the waves that came in, J.
    """

    def __init__(
        self, finished: FrontRun, masses: list[float], velocities: Sequence[float]
    ) -> None:
        """Add up the effects on both ends of a run, from the totals of the end nodes.

        `masses`, kg, inf for a wall, and `velocities`, m/s in the laboratory, are those
        of the bodies. Work in the laboratory is the work in the frame plus the velocity
        of the frame times the impulse. A free or fixed end does no work.
        """
        self.impulse = 0.0
        self.wall_work = 0.0
        self.drive_work = 0.0
        self.radiated = 0.0
        clock = finished.clock
        for side in (0, -1):  # first and last of nodes, bodies and ends
            # A push on the row acts to the right (+) at its left end, to the left (-)
            # at its right end.
            sign = 1 if side == 0 else -1
            impulse = sign * finished.nodes[side].impulse * clock.tick
            self.impulse += impulse
            end = clock.system.ends[side]
            if masses[side] == math.inf:  # a wall
                self.wall_work += impulse * velocities[side]
            elif not isinstance(end, Free | Fixed):
                # `Node.work` is energy from left to right: it enters the row at the
                # left end (+), and leaves it at the right end (-).
                work = (
                    sign * finished.nodes[side].work * clock.tick
                    + clock.frame * impulse
                )
                if isinstance(end, Absorbing):  # positive work brings energy in
                    self.radiated -= work
                else:
                    self.drive_work += work
