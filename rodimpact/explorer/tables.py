"""From the tables of a case to a system, in Python that the page has as JavaScript.

Mistakes are told in the words of the model: `RULES` are its fields. What the page cannot solve is
named.
"""

import math
import sys
from collections import namedtuple
from typing import Any

from ..methods import abilities
from ..model import GAP, Bonded, Material, Rigid, RigidMass, Rod, Segment, Wall
from ..model.frozen import LARGEST, OUT_OF_SCALE, SMALLEST, TINY, Field
from ..model.laws import Hertz, HuntCrossley, PowerLaw, Spring, SpringDashpot
from ..model.profiles import Steps

LAWS = (Rigid, Bonded, Spring, SpringDashpot, Hertz, HuntCrossley, PowerLaw)
MAX = sys.float_info.max
RANGES = {
    "positive": (TINY, MAX),
    "non-negative": (0.0, MAX),
    "any": (-MAX, MAX),
    "[0, 1]": (0.0, 1.0),
    "[1, inf)": (1.0, MAX),
}
"""The smallest and the largest number of each sign."""
RULES: dict[str, dict[str, tuple[float, float, str]]] = {
    table: {
        name: (*RANGES[fields[name].sign], fields[name].wanted[:-11]) for name in names
    }
    for table, fields, names in (
        ("segment", Segment.fields, ("length", "area")),
        ("rod", Rod.fields, tuple(Rod.fields)),
        ("wall", Wall.fields, ("velocity",)),
        ("mass", RigidMass.fields, ("mass", "velocity")),
        *((law.law, law.fields, tuple(law.fields)) for law in LAWS),
        ("contact", {"gap": GAP}, ("gap",)),
        ("material", Material.fields, ("youngs_modulus", "density")),
        ("gauge", {"fraction": Field("", "[0, 1]")}, ("fraction",)),
    )
}
"""By table and field the smallest and the largest number, and what it must be."""
NUMBERS = {law.law: list(law.fields) for law in LAWS}
NAMES = {
    "lateral_inertia": abilities.LATERAL,
    "polar_moment": abilities.LATERAL,
    "viscosity": abilities.DAMPING,
    "loss_factor": abilities.DAMPING,
}
"""What entries stand for that the page cannot solve."""
PROFILES = "profiles in one row with compliant contacts or rigid masses"
SCALE = OUT_OF_SCALE[:-11]
MOST_EVENTS = (
    20_000  # fronts that arrive at an end: an answer comes while a slider is dragged
)


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
    asked, bodies = case.get("solve", {}).get("method", "auto"), case["bodies"]
    if asked not in ("auto", "fronts", "characteristics"):
        return "solve.method", f'the method "{asked}"'
    if case.get("gravity", 0) != 0:
        return "gravity", abilities.GRAVITY
    smooth = is_smooth(case)
    entries: list[Any] = []  # with their paths, and what may be in them
    for i, body in enumerate(bodies):
        if body["kind"] == "mass" and not smooth:
            return f"bodies.{i}", abilities.MASSES
        entries.append(
            (
                f"bodies.{i}",
                body,
                (
                    "kind",
                    "segments",
                    "velocity",
                    "strain",
                    "length",
                    "area",
                    "material",
                    "mass",
                ),
            )
        )
        entries.extend(
            [
                (f"bodies.{i}", piece, ("length", "area", "material"))
                for piece in body.get("segments", [])
            ]
        )
    for i, contact in enumerate(case.get("contacts", [])):
        path, law = f"contacts.{i}", contact.get("law", "rigid")
        rods = any(body["kind"] == "rod" for body in bodies[i : i + 2])
        if law not in NUMBERS:
            return path, f'the contact law "{law}"'
        if law not in ("rigid", "bonded") and not smooth:
            return path, abilities.COMPLIANCE
        if law == "bonded" and not rods:
            return path, "rigid bodies that are bonded"
        numbers = (
            [] if law == "rigid" and rods else NUMBERS[law]
        )  # waves decide e of rods
        entries.append((path, contact, ("gap", "law", *numbers)))
    used = [piece.get("material", "") for body in bodies for piece in pieces_of(body)]
    entries.extend(
        [
            (
                f"materials.{name}",
                material,
                ("youngs_modulus", "density", "poisson_ratio"),
            )
            for name, material in case.get("materials", {}).items()
            if name in used
        ]
    )
    entries.extend(
        [
            (f"ends.{side}", end, ("kind", "value"))
            for side, end in case.get("ends", {}).items()
        ]
    )
    for path, table, known in entries:
        for key, value in table.items():
            what = "" if key in known else NAMES.get(key, f"the entry {key}")
            if isinstance(value, dict) and "samples" in value:
                what = abilities.TAPER if key == "area" else abilities.SMOOTH_STATES
            elif isinstance(value, dict) and smooth:
                what = PROFILES
            if what != "" and value is not None and value != 0:
                return f"{path}.{key}", what
    return "", ""


def pieces_of(body: Any) -> Any:
    """Tables with the segments of a body; none of a wall."""
    return body.get("segments", [body] if body["kind"] == "rod" else [])


