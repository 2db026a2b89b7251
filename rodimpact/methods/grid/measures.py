"""Measures of a force whose means over time steps are known.

Gaps are known at the ends of the steps. The measures are the largest force, the start
and end of forces, contact intervals and openings. Times are counted in steps. Arrays of
forces, N, have one entry for each step; arrays of gaps, m, have one entry more.
"""

import math
from typing import NamedTuple

import numpy as np

from ..run import Episode, episodes_of
from ..signals import Floats
from ..states import Status

MAX_CLOSING_STEPS = 2.0
"""A gap closes at most so many steps after the start of the first step with force."""
NEGLIGIBLE_FORCE_RATIO = 1e-6
"""A first mean force smaller than this fraction of the next one is round-off."""
JUMP_RATIO = 0.3
"""Relative change of forces from step to step above which they jump."""
KINK_CURVATURE_RATIO = 4
"""Smallest ratio of the curvature across a jump or kink to that beside it."""
FLAT_RTOL = 1e-9
"""Relative change of forces from step to step that is round-off."""


class _Parabola(NamedTuple):
    """The curve value + slope t + curve t^2, N, with t in steps.

    t is 0 at the start of the first of the three steps that define it.
    """

    value: float
    slope: float
    curve: float


def largest_force(force: Floats) -> float:
    """Largest value of a curve whose means over steps are `force` [step], N.

    It is sought in the top step, the step with the largest mean. If no mean is
    positive, 0 is returned. Outside the run the force counts as 0.

    The curve is the parabola with the means of the top step and its two neighbours. The
    result is its vertex, or the mean of the top step if the vertex is outside this
    step. If these steps span a jump or a kink, the curve is the parabola with the means
    of the top step and of two steps on one side, see `_one_sided_parabola`. The result
    is then its vertex or, if that is outside the top step, the larger one of its values
    at both ends of this step.
    """
    if np.max(force, initial=0.0) <= 0:
        return 0.0
    top = int(np.argmax(force))
    # Means of the top step, `F`, and of two steps before and two after it. Padded by
    # two zeros, the top step has the index top + 2.
    before_2, before, F, after, after_2 = np.pad(force, 2)[top : top + 5].tolist()
    central = _parabola(before, F, after)
    # A parabola on one side with less curvature than this shows that there is a jump or
    # a kink in the steps of the central one.
    max_curvature = abs(central.curve) / KINK_CURVATURE_RATIO
    one_sided = _one_sided_parabola(
        F, ((after, after_2), (before, before_2)), max_curvature
    )
    if one_sided is None:
        # The top step is the second one of this parabola.
        vertex = _vertex_between(central, begin=1, end=2)
        without_vertex = F  # the result if there is no vertex in the top step
    else:
        # The top step is the first one of this parabola.
        vertex = _vertex_between(one_sided, begin=0, end=1)
        at_begin = one_sided.value
        at_end = one_sided.value + one_sided.slope + one_sided.curve  # at t = 1
        without_vertex = max(at_begin, at_end)
    if vertex is None:
        return float(without_vertex)
    return float(vertex)


def _one_sided_parabola(
    F: float, sides: tuple[tuple[float, float], ...], max_curvature: float
) -> _Parabola | None:
    """Parabola with the means of the top step and of two steps on one side of it.

    F is the mean of the top step, N. Each of `sides` has the means of the next step on
    this side and of the step after that. t is counted from the top step towards this
    side. The curvature of a parabola is here its absolute factor of t^2. A parabola is
    accepted if its curvature is less than `max_curvature` and it is smooth: nearly
    straight, or constant to round-off. If both are accepted, the less curved one is
    returned; if none is, None.
    """
    chosen = None
    for second, third in sides:
        parabola = _parabola(F, second, third)
        curvature = abs(parabola.curve)
        # The slope changes by 2 curvature in a step; it must change by less than the
        # mean does.
        is_nearly_straight = curvature < abs(F - second) / 2
        is_flat = curvature <= FLAT_RTOL * F  # constant to round-off
        is_smooth = is_nearly_straight or is_flat
        is_less_curved = curvature < max_curvature
        if is_less_curved and is_smooth:
            chosen = parabola
            max_curvature = curvature  # the other side is taken if it is less curved
    return chosen


