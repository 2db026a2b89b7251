"""From a row, or a family of them, to the records of the kernels, and their runs.

Plain Python runs on lists of objects, until machine code pays: then all goes on in arrays.
"""

import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from .. import duration, kernels
from ..compiling import as_objects, as_records, blank, lengthened
from ..duration import Forecast
from ..laws import Stop
from ..memory import ask, most_numbers
from ..run import Stopped
from . import events, layout, march, stock
from .plan import Plan, blank_records
from .records import CHANGE, LINE, NODE, PART, PIECE, ROW, RUN, SEGMENT

ROOM = 32  # rows of the log at first, beside those at t = 0
ROW_NUMBERS, LIST_NUMBERS = 18, 60  # that a row of the log takes with what results make of it
EVENT_TIMES = 2e-5, 2e-6  # s, about what an event takes in plain Python, and compiled
ROW_TIME = 1e-5  # s, about what plain Python takes for a row of the log
PAIR_TIME = 4e-7  # s, about what plain Python takes to compare two durations
FIRST_BLOCK, LAST_BLOCK = 64, 2048  # members of a block
RECORDS = {"run": RUN, "segment": SEGMENT, "node": NODE, "line": LINE, "log": ROW, "piece": PIECE,
           "part": PART}
FOLLOWED = ("run", "given", "piece", "segment", "node", "line", "log", "tree", "part")
GROWTH = 16  # of a block after one that was quick
PATIENCE = 0.1  # s; about how long a block runs before `stop` is asked again
now = getattr(time, "thread_time", time.perf_counter)  # a browser has no clock of threads


class Members:
    """Some members of a family: their records, and the room that they share.

    Parameters
    ----------
    plan : Plan
    given : list of float
        Numbers of a single member.
    fast : bool
        Whether they run in machine code.
    **asked
        Fields of RUN.

    Attributes
    ----------
    records : dict of str to array or list
        What the kernel works on: in machine code arrays of records, else lists of objects.
    """

    def __init__(self, plan: Plan, given: list[float], fast: bool, **asked: Any) -> None:
        self.plan, self.fast = plan, False
        self.records: dict[str, Any] = blank_records(plan, ROOM)
        one = self.records["run"]
        for name, value in asked.items():
            setattr(one, name, value)
        self.records |= {"run": [one], "given": given}
        self._room = np.empty(0, PART)
        if fast:
            self.on_arrays()

    def lay(self, given: Any) -> None:
        """Take the numbers of other members, [member, number]."""
        parts = len(given) * len(self.plan.kinds)
        if self.fast:
            if len(self._room) < parts:  # memory that is new takes longer than a run
                self._room = np.empty(parts, PART)
            self.records |= {"given": given.ravel(), "part": self._room[:parts]}
        else:
            self.records |= {"given": given.ravel().tolist(), "part": blank(parts, PART)}

    def go(self) -> bool:
        """Run them; return whether there is more to do, with a longer log."""
        follow: Any = kernels.compiled(march.follow) if self.fast else march.follow
        return not follow(*(self.records[name] for name in FOLLOWED))

    def lengthen(self) -> None:
        """Make the log longer."""
        rows = len(self.records["log"])
        ask(rows * (2 * ROW_NUMBERS if self.fast else LIST_NUMBERS), "max_events",
            f"a run of more than {rows} fronts", "lower the cap, or stop earlier (until)")
        self.records["log"] = lengthened(self.records["log"], ROW)

    def on_arrays(self) -> None:
        """Go on in machine code."""
        for name, held in self.records.items():
            self.records[name] = self.arrays(name) if name in RECORDS else np.array(held)
        self.fast = True

    def arrays(self, name: str) -> Any:
        """The records of this name as an array."""
        records = self.records[name]
        return records if self.fast else as_records(records, RECORDS[name])

    def objects(self, name: str) -> list[Any]:
        """The records of this name as objects."""
        records = self.records[name]
        return as_objects(records) if self.fast else records


class Laid(NamedTuple):
    """One collision at t = 0 on lists of objects: fields of their records, but `run` is one."""

    run: Any
    segment: list[Any]
    node: list[Any]
    line: list[Any]
    log: list[Any]
    tree: list[Any]

    def go(self, target: Any, limit: int, tolerance: Any = 0.0, window: int = 0) -> Stop:
        """Run to tick `target`, or if it is negative to the proof and -target ticks more."""
        run = self.run
        run.target, run.limit, run.tolerance, run.window = target, limit, tolerance, window
        while (stop := march.play(*self)) == Stop.FULL:
            self.log.extend(blank(len(self.log), ROW))
        events.close_books(run, self.node, run.now)
        return Stop(stop)

    def advance(self, horizon: int) -> None:
        """Run to a tick, and prove nothing."""
        while events.advance(*self, horizon) == Stop.FULL:
            self.log.extend(blank(len(self.log), ROW))

    @property
    def changes(self) -> list[Any]:
        """Rows of the log on changes of contacts."""
        return [row for row in self.log[: self.run.rows] if row.line == CHANGE]


