"""Samples of a solution, for `picture`, where the page cannot solve by itself."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..methods.signals import Floats
from ..model import Bonded, Fixed, Joint, Moved, Rigid, Rod, Wall
from ..model.frozen import InvalidModel
from ..model.profiles import extremes
from ..results.contacts import ContactHistory
from ..results.pair_theory import pair_theory
from ..results.regions import nothing_to_draw
from ..results.solution import Solution
from ..storage.casefile import Case
from ..storage.report import ENERGIES
from ..units import format_si
from .fronts import plot_of, series_of
from .picture import picture
from .texts import contacts_of, numbers_of
from .tiling import grids

SAMPLES = 400  # of a curve
MOMENTS = 101  # of the energy
DIGITS = 5  # of the numbers that are drawn; four are read off

Scene = dict[str, Any]


def scene(case: Case, solution: Solution) -> Scene:
    """All that the page shows of a solution.

    Parameters
    ----------
    case : Case
        With its gauges.
    solution : Solution
        Of this case.

    Returns
    -------
    dict
        As `picture` makes it.

    Raises
    ------
    InvalidModel
        If the solution lasts no time.
    """
    if reason := nothing_to_draw(solution):
        raise InvalidModel([("solve", reason)])
    tiling, o = grids(solution), solution.outcome
    notes = [solution.status, "The picture shows means over cells, not the fronts themselves."]
    system = solution.system
    held = [float(b.velocity) for b in system.bodies if isinstance(b, Wall)]
    held += [0.0 for end in system.ends if isinstance(end, Fixed | Moved)]
    why, theory, errors = o.why_no_restitution(), pair_theory(system), _errors(solution)
    error = 0.0
    if not why:
        left, right = o.velocities_before[o.unilateral[0]:][:2]
        error = 2 * errors["velocity"] / (left - right)
    closed = theory and {
        "restitution": float(theory.collision().restitution), "source": theory.source}
    return shortened(picture({
        "method": solution.method, "exact": False, "notes": notes, "closed_form": closed,
        "bodies": [_body(solution, i) for i in range(len(system.bodies))],
        "positions": solution.fields.positions, "polygons": tiling,
        "strain": max(map(abs, tiling.pop("strain"))),
        "slowest": min(held or o.velocities_before, key=abs),
        "plots": [*_contacts(solution), _energy(solution), _gauges(case, solution)],
        "contacts": [
            {"index": c.index, "bonded": isinstance(c.law, Bonded),
             "compliant": not isinstance(c.law, Rigid | Bonded)}
            for c in solution.contacts
        ],
        "gauges": [{"body": body, "fraction": at} for body, at, _ in case.gauges],
        "curve": None,
        "outcome": {
            "before": o.velocities_before, "after": o.velocities_after, "able": o.unilateral,
            "contacts": [tally._asdict() for tally in o.contacts], "final": o.final, "why": why,
            "restitution": None if why else o.restitution,
            "errors": errors, "error": error,
            "energy_before": o.kinetic_before + sum(o.vibration_before),
            "vibration_after": sum(o.vibration_after),
        },
    }))


def _errors(solution: Solution) -> dict[str, float]:
    """Stated error of each kind of number, in its unit."""
    o, own = solution.outcome, solution.accuracy
    speeds = (*o.velocities_before, *o.velocities_after)
    found = {"velocity": own.get("velocity", 0.0) * (max(speeds) - min(speeds))}
    for key in ("impulse", "peak_force", "duration"):
        known = [abs(v) for tally in o.contacts if (v := getattr(tally, key)) == v]
        found[key] = own.get(key.replace("_", " "), 0.0) * max(known, default=0.0)
    return found


def _body(solution: Solution, i: int) -> Scene:
    """What a body is, and how one without inside moves."""
    body: Any = solution.system.bodies[i]
    speed, path = body.velocity, None
    speed = speed if isinstance(speed, float) else None
    if not isinstance(body, Rod):
        times = np.linspace(0.0, solution.t_end, 2 if isinstance(body, Wall) else SAMPLES)
        moved = solution.displacement(i, 0.0, times)
        path = {"t": times.tolist(), "displacement": moved.tolist()}
    return {
        "kind": body.kind, "velocity": speed, "path": path, "mass": getattr(body, "mass", 0.0),
        "approach": speed if getattr(body, "strain", 0.0) == 0.0 else None,
        "pieces": [{
            "length": float(piece.length), "areas": extremes(piece.area),
            "material": piece.material.name, "density": float(piece.material.density),
            "wave_speed": float(piece.wave_speed), "transit_time": float(piece.transit_time),
            "mass": float(piece.mass),
        } for piece in getattr(body, "segments", ())],
    }


def _curve(name: str, t: Floats, y: Floats, steps: bool) -> Any:
    return series_of(name, t.tolist(), y.tolist(), steps)


def _kinds(solution: Solution) -> list[Scene]:
    """What bodies are, as `picture` names them."""
    return [{"kind": kind} for kind in solution.system.kinds]


def _contacts(solution: Solution) -> list[Scene]:
    """Force and gap of the contacts, stretch of joints, of bonded ones the force."""
    times, forces, gaps = np.linspace(0.0, solution.t_end, SAMPLES + 1), [], []
    names = contacts_of(_kinds(solution))
    for contact in solution.contacts:
        name = f"contact {names[contact.index]}"
        forces.append(_curve(name, times, _mean_force(contact, times), True))
        if not isinstance(contact.law, Bonded):
            gaps.append(_curve(name, times, contact.gap(times), False))
    laws = {type(c.law) for c in solution.contacts} - {Bonded}
    title = "Gap" if laws <= {Rigid, Joint} else "Gap, below 0 indentation"
    if Joint in laws:
        title = f"{title}, or stretch" if laws > {Joint} else "Stretch of joints"
    return [plot_of("force", "Contact force", "N", forces), plot_of("gap", title, "m", gaps)]


def _mean_force(contact: ContactHistory, times: Floats) -> Floats:
    """Mean force from each time to the next; the last one again at the end."""
    mean = np.diff(contact.impulse_until(times)) / np.diff(times)
    return np.append(mean, mean[-1])


def _energy(solution: Solution) -> Any:
    """Energy by kind."""
    times = np.linspace(0.0, solution.t_end, MOMENTS)
    e = solution.energy(times)
    always, rare = ("kinetic", "vibrational_kinetic", "strain"), ("contact", "damped")
    kinds = {ENERGIES[name]: getattr(e, name) for name in (*always, *rare)
             if name in always or getattr(e, name).any()}
    kinds["total"] = e.total
    series = [_curve(name, times, y, False) for name, y in kinds.items()]
    return plot_of("energy", "Energy", "J", series)


def _gauges(case: Case, solution: Solution) -> Any:
    times, series = np.linspace(0.0, solution.t_end, SAMPLES + 1), []
    for body, fraction, _ in case.gauges:
        x = fraction * float(solution.fields.edges(body)[-1])
        name = f"rod {numbers_of(_kinds(solution))[body]} at {format_si(x, 'm', 4)}"
        strain = solution.gauge(body, x).strain_at(times)
        series.append(_curve(name, times, 1e6 * strain, True))
    return plot_of("gauge", "Strain, below 0 compressed", "µε", series)


def shortened(found: Scene) -> Scene:
    """The scene with as many digits in what is drawn as a picture can use."""
    for table in (found["tiling"], *found["bodies"], *found["plots"]):
        table.update({key: _short(value) for key, value in table.items()})
    return {**found, "end": _short(found["end"])}  # no later than the polygons


def _short(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, dict):
        return {key: _short(item) for key, item in value.items()}
    return [*map(_short, value)] if isinstance(value, list | tuple) else value
