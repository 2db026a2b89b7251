"""What the user gave on the command line: numbers with units, files to write, mistakes in them.

Mistakes are collected in a list of (path, message) and reported together, like those of a model.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Mapping

from ..storage.writing import check_target
from ..units import parse

Problems = list[tuple[str, str]]


class Mistakes(ValueError):
    """Mistakes in a call; `problems` lists them as (what was given, what is wrong)."""

    def __init__(self, problems: Problems) -> None:
        self.problems = problems
        super().__init__("\n".join(f"{path}: {message}" for path, message in problems))


def quantity(problems: Problems, option: str, text: str, dimension: str) -> float:
    """A number with or without a unit; nan and a problem if it is none."""
    try:
        return parse(text, dimension)
    except ValueError as error:
        problems.append((option, str(error)))
        return math.nan


def whole_number(problems: Problems, option: str, text: str) -> int:
    """A positive whole number that a register can hold; 0 and a problem if it is none."""
    if re.fullmatch("0*[1-9][0-9]{0,17}", text.strip()):
        return int(text)
    problems.append((option, f"must be a positive whole number below 10^18, got {text.strip()!r}"))
    return 0


def check_outputs(problems: Problems, files: Mapping[str, str | None], force: bool) -> None:
    """Refuse, before any work, files that must not or cannot be written.

    Parameters
    ----------
    problems : list
        An existing file without `force` is added here.
    files : mapping of option to path or None
    force : bool

    Raises
    ------
    Mistakes
        If there are problems, these or earlier ones.
    OSError
        If there are none, but a file cannot be written.
    """
    unwritable = None
    for option, path in files.items():
        try:
            if path is not None:
                check_target(path, force=force)
        except FileExistsError as error:
            problems.append((option, str(error)))
        except OSError as error:
            unwritable = unwritable or error
    if problems:
        raise Mistakes(problems)
    if unwritable:
        raise unwritable


def check_format(problems: Problems, option: str, path: str) -> None:
    """Refuse a figure in a format that cannot be written."""
    from ..plot.film import format_of
    from ..plot.saving import FORMATS

    try:
        format_of(path, FORMATS)
    except ValueError as error:
        problems.append((option, str(error).removeprefix("path: ")))


def note(text: str) -> None:
    """Tell a person at a terminal how things go; a program that reads the results never sees it."""
    if sys.stderr is not None and sys.stderr.isatty():
        print(text, file=sys.stderr)
