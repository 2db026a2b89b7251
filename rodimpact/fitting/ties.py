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
    def number(
        name: str, kind: str, records: tuple[int, ...], ends: tuple[float, float] | None
    ) -> Parameter:
        """With these bounds; without, with those within which it makes sense."""
        if ends is None and kind == "shift":
            first, last = zip(*(measured[k].shifts(until, system) for k in records), strict=True)
            ends = min(first), max(last)
        low, high = ends or (-math.inf, math.inf)
        unit = _unit(measured[records[0]], kind)
        return Parameter(name, low, high, unit, kind=kind, records=records)

    paths = {f"{HEAD}{k}.{kind}": (k, kind) for kind in KINDS for k in range(len(measured))}
    free = dict(paths)
    found = []
    for name, bounds in vary.items():
        tied = {path: own for path, own in paths.items() if fnmatchcase(path, name)}
        kinds = {kind for _, kind in tied.values()}
        units = {_unit(measured[k], kind) for k, kind in tied.values()}
        if len(kinds) != 1:
            problems.append((f"vary.{name}", "is not a number of a record; give a name such as "
                             f"{HEAD}0.shift, or {HEAD}*.gain for one gain of all records"))
        elif len(units) != 1:
            both = " and ".join(sorted(unit or "1" for unit in units))
            problems.append((f"vary.{name}", f"ties records in {both}; convert them to one unit"))
        elif not free.keys() >= tied.keys():
            problems.append((f"vary.{name}", "names a number that another name includes; leave "
                             "one of them out"))
        else:
            (kind,), (unit,) = kinds, units
            bounded = bounds is not None or kind == "blur"
            ends = ends_of(problems, name, bounds, unit) if bounded else None
            found.append(number(name, kind, tuple(free.pop(path)[0] for path in tied), ends))
    return found + [number(path, kind, (k,), measured[k].limits[kind])
                    for path, (k, kind) in free.items()]


def _unit(measured: Measured, kind: str) -> str:
    return measured.signal.unit if kind == "gain" else "s"
