"""Theories of the lateral motion of a rod in which waves run, and their constants.

A wave that stretches a rod makes it thinner, and the lateral motion has inertia. Both
theories let a point at the distance r from the axis move by q(x, t) r. A is the area of
the cross-section, I_p its polar second moment, and w = q a the radial displacement at
the surface of a round rod of radius a.

- "rayleigh-love": q = -nu u_x, as in slow stretching, and
  rho A u_tt - rho nu^2 I_p u_xxtt = E A u_xx. Its waves are exact if they are long, 1 %
  too fast at a wavelength of 5 radii and 7 % at one of 3.3.
- "mindlin-herrmann": q has an equation of its own, with inertia, shear between
  neighbouring cross-sections and stiffness::

      rho A u_tt = [(lambda + 2 mu) A u_x + 2 lambda A q]_x
      m rho I_p q_tt = [s mu I_p q_x]_x - 4 (lambda + mu) A q - 2 lambda A u_x

  With m = 1.62 and s = 0.81 its waves stay within 0.01 c of the exact ones of a round
  rod down to wavelengths of 1.7 radii, but the dispersion of long waves is 31 % too
  large. This theory is the better one up to some 60 diameters from the impact; beyond
  take `Signal.propagated`.

At the ends of rods and at rigid masses the lateral motion is free, whatever holds,
touches or pushes the end: no shear, q_x = 0. At a step, q and the shear force are
continuous, since points common to both sections move alike; no energy is lost there. A
rod starts without lateral velocity, at q = -nu u_x, also if its state is that of a
solution at some time. Viscosity resists the rate of u_x, not that of q. The stress is E
u_x, without the part of the lateral motion.

On a grid the time steps are a little shorter for Mindlin and Herrmann, since the
fastest waves run at sqrt((lambda + 2 mu)/rho); with cells longer than a the steps stay
below about a/c.

Source: A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed.,
1927, art. 278; Lord Rayleigh, The Theory of Sound, art. 157; R. D. Mindlin and G.
Herrmann, A one-dimensional theory of compressional waves in an elastic rod, Proc. 1st
US National Congress of Applied Mechanics (1951) 187.
"""

from typing import Any, NamedTuple

RAYLEIGH_LOVE = "rayleigh-love"
MINDLIN_HERRMANN = "mindlin-herrmann"
THEORIES = (RAYLEIGH_LOVE, MINDLIN_HERRMANN)
INERTIA = 1.62
"""m of Mindlin and Herrmann, the correction of the lateral inertia."""
SHEAR = 0.81
"""s of Mindlin and Herrmann, the correction of the shear stiffness."""


class RadialModuli(NamedTuple):
    """Moduli of the theory of Mindlin and Herrmann, Pa: the factors of u_x and q."""

    axial: Any  # lambda + 2 mu
    coupling: Any  # 2 lambda
    radial: Any  # 4 (lambda + mu)
    shear: Any  # s mu


def radial_moduli(youngs_modulus: Any, poisson_ratio: Any) -> RadialModuli:
    """Moduli of the theory of Mindlin and Herrmann from E and nu.

    With lambda = E nu/((1 + nu) (1 - 2 nu)) and mu = E/(2 (1 + nu)): radial is
    4 (lambda + mu) = 2 E/((1 + nu) (1 - 2 nu)), coupling is 2 lambda = nu radial, axial
    is lambda + 2 mu = E + nu^2 radial, and shear is `SHEAR` mu.

    Parameters
    ----------
    youngs_modulus : float or array
        E, Pa.
    poisson_ratio : float or array
        nu, below 0.5; it is not checked.

    Returns
    -------
    RadialModuli
        Pa, each of the broadcast shape of E and nu.

    Examples
    --------
    >>> radial_moduli(1.0, 0.25)
    RadialModuli(axial=1.2, coupling=0.8, radial=3.2, shear=0.324)
    """
    E = youngs_modulus
    nu = poisson_ratio
    radial = 2 * E / ((1 + nu) * (1 - 2 * nu))
    return RadialModuli(
        axial=E + nu * nu * radial,
        coupling=nu * radial,
        radial=radial,
        shear=SHEAR * E / (2 + 2 * nu),
    )
