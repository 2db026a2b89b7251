"""fit(): the parameters of a system that reproduce measured records best.

A coarse sweep between the bounds finds several starting points. A least-squares search descends
from each of them. If all searches end at the same point, the minimum is unique.
"""

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any

import numpy as np

from ..methods.registry import METHODS, Options, count
from ..model import Rod, System
from ..model.arguments import of_kind, single
from ..model.frozen import Problems, raise_noted, refusal
from ..model.quantities import Floats
from ..progress import Progress, ProgressFunction, check_progress
from ..running.readings import check_readings
from ..units import shown
from .measured import Measured
from .objective import Objective
from .parameters import HEAD, parameters_of, record_numbers
from .result import Descent, Fit, Fitted, doubts, misfit_notes
from .uncertainty import covariance

TRIES = 16  # systems of the coarse sweep for each number that varies
MOST_STEPS = 200
DIFFERENCE_STEP = 1e-5  # of the range of a number, for derivatives


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
        The unknown numbers: their paths as in a case file, each with bounds in SI units.
        ``materials.NAME.field`` is common to all bodies of a material; ``wave_speed`` varies its
        Young's modulus. Steps are ratios if the bounds are positive and differ by a factor of 10 or
        more. ``records.0.shift``, ``records.0.gain`` and ``records.0.blur`` are numbers of the
        first record. ``records.*.gain`` is one gain for all records, ``records.[01].gain`` one for
        the first two. With the bounds None, shift and gain are free.
    until : float
        Time to which each collision runs, s.
    method, dt, rtol, cells
        Of each collision, as for `solve`. If `dt`, `rtol` and `cells` are not given, a wave crosses
        a cell of a grid in one `interval`. Thus the number of cells is fixed, and predictions vary
        smoothly with the parameters.
    interval : float, optional
        Time step of the computed signals, s; by default the shortest time step of the records.
    starts : int
        Number of points of the coarse sweep from which a least-squares search begins.
    executor : concurrent.futures.Executor, optional
        Solves the collisions of the coarse sweep; by default they are solved one by one.
    progress : bool or function
        Whether a bar may show that a long fit goes on. A function is called with the number of
        collisions solved so far, and None: nobody knows how many there will be.

    Returns
    -------
    Fit

    Raises
    ------
    InvalidModel
        If an argument is invalid; the error names its path.

    Notes
    -----
    Derivatives are forward differences. Residuals are not assumed independent: standard errors
    follow from the autocovariance of the residuals of each record, `rodimpact.fitting.uncertainty`.

    Examples
    --------
    Length and velocity of the striker follow from a record, here a computed one:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> rods = [ri.Rod(x, area=1e-4, material=steel, velocity=v) for x, v in ((0.2, 10), (1, 0))]
    >>> record = ri.solve(ri.System(rods), until=2e-4).gauge(1, 0.4).signal(1e-6)
    >>> unknown = ri.System([ri.Rod(0.3, area=1e-4, material=steel, velocity=5.0), rods[1]])
    >>> found = ri.fit(unknown, ri.Measured(record, (1, 0.4), shift=0.0, gain=1.0),
    ...                {"bodies.0.length": (0.1, 0.4), "bodies.0.velocity": (1.0, 20.0)}, 2e-4)
    >>> {path: round(value, 6) for path, value in found.values.items()}
    {'bodies.0.length': 0.2, 'bodies.0.velocity': 10.0}
    """
    records: list[Any] = (
        list(measured) if isinstance(measured, list | tuple) else [measured]
    )
    for each in records or [measured]:
        of_kind("measured", each, Measured, "Measured(signal, gauge=(1, 0.5))")
    options = Options(until, method, dt=dt, rtol=rtol, cells=cells)
    options = replace(options, method=options.method_for(system))
    if system.shape:
        message = f"must be one system, got a family of shape {system.shape}; fit system[index]"
        raise refusal("system", message)
    if options.until is None:
        raise refusal(
            "until", "is missing; give a time, s, at which all pulses have passed"
        )
    if not isinstance(vary, Mapping) or not vary:
        message = "must name numbers with their bounds, such as {'bodies.0.length': (0.1, 0.2)}"
        raise refusal("vary", f"{message}, got {shown(vary)}")
    shortest = min(float(np.diff(m.signal.times).min()) for m in records)
    step = single(
        "interval", shortest if interval is None else interval, "s", "positive"
    )
    problems: Problems = []
    begins = count(problems, "starts", starts)
    check_progress(problems, progress)
    check_readings(problems, system, [m.gauge for m in records], np.zeros(1))
    raise_noted(problems)
    ours = {path: ends for path, ends in vary.items() if str(path).startswith(HEAD)}
    parameters = parameters_of(system, {p: e for p, e in vary.items() if p not in ours})
    of_records = record_numbers(system, records, ours, options.until)
    if dt is rtol is cells is None and "cells" in METHODS[options.method].takes:
        pieces = [
            s for rod in system.bodies if isinstance(rod, Rod) for s in rod.segments
        ]
        crossing = max(s.transit_time for s in pieces)
        options = replace(options, cells=math.ceil(crossing / step))
    objective = Objective(
        system, records, parameters, of_records, options, step, executor
    )

    tried = _coarse([p.share(p.start) for p in parameters])
    with Progress(progress, "fit", "collisions") as report:
        objective.heard = lambda done: report(done, None)
        swept = [
            objective.started(shares, signals)
            for shares, signals in zip(tried, objective.signals(tried), strict=True)
        ]
        least = [
            min(swept[k::begins], key=lambda one: one[0])[1]
            for k in range(min(begins, len(swept)))
        ]
        lasting = max(m.signal.end - m.signal.start for m in records)
        sizes = np.array(
            [
                {"": 1.0, "gain": abs(x)}.get(n.kind, lasting)
                for n, x in zip(objective.all, least[0], strict=True)
            ]
        )
        ends = [_search(objective, point, sizes) for point in least]
        return _result(objective, sorted(ends, key=lambda end: end.cost), sizes)


def _coarse(own: Sequence[float]) -> list[Floats]:
    """Shares that fill evenly what lies between the bounds, first those of the system itself.

    Multiples of the powers of 1/x, x^(n+1) = x + 1: each new place lies far from all before it.
    """
    n, root = len(own), 2.0
    for _ in range(64):
        root = (1 + root) ** (1 / (n + 1))
    steps = root ** -np.arange(1.0, n + 1)
    return [np.array(own), *((0.5 + k * steps) % 1 for k in range(1, TRIES * n))]


def _search(objective: Objective, start: Floats, sizes: Floats) -> Any:
    """Descend from a start, first with blurs at their lower bounds, then with all numbers free.

    Predictions depend on the square of a blur, so a descent that begins without blur would stay
    there. It begins in the middle of the bounds. If it ends worse than without blur, the descent
    goes on from there, so that a blur never makes a fit worse.
    """
    free = objective.free
    blurs = free & objective.is_blur
    if not blurs.any():
        return _descend(objective, start, free, sizes)
    sharp = _descend(objective, start, free & ~blurs, sizes)
    blurred_start = np.where(blurs, objective.middle, sharp.x)
    blurred = _descend(objective, blurred_start, free, sizes)
    if blurred.cost > sharp.cost:
        blurred = _descend(objective, sharp.x, free, sizes)
    return blurred


def _descend(objective: Objective, start: Floats, free: Any, sizes: Floats) -> Any:
    """Least-squares search from a point; the result's `x` is the point where it ends.

    The variables are the free numbers over their sizes, plus 1: SciPy's differences take steps
    relative to a variable, and so the variables must not be 0.

    Parameters
    ----------
    objective : Objective
    start : [number] array
    free : [number] array of bool
        Numbers that vary.
    sizes : [number] array
    """
    from scipy.optimize import least_squares

    low = objective.low[free] / sizes[free] + 1.0
    high = objective.high[free] / sizes[free] + 1.0

    def point(variables: Floats) -> Floats:
        whole = start.copy()
        whole[free] = (variables - 1.0) * sizes[free]
        return whole

    def residuals(variables: Floats) -> Floats:
        return objective.residuals(point(variables))

    end = least_squares(
        residuals,
        np.clip(start[free] / sizes[free] + 1.0, low, high),
        bounds=(low, high),
        diff_step=DIFFERENCE_STEP,
        x_scale="jac",
        ftol=1e-10,
        xtol=1e-8,
        gtol=1e-10,
        max_nfev=MOST_STEPS,
    )
    end.x = point(end.x)
    return end


def _result(objective: Objective, ends: Sequence[Any], sizes: Floats) -> Fit:
    """The best end with its errors, and what there is to say about it."""
    best, records, free = ends[0], objective.measured, objective.free
    ranges = np.minimum(objective.high - objective.low, sizes)[free]
    jacobian = best.jac * (ranges / sizes[free])
    relative = covariance(jacobian, best.fun, objective.lengths)
    varied = [n for n, is_free in zip(objective.all, free, strict=True) if is_free]
    descents = tuple(
        Descent(
            math.sqrt(2 * end.cost / len(end.fun)),
            {
                n.path: n.value(x)
                for n, x in zip(varied, end.x[free].tolist(), strict=True)
            },
            end.status > 0,
        )
        for end in ends
    )
    units = ranges * [
        n.slope(x) for n, x in zip(varied, best.x[free].tolist(), strict=True)
    ]
    errors = np.sqrt(np.diag(relative)) * units
    fitted = tuple(
        Fitted(n.path, n.unit, descents[0].values[n.path], error, *map(n.value, n.ends))
        for n, error in zip(varied, errors.tolist(), strict=True)
    )
    spread = np.sqrt(np.einsum("ij,jk,ik->i", jacobian, relative, jacobian))
    residuals, spreads = (
        np.split(each, np.cumsum(objective.lengths)[:-1]) for each in (best.fun, spread)
    )
    predicted = tuple(
        m.signal.replace(values=m.signal.values + m.size * r)
        for m, r in zip(records, residuals, strict=True)
    )
    misfits = tuple(math.sqrt(float(np.mean(r**2))) for r in residuals)
    notes = [
        *misfit_notes(records, predicted, misfits),
        *doubts(fitted, relative, descents),
    ]
    return Fit(
        system=objective.system_at(best.x),
        measured=tuple(records),
        fitted=fitted,
        covariance=relative * np.outer(units, units),
        predicted=predicted,
        bands=tuple(m.size * s for m, s in zip(records, spreads, strict=True)),
        misfits=misfits,
        descents=descents,
        notes=tuple(notes),
    )
