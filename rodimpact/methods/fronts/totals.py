"""What a finished run by fronts has come to, in SI units."""

import math

from ...model import Absorbing, Bonded, Fixed, Free
from .. import run as runs
from ..clock import Clock
from ..groups import body_velocities, heads
from ..laws import Status
from ..run import ContactTally
from ..status import last_contact
from .records import NONE, Node, Run
from .run import FrontRun


def tally_of(node: Node, tick: float) -> ContactTally:
    """Totals of the contact at a node; the page has this as JavaScript."""
    began = math.nan
    if node.force_began != NONE:
        began = node.force_began * tick
    ended = math.nan
    if node.force_ended != NONE:
        ended = node.force_ended * tick
    impulse = node.impulse * tick
    duration = node.pressed * tick
    return ContactTally(impulse, node.peak_force, duration, began, ended, node.episodes)


def last_of(run: Run, contacts: list[Node], round_trip: float) -> float:
    """When the last contact ended in a proved run, s, as `last_contact` says.

    The page has this as JavaScript.
    """
    ends: list[list[float]] = []
    for node in contacts:
        if node.status < Status.OPEN or node.episodes == 0:
            continue
        force_end = math.nan
        if node.status != Status.PRESS:
            force_end = node.force_ended * run.tick
        opening = math.nan
        if node.status < Status.GRAZE:
            opening = node.opened * run.tick
        ends.append([force_end, opening])
    return last_contact(ends, run.now * run.tick, round_trip)


def totals_of(run: FrontRun) -> runs.Totals:
    """Read the totals off a finished run."""
    clock = run.clock
    masses = [clock.mass(i) for i in range(len(clock.spans))]
    segments = run.segments
    before = Motion(
        clock,
        masses,
        velocities=[segment.initial_velocity for segment in segments],
        vibrations=[segment.initial_vibration for segment in segments],
        momenta=[segment.initial_momentum for segment in segments],
    )
    after = Motion(
        clock,
        masses,
        velocities=[segment.velocity for segment in segments],
        vibrations=[segment.vibration for segment in segments],
        momenta=[segment.momentum for segment in segments],
    )
    outside = Outside(run, masses, after.velocities)
    gained = (after.momentum - before.momentum) * clock.tick
    works = {
        "wall_work": outside.wall_work,
        "drive_work": outside.drive_work,
        "radiated": outside.radiated,
    }
    missing = after.energy - before.energy - outside.wall_work - outside.drive_work
    missing += outside.radiated
    taking_part = before.energy + outside.lent + sum(map(abs, works.values()))
    return runs.Totals(
        masses=masses,
        velocities=(before.velocities, after.velocities),
        kinetic=(before.kinetic, after.kinetic),
        vibration=(before.vibration, after.vibration),
        momentum=(gained - outside.impulse, outside.absolute_momentum),
        energy=(missing, taking_part),
        works=works,
    )


class Motion:
    """Motion of a row at its start or its end, from that of its segments.

    Attributes
    ----------
    velocities, vibration : list of float
        By body: of its centre of mass, m/s; energy about that, J.
    kinetic, energy : float
        Of the centres of mass, and with vibration, J.
    momentum : float
        In the frame, kg m/s over the tick.
    """

    def __init__(
        self,
        clock: Clock,
        masses: list[float],
        velocities: list[float],
        vibrations: list[float],
        momenta: list[float],
    ) -> None:
        own = [velocity + clock.frame for velocity in velocities]
        group_velocities = [own[s] for s in heads(clock.system, clock.spans)]
        by_body = body_velocities(clock.system, group_velocities)
        self.velocities = [float(velocity) for velocity in by_body]
        self.vibration: list[float] = []
        self.kinetic = 0.0
        for mass, (first, last) in zip(masses, clock.spans, strict=True):
            if last > 0:  # no wall
                self.kinetic += mass * own[first] ** 2 / 2
            self.vibration.append(math.fsum(vibrations[first : last + 1]) * clock.tick)
        self.energy = self.kinetic + sum(self.vibration)
        self.momentum = math.fsum(momenta)


class Outside:
    """What walls, drives and endless bars have done.

    Attributes
    ----------
    impulse : float
        To the right, N s.
    wall_work, drive_work, radiated : float
        J.
    lent : float
        Energy that may have gone in and out again, J.
    absolute_momentum : float
        Sum of all momenta that took part, kg m/s.
    """

    def __init__(
        self, run: FrontRun, masses: list[float], velocities: list[float]
    ) -> None:
        self.impulse = 0.0
        self.wall_work = 0.0
        self.drive_work = 0.0
        self.radiated = 0.0
        self.lent = 0.0
        self.absolute_momentum = run.run.absolute_momentum
        self._run = run
        self._moving = sum(mass for mass in masses if mass < math.inf)
        for side in (0, -1):
            sign = 1 if side == 0 else -1
            impulse = sign * run.nodes[side].impulse * run.clock.tick
            self.impulse += impulse
            self.absolute_momentum += abs(impulse)
            if masses[side] == math.inf:
                self._add_wall(side, impulse, velocities[side])
            else:
                self._add_end(side, impulse, sign)

    def _add_wall(self, side: int, impulse: float, speed: float) -> None:
        self.wall_work += impulse * speed
        if isinstance(self._run.clock.system.contacts[side], Bonded):
            self.lent += self._moving * abs(speed) * self._run.run.scale

    def _add_end(self, side: int, impulse: float, sign: int) -> None:
        clock = self._run.clock
        end = clock.system.ends[side]
        if isinstance(end, Free | Fixed):
            return
        work = sign * self._run.nodes[side].work * clock.tick + clock.frame * impulse
        if isinstance(end, Absorbing):
            self.radiated -= work
        else:
            self.drive_work += work
        # What goes in and out again is no more exact than this.
        scale = self._run.run.scale
        self.absolute_momentum += self._moving * scale
        self.lent += self._moving * scale**2 / 2
