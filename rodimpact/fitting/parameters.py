"""Parameters of a fit: numbers of a system, by the paths of a case file, or of its records."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..model import System
from ..model.frozen import InvalidModel, Problems
from ..model.paths import held_at, numbers_of, places_of, suggestion, unit_at, with_numbers
from ..model.quantities import floats
from ..units import shown

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
        low, high = map(math.log, (self.low, self.high)) if self.by_ratio else (self.low, self.high)
        return low, high - low

    def value(self, share: float) -> float:
        """The number at this share of the way from `low` to `high`, or where it is not scaled."""
        start, slope = self.line
        return math.exp(start + slope * share) if self.by_ratio else start + slope * share

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
        return not self.kind and self.low > 0 and self.high / self.low >= RATIO


def parameters_of(
    problems: Problems, system: System, vary: Mapping[str, Any]
) -> list[Parameter]:
    """The parameters to vary, each with its bounds; errors are added to `problems`."""
    known, numbers, taken = places_of(system), numbers_of(system), dict[str, str]()
    found = []
    for path, bounds in vary.items():
        if path not in known:
            message = f"is not a parameter of the system; {suggestion(str(path), known)}"
            problems.append((f"vary.{path}", message))
            continue
        unit = unit_at(system, known[path][0])
        if (ends := ends_of(problems, path, bounds, unit)) is None:
            continue
        for place in known[path]:
            other = taken.setdefault(held_at(place), path)
            if other != path:
                message = f"is already varied as {other}; leave one of them out"
                problems.append((f"vary.{path}", message))
                break
        start = float(numbers[known[path][0]])
        found.append(Parameter(path, *ends, unit, start, known[path]))
    return found


def ends_of(
    problems: Problems, path: str, bounds: Any, unit: str
) -> tuple[float, float] | None:
    """Bounds of a parameter; None, and an entry in `problems`, if they are invalid."""
    try:
        ends = floats(bounds, unit)
    except ValueError as error:
        problems.append((f"vary.{path}", str(error)))
        return None
    if ends.shape != (2,) or not (np.isfinite(ends).all() and ends[0] < ends[1]):
        message = f"must be (low, high), two numbers with low < high, got {shown(bounds)}"
        problems.append((f"vary.{path}", message))
        return None
    return float(ends[0]), float(ends[1])


def changed(system: System, parameters: Sequence[Parameter], values: Sequence[float]) -> System:
    """The system with these values; InvalidModel, which names the values, if they are invalid."""
    each = zip(parameters, values, strict=True)
    try:
        return with_numbers(system, {place: v for p, v in each for place in p.places})
    except InvalidModel as error:
        which = ", ".join(f"{p.path} = {v:.6g}" for p, v in zip(parameters, values, strict=True))
        message = f"the bounds allow an invalid system ({which}): {error}"
        raise InvalidModel([("vary", f"{message}; narrow the bounds")]) from None
