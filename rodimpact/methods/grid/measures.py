"""Measures of a force that is known by its means over time steps.

Gaps are known at the ends of the steps. The measures are largest force, begin and end
of forces, contact intervals and openings. Times are counted in steps. Arrays of forces
have an entry for each step, N, those of gaps one entry more, m.
"""

import math
from typing import NamedTuple

import numpy as np

from ..run import Episode, episodes_of
from ..signals import Floats
from ..states import Status

MAX_CLOSING_STEPS = 2.0
"""Steps, at most, by which a gap closes later than its contact first presses."""
NEGLIGIBLE_FORCE_RATIO = 1e-6
"""A first mean force of less than this part of the next one is round-off."""
JUMP_RATIO = 0.3
"""Relative change of forces from step to step, beyond which they jump."""
KINK_CURVATURE_RATIO = 4
"""Curvature, at least, of a parabola across a jump or kink over one beside it."""
FLAT_RTOL = 1e-9
"""Relative change of forces from step to step that is round-off."""


class _Parabola(NamedTuple):
    """The curve value + slope t + curve t^2, N; t in steps from its first step on."""

    value: float
    slope: float
    curve: float


def largest_force(force: Floats) -> float:
    """Largest value of a curve whose means over steps are `force` [step], N.

    It is sought in the top step, that with the largest mean. If no mean is positive, 0
    is returned. Outside the run the force is 0.

    The curve is the parabola with the means of the top step and of both neighbours. Its
    value is the vertex, or the mean of the top step if the vertex is outside this step.
    Where these steps span a jump or a kink, the curve is a parabola through the top
    step and two steps on one side, see `_one_sided_parabola`. Its value is the vertex,
    or, if that is outside the top step, the larger value at an end of this step.
    """
    if np.max(force, initial=0.0) <= 0:
        return 0.0
    top = int(np.argmax(force))
    # `F` is the mean of the top step, with those of two steps before and two after, 0
    # outside the run: after padding by two steps, the top step is number top + 2.
    earlier, before, F, after, later = np.pad(force, 2)[top : top + 5].tolist()
    central = _parabola(before, F, after)  # the top step is its second one
    max_curvature = abs(central.curve) / KINK_CURVATURE_RATIO
    one_sided = _one_sided_parabola(
        F, ((after, later), (before, earlier)), max_curvature
    )
    if one_sided is None:
        vertex = _vertex_between(central, 1, 2)
        without_vertex = F
    else:  # the top step is its first one
        vertex = _vertex_between(one_sided, 0, 1)
        at_begin = one_sided.value
        at_end = one_sided.value + one_sided.slope + one_sided.curve
        without_vertex = max(at_begin, at_end)
    if vertex is None:
        return float(without_vertex)
    return float(vertex)


def _one_sided_parabola(
    F: float, sides: tuple[tuple[float, float], ...], max_curvature: float
) -> _Parabola | None:
    """Parabola with the means of the top step and of two steps on one side of it.

    F is the mean of the top step, N. Each of `sides` has the means of the next step on
    a side, and of the one after it. t is counted from the top step to that side. The
    parabola is smooth, and its curvature is less than `max_curvature`; if those on both
    sides are so, the less curved one is returned, and None if none is.
    """
    chosen = None
    for second, third in sides:
        parabola = _parabola(F, second, third)
        curvature = abs(parabola.curve)
        # Within a step the slope changes less, by 2 c, than the mean does.
        is_nearly_straight = curvature < abs(F - second) / 2
        is_flat = curvature <= FLAT_RTOL * F  # constant to round-off
        is_smooth = is_nearly_straight or is_flat
        if curvature < max_curvature and is_smooth:
            chosen = parabola
            max_curvature = curvature  # the other side is taken if it is less curved
    return chosen


def _parabola(first: float, second: float, third: float) -> _Parabola:
    """Parabola with these means over three steps, in N.

    t is 0 at the begin of the first of them.
    """
    curve = (first - 2 * second + third) / 2
    slope = second - first - 2 * curve
    return _Parabola(first - slope / 2 - curve / 3, slope, curve)


def _vertex_between(parabola: _Parabola, begin: float, end: float) -> float | None:
    """Largest value of a parabola, N, if it is reached between two times, else None.

    The times `begin` and `end`, in steps, do not count themselves. A parabola that is
    straight, or has a smallest value, has no largest one.
    """
    value, slope, curve = parabola
    if curve >= 0:
        return None
    vertex_time = -slope / (2 * curve)
    if begin < vertex_time < end:
        return value - slope * slope / (4 * curve)
    return None


