"""Lines: what left one end arrives at the other a transit later, as a list of pieces in a log."""

from ..compiling import borrowed
from . import series
from .records import HARD, NONE, SMOOTH, Lines, Log, Node, Piece, Run
from .series import POINTS, WEIGHTS, MutableValues, N, Values, X

EXACT = 1e-4
"""Jump of a wave over the tolerance, below which the wave counts as continuous."""


def at(piece: Piece, y: float) -> float:
    """Return the value of a piece at y, from -1 to 1; y beyond these is taken for round-off."""
    if piece.degree == 0:
        return piece.coefficient[0]
    return series.value(piece.coefficient, min(1.0, max(-1.0, y)))


def move_on(lines: Lines, log: Log, l: int, tick: int) -> None:
    """Let the head of a line be the piece that arrives at a tick, or the last one."""
    line = lines[l]
    while log[line.head].after != NONE and log[line.head].stop + line.delay <= tick:
        line.head = log[line.head].after
        if log[line.head].order <= HARD:
            line.hard -= 1


def rewind(lines: Lines, log: Log, l: int) -> None:
    """Let the head of a line be its first piece again: its readers may be at different ticks."""
    line = lines[l]
    line.head = line.first
    line.hard = 0
    i = log[line.first].after
    while i != NONE:
        if log[i].order <= HARD:
            line.hard += 1
        i = log[i].after


def known_until(lines: Lines, log: Log, l: int) -> int:
    """Return the tick until which the arriving wave is known."""
    return int(log[lines[l].tail].stop + lines[l].delay)


def next_break(lines: Lines, log: Log, l: int, tick: int, end: int) -> int:
    """Return the tick of the next hard break that arrives after a tick, or the end."""
    delay = lines[l].delay
    i = log[lines[l].head].after
    while i != NONE and log[i].start + delay < end:
        if log[i].order <= HARD and log[i].start + delay > tick:
            return int(log[i].start + delay)
        i = log[i].after
    return end


def order_at(lines: Lines, log: Log, l: int, tick: int) -> int:
    """Return the order of the break that arrives at a tick; at t = 0 anything may jump."""
    if tick == 0:
        return 0
    piece = log[lines[l].head]
    if piece.start + lines[l].delay == tick:
        return int(piece.order)
    return SMOOTH


def sample(
    lines: Lines, log: Log, l: int, tick: int, ticks: int, f: MutableValues
) -> None:
    """Set f to the arriving wave at the points of a piece; at its end to the limit from before."""
    begin = tick - lines[l].delay
    piece = log[lines[l].head]
    if piece.degree == 0 and begin + ticks <= piece.stop:
        for j in range(POINTS):
            f[j] = piece.coefficient[0]
        return
    for j in range(POINTS):
        u = 0.5 * (X[j] + 1) * ticks  # since `begin`
        while (
            piece.after != NONE
            and begin + u > piece.stop
            and piece.stop < begin + ticks
        ):
            piece = log[piece.after]
        y = 2 * ((begin - piece.start) + u) / (piece.stop - piece.start) - 1
        f[j] = at(piece, y)


def moments(
    log: Log, i: int, begin: int, ticks: int, speed: float
) -> tuple[float, float, float, float]:
    """Return the moments of the wave, less a velocity, that a line sent over `ticks` from `begin`.

    These are the integrals over y from -1 to 1 of the wave times the Legendre polynomials of degree
    0, 1 and 2, and of its square; i is the place of a piece at or before `begin`.
    """
    whole = 0.0
    tilt = 0.0
    bend = 0.0
    square = 0.0
    while i != NONE and log[i].start < begin + ticks:
        piece = log[i]
        low = max(begin, piece.start)
        high = min(begin + ticks, piece.stop)
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


def project(
    lines: Lines, log: Log, l: int, tick: int, ticks: int, f: MutableValues
) -> None:
    """Set f to the parabola nearest to the arriving wave: same momentum, never more energy."""
    line = lines[l]
    begin = tick - line.delay
    whole, tilt, bend, _ = moments(log, line.head, begin, ticks, 0.0)
    series.set_parabola(f, whole, tilt, bend)


