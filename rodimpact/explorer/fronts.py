"""What is known of a row of fronts, as `picture` shows it.

Plain Python, which the page has as JavaScript.
"""

from __future__ import annotations

import math
from typing import Any

from ..methods.laws import Stop
from ..results.front_polygons import polygons_of, stretch_of
from ..units import format_si
from .motion import (
    contact_curves,
    end_of_picture,
    energy_curves,
    gauge_curve,
    rods_of,
)
from .outcome import closed_form_of, outcome_of
from .runs import run_of, space_of
from .texts import contacts_of, numbers_of

TOO_FAR_APART = "times too far apart for the clock of this page; rodimpact run may solve it"


def known_of(row: Any, gauges: Any) -> Any:
    """What `picture` shows of a row of fronts.

    Parameters
    ----------
    row : dict
        As `row_of` makes it.
    gauges : list of dict
        Each with its ``body`` and ``fraction`` of the length.

    Returns
    -------
    dict
        Or one with a ``problem``, path and sentence, where there is nothing to show.
    """
    run = run_of(row, True, space_of(row))
    if run["run"].stop >= Stop.OVERFLOW:
        return {"problem": ("bodies", TOO_FAR_APART)}
    outcome, rods = outcome_of(row, run), rods_of(row, run)
    tick, now = run["run"].tick, run["run"].now
    lengths = []
    for rod in rods:
        lengths.extend([it["length"] + stretch_of(it) * tick for it in rod["pieces"]])
    stop = end_of_picture(rods, now)
    if stop == 0:
        message = "lasts no time to show" if now == 0 else "has too many fronts to show"
        return {"problem": ("solve", f"{message}. {outcome['status']}")}
    notes = [outcome["status"]]
    if stop < now:
        end = format_si(stop * tick, "s", 4)
        notes.append(f"The picture ends at {end}: too many regions later.")
    polygons, strain = polygons_of(rods, tick, run["run"].frame, 0, stop), 0.0
    for e in polygons["strain"]:
        strain = max(strain, abs(e))
    curves, energy = contact_curves(row, run, stop), energy_curves(row, rods, polygons)
    names = [f"contact {name}" for name in contacts_of(row["bodies"])]
    opening = outcome["able"]
    return {
        "method": "fronts", "exact": True, "notes": notes, "curve": None,
        "closed_form": closed_form_of(row, outcome["before"]),
        "bodies": [body_of(row, body, stop * tick) for body in row["bodies"]],
        "positions": positions_of(row, lengths), "polygons": polygons, "strain": strain,
        "slowest": slowest_of(row, outcome["before"]),
        "contacts": [{"index": i, "bonded": bonded, "compliant": False}
                     for i, bonded in enumerate(row["bonded"])],
        "gauges": gauges, "outcome": outcome,
        "plots": [
            plot_of("force", "Contact force", "N", [
                series_of(names[i], curve["t"], curve["force"], True)
                for i, curve in enumerate(curves)]),
            plot_of("gap", "Gap", "m", [
                series_of(names[i], curves[i]["t"], curves[i]["gap"], False) for i in opening]),
            plot_of("energy", "Energy", "J", [
                series_of("moving as a whole", energy["t"], energy["whole"], False),
                series_of("vibration", energy["t"], energy["vibration"], False),
                series_of("strain", energy["t"], energy["strain"], False),
                series_of("total", energy["t"], energy["total"], False)]),
            plot_of("gauge", "Strain, below 0 compressed", "µε", [
                gauge_series(row, rods, gauge, tick, stop) for gauge in gauges]),
        ],
    }


def positions_of(row: Any, lengths: list[float]) -> list[float]:
    """Where the left end of each body lies at t = 0, m; `lengths` of the segments are strained."""
    place, positions = 0.0, []
    for i, body in enumerate(row["bodies"]):
        place += row["gaps"][i - 1] if i > 0 else 0.0
        positions.append(place)
        for s in range(body["first"], body["last"] + 1):
            place += lengths[s - 1]
    return positions


def slowest_of(row: Any, before: list[float]) -> float:
    """Velocity of a wall, 0 if an end is held, else the least of the bodies' velocities."""
    bodies = row["bodies"]
    held = [body["velocity"] for body in bodies if body["kind"] == "wall"]
    held.extend([0.0 for end in row["ends"] if end in ("fixed", "velocity")])
    slowest = math.inf
    for v in held if len(held) > 0 else before:
        slowest = v if abs(v) < abs(slowest) else slowest
    return slowest


def body_of(row: Any, body: Any, end: float) -> Any:
    """What `picture` shows of a body."""
    velocity, path = body["velocity"], None
    speed = None if isinstance(velocity, dict) else velocity
    if body["kind"] == "wall":
        path = {"t": [0.0, end], "displacement": [0.0, velocity * end]}
    return {
        "kind": body["kind"], "velocity": speed, "path": path, "mass": body["mass"],
        "approach": speed if body["strain"] == 0.0 else None,
        "pieces": [
            {**row["segments"][s - 1], "areas": [row["segments"][s - 1]["area"]]}
            for s in range(body["first"], body["last"] + 1)
        ],
    }


def plot_of(key: str, title: str, unit: str, series: list[Any]) -> Any:
    """A figure of curves over time."""
    return {"key": key, "title": title, "unit": unit, "series": series}


def series_of(name: str, t: list[float], y: list[float], steps: bool) -> Any:
    """A curve over time; with `steps` each value holds until the next time."""
    return {"name": name, "t": [*t], "y": y, "steps": steps}


def gauge_series(row: Any, rods: Any, gauge: Any, tick: float, stop: int) -> Any:
    """The curve of a gauge, in 1e-6."""
    x, name = gauge_of(row, gauge)
    curve = gauge_curve(rods[gauge["body"]]["pieces"], tick, x, stop)
    return series_of(name, curve["t"], [1e6 * e for e in curve["strain"]], True)


def gauge_of(row: Any, gauge: Any) -> Any:
    """Place of a gauge, m from the left end of its rod, and its name."""
    length, body = 0.0, row["bodies"][gauge["body"]]
    for s in range(body["first"], body["last"] + 1):
        length += row["segments"][s - 1]["length"]
    x, number = gauge["fraction"] * length, numbers_of(row["bodies"])[gauge["body"]]
    return x, f"rod {number} at {format_si(x, 'm', 4)}"
