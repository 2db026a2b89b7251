"""Files appear whole or not at all.

A file is written under a passing name beside its target and moved into place when it is complete.
What is to be loaded again is an NPZ of plain arrays, with everything else in one JSON document.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import os
import secrets
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias

import numpy as np

from .. import __version__

PathLike: TypeAlias = "str | os.PathLike[str]"
Arrays: TypeAlias = dict[str, Any]

FORMAT = "rodimpact"
SCHEMA = 2
"""Version of what a saved file holds; older readers refuse files with a higher one."""


class FileFormatError(ValueError):
    """A file is not what rodimpact saved: foreign, damaged, or of a newer version."""


def check_target(path: PathLike, *, force: bool = False) -> Path:
    """Make sure that a file may be written at `path`; worth asking before a long computation.

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
    OSError
        The subclass that fits (`IsADirectoryError`, `NotADirectoryError`, `FileNotFoundError` for a
        missing directory): where no file can be.
    """
    target = Path(os.path.realpath(path))
    refused = f"cannot write {os.fspath(path)!r}: "
    if target.is_dir() or not os.path.basename(path):
        raise IsADirectoryError(refused + "it is a directory; add the name of a file")
    if target.exists():
        if not target.is_file():
            raise OSError(refused + "it is not a regular file")
        if not force:
            message = "it exists already; give --force (in Python force=True) to replace it"
            raise FileExistsError(refused + message)
    elif not target.parent.exists():
        raise FileNotFoundError(refused + f"there is no directory {str(target.parent)!r}; make it")
    elif not target.parent.is_dir():
        raise NotADirectoryError(refused + f"{str(target.parent)!r} is not a directory")
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
        Or a subclass, with a sentence, if the file cannot be written; an existing one is unharmed.
    """
    with written(path, force=force) as file:
        file.write(data)


@contextlib.contextmanager
def written(path: PathLike, *, force: bool = False) -> Iterator[BinaryIO]:
    """Open a file to be written piece by piece; it appears when all is written, or not at all.

    Parameters and errors are those of `write_bytes`.
    """
    target = check_target(path, force=force)
    passing = target.with_name(f".rodimpact-{secrets.token_hex(8)}")
    try:
        with open(passing, "xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.replace(passing, target)
    except BaseException as error:
        with contextlib.suppress(OSError):
            passing.unlink()
        if isinstance(error, OSError):
            message = f"cannot write {os.fspath(path)!r}: {error.strerror or error}"
            raise type(error)(message) from error
        raise


def write_text(path: PathLike, text: str, *, force: bool = False) -> None:
    """Write a text file in UTF-8, as `write_bytes` does."""
    write_bytes(path, text.encode(), force=force)


def write_npz(
    path: PathLike, kind: str, document: dict[str, Any], arrays: Arrays, *, force: bool = False
) -> None:
    """Write arrays and a JSON document as one compressed NPZ that `load` knows by its `kind`."""
    head = {"format": FORMAT, "schema": SCHEMA, "rodimpact": __version__, "kind": kind}
    text = json.dumps(_finite({**head, **document}), allow_nan=False)
    buffer = io.BytesIO()
    np.savez_compressed(buffer, document=np.array(text), **arrays)
    write_bytes(path, buffer.getvalue(), force=force)


_SPECIAL = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}  # JSON has no such numbers


def _finite(value: Any) -> Any:
    """The same with numbers that JSON lacks as words."""
    if isinstance(value, float) and not math.isfinite(value):
        return str(float(value))
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    return [_finite(item) for item in value] if isinstance(value, list | tuple) else value


def restored(value: Any) -> Any:
    """Undo `_finite`; lists become tuples."""
    if isinstance(value, dict):
        return {key: restored(item) for key, item in value.items()}
    if isinstance(value, list):
        return tuple(restored(item) for item in value)
    return _SPECIAL.get(value, value) if isinstance(value, str) else value
