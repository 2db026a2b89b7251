"""Tables of a case, and the system that the page makes of them.

`lacking` names the first physics that the page cannot solve, `mistakes` lists the
mistakes of a case in the words of the model (`RULES` are the rules of its fields), and
`system_of` makes the system. The page has these functions as JavaScript.
"""

import math
import sys
from typing import Any, NamedTuple

from ..methods import abilities
from ..model import GAP, Bonded, Material, Rigid, RigidMass, Rod, Segment, Wall
from ..model.frozen import LARGEST, OUT_OF_SCALE, SMALLEST, TINY, QuantityField
from ..model.laws import Hertz, HuntCrossley, PowerLaw, Spring, SpringDashpot
from ..model.profiles import Steps
from ..model.quantities import of_unit

LAWS = (Rigid, Bonded, Spring, SpringDashpot, Hertz, HuntCrossley, PowerLaw)
"""Contact laws that the page can solve."""
MAX_FLOAT = sys.float_info.max
RANGES = {
    "positive": (TINY, MAX_FLOAT),
    "non-negative": (0.0, MAX_FLOAT),
    "any": (-MAX_FLOAT, MAX_FLOAT),
    "[0, 1]": (0.0, 1.0),
    "[1, inf)": (1.0, MAX_FLOAT),
}
"""Smallest and largest number of each sign."""
VALUE = ", got {0!r}"
"""End of a message of the model with the value, which the page writes itself."""
OUT_OF_SCALE_PAGE = OUT_OF_SCALE.removesuffix(VALUE)
"""Message for a number whose size is out of scale, without the value."""
NUMBERS = {law.law: list(law.fields) for law in LAWS}
"""Numbers of each contact law, by its word."""
LACKING_ENTRIES = {
    "lateral_inertia": abilities.LATERAL,
    "polar_moment": abilities.LATERAL,
    "viscosity": abilities.DAMPING,
    "loss_factor": abilities.DAMPING,
}
"""Physics that the page cannot solve, by the entries that ask for it."""
PROFILES = "profiles in one row with compliant contacts or rigid masses"
BODY_ENTRIES = [
    "kind",
    "segments",
    "velocity",
    "strain",
    "length",
    "area",
    "material",
    "mass",
]
"""Entries of a body that the page can solve."""
SEGMENT_ENTRIES = ["length", "area", "material"]
MATERIAL_ENTRIES = ["youngs_modulus", "density", "poisson_ratio"]
END_ENTRIES = ["kind", "value"]
MAX_PAGE_EVENTS = 20_000
"""Cap on events of a run: few enough for an answer while a slider is dragged."""


class Rule(NamedTuple):
    """Rule of a number in a table."""

    smallest: float  # allowed, in SI units
    largest: float  # allowed, in SI units
    wanted: str  # sentence: what the number must be
    unit: str  # end of that sentence: the SI unit in words; "" for a pure number


class Mistake(NamedTuple):
    """A mistake in a table. The page shows a number in the unit of its field."""

    path: str
    message: str  # sentence, without the unit and the value of a wrong number
    unit: str  # its end: the SI unit in words; "" without any
    value: Any  # the wrong number in this unit; None if the message is complete


def _rules_of(fields: dict[str, QuantityField], names: list[str]) -> dict[str, Rule]:
    """Rules of the fields of the model that have these names, by name.

    The sentence of a rule has no unit; if the model's sentence names the unit, the rule
    has it in words.
    """
    rules = {}
    for name in names:
        field = fields[name]
        smallest, largest = RANGES[field.sign]
        wanted = field._replace(unit="").wanted.removesuffix(VALUE)
        unit = ""
        sentence_has_unit = field.wanted.removesuffix(VALUE) != wanted
        if sentence_has_unit:
            unit = of_unit(field.unit)
        rules[name] = Rule(smallest, largest, wanted, unit)
    return rules


RULES: dict[str, dict[str, Rule]] = {
    "segment": _rules_of(Segment.fields, ["length", "area"]),
    "rod": _rules_of(Rod.fields, list(Rod.fields)),
    "wall": _rules_of(Wall.fields, ["velocity"]),
    "mass": _rules_of(RigidMass.fields, ["mass", "velocity"]),
    "contact": _rules_of({"gap": GAP}, ["gap"]),
    "material": _rules_of(Material.fields, ["youngs_modulus", "density"]),
    "gauge": _rules_of({"fraction": QuantityField("", "[0, 1]")}, ["fraction"]),
}
for _law in LAWS:
    RULES[_law.law] = _rules_of(_law.fields, list(_law.fields))
