"""Families as tables for people and as JSON for programs."""

import json
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..model import Wall
from ..results.labels import quantity_of_column
from ..storage.tables import JSON_SCHEMA, align, finite, joules, without_round_off
from ..units import format_si
from .columns import columns_of
from .sweep_result import SweepResult

MAX_LISTED_MEMBERS = 20  # size of the largest family whose members are all listed
SAMPLED_MEMBERS = 12  # number of members that are listed of a larger family
MAX_LISTED_BODIES = 8  # largest number of bodies whose velocities are listed

Varied = Sequence[tuple[str, Any, str]]
"""For each axis of a family: path of the number that varies, its values, their unit."""
TextColumns = dict[str, list[str]]
"""Columns of a table by their heads: one text for each member that is listed."""


def sweep_table(result: SweepResult, varied: Varied, more: str) -> str:
    """Results of the collisions of a family as text, for people.

    Parameters
    ----------
    result : SweepResult
    varied : sequence of (path, values, unit)
        The number that varies along each axis, with its values.
    more : str
        How to see all members; used if only some of them are listed.

    Returns
    -------
    str
        Tables of the grids, of the extremes of e, and of all collisions or some of
        them; then the reasons why collisions have no e, if there are such.
    """
    rows = [["varied", "values", "from", "to"]]
    for path, values, unit in varied:
        smallest = format_si(values.min(), unit)
        largest = format_si(values.max(), unit)
        rows.append([path, str(len(values)), smallest, largest])
    blocks = [align(rows), _extremes(result, varied), _members(result, varied, more)]
    reasons = _why_no_restitution(result, varied)
    if reasons:
        blocks.append(reasons)
    return "\n\n".join(blocks)


def sweep_json(result: SweepResult, varied: Varied) -> Iterator[str]:
    """Results of the collisions of a family for programs: lines of a JSON document.

    Parameters
    ----------
    result : SweepResult
    varied : sequence of (path, values, unit)
        The number that varies along each axis, with its values.

    Yields
    ------
    str
        Lines of an object with ``schema_version``, ``method``, ``shape``, ``varied``
        and ``columns``. A column is a number that varies or a result: a list with one
        entry per collision, the last axis fastest, in SI units and full precision, with
        null for a number that does not exist.
    """
    axes = []
    for path, values, unit in varied:
        axes.append({"path": path, "unit": unit, "values": values.tolist()})
    head = {
        "schema_version": JSON_SCHEMA,
        "method": result.method,
        "shape": result.shape,
        "varied": axes,
    }
    # Without its closing brace, the object stays open for the columns, a line each.
    yield json.dumps(head).removesuffix("}") + ', "columns": {'
    columns = result.table()
    last = list(columns)[-1]
    for name, column in columns.items():
        entries = json.dumps(finite(column.tolist()))
        line = f"{json.dumps(name)}: {entries}"
        if name != last:
            line += ","
        yield line
    yield "}}"


def _extremes(result: SweepResult, varied: Varied) -> str:
    """Table of the number of collisions, and of the smallest and largest e.

    Beside an extreme e are the varied numbers of the first member that has this e. Both
    lines are left out if no member has an e.
    """
    grid = ""
    if result.shape:
        grid = f"in a grid of {' x '.join(map(str, result.shape))}"
    rows = [["collisions", str(result.restitution.size), grid]]
    for name, extreme in (("smallest", np.fmin), ("largest", np.fmax)):
        # fmin and fmax ignore nan, unless all values are nan.
        e = extreme.reduce(result.restitution, axis=None)
        if not math.isnan(e):
            index = _index_of_first(result.restitution == e)
            where = _where(index, varied)
            label = f"{name} coefficient of restitution e"
            e_shown = without_round_off(e, scale=1.0)
            rows.append([label, f"{e_shown:.9g}", where])
    return align(rows, left=(0, 2))  # the numbers, in column 1, end at the right


