"""Textbook exercises on rigid bodies that follow from momentum and one coefficient of restitution.

Bouncing balls, a bullet through two blocks, a collision as two linear equations, and the peak force
of a smooth pulse: formulas that `problems` and `samples` compare with `rigid.collide` and with what
is worked out by hand. Arguments broadcast as in NumPy.

Source: textbook section 10.5, "Collisions in 1D".
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import quad


class LinearSystem(NamedTuple):
    """``matrix @ velocities = right_hand_side``; momentum [kg m/s] first, then e [m/s]."""

    matrix: np.ndarray
    right_hand_side: np.ndarray
    velocities: np.ndarray


class BouncingBall(NamedTuple):
    """Bounces of a dropped ball, along a last axis [s], [m], and their limits."""

    impact_times: np.ndarray
    impact_distances: np.ndarray
    rebound_heights: np.ndarray
    total_time: np.ndarray
    total_distance: np.ndarray


class BulletThrough(NamedTuple):
    """A bullet that went through block A and stuck in block B [m/s], [J]."""

    initial_speed: Any
    speed_between: Any
    energy_lost_in_a: Any
    energy_lost_in_b: Any


def solve_linear(m1: float, v1: float, m2: float, v2: float, e: float) -> LinearSystem:
    """Collision as two linear equations for the velocities w1, w2 after it (problem 10.5.5).

    m1 w1 + m2 w2 = m1 v1 + m2 v2  and  w1 - w2 = -e (v1 - v2).
    """
    matrix = np.array([[m1, m2], [1.0, -1.0]])
    right_hand_side = np.array([m1 * v1 + m2 * v2, -e * (v1 - v2)])
    return LinearSystem(matrix, right_hand_side, np.linalg.solve(matrix, right_hand_side))


def bouncing_ball(
    height: ArrayLike, restitution: ArrayLike, bounces: int, gravity: ArrayLike = 9.81
) -> BouncingBall:
    """Ball dropped from rest that bounces on the ground without air drag (problem 10.5.8).

    Each impact multiplies the time of flight by e < 1 and the height by e^2; the geometric series
    give the limits ``sqrt(2 h/g) (1 + e)/(1 - e)`` and ``h (1 + e^2)/(1 - e^2)``.
    """
    h, e, g = np.broadcast_arrays(height, restitution, gravity)
    first_fall = np.sqrt(2 * h / g)
    bounce = np.arange(bounces)
    powers = e[..., np.newaxis] ** bounce
    legs = np.where(bounce == 0, 1.0, 2.0)  # the first is only a fall, the others rise and fall
    return BouncingBall(
        impact_times=first_fall[..., np.newaxis] * np.cumsum(legs * powers, axis=-1),
        impact_distances=h[..., np.newaxis] * np.cumsum(legs * powers**2, axis=-1),
        rebound_heights=h[..., np.newaxis] * (e[..., np.newaxis] * powers) ** 2,
        total_time=first_fall * ((1 + e) / (1 - e)),
        total_distance=h * ((1 + e * e) / ((1 - e) * (1 + e))),
    )


def bullet_through(m: Any, m_a: Any, m_b: Any, v_a: Any, v_b: Any) -> BulletThrough:
    """Bullet of mass m that passes through block A and stays in block B (problem 10.5.9).

    From the speeds v_a and v_b that it leaves behind, by momentum balance at B, then at A.
    """
    between = v_b + m_b * v_b / m
    initial = between + m_a * v_a / m
    return BulletThrough(
        initial_speed=initial,
        speed_between=between,
        energy_lost_in_a=m_a * v_a * (initial + (between - v_a)) / 2,
        energy_lost_in_b=m_b * v_b * between / 2,
    )


def raised_cosine_force(time: ArrayLike, peak: float, duration: float) -> np.ndarray:
    """Force ``(F0/2) (1 + cos(2 pi t/T))`` for abs(t) <= T/2, otherwise 0 (sample 10.20)."""
    t = np.asarray(time)
    return np.where(
        np.abs(t) <= duration / 2, peak / 2 * (1 + np.cos(2 * np.pi * (t / duration))), 0.0)


def peak_force(impulse: float, duration: float) -> float:
    """Peak ``2 P/T`` of the raised-cosine pulse that delivers an impulse (sample 10.20)."""
    return 2 * impulse / duration


def pulse_impulse(force: Callable[[float], Any], duration: float) -> float:
    """Impulse of a pulse of any shape, over -T/2 <= t <= T/2 (before eq. 10.53)."""
    return float(quad(force, -duration / 2, duration / 2)[0])
