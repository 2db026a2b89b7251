"""The method "characteristics" for many collisions of one make, in compiled code.

The whole of a member, from its layout to its totals, is one call of a kernel, which takes many of
them on the same work space. What `solve` makes of a member is the same bit for bit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce
from typing import Any

import numpy as np

from .. import kernels
from ..family import STOPPED_BY, FamilyRun, Stopped, now, table
from ..groups import groups, movable, velocities_in_group
from ..memory import ask, most_numbers
from ..row import Row, whole
from .layout import Work, is_even, make_of, memory_of, numbers_of, space
from .level_kernel import ROOM, Make
from .machine import averages_before, no_results
from .method import RTOL, longest_step, most_parts
from .method import STOPPED_BY as REASONS
from .search_kernel import MEMBERS, Results, work_on
from .step_kernel import DONE

PATIENCE = 0.1  # s; about how long a call runs before `stop` is asked again
MOST_MEMBERS = 4096  # of one call of `run_family`
MEMBER_TIME = 0.02  # s; a guess of what plain Python takes for a member


def together(row: Row) -> int:
    """How many members to run in one call; 0 where each is to be run alone."""
    return MOST_MEMBERS if is_even(row) else 0


def solve_family(
    row: Row, until: float | None, max_events: int, dt: float | None, rtol: float | None,
    stop: Callable[[], bool] = lambda: False, more: int = 0,
) -> FamilyRun:
    """Totals of every member; arguments as of `run_family`."""
    system, count = row.system, math.prod(row.system.shape)
    run = run_family(row, until, most_parts(row, max_events), dt, rtol or RTOL, stop, more)
    refused = run.flag != DONE
    unknown, final = np.where(refused, math.nan, 0.0), run.final > 0
    before: list[Any] = []
    after: list[Any] = []
    free = movable(system)
    for g, group in enumerate(groups(system)):
        inside = [i for i in group if i in free]
        for found, velocity in ((before, run.before), (after, run.after)):
            shared = velocity[:, g].reshape(system.shape)
            found += [unknown + np.broadcast_to(v, system.shape).ravel()
                      for v in velocities_in_group(system, group, inside, shared)]
    contacts = {}
    for name, values in (("impulse", run.impulse), ("peak_force", run.peak),
                         ("duration", run.pressed)):
        contacts[name] = _by_contact(row, unknown[:, None] + values, math.nan)
    contacts["episodes"] = _by_contact(row, run.episodes, 0)
    places = np.array([STOPPED_BY.index(name) for name in REASONS])[run.reason]
    places[final & (until is None)] = STOPPED_BY.index("final")
    places[refused] = STOPPED_BY.index("refused")
    vibration = unknown + reduce(np.add, run.vibration.T, np.zeros(count))
    return FamilyRun(before, after, vibration, contacts, final & ~refused, places)


def _by_contact(row: Row, values: Any, missing: float) -> list[Any]:
    """Columns of what contacts that can open have, by contact."""
    able = list(row.opening)
    none = np.full(len(values), missing)
    return [values[:, able.index(k)] if k in able else none for k in range(len(row.contact_link))]


def run_family(
    row: Row, until: float | None, most_parts: int, dt: float | None, rtol: float,
    stop: Callable[[], bool] = lambda: False, more: int = 0,
) -> Results:
    """Solve every member of a family whose rows are even.

    Parameters
    ----------
    row : Row
        Of a family.
    until : float or None
        s.
    most_parts : int
        Cap on steps where no end is given.
    dt : float or None
        Step, s; chosen if not given.
    rtol : float
    stop : callable
        Asked now and then whether to give up.
    more : int
        Members that other calls will run in this process.

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
    shape, make = row.system.shape, make_of(row)
    given = table([x for column in numbers_of(row) for x in column], shape)
    count = len(given)
    beyond = np.zeros(count, dtype=bool)
    for bad, _, _ in row.beyond_scales():
        beyond |= np.broadcast_to(bad, shape).ravel()
    if dt is not None:
        beyond |= np.broadcast_to(dt > longest_step(row), shape).ravel()
    groups, bodies, contacts = len(make.held), len(make.body_first), len(make.opening)
    wide = [groups] * 2 + [bodies] + [contacts] * 4
    results = no_results(count, *wide)
    room, member, size, plain, fast = (0, 0), 0, 1, MEMBER_TIME, False
    work: Any = None
    while member < count:
        if stop():
            raise Stopped
        last = min(member + size, count)
        if not fast:
            ahead = plain * (count - last + more)
            fast = kernels.worth_compiling(plain * (last - member), work_on, ahead=ahead)
            work = None if fast else work
        if work is None:
            work = _work(row, make, fast, *room)
            work.limit.until[0], work.limit.steps[0] = -1.0 if until is None else until, most_parts
            work.search.goal[0] = rtol
        begun = now()
        part = Results(*(x[member:last].reshape(-1) for x in results))
        rows, beyond_part = given[member:last].reshape(-1), beyond[member:last]
        solve: Any
        if fast:
            solve = kernels.compiled(work_on)
            reached = solve(*work, rows, beyond_part, dt or 0.0, part, MEMBERS)
        else:
            lists = kernels.as_lists(part)
            solve = work_on
            reached = solve(*work, rows.tolist(), beyond_part.tolist(), dt or 0.0, lists, MEMBERS)
            kernels.copy_back(lists, part)
        if reached < last - member:
            room, work = (int(work.level.at[ROOM]) + 1, averages_before(work.level)), None
        seconds = now() - begun
        if not fast and reached:
            plain = seconds / reached
        member += reached
        size = 2 * size if seconds < PATIENCE / 4 else max(1, size // 2)
    return results


def _work(row: Row, make: Make, fast: bool, room: int, before: int) -> Work:
    """Work space with room for so many parts, and averages from before t = 0."""
    of_part, of_average = memory_of(row, not fast)
    numbers = room * of_part + before * of_average
    ask(numbers, "until", "a member of the family", "stop earlier (until)")
    work = space(Make(*map(whole, make)), np.full, room, before) if fast else space(
        make, lambda size, zero: [zero] * size, room, before)
    work.limit.numbers[:] = [most_numbers(), of_part, of_average]
    return work