def _members(result: SweepResult, varied: Varied, more: str) -> str:
    """Table of all members of a family, or of evenly spread members of a large one.

    Its columns are the numbers that vary; totals of the contact that can open, or
    velocities of the bodies if not exactly one contact can open; the vibration energy;
    and the results that `also` requested. If only some members are listed, a line below
    the table says so, with the text `more`.
    """
    system = result.system
    count = result.restitution.size
    listed = count
    if count > MAX_LISTED_MEMBERS:
        listed = SAMPLED_MEMBERS
    # Indices of the listed members in C order
    members = np.linspace(0, count - 1, listed).round().astype(int)
    numbers = {}  # by column, [listed member]
    for name, column in result.columns.items():
        numbers[name] = np.ravel(column)[members]
    columns = _varied_columns(result, varied, members)
    unilateral_contacts = result.unilateral
    if len(unilateral_contacts) == 1:
        columns |= _of_contact(unilateral_contacts[0], numbers)
    else:
        columns |= _of_bodies(len(system.bodies), numbers)
    scales = _energy_scales(result, members, numbers)
    energies = []  # an energy below the round-off of its scale is shown as 0
    for vibration, scale in zip(numbers["vibration"], scales, strict=True):
        energies.append(joules(vibration, scale))
    columns["vibration energy"] = energies
    for name in columns_of(system, result.readings.also):
        label = quantity_of_column(system, name)
        columns[label.name] = _written(numbers[name], label.unit)
    rows = zip(*columns.values(), strict=True)
    table = align([list(columns), *rows], left=())  # all columns end at the right
    if listed < count:
        table += f"\n... {listed} of {count}; {more}"
    return table


def _varied_columns(result: SweepResult, varied: Varied, members: Any) -> TextColumns:
    """Columns of text with the number that varies along each axis, for some members.

    `members` are the indices of these members in C order. For a single collision there
    is no column.
    """
    shape = result.shape
    if not shape:  # a single collision is a table of one line
        shape = (1,)
    columns: TextColumns = {}  # by path
    indices = np.unravel_index(members, shape)  # for each axis, [member]
    # Not strict: a single collision has one axis here, along which nothing varies.
    for axis, index in zip(varied, indices, strict=False):
        path, values, unit = axis
        columns[path] = _written(values[index], unit)
    return columns


def _of_contact(k: int, numbers: dict[str, Any]) -> TextColumns:
    """Columns of text for contact k: e, its totals and its number of episodes.

    They are made from `numbers`, arrays [member] by column name. Contact k is the only
    one that can open, so the restitution of the collision belongs to it. "-" stands for
    nan, and for the episodes of a member that the method refused.
    """
    impulses = numbers[f"impulse.{k}"]
    episode_counts = numbers[f"episodes.{k}"]
    episodes = []
    for impulse, episode_count in zip(impulses, episode_counts, strict=True):
        if math.isnan(impulse):  # a refused member
            episodes.append("-")
        else:
            episodes.append(str(episode_count))
    restitution = []
    for e in numbers["restitution"]:
        # An e below the round-off of 1 is shown as 0.
        restitution.append(_digits(e, scale=1.0))
    return {
        "e": restitution,
        "impulse": _written(impulses, "N s"),
        "peak force": _written(numbers[f"peak_force.{k}"], "N"),
        "force duration": _written(numbers[f"duration.{k}"], "s"),
        "episodes": episodes,
    }


def _of_bodies(count: int, numbers: dict[str, Any]) -> TextColumns:
    """Columns of text with the velocities of `count` bodies after the collision.

    They are made from `numbers`, arrays [member] by column name. If there are more than
    `MAX_LISTED_BODIES` bodies, only the first and the last ones are listed, half of
    this number each. "-" stands for nan.
    """
    velocities = _numbered("velocity_after", count, numbers)  # [body][member]
    fastest = np.max(np.abs(velocities), axis=0)  # largest speed, [member]
    bodies = list(range(count))
    if count > MAX_LISTED_BODIES:
        half = MAX_LISTED_BODIES // 2
        bodies = bodies[:half] + bodies[-half:]
    columns = {}
    for i in bodies:
        entries = []
        for velocity, scale in zip(velocities[i], fastest, strict=True):
            entries.append(_digits(velocity, scale, unit=" m/s"))
        columns[f"velocity {i} after"] = entries
    return columns


