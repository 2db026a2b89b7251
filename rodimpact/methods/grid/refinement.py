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
from .smoothness import JUMP_ORDER

FACTORS = (1, *(k << n for n in range(60) for k in (2, 3)))
"""Factors by which the step is divided, by level: 1, 2, 3, 4, 6, 8, 12, ...

Powers of 2 alone would not do: an error that depends on where in a step an event lies
may be the same at all of them.
"""
MIN_LEVELS = 4
"""Fewest levels for an estimate of the error."""
MAX_COMPARED = 4
"""Largest number of coarser levels with which the finest level is compared."""
SAFETY_FACTOR = 3
"""Estimated error over the error that follows from changes, as these may cancel."""
DURATION_FACTOR = 5 / 3
"""Further factor of the error of a duration: all levels may miss a weak force alike."""
TIME_RESOLUTION = 0.1
"""Smallest error of a time, in steps, if no wave jumps."""
UNREFINED = (PEAK_FORCE, DURATION)
"""Measures for which the mesh is not refined: they depend on few steps."""


class Level(NamedTuple):
    """Results of the run on one level: a mesh with a certain factor of the step."""

    step: float  # s
    measures: dict[str, Array]  # those of `measures_of`, by name


def refined(
    run_level: Callable[[int], GridRun],
    measures: Callable[[GridRun], dict[str, Array]],
    order: float,
    rtol: float,
    max_factor: int,
) -> tuple[GridRun, dict[str, float]]:
    """Divide the step until the estimated error of each measure is at most `rtol`.

    The refinement ends earlier if the next factor is too large, if memory is short, or
    if a run ends at its cap on events: such a run is used only if it is the first.
    TooLong is raised if memory is short for the first run.

    Parameters
    ----------
    run_level : function
        Run with the step divided by a factor. It raises `TooLong` if it would take too
        much memory.
    measures : function
        Measures of the outcome of a run, by name. Errors of `UNREFINED` measures may be
        larger than `rtol`.
    order : float
        Power of the step with which errors fall at least.
    rtol : float
        Largest relative error.
    max_factor : int
        Largest factor; below 4 it counts as 4, which makes `MIN_LEVELS` levels.

    Returns
    -------
    run : GridRun
        The finest run that is used.
    estimates : dict of str to float
        Error of each measure, relative to its largest value; inf if there are too few
        levels.
    """
    levels: list[Level] = []
    last_factor = max(4, max_factor)
    for factor in FACTORS:
        if factor > last_factor:
            break
        try:
            finer = run_level(factor)
        except TooLong:
            if not levels:  # not even the coarsest run
                raise
            break
        met_cap = finer.stopped_by == "max_events"
        if levels and met_cap:  # it ends earlier than the coarser run before it
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

    With q(h) the result for the step h of the last level and q(g) that for a coarser
    step g, an error that falls with the power p = `order` of the step is
    abs(q(g) - q(h))/((g/h)^p - 1); an error of higher order is smaller. The estimate is
    `SAFETY_FACTOR` times the largest of these numbers for the last `MAX_COMPARED`
    coarser levels: with several levels a small change by accident does no harm. For a
    duration it is `DURATION_FACTOR` times larger, and at least `TIME_RESOLUTION` steps,
    or a whole step if waves jump (`order` is `JUMP_ORDER`). If all values are 0, the
    error is absolute. With fewer than `MIN_LEVELS` levels, or if a measure overflows,
    it is inf.
    """
    if len(levels) < MIN_LEVELS:
        return math.inf
    h = levels[-1].step
    values = levels[-1].measures[name]
    largest = float(np.abs(values).max(initial=0.0))
    errors = []
    for coarser in levels[-1 - MAX_COMPARED : -1]:  # those before the last level
        change = float(np.abs(coarser.measures[name] - values).max(initial=0.0))
        errors.append(change / ((coarser.step / h) ** order - 1))
    error: float = SAFETY_FACTOR * max(errors)
    if not error < math.inf:  # it is also nan if a measure overflows
        return math.inf
    if name == DURATION:
        least = 0.0  # smallest error of a duration, s
        if largest > 0 and order > JUMP_ORDER:
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
    """The last `MAX_COMPARED` runs coarser than the finest, as pairs (share, run).

    The error of a field of the finest run is bounded by `share` times its difference
    from the same field of the coarser run. If errors fall with the power p = `order` of
    the step, the error with step h is 1/((g/h)^p - 1) times the difference from a run
    with step g; `share` is `SAFETY_FACTOR` times this number. `runs` are ordered from
    coarse to fine. The list is empty if there are too few levels, or if the states of
    these runs take too much memory.
    """
    coarser = [run for run in runs if run.step > finest.step]
    compared = coarser[-MAX_COMPARED:]
    levels = len(compared) + 1  # with that of the finest run
    if levels < MIN_LEVELS:
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

    The measures are velocities, see `velocities_of`, and impulses, peak forces and
    durations of contacts; a name is left out if the row has no such measure. Impacts of
    rigid bodies have only an impulse. Bonds and joints have impulses and peak forces,
    and only in runs to a given end. The last impulse and the last peak force belong to
    no contact: they are the round-off, which sets the smallest scale. Restitution needs
    no entry, as it follows from the impulses.
    """
    measures = {VELOCITY: velocities_of(run)}
    impulses: list[float] = []
    peaks: list[float] = []
    durations: list[float] = []
    left = outside_of(run, side=0)  # forces in bonds of rigid bodies follow from it
    forces = contact_forces(run, left)
    for k, force in enumerate(forces):
        if k in run.row.unilateral_links:
            impulses.append(float(force.sum()) * run.step)
            # The impulse of an impact jumps: it has no peak force and no duration.
            if run.row.links[run.row.contact_link[k]].law != Law.IMPACT:
                intervals = run.force_intervals(k)
                begins, ends = run.force_spans(intervals)  # of each force, s
                peaks.append(largest_force(force))
                durations.append(float((ends - begins).sum()))
        elif run.stopped_by == "until":
            impulses.extend(_impulses_of_bond(force, run.step))
            peaks.append(float(force.max(initial=0.0)))
    # Changes from run to run are divided by the largest entry. If all impulses are
    # round-off, this entry keeps their changes from counting as errors.
    round_off = round_off_of(run) * float(run.mesh.mass.sum())  # of impulses, N s
    if impulses:
        measures[IMPULSE] = np.array([*impulses, round_off])
    if peaks:
        transit = run.clock.longest_rod * run.clock.tick  # of the longest rod, s
        force_round_off = round_off / transit  # N
        measures[PEAK_FORCE] = np.array([*peaks, force_round_off])
    if durations:
        measures[DURATION] = np.array(durations)
    return measures


