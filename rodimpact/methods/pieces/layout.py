"""From the numbers of a row to the records that the kernels of this method work on.

The page has this as JavaScript. In Python a number is an array, with one number for each member of
a family: so nothing here is decided by a number but through `np.where`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .. import tick_rule as rule
from ..compiling import blank
from ..laws import KNOTS, UNREACHED, Law, Status
from . import finality
from .records import LINE, LINK, MASS, NEVER, NODE, NONE, PART, PIECE, RUN, SMOOTH, Part
from .series import POINTS, N

FLOORS = 128  # in the shortest transit
WINDOW = 2.0**-40  # of the longest transit: what comes nearer is taken together
NEAR = 1e-7  # of the velocity scale: over which the slopes of a law of the user are taken
GRAZE = 2.0**-40  # of the velocity scale: forces that move no faster are none


class Given(NamedTuple):
    """What is given of a row; links, masses and segments are counted from 0, from left to right.

    Attributes
    ----------
    first : list of int
        Masses left of each node, and of all.
    spans : list of (int, int)
        By body, its first segment and the one behind its last.
    laws : list of Law
        By link.
    stiffness, exponent, damping, strength, gap, table : list
        By link; `damping` of an impact is its coefficient of restitution, and of what yields the
        hardening as a share of the stiffness; the gap of a joint is its stretch.
    masses, mass_velocity : list
        kg, m/s.
    transit, impedance, weight : list
        By segment: s, kg/s, kg.
    outside : list of str
        Left and right: "none", "velocity", "force" or "absorbing".
    joined : bool
        Whether bodies are bonded or joined.
    reference, frame, scale
        The longest transit or what stands for it, s; velocities of the frame and their scale, m/s.
    """

    first: Any
    spans: Any
    laws: Any
    stiffness: Any
    exponent: Any
    damping: Any
    strength: Any
    gap: Any
    table: Any
    masses: Any
    mass_velocity: Any
    transit: Any
    impedance: Any
    weight: Any
    outside: Any
    joined: Any
    reference: Any
    frame: Any
    scale: Any


class Clock(NamedTuple):
    """Duration of a tick, s, the transits of all segments in ticks, and the last tick."""

    tick: Any
    transits: Any
    last: Any


class Asked(NamedTuple):
    """What a run is asked for: its end, s, if any; tolerance; cap on steps; what to keep."""

    until: Any
    tolerance: Any  # relative to the velocity scale
    limit: int
    keep: bool  # forces, overlaps and velocities of masses
    prove: bool  # that the collision is final


class Known(NamedTuple):
    """What is known at t = 0 of a line: ticks of its start and stop, its pieces and hard breaks."""

    start: Any
    stop: Any
    pieces: int
    hard: Any


class Laid(NamedTuple):
    """Lists of records."""

    run: Any
    node: Any
    link: Any
    mass: Any
    line: Any
    part: Any


def given_of(row: Any, reference: Any, frame: Any, scale: Any) -> Given:
    """What is given of a `Row` or `Walk`; frame and scale of velocities, m/s."""
    return Given(
        row.first, [(first - 1, last) for first, last in row.spans],
        [int(law) for law in row.laws], row.stiffness, row.exponent, row.damping, row.strength,
        row.gap, row.table, row.masses, row.mass_velocity,
        [s.transit_time for s in row.segments], [s.impedance for s in row.segments],
        [s.mass for s in row.segments],
        [kind for kind, _ in row.outside],
        not all(law.opens for law in row.system.contacts), reference, frame, scale)


# The clock ----------------------------------------------------------------------------------------


def horizon_of(given: Given) -> Any:
    """Time for which the clock has room where no end is asked for, s."""
    total, flight = 0.0, 0.0
    for transit in given.transit:
        total = total + transit
    for gap in given.gap:
        flight = flight + np.maximum(gap, 0.0)
    horizon = np.maximum(rule.HORIZON * given.reference, 16 * total)
    horizon = np.maximum(horizon, 4 * flight / given.scale)
    return np.minimum(horizon, given.reference * 2.0 ** (rule.CLOCK_BITS - 1 - rule.COARSEST))


def count_ticks(durations: list[float], longest: float, end: float) -> tuple[int, list[int]]:
    """Ticks of the longest transit and of all durations of one member.

    There are none if the clock cannot count to the end.
    """
    bits = rule.clock_bits(end / longest)
    if bits < rule.COARSEST:
        return 0, []
    span = blank(len(durations), rule.SPAN)
    for i in range(len(span)):
        span[i].time = durations[i]
    total = rule.assign_ticks(span, bits) if len(span) > 0 else 1 << bits
    return total, [one.ticks for one in span]


# Waves at t = 0, and from outside -----------------------------------------------------------------


def piece_of(start: Any, stop: Any, values: Any) -> Any:
    """A piece with these coefficients."""
    it = blank(1, PIECE)[0]
    it.start, it.stop, it.order, it.after = start, stop, SMOOTH, NONE
    it.degree = N if len(values) > 1 else 0
    for m in range(len(values)):
        it.coefficient[m] = values[m]
    return it


def under_way(velocity: Any, stretch: Any, T: Any) -> list[Any]:
    """Waves in a segment of one velocity in the frame and one strain, that times the wave speed."""
    return [piece_of(-T, 0, [velocity - stretch]), piece_of(-T, 0, [velocity + stretch])]


def steady(value: Any) -> Any:
    """What comes from outside and does not change."""
    return piece_of(0, NEVER, [value])


def falling(value: Any, gravity: Any, until: Any, tick: Any) -> Any:
    """The velocity of a wall as a frame sees it that falls."""
    stop = np.rint(until / tick) + 1
    half = -gravity * stop * tick / 2
    return piece_of(0, stop, [value + half, half])


# Records ------------------------------------------------------------------------------------------


def lay_out(given: Given, clock: Clock, asked: Asked, known: list[Known], outside: Any) -> Laid:
    """Put a row on records.

    Parameters
    ----------
    given : Given
    clock : Clock
    asked : Asked
    known : list of Known
        Lines: two a segment, to the right and to the left, then what comes from outside.
    outside : list of int
        Lines of what comes from outside the left and the right end; NONE at the free end of a rod.
    """
    shortest = np.rint(given.reference / clock.tick)
    for T in clock.transits:
        shortest = np.minimum(shortest, T)
    node, mass = nodes_of(given, outside), blank(len(given.masses), MASS)
    link = links_of(given, node, shortest * clock.tick)
    for m in range(len(mass)):
        mass[m].mass, mass[m].line = given.masses[m], NONE
        for j in range(POINTS):
            mass[m].speed[j] = given.mass_velocity[m] - given.frame
    part = parts_of(given, node, link, outside)
    extra = keep_lines(link, mass, len(known)) if asked.keep else 0
    run = run_of(given, clock, asked, shortest, known)
    for p in range(len(part)):
        if part[p].kind == Part.GROUND and part[p].parts != 1:
            run.held = 1
    if asked.until is None and (run.held or asked.keep):  # else no more than the proof is needed
        run.extra = 2 * longest_of(given, clock, shortest)
    for at in node:
        at.length = np.maximum(shortest // 8, 16)
    return Laid([run], node, link, mass, lines_of(clock, known, extra), part)


def longest_of(given: Given, clock: Clock, shortest: Any) -> Any:
    """Ticks in which a wave goes through the longest body."""
    longest = 0 if len(clock.transits) > 0 else shortest
    for first, stop in given.spans:
        span = 0
        for s in range(first, stop):
            span = span + clock.transits[s]
        longest = np.maximum(longest, span)
    return longest


def run_of(given: Given, clock: Clock, asked: Asked, shortest: Any, known: list[Known]) -> Any:
    """The record of a run."""
    run, breaks = blank(1, RUN)[0], 0
    for line in known:  # where hard breaks are given most densely
        span = np.maximum(line.stop - line.start, 1)
        breaks = np.maximum(breaks, np.floor(line.hard * (shortest / span)))
    run.tick, run.scale, run.tolerance = clock.tick, given.scale, asked.tolerance * given.scale
    run.floor = np.maximum(shortest // (FLOORS + 4 * breaks), 64)
    run.shortest, run.graze = shortest, GRAZE * given.scale
    run.window = np.maximum(np.rint(given.reference / clock.tick * WINDOW), 1)
    run.end, run.limit, run.keep = clock.last, asked.limit, 1 if asked.keep else 0
    run.proved = run.first_rough = run.surveyed = NONE
    run.prove, run.check = 1 if asked.prove else 0, shortest if asked.prove else NEVER
    run.held, run.extra = 1 if given.joined else 0, 0 if asked.until is None else NEVER
    return run


def nodes_of(given: Given, outside: Any) -> list[Any]:
    """Nodes, with the lines that come in and go out."""
    n = len(given.impedance)
    node = blank(n + 1, NODE)
    for k in range(n + 1):
        at = node[k]
        at.first, at.mass = k + given.first[k], given.first[k]
        at.links = given.first[k + 1] - given.first[k] + 1
        at.in_left = at.in_right = at.out_left = at.out_right = at.speed_line = NONE
        if k > 0:
            at.in_left, at.out_left = 2 * k - 2, 2 * k - 1
            at.mobility_left = 1 / given.impedance[k - 1]
        if k < n:
            at.in_right, at.out_right = 2 * k + 1, 2 * k
            at.mobility_right = 1 / given.impedance[k]
    left, right = node[0], node[n]
    left.in_left, right.in_right = outside[0], outside[1]
    if outside[0] == NONE:
        left.mirror = 1
    if outside[1] == NONE:
        right.mirror = 1
    if given.outside[0] == "absorbing":  # bonded to an endless rod
        left.mobility_left = left.mobility_right
    if given.outside[1] == "absorbing":
        right.mobility_right = right.mobility_left
    return node


def links_of(given: Given, node: list[Any], time: Any) -> list[Any]:
    """Links; `ease` is the velocity that a force makes in this time."""
    link = blank(len(given.laws), LINK)
    for at in node:
        for q in range(at.links):
            it = link[at.first + q]
            set_law(it, given, at.first + q)
            if q == 0:
                it.mobility = it.mobility + at.mobility_left
            if q == at.links - 1:
                it.mobility = it.mobility + at.mobility_right
            it.ease = it.mobility
            if q > 0:
                it.ease = it.ease + time / given.masses[at.mass + q - 1]
            if q < at.links - 1:
                it.ease = it.ease + time / given.masses[at.mass + q]
            if it.law == Law.IMPACT:
                it.strength = given.scale / it.ease  # the force that is one
            elif it.law == Law.OWN:
                it.near, it.near_rate = NEAR * given.scale * time, NEAR * given.scale
    return link


def set_law(it: Any, given: Given, i: int) -> None:
    """Set the law of link i, its numbers and its status."""
    it.force_line = it.overlap_line = it.closing_line = it.left_group = it.right_group = NONE
    it.first = it.last = it.apart = NONE
    it.order, it.opened, it.law = SMOOTH, 1, given.laws[i]
    it.status, it.touch = Status.BOND.value, Status.OPEN.value
    it.stiffness, it.exponent = given.stiffness[i], given.exponent[i]
    it.strength, it.overlap = given.strength[i], -given.gap[i]
    if it.law == Law.IMPACT:  # what touches is struck by the first look at it
        it.restitution, it.status = given.damping[i], Status.OPEN.value
        return
    if it.law == Law.YIELD:
        it.hardening, it.knots = given.damping[i], [UNREACHED for _ in range(KNOTS)]
        for j, entry in enumerate(given.table[i]):
            it.knots[j], it.shares[j] = entry[0], entry[1]
    else:
        it.damping = given.damping[i]
    if it.law == Law.OWN:
        it.function = i
    if it.law >= Law.RIGID:
        it.status = np.where(given.gap[i] > 0, Status.OPEN.value, Status.PRESS.value)


def keep_lines(link: list[Any], mass: list[Any], first: int) -> int:
    """Number the lines that keep what happens in links and masses; return how many there are."""
    l = first
    for it in link:
        it.force_line = l
        l += 1
        if it.law >= Law.JOINT:
            it.overlap_line = l
            l += 1
        if it.law == Law.YIELD:
            it.closing_line = l
            l += 1
    for body in mass:
        body.line = l
        l += 1
    return l - first


def lines_of(clock: Clock, known: list[Known], extra: int) -> list[Any]:
    """Lines, of which the pieces that are known stand at the beginning of the log."""
    line, first = blank(len(known) + extra, LINE), 0
    for l in range(len(line)):
        it = line[l]
        it.first = it.head = it.tail = NONE
        if l < len(known):
            it.first, it.head, it.tail = first, first, first + known[l].pieces - 1
            it.hard, first = known[l].hard, first + known[l].pieces
        if l < 2 * len(clock.transits):
            it.delay = clock.transits[l // 2]
    return line


def parts_of(given: Given, node: list[Any], link: list[Any], outside: Any) -> list[Any]:
    """What groups of bodies between contacts that open are made of, from left to right."""
    part: list[Any] = []
    head, n = 0, len(given.impedance)
    add_ground(part, head, given, outside, 0)
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
                add_part(part, head, Part.MASS.value, m, given.masses[m], 0.0)
        if k < n:
            gives = given.transit[k] / given.impedance[k]
            add_part(part, head, Part.SEGMENT.value, k, given.weight[k], gives)
    add_ground(part, head, given, outside, 1)
    return part


def add_part(part: list[Any], head: int, kind: int, index: int, mass: Any, compliance: Any) -> None:
    """Add a part to the group that begins with part `head`."""
    it = blank(1, PART)[0]
    it.kind, it.index, it.mass, it.compliance, it.held = kind, index, mass, compliance, NONE
    part.append(it)
    part[head].parts += 1


def add_ground(part: list[Any], head: int, given: Given, outside: Any, side: int) -> None:
    """Add what holds an end of the row."""
    endless = given.outside[side] == "absorbing"
    if endless or given.outside[side] == "velocity":
        index = finality.ENDLESS if endless else finality.WALL
        add_part(part, head, Part.GROUND.value, index, 0.0, 1e300 if endless else 0.0)
        part[head].held = outside[side]
