"""Lines: a wave that leaves one end of a segment arrives at the other a transit later.

A line is a linked list of pieces in a log. Line l has the rows of the log whose `line`
is l; each row has the row of the next piece in `next`. The times of a piece are those
at which it was sent. It arrives a `delay` later. The read piece of a line is the one
that arrives now at the end of the line, where a node reads it. The break at the start
of a piece is hard if its order is at most MAX_HARD_ORDER: if the value, the slope or
the curvature of the wave jumps there.
"""

from typing import NamedTuple

from ..compiling import borrowed
from . import series
from .records import MAX_HARD_ORDER, NONE, SMOOTH, Lines, Log, Node, Piece, Run
from .series import POINTS, WEIGHTS, MutableValues, N, Values, X

CONTINUITY_RTOL = 1e-4
"""Largest jump of a wave that counts as continuous, over the tolerance of pieces."""
SMOOTHNESS_RTOL = 4
"""Largest jump of slope and curvature that counts as smooth, over the tolerance.

The jump is measured by the change of values that it makes, see `classify_break`.
"""


class Moments(NamedTuple):
    """Integrals over y, from -1 to 1, with the Legendre polynomials P0, P1 and P2."""

    whole: float  # integral of w P0, of a wave w, m/s
    tilt: float  # integral of w P1, m/s
    bend: float  # integral of w P2, m/s
    square: float  # integral of w^2, m^2/s^2


def at(piece: Piece, y: float) -> float:
    """Return the value of a piece at y, from -1 at its start to 1 at its end.

    If y is outside this range, by round-off, the value at the nearer end is returned.
    """
    if piece.degree == 0:  # the piece is constant
        return piece.coefficients[0]
    return series.value(piece.coefficients, min(1.0, max(-1.0, y)))


def advance_to(lines: Lines, log: Log, l: int, tick: int) -> None:
    """Move the read piece of line l forward to the piece that arrives at a tick.

    At the border of two pieces it is the later one. The last piece stays the read piece
    after its end. Each hard break that is passed is subtracted from `unread_breaks`.
    """
    line = lines[l]
    # A piece is over when its end arrives, a delay after it was sent.
    while (
        log[line.read_piece].next != NONE
        and log[line.read_piece].end + line.delay <= tick
    ):
        line.read_piece = log[line.read_piece].next
        if log[line.read_piece].break_order <= MAX_HARD_ORDER:
            line.unread_breaks -= 1


def rewind(lines: Lines, log: Log, l: int) -> None:
    """Move the read piece of line l back to its first piece.

    All its hard breaks are counted as unread again. Afterwards `advance_to`, which only
    moves forward, can move to an earlier tick.
    """
    line = lines[l]
    line.read_piece = line.first_piece
    line.unread_breaks = 0
    # A break is at the start of a piece; the start of the first piece is not counted.
    i = log[line.first_piece].next
    while i != NONE:
        if log[i].break_order <= MAX_HARD_ORDER:
            line.unread_breaks += 1
        i = log[i].next


def known_until(lines: Lines, log: Log, l: int) -> int:
    """Return the tick at which the last piece of line l, so far, ends its arrival."""
    return int(log[lines[l].last_piece].end + lines[l].delay)


def next_break(lines: Lines, log: Log, l: int, tick: int, end: int) -> int:
    """Return the tick at which the first hard break arrives between `tick` and `end`.

    The break arrives by line l, after `tick` and before `end`. If there is none, `end`
    is returned. The read piece must not be later than `tick`; it is not moved.
    """
    delay = lines[l].delay
    i = log[lines[l].read_piece].next
    # The break at the start of piece i arrives a delay after it was sent.
    while i != NONE and log[i].start + delay < end:
        arrival = log[i].start + delay
        if log[i].break_order <= MAX_HARD_ORDER and arrival > tick:
            return int(arrival)
        i = log[i].next
    return end


def order_at(lines: Lines, log: Log, l: int, tick: int) -> int:
    """Return the order of the break that arrives by line l at a tick.

    It is SMOOTH if no piece begins to arrive at this tick. At tick 0 it is 0, since
    everything may jump there. `advance_to` must have moved the read piece to this tick;
    it is not moved here.
    """
    if tick == 0:
        return 0
    piece = log[lines[l].read_piece]
    if piece.start + lines[l].delay == tick:
        return int(piece.break_order)
    return SMOOTH


