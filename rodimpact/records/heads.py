"""Names and units of the columns of a table, from the lines above the numbers."""

import re
from typing import NamedTuple

from .. import units as known_units
from ..storage.reading import FileFormatError
from ..storage.tables import TIMES
from ..units import one_line, shown
from .number_forms import NumberForm

UNIT_WORDS = {
    "second": "s",
    "seconds": "s",
    "sec": "s",
    "msec": "ms",
    "usec": "us",
    "nsec": "ns",
    "volt": "V",
    "volts": "V",
    "strain": "1",
    "-": "1",
    "m/m": "1",
    "mm/mm": "1",
}
"""Units as instruments spell them."""
MEASURED = (
    "time",
    "voltage",
    "dimensionless",
    "force",
    "pressure",
    "velocity",
    "length",
    "acceleration",
)
"""Dimensions of units that may end a name without brackets, such as incident_V."""
IN_BRACKETS = re.compile(r"(.*?)[\s_/,]*[\[(]([^\[\]()]*)[\])]")
"""Name and unit of a head such as ``incident [mV]``."""
AT_THE_END = re.compile(r"(.*?)\s*(?:/|\bin\b|_|,|\s)\s*([^\s_/,]+)")
"""Name and last word, which may be a unit, of a head such as ``incident_mV``."""
COMMENT_MARKS = "#%/"
"""Characters with which instruments begin a line above the numbers."""


class Head(NamedTuple):
    """Name of a column and its unit, "" if it has none."""

    name: str
    unit: str


def heads_of(lines: list[str], form: NumberForm, count: int) -> list[Head]:
    """Head of each column, from the lines before the numbers.

    The heads are in the last line that has a cell for each column; if this is a line of
    units, in the line above it. If no head is called time or t, heads further up that
    have times and a line of units are preferred. If names repeat, the names of a line
    above are taken. Without heads the columns are called "1", "2" and so on.

    Parameters
    ----------
    lines : list of str
        The lines before the numbers.
    form : NumberForm
        How lines are cut into cells.
    count : int
        Number of columns.

    Raises
    ------
    FileFormatError
        If the heads are not as many as the columns, mix numbers and words, or two are
        the same.
    """
    texts = []
    for line in lines:
        # Comment marks, blanks and delimiters at both ends are left out.
        text = line.strip(f"{COMMENT_MARKS} \t\r;,")
        if text:
            texts.append(text)
    rows = []  # cells of the lines that have a cell for each column
    for text in texts:
        cells = _head_cells(text, form, count)
        if len(cells) == count and all(cells):
            rows.append(cells)
    if not rows:
        _check_no_heads(texts, form, count)
        return [Head(str(j + 1), "") for j in range(count)]
    # A last row that begins with a number is not a row of heads. Only the head of a
    # single column may be a number.
    if count > 1 and form.is_number(rows[-1][0]):
        raise FileFormatError(
            f"begins with a line that mixes {shown(rows[-1])} and numbers; complete or "
            "remove it"
        )
    heads = _last_heads(rows)
    if not _has_times(heads):
        heads = _times_and_units_above(rows, heads)
    heads = _told_apart(heads, rows)
    names = [head.name for head in heads]
    for name in names:
        if names.count(name) > 1:
            raise FileFormatError(f"has two columns called {shown(name)}; rename one")
    return heads


def _check_no_heads(texts: list[str], form: NumberForm, count: int) -> None:
    """Raise FileFormatError if the last line above the numbers has a wrong head count.

    `texts` are the lines above the numbers, and `count` is the number of columns; none
    of the lines has `count` cells. Heads are two or more cells, numbers or words,
    between delimiters. Tables of one column, or without delimiters, pass.
    """
    cells = []
    if texts:
        cells = form.cells(texts[-1])
    # A single cell, or words between blanks, may be a sentence.
    may_be_sentence = not form.delimiter or len(cells) < 2
    if may_be_sentence or count < 2:
        return
    if all(map(form.is_number, cells)):
        raise FileFormatError(
            f"has the {len(cells)} numbers {shown(cells)} above {count} columns of "
            "numbers; every line needs a number for each column"
        )
    raise FileFormatError(
        f"has the {len(cells)} heads {shown(cells)} for {count} columns "
        "of numbers; name each column"
    )


