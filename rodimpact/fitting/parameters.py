"""Parameters of a fit: numbers of a system, by the paths of a case file, or of its records."""

import math
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Any, NamedTuple

from ..model import System
from ..model.arguments import array
from ..model.frozen import InvalidModel, refusal
from ..model.paths import (
    alternative_of,
    numbers_of,
    places_of,
    suggestion,
    unit_at,
    with_numbers,
)
from ..units import shown
from .measured import Measured

HEAD = "records."
KINDS = "shift", "gain", "blur"
RATIO = 10.0  # of bounds from which on what lies between is divided in equal ratios


class Parameter(NamedTuple):
    """A number that a fit varies; infinite bounds leave it free.

    path : its name; low, high : bounds; unit : of SI; start : the value of the system; places : in
    ``System.to_dict()``, all with this number; kind : "shift", "gain" or "blur" if it belongs to
    `records`, by their index. A number of the system is scaled to 0 at `low` and 1 at `high`, one
    of records is not scaled.
    """

    path: str
    low: float
    high: float
    unit: str
    start: float = 0.0
    places: Sequence[str] = ()
    kind: str = ""
    records: tuple[int, ...] = ()

    @property
    def ends(self) -> tuple[float, float]:
        """The scaled bounds."""
        return (self.low, self.high) if self.kind else (0.0, 1.0)

    @property
    def line(self) -> tuple[float, float]:
        """The number, or its logarithm, at 0, and how much more it is at 1."""
        if self.kind:
            return 0.0, 1.0
        low, high = (
            map(math.log, (self.low, self.high))
            if self.by_ratio
            else (self.low, self.high)
        )
        return low, high - low

    def value(self, share: float) -> float:
        """The number at this share of the way from `low` to `high`, or where it is not scaled."""
        start, slope = self.line
        return (
            math.exp(start + slope * share) if self.by_ratio else start + slope * share
        )

    def share(self, value: float) -> float:
        """The share of the way from `low` to `high` at which this number lies, or the nearest."""
        value, (start, slope) = min(max(value, self.low), self.high), self.line
        return ((math.log(value) if self.by_ratio else value) - start) / slope

    def slope(self, share: float) -> float:
        """Derivative of `value`."""
        return self.line[1] * (self.value(share) if self.by_ratio else 1.0)

    @property
    def by_ratio(self) -> bool:
        """Whether equal steps are equal ratios."""
        return not self.kind and spans_a_ratio(self.low, self.high)


def spans_a_ratio(low: float, high: float) -> bool:
    """Whether a range is divided in equal ratios: its bounds differ by a factor of 10 or more."""
    return low > 0 and high / low >= RATIO


def share_of_range(value: float, low: float, high: float) -> float:
    """Share of the way from `low` to `high`, by ratios if the range spans a ratio."""
    if spans_a_ratio(low, high):
        return math.log(value / low) / math.log(high / low)
    return (value - low) / (high - low)


def parameters_of(system: System, vary: Mapping[str, Any]) -> list[Parameter]:
    """The parameters to vary, each with its bounds."""
    known, numbers, taken = places_of(system), numbers_of(system), dict[str, str]()
    found = []
    for path, bounds in vary.items():
        if path not in known:
            message = (
                f"is not a parameter of the system; {suggestion(str(path), known)}"
            )
            raise refusal(f"vary.{path}", message)
        unit = unit_at(system, known[path][0])
        for place in known[path]:
            if (other := taken.setdefault(alternative_of(place), path)) != path:
                message = f"is already varied as {other}; leave one of them out"
                raise refusal(f"vary.{path}", message)
        start = float(numbers[known[path][0]])
        found.append(
            Parameter(path, *ends_of(path, bounds, unit), unit, start, known[path])
        )
    return found


def record_numbers(
    system: System, measured: Sequence[Measured], vary: Mapping[str, Any], until: float
) -> list[Parameter]:
    """Shift, gain and blur of every record, once each.

    A name in `vary` may hold the wildcards ``*`` and ``[01]``: all matching numbers become one.
    """
    groups: dict[str, list[tuple[int, str]]] = {name: [] for name in vary}
    for kind in KINDS:
        for k in range(len(measured)):
            path = f"{HEAD}{k}.{kind}"
            names = [name for name in vary if fnmatchcase(path, name)] or [path]
            if len(names) > 1:
                message = (
                    f"names {path}, which {names[0]} includes; leave one of them out"
                )
                raise refusal(f"vary.{names[1]}", message)
            groups.setdefault(names[0], []).append((k, kind))
    found = []
    for name, members in groups.items():
        alike = {
            (kind, measured[k].signal.unit if kind == "gain" else "s")
            for k, kind in members
        }
        if len(alike) != 1:
            raise refusal(
                f"vary.{name}",
                "is not one number of records, in one unit; give a name "
                f"such as {HEAD}0.shift, or {HEAD}*.gain for one gain of all",
            )
        ((kind, unit),) = alike
        records = tuple(k for k, _ in members)
        ends: tuple[float, float] | None = None
        if name not in vary:
            ends = measured[records[0]].limits[kind]
        elif vary[name] is not None or kind == "blur":
            ends = ends_of(name, vary[name], unit)
        if ends is None and kind == "shift":
            first, last = zip(
                *(measured[k].shifts(until, system) for k in records), strict=True
            )
            ends = min(first), max(last)
        low, high = ends or (-math.inf, math.inf)
        found.append(Parameter(name, low, high, unit, kind=kind, records=records))
    return found


def ends_of(path: str, bounds: Any, unit: str) -> tuple[float, float]:
    """Bounds of a parameter."""
    ends = array(f"vary.{path}", bounds, unit, "any")
    if ends.shape != (2,) or not ends[0] < ends[1]:
        message = (
            f"must be (low, high), two numbers with low < high, got {shown(bounds)}"
        )
        raise refusal(f"vary.{path}", message)
    return float(ends[0]), float(ends[1])


def changed(
    system: System, parameters: Sequence[Parameter], values: Sequence[float]
) -> System:
    """The system with these values; InvalidModel, which names the values, if they are invalid."""
    each = zip(parameters, values, strict=True)
    try:
        return with_numbers(system, {place: v for p, v in each for place in p.places})
    except InvalidModel as error:
        which = ", ".join(
            f"{p.path} = {v:.6g}" for p, v in zip(parameters, values, strict=True)
        )
        message = f"the bounds allow an invalid system ({which}): {error}"
        raise InvalidModel([("vary", f"{message}; narrow the bounds")]) from None
