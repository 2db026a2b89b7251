"""Columns of a family: their names, and how each is read of a finished member.

A column has one entry a collision. Which columns there are follows from the system, and from what
was asked for besides: a name of `COLUMNS` for the whole row, ``name.i`` for a body or a contact i.
"""

import math
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from ..methods.family import Columns
from ..methods.run import ALSO, STOPPED_BY, largest_error
from ..model import Plastic, Rod, System
from ..results.centre_of_mass import final_displacement
from ..results.solution import Solution
from .readings import Readings

STATUS = STOPPED_BY
"""Why each run stopped; the column ``status`` holds places in this tuple."""
ENDED = [STATUS.index("final"), STATUS.index("until")]


class ContactColumns(NamedTuple):
    """Totals of one contact; arrays of the family's shape, SI units."""

    impulse: Any
    peak_force: Any
    duration: Any
    episodes: Any


# How columns are read -------------------------------------------------------------------------


def _restitution(solution: Solution, _: int) -> float:
    if solution.outcome.why_no_restitution():
        return math.nan
    return solution.outcome.restitution


def _velocity_after(solution: Solution, body: int) -> float:
    return solution.outcome.velocities_after[body]


def _impulse(solution: Solution, contact: int) -> float:
    return solution.outcome.contacts[contact].impulse


def _peak_force(solution: Solution, contact: int) -> float:
    return solution.outcome.contacts[contact].peak_force


def _duration(solution: Solution, contact: int) -> float:
    return solution.outcome.contacts[contact].duration


def _episodes(solution: Solution, contact: int) -> int:
    return solution.outcome.contacts[contact].episodes


def _vibration(solution: Solution, _: int) -> float:
    return sum(solution.outcome.vibration_after)


def _final(solution: Solution, _: int) -> bool:
    return solution.outcome.final


def _status(solution: Solution, _: int) -> int:
    return STATUS.index(solution.stopped_by)


def _dissipated(solution: Solution, _: int) -> float:
    return solution.outcome.dissipated


def _permanent_set(solution: Solution, contact: int) -> float:
    return solution.contacts[contact].permanent_set()


def _largest_stress(solution: Solution, body: int) -> float:
    return solution.extreme_stress(body).largest


def _displacement(solution: Solution, body: int) -> float:
    return final_displacement(solution.run, solution.fields, body)


def _accuracy(solution: Solution, _: int) -> float:
    return largest_error(solution.accuracy)


# Which columns there are ----------------------------------------------------------------------


class Column(NamedTuple):
    """A result of each member.

    Attributes
    ----------
    owner : str
        What has one each: "row", "body", "contact", "rod", or "yielding" for contacts that yield.
    read : function
        Reads it of a finished member; the second argument is the index of the owner.
    dtype : type
    """

    owner: str
    read: Callable[[Solution, int], Any]
    dtype: Any = np.float64


COLUMNS = {
    "restitution": Column("row", _restitution),
    "velocity_after": Column("body", _velocity_after),
    "impulse": Column("contact", _impulse),
    "peak_force": Column("contact", _peak_force),
    "duration": Column("contact", _duration),
    "episodes": Column("contact", _episodes, np.int32),
    "vibration": Column("row", _vibration),
    "final": Column("row", _final, np.bool_),
    "status": Column("row", _status, np.int8),
    "dissipated": Column("row", _dissipated),
    "set": Column("yielding", _permanent_set),
    "largest_stress": Column("rod", _largest_stress),
    "displacement": Column("body", _displacement),
    "accuracy": Column("row", _accuracy),
}
ALWAYS = [name for name in COLUMNS if name not in ALSO]
"""Names of the columns that every family has."""


class Source(NamedTuple):
    """Name in `COLUMNS` of what a column holds, and the body or contact; 0 of a whole row."""

    name: str
    owner: int


class Layout(NamedTuple):
    """Type of a column, and the shape of the entry of one member."""

    dtype: Any
    member_shape: tuple[int, ...]


def columns_of(system: System, names: Iterable[str]) -> dict[str, Source]:
    """Columns of these names of `COLUMNS`, by the names that users read."""
    owners = {
        "body": list(range(len(system.bodies))),
        "contact": list(range(len(system.contacts))),
        "rod": [i for i, body in enumerate(system.bodies) if isinstance(body, Rod)],
        "yielding": [
            k for k, law in enumerate(system.contacts) if isinstance(law, Plastic)
        ],
    }
    sources = {}
    for name in names:
        owner = COLUMNS[name].owner
        if owner == "row":
            sources[name] = Source(name, 0)
        else:
            for i in owners[owner]:
                sources[f"{name}.{i}"] = Source(name, i)
    return sources


def layout_of(system: System, readings: Readings) -> dict[str, Layout]:
    """Types and shapes of the columns that each member has, by name."""
    layout = {}
    for column, source in columns_of(system, (*ALWAYS, *readings.also)).items():
        layout[column] = Layout(COLUMNS[source.name].dtype, ())
    if readings.gauges:
        member_shape = (len(readings.gauges), len(readings.times))
        layout["strain"] = Layout(np.float64, member_shape)
    return layout


def row_of(solution: Solution, readings: Readings) -> Columns:
    """Entries of a finished member in all columns, by name."""
    row: Columns = {}
    sources = columns_of(solution.system, (*ALWAYS, *readings.also))
    for column, source in sources.items():
        row[column] = COLUMNS[source.name].read(solution, source.owner)
    if readings.gauges:
        row["strain"] = _strain(solution, readings)
    return row


def _strain(solution: Solution, readings: Readings) -> Any:
    """Strain at the gauges, [gauge, time]; nan after the end of the run."""
    inside = readings.times <= solution.t_end * (1 + 1e-12)
    strain = np.full((len(readings.gauges), len(inside)), math.nan)
    for g, (body, x) in enumerate(readings.gauges):
        gauge = solution.gauge(body, x)
        strain[g, inside] = gauge.strain_at(readings.times[inside])
    return strain
