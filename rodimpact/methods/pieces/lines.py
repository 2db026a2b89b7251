"""Lines: what left one end arrives at the other a transit later, as a list of pieces in a log."""

from typing import Any

from . import series
from .records import HARD, NONE, SMOOTH
from .series import POINTS, WEIGHTS, N, X

EXACT = 1e-4  # of the tolerance: a smaller jump is none


def at(piece: Any, y: float) -> float:
    """Value of a piece at y, from -1 to 1; beyond round-off it holds on."""
    if piece.degree == 0:
        return piece.coefficient[0]
    return series.value(piece.coefficient, min(1.0, max(-1.0, y)))


def move_on(line: Any, log: Any, l: int, tick: int) -> None:
    """Let the head of a line be the piece that arrives at a tick, or the last one."""
    here = line[l]
    while log[here.head].after != NONE and log[here.head].stop + here.delay <= tick:
        here.head = log[here.head].after
        if log[here.head].order <= HARD:
            here.hard -= 1


def rewind(line: Any, log: Any, l: int) -> None:
    """Let the head of a line be its first piece again: readers may have come to different times."""
    here = line[l]
    here.head, here.hard = here.first, 0
    i = log[here.first].after
    while i != NONE:
        if log[i].order <= HARD:
            here.hard += 1
        i = log[i].after


def known_until(line: Any, log: Any, l: int) -> int:
    """Tick until which it is known what arrives."""
    return int(log[line[l].tail].stop + line[l].delay)


def next_break(line: Any, log: Any, l: int, tick: int, end: int) -> int:
    """Tick of the next hard break that arrives after a tick, or the end."""
    delay = line[l].delay
    i = log[line[l].head].after
    while i != NONE and log[i].start + delay < end:
        if log[i].order <= HARD and log[i].start + delay > tick:
            return int(log[i].start + delay)
        i = log[i].after
    return end


def order_at(line: Any, log: Any, l: int, tick: int) -> int:
    """Order of the break that arrives at a tick; at the beginning anything may jump."""
    if tick == 0:
        return 0
    piece = log[line[l].head]
    if piece.start + line[l].delay == tick:
        return int(piece.order)
    return SMOOTH


def sample(line: Any, log: Any, l: int, tick: int, ticks: int, f: Any) -> None:
    """Set f to what arrives at the points of a piece; at its end to what arrives before it."""
    begin = tick - line[l].delay
    piece = log[line[l].head]
    if piece.degree == 0 and begin + ticks <= piece.stop:
        for j in range(POINTS):
            f[j] = piece.coefficient[0]
        return
    for j in range(POINTS):
        y = 0.5 * (X[j] + 1) * ticks  # since the begin
        while (
            piece.after != NONE
            and begin + y > piece.stop
            and piece.stop < begin + ticks
        ):
            piece = log[piece.after]
        f[j] = at(
            piece, 2 * ((begin - piece.start) + y) / (piece.stop - piece.start) - 1
        )


def moments(
    log: Any, i: int, begin: int, ticks: int, speed: float
) -> tuple[float, float, float, float]:
    """Integrals of what a line sent over `ticks` from `begin` on, less a velocity.

    Times the Legendre polynomials of degree 0, 1 and 2, and squared, over y from -1 to 1; i is the
    place of a piece at or before `begin`.
    """
    whole = tilt = bend = square = 0.0
    while i != NONE and log[i].start < begin + ticks:
        piece = log[i]
        low, high = max(begin, piece.start), min(begin + ticks, piece.stop)
        if high > low:
            for j in range(N):
                u = 0.5 * (X[j + 1] + 1) * (high - low)
                y = 2 * ((low - piece.start) + u) / (piece.stop - piece.start) - 1
                v = at(piece, y) - speed
                y = 2 * ((low - begin) + u) / ticks - 1
                w = (high - low) / ticks * WEIGHTS[j] * v
                whole += w
                tilt += w * y
                bend += w * (1.5 * y * y - 0.5)
                square += w * v
        i = piece.after
    return whole, tilt, bend, square


