"""What happened at each contact: force, gap, and the episodes of touching."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .fields import WaveFields
from .methods.front_kernel import OPEN, PRESS
from .model import Bonded
from .signals import Floats, Side, StepSignal


class Episode(NamedTuple):
    """One uninterrupted touching that carried force; times in s.

    start : first force; force_end : end of the last force (nan if it lasts to the end);
    opening : when the gap opens (nan if it has not).
    """

    start: float
    force_end: float
    opening: float


class ContactTally(NamedTuple):
    """Totals of one contact, kept while the run went: SI units, times nan where there was none.

    A bonded contact has an impulse and a largest push; the rest is for contacts that can open.
    """

    impulse: float
    peak_force: float
    duration: float
    first: float
    last: float
    episodes: int


class ContactHistory:
    """Force and gap of one contact.

    Attributes
    ----------
    index : int
        Between body `index` and body `index + 1`, walls counted.
    law : contact law
    impulse : float
        Integral of the force, N s.
    duration : float
        Time under force, s.
    peak_force : float
        N.
    episodes : tuple of Episode
    """

    def __init__(
        self,
        index: int,
        fields: WaveFields,
        turns: tuple[list[int], list[int]],
        tally: ContactTally,
    ) -> None:
        a = fields.assembly
        self.index, self.law = index, a.system.contacts[index]
        self.impulse, self.duration = tally.impulse, tally.duration
        self.peak_force = tally.peak_force
        self._fields, self._end, self._tick = fields, fields.end, a.tick
        node = a.nodes[index]
        self._status = StepSignal([-1, *turns[0]], [a.status[node], *turns[1]])
        self.episodes = () if isinstance(self.law, Bonded) else self._read_episodes()
        left, right = self._arrivals(node, 0), self._arrivals(node, 1)
        ticks = np.unique(np.concatenate(([0], left.ticks, right.ticks, self._status.ticks)))
        ticks = ticks[(ticks >= 0) & (ticks <= self._end)]
        closing = left.at(ticks) - right.at(ticks)
        yielding = sum(1 / a.impedance[s] for s in (node, node + 1) if a.impedance[s])
        status = self._status.at(ticks)
        pressing = np.full(ticks.shape, True) if isinstance(self.law, Bonded) else status == PRESS
        force = np.where(pressing, closing / yielding, 0.0)
        self._force = StepSignal(ticks, force)
        opening = np.where(status == OPEN, -closing, 0.0)
        opening[np.abs(opening) <= a.tolerance] = 0.0
        self._rate = StepSignal(ticks, opening)
        travelled = np.concatenate(([0.0], np.cumsum(opening[:-1] * np.diff(ticks))))
        # every change of status but the initial one leaves the gap at 0
        turn = np.searchsorted(ticks, self._status.ticks[1:])
        last = np.searchsorted(self._status.ticks[1:], ticks, "right") - 1
        zero = np.append(travelled[turn], -a.gaps[node])[last]
        gap = np.where(status == OPEN, travelled - zero, 0.0)
        self._gap = gap * a.tick

    def _arrivals(self, node: int, right: int) -> StepSignal:
        a, segment = self._fields.assembly, node + right
        if not a.impedance[segment]:
            return StepSignal([0], [a.outside[right]])
        wave = self._fields.waves(segment)[right]
        return StepSignal(wave.ticks + a.ticks[segment], wave.values)

    def _read_episodes(self) -> tuple[Episode, ...]:
        found: list[Episode] = []
        start = force_end = np.nan
        touching = False
        for tick, status in zip(self._status.ticks[1:], self._status.values[1:], strict=True):
            t = float(tick) * self._tick
            if status == PRESS:
                start, force_end = (start, np.nan) if touching else (t, np.nan)
                touching = True
            elif touching:
                force_end = t if np.isnan(force_end) else force_end
                if status == OPEN:
                    found.append(Episode(start, force_end, t))
                    touching = False
        if touching:
            found.append(Episode(start, force_end, np.nan))
        return tuple(found)

    def force(self, t: ArrayLike, side: Side = "right") -> Floats:
        """Contact force, N, positive in compression; `side` decides at jumps."""
        return self._force.at(self._fields.to_ticks(t, side), side)

    def gap(self, t: ArrayLike) -> Floats:
        """Distance between the two bodies, m; exactly 0 while they touch."""
        ticks = self._fields.to_ticks(t, "right")
        i = np.searchsorted(self._force.ticks, ticks, "right") - 1
        rest = self._rate.values[i] * (ticks - self._force.ticks[i])
        result: Floats = self._gap[i] + rest * self._tick
        return result

    def breakpoints(self) -> tuple[Floats, Floats, Floats]:
        """Times (s) at which force or gap rate may change, force just after (N), and gap (m)."""
        return self._force.ticks * self._tick, self._force.values.copy(), self._gap.copy()

    def impulse_until(self, t: ArrayLike) -> Floats:
        """Integral of the force from 0 to t, N s, from the signals."""
        return self._force.integral(0, self._fields.to_ticks(t)) * self._tick

    def __repr__(self) -> str:
        name = type(self.law).__name__
        return (
            f"<contact {self.index} ({name}): {len(self.episodes)} episodes, impulse "
            f"{self.impulse:.6g} N s, peak force {self.peak_force:.6g} N, under force "
            f"{self.duration:.6g} s>"
        )

