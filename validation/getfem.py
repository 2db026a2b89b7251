"""A compressed bar, clamped at one end, is released above a floor: exactly periodic.

L = c = 1 and E A = 1. The bar is clamped at x = 1, and a unilateral floor is at x = 0.
The bar is released at rest with u = 1/2 - x/2, so it is compressed by 1/2, and its
lower end is 1/2 above the floor. The lower end falls at the speed 1/2 and reaches the
floor at t = 1. It rests on the floor with the force 1/2 until t = 2, and rises until t
= 3. The motion repeats with the period 3. Two methods are compared with this solution:
exact fronts over two periods, and characteristics over ten periods, without drift.

Source: demo_dynamic_contact_1D of GetFEM, after F. Dabaghi, A. Petrov, J. Pousin, Y.
Renard, Convergence of mass redistribution method for the one-dimensional wave equation
with a unilateral constraint at the boundary, ESAIM: Mathematical Modelling and
Numerical Analysis 48 (2014).
"""

import numpy as np

import rodimpact as ri

from .table import Case, Rows, largest_magnitude
from .unit import rod

SOURCE = "Dabaghi et al. 2014"
PERIOD = 3.0
PERIODS = 10  # periods of the run by characteristics
SAMPLES_PER_TIME = 50  # times at which gap and force are compared
X = np.linspace(0.0, 1.0, 41)


def released_bar() -> ri.System:
    """System of a floor, a compressed bar, and a wall that is bonded to the bar.

    The bar is compressed by a half, and 1/2 above the floor. It is released at t = 0.
    """
    bar = rod(1.0, strain=-0.5)
    bodies = [ri.Wall(), bar, ri.Wall()]
    contacts = [ri.Rigid(), ri.Bonded()]
    return ri.System(bodies, gaps=[0.5, 0.0], contacts=contacts)


def run() -> Rows:
    """Compare two periods by wave fronts, then ten by characteristics."""
    yield from by_fronts()
    yield from by_characteristics()


def expected_height(t: np.ndarray) -> np.ndarray:
    """Height of the lower end at times t, by lines between its turns.

    In each period of 3 the end falls from 1/2 until 1, rests on the floor until 2, and
    rises to 1/2 until 3.
    """
    phase = t % PERIOD
    falling = (1 - phase) / 2
    rising = (phase - 2) / 2
    return np.select([phase < 1, phase < 2], [falling, 0.0], rising)


def expected_force(t: np.ndarray) -> np.ndarray:
    """Force of the floor at times t, none of which is that of a jump.

    It is 1/2 while the end rests, from 1 to 2 in each period of 3, else 0.
    """
    phase = t % PERIOD
    rests = (phase > 1) & (phase < 2)
    return np.where(rests, 0.5, 0.0)


def by_fronts() -> Rows:
    """Height, force, contacts and state over two periods, by wave fronts.

    All is compared with the solution by hand; the state after each period with that at
    t = 0.
    """
    end = 6.75
    solution = ri.solve(released_bar(), until=end)
    floor = solution.contacts[0]
    t = np.linspace(0.0, end, 271)
    between = (t + 0.0125)[:-1]  # half-way to the next time: the force does not jump
    height_error = floor.gap(t) - expected_height(t)
    force_error = floor.force(between) - expected_force(between)
    case = Case("GetFEM, released bar", SOURCE)
    yield case.zero("height of the lower end, largest difference", height_error, 1e-13)
    yield case.zero("contact force, largest difference", force_error, 1e-14)
    for i, episode in enumerate(floor.episodes):
        start = 1.0 + 3 * i
        opening = 2.0 + 3 * i
        yield case.row(f"contact {i + 1} begins", start, episode.start, 1e-14)
        yield case.row(f"contact {i + 1} ends", opening, episode.opening, 1e-14)
    for later in (PERIOD, 2 * PERIOD):
        difference = state_change(solution, later)
        quantity = f"state at t = {later:g}, largest difference from t = 0"
        yield case.row(quantity, 0.0, difference, 1e-13)


def state_change(solution: ri.Solution, t: float) -> float:
    """Largest difference of a field at time t from the field at the start.

    The fields are velocity, strain and displacement of the bar.
    """
    differences = []
    for field in (solution.velocity, solution.strain, solution.displacement):
        at_start = field(1, X, 0.0)
        difference = field(1, X, t) - at_start
        differences.append(largest_magnitude(difference))
    return max(differences)


def by_characteristics() -> Rows:
    """Contacts, height, force and drift over ten periods, by characteristics.

    All is compared with the solution by hand. The drift is that of the height 1/2 after
    each period.
    """
    end = PERIOD * PERIODS
    solution = ri.solve(released_bar(), until=end, method="characteristics")
    floor = solution.contacts[0]
    t = np.arange(round(end * SAMPLES_PER_TIME) + 1) / SAMPLES_PER_TIME
    between = (t[:-1] + t[1:]) / 2  # times at which the force does not jump
    height_error = floor.gap(t) - expected_height(t)
    force_error = floor.force(between) - expected_force(between)
    ends = PERIOD * np.arange(1, PERIODS + 1)
    drift = floor.gap(ends) - 0.5
    case = Case(f"GetFEM, released bar, {PERIODS} periods of characteristics", SOURCE)
    contacts = len(floor.episodes)
    yield case.row("contacts", float(PERIODS), contacts, 0.0)
    yield case.zero("height of the lower end, largest difference", height_error, 1e-12)
    yield case.zero("contact force, largest difference", force_error, 1e-12)
    yield case.zero("highest point of each period, largest drift", drift, 1e-12)
