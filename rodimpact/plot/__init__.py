"""Figures of collisions: each function draws a solution on an Axes and returns its artists.

No function shows a window or changes matplotlib's global state. Without an Axes a new figure is
made. `save` writes it to a file; a notebook shows it if the call is the last line of a cell. ``with
look("dark", width=85):`` makes figures dark and 85 mm wide.

>>> import rodimpact as ri
>>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
>>> picture = ri.plot.spacetime(ri.solve(ri.System([rod, ri.Wall()])))
>>> picture.ax.get_ylabel()
'time t (µs)'
"""

from .atlases import atlas
from .designs import design
from .diagram import spacetime
from .families import restitution, sweep
from .files import save
from .histories import contact, gauge
from .ledger import energy
from .moving import animation
from .page import overview
from .records import comparison, fit, reduction
from .stages import snapshots
from .style import look

__all__ = [
    "animation",
    "atlas",
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
    "snapshots",
    "spacetime",
    "sweep",
]