def mistakes(case: Any, gauges: Any, library: Any, rules: Any) -> list[Any]:
    """Path and sentence of each mistake in a case that fronts can carry, and in its gauges."""
    found, bodies, materials = [], case["bodies"], case.get("materials", {})
    kinds, pairs = [body["kind"] for body in bodies], len(bodies) - 1
    rods = [i for i, kind in enumerate(kinds) if kind == "rod"]
    tables = [
        (f"materials.{name}", table, "material") for name, table in materials.items()
    ]
    if len(rods) == 0:
        found.append(("bodies", "needs at least one rod"))
    if len(contacts_in(case)) != pairs:
        found.append(
            ("contacts", f"needs one entry for each neighbouring pair, {pairs} in all")
        )
    for i, gauge in enumerate(gauges):
        tables.append((f"gauges.{i}", gauge, "gauge"))
        if gauge["body"] not in rods:
            found.append((f"gauges.{i}.body", "must be the number of a rod"))
    until = case.get("solve", {}).get("until", 1.0)
    if not isinstance(until, float) or not math.isfinite(until) or until <= 0:
        found.append(("solve.until", "must be above 0 for a picture"))
    for i, body in enumerate(bodies):
        tables.append((f"bodies.{i}", body, body["kind"]))
        if body["kind"] == "wall" and 0 < i < pairs:
            found.append((f"bodies.{i}", "a wall may stand only at an end of the row"))
        for j, piece in enumerate(pieces_of(body)):
            where = f"bodies.{i}.segments.{j}" if "segments" in body else f"bodies.{i}"
            tables.append((where, piece, "segment"))
            if piece.get("material", "") not in {**library, **materials}:
                found.append((f"{where}.material", "unknown material"))
    for i, contact in enumerate(case.get("contacts", [])):
        law, pair = contact.get("law", "rigid"), kinds[i : i + 2]
        tables.extend(
            [(f"contacts.{i}", contact, "contact"), (f"contacts.{i}", contact, law)]
        )
        waves = "rod" in pair or "mass" not in pair
        if law == "rigid" and not waves and contact.get("restitution") is None:
            message = (
                "no wave decides this contact: give its restitution, or a compliant law"
            )
            found.append((f"contacts.{i}", message))
        if law == "bonded" and contact.get("gap", 0) != 0:
            found.append((f"contacts.{i}.gap", "must be 0 where bodies are bonded"))
    for path, table, kind in tables:
        for key, (low, high, sentence) in rules[kind].items():
            wrong = wrong_number(table.get(key, 0.0), low, high, sentence)
            if wrong != "":
                found.append((f"{path}.{key}", wrong))
    return found


def wrong_number(value: Any, low: float, high: float, sentence: str) -> str:
    """What is wrong with a number; "" if nothing is, or if it is a profile."""
    if not isinstance(value, float):
        return "" if isinstance(value, dict) else f"{sentence}, got no number"
    if not low <= value <= high:
        return f"{sentence}, got {value:.6g}"
    sound = value == 0 or SMALLEST <= abs(value) <= LARGEST
    return "" if sound else f"{SCALE}, got {value:.6g}"


# A case as a system -------------------------------------------------------------------------------


# What stands in a row, by the names of the model.
Stuff = namedtuple("Stuff", "name density youngs_modulus")
Piece = namedtuple(
    "Piece", "length area material wave_speed impedance transit_time mass"
)
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
        [law_of(contact) for contact in contacts],
        0.0,
        [
            End(end["kind"], profile_of(end.get("value", 0.0)))
            for end in (
                ends.get("left", {"kind": "free"}),
                ends.get("right", {"kind": "free"}),
            )
        ],
    )


def asked_of(case: Any) -> Asked:
    """What a case asks of a run."""
    solve = case.get("solve", {})
    return Asked(
        solve.get("until", -1.0), min(solve.get("max_events", MOST_EVENTS), MOST_EVENTS)
    )


def body_of(table: Any, materials: Any) -> Body:
    """A body from its table."""
    segments, mass = [], table.get("mass", 0.0)
    for piece in pieces_of(table):
        material, length = materials[piece["material"]], piece["length"]
        stuff = Stuff(
            piece["material"], material["density"], material["youngs_modulus"]
        )
        speed = math.sqrt(stuff.youngs_modulus / stuff.density)
        Z, T = stuff.density * piece["area"] * speed, length / speed
        segments.append(Piece(length, piece["area"], stuff, speed, Z, T, Z * T))
        mass += Z * T
    return Body(
        table["kind"],
        segments,
        mass,
        profile_of(table.get("velocity", 0.0)),
        profile_of(table.get("strain", 0.0)),
    )


def law_of(contact: Any) -> Contact:
    """A contact law from its table."""
    law = contact.get("law", "rigid")
    exponent = (
        1.0 if law in ("spring", "spring-dashpot") else contact.get("exponent", 1.5)
    )
    return Contact(
        law,
        law != "bonded",
        contact.get("restitution"),
        contact.get("stiffness", 0.0),
        exponent,
        contact.get("damping", 0.0),
    )


def profile_of(value: Any) -> Any:
    """A number, or steps from their table."""
    return Steps(value["values"], value["at"]) if isinstance(value, dict) else value
