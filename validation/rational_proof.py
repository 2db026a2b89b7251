"""The same kernel in plain Python on fractions: e is not nearly l1/l2, it is l1/l2.

Waves are `fractions.Fraction`, times whole numbers, the tolerance is 0. For rods of one material
and area e == Fraction(l1, l2); for any impedances e equals Saint-Venant's formula evaluated in
fractions. Nothing is rounded anywhere, so the bounds are 0.

Source: textbook section 10.5, box 10.4; Saint-Venant 1867, see saint_venant.py.
"""

from fractions import Fraction

import rodimpact as ri

from .table import Case, Rows
from .unit import rod

SHOWN = [(1, 3), (2, 5), (3, 7), (99, 100), (355, 1130)]
LENGTHS, TIMES, IMPEDANCES = range(1, 31), range(1, 9), range(1, 6)

PAIR = ri.System([rod(1.0, velocity=1.0), rod(1.0)])


def run() -> Rows:
    """A few ratios of lengths by name, then all small ones, then all small pairs."""
    case = Case("rational arithmetic", "textbook, box 10.4: l1/l2")
    for l1, l2 in SHOWN:
        yield case.row(
            f"e of lengths {l1} : {l2}", Fraction(l1, l2), collide(1, l1, 1, l2), 0.0
        )
    ratios = [(l1, l2) for l2 in LENGTHS for l1 in range(1, l2)]
    wrong = sum(collide(1, l1, 1, l2) != Fraction(l1, l2) for l1, l2 in ratios)
    yield case.row(
        f"wrong ones of {len(ratios)} ratios of lengths",
        Fraction(0),
        Fraction(wrong),
        0.0,
    )
    pairs = [
        (Z1, T1, Z2, T2)
        for Z1 in IMPEDANCES
        for T1 in TIMES
        for Z2 in IMPEDANCES
        for T2 in TIMES
    ]
    wrong = sum(collide(*pair) != saint_venant(*pair) for pair in pairs)
    yield case.row(
        f"wrong ones of {len(pairs)} pairs of impedance and transit time",
        Fraction(0),
        Fraction(wrong),
        0.0,
        "Saint-Venant 1867",
    )


def collide(Z1: int, T1: int, Z2: int, T2: int) -> Fraction:
    """e of a rod at velocity 1 and a rod at rest, by the kernel of the fronts method."""
    e = ri.exact(
        PAIR,
        {
            "bodies.0.impedance": Z1,
            "bodies.0.transit_time": T1,
            "bodies.1.impedance": Z2,
            "bodies.1.transit_time": T2,
        },
    ).restitution
    assert e is not None
    return e


def saint_venant(Z1: int, T1: int, Z2: int, T2: int) -> Fraction:
    """The closed form, from the sum of the force's steps."""
    (T_short, Z_short), (T_long, Z_long) = sorted([(T1, Z1), (T2, Z2)])
    q = max(Fraction(Z_short - Z_long, Z_short + Z_long), Fraction(0))
    K, rest = divmod(T_long, T_short)
    steps = sum(q**k for k in range(K)) * T_short + q**K * rest * (q > 0)
    impulse = 2 * Fraction(Z1 * Z2, Z1 + Z2) * steps
    return impulse * (Fraction(1, Z1 * T1) + Fraction(1, Z2 * T2)) - 1
