"""File layouts of LabVIEW and of scopes: entries with units and times beside a table.

An entry is a name with values, such as a unit for each channel. LabVIEW measurement
files (.lvm) have units and time steps in entries, and may lack a column of times.
Scopes of Tektronix write entries above the table, or in three columns to its left;
those of Rigol, LeCroy, Yokogawa and Keysight (Infiniium) write them above the table. An
entry without a value counts as missing. Column heads are made from the entries.
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
"""Begin of the first line of LeCroy files, whose times are in s and values in V."""
RIGOL_HEADS = {"x", "start", "increment"}
"""Heads of Rigol scopes, in the first line."""
YOKOGAWA = {"tracename", "hresolution", "hoffset"}
"""Entries of Yokogawa scopes, whose rows have no times."""
KEYSIGHT = {"revision", "xinc", "xorg"}
"""Entries of Keysight Infiniium scopes, whose rows have a time before each value."""
# Name and values of an entry such as "XInc:,1e-9"
KEYSIGHT_ENTRY = re.compile(r"([A-Za-z]+)\s*:\s*,?(.*)")
COLUMNS_BESIDE = 3
"""Number of columns of entries that Tektronix writes to the left of a table."""
MAX_ENTRY_LINES = 100
"""Number of first lines that are searched for entries."""


class Layout(NamedTuple):
    """Heads of the table in a file, and the part of each line that belongs to it.

    Attributes
    ----------
    head : str
        A line of heads, made from entries; "" if the heads stand above the table.
    table_line : function
        Takes index and text of a line, and returns the text that belongs to the table,
        with a time added if the file has none; "" if nothing belongs to it.
    """

    head: str
    table_line: Callable[[int, str], str]


Entries = dict[str, list[str]]
"""Values of each entry, one for each cell after the name, by name in small letters."""


def first_value(entries: Entries, name: str, default: str) -> str:
    """The first value of an entry, or a default if it is missing or empty."""
    values = entries.get(name, [])
    if values and values[0]:
        return values[0]
    return default


def as_written(_: int, line: str) -> str:
    """The whole line: `Layout.table_line` of a file without entries in its rows."""
    return line


def find_layout(lines: list[str]) -> Layout:
    """Layout of a file with these first lines.

    The instrument is recognized by the first line, or by entries in the first
    `MAX_ENTRY_LINES` lines. If it is unknown, the layout takes all lines as they are.
    FileFormatError for a known instrument whose table cannot be read.
    """
    lines = lines[:MAX_ENTRY_LINES]
    mark = "\t"  # the delimiter of cells
    if "," in lines[0]:
        mark = ","
    entries: Entries = {}
    for index, line in enumerate(lines):
        cells = [cell.strip(' "') for cell in line.split(mark)]
        name = cells[0].casefold()
        entries[name] = cells[1:]
        # The row of heads of LabVIEW stands below all entries: they are complete.
        if name == LABVIEW_HEAD and LABVIEW in entries:
            return _labview_layout(index, cells, entries, mark)
    if lines[0].startswith(LECROY):
        return Layout(head="Time [s],Ampl [V]", table_line=as_written)
    # Between sets, `>=` means that all these names are present.
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
    """Layout of a Rigol file, whose rows begin with the number of the sample, from 0.

    `heads` are the cells of the first line in small letters: x, the channels, start,
    increment. `entries` are the cells of the second line below them: units of the
    channels, start time and time step. The layout replaces the number of each row by
    its time. FileFormatError if start time or time step is not a number.
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
    # The channels stand between x, the column 0, and start. Their names, such as CH1,
    # were made small by `_cells`.
    for name, unit in zip(heads[1:start_column], entries[1:start_column], strict=True):
        channels.append(_head(name.upper(), spelt(unit)))

    channel_count = start_column - 1  # without x

    def table_line(index: int, line: str) -> str:
        """The row with its time; "" for the first two lines, and for any other line."""
        if index < 2:
            return ""
        number, *values = line.split(",")
        if not number.strip().isdecimal():
            return ""
        time = start + int(number) * step
        # The row may have blank cells below start and increment.
        return ",".join([repr(time), *values[:channel_count]])

    head = ",".join([_head("time", "s"), *channels])
    return Layout(head, table_line)


def _yokogawa_layout(lines: list[str], entries: Entries) -> Layout:
    """Layout of a Yokogawa file, whose rows have no times and may begin with a comma.

    The layout adds times: that of row k = 1, 2, ... is HResolution (k - 1) + HOffset,
    in HUnit (appendix on the ASCII data file of the manuals). FileFormatError for
    several blocks, or if HResolution or HOffset is not a number.
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
        """The row after its time; "" for a blank line and a line above the rows."""
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
    """Whether a line has numbers and no other cells, except blank ones."""
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
    """Layout of a Keysight file of one channel.

    The name of the channel is the last cell of the first line if this cell is not an
    entry, else "Channel 1". The units are among the entries. FileFormatError for
    several channels or segments, since each of them has its own column of times.
    """
    starts = [text for text in entries["xorg"] if text]  # of each channel or segment
    if len(starts) > 1:
        raise FileFormatError(
            "has a column of times for each channel or segment; save each channel in a "
            "file of its own"
        )
    names = [cell for cell in first_line.split(",") if cell.strip(' "')]  # not blank
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
    """Layout of a LabVIEW file, whose table stands below the line of names.

    `head_index` is the index of this line, and `names` are its cells; `mark` is the
    delimiter. If the file has no times, they are added to the rows. FileFormatError if
    the file has a column of times for each channel.
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
    channels = names[1:]  # without the head of the times
    count = first_value(entries, "channels", "")
    if count.isdecimal():
        channels = channels[: int(count)]  # without the column of comments
    units = entries.get("y_unit_label", [])
    head = _head_line(channels, units, time_unit="s", mark=mark)
    return Layout(head, table_line)


def _with_times(head_index: int, entries: Entries) -> Callable[[int, str], str]:
    """A `Layout.table_line` that adds the time to each row of a table without times.

    The table begins below the line of the index `head_index`. The times follow from the
    entries X0 and Delta_X; FileFormatError if one of these is not a number.
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
        """The row after its time; "" for a blank line.

        The lines up to the line of names are returned unchanged.
        """
        if index <= head_index:
            return line
        if not line.strip():
            return ""
        row_number = index - head_index - 1  # from 0
        time = start + row_number * step
        # The row begins with a delimiter, since its first column, for times, is empty.
        return repr(time).replace(".", sign) + line

    return table_line


def _tektronix_layout(entries: Entries, is_beside: bool) -> Layout:
    """Layout of a Tektronix file.

    The table stands below the entries or, if `is_beside`, to their right. Three cases:
    if there is an entry "time", it is the row of heads, and lines are taken as they
    are. Otherwise, if `is_beside`, the head is made from name and unit of the channel,
    and the columns of entries are cut off. Otherwise lines are taken as they are.
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
        """The part of a line to the right of the columns of entries."""
        return line.split(",", COLUMNS_BESIDE)[-1]  # after the first commas

    head = _head_line([channel], units[:1], time_unit, mark=",")
    return Layout(head, table_line)


def _head_line(channels: list[str], units: list[str], time_unit: str, mark: str) -> str:
    """A line of heads, with the delimiter `mark`: first the time, then the channels.

    Blank units at the end of `units` are dropped. A single remaining unit holds for all
    channels; channels beyond the last unit have none. Channels without a name, and the
    one called "comment", are left out, as their columns have no numbers.
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
