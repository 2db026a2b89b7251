"""Grids of points in x and time, for solutions that have no fronts.

Each segment has a grid. Displacements are linear between its points, so that the cells
cut at time t are the rods at time t. Each cell has the mean velocity and strain that
follow from the displacements of its corners.

Grids are a dictionary of lists. For each grid it has the index of the ``body``, the
number of cells ``across``, and the ``start`` of its points in the lists ``x`` (m),
``t`` (s) and ``displacement`` (m). For each cell it has ``velocity`` (m/s), ``strain``
and ``stress`` (Pa). Cells and points are in rows of equal time, from t = 0 on. The page
has these functions as JavaScript.
"""

from typing import Any

CELLS = 2000
"""Approximate number of cells of all grids together."""
ROWS = 50
"""Number of rows of cells: each grid has as many cells in time."""


def no_cells() -> Any:
    """Grids without any cell: empty lists, and the ``start`` 0 of the first grid."""
    return {
        "start": [0],
        "body": [],
        "across": [],
        "x": [],
        "t": [],
        "displacement": [],
        "velocity": [],
        "strain": [],
        "stress": [],
    }


def across_of(system: Any, segment: Any) -> int:
    """Number of cells along a segment, at least one.

    It is proportional to the length of the segment: all cells of the row have about the
    same width.
    """
    length_of_rods = 0.0
    for body in system.bodies:
        if body.kind == "rod":
            for other in body.segments:
                length_of_rods += other.length
    across: int = round(CELLS / ROWS * segment.length / length_of_rods)
    return max(1, across)


def add_cells(
    grids: Any, body: int, segment: Any, left: float, end: float, rows: Any
) -> None:
    """Add the grid of a segment of a body to `grids`.

    Parameters
    ----------
    grids : dict
        Lists of all grids one after another, as from `no_cells`: values at points, and
        means of cells, which `add_row_of_cells` appends. ``start`` gets the index of
        the first point of the next grid. Changed in place.
    body : int
    segment : Segment
    left : float
        Distance of the segment's left end from that of the body, m.
    end : float
        Last time, s.
    rows : list of list of float
        Displacements [time][point], m, at equal steps of time from 0 to the end, at
        points with equal distances from the left to the right end.
    """
    L = segment.length
    across = len(rows[0]) - 1
    n_steps = len(rows) - 1
    for j, displacements in enumerate(rows):
        for k in range(across + 1):
            grids["x"].append(left + L * k / across)
            grids["t"].append(end * j / n_steps)
        grids["displacement"].extend(displacements)
        if j > 0:
            add_row_of_cells(grids, segment, rows[j - 1], displacements, end / n_steps)
    grids["body"].append(body)
    grids["across"].append(across)
    grids["start"].append(len(grids["x"]))


def add_row_of_cells(
    grids: Any, segment: Any, before: list[float], now: list[float], step: float
) -> None:
    """Add the velocity, strain and stress of a row of cells to `grids`.

    The cells are between the displacements `before` and `now`, m, which are `step`
    seconds apart. A cell with the displacements u at its corners has the strain du/dx
    and the velocity du/dt, each the mean over two opposite edges.
    """
    across = len(now) - 1
    for k in range(across):
        stretch = (now[k + 1] - now[k] + before[k + 1] - before[k]) / 2
        strain = stretch * across / segment.length  # a cell is length/across wide
        sum_of_changes = now[k] + now[k + 1] - before[k] - before[k + 1]
        grids["velocity"].append(sum_of_changes / 2 / step)
        grids["strain"].append(strain)
        grids["stress"].append(strain * segment.material.youngs_modulus)
