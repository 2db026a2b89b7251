"""Samples of a solution, for `picture`, where the page cannot solve by itself."""

from typing import Any

import numpy as np

from ..methods import run
from ..methods.signals import Floats
from ..model import Bonded
from ..model.frozen import InvalidModel
from ..results.contacts import ContactHistory
from ..results.pair_theory import pair_theory
from ..results.regions import nothing_to_draw
from ..results.solution import Solution
from ..storage.casefile import Case
from ..storage.report import ENERGIES
from .known import errors_of, gauge_of, outcome_told
from .picture import picture
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
    system, o, theory = solution.system, solution.outcome, pair_theory(solution.system)
    times = np.linspace(0.0, solution.t_end, SAMPLES + 1)
    contacts = [
        {
            "force": _mean_force(contact, times),
            "gap": None
            if isinstance(contact.law, Bonded)
            else _curve(times, contact.gap(times)),
        }
        for contact in solution.contacts
    ]
    records = []
    for body, fraction, _ in case.gauges:
        _, _, name = gauge_of(system, {"body": body, "fraction": fraction})
        x = fraction * float(solution.fields.edges(body)[-1])
        records.append(
            {"name": name, **_curve(times, solution.gauge(body, x).strain_at(times))}
        )
    relative = [solution.accuracy.get(name, 0.0) for name in run.MEASURES]
    speeds = [*o.velocities_before, *o.velocities_after]
    found: Scene = _short(
        picture(
            system,
            {
                "method": solution.method,
                "exact": False,
                "closed_form": theory
                and {
                    "restitution": float(theory.collision().restitution),
                    "source": theory.source,
                },
                "notes": [
                    solution.status,
                    "The picture shows means over cells, not the fronts themselves.",
                ],
                "gauges": [
                    {"body": body, "fraction": at} for body, at, _ in case.gauges
                ],
                "outcome": outcome_told(
                    system,
                    {
                        "before": o.velocities_before,
                        "after": o.velocities_after,
                        "contacts": o.contacts,
                        "final": o.final,
                        "status": o.status,
                        "errors": errors_of(
                            relative, max(speeds) - min(speeds), [*o.contacts]
                        ),
                        "energy_before": o.kinetic_before + sum(o.vibration_before),
                        "vibration_after": sum(o.vibration_after),
                    },
                ),
                "tiling": grids(solution),
                "contacts": contacts,
            },
            [_path(solution, i) for i in range(len(system.bodies))],
            records,
            _energy(solution),
        )
    )
    found["tiling"].pop("strain")
    return found


def _curve(times: Floats, values: Floats) -> dict[str, list[float]]:
    """A curve over time, of straight lines."""
    return {"t": times.tolist(), "y": values.tolist()}


def _path(solution: Solution, i: int) -> Any:
    """How a body without inside moves; None for a rod."""
    kind = solution.system.bodies[i].kind
    times = np.linspace(0.0, solution.t_end, 2 if kind == "wall" else SAMPLES)
    return (
        None
        if kind == "rod"
        else {
            "t": times.tolist(),
            "displacement": solution.displacement(i, 0.0, times).tolist(),
        }
    )


def _mean_force(contact: ContactHistory, times: Floats) -> dict[str, list[float]]:
    """Mean force between times that follow each other, at the middle between them."""
    mean, middles = (
        np.diff(contact.impulse_until(times)) / np.diff(times),
        times[1:] + times[:-1],
    )
    return _curve(middles / 2, mean)


def _energy(solution: Solution) -> Any:
    """Energy by kind."""
    times = np.linspace(0.0, solution.t_end, MOMENTS)
    e = solution.energy(times)
    always, rare = ("kinetic", "vibrational_kinetic", "strain"), ("contact", "damped")
    kinds = {
        ENERGIES[name]: getattr(e, name).tolist()
        for name in (*always, *rare)
        if name in always or getattr(e, name).any()
    }
    return {"t": times.tolist(), **kinds, "total": e.total.tolist()}


def _short(value: Any) -> Any:
    """A scene with as many digits as a picture can use; e and what belongs to it have all."""
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, dict):
        return {
            key: item if key == "restitution" else _short(item)
            for key, item in value.items()
        }
    return [*map(_short, value)] if isinstance(value, list | tuple) else value
