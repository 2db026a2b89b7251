"""When kernels run compiled: plain Python goes first, machine code where it pays.

Both run the same source, bit for bit. `worth_compiling` says which, `compiled(kernel)`
runs on arrays of records. Where there is no numba, everything is plain Python.
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
STARTING = 0.4  # numba starts
LOADING = 0.1  # machine code is read from disk
COMPILING = 3.0
"""Time in plain Python after which a kernel is compiled at any cost: it is kept."""
LIST_TIME = 5e-8  # a number goes to a list and back


class NoCompiler(UserWarning):
    """A long run goes in plain Python, because numba is missing or does not start.

    Examples
    --------
    A program without numba that shall be silent:

    >>> import warnings, rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", ri.NoCompiler)
    ...     outcome = ri.collide(rod, ri.Wall())
    """


def enabled() -> bool:
    """Whether kernels may be compiled.

    Then numba is there, and NUMBA_DISABLE_JIT does not say no.
    """
    return _asked_for() and importlib.util.find_spec("numba") is not None


def worth_compiling(seconds: float, kernel: Kernel, ahead: float = 0.0) -> bool:
    """Whether a job shall run compiled.

    Each call adds the seconds of its job to those of earlier jobs of the kernel in this
    process, until their sum and what lies ahead are worth it; from then on every job
    is. To see that, numba is started. In the context `forced` nothing is added: jobs
    run compiled if the context says so and numba starts.

    Parameters
    ----------
    seconds : float
        What the job takes in plain Python.
    kernel : function
        What it calls.
    ahead : float, optional
        Seconds in plain Python that are certain to follow.

    Warns
    -----
    NoCompiler
        If it would be worth it, and numba is missing or does not start.
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

    The cost does not matter. Where numba does not start, none does either way. Behind
    the context what was before counts again.
    """
    global _forced
    before = _forced
    _forced = compiling
    try:
        yield
    finally:
        _forced = before


@contextlib.contextmanager
def kept() -> Iterator[None]:
    """Context in which kernels that are forced to be compiled stay so in this process.

    Kernels that `forced(True)` makes run compiled here do so behind both contexts, too:
    their machine code is loaded, so that it pays in every run.
    """
    global _is_kept
    before = _is_kept
    _is_kept = True
    try:
        yield
    finally:
        _is_kept = before


_forced: bool | None = None
_is_kept = False
_spent: dict[Kernel, float] = {}  # s, in plain Python
_ready: set[Kernel] = set()  # paid for by this process


def _pays(seconds: float, kernel: Kernel) -> bool:
    """Whether machine code of a kernel is worth its cost in a run of so many seconds.

    The seconds are those in plain Python. Machine code on disk costs little: a start of
    numba, if it has not started, and reading. Without any, a kernel is worth compiling
    once the seconds exceed `COMPILING`, as later runs gain by it. Then a terminal is
    told that this takes time; if nothing can be compiled, NoCompiler warns why, and
    False is returned. Nothing is compiled yet.
    """
    if _ready:
        price = LOADING
    else:  # numba has not started yet
        price = STARTING + LOADING
    if seconds <= price:
        return False  # a look at the cache would start numba
    reason = why_not()  # "" if numba compiles
    if reason or not compiled(kernel).files():  # there is no machine code of it
        if seconds <= COMPILING:
            return False
        _tell(reason)
    return not reason


def why_not() -> str:
    """Why nothing is compiled.

    It is empty if it can be, which is known once numba has started.
    """
    if not _asked_for():
        return "disabled by NUMBA_DISABLE_JIT"
    return _fault()


def _asked_for() -> bool:
    """Whether NUMBA_DISABLE_JIT does not say no."""
    return os.environ.get("NUMBA_DISABLE_JIT", "0") in ("", "0")


@functools.cache
def _fault() -> str:
    """Why numba does not start, with a remedy; empty if it does.

    It is started here if it has not been. The answer of the first call stays.
    """
    if not importlib.util.find_spec("numba"):
        return "numba is not installed"
    try:
        compiling.compiler()
    except Exception as error:
        # The fault may be numba's, that of what it needs,
        # or a variable with a wrong value.
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
    """Warn NoCompiler that nothing is compiled for this reason.

    If the reason is "", tell a terminal, if there is one, that compiling takes time.
    Each reason is told once in a process.
    """
    if reason:
        message = f"{reason}; long runs go in plain Python, some fifty times slower"
        warnings.warn(message, NoCompiler, stacklevel=2)
    elif is_watched():
        write_message("compiling once, for this and all later runs; up to a minute")


if hasattr(os, "register_at_fork"):
    # Its lock is taken after this one, as numba does: else both wait.
    import logging  # noqa: F401

    # a child that is forked while a thread starts numba or compiles would wait for ever
    os.register_at_fork(
        before=ONE_AT_A_TIME.acquire,
        after_in_parent=ONE_AT_A_TIME.release,
        after_in_child=ONE_AT_A_TIME.release,
    )
