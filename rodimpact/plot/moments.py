"""Instants of a collision: for snapshots, the events at contacts, and their names."""

import math
from typing import Any

import numpy as np

from ..methods.signals import Floats
from ..model import Rod
from ..model.numbering import contact_names
from ..results.contacts import ContactHistory
from ..results.solution import Solution
from .labels import length_name
from .sampling import evenly, is_smooth

MIN_MOMENTS = 3  # moments of a solution in which nothing stands out
MIN_SPACING = 0.5  # least time between events on a time step, in even spacings
SHORTEST_WAIT = 0.75  # least wait that is halved, in waits between reflections
MAX_NAMED_TRIPS = 9  # whole round trips that are named
ROUND_TRIP_RTOL = 1e-6


def moments(solution: Solution, at_most: int = 8) -> Floats:
    """Instructive times, s, at most `at_most` of them.

    The times are the start and the end, each beginning and end of a force, each opening
    of a gap, waves half-way to their first reflection, and reflections while contacts
    last, the first at each end of a rod before others. The middles of the longest
    intervals are added. Solutions with a time step have no reflections. Of too many
    events the first and the last are among the times, see `n_hidden_events`.
    """
    # Interesting is what happens from the first event to the last: [first, last].
    events: Floats = np.unique(contact_event_times(solution))
    first = 0.0
    last = solution.t_end
    if events.size:
        first = float(events[0])
        if not _is_closed_at_the_end(solution):
            last = float(events[-1])

    reflections = _Reflections(solution, last)
    if is_smooth(solution):  # events on neighbouring time steps are one to the eye
        least = MIN_SPACING * (last - first) / at_most
        events = events[np.diff(events, prepend=-np.inf) >= least]
    if not events.size and not reflections.all.size:
        at_most = MIN_MOMENTS

    ends = np.array([0.0, solution.t_end])
    n_places = at_most - np.setdiff1d(ends, events).size
    chosen = np.union1d(events[evenly(events.size, n_places)], ends)
    after = reflections.all[reflections.all > first]
    if after.size and chosen.size < at_most:  # waves half-way to their first reflection
        chosen = np.union1d(chosen, (first + after[0]) / 2)
    for candidates in (reflections.first, reflections.all):
        new = np.setdiff1d(candidates, chosen)
        new = new[evenly(new.size, at_most - chosen.size)]
        chosen = np.union1d(chosen, new)
    shortest = 0.0
    if after.size:
        waits = np.diff(np.union1d(first, after))
        shortest = SHORTEST_WAIT * float(waits.min(initial=np.inf))
    return _with_middles(chosen, (first, last), shortest, at_most)


def n_hidden_events(solution: Solution, times: Floats) -> int:
    """Number of times of events at the contacts that are not among `times`, s.

    Of a solution with a time step, an event counts as shown if one of the times is
    close to it, as `moments` takes events on neighbouring time steps for one.
    """
    events = np.unique(contact_event_times(solution))
    if not events.size:
        return 0
    least = 0.0
    if is_smooth(solution):
        least = MIN_SPACING * float(events[-1] - events[0]) / times.size
    distances = np.abs(events[:, np.newaxis] - times)  # s, [event, time]
    return int(np.count_nonzero(distances.min(axis=1) > least))


class _Reflections:
    """Times, s, up to `last` at which a changed wave leaves an end of a segment.

    Attributes
    ----------
    all, first : array
        All times, and the first at each end of a segment.
    """

    def __init__(self, solution: Solution, last: float) -> None:
        """Take the times from the ticks of all waves; none from a smooth solution."""
        every = [np.empty(0)]
        first = []
        if not is_smooth(solution):
            fields: Any = solution.fields
            for line in fields.motion.lines:
                if line is None:
                    continue
                times = np.asarray(line.ticks) * fields.clock.tick
                times = times[(times > 0) & (times <= last)]
                every.append(times)
                first.extend(times[:1])
        self.all = np.unique(np.concatenate(every))
        self.first = np.unique(np.array(first, dtype=float))


