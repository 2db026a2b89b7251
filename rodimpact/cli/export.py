"""Write a collision as a page to hand out: one file, for any browser, without a network.

The page has the solver inside, and its sliders work. It cannot solve everything: for a collision
with damping, say, `rodimpact animate` makes a moving picture.
"""

import argparse

from ..explorer.exploring import explore
from . import DONE
from .asking import Given


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, and the page to write."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument(
        "-o", "--output", metavar="FILE.html", required=True, help="the page"
    )
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def run(given: Given) -> tuple[str, int]:
    """Write the page."""
    case = given.read_case()
    given.check_outputs("output")
    page = explore(case)
    page.save(given.output, force=given.force)
    return f"{given.output}: {len(page.html.encode()) / 1000:.0f} kB", DONE
