"""Rods of steel, as most tests collide them."""

import rodimpact as ri

STEEL = ri.materials.steel
C = STEEL.wave_speed
"""Bar speed of steel, m/s."""


def rod(length=1.0, velocity=0.0, area=1e-4, material=STEEL, **settings):
    """A rod of steel, 1 m long and 1 cm^2 thick, at rest, if nothing else is said.

    `settings` are other arguments of `ri.Rod`.
    """
    return ri.Rod(length, area=area, material=material, velocity=velocity, **settings)
