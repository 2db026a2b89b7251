"""When contacts press and open, from mean forces in steps and gaps between them."""

from __future__ import annotations

import math

import numpy as np

from .run import Episode
from .signals import Floats, Ints

LATEST = 2.0  # steps, by which a gap can close later than its contact first presses
FAINT = 1e-6  # of the next mean force: what presses less is round-off
SMOOTH = 0.3  # relative change of forces from step to step, beyond which they jump


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
        begin = _begin_of_force(times, force, gap, i)
        running = j == len(force)
        end = math.nan if running else max(begin, _end_of_force(times, force, gap, i, j))
        spans.append((begin, end))
    return spans


def _pressing(force: Floats) -> list[tuple[int, int]]:
    """First and behind the last of the steps in which a contact presses without a break."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], force > 0, [False]))))
    return [(int(i), int(j)) for i, j in edges.reshape(-1, 2)]


def _begin_of_force(times: Floats, force: Floats, gap: Floats, i: int) -> float:
    """When the force begins that first presses in step i."""
    start, width = float(times[i]), float(times[i + 1] - times[i])
    if i + 1 < len(force) and force[i] <= FAINT * force[i + 1]:
        return start + width
    before = max(i - 1, 0)
    fell = float(gap[before] - gap[before + 1]) / float(times[before + 1] - times[before]) * width
    return start + (width * float(gap[i]) / fell if 0 < gap[i] < LATEST * fell else 0.0)


def _end_of_force(times: Floats, force: Floats, gap: Floats, i: int, j: int) -> float:
    """When the force ends that presses in the steps i to j - 1."""
    start, end = float(times[j - 1]), float(times[j])
    if gap[j - 1] < 0:
        through = gap[j - 1] / (gap[j - 1] - gap[j]) if gap[j] > 0 else 1.0
        return start + (end - start) * float(through)
    if j - i >= 3:
        middles = (times[j - 3 : j + 1] + times[j - 2 : j + 2]) / 2
        fall, last_fall = (-np.diff(force[j - 3 : j]) / np.diff(middles[:-1])).tolist()
        if 0 < fall <= 2 * last_fall <= 4 * fall:
            zero = float(middles[2] + force[j - 1] / last_fall)
            if zero <= middles[3]:
                return zero
    return start + (end - start) * _share_of_jump(force[max(i, j - 4) : j][::-1])


def _share_of_jump(force: Floats) -> float:
    """Share of its step that a force presses which jumps, from up to four means, its own first.

    All of it where the mean differs from what those beside lead to by no more than their curvature.
    """
    own, *beside = force.tolist()
    if not beside:
        return 1.0
    smooth = len(beside) > 1 and max(beside) - min(beside) <= SMOOTH * beside[0]
    led = 2 * beside[0] - beside[1] if smooth else beside[0]
    curvature = abs(beside[0] - 2 * beside[1] + beside[2]) if smooth and len(beside) > 2 else 0.0
    return 1.0 if led - own <= 2 * curvature else float(own / led)


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
        opening = max(_opening(times, gap, shut, int(far[k])), end) if opens else math.nan
        episodes.append(Episode(begin, end, opening))
    return tuple(episodes)


def _opening(times: Floats, gap: Floats, shut: Ints, k: int) -> float:
    """When a gap that is open at step end k was 0 for the last time; `shut` are all such ends."""
    last = int(np.searchsorted(shut, k)) - 1
    if last < 0:
        return float(times[max(k - 1, 0)])
    i = int(shut[last])
    share = float(gap[i] / (gap[i] - gap[i + 1]))
    return float(times[i]) + share * float(times[i + 1] - times[i])
