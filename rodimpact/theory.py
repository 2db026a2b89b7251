"""Closed forms for elastic rods: collisions, horns, damping and lateral inertia.

Two rods with the impedances Z = rho A c meet at the closing speed V. The contact force
is V Z1 Z2/(Z1 + Z2) until a wave returns from a far end. The wave of the rod with the
shorter transit time T = L/c returns first, after 2 T. If this rod has the lower
impedance, the contact force ends. If it has the higher impedance, the force is
multiplied by q at each return of its wave, until the wave of the other rod ends the
contact:

    q = (Z_short - Z_long)/(Z_short + Z_long)      short, long: by transit time

The module also has exact results for tapers, damping and lateral inertia, for which
d'Alembert's solution does not hold.

Arguments broadcast as in NumPy. Results are floats if every argument is a single
number.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .hints import explain_arguments, explain_missing, missing_name
from .model.arguments import Array, Number, array, broadcast_arguments, float_or_array
from .rigid import reduced_mass

__all__ = [
    "PairCollision",
    "horn_amplification",
    "horn_frequency",
    "kelvin_voigt_decay",
    "mass_on_rod",
    "rayleigh_love_speed",
    "rod_on_wall",
    "saint_venant",
    "saint_venant_force",
]


if not TYPE_CHECKING:  # a type checker must not take every name for granted

    def __getattr__(name: str) -> object:
        """Raise AttributeError that names the function that may be meant."""
        raise missing_name(__name__, name, __all__)


EQUAL_IMPEDANCES_RTOL = 2.0**-48
"""Impedances that differ by less than this fraction count as equal, up to round-off."""
RULES = {
    "impedance": ("kg/s", "positive"),
    "transit_time": ("s", "positive"),
    "mass": ("kg", "positive"),
    "speed": ("m/s", "positive"),
    "closing_speed": ("m/s", "positive"),
    "area": ("m^2", "positive"),
    "wave_speed": ("m/s", "positive"),
    "youngs_modulus": ("Pa", "positive"),
    "viscosity": ("Pa s", "positive"),
    "angular_frequency": ("rad/s", "positive"),
    "gyration_radius": ("m", "positive"),
    "wave_number": ("rad/m", "any"),
    "taper": ("1/m", "any"),
    "poisson_ratio": ("", "any"),
}
"""Unit and sign of each argument, by its name without the number of the body."""


@explain_missing()
class PairCollision(NamedTuple):
    """Collision of two bodies that do not vibrate beforehand.

    Attributes
    ----------
    restitution : float or array
        Coefficient of restitution of the centres of mass [1].
    impulse : float or array
        Impulse on either body [N s].
    duration : float or array
        Time from first contact to the end of the contact force [s].
    opening : float or array
        Time from first contact until the ends move apart [s].
    peak_force : float or array
        Peak of the contact force [N].
    vibration_energy : float or array
        Vibration energy of both bodies after the contact [J].

    Examples
    --------
    >>> pair = saint_venant(1.0, 1.0, 1.0, 2.0, closing_speed=3.0)
    >>> pair.restitution, pair.impulse
    (0.5, 3.0)
    """

    restitution: Number
    impulse: Number
    duration: Number
    opening: Number
    peak_force: Number
    vibration_energy: Number


@np.errstate(under="ignore")  # q^K may vanish
@explain_arguments
def saint_venant(
    impedance_1: ArrayLike,
    transit_time_1: ArrayLike,
    impedance_2: ArrayLike,
    transit_time_2: ArrayLike,
    closing_speed: ArrayLike = 1.0,
) -> PairCollision:
    """Collision of two uniform free rods, each moving uniformly.

    With q = (Z_short - Z_long)/(Z_short + Z_long), short and long by transit time,
    x = T_short/T_long, and T_long = (K + f) T_short, K whole and 0 <= f < 1::

        Z_long >= Z_short:  e = |q| + (1 - |q|) x                force ends at 2 T_short
        Z_long < Z_short:   e = (1 + q) x g - q^K (1 - (1 - q) f)
                            g = (1 - q^K)/(1 - q) + q^K f        force ends at 2 T_long

    This is ``e = J (1/m1 + 1/m2)/V - 1`` with m = Z T and J the integral of
    `saint_venant_force`. The terms are arranged so that no digits cancel at any ratio
    of impedances. Equal transit times give e = 1 for all impedances. Equal impedances
    give e = x.

    The contact opens when the force ends, with one exception: rods of equal impedance
    then touch without force and move together until the wave of the long rod opens the
    contact at 2 T_long. No second contact follows. Where Z_long equals Z_short, e and J
    are continuous, but the duration jumps between 2 T_short and 2 T_long.

    Source: B. de Saint-Venant, Sur le choc longitudinal de deux barres élastiques,
    Journal de mathématiques pures et appliquées 12 (1867); S. P. Timoshenko and J. N.
    Goodier, Theory of Elasticity, longitudinal impact of bars.

    Parameters
    ----------
    impedance_1, impedance_2 : float or array
        Impedances rho A c [kg/s].
    transit_time_1, transit_time_2 : float or array
        Times L/c that a wave takes from end to end [s].
    closing_speed : float or array
        Velocity of the left rod minus that of the right one [m/s].

    Returns
    -------
    PairCollision
        Every entry has the broadcast shape of the arguments.

    Raises
    ------
    ValueError
        If an argument is not positive and finite.

    Examples
    --------
    Equal impedances, one rod twice as long: the force ends at 2, the gap opens at 4.

    >>> pair = saint_venant(1.0, 1.0, 1.0, 2.0)
    >>> pair.restitution, pair.duration, pair.opening
    (0.5, 2.0, 4.0)
    >>> pair.impulse, pair.peak_force, pair.vibration_energy
    (1.0, 0.5, 0.25)

    A short rod of five times the impedance:

    >>> round(saint_venant(5.0, 3.0, 1.0, 10.0).restitution, 6)
    0.841564
    """
    Z1, T1, Z2, T2, V = _checked(
        impedance_1=impedance_1,
        transit_time_1=transit_time_1,
        impedance_2=impedance_2,
        transit_time_2=transit_time_2,
        closing_speed=closing_speed,
    )
    numbers = pair_numbers(Z1, T1, Z2, T2)
    e = pair_restitution(numbers)
    m = reduced_mass(Z1 * T1, Z2 * T2)
    low = np.minimum(Z1, Z2)
    high = np.maximum(Z1, Z2)
    q = numbers.q
    # The wave of the short rod ends the force, except if q > 0: then the short rod goes
    # on pushing, and the wave of the long rod ends it. For equal transit times q <= 0.
    # For impedances that are equal up to round-off `pair_numbers` sets q to exactly 0.
    ending_transit = np.where(q > 0, numbers.long_time, numbers.short_time)
    duration = 2 * ending_transit
    # Rods of equal impedance, q = 0, stay in touch after the force has ended.
    opening = np.where(q == 0, 2 * numbers.long_time, duration)
    # V Z1 Z2/(Z1 + Z2) = V low (high/(high + low)): no product of impedances overflows.
    high_fraction = high / (high + low)
    return _collision(
        restitution=e,
        impulse=(1 + e) * m * V,
        duration=duration,
        opening=opening,
        peak_force=V * low * high_fraction,
        vibration_energy=(1 - e) * (1 + e) * m * V * V / 2,  # 1 - e^2
    )


@np.errstate(under="ignore")
@explain_arguments
def saint_venant_force(
    time: ArrayLike,
    impedance_1: ArrayLike,
    transit_time_1: ArrayLike,
    impedance_2: ArrayLike,
    transit_time_2: ArrayLike,
    closing_speed: ArrayLike = 1.0,
) -> Number:
    """Contact force of two uniform free rods, each moving uniformly.

    ``F = V Z1 Z2/(Z1 + Z2) q^k`` for 2 k T_short <= t < 2 (k + 1) T_short while t <
    duration, otherwise 0, with q and the duration of `saint_venant`. Only if Z_long <
    Z_short does the force last beyond k = 0. At a jump the function returns the value
    after the jump.

    Source: see `saint_venant`.

    Parameters
    ----------
    time : float or array
        Time t since first contact [s].
    impedance_1, impedance_2 : float or array
        Impedances rho A c [kg/s].
    transit_time_1, transit_time_2 : float or array
        Times L/c that a wave takes from end to end [s].
    closing_speed : float or array
        Velocity of the left rod minus that of the right one [m/s].

    Returns
    -------
    float or array
        Contact force, positive when the rods push each other apart [N].

    Raises
    ------
    ValueError
        If `time` is not finite, or another argument is not positive and finite.

    Examples
    --------
    >>> saint_venant_force([0.0, 2.0, 4.0, 6.0], 3.0, 1.0, 1.0, 3.0).round(9).tolist()
    [0.75, 0.375, 0.1875, 0.0]
    """
    t = array("time", time, "s", "any")
    pair = saint_venant(
        impedance_1, transit_time_1, impedance_2, transit_time_2, closing_speed
    )
    Z1, T1, Z2, T2 = _checked(
        impedance_1=impedance_1,
        transit_time_1=transit_time_1,
        impedance_2=impedance_2,
        transit_time_2=transit_time_2,
    )
    numbers = pair_numbers(Z1, T1, Z2, T2)
    time_in_contact = np.clip(t, 0.0, pair.duration)
    round_trip = 2 * numbers.short_time  # s
    k = np.floor(time_in_contact / round_trip)
    # q^k times the first force; for q <= 0 the force ends before k is 1.
    force = pair.peak_force * np.exp(k * numbers.log_q)
    is_pressing = (t >= 0) & (t < pair.duration)
    return float_or_array(np.where(is_pressing, force, 0.0))


@explain_arguments
def rod_on_wall(
    impedance: ArrayLike, transit_time: ArrayLike, speed: ArrayLike
) -> PairCollision:
    """Collision of a uniform free rod, moving uniformly, with a rigid wall.

    ``F = Z V for a time 2 T``, in which the wave runs to the free end and back. The rod
    leaves the wall with its initial speed and without vibration.

    Source: textbook section 10.5, box 10.4.

    Parameters
    ----------
    impedance : float or array
        Impedance rho A c [kg/s].
    transit_time : float or array
        Time L/c that a wave takes from end to end [s].
    speed : float or array
        Speed at which the rod approaches the wall [m/s].

    Returns
    -------
    PairCollision
        Every entry has the broadcast shape of the arguments.

    Raises
    ------
    ValueError
        If an argument is not positive and finite.

    Examples
    --------
    >>> collision = rod_on_wall(impedance=40.0, transit_time=2.0e-4, speed=3.0)
    >>> collision.restitution, collision.impulse, collision.peak_force
    (1.0, 0.048, 120.0)
    """
    Z, T, V = _checked(impedance=impedance, transit_time=transit_time, speed=speed)
    round_trip = 2 * T
    return _collision(
        restitution=np.ones_like(Z),
        impulse=2 * Z * V * T,
        duration=round_trip,
        opening=round_trip,
        peak_force=Z * V,
        vibration_energy=np.zeros_like(Z),
    )


@explain_arguments
def mass_on_rod(
    mass: ArrayLike, impedance: ArrayLike, transit_time: ArrayLike, speed: ArrayLike
) -> PairCollision:
    """Collision of a rigid mass with the end of a uniform free rod without vibration.

    The rod acts as a dashpot, ``F = Z V exp(-Z t/M)``, until the wave returns from its
    free end after 2 T. Let mu = Z T/M be the mass of the rod over the mass M. Then
    ``e = (1 - exp(-2 mu))/mu - exp(-2 mu)``.

    Source: J. Boussinesq's solution for a struck rod, in S. P. Timoshenko and J. N.
    Goodier, Theory of Elasticity, section on longitudinal impact of bars; the free rod
    follows from balances.

    Parameters
    ----------
    mass : float or array
        M [kg].
    impedance : float or array
        Impedance Z = rho A c of the rod [kg/s].
    transit_time : float or array
        Time T = L/c that a wave takes from end to end [s].
    speed : float or array
        Speed at which the mass approaches the rod [m/s].

    Returns
    -------
    PairCollision
        Every entry has the broadcast shape of the arguments.

    Raises
    ------
    ValueError
        If an argument is not positive and finite.

    Examples
    --------
    >>> collision = mass_on_rod(mass=2.0, impedance=40.0, transit_time=0.05, speed=3.0)
    >>> round(collision.restitution, 6)
    0.729329
    """
    M, Z, T, V = _checked(
        mass=mass, impedance=impedance, transit_time=transit_time, speed=speed
    )
    rod_mass = Z * T
    mu = rod_mass / M
    round_trip = 2 * T
    # The fraction of its momentum that the mass hands over: 1 - exp(-Z t/M) at t = 2 T,
    # which is 1 - exp(-2 mu)
    momentum_fraction = -np.expm1(-2 * mu)
    # In the formula of the docstring, exp(-2 mu) is 1 - momentum_fraction.
    e = momentum_fraction / mu - 1 + momentum_fraction
    m = reduced_mass(M, rod_mass)
    return _collision(
        restitution=e,
        impulse=M * V * momentum_fraction,
        duration=round_trip,
        opening=round_trip,
        peak_force=Z * V,
        vibration_energy=(1 - e * e) * m * V * V / 2,
    )


@explain_arguments
def horn_amplification(area_0: ArrayLike, area_1: ArrayLike) -> Number:
    """Growth of a jump of velocity or stress from one cross-section to another.

    ``(A0/A1)^(1/2)``. The energy of the jump stays in the jump: a taper reflects waves
    only behind it.

    Source: G. B. Whitham, Linear and Nonlinear Waves, Wiley 1974, chapter 7, on tubes
    of rays in geometrical optics.

    Parameters
    ----------
    area_0, area_1 : float or array
        Cross-sectional areas where the jump starts and where it arrives [m^2].

    Returns
    -------
    float or array
        Jump at `area_1` over jump at `area_0` [1].

    Raises
    ------
    ValueError
        If an argument is not positive and finite.

    Examples
    --------
    >>> horn_amplification(area_0=4e-4, area_1=1e-4)
    2.0
    """
    A0, A1 = _checked(area_0=area_0, area_1=area_1)
    growth = np.sqrt(A0 / A1)
    return float_or_array(growth)


@explain_arguments
def horn_frequency(
    wave_speed: ArrayLike, wave_number: ArrayLike, taper: ArrayLike
) -> Number:
    """Angular frequency of a wave in an exponential horn, A = A0 exp(2 beta x).

    ``omega = c (k^2 + beta^2)^(1/2)`` for the wave
    ``u ~ exp(-beta x) cos(k x - omega t)``. No wave has a frequency below c beta.

    Source: A. G. Webster, Acoustical impedance, and the theory of horns and of the
    phonograph, Proc. Natl. Acad. Sci. USA 5 (1919) 275-282.

    Parameters
    ----------
    wave_speed : float or array
        c [m/s].
    wave_number : float or array
        k [rad/m].
    taper : float or array
        beta [1/m].

    Returns
    -------
    float or array
        omega [rad/s].

    Raises
    ------
    ValueError
        If the wave speed is not positive, or an argument not finite.

    Examples
    --------
    >>> horn_frequency(wave_speed=2.0, wave_number=3.0, taper=4.0)
    10.0
    """
    c, k, beta = _checked(wave_speed=wave_speed, wave_number=wave_number, taper=taper)
    omega = c * np.hypot(k, beta)
    return float_or_array(omega)


@explain_arguments
def kelvin_voigt_decay(
    youngs_modulus: ArrayLike, viscosity: ArrayLike, angular_frequency: ArrayLike
) -> Number:
    """Decay rate of a mode of a rod of Kelvin-Voigt material.

    ``eta omega^2/(2 E)``: the amplitude a of a mode obeys a'' + (eta/E) omega^2 a' +
    omega^2 a = 0.

    Source: Lord Rayleigh, The Theory of Sound, arts. 81 and 45, on modes with viscous
    damping proportional to stiffness.

    Parameters
    ----------
    youngs_modulus : float or array
        E [Pa].
    viscosity : float or array
        eta in the material law sigma = E eps + eta d(eps)/dt [Pa s].
    angular_frequency : float or array
        omega of the mode without damping [rad/s].

    Returns
    -------
    float or array
        Rate r of the amplitude exp(-r t) [1/s]. It holds while the mode oscillates,
        r < omega. The energy decays at the rate 2 r.

    Raises
    ------
    ValueError
        If an argument is not positive and finite.

    Examples
    --------
    >>> kelvin_voigt_decay(youngs_modulus=2.0, viscosity=0.5, angular_frequency=3.0)
    1.125
    """
    E, eta, omega = _checked(
        youngs_modulus=youngs_modulus,
        viscosity=viscosity,
        angular_frequency=angular_frequency,
    )
    rate = eta * omega * omega / (2 * E)
    return float_or_array(rate)


@explain_arguments
def rayleigh_love_speed(
    wave_speed: ArrayLike,
    poisson_ratio: ArrayLike,
    gyration_radius: ArrayLike,
    wave_number: ArrayLike,
) -> Number:
    """Phase velocity in a rod with lateral inertia.

    ``c/(1 + nu^2 kappa^2 k^2)^(1/2)``, from u_tt - nu^2 kappa^2 u_xxtt = c^2 u_xx.

    Source: A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed.,
    1927, art. 278; Lord Rayleigh, The Theory of Sound, art. 157.

    Parameters
    ----------
    wave_speed : float or array
        Bar speed c [m/s].
    poisson_ratio : float or array
        nu [1].
    gyration_radius : float or array
        kappa = (I_p/A)^(1/2), I_p the polar second moment of the cross-section; of a
        solid round rod its diameter over 8^(1/2) [m].
    wave_number : float or array
        k [rad/m].

    Returns
    -------
    float or array
        omega/k [m/s].

    Raises
    ------
    ValueError
        If wave speed or radius of gyration is not positive, or an argument not finite.

    Examples
    --------
    >>> rayleigh_love_speed(
    ...     5000.0, poisson_ratio=0.25, gyration_radius=3.0, wave_number=1.0
    ... )
    4000.0
    """
    c, kappa, nu, k = _checked(
        wave_speed=wave_speed,
        gyration_radius=gyration_radius,
        poisson_ratio=poisson_ratio,
        wave_number=wave_number,
    )
    slowdown = np.hypot(1.0, nu * kappa * k)
    return float_or_array(c / slowdown)


class PairNumbers(NamedTuple):
    """Transit times of two rods, and dimensionless numbers of their collision.

    The short rod has the shorter transit time, the long rod the longer one.
    """

    short_time: Array  # T of the short rod, s
    long_time: Array  # T of the long rod, s
    q: Array  # (Z_short - Z_long)/(Z_short + Z_long)
    p: Array  # 1 - |q|, without cancellation
    log_q: Array  # log(q) where q > 0, else 0


def pair_numbers(Z1: Array, T1: Array, Z2: Array, T2: Array) -> PairNumbers:
    """Numbers of `saint_venant` from impedances, kg/s, and transit times, s.

    They are the transit times of the short and the long rod, q = (Z_short -
    Z_long)/(Z_short + Z_long), p = 1 - abs(q), and log(q) where q > 0, else 0.
    Impedances that are equal up to round-off give q = 0 and p = 1. Equal transit
    times, for which no rod is the short one, give q <= 0. The page of the explorer has
    this function and `pair_restitution` as JavaScript.
    """
    low = np.minimum(Z1, Z2)
    high = np.maximum(Z1, Z2)
    difference = high - low
    total = high + low
    is_equal = difference <= EQUAL_IMPEDANCES_RTOL * high
    # Where transit times are equal, this is False: no rod is the short one.
    short_has_higher_impedance = np.where(Z1 > Z2, T1 < T2, T2 < T1)
    short_has_higher_impedance = np.where(is_equal, False, short_has_higher_impedance)
    abs_q = np.where(is_equal, 0.0, difference / total)
    q = np.where(short_has_higher_impedance, abs_q, -abs_q)
    p = np.where(is_equal, 1.0, 2 * low / total)  # 1 - difference/total
    # With r = low/high, q = (1 - r)/(1 + r), and log(q) = -2 artanh(r). The 0.0 makes
    # log_q 0 where q is not positive.
    low_over_high = np.where(short_has_higher_impedance, low / high, 0.0)
    log_q = -2 * np.arctanh(low_over_high)
    return PairNumbers(np.minimum(T1, T2), np.maximum(T1, T2), q, p, log_q)


def pair_restitution(numbers: PairNumbers) -> Array:
    """Coefficient of restitution e, by the formulae and letters of `saint_venant`.

    With p = 1 - abs(q), e = abs(q) + p x for Z_long >= Z_short, else
    e = (1 + q) x g - q^K (1 - p f), with g = (1 - q^K)/p + q^K f. It is 1 at most.
    """
    q = numbers.q
    p = numbers.p
    x = numbers.short_time / numbers.long_time
    trips = numbers.long_time / numbers.short_time  # K + f
    K = np.floor(trips)
    f = trips - K
    log_q_K = K * numbers.log_q
    q_K = np.exp(log_q_K)  # q^K
    geometric_sum = -np.expm1(log_q_K) / p  # (1 - q^K)/(1 - q)
    g = geometric_sum + q_K * f
    if_long_higher = np.abs(q) + p * x
    handed_over = (1 + q) * x * g
    if_short_higher = handed_over - q_K * (1 - p * f)
    e: Array = np.where(q > 0, if_short_higher, if_long_higher)
    return np.minimum(e, 1.0)  # round-off may exceed 1


def _collision(**entries: Any) -> PairCollision:
    """PairCollision with these entries by name; those of shape () become floats."""
    values = {}
    for name, entry in entries.items():
        values[name] = float_or_array(np.asarray(entry))
    return PairCollision(**values)


def _checked(**arguments: ArrayLike) -> tuple[Array, ...]:
    """Arguments as arrays of one shape, in the order given.

    `RULES` has the unit and the sign of each argument, under its name without a final
    number. ValueError names all arguments that are not finite or have the wrong sign.
    """
    with_rules = {}
    for name, value in arguments.items():
        unit, sign = RULES[name.rstrip("_012")]  # "impedance" of "impedance_1"
        with_rules[name] = (value, unit, sign)
    return broadcast_arguments(**with_rules)
