"""Entries of LabVIEW and of scopes before or beside a table, as column heads.

LabVIEW measurement files (.lvm) name units and steps of time in lines of their own, and
may leave out the column of times. Scopes of Tektronix write such lines before the
table, or in three columns to its left; those of Rigol, LeCroy, Yokogawa and Keysight
(Infiniium) before the table. An entry without a value is taken as missing.
"""

import re
from collections.abc import Callable
from itertools import zip_longest
from typing import NamedTuple

from ..storage.reading import FileFormatError
from .heads import spelt

LABVIEW = "labview measurement"
"""Entry with which files of LabVIEW begin."""
LABVIEW_HEAD = "x_value"
"""First head of the table in files of LabVIEW."""
TEKTRONIX = ("record length", "sample interval")
"""Entries of Tektronix scopes, whose files have one of them or both."""
LECROY = "LECROY"
"""Begin of the first line of LeCroy scopes, whose times are in s and values in V."""
RIGOL_HEADS = {"x", "start", "increment"}
"""Heads of Rigol scopes, in the first line."""
YOKOGAWA = {"tracename", "hresolution", "hoffset"}
"""Entries of Yokogawa scopes, whose rows have no times."""
KEYSIGHT = {"revision", "xinc", "xorg"}
"""Entries of Keysight Infiniium scopes, whose rows have a time before each value."""
KEYSIGHT_ENTRY = re.compile(r"([A-Za-z]+)\s*:\s*,?(.*)")
COLUMNS_BESIDE = 3
"""Columns of entries that Tektronix writes to the left of a table."""
MAX_ENTRY_LINES = 100
"""Lines that are searched for entries."""


class Layout(NamedTuple):
    """Where an instrument puts the table in its file.

    Attributes
    ----------
    head : str
        A line of heads; "" if the lines above the table have them.
    table_line : function
        What of a line belongs to the table: takes the index of the line and the line.
    """

    head: str
    table_line: Callable[[int, str], str]


Entries = dict[str, list[str]]
"""Values of each entry, column by column."""


def first_value(entries: Entries, name: str, default: str) -> str:
    """The first value of an entry, or a default if it is missing or empty."""
    values = entries.get(name, [])
    if values and values[0]:
        return values[0]
    return default


def as_written(_: int, line: str) -> str:
    """The whole line."""
    return line


def find_layout(lines: list[str]) -> Layout:
    """Layout of a file with these first lines.

    The instrument is known by its first line or by its entries, among the first
    `MAX_ENTRY_LINES`. If none is known, all lines are taken as they are.
    FileFormatError for a known instrument whose table cannot be read.
    """
    lines = lines[:MAX_ENTRY_LINES]
    mark = "\t"  # what parts two cells
    if "," in lines[0]:
        mark = ","
    entries: Entries = {}
    for index, line in enumerate(lines):
        cells = [cell.strip(' "') for cell in line.split(mark)]
        name = cells[0].casefold()
        entries[name] = cells[1:]
        # The row of heads stands below all entries, which are complete now.
        if name == LABVIEW_HEAD and LABVIEW in entries:
            return _labview_layout(index, cells, entries, mark)
    if lines[0].startswith(LECROY):
        return Layout(head="Time [s],Ampl [V]", table_line=as_written)
    if len(lines) > 1 and set(_cells(lines[0])) >= RIGOL_HEADS:
        return _rigol_layout(_cells(lines[0]), _cells(lines[1]))
    if entries.keys() >= YOKOGAWA:
        return _yokogawa_layout(lines, entries)
    keysight = _keysight_entries(lines)
    if keysight.keys() >= KEYSIGHT:
        return _keysight_layout(lines[0], keysight)
    is_tektronix = any(name in entries for name in TEKTRONIX)
    if is_tektronix and "horizontal units" in entries:
        is_beside = lines[0].count(",") >= COLUMNS_BESIDE
        return _tektronix_layout(entries, is_beside)
    return Layout(head="", table_line=as_written)


def _cells(line: str) -> list[str]:
    """Cells between commas, in small letters."""
    return [cell.strip(' "').casefold() for cell in line.split(",")]


