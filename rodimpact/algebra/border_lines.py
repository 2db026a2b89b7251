"""Straight lines between border points, mesh by mesh of the lattice."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from .plane_cell import Floats
from .plane_search import LATTICE, BorderPoints, Indices

EDGES_ALONG_X = LATTICE * (LATTICE + 1)


class BorderLines(NamedTuple):
    """Pieces of borders, straight from point to point."""

    ends: Floats  # [line, 2, 2], shares of the axes
    points: Indices  # [line], a border point on each line


class BorderLine(NamedTuple):
    """A piece of a border in a mesh of the lattice."""

    start_point: int  # index of the border point where it begins
    end: Any  # [2] array, position


def join_points(borders: BorderPoints) -> BorderLines:
    """Straight lines between the border points on the four edges of each mesh.

    In a mesh, two points between the same regions are joined, and so are two points
    that remain. If more than two remain, each is joined to a centre, where several
    borders meet.
    """
    points_on_edge: dict[int, list[int]] = {}
    for p, edge in enumerate(borders.edges.tolist()):
        points_on_edge.setdefault(edge, []).append(p)
    lines: list[BorderLine] = []
    for i, j in np.ndindex(LATTICE, LATTICE):
        points = []
        for edge in _edges_of_mesh(i, j):
            points += points_on_edge.get(edge, [])
        lines += _lines_in_mesh(borders, points)
    ends = []
    start_points = []
    for line in lines:
        ends.append((borders.points[line.start_point], line.end))
        start_points.append(line.start_point)
    return BorderLines(
        np.array(ends).reshape(-1, 2, 2), np.array(start_points, dtype=int)
    )


def _edges_of_mesh(i: int, j: int) -> tuple[int, int, int, int]:
    """Edges around the mesh (i, j): two along x, then two along y.

    Edges are counted as in `BorderPoints.edges`: those along x from (i, j) to (i + 1,
    j) first, each with LATTICE + 1 values of j; then those along y, with LATTICE values
    of j.
    """
    along_x = i * (LATTICE + 1) + j
    along_y = EDGES_ALONG_X + i * LATTICE + j
    return along_x, along_x + 1, along_y, along_y + LATTICE


def _lines_in_mesh(borders: BorderPoints, points: list[int]) -> Iterator[BorderLine]:
    """Lines between the border points around a mesh.

    The only two points between the same regions are a pair, joined by a line. The other
    points are joined if they are two, or each joined to their centre if they are more.
    """
    points_between: dict[frozenset[int], list[int]] = {}  # keys: the two regions
    for p in points:
        regions = frozenset(borders.regions[p].tolist())
        points_between.setdefault(regions, []).append(p)
    unpaired = []
    for p in points:
        regions = frozenset(borders.regions[p].tolist())
        if len(points_between[regions]) != 2:
            unpaired.append(p)
    pairs = [pair for pair in points_between.values() if len(pair) == 2]
    if len(unpaired) == 2:
        pairs.append(unpaired)
    for p, q in pairs:
        yield BorderLine(p, borders.points[q])
    if len(unpaired) > 2:
        centre = _centre(borders, unpaired)
        for p in unpaired:
            yield BorderLine(p, centre)


def _centre(borders: BorderPoints, points: list[int]) -> Any:
    """Point where several borders meet in a mesh.

    Its x is the mean x of the points on edges along x, and its y the mean y of the
    points on edges along y. Without such points it is the mean of all points.
    """
    centre = borders.points[points].mean(axis=0)
    for axis in (0, 1):
        crossed = []
        for p in points:
            axis_of_edge = 0
            if borders.edges[p] >= EDGES_ALONG_X:  # those along y come after these
                axis_of_edge = 1
            if axis_of_edge == axis:
                crossed.append(p)
        if crossed:
            centre[axis] = borders.points[crossed, axis].mean()
    return centre
