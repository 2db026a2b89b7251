"""Writing of a case as a case file: the descriptions of its objects, in TOML."""

import json
import re
from collections.abc import Mapping
from typing import Any

from ..hints import explain_arguments
from ..model import System
from ..model.bodies import Material, Rod
from ..model.frozen import invalid_argument
from ..units import shown
from .case import CASE_SCHEMA, MAX_CASE_BYTES, Case
from .saved_result import SavedResult
from .writing import PathLike, check_ending, write_bytes

MAX_ITEMS_PER_LINE = 6
"""Largest number of items of a list in one line."""


@explain_arguments
def format_case(case: Case | System) -> str:
    """Return the text of the case file of a case, or just of a system.

    The numbers of every material are written, so that the file means the same if the
    library of materials changes.

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
        For a family, for an object that is not a case, for laws that are functions, and
        for names that cannot be written in UTF-8.

    Examples
    --------
    >>> from rodimpact.materials import steel
    >>> from rodimpact.model import Rod, System, Wall
    >>> from rodimpact.storage.casefile import parse_case
    >>> system = System([Rod(0.4, area=1e-4, material=steel, velocity=1.0), Wall()])
    >>> parse_case(format_case(system)).system == system
    True
    """
    if isinstance(case, System):
        case = Case(case)
    if not isinstance(case, Case) or not isinstance(case.system, System):
        raise invalid_argument("case", f"must be a Case or a System, got {shown(case)}")
    system = case.system
    if system.shape != ():
        message = (
            f"a family of shape {system.shape} is no single case; write system[index]"
        )
        raise invalid_argument("system", message)
    system.check_file()  # raises if a law is a function
    parts = _system_tables(system)
    for gauge in case.gauges:
        entries = gauge._asdict()
        if not gauge.name:
            entries["name"] = None  # `toml_table` leaves it out
        parts.append(toml_table("[[gauges]]", entries))
    if case.solve:
        parts.append(toml_table("[solve]", case.solve))
    if case.output:
        parts.append(toml_table("[output]", case.output))
    if case.result:
        parts += _result_tables(case.result)
    text = "\n\n".join(parts) + "\n"
    _check_utf8(text)
    return text


def _system_tables(system: System) -> list[str]:
    """Tables of a case file that describe a system, each as text.

    The first has the schema and the gravity, if there is any. Materials, bodies with
    their segments, contacts and ends follow.
    """
    described = system.to_dict()
    materials = _name_materials(system, described)
    parts = [
        # The top of the file has no header; the line of the schema takes its place.
        toml_table(f"schema = {CASE_SCHEMA}", {"gravity": described.get("gravity")})
    ]
    for key, material in materials.items():
        entries = material.to_dict()
        entries["name"] = None  # left out if the key is the name of the material
        if key != material.name:
            entries["name"] = material.name
        parts.append(toml_table(f"[materials.{_key(key)}]", entries))
    for body in described["bodies"]:
        # Segments are left out here (None); their own tables follow.
        parts.append(toml_table("[[bodies]]", body | {"segments": None}))
        for segment in body.get("segments", ()):
            parts.append(toml_table("[[bodies.segments]]", segment))
    for contact in described["contacts"]:
        parts.append(toml_table("[[contacts]]", contact))
    for side, end in described.get("ends", {}).items():
        parts.append(toml_table(f"[ends.{side}]", end))
    return parts


def _check_utf8(text: str) -> None:
    """Raise InvalidModel if a text cannot be written in UTF-8."""
    try:
        text.encode()
    except UnicodeEncodeError as error:
        wrong = shown(text[error.start : error.end])
        message = f"has a name with {wrong}, which is no character of UTF-8; rename it"
        raise invalid_argument("case", message) from None