def _numbered(name: str, count: int, numbers: dict[str, Any]) -> list[Any]:
    """The columns "name.0" to "name.(count - 1)" of `numbers`, in this order."""
    columns = []
    for i in range(count):
        columns.append(numbers[f"{name}.{i}"])
    return columns


def _energy_scales(result: SweepResult, members: Any, numbers: dict[str, Any]) -> Any:
    """Scale of energies, J, [member]: an energy below its round-off counts as 0.

    It is (sum of m) (spread of v)^2/2 + (sum of abs(J))^2/(2 smallest m), with the
    masses m of all bodies except walls, the velocities v after and the impulses J of
    all contacts. It is no less than the energy of the relative motion of the bodies.
    `members` are the indices in C order of the members in `numbers`.
    """
    bodies = result.system.bodies
    masses = []
    for body in bodies:
        if not isinstance(body, Wall):
            mass = np.broadcast_to(body.mass, result.shape)
            masses.append(mass.ravel()[members])
    velocities = _numbered("velocity_after", len(bodies), numbers)
    impulses = _numbered("impulse", len(result.system.contacts), numbers)
    total_impulse = np.sum(np.abs(impulses), axis=0)
    spread = np.ptp(velocities, axis=0)
    # Energy of masses that differ in velocity by no more than the spread
    of_motion = np.sum(masses, axis=0) * spread**2 / 2
    smallest_mass = np.min(masses, axis=0)
    return of_motion + total_impulse**2 / (2 * smallest_mass)


def _written(values: Any, unit: str) -> list[str]:
    """Values as text with unit and SI prefix, such as "5 mm"; "-" stands for nan."""
    return [format_si(value, unit) for value in values]


def _digits(value: float, scale: float, unit: str = "") -> str:
    """A value with six digits; 0 if it is only round-off of `scale`, "-" for nan."""
    if math.isnan(value):
        return "-"
    return f"{without_round_off(value, scale):.6g}{unit}"


def _why_no_restitution(result: SweepResult, varied: Varied) -> str:
    """Sentences on members without e, one line per kind of member; "" if all have an e.

    The members of a kind have the same status; in addition, either all or none of them
    had a contact that pressed. A line gives the number of members of this kind without
    e, and the reason for the first of them, which is solved again to find it.
    """
    missing = np.isnan(result.restitution)
    # Sum of the episodes of all contacts, an array of the family's shape
    episodes: Any = 0
    for contact in result.contacts:
        episodes = episodes + contact.episodes
    never_met = episodes == 0
    # One number for each pair (status, never_met): `never_met` counts as 0 or 1.
    kinds = np.asarray(2 * result.columns["status"] + never_met)
    sentences = []
    for kind in np.unique(kinds[missing]):
        of_kind = missing & (kinds == kind)  # members of this kind without e
        index = _index_of_first(of_kind)
        count = int(np.count_nonzero(of_kind))
        have = f"{count} collisions have"
        if count == 1:
            have = "1 collision has"
        reason = result.explain(index).removesuffix(".")
        sentences.append(f"{have} no e. At {_where(index, varied)}: {reason}.")
    return "\n".join(sentences)


def _index_of_first(chosen: Any) -> Any:
    """Index, a tuple, of the first member in C order for which `chosen` is true."""
    # argmax of truth values is the index of the first True
    return np.unravel_index(np.argmax(chosen), chosen.shape)


def _where(index: Any, varied: Varied) -> str:
    """Text "path = value, ..." of the varied numbers of the member at an index.

    `index` has one entry per axis of the family; that of a single collision, (), gives
    the text "".
    """
    coordinates = []
    for i, axis in zip(index, varied, strict=True):
        path, values, unit = axis
        coordinates.append(f"{path} = {format_si(values[i], unit)}")
    return ", ".join(coordinates)
