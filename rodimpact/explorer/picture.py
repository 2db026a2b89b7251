"""All that the page shows of a solution, from what is known of it: layout, curves, texts.

Plain Python, which the page has as JavaScript: a collision that it solves itself and one that
Python has solved for it are shown alike. Polygons cut at time t are the rods at time t, so the page
slices them and needs no physics.
"""

from __future__ import annotations

import math
from typing import Any

from ..results.magnification import BLOCK, drifts, magnified, round_down
from ..storage.tables import clean
from ..units import TIMES, format_factor, format_si
from .reason import reason_of
from .texts import capital, contacts_of, name_of, numbers_of, stated, written


def picture(known: Any) -> Any:
    """The scene of a solution.

    Parameters
    ----------
    known : dict
        ``bodies``: kind, ``velocity`` (None for a profile), ``approach`` (None unless all of it
        comes unstrained with one velocity), ``pieces``, ``mass``, and ``path`` of what has no
        inside; ``positions`` of their left ends, m; ``polygons``, or grids with ``across`` cells
        in a row, and the largest ``strain``; ``slowest``: velocity of a frame for a row that
        drifts; curves; and what `_outcome`, `_results` and the page itself read.

    Returns
    -------
    dict
        JSON-ready, SI units but for strain in 1e-6; numbers that do not exist are None.
    """
    polygons, end = known["polygons"], 0.0
    for t in polygons["t"]:
        end = max(end, t)
    row, bodies = row_of_picture(known)
    e = restitution_of(known)
    reason = reason_of(known, e["text"] if e["why"] == "" else "")
    return {
        "end": end, "exact": known["exact"], "method": known["method"], "row": row,
        "bodies": bodies, "tiling": polygons,
        "plots": [plot for plot in known["plots"] if len(plot["series"]) > 0],
        "contacts": known["contacts"], "gauges": known["gauges"],
        "restitution": e, "reason": reason, "curve": known["curve"], "ratio": ratio_of(known),
        "results": results_of(known), "notes": known["notes"],
    }


def row_of_picture(known: Any) -> Any:
    """How the row is laid out: X = left + x + magnification * (apart + displacement - frame t)."""
    lengths, total, masses = [], 0.0, 0
    for body in known["bodies"]:
        length = 0.0
        for piece in body["pieces"]:
            length += piece["length"]
        lengths.append(length)
        total += length
        masses += 1 if body["kind"] == "mass" else 0
    block = round_down(BLOCK * total) if masses > 0 else 0.0
    left, apart, begin, place, entries = [], [], 0.0, 0.0, []
    numbers = numbers_of(known["bodies"])
    for i, body in enumerate(known["bodies"]):
        name = name_of(body["kind"], numbers[i])
        width = block if body["kind"] == "mass" else lengths[i]
        left.append(place)
        apart.append(known["positions"][i] - begin)
        begin += lengths[i]
        place += width
        entries.append({
            "kind": body["kind"], "name": name, "width": width,
            "title": "Wall" if body["kind"] == "wall" else capital(name),
            "derived": [derived_of(piece) for piece in body["pieces"]], "path": body["path"],
            "approach": body["approach"],
            "pieces": [
                (piece["length"], piece["areas"][-1], piece["mass"] / piece["length"],
                 piece["transit_time"]) for piece in body["pieces"]],
        })
    marks = marks_of(known)
    reach, slowest = spread(marks, apart, 0.0), known["slowest"]
    relative = spread(marks, apart, slowest)
    magnification = magnified(total, reach, relative, known["strain"])
    frame = slowest if drifts(reach, relative) else 0.0
    low, high = math.inf, -math.inf
    for i, x, t, u in marks:
        at = left[i] + x + magnification * (apart[i] + u - frame * t)
        low, high = min(low, at), max(high, at + (block if entries[i]["kind"] == "mass" else 0.0))
    note = "true to scale"
    if magnification != 1:
        note = f"displacements {TIMES} {format_factor(magnification)}"
    if frame != 0:
        note = f"{note}, frame moving at {format_si(frame, 'm/s', 4)}"
    row = {
        "left": left, "apart": apart, "magnification": magnification, "frame": frame, "note": note,
        "span": [low, high],
    }
    return row, entries


