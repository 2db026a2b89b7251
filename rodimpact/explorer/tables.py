"""From the tables of a case to a system, in Python that the page has as JavaScript.

Mistakes are told in the words of the model: `RULES` are its fields. What the page cannot solve is
named.
"""

from __future__ import annotations

import math
from collections import namedtuple
from typing import Any

from ..methods.abilities import (
    COMPLIANCE,
    DAMPING,
    GRAVITY,
    JOINTS,
    LATERAL,
    MASSES,
    OWN_LAWS,
    SMOOTH_DRIVES,
    SMOOTH_STATES,
    TAPER,
)
from ..model import Bonded, Material, Rigid, RigidMass, Rod, Segment, System, Wall
from ..model.frozen import LARGEST, OUT_OF_SCALE, SMALLEST, Field, wanted
from ..model.laws import Hertz, HuntCrossley, PowerLaw, Spring, SpringDashpot
from ..model.profiles import Steps

LAWS = (Rigid, Bonded, Spring, SpringDashpot, Hertz, HuntCrossley, PowerLaw)
RULES: dict[str, dict[str, tuple[str, str]]] = {
    table: {name: (fields[name].sign, wanted(fields[name].unit, fields[name].sign)[:-11])
            for name in names}
    for table, fields, names in (
        ("segment", Segment.fields, ("length", "area")), ("rod", Rod.fields, tuple(Rod.fields)),
        ("wall", Wall.fields, ("velocity",)), ("mass", RigidMass.fields, ("mass", "velocity")),
        *((law.law, law.fields, tuple(law.fields)) for law in LAWS),
        ("contact", {"gap": System.fields["gaps"]}, ("gap",)),
        ("material", Material.fields, ("youngs_modulus", "density")),
        ("gauge", {"fraction": Field("", "[0, 1]")}, ("fraction",)),
    )
}
"""By table and field its sign, and what it must be."""
NUMBERS = {law.law: list(law.fields) for law in LAWS}
PROFILES = "profiles in one row with compliant contacts or rigid masses"
SCALE = OUT_OF_SCALE[:-11]
MOST_EVENTS = 20_000  # fronts that arrive at an end: an answer comes while a slider is dragged


def is_smooth(case: Any) -> bool:
    """Whether characteristics solve a case: fronts carry no masses and no compliant contacts."""
    asked = case.get("solve", {}).get("method", "auto")
    laws = [contact.get("law", "rigid") for contact in case.get("contacts", [])]
    compliant = any(law not in ("rigid", "bonded") for law in laws)
    masses = any(body["kind"] == "mass" for body in case["bodies"])
    return asked == "characteristics" or (asked == "auto" and (compliant or masses))


def contacts_in(case: Any) -> Any:
    """The tables of all contacts."""
    return case.get("contacts", [{} for _ in range(len(case["bodies"]) - 1)])


