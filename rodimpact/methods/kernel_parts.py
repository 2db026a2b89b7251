"""What machine code is made of: the functions that a kernel calls, and the sources of all."""

from __future__ import annotations

import dis
import functools
import hashlib
import types
from pathlib import Path

PACKAGE = Path(__file__).parents[1]


def callees(kernel: types.FunctionType) -> list[types.FunctionType]:
    """Functions that a kernel calls, of its own file and of other kernel files."""
    names = {x.argval for x in dis.get_instructions(kernel) if x.opname == "LOAD_GLOBAL"}
    called = [kernel.__globals__.get(name) for name in sorted(names)]
    return [
        f for f in called if isinstance(f, types.FunctionType)
        and (f.__module__ == kernel.__module__ or f.__module__.endswith("_kernel"))
    ]


@functools.cache
def parts(kernel: types.FunctionType) -> set[types.FunctionType]:
    """A kernel and all that it calls, directly or not."""
    found, waiting = {kernel}, [kernel]
    while waiting:
        new = set(callees(waiting.pop())) - found
        found |= new
        waiting += new
    return found


@functools.cache
def sources() -> bytes:
    """A digest of all kernel files, as constants of one may stand in the code of another.

    And of the files that say how they are translated.
    """
    here = Path(__file__).parent
    files = sorted(PACKAGE.rglob("*_kernel.py"))
    digest = hashlib.blake2b(digest_size=16)
    for file in (*files, here / "columns.py", here / "translation.py"):
        digest.update(hashlib.blake2b(file.read_bytes()).digest())
    return digest.digest()
