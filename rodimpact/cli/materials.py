"""List the materials that rodimpact knows, with the source of each number."""

import argparse

from ..materials import SOURCES, TABLE
from ..storage.tables import align, versioned_json
from ..units import format_si
from .exit_status import DONE, CommandResult


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The form of the answer."""
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(args: argparse.Namespace) -> CommandResult:
    """Table or JSON of the materials."""
    if args.json:
        return CommandResult(_json(), DONE)
    return CommandResult(f"{_table()}\n\n{_sources()}", DONE)


def _json() -> str:
    """JSON of all materials, with wave speeds and sources."""
    entries = []
    for name, material in TABLE.items():
        entry = dict(material.to_dict())
        entry["wave_speed"] = material.wave_speed
        entry["source"] = SOURCES[name]
        entries.append(entry)
    return versioned_json(materials=entries)


def _table() -> str:
    """Table of all materials."""
    rows = [["material", "Young's modulus", "density", "bar speed", "Poisson ratio"]]
    for name, material in TABLE.items():
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


def _sources() -> str:
    """Lines with the source of each material."""
    lines = ["Sources"]
    for name, source in SOURCES.items():
        lines.append(f"{name}: {source}")
    return "\n".join(lines)
