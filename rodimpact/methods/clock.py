"""A row of bodies on a clock of whole ticks: what fields need to know of any method's run."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..model import System


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
        return sum(self.impedance[s] * self.ticks[s] for s in range(first, last + 1)) * self.tick
