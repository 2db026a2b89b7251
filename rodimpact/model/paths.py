"""Numbers of a system by their paths in a case file.

An entry is the path of a number in ``System.to_dict()``: ``bodies.0.material.density``.
The path ``materials.NAME.density`` has the entries of all bodies of this material. A
number may stand for another: a material has a ``wave_speed`` that stands for Young's
modulus at its density, a round rod an ``area`` that stands for its diameter.
"""

import math
from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import numpy as np

from ..hints import MOST_CHOICES, listed, nearest, similar
from ..units import MOST_SHOWN
from .bodies import Material, RigidMass, Rod, Segment
from .frozen import Number, QuantityField
from .shaft import SHAFTS
from .system import GAP, System

SPEED = "wave_speed"
MODULUS = "youngs_modulus"
ALTERNATIVES = {SPEED: MODULUS, "area": "diameter"}
"""Fields that may be given in place of others: key in place of value."""
FIELDS = {
    **Material.fields,
    **Segment.fields,
    **Rod.fields,
    **RigidMass.fields,
    SPEED: QuantityField("m/s"),
    "gravity": System.fields["gravity"],
    "gap": GAP,
    "step": QuantityField("s"),
}
"""Declarations of the numbers of a system, by their last name."""
for _kind in SHAFTS.values():
    FIELDS.update(_kind.fields)


class _Slot(NamedTuple):
    """Table of a description that holds a number, with the key of the number."""

    table: Any  # dictionary or list that holds the number
    key: Any  # its key or index there


def numbers_of(system: System) -> dict[str, Number]:
    """Every number of a system that can vary, by its entry: a float, or an array.

    An entry is a path of one number, such as ``bodies.0.material.density``. Beside the
    stored numbers there are those that may be given in their place: the wave speed
    c = sqrt(E/rho) of a material, and the area pi d^2/4 of a round rod.
    """
    stored_numbers = dict(system._numbers())
    numbers = dict(stored_numbers)
    for entry, value in stored_numbers.items():
        owner, _, field = entry.rpartition(".")
        if field == MODULUS:
            density = stored_numbers[f"{owner}.density"]
            speed = np.sqrt(value / density)
            # [()] makes a number of an array of shape ().
            numbers[f"{owner}.{SPEED}"] = speed[()]
        elif field == "diameter":
            numbers[f"{owner}.area"] = math.pi * value * value / 4
    return numbers


def entries_by_path(system: System) -> dict[str, list[str]]:
    """All paths that can name a varying number, each with the entries it stands for.

    An entry is a path that stands for itself alone. The path ``materials.NAME.density``
    stands for the entries of all bodies that are made of this material.
    """
    entries: dict[str, list[str]] = {}
    description = system.to_dict()
    for entry in numbers_of(system):
        entries[entry] = [entry]
        owner, _, field = entry.rpartition(".")
        if owner.endswith(".material"):
            material = _slot(description, entry).table
            path = f"materials.{material['name']}.{field}"
            entries.setdefault(path, []).append(entry)
    return entries


def alternative_of(entry: str) -> str:
    """Entry of the number that the number at `entry` replaces, see `ALTERNATIVES`.

    For "bodies.0.area" it is "bodies.0.diameter". An entry that replaces no other is
    returned itself.
    """
    owner, dot, field = entry.rpartition(".")
    return owner + dot + ALTERNATIVES.get(field, field)


def with_numbers(system: System, numbers: Mapping[str, float]) -> System:
    """New system with other numbers at entries; InvalidModel if the model refuses them.

    A wave speed c is set as the modulus E = rho c^2, with the new density rho if that
    is changed, too. An area A of a round rod is set as the diameter sqrt(4 A/pi). A
    negative speed or area is passed on as a negative modulus or diameter, so that the
    model refuses it.
    """
    description = system.to_dict()
    speeds = []  # tables of materials, with the wave speed that each shall have
    for entry, value in numbers.items():
        table, field = _slot(description, entry)
        if field == SPEED:
            speeds.append((table, value))
        elif field == "area" and "diameter" in table:
            diameter = np.sqrt(4 * np.abs(value) / math.pi)
            signed = np.copysign(diameter, value)
            table["diameter"] = signed[()]  # a number in place of an array of shape ()
        else:
            table[field] = value
    for table, speed in speeds:
        # The modulus has the sign of the speed.
        table[MODULUS] = table["density"] * speed * abs(speed)
    return System.from_dict(description)


def field_at(system: System, entry: str) -> QuantityField:
    """Declaration of the number at an entry of the system.

    A number of a contact law is declared in the class of the law. The declarations of
    all other numbers are in `FIELDS`, by the last word of the entry; without one there,
    a declaration without unit and of any sign is returned. IndexError or KeyError for a
    contact, or a number of its law, that the system does not have.
    """
    owner, _, field = entry.rpartition(".")
    if owner.startswith("contacts") and field != "gap":
        # Parts are contacts, the index, the field, and for a list the index in it.
        parts = entry.split(".")
        law = system.contacts[int(parts[1])]
        return law.fields[parts[2]]
    return FIELDS.get(field, QuantityField())


def unit_at(system: System, entry: str) -> str:
    """SI unit of the number at an entry; "" for a pure number or if none is known."""
    return field_at(system, entry).unit


def suggestion(path: str, choices: Collection[str]) -> str:
    """Hint at the choices that may be meant by an unknown path, for a message.

    Only the choices that share the longest beginning with the path are considered. If
    some of them end with the rest of the path, all of these are named: the area of a
    stepped rod, for example, is in its segments. Else the nearest choice is named. If
    none is near, all are listed, or only their next parts if there are more than
    `MOST_CHOICES`.
    """
    beginning = _shared_beginning(path, choices)
    last_parts = path.removeprefix(beginning)
    deeper = []
    for choice in choices:
        if choice.startswith(beginning) and choice.endswith("." + last_parts):
            deeper.append(choice)
    if deeper:
        return f"perhaps one of {listed(deeper)} is meant"
    remainders = []  # of the choices, behind the beginning
    for choice in choices:
        if choice.startswith(beginning):
            remainders.append(choice.removeprefix(beginning))
    none_is_near = similar(last_parts, remainders) is None
    if none_is_near and len(remainders) > MOST_CHOICES:
        beginnings: dict[str, None] = {}  # each once, in order
        for remainder in remainders:
            next_part, _, _ = remainder.partition(".")
            beginnings[beginning + next_part] = None
        return f"use one that begins with {listed(list(beginnings))}"
    return nearest(last_parts, remainders, beginning)


def _shared_beginning(path: str, choices: Collection[str]) -> str:
    """Longest beginning that a path shares with any choice, such as "bodies.0.".

    Only whole parts of the path count, and never the last one; "" if no part is shared.
    """
    # Only the beginning of a long text, pasted by mistake, is searched.
    parts = path[: 2 * MOST_SHOWN].split(".")[:-1]
    for n in range(len(parts), 0, -1):
        beginning = ".".join(parts[:n]) + "."
        for choice in choices:
            if choice.startswith(beginning):
                return beginning
    return ""


def _slot(description: Any, entry: str) -> _Slot:
    """Table and key at which a description holds the number at an entry.

    The description is that of ``System.to_dict()``; the table is a dictionary or a list
    in it. The key may be missing there: a ``wave_speed`` is not stored.
    """
    *steps, last = entry.split(".")
    table = description
    for step in steps:
        table = table[_key(step)]
    return _Slot(table, _key(last))


def _key(step: str) -> Any:
    """Key of a table, or index of a list, for a step of a path."""
    if step.isdecimal():
        return int(step)
    return step
