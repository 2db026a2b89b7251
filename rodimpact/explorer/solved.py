"""What the page shows of a case, by the method that carries it: fronts, else characteristics.

Plain Python, which the page has as JavaScript.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..methods.fronts.plan import plan_of
from ..methods.laws import Stop
from ..methods.pieces.method import RTOL
from ..methods.walk import walk
from . import fronts, pieces
from .known import described, gauge_of
from .motion import energy_curves, gauge_curve, path_of
from .picture import picture, ratio_of
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
        known = known_of(system, gauges, pieces.solved_by_pieces(system, asked, tolerance))
    else:
        known = known_of(system, gauges, fronts.solved_by_fronts(system, asked))
    if "problem" in known:
        return known
    ratio = ratio_of(known)
    if ratio is not None and is_smooth(case):
        known["curve"] = {"ratios": [], "values": [], "source": ""}  # solved when sliders rest
    elif ratio is not None:
        known["curve"] = curve_of(case, library, ratio)
    return {**picture(known), "roundness": begin_roundness(case, system)}


def known_of(system: Any, gauges: Any, found: Any) -> Any:
    """What `picture` shows of a collision that is solved.

    Parameters
    ----------
    system : Row
    gauges : list of dict
        Each with its ``body`` and ``fraction`` of the length.
    found : dict
        The ``motion``, the ``outcome``, ``method``, ``notes``, ``closed_form``, curves of the
        ``contacts`` and the ``tiling``; or a ``problem``, which is returned.
    """
    if "problem" in found:
        return found
    motion, records, exact = found["motion"], [], found["motion"]["exact"]
    for gauge in gauges:
        s, x, name = gauge_of(system, gauge)
        curve = gauge_curve(motion, motion["row"].spans[gauge["body"]][0] - 1 + s, x)
        records.append({"name": name, **curve})
    return described(system, {
        **found, "exact": exact, "gauges": gauges, "records": records,
        "paths": [path_of(motion, i) for i in range(len(system.bodies))],
        "energy": energy_curves(motion, found["tiling"]["t"] if exact else [])})


def e_over(case: Any, library: Any, path: list[Any], values: list[float]) -> list[Any]:
    """e for each value of a number of a case; None where there is none."""
    smooth, asked, found = is_smooth(case), asked_of(case), []
    space: Any = None if smooth else fronts.space_of(plan_of(walk(system_of(case, library))))
    for value in values:
        system, e = system_of(changed(case, path, value), library), None
        if smooth:
            e = pieces.restitution_of(system, asked)
        else:
            space["plan"] = plan_of(walk(system))
            run = fronts.run_of(asked, False, space)
            if run["run"].stop < Stop.OVERFLOW:
                outcome = fronts.outcome_of(run)
                e = outcome["restitution"] if outcome["why"] == "" else None
        found.append(e)
    return found


def changed(tree: Any, path: list[Any], value: float) -> Any:
    """The tables with another number at a path."""
    if len(path) == 0:
        return value
    copy = [*tree] if isinstance(tree, list) else {**tree}
    copy[path[0]] = changed(tree[path[0]], path[1:], value)
    return copy


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
        system = system_of({**case, "contacts": [hertz]}, library)
        values.append(pieces.restitution_of(system, asked_of(case)))
    return {"ratios": logs, "values": values, "source": f"solved at {FEW} stiffnesses"}
