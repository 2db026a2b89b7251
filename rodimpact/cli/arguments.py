"""The arguments of a call: how they are read, and the mistakes in them.

All mistakes of a call are collected and reported together. They bear the names of
options.
"""

import argparse
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

from .. import Case, InvalidModel, Options, Solution, read_case
from ..methods.memory import LargeFile
from ..methods.registry import METHOD_NAMES
from ..model.frozen import Problems, raise_if_problems
from ..storage.writing import check_target
from ..units import parse, shown, shown_path
from .exit_status import DONE, INCOMPLETE, MISTAKE
from .messages import (
    NOT_QUOTED,
    ONLY_ARGUMENTS,
    complain,
    option_of,
    print_progress,
)

T = TypeVar("T")
COUNT = ""
"""Dimension of an option that is a positive whole number."""
RUN_NUMBERS = {
    "until": ("time", "end of the run; default: the end in the case"),
    "dt": ("time", "time step of finite-difference"),
    "rtol": ("dimensionless", "accepted relative error of the outcome"),
    "max_events": (COUNT, "largest number of events; default: the number in the case"),
    "cells": (
        COUNT,
        "number of cells of finite-difference in the rod with the longest transit time",
    ),
    "snapshots": (COUNT, "number of states that finite-difference stores"),
}
"""Numbers that say how to run: their dimension, and their help."""
CASE_KEYS = {"gauges": "gauges", "output": "output"}
"""Tables of a case that bear the name of an option, too."""


class Arguments(argparse.Namespace):
    """The arguments of a call, and the mistakes in them.

    Attributes
    ----------
    problems : list of (path, message)
        Mistakes that were found so far, as in a model.
    options : dict of str
        The option that gives each argument.
    """

    def __init__(self, parser: argparse.ArgumentParser) -> None:
        """Begin without mistakes; `options` has the option of each argument."""
        super().__init__()
        self.problems: Problems = []
        self.options: dict[str, str] = {}
        for action in parser._actions:
            if action.option_strings:
                self.options[action.dest] = action.option_strings[-1]

    # Mistakes

    def add_problem(self, path: str, message: str) -> None:
        """Add a mistake, unless there is one already.

        A value that cannot be read has no further mistakes.
        """
        if path not in dict(self.problems):
            self.problems.append((path, message))

    def build_or_add_problems(
        self,
        build: Callable[..., T],
        *values: object,
        names: Mapping[str, str] | None = None,
        **keywords: object,
    ) -> T | None:
        """Result of a function; None, and its mistakes added, if it refuses the values.

        Of two mistakes of one argument only the first is kept.

        Parameters
        ----------
        build : function
        *values, **keywords
            Arguments of the function.
        names : dict of str
            Names of arguments in messages, other than those of `options`.
        """
        try:
            with self.naming_mistakes(names=names):
                return build(*values, **keywords)
        except InvalidModel as error:
            earlier = dict(self.problems)
            for path, message in error.problems:
                if path not in earlier:
                    self.problems.append((path, message))
            return None

    @contextmanager
    def naming_mistakes(
        self, every: str = "", names: Mapping[str, str] | None = None
    ) -> Iterator[None]:
        """Name mistakes after the options that gave the arguments.

        An error that names no argument has the path "". If this path has no name, the
        error is a fault of rodimpact, and is raised unchanged.

        Parameters
        ----------
        every : str
            One name for all mistakes.
        names : dict of str
            Names of arguments, other than those of `options`.
        """
        name_of = dict(self.options)
        if names is not None:
            name_of |= names
        try:
            yield
        except (ValueError, LargeFile) as error:
            problems = []
            unnamed = [("", str(error))]  # an error other than InvalidModel
            for path, message in getattr(error, "problems", unnamed):
                name = every
                if name == "":
                    name = name_of.get(path, path)
                if name == "":
                    raise  # the error as it is: a fault of rodimpact
                problems.append((name, message))
            raise InvalidModel(problems) from error

    # Values

    def number(self, option: str, text: str, dimension: str) -> float:
        """A number with or without a unit; nan, with a mistake added, for another text.

        Parameters
        ----------
        option : str
        text : str
        dimension : str
            Dimension of the number, such as "time", or `COUNT`.
        """
        try:
            if dimension == COUNT:
                return _whole(text)
            return parse(text, dimension)
        except ValueError as error:
            self.add_problem(option, str(error))
            return math.nan

    def read_case(self, vary: Mapping[str, str] | None = None) -> Any:
        """The case of the call, in which the numbers in `vary` have grids of values.

        None if it is invalid; its mistakes are added, by their keys.
        """
        return self.build_or_add_problems(read_case, self.case, vary, names=CASE_KEYS)

    def run_options(self, case: Case | None) -> dict[str, Any]:
        """Options for `solve` and `sweep`: those of the call, and those of the case.

        An option of the call replaces that of the case. Mistakes are added; they bear
        the name of the option, or of the entry in the case, here and in
        `naming_mistakes`. The options are returned even if they are wrong.
        """
        options: dict[str, Any] = {}
        for name in ("method", *RUN_NUMBERS):
            value = getattr(self, name, None)
            if value is not None:
                options[name] = value
        entries = {}
        if case is not None:
            for name in _entries_in_force(case.solve, options):
                options[name] = case.solve[name]
                entries[name] = f"solve.{name}"
        self.options |= entries
        checked = self.build_or_add_problems(Options, **options, names=entries)
        if checked is not None and case is not None:
            self.build_or_add_problems(checked.method_for, case.system, names=entries)
        return options

    def name_entries(self, text: str) -> str:
        """The text with names of arguments replaced by the case entries that gave them.

        "Give until=" becomes "Give solve.until" if the case file has this entry. Names
        whose values came from options of the command line stay: they are replaced by
        the options when the text is printed.
        """
        for name in RUN_NUMBERS:
            entry = self.options.get(name, "")
            if not entry.startswith("solve."):
                continue
            pattern = rf"{NOT_QUOTED}{name}="
            if name in ONLY_ARGUMENTS:
                # The "=" is optional: the name alone is replaced too, as a whole word.
                pattern += r"?(?!\w)"
            text = re.sub(pattern, entry, text)
        return text

    # Output files

    def check_outputs(self, *names: str, figure: str = "") -> None:
        """Raise an error, before any work, if an output file cannot be written.

        Arguments that are None are ignored.

        Parameters
        ----------
        *names : str
            Arguments that name files.
        figure : str
            The one of these arguments that names a figure, "" if there is none. The
            ending of its file must be that of a format.

        Raises
        ------
        InvalidModel
            If there are mistakes, in the files or earlier ones. A file that exists
            without --force, or that is named for two outputs, is a mistake.
        OSError
            If a file cannot be written.
        """
        if figure and getattr(self, figure) is not None:
            from ..plot.files import FORMATS, format_of

            self.build_or_add_problems(
                format_of,
                getattr(self, figure),
                FORMATS,
                names={"path": self.options[figure]},
            )
        option_of_target: dict[object, str] = {}
        for name in names:
            path = getattr(self, name)
            option = self.options[name]
            if path is None:
                continue
            try:
                target = check_target(path, force=self.force)
            except FileExistsError as error:
                self.add_problem(option, str(error))
                continue
            first = option_of_target.setdefault(target, option)
            if first != option:
                message = f"{shown_path(path)} is the file of {first} too; name another"
                self.add_problem(option, message)
        raise_if_problems(self.problems)

    def write(self, **writers: Callable[..., object]) -> int:
        """Write the outputs that are asked for, and say at a terminal what was written.

        Parameters
        ----------
        **writers : function
            Function of a path and of `force` that writes the file, by the argument with
            the path. An output whose argument is None is not asked for.

        Returns
        -------
        int
            Exit status: that of a mistake if an output cannot be made of these results,
            such as a figure of e where nothing collided.
        """
        status = DONE
        for name, write in writers.items():
            path = getattr(self, name)
            if path is None:
                continue
            try:
                with self.naming_mistakes():
                    write(path, force=self.force)
                print_progress(f"wrote {path}")
            except ValueError as error:
                status = complain(f"{self.options[name]}: {error}", MISTAKE)
        return status


