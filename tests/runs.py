"""Runs as methods make them, below what users see."""

import numpy as np

from rodimpact.methods import kernels
from rodimpact.methods.fronts import finality
from rodimpact.methods.fronts import method as fronts
from rodimpact.methods.fronts.run import FrontRun
from rodimpact.methods.grid import method as grid
from rodimpact.methods.grid.run import GridRun
from rodimpact.methods.record_lists import as_objects
from rodimpact.methods.registry import Options
from rodimpact.methods.row_builder import build_row
from rodimpact.methods.run import MAX_EVENTS
from rodimpact.results.solution import Solution

MAKERS = {FrontRun: fronts.make_run, GridRun: grid.make_run}


def tracked(system, until=None, max_events=MAX_EVENTS):
    """A run by fronts, before a `Run` is made of it."""
    return fronts.run_fronts(build_row(system), until, max_events)


def solution_of(run, until=None):
    """The solution that a run by fronts or on a grid makes."""
    return Solution(MAKERS[type(run)](run, until), Options(until))


def bits_of(system, until, compiling, max_events=4000):
    """All that a run by fronts leaves, bit for bit."""
    with kernels.forced(compiling):
        run = tracked(system, until, max_events)
    assert run.batch.is_compiled == compiling
    bits = [run.log.tobytes()]
    for name in ("runs", "segments", "nodes", "lines"):
        bits.append(run.batch.array(name).tobytes())
    return bits


def records_of(run):
    """State of a run by fronts with objects in place of arrays, as its proof takes
    it.
    """
    return run.batch.state._replace(
        runs=[run.run],
        segments=run.segments,
        nodes=run.nodes,
        lines=run.lines,
        log=as_objects(run.log),
    )


def group_of(run, contact, right):
    """Record of the bonded group on the right of a contact, or else on its left, with
    its mean motion and the bounds of its end by the proof.
    """
    k = run.layout.contacts[contact]
    for find in (finality.find_mean_motions, finality.bound_deviations):
        find(records_of(run), k, run.run.now)
    return run.segments[k + right]


def step_ends(solution):
    """Ends of all steps of a run on a grid, s, from t = 0 on [step + 1]."""
    ends = solution.run.signals.edges * solution.fields.clock.tick
    return np.minimum(ends, solution.t_end)


def gaps_of(solution, contact):
    """Gap of a contact at the ends of all steps, m [step + 1]."""
    return solution.contacts[contact].gap(step_ends(solution))