def put(
    run: Run,
    lines: Lines,
    log: Log,
    l: int,
    tick: int,
    stop: int,
    degree: int,
    c: Values,
) -> int:
    """Append a piece to a line; return its place in the log.

    A constant wave stays one piece as long as it is constant: a front is a piece of degree 0. If
    the new piece only goes on with it, NONE is returned.
    """
    i = int(run.pieces)
    line = lines[l]
    old = line.tail
    if old == NONE:
        line.first = i
        line.head = i
    elif degree == 0 and log[old].degree == 0 and log[old].coefficient[0] == c[0]:
        log[old].stop = stop
        return NONE
    else:
        log[old].after = i
    piece = log[i]
    piece.start = tick
    piece.stop = stop
    piece.order = SMOOTH
    piece.after = NONE
    piece.line = l
    piece.degree = degree
    for m in range(POINTS):
        piece.coefficient[m] = c[m]
    line.tail = i
    run.pieces = i + 1
    return i


def append(
    run: Run,
    lines: Lines,
    log: Log,
    l: int,
    tick: int,
    ticks: int,
    f: Values,
    c: MutableValues,
) -> int:
    """Append the piece with the values f at its points, as `put` does, with c as scratch."""
    lines = borrowed(lines)
    log = borrowed(log)
    degree = 0
    for m in range(POINTS):
        c[m] = 0.0
    c[0] = f[0]
    if not series.is_constant(f):
        degree = N
        series.coefficients(f, c)
    return put(run, lines, log, l, tick, tick + ticks, degree, c)


def send(
    run: Run, lines: Lines, log: Log, l: int, node: Node, ticks: int, order: int
) -> None:
    """Append the wave that leaves a node, with a break of this order.

    A constant wave that starts to change makes a hard break, however smooth the start is. So no
    piece of any node reaches across the arrival of this wave, and nothing moves before it arrives.
    """
    old = lines[l].tail
    i = append(run, lines, log, l, node.now, ticks, node.leaving, node.series)
    if i != NONE and order <= HARD:
        log[i].order = order
        classify_break(run, lines, log, old, i)
    if i != NONE and log[i].order > HARD and log[old].degree == 0 and log[i].degree > 0:
        log[i].order = HARD
        lines[l].hard += 1


def classify_break(run: Run, lines: Lines, log: Log, old: int, i: int) -> None:
    """Classify the break between two pieces: it is hard if its jump is above tolerance.

    Its `order` is the lowest that theory allows; jumps of value, slope and curvature are measured
    over the shortest transit, a typical length of a piece.
    """
    before = log[old]
    new = log[i]
    s0 = 0.5 * run.shortest / (before.stop - before.start)
    s1 = 0.5 * run.shortest / (new.stop - new.start)
    jump = 0.0
    slope = 0.0
    bend = 0.0
    sign = 1.0
    for m in range(POINTS):
        q = m * m
        b = before.coefficient[m]
        c = sign * new.coefficient[m]
        jump += c - b
        slope -= q * (c * s1 + b * s0)
        bend += q * (q - 1) / 6 * (c * s1 * s1 - b * s0 * s0)
        sign = -sign
    if abs(jump) <= EXACT * run.tolerance:
        new.order = max(new.order, 1)
        if abs(slope) + abs(bend) <= 4 * run.tolerance:
            new.order = SMOOTH
    if new.order <= HARD:
        lines[new.line].hard += 1


def reflect(run: Run, lines: Lines, log: Log, node: Node) -> int:
    """Send the arriving piece back from a free end, unchanged; return the tick of its end."""
    side = 0
    if node.mobility[1] > 0:
        side = 1
    source = node.source[side]
    target = node.target[side]
    move_on(lines, log, source, node.now)
    piece = log[lines[source].head]
    delay = lines[source].delay
    old = lines[target].tail
    stop = piece.stop + delay
    i = put(run, lines, log, target, node.now, stop, piece.degree, piece.coefficient)
    if i != NONE and node.now == 0:
        # the first piece meets the wave that is under way at t = 0
        log[i].order = 0
        classify_break(run, lines, log, old, i)
    elif i != NONE and node.now == piece.start + delay:
        log[i].order = piece.order
        lines[target].hard += piece.order <= HARD
    return int(stop)
