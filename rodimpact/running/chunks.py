"""Chunks of a sweep: some members of a family, which are run in one job.

A chunk is a smaller family. Whoever runs it, and in which order, its columns are the
same bit for bit.
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
    """Some members of a family, and what is wanted of them.

    Attributes
    ----------
    system : System
        A smaller family, of these members.
    options : Options
        With the method that is chosen.
    readings : RequestedReadings
    in_one_call : bool
        Whether the method runs members of this family in one call. Energies of
        vibration then differ in their last digits, so all chunks of a family are run in
        the same way.
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
    """Run the members that the store does not have, in jobs.

    Lists of jobs that have ended are yielded, with their columns, as by
    `jobs.results_of`; the caller puts them into the store. There are about eight jobs a
    worker, or a hundred if the store is on disk. If it is not, a single worker whose
    method runs many members in one call gets as few jobs as possible.
    """
    size = math.prod(system.shape)
    row_size = math.prod(system.shape[1:])  # members with one index of the first axis
    members_per_call = METHODS[options.method].members_per_call(build_row(system))
    in_one_call = members_per_call > 0  # 0: the method runs each member alone
    largest_job = size
    # No bound where members are solved one by one, too: that takes the longer time.
    if in_one_call and not needs_solutions(options, readings):
        largest_job = members_per_call
    missing = store.missing()  # spans of members, from `start` to `stop` - 1
    missing_count = 0
    for start, stop in missing:
        missing_count += stop - start

    def submit(start: int, stop: int) -> Future[Columns]:
        """Hand the members `start` to `stop - 1` over to the executor."""
        members = members_of(system, start, stop)
        chunk = Chunk(members, options, readings, in_one_call)
        if pool.stop is None:  # other processes cannot ask whether to stop
            return pool.executor.submit(run_chunk, chunk)
        # Jobs begin in order: members that the store lacks behind those of this job
        # will be run in this process.
        later_members = int(np.count_nonzero(~store.done[stop:]))
        return pool.executor.submit(run_chunk, chunk, pool.stop, later_members)

    jobs_a_worker = JOBS_A_WORKER
    if pool.workers == 1 and in_one_call:
        jobs_a_worker = 1  # there is no other worker that would wait for this one
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

    For all members this is the family itself. Whole rows, which have one index of the
    first axis each, keep the other axes: the shape is (rows, ...). Other members stand
    along a single axis: the shape is (stop - start,).
    """
    if stop - start == math.prod(system.shape):
        return system
    row_size = math.prod(system.shape[1:])  # members with one index of the first axis
    are_whole_rows = start % row_size == 0 and stop % row_size == 0
    if are_whole_rows:
        # A slice keeps numbers that vary along other axes alone as small as they are;
        # an index, as below, repeats them.
        return system[start // row_size : stop // row_size]
    members = np.arange(start, stop)
    return system[np.unravel_index(members, system.shape)]


def needs_solutions(options: Options, readings: RequestedReadings) -> bool:
    """Whether each member must be solved alone, for what is to be read of it.

    Gauges need it, and so do names of `also` that the method does not find when it runs
    many members in one call.
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
    """Columns of the members of a chunk, by name, with an entry a member in C order.

    They are those of `layout_of`, with its types. Members are run in one call, one by
    one, or both if the readings need solutions. Stopped is raised if the sweep shall
    give up.

    Parameters
    ----------
    chunk : Chunk
    should_stop : function
        Asked now and then whether to give up.
    later_members : int
        Number of members that are certain to follow in this process: with many of them
        the method compiles its kernels.
    """
    columns: Columns = {}
    try:
        if not chunk.in_one_call or needs_solutions(chunk.options, chunk.readings):
            columns = _one_by_one(chunk, should_stop)
        if chunk.in_one_call:
            # Columns of the call replace those of the same name of single members: a
            # sweep with gauges has the same digits as one without.
            columns |= _in_one_call(chunk, should_stop, later_members)
    finally:
        memory.end_turn()  # others may now take more than their share of memory
    with_dtypes = {}
    for name, layout in layout_of(chunk.system, chunk.readings).items():
        with_dtypes[name] = columns[name].astype(layout.dtype, copy=False)
    return with_dtypes


def _one_by_one(chunk: Chunk, should_stop: Callable[[], bool]) -> Columns:
    """Columns of members that are solved each alone, by name, [member, ...].

    They are those of `layout_of`, with all names of `also` and with strains. A member
    that the method refuses is nan or 0 there, see `_empty_columns`. Stopped is raised
    if the sweep shall give up.
    """
    system = chunk.system
    readings = chunk.readings
    # Snapshots that no reading needs are not kept.
    options = _without_unread_states(chunk.options, readings)
    columns = _empty_columns(system, readings)

    def raise_if_stopped(*_: Any) -> None:
        """Raise Stopped if the sweep shall give up.

        It serves as the progress function of a run.
        """
        if should_stop():
            raise Stopped

    for i, index in enumerate(np.ndindex(system.shape)):
        raise_if_stopped()
        # After InvalidModel the member stays refused, as its columns begin. A number
        # too small for a float becomes 0, even if NumPy was told to raise for that.
        with contextlib.suppress(InvalidModel), np.errstate(under="ignore"):
            run = options._run_checked(options.method, system[index], raise_if_stopped)
            solution = Solution(run, options)
            for name, entry in row_of(solution, readings).items():
                columns[name][i] = entry
    return columns


def _empty_columns(system: System, readings: RequestedReadings) -> Columns:
    """Columns of `layout_of` in which all members are refused: ``status`` says so.

    Columns of floats are nan, [member, ...]. Those of whole numbers and of truth values
    are 0, as whole numbers; `run_chunk` gives every column the dtype of its layout.
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
    """Options of a grid that keep its first and last state, unless others are read.

    Those two are enough for an outcome; gauges and largest stresses read all states.
    Other methods keep no states, and their options are returned as they are.
    """
    reads_fields = len(readings.gauges) > 0 or "largest_stress" in readings.also
    if reads_fields or "snapshots" not in METHODS[options.method].takes:
        return options
    return replace(options, snapshots=2)


def _in_one_call(
    chunk: Chunk, should_stop: Callable[[], bool], later_members: int
) -> Columns:
    """Columns of members that the method runs in one call, by name, [member].

    The columns of `chunk.readings.also` are included, except those that the method does
    not offer. `should_stop` and `later_members` are those of `run_chunk`.
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
