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
from ..methods.pieces.layout import Asked, Clock, Known
from ..methods.pieces.records import NONE, PIECE, TURN
from ..methods.pieces.series import N
from ..methods.scales import largest
from ..methods.walk import frame_of, scale_of, wave_of_strain

ROOM = 512  # of the log at first


def given_of(row: Any) -> Any:
    """What is given of a row with rods, as `layout` has it."""
    scale = scale_of(row)
    return layout.given_of(row, largest([s.transit_time for s in row.segments]), frame_of(row),
                           scale if scale > 0 else 1.0)


def waves_at_start(row: Any, given: Any, clock: Clock) -> Any:
    """Pieces of all lines that are known at t = 0, and lines of what comes from outside."""
    pieces, outside, last = [], [], len(row.segments) - 1
    for i, body in enumerate(row.system.bodies):
        for s in range(row.spans[i][0] - 1, row.spans[i][1]):
            stretch = body.strain * row.segments[s].wave_speed
            pieces.extend(layout.under_way(
                body.velocity - given.frame, stretch, clock.transits[s]))
    for side, (kind, value) in enumerate(row.outside):
        k, came, factor = side * (last + 1), 0.0, 1.0
        if kind == "none" and given.first[k] == given.first[k + 1]:
            outside.append(NONE)
            continue
        if kind == "velocity":
            came = -given.frame
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
        The `row`, what is `given`, ``ended``, the records of `Ended`; ``line``, ``mass``, ``log``,
        ``turn``, ``clock``; or None where times are too far apart for the clock.
    """
    given, until = given_of(row), asked.until if asked.until >= 0 else None
    end = layout.horizon_of(given) if until is None else until
    total, made = layout.count_ticks(given.transit, given.reference, end)
    if total == 0 or any(ticks <= 4096 for ticks in made):
        return None
    tick = given.reference / total
    clock = Clock(tick, made, round(end / tick))
    log, outside = waves_at_start(row, given, clock)
    starts = [Known(piece.start, piece.stop, 1, 0) for piece in log]
    wanted = Asked(until, tolerance, asked.max_events, keep, not has_driven_end(row.system))
    laid = layout.lay_out(given, clock, wanted, starts, outside)
    run, turn = laid.run[0], blank(ROOM + march.FLIPS, TURN)
    run.pieces = len(log)
    for l in range(len(log)):
        log[l].line = l
    log.extend(blank(ROOM, PIECE))
    if earlier is not None:
        accuracy.compare(earlier["ended"].run, run)
    longest = 1
    for at in laid.node:
        longest = max(longest, at.links)
    size = N * (2 * longest - 1)
    matrix = [[0.0] * (size + 1) for _ in range(size)]
    while march.follow(
        laid.run, laid.node, laid.link, laid.mass, laid.line, log, turn, laid.part, matrix
    ) == Stop.FULL:
        log.extend(blank(len(log), PIECE))
        turn.extend(blank(len(turn), TURN))
    now = run.end
    for at in laid.node:
        now = min(now, at.now)
    return {"row": row, "given": given, "ended": Ended(run, laid.link, laid.part),
            "line": laid.line, "mass": laid.mass, "log": log, "turn": turn, "clock": clock,
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
