"""The two methods on the same collisions: exact wave fronts, and characteristics on a time step.

Where transit times are whole numbers of steps and states are even, averages over steps are exact,
and so is the method: contacts that open and close on a step need nothing more, and where they close
inside of one, all steps are cut there. Pairs, cradles, relays, and random rows of 2 to 4 rods with
gaps between them, walls at some ends, and re-contact, for 4 transits of the longest rod, agree to
1e-9, and in fact to round-off.

Where transit times have no common measure, what arrives in a step is the mean of what left in two,
which smears jumps; contacts that open and close on smeared jumps leave an error of first order.

Source: `fronts`, itself proved on rationals (`rational_proof`).
"""

from __future__ import annotations

import numpy as np

import rodimpact as ri

from .table import Row

UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)  # impedance = area, transit = length
ROWS = 100
STEPS = (16, 256)  # in the unit of length


def rod(length: float, Z: float = 1.0, velocity: float = 0.0) -> ri.Rod:
    """A rod of wave speed 1."""
    return ri.Rod(length, area=Z, material=UNIT, velocity=velocity)


def run() -> list[Row]:
    """Commensurate rows, then random ones."""
    return commensurate() + inside_steps()


def impulses(solution: ri.Solution) -> np.ndarray:
    """Of all contacts."""
    return np.array([tally.impulse for tally in solution.outcome.contacts])


def commensurate() -> list[Row]:
    """Every contact opens and closes on a step."""
    rows = []
    rng = np.random.default_rng(5)
    apart, force = [], []
    for _ in range(20):
        (T1, T2), (Z1, Z2) = rng.integers(1, 12, 2).tolist(), rng.uniform(0.2, 5.0, 2).tolist()
        row = ri.System([rod(T1, Z1, 1.0), rod(T2, Z2)])
        exact, got = ri.solve(row).outcome, ri.solve(row, dt=0.25).outcome
        apart.append(abs(got.restitution - exact.restitution))
        force.append(abs(got.impulse / exact.impulse - 1))
    case, source = "20 random pairs, transits 1 to 11", "fronts"
    rows += [Row(case, "e, largest difference", source, 0.0, max(apart), 1e-9),
             Row(case, "impulse, largest relative difference", source, 0.0, max(force), 1e-9)]
    for name, lengths in (
        ("cradle of five", (1, 1, 1, 1, 1)), ("cradle, the first twice as long", (2, 1, 1, 1, 1)),
        ("rods 1 : 2 : 3 : 1 : 2", (1, 2, 3, 1, 2)), ("rods 2 : 2 : 1 : 1 : 1", (2, 2, 1, 1, 1)),
    ):
        row = ri.System([rod(x, velocity=0.0 if i else 1.0) for i, x in enumerate(lengths)])
        exact_run, got_run = ri.solve(row), ri.solve(row, dt=0.25)
        v = np.subtract(exact_run.outcome.velocities_after, got_run.outcome.velocities_after)
        rows += [
            Row(name, "velocities after, largest difference", source, 0.0,
                float(np.abs(v).max()), 1e-9),
            Row(name, "impulses, largest difference", source, 0.0,
                float(np.abs(impulses(exact_run) - impulses(got_run)).max()), 1e-9),
        ]
    return rows


def random_row(rng: np.random.Generator, whole: bool) -> ri.System:
    """Two to four rods with gaps, walls at some ends; lengths are whole numbers or any."""
    bodies: list[ri.Rod | ri.Wall] = [
        rod(float(rng.integers(1, 7)) if whole else rng.uniform(1.0, 6.0),
            rng.uniform(0.3, 3.0), rng.uniform(-1.0, 1.0))
        for _ in range(rng.integers(2, 5))
    ]
    if rng.random() < 0.5:
        bodies.insert(0, ri.Wall())
    if rng.random() < 0.5:
        bodies.append(ri.Wall())
    return ri.System(bodies, rng.uniform(0.0, 2.0, len(bodies) - 1).tolist())


def errors(rows: int, whole: bool, steps: tuple[int, ...]) -> np.ndarray:
    """[row, step] errors of the worst impulse of random rows, relative to the largest."""
    rng = np.random.default_rng(2)
    differences: list[list[float]] = []
    while len(differences) < rows:
        row = random_row(rng, whole)
        until = 4 * max(body.length for body in row.bodies if isinstance(body, ri.Rod))
        exact = impulses(ri.solve(row, until=until))
        if exact.any():
            runs = [ri.solve(row, until=until, dt=1 / N) for N in steps]
            off = [float(np.abs(impulses(run) - exact).max()) for run in runs]
            differences.append([x / float(exact.max()) for x in off])
    return np.array(differences)


def inside_steps() -> list[Row]:
    """Contacts that close inside steps."""
    source = "fronts"
    case = f"{ROWS} random rows with gaps, walls and re-contact"
    whole = errors(ROWS, whole=True, steps=(4, 16))
    any_length = errors(ROWS, whole=False, steps=STEPS)
    order = np.log(np.mean(any_length[:, 0]) / np.mean(any_length[:, -1])) / np.log(
        STEPS[-1] / STEPS[0])
    return [
        *(Row(case, f"worst impulse, largest relative difference, steps 1/{N}", source, 0.0,
              float(x), 1e-9) for N, x in zip((4, 16), whole.max(axis=0), strict=True)),
        Row(f"{case}, lengths without common measure",
            f"order of the mean error of the worst impulse, steps 1/{STEPS[0]} to 1/{STEPS[-1]}",
            "first order", 1.0, float(order), 0.2),
    ]
