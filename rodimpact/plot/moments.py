"""Instants of a collision for snapshots, the events at contacts, and their names."""

import math
from typing import Any

import numpy as np

from ..methods.signals import Floats
from ..model import Rod, System
from ..model.numbering import body_numbers, contact_names
from ..results.solution import Solution
from .sampling import evenly, is_stepped

FEWEST = 3  # instants of a solution in which nothing stands out
CROWD = 0.5  # of an even spacing: how near happenings may come on a time step
SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
TRIPS = 9  # whole round trips that are named, at most
ALIKE = 1e-6  # relative difference of times that are the same


def moments(solution: Solution, most: int = 8) -> Floats:
    """Instructive times, s, at most `most` of them.

    The times are the start and the end, each beginning and end of a force, each opening of a gap,
    waves half-way to their first reflection, and reflections while contacts last. The middles of
    the longest intervals are added. Solutions with a time step have no reflections.
    """
    turns: Floats = np.unique(contact_turns(solution))
    closed = any(
        c.episodes and not c.episodes[-1].opening <= solution.t_end
        for c in solution.contacts
    )
    fields: Any = solution.fields
    first = float(turns[0]) if turns.size else 0.0
    last = solution.t_end if closed or not turns.size else float(turns[-1])
    reflections: Floats = np.empty(
        0
    )  # times at which a changed wave leaves an end of a segment
    if is_stepped(solution):
        near = np.diff(turns, prepend=-np.inf) < CROWD * (last - first) / most
        turns = turns[~near]
    else:
        ticks = np.concatenate([s.ticks for s in fields.motion.lines if s is not None])
        times = np.unique(ticks) * fields.clock.tick
        reflections = times[(times > 0) & (times <= last)]
    most = most if turns.size or reflections.size else FEWEST
    chosen = np.union1d(turns, [0.0, solution.t_end])
    chosen = chosen[evenly(chosen.size, most)]
    after = reflections[reflections > first]
    if after.size and chosen.size < most:
        chosen = np.union1d(chosen, (first + after[0]) / 2)
    others = np.setdiff1d(reflections, chosen)
    chosen = np.union1d(chosen, others[evenly(others.size, most - chosen.size)])
    shortest = 0.75 * float(np.diff(np.union1d(first, after)).min(initial=np.inf))
    while (
        chosen.size < most
    ):  # the middles of the longest waits, if these are not too short
        inside = chosen[(chosen >= first) & (chosen <= last)]
        waits = np.diff(inside)
        if waits.max(initial=0.0) <= (shortest if after.size else 0.0):
            break
        i = int(waits.argmax())
        chosen = np.union1d(chosen, (inside[i] + inside[i + 1]) / 2)
    return chosen


def happening(solution: Solution, t: float) -> str:
    """What happens at the contacts at time t: one line for each contact concerned."""
    several = len(solution.outcome.unilateral) > 1
    names = contact_names(solution.system.kinds)
    lines = []
    for contact in solution.contacts:
        where = f" at contact {names[contact.index]}" if several else ""
        for start, force_end, opening in contact.episodes:
            ends = ((force_end, "force ends"), (opening, "gap opens"))
            event = (
                "force begins"
                if t == start
                else ", ".join(what for when, what in ends if t == when)
            )
            if event:
                lines.append(event + where)
    return "\n".join(lines)


def contact_turns(solution: Solution) -> list[float]:
    """Times at which a contact begins, stops pressing, or opens."""
    return [
        t
        for contact in solution.contacts
        for episode in contact.episodes
        for t in episode
        if t == t
    ]


def length_name(system: System, body: int) -> str:
    """Symbol of the length of a rod, with the number of the rod."""
    return "\N{SCRIPT SMALL L}" + body_numbers(system.kinds)[body].translate(SUBSCRIPTS)


def round_trips(solution: Solution) -> dict[float, str]:
    """Names of instants, s, at which a force ends or a gap opens after whole round trips: 2 l1/c.

    Of contacts that press from t = 0 on; a trip is that of a wave in one of the two rods there.
    """
    system, names = solution.system, dict[float, str]()
    rods = {
        i: body
        for i, body in enumerate(system.bodies)
        if isinstance(body, Rod) and len(body.segments) == 1
    }
    several = len({body.segments[0].material for body in rods.values()}) > 1
    for contact in solution.contacts:
        turns = {
            t
            for start, *ends in contact.episodes[:1]
            if start == 0
            for t in ends
            if t == t
        }
        trips = [
            (round(t / (2 * time)), t, body)
            for body in (contact.index, contact.index + 1)
            if body in rods
            for time in [float(rods[body].transit_time)]
            for t in turns
            if math.isclose(t, 2 * time * round(t / (2 * time)), rel_tol=ALIKE)
        ]
        for count, t, body in sorted(trips):
            length = length_name(system, body)
            if count <= TRIPS:
                names.setdefault(
                    t, f"{2 * count} {length}/c{length[1:] if several else ''}"
                )
    return names
