"""sweep(): every collision of a family, on any executor.

A family is cut into chunks, which are smaller families; a chunk's result is a table of columns, one
row a collision. Whoever runs a chunk, and in which order, its numbers are the same bit for bit.
"""

from __future__ import annotations

import contextlib
import math
import os
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import asdict, replace
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import __version__
from ..methods.abilities import driven
from ..methods.fronts.assembly import Blueprint
from ..methods.fronts.families import Stopped, chunk_members, run_family
from ..methods.fronts.front_kernel import CAP, CLOCK, FULL
from ..methods.groups import body_velocities, unilateral
from ..methods.registry import METHODS, Options, count
from ..methods.row import Row
from ..methods.run import MAX_EVENTS
from ..model import Rod, System
from ..model.frozen import InvalidModel, Problems, number
from ..results.outcome import effective_restitution
from ..results.solution import Solution
from ..storage.checkpoint import Checkpoint
from ..storage.writing import PathLike
from ..units import shown
from .sweep_result import (
    ENDED,
    STATUS,
    Columns,
    ContactColumns,
    Readings,
    SweepResult,
    arrays_of,
    explanation,
)

ONE_BY_ONE = 16  # members of a chunk where each is solved alone
AHEAD = 32  # chunks handed to an executor before the first is waited for


class SweepError(ValueError):
    """A member of the family could not be run to its end.

    Attributes
    ----------
    index : tuple of int
    parameters : dict of str to float
        What is special about this member, by path.
    problems : list of (str, str)
        The member, and what is wrong with it.
    """

    def __init__(self, index: tuple[int, ...], parameters: dict[str, float], reason: str) -> None:
        self.index, self.parameters = index, parameters
        numbers = ", ".join(f"{path} = {value!r}" for path, value in parameters.items())
        self.problems = [(f"member {list(index)} ({numbers})", reason)]
        super().__init__(f"{self.problems[0][0]}: {reason}")
        self._arguments = (index, parameters, reason)

    def __reduce__(self) -> tuple[Any, ...]:
        return SweepError, self._arguments