def sample(
    lines: Lines, log: Log, l: int, tick: int, ticks: int, f: MutableValues
) -> None:
    """Set f to the values of the wave that arrives by line l at the points of a piece.

    The piece lasts `ticks` from `tick` on. If the wave jumps at the end of the piece,
    the last value is the one before the jump. The read piece must begin to arrive at
    `tick` or before; it is not moved.
    """
    begin = tick - lines[l].delay  # tick at which the wave was sent
    end = begin + ticks
    piece = log[lines[l].read_piece]
    if piece.degree == 0 and end <= piece.end:  # one constant piece covers all of it
        for j in range(POINTS):
            f[j] = piece.coefficients[0]
        return
    for j in range(POINTS):
        u = 0.5 * (X[j] + 1) * ticks  # time since `begin`, ticks
        # Go on to the piece at this time, as long as there is a next one. By round-off
        # the last time may be beyond `end`: a piece that ends at `end` is kept, hence
        # the last condition.
        while piece.next != NONE and begin + u > piece.end and piece.end < end:
            piece = log[piece.next]
        # Position of this time in the piece, from -1 to 1
        y = 2 * ((begin - piece.start) + u) / (piece.end - piece.start) - 1
        f[j] = at(piece, y)


def moments(log: Log, i: int, begin: int, ticks: int, speed: float) -> Moments:
    """Return the moments of w = wave - speed over `ticks` from tick `begin` on.

    The times are those at which the wave was sent. The moments are the integrals of w,
    w y, w P2(y) and w^2 over y, which goes from -1 to 1 in these ticks; w and `speed`
    are in m/s. i is the row of the log of a piece of the line that starts at or before
    `begin`. Times for which the line has no piece add nothing. Each piece is integrated
    with the weights of the stages.
    """
    whole = 0.0
    tilt = 0.0
    bend = 0.0
    square = 0.0
    while i != NONE and log[i].start < begin + ticks:
        piece = log[i]
        low = max(begin, piece.start)
        high = min(begin + ticks, piece.end)
        if high > low:
            share = (high - low) / ticks  # share of the time that is in this piece
            for j in range(N):  # stage j is point j + 1
                u = 0.5 * (X[j + 1] + 1) * (high - low)  # ticks since `low`
                # Position of this instant in the piece, and in all `ticks`
                y_piece = 2 * ((low - piece.start) + u) / (piece.end - piece.start) - 1
                y = 2 * ((low - begin) + u) / ticks - 1
                w = at(piece, y_piece) - speed
                weighted = share * WEIGHTS[j] * w
                whole += weighted
                tilt += weighted * y
                bend += weighted * (1.5 * y * y - 0.5)  # P2
                square += weighted * w
        i = piece.next
    return Moments(whole, tilt, bend, square)


def project(
    lines: Lines, log: Log, l: int, tick: int, ticks: int, f: MutableValues
) -> None:
    """Set f to the parabola nearest to the wave that arrives by line l, at the points.

    The wave is taken over `ticks` from `tick` on. The read piece must begin to arrive
    at `tick` or before; it is not moved. The parabola, the nearest by least squares,
    has the same momentum as the wave, and never more energy.
    """
    line = lines[l]
    begin = tick - line.delay  # tick at which the wave was sent
    speed = 0.0  # nothing is subtracted from the wave
    wave = moments(log, line.read_piece, begin, ticks, speed)
    series.set_parabola(f, wave.whole, wave.tilt, wave.bend)


def append_piece(
    run: Run,
    lines: Lines,
    log: Log,
    l: int,
    tick: int,
    stop: int,
    degree: int,
    c: Values,
) -> int:
    """Append the series c from `tick` to `stop` to line l; return its row in the log.

    If both this piece (`degree` 0) and the last piece of the line are constant with the
    same value, the last piece is lengthened instead, and NONE is returned. The new
    piece takes the row `piece_count`, which must exist in the log. The order of its
    break is SMOOTH; callers may set it.
    """
    i = int(run.piece_count)
    line = lines[l]
    old = line.last_piece
    if old == NONE:  # the line has no piece yet
        line.first_piece = i
        line.read_piece = i
    # A series of degree 0 is constant, with the value `coefficients[0]`.
    elif degree == 0 and log[old].degree == 0 and log[old].coefficients[0] == c[0]:
        log[old].end = stop  # the same constant goes on
        return NONE
    else:
        log[old].next = i
    piece = log[i]
    piece.start = tick
    piece.end = stop
    piece.break_order = SMOOTH
    piece.next = NONE
    piece.line = l
    piece.degree = degree
    for m in range(POINTS):
        piece.coefficients[m] = c[m]
    line.last_piece = i
    run.piece_count = i + 1
    return i


def append_values(
    run: Run,
    lines: Lines,
    log: Log,
    l: int,
    tick: int,
    ticks: int,
    f: Values,
    c: MutableValues,
) -> int:
    """Append a piece with the values f at its points to line l.

    It lasts `ticks` from `tick` on. Its degree is 0 if all values are equal, otherwise
    N. Its row in the log is returned, or NONE if a constant piece was lengthened
    instead, see `append_piece`. c is scratch: it is set to the series.
    """
    # For speed: machine code does not count references to borrowed arrays.
    lines = borrowed(lines)
    log = borrowed(log)
    if series.is_constant(f):
        degree = 0
        for m in range(POINTS):
            c[m] = 0.0
        c[0] = f[0]
    else:
        degree = N
        series.set_series(f, c)
    return append_piece(run, lines, log, l, tick, tick + ticks, degree, c)


