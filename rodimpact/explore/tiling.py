"""Cells that tile the (x, t) plane of every rod, for solutions that have no fronts.

Between vertices displacement is linear, so the cells cut at time t are the rods at time t; each has
the mean state that its corners' displacements imply.
"""

from __future__ import annotations

import numpy as np

from ..methods.signals import Floats
from ..model import Rod
from ..results.regions import Regions
from ..results.solution import Solution

CELLS, ROWS = 2000, 50  # in all, about, and one above the other


def cells(solution: Solution) -> Regions:
    """Cells of equal height, and about equal width, of any solution."""
    rods = [(i, b) for i, b in enumerate(solution.system.bodies) if isinstance(b, Rod)]
    total = sum(float(rod.length) for _, rod in rods)
    times = np.linspace(0.0, solution.t_end, ROWS + 1)
    parts = []
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
            strain = (stretch[1:] + stretch[:-1]).ravel() / 2 * across / L
            velocity = (rise[:, 1:] + rise[:, :-1]).ravel() / 2 / times[1]
            n = strain.size
            parts.append((
                np.full(n, body), np.full(n, segment), velocity, strain,
                strain * float(piece.material.youngs_modulus), np.full(n, 4),
                _corners(x), _corners(t), _corners(u),
            ))
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    columns[5] = np.concatenate(([0], np.cumsum(columns[5])))
    return Regions(*columns)


def _corners(grid: Floats) -> Floats:
    """Values at the four corners of each cell, going round."""
    around = (grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1])
    corners: Floats = np.stack(around, axis=-1).ravel()
    return corners
