"""Formulas of validation/ that no user of the package needs, against balances and integrals."""

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import itairy
from validation_cases import validation_module

from rodimpact import rigid, theory

exercises, horns, lateral_inertia = map(
    validation_module, ("exercises", "horns", "lateral_inertia"))
MASS = st.floats(1e-3, 1e3)
VELOCITY = st.floats(-100, 100)


def test_problem_10_5_5_in_matrix_form():
    matrix, right_hand_side, velocities = exercises.solve_linear(2.0, 2.6, 0.5, 0.0, 0.8)
    assert matrix.tolist() == [[2.0, 0.5], [1.0, -1.0]]
    assert right_hand_side == pytest.approx([5.2, -2.08])
    assert velocities == pytest.approx([1.664, 3.744])


def test_problem_10_5_8_infinitely_many_bounces_in_finite_time_and_distance():
    h, e, g = 2.0, 0.6, 9.81
    ball = exercises.bouncing_ball(h, e, 200, gravity=g)
    assert np.all(ball.rebound_heights > 0)
    assert ball.total_time == pytest.approx(math.sqrt(2 * h / g) * (1 + e) / (1 - e))
    assert ball.total_distance == pytest.approx(h * (1 + e**2) / (1 - e**2))
    assert ball.impact_times[-1] == pytest.approx(ball.total_time)
    assert ball.impact_distances[-1] == pytest.approx(ball.total_distance)


def test_problem_10_5_9_bullet_through_a_into_b():
    m, m_a, m_b, v_a, v_b = 0.02, 1.0, 2.0, 4.0, 3.0
    shot = exercises.bullet_through(m, m_a, m_b, v_a, v_b)
    assert m * shot.initial_speed == pytest.approx(m_a * v_a + (m_b + m) * v_b)
    assert m * shot.speed_between == pytest.approx((m_b + m) * v_b)
    energy = [m * shot.initial_speed**2 / 2, m * shot.speed_between**2 / 2 + m_a * v_a**2 / 2]
    assert shot.energy_lost_in_a == pytest.approx(energy[0] - energy[1])
    embedded = rigid.collide(m, shot.speed_between, m_b, 0.0, 0.0)
    assert embedded.velocity_2 == pytest.approx(v_b)
    assert shot.energy_lost_in_b == pytest.approx(embedded.energy_lost)
    passed = rigid.restitution_from_velocities(shot.initial_speed, 0.0, shot.speed_between, v_a)
    assert -1 < passed < 0
    through = rigid.collide(m, shot.initial_speed, m_a, 0.0, passed)
    assert shot.energy_lost_in_a == pytest.approx(through.energy_lost)


@settings(derandomize=True, max_examples=200)
@given(MASS, VELOCITY, MASS, VELOCITY, st.floats(-1, 1))
def test_the_linear_system_and_the_closed_form_agree(m1, v1, m2, v2, e):
    assume(v1 > v2)
    after = rigid.collide(m1, v1, m2, v2, e)
    velocities = exercises.solve_linear(m1, v1, m2, v2, e).velocities
    assert velocities == pytest.approx([after.velocity_1, after.velocity_2], abs=1e-8)


def test_bounces_follow_free_fall():
    h, e, g = 10.0, 0.8, 9.81
    ball = exercises.bouncing_ball(h, e, 3, gravity=g)
    speed = e * math.sqrt(2 * g * h)
    first = math.sqrt(2 * h / g)
    times = [first, first + 2 * speed / g, first + 2 * speed / g + 2 * e * speed / g]
    assert ball.impact_times == pytest.approx(times)
    assert ball.rebound_heights == pytest.approx([6.4, 4.096, 2.62144])
    assert ball.impact_distances == pytest.approx([10.0, 22.8, 30.992])


def test_the_path_of_an_almost_perfect_ball_keeps_its_digits():
    e = Fraction(1 - 1e-9)
    total = exercises.bouncing_ball(1.0, float(e), 1).total_distance
    assert total == pytest.approx(float((1 + e**2) / (1 - e**2)), rel=1e-14)


def test_pulse():
    assert exercises.raised_cosine_force(0.0, 190.0, 0.1) == 190.0
    edges = exercises.raised_cosine_force([-0.06, -0.05, -0.025, 0.025, 0.05, 0.06], 190.0, 0.1)
    assert edges == pytest.approx([0, 0, 95, 95, 0, 0], abs=1e-12)


