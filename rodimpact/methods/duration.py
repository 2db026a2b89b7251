"""How long a run takes: who waits is told before it gets long, with what takes less."""

from __future__ import annotations

import time
from collections.abc import Callable

LONG = 8.0  # s, from which a run is announced: before anyone has waited for ten
MORE = 4.0  # times as long as announced, and it is announced again


class LongRun(UserWarning):
    """Something takes long, ten seconds or more; the message says how long, and what takes less."""


class Forecast:
    """Announces a run that takes long.

    Parameters
    ----------
    announce : function or None
        Called with a sentence.
    remedy : str
        What takes less: "a larger rtol or fewer cells".
    """

    def __init__(self, announce: Callable[[str], None] | None, remedy: str) -> None:
        self._announce, self._remedy = announce, remedy
        self._began, self._told = time.monotonic(), LONG / MORE

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
                f"this run takes some {how_long(total)}, perhaps more ({what}); {self._remedy} "
                "takes less"
            )


def how_long(s: float) -> str:
    """A time of so many seconds."""
    minutes, seconds = divmod(round(s), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
