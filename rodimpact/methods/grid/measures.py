"""Measures of a force that is known by its means over time steps.

Gaps are known at the ends of the steps. The measures are largest force, begin and end
of forces, contact intervals and openings. Times are counted in steps. Arrays of forces
have an entry for each step, N, those of gaps one entry more, m.
"""

import math

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


def largest_force(force: Floats) -> float:
    """Largest force of a curve with these means over steps, N.

    It is that in the step of the largest mean. The curve is the parabola with the means
    of this step and of both neighbours. Where these span a jump or a kink, it is the
    parabola through this step and two steps before or after it, the less curved of
    both. That one must have much less curvature than the first parabola, and be smooth:
    its curvature is less than its slope, or the force is constant.
    """
    if np.max(force, initial=0.0) <= 0:  # no force presses
        return 0.0
    top = int(np.argmax(force))
    # Two steps more on both sides, so that `top` is the middle of five
    earlier, before, F, after, later = np.pad(force, 2)[top : top + 5].tolist()
    # The curve is value + slope t + curve t^2, t in steps; at t = 0 the first of its
    # three steps begins.
    value, slope, curve = _parabola(before, F, after)
    top_begin = 1  # t where the top step begins, the second of the three
    largest = F
    # A parabola beside the top step is taken if its curvature is less than this.
    max_curvature = abs(curve) / KINK_CURVATURE_RATIO
    # Time is counted away from the top step on either side.
    for second, third in ((after, later), (before, earlier)):
        a, b, c = _parabola(F, second, third)
        # Its curvature 2 c is less than the fall of its mean in a step, or it is flat.
        is_smooth = abs(c) < abs(F - second) / 2 or abs(c) <= FLAT_RTOL * F
        if abs(c) < max_curvature and is_smooth:
            value = a
            slope = b
            curve = c
            top_begin = 0  # the top step is the first of these three
            max_curvature = abs(c)  # the other side is taken if it is less curved
            largest = max(a, a + b + c)  # values at both ends of the step
    # If the vertex lies in the top step it is the largest force.
    if curve < 0 and top_begin < -slope / (2 * curve) < top_begin + 1:
        largest = value - slope * slope / (4 * curve)
    return float(largest)


def _parabola(first: float, second: float, third: float) -> tuple[float, float, float]:
    """Parabola a + b t + c t^2 with these means over three steps: a, b and c.

    t is counted in steps from the begin of the first one.
    """
    curve = (first - 2 * second + third) / 2
    slope = second - first - 2 * curve
    return first - slope / 2 - curve / 3, slope, curve


def contact_intervals(force: Floats, gap: Floats, open_gap: float) -> Floats:
    """Times of forces in steps, [n, 3].

    They are begin and end of each force, and the opening before the next one. `gap` is
    at the ends of steps, with one entry more than `force`. A gap has opened once it
    passes `open_gap`, m. A time that does not come is nan.
    """
    # Steps in which forces begin, and those after their last ones, in turn
    edges = np.flatnonzero(np.diff(force > 0, prepend=False, append=False)).tolist()
    wide = np.flatnonzero(gap > open_gap)  # step ends at which the gap is open
    # Step in which the next force begins:
    # every other edge from the third on; then the end of the run
    next_begins = [*edges, len(force)][2::2]
    intervals = []
    for first, stop, following in zip(
        edges[::2], edges[1::2], next_begins, strict=True
    ):
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
    """Episodes of touching, from the first force until a gap has opened.

    Times are in steps. A row of `intervals` holds the begin and the end of a force and
    the opening, in steps; what has not happened yet is nan.
    """
    changes = [Status.PRESS, Status.GRAZE, Status.OPEN]
    statuses = np.broadcast_to(changes, intervals.shape)
    happens = ~np.isnan(intervals)
    tick = 1.0  # times are in steps, and stay so
    return episodes_of(intervals[happens], statuses[happens], tick)


def begin_of_force(force: Floats, gap: Floats, i: int) -> float:
    """Time at which the force begins that first presses in step i, in steps.

    It begins where the gap closes, if the gap goes on as in the step before; else with
    step i. A force in step i that is round-off beside that of the next step does not
    count: then it begins with the next step.
    """
    if i + 1 < len(force) and force[i] <= NEGLIGIBLE_FORCE_RATIO * force[i + 1]:
        return i + 1.0
    before = max(i - 1, 0)  # the step before, or the first one
    fall_per_step = gap[before] - gap[before + 1]
    if 0 < gap[i] < MAX_CLOSING_STEPS * fall_per_step:
        return i + float(gap[i] / fall_per_step)
    return float(i)


