"""Figures of collisions: each function draws a solution on an Axes and returns its artists.

Nothing here shows a window or touches matplotlib's global state: without an Axes a new figure is
made, which `save` writes to a file; in a notebook, run ``%matplotlib inline`` and end a cell with
``picture.ax.figure``.

>>> import rodimpact as ri
>>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
>>> picture = ri.plot.spacetime(ri.solve(ri.System([rod, ri.Wall()])))
>>> picture.ax.get_ylabel()
'time t (µs)'
"""

from .diagram import spacetime
from .families import sweep
from .histories import contact, gauge
from .law import restitution
from .ledger import energy
from .page import overview
from .saving import save
from .stages import snapshots

__all__ = [
    "contact", "energy", "gauge", "overview", "restitution", "save", "snapshots", "spacetime",
    "sweep",
]
