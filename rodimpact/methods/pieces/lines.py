"""Lines: what left one end arrives at the other a transit later.

A line is a list of pieces in a log. Line l carries the pieces of the log whose `line`
is l, linked by `next`. Their times are those at which they were sent; they arrive later
by the delay of the line. The read piece of a line is the one that its reader, the node
at its end, reads now.
"""

from typing import NamedTuple

from ..compiling import borrowed
from . import series
from .records import MAX_HARD_ORDER, NONE, SMOOTH, Lines, Log, Node, Piece, Run
from .series import POINTS, WEIGHTS, MutableValues, N, Values, X

CONTINUITY_RTOL = 1e-4
"""Jump of a wave over the tolerance, below which the wave counts as continuous."""
SMOOTHNESS_RTOL = 4
"""Change of values by jumps of slope and curvature, over the tolerance.

Up to it the wave counts as smooth.
"""


class Moments(NamedTuple):
    """Integrals of a wave w over y, from -1 to 1; P are the Legendre polynomials."""

    whole: float  # of w P0, m/s
    tilt: float  # of w P1
    bend: float  # of w P2
    square: float  # of w^2, m^2/s^2


def at(piece: Piece, y: float) -> float:
    """Return the value of a piece at y, from -1 at its start to 1 at its end.

    A y beyond these is round-off: the value at the end is returned.
    """
    if piece.degree == 0:  # the piece is constant
        return piece.coefficients[0]
    return series.value(piece.coefficients, min(1.0, max(-1.0, y)))


def advance_to(lines: Lines, log: Log, l: int, tick: int) -> None:
    """Move on to the piece of line l that arrives at a tick: it is read from now on.

    A piece whose end arrives at this tick has been read. The last piece stays the one
    that is read, also after its end. Hard breaks that are passed are no longer counted
    in `unread_breaks`.
    """
    line = lines[l]
    # A piece has been read when its end has arrived, a delay after it was sent.
    while (
        log[line.read_piece].next != NONE
        and log[line.read_piece].end + line.delay <= tick
    ):
        line.read_piece = log[line.read_piece].next
        if log[line.read_piece].break_order <= MAX_HARD_ORDER:
            line.unread_breaks -= 1


def rewind(lines: Lines, log: Log, l: int) -> None:
    """Move the read piece of line l back to its first one.

    All its hard breaks count as unread again. This is for reading the line at an
    earlier tick, as `advance_to` only moves on.
    """
    line = lines[l]
    line.read_piece = line.first_piece
    line.unread_breaks = 0
    # A break is at the start of a piece; that of the first one is not counted.
    i = log[line.first_piece].next
    while i != NONE:
        if log[i].break_order <= MAX_HARD_ORDER:
            line.unread_breaks += 1
        i = log[i].next


def known_until(lines: Lines, log: Log, l: int) -> int:
    """Return the tick until which the wave that arrives by line l is known."""
    return int(log[lines[l].last_piece].end + lines[l].delay)


