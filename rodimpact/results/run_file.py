"""A run as a document and arrays, for a file that holds it as it is.

Every class is written as its fields by name, so that one that comes later has its default in an
older file. Arrays of one type stand one behind another, in the document is where each is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from ..methods import run as runs
from ..methods.clock import Clock
from ..methods.grid.mesh import Cells, GridMotion
from ..methods.run import Run
from ..methods.signals import Floats, Pieces
from ..model import System
from ..storage.writing import Arrays

KINDS = {kind.__name__: kind for kind in (
    Cells, Clock, GridMotion, Pieces, Run, runs.ContactSignal, runs.ContactTally,
    runs.Episode, runs.Outside, runs.Signals, runs.Totals, runs.Waves,
)}


STEPS = 3
"""Schema of files whose signals were all constant between jumps; they are made into pieces.

There a contact had the gap as each piece of its force began, m, its rate, m per tick, and the power
of the force, J per tick; the outside had its power, W, and masses their velocities at the edges of
steps.
"""
STEP_KINDS: dict[str, Any] = {
    "StepSignal": lambda ticks, values: Pieces(ticks, values),
    "ContactSignal": dict, "Outside": dict, "Signals": dict,
    "Clock": lambda **values: Clock(**{k: v for k, v in values.items() if k != "grain"}),
}
"""What the classes of such a file are read as, where they have changed."""


def take_apart(run: Run) -> tuple[dict[str, Any], Arrays]:
    """Document and arrays that `put_together` makes the same run of, bit for bit."""
    columns: dict[str, list[Any]] = {}
    sizes: dict[str, int] = {}
    places: dict[int, tuple[Any, dict[str, Any]]] = {}  # with the array, so that its id is its own

    def put(array: Any) -> dict[str, Any]:
        if id(array) not in places:
            name = array.dtype.str[1:]
            place = {"array": name, "start": sizes.get(name, 0), "shape": list(array.shape)}
            columns.setdefault(name, []).append(array.ravel())
            sizes[name] = sizes.get(name, 0) + array.size
            places[id(array)] = array, place
        return places[id(array)][1]

    def plain(value: Any) -> Any:
        if isinstance(value, np.ndarray):
            return put(value)
        if isinstance(value, System):
            return {"class": "System", "system": value.for_file()}
        kind = Clock if isinstance(value, Clock) else type(value)  # what else an assembly has goes
        if kind in KINDS.values():
            entries = {key: plain(getattr(value, key)) for key in names_of(kind)}
            return {"class": kind.__name__, **entries}
        if isinstance(value, Mapping):
            return {"class": "map", "items": [[plain(k), plain(v)] for k, v in value.items()]}
        return [plain(item) for item in value] if isinstance(value, list | tuple) else value

    document = {"run": plain(run)}
    return document, {name: np.concatenate(parts) for name, parts in columns.items()}


def put_together(document: Mapping[str, Any], arrays: Arrays) -> Run:
    """Make again what `take_apart` took apart."""
    parts: dict[tuple[Any, ...], Any] = {}
    older = document.get("schema") == STEPS
    kinds = {**KINDS, "GridMotion": _motion, "RadialMotion": dict,
             **(STEP_KINDS if older else {})}

    def array_of(name: str, start: int, shape: list[int]) -> Any:
        key = (name, start, *shape)
        if key not in parts:
            size = int(np.prod(shape, dtype=np.int64))
            parts[key] = arrays[name][start : start + size].reshape(shape)
        return parts[key]

    def made(value: Any) -> Any:
        if isinstance(value, list | tuple):
            return [made(item) for item in value]
        if not isinstance(value, dict):
            return value
        if "array" in value:
            return array_of(value["array"], value["start"], value["shape"])
        if value["class"] == "map":
            return {made(k): made(v) for k, v in value["items"]}
        if value["class"] == "System":
            return System.from_dict(value["system"])
        values = {key: made(item) for key, item in value.items() if key != "class"}
        if value["class"] == "Run":
            signals = values.pop("signals")
            if older:
                signals = _signals(signals, values["clock"], values["end"])
            return Run(**values, make_signals=lambda: signals)
        return kinds[value["class"]](**values)

    run = made(document["run"])
    assert isinstance(run, Run)
    return run


def _motion(**values: Any) -> GridMotion:
    """Motion on a grid; older files have its cells array by array, some in a `RadialMotion`."""
    if "cells" not in values:
        none, states = np.zeros_like(values["stiffness"]), np.zeros((len(values["when"]), 0))
        old = values.pop("radial", None) or {"strain": states, "rate": states}
        shear = old.pop("shear", np.zeros_like(values["mass"]))  # by node, and by cell no more
        cells = Cells(*(values.pop(name, old.get(name, none)) for name in Cells._fields))
        values |= {"cells": cells, "shear": shear, "radial": old["strain"],
                   "radial_rate": old["rate"]}
    return GridMotion(**values)


def _signals(old: Mapping[str, Any], clock: Clock, end: int) -> runs.Signals:
    """Signals to the tick `end`, of what a file of steps has under that name."""
    outside = [
        side and runs.Outside(side["kind"], side["push"], _ratio(side["power"], side["push"], sign))
        for side, sign in zip(old["outside"], runs.INWARD, strict=True)
    ]
    masses = {body: Pieces.through(old["edges"], V) for body, V in old["masses"].items()}
    contacts = tuple(_contact(contact, clock.tick, end) for contact in old["contacts"])
    return runs.Signals(old["motion"], contacts, (outside[0], outside[1]), old["edges"], masses)


def _contact(old: Mapping[str, Any], tick: float, end: int) -> runs.ContactSignal:
    force, gap, rate = old["force"], old["gap"], old["rate"]
    until = gap + rate * np.diff(force.ticks, append=end)
    return runs.ContactSignal(
        force, Pieces.lines(force.ticks, gap, until, end),
        _ratio(old["power"], force, 1 / tick, -rate / tick), old["episodes"],
    )


def _ratio(power: Pieces, force: Pieces, factor: float, otherwise: Floats | float = 0.0) -> Pieces:
    """The velocity power/force times a factor, and another one where there is no force."""
    velocity = np.zeros(len(force.ticks)) + otherwise
    np.divide(power.values * factor, force.values, out=velocity, where=force.values != 0)
    return Pieces(force.ticks, velocity)


def names_of(kind: Any) -> list[str]:
    """Fields of a class, by which it is made again."""
    if kind is Run:
        return ["signals", *(f.name for f in fields(Run) if f.name != "make_signals")]
    if is_dataclass(kind):
        return [f.name for f in fields(kind)]
    return ["ticks", "coefficients", "end"] if kind is Pieces else list(kind._fields)
