"""How much memory a run may take.

It is checked before it is taken, and refused with the figure. What a method takes it
counts itself, at its largest: the arrays of its kernel, the record made of them, and
the copies that results need. The limit is the same on all but small machines, so that a
search for an accurate step ends at the same step on each. Runs side by side in threads
have it too, but those that take more than their share of it go one after the other.
"""

import math
import os
import threading

from ..model.frozen import InvalidModel

MAX_BYTES = 2e9
"""Memory that a run may take: a fixed number, so that searches end alike everywhere."""
SHARE = 1 / 4
"""Part of the machine's memory for a run, where that is less than `MAX_BYTES`."""

_turn = threading.Lock()  # held by the one thread that takes more than its share
_thread = threading.local()
"""What a thread that `limit_to_share` has limited may take.

It has its `share`, bytes, and whether it `has_turn`. Other threads have neither.
"""


def _new_turns() -> None:
    """Begin turns anew in a forked child.

    The thread whose turn it was is missing there.
    """
    global _turn
    _turn = threading.Lock()
    _thread.has_turn = False


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_new_turns)


class TooLong(InvalidModel):
    """A run takes more steps than there is memory for."""

    size: str = ""
    """What takes the memory, and how much: the message without its remedy."""


def installed() -> float:
    """Bytes of memory that this machine has; inf if the system does not say."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):
        return math.inf


def max_numbers() -> float:
    """Numbers of 8 bytes that a run may keep."""
    return min(MAX_BYTES, SHARE * installed()) / 8


def require_memory(numbers: float, field: str, work: str, remedy: str) -> None:
    """Raise TooLong where so many numbers of 8 bytes are more than `max_numbers`.

    A thread that is limited to a share, see `limit_to_share`, waits here for its turn
    if it needs more than that, and has the turn until `end_turn`. Nothing is
    allocated.

    Parameters
    ----------
    numbers : float
    field : str
        Path of the error: the argument that is to be changed.
    work : str
        What takes the memory, for the message.
    remedy : str
        Advice, for the message.

    Raises
    ------
    TooLong
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
    share = getattr(_thread, "share", math.inf)  # bytes
    # A thread that has a share has `has_turn` as well;
    # without a share nothing is more than inf.
    if 8 * numbers > share and not _thread.has_turn:
        _turn.acquire()
        _thread.has_turn = True


class LargeFile(MemoryError):
    """A file takes more memory than there is for it."""

    def __init__(self, path: str, message: str) -> None:
        self.problems = [(path, message)]
        super().__init__(f"{path}: {message}")


def check_file(path: object, size: float, remedy: str) -> None:
    """Raise LargeFile where a file takes over half of this machine's memory.

    It takes up to `size` bytes. `remedy` is advice, for the message.
    """
    if size > installed() / 2:
        taken = f"takes up to {size / 1e9:.3g} GB of memory, more than half of the"
        raise LargeFile(str(path), f"{taken} {installed() / 1e9:.3g} GB here; {remedy}")


def limit_to_share(threads: int) -> None:
    """Limit this thread to its part of what all `threads` may take together.

    A thread that needs more waits in `require_memory` until no other thread takes more;
    its turn lasts until `end_turn`. All together take half of the machine's memory at
    most.
    """
    _thread.share = SHARE * installed() / threads
    _thread.has_turn = False


def end_turn() -> None:
    """End the turn of this thread, if it has it.

    Then another may take more than its share.
    """
    if getattr(_thread, "has_turn", False):
        _thread.has_turn = False
        _turn.release()
