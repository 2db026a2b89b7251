"""Where the next event of a piece is.

A guard of a link falls below 0 there, and its status ends. A guard is known at the
points of the piece; the event function is the polynomial through these values. Places
in a piece are y, from -1 at its start to 1 at its end.
"""

from typing import NamedTuple

from .. import contact_laws
from ..states import Status
from . import series
from .records import NONE, Link, Links, Node, Run
from .series import POINTS, N, X

GUARD_LENGTH = 0.01
"""Length in which guards measure overlaps, over velocity scale times duration."""
ROUND_OFF = 1e-13
"""Value below 0, without dimension, down to which an event function counts as 0."""
FIRST_RISE = 1e-3
"""Part of the way to the next point where a function that starts at 0 has a sign."""
NOWHERE = 2.0
"""Place after the end of a piece: there is no event."""


class Event(NamedTuple):
    """The first event of a piece."""

    position: float  # y; -1 if it is at the start, 1 if there is none
    link: int  # number of the link, NONE if there is no event
    status: int  # `Status` of the link from then on


def guard_length(run: Run, h: float) -> float:
    """Return the length in which guards measure overlaps, m.

    The piece has the duration h, s.
    """
    return GUARD_LENGTH * run.velocity_scale * h


def set_guard_values(run: Run, link: Link, node: Node, which: int, h: float) -> int:
    """Set `node.scratch_values` to guard `which` of a link at the points of a piece.

    The piece is solved, and has the duration h, s. The values are dimensionless. Return
    the status that follows if this guard falls below 0.
    """
    length = guard_length(run, h)
    status = 0  # the same at all points
    for j in range(POINTS):
        value, status = contact_laws.guard(
            link,
            which,
            link.overlaps[j],
            link.closing[j],
            link.force[j],
            run.velocity_scale,
            length,
        )
        node.scratch_values[j] = value
    return status


def next_event(run: Run, links: Links, node: Node, h: float) -> Event:
    """Return the first event in a piece, of any guard of any link of a node.

    The piece is solved, and has the duration h, s. Without an event the position is 1,
    the end of the piece, and the link NONE. Of events at the same place it is the one
    of the first link. Both scratch arrays of the node are overwritten.
    """
    position = 1.0
    first = NONE  # link of the first event so far
    first_status = 0
    for q in range(node.link_count):
        i = node.first_link + q
        for which in range(contact_laws.guard_count(links[i])):
            status = set_guard_values(run, links[i], node, which, h)
            zero = find_event(run, links[i], node, which, h)
            # A place after 1 means that there is no event; one at 1 itself counts.
            if zero <= 1 and (first == NONE or zero < position):
                position = zero
                first = i
                first_status = status
    return Event(position, first, first_status)


def find_event(run: Run, link: Link, node: Node, which: int, h: float) -> float:
    """Return the place y at which guard `which` of a link falls below 0, or NOWHERE.

    `node.scratch_values` has its values at the points; `node.scratch_series` is
    overwritten. A guard of velocities or forces that starts negative gives -1, the
    start, unless the link is at rest. Else the first point after the start with a
    negative value decides: `find_crossing` looks for the zero before it. If there is
    none, `find_dip` looks for a zero between two points. Values that only round-off, or
    the swing of a soft start, makes negative are ignored; so are dips that the
    truncation error can make.
    """
    follows_overlap = contact_laws.follows_overlap(link, which)
    ignored_depth = ROUND_OFF  # values down to its negative count as 0 at the points
    value_at_end = node.scratch_values[N]
    if follows_overlap and value_at_end > 0:
        # A force that starts softly is a polynomial that swings a little below 0.
        graze = run.graze_velocity * run.shortest_transit * run.tick_duration
        ignored_depth = max(ignored_depth, graze / guard_length(run, h))
    # A dip below 0 that is less deep may be the truncation error of the piece.
    dip_depth = max(ignored_depth, run.tolerance / run.velocity_scale)
    j = 1  # becomes the first point after the start at which the guard is negative
    while j < POINTS and node.scratch_values[j] >= -ignored_depth:
        j += 1
    # A guard of velocities or forces may start negative, and rise again before the next
    # point. That of REST is a force that is only extrapolated to the start.
    may_jump = not follows_overlap and link.status != Status.REST
    if node.scratch_values[0] < -dip_depth and may_jump:
        zero = -1.0
    elif j == POINTS:
        zero = find_dip(node, dip_depth)
    else:
        zero = find_crossing(node, j)
    return zero


def find_crossing(node: Node, j: int) -> float:
    """Return the place y at which an event function falls below 0 before point j.

    `node.scratch_values` has its values at the points, and gets its series into
    `node.scratch_series`; the first negative value after the start is that at point j.
    If the function is 0 or less at the point before, and does not rise above 0 after
    it, the place of that point is returned: the start of the piece, -1, if j = 1.
    """
    series.set_series(node.scratch_values, node.scratch_series)
    low = X[j - 1]
    zero = X[j - 1]  # unless it rises above 0 after that point
    if node.scratch_values[j - 1] <= 0:  # its sign shows a little after the point
        low += FIRST_RISE * (X[j] - X[j - 1])
    if series.value(node.scratch_series, low) > 0:
        zero = series.first_zero(node.scratch_series, low, X[j])
    return zero


def find_dip(node: Node, depth: float) -> float:
    """Return the place y at which an event function dips below 0, or NOWHERE.

    The dip is between two points: a contact may close or let go for a shorter time than
    points are apart. `node.scratch_values` has the values at the points, none of them
    negative but by round-off; `node.scratch_series` is overwritten. A dip below 0 by
    less than `depth` is none.
    """
    zero = NOWHERE
    least = series.smallest(node.scratch_values)
    # If all values are well above 0, there is no zero between the points.
    if least < series.POSITIVE_RTOL * series.largest(node.scratch_values):
        j = 0  # point of the smallest value
        while node.scratch_values[j] > least:
            j += 1
        low = X[max(j - 1, 0)]
        high = X[min(j + 1, N)]
        series.set_series(node.scratch_values, node.scratch_series)
        # An end of the piece is lowest if the function rises from there.
        is_end_lowest = False
        if j == 0:
            is_end_lowest = series.slope_at_end(node.scratch_series, -1.0) >= 0
        elif j == N:
            is_end_lowest = series.slope_at_end(node.scratch_series, 1.0) <= 0
        if not is_end_lowest:
            bottom = series.position_of_minimum(node.scratch_series, low, high)
            # There is a dip if the lowest place is well below 0,
            # and not where the search began.
            if bottom > low and series.value(node.scratch_series, bottom) < -depth:
                zero = series.first_zero(node.scratch_series, low, bottom)
    return zero
