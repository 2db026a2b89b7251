"""Rods in units in which the wave speed is 1: time is length, impedance is area."""

from typing import Any

import rodimpact as ri

UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)


def rod(
    transit_time: Any, impedance: Any = 1.0, velocity: Any = 0.0, strain: Any = 0.0
) -> ri.Rod:
    """A uniform rod by its transit time and its impedance.

    The length is c T = T, and the area is Z/(rho c) = Z.
    """
    return ri.Rod(
        transit_time,
        area=impedance,
        material=UNIT,
        velocity=velocity,
        strain=strain,
    )
