"""Columns of a family: what is read of each of its members, when it has run.

A column has one entry a collision; which columns there are follows from the system, and from what
was asked for besides.
"""

import math
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from ..methods.run import ALSO, INWARD, STOPPED_BY, largest_error
from ..model import Plastic, Rod, System
from ..results.solution import Solution

STATUS = STOPPED_BY
"""Why each run stopped; the column ``status`` holds places in this tuple."""
ENDED = [STATUS.index("final"), STATUS.index("until")]

Columns = dict[str, Any]


class ContactColumns(NamedTuple):
    """Totals of one contact; arrays of the family's shape, SI units."""

    impulse: Any
    peak_force: Any
    duration: Any
    episodes: Any


class Readings(NamedTuple):
    """What is read of each member beside its outcome.

    Strain gauges, (body, m from its left end), the times at which they are read, s, and what was
    asked for of `ALSO`.
    """

    gauges: tuple[tuple[int, float], ...] = ()
    times: Any = np.zeros(0)
    also: tuple[str, ...] = ()


def columns_of(
    system: System, names: Iterable[str]
) -> dict[str, tuple[str, int | None]]:
    """Columns of these names of `COLUMNS`, each with its name there and its body or contact."""
    bodies = range(len(system.bodies))
    contacts = range(len(system.contacts))
    owners: dict[str, Iterable[int | None]] = {
        "row": [None],
        "body": bodies,
        "contact": contacts,
        "rod": [i for i in bodies if isinstance(system.bodies[i], Rod)],
        "yielding": [k for k in contacts if isinstance(system.contacts[k], Plastic)],
    }
    return {
        name if owner is None else f"{name}.{owner}": (name, owner)
        for name in names
        for owner in owners[COLUMNS[name][0]]
    }


def arrays_of(
    system: System, readings: Readings
) -> dict[str, tuple[Any, tuple[int, ...]]]:
    """Columns that each member has, with types and shapes beyond the family's, by name."""
    columns = columns_of(system, (*ALWAYS, *readings.also)).items()
    arrays: dict[str, Any] = {
        column: (KINDS.get(name, np.float64), ()) for column, (name, _) in columns
    }
    if readings.gauges:
        arrays["strain"] = np.float64, (len(readings.gauges), len(readings.times))
    return arrays


def row_of(solution: Solution, readings: Readings) -> Columns:
    """Columns of a member, by name."""
    columns = columns_of(solution.system, (*ALWAYS, *readings.also)).items()
    row = {
        column: COLUMNS[name][1](solution, owner) for column, (name, owner) in columns
    }
    if readings.gauges:
        inside = readings.times <= solution.t_end * (1 + 1e-12)
        row["strain"] = np.full((len(readings.gauges), len(inside)), math.nan)
        for g, gauge in enumerate(readings.gauges):
            row["strain"][g, inside] = solution.gauge(*gauge).strain_at(
                readings.times[inside]
            )
    return row


def _set(solution: Solution, contact: int) -> float:
    """How far a contact has yielded for good, m: its gap counts from the faces as they are."""
    times = [0.0, solution.fields.end * solution.fields.clock.tick]
    length = getattr(
        solution.system.bodies[contact], "length", 0.0
    )  # rigid masses have none
    left = solution.displacement(contact, length, times)
    right = solution.displacement(contact + 1, 0.0, times)
    start, end = solution.contacts[contact].gap(times) - (right - left)
    return max(0.0, float(end - start))


def _moved(solution: Solution, body: int) -> float:
    """How far the centre of mass of a body has moved at the end, m."""
    signals = solution.run.signals
    end = solution.fields.end
    tick = solution.fields.clock.tick
    time = end * tick
    if not isinstance(solution.system.bodies[body], Rod):
        return float(solution.displacement(body, 0.0, time))
    left, right = (side and side.push for side in signals.outside)
    pushes = [left, *(contact.force for contact in signals.contacts), right]
    # by the forces on its two faces: Newton's law, integrated twice
    moved = sum(
        sign * float(push.integrated_twice(end)) * tick * tick
        for push, sign in zip(pushes[body : body + 2], INWARD, strict=True)
        if push
    )
    start = float(solution.mean_velocity(body, 0.0)) * time
    fallen = float(solution.system.gravity) * time * time / 2
    return start + moved / solution.fields.clock.mass(body) + fallen


COLUMNS: dict[str, tuple[str, Callable[[Solution, Any], Any]]] = {
    "restitution": (
        "row",
        lambda run, _: (
            math.nan if run.outcome.why_no_restitution() else run.outcome.restitution
        ),
    ),
    "velocity_after": ("body", lambda run, i: run.outcome.velocities_after[i]),
    "impulse": ("contact", lambda run, k: run.outcome.contacts[k].impulse),
    "peak_force": ("contact", lambda run, k: run.outcome.contacts[k].peak_force),
    "duration": ("contact", lambda run, k: run.outcome.contacts[k].duration),
    "episodes": ("contact", lambda run, k: run.outcome.contacts[k].episodes),
    "vibration": ("row", lambda run, _: sum(run.outcome.vibration_after)),
    "final": ("row", lambda run, _: run.outcome.final),
    "status": ("row", lambda run, _: STATUS.index(run.stopped_by)),
    "dissipated": ("row", lambda run, _: run.outcome.dissipated),
    "set": ("yielding", _set),
    "largest_stress": ("rod", lambda run, i: run.extreme_stress(i).largest),
    "displacement": ("body", _moved),
    "accuracy": ("row", lambda run, _: largest_error(run.accuracy)),
}
"""For each name: what has one each, and how it is read of a finished member."""
KINDS: dict[str, Any] = {"episodes": np.int32, "final": np.bool_, "status": np.int8}
"""Types of columns, where they are not numbers."""
ALWAYS = [name for name in COLUMNS if name not in ALSO]
"""Names of the columns that every family has."""
