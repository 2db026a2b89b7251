"""Samples of solutions that change smoothly, and of long records.

Such a solution has no fronts to draw between; a few hundred pieces show what can be
seen of it. Of a long record the least and the largest value in each of many intervals
are drawn.
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
    """Whether a solution changes between fronts, so that pictures sample it."""
    return not solution.fields.constant_between_fronts


def rods_of(system: System) -> list[int]:
    """Indices of the bodies that are rods."""
    return [i for i, body in enumerate(system.bodies) if isinstance(body, Rod)]


def pieces(solution: Solution, body: int) -> Floats:
    """Ends of the pieces of a rod, m from its left end; each piece is in one segment.

    The row has about `PIECES_OF_ROW` pieces of about one length, each segment at least
    one.
    """
    bodies: Any = solution.system.bodies
    row = sum(float(bodies[i].length) for i in rods_of(solution.system))
    corners = solution.fields.edges(body)
    shares = np.diff(corners) / row
    counts = np.rint(PIECES_OF_ROW * shares).astype(int)
    parts = []
    for left, right, count in zip(corners[:-1], corners[1:], counts, strict=True):
        parts.append(np.linspace(left, right, max(1, count), endpoint=False))
    return np.append(np.concatenate(parts), corners[-1])


def middles(edges: Floats) -> Floats:
    """Middles between neighbouring edges."""
    return (edges[:-1] + edges[1:]) / 2


def state_at(solution: Solution, body: int, t: float) -> Profile:
    """State of a rod at t, s: between its fronts, or in the middle of each piece."""
    if not is_smooth(solution):
        tick = int(solution.fields.to_ticks(t))
        return solution.fields.profile(body, tick)
    edges = pieces(solution, body)
    x = middles(edges)
    return Profile(edges, solution.velocity(body, x, t), solution.strain(body, x, t))


def properties(solution: Solution, body: int, x: Floats) -> Iterator[Floats]:
    """Area, m^2, Young's modulus, Pa, and density, kg/m^3, at points x of a rod, m."""
    for name in ("area", "youngs_modulus", "density"):
        yield solution._property_along(body, x, name)


class StepCurve(NamedTuple):
    """A piecewise constant curve."""

    values: Floats  # [n]
    edges: Floats  # [n + 1]


def steps_until(end: float, times: Floats, values: Floats, smooth: bool) -> StepCurve:
    """Steps of a record that begin before its end, s; the last one lasts to the end.

    Each value holds from its time to the next. A smooth record has steps too small to
    be seen, along straight lines through its values.
    """
    if smooth:
        edges = np.linspace(times[0], times[-1], EDGES_OF_SMOOTH_STEPS)
        edges = np.union1d(times, edges)
        values = np.interp(middles(edges), times, values)
        times = edges[:-1]
    inside = times < end
    return StepCurve(values[inside], np.append(times[inside], end))


def evenly(count: int, at_most: int) -> Ints:
    """Indices of at most so many of `count` values, evenly spread, with both ends."""
    number = max(0, min(count, at_most))
    indices = np.linspace(0, count - 1, number).round().astype(np.int64)
    return np.unique(indices)


def extreme_indices(values: Floats) -> Ints:
    """Indices of the extremes of a long curve: they look like all of it.

    They are those of the least and the largest value in each of `INTERVALS`, and of the
    first and the last value. All indices are returned of up to twice as many values.
    """
    if values.size <= 2 * INTERVALS:
        return np.arange(values.size)
    width = math.ceil(values.size / INTERVALS)  # values in an interval
    padding = (0, width * INTERVALS - values.size)  # the last value is repeated
    rows = np.pad(values, padding, mode="edge").reshape(-1, width)
    first = width * np.arange(INTERVALS)
    least = first + rows.argmin(axis=1)
    largest = first + rows.argmax(axis=1)
    last = values.size - 1
    extremes = np.concatenate((least, largest))
    extremes = np.minimum(extremes, last)  # an index in padding: the last value
    return np.unique(np.append(extremes, [0, last]))


def thinned(curve: StepCurve) -> StepCurve:
    """The steps of a long curve with the extreme values; all of a short one."""
    chosen = extreme_indices(curve.values)
    edges = np.append(curve.edges[chosen], curve.edges[-1])
    return StepCurve(curve.values[chosen], edges)