def _told_apart(heads: list[Head], rows: list[list[str]]) -> list[Head]:
    """The heads, with the names of a line above if their own names repeat.

    `rows` are the cells of all lines with heads. The names are those of the lowest line
    without repeated names; the units are kept. (Scopes write the names of the channels
    above a line such as Time, Signal, Signal.) The heads are returned unchanged if
    their names are different, or if no such line exists.
    """
    if len({head.name for head in heads}) == len(heads):
        return heads
    for row in reversed(rows[:-1]):
        names = [_head_of(cell).name for cell in row]
        are_different = len(set(names)) == len(names)
        if are_different:
            renamed = []
            for head, name in zip(heads, names, strict=True):
                renamed.append(head._replace(name=name))
            return renamed
    return heads


def _has_times(heads: list[Head]) -> bool:
    """Whether the name of a column is time or t."""
    return any(TIMES.fullmatch(head.name) for head in heads)


def _last_heads(rows: list[list[str]]) -> list[Head]:
    """Heads from the last row or, if it is a row of units, from the last two rows."""
    heads = _with_units_below(rows)
    if heads is None:
        heads = [_head_of(cell) for cell in rows[-1]]
    return heads


def _times_and_units_above(rows: list[list[str]], heads: list[Head]) -> list[Head]:
    """Heads further up that have a column of times, with the row of units below them.

    The lowest such heads are returned; `heads` if there are none. The recorder catman
    writes two dozen rows about the channels: their names, their units, and so on.
    """
    # Rows are left out from the end, one more each time; the last two of the remaining
    # `count` rows may be heads and their units.
    for count in range(len(rows) - 1, 1, -1):
        with_units = _with_units_below(rows[:count])
        if with_units is not None and _has_times(with_units):
            return with_units
    return heads


def _with_units_below(rows: list[list[str]]) -> list[Head] | None:
    """Heads with names from the second last row and units from the last row.

    Units may be in brackets. None unless all cells of the last row are known units.
    """
    if len(rows) < 2:
        return None
    below = [spelt(cell.strip("[]() ")) for cell in rows[-1]]  # the units
    for unit in below:
        if known_units.conversion(unit) is None:
            return None
    heads = []
    for cell, unit in zip(rows[-2], below, strict=True):
        heads.append(Head(_head_of(cell).name, unit))
    return heads


def _head_cells(text: str, form: NumberForm, count: int) -> list[str]:
    """Heads in a line; they may be more or fewer than `count`.

    In a table without delimiters three ways are tried until they give `count` heads:
    heads end at blanks; they end at blanks, but not at blanks before a bracket; they
    end at two blanks or a tab. An additional last head "Comment" is left out.
    """
    cells = form.cells(text)
    if not form.delimiter and len(cells) != count:
        with_units_joined = re.sub(r"\s+([\[(])", r"\1", text)  # "t [s]" to "t[s]"
        cells = with_units_joined.split()
        if len(cells) != count:
            cells = re.split(r"\s{2,}|\t", text)
    # LabVIEW writes the head of a column of comments, which has no cells.
    if len(cells) == count + 1 and cells[-1].casefold() == "comment":
        cells.pop()
    return cells


def _head_of(cell: str) -> Head:
    """Name and unit from a cell: ``incident [mV]``, ``incident_mV``, ``incident / mV``.

    If the cell has nothing but brackets, their text is the name. Without brackets the
    last word is the unit if it is a known unit of a dimension in `MEASURED`; otherwise
    the whole text is the name, and the unit is "".
    """
    text = cell.strip(" \"'")
    # In both patterns group 1 is the name. Group 2 is the text in brackets, or the last
    # word.
    match = IN_BRACKETS.fullmatch(text)
    if match and match[1]:
        return Head(one_line(match[1]), spelt(match[2].strip()))
    if match:
        return Head(one_line(match[2]), "")
    match = AT_THE_END.fullmatch(text)
    if match and match[1]:
        unit = spelt(match[2])
        # The "1" of a name such as "gauge 1" is not a unit.
        in_si = known_units.conversion(unit)  # None for an unknown unit
        if in_si and known_units.dimension_of(in_si.unit) in MEASURED and unit != "1":
            return Head(one_line(match[1]), unit)
    return Head(one_line(text), "")


def spelt(unit: str) -> str:
    """A unit in the spelling of this package, such as "V" for "volts".

    Units that are not in `UNIT_WORDS` are returned unchanged.
    """
    return UNIT_WORDS.get(unit.casefold(), unit)
