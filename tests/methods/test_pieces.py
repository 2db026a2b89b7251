"""Kernels of polynomial pieces: series, lines, laws, compiling; in plain Python on objects."""

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial import chebyshev, legendre

from rodimpact.methods import contact_laws, record_lists
from rodimpact.methods.link import Law
from rodimpact.methods.pieces import lines, nodes, profile_pieces, series
from rodimpact.methods.pieces.records import (
    HARD,
    LINE,
    LINK,
    NODE,
    NONE,
    PIECE,
    RUN,
    SMOOTH,
)
from rodimpact.methods.pieces.series import POINTS, N
from rodimpact.methods.signals import Pieces
from rodimpact.methods.states import Status

X = np.array(series.X)


def drawn(seed, n=POINTS):
    return np.random.default_rng(seed).normal(size=n)


def one(record, **fields):
    """An object with the fields of a record; those that are not given are 0."""
    made = record_lists.as_objects(np.zeros(1, record))[0]
    for name, value in fields.items():
        setattr(made, name, value)
    return made


# Series ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("degree", range(2 * N - 1))
def test_integrals_are_exact_to_the_degree_of_radau(degree):
    exact = (1 - (-1) ** (degree + 1)) / (degree + 1)
    assert series.integral((X**degree).tolist()) == pytest.approx(exact, abs=1e-14)


