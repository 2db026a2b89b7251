"""Stated errors of the fields of a grid: from the same collision on coarser meshes."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..methods.run import Coarser
from ..methods.signals import Floats
from ..model import Rod

PLACES = 65
"""Places of a rod at which fields are compared, both ends among them."""
NEAR_STEPS = (-2.0, -1.0, 0.0, 1.0, 2.0)
"""Coarse time steps about a time at which fields are compared: differences change their sign."""


class FieldError(NamedTuple):
    """Stated errors of field values at some times, anywhere in the row; arrays like the times.

    inf where no mesh finds the value: waves that jump and stay steep have no velocity and no stress
    at the jump.

    Attributes
    ----------
    velocity : array
        m/s.
    stress : array
        Pa.
    displacement : array
        m.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> row = ri.System([left, right], contacts=[ri.Hertz(1e10)])
    >>> solution = ri.solve(row, until=4e-4, method="finite-difference")
    >>> error = solution.field_error(2e-4)
    >>> bool(0 < error.velocity < 1e-2), bool(0 < error.displacement < 1e-6)
    (True, True)
    """

    velocity: Floats
    stress: Floats
    displacement: Floats


def field_error(
    fine: Any, coarser: Sequence[tuple[Coarser, Any]], t: Floats
) -> FieldError:
    """Compare fields of solutions on several meshes.

    Parameters
    ----------
    fine : Solution
    coarser : sequence of (Coarser, Solution)
    t : array
        s.

    Returns
    -------
    FieldError
        With q(h) a value on the finer mesh and q(g) that on a coarser one, the largest of
        share |q(g) - q(h)| over all rods, places, coarser meshes, and times near t.
    """
    errors: dict[str, Floats] = {}
    for name in FieldError._fields:
        errors[name] = _error_of(name, fine, coarser, t.ravel()).reshape(t.shape)
    if any(mesh.steep for mesh, _ in coarser):
        errors["velocity"] = np.full(t.shape, np.inf)
        errors["stress"] = np.full(t.shape, np.inf)
    return FieldError(**errors)


def _error_of(
    name: str, fine: Any, coarser: Sequence[tuple[Coarser, Any]], t: Floats
) -> Floats:
    """Stated error of a field at the times t, [time]; inf where no mesh is compared."""
    largest = np.full(t.size, np.inf)
    for mesh, solution in coarser:
        times = t[:, None] + solution.fields.step * np.array(NEAR_STEPS)
        times = np.clip(times, 0.0, fine.t_end)
        compared = times.max(axis=1) <= solution.t_end
        if not compared.any():
            continue
        difference = _difference(name, fine, solution, times[compared])
        before = largest[compared]
        before[np.isinf(before)] = 0.0
        largest[compared] = np.maximum(before, mesh.share * difference)
    return largest


def _difference(name: str, fine: Any, coarse: Any, times: Floats) -> Floats:
    """Largest difference of a field over all rods, [time]; times are [time, near]."""
    largest = np.zeros(len(times))
    instants = times.ravel()
    for body, rod in enumerate(fine.system.bodies):
        if not isinstance(rod, Rod):
            continue
        x = np.linspace(0.0, float(rod.length), PLACES)[:, None]
        fine_values = getattr(fine, name)(body, x, instants)
        coarse_values = getattr(coarse, name)(body, x, instants)
        over_places = np.abs(fine_values - coarse_values).max(axis=0)
        over_near_times = over_places.reshape(times.shape).max(axis=1)
        largest = np.maximum(largest, over_near_times)
    return largest
