"""Case files: a collision written down in TOML, read with every mistake reported at once.

    schema = 1

    [[bodies]]
    kind = "rod"
    length = "400 mm"        # a number in SI units, or text with a unit
    area = 1e-4              # or the `diameter` of a round rod
    material = "steel"       # of `rodimpact.materials`, or a [materials.NAME] of this file
    velocity = 1.0           # or a profile {values = [1.0, 0.0], at = [0.1]}; so is `strain`

    [[bodies]]
    kind = "wall"            # takes `velocity` only

    [[contacts]]             # entry i lies between body i and i + 1; leave all out for touching
    gap = "50 um"
    law = "rigid"            # or "bonded"

    [solve]                  # until, method, max_events: as for `rodimpact.solve`
    [output]                 # plot, save: names of files to write

A [materials.NAME] takes youngs_modulus, density, poisson_ratio and viscosity; a stepped rod takes
[[bodies.segments]] with length, area and material each. Mistakes bear the path of the entry, such
as `bodies.0.length`.
"""

from __future__ import annotations

import difflib
import json
import math
import os
import re
import reprlib
import tomllib
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from . import materials, units
from .frozen import InvalidModel, Problems
from .model import (
    CONTACT_LAWS,
    Body,
    Material,
    Rod,
    Segment,
    Steps,
    System,
    Wall,
)
from .solving import METHODS

SCHEMA = 1
MISSING = math.nan  # default of an entry that must be there, and what stands for it then

Materials = dict[str, Material]


@dataclass(frozen=True)
class Case:
    """A collision and what to do with it.

    Attributes
    ----------
    system : System
        Of shape ().
    solve : dict
        Those of `until` (s), `method` and `max_events` that were given, for ``ri.solve``.
    output : dict of str
        Those of `plot` and `save` that were given: names of files.
    path : str
        Where it was read from; empty if from nowhere.
    """

    system: System
    solve: dict[str, Any] = field(default_factory=dict)
    output: dict[str, str] = field(default_factory=dict)
    path: str = ""


# Reading ------------------------------------------------------------------------------------------


def read_case(path: str | os.PathLike[str]) -> Case:
    """Read a case file.

    Parameters
    ----------
    path : str or path
        Of a TOML file in UTF-8.

    Returns
    -------
    Case

    Raises
    ------
    InvalidModel
        If the file cannot be read, is no TOML, or describes no collision; with all its mistakes.
    """
    name = os.fspath(path)
    try:
        raw = Path(path).read_bytes()
    except (OSError, ValueError) as error:  # a name with a null byte is a ValueError
        reason = getattr(error, "strerror", None) or error
        raise InvalidModel([(name, f"cannot be read: {reason}")]) from None
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        message = f"is not text in UTF-8 (at line {line}); save it as UTF-8"
        raise InvalidModel([(name, message)]) from None
    return parse_case(text, name)


def parse_case(text: str, source: str = "case") -> Case:
    """Read the text of a case file.

    Parameters
    ----------
    text : str
        TOML.
    source : str
        What to call it where the text itself is at fault.

    Returns
    -------
    Case

    Raises
    ------
    InvalidModel
        With all mistakes, each with the path of its entry.

    Examples
    --------
    >>> case = parse_case('''
    ... schema = 1
    ... bodies = [
    ...     {kind = "rod", length = "40 cm", area = "1 cm^2", material = "steel", velocity = 1},
    ...     {kind = "wall"},
    ... ]
    ... ''')
    >>> case.system.bodies[0].length, case.system.gaps
    (0.4, (0.0,))
    """
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # a number of 5000 digits is a plain ValueError
        raise InvalidModel([(source, f"is not valid TOML: {error}")]) from None
    problems: Problems = []
    top = _Table(problems, "", data)
    _check_schema(top)
    known = _read_materials(top)
    bodies = [_read_body(table, known) for table in top.tables("bodies")]
    if not bodies:
        top.note("bodies", "is missing; describe each body in a [[bodies]] table")
    gaps, laws = _read_contacts(top, len(bodies) - 1)
    system: Any = bodies and top.make(System, bodies=bodies, gaps=gaps, contacts=laws)
    options, output = _read_solve(top.table("solve")), _read_output(top.table("output"))
    top.close()
    if problems:
        raise InvalidModel(problems)
    return Case(system, options, output, source)


