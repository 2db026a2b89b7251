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
    the guard moves this zero, or to all of h if the guard changes by less than that.

    `event_lag` is raised to the time by which wrong velocities before move the zero, if
    they are wrong by the velocity scale. With velocities wrong by v a force is wrong by
    v/Y, and an overlap by v times `overlap_memory`. A guard that barely changes leaves
    it as it is. The scratch arrays of the node are overwritten.
    """
    link = links[event.link]
    for which in range(contact_laws.guard_count(link)):
        status = event_location.set_guard_values(run, link, node, which, h)
        if status == event.status:
            series.set_series(node.scratch_values, node.scratch_series)
            error = series.error_at(node.scratch_values, event.position)
            # dg/dt, as y goes from -1 to 1 in the time h
            rate = abs(series.slope(node.scratch_series, event.position)) * 2 / h
            if error < rate * h:
                # A guard of velocities or forces, which is in units of their scale, is
                # wrong by 1 for a v of the scale.
                lag = 1 / rate
                # One of overlaps is wrong by v times the memory, over its own scale.
                if contact_laws.follows_overlap(link, which):
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
    undone_rate = link.mobility * link.force[0]
    memory = transit
    if overlap > 0 and undone_rate * transit > overlap:
        memory = overlap / undone_rate
    return float(memory)
