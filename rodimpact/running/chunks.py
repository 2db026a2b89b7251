"""Chunks of a sweep: some members of a family, which are run in one job.

A chunk is a smaller family. Whoever runs it, and in which order, its columns are the same bit for
bit.
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
    Pool,
    cut,
    job_size,
    results_of,
)
from .readings import Readings


class Chunk(NamedTuple):
    """Some members of a family, and what is wanted of them.

    Attributes
    ----------
    system : System
        The members.
    options : Options
        With the method that is chosen.
    readings : Readings
    together : bool
        Whether the method runs members of this family in one call. Energies of vibration then
        differ in their last digits, so all chunks of a family are run in the same way.
    """

    system: System
    options: Options
    readings: Readings
    together: bool


def run_jobs(
    system: System, options: Options, readings: Readings, keep: Checkpoint, pool: Pool
) -> Generator[list[tuple[int, int, Columns]]]:
    """Run the members that are not done; see `jobs.results_of`."""
    size = math.prod(system.shape)
    row = math.prod(system.shape[1:])
    together = METHODS[options.method].members_per_call(build_row(system))
    most = size
    if together and not needs_solutions(options, readings):
        most = together
    missing = keep.missing()
    to_do = sum(stop - start for start, stop in missing)

    def submit(start: int, stop: int) -> Future[Columns]:
        members = members_of(system, start, stop)
        chunk = Chunk(members, options, readings, together > 0)
        if pool.stop is None:
            return pool.executor.submit(run_chunk, chunk)
        more = size - stop  # members that follow in this process
        return pool.executor.submit(run_chunk, chunk, pool.stop, more)

    jobs_a_worker = JOBS_A_WORKER
    if pool.workers == 1 and together:
        jobs_a_worker = 1  # no other worker has to end at the same time
    if keep.path is not None:
        jobs_a_worker = JOBS_A_WORKER_TO_KEEP
    jobs = cut(missing, job_size(to_do, row, jobs_a_worker * pool.workers, most))
    return results_of(jobs, submit, pool.workers)


def members_of(system: System, start: int, stop: int) -> System:
    """Members of a family from `start` to `stop` in C order."""
    if stop - start == math.prod(system.shape):
        return system
    row = math.prod(system.shape[1:])
    if start % row == stop % row == 0:
        return system[start // row : stop // row]
    return system[np.unravel_index(np.arange(start, stop), system.shape)]


def needs_solutions(options: Options, readings: Readings) -> bool:
    """Whether what is to be read needs the solution of each member."""
    by_method = METHODS[options.method].also
    return bool(readings.gauges) or not set(readings.also) <= {*by_method}


def run_chunk(
    chunk: Chunk, should_stop: Callable[[], bool] = lambda: False, later: int = 0
) -> Columns:
    """Columns of the members of a chunk, in C order.

    Parameters
    ----------
    chunk : Chunk
    should_stop : function
        Asked now and then whether to give up.
    later : int
        Members that are certain to follow in this process.
    """
    columns: Columns = {}
    try:
        if not chunk.together or needs_solutions(chunk.options, chunk.readings):
            columns = _one_by_one(chunk, should_stop)
        if chunk.together:
            columns |= _in_one_call(chunk, should_stop, later)
    finally:
        memory.give_back()
    wanted = {}
    for name, layout in layout_of(chunk.system, chunk.readings).items():
        wanted[name] = columns[name].astype(layout.dtype, copy=False)
    return wanted


def _one_by_one(chunk: Chunk, should_stop: Callable[[], bool]) -> Columns:
    """Columns of members that are solved each alone; a member that is refused has no numbers."""
    system = chunk.system
    readings = chunk.readings
    options = chunk.options
    count = math.prod(system.shape)
    columns: Columns = {}
    for name, layout in layout_of(system, readings).items():
        nothing = math.nan if layout.dtype is np.float64 else 0
        columns[name] = np.full((count, *layout.member_shape), nothing)
    columns["status"][...] = STATUS.index("refused")
    reads_fields = readings.gauges or "largest_stress" in readings.also
    if "snapshots" in METHODS[options.method].takes and not reads_fields:
        # of the states that the method keeps, an outcome needs the first and the last
        options = replace(options, snapshots=2)

    def ask(*_: Any) -> None:
        if should_stop():
            raise Stopped

    for i, index in enumerate(np.ndindex(system.shape)):
        ask()
        with contextlib.suppress(InvalidModel), np.errstate(under="ignore"):
            run = options.run_checked(options.method, system[index], ask)
            solution = Solution(run, options)
            for name, entry in row_of(solution, readings).items():
                columns[name][i] = entry
    return columns


def _in_one_call(chunk: Chunk, should_stop: Callable[[], bool], later: int) -> Columns:
    """Columns of members that the method runs in one call."""
    options = chunk.options
    method = METHODS[options.method]
    assert method.family is not None
    own = {name: getattr(options, name) for name in method.takes}
    own["also"] = [name for name in chunk.readings.also if name in method.also]
    return method.family(
        build_row(chunk.system),
        options.until,
        options.max_events,
        **own,
        should_stop=should_stop,
        later_members=later,
    )
