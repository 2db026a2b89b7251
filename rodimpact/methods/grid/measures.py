"""What a force did that is known by its averages over steps, and gaps at step ends.

Its largest value, when it began and ended, and when contacts press and open. Arrays have an entry a
step, `times` (s) and `gap` (m) one more.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..run import Episode
from ..signals import Floats, Ints

LATEST = 2.0  # steps, by which a gap can close later than its contact first presses
FAINT = 1e-6  # of the next mean force: what presses less is round-off
SMOOTH = 0.3  # relative change of forces from step to step, beyond which they jump
KINK = 4  # times less curvature of a parabola beside a jump or kink than of one across it
FLAT = 1e-9  # relative change of forces from step to step that is round-off


def largest_force(times: Any, force: Any) -> float:
    """Largest force behind averages, in the step of the largest one."""
    if np.max(force, initial=0.0) <= 0:
        return 0.0
    top = int(np.argmax(force))
    a, b, c, central = force_in_step(times, force, top)
    d, F = times[top + 1] - times[top], mean_force(force, top)
    if not central:
        F = max(a, a + b * d + c * d * d)
    if c < 0 and 0 < -b / (2 * c) < d:
        F = a - b * b / (4 * c)
    return float(F)


def force_in_step(times: Any, force: Any, j: int) -> tuple[float, float, float, bool]:
    """Coefficients of a parabola for the force from where step j begins, from averages.

    That with the averages of step j and of those around it; or, where that spans a jump or a kink,
    of step j and two before or behind it: if that has much less curvature, and is less curved than
    steep, or flat.

    Returns
    -------
    value, slope, curve : float
        Of value + slope x + curve x^2.
    central : bool
        Whether step j is in the middle.
    """
    d, before = width_of(times, j), width_of(times, j - 1)
    a, b, c = parabola(times, force, j - 1, 1)
    best = (a + b * before + c * before * before, b + 2 * c * before, c)
    central, least = True, abs(c)
    first = mean_force(force, j)
    for way in (1, -1):
        middle, far = width_of(times, j + way), width_of(times, j + 2 * way)
        second, third = mean_force(force, j + way), mean_force(force, j + 2 * way)
        rate, next_rate = (first - second) / (d + middle), (second - third) / (middle + far)
        bend = abs(rate - next_rate)
        value, slope, curve = parabola(times, force, j, way)
        if KINK * abs(curve) < least and (bend < abs(rate) or bend * d <= FLAT * first):
            best, central = (value, slope, curve), False
            if way < 0:
                best = (value + slope * d + curve * d * d, -slope - 2 * curve * d, curve)
            least = KINK * abs(curve)
    return best[0], best[1], best[2], central


def mean_force(force: Any, j: int) -> float:
    """Force in step j, 0 before the first and behind the last."""
    F: float = 0.0
    if 0 <= j < len(force):
        F = force[j]
    return F


def width_of(times: Any, j: int) -> float:
    """Duration of step j, or of the nearest one."""
    j = max(0, min(len(times) - 2, j))
    width: float = times[j + 1] - times[j]
    return width


def parabola(times: Any, force: Any, j: int, way: int) -> tuple[float, float, float]:
    """Coefficients of the parabola with the averages of three steps, from where step j begins.

    With way -1 from its end, backwards. Divided differences of the averages over widths a, b, c.
    """
    first, second, third = (
        mean_force(force, j), mean_force(force, j + way), mean_force(force, j + 2 * way))
    a, b, c = width_of(times, j), width_of(times, j + way), width_of(times, j + 2 * way)
    rate, next_rate = (second - first) / (a + b), (third - second) / (b + c)
    curve = 3 * (next_rate - rate) / (a + b + c)
    slope = 2 * rate - curve * (2 * a + b) / 1.5
    value = first - slope * a / 2 - curve * a * a / 3
    return value, slope, curve


def begin_of_force(times: Any, force: Any, gap: Any, i: int) -> float:
    """When the force begins that first presses in step i, s.

    A contact begins where its gap is closed that goes on as in the step before.
    """
    begin: float = times[i]
    width: float = times[i + 1] - begin
    if i + 1 < len(force) and force[i] <= FAINT * force[i + 1]:
        return begin + width
    before = max(i - 1, 0)
    fell = (gap[before] - gap[before + 1]) / (times[before + 1] - times[before]) * width
    if 0 < gap[i] < LATEST * fell:
        begin += width * gap[i] / fell
    return begin


def end_of_force(times: Any, force: Any, gap: Any, i: int, j: int) -> float:
    """When the force ends that presses in the steps i to j - 1, s.

    That of a compliant contact ends where its indentation does. The force of a rigid one ends with
    a jump inside its last step: after that share of it which its mean is of what the means before
    lead to. If it falls evenly, it ends where the line through the last means reaches 0. A dashpot
    lets go while there is an indentation, where the force has fallen to 0 from what means lead to.
    """
    begin: float = times[j - 1]
    width: float = times[j] - begin
    if gap[j - 1] < 0 < gap[j]:
        rate: float = (gap[j] - gap[j - 1]) / width
        line, curve = -gap[j - 1] / rate, 0.0
        if j - i >= 3:
            before = begin - times[j - 2]
            curve = (rate - (gap[j - 1] - gap[j - 2]) / before) / (width + before)
        x = line
        for _ in range(4):  # where the parabola through three step ends is 0
            slope = rate + curve * (x - width)
            x = -gap[j - 1] / slope if slope > 0 else line
        return float(begin + (x if 0 < x < width else line))
    if j - i >= 3:
        fall = (force[j - 3] - force[j - 2]) / ((times[j - 1] - times[j - 3]) / 2)
        if gap[j - 1] < 0:
            led = force[j - 2] - fall * (begin - times[j - 2]) / 2
            return float(begin + width * min(1.0, 2 * force[j - 1] / led)) if led > 0 else begin
        last_fall = (force[j - 2] - force[j - 1]) / ((times[j] - times[j - 2]) / 2)
        if 0 < fall <= 2 * last_fall <= 4 * fall:
            zero = (times[j - 1] + times[j]) / 2 + force[j - 1] / last_fall
            if zero <= (times[j] + times[j + 1]) / 2:
                return float(zero)
    if gap[j - 1] < 0:
        return begin + width
    return begin + width * share_of_jump(force, i, j)


def share_of_jump(force: Any, i: int, j: int) -> float:
    """Share of step j - 1 that a force presses which jumps, from up to four means.

    All of it where the mean differs from what those before lead to by no more than their curvature.
    """
    count = min(j - i, 4)
    if count < 2:
        return 1.0
    own, first = force[j - 1], force[j - 2]
    if count == 2:
        return 1.0 if first <= own else own / first
    second, third = force[j - 3], force[j - 3] if count == 3 else force[j - 4]
    spread = max(first, second, third) - min(first, second, third)
    if spread > SMOOTH * first:
        return 1.0 if first <= own else own / first
    led = 2 * first - second
    curvature = 0.0 if count == 3 else abs(first - 2 * second + third)
    return 1.0 if led - own <= 2 * curvature else own / led


def pressed_spans(times: Floats, force: Floats, gap: Floats) -> list[tuple[float, float]]:
    """When a contact presses, from the mean force in each step and the gaps at step ends.

    A contact begins where its gap is closed that goes on as in the step before. A compliant one
    ends where its indentation does. The force of a rigid one ends with a jump inside its last step:
    after that share of it which its mean is of what the means before lead to. If it falls evenly,
    it ends where the line through the last means reaches 0.

    Parameters
    ----------
    times : [steps + 1] array
        Ends of steps, s.
    force, gap : [steps], [steps + 1] arrays
        N and m.

    Returns
    -------
    list of (float, float)
        Begin and end of each, s; nan for an end that does not come before the last time.
    """
    spans = []
    for i, j in _pressing(force):
        begin = begin_of_force(times, force, gap, i)
        running = j == len(force)
        end = math.nan if running else max(begin, end_of_force(times, force, gap, i, j))
        spans.append((float(begin), float(end)))
    return spans


def _pressing(force: Floats) -> list[tuple[int, int]]:
    """First and behind the last of the steps in which a contact presses without a break."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], force > 0, [False]))))
    return [(int(i), int(j)) for i, j in edges.reshape(-1, 2)]


