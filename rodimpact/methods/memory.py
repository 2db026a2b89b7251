"""Limits of the memory of a run.

Memory is checked before it is allocated, and the error of a refused run states its
size. Each method counts the largest memory that it needs at a time: the arrays of its
kernel, the record made from them, and the copies that results need. The limit is the
same on all but small machines, so that a search for an accurate step ends at the same
step on each of them. It also holds for parallel runs in threads, but of runs that need
more than their share, only one runs at a time.
"""

import math
import os
import threading

from ..model.frozen import InvalidModel

MAX_BYTES = 2e9
"""Largest memory of a run: a fixed number, so that searches end alike everywhere."""
SHARE = 1 / 4
"""Part of the machine's memory for a run, if this is less than `MAX_BYTES`."""

_turn = threading.Lock()  # held by the thread that may take more than its share
_thread = threading.local()
"""Limit of the present thread, if `limit_to_share` has set one.

Its attributes are `share`, in bytes, and `has_turn`, whether the thread holds `_turn`.
A thread without a limit has no attributes.
"""


def _new_turns() -> None:
    """Make a new lock of turns in a forked child.

    The old lock may be held by a thread that does not exist in the child.
    """
    global _turn
    _turn = threading.Lock()
    _thread.has_turn = False


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_new_turns)


class TooLong(InvalidModel):
    """A run needs more memory than it may take."""

    size: str = ""
    """The message without its remedy: the work, its memory and the limit."""


def installed() -> float:
    """Memory of this machine, bytes; inf if the operating system does not state it."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):
        return math.inf


def max_numbers() -> float:
    """Largest count of numbers of 8 bytes that a run may keep."""
    return min(MAX_BYTES, SHARE * installed()) / 8


def require_memory(numbers: float, field: str, work: str, remedy: str) -> None:
    """Raise TooLong if a run needs more memory than it may take; nothing is allocated.

    A thread with a limit, see `limit_to_share`, that needs more than its share waits
    here for its turn, and keeps the turn until `end_turn`.

    Parameters
    ----------
    numbers : float
        Count of the numbers of 8 bytes that the run needs.
    field : str
        Path of the error: the argument that the user should change.
    work : str
        The work that needs the memory, for the message.
    remedy : str
        Advice, for the message.

    Raises
    ------
    TooLong
        If `numbers` exceeds `max_numbers`.
    """
    most = max_numbers()
    if numbers > most:
        size = (
            f"{work} needs {8e-9 * numbers:.3g} GB of memory, "
            f"more than {8e-9 * most:.3g} GB"
        )
        error = TooLong([(field, f"{size}; {remedy}")])
        error.size = size
        raise error
    share = getattr(_thread, "share", math.inf)  # bytes; inf without a limit
    # `has_turn` exists if there is a limit. Otherwise the first condition is false.
    if 8 * numbers > share and not _thread.has_turn:
        _turn.acquire()
        _thread.has_turn = True


class LargeFile(MemoryError):
    """A file needs more memory than it may take."""

    def __init__(self, path: str, message: str) -> None:
        self.problems = [(path, message)]
        super().__init__(f"{path}: {message}")


def check_file(path: object, size: float, remedy: str) -> None:
    """Raise LargeFile if a file needs more than half of this machine's memory.

    `path` is the path of the file, `size` an upper bound of the memory that it needs,
    in bytes, and `remedy` advice for the message.
    """
    if size > installed() / 2:
        taken = f"takes up to {size / 1e9:.3g} GB of memory, more than half of the"
        raise LargeFile(str(path), f"{taken} {installed() / 1e9:.3g} GB here; {remedy}")


def limit_to_share(threads: int) -> None:
    """Limit this thread to its share of a quarter of the machine's memory.

    The quarter is divided by the number of threads. A thread that needs more than its
    share waits in `require_memory` until no other thread takes more; its turn lasts
    until `end_turn`. So all threads together take at most half of the memory.
    """
    _thread.share = SHARE * installed() / threads
    _thread.has_turn = False


def end_turn() -> None:
    """End the turn of this thread, so that another may take more than its share.

    If the thread does not have the turn, nothing happens.
    """
    if getattr(_thread, "has_turn", False):
        _thread.has_turn = False
        _turn.release()
