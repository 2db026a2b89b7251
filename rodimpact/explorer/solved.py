"""What the page shows of a case, by the method that carries it: fronts, else characteristics.

Plain Python, which the page has as JavaScript.
"""

import math
from time import monotonic
from typing import Any

from ..methods.fronts.family_layout import lay_out_family
from ..methods.pieces.method import RTOL
from ..methods.row_builder import build_row
from ..methods.states import Stop
from . import fronts, pieces
from .known import gauge_of
from .motion import energy_curves, gauge_curve, path_of
from .picture import page_data
from .tables import is_smooth, request_of, system_of

QUICK = 1e-6  # tolerance of pieces for curves and maps


def scene_of(
    case: Any,
    gauges: Any,
    library: Any,
    tolerance: float = RTOL,
    seconds: float = math.inf,
) -> Any:
    """All that the page shows of a case without mistakes that it can solve.

    Waves between compliant contacts are pieces of this tolerance; the errors say what it does.
    Runs that take longer than so many seconds are given up.

    Returns
    -------
    dict
        As `page_data` makes it; or one with a ``problem``, path and sentence.
    """
    system, asked = system_of(case, library), request_of(case)
    if is_smooth(case):
        found = pieces.solved_by_pieces(system, asked, tolerance, seconds)
    else:
        found = fronts.solved_by_fronts(system, asked)
    return found if "problem" in found else shown_of(system, gauges, found)


def shown_of(system: Any, gauges: Any, found: Any) -> Any:
    """The data of the page for a solved collision.

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
    paths = [path_of(motion, i) for i in range(len(system.bodies))]
    energy = energy_curves(motion, found["tiling"]["t"] if exact else [])
    found = {**found, "motion": None, "exact": exact, "gauges": gauges}
    return page_data(system, found, paths, records, energy)


def e_of(case: Any, library: Any, seconds: float = math.inf) -> Any:
    """e of a case, as quickly as a curve needs it.

    None where there is no e, and where its run takes longer than so many seconds.
    """
    row, asked = build_row(system_of(case, library)), request_of(case)
    if is_smooth(case):
        deadline = monotonic() + seconds
        run = pieces.run_of(row, asked, QUICK, False, None, deadline)
        if "problem" in run:
            return None
        return pieces.outcome_of(run, [0.0 for _ in range(5)], "")["restitution"]
    run = fronts.run_of(asked, False, fronts.space_of(lay_out_family(row)))
    if run["run"].stop_reason >= Stop.OVERFLOW:
        return None
    return fronts.outcome_of(run, "")["restitution"]