"""Rules of the numbers in each kind of table."""


def is_smooth(case: Any) -> bool:
    """Whether characteristics solve a case, and not fronts.

    The method that the case names decides. With "auto" it is characteristics if there
    is a mass or a compliant contact, which fronts do not have.
    """
    method = case.get("solve", {}).get("method", "auto")
    if method != "auto":
        return bool(method == "characteristics")
    for contact in case.get("contacts", []):
        law = contact.get("law", "rigid")
        if law not in ("rigid", "bonded"):
            return True
    return any(body["kind"] == "mass" for body in case["bodies"])


def contacts_in(case: Any) -> Any:
    """Tables of all contacts; an empty one for each pair if the case has none."""
    return case.get("contacts", [{}] * (len(case["bodies"]) - 1))


def rods_in(case: Any) -> list[int]:
    """Indices of the bodies that are rods."""
    return [i for i, body in enumerate(case["bodies"]) if body["kind"] == "rod"]


def segments_of(body: Any) -> Any:
    """Tables with the segments of a body: its own table for a uniform rod.

    A wall or a mass has none: [].
    """
    if "segments" in body:
        return body["segments"]
    if body["kind"] == "rod":
        return [body]
    return []


# Physics that the page cannot solve ---------------------------------------------------


class Entries(NamedTuple):
    """A table with the entries that the page can solve in it."""

    path: str
    table: Any
    allowed: list[str]  # names of the entries


def lacking(case: Any) -> tuple[str, str]:
    """Path and name of the first physics that the page cannot solve.

    Options come first, then bodies, contacts, and entries of tables. Both are "" if the
    page can solve the case.
    """
    path, name = lacking_in_options(case)
    if name == "":
        path, name = lacking_in_bodies(case)
    if name == "":
        path, name = lacking_in_contacts(case)
    if name == "":
        path, name = lacking_in_entries(case)
    return path, name


def lacking_in_options(case: Any) -> tuple[str, str]:
    """Path and name of a method that the page does not have, or else of gravity.

    Both are "" if the case asks for neither.
    """
    method = case.get("solve", {}).get("method", "auto")
    if method not in ("auto", "fronts", "characteristics"):
        return "solve.method", f'the method "{method}"'
    if case.get("gravity", 0) != 0:
        return "gravity", abilities.GRAVITY
    return "", ""


def lacking_in_bodies(case: Any) -> tuple[str, str]:
    """Path of the first rigid mass, and name of this physics, if fronts solve the case.

    Both are "" if there is no mass, or if characteristics solve the case.
    """
    smooth = is_smooth(case)
    for i, body in enumerate(case["bodies"]):
        if body["kind"] == "mass" and not smooth:
            return f"bodies.{i}", abilities.MASSES
    return "", ""


def lacking_in_contacts(case: Any) -> tuple[str, str]:
    """Path of the first contact whose law the page cannot solve, and name of the law.

    These are unknown laws, compliant laws if fronts are to solve the case, and bonds of
    two rigid bodies. Both are "" if there are none.
    """
    smooth = is_smooth(case)
    for i, contact in enumerate(case.get("contacts", [])):
        path = f"contacts.{i}"
        law = contact.get("law", "rigid")
        if law not in NUMBERS:
            return path, f'the contact law "{law}"'
        if law not in ("rigid", "bonded") and not smooth:
            return path, abilities.COMPLIANCE
        if law == "bonded" and not has_rod(case, i):
            return path, "rigid bodies that are bonded"
    return "", ""


def has_rod(case: Any, i: int) -> bool:
    """Whether contact i has a rod on one side."""
    return any(body["kind"] == "rod" for body in case["bodies"][i : i + 2])


def lacking_in_entries(case: Any) -> tuple[str, str]:
    """Path of the first entry of a table that the page cannot solve, and its physics.

    An entry is a number or a profile, see `lacking_entry`. Both are "" if there is
    none.
    """
    smooth = is_smooth(case)
    for entries in entries_of(case):
        for key, value in entries.table.items():
            name = lacking_entry(key, value, entries.allowed, smooth)
            if name != "":
                return f"{entries.path}.{key}", name
    return "", ""


