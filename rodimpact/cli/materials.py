"""List the materials that rodimpact knows, with the source of each number."""

import argparse

from ..materials import SOURCES, TABLE
from ..storage.tables import align, as_json
from ..units import format_si
from . import DONE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Only the form of the answer."""
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(given: argparse.Namespace) -> tuple[str, int]:
    """Table or JSON of the materials."""
    if given.json:
        entries = [
            {
                **material.to_dict(),
                "wave_speed": material.wave_speed,
                "source": SOURCES[name],
            }
            for name, material in TABLE.items()
        ]
        return as_json(materials=entries), DONE
    rows = [["material", "Young's modulus", "density", "bar speed", "Poisson ratio"]]
    for name, m in TABLE.items():
        nu = "-" if m.poisson_ratio is None else f"{m.poisson_ratio:g}"
        rows.append(
            [
                name,
                format_si(float(m.youngs_modulus), "Pa"),
                format_si(float(m.density), "kg/m^3"),
                f"{float(m.wave_speed):.0f} m/s",
                nu,
            ]
        )
    sources = "\n".join(f"{name}: {source}" for name, source in SOURCES.items())
    return f"{align(rows)}\n\nSources\n{sources}", DONE
