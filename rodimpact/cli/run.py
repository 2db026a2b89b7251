"""Solve a case file and print what the collision did.

A number may have a unit: --until "2 ms". The names of files are relative to the current directory.
Exit status 3 if the run stopped before what was asked, at a cap on events or on time.
"""

import argparse
from dataclasses import replace

from .. import Case, Gauge, Solution, gauges_to_csv, solve
from ..results.regions import nothing_to_draw
from ..results.saved import case_of, difference
from ..storage.case_writing import check_case_name, save_case
from ..storage.report import solution_json, solution_table
from ..storage.tables import misnamed
from . import DONE, complain
from .asking import Given, add_run_options, drawn, status_of
from .options import as_options
from .record_options import FORM, Places, add_gauge_option, gauge_places


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, what to write, how far to go."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "--save", metavar="FILE.toml", help="save the case with its outcome"
    )
    parser.add_argument("--plot", metavar="FILE", help="draw it: .png, .svg or .pdf")
    parser.add_argument(
        "--gauges",
        metavar="FILE.csv",
        help="write strains against time, as tools for Hopkinson bars read them",
    )
    add_gauge_option(parser, "a column of --gauges and a station in --plot")
    add_run_options(parser)
    parser.add_argument("--force", action="store_true", help="replace existing files")


def run(given: Given) -> tuple[str, int]:
    """Check everything, solve, write the files, and hand back the table or JSON."""
    case = given.read_case()
    options = given.run_options(case)
    places = gauge_places(given, case)
    if given.gauge or given.gauges:
        given.problems += [
            ("--gauge" if given.gauge else "gauges", sentence)
            for name in places
            if (sentence := misnamed(name))
        ]
    if given.gauges is not None and not places:
        message = (
            f"goes with --gauge {FORM}, one for each column, or [[gauges]] of the case"
        )
        given.problems.append(("--gauges", message))
    for name, path in case.output.items() if case else ():
        if getattr(given, name) is None:
            setattr(given, name, path)
            given.options[name] = f"output.{name}"
    if given.gauge and given.plot is given.gauges is None:
        given.problems.append(
            ("--gauge", "goes with --gauges or --plot, which show its record")
        )
    if given.save is not None:
        names = {"path": given.options["save"]}
        given.attempt(check_case_name, given.save, names=names)
    given.check_outputs("save", "plot", "gauges", figure="plot")
    solution = solve(case.system, **options)
    if options == case.solve:
        _compare(case, solution)
    wrote = given.write(
        save=lambda path, force: _save(path, case, solution, force),
        plot=drawn(lambda plot: plot.overview(solution, _gauges(solution, places))),
        gauges=lambda path, force: gauges_to_csv(
            path, _gauges(solution, places), force=force
        ),
    )
    status = (
        status_of(solution) or wrote
    )  # a run that stopped early also tells why a file lacks
    tell = solution_json if given.json else solution_table
    return as_options(tell(solution)), status


def _compare(case: Case, solution: Solution) -> None:
    """Say where the outcome differs from the one that a saved case stores."""
    if case.result is None:
        return
    if sentence := difference(case.result, solution):
        complain(f"{case.path}: {sentence}", DONE)


def _save(path: str, case: Case, solution: Solution, force: bool) -> None:
    """Write the case with its outcome, and with its gauges."""
    saved = replace(case_of(solution), gauges=case.gauges)
    save_case(path, saved, force=force)


def _gauges(solution: Solution, places: Places) -> dict[str, Gauge]:
    """Records by name; ValueError if the run lasted no time."""
    if reason := nothing_to_draw(solution):
        raise ValueError(reason)
    return {name: solution.gauge(*place) for name, place in places.items()}
