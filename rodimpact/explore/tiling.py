"""Polygons that tile the (x, t) plane of every rod.

Between vertices displacement is linear, so the polygons cut at time t are the rods at time t.
Fronts give exact regions of constant state; other solutions are sampled in cells, each with the
mean state that its corners' displacements imply.
"""

from __future__ import annotations

import numpy as np

from ..methods.groups import groups, movable
from ..methods.signals import Floats
from ..model import Rod
from ..results.regions import Regions
from ..results.solution import Solution

CELLS, ROWS = 2000, 50  # in all, about, and one above the other
POINTS = 240  # of a curve of energy, about: lines that its parabolas are drawn with
CROSSINGS = 1 << 20  # of edges and times that are tried for a curve of energy


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


def sliced_energy(solution: Solution, tiling: Regions) -> tuple[Floats, dict[str, Floats]]:
    """Energy in the rods by kind, J, over time: the ledger's, from slices of exact regions.

    The width of a polygon is linear in time between vertices, so momentum and the sums of kinetic
    and strain energy are; the rest is their parabolas.

    Parameters
    ----------
    solution : Solution
        Of fronts.
    tiling : Regions
        Its regions.

    Returns
    -------
    (array, dict of str to array)
        Times, s, and energies.
    """
    bodies = solution.system.bodies
    pieces = {(i, j): piece for i, body in enumerate(bodies) if isinstance(body, Rod)
              for j, piece in enumerate(body.segments)}
    of = [pieces[key] for key in zip(tiling.body.tolist(), tiling.segment.tolist(), strict=True)]
    per_length = np.array([float(s.mass) / float(s.length) for s in of])
    area = per_length / np.array([float(s.material.density) for s in of])
    corners = np.unique(tiling.t)
    parts = np.arange(count := max(6, POINTS // len(corners))) / count
    most = CROSSINGS // len(tiling.t)
    if len(corners) > most:
        corners, parts = np.linspace(0.0, corners[-1], most), np.zeros(1)
    times = np.append((corners[:-1, None] + np.diff(corners)[:, None] * parts).ravel(), corners[-1])
    widths = _widths(tiling, corners)

    def over_time(per_width: Floats) -> Floats:
        energy: Floats = np.interp(times, corners, per_width @ widths)
        return energy

    moving = over_time(per_length * tiling.velocity**2 / 2)
    strain = over_time(area * tiling.stress * tiling.strain / 2)
    free, whole = movable(solution.system), np.zeros(times.shape)
    for group in groups(solution.system):
        inside = [i for i in group if i in free]
        if inside:
            momentum = over_time(np.isin(tiling.body, inside) * per_length * tiling.velocity)
            whole += momentum**2 / (2 * sum(solution.outcome.masses[i] for i in inside))
    return times, {
        "moving as a whole": whole, "vibration": moving - whole, "strain": strain,
        "total": moving + strain,
    }


def _widths(tiling: Regions, times: Floats) -> Floats:
    """Width of each polygon at each time, m."""
    polygon = np.repeat(np.arange(len(tiling.body)), np.diff(tiling.start))
    following = np.arange(1, len(polygon) + 1)
    following[tiling.start[1:] - 1] = tiling.start[:-1]
    t0, t1 = tiling.t[:, None], tiling.t[following][:, None]
    x0, x1 = tiling.x[:, None], tiling.x[following][:, None]
    low, high = np.minimum(t0, t1), np.maximum(t0, t1)
    crossed = ((low < times) & (times <= high)) | ((times == times[0]) & (low == times[0]))
    crossed &= low < high
    share = np.where(crossed, times - t0, 0.0) / np.where(t0 == t1, 1.0, t1 - t0)
    places = np.where(crossed, np.sign(t1 - t0) * (x0 + (x1 - x0) * share), 0.0)
    widths = np.zeros((len(tiling.body), len(times)))
    np.add.at(widths, polygon, places)
    return np.abs(widths)
