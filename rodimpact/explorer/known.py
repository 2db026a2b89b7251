"""What is known of a solution before `picture` makes texts of it: the same for every method.

Plain Python, which the page has as JavaScript. A system is that of the model or of `tables`.
"""

from __future__ import annotations

import math
from typing import Any

from ..methods.abilities import has_driven_end
from ..methods.groups import unilateral
from ..model.numbering import body_numbers, contact_names
from ..model.profiles import extremes
from ..results.outcome import effective_restitution, no_restitution
from ..units import format_si


def described(system: Any, paths: Any, positions: Any, polygons: Any, outcome: Any) -> Any:
    """What `picture` asks of a solution beside its curves and its notes.

    Parameters
    ----------
    system : System
    paths : list
        How bodies without inside move, by body; None for rods.
    positions : list of float
        Where the left end of each body lies at t = 0, m.
    polygons : dict
    outcome : dict
        As `outcome_told` makes it.
    """
    strain = 0.0
    for e in polygons["strain"]:
        strain = max(strain, abs(e))
    return {
        "bodies": [body_told(body, paths[i]) for i, body in enumerate(system.bodies)],
        "positions": positions, "polygons": polygons, "strain": strain,
        "slowest": slowest_of(system, outcome["before"]), "outcome": outcome, "curve": None,
        "contacts": [{"index": i, "bonded": law.law == "bonded",
                      "compliant": law.law not in ("rigid", "bonded")}
                     for i, law in enumerate(system.contacts)],
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


def body_told(body: Any, path: Any) -> Any:
    """A body; `path` of one that has no inside, else None."""
    speed = body.velocity if isinstance(body.velocity, float) else None
    rod = body.kind == "rod"
    return {
        "kind": body.kind, "velocity": speed, "path": path,
        "mass": 0.0 if body.kind == "wall" else body.mass,
        "approach": speed if not rod or body.strain == 0.0 else None,
        "pieces": [{
            "length": piece.length, "areas": extremes(piece.area),
            "material": piece.material.name, "density": piece.material.density,
            "wave_speed": piece.wave_speed, "transit_time": piece.transit_time, "mass": piece.mass,
        } for piece in (body.segments if rod else [])],
    }


def positions_of(system: Any, lengths: Any) -> list[float]:
    """Where the left end of each body lies at t = 0, m; `lengths` of bodies are strained."""
    place, positions = 0.0, []
    for i, length in enumerate(lengths):
        place += system.gaps[i - 1] if i > 0 else 0.0
        positions.append(place)
        place += length
    return positions


def slowest_of(system: Any, before: list[float]) -> float:
    """Velocity of a wall, 0 if an end is held, else the least of the bodies' velocities."""
    held = [body.velocity for body in system.bodies if body.kind == "wall"]
    held.extend([0.0 for end in system.ends if end.kind in ("fixed", "velocity")])
    slowest = math.inf
    for v in held if len(held) > 0 else before:
        slowest = v if abs(v) < abs(slowest) else slowest
    return slowest


# Curves -------------------------------------------------------------------------------------------


def series_of(name: str, t: list[float], y: list[float]) -> Any:
    """A curve over time, of straight lines; where it jumps, it has two values at one time."""
    return {"name": name, "t": [*t], "y": y}


def curves_of(system: Any, contacts: Any, energy: Any, gauges: Any) -> Any:
    """The figures: force, gap, energy, gauges.

    Parameters
    ----------
    system : System
    contacts : list of dict
        Of each contact `force` and `gap`, pairs of times and values; `gap` None for a bond.
    energy : dict
        Times ``t``, and energies by their names.
    gauges : list
        Name of each gauge, times and strains.
    """
    names = [f"contact {name}" for name in contact_names([body.kind for body in system.bodies])]
    title = "Gap"
    if any(law.law not in ("rigid", "bonded", "joint") for law in system.contacts):
        title = "Gap, below 0 overlap"
    if any(law.law == "joint" for law in system.contacts):
        title = f"{title}, or stretch of joints"
    forces, gaps = [], []
    for i, curve in enumerate(contacts):
        forces.append(series_of(names[i], curve["force"][0], curve["force"][1]))
        if curve["gap"] is not None:
            gaps.append(series_of(names[i], curve["gap"][0], curve["gap"][1]))
    energies = [series_of(name, energy["t"], values)
                for name, values in energy.items() if name != "t"]
    strains = [series_of(name, t, [1e6 * e for e in strain]) for name, t, strain in gauges]
    return [{"key": key, "title": title, "unit": unit, "series": series}
            for key, title, unit, series in (
                ("force", "Contact force", "N", forces), ("gap", title, "m", gaps),
                ("energy", "Energy", "J", energies),
                ("gauge", "Strain, below 0 compressed", "µε", strains))]


def gauge_of(system: Any, gauge: Any) -> Any:
    """Segment of a gauge in its rod, place in that, m, and its name."""
    segments, x, s = system.bodies[gauge["body"]].segments, 0.0, 0
    for piece in segments:
        x += gauge["fraction"] * piece.length
    number = body_numbers([body.kind for body in system.bodies])[gauge["body"]]
    name = f"rod {number} at {format_si(x, 'm', 4)}"
    while s < len(segments) - 1 and x >= segments[s].length:
        x -= segments[s].length
        s += 1
    return s, x, name
