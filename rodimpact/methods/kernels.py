"""When kernels run compiled: plain Python first, then machine code if it pays.

Both run the same source, with results equal bit for bit. `worth_compiling` decides
between them; `compiled(kernel)` runs on arrays of records. Without numba, everything
runs in plain Python.
"""

import contextlib
import functools
import importlib.util
import os
import warnings
from collections.abc import Iterator

from ..progress import is_watched, write_message
from . import compiling
from .compiling import ONE_AT_A_TIME, Kernel, compiled

__all__ = ["Kernel", "compiled"]

# Processor times, s
STARTING = 0.4  # start of numba
LOADING = 0.1  # reading machine code from disk
COMPILING = 3.0
"""Time in plain Python after which a kernel is compiled, although compiling takes more.

The machine code is kept for later runs.
"""
LIST_TIME = 5e-8  # conversion of a number from an array to a list and back


class NoCompiler(UserWarning):
    """A long run uses plain Python, because numba is missing or does not start.

    Examples
    --------
    A program without numba that suppresses the warning:

    >>> import warnings, rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", ri.NoCompiler)
    ...     outcome = ri.collide(rod, ri.Wall())
    """


def enabled() -> bool:
    """Whether numba is installed, and NUMBA_DISABLE_JIT does not disable it."""
    return _asked_for() and importlib.util.find_spec("numba") is not None


def worth_compiling(seconds: float, kernel: Kernel, ahead: float = 0.0) -> bool:
    """Whether a job is to run compiled.

    Each call adds the time of its job to the time of earlier jobs of the kernel in this
    process. Once this sum plus `ahead` is worth machine code, the result is True, and
    remains True for all later jobs of the kernel. Numba may be started to find out. In
    the context `forced` no time is added: the result is the argument of the context, or
    False if numba does not start.

    Parameters
    ----------
    seconds : float
        Time of the job in plain Python, s.
    kernel : function
        The kernel that the job calls.
    ahead : float, optional
        Time in plain Python that is certain to follow, s.

    Warns
    -----
    NoCompiler
        If machine code would be worth it, but numba is missing or does not start.
    """
    if _forced is not None:  # the context `forced` decides
        is_compiled = _forced and not why_not()
        if is_compiled and _is_kept:
            _ready.add(kernel)
        return is_compiled
    if kernel not in _ready:
        _spent[kernel] = _spent.get(kernel, 0.0) + seconds
        if _asked_for() and _pays(_spent[kernel] + ahead, kernel):  # this may warn
            _ready.add(kernel)
    return kernel in _ready


@contextlib.contextmanager
def forced(compiling: bool) -> Iterator[None]:
    """Context in which every kernel runs compiled (True), or none does (False).

    The time of the job does not matter. If numba does not start, no kernel runs
    compiled. Afterwards the previous setting applies again.
    """
    global _forced
    previous = _forced
    _forced = compiling
    try:
        yield
    finally:
        _forced = previous


@contextlib.contextmanager
def kept() -> Iterator[None]:
    """Context in which kernels that are forced to be compiled remain compiled.

    A kernel that runs compiled in this context because of `forced(True)` runs compiled
    in the rest of the process, too: its machine code is loaded, so that it pays in
    every run. Afterwards the previous setting applies again.
    """
    global _is_kept
    previous = _is_kept
    _is_kept = True
    try:
        yield
    finally:
        _is_kept = previous


_forced: bool | None = None  # setting of the context `forced`; None outside of it
_is_kept = False  # whether the context `kept` is active
_spent: dict[Kernel, float] = {}  # time of each kernel in plain Python so far, s
_ready: set[Kernel] = set()  # kernels that run compiled in this process


def _pays(seconds: float, kernel: Kernel) -> bool:
    """Whether machine code of a kernel is worth its cost.

    `seconds` is the time of the kernel in plain Python. If its machine code is on disk,
    the cost is the time to read it, and to start numba if it has not started. Without
    machine code, a kernel is worth compiling if `seconds` exceed `COMPILING`, as later
    runs gain, too. In this case a message tells a terminal that compiling takes time.
    If nothing can be compiled, the warning NoCompiler says why in its place, and False
    is returned. Nothing is compiled here.
    """
    if _ready:
        price = LOADING
    else:  # numba has not started yet
        price = STARTING + LOADING
    if seconds <= price:  # checked first, as `why_not` and `compiled` start numba
        return False
    reason = why_not()  # "" if numba can compile
    if reason or not compiled(kernel).files():  # no machine code can be read
        if seconds <= COMPILING:
            return False
        _tell(reason)
    return not reason


def why_not() -> str:
    """The reason why nothing can be compiled; "" if kernels can be compiled.

    Numba is started to find out.
    """
    if not _asked_for():
        return "disabled by NUMBA_DISABLE_JIT"
    return _fault()


def _asked_for() -> bool:
    """Whether NUMBA_DISABLE_JIT does not disable compiling: it is not set, "" or 0."""
    return os.environ.get("NUMBA_DISABLE_JIT", "0") in ("", "0")


@functools.cache
def _fault() -> str:
    """The reason why numba does not start, perhaps with a remedy; "" if it starts.

    Numba is started at the first call; later calls return the same text.
    """
    if not importlib.util.find_spec("numba"):
        return "numba is not installed"
    try:
        compiling.compiler()
    except Exception as error:
        # The cause may be numba, a package that it needs, or a variable of the
        # environment with a wrong value: the message lists such variables.
        variables = []
        for name, value in os.environ.items():
            if name.startswith("NUMBA_"):
                variables.append(f"{name} = {value!r}")
        remedy = ""
        if variables:
            remedy = f" Mend or unset {', '.join(variables)}"
        return f"numba does not start: {error}{remedy}"
    return ""


@functools.cache  # a second call with the same reason does nothing
def _tell(reason: str) -> None:
    """Warn with NoCompiler that nothing can be compiled, for this reason.

    If the reason is "", write to the terminal, if there is one, that compiling takes
    time. For the same reason this happens once in a process.
    """
    if reason:
        message = f"{reason}; long runs go in plain Python, some fifty times slower"
        warnings.warn(message, NoCompiler, stacklevel=2)
    elif is_watched():
        write_message("compiling once, for this and all later runs; up to a minute")


if hasattr(os, "register_at_fork"):
    # Functions registered later are called first before a fork. `logging` registers its
    # own lock, which numba takes after this one: in the other order both would wait.
    import logging  # noqa: F401

    # A child that is forked while a thread starts numba or compiles would otherwise
    # wait for ever for the lock of that thread.
    os.register_at_fork(
        before=ONE_AT_A_TIME.acquire,
        after_in_parent=ONE_AT_A_TIME.release,
        after_in_child=ONE_AT_A_TIME.release,
    )