def contact_intervals(force: Floats, gap: Floats, open_gap: float) -> Floats:
    """Begin and end of each force, and the opening after it, in steps [n, 3].

    A force is a run of steps with means > 0. `force` [step] has the means, N, `gap`
    [step + 1] is at the ends of steps from t = 0 on, m. The opening is where the gap
    passes `open_gap`, m, before the next force begins. A time that does not come is
    nan: an opening, or the end of a force in the last step. [0, 3] without forces.
    """
    # Steps in which forces begin, and those after their last ones, in turn
    edges = np.flatnonzero(np.diff(force > 0, prepend=False, append=False)).tolist()
    begin_steps = edges[::2]
    stop_steps = edges[1::2]
    wide = np.flatnonzero(gap > open_gap)  # step ends at which the gap is open
    intervals = []
    for k, (first, stop) in enumerate(zip(begin_steps, stop_steps, strict=True)):
        following = len(force)  # the end of the run, or the step of the next force
        if k + 1 < len(begin_steps):
            following = begin_steps[k + 1]
        begin = begin_of_force(force, gap, first)
        end = math.nan
        if stop < len(force):  # it ends before the run does
            end = max(begin, end_of_force(force, gap, first, stop))
        opening = math.nan
        # First step end with a wide gap from `stop` on, if there is one
        next_wide = np.searchsorted(wide, stop)
        if next_wide < len(wide) and wide[next_wide] <= following:
            opening = _opening(gap, int(wide[next_wide]), open_gap, end)
        intervals.append((begin, end, opening))
    return np.array(intervals).reshape(-1, 3)


def episodes_from_intervals(intervals: Floats) -> tuple[Episode, ...]:
    """Episodes of touching: each lasts from its first force until a gap has opened.

    A row of `intervals` [n, 3] holds the begin and the end of a force and the opening
    after it, in steps; nan is what does not happen. Times of the episodes are in steps,
    too. Without an opening between them, forces are one episode.
    """
    changes = [Status.PRESS, Status.GRAZE, Status.OPEN]
    statuses = np.broadcast_to(changes, intervals.shape)  # by column
    happens = ~np.isnan(intervals)
    tick = 1.0  # times are in steps, and stay so
    return episodes_of(intervals[happens], statuses[happens], tick)


def begin_of_force(force: Floats, gap: Floats, i: int) -> float:
    """Time at which the force begins that first presses in step i, in steps.

    It begins where the gap closes that is open at the begin of step i, if it goes on to
    close as fast as in the step before; else, also if that is more than
    `MAX_CLOSING_STEPS` later, with step i. If the force in step i is only round-off
    beside that in the next step, it begins with the next step.
    """
    if i + 1 < len(force) and force[i] <= NEGLIGIBLE_FORCE_RATIO * force[i + 1]:
        return i + 1.0
    before = max(i - 1, 0)  # the step before, or the first one
    fall_per_step = gap[before] - gap[before + 1]
    # gap[i] is at the begin of step i.
    if 0 < gap[i] < MAX_CLOSING_STEPS * fall_per_step:
        return i + float(gap[i] / fall_per_step)
    return float(i)


def end_of_force(force: Floats, gap: Floats, i: int, j: int) -> float:
    """Time at which the force ends that presses in the steps i to j - 1, in steps.

    What ends it is seen from the gaps at the begin and at the end of step j - 1:

    - An overlap, then a gap: the force of a compliant contact ends where the overlap
      does, see `_closing_share`.
    - An overlap at both: a dashpot lets go, see `_end_of_dashpot`.
    - No overlap: the contact is rigid, see `_end_of_rigid_contact`.
    """
    begin = j - 1  # begin of the last step with force
    gap_at_begin = float(gap[begin])
    gap_at_end = float(gap[j])
    if gap_at_begin < 0 < gap_at_end:  # the overlap ends inside the step
        return begin + _closing_share(gap, i, j)
    if gap_at_begin < 0:
        return _end_of_dashpot(force, i, j)
    return _end_of_rigid_contact(force, i, j)


def _end_of_dashpot(force: Floats, i: int, j: int) -> float:
    """Time at which the force of a dashpot ends that presses in the steps i to j - 1.

    It is in steps. The force falls to 0 along a line from its value at the begin of
    step j - 1, which is extrapolated from the two means before. If it pressed for less
    than three steps, it ends with the step.
    """
    if j - i < 3:
        return float(j)
    third_last, second_last, last = force[j - 3 : j].tolist()
    at_begin = second_last - (third_last - second_last) / 2
    if at_begin <= 0:
        return j - 1.0
    # The mean of the step is half of the force at its begin, times this time.
    time_to_zero = 2 * last / at_begin
    return float(j - 1 + min(1.0, time_to_zero))


