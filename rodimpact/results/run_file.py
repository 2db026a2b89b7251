"""A run or a family as a document and arrays, for a file that holds it as it is.

An object is written as its fields by name, so that one that comes later has its default in an older
file. Arrays of one type stand one behind another, in the document is where each is.
"""

import math
from collections import Counter, defaultdict
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from ..methods import run as runs
from ..methods.clock import Clock
from ..methods.grid.mesh import Cells, GridMotion
from ..methods.run import Run
from ..methods.signals import Pieces
from ..model import System
from ..model.bodies import BODIES, Material, Segment
from ..model.ends import ENDS
from ..model.frozen import Frozen, defaults_of
from ..model.laws import CONTACT_LAWS
from ..model.profiles import Samples, Steps
from ..storage.writing import Arrays

RUN_CLASSES: tuple[Any, ...] = (
    Cells,
    Clock,
    GridMotion,
    Pieces,
    Run,
    runs.ContactSignal,
    runs.ContactTally,
    runs.Episode,
    runs.Outside,
    runs.Signals,
    runs.Totals,
    runs.Waves,
)
MODEL_CLASSES: tuple[Any, ...] = (
    System,
    Material,
    Segment,
    Samples,
    Steps,
    *BODIES.values(),
    *CONTACT_LAWS.values(),
    *ENDS.values(),
)
MAKERS: dict[str, Any] = {
    **{kind.__name__: kind for kind in RUN_CLASSES + MODEL_CLASSES},
    "Run": lambda signals, **others: Run(**others, make_signals=lambda: signals),
    "dict": lambda items: dict(items),
}
"""What makes an object again from its fields by name."""
NOT_IN_JSON = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}


def take_apart(content: Any) -> tuple[dict[str, Any], Arrays]:
    """Document and arrays that `put_together` makes the same of, bit for bit."""
    columns, sizes = defaultdict[str, list[Any]](list), Counter[str]()
    places: dict[
        int, tuple[Any, dict[str, Any]]
    ] = {}  # with the array, so that its id is its own

    def put(array: Any) -> dict[str, Any]:
        if id(array) not in places:
            name = array.dtype.str[1:]
            place = {"array": name, "start": sizes[name], "shape": list(array.shape)}
            places[id(array)] = array, place
            columns[name].append(array.ravel())
            sizes[name] += array.size
        return places[id(array)][1]

    def plain(value: Any) -> Any:
        if isinstance(value, np.ndarray):
            return put(value)
        if isinstance(value, list | tuple) and not hasattr(value, "_fields"):
            return [plain(item) for item in value]
        if isinstance(value, float) and not math.isfinite(value):
            return str(float(value))
        if (
            isinstance(value, str) and value in NOT_IN_JSON
        ):  # a name that reads as a number
            return {"class": "str", "text": value}
        if isinstance(value, System):
            value.check_file()
        kind: Any = (
            Clock if isinstance(value, Clock) else type(value)
        )  # not what assemblies add
        if isinstance(value, Mapping):
            kind, entries = dict, {"items": list(value.items())}
        elif isinstance(value, Frozen):
            entries = value._parameters()
        elif kind in RUN_CLASSES:
            entries = {name: getattr(value, name) for name in names_of(kind)}
        else:
            return value
        return {
            "class": kind.__name__,
            **{key: plain(entry) for key, entry in entries.items()},
        }

    document = {"content": plain(content)}
    return document, {name: np.concatenate(parts) for name, parts in columns.items()}


def put_together(document: Mapping[str, Any], arrays: Arrays) -> Any:
    """Make again what `take_apart` took apart."""

    @cache
    def part(array: str, start: int, *shape: int) -> Any:
        """A stretch of a column, the same object wherever it stands."""
        return arrays[array][start : start + math.prod(shape)].reshape(shape)

    def made(value: Any) -> Any:
        if isinstance(value, list):
            return [made(item) for item in value]
        if isinstance(value, str):
            return NOT_IN_JSON.get(value, value)
        if not isinstance(value, dict):
            return value
        if "array" in value:
            return part(value["array"], value["start"], *value["shape"])
        if value["class"] == "str":
            return value["text"]
        entries = {key: made(entry) for key, entry in value.items() if key != "class"}
        return MAKERS[value["class"]](**entries)

    return made(document["content"])


def names_of(kind: Any) -> list[str]:
    """Fields of a class, by which it is made again; a run has its signals, not what makes them."""
    return [name.removeprefix("make_") for name in defaults_of(kind)]
