"""What a force did that is known by its averages over steps, and gaps at step ends.

Its largest value, when it began and ended, and when contacts press and open. Times are counted in
steps; arrays of forces have an entry a step, N, those of gaps one more, m.
"""

from __future__ import annotations

import math

import numpy as np

from ..signals import Floats, Ints

LATEST = 2.0  # steps, by which a gap can close later than its contact first presses
FAINT = 1e-6  # of the next mean force: what presses less is round-off
SMOOTH = 0.3  # relative change of forces from step to step, beyond which they jump
KINK = 4  # times less curvature of a parabola beside a jump or kink than of one across it
FLAT = 1e-9  # relative change of forces from step to step that is round-off


def largest_force(force: Floats) -> float:
    """Largest force behind averages, in the step of the largest one."""
    if np.max(force, initial=0.0) <= 0:
        return 0.0
    top = int(np.argmax(force))
    a, b, c, central = force_in_step(force, top)
    F = force[top] if central else max(a, a + b + c)
    if c < 0 and 0 < -b / (2 * c) < 1:
        F = a - b * b / (4 * c)
    return float(F)


def force_in_step(force: Floats, j: int) -> tuple[float, float, float, bool]:
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
    a, b, c = parabola(force, j - 1, 1)
    best, central, least = (a + b + c, b + 2 * c, c), True, abs(c)
    for way in (1, -1):
        first, second, third = (mean_force(force, j + n * way) for n in range(3))
        rate, bend = (first - second) / 2, abs(first - 2 * second + third) / 2
        value, slope, curve = parabola(force, j, way)
        if KINK * abs(curve) < least and (bend < abs(rate) or bend <= FLAT * first):
            best, central, least = (value, slope, curve), False, KINK * abs(curve)
            if way < 0:
                best = (value + slope + curve, -slope - 2 * curve, curve)
    return *best, central


def mean_force(force: Floats, j: int) -> float:
    """Force in step j, 0 before the first and behind the last."""
    return float(force[j]) if 0 <= j < len(force) else 0.0


def parabola(force: Floats, j: int, way: int) -> tuple[float, float, float]:
    """Coefficients of the parabola with the averages of three steps, from where step j begins.

    With way -1 from its end, backwards.
    """
    first, second, third = (mean_force(force, j + n * way) for n in range(3))
    curve = (first - 2 * second + third) / 2
    slope = second - first - 2 * curve
    return first - slope / 2 - curve / 3, slope, curve


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

    That of a compliant contact ends where its indentation does. The force of a rigid one ends with
    a jump inside its last step: after that share of it which its mean is of what the means before
    lead to. If it falls evenly, it ends where the line through the last means reaches 0. A dashpot
    lets go while there is an indentation, where the force has fallen to 0 from what means lead to.
    """
    begin, start, stop = j - 1, float(gap[j - 1]), float(gap[j])
    if start < 0 < stop:
        rate, curve = stop - start, 0.0
        if j - i >= 3:
            curve = (rate - (start - float(gap[j - 2]))) / 2
        x = line = -start / rate
        for _ in range(4):  # where the parabola through three step ends is 0
            slope = rate + curve * (x - 1)
            x = -start / slope if slope > 0 else line
        return begin + (x if 0 < x < 1 else line)
    if j - i >= 3:
        fall = float(force[j - 3] - force[j - 2])
        if start < 0:
            led = float(force[j - 2]) - fall / 2
            return begin + min(1.0, 2 * float(force[j - 1]) / led) if led > 0 else begin
        last_fall = float(force[j - 2] - force[j - 1])
        if 0 < fall <= 2 * last_fall <= 4 * fall and force[j - 1] <= last_fall:
            return begin + 0.5 + float(force[j - 1]) / last_fall
    return begin + (1.0 if start < 0 else share_of_jump(force, i, j))


def share_of_jump(force: Floats, i: int, j: int) -> float:
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


def pressed_spans(force: Floats, gap: Floats) -> list[tuple[float, float]]:
    """When a contact begins and ceases to press; nan for an end that does not come."""
    spans = []
    for i, j in _pressing(force):
        begin = begin_of_force(force, gap, i)
        end = math.nan if j == len(force) else max(begin, end_of_force(force, gap, i, j))
        spans.append((begin, end))
    return spans


def _pressing(force: Floats) -> list[tuple[int, int]]:
    """First and behind the last of the steps in which a contact presses without a break."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], force > 0, [False]))))
    return [(int(i), int(j)) for i, j in edges.reshape(-1, 2)]


def episodes_of_steps(
    force: Floats, gap: Floats, least: float, spans: list[tuple[float, float]]
) -> list[tuple[float, float, float]]:
    """Touchings that carried force, from the first force until a gap has opened: an `Episode` each.

    A gap has opened once it passes `least`, m, if it does so before the next force; `spans` are
    those of `pressed_spans`.
    """
    steps = _pressing(force)
    far, shut = np.flatnonzero(gap > least), np.flatnonzero(gap <= 0)
    episodes: list[tuple[float, float, float]] = []
    for n, ((_, j), (begin, end)) in enumerate(zip(steps, spans, strict=True)):
        if episodes and math.isnan(episodes[-1][2]):
            begin = episodes.pop()[0]
        k = int(np.searchsorted(far, j))
        last = steps[n + 1][0] if n + 1 < len(steps) else len(force)
        opening = math.nan
        if k < len(far) and far[k] <= last:
            left = max(_opening(gap, shut, int(far[k])), end)
            opening = _parting(gap, int(far[k]), least, left)
        episodes.append((begin, end, opening))
    return episodes


def _parting(gap: Floats, k: int, least: float, left: float) -> float:
    """When bodies part whose gap left 0 at the time `left` and passes `least` before step end k.

    Dispersed waves hold bodies that touch a little apart: a gap that has not grown faster and
    faster since it left 0 was of their making. Bodies then part at t - (t - s)/(1 - sqrt(1/2)), t
    and s when the gap passed `least` and half of it, as on a parabola.
    """
    passed = [k - 1.0] * 2
    for i, level in enumerate((least, least / 2)):
        j = k
        while j > 0 and gap[j - 1] > level:
            j -= 1
        if j > 0:
            passed[i] = j - 1 + float((level - gap[j - 1]) / (gap[j] - gap[j - 1]))
    parting = passed[0] - (passed[0] - passed[1]) / (1 - math.sqrt(0.5))
    halfway, then = np.interp([(left + parting) / 2, parting], np.arange(len(gap)), gap)
    return parting if parting > left and 3 * halfway > then else left


def _opening(gap: Floats, shut: Ints, k: int) -> float:
    """When a gap that is open at step end k was 0 for the last time; `shut` are all such ends."""
    last = int(np.searchsorted(shut, k)) - 1
    if last < 0:
        return max(k - 1.0, 0.0)
    i = int(shut[last])
    return i + float(gap[i] / (gap[i] - gap[i + 1]))
