"""The instants of a collision worth a picture, and what happens at them."""

from __future__ import annotations

import numpy as np

from ..methods.signals import Floats
from ..results.solution import Solution
from ..results.wave_fields import WaveFields
from .sampling import is_stepped
from .thinning import evenly

EVEN = 6  # instants of a solution in which nothing stands out


def moments(solution: Solution, most: int = 8) -> Floats:
    """Instructive times, s, at most `most` of them.

    The start and the end; every beginning and end of force and opening of a gap; waves half-way to
    their first reflection, and reflections as long as contacts last, if there is room. With a time
    step, waves change all the time, and the longest waits while contacts last are halved instead.
    """
    turns = contact_turns(solution)
    if is_stepped(solution):
        return _between(solution, turns, most)
    last = max(turns, default=solution.t_end)
    reflections = _reflections(solution, last)
    if not turns and reflections.size == 0:
        return np.unique(np.linspace(0.0, solution.t_end, 3))
    chosen = np.union1d(turns, [0.0, solution.t_end])
    if chosen.size > most:
        return chosen[evenly(chosen.size, most)]
    first = min(turns, default=0.0)
    after = reflections[reflections > first]
    if after.size and chosen.size < most:
        chosen = np.union1d(chosen, (first + after[0]) / 2)
    others = np.setdiff1d(reflections, chosen)
    chosen = np.union1d(chosen, others[evenly(others.size, most - chosen.size)])
    shortest = float(np.diff(np.union1d(first, after)).min(initial=np.inf))
    return _halved(chosen, first, last, most, 0.75 * shortest)


def _between(solution: Solution, turns: list[float], most: int) -> Floats:
    """Start, end, turns that are no crowd, and instants between them."""
    if not turns:
        return np.unique(np.linspace(0.0, solution.t_end, min(EVEN, most)))
    spacing = (max(turns) - min(turns)) / (2 * most)
    apart: list[float] = []
    for t in sorted(turns):
        if not apart or t - apart[-1] > spacing:
            apart.append(t)
    chosen = np.union1d(apart, [0.0, solution.t_end])
    chosen = chosen[evenly(chosen.size, most)]
    open_at_end = any(c.episodes and not c.episodes[-1].opening <= solution.t_end
                      for c in solution.contacts)
    return _halved(chosen, min(turns), solution.t_end if open_at_end else max(turns), most)


def _halved(
    chosen: Floats, first: float, last: float, most: int, shortest: float = 0.0
) -> Floats:
    """Instants, and middles of the longest waits between `first` and `last` if not too short."""
    while chosen.size < most:
        inside = chosen[(chosen >= first) & (chosen <= last)]
        if inside.size < 2 and not shortest:
            inside = chosen
        waits = np.diff(inside)
        if waits.max(initial=0.0) < shortest:
            break
        i = int(waits.argmax())
        chosen = np.union1d(chosen, (inside[i] + inside[i + 1]) / 2)
    return chosen


def happening(solution: Solution, t: float) -> str:
    """What happens at the contacts at time t: one line for each contact concerned."""
    several = len(solution.outcome.unilateral) > 1
    lines = []
    for contact in solution.contacts:
        where = f" at contact {contact.index}" if several else ""
        for start, force_end, opening in contact.episodes:
            ends = ((force_end, "force ends"), (opening, "gap opens"))
            event = "force begins" if t == start else ", ".join(
                what for when, what in ends if t == when)
            if event:
                lines.append(event + where)
    return "\n".join(lines)


def contact_turns(solution: Solution) -> list[float]:
    """Times at which a contact begins, stops pressing, or opens."""
    return [t for contact in solution.contacts for episode in contact.episodes for t in episode
            if t == t]


def _reflections(solution: Solution, last: float) -> Floats:
    """Times up to `last` at which a changed wave leaves an end of a segment."""
    fields = solution.fields
    assert isinstance(fields, WaveFields)
    ticks = np.unique(np.concatenate([s.ticks for s in fields.signals if s is not None]))
    times = ticks[ticks > 0] * fields.clock.tick
    return np.asarray(times[times <= last])
