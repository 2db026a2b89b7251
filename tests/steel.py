"""Rods of steel, as most tests collide them."""

import rodimpact as ri

STEEL = ri.materials.steel
C = STEEL.wave_speed


def rod(length=1.0, velocity=0.0, area=1e-4, material=STEEL, **more):
    """A rod of steel, 1 m long and 1 cm^2 thick, at rest, if nothing else is said."""
    return ri.Rod(length, area=area, material=material, velocity=velocity, **more)
