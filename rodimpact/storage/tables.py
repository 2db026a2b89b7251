"""Numbers as text: tables for people, JSON for programs.

A table has six digits with units, a dash for a number that does not exist, and 0 for a
number that is only round-off.
"""

import html
import json
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from ..model.frozen import invalid_argument
from ..units import format_si, shown
from .writing import PathLike, write_lines

MAX_COLUMN_NAME = 60
"""Largest number of characters in the name of a column."""
TIMES = re.compile(r"(?i)(?:time|t|zeit|temps|tiempo|x-?axis|seconds?)\b.*")
"""Names by which a column counts as one of times."""
_NAME = re.compile(rf"(?!.*  )\w[\w .:()/-]{{0,{MAX_COLUMN_NAME - 1}}}(?<![ _/])")
"""Valid names of columns; `misnamed` describes them."""
_MICRO = re.compile(r"(?<=[0-9] )u(?=(?:s|m|J|N|V|Pa)\b)")
"""The letter u of a unit such as us, after a number and a blank."""
JSON_SCHEMA = 1
"""Version of the JSON documents for programs."""

ZERO_IN_TABLE_RTOL = 2.0**-44
"""Largest value, over its scale, that a table shows as 0.

The error of a wave is at most 2^-48 of the velocities for each end that it has passed.
"""


def align(rows: Sequence[Sequence[str]], left: Sequence[int] = (0,)) -> str:
    """Arrange rows of text in aligned columns, two spaces apart.

    Parameters
    ----------
    rows : sequence of rows of str
        All rows have the same number of cells.
    left : sequence of int
        Indices of the columns that are aligned left; the others are aligned right.

    Returns
    -------
    str
        One line per row, without a final newline; "" if there are no rows.

    Examples
    --------
    >>> print(align([["rod", "length"], ["left", "0.4 m"], ["right", "1 m"]]))
    rod    length
    left    0.4 m
    right     1 m
    """
    columns = []
    for i, column in enumerate(zip(*rows, strict=True)):  # the cells of column i
        width = max(map(len, column))
        side = ">"  # format of text that is aligned right
        if i in left:
            side = "<"
        columns.append([f"{cell:{side}{width}}" for cell in column])
    lines = []
    for cells in zip(*columns, strict=True):
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def without_round_off(value: float, scale: float) -> float:
    """0 if a value is only round-off relative to `scale`, else the value unchanged.

    The bound is `ZERO_IN_TABLE_RTOL` times the scale. With an infinite scale no value
    is round-off; nan is returned unchanged.
    """
    if abs(value) <= ZERO_IN_TABLE_RTOL * scale < math.inf:
        return 0.0
    return value


def as_html(text: str) -> str:
    """A table of text as HTML, for notebooks and pages; its columns stay aligned.

    Special characters of HTML are escaped. Units such as us are written µs.
    """
    style = (
        "white-space: pre; overflow-x: auto; font-family: monospace; text-align: left"
    )
    return f'<pre style="{style}">{html.escape(with_micro_sign(text))}</pre>'


def with_micro_sign(text: str) -> str:
    """A text in which units such as us, after a number, are written µs."""
    return _MICRO.sub("µ", text)


def misnamed(column: object) -> str:
    """Reason why a column cannot have this name, as a sentence; "" if it can.

    A name is refused if a file with it would not be read back correctly, or if the
    column would be read as times.
    """
    if isinstance(column, str):
        is_time = TIMES.fullmatch(column)
        if _NAME.fullmatch(column) and not is_time:
            return ""
    return (
        "a column is named by letters, digits, single blanks and _ . : ( ) / -, a "
        f"letter or digit first, no _ or / last, {MAX_COLUMN_NAME} at most, and not as "
        f"times are; got {shown(column)}"
    )


def heading(column: str, unit: str) -> str:
    """Head of a column: its name and its unit in brackets, "1" for the unit "".

    The column is "time" or a channel of a record. InvalidModel if the name or the unit
    is not allowed.

    Examples
    --------
    >>> heading("incident", "V"), heading("strain", "")
    ('incident [V]', 'strain [1]')
    """
    if column != "time":
        fault = misnamed(column)  # a sentence, or ""
        if fault:
            raise invalid_argument("name", fault)
    if re.search(r'[]["(),;]', unit):
        message = (
            f"a unit in a table has no brackets, commas or quotes; got {shown(unit)}"
        )
        raise invalid_argument("unit", message)
    if unit == "":
        unit = "1"
    return f"{column} [{unit}]"


def write_table(
    path: PathLike,
    heads: Sequence[str],
    blocks: Iterable[Sequence[Any]],
    *,
    force: bool = False,
) -> None:
    """Write a table of numbers with all digits as CSV; an error leaves no partial file.

    Each block has the next rows of the table, as one array per head. An existing file
    is replaced if `force` is true; otherwise FileExistsError is raised.
    """
    write_lines(path, _lines_of_table(heads, blocks), force=force)


def _lines_of_table(
    heads: Sequence[str], blocks: Iterable[Sequence[Any]]
) -> Iterator[str]:
    """Lines of a table as CSV, without newlines; the first line has the heads.

    Each block has the next rows of the table, as one array per head.
    """
    yield ",".join(heads)
    for columns in blocks:
        # `repr` writes every digit of a float.
        cells = [map(repr, column.tolist()) for column in columns]
        for row in zip(*cells, strict=True):
            yield ",".join(row)


def joules(value: float, scale: float) -> str:
    """An energy with its unit as text; 0 J if it is only round-off of `scale`, J."""
    return format_si(without_round_off(value, scale), "J")


def versioned_json(**entries: Any) -> str:
    """A JSON document for programs: "schema_version", then the entries.

    nan and infinite numbers become null.
    """
    document = {"schema_version": JSON_SCHEMA} | finite(entries)
    return json.dumps(document, indent=2)


def finite(value: Any) -> Any:
    """A value for JSON, which has no nan and no infinite numbers: they become None.

    Dictionaries, lists and tuples are copied with all their items treated in the same
    way; tuples become lists. Other values are returned unchanged.
    """
    if isinstance(value, dict):
        return dict(zip(value, map(finite, value.values()), strict=True))
    if isinstance(value, list | tuple):
        return list(map(finite, value))
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
