"""All that the page shows of a case, solved by fronts or else by characteristics.

Begin with `scene_of`. The page has this module as JavaScript.
"""

import math
from time import monotonic
from typing import Any

from ..methods.fronts.family_layout import lay_out_family
from ..methods.pieces.method import RTOL
from ..methods.row_builder import build_row
from ..methods.states import Stop
from . import fronts, pieces
from .facts import locate_gauge
from .motion import energy_curves, gauge_curve, path_of
from .picture import page_data
from .tables import is_smooth, request_of, system_of

MAP_TOLERANCE = 1e-6
"""Tolerance of pieces for curves and maps of e, which need many runs."""


def scene_of(
    case: Any,
    gauges: Any,
    library: Any,
    tolerance: float = RTOL,
    seconds: float = math.inf,
) -> Any:
    """All that the page shows of a case without mistakes that it can solve.

    Parameters
    ----------
    case : dict
        Tables of a case file.
    gauges : list of dict
        Each with its ``body`` and ``fraction`` of the length.
    library : dict
        Tables of the materials that the case may name.
    tolerance : float
        Tolerance of the pieces of waves, if characteristics solve the case. The stated
        errors say how accurate the results are.
    seconds : float
        Time after which runs by characteristics are given up.

    Returns
    -------
    dict
        That of `page_data`; or one with a ``problem``, path and sentence.
    """
    system = system_of(case, library)
    request = request_of(case)
    if is_smooth(case):
        solution = pieces.solve_by_pieces(system, request, tolerance, seconds)
    else:
        solution = fronts.solve_by_fronts(system, request)
    if "problem" in solution:
        return solution
    return scene_of_solution(system, gauges, solution)


def scene_of_solution(system: Any, gauges: Any, solution: Any) -> Any:
    """All that the page shows of a solved collision, see `page_data`.

    `solution` is changed: it gets the entries ``exact`` and ``gauges``.

    Parameters
    ----------
    system : System
    gauges : list of dict
        Each with its ``body`` and ``fraction`` of the length.
    solution : dict
        The ``motion``, the ``outcome``, ``method``, ``notes``, ``closed_form``, curves
        of the ``contacts`` and the ``tiling``.
    """
    motion = solution["motion"]
    records = []
    for gauge in gauges:
        location = locate_gauge(system, gauge)
        # Index in the row of the first segment of the body; spans count from 1.
        first_segment = motion["row"].spans[gauge["body"]][0] - 1
        curve = gauge_curve(motion, first_segment + location.segment, location.x)
        curve["name"] = location.name
        records.append(curve)
    paths = [path_of(motion, i) for i in range(len(system.bodies))]
    corners = []  # times at which the energies of a run by fronts change
    if motion["exact"]:
        corners = solution["tiling"]["t"]
    energies = energy_curves(motion, corners)
    solution["exact"] = motion["exact"]
    solution["gauges"] = gauges
    return page_data(system, solution, paths, records, energies)


def restitution_of_case(case: Any, library: Any, seconds: float = math.inf) -> Any:
    """e of a case, quickly, as curves and maps of many cases need it.

    There is one run, without stated error. The result is None if there is no e, the
    page cannot solve the case, or a run by characteristics takes longer than `seconds`.
    """
    row = build_row(system_of(case, library))
    request = request_of(case)
    no_status = ""  # nobody reads why the run ended
    if is_smooth(case):
        deadline = monotonic() + seconds
        keep_waves = False
        no_earlier_run = None
        run = pieces.run_of(
            row, request, MAP_TOLERANCE, keep_waves, no_earlier_run, deadline
        )
        if "problem" in run:
            return None
        no_errors = [0.0] * 5  # one for each measure
        return pieces.outcome_of(run, no_errors, no_status)["restitution"]
    run = fronts.new_run(lay_out_family(row))
    run_past_proof = False  # e is final at the proof
    fronts.run_to_end(request, run_past_proof, run)
    if run.record.stop_reason >= Stop.OVERFLOW:  # there is no result
        return None
    return fronts.outcome_of(run, no_status)["restitution"]
