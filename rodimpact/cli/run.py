"""Solve a case file and print what the collision did.

A number may have a unit: --until "2 ms". The names of files are relative to the current directory.
Exit status 3 if the run stopped before what was asked, at a cap on events or on time.
"""

from __future__ import annotations

import argparse
import json

from ..model import Rod
from ..model.frozen import InvalidModel
from ..results.gauges import gauges_to_csv, misnamed
from ..storage.casefile import Case, read_case
from ..storage.report import solution_dict, solution_table
from . import DONE, FAULT, INCOMPLETE, complain
from .asking import Problems, check_format, check_outputs, note, quantity
from .progress import solved
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
    case: Case | None = None
    try:
        case = read_case(arguments.case)
    except InvalidModel as error:
        problems += error.problems
    options = run_options(problems, arguments, case)
    places = _places(problems, arguments.gauge, case)
    if (arguments.gauges is None) != (not arguments.gauge):
        problems.append(("--gauges", "goes with --gauge NAME=BODY:X, one for each column"))
    files, paths = {}, {}  # by what they are for: name, and where the user gave it
    for key in ("save", "plot"):
        given = getattr(arguments, key)
        files[key] = case.output.get(key) if given is None and case else given
        paths[key] = f"output.{key}" if given is None else f"--{key}"
    files["gauges"], paths["gauges"] = arguments.gauges, "--gauges"
    if files["plot"] is not None:
        check_format(problems, paths["plot"], files["plot"])
    check_outputs(problems, {paths[key]: files[key] for key in files}, arguments.force)
    assert case is not None  # or there were problems

    solution = solved(case.system, **options)
    status = INCOMPLETE if solution.stopped_by in ("max_events", "clock") else DONE
    if files["save"] is not None:
        solution.save(files["save"], force=arguments.force)
        note(f"wrote {files['save']}")
    if files["plot"] is not None:
        from .. import plot

        try:
            picture = plot.overview(solution)
        except ValueError as error:  # the table tells why
            status = complain(f"{paths['plot']}: {error}", FAULT)
        else:
            plot.save(picture, files["plot"], force=arguments.force)
            note(f"wrote {files['plot']}")
    if files["gauges"] is not None:
        gauges = {name: solution.gauge(*place) for name, place in places.items()}
        gauges_to_csv(files["gauges"], gauges, force=arguments.force)
        note(f"wrote {files['gauges']}")
    text = (
        json.dumps(solution_dict(solution), indent=2, allow_nan=False)
        if arguments.json else solution_table(solution)
    )
    return text, status


def _places(
    problems: Problems, given: list[str], case: Case | None
) -> dict[str, tuple[int, float]]:
    """Bodies and places of gauges by name."""
    found: dict[str, tuple[int, float]] = {}
    bodies = case.system.bodies if case else ()
    for text in given:
        name, _, place = text.partition("=")
        number, _, x = place.partition(":")
        if not name or not number.strip().isdecimal() or not x or name in found:
            message = f"must be NAME=BODY:X, such as incident=1:0.5, each name once, got {text!r}"
            problems.append(("--gauge", message))
            continue
        if sentence := misnamed(name):
            problems.append(("--gauge", sentence))
        found[name] = int(number), quantity(problems, f"--gauge {name}", x, "length")
        body = bodies[int(number)] if int(number) < len(bodies) else None
        if case and not isinstance(body, Rod):
            rods = [str(i) for i, b in enumerate(bodies) if isinstance(b, Rod)]
            message = f"body {number} is no rod; the rods are {', '.join(rods)}"
            problems.append((f"--gauge {name}", message))
        elif isinstance(body, Rod) and not 0 <= found[name][1] <= float(body.length):
            message = f"must lie in body {number}, 0 to {float(body.length)!r} m, got {x!r}"
            problems.append((f"--gauge {name}", message))
    return found
