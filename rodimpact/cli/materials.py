"""List the materials that rodimpact knows, with the source of each number."""

import argparse

from ..hints import nearest
from ..materials import SOURCES, TABLE
from ..model.frozen import invalid_argument
from ..storage.tables import align, versioned_json
from ..units import format_si, shown
from .exit_status import DONE, CommandResult


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add arguments: names of materials, by default all, and --json."""
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help="materials to list; default: all"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(args: argparse.Namespace) -> CommandResult:
    """Table or JSON of all materials, or of those that are named.

    The sources follow the table. InvalidModel is raised for a name that is no material.
    """
    names = list(TABLE)
    if args.names:
        names = args.names
    for name in names:
        if name not in TABLE:
            message = f"there is no material {shown(name)}; {nearest(name, TABLE)}"
            raise invalid_argument("NAME", message)
    if args.json:
        return CommandResult(_json(names), DONE)
    return CommandResult(f"{_table(names)}\n\n{_sources(names)}", DONE)


def _json(names: list[str]) -> str:
    """JSON of materials: their tables, with wave speeds, m/s, and sources."""
    entries = []
    for name in names:
        material = TABLE[name]
        entry = dict(material.to_dict())
        entry["wave_speed"] = material.wave_speed
        entry["source"] = SOURCES[name]
        entries.append(entry)
    return versioned_json(materials=entries)


def _table(names: list[str]) -> str:
    """Table of materials: modulus, density, bar speed and Poisson's ratio, with units.

    An unknown Poisson's ratio is "-".
    """
    rows = [["material", "Young's modulus", "density", "bar speed", "Poisson ratio"]]
    for name in names:
        material = TABLE[name]
        poisson_ratio = "-"
        if material.poisson_ratio is not None:
            poisson_ratio = f"{material.poisson_ratio:g}"
        rows.append(
            [
                name,
                format_si(float(material.youngs_modulus), "Pa"),
                format_si(float(material.density), "kg/m^3"),
                f"{float(material.wave_speed):.0f} m/s",
                poisson_ratio,
            ]
        )
    return align(rows)


def _sources(names: list[str]) -> str:
    """Lines with the source of each material.

    They come below the heading "Sources".
    """
    lines = ["Sources"]
    for name in names:
        lines.append(f"{name}: {SOURCES[name]}")
    return "\n".join(lines)
