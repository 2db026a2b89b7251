"""Reading of the tables of a case file: they become a `Case`.

Each table names a class of the model by its `kind` or `law`, and gives the numbers that
this class declares. An object with mistakes is replaced by a valid one, its stand-in,
so that reading goes on and finds all mistakes of the file. Then the file is refused.
"""

import math
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .. import materials
from ..hints import listed
from ..methods.registry import Options
from ..model import GAP, SIDES, System
from ..model.bodies import (
    BODIES,
    WAVE_SPEED,
    Body,
    Material,
    RigidMass,
    Rod,
    Segment,
    Wall,
)
from ..model.drag import COEFFICIENT_PER_LENGTH, Drag
from ..model.ends import END_OF_KIND, ENDS, FREE, End
from ..model.frozen import InvalidModel, QuantityField, defaults_of, invalid_argument
from ..model.lateral_inertia import THEORIES
from ..model.laws import CONTACT_LAWS, FACE_RADIUS, ContactLaw, Hertz, Rigid, Spring
from ..model.paths import FIELDS, MODULUS, SPEED, suggestion
from ..model.shaft import SHAFTS, Shaft
from ..model.soil import DAMPING_LAWS, RESISTANCE_PER_LENGTH, Soil
from ..units import shown
from .case import CASE_SCHEMA, Case, GaugePlace
from .case_tables import Reading, Table
from .grids import Tie, read_grids, variables_of
from .saved_result import read_result

DAMPING = {
    "loss_factor": QuantityField("", "non-negative"),
    "loss_frequency": QuantityField("Hz", "positive"),
}
"""Numbers that may be given instead of the viscosity of a material."""
DAMPING_KEYS = {"^frequency": "loss_frequency"}
"""Argument of `Material.damped` with another name in the file: pattern, replacement."""
SYSTEM_KEYS = {r"^gaps\.(\d+)": r"contacts.\1.gap", "^gaps$": "contacts"}
"""Paths of the model with other names in the file: pattern and replacement."""
SEGMENT_KEYS = (*Segment.fields, "material", "lateral_inertia")
ANY_ROD = Rod(1.0, area=1.0, material=materials.steel)
ANY_LAW = Spring(1.0)  # stand-in: a spring is allowed between any two bodies
STAND_INS: dict[str, Body] = {"rod": ANY_ROD, "mass": RigidMass(1.0), "wall": Wall()}
"""Bodies that replace bodies with mistakes, by kind."""
KIND_OF_WORD = {
    "anvil": "wall",
    "ball": "mass",
    "bar": "rod",
    "beam": "rod",
    "floor": "wall",
    "ground": "wall",
    "helmet": "mass",
    "pile": "rod",
    "ram": "mass",
    "soil": "wall",
}
"""Kind of body that is probably meant by a word that is not a kind."""
Materials = dict[str, Material]
"""Materials by name."""


def case_from(
    data: dict[str, Any],
    source: str = "case",
    vary: Mapping[str, ArrayLike] | None = None,
) -> Case:
    """Make a `Case` from the tables of a case file.

    Reading goes on after a mistake, with a stand-in for the object, so that all
    mistakes are found. Then they are raised together.

    Parameters
    ----------
    data : dict
        Tables as ``tomllib.loads`` returns them for a case file.
    source, vary
        As for `parse_case`.

    Returns
    -------
    Case

    Raises
    ------
    InvalidModel
        With all mistakes, each with the path of its entry. It is raised at once if
        `data` is not a dict, if `vary` is wrong, or if the schema is a newer one.
    """
    if not isinstance(data, dict):
        raise invalid_argument(
            source, f"must be the tables of a case file, got {shown(data)}"
        )
    reading = Reading(read_grids(vary))
    top = Table(reading, "", data)  # path "": the whole file
    check_schema(top)
    library = read_materials(top.table("materials"))
    # Arguments of `System`; its only number, the gravity, is among them if it is given.
    arguments = top.given_numbers(System)
    bodies = [read_body(table, library) for table in top.tables("bodies")]
    contacts = read_contacts(top, bodies, library)
    arguments["gaps"] = contacts.gaps
    arguments["contacts"] = contacts.laws
    arguments["ends"] = read_ends(top.table("ends"))
    system = None
    if bodies:
        arguments["bodies"] = list(map(_body_or_any_rod, bodies))
        system = top.make_or_note(System, SYSTEM_KEYS, **arguments)
    else:
        top.note_mistake(
            "bodies", "is missing; describe each body in a [[bodies]] table"
        )
    options = read_solve(top.table("solve"))
    output = read_output(top.table("output"))
    gauges = [read_gauge(table, bodies) for table in top.tables("gauges")]
    result = None
    if top.has("result"):
        saved = top.table("result")
        # `read_result` makes the object here, as a class does elsewhere.
        result = saved.make_or_note(read_result, table=saved.data, bodies=len(bodies))
    top.note_unknown_keys()
    check_grids(top, system)
    if system is None or reading.mistakes:
        raise InvalidModel(list(reading.mistakes.items()))
    varied = []  # in the order of the axes
    for grid in reading.axes:
        if grid.varied is not None:  # always true: `check_grids` refuses other grids
            varied.append(grid.varied)
    return Case(system, options, output, source, tuple(varied), tuple(gauges), result)


