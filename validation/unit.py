"""Rods in units of their own: the wave speed is 1, so transit time is length, impedance is area."""

from typing import Any

import rodimpact as ri

UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)


def rod(length: Any, Z: Any = 1.0, velocity: Any = 0.0, strain: Any = 0.0) -> ri.Rod:
    """A rod of transit time `length` and impedance Z."""
    return ri.Rod(length, area=Z, material=UNIT, velocity=velocity, strain=strain)
