"""Rigid-body collisions on a line: momentum is kept, a coefficient of restitution says the rest.

What happens inside two colliding bodies is summed up in one number, the impulse P. Momentum
balance leaves P open; the restitution e closes the equations by stating how fast the bodies part
compared with how fast they met. Bouncing balls, stacks of balls and bullets follow from repeating
that one law, `collide`.

Arguments broadcast as in NumPy; results are floats where every argument is a single number.
Velocities are positive to the right and body 1 is the left one. Equation numbers and problems are
those of the textbook section 10.5, "Collisions in 1D".
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .model.arguments import Array, Number, array, finite, plain, positive, refuse

NEWTON_RATIOS = {"wool": Fraction(5, 9), "glass": Fraction(15, 16)}
"""Restitution of balls that Newton measured with pendulums, allowing for the drag of the air.

Principia, scholium to the laws of motion; Motte's translation revised by Cajori, University of
California Press 1947, page 25. Steel he found to be close to 1, and cork a little below that.
"""

_APART = "the bodies do not approach; body 1 is on the left, so its velocity must be the larger"


class RigidCollision(NamedTuple):
    """Two rigid bodies after their collision, and what the collision did.

    Attributes
    ----------
    velocity_1, velocity_2 : float or array
        Velocities after the collision [m/s].
    impulse : float or array
        Impulse on body 2; body 1 receives the opposite [N s].
    centre_of_mass_velocity : float or array
        The same before and after [m/s].
    relative_velocity_before, relative_velocity_after : float or array
        Velocity of body 2 minus that of body 1: negative before, positive after a bounce [m/s].
    energy_before, energy_after : float or array
        Kinetic energy of both bodies; an immovable body has 0 if at rest, else infinity [J].
    energy_lost : float or array
        Kinetic energy lost, finite also with an immovable body [J].
    """

    velocity_1: Number
    velocity_2: Number
    impulse: Number
    centre_of_mass_velocity: Number
    relative_velocity_before: Number
    relative_velocity_after: Number
    energy_before: Number
    energy_after: Number
    energy_lost: Number


class LinearSystem(NamedTuple):
    """The equations of a collision, ``matrix @ velocities = right_hand_side``.

    Attributes
    ----------
    matrix : array, shape (..., 2, 2)
        First row momentum [kg], second row restitution [1].
    right_hand_side : array, shape (..., 2)
        Momentum before [N s] and minus e times the closing speed [m/s].
    velocities : array, shape (..., 2)
        Velocities of body 1 and body 2 after the collision [m/s].
    """

    matrix: Array
    right_hand_side: Array
    velocities: Array


class BouncingBall(NamedTuple):
    """The bounces of a dropped ball, and where they tend.

    Attributes
    ----------
    impact_times : array, shape (..., bounces)
        Time of each impact since the release [s].
    impact_distances : array, shape (..., bounces)
        Path travelled, down and up, until each impact [m].
    rebound_heights : array, shape (..., bounces)
        Height reached after each impact [m].
    total_time, total_distance : float or array
        Limits for infinitely many bounces [s], [m]; infinite for a restitution of 1.
    """

    impact_times: Array
    impact_distances: Array
    rebound_heights: Array
    total_time: Number
    total_distance: Number


class StackDrop(NamedTuple):
    """A stack of balls after its drop.

    Attributes
    ----------
    velocities : array, shape (..., balls)
        Velocities from the bottom ball to the top one, positive upwards [m/s].
    top_height : float or array
        Height the top ball reaches above its collision; 0 if it does not rise [m].
    """

    velocities: Array
    top_height: Number


class BulletThrough(NamedTuple):
    """A bullet that went through block A and stuck in block B.

    Attributes
    ----------
    initial_speed, speed_between : float or array
        Speed of the bullet before A, and between A and B [m/s].
    energy_lost_in_a, energy_lost_in_b : float or array
        Kinetic energy lost in each block [J].
    """

    initial_speed: Number
    speed_between: Number
    energy_lost_in_a: Number
    energy_lost_in_b: Number


def contact_mass(m1: ArrayLike, m2: ArrayLike) -> Number:
    """Mass that stands for both bodies in their relative motion.

    ``m_coll = m1 m2/(m1 + m2)``, the reciprocal of the sum of reciprocals.

    Parameters
    ----------
    m1, m2 : float or array
        Masses; one of them may be infinite [kg].

    Returns
    -------
    float or array
        The contact mass; the other mass if one is infinite [kg].

    Raises
    ------
    ValueError
        If a mass is not positive, or both are infinite.

    Examples
    --------
    >>> contact_mass(2.0, 6.0), contact_mass(2.0, float("inf"))
    (1.5, 2.0)
    """
    return plain(_contact_mass(_mass("m1", m1), _mass("m2", m2)))


def collide(
    m1: ArrayLike,
    v1: ArrayLike,
    m2: ArrayLike,
    v2: ArrayLike,
    restitution: ArrayLike,
    *,
    allow_energy_release: bool = False,
) -> RigidCollision:
    """Collision of two rigid bodies.

    The centre of mass keeps its velocity, and the relative velocity v2 - v1 turns into -e times
    itself (eq. 10.56), so that ``P = (1 + e) m_coll (v1 - v2)`` and the energy lost is
    ``(1 - e^2) m_coll (v1 - v2)^2/2``. With e = 0 the bodies stay together, as when one captures
    the other; with e = 1 no energy is lost; a negative e lets them pass through each other.

    Parameters
    ----------
    m1, m2 : float or array
        Masses; infinite for an immovable body [kg].
    v1, v2 : float or array
        Velocities before the collision, v1 > v2 [m/s].
    restitution : float or array
        Coefficient of restitution e, from -1 to 1 [1].
    allow_energy_release : bool
        Accept abs(e) > 1, a collision that adds energy, as an explosion does.

    Returns
    -------
    RigidCollision
        Velocities, impulse and energies, each of the broadcast shape of the arguments.

    Raises
    ------
    ValueError
        If a mass is not positive or both are infinite, a velocity or e is not finite, the bodies
        do not approach, or abs(e) > 1 without `allow_energy_release`.

    Examples
    --------
    Problem 10.5.6:

    >>> after = collide(7.0, 6.0, 9.0, 2.0, 0.5)
    >>> after.impulse, after.velocity_1, after.velocity_2
    (23.625, 2.625, 4.625)
    """
    M1, V1, M2, V2, e = _collision(m1, v1, m2, v2, restitution)
    if not allow_energy_release:
        wanted = "abs(e) > 1 adds energy; give e from -1 to 1 or set allow_energy_release=True"
        refuse(np.abs(e) > 1, wanted, restitution=e)
    M = _contact_mass(M1, M2)
    share_1, share_2 = M / M2, M / M1  # of the total mass: m1/(m1 + m2) and m2/(m1 + m2)
    V_cm = share_1 * V1 + share_2 * V2
    before = V2 - V1
    after = -e * before
    W1, W2 = V_cm - share_2 * after, V_cm + share_1 * after
    return RigidCollision(
        velocity_1=plain(W1),
        velocity_2=plain(W2),
        impulse=plain(M * (after - before)),
        centre_of_mass_velocity=plain(V_cm),
        relative_velocity_before=plain(before),
        relative_velocity_after=plain(after),
        energy_before=plain(_kinetic_energy(M1, V1) + _kinetic_energy(M2, V2)),
        energy_after=plain(_kinetic_energy(M1, W1) + _kinetic_energy(M2, W2)),
        energy_lost=plain((1 - e) * (1 + e) * _kinetic_energy(M, before)),
    )


def solve_linear(
    m1: ArrayLike, v1: ArrayLike, m2: ArrayLike, v2: ArrayLike, restitution: ArrayLike
) -> LinearSystem:
    """Collision of two rigid bodies, written and solved as two linear equations.

    Momentum balance and the collision law for the velocities w1, w2 after the collision (problem
    10.5.5)::

        m1 w1 + m2 w2 = m1 v1 + m2 v2
           w1 -    w2 = -e (v1 - v2)

    Parameters
    ----------
    m1, m2 : float or array
        Finite masses [kg].
    v1, v2 : float or array
        Velocities before the collision, v1 > v2 [m/s].
    restitution : float or array
        Coefficient of restitution e, any finite number [1].

    Returns
    -------
    LinearSystem
        Matrix, right-hand side and solution.

    Raises
    ------
    ValueError
        If a mass is not positive and finite, a velocity or e is not finite, or the bodies do not
        approach.

    Examples
    --------
    >>> matrix, right_hand_side, velocities = solve_linear(2.0, 2.6, 0.5, 0.0, 0.8)
    >>> matrix.tolist(), velocities.round(12).tolist()
    ([[2.0, 0.5], [1.0, -1.0]], [1.664, 3.744])
    """
    positive("m1", m1, "kg")
    positive("m2", m2, "kg")
    M1, V1, M2, V2, e = _collision(m1, v1, m2, v2, restitution)
    rows = [np.stack([M1, M2], axis=-1), np.stack([np.ones_like(e), -np.ones_like(e)], axis=-1)]
    matrix = np.stack(rows, axis=-2)
    right_hand_side = np.stack([M1 * V1 + M2 * V2, -e * (V1 - V2)], axis=-1)
    velocities = np.linalg.solve(matrix, right_hand_side[..., np.newaxis])[..., 0]
    return LinearSystem(matrix, right_hand_side, np.asarray(velocities, dtype=np.float64))


def restitution_from_velocities(
    v1_before: ArrayLike, v2_before: ArrayLike, v1_after: ArrayLike, v2_after: ArrayLike
) -> Number:
    """Coefficient of restitution measured from velocities (eq. 10.56).

    ``e = (v2_after - v1_after)/(v1_before - v2_before)``; with abs(e) > 1 energy was released.

    Parameters
    ----------
    v1_before, v2_before : float or array
        Velocities before the collision, v1_before > v2_before [m/s].
    v1_after, v2_after : float or array
        Velocities after it [m/s].

    Returns
    -------
    float or array
        Coefficient of restitution [1].

    Raises
    ------
    ValueError
        If a velocity is not finite or the bodies do not approach.

    Examples
    --------
    >>> restitution_from_velocities(10.0, 5.0, 6.0, 7.0)
    0.2
    """
    before_1 = finite("v1_before", v1_before, "m/s")
    before_2 = finite("v2_before", v2_before, "m/s")
    after_1 = finite("v1_after", v1_after, "m/s")
    after_2 = finite("v2_after", v2_after, "m/s")
    refuse(before_1 <= before_2, _APART, v1_before=before_1, v2_before=before_2)
    return plain((after_2 - after_1) / (before_1 - before_2))


def restitution_from_heights(drop: ArrayLike, rebound: ArrayLike) -> Number:
    """Coefficient of restitution of a dropped ball with the ground.

    ``e = sqrt(rebound/drop)``, as speeds grow with the square root of the height (problems 10.5.2
    and 10.5.4).

    Parameters
    ----------
    drop : float or array
        Height of the release from rest [m].
    rebound : float or array
        Height reached afterwards [m].

    Returns
    -------
    float or array
        Coefficient of restitution [1].

    Raises
    ------
    ValueError
        If `drop` is not positive and finite, or `rebound` is negative or above `drop`.

    Examples
    --------
    >>> restitution_from_heights(10.0, 6.4)
    0.8
    """
    fall, rise = positive("drop", drop, "m"), finite("rebound", rebound, "m")
    wanted = "a ball released from rest rebounds to a height from 0 to the drop"
    refuse((rise < 0) | (rise > fall), wanted, drop=fall, rebound=rise)
    return plain(np.sqrt(rise / fall))


def bouncing_ball(
    height: ArrayLike, restitution: ArrayLike, bounces: int, gravity: ArrayLike = 9.81
) -> BouncingBall:
    """Ball dropped from rest that bounces on the ground without air drag.

    Each impact multiplies the speed by e, hence the time of flight by e and the height by e^2.
    The geometric series give the limits ``t (1 + e)/(1 - e)``, with t = sqrt(2 h/g) the first
    fall, and ``h (1 + e^2)/(1 - e^2)`` (problem 10.5.8): for 0 < e < 1 infinitely many bounces in
    a finite time. With e = 0 the ball stays down: further impacts are listed at the time of the
    first.

    Parameters
    ----------
    height : float or array
        Height h of the release [m].
    restitution : float or array
        Coefficient of restitution e with the ground, from 0 to 1 [1].
    bounces : int
        Number of impacts to list, at least 1.
    gravity : float or array
        Gravitational acceleration g [m/s^2].

    Returns
    -------
    BouncingBall
        Times, distances and heights, with the bounces along a last axis, and the limits.

    Raises
    ------
    ValueError
        If `height` or `gravity` is not positive and finite, e is not from 0 to 1, or `bounces`
        is below 1.
    TypeError
        If `bounces` is not an integer.

    Examples
    --------
    >>> ball = bouncing_ball(height=10.0, restitution=0.8, bounces=2)
    >>> ball.rebound_heights.round(12).tolist(), round(ball.total_time, 6)
    ([6.4, 4.096], 12.850588)
    """
    h, e, g = np.broadcast_arrays(
        positive("height", height, "m"),
        _fraction("restitution", restitution),
        positive("gravity", gravity, "m/s^2"),
    )
    if operator.index(bounces) < 1:
        raise ValueError(f"bounces = {bounces}: list at least one bounce")
    first_fall = np.sqrt(2 * h / g)
    bounce = np.arange(bounces)
    powers = e[..., np.newaxis] ** bounce
    legs = np.where(bounce == 0, 1.0, 2.0)  # the first is only a fall, the others rise and fall
    with np.errstate(divide="ignore"):
        total_time = first_fall * ((1 + e) / (1 - e))
        total_distance = h * ((1 + e * e) / ((1 - e) * (1 + e)))
    return BouncingBall(
        impact_times=first_fall[..., np.newaxis] * np.cumsum(legs * powers, axis=-1),
        impact_distances=h[..., np.newaxis] * np.cumsum(legs * powers**2, axis=-1),
        rebound_heights=h[..., np.newaxis] * (e[..., np.newaxis] * powers) ** 2,
        total_time=plain(total_time),
        total_distance=plain(total_distance),
    )


def stack_drop(
    masses: ArrayLike, restitutions: ArrayLike, height: ArrayLike, gravity: ArrayLike = 9.81
) -> StackDrop:
    """Stack of balls dropped on the floor, hardly apart, so that they collide one after another.

    The bottom ball bounces off the floor, meets the second one, which is still falling, and so on
    upwards (sample 10.21 and problem 10.5.10). One upward sweep is followed: a ball that comes
    back to the one below it does not meet it again.

    Parameters
    ----------
    masses : array, shape (..., balls)
        Finite masses from the bottom to the top [kg].
    restitutions : array, shape (..., balls)
        Coefficient of restitution of each ball with what is below it, from 0 to 1; the floor's
        comes first [1].
    height : float or array, shape (...)
        Height of the release [m].
    gravity : float or array, shape (...)
        Gravitational acceleration [m/s^2].

    Returns
    -------
    StackDrop
        Velocities after the sweep, and how high the top ball flies.

    Raises
    ------
    ValueError
        If the numbers of masses and restitutions differ, a mass, `height` or `gravity` is not
        positive and finite, or a restitution is not from 0 to 1.

    Examples
    --------
    A basketball with a tennis ball on top:

    >>> round(stack_drop([0.6, 0.06], [0.9, 0.6], height=1.0).top_height, 4)
    3.1104
    """
    M = np.atleast_1d(positive("masses", masses, "kg"))
    e = np.atleast_1d(_fraction("restitutions", restitutions))
    h, g = positive("height", height, "m"), positive("gravity", gravity, "m/s^2")
    balls = M.shape[-1]
    if balls != e.shape[-1] or balls == 0:
        raise ValueError(
            f"masses has {balls} balls and restitutions {e.shape[-1]}: give at least one ball, "
            "and for each ball the restitution with what is below it, the floor's first"
        )
    drop_speed = np.sqrt(2 * g * h)
    shape = np.broadcast_shapes(M.shape[:-1], e.shape[:-1], drop_speed.shape)
    v = np.empty((*shape, balls))
    v[...] = -drop_speed[..., np.newaxis]
    v[..., 0] = e[..., 0] * drop_speed
    for i, j in pairwise(range(balls)):
        after = collide(M[..., i], v[..., i], M[..., j], v[..., j], e[..., j])
        v[..., i], v[..., j] = after.velocity_1, after.velocity_2
    return StackDrop(velocities=v, top_height=plain(np.maximum(v[..., -1], 0.0) ** 2 / (2 * g)))


def bullet_through(
    m_bullet: ArrayLike, m_a: ArrayLike, m_b: ArrayLike, v_a: ArrayLike, v_b: ArrayLike
) -> BulletThrough:
    """Bullet that passes through block A and stays in block B, both at rest before.

    Momentum balance at B, then at A, gives the speed of the bullet from the speeds it leaves
    behind (problem 10.5.9): ``speed_between = (m + m_b) v_b/m`` and
    ``initial_speed = speed_between + m_a v_a/m``.

    Parameters
    ----------
    m_bullet, m_a, m_b : float or array
        Masses of the bullet and of the blocks [kg].
    v_a : float or array
        Speed of block A once the bullet has left it [m/s].
    v_b : float or array
        Speed of block B with the bullet in it [m/s].

    Returns
    -------
    BulletThrough
        Speeds of the bullet and the energy lost in each block.

    Raises
    ------
    ValueError
        If an argument is not positive and finite, or the bullet would be too slow to leave A.

    Examples
    --------
    >>> bullet_through(0.02, 1.0, 2.0, v_a=4.0, v_b=3.0)
    BulletThrough(initial_speed=503.0, speed_between=303.0, energy_lost_in_a=1604.0, \
energy_lost_in_b=909.0)
    """
    m, M_a = positive("m_bullet", m_bullet, "kg"), positive("m_a", m_a, "kg")
    M_b = positive("m_b", m_b, "kg")
    V_a, V_b = positive("v_a", v_a, "m/s"), positive("v_b", v_b, "m/s")
    between = V_b + M_b * V_b / m
    refuse(
        between <= V_a,
        "the bullet would leave A no faster than A moves; give a smaller v_a or a larger v_b",
        v_a=V_a,
        speed_between=between,
    )
    initial = between + M_a * V_a / m
    return BulletThrough(
        initial_speed=plain(initial),
        speed_between=plain(between),
        energy_lost_in_a=plain(M_a * V_a * (initial + (between - V_a)) / 2),
        energy_lost_in_b=plain(M_b * V_b * between / 2),
    )


def raised_cosine_force(time: ArrayLike, peak_force: ArrayLike, duration: ArrayLike) -> Number:
    """Force of a smooth pulse, a simple picture of the force in a collision.

    ``F(t) = (F0/2) (1 + cos(2 pi t/T))`` for abs(t) <= T/2, otherwise 0 (sample 10.20).

    Parameters
    ----------
    time : float or array
        Time t from the middle of the pulse [s].
    peak_force : float or array
        Force F0 in the middle [N].
    duration : float or array
        Duration T of the pulse [s].

    Returns
    -------
    float or array
        Force at `time` [N].

    Raises
    ------
    ValueError
        If `time` is not finite, or another argument is not positive and finite.

    Examples
    --------
    >>> raised_cosine_force([0.0, 0.025, 0.1], peak_force=190.0, duration=0.1).round(9).tolist()
    [190.0, 95.0, 0.0]
    """
    t, T = finite("time", time, "s"), positive("duration", duration, "s")
    F0 = positive("peak_force", peak_force, "N")
    inside = np.abs(t) <= T / 2
    return plain(np.where(inside, F0 / 2 * (1 + np.cos(2 * np.pi * (t / T))), 0.0))


def peak_force(impulse: ArrayLike, duration: ArrayLike) -> Number:
    """Peak of the raised-cosine pulse that delivers an impulse.

    ``F0 = 2 P/T`` (sample 10.20): the shorter the contact, the larger the force.

    Parameters
    ----------
    impulse : float or array
        Impulse P of the pulse [N s].
    duration : float or array
        Duration T of the pulse [s].

    Returns
    -------
    float or array
        Peak force F0 [N].

    Raises
    ------
    ValueError
        If an argument is not positive and finite.

    Examples
    --------
    >>> peak_force(impulse=0.5 * 19.0, duration=0.1)
    190.0
    """
    return plain(2 * positive("impulse", impulse, "N s") / positive("duration", duration, "s"))


def pulse_impulse(force: Callable[[float], Any], duration: float) -> float:
    """Impulse of a force pulse of any shape, by numerical integration.

    ``P = integral of F(t) dt`` over -T/2 <= t <= T/2 (before eq. 10.53).

    Parameters
    ----------
    force : callable
        Force [N] as a smooth function of the time from the middle of the pulse [s].
    duration : float
        Duration T of the pulse [s].

    Returns
    -------
    float
        Impulse [N s].

    Raises
    ------
    ValueError
        If `duration` is not positive and finite.

    Examples
    --------
    >>> round(pulse_impulse(lambda t: raised_cosine_force(t, 190.0, 0.1), 0.1), 12)
    9.5
    """
    from scipy.integrate import quad  # slow to import

    half = float(positive("duration", duration, "s")) / 2
    return float(quad(lambda t: array("force", force(t), "N"), -half, half)[0])


def _collision(
    m1: ArrayLike, v1: ArrayLike, m2: ArrayLike, v2: ArrayLike, restitution: ArrayLike
) -> tuple[Array, ...]:
    """The arguments of a collision, checked and broadcast."""
    M1, V1, M2, V2, e = np.broadcast_arrays(
        _mass("m1", m1),
        finite("v1", v1, "m/s"),
        _mass("m2", m2),
        finite("v2", v2, "m/s"),
        finite("restitution", restitution, ""),
    )
    refuse(V1 <= V2, _APART, v1=V1, v2=V2)
    return M1, V1, M2, V2, e


def _contact_mass(M1: Array, M2: Array) -> Array:
    refuse(np.isinf(M1) & np.isinf(M2), "at most one body can be immovable", m1=M1, m2=M2)
    light, heavy = np.minimum(M1, M2), np.maximum(M1, M2)
    return np.asarray(light / (1 + light / heavy))


def _kinetic_energy(mass: Array, velocity: Array) -> Array:
    """M V^2/2, and 0 for a body at rest whose mass is infinite."""
    return np.where(velocity == 0, 0.0, mass) * velocity * velocity / 2


def _mass(name: str, value: ArrayLike) -> Array:
    M = array(name, value, "kg")
    refuse(~(M > 0), "a mass must be positive [kg], or inf for an immovable body", **{name: M})
    return M


def _fraction(name: str, value: ArrayLike) -> Array:
    x = array(name, value, "")
    refuse(~((x >= 0) & (x <= 1)), "must be from 0 to 1", **{name: x})
    return x
