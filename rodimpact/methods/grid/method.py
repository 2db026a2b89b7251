"""The method "finite-difference": rods on a staggered grid, for physics that breaks d'Alembert.

It carries everything the other methods carry, and damping, tapers and lateral inertia; it stores
states and rebuilds nothing from signals at the ends. Waves cross all but a cell in a step (Courant
number 0.999) in the segment with the longest transit; every other segment gets as many cells as its
transit has whole steps of this, so that it runs just below: one cell more would be unstable, one
less disperses waves more than it must. At 1 exactly leapfrog has no error, but the even and the odd
nodes do not know of each other: what a contact does between two steps makes them part for good, and
velocities never converge.
"""

import math
from typing import Any

import numpy as np

from ...model.frozen import InvalidModel
from ...progress import Report, no_report
from .. import abilities as physics
from ..row import Row
from ..run import PEAK_FORCE, Run
from ..scales import check_scales
from . import refinement
from .mesh import Mesh, check_polar_moments, crossing_time, most_cells, stable_step
from .proof import finality_time
from .run import GridRun
from .signals import hand_over
from .smoothness import order_of

RTOL = 1e-3
COURANT = 0.999
FIRST = 100  # fewest cells of the longest transit
FEWEST = (
    8  # cells of a segment, where nothing else is asked for, and steps of a short run
)
FINEST = 1 << 13  # most cells of the longest transit in the search for an accurate mesh
MOST_CELLS = 1 << 20
STABLE = (
    1 + 2.0**-30
)  # Courant number up to which a mesh is taken; beyond 1 by round-off only

LACKS = (physics.RODLESS, physics.OWN_LAWS)


@np.errstate(under="ignore")  # ahead of the waves all is next to nothing
def solve(row: Row, until: float | None, max_events: int, **options: Any) -> Run:
    """Run a single collision; arguments as of `follow`."""
    return hand_over(follow(row, until, max_events, **options), until)