def _parabola(first: float, second: float, third: float) -> _Parabola:
    """Parabola with these means over three successive steps, in N.

    t is 0 at the start of the first of these steps.
    """
    # The mean over step n is value + slope (n + 1/2) + curve (n^2 + n + 1/3).
    curve = (first - 2 * second + third) / 2
    slope = second - first - 2 * curve
    value = first - slope / 2 - curve / 3
    return _Parabola(value, slope, curve)


def _vertex_between(parabola: _Parabola, begin: float, end: float) -> float | None:
    """Largest value of a parabola, N, if it is reached between two times, else None.

    The times `begin` and `end`, in steps, are excluded. None is also returned for a
    straight line and for a parabola that opens upwards.
    """
    value, slope, curve = parabola
    if curve >= 0:
        return None
    vertex_time = -slope / (2 * curve)
    if begin < vertex_time < end:
        return value - slope * slope / (4 * curve)
    return None


def contact_intervals(force: Floats, gap: Floats, open_gap: float) -> Floats:
    """Start and end of each force, and the opening after it, in steps [n, 3].

    A force is a sequence of steps with means > 0. `force` [step] has the means, N, and
    `gap` [step + 1] the gaps at t = 0 and at the ends of steps, m. There is an opening
    if the gap exceeds `open_gap`, m, before the next force begins, see `_opening`. A
    time that is not reached is nan: an opening, or the end of a force that acts in the
    last step. The result is [0, 3] without forces.
    """
    # First step of each force and the step after its last one, alternately
    edges = np.flatnonzero(np.diff(force > 0, prepend=False, append=False)).tolist()
    first_steps = edges[::2]
    stop_steps = edges[1::2]
    open_ends = np.flatnonzero(gap > open_gap)  # step ends at which the gap is open
    intervals = []
    for k, (first, stop) in enumerate(zip(first_steps, stop_steps, strict=True)):
        next_force = len(force)  # first step of the next force, or the end of the run
        if k + 1 < len(first_steps):
            next_force = first_steps[k + 1]
        begin = begin_of_force(force, gap, first)
        end = math.nan
        if stop < len(force):  # the force ends before the run does
            # Both times are extrapolated: round-off might exchange them.
            end = max(begin, end_of_force(force, gap, first, stop))
        opening = math.nan
        # First entry of `open_ends` at or after `stop`, the end of the last step with
        # force
        i = np.searchsorted(open_ends, stop)
        # An index of a step is also that of the step end at which it begins: the gap
        # may open up to the start of the next force.
        opens = i < len(open_ends) and open_ends[i] <= next_force
        if opens:
            open_end = int(open_ends[i])
            # Not before `end`; this is nan if the force acts in the last step.
            opening = _opening(gap, open_end, open_gap, force_end=end)
        intervals.append((begin, end, opening))
    return np.array(intervals).reshape(-1, 3)


def episodes_from_intervals(intervals: Floats) -> tuple[Episode, ...]:
    """Episodes of touching: each lasts from its first force until a gap opens.

    A row of `intervals` [n, 3] has the start and the end of a force and the opening
    after it; a time that is not reached is nan. The episodes have the same unit of
    time. Forces without an opening between them belong to one episode.
    """
    # Status of the contact after each of the three times, [n, 3]
    statuses = np.broadcast_to(
        [Status.PRESS, Status.GRAZE, Status.OPEN], intervals.shape
    )
    is_reached = ~np.isnan(intervals)  # selects row by row, in the order of time
    # A tick of 1 keeps the unit of time.
    return episodes_of(intervals[is_reached], statuses[is_reached], tick=1.0)


