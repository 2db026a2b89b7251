"""Results in a notebook: pictures, where there are any, above the table."""

from contextlib import suppress
from typing import Any, NamedTuple

from ..design import PulseDesign
from ..fitting.result import Fit
from ..results.labels import quantity_of_parameter
from ..results.solution import Solution
from ..running.sweep_report import sweep_table
from ..running.sweep_result import SweepResult
from ..storage.report import solution_table
from ..storage.tables import as_html
from .designs import design
from .families import sweep
from .files import as_image
from .page import headline, overview
from .records import fit

CSV_HINT = "to_csv writes all, save keeps them"


class _Described(NamedTuple):
    """A picture, and its description for screen readers."""

    picture: Any
    description: str


def html_of(result: Solution | SweepResult | PulseDesign | Fit) -> str:
    """HTML with the pictures of a result, if it has any, and its table below them.

    A solution has an overview, a design and a fitted record have one picture each, and
    a family a curve or a map.
    """
    if isinstance(result, PulseDesign):
        table = str(result)
        pictures = [_Described(design(result), "wanted and reached")]
    elif isinstance(result, Fit):
        table = str(result)
        pictures = []
        for i, measured in enumerate(result.measured):
            description = f"{measured.title}, measured and predicted"
            pictures.append(_Described(fit(result, record=i), description))
    elif isinstance(result, Solution):
        table = solution_table(result)
        pictures = []
        if result.t_end > 0:  # otherwise there is nothing to draw
            pictures.append(_Described(overview(result), headline(result)))
    else:
        table = _family_table(result)
        pictures = _family_pictures(result)
    html = ""
    for picture, description in pictures:
        html += as_image(picture._repr_png_(), "png", description)
    return html + as_html(table)


def _family_table(result: SweepResult) -> str:
    """Results of a family as plain text, with the units of the varied numbers.

    `sweep_table` writes the tables: the grids, the extremes of e, and the collisions.
    """
    varied = []
    for axis in result.axes:
        unit = quantity_of_parameter(result.system, axis.name).unit
        if unit == "1":  # a pure number: the table shows no unit
            unit = ""
        varied.append((axis.name, axis.values, unit))
    return sweep_table(result, varied, CSV_HINT)


def _family_pictures(result: SweepResult) -> list[_Described]:
    """Picture of e over the family, or of the last body's velocity if no member has e.

    The list is empty if neither can be drawn, as for a family with three axes.
    """
    last = len(result.system.bodies) - 1
    varied = ", ".join(result.parameters)
    for quantity in ("restitution", f"velocity_after.{last}"):
        with suppress(ValueError):  # no values, or not one or two axes
            picture = sweep(result, quantity=quantity)
            return [_Described(picture, f"{quantity} over {varied}")]
    return []
