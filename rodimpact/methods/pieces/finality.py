"""What groups of bonded bodies do at an instant, for the proof that none of them meets again.

A wall holds a group: its velocity is the mean, and the mass fraction beyond every x is 1.
"""

import math
from typing import Any

from .. import finality_kernel as proof
from ..laws import Law, Status, Stop
from . import lines
from .records import NEVER, NONE, Part
from .series import N

WALL, ENDLESS = 0, 1  # `index` of what holds a group
DASHPOT = 16.0  # (2 sqrt(2 E m)/c)^2 over 2 E, twice as the sum of two bounds is squared
STILL = 2.0**-40  # of the velocity scale: slower is at rest
ROUGH = 1e-3  # of the tolerance of pieces: what they leave open


def look(run: Any, link: Any, mass: Any, line: Any, log: Any, part: Any, tick: int) -> None:
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
        elif run.prove and run.stop == Stop.NONE and tick < run.end:
            time = time_until_over(run, link, part)
            run.check = tick + max(run.shortest, int(min(time / run.tick, 0.5 * NEVER)) + 1)
            if time == 0:
                run.proved, run.prove, run.check = tick, 0, NEVER
                run.end = min(run.end, tick + run.extra)
        run.surveyed = tick
    if tick >= run.end:
        run.stop = Stop.DONE.value


def time_until_over(run: Any, link: Any, part: Any) -> float:
    """Time until it may be proved that the run is over, s, as bodies move now.

    It is 0 if no contact can close again, or nothing changes any more.
    """
    slow, over, quiet, longest = STILL * run.scale + ROUGH * run.tolerance, True, True, 0.0
    for i in range(len(link)):
        it = link[i]
        if it.left_group == NONE:
            continue
        left, right = part[it.left_group], part[it.right_group]
        quiet = quiet and is_quiet(it, left, slow) and is_quiet(it, right, slow)
        time = time_until_apart(it, left, right, slow)
        pressed = it.status != Status.OPEN and (
            it.law > Law.IMPACT or it.force[N] * it.ease > run.graze)
        over = over and time == 0 and not pressed
        if it.status == Status.OPEN and time < math.inf:
            longest = max(longest, time)
    return 0.0 if over or quiet else max(longest, run.tick)


def time_until_apart(it: Any, left: Any, right: Any, slow: float) -> float:
    """Time until a contact between two groups may be proved not to close again, s."""
    least = right.low - left.high if left.plain and right.plain else -math.inf
    apart = left.right_deviation - right.left_deviation - it.overlap
    reach = bound(left, left.right_slack) + bound(right, right.left_slack)
    return proof.separation_time(right.speed - left.speed, least, apart, reach * reach, slow)


def is_quiet(it: Any, group: Any, slow: float) -> bool:
    """Whether a group moves evenly, and no contact with it changes."""
    rate = it.closing[N] - it.mobility * it.force[N]
    return bool(group.high - group.low <= slow and abs(rate) <= slow)


def bound(group: Any, slack: float) -> float:
    """How far an end of a group can ever deviate from the mean motion, m."""
    return math.sqrt(2 * group.bound * slack)


def survey(link: Any, mass: Any, line: Any, log: Any, part: Any, second: float, tick: int) -> None:
    """Set what all groups do at a tick that every node has reached; `second` is s a tick."""
    first = 0
    while first < len(part):
        head, last = part[first], first + part[first].parts
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
                piece, 2 * (tick - piece.start) / (piece.stop - piece.start) - 1)
        off = head.mean - head.speed
        head.bound = total * (off * off) / 2
        head.low = head.high = head.speed
        for k in range(first, last):
            look_at(link, mass, line, log, part[k], head.mean, tick)
            head.bound += part[k].energy
        set_ends(link, line, log, part, first, last, total, second)
        first = last


def look_at(
    link: Any, mass: Any, line: Any, log: Any, it: Any, speed: float, tick: int
) -> None:
    """Set the mean velocity of a part, its energy about a velocity, and moments of its waves."""
    it.energy = 0.0
    if it.kind == Part.MASS:
        it.own = mass[it.index].speed[0]
        it.energy = it.mass * ((it.own - speed) * (it.own - speed)) / 2
    elif it.kind == Part.SEGMENT:
        T = line[2 * it.index].delay
        a, b = line[2 * it.index], line[2 * it.index + 1]
        it.right_wave, it.right_tilt, _, a2 = lines.moments(log, a.head, tick - T, T, speed)
        it.left_wave, it.left_tilt, _, b2 = lines.moments(log, b.head, tick - T, T, speed)
        it.own = speed + (it.right_wave + it.left_wave) / 4
        it.energy = it.mass * (a2 + b2) / 8
    elif it.kind == Part.JOINT:
        it.energy = link[it.index].stiffness * (link[it.index].overlap * link[it.index].overlap) / 2


def set_ends(
    link: Any, line: Any, log: Any, part: Any, first: int, last: int, total: float, second: float
) -> None:
    """Set what is known of the ends of a group.

    Waves under way, and what holds the group, are all that an end of a single segment can come to
    move with. A part begins and stops with the mass fractions g and w beyond it as seen from the
    right end, far and beyond as seen from the left end.
    """
    head, held = part[first], part[first].held != NONE
    head.left_deviation = head.right_deviation = head.left_slack = head.right_slack = 0.0
    passed, pieces, w, beyond = 0.0, 0, 1.0 if held else 0.0, 1.0
    for k in range(first, last):
        it, g, far = part[k], w, beyond
        passed += it.mass
        if total > 0 and not held:
            w, beyond = passed / total, 1 - passed / total
        if it.kind == Part.SEGMENT:
            pieces += 1
            low, high = extremes(line, log, 2 * it.index, head.low, head.high)
            head.low, head.high = extremes(line, log, 2 * it.index + 1, low, high)
            transit = second * line[2 * it.index].delay
            head.right_deviation += stretch(it, g, w) * transit
            head.left_deviation -= stretch(it, far, beyond) * transit
            head.right_slack += it.compliance * (g * g + g * w + w * w) / 3
            head.left_slack += it.compliance * (far * far + far * beyond + beyond * beyond) / 3
        elif it.kind == Part.JOINT:
            pieces += 2
            gives, c = it.compliance, link[it.index].damping
            if gives > 0:
                head.right_deviation -= link[it.index].overlap * g
                head.left_deviation += link[it.index].overlap * far
            else:  # a dashpot stretches by no more than the momentum that passes it, over c
                gives = DASHPOT * max(passed, total - passed) / (c * c)
            head.right_slack += gives * (g * g)
            head.left_slack += gives * (far * far)
        elif it.kind == Part.MASS:
            pieces += 2
        elif it.index == ENDLESS:
            head.left_slack, head.right_slack = it.compliance, it.compliance
    for k in range(first, last):
        if part[k].kind == Part.GROUND and part[k].index == WALL:  # turns waves around its velocity
            low = min(head.low, 2 * head.speed - head.high)
            head.high = max(head.high, 2 * head.speed - head.low)
            head.low = low
    head.plain = pieces <= 1 or last - first == 1


def stretch(it: Any, g: float, w: float) -> float:
    """Integral of strain g dx of a segment over its transit time, with g linear from g to w.

    As dx is c dt, strain dx is (b - a)/2 dt. What a sent last is at the left end now, what b sent
    last at the right end.
    """
    mean, slope = it.left_wave - it.right_wave, it.left_tilt + it.right_tilt
    return float((g + w) * mean + (w - g) * slope) / 8


def extremes(line: Any, log: Any, l: int, low: float, high: float) -> tuple[float, float]:
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
