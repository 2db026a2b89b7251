"""Runs of the kernels: a single collision, or the members of a family.

Plain Python runs on lists of objects, until machine code pays: then all goes on in
arrays of records.
"""

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .. import duration, kernels
from ..compiling import as_objects, as_records, blank, lengthened
from ..duration import Forecast
from ..laws import Stop
from ..memory import ask, most_numbers
from ..row import Array
from ..run import Stopped
from . import energy, events, initial_state
from .members import run_members, run_to_end
from .plan import Plan, make_state
from .records import (
    CHANGE,
    FRONT,
    LINE,
    NODE,
    PIECE,
    RUN,
    SEGMENT,
    TOTALS,
    Front,
    Run,
    State,
)

ROOM = 32  # rows of the log at first, beside those at t = 0
ROW_NUMBERS = 18  # that a row of the log takes, with what results make of it
LIST_NUMBERS = 60  # the same in plain Python
EVENT_TIME = 2e-6  # s, about what an event takes in machine code
PLAIN_EVENT_TIME = 2e-5  # s, in plain Python
ROW_TIME = 1e-5  # s, about what plain Python takes for a row of the log
PAIR_TIME = 4e-7  # s, about what plain Python takes to compare two durations

FIRST_BLOCK = 64  # members
LAST_BLOCK = 2048
GROWTH = 16  # of a block over one that was quick
PATIENCE = 0.1  # s; about how long a block runs before `stop` is asked again
now = getattr(time, "thread_time", time.perf_counter)  # a browser has no thread_time

KINDS = {
    "runs": RUN,
    "pieces": PIECE,
    "segments": SEGMENT,
    "nodes": NODE,
    "lines": LINE,
    "log": FRONT,
}
"""Types of the records of a `State`, by its fields."""


class Batch:
    """Members of a family that run one after the other on the same records.

    Parameters
    ----------
    plan : Plan
    fast : bool
        Whether they run in machine code.
    **request
        Fields of `records.Run` that say what is asked for.

    Attributes
    ----------
    state : State
        In machine code of arrays, else of lists of objects.
    """

    def __init__(self, plan: Plan, fast: bool, **request: Any) -> None:
        self.plan = plan
        self.fast = False
        self.state = make_state(plan, ROOM, [])
        for name, value in request.items():
            setattr(self.state.runs[0], name, value)
        self._room = np.empty((0, len(plan.kinds)), TOTALS)
        if fast:
            self.to_arrays()

    def load(self, numbers: Array) -> None:
        """Take the numbers of other members, [member, number]."""
        members, nodes = len(numbers), len(self.plan.kinds)
        if self.fast:
            if len(self._room) < members:  # new memory takes longer than a run
                self._room = np.empty((members, nodes), TOTALS)
            totals = self._room[:members]
            self.state = self.state._replace(numbers=numbers, totals=totals)
        else:
            lists = [blank(nodes, TOTALS) for _ in range(members)]
            self.state = self.state._replace(numbers=numbers.tolist(), totals=lists)

    def run(self) -> bool:
        """Run them; return whether all are done, else the log must grow first."""
        kernel: Any = run_members
        if self.fast:
            kernel = kernels.compiled(run_members)
        return bool(kernel(self.state))

    def grow_log(self) -> None:
        """Make the log longer."""
        rows = len(self.state.log)
        numbers = rows * LIST_NUMBERS
        if self.fast:
            numbers = rows * 2 * ROW_NUMBERS
        what = f"a run of more than {rows} fronts"
        ask(numbers, "max_events", what, "lower the cap, or stop earlier (until)")
        self.state = self.state._replace(log=lengthened(self.state.log, FRONT))

    def to_arrays(self) -> None:
        """Go on in machine code."""
        arrays: dict[str, Any] = {name: self.array(name) for name in KINDS}
        arrays["numbers"] = np.array(self.state.numbers, dtype=float)
        arrays["queue"] = np.array(self.state.queue)
        arrays["totals"] = self.totals()
        self.state = State(**arrays)
        self.fast = True

    def array(self, name: str) -> Any:
        """The records of a field of the state as an array."""
        records = getattr(self.state, name)
        return records if self.fast else as_records(records, KINDS[name])

    def objects(self, name: str) -> list[Any]:
        """The records of a field of the state as objects."""
        records = getattr(self.state, name)
        return as_objects(records) if self.fast else records

    def totals(self) -> Any:
        """Totals of the members as an array, [member, node]."""
        totals: Any = self.state.totals
        if self.fast:
            return totals
        return np.array([as_records(own, TOTALS) for own in totals])

    @property
    def progress(self) -> Run:
        """The record of the run."""
        return self.objects("runs")[0]


# A single collision -------------------------------------------------------------------


def solve_one(
    plan: Plan,
    until: float | None,
    max_events: int,
    forecast: Forecast | None = None,
    other_side: bool = False,
) -> Batch:
    """Follow every front of a single collision.

    Without `until` the run ends one round trip of the longest body after the proof.

    Parameters
    ----------
    plan : Plan
    until : float or None
        Time to be reached, s.
    max_events : int
        Cap.
    forecast : Forecast, optional
        Told how long the run takes.
    other_side : bool
        Whether transit times that the clock rounds are rounded the other way.

    Raises
    ------
    TooLong
        If the run takes too much memory.
    InvalidModel
        When velocities overflow, or transit times are too far apart for one clock.
    """
    fast = kernels.worth_compiling(plan.fronts**2 * PAIR_TIME, run_members)
    batch = Batch(
        plan,
        fast,
        until=-1.0 if until is None else until,
        event_limit=max_events,
        goes_on=1,
        other_side=int(other_side),
    )
    batch.load(np.array([plan.numbers], dtype=float))
    while not batch.run():
        spent = len(batch.state.log) * ROW_TIME
        if not batch.fast and kernels.worth_compiling(spent, run_members):
            batch.to_arrays()  # what is not over takes as long again as it took
        if forecast:
            announce(forecast, batch)
        batch.grow_log()
    return batch


