"""What the page shows of a case, by the method that carries it: fronts, else characteristics.

Plain Python, which the page has as JavaScript.
"""

from typing import Any

from ..methods.pieces.method import RTOL
from . import fronts, pieces
from .known import described, gauge_of
from .motion import energy_curves, gauge_curve, path_of
from .picture import picture
from .tables import asked_of, is_smooth, system_of


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
        found = pieces.solved_by_pieces(system, asked, tolerance)
    else:
        found = fronts.solved_by_fronts(system, asked)
    return found if "problem" in found else picture(known_of(system, gauges, found))


def known_of(system: Any, gauges: Any, found: Any) -> Any:
    """What `picture` shows of a collision that is solved.

    Parameters
    ----------
    system : Row
    gauges : list of dict
        Each with its ``body`` and ``fraction`` of the length.
    found : dict
        The ``motion``, the ``outcome``, ``method``, ``notes``, ``closed_form``, curves of the
        ``contacts`` and the ``tiling``.
    """
    motion, records, exact = found["motion"], [], found["motion"]["exact"]
    for gauge in gauges:
        s, x, name = gauge_of(system, gauge)
        curve = gauge_curve(motion, motion["row"].spans[gauge["body"]][0] - 1 + s, x)
        records.append({"name": name, **curve})
    return described(system, {
        **found, "exact": exact, "gauges": gauges, "records": records,
        "paths": [path_of(motion, i) for i in range(len(system.bodies))],
        "energy": energy_curves(motion, found["tiling"]["t"] if exact else [])})


def e_of(case: Any, library: Any) -> Any:
    """e of a case, as quickly as a curve needs it; None where there is none."""
    system, asked = system_of(case, library), asked_of(case)
    if is_smooth(case):
        return pieces.restitution_of(system, asked)
    return fronts.restitution_of(system, asked)
