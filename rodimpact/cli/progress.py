"""A line on a terminal: how much is done, how fast it goes, and how long it takes yet."""

import math
import shutil
import sys
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from .. import Solution, System, solve
from ..methods.duration import how_long
from . import DONE, INCOMPLETE, complain

REDRAWN = 0.1  # s between two states of the bar
BAR = 30  # characters


class ProgressBar:
    """Called with the number of things done and of all, it shows them."""

    def __init__(self, of: str) -> None:
        self.of = of
        self.width = 0  # of the line that stands there
        self.drawn = -math.inf  # when it was drawn
        self.start: tuple[float, int] | None = (
            None  # the first news, and what was done by then
        )

    def __call__(self, done: int, total: int) -> None:
        """Show that so many are done, unless the last news was just now."""
        now = time.monotonic()
        since, before = self.start = self.start or (now, done)
        if now < self.drawn + REDRAWN:
            return
        self.drawn = now
        part = done / total
        line = f"{math.floor(100 * part):3} %  [{'#' * math.floor(BAR * part):{BAR}}]"
        if (
            now > since and done > before
        ):  # what an earlier run had done tells nothing of the rate
            rate = (done - before) / (now - since)
            number = f"{rate:.3g}" if rate < 100 else f"{rate:,.0f}"
            line += f"  {number} {self.of}/s  {how_long((total - done) / rate)} left"
        self._show(line[: shutil.get_terminal_size().columns - 1])

    def erase(self) -> None:
        """Leave an empty line, if anything was shown."""
        if self.width:
            self._show("")
            print(end="\r", file=sys.stderr, flush=True)

    def _show(self, line: str) -> None:
        print(f"\r{line:{self.width}}", end="", file=sys.stderr, flush=True)
        self.width = len(line)


@contextmanager
def progress_bar(of: str) -> Iterator[ProgressBar | None]:
    """A bar for so many things, erased for warnings and in the end; none where nobody looks."""
    bar = ProgressBar(of)

    def tell(message: Warning | str, *_: Any, **__: Any) -> None:
        bar.erase()
        complain(str(message), DONE)

    try:
        with warnings.catch_warnings():
            warnings.showwarning = tell
            yield bar if sys.stderr.isatty() else None
    finally:
        bar.erase()


def status_of(solution: Solution) -> int:
    """Exit status of a run: whether it came to its end."""
    return INCOMPLETE if solution.stopped_by in ("max_events", "clock") else DONE


def solved(system: System, **options: Any) -> Solution:
    """Solve, with a bar."""
    with progress_bar("steps") as bar:
        return solve(system, progress=bar, **options)
