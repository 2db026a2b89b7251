"""What groups of bonded bodies do at an instant, for the proof that none of them meets again.

A wall holds a group: its velocity is the mean, and the mass fraction beyond every x is 1.
"""

import math
from typing import Any

from .. import finality_kernel as proof
from ..link import Law
from ..states import Status, Stop
from . import lines
from .records import NEVER, NONE, Part
from .series import N

DASHPOT = (
    16.0  # (2 sqrt(2 E m)/c)^2 over 2 E, twice as the sum of two bounds is squared
)
STILL = 2.0**-40  # of the velocity scale: slower is at rest
ROUGH = 1e-3  # of the tolerance of pieces: what they leave open


def look(
    run: Any, link: Any, mass: Any, line: Any, log: Any, part: Any, tick: int
) -> None:
    """See at a tick that every node has reached whether the run is over, or when to look again."""
    if run.proved == NONE or run.held:  # what is joined goes on changing
        for l in range(len(line)):
            if line[l].head != NONE:
                if run.stop == Stop.CAP:
                    lines.rewind(line, log, l)
                lines.move_on(line, log, l, tick)
        survey(link, mass, line, log, part, run.tick, tick)
        if run.surveyed == NONE:
            for i in range(len(part)):
                part[i].initial = part[i].mean
        elif run.check < NEVER and run.stop == Stop.NONE and tick < run.end:
            time = time_until_over(run, link, part)
            run.check = tick + max(
                run.proof_interval, int(min(time / run.tick, 0.5 * NEVER)) + 1
            )
            if time == 0:
                run.proved, run.check = tick, NEVER
                run.end = min(run.end, tick + run.extra)
        run.surveyed = tick
    if tick >= run.end:
        run.stop = Stop.DONE.value


def time_until_over(run: Any, link: Any, part: Any) -> float:
    """Time until it may be proved that the run is over, s, as bodies move now.

    It is 0 if no contact can close again, or nothing changes any more.
    """
    slow, over, quiet, longest = (
        STILL * run.scale + ROUGH * run.tolerance,
        True,
        True,
        0.0,
    )
    for i in range(len(link)):
        it = link[i]
        if it.left_group == NONE:
            continue
        left, right = part[it.left_group], part[it.right_group]
        quiet = quiet and is_quiet(it, left, slow) and is_quiet(it, right, slow)
        time = time_until_apart(it, left, right, slow)
        pressed = it.status != Status.OPEN and (
            it.law > Law.IMPACT or it.force[N] * it.ease > run.graze
        )
        over = over and time == 0 and not pressed
        if it.status == Status.OPEN and time < math.inf:
            longest = max(longest, time)
    return 0.0 if over or quiet else max(longest, run.tick)


def time_until_apart(it: Any, left: Any, right: Any, slow: float) -> float:
    """Time until a contact between two groups may be proved not to close again, s."""
    least = right.low - left.high if left.plain and right.plain else -math.inf
    apart = left.deviation[1] - right.deviation[0] - it.overlap
    reach = bound(left, left.slack[1]) + bound(right, right.slack[0])
    return proof.separation_time(
        right.speed - left.speed, least, apart, reach * reach, slow
    )


def is_quiet(it: Any, group: Any, slow: float) -> bool:
    """Whether a group moves evenly, and no contact with it changes."""
    rate = it.closing[N] - it.mobility * it.force[N]
    return bool(group.high - group.low <= slow and abs(rate) <= slow)


def bound(group: Any, slack: float) -> float:
    """How far an end of a group can ever deviate from the mean motion, m."""
    return math.sqrt(2 * group.bound * slack)


def survey(
    link: Any, mass: Any, line: Any, log: Any, part: Any, second: float, tick: int
) -> None:
    """Set what all groups do at a tick that every node has reached; `second` is s a tick."""
    for first in range(len(part)):
        head, last = part[first], first + part[first].parts
        if head.parts == 0:
            continue
        momentum = total = 0.0
        for k in range(first, last):
            look_at(link, mass, line, log, part[k], 0.0, tick)
            momentum += part[k].mass * part[k].own
            total += part[k].mass
        if total > 0:
            head.mean = momentum / total
        head.speed = head.mean
        if head.held != NONE:
            piece = log[line[head.held].head]  # of what comes from outside
            head.speed = lines.at(
                piece, 2 * (tick - piece.start) / (piece.stop - piece.start) - 1
            )
        off = head.mean - head.speed
        head.bound = total * (off * off) / 2
        head.low = head.high = head.speed
        for k in range(first, last):
            look_at(link, mass, line, log, part[k], head.mean, tick)
            head.bound += part[k].energy
        set_ends(link, line, log, part, first, last, total, second)