def _impulses_of_bond(force: Array, step: float) -> list[float]:
    """Impulse of a bond or joint in the whole run, and the largest one up to any step.

    Both are in N s. The largest one, of absolute values, sets the scale, as the impulse
    in the whole run may be much smaller. `force` [step] is in N, `step` in s. For a run
    without steps only the largest one is returned, which is 0.
    """
    impulse = np.cumsum(force) * step  # up to the end of each step
    largest = float(np.abs(impulse).max(initial=0.0))
    return [*impulse[-1:], largest]  # a slice, as there may be no step


def round_off_of(run: GridRun) -> float:
    """Return the velocity that may be round-off, m/s."""
    return ROUND_OFF * (abs(float(run.row.frame)) + float(run.row.scale))


def velocities_of(run: GridRun) -> Array:
    """Scale of velocities and, after it, velocities at the end of a run, m/s.

    Errors are relative to the largest entry, that is at least to the scale. Velocities
    are those in the frame. First come the mean velocities of groups of joined bodies
    without a driven end: they stay constant after the last contact. In a run to a given
    end the mean velocity of each rod and the velocity of each rigid mass follow; these
    oscillate within their groups.
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
            if stop > 0:  # a rod with the segments from `start` to `stop`
                first = mesh.first[start]
                last = mesh.last[stop]
                # Half of the mass of a cell is at its left node, half at its right.
                # Cell i is on the left of node i.
                half_mass = mesh.cell_mass[first + 1 : last + 1] / 2
                v_left = v[first:last]
                v_right = v[first + 1 : last + 1]
                momentum = half_mass @ v_left + half_mass @ v_right
                velocities.append(float(momentum / (2 * half_mass.sum())))
        velocities.extend(v[mesh.node_of_mass])
    return np.array(velocities)
