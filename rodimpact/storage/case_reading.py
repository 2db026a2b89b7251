"""The tables of a case file become a `Case`: bodies, contacts, ends, and what to do with them."""

import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from .. import materials
from ..methods.registry import Options
from ..model import GAP, SIDES, System
from ..model.bodies import BODIES, Body, Material, RigidMass, Rod, Segment, Wall
from ..model.ends import ENDS, FREE, End
from ..model.frozen import Field, InvalidModel, defaults_of, refusal
from ..model.lateral_inertia import THEORIES
from ..model.laws import CONTACT_LAWS, FACE, ContactLaw, Hertz, Spring
from ..model.paths import FIELDS, SPEED, suggestion
from ..units import shown
from .case import SCHEMA, Case, GaugePlace
from .case_tables import Table
from .grids import Grids

DAMPING = {
    "loss_factor": Field("", "non-negative"),
    "loss_frequency": Field("Hz", "positive"),
}
SEGMENT = (*Segment.fields, "material", "lateral_inertia")
OF_SYSTEM = {r"^gaps\.(\d+)": r"contacts.\1.gap", "^gaps$": "contacts"}
"""Keys of the file, where the model calls numbers otherwise."""
ANY_ROD = Rod(1.0, area=1.0, material=materials.steel)
STAND_INS: dict[str, Body] = {"rod": ANY_ROD, "mass": RigidMass(1.0), "wall": Wall()}
"""Bodies in place of those whose mistakes allow none."""
Materials = dict[str, Material]


def case_from(
    data: dict[str, Any], source: str = "case", vary: Mapping[str, str] | None = None
) -> Case:
    """Make a case of the tables that a case file holds.

    Parameters
    ----------
    data : dict
        As ``tomllib.loads`` makes it of a case file, or a program of its own.
    source, vary
        As for `parse_case`.

    Returns
    -------
    Case

    Raises
    ------
    InvalidModel
        With all mistakes, each with the path of its entry.
    """
    if not isinstance(data, dict):
        raise refusal(source, f"must be the tables of a case file, got {shown(data)}")
    top = Table("", data, Grids(vary), {})
    _check_schema(top)
    known = _read_materials(top)
    gravity = top.entry("gravity", System.fields["gravity"])
    bodies = [_read_body(table, known) for table in top.tables("bodies")]
    if not bodies:
        top.note("bodies", "is missing; describe each body in a [[bodies]] table")
    gaps, laws = [], []
    contacts = top.tables("contacts")
    if "contacts" not in top.data:
        contacts = [top.inner(f"contacts.{i}", {}) for i in range(len(bodies) - 1)]
    for i, table in enumerate(contacts):
        gaps.append(table.entry("gap", GAP))
        laws.append(_read_law(table, (*bodies[i : i + 2], None, None)[:2], known))
    sides = top.table(
        "ends"
    )  # of the row; where mistakes allow nothing, nothing happens there
    ends = [_read_end(sides.table(side)) if sides.has(side) else FREE for side in SIDES]
    sides.close()
    system: Any = bodies and top.make(
        System,
        OF_SYSTEM,
        bodies=[body or ANY_ROD for body in bodies],
        gaps=gaps,
        contacts=laws,
        gravity=gravity,
        ends=ends,
    )
    options, output = _read_solve(top.table("solve")), _read_output(top.table("output"))
    gauges = tuple(_read_gauge(table, bodies) for table in top.tables("gauges"))
    top.close()
    _check_varied(top, system)
    if top.mistakes:
        raise InvalidModel(list(top.mistakes.items()))
    varied = tuple(top.grids.taken[path] for path in top.grids.texts)
    return Case(system, options, output, source, varied, gauges)


def _check_schema(top: Table) -> None:
    schema = top.get("schema")
    if (
        type(schema) is int and schema > SCHEMA
    ):  # its other entries may mean other things
        message = f"is {shown(schema)}; this rodimpact reads {SCHEMA}, get a newer one"
        raise refusal("schema", message)
    if type(schema) is not int or schema != SCHEMA:
        top.note("schema", f"must be {SCHEMA}; begin the file with schema = {SCHEMA}")


def _read_materials(top: Table) -> Materials:
    """Materials by name; steel stands in for those with mistakes."""
    known, group = dict(materials.TABLE), top.table("materials")
    for name in group.data:
        table = group.table(name)
        material = (
            table.make(Material, name=name, **table.entries(Material))
            or materials.steel
        )
        if [key for key in DAMPING if table.gives(key)]:
            if table.gives("viscosity"):
                message = (
                    "give either viscosity or loss_factor and loss_frequency, not both"
                )
                table.note("viscosity", message)
            factor, frequency = (
                table.entry(key, field) for key, field in DAMPING.items()
            )
            material = table.make(
                material.damped,
                {"^frequency": "loss_frequency"},
                loss_factor=factor,
                frequency=frequency,
            )
        table.close()
        known[name] = material or materials.steel
    return known


def _read_body(table: Table, known: Materials) -> Body | None:
    """The body, None if of unknown kind; where mistakes allow none, any of its kind stands in."""
    kind = table.word("kind", BODIES)
    if kind is None:
        return None
    shape: dict[str, Any] = {}
    if kind == Rod.kind:
        shape = (
            _read_segments(table, known)
            if table.has("segments")
            else _shape(table, known)
        )
    body: Body | None = None
    entries = {**shape, **table.entries(BODIES[kind])}
    if None not in shape.get("segments", ()):
        body = table.make(BODIES[kind], **entries)
    table.close()
    return body or STAND_INS[kind]