def _rigol_layout(heads: list[str], entries: list[str]) -> Layout:
    """Layout of a file whose rows have a number instead of a time.

    `heads` are the cells of the first line in small letters: x, channels, start,
    increment. `entries` are those of the second one: units of the channels, the time of
    the first row and the time step. In each row the number, of a sample from 0 on,
    becomes a time. FileFormatError if the last two are no numbers.
    """
    start_column = heads.index("start")
    try:
        start = float(entries[start_column])
        step = float(entries[heads.index("increment")])
    except (ValueError, IndexError):
        raise FileFormatError(
            "has no numbers below Start and Increment; write them there, or remove "
            "both lines and give rate"
        ) from None
    channels = []
    for name, unit in zip(heads[1:start_column], entries[1:start_column], strict=True):
        channels.append(_head(name.upper(), spelt(unit)))

    channel_count = start_column - 1  # X stands before them

    def table_line(index: int, line: str) -> str:
        """The row with a time; "" of the first two lines, and of what is no row."""
        if index < 2:
            return ""
        number, *values = line.split(",")
        if not number.strip().isdecimal():
            return ""
        time = start + int(number) * step
        return ",".join([repr(time), *values[:channel_count]])

    head = ",".join([_head("time", "s"), *channels])
    return Layout(head, table_line)


def _yokogawa_layout(lines: list[str], entries: Entries) -> Layout:
    """Layout of a file whose rows have no times, and may begin with a blank cell.

    The time of row k = 1, 2, ... is HResolution (k - 1) + HOffset, in HUnit, says the
    appendix on the ASCII data file of the manuals. FileFormatError for several blocks,
    or if HResolution or HOffset is no number.
    """
    if first_value(entries, "blocknumber", "1") != "1":
        raise FileFormatError(
            f"has {first_value(entries, 'blocknumber', '')} blocks (BlockNumber), one "
            "below the other; save a single block"
        )
    try:
        step = float(first_value(entries, "hresolution", ""))
        start = float(first_value(entries, "hoffset", ""))
    except ValueError:
        raise FileFormatError(
            "has no numbers HResolution and HOffset; write them there, or remove the "
            "lines above the numbers and give rate"
        ) from None
    channels = [name for name in entries["tracename"] if name]
    first_row = 0  # index of the line with the first row; 0 if there is none
    for index, line in enumerate(lines):
        if _has_numbers_alone(line):
            first_row = index
            break

    def table_line(index: int, line: str) -> str:
        """The row with its time before it; "" for a blank line or one above rows."""
        if index < first_row:
            return ""
        values = line.strip().removeprefix(",")
        if not values.strip(", "):
            return ""
        time = start + (index - first_row) * step
        return f"{time!r},{values}"

    units = [spelt(unit) for unit in entries.get("vunit", [])]
    time_unit = spelt(first_value(entries, "hunit", "s"))
    head = _head_line(channels, units, time_unit, mark=",")
    return Layout(head, table_line)


def _has_numbers_alone(line: str) -> bool:
    """Whether all cells of a line are numbers, but for blank ones; one or more is."""
    cells = [cell for cell in _cells(line) if cell]
    try:
        for cell in cells:
            float(cell)
    except ValueError:
        return False
    return bool(cells)


def _keysight_entries(lines: list[str]) -> Entries:
    """Values of entries such as ``XInc:,1e-9``, by their names in small letters."""
    entries: Entries = {}
    for line in lines:
        match = KEYSIGHT_ENTRY.match(line.strip(' "'))
        if match:
            entries[match[1].casefold()] = [
                cell.strip() for cell in match[2].split(",")
            ]
    return entries


def _keysight_layout(first_line: str, entries: Entries) -> Layout:
    """Layout of a file of one channel.

    The name is the last cell of the first line, if that is no entry, else "Channel 1".
    The units are among the entries. With several channels or segments there is a pair
    of columns for each: FileFormatError.
    """
    starts = [text for text in entries["xorg"] if text]  # of each channel or segment
    if len(starts) > 1:
        raise FileFormatError(
            "has a column of times for each channel or segment; save each channel in a "
            "file of its own"
        )
    names = [cell for cell in first_line.split(",") if cell.strip(' "')]
    channel = "Channel 1"
    if names and not KEYSIGHT_ENTRY.match(names[-1].strip(' "')):
        channel = names[-1].strip(' "')
    time_unit = spelt(first_value(entries, "xunits", "s"))
    unit = spelt(first_value(entries, "yunits", "V"))
    head = _head_line([channel], [unit], time_unit, mark=",")
    return Layout(head, table_line=as_written)


