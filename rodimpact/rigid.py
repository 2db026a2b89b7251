"""Rigid-body collisions on a line, from momentum and a coefficient of restitution.

The impulse P between the two bodies determines both velocities. P follows from the
coefficient of restitution e, which is the speed of separation divided by the speed of
approach. `collide` computes one collision. `stack_drop` computes one collision for each
ball of a stack.

Arguments broadcast as in NumPy. Results are floats if every argument is a single
number. Velocities are positive to the right. Body 1 is on the left. Numbers of
equations, samples and problems are those of the textbook section 10.5, "Collisions in
1D".
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .hints import explain_arguments, explain_missing, missing_name
from .model.arguments import (
    Array,
    Number,
    array,
    broadcast_arguments,
    check_flag,
    demand,
    float_or_array,
)
from .model.frozen import SMALLEST

__all__ = [
    "RigidCollision",
    "StackDrop",
    "collide",
    "reduced_mass",
    "restitution_from_heights",
    "restitution_from_velocities",
    "stack_drop",
]


if not TYPE_CHECKING:  # a type checker must not take every name for granted

    def __getattr__(name: str) -> object:
        """Raise AttributeError that names the function that may be meant."""
        raise missing_name(__name__, name, __all__)


# Unit and sign of an argument
_MASS = ("kg", "positive or infinite")
_VELOCITY = ("m/s", "any")
_TOO_SLOW = (
    f"must be {SMALLEST:g} m/s or more above the velocity of body 2, got {{0!r}} more"
)
_NOT_APPROACHING = (
    "must be above the velocity of body 2, {1!r}, got {0!r}: the bodies do not "
    "approach; body 1 is on the left"
)


@explain_missing()
class RigidCollision(NamedTuple):
    """Velocities, impulse and energies of a collision of two rigid bodies.

    Attributes
    ----------
    velocity_1, velocity_2 : float or array
        Velocities after the collision [m/s].
    impulse : float or array
        Impulse on body 2; body 1 receives the opposite [N s].
    centre_of_mass_velocity : float or array
        The same before and after [m/s].
    relative_velocity_before, relative_velocity_after : float or array
        Velocity of body 2 minus velocity of body 1: negative before the collision,
        positive after a rebound [m/s].
    energy_before, energy_after : float or array
        Kinetic energy of both bodies; an immovable body has the energy 0 at rest, else
        infinity [J].
    energy_lost : float or array
        Kinetic energy lost, finite also with an immovable body [J].

    Examples
    --------
    Equal masses exchange velocities:

    >>> import rodimpact as ri
    >>> collision = ri.rigid.collide(1.0, 2.0, 1.0, 0.0, 1.0)
    >>> collision.velocity_1, collision.velocity_2, collision.energy_lost
    (0.0, 2.0, 0.0)
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


@explain_missing()
class StackDrop(NamedTuple):
    """A stack of balls after its drop.

    Attributes
    ----------
    velocities : array, shape (..., balls)
        Velocities from the bottom ball to the top one, positive upwards [m/s].
    top_height : float or array
        Height that the top ball reaches above the position of its collision; 0 if it
        does not rise [m].

    Examples
    --------
    A light ball on a heavy one:

    >>> import rodimpact as ri
    >>> drop = ri.rigid.stack_drop([1.0, 1e-9], [1.0, 1.0], height=1.0)
    >>> round(float(drop.top_height), 6)
    9.0
    """

    velocities: Array
    top_height: Number


@explain_arguments
def reduced_mass(m1: ArrayLike, m2: ArrayLike) -> Number:
    """Reduced mass of two bodies, ``mu = m1 m2/(m1 + m2)``.

    The kinetic energy of their relative motion is ``mu (v1 - v2)^2/2``. If one mass is
    infinite, mu is the other mass.

    Parameters
    ----------
    m1, m2 : float or array
        Masses; one of them may be infinite [kg].

    Returns
    -------
    float or array
        The reduced mass mu [kg].

    Raises
    ------
    ValueError
        If a mass is not positive, or both are infinite.

    Examples
    --------
    >>> reduced_mass(2.0, 6.0), reduced_mass(2.0, float("inf"))
    (1.5, 2.0)
    """
    M1, M2 = broadcast_arguments(m1=(m1, *_MASS), m2=(m2, *_MASS))
    message = (
        "must be finite where m1 is infinite: at most one body can be immovable, "
        "got {0!r}"
    )
    one_is_finite = np.isfinite(M1) | np.isfinite(M2)
    demand(one_is_finite, "m2", message, M2)
    light = np.minimum(M1, M2)
    heavy = np.maximum(M1, M2)
    mu = light / (1 + light / heavy)  # m1 m2/(m1 + m2), also if one is infinite
    return float_or_array(mu)


