"""List the units that a number may have; `rodimpact --help` lists the commands."""

import argparse

from ..storage.tables import align
from ..units import UNITS, si_unit
from . import DONE

TOPICS = """\
rodimpact help units  Every unit that a number may have.
rodimpact --help      All commands.
docs/input.md         Every table and key of a case file (a page of the manual)."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What to tell."""
    parser.add_argument(
        "topic", nargs="?", choices=("units",), help="units: every known unit"
    )


def run(given: argparse.Namespace) -> tuple[str, int]:
    """The text on this topic."""
    text = units() if given.topic else TOPICS
    return text, DONE


def units() -> str:
    """Every unit that a number in a text may have."""
    rows = [("quantity", "SI", "also")]
    for quantity, known in UNITS.items():
        si = si_unit(quantity)
        others = [unit for unit in known if unit != si]
        rows.append((quantity, si or "1", ", ".join(others)))
    return align(rows, left=(0, 1, 2)) + "\n\nA bare number is in SI units."