def _body_or_any_rod(body: Body | None) -> Body:
    """The body; if it is None, since its kind is unknown, the stand-in `ANY_ROD`."""
    if body is None:
        return ANY_ROD
    return body


def _material_or_steel(material: Material | None) -> Material:
    """The material; if it is None, since it had mistakes, steel as its stand-in."""
    if material is None:
        return materials.steel
    return material


def check_schema(top: Table) -> None:
    """Note a mistake if the schema, the version of the file, is missing or wrong.

    A newer schema raises InvalidModel at once.
    """
    schema = top.get("schema")
    is_whole_number = type(schema) is int  # isinstance would accept True
    if is_whole_number and schema > CASE_SCHEMA:
        # Entries of a newer file may have another meaning, so their mistakes would
        # mislead.
        message = (
            f"is {shown(schema)}; this rodimpact reads {CASE_SCHEMA}, get a newer one"
        )
        raise invalid_argument("schema", message)
    if not is_whole_number or schema != CASE_SCHEMA:
        top.note_mistake(
            "schema",
            f"must be {CASE_SCHEMA}; begin the file with schema = {CASE_SCHEMA}",
        )


def read_materials(group: Table) -> Materials:
    """Materials of the file and of the library, by key.

    `group` has a table for each material of the file. A material of the file replaces
    the material of the library with the same key. If it has a loss factor, its
    viscosity follows from that. Mistakes are noted, and steel stands in for a material
    with mistakes.
    """
    library = dict(materials.TABLE)
    for name in group.data:
        table = group.table(name)
        numbers = read_material_numbers(table)
        shown_name = table.get("name", name)
        built = table.make_or_note(Material, name=shown_name, **numbers)
        material = _material_or_steel(built)
        damping = read_damping(table)
        if damping:
            # Here the method `damped` takes the place of a class: called with these
            # arguments, it returns a material.
            damped = table.make_or_note(material.damped, DAMPING_KEYS, **damping)
            material = _material_or_steel(damped)
        table.note_unknown_keys()
        library[name] = material
    return library


def read_material_numbers(table: Table) -> dict[str, Any]:
    """Numbers that a table of a material gives or varies, as arguments of `Material`.

    A required number that is missing is noted and is nan. The wave speed may be given
    instead of Young's modulus. If the table has both, both are returned; `Material`
    refuses them.
    """
    if not table.has(SPEED):
        return table.given_numbers(Material)
    without = []  # numbers that are not read
    if not table.has(MODULUS):  # the modulus is required: it would be noted as missing
        without.append(MODULUS)
    numbers = table.given_numbers(Material, without)
    numbers[SPEED] = table.number(SPEED, WAVE_SPEED)
    return numbers


def read_damping(table: Table) -> dict[str, Any]:
    """Loss factor and its frequency, the arguments of `Material.damped`.

    The result is {} if neither is given. If only one is given, the other is noted as
    missing, and is nan. A viscosity in addition is noted as a mistake.
    """
    has_factor = table.has_or_varies("loss_factor")
    has_frequency = table.has_or_varies("loss_frequency")
    if not has_factor and not has_frequency:
        return {}
    if table.has_or_varies("viscosity"):
        message = "give either viscosity or loss_factor and loss_frequency, not both"
        table.note_mistake("viscosity", message)
    return {
        "loss_factor": table.number("loss_factor", DAMPING["loss_factor"]),
        "frequency": table.number("loss_frequency", DAMPING["loss_frequency"]),
    }


