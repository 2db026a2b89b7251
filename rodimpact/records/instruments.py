"""Entries of LabVIEW and of Tektronix scopes before or beside a table, as column heads.

LabVIEW measurement files (.lvm) name units and steps of time in lines of their own, and may leave
out the column of times. Scopes of Tektronix write such lines before the table, or in three columns
to its left.
"""

from ..storage.reading import FileFormatError

LABVIEW = "labview measurement"
LABVIEW_HEAD = "x_value"
TEKTRONIX = ("record length", "sample interval")
BESIDE = 3
"""Columns of entries that Tektronix writes to the left of a table."""
MOST_ENTRIES = 100
"""Lines that are searched for entries."""
Entries = dict[str, list[str]]


def as_table(text: str) -> tuple[str, str]:
    """The text of the table alone, and a line of heads; "" if the heads are unknown."""
    lines = text.split("\n", MOST_ENTRIES)[:MOST_ENTRIES]
    mark = "," if "," in lines[0] else "\t"
    entries: Entries = {}
    for number, line in enumerate(lines):
        cells = [cell.strip(' "') for cell in line.split(mark)]
        key = cells[0].casefold()
        entries[key] = [cell for cell in cells[1:] if cell]
        if key == LABVIEW_HEAD and LABVIEW in entries:
            return _read_labview(text, number, cells, entries)
    is_tektronix = any(key in entries for key in TEKTRONIX)
    if is_tektronix and "horizontal units" in entries:
        return _read_tektronix(text, lines, entries)
    return text, ""


def _read_labview(
    text: str, number: int, names: list[str], entries: Entries
) -> tuple[str, str]:
    """The table below line `number`, with a time in every line, and heads with units."""
    columns = entries.get("x_columns", ["One"])[0].casefold()
    if columns not in ("one", "no"):
        raise FileFormatError(
            f"has a column of times for each channel (X_Columns {columns}); "
            "save it with one column for all (X_Columns One)"
        )
    if columns == "no":
        try:
            start = float(entries["x0"][0].replace(",", "."))
            step = float(entries["delta_x"][0].replace(",", "."))
        except (KeyError, IndexError, ValueError):
            raise FileFormatError(
                "has no times (X_Columns No), and no numbers X0 and Delta_X; "
                "save it with a column of times (X_Columns One)"
            ) from None
        sign = entries.get("decimal_separator", ["."])[0]
        lines = text.split("\n")
        for i in range(number + 1, len(lines)):
            time = repr(start + (i - number - 1) * step).replace(".", sign)
            if lines[i].strip():
                lines[i] = time + lines[i]
            else:
                lines[i] = ""
        text = "\n".join(lines)
    channels = [name for name in names[1:] if name and name.casefold() != "comment"]
    return text, _heads(channels, entries.get("y_unit_label", []), "s", "\t")


def _read_tektronix(text: str, lines: list[str], entries: Entries) -> tuple[str, str]:
    """The table alone, and heads with units."""
    time = entries["horizontal units"][0]
    units = entries.get("vertical units", [])
    if "time" in entries:
        return text, _heads(entries["time"], units, time, ",")
    if lines[0].count(",") < BESIDE:
        return text, ""
    table = [line.split(",", BESIDE)[-1] for line in text.split("\n")]
    channels = entries.get("source", ["CH1"])[:1]
    return "\n".join(table), _heads(channels, units[:1], time, ",")


def _heads(channels: list[str], units: list[str], time: str, mark: str) -> str:
    """A line of heads: one unit is that of all channels; without any, channels name their own."""
    if len(units) < 2:
        units = (units or [""]) * len(channels)
    heads = [f"time [{time}]"]
    for channel, unit in zip(channels, units, strict=False):
        heads.append(f"{channel} [{unit}]" if unit else channel)
    return mark.join(heads)
