"""What the user gave on the command line: how to run, files to write, mistakes in them."""

import argparse
import math
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

from .. import Case, InvalidModel, Options, Solution, read_case
from ..methods.memory import LargeFile
from ..methods.registry import METHOD_NAMES
from ..model.frozen import Problems, raise_noted
from ..storage.writing import check_target
from ..units import parse
from . import DONE, FAULT, INCOMPLETE, complain
from .options import flag

Made = TypeVar("Made")
Names = Mapping[str, str] | None
NUMBERS = {  # that say how to run, with their dimensions
    "until": ("time", "end of the run, instead of the case's"),
    "dt": ("time", "time step of finite-difference"),
    "rtol": ("dimensionless", "relative accuracy of the outcome"),
    "max_events": ("", "cap on events, instead of the case's"),
    "cells": ("", "cells of finite-difference"),
    "snapshots": ("", "states of the rods that finite-difference keeps"),
}


class Given(argparse.Namespace):
    """What a call gives, with the mistakes in it, which are reported together.

    Attributes
    ----------
    problems : list of (path, message)
        Mistakes that were found so far, as in a model.
    options : dict of str
        The option that gives each argument.
    """

    def __init__(self, parser: argparse.ArgumentParser) -> None:
        super().__init__()
        self.problems: Problems = []
        self.options = {
            action.dest: action.option_strings[-1]
            for action in parser._actions
            if action.option_strings
        }

    def note(self, path: str, message: str) -> None:
        """Note a mistake, unless there is one already: what cannot be read cannot be right."""
        if path not in dict(self.problems):
            self.problems.append((path, message))

    def number(self, option: str, text: str, dimension: str) -> float:
        """A number with or without a unit, whole if it has no dimension; nan and a mistake."""
        try:
            return parse(text, dimension) if dimension else _whole(text)
        except ValueError as error:
            self.note(option, str(error))
            return math.nan

    def attempt(
        self,
        make: Callable[..., Made],
        *given: object,
        names: Names = None,
        **more: object,
    ) -> Made | None:
        """What `make` makes of what was given; None, and its mistakes noted, if it refuses.

        Arguments are named by the options of these names, but for those that `names` names.
        """
        try:
            with self.naming(names=names):
                return make(*given, **more)
        except InvalidModel as error:
            known = dict(self.problems)
            self.problems += [told for told in error.problems if told[0] not in known]
            return None

    @contextmanager
    def naming(self, every: str = "", names: Names = None) -> Iterator[None]:
        """Mistakes bear the options that gave the arguments, or `every` one the same.

        An error that names no argument has the path ""; where that has no name, it is a fault.
        """
        known = {**self.options, **(names or {})}
        try:
            yield
        except (ValueError, LargeFile) as error:
            found = getattr(error, "problems", [("", str(error))])
            told = [
                (every or known.get(path, path), message) for path, message in found
            ]
            if "" in dict(told):
                raise
            raise InvalidModel(told) from error

    def read_case(self, vary: Mapping[str, str] | None = None) -> Any:
        """The case; None, and its mistakes noted by their keys, if it is none."""
        own = {"gauges": "gauges", "output": "output"}  # tables of a case, and options
        return self.attempt(read_case, self.case, vary, names=own)

    def run_options(self, case: Case | None) -> dict[str, Any]:
        """Options for `solve` and `sweep`; mistakes bear the name of the option, or the entry."""
        asked = {
            name: value
            for name in ("method", *NUMBERS)
            if (value := getattr(self, name, None)) is not None
        }
        own = {
            name: value
            for name, value in (case.solve if case else {}).items()
            if not (name in ("dt", "cells") and "rtol" in asked)
            and not (name == "rtol" and asked.keys() & {"dt", "cells"})
        }
        options = {**own, **asked}
        entries = {name: f"solve.{name}" for name in own.keys() - asked.keys()}
        checked = self.attempt(Options, **options, names=entries)
        if checked and case:
            self.attempt(checked.method_for, case.system, names=entries)
        return options

    def check_outputs(self, *names: str, figure: str = "") -> None:
        """Refuse, before any work, files that must not or cannot be written.

        Parameters
        ----------
        *names : str
            Arguments that name files.
        figure : str
            The one whose file must be in the format of a figure.

        Raises
        ------
        InvalidModel
            If there are mistakes, these or earlier ones: a file that exists without --force, or is
            there for two outputs, is one.
        OSError
            If a file cannot be written.
        """
        if figure and getattr(self, figure) is not None:
            from ..plot.files import FORMATS, format_of

            option = self.options[figure]
            self.attempt(
                format_of, getattr(self, figure), FORMATS, names={"path": option}
            )
        option_of: dict[object, str] = {}
        for name in names:
            path, option = getattr(self, name), self.options[name]
            try:
                if path is not None:
                    first = option_of.setdefault(
                        check_target(path, force=self.force), option
                    )
                    if first != option:
                        self.note(
                            option, f"{path!r} is the file of {first} too; name another"
                        )
            except FileExistsError as error:
                self.note(option, str(error))
        raise_noted(self.problems)

    def write(self, **writers: Callable[..., object]) -> int:
        """Write the outputs that are asked for; the exit status, of a fault if one is empty."""
        status = DONE
        for name, make in writers.items():
            if (path := getattr(self, name)) is None:
                continue
            try:
                make(path, force=self.force)
                note(f"wrote {path}")
            except ValueError as error:
                status = complain(f"{self.options[name]}: {error}", FAULT)
        return status


class Number(argparse.Action):
    """An option that is a number of the dimension `const`; its mistakes are noted in the call."""

    def __call__(self, _: object, given: Any, text: Any, *__: object) -> None:
        """Read the number."""
        setattr(
            given, self.dest, given.number(self.option_strings[-1], text, self.const)
        )


def add_run_options(
    parser: argparse.ArgumentParser, names: Sequence[str] = (*NUMBERS,)
) -> None:
    """Options of those names, and the method."""
    parser.add_argument("--method", choices=METHOD_NAMES, help="instead of the case's")
    for name in names:
        number(parser, flag(name), *NUMBERS[name])


def number(parser: Any, option: str, dimension: str, what: str, **more: Any) -> None:
    """Add to a parser, or a group of it, an option that is a number of a dimension."""
    metavar = {"": "N", "dimensionless": "X"}.get(dimension, dimension.upper())
    parser.add_argument(
        option, action=Number, const=dimension, metavar=metavar, help=what, **more
    )


def drawn(draw: Callable[[Any], Any]) -> Callable[..., None]:
    """Writer of the figure that is drawn with `plot`, which is imported only for that."""

    def write(path: str, force: bool) -> None:
        from .. import plot

        plot.save(draw(plot), path, force=force)

    return write


def _whole(text: str) -> int:
    """A positive whole number that a register can hold."""
    if re.fullmatch("0*[1-9][0-9]{0,17}", text.strip()):
        return int(text)
    raise ValueError(
        f"must be a positive whole number below 10^18, got {text.strip()!r}"
    )


def status_of(solution: Solution) -> int:
    """Exit status of a run: whether it came to its end."""
    if solution.stopped_by in ("max_events", "clock"):
        return INCOMPLETE
    return DONE


def note(text: str) -> None:
    """Tell a person at a terminal how things go; a program that reads the results never sees it."""
    if sys.stderr.isatty():
        print(text, file=sys.stderr)
