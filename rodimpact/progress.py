"""Progress of long calls: a bar of tqdm, or calls of the user's own function.

A call that may take long reports its progress::

    with Progress(progress, "sweep", "collisions") as report:
        report(done, total)

Only the outermost of such calls has a bar: a fit that runs sweeps shows one bar, not
many. A call inside another call of the same name reports to the bar of that call. The
bar appears after two seconds, on a terminal or in a notebook, and never in worker
threads or worker processes. tqdm is imported when the bar appears, as its import takes
longer than most calls. Messages and warnings stand above the bar.
"""

from __future__ import annotations

import contextlib
import math
import sys
import threading
import time
import warnings
from collections.abc import Callable
from types import TracebackType
from typing import Any

from .units import shown

APPEARS_AFTER = 2.0  # s of work before a bar appears
REDRAWN_AFTER = 0.1  # s between two drawings of a bar
ABBREVIATED_FROM = 100_000  # units from which on the bar writes 100k

NOTEBOOK_KERNELS = ("ipykernel.zmqshell", "IPython.utils._process_emscripten")
"""Modules of the kernels of Jupyter and of JupyterLite."""

ProgressFunction = Callable[[int, int | None], object]
"""The user's function: takes the work done and the total, which is None if unknown."""
ProgressReport = Callable[[int, int | None], None]
"""Takes the work done and the total, None if unknown, from a long call."""


def no_report(done: int, total: int | None) -> None:
    """Ignore a report: no progress is shown."""


def is_function(value: object) -> bool:
    """Whether a value is callable, and not a class: a class would make an object."""
    if isinstance(value, type):
        return False
    return callable(value)


def check_progress(problems: list[tuple[str, str]], value: object) -> None:
    """Add a problem of a value that cannot be the argument `progress`."""
    if not isinstance(value, bool) and not is_function(value):
        wanted = "must be True, False or a function of (done, total)"
        problems.append(("progress", f"{wanted}, got {shown(value)}"))


