"""Runs of the kernels of fronts, for the page.

Plain Python around the kernels of the method "fronts", which the page has as JavaScript.
"""

from __future__ import annotations

from typing import Any

from ..methods.compiling import blank
from ..methods.fronts import events, layout, march
from ..methods.fronts.records import BODY, IDLE, LINE, NODE, NONE, PIECE, ROW, RUN, SEGMENT
from ..methods.laws import Stop

ROOM = 256  # rows of the log at first
FINE = 1.0  # share of the usual room of the clock that is tried first, where it has few bits


def run_of(row: Any, further: bool, space: Any) -> Any:
    """Run a row to its end; `further` goes on for a round trip after the proof of finality.

    Returns
    -------
    dict
        The `space`, whose records the kernels have left: ``run``, and lists of the others.
    """
    if row["until"] >= 0:
        return run_on(row, further, row["until"], space)
    share = FINE
    run = run_on(row, further, -share, space)
    while run["run"].stop == Stop.CLOCK and share < 1:
        share = min(4 * share, 1.0)
        run = run_on(row, further, -share, space)
    return run


def run_on(row: Any, further: bool, until: float, space: Any) -> Any:
    """Run a row; `until` as of `RUN`, all else as of `run_of`."""
    ask(row, further, until, space)
    while go_on(row, space) != NONE:
        space["log"].extend(blank(3 * len(space["log"]), ROW))
    return space


def ask(row: Any, further: bool, until: float, space: Any) -> None:
    """Set what a run is asked for."""
    run = space["run"]
    run.until, run.limit, run.stop = until, row["max_events"], Stop.NONE.value
    run.further = 1 if further else 0


def go_on(row: Any, space: Any) -> int:
    """Run, or go on with a longer log; returns as the kernel does."""
    return march.follow(
        [space["run"]], space["body"], row["given"], space["piece"], space["segment"],
        space["node"], space["line"], space["log"], space["tree"])


def begun(row: Any, further: bool, until: float) -> Any:
    """A space in which a row is at t = 0, and nothing is to be proved on the way."""
    space = space_of(row)
    ask(row, further, until, space)
    run, body, piece, segment = space["run"], space["body"], space["piece"], space["segment"]
    layout.choose_clock([run], 0, body, row["given"], piece, segment, space["node"])
    layout.lay_out(
        run, body, row["given"], piece, segment, space["node"], space["line"], space["log"])
    events.begin(
        space["run"], space["segment"], space["node"], space["line"], space["log"], space["tree"])
    space["run"].rest = IDLE
    return space


def advance(space: Any, tick: int) -> None:
    """Run on to a tick."""
    while events.advance(
        space["run"], space["segment"], space["node"], space["line"], space["log"],
        space["tree"], tick,
    ) == Stop.FULL:
        space["log"].extend(blank(len(space["log"]), ROW))


def space_of(row: Any) -> Any:
    """Space for runs of rows of one make."""
    n, pieces = len(row["segments"]), len(row["segments"])
    body = blank(len(row["rows"]), BODY)
    for i, (first, last, profile, velocities, strains, outside) in enumerate(row["rows"]):
        it = body[i]
        it.first, it.last, it.profile = first, last, profile
        it.velocities, it.strains, it.outside = velocities, strains, outside
        pieces += velocities + strains - 2
    node = blank(n + 1, NODE)
    for k in range(n + 1):
        node[k].kind, node[k].contact = row["kinds"][k], NONE
    for i, k in enumerate(row["nodes"]):
        node[k].contact = i
    run = blank(1, RUN)
    return {
        "run": run[0], "body": body, "node": node, "segment": blank(n + 2, SEGMENT),
        "piece": blank(pieces, PIECE), "line": blank(2 * n + 4, LINE),
        "log": blank(2 * pieces + ROOM, ROW),
        "tree": [0 for _ in range(events.size_of_tree(n + 1))],
    }
