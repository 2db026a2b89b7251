"""Waves in round bars as they are: the exact first mode of Pochhammer (1876) and Chree (1889).

A bar of radius a carries a wave of wavelength l at the phase velocity c; below, G = 2 pi a/l::

    2 A^2 (B^2 + G^2) j(A) j(B) - (B^2 - G^2)^2 J0(A) j(B) - 4 G^2 A^2 j(A) J0(B) = 0
    A^2 = G^2 (c^2/c1^2 - 1),  B^2 = G^2 (c^2/c2^2 - 1),  j(x) = J1(x)/x

with the dilatational and the shear speed c1 and c2. This is the equation as K. F. Graff has it,
Wave Motion in Elastic Solids, divided by A B, so that c = c1 and c = c2 solve it no more; where A
or B is imaginary, J becomes I. Long waves run at c0 = sqrt(E/rho), c/c0 = 1 - nu^2 G^2/4, short
ones at the speed of Rayleigh's surface waves. `mindlin_herrmann` is an approximation to it.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.special import i0e, i1e, j0, j1

from .model.arguments import (
    Array,
    Number,
    array,
    broadcast_arguments,
    demand,
    float_or_array,
)
from .model.bodies import Rod, Segment
from .model.frozen import Declared, Problems, quantity, raise_noted, refusal
from .model.lateral_inertia import INERTIA, radial_moduli
from .progress import Progress, ProgressFunction, check_progress
from .units import shown

CUT_OFF = 0.2619
"""f a/c0 beyond which the first mode alone does not describe a bar, at a wavelength of some
a/0.3: A. Tyas and D. J. Pope, Measurement Science and Technology 16 (2005) 642."""
SCAN = 2.0**-7  # of c0: between the speeds at which the lowest root is looked for
SHORTEST = (
    1e15  # a/l from which on waves run at the speed of surface waves, to the last digit
)
BLOCK = 128  # values at a time, so that memory is bounded and progress is heard of
KNOTS = 257  # of the curve of wave numbers up to the cut-off


class Bar(Declared):
    """What of a round bar decides how pulses change their shape along it.

    Parameters
    ----------
    wave_speed : float
        c0 = sqrt(E/rho) of long waves, m/s.
    poisson_ratio : float
        nu, from 0 to 0.5.
    radius : float
        m; for a section that is not round the equivalent radius that you choose.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    A steel bar of 20 mm: waves of 100 kHz are a good 4 % slower than long ones.

    >>> bar = Bar(wave_speed=5189.0, poisson_ratio=0.29, radius=0.01)
    >>> bar.phase_velocity([0.0, 100e3]).round().tolist()
    [5189.0, 4958.0]
    """

    wave_speed: float = quantity("m/s", "positive", single=True)
    poisson_ratio: float = quantity("", "[0, 0.5]", single=True)
    radius: float = quantity("m", "positive", single=True)

    @classmethod
    def of(cls, rod: Rod | Segment, radius: float | None = None) -> Bar:
        """Bar of a rod.

        Parameters
        ----------
        rod : Rod or Segment
            Uniform, of a material with a `poisson_ratio`, and given by its diameter, unless a
            radius is given.
        radius : float, optional
            Equivalent radius of a section that is not round, m.

        Raises
        ------
        InvalidModel
            If the rod has no single section, its section is not said to be round, or its material
            has no Poisson ratio.

        Examples
        --------
        >>> import rodimpact as ri
        >>> rod = ri.Rod(1.0, diameter=0.02, material=ri.materials.steel)
        >>> round(Bar.of(rod).radius, 12)
        0.01
        """
        pieces: Any = rod.segments if isinstance(rod, Rod) else [rod]
        if len(pieces) != 1 or not isinstance(pieces[0], Segment) or pieces[0].tapered:
            message = (
                f"must be a uniform Rod or Segment, or a waves.Bar, got {shown(rod)}"
            )
            raise refusal("bar", message)
        (piece,) = pieces
        material = piece.material
        if material.poisson_ratio is None:
            message = f"is missing in {shown(material.name)}; dispersion needs it"
            raise refusal("bar.material.poisson_ratio", message)
        if radius is None and not piece.solid_round:
            message = "is not said to be round; give the rod its diameter in place of the area, or "
            message += "radius=, the equivalent radius in m"
            raise refusal("bar.section", message)
        a = np.sqrt(piece.area / math.pi) if radius is None else radius
        return cls(material.wave_speed, material.poisson_ratio, a)

    def phase_velocity(self, frequency: ArrayLike) -> Number:
        """Phase velocity c of the first mode.

        Parameters
        ----------
        frequency : float or array
            Hz, 0 or more.

        Returns
        -------
        float or array
            m/s.

        Raises
        ------
        ValueError
            If a frequency is negative or not finite.
        """
        return float_or_array(self.wave_speed * self._ratio(frequency))

    def group_velocity(self, frequency: ArrayLike) -> Number:
        """Group velocity d(omega)/dk of the first mode; as `phase_velocity`.

        Examples
        --------
        >>> bar = Bar(wave_speed=5000.0, poisson_ratio=0.3, radius=0.01)
        >>> bar.group_velocity([0.0, 150e3]).round().tolist()
        [5000.0, 1975.0]
        """
        c = self._ratio(frequency)
        G = (
            2
            * math.pi
            * self.radius
            / self.wave_speed
            * array("frequency", frequency, "Hz")
            / c
        )
        h = (
            2.0**-13
        )  # the quotient of differences is off by its square, and by round-off over it
        up, down = (
            G * f * first_mode(G * f / (2 * math.pi), self.poisson_ratio)
            for f in (1 + h, 1 - h)
        )
        slope = np.divide(
            up - down, 2 * h * G, out=np.ones(np.shape(G)), where=np.asarray(G) > 0
        )
        return float_or_array(self.wave_speed * slope)

    def wavenumber(self, frequency: ArrayLike) -> Number:
        """Wave number k = omega/c of the first mode, rad/m; as `phase_velocity`."""
        f = array("frequency", frequency, "Hz")
        return float_or_array(2 * math.pi * f / self.wave_speed / self._ratio(f))

    @property
    def cut_off(self) -> float:
        """Frequency above which the first mode alone does not describe the bar, Hz."""
        return CUT_OFF * self.wave_speed / self.radius

    def delays(self, frequency: ArrayLike) -> Number:
        """Seconds a metre by which waves are later than long ones, 1/c - 1/c0.

        From a curve through exact values, for the many frequencies of a record.

        Parameters
        ----------
        frequency : float or array
            From 0 to the cut-off, Hz.

        Returns
        -------
        float or array
            s/m.

        Raises
        ------
        ValueError
            If a frequency is out of this range.
        """
        f = array("frequency", frequency, "Hz")
        room = self.cut_off * (1 + 1e-12)
        message = f"must be from 0 to {self.cut_off!r} Hz, got {{0!r}}"
        demand((f >= 0) & (f <= room), "frequency", message, f)
        lag = _slowness(self.poisson_ratio)(f * self.radius / self.wave_speed)
        return float_or_array(lag / self.wave_speed)

    def _ratio(self, frequency: ArrayLike) -> Array:
        f = array("frequency", frequency, "Hz", "non-negative")
        W = 2 * math.pi * f * self.radius / self.wave_speed
        return _each(lambda w, x: w / x, W, np.full(f.shape, self.poisson_ratio))


def first_mode(
    radius_over_wavelength: ArrayLike,
    poisson_ratio: ArrayLike,
    *,
    progress: bool | ProgressFunction = True,
) -> Number:
    """Phase velocity of the first mode over that of long waves, c/c0.

    Parameters
    ----------
    radius_over_wavelength : float or array
        0 or more, 1.
    poisson_ratio : float or array
        From 0 to 0.5, 1.
    progress : bool or function
        Whether a bar may show how far long work is. A function is called with the values that are
        done, and how many there are.

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
    s, nu = broadcast_arguments(
        radius_over_wavelength=(radius_over_wavelength, "", "non-negative"),
        poisson_ratio=(poisson_ratio, "", "[0, 0.5]"),
    )
    problems: Problems = []
    check_progress(problems, progress)
    raise_noted(problems)
    return float_or_array(
        _each(lambda g, _: g, 2 * math.pi * np.minimum(s, SHORTEST), nu, progress)
    )


