"""Kernels of polynomial pieces: series, lines, laws, compiling; in plain Python on
objects.
"""

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial import chebyshev, legendre
from numpy.random import default_rng

from rodimpact.methods import contact_laws, record_lists
from rodimpact.methods.link import Law
from rodimpact.methods.pieces import lines, nodes, profile_pieces, series
from rodimpact.methods.pieces.records import (
    LINE,
    LINK,
    MAX_HARD_ORDER,
    NODE,
    NONE,
    PIECE,
    RUN,
    SMOOTH,
)
from rodimpact.methods.pieces.series import POINTS, N
from rodimpact.methods.signals import Pieces
from rodimpact.methods.states import Status

X = np.array(series.X)  # points of a piece, from -1 to 1
FIRST_LINE = 0  # index of a line in a list of lines
SECOND_LINE = 1


def random_series(seed, n=POINTS):
    """Random Chebyshev coefficients [n]."""
    rng = default_rng(seed)
    return rng.normal(size=n)


def record_with(record, **fields):
    """An object with the fields of a record: those given, and 0 for all others."""
    zeros = np.zeros(1, record)
    (blank,) = record_lists.as_objects(zeros)
    for name, value in fields.items():
        setattr(blank, name, value)
    return blank


def work():
    """Memory for a value at each point, which a kernel writes over."""
    return [0.0] * POINTS


def values_at_points(c):
    """Values of a Chebyshev series at the points of a piece, as a list."""
    return chebyshev.chebval(X, c).tolist()


# Series
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("degree", range(2 * N - 1))
def test_integrals_are_exact_to_the_degree_of_radau(degree):
    """The integral of x^degree from -1 to 1 is exact to round-off."""
    values = X**degree
    difference = 1 - (-1) ** (degree + 1)  # of x^(degree + 1) at the ends
    exact = difference / (degree + 1)

    integral = series.integral(values.tolist())

    assert integral == pytest.approx(exact, abs=1e-14)


