"""Even pieces of rods: the states of a solution that changes a little in every time step.

Such a solution has no fronts to draw between; a few hundred pieces show what can be seen of it.
"""

from __future__ import annotations

import numpy as np

from ..fields import Profile
from ..model import Rod
from ..signals import Floats, Ints
from ..solution import Solution

COLUMNS = 300  # pieces of the whole row


def is_stepped(solution: Solution) -> bool:
    """Whether the signals of a solution are averages over time steps."""
    return solution.fields.assembly.grain > 1


def pieces(solution: Solution, body: int) -> tuple[Floats, Ints]:
    """Ends of the pieces of a rod [n + 1], m from its left end, and the segment of each [n]."""
    rods = [b for b in solution.system.bodies if isinstance(b, Rod)]
    row = sum(float(rod.length) for rod in rods)
    corners = solution.fields.edges(body)
    counts = np.maximum(1, np.rint(COLUMNS * np.diff(corners) / row)).astype(int)
    parts = [
        np.linspace(left, right, count, endpoint=False)
        for left, right, count in zip(corners[:-1], corners[1:], counts, strict=True)
    ]
    first = solution.fields.assembly.spans[body][0]
    return np.append(np.concatenate(parts), corners[-1]), np.repeat(
        first + np.arange(counts.size), counts)


def sampled(solution: Solution, body: int, t: float) -> Profile:
    """State of a rod at t, s, as that in the middle of each piece."""
    edges, segment = pieces(solution, body)
    middle = (edges[:-1] + edges[1:]) / 2
    return Profile(edges, solution.velocity(body, middle, t),
                   solution.strain(body, middle, t), segment)


def averaged(solution: Solution, body: int, times: Floats) -> tuple[Floats, Floats]:
    """Velocity and strain [pieces, intervals] in the middle of each piece of a rod.

    They are exact averages over each interval between `times`, so that waves too quick for the
    picture leave no false pattern in it.
    """
    edges, _ = pieces(solution, body)
    return solution.fields.averaged(body, (edges[:-1] + edges[1:]) / 2, times)
