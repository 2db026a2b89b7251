"""Files appear whole or not at all.

A file is written under a passing name beside its target and moved into place when it is
complete. What is to be loaded again is an NPZ of plain arrays, with everything else in
one JSON document.
"""

import contextlib
import hashlib
import json
import os
import secrets
import stat
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias

import numpy as np

from ..model.arguments import check_flag
from ..model.frozen import invalid_argument
from ..units import shown, shown_path
from ..version import __version__

PathLike: TypeAlias = "str | os.PathLike[str]"
Arrays: TypeAlias = dict[str, Any]

FORMAT = "rodimpact"
FILE_SCHEMA = 6
"""Version of what a saved file holds; readers refuse others."""
MAX_DOCUMENT_BYTES = 1 << 28
"""Bytes of the document of a saved file, four to a character."""
PASSING = ".rodimpact-"
"""Begin of the names of files that are being written."""
EXISTS = "it exists already; give force=True to replace it"


def file_name(path: Any) -> str:
    """A path as text, unchanged; whether there is such a file does not matter.

    InvalidModel for anything but text or a path object of text, such as the number of
    an open file, and for a name with the character NUL.
    """
    name = None
    if isinstance(path, str | os.PathLike):
        name = os.fspath(path)
    if not isinstance(name, str) or "\0" in name:
        raise invalid_argument("path", f"must be the name of a file, got {shown(path)}")
    return name


def check_ending(path: Any, endings: tuple[str, ...], remedy: str) -> None:
    """Raise InvalidModel unless the name of a file ends in one of `endings`.

    They are in small letters, but capitals do not matter. `remedy` is the end of the
    message.
    """
    name = file_name(path)
    if not name.lower().endswith(endings):
        wanted = " or ".join(endings)
        message = f"must end in {wanted}, got {shown_path(name)}; {remedy}"
        raise invalid_argument("path", message)


def check_target(path: PathLike, *, force: bool = False) -> Path:
    """Make sure that a file may be written at `path`.

    It is worth asking before a long computation.

    Parameters
    ----------
    path : str or path
    force : bool
        Whether an existing file may be replaced.

    Returns
    -------
    Path
        Absolute, with symbolic links followed.

    Raises
    ------
    FileExistsError
        If the file is there and `force` is false.
    InvalidModel
        If `path` is no name of a file.
    OSError
        The subclass that fits (`IsADirectoryError`, `NotADirectoryError`,
        `FileNotFoundError` for a missing directory, `PermissionError`): where no file
        can be.
    """
    path = file_name(path)
    check_flag("force", force)
    mode = 0  # of the file that is there; 0 if there is none
    refused = f"cannot write {shown_path(path)}: "
    try:
        target = Path(os.path.realpath(path))
        # A missing or wrong directory is told below.
        with contextlib.suppress(FileNotFoundError, NotADirectoryError):
            mode = target.stat().st_mode
    except OSError as error:
        raise type(error)(f"{refused}{error.strerror}") from None
    exists = mode != 0
    folder = target.parent
    ends_in_slash = os.path.basename(path) == ""  # or is ""
    if stat.S_ISDIR(mode) or ends_in_slash:
        raise IsADirectoryError(refused + "it is a directory; add the name of a file")
    if exists and not stat.S_ISREG(mode):
        raise OSError(refused + "it is not a regular file")
    if exists and not force:
        raise FileExistsError(refused + EXISTS)
    if not folder.exists():
        raise FileNotFoundError(
            refused + f"there is no directory {shown_path(folder)}; make it"
        )
    if not folder.is_dir():
        raise NotADirectoryError(refused + f"{shown_path(folder)} is not a directory")
    if not os.access(folder, os.W_OK | os.X_OK):
        message = (
            f"you may not write in the directory {shown_path(folder)}; name another"
        )
        raise PermissionError(refused + message)
    return target


