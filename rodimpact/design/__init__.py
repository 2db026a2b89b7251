"""Inverse design: which row of bodies gives a wanted pulse, a wanted e, or no second pulse.

Every function returns a frozen result with the `system` it found, what was wanted and what that
system reaches, as `rodimpact.solve` computes it; ``plot.design`` draws both.

>>> import numpy as np, rodimpact as ri
>>> steel = ri.materials.steel
>>> shorter = ri.Rod(np.linspace(0.1, 1, 10), area=1e-4, material=steel, velocity=1.0)
>>> longer = ri.Rod(1.0, area=1e-4, material=steel)
>>> found = ri.design.restitution(0.45, ri.System([shorter, longer]))
>>> round(found.system.bodies[0].length, 9)
0.45
"""

from .pulses import PulseDesign
from .rebound import RestitutionDesign, restitution
from .stepped import striker
from .trap import momentum_trap

__all__ = [
    "PulseDesign",
    "RestitutionDesign",
    "momentum_trap",
    "restitution",
    "striker",
]
