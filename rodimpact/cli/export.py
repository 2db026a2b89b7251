"""Write a collision as a page to hand out: one file, for any browser, without a network.

The page plays the collision, and shows its values wherever one points. With --live it has the
solver inside, for fronts, and its sliders work.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from ..explore.design import Design
from ..explore.page_files import standalone
from ..explore.scene import scene
from ..explore.start import start
from ..model.frozen import InvalidModel, Problems
from ..storage.writing import write_text
from ..units import format_si
from .asking import attempt, check_outputs
from .progress import solved, status_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, and the page to write."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument("-o", "--output", metavar="FILE.html", required=True, help="the page")
    parser.add_argument("--live", action="store_true", help="with sliders, solved by the page")
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def run(arguments: argparse.Namespace) -> tuple[str, int]:
    """Solve, and write the page."""
    problems: Problems = []
    design = attempt(problems, Design.read, arguments.case)
    check_outputs(problems, {"--output": arguments.output}, arguments.force)
    assert design is not None  # or there were problems

    solution = solved(design.case.system, **design.case.solve)
    if arguments.live:
        if solution.method != "fronts":
            message = "cannot be solved by a page, which follows fronts only; leave out --live"
            raise InvalidModel([("--live", f"{message}, or use rodimpact explore")])
        embedded = {"start": start(design)}
    else:
        shown = scene(design, solution, as_asked=True)
        embedded = {"scene": shown, "design": design.to_dict()}
    title = os.fsencode(Path(arguments.case).stem).decode(errors="replace")
    page = standalone(embedded, title)
    write_text(arguments.output, page, force=arguments.force)
    size = f"{len(page.encode()) / 1000:.0f} kB"
    text = f"{arguments.output}: {size}, {format_si(solution.t_end, 's', 4)} of the collision"
    return text, status_of(solution)
