"""What is known of a solution before `picture` makes texts of it: the same for every method.

Plain Python, which the page has as JavaScript. A system is that of the model or of `tables`.
"""

import math
from typing import Any

from ..methods.abilities import has_driven_end
from ..methods.groups import unilateral
from ..model.numbering import body_numbers, contact_names
from ..model.profiles import extremes
from ..results.outcome import effective_restitution, no_restitution
from ..units import format_si
from .texts import capital, name_of, written


def described(system: Any, found: Any) -> Any:
    """What `picture` shows of a solution.

    Parameters
    ----------
    system : System
    found : dict
        ``method``, ``notes``, and whether it is ``exact``; ``closed_form`` of e, or None;
        ``gauges``; ``outcome`` as of `outcome_told`; ``tiling``: polygons, or grids with
        ``across`` cells in a row; ``paths`` of bodies without inside, None of rods. Curves, tables
        of ``t``, s, and ``y``: ``force`` and ``gap`` of each of the ``contacts``, the gap None for
        a bond; ``records``, each with the ``name`` of its gauge. ``energy``: times ``t``, and
        energies by their names.
    """
    kinds, tiling = [body.kind for body in system.bodies], found["tiling"]
    numbers, names, energy = body_numbers(kinds), contact_names(kinds), found["energy"]
    return {
        "method": found["method"], "exact": found["exact"], "notes": found["notes"],
        "closed_form": found["closed_form"], "gauges": found["gauges"],
        "tiling": tiling, "outcome": found["outcome"],
        "bodies": [body_told(body, numbers[i], found["paths"][i])
                   for i, body in enumerate(system.bodies)],
        "contacts": [{
            "index": i, "name": names[i], "bonded": law.law == "bonded",
            "compliant": law.law not in ("rigid", "bonded"), **found["contacts"][i],
        } for i, law in enumerate(system.contacts)],
        "plots": [
            {"key": "energy", "title": "Energy", "unit": "J", "series": [
                {"name": name, "t": [*energy["t"]], "y": y}
                for name, y in energy.items() if name != "t"]},
            {"key": "gauge", "title": "Strain, below 0 compressed", "unit": "µε", "series": [
                {**record, "y": [1e6 * e for e in record["y"]]} for record in found["records"]]},
        ],
        "apart": apart_of(system, tiling), "strain": max([abs(e) for e in tiling["strain"]]),
        "slowest": slowest_of(system, found["outcome"]["before"]),
    }


def outcome_told(system: Any, found: Any) -> Any:
    """What the collision did, with e, or why there is none.

    Parameters
    ----------
    system : System
    found : dict
        Velocities ``before`` and ``after`` by body, ``contacts``: a ContactTally of each, whether
        it is ``final``, its ``status``, stated ``errors``, and energies.
    """
    able, before, after = unilateral(system), found["before"], found["after"]
    k, count = able[0] if len(able) > 0 else 0, len(able)
    episodes = found["contacts"][k].episodes if count == 1 else 0
    closing = before[k] - before[k + 1] if count == 1 else 0.0
    driven = has_driven_end(system) or system.gravity != 0
    why = no_restitution(count, driven, episodes, found["final"], closing, found["status"])
    e, error = math.nan, 0.0
    if why == "":
        e = effective_restitution(True, episodes, before[k : k + 2], after[k : k + 2]) + 0.0
        error = 2 * found["errors"]["velocity"] / closing
    contacts = [{
        "impulse": c.impulse, "peak_force": c.peak_force, "duration": c.duration,
        "episodes": c.episodes} for c in found["contacts"]]
    return {**found, "contacts": contacts, "able": able, "why": why, "restitution": e,
            "error": error}


def body_told(body: Any, number: str, path: Any) -> Any:
    """A body; `path` of one that has no inside, else None.

    Its ``approach`` is None unless all of it comes unstrained with one velocity.
    """
    rod, name = body.kind == "rod", name_of(body.kind, number)
    even = isinstance(body.velocity, float) and (not rod or body.strain == 0.0)
    pieces = body.segments if rod else []
    return {
        "kind": body.kind, "name": name, "path": path,
        "title": capital(number if number == "wall" else name),
        "mass": 0.0 if body.kind == "wall" else body.mass,
        "approach": body.velocity if even else None,
        "pieces": [{
            "length": piece.length, "area": extremes(piece.area)[1], "mass": piece.mass,
            "wave_speed": piece.wave_speed, "transit_time": piece.transit_time,
            "impedance": piece.material.density * piece.wave_speed * extremes(piece.area)[1],
        } for piece in pieces],
        "derived": [derived_of(piece) for piece in pieces],
    }


def derived_of(piece: Any) -> Any:
    """What follows for a segment."""
    factor = piece.material.density * piece.wave_speed
    low, high = [f"{area * factor:.4g}" for area in extremes(piece.area)]
    return [
        ("bar speed c", f"{piece.wave_speed:.4g} m/s"),
        ("impedance Z", f"{low if low == high else f'{low} to {high}'} kg/s"),
        ("transit time T", written(piece.transit_time, "s", 5)), ("mass m", f"{piece.mass:.4g} kg"),
    ]


def apart_of(system: Any, tiling: Any) -> list[float]:
    """How far to the right of its place in a row without gaps and strain each body begins, m."""
    apart, found = 0.0, []
    for i in range(len(system.bodies)):
        apart += system.gaps[i - 1] if i > 0 else 0.0
        found.append(apart)
        end, longer = 0.0, 0.0  # how far its right end is displaced at t = 0
        for g, body in enumerate(tiling["body"]):
            for k in range(tiling["start"][g], tiling["start"][g + 1]):
                if body == i and tiling["t"][k] == 0 and tiling["x"][k] > end:
                    end, longer = tiling["x"][k], tiling["displacement"][k]
        apart += longer
    return found


def slowest_of(system: Any, before: list[float]) -> float:
    """Velocity of a wall, 0 if an end is held, else the least of the bodies' velocities."""
    held = [body.velocity for body in system.bodies if body.kind == "wall"]
    held.extend([0.0 for end in system.ends if end.kind in ("fixed", "velocity")])
    slowest = math.inf
    for v in held if len(held) > 0 else before:
        slowest = v if abs(v) < abs(slowest) else slowest
    return slowest


def gauge_of(system: Any, gauge: Any) -> Any:
    """Segment of a gauge in its rod, place in that, m, and its name."""
    segments, s = system.bodies[gauge["body"]].segments, 0
    x = gauge["fraction"] * sum(piece.length for piece in segments)
    number = body_numbers([body.kind for body in system.bodies])[gauge["body"]]
    name = f"rod {number} at {format_si(x, 'm', 4)}"
    while s < len(segments) - 1 and x >= segments[s].length:
        x -= segments[s].length
        s += 1
    return s, x, name