def mindlin_herrmann(
    radius_over_wavelength: ArrayLike, poisson_ratio: ArrayLike
) -> tuple[Number, Number]:
    """Phase velocities of both branches by Mindlin and Herrmann over that of long waves, c/c0.

    The roots x = c^2/c0^2 of a quadratic equation, with the moduli of the theory over E and
    G = 2 pi a/l::

        (x - axial) (x - shear/m - 2 radial/(m G^2)) = 2 coupling^2/(m G^2)

    The slow branch stands for `first_mode`; along the fast one, which starts at a cut-off
    frequency, mostly the radius swings. See `rodimpact.model.lateral_inertia` for the theory.

    Parameters
    ----------
    radius_over_wavelength : float or array
        0 or more, 1.
    poisson_ratio : float or array
        Above -1 and below 0.5, 1.

    Returns
    -------
    slow, fast : float or array
        c/c0, of the broadcast shape of the arguments; the fast one is infinite for long waves.

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
    s, nu = broadcast_arguments(
        radius_over_wavelength=(radius_over_wavelength, "", "non-negative"),
        poisson_ratio=(poisson_ratio, "", "(-1, 0.5)"),
    )
    moduli = radial_moduli(1.0, nu)
    slowest, cut_off = moduli.shear / INERTIA, 2 * moduli.radial / INERTIA
    with np.errstate(divide="ignore", over="ignore"):
        square = (2 * math.pi * s) ** 2
        long, short = 1 / (1 + square), 1 / (1 + 1 / square)  # the equation times short
        both = (moduli.axial + slowest) * short + cut_off * long
        product = moduli.axial * slowest * short + cut_off * long
        larger = both + np.sqrt(both * both - 4 * product * short)
        return float_or_array(np.sqrt(2 * product / larger)), float_or_array(
            np.sqrt(larger / (2 * short))
        )


def rayleigh_speed(poisson_ratio: ArrayLike) -> Number:
    """Speed of surface waves over that of long waves in a bar, c/c0.

    The root c < c2 of (2 - c^2/c2^2)^2 = 4 sqrt(1 - c^2/c1^2) sqrt(1 - c^2/c2^2).

    Parameters
    ----------
    poisson_ratio : float or array
        From 0 to 0.5, 1.

    Examples
    --------
    >>> round(rayleigh_speed(0.25), 6)  # sqrt(2 - 2/sqrt(3)) of the shear speed
    0.581481
    """
    nu = array("poisson_ratio", poisson_ratio, "", "[0, 0.5]")

    def root(v: float) -> float:
        kappa = (1 - 2 * v) / (2 - 2 * v)  # (c2/c1)^2
        # in r = (c/c2)^2, squared and divided by r
        cubic = [1.0, -8.0, 24.0 - 16.0 * kappa, 16.0 * (kappa - 1.0)]
        r = brentq(lambda x: float(np.polyval(cubic, x)), 0.5, 1.0)
        return math.sqrt(r / (2 + 2 * v))

    return float_or_array(np.vectorize(root, otypes=[float])(nu))


def _each(
    wave: Any,
    given: Array,
    poisson_ratio: Array,
    progress: bool | ProgressFunction = True,
) -> Array:
    """Lowest roots x = c/c0 of the equation, where G is `wave` of what is given and of x."""
    known = given.ravel()
    nu = poisson_ratio.ravel()
    roots = np.ones(given.size)
    with Progress(progress, "first mode", "values") as report:
        for start in range(0, known.size, BLOCK):
            part = slice(start, start + BLOCK)
            roots[part] = _roots(wave, known[part], nu[part])
            report(min(start + BLOCK, known.size), known.size)
    return roots.reshape(given.shape)


def _roots(wave: Any, known: Array, nu: Array) -> Array:
    """Roots of some values."""
    roots = np.ones(known.size)
    least = 0.9 * np.min(rayleigh_speed(nu), initial=1.0)
    grid = np.arange(least, 1.0 + 2 * SCAN, SCAN)
    sign = np.sign(_equation(wave(known[:, None], grid), grid, nu[:, None]))
    turns = sign[:, 1:] != sign[:, :1]
    first = turns.argmax(axis=1)
    for i in np.flatnonzero((known > 0) & turns.any(axis=1)):
        g, v, ends = float(known[i]), float(nu[i]), grid[first[i] : first[i] + 2]
        roots[i] = brentq(
            lambda x, g=g, v=v: _equation(wave(g, x), x, v), *ends, xtol=1e-15
        )
    return roots


def _equation(G: Any, x: Any, nu: Any) -> Any:
    """Left-hand side of the equation at c = x c0, over G^4 and the growth of the I functions."""
    A2 = x * x * (1 + nu) * (1 - 2 * nu) / (1 - nu) - 1  # over G^2
    B2 = x * x * (2 + 2 * nu) - 1
    A, B = G * np.sqrt(np.abs(A2)), G * np.sqrt(np.abs(B2))
    J0A, jA = _bessel(A, A2)
    J0B, jB = _bessel(B, B2)
    square = (B2 - 1) * (B2 - 1)
    return 2 * A2 * (B2 + 1) * jA * jB - square * J0A * jB - 4 * A2 * jA * J0B


def _bessel(x: Any, sign: Any) -> tuple[Any, Any]:
    """J0 and J1/x of a real argument, or the scaled I0 and I1/x where `sign` is negative."""
    imaginary = sign < 0
    small = x < 1e-8
    y = np.where(small, 1.0, x)
    over = np.where(imaginary, i1e(y), j1(y)) / y
    return np.where(imaginary, i0e(x), j0(x)), np.where(small, 0.5, over)


@lru_cache(maxsize=64)
def _slowness(poisson_ratio: float) -> Any:
    """Curve of c0/c - 1 over f a/c0, up to the cut-off."""
    knots = np.linspace(0.0, CUT_OFF, KNOTS)
    return CubicSpline(knots, 1 / Bar(1.0, poisson_ratio, 1.0)._ratio(knots) - 1)
