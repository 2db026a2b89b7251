"""A specimen between two bars."""

import math
from dataclasses import KW_ONLY

from ..model.arguments import check_flag
from ..model.frozen import FrozenDataclass, Problems, quantity


class Specimen(FrozenDataclass):
    """A specimen between two bars.

    Parameters
    ----------
    length : float
        Length L0 before the shot, m.
    area, diameter : float
        Cross-sectional area A0, m^2, or diameter of a round specimen, m; one of both.
    youngs_modulus : float, optional
        Modulus of the initial elastic part, Pa; `reduce` can align the waves with it.
    wave_speed : float, optional
        Speed of waves in the specimen, m/s. If equal forces on both faces are assumed,
        this gives an estimate of the time until they are equal.
    incompressible : bool
        Whether the volume of the specimen is constant; true stress and strain need
        this.

    Raises
    ------
    InvalidModel
        If an argument is invalid; the error names every invalid argument.

    Examples
    --------
    >>> copper = Specimen(length=3.2e-3, diameter=6.34e-3, incompressible=True)
    >>> round(copper.section * 1e6, 2)
    31.57
    """

    length: float = quantity("m", "positive", scalar=True)
    _: KW_ONLY
    area: float | None = quantity("m^2", "positive", default=None, scalar=True)
    diameter: float | None = quantity("m", "positive", default=None, scalar=True)
    youngs_modulus: float | None = quantity("Pa", "positive", default=None, scalar=True)
    wave_speed: float | None = quantity("m/s", "positive", default=None, scalar=True)
    incompressible: bool = False

    def _check(self, problems: Problems) -> None:
        if (self.area is None) == (self.diameter is None):
            problems.append(("area", "give either area or diameter"))
        check_flag("incompressible", self.incompressible)

    @property
    def section(self) -> float:
        """Cross-sectional area A0 before the shot, m^2, from area or diameter."""
        if self.area is not None:
            return self.area
        assert self.diameter is not None  # `_check` demands one of both
        return math.pi * self.diameter**2 / 4
