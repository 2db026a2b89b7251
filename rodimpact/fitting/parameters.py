"""Parameters of a fit: numbers of a system or of its records, by their paths.

Every parameter is searched for on a scale of its own. On this scale a number of the
system is its share of the way from its lower to its upper bound, and a number of
records is itself.
"""

import math
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Any, NamedTuple, TypeAlias

from ..model import System
from ..model.arguments import array
from ..model.frozen import InvalidModel, invalid_argument
from ..model.paths import (
    alternative_of,
    entries_by_path,
    numbers_of,
    suggestion,
    unit_at,
    with_numbers,
)
from ..units import shown
from .measured import Measured, trend_unit

RECORD_PREFIX = "records."
KINDS = ("shift", "gain", "blur", "offset", "trend")
"""Kinds of numbers that a record has; SHIFT to TREND are their indices."""
SHIFT = 0
GAIN = 1
BLUR = 2
OFFSET = 3
TREND = 4
RATIO_RANGE = 10.0
"""Ratio of positive bounds from which a range is divided in equal ratios."""


class SystemParameter(NamedTuple):
    """A number of the system that a fit varies."""

    path: str  # its name
    low: float  # bounds
    high: float
    unit: str
    initial: float  # value in the system
    # Paths in ``System.to_dict()`` of all numbers with this value
    entries: Sequence[str]

    @property
    def is_by_ratio(self) -> bool:
        """Whether equal steps of the share are equal ratios of the number."""
        return spans_a_ratio(self.low, self.high)

    @property
    def scaled_bounds(self) -> tuple[float, float]:
        """Bounds of the share."""
        return 0.0, 1.0

    @property
    def _offset(self) -> float:
        """The number, or its logarithm, at the share 0."""
        if self.is_by_ratio:
            return math.log(self.low)
        return self.low

    @property
    def _extent(self) -> float:
        """Increase of the number, or of its logarithm, up to the share 1."""
        if self.is_by_ratio:
            return math.log(self.high) - math.log(self.low)
        return self.high - self.low

    def value(self, share: float) -> float:
        """The number at a share, which grows linearly with it, or by equal ratios.

        The share 0 gives the lower bound, the share 1 the upper one. The ratios are
        those of `is_by_ratio`.
        """
        x = self._offset + self._extent * share
        if self.is_by_ratio:
            return math.exp(x)
        return x

    def share(self, value: float) -> float:
        """Share of a number; 0 or 1 if it is below or above the bounds."""
        x = min(max(value, self.low), self.high)
        if self.is_by_ratio:
            x = math.log(x)
        return (x - self._offset) / self._extent

    def slope(self, share: float) -> float:
        """Derivative of the number with respect to the share, at a share."""
        if self.is_by_ratio:
            return self._extent * self.value(share)
        return self._extent


class RecordParameter(NamedTuple):
    """A number of one or several records that a fit varies; it is not scaled."""

    path: str  # its name
    low: float  # bounds, infinite if it is free
    high: float
    unit: str
    kind: str  # one of `KINDS`
    records: tuple[int, ...]  # indices of its records

    @property
    def scaled_bounds(self) -> tuple[float, float]:
        """Bounds of the number."""
        return self.low, self.high

    def value(self, number: float) -> float:
        """The number."""
        return number

    def slope(self, _number: float) -> float:
        """Derivative of `value`."""
        return 1.0


Parameter: TypeAlias = SystemParameter | RecordParameter


def spans_a_ratio(low: float, high: float) -> bool:
    """Whether a range is divided in equal ratios: from a factor of 10 on."""
    return low > 0 and high / low >= RATIO_RANGE


def share_of_range(value: float, low: float, high: float) -> float:
    """Share of the way from `low` to `high`, by ratios if the range spans a ratio."""
    if spans_a_ratio(low, high):
        return math.log(value / low) / math.log(high / low)
    return (value - low) / (high - low)


# Numbers of the system ----------------------------------------------------------------


def system_parameters(system: System, vary: Mapping[str, Any]) -> list[SystemParameter]:
    """Numbers of the system to vary, each with its bounds.

    Raises
    ------
    InvalidModel
        If the system has no such number, two names vary one number, or bounds are
        invalid.
    """
    entries = entries_by_path(system)
    numbers = numbers_of(system)
    # Path in `vary` by each entry; a wave speed has the entry of its Young's modulus.
    path_that_varies: dict[str, str] = {}
    parameters = []
    for path, bounds in vary.items():
        if path not in entries:
            hint = suggestion(str(path), entries)
            message = f"is not a parameter of the system; {hint}"
            raise invalid_argument(f"vary.{path}", message)
        first_entry = entries[path][0]
        unit = unit_at(system, first_entry)
        for entry in entries[path]:
            earlier_path = path_that_varies.setdefault(alternative_of(entry), path)
            if earlier_path != path:
                message = f"is already varied as {earlier_path}; leave one of them out"
                raise invalid_argument(f"vary.{path}", message)
        initial = float(numbers[first_entry])
        low, high = checked_bounds(path, bounds, unit)
        parameters.append(
            SystemParameter(path, low, high, unit, initial, entries[path])
        )
    return parameters


