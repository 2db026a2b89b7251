"""Compute the bearing graph of a pile: blows per metre of set against resistance.

rodimpact bearing CASE.toml --resistance 200kN:1000kN:5
rodimpact bearing CASE.toml --resistance "300 kN,500 kN" --shaft-share 0.3

The toe is the lower end of a pile, and the shaft is the side of a pile. The set is the
permanent displacement of the soil below the toe after one blow. The quake is the
displacement at which the soil yields.

The bodies of the case are a moving ram, masses such as a helmet on the head of the
pile, the pile, and a wall. The contact of the pile with the wall has the law
"smith-toe". The command splits each resistance between shaft and toe in the same ratio
as in the case; --shaft-share sets another ratio. Quakes and damping stay the same. For
each resistance the command computes one blow, until no soil can yield any more. The
command then computes the blow twice more, with fewer cells, to state errors.

The command removes the ram at the top of its bounce. A ram that is off the pile for
less than the time in which a wave runs down the pile and back is not removed, and
strikes again. If gravity acts, the pile is at rest before the blow.

All results are in SI units. The command ignores [solve] and [output] of the case. The
exit status is 3 if a blow is not over; the table gives the reason.
"""

import argparse
from typing import Any

from .. import bearing_graph
from ..piles.bearing_report import bearing_json, bearing_table
from ..piles.resting import CELLS
from ..storage.grids import grid_values
from .arguments import COUNT, Arguments, add_number, figure_writer
from .exit_status import DONE, INCOMPLETE, CommandResult
from .messages import as_options

EXAMPLE = "200kN:1000kN:5"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add arguments: the case, the resistances, how blows are solved, the outputs."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument(
        "--resistance",
        metavar="GRID",
        required=True,
        help="total ultimate resistances, shaft plus toe: start:stop:count, such as "
        f"{EXAMPLE}, or start:stop:count:log, or a list",
    )
    add_number(
        parser,
        "--shaft-share",
        "dimensionless",
        "fraction of the resistance that acts along the shaft; default: as in the case",
    )
    add_number(
        parser,
        "--cells",
        COUNT,
        f"number of cells in the rod with the longest transit time; default {CELLS}",
    )
    add_number(parser, "--until", "time", "end of each blow; default until it is over")
    add_number(
        parser, "--workers", COUNT, "number of threads; default: one for each processor"
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument(
        "--csv", action="store_true", help="print a row for each resistance"
    )
    form.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "--plot", metavar="FILE", help="draw the graph: .png, .svg or .pdf"
    )
    parser.add_argument("--force", action="store_true", help="replace existing files")


def run(args: Arguments) -> CommandResult:
    """Bearing graph of the pile: check all arguments, solve a blow for each resistance.

    The figure is written if it is asked for. The result is a table, CSV or JSON; its
    status is that of writing the figure, or INCOMPLETE if a blow did not come to its
    end. InvalidModel is raised for mistakes in the arguments, before any blow.
    """
    case = args.read_case()
    resistances = _resistances(args)
    args.check_outputs("plot", figure="plot")  # --plot, the only output, is a figure

    options: dict[str, Any] = {}
    if args.cells is not None:
        options["cells"] = args.cells
    names = {"resistances": "--resistance"}  # paths of mistakes, all of one option
    for i in range(len(resistances)):
        names[f"resistances[{i}]"] = "--resistance"
    with args.naming_mistakes(names=names):
        graph = bearing_graph(
            case.system,
            resistances,
            shaft_share=args.shaft_share,
            until=args.until,
            workers=args.workers,
            **options,
        )
    status = args.write(plot=figure_writer(lambda plot: plot.bearing(graph)))
    if status == DONE and not graph.is_over:
        status = INCOMPLETE
    if args.csv:
        return CommandResult(graph.csv_lines(), status)
    if args.json:
        return CommandResult(bearing_json(graph), status)
    # The table names arguments of Python: they become options.
    return CommandResult(as_options(bearing_table(graph)), status)


def _resistances(args: Arguments) -> Any:
    """Resistances, N; None, with a mistake added, if they cannot be read."""
    try:
        return grid_values(args.resistance, "force")
    except ValueError as error:
        args.problems.append(("--resistance", str(error)))
        return None
