"""The search for the best parameters: points of a coarse sweep, and least squares."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..model.quantities import Floats
from .objective import Objective
from .parameters import RecordParameter

POINTS_PER_PARAMETER = 16
"""Systems of the coarse sweep for each number of the system that varies."""
MAX_EVALUATIONS = 200
"""Cap on the evaluations of a least-squares search, without those for derivatives."""
SEARCH_FTOL = 1e-10
"""Relative fall of the cost at which a search ends."""
COARSE_FTOL = 1e-4
"""SEARCH_FTOL on a coarse grid; a search on the fine grid goes on from its end."""
FINE_FTOL = 1e-7
"""SEARCH_FTOL on the fine grid: no number changes by a tenth of its standard error."""
DIFFERENCE_STEP = 1e-5
"""Step of the differences for derivatives, relative to the size of a number."""


def coarse_shares(initial: Sequence[float]) -> list[Floats]:
    """Points that fill the space between the bounds evenly, as shares of n numbers.

    There are `POINTS_PER_PARAMETER` n points. The first is `initial`, that of the
    system. The others are the R-sequence: point k is 0.5 + k (1/x, 1/x^2, ..., 1/x^n)
    modulo 1, with x^(n+1) = x + 1. Each new point lies far from all before it.
    """
    n = len(initial)
    root = 2.0
    for _ in range(64):  # the iteration converges to x for every n
        root = (1 + root) ** (1 / (n + 1))
    steps = root ** -np.arange(1.0, n + 1)
    shares = [np.array(initial)]
    for k in range(1, POINTS_PER_PARAMETER * n):
        shares.append((0.5 + k * steps) % 1)
    return shares


def sizes_of_numbers(objective: Objective, point: Floats) -> Floats:
    """Typical size of each number of a point.

    Numbers of the system are shares of the way between their bounds, of size 1. Gains
    have their own size; shifts and blurs have the duration of the longest record, s;
    offsets and trends have the level of their record, trends over this duration. If
    several records share a number, the level is that of the first.
    """
    longest = 0.0
    for record in objective.measured:
        longest = max(longest, record.signal.end - record.signal.start)
    sizes = np.ones(len(point))
    for i, number in enumerate(objective.numbers):
        if not isinstance(number, RecordParameter):
            continue
        record = objective.measured[number.records[0]]
        level = record.size
        if number.kind == "gain":
            sizes[i] = abs(point[i])
        elif number.kind == "offset":
            sizes[i] = level
        elif number.kind == "trend":
            sizes[i] = level / longest
        else:
            sizes[i] = longest
    return sizes


class Grids(NamedTuple):
    """Objectives of one fit; they are the same without a grid that can be coarser."""

    fine: Objective
    coarse: Objective  # half the cells: a collision takes a quarter of the time


def search_on(grids: Grids, start: Floats, sizes: Floats) -> Any:
    """Least-squares search on the coarse grid, then from its end on the fine one.

    If both grids are one, there is one search. Blurs are set free in the first search,
    see `search_from`. The result is SciPy's OptimizeResult of the last search, whose
    `x` is a point.
    """
    if grids.coarse is grids.fine:
        return search_from(grids.fine, start, sizes, SEARCH_FTOL)
    coarse_end = search_from(grids.coarse, start, sizes, COARSE_FTOL)
    return _descend(grids.fine, coarse_end.x, grids.fine.is_free, sizes, FINE_FTOL)


def search_from(objective: Objective, start: Floats, sizes: Floats, ftol: float) -> Any:
    """Least-squares search from a start, first with fixed blurs, then with all free.

    Without a free blur there is only one search. Predictions depend on the square of a
    blur, so a search from blur 0 would stay there: the second search begins with blurs
    in the middle of their bounds. If it ends at a higher cost than the first, a third
    search, with all free, begins at the end of the first. The result is the
    OptimizeResult of the last search, see `_descend`.
    """
    is_free = objective.is_free
    is_free_blur = is_free & objective.is_blur
    if not is_free_blur.any():
        return _descend(objective, start, is_free, sizes, ftol)
    sharp = _descend(objective, start, is_free & ~is_free_blur, sizes, ftol)
    blurred_start = np.where(is_free_blur, objective.middle, sharp.x)
    blurred = _descend(objective, blurred_start, is_free, sizes, ftol)
    if blurred.cost > sharp.cost:
        blurred = _descend(objective, sharp.x, is_free, sizes, ftol)
    return blurred


def _descend(
    objective: Objective, start: Floats, is_free: Any, sizes: Floats, ftol: float
) -> Any:
    """Least-squares search from a point; `x` of the result is the point where it ends.

    The variables are the free numbers over their sizes, plus 1: SciPy's differences
    take steps relative to a variable, and so the variables must not be 0. The other
    numbers stay as in the start, which is moved within the bounds.

    Parameters
    ----------
    objective : Objective
    start : [number] array
    is_free : [number] array of bool
        Whether a number varies.
    sizes : [number] array
    ftol : float
        The search ends where the cost falls by less than this fraction of itself.

    Returns
    -------
    scipy.optimize.OptimizeResult
        `jac` has the derivatives with respect to the variables.
    """
    from scipy.optimize import least_squares

    low = objective.low[is_free] / sizes[is_free] + 1.0
    high = objective.high[is_free] / sizes[is_free] + 1.0

    def point_of(variables: Floats) -> Floats:
        """Point with these variables."""
        point = start.copy()
        point[is_free] = (variables - 1.0) * sizes[is_free]
        return point

    def residuals(variables: Floats) -> Floats:
        """Residuals at the point with these variables."""
        return objective.residuals(point_of(variables))

    first_variables = np.clip(start[is_free] / sizes[is_free] + 1.0, low, high)
    end = least_squares(
        residuals,
        first_variables,
        bounds=(low, high),
        diff_step=DIFFERENCE_STEP,
        x_scale="jac",
        ftol=ftol,
        xtol=1e-8,
        gtol=1e-10,
        max_nfev=MAX_EVALUATIONS,
    )
    end.x = point_of(end.x)
    return end
