"""Proof that the two sides of a contact never meet again, for all methods.

On each side of the contact is a group of bonded bodies, or a wall. As long as nothing
touches the group, its end moves with the mean velocity of the group, and deviates from
this motion by d = integral(strain g dx), where g is the fraction of the mass that lies
beyond x as seen from that end. The deviation is at most
sqrt(2 U integral(g^2 dx/(E A))), with the vibration energy U, which never grows. Each
method computes the motions of its groups; the proof is the same.
"""

import math
from typing import Any


def separation_time(
    opening: Any, least_opening: Any, mean_gap: Any, bound_squared: Any, tolerance: Any
) -> float:
    """Time after which the proof that a contact stays open can succeed.

    It is 0 if the proof succeeds now, and inf if the mean motions do not open the gap,
    so that the proof will not succeed later either. Any consistent units may be used.

    Parameters
    ----------
    opening : float
        Mean velocity of the right group minus that of the left group.
    least_opening : float
        Lower bound of the velocity at which the two ends part while nothing touches
        them.
    mean_gap : float
        Gap between the mean motions: the gap, minus the deviation of the right end,
        plus that of the left end.
    bound_squared : float
        Square of the largest distance that vibration can bridge. It is given as a
        square, so that the proof itself needs no root and works on fractions.
    tolerance : float
        Largest velocity that counts as zero.
    """
    if least_opening >= -tolerance:  # the ends cannot approach each other
        return 0.0
    # The mean gap does not close, and vibration cannot bridge it: the gap is larger
    # than the root of `bound_squared`.
    if opening >= -tolerance and mean_gap > 0 and mean_gap * mean_gap > bound_squared:
        return 0.0
    wait = math.inf
    if opening > tolerance:  # time until the mean gap is as large as the bound
        wait = (math.sqrt(bound_squared) - mean_gap) / opening
    return wait


def undecided(opening: Any, least_opening: Any, tolerance: Any) -> bool:
    """Whether `separation_time` needs the mean gap and its bound to decide.

    Otherwise the velocities, its other arguments, decide alone.
    """
    return bool(least_opening < -tolerance <= opening)