def marks_of(known: Any) -> list[Any]:
    """Body, place in it, time and displacement of all that is drawn."""
    polygons = known["polygons"]
    marks = [
        (body, polygons["x"][k], polygons["t"][k], polygons["displacement"][k])
        for i, body in enumerate(polygons["body"])
        for k in range(polygons["start"][i], polygons["start"][i + 1])
    ]
    for i, body in enumerate(known["bodies"]):
        if body["path"] is not None:
            for t, u in zip(body["path"]["t"], body["path"]["displacement"], strict=True):
                marks.append((i, 0.0, t, u))
    return marks


def spread(marks: list[Any], apart: list[float], frame: float) -> float:
    """How far bodies get from where they would be, m, in a moving frame."""
    low, high = math.inf, -math.inf
    for i, _, t, u in marks:
        moved = apart[i] + u - frame * t
        low, high = min(low, moved), max(high, moved)
    return high - low


# Texts --------------------------------------------------------------------------------------------


def derived_of(piece: Any) -> Any:
    """What follows for a segment."""
    return [
        ("bar speed c", f"{piece['wave_speed']:.4g} m/s"),
        ("impedance Z", f"{between(piece, piece['density'] * piece['wave_speed'], 4)} kg/s"),
        ("transit time T", written(piece["transit_time"], "s", 5)),
        ("mass m", f"{piece['mass']:.4g} kg"),
    ]


def between(piece: Any, factor: float, digits: int) -> str:
    """The area times a factor, or from the smallest to the largest."""
    low = f"{piece['areas'][0] * factor:.{digits}g}"
    high = f"{piece['areas'][-1] * factor:.{digits}g}"
    return low if low == high else f"{low} to {high}"


def ratio_of(known: Any) -> Any:
    """l1/l2 of two uniform rods; None for any other row."""
    bodies = known["bodies"]
    if len(bodies) != 2 or len(bodies[0]["pieces"]) != 1 or len(bodies[1]["pieces"]) != 1:
        return None
    return bodies[0]["pieces"][0]["length"] / bodies[1]["pieces"][0]["length"]


def restitution_of(known: Any) -> Any:
    """e beside its closed form."""
    outcome, closed, why = known["outcome"], known["closed_form"], known["outcome"]["why"]
    value, digits, text = None, 6 if known["method"] == "fronts" else 5, "-"
    if why == "":
        value, error = outcome["restitution"], outcome.get("error", 0.0)
        text = stated(
            f"{clean(value, 1.0):.{digits}g}", max(value, 1e-9), digits, error, "")
    elif len(outcome["able"]) > 1:
        count = len(outcome["able"])
        why = f"A coefficient e belongs to one contact; this row has {count}, see the velocities"
    else:
        why = capital(why)
    entry = {"value": value, "text": text, "why": why, "closed_form": None, "source": ""}
    if closed is not None:
        entry = {
            **entry, "closed_form": closed["restitution"], "source": closed["source"],
            "closed_text": f"{closed['restitution']:.6g}",
        }
        if value is not None:
            entry["difference"] = f"{abs(value - closed['restitution']):.1g}"
    return entry


def results_of(known: Any) -> Any:
    """What the collision did, in words and numbers."""
    o, digits, fastest = known["outcome"], 6 if known["method"] == "fronts" else 4, 0.0
    for v in [*o["before"], *o["after"]]:
        fastest = max(fastest, abs(v))
    after = "after" if o["final"] else "at the end"
    rows, names, errors = [], contacts_of(known["bodies"]), o.get("errors", {})
    for i, number in enumerate(numbers_of(known["bodies"])):
        if number != "wall":
            v, name = clean(o["after"][i], fastest), name_of(known["bodies"][i]["kind"], number)
            text = stated(f"{v:.{digits}g} m/s", v, digits, errors.get("velocity", 0.0), "m/s")
            rows.append((f"velocity of {name} {after}", text))
    for i in o["able"]:
        c, name = o["contacts"][i], f" {names[i]}" if len(o["able"]) > 1 else ""
        for what, key, unit in (
            ("impulse", "impulse", "N s"), ("peak force", "peak_force", "N"),
            ("force duration", "duration", "s"),
        ):
            if c[key] == c[key]:  # a blow of rigid bodies has no peak force
                text = stated(written(c[key], unit, 5), c[key], 5, errors.get(key, 0.0), unit)
                rows.append((f"{what}{name}", text))
    rows.append(("energy before", written(o["energy_before"], "J", 5)))
    vibration = clean(o["vibration_after"], o["energy_before"])
    text = stated(written(vibration, "J", 5), vibration, 5, errors.get("energy", 0.0), "J")
    rows.append((f"energy in vibration {after}", text))
    rows.append(("method", known["method"]))
    return rows
