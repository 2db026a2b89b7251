"""Signals in time: steps beside sums over ticks, polynomials beside NumPy and SciPy."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Chebyshev
from numpy.random import default_rng
from scipy.integrate import quad

from rodimpact.methods.signals import LINE_RTOL, Pieces

STEPS = st.lists(
    st.tuples(st.integers(0, 60), st.integers(-5, 5)),
    min_size=1,
    max_size=8,
    unique_by=lambda step: step[0],
).map(sorted)
"""Steps of a signal in the order of time, each a tick and the value from then on."""
TICKS = st.integers(-20, 80)
"""Ticks before, among and after those of `STEPS`."""


def signal_of(steps):
    """A signal of constant pieces, from (tick, value) of each."""
    ticks = [tick for tick, _ in steps]
    values = [float(value) for _, value in steps]
    return Pieces(ticks, values)


def value_at(steps, t):
    """Value of a step function, given as pairs of tick and value: the value of the last
    step at or before t, or of the first step if t is before all.
    """
    _, value = steps[0]
    for tick, later_value in steps:
        if tick <= t:
            value = later_value
    return value


@given(STEPS, TICKS, TICKS)
def test_steps_have_their_values_on_both_sides_of_ticks_and_their_integrals(
    steps, t, u
):
    """Integrals are sums of the values from tick to tick."""
    low = min(t, u)
    high = max(t, u)
    exact = sum(value_at(steps, k) for k in range(low, high))

    signal = signal_of(steps)

    assert signal.at(t) == value_at(steps, t)
    value_before = value_at(steps, t - 1)
    assert signal.at(t, "left") == value_before
    assert signal.integral(low, high) == exact
    assert signal.integral(high, low) == -exact


@given(STEPS, STEPS, TICKS, st.integers(0, 60), st.integers(-30, 130))
def test_integrals_of_products_of_steps_are_sums_over_ticks(
    first, second, start, length, about
):
    """The integral of the product of two step signals is the sum over ticks, also with
    the second signal s reversed in time, s(about - t).
    """
    stop = start + length
    exact = 0
    exact_backwards = 0
    for k in range(start, stop):
        value = value_at(first, k)
        exact += value * value_at(second, k)
        # From tick k to k + 1 the other runs backwards from about - k to about - k - 1.
        value_backwards = value_at(second, about - k - 1)
        exact_backwards += value * value_backwards

    f = signal_of(first)
    g = signal_of(second)
    product = f * g
    product_backwards = f * g.time_reversed(about)

    assert product.integral(start, stop) == exact
    assert product_backwards.integral(start, stop) == exact_backwards


# Polynomial pieces, beside NumPy's polynomials and SciPy's quadrature

LATE = 1 << 50  # a tick that a long run may come to; ticks count from it in floats


def random_pieces(seed, size=9, count=6):
    """Pieces of unequal length from tick LATE on, and the same as NumPy's polynomials.

    There are `count` pieces with `size` coefficients each. The polynomials are of the
    ticks since LATE.
    """
    rng = default_rng(seed)
    durations = rng.integers(3, 1 << 30, count)
    times = np.append(0, np.cumsum(durations))
    decay = (1 + np.arange(size)) ** 2  # high degrees matter less, as in smooth signals
    coefficients = rng.normal(size=(count, size)) / decay
    polynomials = []
    spans = pairwise(times)
    for c, (begin, end) in zip(coefficients, spans, strict=True):
        domain = [float(begin), float(end)]
        polynomials.append(Chebyshev(c, domain=domain))
    *begins, end = LATE + times
    signal = Pieces(np.array(begins), coefficients, end)
    return signal, polynomials


def exact_value(polynomials, t):
    """Value of piecewise polynomials at t ticks after LATE; outside of them, their
    first or last value.
    """
    first = polynomials[0].domain[0]
    last = polynomials[-1].domain[1]
    inside = min(max(t, first), last)
    begun = [p for p in polynomials if p.domain[0] <= inside]
    current = begun[-1]
    return current(inside)


def breaks_of(polynomials):
    """Times at which the polynomials begin, and the end of the last, from LATE on."""
    begins = [p.domain[0] for p in polynomials]
    end = polynomials[-1].domain[1]
    return [*begins, end]


def integrated(function, start, stop, breaks):
    """Integral of a function from start to stop by SciPy, over each part between
    breaks.
    """
    inside = [t for t in breaks if start < t < stop]
    total = 0.0
    edges = sorted({start, *inside, stop})
    for low, high in pairwise(edges):
        integral, _ = quad(function, low, high, epsabs=0, epsrel=1e-12)
        total += integral
    return total


@pytest.mark.parametrize("seed", range(3))
def test_values_of_polynomials_are_those_of_numpy(seed):
    """A random signal has the values of the numpy polynomials of which it is made, also
    before its start and after its end.
    """
    signal, polynomials = random_pieces(seed)
    rng = default_rng(seed)
    low = signal.ticks[0] - 1000  # before the first piece
    high = signal.end + 1000  # after the last
    ticks = rng.integers(low, high, 50)
    times = [float(t - LATE) for t in ticks]
    expected = [exact_value(polynomials, t) for t in times]
    assert signal.at(ticks) == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("seed", range(3))
def test_polynomials_have_two_sides_at_breaks(seed):
    """The values of a random signal at its breaks are those of the later polynomial,
    and with "left" those of the earlier one; the two differ.
    """
    signal, polynomials = random_pieces(seed)
    at_begins = [p(p.domain[0]) for p in polynomials]
    at_ends = [p(p.domain[1]) for p in polynomials]
    breaks = signal.ticks[1:]
    before = signal.at(breaks, "left")
    after = signal.values[1:]
    assert signal.values == pytest.approx(at_begins, abs=1e-13)
    assert before == pytest.approx(at_ends[:-1], abs=1e-13)
    jumps = np.abs(before - after)
    assert jumps.min() > 1e-3  # the two sides differ


@pytest.mark.parametrize("seed", range(3))
def test_integrals_of_polynomials_and_of_their_products_are_those_of_scipy(seed):
    """The integrals of piecewise polynomials f, forth and back, of f g, and of f times
    the time-reversed g, from `start` to beyond the end of both, are those of scipy.
    """
    f, polynomials_of_f = random_pieces(seed)
    g, polynomials_of_g = random_pieces(seed + 10, size=4, count=9)
    start = int(f.ticks[1]) - 99
    stop = max(f.end, g.end) + 999  # beyond the end, too
    low = float(start - LATE)
    high = float(stop - LATE)
    span = high - low
    breaks_of_f = breaks_of(polynomials_of_f)
    breaks_of_g = breaks_of(polynomials_of_g)
    breaks_backwards = [low + high - t for t in breaks_of_g]

    def f_at(t):
        return exact_value(polynomials_of_f, t)

    def g_at(t):
        return exact_value(polynomials_of_g, t)

    mean = integrated(f_at, low, high, breaks_of_f) / span
    forth, back = f.integral([start, stop], [stop, start]) / span
    assert forth == pytest.approx(mean, abs=1e-12)
    assert back == pytest.approx(-mean, abs=1e-12)

    breaks = breaks_of_f + breaks_of_g
    mean = integrated(lambda t: f_at(t) * g_at(t), low, high, breaks) / span
    product = f * g
    assert product.integral(start, stop) / span == pytest.approx(mean, abs=1e-12)

    def product_backwards_at(t):
        return f_at(t) * g_at(low + high - t)

    breaks = breaks_of_f + breaks_backwards
    mean = integrated(product_backwards_at, low, high, breaks) / span
    product = f * g.time_reversed(start + stop)
    mean_of_product = product.integral(start, stop) / span
    assert mean_of_product == pytest.approx(mean, abs=1e-12)


@pytest.mark.parametrize("size", [1, 2, 9])
def test_difference_product_delay_sum_and_multiple_have_their_values(size):
    """At random ticks, f - g, f g and 3 (f + 2), delayed by 5 ticks, of two piecewise
    polynomials have the values that follow from those of f and g.
    """
    f, _ = random_pieces(1, size=size)
    g, _ = random_pieces(2, count=3)  # with other breaks and another degree
    rng = default_rng(3)
    first_end = min(f.end, g.end)
    ticks = rng.integers(f.ticks[0], first_end, 40)
    of_f = f.at(ticks)
    of_g = g.at(ticks)

    difference = f - g
    product = f * g
    delayed = f.delayed(5)
    changed = delayed.plus(2.0).times(3.0)

    expected_difference = of_f - of_g
    expected_product = of_f * of_g
    expected_changed = 3 * (of_f + 2)
    assert difference.at(ticks) == pytest.approx(expected_difference, abs=1e-13)
    assert product.at(ticks) == pytest.approx(expected_product, abs=1e-13)
    assert changed.at(ticks + 5) == pytest.approx(expected_changed, abs=1e-13)


@pytest.mark.parametrize("size", [1, 2, 9])
def test_a_part_of_a_signal_has_its_values(size):
    """The part of a signal between two breaks has fewer pieces and, at random ticks,
    the same values bit for bit.
    """
    signal, _ = random_pieces(1, size=size)
    start = int(signal.ticks[1])
    stop = int(signal.ticks[3])

    part = signal.within(start, stop)

    assert len(part.ticks) < len(signal.ticks)
    rng = default_rng(3)
    ticks = rng.integers(start, stop + 1, 40)
    values_of_part = part.at(ticks)
    assert np.array_equal(values_of_part, signal.at(ticks))


def test_straight_lines_between_marks_follow_a_signal():
    """Straight lines between the `marks` of a random signal miss it by less than twice
    `LINE_RTOL` of its range, and there are not too many marks.
    """
    signal, _ = random_pieces(5)
    marks = signal.marks
    at_marks = signal.at(marks)
    rng = default_rng(5)
    ticks = rng.integers(signal.ticks[0], signal.end, 2000)

    # Ticks as late as these are subtracted as integers: floats would round them.
    times = (ticks - LATE).astype(float)
    times_of_marks = (marks - LATE).astype(float)
    lines = np.interp(times, times_of_marks, at_marks)

    # The bound of `marks` is on the sum of the coefficients, which exceeds the range.
    errors = np.abs(lines - signal.at(ticks))
    scale = np.ptp(at_marks)
    assert errors.max() < 2 * LINE_RTOL * scale
    # A line over one of n parts of a piece misses it by about its bend/(2 n^2). The
    # bends of these pieces are up to some 10 ranges of the signal.
    most_parts = 4 / np.sqrt(LINE_RTOL)  # of a piece
    n_pieces = len(signal.ticks)
    assert len(marks) < most_parts * n_pieces


def test_a_constant_signal_needs_no_marks_but_its_breaks():
    one = [1.0, 0.0]  # a constant, as a polynomial of degree 1
    constant = Pieces([0, 3], [one, one], 9)
    assert constant.marks.tolist() == [0, 3, 9]


def test_what_acts_for_a_moment_does_not_gather_round_off_afterwards():
    """A signal acts in one early piece of 40,000, as the force of a wall that a bar
    left long ago. Its double integral at the end is impulse times the time since, to
    1e-14.
    """
    count = 40000
    width = 7  # ticks of a piece
    force = np.zeros((count, 1))  # constant pieces
    force[7] = 0.1
    end = count * width
    starts = np.arange(count) * width
    signal = Pieces(starts, force)
    impulse = 0.1 * width
    middle = 7.5 * width  # of the piece in which it acts
    time_since = end - middle

    integral = signal.integrated_twice(end)

    expected = impulse * time_since
    assert integral == pytest.approx(expected, rel=1e-14)
