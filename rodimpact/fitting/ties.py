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
    groups: dict[str, list[tuple[int, str]]] = {name: [] for name in vary}
    for kind in KINDS:
        for k in range(len(measured)):
            path = f"{HEAD}{k}.{kind}"
            names = [name for name in vary if fnmatchcase(path, name)] or [path]
            for other in names[1:]:
                message = f"names {path}, which {names[0]} includes; leave one of them out"
                problems.append((f"vary.{other}", message))
            groups.setdefault(names[0], []).append((k, kind))
    found = []
    for name, members in groups.items():
        alike = {(kind, _unit(measured[k], kind)) for k, kind in members}
        if len(alike) != 1:
            problems.append((f"vary.{name}", "is not one number of records, in one unit; give a "
                             f"name such as {HEAD}0.shift, or {HEAD}*.gain for one gain of all"))
            continue
        ((kind, unit),) = alike
        records = tuple(k for k, _ in members)
        ends: tuple[float, float] | None = None
        if name not in vary:
            ends = measured[records[0]].limits[kind]
        elif vary[name] is not None or kind == "blur":
            ends = ends_of(problems, name, vary[name], unit)
        if ends is None and kind == "shift":
            first, last = zip(*(measured[k].shifts(until, system) for k in records), strict=True)
            ends = min(first), max(last)
        low, high = ends or (-math.inf, math.inf)
        found.append(Parameter(name, low, high, unit, kind=kind, records=records))
    return found


def _unit(measured: Measured, kind: str) -> str:
    return measured.signal.unit if kind == "gain" else "s"
