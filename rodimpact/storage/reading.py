"""Safe reading of files: arrays are unpacked only if the file's document lists them.

The document of an NPZ file is read first. If it is one of rodimpact, the arrays that it
names are read. Each must have the size, type, shape and checksum that the document
states.
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
"""Largest size of the header of an NPY file, bytes; usually 128."""
ADVICE = "load it on a larger machine"
BYTES_PER_CHARACTER = 24
"""Largest memory that Python takes for a character of a document, bytes.

A document that consists of brackets takes the most.
"""
OLD_SOLUTION = (
    "holds the arrays of a single solution, as an earlier version of rodimpact saved "
    "them. A solution is saved as its case now: solve its system again, and "
    'save("run.toml"). Without the system, load the file with the version that saved '
    "it, and write solution.system as a case file"
)
COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Accepted compressions of arrays; others may expand without limit."""


class FileFormatError(ValueError):
    """A file cannot be used: it is foreign, damaged, or of another version.

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
        """Store path and message as `problems`; the text is "path: message".

        `problems` is a list of one pair (path, message), like that of `InvalidModel`.
        If the path is "", the text is the message alone. InvalidModel is raised if
        either is not text.
        """
        check_text("message", message, "is empty")
        check_text("path", path, "run.toml")
        self.problems = [(path, message)]
        sentence = message
        if path:
            sentence = f"{path}: {message}"
        super().__init__(sentence)


def open_regular(path: PathLike) -> BinaryIO:
    """Open a regular file for reading bytes.

    OSError, or a subclass that fits, is raised if there is no such file, if it cannot
    be opened, or if it is a directory, a pipe or a device. For a missing file the error
    names a file with a similar name, if there is one.
    """
    path = file_name(path)
    # A directory is left to `open`, which raises IsADirectoryError.
    is_file_or_directory = os.path.isfile(path) or os.path.isdir(path)
    if os.path.exists(path) and not is_file_or_directory:
        raise OSError(errno.EINVAL, "it is not a regular file", path)
    try:
        return open(path, "rb")
    except OSError as error:
        # [1:-1] removes the quotes of `shown_path`, as OSError adds its own.
        unquoted = shown_path(path)[1:-1]
        reason = str(error.strerror)
        if isinstance(error, FileNotFoundError):
            reason += _similar_file(path)
        elif isinstance(error, IsADirectoryError):
            reason += "; add the name of a file in it"
        raise type(error)(error.errno, reason, unquoted) from None


def _similar_file(name: str) -> str:
    """End of a message that names a file of the same folder with a similar name.

    A file that only has an ending in addition, such as t1.toml for t1, is preferred.
    The result is "" if there is no such file.
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
    """Read a file that `write_npz` wrote.

    Parameters
    ----------
    path : str or path
    readers : mapping of str to callable
        For each kind of file that is accepted, a function (document, arrays by name)
        that makes the result.

    Returns
    -------
    object
        Result of the reader of this kind of file.

    Raises
    ------
    FileFormatError
        If `write_npz` did not write the file, if it is damaged or of a kind without a
        reader, or if the reader raises an error.
    OSError
        If the file cannot be opened.
    MemoryError
        If the file needs too much memory.
    """
    with open_regular(path) as file:
        try:
            if file.read(2) != b"PK":  # the first bytes of every ZIP archive
                raise FileFormatError(
                    "is not an NPZ file, so rodimpact did not save it"
                )
            with zipfile.ZipFile(file) as archive:
                document = _document(archive, readers)
                entries = document.pop("arrays")  # type, shape, checksum by name
                arrays = _arrays(archive, entries)
            return readers[document["kind"]](document, arrays)
        except FileFormatError as error:
            # The errors of the helpers lack the path.
            raise FileFormatError(str(error), os.fspath(path)) from None
        except MemoryError:
            raise  # the file may be undamaged
        except Exception as error:
            # zipfile, zlib and numpy raise a dozen classes of errors for a damaged
            # file. The message is cut, as some of them repeat the data.
            reason = f"{type(error).__name__}: {error}"[:200]
            message = (
                f"is not a whole NPZ file of plain arrays that fit together ({reason})"
            )
            raise FileFormatError(message, os.fspath(path)) from error


def _document(archive: zipfile.ZipFile, readers: Mapping[str, Any]) -> dict[str, Any]:
    """The document of an archive, a dict: format, kind, schema, arrays and so on.

    FileFormatError is raised if it is foreign, of another schema, or of a kind that
    `readers` does not have; MemoryError if it is too large.
    """
    foreign = FileFormatError("is an NPZ file, but not one that rodimpact saved")
    if "document.npy" not in archive.namelist():
        raise foreign
    # The document is JSON in an array of shape (), which is a single text.
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
    if kind == "solution":  # only earlier versions wrote this kind
        raise FileFormatError(OLD_SOLUTION)
    if not is_readable:
        raise FileFormatError(
            f"is a {kind!r} of schema {schema!r}, saved by rodimpact {version}; this "
            f"is rodimpact {__version__}, which reads schema {FILE_SCHEMA}. Load it "
            "with the version that saved it"
        )
    return document  # type: ignore[no-any-return]


def _arrays(archive: zipfile.ZipFile, entries: dict[str, Any]) -> Arrays:
    """The arrays of an archive by name, checked against the entries of its document.

    An entry has type, shape and checksum of an array, see `described`. FileFormatError
    is raised if an array has no entry, if it is missing, or if it differs from its
    entry; MemoryError if all arrays together are too large.
    """
    sizes = {}  # bytes
    expected_names = {"document.npy"}
    for name, entry in entries.items():
        sizes[name] = np.dtype(entry["type"]).itemsize * math.prod(entry["shape"])
        expected_names.add(f"{name}.npy")
    memory.check_file(archive.filename, sum(sizes.values()), ADVICE)
    mismatch = "is damaged: {} is not what the document says"
    # Names that are only in the document or only in the archive
    unmatched = expected_names.symmetric_difference(archive.namelist())
    if unmatched:  # the message names the first of them
        raise FileFormatError(mismatch.format(min(unmatched)))
    arrays = {}
    for name, entry in entries.items():
        arrays[name] = _array(archive, name, sizes[name])
        if described(arrays[name]) != entry:
            raise FileFormatError(mismatch.format(name))
    return arrays


def _array(archive: zipfile.ZipFile, name: str, most: int) -> Any:
    """The array `name` of an archive, of at most `most` bytes.

    ValueError is raised if it is larger, if its compression or its version of NPY is
    not accepted, or if its length does not agree with its header. All this is checked
    before its numbers are unpacked. An array of Python objects is refused, too.
    """
    packed = archive.getinfo(f"{name}.npy")
    if packed.compress_type not in COMPRESSIONS:
        raise ValueError(f"{name} is packed in a way that NPZ files are not")
    if packed.file_size > most + MAX_HEADER_BYTES:
        raise ValueError(f"{name} has {packed.file_size} bytes and should have {most}")
    with archive.open(packed) as file:
        if np.lib.format.read_magic(file) != (1, 0):  # version 1.0 of NPY
            raise ValueError(f"{name} is an array of another version of NPY")
        # The part that is left out is the order of the axes in memory.
        shape, _, dtype = np.lib.format.read_array_header_1_0(file)
        expected_bytes = dtype.itemsize * math.prod(shape)
        bytes_after_header = packed.file_size - file.tell()
        if expected_bytes != bytes_after_header:
            raise ValueError(f"{name} is not as long as it says")
        file.seek(0)  # back to the start: `read_array` reads the header again
        return np.lib.format.read_array(file, allow_pickle=False)
