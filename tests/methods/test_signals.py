import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rodimpact.methods.signals import Pieces, integral_of_product

steps = st.lists(st.tuples(st.integers(0, 60), st.integers(-5, 5)), min_size=1, max_size=8,
                 unique_by=lambda pair: pair[0]).map(sorted)


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
    low, high = min(t, u), max(t, u)
    exact = sum(brute(pairs, k) for k in range(low, high))
    assert s.integral(low, high) == exact
    assert s.integral(high, low) == -exact


@given(steps, steps, st.integers(-20, 80), st.integers(0, 60), st.integers(-30, 130))
def test_integral_of_a_product(f, g, start, length, about):
    stop = start + length
    plain = sum(brute(f, k) * brute(g, k) for k in range(start, stop))
    assert integral_of_product(signal(f), signal(g), start, stop) == plain
    turned = sum(brute(f, k) * brute(g, about - k - 1) for k in range(start, stop))
    assert integral_of_product(signal(f), signal(g), start, stop, about) == turned


@given(steps, st.integers(-20, 80), st.integers(-20, 80))
def test_breaks_strictly_inside(pairs, a, b):
    start, stop = min(a, b), max(a, b)
    inside = [t for t, _ in pairs if start < t < stop]
    assert signal(pairs).breaks_in(start, stop).tolist() == inside


def test_arrays_broadcast():
    s = Pieces([0, 10], [1.0, 2.0])
    assert s.at(np.array([[-1, 0], [9, 10]])).tolist() == [[1, 1], [1, 2]]
    assert s.integral(np.array([[0], [5]]), np.array([10, 20])) == pytest.approx(
        np.array([[10, 30], [5, 25]])
    )