def begin_of_force(force: Floats, gap: Floats, i: int) -> float:
    """Time at which a force begins whose first step with a mean > 0 is i, in steps.

    The gap at the start of step i is extrapolated at the rate of the step before, for
    i = 0 at the rate of step 0: the force begins when the gap becomes 0. If the gap is
    not open at the start of step i, or does not close within `MAX_CLOSING_STEPS`, the
    force begins with step i. If the force in step i is only round-off of that in the
    next step, it begins with the next step.
    """
    has_next = i + 1 < len(force)
    if has_next and force[i] <= NEGLIGIBLE_FORCE_RATIO * force[i + 1]:
        return i + 1.0  # start of the next step
    before = max(i - 1, 0)  # the step before; step 0 has none
    fall_per_step = gap[before] - gap[before + 1]
    # gap[i] is at the start of step i.
    closes_soon = 0 < gap[i] < MAX_CLOSING_STEPS * fall_per_step
    if closes_soon:
        return i + float(gap[i] / fall_per_step)
    return float(i)


def end_of_force(force: Floats, gap: Floats, i: int, j: int) -> float:
    """Time at which a force ends that acts in the steps i to j - 1, in steps.

    It depends on the gaps at the start and at the end of the last step, j - 1:

    - An overlap, then a gap > 0: the force of a compliant contact ends when the overlap
      becomes 0, see `_share_with_overlap`.
    - An overlap, then no gap (an overlap or 0): the contact has a dashpot, see
      `_end_of_dashpot`.
    - No overlap at the start: the contact is rigid, see `_end_of_rigid_contact`.
    """
    begin = j - 1  # start of the last step with force: a step number and index in `gap`
    gap_at_begin = float(gap[begin])
    gap_at_end = float(gap[j])
    if gap_at_begin < 0 < gap_at_end:  # the overlap ends inside the step
        share = _share_with_overlap(gap, i, j)  # fraction of the step
        return begin + share
    if gap_at_begin < 0:
        return _end_of_dashpot(force, i, j)
    return _end_of_rigid_contact(force, i, j)


def _end_of_dashpot(force: Floats, i: int, j: int) -> float:
    """Time at which the force of a dashpot ends that acts in the steps i to j - 1.

    The time is in steps. In the last step, j - 1, the force falls linearly to 0 from
    its value at the start of this step, which is extrapolated from the means of the two
    steps before. If this value is not positive, the force ends at the start of step
    j - 1. If the force acts in fewer than three steps, it ends with the last.
    """
    if j - i < 3:
        return float(j)
    third_last, second_last, last = force[j - 3 : j].tolist()
    # A mean is the value in the middle of its step: half of the difference leads to the
    # end of the second last step.
    at_begin = second_last - (third_last - second_last) / 2
    if at_begin <= 0:
        return j - 1.0
    # The impulse `last` (mean times one step) is the triangle at_begin time_to_zero/2.
    time_to_zero = 2 * last / at_begin
    return float(j - 1 + min(1.0, time_to_zero))


def _end_of_rigid_contact(force: Floats, i: int, j: int) -> float:
    """Time at which the force of a rigid contact ends that acts in steps i to j - 1.

    The time is in steps. If the last three means fall evenly (the last fall is half to
    twice the fall before), the force ends where the line through the last two means
    reaches 0, at most half a step after step j - 1. If they do not, or if this line
    ends later, the force drops to 0 inside step j - 1, after the fraction
    `share_of_jump` of it.
    """
    begin = j - 1  # start of the last step
    if j - i >= 3:
        third_last, second_last, last = force[j - 3 : j].tolist()
        fall = third_last - second_last
        last_fall = second_last - last
        # The last fall is at least half and at most twice the fall before.
        falls_evenly = 0 < fall <= 2 * last_fall <= 4 * fall
        # The mean `last` is the force in the middle of the last step; from there it
        # falls by `last_fall` in a step, to 0 within a step.
        if falls_evenly and last <= last_fall:
            return float(begin + 0.5 + last / last_fall)
    last_means = force[max(i, j - 4) : j]  # up to four
    return begin + share_of_jump(last_means)