def follow(
    row: Row,
    until: float | None,
    max_events: int,
    *,
    cells: int | None = None,
    dt: float | None = None,
    rtol: float | None = None,
    snapshots: int | tuple[float, ...] | None = None,
    report: Report = no_report,
) -> GridRun:
    """Run a single collision.

    The step is divided until velocities and impulses stand still. The errors of the peak force
    and of the duration are told and not waited for: beside a jump waves overshoot, on any mesh,
    flat ends of viscous rods, or of rods with lateral inertia, meet with a force that has no
    largest value, and faint forces begin and end late.

    Parameters
    ----------
    row : Row
        Of a single system.
    until : float, optional
        s; by default the run ends a round trip of the longest rod after the proof of finality.
    max_events : int
        Cap on steps times contacts and ends, where no end is given.
    cells : int, optional
        Of the segment with the longest transit.
    dt : float, optional
        Step, s; less where `until` is no multiple of it.
    rtol : float, optional
        Relative accuracy to which cells and step are halved, where neither is given.
    snapshots : int or tuple of float, optional
        How many states to keep at most, or the times at which to keep them, s.
    report : function
        Told how many steps are done on each mesh, and how many there are.

    Raises
    ------
    InvalidModel
        If the mesh would be unstable.
    TooLong
        If the run takes too much memory.
    """
    check_scales(row)
    check_polar_moments(row)
    counts, step = _mesh_size(row, cells, dt, until)
    stepping = until is None or 2 * until > step
    if until is not None and stepping:
        step = until / math.ceil(until / step * (1 - 1e-12))

    searching = cells is None and dt is None and stepping
    order = order_of(row)
    runs: list[GridRun] = []

    def level(factor: int) -> GridRun:
        mesh, h = Mesh(row, [factor * N for N in counts]), step / factor
        last = (
            max(1, max_events // len(row.links)) if until is None else round(until / h)
        )
        run = GridRun(mesh, h, snapshots, None if until is None else max(1, last))
        _go(run, last, until is not None, report)
        runs.append(run)
        return run

    if searching:
        goal = RTOL if rtol is None else rtol
        run, estimates = refinement.refined(
            level,
            refinement.measures_of,
            order,
            goal,
            FINEST // max(counts),
        )
        run.rtol, run.estimates = goal, estimates
        run.coarser = refinement.comparable_runs(runs, run, order)
        if PEAK_FORCE in estimates:
            estimates[PEAK_FORCE] += run.peak_error
    else:
        run = level(1)
    if run.stopped_by == "final":
        run.advance(run.steps + run.round_trip)
    return run


def _mesh_size(
    row: Row, cells: int | None, dt: float | None, until: float | None
) -> tuple[list[int], float]:
    """Cells of each segment, and the step, s, that is stable for them."""
    T = np.array([crossing_time(s) for s in row.segments])
    longest, shortest = int(np.argmax(T)), int(np.argmin(T))
    given = "cells" if cells is not None else "dt" if dt is not None else ""
    if not given:
        least = max(FIRST, math.ceil(FEWEST * T[longest] / T[shortest]))
        if until:
            least = max(
                least, math.ceil(min(FINEST / 4, FEWEST * float(T[longest]) / until))
            )
        # of the numbers up to twice as many, the first for which all segments run nearest to 1
        numbers = float(least) + np.arange(min(least, 1 + MOST_CELLS // len(T)))
        steps = numbers[:, None] * (T / T[longest])
        waste = (1 - np.floor(steps * STABLE) / steps).max(axis=1)
        cells = int(numbers[int(np.argmax(waste <= waste.min() + 2.0**-20))])
    base: Any = dt if cells is None else float(T[longest]) / cells
    counts = np.floor(T / base * STABLE)
    if cells is not None:
        counts[longest] = cells
    name, path = given or row.paths[shortest + 1], row.paths[shortest + 1]
    if counts.min() < 1:
        bound = (
            f"{T[shortest]:.6g} s or less"
            if cells is None
            else f"{math.ceil(T[longest] / T[shortest] / STABLE)} or more"
        )
        message = f"must be {bound} for a cell in {path}, which waves cross in {T[shortest]:.6g} s"
        raise InvalidModel([(name, message)])
    if counts.sum() > MOST_CELLS:
        message = f"asks for {counts.sum():.10g} cells, of {MOST_CELLS} at most"
        if not given:
            message = f"its transit time, {T[shortest]:.3g} s, {message}; leave this segment out"
        raise InvalidModel([(name, message)])
    whole = counts.astype(int).tolist()
    if cells is None:  # the most for which it is stable
        whole = [
            most_cells(s, N, base / STABLE)
            for s, N in zip(row.segments, whole, strict=True)
        ]
    stable = list(map(stable_step, row.segments, whole))
    step = min(stable) * COURANT if dt is None else dt
    worst = int(np.argmin(stable))
    if step > STABLE * stable[worst]:
        message = (
            f"would be unstable in {row.paths[worst + 1]}, where {whole[worst]:g} cells "
            f"allow {stable[worst]:.6g} s, got {dt!r}; take a smaller dt or fewer cells"
        )
        raise InvalidModel([("dt", message)])
    return whole, step


def _go(run: GridRun, last: int, on: bool, report: Report) -> None:
    """Run to the proof, but not beyond the last step; `on` to that in any case."""
    longest = run.round_trip // 2
    total = last if on else None  # nobody knows when a proof will succeed

    def tell(taken: int) -> None:
        report(taken, total)

    tell(0)
    while run.proved < 0:
        wait = finality_time(run) / run.step
        if wait == 0:
            run.proved = run.steps
        elif run.steps < last:
            more = math.ceil(max(min(wait, max(longest // 4, run.steps // 8)), FEWEST))
            run.advance(min(last, run.steps + more), tell)
        else:
            break
    if on:
        run.advance(last, tell)
    else:
        run.stopped_by = "final" if run.proved >= 0 else "max_events"
