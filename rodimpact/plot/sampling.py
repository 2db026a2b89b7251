"""Samples of solutions that change smoothly, and of long records.

A smooth solution has no fronts between which it could be drawn; a few hundred pieces
show all that can be seen. A long record is cut into many intervals, and the least and
the largest value in each are drawn.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ..methods.signals import Floats, Ints
from ..model import Rod, System
from ..results.fields import Profile
from ..results.solution import Solution

PIECES_OF_ROW = 300
EDGES_OF_SMOOTH_STEPS = 2001  # edges of the steps that stand for a smooth curve
INTERVALS = 1000  # intervals of a long record: each is narrower than a pixel


def is_smooth(solution: Solution) -> bool:
    """Whether states change between fronts, so that pictures must sample the solution.

    False if velocity and strain are constant between the fronts.
    """
    return not solution.fields.constant_between_fronts


def rods_of(system: System) -> list[int]:
    """Indices of the bodies that are rods."""
    return [i for i, body in enumerate(system.bodies) if isinstance(body, Rod)]


def pieces(solution: Solution, body: int) -> Floats:
    """Edges [n + 1] of the n pieces of a rod, m from its left end.

    The ends of segments are among the edges. All rods of the row together have about
    `PIECES_OF_ROW` pieces of about equal length; each segment has at least one.
    """
    bodies: Any = solution.system.bodies
    row_length = sum(float(bodies[i].length) for i in rods_of(solution.system))
    segment_ends = solution.fields.edges(body)
    shares = np.diff(segment_ends) / row_length
    counts = np.rint(PIECES_OF_ROW * shares).astype(int)
    parts = []
    for left, right, count in zip(
        segment_ends[:-1], segment_ends[1:], counts, strict=True
    ):
        # The right end is left out: it is the first edge of the next segment.
        parts.append(np.linspace(left, right, max(1, count), endpoint=False))
    return np.append(np.concatenate(parts), segment_ends[-1])


def middles(edges: Floats) -> Floats:
    """Middles between neighbouring edges."""
    return (edges[:-1] + edges[1:]) / 2


def state_at(solution: Solution, body: int, t: float) -> Profile:
    """State of a rod at t, s: edges of its pieces, velocity and strain in each piece.

    The edges are the ends of segments and the fronts at t, which is rounded to a whole
    tick. A smooth solution has the edges of `pieces`, and its state is that in the
    middle of each piece at t itself.
    """
    if not is_smooth(solution):
        tick = int(solution.fields.to_ticks(t))
        return solution.fields.profile(body, tick)
    edges = pieces(solution, body)
    x = middles(edges)
    return Profile(edges, solution.velocity(body, x, t), solution.strain(body, x, t))


def properties(solution: Solution, body: int, x: Floats) -> Iterator[Floats]:
    """Yield the area, m^2, Young's modulus, Pa, and density, kg/m^3, along a rod.

    Each is an array of the values at the points x, m from the left end of the rod.
    """
    for name in ("area", "youngs_modulus", "density"):
        yield solution._property_along(body, x, name)


class StepCurve(NamedTuple):
    """A piecewise constant curve: value i from edge i to edge i + 1."""

    values: Floats  # [n]
    edges: Floats  # [n + 1], times, s


def steps_until(end: float, times: Floats, values: Floats, smooth: bool) -> StepCurve:
    """Steps of a record from its first time to `end`, s.

    Each value holds from its time to the next time, the last one to the end; values
    whose times are not before the end are left out. If `smooth`, the values are joined
    by straight lines instead, which are drawn as steps too small to be seen.
    """
    if smooth:
        edges = np.linspace(times[0], times[-1], EDGES_OF_SMOOTH_STEPS)
        edges = np.union1d(times, edges)
        values = np.interp(middles(edges), times, values)
        times = edges[:-1]  # times at which the small steps begin
    inside = times < end
    return StepCurve(values[inside], np.append(times[inside], end))


def evenly(count: int, at_most: int) -> Ints:
    """Indices of at most `at_most` of `count` values, evenly spread.

    The first and the last index are among them; [] if `count` is 0.
    """
    number = max(0, min(count, at_most))
    indices = np.linspace(0, count - 1, number).round().astype(np.int64)
    return np.unique(indices)


def extreme_indices(values: Floats) -> Ints:
    """Indices of extreme values: a curve through these alone looks like all of it.

    The curve is cut into `INTERVALS` intervals. The indices are those of the least and
    the largest value in each interval, and of the first and the last value, sorted. If
    there are at most 2 `INTERVALS` values, all indices are returned.
    """
    if values.size <= 2 * INTERVALS:
        return np.arange(values.size)
    width = math.ceil(values.size / INTERVALS)  # values in an interval
    # The last value is repeated until all intervals are full.
    padding = (0, width * INTERVALS - values.size)
    intervals = np.pad(values, padding, mode="edge").reshape(-1, width)
    first_of_interval = width * np.arange(INTERVALS)
    least = first_of_interval + intervals.argmin(axis=1)
    largest = first_of_interval + intervals.argmax(axis=1)
    extremes = np.concatenate((least, largest))
    last = values.size - 1
    extremes = np.minimum(extremes, last)  # a repeated value stands for the last one
    return np.unique(np.append(extremes, [0, last]))


def thinned(curve: StepCurve) -> StepCurve:
    """The steps of a curve at its `extreme_indices`: all steps of a short curve.

    A step that is left out is replaced by the step before it, which lasts longer.
    """
    chosen = extreme_indices(curve.values)
    edges = np.append(curve.edges[chosen], curve.edges[-1])
    return StepCurve(curve.values[chosen], edges)