def _is_closed_at_the_end(solution: Solution) -> bool:
    """Whether a contact is still closed when the solution ends."""
    for contact in solution.contacts:
        if not contact.episodes:
            continue
        has_opened = contact.episodes[-1].opening <= solution.t_end  # False for NaN
        if not has_opened:
            return True
    return False


def _with_middles(
    chosen: Floats, span: tuple[float, float], shortest: float, at_most: int
) -> Floats:
    """Chosen times, with middles of the longest waits until there are enough.

    Only waits inside the span count; none is halved that is no longer than `shortest`.
    """
    first, last = span
    while chosen.size < at_most:
        inside = chosen[(chosen >= first) & (chosen <= last)]
        waits = np.diff(inside)
        if waits.max(initial=0.0) <= shortest:
            break
        i = int(waits.argmax())
        chosen = np.union1d(chosen, (inside[i] + inside[i + 1]) / 2)
    return chosen


def events_at(solution: Solution, t: float) -> str:
    """Events at the contacts at time t in words: one line for each contact concerned.

    A line is such as "force ends, gap opens at contact 1-2"; the contact is named only
    in a row of several.
    """
    several = len(solution.outcome.unilateral) > 1
    names = contact_names(solution.system.kinds)
    lines = []
    for contact in solution.contacts:
        where = ""
        if several:
            where = f" at contact {names[contact.index]}"
        for episode in contact.episodes:
            events = []
            # Moments are copies of these times, so that equal ones are equal to the
            # last bit. Of a contact without duration only the beginning is told.
            if t == episode.start:
                events.append("force begins")
            else:
                if t == episode.force_end:
                    events.append("force ends")
                if t == episode.opening:
                    events.append("gap opens")
            if events:
                lines.append(", ".join(events) + where)
    return "\n".join(lines)


def contact_event_times(solution: Solution) -> list[float]:
    """Times at which a contact begins, stops pressing, or opens."""
    times: list[float] = []
    for contact in solution.contacts:
        times += event_times(contact)
    return times


def event_times(contact: ContactHistory, at_most: int | None = None) -> list[float]:
    """Times at which one contact begins, stops pressing, or opens.

    They are those of its first episodes, `at_most` of them, by default all; NaN
    is left out.
    """
    times: list[float] = []
    for episode in contact.episodes[:at_most]:
        times += [t for t in episode if not math.isnan(t)]
    return times


def round_trips(solution: Solution) -> dict[float, str]:
    """Names, 2 l1/c, of times, s, at which a force ends or a gap opens.

    They are times after whole round trips of a wave in one of the two rods beside the
    contact. In a row of more than two rods only the first round trip counts: later
    waves have crossed other rods too, and lengths that add up would be named by chance.
    Contacts that do not press from t = 0 on have none.
    """
    system = solution.system
    max_trips = MAX_NAMED_TRIPS
    if system.kinds.count("rod") > 2:
        max_trips = 1
    uniform = {
        i: body
        for i, body in enumerate(system.bodies)
        if isinstance(body, Rod) and len(body.segments) == 1
    }
    materials = {rod.segments[0].material for rod in uniform.values()}

    names: dict[float, str] = {}
    for contact in solution.contacts:
        if not contact.episodes or contact.episodes[0].start != 0:
            continue
        trips = []
        for i in (contact.index, contact.index + 1):
            if i not in uniform:
                continue
            trip = 2 * float(uniform[i].transit_time)
            for t in event_times(contact, at_most=1):
                count = round(t / trip)
                if t > 0 and math.isclose(t, trip * count, rel_tol=ROUND_TRIP_RTOL):
                    trips.append((count, t, i))
        for count, t, i in sorted(trips):  # the fewest round trips name the time
            length = length_name(system, i)
            speed = "c"
            if len(materials) > 1:
                speed = f"c{length[1:]}"
            if count <= max_trips:
                names.setdefault(t, f"{2 * count} {length}/{speed}")
    return names
