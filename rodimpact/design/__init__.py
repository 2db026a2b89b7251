"""Inverse design: which row of bodies gives a wanted pulse, or no second pulse.

Every function returns a frozen result with the `system` it found, the wanted pulse and the pulse
that this system reaches, as `rodimpact.solve` computes it; ``plot.design`` draws both.
"""

from .pulses import PulseDesign
from .stepped import striker
from .trap import momentum_trap

__all__ = [
    "PulseDesign",
    "momentum_trap",
    "striker",
]
