"""fit(): the parameters of a system that reproduce measured records best.

A coarse sweep between the bounds finds several starting points. A least-squares search
descends from each of them. If all searches end at the same point, the minimum is
unique.
"""

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any

import numpy as np

from ..methods.registry import METHODS, Options, count
from ..model import Rod, System
from ..model.arguments import of_kind, scalar
from ..model.frozen import Problems, invalid_argument, raise_if_problems
from ..progress import Progress, ProgressFunction, check_progress
from ..running.jobs import check_executor
from ..running.readings import check_readings
from ..units import shown
from .measured import Measured
from .objective import Objective
from .parameters import RECORD_PREFIX, record_parameters, system_parameters
from .result import Fit
from .searching import coarse_shares, search_from, sizes_of_numbers
from .summary import summarise


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
        positive and differ by a factor of 10 or more. ``records.0.shift``,
        ``records.0.gain`` and ``records.0.blur`` are numbers of the first record.
        ``records.*.gain`` is one gain for all records, ``records.[01].gain`` one for
        the first two. With the bounds None, shift and gain are free.
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
    Derivatives are forward differences. Residuals are not assumed independent: standard
    errors follow from the autocovariance of the residuals of each record,
    `rodimpact.fitting.uncertainty`.

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
    if options.until is None:
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
    search_count = count(problems, "starts", starts)
    check_progress(problems, progress)
    check_executor(problems, executor, system)
    gauges = [record.gauge for record in records]
    check_readings(problems, system, gauges, np.zeros(1))
    raise_if_problems(problems)

    vary_system = {}
    vary_records = {}
    for path, bounds in vary.items():
        if str(path).startswith(RECORD_PREFIX):
            vary_records[path] = bounds
        else:
            vary_system[path] = bounds
    parameters = system_parameters(system, vary_system)
    of_records = record_parameters(system, records, vary_records, options.until)
    is_step_given = not (dt is None and rtol is None and cells is None)
    if not is_step_given and "cells" in METHODS[options.method].takes:
        options = replace(options, cells=_cell_count(system, step))
    objective = Objective(
        system=system,
        measured=records,
        parameters=parameters,
        record_parameters=of_records,
        options=options,
        interval=step,
        executor=executor,
    )
    initial_shares = [parameter.share(parameter.initial) for parameter in parameters]
    with Progress(progress, "fit", "collisions") as report:
        objective.on_progress = lambda solved: report(solved, None)
        points = _starting_points(objective, initial_shares, search_count)
        sizes = sizes_of_numbers(objective, points[0])
        ends = []
        for point in points:
            ends.append(search_from(objective, point, sizes))
        ends.sort(key=lambda end: end.cost)
        return summarise(objective, ends, sizes)


def _checked_records(measured: Any) -> list[Measured]:
    """The records as a list; InvalidModel for anything else."""
    records = [measured]
    if isinstance(measured, list | tuple) and measured:
        records = list(measured)
    for record in records:
        of_kind("measured", record, Measured, "Measured(signal, gauge=(1, 0.5))")
    return records


def _checked_interval(interval: float | None, records: Sequence[Measured]) -> float:
    """Time step of the computed signals, s; by default the shortest of the records."""
    if interval is None:
        intervals = []
        for record in records:
            intervals.append(float(np.diff(record.signal.times).min()))
        interval = min(intervals)
    return scalar("interval", interval, "s", "positive")


def _cell_count(system: System, interval: float) -> int:
    """Cells of a grid with which a wave crosses one in an `interval`, s."""
    longest_transit = 0.0
    for body in system.bodies:
        if isinstance(body, Rod):
            for segment in body.segments:
                transit_time = float(segment.transit_time)
                longest_transit = max(longest_transit, transit_time)
    return math.ceil(longest_transit / interval)


def _starting_points(
    objective: Objective, initial_shares: Sequence[float], count: int
) -> list[Any]:
    """Points where searches begin, each the best of a part of a coarse sweep."""
    shares = coarse_shares(initial_shares)
    starts = []
    for tried, signals in zip(shares, objective.signals(shares), strict=True):
        starts.append(objective.best_start(tried, signals))
    points = []
    for k in range(min(count, len(starts))):
        best = min(starts[k::count], key=lambda start: start.misfit)
        points.append(best.point)
    return points
