"""sweep(): every collision of a family, on any executor, as arrays of the family's shape.

A family is cut into chunks, which are smaller families; a chunk's result is a table of columns, one
row a collision. Whoever runs a chunk, and in which order, its numbers are the same bit for bit.
"""

from __future__ import annotations

import contextlib
import math
import os
import threading
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass
from numbers import Integral
from typing import Any, NamedTuple

import numpy as np

from . import __version__
from .checkpoint import Checkpoint
from .files import PathLike, write_npz, written
from .frozen import InvalidModel, Problems
from .methods.abilities import choose, driven, refuse
from .methods.assembly import Blueprint
from .methods.families import Stopped, chunk_members, run_family
from .methods.front_kernel import CAP, CLOCK, FULL
from .methods.fronts import MAX_EVENTS
from .model import Bonded, System
from .outcome import body_velocities, effective_restitution
from .solving import METHODS, solve

STATUS = ("final", "max_events", "clock", "refused")
"""Why each run stopped; `SweepResult.status` holds places in this tuple."""

ONE_BY_ONE = 16  # members of a chunk where each is solved alone
AHEAD = 32  # chunks handed to an executor before the first is waited for
Columns = dict[str, Any]


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
        self._given = (index, parameters, reason)

    def __reduce__(self) -> tuple[Any, ...]:
        return SweepError, self._given


class Axis(NamedTuple):
    """One dimension of a family: the path of the number that varies along it alone, and its values.

    Where there is no such number, the name is ``"axis 0"`` and the values count from 0.
    """

    name: str
    values: Any


class ContactColumns(NamedTuple):
    """Totals of one contact; arrays of the family's shape, SI units."""

    impulse: Any
    peak_force: Any
    duration: Any
    episodes: Any


