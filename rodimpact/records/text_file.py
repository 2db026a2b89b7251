"""The text of a file, read line by line, so that memory does not grow with the file."""

import codecs
import os
import re
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple, TextIO

from ..storage.reading import FileFormatError

NO_TEXT = "is not text (it contains the character NUL); export it as text, in UTF-8"
BLOCK = 1 << 17
"""Number of characters read at a time.

It is also the largest number above a table, and between two reports of progress.
"""
QUOTED_COMMA = re.compile(r'"[+-]?\d*,\d+(?:[eE][+-]?\d+)?"')
"""A number with a decimal comma, in quotes."""
MINUS = "\N{MINUS SIGN}"


class Survey(NamedTuple):
    """Facts about a whole text, most of which its first lines do not show.

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

    Lines may end in any way; minus signs of typography are hyphens here.
    """

    def __init__(self, file: BinaryIO) -> None:
        """Find the encoding, and survey the whole text in it.

        UTF-16 begins with its mark; a text that is not UTF-8 is taken for Latin-1.
        FileFormatError for a text with the character NUL.
        """
        self._descriptor = file.fileno()
        encoding = "utf-8-sig"
        if file.read(2) in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
            encoding = "utf-16"
        try:
            self.survey = self._surveyed(encoding)
        except UnicodeDecodeError:
            self.survey = self._surveyed("latin-1")

    def lines(self) -> Iterator[str]:
        """All lines, each with its end."""
        with self._opened(self.survey.encoding) as text:
            for line in text:
                yield line.replace(MINUS, "-")

    def _surveyed(self, encoding: str) -> Survey:
        """Read the whole text once, block by block, for its survey.

        FileFormatError if it has the character NUL, UnicodeDecodeError if it has
        another encoding.
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
                comma = block.rfind(",")  # -1 if there is none
                if comma >= 0:
                    last_comma_line = line_ends + block.count("\n", 0, comma)
                if '"' in block and not quotes_commas:
                    quotes_commas = QUOTED_COMMA.search(block) is not None
                characters += len(block)
                line_ends += block.count("\n")
        return Survey(
            encoding=encoding,
            head=head,
            characters=characters,
            lines=line_ends + 1,  # the last line has no end
            last_comma_line=last_comma_line,
            quotes_commas=quotes_commas,
        )

    def _opened(self, encoding: str) -> TextIO:
        """The text from its beginning; the file stays open when it is closed."""
        os.lseek(self._descriptor, 0, os.SEEK_SET)
        return open(self._descriptor, encoding=encoding, closefd=False)
