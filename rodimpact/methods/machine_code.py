"""Files of machine code: what is not exactly what was written there is never run."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import uuid
import warnings
from pathlib import Path

SEAL = 16  # bytes of checksum after machine code


class DamagedCache(UserWarning):
    """Machine code on disk is not what was written, and is made anew."""


def read(file: Path) -> bytes | None:
    """Return what was written to the file; None where there is no such file, or it is damaged."""
    try:
        data = file.read_bytes()
    except OSError:
        return None
    code = data[:-SEAL]
    if data[-SEAL:] == _seal(file, code):
        return code
    _tell_of_damage()
    return None


def write(file: Path, code: bytes) -> None:
    """Write the file, whole or not at all; a full disk is no error."""
    new = file.with_name(f"{uuid.uuid4().hex}.tmp")
    with contextlib.suppress(OSError):
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            new.write_bytes(code + _seal(file, code))
            os.replace(new, file)
        finally:
            new.unlink(missing_ok=True)


def _seal(file: Path, code: bytes) -> bytes:
    return hashlib.blake2b(file.name.encode() + code, digest_size=SEAL).digest()


@functools.cache  # once is enough
def _tell_of_damage() -> None:
    message = "machine code in the compiler's cache is damaged; it is made anew"
    warnings.warn(message, DamagedCache, stacklevel=2)
