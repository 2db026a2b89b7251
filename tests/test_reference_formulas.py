"""Formulas of horns and of lateral inertia in validation/ against balances and integrals."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import itairy
from validation_cases import validation_module

from rodimpact import theory

horns, lateral_inertia = map(validation_module, ("horns", "lateral_inertia"))


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
