"""Two uniform free rods that differ in length, area and material.

The shorter transit time T names the short rod. If its impedance is the smaller one the force
V Z1 Z2/(Z1 + Z2) ends after 2 T_short; otherwise it falls by the factor
q = (Z_short - Z_long)/(Z_short + Z_long) every 2 T_short and ends after 2 T_long. Hand values of
that formula, one pair that differs in everything, and random pairs against `rodimpact.theory`.

The solver takes a wave below 2^-48 of the velocity scale for none. Where q^K, K the number of round
trips of the short rod, falls below that, the force ends early by a last part that carries no
impulse, so durations are compared only where q^K > 2^-46.

Source: B. de Saint-Venant, Sur le choc longitudinal de deux barres élastiques, Journal de
mathématiques pures et appliquées 12 (1867); S. P. Timoshenko and J. N. Goodier, Theory of
Elasticity, longitudinal impact of bars.
"""

from fractions import Fraction

import numpy as np

import rodimpact as ri

from .table import Case, Rows
from .unit import rod

SOURCE = "Saint-Venant 1867"
BY_HAND = {  # (Z1, Z2), (T1, T2): e
    ((1, 1), (1, 2)): Fraction(1, 2),
    ((1, 2), (1, 2)): Fraction(2, 3),
    ((2, 1), (1, 2)): Fraction(7, 9),
    ((3, 1), (1, 5)): Fraction(11, 20),
    ((5, 1), (3, 10)): Fraction(409, 486),
}
PAIRS = 2000


def run() -> Rows:
    """Hand values, one awkward pair, random pairs."""
    for ((Z1, Z2), (T1, T2)), e in BY_HAND.items():
        o = ri.collide(rod(T1, Z1, 1.0), rod(T2, Z2))
        case = Case(f"Z {Z1} : {Z2}, T {T1} : {T2}", f"{SOURCE}: {e}")
        yield case.row("e", float(e), o.restitution, 1e-13)
    yield from all_different()
    yield from random_pairs()


def all_different() -> Rows:
    """Z1 = 1, c1 = 1, l1 = 0.7 hits Z2 = 0.5, c2 = 1.3, l2 = 1.1 at speed 1."""
    case = Case("Z 1 : 0.5, c 1 : 1.3, l 0.7 : 1.1", SOURCE)
    other = ri.Material("other", youngs_modulus=1.3**2, density=1.0)
    solution = ri.solve(
        ri.System(
            [
                rod(0.7, velocity=1.0),
                ri.Rod(1.1, area=0.5 / 1.3, material=other),
            ]
        )
    )
    o, force = solution.outcome, solution.contacts[0].force
    times, forces, _ = solution.contacts[0].breakpoints()
    drop = float(times[np.flatnonzero(np.diff(forces))[0] + 1])
    yield case.row("e", 0.892862692862693, o.restitution, 1e-14)
    yield case.row("impulse, N s", 0.499145299145299, o.impulse, 1e-14)
    yield case.row("force at first, N", 1 / 3, force(0.0), 1e-15, ": 1/3")
    yield case.row("force drops at, s", 1.4, drop, 1e-14, ": 2 T_short")
    yield case.row("force after that, N", 1 / 9, force(1.5), 1e-15, ": 1/9")
    yield case.row(
        "force ends at, s", 2.2 / 1.3, o.contacts[0].last, 1e-14, ": 2 T_long"
    )


def random_pairs() -> Rows:
    """Impedances and transit times log-uniform over 1 : 30."""
    rng = np.random.default_rng(1867)
    Z1, T1, Z2, T2 = np.exp(rng.uniform(0, np.log(30.0), (4, PAIRS)))
    exact = ri.theory.saint_venant(Z1, T1, Z2, T2)
    outcomes = [
        ri.collide(rod(*first, 1.0), rod(*second))
        for first, second in zip(
            zip(T1, Z1, strict=True), zip(T2, Z2, strict=True), strict=True
        )
    ]
    short, long = np.where(T1 < T2, Z1, Z2), np.where(T1 < T2, Z2, Z1)
    q = np.maximum((short - long) / (short + long), 0.0)
    last = q ** np.floor(np.maximum(T1, T2) / np.minimum(T1, T2))
    faint = (q > 0) & (last <= 2.0**-46)
    e = np.array([o.restitution for o in outcomes])
    excess = np.array([o.duration for o in outcomes]) / exact.duration - 1
    case = Case(f"{PAIRS} random pairs", "`rodimpact.theory`")
    yield case.zero("e, largest difference", e - exact.restitution, 1e-11)
    yield case.zero(
        f"contact time of {np.sum(~faint)} pairs, largest relative difference",
        excess[~faint],
        1e-11,
    )
    yield case.zero(
        f"contact time of the other {np.sum(faint)}, whose force falls below 2^-46 of "
        "the first, largest relative excess",
        np.maximum(excess[faint], 0.0),
        1e-11,
    )
