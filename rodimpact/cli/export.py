"""Write a collision as a page to hand out: one file, for any browser, offline.

The page contains the solver, so its sliders work. It cannot solve everything. For a
collision with damping, for example, `rodimpact animate` makes a moving picture.
"""

import argparse

from ..explorer.exploring import check_page_name, explore
from .arguments import Arguments
from .exit_status import DONE, CommandResult


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, and the page to write."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument(
        "-o", "--output", metavar="FILE.html", required=True, help="the page"
    )
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def run(args: Arguments) -> CommandResult:
    """Write the page; the result is its path and size."""
    case = args.read_case()
    names = {"path": args.options["output"]}
    args.build_or_add_problems(check_page_name, args.output, names=names)
    args.check_outputs("output")
    page = explore(case)
    page.save(args.output, force=args.force)
    kilobytes = len(page.html.encode()) / 1000
    return CommandResult(f"{args.output}: {kilobytes:.0f} kB", DONE)
