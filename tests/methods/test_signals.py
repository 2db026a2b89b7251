from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Chebyshev
from scipy.integrate import quad

from rodimpact.methods.signals import Pieces

steps = st.lists(
    st.tuples(st.integers(0, 60), st.integers(-5, 5)),
    min_size=1,
    max_size=8,
    unique_by=lambda pair: pair[0],
).map(sorted)


def signal(pairs):
    return Pieces([t for t, _ in pairs], [float(v) for _, v in pairs])


def brute(pairs, t):
    values = [v for tick, v in pairs if tick <= t]
    return values[-1] if values else pairs[0][1]


@given(steps, st.integers(-20, 80), st.integers(-20, 80))
def test_value_limits_and_integral(pairs, t, u):
    s = signal(pairs)
    assert s.at(t) == brute(pairs, t)
    assert s.at(t, "left") == brute(pairs, t - 1)
    low = min(t, u)
    high = max(t, u)
    exact = sum(brute(pairs, k) for k in range(low, high))
    assert s.integral(low, high) == exact
    assert s.integral(high, low) == -exact


@given(steps, steps, st.integers(-20, 80), st.integers(0, 60), st.integers(-30, 130))
def test_integral_of_a_product(f, g, start, length, about):
    stop = start + length
    plain = sum(brute(f, k) * brute(g, k) for k in range(start, stop))
    assert (signal(f) * signal(g)).integral(start, stop) == plain
    turned = sum(brute(f, k) * brute(g, about - k - 1) for k in range(start, stop))
    assert (signal(f) * signal(g).time_reversed(about)).integral(start, stop) == turned


# Polynomial pieces, beside NumPy's polynomials and SciPy's quadrature

LATE = 1 << 50  # ticks at which a run may be


def random_pieces(seed, size=9, count=6, start=LATE):
    """Pieces of unequal length, and the same as NumPy's polynomials in time from `start`."""
    rng = np.random.default_rng(seed)
    ticks = start + np.concatenate(([0], np.cumsum(rng.integers(3, 1 << 30, count))))
    coefficients = rng.normal(size=(count, size)) / (1 + np.arange(size)) ** 2
    known = [
        Chebyshev(c, domain=[a, b])
        for c, a, b in zip(
            coefficients,
            (ticks[:-1] - start).astype(float),
            (ticks[1:] - start).astype(float),
            strict=True,
        )
    ]
    return Pieces(ticks[:-1], coefficients, ticks[-1]), known


def exactly(known, t):
    """Value at t, from the start; the first and the last value hold outside."""
    t = min(max(t, known[0].domain[0]), known[-1].domain[1])
    return next(p for p in reversed(known) if p.domain[0] <= t)(t)


def integrated(function, known, start, stop, *more):
    """By SciPy, from break to break."""
    breaks = sorted(
        {start, stop, *(p.domain[0] for p in known), known[-1].domain[1], *more}
    )
    inside = [t for t in breaks if start <= t <= stop]
    return sum(
        quad(function, a, b, epsabs=0, epsrel=1e-12)[0] for a, b in pairwise(inside)
    )


@pytest.mark.parametrize("seed", range(3))
def test_polynomials_are_those_of_numpy(seed):
    signal, known = random_pieces(seed)
    rng = np.random.default_rng(seed)
    ticks = rng.integers(signal.ticks[0] - 1000, signal.end + 1000, 50)
    wanted = [exactly(known, float(t - LATE)) for t in ticks]
    assert signal.at(ticks) == pytest.approx(wanted, abs=1e-13)
    assert signal.values == pytest.approx([p(p.domain[0]) for p in known], abs=1e-13)
    before = signal.at(signal.ticks[1:], "left")
    assert before == pytest.approx([p(p.domain[1]) for p in known[:-1]], abs=1e-13)
    assert np.abs(before - signal.values[1:]).min() > 1e-3  # the two sides differ


@pytest.mark.parametrize("seed", range(3))
def test_integrals_of_polynomials(seed):
    f, known = random_pieces(seed)
    g, others = random_pieces(seed + 10, size=4, count=9)
    start, stop = int(f.ticks[1]) - 99, max(f.end, g.end) + 999  # beyond the end, too
    low = float(start - LATE)
    high = float(stop - LATE)
    breaks = [p.domain[0] for p in others] + [others[-1].domain[1]]
    span = high - low
    by_scipy = integrated(lambda t: exactly(known, t), known, low, high)
    assert f.integral([start, stop], [stop, start]) / span == pytest.approx(
        np.array([1, -1]) * by_scipy / span, abs=1e-12
    )
    both = integrated(
        lambda t: exactly(known, t) * exactly(others, t), known, low, high, *breaks
    )
    assert (f * g).integral(start, stop) / span == pytest.approx(both / span, abs=1e-12)
    turned = integrated(
        lambda t: exactly(known, t) * exactly(others, low + high - t),
        known,
        low,
        high,
        *(low + high - t for t in breaks),
    )
    found = (f * g.time_reversed(start + stop)).integral(start, stop)
    assert found / span == pytest.approx(turned / span, abs=1e-12)


@pytest.mark.parametrize("size", [1, 2, 9])
def test_signals_that_are_made_of_others(size):
    f = random_pieces(1, size)[0]
    g = random_pieces(2, count=3)[0]
    ticks = np.random.default_rng(3).integers(f.ticks[0], min(f.end, g.end), 40)
    assert (f - g).at(ticks) == pytest.approx(f.at(ticks) - g.at(ticks), abs=1e-13)
    assert (f * g).at(ticks) == pytest.approx(f.at(ticks) * g.at(ticks), abs=1e-13)
    later = f.later(5).plus(2.0).times(3.0)
    assert later.at(ticks + 5) == pytest.approx(3 * (f.at(ticks) + 2), abs=1e-13)
    start = int(f.ticks[1])
    stop = int(f.ticks[3])
    inside = f.within(start, stop)
    assert len(inside.ticks) < len(f.ticks)
    between = ticks[(ticks >= start) & (ticks <= stop)]
    assert (inside.at(between) == f.at(between)).all()


def test_straight_lines_between_marks_follow_a_signal():
    f, _ = random_pieces(5)
    ticks = np.random.default_rng(5).integers(f.ticks[0], f.end, 2000)
    lines = np.interp(
        (ticks - LATE).astype(float), (f.marks - LATE).astype(float), f.at(f.marks)
    )
    swing = np.ptp(f.at(f.marks))
    assert np.abs(lines - f.at(ticks)).max() < 1e-4 * swing
    assert len(f.marks) < 1000 * len(f.ticks)
    assert Pieces([0, 3], [[1.0, 0.0], [1.0, 0.0]], 9).marks.tolist() == [0, 3, 9]


def test_what_acts_for_a_moment_does_not_gather_round_off_afterwards():
    """As the force of a wall that a bar under gravity left long ago."""
    count = 40000
    width = 7
    force = np.zeros((count, 1))
    force[7] = 0.1
    end = count * width
    passed = Pieces(np.arange(count) * width, force).integrated_twice(end)
    assert passed == pytest.approx(0.1 * width * (end - 7.5 * width), rel=1e-14)