def sweep(
    system: System, method: str = "auto", executor: Executor | None = None, *,
    until: float | None = None, max_events: int = MAX_EVENTS, dt: float | None = None,
    rtol: float | None = None, cells: int | None = None,
    gauges: Sequence[tuple[int, float]] = (), times: ArrayLike | None = None,
    workers: int | None = None, progress: Callable[[int, int], Any] | None = None,
    on_error: str = "record", checkpoint: PathLike | None = None,
) -> SweepResult:
    """Solve every collision of a family.

    Parameters
    ----------
    system : System
        Of any shape: numbers of the model that are arrays make a family, as NumPy broadcasts them.
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
    workers : int, optional
        Number of threads where there is no executor; default: the processors at hand.
    progress : callable, optional
        Called with the number of collisions done and of all, after each chunk.
    on_error : "record" or "raise"
        What to do about a member that cannot be solved, or is stopped by the cap on events or the
        clock: go on, with its `status` and what is known of it, or raise.
    checkpoint : path, optional
        Directory that keeps finished chunks, strains included, so that a sweep that was interrupted
        goes on where it was. The arrays of the result then stay on disk until they are looked at.

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
        If the checkpoint has parts that are not what was written; they are run again.

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
        problems.append(("on_error", f'must be "raise" or "record", got {shown(on_error)}'))
    if workers is not None:
        workers = count(problems, "workers", workers)
    runs_chunks = isinstance(executor, Executor | None)
    if not runs_chunks:
        message = "must be an executor, such as concurrent.futures.ProcessPoolExecutor()"
        problems.append(("executor", f"{message}, got {executor!r}"))
    try:
        options = Options(until, method, max_events, dt, rtol, cells)
        options = replace(options, method=options.method_for(system))
        readings = _readings(problems, system, gauges, times)
        if not math.prod(system.shape):
            message = f"has no members, its shape is {system.shape}; select one or more"
            problems.append(("system", message))
    except InvalidModel as error:
        problems += error.problems
    if problems:
        raise InvalidModel(problems)
    of = arrays_of(system, readings)
    together = METHODS[options.method].together and not readings.gauges
    most = chunk_members(Blueprint(Row(system))) if together else ONE_BY_ONE
    chunks = _Chunks(system.shape, most)
    size = math.prod(system.shape)
    keep: Checkpoint | None = None
    if checkpoint is None:
        columns = {name: np.empty((size, *beyond), kind) for name, (kind, beyond) in of.items()}
        done = np.zeros(len(chunks), dtype=bool)
    else:
        described = {
            "format": "rodimpact sweep", "rodimpact": __version__, "system": system.digest,
            "shape": list(system.shape), **asdict(options), **readings.to_dict(),
        }
        shapes = {name: (np.dtype(kind), (*system.shape, *beyond))
                  for name, (kind, beyond) in of.items()}
        spans = [chunks.span(number) for number in range(len(chunks))]
        keep = Checkpoint(checkpoint, described, shapes, spans)
        columns, done = keep.columns(), keep.done.copy()

    def arrived(number: int, part: Columns) -> None:
        start, stop = chunks.span(number)
        if on_error == "raise":
            _raise_first(part["status"], start, system, options)
        if keep is not None and not done[number]:
            keep.write(number, part)
        elif keep is None:
            for name, values in part.items():
                columns[name][start:stop] = values
        if progress is not None:
            progress(stop, size)

    waiting: deque[tuple[int, Any]] = deque()
    try:
        for number in np.flatnonzero(done).tolist():
            start, stop = chunks.span(number)
            arrived(number, {"status": columns["status"].reshape(-1)[start:stop]})
        with _pool(executor, workers) as (pool, *asking):
            for number in np.flatnonzero(~done).tolist():
                if len(waiting) == AHEAD:
                    first, job = waiting.popleft()
                    arrived(first, job.result())
                part, more = system[chunks.box(number)], size - chunks.span(number)[1]
                own = [*asking, more] if asking else []
                waiting.append((number, pool.submit(run_chunk, part, options, readings, *own)))
            while waiting:
                first, job = waiting.popleft()
                arrived(first, job.result())
    finally:
        for _, job in waiting:
            job.cancel()
        if keep is not None:
            keep.close()
    if keep is not None:
        columns = keep.columns()
    shaped = {
        name: columns[name].reshape((*system.shape, *beyond)) for name, (_, beyond) in of.items()
    }
    strain = shaped.pop("strain", None)
    return SweepResult(system, options, shaped, readings, strain)


def run_chunk(
    system: System, options: Options, readings: Readings,
    stop: Callable[[], bool] = lambda: False, more: int = 0,
) -> Columns:
    """Columns of the members of a family, in C order; what executors run.

    The method is chosen, and `options` hold for the family, of which so many `more` members are
    certain to follow in this process.
    """
    together, columns = METHODS[options.method].together, {}
    if not together or readings.gauges:
        columns = _one_by_one(system, options, readings, stop)
    if together:
        columns |= _together(system, options, stop, more)
    kinds = {name: kind for name, (kind, _) in arrays_of(system, readings).items()}
    return {name: columns[name].astype(kind) for name, kind in kinds.items()}


def _one_by_one(
    system: System, options: Options, readings: Readings, stop: Callable[[], bool]
) -> Columns:
    """Columns of members that are solved each alone."""
    size = math.prod(system.shape)
    columns: Columns = {
        name: np.full((size, *beyond), math.nan if kind is np.float64 else 0)
        for name, (kind, beyond) in arrays_of(system, readings).items()
    }
    columns["status"][:] = STATUS.index("refused")
    for place, index in enumerate(np.ndindex(system.shape)):
        if stop():
            raise Stopped
        try:
            solution = Solution(options.run(options.method, system[index]))
        except InvalidModel:
            continue
        o = solution.outcome
        as_asked = options.until is None or solution.stopped_by == "until"
        columns["status"][place] = STATUS.index(
            "final" if o.final and as_asked else solution.stopped_by
        )
        columns["final"][place], columns["vibration"][place] = o.final, sum(o.vibration_after)
        if not o.why_no_restitution():
            columns["restitution"][place] = o.restitution
        for i, v in enumerate(o.velocities_after):
            columns[f"velocity_after.{i}"][place] = v
        for k in o.unilateral:
            for name in ContactColumns._fields:
                columns[f"{name}.{k}"][place] = getattr(o.contacts[k], name)
        for g, (body, x) in enumerate(readings.gauges):
            inside = readings.times <= solution.t_end * (1 + 1e-12)
            record = solution.gauge(body, x)
            columns["strain"][place, g, inside] = record.strain_at(readings.times[inside])
    return columns


def _together(
    system: System, options: Options, stop: Callable[[], bool], more: int
) -> Columns:
    """Columns of members that the fronts method runs as a family."""
    plan = Blueprint(Row(system))
    run = run_family(plan, system.shape, options.until, options.max_events, stop, more)
    first, nodes = [span[0] for span in plan.row.spans], plan.make.node
    contacts = range(len(system.contacts))
    final = run.final & (not driven(system))
    unknown = np.where(run.flag == FULL, math.nan, 0.0)
    before, after = (
        [unknown + np.broadcast_to(v, system.shape).ravel()
         for v in body_velocities(system, first, [x.reshape(system.shape) for x in by_segment.T],
                                  0.0)]
        for by_segment in (run.before, run.after)
    )
    able = unilateral(system)
    e = np.full(len(unknown), math.nan)
    if len(able) == 1:
        k = able[0]
        e = effective_restitution(
            final, run.episodes[:, nodes[k]], before[k : k + 2], after[k : k + 2]
        )
    columns = {"restitution": e}
    columns |= {f"velocity_after.{i}": v for i, v in enumerate(after)}
    for name in ContactColumns._fields:
        by_node = getattr(run, name)
        for k in contacts:
            values = by_node[:, nodes[k]]
            if name != "episodes":
                values = unknown + values if k in able else np.full(len(e), math.nan)
            columns[f"{name}.{k}"] = values
    capped = (run.flag == CAP) & (~final | (options.until is not None))
    places = [STATUS.index(name) for name in ("max_events", "clock", "refused", "final")]
    status = np.select(
        [capped, run.flag == CLOCK, run.flag == FULL, final], places, STATUS.index("until")
    )
    return {**columns, "vibration": unknown + run.vibration, "final": final, "status": status}


class _Chunks:
    """A shape cut into boxes that are contiguous in C order and hold at most `most` members."""

    def __init__(self, shape: tuple[int, ...], most: int) -> None:
        padded = (1, *shape)
        axis = min(d for d in range(len(padded)) if math.prod(padded[d + 1 :]) <= most)
        self._outer, self._inner = padded[:axis], math.prod(padded[axis + 1 :])
        self._rest = (slice(None),) * (len(shape) - axis)
        parts = -(-padded[axis] // (most // self._inner))
        self._cuts = [padded[axis] * i // parts for i in range(parts + 1)]

    def __len__(self) -> int:
        return math.prod(self._outer) * (len(self._cuts) - 1)

    def span(self, number: int) -> tuple[int, int]:
        """First and last flat index of a chunk."""
        outer, part = divmod(number, len(self._cuts) - 1)
        low, high = (outer * self._cuts[-1] + cut for cut in self._cuts[part : part + 2])
        return low * self._inner, high * self._inner

    def box(self, number: int) -> tuple[slice, ...]:
        """Index of a chunk in the family."""
        outer, part = divmod(number, len(self._cuts) - 1)
        leading = [slice(int(i), int(i) + 1) for i in np.unravel_index(outer, self._outer)]
        return (*leading, slice(*self._cuts[part : part + 2]), *self._rest)[1:]


class _Here(Executor):
    """Does every job at once, itself."""

    def submit(self, job: Callable[..., Any], /, *given: Any, **named: Any) -> Future[Any]:
        """Do it; what goes wrong is raised here."""
        future: Future[Any] = Future()
        future.set_result(job(*given, **named))
        return future


@contextlib.contextmanager
def _pool(executor: Executor | None, workers: int | None) -> Iterator[tuple[Any, ...]]:
    """An executor, and for our own what its jobs ask whether to stop."""
    if executor is not None:
        yield (executor,)
        return
    stopping = threading.Event()
    with ThreadPoolExecutor(workers or _processors()) as pool:
        doing: Executor = pool
        try:
            pool.submit(int)
        except RuntimeError:  # no thread can start, as in a browser
            doing = _Here()
        try:
            yield doing, stopping.is_set
        except BaseException:
            stopping.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _processors() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _readings(problems: Problems, system: System, gauges: Any, times: Any) -> Readings:
    """Check gauges and times; note mistakes."""
    if not isinstance(gauges, Sequence | np.ndarray):
        problems.append(("gauges", f"must be [(body, x), ...], got {shown(gauges)}"))
        return Readings()
    if times is None or not len(gauges):
        if times is not None or len(gauges):
            problems.append(("times", "go with gauges=[(body, x), ...]; give both or neither"))
        return Readings()
    lengths = {i: b.length for i, b in enumerate(system.bodies) if isinstance(b, Rod)}
    places = []
    for i, gauge in enumerate(gauges):
        try:
            body, x = gauge
        except (TypeError, ValueError):
            problems.append((f"gauges.{i}", f"must be (body, x), such as (1, 0.5), got {gauge!r}"))
            continue
        x = number(problems, f"gauges.{i}.x", x, "m", "non-negative")
        if isinstance(body, bool) or not isinstance(body, Integral) or body not in lengths:
            known = ", ".join(map(str, lengths))
            problems.append((f"gauges.{i}.body", f"must be a rod, {known}; got {body!r}"))
        elif not isinstance(x, float):
            problems.append((f"gauges.{i}.x", f"must be a single number, got {x!r}"))
        elif x > (shortest := float(np.min(lengths[int(body)]))):
            message = f"must lie in body {body} of every member, 0 to {shortest!r} m, got {x!r}"
            problems.append((f"gauges.{i}.x", message))
        else:
            places.append((int(body), x))
    read_at: Any = number(problems, "times", times, "s", "non-negative")
    if np.ndim(read_at) != 1:
        problems.append(("times", f"must be a list of times, got {times!r}"))
    return Readings(tuple(places), read_at)


def _raise_first(status: Any, start: int, system: System, options: Options) -> None:
    """Raise for the first member of a chunk that did not come to its end."""
    bad = np.flatnonzero(~np.isin(status, ENDED))
    if not bad.size:
        return
    index = tuple(int(i) for i in np.unravel_index(start + bad[0], system.shape))
    reason = explanation(system[index], options)
    parameters = {
        path: float(np.broadcast_to(values, system.shape)[index])
        for path, values in system.parameters.items()
    }
    raise SweepError(index, parameters, f'{reason} (on_error="record" keeps the others)')
