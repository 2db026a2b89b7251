"""Solution -> all that the page shows: polygons, curves and texts, ready for JSON.

Polygons cut at time t are the rods at time t, so the page slices them and needs no physics.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ..methods.signals import Floats
from ..model import Bonded, Rigid, RigidMass, Rod, Wall
from ..model.frozen import InvalidModel
from ..model.profiles import extremes
from ..results.closed_forms import ClosedForm, closed_form
from ..results.contacts import ContactHistory
from ..results.placing import Placing, placing
from ..results.regions import Regions, nothing_to_draw, readable_until, regions_of
from ..results.solution import Solution
from ..storage.tables import clean
from ..units import format_si
from .comparison import Curve, closed_curve, ratio_of
from .design import Design
from .tiling import cells, sliced_energy

REGIONS = 3000  # at most, where they are exact
SAMPLES = 400  # of a curve whose jumps are too many
MOMENTS = 33  # of the energy, where it is sampled
DIGITS = 9  # of the numbers that are drawn

Scene = dict[str, Any]
Labelled = list[tuple[str, str]]


def scene(design: Design, solution: Solution, as_asked: bool = False) -> Scene:
    """All that the page shows of a solution.

    Parameters
    ----------
    design : Design
    solution : Solution
        Of this design.
    as_asked : bool
        Whether it was solved as the case asks, not on a time step or cells of the page's own.

    Returns
    -------
    dict
        JSON-ready, SI units but for strain in 1e-6; numbers that do not exist are None.

    Raises
    ------
    InvalidModel
        If the solution lasts no time.
    """
    if reason := nothing_to_draw(solution):
        raise InvalidModel([("solve", reason)])
    stop, exact = solution.t_end, solution.method == "fronts"
    try:
        stop = readable_until(solution, REGIONS) if exact else stop
    except ValueError:  # too many from the start
        exact = False
    tiling = regions_of(solution, stop=stop) if exact else cells(solution)
    notes = [solution.status]
    if stop < solution.t_end:
        notes.append(f"The picture ends at {format_si(stop, 's', 4)}: too many regions later.")
    if not exact:
        notes.append("The picture shows means over cells, not the fronts themselves.")
    if solution.method != "fronts" and not as_asked:
        notes.append("Solved quickly, on a coarse time step; rodimpact run is more accurate.")
    plan = placing(solution, 0.0, stop)
    drawn = _tiling(tiling)
    theory = closed_form(solution.system)
    return {
        "end": max(drawn["t"]),  # as rounded there: a moment later no polygon is left to cut
        "exact": exact,
        "row": _row(plan, tiling, stop),
        "bodies": _bodies(plan, stop),
        "tiling": drawn,
        "plots": [
            *_contacts(solution, stop, exact),
            _energy(solution, stop, tiling, exact),
            *_gauges(design, solution, stop, exact),
        ],
        "contacts": [
            {"index": c.index, "bonded": isinstance(c.law, Bonded),
             "compliant": not isinstance(c.law, Rigid | Bonded)}
            for c in solution.contacts
        ],
        "gauges": [gauge._asdict() for gauge in design.case.gauges],
        "restitution": _restitution(solution, theory),
        "curve": curve_dict(closed_curve(solution.system, theory)),
        "ratio": ratio_of(solution.system),
        "results": _results(solution),
        "notes": notes,
    }


def _tiling(tiling: Regions) -> Scene:
    """The polygons for JSON."""
    return {
        "body": tiling.body.tolist(),
        "start": tiling.start.tolist(),
        "x": _short(tiling.x), "t": _short(tiling.t),
        "displacement": _short(tiling.displacement),
        "velocity": _short(tiling.velocity), "stress": _short(tiling.stress),
    }


def curve_dict(curve: Curve | None) -> Scene | None:
    """A curve for JSON."""
    if curve is None:
        return None
    values = [None if math.isnan(e) else e for e in curve.values]
    return {"ratios": curve.ratios, "values": values, "source": curve.source}


# The row ------------------------------------------------------------------------------------------


def _row(plan: Placing, tiling: Regions, stop: float) -> Scene:
    """How the row is laid out: X = left + x + magnification * (apart + displacement - frame t)."""
    times = np.linspace(0.0, stop, SAMPLES)
    shown = [plan.place(tiling.body_of_vertices(), tiling.x, tiling.t, tiling.displacement)]
    shown += [
        plan.end(i, right, times) for i, body in enumerate(plan.solution.system.bodies)
        if not isinstance(body, Rod) for right in (False, True)
    ]
    note = plan.scale
    if plan.frame:
        note += f", frame moving at {format_si(plan.frame, 'm/s', 4)}"
    return {
        "left": _short(plan.left), "apart": _short(plan.apart),
        "magnification": plan.magnification, "frame": plan.frame, "note": note,
        "span": [min(float(x.min()) for x in shown), max(float(x.max()) for x in shown)],
    }


def _bodies(plan: Placing, stop: float) -> list[Scene]:
    """What each body is, and how those without inside move."""
    bodies, entries = plan.solution.system.bodies, []
    for i, (kind, body) in enumerate(zip(plan.solution.outcome.bodies, bodies, strict=True)):
        pieces = body.segments if isinstance(body, Rod) else ()
        given = [item for j, piece in enumerate(pieces) for item in _given(j, len(pieces), piece)]
        if isinstance(body, RigidMass):
            given.append(("mass", format_si(float(body.mass), "kg")))
        speed = body.velocity
        text = format_si(speed, "m/s") if isinstance(speed, float) else "a profile"
        entries.append({
            "kind": kind, "title": f"{kind.capitalize()} {i}", "width": plan.width(i),
            "given": [*given, ("velocity", text)], "derived": [_derived(p) for p in pieces],
            "path": None if pieces else _path(plan.solution, i, stop),
            "approach": _approach(body),
        })
    return entries


def _approach(body: Any) -> float | None:
    """Velocity with which all of a body comes, unstrained; None if its parts differ."""
    whole = isinstance(body.velocity, float) and getattr(body, "strain", 0.0) == 0.0
    return body.velocity if whole else None


def _path(solution: Solution, body: int, stop: float) -> Scene:
    """Times and displacements of a wall or a mass."""
    straight = isinstance(solution.system.bodies[body], Wall)
    times = np.linspace(0.0, stop, 2 if straight else SAMPLES)
    return {"t": _short(times), "displacement": _short(solution.displacement(body, 0.0, times))}


def _given(j: int, count: int, piece: Any) -> Labelled:
    """What is given of a segment."""
    where = f" of segment {j}" if count > 1 else ""
    return [
        (f"length{where}", format_si(float(piece.length), "m")),
        (f"area{where}", f"{_range(extremes(piece.area), 1e4, 6)} cm²"),
        (f"material{where}", piece.material.name),
    ]


def _derived(piece: Any) -> Labelled:
    """What follows for a segment."""
    per_area = float(piece.material.density) * float(piece.wave_speed)
    return [
        ("bar speed c", f"{float(piece.wave_speed):.4g} m/s"),
        ("impedance Z", f"{_range(extremes(piece.area), per_area, 4)} kg/s"),
        ("transit time T", _text(float(piece.transit_time), "s")),
        ("mass m", f"{float(piece.mass):.4g} kg"),
    ]


def _range(values: list[float], factor: float, digits: int) -> str:
    """A number, or from the smallest to the largest."""
    low, high = (f"{v * factor:.{digits}g}" for v in values)
    return low if low == high else f"{low} to {high}"


# Curves -------------------------------------------------------------------------------------------


def _plot(key: str, title: str, unit: str, series: list[Scene]) -> Scene:
    return {"key": key, "title": title, "unit": unit, "series": series}


def _series(name: str, t: Any, y: Any, steps: bool = False) -> Scene:
    """A curve over time; with `steps` each value holds until the next time."""
    return {"name": name, "t": _short(t), "y": _short(y), "steps": steps}


def _contacts(solution: Solution, stop: float, exact: bool) -> list[Scene]:
    """Force and gap of the contacts that can open, of bonded ones the force."""
    forces, gaps = [], []
    for contact in solution.contacts:
        name = f"contact {contact.index}-{contact.index + 1}"
        times, force = _record(
            *contact.breakpoints()[:2], stop, exact, partial(_mean_force, contact))
        forces.append(_series(name, times, force, steps=True))
        if not isinstance(contact.law, Bonded):
            gaps.append(_series(name, times, contact.gap(times)))
    plots = [_plot("force", "Contact force", "N", forces)] if forces else []
    compliant = any(not isinstance(c.law, Rigid | Bonded) for c in solution.contacts)
    title = "Gap, below 0 indentation" if compliant else "Gap"
    return plots + ([_plot("gap", title, "m", gaps)] if gaps else [])


def _record(
    times: Floats, values: Floats, stop: float, exact: bool, sampled: Callable[[Floats], Floats]
) -> tuple[Floats, Floats]:
    """The steps of a record up to `stop`; samples if they are too many, or no steps."""
    inside = times < stop
    if exact and inside.sum() <= SAMPLES:
        last = values[inside][-1:]
        return np.append(times[inside], stop), np.append(values[inside], last)
    even = np.linspace(0.0, stop, SAMPLES + 1)
    return even, sampled(even)


def _mean_force(contact: ContactHistory, times: Floats) -> Floats:
    """Mean force from each time to the next; the last one again at the end."""
    mean = np.diff(contact.impulse_until(times)) / np.diff(times)
    return np.append(mean, mean[-1])


def _energy(solution: Solution, stop: float, tiling: Regions, exact: bool) -> Scene:
    """Energy by kind."""
    if exact:
        times, kinds = sliced_energy(solution, tiling)
    else:
        times = np.linspace(0.0, stop, MOMENTS)
        e = solution.energy(times)
        kinds = {
            "moving as a whole": e.kinetic, "vibration": e.vibrational_kinetic, "strain": e.strain,
            "in contacts": e.contact, "lost in material": e.damped, "total": e.total,
        }
    rare = ("in contacts", "lost in material")
    series = [_series(name, times, y) for name, y in kinds.items() if name not in rare or y.any()]
    return _plot("energy", "Energy", "J", series)


def _gauges(design: Design, solution: Solution, stop: float, exact: bool) -> list[Scene]:
    series = []
    for body, fraction in design.case.gauges:
        x = fraction * float(solution.fields.edges(body)[-1])
        record = solution.gauge(body, x)
        name = f"rod {body} at {format_si(x, 'm', 4)}"
        times, strain = _record(record.times, record.strain, stop, exact, record.strain_at)
        series.append(_series(name, times, 1e6 * strain, steps=True))
    return [_plot("gauge", "Strain gauges", "µε", series)] if series else []


# Numbers ------------------------------------------------------------------------------------------


def _restitution(solution: Solution, theory: ClosedForm | None) -> Scene:
    """e beside its closed form."""
    why = solution.outcome.why_no_restitution()
    value = None if why else float(solution.outcome.restitution)
    count = len(solution.outcome.unilateral)
    if count > 1:
        why = f"A coefficient e belongs to one contact; this row has {count}, see the velocities"
    closed = None if theory is None else float(theory.collision().restitution)
    digits = 9 if solution.method == "fronts" else 5
    entry: Scene = {
        "value": value, "text": "-" if value is None else f"{clean(value, 1.0):.{digits}g}",
        "why": why[:1].upper() + why[1:], "closed_form": closed,
        "source": "" if theory is None else theory.source,
    }
    if closed is not None:
        entry["closed_text"] = f"{closed:.9g}"
        if value is not None:
            entry["difference"] = f"{abs(value - closed):.1g}"
    return entry


def _results(solution: Solution) -> Labelled:
    """What the collision did, in words and numbers."""
    o = solution.outcome
    fastest = max(map(abs, [*o.velocities_before, *o.velocities_after]))
    after = "after" if o.final else "at the end"
    digits = 6 if solution.method == "fronts" else 4
    rows: Labelled = [
        (f"velocity of {kind} {i} {after}", f"{clean(v, fastest):.{digits}g} m/s")
        for i, (kind, v) in enumerate(zip(o.bodies, o.velocities_after, strict=True))
        if kind != "wall"
    ]
    for i in o.unilateral:
        c, name = o.contacts[i], f" {i}-{i + 1}" if len(o.unilateral) > 1 else ""
        rows += [
            (f"impulse{name}", _text(c.impulse, "N s")),
            (f"largest force{name}", _text(c.peak_force, "N")),
            (f"time under force{name}", _text(c.duration, "s")),
        ]
    kinetic = o.kinetic_before + sum(o.vibration_before)
    rows.append(("energy before", _text(kinetic, "J")))
    vibration = clean(sum(o.vibration_after), kinetic)
    rows.append((f"energy in vibration {after}", _text(vibration, "J")))
    rows.append(("method", solution.method))
    return rows


def _text(value: float, unit: str) -> str:
    """A quantity for people, to five digits, with a µ."""
    number, _, prefixed = format_si(value, unit, 5).partition(" ")
    return f"{number} {'µ' + prefixed[1:] if prefixed.startswith('u') else prefixed}".strip()


def _short(values: Any) -> list[float]:
    """Numbers to draw, with as many digits as a picture can use."""
    return [float(f"{v:.{DIGITS}g}") for v in np.asarray(values).ravel().tolist()]
