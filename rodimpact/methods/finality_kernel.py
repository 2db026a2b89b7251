"""When the two sides of a contact are proved never to meet again.

On each side stands a group of bonded bodies, or a wall. As long as nothing touches it, its end
moves with the mean velocity of the group, and deviates from that motion by no more than a bound:
d = integral(strain g dx), g the mass fraction beyond x as seen from that end, is at most
sqrt(2 E integral(g^2 dx/(E A))), E the energy of vibration, which never grows. Methods on a time
step say what their groups do; the proof is the same.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

NEVER = 1 << 62


class Side(NamedTuple):
    """One side of a contact; times in steps, lengths as velocities."""

    mean: float  # velocity
    low: float  # bounds of the end's velocity as long as it is free; infinite if not known
    high: float
    deviation: float  # of the end from the mean motion, positive to the right
    bound: float  # that it can ever reach


def separation_time(gap: float, left: Any, right: Any, tol: float) -> int:
    """Steps until a contact may be proved not to close again: 0 if it is, NEVER if not as it is."""
    if gap < 0:
        return NEVER
    if right.low - left.high >= -tol:
        return 0
    opening = right.mean - left.mean
    if opening < -tol:
        return NEVER
    apart, reach = gap + left.deviation - right.deviation, left.bound + right.bound
    if apart > 0 and apart > reach:
        return 0
    if opening <= tol:
        return NEVER
    wait = (reach - apart) / opening
    return int(wait) + 1 if wait <= NEVER // 2 else NEVER  # nan where energies overflow


def bound_of(energy: float, slack: float) -> float:
    """How far an end can get: `slack` is the integral of g^2/(E A)."""
    return math.sqrt(2 * max(energy, 0.0) * slack)