def lacking_entry(key: str, value: Any, allowed: list[str], smooth: bool) -> str:
    """Name of the physics that an entry needs and the page lacks; "" if none.

    `allowed` are the keys that the page can solve, `smooth` says that characteristics
    solve the case. An entry that is None or 0 needs no physics. Sampled profiles are
    always refused, steps if `smooth`, and other entries unless `allowed`. The physics
    without a name in `LACKING_ENTRIES` is called "the entry KEY".
    """
    if value is None or value == 0:
        return ""
    if isinstance(value, dict) and "samples" in value:
        if key == "area":
            return abilities.TAPER
        return abilities.SMOOTH_STATES
    if isinstance(value, dict) and smooth:
        return PROFILES
    if key in allowed:
        return ""
    return LACKING_ENTRIES.get(key, f"the entry {key}")


def entries_of(case: Any) -> list[Entries]:
    """All tables of a case, each with the names of the entries that the page can solve.

    Materials that no rod uses are left out. A rigid contact with a rod has no
    restitution among its entries.
    """
    tables = []
    used_materials = []
    for i, body in enumerate(case["bodies"]):
        path = f"bodies.{i}"
        tables.append(Entries(path, body, BODY_ENTRIES))
        for segment in body.get("segments", []):
            tables.append(Entries(path, segment, SEGMENT_ENTRIES))
        for segment in segments_of(body):
            used_materials.append(segment.get("material", ""))
    for i, contact in enumerate(case.get("contacts", [])):
        law = contact.get("law", "rigid")
        numbers = NUMBERS[law]
        if law == "rigid" and has_rod(case, i):
            numbers = []  # the waves of the rod decide, not a restitution
        tables.append(Entries(f"contacts.{i}", contact, ["gap", "law", *numbers]))
    for name, material in case.get("materials", {}).items():
        if name in used_materials:
            tables.append(Entries(f"materials.{name}", material, MATERIAL_ENTRIES))
    for side, end in case.get("ends", {}).items():
        tables.append(Entries(f"ends.{side}", end, END_ENTRIES))
    return tables


# Mistakes -----------------------------------------------------------------------------


class RuledTable(NamedTuple):
    """A table whose numbers have rules."""

    path: str
    table: Any
    kind: str  # key of `RULES`


def mistakes(case: Any, gauges: Any, library: Any) -> list[Mistake]:
    """Mistakes in a case whose physics the page can solve; [] if there are none.

    Mistakes of structure come first, then wrong numbers. A number that a table lacks
    counts as 0.

    Parameters
    ----------
    case : dict
        Tables of a case file.
    gauges : list of dict
        Tables of its gauges.
    library : dict
        Materials that the case may name, by their names.
    """
    problems = [  # (path, message) each
        *mistakes_of_row(case),
        *mistakes_of_gauges(case, gauges),
        *mistakes_of_bodies(case, library),
        *mistakes_of_contacts(case),
    ]
    all_mistakes = []
    no_unit = ""
    no_value = None
    for path, message in problems:
        all_mistakes.append(Mistake(path, message, no_unit, no_value))
    for ruled in ruled_tables(case, gauges):
        for key, rule in RULES[ruled.kind].items():
            path = f"{ruled.path}.{key}"
            value = ruled.table.get(key, 0.0)
            all_mistakes.extend(mistakes_of_number(path, value, rule))
    return all_mistakes


def mistakes_of_row(case: Any) -> list[Any]:
    """Mistakes (path, message): a row without rods, a wrong number of contacts.

    There must be one contact for each neighbouring pair of bodies.
    """
    problems = []
    n_pairs = len(case["bodies"]) - 1
    if len(rods_in(case)) == 0:
        problems.append(("bodies", "needs at least one rod"))
    if len(contacts_in(case)) != n_pairs:
        wanted = f"needs one entry for each neighbouring pair, {n_pairs} in all"
        problems.append(("contacts", wanted))
    return problems


def mistakes_of_gauges(case: Any, gauges: Any) -> list[Any]:
    """Mistakes (path, message): gauges not on a rod, an end of the run not above 0.

    The end must also be a finite number; a case without one has no mistake.
    """
    problems = []
    rods = rods_in(case)
    for i, gauge in enumerate(gauges):
        if gauge["body"] not in rods:
            problems.append((f"gauges.{i}.body", "must be the number of a rod"))
    until = case.get("solve", {}).get("until", 1.0)  # a right one if there is none
    # In JavaScript every number counts as a float; a wrong entry may be a text.
    if not isinstance(until, float) or not math.isfinite(until) or until <= 0:
        problems.append(("solve.until", "must be above 0 for a picture"))
    return problems


