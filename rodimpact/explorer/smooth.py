"""What is known of a row of characteristics, as `picture` shows it.

Plain Python, which the page has as JavaScript.
"""

from __future__ import annotations

import math
from typing import Any

from ..methods.laws import Law, Stop
from ..methods.pieces.accuracy import size_of
from ..methods.pieces.method import RTOL
from ..methods.pieces.totals import stated, status_of, tally_of, told_of, why_stopped
from ..methods.scales import smallest
from ..methods.status import strain_warning
from .fronts import (
    TOO_FAR_APART,
    body_of,
    gauge_of,
    plot_of,
    positions_of,
    series_of,
    slowest_of,
)
from .outcome import (
    able_of,
    driven_ends,
    is_held,
    restitution,
    velocities_of,
    why_no_restitution,
)
from .smooth_motion import energy_curves, gauge_curve, grids_of, line_curve, path_of, waves_of
from .smooth_runs import given_of, run_of, solved
from .tables import contacts_in, row_of
from .texts import contacts_of

STIFFEST = 2.0**80  # of a contact, times transit time over impedance
QUICK = 1e-6  # tolerance of curves and maps


def smooth_known(row: Any, contacts: Any, gauges: Any) -> Any:
    """What `picture` shows of a row with compliant contacts or rigid masses.

    Parameters
    ----------
    row : dict
        As `row_of` makes it.
    contacts : list of dict
        The tables of the contacts.
    gauges : list of dict
        Each with its ``body`` and ``fraction`` of the length.

    Returns
    -------
    dict
        Or one with a ``problem``, path and sentence, where there is nothing to show.
    """
    known = given_of(row, contacts)
    problem = refused(row, known)
    if problem is not None:
        return {"problem": problem}
    run = solved(row, known)
    if run is None:
        return {"problem": ("bodies", TOO_FAR_APART)}
    if run["ended"].run.stop == Stop.STUCK:
        message = "a rigid mass is squeezed between walls; give a contact there a compliant law"
        return {"problem": ("contacts", message)}
    outcome, frame = smooth_outcome(row, known, run), known["given"].frame
    if run["now"] == 0:
        return {"problem": ("solve", f"lasts no time to show. {outcome['status']}")}
    waves, tick, lengths = waves_of(run), run["clock"].tick, []
    for body in row["bodies"]:
        inside = row["segments"][body["first"] - 1 : body["last"]]
        lengths.extend([piece["length"] * (1 + body["strain"]) for piece in inside])
    grids, strain = grids_of(row, run, frame, waves), 0.0
    for e in grids["strain"]:
        strain = max(strain, abs(e))
    energy = energy_curves(row, known, run, waves)
    names = [f"contact {name}" for name in contacts_of(row["bodies"])]
    bodies = [body_of(row, body, run["now"] * tick) for body in row["bodies"]]
    masses = [i for i, body in enumerate(row["bodies"]) if body["kind"] == "mass"]
    for m, i in enumerate(masses):
        bodies[i]["path"] = path_of(run, frame, waves[run["mass"][m].line])
    forces, gaps = [], []
    for i, place in enumerate(known["links"]):
        it = run["ended"].link[place]
        force = line_curve(run, waves[it.force_line], 1.0)
        if force["y"][0] != 0:  # it jumps at t = 0
            force = {"t": [0.0, *force["t"]], "y": [0.0, *force["y"]]}
        forces.append(series_of(names[i], force["t"], force["y"], False))
        if it.law >= Law.RIGID:
            gap = line_curve(run, waves[it.overlap_line], -1.0)
            gaps.append(series_of(names[i], gap["t"], gap["y"], False))
    kinds = [("moving as a whole", "whole"), ("vibration", "vibration"), ("strain", "strain"),
             ("in compliant contacts", "contact"), ("total", "total")]
    laws = [contact.get("law", "rigid") for contact in contacts]
    soft = [law not in ("rigid", "bonded") for law in laws]
    title = "Gap, below 0 overlap" if any(compliant for compliant in soft) else "Gap"
    return {
        "method": "characteristics", "exact": False, "curve": None, "closed_form": None,
        "notes": [outcome["status"], "The picture shows means over cells."], "bodies": bodies,
        "positions": positions_of(row, lengths), "polygons": grids, "strain": strain,
        "slowest": slowest_of(row, outcome["before"]), "gauges": gauges, "outcome": outcome,
        "contacts": [{"index": i, "bonded": bonded, "compliant": soft[i]}
                     for i, bonded in enumerate(row["bonded"])],
        "plots": [
            plot_of("force", "Contact force", "N", forces), plot_of("gap", title, "m", gaps),
            plot_of("energy", "Energy", "J", [
                series_of(name, energy["t"], energy[key], False) for name, key in kinds
                if key != "contact" or any(compliant for compliant in soft)]),
            plot_of("gauge", "Strain, below 0 compressed", "µε", [
                smooth_gauge(row, run, waves, gauge) for gauge in gauges]),
        ],
    }


