"""How wrong the time of an event may be.

Contacts close and open where a guard falls to 0. A guard g that is wrong by e falls to
0 earlier or later by e/abs(dg/dt).
"""

from .. import contact_laws
from . import event_location, series
from .event_location import Event
from .records import Link, Links, Node, Run


def record_event(run: Run, links: Links, node: Node, event: Event, h: float) -> None:
    """Raise `event_error` and `event_lag`, s, of the link that has an event.

    The event is in a piece of duration h, s: a zero of each guard that leads to its
    status. `event_error` is raised to the time by which the error of the polynomial of
    the guard moves this zero. A guard that changes by less than that error in the piece
    raises it to all of h, and leaves `event_lag` as it is.

    `event_lag` is raised to the time by which the zero moves if the velocities before
    are wrong by the velocity scale. With velocities wrong by v a force is wrong by v/Y,
    and an overlap by v times `overlap_memory`. The scratch arrays of the node are
    overwritten.
    """
    link = links[event.link]
    for which in range(contact_laws.guard_count(link)):
        # The values of the guard are now in `node.scratch_values`; `status` is where
        # the link goes as they fall below 0.
        status = event_location.set_guard_values(run, link, node, which, h)
        if status == event.status:
            series.set_series(node.scratch_values, node.scratch_series)
            error = series.error_at(node.scratch_values, event.position)
            # dg/dt, as y goes from -1 to 1 in the time h
            rate = abs(series.slope(node.scratch_series, event.position)) * 2 / h
            if error < rate * h:
                # For a v of the velocity scale a guard of velocities or forces, which
                # is in units of their scale, is wrong by 1.
                lag = 1 / rate
                if contact_laws.follows_overlap(link, which):
                    # A guard of overlaps, in units of `length`, m, is wrong by v times
                    # the memory over this length.
                    length = event_location.guard_length(run, h)
                    lag *= run.velocity_scale * overlap_memory(run, link) / length
                link.event_error = max(link.event_error, error / rate)
                link.event_lag = max(link.event_lag, lag)
            else:  # the guard barely changes: the event may be anywhere in the piece
                link.event_error = max(link.event_error, h)


def overlap_memory(run: Run, link: Link) -> float:
    """Return the time for which an overlap keeps an error of the closing velocity, s.

    It is the shortest transit, or d/(Y F) if that is shorter: a force F soon undoes an
    overlap d. Both are those at the start of the piece.
    """
    transit = run.shortest_transit * run.tick_duration
    overlap = link.overlaps[0]
    undoing_rate = link.mobility * link.force[0]  # Y F, m/s: the force undoes it by it
    if overlap > 0 and undoing_rate * transit > overlap:
        memory = overlap / undoing_rate
    else:
        memory = transit
    return float(memory)
