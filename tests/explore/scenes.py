"""Scenes of the page."""

import rodimpact as ri
from rodimpact.explorer.design import LIBRARY, tables_of, with_gauges
from rodimpact.explorer.exploring import page_solves
from rodimpact.explorer.scene import scene
from rodimpact.explorer.solved import scene_of


def shown(system, **solve):
    """The solution, and the scene as the page makes it, or as Python makes it for the page."""
    case, solution = with_gauges(ri.Case(system, solve)), ri.solve(system, **solve)
    sent = tables_of(case)
    if page_solves(sent["case"]):
        return solution, scene_of(sent["case"], sent["gauges"], LIBRARY)
    return solution, scene(case, solution)
