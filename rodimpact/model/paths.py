"""Numbers of a system by the paths of a case file: which there are, and the system with others.

``materials.NAME.field`` is that of every body of this material. A material also has a
``wave_speed``, which stands for Young's modulus at its density, and a round rod an ``area``, which
stands for its diameter.
"""

import math
from collections.abc import Collection, Mapping
from functools import reduce
from typing import Any

import numpy as np

from ..units import MOST_SHOWN
from .bodies import Material, RigidMass, Rod, Segment
from .frozen import MOST_CHOICES, Field, Number, listed, nearest
from .system import GAP, System

SPEED, MODULUS = "wave_speed", "youngs_modulus"
STAND_INS = {SPEED: MODULUS, "area": "diameter"}
"""Fields that stand for others."""
FIELDS = {
    **Material.fields,
    **Segment.fields,
    **Rod.fields,
    **RigidMass.fields,
    SPEED: Field("m/s"),
    "gravity": System.fields["gravity"],
    "gap": GAP,
    "step": Field("s"),
}


def numbers_of(system: System) -> dict[str, Number]:
    """Every number that can vary, by its place in ``System.to_dict()``."""
    numbers = dict(system._numbers())
    for place, value in list(numbers.items()):
        owner, _, field = place.rpartition(".")
        if field == MODULUS:
            numbers[f"{owner}.{SPEED}"] = np.sqrt(value / numbers[f"{owner}.density"])[
                ()
            ]
        elif field == "diameter":
            numbers[f"{owner}.area"] = math.pi * value * value / 4
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


def held_at(place: str) -> str:
    """The place of the number for which the one at a place may stand."""
    owner, dot, field = place.rpartition(".")
    return owner + dot + STAND_INS.get(field, field)


def with_numbers(system: System, numbers: Mapping[str, float]) -> System:
    """The system with these numbers at these places; InvalidModel if there is none."""
    described = system.to_dict()
    each = [(*_at(described, place), value) for place, value in numbers.items()]
    for table, field, value in sorted(each, key=lambda one: one[1] == SPEED):
        if field == SPEED:
            table[MODULUS] = table["density"] * value * abs(value)
        elif field == "area" and "diameter" in table:
            table["diameter"] = np.copysign(
                np.sqrt(4 * np.abs(value) / math.pi), value
            )[()]
        else:
            table[field] = value
    return System.from_dict(described)


def field_at(system: System, place: str) -> Field:
    """Declaration of the number at a place."""
    owner, _, field = place.rpartition(".")
    if owner.startswith("contacts") and field != "gap":
        _, i, *table = owner.split(".")
        return system.contacts[int(i)].fields[table[0] if table else field]
    return FIELDS.get(field, Field())


def unit_at(system: System, place: str) -> str:
    """SI unit of the number at a place."""
    return field_at(system, place).unit


def suggestion(path: str, known: Collection[str]) -> str:
    """Which of the known paths may be meant: the nearest of the same object, or what there is."""
    *parts, _ = path[: 2 * MOST_SHOWN].split(".")
    heads = [".".join([*parts[:n], ""]) for n in range(len(parts), 0, -1)]
    head = next((h for h in heads if any(choice.startswith(h) for choice in known)), "")
    inside = [choice.removeprefix(head) for choice in known if choice.startswith(head)]
    said = nearest(path.removeprefix(head), inside, head)
    if len(inside) > MOST_CHOICES and said.startswith("use one of"):
        starts = dict.fromkeys(head + choice.partition(".")[0] for choice in inside)
        said = f"use one that begins with {listed(list(starts))}"
    return said


def _at(described: Any, place: str) -> tuple[Any, Any]:
    """The table or list of a description that holds a number, and the key of this."""
    *steps, last = (
        int(step) if step.isdecimal() else step for step in place.split(".")
    )
    return reduce(lambda table, step: table[step], steps, described), last
