"""Write a collision as a page to hand out: one file, for any browser, without a network.

The page has the solver inside, and its sliders work. What the page cannot solve by itself, such as
damping, is solved when it is written, and the page shows that.
"""

import argparse

from ..explorer.exploring import page_of
from . import DONE
from .asking import Given
from .progress import solved, status_of


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
    page = page_of(case, solved)
    page.save(given.output, force=given.force)
    shown = (
        "solves the collision itself"
        if page.solution is None
        else "shows a stored solution"
    )
    text = f"{given.output}: {len(page.html.encode()) / 1000:.0f} kB, {shown}"
    return text, DONE if page.solution is None else status_of(page.solution)