def next_break(lines: Lines, log: Log, l: int, tick: int, end: int) -> int:
    """Return the tick of the first hard break by line l between `tick` and `end`.

    A break at `tick` or at `end` itself does not count. `end` is returned if there is
    none. The read piece must not be later than `tick`; it stays.
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

    It is SMOOTH if there is none. At t = 0 it is 0: anything may jump. The read piece
    has been moved to this tick by `advance_to`, and is not moved here.
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
    """Set f to the wave that arrives by line l, at the points of a piece.

    The piece has `ticks` from `tick` on. If the wave jumps at the end of the piece, its
    value is the one before. The read piece begins at `tick` or before, and is not
    moved.
    """
    begin = tick - lines[l].delay  # when the wave was sent
    end = begin + ticks
    piece = log[lines[l].read_piece]
    if piece.degree == 0 and end <= piece.end:  # one constant piece holds all the time
        for j in range(POINTS):
            f[j] = piece.coefficients[0]
        return
    for j in range(POINTS):
        u = 0.5 * (X[j] + 1) * ticks  # time since `begin`, ticks
        # Go on to the piece that holds at this time. By round-off the last time may be
        # beyond `end`: a piece that ends there is not left.
        while piece.next != NONE and begin + u > piece.end and piece.end < end:
            piece = log[piece.next]
        # Place of this time in the piece, from -1 to 1
        y = 2 * ((begin - piece.start) + u) / (piece.end - piece.start) - 1
        f[j] = at(piece, y)


def moments(log: Log, i: int, begin: int, ticks: int, speed: float) -> Moments:
    """Return the moments of w, the wave that a line sent less the velocity `speed`.

    They are the integrals of w, w y, w P2(y) and w^2 over y, which goes from -1 at tick
    `begin` to 1 after `ticks`; w is in m/s. i is the row of the log of a piece of the
    line at or before `begin`. Times in which nothing was sent add nothing. Each piece
    is integrated with the weights of the stages.
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
            share = (high - low) / ticks  # of the time, in this piece
            for j in range(N):
                u = 0.5 * (X[j + 1] + 1) * (high - low)  # ticks of stage j since `low`
                # This instant as y of the piece, and as y of the moments
                in_piece = 2 * ((low - piece.start) + u) / (piece.end - piece.start) - 1
                y = 2 * ((low - begin) + u) / ticks - 1
                w = at(piece, in_piece) - speed
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
    """Set f to the parabola nearest to the wave that arrives by line l.

    The wave arrives in `ticks` from `tick` on; the read piece must not be later, and is
    not moved. f gets the values at the points. The parabola has the same momentum, and
    never more energy.
    """
    line = lines[l]
    begin = tick - line.delay  # when the wave was sent
    speed = 0.0  # the moments are those of the whole wave
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

    A constant wave stays one piece as long as it is constant: a front is a piece of
    degree 0. If the new piece only goes on with it, the old one is made longer, and
    NONE is returned. The new piece has no break at its start (SMOOTH): callers set one.
    It takes the row `piece_count`, which the log must have.
    """
    i = int(run.piece_count)
    line = lines[l]
    old = line.last_piece
    if old == NONE:  # it is the first piece of the line
        line.first_piece = i
        line.read_piece = i
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
    """Append a piece with the values f at its POINTS = N + 1 points to line l.

    It has `ticks` from `tick` on, and degree 0 if all values are the same. Return its
    row in the log, or NONE if the last piece of the line goes on with the same
    constant and is made longer instead. c is scratch: it gets the series.
    """
    # Machine code counts no references to borrowed arrays.
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
    """Append `node.outgoing`, over `ticks` from now, to line l.

    It begins with a break of `order`, the lowest that theory allows: where less jumps,
    the break gets a higher order. Hard breaks are counted as unread. Nothing more is
    done if the last piece only goes on with the same constant.

    A constant wave that starts to change makes a hard break, however smooth the start
    is. So no piece of any node reaches across the arrival of this wave, and nothing
    moves before it arrives.
    """
    old = lines[l].last_piece
    i = append_values(
        run, lines, log, l, node.now, ticks, node.outgoing, node.scratch_series
    )
    if i != NONE and order <= MAX_HARD_ORDER:  # a hard break, if the wave does jump
        log[i].break_order = order
        classify_break(run, lines, log, old, i)
    if i != NONE and log[i].break_order > MAX_HARD_ORDER:  # no hard break so far
        starts_to_change = log[old].degree == 0 and log[i].degree > 0
        if starts_to_change:
            log[i].break_order = MAX_HARD_ORDER
            lines[l].unread_breaks += 1


def classify_break(run: Run, lines: Lines, log: Log, old: int, i: int) -> None:
    """Raise the order of the break between pieces `old` and i if less jumps.

    Before, `break_order` of piece i is the lowest that theory allows. A wave whose
    value does not jump has order 1 or more; one whose slope and curvature do not jump
    either is SMOOTH. A break that stays hard is counted as unread.

    Jumps of slope and curvature are taken as changes of values, m/s, in a quarter of
    the shortest transit. That is s = (shortest transit)/(2 duration) in y of a piece,
    in which T_m changes by s T_m' + s^2 T_m''/2. At the end of a piece T_m' = m^2 and
    T_m'' = m^2 (m^2 - 1)/3; at its start they have the signs (-1)^(m+1) and (-1)^m.
    """
    before = log[old]
    new = log[i]
    s_before = 0.5 * run.shortest_transit / (before.end - before.start)
    s_new = 0.5 * run.shortest_transit / (new.end - new.start)
    jump = 0.0
    slope = 0.0  # jump of the slope times s
    bend = 0.0  # jump of the curvature times s^2/2
    sign = 1.0  # (-1)^m
    for m in range(POINTS):
        q = m * m
        # Value of the term m at the end of the old piece, where T_m = 1, and at the
        # start of the new one, where T_m = (-1)^m
        b = before.coefficients[m]
        c = sign * new.coefficients[m]
        jump += c - b
        # New slope, -q c s_new, less the old one, q b s_before
        slope -= q * (c * s_new + b * s_before)
        bend += q * (q - 1) / 6 * (c * s_new * s_new - b * s_before * s_before)
        sign = -sign
    if abs(jump) <= CONTINUITY_RTOL * run.tolerance:
        new.break_order = max(new.break_order, 1)
        if abs(slope) + abs(bend) <= SMOOTHNESS_RTOL * run.tolerance:
            new.break_order = SMOOTH
    if new.break_order <= MAX_HARD_ORDER:  # it stays a hard one
        lines[new.line].unread_breaks += 1


def reflect(run: Run, lines: Lines, log: Log, node: Node) -> int:
    """Send the piece that arrives at a free end back, unchanged.

    Return the tick of its end; the caller sets `now` of the node to it. v = (a + b)/2
    and no force: the wave that leaves is the one that arrives, with its break. It is
    appended to the outgoing line from `now` on; a hard break is counted as unread. The
    incoming line is read up to `now`.
    """
    # Side of the node on which its rod is
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
    # Row of the new piece; NONE where the last one goes on with the same constant
    i = append_piece(
        run, lines, log, target, node.now, stop, piece.degree, piece.coefficients
    )
    if i != NONE and node.now == 0:
        # The first piece meets the wave that is under way at t = 0. The order of this
        # break is higher if the values of both agree.
        log[i].break_order = 0
        classify_break(run, lines, log, old, i)
    elif i != NONE and node.now == piece.start + delay:
        # The start of the piece arrives now, and its break is sent on: one more unread
        # break, if it is hard. In the middle of a piece there is no break.
        log[i].break_order = piece.break_order
        lines[target].unread_breaks += piece.break_order <= MAX_HARD_ORDER
    return int(stop)