class _Table:
    """One table of the file: hands out entries by name, notes mistakes with their paths."""

    def __init__(self, problems: Problems, path: str, data: dict[str, Any]) -> None:
        self.problems, self.path, self.data = problems, path, data
        self.asked: list[str] = []

    def where(self, key: str) -> str:
        return f"{self.path}.{key}" if self.path else key

    def note(self, key: str, message: str) -> None:
        """Note a mistake, unless this entry has one already: the second would come of the first."""
        path = self.where(key)
        if all(known != path for known, _ in self.problems):
            self.problems.append((path, message))

    def has(self, key: str) -> bool:
        self.asked.append(key)
        return key in self.data

    def number(self, key: str, dimension: str, default: Any = MISSING) -> Any:
        if self.has(key):
            return self.quantity(key, self.data[key], dimension)
        if default is MISSING:
            self.note(key, f"is missing; give {_unit_hint(dimension)}")
        return default

    def quantity(self, key: str, value: Any, dimension: str) -> float:
        """Value of a number or text with unit, nan if it is neither."""
        if isinstance(value, list):
            message = f"must be a single number, got {_short(value)}"
            if key in ("velocity", "strain") and self.data.get("kind") == "rod":
                message += "; a profile is written {values = [...], at = [...]}"
            self.note(key, message)
            return MISSING
        try:
            return units.parse(value, dimension)
        except ValueError as error:
            self.note(key, str(error))
            return MISSING

    def profile(self, key: str, dimension: str) -> Any:
        """A number or `Steps`, 0 where there is neither."""
        if not isinstance(self.data.get(key), dict):
            return self.number(key, dimension, 0.0)
        steps = self.table(key)
        lists = {name: steps.numbers(name, of) for name, of in
                 (("values", dimension), ("at", "length"))}
        steps.close()
        return steps.make(Steps, **lists) or 0.0

    def numbers(self, key: str, dimension: str) -> list[float] | None:
        if not self.has(key):
            self.note(key, "is missing; give a list of numbers")
            return None
        if not isinstance(self.data[key], list):
            self.note(key, f"must be a list of numbers, got {_short(self.data[key])}")
            return None
        return [self.quantity(f"{key}.{i}", v, dimension) for i, v in enumerate(self.data[key])]

    def word(self, key: str, choices: Collection[str], default: str | None = None) -> str | None:
        """One of `choices`, None where it is not."""
        if not self.has(key):
            if default is None:
                self.note(key, f"is missing; use one of {', '.join(choices)}")
            return default
        value = self.data[key]
        if isinstance(value, str) and value in choices:
            return value
        self.note(key, f"unknown {key} {_short(value)}; {_nearest(value, choices)}")
        return None

    def table(self, key: str) -> _Table:
        """The table of that name, an empty one if there is none."""
        data = self.data[key] if self.has(key) else {}
        if isinstance(data, dict):
            return _Table(self.problems, self.where(key), data)
        self.note(key, f"must be a table, got {_short(data)}")
        return _Table([], self.where(key), {})  # what it lacks is no further mistake

    def tables(self, key: str) -> list[_Table]:
        """All tables of that name."""
        data = self.data[key] if self.has(key) else []
        if not isinstance(data, list) or not all(isinstance(item, dict) for item in data):
            brackets = re.sub(r"\.\d+", "", self.where(key))
            self.note(key, f"must be tables that each begin [[{brackets}]], got {_short(data)}")
            data = []
        return [_Table(self.problems, self.where(f"{key}.{i}"), d) for i, d in enumerate(data)]

    def make(self, kind: Any, **fields: Any) -> Any:
        """An object of the model; None, with its mistakes noted here, if they allow none."""
        try:
            return kind(**fields)
        except InvalidModel as error:
            for path, message in error.problems:
                self.note(re.sub(r"^gaps\.(\d+)$", r"contacts.\1.gap", path), message)
            return None

    def close(self) -> None:
        """Note every entry that nobody asked for."""
        for key in self.data:
            if key not in self.asked:
                self.note(key, f"unknown key; {_nearest(key, dict.fromkeys(self.asked))}")