def read_material(table: Table, library: Materials, key: str = "material") -> Material:
    """The material of `library` that the entry at `key` names.

    Numbers of the material that vary are arrays. A number may vary at the path
    "materials.NAME", for all bodies of this material, or at the path of this entry, for
    one body, if its key is "material". If the entry is missing, unknown or a table, a
    mistake is noted and steel is returned.
    """
    if isinstance(table.get(key), dict):
        message = (
            "must be the name of a material, got a table; "
            "call the table [materials.NAME], and write NAME here"
        )
        table.note_mistake(key, message)
        return materials.steel
    name = table.word(key, library)
    if name is None:
        return materials.steel
    # The entries of this material were read before. An empty table at the same path
    # gives only the numbers that vary there.
    in_library = Table(table.reading, f"materials.{name}", {})
    material = with_varying_numbers(in_library, library[name])
    if key == "material":  # the material of a body, not that of a face of a contact
        in_body = Table(table.reading, table.where(key), {})
        material = with_varying_numbers(in_body, material)
    return material


def with_varying_numbers(table: Table, material: Material) -> Material:
    """Copy of a material with arrays for the numbers that vary at paths of this table.

    The table itself is empty: its numbers come from grids and ties. A varying wave
    speed gives a varying modulus. A mistake is noted; the numbers then keep their
    values.
    """
    changes = {}
    for key, field in Material.fields.items():
        if table.has_or_varies(key):
            changes[key] = table.number(key, field)
    if changes:
        material = replace_in(table, material, **changes)
    if table.has_or_varies(SPEED):
        speed = np.asarray(table.number(SPEED, FIELDS[SPEED]))
        # E = rho c abs(c), not rho c^2: a negative c gives a negative modulus, which
        # the material refuses.
        modulus = material.density * speed * abs(speed)
        material = replace_in(table, material, youngs_modulus=modulus)
    return material


def replace_in(table: Table, material: Material, **numbers: Any) -> Material:
    """Copy of a material with the given numbers replaced.

    If a number is refused, a mistake is noted, and the material itself is returned.
    """
    changed = table.make_or_note(material.replace, **numbers)
    if changed is None:
        return material
    return changed  # type: ignore[no-any-return]


def read_body(table: Table, library: Materials) -> Body | None:
    """The body that a table describes, or a stand-in of its kind if it has mistakes.

    The result is None if the kind is missing or unknown. All mistakes are noted.
    """
    word = table.get("kind")
    if isinstance(word, str) and word.lower() in KIND_OF_WORD:
        meant = KIND_OF_WORD[word.lower()]
        message = (
            f"unknown kind {shown(word)}; use {meant!r}; a kind is rod, mass or wall"
        )
        table.note_mistake("kind", message)
    kind = table.word("kind", BODIES)
    if kind is None:
        return None
    entries: dict[str, Any] = {}
    if kind == Rod.kind:
        entries = read_rod_shape(table, library)
        if table.has("shaft"):
            entries["shaft"] = read_shaft(table.table("shaft"))
    entries |= table.given_numbers(BODIES[kind])
    body: Body | None = None
    # None stands for a segment with mistakes; these are noted already.
    has_faulty_segment = None in entries.get("segments", ())
    if not has_faulty_segment:
        body = table.make_or_note(BODIES[kind], **entries)
    table.note_unknown_keys()
    if body is None:
        return STAND_INS[kind]
    return body


def read_rod_shape(table: Table, library: Materials) -> dict[str, Any]:
    """Arguments of `Rod` for its shape: segments, or length, area, material and so on.

    If the table has segments, the result is {"segments": list}, in which a segment with
    mistakes is None. Keys of a uniform rod, such as a length, are then a mistake and
    are left out. Mistakes are noted.
    """
    if not table.has("segments"):
        return read_segment(table, library)
    has_segment_keys = False
    # No break: each key must be asked for by `has`, or it is noted as unknown.
    for key in SEGMENT_KEYS:
        if table.has(key):
            has_segment_keys = True
    if has_segment_keys:
        keys = "length, area, material and polar_moment"
        table.note_mistake("segments", f"give either segments or {keys}, not both")
    segments = []
    for piece in table.tables("segments"):
        entries = read_segment(piece, library)
        segments.append(piece.make_or_note(Segment, **entries))
        piece.note_unknown_keys()
    return {"segments": segments}


