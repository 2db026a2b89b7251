"""Fields from the signals that leave the ends of rods.

A wave seen at x left its end x/c earlier, so fields are look-ups: v = (a + b)/2 and
strain = (b - a)/(2c), with a and b the end signals delayed. Their integrals give displacement,
momentum and energy. Times are rounded to the nearest tick, so that one-sided limits are defined.
"""

import math
from collections.abc import Callable, Iterator
from functools import cached_property
from itertools import accumulate, pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..methods.signals import Floats, Ints, Pieces, Side, each_once, quadrature
from .extreme_stress import ExtremeStress, StressPeak, strongest
from .fields import Fields, Profile
from .wave_extremes import Meeting, extreme_differences

FAR = 1 << 61  # ticks: before all fronts

Seen: TypeAlias = Callable[[int, Pieces, Pieces, Ints, Ints], Floats]
"""A value, of the segment, the waves that leave its two ends, and the ticks at which what meets
left them."""


class WaveFields(Fields):
    """Fields of a row of rods from its end signals.

    Parameters
    ----------
    clock : Clock
    end : int
        Last tick.
    signals : Signals
        Whose motion is `Waves`.
    """

    def waves(self, segment: int) -> tuple[Pieces, Pieces]:
        """Signals leaving the left and the right end of a segment."""
        return self.motion.lines[2 * segment], self.motion.lines[2 * segment + 1]

    def along(self, body: int) -> Iterator[tuple[int, int, Pieces, Pieces]]:
        """Segments of a rod from left to right: place in the row, transit time, both signals."""
        first, last = self.clock.spans[body]
        for s in range(first, last + 1):
            yield s, self.clock.ticks[s], *self.waves(s)

    @cached_property
    def constant_between_fronts(self) -> bool:
        return all(wave is None or wave.size == 1 for wave in self.motion.lines)

    # Where ------------------------------------------------------------------------------------

    def _offset(self, body: int, x: ArrayLike) -> tuple[Ints, Ints]:
        """Segment and ticks from its left end of places x in a body, m from its left end."""
        segment, inside = self.locate(body, x)
        length, transit = (
            np.array(of)[segment] for of in (self.clock.length, self.clock.ticks)
        )
        return segment, np.clip(
            np.rint(inside / length * transit).astype(np.int64), 0, transit
        )

    # Fields -----------------------------------------------------------------------------------

    def rod_velocity(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:
        def velocity(_s: int, A: Pieces, B: Pieces, p: Ints, q: Ints) -> Floats:
            return (A.at(p, side) + B.at(q, side)) * 0.5 + self.clock.frame

        return self._values(body, x, ticks, velocity, side == "right")

    def rod_strain(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:
        def strain(s: int, A: Pieces, B: Pieces, p: Ints, q: Ints) -> Floats:
            per_wave = 0.5 / self.clock.wave_speed[s]
            return (B.at(q, side) - A.at(p, side)) * per_wave + 0.0  # no -0.0

        return self._values(body, x, ticks, strain, side == "right")

    def _values(
        self, body: int, x: Floats, ticks: Ints, value: Seen, onward: bool = False
    ) -> Floats:
        """Values at places and ticks; `onward`: of waves that hold from each front on."""
        if (
            onward
            and self.constant_between_fronts
            and ticks.ndim == 1
            and np.shape(x) == (np.size(x) or 1, 1)
            and np.all(ticks[1:] >= ticks[:-1])
        ):
            return self._on_grid(body, x, ticks, value)
        segments, offset = self._offset(body, x)
        out = np.empty(self._together(offset, ticks))
        segment, offset, ticks = np.broadcast_arrays(segments, offset, ticks)
        for s in np.unique(segments).tolist():
            here = segment == s
            p = ticks[here] - offset[here]
            out[here] = value(
                s, *self.waves(s), p, p + 2 * offset[here] - self.clock.ticks[s]
            )
        return out

    def _on_grid(self, body: int, x: Floats, when: Ints, value: Seen) -> Floats:
        """Values at places [place, 1] and increasing ticks, each found once between two fronts."""
        segment, offset = self._offset(body, x)
        levels, counts = [], []
        borders = np.flatnonzero(np.diff(segment, axis=0, prepend=0, append=0))
        for start, stop in pairwise(borders):
            s, inside = int(segment[start, 0]), offset[start:stop]
            (A, B), T = self.waves(s), self.clock.ticks[s]
            fronts = np.concatenate(
                (A.ticks[1:] + inside, B.ticks[1:] + T - inside), axis=1
            )
            seen = np.sort(when.searchsorted(fronts.T), axis=0).T
            counts.append(np.diff(seen, prepend=0, append=len(when)).ravel())
            starts = np.sort(np.append(fronts, inside - FAR, axis=1))
            levels.append(value(s, A, B, starts - inside, starts + inside - T).ravel())
        whole = np.repeat(np.concatenate(levels), np.concatenate(counts))
        return whole.reshape(len(offset), len(when))

    def rod_displacement(self, body: int, x: Floats, ticks: Ints) -> Floats:
        return self._values(body, x, ticks, self._displaced)

    def _displaced(self, s: int, A: Pieces, B: Pieces, p: Ints, q: Ints) -> Floats:
        """Displacement, m, where the waves meet that left the two ends at ticks p and q."""
        a, T = self.clock, self.clock.ticks[s]
        moved = A.integral(0, p) + B.integral(-T, q) + a.frame * (p + q + T)
        return np.asarray(moved / 2 * a.tick + self._initial_stretch[s])

    @cached_property
    def _initial_stretch(self) -> list[float]:
        """Initial displacement of each segment's left end."""
        starts = [0.0]  # of the outside
        for body in range(len(self.clock.spans)):
            longer = [
                float(A.integral(0, -T) + B.integral(-T, 0)) / 2 * self.clock.tick
                for _, T, A, B in self.along(body)
            ]
            starts += [*accumulate(longer, initial=0.0)][:-1]
        return starts

    def strained(self, body: int, x: Floats, ticks: Ints) -> Floats:
        def strained(s: int, A: Pieces, B: Pieces, p: Ints, q: Ints) -> Floats:
            return (B.integral(0, q) - A.integral(0, p)) * (
                0.5 / self.clock.wave_speed[s]
            )

        return self._values(body, x[:, None], ticks, strained)

    def trace(self, body: int, x: float) -> tuple[Pieces, Pieces, Pieces, float]:
        segment, offset = (int(v) for v in self._offset(body, x))
        A, B = self.waves(segment)
        right, left = A.later(offset), B.later(self.clock.ticks[segment] - offset)
        ticks = each_once([0], right.breaks, left.breaks)
        ticks = ticks[(ticks >= 0) & (ticks <= self.end)]
        right, left = right.cut(ticks, self.end), left.cut(ticks, self.end)
        return right, left, left - right, self.clock.wave_speed[segment]

    # Integrals over bodies ----------------------------------------------------------------------

    def momentum(self, body: int, t: ArrayLike) -> Floats:
        ticks, a = self.to_ticks(t), self.clock
        passed = (
            (s, T, A.integral(ticks - T, ticks) + B.integral(ticks - T, ticks))
            for s, T, A, B in self.along(body)
        )
        total = sum(
            a.impedance[s] * (inside / 2 + a.frame * T) * a.tick
            for s, T, inside in passed
        )
        return np.asarray(total + a.mass(body) * self._fallen(ticks))

    def energy(self, body: int, tick: int, velocity: float) -> tuple[float, float]:
        a = self.clock
        energies = np.zeros(2)
        V = velocity - a.frame - a.gravity * tick * a.tick
        for s, T, A, B in self.along(body):
            start = tick - T
            waves = A.within(start, tick), B.within(start, tick).turned(start + tick)
            edges = each_once(
                [start], *(wave.breaks_in(start, tick) for wave in waves), [tick]
            )
            shares, weights = quadrature(max(A.size, B.size))
            up, down = (
                wave.inside(edges[:-1], edges[1:], shares) - V for wave in waves
            )
            squares = [
                (w * w) @ weights @ np.diff(edges) for w in (up + down, up - down)
            ]
            energies += np.array(squares) * (a.impedance[s] * a.tick / 8)
        return float(energies[0]), float(energies[1])

    def extreme_stress(self, body: int) -> ExtremeStress:
        tensions = []
        compressions = []
        segments = self.rods[body].segments
        for i, (s, T, A, B) in enumerate(self.along(body)):
            modulus = float(segments[i].material.youngs_modulus)
            per_wave = modulus / (2 * self.clock.wave_speed[s])
            highest, lowest = extreme_differences(A, B, T, self.end)
            if highest is not None:
                tensions.append(self._peak(body, s, highest, per_wave))
            if lowest is not None:
                compressions.append(self._peak(body, s, lowest, per_wave))
        return ExtremeStress(strongest(tensions), strongest(compressions))

    def _peak(
        self, body: int, segment: int, meeting: Meeting, per_wave: float
    ) -> StressPeak:
        """The stress where two waves meet in a segment.

        `per_wave` is the stress for a unit difference of the waves, Pa s/m.
        """
        first, last = self.clock.spans[body]
        T = self.clock.ticks[segment]
        left = float(self.edges(body)[segment - first])
        # On whole ticks, so that a field asked for there sees the same waves.
        offset = min((meeting.q - meeting.p + T + 1) // 2, T)
        tick = (meeting.p + meeting.q + T + 1) // 2
        x = left + self.clock.length[segment] * (offset / T)
        if offset == T and segment < last:
            x = math.nextafter(x, left)  # a border belongs to the segment on its right
        return StressPeak(per_wave * meeting.difference, x, tick * self.clock.tick)

    def profile(self, body: int, tick: int) -> Profile:
        a, parts = self.clock, []
        drift = a.frame + a.gravity * tick * a.tick
        ends = pairwise(self.edges(body))
        for (s, T, A, B), (start, stop) in zip(self.along(body), ends, strict=True):
            cuts = each_once(
                tick - A.within(tick - T, tick).marks,
                B.within(tick - T, tick).marks - tick + T,
            )
            unsure = (
                tick >> 51
            )  # it comes from a time: what left within that has just left
            bounds = np.concatenate(
                ([0], cuts[(cuts > unsure) & (cuts < T - unsure)], [T])
            )
            right = A.means(tick - bounds[1:], tick - bounds[:-1])
            left = B.means(tick - T + bounds[:-1], tick - T + bounds[1:])
            parts.append(
                (
                    np.append(start + a.length[s] * (bounds[1:-1] / T), stop),
                    (right + left) / 2 + drift,
                    (left - right) * (0.5 / a.wave_speed[s]),
                )
            )
        edges, *others = (np.concatenate(of) for of in zip(*parts, strict=True))
        return Profile(np.append(0.0, edges), *others)
