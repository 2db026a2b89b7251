"""The method "finite-difference": rods on a staggered grid.

It carries everything that the other methods carry, and also damping, tapers and lateral
inertia. It stores states and rebuilds nothing from signals at the ends.

In the segment with the longest transit waves cross nearly one cell in a step (Courant
number 0.999). Every other segment gets as many cells as its transit time has whole
steps, so its Courant number is slightly lower: one cell more would be unstable, one
cell less would disperse waves more than necessary. At a Courant number of exactly 1
leapfrog has no error, but the even and the odd nodes are not coupled: a contact that
acts between two steps drives them apart for good, and velocities never converge.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ...model.frozen import InvalidModel
from ...progress import ProgressReport, no_report
from .. import abilities as physics
from ..row import Array, Row
from ..run import PEAK_FORCE, Run
from ..scales import check_scales
from . import refinement
from .mesh import Mesh, check_polar_moments, crossing_time, most_cells, stable_step
from .proof import finality_time
from .run import GridRun
from .signals import make_run
from .smoothness import order_of
from .soil import soil_stiffnesses

RTOL = 1e-3
"""Relative accuracy to which the mesh is refined if `rtol` is not given."""
COURANT = 0.999
"""Courant number if the step is not given."""
STABLE_COURANT = 1 + 2.0**-30
"""Largest Courant number of a mesh: 1 plus some round-off."""
MIN_LONGEST_CELLS = 100
"""Fewest cells of the segment with the longest transit, if no mesh is given."""
MIN_CELLS = 8
"""Fewest cells of a segment, if no mesh is given, and fewest steps of a short run."""
MAX_REFINED_CELLS = 1 << 13
"""Most cells of the segment with the longest transit in a refined mesh."""
MAX_CELLS = 1 << 20
"""Most cells of a row."""
EQUAL_WASTE = 2.0**-20
"""Courant numbers that differ by less are equally good."""
UNTIL_RTOL = 1e-12
"""Relative excess of `until` over whole steps that counts as round-off."""

LACKS = (physics.RODLESS, physics.OWN_LAWS)
"""Kinds of rows that this method does not solve, see `abilities`."""


@np.errstate(under="ignore")  # ahead of the waves all numbers are nearly 0
def solve(row: Row, until: float | None, max_events: int, **options: Any) -> Run:
    """Run a single collision; the arguments are those of `run_grid`."""
    return make_run(run_grid(row, until, max_events, **options), until)


def run_grid(
    row: Row,
    until: float | None,
    max_events: int,
    *,
    cells: int | None = None,
    dt: float | None = None,
    rtol: float | None = None,
    snapshots: int | tuple[float, ...] | None = None,
    report: ProgressReport = no_report,
) -> GridRun:
    """Run a single collision on a mesh that is fine enough.

    Return the run on the finest mesh. Unless `cells` or `dt` is given, the step is
    divided until velocities and impulses are accurate to `rtol`. The errors of the peak
    force and of the duration are stated, but the mesh is not refined for them: beside a
    jump waves overshoot on any mesh; flat ends of viscous rods, or of rods with lateral
    inertia, meet with a force that has no largest value; and weak forces begin and end
    late. If `until` is less than half a step, no step is taken.

    Parameters
    ----------
    row : Row
        Row of a single system.
    until : float, optional
        End of the run, s; by default a round trip of the longest rod after the proof of
        finality.
    max_events : int
        Largest number of steps times links (contacts, joints, bonds and both ends); it
        is used only if `until` is not given.
    cells : int, optional
        Number of cells of the segment with the longest transit.
    dt : float, optional
        Step, s; it is made smaller if `until` is not a multiple of it.
    rtol : float, optional
        Relative accuracy to which the mesh is refined, if neither `cells` nor `dt` is
        given; by default `RTOL`.
    snapshots : int or tuple of float, optional
        Largest number of states to keep, or the times at which to keep them, s.
    report : function
        It is called with the steps done on a mesh and the number of all steps, which is
        None without `until`.

    Raises
    ------
    InvalidModel
        If numbers of the row are too large or too small, or the mesh would be unstable.
    TooLong
        If the run takes too much memory.
    """
    check_scales(row)
    check_polar_moments(row)
    counts, step = mesh_size(row, cells, dt, until)  # or InvalidModel
    takes_steps = until is None or 2 * until > step  # more than half a step
    if until is not None and takes_steps:
        # Shorten the step so that `until` is a whole number of steps. UNTIL_RTOL keeps
        # round-off from adding one.
        steps = math.ceil(until / step * (1 - UNTIL_RTOL))
        step = until / steps

    def run_level(factor: int) -> GridRun:
        """Run on a mesh with the step divided by a factor."""
        mesh = Mesh(row, [factor * count for count in counts])
        h = step / factor
        if until is None:
            # Each step counts as one event of each link; a link stands between two
            # neighbours in the row, and at each of its ends. One step is always taken.
            last_step = max(1, max_events // len(row.links))
            run = GridRun(mesh, h, snapshots)
            _run_to_proof(run, last_step, report)
        else:
            last_step = round(until / h)  # 0 if `until` is less than half a step
            expected_steps = max(1, last_step)  # 0 would stand for an unknown number
            run = GridRun(mesh, h, snapshots, expected_steps)
            _run_to_end(run, last_step, report)
        return run

    if cells is None and dt is None and takes_steps:  # the mesh is refined
        goal = RTOL
        if rtol is not None:
            goal = rtol
        # No segment gets more than MAX_REFINED_CELLS cells.
        max_factor = MAX_REFINED_CELLS // max(counts)
        run = _run_refined(run_level, order_of(row), goal, max_factor)
    else:
        run = run_level(factor=1)
    if run.stopped_by == "final":  # the run ends a round trip after the proof
        run.advance(run.steps + run.round_trip)
    return run


def _run_refined(
    run_level: Callable[[int], GridRun], order: float, goal: float, max_factor: int
) -> GridRun:
    """Run on finer and finer meshes; return the finest run, which states its errors.

    Its `rtol` becomes `goal`. Its `estimates` and `coarser`, the coarser runs with
    which its fields are compared, are set. The estimate of the peak force includes
    `peak_error`, which no finer mesh reduces. The refinement ends when `goal` or
    `max_factor` is reached, or when memory is short.

    Parameters
    ----------
    run_level : function
        Run with the step divided by a factor.
    order : float
        Power of the step with which errors fall at least.
    goal : float
        Relative error up to which the mesh is refined.
    max_factor : int
        Largest factor.
    """
    runs: list[GridRun] = []  # all runs, in the order of the levels

    def run_and_keep(factor: int) -> GridRun:
        """Run with the step divided by a factor, and append the run to `runs`."""
        run = run_level(factor)
        runs.append(run)
        return run

    run, estimates = refinement.refined(
        run_and_keep, refinement.measures_of, order, goal, max_factor
    )
    run.rtol = goal
    run.estimates = estimates
    run.coarser = refinement.comparable_runs(runs, run, order)
    if PEAK_FORCE in estimates:
        estimates[PEAK_FORCE] += run.peak_error
    return run


# Running ------------------------------------------------------------------------------


def _run_to_end(run: GridRun, last_step: int, report: ProgressReport) -> None:
    """Run to step `last_step`, and try the proof of finality on the way.

    When the proof succeeds, `run.proved` becomes the number of steps taken, and the
    proof is not tried again. `report` is called with the steps taken and `last_step`.
    """

    def report_of(taken: int) -> None:
        """Report the steps taken of all steps."""
        report(taken, last_step)

    _advance_until_proved(run, last_step, report_of)
    run.advance(last_step, report_of)  # the steps after the proof


def _run_to_proof(run: GridRun, last_step: int, report: ProgressReport) -> None:
    """Run until the proof of finality succeeds, at most to step `last_step`.

    `run.proved` is set if it succeeds; `run.stopped_by` becomes "final" or, without a
    proof, "max_events". `report` is called with the steps taken and None.
    """

    def report_of(taken: int) -> None:
        """Report the steps taken."""
        report(taken, None)  # nobody knows when a proof will succeed

    _advance_until_proved(run, last_step, report_of)
    run.stopped_by = "max_events"  # steps count as events
    if run.proved >= 0:
        run.stopped_by = "final"


def _advance_until_proved(
    run: GridRun, last_step: int, report_of: Callable[[int], None]
) -> None:
    """Run until the proof of finality succeeds, at most to step `last_step`.

    The proof is tried before the first step, then at intervals, and finally at step
    `last_step`. If it succeeds, `run.proved` becomes the number of steps taken, else it
    stays -1. `report_of` is called with the steps taken.
    """
    transit = run.round_trip // 2  # steps in which waves cross the longest rod
    report_of(0)  # no step is taken yet
    while run.proved < 0:
        # Steps after which a proof can succeed: 0 if it succeeds now
        wait = finality_time(run) / run.step
        if wait == 0:
            run.proved = run.steps
        elif run.steps < last_step:
            # Try again after `wait`, but earlier if `wait` is long: after steps that
            # take about as long as a proof.
            affordable = max(transit // 4, run.steps // 8)
            until_next = min(wait, affordable)  # `wait` may be infinite
            more = math.ceil(max(until_next, MIN_CELLS))  # a few steps at least
            run.advance(min(last_step, run.steps + more), report_of)
        else:
            break


# The mesh -----------------------------------------------------------------------------


def mesh_size(
    row: Row, cells: int | None, dt: float | None, until: float | None
) -> tuple[list[int], float]:
    """Numbers of cells, [segment], and a step, s, that is stable for them.

    The step is `dt` if it is given, else `COURANT` times the longest stable step. The
    segment with the longest transit has `cells` cells; if neither `cells` nor `dt` is
    given, it has the number of `_least_wasteful`. All other segments have as many cells
    as are stable. If only `dt` is given, this holds for all segments; if both are
    given, `cells` sets the numbers, and `dt` is only tested. `cells`, `dt` and `until`
    are those of `run_grid`.

    Raises
    ------
    InvalidModel
        If `dt` is unstable, if a segment would have no cell, or if there would be too
        many cells.
    """
    transits = np.array([crossing_time(segment) for segment in row.segments])
    shortest = int(np.argmin(transits))
    # An error names the argument that was given, else the shortest segment. Path 0 is
    # empty: segments count from 1.
    if cells is not None:
        name = "cells"
    elif dt is not None:
        name = "dt"
    else:
        name = row.paths[shortest + 1]
    # Number of cells of the segment with the longest transit; None if it follows from
    # `dt`
    longest_cells = cells
    if cells is None and dt is None:
        longest_cells = _least_wasteful(transits, until)
    # `dt` counts here only if `longest_cells` is None.
    counts = _stable_counts(row, transits, longest_cells, dt, name)
    # Longest stable step of each segment, s
    stable_steps = list(map(stable_step, row.segments, counts, soil_stiffnesses(row)))
    if dt is None:
        step = min(stable_steps) * COURANT
    else:
        step = dt
    worst = int(np.argmin(stable_steps))
    # Only a given `dt` can be too long: a step that is chosen here has the margin
    # COURANT. STABLE_COURANT, which is barely above 1, allows for round-off.
    if step > STABLE_COURANT * stable_steps[worst]:
        message = (
            f"would be unstable in {row.paths[worst + 1]}, where {counts[worst]:g} "
            f"cells allow {stable_steps[worst]:.6g} s, got {dt!r}; take a smaller dt "
            "or fewer cells"
        )
        raise InvalidModel([("dt", message)])
    return counts, step


def _least_wasteful(transits: Array, until: float | None) -> int:
    """Number of cells of the longest transit with Courant numbers nearest to 1.

    The waste of a segment is 1 minus its Courant number, which is below 1 because its
    number of cells is whole. A candidate is as good as its largest waste among all
    segments. Candidates range from the least number that is needed up to twice that
    number; the smallest of the best ones, to `EQUAL_WASTE`, is returned. Needed are
    `MIN_LONGEST_CELLS`, `MIN_CELLS` in the shortest segment, and `MIN_CELLS` steps in a
    short run. `transits` [segment] are in s; `until` is the end of the run, s, or None.
    """
    longest = float(transits.max())
    for_shortest = math.ceil(MIN_CELLS * longest / transits.min())
    least = max(MIN_LONGEST_CELLS, for_shortest)
    if until:  # neither None nor 0
        # A step is about the longest transit over its number of cells. A quarter leaves
        # room for refinements by 2, 3 and 4.
        for_short_run = min(MAX_REFINED_CELLS / 4, MIN_CELLS * longest / until)
        least = max(least, math.ceil(for_short_run))
    # The arrays [candidate, segment] have about MAX_CELLS entries at most.
    candidates = min(least, 1 + MAX_CELLS // len(transits))
    # Floats, as `least` may be too large for integers of NumPy
    numbers = float(least) + np.arange(candidates)
    # Steps in which waves cross each segment [candidate, segment]. A segment has the
    # whole part of them as cells; STABLE_COURANT keeps round-off from costing one.
    steps = numbers[:, None] * (transits / longest)
    courant = np.floor(steps * STABLE_COURANT) / steps
    waste = (1 - courant).max(axis=1)  # [candidate]
    is_best = waste <= waste.min() + EQUAL_WASTE
    first_best = int(np.argmax(is_best))
    return int(numbers[first_best])


def _stable_counts(
    row: Row, transits: Array, cells: int | None, dt: float | None, name: str
) -> list[int]:
    """Number of cells of each segment, [segment]: as many as are stable with a step.

    If `cells` is given, the segment with the longest transit has so many cells, and the
    step is the time in which waves cross one of them; else the step is `dt`. With
    Mindlin and Herrmann's model `cells` may need a shorter step. Waves cross the
    segments in `transits`, s [segment]. `name` is the argument or segment that an error
    names.

    Raises
    ------
    InvalidModel
        If a segment would have no cell, or all together too many.
    """
    longest = int(np.argmax(transits))
    step: Any = dt  # s
    if cells is not None:
        step = float(transits[longest]) / cells
    # As many cells as the transit time has whole steps; STABLE_COURANT keeps round-off
    # from costing one.
    counts = np.floor(transits / step * STABLE_COURANT)
    if cells is not None:
        counts[longest] = cells  # exactly, whatever the rounding of the quotient
    _check_counts(row, transits, counts, cells, name)
    whole: list[int] = counts.astype(int).tolist()
    if cells is not None:
        return whole  # `mesh_size` chooses a step that is stable for so many cells
    # With Mindlin and Herrmann's model the longest stable step is not the transit time
    # of a cell: fewer cells than these may be stable with `dt`.
    most = []
    for segment, count in zip(row.segments, whole, strict=True):
        # Courant numbers up to STABLE_COURANT count as stable.
        most.append(most_cells(segment, count, step / STABLE_COURANT))
    return most


def _check_counts(
    row: Row, transits: Array, counts: Array, cells: int | None, name: str
) -> None:
    """Raise InvalidModel if a segment has no cell, or all together have too many.

    `counts` are the numbers of cells, [segment]; more than `MAX_CELLS` in total are too
    many. The other arguments are those of `_stable_counts`; the errors name `name`.
    """
    longest = int(np.argmax(transits))
    shortest = int(np.argmin(transits))
    path = row.paths[shortest + 1]
    shortest_time = f"{transits[shortest]:.6g} s"
    if counts.min() < 1:
        if cells is not None:
            # So many cells of the longest segment leave one for the shortest.
            ratio = transits[longest] / transits[shortest]
            remedy = f"{math.ceil(ratio / STABLE_COURANT)} or more"
        else:  # `dt` is given
            remedy = f"{shortest_time} or less"
        message = (
            f"must be {remedy} for a cell in {path}, which waves cross in "
            f"{shortest_time}"
        )
        raise InvalidModel([(name, message)])
    if counts.sum() > MAX_CELLS:
        message = f"asks for {counts.sum():.10g} cells, of {MAX_CELLS} at most"
        is_default = name == path  # neither `cells` nor `dt` is given
        if is_default:
            message = (
                f"its transit time, {transits[shortest]:.3g} s, {message}; "
                "leave this segment out"
            )
        raise InvalidModel([(name, message)])
