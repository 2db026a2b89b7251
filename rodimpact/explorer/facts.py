"""Facts of a row and of its collision, from which `picture` makes texts.

They are the same for every method. Begin with `facts_of_outcome` and `facts_of_body`. A
system is one of the model or of `tables`. The page has these functions as JavaScript.
"""

import math
from typing import Any, NamedTuple

from ..methods.abilities import has_external_drive
from ..methods.groups import unilateral
from ..methods.outcome import Motion
from ..methods.pieces.accuracy import max_abs
from ..methods.restitution import effective_restitution, no_restitution
from ..model.numbering import body_numbers
from ..model.profiles import extremes
from ..units import format_si
from .texts import capital, format_quantity, name_of


class RunSummary(NamedTuple):
    """Results of a run besides the motion of its bodies."""

    contacts: Any  # [contact] list of ContactTally
    final: bool  # whether the collision is over for good
    status: str  # why the run ended
    errors: Any  # stated errors by kind of number, in its unit


class GaugeLocation(NamedTuple):
    """Position and name of a gauge."""

    segment: int  # index of its segment in the rod
    x: float  # distance from the left end of that segment, m
    name: str  # the gauge in words


# Outcome ------------------------------------------------------------------------------


def facts_of_outcome(
    system: Any, before: Motion, after: Motion, summary: RunSummary
) -> Any:
    """The outcome of a collision with e, or with the reason why there is no e.

    Returns
    -------
    dict
        Velocities ``before`` and ``after`` of the bodies, m/s; the entries of the
        `summary`; ``energy_before``, kinetic energy and strain energy, and
        ``vibration_after``, J; ``unilateral``, the indices of the contacts that can
        open; ``restitution`` e, or None, with its stated ``error``; and ``why`` there
        is no e, "" if there is.
    """
    can_open = unilateral(system)
    why = no_restitution(
        can_open,
        before.velocities,
        summary.contacts,
        has_external_drive(system),
        summary.final,
        summary.status,
    )
    restitution = None
    error = 0.0
    if why == "":
        # e = (V2 - V1)/(v1 - v2): both V have an error, the v are given.
        k = can_open[0]
        pair_before = before.velocities[k : k + 2]
        pair_after = after.velocities[k : k + 2]
        closing = pair_before[0] - pair_before[1]
        # There is an e, so that the collision is final and the contact has pressed.
        is_final = True
        episodes = 1
        e = effective_restitution(is_final, episodes, pair_before, pair_after)
        restitution = e + 0.0  # adding 0 makes 0 of -0
        error = 2 * summary.errors["velocity"] / closing
    return {
        "before": before.velocities,
        "after": after.velocities,
        "contacts": summary.contacts,
        "final": summary.final,
        "status": summary.status,
        "errors": summary.errors,
        "energy_before": before.kinetic + sum(before.vibration),
        "vibration_after": sum(after.vibration),
        "unilateral": can_open,
        "why": why,
        "restitution": restitution,
        "error": error,
    }


def errors_of(relative: list[float], speed: float, contacts: list[Any]) -> Any:
    """Stated errors of velocities, impulses, peak forces and durations, in SI units.

    They are by name: ``velocity``, ``impulse``, ``peak_force`` and ``duration``. Each
    is the relative error times the scale of the velocities, or times the largest
    impulse, peak force or duration of all contacts.

    Parameters
    ----------
    relative : list of float
        Relative errors of these four numbers, in this order; further ones are ignored.
    speed : float
        Scale of the velocities, m/s.
    contacts : list of ContactTally
    """
    impulses = []
    peak_forces = []
    durations = []
    for contact in contacts:
        impulses.append(contact.impulse)
        peak_forces.append(contact.peak_force)
        durations.append(contact.duration)
    return {
        "velocity": relative[0] * speed,
        "impulse": relative[1] * max_abs(impulses),
        "peak_force": relative[2] * max_abs(peak_forces),
        "duration": relative[3] * max_abs(durations),
    }


# Bodies -------------------------------------------------------------------------------


