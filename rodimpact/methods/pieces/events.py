"""What happens between pieces: contacts close, open, yield, and rigid bodies strike each other."""

from typing import Any

from .. import contact_laws
from ..link import Law
from ..states import Status
from . import lines, series
from .records import NONE, SMOOTH
from .series import N, X

SWEEPS = 1000  # of impacts that happen together
SETTLED = 1e-15  # of the velocities, below which a sweep changes nothing
NEAR = (
    0.9  # of the peak force: what is less at all points does not reach it between them
)
LONGEST_START = (
    16  # a start that is this part of the shortest transit may still be smooth
)
SLOWEST = 1e-8  # of the velocity scale: rigid bodies that part more slowly come to rest


def happen(
    run: Any, link: Any, mass: Any, turn: Any, at: Any, tick: int, i: int, status: int
) -> None:
    """Change the status of link i, and set the order of the break that this makes."""
    it = link[i]
    old = it.status
    it.status, it.order, it.bend = status, 1, 0.0
    if status == Status.OPEN or old == Status.OPEN:
        it.overlap = 0.0
    # the event is rounded to a tick: forces at which a law changes are exact all the same
    if old == Status.PLASTIC:
        if status == Status.PLASTIC:
            it.overlap = it.knots[it.knot] / it.stiffness
        it.yield_force = it.stiffness * it.overlap
        if status == Status.PLASTIC:
            it.hardening_share = it.shares[it.knot]
            it.knot += 1
    elif status == Status.PLASTIC:
        it.overlap = it.yield_force / it.stiffness
    if old == Status.OPEN:
        if contact_laws.force_jumps(it):
            it.order = 0
        elif it.law == Law.IMPACT:
            strike(run, link, mass, turn, at, tick, i)
    elif old == Status.REST:
        it.order = 0


def closing_of(mass: Any, at: Any, q: int) -> float:
    """Closing velocity of rigid bodies at the start of the next piece."""
    before = at.incoming[0][0] if q == 0 else mass[at.mass + q - 1].speed[0]
    behind = at.incoming[1][0] if q == at.links - 1 else mass[at.mass + q].speed[0]
    return float(before - behind)


def lightness(mass: Any, at: Any, q: int) -> float:
    """1/m of the body behind link q; 0 for a wall."""
    if q < 0 or q == at.links - 1:
        return 0.0
    return 1 / float(mass[at.mass + q].mass)


def push(mass: Any, at: Any, q: int, impulse: float) -> None:
    """Let an impulse act in link q."""
    if q > 0:
        mass[at.mass + q - 1].speed[0] -= impulse * lightness(mass, at, q - 1)
    if q < at.links - 1:
        mass[at.mass + q].speed[0] += impulse * lightness(mass, at, q)


def strike(
    run: Any, link: Any, mass: Any, turn: Any, at: Any, tick: int, i: int
) -> None:
    """Let rigid bodies strike, all together that touch.

    Each contact takes the least impulse that leaves it a closing of at most -e times the one before
    (Moreau, in CISM 302, 1988). Bodies that would part too slowly to matter come to rest.
    """
    for q in range(at.links):
        it = link[at.first + q]
        touching = it.law == Law.IMPACT and (at.first + q == i or it.overlap >= 0)
        it.unknown = q if touching else NONE
        if touching:
            closing = closing_of(mass, at, q)
            it.rate_after = -it.restitution * closing if closing > 0 else 0.0
            if -it.rate_after <= SLOWEST * run.scale:
                it.rate_after = 0.0
            it.force[0], it.closing[0] = 0.0, closing
    for _ in range(SWEEPS):
        change = 0.0
        for q in range(at.links):
            it = link[at.first + q]
            if it.unknown != NONE:
                ease = lightness(mass, at, q - 1) + lightness(mass, at, q)
                step = (closing_of(mass, at, q) - it.rate_after) / ease
                step = max(step, -it.force[0])
                it.force[0] += step
                push(mass, at, q, step)
                change = max(change, abs(step) * ease)
        if change <= SETTLED * run.scale:
            break
    for q in range(at.links):
        it = link[at.first + q]
        if it.unknown != NONE:
            settle(run, turn, it, at.first + q, tick, closing_of(mass, at, q))


