"""Numbers as text: tables for people, JSON for programs.

A table gives six digits with units, a dash where there is no such number, and 0 where
only round-off is left.
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
"""Characters of the name of a column, at most."""
TIMES = re.compile(r"(?i)(?:time|t|zeit|temps|tiempo|x-?axis|seconds?)\b.*")
"""Names of columns of times."""
_NAME = re.compile(rf"(?!.*  )\w[\w .:()/-]{{0,{MAX_COLUMN_NAME - 1}}}(?<![ _/])")
_MICRO = re.compile(r"(?<=[0-9] )u(?=(?:s|m|J|N|V|Pa)\b)")
"""The u of a unit behind a number, such as us."""
JSON_SCHEMA = 1
"""Version of the JSON for programs."""

ZERO_IN_TABLE_RTOL = 2.0**-44
"""Bounds the values, over their scale, that a table shows as 0.

A wave is known to 2^-48 of the velocities for each end it has passed.
"""


def align(rows: Sequence[Sequence[str]], left: Sequence[int] = (0,)) -> str:
    """Set rows of text in columns, two spaces apart.

    Parameters
    ----------
    rows : sequence of rows of str
        All rows have as many cells.
    left : sequence of int
        Columns whose text starts at the left; in the others it ends at the right.

    Returns
    -------
    str
        One line a row, without a final newline; "" without rows.

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
        side = ">"
        if i in left:
            side = "<"
        columns.append([f"{cell:{side}{width}}" for cell in column])
    lines = []
    for cells in zip(*columns, strict=True):
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def without_round_off(value: float, scale: float) -> float:
    """A value for a table: 0 if it is only round-off beside `scale`, else itself.

    Beside an infinite scale nothing is round-off.
    """
    if abs(value) <= ZERO_IN_TABLE_RTOL * scale < math.inf:
        return 0.0
    return value


def as_html(text: str) -> str:
    """A table as HTML, for notebooks and pages; its columns stay aligned.

    Characters of HTML are escaped, and us is written µs.
    """
    style = (
        "white-space: pre; overflow-x: auto; font-family: monospace; text-align: left"
    )
    return f'<pre style="{style}">{html.escape(with_micro_sign(text))}</pre>'


def with_micro_sign(text: str) -> str:
    """A text for a page, which can show 385 µs, where a terminal shows 385 us."""
    return _MICRO.sub("µ", text)


def misnamed(column: object) -> str:
    """Why a column cannot have this name, as a sentence; "" if it can.

    A column of such a name would not be read as it was written, or read as times.
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
    """Head of a column with its unit; "1" stands for no unit.

    The column is "time", or one of records. InvalidModel if it cannot have this name or
    this unit.

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
    """Write a table of numbers with all digits, as CSV: the whole file or none.

    Each block holds the next rows, as one array for each head. An existing file is
    replaced if `force` is true, else FileExistsError is raised.
    """
    write_lines(path, _lines_of_table(heads, blocks), force=force)


def _lines_of_table(
    heads: Sequence[str], blocks: Iterable[Sequence[Any]]
) -> Iterator[str]:
    """Lines of a table as CSV, heads first, without newlines.

    Each block holds the next rows, as one array for each head.
    """
    yield ",".join(heads)
    for columns in blocks:
        # `repr` writes every digit of a float.
        cells = [map(repr, column.tolist()) for column in columns]
        for row in zip(*cells, strict=True):
            yield ",".join(row)


def joules(value: float, scale: float) -> str:
    """An energy for a table, with its unit; 0 J if it is round-off beside `scale`."""
    return format_si(without_round_off(value, scale), "J")


def versioned_json(**entries: Any) -> str:
    """A JSON document for programs: entries after `JSON_SCHEMA`.

    nan and inf become null.
    """
    document = {"schema_version": JSON_SCHEMA} | finite(entries)
    return json.dumps(document, indent=2)


def finite(value: Any) -> Any:
    """The value for JSON, which has no infinite numbers and no nan: they become None.

    This goes for all items of dictionaries, lists and tuples, too. These are copied,
    tuples as lists. Other values are returned as they are.
    """
    if isinstance(value, dict):
        return dict(zip(value, map(finite, value.values()), strict=True))
    if isinstance(value, list | tuple):
        return list(map(finite, value))
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
