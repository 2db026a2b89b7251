"""The clock and the scales of a row, or of a family of rows."""

from typing import Any

import numpy as np

from ... import model
from ...model.frozen import InvalidModel
from .. import tick_rule as rule
from ..clock import (
    MIN_TRANSIT,
    Clock,
    count_ticks,
    crossing_time_of,
    flight_time_of,
    too_long,
    too_short,
)
from ..compiling import Functions
from ..row import Row
from ..scales import largest, scale_without_rods, smallest, velocities_of
from .initial_lines import jumps_of, segments_of, varies


def own_laws(row: Row) -> Functions:
    """Laws of the user in a row, as pairs: the number of a link, and its function."""
    laws = []
    for law, i in zip(row.system.contacts, row.contact_link, strict=True):
        if isinstance(law, model.Law):
            laws.append((i, law.force))
    return tuple(laws)


def has_profiles(row: Row) -> bool:
    """Whether an initial velocity or strain, or the value at an end of the row, varies.

    It varies if it is a profile in space or time, not a number; see `varies`.
    """
    for rod, _, _ in segments_of(row):
        if varies(rod.velocity, rod.strain):
            return True
    return any(varies(value) for _, value in row.boundaries)


def closing_velocity(row: Row) -> Any:
    """Largest velocity with which rigid masses may close at first, m/s, by member.

    It is the largest minus the smallest velocity in the row, or 1 if all are equal.
    """
    velocities = velocities_of(row)
    v = largest(velocities) - smallest(velocities)
    return np.where(v > 0, v, 1.0)


def contact_times(row: Row) -> dict[int, Any]:
    """Estimated contact time of each compliant link between rigid masses, s.

    The keys are the numbers of the links; a time is a number, or an array by member. A
    mass m that closes with velocity v against F = k d^p stops where
    m v^2/2 = k d^q/q with q = p + 1, at the overlap d = (q m/(2 k))^(1/q) v^(2/q). The
    estimate is 3 d/v; the time would be pi d/v for a spring, and 2.94 d/v for a Hertz
    contact (p = 3/2). m is the largest mass, and v is `closing_velocity`.
    """
    v = closing_velocity(row)
    times = {}
    for i, link in enumerate(row.links):
        if np.any(np.asarray(link.stiffness) > 0):  # it is compliant
            q = link.exponent + 1
            depth_factor = (q / 2 * largest(row.masses) / link.stiffness) ** (1 / q)
            # 3 d/v with d = depth_factor v^(2/q)
            times[i] = 3 * depth_factor * v ** (2 / q - 1)
    return times


def reference_time(row: Row, until: float | None) -> Any:
    """Longest transit time of a segment, s; a number, or an array by member.

    Without rods it is `until`, returned as it is given. If this is None or 0, it is the
    longest of the contact times and of the times in which gaps are crossed, or 1 if all
    of them are 0.
    """
    if row.segments:
        return largest([segment.transit_time for segment in row.segments])
    if until:
        return until
    # `closing_velocity` is never 0.
    flight_times = [link.gap / closing_velocity(row) for link in row.links]
    longest = largest([*flight_times, *contact_times(row).values()])
    return np.where(longest > 0, longest, 1.0)


def refuse_short_contacts(row: Row, tick: Any) -> None:
    """Raise InvalidModel if a contact between rigid masses lasts too few ticks.

    The row must have no rods. `tick` is the duration of a tick, s. The error names the
    first contact whose estimated time is at most MIN_TRANSIT ticks. Members in which
    all velocities are equal are left out: no contact closes there.
    """
    velocities = velocities_of(row)
    moves = largest(velocities) > smallest(velocities)  # by member
    times = contact_times(row)
    for k, i in enumerate(row.contact_link):  # contact k is link i
        if i not in times:  # it is not compliant
            continue
        is_short = times[i] <= MIN_TRANSIT * tick  # by member
        if not np.any(moves & is_short):
            continue
        short = float(np.min(times[i]))
        sentence = (
            f"it lasts about {short:.1g} s, too short beside the flight or the run: "
            "the clock holds ratios up to about 1e11; take a smaller gap, an earlier "
            "end or a softer law"
        )
        raise InvalidModel([(f"contacts.{k}", sentence)])


