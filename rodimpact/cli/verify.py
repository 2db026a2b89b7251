"""Check the solver against closed forms. Exit status 4 if any number is off."""

import argparse
import math
from collections.abc import Iterator
from fractions import Fraction
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .. import (
    Bonded,
    Material,
    Rigid,
    RigidMass,
    Rod,
    Segment,
    System,
    Wall,
    exact,
    solve,
)
from ..explorer.presets import steel_rod
from ..materials import steel
from ..results.pair_theory import pair_theory
from ..storage.tables import align, as_json
from ..theory import mass_on_rod
from . import DONE, UNVERIFIED

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


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Only the form of the answer."""
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(given: argparse.Namespace) -> tuple[str, int]:
    """Table or JSON of the residuals."""
    found = checks()
    failed = sum(not check.passed for check in found)
    status = UNVERIFIED if failed else DONE
    if given.json:
        rows = [
            {**c._asdict(), "residual": c.residual, "passed": c.passed} for c in found
        ]
        return as_json(passed=not failed, checks=rows), status
    table = [
        ["check", "expected", "found", "residual", "bound", ""],
        *(
            [
                c.name,
                f"{c.expected:.9g}",
                f"{c.got:.9g}",
                f"{c.residual:.1e}",
                f"{c.bound:.0e}",
                "ok" if c.passed else "FAILED",
            ]
            for c in found
        ),
    ]
    verdict = f"{failed} checks FAILED" if failed else f"All {len(found)} checks passed"
    text = f"{verdict}; a check of several cases shows the worst."
    return f"{align(table, left=(0, 5))}\n\n{text}", status


def checks() -> list[Check]:
    """Run all checks: known numbers beside those of the solver.

    A family of cases is one check and shows its worst member.

    Returns
    -------
    list of Check

    Examples
    --------
    >>> all(check.passed for check in checks())
    True
    """
    groups = (pairs, equal_rods, moving_wall, steps, chain, fractions, masses)
    return [worst(*row) for group in groups for row in group()]


def worst(
    name: str, expected: ArrayLike, got: ArrayLike, bound: float = BOUND
) -> Check:
    """Check of the member of a family that is farthest off."""
    members = [
        Check(name, float(e), float(g), bound) for e, g in np.broadcast(expected, got)
    ]
    return max(members, key=lambda check: (not check.passed, check.residual))


def pairs() -> Iterator[Any]:
    """Two free rods (Saint-Venant), and a rod on a wall: every number that theory has."""
    numbers = list(product(IMPEDANCES, TRANSIT_TIMES))
    rows: dict[str, list[Any]] = {
        "identical rods": [(steel_rod(1.0, 1.0), steel_rod(1.0))],
        "lengths l1 < l2": [
            (steel_rod(k / 20, 1.0), steel_rod(1.0)) for k in range(1, 20)
        ],
        f"{len(numbers)} pairs of rods": [
            (_rod(Z, T, 1.0), _rod(1.0, 1.0)) for Z, T in numbers
        ],
        "rod on a wall": [(_rod(3.0, 0.7, 1.0), Wall())],
    }
    for name, family in rows.items():
        runs = [solve(System(row)) for row in family]
        forms = [
            form.collision()
            for form in (pair_theory(run.system) for run in runs)
            if form
        ]
        for quantity in ("restitution", "impulse", "duration", "peak_force"):
            yield (
                f"{name}: {quantity.replace('_', ' ')}",
                [getattr(form, quantity) for form in forms],
                [getattr(run.outcome, quantity) for run in runs],
            )
        openings = [run.contacts[0].episodes[-1].opening for run in runs]
        yield f"{name}: opening", [form.opening for form in forms], openings
        yield (
            f"{name}: energy balance",
            0.0,
            [run.outcome.energy_residual for run in runs],
        )


def equal_rods() -> Iterator[Any]:
    """Identical rods exchange their motion; in between, half the speed and compression."""
    rod = steel_rod(1.0, 1.0)
    solution = solve(System([rod, steel_rod(1.0)]))
    middle = float(rod.transit_time) / 2
    speeds = solution.velocity(0, [0.1, 0.9], middle)
    yield "identical rods: v ahead of the wave, v/2 behind it", [1.0, 0.5], speeds
    stress = -float(steel.density) * float(steel.wave_speed) / 2
    behind = solution.stress(0, 0.9, middle)
    yield "identical rods: stress -rho c v/2 behind the wave", stress, behind
    after = [solution.velocity(i, 0.5, solution.t_end) for i in (0, 1)]
    yield "identical rods: afterwards at rest and at v", [0.0, 1.0], after


def moving_wall() -> Iterator[Any]:
    """A wall against a rod at rest."""
    outcome = solve(System([Wall(velocity=1.0), _rod(3.0, 0.7)])).outcome
    yield "moving wall: the rod leaves at 2 v", 2.0, outcome.velocities_after[1]
    yield "moving wall: its work is 2 m v^2", 2 * 3.0 * 0.7, outcome.wall_work


def steps() -> Iterator[Any]:
    """Cutting a rod in pieces changes nothing; a true step splits a wave as impedances say."""
    striker = steel_rod(0.4, 1.0)
    pieces = [Segment(length, 1e-4, steel) for length in (0.2, 0.5, 0.3)]
    segmented = solve(System([striker, Rod(segments=pieces)])).outcome
    yield "a rod in three segments: e", 0.4, segmented.restitution
    row = [striker, *(Rod(segments=[piece]) for piece in pieces)]
    bonded = solve(System(row, contacts=[Rigid(), Bonded(), Bonded()]))
    plain = solve(System([striker, steel_rod(1.0)])).outcome
    yield "a rod of three bonded bodies: e", 0.4, bonded.outcome.restitution
    yield (
        "a rod of three bonded bodies: impulse",
        plain.impulse,
        bonded.contacts[0].impulse,
    )
    step = [Segment(1.0, area, _unit(1.0)) for area in (1.0, 3.0)]
    speed = solve(System([_rod(1.0, 2.0, 1.0), Rod(segments=step)])).velocity(
        1, 1.5, 1.75
    )
    yield "a step in impedance, 1 to 3: v Z1/(Z1 + Z2) behind it", 0.25, speed


def chain() -> Iterator[Any]:
    """A row of rods with gaps, without and with a wall that sends them back."""
    gap, first = 1e-4, steel_rod(0.5, 1.0)
    run = solve(System([first, steel_rod(0.5), steel_rod(0.5)], gaps=[0.0, gap]))
    after = run.outcome.velocities_after
    yield "three equal rods: only the last one moves", [0.0, 0.0, 1.0], after
    start = run.contacts[1].episodes[0].start
    yield (
        "three equal rods: second contact at L/c + gap/v",
        first.transit_time + gap,
        start,
    )
    row = [
        steel_rod(length, 1 - i / 4)
        for i, length in enumerate((0.3, 0.5, 0.2, 0.7, 0.4))
    ]
    run = solve(System([*row, Wall()], gaps=[0.0, 1e-5, 2e-5, 1e-5, 3e-5]))
    yield (
        "five rods, gaps and a wall: momentum balance",
        0.0,
        run.outcome.momentum_residual,
    )
    yield "five rods, gaps and a wall: energy balance", 0.0, run.outcome.energy_residual
    total = run.energy([run.t_end * k / 8 for k in range(9)]).total
    yield "five rods, gaps and a wall: energy at nine times", total[0], total


def fractions() -> Iterator[Any]:
    """The solver's kernel run on fractions gives e as a fraction, without any error."""
    pair = System([_rod(1.0, 1.0, 1.0), _rod(1.0, 1.0)])
    for Z1, Z2, T1, T2, known in (
        (1, 1, 2, 5, Fraction(2, 5)),
        (3, 1, 1, 3, Fraction(3, 4)),
        (5, 1, 3, 10, Fraction(409, 486)),
    ):
        e = exact(
            pair,
            {
                "bodies.0.impedance": Z1,
                "bodies.0.transit_time": T1,
                "bodies.1.impedance": Z2,
                "bodies.1.transit_time": T2,
            },
        ).restitution
        name = (
            f"on fractions, impedances {Z1}:{Z2}, transit times {T1}:{T2}: e - {known}"
        )
        yield name, 0.0, math.nan if e is None else float(e - known), 0.0


def masses() -> Iterator[Any]:
    """A rigid mass on a free rod, by characteristics."""
    some = (0.25, 1.0, 4.0)
    systems = [System([RigidMass(mass, velocity=1.0), _rod(1.0, 1.0)]) for mass in some]
    yield (
        "e of a mass on a rod, characteristics",
        [mass_on_rod(mass, 1.0, 1.0, 1.0).restitution for mass in some],
        [solve(system).outcome.restitution for system in systems],
        1e-9,
    )


def _unit(impedance: float) -> Material:
    """Material in which waves cover 1 m in 1 s; a rod of 1 m^2 has this impedance."""
    return Material("unit", youngs_modulus=impedance, density=impedance)


def _rod(impedance: float, transit_time: float, velocity: float = 0.0) -> Rod:
    return Rod(transit_time, area=1.0, material=_unit(impedance), velocity=velocity)
