"""The members of a family as jobs of an executor.

A job is some members in a row. There are about eight jobs for each worker: enough that
all workers end together where some members take longer than others, and few enough that
handing them over takes no time. Jobs end in any order.
"""

import contextlib
import math
import os
import pickle
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from typing import Any, NamedTuple

from ..methods import memory
from ..model import Law, System
from ..model.frozen import Problems, add_problem
from ..storage.checkpoint import Span

JOBS_A_WORKER = 8  # number of jobs over that of workers, about
JOBS_A_WORKER_TO_KEEP = 100  # the same with a checkpoint: a crash undoes a hundredth
WORKERS_OF_EXECUTOR = 64  # workers of an executor if the caller does not say how many
HEARTBEAT = 0.4  # s, after which progress is reported though no job has ended


class JobResult(NamedTuple):
    """A job that has ended."""

    start: int  # its first member
    stop: int  # the member after its last
    result: Any


class Pool(NamedTuple):
    """An executor."""

    executor: Executor
    workers: int
    stop: Callable[[], bool] | None = None
    """Says whether jobs shall stop; only the jobs of threads of our own can ask."""


def check_executor(problems: Problems, executor: object, system: System) -> None:
    """Add problems of an executor that is none, or of laws that it cannot take.

    None is no mistake: threads are taken then. Only a ProcessPoolExecutor is asked for
    laws; it cannot take the function of a `Law` that its processes cannot import.
    """
    if executor is None:
        return
    if not isinstance(executor, Executor):
        wanted = "must be an executor, such as concurrent.futures.ProcessPoolExecutor()"
        add_problem(problems, "executor", wanted, executor)
    if not isinstance(executor, ProcessPoolExecutor):
        return
    for k, law in enumerate(system.contacts):
        if isinstance(law, Law) and not _is_importable(law.force):
            message = (
                "is a function that other processes cannot import: define it with def "
                "at the top of a module, or leave executor out, which takes threads"
            )
            problems.append((f"contacts.{k}", message))


def _is_importable(function: Callable[..., Any]) -> bool:
    """Whether another process finds a function by its name, as `pickle` tells."""
    try:
        pickle.dumps(function)
    except (pickle.PicklingError, AttributeError, TypeError):
        return False
    return True


@contextlib.contextmanager
def pool_of(executor: Executor | None, workers: int | None) -> Iterator[Pool]:
    """The given executor, or threads of our own, as a context.

    When the context ends, own threads are told to stop and jobs that wait are
    cancelled; nothing waits for jobs that run. A given executor is left as it is. Where
    no thread can start, jobs are done by the thread that submits them. The number of
    workers is by default that of the processors, and `WORKERS_OF_EXECUTOR` for a given
    executor.
    """
    if executor is not None:
        if workers is None:
            workers = WORKERS_OF_EXECUTOR
        yield Pool(executor, workers)
        return
    if workers is None:
        workers = processors()
    stopping = threading.Event()
    # Each thread takes no more than its share of the memory.
    threads = ThreadPoolExecutor(
        workers, initializer=memory.limit_to_share, initargs=(workers,)
    )
    executor = threads
    try:
        threads.submit(int)  # the first job, whatever it is, starts a thread
    except RuntimeError:  # no thread can start, as in a browser
        executor = SerialExecutor()
    try:
        yield Pool(executor, workers, stopping.is_set)
    finally:
        stopping.set()
        # An interrupt does not wait until a member or a compiler ends.
        threads.shutdown(wait=False, cancel_futures=True)


def processors() -> int:
    """Number of processors that this process may use; 1 if it is not known."""
    affinity = getattr(os, "sched_getaffinity", None)
    if affinity is not None:
        return len(affinity(0))
    count = os.cpu_count()
    if count is None:
        return 1
    return count


class SerialExecutor(Executor):
    """Does every job at once, in the thread that submits it."""

    def submit(
        self, job: Callable[..., Any], /, *arguments: Any, **named: Any
    ) -> Future[Any]:
        """Do a job at once, and return a future with its result.

        Errors of the job are raised here.
        """
        future: Future[Any] = Future()
        future.set_result(job(*arguments, **named))
        return future


def job_size(members: int, row: int, jobs: int, most: int) -> int:
    """Number of members of a job, from 1 to `most`.

    A job of a row or more is rounded down to whole rows, so that there may be more jobs
    than wanted.

    Parameters
    ----------
    members : int
        Members to run in all jobs.
    row : int
        Members with one index of the first axis. Numbers that vary along other axes
        alone are the same in every row, so a job of whole rows has them once.
    jobs : int
        Number of jobs that is wanted.
    most : int
        Largest number of members of a job, 1 or more.
    """
    size = math.ceil(members / jobs)
    size = max(1, min(size, most))
    if size >= row:
        size -= size % row
    return size


def cut(spans: Iterable[Span], size: int) -> Iterator[Span]:
    """Cut spans of members at each multiple of a size, and yield the parts in order.

    So no part has more members than that, and none crosses a multiple.
    """
    for start, stop in spans:
        while start < stop:
            next_multiple = start - start % size + size
            end = min(next_multiple, stop)
            yield Span(start, end)
            start = end


def results_of(
    jobs: Iterator[Span],
    submit: Callable[[int, int], Future[Any]],
    workers: int,
) -> Generator[list[JobResult]]:
    """Run jobs on an executor, two for each worker at a time: one running, one queued.

    An error of a job is raised here. When that happens, or the generator is closed,
    jobs that have not begun are cancelled.

    Parameters
    ----------
    jobs : iterator of Span
    submit : function
        Hands the members `start` to `stop - 1` over, and returns the future.
    workers : int

    Yields
    ------
    list of JobResult
        Jobs that have ended, with their results; twice a second or more often, so that
        it may be empty.
    """
    waiting = deque(jobs)
    submitted: dict[Future[Any], Span] = {}  # by job, its members
    try:
        while waiting or submitted:
            while waiting and len(submitted) < 2 * workers:
                span = waiting.popleft()
                job = submit(span.start, span.stop)
                submitted[job] = span
            results = []
            # Until a job ends, or for this time if none does
            ended = wait(submitted, HEARTBEAT, FIRST_COMPLETED).done
            for job in ended:
                span = submitted.pop(job)
                results.append(JobResult(span.start, span.stop, job.result()))
            yield results
    finally:
        for job in submitted:
            job.cancel()  # has no effect on one that runs
