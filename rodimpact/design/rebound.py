"""Lengths, areas or whatever else varies, for a wanted coefficient of restitution.

What may vary is said as everywhere: by arrays in the system. The answer lies between two members
of that family, every array straight between them, so that several numbers may vary together.
"""

from dataclasses import dataclass

import numpy as np

from ..model import System
from ..model.arguments import of_kind, single
from ..model.frozen import refusal
from ..model.quantities import Floats
from ..results.notebook import Shown
from ..running.sweep_result import SweepResult
from ..running.sweeping import sweep
from ..storage.tables import align

NEAR_ENOUGH = 1e-6  # to the wanted e, where it is a largest or a least one


@dataclass(frozen=True)
class RestitutionDesign(Shown):
    """A collision that was designed for a coefficient of restitution.

    Attributes
    ----------
    system : System
    wanted, reached : float
        e; `reached` is that of the system.
    family : SweepResult
        The members among which it was looked for.
    place : float
        Where among the members the system lies: 2.5 is half way from member 2 to member 3.

    Examples
    --------
    How long must rod 1 be for e = 0.5?

    >>> import numpy as np, rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(np.linspace(0.1, 0.9, 9), area=1e-4, material=steel, velocity=1.0)
    >>> family = ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)])
    >>> found = ri.design.restitution(0.5, family)
    >>> round(found.system.bodies[0].length, 6), round(found.reached, 6)
    (0.5, 0.5)
    """

    system: System
    wanted: float
    reached: float
    family: SweepResult
    place: float

    @property
    def misfit(self) -> float:
        """Reached less wanted e."""
        return self.reached - self.wanted

    @property
    def values(self) -> dict[str, float]:
        """What was varied, as it is in the system, by the paths of a case file; SI units."""
        return {
            path: float(_between(array, self.place))
            for path, array in self.family.system.parameters.items()
        }

    def __str__(self) -> str:
        rows = [[path, f"{value:.6g}"] for path, value in self.values.items()]
        rows += [
            ["e wanted", f"{self.wanted:.6g}"],
            ["e reached", f"{self.reached:.6g}"],
        ]
        return align(rows)


def restitution(wanted: float, family: System) -> RestitutionDesign:
    """Find the collision with a wanted coefficient of restitution in a family.

    Parameters
    ----------
    wanted : float
        e of the centres of mass, 0 or more.
    family : System
        Two bodies or two groups, with one contact that can open; arrays of one length n >= 2 in it
        say what may vary, in which order and how far.

    Returns
    -------
    RestitutionDesign
        With the first system along the family that has it.

    Raises
    ------
    ValueError
        If the family has not one axis of two members or more, or no member has an e, or the wanted
        e lies beyond what is reached.

    Examples
    --------
    How thick must the longer rod be for 0.6?

    >>> import numpy as np, rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=np.geomspace(0.1, 1, 20) * 1e-4, material=steel)
    >>> print(restitution(0.6, ri.System([left, right])))
    bodies.1.area  6.02523e-05
    e wanted               0.6
    e reached              0.6
    """
    of_kind(
        "family", family, System, "System([Rod(np.linspace(.1, 1, 50), ...), other])"
    )
    if len(family.shape) != 1 or family.shape[0] < 2:
        raise refusal(
            "family",
            "must vary along one axis with two members or more, such as "
            f"Rod(np.linspace(.1, 1, 50), ...), got the shape {family.shape}",
        )
    e = single("wanted", wanted, "", "non-negative")
    members = sweep(family)
    known = members.restitution
    if not np.isfinite(known).any():
        raise refusal(
            "family", "none of its members has an e; sweep(family).explain says why"
        )

    def member(place: float) -> System:
        alone = family._mapped(lambda array: _between(array, place))
        return System.from_dict(alone.to_dict())

    def miss(place: float) -> float:
        return float(sweep(member(place)).restitution) - e

    from scipy.optimize import brentq, minimize_scalar

    off = known - e
    sides = np.flatnonzero(off[:-1] * off[1:] <= 0)
    if sides.size:
        first = int(sides[0])
        place = brentq(miss, first, first + 1, xtol=1e-15, rtol=1e-14)
    else:
        nearest = int(np.nanargmin(np.abs(off)))
        around = max(nearest - 1, 0), min(nearest + 1, len(off) - 1)
        place = minimize_scalar(
            lambda p: abs(miss(p)),
            bounds=around,
            method="bounded",
            options={"xatol": 1e-12},
        ).x
        if not abs(miss(place)) <= NEAR_ENOUGH:
            low, high = np.nanmin(known), np.nanmax(known)
            paths = " and ".join(family.parameters)
            raise refusal(
                "wanted",
                f"e = {e:g} is not reached: for these values of {paths}, e lies between {low:.6g} "
                f"and {high:.6g}. Give a wider range, or vary another number",
            )
    return RestitutionDesign(member(place), e, miss(place) + e, members, float(place))


def _between(array: Floats, place: float) -> float:
    """Value of an array at a place between its members."""
    return float(np.interp(place, np.arange(array.size), array.ravel()))