def lacking(case: Any) -> tuple[str, str]:
    """Path and name of the first thing that the page cannot solve; "" if there is none."""
    asked = case.get("solve", {}).get("method", "auto")
    if asked not in ("auto", "fronts", "characteristics"):
        return "solve.method", f'the method "{asked}"'
    if case.get("gravity", 0) != 0:
        return "gravity", GRAVITY
    smooth, ends = is_smooth(case), case.get("ends", {})
    profiles: list[Any] = []
    entries: list[Any] = []  # with their paths, and what may be in them
    for i, body in enumerate(case["bodies"]):
        path = f"bodies.{i}"
        if body["kind"] == "mass" and not smooth:
            return path, MASSES
        for piece in pieces_of(body):
            if piece.get("lateral_inertia", piece.get("polar_moment")) is not None:
                return path, LATERAL
            if isinstance(piece.get("area"), dict):
                return path, TAPER
        profiles.extend([(f"{path}.{key}", body.get(key, 0), SMOOTH_STATES)
                         for key in ("velocity", "strain")])
        entries.append((path, body, (
            "kind", "segments", "velocity", "strain", "length", "area", "material", "mass")))
        entries.extend([(path, piece, ("length", "area", "material"))
                        for piece in body.get("segments", [])])
    for i, contact in enumerate(case.get("contacts", [])):
        path, law = f"contacts.{i}", contact.get("law", "rigid")
        rods = any(body["kind"] == "rod" for body in case["bodies"][i : i + 2])
        numbers = [] if law == "rigid" and rods else NUMBERS.get(law)  # waves decide e of rods
        if numbers is None:
            names = {"joint": JOINTS, "own": OWN_LAWS}
            return path, names.get(law, f'the contact law "{law}"')
        if law not in ("rigid", "bonded") and not smooth:
            return path, COMPLIANCE
        if law == "bonded" and not rods:
            return path, "rigid bodies that are bonded"
        entries.append((path, contact, ("gap", "law", *numbers)))
    used = [piece.get("material", "") for body in case["bodies"] for piece in pieces_of(body)]
    for name, material in case.get("materials", {}).items():
        path = f"materials.{name}"
        for key in ("viscosity", "loss_factor"):
            if material.get(key, 0) != 0 and any(name == one for one in used):
                return path, DAMPING
        entries.append((
            path, material, ("youngs_modulus", "density", "poisson_ratio", "viscosity")))
    profiles.extend([(f"ends.{side}", ends.get(side, {}).get("value", 0), SMOOTH_DRIVES)
                     for side in ("left", "right")])
    for path, profile, what in profiles:
        if isinstance(profile, dict) and ("samples" in profile or smooth):
            return path, what if "samples" in profile else PROFILES
    for path, table, known in entries:
        for key, value in table.items():
            if value is not None and all(key != name for name in known):
                return f"{path}.{key}", f"the entry {key}"
    return "", ""


def pieces_of(body: Any) -> Any:
    """Tables with the segments of a body; none of a wall."""
    if "segments" in body:
        return body["segments"]
    return [body] if body["kind"] == "rod" else []


def mistakes(case: Any, gauges: Any, library: Any, rules: Any) -> list[Any]:
    """Path and sentence of each mistake in a case that fronts can carry, and in its gauges."""
    found: list[Any] = []
    rods = [i for i, body in enumerate(case["bodies"]) if body["kind"] == "rod"]
    pairs = len(case["bodies"]) - 1
    if len(rods) == 0:
        found.append(("bodies", "needs at least one rod"))
    if len(contacts_in(case)) != pairs:
        found.append(("contacts", f"needs one entry for each neighbouring pair, {pairs} in all"))
    for i, gauge in enumerate(gauges):
        check(found, f"gauges.{i}", gauge, rules["gauge"])
        if all(gauge["body"] != rod for rod in rods):
            found.append((f"gauges.{i}.body", "must be the number of a rod"))
    until = case.get("solve", {}).get("until", 1.0)
    if not isinstance(until, float) or not math.isfinite(until) or until <= 0:
        found.append(("solve.until", "must be above 0 for a picture"))
    known = {**library, **case.get("materials", {})}
    for name, material in case.get("materials", {}).items():
        check(found, f"materials.{name}", material, rules["material"])
    for i, body in enumerate(case["bodies"]):
        path = f"bodies.{i}"
        if body["kind"] == "wall" and 0 < i < len(case["bodies"]) - 1:
            found.append((path, "a wall may stand only at an end of the row"))
        check(found, path, body, rules[body["kind"]])
        for j, piece in enumerate(pieces_of(body)):
            where = f"{path}.segments.{j}" if "segments" in body else path
            check(found, where, piece, rules["segment"])
            if piece.get("material", "") not in known:
                found.append((f"{where}.material", "unknown material"))
    for i, contact in enumerate(case.get("contacts", [])):
        law = contact.get("law", "rigid")
        check(found, f"contacts.{i}", contact, {**rules["contact"], **rules[law]})
        pair = [body["kind"] for body in case["bodies"][i : i + 2]]
        waves = any(kind == "rod" for kind in pair) or all(kind != "mass" for kind in pair)
        if law == "rigid" and not waves and contact.get("restitution") is None:
            message = "no wave decides this contact: give its restitution, or a compliant law"
            found.append((f"contacts.{i}", message))
        if law == "bonded" and contact.get("gap", 0) != 0:
            found.append((f"contacts.{i}.gap", "must be 0 where bodies are bonded"))
    return found