def refused(row: Any, known: Any) -> Any:
    """Path and sentence of what nobody can solve; None if there is nothing."""
    for i, place in enumerate(known["links"]):
        if is_beyond(known["given"], place):
            return (f"contacts.{i}.stiffness", "is as good as rigid here; make it less stiff")
    if driven_ends(row) and row["until"] < 0:
        return ("solve.until", "must be given where an end is driven")
    return None


def is_beyond(given: Any, i: int) -> bool:
    """Whether a link is too stiff to be told from a rigid one."""
    weakest = smallest(given.impedance)
    reach = (given.scale * given.reference) ** (given.exponent[i] - 1)
    return not given.stiffness[i] * (given.reference / weakest) * reach <= STIFFEST


def smooth_gauge(row: Any, run: Any, waves: list[Any], gauge: Any) -> Any:
    """The curve of a gauge, in 1e-6."""
    x, name = gauge_of(row, gauge)
    curve = gauge_curve(row, run, waves, row["bodies"][gauge["body"]], x)
    return series_of(name, curve["t"], [1e6 * e for e in curve["strain"]], False)


def smooth_outcome(row: Any, known: Any, run: Any) -> Any:
    """What the collision did, with the stated ``errors`` of each kind of number."""
    ended, tick, frame = run["ended"], run["clock"].tick, known["given"].frame
    link, heads = ended.link, [it for it in ended.part if it.parts > 0]
    before = velocities_of(row, [it.initial + frame for it in heads])
    after = velocities_of(row, [it.mean + frame for it in heads])
    contacts: list[Any] = []
    for i in known["links"]:
        told = tally_of(link[i], tick, run["now"])
        contacts.append({"impulse": told.impulse, "peak_force": told.peak_force,
                         "duration": told.duration, "episodes": told.episodes})
    vibration, energy, momentum = 0.0, 0.0, 0.0  # momentum: what a velocity can make of energy
    for it in ended.part:
        vibration += it.energy
    for body in row["bodies"]:
        energy += body["mass"] * body["velocity"] ** 2 / 2
        for s in range(body["first"], body["last"] + 1):
            energy += row["segments"][s - 1]["mass"] * (
                row["segments"][s - 1]["wave_speed"] * body["strain"]) ** 2 / 2
        momentum += body["mass"] * ended.run.scale
    able, status, final = able_of(row), smooth_sentence(row, run), ended.run.proved >= 0
    why = why_no_restitution(row, [c["episodes"] for c in contacts], before, final, status)
    speed, e, error = run["errors"][0] * ended.run.scale, math.nan, 0.0
    if why == "":
        e = restitution(able[0], before, after)
        error = 2 * speed / (before[able[0]] - before[able[0] + 1])
    return {
        "before": before, "after": after, "contacts": contacts, "able": able, "final": final,
        "status": status, "why": why, "restitution": e, "energy_before": energy,
        "vibration_after": vibration, "error": error,
        "errors": {
            "velocity": speed,
            "impulse": run["errors"][1] * size_of([c["impulse"] for c in contacts]),
            "peak_force": run["errors"][2] * size_of([c["peak_force"] for c in contacts]),
            "duration": run["errors"][3] * size_of([c["duration"] for c in contacts]),
            "energy": momentum * speed,
        },
    }


def smooth_sentence(row: Any, run: Any) -> str:
    """Why the run ended, as `Solution.status` has it."""
    ended, tick = run["ended"], run["clock"].tick
    it, end = ended.run, run["now"] * tick
    longest, fastest = 0.0, 0.0
    for body in row["bodies"]:
        span = 0.0
        for s in range(body["first"], body["last"] + 1):
            span += run["clock"].transits[s - 1]
        longest = max(longest, span)
    for piece in run["log"][: it.pieces]:
        if piece.line < 2 * len(row["segments"]):
            speed = 0.0
            for c in piece.coefficient:
                speed += abs(c)
            fastest = max(fastest, speed / row["segments"][piece.line // 2]["wave_speed"])
    sentence = status_of(it, ended.link, {
        "stopped_by": why_stopped(it, row["until"] >= 0), "end": end,
        "round_trip": 2 * longest * tick, "acting": "an end is driven" if driven_ends(row) else "",
        "held": is_held(row),
    })
    worst = max(run["errors"][0], run["errors"][1], run["errors"][2])
    return sentence + stated(worst, RTOL) + told_of(it) + strain_warning(fastest)


def smooth_restitution(case: Any, library: Any) -> Any:
    """e of a case, as quickly as a curve needs it; None where there is none."""
    row = row_of(case, library)
    known = given_of(row, contacts_in(case))
    stiff = any(is_beyond(known["given"], i) for i in known["links"])
    run = None if stiff else run_of(row, known, QUICK, False, None)
    if run is None or run["ended"].run.stop == Stop.STUCK:
        return None
    outcome = smooth_outcome(row, known, {**run, "errors": [0.0 for _ in range(5)]})
    return outcome["restitution"] if outcome["why"] == "" else None
