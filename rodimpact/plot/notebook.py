"""Results in a notebook: a picture, where there is one, above the table."""

from __future__ import annotations

import base64
import html
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
from .residuals import fit

MORE = "to_csv writes all, save keeps them"


def html_of(result: Solution | SweepResult | PulseDesign | RestitutionDesign | Fit) -> str:
    """Picture and table of a result."""
    if isinstance(result, PulseDesign | RestitutionDesign):
        return _image(design(result), "wanted and reached") + as_html(str(result))
    if isinstance(result, Fit):
        return _fit(result)
    return _solution(result) if isinstance(result, Solution) else _sweep(result)


def _fit(found: Fit) -> str:
    """Figures of all records, and table of a fit."""
    pictures = [_image(fit(found, record=i), f"{m.title}, measured and predicted")
                for i, m in enumerate(found.measured)]
    return "".join(pictures) + as_html(str(found))


def _solution(solution: Solution) -> str:
    """Overview and table of a solution."""
    try:
        picture = _image(overview(solution), headline(solution))
    except ValueError:  # it lasts no time
        picture = ""
    return picture + as_html(solution_table(solution))


def _sweep(result: SweepResult) -> str:
    """Curve or map, and table of a family."""
    varied = [(*axis, _unit(result, axis.name)) for axis in result.axes]
    return _family(result) + as_html(sweep_table(result, varied, MORE))


def _unit(result: SweepResult, path: str) -> str:
    """Unit of what varies, as tables write it."""
    return parameter(result.system, path).unit.removeprefix("1")


def _family(result: SweepResult) -> str:
    """Picture of e, or of the last body's velocity; none of a family with three axes, or none."""
    for quantity in ("restitution", f"velocity_after.{len(result.system.bodies) - 1}"):
        try:
            drawn = sweep(result, quantity=quantity)
        except ValueError:
            continue
        return _image(drawn, f"{quantity} over {', '.join(result.parameters)}")
    return ""


def _image(drawn: Any, description: str) -> str:
    """A picture as HTML that needs no file."""
    data = base64.b64encode(drawn._repr_png_()).decode()
    return (f'<img src="data:image/png;base64,{data}" alt="{html.escape(description)}" '
            'style="max-width: 100%">')
