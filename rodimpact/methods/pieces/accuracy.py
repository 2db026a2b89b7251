"""Stated error of a run.

The run, "fine" here, is compared with a second run, "coarse". The second run has a
coarser tolerance, and halves the pieces that the tolerance does not limit, so that both
runs have no piece in common, except by chance. Errors that both runs share are added.
The web page has these functions as JavaScript.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from ..link import Law
from ..states import Stop
from .records import PartKind

COARSER = 3.0
"""Tolerance of the second run over that of the first.

Errors of both runs then differ by a factor of about three. With a larger factor the
difference of the runs would be much larger than the error of the first one; with a
smaller factor both runs would agree by chance too often.
"""
COARSER_SPACING = 2
"""`min_break_spacing` of the second run over that of the first."""
ROUND_OFF = 2.2e-16
"""Relative round-off of a number.

The round-offs of n steps have both signs: their sum is about sqrt(n) times as large.
"""
ROUND_OFFS_OF_STEP = 8
"""Round-off of the sums in one step, over that of a number."""
DIFFERENCE_FACTOR = 5.0
"""Stated error over the difference of the two runs."""
LEAST_SHARE = 0.1
"""Least error of each measure over the worst difference: some agree by chance."""
SHARED_FACTOR = 0.2
"""Stated error over `shared_error`, the estimate for pieces that breaks limit.

The estimate is for a series; collocation integrates more precisely.
"""
PEAK_FACTOR = 2.0
"""Stated error of peak forces over the difference of their bounds from them."""
EVENT_FACTOR = 1.0
"""Stated error of times over the largest `event_error`."""
LOOSE_FACTOR = 2e7
"""Error over t^LOOSE_POWER, with the largest truncation error t over velocity scale.

Errors at loose tolerances do not fall evenly with the tolerance.
"""
LOOSE_POWER = 2.5
"""Exponent of this truncation error."""
FIT_FACTOR = 4.0
"""Stated error over the difference of given functions from their pieces."""
UNTIMED_COUNT = 3
"""Number of measures that are not times: velocity, impulse and peak force.

