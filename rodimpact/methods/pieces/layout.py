"""From the numbers of a row to the records that the kernels of this method work on.

The page has this as JavaScript. In Python a number is an array, with one number for each member of
a family: so nothing here is decided by a number but through `np.where`.
"""

from typing import Any, NamedTuple

import numpy as np

from ..abilities import driven
from ..clock import Clock
from ..link import FIELDS, Law, initial_gap
from ..record_lists import blank
from ..scales import largest
from ..states import Status
from .records import LINE, LINK, MASS, NEVER, NODE, NONE, PART, PIECE, RUN, SMOOTH, Part
from .series import POINTS, N

FLOORS = 128  # in the shortest transit
WINDOW = 2.0**-40  # of the longest transit: what comes nearer is taken together
NEAR = (
    1e-7  # of the velocity scale: over which the slopes of a law of the user are taken
)
PROOFS = 8  # in the longest transit at most: each looks at all waves under way
GRAZE = 2.0**-40  # of the velocity scale: forces that move no faster are none


class Asked(NamedTuple):
    """What a run is asked for: its end, s, if any; tolerance; cap on steps; what to keep."""

    until: Any
    tolerance: Any  # relative to the velocity scale
    limit: int
    keep: bool  # forces, overlaps and velocities of masses


# Waves at t = 0, and from outside -----------------------------------------------------------------


def piece_of(start: Any, stop: Any, values: Any) -> Any:
    """A piece with these coefficients."""
    it = blank(1, PIECE)[0]
    it.start, it.stop, it.order, it.after = start, stop, SMOOTH, NONE
    it.degree = N if len(values) > 1 else 0
    it.coefficient = [*values, *([0.0] * (POINTS - len(values)))]
    return it


def under_way(velocity: Any, stretch: Any, T: Any) -> list[Any]:
    """Waves in a segment of one velocity in the frame and one strain, that times the wave speed."""
    return [
        piece_of(-T, 0, [velocity - stretch]),
        piece_of(-T, 0, [velocity + stretch]),
    ]


def steady(value: Any) -> Any:
    """What comes from outside and does not change."""
    return piece_of(0, NEVER, [value])


# Records ------------------------------------------------------------------------------------------


