"""Errors of an outcome by fronts: rounded transit times, and forces that are too faint.

Waves are exact to round-off. Two approximations are coarser, and the error of each is
stated. The clock rounds transit times that have no common measure. And a force that
never stops decaying counts as zero from some time on, which shortens durations and
moves times.
"""

import math
from collections.abc import Mapping

import numpy as np

from .. import run as runs
from ..row import Array
from ..status import ROUNDED
from . import driver
from .batch import RunRequest
from .run import FrontRun
from .totals import tally_of, totals_of

RERUN_EVENT_FACTOR = 4  # cap on events of the second run, over those of the first
NO_ERRORS: Mapping[str, float] = {}


def effect_of_rounding(finished: FrontRun) -> Mapping[str, float]:
    """Relative error of each of `runs.MEASURES`, by name, from rounded transit times.

    The exact transit time lies between the rounded one and the next tick on its other
    side. A second run uses that tick. The difference between both outcomes is the
    stated error: it exceeds the error of an outcome that varies monotonically between
    both ticks. Errors of velocities are relative to the velocity scale, others to the
    largest absolute value of the measure.

    `NO_ERRORS`, an empty mapping, is returned without a second run if the relative
    change of transit times by rounding is at most `ROUNDED`, or if the cap on events
    ended the run. All errors are inf if both runs end for different reasons. The second
    run raises TooLong if it takes too much memory.
    """
    if finished.clock.transit_error <= ROUNDED or finished.stopped_by == "max_events":
        return NO_ERRORS
    # The second run may take more events, and needs a cap above 0.
    request = RunRequest(
        until=finished.until,
        max_events=RERUN_EVENT_FACTOR * (finished.run.events + 1),
        perturb_rounding=True,
    )
    second_run = FrontRun(driver.solve_one(finished.layout, request))
    if second_run.stopped_by != finished.stopped_by:
        return dict.fromkeys(runs.MEASURES, math.inf)
    errors: dict[str, float] = {}
    second_measures = measures_of(second_run)
    for name, values in measures_of(finished).items():
        changes = np.abs(values - second_measures[name])
        # A row without contacts has no values; then `initial` is the maximum.
        largest_change = float(changes.max(initial=0.0))
        if name == runs.VELOCITY:
            scale = finished.run.velocity_scale
        else:
            scale = float(np.abs(values).max(initial=0.0))
        errors[name] = 0.0
        if largest_change > 0:  # otherwise the scale may be 0
            errors[name] = largest_change / scale
    return errors


def measures_of(finished: FrontRun) -> dict[str, Array]:
    """Values of each of `runs.MEASURES` by name, in SI units.

    They are the velocities after the run, [body], and impulses, peak forces and force
    durations, [contact]. The times are a single array, [3 * contact], of the first
    force, the last force and the last opening of each contact. A time that does not
    exist is minus the duration of a tick, since NONE is -1.
    """
    tick = finished.clock.tick
    tallies = [tally_of(node, tick) for node in finished.contacts]
    times: list[float] = []
    for node in finished.contacts:
        times.append(node.first_force_tick * tick)
        times.append(node.last_force_tick * tick)
        times.append(node.last_opening_tick * tick)
    return {
        runs.VELOCITY: np.array(totals_of(finished).after.velocities),
        runs.IMPULSE: np.array([tally.impulse for tally in tallies]),
        runs.PEAK_FORCE: np.array([tally.peak_force for tally in tallies]),
        runs.DURATION: np.array([tally.duration for tally in tallies]),
        runs.TIME: np.array(times),
    }


def accuracy_sentence(accuracy: Mapping[str, float]) -> str:
    """Sentence that states the largest error due to rounded transit times.

    `accuracy` has relative errors by measure. If it is empty, so is the sentence. If an
    error is infinite, the sentence says that the error is not known. The sentence
    begins with a space.
    """
    if not accuracy:
        return ""
    largest = max(accuracy.values())
    if largest == math.inf:
        return " The error that this makes is not known."
    return f" Stated relative error: {largest:.1g}."


def with_faint_forces(
    finished: FrontRun, errors: Mapping[str, float]
) -> Mapping[str, float]:
    """Relative errors of an outcome by measure, including those from faint forces.

    A contact that grazes after a faint force may in fact press until it opens. The
    longest time of such grazing, over the largest duration or time, is added to the
    errors of durations and times. Both are inf if a contact still grazes so at the end
    of a run without a given end, as it may press for ever. `errors` are the errors so
    far; they are not changed, and are returned themselves if no contact grazes so.
    """
    faint_ticks = 0
    for node in finished.contacts:
        faint_ticks = max(faint_ticks, node.faint_ticks)
        may_press_for_ever = node.is_faint and finished.until is None
        if may_press_for_ever:
            return {**errors, runs.DURATION: math.inf, runs.TIME: math.inf}
    if faint_ticks == 0:
        return errors
    measures = measures_of(finished)
    with_faint = dict(errors)
    for name in (runs.DURATION, runs.TIME):
        error = faint_ticks * finished.clock.tick / float(measures[name].max())
        with_faint[name] = error + errors.get(name, 0.0)
    return with_faint
