"""How long work takes: who waits is told before it gets long, with what takes less, and how far."""

import time
import warnings
from collections.abc import Callable
from typing import Any

LONG = 4.0  # s, from which work is announced: before anyone has waited for five
MORE = 4.0  # times as long as announced, and it is announced again
SOON = 0.5  # s of work that tell how long all of it takes
QUIET = 1.0  # s of work before progress is reported
NEWS = 0.1  # s between two reports

Progress = Callable[[int, int], Any]
"""Called with what is done and about how much there is to do."""


class LongRun(UserWarning):
    """Something takes five seconds or more; the message says how long, and what takes less.

    Examples
    --------
    A program that knows its runs are long:

    >>> import warnings, rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", ri.LongRun)
    ...     outcome = ri.collide(rod, ri.Wall())
    """


def warn(sentence: str) -> None:
    """Announce work by a warning."""
    warnings.warn(sentence, LongRun, stacklevel=4)


class Forecast:
    """Announces work that takes long, and reports its progress.

    Parameters
    ----------
    announce : function or None
        Called with a sentence.
    remedy : str
        What takes less: "a larger rtol or fewer cells".
    progress : function, optional
    work : str
        What it is.
    """

    def __init__(
        self,
        announce: Callable[[str], None] | None,
        remedy: str,
        progress: Progress | None = None,
        work: str = "this run",
    ) -> None:
        self._announce, self._remedy, self._progress, self._work = (
            announce,
            remedy,
            progress,
            work,
        )
        self._began, self._told = time.monotonic(), LONG / MORE
        self._next = 0.0

    def expect(self, seconds: float, what: str) -> None:
        """Say how long all takes, if that is long, where it goes on for so many seconds.

        Parameters
        ----------
        seconds : float
            From now on; as a search goes on, and as far as is known.
        what : str
            What takes them: "1200 steps, 100 cells".
        """
        total = time.monotonic() - self._began + seconds
        if self._announce and total > MORE * self._told:
            self._told = total
            self._announce(
                f"{self._work} takes some {how_long(total)}, perhaps more ({what}); "
                f"{self._remedy} takes less"
            )

    def extrapolate(self, done: int, total: int, what: str) -> None:
        """Say how long all takes at the rate so far; arguments as of `report`."""
        spent = time.monotonic() - self._began
        if done and spent > SOON:
            self.expect(spent * max(total - done, 0) / done, what)

    def reached(self, done: int, total: int) -> None:
        """Report progress of long work, not more often than anyone can see."""
        now = time.monotonic()
        if self._progress and now > max(self._next, self._began + QUIET):
            self._next = now + NEWS
            self._progress(done, max(done, total))

    def report(self, done: int, total: int, what: str) -> None:
        """Say how far work is, and how long all of it takes at the rate so far.

        Parameters
        ----------
        done, total : int
            What is done, and about how much there is to do.
        what : str
            What there is to do: "300 cells".
        """
        self.extrapolate(done, total, what)
        self.reached(done, total)


def how_long(s: float) -> str:
    """A time of so many seconds."""
    minutes, seconds = divmod(round(s), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
