"""Signals from the text tables of laboratory instruments.

Delimiter, decimal sign, encoding and heads are taken from the file if they are
unambiguous there. Otherwise an error asks for them; nothing is guessed. The modules and
what each of them finds::

    file -> text_file: lines -> instruments: lines of the table -> number_forms: cells
         -> heads: names and units -> table: columns -> sample_times -> signals

A workbook is converted to text first. A TDMS file contains columns, names and units.
"""

import os
import warnings
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from typing import Any, BinaryIO, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .. import units as known_units
from ..hints import explain_arguments, nearest
from ..methods import memory
from ..model.arguments import check_choice, check_text, scalar
from ..model.frozen import Problems, invalid_argument, raise_if_problems
from ..model.quantities import Floats
from ..progress import Progress, ProgressFunction, ProgressReport, check_progress
from ..storage.reading import FileFormatError, open_regular
from ..storage.tables import TIMES
from ..storage.writing import PathLike
from ..units import shown
from .sample_times import checked_times
from .signal import Signal, signal_of
from .table import REMEDY, Table
from .tdms import ENDING as TDMS_ENDING
from .tdms import read_tdms
from .workbook import is_workbook, text_of_workbook

MIN_CLIPPED_SAMPLES = 8
"""Least length of a run of equal samples at the largest value of a clipped record."""
MIN_CLIPPED_RATIO = 4
"""Least ratio of the length of this run to that of the longest run at another value."""
BLOCK_SAMPLES = 1 << 16
"""Number of samples that are searched for runs of equal samples at a time."""
MEMORY_RATIO = 4
"""Bytes of memory needed for each byte of a file."""

Ints: TypeAlias = NDArray[np.intp]


class ClippedSignal(UserWarning):
    """A channel stays at its largest value for long: the recorder may have clipped it.

    Examples
    --------
    >>> import pathlib, tempfile, warnings, rodimpact as ri
    >>> rows = [f"{i}e-6,{min(i % 50, 20)}" for i in range(200)]
    >>> catching = warnings.catch_warnings(record=True)
    >>> with tempfile.TemporaryDirectory() as folder, catching as told:
    ...     warnings.simplefilter("always")
    ...     path = pathlib.Path(folder, "shot.csv")
    ...     _ = path.write_text(chr(10).join(["t [s],bar [V]", *rows]))
    ...     record = ri.read_signals(path)
    >>> [each.category.__name__ for each in told]
    ['ClippedSignal']
    """


