"""Conversion of a workbook to text: the first sheet, with tabs between its cells.

Each row becomes a line, so the text is read as any other table.
"""

from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Iterator
from contextlib import closing
from typing import Any, BinaryIO

from ..storage.extras import optional
from ..storage.reading import FileFormatError
from ..units import one_line

OLD_ENDING = ".xls"
ENDINGS = (".xlsx", ".xlsm", OLD_ENDING)
OLD_SIGNATURES = (b"\xd0\xcf\x11\xe0", b"\x09\x00", b"\x09\x02", b"\x09\x04")
"""First bytes of a workbook called .xls.

Instruments call tables of text by this name, too.
"""


def is_workbook(file: BinaryIO) -> bool:
    """Whether an open file is a workbook, according to the ending of its name.

    Texts may be called .xls, too: for this ending the first bytes decide, and the file
    position is left after them.
    """
    ending = _ending(file)
    if ending == OLD_ENDING:
        file.seek(0)
        return file.read(4).startswith(OLD_SIGNATURES)
    return ending in ENDINGS


def text_of_workbook(file: BinaryIO) -> BinaryIO:
    """The first sheet of a workbook as a file of text, in UTF-8 (extra ``excel``).

    The result is a temporary file with tabs between cells, positioned at its beginning.
    The caller must close it.

    Raises
    ------
    FileFormatError
        If the file is no workbook.
    ImportError
        If the package that reads it is missing.
    """
    file.seek(0)
    if _ending(file) == OLD_ENDING:
        package = optional("xlrd", "excel")
        rows = _rows_of_xls(package, file)
    else:
        package = optional("openpyxl", "excel")
        rows = _rows_of_xlsx(package, file)
    text: BinaryIO = tempfile.TemporaryFile()  # noqa: SIM115
    try:
        for row in rows:
            text.write((row + "\n").encode())
    except Exception as error:
        # The packages have errors of their own, and those of zip files.
        text.close()
        raise FileFormatError(
            f"is no workbook that {package.__name__} reads ({one_line(str(error))}); "
            "save it again as .xlsx, or export it as text"
        ) from None
    text.seek(0)
    return text


def _ending(file: BinaryIO) -> str:
    """Ending of the name of a file, such as ".xls", in small letters."""
    return os.path.splitext(file.name)[1].casefold()


def _rows_of_xlsx(openpyxl: Any, file: BinaryIO) -> Iterator[str]:
    """Yield the rows of the first sheet (.xlsx, .xlsm), with tabs between cells."""
    # `data_only`: the values of formulas, not their texts
    book = openpyxl.load_workbook(file, read_only=True, data_only=True)
    with closing(book):
        for row in book.worksheets[0].iter_rows(values_only=True):
            yield "\t".join(map(_cell_text, row))


def _rows_of_xls(xlrd: Any, file: BinaryIO) -> Iterator[str]:
    """Yield the rows of the first sheet of an old workbook, with tabs between cells."""
    # Without a log xlrd prints to the standard output.
    book = xlrd.open_workbook(file_contents=file.read(), logfile=io.StringIO())
    for row in book.sheet_by_index(0).get_rows():
        yield "\t".join(_cell_text(cell.value) for cell in row)


def _cell_text(cell: Any) -> str:
    """A cell as text on one line; "" for an empty cell, which is None or ""."""
    if cell is None:
        return ""
    return " ".join(str(cell).split())
