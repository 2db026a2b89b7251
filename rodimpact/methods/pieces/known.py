"""What is known of all lines at t = 0: waves under way, then what comes from outside."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from ...model import Samples, Steps
from ..compiling import objects
from ..row import Row
from ..signals import Ints, Pieces
from ..walk import wave_of_strain
from . import layout, waves
from .layout import Clock
from .records import NONE, PIECE
from .series import N


def segments_of(row: Row) -> Iterator[tuple[Any, int, Any]]:
    """Segments with their rods, and where they begin in these, m."""
    for body, (first, last) in zip(row.system.bodies, row.spans, strict=True):
        begin: Any = 0.0
        for s in range(first - 1, last):
            yield body, s, begin
            begin = begin + row.segments[s].length


def jumps_of(row: Row) -> list[tuple[int, float]]:
    """Where the initial state jumps inside of a segment: its place, share of it from the left."""
    return [
        (s, float((x - begin) / row.segments[s].length)) for rod, s, begin in segments_of(row)
        for profile in (rod.velocity, rod.strain) if isinstance(profile, Steps)
        for x in profile.at if begin < x < begin + row.segments[s].length
    ]


def varies(*profiles: Any) -> bool:
    """Whether one of these is no number."""
    return any(isinstance(profile, Steps | Samples) for profile in profiles)


class Known:
    """Pieces of all lines that begin at t = 0 or before.

    Attributes
    ----------
    log : list of PIECE
        Line by line: two a segment, then what comes from outside.
    outside : list of int
        The lines of what comes from outside, NONE for the free end of a rod.
    fit : float
        By how much pieces miss what was given, relative to the velocity scale.
    """

    def __init__(
        self, row: Row, clock: Clock, jumps: dict[tuple[int, float], int], tolerance: float,
        until: float | None,
    ) -> None:
        self._row, self._clock, self._jumps, self._until = row, clock, jumps, until
        self._tolerance, self.log, self.fit = tolerance / 4, list[Any](), 0.0
        for rod, s, begin in segments_of(row):
            self._under_way(s, rod, begin)
        self.outside = [self._from_outside(side) for side in (0, 1)]

    def _add(self, *pieces: Any) -> int:
        """Add a line; return its number."""
        l = self.log[-1].line + 1 if self.log else 0
        for piece in pieces:
            piece.line = l
        self.log += pieces
        return int(l)

    def _follow(self, signal: Pieces, stop: int, *given: tuple[Any, float]) -> waves.Fitted:
        """A signal from tick 0 to `stop` as pieces; it is made of profiles times factors."""
        scale, samples = float(self._clock.scale), [x for x in given if isinstance(x[0], Samples)]
        kinked = signal.end < stop - 1 or not all(p.smooth for p, _ in samples)
        made = waves.fitted(signal, stop, kinked, self._tolerance * scale)
        missed = [made.error, *(abs(factor) * p.error for p, factor in samples)]
        self.fit = max(self.fit, max(missed) / scale)
        return made

    def _enter(self, made: waves.Fitted) -> int:
        """Add a line of pieces; return its number."""
        degree = np.where(np.any(made.coefficients[:, 1:], axis=1), N, 0)
        columns = made.ticks[:-1], made.ticks[1:], made.order, degree, made.coefficients
        rows = zip(*(column.tolist() for column in columns), strict=True)
        return self._add(*objects(
            [(start, stop, order, d, 0, NONE, c) for start, stop, order, d, c in rows], PIECE))

    def _under_way(self, s: int, rod: Any, begin: Any) -> None:
        """Waves that run through segment s at t = 0: a = v - c strain, and b = v + c strain."""
        segment, frame, T = self._row.segments[s], self._clock.frame, self._clock.transits[s]
        c = segment.wave_speed
        if not varies(rod.velocity, rod.strain):
            for piece in layout.under_way(rod.velocity - frame, rod.strain * c, T):
                self._add(piece)
            return
        marks = [(share, tick) for (place, share), tick in self._jumps.items() if place == s]

        def ticks_of(x: Any) -> Ints:
            shares = (x - begin) / segment.length
            found = np.rint(shares * T).astype(np.int64)
            for share, tick in marks:
                found[np.abs(shares - share) < 1e-12] = tick
            return found

        v, strain = (waves.signal_of(p, rod.length, ticks_of) for p in (rod.velocity, rod.strain))
        for factor in (-c, c):
            wave = v.plus(-frame)
            if varies(rod.strain):
                wave = wave + strain.times(factor)
            elif rod.strain:
                wave = wave.plus(factor * rod.strain)
            made = self._follow(wave, int(T), (rod.velocity, 1.0), (rod.strain, c))
            # what is at x left the left end x/c ago, and leaves it in x/c
            self._enter(made.backwards() if factor < 0 else made._replace(ticks=made.ticks - T))

    def _from_outside(self, side: int) -> int:
        """Add what comes from outside an end; return its line, NONE for the free end of a rod."""
        row, clock, until = self._row, self._clock, self._until
        kind, value = row.outside[side]
        first, stop = row.first[-2:] if side else row.first[:2]
        if kind == "none" and first == stop:
            return NONE
        factor, start, slope = 1.0, 0.0, 0.0
        if kind == "velocity":
            start, slope = -clock.frame, -row.gravity
        elif kind == "absorbing":
            last = 2 * len(row.segments) - 1 if side else 0
            wave = [piece for piece in self.log if piece.line == last][-1].coefficient
            start = np.stack(np.broadcast_arrays(*wave)).sum(axis=0)  # at its end
            factor = wave_of_strain(row, side)
        if not varies(value):
            if np.any(np.asarray(slope) != 0):
                return self._add(layout.falling(start + value, row.gravity, until, clock.tick))
            return self._add(layout.steady(start + value * factor))
        assert until is not None
        tick = float(clock.tick)
        stop = round(max(until, tick) / tick) + 1
        drive = waves.signal_of(value, until, lambda t: np.rint(t / tick).astype(np.int64))
        drive = drive.times(float(factor)).plus(float(start))
        if slope:
            drive = drive + Pieces.through([0, stop], np.array([0.0, slope * stop * tick]))
        least = min((float(s.impedance) for s in row.segments), default=math.inf)
        return self._enter(self._follow(
            drive, stop, (value, 2 / least if kind == "force" else float(factor))))