@explain_arguments
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
    r"""Read the channels of a table of text, of a workbook or of a TDMS file.

    Columns are separated by tabs, semicolons, commas or blanks. The decimal sign is a
    point or a comma; if commas separate columns, numbers with a decimal comma must be
    in quotes: ``0,"1,5"``. The text is UTF-8, UTF-16 with a byte order mark, or
    Latin-1. Any lines may precede the numbers. A unit is part of the head,
    ``incident [mV]``, ``incident (mV)``, ``incident_mV`` or ``incident / mV``, or is in
    a separate line below; the values are converted to SI units. In files of LabVIEW
    (.lvm), Tektronix, Rigol, LeCroy, Yokogawa, Keysight and catman, separate lines with
    units and time steps are read, too. If the last line of heads repeats a name, the
    names are those of the line above. Other lines before the table are ignored: give a
    time step or a unit from there as an argument. A channel that ends with blank cells
    is shorter than the others.

    A workbook (.xlsx, .xlsm, .xls; extra ``excel``) has the table in its first sheet.
    Channels of a TDMS file (extra ``tdms``) have their times and units in properties.

    Parameters
    ----------
    path : str or path
    time : str, optional
        Head of the column of times; by default ``time`` or ``t``. Without heads the
        times are the first column that increases throughout.
    time_unit : str, optional
        ``"s"``, ``"ms"``, ``"us"`` or ``"ns"``; needed if the head has no unit.
    rate : float, optional
        Sampling rate, Hz, of a table without times; its first sample is at t = 0.
    units : str or mapping, optional
        Unit of all channels, or a unit for each channel name. These units replace those
        of the heads. A channel without any unit is dimensionless.
    decimal : str, optional
        ``"."`` or ``","``; needed if the file is ambiguous: 0,1 may be two numbers, and
        1,234 may be a number of thousands.
    progress : bool or function
        Whether to show a progress bar. A function is called with the number of
        characters read so far and the number of all characters.

    Returns
    -------
    dict
        A `Signal` for each channel, by name, in the order of the columns; without heads
        the names are ``"1"``, ``"2"`` and so on.

    Warns
    -----
    ClippedSignal
        If a channel stays for long at its largest or smallest value, and at no other.
    RoundedTimes
        If the times have too few digits. They are replaced by equal steps, which agree
        with them to the last digit.

    Raises
    ------
    FileFormatError
        If the file is not such a table. The error names line and column of a cell that
        is not a number, of a time that does not increase, or of missing samples.
    ValueError
        If an argument is invalid.
    ImportError
        If the package that reads a workbook or a TDMS file is missing.
    OSError
        If the file cannot be read at all.
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
        check_choice("decimal", decimal, (".", ","))
    if time is not None:
        check_text("time", time, "time")
    if time_unit is not None:
        check_text("time_unit", time_unit, "us")
    if rate is not None:
        rate = scalar("rate", rate, "Hz", "positive")
        if time is not None or time_unit is not None:
            raise invalid_argument(
                "rate", "give either rate or a column of times, not both"
            )
    problems: Problems = []
    check_progress(problems, progress)
    raise_if_problems(problems)
    with open_regular(path) as file:
        memory.check_file(
            file.name,
            MEMORY_RATIO * os.fstat(file.fileno()).st_size,
            "cut it into shorter records",
        )
        try:
            # Messages name lines, for which they read the text of a workbook again: it
            # stays open until the signals are made.
            with ExitStack() as opened:
                with Progress(progress, "reading", "characters") as report:
                    table = _table_in(file, decimal, report, opened)
                return _signals(table, time, time_unit, rate, units)
        except FileFormatError as error:
            raise FileFormatError(str(error), os.fspath(path)) from None


class ColumnTable(Protocol):
    """Columns with names and units: a `Table`, or the table of a TDMS file."""

    @property
    def names(self) -> list[str]:
        """Name of each column."""

    @property
    def units(self) -> list[str]:
        """Unit of each column, "" if it has none."""

    @property
    def columns(self) -> list[Floats]:
        """Numbers of each column, [row]; a list whose items may be replaced."""

    def place_of(self, row: int) -> str:
        """Name of the line or sample of a row in messages; rows count from 0."""


def _table_in(
    file: BinaryIO, decimal: str | None, report: ProgressReport, opened: ExitStack
) -> ColumnTable:
    """The table in a file, which may be a text, a workbook or a TDMS file.

    `decimal`, the decimal sign that the user gave or None, is used for a text only; the
    converted workbook has decimal points. `opened` closes the converted text later.
    """
    if os.fspath(file.name).casefold().endswith(TDMS_ENDING):
        return read_tdms(file)
    if is_workbook(file):
        sheet = opened.enter_context(text_of_workbook(file))
        return Table(sheet, ".", report)
    return Table(file, decimal, report)


def _signals(
    table: ColumnTable,
    time: str | None,
    time_unit: str | None,
    rate: float | None,
    units: Any,
) -> dict[str, Signal]:
    """Signal of each channel, by name, in SI units and over common times.

    With `rate`, Hz, the times are k/rate, from 0 on. A shorter channel has the first of
    the times. A channel that may be clipped causes a `ClippedSignal` warning. To save
    memory, the columns are removed from the table one by one. FileFormatError if a
    column has fewer than two numbers, if the times are missing or end early, or if
    there is a column of times although `rate` is given.
    """
    lengths = [len(column) for column in table.columns]
    row_count = max(lengths)
    if min(lengths) < 2:
        raise FileFormatError(
            "has one line of numbers; a signal needs two samples or more"
        )
    time_column = None
    if rate is None:
        time_column = _time_column(table, time)
    else:
        time_columns = _named_times(table)
        if time_columns:
            raise FileFormatError(
                f"has a column of times, {shown(time_columns[0])}; leave rate out"
            )
    # Index of the column of each channel, by name; without `time_column`, which is None
    # if there is a rate
    channels = {name: j for j, name in enumerate(table.names) if j != time_column}
    if time_column is not None:
        if lengths[time_column] < row_count:
            raise FileFormatError(
                f"{table.place_of(lengths[time_column])}, column "
                f"{shown(table.names[time_column])}: must be a finite number, got ''; "
                f"{REMEDY}"
            )
        times = _times(table, time_column, time_unit)
    else:
        assert rate is not None
        times = np.arange(float(row_count))
        times /= rate  # in place, to save memory
    times.flags.writeable = False
    user_units = _units_of(channels, units)
    signals = {}
    for name, j in channels.items():
        unit = user_units.get(name)
        if unit is None:
            unit = table.units[j]
        clipping = _clipping(table, j)  # "" for a channel that is not clipped
        values, si_unit = _take_in_si(table, j, unit, option="units")
        if clipping:
            # Level 4 is the user's call of `read_signals`.
            warnings.warn(clipping, ClippedSignal, stacklevel=4)
        # A shorter channel has the first of the times.
        signals[name] = signal_of(values, times[: len(values)], si_unit, name)
    return signals


def _named_times(table: ColumnTable) -> list[str]:
    """Names of columns that are called time or t."""
    return [name for name in table.names if TIMES.fullmatch(name)]


def _time_column(table: ColumnTable, time: str | None) -> int:
    """Index of the column of times.

    It is the column called `time`; if that is None, the column called time or t; in a
    table without heads, the first column that increases. FileFormatError if there is no
    such column or more than one, or if the table has no other column.
    """
    expected = "time"
    has_heads = table.names[0] != "1"  # without heads columns are called 1, 2 and so on
    if time is not None:
        candidates = [time]
        expected = time
    elif has_heads:
        candidates = _named_times(table)
    else:
        candidates = [_first_increasing(table)]
    is_single_known_column = len(candidates) == 1 and candidates[0] in table.names
    if not is_single_known_column or len(table.names) < 2:
        heads = ", ".join(map(shown, table.names[:8]))  # enough for a message
        raise FileFormatError(
            f"must have one column called {shown(expected)} and another one, has "
            f"{heads}; give the head of one as time=, or give rate=, the sampling rate "
            "in Hz"
        )
    return table.names.index(candidates[0])


def _first_increasing(table: ColumnTable) -> str:
    """Name of the first column that increases throughout, or else of the first column.

    In a table without heads it is taken as the column of times. It need not be the
    first column: some scopes write the values before the times.
    """
    for name, column in zip(table.names, table.columns, strict=True):
        if np.all(np.diff(column) > 0):
            return name
    return table.names[0]


def _units_of(channels: Mapping[str, int], units: Any) -> Mapping[str, Any]:
    """Unit that the user gave for each channel, by name of the channel.

    A single unit holds for all channels; None gives None for all. A mapping is returned
    as it is, and may lack channels. InvalidModel if it names an unknown channel.
    """
    if not isinstance(units, Mapping):
        return dict.fromkeys(channels, units)
    for name in units:
        if name not in channels:
            raise invalid_argument(
                "units",
                f"there is no channel {shown(name)}; {nearest(name, channels)}",
            )
    return units


def _take_in_si(
    table: ColumnTable, column: int, unit: Any, option: str
) -> tuple[Floats, str]:
    """Remove the numbers of a column from the table, and convert them to SI units.

    Returns the numbers, which are read-only, and their SI unit. An empty column is left
    in the table. FileFormatError for an unknown unit; its remedy names `option`, the
    argument of `read_signals` that gives a unit.
    """
    numbers = table.columns[column]
    try:
        values, si_unit = known_units.in_si(numbers, unit)
    except ValueError as error:
        name = shown(table.names[column])
        raise FileFormatError(f"column {name}: {error}; give {option}=") from None
    table.columns[column] = np.empty(0)
    values.flags.writeable = False
    return values, si_unit


def _times(table: ColumnTable, column: int, unit: str | None) -> Floats:
    """Times in s, checked by `checked_times`; the column is emptied in the table.

    `unit` is the unit that the user gave; if it is None, the unit of the column is
    used. FileFormatError if this is not a unit of time, or if the times are wrong.
    """
    name = shown(table.names[column])
    if not unit:
        unit = table.units[column]
    times, si_unit = _take_in_si(table, column, unit, option="time_unit")
    if si_unit != "s":
        raise FileFormatError(
            f"column {name}: has no unit of time; give time_unit=, one of 's', 'ms', "
            "'us', 'ns', or give the head of the column of times as time="
        )
    # Level 6 of a warning is the user's call of `read_signals`.
    return checked_times(times, name, table.place_of, stacklevel=6)


def _clipping(table: ColumnTable, column: int) -> str:
    """Sentence of the warning if a channel may be clipped, otherwise "".

    It may be clipped if it stays at its largest or smallest value for
    `MIN_CLIPPED_SAMPLES` and for `MIN_CLIPPED_RATIO` times as long as at any other
    value. The first value of the channel, that of rest, counts as one of the others.
    """
    values = table.columns[column]
    low = values.min()
    high = values.max()
    longest = 0  # number of samples of the longest run at a limit, low or high
    longest_start = 0  # index of the first sample of this run
    longest_other = 0  # number of samples of the longest run at another value
    for starts, lengths in _runs(values):
        level = values[starts]  # value of each run, [run]; so are the arrays below
        is_extreme = (level == low) | (level == high)
        at_limit = is_extreme & (level != values[0])
        lengths_at_limit = np.where(at_limit, lengths, 0)
        other_lengths = np.where(at_limit, 0, lengths)
        k = int(lengths_at_limit.argmax())
        if lengths_at_limit[k] > longest:
            longest = int(lengths[k])
            longest_start = int(starts[k])
        longest_other = max(longest_other, int(other_lengths.max()))
    if longest < max(MIN_CLIPPED_SAMPLES, MIN_CLIPPED_RATIO * longest_other):
        return ""
    return (
        f"column {shown(table.names[column])} stays at {values[longest_start]:.6g} for "
        f"{longest} samples from {table.place_of(longest_start)} on: the recorder may "
        "have clipped it"
    )


def _runs(values: Floats) -> Iterator[tuple[Ints, Ints]]:
    """Yield arrays of starts and lengths of runs of equal samples, [run], by blocks.

    A run is yielded with the block in which it ends. Nothing is yielded for a block in
    which no run ends.
    """
    count = len(values)
    begin = 0  # start of the first run that has not ended yet
    for start in range(0, count, BLOCK_SAMPLES):
        # One more sample, the first of the next block, shows a change between blocks.
        block = values[start : start + BLOCK_SAMPLES + 1]
        changes = np.flatnonzero(block[1:] != block[:-1])  # last samples, in `block`
        ends = start + 1 + changes  # index after the last sample, in `values`
        is_last_block = start + BLOCK_SAMPLES >= count
        if is_last_block:
            ends = np.append(ends, count)
        if ends.size:
            starts = np.append(begin, ends[:-1])
            yield starts, ends - starts
            begin = int(ends[-1])
