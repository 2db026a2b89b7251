"""Figures of collisions: each function draws on an Axes and returns its artists.

Without an Axes a new figure is made; Axes of pyplot can be given, too. `save` writes a
figure to a file, `show` opens a window from a script, and a notebook shows the figure
if the call is the last line of a cell. ``with look("dark", width=85):`` makes figures
dark and 85 mm wide; ``plt.style.use("rodimpact.plot.dark")`` gives other figures the
same look. Only `show` changes matplotlib's global state.

A file draws one kind of figure. It is a recipe: what is measured from the solution,
then what is drawn. Begin with `ledger`, the simplest. `scales` has units and
numbers, `labels` words and their room, `panels` figures and Axes, `style` colours.

>>> import rodimpact as ri
>>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
>>> picture = ri.plot.spacetime(ri.solve(ri.System([rod, ri.Wall()])))
>>> picture.ax.get_ylabel()
'time t (µs)'
"""

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Never

from ..hints import missing_name
from .atlases import atlas
from .bearing import bearing
from .designs import design
from .diagram import spacetime
from .families import restitution, sweep
from .files import save
from .gauges import gauge
from .histories import contact
from .ledger import energy
from .moving import animation
from .page import overview
from .records import comparison, fit, reduction
from .showing import show
from .stages import snapshots
from .style import look

__all__ = [
    "animation",
    "atlas",
    "bearing",
    "comparison",
    "contact",
    "design",
    "energy",
    "fit",
    "gauge",
    "look",
    "overview",
    "reduction",
    "restitution",
    "save",
    "show",
    "snapshots",
    "spacetime",
    "sweep",
]


class _Functions(ModuleType):
    """The kind of this module, which answers a call by the functions to call."""

    def __call__(self, *_: object, **__: object) -> Never:
        """Raise TypeError that names the functions to call."""
        raise TypeError(
            "rodimpact.plot is a module: plot.overview(solution) draws a solution, "
            "plot.sweep(family) a family, and help(rodimpact.plot) lists the others"
        )


sys.modules[__name__].__class__ = _Functions


if not TYPE_CHECKING:  # a type checker must not take every name for granted

    def __getattr__(name: str) -> object:
        """Raise AttributeError that names the function that may be meant."""
        raise missing_name(__name__, name, __all__)
