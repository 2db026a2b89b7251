"""The members of a family as jobs of an executor.

A job is some members in a row. There are about eight jobs for each worker: enough that
all workers end together where some members take longer than others, and few enough that
handing them over takes no time. Jobs end in any order.
"""

import contextlib
import os
import pickle
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
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

JOBS_A_WORKER = 8  # about
JOBS_A_WORKER_TO_KEEP = 100  # with a checkpoint: a crash undoes a hundredth of the work
WORKERS_OF_EXECUTOR = 64  # where the caller does not say how many it has
HEARTBEAT = 0.4  # s, after which progress is reported though no job has ended

Span = tuple[int, int]
"""The first of some members in a row, and the one after the last."""


class Pool(NamedTuple):
    """An executor, the number of its workers, and whether its jobs shall stop.

    Only the jobs of threads of our own can ask.
    """

    executor: Executor
    workers: int
    stop: Callable[[], bool] | None = None


def check_executor(problems: Problems, executor: object, system: System) -> None:
    """Note what is no executor, and laws that its processes cannot be handed."""
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
                "is a function that other processes cannot import: define it with def at "
                "the top of a module, or leave executor out, which takes threads"
            )
            problems.append((f"contacts.{k}", message))


def _is_importable(function: Callable[..., Any]) -> bool:
    """Whether another process finds a function by its name."""
    try:
        pickle.dumps(function)
    except (pickle.PicklingError, AttributeError, TypeError):
        return False
    return True


@contextlib.contextmanager
def pool_of(executor: Executor | None, workers: int | None) -> Iterator[Pool]:
    """The given executor, or threads of our own."""
    if executor is not None:
        yield Pool(executor, workers or WORKERS_OF_EXECUTOR)
        return
    if workers is None:
        workers = processors()
    stopping = threading.Event()
    threads = ThreadPoolExecutor(
        workers, initializer=memory.limit_to_share, initargs=(workers,)
    )
    executor = threads
    try:
        threads.submit(int)
    except RuntimeError:  # no thread can start, as in a browser
        executor = SerialExecutor()
    try:
        yield Pool(executor, workers, stopping.is_set)
    finally:  # who interrupts does not wait for a member, or for a compiler, to end
        stopping.set()
        threads.shutdown(wait=False, cancel_futures=True)


def processors() -> int:
    """Number of processors that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    if affinity is not None:
        return len(affinity(0))
    return os.cpu_count() or 1


class SerialExecutor(Executor):
    """Does every job at once, itself."""

    def submit(
        self, job: Callable[..., Any], /, *arguments: Any, **named: Any
    ) -> Future[Any]:
        """Do a job; what goes wrong is raised here."""
        future: Future[Any] = Future()
        future.set_result(job(*arguments, **named))
        return future


def job_size(members: int, row: int, jobs: int, most: int) -> int:
    """Members of a job.

    Parameters
    ----------
    members : int
        All that are to be run.
    row : int
        Members of a row of the family, which vary along all axes but the first. Jobs of
        whole rows keep numbers small that vary along other axes alone.
    jobs : int
        How many there shall be, about.
    most : int
        Members of a job at most.
    """
    size = -(-members // jobs)
    size = max(1, min(size, most))
    if size >= row:
        size -= size % row
    return size


def cut(spans: Sequence[Span], size: int) -> Iterator[Span]:
    """Cut spans at multiples of a size."""
    for start, stop in spans:
        while start < stop:
            end = min(start - start % size + size, stop)
            yield start, end
            start = end


def results_of(
    jobs: Iterator[Span],
    submit: Callable[[int, int], Future[Any]],
    workers: int,
) -> Generator[list[tuple[int, int, Any]]]:
    """Run jobs, of which each worker has one to do and one to go on with.

    Parameters
    ----------
    jobs : iterator of (int, int)
    submit : function
        Hands over the members from `start` to `stop`.
    workers : int

    Yields
    ------
    list of (int, int, object)
        Jobs that have ended, with their results; twice a second or more often, so that it
        may be empty.
    """
    waiting = deque(jobs)
    running: dict[Future[Any], Span] = {}
    try:
        while waiting or running:
            while waiting and len(running) < 2 * workers:
                start, stop = waiting.popleft()
                running[submit(start, stop)] = start, stop
            results = []
            for job in wait(running, HEARTBEAT, FIRST_COMPLETED).done:
                start, stop = running.pop(job)
                results.append((start, stop, job.result()))
            yield results
    finally:
        for job in running:
            job.cancel()
