"""Scenes of the page."""

import rodimpact as ri
from rodimpact.explorer.design import LIBRARY, tables_of, with_gauges
from rodimpact.explorer.solved import scene_of


def shown(system, **solve):
    """The solution, and the scene as the page makes it."""
    sent = tables_of(with_gauges(ri.Case(system, solve)))
    scene = scene_of(sent["case"], sent["gauges"], LIBRARY)
    return ri.solve(system, **solve), scene
