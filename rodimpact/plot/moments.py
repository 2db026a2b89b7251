"""The instants of a collision worth a picture, and what happens at them."""

from __future__ import annotations

import numpy as np

from ..methods.signals import Floats
from ..results.solution import Solution
from ..results.wave_fields import WaveFields
from .sampling import is_stepped

EVEN = 6  # instants of a solution in which nothing stands out


def moments(solution: Solution, most: int = 8) -> Floats:
    """Instructive times, s, at most `most` of them.

    The start and the end; every beginning and end of force and opening of a gap; waves half-way to
    their first reflection, and reflections as long as contacts last, if there is room. With a time
    step, waves change all the time, and the longest waits while contacts last are halved instead.
    """
    turns = _turns(solution)
    if is_stepped(solution):
        return _between(solution, turns, most)
    last = max(turns, default=solution.t_end)
    reflections = _reflections(solution, last)
    if not turns and reflections.size == 0:
        return np.unique(np.linspace(0.0, solution.t_end, 3))
    chosen = np.union1d(turns, [0.0, solution.t_end])
    if chosen.size > most:
        return _thinned(chosen, most)
    first = min(turns, default=0.0)
    after = reflections[reflections > first]
    if after.size and chosen.size < most:
        chosen = np.union1d(chosen, (first + after[0]) / 2)
    others = np.setdiff1d(reflections, chosen)
    chosen = np.union1d(chosen, _thinned(others, most - chosen.size))
    shortest = np.diff(np.union1d(first, after)).min(initial=np.inf)
    while chosen.size < most:
        inside = chosen[(chosen >= first) & (chosen <= last)]
        steps = np.diff(inside)
        if steps.max(initial=0.0) < 0.75 * shortest:
            break
        i = int(steps.argmax())
        chosen = np.union1d(chosen, (inside[i] + inside[i + 1]) / 2)
    return chosen


def _between(solution: Solution, turns: list[float], most: int) -> Floats:
    """Start, end, turns that are no crowd, and instants between them."""
    if not turns:
        return np.unique(np.linspace(0.0, solution.t_end, min(EVEN, most)))
    spacing = (max(turns) - min(turns)) / (2 * most)
    apart: list[float] = []
    for t in sorted(turns):
        if not apart or t - apart[-1] > spacing:
            apart.append(t)
    chosen = _thinned(np.union1d(apart, [0.0, solution.t_end]), most)
    open_at_end = any(c.episodes and not c.episodes[-1].opening <= solution.t_end
                      for c in solution.contacts)
    last = solution.t_end if open_at_end else max(turns)
    while chosen.size < most:
        inside = chosen[(chosen >= min(turns)) & (chosen <= last)]
        if inside.size < 2:
            inside = chosen
        i = int(np.diff(inside).argmax())
        chosen = np.union1d(chosen, (inside[i] + inside[i + 1]) / 2)
    return chosen


def happening(solution: Solution, t: float) -> str:
    """What happens at the contacts at time t: one line for each contact concerned."""
    several = len(solution.outcome.unilateral) > 1
    lines = []
    for contact in solution.contacts:
        for start, force_end, opening in contact.episodes:
            if t == start:
                said = "force begins"
            elif t == force_end == opening:
                said = "force ends, gap opens"
            elif t == force_end:
                said = "force ends"
            elif t == opening:
                said = "gap opens"
            else:
                continue
            lines.append(said + (f" at contact {contact.index}" if several else ""))
    return "\n".join(lines)


def _turns(solution: Solution) -> list[float]:
    """Times at which a contact begins, stops pressing, or opens."""
    return [t for contact in solution.contacts for episode in contact.episodes for t in episode
            if t == t]


def _reflections(solution: Solution, last: float) -> Floats:
    """Times up to `last` at which a changed wave leaves an end of a segment."""
    fields = solution.fields
    assert isinstance(fields, WaveFields)
    leaving = [signal.ticks for signal in fields.signals if signal is not None]
    ticks = np.unique(np.concatenate(leaving))
    times = ticks[ticks > 0] * fields.clock.tick
    early: Floats = times[times <= last]
    return early


def _thinned(times: Floats, most: int) -> Floats:
    """At most `most` of the times, evenly chosen, first and last among them."""
    if times.size <= most:
        return times
    chosen = np.linspace(0, times.size - 1, max(most, 0)).round().astype(int)
    kept: Floats = times[np.unique(chosen)]
    return kept
