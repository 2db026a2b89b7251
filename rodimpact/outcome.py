"""What a collision did: velocities of the bodies before and after, impulse, restitution, energy.

Read off the tallies that the kernel keeps while it runs and off the waves left at the end; the
signals are not needed. Bodies bonded together move, for an outcome, with their common velocity.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .contacts import ContactTally
from .methods.assembly import TOLERANCE, Assembly
from .methods.fronts import FrontRun
from .model import Bonded, Wall
from .rigid import RigidCollision, collide


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
        Of the centres of mass, m/s; rods bonded to a wall have the wall's, about which they swing.
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

    @property
    def restitution(self) -> float:
        """Effective coefficient of restitution e of a collision at a single contact.

        e = (V2+ - V1+)/(V1- - V2-), V the velocities of the centres of mass.

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
        before, after = self.velocities_before, self.velocities_after
        return (after[k + 1] - after[k]) / (before[k] - before[k + 1])

    def why_no_restitution(self) -> str:
        """Return the sentence that says why `restitution` is undefined, empty if it is defined."""
        if not self.unilateral:
            return "restitution is undefined: no contact of this row can open"
        if len(self.unilateral) != 1:
            return (
                f"restitution is defined for one contact, this row has {len(self.unilateral)}; "
                "read velocities_after instead"
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


def _kinetic(masses: list[float], velocities: list[float], frame: float) -> float:
    return sum(
        m * (v + frame) ** 2 / 2 for m, v in zip(masses, velocities, strict=True) if m < math.inf
    )


def _stock(run: FrontRun, velocities: list[float]) -> tuple[list[float], list[float]]:
    """Momentum of each body at the end, and its energy of vibration about these velocities."""
    spans = run.assembly.spans
    by_segment = [0.0] * len(run.assembly.ticks)
    for (first, last), v in zip(spans, velocities, strict=True):
        by_segment[first : last + 1] = [v] * max(0, last - first + 1)
    momentum, vibration = run.stock(by_segment)
    return (
        [math.fsum(momentum[first : last + 1]) for first, last in spans],
        [math.fsum(vibration[first : last + 1]) for first, last in spans],
    )


def groups(assembly: Assembly) -> list[list[int]]:
    """Bodies that are bonded together, from left to right."""
    found: list[list[int]] = [[0]]
    for i, law in enumerate(assembly.system.contacts):
        if isinstance(law, Bonded):
            found[-1].append(i + 1)
        else:
            found.append([i + 1])
    return found


def read_outcome(run: FrontRun, status: str) -> Outcome:
    """Read the outcome off a finished run."""
    a, tick, frame = run.assembly, run.assembly.tick, run.assembly.frame
    count = len(a.spans)
    masses = [a.mass(i) for i in range(count)]
    impulses = [run.tally.impulse[node] * tick for node in a.nodes]
    momenta, absolute = _initial_momenta(a)

    before, after = [0.0] * count, [0.0] * count  # of the group, or its wall
    motion_before, motion_after = [0.0] * count, [0.0] * count  # of the group's centre of mass
    lent = 0.0  # energy that moving walls lend to the rods bonded to them and take back
    for group in groups(a):
        walls = [v - frame for i in group if (v := _wall_velocity(a, i)) is not None]
        rods = [i for i in group if masses[i] < math.inf]
        mass = sum(masses[i] for i in rods)
        v0 = v1 = sum(momenta[i] for i in rods) / mass if rods else walls[0]
        if walls and rods:
            swinging, _ = _stock(run, [0.0] * count)
            v1 = sum(swinging[i] for i in rods) / mass
            lent += mass * max(abs(w + frame) for w in walls) * a.tolerance / TOLERANCE
        elif rods:
            pushed = impulses[group[0] - 1] if group[0] > 0 else 0.0
            pushed -= impulses[group[-1]] if group[-1] < count - 1 else 0.0
            v1 = v0 + pushed / mass
        for i in group:
            motion_before[i], motion_after[i] = v0, v1
            before[i], after[i] = (walls[0], walls[0]) if walls else (v0, v1)
        if len(walls) == 2:
            before[group[-1]] = after[group[-1]] = walls[1]

    vibration_before = _initial_vibration(a, motion_before)
    left_momenta, vibration_after = _stock(run, motion_after)
    kinetic_before = _kinetic(masses, motion_before, frame)
    kinetic_after = _kinetic(masses, motion_after, frame)
    wall_impulse = wall_work = 0.0
    for i, k, sign in ((0, 0, 1), (count - 1, count - 2, -1)):
        if masses[i] == math.inf:
            wall_impulse += sign * impulses[k]
            wall_work += sign * impulses[k] * (after[i] + frame)
            absolute += abs(impulses[k])
    missing = sum(left_momenta) - sum(momenta) - wall_impulse
    energy_before = kinetic_before + sum(vibration_before)
    gained = kinetic_after + sum(vibration_after) - energy_before
    turnover = energy_before + abs(wall_work) + lent
    return Outcome(
        bodies=tuple("wall" if isinstance(b, Wall) else "rod" for b in a.system.bodies),
        masses=tuple(masses),
        velocities_before=tuple(v + frame for v in before),
        velocities_after=tuple(v + frame for v in after),
        kinetic_before=kinetic_before,
        kinetic_after=kinetic_after,
        vibration_before=tuple(vibration_before),
        vibration_after=tuple(vibration_after),
        contacts=read_tallies(run),
        unilateral=tuple(
            i for i, law in enumerate(a.system.contacts) if not isinstance(law, Bonded)
        ),
        wall_work=wall_work,
        momentum_residual=missing / absolute if absolute > 0 else 0.0,
        energy_residual=(gained - wall_work) / turnover if turnover > 0 else 0.0,
        final=run.settled >= 0,
        status=status,
    )


def _wall_velocity(a: Assembly, body: int) -> float | None:
    wall = a.system.bodies[body]
    return float(wall.velocity) if isinstance(wall, Wall) else None


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


def _pieces(a: Assembly, line: int) -> list[tuple[float, float]]:
    """Waves of a line at t = 0 as (duration in s, value in the frame)."""
    fronts = a.waves[line]
    ends = [t for t, _ in fronts[1:]] + [0]
    return [((end - t) * a.tick, w) for (t, w), end in zip(fronts, ends, strict=True)]


def _initial_momenta(a: Assembly) -> tuple[list[float], float]:
    """Momentum of each body in the frame, and the total absolute momentum of all waves."""
    momenta, absolute = [], 0.0
    for first, last in a.spans:
        total = 0.0
        for s in range(first, last + 1):
            for line in (2 * s, 2 * s + 1):
                for time, wave in _pieces(a, line):
                    total += a.impedance[s] / 2 * time * wave
                    absolute += a.impedance[s] / 2 * time * abs(wave + a.frame)
        momenta.append(total)
    return momenta, absolute


def _initial_vibration(a: Assembly, velocities: list[float]) -> list[float]:
    found = []
    for (first, last), v in zip(a.spans, velocities, strict=True):
        total = 0.0
        for s in range(first, last + 1):
            for line in (2 * s, 2 * s + 1):
                for time, wave in _pieces(a, line):
                    total += a.impedance[s] / 4 * time * (wave - v) ** 2
        found.append(total)
    return found
