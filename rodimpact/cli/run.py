"""Solve a case file and print what the collision did.

A number may have a unit: --until "2 ms". The names of files are relative to the current directory.
Exit status 3 if the run stopped before what was asked, at a cap on events or on time.
"""

from __future__ import annotations

import argparse
import json
from typing import Any

from ..casefile import Case, read_case
from ..frozen import InvalidModel
from ..report import solution_dict, solution_table
from ..solving import solve
from . import DONE, INCOMPLETE
from .asking import Problems, check_format, check_outputs, note, quantity, whole_number


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, what to write, how far to go."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--save", metavar="FILE.npz", help="save the solution")
    parser.add_argument("--plot", metavar="FILE", help="draw it: .png, .svg or .pdf")
    parser.add_argument("--until", metavar="TIME", help="end of the run, instead of the case's")
    parser.add_argument("--max-events", metavar="N", help="cap on events, instead of the case's")
    parser.add_argument("--force", action="store_true", help="replace existing files")


def run(arguments: argparse.Namespace) -> tuple[str, int]:
    """Check everything, solve, write the files, and hand back the table or JSON."""
    problems: Problems = []
    options: dict[str, Any] = {}
    if arguments.until is not None:
        options["until"] = quantity(problems, "--until", arguments.until, "time")
    if arguments.max_events is not None:
        options["max_events"] = whole_number(problems, "--max-events", arguments.max_events)
    case: Case | None = None
    try:
        case = read_case(arguments.case)
    except InvalidModel as error:
        problems += error.problems
    files, paths = {}, {}  # by what they are for: name, and where the user gave it
    for key in ("save", "plot"):
        given = getattr(arguments, key)
        files[key] = case.output.get(key) if given is None and case else given
        paths[key] = f"output.{key}" if given is None else f"--{key}"
    if files["plot"] is not None:
        check_format(problems, paths["plot"], files["plot"])
    check_outputs(problems, {paths[key]: files[key] for key in files}, arguments.force)
    assert case is not None  # or there were problems

    solution = solve(case.system, **{**case.solve, **options})
    if files["save"] is not None:
        solution.save(files["save"], force=arguments.force)
        note(f"wrote {files['save']}")
    if files["plot"] is not None:
        from .. import plot

        plot.save(plot.overview(solution), files["plot"], force=arguments.force)
        note(f"wrote {files['plot']}")
    text = (
        json.dumps(solution_dict(solution), indent=2, allow_nan=False)
        if arguments.json else solution_table(solution)
    )
    return text, INCOMPLETE if solution.stopped_by in ("max_events", "clock") else DONE