def _check_schema(top: _Table) -> None:
    schema = top.data["schema"] if top.has("schema") else None
    if schema is None:
        top.note("schema", f"is missing; begin the file with schema = {SCHEMA}")
    elif type(schema) is int and schema > SCHEMA:  # its other entries may mean other things
        message = f"is {schema}; this rodimpact reads {SCHEMA}, get a newer one"
        raise InvalidModel([("schema", message)])
    elif type(schema) is not int or schema != SCHEMA:
        top.note("schema", f"must be {SCHEMA}, got {_short(schema)}")


def _read_materials(top: _Table) -> Materials:
    """Materials by name; steel stands in for those with mistakes."""
    known, group = dict(materials.TABLE), top.table("materials")
    for name in group.data:
        table = group.table(name)
        made = table.make(
            Material,
            name=name,
            youngs_modulus=table.number("youngs_modulus", "pressure"),
            density=table.number("density", "density"),
            poisson_ratio=table.number("poisson_ratio", "dimensionless", None),
            viscosity=table.number("viscosity", "viscosity", 0.0),
        )
        table.close()
        known[name] = made or materials.steel
    return known


def _read_body(table: _Table, known: Materials) -> Body:
    """The body; where mistakes allow none, any of its kind stands in."""
    kind = table.word("kind", ("rod", "wall"))
    body: Body | None = None
    if kind == "wall":
        body = table.make(Wall, velocity=table.number("velocity", "velocity", 0.0)) or Wall()
    elif kind == "rod":
        shape = _read_segments(table, known) if table.has("segments") else _shape(table, known)
        velocity = table.profile("velocity", "velocity")
        strain = table.profile("strain", "dimensionless")
        if None not in shape.get("segments", ()):
            body = table.make(Rod, **shape, velocity=velocity, strain=strain)
    if kind:  # without it, who knows which keys are right
        table.close()
    return body or Rod(1.0, area=1.0, material=materials.steel)


def _read_segments(table: _Table, known: Materials) -> dict[str, Any]:
    if [key for key in ("length", "area", "diameter", "material") if table.has(key)]:
        table.note("segments", "give either segments or length, area and material, not both")
    pieces = []
    for piece in table.tables("segments"):
        pieces.append(piece.make(Segment, **_shape(piece, known)))
        piece.close()
    return {"segments": pieces}


def _shape(table: _Table, known: Materials) -> dict[str, Any]:
    return {
        "length": table.number("length", "length"),
        "area": _area(table),
        "material": _material(table, known),
    }


def _area(table: _Table) -> float:
    """Area of the cross-section, m^2; of a round one, pi/4 times the square of its diameter."""
    if not table.has("diameter"):
        if not table.has("area"):
            table.note("area", "is missing; give it, or the diameter of a round rod")
        return float(table.number("area", "area"))
    if table.has("area"):
        table.note("diameter", "give either area or diameter, not both")
    d = float(table.number("diameter", "length"))
    if not d > 0:
        table.note("diameter", f"must be a finite positive number of metres, got {d!r}")
        return 1.0
    return math.pi * d * d / 4


def _material(table: _Table, known: Materials) -> Material:
    """The material that the table names; steel stands in for an unknown one."""
    if not table.has("material"):
        table.note("material", "is missing; name one of rodimpact.materials or of this file")
        return materials.steel
    name = table.data["material"]
    if isinstance(name, str) and name in known:
        return known[name]
    table.note("material", f"unknown material {_short(name)}; {_nearest(name, known)}")
    return materials.steel


def _read_contacts(top: _Table, pairs: int) -> tuple[list[float], list[Any]]:
    """Gaps and laws of all pairs."""
    gaps, laws = [], []
    for table in top.tables("contacts"):
        gaps.append(float(table.number("gap", "length", 0.0)))
        laws.append(CONTACT_LAWS[table.word("law", CONTACT_LAWS, "rigid") or "rigid"]())
        table.close()
    if "contacts" in top.data and 0 <= pairs != len(gaps):
        message = f"needs one entry for each neighbouring pair, {pairs} in all, got {len(gaps)}"
        top.note("contacts", message + "; leave all out if all bodies touch")
    more = pairs - len(gaps)
    rigid = CONTACT_LAWS["rigid"]()
    return [*gaps, *[0.0] * more][:pairs], [*laws, *[rigid] * more][:pairs]


