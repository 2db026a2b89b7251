"""Facts of a row and its collision, from which `picture` makes texts.

They are the same for every method. A system is one of the model or of `tables`. The
page has these functions as JavaScript.
"""

import math
from typing import Any, NamedTuple

from ..methods.abilities import has_external_drive
from ..methods.groups import unilateral
from ..methods.outcome import Motion
from ..methods.pieces.accuracy import size_of
from ..methods.restitution import effective_restitution, no_restitution
from ..model.numbering import body_numbers
from ..model.profiles import extremes
from ..units import format_si
from .texts import capital, name_of, written


class Ending(NamedTuple):
    """How a run ended: totals of the contacts, whether it is final, why it ended, stated errors."""

    contacts: Any  # [contact] list of ContactTally
    final: bool
    status: str
    errors: Any  # by kind of number, in its unit


def outcome_shown(system: Any, before: Motion, after: Motion, ending: Ending) -> Any:
    """What the collision did, with e, or the reason why there is none: then e is None.

    Returns
    -------
    dict
        Velocities ``before`` and ``after`` by body, the entries of the `ending`, energies,
        ``unilateral``: contacts that can open, ``restitution`` with its ``error``, and ``why``
        there is none.
    """
    contacts_that_open = unilateral(system)
    why = no_restitution(
        contacts_that_open,
        before.velocities,
        ending.contacts,
        has_external_drive(system),
        ending.final,
        ending.status,
    )
    restitution = None
    error = 0.0
    if why == "":
        k = contacts_that_open[0]
        closing = before.velocities[k : k + 2]
        parting = after.velocities[k : k + 2]
        restitution = effective_restitution(True, 1, closing, parting) + 0.0
        error = 2 * ending.errors["velocity"] / (closing[0] - closing[1])
    return {
        "before": before.velocities,
        "after": after.velocities,
        "contacts": ending.contacts,
        "final": ending.final,
        "status": ending.status,
        "errors": ending.errors,
        "energy_before": before.kinetic + sum(before.vibration),
        "vibration_after": sum(after.vibration),
        "unilateral": contacts_that_open,
        "why": why,
        "restitution": restitution,
        "error": error,
    }


def errors_of(relative: list[float], speed: float, contacts: list[Any]) -> Any:
    """Stated error of each kind of number, in its unit.

    Parameters
    ----------
    relative : list of float
        Those of velocities, impulses, peak forces and durations.
    speed : float
        Scale of the velocities, m/s.
    contacts : list of ContactTally
    """
    return {
        "velocity": relative[0] * speed,
        "impulse": relative[1] * size_of([c.impulse for c in contacts]),
        "peak_force": relative[2] * size_of([c.peak_force for c in contacts]),
        "duration": relative[3] * size_of([c.duration for c in contacts]),
    }


def body_told(body: Any, number: str, path: Any) -> Any:
    """A body; `path` of one that has no inside, else None.

    Its ``approach`` is None unless all of it comes unstrained with one velocity.
    """
    rod, name = body.kind == "rod", name_of(body.kind, number)
    even = isinstance(body.velocity, float) and (not rod or body.strain == 0.0)
    pieces = body.segments if rod else []
    return {
        "kind": body.kind,
        "name": name,
        "path": path,
        "title": capital(number if number == "wall" else name),
        "mass": 0.0 if body.kind == "wall" else body.mass,
        "approach": body.velocity if even else None,
        "pieces": [
            {
                "length": piece.length,
                "area": extremes(piece.area)[1],
                "mass": piece.mass,
                "wave_speed": piece.wave_speed,
                "transit_time": piece.transit_time,
                "impedance": piece.material.density
                * piece.wave_speed
                * extremes(piece.area)[1],
            }
            for piece in pieces
        ],
        "derived": [derived_of(piece) for piece in pieces],
    }


def derived_of(piece: Any) -> Any:
    """What follows for a segment."""
    factor = piece.material.density * piece.wave_speed
    low, high = [f"{area * factor:.4g}" for area in extremes(piece.area)]
    return [
        ("bar speed c", f"{piece.wave_speed:.4g} m/s"),
        ("impedance Z", f"{low if low == high else f'{low} to {high}'} kg/s"),
        ("transit time T", written(piece.transit_time, "s", 5)),
        ("mass m", f"{piece.mass:.4g} kg"),
    ]


def initial_offsets(system: Any, tiling: Any) -> list[float]:
    """Initial offset of the left end of each body from its material coordinate, m.

    It comes from the gaps and the initial strain on its left.
    """
    offset = 0.0
    offsets = []
    for i in range(len(system.bodies)):
        if i > 0:
            offset += system.gaps[i - 1]
        offsets.append(offset)
        offset += initial_elongation(tiling, i)
    return offsets


def initial_elongation(tiling: Any, i: int) -> float:
    """Displacement of the right end of a body at t = 0, m."""
    right_end = 0.0
    elongation = 0.0
    for g, body in enumerate(tiling["body"]):
        if body == i:
            for k in range(tiling["start"][g], tiling["start"][g + 1]):
                if tiling["t"][k] == 0 and tiling["x"][k] > right_end:
                    right_end = tiling["x"][k]
                    elongation = tiling["displacement"][k]
    return elongation


def slowest_of(system: Any, before: list[float]) -> float:
    """Velocity of a wall, 0 if an end is held, else the slowest body's velocity."""
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