def lay_out(
    row: Any,
    clock: Clock,
    asked: Asked,
    known: list[tuple[int, int, int]],
    outside: Any,
) -> list[list[Any]]:
    """Put a row on records; return lists of runs, nodes, links, masses, lines and parts.

    Parameters
    ----------
    row : Row or Walk
    clock : Clock
    asked : Asked
    known : list of (int, int, int)
        Of what is known at t = 0, line by line, the pieces, their hard breaks and their ticks: two
        lines a segment, to the right and to the left, then what comes from outside.
    outside : list of int
        Lines of what comes from outside the left and the right end; NONE at the free end of a rod.
    """
    shortest = np.rint(clock.reference / clock.tick)
    for T in clock.transits:
        shortest = np.minimum(shortest, T)
    node, mass = nodes_of(row, outside), blank(len(row.masses), MASS)
    link = links_of(row, clock, node, shortest * clock.tick)
    for m, body in enumerate(mass):
        body.mass, body.speed = (
            row.masses[m],
            [row.mass_velocity[m] - clock.frame] * POINTS,
        )
    part, n = parts_of(row, node, link, outside), len(known)
    line = lines_of(clock, known, n + (keep_lines(link, mass, n) if asked.keep else 0))
    run = run_of(row, clock, asked, shortest, known)
    if any(it.kind >= Part.WALL and it.parts != 1 for it in part):
        run.held = 1
    if asked.until is None and (
        run.held or asked.keep
    ):  # else no more than the proof is needed
        run.extra = 2 * longest_of(row, clock, shortest)
    for at in node:
        at.length = np.maximum(shortest // 8, 16)
    return [[run], node, link, mass, line, part]


def longest_of(row: Any, clock: Clock, shortest: Any) -> Any:
    """Ticks in which a wave goes through the longest body."""
    without_rods = 0 if len(clock.transits) > 0 else shortest
    return largest(
        [
            without_rods,
            *[sum(clock.transits[first - 1 : last]) for first, last in row.spans],
        ]
    )


def run_of(row: Any, clock: Clock, asked: Asked, shortest: Any, known: Any) -> Any:
    """The record of a run."""
    run, breaks = blank(1, RUN)[0], 0
    for pieces, hard, ticks in known:
        run.pieces += pieces
        if hard > 0:  # where hard breaks are given most densely
            breaks = np.maximum(breaks, np.floor(hard * (shortest / ticks)))
    run.tick, run.scale, run.tolerance = (
        clock.tick,
        clock.scale,
        asked.tolerance * clock.scale,
    )
    run.floor = np.maximum(shortest // (FLOORS + 4 * breaks), 64)
    run.shortest, run.graze = shortest, GRAZE * clock.scale
    run.window = np.maximum(np.rint(clock.reference / clock.tick * WINDOW), 1)
    run.end, run.limit, run.keep = clock.last_tick, asked.limit, 1 if asked.keep else 0
    run.proved = run.first_rough = run.surveyed = NONE
    longest = np.rint(clock.reference / clock.tick)
    run.proof_interval = np.maximum(shortest, longest // PROOFS)
    run.check = NEVER if driven(row.system) else run.proof_interval
    run.held = 0 if all(law.opens for law in row.system.contacts) else 1
    run.extra = 0 if asked.until is None else NEVER
    return run


def nodes_of(row: Any, outside: Any) -> list[Any]:
    """Nodes, with the lines that come in and go out."""
    n = len(row.segments)
    node = blank(n + 1, NODE)
    for k, at in enumerate(node):
        at.first, at.mass = k + row.first[k], row.first[k]
        at.links = row.first[k + 1] - row.first[k] + 1
        at.source, at.target = [2 * k - 2, 2 * k + 1], [2 * k - 1, 2 * k]
        for side in range(2):
            if 0 < k + side <= n:
                at.mobility[side] = 1 / row.segments[k + side - 1].impedance
    for side in range(2):
        end = node[side * n]
        end.source[side], end.target[side] = outside[side], NONE
        end.mirror = 1 if outside[side] == NONE else end.mirror
        if row.outside[side][0] == "absorbing":  # bonded to an endless rod
            end.mobility[side] = end.mobility[1 - side]
    return node


def links_of(row: Any, clock: Clock, node: list[Any], time: Any) -> list[Any]:
    """Links; `ease` is the velocity that a force makes in this time."""
    link = blank(len(row.links), LINK)
    for at in node:
        for q in range(at.links):
            it = link[at.first + q]
            set_law(it, row.links[at.first + q], at.first + q)
            last = q == at.links - 1
            it.mobility = (at.mobility[0] if q == 0 else 0.0) + (
                at.mobility[1] if last else 0.0
            )
            it.ease = it.mobility
            for m in range(max(q - 1, 0), q if last else q + 1):
                it.ease = it.ease + time / row.masses[at.mass + m]
            if it.law == Law.IMPACT:
                it.resting_force = clock.scale / it.ease
            elif it.law == Law.OWN:
                it.near, it.near_rate = NEAR * clock.scale * time, NEAR * clock.scale
    return link


def set_law(it: Any, given: Any, i: int) -> None:
    """Set the law of link i of a row, its numbers and its status."""
    it.left_group = it.right_group = it.first = it.last = it.apart = NONE
    it.order, it.opened, it.function = SMOOTH, 1, i
    it.status, it.touch = Status.BOND.value, Status.OPEN.value
    for name in FIELDS:
        setattr(it, name, getattr(given, name))
    it.overlap = -initial_gap(given)
    if it.law == Law.IMPACT:  # what touches is struck by the first look at it
        it.status = Status.OPEN.value
    elif it.law >= Law.RIGID:
        it.status = np.where(given.gap > 0, Status.OPEN.value, Status.PRESS.value)


def keep_lines(link: list[Any], mass: list[Any], first: int) -> int:
    """Number the lines that keep what happens in links and masses; return how many there are."""
    l = first
    for it in link:
        it.kept = l
        l += 3 if it.law == Law.YIELD else 2 if it.law >= Law.JOINT else 1
    for body in mass:
        body.line = l
        l += 1
    return l - first


def lines_of(clock: Clock, known: Any, count: int) -> list[Any]:
    """Lines, of which the pieces that are known stand at the beginning of the log."""
    line, first = blank(count, LINE), 0
    for it in line[len(known) :]:
        it.first = it.head = it.tail = NONE
    for l, (pieces, hard, _) in enumerate(known):
        line[l].first = line[l].head = first
        first += pieces
        line[l].tail, line[l].hard = first - 1, hard
    for l in range(2 * len(clock.transits)):
        line[l].delay = clock.transits[l // 2]
    return line


def parts_of(row: Any, node: list[Any], link: list[Any], outside: Any) -> list[Any]:
    """What groups of bodies between contacts that open are made of, from left to right."""
    part: list[Any] = []
    head, n = 0, len(row.segments)
    add_ground(part, head, row.outside[0][0], outside[0])
    for k in range(n + 1):
        at = node[k]
        for q in range(at.links):
            it = link[at.first + q]
            if it.law >= Law.RIGID:
                it.left_group, it.right_group, head = head, len(part), len(part)
            elif it.law == Law.JOINT:
                stiff = it.stiffness > 0
                gives = np.where(stiff, 1 / np.where(stiff, it.stiffness, 1.0), 0.0)
                add_part(part, head, Part.JOINT.value, at.first + q, 0.0, gives)
            if q < at.links - 1:
                m = at.mass + q
                add_part(part, head, Part.MASS.value, m, row.masses[m], 0.0)
        if k < n:
            it = row.segments[k]
            add_part(
                part,
                head,
                Part.SEGMENT.value,
                k,
                it.mass,
                it.transit_time / it.impedance,
            )
    add_ground(part, head, row.outside[1][0], outside[1])
    return part


def add_part(
    part: list[Any], head: int, kind: int, index: int, mass: Any, compliance: Any
) -> None:
    """Add a part to the group that begins with part `head`."""
    it = blank(1, PART)[0]
    it.kind, it.index, it.mass, it.compliance, it.held = (
        kind,
        index,
        mass,
        compliance,
        NONE,
    )
    part.append(it)
    part[head].parts += 1


def add_ground(part: list[Any], head: int, kind: str, line: int) -> None:
    """Add what holds an end of the row, with the line of what comes from there."""
    if kind in ("absorbing", "velocity"):
        endless = kind == "absorbing"
        what = Part.ENDLESS.value if endless else Part.WALL.value
        add_part(part, head, what, NONE, 0.0, 1e300 if endless else 0.0)
        part[head].held = line
