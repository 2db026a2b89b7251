"""Totals of a finished run by fronts, in SI units: contacts, momenta, energies."""

import math
from collections.abc import Sequence

from ...model import Absorbing, Fixed, Free
from ..clock import Clock
from ..groups import body_velocities, segments_of_groups
from ..outcome import Motion, Totals, Works, relative_residual
from ..run import ContactTally
from ..states import Status
from ..status import last_contact
from .records import NONE, Node, Run, Segment
from .run import FrontRun


def tally_of(node: Node, tick_duration: float) -> ContactTally:
    """Totals of the contact at a node, in SI units; the page has this as JavaScript.

    `tick_duration` is in s. Both times of the force are nan if there was none; the last
    one is nan, too, while the first force acts on.
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

    It is found by `status.last_contact`: 0 if none pressed, inf if one goes on
    pressing, nan if bodies that touch may still part. Bonds are no contacts here.
    `round_trip` is the longest time in a body there and back, s. The page has this as
    JavaScript.
    """
    ends: list[list[float]] = []
    for node in contacts:
        is_contact = node.status >= Status.OPEN  # one that can open, no bond
        if not is_contact or node.episodes == 0:
            continue
        force_end = math.nan  # it presses on
        if node.status != Status.PRESS:
            force_end = node.last_force_tick * run.tick_duration
        opening = math.nan
        if node.status < Status.GRAZE:  # it is open, or touches without having pressed
            opening = node.last_opening_tick * run.tick_duration
        ends.append([force_end, opening])
    return last_contact(ends, run.now * run.tick_duration, round_trip)


def motion_of(
    clock: Clock,
    masses: list[float],
    velocities: list[float],
    energies: list[float],
) -> Motion:
    """Motion of the bodies, from that of the segments; the page has this as JavaScript.

    It has the mean velocity, m/s, and the vibration energy, J, of each body, and the
    kinetic energy of the mean motions of all rods together, J. A wall has its own
    velocity, and no energies.

    Parameters
    ----------
    clock : Clock
    masses : [body] list of float
        kg; of a wall any number.
    velocities : [segment] list of float
        Velocities of the groups in the frame, m/s, the outside counted.
    energies : [segment] list of float
        Vibration energies about these motions, J over the tick.
    """
    row = clock.row
    # In the laboratory
    segment_velocities = [velocity + clock.frame for velocity in velocities]
    group_velocities = [
        segment_velocities[s] for s in segments_of_groups(row.system, row.spans)
    ]
    by_body = body_velocities(row.system, group_velocities)
    vibration = []
    kinetic = 0.0
    for i, (first, last) in enumerate(row.spans):
        if last > 0:  # a rod, whose segments all have the velocity of its group
            kinetic += masses[i] * segment_velocities[first] ** 2 / 2
        # The span (1, 0) of a wall makes an empty sum.
        vibration.append(math.fsum(energies[first : last + 1]) * clock.tick)
    return Motion([float(velocity) for velocity in by_body], vibration, kinetic)


def initial_motion(
    clock: Clock, masses: list[float], segments: list[Segment]
) -> Motion:
    """Motion of the bodies at t = 0, see `motion_of`; the page has it as JavaScript."""
    velocities = [segment.initial_group_velocity for segment in segments]
    energies = [segment.initial_vibration_energy for segment in segments]
    return motion_of(clock, masses, velocities, energies)


def final_motion(clock: Clock, masses: list[float], segments: list[Segment]) -> Motion:
    """Motion of the bodies when it was measured last, see `motion_of`.

    The page has this as JavaScript.
    """
    velocities = [segment.group_velocity for segment in segments]
    energies = [segment.vibration_energy for segment in segments]
    return motion_of(clock, masses, velocities, energies)


def totals_of(finished: FrontRun) -> Totals:
    """Totals of a finished run in SI units: masses, motions, works, and balances.

    Errors of velocities are relative to the velocity scale, so the residuals of the
    balances are relative to the momentum and the energy of all masses at that velocity.
    """
    clock = finished.clock
    masses = [clock.mass(i) for i in range(len(clock.spans))]
    total_mass = sum(mass for mass in masses if mass < math.inf)  # walls have inf
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
    """Momentum that the row gained, less the impulse from outside, over a scale.

    It is round-off in an exact run. `impulse` is that from outside, N s. The scale is
    the momentum of all masses, `total_mass`, kg, at the velocity scale, plus the
    impulses of all nodes.
    """
    tick = finished.clock.tick
    # Momenta of segments are in N ticks, as impulses of nodes are:
    # times the tick they are in N s.
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
    """Energy that the row gained, less works, plus what was radiated, over a scale.

    It is round-off in an exact run. Energies are kinetic and vibration energies. The
    scale is the energy at t = 0, plus `mass_energy`, that of all masses at the
    velocity scale, J, plus the absolute works.
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
        Impulse to the right, N s.
    wall_work, drive_work : float
        Work of moving walls and of drives, J.
    radiated : float
        Energy that left through absorbing ends, J.
    """

    def __init__(
        self, finished: FrontRun, masses: list[float], velocities: Sequence[float]
    ) -> None:
        """Add up what acted on both ends of a run, from the totals of the end nodes.

        Masses, kg, inf for a wall, and velocities, m/s, are those of the bodies. Work
        in the laboratory is work in the frame plus velocity of the frame times impulse.
        A free or fixed end does no work.
        """
        self.impulse = 0.0
        self.wall_work = 0.0
        self.drive_work = 0.0
        self.radiated = 0.0
        clock = finished.clock
        for side in (0, -1):  # first and last of nodes, bodies and ends
            # A push on the row acts to the right at its left end,
            # to the left at its right end.
            sign = 1 if side == 0 else -1
            impulse = sign * finished.nodes[side].impulse * clock.tick
            self.impulse += impulse
            end = clock.system.ends[side]
            if masses[side] == math.inf:  # a wall
                self.wall_work += impulse * velocities[side]
            elif not isinstance(end, Free | Fixed):
                work = (
                    sign * finished.nodes[side].work * clock.tick
                    + clock.frame * impulse
                )
                if isinstance(end, Absorbing):  # positive work brings energy in
                    self.radiated -= work
                else:
                    self.drive_work += work
