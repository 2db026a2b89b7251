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

MIN_MOMENTS = 3  # moments of a solution without events and reflections
MIN_SPACING = 0.5  # least time between events of a smooth solution, in even spacings
SHORTEST_WAIT = 0.75  # least interval that is halved, in intervals between reflections
MAX_NAMED_TRIPS = 9  # largest number of whole round trips that is named
ROUND_TRIP_RTOL = 1e-6  # relative difference from whole round trips that counts as none


def moments(solution: Solution, at_most: int = 8) -> Floats:
    """Instructive times of a solution, s, in order; at most `at_most` of them.

    They are chosen in this order until there are enough: the start and the end; the
    events at contacts, which are beginnings and ends of forces and openings of gaps; an
    instant half-way to the first reflection of a wave; the first reflection at each end
    of a segment; other reflections while contacts last; and middles of the longest
    intervals. If there are too many events, some are chosen evenly, with the first and
    the last, see `n_hidden_events`. Smooth solutions have no reflections, and of their
    events that lie close together only one counts. Without events and reflections there
    are `MIN_MOMENTS` times.
    """
    # The interesting interval [first, last] is that from the first event to the last,
    # or to the end if a contact is still closed.
    events: Floats = np.unique(contact_event_times(solution))
    first = 0.0
    last = solution.t_end
    if events.size:
        first = float(events[0])
        if not _is_closed_at_the_end(solution):
            last = float(events[-1])

    reflections = _Reflections(solution, last)
    if is_smooth(solution):  # events on neighbouring time steps look like one
        least = MIN_SPACING * (last - first) / at_most
        # The first event always stays: the one before it counts as infinitely early.
        events = events[np.diff(events, prepend=-np.inf) >= least]
    if not events.size and not reflections.all.size:
        at_most = MIN_MOMENTS

    ends = np.array([0.0, solution.t_end])
    # Number of events that have room beside the start and the end
    n_events = at_most - np.setdiff1d(ends, events).size
    chosen = np.union1d(events[evenly(events.size, n_events)], ends)
    after_first = reflections.all[reflections.all > first]
    if after_first.size and chosen.size < at_most:
        half_way = (first + after_first[0]) / 2  # to the first reflection
        chosen = np.union1d(chosen, half_way)
    for candidates in (reflections.first, reflections.all):
        new = np.setdiff1d(candidates, chosen)
        new = new[evenly(new.size, at_most - chosen.size)]
        chosen = np.union1d(chosen, new)
    shortest = 0.0
    if after_first.size:
        intervals = np.diff(np.union1d(first, after_first))
        shortest = SHORTEST_WAIT * float(intervals.min(initial=np.inf))
    return _with_middles(chosen, (first, last), shortest, at_most)


def n_hidden_events(solution: Solution, times: Floats) -> int:
    """Number of instants of events at the contacts that are not among `times`, s.

    Events at one instant count once. In a smooth solution an event counts as shown also
    if one of the times is close to it, because `moments` takes events on neighbouring
    time steps for one. The result is 0 without events.
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

    Time 0 is left out.

    Attributes
    ----------
    all : array
        All these times, in order, each once.
    first : array
        The first time at each end of a segment, in order, each once.
    """

    def __init__(self, solution: Solution, last: float) -> None:
        """Take the times up to `last` from the waves of a solution by fronts.

        Both arrays are empty for a smooth solution.
        """
        every = [np.empty(0)]  # NumPy does not concatenate an empty list
        first = []
        if not is_smooth(solution):
            fields: Any = solution.fields
            # A line holds the waves that leave one end of a segment.
            for line in fields.motion.lines:
                if line is None:
                    continue
                times = np.asarray(line.ticks) * fields.clock.tick
                times = times[(times > 0) & (times <= last)]
                every.append(times)
                first.extend(times[:1])  # nothing if there are no times
        self.all = np.unique(np.concatenate(every))
        self.first = np.unique(np.array(first, dtype=float))


def _is_closed_at_the_end(solution: Solution) -> bool:
    """Whether any contact is still closed when the solution ends.

    A contact counts as closed from the start of its last episode until the gap opens.
    """
    for contact in solution.contacts:
        if not contact.episodes:
            continue
        # The opening is NaN if the contact has not opened: the comparison is False.
        has_opened = contact.episodes[-1].opening <= solution.t_end
        if not has_opened:
            return True
    return False


def _with_middles(
    chosen: Floats, span: tuple[float, float], shortest: float, at_most: int
) -> Floats:
    """Chosen times with added middles of the longest intervals, `at_most` times in all.

    Only intervals inside the span count. Adding ends early if no interval is longer
    than `shortest`, s.
    """
    first, last = span
    while chosen.size < at_most:
        inside = chosen[(chosen >= first) & (chosen <= last)]
        intervals = np.diff(inside)
        if intervals.max(initial=0.0) <= shortest:
            break
        i = int(intervals.argmax())
        chosen = np.union1d(chosen, (inside[i] + inside[i + 1]) / 2)
    return chosen


def events_at(solution: Solution, t: float) -> str:
    """Events at the contacts at time t in words, one line for each contact concerned.

    A line is such as "force ends, gap opens at contact 1-2"; a single contact is not
    named. "" is returned if nothing happens at exactly this time.
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
            # Times of `moments` are copies of these times, so that == is exact. A
            # contact without duration begins and ends at t: only the first is written.
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
    """Times, s, at which any contact begins, stops pressing, or opens.

    They are in the order of the contacts, not sorted; a time may occur several times.
    """
    times: list[float] = []
    for contact in solution.contacts:
        times += event_times(contact)
    return times


def event_times(contact: ContactHistory, at_most: int | None = None) -> list[float]:
    """Times, s, at which a contact begins, stops pressing, or opens, in order.

    They are the times of its first `at_most` episodes, by default of all. Events that
    have not happened, whose times are NaN, are left out.
    """
    times: list[float] = []
    for episode in contact.episodes[:at_most]:
        times += [t for t in episode if not math.isnan(t)]
    return times


def round_trips(solution: Solution) -> dict[float, str]:
    """Names, such as "2 l1/c", of times, s, at which a force ends or a gap opens.

    They are times of the first episode of a contact after whole round trips of a wave,
    at most `MAX_NAMED_TRIPS`, in one of the two uniform rods beside the contact. In a
    row of more than two rods only the first round trip counts: later waves have crossed
    other rods too, and their times would agree only by chance. Contacts that do not
    press from t = 0 on have no names. If both rods have whole round trips, the fewer
    ones name the time; c has the number of the rod if uniform rods differ in material.
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
        trips = []  # count of round trips, time, rod
        for i in (contact.index, contact.index + 1):
            if i not in uniform:
                continue
            trip = 2 * float(uniform[i].transit_time)
            for t in event_times(contact, at_most=1):
                count = round(t / trip)
                if t > 0 and math.isclose(t, trip * count, rel_tol=ROUND_TRIP_RTOL):
                    trips.append((count, t, i))
        # If both rods have whole round trips, the fewer ones name the time.
        for count, t, i in sorted(trips):
            length = length_name(system, i)
            speed = "c"
            if len(materials) > 1:
                subscript = length[1:]
                speed = f"c{subscript}"
            if count <= max_trips:
                # A round trip is twice the length.
                names.setdefault(t, f"{2 * count} {length}/{speed}")
    return names
