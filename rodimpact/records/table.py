"""A table of numbers in a text file: column by column, in blocks of rows.

Only the columns and one block of rows are in memory at a time.
"""

import math
import re
from collections.abc import Iterator
from itertools import islice, zip_longest
from typing import BinaryIO

import numpy as np

from ..model.quantities import Floats
from ..progress import ProgressReport
from ..storage.reading import FileFormatError
from ..units import shown
from .heads import heads_of
from .instruments import find_layout
from .number_forms import COMMA_COLUMNS, find_table
from .text_file import TextFile

BLOCK_ROWS = 4096
"""Number of rows that are converted to numbers at a time."""
REMEDY = "correct the line, or cut the record before it"
"""Remedy for a wrong line. Without this line alone, a sample would be missing."""
THOUSANDS = {
    ".": re.compile(r"[+-]?[1-9]\d{0,2}(\.\d{3})+"),
    ",": re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+"),
}
"""Patterns of numbers whose sign may separate thousands or be a decimal sign: 1,234."""


class Table:
    """Names, units and numbers of the columns of a text file.

    Parameters
    ----------
    file : binary file
    decimal : str, optional
        The decimal sign, if the user gave it.
    report : function
        It is called with the number of characters read so far and the total number.

    Raises
    ------
    FileFormatError
        If there is no table, or it is incomplete; the error names line and column.

    Attributes
    ----------
    names, units : list of str
        Name and unit of each column.
    columns : list of array, shape (rows,)
        Numbers of each column; a column that ends with blank cells is shorter. To save
        memory, the reader may replace a column that is no longer needed.
    """

    def __init__(
        self, file: BinaryIO, decimal: str | None, report: ProgressReport
    ) -> None:
        """Find the table and its heads in the first lines, and read all columns.

        `decimal` is the decimal sign that the user gave, or None. `report` is called
        with the number of characters read so far and the total number. FileFormatError
        if there is no table, for a wrong cell, and if the decimal sign is ambiguous.
        """
        self._text = TextFile(file)
        survey = self._text.survey
        head = survey.head.split("\n")  # the first lines
        layout = find_layout(head)
        if survey.characters > len(survey.head):
            head.pop()  # the last line, which the end of the head may cut off
        self._table_line = layout.table_line
        lines = [layout.table_line(i, line) for i, line in enumerate(head)]
        start = find_table(lines, survey, decimal)
        self._form = start.form
        self._first = start.line  # index of the first row of numbers
        self._count = self._form.count_numbers(lines[start.line])  # of columns
        self._has_blanks = False  # whether a cell is blank; `_checked` sets it
        above = lines[: start.line]
        # `heads_of` looks at the last lines first: the head from entries comes last.
        if layout.head:
            above.append(layout.head)
        heads = heads_of(above, self._form, self._count)
        self.names = [head.name for head in heads]
        self.units = [head.unit for head in heads]
        self.columns = self._read_columns(report)
        # If commas separate cells, a point is the decimal sign for certain.
        if decimal is None and self._form != COMMA_COLUMNS:
            self._check_decimal()

    def place_of(self, row: int) -> str:
        """Name of the line of a row, such as "line 12".

        Rows count from 0, and lines of the file from 1.
        """
        number, _ = next(islice(self._rows(), row, None))
        return f"line {number}"

    def _rows(self) -> Iterator[tuple[int, str]]:
        """Yield number, from 1, and text of each line of the table, without line end.

        Blank lines, and lines with nothing but delimiters, are left out.
        """
        lines = islice(enumerate(self._text.lines()), self._first, None)
        for index, line in lines:
            table_line = self._table_line(index, line)
            row = self._form.row(table_line)
            if row:
                yield index + 1, row

    def _read_columns(self, report: ProgressReport) -> list[Floats]:
        """Numbers of each column, read in blocks of rows.

        Blank cells at the end of a column are cut off. FileFormatError for a cell that
        is not a finite number, and for a blank cell elsewhere. `report` is called with
        the number of characters read so far and the total number.
        """
        survey = self._text.survey
        most_rows = survey.lines - self._first  # fewer if there are blank lines
        # Filled block by block; the unused ends are cut off below.
        columns = [np.empty(most_rows) for _ in range(self._count)]
        rows = self._rows()
        filled = 0  # number of rows read so far
        characters = 0
        while block := list(islice(rows, BLOCK_ROWS)):
            numbers = self._numbers_in(block)  # [row, column]
            for column, part in zip(columns, numbers.T, strict=True):
                column[filled : filled + len(block)] = part
            filled += len(block)
            characters += sum(len(row) + 1 for _, row in block)  # with the line end
            report(min(characters, survey.characters), survey.characters)
        for column in columns:
            column.resize(filled, refcheck=False)  # removes the rows of blank lines
        if self._has_blanks:
            self._cut_blank_ends(columns)
        return columns

    def _cut_blank_ends(self, columns: list[Floats]) -> None:
        """Shorten each column, in place, by the blank cells (NaN) at its end.

        FileFormatError if a number comes after a blank cell, and for a column that has
        only blank cells.
        """
        for name, column in zip(self.names, columns, strict=True):
            is_blank = np.isnan(column)
            # `argmin` finds the last number, counted from the end. It is 0 if all cells
            # are blank; the next check then refuses the column.
            blanks_at_end = int(is_blank[::-1].argmin())
            count = len(column) - blanks_at_end
            if is_blank[:count].any():
                place = self.place_of(int(is_blank.argmax()))
                raise self._invalid_cell(place, name, "")
            column.resize(count, refcheck=False)

    def _numbers_in(self, block: list[tuple[int, str]]) -> Floats:
        """Numbers of some rows, [row, column], with NaN for a blank cell.

        `block` has the number of the line and the text of each row. FileFormatError for
        a cell that is not a finite number, and for a row with too many cells.
        """
        to_points = self._form.to_points
        delimiter = None  # for `loadtxt`: any number of blanks
        if self._form.delimiter:
            # `to_points` makes a comma a point in the rows, so in the delimiter, too.
            delimiter = self._form.delimiter.translate(to_points)
        try:
            numbers: Floats = np.loadtxt(
                [row.translate(to_points) for _, row in block],
                delimiter=delimiter,
                comments=None,
                quotechar='"',
                ndmin=2,
            )
        except ValueError:
            numbers = np.empty((0, 0))  # incomplete, see the next check
        is_complete = numbers.shape == (len(block), self._count)
        if not is_complete or not np.isfinite(numbers).all():
            # Slower, cell by cell: this accepts blank cells, and the error names the
            # first wrong cell.
            return np.array([self._checked(line, row) for line, row in block])
        return numbers

    def _checked(self, line: int, row: str) -> list[float]:
        """Numbers of a row, with NaN for a blank cell.

        Missing cells at the end count as blank; a blank cell sets `_has_blanks`.
        FileFormatError, with the number `line`, for a cell that is not a finite number,
        and for more cells than columns.
        """
        cells = self._form.cells(row)
        if len(cells) > self._count:
            raise FileFormatError(
                f"line {line}: has {len(cells)} columns, the lines above have "
                f"{self._count}; {REMEDY}"
            )
        numbers = []
        for name, cell in zip_longest(self.names, cells, fillvalue=""):
            number = math.nan
            if self._form.is_number(cell):
                number = float(cell.replace(",", "."))  # also from a decimal comma
            if not cell:
                self._has_blanks = True
            elif not math.isfinite(number):
                raise self._invalid_cell(f"line {line}", name, cell)
            numbers.append(number)
        return numbers

    @staticmethod
    def _invalid_cell(place: str, name: str, cell: str) -> FileFormatError:
        """The error for a cell that is not a finite number, with line and column."""
        return FileFormatError(
            f"{place}, column {shown(name)}: must be a finite number, "
            f"got {shown(cell)}; {REMEDY}"
        )

    def _check_decimal(self) -> None:
        """Raise FileFormatError if all numbers with the decimal sign are like 1,234.

        The sign may then separate thousands. A single number of another pattern proves
        that it is a decimal sign. Numbers without the sign prove nothing.
        """
        sign = self._form.decimal
        first = ""  # the first cell with the sign
        for cell in self._cells_with(sign):
            if not first:
                first = cell
            if not THOUSANDS[sign].fullmatch(cell):
                return
        if first:
            raise FileFormatError(
                f'has numbers such as {shown(first)}: "{sign}" may be a decimal sign '
                f'or separate thousands; give decimal="{sign}" if a decimal sign, '
                "otherwise write the numbers without it"
            )

    def _cells_with(self, sign: str) -> Iterator[str]:
        """Yield the cells of the table that contain a sign."""
        for _, row in self._rows():
            if sign not in row:
                continue
            for cell in self._form.cells(row):
                if sign in cell:
                    yield cell
