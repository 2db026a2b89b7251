"""Grids of points over place and time, for solutions that have no fronts.

Each segment has a grid. Between its points the displacement is linear, so that the
cells cut at time t are the rods at time t; each cell has the mean state of its corners'
displacements. Grids are a dictionary of lists. For each grid it has the ``body``, the
number of cells ``across``, and the ``start`` of its points in ``x`` (m), ``t`` (s) and
``displacement`` (m). For each cell it has ``velocity`` (m/s), ``strain`` and ``stress``
(Pa). Cells and points are in rows, from t = 0 on. The page has these functions as
JavaScript.
"""

from typing import Any

CELLS = 2000
"""Number of cells of all grids, about."""
ROWS = 50
"""Number of cells over the time."""


def no_cells() -> Any:
    """Grids without any cell: empty lists, and the start 0 of the first points."""
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
    """Number of cells along a segment, its share of the length of all rods.

    All cells have about the same width; each segment has at least one.
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
    """Add the grid of a segment of a body.

    Parameters
    ----------
    grids : dict
    body : int
    segment : Segment
    left : float
        Distance of the segment's left end from that of the body, m.
    end : float
        Last time, s.
    rows : list of list of float
        Displacements, m, at places at equal distances, at equal steps of time from 0
        on.
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
    """Add the mean states of the cells between two rows of displacements.

    The rows are `step` seconds apart. A cell with the displacements u at its corners
    has the strain du/dx and the velocity du/dt, each the mean over its two edges.
    """
    across = len(now) - 1
    for k in range(across):
        stretch = (now[k + 1] - now[k] + before[k + 1] - before[k]) / 2
        strain = stretch * across / segment.length  # a cell is length/across wide
        both_rises = now[k] + now[k + 1] - before[k] - before[k + 1]
        grids["velocity"].append(both_rises / 2 / step)
        grids["strain"].append(strain)
        grids["stress"].append(strain * segment.material.youngs_modulus)
