"""Runs as methods make them, below what users see."""

from __future__ import annotations

import numpy as np

from rodimpact.methods.fronts import method as fronts
from rodimpact.methods.fronts.assembly import assemble
from rodimpact.methods.fronts.tracking import FrontRun
from rodimpact.methods.grid import method as grid
from rodimpact.methods.grid.run import GridRun
from rodimpact.methods.row import Row
from rodimpact.results.solution import Solution

METHODS = {FrontRun: fronts, GridRun: grid}


def assembled(system, until=None):
    return assemble(Row(system), until)


def solution_of(run, until=None):
    return Solution(METHODS[type(run)].hand_over(run, until))


def gaps_of(solution, contact):
    """Gap of a contact at the ends of all steps, m."""
    edges = solution.run.signals.edges * solution.fields.clock.tick
    return solution.contacts[contact].gap(np.minimum(edges, solution.t_end))
