"""Write a page with sliders to a file; any browser shows the page offline.

The page contains a solver for the collision, so its sliders work. This solver cannot
solve every case: damping, for example, is not possible. For such a case
`rodimpact animate` makes an animation.
"""

import argparse

from ..explorer.exploring import check_page_name, explore
from .arguments import Arguments
from .exit_status import DONE, CommandResult


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add arguments: a case, the page to write, and --force."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument(
        "-o", "--output", metavar="FILE.html", required=True, help="file of the page"
    )
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def run(args: Arguments) -> CommandResult:
    """Write the page; the result is its path and size.

    The size is in kB. InvalidModel is raised for a file that exists, without --force,
    or whose name does not end in .html, and for a case that the page cannot solve.
    """
    case = args.read_case()
    names = {"path": args.options["output"]}
    args.build_or_add_problems(check_page_name, args.output, names=names)
    args.check_outputs("output")
    page = explore(case)
    page.save(args.output, force=args.force)
    kilobytes = len(page.html.encode()) / 1000
    return CommandResult(f"{args.output}: {kilobytes:.0f} kB", DONE)
