"""Self-check: closed forms against the solver, in a fraction of a second.

Every check compares a number that is known beforehand with the one the solver finds. A family of
cases is one check and shows its worst member.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import product
from typing import NamedTuple, SupportsFloat

from .. import materials
from ..algebra.rational import exact
from ..explorer.presets import steel_rod
from ..model import Bonded, Material, Rigid, RigidMass, Rod, Segment, System, Wall
from ..results.pair_theory import pair_theory
from ..running.solving import solve
from ..theory import mass_on_rod

BOUND = 1e-12
"""Largest relative residual that passes; the solver's round-off stays below a hundredth of it."""

IMPEDANCES = (1e-6, 0.2, 0.5, 1.0, 3.0, 8.0, 1e6)
TRANSIT_TIMES = (0.1, 0.3, 0.5, 0.77, 1.0)


class Check(NamedTuple):
    """One comparison.

    Attributes
    ----------
    name : str
        What is compared.
    expected : float
        Known beforehand, SI units.
    got : float
        Found by the solver.
    bound : float
        Largest residual that passes.
    """

    name: str
    expected: float
    got: float
    bound: float = BOUND

    @property
    def residual(self) -> float:
        """|got - expected|, relative to `expected` unless that is 0."""
        return abs(self.got - self.expected) / (abs(self.expected) or 1.0)

    @property
    def passed(self) -> bool:
        """Whether the residual is within the bound; nan is not."""
        return self.residual <= self.bound


def checks() -> list[Check]:
    """Run all checks.

    Returns
    -------
    list of Check

    Examples
    --------
    >>> all(check.passed for check in checks())
    True
    """
    groups = (pairs, equal_rods, moving_wall, steps, chain, fractions, masses)
    return [check for group in groups for check in group()]


def pairs() -> Iterator[Check]:
    """Two free rods (Saint-Venant), and a rod on a wall: every number that theory has."""
    ratios = [k / 20 for k in range(1, 20)]
    products = list(product(IMPEDANCES, TRANSIT_TIMES))
    families = {
        "identical rods": [System([steel_rod(1.0, velocity=1.0), steel_rod(1.0)])],
        "lengths l1 < l2": [System([steel_rod(r, velocity=1.0), steel_rod(1.0)]) for r in ratios],
        f"{len(products)} pairs of rods": [
            System([_rod(Z, T, velocity=1.0), _rod(1.0, 1.0)]) for Z, T in products],
        "rod on a wall": [System([_rod(3.0, 0.7, velocity=1.0), Wall()])],
    }
    for name, family in families.items():
        forms = [form.collision() for form in map(pair_theory, family) if form]
        runs = [solve(system) for system in family]
        for quantity in ("restitution", "impulse", "duration", "peak_force", "opening"):
            expected = [getattr(form, quantity) for form in forms]
            got = [getattr(r.contacts[0].episodes[-1] if quantity == "opening" else r.outcome,
                           quantity) for r in runs]
            yield _worst(f"{name}: {quantity.replace('_', ' ')}", expected, got)
        lost = [run.outcome.energy_residual for run in runs]
        yield _worst(f"{name}: energy balance", [0.0] * len(runs), lost)


def equal_rods() -> Iterator[Check]:
    """Identical rods exchange their motion; in between, half the speed and compression."""
    rod, steel = steel_rod(1.0, velocity=1.0), materials.steel
    solution = solve(System([rod, steel_rod(1.0)]))
    transit = float(rod.transit_time)
    speeds = solution.velocity(0, [0.1, 0.9], transit / 2)
    yield _worst("identical rods: v ahead of the wave, v/2 behind it", [1.0, 0.5], speeds)
    stress = -float(steel.density) * float(steel.wave_speed) / 2
    behind = float(solution.stress(0, 0.9, transit / 2))
    yield Check("identical rods: stress -rho c v/2 behind the wave", stress, behind)
    after = [solution.velocity(i, 0.5, solution.t_end) for i in (0, 1)]
    yield _worst("identical rods: afterwards at rest and at v", [0.0, 1.0], after)


def moving_wall() -> Iterator[Check]:
    """A wall against a rod at rest."""
    outcome = solve(System([Wall(velocity=1.0), _rod(3.0, 0.7)])).outcome
    yield Check("moving wall: the rod leaves at 2 v", 2.0, outcome.velocities_after[1])
    yield Check("moving wall: its work is 2 m v^2", 2 * 3.0 * 0.7, outcome.wall_work)