def write_bytes(path: PathLike, data: bytes, *, force: bool = False) -> None:
    """Write a file as a whole or not at all.

    Parameters
    ----------
    path : str or path
    data : bytes
    force : bool
        Whether to replace an existing file.

    Raises
    ------
    FileExistsError
        If the file is there and `force` is false.
    OSError
        Or a subclass, with a sentence, if the file cannot be written; an existing one
        is unharmed.
    """
    with open_for_writing(path, force=force) as file:
        file.write(data)


@contextlib.contextmanager
def open_for_writing(path: PathLike, *, force: bool = False) -> Iterator[BinaryIO]:
    """Open a file to be written piece by piece, as a context.

    It is written under a passing name beside `path`. At the end of the context it gets
    its own name; after an error it is removed. Parameters and errors are those of
    `write_bytes`.
    """
    target = check_target(path, force=force)
    passing = target.with_name(PASSING + secrets.token_hex(8))
    try:
        with open(passing, "xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        if force:
            os.replace(passing, target)
        else:
            _place(passing, target)  # a file that appeared meanwhile is not replaced
    except OSError as error:
        reason = str(error)
        if isinstance(error, FileExistsError):
            reason = EXISTS
        elif error.strerror:
            reason = error.strerror
        raise type(error)(f"cannot write {os.fspath(path)!r}: {reason}") from error
    finally:
        with contextlib.suppress(OSError):  # if the name is gone already
            passing.unlink()


def _place(passing: Path, target: Path) -> None:
    """Give the file `passing` the name `target`.

    FileExistsError if there is a file of that name, even one just made by another
    program. The name `passing` may be left, and the caller removes it.
    """
    try:
        os.link(passing, target)
    except FileExistsError:
        raise
    except OSError:  # a file system without links
        target.open("xb").close()  # claims the name: only one can make the file
        os.replace(passing, target)


def write_text(path: PathLike, text: str, *, force: bool = False) -> None:
    """Write a text file in UTF-8, as `write_bytes` does."""
    write_bytes(path, text.encode(), force=force)


def write_lines(path: PathLike, lines: Iterable[str], *, force: bool = False) -> None:
    """Write lines of text in UTF-8 one by one, as `write_bytes` does."""
    with open_for_writing(path, force=force) as file:
        for line in lines:
            file.write(f"{line}\n".encode())


def write_npz(
    path: PathLike,
    kind: str,
    document: dict[str, Any],
    arrays: Arrays,
    *,
    force: bool = False,
) -> None:
    """Write arrays and a JSON document as one compressed NPZ: the whole file or none.

    `read_npz` knows the file by its `kind`. To the document are added format, versions,
    and type, shape and checksum of each array, so that no reader unpacks anything else.
    OSError for a document of more than `MAX_DOCUMENT_BYTES`, and if the file cannot be
    written.
    """
    content: dict[str, Any] = {
        "format": FORMAT,
        "schema": FILE_SCHEMA,
        "rodimpact": __version__,
        "kind": kind,
    }
    content.update(document)
    descriptions = {}
    for name, array in arrays.items():
        descriptions[name] = described(np.asanyarray(array))
    content["arrays"] = descriptions
    text = json.dumps(content, allow_nan=False)
    # NumPy keeps a text with four bytes a character.
    if 4 * len(text) > MAX_DOCUMENT_BYTES:
        message = (
            f"cannot write {os.fspath(path)!r}: the row has too many numbers for one "
            "file"
        )
        raise OSError(message)
    with open_for_writing(path, force=force) as file:
        np.savez_compressed(file, document=np.array(text), **arrays)


def described(array: Any) -> dict[str, Any]:
    """Type, shape and checksum of an array; JSON-ready."""
    as_bytes = np.ascontiguousarray(array).ravel().view(np.uint8).data
    checksum = hashlib.blake2b(as_bytes, digest_size=8).hexdigest()
    return {"type": array.dtype.str, "shape": list(array.shape), "checksum": checksum}
