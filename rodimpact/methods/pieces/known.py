"""What is known of all lines at t = 0: waves under way, then what comes from outside."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...model import Rod, Samples, Steps
from ..compiling import as_family
from ..row import Row
from ..walk import wave_of_strain
from . import layout, waves
from .layout import Clock, Given, Known
from .records import HARD, NONE, PIECE
from .series import POINTS


def jumps_of(row: Row) -> list[tuple[int, float]]:
    """Where the initial state jumps inside of a segment: its place, share of it from the left."""
    found = []
    for body, (first, last) in zip(row.system.bodies, row.spans, strict=True):
        profiles = (body.velocity, body.strain) if isinstance(body, Rod) else ()
        at = [float(x) for p in profiles if isinstance(p, Steps) for x in p.at]
        begin = 0.0
        for s in range(first - 1, last if at else first - 1):
            L = float(row.segments[s].length)
            found += [(s, (x - begin) / L) for x in at if begin < x < begin + L]
            begin += L
    return found


def varies(*profiles: Any) -> bool:
    """Whether one of these is no number."""
    return any(isinstance(profile, Steps | Samples) for profile in profiles)


class Waves:
    """Pieces of all lines that begin at t = 0 or before.

    Attributes
    ----------
    records : [member, piece] PIECE
    known : list of Known
        By line: two a segment, then what comes from outside.
    outside : list of int
        The lines of what comes from outside, NONE for the free end of a rod.
    fit : float
        By how much pieces miss what was given, relative to the velocity scale.
    """

    def __init__(
        self, row: Row, given: Given, clock: Clock, jumps: list[list[int]], tolerance: float,
        until: float | None,
    ) -> None:
        self._row, self._given, self._clock, self._until = row, given, clock, until
        self._jumps, self._scale = jumps[0], float(given.scale[0])
        self._tolerance = tolerance / 4 * self._scale
        self.fit, self._lines = 0.0, list[Any]()
        for rod, (first, stop) in zip(row.system.bodies, given.spans, strict=True):
            begin = 0.0
            for s in range(first, stop):
                self._under_way(s, rod, begin)
                begin += float(row.of(row.segments[s].length)[0])  # families are uniform
        self.outside = [self._from_outside(side) for side in (0, 1)]
        self.known = [
            Known(own["start"][:, 0], own["stop"][:, -1], own.shape[1],
                  (own["order"][:, 1:] <= HARD).sum(axis=1)) for own in self._lines]
        self.records = np.concatenate([np.zeros((row.members, 0), PIECE), *self._lines], axis=1)
        first = 0
        for l, line in enumerate(self.known):
            stop = first + line.pieces
            self.records["line"][:, first:stop] = l
            self.records["after"][:, first:stop] = [*range(first + 1, stop), NONE]
            first = stop

    def _even(self, pieces: Sequence[Any]) -> None:
        """Add lines of one piece each."""
        self._lines += [as_family([piece], PIECE, self._row.members) for piece in pieces]

    def _fitted(self, curve: waves.Curve) -> None:
        """Add a line that follows a curve."""
        made = waves.fitted(curve, self._tolerance)
        self.fit = max(self.fit, made.error / self._scale)
        piece = np.zeros((1, len(made.order)), PIECE)
        piece["start"], piece["stop"], piece["order"] = made.ticks[:-1], made.ticks[1:], made.order
        piece["coefficient"] = made.coefficients
        piece["degree"] = np.where(np.any(made.coefficients[:, 1:], axis=1), POINTS - 1, 0)
        self._lines.append(piece)

    def _miss(self, profile: Any, factor: float) -> None:
        """Count the error of samples, in the unit of velocities."""
        if isinstance(profile, Samples):
            self.fit = max(self.fit, abs(factor) * profile.error / self._scale)

    def _under_way(self, s: int, rod: Any, begin: float) -> None:
        """Waves that run through segment s at t = 0: a = v - c strain, and b = v + c strain."""
        row, of, ticks = self._row, self._row.of, self._clock.transits[s]
        c = row.segments[s].wave_speed
        if not varies(rod.velocity, rod.strain):
            v, stretch = of(rod.velocity) - self._given.frame, of(rod.strain) * of(c)
            self._even(layout.under_way(v, stretch, ticks))
            return
        L, T, length = float(row.segments[s].length), int(ticks[0]), float(rod.length)
        state = [waves.part_of(waves.curve_of(p, length), begin, begin + L)
                 for p in (rod.velocity, rod.strain)]
        self._miss(rod.velocity, 1.0)
        self._miss(rod.strain, float(c))
        marks = {share: tick for (place, share), tick in
                 zip(jumps_of(row), self._jumps, strict=True) if place == s}
        for sign in (-1, 1):
            wave = waves.sum_of(state[0], state[1], sign * float(c))
            shares = (wave.edges - begin) / L
            edges = np.rint(shares * T).astype(np.int64)
            for share, tick in marks.items():
                edges[np.abs(shares - share) < 1e-12] = tick
            edges[0], edges[-1] = 0, T
            values = wave.values - float(row.frame)
            if sign < 0:  # what is at x left the left end x/c ago
                self._fitted(waves.Curve(-edges[::-1], values[::-1, ::-1], wave.smooth))
            else:
                self._fitted(waves.Curve(edges - T, values, wave.smooth))

    def _from_outside(self, side: int) -> int:
        """Add what comes from outside an end; return its line, NONE for the free end of a rod."""
        row, of, tick, until = self._row, self._row.of, self._clock.tick, self._until
        kind, value = row.outside[side]
        first, stop = row.first[-2:] if side else row.first[:2]
        if kind == "none" and first == stop:
            return NONE
        factor, start = 1.0, np.zeros(row.members)
        falls = kind == "velocity" and bool(np.any(row.gravity))
        if kind == "velocity":
            start = -self._given.frame
        elif kind == "absorbing":
            wave = self._lines[2 * (len(row.segments) - 1) + 1 if side else 0]
            start = wave["coefficient"][:, -1].sum(axis=1)  # at the end of its last piece
            factor = wave_of_strain(row, side)
        if varies(value):
            self._driven(side, value, float(factor), start)
        elif falls:
            self._even([layout.falling(start + of(value), of(row.gravity), until, tick)])
        else:
            self._even([layout.steady(start + of(value) * of(factor))])
        return len(self._lines) - 1

    def _driven(self, side: int, value: Any, factor: float, start: Any) -> None:
        """Add a drive that is a profile."""
        tick, kind = float(self._clock.tick[0]), self._row.outside[side][0]
        assert self._until is not None
        drive = waves.curve_of(value, max(self._until, tick))
        edges = np.rint(drive.edges / tick).astype(np.int64)
        edges[-1] += 1
        times = edges[:-1, None] + np.diff(edges)[:, None] * waves.SHARES
        slope = -float(self._row.gravity) if kind == "velocity" else 0.0
        shift = float(start[0]) + slope * times * tick
        least = min((float(s.impedance) for s in self._row.segments), default=math.inf)
        self._miss(value, 2 / least if kind == "force" else factor)
        self._fitted(waves.Curve(edges, drive.values * factor + shift, drive.smooth))
