"""Runs of the kernels of characteristics, for the page: compliant contacts and rigid masses.

Plain Python around the kernels of the method, which the page has as JavaScript.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ..methods import scales
from ..methods.compiling import blank
from ..methods.laws import Law, Stop
from ..methods.pieces import accuracy, layout, march
from ..methods.pieces.accuracy import Ended
from ..methods.pieces.layout import Asked, Clock, Given, Known
from ..methods.pieces.method import RTOL
from ..methods.pieces.records import NONE, PIECE, TURN
from ..methods.pieces.series import N

ROOM = 512  # of the log at first
COMPLIANT = ("spring", "spring-dashpot", "hertz", "hunt-crossley", "power")


class Link(NamedTuple):
    """What a contact or an end is, in numbers."""

    law: int
    stiffness: float
    exponent: float
    damping: float
    gap: float


def given_of(row: Any, contacts: Any) -> Any:
    """What is given of a row, as `layout` has it; `links` of the contacts; and what comes in.

    Parameters
    ----------
    row : dict
        As `row_of` makes it.
    contacts : list of dict
        The tables of the contacts.
    """
    bodies, segments, own = row["bodies"], row["segments"], []
    links: list[Link] = []
    first, masses, speeds = [0], [], []
    outside = [outside_of(row, 0), outside_of(row, 1)]
    for i, body in enumerate(bodies):
        if i > 0:
            own.append(len(links))
            links.append(link_of(contacts[i - 1]))
        elif body["kind"] != "wall":
            links.append(end_of(outside[0][0], 0))
        if body["kind"] == "mass":
            masses.append(body["mass"])
            speeds.append(body["velocity"])
        for s in range(body["first"], body["last"] + 1):
            if s > body["first"]:
                links.append(Link(Law.BOND.value, 0.0, 1.0, 0.0, 0.0))
            first.append(len(masses))
    if bodies[-1]["kind"] != "wall":
        links.append(end_of(outside[1][0], 1))
    first.append(len(masses))
    frame, scale = scales_of(row, outside, speeds)
    transit = [piece["transit_time"] for piece in segments]
    given = Given(
        first,
        [(body["first"] - 1, body["last"]) for body in bodies],
        [it.law for it in links], [it.stiffness for it in links], [it.exponent for it in links],
        [it.damping for it in links], [0.0 for _ in links], [it.gap for it in links],
        masses, speeds,
        transit, [piece["impedance"] for piece in segments], [piece["mass"] for piece in segments],
        [kind for kind, _ in outside], any(bonded for bonded in row["bonded"]),
        scales.largest(transit), frame, scale if scale > 0 else 1.0,
    )
    return {"given": given, "links": own, "comes": [value for _, value in outside]}


def outside_of(row: Any, side: int) -> Any:
    """Kind and value of what is outside the left or the right end."""
    body, kind = row["bodies"][side * (len(row["bodies"]) - 1)], row["ends"][side]
    if body["kind"] == "wall":
        return "velocity", body["velocity"]
    if kind in ("fixed", "velocity"):
        return "velocity", row["values"][side]
    if kind in ("absorbing", "incoming"):
        return "absorbing", row["values"][side]
    return ("force" if kind == "force" else "none"), row["values"][side]


def end_of(kind: str, side: int) -> Link:
    """The link at an end of the row."""
    law = Law.BOND.value
    if kind in ("none", "force"):
        law = Law.PUSH_RIGHT.value if side else Law.PUSH_LEFT.value
    return Link(law, 0.0, 1.0, 0.0, 0.0)


def link_of(contact: Any) -> Link:
    """The link of a contact."""
    law, gap, e = contact.get("law", "rigid"), contact.get("gap", 0.0), contact.get("restitution")
    if law == "bonded":
        return Link(Law.BOND.value, 0.0, 1.0, 0.0, 0.0)
    if law == "rigid":
        kind = Law.RIGID.value if e is None else Law.IMPACT.value
        return Link(kind, 0.0, 1.0, 0.0 if e is None else e, gap)
    spring = law in ("spring", "spring-dashpot")
    power = 1.0 if spring else contact.get("exponent", 1.5)
    kind = Law.SPRING.value if spring else Law.POWER.value
    return Link(kind, contact["stiffness"], power, contact.get("damping", 0.0), gap)


def scales_of(row: Any, outside: Any, speeds: list[float]) -> Any:
    """Velocity of the frame, and scale of velocities, m/s."""
    walls, strained, pushed, segments = [], [], [], row["segments"]
    velocities = [*speeds]
    for body in row["bodies"]:
        if body["kind"] == "wall":
            walls.append(body["velocity"])
        if body["kind"] == "rod":
            inside = segments[body["first"] - 1 : body["last"]]
            fastest = scales.largest([piece["wave_speed"] for piece in inside])
            strained.append(fastest * abs(body["strain"]))
        if body["kind"] != "mass":
            velocities.append(body["velocity"])
    for side, (kind, value) in enumerate(outside):
        if kind == "velocity":
            velocities.append(value)
        elif kind == "force":
            pushed.append(abs(value))
        elif kind == "absorbing":
            end = segments[side * (len(segments) - 1)]
            strained.append(abs(value * 2 * end["wave_speed"]))
    weakest = scales.smallest([piece["impedance"] for piece in segments])
    return (scales.frame_of(walls, velocities),
            scales.scale_of(velocities, strained, pushed, weakest, 0.0))


def waves_at_start(row: Any, known: Any, clock: Clock) -> Any:
    """Pieces of all lines that are known at t = 0, and lines of what comes from outside."""
    given, pieces, outside = known["given"], [], []
    for body in row["bodies"]:
        for s in range(body["first"] - 1, body["last"]):
            stretch = body["strain"] * row["segments"][s]["wave_speed"]
            pieces.extend(layout.under_way(
                body["velocity"] - given.frame, stretch, clock.transits[s]))
    last = len(given.impedance) - 1
    for side, kind in enumerate(given.outside):
        k, value, came = side * (last + 1), known["comes"][side], 0.0
        if kind == "none" and given.first[k] == given.first[k + 1]:
            outside.append(NONE)
            continue
        if kind == "velocity":
            came = -given.frame
        elif kind == "absorbing":
            came = pieces[2 * last + 1 if side == 1 else 0].coefficient[0]
            value *= (4 * side - 2) * row["segments"][side * last]["wave_speed"]
        outside.append(len(pieces))
        pieces.append(layout.steady(came + value))
    return pieces, outside


def run_of(row: Any, known: Any, tolerance: float, keep: bool, earlier: Any) -> Any:
    """Run a row; like an `earlier` run at a finer tolerance, where there is one.

    Returns
    -------
    dict
        ``ended``, the records of `Ended`; ``line``, ``mass``, ``log``, ``turn``, ``clock``; or None
        where times are too far apart for the clock.
    """
    given, until = known["given"], row["until"] if row["until"] >= 0 else None
    end = layout.horizon_of(given) if until is None else until
    total, made = layout.count_ticks(given.transit, given.reference, end)
    if total == 0 or any(ticks <= 4096 for ticks in made):
        return None
    tick = given.reference / total
    clock = Clock(tick, made, round(end / tick))
    log, outside = waves_at_start(row, known, clock)
    starts = [Known(piece.start, piece.stop, 1, 0) for piece in log]
    driven = any(kind in ("force", "velocity", "incoming") for kind in row["ends"])
    asked = Asked(until, tolerance, row["max_events"], keep, not driven)
    laid = layout.lay_out(given, clock, asked, starts, outside)
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
    return {"ended": Ended(run, laid.link, laid.part), "line": laid.line, "mass": laid.mass,
            "log": log, "turn": turn, "clock": clock, "now": now}


def solved(row: Any, known: Any) -> Any:
    """A run with the stated ``errors`` of the `MEASURES`; None as of `run_of`."""
    fine, coarser = run_of(row, known, RTOL, True, None), accuracy.COARSER * RTOL
    errors = [0.0 for _ in range(5)]
    if fine is None or fine["ended"].run.stop == Stop.STUCK:
        return fine
    while all(error == 0 for error in errors) and coarser <= accuracy.COARSEST:
        coarse = run_of(row, known, coarser, False, fine)
        errors = accuracy.apart(fine["ended"], coarse["ended"])
        coarser *= accuracy.COARSER  # the same steps tell nothing
    left = accuracy.left_open(fine["ended"].run, 0.0)
    for T in fine["clock"].transits:  # which are rounded to whole ticks
        left = max(left, 1 / T)
    return {**fine, "errors": [error + left for error in errors]}
