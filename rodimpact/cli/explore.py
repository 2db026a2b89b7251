"""Open a page in the browser: sliders, moving rods, space-time diagram.

The page solves a collision again whenever a slider moves. Without a case, the page
begins with two rods of different length. The command writes the page to a temporary
file and prints the path of this file.
"""

import argparse

from ..explorer.exploring import explore
from ..explorer.presets import presets
from ..storage.casefile import Case, read_case
from .exit_status import DONE, CommandResult

DEFAULT_PRESET = "unequal"
"""Key of the preset with which the page begins without a case."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add arguments: a case, which may be left out, and --no-browser."""
    parser.add_argument(
        "case",
        metavar="CASE.toml",
        nargs="?",
        help="case file with which the page begins",
    )
    parser.add_argument(
        "--no-browser",
        action="store_true",
        help="print the path, but do not open a browser",
    )


def run(args: argparse.Namespace) -> CommandResult:
    """Write the page to a temporary file, and print the path of this file.

    The page shows the case of the file `case`, or that of the default preset if no file
    is given. A browser opens it, unless --no-browser is given.
    """
    if args.case is None:
        case = _default_case()
    else:
        case = read_case(args.case)
    page = explore(case)
    path = page.open(browser=not args.no_browser)
    return CommandResult(path, DONE)


def _default_case() -> Case:
    """The case of the default preset."""
    cases = {preset.key: preset.case for preset in presets()}
    return cases[DEFAULT_PRESET]
