"""sweep(): every collision of a family, on any executor.

Its members are run in chunks, which are smaller families; a chunk's result is a table of columns,
one row a collision. Whoever runs a chunk, and in which order, its numbers are the same bit for bit.
"""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, replace
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..methods import memory
from ..methods.duration import Forecast, Progress, warn
from ..methods.groups import unilateral
from ..methods.registry import METHODS, Options, check_function, count
from ..methods.row import Row
from ..methods.run import ALSO, MAX_EVENTS, FamilyRun, Stopped
from ..model import Rod, System
from ..model.frozen import Field, InvalidModel, Problems, quantity, raise_noted
from ..results.outcome import effective_restitution
from ..results.solution import Solution
from ..storage.checkpoint import Checkpoint
from ..storage.writing import PathLike
from ..units import shown
from ..version import __version__
from .columns import ENDED, STATUS, Columns, Readings, arrays_of, row_of
from .jobs import pool_of, results_of
from .sweep_result import SweepResult

FORECAST = warn, "a smaller family", None, "this sweep"
PLACE = quantity("m", "non-negative", single=True)  # of a gauge
TOGETHER = (
    8192  # members that are kept, or run again, as one where they run in compiled code
)


class SweepError(ValueError):
    """A member of the family could not be run to its end.

    Attributes
    ----------
    index : tuple of int
    parameters : dict of str to float
        The numbers of this member that vary, by path.
    problems : list of (str, str)
        The member, and what is wrong with it.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> left = ri.Rod(np.array([0.2, 0.4]), area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> family = ri.System([left, ri.Rod(1.0, area=1e-4, material=ri.materials.steel)])
    >>> try:
    ...     ri.sweep(family, max_events=2, on_error="raise")
    ... except ri.SweepError as error:
    ...     print(error.index, error.parameters)
    (0,) {'bodies.0.length': 0.2}
    """

    def __init__(
        self, index: tuple[int, ...], parameters: dict[str, float], reason: str
    ) -> None:
        self.index, self.parameters = index, parameters
        numbers = ", ".join(f"{path} = {value!r}" for path, value in parameters.items())
        self.problems = [(f"member {list(index)} ({numbers})", reason)]
        super().__init__(f"{self.problems[0][0]}: {reason}")

    def __reduce__(self) -> tuple[Any, ...]:
        return SweepError, (self.index, self.parameters, self.problems[0][1])


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
    progress: Progress | None = None,
    on_error: str = "record",
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
        Number of threads where there is no executor; default: the processors at hand.
    progress : callable, optional
        Called with the number of collisions done and of all, twice a second or more often.
    on_error : "record" or "raise"
        For a member that cannot be solved, or that the cap on events or the clock stops:
        "record" keeps its `status` and the known results and goes on, "raise" raises.
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
    SweepError
        With ``on_error="raise"``, for the first member in C order that did not come to its end.
    FileFormatError, OSError
        If the checkpoint directory holds something else, or cannot be written.

    Warns
    -----
    DamagedChunks
        If the checkpoint has files that are not what was written; their members are run again.
    LongRun
        If the sweep will take more than five seconds; the message says how to shorten it.

    Notes
    -----
    An executor gets jobs of about a second, at most two for each worker at a time. An interrupt
    cancels jobs that wait. Jobs that run end within seconds, or with their present member.
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

    A bar of tqdm shows how far it is, here and in `solve`::

        with tqdm.tqdm(total=math.prod(family.shape)) as bar:
            result = ri.sweep(family, progress=lambda done, of: bar.update(done - bar.n))

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
    if not isinstance(on_error, str) or on_error not in ("raise", "record"):
        problems.append(
            ("on_error", f'must be "raise" or "record", got {shown(on_error)}')
        )
    if workers is not None:
        workers = count(problems, "workers", workers)
    check_function(problems, "progress", progress)
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
    together = (
        0
        if _alone(options, readings)
        else METHODS[options.method].members_per_call(Row(system))
    )
    size, unit = math.prod(system.shape), _unit(system, min(TOGETHER, together))
    described = (
        {}
        if checkpoint is None
        else {
            "rodimpact": __version__,
            "system": system.digest,
            "shape": system.shape,
            **asdict(options),
            **readings._asdict(),
            "times": readings.times.tolist(),
        }
    )
    keep = Checkpoint(arrays_of(system, readings), size, unit, checkpoint, described)
    shaped = {
        name: column.reshape((*system.shape, *column.shape[1:]))
        for name, column in keep.columns.items()
    }
    result = SweepResult(system, options, shaped, readings, shaped.pop("strain", None))
    raises, status = on_error == "raise", keep.columns["status"]
    done = keep.spans(keep.done) if raises else []
    wanted = min((_first_failure(status, *span) for span in done), default=size)
    with (
        contextlib.closing(keep),
        pool_of(executor, workers) as (pool, running, stopping),
    ):
        tell = _news_of(keep, running, together > 0, progress)
        results = results_of(
            running,
            lambda start, stop: pool.submit(
                run_job,
                _members(system, start, stop),
                options,
                readings,
                *((stopping, size - stop) if stopping else ()),
            ),
            keep.spans(~keep.done),
            unit,
            together or TOGETHER,
            lambda i: i < wanted,
        )
        with contextlib.closing(results):
            for parts in results:
                for start, stop, part in parts:
                    keep.put(start, stop, part)
                    if raises:
                        wanted = min(wanted, _first_failure(status, start, stop))
                tell(sum(stop - start for start, stop, _ in parts))
    if wanted < size:
        _raise_for(wanted, result)
    return result


