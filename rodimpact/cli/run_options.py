"""How to run, from the command line and, where that says nothing, from the case."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from ..methods.registry import METHOD_NAMES, Options
from ..storage.casefile import Case
from .asking import Given, Number
from .options import flag

NUMBERS = {  # with their dimensions
    "until": ("time", "end of the run, instead of the case's"),
    "dt": ("time", "time step of finite-difference"),
    "rtol": ("dimensionless", "relative accuracy of the outcome"),
    "max_events": ("", "cap on events, instead of the case's"),
    "cells": ("", "cells of finite-difference"),
    "snapshots": ("", "states of the rods that finite-difference keeps"),
}


def add_run_options(parser: argparse.ArgumentParser, names: Sequence[str] = (*NUMBERS,)) -> None:
    """Options of those names, and the method."""
    parser.add_argument("--method", choices=METHOD_NAMES, help="instead of the case's")
    for name in names:
        dimension, what = NUMBERS[name]
        parser.add_argument(flag(name), action=Number, dimension=dimension, help=what)


def run_options(given: Given, case: Case | None) -> dict[str, Any]:
    """Options for `solve` and `sweep`; mistakes bear the name of the option, or of the entry."""
    asked = {name: value for name in ("method", *NUMBERS)
             if (value := getattr(given, name, None)) is not None}
    own = {
        name: value for name, value in (case.solve if case else {}).items()
        if not (name in ("dt", "cells") and "rtol" in asked)
        and not (name == "rtol" and asked.keys() & {"dt", "cells"})
    }
    options = {**own, **asked}
    entries = {name: f"solve.{name}" for name in own.keys() - asked.keys()}
    checked = given.attempt(Options, **options, names=entries)
    if checked and case:
        given.attempt(checked.method_for, case.system, names=entries)
    return options
