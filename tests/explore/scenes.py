"""Scenes of the page."""

import rodimpact as ri
from rodimpact.explorer.design import LIBRARY, tables_of, with_gauges
from rodimpact.explorer.solved import scene_of
from rodimpact.methods.pieces.method import RTOL


def shown(system, tolerance=RTOL, **solve):
    """The solution of a system, and the scene, a dict, as the page makes it."""
    case = with_gauges(ri.Case(system, solve))
    design = tables_of(case)
    scene = scene_of(design["case"], design["gauges"], LIBRARY, tolerance)
    return ri.solve(system, **solve), scene
