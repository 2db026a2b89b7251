"""From the tables of a case to a system, in Python that the page has as JavaScript.

Mistakes are told in the words of the model: `RULES` are its fields. What the page cannot solve is
named.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

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
    smooth = is_smooth(case)
    if case.get("gravity", 0) != 0:
        return "gravity", GRAVITY
    for i, body in enumerate(case["bodies"]):
        if body["kind"] == "mass" and not smooth:
            return f"bodies.{i}", MASSES
        for key in ("velocity", "strain"):
            if sampled(body.get(key, 0)):
                return f"bodies.{i}.{key}", SMOOTH_STATES
            if smooth and isinstance(body.get(key, 0), dict):
                return f"bodies.{i}.{key}", PROFILES
        for piece in pieces_of(body):
            if piece.get("lateral_inertia", piece.get("polar_moment")) is not None:
                return f"bodies.{i}", LATERAL
            if isinstance(piece.get("area"), dict):
                return f"bodies.{i}", TAPER
        key = other_key(
            body, ("kind", "segments", "velocity", "strain", "length", "area", "material", "mass"))
        for piece in body.get("segments", []):
            key = other_key(piece, ("length", "area", "material")) if key == "" else key
        if key != "":
            return f"bodies.{i}.{key}", f"the entry {key}"
    for i, contact in enumerate(case.get("contacts", [])):
        law = contact.get("law", "rigid")
        rods = any(body["kind"] == "rod" for body in case["bodies"][i : i + 2])
        numbers = [] if law == "rigid" and rods else NUMBERS.get(law)  # waves decide e of rods
        if numbers is None:
            names = {"joint": JOINTS, "own": OWN_LAWS}
            return f"contacts.{i}", names.get(law, f'the contact law "{law}"')
        if law not in ("rigid", "bonded") and not smooth:
            return f"contacts.{i}", COMPLIANCE
        if law == "bonded" and not rods:
            return f"contacts.{i}", "rigid bodies that are bonded"
        key = other_key(contact, ("gap", "law", *numbers))
        if key != "":
            return f"contacts.{i}.{key}", f"the entry {key}"
    used = [piece.get("material", "") for body in case["bodies"] for piece in pieces_of(body)]
    for name, material in case.get("materials", {}).items():
        for key in ("viscosity", "loss_factor"):
            if material.get(key, 0) != 0 and any(name == one for one in used):
                return f"materials.{name}", DAMPING
        key = other_key(material, ("youngs_modulus", "density", "poisson_ratio", "viscosity"))
        if key != "":
            return f"materials.{name}.{key}", f"the entry {key}"
    ends = case.get("ends", {})
    for side in ("left", "right"):
        value = ends.get(side, {}).get("value", 0)
        if sampled(value):
            return f"ends.{side}", SMOOTH_DRIVES
        if smooth and isinstance(value, dict):
            return f"ends.{side}", PROFILES
    return "", ""


def other_key(table: Any, known: tuple[str, ...]) -> str:
    """An entry that the page would not know what to do with; "" if there is none."""
    for key, value in table.items():
        if value is not None and all(key != name for name in known):
            return f"{key}"
    return ""


def sampled(profile: Any) -> bool:
    """Whether a profile varies between its values."""
    return isinstance(profile, dict) and "samples" in profile


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


class Stuff(NamedTuple):
    """A material."""

    name: str
    density: float
    youngs_modulus: float


class Piece(NamedTuple):
    """A segment, with what follows from its numbers."""

    length: float
    area: float
    material: Stuff
    wave_speed: float
    impedance: float
    transit_time: float
    mass: float


class Body(NamedTuple):
    """A body; one that is no rod has no segments, and a wall no mass."""

    kind: str
    segments: Any
    mass: float
    velocity: Any
    strain: Any


class Contact(NamedTuple):
    """A contact law."""

    law: str
    opens: bool
    restitution: Any
    stiffness: float
    exponent: float
    damping: float


class End(NamedTuple):
    """An end of the row."""

    kind: str
    value: Any


class Row(NamedTuple):
    """A system, by the names of `model.System`."""

    bodies: Any
    gaps: Any
    contacts: Any
    gravity: float
    ends: Any


class Asked(NamedTuple):
    """What a case asks of a run: its end, s, negative where there is none; the cap on events."""

    until: float
    max_events: int


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
