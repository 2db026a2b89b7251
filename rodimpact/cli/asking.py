"""What the user gave on the command line: numbers with units, files to write, mistakes in them.

Mistakes are collected in a list of (path, message) and reported together, like those of a model.
"""

from __future__ import annotations

import argparse
import math
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import MappingProxyType
from typing import Any, TypeVar

from ..methods.memory import LargeFile
from ..model.frozen import InvalidModel, Problems, raise_noted
from ..storage.reading import FileFormatError
from ..storage.writing import check_target
from ..units import parse
from . import DONE, FAULT, complain
from .options import flag

Made = TypeVar("Made")


def attempt(
    problems: Problems, make: Callable[..., Made], *given: object,
    options: Mapping[str, str] = MappingProxyType({}), **more: object,
) -> Made | None:
    """What `make` makes of what was given; None, and its mistakes noted, if it refuses.

    `options` names the options that gave its arguments.
    """
    try:
        return make(*given, **more)
    except (InvalidModel, FileFormatError, LargeFile) as error:
        known = dict(problems)  # what cannot be read cannot be right
        found = [(options.get(path, path), message) for path, message in error.problems]
        problems += [told for told in found if told[0] not in known]
        return None


@contextmanager
def naming(options: Mapping[str, str], every: str = "") -> Iterator[None]:
    """Mistakes bear the options that gave the arguments, or every one the same.

    An error that names no argument has the path "".
    """
    try:
        yield
    except ValueError as error:
        found = getattr(error, "problems", [("", str(error))])
        raise InvalidModel([(every or options.get(path, path), message)
                            for path, message in found]) from error


def quantity(problems: Problems, option: str, text: str, dimension: str) -> float:
    """A number with or without a unit; nan and a problem if it is none."""
    try:
        return parse(text, dimension)
    except ValueError as error:
        problems.append((option, str(error)))
        return math.nan


def numbers(
    problems: Problems, arguments: argparse.Namespace, dimensions: Mapping[str, str]
) -> dict[str, Any]:
    """The numbers that options give, by their names; without a dimension they are whole."""
    return {
        name: quantity(problems, flag(name), text, dimension) if dimension
        else whole_number(problems, flag(name), text)
        for name, dimension in dimensions.items()
        if (text := getattr(arguments, name, None)) is not None
    }


def whole_number(problems: Problems, option: str, text: str) -> int:
    """A positive whole number that a register can hold; 0 and a problem if it is none."""
    if re.fullmatch("0*[1-9][0-9]{0,17}", text.strip()):
        return int(text)
    problems.append((option, f"must be a positive whole number below 10^18, got {text.strip()!r}"))
    return 0


def check_outputs(
    problems: Problems, files: Mapping[str, str | None], force: bool, figure: str = ""
) -> None:
    """Refuse, before any work, files that must not or cannot be written.

    Parameters
    ----------
    problems : list
        An existing file without `force`, and a file for two outputs, are added here.
    files : mapping of option to path or None
    force : bool
    figure : str
        Option of a figure, which must be in a format that can be written.

    Raises
    ------
    InvalidModel
        If there are problems, these or earlier ones.
    OSError
        If there are none, but a file cannot be written.
    """
    if files.get(figure) is not None:
        from ..plot.files import FORMATS, format_of

        attempt(problems, format_of, files[figure], FORMATS, options={"path": figure})
    unwritable = None
    option_of: dict[object, str] = {}
    for option, path in files.items():
        try:
            if path is not None:
                first = option_of.setdefault(check_target(path, force=force), option)
                if first != option:
                    problems.append((option, f"{path!r} is the file of {first} too; name another"))
        except FileExistsError as error:
            problems.append((option, str(error)))
        except OSError as error:
            unwritable = unwritable or error
    raise_noted(problems)
    if unwritable:
        raise unwritable


def write(
    files: Mapping[str, str | None], writers: Mapping[str, Callable[..., object]], force: bool
) -> int:
    """Write the outputs that are asked for; the exit status, of a fault if one holds nothing."""
    status = DONE
    for option, make in writers.items():
        if (path := files[option]) is None:
            continue
        try:
            make(path, force=force)
            note(f"wrote {path}")
        except ValueError as error:
            status = complain(f"{option}: {error}", FAULT)
    return status


def note(text: str) -> None:
    """Tell a person at a terminal how things go; a program that reads the results never sees it."""
    if sys.stderr.isatty():
        print(text, file=sys.stderr)
