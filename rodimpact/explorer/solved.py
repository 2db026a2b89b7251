"""What the page shows of a case, by the method that carries it: fronts, else characteristics.

Plain Python, which the page has as JavaScript.
"""

from __future__ import annotations

from typing import Any

from .fronts import known_of
from .outcome import changed, restitutions
from .picture import picture, ratio_of
from .smooth import smooth_known, smooth_restitution
from .tables import contacts_in, is_smooth, row_of

RATIOS, FEW = 80, 20  # of the lengths, on the curve of e: of fronts and of characteristics


def scene_of(case: Any, gauges: Any, library: Any) -> Any:
    """All that the page shows of a case without mistakes that it can solve.

    Returns
    -------
    dict
        As `picture` makes it; or one with a ``problem``, path and sentence.
    """
    row = row_of(case, library)
    if is_smooth(case):
        known = smooth_known(row, contacts_in(case), gauges)
    else:
        known = known_of(row, gauges)
    if "problem" in known:
        return known
    ratio = ratio_of(known)
    if ratio is not None and is_smooth(case):
        known["curve"] = {"ratios": [], "values": [], "source": ""}  # solved when sliders rest
    elif ratio is not None:
        known["curve"] = curve_of(case, library, ratio)
    return picture(known)


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
