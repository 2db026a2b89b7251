"""Solve a case file and print the outcome.

A number may have a unit: --until "2 ms". File names are relative to the current
directory. The exit status is 3 if the run stopped early: at --max-events, or at the
largest time that the method can represent. A run that ends at --until is complete.
"""

import argparse
from dataclasses import replace
from typing import Any

from .. import Case, Gauge, Solution, gauges_to_csv, solve
from ..results.regions import nothing_to_draw
from ..results.saved import case_of, difference
from ..storage.case_writing import check_case_name, write_case
from ..storage.report import solution_json, solution_table
from ..storage.tables import misnamed
from .arguments import Arguments, add_number, add_run_options, figure_writer, status_of
from .exit_status import DONE, CommandResult
from .gauge_options import (
    GAUGE_FORM,
    GaugePositions,
    add_gauge_option,
    gauge_positions,
)
from .messages import complain


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add arguments: the case, the outputs, the gauges, options of the run."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "--save", metavar="FILE.toml", help="save the case with its outcome"
    )
    parser.add_argument(
        "--plot", metavar="FILE", help="draw the result: .png, .svg or .pdf"
    )
    parser.add_argument(
        "--gauges",
        metavar="FILE.csv",
        help="write a table of the strains of all gauges over time",
    )
    add_number(
        parser,
        "--interval",
        "time",
        "time between the rows of --gauges; default: 1/10000 of the run",
    )
    add_gauge_option(parser, "a gauge, for --gauges and --plot")
    add_run_options(parser)
    parser.add_argument("--force", action="store_true", help="replace existing files")


def run(args: Arguments) -> CommandResult:
    """Check all arguments, solve, write the files; table or JSON.

    A saved case that is solved with its own options is compared with its stored
    outcome. The status is INCOMPLETE if the run stopped early, else that of writing the
    files. InvalidModel is raised for mistakes in the arguments, before the case is
    solved.
    """
    case = args.read_case()
    options = args.run_options(case)
    positions = gauge_positions(args, case)
    _check_gauges(args, positions)
    if case is not None:
        _take_outputs_of_case(args, case)
    if args.gauge and args.plot is None and args.gauges is None:
        message = "goes with --gauges or --plot, which show its record"
        args.problems.append(("--gauge", message))
    if args.save is not None:
        names = {"path": args.options["save"]}
        args.build_or_add_problems(check_case_name, args.save, names=names)
    args.check_outputs("save", "plot", "gauges", figure="plot")

    with args.naming_mistakes():
        solution = solve(case.system, **options)
    if options == case.solve:  # no option of the call replaces one of the case
        _compare_with_saved(case, solution)
    writing_status = _write(args, case, solution, positions)
    status = status_of(solution)
    # A run that stopped early is also the reason why a file could not be written, so
    # its status comes first.
    if status == DONE:
        status = writing_status
    if args.json:
        text = solution_json(solution)
    else:
        text = solution_table(solution)
    return CommandResult(args.name_entries(text), status)


def _check_gauges(args: Arguments, positions: GaugePositions) -> None:
    """Add problems of the table of strains, --gauges, and of the names in it.

    They are --interval without --gauges, --gauges without any gauge, and names that do
    not fit a table. Names of the case are checked only if a table is written.
    """
    if args.interval is not None and args.gauges is None:
        args.problems.append(("--interval", "goes with --gauges, whose rows it spaces"))
    gauges_table = args.gauges  # path of the table of strains, or None
    if args.gauge or gauges_table:
        path = "gauges"  # the table of the case
        if args.gauge:
            path = "--gauge"
        for name in positions:
            sentence = misnamed(name)
            if sentence:
                args.problems.append((path, sentence))
    if gauges_table is not None and not positions:
        message = (
            f"goes with --gauge {GAUGE_FORM}, one for each column, or [[gauges]] of "
            "the case"
        )
        args.problems.append(("--gauges", message))


def _take_outputs_of_case(args: Arguments, case: Case) -> None:
    """Set the arguments of output files to those of the case, unless the call has them.

    In `args.options` they get the names of their entries.
    """
    for name, path in case.output.items():
        if getattr(args, name) is None:
            setattr(args, name, path)
            args.options[name] = f"output.{name}"


def _compare_with_saved(case: Case, solution: Solution) -> None:
    """Print a message if the outcome differs from that stored in the case file.

    A case without a stored outcome is not compared.
    """
    if case.result is None:
        return
    sentence = difference(case.result, solution)
    if sentence:
        complain(f"{case.path}: {sentence}", DONE)


def _write(
    args: Arguments, case: Case, solution: Solution, positions: GaugePositions
) -> int:
    """Write the case, the figure and the strains, if asked for; return the status.

    The status is that of `Arguments.write`.
    """

    def save(path: str, force: bool) -> None:
        """Write the case as it was solved, with its outcome and gauges."""
        saved = replace(case_of(solution), gauges=case.gauges)
        write_case(path, saved, force=force)

    def draw(plot: Any) -> Any:
        """Draw the figure of the run."""
        return plot.overview(solution, _gauges(solution, positions))

    def write_gauges(path: str, force: bool) -> None:
        """Write the table of strains."""
        gauges = _gauges(solution, positions)
        gauges_to_csv(path, gauges, interval=args.interval, force=force)

    return args.write(save=save, plot=figure_writer(draw), gauges=write_gauges)


def _gauges(solution: Solution, positions: GaugePositions) -> dict[str, Gauge]:
    """Gauges by name; ValueError if the run lasted no time.

    They are gauges of the solution at `positions`.
    """
    reason = nothing_to_draw(solution)
    if reason:
        raise ValueError(reason)
    gauges = {}
    for name, position in positions.items():
        gauges[name] = solution.gauge(position.body, position.x)
    return gauges
