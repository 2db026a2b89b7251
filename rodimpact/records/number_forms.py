"""How a line of a table is cut into numbers: delimiter and decimal sign.

Both are taken from the first rows if they are unambiguous there. Otherwise an error
asks for the decimal sign; nothing is guessed.
"""

import csv
import re
from contextlib import suppress
from typing import NamedTuple

from ..storage.reading import FileFormatError
from ..units import shown
from .text_file import Survey

FIRST_ROWS = 3
"""Number of first rows that must have equally many numbers."""
_NUMBER = r"[+-]?(?:\d+(?:{0})?|{1})(?:[eE][+-]?\d+)?|(?i:[+-]?(?:nan|inf(?:inity)?))"
"""A number with the fraction {0} after whole digits, or {1} alone.

nan and inf are numbers, too.
"""
_NUMBERS = {
    ".": re.compile(_NUMBER.format(r"\.\d*", r"\.\d+")),
    ",": re.compile(_NUMBER.format(r",\d+", r",\d+")),
}


class NumberForm(NamedTuple):
    """Delimiter, "" for blanks, and decimal sign."""

    delimiter: str
    decimal: str

    @property
    def to_points(self) -> dict[int, int]:
        """Table for `str.translate` from this form to decimal points.

        Commas and points change places if the comma is the decimal sign.
        """
        if self.decimal == ",":
            return str.maketrans(",.", ".,")
        return {}

    def row(self, line: str) -> str:
        """The line without delimiters at its end."""
        return line.rstrip(f"{self.delimiter} \t\n")

    def cells(self, line: str) -> list[str]:
        """Cells of a line, without blanks around them; a cell may be in quotes.

        Blank cells at the end are left out.
        """
        line = self.row(line)
        if not self.delimiter:
            return line.split()
        row = line.split(self.delimiter)
        if '"' in line:
            with suppress(csv.Error):  # quotes that do not end: cut as without quotes
                row = next(csv.reader([line], delimiter=self.delimiter), [])
        return list(map(str.strip, row))

    def count_numbers(self, line: str) -> int:
        """Count of numbers in a line; 0 if any cell is blank or no number."""
        cells = self.cells(line)
        if all(map(self.is_number, cells)):
            return len(cells)
        return 0

    def is_number(self, cell: str) -> bool:
        """Whether a cell is a number with this decimal sign."""
        return _NUMBERS[self.decimal].fullmatch(cell) is not None


COMMA_COLUMNS = NumberForm(",", ".")
"""Commas separate the cells, and the decimal sign is a point."""
QUOTED = NumberForm(",", ",")
"""Commas separate the cells and are the decimal sign in numbers in quotes."""
FORMS = [
    NumberForm("\t", "."),
    NumberForm("\t", ","),
    NumberForm(";", "."),
    NumberForm(";", ","),
    QUOTED,
    COMMA_COLUMNS,
    NumberForm("", "."),
    NumberForm("", ","),
]
"""All forms, in the order in which they are tried."""


class TableStart(NamedTuple):
    """Where a table begins.

    Attributes
    ----------
    form : NumberForm
    line : int
        Index of its first line.
    """

    form: NumberForm
    line: int


def find_table(lines: list[str], survey: Survey, decimal: str | None) -> TableStart:
    """The first line of numbers, and how it is cut into them.

    The form is that of the first `FIRST_ROWS` rows of equally many numbers. The table
    may begin above them, see `_first_row`.

    Parameters
    ----------
    lines : list of str
        The first lines of the file.
    survey : Survey
        Of the whole file: it tells decimal commas that the first lines do not show.
    decimal : str, optional
        The decimal sign, if the user gave it.

    Raises
    ------
    FileFormatError
        If there is no table of numbers, or the decimal sign is ambiguous.
    """
    forms = []
    # The form with commas inside numbers and between cells is tried only in files that
    # quote such cells.
    for form in FORMS:
        is_wanted = decimal in (None, form.decimal)
        if is_wanted and (form != QUOTED or survey.quotes_commas):
            forms.append(form)
    matching: list[NumberForm] = []
    start = 0
    for index in range(len(lines)):
        matching = _forms_from(lines, index, forms)
        if matching:
            start = index
            break
    if not matching:
        raise FileFormatError(f"has no table of numbers{_why_none(lines, forms)}")
    form = _chosen(matching, lines, start, survey)
    return TableStart(form, _first_row(lines, start, form))