def with_values(
    system: System, parameters: Sequence[SystemParameter], values: Sequence[float]
) -> System:
    """The system with these values of its parameters.

    Raises
    ------
    InvalidModel
        If the values are invalid; the message names them.
    """
    value_at: dict[str, float] = {}
    for parameter, value in zip(parameters, values, strict=True):
        value_at |= dict.fromkeys(parameter.entries, value)
    try:
        return with_numbers(system, value_at)
    except InvalidModel as error:
        equations = []
        for parameter, value in zip(parameters, values, strict=True):
            equations.append(f"{parameter.path} = {value:.6g}")
        message = f"the bounds allow an invalid system ({', '.join(equations)}): "
        message += f"{error}; narrow the bounds"
        raise InvalidModel([("vary", message)]) from None


def checked_bounds(path: str, bounds: Any, unit: str) -> tuple[float, float]:
    """Bounds (low, high) of a parameter in SI units.

    InvalidModel is raised unless they are two finite numbers with low < high.
    """
    # Any `sign` makes `array` refuse NaN and infinity.
    ends = array(f"vary.{path}", bounds, unit, sign="any")
    if ends.shape != (2,) or not ends[0] < ends[1]:
        message = (
            f"must be (low, high), two numbers with low < high, got {shown(bounds)}"
        )
        raise invalid_argument(f"vary.{path}", message)
    return float(ends[0]), float(ends[1])


# Numbers of records -------------------------------------------------------------------


class RecordNumber(NamedTuple):
    """A number of one record."""

    record: int
    kind: str


def record_parameters(
    system: System, measured: Sequence[Measured], vary: Mapping[str, Any], until: float
) -> list[RecordParameter]:
    """Shift, gain, blur, offset and trend of every record, once each.

    A name in `vary` may hold the wildcards ``*`` and ``[01]``: all matching numbers
    become one parameter. Numbers that `vary` does not name keep the limits of their
    record. With the bounds None a shift may be any at which a prediction overlaps its
    record, gain, offset and trend are free, and a blur is refused.
    """
    parameters = []
    for name, numbers in _numbers_by_name(len(measured), vary).items():
        kind, unit = _common_kind_and_unit(name, numbers, measured)
        records = tuple(number.record for number in numbers)
        bounds: tuple[float, float] | None = None  # None: the number is free
        if name not in vary:  # the path of a number of a single record
            bounds = measured[records[0]].limits[kind]
        elif vary[name] is not None or kind == "blur":  # a blur must have bounds
            bounds = checked_bounds(name, vary[name], unit)
        if bounds is None and kind == "shift":
            bounds = _overlapping_shifts([measured[k] for k in records], until, system)
        elif bounds is None:
            bounds = (-math.inf, math.inf)
        low, high = bounds
        parameters.append(RecordParameter(name, low, high, unit, kind, records))
    return parameters


def _numbers_by_name(
    record_count: int, vary: Mapping[str, Any]
) -> dict[str, list[RecordNumber]]:
    """Numbers of records by the name in `vary` that they match, or by their path.

    A number that no name matches is alone under its path. A name that matches no number
    has an empty list. InvalidModel is raised if two names match one number.
    """
    numbers_of_name: dict[str, list[RecordNumber]] = {name: [] for name in vary}
    for kind in KINDS:
        for k in range(record_count):
            path = f"{RECORD_PREFIX}{k}.{kind}"
            names = [name for name in vary if fnmatchcase(path, name)]
            if len(names) > 1:
                message = (
                    f"names {path}, which {names[0]} includes; leave one of them out"
                )
                raise invalid_argument(f"vary.{names[1]}", message)
            name = names[0] if names else path
            numbers_of_name.setdefault(name, []).append(RecordNumber(k, kind))
    return numbers_of_name


def _common_kind_and_unit(
    name: str, numbers: list[RecordNumber], measured: Sequence[Measured]
) -> tuple[str, str]:
    """Kind and unit of all numbers with one name; InvalidModel if they differ.

    An unknown name, which has no numbers, raises the same error.
    """
    kinds_and_units = set()
    for number in numbers:
        unit = "s"
        if number.kind in ("gain", "offset"):
            unit = measured[number.record].signal.unit
        elif number.kind == "trend":
            unit = trend_unit(measured[number.record].signal.unit)
        kinds_and_units.add((number.kind, unit))
    if len(kinds_and_units) != 1:
        message = (
            "is not one number of records, in one unit; give a name such as "
            f"{RECORD_PREFIX}0.shift, or {RECORD_PREFIX}*.gain for one gain of all"
        )
        raise invalid_argument(f"vary.{name}", message)
    return kinds_and_units.pop()


def _overlapping_shifts(
    records: Sequence[Measured], until: float, system: System
) -> tuple[float, float]:
    """Smallest and largest shift of predictions that overlap any of the records, s."""
    smallest = []
    largest = []
    for record in records:
        low, high = record.overlapping_shifts(until, system)
        smallest.append(low)
        largest.append(high)
    return min(smallest), max(largest)
