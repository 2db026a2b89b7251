"""What groups of bonded bodies do at an instant, and the proof that none of them meets again.

As long as nothing touches a group its end moves with the mean velocity, and deviates from that by
d = integral(strain g dx), g the mass fraction beyond x as seen from that end. By Cauchy and Schwarz
it can never deviate more than sqrt(2 E integral(g^2 dx/(E A))), E the energy of vibration, which
never grows. A wall holds a group: its velocity is the mean, and g is 1.
"""

from __future__ import annotations

import math
from typing import Any

from . import lines
from .records import NONE, Law, Part, Status
from .series import N, WEIGHTS, X

WALL, ENDLESS = 0, 1  # `index` of what holds a group
STILL = 2.0**-40  # of the velocity scale: slower is at rest
ROUGH = 1e-3  # of the tolerance of pieces: what they leave open


def look(run: Any, link: Any, mass: Any, line: Any, log: Any, part: Any) -> None:
    """See at `run.check` whether the run is over; if not, say when to look again."""
    tick = run.check
    survey(run, link, mass, line, log, part, tick)
    if is_over(run, link, part):
        run.proved, run.prove = tick, 0
        run.end = min(run.end, tick + run.extra)
    else:
        run.check = tick + max(run.shortest, wait(run, link, part))


def is_over(run: Any, link: Any, part: Any) -> bool:
    """Whether no contact can close again, or nothing changes any more."""
    slow = STILL * run.scale + ROUGH * run.tolerance
    over = quiet = True
    for i in range(len(link)):
        it = link[i]
        if it.left_group == NONE:
            continue
        left, right = part[it.left_group], part[it.right_group]
        quiet = quiet and is_quiet(it, left, slow) and is_quiet(it, right, slow)
        if it.status != Status.OPEN and (
            it.law > Law.IMPACT or it.force[N] * it.ease > run.graze
        ):
            over = False
        elif over and not (left.plain and right.plain and right.low - left.high >= -slow):
            apart = left.right_deviation - right.left_deviation - it.overlap
            reach = bound(left, left.right_slack) + bound(right, right.left_slack)
            over = right.speed - left.speed >= -slow and apart > 0 and apart > reach
    return over or quiet


def is_quiet(it: Any, group: Any, slow: float) -> bool:
    """Whether a group moves evenly, and no contact with it changes."""
    rate = it.closing[N] - it.mobility * it.force[N]
    return bool(group.high - group.low <= slow and abs(rate) <= slow)


def bound(group: Any, slack: float) -> float:
    """How far an end of a group can ever deviate from the mean motion, m."""
    return math.sqrt(2 * group.bound * slack)


def wait(run: Any, link: Any, part: Any) -> int:
    """Ticks until all gaps are wide enough for the proof, as bodies move now."""
    longest = 0.0
    for i in range(len(link)):
        it = link[i]
        if it.left_group != NONE and it.status == Status.OPEN:
            left, right = part[it.left_group], part[it.right_group]
            apart = left.right_deviation - right.left_deviation - it.overlap
            reach = bound(left, left.right_slack) + bound(right, right.left_slack)
            opening = right.speed - left.speed
            if opening > 0 and reach > apart:
                longest = max(longest, (reach - apart) / opening / run.tick)
    return int(min(longest, 2.0**60)) + 1


def survey(run: Any, link: Any, mass: Any, line: Any, log: Any, part: Any, tick: int) -> None:
    """Set speed, energies, deviations and bounds of all groups at a tick that every node has reached."""
    i = 0
    while i < len(part):
        head, last = part[i], i + part[i].parts
        momentum = total = 0.0
        for k in range(i, last):
            own = momentum_of(run, mass, line, log, part[k], tick)
            if part[k].mass > 0:
                part[k].own = own / part[k].mass
            momentum += own
            total += part[k].mass
        if head.held == NONE and total > 0:
            head.speed = momentum / total
        elif head.held != NONE:  # a line that says how what holds the group moves
            head.speed = 0.5 * sum_of(line, log, head.held, tick, 0, 0.0, 0.0, 1)
        head.bound = 0.0
        head.low, head.high = math.inf, -math.inf
        for k in range(i, last):
            set_energy(run, link, mass, line, log, part[k], head.speed, tick)
            head.bound += part[k].energy
        set_ends(run, link, line, log, part, i, last, total, tick)
        i = last


def momentum_of(run: Any, mass: Any, line: Any, log: Any, it: Any, tick: int) -> float:
    """Momentum of a part, kg m/s."""
    if it.kind == Part.MASS:
        return float(it.mass * mass[it.index].speed[0])
    if it.kind != Part.SEGMENT:
        return 0.0
    mean = sum_of(line, log, 2 * it.index, tick, line[2 * it.index].delay, 0.0, 0.0, 1)
    mean += sum_of(line, log, 2 * it.index + 1, tick, line[2 * it.index].delay, 0.0, 0.0, 1)
    return float(it.mass * mean / 2)


