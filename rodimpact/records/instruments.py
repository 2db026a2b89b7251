"""Entries of LabVIEW and of Tektronix scopes before or beside a table, as column heads.

LabVIEW measurement files (.lvm) name units and steps of time in lines of their own, and may leave
out the column of times. Scopes of Tektronix write such lines before the table, or in three columns
to its left.
"""

from ..storage.reading import FileFormatError

LABVIEW, HEAD = "labview measurement", "x_value"
TEKTRONIX = "record length", "sample interval"
BESIDE = 3  # columns of entries to the left of a table
MOST_ENTRIES = 100  # lines


def as_table(text: str) -> tuple[str, str]:
    """The text of the table alone, and a line of heads; "" if the heads are unknown."""
    lines = text.split("\n", MOST_ENTRIES)[:MOST_ENTRIES]
    mark = "," if "," in lines[0] else "\t"
    entries = {}
    for number, line in enumerate(lines):
        key, *cells = (cell.strip(' "') for cell in line.split(mark))
        entries[key.casefold()] = [cell for cell in cells if cell]
        if key.casefold() == HEAD and LABVIEW in entries:
            return _labview(text, number, [key, *cells], entries)
    if (
        not any(key in entries for key in TEKTRONIX)
        or "horizontal units" not in entries
    ):
        return text, ""
    return _tektronix(text, lines, entries)


def _labview(
    text: str, number: int, names: list[str], entries: dict[str, list[str]]
) -> tuple[str, str]:
    """A time for every line where there is none, and heads with units."""
    columns = entries.get("x_columns", ["One"])[0].casefold()
    if columns not in ("one", "no"):
        raise FileFormatError(
            f"has a column of times for each channel (X_Columns {columns}); "
            "save it with one column for all (X_Columns One)"
        )
    if columns == "no":
        try:
            start, step = (
                float(entries[key][0].replace(",", ".")) for key in ("x0", "delta_x")
            )
        except (KeyError, IndexError, ValueError):
            raise FileFormatError(
                "has no times (X_Columns No), and no numbers X0 and Delta_X; "
                "save it with a column of times (X_Columns One)"
            ) from None
        sign = entries.get("decimal_separator", ["."])[0]
        lines = text.split("\n")
        for i in range(number + 1, len(lines)):
            time = repr(start + (i - number - 1) * step).replace(".", sign)
            lines[i] = time + lines[i] if lines[i].strip() else ""
        text = "\n".join(lines)
    channels = [name for name in names[1:] if name and name.casefold() != "comment"]
    return text, _heads(channels, entries.get("y_unit_label", []), "s", "\t")


def _tektronix(
    text: str, lines: list[str], entries: dict[str, list[str]]
) -> tuple[str, str]:
    """The table alone, and heads with units."""
    time, units = entries["horizontal units"][0], entries.get("vertical units", [])
    if "time" in entries:
        return text, _heads(entries["time"], units, time, ",")
    if lines[0].count(",") < BESIDE:
        return text, ""
    table = [line.split(",", BESIDE)[-1] for line in text.split("\n")]
    return "\n".join(table), _heads(
        entries.get("source", ["CH1"])[:1], units[:1], time, ","
    )


def _heads(channels: list[str], units: list[str], time: str, mark: str) -> str:
    """A line of heads; one unit is that of all channels, and where there is none they say it."""
    of = units * len(channels) if len(units) == 1 else units
    named = zip(channels, of, strict=False) if of else ((name, "") for name in channels)
    return mark.join([f"time [{time}]", *(f"{n} [{u}]" if u else n for n, u in named)])
