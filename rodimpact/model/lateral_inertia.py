"""Theories of the motion sideways that goes with waves along a rod, and the constants of one.

A wave that stretches a rod makes it thinner, and what moves sideways has inertia. Both theories let
a point at the distance r from the axis move by q(x, t) r; A is the cross-section, I_p its polar
second moment, and w = q a at the surface of a round rod of radius a.

- "rayleigh-love": q = -nu u_x, as if stretched slowly; rho A u_tt - rho nu^2 I_p u_xxtt = E A u_xx.
  Exact for long waves, 1 % too fast at a wavelength of 5 radii and 7 % at one of 3.3.
- "mindlin-herrmann": q moves by itself, with inertia, shear between neighbours and stiffness::

      rho A u_tt = [(lambda + 2 mu) A u_x + 2 lambda A q]_x
      m rho I_p q_tt = [s mu I_p q_x]_x - 4 (lambda + mu) A q - 2 lambda A u_x

  With m = 1.62 and s = 0.81 its waves stay within 0.01 c of the exact ones of a round rod down to
  wavelengths of 1.7 radii. But long ones disperse by 31 % too much. So this theory is the better
  one up to some 60 diameters from the impact; beyond take `Signal.propagated`.

At ends of rods, whatever holds, touches or pushes them, and at rigid masses the motion sideways is
free: no shear, q_x = 0. Where segments meet, q and the shear force are continuous, since points
common to both sections move alike; so no energy is lost there. A rod starts without sideways
motion, at q = -nu u_x, also where its state is that of a solution at some time. Viscosity resists
the rate of u_x, not that of q; and stress is E u_x, without what moves the rod sideways.

On a grid time steps are a little shorter for Mindlin and Herrmann, since the fastest waves run at
sqrt((lambda + 2 mu)/rho); with cells longer than a they stay below about a/c.

Source: A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed., 1927, art. 278;
Lord Rayleigh, The Theory of Sound, art. 157; R. D. Mindlin and G. Herrmann, A one-dimensional
theory of compressional waves in an elastic rod, Proc. 1st US National Congress of Applied Mechanics
(1951) 187.
"""

from typing import Any, NamedTuple

RAYLEIGH_LOVE, MINDLIN_HERRMANN = THEORIES = "rayleigh-love", "mindlin-herrmann"
INERTIA, SHEAR = 1.62, 0.81  # m and s


class RadialModuli(NamedTuple):
    """Of the theory of Mindlin and Herrmann, Pa: what multiplies u_x and q in the equations."""

    axial: Any  # lambda + 2 mu
    coupling: Any  # 2 lambda
    radial: Any  # 4 (lambda + mu)
    shear: Any  # s mu


def radial_moduli(youngs_modulus: Any, poisson_ratio: Any) -> RadialModuli:
    """Return these moduli for a Young's modulus in Pa and a Poisson ratio below 0.5."""
    E, nu = youngs_modulus, poisson_ratio
    radial = 2 * E / ((1 + nu) * (1 - 2 * nu))
    return RadialModuli(
        E + nu * nu * radial, nu * radial, radial, SHEAR * E / (2 + 2 * nu)
    )
