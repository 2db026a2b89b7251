"""Divide cells and step until the outcome of a run stands still, and tell how wrong it may be."""

import math
from collections.abc import Callable, Sequence
from itertools import takewhile

import numpy as np

from ...model import Fixed, Steps, laws
from ..laws import Law
from ..memory import TooLong
from ..row import Array, Row
from ..run import DURATION, IMPULSE, PEAK_FORCE, VELOCITY
from .measures import largest_force
from .run import GridRun

FACTORS = (1, *(k << n for n in range(60) for k in (2, 3)))
"""By how much the step is divided on each level: not by powers of two only.

An error that depends on where in a step something happens may be the same on all of those.
"""
FEWEST = 4  # levels
LOOK_BACK = 4  # coarser levels with which the finest is compared
DOUBT = 3  # times what changes tell: where they cancel, errors are larger
FAINT = (
    5 / 3
)  # times that for a duration: a faint force may be missed on all levels alike
PART = 0.1  # of a step, to which times are known at best
ROUGH = (PEAK_FORCE, DURATION)  # told, and not waited for: they hang on few steps
GENTLE = laws.Spring | laws.Hertz | laws.HuntCrossley | laws.PowerLaw | laws.Plastic


def refined(
    level: Callable[[int], GridRun],
    measures: Callable[[GridRun], dict[str, Array]],
    order: float,
    goal: float,
    last: int,
) -> tuple[GridRun, dict[str, float]]:
    """Divide the step until no measure is wrong by more than `goal`, or as far as it goes.

    Parameters
    ----------
    level : function
        Run with the step divided by about a factor; raises `TooLong` where there is no room for it.
        One that met a cap on events goes no further.
    measures : function
        What is to be known, of a run; what is `ROUGH` need not come to the goal.
    order : float
        Power of the step with which errors fall at least.
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
    levels: list[tuple[float, dict[str, Array]]] = []
    for factor in takewhile(lambda factor: factor <= max(4, last), FACTORS):
        try:
            finer = level(factor)
        except TooLong:
            if not levels:
                raise
            break
        if levels and finer.stopped_by == "max_events":
            break
        finest = finer
        levels.append((finest.step, measures(finest)))
        estimates = {name: error_of(levels, name, order) for name in levels[-1][1]}
        late = any(
            error > goal for name, error in estimates.items() if name not in ROUGH
        )
        if finest.stopped_by == "max_events" or not late:
            break
    return finest, estimates


def error_of(
    levels: Sequence[tuple[float, dict[str, Array]]], name: str, order: float
) -> float:
    """Estimated error of a measure on the last level, relative to its largest value.

    With q(g) the result of a coarser step g, an error that falls with the power p of the step h is
    |q(g) - q(h)|/((g/h)^p - 1); one of higher order is less. The largest over the last coarser
    levels is the estimate: errors that differ from level to level are not all equal by accident.
    """
    if len(levels) < FEWEST:
        return math.inf
    (h, values), coarser = levels[-1], levels[-1 - LOOK_BACK : -1]
    latest = float(np.abs(values[name]).max(initial=0.0))
    changes = [
        float(np.abs(measured[name] - values[name]).max(initial=0.0))
        / ((g / h) ** order - 1)
        for g, measured in coarser
    ]
    error: float = DOUBT * max(changes)
    if not error < math.inf:  # nan where a measure overflows
        return math.inf
    if name == DURATION:
        within = (
            PART if order > 1 / 2 else 1.0
        )  # of a step: where forces jump, all levels may ring
        error = max(FAINT * error, within * h if latest > 0 else 0.0)
    return error / latest if latest > 0 else error


def order_of(row: Row) -> float:
    """Power of the step with which errors fall at least: 1/2 where waves jump and stay steep.

    Waves are smooth where all rods are damped, and where forces begin from 0 and nothing that is
    given jumps.
    """
    system = row.system
    if all(float(segment.material.viscosity) > 0 for segment in row.segments):
        return 1.0
    given = [
        getattr(x, name, 0.0)
        for x in (*system.bodies, *system.ends)
        for name in ("velocity", "strain", "value")
    ]
    gentle = all(isinstance(law, GENTLE) for law in system.contacts)
    held = any(isinstance(end, Fixed) for end in system.ends)
    return (
        1.0
        if gentle and not held and not any(isinstance(x, Steps) for x in given)
        else 0.5
    )


def measures_of(run: GridRun) -> dict[str, Array]:
    """Velocities of what nothing holds; impulse, peak force and duration by contact that can open.

    Restitution follows from the impulses. Impacts of rigid bodies have neither of the other two:
    their impulse grows in jumps. A joint is never done: of it counts the impulse up to a given end,
    beside the largest so far.
    """
    mesh, row, m, v = run.mesh, run.row, run.mesh.mass, run.grid.velocity
    free = [
        float(m[a : b + 1] @ v[a : b + 1] / m[a : b + 1].sum())
        for a, b in mesh.groups
        if not mesh.held[a : b + 1].any()
    ]
    impulses, peaks, durations = [], [], []
    for k, link in row.by_law.items():
        force, _ = run.contact(k)
        if k in row.opening:
            lasting = row.links[link].law != Law.IMPACT
            begins, ends = run.spans(run.pressed(k))
            impulses.append(force.sum() * run.step)
            peaks.append(lasting * largest_force(force))
            durations.append(lasting * (ends - begins).sum())
        elif run.stopped_by == "until":
            passed = np.cumsum(force * run.step)
            impulses += [*passed[-1:], np.abs(passed).max(initial=0.0)]
    return {
        VELOCITY: np.array(
            [*free, row.scale]
        ),  # so that round-off of bodies at rest is none
        IMPULSE: np.array(impulses),
        PEAK_FORCE: np.array(peaks),
        DURATION: np.array(durations),
    }