def announce(forecast: Forecast, batch: Batch) -> None:
    """Say how long a run will take, and how far it is."""
    run = batch.progress
    events = int(run.events)
    expected = expected_events(run)
    event_time = EVENT_TIME if batch.fast else PLAIN_EVENT_TIME
    left = (expected - events) * event_time
    if left > duration.SOON:  # compiling may have taken longer
        forecast.expect(left, f"some {expected:.2g} events")
    forecast.reached(events, expected)


def expected_events(run: Run) -> int:
    """About how many events a run has: at the rate so far, or as many again."""
    most = min(int(run.event_limit), int(most_numbers() / ROW_NUMBERS))
    events, end, reached = int(run.events), int(run.target), int(run.now)
    expected = 2 * events
    if end > 0 and reached > 0:
        expected = events * end // reached
    return min(most, expected)


# Families -----------------------------------------------------------------------------


def solve_many(
    plan: Plan,
    until: float | None,
    max_events: int,
    wanted: Sequence[tuple[str, int]],
    stop: Callable[[], bool] = lambda: False,
    more: int = 0,
) -> dict[tuple[str, int], Array]:
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
        Fields of `records.Totals`, and of which node.
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
    count = plan.row.members
    numbers = NumbersOfMembers(plan)
    columns = {(name, k): np.empty(count, TOTALS[name]) for name, k in wanted}
    request = {
        "until": -1.0 if until is None else until,
        "event_limit": max_events,
        "reads_waves": int(any(name == "wave_difference" for name, _ in wanted)),
    }
    member_time = ROOM * ROW_TIME  # s, in plain Python
    measured = False
    batch = Batch(plan, False, **request)
    first, size = 0, FIRST_BLOCK
    while first < count:
        if stop():
            raise Stopped
        block = slice(first, min(first + size, count))
        begun = now()
        length = block.stop - first
        ahead = 0.0
        if measured:
            ahead = member_time * (count - block.stop + more)
        fast = kernels.worth_compiling(member_time * length, run_members, ahead=ahead)
        if fast != batch.fast:
            batch = Batch(plan, fast, **request)
        batch.load(numbers.of(block))
        while not batch.run():
            batch.grow_log()
        totals = batch.totals()
        for (name, k), column in columns.items():
            column[block] = totals[name][:, k]
        first = block.stop
        seconds = now() - begun
        quick = seconds < PATIENCE / 4
        if not fast:
            member_time = seconds / length
            measured = measured or not quick
        size = min(GROWTH * size, LAST_BLOCK) if quick else max(1, size // 2)
    return columns


class NumbersOfMembers:
    """The numbers of the members of a family, block by block."""

    def __init__(self, plan: Plan) -> None:
        rows = min(plan.row.members, LAST_BLOCK)
        self._block = np.empty((rows, len(plan.numbers)))
        self._varying: dict[int, Array] = {}
        for j, number in enumerate(plan.numbers):
            if np.ndim(number) == 0:
                self._block[:, j] = number  # once for all blocks
            else:
                shape = plan.row.system.shape
                self._varying[j] = np.broadcast_to(number, shape).ravel()

    def of(self, block: slice) -> Array:
        """Numbers of some members, [member, number]; the next call overwrites them."""
        rows = self._block[: block.stop - block.start]
        for j, number in self._varying.items():
            rows[:, j] = number[block]
        return rows


# Numbers of any kind ------------------------------------------------------------------


class Simulation(State):
    """A single collision on objects; times and amplitudes are numbers of any kind."""

    __slots__ = ()

    @property
    def run(self) -> Run:
        """The record of the run."""
        return self.runs[0]

    @property
    def changes(self) -> list[Front]:
        """Rows of the log that say how contacts changed."""
        return [row for row in self.log[: self.run.rows] if row.line == CHANGE]

    def run_to(
        self, target: Any, limit: int, tolerance: Any = 0.0, window: int = 0
    ) -> Stop:
        """Run to tick `target`, or if negative to the proof and -target ticks more."""
        run = self.run
        run.target = target
        run.event_limit = limit
        run.tolerance = tolerance
        run.window = window
        stop = run_to_end(self)
        while stop == Stop.FULL:
            self._grow_log()
            stop = run_to_end(self)
        events.close_books(self, run.now)
        return Stop(stop)

    def advance(self, horizon: int) -> None:
        """Run to a tick, and prove nothing."""
        while events.advance(self, horizon) == Stop.FULL:
            self._grow_log()

    def _grow_log(self) -> None:
        log: Any = self.log
        log.extend(blank(len(log), FRONT))


def simulation(
    plan: Plan,
    numbers: Sequence[Any],
    ticks: Sequence[Any],
    tick: Any,
    frame: Any = 0.0,
) -> Simulation:
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
    state = Simulation(*make_state(plan, ROOM, []))
    state.run.tick = tick
    state.run.frame = frame
    segments = state.segments
    initial_state.cut_at_jumps(numbers, state.pieces, segments)
    n = len(ticks)
    for s in range(1, n + 1):
        segments[s].transit = ticks[s - 1]
        segments[s].mobility = 1 / numbers[n + s - 1]
    initial_state.lay_out(state, numbers)
    events.start(state)
    energy.update(state)
    energy.keep_initial(segments)
    return state
