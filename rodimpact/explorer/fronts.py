"""What is known of a collision that fronts carry, as `picture` shows it.

Plain Python, which the page has as JavaScript.
"""

from __future__ import annotations

from typing import Any

from ..methods.fronts.plan import plan_of
from ..methods.laws import Stop
from ..methods.walk import walk
from ..results.front_polygons import polygons_of, stretch_of
from ..units import format_si
from .known import curves_of, described, gauge_of, positions_of
from .motion import contact_curves, end_of_picture, energy_curves, gauge_curve, rods_of
from .outcome import closed_form_of, outcome_of
from .runs import run_of, space_of

TOO_FAR_APART = "times too far apart for the clock of this page; rodimpact run may solve it"


def known_of(system: Any, asked: Any, gauges: Any) -> Any:
    """What `picture` shows of a system that fronts can carry.

    Parameters
    ----------
    system : Row
    asked : Asked
    gauges : list of dict
        Each with its ``body`` and ``fraction`` of the length.

    Returns
    -------
    dict
        Or one with a ``problem``, path and sentence, where there is nothing to show.
    """
    run = run_of(asked, True, space_of(plan_of(walk(system))))
    it = run["run"]
    if it.stop >= Stop.OVERFLOW:
        return {"problem": ("bodies", TOO_FAR_APART)}
    outcome, rods, tick = outcome_of(run), rods_of(run), it.tick
    stop = end_of_picture(rods, it.now)
    if stop == 0:
        message = "lasts no time to show" if it.now == 0 else "has too many fronts to show"
        return {"problem": ("solve", f"{message}. {outcome['status']}")}
    notes, lengths, end = [outcome["status"]], [], stop * tick
    if stop < it.now:
        notes.append(f"The picture ends at {format_si(end, 's', 4)}: too many regions later.")
    for rod in rods:
        length = 0.0
        for piece in rod["pieces"]:
            length += piece["length"] + stretch_of(piece) * tick
        lengths.append(length)
    polygons = polygons_of(rods, tick, it.frame, 0, stop)
    curves, energy = contact_curves(run, stop), energy_curves(system, rods, polygons)
    paths = [{"t": [0.0, end], "displacement": [0.0, body.velocity * end]}
             if body.kind == "wall" else None for body in system.bodies]
    records = []
    for gauge in gauges:
        s, x, name = gauge_of(system, gauge)
        t, strain = gauge_curve(rods[gauge["body"]]["pieces"][s], tick, x, stop)
        records.append((name, t, strain))
    return {
        **described(system, paths, positions_of(system, lengths), polygons, outcome),
        "method": "fronts", "exact": True, "notes": notes, "gauges": gauges,
        "closed_form": closed_form_of(system, outcome["before"]),
        "plots": curves_of(system, curves, energy, records, True),
    }