def laid(
    plan: Plan, numbers: Sequence[Any], ticks: Sequence[Any], tick: Any, frame: Any = 0.0
) -> Laid:
    """Set a collision to t = 0, of whatever kind of number times and amplitudes are.

    Parameters
    ----------
    plan : Plan
        Of a collision in which velocities and strains do not jump.
    numbers : sequence
        In place of those of the plan.
    ticks : [segment]
        Transit times.
    tick, frame
        What a tick lasts, s, and the velocity from which velocities are counted.
    """
    made, n = {**blank_records(plan, ROOM), "given": numbers}, len(plan.kinds) - 1
    run, _, piece, segment, node, line, log, tree, _ = (made[name] for name in FOLLOWED)
    run.tick, run.frame = tick, frame
    layout.cut(numbers, 0, piece, segment)
    for s, T in enumerate(ticks, 1):
        segment[s].transit, segment[s].mobility = T, 1 / numbers[n + s - 1]
    layout.lay_out(run, numbers, piece, segment, node, line, log)
    events.begin(run, segment, node, line, log, tree)
    stock.settle(run, segment, node, line, log)
    stock.remember(segment)
    return Laid(run, segment, node, line, log, tree)


def solve_one(
    plan: Plan, until: float | None, max_events: int, forecast: Forecast | None = None,
    beside: bool = False,
) -> Members:
    """Follow every front of a single collision.

    Without `until` the run ends one round trip of the longest body after the proof.

    Raises
    ------
    TooLong
        If the run takes too much memory.
    InvalidModel
        When velocities overflow, or transit times are too far apart for one clock.
    """
    fast = kernels.worth_compiling(plan.fronts**2 * PAIR_TIME, march.follow)
    members = Members(plan, list(map(float, plan.numbers)), fast,
                      until=-1.0 if until is None else until, limit=max_events, further=1,
                      beside=int(beside))
    while members.go():
        rows, (run,) = len(members.records["log"]), members.objects("run")
        if not members.fast and kernels.worth_compiling(rows * ROW_TIME, march.follow):
            members.on_arrays()  # what is not over takes as long again as it took
        if forecast:
            events, expected = int(run.events), _expected(run)
            left = (expected - events) * EVENT_TIMES[members.fast]
            if left > duration.SOON:  # compiling may have taken longer
                forecast.expect(left, f"some {expected:.2g} events")
            forecast.reached(events, expected)
        members.lengthen()
    return members


def _expected(run: Any) -> int:
    """About how many events a run has, at the rate so far, or as many again to an unknown end."""
    most = min(int(run.limit), int(most_numbers() / ROW_NUMBERS))
    events, end, reached = int(run.events), int(run.target), int(run.now)
    return min(most, events * end // reached if end > 0 < reached else 2 * events)


def solve_many(
    plan: Plan, until: float | None, max_events: int, wanted: Sequence[tuple[str, int]],
    stop: Callable[[], bool] = lambda: False, more: int = 0,
) -> dict[tuple[str, int], Any]:
    """Run every member of a family to `until`, or to its proof of finality.

    Members run in blocks that share records small enough for the processor's cache.

    Parameters
    ----------
    plan : Plan
    until : float or None
        Time to be reached, s.
    max_events : int
        Cap for each member.
    wanted : sequence of (str, int)
        Fields of PART, and of which node.
    stop : callable
        Asked now and then whether to give up.
    more : int
        Members that other calls will run in this process.

    Returns
    -------
    dict of (str, int) to array
        What is wanted, [member] in C order.

    Raises
    ------
    Stopped
        If `stop` said so.
    TooLong
        If a member takes too much memory.
    """
    count, nodes, varying = plan.row.members, len(plan.kinds), dict[int, Any]()
    given = np.empty((min(count, LAST_BLOCK), len(plan.numbers)))
    for j, number in enumerate(plan.numbers):
        if np.ndim(number) == 0:
            given[:, j] = number
        else:
            varying[j] = np.broadcast_to(number, plan.row.system.shape).ravel()
    first, size, members = 0, FIRST_BLOCK, None
    columns = {(name, k): np.empty(count, PART[name]) for name, k in wanted}
    reads = any(name == "parted" for name, _ in wanted)
    plain, measured = ROOM * ROW_TIME, False  # s of a member in plain Python
    while first < count:
        if stop():
            raise Stopped
        block, begun = slice(first, min(first + size, count)), now()
        length = block.stop - first
        ahead = count - block.stop + more if measured else 0
        fast = kernels.worth_compiling(plain * length, march.follow, ahead=plain * ahead)
        if members is None or members.fast != fast:
            members = Members(plan, [], fast, limit=max_events, reads=int(reads),
                              until=-1.0 if until is None else until)
        for j, number in varying.items():
            given[:length, j] = number[block]
        members.lay(given[:length])
        while members.go():
            members.lengthen()
        part = members.arrays("part").reshape(length, nodes)
        for (name, k), column in columns.items():
            column[block] = part[name][:, k]
        first, seconds = block.stop, now() - begun
        quick = seconds < PATIENCE / 4
        if not fast:
            plain, measured = seconds / length, measured or not quick
        size = min(GROWTH * size, LAST_BLOCK) if quick else max(1, size // 2)
    return columns