def _read_segments(table: Table, known: Materials) -> dict[str, Any]:
    if [key for key in SEGMENT if table.has(key)]:
        message = (
            "give either segments or length, area, material and polar_moment, not both"
        )
        table.note("segments", message)
    pieces = []
    for piece in table.tables("segments"):
        pieces.append(piece.make(Segment, **_shape(piece, known)))
        piece.close()
    return {"segments": pieces}


def _shape(table: Table, known: Materials) -> dict[str, Any]:
    entries = {**table.entries(Segment), "material": _material(table, known)}
    if table.has("lateral_inertia"):
        entries["lateral_inertia"] = theory = table.word("lateral_inertia", THEORIES)
        if theory is None:  # alone a polar moment would be another mistake
            entries["polar_moment"] = None
    return entries


def _material(table: Table, known: Materials, key: str = "material") -> Material:
    """The material that the table names; steel stands in for an unknown one."""
    name = table.word(key, known)
    if name is None:
        return materials.steel
    material = _varied(
        Table(f"materials.{name}", {}, table.grids, table.mistakes), known[name]
    )
    return _varied(table.inner(key, {}), material) if key == "material" else material


def _varied(table: Table, material: Material) -> Material:
    """The material with the numbers of it that vary by their paths in this table."""
    changes = {
        key: table.entry(key, field)
        for key, field in Material.fields.items()
        if table.gives(key)
    }
    if changes:
        material = table.make(material.replace, **changes) or material
    if table.gives(SPEED):
        speed = np.asarray(table.entry(SPEED, FIELDS[SPEED]))
        modulus = material.density * speed * abs(speed)
        material = table.make(material.replace, youngs_modulus=modulus) or material
    return material


def _read_law(
    table: Table, pair: tuple[Body | None, ...], known: Materials
) -> ContactLaw:
    """The law; a spring, which goes between any bodies, where mistakes allow none."""
    name = table.word("law", CONTACT_LAWS, "rigid")
    if name is None:  # who knows which keys are right
        return Spring(1.0)
    kind: Any = CONTACT_LAWS[name]
    rounded = [
        side for side in SIDES if kind is Hertz and table.gives(f"{side}_radius")
    ]
    if kind is Hertz and table.gives("stiffness") == bool(rounded):
        table.note(
            "stiffness", "give either the stiffness, or left_radius and right_radius"
        )
    numbers = _read_faces(table, pair, known) if rounded else table.entries(kind)
    law: ContactLaw | None = table.make(
        Hertz.from_radii if rounded else kind, **numbers
    )
    table.close()
    if None in pair and numbers.get("restitution") is not None:  # is it right here?
        law = None
    return law or Spring(1.0)


def _read_faces(
    table: Table, pair: tuple[Body | None, ...], known: Materials
) -> dict[str, Any]:
    """Radii and materials of a Hertz contact, for `Hertz.from_radii`."""
    faces: dict[str, Any] = {}
    for side, body, end in zip(SIDES, pair, (-1, 0), strict=True):
        faces[f"{side}_radius"] = table.entry(f"{side}_radius", FACE)
        key = f"{side}_material"
        if table.has(key):
            faces[key] = _material(table, known, key)
        elif isinstance(body, Rod):
            faces[key] = body.segments[end].material
        else:
            faces[key] = None if body else materials.steel
    return faces


def _read_end(table: Table) -> End:
    end: End | None = None
    if kind := table.word("kind", ENDS):
        end = table.make(ENDS[kind], **table.entries(ENDS[kind]))
        table.close()
    return end or FREE


def _read_solve(table: Table) -> dict[str, Any]:
    options = {key: table.data[key] for key in defaults_of(Options) if table.has(key)}
    for key in [key for key in Options.fields if key in options]:
        options[key] = table.quantity(key, options[key], Options.fields[key].dimension)
    table.make(Options, **options)
    table.close()
    return options


def _read_output(table: Table) -> dict[str, str]:
    names = {key: table.data[key] for key in ("plot", "save") if table.has(key)}
    for key, name in names.items():
        if not isinstance(name, str) or not name or "\0" in name:
            table.note(key, f"must be the name of a file, got {shown(name)}")
    table.close()
    return names


def _read_gauge(table: Table, bodies: list[Body | None]) -> GaugePlace:
    rods = [i for i, body in enumerate(bodies) if isinstance(body, Rod)]
    body, given, name = table.get("body"), table.get("fraction"), table.get("name", "")
    if type(body) is not int or body not in rods:
        names = ", ".join(map(str, rods))
        table.note("body", f"must be the number of a rod, {names}; got {shown(body)}")
    fraction = (
        math.nan
        if given is None
        else table.quantity("fraction", given, "dimensionless")
    )
    if not 0 <= fraction <= 1:
        table.note("fraction", "give the place over the length of the rod, from 0 to 1")
    if not isinstance(name, str):
        table.note("name", f"must be text, got {shown(name)}")
    table.close()
    return GaugePlace(body, fraction, name)


def _check_varied(top: Table, system: System | None) -> None:
    """Note grids of unknown numbers, and grids that change nothing."""
    grids = top.grids
    # in a table that could not be read, nobody knows the numbers
    unread = tuple(re.sub(r"\.(kind|law)$", "", path) + "." for path in top.mistakes)
    for path in grids.texts:
        if path not in grids.known and not path.startswith(unread):
            top.note(
                path, f"is no number that can vary; {suggestion(path, grids.known)}"
            )
    if system is None or top.mistakes:  # where mistakes are, something else stands in
        return
    shape = system.shape or (0,) * len(grids.texts)
    for size, path in zip(shape, grids.texts, strict=True):
        if size != len(grids.taken[path].values):
            top.note(path, "changes nothing in this row")