def send(
    run: Run, lines: Lines, log: Log, l: int, node: Node, ticks: int, order: int
) -> None:
    """Append the wave `node.outgoing`, over `ticks` from now, to line l.

    The piece begins with a break. `order` is the lowest order that theory allows; if it
    is hard, `classify_break` raises it where less jumps. A break that stays hard is
    counted as unread. If a constant piece was only lengthened, there is no break.

    A constant wave that starts to change always makes a hard break, however smooth the
    start is. So no piece of the node that reads the line reaches across the start, and
    nothing moves before the wave arrives.
    """
    old = lines[l].last_piece
    i = append_values(
        run, lines, log, l, node.now, ticks, node.outgoing, node.scratch_series
    )
    if i != NONE and order <= MAX_HARD_ORDER:
        log[i].break_order = order
        classify_break(run, lines, log, old, i)
    if i != NONE and log[i].break_order > MAX_HARD_ORDER:  # not a hard break so far
        starts_to_change = log[old].degree == 0 and log[i].degree > 0
        if starts_to_change:
            log[i].break_order = MAX_HARD_ORDER
            lines[l].unread_breaks += 1


def classify_break(run: Run, lines: Lines, log: Log, old: int, i: int) -> None:
    """Raise the order of the break between pieces `old` and i if less jumps there.

    `break_order` of piece i must be the lowest order that theory allows. If the value
    does not jump, it becomes at least 1; if slope and curvature do not jump either, it
    becomes SMOOTH. If the break stays hard, it is counted as unread.

    Jumps of slope and curvature are measured by the change of the value, m/s, that they
    make in a quarter of the shortest transit. In y of a piece this time is
    s = (shortest transit)/(2 duration), as y runs through 2 in a piece. T_m changes by
    s T_m' + s^2 T_m''/2 in it. At the end of a piece T_m = 1, T_m' = m^2 and
    T_m'' = m^2 (m^2 - 1)/3. At its start the signs are (-1)^m, (-1)^(m+1) and (-1)^m.
    """
    before = log[old]
    new = log[i]
    s_before = 0.5 * run.shortest_transit / (before.end - before.start)
    s_new = 0.5 * run.shortest_transit / (new.end - new.start)
    jump = 0.0
    slope_jump = 0.0  # jump of the slope, times s
    curvature_jump = 0.0  # jump of the curvature, times s^2/2
    sign = 1.0  # (-1)^m
    for m in range(POINTS):
        q = m * m  # T_m' at the end
        # Value b of term m at the end of the old piece, where T_m = 1, and its value c
        # at the start of the new one, where T_m = (-1)^m
        b = before.coefficients[m]
        c = sign * new.coefficients[m]
        jump += c - b
        # The new slope, -q c s_new, minus the old one, q b s_before
        slope_jump -= q * (c * s_new + b * s_before)
        # T_m''/2 = q (q - 1)/6
        curvature_jump += (
            q * (q - 1) / 6 * (c * s_new * s_new - b * s_before * s_before)
        )
        sign = -sign
    if abs(jump) <= CONTINUITY_RTOL * run.tolerance:
        new.break_order = max(new.break_order, 1)
        if abs(slope_jump) + abs(curvature_jump) <= SMOOTHNESS_RTOL * run.tolerance:
            new.break_order = SMOOTH
    if new.break_order <= MAX_HARD_ORDER:
        lines[new.line].unread_breaks += 1


def reflect(run: Run, lines: Lines, log: Log, node: Node) -> int:
    """Send the piece that arrives at a free end back as it is, from `now` of the node.

    Without a force the leaving wave equals the incoming one. The rest of the incoming
    piece, from `now` on, is appended to the outgoing line, with its break. A hard break
    is counted as unread. The read piece of the incoming line is moved to `now`. The
    tick at which the piece ends is returned: the caller sets `now` of the node to it.
    """
    # Side of the node with the rod: `mobility` is 0 on the other side
    if node.mobility[1] > 0:
        side = 1
    else:
        side = 0
    source = node.incoming_lines[side]
    target = node.outgoing_lines[side]
    advance_to(lines, log, source, node.now)
    piece = log[lines[source].read_piece]
    delay = lines[source].delay
    old = lines[target].last_piece
    stop = piece.end + delay
    # Row of the new piece; NONE if a constant piece was lengthened instead
    i = append_piece(
        run, lines, log, target, node.now, stop, piece.degree, piece.coefficients
    )
    if i != NONE and node.now == 0:
        # The first piece follows the wave that is in the segment at t = 0. The value
        # may jump between them: order 0, unless `classify_break` finds that less jumps.
        log[i].break_order = 0
        classify_break(run, lines, log, old, i)
    elif i != NONE and node.now == piece.start + delay:
        # The piece starts to arrive now, and so does its break.
        log[i].break_order = piece.break_order
        is_hard = piece.break_order <= MAX_HARD_ORDER
        lines[target].unread_breaks += is_hard  # 1 if true
    return int(stop)
