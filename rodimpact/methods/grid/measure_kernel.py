"""What a force did that is known by its averages over steps, and gaps at step ends.

Its largest value, and when it began and ended. Arrays have an
entry a step, `times` (s) and `gap` (m) one more; `start` is where a signal's first step stands.
"""

from __future__ import annotations

from typing import Any

LATEST = 2.0  # steps, by which a gap can close later than its contact first presses
FAINT = 1e-6  # of the next mean force: what presses less is round-off
SMOOTH = 0.3  # relative change of forces from step to step, beyond which they jump
KINK = 4  # times less curvature of a parabola beside a jump or kink than of one across it
FLAT = 1e-9  # relative change of forces from step to step that is round-off


def largest_force(times: Any, force: Any, start: int, steps: int) -> float:
    """Largest force behind averages, in the step of the largest one."""
    top = 0
    for j in range(steps):
        if force[start + j] > force[start + top]:
            top = j
    if steps == 0 or force[start + top] <= 0:
        return 0.0
    a, b, c, central = force_in_step(times, force, start, steps, top)
    d, F = times[top + 1] - times[top], mean_force(force, start, steps, top)
    if not central:
        F = max(a, a + b * d + c * d * d)
    if c < 0 and 0 < -b / (2 * c) < d:
        F = a - b * b / (4 * c)
    return F


def force_in_step(
    times: Any, force: Any, start: int, steps: int, j: int
) -> tuple[float, float, float, bool]:
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
    d, before = width_of(times, steps, j), width_of(times, steps, j - 1)
    a, b, c = parabola(times, force, start, steps, j - 1, 1)
    best = (a + b * before + c * before * before, b + 2 * c * before, c)
    central, least = True, abs(c)
    first = mean_force(force, start, steps, j)
    for way in (1, -1):
        middle, far = width_of(times, steps, j + way), width_of(times, steps, j + 2 * way)
        second, third = (mean_force(force, start, steps, j + way),
                         mean_force(force, start, steps, j + 2 * way))
        rate, next_rate = (first - second) / (d + middle), (second - third) / (middle + far)
        bend = abs(rate - next_rate)
        value, slope, curve = parabola(times, force, start, steps, j, way)
        if KINK * abs(curve) < least and (bend < abs(rate) or bend * d <= FLAT * first):
            best, central = (value, slope, curve), False
            if way < 0:
                best = (value + slope * d + curve * d * d, -slope - 2 * curve * d, curve)
            least = KINK * abs(curve)
    return best[0], best[1], best[2], central


def mean_force(force: Any, start: int, steps: int, j: int) -> float:
    """Force in step j, 0 before the first and behind the last."""
    F: float = 0.0
    if 0 <= j < steps:
        F = force[start + j]
    return F


def width_of(times: Any, steps: int, j: int) -> float:
    """Duration of step j, or of the nearest one."""
    j = max(0, min(steps - 1, j))
    width: float = times[j + 1] - times[j]
    return width


def parabola(
    times: Any, force: Any, start: int, steps: int, j: int, way: int
) -> tuple[float, float, float]:
    """Coefficients of the parabola with the averages of three steps, from where step j begins.

    With way -1 from its end, backwards. Divided differences of the averages over widths a, b, c.
    """
    first, second, third = (
        mean_force(force, start, steps, j), mean_force(force, start, steps, j + way),
        mean_force(force, start, steps, j + 2 * way),
    )
    a, b, c = (width_of(times, steps, j), width_of(times, steps, j + way),
               width_of(times, steps, j + 2 * way))
    rate, next_rate = (second - first) / (a + b), (third - second) / (b + c)
    curve = 3 * (next_rate - rate) / (a + b + c)
    slope = 2 * rate - curve * (2 * a + b) / 1.5
    value = first - slope * a / 2 - curve * a * a / 3
    return value, slope, curve


def begin_of_force(
    times: Any, force: Any, gap: Any, start: int, steps: int, i: int
) -> float:
    """When the force begins that first presses in step i, s.

    A contact begins where its gap is closed that goes on as in the step before.
    """
    begin: float = times[i]
    width: float = times[i + 1] - begin
    if i + 1 < steps and force[start + i] <= FAINT * force[start + i + 1]:
        return begin + width
    before = max(i - 1, 0)
    fell = (gap[before] - gap[before + 1]) / (times[before + 1] - times[before]) * width
    if 0 < gap[i] < LATEST * fell:
        begin += width * gap[i] / fell
    return begin


def end_of_force(
    times: Any, force: Any, gap: Any, start: int, i: int, j: int
) -> float:
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
    p = start + j
    if j - i >= 3:
        fall = (force[p - 3] - force[p - 2]) / ((times[j - 1] - times[j - 3]) / 2)
        if gap[j - 1] < 0:
            led = force[p - 2] - fall * (begin - times[j - 2]) / 2
            return float(begin + width * min(1.0, 2 * force[p - 1] / led)) if led > 0 else begin
        last_fall = (force[p - 2] - force[p - 1]) / ((times[j] - times[j - 2]) / 2)
        if 0 < fall <= 2 * last_fall <= 4 * fall:
            zero = (times[j - 1] + times[j]) / 2 + force[p - 1] / last_fall
            if zero <= (times[j] + times[j + 1]) / 2:
                return float(zero)
    if gap[j - 1] < 0:
        return begin + width
    return begin + width * share_of_jump(force, start, i, j)


def share_of_jump(force: Any, start: int, i: int, j: int) -> float:
    """Share of step j - 1 that a force presses which jumps, from up to four means.

    All of it where the mean differs from what those before lead to by no more than their curvature.
    """
    p, count = start + j, min(j - i, 4)
    if count < 2:
        return 1.0
    own, first = force[p - 1], force[p - 2]
    if count == 2:
        return 1.0 if first <= own else own / first
    second, third = force[p - 3], force[p - 3] if count == 3 else force[p - 4]
    spread = max(first, second, third) - min(first, second, third)
    if spread > SMOOTH * first:
        return 1.0 if first <= own else own / first
    led = 2 * first - second
    curvature = 0.0 if count == 3 else abs(first - 2 * second + third)
    return 1.0 if led - own <= 2 * curvature else own / led
