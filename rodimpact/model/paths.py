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


def numbers_of(system: System) -> dict[str, Number]:
    """Every number that can vary, by its place in ``System.to_dict()``."""
    numbers = dict(system._named_numbers())
    for place, E in list(numbers.items()):
        if place.endswith(MODULUS):
            owner = place.removesuffix(MODULUS)
            numbers[owner + SPEED] = np.sqrt(E / numbers[owner + "density"])[()]
    return numbers


def places_of(system: System) -> dict[str, list[str]]:
    """Every path of a number that can vary, with the places of it in ``System.to_dict()``."""
    found, described = dict[str, list[str]](), system.to_dict()
    for place in numbers_of(system):
        found[place] = [place]
        owner, _, field = place.rpartition(".")
        if owner.endswith(".material"):
            table, _ = _at(described, place)
            found.setdefault(f"materials.{table['name']}.{field}", []).append(place)
    return found


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