def _labview_layout(
    head_index: int, names: list[str], entries: Entries, mark: str
) -> Layout:
    """Layout of a file whose table stands below the line of names.

    `head_index` is the index of this line, `names` its cells, and `mark` ends each
    cell. If the file has no times, the time is put before each row. FileFormatError if
    it has a column of times for each channel.
    """
    columns = first_value(entries, "x_columns", "One").casefold()
    if columns not in ("one", "no"):
        raise FileFormatError(
            f"has a column of times for each channel (X_Columns {columns}); "
            "save it with one column for all (X_Columns One)"
        )
    table_line: Callable[[int, str], str] = as_written
    if columns == "no":
        table_line = _with_times(head_index, entries)
    channels = names[1:]
    count = first_value(entries, "channels", "")
    if count.isdecimal():
        channels = channels[: int(count)]  # a column of comments follows
    units = entries.get("y_unit_label", [])
    head = _head_line(channels, units, time_unit="s", mark=mark)
    return Layout(head, table_line)


def _with_times(head_index: int, entries: Entries) -> Callable[[int, str], str]:
    """Function that puts the time before each line of a table without times.

    The table begins below the line with the index `head_index`. The times follow from
    the entries X0 and Delta_X; FileFormatError if they are missing.
    """
    try:
        start = float(first_value(entries, "x0", "").replace(",", "."))
        step = float(first_value(entries, "delta_x", "").replace(",", "."))
    except ValueError:
        raise FileFormatError(
            "has no times (X_Columns No), and no numbers X0 and Delta_X; "
            "save it with a column of times (X_Columns One)"
        ) from None
    sign = first_value(entries, "decimal_separator", ".")

    def table_line(index: int, line: str) -> str:
        """The row with its time before it; "" for a blank line.

        The lines up to the heads stay as they are.
        """
        if index <= head_index:
            return line
        if not line.strip():
            return ""
        row_number = index - head_index - 1  # from 0
        time = start + row_number * step
        # A row begins with a mark, as the first column, of times, is empty.
        return repr(time).replace(".", sign) + line

    return table_line


def _tektronix_layout(entries: Entries, is_beside: bool) -> Layout:
    """Layout of a file whose table stands below its entries, or to their right.

    `is_beside` tells the latter. The heads are among its entries, or made of name and
    unit of the channel for a table beside them. Otherwise all lines are taken as they
    are.
    """
    time_unit = first_value(entries, "horizontal units", "")
    units = entries.get("vertical units", [])
    if "time" in entries:  # this entry is the row of heads
        head = _head_line(entries["time"], units, time_unit, mark=",")
        return Layout(head, table_line=as_written)
    if not is_beside:
        return Layout(head="", table_line=as_written)
    channel = first_value(entries, "source", "CH1")

    def table_line(_: int, line: str) -> str:
        """What is to the right of the columns of entries."""
        return line.split(",", COLUMNS_BESIDE)[-1]

    head = _head_line([channel], units[:1], time_unit, mark=",")
    return Layout(head, table_line)


def _head_line(channels: list[str], units: list[str], time_unit: str, mark: str) -> str:
    """A line of heads, with `mark` between them: the time, then the channels.

    Blank units at the end are dropped. If a single unit is left, it is that of all
    channels; a channel may also have none. A column without a name, and a column of
    comments, are left out, as they have no numbers.
    """
    while units and not units[-1]:
        units = units[:-1]
    if len(units) == 1:
        units = units * len(channels)
    heads = [_head("time", time_unit)]
    for channel, unit in zip_longest(channels, units, fillvalue=""):
        if channel and channel.casefold() != "comment":
            heads.append(_head(channel, unit))
    return mark.join(heads)


def _head(name: str, unit: str) -> str:
    """Head of a column, with its unit in brackets if it has one."""
    if unit:
        return f"{name} [{unit}]"
    return name
