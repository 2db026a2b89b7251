"""When the two sides of a contact are proved never to meet again, for all methods.

On each side stands a group of bonded bodies, or a wall. As long as nothing touches it, its end
moves with the mean velocity of the group, and deviates from that motion by no more than a bound:
d = integral(strain g dx), g the mass fraction beyond x as seen from that end, is at most
sqrt(2 E integral(g^2 dx/(E A))), E the energy of vibration, which never grows. Methods say what
their groups do; the proof is the same.
"""

import math
from typing import Any


def separation_time(
    opening: Any, least: Any, apart: Any, square: Any, tol: Any
) -> float:
    """Time until a contact may be proved not to close again: 0 if it is, inf if not as it is.

    Parameters
    ----------
    opening : float
        Mean velocity of the right group, less that of the left one.
    least : float
        Least velocity at which their ends can part as long as both are free.
    apart : float
        The gap, less what both ends are nearer to each other than by their mean motions.
    square : float
        Of the distance that vibration can bridge; no root is taken where it decides.
    tol : float
        Velocity that counts as none.
    """
    if least >= -tol:
        return 0.0
    if opening >= -tol and apart > 0 and apart * apart > square:
        return 0.0
    wait = math.inf
    if opening > tol:
        wait = (math.sqrt(square) - apart) / opening
    return wait


def undecided(opening: Any, least: Any, tol: Any) -> bool:
    """Whether velocities alone do not tell."""
    return bool(least < -tol <= opening)