def _end_of_rigid_contact(force: Floats, i: int, j: int) -> float:
    """Time at which a rigid contact lets go that presses in the steps i to j - 1.

    It is in steps. If the last three means fall evenly, the force ends where a line
    through the last two reaches 0, up to half a step after step j - 1. Else it drops to
    0 inside this step, after the share `share_of_jump`.
    """
    begin = j - 1
    if j - i >= 3:
        third_last, second_last, last = force[begin - 2 : j].tolist()
        fall = third_last - second_last
        last_fall = second_last - last
        # At least half and at most twice as fast as before
        falls_evenly = 0 < fall <= 2 * last_fall <= 4 * fall
        # The force is the last mean in the middle of the last step, and falls by
        # `last_fall` in a step.
        if falls_evenly and last <= last_fall:
            return float(begin + 0.5 + last / last_fall)
    return begin + share_of_jump(force[max(i, j - 4) : j])


def _closing_share(gap: Floats, i: int, j: int) -> float:
    """Share of step j - 1 after which the overlap at its begin has become 0.

    The overlap must end there: gap[j - 1] < 0 < gap[j]. The force began in step i. If
    it has pressed for three steps, the gap is the parabola through the last three step
    ends, else a line.
    """
    # With s from 0 to 1 in the step, the gap is
    # first_gap + rise (slope s + curve s^2): slope + curve = 1.
    first_gap = float(gap[j - 1])
    rise = float(gap[j]) - first_gap  # in step j - 1
    curve = 0.0
    if j - i >= 3:
        rise_before = first_gap - float(gap[j - 2])
        curve = (1 - rise_before / rise) / 2
    slope = 1 - curve
    overlap_ratio = -first_gap / rise
    # Root of curve s^2 + slope s = overlap_ratio, in the form that loses no digits
    root = math.sqrt(max(slope * slope + 4 * curve * overlap_ratio, 0.0))
    return 2 * overlap_ratio / (slope + root)


def share_of_jump(force: Floats) -> float:
    """Fraction Fm/Fe of the last step during which a force acts that ends with a jump.

    Fm is the mean of the last step, the last of `force`. Fe is extrapolated from the
    means before it in `force`, up to three: along the line through the last two if they
    are smooth, else it is the last of them. The fraction is 1 if the force does not
    fall by more than twice the curvature of these means, or if there are none.
    """
    *before, last = force.tolist()
    extrapolated = 0.0  # without means before it, `last` is no fall
    curvature = 0.0
    if before:
        extrapolated = before[-1]
    is_smooth = len(before) > 1 and max(before) - min(before) <= JUMP_RATIO * before[-1]
    if is_smooth:
        extrapolated = 2 * before[-1] - before[-2]
        # 0 for two means; of three the second difference
        curvature = float(np.abs(np.diff(before, 2)).sum())
    if extrapolated - last <= 2 * curvature:
        return 1.0
    return float(last / extrapolated)


def _opening(gap: Floats, k: int, open_gap: float, force_end: float) -> float:
    """Time at which bodies part before step end k, in steps.

    At step end k their gap is larger than `open_gap`, m, for the first time since their
    force ended at `force_end`, in steps, or nan if it acts to the end of the run. They
    part at the last zero of the gap, but not before `force_end`. Numerical dispersion
    opens small false gaps, though, which do not accelerate. After such a one they part
    later, at the vertex from which a parabola rises as the gap does when it passes
    `open_gap`.
    """
    # Python's max with nan as its second argument is the first one.
    last_zero = max(_passing_time(gap, k, 0.0), force_end)
    # A parabola (t - vertex)^2 through half the level at one time and the level at the
    # other: the times after the vertex are as sqrt(1/2) to 1.
    half = _passing_time(gap, k, open_gap / 2)
    passed = _passing_time(gap, k, open_gap)
    vertex = passed - (passed - half) / (1 - math.sqrt(0.5))
    midpoint = (last_zero + vertex) / 2
    gap_at_midpoint, gap_at_vertex = np.interp(
        [midpoint, vertex], np.arange(len(gap)), gap
    )
    # A true gap accelerates: after half of the time it is a quarter of what it is in
    # the end, or less. The bound is a third.
    is_false_gap = 3 * gap_at_midpoint > gap_at_vertex
    if vertex > last_zero and is_false_gap:
        return vertex
    return last_zero


def _passing_time(gap: Floats, k: int, level: float) -> float:
    """Last time before step end k at which a gap was at `level`, m, in steps.

    At step end k the gap is larger. Gaps are straight lines between step ends. If the
    gap was larger all the time, k - 1 is returned.
    """
    for i in range(k - 1, -1, -1):
        if gap[i] <= level:  # it passes the level in step i
            return i + float((level - gap[i]) / (gap[i + 1] - gap[i]))
    return k - 1.0
