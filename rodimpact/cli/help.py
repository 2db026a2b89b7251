"""Show where to find help; `rodimpact help units` lists the units of numbers."""

import argparse

from ..storage.tables import align
from ..units import UNITS, si_unit
from .exit_status import DONE, CommandResult

TOPICS = """\
rodimpact help units  Every unit that a number may have.
rodimpact --help      All commands.
docs/input.md         Every table and key of a case file (a page of the manual)."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the topic, which may be left out."""
    parser.add_argument(
        "topic", nargs="?", type=_topic, help="units: list all known units"
    )


def _topic(word: str) -> str:
    """The word itself if there is a text of this name; else a mistake in the call.

    The only text is "units".
    """
    if word == "materials":
        raise argparse.ArgumentTypeError("`rodimpact materials` lists them")
    if word != "units":
        raise argparse.ArgumentTypeError(
            f"there is no text on {word!r}; `rodimpact help` lists all texts, and "
            "`rodimpact COMMAND --help` explains a command"
        )
    return word


def run(args: argparse.Namespace) -> CommandResult:
    """The text on the topic, or the topics."""
    if args.topic is None:
        return CommandResult(TOPICS, DONE)
    return CommandResult(table_of_units(), DONE)


def table_of_units() -> str:
    """Table of every unit that a number in a text may have, by quantity.

    A row has the quantity, its SI unit, or "1" for a pure number, and its other units.
    """
    rows = [("quantity", "SI", "also")]
    for quantity, units in UNITS.items():
        si = si_unit(quantity)
        other_units = [unit for unit in units if unit != si]
        if si == "":
            si = "1"
        rows.append((quantity, si, ", ".join(other_units)))
    return align(rows, left=(0, 1, 2)) + "\n\nA bare number is in SI units."