def _entries_in_force(
    solve: Mapping[str, Any], options: Mapping[str, Any]
) -> list[str]:
    """Entries of the table [solve] that options of the call do not replace.

    An accuracy replaces a time step and a number of cells, and they replace an
    accuracy.
    """
    entries = []
    is_step_given = "dt" in options or "cells" in options
    for name in solve:
        if name in options:
            continue
        if name in ("dt", "cells") and "rtol" in options:
            continue
        if name == "rtol" and is_step_given:
            continue
        entries.append(name)
    return entries


class NumberAction(argparse.Action):
    """An option that is a number of the dimension `const`.

    Mistakes are added to the call.
    """

    def __call__(self, _: object, args: Any, text: Any, *__: object) -> None:
        """Set the argument to the number that the text says, or add a mistake."""
        number = args.number(self.option_strings[-1], text, self.const)
        setattr(args, self.dest, number)


def add_number(
    parser: Any, option: str, dimension: str, help_text: str, **settings: Any
) -> None:
    """Add an option that is a number of a dimension, to a parser or a group of it.

    `dimension` is one such as "time", which help shows as TIME, or "dimensionless" (X),
    or `COUNT` (N). `settings` are those of `add_argument`.
    """
    metavar = dimension.upper()
    if dimension == COUNT:
        metavar = "N"
    elif dimension == "dimensionless":
        metavar = "X"
    parser.add_argument(
        option,
        action=NumberAction,
        const=dimension,
        metavar=metavar,
        help=help_text,
        **settings,
    )


def add_run_options(
    parser: argparse.ArgumentParser, names: Sequence[str] = tuple(RUN_NUMBERS)
) -> None:
    """Add the method, and some of the numbers in `RUN_NUMBERS`.

    By default all of these numbers are added.
    """
    parser.add_argument(
        "--method", choices=METHOD_NAMES, help="method; default: the method in the case"
    )
    for name in names:
        dimension, help_text = RUN_NUMBERS[name]
        add_number(parser, option_of(name), dimension, help_text)


def figure_writer(draw: Callable[[Any], Any]) -> Callable[..., None]:
    """Make a function of a path that draws a figure and writes it there.

    Parameters
    ----------
    draw : function
        Draws the figure; receives `rodimpact.plot`, which is imported only for this.
    """

    def write(path: str, force: bool) -> None:
        """Draw the figure and write it; `force` replaces an existing file."""
        from .. import plot

        plot.save(draw(plot), path, force=force)

    return write


def _whole(text: str) -> int:
    """The positive whole number below 10^18 in a text; ValueError for any other."""
    digits = text.strip()
    if re.fullmatch("0*[1-9][0-9]{0,17}", digits):
        return int(text)
    raise ValueError(
        f"must be a positive whole number below 10^18, got {shown(digits)}"
    )


def status_of(solution: Solution) -> int:
    """Exit status of a run: incomplete if a cap or the clock stopped it, else done."""
    if solution.stopped_by in ("max_events", "clock"):
        return INCOMPLETE
    return DONE