def mistakes_of_bodies(case: Any, library: Any) -> list[Any]:
    """Mistakes (path, message): walls inside the row, and unknown materials.

    A material is known if the case declares it or it is in the library.
    """
    problems = []
    bodies = case["bodies"]
    declared = case.get("materials", {})
    for i, body in enumerate(bodies):
        if body["kind"] == "wall" and 0 < i < len(bodies) - 1:
            problems.append(
                (f"bodies.{i}", "a wall may stand only at an end of the row")
            )
        for j, segment in enumerate(segments_of(body)):
            name = segment.get("material", "")
            if name not in library and name not in declared:
                path = segment_path(body, i, j)
                problems.append((f"{path}.material", "unknown material"))
    return problems


def segment_path(body: Any, i: int, j: int) -> str:
    """Path of segment j of body i: that of the body if it has no list of segments."""
    if "segments" in body:
        return f"bodies.{i}.segments.{j}"
    return f"bodies.{i}"


def mistakes_of_contacts(case: Any) -> list[Any]:
    """Mistakes (path, message): rigid impacts without restitution, bonds with a gap.

    A rigid impact is that of a mass with a mass or a wall, in rigid contact.
    """
    problems = []
    kinds = [body["kind"] for body in case["bodies"]]
    for i, contact in enumerate(case.get("contacts", [])):
        law = contact.get("law", "rigid")
        pair = kinds[i : i + 2]
        is_rigid_impact = law == "rigid" and "rod" not in pair and "mass" in pair
        if is_rigid_impact and contact.get("restitution") is None:
            message = (
                "no wave decides this contact: give its restitution, or a compliant law"
            )
            problems.append((f"contacts.{i}", message))
        if law == "bonded" and contact.get("gap", 0) != 0:
            problems.append((f"contacts.{i}.gap", "must be 0 where bodies are bonded"))
    return problems


def ruled_tables(case: Any, gauges: Any) -> list[RuledTable]:
    """All tables whose numbers have rules, each with its path and its kind of rules.

    They are those of materials, gauges, bodies, segments and contacts. A uniform rod
    occurs twice, as a body and as its segment; each contact occurs twice, with the rule
    of its gap and with those of its law.
    """
    tables = []
    for name, material in case.get("materials", {}).items():
        tables.append(RuledTable(f"materials.{name}", material, "material"))
    for i, gauge in enumerate(gauges):
        tables.append(RuledTable(f"gauges.{i}", gauge, "gauge"))
    for i, body in enumerate(case["bodies"]):
        tables.append(RuledTable(f"bodies.{i}", body, body["kind"]))
        for j, segment in enumerate(segments_of(body)):
            path = segment_path(body, i, j)
            tables.append(RuledTable(path, segment, "segment"))
    for i, contact in enumerate(case.get("contacts", [])):
        path = f"contacts.{i}"
        tables.append(RuledTable(path, contact, "contact"))
        tables.append(RuledTable(path, contact, contact.get("law", "rigid")))
    return tables


def mistakes_of_number(path: str, value: Any, rule: Any) -> list[Mistake]:
    """List with the mistake of a wrong number; [] if it is right, or a profile.

    A number is wrong if it is not finite, outside the range of its rule, or neither 0
    nor of a size from `SMALLEST` to `LARGEST`. A value that is no number is wrong too.
    """
    if isinstance(value, dict):
        return []
    smallest, largest, wanted, unit = rule
    no_unit = ""
    no_value = None  # these messages are complete
    if not isinstance(value, float):
        return [Mistake(path, f"{wanted}{unit}, got no number", no_unit, no_value)]
    if not math.isfinite(value):
        return [Mistake(path, f"{wanted}{unit}, got {value:.6g}", no_unit, no_value)]
    if not smallest <= value <= largest:
        return [Mistake(path, wanted, unit, value)]
    is_in_scale = value == 0 or SMALLEST <= abs(value) <= LARGEST
    if is_in_scale:
        return []
    return [Mistake(path, OUT_OF_SCALE_PAGE, no_unit, value)]


# A case as a system -------------------------------------------------------------------

# The records of a row have the names of the model's classes, with the fields that the
# kernels and the pictures read.


class PageMaterial(NamedTuple):
    """Material of the library or of a case."""

    name: str
    density: float  # kg/m^3
    youngs_modulus: float  # Pa


class PageSegment(NamedTuple):
    """Uniform segment of a rod."""

    length: float  # m
    area: float  # m^2
    material: PageMaterial
    wave_speed: float  # m/s
    impedance: float  # kg/s
    transit_time: float  # s
    mass: float  # kg


class PageBody(NamedTuple):
    """Rod, rigid mass or wall."""

    kind: str
    segments: list[PageSegment]  # empty for a mass and a wall
    mass: float  # kg; 0 for a wall
    velocity: Any  # m/s, a number or steps
    strain: Any  # a number or steps