def _share_with_overlap(gap: Floats, i: int, j: int) -> float:
    """Fraction of step j - 1 after which the overlap at its start has become 0.

    The overlap must end in this step: gap[j - 1] < 0 < gap[j]. The force began in step
    i. If it has acted in three steps or more, the gap is the parabola through the last
    three step ends, else a straight line.
    """
    # With s from 0 to 1 in step j - 1 the gap is first_gap + rise (slope s +
    # curve s^2), and slope + curve = 1.
    first_gap = float(gap[j - 1])
    rise = float(gap[j]) - first_gap  # in step j - 1
    curve = 0.0
    if j - i >= 3:
        # At s = -1 the parabola has the gap first_gap - rise_before, so that
        # slope - curve = rise_before/rise.
        rise_before = first_gap - float(gap[j - 2])
        curve = (1 - rise_before / rise) / 2
    slope = 1 - curve
    overlap_ratio = -first_gap / rise
    # Positive root of curve s^2 + slope s = overlap_ratio, without cancellation;
    # round-off might make its discriminant negative
    root = math.sqrt(max(slope * slope + 4 * curve * overlap_ratio, 0.0))
    return 2 * overlap_ratio / (slope + root)


def share_of_jump(force: Floats) -> float:
    """Fraction Fm/Fe of the last step during which a force acts that ends with a jump.

    `force` are the last means, from one to four; Fm is the last one. Fe is extrapolated
    from the means before: along the line through the last two of them if they are
    smooth, else it is the last of them. The fraction is 1 if there are no means before,
    or if Fe - Fm is at most twice the absolute second difference of the means before.
    """
    *before, last = force.tolist()
    extrapolated = 0.0  # without means before the last one the fraction is 1
    second_difference = 0.0
    is_smooth = False
    if before:
        extrapolated = before[-1]
        variation = max(before) - min(before)
        is_smooth = len(before) > 1 and variation <= JUMP_RATIO * before[-1]
    if is_smooth:
        extrapolated = 2 * before[-1] - before[-2]
        # That of three means; two means have none, and the empty sum is 0.
        second_difference = float(np.abs(np.diff(before, 2)).sum())
    if extrapolated - last <= 2 * second_difference:
        return 1.0
    return float(last / extrapolated)


def _opening(gap: Floats, open_end: int, open_gap: float, force_end: float) -> float:
    """Time at which two bodies separate before step end `open_end`, in steps.

    At this step end their gap exceeds `open_gap`, m, for the first time since their
    force ended at `force_end`, in steps; this is nan if the force acts in the last
    step. The bodies separate at the last zero of the gap, but not before `force_end`.
    However, numerical dispersion opens small false gaps first. After such a false gap
    the bodies separate later: at the vertex of the parabola that rises from 0 and has
    the gaps `open_gap`/2 and `open_gap` at the same times as the gap. A gap is false if
    this vertex is after the last zero, and if up to the vertex the gap grows about
    linearly, not with constant acceleration.
    """
    # With nan as its second argument max returns the first one.
    last_zero = max(_last_time_at(gap, open_end, 0.0), force_end)
    # A parabola in proportion to (t - vertex)^2: the times since the vertex at half the
    # level and at the level have the ratio sqrt(1/2), so that the time between these
    # two is 1 - sqrt(1/2) of the latter.
    half_passed = _last_time_at(gap, open_end, open_gap / 2)
    passed = _last_time_at(gap, open_end, open_gap)
    vertex = passed - (passed - half_passed) / (1 - math.sqrt(0.5))
    midpoint = (last_zero + vertex) / 2
    gap_at_midpoint, gap_at_vertex = np.interp(
        [midpoint, vertex], np.arange(len(gap)), gap
    )
    # A gap with constant acceleration has a quarter of its final value at the midpoint,
    # a false one about half. The bound is a third.
    is_false_gap = 3 * gap_at_midpoint > gap_at_vertex
    if vertex > last_zero and is_false_gap:
        return vertex
    return last_zero


def _last_time_at(gap: Floats, open_end: int, level: float) -> float:
    """Last time before step end `open_end` at which a gap was equal to `level`, m.

    The time is in steps. At `open_end` the gap is larger. Between step ends the gap is
    a straight line. If it was larger than `level` at all times, `open_end` - 1 is
    returned.
    """
    for i in range(open_end - 1, -1, -1):  # backwards to 0
        if gap[i] <= level:  # the gap passes the level in step i
            return i + float((level - gap[i]) / (gap[i + 1] - gap[i]))
    return open_end - 1.0
