"""Map a family of collisions over one or more numbers of a case.

rodimpact sweep CASE.toml --vary bodies.0.length=0.05:1:200 --vary "contacts.0.gap=0,1 um,10 um"

A grid is start:stop:count, start:stop:count:log for equal ratios, or a list; a number may have a
unit. The first --vary is the first axis. Every collision runs as [solve] of the case says, or what
is given here instead, and without an end in time to its proof; [output] is for `rodimpact run`.
Exit status 3 if some did not come to their end; the status of each says why.
"""

import argparse
from collections.abc import Iterable

from .. import Case, sweep
from ..methods.abilities import driven
from ..methods.run import ALSO
from ..model.paths import suggestion
from ..running.columns import layout_of
from ..running.readings import Readings
from ..running.sweep_report import sweep_json, sweep_table
from . import INCOMPLETE
from .asking import Given, add_run_options, drawn, number
from .options import as_options

EXAMPLE = "bodies.0.length=0.05:1:200"
MORE = "--csv prints all, --save keeps them"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, what varies in it, how to go about it, what to print and write."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument(
        "--vary",
        metavar="PATH=GRID",
        action="append",
        default=[],
        help=f"a number and its values, {EXAMPLE}; once for each axis",
    )
    number(parser, "--workers", "", "threads; default one a processor")
    parser.add_argument(
        "--checkpoint",
        metavar="DIR",
        help="keep finished parts here, and go on from those of an earlier run",
    )
    parser.add_argument(
        "--also",
        metavar="NAME",
        action="append",
        default=[],
        choices=ALSO,
        help="compute more, which takes longer: dissipated, the energy lost in "
        "contacts; set, the overlap that yielding contacts keep, such as the set "
        "of a pile; largest_stress in each rod; displacement of each body at the "
        "end (--until); accuracy, the stated error; give --also once for each",
    )
    add_run_options(parser, ("until", "max_events", "dt", "rtol", "cells"))
    form = parser.add_mutually_exclusive_group()
    form.add_argument(
        "--csv", action="store_true", help="print a row for each collision"
    )
    form.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--save", metavar="FILE.npz", help="save the result")
    parser.add_argument("--plot", metavar="FILE", help="draw it: .png, .svg or .pdf")
    parser.add_argument(
        "--quantity",
        metavar="NAME",
        default="restitution",
        help="what --plot shows: restitution (default), duration.0 of contact 0, "
        "velocity_after.1 of body 1, or another column of --csv",
    )
    parser.add_argument("--force", action="store_true", help="replace existing files")


def run(given: Given) -> tuple[str | Iterable[str], int]:
    """Check everything, solve, write the files, and hand back the table, CSV or JSON."""
    case = given.read_case(_vary(given))
    if case:
        _check_case(given, case)
    how = {name: getattr(given, name) for name in ("checkpoint", "also", "workers")}
    options = given.run_options(case)
    given.check_outputs("save", "plot", figure="plot")

    with given.naming():
        result = sweep(case.system, **options, **how)
    # refused for a quantity that no collision has; the table tells why
    figure = drawn(lambda plot: plot.sweep(result, quantity=given.quantity))
    wrote = given.write(save=result.save, plot=figure)
    status = INCOMPLETE if result.incomplete.any() else wrote
    if given.csv:
        return result.csv_lines(), status
    if given.json:
        return sweep_json(result, case.varied), status
    return as_options(sweep_table(result, case.varied, MORE)), status


def _vary(given: Given) -> dict[str, str]:
    """Grids by path."""
    vary: dict[str, str] = {}
    if not given.vary:
        given.problems.append(("--vary", f"name what to vary: --vary {EXAMPLE}"))
    for item in given.vary:
        path, _, grid = (part.strip() for part in item.rpartition("="))
        if not path:
            given.problems.append(
                ("--vary", f"must be PATH=GRID, such as {EXAMPLE}, got {item!r}")
            )
        elif path in vary:
            given.problems.append(
                (path, "is varied twice; write one list or one range")
            )
        else:
            vary[path] = grid
    return vary


def _check_case(given: Given, case: Case) -> None:
    """Refuse what only a single run takes, and a figure that cannot be drawn."""
    if "snapshots" in case.solve:
        given.note(
            "solve.snapshots", "a sweep keeps no states; take snapshots out of the case"
        )
    if given.plot is None:
        return
    known = layout_of(case.system, Readings())
    if given.quantity not in known:
        message = f"there is no {given.quantity!r}; {suggestion(given.quantity, known)}"
        given.note("--quantity", message)
    wide = sum(len(axis.values) > 1 for axis in case.varied)
    contacts = sum(law.opens for law in case.system.contacts)
    if case.varied and not 1 <= wide <= 2:
        given.note(
            "--plot",
            f"a figure has one or two axes, and {wide} numbers vary; leave it out",
        )
    elif given.quantity == "restitution" and (contacts != 1 or driven(case.system)):
        message = (
            "such a row has no e; name another --quantity, such as velocity_after.0"
        )
        given.note("--plot", message)
