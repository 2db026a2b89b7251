"""What groups of bonded bodies do at an instant, for the proof that none of them meets again.

A wall holds a group: its velocity is the mean, and the mass fraction beyond every x is 1.
"""

import math

from .. import finality_kernel as proof
from ..link import Law
from ..states import Status, Stop
from . import lines
from .records import (
    NEVER,
    NONE,
    GroupPart,
    Lines,
    Link,
    Links,
    Log,
    Part,
    Parts,
    Run,
    State,
)
from .series import N

DASHPOT_FACTOR = 16.0
"""Factor of m/c^2 in the `slack` of a dashpot c that a momentum of the mass m passes.

The stretch is at most 2 sqrt(2 E m)/c; its square over 2 E is 4 m/c^2. The rest of the factor
allows for adding this bound to others before the root is taken.
"""
REST_RTOL = 2.0**-40
"""Velocity over the velocity scale, below which a body is at rest: round-off of a long run."""
TRUNCATION_SHARE = 1e-3
"""Velocity over the tolerance of pieces, below which it may be their truncation error."""


def look(state: State, tick: int) -> None:
    """Decide at a tick that every node has reached whether the run is over, or when to look again.

    `run.proved` is set with the proof; `run.check` is the tick of the next look.
    """
    run = state.runs[0]
    parts = state.parts
    if run.proved == NONE or run.held:  # joined bodies go on changing
        for l in range(len(state.lines)):
            if state.lines[l].head != NONE:
                if run.stop == Stop.CAP:
                    lines.rewind(state.lines, state.log, l)
                lines.move_on(state.lines, state.log, l, tick)
        survey(state, tick)
        if run.surveyed == NONE:
            for i in range(len(parts)):
                parts[i].initial = parts[i].mean
        elif run.check < NEVER and run.stop == Stop.NONE and tick < run.end:
            time = time_until_over(run, state.links, parts)
            ticks = int(min(time / run.tick, 0.5 * NEVER)) + 1
            run.check = tick + max(run.proof_interval, ticks)
            if time == 0:
                run.proved = tick
                run.check = NEVER
                run.end = min(run.end, tick + run.extra)
        run.surveyed = tick
    if tick >= run.end:
        run.stop = Stop.DONE.value


def time_until_over(run: Run, links: Links, parts: Parts) -> float:
    """Return the time until it may be proved that the run is over, s, as bodies move now.

    It is 0 if no contact can close again, or nothing changes any more.
    """
    slow = REST_RTOL * run.scale + TRUNCATION_SHARE * run.tolerance
    over = True
    quiet = True
    longest = 0.0
    for i in range(len(links)):
        link = links[i]
        if link.left_group == NONE:
            continue
        left = parts[link.left_group]
        right = parts[link.right_group]
        quiet = quiet and is_quiet(link, left, slow) and is_quiet(link, right, slow)
        time = time_until_apart(link, left, right, slow)
        pressed = link.status != Status.OPEN and (
            link.law > Law.IMPACT or link.force[N] * link.ease > run.graze
        )
        over = over and time == 0 and not pressed
        if link.status == Status.OPEN and time < math.inf:
            longest = max(longest, time)
    if over or quiet:
        return 0.0
    return max(longest, run.tick)


def time_until_apart(
    link: Link, left: GroupPart, right: GroupPart, slow: float
) -> float:
    """Return the time until a contact between two groups may be proved not to close again, s."""
    least = -math.inf
    if left.plain and right.plain:
        least = right.low - left.high
    apart = left.deviation[1] - right.deviation[0] - link.overlap
    reach = bound(left, left.slack[1]) + bound(right, right.slack[0])
    return proof.separation_time(
        right.speed - left.speed, least, apart, reach * reach, slow
    )


def is_quiet(link: Link, group: GroupPart, slow: float) -> bool:
    """Return whether a group moves evenly, and the overlap of a contact with it is constant."""
    rate = link.closing[N] - link.mobility * link.force[N]
    return bool(group.high - group.low <= slow and abs(rate) <= slow)


def bound(group: GroupPart, slack: float) -> float:
    """Return the largest deviation of an end of a group from the mean motion at any time, m."""
    return math.sqrt(2 * group.bound * slack)


def survey(state: State, tick: int) -> None:
    """Set the motion of all groups at a tick that every node has reached."""
    parts = state.parts
    for first in range(len(parts)):
        group = parts[first]
        last = first + group.parts
        if group.parts == 0:
            continue
        momentum = 0.0
        total = 0.0
        for k in range(first, last):
            update_part(state, parts[k], 0.0, tick)
            momentum += parts[k].mass * parts[k].own
            total += parts[k].mass
        if total > 0:
            group.mean = momentum / total
        group.speed = group.mean
        if group.held != NONE:
            # the group comes to the velocity that the line from outside carries
            piece = state.log[state.lines[group.held].head]
            y = 2 * (tick - piece.start) / (piece.stop - piece.start) - 1
            group.speed = lines.at(piece, y)
        off = group.mean - group.speed
        group.bound = total * (off * off) / 2
        group.low = group.speed
        group.high = group.speed
        for k in range(first, last):
            update_part(state, parts[k], group.mean, tick)
            group.bound += parts[k].energy
        set_ends(state, first, last, total)


