"""Runs of the kernels of fronts, for the page.

Plain Python around the kernels of the method "fronts", which the page has as JavaScript.
"""

from __future__ import annotations

from typing import Any

from ..methods.fronts.assembly import sizes_of, work_space
from ..methods.fronts.front_kernel import (
    CLOCK,
    FULL,
    NOW,
    OPEN,
    GroupState,
    final_state,
    initial_state,
    load,
    play,
    segment_totals,
)
from ..methods.fronts.layout_kernel import LAID, Layout, Work, lay_out, round_trip

ROOM = 256  # rows of the log at first
FINE = 1.0  # share of the usual room of the clock that is tried first, where it has few bits


def run_of(row: Any, further: bool, space: Any) -> Any:
    """Run a row to its end; `further` goes on for a round trip after the proof of finality.

    Returns
    -------
    dict
        ``layout`` and ``status`` of its nodes at t = 0; ``state``, ``tally``, ``log`` and ``clock``
        of the kernel; ``opening`` and ``closing`` stocks; ``why`` it stopped: the kernel's flag,
        -1 where its times do not fit on a clock. All but ``status`` and ``why`` is the `space`.
    """
    if row["until"] >= 0:
        return run_on(row, further, row["until"], space)
    share = FINE
    run = run_on(row, further, -share, space)
    while run["why"] == CLOCK and share < 1:
        share = min(4 * share, 1.0)
        run = run_on(row, further, -share, space)
    return run


def run_on(row: Any, further: bool, until: float, space: Any) -> Any:
    """Run a row; `until` as of `lay_out`, all else as of `run_of`."""
    layout, make = space["layout"], row["make"]
    if lay_out(make, row["given"], 0, until, layout, space["work"]) != LAID:
        return {**space, "why": -1}
    status = [OPEN if gap > 0 else at for gap, at in zip(layout.gap, row["status"], strict=True)]
    opening, target = space["opening"], layout.target[0]
    if further and target < 0:
        target = -round_trip(make, 0, layout)
    while True:
        state, tally, log, clock = space["state"], space["tally"], space["log"], space["clock"]
        if layout.count[0] + 2 <= len(log.tick):
            load(state, tally, log, clock, layout, 0, status)
            initial_state(state, log, opening)
            segment_totals(state, log, 0, opening)
            tol, window = layout.tolerance[0], layout.window[0]
            flag = play(state, tally, log, clock, target, row["max_events"], tol, window)
            if flag != FULL:
                break
        space.update(work_of(len(row["segments"]), 4 * len(log.tick)))
    final_state(state, tally, log, clock[NOW], opening, space["closing"])
    return {**space, "why": flag, "status": status}


def space_of(row: Any) -> Any:
    """Space for runs of rows of one make."""
    n = len(row["segments"])
    layout, work = sizes_of(row["make"])
    return {
        "layout": Layout(*[[0] * size for size in layout]),
        "work": Work(*[[0] * size for size in work]),
        "opening": stock_of(n), "closing": stock_of(n), **work_of(n, ROOM),
    }


def work_of(n: int, room: int) -> Any:
    """Space for the kernel."""
    state, tally, log, clock = work_space(n, room)
    return {"state": state, "tally": tally, "log": log, "clock": clock}


def stock_of(n: int) -> Any:
    """Space for what n segments hold."""
    return GroupState([0.0] * (n + 2), [0.0] * (n + 2), [0.0] * (n + 2))