def settle(run: Any, turn: Any, it: Any, i: int, tick: int, closing: float) -> None:
    """Enter the impulse of an impact; what does not part rests, as long as it is pressed."""
    struck = it.force[0] > 0
    it.overlap, it.order = 0.0, 0
    it.status = Status.OPEN.value
    if closing >= -SLOWEST * run.scale:
        it.status = Status.REST.value
        run.rested += struck
    if struck:
        it.impulse += it.force[0]
        change(run, turn, it, i, tick, Status.PRESS.value)
        new = turn[run.turns - 1]
        new.impulse, new.closing = it.force[0], 0.5 * (it.closing[0] + closing)
        it.last = tick
        if it.status == Status.OPEN:
            it.opened, it.apart = 1, tick


def record(
    run: Any, link: Any, mass: Any, line: Any, log: Any, turn: Any, at: Any, ticks: int
) -> None:
    """Enter what a piece did to the links and masses of a node."""
    h = ticks * run.tick
    for q in range(at.links):
        it = link[at.first + q]
        if run.keep:
            keep(run, line, log, at, it, ticks)
        it.order, it.overlap = SMOOTH, it.overlaps[N]
        it.rate = it.closing[N] - it.mobility * it.force[N]
        before = it.closing[N - 1] - it.mobility * it.force[N - 1]
        it.bend = 2 * (it.rate - before) / (h * (X[N] - X[N - 1]))
        touch = Status.OPEN.value if it.status == Status.OPEN else Status.GRAZE.value
        start = at.now
        if it.status != Status.OPEN and it.status != Status.GRAZE:
            it.impulse += 0.5 * h * series.integral(it.force)
            top = series.largest(it.force)
            if (
                ticks > run.window and top > NEAR * it.peak
            ):  # shorter is where breaks nearly meet
                peak = series.maximum(it.force, at.series, it.peak)
                if peak > it.peak:
                    it.peak = peak
                    it.peak_error = series.remainder(it.force, False)
            if it.status >= Status.PRESS and presses(run, it, top):
                touch = Status.PRESS.value
                start -= max(it.faint, 0)
                it.pressed += at.now + ticks - start
        if it.law >= Law.RIGID and touch != it.touch:
            change(run, turn, it, at.first + q, start, touch)
        it.faint = faint_ticks(run, it, touch, ticks)
    for i in range(at.links - 1):
        body = mass[at.mass + i]
        if run.keep:
            lines.append(
                run, line, log, body.line, at.now, ticks, body.speed, at.series
            )
        body.speed[0] = body.speed[N]


def presses(run: Any, it: Any, top: float) -> bool:
    """Whether a touching contact presses: by its overlap if it has one, else by its force."""
    if it.law >= Law.SPRING:
        return (
            top > 0
            and series.largest(it.overlaps) > run.graze * run.shortest * run.tick
        )
    return top * it.ease > run.graze


def faint_ticks(run: Any, it: Any, touch: int, ticks: int) -> int:
    """Ticks for which a compliant contact has been closed, up to now, with a force that is none.

    A force that starts smoothly is none at first; once it presses, it has begun when the contact
    closed. What stays faint for long is round-off: then NONE is returned until the contact opens.
    """
    faint = it.faint
    closed = it.law >= Law.SPRING and it.status >= Status.PRESS
    if touch == Status.PRESS or not closed:
        faint = 0
    elif faint != NONE and series.largest(it.force) > 0:
        faint += ticks
        if faint > run.shortest // LONGEST_START:
            faint = NONE
    return int(faint)


def change(run: Any, turn: Any, it: Any, i: int, tick: int, touch: int) -> None:
    """Log that a contact is touched, presses or is left."""
    if touch == Status.PRESS:
        if it.first == NONE:
            it.first = tick
        it.episodes += it.opened
        it.opened = 0
    elif it.touch == Status.PRESS:
        it.last = tick
    if touch == Status.OPEN:
        it.opened = 1
        it.apart = tick
    it.touch = touch
    new = turn[run.turns]
    new.tick, new.link, new.touch, new.impulse, new.closing = tick, i, touch, 0.0, 0.0
    run.turns += 1


def keep(run: Any, line: Any, log: Any, at: Any, it: Any, ticks: int) -> None:
    """Keep over a piece the force of a link, its overlap, and the closing of what yields."""
    lines.append(run, line, log, it.kept, at.now, ticks, it.force, at.series)
    if it.law >= Law.JOINT:
        lines.append(run, line, log, it.kept + 1, at.now, ticks, it.overlaps, at.series)
    if it.law == Law.YIELD:
        for j in range(series.POINTS):
            at.rate[j] = it.closing[j] - it.mobility * it.force[j]
        lines.append(run, line, log, it.kept + 2, at.now, ticks, at.rate, at.series)
