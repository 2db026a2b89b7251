"""The one door to numba: kernels run as plain Python or compiled, bit for bit the same.

A kernel is a plain function that calls only functions of kernel files (`*_kernel.py`); the compile
cache is told of all of them. Plain Python runs it on lists as it stands, `compiled(kernel)` runs it
on arrays; `worth_compiling` says which. Where there is no numba, everything is plain Python.
"""

from __future__ import annotations

import contextlib
import functools
import importlib.util
import os
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from typing import Any

from .duration import LONG
from .kernel_parts import parts as parts_of

Kernel = Callable[..., Any]

# what things cost, s of processor time
STARTING, LOADING = 0.4, 0.02  # numba itself; machine code from disk
COMPILING = 2e-4  # a byte of bytecode
CALLING = 5e-4  # a compiled call, with space for its arrays
LIST_TIME = 5e-8  # a number to and from a list


class NoCompiler(UserWarning):
    """A long run goes in plain Python, because numba is missing or does not start."""


def enabled() -> bool:
    """Whether kernels may be compiled: numba is there, and NUMBA_DISABLE_JIT does not say no."""
    return _asked_for() and _installed()


def worth_compiling(seconds: float, *kernels: Kernel, ahead: float = 0.0) -> bool:
    """Whether a job shall run compiled.

    A process pays for machine code once plain Python has taken as long for the same kernels, or is
    certain to: it then takes at most about twice the least time.

    Parameters
    ----------
    seconds : float
        What the job takes in plain Python.
    *kernels : function
        What it calls.
    ahead : float, optional
        Seconds in plain Python that are certain to follow.

    Warns
    -----
    NoCompiler
        If it would be worth it, and numba is missing or does not start.
    """
    if _forced is not None:
        return _forced and not why_not()
    if seconds + ahead <= CALLING or not _asked_for():
        return False
    total = _spent.get(kernels, 0.0) + seconds
    if not _pays(total + ahead, [kernel for kernel in kernels if kernel not in _ready]):
        _spent[kernels] = total
        return False
    _ready.update(kernels)
    return True


def pays(spent: float, price: float) -> bool:
    """Whether to go on compiled after so many seconds in plain Python, at this price, s.

    Warns
    -----
    NoCompiler
        If it would, and numba is missing or does not start.
    """
    if _forced is not None:
        return _forced and not why_not()
    if spent < price or not _asked_for():
        return False
    if why_not():
        _tell_of_no_compiler()
        return False
    return True


@contextlib.contextmanager
def forced(compiling: bool) -> Iterator[None]:
    """Compile everything, or nothing, whatever it costs."""
    global _forced
    before, _forced = _forced, compiling
    try:
        yield
    finally:
        _forced = before


_forced: bool | None = None
_spent: dict[tuple[Kernel, ...], float] = {}  # s, in plain Python
_ready: set[Kernel] = set()  # paid for by this process


def _pays(seconds: float, kernels: list[Kernel]) -> bool:
    """Whether machine code of these kernels costs less than so many seconds."""
    if not kernels:
        return True
    price = 0.0 if _ready else STARTING
    if seconds <= price:
        return False  # without a look at the cache, for which numba must start
    reason = why_not()
    to_compile = [kernel for kernel in kernels if reason or not _on_disk(kernel)]
    parts = {part for kernel in to_compile for part in parts_of(kernel)}
    price += LOADING * len(kernels)
    price += COMPILING * sum(len(part.__code__.co_code) for part in parts)
    if seconds <= price:
        return False
    if reason:
        _tell_of_no_compiler()
    elif to_compile:
        _tell_of_compiling(price)
    return not reason


def why_not() -> str:
    """Why nothing is compiled; empty if it can be, which is known once numba has started."""
    if not _asked_for():
        return "disabled by NUMBA_DISABLE_JIT"
    return _fault()


def _asked_for() -> bool:
    return os.environ.get("NUMBA_DISABLE_JIT", "0") in ("", "0")


@functools.cache
def _installed() -> bool:
    return importlib.util.find_spec("numba") is not None


@functools.cache
def _fault() -> str:
    if not _installed():
        return "numba is not installed"
    try:
        _translation()
    except Exception as error:  # of itself, of what it needs, or of a variable with a wrong value
        given = ", ".join(f"{k} = {v!r}" for k, v in os.environ.items() if k.startswith("NUMBA_"))
        remedy = f" Mend or unset {given}" if given else ""
        return f"numba does not start: {error}{remedy}"
    return ""


@functools.cache  # once is enough
def _tell_of_no_compiler() -> None:
    message = f"{why_not()}; long runs go in plain Python, some fifty times slower"
    warnings.warn(message, NoCompiler, stacklevel=2)


def _tell_of_compiling(seconds: float) -> None:
    """Tell who waits, once; a program whose messages go to a file only of what takes long."""
    watched = "ipykernel" in sys.modules or (sys.stderr and sys.stderr.isatty())
    if not _told and sys.stderr and (watched or seconds > LONG):
        sys.stderr.write(f"compiling once, about {seconds:.0f} s\n")
        _told.append(True)


_told: list[bool] = []


def compiled(kernel: Kernel) -> Kernel:
    """Return the same source as machine code, or the kernel itself where there is no compiler.

    Machine code is kept on disk. Where that is impossible (no writable place, full disk) it is
    made anew in each process.
    """
    with _ONE_AT_A_TIME:  # or two threads would compile the same twice
        return _compiled(kernel)


_ONE_AT_A_TIME = threading.RLock()
_held: list[Any] = []  # locks of the thread that forks


def _hold() -> None:
    """Wait for what starts numba or compiles: a child that is forked then would wait for ever."""
    _ONE_AT_A_TIME.acquire()
    _held.append(_ONE_AT_A_TIME)
    if loaded := sys.modules.get("numba.core.compiler_lock"):
        loaded.global_compiler_lock.acquire()
        _held.append(loaded.global_compiler_lock)


def _let_go() -> None:
    """In the parent and in the child: each has its own copy of the locks."""
    held = _held[::-1]
    _held.clear()
    for lock in held:
        lock.release()


if hasattr(os, "register_at_fork"):
    import logging  # noqa: F401 - its lock is taken after these, as numba does: else both would wait

    os.register_at_fork(before=_hold, after_in_parent=_let_go, after_in_child=_let_go)


def as_lists(columns: Any) -> Any:
    """Return a NamedTuple of arrays as one of lists, for a kernel in plain Python."""
    return type(columns)(*(column.tolist() for column in columns))


def copy_back(lists: Any, columns: Any) -> None:
    """Copy what a kernel left in a NamedTuple of lists to the one of arrays."""
    for column, values in zip(columns, lists, strict=True):
        column[:] = values


@functools.cache
def _compiled(kernel: Kernel) -> Kernel:
    if why_not():
        return kernel
    fast: Kernel = _translation().translate(kernel)
    return fast


def cache_directory(kernel: Kernel) -> str:
    """Where the machine code of this kernel is kept; empty if it is kept nowhere."""
    place: str = _translation().directory(kernel)
    return place


def _on_disk(kernel: Kernel) -> bool:
    """Whether there is machine code of this kernel."""
    return bool(_translation().on_disk(kernel))


def _translation() -> Any:
    with _ONE_AT_A_TIME:
        from . import translation  # starts numba

    return translation
