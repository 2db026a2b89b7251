"""Errors of an outcome by fronts: rounded transit times, and forces that are too faint.

Waves are exact to round-off. Two approximations are larger, and each states its error.
The clock rounds transit times that have no common measure. And a force that decays for
ever counts as zero from some time on, which shortens durations and moves times.
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

RERUN_EVENT_FACTOR = 4  # cap on events of a run with perturbed transit times
NO_ERRORS: Mapping[str, float] = {}


def effect_of_rounding(finished: FrontRun) -> Mapping[str, float]:
    """Relative error of each of `runs.MEASURES`, by name, that rounded transits make.

    The exact transit time lies between the rounded one and the next tick on its other
    side. A second run uses that tick. The difference between both outcomes is the
    stated error: it exceeds the error of an outcome that varies steadily between both
    ticks. Errors of velocities are relative to the velocity scale, others to the
    largest value of the measure.

    Without a second run there are no errors: where transit times change by no more than
    `ROUNDED`, or the cap ended the run. All are inf where both runs end for different
    reasons.
    """
    if finished.clock.transit_error <= ROUNDED or finished.stopped_by == "max_events":
        return NO_ERRORS
    request = RunRequest(
        until=finished.until,
        max_events=RERUN_EVENT_FACTOR * (finished.run.events + 1),
        perturb_rounding=True,
    )
    other = FrontRun(driver.solve_one(finished.layout, request))
    if other.stopped_by != finished.stopped_by:
        return dict.fromkeys(runs.MEASURES, math.inf)
    errors: dict[str, float] = {}
    other_measures = measures_of(other)
    for name, values in measures_of(finished).items():
        largest_change = float(np.abs(values - other_measures[name]).max(initial=0.0))
        if name == runs.VELOCITY:
            scale = finished.run.velocity_scale
        else:
            scale = float(np.abs(values).max(initial=0.0))
        errors[name] = 0.0
        if largest_change > 0:
            errors[name] = largest_change / scale
    return errors


def measures_of(finished: FrontRun) -> dict[str, Array]:
    """Values of each of `runs.MEASURES` by name, in SI units.

    They are velocities after the run, [body], and impulses, peak forces and force
    durations, [contact]. Times are three of each contact in one array: of its first and
    last force, and of its last opening. One that never came is a tick before 0.
    """
    tick = finished.clock.tick
    tallies = [tally_of(node, tick) for node in finished.contacts]
    times: list[float] = []  # a tick that is NONE is -1
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
    """Sentence that states the largest error by rounded transit times.

    `accuracy` has errors by measure. Without any the sentence is empty. An infinite
    error is one that is not known. The sentence begins with a space.
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
    """Relative errors of an outcome by measure, with those that faint forces make.

    A contact that grazes after a faint force may press until it opens. The longest such
    time, relative to the largest value, is added to the errors of durations and times.
    If a contact grazes so at the end of a run to its proof, it may press for ever: both
    are inf. `errors` are those so far, and stay as they are; without faint forces they
    are returned themselves.
    """
    faint_ticks = 0
    for node in finished.contacts:
        faint_ticks = max(faint_ticks, node.faint_ticks)
        grazes_in_the_end = node.is_faint and finished.until is None
        if grazes_in_the_end:
            return {**errors, runs.DURATION: math.inf, runs.TIME: math.inf}
    if faint_ticks == 0:
        return errors
    measures = measures_of(finished)
    with_faint = dict(errors)
    for name in (runs.DURATION, runs.TIME):
        error = faint_ticks * finished.clock.tick / float(measures[name].max())
        with_faint[name] = error + errors.get(name, 0.0)
    return with_faint
