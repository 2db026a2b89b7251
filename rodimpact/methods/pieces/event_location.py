"""Location of the first event in a piece.

The status of a link has guards, see `contact_laws.guard`. An event is where a guard
falls below 0: the status ends there. A guard is computed at the points of the piece.
The event function is the polynomial through these values. Positions in a piece are y,
from -1 at its start to 1 at its end.
"""

from typing import NamedTuple

from .. import contact_laws
from ..states import Status
from . import series
from .records import NONE, Link, Links, Node, Run
from .series import POINTS, N, X

GUARD_LENGTH = 0.01
"""Unit of length of overlaps in guards, over velocity scale times duration of a piece.
"""
ROUND_OFF = 1e-13
"""Depth below 0, without dimension, to which an event function still counts as 0."""
FIRST_RISE = 1e-3
"""Share of the way to the next point, after which the sign of a function is taken.

The function is 0 at the point before, or slightly below by round-off.
"""
NOWHERE = 2.0
"""Position after the end of a piece: there is no event."""


class Event(NamedTuple):
    """The first event of a piece."""

    position: float  # y; -1 if it is at the start, 1 if there is none
    link: int  # number of the link, NONE if there is no event
    status: int  # `Status` of the link from then on


def guard_length(run: Run, h: float) -> float:
    """Return the unit of length of overlaps in guards, m.

    The piece has the duration h, s.
    """
    return GUARD_LENGTH * run.velocity_scale * h


def set_guard_values(run: Run, link: Link, node: Node, which: int, h: float) -> int:
    """Set `node.scratch_values` to guard `which` of a link at the points of a piece.

    The piece has been solved, and has the duration h, s. The values have no dimension.
    Return the status that the link gets where this guard falls below 0.
    """
    length = guard_length(run, h)
    status = 0  # the loop sets it, at each point to the same
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
    """Return the first event in a piece, of all guards of all links of a node.

    The piece has been solved, and has the duration h, s. If there is no event, the
    position is 1, the end of the piece, and the link is NONE. Of several events at the
    same position, the one of the leftmost link is returned. Both scratch arrays of the
    node are overwritten.
    """
    position = 1.0
    first = NONE  # link of the first event so far
    first_status = 0  # status of this link after the event
    for q in range(node.link_count):
        i = node.first_link + q
        for which in range(contact_laws.guard_count(links[i])):
            status = set_guard_values(run, links[i], node, which, h)
            zero = find_event(run, links[i], node, which, h)
            is_in_piece = zero <= 1  # NOWHERE is above 1, the end of the piece
            # The event that is found first counts even at 1, the initial `position`.
            is_earliest = first == NONE or zero < position
            if is_in_piece and is_earliest:
                position = zero
                first = i
                first_status = status
    return Event(position, first, first_status)


def find_event(run: Run, link: Link, node: Node, which: int, h: float) -> float:
    """Return the position at which guard `which` of a link falls below 0, or NOWHERE.

    `node.scratch_values` must have the values of the guard at the points of a piece of
    duration h, s. There are three cases. (1) The guard is negative at the start: -1 is
    returned. This is only so for guards of velocities or forces, of links that are not
    at rest. (2) Otherwise, the zero before the first point with a negative value is
    returned, see `find_crossing`. (3) If there is no such point, the function may still
    be negative between two points, see `find_dip`.

    Negative values that may be round-off, or swings of the polynomial of a soft start,
    are ignored; at the start and between points also those that may be truncation
    errors. `node.scratch_series` is overwritten.
    """
    follows_overlap = contact_laws.follows_overlap(link, which)
    ignored_depth = ROUND_OFF  # negative values up to this depth count as 0
    value_at_end = node.scratch_values[N]
    if follows_overlap and value_at_end > 0:
        # An overlap or gap that starts softly is a polynomial that swings slightly
        # below 0, by less than this length, m.
        graze = run.graze_velocity * run.shortest_transit * run.tick_duration
        ignored_depth = max(ignored_depth, graze / guard_length(run, h))
    # The truncation error of the piece may make a dip of this depth.
    dip_depth = max(ignored_depth, run.tolerance / run.velocity_scale)
    j = 1  # becomes the first point after the start at which the guard is negative
    while j < POINTS and node.scratch_values[j] >= -ignored_depth:
        j += 1
    # A guard of velocities or forces may jump at the start of a piece. The guard of
    # REST does not count there: it is a force that is only extrapolated to the start.
    may_jump = not follows_overlap and link.status != Status.REST
    if node.scratch_values[0] < -dip_depth and may_jump:
        zero = -1.0
    elif j == POINTS:
        zero = find_dip(node, dip_depth)
    else:
        zero = find_crossing(node, j)
    return zero


def find_crossing(node: Node, j: int) -> float:
    """Return the position before point j at which an event function falls below 0.

    `node.scratch_values` must have the values of the function at the points; point j is
    the first one after the start with a negative value. `node.scratch_series` is set to
    its series. If the function is 0 (or below by round-off) at point j - 1, and does
    not rise above 0 after it, the position of point j - 1 is returned: -1 for j = 1.
    """
    series.set_series(node.scratch_values, node.scratch_series)
    low = X[j - 1]
    zero = X[j - 1]  # unless the function is positive at `low`
    if node.scratch_values[j - 1] <= 0:  # take its sign a little after the point
        low += FIRST_RISE * (X[j] - X[j - 1])
    if series.value(node.scratch_series, low) > 0:
        zero = series.first_zero(node.scratch_series, low, X[j])
    return zero


def find_dip(node: Node, depth: float) -> float:
    """Return the position between two points at which an event function falls below 0.

    The function is negative only between two points, for instance where a contact
    closes for a short time. `node.scratch_values` must have its values at the points,
    none of them negative except by round-off. A dip is searched for beside the smallest
    value only, and counts if it is more than `depth` below 0; without one, NOWHERE is
    returned. `node.scratch_series` is overwritten.
    """
    zero = NOWHERE
    least = series.smallest(node.scratch_values)
    # If all values are well above 0, there is no zero between the points either.
    if least < series.POSITIVE_RTOL * series.largest(node.scratch_values):
        j = 0  # point of the smallest value
        while node.scratch_values[j] > least:
            j += 1
        low = X[max(j - 1, 0)]
        high = X[min(j + 1, N)]
        series.set_series(node.scratch_values, node.scratch_series)
        # If the smallest value is at an end of the piece, and the function rises from
        # there into the piece, there is no dip.
        is_end_lowest = False
        if j == 0:
            is_end_lowest = series.slope_at_end(node.scratch_series, -1.0) >= 0
        elif j == N:
            is_end_lowest = series.slope_at_end(node.scratch_series, 1.0) <= 0
        if not is_end_lowest:
            bottom = series.position_of_minimum(node.scratch_series, low, high)
            # A minimum at `low`, where the search began, is no dip.
            is_deep = series.value(node.scratch_series, bottom) < -depth
            if bottom > low and is_deep:
                zero = series.first_zero(node.scratch_series, low, bottom)
    return zero
