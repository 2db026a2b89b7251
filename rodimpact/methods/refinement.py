"""Divide a step until the outcome of a run stands still, and tell how wrong it may be."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

import numpy as np

from .contact_law_kernel import IMPACT
from .memory import TooLong
from .row import Array
from .stepped_run import SteppedRun

MEASURES = ("impulse", "largest force", "time of 99.9 % of the impulse")
LOOK_BACK = 3  # coarser levels with which the finest is compared
FEWEST = 4  # levels
R = TypeVar("R", bound=SteppedRun)


def factors() -> Iterator[int]:
    """By how much the step is divided from level to level: 1, 2, 3, 4, 6, 8, 12, 16, 24, ...

    Not by powers of two only: an error that depends on where in a step something happens may be the
    same on all of those.
    """
    yield 1
    power = 2
    while True:
        yield power
        yield 3 * power // 2
        power *= 2


def refined(
    level: Callable[[int], R], measures: Callable[[R], dict[str, Array]], goal: float, last: int,
    known: Callable[[R], dict[str, float]] = lambda _: {},
) -> tuple[R, dict[str, float]]:
    """Divide the step until no measure is wrong by more than `goal`, or as far as it goes.

    An error that falls in proportion to the step h is |q(g) - q(h)| h/(g - h), q(g) the result of a
    coarser step g; one of higher order is less. The largest over the last coarser levels is the
    estimate: errors that differ from level to level are not all equal by accident.

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
    known : function, optional
        Errors of a run that need no other one to be known.

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
    for factor in factors():
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
        estimates = {**{name: _error(levels, name) for name in values}, **known(finest)}
        if finest.stopped_by == "max_events" or max(estimates.values()) <= goal:
            break
    assert finest is not None
    return finest, estimates


def _error(levels: list[tuple[float, dict[str, Array]]], name: str) -> float:
    """Estimated error of a measure on the last level."""
    if len(levels) < FEWEST:
        return math.inf
    step, values = levels[-1][0], levels[-1][1][name]
    scale = float(np.max(np.abs(values), initial=0.0)) or 1.0
    return max(
        float(np.max(np.abs(coarse[name] - values), initial=0.0)) / scale * step / (wider - step)
        for wider, coarse in levels[-1 - LOOK_BACK : -1]
    )


def velocity_measure(free: Sequence[float], scale: float) -> Array:
    """Velocities of free bodies, and of each of them seen from the next, beside their scale.

    The error of restitution may be twice that of velocities. Beside the scale, the round-off of
    bodies at rest is none.
    """
    return np.array([*free, *np.diff(free), scale])


def contact_measures(run: SteppedRun) -> dict[str, Array]:
    """Impulse, largest force, and time of 99.9 % of the impulse, by contact that can open.

    Restitution follows from the impulses. Impacts of rigid bodies have neither of the other two:
    their impulse grows in jumps.
    """
    laws = [run.row.laws[link] for link in run.row.opening.values()]
    forces = [run.contact(k)[0] for k in run.row.opening]
    lasting = [(law != IMPACT) * F for law, F in zip(laws, forces, strict=True)]
    measured = (
        [float(F @ run.durations) for F in forces],
        [peak(run.edges, F) for F in lasting],
        [_most_of(F, run.durations) for F in lasting],
    )
    return {name: np.array(values) for name, values in zip(MEASURES, measured, strict=True)}


def _most_of(force: Array, durations: Array) -> float:
    """Time in which 99.9 % of the impulse has passed, s."""
    passed = np.cumsum(force * durations)
    if not len(passed) or passed[-1] <= 0:
        return 0.0
    goal = 0.999 * passed[-1]
    j = int(np.searchsorted(passed, goal))
    before = passed[j - 1] if j else 0.0
    times = np.cumsum(durations)
    return float(times[j] - durations[j] * (1 - (goal - before) / (passed[j] - before)))


def peak(edges: Array, force: Array) -> float:
    """Largest force behind averages between edges.

    That of the parabola with the averages of three steps: at a smooth top its largest value, behind
    a jump the one at the jump.
    """
    if not len(force) or force.max() <= 0:
        return 0.0
    G = np.concatenate(([0.0, 0.0], force, [0.0, 0.0]))
    width = np.pad(np.diff(edges) / np.diff(edges).max(), 2, mode="edge")
    j = int(np.argmax(G))
    before, after = float(G[j] - G[j - 1]), float(G[j] - G[j + 1])
    if before > 4 * after:
        return _at_jump(G[j : j + 3], width[j : j + 3])
    if after > 4 * before:
        return _at_jump(G[j - 2 : j + 1][::-1], width[j - 2 : j + 1][::-1])
    if before + after <= 0:
        return float(G[j])
    value, slope, curve = _parabola(G[j - 1 : j + 2], width[j - 1 : j + 2])
    return value - slope * slope / (4 * curve) if curve < 0 else float(G[j])


def _at_jump(means: Array, width: Array) -> float:
    """Force just behind a jump, from the averages of three steps behind it, the next one first."""
    rate, next_rate = -np.diff(means) / (width[1:] + width[:-1])
    return _parabola(means, width)[0] if abs(rate - next_rate) < rate else float(means[0])


def _parabola(means: Array, width: Array) -> tuple[float, float, float]:
    """Coefficients of the parabola with averages over three steps, from where the first begins."""
    ends = np.concatenate(([0.0], np.cumsum(width)))
    passed = np.concatenate(([0.0], np.cumsum(means * width)))
    _, value, slope, curve = np.linalg.solve(np.vander(ends, increasing=True), passed).tolist()
    return value, 2 * slope, 3 * curve
