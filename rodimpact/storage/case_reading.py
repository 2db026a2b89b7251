"""The tables of a case file become a `Case`: bodies, contacts, ends, and what to do with them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from .. import materials
from ..methods.registry import METHOD_NAMES, Options
from ..model import SIDES, System
from ..model.bodies import BODIES, Body, Material, RigidMass, Rod, Segment, Wall
from ..model.ends import ENDS, FREE, End
from ..model.frozen import Field, InvalidModel, Number, defaults_of
from ..model.lateral_inertia import THEORIES
from ..model.laws import CONTACT_LAWS, FACE, ContactLaw, Hertz, Spring, Tabulated
from ..model.paths import FIELDS, SPEED, suggestion
from ..units import shown
from .case import SCHEMA, Case, GaugePlace
from .case_tables import Table
from .grids import Grids

OPTIONS = {"until": "time", "dt": "time", "rtol": "dimensionless"}  # with units
DAMPING = {"loss_factor": Field("", "non-negative"), "loss_frequency": Field("Hz", "positive")}
SEGMENT = (*Segment.fields, "material", "lateral_inertia")
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
        raise InvalidModel([(source, f"must be the tables of a case file, got {shown(data)}")])
    top = Table("", data, Grids(vary), {})
    _check_schema(top)
    known = _read_materials(top)
    gravity = top.entry("gravity", System.fields["gravity"])
    bodies = [_read_body(table, known) for table in top.tables("bodies")]
    if not bodies:
        top.note("bodies", "is missing; describe each body in a [[bodies]] table")
    gaps, laws = _read_contacts(top, bodies, known)
    ends = _read_ends(top.table("ends"))
    system: Any = bodies and top.make(
        System, bodies=[body or ANY_ROD for body in bodies], gaps=gaps, contacts=laws,
        gravity=gravity, ends=ends,
    )
    options, output = _read_solve(top.table("solve")), _read_output(top.table("output"))
    gauges = tuple(_read_gauge(table, bodies) for table in top.tables("gauges"))
    top.close()
    _check_varied(top, system)
    if top.mistakes:
        raise InvalidModel(list(top.mistakes.items()))
    taken = top.grids.taken
    varied = tuple(taken[path] for path in top.grids.texts)
    return Case(system, options, output, source, varied, gauges)


def _check_schema(top: Table) -> None:
    schema = top.data.get("schema")
    if not top.has("schema"):
        top.note("schema", f"is missing; begin the file with schema = {SCHEMA}")
    elif type(schema) is int and schema > SCHEMA:  # its other entries may mean other things
        message = f"is {shown(schema)}; this rodimpact reads {SCHEMA}, get a newer one"
        raise InvalidModel([("schema", message)])
    elif type(schema) is not int or schema != SCHEMA:
        top.note("schema", f"must be {SCHEMA}, got {shown(schema)}")


def _read_materials(top: Table) -> Materials:
    """Materials by name; steel stands in for those with mistakes."""
    known, group = dict(materials.TABLE), top.table("materials")
    for name in group.data:
        table = group.table(name)
        material = table.make(Material, name=name, **table.entries(Material)) or materials.steel
        if [key for key in DAMPING if table.gives(key)]:
            if table.gives("viscosity"):
                message = "give either viscosity or loss_factor and loss_frequency, not both"
                table.note("viscosity", message)
            factor, frequency = (table.entry(key, field) for key, field in DAMPING.items())
            material = table.make(material.damped, loss_factor=factor, frequency=frequency)
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
        shape = _read_segments(table, known) if table.has("segments") else _shape(table, known)
    body: Body | None = None
    entries = table.entries(BODIES[kind])
    if None not in shape.get("segments", ()):
        body = table.make(BODIES[kind], **shape, **entries)
    table.close()
    return body or STAND_INS[kind]


def _read_segments(table: Table, known: Materials) -> dict[str, Any]:
    if [key for key in SEGMENT if table.has(key)]:
        message = "give either segments or length, area, material and polar_moment, not both"
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
    if not table.has(key):
        table.note(key, "is missing; name one of rodimpact.materials or of this file")
        return materials.steel
    name = table.data[key]
    if isinstance(name, str) and name in known:
        material = _varied(table.at(f"materials.{name}"), known[name])
        return _varied(table.inner(key, {}), material) if key == "material" else material
    table.note(key, f"unknown material {shown(name)}", name, known)
    return materials.steel


def _varied(table: Table, material: Material) -> Material:
    """The material with the numbers of it that vary by their paths in this table."""
    changes = {key: table.entry(key, field) for key, field in Material.fields.items()
               if table.gives(key)}
    if changes:
        material = table.make(material.replace, **changes) or material
    if table.gives(SPEED):
        speed = np.asarray(table.entry(SPEED, FIELDS[SPEED]))
        modulus = material.density * speed * abs(speed)
        material = table.make(material.replace, youngs_modulus=modulus) or material
    return material


def _read_contacts(
    top: Table, bodies: list[Body | None], known: Materials
) -> tuple[list[Number], list[ContactLaw]]:
    """Gaps and laws of all pairs."""
    tables = top.tables("contacts")
    if "contacts" not in top.data:
        tables = [top.inner(f"contacts.{i}", {}) for i in range(len(bodies) - 1)]
    gaps, laws = [], []
    for i, table in enumerate(tables):
        gaps.append(table.entry("gap", System.fields["gaps"]))
        laws.append(_read_law(table, (*bodies[i : i + 2], None, None)[:2], known))
    return gaps, laws


def _read_law(table: Table, pair: tuple[Body | None, ...], known: Materials) -> ContactLaw:
    """The law; a spring, which goes between any bodies, where mistakes allow none."""
    name = table.word("law", CONTACT_LAWS, "rigid")
    law: ContactLaw | None = None
    if name is None:  # who knows which keys are right
        return Spring(1.0)
    if name == Hertz.law and (faces := _read_faces(table, pair, known)):
        law = table.make(Hertz.from_radii, **faces)
    else:
        numbers = table.entries(CONTACT_LAWS[name])
        if name == Tabulated.law:
            numbers |= {key: table.numbers(key, dimension) or ()
                        for key, dimension in (("compression", "length"), ("force", "force"))}
        law = table.make(CONTACT_LAWS[name], **numbers)
        if numbers.get("restitution") is not None and None in pair:  # is it right here?
            law = None
    table.close()
    return law or Spring(1.0)


def _read_faces(
    table: Table, pair: tuple[Body | None, ...], known: Materials
) -> dict[str, Any]:
    """Radii and materials of a Hertz contact, for `Hertz.from_radii`; empty if it has none."""
    rounded = [key for side in SIDES if table.gives(key := f"{side}_radius")]
    named = [key for side in SIDES if table.has(key := f"{side}_material")]
    if table.gives("stiffness") or not rounded:
        for key in rounded + named:
            table.note(key, "belongs to radii; give either stiffness or radii, not both")
        if not table.gives("stiffness"):
            table.note("stiffness", "is missing; give it, or left_radius and right_radius")
        return {}
    faces: dict[str, Any] = {}
    for side, body, end in zip(SIDES, pair, (-1, 0), strict=True):
        faces[f"{side}_radius"] = table.entry(f"{side}_radius", FACE)
        key = f"{side}_material"
        if key in named:
            faces[key] = _material(table, known, key)
        elif isinstance(body, Rod):
            faces[key] = body.segments[end].material
        else:
            faces[key] = None if body else materials.steel
    return faces


def _read_ends(table: Table) -> list[End]:
    """What happens at the two ends of the row; where mistakes allow nothing, nothing does."""
    ends: list[End] = []
    for side in SIDES:
        end: End | None = None
        if table.has(side):
            inner = table.table(side)
            if kind := inner.word("kind", ENDS):
                end = inner.make(ENDS[kind], **inner.entries(ENDS[kind]))
                inner.close()
        ends.append(end or FREE)
    table.close()
    return ends


def _read_solve(table: Table) -> dict[str, Any]:
    options: dict[str, Any] = {}
    for key in defaults_of(Options):
        if table.has(key):
            value = options[key] = table.data[key]
            if key in OPTIONS:
                options[key] = table.quantity(key, value, OPTIONS[key])
            elif key == "method":
                options[key] = table.word(key, METHOD_NAMES)
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
    body: Any = table.data["body"] if table.has("body") else None
    if type(body) is not int or body not in rods:
        names = ", ".join(map(str, rods))
        table.note("body", f"must be the number of a rod, {names}; got {shown(body)}")
    given = table.data["fraction"] if table.has("fraction") else None
    if given is None:
        table.note("fraction", "is missing; give the place over the length of the rod, from 0 to 1")
    fraction = table.quantity("fraction", given, "dimensionless")
    if not 0 <= fraction <= 1:
        table.note("fraction", f"must lie in [0, 1], got {shown(given)}")
    name = table.data["name"] if table.has("name") else ""
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
            top.note(path, f"is no number that can vary; {suggestion(path, grids.known)}")
    if system is None or top.mistakes:  # where mistakes are, something else stands in
        return
    rods = [body for body in system.bodies if isinstance(body, Rod)]
    used = [f"materials.{s.material.name}." for rod in rods for s in rod.segments]
    used += [f"materials.{entry.get(f'{side}_material')}.{elastic}"
             for entry in top.data.get("contacts", ()) for side in SIDES
             for elastic in ("youngs_modulus", "poisson_ratio")]
    for path in grids.taken:
        if path.startswith("materials.") and not path.startswith(tuple(used)):
            top.note(path, "changes nothing: no rod is made of this material")
