"""Reading of files: nothing is unpacked that the file's document does not announce.

An NPZ is opened at its document. Only if that is one of rodimpact's are the arrays read
that it names, and each must have the size, type, shape and checksum that it had when it
was written.
"""

import errno
import json
import math
import os
import zipfile
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ..hints import similar
from ..methods import memory
from ..model.arguments import check_text
from ..units import shown_path
from ..version import __version__
from .writing import (
    FILE_SCHEMA,
    FORMAT,
    MAX_DOCUMENT_BYTES,
    Arrays,
    PathLike,
    described,
    file_name,
)

MAX_HEADER_BYTES = 1 << 12
"""Bytes before the numbers of an array, at most; usually 128."""
ADVICE = "load it on a larger machine"
BYTES_PER_CHARACTER = 24
"""Largest memory that Python takes for a character of a document, bytes.

A document of brackets alone takes most.
"""
OLD_SOLUTION = (
    "holds the arrays of a single solution, as an earlier version of rodimpact saved "
    "them. A solution is saved as its case now: solve its system again, and "
    'save("run.toml"). Without the system, load the file with the version that saved '
    "it, and write solution.system as a case file"
)
COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Compressions of arrays; others expand without bounds."""


class FileFormatError(ValueError):
    """A file is not what it should be: foreign, damaged, or of a newer version.

    Examples
    --------
    >>> import pathlib, tempfile, rodimpact as ri
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "map.npz")
    ...     _ = path.write_text("not a family")
    ...     try:
    ...         ri.load(path)
    ...     except ri.FileFormatError:
    ...         print("refused")
    refused
    """

    def __init__(self, message: str, path: str = "") -> None:
        """Keep path and message as `problems`; the text is the message behind the path.

        `problems` is a list of one pair, as that of `InvalidModel`. Without a path the
        text is the message alone. Either must be text.
        """
        check_text("message", message, "is empty")
        check_text("path", path, "run.toml")
        self.problems = [(path, message)]
        sentence = message
        if path:
            sentence = f"{path}: {message}"
        super().__init__(sentence)


def open_regular(path: PathLike) -> BinaryIO:
    """Open a file for reading bytes; OSError if there is none, or a pipe or a device.

    For a missing file the error names one that is spelt like it.
    """
    path = file_name(path)
    # A directory is left to `open`, whose error says what it is.
    is_file_or_directory = os.path.isfile(path) or os.path.isdir(path)
    if os.path.exists(path) and not is_file_or_directory:
        raise OSError(errno.EINVAL, "it is not a regular file", path)
    try:
        return open(path, "rb")
    except OSError as error:
        # Without the quotes of `shown_path`: OSError puts its own around a name.
        unquoted = shown_path(path)[1:-1]
        reason = str(error.strerror)
        if isinstance(error, FileNotFoundError):
            reason += _similar_file(path)
        elif isinstance(error, IsADirectoryError):
            reason += "; add the name of a file in it"
        raise type(error)(error.errno, reason, unquoted) from None


def _similar_file(name: str) -> str:
    """End of a message: a file of the same folder that is spelt like the missing one.

    One with an ending more, such as t1.toml for t1, comes first. "" if there is none.
    """
    path = Path(name)
    files = []
    with suppress(OSError):  # there is no such folder, or it may not be read
        files = [file.name for file in path.parent.iterdir()]
    same_stem = [file for file in sorted(files) if Path(file).stem == path.name]
    if same_stem:
        meant: str | None = same_stem[0]
    else:
        meant = similar(path.name, files)
    if meant is None:
        return ""
    return f"; perhaps {str(path.with_name(meant))!r} is meant"


def read_npz(
    path: PathLike, readers: Mapping[str, Callable[[dict[str, Any], Arrays], Any]]
) -> Any:
    """Read what `write_npz` wrote.

    Parameters
    ----------
    path : str or path
    readers : mapping of str to callable
        For each kind of file, a function that makes the result of the document and the
        arrays by name.

    Returns
    -------
    object
        What the reader of that kind makes.

    Raises
    ------
    FileFormatError
        If the file is not such a one, is damaged, or its reader fails.
    OSError
        If it cannot be opened.
    MemoryError
        If it has more than the memory holds.
    """
    with open_regular(path) as file:
        try:
            if file.read(2) != b"PK":  # every ZIP begins with it
                raise FileFormatError(
                    "is not an NPZ file, so rodimpact did not save it"
                )
            with zipfile.ZipFile(file) as archive:
                document = _document(archive, readers)
                entries = document.pop("arrays")  # type, shape, checksum by name
                arrays = _arrays(archive, entries)
            return readers[document["kind"]](document, arrays)
        except FileFormatError as error:
            raise FileFormatError(str(error), os.fspath(path)) from None
        except MemoryError:
            raise  # the file may be whole
        except Exception as error:
            # zipfile, zlib and numpy raise a dozen kinds for a damaged file; some of
            # the messages repeat the data
            reason = f"{type(error).__name__}: {error}"[:200]
            message = (
                f"is not a whole NPZ file of plain arrays that fit together ({reason})"
            )
            raise FileFormatError(message, os.fspath(path)) from error


def _document(archive: zipfile.ZipFile, readers: Mapping[str, Any]) -> dict[str, Any]:
    """The document of an archive: kind, version, entries of its arrays, and the rest.

    FileFormatError if it is foreign, of another schema, or of a kind that none of the
    readers reads. MemoryError if it is too large.
    """
    foreign = FileFormatError("is an NPZ file, but not one that rodimpact saved")
    if "document.npy" not in archive.namelist():
        raise foreign
    text = str(_array(archive, "document", MAX_DOCUMENT_BYTES))
    memory.check_file(archive.filename, BYTES_PER_CHARACTER * len(text), ADVICE)
    try:
        document = json.loads(text)
        if document["format"] != FORMAT:
            raise foreign
        schema = document["schema"]
        kind = document["kind"]
        version = document["rodimpact"]
        is_readable = schema == FILE_SCHEMA and kind in readers
    except (KeyError, TypeError, ValueError, RecursionError):
        raise foreign from None
    if kind == "solution":  # of an earlier version, whatever the schema
        raise FileFormatError(OLD_SOLUTION)
    if not is_readable:
        raise FileFormatError(
            f"is a {kind!r} of schema {schema!r}, saved by rodimpact {version}; this "
            f"is rodimpact {__version__}, which reads schema {FILE_SCHEMA}. Load it "
            "with the version that saved it"
        )
    return document  # type: ignore[no-any-return]


def _arrays(archive: zipfile.ZipFile, entries: dict[str, Any]) -> Arrays:
    """The arrays that the document names in its `entries`, by name.

    An entry has type, shape and checksum of the array. FileFormatError if an array is
    missing, is not named, or differs from its entry; MemoryError if they are too large.
    """
    sizes = {}  # bytes
    expected_names = {"document.npy"}
    for name, entry in entries.items():
        sizes[name] = np.dtype(entry["type"]).itemsize * math.prod(entry["shape"])
        expected_names.add(f"{name}.npy")
    memory.check_file(archive.filename, sum(sizes.values()), ADVICE)
    mismatch = "is damaged: {} is not what the document says"
    unmatched = expected_names.symmetric_difference(archive.namelist())
    if unmatched:  # the first of them is named
        raise FileFormatError(mismatch.format(min(unmatched)))
    arrays = {}
    for name, entry in entries.items():
        arrays[name] = _array(archive, name, sizes[name])
        if described(arrays[name]) != entry:
            raise FileFormatError(mismatch.format(name))
    return arrays


def _array(archive: zipfile.ZipFile, name: str, most: int) -> Any:
    """The array `name` of an archive, with at most `most` bytes.

    ValueError for more, and for another compression, version or length than that of an
    NPY file. All this is checked before the numbers are unpacked. Objects are refused.
    """
    packed = archive.getinfo(f"{name}.npy")
    if packed.compress_type not in COMPRESSIONS:
        raise ValueError(f"{name} is packed in a way that NPZ files are not")
    if packed.file_size > most + MAX_HEADER_BYTES:
        raise ValueError(f"{name} has {packed.file_size} bytes and should have {most}")
    with archive.open(packed) as file:
        if np.lib.format.read_magic(file) != (1, 0):
            raise ValueError(f"{name} is an array of another version of NPY")
        shape, _, dtype = np.lib.format.read_array_header_1_0(file)
        expected_bytes = dtype.itemsize * math.prod(shape)
        bytes_after_header = packed.file_size - file.tell()
        if expected_bytes != bytes_after_header:
            raise ValueError(f"{name} is not as long as it says")
        file.seek(0)  # `read_array` reads the header again
        return np.lib.format.read_array(file, allow_pickle=False)