def project(line: Any, log: Any, l: int, tick: int, ticks: int, f: Any) -> None:
    """Set f to the nearest parabola to what arrives: exact in momentum, never of more energy."""
    here = line[l]
    whole, tilt, bend, _ = moments(log, here.head, tick - here.delay, ticks, 0.0)
    series.set_parabola(f, whole, tilt, bend)


def put(
    run: Any, line: Any, log: Any, l: int, tick: int, stop: int, degree: int, c: Any
) -> int:
    """Append a piece to a line; return its place in the log.

    What is constant stays one piece as long as it is: a front is a piece of degree 0. NONE is
    returned where it only goes on.
    """
    i, here, old = int(run.pieces), line[l], line[l].tail
    if old == NONE:
        here.first = here.head = i
    elif degree == 0 and log[old].degree == 0 and log[old].coefficient[0] == c[0]:
        log[old].stop = stop
        return NONE
    else:
        log[old].after = i
    piece = log[i]
    piece.start, piece.stop, piece.order, piece.after = tick, stop, SMOOTH, NONE
    piece.line, piece.degree = l, degree
    for m in range(POINTS):
        piece.coefficient[m] = c[m]
    here.tail, run.pieces = i, i + 1
    return i


def append(
    run: Any, line: Any, log: Any, l: int, tick: int, ticks: int, f: Any, c: Any
) -> int:
    """Append what has the values f at the points of a piece, with c as scratch, as `put` does."""
    degree = 0
    for m in range(POINTS):
        c[m] = f[0] if m == 0 else 0.0
    if not series.is_constant(f):
        degree = N
        series.coefficients(f, c)
    return put(run, line, log, l, tick, tick + ticks, degree, c)


def send(
    run: Any, line: Any, log: Any, l: int, at: Any, ticks: int, order: int
) -> None:
    """Append what leaves an end, with a break of this order.

    A constant wave that starts to change makes a hard break, however smooth the start is. So no
    piece of any node reaches across the arrival of this wave, and nothing moves before it arrives.
    """
    old = line[l].tail
    i = append(run, line, log, l, at.now, ticks, at.leaving, at.series)
    if i != NONE and order <= HARD:
        log[i].order = order
        judge(run, line, log, old, i)
    if i != NONE and log[i].order > HARD and log[old].degree == 0 and log[i].degree > 0:
        log[i].order = HARD
        line[l].hard += 1


def judge(run: Any, line: Any, log: Any, old: int, i: int) -> None:
    """Judge the break between two pieces: it is hard if what jumps is above tolerance.

    Its `order` is what theory says it can be; jumps of value, slope and curvature are measured over
    the shortest transit, a typical length of a piece.
    """
    before, new = log[old], log[i]
    s0 = 0.5 * run.shortest / (before.stop - before.start)
    s1 = 0.5 * run.shortest / (new.stop - new.start)
    jump = slope = bend = 0.0
    sign = 1.0
    for m in range(POINTS):
        q, b, c = m * m, before.coefficient[m], sign * new.coefficient[m]
        jump += c - b
        slope -= q * (c * s1 + b * s0)
        bend += q * (q - 1) / 6 * (c * s1 * s1 - b * s0 * s0)
        sign = -sign
    if abs(jump) <= EXACT * run.tolerance:
        new.order = max(new.order, 1)
        if abs(slope) + abs(bend) <= 4 * run.tolerance:
            new.order = SMOOTH
    if new.order <= HARD:
        line[new.line].hard += 1


def reflect(run: Any, line: Any, log: Any, at: Any) -> int:
    """Send back from a free end, as it came, the piece that arrives; return the tick behind it."""
    side = 1 if at.mobility[1] > 0 else 0
    source, target = at.source[side], at.target[side]
    move_on(line, log, source, at.now)
    piece, delay, old = log[line[source].head], line[source].delay, line[target].tail
    stop = piece.stop + delay
    i = put(run, line, log, target, at.now, stop, piece.degree, piece.coefficient)
    if i != NONE and at.now == 0:  # the first that meets what was under way
        log[i].order = 0
        judge(run, line, log, old, i)
    elif i != NONE and at.now == piece.start + delay:
        log[i].order = piece.order
        line[target].hard += piece.order <= HARD
    return int(stop)
