"""Waves in round bars: the exact first mode of Pochhammer (1876) and Chree (1889).

A bar of radius a carries a wave of wavelength l at the phase velocity c. With
G = 2 pi a/l the equation of frequencies is::

    2 A^2 (B^2 + G^2) j(A) j(B) - (B^2 - G^2)^2 J0(A) j(B) - 4 G^2 A^2 j(A) J0(B) = 0
    A^2 = G^2 (c^2/c1^2 - 1),  B^2 = G^2 (c^2/c2^2 - 1),  j(x) = J1(x)/x

with the dilatational speed c1 and the shear speed c2. The equation is from K. F. Graff,
Wave Motion in Elastic Solids, divided by A B, so that c = c1 and c = c2 are not roots.
If A or B is imaginary, the modified Bessel function I replaces J. Long waves have the
bar speed c0 = sqrt(E/rho), with c/c0 = 1 - nu^2 G^2/4 to second order. Short waves have
the speed of Rayleigh's surface waves. `mindlin_herrmann` is an approximation to the
first mode.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.special import i0e, i1e, j0, j1

from .hints import explain_arguments, missing_name
from .model.arguments import (
    Array,
    Number,
    array,
    broadcast_arguments,
    demand,
    float_or_array,
)
from .model.bodies import Rod, Segment
from .model.frozen import (
    FrozenDataclass,
    Problems,
    invalid_argument,
    quantity,
    raise_if_problems,
)
from .model.lateral_inertia import INERTIA, radial_moduli
from .progress import Progress, ProgressFunction, check_progress
from .units import shown

__all__ = [
    "Bar",
    "first_mode",
    "mindlin_herrmann",
    "rayleigh_speed",
]


if not TYPE_CHECKING:  # a type checker must not take every name for granted

    def __getattr__(name: str) -> object:
        """Raise AttributeError that names the function that may be meant."""
        raise missing_name(__name__, name, __all__)


CUT_OFF = 0.2619
"""f a/c0 beyond which the first mode alone does not describe a bar.

The wavelength there is about a/0.3: A. Tyas and D. J. Pope, Measurement Science and
Technology 16 (2005) 642.
"""
CUT_OFF_RTOL = 1e-12
"""A frequency may exceed the cut-off by this fraction, its round-off."""
SPEED_STEP = 2.0**-7
"""Distance of the speeds c/c0 between which the lowest root is bracketed."""
ROOT_ATOL = 1e-15
"""Error of a root c/c0."""
MAX_RADIUS_OVER_WAVELENGTH = 1e15
"""Shorter waves run at the speed of surface waves, to the last digit."""
DIFFERENCE_STEP = 2.0**-13
"""Relative step of the difference quotient that gives the group velocity.

