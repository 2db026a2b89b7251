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
    run: Any, given: Any, piece: Any, segment: Any, node: Any, line: Any, log: Any, tree: Any,
    part: Any,
) -> bool:
    """Run every member to its end; return whether all are done.

    Where the log is full, this is to be called again, with a longer one: the member goes on. All
    members share the records but `given` and `part`.

    Parameters
    ----------
    run : [1] RUN
    given : [member * numbers]
    piece : [duration] PIECE
    segment : [n + 2] SEGMENT
    node : [n + 1] NODE
    line : [2 n + 4] LINE
    log : ROW
    tree : [2 * leaves] int
    part : [member * (n + 1)] PART
    """
    it, members = run[0], len(part) // len(node)
    if it.stop != Stop.FULL:
        it.member = 0
    while it.member < members:
        if it.stop != Stop.FULL:
            it.row = it.member * (len(given) // members)
            layout.choose_clock(it, given, piece, segment, node)
            if it.stop == Stop.NONE:
                layout.lay_out(it, given, piece, segment, node, line, log)
                events.begin(it, segment, node, line, log, tree)
                stock.settle(it, segment, node, line, log)
                stock.remember(segment)
        if it.stop < Stop.DONE:
            it.stop = play(it, segment, node, line, log, tree)
            if it.stop == Stop.FULL:
                return False
            events.close_books(it, node, it.now)
            stock.settle(it, segment, node, line, log)
            if it.further:
                scales(it, segment, line, log)
            if it.reads:
                stock.read(it, segment, line, log)
        tell(it, segment, node, part)
        it.member += 1
    return True


def tell(run: Any, segment: Any, node: Any, part: Any) -> None:
    """Tell what a member has come to."""
    tick, time, first = run.tick, run.now * run.tick, run.member * len(node)
    for k in range(len(node)):
        it, own, at = part[first + k], segment[k], node[k]
        it.before, it.after = own.initial + run.frame, own.velocity + run.frame
        it.momentum, it.parted = own.initial_momentum * tick, own.parted
        it.impulse, it.peak_force = at.impulse * tick, at.peak
        it.carried = at.impulse * tick * time - at.lever * tick * tick
        it.duration, it.episodes = at.pressed * tick, at.episodes
    it, energy = part[first], 0.0
    for s in range(len(segment)):
        energy += segment[s].vibration
    it.stop, it.proved = run.stop, 0 if run.proved == NONE else 1
    it.vibration, it.time, it.frame = energy * tick, time, run.frame


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