@settings(derandomize=True, max_examples=30)
@given(st.floats(1e-3, 1e3), st.floats(1e-6, 1e2))
def test_peak_force_gives_the_impulse_back(impulse, duration):
    peak = exercises.peak_force(impulse, duration)
    area = exercises.pulse_impulse(
        lambda t: exercises.raised_cosine_force(t, peak, duration), duration)
    assert area == pytest.approx(impulse, rel=1e-10)


def test_impulse_of_another_pulse():
    assert exercises.pulse_impulse(math.cos, math.pi) == pytest.approx(2.0)


@pytest.mark.parametrize(("duration", "force"), [(0.1, 190.0), (0.001, 19000.0)])
def test_sample_10_20_peak_force(duration, force):
    impulse = rigid.collide(0.5, 10.0, math.inf, 0.0, 0.9).impulse
    assert impulse == pytest.approx(0.5 * 19)
    assert exercises.peak_force(impulse, duration) == pytest.approx(force)


def slope(function, x, step):
    """Derivative, to fourth order."""
    far, near = (function(x + k * step) - function(x - k * step) for k in (2, 1))
    return (8 * near - far) / (12 * step)


def test_a_cone_under_constant_pressure():
    """The velocity obeys the wave equation, and the momentum is that which the pressure gives."""
    s0, v = horns.APEX, horns.under_pressure

    def growth(x):
        return (s0 + x) ** 2 * slope(lambda y: v(1.0, y), x, 1e-3)

    twice = slope(lambda t: slope(lambda r: v(r, 0.4), t, 1e-3), 1.0, 1e-3)
    assert slope(growth, 0.4, 1e-3) == pytest.approx((s0 + 0.4) ** 2 * twice, rel=1e-8)
    for t in (0.2, 1.0, 3.0):  # a pressure of 1, on the area s0^2
        momentum = quad(lambda x, t=t: (s0 + x) ** 2 * v(t, x), 0.0, t)[0]
        assert momentum == pytest.approx(s0**2 * t, rel=1e-10)
        front = v(t, t * (1 - 1e-15))
        assert front == pytest.approx(theory.horn_amplification(s0**2, (s0 + t) ** 2))
        assert v(t, t * (1 + 1e-15)) == 0.0


def love_front(x, t):
    """Inverse Laplace transform by the principal value on the real axis, to about 1e-7.

    The integrand falls as k^-3, and beyond 40 it oscillates as sin(t - k x).
    """

    def wave(k):
        return math.sin(k / math.sqrt(1 + k * k) * t - k * x) / (k * (1 + k * k))

    edges = np.linspace(0, 40, int(10 * x) + 1)
    return 1 / 2 + sum(quad(wave, a, b)[0] for a, b in pairwise(edges)) / math.pi


@pytest.mark.parametrize("x", [30.0, 120.0])
def test_rise_of_a_step_with_lateral_inertia(x):
    spread = (1.5 * x) ** (1 / 3)
    times = [
        brentq(lambda z, level=level: love_front(x, x + z * spread) - level, *bracket, xtol=1e-6)
        for level, bracket in ((0.1, (-1.2, -0.8)), (0.9, (1.0, 1.4)))
    ]
    rise = lateral_inertia.rise_by_contour(x, 1.0, 1.0)
    assert rise == pytest.approx((times[1] - times[0]) * spread, rel=2e-5)


def test_far_away_the_front_is_that_of_airy():
    ahead = brentq(lambda z: 1 / 3 - itairy(z)[0] - 0.1, 0.0, 3.0)
    behind = brentq(lambda z: 1 / 3 + itairy(z)[2] - 0.9, 0.0, 2.0)
    rise = lateral_inertia.rise_by_contour(1e12, 1.0, 1.0)
    assert rise / (1.5e12) ** (1 / 3) == pytest.approx(ahead + behind, rel=1e-7)


def test_rise_in_a_steel_bar():
    """Values of an independent computation with waves of a coarse grid, good to some per cent."""
    c, kappa = math.sqrt(200e9 / 7850), 19e-3 / math.sqrt(8)
    rises = [lateral_inertia.rise_by_contour(x, c, 0.29 * kappa) for x in (1.0, 2.0, 4.0, 8.0)]
    assert rises == pytest.approx([7.9e-6, 9.7e-6, 12.4e-6, 15.2e-6], rel=0.03)
