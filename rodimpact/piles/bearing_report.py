"""Bearing graphs as tables for people and as JSON for programs."""

import math
from typing import Any

from ..methods.status import quake_warning
from ..storage.tables import align, versioned_json
from ..units import format_si
from .resting import CELLS

COLUMNS = {
    "resistance": "N",
    "shaft": "N",
    "toe": "N",
    "set": "m",
    "blow_count": "1/m",
    "compression": "Pa",
    "compression_x": "m",
    "compression_t": "s",
    "tension": "Pa",
    "tension_x": "m",
    "tension_t": "s",
    "set_error": "",
    "compression_error": "",
    "tension_error": "",
}
"""Numbers of a `BearingPoint` with their units."""
LARGE_ERROR = 0.1
"""Relative stated error above which the report names a remedy."""
HEADS = (
    "resistance",
    "shaft",
    "toe",
    "set",
    "blow count",
    "compression",
    "at x",
    "at t",
    "tension",
    "at x",
    "at t",
)


def bearing_table(graph: Any) -> str:
    """A bearing graph for people: a row for each resistance, then notes.

    The notes are the stated errors, the status of each blow that is not over, and a
    warning of quakes if there is one.

    Parameters
    ----------
    graph : BearingGraph

    Returns
    -------
    str
    """
    rows = [list(HEADS)]
    for point in graph.points:
        rows.append(_row(point))
    blocks = [align(rows, left=()), _errors(graph)]
    for point in graph.points:
        if not point.is_over:
            blocks.append(f"At {format_si(point.resistance, 'N')}: {point.status}")
    warning = quake_warning(graph.system).strip()
    if warning:
        blocks.append(warning)
    return "\n\n".join(blocks)


def _row(point: Any) -> list[str]:
    """Cells of a row, as in `HEADS`; "-" for numbers that do not exist."""
    blow_count = "-"
    if math.isfinite(point.blow_count):
        blow_count = f"{point.blow_count:.4g} 1/m"
    return [
        format_si(point.resistance, "N"),
        format_si(point.shaft, "N"),
        format_si(point.toe, "N"),
        format_si(point.set, "m"),
        blow_count,
        format_si(point.compression, "Pa"),
        _known(point.compression_x, "m"),
        _known(point.compression_t, "s"),
        format_si(point.tension, "Pa"),
        _known(point.tension_x, "m"),
        _known(point.tension_t, "s"),
    ]


def _known(value: float, unit: str) -> str:
    """A number with its unit as a text; "-" for nan."""
    if math.isnan(value):
        return "-"
    return format_si(value, unit)


def _errors(graph: Any) -> str:
    """Sentences on the meaning of the stresses and on the largest stated errors.

    If an error is above `LARGE_ERROR`, a sentence proposes more cells.
    """
    largest_errors = {}
    for name in ("set", "compression", "tension"):
        largest_errors[name] = float(graph[f"{name}_error"].max())
    stated = []
    large = []
    for name, error in largest_errors.items():
        stated.append(f"{name} {100 * error:.2g} %")
        if error > LARGE_ERROR:
            large.append(name)
    text = (
        "Largest stresses in the pile until the blow is over; x from its head, t from "
        f"the impact. Largest stated errors: {', '.join(stated)}."
    )
    if large:
        text += (
            f" For {' and '.join(large)} take more cells: give cells=, such as "
            f"{2 * CELLS} or {4 * CELLS}; the default is {CELLS}."
        )
    return text


def bearing_json(graph: Any) -> str:
    """A bearing graph for programs.

    Parameters
    ----------
    graph : BearingGraph

    Returns
    -------
    str
        An object with ``schema_version``, ``shaft_share`` and ``points``: a list of the
        numbers of each resistance in SI units, with null for what does not exist.
    """
    points = []
    for point in graph.points:
        entries: dict[str, Any] = {name: getattr(point, name) for name in COLUMNS}
        entries["is_over"] = point.is_over
        entries["status"] = point.status
        points.append(entries)
    return versioned_json(shaft_share=graph.shaft_share, points=points)
