"""What a fit may change: numbers of a system between bounds, by the paths of a case file.

``materials.NAME.field`` is that of every body of this material. A material also has a
``wave_speed``, which stands for Young's modulus at its density.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from ..model import Material, RigidMass, Rod, Segment, System
from ..model.frozen import Field, InvalidModel, Problems, nearest
from ..model.quantities import floats
from ..units import shown

SPEED, MODULUS = "wave_speed", "youngs_modulus"
RATIO = 10.0  # of bounds from which on what lies between is divided in equal ratios
FIELDS = {
    **Material.fields, **Segment.fields, **Rod.fields, **RigidMass.fields, SPEED: Field("m/s"),
    "gravity": System.fields["gravity"], "gap": System.fields["gaps"], "step": Field("s"),
}


class Parameter(NamedTuple):
    """A number that a fit varies.

    path : of a case file; places : in ``System.to_dict()``, all with this number; start : that of
    the system; low, high : bounds; unit : of SI.
    """

    path: str
    places: list[str]
    start: float
    low: float
    high: float
    unit: str

    def value(self, share: float) -> float:
        """The number at this share of the way from `low` to `high`."""
        if self.by_ratio:
            return float(self.low * (self.high / self.low) ** share)
        return float(self.low + (self.high - self.low) * share)

    def share(self, value: float) -> float:
        """The share of the way from `low` to `high` at which this number lies, or the nearest."""
        value = min(max(value, self.low), self.high)
        if self.by_ratio:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def slope(self, share: float) -> float:
        """Derivative of the number with respect to the share."""
        if self.by_ratio:
            return self.value(share) * math.log(self.high / self.low)
        return self.high - self.low

    @property
    def by_ratio(self) -> bool:
        """Whether equal steps are equal ratios."""
        return self.low > 0 and self.high / self.low >= RATIO


def parameters_of(system: System, vary: Any) -> list[Parameter]:
    """The numbers to vary, each with its bounds; InvalidModel with all mistakes."""
    if not isinstance(vary, Mapping) or not vary:
        message = "must name numbers with their bounds, such as {'bodies.0.length': (0.1, 0.2)}"
        raise InvalidModel([("vary", f"{message}, got {shown(vary)}")])
    problems: Problems = []
    known, described, taken = _places(system), system.to_dict(), dict[str, str]()
    found = []
    for path, bounds in vary.items():
        if path not in known:
            problems.append((f"vary.{path}", f"is no number of the system; {nearest(path, known)}"))
            continue
        unit = _unit(system, known[path][0])
        try:
            ends = floats(bounds, unit)
        except ValueError as error:
            problems.append((f"vary.{path}", str(error)))
            continue
        if ends.shape != (2,) or not (np.isfinite(ends).all() and ends[0] < ends[1]):
            message = f"must be (low, high), two numbers with low < high, got {shown(bounds)}"
            problems.append((f"vary.{path}", message))
            continue
        for place in known[path]:
            other = taken.setdefault(place.replace(SPEED, MODULUS), path)
            if other != path:
                message = f"is varied as {other} already; leave one of them out"
                problems.append((f"vary.{path}", message))
                break
        table, field = _at(described, known[path][0])
        start = math.sqrt(table[MODULUS] / table["density"]) if field == SPEED else table[field]
        low, high = ends.tolist()
        found.append(Parameter(path, known[path], start, low, high, unit))
    if problems:
        raise InvalidModel(problems)
    return found


def changed(system: System, parameters: Sequence[Parameter], values: Sequence[float]) -> System:
    """The system with these numbers; InvalidModel, which names them, if there is none."""
    described = system.to_dict()
    each = [(*_at(described, place), value)
            for p, value in zip(parameters, values, strict=True) for place in p.places]
    for table, field, value in sorted(each, key=lambda one: one[1] == SPEED):
        if field == SPEED:
            table[MODULUS] = table["density"] * value * abs(value)
        else:
            table[field] = value
    try:
        return System.from_dict(described)
    except InvalidModel as error:
        which = ", ".join(f"{p.path} = {v:.6g}" for p, v in zip(parameters, values, strict=True))
        message = f"between the bounds lie systems that are none ({which}): {error}"
        raise InvalidModel([("vary", f"{message}; narrow the bounds")]) from None


def _places(system: System) -> dict[str, list[str]]:
    """Every number that can vary: by its path the places in ``system.to_dict()``."""
    found: dict[str, list[str]] = {}
    described = system.to_dict()
    for path, _ in system._named_numbers():
        found[path] = [path]
        owner, _, field = path.rpartition(".")
        if owner.endswith(".material"):
            for name in (field, SPEED) if field == MODULUS else (field,):
                place = f"{owner}.{name}"
                found[place] = [place]
                table, _ = _at(described, place)
                found.setdefault(f"materials.{table['name']}.{name}", []).append(place)
    return found


def _at(described: Any, place: str) -> tuple[Any, Any]:
    """The table or list of a description that holds a number, and the key of this."""
    *steps, last = (int(step) if step.isdecimal() else step for step in place.split("."))
    return reduce(lambda table, step: table[step], steps, described), last


def _unit(system: System, place: str) -> str:
    """SI unit of the number at a place."""
    owner, _, field = place.rpartition(".")
    if owner.startswith("contacts") and field != "gap":
        law = system.contacts[int(owner.removeprefix("contacts."))]
        return law.fields[field].unit
    return FIELDS.get(field, Field()).unit
