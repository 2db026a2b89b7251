"""A compressed bar, clamped at one end, is released above a floor: exactly periodic.

L = c = 1, E A = 1. The bar is clamped at x = 1 and has a unilateral floor at x = 0. It is released
at rest with u = 1/2 - x/2, so it is compressed by 1/2 and its lower end is 1/2 above the floor. The
end falls at speed 1/2, reaches the floor at t = 1, rests on it with force 1/2 until t = 2, rises
until t = 3, and everything begins anew with period 3. Both methods: exact fronts over two periods,
and characteristics over ten, where nothing may drift.

Source: demo_dynamic_contact_1D of GetFEM, after F. Dabaghi, A. Petrov, J. Pousin, Y. Renard,
Convergence of mass redistribution method for the one-dimensional wave equation with a unilateral
constraint at the boundary, ESAIM: Mathematical Modelling and Numerical Analysis 48 (2014).
"""

import numpy as np

import rodimpact as ri

from .table import Case, Rows
from .unit import rod

SOURCE = "Dabaghi et al. 2014"
X = np.linspace(0.0, 1.0, 41)
ROW = ri.System(  # floor, bar, wall bonded to the bar
    [ri.Wall(), rod(1.0, strain=-0.5), ri.Wall()],
    gaps=[0.5, 0.0],
    contacts=[ri.Rigid(), ri.Bonded()],
)
PERIODS, STEPS = 10, 50


def run() -> Rows:
    """Fronts, then characteristics."""
    return exactly(), for_long()


def height_of(t: np.ndarray) -> np.ndarray:
    """Height of the lower end."""
    phase = t % 3.0
    return np.where(
        phase < 1, (1 - phase) / 2, np.where(phase < 2, 0.0, (phase - 2) / 2)
    )


def force_of(t: np.ndarray) -> np.ndarray:
    """Force of the floor, not at jumps."""
    return np.where((t % 3.0 > 1) & (t % 3.0 < 2), 0.5, 0.0)


def exactly() -> Rows:
    """Two periods of exact fronts."""
    solution = ri.solve(ROW, until=6.75)
    floor = solution.contacts[0]
    case = Case("GetFEM, released bar", SOURCE)
    t = np.linspace(0.0, 6.75, 271)
    middle = (t + 0.0125)[:-1]
    yield case.zero(
        "height of the lower end, largest difference",
        floor.gap(t) - height_of(t),
        1e-13,
    )
    yield case.zero(
        "contact force, largest difference",
        floor.force(middle) - force_of(middle),
        1e-14,
    )
    for i, episode in enumerate(floor.episodes):
        yield case.row(f"contact {i + 1} begins", 1.0 + 3 * i, episode.start, 1e-14)
        yield case.row(f"contact {i + 1} ends", 2.0 + 3 * i, episode.opening, 1e-14)
    for later in (3.0, 6.0):
        apart = [
            np.abs(field(1, X, later) - field(1, X, 0.0)).max()
            for field in (solution.velocity, solution.strain, solution.displacement)
        ]
        yield case.row(
            f"state at t = {later:g}, largest difference from t = 0",
            0.0,
            max(apart),
            1e-13,
        )


def for_long() -> Rows:
    """Ten periods of characteristics."""
    end = 3.0 * PERIODS
    solution = ri.solve(ROW, until=end, method="characteristics")
    floor = solution.contacts[0]
    t = np.arange(round(end * STEPS) + 1) / STEPS
    middle = (t[:-1] + t[1:]) / 2
    tops = floor.gap(3.0 * np.arange(1, PERIODS + 1))
    case = Case(f"GetFEM, released bar, {PERIODS} periods of characteristics", SOURCE)
    yield case.row("contacts", float(PERIODS), len(floor.episodes), 0.0)
    yield case.zero(
        "height of the lower end, largest difference",
        floor.gap(t) - height_of(t),
        1e-12,
    )
    yield case.zero(
        "contact force, largest difference",
        floor.force(middle) - force_of(middle),
        1e-12,
    )
    yield case.zero("highest point of each period, largest drift", tops - 0.5, 1e-12)