def read_shaft(table: Table) -> Shaft | None:
    """The soil or the drag along a rod; soil if the table has no kind.

    The result is None if the table has mistakes or an unknown kind, which are noted.
    """
    kind = table.word("kind", SHAFTS, Soil.kind)
    if kind is None:
        return None
    if kind == Drag.kind:
        return read_drag(table)
    return read_soil(table)


def read_drag(table: Table) -> Drag | None:
    """The drag along a rod; None if it has mistakes, which are noted.

    A coefficient that is a number holds for the whole rod; a profile gives it per unit
    length.
    """
    if isinstance(table.get("coefficient"), dict):
        # A table is a profile along the rod: its values are in N s/m^2, not N s/m.
        entries = table.given_numbers(Drag, without=["coefficient"])
        entries["coefficient"] = table.number("coefficient", COEFFICIENT_PER_LENGTH)
    else:
        entries = table.given_numbers(Drag)
    drag: Drag | None = table.make_or_note(Drag, **entries)
    table.note_unknown_keys()
    return drag


def read_soil(table: Table) -> Soil | None:
    """The soil along a rod; None if it has mistakes, which are noted.

    A resistance that is a number holds for the whole rod; a profile gives it per unit
    length. After an unknown damping law no further mistakes are looked for.
    """
    if isinstance(table.get("resistance"), dict):
        # A table is a profile along the rod: its values are in N/m, not N.
        entries = table.given_numbers(Soil, without=["resistance"])
        entries["resistance"] = table.number("resistance", RESISTANCE_PER_LENGTH)
    else:
        entries = table.given_numbers(Soil)
    if table.has("law"):
        word = table.word("law", DAMPING_LAWS)
        if word is None:
            return None
        entries["law"] = word
    soil: Soil | None = table.make_or_note(Soil, **entries)
    table.note_unknown_keys()
    return soil


def read_segment(table: Table, library: Materials) -> dict[str, Any]:
    """Arguments of `Segment` that a table gives; the material is always among them.

    A required number that is missing is nan. If the theory of lateral inertia is
    unknown, it is None, and so is the polar moment. Both mistakes are noted.
    """
    entries = table.given_numbers(Segment)
    entries["material"] = read_material(table, library)
    if table.has("lateral_inertia"):
        theory = table.word("lateral_inertia", THEORIES)
        entries["lateral_inertia"] = theory
        if theory is None:  # `Segment` would refuse a polar moment without a theory
            entries["polar_moment"] = None
    return entries


class Contacts(NamedTuple):
    """Gaps and laws of all contacts, from left to right."""

    gaps: list[Any]  # m; a number, or an array where it varies
    laws: list[ContactLaw]


def read_contacts(
    top: Table, bodies: list[Body | None], library: Materials
) -> Contacts:
    """Gaps and laws of the contacts, one for each table of a contact in the file.

    If the file has no such tables, all contacts between `bodies` are rigid with the gap
    0, except for numbers that a grid varies. The number of tables is not checked here.
    """
    tables = top.tables("contacts")
    if not top.has("contacts"):
        # An empty table gives a contact the default numbers, or the grids at its path.
        for i in range(len(bodies) - 1):
            tables.append(Table(top.reading, f"contacts.{i}", {}))
    gaps = []
    laws = []
    for i, table in enumerate(tables):
        gap = 0.0
        if table.has_or_varies("gap"):
            gap = table.number("gap", GAP)
        gaps.append(gap)
        pair = bodies[i : i + 2]  # on the left and on the right of the contact
        laws.append(read_law(table, pair, library))
    return Contacts(gaps, laws)


