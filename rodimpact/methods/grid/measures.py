"""What a force did that is known by its averages over steps, and gaps at step ends.

Its largest value, when it began and ended, and when contacts press and open. Times are counted in
steps; arrays of forces have an entry a step, N, those of gaps one more, m.
"""

import math

import numpy as np

from ..run import Episode, episodes_of
from ..signals import Floats
from ..states import Status

LATEST = 2.0  # steps, by which a gap can close later than its contact first presses
FAINT = 1e-6  # of the next mean force: what presses less is round-off
SMOOTH = 0.3  # relative change of forces from step to step, beyond which they jump
KINK = (
    4  # times less curvature of a parabola beside a jump or kink than of one across it
)
FLAT = 1e-9  # relative change of forces from step to step that is round-off


def largest_force(force: Floats) -> float:
    """Largest force behind averages, in the step of the largest one.

    It is that of the parabola with the averages of this step and of those around it; or, where that
    spans a jump or a kink, of this step and two before or behind it: if that has much less
    curvature, and is less curved than steep, or flat.
    """
    if np.max(force, initial=0.0) <= 0:
        return 0.0
    top = int(np.argmax(force))
    earlier, before, F, after, later = np.pad(force, 2)[top : top + 5].tolist()
    value, slope, curve = _parabola(before, F, after)
    begin, largest, least = 1, F, abs(curve)  # the step begins one behind the first
    for second, third in ((after, later), (before, earlier)):
        a, b, c = _parabola(F, second, third)
        if KINK * abs(c) < least and (
            abs(c) < abs(F - second) / 2 or abs(c) <= FLAT * F
        ):
            value, slope, curve, begin, least = a, b, c, 0, KINK * abs(c)
            largest = max(a, a + b + c)
    if curve < 0 and begin < -slope / (2 * curve) < begin + 1:
        largest = value - slope * slope / (4 * curve)
    return float(largest)


def _parabola(first: float, second: float, third: float) -> tuple[float, float, float]:
    """Value, slope and curvature, where the first step begins, for averages of three steps."""
    curve = (first - 2 * second + third) / 2
    slope = second - first - 2 * curve
    return first - slope / 2 - curve / 3, slope, curve


def pressings(force: Floats, gap: Floats, least: float) -> Floats:
    """[n, 3] when a contact begins and ceases to press, and has opened before it presses again.

    A gap has opened once it passes `least`, m. What does not come is nan.
    """
    edges = np.flatnonzero(np.diff(force > 0, prepend=False, append=False)).tolist()
    far, ends, found = np.flatnonzero(gap > least), [*edges, len(force)], []
    for i, j, following in zip(edges[::2], edges[1::2], ends[2::2], strict=True):
        begin, end, opening = begin_of_force(force, gap, i), math.nan, math.nan
        if j < len(force):
            end = max(begin, end_of_force(force, gap, i, j))
        opened = far[np.searchsorted(far, j) :][:1]
        if opened.size and opened[0] <= following:
            opening = _parting(gap, int(opened[0]), least, end)
        found.append((begin, end, opening))
    return np.array(found).reshape(-1, 3)


def touchings(pressed: Floats) -> tuple[Episode, ...]:
    """From the first force until a gap has opened."""
    statuses = np.broadcast_to([Status.PRESS, Status.GRAZE, Status.OPEN], pressed.shape)
    known = ~np.isnan(pressed)
    return episodes_of(pressed[known], statuses[known], 1.0)


def begin_of_force(force: Floats, gap: Floats, i: int) -> float:
    """When the force begins that first presses in step i.

    A contact begins where its gap is closed that goes on as in the step before.
    """
    if i + 1 < len(force) and force[i] <= FAINT * force[i + 1]:
        return i + 1.0
    before = max(i - 1, 0)
    fell = gap[before] - gap[before + 1]
    return i + float(gap[i] / fell) if 0 < gap[i] < LATEST * fell else float(i)


def end_of_force(force: Floats, gap: Floats, i: int, j: int) -> float:
    """When the force ends that presses in the steps i to j - 1.

    That of a compliant contact ends where its indentation does, on the parabola through the last
    three step ends. The force of a rigid one ends with a jump inside its last step: after that
    share of it which its mean is of what the means before lead to. If it falls evenly, it ends
    where the line through the last means reaches 0. A dashpot lets go while there is an
    indentation, where the force has fallen to 0 from what means lead to.
    """
    begin, start, stop = j - 1, float(gap[j - 1]), float(gap[j])
    if start < 0 < stop:
        rate = stop - start
        curve = (1 - (start - float(gap[j - 2])) / rate) / 2 if j - i >= 3 else 0.0
        slope, depth = 1 - curve, -start / rate
        root = math.sqrt(max(slope * slope + 4 * curve * depth, 0.0))
        return begin + 2 * depth / (slope + root)
    if j - i >= 3:
        third, second, last = (float(F) for F in force[j - 3 : j])
        fall, last_fall = third - second, second - last
        if start < 0:
            led = second - fall / 2
            return begin + min(1.0, 2 * last / led) if led > 0 else begin
        if 0 < fall <= 2 * last_fall <= 4 * fall and last <= last_fall:
            return begin + 0.5 + last / last_fall
    return begin + (1.0 if start < 0 else share_of_jump(force[max(i, j - 4) : j]))


def share_of_jump(force: Floats) -> float:
    """Share of the last step that a force presses which jumps, from up to four means.

    All of it where the mean differs from what those before lead to by no more than their curvature.
    """
    *before, last = force.tolist()
    led, curvature = before[-1] if before else 0.0, 0.0
    if len(before) > 1 and max(before) - min(before) <= SMOOTH * led:
        led, curvature = 2 * led - before[-2], float(np.abs(np.diff(before, 2)).sum())
    return 1.0 if led - last <= 2 * curvature else last / led


def _parting(gap: Floats, k: int, least: float, end: float) -> float:
    """When bodies part whose force ends, and whose gap passes `least` before step end k.

    Dispersed waves hold bodies that touch a little apart: a gap that has not grown faster and
    faster since it left 0 was of their making. Bodies then part at t - (t - s)/(1 - sqrt(1/2)), t
    and s when the gap passed `least` and half of it, as on a parabola.
    """
    left, half, passed = (_passed(gap, k, level) for level in (0.0, least / 2, least))
    left = max(left, end)
    parting = passed - (passed - half) / (1 - math.sqrt(0.5))
    halfway, then = np.interp([(left + parting) / 2, parting], np.arange(len(gap)), gap)
    return parting if parting > left and 3 * halfway > then else left


def _passed(gap: Floats, k: int, level: float) -> float:
    """When a gap that is more at step end k was at this level for the last time."""
    i = next((i for i in range(k - 1, -1, -1) if gap[i] <= level), None)
    return k - 1.0 if i is None else i + float((level - gap[i]) / (gap[i + 1] - gap[i]))