def test_the_tail_is_that_of_the_last_two_coefficients():
    c = drawn(5)
    assert series.truncation_estimate(
        chebyshev.chebval(X, c).tolist()
    ) == pytest.approx(abs(c[-2]) + abs(c[-1]), abs=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_the_smallest_value_of_a_series_is_found(seed):
    c = drawn(seed)
    c[0] = 0.0
    least = chebyshev.chebval(np.linspace(-1, 1, 100_001), c).min()
    assert series.minimum(c.tolist()) == pytest.approx(least, abs=1e-6)


@pytest.mark.parametrize("end", [-1.0, 1.0])
def test_slopes_at_the_ends_of_a_piece(end):
    c = drawn(7)
    wanted = chebyshev.chebval(end, chebyshev.chebder(c))
    assert series.slope_at_end(c.tolist(), end) == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("y", [-0.9, 0.1, 1.0])
def test_a_part_of_a_piece_is_the_same_polynomial(y):
    c = drawn(6)
    f = chebyshev.chebval(X, c).tolist()
    series.restrict(f, y, [0.0] * POINTS)
    assert f == pytest.approx(
        chebyshev.chebval((y + 1) * (X + 1) / 2 - 1, c), abs=1e-13
    )


@pytest.mark.parametrize("root", [-0.999, -0.2, 0.6180339887498949, 1.0])
def test_the_first_zero_is_found_to_round_off(root):
    c = chebyshev.poly2cheb(np.polynomial.polynomial.polyfromroots([root, 3.0]))
    c = np.append(c, np.zeros(POINTS - 3)).tolist()  # positive on the left
    zero = series.first_zero(c, -1.0, 1.0)
    assert zero == pytest.approx(root, abs=1e-15)


@pytest.mark.parametrize("seed", range(8))
def test_the_maximum_is_that_of_a_fine_grid(seed):
    rng = np.random.default_rng(seed)
    c = rng.normal(size=POINTS) * 0.2 ** np.arange(POINTS)  # smooth, as pieces are
    f = chebyshev.chebval(X, c).tolist()
    fine = chebyshev.chebval(np.linspace(-1, 1, 20001), c).max()
    assert series.maximum(f, [0.0] * POINTS, -math.inf) == pytest.approx(fine, abs=1e-7)
    assert series.maximum(f, [0.0] * POINTS, -math.inf) >= max(f)


@pytest.mark.parametrize(("n", "band"), [(8, 24), (24, 8), (40, 3), (5, 1)])
def test_elimination_with_bands(n, band):
    rng = np.random.default_rng(n)
    near = np.abs(np.subtract.outer(np.arange(n), np.arange(n))) < band
    A = rng.normal(size=(n, n)) * near
    b = rng.normal(size=n)
    G = np.column_stack((A, b)).tolist()
    series.eliminate(G, n, band)
    assert [row[n] for row in G] == pytest.approx(
        np.linalg.solve(A, b), rel=1e-9, abs=1e-9
    )


def test_what_stands_for_dense_breaks_is_the_nearest_parabola():
    found = np.exp(X).tolist()
    series.flatten(found)
    nodes, weights = legendre.leggauss(20)
    exact = [
        (2 * k + 1) / 2 * weights @ (np.exp(nodes) * legendre.Legendre.basis(k)(nodes))
        for k in range(3)
    ]
    assert found == pytest.approx(legendre.legval(X, exact), abs=1e-9)
    assert max(abs(np.exp(X) - found)) > 1e-3  # of degree 2 alone


# Lines -------------------------------------------------------------------------------------------


def stock(*pieces, delay=0, room=4, **run):
    """Run, lines and log with one line that holds these pieces: (start, end, order, series)."""
    run = one(RUN, tolerance=1e-8, shortest_transit=1000, **run)
    line = [
        one(
            LINE,
            delay=delay,
            first_piece=0,
            read_piece=0,
            last_piece=len(pieces) - 1,
            unread_breaks=sum(order <= HARD for _, _, order, _ in pieces[1:]),
        )
    ]
    log = record_lists.as_objects(np.zeros(len(pieces) + room, PIECE))
    for i, (start, stop, order, c) in enumerate(pieces):
        it = log[i]
        it.start = start
        it.stop = stop
        it.order = order
        it.degree = N if len(c) > 1 else 0
        it.coefficient = [*c, *[0.0] * (POINTS - len(c))]
        it.after = i + 1 if i + 1 < len(pieces) else NONE
    run.pieces = len(pieces)
    return run, line, log


PIECES = [
    (-1000, -400, SMOOTH, [1.0, 0.5, 0.25]),
    (-400, 100, 0, [3.0]),
    (100, 1000, 1, [0.2, -1.0, 0.3, 0.1]),
]


def arriving(t, delay, before=False):
    """What the pieces above bring at a tick."""
    i = np.searchsorted([-400, 100], t - delay, "left" if before else "right")
    start, stop, _, c = PIECES[i]
    return chebyshev.chebval(2 * (t - delay - start) / (stop - start) - 1, c)


@pytest.mark.parametrize(
    ("tick", "ticks"), [(0, 300), (0, 600), (350, 700), (1100, 900)]
)
def test_what_left_arrives_a_delay_later(tick, ticks):
    _, line, log = stock(*PIECES, delay=1000)
    f = [0.0] * POINTS
    lines.advance_to(line, log, 0, tick)
    lines.sample(line, log, 0, tick, ticks, f)
    t = tick + ticks * (X + 1) / 2
    wanted = [arriving(float(u), 1000, before=j == N) for j, u in enumerate(t)]
    assert f == pytest.approx(wanted, abs=1e-13)


def test_breaks_of_a_line_in_their_order():
    _, line, log = stock(*PIECES, delay=1000)
    assert lines.known_until(line, log, 0) == 2000
    assert lines.next_break(line, log, 0, 0, 2000) == 600
    assert lines.next_break(line, log, 0, 0, 500) == 500
    assert lines.next_break(line, log, 0, 600, 2000) == 1100
    assert lines.order_at(line, log, 0, 0) == 0  # at the beginning anything may jump
    lines.advance_to(line, log, 0, 599)
    assert (line[0].read_piece, line[0].unread_breaks) == (0, 2)
    lines.advance_to(line, log, 0, 600)
    assert (line[0].read_piece, line[0].unread_breaks) == (1, 1)
    assert lines.order_at(line, log, 0, 600) == 0
    assert lines.order_at(line, log, 0, 601) == SMOOTH
    lines.advance_to(line, log, 0, 5000)
    assert (line[0].read_piece, line[0].unread_breaks) == (2, 0)


@pytest.mark.parametrize(
    ("tick", "ticks"), [(0, 2000), (500, 300), (550, 700), (1400, 64)]
)
def test_dense_breaks_keep_their_momentum_and_gain_no_energy(tick, ticks):
    _, line, log = stock(*PIECES, delay=1000)
    f = [0.0] * POINTS
    lines.advance_to(line, log, 0, tick)
    lines.project(line, log, 0, tick, ticks, f)
    edges = sorted(
        {tick, tick + ticks, *(e for e in (600, 1100) if tick < e < tick + ticks)}
    )
    nodes, weights = legendre.leggauss(12)
    t = np.concatenate([a + (b - a) * (nodes + 1) / 2 for a, b in pairwise(edges)])
    w = np.concatenate([(b - a) / 2 * weights for a, b in pairwise(edges)])
    came = np.array([arriving(x, 1000) for x in t])
    kept = ticks / 2 * series.integral(f)
    energy = ticks / 2 * series.integral([v * v for v in f])
    assert kept == pytest.approx(w @ came, rel=1e-12)
    assert energy <= w @ came**2 * (1 + 1e-12)
    moment = (
        ticks / 2 * series.integral([v * y for v, y in zip(f, series.X, strict=True)])
    )
    assert moment == pytest.approx(w @ (came * (2 * (t - tick) / ticks - 1)), rel=1e-11)


def test_what_is_constant_stays_one_piece():
    run, line, log = stock((0, 100, SMOOTH, [2.0]))
    assert (
        lines.append_values(run, line, log, 0, 100, 50, [2.0] * POINTS, [0.0] * POINTS)
        == NONE
    )
    assert (run.piece_count, log[0].end) == (1, 150)
    assert (
        lines.append_values(run, line, log, 0, 150, 50, [3.0] * POINTS, [0.0] * POINTS)
        == 1
    )
    assert (run.piece_count, log[1].degree) == (2, 0)
    assert (log[0].next, line[0].last_piece) == (1, 1)


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
    """Slope and bend over the shortest transit, 1000 ticks; pieces of 1000 and 500."""
    run, line, log = stock(
        (0, 1000, SMOOTH, chebyshev.poly2cheb([0.5, 0.3, 0.1]).tolist())
    )
    u = (X + 1) / 4  # transits since the break
    f = (
        0.9 + jump + (2 * 0.5 + slope) * u + (4 * 0.1 + bend) * u**2
    )  # y = 1 + 2 u before
    node = one(NODE, now=1000, outgoing=f.tolist())
    lines.send(run, line, log, 0, node, 500, order)
    assert (log[1].break_order, line[0].unread_breaks) == (sent, int(sent <= HARD))


@pytest.mark.parametrize(("sent", "order"), [(2.0, 0), (0.5, 1)])
def test_what_a_free_end_sends_back_first_may_jump(sent, order):
    """What arrives at t = 0 begins with 0.5, and is sent after what is under way."""
    run, line, log = stock((-1000, 0, SMOOTH, [1.0, 0.5]), delay=1000)
    line.append(one(LINE, last_piece=NONE))
    lines.append_values(run, line, log, 1, -1000, 1000, [sent] * POINTS, [0.0] * POINTS)
    end = one(
        NODE, incoming_lines=[0, NONE], outgoing_lines=[1, NONE], mobility=[1.0, 0.0]
    )
    assert lines.reflect(run, line, log, end) == 1000
    assert (log[1].next, log[2].end) == (2, 1000)
    assert log[2].coefficients[:2] == [1.0, 0.5]
    assert (log[2].break_order, line[1].unread_breaks) == (order, 1)


def test_a_wave_with_a_jump_and_a_kink_becomes_pieces_either_way():
    signal = Pieces.lines(
        [0, 300, 700], np.array([1.0, 3.0, 2.0]), np.array([1.0, 2.0, 4.0]), 1000
    )
    made, missed = profile_pieces.in_pieces(signal, 0, 1000, 1e-9, 1e-9)
    assert missed == 0
    back = profile_pieces.backwards(made)
    assert (made["start"].tolist(), made["break_order"].tolist()) == (
        [0, 300, 700],
        [SMOOTH, 0, 1],
    )
    assert (back["start"].tolist(), back["break_order"].tolist()) == (
        [-1000, -700, -300],
        [SMOOTH, 1, 0],
    )
    assert (made["end"].tolist(), back["end"].tolist()) == (
        [300, 700, 1000],
        [-700, -300, 0],
    )
    for fit, ends in ((made, [1, 1, 3, 2, 2, 4]), (back, [4, 2, 2, 3, 1, 1])):
        found = [chebyshev.chebval(y, c) for c in fit["coefficients"] for y in (-1, 1)]
        assert found == pytest.approx(ends, abs=1e-12)
    assert made["degree"].tolist() == [0, N, N]  # what is constant stays so


# Laws --------------------------------------------------------------------------------------------

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


@pytest.mark.parametrize("name", LAWS)
def test_a_force_satisfies_its_law_and_has_these_derivatives(name):
    it = one(
        LINK, **{"mobility": 0.8, "exponent": 1.0, "status": Status.PRESS, **LAWS[name]}
    )
    d = 0.3
    closing = 1.7
    small = 1e-6
    F, by_d, by_closing = contact_laws.force(it, d, closing)
    rate = closing - it.mobility * F
    if it.law == Law.BOND:
        assert rate == pytest.approx(0.0, abs=1e-15)
    elif it.law == Law.POWER:
        assert pytest.approx(F) == 7.0 * d**it.exponent * (1 + it.damping * rate)
    else:
        assert pytest.approx(F) == 7.0 * d + it.damping * rate
    around = [contact_laws.force(it, d + i * small, closing)[0] for i in (-1, 1)]
    assert by_d == pytest.approx(
        (around[1] - around[0]) / (2 * small), rel=1e-7, abs=1e-9
    )
    around = [contact_laws.force(it, d, closing + i * small)[0] for i in (-1, 1)]
    assert by_closing == pytest.approx(
        (around[1] - around[0]) / (2 * small), rel=1e-7, abs=1e-9
    )


@pytest.mark.parametrize(
    ("law", "status", "d", "closing", "to"),
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
def test_what_ends_a_status(law, status, d, closing, to):
    it = one(
        LINK,
        law=law,
        status=status,
        stiffness=10.0,
        exponent=1.0,
        yield_force=2.0,
        resting_force=2.0,
        mobility=0.1,
        damping=0.5 if law == Law.POWER else 0.0,
    )
    it.knots[0] = 9.0
    F = (
        contact_laws.force(it, d, closing)[0]
        if status in (Status.PRESS, Status.PLASTIC)
        else 0.0
    )
    ended = [
        after
        for g, after in (
            contact_laws.guard(it, i, d, closing, F, 1.0, 1.0)
            for i in range(contact_laws.guards(it))
        )
        if g < 0
    ]
    assert ended == [to]
    assert all(
        math.isfinite(contact_laws.guard(it, i, d, closing, F, 1.0, 1.0)[0])
        for i in range(contact_laws.guards(it))
    )


@pytest.mark.parametrize(("law", "side"), [(Law.PUSH_LEFT, 0), (Law.PUSH_RIGHT, 1)])
def test_a_force_that_pushes_an_end_is_as_rough_as_the_velocity_it_makes(law, side):
    """What comes in is a force there, and a velocity at the other side."""
    forces = drawn(7).tolist()
    link = one(LINK, law=law, effective_mobility=0.03)
    node = one(NODE, link_count=1)
    node.incoming[side] = forces
    estimate = series.truncation_estimate(forces)
    error = nodes.truncation_error([link], [], node)
    assert error == pytest.approx(2 * 0.03 * estimate)
    link.law = Law.RIGID
    assert nodes.truncation_error([link], [], node) == estimate


# A force that is almost 0


def test_a_force_that_is_the_difference_of_large_terms_is_found():
    """A light rod parts from a strong dashpot just as fast as this lets go.

    F = g (1 + chi d') is 1e-9 of its terms, so that it has seven digits; Newton's method must not
    ask for more. Once this was said to be a mass that two walls squeeze.
    """
    closing = -6.860369287269019e-05
    link = one(
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
    node = one(NODE, link_count=1, mobility=[5.60433405e-09, 3.75933741e-03])
    node.incoming[0] = [-0.11930282] * POINTS
    for j in range(POINTS):  # round-off of the last digit
        node.incoming[1][j] = -0.11930282 - closing + (j % 2) * 1.4e-17
    run = one(RUN, velocity_scale=1.1193)
    matrix = np.zeros((N, N + 1)).tolist()
    assert nodes.collocate(run, [link], [], node, 8.4e-14, matrix)
    assert np.all(np.abs(link.force) < 1e-11)
