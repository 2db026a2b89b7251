"""Runs of collisions: laid out, followed to their end, and added up; one after the other.

A run ends at the time asked for, or some ticks after the proof that no contact can press again.
After a failed proof the next one waits for an eighth more events, so that proofs cost no more than
the run itself.
"""

from typing import Any

from ..laws import Stop
from . import events, finality, layout, stock
from .records import CHANGE, IDLE, NEVER, NONE


def follow(
    run: Any, body: Any, given: Any, piece: Any, segment: Any, node: Any, line: Any, log: Any,
    tree: Any,
) -> int:
    """Run every member to its end; return the one for which the log is full, -1 if all are done.

    A member that needs more room goes on when this is called again, with a longer log.

    Parameters
    ----------
    run : [member] RUN
        Of what is asked for; those with a `stop` from DONE on are done.
    body : [body] BODY
    given : [member * numbers]
    piece : [duration] PIECE
        Work space.
    segment : [member * (n + 2)] SEGMENT
    node : [member * (n + 1)] NODE
    line : [2 n + 4] LINE
        Work space.
    log : ROW
    tree : [2 * leaves] int
        Work space.
    """
    nodes = len(node) // len(run)
    for m in range(len(run)):
        it = run[m]
        if it.stop < Stop.DONE:
            inside = segment[m * (nodes + 1) : (m + 1) * (nodes + 1)]
            ends = node[m * nodes : (m + 1) * nodes]
            if it.stop == Stop.NONE:
                layout.choose_clock(run, m, body, given, piece, inside, ends)
                if it.stop == Stop.NONE:
                    layout.lay_out(it, body, given, piece, inside, ends, line, log)
            if it.stop == Stop.LAID:
                events.begin(it, inside, ends, line, log, tree)
                stock.initial(it, inside, ends, line, log)
            if it.stop < Stop.DONE:
                it.stop = play(it, inside, ends, line, log, tree)
            if it.stop == Stop.FULL:
                return m
            if it.stop < Stop.OVERFLOW:
                finish(it, inside, ends, line, log)
    return NONE


def finish(run: Any, segment: Any, node: Any, line: Any, log: Any) -> None:
    """Add up what a run has come to."""
    stock.settle(run, segment, node, line, log)
    run.vibration = 0 * run.tick
    for s in range(len(segment)):
        run.vibration += segment[s].vibration
    run.vibration *= run.tick
    if run.further:
        scales(run, segment, line, log)
    if run.reads:
        stock.read(run, segment, line, log)


def scales(run: Any, segment: Any, line: Any, log: Any) -> None:
    """Find the fastest wave, and the sum of absolute momenta at t = 0."""
    run.absolute, run.fastest = 0 * run.tick, 0 * run.tick
    for r in range(run.rows):
        if log[r].line != CHANGE:
            run.fastest = max(run.fastest, abs(log[r].value))
    for r in range(run.started):
        front, end = log[r], 0
        if 1 < front.line < len(line) - 2:
            if front.after != NONE:
                end = min(log[front.after].tick, 0)
            weight = (end - front.tick) * run.tick / (2 * segment[front.line // 2].mobility)
            run.absolute += weight * abs(front.value + run.frame)


def play(run: Any, segment: Any, node: Any, line: Any, log: Any, tree: Any) -> int:
    """Run to tick `target`, or if it is negative to the proof and -target ticks more.

    Returns
    -------
    int
        DONE (reached `target`), FINAL (proved, and run on), FULL (grow the log and call again), CAP
        (more than `limit` events) or CLOCK (2^62 ticks are over). At the end `now` is the tick
        reached, `proved` that of the proof, NONE without.
    """
    until, horizon, tol = run.target, run.target, run.tolerance
    if until >= 0:
        run.rest = IDLE  # nothing is to be proved on the way
    else:
        horizon = NEVER - 1 if run.proved == NONE else min(run.proved - until, NEVER - 1)
    while True:
        stop = events.advance(run, segment, node, line, log, tree, horizon)
        if stop == Stop.FULL:
            return stop
        known = until >= 0 or run.proved != NONE  # when the run ends
        if stop == Stop.DONE and known:
            run.now = horizon
        now = max(run.now, run.probe) if stop == Stop.CHECK else run.now
        if run.proved == NONE:
            when = finality.finality_time(segment, node, line, log, now, tol)
            if when == now:
                run.proved, run.rest = now, IDLE
                horizon = min(now - until, NEVER - 1)
            elif stop == Stop.CHECK:
                run.probe = when
                run.rest = run.events + len(node) + run.events // 8
        if stop == Stop.CAP or (stop == Stop.DONE and known):
            break
        if stop == Stop.DONE and run.proved == NONE:
            stop = Stop.CLOCK.value
            break
    events.close_books(run, node, run.now)
    return Stop.FINAL.value if until < 0 and stop == Stop.DONE else stop