def velocity_scale(row: Row, time: Any) -> Any:
    """Scale of velocities, m/s, a number or an array by member; 1 where it would be 0.

    With rods it is `row.scale`. Without rods it is `scale_without_rods`, for forces
    that act for `time`, s.
    """
    if row.segments:
        scale = np.asarray(row.scale)
    else:
        scale = scale_without_rods(row, time)
    return np.where(scale > 0, scale, 1.0)


def member_clock(
    row: Row, times: list[float], longest: float, end: float
) -> tuple[float, list[int]]:
    """Duration of a tick of one member, s, and its `times` in ticks.

    `times`, s, are the transit times of the segments, then other times. `longest`, s,
    is the longest transit time, or the reference time of a row without rods: it becomes
    a whole number of ticks. The clock must count to `end`, s.

    Raises
    ------
    InvalidModel
        If no clock counts to the end, or a transit time is at most MIN_TRANSIT ticks.
    """
    longest_ticks, counted = count_ticks(times, longest, end)
    if longest_ticks == 0:  # there is no clock
        raise InvalidModel([too_long(end, longest)])
    transits = counted[: len(row.segments)]
    if transits and min(transits) <= MIN_TRANSIT:
        s = transits.index(min(transits))  # the shortest segment, counted from 0
        path = row.paths[s + 1]  # paths are counted from 1
        raise InvalidModel([too_short(path, times[s], max(times))])
    return longest / longest_ticks, counted


def family_clock(
    row: Row, until: float | None
) -> tuple[Clock, dict[tuple[int, float], int]]:
    """The clock of a family, and the jumps inside segments, in ticks.

    The clock of each member counts transit times, and the times to jumps, in whole
    ticks. `until` is the end of the run, s, or None for the default horizon. The second
    result is a dictionary of the jumps of `jumps_of`. A key is the segment of the jump
    and its share of the length; the value is the time that a wave takes from the left
    end of the segment to the jump, ticks.

    Raises
    ------
    InvalidModel
        If transit times are too unequal for one clock, the run is too long for it, or a
        contact in a row without rods is too short.
    """
    transits = [segment.transit_time for segment in row.segments]  # s
    reference = reference_time(row, until)
    scale = velocity_scale(row, reference)
    jumps = jumps_of(row)
    crossing_time = crossing_time_of(row)
    flight_time = flight_time_of(row, scale)
    # Times from the left end of a segment to a jump, at a share of its length
    jump_times = [share * transits[s] for s, share in jumps]
    # Times that are counted: transit times, then times to jumps. `by_member` gives an
    # array with a number for each member.
    counted_times = [row.by_member(time) for time in (*transits, *jump_times)]
    # [time, member]; without rods there are no times, and the shape is (0, members).
    by_time = np.array(counted_times).reshape(-1, row.members)
    times_of_members = by_time.T.tolist()  # [member][time]
    longest_times = row.by_member(reference)
    crossing_times = row.by_member(crossing_time)
    flight_times = row.by_member(flight_time)
    segment_count = len(transits)
    tick_by_member = np.zeros(row.members)  # duration of a tick, s
    end_by_member = np.zeros(row.members)  # end of the run, s
    transit_ticks = np.zeros((segment_count, row.members), np.int64)
    counted: list[int] = []  # the times of one member in ticks
    for m, times in enumerate(times_of_members):
        longest = float(longest_times[m])
        if until is None:
            crossing = float(crossing_times[m])
            flight = float(flight_times[m])
            share = 1.0  # of the default: all of it
            end = rule.default_horizon(longest, crossing, flight, share)
        else:
            end = until
        end_by_member[m] = end
        tick_by_member[m], counted = member_clock(row, times, longest, float(end))
        transit_ticks[:, m] = counted[:segment_count]
    # The numbers of the clock are arrays of the shape of the family.
    shape = row.system.shape
    tick: Any = tick_by_member.reshape(shape)
    last_tick: Any = np.rint(end_by_member.reshape(shape) / tick)
    # One array for each segment
    by_segment: Any = [*transit_ticks.reshape((segment_count, *shape))]
    if not row.segments:
        refuse_short_contacts(row, tick)
    clock = Clock(row, tick, by_segment, row.frame, scale, reference, last_tick)
    # Only a single row has jumps, a family has none. The loop ran once then, so that
    # `counted` belongs to its only member.
    jump_ticks = counted[segment_count:]
    return clock, dict(zip(jumps, jump_ticks, strict=True))