def episodes_of_steps(
    times: Floats, force: Floats, gap: Floats, least: float, spans: list[tuple[float, float]]
) -> tuple[Episode, ...]:
    """Touchings that carried force: from the first force until a gap has opened.

    A gap has opened once it passes `least`, m, if it does so before the next force; `spans` are
    those of `pressed_spans`, of which the other arguments are.
    """
    steps = _pressing(force)
    far, shut = np.flatnonzero(gap > least), np.flatnonzero(gap <= 0)
    episodes: list[Episode] = []
    for n, ((_, j), (begin, end)) in enumerate(zip(steps, spans, strict=True)):
        if episodes and math.isnan(episodes[-1].opening):
            begin = episodes.pop().start
        k = int(np.searchsorted(far, j))
        last = steps[n + 1][0] if n + 1 < len(steps) else len(force)
        opens = k < len(far) and far[k] <= last
        opening = math.nan
        if opens:
            opening = max(_opening(times, gap, shut, int(far[k])), end)
            opening = _parting(times, gap, int(far[k]), least, opening)
        episodes.append(Episode(begin, end, opening))
    return tuple(episodes)


def _parting(times: Floats, gap: Floats, k: int, least: float, left: float) -> float:
    """When bodies part whose gap left 0 at the time `left` and passes `least` before step end k.

    Dispersed waves hold bodies that touch a little apart: a gap that has not grown faster and
    faster since it left 0 was of their making. Bodies then part at t - (t - s)/(1 - sqrt(1/2)), t
    and s when the gap passed `least` and half of it, as on a parabola.
    """
    passed = [float(times[k - 1])] * 2
    for i, level in enumerate((least, least / 2)):
        j = k
        while j > 0 and gap[j - 1] > level:
            j -= 1
        if j > 0:
            share = float((level - gap[j - 1]) / (gap[j] - gap[j - 1]))
            passed[i] = float(times[j - 1]) + share * float(times[j] - times[j - 1])
    parting = passed[0] - (passed[0] - passed[1]) / (1 - math.sqrt(0.5))
    halfway, then = np.interp([(left + parting) / 2, parting], times, gap)
    return parting if parting > left and 3 * halfway > then else left


def _opening(times: Floats, gap: Floats, shut: Ints, k: int) -> float:
    """When a gap that is open at step end k was 0 for the last time; `shut` are all such ends."""
    last = int(np.searchsorted(shut, k)) - 1
    if last < 0:
        return float(times[max(k - 1, 0)])
    i = int(shut[last])
    share = float(gap[i] / (gap[i] - gap[i + 1]))
    return float(times[i]) + share * float(times[i + 1] - times[i])
