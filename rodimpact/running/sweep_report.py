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

MAX_LISTED_MEMBERS = 20  # members of a family that are all listed
SAMPLED_MEMBERS = 12  # members that are listed of a larger family
MAX_LISTED_BODIES = 8  # bodies whose velocities are listed for each member

Varied = Sequence[tuple[str, Any, str]]
"""For each axis of a family: the path of what varies, its values, and their unit."""
TextColumns = dict[str, list[str]]
"""Columns of a table by their heads: an entry for each member that is listed."""


def sweep_table(result: SweepResult, varied: Varied, more: str) -> str:
    """Text on what the collisions of a family did, for people.

    Parameters
    ----------
    result : SweepResult
    varied : sequence of (path, values, unit)
        What varies along each axis.
    more : str
        How to get at all members, where only some are listed.

    Returns
    -------
    str
        The grids, the extremes of e, all collisions or some, and why some have no e.
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
    """What the collisions of a family did, for programs: the lines of a JSON document.

    Parameters
    ----------
    result : SweepResult
    varied : sequence of (path, values, unit)
        What varies along each axis.

    Yields
    ------
    str
        Lines of an object with ``schema_version``, ``method``, ``shape``, ``varied``
        and ``columns``. A column is a number that varies or a result: a list with one
        entry a collision, the last axis fastest, in SI units and full precision, with
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
    # One line for each column: the object of the head stays open for them.
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

    Each e stands beside the numbers that vary of the first member that has it. Both are
    left out if no member has an e.
    """
    grid = ""
    if result.shape:
        grid = f"in a grid of {' x '.join(map(str, result.shape))}"
    rows = [["collisions", str(result.restitution.size), grid]]
    for name, extreme in (("smallest", np.fmin), ("largest", np.fmax)):
        # Both leave nan out: it is the result only if all are nan.
        e = extreme.reduce(result.restitution, axis=None)
        if not math.isnan(e):
            index = _index_of_first(result.restitution == e)
            where = _where(index, varied)
            label = f"{name} coefficient of restitution e"
            e_shown = without_round_off(e, scale=1.0)
            rows.append([label, f"{e_shown:.9g}", where])
    return align(rows, left=(0, 2))  # the numbers between end at the right


def _members(result: SweepResult, varied: Varied, more: str) -> str:
    """Table of all collisions of a small family, of evenly spread ones of a large one.

    Its columns: what varies, then totals of the only contact that can open or else
    velocities of the bodies, energy of vibration, and what was asked for besides. If
    only some are listed, a line below says so, with `more`.
    """
    system = result.system
    count = result.restitution.size
    listed = count
    if count > MAX_LISTED_MEMBERS:
        listed = SAMPLED_MEMBERS
    # Places of the listed members in C order
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
    energies = []  # less than the round-off of its scale counts as 0
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
    """Columns of text with what varies along each axis, for some members.

    `members` are their places in C order. There is no column for a single collision.
    """
    shape = result.shape
    if not shape:  # a single collision is a table of one line
        shape = (1,)
    columns: TextColumns = {}
    indices = np.unravel_index(members, shape)  # for each axis, [member]
    # Not strict: nothing varies in a single collision, which has one axis here.
    for axis, index in zip(varied, indices, strict=False):
        path, values, unit = axis
        columns[path] = _written(values[index], unit)
    return columns


def _of_contact(k: int, numbers: dict[str, Any]) -> TextColumns:
    """Columns of text on contact k: e, its totals and its episodes.

    They are made of `numbers` by column, [member]. The contact is the only one that can
    open, so that the restitution of the collision is its own. "-" stands for nan, and
    for the episodes of a member that was refused.
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
        restitution.append(_digits(e, scale=1.0))  # less than the round-off of 1 is 0
    return {
        "e": restitution,
        "impulse": _written(impulses, "N s"),
        "peak force": _written(numbers[f"peak_force.{k}"], "N"),
        "force duration": _written(numbers[f"duration.{k}"], "s"),
        "episodes": episodes,
    }


def _of_bodies(count: int, numbers: dict[str, Any]) -> TextColumns:
    """Columns of text with velocities of bodies, from numbers by column [member].

    Of more than `MAX_LISTED_BODIES` bodies only the first and the last ones are listed,
    half of this number each. "-" stands for nan.
    """
    velocities = _numbered("velocity_after", count, numbers)  # of a body, [member]
    fastest = np.max(np.abs(velocities), axis=0)  # speed, [member]
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
    """The columns name.0 to name.(count - 1) of numbers by column."""
    columns = []
    for i in range(count):
        columns.append(numbers[f"{name}.{i}"])
    return columns


def _energy_scales(result: SweepResult, members: Any, numbers: dict[str, Any]) -> Any:
    """Scale of energies, J, [member]: what is less than its round-off counts as 0.

    It is (sum of m) (spread of v)^2/2 + (sum of abs(J))^2/(2 smallest m), with masses
    m, but not of walls, velocities v after and impulses J: no less than the energy of
    the motion of the bodies relative to each other. `members` are the places in C order
    of those in `numbers`.
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
    of_motion = np.sum(masses, axis=0) * spread**2 / 2
    smallest_mass = np.min(masses, axis=0)
    return of_motion + total_impulse**2 / (2 * smallest_mass)


def _written(values: Any, unit: str) -> list[str]:
    """Values with their unit, each with a prefix such as "m" for 1/1000; nan as "-"."""
    return [format_si(value, unit) for value in values]


def _digits(value: float, scale: float, unit: str = "") -> str:
    """Six digits of a value, without round-off relative to a scale; "-" for nan."""
    if math.isnan(value):
        return "-"
    return f"{without_round_off(value, scale):.6g}{unit}"


def _why_no_restitution(result: SweepResult, varied: Varied) -> str:
    """Sentences on members without e, a line for each kind; "" if all have an e.

    Members of one kind have the same status; in addition, either all or none of them
    have touched. A line tells how many members a kind has, and why the first of them
    has no e; for this the first member is solved again.
    """
    missing = np.isnan(result.restitution)
    # Number of episodes of all contacts, an array of the family's shape
    episodes: Any = 0
    for contact in result.contacts:
        episodes = episodes + contact.episodes
    never_met = episodes == 0
    # A different number for each pair (status, never_met): never_met is 0 or 1
    kinds = np.asarray(2 * result.columns["status"] + never_met)
    sentences = []
    for kind in np.unique(kinds[missing]):
        of_kind = missing & (kinds == kind)
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
    return np.unravel_index(np.argmax(chosen), chosen.shape)


def _where(index: Any, varied: Varied) -> str:
    """Values of what varies for the member of that index: "path = value, ...".

    `index` has an entry for each axis; () of a single collision gives "".
    """
    coordinates = []
    for i, axis in zip(index, varied, strict=True):
        path, values, unit = axis
        coordinates.append(f"{path} = {format_si(values[i], unit)}")
    return ", ".join(coordinates)
