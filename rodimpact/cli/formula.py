"""Solve a case in symbols: formulas of what the collision comes to, and where they hold.

rodimpact formula CASE.toml --symbols length,area

Symbols are paths of the case, such as bodies.0.length, or their last words, which name all of
these; transit_time and impedance, too, of which rods are made where wave speeds do not matter.
"""

import argparse

from .. import ClosedForm, closed_form, read_case
from ..model.numbering import body_names, contact_names
from . import DONE, MISTAKE, complain


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, and which of its numbers get names."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument(
        "--symbols",
        metavar="A,B,...",
        default="transit_time,impedance",
        help="numbers that get names; default transit_time,impedance",
    )
    parser.add_argument(
        "--conditions",
        action="store_true",
        help="print all conditions under which a formula holds, one a line",
    )
    parser.add_argument("--latex", action="store_true", help="print LaTeX")


def run(given: argparse.Namespace) -> tuple[str, int]:
    """Formulas in the cell of the case and, if it lies on a border, in those beside it."""
    case = read_case(given.case)
    symbols = given.symbols.replace(" ", "").split(",")
    try:
        found = closed_form(case.system, symbols)
    except ImportError as error:
        return "", complain(str(error), MISTAKE)
    forms = [found, *found.sides]
    if given.latex:
        return "\n".join(form._repr_latex_() for form in forms), DONE
    names = "\n".join(f"{name}: {path}" for name, path in found.symbols.items())
    told = [_told(form, case.system.kinds, given.conditions) for form in forms]
    return "\n\n".join([names, *told]), DONE


def _told(form: ClosedForm, kinds: list[str], conditions: bool) -> str:
    """All that a formula says, with all conditions or the nearest."""
    results = [("e", form.restitution)] if form.restitution is not None else []
    results += [
        (f"velocity of {name} after", v)
        for name, v in zip(body_names(kinds), form.velocities_after, strict=True)
    ]
    contacts = contact_names(kinds)
    for k, J, episodes in zip(contacts, form.impulses, form.contact_times, strict=True):
        results.append((f"impulse at contact {k}", J))
        for start, end in episodes:
            results += [(f"start of force at contact {k}", start), ("end of it", end)]
    lines = [f"{name} = {value}" for name, value in results]
    lines.append(
        "where " + "\n  and ".join(map(str, form.cell))
        if conditions and form.cell
        else form.where("--conditions shows all")
    )
    return "\n".join(lines)
