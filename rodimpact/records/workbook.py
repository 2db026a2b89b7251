"""Workbooks of spreadsheets, as text: the first sheet, with tabs between its cells.

From there on they are read as other tables are: a row is a line.
"""

from __future__ import annotations

import os
import tempfile
from typing import Any, BinaryIO

from ..storage.extras import optional
from ..storage.reading import FileFormatError
from ..units import one_line

ENGINES = {".xlsx": "openpyxl", ".xlsm": "openpyxl", ".xls": "xlrd"}
"""Package that reads a workbook, by the end of the file's name."""
EXCEL_SIGNATURES = (b"\xd0\xcf\x11\xe0", b"\x09\x00", b"\x09\x02", b"\x09\x04")
"""First bytes of a workbook of the name .xls; instruments call tables of text by this name, too."""


def is_workbook(file: BinaryIO) -> bool:
    """Whether an open file is a workbook, by its name and, if that is .xls, its first bytes."""
    ending = _ending(file)
    if ending == ".xls":
        file.seek(0)
        return file.read(4).startswith(EXCEL_SIGNATURES)
    return ending in ENGINES


def text_of_workbook(file: BinaryIO) -> BinaryIO:
    """The first sheet of a workbook as a file of text, in UTF-8 (extra ``excel``).

    Raises
    ------
    FileFormatError
        If the file is no workbook.
    ImportError
        If a package is missing.
    """
    pandas = optional("pandas", "excel")
    engine = ENGINES[_ending(file)]
    optional(engine, "excel")
    file.seek(0)
    try:
        sheet = pandas.read_excel(file, header=None, dtype=object, engine=engine)
    except Exception as error:  # each package has errors of its own
        raise FileFormatError(
            f"is no workbook that {engine} reads ({one_line(str(error))}); save it again as "
            ".xlsx, or export it as text"
        ) from None
    text: BinaryIO = tempfile.TemporaryFile()  # type: ignore[assignment]  # noqa: SIM115
    for row in sheet.itertuples(index=False):
        cells = [_cell_text(cell) for cell in row]
        text.write(("\t".join(cells) + "\n").encode())
    text.seek(0)
    return text


def _ending(file: BinaryIO) -> str:
    return os.path.splitext(file.name)[1].casefold()


def _cell_text(cell: Any) -> str:
    """A cell as text on one line; an empty one is NaN."""
    if cell != cell:
        return ""
    if isinstance(cell, str):
        return " ".join(cell.split())
    return repr(cell)
