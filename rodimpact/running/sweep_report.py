"""Families as tables for people and as JSON for programs."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..model import Wall
from ..results.labels import outcome
from ..storage.tables import SCHEMA_VERSION, align, clean, joules
from ..units import format_si
from .sweep_result import SweepResult, columns_of

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
    rows = [["varied", "values", "from", "to"]]
    rows += [
        [path, str(len(values)), format_si(values.min(), unit), format_si(values.max(), unit)]
        for path, values, unit in varied
    ]
    blocks = [align(rows), _extremes(result, varied), _members(result, varied, more)]
    return "\n\n".join([*blocks, *_missing(result, varied)])


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
    yield "{"
    for name, value in {
        "schema_version": SCHEMA_VERSION,
        "method": result.method,
        "shape": result.shape,
        "varied": [
            {"path": path, "unit": unit, "values": values.tolist()} for path, values, unit in varied
        ],
    }.items():
        yield f"{json.dumps(name)}: {json.dumps(value)},"
    yield '"columns": {'
    columns = {**result.parameters, **result.columns, "status": result.status}
    for i, (name, column) in enumerate(columns.items(), 1):
        entries = [
            None if isinstance(entry, float) and not math.isfinite(entry) else entry
            for entry in np.broadcast_to(column, result.shape).ravel().tolist()
        ]
        yield f"{json.dumps(name)}: {json.dumps(entries)}" + "," * (i < len(columns))
    yield "}}"


def _extremes(result: SweepResult, varied: Varied) -> str:
    shape = " x ".join(map(str, result.shape))
    where = f"in a grid of {shape}" if shape else ""
    rows = [["collisions", str(result.restitution.size), where]]
    for name, extreme in (("smallest", np.fmin), ("largest", np.fmax)):
        e = extreme.reduce(result.restitution, axis=None)
        if not math.isnan(e):
            where = _where(_first(result.restitution == e), varied)
            rows.append([f"{name} coefficient of restitution e", f"{clean(e, 1.0):.9g}", where])
    return align(rows, left=(0, 2))


def _members(result: SweepResult, varied: Varied, more: str) -> str:
    """All collisions of a small family, some of a large one."""
    count = result.restitution.size
    shown = range(count) if count <= MOST_MEMBERS else [
        round(i * (count - 1) / (SOME_MEMBERS - 1)) for i in range(SOME_MEMBERS)
    ]
    pairs = result.unilateral
    bodies = list(range(len(result.system.bodies)))
    if len(bodies) > MOST_BODIES:
        bodies = bodies[: MOST_BODIES // 2] + bodies[-MOST_BODIES // 2 :]
    names = (
        ["e", "impulse", "peak force", "force duration", "episodes"] if len(pairs) == 1
        else [f"velocity {i} after" for i in bodies]
    )
    also = {name: outcome(result.system, name)
            for name in columns_of(result.system, result.readings.also)}
    rows = [[*(path for path, _, _ in varied), *names, "vibration energy",
             *(quantity.name for quantity in also.values())]]
    for flat in shown:
        index = np.unravel_index(flat, result.shape)
        where = [
            format_si(values[i], unit) for i, (_, values, unit) in zip(index, varied, strict=True)
        ]
        if len(pairs) == 1:
            c = result.contacts[pairs[0]]
            cells = [
                _digits(result.restitution[index], 1.0),
                format_si(c.impulse[index], "N s"), format_si(c.peak_force[index], "N"),
                format_si(c.duration[index], "s"),
                "-" if math.isnan(c.impulse[index]) else str(c.episodes[index]),
            ]
        else:
            velocities = [result.velocities_after[i][index] for i in bodies]
            scale = max(map(abs, velocities))
            cells = [_digits(v, scale, " m/s") for v in velocities]
        cells.append(joules(result.vibration[index], _scale(result, index)))
        cells += [format_si(result.columns[name][index], quantity.unit)
                  for name, quantity in also.items()]
        rows.append([*where, *cells])
    table = align(rows, left=())
    if len(shown) < count:
        table += f"\n... {len(shown)} of {count}; {more}"
    return table


def _scale(result: SweepResult, index: Any) -> float:
    """Energy of the motion of the bodies of a member relative to each other, or more."""
    masses = [body.mass for body in result.system[index].bodies if not isinstance(body, Wall)]
    velocities = [v[index] for v in result.velocities_after]
    spread = max(velocities) - min(velocities)
    push = sum(abs(contact.impulse[index]) for contact in result.contacts)
    return float(sum(masses) * spread * spread / 2 + push * push / (2 * min(masses)))


def _digits(value: float, scale: float, unit: str = "") -> str:
    return "-" if math.isnan(value) else f"{clean(value, scale):.6g}{unit}"


def _missing(result: SweepResult, varied: Varied) -> list[str]:
    """How many have no e, and why: a sentence for each kind."""
    missing = np.isnan(result.restitution)
    met = sum(contact.episodes for contact in result.contacts) > 0
    sentences = []
    status = result.columns["status"]
    for code in np.unique(status[missing]):
        for which in (met, ~met):
            kind = missing & (status == code) & which
            if kind.any():
                index = _first(kind)
                count = int(np.count_nonzero(kind))
                have = "1 collision has" if count == 1 else f"{count} collisions have"
                reason = result.explain(index).removesuffix(".")
                sentences.append(f"{have} no e. At {_where(index, varied)}: {reason}.")
    return ["\n".join(sentences)] if sentences else []


def _first(which: Any) -> Any:
    return np.unravel_index(np.argmax(which), which.shape)


def _where(index: Any, varied: Varied) -> str:
    return ", ".join(
        f"{path} = {format_si(values[i], unit)}"
        for i, (path, values, unit) in zip(index, varied, strict=True)
    )
