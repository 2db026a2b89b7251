"""Error of a run: from a second run at a coarser tolerance, and from what both runs share.

The page has this as JavaScript.
"""

from typing import Any, NamedTuple

import numpy as np

from ..link import Law
from .records import Part

COARSER = 5.0  # tolerance of the run that the first is compared with, over its own
COARSER_FLOOR = 2  # its floor over that of the first, where breaks come too densely
COARSEST = 1e-2  # largest tolerance of a second run
RUN_ROUND_OFF = 1e-14  # relative error that a run has at any tolerance
DIFFERENCE_FACTOR = 3.0  # stated error over the difference of two runs
TIME_FACTOR = 2.0  # further factor for times, which may depend on faint forces
LEAST_SHARE = 0.1  # error of every measure, over the worst difference, at least
LEAST_SHARE_OF_TIMES = 0.05  # the same for times
SHARED_FACTOR = (
    2.0  # stated error over the estimate for steps that both runs took alike
)
SHARED_TIME_FACTOR = 2.2  # the same for times, which may depend on faint forces
LOOSE_FACTOR = 2e7  # error over tail^2.5: errors of loose tolerances do not fall evenly
LOOSE_POWER = 2.5  # exponent of that tail
FIT_FACTOR = 4.0  # stated error over the miss of a given function by its pieces
SHOWN = 3  # number of measures that are not times: their errors fall evenly
PEAK_FORCE = 2  # place of the peak force among the measures


class Ended(NamedTuple):
    """Records of a run that has come to its end: that of the run, and lists of the others."""

    run: Any
    link: Any
    part: Any


def compare(fine: Any, coarse: Any) -> None:
    """Let runs at a coarser tolerance end as finer ones did, and on other floors.

    Parameters
    ----------
    fine, coarse : RUN
        Of all members.
    """
    coarse.ticks_after_proof = fine.ticks_after_proof
    coarse.min_break_spacing = np.where(
        fine.averaged_steps > 0,
        COARSER_FLOOR * coarse.min_break_spacing,
        coarse.min_break_spacing,
    )


def left_open(fine: Ended, fit: float) -> list[float]:
    """Relative error of each of the `MEASURES` that a second run does not show.

    With large tails, errors are not small enough to fall evenly from run to run. A peak force is
    one value of a polynomial: two runs may miss it alike, by about `peak_error`.
    """
    run = fine.run
    loose = (
        LOOSE_FACTOR * (run.max_truncation_error / run.velocity_scale) ** LOOSE_POWER
    )
    common = RUN_ROUND_OFF + loose + FIT_FACTOR * fit
    errors = [common, common, common, common, common]
    if all(part.kind != Part.SEGMENT for part in fine.part):
        add_faint_times(fine, errors)
    peak = size_of([link.peak_force for link in fine.link])
    if peak > 0:
        peak_error = size_of([link.peak_force_error for link in fine.link])
        errors[PEAK_FORCE] += peak_error / peak
    return errors


def add_faint_times(fine: Ended, errors: list[float]) -> None:
    """Add the error of durations and times of a row without rods, where a flight may be long.

    A contact does not press while its overlap is less than the length that `graze` makes in the
    reference time of the run, at its beginning and at its end.
    """
    run = fine.run
    episodes = max([1, *[link.episodes for link in fine.link]])
    faint = (
        2
        * run.graze_velocity
        / run.velocity_scale
        * run.shortest_transit
        * run.tick_duration
        * episodes
    )
    values = measures_of(fine)
    for i in range(SHOWN, len(errors)):
        longest = size_of(values[i])
        if longest > 0:
            errors[i] += faint / longest


def measures_of(ended: Ended) -> list[list[float]]:
    """Values of a run that the `MEASURES` compare, measure by measure."""
    run = ended.run
    impulses = []
    peaks = []
    durations = []
    times = []
    for link in ended.link:
        if link.law >= Law.JOINT:
            impulses.append(link.impulse)
            peaks.append(link.peak_force)
            durations.append(link.force_ticks * run.tick_duration)
            times.append(link.first_force_tick * run.tick_duration)
            times.append(link.last_force_tick * run.tick_duration)
            times.append(link.last_opening_tick * run.tick_duration)
    velocities = []
    for part in ended.part:
        if (
            run.has_bonds
        ):  # after the proof, whenever it came, the other groups go on evenly
            velocities.append(part.mean_velocity)
        elif part.part_count > 0:
            velocities.append(part.group_velocity)
    return [velocities, impulses, peaks, durations, times]


def differences(fine: Ended, coarse: Ended) -> list[float]:
    """Difference of two runs in each of the `MEASURES`, over its largest value."""
    relative = []
    coarse_values = measures_of(coarse)
    for i, values in enumerate(measures_of(fine)):
        scale = size_of(values)
        if i == 0 and scale > 0:
            scale = fine.run.velocity_scale
        pairs = zip(values, coarse_values[i], strict=True)
        largest = size_of([a - b for a, b in pairs])
        if scale > 0:
            relative.append(largest / scale)
        else:
            relative.append(0.0)
    return relative


def stated(fine: Ended, apart: list[float]) -> list[float]:
    """Error of each of the `MEASURES`, from the differences of two runs.

    Errors fall by five or more from one run to the other. Where two numbers agree by chance, others
    do not: none is said to be much better known than the worst. Both runs take the same steps where
    these are as long as breaks allow, and share their errors:
    `run.shared_error` estimates the largest.
    """
    estimate = fine.run.shared_error / fine.run.velocity_scale
    worst = max(apart[0], apart[1], apart[2])
    errors = []
    for i, values in enumerate(measures_of(fine)):
        share = LEAST_SHARE
        factor = DIFFERENCE_FACTOR
        shared = SHARED_FACTOR * estimate
        if i >= SHOWN:
            share = LEAST_SHARE_OF_TIMES
            factor *= TIME_FACTOR
            shared = SHARED_TIME_FACTOR * estimate
        error = 0.0
        if size_of(values) > 0:
            error = max(factor * max(apart[i], share * worst), shared)
        errors.append(error)
    return errors


def size_of(values: list[float]) -> float:
    """Largest absolute value."""
    return max([0.0, *[abs(value) for value in values]])
