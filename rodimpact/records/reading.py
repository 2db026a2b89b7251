"""Signals from the text tables of laboratory instruments.

Delimiter, decimal sign, encoding and heads are taken from the file if they are unambiguous there.
Otherwise an error asks for them; nothing is guessed.
"""

import codecs
import csv
import math
import os
import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import suppress
from itertools import islice, zip_longest
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from .. import units as known_units
from ..methods import memory
from ..model.arguments import one_of, single
from ..model.frozen import Problems, nearest, raise_noted, refusal
from ..model.quantities import Floats
from ..progress import Progress, ProgressFunction, Report, check_progress
from ..storage.reading import FileFormatError, open_regular
from ..storage.tables import TIMES
from ..storage.writing import PathLike
from ..units import one_line, shown
from .instruments import as_table
from .signal import EVEN, Signal

NO_TEXT = "is not text (it contains the character NUL); export it as text, in UTF-8"
SURE = 3  # rows of numbers that begin a table
GAP = 1.5  # steps from which on samples are missing
HELD = 8  # samples in a row at the largest value, and
LONGER = 4  # times as many as at any other: a recorder at its limit
BLOCK = (
    1 << 17
)  # characters: the most before the numbers, and between two reports of progress
TIMES_FILE = 4  # bytes of memory for each byte of a table
WORDS = {
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
_NUMBER = r"[+-]?(?:\d+(?:{0})?|{1})(?:[eE][+-]?\d+)?|(?i:[+-]?(?:nan|inf(?:inity)?))"
_THOUSANDS = {
    ".": re.compile(r"[+-]?[1-9]\d{0,2}(\.\d{3})+"),
    ",": re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+"),
}
_QUOTED = re.compile(r'"[+-]?\d*,\d+(?:[eE][+-]?\d+)?"')
_LINE = re.compile(r".*\n|.+")
_NUMBERS = {
    ".": re.compile(_NUMBER.format(r"\.\d*", r"\.\d+")),
    ",": re.compile(_NUMBER.format(r",\d+", r",\d+")),
}


class ClippedSignal(UserWarning):
    """A channel stays at its largest value for long: the recorder may have clipped it.

    Examples
    --------
    >>> import pathlib, tempfile, warnings, rodimpact as ri
    >>> rows = [f"{i}e-6,{min(i % 50, 20)}" for i in range(200)]
    >>> with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(record=True) as told:
    ...     warnings.simplefilter("always")
    ...     path = pathlib.Path(folder, "shot.csv")
    ...     _ = path.write_text(chr(10).join(["t [s],bar [V]", *rows]))
    ...     record = ri.read_signals(path)
    >>> [each.category.__name__ for each in told]
    ['ClippedSignal']
    """


class _Form(NamedTuple):
    """How a line is cut into numbers: delimiter, "" for blanks, and decimal sign."""

    delimiter: str
    decimal: str

    @property
    def to_points(self) -> dict[int, int]:
        """For `str.translate`: commas and points change places if the comma is the decimal sign."""
        return str.maketrans(",.", ".,") if self.decimal == "," else {}

    def row(self, line: str) -> str:
        """The line without delimiters at its end."""
        return line.rstrip(f"{self.delimiter} \t\n")

    def cells(self, line: str) -> list[str]:
        line = self.row(line)
        if not self.delimiter:
            return line.split()
        row = line.split(self.delimiter)
        if '"' in line:
            with suppress(csv.Error):  # a cell without an end
                row = next(csv.reader([line], delimiter=self.delimiter), [])
        return [cell.strip() for cell in row]

    def numbers(self, line: str) -> int:
        """How many numbers the line has; 0 if it has anything else."""
        cells = self.cells(line)
        return len(cells) if all(map(self.is_number, cells)) else 0

    def is_number(self, cell: str) -> bool:
        return _NUMBERS[self.decimal].fullmatch(cell) is not None


COMMAS = _Form(",", ".")
QUOTED = _Form(",", ",")
"""Commas between cells and in numbers, which have quotes around them then."""
FORMS = [_Form(delimiter, decimal) for delimiter in ("\t", ";", "") for decimal in ".,"]
FORMS[4:4] = QUOTED, COMMAS


def read_signals(
    path: PathLike,
    *,
    time: str | None = None,
    time_unit: str | None = None,
    rate: float | None = None,
    units: str | Mapping[str, str] | None = None,
    decimal: str | None = None,
    progress: bool | ProgressFunction = True,
) -> dict[str, Signal]:
    r"""Read the channels of a table of text.

    Columns are separated by tabs, semicolons, commas or blanks. The decimal sign is a point or a
    comma; if commas separate columns, numbers with a decimal comma must be in quotes: ``0,"1,5"``.
    The text is UTF-8, UTF-16 with a byte order mark, or Latin-1. Any lines may precede the numbers.
    A unit is part of the head, ``incident [mV]``, ``incident (mV)``, ``incident_mV`` or ``incident
    / mV``, or is in a separate line below; the values are converted to SI units. In files of
    LabVIEW (.lvm) and Tektronix, separate lines with units and time steps are read, too. Other
    lines before the table are ignored: give a time step or a unit from there as an argument.

    Parameters
    ----------
    path : str or path
    time : str, optional
        Head of the column of times; by default ``time`` or ``t``. Without heads the times are the
        first column.
    time_unit : str, optional
        ``"s"``, ``"ms"``, ``"us"`` or ``"ns"``; needed if the head has no unit.
    rate : float, optional
        Sampling rate, Hz, of a table without times; its first sample is at t = 0.
    units : str or mapping, optional
        Unit of all channels, or a unit for each channel name. These units replace those of the
        heads. A channel without any unit is dimensionless.
    decimal : str, optional
        ``"."`` or ``","``; needed if the file is ambiguous: 0,1 may be two numbers, and 1,234 may
        be a number of thousands.
    progress : bool or function
        Whether a bar may show how far reading is. A function is called with the number of
        characters read so far, and of all.

    Returns
    -------
    dict
        A `Signal` for each channel, by name, in the order of the columns; without heads the names
        are ``"1"``, ``"2"`` and so on.

    Warns
    -----
    ClippedSignal
        If a channel stays for long at its largest value, and at no other value.

    Raises
    ------
    FileFormatError
        If the file is not such a table. The error names line and column of a cell that is not a
        number, of a time that does not increase, or of missing samples.
    ValueError
        If an argument is invalid. OSError If the file cannot be read at all.
    MemoryError
        If four times the size of the file exceeds half of the memory of the machine.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     shot = pathlib.Path(folder, "shot.txt")
    ...     _ = shot.write_text("Shot 12\nt (us); bar (mV)\n-0,5; 1,25\n0,0; 2,5\n")
    ...     bar = read_signals(shot)["bar"]
    >>> bar.times.tolist(), bar.values.tolist(), bar.unit
    ([-5e-07, 0.0], [0.00125, 0.0025], 'V')
    """
    if decimal is not None:
        one_of("decimal", decimal, (".", ","))
    if rate is not None:
        rate = single("rate", rate, "Hz", "positive")
        if time is not None or time_unit is not None:
            raise refusal("rate", "give either rate or a column of times, not both")
    problems: Problems = []
    check_progress(problems, progress)
    raise_noted(problems)
    with open_regular(path) as file:
        memory.check_file(
            file.name,
            TIMES_FILE * os.fstat(file.fileno()).st_size,
            "cut it into shorter records",
        )
        try:
            with Progress(progress, "reading", "characters") as report:
                table = _Table(_text(file), decimal, report)
            return table.signals(time, time_unit, rate, units)
        except FileFormatError as error:
            raise FileFormatError(str(error), os.fspath(path)) from None


class _Table:
    """Names, units and numbers of the columns of a text, which is cut into numbers by blocks."""

    def __init__(self, text: str, decimal: str | None, report: Report) -> None:
        text, said = as_table(text)
        self.text = text
        lines = text[:BLOCK].split("\n")
        if len(text) > BLOCK:
            lines.pop()  # it goes on
        self.form, before = _form_of(lines, text, decimal)
        self.count, self.first = self.form.numbers(lines[before]), before + 1
        self.start = sum(len(line) + 1 for line in lines[:before])
        heads = [*lines[:before], said] if said else lines[:before]
        self.names, self.units = _heads(heads, self.form, self.count)
        delimiter = self.form.delimiter.translate(self.form.to_points) or None
        try:
            rows: Any = np.loadtxt(
                self._plain(report),
                delimiter=delimiter,
                comments=None,
                quotechar='"',
                ndmin=2,
            )
        except ValueError:
            rows = np.empty((0, 0))
        if rows.shape[1] != self.count or not np.isfinite(rows).all():
            rows = np.array([self._checked(i, row) for i, row in self._rows()])
        self.columns = rows.T
        if decimal is None and self.form != COMMAS:
            self._check_decimal()

    def _rows(self) -> Iterator[tuple[int, str]]:
        """Number and text of each line from the first row on that is not empty."""
        for i, line in enumerate(_LINE.finditer(self.text, self.start), self.first):
            if row := self.form.row(line[0]):
                yield i, row

    def _plain(self, report: Report) -> Iterator[str]:
        """Rows with decimal points."""
        reported = 0
        done = self.start
        for _, row in self._rows():
            yield row.translate(self.form.to_points)
            done += len(row) + 1
            if done > reported + BLOCK:
                reported = done
                report(done, len(self.text))

    def _checked(self, i: int, text: str) -> list[float]:
        """Numbers of line i; FileFormatError with the place of what is none."""
        cells = self.form.cells(text)
        if len(cells) > self.count:
            raise FileFormatError(
                f"line {i}: has {len(cells)} columns, the lines above have "
                f"{self.count}; complete or remove it"
            )
        numbers = []
        for name, cell in zip_longest(self.names, cells, fillvalue=""):
            number = (
                float(cell.replace(",", ".")) if self.form.is_number(cell) else math.nan
            )
            if not math.isfinite(number):
                raise FileFormatError(
                    f"line {i}, column {shown(name)}: must be a finite number, "
                    f"got {shown(cell)}; complete or remove the line"
                )
            numbers.append(number)
        return numbers

    def _check_decimal(self) -> None:
        """Refuse numbers that may be thousands or parts of one: all are like 1,234."""
        sign = self.form.decimal
        whole = _THOUSANDS[sign].fullmatch
        cells = (
            cell
            for _, row in self._rows()
            if sign in row
            for cell in self.form.cells(row)
            if sign in cell
        )
        first = next(cells, "")
        if whole(first) and all(map(whole, cells)):
            raise FileFormatError(
                f'has numbers such as {shown(first)}: "{sign}" may be a decimal sign or separate '
                f'thousands; give decimal="{sign}" if a decimal sign, otherwise write the '
                "numbers without it"
            )

    def _line(self, row: int) -> int:
        """Number of the line in which a row stands."""
        return next(islice(self._rows(), row, None))[0]

    def signals(
        self, time: str | None, time_unit: str | None, rate: float | None, units: Any
    ) -> dict[str, Signal]:
        """Signal of each channel."""
        if self.columns.shape[1] < 2:
            raise FileFormatError(
                "has one line of numbers; a signal needs two samples or more"
            )
        named = [name for name in self.names if TIMES.fullmatch(name)]
        if rate is None:
            first = (
                ["1"] if self.names[0] == "1" else named
            )  # the first column without heads
            found = first if time is None else [time]
            if len(found) != 1 or found[0] not in self.names or self.count < 2:
                heads = ", ".join(map(shown, self.names[:8]))
                raise FileFormatError(
                    f"must have one column called {shown(time or 'time')} and another one, has "
                    f"{heads}; give the head of one as time=, or give rate=, the sampling rate in "
                    "Hz"
                )
            clock = self.names.index(found[0])
            times = self._times(clock, time_unit)
        elif named:
            raise FileFormatError(
                f"has a column of times, {shown(named[0])}; leave rate out"
            )
        else:
            clock, times = -1, np.arange(self.columns.shape[1]) / rate
        channels = {name: j for j, name in enumerate(self.names) if j != clock}
        if not isinstance(units, Mapping):
            units = dict.fromkeys(channels, units)
        for name in units:
            if name not in channels:
                raise refusal(
                    "units",
                    f"there is no channel {shown(name)}; {nearest(name, channels)}",
                )
        signals = {}
        for name, j in channels.items():
            unit = self.units[j] if units.get(name) is None else units[name]
            values, si = self._in_si(j, unit, "units")
            self._warn_if_clipped(j)
            signals[name] = Signal(values, times, unit=si, name=name)
        return signals

    def _in_si(self, column: int, unit: Any, option: str) -> tuple[Any, str]:
        """Numbers of a column in SI units, and their unit."""
        try:
            return known_units.in_si(self.columns[column], unit)
        except ValueError as error:
            name = shown(self.names[column])
            raise FileFormatError(f"column {name}: {error}; give {option}=") from None

    def _times(self, column: int, unit: str | None) -> Floats:
        """Times in s, increasing and without gaps."""
        name = shown(self.names[column])
        times, si = self._in_si(column, unit or self.units[column], "time_unit")
        if si != "s":
            raise FileFormatError(
                f"column {name}: has no unit of time; give time_unit=, one of 's', 'ms', 'us', "
                "'ns', or give the head of the column of times as time="
            )
        steps = np.diff(times)
        usual = np.median(steps)
        uneven = np.mean(np.abs(steps - usual) > EVEN * usual) >= 0.1
        for wrong, message in (
            (
                steps <= 0,
                "times must increase; if the times have too few digits, remove the column "
                "and give rate",
            ),
            (
                (steps > GAP * usual) & ~uneven,
                "samples are missing; cut the record there, or fill in the samples",
            ),
        ):
            if wrong.any():
                i = int(wrong.argmax())
                raise FileFormatError(
                    f"line {self._line(i + 1)}, column {name}: {times[i + 1]:.9g}"
                    f" s comes after {times[i]:.9g} s; {message}"
                )
        return times  # type: ignore[no-any-return]

    def _warn_if_clipped(self, column: int) -> None:
        values = self.columns[column]
        starts = np.flatnonzero(np.diff(values, prepend=np.nan))
        lengths, held = np.diff(starts, append=len(values)), values[starts]
        limit = ((held == values.max()) | (held == values.min())) & (held != values[0])
        i = int(np.where(limit, lengths, 0).argmax())
        if limit[i] and lengths[i] >= max(HELD, LONGER * lengths[~limit].max()):
            warnings.warn(
                f"column {shown(self.names[column])} stays at {held[i]:.6g} for {lengths[i]} "
                f"samples from line {self._line(int(starts[i]))} on: the recorder may have "
                "clipped it",
                ClippedSignal,
                stacklevel=4,
            )


def _text(file: BinaryIO) -> str:
    """The text of a file, with one character at the end of each line."""
    data = file.read()
    marked = data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
    try:
        text = data.decode("utf-16" if marked else "utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    if "\0" in text:
        raise FileFormatError(NO_TEXT)
    del data
    return text.replace("\N{MINUS SIGN}", "-").replace("\r\n", "\n").replace("\r", "\n")


def _form_of(lines: list[str], text: str, decimal: str | None) -> tuple[_Form, int]:
    """How the lines of a text are cut into numbers, and the first line of numbers."""
    forms = [
        form
        for form in FORMS
        if decimal in (None, form.decimal) and (form != QUOTED or _QUOTED.search(text))
    ]
    found: list[_Form] = []
    for start in range(len(lines)):
        # so many lines from there on, or all that follow, have equally many numbers
        rows = [line for line in lines[start : start + 2 * SURE] if line.strip()][:SURE]
        if found := [
            form
            for form in forms
            if (count := form.numbers(lines[start]))
            and all(form.numbers(row) == count for row in rows)
        ]:
            break
    else:
        raise FileFormatError(f"has no table of numbers{_why_none(lines, forms)}")
    line = lines[start]
    # where the first rows are whole numbers, later ones tell the decimal sign
    sign = "," if text.find(",", sum(map(len, lines[:start])) + start) >= 0 else "."
    # a line of one number is that number only if no form finds more
    several = [form for form in found if form.numbers(line) > 1] or found
    form = next((form for form in several if form.decimal == sign), several[0])
    if several[0] == COMMAS:
        form = COMMAS
        last = next(filter(str.strip, reversed(lines[:start])), "")  # of the heads
        if len(several) < len(found) and last.count(",") != form.numbers(line) - 1:
            raise FileFormatError(
                f"line {start + 1}: {shown(line)} may be two numbers or a "
                'decimal comma; give decimal="." or decimal=","'
            )
    count = form.numbers(line)
    alike = (i for i in range(start) if form.numbers(lines[i]) == count > 1)
    return form, next(alike, start)


def _why_none(lines: list[str], forms: list[_Form]) -> str:
    """What keeps a line in the middle of the file from being numbers, and the remedy."""
    filled = [i for i, line in enumerate(lines) if line.strip()]
    if not filled:
        return "; export it as text, with one row for each sample"
    i = filled[len(filled) // 2]
    form = max(forms, key=lambda form: sum(map(form.is_number, form.cells(lines[i]))))
    if count := form.numbers(
        lines[i]
    ):  # then a line below it keeps it from being the first row
        return (
            f": line {i + 1} has {count} numbers, but not all lines below it; every line needs "
            "a number for each column"
        )
    odd = next(cell for cell in form.cells(lines[i]) if not form.is_number(cell))
    return (
        f": line {i + 1} has {shown(odd)}; below the heads write only numbers, in columns "
        "separated by tabs, semicolons, commas or blanks, times in seconds, and no separators "
        "of thousands"
    )


def _heads(lines: list[str], form: _Form, count: int) -> tuple[list[str], list[str]]:
    """Names and units of the columns, from the lines before the numbers."""
    texts = {
        i: text for i, line in enumerate(lines, 1) if (text := line.strip("#%/ \t\r;,"))
    }
    rows = [
        row
        for row in (_head_cells(text, form, count) for text in texts.values())
        if len(row) == count and all(row)
    ]
    if not rows:
        given = form.cells(texts.popitem()[1]) if texts else []
        if form.delimiter and min(count, len(given)) > 1:
            raise FileFormatError(
                f"has the {len(given)} heads {shown(given)} for {count} columns "
                "of numbers; name each column"
            )
        return [str(j + 1) for j in range(count)], [""] * count
    if count > 1 and form.is_number(rows[-1][0]):
        raise FileFormatError(
            f"begins with a line that mixes {shown(rows[-1])} and numbers; complete or remove it"
        )
    below = [_spelt(cell.strip("[]() ")) for cell in rows[-1]]
    alone = len(rows) > 1 and all(
        known_units.conversion(unit) is not None for unit in below
    )
    names, inside = zip(*map(_name_and_unit, rows[-2 if alone else -1]), strict=True)
    if double := [name for name in names if names.count(name) > 1]:
        raise FileFormatError(f"has two columns called {shown(double[0])}; rename one")
    return list(names), below if alone else list(inside)


def _head_cells(text: str, form: _Form, count: int) -> list[str]:
    """Heads in a line; between blanks, a unit in brackets belongs to what is before it."""
    cells = form.cells(text)
    if not form.delimiter and len(cells) != count:
        joined = re.sub(r"\s+([\[(])", r"\1", text).split()
        cells = joined if len(joined) == count else re.split(r"\s{2,}|\t", text)
    if (
        len(cells) == count + 1 and cells[-1].casefold() == "comment"
    ):  # of LabVIEW, without entries
        cells.pop()
    return cells


def _spelt(unit: str) -> str:
    """A unit as it is known here."""
    return WORDS.get(unit.casefold(), unit)


def _name_and_unit(head: str) -> tuple[str, str]:
    """Name of a column and its unit, "" if it has none."""
    head = head.strip(" \"'")
    if found := re.fullmatch(r"(.*?)[\s_/,]*[\[(]([^\[\]()]*)[\])]", head):
        return one_line(found[1] or found[2]), _spelt(found[2].strip()) if found[
            1
        ] else ""
    if (
        found := re.fullmatch(r"(.*?)\s*(?:/|\bin\b|_|,|\s)\s*([^\s_/,]+)", head)
    ) and found[1]:
        si = known_units.conversion(unit := _spelt(found[2]))
        if si and known_units.dimension_of(si.unit) in MEASURED and unit != "1":
            return one_line(found[1]), unit
    return one_line(head), ""
