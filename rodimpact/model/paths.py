"""Numbers of a system by the paths of a case file: where they stand, and the system with others.

``materials.NAME.field`` is that of every body of this material. A material also has a
``wave_speed``, which stands for Young's modulus at its density.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from typing import Any

import numpy as np

from .bodies import Material, RigidMass, Rod, Segment
from .frozen import Field, Number
from .system import System

SPEED, MODULUS = "wave_speed", "youngs_modulus"
FIELDS = {
    **Material.fields, **Segment.fields, **Rod.fields, **RigidMass.fields, SPEED: Field("m/s"),
    "gravity": System.fields["gravity"], "gap": System.fields["gaps"], "step": Field("s"),
}


def places_of(system: System) -> dict[str, list[str]]:
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


def number_at(system: System, place: str) -> Number:
    """The number at a place; of a family, as it was given."""
    owner, _, field = place.rpartition(".")
    numbers = dict(system._named_numbers())
    if field != SPEED:
        return numbers[place]
    return np.sqrt(numbers[f"{owner}.{MODULUS}"] / numbers[f"{owner}.density"])[()]


def with_numbers(system: System, numbers: Mapping[str, float]) -> System:
    """The system with these numbers at these places; InvalidModel if there is none."""
    described = system.to_dict()
    each = [(*_at(described, place), value) for place, value in numbers.items()]
    for table, field, value in sorted(each, key=lambda one: one[1] == SPEED):
        if field == SPEED:
            table[MODULUS] = table["density"] * value * abs(value)
        else:
            table[field] = value
    return System.from_dict(described)


def unit_at(system: System, place: str) -> str:
    """SI unit of the number at a place."""
    owner, _, field = place.rpartition(".")
    if owner.startswith("contacts") and field != "gap":
        law = system.contacts[int(owner.removeprefix("contacts."))]
        return law.fields[field].unit
    return FIELDS.get(field, Field()).unit


def _at(described: Any, place: str) -> tuple[Any, Any]:
    """The table or list of a description that holds a number, and the key of this."""
    *steps, last = (int(step) if step.isdecimal() else step for step in place.split("."))
    return reduce(lambda table, step: table[step], steps, described), last
