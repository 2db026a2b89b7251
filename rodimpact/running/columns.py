"""Columns of a family: their names, and how each is read from a finished member.

A column has one entry per collision. A column for the whole row has a name of
`COLUMNS`; a column for body or contact i is called ``name.i``. The system and the
argument `also` of `sweep` decide which columns there are.
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
from .readings import RequestedReadings

STATUS = STOPPED_BY
"""Why each run stopped; the column ``status`` holds indices of this tuple."""
ENDED = [STATUS.index("final"), STATUS.index("until")]
"""Indices in `STATUS` of the runs that reached their end."""
RUN_END_RTOL = 1e-12  # fraction of a run by which a time may exceed its end


class ContactColumns(NamedTuple):
    """Totals of one contact; arrays of the family's shape."""

    impulse: Any  # N s
    peak_force: Any  # N
    duration: Any  # force duration, s
    episodes: Any  # how often the contact pressed


# How columns are read: the second argument is the index of a body or a contact --------


def _restitution(solution: Solution, _: int) -> float:
    """Coefficient of restitution e of the collision; nan if it is undefined."""
    if solution.outcome.why_no_restitution():
        return math.nan
    return solution.outcome.restitution


def _velocity_after(solution: Solution, body: int) -> float:
    """Velocity of the centre of mass at the end, m/s."""
    return solution.outcome.velocities_after[body]


def _impulse(solution: Solution, contact: int) -> float:
    """Impulse, N s."""
    return solution.outcome.contacts[contact].impulse


def _peak_force(solution: Solution, contact: int) -> float:
    """Peak force, N."""
    return solution.outcome.contacts[contact].peak_force


def _duration(solution: Solution, contact: int) -> float:
    """Force duration, s."""
    return solution.outcome.contacts[contact].duration


def _episodes(solution: Solution, contact: int) -> int:
    """How often the contact pressed."""
    return solution.outcome.contacts[contact].episodes


def _vibration(solution: Solution, _: int) -> float:
    """Sum of the vibration energies of all bodies at the end, J."""
    return sum(solution.outcome.vibration_after)


def _final(solution: Solution, _: int) -> bool:
    """Whether it is proved that no contact can press again."""
    return solution.outcome.final


def _status(solution: Solution, _: int) -> int:
    """Why the run stopped, an index of `STATUS`."""
    return STATUS.index(solution.stopped_by)


def _dissipated(solution: Solution, _: int) -> float:
    """Energy lost in contacts, J."""
    return solution.outcome.dissipated


def _permanent_set(solution: Solution, contact: int) -> float:
    """Permanent set: the part of the overlap that is plastic and remains, m."""
    return solution.contacts[contact].permanent_set()


def _largest_stress(solution: Solution, body: int) -> float:
    """Largest absolute stress in the rod, Pa."""
    return solution.extreme_stress(body).largest


def _displacement(solution: Solution, body: int) -> float:
    """Displacement of the centre of mass at the end, m."""
    return final_displacement(solution.run, solution.fields, body)


def _accuracy(solution: Solution, _: int) -> float:
    """Largest stated relative error of velocities, impulses and forces."""
    return largest_error(solution.accuracy)


# Which columns there are --------------------------------------------------------------


class Column(NamedTuple):
    """How a result is read from each member.

    Attributes
    ----------
    owner_kind : str
        Objects that have a column each: "body", "contact", "rod", or "yielding" for
        contacts that yield. "row" stands for one column of the whole row.
    read : function
        Called with the solution of a member and the index of the owner (0 for the whole
        row); returns the entry of this member.
    dtype : type
        Type of the entries.
    """

    owner_kind: str
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
"""Names in `COLUMNS` of the columns that every family has."""


class Source(NamedTuple):
    """Result and owner of a column: ("impulse", 1) for the column "impulse.1"."""

    name: str  # of the result in `COLUMNS`
    owner_index: int  # index of the body or contact; 0 for the whole row


class Layout(NamedTuple):
    """How a column is stored."""

    dtype: Any
    member_shape: tuple[int, ...]  # shape of the entry of one member


def columns_of(system: System, names: Iterable[str]) -> dict[str, Source]:
    """Columns that a family has for these names of `COLUMNS`, each with its `Source`.

    The result is a dict by the full name of the column. A result of the whole row has
    one column of its own name, with the index 0. The name "impulse" gives a column for
    each contact: "impulse.0", "impulse.1", ... A name gives no column if the system has
    no body or contact of its kind, such as a yielding contact for "set".
    """
    owners = _owners(system)
    sources = {}
    for name in names:
        kind = COLUMNS[name].owner_kind
        if kind == "row":
            sources[name] = Source(name, 0)  # index 0 for the whole row
        else:
            for i in owners[kind]:
                sources[f"{name}.{i}"] = Source(name, i)
    return sources


def _owners(system: System) -> dict[str, list[int]]:
    """Indices of the bodies or contacts of each kind of `Column.owner_kind`.

    The keys are "body", "contact", "rod", and "yielding" for plastic contacts.
    """
    rods = []
    for i, body in enumerate(system.bodies):
        if isinstance(body, Rod):
            rods.append(i)
    yielding = []
    for k, law in enumerate(system.contacts):
        if isinstance(law, Plastic):
            yielding.append(k)
    return {
        "body": list(range(len(system.bodies))),
        "contact": list(range(len(system.contacts))),
        "rod": rods,
        "yielding": yielding,
    }


def layout_of(system: System, readings: RequestedReadings) -> dict[str, Layout]:
    """Type of each column of a family and shape of its entries, by name of the column.

    The columns are those of `ALWAYS` and of `readings.also`, whose entries are single
    values (shape ()). If there are gauges, the column "strain" is added; its entries
    have the shape (gauges, times).
    """
    layout = {}
    for column, source in columns_of(system, (*ALWAYS, *readings.also)).items():
        layout[column] = Layout(COLUMNS[source.name].dtype, member_shape=())
    if readings.gauges:
        member_shape = (len(readings.gauges), len(readings.times))
        layout["strain"] = Layout(np.float64, member_shape)
    return layout


def row_of(solution: Solution, readings: RequestedReadings) -> Columns:
    """Entries of a finished member in all columns of its family, by name of the column.

    An entry is a single value. If there are gauges, the entry "strain" is an array,
    [gauge, time].
    """
    row: Columns = {}
    sources = columns_of(solution.system, (*ALWAYS, *readings.also))
    for column, source in sources.items():
        row[column] = COLUMNS[source.name].read(solution, source.owner_index)
    if readings.gauges:
        row["strain"] = _strain(solution, readings)
    return row


def _strain(solution: Solution, readings: RequestedReadings) -> Any:
    """Strain at the gauges at the times of the readings, [gauge, time].

    Entries after the end of the run are nan.
    """
    times = readings.times
    # A time that exceeds the end by round-off alone still counts as inside the run.
    latest = solution.t_end * (1 + RUN_END_RTOL)
    inside = times <= latest  # [time]
    strain = np.full((len(readings.gauges), len(times)), math.nan)
    for i, body_and_place in enumerate(readings.gauges):
        body, x = body_and_place
        gauge = solution.gauge(body, x)
        strain[i, inside] = gauge.strain_at(times[inside])
    return strain
