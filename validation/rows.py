"""Rows of more than two rods.

- Newton's cradle of five equal rods: one comes, one goes, as in textbooks about balls; two come,
  two go. Every other rod is at rest, inside as well.
- Three rods of one impedance, each longer than the one before: the pulse of the first passes
  through the second into the third, which takes all the momentum: its velocity is l1/l3 of the
  first one's.
- Eight rods of many lengths and areas: momentum and energy of the bodies balance, and at every
  contact what the left part of the row lost the right part gained.

Source: balances of momentum and energy; waves of equal impedance pass through a closed contact
unchanged.
"""

import numpy as np

import rodimpact as ri

from .table import Case, Rows

STEEL = ri.materials.steel


def run() -> Rows:
    """Cradles, a relay of three, a chain of eight."""
    return cradle(1), cradle(2), relay(), chain()


def cradle(moving: int) -> Rows:
    """Five equal rods, the first `moving` of them at 1 m/s."""
    rods = [
        ri.Rod(0.1, area=1e-4, material=STEEL, velocity=1.0 if i < moving else 0.0)
        for i in range(5)
    ]
    o = ri.solve(ri.System(rods)).outcome
    case = Case(f"Newton's cradle, {moving} of 5", "as many go as came")
    for i, v in enumerate(o.velocities_after):
        yield case.row(
            f"velocity of rod {i + 1} after, m/s",
            1.0 if i >= 5 - moving else 0.0,
            v,
            1e-13,
        )
    left = sum(o.vibration_after)
    yield case.row("vibration energy after, J", 0.0, left, 1e-14, "none")


def relay() -> Rows:
    """Rods of 0.2 m, 0.3 m and 1 m."""
    o = ri.solve(
        ri.System(
            [
                ri.Rod(length, area=1e-4, material=STEEL, velocity=v)
                for length, v in ((0.2, 1.0), (0.3, 0.0), (1.0, 0.0))
            ]
        )
    ).outcome
    case = Case("three rods 0.2 : 0.3 : 1", "the pulse passes through")
    for i, (expected, v) in enumerate(
        zip((0.0, 0.0, 0.2), o.velocities_after, strict=True)
    ):
        yield case.row(f"velocity of rod {i + 1} after, m/s", expected, v, 1e-13)


def chain() -> Rows:
    """Eight rods of many lengths and areas, closing in on each other."""
    rng = np.random.default_rng(1)
    rods = [
        ri.Rod(
            float(rng.integers(1, 10)) / 20,
            area=float(rng.uniform(0.2, 2.0)) * 1e-4,
            material=STEEL,
            velocity=0.1 * (8 - i),
        )
        for i in range(8)
    ]
    solution = ri.solve(ri.System(rods, gaps=(1e-4 * rng.integers(0, 4, 7)).tolist()))
    o = solution.outcome
    m, before, after = (
        np.array(x) for x in (o.masses, o.velocities_before, o.velocities_after)
    )
    momentum = float(np.abs(m * before).sum())
    energy = o.kinetic_before
    waves = solution.energy(solution.t_end)
    gained = np.cumsum((m * (after - before))[::-1])[::-1][1:]
    case = Case("eight different rods", "conserved")
    yield case.row(
        "proved final (1 is yes)", 1.0, o.final, 0.0, "a row without walls flies apart"
    )
    yield case.row(
        "momentum after - before, relative",
        0.0,
        float((m * (after - before)).sum()) / momentum,
        1e-13,
    )
    yield case.row(
        "motion and vibration after - before, relative",
        0.0,
        (o.kinetic_after + sum(o.vibration_after) - energy) / energy,
        1e-12,
    )
    yield case.row(
        "energy of the waves after - before, relative",
        0.0,
        float(waves.total) / energy - 1,
        1e-12,
    )
    yield case.row(
        "impulse - momentum gained to its right, largest, relative",
        0.0,
        float(np.abs([c.impulse for c in solution.contacts] - gained).max()) / momentum,
        1e-12,
    )
