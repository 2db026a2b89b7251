"""The members of a family as jobs of an executor: how many in one, and which come next.

A job is some members in a row. Its time is measured, and the next ones are cut to take about as
long as is wanted, and to be a small share of what is left. Jobs end in any order.
"""

import contextlib
import os
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from typing import Any

from ..methods import memory

SECONDS = 1.0  # that a job shall take
HEARTBEAT = 0.4  # s; nobody waits longer for news
GROWTH = 4  # of a job over the one before
UNKNOWN = 256  # workers of an executor that does not say how many it has

Span = tuple[int, int]


@contextlib.contextmanager
def pool_of(
    executor: Executor | None, workers: int | None
) -> Iterator[tuple[Executor, int, Callable[[], bool] | None]]:
    """The executor given, or threads of our own, and the workers it has.

    Jobs of our own threads ask the function whether to stop.
    """
    if executor is not None:
        yield executor, workers_of(executor), None
        return
    mine = getattr(
        os, "sched_getaffinity", None
    )  # processors that this process may use
    threads = workers or (len(mine(0)) if mine else os.cpu_count() or 1)
    stopping = threading.Event()
    own = ThreadPoolExecutor(threads, initializer=memory.share, initargs=(threads,))
    doing: Executor = own
    try:
        own.submit(int)
    except RuntimeError:  # no thread can start, as in a browser
        doing = Here()
    try:
        yield doing, threads, stopping.is_set
    finally:  # who interrupts does not wait for a member, or for a compiler, to end
        stopping.set()
        own.shutdown(wait=False, cancel_futures=True)


class Here(Executor):
    """Does every job at once, itself."""

    def submit(
        self, job: Callable[..., Any], /, *given: Any, **named: Any
    ) -> Future[Any]:
        """Do it; what goes wrong is raised here."""
        future: Future[Any] = Future()
        future.set_result(job(*given, **named))
        return future


def workers_of(executor: Any) -> int:
    """How many jobs an executor runs at a time, as far as it says."""
    cores = getattr(getattr(executor, "_client", None), "ncores", None)
    if cores is not None:  # dask
        return sum(cores().values()) or UNKNOWN
    said = (getattr(executor, name, None) for name in ("_max_workers", "num_workers"))
    return next((n for n in said if isinstance(n, int) and n > 0), UNKNOWN)


def results_of(
    workers: int,
    submit: Callable[[int, int], Future[Any]],
    spans: list[Span],
    unit: int,
    most: int,
    wanted: Callable[[int], bool],
) -> Generator[list[tuple[int, int, Any]]]:
    """Run members of a family; yield what has come in, if anything, twice a second or more often.

    Parameters
    ----------
    workers : int
        How many jobs run at a time.
    submit : function
        Hands the members of a span over; the future's result has the seconds that it took,
        and what came out.
    spans : list of (int, int)
        First member and the one after the last, of what is to be run.
    unit, most : int
        Jobs begin at multiples of `unit` and have at most `most` members.
    wanted : function
        Whether what begins with this member is still to be run.

    Yields
    ------
    list of (int, int, object)
        Spans, and what came out of each.
    """
    waiting, running = deque(spans), dict[Future[Any], Span]()
    left, size = sum(stop - start for start, stop in spans), unit
    try:
        while True:
            while (
                waiting and len(running) < 2 * workers
            ):  # one to do, and one to go on with
                start, stop = waiting.popleft()
                if not wanted(start):
                    continue
                fair = left // (2 * workers)  # so that all end together
                units = max(1, min(size, fair) // unit)
                cut = min(start - start % unit + units * unit, stop)
                if cut < stop:
                    waiting.appendleft((cut, stop))
                left -= cut - start
                running[submit(start, cut)] = start, cut
            if not running:
                return
            news = []
            for job in wait(running, HEARTBEAT, FIRST_COMPLETED).done:
                start, stop = running.pop(job)
                seconds, result = job.result()
                fitting = (stop - start) * SECONDS / max(seconds, 1e-9)
                size = int(min(fitting, GROWTH * (stop - start), most))
                news.append((start, stop, result))
            yield news
    finally:
        for job in running:
            job.cancel()
