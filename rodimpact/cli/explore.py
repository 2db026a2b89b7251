"""Play with a collision in the browser: sliders, space-time diagram, moving rods.

The page is written to a temporary file, whose path is printed. It solves collisions
itself. Without a case it begins with two rods of different length.
"""

import argparse

from ..explorer.exploring import explore
from ..explorer.presets import presets
from ..storage.casefile import Case, read_case
from .exit_status import DONE, CommandResult

DEFAULT_PRESET = "unequal"
"""Key of the preset with which the page begins without a case."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, and whether a browser opens it."""
    parser.add_argument(
        "case", metavar="CASE.toml", nargs="?", help="the case file to begin with"
    )
    parser.add_argument(
        "--no-browser", action="store_true", help="print the path, and open no browser"
    )


def run(args: argparse.Namespace) -> CommandResult:
    """Write the page and open it, unless --no-browser is given; print its path."""
    if args.case is None:
        case = _default_case()
    else:
        case = read_case(args.case)
    page = explore(case)
    return CommandResult(page.open(not args.no_browser), DONE)


def _default_case() -> Case:
    """The case of the default preset."""
    cases = {preset.key: preset.case for preset in presets()}
    return cases[DEFAULT_PRESET]