def steps() -> Iterator[Check]:
    """Cutting a rod in pieces changes nothing; a true step splits a wave as impedances say."""
    striker, whole = steel_rod(0.4, velocity=1.0), steel_rod(1.0)
    pieces = [Segment(length, 1e-4, materials.steel) for length in (0.2, 0.5, 0.3)]
    segmented = solve(System([striker, Rod(segments=pieces)])).outcome
    yield Check("a rod in three segments: e", 0.4, segmented.restitution)
    row = [striker, *(Rod(segments=[piece]) for piece in pieces)]
    bonded = solve(System(row, contacts=[Rigid(), Bonded(), Bonded()])).outcome
    yield Check("a rod of three bonded bodies: e", 0.4, bonded.restitution)
    impulse = bonded.contacts[0].impulse
    plain = solve(System([striker, whole])).outcome.impulse
    yield Check("a rod of three bonded bodies: impulse", plain, impulse)
    step = [Segment(1.0, area, _unit(1.0)) for area in (1.0, 3.0)]
    run = solve(System([_rod(1.0, 2.0, velocity=1.0), Rod(segments=step)]))
    speed = float(run.velocity(1, 1.5, 1.75))
    yield Check("a step in impedance, 1 to 3: v Z1/(Z1 + Z2) behind it", 0.25, speed)


def chain() -> Iterator[Check]:
    """A row of rods with gaps, without and with a wall that sends them back."""
    gap, first = 1e-4, steel_rod(0.5, velocity=1.0)
    run = solve(System([first, steel_rod(0.5), steel_rod(0.5)], gaps=[0.0, gap]))
    after = run.outcome.velocities_after
    yield _worst("three equal rods: only the last one moves", [0.0, 0.0, 1.0], after)
    yield Check(
        "three equal rods: second contact at L/c + gap/v",
        float(first.transit_time) + gap, run.contacts[1].episodes[0].start,
    )
    lengths = (0.3, 0.5, 0.2, 0.7, 0.4)
    row = [steel_rod(length, velocity=1.0 - i / 4) for i, length in enumerate(lengths)]
    run = solve(System([*row, Wall()], gaps=[0.0, 1e-5, 2e-5, 1e-5, 3e-5]))
    yield Check("five rods, gaps and a wall: momentum balance", 0.0, run.outcome.momentum_residual)
    yield Check("five rods, gaps and a wall: energy balance", 0.0, run.outcome.energy_residual)
    total = run.energy([run.t_end * k / 8 for k in range(9)]).total
    yield _worst("five rods, gaps and a wall: energy at nine times", [total[0]] * 9, total)


def fractions() -> Iterator[Check]:
    """The solver's kernel run on fractions gives e as a fraction, without any error."""
    pair = System([_rod(1.0, 1.0, velocity=1.0), _rod(1.0, 1.0)])
    for (Z1, Z2), (T1, T2), known in (
        ((1, 1), (2, 5), Fraction(2, 5)),
        ((3, 1), (1, 3), Fraction(3, 4)),
        ((5, 1), (3, 10), Fraction(409, 486)),
    ):
        e = exact(pair, {
            "bodies.0.impedance": Z1, "bodies.0.transit_time": T1,
            "bodies.1.impedance": Z2, "bodies.1.transit_time": T2}).restitution
        name = f"on fractions, impedances {Z1}:{Z2}, transit times {T1}:{T2}: e - {known}"
        yield Check(name, 0.0, float(e - known) if e is not None else math.nan, 0.0)


def masses() -> Iterator[Check]:
    """A rigid mass on a free rod, by characteristics."""
    some = (0.25, 1.0, 4.0)
    expected = [mass_on_rod(mass, 1.0, 1.0, 1.0).restitution for mass in some]
    systems = [System([RigidMass(mass, velocity=1.0), _rod(1.0, 1.0)]) for mass in some]
    got = [solve(system).outcome.restitution for system in systems]
    yield _worst("e of a mass on a rod, characteristics", expected, got)._replace(bound=1e-9)


def _worst(name: str, expected: Iterable[SupportsFloat], got: Iterable[SupportsFloat]) -> Check:
    """Check of the member of a family that is farthest off."""
    members = [Check(name, float(e), float(g)) for e, g in zip(expected, got, strict=True)]
    return max(members, key=lambda check: (not check.passed, check.residual))


def _unit(impedance: float) -> Material:
    """Material in which waves cover 1 m in 1 s; a rod of 1 m^2 has this impedance."""
    return Material("unit", youngs_modulus=impedance, density=impedance)


def _rod(impedance: float, transit_time: float, velocity: float = 0.0) -> Rod:
    return Rod(transit_time, area=1.0, material=_unit(impedance), velocity=velocity)
