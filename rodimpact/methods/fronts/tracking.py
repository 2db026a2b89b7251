"""Runs the front kernel on one collision, on lists or compiled on arrays."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .. import kernels
from ..abilities import driven
from ..duration import Forecast
from ..memory import ask, most_numbers
from ..run import MAX_EVENTS
from .assembly import Assembly, start
from .front_kernel import (
    CAP,
    CHANGES,
    CLOCK,
    EVENTS,
    FINAL,
    FINALITY,
    FULL,
    NOW,
    ROWS,
    GroupState,
    Log,
    State,
    Tally,
    final_state,
    initial_state,
    play,
    segment_totals,
)

ROW_NUMBERS, LIST_NUMBERS = 18, 60  # that a row of the log takes with what results make of it
SLICE = 1 << 19  # rows that machine code adds at a time: it hears of nothing meanwhile
EVENT_TIMES = 2e-5, 2e-6  # s, about what an event takes in plain Python, and compiled
ROW_TIME = 2e-6  # s, about what plain Python takes for a row of the log

_LOG_TYPES = Log(np.int64, np.int32, np.int32, np.float64, np.int64, np.int32, np.int8)


class FrontRun(NamedTuple):
    """A finished run.

    Attributes
    ----------
    assembly : Assembly
    state, tally, log
        The kernel's state at the end; log arrays cut to what was used.
    opening, closing : Stock
        What the segments held at t = 0 and at the end, momenta and energies per tick.
    end : int
        Tick reached.
    finality_time : int
        Tick at which the collision was proved final, -1 without proof, as where ends are driven.
    events : int
        Arrival ticks taken, one end each.
    stopped_by : str
        ``"final"``, ``"until"``, ``"max_events"`` or ``"clock"``.
    """

    assembly: Assembly
    state: State
    tally: Tally
    log: Log
    opening: GroupState
    closing: GroupState
    end: int
    finality_time: int
    events: int
    stopped_by: str


def track(
    assembly: Assembly, until: float | None = None, max_events: int = MAX_EVENTS,
    forecast: Forecast | None = None,
) -> FrontRun:
    """Follow every front of a collision.

    Parameters
    ----------
    assembly : Assembly
    until : float, optional
        Time to be reached, s; by default the run ends one round trip of the longest body after the
        collision has been proved final.
    max_events : int
        Cap; a run that reaches it says so in `stopped_by`.
    forecast : Forecast, optional
        Hears of the progress.

    Raises
    ------
    TooLong
        If the run takes too much memory.
    """
    a = assembly
    mobility = [1 / Z if Z else 0.0 for Z in a.impedance]
    state: Any = start(a.ticks, mobility, a.status, a.gaps, a.outside, a.waves)
    state, tally, log, clock = state
    none = [0.0] * len(a.ticks)
    opening, closing = (GroupState(none[:], none[:], none[:]) for _ in range(2))
    initial_state(state, log, opening)
    segment_totals(state, log, 0, opening)
    target = -2 * a.longest
    if until is not None:
        target = round(until / a.tick)
    kernel: Any = play
    on_lists = True
    while True:
        # what is not over takes as long again as it took
        if on_lists and kernels.worth_compiling(clock[ROWS] * ROW_TIME, play):
            state, tally, log, clock = on_arrays(state, tally, log, clock)
            kernel, on_lists = kernels.compiled(play), False
        part = log if on_lists else _part(log, clock)
        flag = kernel(state, tally, part, clock, target, max_events, a.tolerance, a.window)
        if flag != FULL:
            break
        if forecast:
            done, events = int(clock[EVENTS]), _expected(clock, target, max_events)
            left = (events - done) * EVENT_TIMES[kernels.enabled()]
            forecast.expect(left, f"some {events:.2g} events")
            forecast.reached(done, events)
        log = _longer(log, clock, on_lists)
    if not on_lists:
        state, tally = State(*(x.tolist() for x in state)), Tally(*(x.tolist() for x in tally))
        clock = clock.tolist()
    final_state(state, tally, log, clock[NOW], opening, closing)
    closing = GroupState(*(list(map(float, column)) for column in closing))
    n, m = clock[ROWS], clock[CHANGES]
    log = Log(*(x[:n] for x in log[:4]), *(x[:m] for x in log[4:]))
    finality_time = -1 if until is not None and driven(a.system) else clock[FINALITY]
    reason = {FINAL: "final", CAP: "max_events", CLOCK: "clock"}.get(flag, "until")
    return FrontRun(
        a, state, tally, log, opening, closing, clock[NOW], finality_time, clock[EVENTS], reason
    )


def as_arrays(state: Any) -> Any:
    """Lists to arrays of the type of their first entry."""
    return type(state)(*(np.array(x, dtype=type(x[0])) for x in state))


def on_arrays(
    state: State, tally: Tally, log: Log, clock: list[int]
) -> tuple[State, Tally, Log, Any]:
    """Return the kernel's state on arrays, for compiled code."""
    columns = [np.array(x, dtype=t) for x, t in zip(log, _LOG_TYPES, strict=True)]
    return as_arrays(state), as_arrays(tally), Log(*columns), np.array(clock, dtype=np.int64)


def _part(log: Log, clock: Any) -> Log:
    """The log, on arrays, up to so many rows that a run is heard of in time."""
    rows, changes = int(clock[ROWS]) + SLICE, int(clock[CHANGES]) + SLICE
    return Log(*(x[:rows] for x in log[:4]), *(x[:changes] for x in log[4:]))


def _expected(clock: Any, target: int, max_events: int) -> int:
    """About how many events a run has, at the rate so far, or as many again to an unknown end."""
    most = min(max_events, int(most_numbers() / ROW_NUMBERS))
    events, now = int(clock[EVENTS]), int(clock[NOW])
    return min(most, events * target // now if target > 0 < now else 2 * events)


def _longer(log: Log, clock: Any, on_lists: bool) -> Log:
    """Make room for as much again in the list of fronts, of changes, or in both."""
    full = [clock[ROWS] + 2 > len(log.value)] * 4 + [clock[CHANGES] >= len(log.change_tick)] * 3
    if not any(full):
        return log
    used = int(clock[ROWS] + clock[CHANGES])
    numbers = used * (LIST_NUMBERS if on_lists else ROW_NUMBERS)
    remedy = "lower the cap, or stop earlier (until)"
    ask(numbers, "max_events", f"a run of more than {clock[EVENTS]} events", remedy)
    grown = []
    for column, grow in zip(log, full, strict=True):
        if not grow:
            grown.append(column)
        elif on_lists:
            grown.append(column + [0 * column[0]] * len(column))
        else:
            longer = np.empty(2 * len(column), dtype=column.dtype)
            longer[: len(column)] = column
            grown.append(longer)
    return Log(*grown)
