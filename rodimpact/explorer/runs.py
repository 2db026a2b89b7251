"""Runs of the kernels of fronts, for the page.

Plain Python around the kernels of the method "fronts", which the page has as JavaScript.
"""

from __future__ import annotations

from typing import Any

from ..methods.compiling import blank
from ..methods.fronts import events, layout, march
from ..methods.fronts.plan import blank_records
from ..methods.fronts.records import IDLE, NONE, ROW
from ..methods.laws import Stop

ROOM = 256  # rows of the log at first
FINE = 1.0  # share of the usual room of the clock that is tried first, where it has few bits


def run_of(asked: Any, further: bool, space: Any) -> Any:
    """Run a plan to its end; `further` goes on for a round trip after the proof of finality.

    Returns
    -------
    dict
        The `space`, whose records the kernels have left: ``run``, and lists of the others.
    """
    run, share = space["run"], FINE
    run.limit, run.further, run.until = asked.max_events, 1 if further else 0, asked.until
    if asked.until < 0:
        run.until = -share
    go(space)
    while asked.until < 0 and run.stop == Stop.CLOCK and share < 1:
        share = min(4 * share, 1.0)
        run.until = -share
        go(space)
    return space


def go(space: Any) -> None:
    """Run from t = 0 on, on the clock that `until` asks for."""
    space["run"].stop = Stop.NONE.value
    while march.follow(
        [space["run"]], space["body"], space["plan"].numbers, space["piece"], space["segment"],
        space["node"], space["line"], space["log"], space["tree"]) != NONE:
        space["log"].extend(blank(3 * len(space["log"]), ROW))


def begun(run: Any) -> Any:
    """A space in which a collision that was run is at t = 0, and nothing is to be proved."""
    space = space_of(run["plan"])
    it, body, piece, segment = space["run"], space["body"], space["piece"], space["segment"]
    it.until, it.limit, it.further = run["run"].until, run["run"].limit, 1
    given = space["plan"].numbers
    layout.choose_clock([it], 0, body, given, piece, segment, space["node"])
    layout.lay_out(it, body, given, piece, segment, space["node"], space["line"], space["log"])
    events.begin(it, segment, space["node"], space["line"], space["log"], space["tree"])
    it.rest = IDLE
    return space


def advance(space: Any, tick: int) -> None:
    """Run on to a tick."""
    while events.advance(
        space["run"], space["segment"], space["node"], space["line"], space["log"],
        space["tree"], tick,
    ) == Stop.FULL:
        space["log"].extend(blank(len(space["log"]), ROW))


def space_of(plan: Any) -> Any:
    """Space for runs of a plan, and of others that differ from it in numbers only."""
    return {"plan": plan, **blank_records(plan, ROOM)}
