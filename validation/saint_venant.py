"""Two uniform free rods that differ in length, area and material.

The short rod is the rod with the shorter transit time T. If its impedance is the
smaller impedance, the force V Z1 Z2/(Z1 + Z2) ends after 2 T_short. Otherwise the force
is multiplied after every 2 T_short by the factor

    q = (Z_short - Z_long)/(Z_short + Z_long)

and ends after 2 T_long. The solver is compared with values of this formula computed by
hand, also for a pair with different lengths, areas and materials. Random pairs are
compared with `rodimpact.theory`, to round-off.

The solver ignores waves below 2^-48 of the velocity scale. Let K be the number of round
trips of the short rod. If q^K is smaller than 2^-48, the computed force ends early: the
last part, which has no impulse, is missing. So durations are compared only if q^K >
2^-46.

Source: B. de Saint-Venant, Sur le choc longitudinal de deux barres élastiques, Journal
de mathématiques pures et appliquées 12 (1867); S. P. Timoshenko and J. N. Goodier,
Theory of Elasticity, longitudinal impact of bars.
"""

from fractions import Fraction

import numpy as np
from numpy.random import default_rng

import rodimpact as ri

from .table import Case, Rows
from .unit import rod

SOURCE = "Saint-Venant 1867"
BY_HAND = {  # impedances (Z1, Z2) and transit times (T1, T2): e
    ((1, 1), (1, 2)): Fraction(1, 2),
    ((1, 2), (1, 2)): Fraction(2, 3),
    ((2, 1), (1, 2)): Fraction(7, 9),
    ((3, 1), (1, 5)): Fraction(11, 20),
    ((5, 1), (3, 10)): Fraction(409, 486),
}
PAIRS = 2000
NEGLIGIBLE_WAVE_RATIO = 2.0**-46  # the solver may end the force early below it


def run() -> Rows:
    """Compare pairs by hand, a pair that differs in everything, and random pairs."""
    for (impedances, transit_times), e in BY_HAND.items():
        yield from by_hand(impedances, transit_times, e)
    yield from all_different()
    yield from random_pairs()


def by_hand(
    impedances: tuple[int, int], transit_times: tuple[int, int], e: Fraction
) -> Rows:
    """e of a pair, beside the value that is worked out by hand."""
    Z1, Z2 = impedances
    T1, T2 = transit_times
    first = rod(T1, Z1, velocity=1.0)
    second = rod(T2, Z2)
    outcome = ri.collide(first, second)
    case = Case(f"Z {Z1} : {Z2}, T {T1} : {T2}", f"{SOURCE}: {e}")
    yield case.row("e", float(e), outcome.restitution, 1e-13)


def all_different() -> Rows:
    """e, impulse, and steps of the force of a pair that differs in everything.

    Z1 = 1, c1 = 1, l1 = 0.7 hits Z2 = 0.5, c2 = 1.3, l2 = 1.1 at speed 1.
    """
    l1 = 0.7
    l2 = 1.1
    c2 = 1.3
    Z2 = 0.5
    material = ri.Material("other", youngs_modulus=c2**2, density=1.0)
    first = rod(l1, velocity=1.0)
    second = ri.Rod(l2, area=Z2 / c2, material=material)  # Z = rho A c, rho = 1
    system = ri.System([first, second])
    solution = ri.solve(system)
    outcome = solution.outcome
    contact = solution.contacts[0]
    times, forces, _ = contact.breakpoints()
    changes = np.flatnonzero(np.diff(forces))
    first_change = changes[0]
    drop = times[first_change + 1]  # force i holds from time i on
    first_force = contact.force(0.0)
    second_force = contact.force(1.5)  # between the drop at 1.4 and the end at 1.69
    force_end = outcome.contacts[0].last
    e = outcome.restitution
    impulse = outcome.impulse
    case = Case("Z 1 : 0.5, c 1 : 1.3, l 0.7 : 1.1", SOURCE)
    yield case.row("e", 0.892862692862693, e, 1e-14)
    yield case.row("impulse, N s", 0.499145299145299, impulse, 1e-14)
    yield case.row("force at first, N", 1 / 3, first_force, 1e-15, detail="1/3")
    yield case.row("force drops at, s", 1.4, drop, 1e-14, detail="2 T_short")
    yield case.row("force after that, N", 1 / 9, second_force, 1e-15, detail="1/9")
    yield case.row("force ends at, s", 2.2 / 1.3, force_end, 1e-14, detail="2 T_long")


def last_wave_ratio(
    Z1: np.ndarray, T1: np.ndarray, Z2: np.ndarray, T2: np.ndarray
) -> np.ndarray:
    """Last force over the first: q^K, K the number of round trips of the short rod.

    q is the reflection of the short rod's wave at the contact, 0 if that is negative.
    """
    Z_short = np.where(T1 < T2, Z1, Z2)
    Z_long = np.where(T1 < T2, Z2, Z1)
    reflection = (Z_short - Z_long) / (Z_short + Z_long)
    q = np.maximum(reflection, 0.0)
    T_long = np.maximum(T1, T2)
    T_short = np.minimum(T1, T2)
    K = np.floor(T_long / T_short)
    return q**K


def random_pairs() -> Rows:
    """e and contact time of pairs with log-uniform impedances and transit times.

    Both are from 1 to 30. The contact time of a pair whose last wave is negligible must
    not be too long.
    """
    rng = default_rng(1867)
    logarithms = rng.uniform(0, np.log(30.0), (4, PAIRS))
    Z1, T1, Z2, T2 = np.exp(logarithms)
    exact = ri.theory.saint_venant(Z1, T1, Z2, T2)
    restitutions = []
    durations = []
    for i in range(PAIRS):
        first = rod(T1[i], Z1[i], velocity=1.0)
        second = rod(T2[i], Z2[i])
        outcome = ri.collide(first, second)
        restitutions.append(outcome.restitution)
        durations.append(outcome.duration)
    ratio = last_wave_ratio(Z1, T1, Z2, T2)
    # With the ratio 0 the first wave that returns ends the force, and none is left out.
    is_negligible = (ratio > 0) & (ratio <= NEGLIGIBLE_WAVE_RATIO)
    is_compared = ~is_negligible
    e_error = np.array(restitutions) - exact.restitution
    duration_error = np.array(durations) / exact.duration - 1
    # The solver may end such a force early, but not late.
    excess = np.maximum(duration_error[is_negligible], 0.0)
    case = Case(f"{PAIRS} random pairs", "`rodimpact.theory`")
    yield case.zero("e, largest difference", e_error, 1e-11)
    yield case.zero(
        f"contact time of {np.sum(is_compared)} pairs, largest relative difference",
        duration_error[is_compared],
        1e-11,
    )
    yield case.zero(
        f"contact time of the other {np.sum(is_negligible)}, whose force falls below "
        "2^-46 of the first, largest relative excess",
        excess,
        1e-11,
    )
