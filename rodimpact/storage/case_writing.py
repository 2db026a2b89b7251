"""A case is written as the text of a case file: what the model says of itself, as TOML."""

import json
import re
from typing import Any

from ..model import System
from ..model.bodies import Material, Rod
from ..model.frozen import refusal
from ..units import shown
from .case import SCHEMA, Case


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
        For a family, for what is no case, and where two different materials bear one name.

    Examples
    --------
    >>> from rodimpact.materials import steel
    >>> from rodimpact.model import Rod, System, Wall
    >>> from rodimpact.storage.casefile import parse_case
    >>> system = System([Rod(0.4, area=1e-4, material=steel, velocity=1.0), Wall()])
    >>> parse_case(write_case(system)).system == system
    True
    """
    if isinstance(case, System):
        case = Case(case)
    if not isinstance(case, Case) or not isinstance(case.system, System):
        raise refusal("case", f"must be a Case or a System, got {shown(case)}")
    system = case.system
    if system.shape != ():
        message = (
            f"a family of shape {system.shape} is no single case; write system[index]"
        )
        raise refusal("system", message)
    system.check_file()
    described = system.to_dict()
    parts = [toml_table(f"schema = {SCHEMA}", {"gravity": described.get("gravity")})]
    for name, material in _materials(system).items():
        key = name if re.fullmatch("[A-Za-z0-9_-]+", name) else _toml(name)
        parts.append(
            toml_table(f"[materials.{key}]", material.to_dict() | {"name": None})
        )
    for body in described["bodies"]:
        parts.append(toml_table("[[bodies]]", body | {"segments": None}))
        parts += [
            toml_table("[[bodies.segments]]", piece)
            for piece in body.get("segments", ())
        ]
    parts += [toml_table("[[contacts]]", contact) for contact in described["contacts"]]
    parts += [
        toml_table(f"[ends.{side}]", end)
        for side, end in described.get("ends", {}).items()
    ]
    parts += [
        toml_table("[[gauges]]", gauge._asdict() | {"name": gauge.name or None})
        for gauge in case.gauges
    ]
    options = ("[solve]", case.solve), ("[output]", case.output)
    parts += [toml_table(header, given) for header, given in options if given]
    return "\n\n".join(parts) + "\n"


def _materials(system: System) -> dict[str, Material]:
    """All materials of the rods by their names."""
    named: dict[str, Material] = {}
    for i, body in enumerate(system.bodies):
        for segment in body.segments if isinstance(body, Rod) else ():
            material = segment.material
            if named.setdefault(material.name, material) != material:
                message = (
                    f"another material is called {shown(material.name)} too; rename one"
                )
                raise refusal(f"bodies.{i}.material", message)
    return named


def toml_table(header: str, entries: dict[str, Any]) -> str:
    """A table of a case file, of the entries that are not None."""
    kept = (
        f"{key} = {_toml(value)}" for key, value in entries.items() if value is not None
    )
    return "\n".join([header, *kept])


def _toml(value: Any) -> str:
    if hasattr(value, "tolist"):  # of NumPy
        value = value.tolist()
    if isinstance(value, str):  # a string of JSON is one of TOML, but for DEL
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if (
        isinstance(value, dict) and "youngs_modulus" in value
    ):  # a material, with a table of its own
        return _toml(value["name"])
    if isinstance(value, dict):
        return (
            "{"
            + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items())
            + "}"
        )
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return repr(value)
