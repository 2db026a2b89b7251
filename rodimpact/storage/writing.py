"""Writing of files: a file is written completely or not at all.

A file is written under a temporary name in the folder of its target, and renamed when
it is complete. Results that can be loaded again are an NPZ file of plain arrays and one
JSON document with all the rest.
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
"""Version of the content of a saved file; readers refuse other versions."""
MAX_DOCUMENT_BYTES = 1 << 28
"""Largest size of the document of a saved file, bytes; a character has four."""
PASSING = ".rodimpact-"
"""Beginning of the temporary names of files that are being written."""
EXISTS = "it exists already; give force=True to replace it"


def file_name(path: Any) -> str:
    """A path as text, unchanged; the file need not exist.

    InvalidModel is raised unless `path` is text or a path object of text, so also for
    bytes or the number of an open file, and for a name with the character NUL.
    """
    name = None
    if isinstance(path, str | os.PathLike):
        name = os.fspath(path)
    if not isinstance(name, str) or "\0" in name:
        raise invalid_argument("path", f"must be the name of a file, got {shown(path)}")
    return name


def check_ending(path: Any, endings: tuple[str, ...], remedy: str) -> None:
    """Raise InvalidModel unless the name of a file ends in one of `endings`.

    The endings are in lower case; the name may have capitals. `remedy` is the end of
    the message.
    """
    name = file_name(path)
    if not name.lower().endswith(endings):
        wanted = " or ".join(endings)
        message = f"must end in {wanted}, got {shown_path(name)}; {remedy}"
        raise invalid_argument("path", message)


def check_target(path: PathLike, *, force: bool = False) -> Path:
    """Check that a file can be written at `path`; nothing is written.

    This is called before a long computation, so that an error comes early.

    Parameters
    ----------
    path : str or path
    force : bool
        Whether an existing file may be replaced.

    Returns
    -------
    Path
        Absolute path of the file, with symbolic links resolved.

    Raises
    ------
    FileExistsError
        If the file is there and `force` is false.
    InvalidModel
        If `path` is not the name of a file, or `force` is not a truth value.
    OSError
        If no file can be written there: `IsADirectoryError`, `NotADirectoryError`,
        `FileNotFoundError` for a missing directory, `PermissionError`, or OSError
        itself, such as for a device.
    """
    path = file_name(path)
    check_flag("force", force)
    mode = 0  # type and permissions of an existing file; 0 if there is none
    refused = f"cannot write {shown_path(path)}: "
    try:
        target = Path(os.path.realpath(path))
        # A missing or wrong directory is refused below, with its own message.
        with contextlib.suppress(FileNotFoundError, NotADirectoryError):
            mode = target.stat().st_mode
    except OSError as error:
        raise type(error)(f"{refused}{error.strerror}") from None
    exists = mode != 0
    folder = target.parent
    ends_in_slash = os.path.basename(path) == ""  # also true for the path ""
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
    # To make a file in a directory takes both permissions, to write and to enter it.
    if not os.access(folder, os.W_OK | os.X_OK):
        message = (
            f"you may not write in the directory {shown_path(folder)}; name another"
        )
        raise PermissionError(refused + message)
    return target


def write_bytes(path: PathLike, data: bytes, *, force: bool = False) -> None:
    """Write a file; an error leaves no partial file.

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
        If the file cannot be written; a subclass where one fits. An existing file is
        then unchanged.
    """
    with open_for_writing(path, force=force) as file:
        file.write(data)


@contextlib.contextmanager
def open_for_writing(path: PathLike, *, force: bool = False) -> Iterator[BinaryIO]:
    """Context with a new file, open for writing bytes piece by piece.

    The file is written under a temporary name in the same folder. At the end of the
    context it is renamed to `path`; after an error it is removed. Parameters and errors
    are those of `write_bytes`.
    """
    target = check_target(path, force=force)
    passing = target.with_name(PASSING + secrets.token_hex(8))
    try:
        with open(passing, "xb") as file:
            yield file
            # All bytes must be on the disk before the file gets its name.
            file.flush()
            os.fsync(file.fileno())
        if force:
            os.replace(passing, target)
        else:
            _place(passing, target)  # refuses a target that was made in the meantime
    except OSError as error:
        reason = str(error)
        if isinstance(error, FileExistsError):
            reason = EXISTS
        elif error.strerror:
            reason = error.strerror
        raise type(error)(f"cannot write {os.fspath(path)!r}: {reason}") from error
    finally:
        with contextlib.suppress(OSError):  # the temporary name may be gone already
            passing.unlink()


def _place(passing: Path, target: Path) -> None:
    """Give the file `passing` the name `target`, without replacing a file.

    FileExistsError is raised if there is a file `target`, even if another program has
    just made it. The name `passing` may still exist afterwards; the caller removes it.
    """
    try:
        os.link(passing, target)
    except FileExistsError:
        raise
    except OSError:  # a file system without links
        # Mode "xb" fails if the file exists: only one program can make this file.
        target.open("xb").close()
        os.replace(passing, target)


def write_text(path: PathLike, text: str, *, force: bool = False) -> None:
    """Write a text file in UTF-8; errors and `force` are those of `write_bytes`."""
    write_bytes(path, text.encode(), force=force)


def write_lines(path: PathLike, lines: Iterable[str], *, force: bool = False) -> None:
    """Write lines of text in UTF-8, each followed by a newline.

    Errors and `force` are those of `write_bytes`.
    """
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
    """Write arrays and a JSON document as one compressed NPZ file.

    `kind` selects the reader in `read_npz`. Format, versions and kind are added to the
    document, and type, shape and checksum of each array, by which `read_npz` checks the
    arrays. A document of more than `MAX_DOCUMENT_BYTES` raises OSError; other errors
    and `force` are those of `write_bytes`.
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
    # A text in a NumPy array has four bytes per character.
    if 4 * len(text) > MAX_DOCUMENT_BYTES:
        message = (
            f"cannot write {os.fspath(path)!r}: the row has too many numbers for one "
            "file"
        )
        raise OSError(message)
    with open_for_writing(path, force=force) as file:
        np.savez_compressed(file, document=np.array(text), **arrays)


def described(array: Any) -> dict[str, Any]:
    """Type, shape and checksum of an array, ready for JSON."""
    as_bytes = np.ascontiguousarray(array).ravel().view(np.uint8).data
    checksum = hashlib.blake2b(as_bytes, digest_size=8).hexdigest()
    return {"type": array.dtype.str, "shape": list(array.shape), "checksum": checksum}
