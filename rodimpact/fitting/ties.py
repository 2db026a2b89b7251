"""Shift, gain and blur of records: separate numbers, or numbers common to several records."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Any

from ..model import System
from ..model.frozen import Problems
from .measured import Measured
from .parameters import Parameter, ends_of

HEAD = "records."
KINDS = "shift", "gain", "blur"


def record_numbers(
    problems: Problems, system: System, measured: Sequence[Measured], vary: Mapping[str, Any],
    until: float,
) -> list[Parameter]:
    """Shift, gain and blur of every record, once each; errors are added to `problems`.

    A name in `vary` may hold the wildcards ``*`` and ``[01]``: all matching numbers become one.
    """
    paths = {f"{HEAD}{k}.{kind}": (k, kind) for kind in KINDS for k in range(len(measured))}
    free = dict(paths)
    found = []
    for name, bounds in vary.items():
        tied = [path for path in paths if fnmatchcase(path, name)]
        kinds = {paths[path][1] for path in tied}
        units = {_unit(measured[k], kind) for k, kind in map(paths.__getitem__, tied)}
        if len(kinds) != 1:
            problems.append((f"vary.{name}", "is not a number of a record; give a name such as "
                             f"{HEAD}0.shift, or {HEAD}*.gain for one gain of all records"))
        elif len(units) != 1:
            both = " and ".join(sorted(unit or "1" for unit in units))
            problems.append((f"vary.{name}", f"ties records in {both}; convert them to one unit"))
        elif not free.keys() >= {*tied}:
            problems.append((f"vary.{name}", "names a number that another name includes; leave "
                             "one of them out"))
        else:
            records = tuple(free.pop(path)[0] for path in tied)
            (kind,), (unit,) = kinds, units
            ends = None
            if bounds is not None or kind == "blur":
                ends = ends_of(problems, name, bounds, unit)
            found.append(_number(system, measured, until, name, kind, records, unit, ends))
    for path, (k, kind) in free.items():
        unit, ends = _unit(measured[k], kind), measured[k].limits[kind]
        found.append(_number(system, measured, until, path, kind, (k,), unit, ends))
    return found


def _number(
    system: System, measured: Sequence[Measured], until: float, name: str, kind: str,
    records: tuple[int, ...], unit: str, ends: tuple[float, float] | None,
) -> Parameter:
    """With these bounds; without, with those within which it makes sense."""
    low, high = ends or (-math.inf, math.inf)
    if ends is None and kind == "shift":
        spans = [measured[k].shifts(until, system) for k in records]
        low, high = min(first for first, _ in spans), max(last for _, last in spans)
    return Parameter(name, low, high, unit, kind=kind, records=records)


def _unit(measured: Measured, kind: str) -> str:
    return measured.signal.unit if kind == "gain" else "s"