@explain_arguments
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

    The centre of mass keeps its velocity. The relative velocity v2 - v1 is multiplied
    by -e: this is Newton's law of restitution (the textbook's eq. 10.56). With the
    reduced mass ``mu = m1 m2/(m1 + m2)``, the impulse is ``P = (1 + e) mu (v1 - v2)``,
    and the energy lost is ``(1 - e^2) mu (v1 - v2)^2/2``. With e = 0 the bodies stay
    together, with e = 1 no energy is lost, with a negative e they pass through each
    other.

    Parameters
    ----------
    m1, m2 : float or array
        Masses; infinite for an immovable body [kg].
    v1, v2 : float or array
        Velocities before the collision, v1 > v2 [m/s].
    restitution : float or array
        Coefficient of restitution e, from -1 to 1 [1].
    allow_energy_release : bool
        Whether abs(e) > 1 is accepted: a collision that adds energy, such as an
        explosion.

    Returns
    -------
    RigidCollision
        Velocities, impulse and energies, each of the broadcast shape of the arguments.

    Raises
    ------
    ValueError
        If a mass is not positive or both are infinite, a velocity or e is not finite,
        the bodies do not approach, or abs(e) > 1 without `allow_energy_release`.

    Examples
    --------
    Problem 10.5.6:

    >>> after = collide(7.0, 6.0, 9.0, 2.0, 0.5)
    >>> after.impulse, after.velocity_1, after.velocity_2
    (23.625, 2.625, 4.625)
    """
    M1, V1, M2, V2, e = broadcast_arguments(
        m1=(m1, *_MASS),
        v1=(v1, *_VELOCITY),
        m2=(m2, *_MASS),
        v2=(v2, *_VELOCITY),
        restitution=(restitution, "", "any"),
    )
    check_flag("allow_energy_release", allow_energy_release)
    demand(V1 > V2, "v1", _NOT_APPROACHING, V1, V2)
    if not allow_energy_release:
        message = (
            "must lie in [-1, 1], got {0!r}, which adds energy; set "
            "allow_energy_release=True if that is meant"
        )
        demand(np.abs(e) <= 1, "restitution", message, e)
    # With the reduced mass mu, m1/(m1 + m2) is mu/m2, which is 1 if m1 is infinite.
    mu = np.asarray(reduced_mass(M1, M2))
    mass_fraction_1 = mu / M2  # m1/(m1 + m2)
    mass_fraction_2 = mu / M1  # m2/(m1 + m2)
    V_cm = mass_fraction_1 * V1 + mass_fraction_2 * V2
    # Velocities of body 2 relative to body 1; they give W1 and W2 after the collision
    before = V2 - V1
    after = -e * before
    W1 = V_cm - mass_fraction_2 * after
    W2 = V_cm + mass_fraction_1 * after
    # Energies are infinite if an immovable body moves; the energy lost is finite.
    energy_before = _kinetic_energy(M1, V1) + _kinetic_energy(M2, V2)
    energy_after = _kinetic_energy(M1, W1) + _kinetic_energy(M2, W2)
    lost_fraction = (1 - e) * (1 + e)  # of the energy of the relative motion
    energy_lost = lost_fraction * _kinetic_energy(mu, before)
    impulse = mu * (after - before)
    return RigidCollision(
        velocity_1=float_or_array(W1),
        velocity_2=float_or_array(W2),
        impulse=float_or_array(impulse),
        centre_of_mass_velocity=float_or_array(V_cm),
        relative_velocity_before=float_or_array(before),
        relative_velocity_after=float_or_array(after),
        energy_before=float_or_array(energy_before),
        energy_after=float_or_array(energy_after),
        energy_lost=float_or_array(energy_lost),
    )


@explain_arguments
def restitution_from_velocities(
    v1_before: ArrayLike, v2_before: ArrayLike, v1_after: ArrayLike, v2_after: ArrayLike
) -> Number:
    """Coefficient of restitution from measured velocities.

    ``e = (v2_after - v1_after)/(v1_before - v2_before)`` (the textbook's eq. 10.56).
    With abs(e) > 1 energy was released.

    Parameters
    ----------
    v1_before, v2_before : float or array
        Velocities before the collision, v1_before > v2_before [m/s].
    v1_after, v2_after : float or array
        Velocities after the collision [m/s].

    Returns
    -------
    float or array
        Coefficient of restitution [1].

    Raises
    ------
    ValueError
        If a velocity is not finite or the bodies do not approach, or if they approach
        so slowly that e might overflow.

    Examples
    --------
    >>> restitution_from_velocities(10.0, 5.0, 6.0, 7.0)
    0.2
    """
    V1, V2, W1, W2 = broadcast_arguments(
        v1_before=(v1_before, *_VELOCITY),
        v2_before=(v2_before, *_VELOCITY),
        v1_after=(v1_after, *_VELOCITY),
        v2_after=(v2_after, *_VELOCITY),
    )
    demand(V1 > V2, "v1_before", _NOT_APPROACHING, V1, V2)
    closing = V1 - V2
    # No velocity exceeds 1e150 m/s, so e stays finite.
    demand(closing >= SMALLEST, "v1_before", _TOO_SLOW, closing)
    parting = W2 - W1
    return float_or_array(parting / closing)


@explain_arguments
def restitution_from_heights(drop: ArrayLike, rebound: ArrayLike) -> Number:
    """Coefficient of restitution of a dropped ball with the ground.

    ``e = sqrt(rebound/drop)``, because speeds are proportional to the square root of
    the height (problems 10.5.2 and 10.5.4).

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
    fall, rise = broadcast_arguments(
        drop=(drop, "m", "positive"), rebound=(rebound, "m", "non-negative")
    )
    message = (
        "must be at most the drop, {1!r}, got {0!r}: a ball from rest rises no higher"
    )
    # The message shows the rise as {0!r}, and the fall as {1!r}.
    demand(rise <= fall, "rebound", message, rise, fall)
    e = np.sqrt(rise / fall)
    return float_or_array(e)


@explain_arguments
def stack_drop(
    masses: ArrayLike,
    restitutions: ArrayLike,
    height: ArrayLike,
    gravity: ArrayLike = 9.81,
) -> StackDrop:
    """Stack of balls dropped on the floor, which collide one after another.

    The gaps between the falling balls are very small. The bottom ball bounces off the
    floor and meets the second ball, which is still falling. The second ball then meets
    the third one, and so on upwards. Each pair collides once: later collisions of the
    same two balls are left out. In contrast, `solve` treats contacts that close at the
    same time as one collision. With a small gap between two balls, such as
    ``gaps=[1.0, 1e-6]`` above a wall, `solve` also computes one collision after
    another.

    Parameters
    ----------
    masses : array, shape (..., balls)
        Finite masses from the bottom to the top [kg].
    restitutions : array, shape (..., balls)
        Coefficient of restitution of each ball with the ball below it, from 0 to 1. The
        first one is that of the bottom ball with the floor [1].
    height : float or array, shape (...)
        Height of the release [m].
    gravity : float or array, shape (...)
        Gravitational acceleration [m/s^2].

    Returns
    -------
    StackDrop
        Velocities of shape (..., balls) after all collisions, positive upwards, and the
        height of shape (...) that the top ball reaches above its collision, 0 if it
        does not rise.

    Raises
    ------
    ValueError
        If the numbers of masses and restitutions differ, a mass, `height` or `gravity`
        is not positive and finite, or a restitution is not from 0 to 1.

    Examples
    --------
    A basketball with a tennis ball on top:

    >>> round(stack_drop([0.6, 0.06], [0.9, 0.6], height=1.0).top_height, 4)
    3.1104
    """
    # Members of a family come first: the last axis of M, e and v is that of the balls.
    M = np.atleast_1d(array("masses", masses, "kg", "positive"))
    e = np.atleast_1d(array("restitutions", restitutions, "", "[0, 1]"))
    h, g = broadcast_arguments(
        height=(height, "m", "positive"), gravity=(gravity, "m/s^2", "positive")
    )
    n_balls = M.shape[-1]
    n_restitutions = e.shape[-1]
    if n_balls != n_restitutions or n_balls == 0:
        raise ValueError(
            f"masses has {n_balls} balls and restitutions {n_restitutions}: give at "
            "least one ball, and one restitution for each: first that of the bottom "
            "ball with the floor, then that of each ball with the ball below it"
        )
    drop_speed = np.sqrt(2 * g * h)
    shape = np.broadcast_shapes(M.shape[:-1], e.shape[:-1], drop_speed.shape)
    fall_velocity = -drop_speed[..., np.newaxis]  # [..., 1], the same for all balls
    v = np.full((*shape, n_balls), fall_velocity)  # positive upwards
    v[..., 0] = e[..., 0] * drop_speed  # the bottom ball bounces off the floor
    for i in range(1, n_balls):
        below = i - 1
        after = collide(
            m1=M[..., below],
            v1=v[..., below],
            m2=M[..., i],
            v2=v[..., i],
            restitution=e[..., i],
        )
        v[..., below] = after.velocity_1
        v[..., i] = after.velocity_2
    rise_speed = np.maximum(v[..., -1], 0.0)  # 0 if the top ball does not rise
    top_height = rise_speed**2 / (2 * g)
    return StackDrop(velocities=v, top_height=float_or_array(top_height))


def _kinetic_energy(mass: Array, velocity: Array) -> Array:
    """Kinetic energy M V^2/2, J; 0 for a body at rest, also if its mass is infinite."""
    moving_mass = np.where(velocity == 0, 0.0, mass)
    return moving_mass * velocity * velocity / 2
