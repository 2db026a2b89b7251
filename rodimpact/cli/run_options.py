"""How to run, from the command line and, where that says nothing, from the case."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any, NamedTuple

from ..methods.registry import METHOD_NAMES, Options
from ..model.frozen import Problems
from ..storage.casefile import Case
from .asking import attempt, numbers
from .options import flag


class _Option(NamedTuple):
    metavar: str
    dimension: str  # of a number with a unit; "" for a whole number
    help: str


NUMBERS = {
    "until": _Option("TIME", "time", "end of the run, instead of the case's"),
    "dt": _Option("TIME", "time", "time step of finite-difference"),
    "rtol": _Option("X", "dimensionless", "relative accuracy of the outcome"),
    "max_events": _Option("N", "", "cap on events, instead of the case's"),
    "cells": _Option("N", "", "cells of finite-difference"),
    "snapshots": _Option("N", "", "states of the rods that finite-difference keeps"),
}


def add_run_options(parser: argparse.ArgumentParser, names: Sequence[str]) -> None:
    """Options of those names, and the method."""
    parser.add_argument("--method", choices=METHOD_NAMES, help="instead of the case's")
    for name in names:
        option = NUMBERS[name]
        parser.add_argument(flag(name), metavar=option.metavar, help=option.help)


def run_options(
    problems: Problems, arguments: argparse.Namespace, case: Case | None
) -> dict[str, Any]:
    """Options for `solve` and `sweep`; mistakes bear the name of the option, or of the entry."""
    given = numbers(problems, arguments, {name: of.dimension for name, of in NUMBERS.items()})
    if arguments.method is not None:
        given["method"] = arguments.method
    own = {
        name: value for name, value in (case.solve if case else {}).items()
        if not (name in ("dt", "cells") and "rtol" in given)
        and not (name == "rtol" and given.keys() & {"dt", "cells"})
    }
    options = {**own, **given}
    from_case = own.keys() - given.keys()
    paths = {name: f"solve.{name}" if name in from_case else flag(name) for name in NUMBERS}
    checked = attempt(problems, Options, **options, options=paths)
    if checked and case:
        attempt(problems, checked.method_for, case.system, options=paths)
    return options