def _first_failure(status: Any, start: int, stop: int) -> int:
    """The first of these members that did not come to its end, or how many there are in all."""
    failed = np.flatnonzero(~np.isin(status[start:stop], ENDED))
    return start + int(failed[0]) if len(failed) else len(status)


def _news_of(
    keep: Checkpoint, workers: int, compiles: bool, progress: Progress | None
) -> Callable[[int], None]:
    """Function that tells how far a sweep is, and how long it takes, as so many more have ended."""
    ended = counted = sum(stop - start for start, stop in keep.spans(keep.done))
    to_do, forecast = keep.size - ended, Forecast(*FORECAST)

    def tell(members: int) -> None:
        nonlocal ended, counted, forecast, compiles
        ended += members
        if not compiles:  # what runs is all that has been done in this time, at most
            done = max(ended - counted, workers)
            forecast.extrapolate(done, keep.size - counted, f"{to_do} collisions")
        elif members:  # the first waited for machine code
            counted, compiles, forecast = ended, False, Forecast(*FORECAST)
        if progress is not None:
            progress(ended, keep.size)

    return tell


def run_job(*of_chunk: Any) -> tuple[float, Columns]:
    """Run a chunk, as executors do: the s that it took, and its columns."""
    began = time.perf_counter()
    columns = run_chunk(*of_chunk)
    return time.perf_counter() - began, columns


def run_chunk(
    system: System,
    options: Options,
    readings: Readings,
    stop: Callable[[], bool] = lambda: False,
    more: int = 0,
) -> Columns:
    """Columns of the members of a family, in C order.

    The method is chosen, and `options` hold for the family, of which so many `more` members are
    certain to follow in this process.
    """
    method, columns = METHODS[options.method], {}
    own = {name: getattr(options, name) for name in method.takes}
    own["also"] = [name for name in readings.also if name in method.also]
    try:
        run = method.family and method.family(
            Row(system),
            options.until,
            options.max_events,
            **own,
            should_stop=stop,
            later_members=more,
        )
        if not run or _alone(options, readings):
            columns = _one_by_one(system, options, readings, stop)
        if run:
            columns |= _columns_of(run, system)
    finally:
        memory.give_back()
    return {
        name: columns[name].astype(kind, copy=False)
        for name, (kind, _) in arrays_of(system, readings).items()
    }


def _alone(options: Options, readings: Readings) -> bool:
    """Whether what is to be read needs the solution of each member."""
    return bool(readings.gauges) or not set(readings.also) <= {
        *METHODS[options.method].also
    }


def _one_by_one(
    system: System, options: Options, readings: Readings, stop: Callable[[], bool]
) -> Columns:
    """Columns of members that are solved each alone."""
    # a member that is refused has no numbers
    columns = {
        name: np.full(
            (math.prod(system.shape), *beyond), math.nan if kind is np.float64 else 0
        )
        for name, (kind, beyond) in arrays_of(system, readings).items()
    }
    columns["status"][...] = STATUS.index("refused")
    seen = readings.gauges or "largest_stress" in readings.also
    if "snapshots" in METHODS[options.method].takes and not seen:
        options = replace(
            options, snapshots=2
        )  # an outcome needs the first and the last state

    def ask(*_: Any) -> None:
        if stop():
            raise Stopped

    for i, index in enumerate(np.ndindex(system.shape)):
        ask()
        with contextlib.suppress(InvalidModel), np.errstate(under="ignore"):
            solution = Solution(
                options.run(options.method, system[index], progress=ask)
            )
            for name, value in row_of(solution, readings).items():
                columns[name][i] = value
    return columns


def _columns_of(run: FamilyRun, system: System) -> Columns:
    """Columns of members that the method has run in one call."""
    able, e = unilateral(system), np.full(len(run.final), math.nan)
    if len(able) == 1:
        k = able[0]
        e = effective_restitution(
            run.final,
            run.contacts["episodes"][k],
            run.before[k : k + 2],
            run.after[k : k + 2],
        )
    columns = {
        "restitution": e,
        "vibration": run.vibration,
        "final": run.final,
        "status": run.stopped_by,
        **run.further,
    }
    columns |= {f"velocity_after.{i}": v for i, v in enumerate(run.after)}
    return columns | {
        f"{name}.{k}": values
        for name, by_contact in run.contacts.items()
        for k, values in enumerate(by_contact)
    }


def _members(system: System, start: int, stop: int) -> System:
    """Members of a family from `start` to `stop` in C order."""
    if stop - start == math.prod(system.shape):
        return system
    row = math.prod(system.shape[1:])
    if start % row == stop % row == 0:
        return system[start // row : stop // row]
    return system[np.unravel_index(np.arange(start, stop), system.shape)]


def _unit(system: System, most: int) -> int:
    """Members of a chunk: an even number of like chunks, of whole rows of the family if they fit.

    Numbers that vary along other axes alone stay small in a chunk of whole rows.
    """
    size, row = math.prod(system.shape), math.prod(system.shape[1:])
    if most == 0:
        return 1
    unit = -(-size // (2 * -(-size // (2 * most))))
    whole = -(-unit // row) * row
    if unit < row:
        return unit
    return whole if whole <= most else unit - unit % row


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


def _raise_for(member: int, result: SweepResult) -> None:
    """Say why a member did not come to its end."""
    index = tuple(map(int, np.unravel_index(member, result.shape)))
    parameters = {
        path: float(np.broadcast_to(values, result.shape)[index])
        for path, values in result.parameters.items()
    }
    reason = f'{result.explain(index)} (on_error="record" keeps the others)'
    raise SweepError(index, parameters, reason)
