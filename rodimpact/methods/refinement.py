"""Divide a step until the outcome of a run stands still, and tell how wrong it may be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import count
from typing import Any, TypeVar

import numpy as np

from . import kernels
from .contact_law_kernel import IMPACT
from .measure_kernel import largest_force, time_of_most
from .memory import TooLong
from .refinement_kernel import error_of, factor_of
from .row import Array
from .stepped_run import SteppedRun

STEP_TIME = 2e-7  # s, about what a measure takes for a step in plain Python
MEASURES = ("impulse", "largest force", "time of 99.9 % of the impulse")
DOUBT = 2  # times what changes tell: where they cancel, errors are larger
PART = 0.1  # of a step, to which times are known at best
R = TypeVar("R", bound=SteppedRun)


def refined(
    level: Callable[[int], R], measures: Callable[[R], dict[str, Array]], goal: float, last: int,
) -> tuple[R, dict[str, float]]:
    """Divide the step until no measure is wrong by more than `goal`, or as far as it goes.

    Parameters
    ----------
    level : function
        Run with the step divided by about a factor; raises `TooLong` where there is no room for it.
        One that met a cap on events goes no further.
    measures : function
        What is to stand still, of a run.
    goal : float
    last : int
        Largest factor, 4 at least.

    Returns
    -------
    run
        The finest.
    estimates : dict of str to float
        Error of each measure, relative to its largest value; inf where there are too few levels.
    """
    finest: R | None = None
    levels: list[tuple[float, dict[str, Array]]] = []
    estimates: dict[str, float] = {}
    for factor in map(factor_of, count()):
        if factor > max(4, last):
            break
        try:
            finer = level(factor)
        except TooLong:
            if finest is None:
                raise
            break
        if finest is not None and finer.stopped_by == "max_events":
            break
        finest, values = finer, measures(finer)
        levels.append((finest.step, values))
        estimates = {name: _error(levels, name) for name in values}
        if finest.stopped_by == "max_events" or max(estimates.values()) <= goal:
            break
    assert finest is not None
    return finest, estimates


def _error(levels: list[tuple[float, dict[str, Array]]], name: str) -> float:
    """Estimated error of a measure on the last level."""
    values = [x for _, measured in levels for x in measured[name].tolist()]
    width, steps = len(values) // len(levels), [step for step, _ in levels]
    error = DOUBT * error_of(values, width, steps, len(levels), 0, width, False, 0.0)
    latest = max(values[-width:], default=0.0)
    if name == MEASURES[2] and latest > 0:
        error = max(error, PART * steps[-1] / latest)
    return error


def velocity_measure(free: Sequence[float], scale: float) -> Array:
    """Velocities of free bodies, and of each of them seen from the next, beside their scale.

    The error of restitution may be twice that of velocities. Beside the scale, the round-off of
    bodies at rest is none.
    """
    return np.array([*free, *np.diff(free), scale])


def contact_measures(run: SteppedRun) -> dict[str, Array]:
    """Impulse, largest force, and time of 99.9 % of the impulse, by contact that can open.

    Restitution follows from the impulses. Impacts of rigid bodies have neither of the other two:
    their impulse grows in jumps. A joint is never done: of it counts the impulse up to a given end,
    beside the largest so far.
    """
    laws = [run.row.laws[link] for link in run.row.opening.values()]
    forces = [run.contact(k)[0] for k in run.row.opening]
    lasting = [(law != IMPACT) * F for law, F in zip(laws, forces, strict=True)]
    joined: list[float] = []
    for k in run.row.by_law if run.stopped_by == "until" else ():
        if k not in run.row.opening:
            passed = np.cumsum(run.contact(k)[0] * run.durations)
            joined += [*passed[-1:], np.abs(passed).max(initial=0.0)]
    measured = (
        [*joined, *(float(F @ run.durations) for F in forces)],
        *([_measured(of, run, F) for F in lasting] for of in (largest_force, time_of_most)),
    )
    return {name: np.array(values) for name, values in zip(MEASURES, measured, strict=True)}


def _measured(measure: Callable[..., float], run: SteppedRun, force: Array) -> float:
    """What a kernel measures of the mean forces in the steps of a run."""
    times: Any = run.edges * run.clock.tick
    if kernels.worth_compiling(run.steps * STEP_TIME, largest_force, time_of_most):
        return float(kernels.compiled(measure)(times, force, 0, run.steps))
    return measure(times.tolist(), force.tolist(), 0, run.steps)
