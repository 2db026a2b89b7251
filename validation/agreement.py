"""The methods on the same collisions: wave fronts, characteristics as pieces, a grid.

If waves are constant between jumps, fronts and characteristics are both exact except
for round-off. The systems are pairs, cradles, relays, and random rows of 2 to 4 rods.
The random rows have gaps, walls at some ends, and repeated contact, and are solved for
4 transit times of the longest rod. Their lengths are whole numbers or any numbers.

If waves are smooth, the grid is compared with characteristics. The systems are rods
with Hertz contacts and springs, and a mass. The difference of the impulses falls with
the square of the cell length.

Source: `fronts`, which is proved on fractions (`rational_proof`), and characteristics
at a tolerance of 1e-10.
"""

import math

import numpy as np
from numpy.random import Generator, default_rng

import rodimpact as ri

from .table import Case, Rows
from .unit import rod

PAIRS = 20
RANDOM_ROWS = 100
CELLS = (100, 200, 400)
RTOL = 1e-10  # relative accuracy of characteristics
END = 4.0  # end of the runs on a grid
ROWS_OF_RODS = {  # transit times
    "cradle of five": (1, 1, 1, 1, 1),
    "cradle, the first twice as long": (2, 1, 1, 1, 1),
    "rods 1 : 2 : 3 : 1 : 2": (1, 2, 3, 1, 2),
    "rods 2 : 2 : 1 : 1 : 1": (2, 2, 1, 1, 1),
}


def run() -> Rows:
    """Compare pairs, rows that touch, random rows, and the grid.

    The first three compare characteristics with fronts, the last one a grid with
    characteristics.
    """
    yield from pairs()
    yield from touching_rows()
    yield from random_rows(whole_numbers=True)
    yield from random_rows(whole_numbers=False)
    yield from on_grid()


def impulses(solution: ri.Solution) -> np.ndarray:
    """Impulse of each contact, [contact]."""
    values = [tally.impulse for tally in solution.outcome.contacts]
    return np.array(values)


def pairs() -> Rows:
    """Largest differences of e and impulse between fronts and characteristics.

    The pairs are random, with transit times that are whole numbers.
    """
    rng = default_rng(5)
    restitution_errors = []
    impulse_errors = []
    for _ in range(PAIRS):
        T1, T2 = rng.integers(1, 12, 2).tolist()
        Z1, Z2 = rng.uniform(0.2, 5.0, 2).tolist()
        first = rod(T1, Z1, velocity=1.0)
        second = rod(T2, Z2)
        system = ri.System([first, second])
        exact = ri.solve(system, method="fronts").outcome
        outcome = ri.solve(system, method="characteristics").outcome
        restitution_errors.append(outcome.restitution - exact.restitution)
        impulse_errors.append(outcome.impulse / exact.impulse - 1)
    case = Case(f"{PAIRS} random pairs, transits 1 to 11", "fronts")
    yield case.zero("e, largest difference", restitution_errors, 1e-13)
    yield case.zero("impulse, largest relative difference", impulse_errors, 1e-13)


def touching_rows() -> Rows:
    """Velocities and impulses of rows of five rods, by fronts and characteristics.

    The rods touch, and the first has the velocity 1.
    """
    for name, transit_times in ROWS_OF_RODS.items():
        first, *others = transit_times
        rods = [rod(first, velocity=1.0)]
        for transit_time in others:
            rods.append(rod(transit_time))
        system = ri.System(rods)
        exact = ri.solve(system, method="fronts")
        solution = ri.solve(system, method="characteristics")
        velocities = solution.outcome.velocities_after
        exact_velocities = exact.outcome.velocities_after
        velocity_errors = np.subtract(exact_velocities, velocities)
        impulse_errors = impulses(exact) - impulses(solution)
        case = Case(name, "fronts")
        yield case.zero("velocities after, largest difference", velocity_errors, 1e-13)
        yield case.zero("impulses, largest difference", impulse_errors, 1e-13)


def random_transit_time(rng: Generator, whole_number: bool) -> float:
    """A transit time from 1 to 6, a whole number or any."""
    if whole_number:
        return float(rng.integers(1, 7))
    return rng.uniform(1.0, 6.0)


