"""Grids of points over place and time, for solutions that have no fronts.

One grid a segment. Between its points displacement is linear, so the cells cut at time t are the
rods at time t; each has the mean state that its corners' displacements imply.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..model import Rod
from ..results.solution import Solution

CELLS, ROWS = 2000, 50  # in all, about, and one above the other


def grids(solution: Solution) -> dict[str, list[Any]]:
    """Grids of equal height, with cells of about equal width, of any solution.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    dict of str to list
        For each grid its ``body``, its cells ``across``, and where in ``x`` (m), ``t`` (s) and
        ``displacement`` (m) of the points it has its ``start``; ``velocity`` (m/s), ``strain`` and
        ``stress`` (Pa) of the cells. Row after row, upwards in time.
    """
    rods = [(i, b) for i, b in enumerate(solution.system.bodies) if isinstance(b, Rod)]
    total = sum(float(rod.length) for _, rod in rods)
    times = np.linspace(0.0, solution.t_end, ROWS + 1)
    names = ("body", "across", "x", "t", "displacement", "velocity", "strain", "stress")
    found: dict[str, list[Any]] = {"start": [0], **{name: [] for name in names}}
    for body, rod in rods:
        edges = solution.fields.edges(body)
        for segment, piece in enumerate(rod.segments):
            L = float(piece.length)
            across = max(1, round(CELLS / ROWS * L / total))
            x, t = np.broadcast_arrays(
                np.linspace(edges[segment], edges[segment + 1], across + 1), times[:, None]
            )
            u = solution.displacement(body, x, t)
            rise, stretch = np.diff(u, axis=0), np.diff(u, axis=1)
            strain = (stretch[1:] + stretch[:-1]) / 2 * across / L
            velocity = (rise[:, 1:] + rise[:, :-1]) / 2 / times[1]
            columns = (
                [body], [across], x, t, u, velocity, strain,
                strain * float(piece.material.youngs_modulus),
            )
            for name, values in zip(names, columns, strict=True):
                found[name] += np.ravel(values).tolist()
            found["start"].append(len(found["x"]))
    return found
