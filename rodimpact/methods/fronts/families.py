"""The method "fronts" for many collisions of one make, laid out and run by kernels.

No Python object is made for a single collision. Members run in blocks that share a work space small
enough for the processor's cache; one whose log outgrows it is run again with more room, to the same
result. Blocks run in plain Python until their time says that compiling pays.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any

import numpy as np

from .. import kernels
from ..abilities import driven
from ..family import STOPPED_BY, FamilyRun, Stopped, now, table
from ..groups import body_velocities
from ..memory import ask
from ..row import Array, Row
from .assembly import Blueprint, work_space
from .front_kernel import CAP, CLOCK, FULL, OPEN, GroupState, Results, family
from .layout_kernel import LAID, Layout, Make, lay_out_all
from .reading_kernel import Reading, family_with_reading
from .tracking import as_arrays, on_arrays

ROOM = 256  # rows of the log at first
ROW_NUMBERS = 11  # that a row takes, on lists and then on arrays
ROW_TIME = 1e-6  # s; a guess of what plain Python takes for a row of the log
FIRST_BLOCK, LAST_BLOCK = 32, 2048  # members of a block
PATIENCE = 0.1  # s; about how long a block runs before `stop` is asked again
MOST_MEMBERS, MOST_BYTES = 16384, 1 << 24  # of one call of `run_family`, for memory's sake


def together(row: Row) -> int:
    """How many members to run in one call."""
    n, width, _ = Blueprint(row).make.size
    return int(max(1, min(MOST_MEMBERS, MOST_BYTES // (8 * (width + 6 * (n + 2))))))


def solve_family(
    row: Row, until: float | None, max_events: int, stop: Callable[[], bool] = lambda: False,
    more: int = 0, also: Sequence[str] = (),
) -> FamilyRun:
    """Totals of every member, and what is wanted of `ALSO`; arguments as of `run_family`."""
    plan, system, shape = Blueprint(row), row.system, row.system.shape
    reads = not {"displacement", "largest_stress"}.isdisjoint(also)
    run, *reading = run_family(plan, shape, until, max_events, stop, more, reads)
    first, nodes = [span[0] for span in row.spans], plan.make.node
    final = run.final & (not driven(system))
    unknown = np.where(run.flag == FULL, math.nan, 0.0)
    stocks = ([x.reshape(shape) for x in stock.T] for stock in (run.before, run.after))
    before, after = (
        [unknown + np.broadcast_to(v, shape).ravel() for v in velocities]
        for velocities in body_velocities(system, first, 0.0, *stocks)
    )
    contacts = {"episodes": [run.episodes[:, node] for node in nodes]}
    for name in ("impulse", "peak_force", "duration"):
        contacts[name] = [unknown + getattr(run, name)[:, node] for node in nodes]
    capped = (run.flag == CAP) & (~final | (until is not None))
    reasons = [capped, run.flag == CLOCK, run.flag == FULL, final & (until is None)]
    places = [STOPPED_BY.index(name) for name in ("max_events", "clock", "refused", "final")]
    return FamilyRun(
        before, after, unknown + run.vibration, contacts, final,
        np.select(reasons, places, STOPPED_BY.index("until")),
        _further(row, reading[0], unknown) if reading else {"dissipated": unknown},
    )


def _further(row: Row, reading: Reading, unknown: Array) -> dict[str, Array]:
    """Columns of what was read of the waves, and the energy lost in rigid contacts, which is none.

    Where bodies are walls, nothing is read: they move on.
    """
    columns, shape = {"dissipated": unknown}, row.system.shape
    time = reading.time
    for i, (body, (first, last)) in enumerate(zip(row.system.bodies, row.spans, strict=True)):
        if not last:
            speed: Any = np.broadcast_to(np.asarray(body.velocity), shape).ravel()
            columns[f"displacement.{i}"] = unknown + speed * time
            continue
        inside = range(first, last + 1)
        pieces = [row.segments[s - 1] for s in inside]
        masses = [np.broadcast_to(piece.mass, shape).ravel() for piece in pieces]
        paths = [m * reading.moved[:, s] for m, s in zip(masses, inside, strict=True)]
        columns[f"displacement.{i}"] = unknown + sum(paths) / sum(masses)
        stresses = [
            np.broadcast_to(piece.material.youngs_modulus / (2 * piece.wave_speed), shape).ravel()
            * reading.parted[:, s] for piece, s in zip(pieces, inside, strict=True)
        ]
        columns[f"largest_stress.{i}"] = unknown + reduce(np.maximum, stresses)
    return columns


def run_family(
    plan: Blueprint, shape: tuple[int, ...], until: float | None, max_events: int,
    stop: Callable[[], bool] = lambda: False, more: int = 0, reads: bool = False,
) -> list[Any]:
    """Run every member of a family to `until`, or to its proof of finality.

    Parameters
    ----------
    plan : Blueprint
    shape : tuple of int
        Of the family.
    until : float or None
        Time to be reached, s.
    max_events : int
        Cap for each member.
    stop : callable
        Asked now and then whether to give up.
    more : int
        Members that other calls will run in this process.
    reads : bool
        Whether to read the waves of each member, too.

    Returns
    -------
    [Results] or [Results, Reading]
        Arrays with one row a member, in C order and SI units; `flag` is FULL for a member for which
        there is no clock.

    Raises
    ------
    Stopped
        If `stop` said so.
    TooLong
        If a member takes too much memory.
    """
    given = table(plan.numbers, shape)
    n = plan.make.size[0]
    results: list[Any] = [space(len(given), n)]
    if reads:
        results.append(Reading(np.zeros(len(given)), *np.zeros((2, len(given), n + 2))))
    waiting, room = np.arange(len(given)), ROOM
    while len(waiting):
        what = f"following {room} fronts of a member"
        ask(ROW_NUMBERS * room, "max_events", what, "lower the cap, or stop earlier (until)")
        waiting = _run_blocks(plan, given, waiting, results, room, until, max_events, stop, more)
        room, more = 8 * room, 0
    return results


def space(count: int, n: int) -> Results:
    """Space for the results of so many members."""
    widths = [(), (), (n + 2,), (n + 2,), (), *[(n + 1,)] * 4]
    kinds = [np.int64, np.bool_, *[np.float64] * 6, np.int64]
    columns: list[Any] = [
        np.zeros((count, *width), kind) for width, kind in zip(widths, kinds, strict=True)
    ]
    return Results(*columns)


def _run_blocks(
    plan: Blueprint, given: Array, which: Array, results: list[Any], room: int,
    until: float | None, max_events: int, stop: Callable[[], bool], more: int,
) -> Array:
    """Run some members; return those that filled the log."""
    blocks: dict[bool, Block] = {}
    again, first, size = [], 0, FIRST_BLOCK
    plain, measured = room * ROW_TIME, False  # s of a member in plain Python
    kernel: Any = family_with_reading if len(results) > 1 else family
    while first < len(which):
        if stop():
            raise Stopped
        members = which[first : first + size]
        ahead = len(which) - first - len(members) + more if measured else 0
        fast = kernels.worth_compiling(
            plain * len(members), kernel, lay_out_all, ahead=plain * ahead)
        block = blocks.get(fast) or blocks.setdefault(fast, Block(plan, room, until, fast, kernel))
        everyone, begun = len(which) == len(given), now()
        place = slice(first, first + len(members)) if everyone else members
        part = [type(table)(*(column[place] for column in table)) for table in results]
        full = block.run(block.lay_out(given[place]), max_events, part)
        if not everyone:
            for table, rows in zip(results, part, strict=True):
                for column, values in zip(table, rows, strict=True):
                    column[members] = values
        again.append(members[full])
        first += len(members)
        seconds = now() - begun
        quick = seconds < PATIENCE / 4
        if not fast:
            plain, measured = seconds / len(members), measured or not quick
        size = min(4 * size, LAST_BLOCK) if quick else max(1, size // 2)
    return np.concatenate(again)


class Block:
    """Work space for some members at a time: arrays for compiled kernels, else lists."""

    def __init__(
        self, plan: Blueprint, room: int, until: float | None = None, fast: bool = True,
        kernel: Any = family,
    ) -> None:
        self.plan, self.fast = plan, fast
        self.until = -1.0 if until is None else until
        self.make: Any = plan.make
        n = self.make.size[0]
        self.state: Any = work_space(n, room)
        self.stocks = tuple(GroupState(*([0.0] * (n + 2) for _ in range(3))) for _ in range(2))
        self.go: tuple[Any, Any] = lay_out_all, kernel
        if fast:
            self.make = Make(*(np.array(x, dtype=np.int64) for x in self.make))
            self.state, self.stocks = on_arrays(*self.state), tuple(map(as_arrays, self.stocks))
            self.go = kernels.compiled(lay_out_all), kernels.compiled(kernel)
        self.fates: Any = []

    def lay_out(self, given: Array) -> Layout:
        """Put members on their clocks; `fates` says for whom there is none."""
        count = len(given)
        if len(self.fates) != count:
            full = np.full if self.fast else lambda size, zero: [zero] * size
            self.layout, self.work = self.plan.space(count, full)
            self.fates = full(count, LAID)
        rows: Any = given.ravel()
        self.go[0](
            self.make, rows if self.fast else rows.tolist(), self.until, self.layout, self.work,
            self.fates,
        )
        return self.layout

    def status(self, members: Layout) -> Any:
        """Status of the nodes of each member at t = 0."""
        status = np.tile(self.plan.status, len(members.count))
        status[np.asarray(members.gap) > 0] = OPEN
        return status if self.fast else status.tolist()

    def run(self, members: Layout, max_events: int, results: list[Any]) -> Array:
        """Run members; return which of them filled the log."""
        flat: list[Any] = [type(x)(*(column.reshape(-1) for column in x)) for x in results]
        if not self.fast:
            flat = [kernels.as_lists(x) for x in flat]
        self.go[1](
            *self.state, self.stocks, members, self.status(members), max_events,
            tuple(flat) if len(flat) > 1 else flat[0],
        )
        if not self.fast:
            for table, found in zip(results, flat, strict=True):
                for column, values in zip(table, found, strict=True):
                    column[...] = np.reshape(values, column.shape)
        return np.asarray((np.asarray(self.fates) == LAID) & (results[0].flag == FULL))