def read_law(table: Table, pair: list[Body | None], library: Materials) -> ContactLaw:
    """The law of a contact; `Rigid` if the table names no law.

    `ANY_LAW` stands in for a law with mistakes, which are noted. It also stands in for
    a rigid law with a restitution if one of the two bodies is unknown. A Hertz contact
    may have the radii of its faces instead of a stiffness. `pair` has the left and the
    right body, None for a body of unknown kind; it is shorter if the case has too few
    bodies.
    """
    name = table.word("law", CONTACT_LAWS, Rigid.law)
    if name is None:
        return ANY_LAW
    has_radius = False
    if name == Hertz.law:
        # No break: `has_or_varies` notes the path of each side as one that can vary.
        for side in SIDES:
            if table.has_or_varies(f"{side}_radius"):
                has_radius = True
        has_stiffness = table.has_or_varies("stiffness")
        if has_stiffness == has_radius:  # both, or neither
            message = "give either the stiffness, or left_radius and right_radius"
            table.note_mistake("stiffness", message)
    law: ContactLaw | None
    if has_radius:
        faces = read_faces(table, pair, library)
        law = table.make_or_note(Hertz.from_radii, **faces)
        table.note_unknown_keys()
    else:
        law = table.read_object(CONTACT_LAWS[name])
    knows_both_bodies = len(pair) == 2 and None not in pair
    has_restitution = isinstance(law, Rigid) and law.restitution is not None
    if has_restitution and not knows_both_bodies:
        return ANY_LAW  # `Rigid` may have a restitution between some kinds of body only
    if law is None:
        return ANY_LAW
    return law


def read_faces(
    table: Table, pair: list[Body | None], library: Materials
) -> dict[str, Any]:
    """Radii and materials of the faces of a Hertz contact, for `Hertz.from_radii`.

    A radius that is not given is infinite: the face is flat. A material that is not
    given is the material of the rod; for a mass or a wall it is None: the face is
    rigid. Steel stands in if `pair` has None for the body, or no body.
    """
    faces: dict[str, Any] = {}
    bodies = [*pair, None, None]  # None for missing bodies; the loop takes the first 2
    # `touching`: the last segment (-1) of the left body touches the first one (0) of
    # the right body.
    for side, body, touching in zip(SIDES, bodies, (-1, 0), strict=False):
        radius_key = f"{side}_radius"
        faces[radius_key] = math.inf
        if table.has_or_varies(radius_key):
            faces[radius_key] = table.number(radius_key, FACE_RADIUS)
        material_key = f"{side}_material"
        faces[material_key] = None  # rigid
        if table.has(material_key):
            faces[material_key] = read_material(table, library, material_key)
        elif body is None:
            faces[material_key] = materials.steel
        elif isinstance(body, Rod):
            faces[material_key] = body.segments[touching].material
    return faces


def read_ends(sides: Table) -> list[End]:
    """The left and the right end of the row, in this order.

    An end that is not given is free. An end with mistakes is free, too, and they are
    noted. Kinds that earlier versions wrote (in `END_OF_KIND`) are still read; messages
    name only the kinds of `ENDS`.
    """
    ends: list[End] = []
    for side in SIDES:
        end: End | None = None
        if sides.has(side):
            table = sides.table(side)
            kind = table.get("kind")
            if isinstance(kind, str) and kind in END_OF_KIND:
                end = table.read_object(END_OF_KIND[kind])
            else:
                table.word("kind", ENDS)  # only notes the mistake
        if end is None:
            end = FREE
        ends.append(end)
    sides.note_unknown_keys()
    return ends


def read_solve(table: Table) -> dict[str, Any]:
    """Arguments of `solve` that the table gives, by name; quantities in SI units.

    Mistakes are noted. A wrong value is returned as it is; a quantity that cannot be
    read is nan.
    """
    options = {}
    for key in defaults_of(Options):
        if table.has(key):
            options[key] = table.get(key)
            if key in Options.fields:  # a number, which may have a unit
                dimension = Options.fields[key].dimension
                options[key] = table.quantity(key, options[key], dimension)
    table.make_or_note(Options, **options)  # only notes the mistakes
    table.note_unknown_keys()
    return options


def read_output(table: Table) -> dict[str, str]:
    """Names of the files to write, by the words "plot" and "save", if given.

    A wrong name is noted as a mistake, but is returned, too.
    """
    names = {}
    for key in ("plot", "save"):
        if table.has(key):
            name = table.get(key)
            names[key] = name
            # No file system has a name with the character NUL.
            if not isinstance(name, str) or name == "" or "\0" in name:
                table.note_mistake(
                    key, f"must be the name of a file, got {shown(name)}"
                )
    table.note_unknown_keys()
    return names


