"""The coefficient of restitution of a pair beside theory, and over the ratio of the lengths."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..methods.signals import Floats
from ..model import Rod, System
from ..model.frozen import InvalidModel
from ..results.closed_forms import ClosedForm
from .design import Design

CLOSED, SOLVED = 81, 21  # points of the curve


class Curve(NamedTuple):
    """e over l1/l2, l1 varied and all else as it is; nan where there is no e.

    source : where the values come from, for people
    """

    ratios: list[float]
    values: list[float]
    source: str


def ratio_of(system: System) -> float | None:
    """l1/l2 of two uniform rods; None for any other row."""
    lengths = [
        float(b.length) for b in system.bodies if isinstance(b, Rod) and len(b.segments) == 1
    ]
    return lengths[0] / lengths[1] if len(lengths) == len(system.bodies) == 2 else None


def closed_curve(system: System, theory: ClosedForm | None) -> Curve | None:
    """Curve by the closed form that holds; None where there is none, or no l1/l2."""
    ratio = ratio_of(system)
    if ratio is None or theory is None:
        return None
    ratios = _ratios(ratio, CLOSED)
    left, right = theory.transit_time
    varied = theory._replace(transit_time=(left * ratios / ratio, right))
    return Curve(
        ratios.tolist(), np.asarray(varied.collision().restitution).tolist(),
        f"closed form, {theory.source}",
    )


def solved_curve(design: Design) -> Curve | None:
    """Curve by solving a collision at each of some ratios; None where there is no l1/l2."""
    system = design.case.system
    ratio = ratio_of(system)
    if ratio is None:
        return None
    left, right = system.bodies
    assert isinstance(left, Rod)
    assert isinstance(right, Rod)
    if not isinstance(left.velocity, float) or not isinstance(left.strain, float):
        return None  # a profile is bound to the length it was made for
    ratios = _ratios(ratio, SOLVED)
    rows = [
        system.replace(bodies=[left.replace(length=length), right])
        for length in (ratios * float(right.length)).tolist()
    ]
    values = [_restitution(design.of_system(row)) for row in rows]
    return Curve(ratios.tolist(), values, f"solved at {len(rows)} ratios")


def _restitution(design: Design) -> float:
    """e, nan where there is none."""
    try:
        outcome = design.solve().outcome
    except InvalidModel:
        return math.nan
    return math.nan if outcome.why_no_restitution() else outcome.restitution


def _ratios(ratio: float, count: int) -> Floats:
    """Even points up to 2, or to 4, 8, ... with the current ratio inside."""
    reach = 2.0 ** max(1, math.ceil(math.log2(1.1 * ratio)))
    return np.linspace(0.0, reach, count)[1:]
