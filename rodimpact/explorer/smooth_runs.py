"""Runs of the kernels of characteristics, for the page: compliant contacts and rigid masses.

Plain Python around the kernels of the method, which the page has as JavaScript.
"""

from __future__ import annotations

from typing import Any

from ..methods.abilities import has_driven_end
from ..methods.compiling import blank
from ..methods.laws import Stop
from ..methods.pieces import accuracy, layout, march
from ..methods.pieces.accuracy import Ended
from ..methods.pieces.layout import Asked, Clock
from ..methods.pieces.records import NONE, PIECE, TURN
from ..methods.pieces.series import N
from ..methods.walk import frame_of, largest, scale_of, wave_of_strain

ROOM = 512  # of the log at first


def clock_of(row: Any, until: Any) -> Any:
    """The clock of a row with rods; None where times are too far apart for it."""
    transits, scale = [s.transit_time for s in row.segments], scale_of(row)
    reference, scale = largest(transits), scale if scale > 0 else 1.0
    end = layout.horizon_of(row, reference, scale) if until is None else until
    total, made = layout.count_ticks(transits, reference, end)
    if total == 0 or any(ticks <= 4096 for ticks in made):
        return None
    tick = reference / total
    return Clock(tick, made, round(end / tick), reference, frame_of(row), scale)


def waves_at_start(row: Any, clock: Clock) -> Any:
    """Pieces of all lines that are known at t = 0, and lines of what comes from outside."""
    pieces, outside, last = [], [], len(row.segments) - 1
    for i, body in enumerate(row.system.bodies):
        for s in range(row.spans[i][0] - 1, row.spans[i][1]):
            stretch = body.strain * row.segments[s].wave_speed
            pieces.extend(layout.under_way(
                body.velocity - clock.frame, stretch, clock.transits[s]))
    for side, (kind, value) in enumerate(row.outside):
        k, came, factor = side * (last + 1), 0.0, 1.0
        if kind == "none" and row.first[k] == row.first[k + 1]:
            outside.append(NONE)
            continue
        if kind == "velocity":
            came = -clock.frame
        elif kind == "absorbing":
            came = pieces[2 * last + 1 if side == 1 else 0].coefficient[0]
            factor = wave_of_strain(row, side)
        outside.append(len(pieces))
        pieces.append(layout.steady(came + value * factor))
    return pieces, outside


def run_of(row: Any, asked: Any, tolerance: float, keep: bool, earlier: Any) -> Any:
    """Run a row; like an `earlier` run at a finer tolerance, where there is one.

    Returns
    -------
    dict
        The `row`, ``ended``, the records of `Ended`; ``line``, ``mass``, ``log``,
        ``turn``, ``clock``; or None where times are too far apart for the clock.
    """
    until = asked.until if asked.until >= 0 else None
    clock = clock_of(row, until)
    if clock is None:
        return None
    log, outside = waves_at_start(row, clock)
    for l in range(len(log)):
        log[l].line = l
    wanted = Asked(until, tolerance, asked.max_events, keep, not has_driven_end(row.system))
    runs, node, link, mass, line, part = layout.lay_out(row, clock, wanted, log, outside)
    run, turn = runs[0], blank(ROOM + march.FLIPS, TURN)
    log.extend(blank(ROOM, PIECE))
    if earlier is not None:
        accuracy.compare(earlier["ended"].run, run)
    longest = 1
    for at in node:
        longest = max(longest, at.links)
    size = N * longest
    matrix = [[0.0] * (size + 1) for _ in range(size)]
    while march.follow(
        runs, node, link, mass, line, part, log, turn, matrix
    ) == Stop.FULL:
        log.extend(blank(len(log), PIECE))
        turn.extend(blank(len(turn), TURN))
    now = run.end
    for at in node:
        now = min(now, at.now)
    return {"row": row, "ended": Ended(run, link, part),
            "line": line, "mass": mass, "log": log, "turn": turn, "clock": clock,
            "now": now, "until": asked.until}


def solved(row: Any, asked: Any, tolerance: float) -> Any:
    """A run with the stated ``errors`` of the `MEASURES`; None as of `run_of`."""
    fine, coarser = run_of(row, asked, tolerance, True, None), accuracy.COARSER * tolerance
    errors = [0.0 for _ in range(5)]
    if fine is None or fine["ended"].run.stop == Stop.STUCK:
        return fine
    while all(error == 0 for error in errors) and coarser <= accuracy.COARSEST:
        coarse = run_of(row, asked, coarser, False, fine)
        errors = accuracy.apart(fine["ended"], coarse["ended"])
        coarser *= accuracy.COARSER  # the same steps tell nothing
    left = accuracy.left_open(fine["ended"].run, 0.0)
    for T in fine["clock"].transits:  # which are rounded to whole ticks
        left = max(left, 1 / T)
    return {**fine, "errors": [error + left for error in errors], "goal": tolerance}
