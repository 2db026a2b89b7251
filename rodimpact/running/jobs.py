"""The members of a family as jobs of an executor.

A job is a span of consecutive members. There are about eight jobs for each worker:
enough for all workers to finish at about the same time although some members take
longer than others, and few enough that submitting them costs little. Jobs may end in
any order.
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

JOBS_A_WORKER = 8  # approximate number of jobs over the number of workers
JOBS_A_WORKER_TO_KEEP = 100  # the same with a checkpoint: a crash undoes a hundredth
WORKERS_OF_EXECUTOR = 64  # workers of an executor if the caller does not say how many
HEARTBEAT = 0.4  # s; progress is reported after this time even if no job has ended


class JobResult(NamedTuple):
    """A job that has ended."""

    start: int  # its first member
    stop: int  # index after its last member
    result: Any  # what the function of the job returned


class Pool(NamedTuple):
    """An executor with its number of workers."""

    executor: Executor
    workers: int
    stop: Callable[[], bool] | None = None
    """Tells whether jobs shall stop; None for an executor that the user gave.

    Its jobs may run in other processes, which cannot call this function.
    """


def check_executor(problems: Problems, executor: object, system: System) -> None:
    """Add problems if `executor` is no executor, or cannot run the laws of the system.

    None is allowed and means threads. Laws are checked for a ProcessPoolExecutor only:
    its processes must be able to import the function of each `Law`.
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
    """Whether another process can import a function by its name, as `pickle` does."""
    try:
        pickle.dumps(function)
    except (pickle.PicklingError, AttributeError, TypeError):
        return False
    return True


@contextlib.contextmanager
def pool_of(executor: Executor | None, workers: int | None) -> Iterator[Pool]:
    """Context with the given executor, or with new threads if it is None, as a `Pool`.

    At the end of the context, `Pool.stop` tells the threads to stop, and waiting jobs
    are cancelled; the context does not wait for running jobs. A given executor is not
    shut down. Where no thread can be started, `SerialExecutor` takes their place. The
    default of `workers` is the number of processors, or `WORKERS_OF_EXECUTOR` for a
    given executor.
    """
    if executor is not None:
        if workers is None:
            workers = WORKERS_OF_EXECUTOR
        yield Pool(executor, workers)
        return
    if workers is None:
        workers = processors()
    stopping = threading.Event()
    # Each thread is limited to its share of the memory.
    threads = ThreadPoolExecutor(
        workers, initializer=memory.limit_to_share, initargs=(workers,)
    )
    executor = threads
    try:
        threads.submit(int)  # any first job, here int(), starts a thread
    except RuntimeError:  # no thread can start, as in a browser
        executor = SerialExecutor()
    try:
        yield Pool(executor, workers, stopping.is_set)
    finally:
        stopping.set()
        # No wait: an interrupt must not last until a member or a compilation ends.
        threads.shutdown(wait=False, cancel_futures=True)


def processors() -> int:
    """Number of processors that this process may use; 1 if it is not known."""
    affinity = getattr(os, "sched_getaffinity", None)  # not on every system
    if affinity is not None:
        return len(affinity(0))  # 0 stands for this process
    count = os.cpu_count()
    if count is None:
        return 1
    return count


class SerialExecutor(Executor):
    """Executor that runs every job at once, in the thread that submits it."""

    def submit(
        self, job: Callable[..., Any], /, *arguments: Any, **named: Any
    ) -> Future[Any]:
        """Run a job at once, and return a finished future with its result.

        An error of the job is raised here, not kept in the future.
        """
        future: Future[Any] = Future()
        future.set_result(job(*arguments, **named))
        return future


def job_size(members: int, row: int, jobs: int, most: int) -> int:
    """Number of members of a job, from 1 to `most`: about `members` / `jobs`.

    A size of a row or more is rounded down to whole rows, so that there may be more
    jobs than wanted.

    Parameters
    ----------
    members : int
        Number of members to run in all jobs.
    row : int
        Number of members with one index of the first axis. Numbers that vary only along
        other axes are the same in every row, so a job of whole rows stores them once.
    jobs : int
        Number of jobs that is wanted.
    most : int
        Largest number of members of a job, 1 or more.
    """
    size = math.ceil(members / jobs)
    size = max(1, min(size, most))
    if size >= row:
        size -= size % row  # whole rows only
    return size


def cut(spans: Iterable[Span], size: int) -> Iterator[Span]:
    """Cut spans of members at each multiple of `size`, and yield the parts in order.

    A part has at most `size` members and does not extend across a multiple of `size`.
    """
    for start, stop in spans:
        while start < stop:
            next_multiple = start - start % size + size  # first one after `start`
            end = min(next_multiple, stop)
            yield Span(start, end)
            start = end


def results_of(
    jobs: Iterator[Span],
    submit: Callable[[int, int], Future[Any]],
    workers: int,
) -> Generator[list[JobResult]]:
    """Run jobs on an executor, two for each worker at a time: one running, one queued.

    An error of a job is raised here. After an error, or when the generator is closed,
    the jobs that have not begun are cancelled.

    Parameters
    ----------
    jobs : iterator of Span
    submit : function
        Called with `start` and `stop`; submits the members `start` to `stop - 1` to the
        executor and returns the future.
    workers : int
        Number of workers of the executor.

    Yields
    ------
    list of JobResult
        Jobs that have ended since the previous list. A list is yielded at least every
        `HEARTBEAT` seconds; it is empty if no job has ended.
    """
    waiting = deque(jobs)
    submitted: dict[Future[Any], Span] = {}  # members of each job that has not ended
    try:
        while waiting or submitted:
            while waiting and len(submitted) < 2 * workers:
                span = waiting.popleft()
                job = submit(span.start, span.stop)
                submitted[job] = span
            results = []
            # Wait until a job ends, but no longer than `HEARTBEAT`.
            ended = wait(submitted, HEARTBEAT, FIRST_COMPLETED).done
            for job in ended:
                span = submitted.pop(job)
                results.append(JobResult(span.start, span.stop, job.result()))
            yield results
    finally:
        for job in submitted:
            job.cancel()  # has no effect on a running job
