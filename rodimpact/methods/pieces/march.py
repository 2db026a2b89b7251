"""The loop over nodes: the one furthest behind goes next, up to what is known of its inputs.

A node can always go on by the shortest transit beside it, so there is no common time step
(conservative simulation of Chandy and Misra, IEEE Trans. Software Eng. SE-5, 1979). One step is:
limit of what is known, inputs at the points of a piece, collocation, first event, what leaves.
"""

import math
from typing import Any

from .. import contact_laws
from ..states import Status, Stop
from . import events, finality, lines, nodes, series
from .records import HARD, NEVER, NONE
from .series import N

FLIPS = 1000  # changes of status at one instant: beyond, none of them lasts, and none matters
SHORTEST = 16  # ticks of a piece that is taken however rough it is
ROOM = 4  # pieces that a link may add in a step


def borrowed(array: Any) -> Any:
    """Return the array itself; compiled, one to which references are not counted."""
    return array


def follow(
    runs: Any,
    node: Any,
    link: Any,
    mass: Any,
    line: Any,
    part: Any,
    log: Any,
    turn: Any,
    G: Any,
) -> int:
    """Run to `run.end`, or to the proof that nothing meets any more and `run.extra` ticks more.

    All state is in the records: a run that has no room left goes on once it has more.

    Returns
    -------
    int
        A `Stop`.
    """
    run = runs[0]
    node = borrowed(node)
    link = borrowed(link)
    mass = borrowed(mass)
    line = borrowed(line)
    part = borrowed(part)
    log = borrowed(log)
    turn = borrowed(turn)
    G = borrowed(G)
    room = 2 + ROOM * len(link) + len(mass)
    run.stop = Stop.NONE.value
    while run.stop == Stop.NONE:
        at = node[behind(node)]
        due = run.surveyed == NONE or at.now >= min(run.end, run.check)
        if not due and run.steps >= run.limit:
            run.stop = Stop.CAP.value
        elif not due and (
            run.pieces + room > len(log) or run.turns + len(link) + FLIPS > len(turn)
        ):
            run.stop = Stop.FULL.value
        if due or run.stop == Stop.CAP:
            finality.look(run, link, mass, line, log, part, min(at.now, run.end))
        elif run.stop == Stop.NONE:
            run.steps += 1
            if at.mirror:
                at.now = lines.reflect(run, line, log, at)
            elif not advance(run, node, link, mass, line, log, turn, G, at):
                run.stop = Stop.STUCK.value
    return int(run.stop)


def behind(node: Any) -> int:
    """The node furthest behind."""
    k = 0
    for i in range(1, len(node)):
        if node[i].now < node[k].now:
            k = i
    return k


def advance(
    run: Any,
    node: Any,
    link: Any,
    mass: Any,
    line: Any,
    log: Any,
    turn: Any,
    G: Any,
    at: Any,
) -> bool:
    """Take one step of a node; return whether there was a solution."""
    tick = at.now
    for side in range(2):
        lines.move_on(line, log, at.source[side], tick)
    left = lines.order_at(line, log, at.source[0], tick)
    right = lines.order_at(line, log, at.source[1], tick)
    end = horizon(run, line, log, at, left <= HARD or right <= HARD)
    ticks, worst, where, which, status = solve(
        run, link, mass, line, log, turn, at, end - tick, G
    )
    if ticks == 0:
        return False
    full = ticks
    if which != NONE:
        rounding = 0.5
        if status == Status.PLASTIC:
            rounding = 0.0  # the force stays below that at which the contact yields
        ticks = max(1, int(0.5 * (where + 1) * full + rounding))
        if full - ticks <= run.window and link[which].status == Status.OPEN:
            ticks = full  # and with what arrives at the end
        if (
            ticks < full and at.rough
        ):  # means over the shorter time, or momentum would be lost
            take_inputs(line, log, at, ticks)
            nodes.collocate(run, link, mass, at, ticks * run.tick, G)
        elif ticks < full:
            nodes.restrict_piece(link, mass, at, 2 * ticks / full - 1)
    limited = at.rough == 1 or (
        full == end - tick and full < at.length
    )  # and not by smoothness
    if at.rough == 0 and full > SHORTEST:
        run.roughest = max(run.roughest, worst)
    if at.rough == 0 and limited:
        # a run at another tolerance takes the same step, and does not show its error;
        # values decide when an event is, integrals all else
        error = nodes.remainder(link, at, which == NONE)
        run.shared = max(run.shared, ticks / run.shortest * error)
    nodes.forbid_pulling(link, at)
    leave(run, link, line, log, at, ticks, left, right)
    events.record(run, link, mass, line, log, turn, at, ticks)
    if at.rough:
        run.rough += 1
        if run.first_rough == NONE:
            run.first_rough = tick
    if which != NONE:
        for side in range(2):
            at.incoming[side][0] = at.incoming[side][N]
        events.happen(run, link, mass, turn, at, tick + ticks, which, status)
        if status == Status.OPEN and run.check < NEVER:
            run.check = tick + ticks
            for i in range(len(node)):  # to which some node may have come already
                run.check = max(run.check, node[i].now)
    at.now = tick + ticks
    grow = 4.0 if worst <= 0 else min(4.0, 0.9 * (run.tolerance / worst) ** (1 / N))
    wish = int(full * max(0.25, grow)) + 1
    at.length = max(at.length, wish) if limited else wish
    return True


