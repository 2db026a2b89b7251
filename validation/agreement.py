"""The methods on the same collisions: wave fronts, characteristics as pieces, and a grid.

Where waves are constant between jumps, fronts and characteristics are both exact but for round-off:
pairs, cradles, relays, and random rows of 2 to 4 rods with gaps between them, walls at some ends,
and re-contact, for 4 transits of the longest rod, with lengths in whole numbers or any.

Where waves are smooth, the grid and characteristics can both do it: rods with Hertz contacts and
springs, and a mass. The impulses of the grid approach those of characteristics with the square of
its cells.

Source: `fronts`, itself proved on rationals (`rational_proof`), and characteristics at a tolerance
of 1e-10.
"""

import numpy as np

import rodimpact as ri

from .table import Case, Row, Rows
from .unit import rod

ROWS = 100
METHOD = "characteristics"
CELLS = (100, 200, 400)


def run() -> Rows:
    """Commensurate rows, random ones, and the grid."""
    return commensurate(), any_rows(), grid()


def impulses(solution: ri.Solution) -> np.ndarray:
    """Of all contacts."""
    return np.array([tally.impulse for tally in solution.outcome.contacts])


def commensurate() -> Rows:
    """Pairs, cradles and relays."""
    rng = np.random.default_rng(5)
    apart, force = [], []
    for _ in range(20):
        (T1, T2), (Z1, Z2) = (
            rng.integers(1, 12, 2).tolist(),
            rng.uniform(0.2, 5.0, 2).tolist(),
        )
        row = ri.System([rod(T1, Z1, 1.0), rod(T2, Z2)])
        exact, got = (ri.solve(row, method=m).outcome for m in ("fronts", METHOD))
        apart.append(abs(got.restitution - exact.restitution))
        force.append(abs(got.impulse / exact.impulse - 1))
    case = Case("20 random pairs, transits 1 to 11", "fronts")
    yield case.row("e, largest difference", 0.0, max(apart), 1e-13)
    yield case.row("impulse, largest relative difference", 0.0, max(force), 1e-13)
    for name, lengths in (
        ("cradle of five", (1, 1, 1, 1, 1)),
        ("cradle, the first twice as long", (2, 1, 1, 1, 1)),
        ("rods 1 : 2 : 3 : 1 : 2", (1, 2, 3, 1, 2)),
        ("rods 2 : 2 : 1 : 1 : 1", (2, 2, 1, 1, 1)),
    ):
        row = ri.System(
            [rod(x, velocity=0.0 if i else 1.0) for i, x in enumerate(lengths)]
        )
        exact_run, got_run = (ri.solve(row, method=m) for m in ("fronts", METHOD))
        v = np.subtract(
            exact_run.outcome.velocities_after, got_run.outcome.velocities_after
        )
        case = Case(name, "fronts")
        yield case.zero("velocities after, largest difference", v, 1e-13)
        yield case.zero(
            "impulses, largest difference",
            impulses(exact_run) - impulses(got_run),
            1e-13,
        )


def random_row(rng: np.random.Generator, whole: bool) -> ri.System:
    """Two to four rods with gaps, walls at some ends; lengths are whole numbers or any."""
    bodies: list[ri.Rod | ri.Wall] = [
        rod(
            float(rng.integers(1, 7)) if whole else rng.uniform(1.0, 6.0),
            rng.uniform(0.3, 3.0),
            rng.uniform(-1.0, 1.0),
        )
        for _ in range(rng.integers(2, 5))
    ]
    if rng.random() < 0.5:
        bodies.insert(0, ri.Wall())
    if rng.random() < 0.5:
        bodies.append(ri.Wall())
    return ri.System(bodies, rng.uniform(0.0, 2.0, len(bodies) - 1).tolist())


def error(row: ri.System) -> float:
    """Of the worst impulse of a row, relative to the largest; nan where nothing meets."""
    until = 4 * max(body.length for body in row.bodies if isinstance(body, ri.Rod))
    exact, got = (impulses(ri.solve(row, until, m)) for m in ("fronts", METHOD))
    return (
        float(np.abs(got - exact).max() / exact.max()) if exact.any() else float("nan")
    )


def any_rows() -> Rows:
    """Contacts that close at any time."""
    for whole, lengths in ((True, "whole numbers"), (False, "without common measure")):
        rng = np.random.default_rng(2)
        worst = float(np.nanmax([error(random_row(rng, whole)) for _ in range(ROWS)]))
        yield Row(
            f"{ROWS} random rows with gaps, walls and re-contact, lengths {lengths}",
            "worst impulse, largest relative difference",
            "fronts",
            0.0,
            worst,
            1e-10 if whole else 1e-12,
        )


def grid() -> Rows:
    """Impulses of a grid against those of characteristics."""
    rods, mass = [rod(0.4, 1.0, 1.0), rod(1.0, 2.0)], ri.RigidMass(0.7, velocity=1.0)
    systems = {
        "two rods, Hertz contact": ri.System(rods, contacts=[ri.Hertz(10.0)]),
        "two rods, spring": ri.System(rods, contacts=[ri.Spring(10.0)]),
        "a mass and two rods, Hertz contact and joint": ri.System(
            [mass, rod(0.4), rod(1.0, 2.0)], contacts=[ri.Hertz(10.0), ri.Joint(3.0)]
        ),
    }
    for case, system in systems.items():
        exact = ri.solve(system, 4.0, METHOD, rtol=1e-10).outcome.contacts[0].impulse
        off = [
            abs(
                ri.solve(system, 4.0, "finite-difference", cells=N)
                .outcome.contacts[0]
                .impulse
                - exact
            )
            for N in CELLS
        ]
        yield Row(
            case,
            f"order of the grid's impulse, {CELLS[0]} to {CELLS[-1]} cells",
            f"{METHOD}: 2",
            2.0,
            float(np.log(off[0] / off[-1]) / np.log(CELLS[-1] / CELLS[0])),
            0.02,
        )
