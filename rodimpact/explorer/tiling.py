"""Grids of points over place and time, for solutions that have no fronts.

One grid a segment. Between its points displacement is linear, so the cells cut at time t are the
rods at time t; each has the mean state that its corners' displacements imply. Grids are a table of
lists: the ``body`` of each, its cells ``across``, and where in ``x`` (m), ``t`` (s) and
``displacement`` (m) of the points it has its ``start``; ``velocity`` (m/s), ``strain`` and
``stress`` (Pa) of the cells. Row after row, upwards in time. Plain Python, which the page has as
JavaScript.
"""

from typing import Any

CELLS, ROWS = 2000, 50  # in all, about, and one above the other


def no_cells() -> Any:
    """A grid to begin with."""
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


def across_of(system: Any, piece: Any) -> int:
    """How many cells a segment has beside each other: cells are of about equal width."""
    total = sum(
        one.length
        for body in system.bodies
        if body.kind == "rod"
        for one in body.segments
    )
    across: int = round(CELLS / ROWS * piece.length / total)
    return max(1, across)


def add_cells(
    found: Any, body: int, piece: Any, left: float, end: float, rows: Any
) -> None:
    """Add the grid of a segment of a body.

    Parameters
    ----------
    found : dict
    body : int
    piece : Segment
    left : float
        Where its left end is in the body, m.
    end : float
        Last time, s.
    rows : list of list of float
        Displacements, m, at even places, at even times from 0 on.
    """
    L, across, step = piece.length, len(rows[0]) - 1, end / (len(rows) - 1)
    for j, here in enumerate(rows):
        found["x"].extend([left + L * k / across for k in range(across + 1)])
        found["t"].extend([end * j / (len(rows) - 1) for _ in here])
        found["displacement"].extend(here)
        before = rows[max(0, j - 1)]
        for k in range(across if j > 0 else 0):
            strain = (
                (here[k + 1] - here[k] + before[k + 1] - before[k]) / 2 * across / L
            )
            rise = here[k] + here[k + 1] - before[k] - before[k + 1]
            found["velocity"].append(rise / 2 / step)
            found["strain"].append(strain)
            found["stress"].append(strain * piece.material.youngs_modulus)
    found["body"].append(body)
    found["across"].append(across)
    found["start"].append(len(found["x"]))