def random_row(rng: Generator, whole_numbers: bool) -> ri.System:
    """Random row of two to four moving rods with gaps; each end may have a wall.

    The transit times are whole numbers if `whole_numbers`.
    """
    bodies: list[ri.Rod | ri.Wall] = []
    for _ in range(rng.integers(2, 5)):
        transit_time = random_transit_time(rng, whole_numbers)
        impedance = rng.uniform(0.3, 3.0)
        velocity = rng.uniform(-1.0, 1.0)
        bodies.append(rod(transit_time, impedance, velocity))
    if rng.random() < 0.5:
        bodies.insert(0, ri.Wall())
    if rng.random() < 0.5:
        bodies.append(ri.Wall())
    gaps = rng.uniform(0.0, 2.0, len(bodies) - 1)
    return ri.System(bodies, gaps.tolist())


def impulse_error(system: ri.System) -> float:
    """Largest error of an impulse over the largest impulse; nan if nothing collides.

    Characteristics are compared with fronts, up to four transits of the longest rod.
    """
    transit_times = []
    for body in system.bodies:
        if isinstance(body, ri.Rod):
            transit_times.append(body.length)  # the wave speed is 1
    until = 4 * max(transit_times)
    exact = impulses(ri.solve(system, until, "fronts"))
    computed = impulses(ri.solve(system, until, "characteristics"))
    if not exact.any():
        return math.nan
    largest_error = np.abs(computed - exact).max()
    return float(largest_error / exact.max())


def random_rows(whole_numbers: bool) -> Rows:
    """Largest relative error of an impulse in random rows with gaps and walls.

    Rows in which nothing collides are left out. `whole_numbers` says whether all
    transit times are whole numbers.
    """
    lengths = "without common measure"
    bound = 1e-12
    if whole_numbers:
        lengths = "whole numbers"
        bound = 1e-10
    rng = default_rng(2)
    errors = []
    for _ in range(RANDOM_ROWS):
        system = random_row(rng, whole_numbers)
        errors.append(impulse_error(system))
    worst = np.nanmax(errors)  # nan stands for a row without a collision
    case = Case(
        f"{RANDOM_ROWS} random rows with gaps, walls and re-contact, lengths {lengths}",
        "fronts",
    )
    yield case.row("worst impulse, largest relative difference", 0.0, worst, bound)


def compliant_systems() -> dict[str, ri.System]:
    """Three systems with springs, Hertz contacts and a joint, by name.

    All their waves are smooth. Wave speeds are 1.
    """
    first = rod(0.4, impedance=1.0, velocity=1.0)
    second = rod(1.0, impedance=2.0)
    mass = ri.RigidMass(0.7, velocity=1.0)
    hertz = ri.Hertz(10.0)
    middle = rod(0.4)
    contacts = [hertz, ri.Joint(3.0)]
    joined = ri.System([mass, middle, second], contacts=contacts)
    pair = [first, second]
    spring = ri.Spring(10.0)
    return {
        "two rods, Hertz contact": ri.System(pair, contacts=[hertz]),
        "two rods, spring": ri.System(pair, contacts=[spring]),
        "a mass and two rods, Hertz contact and joint": joined,
    }


def on_grid() -> Rows:
    """Order of the error of the grid in the impulse of the first contact.

    The error falls as cells^-order, from the smallest to the largest number of cells.
    The reference is the method of characteristics.
    """
    first = CELLS[0]
    last = CELLS[-1]
    for name, system in compliant_systems().items():
        reference = ri.solve(system, END, "characteristics", rtol=RTOL)
        exact = impulses(reference)[0]  # of the first contact
        errors = []
        for cells in CELLS:
            solution = ri.solve(system, END, "finite-difference", cells=cells)
            errors.append(abs(impulses(solution)[0] - exact))
        error_ratio = errors[0] / errors[-1]
        cell_ratio = last / first
        order = np.log(error_ratio) / np.log(cell_ratio)
        case = Case(name, "characteristics: 2")
        quantity = f"order of the grid's impulse, {first} to {last} cells"
        yield case.row(quantity, 2.0, order, 0.02)