class PageContact(NamedTuple):
    """Contact law with the numbers of all laws; 0 for numbers that it does not have."""

    law: str
    opens: bool  # whether the contact is unilateral
    restitution: Any  # None between rods
    stiffness: float  # N/m^p
    exponent: float  # p
    damping: float  # N s/m, or s/m for Hunt and Crossley


class PageEnd(NamedTuple):
    """Boundary condition at an end of the row."""

    kind: str
    value: Any  # a number or steps of a driven end; else 0


class PageSystem(NamedTuple):
    """Row of bodies from left to right."""

    bodies: list[PageBody]
    gaps: list[float]  # m
    contacts: list[PageContact]
    gravity: float  # m/s^2
    ends: list[PageEnd]  # left, right
    has_shaft: bool  # `System` has this field, too


class RunRequest(NamedTuple):
    """Options of a run."""

    until: float  # end of the run, s; negative if there is none
    max_events: int  # cap on the events


def system_of(case: Any, library: Any) -> PageSystem:
    """System of a case without mistakes that the page can solve.

    Ends that the case does not name are free. A material of the case replaces one of
    the library with the same name.
    """
    materials = {**library, **case.get("materials", {})}
    bodies = [body_of(body, materials) for body in case["bodies"]]
    gaps = []
    laws = []
    for contact in contacts_in(case):
        gaps.append(contact.get("gap", 0.0))
        laws.append(law_of(contact))
    ends = case.get("ends", {})
    left = end_of(ends.get("left", {"kind": "free"}))
    right = end_of(ends.get("right", {"kind": "free"}))
    gravity = 0.0  # the page solves no row in gravity or in soil
    has_shaft = False
    return PageSystem(bodies, gaps, laws, gravity, [left, right], has_shaft)


def request_of(case: Any) -> RunRequest:
    """Options of the run of a case; the cap on events is at most `MAX_PAGE_EVENTS`.

    The end is negative if the case gives none.
    """
    solve = case.get("solve", {})
    until = solve.get("until", -1.0)  # negative if there is none
    max_events = solve.get("max_events", MAX_PAGE_EVENTS)
    return RunRequest(until, min(max_events, MAX_PAGE_EVENTS))


def body_of(table: Any, materials: Any) -> PageBody:
    """Body from its table; the mass of a rod is the sum of those of its segments.

    `materials` are tables by name.
    """
    segments = []
    mass = table.get("mass", 0.0)  # only a rigid mass has this entry
    for segment_table in segments_of(table):
        segment = segment_of(segment_table, materials)
        segments.append(segment)
        mass += segment.mass
    velocity = profile_of(table.get("velocity", 0.0))
    strain = profile_of(table.get("strain", 0.0))
    return PageBody(table["kind"], segments, mass, velocity, strain)


def segment_of(table: Any, materials: Any) -> PageSegment:
    """Segment from its table, and its wave speed, impedance, transit time and mass.

    They are c = sqrt(E/rho), Z = rho A c, T = l/c and m = Z T. `materials` has tables
    by name.
    """
    name = table["material"]
    density = materials[name]["density"]
    youngs_modulus = materials[name]["youngs_modulus"]
    material = PageMaterial(name, density, youngs_modulus)
    length = table["length"]
    area = table["area"]
    c = math.sqrt(youngs_modulus / density)
    Z = density * area * c
    T = length / c
    return PageSegment(length, area, material, c, Z, T, Z * T)


def law_of(contact: Any) -> PageContact:
    """Contact law from its table.

    The exponent of springs and dashpots is 1. Entries that the table lacks have default
    values: "rigid" for the law, 1.5 for any other exponent, None for the restitution,
    and 0 for the rest.
    """
    law = contact.get("law", "rigid")
    exponent = contact.get("exponent", 1.5)
    if law in ("spring", "spring-dashpot"):
        exponent = 1.0
    opens = law != "bonded"
    return PageContact(
        law,
        opens,
        contact.get("restitution"),
        contact.get("stiffness", 0.0),
        exponent,
        contact.get("damping", 0.0),
    )


def end_of(table: Any) -> PageEnd:
    """End of the row from its table; its value is 0 by default."""
    return PageEnd(table["kind"], profile_of(table.get("value", 0.0)))


def profile_of(value: Any) -> Any:
    """A number as it is, or steps from their table."""
    if isinstance(value, dict):
        return Steps(value["values"], value["at"])
    return value
