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
    """Fields of the rod [place, time]; the stress is in units of the modulus."""

    velocity: np.ndarray
    stress: np.ndarray
    displacement: np.ndarray


class Modes(NamedTuple):
    """Angular frequencies w, and displacements and velocities at t = 0, each [mode]."""

    frequency: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray

    def amplitudes(self, t, viscosity):
        """q and q' of all modes at times t, each [mode, time].

        q is a sum of exp(r t) with the two roots r of r^2 + eta w^2 r + w^2 = 0. A mode
        with w = 0 moves on at the velocity that it has.
        """
        w = self.frequency[:, None]  # [mode, 1], as all that follows
        is_rigid = w == 0
        decay = viscosity * w * w / 2
        root = np.sqrt((decay * decay - w * w).astype(complex))
        # A double root is met by none of the frequencies that are used, but by w = 0.
        root = np.where(np.abs(root) < 1e-12, 1e-6, root)
        fast = -decay - root
        # The product of both roots is w^2; the sum -decay + root would lose digits.
        slow = w * w / np.where(np.abs(fast) > 0, fast, 1.0)
        slow = np.where(is_rigid, 0.0, slow)
        # u0 = fast_share + slow_share, v0 = fast_share fast + slow_share slow
        u0 = self.displacement[:, None]
        v0 = self.velocity[:, None]
        fast_share = (v0 - slow * u0) / (fast - slow + is_rigid)
        slow_share = u0 - fast_share
        q = fast_share * np.exp(fast * t) + slow_share * np.exp(slow * t)
        fast_rate = fast_share * fast * np.exp(fast * t)
        slow_rate = slow_share * slow * np.exp(slow * t)
        rate = fast_rate + slow_rate
        q = np.where(is_rigid, u0 + v0 * t, q).real
        rate = np.where(is_rigid, v0 + 0 * t, rate).real
        return q, rate

    def fields(self, x, t, viscosity):
        """Fields of the rod at places x and times t.

        The velocity is u_t, the stress u_x + viscosity u_xt (E = 1).
        """
        q, rate = self.amplitudes(t, viscosity)
        phase = np.outer(x, self.frequency)  # [place, mode]
        shape = np.cos(phase)
        shape_slope = -np.sin(phase) * self.frequency
        return Fields(
            velocity=shape @ rate,
            stress=shape_slope @ (q + viscosity * rate),
            displacement=shape @ q,
        )


def pressing_modes():
    """Modes while the rod presses; t = 0 when it touches, with unit velocity.

    The series of 1 in cos(w x), w = (k + 1/2) pi, has the coefficients 2 (-1)^k/w.
    """
    k = np.arange(MODES)
    frequency = (k + 0.5) * math.pi
    velocity = 2 * (-1.0) ** k / frequency
    return Modes(frequency, np.zeros(MODES), velocity)


def opening_time(viscosity):
    """Time after the touching at which the stress at the wall is 0 again.

    Without viscosity it is 2, when the wave has gone to the free end and back.
    """
    modes = pressing_modes()

    def stress(t):
        """Stress at the wall, x = 1."""
        at_wall = modes.fields([1.0], np.array([t]), viscosity)
        return float(at_wall.stress[0, 0])

    return brentq(stress, 0.9, 2.5, xtol=1e-13)


def rod_on_wall(x, t, viscosity):
    """Fields at places x and increasing times t > 0 after the touching, and the time at
    which the contact opens.
    """
    x = np.asarray(x, float)
    t = np.asarray(t, float)
    opening = opening_time(viscosity)
    pressing = pressing_modes()
    before = pressing.fields(x, t[t <= opening], viscosity)

    # The free modes begin with the state of the whole rod at the opening.
    places = np.linspace(0.0, 1.0, FREE_MODES + 1)
    state = pressing.fields(places, np.array([opening]), viscosity)
    free = Modes(
        frequency=np.arange(FREE_MODES) * math.pi,
        displacement=_cosines(state.displacement[:, 0]),
        velocity=_cosines(state.velocity[:, 0]),
    )
    after = free.fields(x, t[t > opening] - opening, viscosity)

    columns = []
    for name in Fields._fields:
        columns.append(np.hstack((getattr(before, name), getattr(after, name))))
    return Fields(*columns), opening


def _cosines(values):
    """Coefficients of cos(k pi x), k = 0, 1 ..., of a function on 0 to 1.

    `values` are its values at even places from 0 to 1; there are as many coefficients
    as intervals between them.
    """
    intervals = len(values) - 1
    series = dct(values, type=1)[:-1] / intervals
    series[0] /= 2
    return series
