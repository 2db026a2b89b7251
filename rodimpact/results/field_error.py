"""Stated errors of the fields of a grid: from the same collision on coarser meshes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_missing
from ..methods.run import Coarser
from ..methods.signals import Floats
from ..model import Rod

COMPARED_POINTS = 65
"""Number of points of a rod at which fields are compared, both ends included."""
COMPARED_STEPS = (-2.0, -1.0, 0.0, 1.0, 2.0)
"""Delays at which fields are compared around a time, in steps of the coarser mesh.

One time is not enough: the difference of two meshes changes its sign over time, and may
be 0 there by chance.
"""


@explain_missing()
class FieldError(NamedTuple):
    """Stated errors of field values anywhere in the row, at given times.

    The errors are arrays of the shape of the times. An error is inf if no mesh
    determines the value: at a steep jump velocity and stress have no unique value.

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


class CoarserSolution(NamedTuple):
    """The same collision on a coarser mesh."""

    mesh: Coarser
    solution: Any  # Solution


def field_error(fine: Any, coarser: Sequence[CoarserSolution], t: Floats) -> FieldError:
    """Stated errors of the fields of a solution, by comparison with coarser meshes.

    The difference of a field on two meshes is the largest one over all rods and points,
    and over times up to two steps of the coarser mesh from t. The error is this
    difference times `Coarser.share`. If there are several coarser meshes, it is the
    largest of their errors.

    Parameters
    ----------
    fine : Solution
    coarser : sequence of CoarserSolution
    t : array
        s; of any shape, which the errors have too.

    Returns
    -------
    FieldError
        Errors are inf at times that no coarser run reaches. Those of velocity and
        stress are inf at all times if waves are steep.
    """
    errors: dict[str, Floats] = {}
    for name in FieldError._fields:
        error = _error_of(name, fine, coarser, t.ravel())
        errors[name] = error.reshape(t.shape)
    has_steep_waves = any(mesh.steep for mesh, _ in coarser)
    if has_steep_waves:  # no mesh has the values at their jumps
        errors["velocity"] = np.full(t.shape, np.inf)
        errors["stress"] = np.full(t.shape, np.inf)
    return FieldError(**errors)


def _error_of(
    name: str, fine: Any, coarser: Sequence[CoarserSolution], t: Floats
) -> Floats:
    """Stated error of the field `name` near times t, s, [time].

    Each coarser mesh gives an error: its `Coarser.share` times the largest difference
    near a time. The largest of these errors is returned; inf at times that no coarser
    run reaches.
    """
    largest_error = np.zeros(t.size)
    is_compared = np.zeros(t.size, dtype=bool)
    for mesh, coarse in coarser:
        time_step = coarse.fields.step  # s
        delays = time_step * np.array(COMPARED_STEPS)
        times = np.clip(t[:, None] + delays, 0.0, fine.t_end)  # [time, delay]
        # A time is compared only if the coarser run reaches all times near it.
        is_reached = times.max(axis=1) <= coarse.t_end
        if not is_reached.any():
            continue
        difference = _largest_difference(name, fine, coarse, times[is_reached])
        # The error of the finer mesh is at most this share of the difference.
        by_this_mesh = mesh.share * difference
        largest_error[is_reached] = np.maximum(largest_error[is_reached], by_this_mesh)
        is_compared |= is_reached
    return np.where(is_compared, largest_error, np.inf)


def _largest_difference(name: str, fine: Any, coarse: Any, times: Floats) -> Floats:
    """Largest absolute difference of a field of two solutions near each time, [time].

    It is the largest one over all rods, over `COMPARED_POINTS` points of each, and over
    the times near each time: `times` is [time, delay], s. `name` is that of the field.
    Walls and rigid masses are left out; the result is 0 if there is no rod.
    """
    largest = np.zeros(len(times))
    instants = times.ravel()
    for body, rod in enumerate(fine.system.bodies):
        if not isinstance(rod, Rod):
            continue
        x = np.linspace(0.0, float(rod.length), COMPARED_POINTS)
        column = x[:, None]
        # The methods of that name, such as `Solution.stress`, give [point, instant],
        # with an instant for each time and delay.
        fine_values = getattr(fine, name)(body, column, instants)
        coarse_values = getattr(coarse, name)(body, column, instants)
        over_points = np.abs(fine_values - coarse_values).max(axis=0)  # [instant]
        over_delays = over_points.reshape(times.shape).max(axis=1)  # [time]
        largest = np.maximum(largest, over_delays)
    return largest
