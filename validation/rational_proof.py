"""The same kernel in plain Python on fractions: e is not nearly l1/l2, it is l1/l2.

Waves are of the type `fractions.Fraction`, times are integers, and the tolerance is 0.
For rods of one material and area, e == Fraction(l1, l2). For any impedances e equals
the formula of Saint-Venant, evaluated in fractions. Nothing is rounded, so the bounds
are 0.

Source: textbook section 10.5, box 10.4; Saint-Venant 1867, see saint_venant.py.
"""

from fractions import Fraction
from itertools import product

import rodimpact as ri

from .table import Case, Rows
from .unit import rod

NAMED_LENGTHS = [(1, 3), (2, 5), (3, 7), (99, 100), (355, 1130)]
LENGTHS = range(1, 31)
TRANSIT_TIMES = range(1, 9)
IMPEDANCES = range(1, 6)

PAIR = ri.System([rod(1.0, velocity=1.0), rod(1.0)])


def run() -> Rows:
    """Compare e of a few ratios of lengths, then of all small ones and small pairs."""
    case = Case("rational arithmetic", "textbook, box 10.4: l1/l2")
    for l1, l2 in NAMED_LENGTHS:
        e = collide(1, l1, 1, l2)
        yield case.row(f"e of lengths {l1} : {l2}", Fraction(l1, l2), e, 0.0)
    yield from all_lengths(case)
    yield from all_pairs(case)


def all_lengths(case: Case) -> Rows:
    """Number of wrong e of rods of one area, all lengths up to 30: e = l1/l2.

    e is computed in fractions, so that any difference counts.
    """
    count = 0
    wrong = 0
    for l2 in LENGTHS:
        for l1 in range(1, l2):
            count += 1
            if collide(1, l1, 1, l2) != Fraction(l1, l2):
                wrong += 1
    quantity = f"wrong ones of {count} ratios of lengths"
    yield case.row(quantity, Fraction(0), Fraction(wrong), 0.0)


def all_pairs(case: Case) -> Rows:
    """Number of wrong e of all pairs of small impedances and transit times.

    e is computed in fractions, and compared with Saint-Venant's closed form.
    """
    count = 0
    wrong = 0
    for pair in product(IMPEDANCES, TRANSIT_TIMES, IMPEDANCES, TRANSIT_TIMES):
        count += 1
        if collide(*pair) != saint_venant(*pair):
            wrong += 1
    quantity = f"wrong ones of {count} pairs of impedance and transit time"
    yield case.row(
        quantity, Fraction(0), Fraction(wrong), 0.0, source="Saint-Venant 1867"
    )


def collide(Z1: int, T1: int, Z2: int, T2: int) -> Fraction:
    """e of a rod at velocity 1 on a rod at rest, by the kernel of fronts.

    It runs on fractions.
    """
    values = {
        "bodies.0.impedance": Z1,
        "bodies.0.transit_time": T1,
        "bodies.1.impedance": Z2,
        "bodies.1.transit_time": T2,
    }
    e = ri.exact(PAIR, values).restitution
    assert e is not None
    return e


def saint_venant(Z1: int, T1: int, Z2: int, T2: int) -> Fraction:
    """e by the closed form, from the sum of the force's steps.

    With q = (Z_short - Z_long)/(Z_short + Z_long), or 0 if that is negative, the force
    falls by the factor q after each round trip of the short rod; K of them fit into one
    of the long rod. The impulse is that of these steps, each lasting 2 T_short, and of
    the last, shorter one.
    """
    short, long = sorted([(T1, Z1), (T2, Z2)])
    T_short, Z_short = short
    T_long, Z_long = long
    q = max(Fraction(Z_short - Z_long, Z_short + Z_long), Fraction(0))
    K, remainder = divmod(T_long, T_short)
    powers = [q**k for k in range(K)]
    steps = sum(powers) * T_short
    if q > 0:
        steps += q**K * remainder
    # The first force is Z1 Z2/(Z1 + Z2); a step lasts two transits: the factor 2.
    impulse = 2 * Fraction(Z1 * Z2, Z1 + Z2) * steps
    m1 = Z1 * T1
    m2 = Z2 * T2
    inverse_masses = Fraction(1, m1) + Fraction(1, m2)
    return impulse * inverse_masses - 1
