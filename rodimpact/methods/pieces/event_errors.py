"""Errors of the times of events.

An event is where a guard of a link falls to 0. If the guard g has the error e, its zero
is displaced by e/abs(dg/dt) in time.
"""

from .. import contact_laws
from . import event_location, series
from .event_location import Event
from .records import Link, Links, Node, Run


def record_event(run: Run, links: Links, node: Node, event: Event, h: float) -> None:
    """Raise `event_error` and `event_lag`, s, of the link that has an event.

    The event is in a piece of duration h, s, at a zero of a guard that leads to the new
    status. `event_error` is raised to the time by which the error of the polynomial of
    this guard displaces the zero; to all of h if the guard is so flat that this is
    longer, and `event_lag` stays then.

    `event_lag` is raised to the time by which the zero is displaced if the velocities
    before the event are wrong by the velocity scale. An error v of velocities makes an
    error of v/Y in a force, and of v times `overlap_memory` in an overlap. Both scratch
    arrays of the node are overwritten.
    """
    link = links[event.link]
    for which in range(contact_laws.guard_count(link)):
        # This sets `node.scratch_values` to the guard. `status` is the status of the
        # link after a zero of it.
        status = event_location.set_guard_values(run, link, node, which, h)
        if status == event.status:
            series.set_series(node.scratch_values, node.scratch_series)
            error = series.error_at(node.scratch_values, event.position)
            # abs(dg/dt): y goes from -1 to 1 in the time h
            rate = abs(series.slope(node.scratch_series, event.position)) * 2 / h
            if error < rate * h:
                # Velocities wrong by v, the velocity scale: guards of velocities or
                # forces are in units of this scale, and wrong by 1.
                lag = 1 / rate
                if contact_laws.follows_overlap(link, which):
                    # A guard of an overlap, in units of `length`, m, is wrong by
                    # v overlap_memory/length.
                    length = event_location.guard_length(run, h)
                    lag *= run.velocity_scale * overlap_memory(run, link) / length
                link.event_error = max(link.event_error, error / rate)
                link.event_lag = max(link.event_lag, lag)
            else:  # the guard barely changes: the event may be anywhere in the piece
                link.event_error = max(link.event_error, h)


def overlap_memory(run: Run, link: Link) -> float:
    """Return the time over which an overlap sums errors of the closing velocity, s.

    It is the shortest transit, or d/(Y F) if that is shorter: the force F undoes the
    overlap d, and with it the errors, at the rate Y F. d and F are taken at the start
    of the piece.
    """
    transit = run.shortest_transit * run.tick_duration
    overlap = link.overlaps[0]
    undoing_rate = link.mobility * link.force[0]  # Y F, m/s
    if overlap > 0 and undoing_rate * transit > overlap:
        memory = overlap / undoing_rate
    else:
        memory = transit
    return float(memory)
