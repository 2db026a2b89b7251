"""The clock of a row.

It measures time in whole ticks, and velocities in a moving frame. Lists by segment are
of two kinds. `transits` has the n segments only, with the indices 0 to n - 1. A list
"with the outside" has the segments from 1 to n, and the entries 0 and n + 1 for the
outside on the left and on the right.

One class serves all methods, fields and the web page. In a family its numbers are
arrays.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..model import System
from . import tick_rule as rule
from .record_lists import blank
from .row import Row

MIN_TRANSIT = 4096
"""Ticks that a transit time must exceed, so that a share of it is still some ticks."""


@dataclass(frozen=True, eq=False)
class Clock:
    """A row on a clock of whole ticks.

    Lists by segment with the outside have the index 0 for the outside on the left, and
    n + 1 for the outside on the right of n segments.

    Attributes
    ----------
    row : Row
    tick : float
        Duration of a tick, s.
    transits : list of int
        Transit times of the segments from left to right, ticks.
    frame : float
        Velocity of the frame in which waves are given, m/s, at t = 0.
    scale : float
        Scale of velocities, m/s; 0 for a method whose totals are exact.
    reference : float
        The longest transit time, or its replacement in a row without rods, s.
    last_tick : int
        Tick at which the clock ends.
    impedance : list of float
        By segment with the outside, kg/s: impedance times transit time is mass.
    transit_error : float
        Largest relative change of a transit time by its rounding to the clock.
    worst_path : str
        Path of the segment with this error.
    """

    row: Row
    tick: float
    transits: Sequence[int]
    frame: float
    scale: float = 0.0
    reference: float = 0.0
    last_tick: int = 0
    impedance: Sequence[float] = ()
    transit_error: float = 0.0
    worst_path: str = ""

    @property
    def system(self) -> System:
        """The system of the row."""
        system: System = self.row.system
        return system

    @property
    def spans(self) -> list[tuple[int, int]]:
        """First and last segment of each body; (1, 0) for a wall or a rigid mass."""
        return self.row.spans

    @property
    def gravity(self) -> float:
        """Acceleration of the frame, m/s^2."""
        return float(self.row.system.gravity)

    @cached_property
    def ticks(self) -> list[int]:
        """Transit times by segment with the outside, ticks; 0 outside."""
        return [0, *self.transits, 0]

    @cached_property
    def wave_speed(self) -> list[float]:
        """Wave speeds by segment with the outside, m/s; 0 outside."""
        return [0.0, *(float(s.wave_speed) for s in self.row.segments), 0.0]

    @cached_property
    def length(self) -> list[float]:
        """Lengths by segment with the outside, m; 0 outside."""
        return [0.0, *(float(s.length) for s in self.row.segments), 0.0]

    @property
    def longest_rod(self) -> int:
        """Longest transit time of a rod, ticks; 0 without rods.

        The transit time of a rod is the sum over its segments.
        """
        longest = 0
        # A wall or a mass has the span (1, 0), so that its sum is empty.
        for first, last in self.spans:
            longest = max(longest, sum(self.ticks[first : last + 1]))
        return longest

    def mass(self, body: int) -> float:
        """Mass of the body of this number, kg; infinite for a wall.

        The mass of a rod follows from its rounded transit times, see `rod_mass`; the
        mass of a rigid mass is its own.
        """
        last_segment = self.spans[body][1]
        if last_segment == 0:  # a rigid mass, or a wall, which has no `mass`
            return float(getattr(self.system.bodies[body], "mass", math.inf))
        return rod_mass(self, body)


def rod_mass(clock: Clock, body: int) -> float:
    """Mass of the rod that is the body of this number, kg.

    It is the sum over its segments of impedance times transit time, which is rounded to
    ticks. It is 0 for a body without segments. The web page has this function as
    JavaScript.
    """
    first, last = clock.row.spans[body]  # segments, counted from 1
    mass_in_ticks: float = 0  # kg/s times ticks
    for s in range(first, last + 1):
        # The index of segment s is s in `impedance`, and s - 1 in `transits`.
        mass_in_ticks += clock.impedance[s] * clock.transits[s - 1]
    return mass_in_ticks * clock.tick


def clock_of(
    row: Row,
    transits: Sequence[int],
    tick: float,
    *,
    frame: float | None = None,
    scale: float = 0.0,
    impedance: Sequence[float] | None = None,
    is_mesh: bool = False,
) -> Clock:
    """Make the clock of a single row whose segments have these `transits`.

    `transit_error`, the largest relative change of a transit time by rounding, and
    `worst_path`, the path of that segment, are computed here. `reference` and
    `last_tick` of the clock stay 0.

    Parameters
    ----------
    row : Row
    transits : sequence of int
        Transit times by segment, ticks.
    tick : float
        Duration of a tick, s.
    frame : float, optional
        Velocity of the frame, m/s; by default that of the row.
    scale : float
        Scale of velocities, m/s.
    impedance : sequence of float, optional
        By segment with the outside, kg/s; by default those of the segments, and 0
        outside.
    is_mesh : bool
        Whether the ticks are those of a mesh, to which transit times are not rounded:
        then `transit_error` is 0.
    """
    if frame is None:  # computing it takes longer than the rest of this function
        frame = float(row.frame)
    if impedance is None:
        impedance = [0.0, *(float(s.impedance) for s in row.segments), 0.0]
    error, worst_path = most_rounded(row, transits, tick)
    if is_mesh:  # nothing was rounded
        error = 0.0
    return Clock(
        row,
        tick,
        transits,
        frame,
        scale,
        impedance=impedance,
        transit_error=error,
        worst_path=worst_path,
    )


def crossing_time_of(row: Any) -> Any:
    """Sum of the transit times of all segments of a row, s; 0 without segments.

    In a family it may be an array over the members.
    """
    crossing_time = 0.0
    for segment in row.segments:
        crossing_time = crossing_time + segment.transit_time
    return crossing_time


def flight_time_of(row: Any, scale: Any) -> Any:
    """Time to cross all gaps, one after the other, at the velocity `scale`, s.

    `scale` is positive, m/s. An overlap counts as a gap of 0. In a family the time may
    be an array over the members.
    """
    flight_length = 0.0
    for link in row.links:
        # A gap below 0 is an overlap.
        flight_length = flight_length + np.maximum(link.gap, 0.0)
    return flight_length / scale


def count_ticks(
    durations: list[float], longest: float, end: float
) -> tuple[int, list[int]]:
    """Ticks of the longest transit, and of all durations, on the clock of one member.

    `durations`, s, are the transit times, possibly with other times; `longest`, s, is
    the longest of them, or a time that replaces it in a row without rods. The clock
    must count to `end`, s. Durations in simple ratios keep these ratios, see
    `tick_rule.assign_ticks`; the others are rounded to whole ticks. If no clock counts
    to `end`, 0 and an empty list are returned.
    """
    bits = rule.clock_bits(end / longest)  # the longest transit has about 2^bits ticks
    if bits < rule.MIN_TRANSIT_BITS:
        return 0, []
    counted = blank(len(durations), rule.DURATION)
    for i in range(len(counted)):
        counted[i].time = durations[i]
    longest_ticks = 1 << bits  # in a row without durations
    if len(counted) > 0:
        longest_ticks = rule.assign_ticks(counted, bits)  # this sets `ticks` of each
    return longest_ticks, [duration.ticks for duration in counted]


def most_rounded(row: Any, ticks: Any, tick: float) -> tuple[float, str]:
    """Largest relative change of a transit time by rounding, and that segment's path.

    `ticks` are the rounded transit times by segment, `tick` is the duration of a tick,
    s. If all transit times are exact, the result is 0 and the path of the first
    segment; in a row without segments it is 0 and "". The web page has this function as
    JavaScript.
    """
    error = 0.0
    worst = 0  # number of the segment, from 1 on; `paths` has "" at 0
    if len(row.segments) > 0:
        worst = 1
    for s, segment in enumerate(row.segments):
        change = abs(ticks[s] * tick / segment.transit_time - 1)
        if change > error:
            error = float(change)
            worst = s + 1
    return error, row.paths[worst]


def too_long(end: float, longest: float) -> tuple[str, str]:
    """Path "until" and the sentence that refuse a run to `end`, s, as too long.

    The sentence names the longest time that a clock can count. `longest` is the longest
    transit time, s.
    """
    most = rule.countable_time(longest)
    return "until", (
        f"a run of {end:g} s is {end / longest:.3g} times the longest transit time "
        f"{longest:g} s, more than the clock can count; stop before {most:.3g} s"
    )


def too_short(path: str, transit: float, longest: float) -> tuple[str, str]:
    """The given path and the sentence that refuse the segment with this path.

    Its transit time `transit` is too short beside the longest transit time `longest`,
    both in s, to be counted in ticks.
    """
    return path, (
        f"its transit time {transit:.3g} s is too short beside the longest, "
        f"{longest:.3g} s: the clock holds ratios up to about 2e11; leave this segment "
        "out"
    )
