"""Solve a case in symbols: formulas for e, velocities and impulses.

rodimpact formula CASE.toml --symbols length,area

The formulas hold under conditions. The command prints the three conditions that the
case fulfils with the smallest margin; --conditions prints all conditions. The command
needs SymPy: pip install '.[sympy]'.

A symbol replaces a number of the case. Give the path of the number, such as
bodies.0.length, or the last word of the path: length stands for all lengths. The
symbols transit_time and impedance replace the lengths, areas and materials of rods.
Stepped rods with many symbols take minutes; fewer --symbols take less time.
"""

import argparse
from typing import Any

from .. import Case, ClosedForm, closed_form, read_case
from ..model.numbering import body_names, contact_names
from .arguments import Arguments
from .exit_status import DONE, MISTAKE, CommandResult
from .messages import complain


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add arguments: a case, its numbers that become symbols, and forms of the text."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument(
        "--symbols",
        metavar="A,B,...",
        default="transit_time,impedance",
        help="numbers to replace by symbols; default transit_time,impedance",
    )
    parser.add_argument(
        "--conditions",
        action="store_true",
        help="print all conditions of each formula, one per line",
    )
    parser.add_argument("--latex", action="store_true", help="print LaTeX")


def run(args: Arguments) -> CommandResult:
    """Formulas in the cell of the case and in cells beside a border: text or LaTeX.

    The text begins with the path of each symbol. Without SymPy a message is printed,
    and the status is MISTAKE.
    """
    case = read_case(args.case)
    symbols = args.symbols.replace(" ", "").split(",")
    try:
        with args.naming_mistakes(names={"max_events": "solve.max_events"}):
            form = closed_form(case.system, symbols, **_caps(case))
    except ImportError as error:
        return CommandResult("", complain(str(error), MISTAKE))
    forms = [form, *form.sides]
    if args.latex:
        lines = [each._repr_latex_() for each in forms]
        return CommandResult("\n".join(lines), DONE)
    names = []
    for name, path in form.symbols.items():
        names.append(f"{name}: {path}")
    blocks = ["\n".join(names)]
    for each in forms:
        blocks.append(_text_of(each, case.system.kinds, args.conditions))
    return CommandResult("\n\n".join(blocks), DONE)


def _caps(case: Case) -> dict[str, Any]:
    """Keyword arguments of `closed_form`: the largest number of events, if stated.

    It is in the table [solve] of the case; {} if it is not.
    """
    caps: dict[str, Any] = {}
    if "max_events" in case.solve:
        caps["max_events"] = case.solve["max_events"]
    return caps


def _text_of(form: ClosedForm, kinds: list[str], all_conditions: bool) -> str:
    """Lines of e, velocities, impulses and contact times, and where they hold.

    These are all conditions, if there are any, or the nearest ones. e is left out if it
    has no formula.
    """
    lines = []
    if form.restitution is not None:
        lines.append(f"e = {form.restitution}")
    for body, velocity in zip(body_names(kinds), form.velocities_after, strict=True):
        lines.append(f"velocity of {body} after = {velocity}")
    for k, contact in enumerate(contact_names(kinds)):
        lines.append(f"impulse at contact {contact} = {form.impulses[k]}")
        for start, end in form.contact_times[k]:
            lines.append(f"start of force at contact {contact} = {start}")
            lines.append(f"end of it = {end}")
    if all_conditions and form.cell:
        lines.append("where " + "\n  and ".join(map(str, form.cell)))
    else:
        lines.append(form.where(remedy="--conditions shows all"))
    return "\n".join(lines)
