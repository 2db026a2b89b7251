"""Inverse design: bodies that give a wanted pulse, or no second pulse.

Every function returns a frozen `PulseDesign` with the system, the wanted pulse and the
pulse that this system reaches, as `rodimpact.solve` computes it; ``plot.design`` draws
both. Where to begin: `striker` in `stepped`, with the search in `striker_search`, and
`momentum_trap` in `trap`; `pulses` has the result and the integrals over pulses.
"""

from .pulses import PulseDesign
from .stepped import striker
from .trap import momentum_trap

__all__ = [
    "PulseDesign",
    "momentum_trap",
    "striker",
]