def end_of_force(force: Floats, gap: Floats, i: int, j: int) -> float:
    """Time at which the force ends that presses in the steps i to j - 1, in steps.

    The force of a compliant contact ends where its overlap does, on the parabola
    through the last three step ends. The force of a rigid contact drops to 0 inside its
    last step: with Fe extrapolated from the earlier step means and Fm the mean of the
    last step, it ends after the fraction Fm/Fe of that step. If it falls evenly, it
    ends where the line through the last means reaches 0. The force of a dashpot can end
    while there is overlap: it falls to 0 along a line from its value at the begin of
    the last step, which is extrapolated. If it pressed for less than three steps, it
    ends with the last one.
    """
    begin = j - 1  # begin of the last step with force
    first_gap = float(gap[j - 1])  # gaps at its begin and at its end
    last_gap = float(gap[j])
    if first_gap < 0 < last_gap:  # the overlap ends inside the step
        return begin + _closing_share(gap, i, j)
    if j - i >= 3:
        third = float(force[j - 3])
        second = float(force[j - 2])
        last = float(force[j - 1])
        fall = third - second
        last_fall = second - last
        if first_gap < 0:  # a dashpot lets go
            # Force at the begin of the last step; half of it, times the time in which
            # it falls to 0, is the mean of the step.
            extrapolated = second - fall / 2
            if extrapolated <= 0:
                return begin
            return begin + min(1.0, 2 * last / extrapolated)
        # It falls evenly: at least half and at most twice as fast as before.
        is_even = 0 < fall <= 2 * last_fall <= 4 * fall
        # It reaches 0 within a step of its last mean, which it has in the middle of the
        # last step.
        if is_even and last <= last_fall:
            return begin + 0.5 + last / last_fall
    if first_gap < 0:
        return begin + 1.0
    return begin + share_of_jump(force[max(i, j - 4) : j])


def _closing_share(gap: Floats, i: int, j: int) -> float:
    """Time in step j - 1 at which its overlap becomes 0, as a share of the step.

    The overlap must end there: gap[j - 1] < 0 < gap[j]. The force began in step i. The
    gap is the parabola through the last three step ends if it has pressed for three
    steps, else a line. With s the time in step j - 1, the gap is
    first_gap + rate (slope s + curve s^2).
    """
    first_gap = float(gap[j - 1])
    rate = float(gap[j]) - first_gap
    curve = 0.0
    if j - i >= 3:
        rate_before = first_gap - float(gap[j - 2])
        curve = (1 - rate_before / rate) / 2
    slope = 1 - curve
    depth_share = -first_gap / rate  # overlap at the begin, over its change in the step
    # Root of curve s^2 + slope s = depth_share, in the form that loses no digits
    root = math.sqrt(max(slope * slope + 4 * curve * depth_share, 0.0))
    return 2 * depth_share / (slope + root)


def share_of_jump(force: Floats) -> float:
    """Fraction Fm/Fe of the last step during which a force acts that ends with a jump.

    Fm is the mean of the last step, the last of `force`, and Fe is extrapolated from up
    to three means before: along a line if they are smooth, else it is the last of them.
    The fraction is 1 if Fe - Fm is at most twice the curvature of these means.
    """
    *before, last = force.tolist()
    extrapolated = 0.0
    curvature = 0.0
    if before:
        extrapolated = before[-1]
    is_smooth = len(before) > 1 and max(before) - min(before) <= JUMP_RATIO * before[-1]
    if is_smooth:
        extrapolated = 2 * before[-1] - before[-2]
        curvature = float(np.abs(np.diff(before, 2)).sum())
    if extrapolated - last <= 2 * curvature:
        return 1.0
    return float(last / extrapolated)


def _opening(gap: Floats, k: int, open_gap: float, force_end: float) -> float:
    """Time at which bodies part before step end k, in steps.

    At step end k their gap is larger than `open_gap`, m, for the first time since their
    force ended at `force_end`, in steps. Numerical dispersion opens small false gaps.
    Take the vertex of the parabola through the times t and s at which the gap passes
    `open_gap` and half of it, t - (t - s)/(1 - sqrt(1/2)). If the gap before the vertex
    did not accelerate, it is false, and the vertex is the opening; else the last zero
    of the gap is. A gap that accelerates is at a half of the time a quarter of what it
    is in the end, or less; a third is the bound.
    """
    last_zero = max(_passing_time(gap, k, 0.0), force_end)
    half = _passing_time(gap, k, open_gap / 2)
    passed = _passing_time(gap, k, open_gap)
    vertex = passed - (passed - half) / (1 - math.sqrt(0.5))
    midpoint = (last_zero + vertex) / 2
    at_midpoint, at_vertex = np.interp([midpoint, vertex], np.arange(len(gap)), gap)
    if vertex > last_zero and 3 * at_midpoint > at_vertex:
        return vertex
    return last_zero


def _passing_time(gap: Floats, k: int, level: float) -> float:
    """Last time before step end k at which a gap was at this level, in steps.

    At step end k the gap is larger. Gaps are straight lines between step ends. It is
    k - 1 if the gap was never so small.
    """
    for i in range(k - 1, -1, -1):
        if gap[i] <= level:  # it passes the level in step i
            return i + float((level - gap[i]) / (gap[i + 1] - gap[i]))
    return k - 1.0
