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

MOST_MEMBERS, SOME_MEMBERS = 20, 12  # listed one by one, picked from a larger family
MOST_BODIES = 8  # whose velocities are listed for each member

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
    rows = [
        ["varied", "values", "from", "to"],
        *(
            [
                path,
                str(len(values)),
                format_si(values.min(), unit),
                format_si(values.max(), unit),
            ]
            for path, values, unit in varied
        ),
    ]
    blocks = [align(rows), _extremes(result, varied), _members(result, varied, more)]
    return "\n\n".join(filter(None, [*blocks, _missing(result, varied)]))


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
    axes = [
        {"path": path, "unit": unit, "values": values.tolist()}
        for path, values, unit in varied
    ]
    head = {
        "schema_version": SCHEMA_VERSION,
        "method": result.method,
        "shape": result.shape,
        "varied": axes,
    }
    yield json.dumps(head).removesuffix("}") + ', "columns": {'
    columns = result.table()
    for i, (name, column) in enumerate(columns.items(), 1):
        entries = json.dumps(finite(column.tolist()))
        yield f"{json.dumps(name)}: {entries}" + "," * (i < len(columns))
    yield "}}"


def _extremes(result: SweepResult, varied: Varied) -> str:
    shape = " x ".join(map(str, result.shape))
    where = f"in a grid of {shape}" if shape else ""
    rows = [["collisions", str(result.restitution.size), where]]
    for name, extreme in (("smallest", np.fmin), ("largest", np.fmax)):
        e = extreme.reduce(result.restitution, axis=None)
        if not math.isnan(e):
            where = _where(_first(result.restitution == e), varied)
            rows.append(
                [f"{name} coefficient of restitution e", f"{clean(e, 1.0):.9g}", where]
            )
    return align(rows, left=(0, 2))


def _members(result: SweepResult, varied: Varied, more: str) -> str:
    """All collisions of a small family, some of a large one."""
    count, system = result.restitution.size, result.system
    listed = count if count <= MOST_MEMBERS else SOME_MEMBERS
    shown = np.linspace(0, count - 1, listed).round().astype(int)
    read = {name: np.ravel(column)[shown] for name, column in result.columns.items()}
    bodies, pairs = list(range(len(system.bodies))), result.unilateral
    velocities = [read[f"velocity_after.{i}"] for i in bodies]
    places = np.unravel_index(shown, result.shape or (1,))
    columns = {
        path: _written(values[where], unit)
        for (path, values, unit), where in zip(varied, places, strict=False)
    }
    if len(pairs) == 1:
        k = pairs[0]
        columns["e"] = [_digits(e, 1.0) for e in read["restitution"]]
        columns["impulse"] = _written(read[f"impulse.{k}"], "N s")
        columns["peak force"] = _written(read[f"peak_force.{k}"], "N")
        columns["force duration"] = _written(read[f"duration.{k}"], "s")
        columns["episodes"] = [
            "-" if math.isnan(J) else str(n)
            for J, n in zip(read[f"impulse.{k}"], read[f"episodes.{k}"], strict=True)
        ]
    else:
        if len(bodies) > MOST_BODIES:
            bodies = bodies[: MOST_BODIES // 2] + bodies[-MOST_BODIES // 2 :]
        fastest = np.max(np.abs(velocities), axis=0)
        for i in bodies:
            columns[f"velocity {i} after"] = [
                _digits(*both, " m/s")
                for both in zip(velocities[i], fastest, strict=True)
            ]
    # energy of the motion of the bodies relative to each other, or more
    masses = [
        np.broadcast_to(body.mass, result.shape).ravel()[shown]
        for body in system.bodies
        if not isinstance(body, Wall)
    ]
    push = np.sum(
        [np.abs(read[f"impulse.{k}"]) for k in range(len(system.contacts))], axis=0
    )
    scale = np.sum(masses, axis=0) * np.ptp(velocities, axis=0) ** 2 / 2
    scale = scale + push**2 / (2 * np.min(masses, axis=0))
    columns["vibration energy"] = list(map(joules, read["vibration"], scale))
    for name in columns_of(system, result.readings.also):
        quantity = outcome(system, name)
        columns[quantity.name] = _written(read[name], quantity.unit)
    table = align([list(columns), *zip(*columns.values(), strict=True)], left=())
    if listed < count:
        table += f"\n... {listed} of {count}; {more}"
    return table


def _written(values: Any, unit: str) -> list[str]:
    return [format_si(value, unit) for value in values]


def _digits(value: float, scale: float, unit: str = "") -> str:
    return "-" if math.isnan(value) else f"{clean(value, scale):.6g}{unit}"


def _missing(result: SweepResult, varied: Varied) -> str:
    """How many have no e, and why: a sentence for each kind."""
    missing, met = (
        np.isnan(result.restitution),
        sum(c.episodes for c in result.contacts) > 0,
    )
    kinds = np.asarray(2 * result.columns["status"] + np.logical_not(met))
    sentences = []
    for kind in np.unique(kinds[missing]):
        which = missing & (kinds == kind)
        index, count = _first(which), int(np.count_nonzero(which))
        have = "1 collision has" if count == 1 else f"{count} collisions have"
        reason = result.explain(index).removesuffix(".")
        sentences.append(f"{have} no e. At {_where(index, varied)}: {reason}.")
    return "\n".join(sentences)


def _first(which: Any) -> Any:
    return np.unravel_index(np.argmax(which), which.shape)


def _where(index: Any, varied: Varied) -> str:
    return ", ".join(
        f"{path} = {format_si(values[i], unit)}"
        for i, (path, values, unit) in zip(index, varied, strict=True)
    )
