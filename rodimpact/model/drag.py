"""Drag along a rod in proportion to its velocity, as on a pump rod in a fluid.

Waves in a rod with drag follow the telegraph equation,

    rho A v_t = (E A u_x)_x - d v,     d the drag coefficient per length,

as S. G. Gibbs uses it for pump rods (Predicting the behavior of sucker-rod pumping
systems, J. Petroleum Technology 15 (1963) 769-778), where d/(rho A) is the damping c in
1/s.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from . import frozen
from .frozen import FrozenDataclass, Number, Problems, QuantityField, quantity
from .profiles import Floats, Profile
from .shaft_profiles import checked_along, is_profile, spread

COEFFICIENT_PER_LENGTH = QuantityField("N s/m^2", "non-negative", along="length")
"""Drag coefficient that varies along the rod."""


class Drag(FrozenDataclass, kind="drag"):
    """Drag that resists the motion of a rod in proportion to its velocity.

    The force on the rod per length is -d v, with the drag coefficient d and the
    velocity v of the rod, positive to the right. The fluid is at rest. Free motion
    decays as exp(-d t/(rho A)), and the amplitude of a wave decays at half of this
    rate.

    Parameters
    ----------
    coefficient : float, array, Steps, Samples or function
        Drag coefficient. A number is the coefficient of the whole rod, N s/m,
        distributed uniformly. A profile or function is the coefficient per length, N
        s/m^2, at the distance from the left end, m.

    Raises
    ------
    InvalidModel
        If the coefficient is not what it should be.

    Examples
    --------
    A rod of 2 kg slows down by half in 0.1 s:

    >>> import math
    >>> import rodimpact as ri
    >>> steel = ri.Material("steel", youngs_modulus=200e9, density=8000.0)
    >>> drag = ri.Drag(2.0 * math.log(2) / 0.1)
    >>> rod = ri.Rod(2.5, area=1e-4, material=steel, velocity=1.0, shaft=drag)
    >>> run = ri.solve(ri.System([rod]), until=0.1, cells=10)
    >>> round(float(run.mean_velocity(0, 0.1)), 6)
    0.5
    """

    coefficient: Profile = quantity(
        "N s/m", "non-negative", "drag coefficient", along="length"
    )

    def _check(self, problems: Problems) -> None:
        """Check and set a coefficient that is a number or an array of a family.

        A profile or a function is not checked here: `drag_along_rod` checks it when the
        rod is made.
        """
        value = self.coefficient
        if not is_profile(value):
            field = self.fields["coefficient"]
            checked = field.checked(problems, "coefficient", value)
            self._set(coefficient=checked)


def drag_along_rod(drag: Drag, length: Number | None) -> Drag:
    """Drag whose profile is checked along a rod of this length, m, and sampled.

    A function becomes `Samples`; a number is kept. The length is None if it is unknown.

    Raises
    ------
    InvalidModel
        If the profile goes beyond the rod, or has values that it cannot have.
    """
    problems: Problems = []
    coefficient = checked_along(
        problems, "coefficient", drag.coefficient, COEFFICIENT_PER_LENGTH, length
    )
    frozen.raise_if_problems(problems)
    return drag.replace(coefficient=coefficient)


def coefficients(drag: Drag, edges: Any, length: float) -> Floats:
    """Drag coefficient of each stretch between neighbouring places, N s/m, shape (n,).

    Parameters
    ----------
    drag : Drag
    edges : [n + 1] array
        Increasing distances from the left end, m.
    length : float
        Length of the rod, m.
    """
    return np.asarray(spread(drag.coefficient, edges, length))
