"""What is known of all lines at t = 0: waves under way, then what comes from outside."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from ...model import Polynomials, Samples, Steps
from ..clock import Clock
from ..row import Row
from ..scales import wave_of_strain
from ..signals import Ints, Pieces
from . import layout, waves
from .layout import Asked
from .records import HARD, NONE, PIECE

EXACT_FIT = 2.0**-48  # of the velocity scale


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
        (s, float((x - begin) / row.segments[s].length))
        for rod, s, begin in segments_of(row)
        for profile in (rod.velocity, rod.strain)
        if isinstance(profile, Steps)
        for x in profile.at
        if begin < x < begin + row.segments[s].length
    ]


def varies(*profiles: Any) -> bool:
    """Whether one of these is no number."""
    return any(
        isinstance(profile, Steps | Samples | Polynomials) for profile in profiles
    )


def as_family(objects: list[Any], record: Any, row: Row) -> Any:
    """Objects whose fields hold a number, or one for each member, as records [member, i]."""
    records = np.zeros((*row.system.shape, len(objects)), record)
    for i, one in enumerate(objects):
        for name in record.names:
            value = getattr(one, name)
            if not isinstance(value, list):
                records[name][..., i] = value
                continue
            for j, number in enumerate(value):
                if isinstance(number, list):
                    break  # what is found during the run
                if type(number) is not float or number:
                    records[name][..., i, j] = number
    return records.reshape(row.members, len(objects))


class Known:
    """Pieces of all lines that begin at t = 0 or before.

    Attributes
    ----------
    log : list of [member, piece] PIECE
        Line by line: two a segment, then what comes from outside.
    lines : list of (int, int, int)
        How many pieces, hard breaks and ticks each has.
    outside : list of int
        The lines of what comes from outside, NONE for the free end of a rod.
    fit : float
        By how much the pieces miss what was given, or samples the functions that they stand for,
        relative to the velocity scale.
    carried : float
        Stated error of the run from whose state this one goes on, relative to the velocity scale.
    """

    def __init__(
        self, row: Row, clock: Clock, jumps: dict[tuple[int, float], int], asked: Asked
    ) -> None:
        self._row, self._clock, self._jumps, self._asked = row, clock, jumps, asked
        self.log = list[Any]()
        self.lines = list[tuple[int, int, int]]()
        self.fit = 0.0
        self.carried = 0.0
        for rod, s, begin in segments_of(row):
            self._under_way(s, rod, begin)
        self.outside = [self._from_outside(side) for side in (0, 1)]

    def _add(self, pieces: Any) -> int:
        """Add a line of pieces, [member, piece]; return its number."""
        l, first, (_, n) = (
            len(self.log),
            sum(count for count, _, _ in self.lines),
            pieces.shape,
        )
        pieces["line"], pieces["after"] = l, [*range(first + 1, first + n), NONE]
        hard = int(np.sum(pieces["order"][0, 1:] <= HARD))
        self.log.append(pieces)
        self.lines.append((n, hard, int(pieces["stop"][0, -1] - pieces["start"][0, 0])))
        return l

    def _follow(
        self, signal: Pieces, start: int, stop: int, *given: tuple[Any, float]
    ) -> Any:
        """A signal between two ticks as pieces; it is made of profiles times factors."""
        scale = float(self._clock.scale)
        tolerance = self._asked.tolerance * scale / 4
        fit = tolerance
        if any(isinstance(profile, Polynomials) for profile, _ in given):
            fit = EXACT_FIT * scale  # waves of an earlier run, as they were
        made, missed = waves.in_pieces(signal, start, stop, tolerance, fit)
        self.fit = max(self.fit, missed / scale)
        for profile, factor in given:
            if isinstance(profile, Samples):
                self.fit = max(self.fit, abs(factor) * profile.error / scale)
            elif isinstance(profile, Polynomials):
                error = abs(factor) * profile.error / scale
                self.carried = max(self.carried, error)
        return made

    def _under_way(self, s: int, rod: Any, begin: Any) -> None:
        """Waves that run through segment s at t = 0: a = v - c strain, and b = v + c strain."""
        segment, frame, T = (
            self._row.segments[s],
            self._clock.frame,
            self._clock.transits[s],
        )
        c = segment.wave_speed
        if not varies(rod.velocity, rod.strain):
            for piece in layout.under_way(rod.velocity - frame, rod.strain * c, T):
                self._add(as_family([piece], PIECE, self._row))
            return
        marks = [
            (share, tick) for (place, share), tick in self._jumps.items() if place == s
        ]

        def ticks_of(x: Any) -> Ints:
            shares = (x - begin) / segment.length
            found = np.rint(shares * T).astype(np.int64)
            for share, tick in marks:
                found[np.abs(shares - share) < 1e-12] = tick
            return found

        v, strain = (
            waves.signal_of(p, rod.length, ticks_of) for p in (rod.velocity, rod.strain)
        )
        for factor in (-c, c):
            # what is at x left the left end x/c ago, and the right end T - x/c ago
            given, since = (
                ((rod.velocity, 1.0), (rod.strain, c)),
                0 if factor < 0 else int(-T),
            )
            wave = (v + strain.times(factor)).plus(-frame).later(since)
            made = self._follow(wave, since, since + int(T), *given)
            self._add((waves.backwards(made) if factor < 0 else made)[None])

    def _from_outside(self, side: int) -> int:
        """Add what comes from outside an end; return its line, NONE for the free end of a rod."""
        row, clock, until = self._row, self._clock, self._asked.until
        kind, value = row.outside[side]
        first, stop = row.first[-2:] if side else row.first[:2]
        if kind == "none" and first == stop:
            return NONE
        factor, start, slope = 1.0, 0.0, 0.0
        if kind == "velocity":
            start, slope = -clock.frame, -row.system.gravity
        elif kind == "absorbing":
            ends = self.log[2 * len(row.segments) - 1 if side else 0][:, -1][
                "coefficient"
            ]
            start = ends.sum(axis=1).reshape(row.system.shape)
            factor = wave_of_strain(row, side)
        if not varies(value):
            piece = layout.steady(start + value * factor)
            if np.any(np.asarray(slope) != 0):  # a frame that falls
                stop = np.rint(until / clock.tick) + 1
                half = slope * stop * clock.tick / 2
                piece = layout.piece_of(0, stop, [start + value + half, half])
            return self._add(as_family([piece], PIECE, row))
        assert until is not None
        tick = float(clock.tick)
        stop = round(max(until, tick) / tick) + 1
        drive = waves.signal_of(
            value, until, lambda t: np.rint(t / tick).astype(np.int64)
        )
        drive = drive.times(float(factor)).plus(float(start))
        if slope:
            drive = drive + Pieces.through(
                [0, stop], np.array([0.0, slope * stop * tick])
            )
        least = min((float(s.impedance) for s in row.segments), default=math.inf)
        weight = 2 / least if kind == "force" else float(factor)
        return self._add(self._follow(drive, 0, stop, (value, weight))[None])
