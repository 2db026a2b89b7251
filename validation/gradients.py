"""Derivatives of collisions against derivatives of closed forms, and scaling laws.

- For rods of one material and section, e = l1/l2, where l1 is the shorter length. At
  equal lengths l this function has a kink, with the slope 1/l on one side and -1/l on
  the other.
- Near T1 : T2 = 2 : 5 and for r = Z2/Z1 >= 1, e = (2 T1 + (r - 1) T2)/(T2 (1 + r)).
  This formula is the sum of Saint-Venant's series.
- The velocities after a collision of three rods do not change if all lengths and gaps,
  or all areas, are multiplied by the same number. They are multiplied by the number
  that multiplies all velocities and gaps. So the sum of parameters times derivatives is
  0, 0 and the velocity itself, by Euler's theorem.

Source: textbook section 10.5, box 10.4; Saint-Venant 1867, see saint_venant.py.
"""

import numpy as np
from numpy.random import Generator, default_rng

import rodimpact as ri

from .table import Case, Rows
from .unit import rod

BOX = "textbook, box 10.4: l1/l2"
SERIES = "Saint-Venant 1867"
EULER = "Euler's theorem"
LENGTHS = ("bodies.0.length", "bodies.1.length")
GAP = "contacts.0.gap"
RANDOM_ROWS = 50


def run() -> Rows:
    """Compare derivatives for the box, its kink, a pair near 2 : 5, and random rows."""
    yield from box()
    yield from kink_of_the_box()
    yield from near_two_to_five()
    yield from scaling()


def box() -> Rows:
    """Derivatives of e = l1/l2 at lengths 2 : 5 of rods of one section.

    They are 1/l2 and -l1/l2^2.
    """
    first = rod(2, velocity=1.0)
    second = rod(5)
    system = ri.System([first, second])
    gradient = ri.gradient(system, wrt=LENGTHS)
    by_l1 = gradient[LENGTHS[0]]
    by_l2 = gradient[LENGTHS[1]]
    case = Case("rods of one section", BOX)
    yield case.row("de/dl1 at 2 : 5", 1 / 5, by_l1, 1e-10)
    yield case.row("de/dl2 at 2 : 5", -2 / 25, by_l2, 1e-10)


def kink_of_the_box() -> Rows:
    """One-sided derivatives of e at equal lengths, where e has a kink.

    The derivative with respect to l1 is 1/l2 below and -1/l2 above l1 = l2.
    """
    first = rod(2, velocity=1.0)
    second = rod(2)
    system = ri.System([first, second])
    gradient = ri.gradient(system, wrt=LENGTHS)
    kink = gradient.kinks[LENGTHS[0]]
    exchanged = "the same with l1 and l2 exchanged"
    below = kink.below
    above = kink.above
    case = Case("rods of one section", BOX)
    yield case.row("de/dl1 below l1 = l2 = 2", 0.5, below, 1e-9)
    yield case.row("de/dl1 above l1 = l2 = 2", -0.5, above, 1e-9, source=exchanged)


def near_two_to_five() -> Rows:
    """Derivatives of e at transit times 2.05 : 5.15 and impedances 1 : 1.7.

    They are derivatives with respect to both transit times and the ratio r of
    impedances, beside those of Saint-Venant's formula.
    """
    T1 = 2.05
    T2 = 5.15
    r = 1.7
    first = rod(T1, velocity=1.0)
    second = rod(T2, r)
    system = ri.System([first, second])
    area = "bodies.1.area"
    gradient = ri.gradient(system, wrt=[*LENGTHS, area])
    total = 1 + r  # (Z1 + Z2)/Z1
    by_T1 = 2 / (T2 * total)
    by_T2 = -2 * T1 / (T2**2 * total)
    by_r = 2 * (T2 - T1) / (T2 * total**2)
    case = Case("T 2.05 : 5.15, Z 1 : 1.7", SERIES)
    yield case.row("de/dT1", by_T1, gradient[LENGTHS[0]], 1e-11)
    yield case.row("de/dT2", by_T2, gradient[LENGTHS[1]], 1e-11)
    yield case.row("de/dr", by_r, gradient[area], 1e-11)


def scaling_errors(rng: Generator) -> np.ndarray:
    """Errors of Euler's theorem for the last velocity of a row, over stated errors.

    They are those of scaling all lengths and the gap, all areas, and all velocities and
    the gap: the sum of each derivative times its number is 0, 0 and the velocity
    itself.
    """
    T = rng.uniform(1, 2, 3)
    Z = rng.uniform(0.5, 2, 3)
    velocities = rng.uniform(0, 1, 3)
    v = sorted(velocities, reverse=True)
    gap = float(rng.uniform(0.1, 1))
    rods = []
    for i in range(3):
        rods.append(rod(T[i], Z[i], v[i]))
    system = ri.System(rods, gaps=[gap, 0.0])
    paths = []
    for name in ("length", "area", "velocity"):
        for i in range(3):
            paths.append(f"bodies.{i}.{name}")
    gradient = ri.gradient(system, "velocity_after.2", [*paths, GAP])

    numbers = np.concatenate([T, Z, v])
    derivatives = [gradient[path] for path in paths]
    # A relative change of a number x changes the result by x times its derivative.
    by_lengths, by_areas, by_velocities = sums_of_three(numbers * derivatives)
    by_gap = gap * gradient[GAP]
    length_error = by_lengths + by_gap
    velocity_error = by_velocities + by_gap - gradient.value
    errors = (length_error, by_areas, velocity_error)

    stated_errors = [gradient.errors[path] for path in paths]
    stated = sums_of_three(numbers * stated_errors)
    gap_error = gap * gradient.errors[GAP]
    stated += np.array([gap_error, 0.0, gap_error])
    return np.abs(errors) / stated


def sums_of_three(values: np.ndarray) -> np.ndarray:
    """Sums over the three rods: of lengths' values, areas' and velocities'."""
    return values.reshape(3, 3).sum(axis=1)


def scaling() -> Rows:
    """Euler's theorem: the largest errors of its sums of derivatives, of random rows.

    The errors are divided by the stated ones.
    """
    rng = default_rng(18)
    worst = np.zeros(3)
    for _ in range(RANDOM_ROWS):
        worst = np.maximum(worst, scaling_errors(rng))
    case = Case(f"{RANDOM_ROWS} random rows of three", EULER)
    scaled = ("lengths and gap", "areas", "velocities and gap")
    for i, parameters in enumerate(scaled):
        quantity = (
            f"velocity after by {parameters}, largest difference over stated error"
        )
        yield case.row(quantity, 0.0, worst[i], 1.0)
