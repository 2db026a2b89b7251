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
    """Laws of the user in a row: pairs of the number of a link and its function."""
    laws = []
    for law, i in zip(row.system.contacts, row.contact_link, strict=True):
        if isinstance(law, model.Law):
            laws.append((i, law.force))
    return tuple(laws)


def has_profiles(row: Row) -> bool:
    """Whether an initial velocity or strain, or what acts on an end of the row, varies.

    It varies if it is a profile over place or time, not a number; see `varies`.
    """
    for rod, _, _ in segments_of(row):
        if varies(rod.velocity, rod.strain):
            return True
    return any(varies(value) for _, value in row.boundaries)


def closing_velocity(row: Row) -> Any:
    """Largest velocity with which rigid masses may close, m/s.

    It is 1 where none approaches another.
    """
    speeds = velocities_of(row)
    v = largest(speeds) - smallest(speeds)
    return np.where(v > 0, v, 1.0)


def contact_times(row: Row) -> dict[int, Any]:
    """Estimated contact time of each compliant link between rigid masses, s, by number.

    The time is a number, or an array by member. A mass m that closes with velocity v on
    F = k d^p stops where m v^2/2 = k d^q/q with q = p + 1, so at d = (q m/(2 k))^(1/q)
    v^(2/q). It takes about d/v, and comes back: the time is 3 d/v. All masses count as
    the largest, v is the largest closing velocity, or 1 m/s where nothing closes.
    """
    v = closing_velocity(row)
    times = {}
    for i, link in enumerate(row.links):
        if np.any(np.asarray(link.stiffness) > 0):  # it is compliant
            q = link.exponent + 1
            depth_factor = (q / 2 * largest(row.masses) / link.stiffness) ** (1 / q)
            # d is depth_factor v^(2/q), which is divided by v.
            times[i] = 3 * depth_factor * v ** (2 / q - 1)
    return times


def reference_time(row: Row, until: float | None) -> Any:
    """Longest transit time of a segment, s; a number, or an array by member.

    Without rods it is `until`, unless that is None or 0; else the longest time of a
    contact or a flight, and 1 where there is none of these.
    """
    if row.segments:
        return largest([s.transit_time for s in row.segments])
    if until:
        return until
    flights = [link.gap / closing_velocity(row) for link in row.links]
    longest = largest([*flights, *contact_times(row).values()])
    return np.where(longest > 0, longest, 1.0)


def refuse_short_contacts(row: Row, tick: Any) -> None:
    """Raise InvalidModel if a contact lasts too few ticks to be followed.

    The row has no rods. `tick` is the duration of a tick, s. The error names the first
    such contact. Where nothing moves no contact closes, and none is refused.
    """
    speeds = velocities_of(row)
    moving = largest(speeds) > smallest(speeds)
    times = contact_times(row)
    for k, i in enumerate(row.contact_link):  # contact k is link i
        if i not in times:  # it is not compliant
            continue
        is_short = times[i] <= MIN_TRANSIT * tick
        if not np.any(moving & is_short):
            continue
        short = float(np.min(times[i]))
        sentence = (
            f"it lasts about {short:.1g} s, too short beside the flight or the run: "
            "the clock holds ratios up to about 1e11; take a smaller gap, an earlier "
            "end or a softer law"
        )
        raise InvalidModel([(f"contacts.{k}", sentence)])


def velocity_scale(row: Row, time: Any) -> Any:
    """Scale of velocities, m/s, a number or an array by member; 1 where nothing moves.

    With rods it is `row.scale`. Without rods it follows from `time`, s, for which
    forces act.
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

    `times`, s, are the transit times of the segments, then others. The clock counts to
    `end`, s; `longest` is the longest transit or the reference time, s, and a whole
    number of ticks.

    Raises
    ------
    InvalidModel
        If no clock counts to the end, or a transit time is too few ticks.
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
    """The clock of a family, and the places of jumps inside segments, in ticks.

    The clock counts transit times, and times to jumps, in whole ticks, for each member;
    `until` is the end of the run, s, or None for the default horizon. The second result
    has an entry for each jump of `jumps_of`: its segment and share of the length, and
    the ticks of a wave from the left end of the segment to it.

    Raises
    ------
    InvalidModel
        If transit times are too far apart for one clock, the run is too long for it,
        or a contact of a row without rods is too short.
    """
    transits = [s.transit_time for s in row.segments]
    reference = reference_time(row, until)
    scale = velocity_scale(row, reference)
    jumps = jumps_of(row)
    crossing_time = crossing_time_of(row)
    flight_time = flight_time_of(row, scale)
    jump_times = [share * transits[s] for s, share in jumps]
    # Times that are counted, [time, member]: transit times, then times to jumps
    counted_times = [row.of(time) for time in (*transits, *jump_times)]
    by_time = np.array(counted_times).reshape(-1, row.members)
    times_of_members = by_time.T.tolist()
    longest_times = row.of(reference)  # `of` gives a number for each member
    crossing_times = row.of(crossing_time)
    flight_times = row.of(flight_time)
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
            end = rule.default_horizon(longest, crossing, flight, 1.0)
        else:
            end = until
        end_by_member[m] = end
        tick_by_member[m], counted = member_clock(row, times, longest, float(end))
        transit_ticks[:, m] = counted[:segment_count]
    # The clock has arrays of the shape of the family.
    shape = row.system.shape
    tick: Any = tick_by_member.reshape(shape)
    last_tick: Any = np.rint(end_by_member.reshape(shape) / tick)
    by_segment: Any = [*transit_ticks.reshape((segment_count, *shape))]
    if not row.segments:
        refuse_short_contacts(row, tick)
    clock = Clock(row, tick, by_segment, row.frame, scale, reference, last_tick)
    # Only a single row, not a family, has states that jump: its only member was the
    # last one in the loop, so that `counted` is of it.
    jump_ticks = counted[segment_count:]
    return clock, dict(zip(jumps, jump_ticks, strict=True))
