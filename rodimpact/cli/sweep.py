"""Solve a family of collisions, in which one or more numbers of a case vary.

rodimpact sweep CASE.toml --vary bodies.0.length=0.05:1:200
    --vary "contacts.0.gap=0,1 um,10 um"

A grid is start:stop:count, or start:stop:count:log for equal ratios, or a list. A
number may have a unit. Each --vary with a grid adds an axis to the family.

--vary PATH=0.5*OTHER adds no axis. The number at PATH is then 0.5 times the number
OTHER. Another --vary must give the values of OTHER. OTHER is a path, or a name of your
own such as R. A divisor may follow OTHER. Units must agree: if R is a force,
0.5*R/2.5mm is a stiffness.
    --vary R=200kN:1000kN:5 --vary "contacts.1.yield_force=0.5*R"
    --vary "contacts.1.stiffness=0.5*R/2.5mm"

Options of this command override the entries of [solve] in the case. If neither the
command nor the case gives an end, the solver follows each collision until it has proved
that the collision is over. The command ignores [output] of the case. The exit status is
3 if some collisions stopped early; the status of each collision gives the reason.
"""

import argparse

from .. import Case, sweep
from ..methods.abilities import has_external_drive
from ..methods.run import ALSO
from ..model.paths import suggestion
from ..running.columns import layout_of
from ..running.readings import RequestedReadings
from ..running.sweep_report import sweep_json, sweep_table
from ..running.sweep_result import check_family_name
from ..units import shown
from .arguments import COUNT, Arguments, add_number, add_run_options, figure_writer
from .exit_status import INCOMPLETE, CommandResult

EXAMPLE = "bodies.0.length=0.05:1:200"
OUTPUT_HINT = "--csv prints all, --save keeps them"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add arguments: the case, what varies, options of the runs, the outputs."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument(
        "--vary",
        metavar="PATH=GRID",
        action="append",
        default=[],
        help=f"path of a number and its values, such as {EXAMPLE}; or "
        "PATH=FACTOR*OTHER/DIVISOR, with or without FACTOR and DIVISOR; --vary may be "
        "given several times",
    )
    add_number(
        parser, "--workers", COUNT, "number of threads; default: one for each processor"
    )
    parser.add_argument(
        "--checkpoint",
        metavar="DIR",
        help="store finished parts in this folder, or continue from stored parts",
    )
    parser.add_argument(
        "--also",
        metavar="NAME",
        action="append",
        default=[],
        choices=ALSO,
        help="compute a further result, which takes longer: dissipated (energy lost in "
        "contacts), set (permanent set of yielding contacts, such as the set of a "
        "pile), largest_stress (in each rod), displacement (of each body, at the "
        "end --until) or accuracy (the stated error); --also may be given several "
        "times",
    )
    add_run_options(parser, ("until", "max_events", "dt", "rtol", "cells"))
    form = parser.add_mutually_exclusive_group()
    form.add_argument(
        "--csv", action="store_true", help="print a row for each collision"
    )
    form.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--save", metavar="FILE.npz", help="save the result")
    parser.add_argument(
        "--plot", metavar="FILE", help="draw the result: .png, .svg or .pdf"
    )
    parser.add_argument(
        "--quantity",
        metavar="NAME",
        default="restitution",
        help="quantity that --plot shows: restitution (default), or another column of "
        "--csv, such as duration.0 of contact 0 or velocity_after.1 of body 1; bodies "
        "and contacts are numbered from 0, and walls count as bodies",
    )
    parser.add_argument("--force", action="store_true", help="replace existing files")


def run(args: Arguments) -> CommandResult:
    """Check all arguments, solve the family, write the files; table, CSV or JSON.

    The status is INCOMPLETE if a collision stopped early, else that of writing the
    files. InvalidModel is raised for mistakes in the arguments, before any run.
    """
    case = args.read_case(_grids(args))
    if case is not None:
        _check_case(args, case)
        if args.plot is not None:
            _check_figure(args, case)
    options = args.run_options(case)
    if args.save is not None:
        names = {"path": args.options["save"]}
        args.build_or_add_problems(check_family_name, args.save, names=names)
    args.check_outputs("save", "plot", figure="plot")

    with args.naming_mistakes():
        result = sweep(
            case.system,
            checkpoint=args.checkpoint,
            also=args.also,
            workers=args.workers,
            **options,
        )
    # A figure of a quantity that no collision has is refused when it is written; the
    # table says why.
    quantity = args.quantity
    draw = figure_writer(
        lambda plot: plot.sweep(result, quantity=quantity, varied=case.varied)
    )
    status = args.write(save=result.save, plot=draw)
    if result.incomplete.any():
        status = INCOMPLETE
    if args.csv:
        return CommandResult(result.csv_lines(), status)
    if args.json:
        return CommandResult(sweep_json(result, case.varied), status)
    table = sweep_table(result, case.varied, OUTPUT_HINT)
    return CommandResult(args.name_entries(table), status)


def _grids(args: Arguments) -> dict[str, str]:
    """Grids of the numbers that vary, as texts by path.

    Problems are added: no --vary, one that is not PATH=GRID, and a path given twice.
    """
    grids: dict[str, str] = {}
    if not args.vary:
        message = f"name what to vary: --vary {EXAMPLE}"
        args.problems.append(("--vary", message))
    for item in args.vary:
        path, _, grid = item.rpartition("=")
        path = path.strip()
        if not path:
            message = f"must be PATH=GRID, such as {EXAMPLE}, got {shown(item)}"
            args.problems.append(("--vary", message))
        elif path in grids:
            message = "is varied twice; write one list or one range"
            args.problems.append((path, message))
        else:
            grids[path] = grid.strip()
    return grids


def _check_case(args: Arguments, case: Case) -> None:
    """Add a problem for an entry that only a single run takes."""
    if "snapshots" in case.solve:
        message = "a sweep keeps no states; take snapshots out of the case"
        args.add_problem("solve.snapshots", message)


def _check_figure(args: Arguments, case: Case) -> None:
    """Add problems of a figure that cannot be drawn.

    Its quantity must be computed, one or two numbers must vary, and e needs exactly one
    contact that can open, without an external drive.
    """
    _check_quantity(args, case)
    axes = sum(len(axis.values) > 1 for axis in case.varied)
    opening_contacts = sum(law.opens for law in case.system.contacts)
    has_restitution = opening_contacts == 1 and not has_external_drive(case.system)
    if case.varied and not 1 <= axes <= 2:
        message = f"a figure has one or two axes, and {axes} numbers vary; leave it out"
        args.add_problem("--plot", message)
    elif args.quantity == "restitution" and not has_restitution:
        message = (
            "such a row has no e; name another --quantity, such as velocity_after.0"
        )
        args.add_problem("--plot", message)


def _check_quantity(args: Arguments, case: Case) -> None:
    """Add a problem for a figure of a quantity that is not computed.

    The problem names the option --also if that computes it.
    """
    quantity = args.quantity
    computed = layout_of(case.system, RequestedReadings(also=tuple(args.also)))
    if quantity in computed:
        return
    name, _, _ = quantity.partition(".")
    if quantity in layout_of(case.system, RequestedReadings(also=ALSO)):
        message = f"{shown(quantity)} is not computed; add --also {name}"
    else:
        hint = suggestion(quantity, computed)
        message = f"there is no {shown(quantity)}; {hint}"
    args.add_problem("--quantity", message)
