"""Solve a case file and print what the collision did.

A number may have a unit: --until "2 ms". The names of files are relative to the current directory.
Exit status 3 if the run stopped before what was asked, at a cap on events or on time.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from functools import partial

from ..model import Rod
from ..model.frozen import Problems
from ..results.gauges import gauges_to_csv
from ..results.regions import nothing_to_draw
from ..results.solution import Solution
from ..storage.casefile import Case, read_case
from ..storage.report import solution_dict, solution_table
from ..storage.tables import misnamed
from .asking import attempt, check_format, check_outputs, quantity, write
from .progress import solved, status_of
from .run_options import NUMBERS, add_run_options, run_options


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, what to write, how far to go."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--save", metavar="FILE.npz", help="save the solution")
    parser.add_argument("--plot", metavar="FILE", help="draw it: .png, .svg or .pdf")
    parser.add_argument("--gauges", metavar="FILE.csv",
                        help="write strains against time, as tools for Hopkinson bars read them")
    parser.add_argument("--gauge", metavar="NAME=BODY:X", action="append", default=[],
                        help="a column of --gauges: incident=1:0.5 is 0.5 m into body 1")
    add_run_options(parser, tuple(NUMBERS))
    parser.add_argument("--force", action="store_true", help="replace existing files")


def run(arguments: argparse.Namespace) -> tuple[str, int]:
    """Check everything, solve, write the files, and hand back the table or JSON."""
    problems: Problems = []
    case = attempt(problems, read_case, arguments.case)
    options = run_options(problems, arguments, case)
    places = _places(problems, arguments.gauge, case)
    if (arguments.gauges is None) != (not arguments.gauge):
        problems.append(("--gauges", "goes with --gauge NAME=BODY:X, one for each column"))
    names = ("save", "plot", "gauges")
    files = {name: (f"--{name}", getattr(arguments, name)) for name in names}  # where given: path
    for name, path in (case.output if case else {}).items():
        if files[name][1] is None:
            files[name] = f"output.{name}", path
    if files["plot"][1] is not None:
        check_format(problems, *files["plot"])
    check_outputs(problems, dict(files.values()), arguments.force)
    assert case is not None  # or there were problems

    solution = solved(case.system, **options)
    status = status_of(solution)
    writers: dict[str, Callable[..., None]] = {
        "save": solution.save, "plot": partial(_draw, solution, places),
        "gauges": partial(_record, solution, places),
    }
    for name, (where, path) in files.items():
        if path is not None:
            status = write(where, path, partial(writers[name], force=arguments.force)) or status
    text = (
        json.dumps(solution_dict(solution), indent=2, allow_nan=False)
        if arguments.json else solution_table(solution)
    )
    return text, status


def _draw(
    solution: Solution, places: dict[str, tuple[int, float]], path: str, force: bool
) -> None:
    """Draw a run with its gauges; ValueError if there is nothing to draw."""
    from .. import plot

    _check_time(solution)
    plot.save(plot.overview(solution, list(places.values())), path, force=force)


def _record(
    solution: Solution, places: dict[str, tuple[int, float]], path: str, force: bool
) -> None:
    """Write what gauges show of a run; ValueError if that is nothing."""
    _check_time(solution)
    gauges = {name: solution.gauge(*place) for name, place in places.items()}
    gauges_to_csv(path, gauges, force=force)


def _check_time(solution: Solution) -> None:
    if reason := nothing_to_draw(solution):
        raise ValueError(reason)


def _places(
    problems: Problems, given: list[str], case: Case | None
) -> dict[str, tuple[int, float]]:
    """Bodies and places of gauges by name."""
    places: dict[str, tuple[int, float]] = {}
    bodies = case.system.bodies if case else ()
    for text in given:
        name, _, place = text.partition("=")
        number, _, x = place.partition(":")
        if not name or not number.strip().isdecimal() or not x or name in places:
            message = f"must be NAME=BODY:X, such as incident=1:0.5, each name once, got {text!r}"
            problems.append(("--gauge", message))
            continue
        if sentence := misnamed(name):
            problems.append(("--gauge", sentence))
        option = f"--gauge {name}"
        places[name] = body, at = int(number), quantity(problems, option, x, "length")
        rods = {i: float(b.length) for i, b in enumerate(bodies) if isinstance(b, Rod)}
        if case and body not in rods:
            message = f"body {number} is no rod; the rods are {', '.join(map(str, rods))}"
            problems.append((option, message))
        elif case and not 0 <= at <= rods[body]:
            message = f"must lie in body {number}, 0 to {rods[body]!r} m, got {x!r}"
            problems.append((option, message))
    return places
