"""Results in a notebook: a picture, where there is one, above the table."""

import base64
import html
from contextlib import suppress
from typing import Any

from ..design import PulseDesign, RestitutionDesign
from ..fitting.result import Fit
from ..results.labels import parameter
from ..results.solution import Solution
from ..running.sweep_report import sweep_table
from ..running.sweep_result import SweepResult
from ..storage.report import solution_table
from ..storage.tables import as_html
from .designs import design
from .families import sweep
from .page import headline, overview
from .records import fit

MORE = "to_csv writes all, save keeps them"


def html_of(result: Solution | SweepResult | PulseDesign | RestitutionDesign | Fit) -> str:
    """Picture and table of a result."""
    if isinstance(result, PulseDesign | RestitutionDesign):
        return _image(design(result), "wanted and reached") + as_html(str(result))
    if isinstance(result, Fit):
        pictures = [_image(fit(result, record=i), f"{m.title}, measured and predicted")
                    for i, m in enumerate(result.measured)]
        return "".join(pictures) + as_html(str(result))
    if isinstance(result, Solution):
        lasts = result.t_end > 0  # otherwise there is nothing to draw
        picture = _image(overview(result), headline(result)) if lasts else ""
        return picture + as_html(solution_table(result))
    varied = [(*axis, parameter(result.system, axis.name).unit.removeprefix("1"))
              for axis in result.axes]
    return _family(result) + as_html(sweep_table(result, varied, MORE))


def _family(result: SweepResult) -> str:
    """Picture of e, or of the last body's velocity; none of a family with three axes, or none."""
    for quantity in ("restitution", f"velocity_after.{len(result.system.bodies) - 1}"):
        with suppress(ValueError):
            drawn = sweep(result, quantity=quantity)
            return _image(drawn, f"{quantity} over {', '.join(result.parameters)}")
    return ""


def _image(drawn: Any, description: str) -> str:
    """A picture as HTML that needs no file."""
    data = base64.b64encode(drawn._repr_png_()).decode()
    return (f'<img src="data:image/png;base64,{data}" alt="{html.escape(description)}" '
            'style="max-width: 100%">')
