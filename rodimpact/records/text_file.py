"""The text of a file, read line by line, so that memory does not grow with the file."""

import codecs
import os
import re
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple, TextIO

from ..storage.reading import FileFormatError

NO_TEXT = "is not text (it contains the character NUL); export it as text, in UTF-8"
BLOCK = 1 << 17
"""Number of characters read at a time, to the end of a line.

The table must begin within the first block.
"""
QUOTED_COMMA = re.compile(r'"[+-]?\d*,\d+(?:[eE][+-]?\d+)?"')
"""A number with a decimal comma, in quotes."""
MINUS = "\N{MINUS SIGN}"


class Survey(NamedTuple):
    """Facts about a whole text.

    Attributes
    ----------
    encoding : str
    head : str
        The first `BLOCK` characters.
    characters : int
    lines : int
    last_comma_line : int
        Index of the last line with a comma; -1 if there is none.
    quotes_commas : bool
        Whether a number with a decimal comma is in quotes somewhere.
    """

    encoding: str
    head: str
    characters: int
    lines: int
    last_comma_line: int
    quotes_commas: bool


class TextFile:
    """A file of text: UTF-8, UTF-16 with a byte order mark, or Latin-1.

    All kinds of line ends are accepted. Typographic minus signs are read as hyphens.
    """

    def __init__(self, file: BinaryIO) -> None:
        """Find the encoding, and read the whole text once for its `survey`.

        A text with a mark of UTF-16 is read as UTF-16; any other text as UTF-8 or, if
        it is not valid UTF-8, as Latin-1. FileFormatError for a text with the character
        NUL.
        """
        self._descriptor = file.fileno()
        encoding = "utf-8-sig"  # UTF-8, with or without a byte order mark
        if file.read(2) in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
            encoding = "utf-16"
        try:
            self.survey = self._surveyed(encoding)
        except UnicodeDecodeError:
            self.survey = self._surveyed("latin-1")

    def lines(self) -> Iterator[str]:
        """Yield all lines, each with its line end."""
        with self._opened(self.survey.encoding) as text:
            for line in text:
                yield line.replace(MINUS, "-")

    def _surveyed(self, encoding: str) -> Survey:
        """Read the whole text once, block by block, and return its survey.

        FileFormatError if the text has the character NUL, UnicodeDecodeError if it has
        a different encoding.
        """
        head = ""
        characters = 0
        line_ends = 0
        last_comma_line = -1
        quotes_commas = False
        with self._opened(encoding) as text:
            # Blocks end with whole lines, so that no number is cut.
            while block := text.read(BLOCK) + text.readline():
                if "\0" in block:
                    raise FileFormatError(NO_TEXT)
                is_first = characters == 0
                if is_first:
                    head = block[:BLOCK].replace(MINUS, "-")
                comma = block.rfind(",")  # position of the last comma; -1 without any
                if comma >= 0:
                    # Number of line ends before the comma
                    last_comma_line = line_ends + block.count("\n", 0, comma)
                if '"' in block and not quotes_commas:
                    quotes_commas = QUOTED_COMMA.search(block) is not None
                characters += len(block)
                line_ends += block.count("\n")
        return Survey(
            encoding=encoding,
            head=head,
            characters=characters,
            lines=line_ends + 1,  # the last line has no line end
            last_comma_line=last_comma_line,
            quotes_commas=quotes_commas,
        )

    def _opened(self, encoding: str) -> TextIO:
        """The text from its beginning; closing it leaves the file open."""
        os.lseek(self._descriptor, 0, os.SEEK_SET)
        return open(self._descriptor, encoding=encoding, closefd=False)
