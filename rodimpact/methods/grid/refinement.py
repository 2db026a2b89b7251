"""Refine a mesh until the outcome of a run is settled, and estimate its error."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

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
"""Factors by which the step is divided on each level: not powers of two only.

An error that depends on where in a step something happens may be the same on all of
those.
"""
MIN_LEVELS = 4
"""Levels, from which on an error is estimated."""
MAX_COMPARED = 4
"""Coarser levels with which the finest is compared."""
SAFETY_FACTOR = 3
"""Estimated error over the error that the changes tell, as they may cancel."""
DURATION_FACTOR = 5 / 3
"""Further factor of the error of a duration: all levels may miss a weak force alike."""
TIME_RESOLUTION = 0.1
"""Steps to which times are known at best."""
UNREFINED = (PEAK_FORCE, DURATION)
"""Measures that the mesh is not refined for: they depend on few steps."""


class Level(NamedTuple):
    """Measures of the run on one level."""

    step: float  # s
    measures: dict[str, Array]


def refined(
    run_level: Callable[[int], GridRun],
    measures: Callable[[GridRun], dict[str, Array]],
    order: float,
    rtol: float,
    max_factor: int,
) -> tuple[GridRun, dict[str, float]]:
    """Divide the step until the estimated error of each measure is at most `rtol`.

    It ends earlier if the next factor is too large, if memory is short, or with a run
    that met its cap on events: such a run counts only if it is the first. TooLong is
    raised if memory is short for the first run.

    Parameters
    ----------
    run_level : function
        Run with the step divided by a factor. It raises `TooLong` where it takes too
        much memory.
    measures : function
        Measures of the outcome of a run; those of `UNREFINED` need not come to `rtol`.
    order : float
        Power of the step with which errors fall at least.
    rtol : float
    max_factor : int
        Largest factor; below 4 it counts as 4.

    Returns
    -------
    run : GridRun
        The finest one.
    estimates : dict of str to float
        Error of each measure, relative to its largest value; inf where there are too
        few levels.
    """
    levels: list[Level] = []
    for factor in FACTORS:
        if factor > max(4, max_factor):
            break
        try:
            finer = run_level(factor)
        except TooLong:
            if not levels:  # not even the coarsest run
                raise
            break
        met_cap = finer.stopped_by == "max_events"
        if levels and met_cap:  # it shows less than the coarser run before it
            break
        finest = finer
        levels.append(Level(finest.step, measures(finest)))
        estimates = {}
        is_converged = True
        for name in levels[-1].measures:
            estimates[name] = error_of(levels, name, order)
            if estimates[name] > rtol and name not in UNREFINED:
                is_converged = False
        if met_cap or is_converged:
            break
    return finest, estimates


def error_of(levels: Sequence[Level], name: str, order: float) -> float:
    """Estimated error of a measure on the last level, relative to its largest value.

    With q(g) the result of a coarser step g, an error that falls with the power p =
    `order` of the step h is abs(q(g) - q(h))/((g/h)^p - 1); one of higher order is
    less. The estimate is `SAFETY_FACTOR` times the largest of these over the last
    `MAX_COMPARED` coarser levels: errors that differ from level to level are not all
    equal by accident. That of a duration is larger, and at least a part of a step, or a
    step where forces jump. Where all values are 0 the error is not relative. With fewer
    than `MIN_LEVELS` levels, and where a measure overflows, it is inf.
    """
    if len(levels) < MIN_LEVELS:
        return math.inf
    h = levels[-1].step
    values = levels[-1].measures[name]
    largest = float(np.abs(values).max(initial=0.0))
    errors = []
    for coarser in levels[-1 - MAX_COMPARED : -1]:
        change = float(np.abs(coarser.measures[name] - values).max(initial=0.0))
        errors.append(change / ((coarser.step / h) ** order - 1))
    error: float = SAFETY_FACTOR * max(errors)
    if not error < math.inf:  # nan where a measure overflows
        return math.inf
    if name == DURATION:
        least = 0.0  # error that a duration has at least, s
        if largest > 0 and order > 1 / 2:  # nothing jumps
            least = TIME_RESOLUTION * h
        elif largest > 0:  # forces jump, and waves may oscillate on all levels
            least = h
        error = max(DURATION_FACTOR * error, least)
    if largest > 0:
        return error / largest
    return error


def comparable_runs(
    runs: Sequence[GridRun], finest: GridRun, order: float
) -> list[tuple[float, GridRun]]:
    """Pairs of a share and a run: the last `MAX_COMPARED` runs coarser than the finest.

    The share, times the difference of fields from those of that run, bounds the error
    of the finest. An error that falls with the power p = `order` of the step h is
    1/((g/h)^p - 1) of the difference from a run with step g; the share is
    `SAFETY_FACTOR` times this. `runs` come from coarse to fine. The list is empty if
    there are too few levels, or if states of these runs take too much memory.
    """
    coarser = [run for run in runs if run.step > finest.step]
    compared = coarser[-MAX_COMPARED:]
    if len(compared) + 1 < MIN_LEVELS:  # the finest one is a level, too
        return []
    if sum(run.states_bytes for run in compared) > MAX_STATES_BYTES:
        return []
    pairs = []
    for run in compared:
        share = SAFETY_FACTOR / ((run.step / finest.step) ** order - 1)
        pairs.append((share, run))
    return pairs


def measures_of(run: GridRun) -> dict[str, Array]:
    """Measures of the outcome of a run, by name: arrays in SI units.

    They are velocities, see `velocities_of`, and impulses, peak forces and durations of
    contacts; a name is left out if nothing has such a measure. Impacts of rigid bodies
    have an impulse alone. Bonds and joints count in runs to a given end only, with
    impulses and peak forces. The last impulse and the last peak force are round-off, an
    entry that only sets a scale. Restitution follows from the impulses.
    """
    measures = {VELOCITY: velocities_of(run)}
    impulses: list[float] = []
    peaks: list[float] = []
    durations: list[float] = []
    left = outside_of(run, side=0)  # forces of rigid bonds follow from there
    forces = contact_forces(run, left)
    for k, force in enumerate(forces):
        if k in run.row.unilateral_links:
            impulses.append(float(force.sum()) * run.step)
            # The impulse of an impact jumps: it has no peak force and no duration.
            if run.row.links[run.row.contact_link[k]].law != Law.IMPACT:
                intervals = run.force_intervals(k)
                begins, ends = run.force_spans(intervals)  # of all its forces, s
                peaks.append(largest_force(force))
                durations.append(float((ends - begins).sum()))
        elif run.stopped_by == "until":
            impulses.extend(_impulses_of_bond(force, run.step))
            peaks.append(float(force.max(initial=0.0)))
    # Changes from run to run are compared with the largest entry. If all are round-off,
    # this one keeps their changes from being errors.
    round_off = round_off_of(run) * float(run.mesh.mass.sum())  # N s
    if impulses:
        measures[IMPULSE] = np.array([*impulses, round_off])
    if peaks:
        transit = run.clock.longest_rod * run.clock.tick
        measures[PEAK_FORCE] = np.array([*peaks, round_off / transit])
    if durations:
        measures[DURATION] = np.array(durations)
    return measures


def _impulses_of_bond(force: Array, step: float) -> list[float]:
    """Impulse of a bond or joint in all of a run, N s, and the largest on the way.

    The largest, of absolute values, sets the scale: the whole one may be small beside
    it. A run without steps has the largest only, which is 0.
    """
    impulse = np.cumsum(force) * step  # up to the end of each step
    largest = float(np.abs(impulse).max(initial=0.0))
    return [*impulse[-1:], largest]


def round_off_of(run: GridRun) -> float:
    """Return the velocity that may be round-off, m/s."""
    return ROUND_OFF * (abs(float(run.row.frame)) + float(run.row.scale))


def velocities_of(run: GridRun) -> Array:
    """Scale of velocities, and after it velocities at the end of a run, m/s.

    Errors are relative to the largest entry, so to the scale at least. The velocities,
    in the frame, are the means of groups of joined bodies none of which is driven:
    these last after the last contact. In a run to a given end those of each rod and of
    each rigid mass follow, which oscillate in their groups.
    """
    mesh = run.mesh
    v = run.grid.velocity
    velocities = [max(float(run.row.scale), round_off_of(run))]
    for first, last in mesh.groups:
        nodes = slice(first, last + 1)
        if not mesh.is_prescribed[nodes].any():
            mass = mesh.mass[nodes]
            velocities.append(float(mass @ v[nodes] / mass.sum()))
    if run.stopped_by == "until":
        for start, stop in run.row.spans:
            if stop > 0:  # a rod, with the segments from `start` to `stop`
                first = mesh.first[start]
                last = mesh.last[stop]
                # Half of the mass of a cell sits at its left node, half at its right.
                half_mass = mesh.cell_mass[first + 1 : last + 1] / 2
                v_left = v[first:last]
                v_right = v[first + 1 : last + 1]
                momentum = half_mass @ v_left + half_mass @ v_right
                velocities.append(float(momentum / (2 * half_mass.sum())))
        velocities.extend(v[mesh.node_of_mass])
    return np.array(velocities)