def look_at(
    link: Any, mass: Any, line: Any, log: Any, it: Any, speed: float, tick: int
) -> None:
    """Set the mean velocity of a part, its energy about a velocity, and moments of its waves."""
    it.energy = 0.0
    if it.kind == Part.MASS:
        it.own = mass[it.index].speed[0]
        it.energy = it.mass * ((it.own - speed) * (it.own - speed)) / 2
    elif it.kind == Part.SEGMENT:
        T, squares = line[2 * it.index].delay, 0.0
        for way in range(2):
            head = line[2 * it.index + way].head
            it.wave[way], it.tilt[way], _, square = lines.moments(
                log, head, tick - T, T, speed
            )
            squares += square
        it.own = speed + (it.wave[0] + it.wave[1]) / 4
        it.energy = it.mass * squares / 8
    elif it.kind == Part.JOINT:
        it.energy = (
            link[it.index].stiffness
            * (link[it.index].overlap * link[it.index].overlap)
            / 2
        )


def set_ends(
    link: Any,
    line: Any,
    log: Any,
    part: Any,
    first: int,
    last: int,
    total: float,
    second: float,
) -> None:
    """Set what is known of the ends of a group.

    Waves under way, and what holds the group, are all that an end of a single segment can come to
    move with. A part begins and stops with the mass fractions g and w beyond it, as seen from the
    left or the right end.
    """
    head, held, passed, pieces = part[first], part[first].held != NONE, 0.0, 0
    for side in range(2):
        head.deviation[side] = head.slack[side] = 0.0
    for k in range(first, last):
        it, before = part[k], passed
        passed += it.mass
        pieces += 1 if it.kind == Part.SEGMENT else 2 if it.kind < Part.WALL else 0
        for side in range(2):
            g = w = 1.0
            if not held:
                g, w = before / total, passed / total
            if not held and side == 0:
                g, w = 1 - g, 1 - w
            sign, gives = 2 * side - 1, it.compliance
            if it.kind == Part.SEGMENT:
                head.low, head.high = extremes(
                    line, log, 2 * it.index + side, head.low, head.high
                )
                transit = second * line[2 * it.index].delay
                head.deviation[side] += sign * stretch(it, g, w) * transit
                head.slack[side] += gives * (g * g + g * w + w * w) / 3
            elif it.kind == Part.JOINT:
                if gives > 0:
                    head.deviation[side] -= sign * link[it.index].overlap * g
                else:  # a dashpot stretches by no more than the momentum that passes it, over c
                    c = link[it.index].damping
                    gives = DASHPOT * max(passed, total - passed) / (c * c)
                head.slack[side] += gives * (g * g)
            elif it.kind == Part.ENDLESS:
                head.slack[side] = gives
    for k in range(first, last):
        if part[k].kind == Part.WALL:  # turns waves around its velocity
            low = min(head.low, 2 * head.speed - head.high)
            head.high = max(head.high, 2 * head.speed - head.low)
            head.low = low
    head.plain = pieces <= 1 or last - first == 1


def stretch(it: Any, g: float, w: float) -> float:
    """Integral of strain g dx of a segment over its transit time, with g linear from g to w.

    As dx is c dt, strain dx is (b - a)/2 dt. What a sent last is at the left end now, what b sent
    last at the right end.
    """
    mean, slope = it.wave[1] - it.wave[0], it.tilt[1] + it.tilt[0]
    return float((g + w) * mean + (w - g) * slope) / 8


def extremes(
    line: Any, log: Any, l: int, low: float, high: float
) -> tuple[float, float]:
    """Bounds of what is under way in a line, and of these two."""
    i = line[l].head
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