They come first, and their errors fall evenly.
"""
# Index of each measure in `MEASURES`
VELOCITY = 0
"""Velocities."""
IMPULSE = 1
"""Impulses of contacts and joints."""
PEAK_FORCE = 2
"""Peak forces of contacts and joints."""
DURATION = 3
"""Force durations."""
TIME = 4
"""Times at which contacts begin and end."""


class Ended(NamedTuple):
    """Records of a run that has ended."""

    run: Any  # RUN
    links: Any  # list of LINK
    parts: Any  # list of GROUP_PART


def prepare_second_run(fine: Any, coarse: Any) -> None:
    """Set fields of a second run so that it can be compared with the first one.

    Fields of `coarse` are changed. `halves_pieces` becomes 1: it halves the pieces that
    its tolerance does not limit. It goes on after its proof for as long as `fine`. If
    `fine` has taken averaging steps, `min_break_spacing` of `coarse` becomes
    COARSER_SPACING times as long.

    Parameters
    ----------
    fine, coarse : RUN
        The run that has ended, and the one that has not begun. Both may be record
        arrays with the runs of all members.
    """
    coarse.halves_pieces = 1
    coarse.ticks_after_proof = fine.ticks_after_proof
    coarse.min_break_spacing = np.where(
        fine.averaged_steps > 0,
        COARSER_SPACING * coarse.min_break_spacing,
        coarse.min_break_spacing,
    )


def hidden_errors(fine: Ended, fit_error: float) -> list[float]:
    """Relative errors that a second run does not show, [measure] of `MEASURES`.

    All measures have a common error. It is the sum of the round-off of all steps, an
    error at loose tolerances, the largest opening velocity that was set to 0, and
    FIT_FACTOR times `fit_error`, the largest difference of given functions from their
    pieces; all are relative to the velocity scale.

    Peak forces, and the times of events, depend on the value of a signal at one point,
    which may be wrong by the same amount in both runs. So peak forces have a further
    error from their bounds. Durations and times have one from the errors of events and
    from faint forces, and without rods that of `add_faint_times`. If all values of a
    measure are 0, it has the common error only.
    """
    run = fine.run
    truncation = run.max_truncation_error / run.velocity_scale
    loose = LOOSE_FACTOR * truncation**LOOSE_POWER  # negligible if it is small
    resting = run.resting_velocity / run.velocity_scale
    # Velocities that the peak forces of the links make, m/s
    velocities = [link.peak_force * link.effective_mobility for link in fine.links]
    largest_velocity = max_abs(velocities) / run.velocity_scale
    # The round-offs of many steps add up as their square root: their signs vary.
    round_off = ROUND_OFF * (ROUND_OFFS_OF_STEP + math.sqrt(run.steps))
    # Velocities that are larger than the scale, and cancel, have a larger round-off.
    round_off = round_off * max(1.0, largest_velocity)
    common = round_off + loose + resting + FIT_FACTOR * fit_error
    errors = [common, common, common, common, common]  # one for each measure
    values = measures_of(fine)
    if all(part.kind != PartKind.SEGMENT for part in fine.parts):  # there are no rods
        add_faint_times(fine, errors)
    peak = max_abs(values[PEAK_FORCE])
    if peak > 0:
        excesses = []  # bounds of peak forces minus the peak forces, N
        for link in fine.links:
            if has_peak(link):
                excesses.append(link.peak_force_bound - link.peak_force)
        errors[PEAK_FORCE] += PEAK_FACTOR * max_abs(excesses) / peak
    event_error = EVENT_FACTOR * max_abs([link.event_error for link in fine.links])
    # Uncertainty of the ends of faint forces, s
    end_error = run.tick_duration * max_abs(
        [link.uncertain_ticks for link in fine.links]
    )
    for i in range(UNTIMED_COUNT, len(errors)):  # durations and times
        longest = max_abs(values[i])
        if longest > 0:
            errors[i] += (event_error + end_error) / longest
    return errors


def rounding_errors(ended: Ended, transit_error: float) -> list[float]:
    """Relative error of each of the `MEASURES` from rounded transit times, [measure].

    Every measure has the error `transit_error`. In addition, waves are shifted in time,
    at most by `transit_error` times the latest time of an event. Forces and velocities
    change within the longest force duration: velocities, impulses and peak forces get
    the shift over this duration as a further error. Durations get it twice for each
    episode, for its beginning and its end. Without any force there are no further
    errors.

    Parameters
    ----------
    ended : Ended
    transit_error : float
        Largest relative change of a transit time.
    """
    values = measures_of(ended)
    longest = max_abs(values[DURATION])
    latest = max_abs(values[TIME])
    shift = transit_error * latest  # error of the latest time, s
    errors = [transit_error] * len(values)
    if longest > 0:
        episodes = max([link.episodes for link in ended.links])
        for i in range(UNTIMED_COUNT):  # velocities, impulses and peak forces
            errors[i] += shift / longest
        errors[DURATION] += 2 * episodes * shift / longest
    return errors


def has_peak(link: Any) -> bool:
    """Whether a link has a peak force: contacts and joints, except impact contacts."""
    return bool(link.law >= Law.JOINT and link.law != Law.IMPACT)


def add_faint_times(fine: Ended, errors: list[float]) -> None:
    """Add the error from faint forces to `errors` of durations and times.

    The row must have no rods. `errors`, [measure], is changed. A contact counts as
    pressing only while its overlap is more than `graze_velocity` times the reference
    time of the run. So each episode seems to begin too late and to end too early. The
    error is the time in which faces with the velocity scale cover this overlap, twice
    for each episode of the contact that has most. It is divided by the largest value of
    the measure; a measure whose values are all 0 gets no error.
    """
    run = fine.run
    all_episodes = [link.episodes for link in fine.links]
    episodes = max([1, *all_episodes])  # of the contact that has most
    # The factor 2 is for the beginning and the end of an episode.
    ratio = 2 * run.graze_velocity / run.velocity_scale
    # Without rods, `shortest_transit` is the reference time.
    faint = ratio * run.shortest_transit * run.tick_duration * episodes
    values = measures_of(fine)
    for i in range(UNTIMED_COUNT, len(errors)):
        longest = max_abs(values[i])
        if longest > 0:
            errors[i] += faint / longest


def measures_of(ended: Ended) -> list[list[float]]:
    """Values of each of the `MEASURES` in a run, [measure][value], in SI units.

    The measures are velocities of groups (of all parts if bodies are bonded), impulses,
    peak forces, force durations, and times. Each contact or joint has three times: of
    its first and last force, and of its last opening. A time that never came is minus
    one tick.
    """
    run = ended.run
    impulses = []
    peaks = []
    durations = []
    times = []
    for link in ended.links:
        if link.law >= Law.JOINT:  # a joint or a contact
            impulses.append(link.impulse)
            durations.append(link.force_ticks * run.tick_duration)
            times.append(link.first_force_tick * run.tick_duration)
            times.append(link.last_force_tick * run.tick_duration)
            times.append(link.last_opening_tick * run.tick_duration)
        if has_peak(link):
            peaks.append(link.peak_force)
    velocities = []
    for part in ended.parts:
        # The velocity of a group is constant after the proof. Parts of bonded bodies
        # still vibrate.
        if run.has_bonds:
            velocities.append(part.mean_velocity)
        elif part.part_count > 0:  # the first part of a group
            velocities.append(part.group_velocity)
    return [velocities, impulses, peaks, durations, times]


def differences(fine: Ended, coarse: Ended) -> list[float]:
    """Largest relative difference of two runs in each of the `MEASURES`, [measure].

    Differences of velocities are relative to the velocity scale, those of other
    measures to the largest absolute value in the finer run. If all values of a measure
    are 0 in the finer run, its difference is set to 0.
    """
    relative = []
    coarse_values = measures_of(coarse)
    for i, values in enumerate(measures_of(fine)):
        scale = max_abs(values)
        if i == VELOCITY and scale > 0:
            scale = fine.run.velocity_scale
        pairs = zip(values, coarse_values[i], strict=True)
        largest = max_abs([a - b for a, b in pairs])
        if scale > 0:
            relative.append(largest / scale)
        else:
            relative.append(0.0)
    return relative


def wave_difference(fine: Ended, coarse: Ended) -> float:
    """Largest difference of the waves of two runs, relative to the velocity scale.

    The means and first moments of both waves over each segment, at the last check of
    finality, are compared. If both runs had this check at different ticks, or there are
    no segments, 0 is returned.
    """
    if fine.run.last_check_tick != coarse.run.last_check_tick:
        return 0.0
    changes = []
    for part, other in zip(fine.parts, coarse.parts, strict=True):
        for side in range(2):
            changes.append(part.wave_integrals[side] - other.wave_integrals[side])
            changes.append(part.wave_moments[side] - other.wave_moments[side])
    # The integrals are over y from -1 to 1: the means are half of them.
    return max_abs(changes) / (2 * fine.run.velocity_scale)


def momentum_error(fine: Ended) -> float:
    """Largest error of the velocity of a free group of bodies, over the velocity scale.

    The velocity of a group is computed in two ways, and the error is their difference.
    The first one is `group_velocity`, from the waves in the rods, which contain the
    errors of all pieces. The second one follows from Newton's law: the velocity at
    t = 0 plus (impulses from the left - impulses from the right)/m. Groups with a wall
    or an endless rod are left out. 0 is returned if the error is not known: if a force
    acts on an end of the row, or if the run stopped at the cap on steps, since its
    nodes are at different times then.
    """
    run = fine.run
    for link in fine.links:
        is_push = link.law == Law.PUSH_LEFT or link.law == Law.PUSH_RIGHT
        if is_push and link.impulse != 0:
            return 0.0
    if run.stop_reason == Stop.CAP:
        return 0.0
    worst = 0.0
    for first, group in enumerate(fine.parts):
        if group.part_count == 0:  # it is not the first part of a group
            continue
        mass = 0.0
        is_free = True
        for part in fine.parts[first : first + group.part_count]:
            mass += part.mass
            is_anchor = part.kind >= PartKind.WALL  # a wall or an endless rod
            is_free = is_free and not is_anchor
        if is_free and mass > 0:
            momentum = 0.0  # change since t = 0, kg m/s
            for link in fine.links:
                # `left_group` and `right_group` are numbers of first parts.
                if link.right_group == first:
                    momentum += link.impulse
                if link.left_group == first:
                    momentum -= link.impulse
            newton_velocity = group.initial_velocity + momentum / mass
            worst = max(worst, abs(group.group_velocity - newton_velocity))
    return worst / run.velocity_scale


def errors_of_two_runs(fine: Ended, coarse: Ended) -> list[float]:
    """Relative error of each of the `MEASURES` of the finer of two runs, [measure].

    It is DIFFERENCE_FACTOR times the relative difference of both runs in this measure.
    For velocities this difference is at least `momentum_error`: by so much velocities
    from the waves differ from those by Newton's law, in the finer run alone. As two
    numbers may agree by chance, at least a share of the worst difference is taken,
    which is the largest one of velocities, impulses, peak forces and waves. The share
    is LEAST_SHARE. It is larger for durations and times below the largest `event_lag`:
    a relative error e of velocities changes the time of an event by e times its lag.
    SHARED_FACTOR times the error that both runs share, of pieces that no tolerance
    limits, is added. If all values of a measure are 0, its error is 0.
    """
    relative = differences(fine, coarse)  # [measure]
    common = SHARED_FACTOR * fine.run.shared_error / fine.run.velocity_scale
    # The error of velocities from the waves, which Newton's law shows, may be larger
    # than the difference of the runs.
    relative[VELOCITY] = max(relative[VELOCITY], momentum_error(fine))
    worst = max(
        relative[VELOCITY],
        relative[IMPULSE],
        relative[PEAK_FORCE],
        wave_difference(fine, coarse),
    )
    lag = max_abs([link.event_lag for link in fine.links])
    errors = []
    for i, values in enumerate(measures_of(fine)):
        largest = max_abs(values)
        share = LEAST_SHARE
        if i >= UNTIMED_COUNT and largest > 0:  # durations and times
            share *= max(1.0, lag / largest)
        if largest > 0:
            error = DIFFERENCE_FACTOR * max(relative[i], share * worst) + common
        else:
            error = 0.0
        errors.append(error)
    return errors


def max_abs(values: list[float]) -> float:
    """Largest absolute value; 0 for an empty list."""
    return max([0.0, *[abs(value) for value in values]])
