"""e of a pair over the ratio of the lengths, where fronts do not give it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..model import Rod
from ..model.frozen import InvalidModel
from .design import Design

SOLVED = 20  # points of the curve


def solved_curve(design: Design) -> dict[str, Any] | None:
    """e over l1/l2, l1 varied and all else as it is, as `fronts.curve_of`; None without l1/l2."""
    system = design.case.system
    rods = [b for b in system.bodies if isinstance(b, Rod) and len(b.segments) == 1]
    if len(rods) != 2 or len(system.bodies) != 2:
        return None
    left, right = rods
    if not isinstance(left.velocity, float) or not isinstance(left.strain, float):
        return None  # a profile is bound to the length it was made for
    long = float(right.length)
    reach = 2.0 ** max(1, math.ceil(math.log2(1.1 * float(left.length) / long)))
    ratios = (reach * np.arange(1, SOLVED + 1) / SOLVED).tolist()
    rows = [system.replace(bodies=[left.replace(length=r * long), right]) for r in ratios]
    values = [_restitution(design.of_system(row)) for row in rows]
    return {"ratios": ratios, "values": values, "source": f"solved at {SOLVED} ratios"}


def _restitution(design: Design) -> float | None:
    """e, None where there is none."""
    try:
        outcome = design.solve().outcome
    except InvalidModel:
        return None
    return None if outcome.why_no_restitution() else float(outcome.restitution)
