"""Families as tables for people and as JSON for programs."""

import json
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..model import Wall
from ..results.labels import outcome
from ..storage.tables import SCHEMA_VERSION, align, clean, finite, joules
from ..units import format_si
from .columns import columns_of
from .sweep_result import SweepResult

MAX_LISTED_MEMBERS = 20  # of a family that is listed one by one
SAMPLED_MEMBERS = 12  # picked from a larger family
MAX_LISTED_BODIES = 8  # whose velocities are listed for each member

Varied = Sequence[tuple[str, Any, str]]
"""For each axis of a family: the path of what varies along it, its values, and their unit."""


def sweep_table(result: SweepResult, varied: Varied, more: str) -> str:
    """What the collisions of a family did, for people.

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
    missing = _missing(result, varied)
    if missing:
        blocks.append(missing)
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
        Of an object with ``schema_version``, ``method``, ``shape``, ``varied`` and ``columns``. A
        column is a number that varies or a result: a list with one entry a collision, the last axis
        fastest, in SI units and full precision, with null for what does not exist.
    """
    axes = []
    for path, values, unit in varied:
        axes.append({"path": path, "unit": unit, "values": values.tolist()})
    head = {
        "schema_version": SCHEMA_VERSION,
        "method": result.method,
        "shape": result.shape,
        "varied": axes,
    }
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
    where = ""
    if result.shape:
        where = f"in a grid of {' x '.join(map(str, result.shape))}"
    rows = [["collisions", str(result.restitution.size), where]]
    for name, extreme in (("smallest", np.fmin), ("largest", np.fmax)):
        e = extreme.reduce(result.restitution, axis=None)
        if not math.isnan(e):
            where = _where(_first(result.restitution == e), varied)
            label = f"{name} coefficient of restitution e"
            rows.append([label, f"{clean(e, 1.0):.9g}", where])
    return align(rows, left=(0, 2))


def _members(result: SweepResult, varied: Varied, more: str) -> str:
    """All collisions of a small family, some of a large one."""
    system = result.system
    count = result.restitution.size
    listed = count
    if count > MAX_LISTED_MEMBERS:
        listed = SAMPLED_MEMBERS
    members = np.linspace(0, count - 1, listed).round().astype(int)
    numbers = {}
    for name, column in result.columns.items():
        numbers[name] = np.ravel(column)[members]
    shape = result.shape
    if not shape:  # a single collision is a table of one line
        shape = (1,)
    indices = np.unravel_index(members, shape)
    columns: dict[str, list[str]] = {}
    for (path, values, unit), index in zip(varied, indices, strict=False):
        columns[path] = _written(values[index], unit)
    opening = result.unilateral
    if len(opening) == 1:
        columns |= _of_contact(opening[0], numbers)
    else:
        columns |= _of_bodies(len(system.bodies), numbers)
    scale = _energy_scale(result, members, numbers)
    columns["vibration energy"] = list(map(joules, numbers["vibration"], scale))
    for name in columns_of(system, result.readings.also):
        quantity = outcome(system, name)
        columns[quantity.name] = _written(numbers[name], quantity.unit)
    table = align([list(columns), *zip(*columns.values(), strict=True)], left=())
    if listed < count:
        table += f"\n... {listed} of {count}; {more}"
    return table


def _of_contact(k: int, numbers: dict[str, Any]) -> dict[str, list[str]]:
    """Columns where only contact k can open."""
    impulses = numbers[f"impulse.{k}"]
    episodes = []
    for impulse, episode_count in zip(impulses, numbers[f"episodes.{k}"], strict=True):
        if math.isnan(impulse):
            episodes.append("-")
        else:
            episodes.append(str(episode_count))
    return {
        "e": [_digits(e, 1.0) for e in numbers["restitution"]],
        "impulse": _written(impulses, "N s"),
        "peak force": _written(numbers[f"peak_force.{k}"], "N"),
        "force duration": _written(numbers[f"duration.{k}"], "s"),
        "episodes": episodes,
    }


def _of_bodies(count: int, numbers: dict[str, Any]) -> dict[str, list[str]]:
    """Columns where several contacts can open: velocities, of a long row some."""
    velocities = [numbers[f"velocity_after.{i}"] for i in range(count)]
    fastest = np.max(np.abs(velocities), axis=0)
    bodies = list(range(count))
    if count > MAX_LISTED_BODIES:
        half = MAX_LISTED_BODIES // 2
        bodies = bodies[:half] + bodies[-half:]
    columns = {}
    for i in bodies:
        written = []
        for velocity, scale in zip(velocities[i], fastest, strict=True):
            written.append(_digits(velocity, scale, " m/s"))
        columns[f"velocity {i} after"] = written
    return columns


def _energy_scale(result: SweepResult, members: Any, numbers: dict[str, Any]) -> Any:
    """Energy of the motion of the bodies relative to each other, or more, J, [member].

    (sum of m) (spread of v)^2/2 + (sum of J)^2/(2 smallest m), with the impulses J.
    """
    bodies = result.system.bodies
    masses = []
    for body in bodies:
        if not isinstance(body, Wall):
            mass = np.broadcast_to(body.mass, result.shape)
            masses.append(mass.ravel()[members])
    velocities = [numbers[f"velocity_after.{i}"] for i in range(len(bodies))]
    contacts = range(len(result.system.contacts))
    impulses = [np.abs(numbers[f"impulse.{k}"]) for k in contacts]
    push = np.sum(impulses, axis=0)
    scale = np.sum(masses, axis=0) * np.ptp(velocities, axis=0) ** 2 / 2
    return scale + push**2 / (2 * np.min(masses, axis=0))


def _written(values: Any, unit: str) -> list[str]:
    return [format_si(value, unit) for value in values]


def _digits(value: float, scale: float, unit: str = "") -> str:
    if math.isnan(value):
        return "-"
    return f"{clean(value, scale):.6g}{unit}"


def _missing(result: SweepResult, varied: Varied) -> str:
    """How many have no e, and why: a sentence for each kind."""
    missing = np.isnan(result.restitution)
    met = sum(contact.episodes for contact in result.contacts) > 0
    # a number for each status, with contact or without
    kinds = np.asarray(2 * result.columns["status"] + np.logical_not(met))
    sentences = []
    for kind in np.unique(kinds[missing]):
        which = missing & (kinds == kind)
        index = _first(which)
        count = int(np.count_nonzero(which))
        have = f"{count} collisions have"
        if count == 1:
            have = "1 collision has"
        reason = result.explain(index).removesuffix(".")
        sentences.append(f"{have} no e. At {_where(index, varied)}: {reason}.")
    return "\n".join(sentences)


def _first(which: Any) -> Any:
    return np.unravel_index(np.argmax(which), which.shape)


def _where(index: Any, varied: Varied) -> str:
    coordinates = []
    for i, (path, values, unit) in zip(index, varied, strict=True):
        coordinates.append(f"{path} = {format_si(values[i], unit)}")
    return ", ".join(coordinates)
