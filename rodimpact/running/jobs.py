"""The members of a family as jobs of an executor: how many in one, and which come next.

A job is some members in a row. What one takes is measured, and the next ones are cut to take about
as long as is wanted; one that takes far longer hands back what it has not begun. Jobs end in any
order.
"""

from __future__ import annotations

import contextlib
import math
import os
import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from typing import Any, NamedTuple

from ..methods import memory

QUICK, LONG = 0.1, 2.0  # s that a job shall take on threads of our own, and on what others give
LONGEST = 5.0  # s after which a job begins no further part
HEARTBEAT = 0.4  # s; nobody waits longer for news
GROWTH = 4  # of a job, or a part of one, over the one before
UNKNOWN = 256  # workers of an executor that does not say how many it has

Span = tuple[int, int]


class Pool(NamedTuple):
    """An executor, its workers, how long a job shall take, s, and what jobs ask whether to stop."""

    executor: Any
    workers: int
    seconds: float
    asking: tuple[Callable[[], bool], ...] = ()


@contextlib.contextmanager
def pool_of(executor: Executor | None, workers: int | None) -> Iterator[Pool]:
    """The executor given, or threads of our own."""
    if executor is not None:
        yield Pool(executor, workers_of(executor), LONG)
        return
    stopping, threads = threading.Event(), workers or _processors()
    own = ThreadPoolExecutor(threads, initializer=memory.share, initargs=(threads,))
    doing: Executor = own
    try:
        own.submit(int)
    except RuntimeError:  # no thread can start, as in a browser
        doing = Here()
    try:
        yield Pool(doing, threads, QUICK, (stopping.is_set,))
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


def run_parts(
    run: Callable[[int, int], Any], count: int, first: int, most: int
) -> tuple[list[Any], int, float]:
    """Run a job in parts that grow while they are quick, for `LONGEST` s.

    Parameters
    ----------
    run : function
        Of the first member of a part and the one after its last.
    count, first, most : int
        Members of the job, of its first part, and of any part.

    Returns
    -------
    list, int, float
        What the parts returned; how many members they had, all or a multiple of `first`; s.
    """
    begun, parts, done, size = time.perf_counter(), [], 0, first
    before = begun
    while done < count and before - begun < LONGEST:
        parts.append(run(done, min(done + size, count)))
        done, now = min(done + size, count), time.perf_counter()
        quick, before = now - before < QUICK, now
        size = min(GROWTH * size, most) if quick else max(size // GROWTH, first)
        size -= size % first
    return parts, done, before - begun


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
        self._news: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()
        self.end = math.inf

    def results(self) -> Generator[list[tuple[int, int, Any]]]:
        """Yield what has come in, if anything, with its span; twice a second or more often."""
        try:
            self._hand_out()
            while self._running:
                yield [self._take(job) for job in self._ended()]
                self._hand_out()
        finally:
            for job in self._running:
                job.cancel()

    def _ended(self) -> Iterator[Future[Any]]:
        """Wait for a job to end, though not for long; it, and all others that have ended."""
        with contextlib.suppress(queue.Empty):
            yield self._news.get(timeout=HEARTBEAT)
            while True:
                yield self._news.get_nowait()

    def _hand_out(self) -> None:
        """Give every worker a job, and one to go on with."""
        while self._waiting and len(self._running) < 2 * self._pool.workers:
            start, stop = self._waiting.popleft()
            if start >= self.end:
                continue
            fair = min(self._size, self._left // self._pool.workers)  # so that all end together
            units = max(1, fair // self._unit)
            cut = min(start - start % self._unit + units * self._unit, stop)
            if cut < stop:
                self._waiting.appendleft((cut, stop))
            self._left -= cut - start
            job = self._submit(start, cut)
            self._running[job] = start, cut
            job.add_done_callback(self._news.put)
            if job.done():  # by who does it at once, in the thread that asks
                break

    def _take(self, job: Future[Any]) -> tuple[int, int, Any]:
        start, stop = self._running.pop(job)
        count, seconds, result = job.result()
        if start + count < stop:
            self._waiting.appendleft((start + count, stop))
            self._left += stop - start - count
        wanted = count * self._pool.seconds / max(seconds, 1e-9)
        self._size = int(min(wanted, GROWTH * count, self._most))
        return start, start + count, result
