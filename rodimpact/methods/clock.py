"""A row of bodies on a clock of whole ticks: what fields need to know of any method's run."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..model import System
from . import tick_rule as rule
from .row import Row


@dataclass(frozen=True, kw_only=True)
class Clock:
    """Segments 1 to n from left to right; index 0 and n + 1 of a segment list are the outside.

    Attributes
    ----------
    system : System
    spans : tuple of (int, int)
        First and last segment of each body; (1, 0) for a wall or a rigid mass.
    wave_speed, impedance, length : list of float
        By segment, SI.
    ticks : list of int
        Transit times by segment.
    tick : float
        s.
    frame : float
        Velocity of the frame in which waves are given, m/s, at t = 0.
    gravity : float
        Acceleration of that frame, m/s^2.
    scale : float
        Of velocities, m/s; 0 where totals are exact.
    transit_error : float
        Largest relative change of a transit time by its rounding to the clock.
    worst : str
        Path of the segment with that error.
    """

    system: System
    spans: tuple[tuple[int, int], ...]
    wave_speed: list[float]
    impedance: list[float]
    length: list[float]
    ticks: list[int]
    tick: float
    frame: float
    gravity: float = 0.0
    scale: float = 0.0
    transit_error: float = 0.0
    worst: str = ""

    @property
    def longest(self) -> int:
        """Transit time of the longest rod, ticks."""
        return max(sum(self.ticks[first : last + 1]) for first, last in self.spans)

    def mass(self, body: int) -> float:
        """Mass with the transit times in use, kg; infinite for a wall."""
        first, last = self.spans[body]
        if last == 0:
            return float(getattr(self.system.bodies[body], "mass", math.inf))
        return (
            sum(self.impedance[s] * self.ticks[s] for s in range(first, last + 1))
            * self.tick
        )


def clock_of(row: Row, ticks: Sequence[int], tick: float, **known: Any) -> Clock:
    """The clock of a row whose segments take so many ticks; `known` is what a method says itself.

    Parameters
    ----------
    row : Row
    ticks : sequence of int
        Transit times by segment, without the outside.
    tick : float
        s.
    **known
        Attributes of a `Clock`, for those that follow from the row.
    """
    for name in ("wave_speed", "impedance", "length"):
        if name not in known:
            known[name] = [
                0.0,
                *(float(getattr(piece, name)) for piece in row.segments),
                0.0,
            ]
    if "frame" not in known:  # which takes longer than all else here
        known["frame"] = float(row.frame)
    error, worst = most_rounded(row, ticks, tick)
    known = {"gravity": float(row.system.gravity), "transit_error": error, **known}
    return Clock(
        system=row.system,
        spans=tuple(row.spans),
        ticks=[0, *ticks, 0],
        tick=tick,
        worst=worst,
        **known,
    )


def most_rounded(row: Any, ticks: Any, tick: float) -> tuple[float, str]:
    """Largest relative change of a transit time on the clock, and its path.

    The page has this as JavaScript.
    """
    error, worst = 0.0, row.paths[1 if len(row.segments) > 0 else 0]
    for s, piece in enumerate(row.segments):
        off = abs(ticks[s] * tick / piece.transit_time - 1)
        if off > error:
            error, worst = float(off), row.paths[s + 1]
    return error, worst


def too_long(end: float, longest: float) -> tuple[str, str]:
    """Path and sentence for a run to `end`, s, which no clock counts; `longest` transit time, s."""
    most = longest * 2.0 ** (rule.CLOCK_BITS - 1 - rule.MIN_TRANSIT_BITS)
    return "until", (
        f"a run of {end:g} s is {end / longest:.3g} times the longest transit time {longest:g} s, "
        f"more than the clock can count; stop before {most:.3g} s"
    )


def too_short(path: str, transit: float, longest: float) -> tuple[str, str]:
    """Path and sentence for a segment, if no clock holds its transit time beside the longest, s."""
    return path, (
        f"its transit time {transit:.3g} s is too short beside the longest, {longest:.3g} s: the "
        "clock holds ratios up to about 2e11; leave this segment out"
    )
