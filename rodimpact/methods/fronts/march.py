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
        it, inside = run[m], segment[m * (nodes + 1) : (m + 1) * (nodes + 1)]
        ends = node[m * nodes : (m + 1) * nodes]
        if it.stop == Stop.NONE:
            it.row = m * (len(given) // len(run))
            layout.measure(it, body, given, piece, inside, ends)
            if it.stop == Stop.NONE:
                layout.choose_clock(run, m, given, piece, inside)
            if it.stop == Stop.NONE:
                layout.lay_out(it, body, given, piece, inside, ends, line, log)
                events.begin(it, inside, ends, line, log, tree)
                stock.settle(it, inside, ends, line, log)
                stock.remember(inside)
        if it.stop < Stop.DONE:
            it.stop = play(it, inside, ends, line, log, tree)
            if it.stop == Stop.FULL:
                return m
            events.close_books(it, ends, it.now)
            stock.settle(it, inside, ends, line, log)
            it.vibration = energy_left(it, inside)
            if it.further:
                scales(it, inside, line, log)
            if it.reads:
                stock.read(it, inside, line, log)
    return NONE


def energy_left(run: Any, segment: Any) -> Any:
    """Energy of vibration of all segments, J."""
    energy = 0 * run.tick
    for s in range(len(segment)):
        energy += segment[s].vibration
    return energy * run.tick


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
    until, horizon, tol, going = run.target, run.target, run.tolerance, True
    stop = Stop.NONE.value
    if until >= 0:
        run.rest = IDLE  # nothing is to be proved on the way
    else:
        horizon = NEVER - 1 if run.proved == NONE else min(run.proved - until, NEVER - 1)
    while going:
        stop = events.advance(run, segment, node, line, log, tree, horizon)
        known = until >= 0 or run.proved != NONE  # when the run ends
        if stop == Stop.DONE and known:
            run.now = horizon
        if stop != Stop.FULL and run.proved == NONE:
            now = max(run.now, run.probe) if stop == Stop.CHECK else run.now
            when = finality.finality_time(segment, node, line, log, now, tol)
            if when == now:
                run.proved, run.rest = now, IDLE
                horizon = min(now - until, NEVER - 1)
            elif stop == Stop.CHECK:
                run.probe = when
                run.rest = run.events + len(node) + run.events // 8
        going = stop == Stop.CHECK or (stop == Stop.DONE and not known and run.proved != NONE)
    if stop == Stop.DONE and until < 0:
        stop = Stop.CLOCK.value if run.proved == NONE else Stop.FINAL.value
    return stop
