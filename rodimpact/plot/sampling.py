"""Even pieces of rods: the states of a solution that changes smoothly.

Such a solution has no fronts to draw between; a few hundred pieces show what can be seen of it.
"""

from collections.abc import Iterator

import numpy as np

from ..methods.signals import Floats, Ints
from ..model import Rod
from ..results.fields import Profile
from ..results.solution import Solution

COLUMNS = 300  # pieces of the whole row
FINE = 2001  # edges of steps that stand for a smooth curve
INTERVALS = (
    500  # of a long record, in each of which the least and the largest value are drawn
)


def is_stepped(solution: Solution) -> bool:
    """Whether a solution changes between fronts, so that pictures sample it."""
    return not solution.fields.constant_between_fronts


def pieces(solution: Solution, body: int) -> Floats:
    """Ends of the pieces of a rod, m from its left end; each piece is in one segment."""
    rods = [b for b in solution.system.bodies if isinstance(b, Rod)]
    row = sum(float(rod.length) for rod in rods)
    corners = solution.fields.edges(body)
    counts = np.maximum(1, np.rint(COLUMNS * np.diff(corners) / row)).astype(int)
    parts = [
        np.linspace(left, right, count, endpoint=False)
        for left, right, count in zip(corners[:-1], corners[1:], counts, strict=True)
    ]
    return np.append(np.concatenate(parts), corners[-1])


def state_at(solution: Solution, body: int, t: float) -> Profile:
    """State of a rod at t, s: between its fronts, or as that in the middle of each piece."""
    fields = solution.fields
    if not is_stepped(solution):
        return fields.profile(body, int(fields.to_ticks(t)))
    edges = pieces(solution, body)
    middle = (edges[:-1] + edges[1:]) / 2
    return Profile(
        edges, solution.velocity(body, middle, t), solution.strain(body, middle, t)
    )


def steps_until(
    end: float, times: Floats, values: Floats, smooth: bool
) -> tuple[Floats, Floats]:
    """Edges [n + 1] and values [n] of the steps of a record that begin before its end, s.

    A smooth record has steps too small to be seen, along lines through it.
    """
    if smooth:
        edges = np.union1d(times, np.linspace(times[0], times[-1], FINE))
        values, times = (
            np.interp((edges[1:] + edges[:-1]) / 2, times, values),
            edges[:-1],
        )
    inside = times < end
    return np.append(times[inside], end), values[inside]


def properties(solution: Solution, body: int, x: Floats) -> Iterator[Floats]:
    """Area, m^2, Young's modulus, Pa, and density, kg/m^3, at places in a rod, m."""
    return (
        solution._along(body, x, name) for name in ("area", "youngs_modulus", "density")
    )


def evenly(count: int, most: int) -> Ints:
    """Indices of at most `most` of so many values, evenly chosen, first and last among them."""
    return np.unique(
        np.linspace(0, count - 1, max(0, min(count, most))).round().astype(np.int64)
    )


def telling(values: Floats) -> Ints:
    """Indices of the least and the largest value of each of `INTERVALS`, of the first and last.

    All indices of up to twice as many values.
    """
    if values.size <= 2 * INTERVALS:
        return np.arange(values.size)
    wide = -(-values.size // INTERVALS)
    parts = np.pad(values, (0, wide * INTERVALS - values.size), mode="edge").reshape(
        -1, wide
    )
    begins, last = wide * np.arange(INTERVALS), values.size - 1
    found = np.concatenate(
        (begins + parts.argmin(axis=1), begins + parts.argmax(axis=1))
    )
    return np.unique(np.append(np.minimum(found, last), [0, last]))


def thinned_steps(edges: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Values [n] of the steps of a record that tell most, and their edges [n + 1]."""
    kept = telling(values)
    return values[kept], np.append(edges[kept], edges[-1])
