"""When contacts press and open, from mean forces in steps and gaps between them."""

from __future__ import annotations

import math

import numpy as np

from ..run import Episode
from ..signals import Floats, Ints
from .measure_kernel import begin_of_force, end_of_force


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
        begin = begin_of_force(times, force, gap, 0, len(force), i)
        running = j == len(force)
        end = math.nan if running else max(begin, end_of_force(times, force, gap, 0, i, j))
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
