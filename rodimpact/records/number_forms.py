"""The form of the numbers in a text table: delimiter of cells, and decimal sign.

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
"""Number of rows at the start of a table that must have equally many numbers."""
_NUMBER = r"[+-]?(?:\d+(?:{0})?|{1})(?:[eE][+-]?\d+)?|(?i:[+-]?(?:nan|inf(?:inity)?))"
"""Pattern of a number: {0} is a fraction after whole digits, {1} a fraction alone.

nan and inf are numbers, too.
"""
_NUMBERS = {
    ".": re.compile(_NUMBER.format(r"\.\d*", r"\.\d+")),
    ",": re.compile(_NUMBER.format(r",\d+", r",\d+")),
}


class NumberForm(NamedTuple):
    """Delimiter of cells and decimal sign of a table."""

    delimiter: str  # "" for blanks, any number of them
    decimal: str  # "." or ","

    @property
    def to_points(self) -> dict[int, int]:
        """Table for `str.translate` that makes decimal commas decimal points.

        Points become commas at the same time. Without decimal commas it is empty.
        """
        if self.decimal == ",":
            return str.maketrans(",.", ".,")
        return {}

    def row(self, line: str) -> str:
        """The line without the delimiters and blanks at its end."""
        return line.rstrip(f"{self.delimiter} \t\n")

    def cells(self, line: str) -> list[str]:
        """Cells of a line, without the blanks around them and without quotes.

        Blank cells at the end of the line are left out.
        """
        line = self.row(line)
        if not self.delimiter:
            return line.split()
        row = line.split(self.delimiter)
        if '"' in line:
            with suppress(csv.Error):  # an unclosed quote: `row` stays as it is
                row = next(csv.reader([line], delimiter=self.delimiter), [])
        return list(map(str.strip, row))

    def count_numbers(self, line: str) -> int:
        """Count of numbers in a line; 0 for a blank line, or one with another cell."""
        cells = self.cells(line)
        if all(map(self.is_number, cells)):
            return len(cells)
        return 0

    def is_number(self, cell: str) -> bool:
        """Whether a cell is a number with this decimal sign."""
        return _NUMBERS[self.decimal].fullmatch(cell) is not None


COMMA_COLUMNS = NumberForm(",", ".")
"""Form in which commas separate the cells, and the decimal sign is a point."""
QUOTED = NumberForm(",", ",")
"""Form in which commas separate the cells and, inside quotes, are the decimal sign."""
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
    """Form of the numbers of a table, and the line with which it begins.

    Attributes
    ----------
    form : NumberForm
    line : int
        Index of the first line of numbers.
    """

    form: NumberForm
    line: int


def find_table(lines: list[str], survey: Survey, decimal: str | None) -> TableStart:
    """The form of the numbers of a table, and its first line.

    The form is the one in which `FIRST_ROWS` rows, as near to the top as possible, have
    equally many numbers. The table may begin above these rows, see `_first_row`.

    Parameters
    ----------
    lines : list of str
        The first lines of the file.
    survey : Survey
        Facts about the whole file, which may have decimal commas below these lines.
    decimal : str, optional
        The decimal sign, if the user gave it.

    Raises
    ------
    FileFormatError
        If there is no table of numbers, or the decimal sign is ambiguous.
    """
    forms = []
    # QUOTED is tried only if the file has a number with a decimal comma in quotes.
    for form in FORMS:
        is_wanted = decimal in (None, form.decimal)
        if is_wanted and (form != QUOTED or survey.quotes_commas):
            forms.append(form)
    matching: list[NumberForm] = []
    start = 0  # index of the first line at which a form matches
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
    """The forms in which the lines from `start` on are rows of numbers, in their order.

    The next `FIRST_ROWS` lines that are not blank must have equally many numbers; near
    the end of the lines there may be fewer rows. A blank line at `start` matches no
    form.
    """
    # Twice as many lines, since a blank line may stand below each row
    nearest = lines[start : start + 2 * FIRST_ROWS]
    filled = list(filter(str.strip, nearest))
    first_rows = filled[:FIRST_ROWS]
    matching = []
    for form in forms:
        count = form.count_numbers(lines[start])
        counts = set(map(form.count_numbers, first_rows))
        if count > 0 and counts == {count}:  # all rows have `count` numbers
            matching.append(form)
    return matching


def _first_row(lines: list[str], start: int, form: NumberForm) -> int:
    """Index of the first row of the table, which may lie above `start`.

    The row is the highest line with as many numbers as the line at `start`, in the same
    form. Lines with fewer or more numbers, such as a row in which channels are missing,
    may stand between the two. The search upwards ends at a line of words, which belongs
    to the head, but not at a blank line. A table of one column begins at `start`.
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
    """The form of a table, from the forms `matching` its first rows.

    A form that finds several numbers in the line at `start` is preferred to a form that
    finds a single number. If the numbers fit both decimal signs, the sign is a comma if
    the table has a comma anywhere, else a point. FileFormatError if commas may separate
    numbers or be decimal signs, and the last head has not as many commas as the line.
    """
    line = lines[start]
    # Forms that find a single number are used only if no form finds several.
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
        # A form that finds a single number is in `matching`, but not in `several`: the
        # comma may be its decimal sign. But commas separate columns if the last head
        # has as many commas as the line.
        may_be_decimal = len(several) < len(matching)
        commas = COMMA_COLUMNS.count_numbers(line) - 1
        if may_be_decimal and last_head.count(",") != commas:
            raise FileFormatError(
                f"line {start + 1}: {shown(line)} may be two numbers or a "
                'decimal comma; give decimal="." or decimal=","'
            )
        return COMMA_COLUMNS
    # Here commas do not separate cells, or only beside quoted numbers: a comma anywhere
    # in the table, also far below, is a decimal sign.
    sign = "."
    if survey.last_comma_line >= start:
        sign = ","
    for form in several:
        if form.decimal == sign:
            return form
    return several[0]


def _why_none(lines: list[str], forms: list[NumberForm]) -> str:
    """End of the message that no table is found: the reason and a remedy.

    The reason is one of three: all lines are blank; the line in the middle has a cell
    that is not a number; this line has numbers only, but a line below it has not as
    many. The line is read in the form that finds most numbers in it.
    """
    filled = [i for i, line in enumerate(lines) if line.strip()]
    if not filled:
        return "; export it as text, with one row for each sample"
    middle = filled[len(filled) // 2]
    line = lines[middle]

    def cells_that_are_numbers(form: NumberForm) -> int:
        """Number of cells of the line that are numbers in a form."""
        return sum(map(form.is_number, form.cells(line)))

    form = max(forms, key=cells_that_are_numbers)
    count = form.count_numbers(line)  # 0 if a cell is not a number
    if count:  # the line matches, so the fault is in one of the next lines
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