class Progress:
    """Progress of one call, from its first statement to its last.

    Parameters
    ----------
    progress : bool or function
        Whether a bar may appear, or a function to be called in its place. An error of
        this function ends the call.
    name : str
        Name of the call, to the left of the bar.
    unit : str
        Plural of what is counted: "collisions".
    """

    def __init__(self, progress: bool | ProgressFunction, name: str, unit: str) -> None:
        """Store the arguments; nothing is shown before the call begins."""
        self._progress = progress
        self._name = name
        self._unit = unit
        self._is_outermost = False  # whether no other call shows its progress
        self._bar: Any = None
        self._showwarning: Any = None  # `warnings.showwarning` without the bar
        self._began = math.inf  # s, time.time(); inf: no bar will appear
        # Work done at the first report, taken over from a checkpoint. It is left out of
        # the rate.
        self._done_before: int | None = None

    def __enter__(self) -> ProgressReport:
        """Begin the call; return the function to which it reports its progress.

        Inside an outermost call of the same name, it is the function of that call. Else
        it calls the user's function, if there is one; or updates the bar, if this is
        the outermost call and a bar is wanted; or does nothing. In a worker thread no
        call is outermost.
        """
        global _outermost
        self._is_outermost = False
        if in_main_thread():
            if _outermost is None:
                _outermost = self
                self._is_outermost = True
            elif _outermost._name == self._name:
                return _outermost._report
        if callable(self._progress):
            return self._report
        if self._progress and self._is_outermost:
            self._began = time.time()
            return self._report
        return no_report

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        """End the call; the outermost one erases its bar.

        The bar is full unless an error ends the call. The error is not caught.
        """
        global _outermost
        if not self._is_outermost:
            return
        _outermost = None
        if self._bar is not None:
            if kind is None:
                self._bar.total = self._bar.n  # totals may have been estimates
            self._close()

    def _report(self, done: int, total: int | None) -> None:
        """Call the user's function, or else show the bar.

        Both get the work done and the total, None if unknown; a total below the work
        done is set to it. The bar appears at the first report after `APPEARS_AFTER`
        seconds, if somebody can see it.
        """
        if total is not None:
            total = max(done, total)
        if callable(self._progress):
            self._progress(done, total)
            return
        if self._done_before is None:
            self._done_before = done  # more than 0 after a checkpoint
        if self._bar is None and time.time() >= self._began + APPEARS_AFTER:
            if is_watched():
                self._open(total)
            else:
                self._began = math.inf  # nobody watches: never check again
        if self._bar is not None:
            self._update(done, total)

    def _open(self, total: int | None) -> None:
        """Make a progress bar, and show warnings above it from now on.

        Its time is measured from the beginning of the call. `total` is None if it is
        unknown. The bar is drawn by the first update.
        """
        kind_of_bar = bar_class()
        self._bar = kind_of_bar(
            desc=self._name,
            unit=f" {self._unit}",
            initial=self._done_before,  # work done earlier: tqdm leaves it out of rates
            total=total,
            file=sys.stderr,
            leave=False,
            mininterval=REDRAWN_AFTER,
            miniters=0,  # else tqdm redraws only after as much work as before
            delay=1e-9,  # s; any delay keeps tqdm from drawing before the times are set
            dynamic_ncols=True,
        )
        self._bar.start_t = self._began
        self._bar.last_print_t = self._began
        self._showwarning = warnings.showwarning
        warnings.showwarning = self._show_warning

    def _update(self, done: int, total: int | None) -> None:
        """Set the bar to the work done and the total, None if unknown.

        If less work is done than before, a new stage has begun: the bar starts again.
        Numbers are abbreviated if one reaches `ABBREVIATED_FROM`.
        """
        bar = self._bar
        if done < bar.n:  # a new stage, such as a finer mesh
            bar.reset(total)
            bar.initial = 0
        if total != bar.total:
            bar.total = total
            # The bar of a notebook is a widget, which has a total of its own.
            if total and hasattr(bar, "container"):
                bar.container.children[1].max = total
        largest = done
        if total is not None:
            largest = max(done, total)
        bar.unit_scale = largest >= ABBREVIATED_FROM
        bar.update(done - bar.n)  # tqdm takes the increase

    def _close(self) -> None:
        """Erase the bar, and show warnings as before."""
        if warnings.showwarning == self._show_warning:
            warnings.showwarning = self._showwarning
        self._bar.close()

    def _show_warning(self, *message: Any, **more: Any) -> None:
        """Show a warning above the bar; arguments as for `warnings.showwarning`."""
        with self.above_bar():
            self._showwarning(*message, **more)

    def above_bar(self) -> contextlib.AbstractContextManager[None]:
        """Context in which text for standard error stands above the bar.

        The bar is erased on entry and drawn again on exit. Without a bar the context
        does nothing.
        """
        if self._bar is None:
            return contextlib.nullcontext()
        context: contextlib.AbstractContextManager[None]
        context = self._bar.external_write_mode(file=sys.stderr)
        return context


_outermost: Progress | None = None
"""Call whose progress is shown; only the main thread of the main process has one."""


def write_message(sentence: str) -> None:
    """Print a line on standard error, above the bar of the outermost call if any."""
    above_bar: contextlib.AbstractContextManager[None] = contextlib.nullcontext()
    if _outermost is not None:
        above_bar = _outermost.above_bar()
    with above_bar:
        sys.stderr.write(f"{sentence}\n")


def in_main_thread() -> bool:
    """Whether this is the thread in which the program, or a notebook's cell, runs."""
    return threading.get_ident() == threading.main_thread().ident


def is_watched() -> bool:
    """Whether somebody can see a bar: on a terminal or in a notebook.

    Nobody can in a worker process, or where standard error is a file or missing.
    """
    import multiprocessing.process

    if multiprocessing.process.parent_process() is not None:
        return False
    if in_notebook():
        return True
    if sys.stderr is None:
        return False
    return sys.stderr.isatty()


def in_notebook() -> bool:
    """Whether this process runs the cells of a notebook."""
    return any(name in sys.modules for name in NOTEBOOK_KERNELS)


def bar_class() -> Any:
    """The class of bars of tqdm for a terminal or for a notebook, whichever this is."""
    with warnings.catch_warnings():
        # Without ipywidgets a notebook has the bar of a terminal, and tqdm warns.
        warnings.simplefilter("ignore")
        from tqdm.autonotebook import tqdm

    class Bar(tqdm):  # type: ignore[misc]
        monitor_interval = 0  # no thread that would outlive the bar

    return Bar