def update_part(state: State, part: GroupPart, speed: float, tick: int) -> None:
    """Set the mean velocity of a part, its energy about a velocity, and moments of its waves."""
    part.energy = 0.0
    if part.kind == Part.MASS:
        part.own = state.masses[part.index].speed[0]
        part.energy = part.mass * ((part.own - speed) * (part.own - speed)) / 2
    elif part.kind == Part.SEGMENT:
        transit = state.lines[2 * part.index].delay
        squares = 0.0
        for way in range(2):
            head = state.lines[2 * part.index + way].head
            whole, tilt, _, square = lines.moments(
                state.log, head, tick - transit, transit, speed
            )
            part.wave[way] = whole
            part.tilt[way] = tilt
            squares += square
        part.own = speed + (part.wave[0] + part.wave[1]) / 4
        part.energy = part.mass * squares / 8
    elif part.kind == Part.JOINT:
        joint = state.links[part.index]
        part.energy = joint.stiffness * (joint.overlap * joint.overlap) / 2


def set_ends(state: State, first: int, last: int, total: float) -> None:
    """Set the displacements of the ends of a group, and the bounds of their velocities.

    The end of a single segment can only take velocities of the waves in it, of their reflections,
    and of its holder. At the start and at the stop of a part the mass fractions beyond it are g and
    w, as seen from the left or the right end.
    """
    second = state.runs[0].tick
    parts = state.parts
    group = parts[first]
    held = group.held != NONE
    passed = 0.0
    segments = 0
    others = 0
    for side in range(2):
        group.deviation[side] = 0.0
        group.slack[side] = 0.0
    for k in range(first, last):
        part = parts[k]
        before = passed
        passed += part.mass
        if part.kind == Part.SEGMENT:
            segments += 1
        elif part.kind < Part.WALL:
            others += 1  # masses and joints
        for side in range(2):
            g = 1.0
            w = 1.0
            if not held:
                g = before / total
                w = passed / total
            if not held and side == 0:
                g = 1 - g
                w = 1 - w
            sign = 2 * side - 1
            compliance = part.compliance
            if part.kind == Part.SEGMENT:
                l = 2 * part.index + side
                low, high = extremes(state.lines, state.log, l, group.low, group.high)
                group.low = low
                group.high = high
                transit = second * state.lines[2 * part.index].delay
                group.deviation[side] += sign * stretch(part, g, w) * transit
                group.slack[side] += compliance * (g * g + g * w + w * w) / 3
            elif part.kind == Part.JOINT:
                joint = state.links[part.index]
                if compliance > 0:
                    group.deviation[side] -= sign * joint.overlap * g
                else:
                    # a dashpot stretches by no more than the momentum that passes it, over c
                    c = joint.damping
                    largest = max(passed, total - passed)
                    compliance = DASHPOT_FACTOR * largest / (c * c)
                group.slack[side] += compliance * (g * g)
            elif part.kind == Part.ENDLESS:
                group.slack[side] = compliance
    for k in range(first, last):
        if parts[k].kind == Part.WALL:
            # a wall reflects waves about its velocity
            low = min(group.low, 2 * group.speed - group.high)
            group.high = max(group.high, 2 * group.speed - group.low)
            group.low = low
    alone = segments <= 1 and others == 0
    group.plain = alone or last - first == 1


def stretch(part: GroupPart, g: float, w: float) -> float:
    """Return the integral of strain g dx over the transit time, with g linear from g to w.

    As dx is c dt, strain dx is (b - a)/2 dt. The wave that a sent last is at the left end now, the
    wave that b sent last at the right end.
    """
    mean = part.wave[1] - part.wave[0]
    slope = part.tilt[1] + part.tilt[0]
    return float((g + w) * mean + (w - g) * slope) / 8


def extremes(
    all_lines: Lines, log: Log, l: int, low: float, high: float
) -> tuple[float, float]:
    """Return bounds of the waves under way in a line, and of two velocities."""
    i = all_lines[l].head
    while i != NONE:
        piece = log[i]
        swing = 0.0
        if piece.degree > 0:
            for m in range(1, N + 1):
                swing += abs(piece.coefficient[m])
        low = min(low, piece.coefficient[0] - swing)
        high = max(high, piece.coefficient[0] + swing)
        i = piece.after
    return low, high
