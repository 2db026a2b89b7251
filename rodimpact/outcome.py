"""What a collision did: velocities of the bodies before and after, impulse, restitution, energy.

Read off the tallies that the kernel keeps while it runs and off the waves left at the end; the
signals are not needed. Bodies bonded together move, for an outcome, with their common velocity.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .contacts import ContactTally
from .groups import groups, velocities_in_group
from .methods.abilities import driven
from .methods.assembly import Assembly
from .methods.fronts import FrontRun
from .methods.layout_kernel import TOLERANCE
from .model import Absorbing, Bonded, Fixed, Free, System, Wall
from .rigid import RigidCollision, collide

ROUND_OFF = 2.0**-40
"""Parting velocity, over closing velocity, up to which bodies count as staying together: 256 times
the `TOLERANCE` of a front, and a fifth of the least ratio of two transit times that a clock holds,
so of the least e of a pair."""


class UndefinedRestitution(ValueError):
    """The collision has no coefficient of restitution; the message says why."""


@dataclass(frozen=True)
class Outcome:
    """Result of a collision; one entry a body or a contact, walls counted.

    Attributes
    ----------
    bodies : tuple of str
        What each body is.
    masses : tuple of float
        kg, with the transit times in use; infinite for a wall.
    velocities_before, velocities_after : tuple of float
        Of the centres of mass, m/s; rods bonded to a wall have the wall's, about which they swing,
        those between two walls of different velocity their own.
    kinetic_before, kinetic_after : float
        Energy of the motion of the centres of mass, J.
    vibration_before, vibration_after : tuple of float
        Energy of the motion relative to the centre of mass, and of strain, J.
    contacts : tuple of ContactTally
        Impulse, peak force, time under force and episodes of each contact.
    unilateral : tuple of int
        Indices of the contacts that can open.
    wall_work : float
        Work done by moving walls, J.
    momentum_residual, energy_residual : float
        What is missing in the balance of the waves left at the end, relative to the total absolute
        momentum and to the energy that took part.
    final : bool
        Whether it is proved that no contact can happen again.
    status : str
        Why the run ended, and what to do if that is not enough.
    contact_energy : float
        Stored in compliant contacts at the end, J.
    dissipated, numerical, radiated : float
        Lost in contacts, to the time step (see `EnergyLedger`), and through absorbing ends,
        J.
    damped : float
        Lost in damped material, J.
    drive_work, gravity_work : float
        Work of driven ends and of gravity, J.
    driven : bool
        Whether gravity or driven ends change the velocities besides the contacts.
    """

    bodies: tuple[str, ...]
    masses: tuple[float, ...]
    velocities_before: tuple[float, ...]
    velocities_after: tuple[float, ...]
    kinetic_before: float
    kinetic_after: float
    vibration_before: tuple[float, ...]
    vibration_after: tuple[float, ...]
    contacts: tuple[ContactTally, ...]
    unilateral: tuple[int, ...]
    wall_work: float
    momentum_residual: float
    energy_residual: float
    final: bool
    status: str
    contact_energy: float = 0.0
    dissipated: float = 0.0
    numerical: float = 0.0
    radiated: float = 0.0
    damped: float = 0.0
    drive_work: float = 0.0
    gravity_work: float = 0.0
    driven: bool = False

    @property
    def restitution(self) -> float:
        """Effective coefficient of restitution e of a collision at a single contact.

        e = (V2+ - V1+)/(V1- - V2-), V the velocities of the centres of mass; 0 where the bodies
        part with no more than round-off.

        Raises
        ------
        UndefinedRestitution
            If the run is not final, nothing met, the bodies did not approach each other, or there
            is more than one contact.
        """
        reason = self.why_no_restitution()
        if reason:
            raise UndefinedRestitution(reason)
        k = self.unilateral[0]
        before, after = self.velocities_before[k : k + 2], self.velocities_after[k : k + 2]
        return float(effective_restitution(True, 1, before, after))

    def why_no_restitution(self) -> str:
        """Return the sentence that says why `restitution` is undefined, empty if it is defined."""
        if not self.unilateral:
            return "restitution is undefined: no contact of this row can open"
        if len(self.unilateral) != 1:
            return (
                f"restitution is defined for one contact, this row has {len(self.unilateral)}; "
                "read velocities_after instead"
            )
        if self.driven:
            return (
                "restitution is undefined: gravity, or what drives an end, changes the velocities "
                "too; read impulse and velocities instead"
            )
        k = self.unilateral[0]
        if self.contacts[k].episodes == 0:
            closing = self.velocities_before[k] - self.velocities_before[k + 1]
            how = "move apart" if closing < 0 else "do not approach each other"
            return "restitution is undefined: nothing collided" + (
                f"; the bodies {how}" if closing <= 0 else f"; {self.status}"
            )
        if not self.final:
            return f"restitution is undefined: the collision is not over. {self.status}"
        if self.velocities_before[k] <= self.velocities_before[k + 1]:
            return (
                "restitution is undefined: the centres of mass did not approach each other; only "
                "vibration brought the bodies together"
            )
        return ""

    def _only(self) -> ContactTally:
        if len(self.unilateral) != 1:
            message = f"this row has {len(self.unilateral)} contacts that can open, not 1"
            raise ValueError(f"{message}; use outcome.contacts")
        return self.contacts[self.unilateral[0]]

    @property
    def impulse(self) -> float:
        """Impulse of the only contact, N s; ValueError where there are several."""
        return self._only().impulse

    @property
    def duration(self) -> float:
        """Time under force of the only contact, s; ValueError where there are several."""
        return self._only().duration

    @property
    def peak_force(self) -> float:
        """Largest force of the only contact, N; ValueError where there are several."""
        return self._only().peak_force

    def as_rigid(self) -> RigidCollision:
        """Return the collision as rigid-body mechanics sees it.

        The two sides of the only contact collide with the effective `restitution`; the velocities
        and the impulse are those of the rods, and the energy that looks lost is what vibration
        gained. (Where a side is bonded to a wall, its swing has gained some of it.)

        Returns
        -------
        rigid.RigidCollision

        Raises
        ------
        UndefinedRestitution
            As `restitution`.

        Examples
        --------
        >>> import rodimpact as ri
        >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
        >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
        >>> outcome = ri.collide(left, right)
        >>> round(outcome.as_rigid().energy_lost / sum(outcome.vibration_after), 12)
        1.0
        """
        e = self.restitution
        k = self.unilateral[0] + 1
        return collide(
            sum(self.masses[:k]), self.velocities_before[0],
            sum(self.masses[k:]), self.velocities_before[-1],
            e, allow_energy_release=e > 1,
        )

    def __str__(self) -> str:
        from .report import outcome_table

        return outcome_table(self)

    def _repr_html_(self) -> str:
        from .report import as_html

        return as_html(str(self))


def effective_restitution(
    final: Any, episodes: Any, before: Sequence[Any], after: Sequence[Any]
) -> Any:
    """e = (V2+ - V1+)/(V1- - V2-) of one contact, nan where there is none; arrays broadcast.

    After their last contact bodies do not approach each other: where they seem to, or part by no
    more than round-off, as when a bar without end is pushed for ever, they stay together: e is 0.

    Parameters
    ----------
    final, episodes
        Whether the collision is over, and how often the contact pressed.
    before, after : pair
        Velocities of the left and of the right centre of mass, m/s.
    """
    closing = np.asarray(before[0] - before[1])
    defined = np.asarray(final) & (np.asarray(episodes) > 0) & (closing > 0)
    parting = np.asarray(after[1] - after[0])
    largest = np.maximum(np.abs(after[0]), np.abs(after[1]))
    e = np.full(np.broadcast_shapes(parting.shape, defined.shape), math.nan)
    np.divide(parting, closing, out=e, where=defined)
    stays = (e <= ROUND_OFF) | (parting <= 2 * np.spacing(largest))
    return np.where(defined & stays, 0.0, e)


def body_velocities(
    system: System, first: Sequence[int], velocity: Sequence[Any], frame: Any
) -> list[Any]:
    """Velocities of the bodies, m/s: of their group, or of the wall that it is bonded to.

    Parameters
    ----------
    system : System
    first : sequence of int
        First segment of each body.
    velocity : sequence of float or array
        By segment, in the frame; for a family, one array of its shape a segment.
    frame : float or array
    """
    found: list[Any] = []
    for group in groups(system):
        inside = [i for i in group if not isinstance(system.bodies[i], Wall)]
        own = velocity[first[(inside or group)[0]]] + frame
        found += velocities_in_group(system, group, inside, own)
    return found


def read_outcome(run: FrontRun, status: str) -> Outcome:
    """Read the outcome off a finished run."""
    a = run.assembly
    system, count, first = a.system, len(a.spans), [span[0] for span in a.spans]
    masses = [a.mass(i) for i in range(count)]
    before, after = (
        [float(v) for v in body_velocities(system, first, stock.velocity, a.frame)]
        for stock in (run.opening, run.closing)
    )
    vibration_before, vibration_after = (
        [math.fsum(stock.vibration[s : e + 1]) * a.tick for s, e in a.spans]
        for stock in (run.opening, run.closing)
    )
    kinetic_before, kinetic_after = (
        sum(m * (stock.velocity[s] + a.frame) ** 2 / 2
            for m, (s, e) in zip(masses, a.spans, strict=True) if e)
        for stock in (run.opening, run.closing)
    )
    tallies = read_tallies(run)
    absolute = _absolute_momentum(a)
    outside_impulse = wall_work = lent = 0.0
    for i, k, sign in ((0, 0, 1), (count - 1, count - 2, -1)):
        if masses[i] == math.inf:
            impulse = sign * tallies[k].impulse
            outside_impulse += impulse
            wall_work += impulse * after[i]
            absolute += abs(impulse)
            if isinstance(system.contacts[k], Bonded):  # the wall lends energy and takes it back
                group = next(g for g in groups(system) if i in g)
                swinging = sum(masses[j] for j in group if masses[j] < math.inf)
                lent += swinging * abs(after[i]) * a.tolerance / TOLERANCE
    drive_work = radiated = 0.0
    for end, node, sign in zip(system.ends, (0, -1), (1, -1), strict=True):
        if isinstance(end, Free):
            continue
        impulse = run.tally.impulse[node] * a.tick
        work = sign * (run.tally.work[node] * a.tick + a.frame * impulse)
        outside_impulse += sign * impulse
        absolute += abs(impulse)
        if isinstance(end, Absorbing):
            radiated -= work
        elif not isinstance(end, Fixed):
            drive_work += work
        if not isinstance(end, Fixed):  # what goes in and out again is no more exact than this
            scale = a.tolerance / TOLERANCE
            mass = sum(m for m in masses if m < math.inf)
            absolute += mass * scale
            lent += mass * scale**2 / 2
    gained = math.fsum(run.closing.momentum) - math.fsum(run.opening.momentum)
    missing = gained * a.tick - outside_impulse
    energy_before = kinetic_before + sum(vibration_before)
    energy_gained = kinetic_after + sum(vibration_after) - energy_before
    turnover = energy_before + abs(wall_work) + lent + abs(drive_work) + abs(radiated)
    return Outcome(
        bodies=tuple("wall" if isinstance(b, Wall) else "rod" for b in system.bodies),
        masses=tuple(masses),
        velocities_before=tuple(before),
        velocities_after=tuple(after),
        kinetic_before=kinetic_before,
        kinetic_after=kinetic_after,
        vibration_before=tuple(vibration_before),
        vibration_after=tuple(vibration_after),
        contacts=tallies,
        unilateral=tuple(
            i for i, law in enumerate(system.contacts) if not isinstance(law, Bonded)
        ),
        wall_work=wall_work,
        momentum_residual=missing / absolute if absolute > 0 else 0.0,
        energy_residual=(energy_gained - wall_work - drive_work + radiated) / turnover
        if turnover > 0 else 0.0,
        final=run.settled >= 0,
        status=status,
        radiated=radiated,
        drive_work=drive_work,
        driven=driven(system),
    )


def read_tallies(run: FrontRun) -> tuple[ContactTally, ...]:
    """Totals of every contact in SI units."""
    t, tick = run.tally, run.assembly.tick
    return tuple(
        ContactTally(
            impulse=t.impulse[k] * tick,
            peak_force=t.peak[k],
            duration=t.pressed[k] * tick,
            first=t.first[k] * tick if t.first[k] >= 0 else math.nan,
            last=t.last[k] * tick if t.last[k] >= 0 else math.nan,
            episodes=t.episodes[k],
        )
        for k in run.assembly.nodes
    )


def _absolute_momentum(a: Assembly) -> float:
    """Total of the absolute momenta of all waves at t = 0, kg m/s."""
    total = 0.0
    for line, fronts in enumerate(a.waves[2:-2], 2):
        ends = [tick for tick, _ in fronts[1:]] + [0]
        for (tick, wave), end in zip(fronts, ends, strict=True):
            total += a.impedance[line // 2] / 2 * (end - tick) * a.tick * abs(wave + a.frame)
    return total