def horizon(run: Any, line: Any, log: Any, at: Any, broken: bool) -> int:
    """End of the next piece; sets whether hard breaks are too dense there.

    Where more of them are under way than there are floors in a transit, they are not followed one
    by one: cost would grow without end.
    """
    tick, l, r = at.now, at.source[0], at.source[1]
    known = min(
        run.end, lines.known_until(line, log, l), lines.known_until(line, log, r)
    )
    if run.check > tick:
        known = min(known, run.check)
    end = min(known, tick + at.length)
    end = lines.next_break(line, log, l, tick, end)
    end = lines.next_break(line, log, r, tick, end)
    dense = end < min(known, tick + run.floor)
    if (
        dense
        and is_dense(run, line, log, l, tick) + is_dense(run, line, log, r, tick) > 0
    ):
        at.rough = 1
        return int(min(known, tick + run.floor))
    at.rough = 0
    if broken:  # after a break about as long as what comes in is smooth
        for source in (l, r):
            if lines.order_at(line, log, source, tick) <= HARD:
                piece = log[line[source].head]
                end = min(end, tick + 2 * (piece.stop - piece.start))
    return end


def is_dense(run: Any, line: Any, log: Any, l: int, tick: int) -> bool:
    """Whether more hard breaks are under way in a line than the floor allows."""
    unread = lines.known_until(line, log, l) - tick
    return bool(line[l].hard * run.floor > 2 * max(unread, run.shortest))


def solve(
    run: Any,
    link: Any,
    mass: Any,
    line: Any,
    log: Any,
    turn: Any,
    at: Any,
    ticks: int,
    G: Any,
) -> tuple[int, float, float, int, int]:
    """Solve a node on a piece as long as it turns out smooth; events at its start come first.

    Returns
    -------
    int, float, float, int, int
        Its ticks, 0 without a solution; its tail; where its first event is, in which link, to what.
    """
    flips, tried, rough_before = 0, ticks, 0.0
    while True:
        h = ticks * run.tick
        take_inputs(line, log, at, ticks)
        worst = -1.0
        if nodes.collocate(run, link, mass, at, h, G):
            worst = nodes.roughness(link, mass, at)
        if worst >= 0 and (worst <= run.tolerance or at.rough or ticks <= SHORTEST):
            where, which, status = nodes.next_event(run, link, at, h)
            closes = which != NONE and link[which].status == Status.OPEN
            soon = (
                run.window if closes else 0.5
            )  # it closes with what arrives at the start
            if which == NONE or 0.5 * (where + 1) * ticks >= soon:
                return ticks, worst, where, which, status
            flips += 1
            if flips > FLIPS:
                return ticks, worst, 1.0, NONE, 0
            if flips % (8 + at.links * at.links) == 0 and ticks > SHORTEST:
                ticks = max(SHORTEST, ticks // 10)  # no status lasts as long: a graze
            events.happen(run, link, mass, turn, at, at.now, which, status)
        elif ticks <= 1:
            return 0, worst, 1.0, NONE, 0
        else:
            part = shorter(run.tolerance, worst, tried, ticks, rough_before)
            tried, rough_before = ticks, worst
            ticks = max(1, int(ticks * part))


def take_inputs(line: Any, log: Any, at: Any, ticks: int) -> None:
    """Set what comes in from both sides over a piece."""
    for side in range(2):
        if at.rough:
            lines.project(line, log, at.source[side], at.now, ticks, at.incoming[side])
        else:
            lines.sample(line, log, at.source[side], at.now, ticks, at.incoming[side])


def shorter(
    tolerance: float, worst: float, tried: int, ticks: int, before: float
) -> float:
    """Part of a piece that may be smooth enough, from its tail and that of a longer one before.

    After a touch the force starts like a power of time, often 3/2, and the tail falls as slowly.
    """
    if worst <= 0:
        return 0.25
    power = 1.0 * N
    if before > worst:
        power = max(1.0, min(power, math.log(before / worst) / math.log(tried / ticks)))
    return max(
        0.1 if power > 4 else 1e-4, min(0.6, 0.8 * (tolerance / worst) ** (1 / power))
    )


def leave(
    run: Any, link: Any, line: Any, log: Any, at: Any, ticks: int, left: int, right: int
) -> None:
    """Send what leaves a node. Each spring and mass of a chain makes breaks one order smoother."""
    over, back = left, right
    for q in range(at.links):
        over = contact_laws.break_order(link[at.first + q], over) + 1
        back = contact_laws.break_order(link[at.first + at.links - 1 - q], back) + 1
    for side in range(2):
        if at.target[side] == NONE:
            continue
        nodes.set_leaving(link, at, side)
        order = min(right, over - 1) if side else min(left, back - 1)
        if at.rough:
            series.flatten(at.leaving)
            order = 0
        lines.send(run, line, log, at.target[side], at, ticks, order)
