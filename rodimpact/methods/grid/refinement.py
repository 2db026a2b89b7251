"""Divide cells and step until the outcome of a run stands still, and tell how wrong it may be."""

import math
from collections.abc import Callable, Sequence
from itertools import takewhile

import numpy as np

from ..link import Law
from ..memory import TooLong
from ..row import Array
from ..run import DURATION, IMPULSE, PEAK_FORCE, VELOCITY
from ..signals import ROUND_OFF
from .forces import contact_forces, outside_of
from .measures import largest_force
from .run import MAX_STATES_BYTES, GridRun

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


def comparable_runs(
    runs: Sequence[GridRun], finest: GridRun, order: float
) -> list[tuple[float, GridRun]]:
    """The last coarser runs, with the share of differences of fields that bounds the error.

    None where there are too few, or where they would take too much memory.
    """
    coarser = [run for run in runs if run.step > finest.step][-LOOK_BACK:]
    if len(coarser) + 1 < FEWEST:
        return []
    if sum(run.states_bytes for run in coarser) > MAX_STATES_BYTES:
        return []
    return [(DOUBT / ((run.step / finest.step) ** order - 1), run) for run in coarser]


def measures_of(run: GridRun) -> dict[str, Array]:
    """What the outcome of a run consists of: velocities, impulses, peak forces and durations.

    Restitution follows from the impulses. Only what the row has is among the measures.
    """
    measures = {VELOCITY: velocities_of(run)}
    impulses: list[float] = []
    peaks: list[float] = []
    durations: list[float] = []
    forces = contact_forces(run, outside_of(run, 0))
    for k, force in enumerate(forces):
        if k in run.row.opening:
            impulses.append(float(force.sum()) * run.step)
            # Impacts of rigid bodies have no peak force and no duration: their impulse jumps.
            if run.row.links[run.row.contact_link[k]].law != Law.IMPACT:
                begins, ends = run.spans(run.pressed(k))
                peaks.append(largest_force(force))
                durations.append(float((ends - begins).sum()))
        elif run.stopped_by == "until":
            # A bond or joint is never done: its impulse counts up to the given end, and
            # so does the largest one on the way, beside which that may be small.
            passed = np.cumsum(force) * run.step
            impulses.extend(passed[-1:])
            impulses.append(float(np.abs(passed).max(initial=0.0)))
            peaks.append(float(force.max(initial=0.0)))
    # Beside these, what differs by round-off alone is the same.
    round_off = round_off_of(run) * float(run.mesh.mass.sum())
    if impulses:
        measures[IMPULSE] = np.array([*impulses, round_off])
    if peaks:
        transit = run.clock.longest * run.clock.tick
        measures[PEAK_FORCE] = np.array([*peaks, round_off / transit])
    if durations:
        measures[DURATION] = np.array(durations)
    return measures


def round_off_of(run: GridRun) -> float:
    """Velocities of this size or less may be round-off, m/s."""
    return ROUND_OFF * (abs(float(run.row.frame)) + float(run.row.scale))


def velocities_of(run: GridRun) -> Array:
    """Velocities at the end of a run, and their scale, so that round-off at rest is none.

    Groups of bodies that hang together and are not held keep theirs after the last contact. The
    bodies of a group swing on, so that each body has a velocity of its own at a given end only.
    """
    mesh = run.mesh
    v = run.grid.velocity
    velocities = [max(float(run.row.scale), round_off_of(run))]
    for first, last in mesh.groups:
        nodes = slice(first, last + 1)
        if not mesh.held[nodes].any():
            velocities.append(
                float(mesh.mass[nodes] @ v[nodes] / mesh.mass[nodes].sum())
            )
    if run.stopped_by == "until":
        for start, stop in run.row.spans:
            if stop > 0:
                first = mesh.first[start]
                last = mesh.last[stop]
                halves = mesh.cell_mass[first + 1 : last + 1] / 2
                momentum = halves @ v[first:last] + halves @ v[first + 1 : last + 1]
                velocities.append(float(momentum / (2 * halves.sum())))
        velocities.extend(v[mesh.node_of_mass])
    return np.array(velocities)
