"""Bearing graphs as tables for people and as JSON for programs."""

import math
from typing import Any

from ..storage.tables import align, versioned_json
from ..units import format_si

COLUMNS = {
    "resistance": "N",
    "shaft": "N",
    "toe": "N",
    "set": "m",
    "blow_count": "1/m",
    "compression": "Pa",
    "compression_x": "m",
    "tension": "Pa",
    "tension_x": "m",
    "set_error": "",
    "stress_error": "",
}
"""Numbers of a `BearingPoint` with their units."""
HEADS = (
    "resistance",
    "shaft",
    "toe",
    "set",
    "blow count",
    "compression",
    "at",
    "tension",
    "at",
)


def bearing_table(graph: Any) -> str:
    """A bearing graph for people: a row for each resistance, and what the numbers are.

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
    return "\n\n".join(blocks)


def _row(point: Any) -> list[str]:
    """Cells of one resistance."""
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
        _place(point.compression_x),
        format_si(point.tension, "Pa"),
        _place(point.tension_x),
    ]


def _place(x: float) -> str:
    """A place, m from the head of the pile; "-" where there is none."""
    if math.isnan(x):
        return "-"
    return format_si(x, "m")


def _errors(graph: Any) -> str:
    """The largest stated errors, in a sentence."""
    set_error = float(graph["set_error"].max())
    stress_error = float(graph["stress_error"].max())
    return (
        "Largest stresses in the pile, with their distance from its head. Stated "
        f"relative error: set {set_error:.1g}, stress {stress_error:.1g}."
    )


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
