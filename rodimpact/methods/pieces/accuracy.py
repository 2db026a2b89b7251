"""Error of a run.

It follows from a second run with other steps, and from what both runs share. The second
run has a coarser tolerance, and halves what the tolerance does not limit. So there is
no piece that both runs have, but by chance. The page has this as JavaScript.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from ..link import Law
from ..states import Stop
from .records import Part

COARSER = 3.0
"""Tolerance of the second run over that of the first.

Errors of both differ by some three then. A larger factor would make the difference
larger than the error; with a smaller one both agree by chance too often.
"""
COARSER_FLOOR = 2
"""Least duration of pieces in the second run over the first, at dense breaks."""
ROUND_OFF = 2.2e-16
"""Relative round-off of a number.

Those of the steps of a run have both signs: n make sqrt(n).
"""
ROUND_OFFS_OF_STEP = 8
"""Round-offs of the sums of one step, over that of a number.

So precisely forces satisfy their laws as well; where they make velocities that are
larger than the scale and cancel, that counts as much more.
"""
DIFFERENCE_FACTOR = 5.0
"""Stated error over the difference of two runs."""
LEAST_SHARE = 0.1
"""Least error of every measure over the worst difference: some agree by chance."""
SHARED_FACTOR = 0.2
"""Stated error over the estimate for pieces that breaks limit.

The estimate is that of a series; collocation integrates more precisely.
"""
PEAK_FACTOR = 2.0
"""Stated error of peaks over the estimate for the pieces in which they may be."""
EVENT_FACTOR = 1.0
"""Stated error of times over the estimate for the pieces in which events are."""
LOOSE_FACTOR = 2e7
"""Error over tail^2.5: errors of loose tolerances do not fall evenly."""
LOOSE_POWER = 2.5
"""Exponent of that tail."""
FIT_FACTOR = 4.0
"""Stated error over the miss of a given function by its pieces."""
UNTIMED_MEASURES = 3
"""Number of measures that are no times.

