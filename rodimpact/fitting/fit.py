"""fit(): the parameters of a system that reproduce measured records best.

A coarse sweep between the bounds finds several starting points. A least-squares search
descends from each of them. If all searches end at the same point, the minimum is
unique.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_arguments
from ..methods.registry import METHODS, Options, checked_count
from ..model import Rod, System
from ..model.arguments import check_kind, scalar
from ..model.frozen import Problems, invalid_argument, raise_if_problems
from ..progress import Progress, ProgressFunction, check_progress
from ..running.jobs import check_executor
from ..running.readings import check_readings
from ..units import shown
from .additions import Trial, with_additions
from .measured import Measured
from .objective import Objective
from .parameters import RECORD_PREFIX, record_parameters, system_parameters
from .result import Fit
from .searching import Grids, coarse_shares, search_on, sizes_of_numbers
from .summary import summarise

MIN_CELLS_TO_HALVE = 200
"""With at least as many cells, searches begin on a grid of half of them."""


@explain_arguments
def fit(
    system: System,
    measured: Measured | Sequence[Measured],
    vary: Mapping[str, tuple[float, float] | None],
    until: float,
    *,
    method: str = "auto",
    dt: float | None = None,
    rtol: float | None = None,
    cells: int | None = None,
    interval: float | None = None,
    starts: int = 3,
    additions: Mapping[str, Mapping[str, tuple[float, float] | None]] | None = None,
    executor: Executor | None = None,
    progress: bool | ProgressFunction = True,
) -> Fit:
    """Fit numbers of a system to measured records.

    Parameters
    ----------
    system : System
        A single system, not a family; its own values are tried first.
    measured : Measured or sequence of Measured
        Records, with their gauges.
    vary : dict of str to (float, float)
        The unknown numbers: their paths as in a case file, each with bounds in SI
        units. ``materials.NAME.field`` is common to all bodies of a material;
        ``wave_speed`` varies its Young's modulus. Steps are ratios if the bounds are
        positive and differ by a factor of 10 or more. ``records.0.shift``, ``.gain``,
        ``.blur``, ``.offset`` and ``.trend`` are numbers of the first record.
        ``records.*.gain`` is one gain for all records, ``records.[01].gain`` one for
        the first two. With the bounds None, all of these but the blur are free.
    until : float
        Time to which each collision runs, s.
    method, dt, rtol, cells
        Options of each collision, as for `solve`. If `dt`, `rtol` and `cells` are not
        given, a wave crosses a cell of a grid in one `interval`. Thus the number of
        cells is fixed, and predictions vary smoothly with the parameters.
    interval : float, optional
        Time step of the computed signals, s; by default the shortest time step of the
        records.
    starts : int
        Number of points of the coarse sweep from which a least-squares search begins.
    additions : dict of str to dict, optional
        Further unknown numbers by the name of an addition, each as in `vary`, such as
        ``{"blur": {"records.0.blur": (0.0, 1e-5)}}``. Each addition is tried alone.
        `Fit.additions` says which of them earn their place: add those to `vary`.
    executor : concurrent.futures.Executor, optional
        Solves the collisions of the coarse sweep; by default they are solved one by
        one.
    progress : bool or function
        Whether a bar may show that a long fit goes on. A function is called with the
        number of collisions solved so far, and None, since their number is not known
        before.

    Returns
    -------
    Fit

    Raises
    ------
    InvalidModel
        If an argument is invalid; the error names its path.

    Notes
    -----
    Derivatives are forward differences. On a grid, searches begin with half the cells,
    where a collision takes a quarter of the time, and end with all of them. Residuals
    are not assumed independent: standard errors follow from the autocovariance of the
    residuals of each record, `rodimpact.fitting.uncertainty`. Additions are compared by
    cross-validation, `rodimpact.fitting.additions`.

    Examples
    --------
    Length and velocity of the striker follow from a record, here a computed one:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> striker = ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0)
    >>> bar = ri.Rod(1.0, area=1e-4, material=steel)
    >>> solution = ri.solve(ri.System([striker, bar]), until=2e-4)
    >>> record = solution.gauge(1, 0.4).signal(1e-6)
    >>> guess = ri.Rod(0.3, area=1e-4, material=steel, velocity=5.0)
    >>> unknown = ri.System([guess, bar])
    >>> found = ri.fit(unknown, ri.Measured(record, (1, 0.4), shift=0.0, gain=1.0),
    ...                {"bodies.0.length": (0.1, 0.4),
    ...                 "bodies.0.velocity": (1.0, 20.0)}, until=2e-4)
    >>> {path: round(value, 6) for path, value in found.values.items()}
    {'bodies.0.length': 0.2, 'bodies.0.velocity': 10.0}
    """
    records = _checked_records(measured)
    options = Options(until, method, dt=dt, rtol=rtol, cells=cells)
    options = replace(options, method=options.method_for(system))
    if system.shape:
        message = (
            f"must be one system, got a family of shape {system.shape}; "
            "fit system[index]"
        )
        raise invalid_argument("system", message)
    if options.until is None:  # `Options` allows it, a fit does not
        raise invalid_argument(
            "until", "is missing; give a time, s, at which all pulses have passed"
        )
    if not isinstance(vary, Mapping) or not vary:
        message = (
            "must name numbers with their bounds, such as "
            f"{{'bodies.0.length': (0.1, 0.2)}}, got {shown(vary)}"
        )
        raise invalid_argument("vary", message)
    step = _checked_interval(interval, records)
    problems: Problems = []
    search_count = checked_count(problems, "starts", starts)
    check_progress(problems, progress)
    check_executor(problems, executor, system)
    gauges = []
    for record in records:
        gauges.append((record.place.body, record.place.x))
    # Only the gauges are checked; any time will do.
    check_readings(problems, system, gauges, times=np.zeros(1))
    raise_if_problems(problems)

    has_no_accuracy = dt is None and rtol is None and cells is None
    takes_cells = "cells" in METHODS[options.method].takes
    if has_no_accuracy and takes_cells:
        # By default cells follow from the parameters, and predictions would jump.
        options = replace(options, cells=_cell_count(system, step))
    checked_additions = _checked_additions(additions, vary)
    with Progress(progress, "fit", "collisions") as report:
        solved = itertools.count(1)  # collisions
        task = _Task(
            system=system,
            records=records,
            options=options,
            interval=step,
            executor=executor,
            on_solved=lambda: report(next(solved), None),  # how many follow is unknown
        )
        base = _fit_from_sweep(task, vary, search_count)
        if not checked_additions:
            return base.fit
        trials = []
        for name, numbers in checked_additions.items():
            trials.append(_fit_with_addition(task, name, {**vary, **numbers}, base))
        return with_additions(base, trials)


class _Task(NamedTuple):
    """What the fits with and without additions have in common."""

    system: System
    records: list[Measured]
    options: Options
    interval: float  # s
    executor: Executor | None
    on_solved: Callable[[], object]  # called after each collision


def _fit_from_sweep(task: _Task, vary: Mapping[str, Any], search_count: int) -> Trial:
    """Fit of the numbers in `vary` only: a search from each best point of a sweep.

    The result is the search with the least cost, with the name "". The sweep is on the
    coarse grid; each search begins on the coarse grid and ends on the fine one.
    """
    grids = _grids(task, vary)
    points = _starting_points(grids.coarse, search_count)
    sizes = sizes_of_numbers(grids.fine, points[0])  # of a gain: its value here
    ends = []
    for point in points:
        ends.append(search_on(grids, point, sizes))
    ends.sort(key=lambda end: end.cost)
    fit = summarise(grids.fine, ends, sizes)
    # The name is "" because nothing is added to `vary`.
    return Trial(name="", fit=fit, objective=grids.fine, end=ends[0])


def _fit_with_addition(
    task: _Task, name: str, vary: Mapping[str, Any], base: Trial
) -> Trial:
    """Fit with more numbers: one search from the end of the best search without them.

    The numbers added begin at their values in the system, or in the middle of their
    bounds. All numbers begin within the bounds of `vary`.
    """
    grids = _grids(task, vary)
    objective = grids.fine
    scaled_value_at = {}  # values that the base fit found, by path
    for number, scaled_value in zip(base.objective.numbers, base.end.x, strict=True):
        scaled_value_at[number.path] = scaled_value
    start = objective.point_at(objective.initial_shares)
    for i, number in enumerate(objective.numbers):
        start[i] = scaled_value_at.get(number.path, start[i])
    start = np.clip(start, objective.low, objective.high)
    sizes = sizes_of_numbers(objective, start)
    end = search_on(grids, start, sizes)
    return Trial(name, summarise(objective, [end], sizes), objective, end)


def _grids(task: _Task, vary: Mapping[str, Any]) -> Grids:
    """Objectives for the numbers to vary, with all cells of a grid and with half.

    Both are the same objective if the method has no cells, or there are fewer than
    `MIN_CELLS_TO_HALVE`.
    """
    vary_system = {}
    vary_records = {}
    for path, bounds in vary.items():
        if str(path).startswith(RECORD_PREFIX):
            vary_records[path] = bounds
        else:
            vary_system[path] = bounds
    assert task.options.until is not None
    make_objective = partial(
        Objective,
        system=task.system,
        measured=task.records,
        parameters=system_parameters(task.system, vary_system),
        record_parameters=record_parameters(
            task.system, task.records, vary_records, task.options.until
        ),
        interval=task.interval,
        executor=task.executor,
        on_solved=task.on_solved,
    )
    fine = make_objective(options=task.options)
    cells = task.options.cells
    if cells is None or cells < MIN_CELLS_TO_HALVE:
        return Grids(fine=fine, coarse=fine)
    coarse_options = replace(task.options, cells=cells // 2)
    return Grids(fine=fine, coarse=make_objective(options=coarse_options))


def _checked_additions(
    additions: Any, vary: Mapping[str, Any]
) -> dict[str, Mapping[str, Any]]:
    """Bounds by path for each addition, by its name; {} for None.

    InvalidModel is raised for anything but mappings, for an addition without numbers,
    and for a number that `vary` has already.
    """
    if additions is None:
        return {}
    checked = {}
    example = "{'blur': {'records.0.blur': (0.0, 1e-5)}}"
    if not isinstance(additions, Mapping):
        message = f"must be such as {example}, got {shown(additions)}"
        raise invalid_argument("additions", message)
    for name, numbers in additions.items():
        if not isinstance(numbers, Mapping) or not numbers:
            message = (
                f"must name numbers with their bounds, as in {example}, "
                f"got {shown(numbers)}"
            )
            raise invalid_argument(f"additions.{name}", message)
        for path in numbers:
            if path in vary:
                message = f"adds {path}, which already varies; leave it out of vary"
                raise invalid_argument(f"additions.{name}", message)
        checked[str(name)] = numbers
    return checked


def _checked_records(measured: Any) -> list[Measured]:
    """The records, or the one record, as a list.

    InvalidModel is raised for anything else, also for an empty list.
    """
    records = [measured]
    if isinstance(measured, list | tuple) and measured:  # an empty one is refused below
        records = list(measured)
    for record in records:
        check_kind("measured", record, Measured, "Measured(signal, gauge=(1, 0.5))")
    return records


def _checked_interval(interval: float | None, records: Sequence[Measured]) -> float:
    """Time step of the computed signals, s; by default the shortest in any record.

    It must be positive; a quantity with a unit is converted to s.
    """
    if interval is None:
        intervals = []
        for record in records:
            intervals.append(float(np.diff(record.signal.times).min()))
        interval = min(intervals)
    return scalar("interval", interval, "s", "positive")


def _cell_count(system: System, interval: float) -> int:
    """Cells of the longest transit, so that a wave crosses one in an `interval`, s.

    The longest transit is that of a segment. The number is rounded up.
    """
    longest_transit = 0.0
    for body in system.bodies:
        if isinstance(body, Rod):
            for segment in body.segments:
                transit_time = float(segment.transit_time)
                longest_transit = max(longest_transit, transit_time)
    return math.ceil(longest_transit / interval)


def _starting_points(objective: Objective, count: int) -> list[Any]:
    """At most `count` points where searches begin, each the best of a part of a sweep.

    Part k has the points k, k + count, k + 2 count, ... of the coarse sweep, so that
    each part fills all bounds. Each point of the sweep has the best shifts and gains.
    """
    shares = coarse_shares(objective.initial_shares)  # 0 to 1 between the bounds
    starts = []  # with the best shifts and gains for these shares
    for tried, signals in zip(shares, objective.signals(shares), strict=True):
        starts.append(objective.best_start(tried, signals))
    points = []
    for k in range(min(count, len(starts))):
        best = min(starts[k::count], key=lambda start: start.misfit)
        points.append(best.point)
    return points
