"""The one door to numba: kernels run as plain Python or compiled, bit for bit the same.

A kernel is a plain function in a file of its own, calling only functions of that file (the compile
cache does not notice changes elsewhere). Short jobs run it on lists as it stands, because starting
the compiler costs more than they do; long ones run `compiled(kernel)` on arrays.
"""

from __future__ import annotations

import functools
import os
import sys
import threading
import types
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


@functools.cache
def _compiled(kernel: Kernel) -> Kernel:
    if not enabled():
        return kernel
    try:
        fast = _translate(kernel, True)
    except RuntimeError:  # numba found no place for its cache
        fast = _translate(kernel, False)

    @functools.wraps(kernel)
    def call(*arguments: Any) -> Any:
        nonlocal fast
        try:
            return fast(*arguments)
        except OSError:  # the cache could not be written; nothing has run yet
            fast = _translate(kernel, False)
            return fast(*arguments)

    return call


def cache_directory(kernel: Kernel) -> str:
    """Where the machine code of this kernel is kept; empty if it is kept nowhere."""
    try:
        return str(_translate(kernel, True).stats.cache_path)  # type: ignore[attr-defined]
    except RuntimeError:
        return ""


@functools.cache
def _translate(kernel: Kernel, cache: bool) -> Kernel:
    """Compile a twin of `kernel` whose callees of the same file are compiled twins too."""
    import numba

    assert isinstance(kernel, types.FunctionType)
    scope = dict(kernel.__globals__)
    for name in kernel.__code__.co_names:
        callee = scope.get(name)
        if isinstance(callee, types.FunctionType) and callee.__module__ == kernel.__module__:
            scope[name] = _translate(callee, cache)
    compile_: Any = numba.njit
    twin = types.FunctionType(kernel.__code__, scope, kernel.__name__, kernel.__defaults__)
    twin.__qualname__, twin.__module__ = kernel.__qualname__, kernel.__module__
    # most of a call would be counting references, though kernels make no arrays, and handing a
    # hundred array fields to the next kernel
    switches = {"_nrt": False, "forceinline": True}
    try:
        fast: Kernel = compile_(twin, cache=cache, nogil=True, **switches)
    except KeyError:  # a numba without one of them
        fast = compile_(twin, cache=cache, nogil=True)
    return fast
