"""Proof that the two sides of a contact never meet again, for all methods.

On each side stands a group of bonded bodies, or a wall. As long as nothing touches the
group, its end moves with the mean velocity of the group, and deviates from that motion
by no more than a bound: d = integral(strain g dx), g the mass fraction beyond x as seen
from that end, is at most sqrt(2 U integral(g^2 dx/(E A))), U the vibration energy,
which never grows. Methods say what their groups do; the proof is the same.
"""

import math
from typing import Any


def separation_time(
    opening: Any, least_opening: Any, mean_gap: Any, bound_squared: Any, tolerance: Any
) -> float:
    """Time after which the proof that a contact stays open can succeed.

    It is 0 if the proof succeeds now, and inf if the mean motions do not open the gap:
    then time alone does not help. Any units may be used that fit each other.

    Parameters
    ----------
    opening : float
        Mean velocity of the right group, less that of the left one.
    least_opening : float
        Least velocity at which their ends can part as long as both are free.
    mean_gap : float
        Gap between the mean motions: the gap, less the deviation of the right end, plus
        that of the left end.
    bound_squared : float
        Square of the distance that vibration can bridge. The proof itself takes no
        root, so that it works on fractions.
    tolerance : float
        Velocity that counts as zero.
    """
    if least_opening >= -tolerance:  # the ends cannot approach each other
        return 0.0
    # The mean gap does not close, and vibration cannot bridge it.
    if opening >= -tolerance and mean_gap > 0 and mean_gap * mean_gap > bound_squared:
        return 0.0
    wait = math.inf
    if opening > tolerance:  # the mean gap will be as large as the bound
        wait = (math.sqrt(bound_squared) - mean_gap) / opening
    return wait


def undecided(opening: Any, least_opening: Any, tolerance: Any) -> bool:
    """Whether the velocities alone decide nothing, so that the bounds are needed."""
    return bool(least_opening < -tolerance <= opening)
