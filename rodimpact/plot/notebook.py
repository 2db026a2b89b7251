"""Results in a notebook: a picture, where there is one, above the table."""

from contextlib import suppress
from typing import Any

from ..design import PulseDesign
from ..fitting.result import Fit
from ..results.labels import parameter
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

MORE = "to_csv writes all, save keeps them"


def html_of(
    result: Solution | SweepResult | PulseDesign | Fit,
) -> str:
    """Picture and table of a result."""
    pictures: list[tuple[Any, str]] = []
    if isinstance(result, PulseDesign):
        table, pictures = str(result), [(design(result), "wanted and reached")]
    elif isinstance(result, Fit):
        table = str(result)
        pictures = [
            (fit(result, record=i), f"{m.title}, measured and predicted")
            for i, m in enumerate(result.measured)
        ]
    elif isinstance(result, Solution):
        table = solution_table(result)
        if result.t_end > 0:  # otherwise there is nothing to draw
            pictures = [(overview(result), headline(result))]
    else:
        varied = [
            (*axis, parameter(result.system, axis.name).unit.removeprefix("1"))
            for axis in result.axes
        ]
        table = sweep_table(result, varied, MORE)
        # of e, or of the last body's velocity; none of a family with three axes, or none
        for quantity in (
            "restitution",
            f"velocity_after.{len(result.system.bodies) - 1}",
        ):
            with suppress(ValueError):
                over = f"{quantity} over {', '.join(result.parameters)}"
                pictures = pictures or [(sweep(result, quantity=quantity), over)]
    images = [as_image(drawn._repr_png_(), "png", words) for drawn, words in pictures]
    return "".join(images) + as_html(table)
