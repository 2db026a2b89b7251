"""Play with a collision in the browser: sliders, the space-time diagram, the rods moving.

The page is written to a temporary file, whose path is printed, and solves by itself. Without a case
it begins with two rods of different length.
"""

import argparse

from ..explorer.exploring import explore
from ..explorer.presets import presets
from ..storage.casefile import read_case
from . import DONE

FIRST = "unequal"  # of the presets, where no case is given


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, and whether a browser opens it."""
    parser.add_argument(
        "case", metavar="CASE.toml", nargs="?", help="the case file to begin with"
    )
    parser.add_argument(
        "--no-browser", action="store_true", help="print the path, open nothing"
    )


def run(given: argparse.Namespace) -> tuple[str, int]:
    """Write the page and open it."""
    first = (preset.case for preset in presets() if preset.key == FIRST)
    case = next(first) if given.case is None else read_case(given.case)
    return explore(case).open(not given.no_browser), DONE
