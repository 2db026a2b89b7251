"""The method "characteristics" for many collisions of one make, in compiled code.

The whole of a member, from its layout to its totals, is one call of a kernel, which takes many of
them on the same work space. What `solve` makes of a member is the same bit for bit.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import reduce

import numpy as np

from .. import kernels
from ..memory import most_numbers
from ..row import Row, whole
from .layout import make_of, memory_of, numbers_of, space
from .level_kernel import ROOM, Make
from .machine import averages_before
from .search_kernel import Results, solve_members

PATIENCE = 0.1  # s; about how long a call runs before `stop` is asked again


class Stopped(Exception):
    """A run was told to stop."""


def run_family(
    row: Row, shape: tuple[int, ...], until: float | None, most_parts: int, dt: float | None,
    rtol: float, stop: Callable[[], bool] = lambda: False,
) -> Results:
    """Solve every member of a family whose rows are even.

    Parameters
    ----------
    row : Row
    shape : tuple of int
        Of the family.
    until : float or None
        s.
    most_parts : int
        Cap on steps where no end is given.
    dt : float or None
        Step, s; chosen if not given.
    rtol : float
    stop : callable
        Asked now and then whether to give up.

    Returns
    -------
    Results
        Arrays [member, ...] in C order and SI units; `flag` is not DONE for a member that could not
        be solved.

    Raises
    ------
    Stopped
        If `stop` said so.
    """
    count, lists = math.prod(shape), make_of(row)
    make = Make(*map(whole, lists))
    columns = [x for column in numbers_of(row) for x in column]
    given = np.empty((count, len(columns)))
    for place, x in enumerate(columns):
        given[:, place] = np.broadcast_to(x, shape).ravel()
    beyond = np.zeros(count, dtype=bool)
    for bad, _, _ in row.beyond_scales():
        beyond |= np.broadcast_to(bad, shape).ravel()
    if dt is not None:
        shortest = reduce(np.minimum, [s.transit_time for s in row.segments])
        beyond |= np.broadcast_to(dt > shortest * (1 + 2.0**-36), shape).ravel()
    groups, bodies, contacts = len(make.held), len(make.body_first), len(make.opening)
    results = Results(
        *(np.zeros(count, dtype=np.int64) for _ in range(3)), *np.zeros((2, count * groups)),
        np.zeros(count * bodies), *np.zeros((3, count * contacts)),
        np.zeros(count * contacts, dtype=np.int64),
    )
    solve, work = kernels.compiled(solve_members), space(make, np.full, 0, 0)
    member, size = 0, 1
    while member < count:
        if stop():
            raise Stopped
        work.limit.until[0], work.limit.steps[0] = -1.0 if until is None else until, most_parts
        work.limit.numbers[:], work.search.goal[0] = [most_numbers(), *memory_of(row)], rtol
        last, begun = min(member + size, count), time.perf_counter()
        reached = solve(*work, given.ravel(), beyond, member, last, dt or 0.0, results)
        if reached < last:
            work = space(make, np.full, int(work.level.at[ROOM]) + 1, averages_before(work.level))
        quick = time.perf_counter() - begun < PATIENCE / 4
        member, size = reached, 2 * size if quick else max(1, size // 2)
    return Results(*(x.reshape(count, -1) if x.size != count else x for x in results))