They come first, and their errors fall evenly.
"""
VELOCITY = 0
"""Place of the velocity among the measures."""
IMPULSE = 1
"""Place of the impulse among them."""
PEAK_FORCE = 2
"""Place of the peak force among them."""
DURATION = 3
"""Place of the durations of contacts among them."""
TIME = 4
"""Place of the times at which contacts begin and end among them."""


class Ended(NamedTuple):
    """Records of a run that has come to its end."""

    run: Any  # RUN
    links: Any  # list of LINK
    parts: Any  # list of GROUP_PART


def prepare_second_run(fine: Any, coarse: Any) -> None:
    """Set what runs at a coarser tolerance need to be compared with finer ones.

    Fields of `coarse` are changed. Its pieces that no tolerance limits will be halved:
    else both runs would have the same. It goes on as long after its proof as `fine`.
    Where `fine` took means over dense breaks, `min_break_spacing` of `coarse`, up to
    which a piece with means lasts, becomes COARSER_FLOOR times as long.

    Parameters
    ----------
    fine, coarse : RUN
        Runs that have ended, and runs that have not begun; of one member, or of all.
    """
    coarse.halves_pieces = 1
    coarse.ticks_after_proof = fine.ticks_after_proof
    coarse.min_break_spacing = np.where(
        fine.averaged_steps > 0,
        COARSER_FLOOR * coarse.min_break_spacing,
        coarse.min_break_spacing,
    )


def hidden_errors(fine: Ended, fit: float) -> list[float]:
    """Relative errors that a second run does not show, [measure] of `MEASURES`.

    All measures have a common error: the round-off of the steps, an error that large
    truncation errors add, the velocity of parting bodies that counted as rest, and
    FIT_FACTOR times `fit`, the largest miss of given functions by their pieces; all
    over the velocity scale.

    Single values decide peak forces, and times at which contacts close and open: two
    runs may miss them alike. So peak forces also have what their bounds leave open;
    durations and times have the error of events, the time in which a force counted as
    none, and without rods what `add_faint_times` adds. A measure whose values are all 0
    has the common error only.
    """
    run = fine.run
    tail = run.max_truncation_error / run.velocity_scale
    loose = LOOSE_FACTOR * tail**LOOSE_POWER  # small tails add next to nothing
    resting = run.resting_velocity / run.velocity_scale
    # Velocities that the peak forces of the links make, m/s
    velocities = [link.peak_force * link.effective_mobility for link in fine.links]
    strongest = max_abs(velocities) / run.velocity_scale
    round_off = ROUND_OFF * (ROUND_OFFS_OF_STEP + math.sqrt(run.steps))
    # Velocities that are larger than the scale, and cancel, have a larger round-off.
    round_off = round_off * max(1.0, strongest)
    common = round_off + loose + resting + FIT_FACTOR * fit
    errors = [common, common, common, common, common]  # of the `MEASURES`
    values = measures_of(fine)
    if all(part.kind != Part.SEGMENT for part in fine.parts):
        # Without rods, contacts press too faintly to be seen at first and at last.
        add_faint_times(fine, errors)
    peak = max_abs(values[PEAK_FORCE])
    if peak > 0:
        excess = []  # bounds of peaks less the peaks, N
        for link in fine.links:
            if has_peak(link):
                excess.append(link.peak_force_bound - link.peak_force)
        errors[PEAK_FORCE] += PEAK_FACTOR * max_abs(excess) / peak
    event_error = EVENT_FACTOR * max_abs([link.event_error for link in fine.links])
    # Time in which a force acted but counted as none, s
    cut = run.tick_duration * max_abs([link.cut_ticks for link in fine.links])
    for i in range(UNTIMED_MEASURES, len(errors)):  # durations and times
        longest = max_abs(values[i])
        if longest > 0:
            errors[i] += (event_error + cut) / longest
    return errors


def rounding_errors(ended: Ended, transit_error: float) -> list[float]:
    """Relative error of each of the `MEASURES` by rounded transit times, [measure].

    Each has `transit_error`. A wave that has crossed the row several times is shifted
    by this share of the time, at most by that of the latest time. As forces and
    velocities change within the longest duration of a force, the shift over this
    duration is added to velocities, impulses and peak forces. It counts twice for each
    episode in the durations: at its beginning and at its end. Nothing is added if no
    force acted.

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
        for i in range(UNTIMED_MEASURES):  # forces, impulses and velocities
            errors[i] += shift / longest
        errors[DURATION] += 2 * episodes * shift / longest
    return errors


def has_peak(link: Any) -> bool:
    """Whether a link has a peak force.

    Contacts and joints have one, but no impact, no bond and no push.
    """
    return bool(link.law >= Law.JOINT and link.law != Law.IMPACT)


def add_faint_times(fine: Ended, errors: list[float]) -> None:
    """Add the relative error of durations and times of a row without rods to `errors`.

    `errors` is a list by measure, and is changed. A contact counts as pressing only
    once its overlap is the length that `graze_velocity` makes in the reference time of
    the run. So each episode begins too late and ends too early, by the time in which
    faces that close with the velocity scale cover this length. A measure whose values
    are all 0 gets no error.
    """
    run = fine.run
    all_episodes = [link.episodes for link in fine.links]
    episodes = max([1, *all_episodes])  # most of any contact
    # Share of the reference time, at the beginning and at the end of an episode.
    # Without rods `shortest_transit` is the reference time.
    ratio = 2 * run.graze_velocity / run.velocity_scale
    faint = ratio * run.shortest_transit * run.tick_duration * episodes
    values = measures_of(fine)
    for i in range(UNTIMED_MEASURES, len(errors)):
        longest = max_abs(values[i])
        if longest > 0:
            errors[i] += faint / longest