def check(found: list[Any], path: str, table: Any, rules: Any) -> None:
    """Note the numbers of a table that are not what they must be."""
    for key, (sign, sentence) in rules.items():
        value = table.get(key, 0.0)
        if sign == "positive" and key not in table:
            found.append((f"{path}.{key}", "is missing"))
        elif not isinstance(value, dict):
            number = isinstance(value, float) and math.isfinite(value)
            given, wrong = "no number", sentence
            if isinstance(value, float):
                given = f"{value:.6g}"
            if number and (sign == "any" or value > 0 or (value == 0 and sign != "positive")) and (
                (sign != "[0, 1]" or value <= 1) and (sign != "[1, inf)" or value >= 1)
            ):
                size, wrong = abs(value), ""
                if size > LARGEST or (sign == "positive" and size < SMALLEST):
                    wrong = SCALE
            if wrong != "":
                found.append((f"{path}.{key}", f"{wrong}, got {given}"))


# A case as a system -------------------------------------------------------------------------------


# What stands in a row, by the names of the model.
Stuff = namedtuple("Stuff", "name density youngs_modulus")
Piece = namedtuple("Piece", "length area material wave_speed impedance transit_time mass")
Body = namedtuple("Body", "kind segments mass velocity strain")  # a wall has no mass
Contact = namedtuple("Contact", "law opens restitution stiffness exponent damping")
End = namedtuple("End", "kind value")
Row = namedtuple("Row", "bodies gaps contacts gravity ends")

Asked = namedtuple("Asked", "until max_events")
"""What a case asks of a run: its end, s, negative where there is none; the cap on events."""


def system_of(case: Any, library: Any) -> Row:
    """A case without mistakes that the page can solve, as a system."""
    contacts, ends = contacts_in(case), case.get("ends", {})
    materials = {**library, **case.get("materials", {})}
    return Row(
        [body_of(body, materials) for body in case["bodies"]],
        [contact.get("gap", 0.0) for contact in contacts],
        [law_of(contact) for contact in contacts], 0.0,
        [End(end["kind"], profile_of(end.get("value", 0.0))) for end in (
            ends.get("left", {"kind": "free"}), ends.get("right", {"kind": "free"}))])


def asked_of(case: Any) -> Asked:
    """What a case asks of a run."""
    solve = case.get("solve", {})
    return Asked(solve.get("until", -1.0), min(solve.get("max_events", MOST_EVENTS), MOST_EVENTS))


def body_of(table: Any, materials: Any) -> Body:
    """A body from its table."""
    segments, mass = [], table.get("mass", 0.0)
    for piece in pieces_of(table):
        material, length = materials[piece["material"]], piece["length"]
        stuff = Stuff(piece["material"], material["density"], material["youngs_modulus"])
        speed = math.sqrt(stuff.youngs_modulus / stuff.density)
        Z, T = stuff.density * piece["area"] * speed, length / speed
        segments.append(Piece(length, piece["area"], stuff, speed, Z, T, Z * T))
        mass += Z * T
    return Body(table["kind"], segments, mass, profile_of(table.get("velocity", 0.0)),
                profile_of(table.get("strain", 0.0)))


def law_of(contact: Any) -> Contact:
    """A contact law from its table."""
    law = contact.get("law", "rigid")
    exponent = 1.0 if law in ("spring", "spring-dashpot") else contact.get("exponent", 1.5)
    return Contact(law, law != "bonded", contact.get("restitution"), contact.get("stiffness", 0.0),
                   exponent, contact.get("damping", 0.0))


def profile_of(value: Any) -> Any:
    """A number, or steps from their table."""
    return steps(value) if isinstance(value, dict) else value


def steps(table: Any) -> Any:
    """Steps from their table; the page has this under another name, as its tables are objects."""
    return Steps(table["values"], table["at"])
