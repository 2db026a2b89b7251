"""The members of a family as jobs of an executor: how many in one, and which come next.

A job is some members in a row. Its time is measured, and the next ones are cut to take about as
long as is wanted, and to be a small share of what is left. Jobs end in any order.
"""

import contextlib
import math
import os
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from typing import Any, NamedTuple

from ..methods import memory

SECONDS = 1.0  # that a job shall take
HEARTBEAT = 0.4  # s; nobody waits longer for news
GROWTH = 4  # of a job over the one before
UNKNOWN = 256  # workers of an executor that does not say how many it has

Span = tuple[int, int]


class Pool(NamedTuple):
    """An executor, its workers, and, of threads of our own, what jobs ask whether to stop."""

    executor: Any
    workers: int
    asking: tuple[Callable[[], bool], ...] = ()


@contextlib.contextmanager
def pool_of(executor: Executor | None, workers: int | None) -> Iterator[Pool]:
    """The executor given, or threads of our own."""
    if executor is not None:
        yield Pool(executor, workers_of(executor))
        return
    stopping, threads = threading.Event(), workers or _processors()
    own = ThreadPoolExecutor(threads, initializer=memory.share, initargs=(threads,))
    doing: Executor = own
    try:
        own.submit(int)
    except RuntimeError:  # no thread can start, as in a browser
        doing = Here()
    try:
        yield Pool(doing, threads, (stopping.is_set,))
    finally:  # who interrupts does not wait for a member, or for a compiler, to end
        stopping.set()
        own.shutdown(wait=False, cancel_futures=True)


class Here(Executor):
    """Does every job at once, itself."""

    def submit(self, job: Callable[..., Any], /, *given: Any, **named: Any) -> Future[Any]:
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


def _processors() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Jobs:
    """Members of a family that are to be run.

    Parameters
    ----------
    pool : Pool
    submit : function
        Hands the members of a span to the pool; the future's result has how many of them were run,
        the seconds that took, and what came out.
    spans : list of (int, int)
        First member and the one after the last, of what is to be run.
    unit, most : int
        Jobs begin at multiples of `unit` and have at most `most` members.

    Attributes
    ----------
    end : float
        Members from here on are wanted no longer.
    """

    def __init__(
        self, pool: Pool, submit: Callable[[int, int], Future[Any]], spans: list[Span], unit: int,
        most: int,
    ) -> None:
        self._pool, self._submit, self._unit, self._most = pool, submit, unit, most
        self._waiting, self._running = deque(spans), dict[Future[Any], Span]()
        self._left, self._size = sum(stop - start for start, stop in spans), unit
        self.end = math.inf

    def results(self) -> Generator[list[tuple[int, int, Any]]]:
        """Yield what has come in, if anything, with its span; twice a second or more often."""
        try:
            while self._hand_out():
                ended, _ = wait(self._running, HEARTBEAT, FIRST_COMPLETED)
                yield [self._take(job) for job in ended]
        finally:
            for job in self._running:
                job.cancel()

    def _hand_out(self) -> bool:
        """Give every worker a job, and one to go on with; False if there is nothing left."""
        while self._waiting and len(self._running) < 2 * self._pool.workers:
            start, stop = self._waiting.popleft()
            if start >= self.end:
                continue
            fair = self._left // (2 * self._pool.workers)  # so that all end together
            units = max(1, min(self._size, fair) // self._unit)
            cut = min(start - start % self._unit + units * self._unit, stop)
            if cut < stop:
                self._waiting.appendleft((cut, stop))
            self._left -= cut - start
            self._running[self._submit(start, cut)] = start, cut
        return bool(self._running)

    def _take(self, job: Future[Any]) -> tuple[int, int, Any]:
        start, stop = self._running.pop(job)
        seconds, result = job.result()
        wanted = (stop - start) * SECONDS / max(seconds, 1e-9)
        self._size = int(min(wanted, GROWTH * (stop - start), self._most))
        return start, stop, result