def measures_of(ended: Ended) -> list[list[float]]:
    """Values of a run that the `MEASURES` compare, [measure][value], in SI units.

    These are velocities of groups (of parts, where they are bonded to others),
    impulses, peak forces, force durations and times. A contact has three times: those
    of its first and last force, and of its last opening. A time that never came is one
    tick below 0.
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
        # Groups go on evenly after the proof, whenever it came;
        # parts of joined bodies vibrate.
        if run.has_bonds:
            velocities.append(part.mean_velocity)
        elif part.part_count > 0:  # the first part of a group, which has its motion
            velocities.append(part.group_velocity)
    return [velocities, impulses, peaks, durations, times]


def differences(fine: Ended, coarse: Ended) -> list[float]:
    """Largest relative difference of two runs in each of the `MEASURES`, [measure].

    It is relative to the largest absolute value of the finer run, for velocities to the
    velocity scale; and 0 where all values of the finer run are 0.
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

    Compared are their means and first moments over each segment at the last check of
    finality; 0 is returned if that was at different ticks. The integrals are over y
    from -1 to 1, so that half of one is a mean.
    """
    if fine.run.last_proof_tick != coarse.run.last_proof_tick:
        return 0.0
    changes = []
    for part, other in zip(fine.parts, coarse.parts, strict=True):
        for side in range(2):
            changes.append(part.wave_integrals[side] - other.wave_integrals[side])
            changes.append(part.wave_moments[side] - other.wave_moments[side])
    return max_abs(changes) / (2 * fine.run.velocity_scale)


def momentum_error(fine: Ended) -> float:
    """Largest error of the velocity of a free group of bodies, over the velocity scale.

    The error is the difference of two velocities of a group: `group_velocity`, by the
    waves in its rods, which lacks what pieces have lost, and by Newton's law the one at
    t = 0 plus (impulses from the left - impulses from the right)/m. Groups that a wall
    or an endless rod holds are left out. 0 is returned where the error is not known: if
    a force acts on an end of the row, or the cap on steps ended the run, as its nodes
    are at different times then.
    """
    run = fine.run
    for link in fine.links:
        is_push = link.law == Law.PUSH_LEFT or link.law == Law.PUSH_RIGHT
        if is_push and link.impulse != 0:
            return 0.0
    if run.stop_reason == Stop.CAP:
        return 0.0
    worst = 0.0
    for first, head in enumerate(fine.parts):
        if head.part_count == 0:  # it is not the first part of a group
            continue
        mass = 0.0
        is_free = True
        for part in fine.parts[first : first + head.part_count]:
            mass += part.mass
            is_anchor = part.kind >= Part.WALL
            is_free = is_free and not is_anchor
        if is_free and mass > 0:
            momentum = 0.0  # gained since t = 0
            for link in fine.links:
                # A link knows a group by the number of its first part.
                if link.right_group == first:
                    momentum += link.impulse
                if link.left_group == first:
                    momentum -= link.impulse
            newton_velocity = head.initial_velocity + momentum / mass
            worst = max(worst, abs(head.group_velocity - newton_velocity))
    return worst / run.velocity_scale


def errors_of_two_runs(fine: Ended, coarse: Ended) -> list[float]:
    """Relative error of each of the `MEASURES` of the finer of two runs, [measure].

    It is DIFFERENCE_FACTOR times the difference of both runs in this measure, or times
    a share of the worst difference, if that is larger: two numbers may agree by chance.
    The worst is that of velocities, impulses, peak forces, or waves in rods. The share
    is larger for durations and times that are shorter than `event_lag`: an error of
    velocities, relative to their scale, moves an event by this part of its lag. The
    error of pieces that no tolerance limits, which both runs have in common, is added.
    An error is 0 where all values of the measure are.
    """
    apart = differences(fine, coarse)  # relative, by measure
    common = SHARED_FACTOR * fine.run.shared_error / fine.run.velocity_scale
    # Velocities that disagree with the impulses are as wrong as that.
    apart[VELOCITY] = max(apart[VELOCITY], momentum_error(fine))
    worst = max(
        apart[VELOCITY],
        apart[IMPULSE],
        apart[PEAK_FORCE],
        wave_difference(fine, coarse),
    )
    lag = max_abs([link.event_lag for link in fine.links])
    errors = []
    for i, values in enumerate(measures_of(fine)):
        largest = max_abs(values)
        share = LEAST_SHARE
        if i >= UNTIMED_MEASURES and largest > 0:  # durations and times
            share *= max(1.0, lag / largest)
        if largest > 0:
            error = DIFFERENCE_FACTOR * max(apart[i], share * worst) + common
        else:
            error = 0.0
        errors.append(error)
    return errors


def max_abs(values: list[float]) -> float:
    """Largest absolute value; 0 of an empty list."""
    return max([0.0, *[abs(value) for value in values]])
