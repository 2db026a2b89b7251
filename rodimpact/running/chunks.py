"""Chunks of a sweep: some members of a family, which are run in one job.

A chunk is itself a smaller family. Its columns are the same bit for bit, whichever
worker runs it, and in whichever order the chunks are run.
"""

import contextlib
import math
from collections.abc import Callable, Generator
from concurrent.futures import Future
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ..methods import memory
from ..methods.family import Columns
from ..methods.registry import METHODS, Options
from ..methods.row_builder import build_row
from ..methods.run import Stopped
from ..model import System
from ..model.frozen import InvalidModel
from ..results.solution import Solution
from ..storage.checkpoint import Checkpoint
from .columns import STATUS, layout_of, row_of
from .jobs import (
    JOBS_A_WORKER,
    JOBS_A_WORKER_TO_KEEP,
    JobResult,
    Pool,
    cut,
    job_size,
    results_of,
)
from .readings import RequestedReadings


class Chunk(NamedTuple):
    """Some members of a family, with the options and readings of their sweep.

    Attributes
    ----------
    system : System
        A smaller family, of these members.
    options : Options
        Options of the sweep; their method is the chosen one, never "auto".
    readings : RequestedReadings
    in_one_call : bool
        Whether the method runs all members of the chunk in one call. Vibration energies
        then differ in their last digits from those of single runs, so this is the same
        for all chunks of a family.
    """

    system: System
    options: Options
    readings: RequestedReadings
    in_one_call: bool


def run_jobs(
    system: System,
    options: Options,
    readings: RequestedReadings,
    store: Checkpoint,
    pool: Pool,
) -> Generator[list[JobResult]]:
    """Run the members that the store does not have, as jobs of the pool.

    The generator is that of `jobs.results_of`: it yields lists of jobs that have ended,
    with their columns. The caller puts them into the store. Each worker gets about
    eight jobs, or about a hundred if the store is on disk. If the store is in memory, a
    single worker whose method runs many members in one call gets as few jobs as
    possible.
    """
    size = math.prod(system.shape)
    row_size = math.prod(system.shape[1:])  # members with one index of the first axis
    members_per_call = METHODS[options.method].members_per_call(build_row(system))
    in_one_call = members_per_call > 0  # 0: the method runs each member alone
    largest_job = size
    # Members that are also solved one by one need no such bound: solving them takes
    # longer than the call.
    if in_one_call and not needs_solutions(options, readings):
        largest_job = members_per_call
    missing = store.missing()  # spans (start, stop) of members without results
    missing_count = 0
    for start, stop in missing:
        missing_count += stop - start

    def submit(start: int, stop: int) -> Future[Columns]:
        """Submit the members `start` to `stop - 1` to the executor as one job."""
        members = members_of(system, start, stop)
        chunk = Chunk(members, options, readings, in_one_call)
        if pool.stop is None:  # a given executor: its jobs cannot ask whether to stop
            return pool.executor.submit(run_chunk, chunk)
        # Jobs begin in order, so all missing members after this job are still to be run
        # in this process.
        later_members = int(np.count_nonzero(~store.done[stop:]))
        return pool.executor.submit(run_chunk, chunk, pool.stop, later_members)

    jobs_a_worker = JOBS_A_WORKER
    if pool.workers == 1 and in_one_call:
        jobs_a_worker = 1  # there is no second worker to share the work with
    if store.path is not None:
        jobs_a_worker = JOBS_A_WORKER_TO_KEEP
    job_count = jobs_a_worker * pool.workers
    job_members = job_size(
        members=missing_count, row=row_size, jobs=job_count, most=largest_job
    )
    jobs = cut(missing, job_members)
    return results_of(jobs, submit, pool.workers)


