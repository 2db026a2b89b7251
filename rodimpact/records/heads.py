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
"""What a unit at the end of a name may be, without brackets: incident_V."""
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

    The heads are in the last line with a cell for each column, or above a line of
    units. If they name no times, heads with times and units further up are taken; if
    two are the same, the names of a line above. Columns without heads are called "1",
    "2" and so on.

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
        text = line.strip(f"{COMMENT_MARKS} \t\r;,")
        if text:
            texts.append(text)
    rows = []  # cells of each line with one for each column
    for text in texts:
        cells = _head_cells(text, form, count)
        if len(cells) == count and all(cells):
            rows.append(cells)
    if not rows:
        _check_no_heads(texts, form, count)
        return [Head(str(j + 1), "") for j in range(count)]
    # The head of a single column may be a number.
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
    """FileFormatError if the last line above the numbers has heads, but not `count`.

    `texts` are the lines above the numbers, and `count` is the number of columns. The
    heads may be numbers or words, two or more with a delimiter between them. A table of
    one column, or one without delimiters, is not judged.
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
    """Heads of different names: those of a line above, if the last line repeats names.

    `rows` are the cells of all lines with heads. Scopes write a line of channels above
    a line such as Time, Signal, Signal. The heads stay as they are if no line has
    different names.
    """
    if len({head.name for head in heads}) == len(heads):
        return heads
    for row in reversed(rows[:-1]):
        names = [_head_of(cell).name for cell in row]
        are_different = len(set(names)) == len(names)
        if are_different:
            told_apart = []
            for head, name in zip(heads, names, strict=True):
                told_apart.append(head._replace(name=name))
            return told_apart
    return heads


def _has_times(heads: list[Head]) -> bool:
    """Whether a column is called time or t."""
    return any(TIMES.fullmatch(head.name) for head in heads)


def _last_heads(rows: list[list[str]]) -> list[Head]:
    """Heads in the last row, or in the one before if the last is a line of units."""
    heads = _with_units_below(rows)
    if heads is None:
        heads = [_head_of(cell) for cell in rows[-1]]
    return heads


def _times_and_units_above(rows: list[list[str]], heads: list[Head]) -> list[Head]:
    """Heads with a column of times and a row of units below, above further rows.

    The lowest such heads are returned; without any, `heads`. The recorder catman writes
    two dozen lines about each channel: its name, its unit, and so on.
    """
    # The last two of the first `count` rows may be heads and their units. The rows
    # below them are left out, one more each time.
    for count in range(len(rows) - 1, 1, -1):
        with_units = _with_units_below(rows[:count])
        if with_units is not None and _has_times(with_units):
            return with_units
    return heads


def _with_units_below(rows: list[list[str]]) -> list[Head] | None:
    """Heads from the last row but one, with their units from the last row.

    Units may be in brackets. None unless all cells of the last row are known units.
    """
    if len(rows) < 2:
        return None
    below = [spelt(cell.strip("[]() ")) for cell in rows[-1]]
    for unit in below:
        if known_units.conversion(unit) is None:
            return None
    heads = []
    for cell, unit in zip(rows[-2], below, strict=True):
        heads.append(Head(_head_of(cell).name, unit))
    return heads


def _head_cells(text: str, form: NumberForm, count: int) -> list[str]:
    """Heads in a line; the caller checks their number.

    Without a delimiter heads end at blanks. If that does not give `count` heads, a unit
    in brackets is joined to what is before it; if that does not either, heads end at
    two blanks or a tab. One more head at the end, "Comment", is left out.
    """
    cells = form.cells(text)
    if not form.delimiter and len(cells) != count:
        with_units_joined = re.sub(r"\s+([\[(])", r"\1", text)  # "t [s]" to "t[s]"
        cells = with_units_joined.split()
        if len(cells) != count:
            cells = re.split(r"\s{2,}|\t", text)
    # LabVIEW has a column for comments, without entries.
    if len(cells) == count + 1 and cells[-1].casefold() == "comment":
        cells.pop()
    return cells


def _head_of(cell: str) -> Head:
    """Name and unit from a cell: ``incident [mV]``, ``incident_mV``, ``incident / mV``.

    Brackets alone hold the name. Without brackets the last word is a unit if it is
    known as one of what instruments measure; otherwise all of the text is the name.
    """
    text = cell.strip(" \"'")
    # Group 1 of both patterns is the text before, group 2 the brackets or last word.
    match = IN_BRACKETS.fullmatch(text)
    if match and match[1]:
        return Head(one_line(match[1]), spelt(match[2].strip()))
    if match:
        return Head(one_line(match[2]), "")
    match = AT_THE_END.fullmatch(text)
    if match and match[1]:
        unit = spelt(match[2])
        in_si = known_units.conversion(unit)  # None of an unknown unit
        if in_si and known_units.dimension_of(in_si.unit) in MEASURED and unit != "1":
            return Head(one_line(match[1]), unit)
    return Head(one_line(text), "")


def spelt(unit: str) -> str:
    """A unit in the spelling of this package, from words of instruments.

    Other units stay as they are.
    """
    return UNIT_WORDS.get(unit.casefold(), unit)