def read_gauge(table: Table, bodies: list[Body | None]) -> GaugePlace:
    """The strain gauge that a table describes; mistakes are noted.

    `body` must be the index of a rod among the bodies, from 0 on. `fraction` must be
    from 0 to 1, and `name`, if it is given, must be text. A fraction that is missing or
    not a number becomes nan; other wrong entries are returned as they are.
    """
    rods = [i for i, body in enumerate(bodies) if isinstance(body, Rod)]
    body = table.get("body")
    is_rod = type(body) is int and body in rods  # isinstance would accept True as 1
    if not is_rod:
        numbers = ", ".join(map(str, rods))
        message = f"must be the number of a rod, {numbers}; got {shown(body)}"
        table.note_mistake("body", message)
    fraction = table.get("fraction", math.nan)
    if table.has("fraction"):
        fraction = table.quantity("fraction", fraction, "dimensionless")
    if not 0 <= fraction <= 1:  # also true for nan
        # If `quantity` has noted a mistake of this entry, the second one is dropped.
        message = "give the place over the length of the rod, from 0 to 1"
        table.note_mistake("fraction", message)
    name = table.get("name", "")
    if not isinstance(name, str):
        table.note_mistake("name", f"must be text, got {shown(name)}")
    table.note_unknown_keys()
    return GaugePlace(body, fraction, name)


def note_wrong_units(top: Table) -> None:
    """Note a mistake for each number that is tied to a quantity of another unit.

    All numbers must have been read. A tie whose source has no values is not checked.
    """
    for path, tie in top.reading.grids.items():
        if isinstance(tie, Tie) and tie.source.varied is not None:
            mistake = tie.wrong_unit()
            if mistake != "":
                top.note_mistake(path, mistake)


def check_grids(top: Table, system: System | None) -> None:
    """Note grids of unknown numbers, ties of a wrong unit, grids that change nothing.

    The last two are looked for only if the file has no other mistakes. `system` is None
    if it could not be made. The grids of variables get their values here, in
    `Grid.varied`; the grids of numbers got theirs when the numbers were read.
    """
    reading = top.reading
    # Numbers of tables that were not read are not known: tables with a wrong kind or
    # law, and entries that should be tables.
    unread_tables = []
    for path in reading.mistakes:
        table_path = re.sub(r"\.(kind|law)$", "", path)
        unread_tables.append(f"{table_path}.")  # paths of its numbers begin with this
    variables = variables_of(reading.grids, reading.numbers)
    for path in reading.grids:
        if path in variables or path in reading.numbers:
            continue
        if path.startswith(tuple(unread_tables)):
            continue  # without the mistake, the table may have this number
        remedy = other_way_to_vary(path, top)
        if remedy == "":
            remedy = suggestion(path, reading.numbers)
        top.note_mistake(path, f"is no number that can vary; {remedy}")
    if system is None or reading.mistakes:
        return  # the stand-in of an object with mistakes does not vary
    grids = reading.axes
    for grid in grids:
        if grid.path in variables:
            grid.varied = grid.amounts()
    note_wrong_units(top)
    shape = system.shape
    if shape == ():  # no number varies: sizes 0 make the loop note every grid
        shape = (0,) * len(grids)
    for size, grid in zip(shape, grids, strict=True):
        # An axis along which no number varies is shorter than its grid.
        if grid.varied is None or size != grid.varied.values.size:
            top.note_mistake(grid.path, "changes nothing in this row")


def other_way_to_vary(path: str, top: Table) -> str:
    """Remedy for a wrong path of a number to vary, as the end of a message; "" if none.

    There is a remedy for a path that ends in ".material", and for a number that a rigid
    contact does not have, but that other laws have.
    """
    # The material of a body has numbers at longer paths, such as its density.
    if path.endswith(".material") and f"{path}.density" in top.reading.numbers:
        return (
            "write a case with each material, and solve each by `rodimpact run`, or "
            f"vary {path}.youngs_modulus"
        )
    # Groups: path of the contact, name of the number
    number_path = re.fullmatch(r"(contacts\.\d+)\.(\w+)", path)
    if (
        number_path is None
        or f"{number_path[1]}.restitution" not in top.reading.numbers
    ):
        return ""  # no such contact, or not a rigid one: only `Rigid` has a restitution
    laws = []
    for law, kind in CONTACT_LAWS.items():
        if number_path[2] in kind.fields:
            laws.append(f'"{law}"')
    if not laws:
        return ""
    return f"give {number_path[1]} a law that has it, one of {listed(laws)}"
