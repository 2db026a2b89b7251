"""Modal sums for a damped rod that falls on a rigid wall; nothing of the package is
used.

A rod of unit length, modulus, density and area moves with unit velocity to the right
and touches a wall at x = 1. While it presses, its modes are cos((k + 1/2) pi x),
afterwards cos(k pi x); the amplitudes obey q'' + eta w^2 q' + w^2 q = 0. It opens when
the stress at the wall is 0.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.fft import dct
from scipy.optimize import brentq

MODES = 400  # while the rod presses
FREE_MODES = 4096  # afterwards: the strain at the wall is not 0 when the rod opens


class Fields(NamedTuple):
    """Of the rod at [place, time]; its stress is in units of the modulus."""

    velocity: np.ndarray
    stress: np.ndarray
    displacement: np.ndarray


class Modes(NamedTuple):
    """Frequencies, with the displacements and velocities of the modes at t = 0."""

    frequency: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray

    def amplitudes(self, t, viscosity):
        """q, q' [mode, time]."""
        w = self.frequency[:, None]
        decay = viscosity * w * w / 2
        root = np.sqrt((decay * decay - w * w).astype(complex))
        # A double root is met by none of the frequencies that are used, but by w = 0.
        root = np.where(np.abs(root) < 1e-12, 1e-6, root)
        fast = -decay - root
        slow = w * w / np.where(np.abs(fast) > 0, fast, 1.0)
        slow = np.where(w == 0, 0.0, slow)
        u0 = self.displacement[:, None]
        v0 = self.velocity[:, None]
        fast_share = (v0 - slow * u0) / (fast - slow + (w == 0))
        slow_share = u0 - fast_share
        q = fast_share * np.exp(fast * t) + slow_share * np.exp(slow * t)
        fast_rate = fast_share * fast * np.exp(fast * t)
        slow_rate = slow_share * slow * np.exp(slow * t)
        rate = fast_rate + slow_rate
        q = np.where(w == 0, u0 + v0 * t, q).real
        rate = np.where(w == 0, v0 + 0 * t, rate).real
        return q, rate

    def fields(self, x, t, viscosity):
        """Velocity, stress u' + viscosity * (velocity)' (E = 1), and displacement u."""
        q, rate = self.amplitudes(t, viscosity)
        shape = np.cos(np.outer(x, self.frequency))
        slope = -np.sin(np.outer(x, self.frequency)) * self.frequency
        return Fields(shape @ rate, slope @ (q + viscosity * rate), shape @ q)


def pressing_modes():
    """Modes of the rod from its touching on, as it has unit velocity everywhere."""
    half_orders = np.arange(MODES) + 0.5
    frequency = half_orders * math.pi
    velocity = 2 * (-1.0) ** np.arange(MODES) / frequency
    return Modes(frequency, np.zeros(MODES), velocity)


def opening_time(viscosity):
    """When the stress at the wall is 0 again."""
    modes = pressing_modes()

    def stress(t):
        """Stress at the wall."""
        return float(modes.fields([1.0], np.array([t]), viscosity).stress[0, 0])

    return brentq(stress, 0.9, 2.5, xtol=1e-13)


def rod_on_wall(x, t, viscosity):
    """Fields at places x and increasing times t > 0 after the touching; and when it
    opens.
    """
    x = np.asarray(x, float)
    t = np.asarray(t, float)
    opening = opening_time(viscosity)
    pressing = pressing_modes()
    before = pressing.fields(x, t[t <= opening], viscosity)
    places = np.linspace(0.0, 1.0, FREE_MODES + 1)
    state = pressing.fields(places, np.array([opening]), viscosity)
    free = Modes(
        np.arange(FREE_MODES) * math.pi,
        _cosines(state.displacement[:, 0]),
        _cosines(state.velocity[:, 0]),
    )
    after = free.fields(x, t[t > opening] - opening, viscosity)
    columns = []
    for name in Fields._fields:
        columns.append(np.hstack((getattr(before, name), getattr(after, name))))
    return Fields(*columns), opening


def _cosines(values):
    """Coefficients of cos(k pi x) of a function from its values at even places."""
    series = dct(values, type=1)[:-1] / (len(values) - 1)
    series[0] /= 2
    return series