def _read_solve(table: _Table) -> dict[str, Any]:
    options: dict[str, Any] = {}
    if table.has("until"):
        options["until"] = table.number("until", "time")
        if options["until"] < 0:
            table.note("until", f"must not be negative, got {options['until']!r}")
    if table.has("method"):
        options["method"] = table.word("method", ("auto", *METHODS))
    if table.has("max_events"):
        options["max_events"] = limit = table.data["max_events"]
        if type(limit) is not int or limit < 1:
            table.note("max_events", f"must be a positive whole number, got {_short(limit)}")
    table.close()
    return options


def _read_output(table: _Table) -> dict[str, str]:
    names = {key: table.data[key] for key in ("plot", "save") if table.has(key)}
    for key, name in names.items():
        if not isinstance(name, str) or not name:
            table.note(key, f"must be the name of a file, got {_short(name)}")
    table.close()
    return names


def _unit_hint(dimension: str) -> str:
    if dimension == "dimensionless":
        return "a number"
    return f"a {dimension}, in SI units or as text with one of {', '.join(units.UNITS[dimension])}"


def _nearest(word: Any, choices: Collection[str]) -> str:
    plain = {choice.casefold(): choice for choice in choices}
    near = difflib.get_close_matches(str(word).casefold(), plain, n=1)
    if near:
        return f"perhaps {plain[near[0]]!r} is meant"
    return f"use one of {', '.join(plain.values())}"


def _short(value: Any) -> str:
    return reprlib.repr(value)


# Writing ------------------------------------------------------------------------------------------


def write_case(case: Case | System) -> str:
    """Write a case, or just a system, as the text of a case file.

    Every material is spelt out, so that the file means the same whatever the table says later.

    Parameters
    ----------
    case : Case or System

    Returns
    -------
    str
        TOML, from which `parse_case` makes an equal system.

    Raises
    ------
    InvalidModel
        For a family, and where two different materials bear one name.

    Examples
    --------
    >>> from rodimpact.model import Rod, System, Wall
    >>> system = System([Rod(0.4, area=1e-4, material=materials.steel, velocity=1.0), Wall()])
    >>> parse_case(write_case(system)).system == system
    True
    """
    if isinstance(case, System):
        case = Case(case)
    system = case.system
    if system.shape != ():
        message = f"a family of shape {system.shape} is no single case; write system[index]"
        raise InvalidModel([("system", message)])
    found: Materials = {}
    for i, body in enumerate(system.bodies):
        for material in (s.material for s in body.segments) if isinstance(body, Rod) else ():
            if found.setdefault(material.name, material) != material:
                message = f"another material is called {material.name!r} too; rename one"
                raise InvalidModel([(f"bodies.{i}.material", message)])
    lines = [f"schema = {SCHEMA}"]
    for name, material in found.items():
        key = name if re.fullmatch("[A-Za-z0-9_-]+", name) else _toml(name)
        lines += _lines(f"[materials.{key}]", material.to_dict(), without=("name",))
    described = system.to_dict()
    for body_table in described["bodies"]:
        lines += _lines("[[bodies]]", body_table, without=("segments",))
        for segment in body_table.get("segments", ()):
            lines += _lines("[[bodies.segments]]", segment)
    for contact in described["contacts"]:
        lines += _lines("[[contacts]]", contact)
    for name, options in (("solve", case.solve), ("output", case.output)):
        lines += _lines(f"[{name}]", options) if options else []
    return "\n".join(lines) + "\n"


def _lines(header: str, table: dict[str, Any], without: tuple[str, ...] = ()) -> list[str]:
    kept = {k: v for k, v in table.items() if v is not None and k not in without}
    if "material" in kept:
        kept["material"] = kept["material"]["name"]
    return ["", header, *(f"{key} = {_toml(value)}" for key, value in kept.items())]


def _toml(value: Any) -> str:
    if isinstance(value, str):  # a string of JSON is one of TOML, but for DEL
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return repr(value)
