"""Scales of a row, from its numbers; the page has this as JavaScript.

In a family numbers are arrays, so nothing here is decided by one of them.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def largest(values: Any) -> Any:
    """Largest of some numbers, for each member of a family."""
    found = values[0]
    for value in values[1:]:
        found = np.maximum(found, value)
    return found


def smallest(values: Any) -> Any:
    """Smallest of some numbers, for each member of a family."""
    found = values[0]
    for value in values[1:]:
        found = np.minimum(found, value)
    return found


def frame_of(walls: Any, velocities: Any) -> Any:
    """Velocity of the frame, m/s: that of the walls, else the middle of all velocities."""
    if len(walls) == 0:
        return smallest(velocities) / 2 + largest(velocities) / 2
    total = 0.0
    for v in walls:
        total = total + v
    return total / len(walls)


def scale_of(velocities: Any, strained: Any, pushed: Any, impedance: Any, fall: Any) -> Any:
    """Scale of velocities, m/s.

    Parameters
    ----------
    velocities : list
        Of all that moves at t = 0 or is moved, m/s.
    strained : list
        Wave speeds times strains, m/s.
    pushed : list
        Forces from outside, and those of contacts at t = 0, N.
    impedance : float
        The smallest, kg/s.
    fall : float
        What gravity adds in the longest transit, m/s.
    """
    spread = largest(velocities) - smallest(velocities)
    return spread + largest([0.0, *strained]) + largest([0.0, *pushed]) / impedance + fall