@explain_arguments
def write_case(path: PathLike, case: Case | System, *, force: bool = False) -> None:
    """Write a case, or just a system, as a case file; an error leaves no partial file.

    Parameters
    ----------
    path : str or path
        Name of the file; it ends in ``.toml``.
    case : Case or System
    force : bool
        Whether to replace an existing file.

    Raises
    ------
    InvalidModel
        As `format_case`; also if the name does not end in ``.toml``, and if the file
        would have more than `MAX_CASE_BYTES`.
    FileExistsError
        If the file is there and `force` is false.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "rod.toml")
    ...     ri.write_case(path, ri.System([rod, ri.Wall()]))
    ...     ri.read_case(path).system.bodies[0] == rod
    True
    """
    check_case_name(path)
    data = format_case(case).encode()
    if len(data) > MAX_CASE_BYTES:
        message = (
            f"has too many numbers for a case file: {len(data)} bytes, and at most "
            f"{MAX_CASE_BYTES} are read. Give profiles of fewer samples; instead of a "
            "later state save the solution that has it"
        )
        raise invalid_argument("system", message)
    write_bytes(path, data, force=force)


def check_case_name(path: PathLike) -> None:
    """Raise InvalidModel unless the name of a file ends in ``.toml``."""
    check_ending(path, (".toml",), "a solution is saved as its case")


def _name_materials(system: System, described: dict[str, Any]) -> dict[str, Material]:
    """Give each material of a rod a key, and return the materials by key.

    `described`, the description of the system, is changed in place: the material of
    each rod or segment is replaced by its key. A key is the name of the material,
    followed by a number if another material has the same name.
    """
    named: dict[str, Material] = {}
    # Keys by the id of the material: many segments share one object.
    keys: dict[int, str] = {}
    for body, table in zip(system.bodies, described["bodies"], strict=True):
        if not isinstance(body, Rod):
            continue
        # The table of a uniform rod is that of its only segment, too.
        pieces = table.get("segments", [table])
        for segment, piece in zip(body.segments, pieces, strict=True):
            material = segment.material
            if id(material) not in keys:
                keys[id(material)] = _free_key(named, material)
            piece["material"] = keys[id(material)]
    return named


def _free_key(named: dict[str, Material], material: Material) -> str:
    """Key of a material: its name, or a key like ``"steel 2"`` if the name is taken.

    The material is added to `named` at its key. If `named` has an equal material, the
    result is the key of that one.
    """
    key = material.name
    number = 1
    while key in named and named[key] != material:
        number += 1
        key = f"{material.name} {number}"
    if key not in named:
        named[key] = material
    return key


def _result_tables(result: SavedResult) -> list[str]:
    """The tables [result], [result.numbers] and [result.accuracy], each as text.

    The first has the words, such as the status, and whether the result is final.
    """
    words = result._asdict()
    numbers = words.pop("numbers")
    accuracy = words.pop("accuracy")
    return [
        toml_table("[result]", words),
        toml_table("[result.numbers]", numbers),
        toml_table("[result.accuracy]", accuracy),
    ]


def toml_table(header: str, entries: Mapping[str, Any]) -> str:
    """A table of a case file: a header such as "[solve]", then one line per entry.

    Entries that are None are left out.
    """
    lines = [header]
    for key, value in entries.items():
        if value is not None:
            lines.append(f"{_key(key)} = {_toml(value)}")
    return "\n".join(lines)


def _key(name: str) -> str:
    """A key of TOML, in quotes unless it has only letters, digits, "_" and "-"."""
    if re.fullmatch("[A-Za-z0-9_-]+", name):
        return name
    return _toml(name)


def _toml(value: Any) -> str:
    """A value as TOML: a number, a text, a list, an array or a dictionary.

    A list of more than `MAX_ITEMS_PER_LINE` items takes several lines.
    """
    if hasattr(value, "tolist"):  # an array or a number of NumPy
        value = value.tolist()
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        # A string of JSON is a string of TOML, except that TOML requires an escape for
        # the character DEL.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, dict):
        entries = [f"{_key(key)} = {_toml(item)}" for key, item in value.items()]
        return "{" + ", ".join(entries) + "}"
    if isinstance(value, list | tuple):
        items = list(map(_toml, value))
        if len(items) <= MAX_ITEMS_PER_LINE:
            return "[" + ", ".join(items) + "]"
        lines = []
        for start in range(0, len(items), MAX_ITEMS_PER_LINE):
            lines.append(", ".join(items[start : start + MAX_ITEMS_PER_LINE]))
        return "[\n  " + ",\n  ".join(lines) + "\n]"
    return repr(value)  # a number; TOML has the words inf and nan, too