def test_the_truncation_estimate_is_the_size_of_the_last_two_coefficients():
    """For random coefficients, the truncation estimate of a series is the sum of the
    absolute values of its last two.
    """
    c = random_series(5)
    values = values_at_points(c)
    last = abs(c[-1])
    last_but_one = abs(c[-2])
    tail = last_but_one + last

    estimate = series.truncation_estimate(values)

    assert estimate == pytest.approx(tail, abs=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_the_smallest_value_of_a_series_is_found(seed):
    """The minimum of a random series is the smallest of 100,001 of its values, to 1e-6."""
    c = random_series(seed)
    c[0] = 0.0
    places = np.linspace(-1, 1, 100_001)
    values = chebyshev.chebval(places, c)

    minimum = series.minimum(c.tolist())

    smallest = values.min()
    assert minimum == pytest.approx(smallest, abs=1e-6)


@pytest.mark.parametrize("end", [-1.0, 1.0])
def test_slopes_at_the_ends_of_a_piece_are_those_of_numpy(end):
    """`slope_at_end` of a random Chebyshev series is its derivative by numpy there."""
    c = random_series(7)
    derivative = chebyshev.chebder(c)
    expected = chebyshev.chebval(end, derivative)

    slope = series.slope_at_end(c.tolist(), end)

    assert slope == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("y", [-0.9, 0.1, 1.0])
def test_a_part_of_a_piece_is_the_same_polynomial(y):
    """`restrict` replaces values at the points of a piece by those of its part from -1
    to y.
    """
    c = random_series(6)
    values = values_at_points(c)

    series.restrict(values, y, work())

    x = (y + 1) * (X + 1) / 2 - 1  # points of the part
    expected = chebyshev.chebval(x, c)
    assert values == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("root", [-0.999, -0.2, 0.6180339887498949, 1.0])
def test_the_first_zero_from_the_left_is_found_to_round_off(root):
    """The function is the parabola (x - root)(x - 3), which is positive on the left."""
    powers = np.polynomial.polynomial.polyfromroots([root, 3.0])
    c = np.zeros(POINTS)
    c[:3] = chebyshev.poly2cheb(powers)

    zero = series.first_zero(c.tolist(), -1.0, 1.0)

    assert zero == pytest.approx(root, abs=1e-15)


@pytest.mark.parametrize("seed", range(8))
def test_the_maximum_is_missed_by_no_more_than_it_says(seed):
    """The largest value of a random series is at an end, or where the derivative is 0;
    the miss is stated, and small.
    """
    decay = 0.2 ** np.arange(POINTS)  # of coefficients, as pieces are smooth
    c = random_series(seed) * decay
    values = values_at_points(c)
    derivative = chebyshev.chebder(c)
    vertices = chebyshev.chebroots(derivative)
    is_real = vertices.imag == 0
    is_inside = is_real & (abs(vertices.real) <= 1)
    vertices_inside = vertices.real[is_inside]
    places = np.append(vertices_inside, [-1.0, 1.0])
    exact = chebyshev.chebval(places, c).max()
    round_off = 2e-15

    maximum = series.maximum(values, work(), -math.inf)

    allowed_error = maximum.miss + round_off
    assert maximum.value == pytest.approx(exact, rel=0, abs=allowed_error)
    assert maximum.miss <= 1e-12 * np.ptp(values)
    assert maximum.value >= max(values)
    at_place = chebyshev.chebval(maximum.position, c)
    assert at_place == pytest.approx(maximum.value, abs=round_off)


@pytest.mark.parametrize("fall", [0.05, 0.2, 0.5])
@pytest.mark.parametrize("seed", range(4))
def test_the_error_of_a_polynomial_is_estimated_where_it_is(fall, seed):
    """The polynomial of degree N is that through the points of a series of 30 terms,
    which `fall` from one to the next.

    The estimate is two thirds of the error at least. Half of the estimates are 100
    times the error at most; the error is less near the points, where the polynomial is
    right.
    """
    signs = np.sign(random_series(seed, n=30))
    c = signs * fall ** np.arange(30)
    values = values_at_points(c)
    polynomial = chebyshev.chebfit(X, values, N)
    round_off = 1e-15

    def largest_estimate(places):
        return max(series.error_at(values, y) for y in places)

    ratios = []
    for y in np.linspace(-0.99, 0.99, 40):
        approximation = chebyshev.chebval(y, polynomial)
        error = abs(chebyshev.chebval(y, c) - approximation)
        estimate = series.error_at(values, y)
        assert error <= 1.5 * estimate + round_off
        ratios.append(estimate / (error + round_off))

    assert np.median(ratios) <= 100
    middles = (X[1:] + X[:-1]) / 2
    assert largest_estimate(X) < largest_estimate(middles)


@pytest.mark.parametrize(("n", "band"), [(8, 24), (24, 8), (40, 3), (5, 1)])
def test_elimination_solves_banded_equations_as_numpy_does(n, band):
    """There are n unknowns; coefficients `band` or more off the diagonal are 0."""
    rng = default_rng(n)
    numbers = np.arange(n)
    off_diagonal = np.abs(numbers[:, None] - numbers)
    is_in_band = off_diagonal < band
    A = rng.normal(size=(n, n)) * is_in_band
    b = rng.normal(size=n)
    rows = np.column_stack((A, b)).tolist()

    series.eliminate(rows, n, band)

    solution = [row[n] for row in rows]  # in place of the right side b
    expected = np.linalg.solve(A, b)
    assert solution == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_what_is_flattened_becomes_the_nearest_parabola():
    """The exponential function becomes its parabola by Legendre's series; so a parabola
    stands for dense breaks.
    """
    exponential = np.exp(X)
    values = exponential.tolist()

    series.flatten(values)

    # The nearest parabola has the first three coefficients of Legendre's series.
    x, weights = legendre.leggauss(20)
    parabola = []
    for k in range(3):
        basis = legendre.Legendre.basis(k)
        projection = weights @ (np.exp(x) * basis(x))
        coefficient = (2 * k + 1) / 2 * projection
        parabola.append(coefficient)
    expected = legendre.legval(X, parabola)
    assert values == pytest.approx(expected, abs=1e-9)
    changes = abs(exponential - values)
    assert changes.max() > 1e-3  # a parabola is not the exponential


# Lines
# --------------------------------------------------------------------------------------


def line_of(*pieces, delay=0):
    """A run, a list of one line that holds these pieces, and the log of pieces.

    A piece is given by its start and end, the order of the break before it and its
    coefficients. In the log there is room for four more.
    """
    last = len(pieces) - 1
    orders_after_first = [order for _, _, order, _ in pieces[1:]]
    hard_breaks = sum(order <= MAX_HARD_ORDER for order in orders_after_first)
    line = record_with(
        LINE,
        delay=delay,
        first_piece=0,
        read_piece=0,
        last_piece=last,
        unread_breaks=hard_breaks,
    )
    blank_rows = np.zeros(len(pieces) + 4, PIECE)
    log = record_lists.as_objects(blank_rows)
    for i, (start, end, order, c) in enumerate(pieces):
        piece = log[i]
        piece.start = start
        piece.end = end
        piece.break_order = order
        is_constant = len(c) == 1
        piece.degree = 0 if is_constant else N
        zeros = [0.0] * (POINTS - len(c))
        piece.coefficients = [*c, *zeros]
        piece.next = i + 1
    log[last].next = NONE
    run = record_with(RUN, tolerance=1e-8, shortest_transit=1000)
    run.piece_count = len(pieces)
    return run, [line], log


DELAY = 1000  # ticks by which the pieces below arrive later than they left
PIECES = [  # start and end, order of the break before, coefficients
    (-1000, -400, SMOOTH, [1.0, 0.5, 0.25]),
    (-400, 100, 0, [3.0]),
    (100, 1000, 1, [0.2, -1.0, 0.3, 0.1]),
]
BREAKS = (600, 1100)  # ticks at which the second and the third piece arrive


def line_of_pieces():
    """The line of `PIECES`, which arrive from tick 0 to 2000, as a list; the log."""
    _, line, log = line_of(*PIECES, delay=DELAY)
    return line, log


def arriving(t, side="right"):
    """Value of the wave that arrives from `PIECES` at tick t; at one of `BREAKS`, its
    limit from the right, in the later piece, or from the left.
    """
    index = np.searchsorted(BREAKS, t, side)  # of the piece that arrives
    start, stop, _, coefficients = PIECES[index]
    since_start = t - DELAY - start
    y = 2 * since_start / (stop - start) - 1  # from -1 to 1 in the piece
    return chebyshev.chebval(y, coefficients)


@pytest.mark.parametrize(
    ("tick", "ticks"), [(0, 300), (0, 600), (350, 700), (1100, 900)]
)
def test_what_left_arrives_a_delay_later(tick, ticks):
    """A line with a delay is sampled over `ticks` from `tick` on. The values are those of
    the Chebyshev series of its pieces, as `arriving` evaluates them.
    """
    line, log = line_of_pieces()
    lines.advance_to(line, log, FIRST_LINE, tick)
    values = work()

    lines.sample(line, log, FIRST_LINE, tick, ticks, values)

    *times, end = tick + ticks * (X + 1) / 2
    expected = [arriving(t) for t in times]
    # If a break is at the end, the last value is the one before it.
    expected.append(arriving(end, side="left"))
    assert values == pytest.approx(expected, abs=1e-13)


def test_breaks_of_a_line_come_in_their_order():
    """`next_break` gives the first of `BREAKS`, 600 and 1100, after a tick, or a given
    end that comes earlier. The line is known until 2000, and may jump (order 0) at 0.
    """
    line, log = line_of_pieces()

    def next_break(tick, end):
        """The first break after a tick; or the end, if there is none before it."""
        return lines.next_break(line, log, FIRST_LINE, tick, end)

    assert lines.known_until(line, log, FIRST_LINE) == 2000
    assert next_break(0, 2000) == 600
    assert next_break(0, 500) == 500
    assert next_break(600, 2000) == 1100
    # Every wave may jump when its line begins.
    assert lines.order_at(line, log, FIRST_LINE, 0) == 0


def test_breaks_that_have_passed_are_left_behind():
    """As a line is read on, the read piece and the number of breaks still ahead change
    when each of `BREAKS`, 600 and 1100, arrives. The break at 600 is a jump (order 0);
    just after it, the wave is smooth.
    """
    line, log = line_of_pieces()

    def read_and_unread(tick):
        """Index of the piece that is read at a tick; number of breaks still ahead."""
        lines.advance_to(line, log, FIRST_LINE, tick)
        read_line = line[FIRST_LINE]
        return read_line.read_piece, read_line.unread_breaks

    assert read_and_unread(599) == (0, 2)
    assert read_and_unread(600) == (1, 1)
    assert lines.order_at(line, log, FIRST_LINE, 600) == 0
    assert lines.order_at(line, log, FIRST_LINE, 601) == SMOOTH  # no piece begins here
    assert read_and_unread(1099) == (1, 1)
    assert read_and_unread(1100) == (2, 0)
    assert read_and_unread(5000) == (2, 0)


def quadrature(tick, ticks):
    """Times and weights over `ticks` from `tick` on: the weighted sum of the values that
    arrive from `PIECES` is their integral.
    """
    breaks = [t for t in BREAKS if tick < t < tick + ticks]
    edges = [tick, *breaks, tick + ticks]
    x, weights = legendre.leggauss(12)
    times = []
    all_weights = []
    for start, stop in pairwise(edges):
        half_duration = (stop - start) / 2
        times.append(start + half_duration * (x + 1))
        all_weights.append(half_duration * weights)
    return np.concatenate(times), np.concatenate(all_weights)


@pytest.mark.parametrize(
    ("tick", "ticks"), [(0, 2000), (500, 300), (550, 700), (1400, 64)]
)
def test_dense_breaks_keep_momentum_and_its_first_moment_and_gain_no_energy(
    tick, ticks
):
    """One smooth piece replaces the wave that arrives for `ticks` from `tick` on:
    integral and first moment stay, and the integral of the square does not grow.
    """
    line, log = line_of_pieces()
    lines.advance_to(line, log, FIRST_LINE, tick)
    smoothed = work()

    lines.project(line, log, FIRST_LINE, tick, ticks, smoothed)

    def integral(values):
        """Integral over the time of the piece of values at its points."""
        return ticks / 2 * series.integral(values.tolist())

    smoothed = np.array(smoothed)
    times, weights = quadrature(tick, ticks)
    arrived = np.array([arriving(t) for t in times])
    momentum = weights @ arrived
    assert integral(smoothed) == pytest.approx(momentum, rel=1e-12)
    energy = weights @ arrived**2
    energy_of_smoothed = integral(smoothed**2)
    assert energy_of_smoothed <= energy * (1 + 1e-12)
    y = 2 * (times - tick) / ticks - 1  # from -1 to 1 in the piece
    first_moment = weights @ (arrived * y)
    moment_of_smoothed = integral(smoothed * X)
    assert moment_of_smoothed == pytest.approx(first_moment, rel=1e-11)


def constant(value):
    """Values of a constant piece."""
    return [value] * POINTS


def append_constant(value, run, line, log):
    """Number of the piece that a constant from tick 100 to 150 adds, or `NONE`."""
    values = constant(value)
    return lines.append_values(run, line, log, FIRST_LINE, 100, 50, values, work())


CONSTANT_PIECE = (0, 100, SMOOTH, [2.0])


def test_what_is_constant_stays_one_piece():
    """The same constant lengthens the piece before and adds none."""
    run, line, log = line_of(CONSTANT_PIECE)

    new_piece = append_constant(2.0, run, line, log)

    assert new_piece == NONE
    assert run.piece_count == 1
    assert log[0].end == 150


def test_another_constant_is_another_piece():
    """A constant other than that of the piece before adds a piece of degree 0."""
    run, line, log = line_of(CONSTANT_PIECE)

    new_piece = append_constant(3.0, run, line, log)

    assert new_piece == 1
    assert run.piece_count == 2
    assert log[1].degree == 0
    assert log[0].next == 1
    assert line[0].last_piece == 1


@pytest.mark.parametrize(
    ("jump", "slope", "bend", "order", "sent"),
    [
        (1e-3, 0.0, 0.0, 0, 0),
        (1e-3, 0.0, 0.0, SMOOTH, SMOOTH),  # theory says that nothing jumps
        (1e-13, 1e-2, 0.0, 0, 1),  # a jump of round-off
        (0.0, 1e-2, 0.0, 1, 1),
        (0.0, 0.0, 1e-2, 1, 1),
        (0.0, 1e-9, 0.0, 1, SMOOTH),  # below tolerance
        (0.0, 0.0, 0.0, 0, SMOOTH),
    ],
)
def test_a_break_is_hard_where_what_jumps_is_above_tolerance(
    jump, slope, bend, order, sent
):
    """The theory gives a break this `order`; it is `sent` with another one by what
    jumps.

    Slope and bend are over the shortest transit, 1000 ticks. The piece before lasts so
    long, the one after 500 ticks.
    """
    before = chebyshev.poly2cheb([0.5, 0.3, 0.1])
    piece_before = (0, 1000, SMOOTH, before.tolist())
    run, line, log = line_of(piece_before)
    # The piece before is 0.5 + 0.3 y + 0.1 y^2 with y = 1 + 2 u, u in transits since
    # the break: it would go on with 0.9 + u + 0.4 u^2.
    u = (X + 1) / 4
    start = 0.9 + jump
    after = start + (1.0 + slope) * u + (0.4 + bend) * u**2
    node = record_with(NODE, now=1000, outgoing=after.tolist())

    lines.send(run, line, log, FIRST_LINE, node, 500, order)

    assert log[1].break_order == sent
    is_hard = sent <= MAX_HARD_ORDER
    assert line[0].unread_breaks == int(is_hard)


@pytest.mark.parametrize(("sent", "order"), [(2.0, 0), (0.5, 1)])
def test_the_first_reflection_of_a_free_end_has_a_break_of_its_order(sent, order):
    """The wave that arrives at a free end begins at t = 0 with 1 - 0.5 and is sent back
    after the constant `sent`: the reflected piece jumps there (order 0), or only its
    slope does (order 1).
    """
    incoming = (-1000, 0, SMOOTH, [1.0, 0.5])
    run, line, log = line_of(incoming, delay=1000)
    empty_line = record_with(LINE, last_piece=NONE)
    line.append(empty_line)
    sent_before = constant(sent)
    lines.append_values(run, line, log, SECOND_LINE, -1000, 1000, sent_before, work())
    end = record_with(
        NODE, incoming_lines=[0, NONE], outgoing_lines=[1, NONE], mobility=[1.0, 0.0]
    )

    end_of_reflection = lines.reflect(run, line, log, end)

    assert end_of_reflection == 1000

    under_way = log[1]
    reflected = log[2]
    assert under_way.next == 2
    assert reflected.end == 1000
    assert reflected.coefficients[:2] == [1.0, 0.5]
    assert reflected.break_order == order
    assert line[1].unread_breaks == 1


@pytest.fixture
def wave_with_a_jump_and_a_kink():
    """Pieces of a signal of straight lines from tick 0 to 1000: constant, from 300 on
    falling, from 700 on rising.
    """
    begins = np.array([1.0, 3.0, 2.0])
    ends = np.array([1.0, 2.0, 4.0])
    starts = [0, 300, 700]
    signal = Pieces.lines(starts, begins, ends, 1000)
    wave, missed = profile_pieces.in_pieces(signal, 0, 1000, 1e-9, 1e-9)
    assert missed == 0
    return wave


def values_at_ends(wave):
    """Values of a wave at the start and at the end of each piece, one after the other."""
    values = []
    for c in wave["coefficients"]:
        values.append(chebyshev.chebval(-1, c))
        values.append(chebyshev.chebval(1, c))
    return values


def test_a_wave_with_a_jump_and_a_kink_becomes_pieces(wave_with_a_jump_and_a_kink):
    """The wave becomes three pieces, with their starts, ends, orders of breaks (0 jump,
    1 kink), values at the ends, and degrees.
    """
    wave = wave_with_a_jump_and_a_kink
    assert wave["start"].tolist() == [0, 300, 700]
    assert wave["end"].tolist() == [300, 700, 1000]
    assert wave["break_order"].tolist() == [SMOOTH, 0, 1]
    values = values_at_ends(wave)
    assert values == pytest.approx([1, 1, 3, 2, 2, 4], abs=1e-12)
    assert wave["degree"].tolist() == [0, N, N]  # what is constant stays so


def test_a_wave_can_run_backwards(wave_with_a_jump_and_a_kink):
    """The reversed wave has the pieces in reverse order, with negated times and
    exchanged ends.
    """
    wave = profile_pieces.backwards(wave_with_a_jump_and_a_kink)
    assert wave["start"].tolist() == [-1000, -700, -300]
    assert wave["end"].tolist() == [-700, -300, 0]
    assert wave["break_order"].tolist() == [SMOOTH, 1, 0]
    values = values_at_ends(wave)
    assert values == pytest.approx([4, 2, 2, 3, 1, 1], abs=1e-12)


# Laws
# --------------------------------------------------------------------------------------

LAWS = {
    "bond": {"law": Law.BOND, "status": Status.BOND},
    "spring": {"law": Law.SPRING, "stiffness": 7.0},
    "dashpot": {"law": Law.SPRING, "stiffness": 7.0, "damping": 0.6},
    "joint": {
        "law": Law.JOINT,
        "stiffness": 7.0,
        "damping": 0.6,
        "status": Status.BOND,
    },
    "Hertz": {"law": Law.POWER, "stiffness": 7.0, "exponent": 1.5},
    "power": {"law": Law.POWER, "stiffness": 7.0, "exponent": 2.3},
    "Hunt-Crossley": {
        "law": Law.POWER,
        "stiffness": 7.0,
        "exponent": 1.5,
        "damping": 0.6,
    },
}


def pressed_link(fields):
    """A link that presses or is bonded, with these fields."""
    all_fields = {"mobility": 0.8, "exponent": 1.0, "status": Status.PRESS}
    all_fields |= fields
    return record_with(LINK, **all_fields)


@pytest.mark.parametrize("fields", LAWS.values(), ids=LAWS)
def test_a_force_satisfies_its_law(fields):
    """The overlap is 0.3 m and the closing velocity 1.7 m/s; a bond takes all of the
    velocity away.
    """
    link = pressed_link(fields)
    overlap = 0.3
    closing = 1.7

    F, _, _ = contact_laws.force(link, overlap, closing)

    rate = closing - link.mobility * F  # what is left of the closing velocity
    if link.law == Law.BOND:
        assert rate == pytest.approx(0.0, abs=1e-15)
    elif link.law == Law.POWER:
        damping_factor = 1 + link.damping * rate
        expected = 7.0 * overlap**link.exponent * damping_factor
        assert pytest.approx(expected) == F
    else:
        expected = 7.0 * overlap + link.damping * rate
        assert pytest.approx(expected) == F


@pytest.mark.parametrize("fields", LAWS.values(), ids=LAWS)
def test_derivatives_of_a_force_are_its_difference_quotients(fields):
    """The derivatives of the force of a link by overlap and by closing velocity are its
    central differences.
    """
    link = pressed_link(fields)
    step = 1e-6
    overlap = 0.3
    closing = 1.7

    def force_at(overlap, closing):
        F, _, _ = contact_laws.force(link, overlap, closing)
        return F

    _, by_overlap, by_closing = contact_laws.force(link, overlap, closing)

    more = force_at(overlap + step, closing)
    less = force_at(overlap - step, closing)
    quotient = (more - less) / (2 * step)
    assert by_overlap == pytest.approx(quotient, rel=1e-7, abs=1e-9)
    more = force_at(overlap, closing + step)
    less = force_at(overlap, closing - step)
    quotient = (more - less) / (2 * step)
    assert by_closing == pytest.approx(quotient, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize(
    ("law", "status", "overlap", "closing", "next_status"),
    [
        (Law.SPRING, Status.OPEN, 1e-3, 1.0, Status.PRESS),
        (Law.SPRING, Status.PRESS, -1e-3, 1.0, Status.OPEN),
        (Law.RIGID, Status.PRESS, 0.0, -1.0, Status.OPEN),
        (Law.YIELD, Status.PRESS, 0.25, 1.0, Status.PLASTIC),
        (Law.YIELD, Status.PLASTIC, 0.5, -1.0, Status.PRESS),
        (Law.YIELD, Status.PLASTIC, 1.0, 5.0, Status.PLASTIC),  # at a knot of its table
        (Law.POWER, Status.PRESS, 0.5, -9.0, Status.GRAZE),
        (Law.POWER, Status.GRAZE, 0.5, 9.0, Status.PRESS),
        (Law.POWER, Status.GRAZE, -0.5, -9.0, Status.OPEN),
    ],
)
def test_one_guard_ends_a_status_and_names_the_next(
    law, status, overlap, closing, next_status
):
    """At this overlap and closing velocity just one guard of the link is negative, and
    names the next status. The law yields at 2 N, from an overlap of 0.2 m on; its table
    goes on at 9 N.
    """
    damping = 0.5 if law == Law.POWER else 0.0
    link = record_with(
        LINK,
        law=law,
        status=status,
        stiffness=10.0,
        exponent=1.0,
        yield_force=2.0,
        resting_force=2.0,
        mobility=0.1,
        damping=damping,
    )
    link.knots[0] = 9.0
    F = 0.0
    if status in (Status.PRESS, Status.PLASTIC):
        F, _, _ = contact_laws.force(link, overlap, closing)

    reached = []
    for i in range(contact_laws.guard_count(link)):
        guard, after = contact_laws.guard(link, i, overlap, closing, F, 1.0, 1.0)
        assert math.isfinite(guard)
        if guard < 0:
            reached.append(after)

    assert reached == [next_status]


@pytest.mark.parametrize(("law", "side"), [(Law.PUSH_LEFT, 0), (Law.PUSH_RIGHT, 1)])
def test_a_force_that_pushes_an_end_is_as_rough_as_the_velocity_it_makes(law, side):
    """The values that come in from one side of a node are a driving force, which makes
    a velocity of 2 mobility F: their truncation error is 2 mobility times that of the
    values; beside a rigid contact they are a velocity, and it is that of the values.
    """
    values = random_series(7)
    truncation = series.truncation_estimate(values.tolist())
    mobility = 0.03
    push = record_with(LINK, law=law, effective_mobility=mobility)
    rigid = record_with(LINK, law=Law.RIGID, effective_mobility=mobility)
    node = record_with(NODE, link_count=1)
    node.incoming[side] = values.tolist()

    of_force = nodes.truncation_error([push], [], node)
    of_velocity = nodes.truncation_error([rigid], [], node)

    assert of_force == pytest.approx(2 * mobility * truncation)
    assert of_velocity == truncation


def test_a_force_that_is_the_difference_of_large_terms_is_found():
    """A light rod parts from a strong dashpot just as fast as this lets go.

    F = g (1 + chi d') is 1e-9 of its terms, so that it has seven digits; Newton's
    method must not ask for more. Once this was said to be a mass that two walls
    squeeze.
    """
    closing = -6.860369287269019e-05
    link = record_with(
        LINK,
        law=Law.POWER.value,
        status=Status.PRESS.value,
        stiffness=0.0013434470567860893,
        exponent=1.5,
        damping=14576.474780119703,
        mobility=0.0037593430123712464,
        overlap=0.18203465728144244,
        overlap_rate=closing,
    )
    mobilities = [5.60433405e-09, 3.75933741e-03]  # on the left, on the right
    node = record_with(NODE, link_count=1, mobility=mobilities)
    velocity = -0.11930282
    node.incoming[0] = constant(velocity)
    for j in range(POINTS):
        round_off = (j % 2) * 1.4e-17
        node.incoming[1][j] = velocity - closing + round_off
    run = record_with(RUN, velocity_scale=1.1193)
    matrix = np.zeros((N, N + 1)).tolist()

    converged = nodes.collocate(run, [link], [], node, 8.4e-14, matrix)

    assert converged
    assert np.abs(link.force).max() < 1e-11