def set_energy(
    run: Any, link: Any, mass: Any, line: Any, log: Any, it: Any, speed: float, tick: int
) -> None:
    """Set the energy of a part about a velocity."""
    it.energy = 0.0
    if it.kind == Part.MASS:
        it.energy = it.mass * (mass[it.index].speed[0] - speed) ** 2 / 2
    elif it.kind == Part.JOINT:
        it.energy = link[it.index].stiffness * link[it.index].overlap ** 2 / 2
    elif it.kind == Part.SEGMENT:
        T = line[2 * it.index].delay
        square = sum_of(line, log, 2 * it.index, tick, T, 0.0, speed, 2)
        square += sum_of(line, log, 2 * it.index + 1, tick, T, 0.0, speed, 2)
        it.energy = it.mass * square / 4


def set_ends(
    run: Any, link: Any, line: Any, log: Any, part: Any, first: int, last: int, total: float,
    tick: int,
) -> None:
    """Set deviations and slacks of the ends of a group, and bounds of their velocity."""
    head = part[first]
    # waves under way are all that the end of a single segment can come to move with
    head.left_deviation = head.right_deviation = head.left_slack = head.right_slack = 0.0
    passed = 0.0
    for k in range(first, last):
        it = part[k]
        before = passed / total if total > 0 else 0.0
        passed += it.mass
        behind = passed / total if total > 0 else 0.0
        if head.held != NONE:
            before = behind = 1.0
        if it.kind == Part.SEGMENT:
            add_segment(line, log, head, it, before, behind, run.tick, tick)
        elif it.kind == Part.JOINT:
            far = 1.0 if head.held != NONE else 1 - before
            head.right_deviation -= link[it.index].overlap * before
            head.left_deviation += link[it.index].overlap * far
            head.right_slack += it.compliance * before * before
            head.left_slack += it.compliance * far * far
    segments = 0
    for k in range(first, last):
        it = part[k]
        if it.kind == Part.MASS or it.kind == Part.JOINT:
            segments += 2
        elif it.kind == Part.SEGMENT:
            segments += 1
        elif it.index == ENDLESS:
            head.left_slack = head.right_slack = it.compliance
        else:  # turns waves around its own velocity
            low = min(head.low, 2 * head.speed - head.high)
            head.high = max(head.high, 2 * head.speed - head.low)
            head.low = low
        head.low, head.high = min(head.low, head.speed), max(head.high, head.speed)
    head.plain = segments <= 1 or last - first == 1


def add_segment(
    line: Any, log: Any, head: Any, it: Any, before: float, behind: float, second: float, tick: int
) -> None:
    """Add a segment to the deviations of the ends of its group; `before` and `behind` are g."""
    right_going, left_going, T = 2 * it.index, 2 * it.index + 1, line[2 * it.index].delay
    low, high = extremes(line, log, right_going, tick, head.low, head.high)
    head.low, head.high = extremes(line, log, left_going, tick, low, high)
    far_before, far_behind = (1.0, 1.0) if head.held != NONE else (1 - before, 1 - behind)
    for side in range(2):
        g, w = (before, behind) if side else (far_before, far_behind)
        # strain dx = (b - a)/2 dt; a that left the left end last is at the left end now
        mean = sum_of(line, log, left_going, tick, T, g - w, w, 3)
        mean -= sum_of(line, log, right_going, tick, T, w - g, g, 3)
        stretch = mean * T * second / 2
        slack = it.compliance * (g * g + g * w + w * w) / 3
        if side:
            head.right_deviation += stretch
            head.right_slack += slack
        else:
            head.left_deviation -= stretch
            head.left_slack += slack


def extremes(
    line: Any, log: Any, l: int, tick: int, low: float, high: float
) -> tuple[float, float]:
    """Bounds of what is under way in a line, and of these two."""
    i = line[l].head
    while i != NONE:
        piece = log[i]
        if piece.stop + line[l].delay > tick:
            swing = 0.0
            if piece.degree > 0:
                for m in range(1, N + 1):
                    swing += abs(piece.coefficient[m])
            low = min(low, piece.coefficient[0] - swing)
            high = max(high, piece.coefficient[0] + swing)
        i = piece.after
    return low, high


def sum_of(
    line: Any, log: Any, l: int, tick: int, T: int, slope: float, shift: float, what: int
) -> float:
    """Mean over the last T ticks of what a line sent, or twice its value where T is 0.

    what : 1: of the wave; 2: of the square of the wave less `shift`; 3: of the wave times the
    weight `shift` + `slope` u, u from 0 for what was sent last to 1 for what was sent first.
    """
    i, total = line[l].head, 0.0
    if T == 0:
        while log[i].after != NONE and log[i].stop + line[l].delay <= tick:
            i = log[i].after
        piece = log[i]
        y = 2 * (tick - line[l].delay - piece.start) / (piece.stop - piece.start) - 1
        return 2 * lines.at(piece, y)
    while i != NONE:
        piece = log[i]
        low, high = max(tick - T, piece.start), min(tick, piece.stop)
        if high > low:
            part = 0.0
            for j in range(N):
                u = 0.5 * (X[j + 1] + 1) * (high - low)
                f = lines.at(piece, 2 * ((low - piece.start) + u) / (piece.stop - piece.start) - 1)
                if what == 2:
                    f = (f - shift) ** 2
                elif what == 3:
                    f *= shift + slope * (((tick - low) - u) / T)
                part += WEIGHTS[j] * f
            total += 0.5 * part * ((high - low) / T)
        i = piece.after
    return total
