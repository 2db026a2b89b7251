"""Certified bounds: closed forms within them, runs on fractions, and how much wider they are.

- Rods of one material and section: e = l1/l2, l1 the shorter one, lies between the quotients of the
  lengths at the ends of their tolerances.
- Rods whose tolerances lie on both sides of equal lengths: e = l1/l2 or l2/l1 by two formulas.
- Random pairs, a third of them commensurate, with a tolerance of 0.1 % on all lengths, areas and
  velocities: runs on fractions at corners of the tolerances and between are all within the bounds,
  and these are at most four times as wide as what the runs come to.

Source: textbook section 10.5, box 10.4; Moore, Interval Analysis, 1966.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

import rodimpact as ri

from .saint_venant import rod
from .table import Row

BOX, RUNS = "textbook, box 10.4: l1/l2", "runs on fractions"
PAIRS, PLACES = 12, 24


def run() -> list[Row]:
    """The box, equal rods, random pairs."""
    return box() + equal_rods() + pairs()


def box() -> list[Row]:
    """Lengths 2 : 5, each within 1/4000."""
    low, high = ri.enclosure(
        ri.System([rod(1, 2, 1.0), rod(1, 5)]), {"length": 1 / 4000}).restitution or (0, 0)
    case, size = "lengths 2 : 5 within 1/4000", Fraction(1, 4000)
    lowest, highest = (2 - size) / (5 + size), (2 + size) / (5 - size)
    return [
        Row(case, "lowest e", BOX, float(lowest), low, 1e-12),
        Row(case, "highest e", BOX, float(highest), high, 1e-12),
        Row(case, "ends that the bounds leave out", BOX, 0,
            float((low > lowest) + (high < highest)), 0.0),
    ]


def equal_rods() -> list[Row]:
    """Lengths 1 : 1, the first within 1/1000."""
    found = ri.enclosure(ri.System([rod(1, 1, 1.0), rod(1, 1)]), {"bodies.0.length": 1e-3})
    low, high = found.restitution or (0, 0)
    case = "lengths 1 : 1, the first within 1/1000"
    return [
        Row(case, "formulas that meet", BOX, 2, found.formulas, 0.0),
        Row(case, "lowest e", BOX, 0.999, low, 1e-12),
        Row(case, "highest e", BOX, 1.0, high, 4e-6),
    ]


def pairs() -> list[Row]:
    """Random pairs within 0.1 %."""
    rng, outside, widest = np.random.default_rng(18), 0, 0.0
    for i in range(PAIRS):
        T, Z = rng.uniform(1, 9, 2).round(3), rng.uniform(0.5, 2, 2).round(3)
        if i % 3 == 0:
            T, Z = T.round(), Z.round()
        system = ri.System([rod(Z[0], T[0], 1.0), rod(Z[1], T[1], -0.5)])
        found = ri.enclosure(system, dict.fromkeys(("length", "area", "velocity"), "0.1 %"))
        low, high = found.restitution or (0, 0)
        values = []
        for place in range(PLACES):
            shares = rng.integers(0, 2, 6) * 8 if place % 2 else rng.integers(0, 9, 6)
            e = ri.exact(system, {
                path: Fraction(repr(least)) + (Fraction(repr(most)) - Fraction(repr(least)))
                * Fraction(int(share), 8)
                for share, (path, (least, most)) in zip(
                    shares, found.tolerances.items(), strict=True)
            }).restitution
            assert e is not None
            outside += not low <= e <= high
            values.append(float(e))
        widest = max(widest, (high - low - 1e-12) / (max(values) - min(values)))
    case = f"{PAIRS} random pairs within 0.1 %"
    return [
        Row(case, f"of {PAIRS * PLACES} runs, outside", RUNS, 0, outside, 0.0),
        Row(case, "how much wider than the runs, above 1", RUNS, 1.0, widest, 3.0),
    ]
