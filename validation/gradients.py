"""Derivatives of collisions against those of closed forms, and against what scaling demands.

- Rods of one material and section: e = l1/l2, l1 the shorter one; so e has a kink where they are
  as long, of slope 1/l on one side and -1/l on the other.
- Near T1 : T2 = 2 : 5 and for r = Z2/Z1 >= 1: e = (2 T1 + (r - 1) T2)/(T2 (1 + r)), as hand
  summation of Saint-Venant's series gives.
- Velocities after the collision of three rods do not change if all lengths and gaps are multiplied
  by one number, or all areas; they are multiplied as velocities and gaps are. Derivatives obey
  (Euler).

Source: textbook section 10.5, box 10.4; Saint-Venant 1867, see saint_venant.py.
"""

import numpy as np

import rodimpact as ri

from .table import Case, Row, Rows
from .unit import rod

BOX, SERIES, EULER = "textbook, box 10.4: l1/l2", "Saint-Venant 1867", "Euler's theorem"
LENGTHS = ("bodies.0.length", "bodies.1.length")
ROWS = 50


def run() -> Rows:
    """The box, its kink, a pair near 2 : 5, random rows of three."""
    return box(), near_two_to_five(), scaling()


def box() -> Rows:
    """Lengths 2 : 5 and equal lengths."""
    case = Case("rods of one section", BOX)
    g = ri.gradient(ri.System([rod(2, velocity=1.0), rod(5)]), wrt=LENGTHS)
    for i, (path, exact) in enumerate(zip(LENGTHS, (1 / 5, -2 / 25), strict=True)):
        yield case.row(f"de/dl{i + 1} at 2 : 5", exact, g[path], 1e-10)
    kink = ri.gradient(ri.System([rod(2, velocity=1.0), rod(2)]), wrt=LENGTHS).kinks[
        LENGTHS[0]
    ]
    yield case.row("de/dl1 below l1 = l2 = 2", 0.5, kink.below, 1e-9)
    yield case.row(
        "de/dl1 above l1 = l2 = 2",
        -0.5,
        kink.above,
        1e-9,
        "the same with l1 and l2 exchanged",
    )


def near_two_to_five() -> Rows:
    """Transit times 2.05 : 5.15, impedances 1 : 1.7."""
    T1, T2, r = 2.05, 5.15, 1.7
    g = ri.gradient(
        ri.System([rod(T1, velocity=1.0), rod(T2, r)]), wrt=[*LENGTHS, "bodies.1.area"]
    )
    exact = (
        2 / (T2 * (1 + r)),
        -2 * T1 / (T2**2 * (1 + r)),
        2 * (T2 - T1) / (T2 * (1 + r) ** 2),
    )
    for name, path, value in zip(("T1", "T2", "r"), g.wrt, exact, strict=True):
        yield Row(
            "T 2.05 : 5.15, Z 1 : 1.7", f"de/d{name}", SERIES, value, g[path], 1e-11
        )


def scaling() -> Rows:
    """Sums of the derivatives of the last velocity, each times its number."""
    rng, worst = np.random.default_rng(18), np.zeros(3)
    for _ in range(ROWS):
        T, Z = rng.uniform(1, 2, 3), rng.uniform(0.5, 2, 3)
        v, gap = sorted(rng.uniform(0, 1, 3), reverse=True), float(rng.uniform(0.1, 1))
        system = ri.System(
            [rod(*of) for of in zip(T, Z, v, strict=True)], gaps=[gap, 0.0]
        )
        paths = [
            f"bodies.{i}.{name}"
            for name in ("length", "area", "velocity")
            for i in range(3)
        ]
        g = ri.gradient(system, "velocity_after.2", [*paths, "contacts.0.gap"])
        by_number = np.concatenate([T, Z, v]) * [g[path] for path in paths]
        sums = by_number.reshape(3, 3).sum(axis=1)
        by_gap = gap * g["contacts.0.gap"]
        wrong = (sums[0] + by_gap, sums[1], sums[2] + by_gap - g.value)
        stated = np.concatenate([T, Z, v]) * [g.errors[path] for path in paths]
        gap_error = gap * g.errors["contacts.0.gap"]
        allowed = stated.reshape(3, 3).sum(axis=1)
        allowed += np.array([gap_error, 0.0, gap_error])
        worst = np.maximum(worst, np.abs(wrong) / allowed)
    for what, difference in zip(
        ("lengths and gap", "areas", "velocities and gap"), worst, strict=True
    ):
        yield Row(
            f"{ROWS} random rows of three",
            f"velocity after by {what}, largest difference over stated error",
            EULER,
            0.0,
            float(difference),
            1.0,
        )