def _forms_from(
    lines: list[str], start: int, forms: list[NumberForm]
) -> list[NumberForm]:
    """Those of the forms in which the first rows from a line on are rows of numbers.

    The first `FIRST_ROWS` rows must have equally many. Blank lines between them do not
    count; there may be fewer rows, if the lines end. A blank line at `start` matches no
    form.
    """
    # A blank line may stand below each row.
    nearest = lines[start : start + 2 * FIRST_ROWS]
    filled = list(filter(str.strip, nearest))
    first_rows = filled[:FIRST_ROWS]
    matching = []
    for form in forms:
        count = form.count_numbers(lines[start])
        counts = set(map(form.count_numbers, first_rows))
        if count > 0 and counts == {count}:  # all rows have as many
            matching.append(form)
    return matching


def _first_row(lines: list[str], start: int, form: NumberForm) -> int:
    """Index of the first row of the table, which may lie above `start`.

    It is the first line of as many numbers as the line at `start`, in the same form:
    below it may stand rows of other lengths, such as one without some channels. A line
    of words ends the search: what is above it belongs to the head. A blank line does
    not. A table of one column begins at `start`.
    """
    count = form.count_numbers(lines[start])
    if count == 1:
        return start
    first = start
    for earlier in reversed(range(start)):
        cells = form.cells(lines[earlier])
        is_head = any(cells) and not any(map(form.is_number, cells))
        if is_head:
            break
        if form.count_numbers(lines[earlier]) == count:
            first = earlier
    return first


def _chosen(
    matching: list[NumberForm], lines: list[str], start: int, survey: Survey
) -> NumberForm:
    """One of the forms that match the first rows.

    A form that finds several numbers in the line at `start` is preferred to a form that
    finds a single one. If whole numbers fit both decimal signs, a comma is chosen if
    the table has one anywhere, else a point. FileFormatError is raised if commas may
    separate numbers or be decimal signs and the number of commas in the last head does
    not decide it.
    """
    line = lines[start]
    # Forms with a single number count only if no form finds several.
    several = [form for form in matching if form.count_numbers(line) > 1]
    if not several:
        several = matching
    # `several` is in the order of FORMS. If COMMA_COLUMNS is the first, neither tabs
    # nor semicolons nor quoted numbers fit.
    if several[0] == COMMA_COLUMNS:
        last_head = ""
        for head in lines[:start]:
            if head.strip():
                last_head = head
        # If another form finds a single number, the comma may be its decimal sign. But
        # commas separate columns if the last head has equally many.
        may_be_decimal = len(several) < len(matching)
        commas = COMMA_COLUMNS.count_numbers(line) - 1
        if may_be_decimal and last_head.count(",") != commas:
            raise FileFormatError(
                f"line {start + 1}: {shown(line)} may be two numbers or a "
                'decimal comma; give decimal="." or decimal=","'
            )
        return COMMA_COLUMNS
    # A comma in any line of the table, also below the first rows, is a decimal sign.
    sign = "."
    if survey.last_comma_line >= start:
        sign = ","
    for form in several:
        if form.decimal == sign:
            return form
    return several[0]


def _why_none(lines: list[str], forms: list[NumberForm]) -> str:
    """Why no first row of numbers is found, and the remedy: the end of a sentence.

    All lines are blank, or a line in the middle has a cell that is no number, or the
    line has numbers and a line below it has not. The line is read in the form that
    finds most numbers in it.
    """
    filled = [i for i, line in enumerate(lines) if line.strip()]
    if not filled:
        return "; export it as text, with one row for each sample"
    middle = filled[len(filled) // 2]
    line = lines[middle]

    def cells_that_are_numbers(form: NumberForm) -> int:
        """How many cells of the line are numbers in a form, whatever the others are."""
        return sum(map(form.is_number, form.cells(line)))

    form = max(forms, key=cells_that_are_numbers)
    count = form.count_numbers(line)  # 0 if a cell is no number
    if count:  # This line could begin the numbers: so a line below it is none.
        return (
            f": line {middle + 1} has {count} numbers, but not all lines below it; "
            "every line needs a number for each column"
        )
    odd = next(cell for cell in form.cells(line) if not form.is_number(cell))
    return (
        f": line {middle + 1} has {shown(odd)}; below the heads write only numbers, in "
        "columns separated by tabs, semicolons, commas or blanks, times in seconds, "
        "and no separators of thousands"
    )