def facts_of_body(body: Any, number: str, path: Any) -> Any:
    """Facts of a body: names, mass, segments, and quantities that follow from them.

    The mass of a wall counts as 0. A wall and a mass have no segments. ``approach`` is
    the initial velocity of the body, m/s, or None if it is strained or has several
    velocities. ``derived`` has the `derived_quantities` of each segment.

    Parameters
    ----------
    body : Body
    number : str
        Its number from the left, or "wall".
    path : dict or None
        Displacement over time of a mass or a wall, from `motion.path_of`.
    """
    name = name_of(body.kind, number)
    title = capital(name)
    mass = body.mass
    if body.kind == "wall":
        title = capital(number)
        mass = 0.0
    segments = []
    derived = []
    if body.kind == "rod":
        for segment in body.segments:
            segments.append(facts_of_segment(segment))
            derived.append(derived_quantities(segment))
    approach = None
    is_unstrained = body.kind != "rod" or body.strain == 0.0
    if isinstance(body.velocity, float) and is_unstrained:
        approach = body.velocity
    return {
        "kind": body.kind,
        "number": number,
        "name": name,
        "path": path,
        "title": title,
        "mass": mass,
        "approach": approach,
        "segments": segments,
        "derived": derived,
    }


def facts_of_segment(segment: Any) -> Any:
    """Numbers of a segment by name, SI; the largest area and impedance if it tapers."""
    area = extremes(segment.area)[1]  # the largest
    density = segment.material.density
    return {
        "length": segment.length,
        "area": area,
        "mass": segment.mass,
        "wave_speed": segment.wave_speed,
        "transit_time": segment.transit_time,
        "impedance": density * segment.wave_speed * area,
    }


def derived_quantities(segment: Any) -> Any:
    """Pairs of name and text: bar speed, impedance, transit time, mass of a segment.

    The impedance of a tapered segment is a range.
    """
    impedance_by_area = segment.material.density * segment.wave_speed  # Z/A = rho c
    smallest, largest = extremes(segment.area)
    impedance = f"{smallest * impedance_by_area:.4g}"
    largest_impedance = f"{largest * impedance_by_area:.4g}"
    if impedance != largest_impedance:
        impedance = f"{impedance} to {largest_impedance}"
    return [
        ("bar speed c", f"{segment.wave_speed:.4g} m/s"),
        ("impedance Z", f"{impedance} kg/s"),
        ("transit time T", format_quantity(segment.transit_time, "s", 5)),
        ("mass m", f"{segment.mass:.4g} kg"),
    ]


# Layout -------------------------------------------------------------------------------


def initial_offsets(system: Any, tiling: Any) -> list[float]:
    """Initial offset of the left end of each body from its material coordinate, m.

    It is the sum of the gaps to its left and of the `initial_elongation` of the bodies
    to its left; that of the first body is 0.
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
    """Displacement of the right end of body i at t = 0, m, from its initial strain.

    The right end is the point of the tiling of the body with the largest x at t = 0. A
    body that is not in the tiling, a mass or a wall, has 0.
    """
    right_end = 0.0
    elongation = 0.0
    for g, body in enumerate(tiling["body"]):
        if body == i:  # grid or polygon g, with the points k
            for k in range(tiling["start"][g], tiling["start"][g + 1]):
                if tiling["t"][k] == 0 and tiling["x"][k] > right_end:
                    right_end = tiling["x"][k]
                    elongation = tiling["displacement"][k]
    return elongation


def slowest_velocity(system: Any, before: list[float]) -> float:
    """Velocity of smallest magnitude among walls and held ends, m/s.

    A held end, fixed or driven at a velocity, counts as at rest. Without walls and held
    ends it is the velocity of smallest magnitude among the bodies. Of equal magnitudes
    the first counts.

    Parameters
    ----------
    system : System
    before : list of float
        Velocities of the bodies before the collision, m/s.
    """
    velocities = []
    for body in system.bodies:
        if body.kind == "wall":
            velocities.append(body.velocity)
    for end in system.ends:
        if end.kind in ("fixed", "moved"):
            velocities.append(0.0)
    if len(velocities) == 0:
        velocities = before
    slowest = math.inf
    for velocity in velocities:
        if abs(velocity) < abs(slowest):
            slowest = velocity
    return slowest


def locate_gauge(system: Any, gauge: Any) -> GaugeLocation:
    """Segment of a gauge, its position in the segment, and its name.

    The name is such as "rod 2 at 0.5 m", counted from the left end of the rod. A gauge
    where two segments meet is in the right one.

    Parameters
    ----------
    system : System
    gauge : dict
        The index ``body`` of its rod, and its position as a ``fraction`` of the length.
    """
    segments = system.bodies[gauge["body"]].segments
    number = body_numbers([body.kind for body in system.bodies])[gauge["body"]]
    length = 0.0
    for segment in segments:
        length += segment.length
    x = gauge["fraction"] * length  # from the left end of the rod
    name = f"rod {number} at {format_si(x, 'm', 4)}"
    s = 0
    # From here on x counts from the left end of segment s.
    while s < len(segments) - 1 and x >= segments[s].length:
        x -= segments[s].length
        s += 1
    return GaugeLocation(s, x, name)
