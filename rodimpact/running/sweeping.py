"""sweep(): every collision of a family, on any executor.

Its members are run in chunks, which are smaller families; a chunk's result is a table of columns,
one row a collision. Whoever runs a chunk, and in which order, its numbers are the same bit for bit.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Executor, Future
from dataclasses import asdict, replace
from numbers import Integral
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..methods import memory
from ..methods.groups import unilateral
from ..methods.registry import METHODS, Options, count
from ..methods.row import Row
from ..methods.run import ALSO, MAX_EVENTS, FamilyRun, Stopped
from ..model import Rod, System
from ..model.frozen import Field, InvalidModel, Problems, quantity, raise_noted
from ..progress import Progress, ProgressFunction, check_progress
from ..results.outcome import effective_restitution
from ..results.solution import Solution
from ..storage.checkpoint import Checkpoint
from ..storage.writing import PathLike
from ..units import shown
from ..version import __version__
from .columns import STATUS, Columns, Readings, arrays_of, row_of
from .jobs import (
    JOBS_A_WORKER,
    JOBS_A_WORKER_TO_KEEP,
    Pool,
    cut,
    job_size,
    pool_of,
    results_of,
)
from .sweep_result import SweepResult

PLACE = quantity("m", "non-negative", single=True)  # of a gauge


def sweep(
    system: System,
    method: str = "auto",
    executor: Executor | None = None,
    *,
    until: float | None = None,
    max_events: int = MAX_EVENTS,
    dt: float | None = None,
    rtol: float | None = None,
    cells: int | None = None,
    gauges: Sequence[tuple[int, float]] = (),
    times: ArrayLike | None = None,
    also: Sequence[str] = (),
    workers: int | None = None,
    progress: bool | ProgressFunction = True,
    checkpoint: PathLike | None = None,
) -> SweepResult:
    """Solve every collision of a family.

    Parameters
    ----------
    system : System
        Of any shape: numbers of the model that are arrays make a family, as NumPy broadcasts them.
        ``read_case("case.toml", vary={"bodies.0.length": "0.05:1:20"}).system`` is that of a case.
    method : str
        As for `solve`; one for all members.
    executor : concurrent.futures.Executor, optional
        Who runs the chunks: threads of this process if not given, else processes, a cluster by
        ``dask.distributed.Client.get_executor()`` or ``mpi4py.futures.MPIPoolExecutor``. The result
        is the same bit for bit.
    until : float, optional
        Time to which each member runs, s; by default to the proof that its collision is over. Where
        drives or gravity act there is none, and chains that touch again and again may have none for
        a long time.
    max_events, dt, rtol, cells
        Of each member, as for `solve`.
    gauges : sequence of (int, float), optional
        Strain gauges: body, and place in m from its left end.
    times : array_like, optional
        Times at which the strain at the gauges is wanted, s, for all members; [time].
    also : sequence of str, optional
        What else is wanted, which takes longer: ``"dissipated"``, the energy lost in contacts;
        ``"largest_stress"`` in each rod; ``"set"``, how far each yielding contact has yielded for
        good, such as the set of a pile; ``"displacement"``, how far each body has moved at
        `until`; ``"accuracy"``, the stated error of each member. See `SweepResult`.
    workers : int, optional
        Number of threads, by default the processors at hand; beside an executor the number of its
        workers, by default 64.
    progress : bool or function
        Whether a bar may show how far the sweep is: after two seconds of work, on a terminal or in
        a notebook. A function is called with the number of collisions done and of all, twice a
        second or more often; what it raises ends the sweep.
    checkpoint : path, optional
        Directory for finished chunks, strains included. A sweep that was interrupted continues
        from there.

    Returns
    -------
    SweepResult

    Raises
    ------
    InvalidModel
        If an argument is wrong or missing, or the method lacks something that the system has.
    FileFormatError, OSError
        If the checkpoint directory holds something else, or cannot be written.

    Warns
    -----
    DamagedChunks
        If the checkpoint has files that are not what was written; their members are run again.

    Notes
    -----
    A member that cannot be solved, or that the cap on events or the clock stops, keeps its `status`
    and the results that are known; `SweepResult.incomplete` and `SweepResult.explain` tell more.

    Each of several workers gets about eight jobs, with a checkpoint a hundred, at most two at a
    time. An interrupt cancels jobs that wait. Jobs that run end within seconds, or with their present
    member.

    Processes, dask, and MPI, started by ``mpiexec -n 65 python -m mpi4py.futures program.py``::

        with ProcessPoolExecutor() as pool:  # under if __name__ == "__main__":
            result = ri.sweep(family, executor=pool)

        client.run(ri.warm)  # each machine compiles once, before the first job
        result = ri.sweep(family, executor=client.get_executor())

        with MPIPoolExecutor() as pool:
            result = ri.sweep(family, executor=pool)

    Under SLURM, ``sbatch --array=0-99`` starts a hundred programs, each with members of its own; a
    checkpoint each lets them go on where they were::

        task = int(os.environ["SLURM_ARRAY_TASK_ID"])
        ri.sweep(family[task::100], checkpoint=f"part-{task}").save(f"part-{task}.npz")

    Examples
    --------
    Strain at a gauge in the middle of a bar, for three strikers:

    >>> import numpy as np, rodimpact as ri
    >>> steel = ri.materials.steel
    >>> striker = ri.Rod(np.array([0.1, 0.2, 0.4]), area=1e-4, material=steel, velocity=10.0)
    >>> bar = ri.Rod(2.0, area=1e-4, material=steel)
    >>> pulses = ri.sweep(ri.System([striker, bar]), until=5e-4, gauges=[(1, 1.0)],
    ...                   times=np.linspace(0, 5e-4, 6))
    >>> pulses.strain.shape
    (3, 1, 6)
    """
    problems: Problems = []
    if workers is not None:
        workers = count(problems, "workers", workers)
    check_progress(problems, progress)
    runs_chunks = isinstance(executor, Executor | None)
    if not runs_chunks:
        message = (
            "must be an executor, such as concurrent.futures.ProcessPoolExecutor()"
        )
        problems.append(("executor", f"{message}, got {executor!r}"))
    try:
        options = Options(until, method, max_events, dt, rtol, cells)
        options = replace(options, method=options.method_for(system))
        readings = readings_of(problems, system, gauges, times)
        readings = readings._replace(also=_also(problems, also, options.until))
        if not math.prod(system.shape):
            message = f"has no members, its shape is {system.shape}; select one or more"
            problems.append(("system", message))
    except InvalidModel as error:
        problems += error.problems
    raise_noted(problems)
    size = math.prod(system.shape)
    described: dict[str, Any] = {}
    if checkpoint is not None:
        described = {
            "rodimpact": __version__,
            "system": system.digest,
            "shape": system.shape,
            **asdict(options),
            **readings._asdict(),
            "times": readings.times.tolist(),
        }
    keep = Checkpoint(arrays_of(system, readings), size, checkpoint, described)
    with (
        contextlib.closing(keep),
        Progress(progress, "sweep", "collisions") as report,
        pool_of(executor, workers) as pool,
        contextlib.closing(run_jobs(system, options, readings, keep, pool)) as results,
    ):
        for parts in results:
            for start, stop, part in parts:
                keep.put(start, stop, part)
            report(int(np.count_nonzero(keep.done)), size)
    columns = {}
    for name, column in keep.columns.items():
        columns[name] = column.reshape((*system.shape, *column.shape[1:]))
    strain = columns.pop("strain", None)
    return SweepResult(system, options, columns, readings, strain)


def run_jobs(
    system: System, options: Options, readings: Readings, keep: Checkpoint, pool: Pool
) -> Generator[list[tuple[int, int, Columns]]]:
    """Run the members that are not done; see `jobs.results_of`."""
    size = math.prod(system.shape)
    row = math.prod(system.shape[1:])
    together = METHODS[options.method].members_per_call(Row(system))
    most = size
    if together and not needs_solutions(options, readings):
        most = together
    missing = keep.missing()
    to_do = sum(stop - start for start, stop in missing)

    def submit(start: int, stop: int) -> Future[Columns]:
        members = _members(system, start, stop)
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


class Chunk(NamedTuple):
    """Some members of a family, and what is wanted of them."""

    system: System  # the members
    options: Options  # with the method that is chosen
    readings: Readings
    # Whether the method runs members of this family in one call. Energies of vibration
    # then differ in their last digits, so all chunks of a family are run in the same way.
    together: bool


def needs_solutions(options: Options, readings: Readings) -> bool:
    """Whether what is to be read needs the solution of each member."""
    able = METHODS[options.method].also
    return bool(readings.gauges) or not set(readings.also) <= {*able}


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
            columns |= _together(chunk, should_stop, later)
    finally:
        memory.give_back()
    of_members = arrays_of(chunk.system, chunk.readings)
    return {
        name: columns[name].astype(kind, copy=False)
        for name, (kind, _) in of_members.items()
    }


def _one_by_one(chunk: Chunk, should_stop: Callable[[], bool]) -> Columns:
    """Columns of members that are solved each alone."""
    system = chunk.system
    readings = chunk.readings
    options = chunk.options
    count = math.prod(system.shape)
    # a member that is refused has no numbers
    columns: Columns = {}
    for name, (kind, beyond) in arrays_of(system, readings).items():
        nothing = math.nan if kind is np.float64 else 0
        columns[name] = np.full((count, *beyond), nothing)
    columns["status"][...] = STATUS.index("refused")
    reads_fields = readings.gauges or "largest_stress" in readings.also
    if "snapshots" in METHODS[options.method].takes and not reads_fields:
        # an outcome needs the first and the last state
        options = replace(options, snapshots=2)

    def ask(*_: Any) -> None:
        if should_stop():
            raise Stopped

    for i, index in enumerate(np.ndindex(system.shape)):
        ask()
        with contextlib.suppress(InvalidModel), np.errstate(under="ignore"):
            run = options.run(options.method, system[index], ask)
            solution = Solution(run, options)
            for name, value in row_of(solution, readings).items():
                columns[name][i] = value
    return columns


def _together(chunk: Chunk, should_stop: Callable[[], bool], later: int) -> Columns:
    """Columns of members that the method runs in one call."""
    options = chunk.options
    method = METHODS[options.method]
    assert method.family is not None
    own = {name: getattr(options, name) for name in method.takes}
    own["also"] = [name for name in chunk.readings.also if name in method.also]
    run = method.family(
        Row(chunk.system),
        options.until,
        options.max_events,
        **own,
        should_stop=should_stop,
        later_members=later,
    )
    return _columns_of(run, chunk.system)


def _columns_of(run: FamilyRun, system: System) -> Columns:
    """Columns of members that the method has run in one call."""
    restitution = np.full(len(run.final), math.nan)
    opening = unilateral(system)
    if len(opening) == 1:
        k = opening[0]
        restitution = effective_restitution(
            run.final,
            run.contacts["episodes"][k],
            run.before[k : k + 2],
            run.after[k : k + 2],
        )
    columns = {
        "restitution": restitution,
        "vibration": run.vibration,
        "final": run.final,
        "status": run.stopped_by,
    }
    columns |= run.further
    for i, velocity in enumerate(run.after):
        columns[f"velocity_after.{i}"] = velocity
    for name, by_contact in run.contacts.items():
        for k, values in enumerate(by_contact):
            columns[f"{name}.{k}"] = values
    return columns


def _members(system: System, start: int, stop: int) -> System:
    """Members of a family from `start` to `stop` in C order."""
    if stop - start == math.prod(system.shape):
        return system
    row = math.prod(system.shape[1:])
    if start % row == stop % row == 0:
        return system[start // row : stop // row]
    return system[np.unravel_index(np.arange(start, stop), system.shape)]


def readings_of(
    problems: Problems, system: System, gauges: Any, times: Any
) -> Readings:
    """Check gauges and times; note mistakes."""
    if not isinstance(gauges, Sequence | np.ndarray):
        problems.append(("gauges", f"must be [(body, x), ...], got {shown(gauges)}"))
        return Readings()
    if (times is None) == bool(len(gauges)):
        problems.append(
            ("times", "go with gauges=[(body, x), ...]; give both or neither")
        )
    if times is None or not len(gauges):
        return Readings()
    lengths = {i: b.length for i, b in enumerate(system.bodies) if isinstance(b, Rod)}
    places = []
    for i, gauge in enumerate(gauges):
        try:
            body, x = gauge
        except (TypeError, ValueError):
            problems.append(
                (f"gauges.{i}", f"must be (body, x), such as (1, 0.5), got {gauge!r}")
            )
            continue
        x = PLACE.checked(problems, f"gauges.{i}.x", x)
        if (
            isinstance(body, bool)
            or not isinstance(body, Integral)
            or body not in lengths
        ):
            known = ", ".join(map(str, lengths))
            problems.append(
                (f"gauges.{i}.body", f"must be a rod, {known}; got {body!r}")
            )
        elif np.all(x > (shortest := float(np.min(lengths[int(body)])))):
            message = f"must lie in body {body} of every member, 0 to {shortest!r} m, got {x!r}"
            problems.append((f"gauges.{i}.x", message))
        else:
            places.append((int(body), x))
    read_at: Any = Field("s", "non-negative").checked(problems, "times", times)
    if np.ndim(read_at) != 1:
        problems.append(("times", f"must be a list of times, got {times!r}"))
    return Readings(tuple(places), read_at)


def _also(problems: Problems, given: Any, until: float | None) -> tuple[str, ...]:
    """Check what else is wanted; note mistakes."""
    known = ", ".join(f'"{name}"' for name in ALSO)
    if isinstance(given, str) or not isinstance(given, Sequence):
        problems.append(("also", f"must be a list of {known}, got {shown(given)}"))
        return ()
    problems += [
        ("also", f"must be of {known}, got {shown(name)}")
        for name in given
        if not isinstance(name, str) or name not in ALSO
    ]
    if "displacement" in given and until is None:
        message = "a body that flies on has no last displacement; give the time (until)"
        problems.append(("also", message))
    return tuple(name for name in ALSO if name in given)
