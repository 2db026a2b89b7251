"""What the page shows of a case, by the method that carries it: fronts, else characteristics.

Plain Python, which the page has as JavaScript.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..methods.pieces.method import RTOL
from .fronts import known_of
from .outcome import changed, restitutions
from .picture import picture, ratio_of
from .smooth import smooth_known, smooth_restitution
from .tables import asked_of, contacts_in, is_smooth, system_of

LEAST, MOST = -2.0, 4.0  # log10 of kappa, on the curve of e over the roundness of the ends
RATIOS, FEW = 80, 20  # of the lengths, on the curve of e: of fronts and of characteristics


def scene_of(case: Any, gauges: Any, library: Any, tolerance: float = RTOL) -> Any:
    """All that the page shows of a case without mistakes that it can solve.

    Waves between compliant contacts are pieces of this tolerance; the errors say what it does.

    Returns
    -------
    dict
        As `picture` makes it; or one with a ``problem``, path and sentence.
    """
    system, asked = system_of(case, library), asked_of(case)
    if is_smooth(case):
        known = smooth_known(system, asked, gauges, tolerance)
    else:
        known = known_of(system, asked, gauges)
    if "problem" in known:
        return known
    ratio = ratio_of(known)
    if ratio is not None and is_smooth(case):
        known["curve"] = {"ratios": [], "values": [], "source": ""}  # solved when sliders rest
    elif ratio is not None:
        known["curve"] = curve_of(case, library, ratio)
    return {**picture(known), "roundness": begin_roundness(case, system)}


def e_over(case: Any, library: Any, path: list[Any], values: list[float]) -> list[Any]:
    """e for each value of a number of a case; None where there is none."""
    if not is_smooth(case):
        return restitutions(case, library, path, values)
    return [smooth_restitution(changed(case, path, value), library) for value in values]


def curve_of(case: Any, library: Any, ratio: float) -> Any:
    """e over l1/l2 of two uniform rods, l1 varied and all else as it is.

    None where the left one has a profile, which is bound to the length it was made for.
    """
    left, reach, count = case["bodies"][0], 2.0, FEW if is_smooth(case) else RATIOS
    if isinstance(left.get("velocity", 0.0), dict) or isinstance(left.get("strain", 0.0), dict):
        return None
    while reach < 1.1 * ratio:
        reach *= 2
    ratios = [reach * (k + 1) / count for k in range(count)]
    lengths = [r * case["bodies"][1]["length"] for r in ratios]
    values = e_over(case, library, ["bodies", 0, "length"], lengths)
    return {"ratios": ratios, "values": values, "source": f"solved at {count} ratios"}


def unit_stiffness(system: Any) -> float:
    """Stiffness k of rounded ends, N/m^1.5, for which kappa = k (V T)^(1/2) T/Z is 1.

    V is the closing speed, T the longer transit time and Z the impedance of that rod, so that
    T/Z = L/(E A). It is 0 for all but two uniform rods with rigid or round ends.
    """
    bodies, segments = system.bodies, [s for body in system.bodies for s in body.segments]
    if len(bodies) != 2 or len(segments) != 2 or any(body.kind != "rod" for body in bodies):
        return 0.0
    if any(not isinstance(body.velocity, float) for body in bodies):
        return 0.0
    closing = bodies[0].velocity - bodies[1].velocity
    if system.contacts[0].law not in ("rigid", "hertz") or closing <= 0:
        return 0.0
    left, right = segments
    rod = left if left.transit_time > right.transit_time else right
    T: float = rod.transit_time
    k: float = rod.impedance / (T * math.sqrt(closing * T))
    return k


def begin_roundness(case: Any, system: Any) -> Any:
    """Where a pair is on the curve of `roundness_of`, log10 of its kappa; None for other rows."""
    unit = unit_stiffness(system)
    if unit == 0:
        return None
    k = contacts_in(case)[0].get("stiffness")
    return {"ratios": [], "values": [], "source": "", "unit": unit,
            "here": None if k is None else math.log10(k / unit)}


def roundness_of(case: Any, library: Any) -> Any:
    """e of a pair over the roundness of its ends, which meet by Hertz's law: over log10 kappa.

    Ends that are nearly flat, of large kappa, let waves decide: e is that of rigid ends. Between
    round ends the force changes little in a transit, and the rods rebound like rigid balls.
    """
    unit = unit_stiffness(system_of(case, library))
    logs = [LEAST + (MOST - LEAST) * i / (FEW - 1) for i in range(FEW)]
    contact, values = contacts_in(case)[0], []
    for log in logs:
        hertz = {**contact, "law": "hertz", "stiffness": unit * np.exp(log * math.log(10.0))}
        values.append(smooth_restitution({**case, "contacts": [hertz]}, library))
    return {"ratios": logs, "values": values, "source": f"solved at {FEW} stiffnesses"}
