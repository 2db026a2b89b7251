"""How wrong the time of an event may be: contacts close and open where a guard falls to 0.

A guard g that is wrong by e falls to 0 earlier or later by e/|dg/dt|.
"""

from .. import contact_laws
from . import series
from .records import Link, Node, Run
from .series import POINTS

GUARD_LENGTH = 0.01
"""Length in which guards measure overlaps, over velocity scale times duration of the piece."""


def record_event(
    run: Run, link: Link, node: Node, position: float, status: int, h: float
) -> None:
    """Record the error of an event of a link at a position in a piece of duration h.

    The piece of the event is wrong by what its polynomial leaves out, which makes `event_error`.
    All that went before is wrong, too: where velocities are wrong by v, a force is wrong by v/Y,
    and an overlap by v times its memory. For a v of the velocity scale that makes `event_lag`.
    """
    length = GUARD_LENGTH * run.velocity_scale * h
    for i in range(contact_laws.guards(link)):
        next_status = 0
        for j in range(POINTS):
            value, next_status = contact_laws.guard(
                link,
                i,
                link.overlaps[j],
                link.closing[j],
                link.force[j],
                run.velocity_scale,
                length,
            )
            node.scratch_values[j] = value
        if next_status == status:
            series.coefficients(node.scratch_values, node.scratch_series)
            error = series.remainder(node.scratch_values, False)
            slope = abs(series.slope(node.scratch_series, position)) * 2 / h
            if error < slope * h:
                lag = 1 / slope
                if contact_laws.follows_overlap(link, i):
                    lag *= run.velocity_scale * memory_of_overlap(run, link) / length
                link.event_error = max(link.event_error, error / slope)
                link.event_lag = max(link.event_lag, lag)
            else:  # the guard barely changes
                link.event_error = max(link.event_error, h)


def memory_of_overlap(run: Run, link: Link) -> float:
    """Return the time for which an overlap keeps an error of the closing velocity, s.

    It is the shortest transit, or d/(Y F) where the force F of an overlap d soon undoes it.
    """
    transit = run.shortest_transit * run.tick_duration
    undone = link.mobility * link.force[0]
    memory = transit
    if link.overlaps[0] > 0 and undone * transit > link.overlaps[0]:
        memory = link.overlaps[0] / undone
    return float(memory)
