"""Inverse design: bodies that give a wanted pulse, or no second pulse.

Every function returns a frozen `PulseDesign`. It holds the system, the wanted pulse and
the pulse of this system as `rodimpact.solve` computes it; ``plot.design`` draws both
pulses. Where to begin: `striker` in `stepped`, with the search in `striker_search`, and
`momentum_trap` in `trap`; `pulses` has the result and the integrals over pulses.
"""

from typing import TYPE_CHECKING

from ..hints import missing_name
from .pulses import PulseDesign
from .stepped import striker
from .trap import momentum_trap

__all__ = [
    "PulseDesign",
    "momentum_trap",
    "striker",
]


if not TYPE_CHECKING:  # a type checker must not take every name for granted

    def __getattr__(name: str) -> object:
        """Raise AttributeError that names the function that may be meant."""
        raise missing_name(__name__, name, __all__)