def members_of(system: System, start: int, stop: int) -> System:
    """Members `start` to `stop - 1` of a family in C order, as a smaller family.

    All members together are the family itself. A row consists of the members with one
    index of the first axis. Whole rows keep the other axes: the result has the shape
    (rows, ...). Any other span of members has the shape (stop - start,).
    """
    if stop - start == math.prod(system.shape):
        return system
    row_size = math.prod(system.shape[1:])  # members with one index of the first axis
    are_whole_rows = start % row_size == 0 and stop % row_size == 0
    if are_whole_rows:
        # A slice leaves the numbers that vary only along other axes as they are; the
        # index arrays below would repeat them for each row.
        return system[start // row_size : stop // row_size]
    members = np.arange(start, stop)
    return system[np.unravel_index(members, system.shape)]


def needs_solutions(options: Options, readings: RequestedReadings) -> bool:
    """Whether the readings require that each member is solved alone.

    Gauges require it, and so do names of `also` that the method does not compute when
    it runs many members in one call.
    """
    if readings.gauges:
        return True
    found_by_method = METHODS[options.method].also
    return not set(readings.also).issubset(found_by_method)


def run_chunk(
    chunk: Chunk,
    should_stop: Callable[[], bool] = lambda: False,
    later_members: int = 0,
) -> Columns:
    """Run a chunk and return its columns by name, one entry per member in C order.

    The columns and their types are those of `layout_of`. Members are run in one call if
    `chunk.in_one_call`, else one by one; if the readings need solutions, they are run
    in both ways. Stopped is raised if `should_stop` returns true.

    Parameters
    ----------
    chunk : Chunk
    should_stop : function
        Called now and then; it returns true if the run shall be abandoned.
    later_members : int
        Number of members that are certain to follow in this process: with many of them
        the method compiles its kernels.
    """
    columns: Columns = {}
    try:
        if not chunk.in_one_call or needs_solutions(chunk.options, chunk.readings):
            columns = _one_by_one(chunk, should_stop)
        if chunk.in_one_call:
            # Columns of the call replace the columns of the same name from single
            # members, so that a sweep with gauges has the same digits as one without.
            columns |= _in_one_call(chunk, should_stop, later_members)
    finally:
        memory.end_turn()  # others may now take more than their share of memory
    with_dtypes = {}
    for name, layout in layout_of(chunk.system, chunk.readings).items():
        with_dtypes[name] = columns[name].astype(layout.dtype, copy=False)
    return with_dtypes


def _one_by_one(chunk: Chunk, should_stop: Callable[[], bool]) -> Columns:
    """Solve each member alone and return the columns by name, [member, ...].

    The columns are all those of `layout_of`, including the names of `also` and the
    strains. The entries of a member that the method refuses are nan or 0, see
    `_empty_columns`. Stopped is raised if `should_stop` returns true.
    """
    system = chunk.system
    readings = chunk.readings
    # States that no reading needs are not stored.
    options = _without_unread_states(chunk.options, readings)
    columns = _empty_columns(system, readings)

    def raise_if_stopped(*_: Any) -> None:
        """Raise Stopped if `should_stop` returns true.

        This is also the progress function of a run, whose arguments are ignored.
        """
        if should_stop():
            raise Stopped

    for i, index in enumerate(np.ndindex(system.shape)):
        raise_if_stopped()
        # If the method raises InvalidModel, the entries stay as `_empty_columns` made
        # them: "refused". A number too small for a float becomes 0, even if the user
        # has set NumPy to raise an error at underflow.
        with contextlib.suppress(InvalidModel), np.errstate(under="ignore"):
            run = options._run_checked(options.method, system[index], raise_if_stopped)
            solution = Solution(run, options)
            for name, entry in row_of(solution, readings).items():
                columns[name][i] = entry
    return columns


def _empty_columns(system: System, readings: RequestedReadings) -> Columns:
    """Columns of `layout_of`, [member, ...], with the status "refused" for all members.

    Columns of floats are filled with nan. Columns of integers and of truth values are
    filled with the integer 0; `run_chunk` gives them the dtype of their layout later.
    """
    count = math.prod(system.shape)
    columns: Columns = {}
    for name, layout in layout_of(system, readings).items():
        fill: float = 0
        if layout.dtype is np.float64:
            fill = math.nan
        columns[name] = np.full((count, *layout.member_shape), fill)
    columns["status"][...] = STATUS.index("refused")
    return columns


def _without_unread_states(options: Options, readings: RequestedReadings) -> Options:
    """Options by which a grid stores only its first and last state.

    These two states are enough for an outcome. The options are returned unchanged if
    gauges or largest stresses are read, since they need all states, and for methods
    that store no states.
    """
    reads_fields = len(readings.gauges) > 0 or "largest_stress" in readings.also
    if reads_fields or "snapshots" not in METHODS[options.method].takes:
        return options
    return replace(options, snapshots=2)  # the first and the last state


def _in_one_call(
    chunk: Chunk, should_stop: Callable[[], bool], later_members: int
) -> Columns:
    """Run all members in one call of the method and return the columns, [member].

    The columns that `chunk.readings.also` names are included, except those that the
    method does not compute in such a call. `should_stop` and `later_members` are those
    of `run_chunk`.
    """
    options = chunk.options
    method = METHODS[options.method]
    run_family = method.family
    assert run_family is not None  # `chunk.in_one_call` has checked this
    method_options: dict[str, Any] = {}
    for name in method.takes:
        method_options[name] = getattr(options, name)
    also = [name for name in chunk.readings.also if name in method.also]
    return run_family(
        build_row(chunk.system),
        options.until,
        options.max_events,
        **method_options,
        also=also,
        should_stop=should_stop,
        later_members=later_members,
    )
