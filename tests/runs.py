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
"""What makes the `Run` of a solution, by the class of a method's own run."""


def tracked(system, until=None, max_events=MAX_EVENTS):
    """The method's own run by fronts, a `FrontRun`, to `until`, s."""
    return fronts.run_fronts(build_row(system), until, max_events)


def solution_of(run, until=None):
    """The solution that a run by fronts (`FrontRun`) or on a grid (`GridRun`) makes."""
    make_run = MAKERS[type(run)]
    return Solution(make_run(run, until), Options(until))


def bits_of(system, until, compiling, max_events=4000):
    """All that a run by fronts leaves, bit for bit: a list of bytes.

    The kernels are compiled if `compiling`, and else interpreted by Python.
    """
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
    """Record of the bonded group on the right of a contact if `right`, else on its
    left, with its mean motion and the bounds of its end by the proof.

    Both are found now, at the present time of the run.
    """
    node = run.layout.contacts[contact]
    records = records_of(run)
    finality.find_mean_motions(records, node, run.run.now)
    finality.set_deviations(records, node, run.run.now)
    return run.segments[node + right]


def step_ends(solution):
    """Ends of all steps of a run on a grid, s, from t = 0 on [step + 1].

    The last step may go a little beyond the end of the run, where it is cut.
    """
    ends = solution.run.signals.edges * solution.fields.clock.tick
    return np.minimum(ends, solution.t_end)


def gaps_of(solution, contact):
    """Gap of a contact at the ends of all steps, m [step + 1]."""
    return solution.contacts[contact].gap(step_ends(solution))
