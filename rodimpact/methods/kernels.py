"""The one door to numba: kernels run as plain Python or compiled, bit for bit the same.

A kernel is a plain function that calls only functions of kernel files (`*_kernel.py`); the compile
cache is told of all of them. Short jobs run it on lists as it stands, because starting the compiler
costs more than they do; long ones run `compiled(kernel)` on arrays.
"""

from __future__ import annotations

import contextlib
import dis
import functools
import hashlib
import os
import sys
import threading
import types
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .duration import LongRun

Kernel = Callable[..., Any]


class DamagedCache(UserWarning):
    """Machine code on disk is not what was written, and is made anew."""


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
SEAL = 16  # bytes of checksum after machine code
LOADING, PATIENCE = 0.005, 2.0  # s: of a compiled call, and of plain Python before the first one
LARGE = 9  # functions of a kernel, from which compiling takes seconds
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
    try:
        return _translate(kernel, True)
    except RuntimeError:  # numba found no place for its cache
        return _translate(kernel, False)


def cache_directory(kernel: Kernel) -> str:
    """Where the machine code of this kernel is kept; empty if it is kept nowhere."""
    try:
        return str(_translate(kernel, True).stats.cache_path)  # type: ignore[attr-defined]
    except RuntimeError:
        return ""


@functools.cache
def _translate(kernel: Kernel, cache: bool) -> Kernel:
    """Compile a twin of `kernel` whose callees in kernel files are compiled twins too."""
    try:
        import numba
    except ValueError as error:
        given = ", ".join(f"{k} = {v!r}" for k, v in os.environ.items() if k.startswith("NUMBA_"))
        message = f"numba does not start: {error} Mend or unset this environment variable"
        raise OSError(f"{given}: {message}") from None

    assert isinstance(kernel, types.FunctionType)
    scope = dict(kernel.__globals__)
    for callee in _callees(kernel):
        scope[callee.__name__] = _translate(callee, cache)
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
    if cache:
        with contextlib.suppress(AttributeError):  # a numba whose cache has other parts
            _watch(fast._cache._cache_file, kernel)  # type: ignore[attr-defined]
            _mend(fast._cache, kernel)  # type: ignore[attr-defined]
    return fast


def _callees(kernel: types.FunctionType) -> list[types.FunctionType]:
    """Functions that a kernel calls, of its own file and of other kernel files."""
    names = {x.argval for x in dis.get_instructions(kernel) if x.opname == "LOAD_GLOBAL"}
    called = [kernel.__globals__.get(name) for name in sorted(names)]
    return [
        f for f in called if isinstance(f, types.FunctionType)
        and (f.__module__ == kernel.__module__ or f.__module__.endswith("_kernel"))
    ]


def _parts(kernel: types.FunctionType) -> set[types.FunctionType]:
    """A kernel and all that it calls, directly or not."""
    parts, waiting = {kernel}, [kernel]
    while waiting:
        new = set(_callees(waiting.pop())) - parts
        parts |= new
        waiting += new
    return parts


def _watch(file: Any, kernel: types.FunctionType) -> None:
    """Let the cache notice a change in any source that the kernel is made of, or in itself."""
    sources = [os.stat(name) for name in sorted({f.__code__.co_filename for f in _parts(kernel)})]
    stamp = repr([(source.st_mtime, source.st_size) for source in sources]) + " sealed"
    dump, load = file._dump, file._load_data

    def seal(data: bytes) -> bytes:
        return hashlib.blake2b(stamp.encode() + data, digest_size=SEAL).digest()

    def dump_sealed(code: Any) -> bytes:
        data: bytes = dump(code)
        return data + seal(data)  # what reads it ends before the seal

    def load_sealed(name: str) -> Any:
        data = Path(file._data_path(name)).read_bytes()
        if data[-SEAL:] != seal(data[:-SEAL]):
            raise ValueError(f"{name} is damaged")
        return load(name)

    file._source_stamp, file._dump, file._load_data = stamp, dump_sealed, load_sealed


def _mend(cache: Any, kernel: types.FunctionType) -> None:
    """Let the compiler do without what cannot be read from the cache, or written to it."""
    load, save = cache.load_overload, cache.save_overload
    large = len(_parts(kernel)) > LARGE

    def load_or_none(signature: Any, target: Any) -> Any:
        try:
            code = load(signature, target)
        except OSError:
            return None
        except Exception:  # pickle raises a dozen kinds for a damaged file
            with contextlib.suppress(OSError):
                cache.flush()
            _tell_of_damage()
            return None
        if code is None and large:
            _tell_of_compiling()
        return code

    def save_if_possible(signature: Any, code: Any) -> None:
        with contextlib.suppress(Exception):  # a full disk, or an index that nobody may mend
            save(signature, code)

    cache.load_overload, cache.save_overload = load_or_none, save_if_possible


@functools.cache
def _tell_of_compiling() -> None:
    if sys.stderr and sys.stderr.isatty():  # somebody waits for it
        message = "machine code is made for this machine, once; that takes some ten seconds"
        warnings.warn(message, LongRun, stacklevel=2)


@functools.cache  # once is enough, though each kernel has files of its own
def _tell_of_damage() -> None:
    message = "machine code in the compiler's cache is damaged; it is made anew"
    warnings.warn(message, DamagedCache, stacklevel=2)
