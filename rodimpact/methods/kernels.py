"""The one door to the compiler: kernels run as plain Python or compiled, bit for bit the same.

A kernel is a plain function that calls only functions of kernel files (`*_kernel.py`); the compile
cache is told of all of them. Short jobs run it on lists as it stands, because starting the compiler
costs more than they do; long ones run `compiled(kernel)` on arrays.
"""

from __future__ import annotations

import functools
import os
import sys
import threading
from collections.abc import Callable
from typing import Any

Kernel = Callable[..., Any]


def enabled() -> bool:
    """Whether kernels may be compiled (NUMBA_DISABLE_JIT says no)."""
    return os.environ.get("NUMBA_DISABLE_JIT", "0") in ("", "0")


def started() -> bool:
    """Whether this process has paid for starting the compiler already."""
    return enabled() and "numba" in sys.modules


def compiled(kernel: Kernel) -> Kernel:
    """Return the same source as machine code, or the kernel itself where compiling is disabled.

    Machine code is kept on disk. Where that is impossible (no writable place, full disk) it is
    made anew in each process.
    """
    with _ONE_AT_A_TIME:  # or two threads would compile the same twice
        return _compiled(kernel)


_ONE_AT_A_TIME = threading.Lock()
LOADING, PATIENCE = 0.005, 2.0  # s: of a compiled call, and of plain Python before the first one
LIST_TIME = 5e-8  # s: of a number to and from a list
_spent = 0.0


def worth_compiling(seconds: float) -> bool:
    """Whether a job of so many seconds in plain Python shall run compiled.

    Starting the compiler takes about a second, and many the first time on a machine; a process
    does without until its short jobs have added up to as much.
    """
    global _spent
    if not enabled():
        return False
    if started():
        return seconds > LOADING
    _spent += seconds
    return _spent > PATIENCE


def as_lists(columns: Any) -> Any:
    """Return a NamedTuple of arrays as one of lists, for a kernel in plain Python."""
    return type(columns)(*(column.tolist() for column in columns))


def copy_back(lists: Any, columns: Any) -> None:
    """Copy what a kernel left in a NamedTuple of lists to the one of arrays."""
    for column, values in zip(columns, lists, strict=True):
        column[:] = values


@functools.cache
def _compiled(kernel: Kernel) -> Kernel:
    if not enabled():
        return kernel
    fast: Kernel = _compiler().translate(kernel)
    return fast


def cache_directory(kernel: Kernel) -> str:
    """Where the machine code of this kernel is kept; empty if it is kept nowhere."""
    place: str = _compiler().directory(kernel)
    return place


def _compiler() -> Any:
    """Load numba."""
    try:
        from . import translation
    except ValueError as error:
        given = ", ".join(f"{k} = {v!r}" for k, v in os.environ.items() if k.startswith("NUMBA_"))
        message = f"numba does not start: {error} Mend or unset this environment variable"
        raise OSError(f"{given}: {message}") from None
    return translation