Its error is the step squared, plus round-off over the step.
"""
VALUES_PER_BLOCK = 128
"""Roots found at a time: memory is bounded, and progress is reported in between."""
SLOWNESS_KNOTS = 257
"""Knots of the curve of delays from frequency 0 to the cut-off."""
SERIES_LIMIT = 1e-8
"""Below this argument J1(x)/x is 1/2 to the last digit."""

WavenumberFunction: TypeAlias = Callable[[Any, Any], Any]
"""Dimensionless wave number G from a given number of a wave and its speed c/c0."""


class Bar(FrozenDataclass):
    """Round bar, described by the numbers that determine its dispersion.

    Parameters
    ----------
    wave_speed : float
        c0 = sqrt(E/rho) of long waves, m/s.
    poisson_ratio : float
        nu, from 0 to 0.5.
    radius : float
        a, m; an equivalent radius if the bar is not round.

    Raises
    ------
    InvalidModel
        If fields are invalid. The message names all of them.

    Examples
    --------
    In a steel bar of 20 mm, waves of 100 kHz are 4.5 % slower than long waves.

    >>> bar = Bar(wave_speed=5189.0, poisson_ratio=0.29, radius=0.01)
    >>> bar.phase_velocity([0.0, 100e3]).round().tolist()
    [5189.0, 4958.0]
    """

    wave_speed: float = quantity("m/s", "positive", scalar=True)
    poisson_ratio: float = quantity("", "[0, 0.5]", scalar=True)
    radius: float = quantity("m", "positive", scalar=True)

    @classmethod
    def of(cls, rod: Rod | Segment, radius: float | None = None) -> Bar:
        """Bar of a uniform rod of round section, or with an equivalent radius.

        Parameters
        ----------
        rod : Rod or Segment
            Uniform, with a material that has a `poisson_ratio`. Without `radius` it
            must be given by its diameter.
        radius : float, optional
            Equivalent radius of a section that is not round, m.

        Returns
        -------
        Bar

        Raises
        ------
        InvalidModel
            If the rod has no single section, its section is not said to be round, or
            its material has no Poisson ratio.

        Examples
        --------
        >>> import rodimpact as ri
        >>> rod = ri.Rod(1.0, diameter=0.02, material=ri.materials.steel)
        >>> round(Bar.of(rod).radius, 12)
        0.01
        """
        segment = _uniform_segment(rod)
        material = segment.material
        if material.poisson_ratio is None:
            message = f"is missing in {shown(material.name)}; dispersion needs it"
            raise invalid_argument("bar.material.poisson_ratio", message)
        if radius is not None:
            return cls(material.wave_speed, material.poisson_ratio, radius)
        if not segment.solid_round:
            message = (
                "is not said to be round; give the rod its diameter in place of the "
                "area, or radius=, the equivalent radius in m"
            )
            raise invalid_argument("bar.section", message)
        round_radius = np.sqrt(segment.area / math.pi)
        return cls(material.wave_speed, material.poisson_ratio, round_radius)

    def phase_velocity(self, frequency: ArrayLike) -> Number:
        """Phase velocity c of the first mode.

        Parameters
        ----------
        frequency : float or array
            f, 0 or more, Hz.

        Returns
        -------
        float or array
            c, m/s, of the shape of `frequency`.

        Raises
        ------
        ValueError
            If a frequency is negative or not finite.

        Examples
        --------
        >>> bar = Bar(wave_speed=5000.0, poisson_ratio=0.3, radius=0.01)
        >>> bar.phase_velocity([0.0, 150e3]).round().tolist()
        [5000.0, 3885.0]
        """
        return float_or_array(self.wave_speed * self._speed_ratio(frequency))

    def group_velocity(self, frequency: ArrayLike) -> Number:
        """Group velocity d(omega)/dk of the first mode.

        With x = c/c0 and omega a/c0 = G x(G), the group velocity is c0 d(G x)/dG. The
        derivative is a central difference.

        Parameters
        ----------
        frequency : float or array
            f, 0 or more, Hz.

        Returns
        -------
        float or array
            m/s, of the shape of `frequency`.

        Raises
        ------
        ValueError
            If a frequency is negative or not finite.

        Examples
        --------
        >>> bar = Bar(wave_speed=5000.0, poisson_ratio=0.3, radius=0.01)
        >>> bar.group_velocity([0.0, 150e3]).round().tolist()
        [5000.0, 1975.0]
        """
        f = array("frequency", frequency, "Hz", "non-negative")
        x = self._speed_ratio(f)
        # G = k a, with k = omega/c = 2 pi f/(c0 x)
        G = np.asarray(2 * math.pi * self.radius / self.wave_speed * f / x)
        # G x on both sides of G
        above = self._scaled_frequency(G * (1 + DIFFERENCE_STEP))
        below = self._scaled_frequency(G * (1 - DIFFERENCE_STEP))
        change = above - below
        width = 2 * DIFFERENCE_STEP * G
        ratio = np.ones(G.shape)  # 1 stays where G = 0: the limit of long waves
        np.divide(change, width, out=ratio, where=G > 0)
        return float_or_array(self.wave_speed * ratio)

    def wavenumber(self, frequency: ArrayLike) -> Number:
        """Wave number k = omega/c of the first mode.

        Parameters
        ----------
        frequency : float or array
            f, 0 or more, Hz.

        Returns
        -------
        float or array
            k, rad/m, of the shape of `frequency`.

        Raises
        ------
        ValueError
            If a frequency is negative or not finite.

        Examples
        --------
        >>> bar = Bar(wave_speed=5000.0, poisson_ratio=0.3, radius=0.01)
        >>> bar.wavenumber([0.0, 150e3]).round(2).tolist()
        [0.0, 242.6]
        """
        f = array("frequency", frequency, "Hz", "non-negative")
        k_of_long_waves = 2 * math.pi * f / self.wave_speed
        k = k_of_long_waves / self._speed_ratio(f)
        return float_or_array(k)

    @property
    def cut_off(self) -> float:
        """Frequency above which the first mode alone does not describe the bar, Hz."""
        return CUT_OFF * self.wave_speed / self.radius

    def delays(self, frequency: ArrayLike) -> Number:
        """Delay of waves relative to long waves per metre of bar, 1/c - 1/c0.

        The values come from a spline through exact values up to the cut-off. This is
        faster than solving the equation for each of the many frequencies of a record.

        Parameters
        ----------
        frequency : float or array
            f, from 0 to the cut-off, Hz.

        Returns
        -------
        float or array
            1/c - 1/c0, s/m, of the shape of `frequency`.

        Raises
        ------
        ValueError
            If a frequency is out of this range.

        Examples
        --------
        >>> bar = Bar(wave_speed=5000.0, poisson_ratio=0.3, radius=0.01)
        >>> (1e6 * bar.delays([0.0, 100e3])).round(2).tolist()  # us/m
        [0.0, 11.1]
        """
        f = array("frequency", frequency, "Hz")
        highest = self.cut_off * (1 + CUT_OFF_RTOL)
        message = f"must be from 0 to {self.cut_off!r} Hz, got {{0!r}}"
        is_in_range = (f >= 0) & (f <= highest)
        demand(is_in_range, "frequency", message, f)
        relative_delays = _slowness_curve(self.poisson_ratio)
        scaled_frequency = f * self.radius / self.wave_speed
        relative_delay = relative_delays(scaled_frequency)  # c0/c - 1
        return float_or_array(relative_delay / self.wave_speed)

    def _speed_ratio(self, frequency: ArrayLike) -> Array:
        """c/c0 of the first mode at frequencies in Hz, of their shape.

        It is the lowest root of the frequency equation. Long work shows its progress.
        """
        f = array("frequency", frequency, "Hz", "non-negative")
        W = 2 * math.pi * f * self.radius / self.wave_speed  # omega a/c0
        poisson_ratios = np.full(f.shape, self.poisson_ratio)
        return _lowest_speed_ratios(_wavenumber_of_frequency, W, poisson_ratios)

    def _scaled_frequency(self, G: Array) -> Any:
        """omega a/c0 of the first mode at dimensionless wave numbers G.

        G is k a = 2 pi a/l.
        """
        radius_over_wavelength = G / (2 * math.pi)
        return G * first_mode(radius_over_wavelength, self.poisson_ratio)


@explain_arguments
def first_mode(
    radius_over_wavelength: ArrayLike,
    poisson_ratio: ArrayLike,
    *,
    progress: bool | ProgressFunction = True,
) -> Number:
    """Phase velocity of the first mode over that of long waves, c/c0.

    The phase velocity is the lowest root of the equation at the head of this module.

    Parameters
    ----------
    radius_over_wavelength : float or array
        a/l, 0 or more.
    poisson_ratio : float or array
        nu, from 0 to 0.5.
    progress : bool or function
        Whether a progress bar may be shown during long work. A function is called with
        the number of completed values and the number of all values.

    Returns
    -------
    float or array
        c/c0, of the broadcast shape of the arguments.

    Raises
    ------
    ValueError
        If an argument is out of its range.

    Examples
    --------
    >>> first_mode([0.0, 0.1, 0.3], 0.29).round(5).tolist()
    [1.0, 0.99113, 0.87299]
    """
    ratio, nu = broadcast_arguments(
        radius_over_wavelength=(radius_over_wavelength, "", "non-negative"),
        poisson_ratio=(poisson_ratio, "", "[0, 0.5]"),
    )
    problems: Problems = []
    check_progress(problems, progress)
    raise_if_problems(problems)
    # Beyond this limit the speed no longer changes; larger numbers would overflow.
    ratio = np.minimum(ratio, MAX_RADIUS_OVER_WAVELENGTH)
    G = 2 * math.pi * ratio
    speeds = _lowest_speed_ratios(_same_wavenumber, G, nu, progress)
    return float_or_array(speeds)


@explain_arguments
def mindlin_herrmann(
    radius_over_wavelength: ArrayLike, poisson_ratio: ArrayLike
) -> tuple[Number, Number]:
    """Phase velocities of both branches by Mindlin and Herrmann, c/c0.

    The squares x = c^2/c0^2 are the roots of a quadratic equation, with G = 2 pi a/l
    and the moduli of the theory divided by E::

        (x - axial) (x - shear/m - 2 radial/(m G^2)) = 2 coupling^2/(m G^2)

    The slow branch approximates `first_mode`. The fast branch starts at a cut-off
    frequency; its motion is mostly radial. See `rodimpact.model.lateral_inertia` for
    the theory and its source.

    Parameters
    ----------
    radius_over_wavelength : float or array
        a/l, 0 or more.
    poisson_ratio : float or array
        nu, above -1 and below 0.5.

    Returns
    -------
    slow, fast : float or array
        c/c0, of the broadcast shape of the arguments. The fast branch is infinite for
        long waves.

    Raises
    ------
    ValueError
        If an argument is out of its range.

    Examples
    --------
    >>> slow, fast = mindlin_herrmann([0.0, 0.1, 0.3], 0.29)
    >>> slow.round(5).tolist(), fast.round(5).tolist()
    ([1.0, 0.98863, 0.87005], [inf, 3.47427, 1.42475])
    """
    ratio, nu = broadcast_arguments(
        radius_over_wavelength=(radius_over_wavelength, "", "non-negative"),
        poisson_ratio=(poisson_ratio, "", "(-1, 0.5)"),
    )
    moduli = radial_moduli(1.0, nu)
    shear = moduli.shear / INERTIA
    cut_off = 2 * moduli.radial / INERTIA  # square of omega a/c0 there
    with np.errstate(divide="ignore", over="ignore"):
        G_squared = (2 * math.pi * ratio) ** 2
        # The quadratic equation is multiplied by short = G^2/(1 + G^2), so that it is
        # finite for long waves and for short ones.
        long = 1 / (1 + G_squared)  # short/G^2
        short = 1 / (1 + 1 / G_squared)
        # It is short x^2 - root_sum x + root_product = 0; moduli are over E, so that
        # axial radial - coupling^2 is radial.
        root_sum = (moduli.axial + shear) * short + cut_off * long
        root_product = moduli.axial * shear * short + cut_off * long
        discriminant = root_sum * root_sum - 4 * root_product * short
        # The larger root times 2 short. The smaller root is root_product/short over the
        # larger one: no digits cancel.
        scaled_root = root_sum + np.sqrt(discriminant)
        slow = np.sqrt(2 * root_product / scaled_root)
        fast = np.sqrt(scaled_root / (2 * short))
    return float_or_array(slow), float_or_array(fast)


@explain_arguments
def rayleigh_speed(poisson_ratio: ArrayLike) -> Number:
    """Speed of surface waves over that of long waves in a bar, c/c0.

    The speed is the root c < c2 of
    (2 - c^2/c2^2)^2 = 4 sqrt(1 - c^2/c1^2) sqrt(1 - c^2/c2^2).

    Source: Lord Rayleigh, On waves propagated along the plane surface of an elastic
    solid, Proc. London Math. Soc. 17 (1885) 4.

    Parameters
    ----------
    poisson_ratio : float or array
        nu, from 0 to 0.5.

    Returns
    -------
    float or array
        c/c0, of the shape of `poisson_ratio`.

    Raises
    ------
    ValueError
        If a Poisson ratio is out of its range.

    Examples
    --------
    >>> round(rayleigh_speed(0.25), 6)  # sqrt(2 - 2/sqrt(3)) of the shear speed
    0.581481
    """
    nu = array("poisson_ratio", poisson_ratio, "", "[0, 0.5]")
    speeds = np.vectorize(_rayleigh_speed, otypes=[float])
    return float_or_array(speeds(nu))


def _rayleigh_speed(nu: float) -> float:
    """c/c0 of Rayleigh's surface waves for one Poisson ratio.

    With r = (c/c2)^2 and kappa = (c2/c1)^2, Rayleigh's equation squared and divided by
    r is r^3 - 8 r^2 + (24 - 16 kappa) r + 16 (kappa - 1) = 0.
    """
    kappa = (1 - 2 * nu) / (2 - 2 * nu)
    linear = 24.0 - 16.0 * kappa
    constant = 16.0 * (kappa - 1.0)

    def cubic(r: float) -> float:
        """Left-hand side of the equation."""
        return float(np.polyval([1.0, -8.0, linear, constant], r))

    r = brentq(cubic, a=0.5, b=1.0)  # 0.76 for nu = 0, 0.91 for nu = 0.5
    return math.sqrt(r / (2 + 2 * nu))  # (c2/c0)^2 = 1/(2 + 2 nu)


def _uniform_segment(rod: Any) -> Any:
    """The segment of a uniform `Rod`, or a uniform `Segment` itself.

    InvalidModel for any other argument: a rod of several segments, a taper, another
    object. The caller has dealt with a `waves.Bar`.
    """
    segments = [rod]
    if isinstance(rod, Rod):
        segments = list(rod.segments)
    segment = segments[0]
    if len(segments) == 1 and isinstance(segment, Segment) and not segment.tapered:
        return segment
    wanted = "must be a uniform Rod or Segment, or a waves.Bar"
    raise invalid_argument("bar", f"{wanted}, got {shown(rod)}")


def _same_wavenumber(G: Any, speed_ratio: Any) -> Any:  # noqa: ARG001
    """G of a wave that is given by G itself, whatever its speed."""
    return G


def _wavenumber_of_frequency(W: Any, speed_ratio: Any) -> Any:
    """G = 2 pi a/l of a wave that is given by W = omega a/c0 and has c/c0."""
    return W / speed_ratio


def _lowest_speed_ratios(
    wavenumber: WavenumberFunction,
    given_numbers: Array,
    poisson_ratios: Array,
    progress: bool | ProgressFunction = True,
) -> Array:
    """Lowest roots c/c0 of the equation of frequencies.

    Parameters
    ----------
    wavenumber : function
        Gives G of a wave from its given number and c/c0.
    given_numbers : array
        Numbers that describe the waves; the root of 0 is 1, as for long waves.
    poisson_ratios : array
        The same shape.
    progress : bool or function
        See `first_mode`; a report follows each block of `VALUES_PER_BLOCK` waves.

    Returns
    -------
    array
        The same shape.
    """
    numbers = given_numbers.ravel()
    nu = poisson_ratios.ravel()
    roots = np.ones(numbers.size)
    with Progress(progress, "first mode", "values") as report:
        for start in range(0, numbers.size, VALUES_PER_BLOCK):
            block = slice(start, start + VALUES_PER_BLOCK)
            roots[block] = _roots_of_block(wavenumber, numbers[block], nu[block])
            done = min(block.stop, numbers.size)
            report(done, numbers.size)
    return roots.reshape(given_numbers.shape)


def _roots_of_block(wavenumber: WavenumberFunction, numbers: Array, nu: Array) -> Array:
    """Lowest roots c/c0 of some waves, [wave], from their numbers and nu, [wave].

    `wavenumber` gives G from a number and c/c0. The equation is computed at equally
    spaced c/c0 from below the speed of surface waves to a little above 1. The first
    change of its sign brackets the root, and Brent's method finds it. Without a change,
    or for the number 0, the root is 1, as for long waves.
    """
    roots = np.ones(numbers.size)
    # All waves are faster than surface waves. The factor 0.9 puts the first speed well
    # below the root; `initial` is only used if there are no waves.
    slowest = 0.9 * np.min(rayleigh_speed(nu), initial=1.0)
    speeds = np.arange(slowest, 1.0 + 2 * SPEED_STEP, SPEED_STEP)
    G = wavenumber(numbers[:, None], speeds)  # [wave, speed]
    values = _equation(G, speeds, nu[:, None])
    signs = np.sign(values)
    has_changed = signs[:, 1:] != signs[:, :1]  # since the slowest speed
    first_change = has_changed.argmax(axis=1)  # index of the first True
    has_root = (numbers > 0) & has_changed.any(axis=1)
    for i in np.flatnonzero(has_root):
        low = speeds[first_change[i]]
        high = speeds[first_change[i] + 1]
        of_wave = (wavenumber, float(numbers[i]), float(nu[i]))
        roots[i] = brentq(_equation_of_wave, low, high, args=of_wave, xtol=ROOT_ATOL)
    return roots


def _equation_of_wave(
    speed_ratio: float, wavenumber: WavenumberFunction, number: float, nu: float
) -> Any:
    """Left-hand side of the equation of one wave at c/c0, for `brentq`.

    `number` describes the wave; with c/c0 it gives the dimensionless wave number G.
    """
    return _equation(wavenumber(number, speed_ratio), speed_ratio, nu)


def _equation(G: Any, speed_ratio: Any, nu: Any) -> Any:
    """Left-hand side of the equation of frequencies for G = 2 pi a/l and c/c0.

    The equation is in the docstring of this module. It is divided by G^4, so that A^2
    becomes A2 = (A/G)^2 = c^2/c1^2 - 1 and B^2 becomes B2 = c^2/c2^2 - 1. If A or B is
    imaginary, it is also divided by exp(abs(A)) or exp(abs(B)), the growth of the
    modified Bessel functions. So only its sign and its roots are those of the equation.
    """
    x2 = speed_ratio * speed_ratio
    A2 = x2 * (1 + nu) * (1 - 2 * nu) / (1 - nu) - 1
    B2 = x2 * (2 + 2 * nu) - 1
    # Here A and B are the absolute values. They are imaginary if A2 or B2 is negative.
    A = G * np.sqrt(np.abs(A2))
    B = G * np.sqrt(np.abs(B2))
    J0A, jA = _bessel(A, A2)  # J0(A) and j(A) = J1(A)/A
    J0B, jB = _bessel(B, B2)
    square = (B2 - 1) * (B2 - 1)
    of_both = 2 * A2 * (B2 + 1) * jA * jB
    of_dilatation = square * J0A * jB
    of_shear = 4 * A2 * jA * J0B
    return of_both - of_dilatation - of_shear


class _Bessel(NamedTuple):
    """Bessel functions J at x, or modified ones I at x, divided by exp(x)."""

    order_0: Any  # J0(x) or I0(x)
    order_1_over_x: Any  # J1(x)/x or I1(x)/x


def _bessel(x: Any, square: Any) -> _Bessel:
    """Bessel functions J0(x) and J1(x)/x, or modified ones if `square` is negative.

    `square` has the sign of the square of the argument, whose absolute value is x. If
    it is negative, the argument is imaginary, and the functions are I0(x) and I1(x)/x,
    divided by exp(x). Only the sign of `square` is used.
    """
    is_imaginary = square < 0
    is_small = x < SERIES_LIMIT
    divisor = np.where(is_small, 1.0, x)  # 1.0: any number that divides without error
    first_order = np.where(is_imaginary, i1e(divisor), j1(divisor))
    order_0 = np.where(is_imaginary, i0e(x), j0(x))
    order_1_over_x = np.where(is_small, 0.5, first_order / divisor)  # the limit is 1/2
    return _Bessel(order_0, order_1_over_x)


@lru_cache(maxsize=64)
def _slowness_curve(poisson_ratio: float) -> Any:
    """Curve of c0/c - 1 over f a/c0, up to the cut-off: a function of arrays.

    It is a cubic spline through exact values of a bar of unit wave speed and radius.
    """
    frequencies = np.linspace(0.0, CUT_OFF, SLOWNESS_KNOTS)
    unit_bar = Bar(wave_speed=1.0, poisson_ratio=poisson_ratio, radius=1.0)
    speed_ratios = unit_bar._speed_ratio(frequencies)
    return CubicSpline(frequencies, 1 / speed_ratios - 1)