@dataclass(frozen=True, eq=False)
class SweepResult:
    """Outcomes of a family of collisions; every array has its `shape`.

    Attributes
    ----------
    system : System
        The family.
    method : str
    max_events : int
        Cap on the events of a member.
    columns : dict of str to array
        By name: ``restitution``; ``velocity_after.I`` of body I, m/s; ``impulse.K`` (N s),
        ``peak_force.K`` (N), ``duration.K`` (time under force, s) and ``episodes.K`` of contact K;
        ``vibration``, energy left in vibration and strain, J; ``final``; ``status``. Totals count
        up to the proof that the collision is over. A number that does not exist is nan, as the
        impulse of a bonded contact, which never ends.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> left = ri.Rod(np.array([0.2, 0.4, 0.8]), area=1e-4, material=ri.materials.steel, velocity=1)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> ri.sweep(ri.System([left, right])).restitution.round(12)
    array([0.2, 0.4, 0.8])
    """

    system: System
    method: str
    max_events: int
    columns: Columns

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the family."""
        return self.system.shape

    @property
    def parameters(self) -> dict[str, Any]:
        """Numbers in which the members differ, by path; they broadcast to `shape`."""
        return self.system.parameters

    @property
    def axes(self) -> tuple[Axis, ...]:
        """What varies along each dimension."""
        found = [Axis(f"axis {d}", np.arange(size)) for d, size in enumerate(self.shape)]
        for path, values in reversed(self.parameters.items()):
            wide = [d for d, size in enumerate(values.shape) if size > 1]
            if len(wide) == 1:
                found[wide[0] - values.ndim] = Axis(path, values.ravel())
        return tuple(found)

    @property
    def restitution(self) -> Any:
        """Effective coefficient of restitution e; nan where undefined, see `explain`."""
        return self.columns["restitution"]

    @property
    def velocities_after(self) -> tuple[Any, ...]:
        """Velocities of the centres of mass, one array a body, m/s."""
        return tuple(
            self.columns[f"velocity_after.{i}"] for i in range(len(self.system.bodies))
        )

    @property
    def vibration(self) -> Any:
        """Energy left in vibration and strain, J."""
        return self.columns["vibration"]

    @property
    def final(self) -> Any:
        """Whether it is proved that no contact can happen again."""
        return self.columns["final"]

    @property
    def status(self) -> Any:
        """Why each run stopped: places in `STATUS`."""
        return self.columns["status"]

    @property
    def contacts(self) -> tuple[ContactColumns, ...]:
        """Totals of each contact, walls counted."""
        return tuple(
            ContactColumns(*(self.columns[f"{name}.{k}"] for name in ContactColumns._fields))
            for k in range(len(self.system.contacts))
        )

    def _only(self) -> ContactColumns:
        unilateral = _unilateral(self.system)
        if len(unilateral) != 1:
            message = f"these rows have {len(unilateral)} contacts that can open, not 1"
            raise ValueError(f"{message}; use result.contacts")
        return self.contacts[unilateral[0]]

    @property
    def impulse(self) -> Any:
        """Impulse of the only contact, N s; ValueError where there are several."""
        return self._only().impulse

    @property
    def duration(self) -> Any:
        """Time under force of the only contact, s; ValueError where there are several."""
        return self._only().duration

    @property
    def peak_force(self) -> Any:
        """Largest force of the only contact, N; ValueError where there are several."""
        return self._only().peak_force

    @property
    def episodes(self) -> Any:
        """How often the only contact pressed; ValueError where there are several."""
        return self._only().episodes

    def explain(self, index: Any) -> str:
        """Say of one member why it ended as it did, and why it has no restitution if it has none.

        Parameters
        ----------
        index : int or tuple of int
        """
        return _explain(self.system[index], self.method, self.max_events)

    def save(self, path: PathLike, *, force: bool = False) -> None:
        """Write an NPZ file that `rodimpact.load` reads.

        Raises
        ------
        FileExistsError
            If the file is there and `force` is false.
        """
        numbers: Columns = {}

        def put(array: Any) -> dict[str, str]:
            name = f"number.{len(numbers)}"
            numbers[name] = array
            return {"array": name}

        document = {
            "system": self.system._mapped(put).to_dict(), "method": self.method,
            "max_events": self.max_events, "shape": list(self.shape),
        }
        write_npz(path, "sweep", document, {**numbers, **self.columns}, force=force)

    @classmethod
    def restored(cls, document: dict[str, Any], arrays: Columns) -> SweepResult:
        """Make again what `save` wrote."""

        def take(value: Any) -> Any:
            if isinstance(value, dict):
                name = value.get("array")
                return arrays[name] if name else {key: take(v) for key, v in value.items()}
            return [take(v) for v in value] if isinstance(value, list) else value

        system = System.from_dict(take(document["system"]))
        columns = {name: arrays[name] for name in _kinds(system)}
        if any(c.shape != system.shape for c in columns.values()):
            raise ValueError("columns do not have the family's shape")
        return cls(system, document["method"], document["max_events"], columns)

    def table(self, start: int = 0, stop: int | None = None) -> Columns:
        """Varied numbers and results of the members `start` to `stop` in C order, by name."""
        which = np.arange(math.prod(self.shape))[start:stop]
        index = np.unravel_index(which, self.shape)
        both = {**self.parameters, **self.columns}
        return {name: np.broadcast_to(v, self.shape)[index] for name, v in both.items()}

    def csv_lines(self) -> Iterator[str]:
        """Lines of a table of all members, names first: every digit, an empty cell for nan."""
        yield ",".join([*self.parameters, *self.columns])
        size = math.prod(self.shape)
        for start in range(0, size, 4096):
            table = self.table(start, start + 4096)
            table["status"] = np.array(STATUS)[table["status"]]
            for row in zip(*(values.tolist() for values in table.values()), strict=True):
                yield ",".join("" if v != v else str(v) for v in row)

    def to_csv(self, path: PathLike, *, force: bool = False) -> None:
        """Write a table of all members, one a line, with what varies and what came out.

        Raises
        ------
        FileExistsError
            If the file is there and `force` is false.
        """
        with written(path, force=force) as file:
            for line in self.csv_lines():
                file.write(f"{line}\n".encode())

    def to_dataframe(self) -> Any:
        """All members as a pandas DataFrame (extra ``dataframe``), one a row."""
        pandas = _extra("pandas", "dataframe")
        frame = pandas.DataFrame(self.table())
        frame["status"] = pandas.Categorical.from_codes(frame["status"], STATUS)
        return frame

    def to_xarray(self) -> Any:
        """Everything as an xarray Dataset (extra ``xarray``), a dimension an axis."""
        xarray = _extra("xarray", "xarray")
        names = [axis.name for axis in self.axes]
        coordinates = {axis.name: axis.values for axis in self.axes}
        for path, values in self.parameters.items():
            if path not in coordinates:
                coordinates[path] = (names, np.broadcast_to(values, self.shape))
        columns = {name: (names, values) for name, values in self.columns.items()}
        return xarray.Dataset(columns, coordinates, {"status": ", ".join(STATUS)})

    def __repr__(self) -> str:
        what = ", ".join(self.parameters) or "nothing"
        return f"<SweepResult of shape {self.shape} over {what}>"

    def _repr_html_(self) -> str:
        from .plot.notebook import sweep_html

        return sweep_html(self)


def sweep(
    system: System,
    method: str = "auto",
    executor: Executor | None = None,
    *,
    workers: int | None = None,
    progress: Callable[[int, int], Any] | None = None,
    on_error: str = "raise",
    checkpoint: PathLike | None = None,
    max_events: int = MAX_EVENTS,
) -> SweepResult:
    """Solve every collision of a family.

    Parameters
    ----------
    system : System
        Of any shape: numbers of the model that are arrays make a family, as NumPy broadcasts them.
    method : str
        As for `solve`.
    executor : concurrent.futures.Executor, optional
        Who runs the chunks: threads of this process if not given, else processes, a cluster by
        ``dask.distributed.Client.get_executor()`` or ``mpi4py.futures.MPIPoolExecutor``. The result
        is the same bit for bit.
    workers : int, optional
        Number of threads where there is no executor; default: the processors at hand.
    progress : callable, optional
        Called with the number of collisions done and of all, after each chunk.
    on_error : "raise" or "record"
        What to do about a member that cannot be run to the proof that it is over: raise, or go on
        and leave nan and its `status`.
    checkpoint : path, optional
        Directory that keeps finished chunks, so that a sweep that was interrupted goes on where it
        was. The columns of the result then stay on disk until they are looked at.
    max_events : int
        Cap on the events of each member.

    Returns
    -------
    SweepResult

    Raises
    ------
    InvalidModel
        If an argument is wrong, or the method lacks something that the system has.
    SweepError
        With ``on_error="raise"``, for the first member in C order that did not come to an end.
    FileFormatError, OSError
        If the checkpoint directory holds something else, or cannot be written.
    """
    _check(system, method, workers, on_error, max_events)
    chosen = choose(system) if method == "auto" else method
    refuse(chosen, system)
    most = chunk_members(Blueprint(system)) if chosen == "fronts" else ONE_BY_ONE
    chunks = _Chunks(system.shape, most)
    kinds = _kinds(system)
    keep: Checkpoint | None = None
    if checkpoint is None:
        columns = {name: np.empty(math.prod(system.shape), kind) for name, kind in kinds.items()}
        done = np.zeros(len(chunks), dtype=bool)
    else:
        described = {
            "format": "rodimpact sweep", "rodimpact": __version__, "system": system.digest,
            "shape": list(system.shape), "method": chosen, "max_events": max_events,
        }
        of = {name: (np.dtype(kind), system.shape) for name, kind in kinds.items()}
        keep = Checkpoint(checkpoint, described, of, len(chunks))
        columns, done = keep.columns(), keep.done.copy()

    def arrived(number: int, found: Columns) -> None:
        start, stop = chunks.span(number)
        if on_error == "raise":
            _raise_first(found["status"], start, system, chosen, max_events)
        if keep is not None and not done[number]:
            keep.write(number, start, found)
        elif keep is None:
            for name, values in found.items():
                columns[name][start:stop] = values
        if progress is not None:
            progress(stop, math.prod(system.shape))

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
                part = system[chunks.box(number)]
                waiting.append((number, pool.submit(
                    run_chunk, part, chosen, max_events, *asking
                )))
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
    shaped = {name: values.reshape(system.shape) for name, values in columns.items()}
    return SweepResult(system, chosen, max_events, shaped)


def run_chunk(
    system: System, method: str, max_events: int, stop: Callable[[], bool] = lambda: False
) -> Columns:
    """Columns of the members of a family, in C order; what executors run."""
    together = method == "fronts" and not driven(system)
    found = (_together if together else _one_by_one)(system, method, max_events, stop)
    return {name: found[name].astype(kind) for name, kind in _kinds(system).items()}


def _one_by_one(
    system: System, method: str, max_events: int, stop: Callable[[], bool]
) -> Columns:
    """Columns of members that are solved each alone."""
    kinds = _kinds(system)
    count = math.prod(system.shape)
    found: Columns = {
        name: np.full(count, math.nan if kind is np.float64 else 0) for name, kind in kinds.items()
    }
    found["status"][:] = STATUS.index("refused")
    for place, index in enumerate(np.ndindex(system.shape)):
        if stop():
            raise Stopped
        try:
            solution = solve(system[index], method=method, max_events=max_events)
        except InvalidModel:
            continue
        o = solution.outcome
        found["status"][place] = STATUS.index("final" if o.final else solution.stopped_by)
        found["final"][place], found["vibration"][place] = o.final, sum(o.vibration_after)
        if not o.why_no_restitution():
            found["restitution"][place] = o.restitution
        for i, v in enumerate(o.velocities_after):
            found[f"velocity_after.{i}"][place] = v
        for k in o.unilateral:
            for name in ContactColumns._fields:
                found[f"{name}.{k}"][place] = getattr(o.contacts[k], name)
    return found


def _together(
    system: System, _: str, max_events: int, stop: Callable[[], bool]
) -> Columns:
    """Columns of members that the fronts method runs in compiled code."""
    plan = Blueprint(system)
    run = run_family(plan, system.shape, max_events, stop)
    first, nodes = [span[0] for span in plan.spans], plan.make.node
    contacts = range(len(system.contacts))
    unknown = np.where(run.flag == FULL, math.nan, 0.0)
    before, after = (
        [unknown + np.broadcast_to(v, system.shape).ravel()
         for v in body_velocities(system, first, [x.reshape(system.shape) for x in by_segment.T],
                                  0.0)]
        for by_segment in (run.before, run.after)
    )
    unilateral = _unilateral(system)
    e = np.full(len(unknown), math.nan)
    if len(unilateral) == 1:
        k = unilateral[0]
        e = effective_restitution(
            run.final, run.episodes[:, nodes[k]], before[k : k + 2], after[k : k + 2]
        )
    found = {"restitution": e}
    found |= {f"velocity_after.{i}": v for i, v in enumerate(after)}
    for name in ContactColumns._fields:
        by_node = getattr(run, name)
        for k in contacts:
            values = by_node[:, nodes[k]]
            if name != "episodes":
                values = unknown + values if k in unilateral else np.full(len(e), math.nan)
            found[f"{name}.{k}"] = values
    status = np.select(
        [run.final, run.flag == CAP, run.flag == CLOCK], [0, 1, 2], STATUS.index("refused")
    )
    return {
        **found, "vibration": unknown + run.vibration, "final": run.final, "status": status,
    }


def _kinds(system: System) -> dict[str, Any]:
    """Names and types of the columns."""
    contacts = range(len(system.contacts))
    kinds: dict[str, Any] = {"restitution": np.float64}
    kinds |= {f"velocity_after.{i}": np.float64 for i in range(len(system.bodies))}
    for name in ContactColumns._fields:
        kind = np.int32 if name == "episodes" else np.float64
        kinds |= {f"{name}.{k}": kind for k in contacts}
    return {**kinds, "vibration": np.float64, "final": np.bool_, "status": np.int8}


def _unilateral(system: System) -> list[int]:
    return [k for k, law in enumerate(system.contacts) if not isinstance(law, Bonded)]


class _Chunks:
    """A shape cut into boxes that are contiguous in C order and hold at most `most` members."""

    def __init__(self, shape: tuple[int, ...], most: int) -> None:
        padded = (1, *shape)
        axis = min(d for d in range(len(padded)) if math.prod(padded[d + 1 :]) <= most)
        self._outer, self._inner = padded[:axis], math.prod(padded[axis + 1 :])
        self._whole = (slice(None),) * (len(shape) - axis)
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
        return (*leading, slice(*self._cuts[part : part + 2]), *self._whole)[1:]


@contextlib.contextmanager
def _pool(executor: Executor | None, workers: int | None) -> Iterator[tuple[Any, ...]]:
    """An executor, and for our own what its jobs ask whether to stop."""
    if executor is not None:
        yield (executor,)
        return
    stopping = threading.Event()
    with ThreadPoolExecutor(workers or _processors()) as pool:
        try:
            yield pool, stopping.is_set
        except BaseException:
            stopping.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _processors() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _check(system: Any, method: str, workers: Any, on_error: str, max_events: Any) -> None:
    problems: Problems = []
    if not isinstance(system, System):
        message = f"must be a System, such as System([rod, Wall()]), got {system!r}"
        problems.append(("system", message))
    if method not in ("auto", *METHODS):
        known = ", ".join(f'"{m}"' for m in ("auto", *METHODS))
        problems.append(("method", f"must be one of {known}, got {method!r}"))
    if on_error not in ("raise", "record"):
        problems.append(("on_error", f'must be "raise" or "record", got {on_error!r}'))
    for name, value in (("max_events", max_events), ("workers", 1 if workers is None else workers)):
        if isinstance(value, bool) or not isinstance(value, Integral) or value < 1:
            problems.append((name, f"must be a positive whole number, got {value!r}"))
    if problems:
        raise InvalidModel(problems)


def _explain(member: System, method: str, max_events: int) -> str:
    try:
        outcome = solve(member, method=method, max_events=max_events).outcome
    except InvalidModel as error:
        return "; ".join(f"{path}: {said}" for path, said in error.problems)
    return (outcome.final and outcome.why_no_restitution()) or outcome.status


def _raise_first(
    status: Any, start: int, system: System, method: str, max_events: int
) -> None:
    """Raise for the first member of a chunk that did not come to its end."""
    bad = np.flatnonzero(status != STATUS.index("final"))
    if not bad.size:
        return
    index = tuple(int(i) for i in np.unravel_index(start + bad[0], system.shape))
    reason = _explain(system[index], method, max_events)
    parameters = {
        path: float(np.broadcast_to(values, system.shape)[index])
        for path, values in system.parameters.items()
    }
    raise SweepError(index, parameters, f'{reason} (on_error="record" keeps the others)')


def _extra(name: str, extra: str) -> Any:
    """An optional package, imported on demand."""
    from importlib import import_module

    try:
        return import_module(name)
    except ImportError:
        message = f"{name} is not installed; pip install 'rodimpact[{extra}]' adds it"
        raise ImportError(message) from None
