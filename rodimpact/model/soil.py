"""Soil along the shaft of a rod: a pile, a mandrel, an anchor.

The soil resists by its static resistance R and a damping. R is elastic up to the quake,
then the soil yields, and it unloads as stiffly as it was loaded (E. A. L. Smith,
Pile-driving analysis by the wave equation, J. Soil Mech. Found. Div. ASCE 86 (1960)
35-61).
"""

from __future__ import annotations

from typing import Any

from . import frozen, profiles
from .frozen import (
    FrozenDataclass,
    Number,
    Numeric,
    Problems,
    QuantityField,
    add_problem,
    quantity,
)
from .profiles import Floats, Profile
from .shaft_profiles import PROFILES, checked_along, is_profile, spread

SMITH = "smith"
VISCOUS = "viscous"
DAMPING_LAWS = (SMITH, VISCOUS)
"""Damping laws of soil.

The damping force is proportional to the present static resistance (`SMITH`), or to the
ultimate resistance (`VISCOUS`).
"""
RESISTANCE_PER_LENGTH = QuantityField("N/m", "non-negative", along="length")
"""Resistance that varies along the rod."""


class Soil(FrozenDataclass, kind="soil"):
    """Soil that resists the motion of a rod along its shaft.

    The force on the rod is -(R + J abs(R) v) by the law ``"smith"`` and -(R + J R_u v)
    by ``"viscous"``, with the velocity v of the rod, positive to the right. Both
    dampings oppose the motion. While the soil is elastic, the static resistance is R =
    k u, with the stiffness k = R_u/q and the displacement u of the rod. The soil yields
    at R = R_u and at R = -R_u, and unloads with the slope k. The soil around the rod is
    at rest.

    Parameters
    ----------
    resistance : float, array, Steps, Samples or function
        Ultimate resistance R_u. A number is the resistance of the whole rod, N,
        distributed uniformly. A profile or function is the resistance per length, N/m,
        at the distance from the left end, m.
    quake : float or array
        Displacement q at which the soil yields, m.
    damping : float or array, optional
        J, s/m.
    law : "smith" or "viscous", optional
        ``"smith"``: the damping force is proportional to the present static resistance
        R. ``"viscous"``: it is proportional to the ultimate resistance R_u.
    mobilised : float, array, Steps, Samples or function, optional
        Mobilised share R/R_u of the resistance at t = 0, from -1 to 1; positive if the
        soil pushes the rod to the left.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    A pile that is pushed into soil of 400 kN comes to rest:

    >>> import rodimpact as ri
    >>> soil = ri.Soil(resistance=400e3, quake=2.5e-3, damping=0.16)
    >>> steel = ri.materials.steel
    >>> pile = ri.Rod(15.0, area=0.0094, material=steel, velocity=2.0, shaft=soil)
    >>> run = ri.solve(ri.System([pile]), until=30e-3)
    >>> bool(run.mean_velocity(0, 0.0) > 1.9 and abs(run.mean_velocity(0, 30e-3)) < 0.3)
    True
    """

    resistance: Profile = quantity("N", "non-negative", along="length")
    quake: Numeric = quantity("m", "positive")
    damping: Numeric = quantity("s/m", "non-negative", default=0.0)
    law: str = SMITH
    mobilised: Profile = quantity("", "[-1, 1]", along="length", default=0.0)

    def _check(self, problems: Problems) -> None:
        """Check the word of the law; check and set the resistance and mobilised share.

        Profiles of these two are not checked here: `soil_along_rod` checks them when
        the rod is made.
        """
        law: Any = self.law
        if not isinstance(law, str) or law not in DAMPING_LAWS:
            add_problem(problems, "law", 'must be "smith" or "viscous"', law)
        for name in ("resistance", "mobilised"):
            value = getattr(self, name)
            if not is_profile(value):
                checked = self.fields[name].checked(problems, name, value)
                self._set(**{name: checked})


def soil_along_rod(soil: Soil, length: Number | None) -> Soil:
    """Soil whose profiles are checked along a rod of this length, m, and sampled.

    Functions become `Samples`; numbers are kept. The length is None if it is unknown.

    Raises
    ------
    InvalidModel
        If a profile goes beyond the rod, or has values that it cannot have.
    """
    problems: Problems = []
    resistance = checked_along(
        problems, "resistance", soil.resistance, RESISTANCE_PER_LENGTH, length
    )
    mobilised = checked_along(
        problems, "mobilised", soil.mobilised, soil.fields["mobilised"], length
    )
    frozen.raise_if_problems(problems)
    return soil.replace(resistance=resistance, mobilised=mobilised)


def resistances(soil: Soil, edges: Any, length: float) -> Floats:
    """Ultimate resistance of each stretch between neighbouring places, N, shape (n,).

    Parameters
    ----------
    soil : Soil
    edges : [n + 1] array
        Increasing distances from the left end, m.
    length : float
        Length of the rod, m.
    """
    return spread(soil.resistance, edges, length)


def mobilised_shares(soil: Soil, edges: Any, length: float) -> Floats:
    """Mean share R/R_u at t = 0 between neighbouring places of a rod, shape (n,).

    The arguments are those of `resistances`.
    """
    return profiles.averages(soil.mobilised, edges, length)


def largest_stiffness(soil: Soil, length: float) -> float:
    """Largest stiffness R_u/q per length along a rod of this length, m, in N/m^2.

    R_u is the resistance per length, q the quake. It is 0 if the soil has no
    resistance. The numbers are those of a single rod.
    """
    largest: Any  # resistance per length, N/m
    if isinstance(soil.resistance, PROFILES):
        _, largest = profiles.extremes(soil.resistance)
    else:  # a number is the resistance of the whole rod
        largest = soil.resistance / length
    return float(largest / soil.quake)
