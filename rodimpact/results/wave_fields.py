"""Fields from the signals that leave the ends of rods.

A wave seen at x left its end x/c earlier, so fields are look-ups: v = (a + b)/2 and
strain = (b - a)/(2c), with a and b the end signals delayed. Their integrals give displacement,
momentum and energy. Times are rounded to the nearest tick, so that one-sided limits are defined.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..methods import kernels
from ..methods.clock import Clock
from ..methods.compiling import as_objects
from ..methods.fronts.records import NONE, ROW
from ..methods.fronts.stock import largest_difference
from ..methods.run import Signals
from ..methods.signals import (
    Floats,
    Ints,
    Pieces,
    Side,
    difference,
    each_once,
    integral_of_product,
)
from ..model import Rod
from .fields import Fields, Profile, Trace

PAIR_TIME = 5e-7  # s of plain Python for two waves that meet
SLIVER = 64  # ticks: waves that last no longer come of round-off


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

    def __init__(self, clock: Clock, end: int, signals: Signals) -> None:
        super().__init__(clock, end, signals.masses, signals.edges)
        self.signals: Sequence[Pieces | None] = signals.motion.lines

    def waves(self, segment: int) -> tuple[Pieces, Pieces]:
        """Signals leaving the left and the right end of a segment."""
        a, b = self.signals[2 * segment], self.signals[2 * segment + 1]
        assert a is not None
        assert b is not None
        return a, b

    @cached_property
    def constant_between_fronts(self) -> bool:
        return all(wave is None or wave.size == 1 for wave in self.signals)

    # Where ------------------------------------------------------------------------------------

    def locate(self, body: int, x: ArrayLike) -> tuple[Ints, Ints]:
        """Segment and ticks from its left end of places x in a body, m from its left end."""
        segment, x = self.segment_at(body, x), self.check(body, x)
        first, last = self.clock.spans[body]
        piece, edges = segment - first, self.edges(body)
        lengths = np.array(self.clock.length[first : last + 1])[piece]
        transit = np.array(self.clock.ticks[first : last + 1])[piece]
        offset = np.rint((x - edges[piece]) / lengths * transit).astype(np.int64)
        return segment, np.clip(offset, 0, transit)

    # Fields -----------------------------------------------------------------------------------

    def velocity(self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right") -> Floats:
        v = self._combine(body, x, t, side, 1.0, lambda _: 0.5, self.clock.frame)
        return v + self._fallen(t) if self.clock.gravity else v

    def strain(self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right") -> Floats:
        c = self.clock.wave_speed
        return self._combine(body, x, t, side, -1.0, lambda s: 0.5 / c[s], 0.0)

    def _combine(
        self, body: int, x: ArrayLike, t: ArrayLike, side: Side, sign: float, factor: Any,
        shift: float,
    ) -> Floats:
        """(sign a + b) * factor(segment) + shift."""
        segment, offset = self.locate(body, x)
        ticks = self.to_ticks(t, side)
        shape = self._together(offset, ticks)
        grid = self._open_grid(offset, ticks, shape)
        if grid is not None and side == "right" and self.constant_between_fronts:
            flat, when, x_first = grid
            out: Floats = np.empty((flat.size, when.size))
            where = segment.ravel()
            for s in np.unique(where):
                rows = where == s
                values = self._on_grid(int(s), flat[rows], when, sign, factor(int(s)), shift)
                if rows.all():
                    out = values
                else:
                    out[rows] = values
            return out.reshape(shape) if x_first else np.ascontiguousarray(out.T).reshape(shape)
        segment, offset, ticks = np.broadcast_arrays(segment, offset, ticks)
        out = np.empty(shape)
        for s in np.unique(segment):
            here = segment == s
            A, B = self.waves(int(s))
            T, o, when = self.clock.ticks[s], offset[here], ticks[here]
            total = sign * A.at(when - o, side) + B.at(when - (T - o), side)
            out[here] = total * factor(int(s)) + shift
        return out

    @staticmethod
    def _open_grid(x: Ints, t: Ints, shape: tuple[int, ...]) -> tuple[Ints, Ints, bool] | None:
        """Flat places and times, and whether places come first, if the two span a grid."""
        if x.size * t.size != np.prod(shape, dtype=int) or min(x.size, t.size) < 2:
            return None
        xs, ts = [i for i, n in enumerate(x.shape[::-1]) if n > 1], [
            i for i, n in enumerate(t.shape[::-1]) if n > 1
        ]
        when = t.ravel()
        if len(xs) != 1 or len(ts) != 1 or np.any(when[1:] < when[:-1]):
            return None
        return x.ravel(), when, xs[0] > ts[0]

    def _on_grid(
        self, s: int, offset: Ints, when: Ints, sign: float, factor: float, shift: float
    ) -> Floats:
        """Values where they are constant between the times at which fronts come to each place."""
        A, B = self.waves(s)
        fronts = A.ticks[1:, None] + offset, B.ticks[1:, None] + (self.clock.ticks[s] - offset)
        first = np.searchsorted(when, np.concatenate(fronts).T)  # time that sees each, by place
        order = np.argsort(first, axis=1, kind="stable")
        come = np.zeros((2, len(offset), order.shape[1] + 1), int)  # of A, and of B
        np.cumsum(order < len(A.ticks) - 1, axis=1, out=come[0, :, 1:])
        come[1] = np.arange(order.shape[1] + 1) - come[0]
        level = (sign * A.values[come[0]] + B.values[come[1]]) * factor + shift
        stops = np.full(level.shape, len(when))
        stops[:, :-1] = np.take_along_axis(first, order, axis=1)
        counts = np.diff(stops, axis=1, prepend=0)
        return np.repeat(level.ravel(), counts.ravel()).reshape(len(offset), len(when))

    def displacement(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        a, when = self.clock, self.to_ticks(t)
        segment, offset = self.locate(body, x)
        self._together(offset, when)
        segment, offset, ticks = np.broadcast_arrays(segment, offset, when)
        out = np.empty(offset.shape)
        for s in np.unique(segment):
            here = segment == s
            p, q = ticks[here] - offset[here], ticks[here] - a.ticks[s] + offset[here]
            out[here] = self.displacement_of_waves(int(s), p, q)
        time = when * a.tick
        return out + a.gravity * time * time / 2

    def displacement_of_waves(self, segment: int, p: Ints, q: Ints) -> Floats:
        """Displacement, m, where the waves meet that left the two ends at ticks p and q."""
        a = self.clock
        A, B = self.waves(segment)
        T = a.ticks[segment]
        moved = A.integral(0, p) + B.integral(-T, q) + a.frame * (p + q + T)
        return np.asarray(moved / 2 * a.tick + self._initial_stretch[segment])

    @cached_property
    def _initial_stretch(self) -> list[float]:
        """Initial displacement of each segment's left end."""
        a = self.clock
        starts = [0.0] * len(a.ticks)
        for first, last in a.spans:
            for s in range(first, last):
                A, B = self.waves(s)
                T = a.ticks[s]
                stretch = float(A.integral(0, -T) + B.integral(-T, 0)) / 2
                starts[s + 1] = starts[s] + stretch * a.tick
        return starts

    def averaged(self, body: int, x: Floats, t: Floats) -> tuple[Floats, Floats]:
        a = self.clock
        segment, offset = self.locate(body, x)
        ticks = self.to_ticks(t)
        velocity, strain = np.empty((2, segment.size, ticks.size - 1))
        for s in np.unique(segment):
            here = segment == s
            A, B = self.waves(int(s))
            away = offset[here, None]
            right, left = (
                np.diff(wave.integral(0, ticks - delay)) / np.diff(ticks)
                for wave, delay in ((A, away), (B, a.ticks[s] - away))
            )
            velocity[here] = (left + right) / 2
            strain[here] = (left - right) * (0.5 / a.wave_speed[s])
        fallen = a.gravity * a.tick * (ticks[:-1] + ticks[1:]) / 2
        return velocity + a.frame + fallen, strain

    def trace(self, body: int, x: float) -> Trace:
        a = self.clock
        segment, offset = (int(v) for v in self.locate(body, x))
        A, B = self.waves(segment)
        T = a.ticks[segment]
        delays = offset, T - offset
        ticks = each_once([0], A.breaks + offset, B.breaks + (T - offset))
        ticks = ticks[(ticks >= 0) & (ticks <= self.end)]
        right, left = (
            wave.later(delay).cut(ticks, self.end)
            for wave, delay in zip((A, B), delays, strict=True)
        )
        return Trace(right, left, difference(left, right), a.wave_speed[segment])

    # Integrals over bodies ----------------------------------------------------------------------

    def momentum(self, body: int, t: ArrayLike) -> Floats:
        ticks, a = self.to_ticks(t), self.clock
        total: Any = 0.0
        first, last = a.spans[body]
        for s in range(first, last + 1):
            A, B = self.waves(s)
            T = a.ticks[s]
            inside = A.integral(ticks - T, ticks) + B.integral(ticks - T, ticks)
            total = total + a.impedance[s] * (inside / 2 + a.frame * T) * a.tick
        if a.gravity:
            total = total + a.mass(body) * self._fallen(t)
        return np.asarray(total)

    def energy(self, body: int, tick: int, velocity: float) -> tuple[float, float]:
        a = self.clock
        kinetic = strain = 0.0
        first, last = a.spans[body]
        for s in range(first, last + 1):
            A, B = self.waves(s)
            T, V = a.ticks[s], velocity - a.frame - a.gravity * tick * a.tick
            A, B = (wave.within(tick - T, tick).plus(-V) for wave in (A, B))
            both = sum(integral_of_product(w, w, tick - T, tick) for w in (A, B)) / 4
            crossed = integral_of_product(A, B, tick - T, tick, about=2 * tick - T) / 2
            scale = a.impedance[s] * a.tick
            kinetic += scale * (both + crossed) / 2
            strain += scale * (both - crossed) / 2
        return kinetic, strain

    def largest_stress(self, body: int) -> float:
        stresses, (first, last) = [], self.clock.spans[body]
        rod = self.clock.system.bodies[body]
        assert isinstance(rod, Rod)
        for s, piece in zip(range(first, last + 1), rod.segments, strict=True):
            waves = [_in_steps(wave) for wave in self.waves(s)]
            counts = [len(wave.ticks) for wave in waves]
            log = np.zeros(sum(counts), ROW)
            log["tick"] = np.concatenate([w.ticks for w in waves])
            log["value"] = np.concatenate([w.values for w in waves])
            log["after"] = np.arange(1, sum(counts) + 1)
            log["after"][[counts[0] - 1, -1]] = NONE
            overlapping = counts[0] * counts[1] * min(1.0, 2 * self.clock.ticks[s] / self.end)
            ends = 0, counts[0], self.clock.ticks[s], self.end, SLIVER
            if kernels.worth_compiling(overlapping * PAIR_TIME, largest_difference):
                parted = kernels.compiled(largest_difference)(log, *ends)
            else:
                parted = largest_difference(as_objects(log), *ends)
            E = float(piece.material.youngs_modulus)
            stresses.append(E * parted / (2 * self.clock.wave_speed[s]))
        return float(max(stresses))

    def profile(self, body: int, tick: int) -> Profile:
        a = self.clock
        first, last = a.spans[body]
        starts = self.edges(body)
        edges, velocity, strain, segments = [0.0], [], [], []
        for s in range(first, last + 1):
            A, B = self.waves(s)
            T = a.ticks[s]
            cuts = each_once(tick - A.within(tick - T, tick).marks,
                             B.within(tick - T, tick).marks - tick + T)
            unsure = tick >> 51  # it comes from a time: what left within that has just left
            bounds = np.concatenate(([0], cuts[(cuts > unsure) & (cuts < T - unsure)], [T]))
            right = A.means(tick - bounds[1:], tick - bounds[:-1])
            left = B.means(tick - T + bounds[:-1], tick - T + bounds[1:])
            x0, L = starts[s - first], a.length[s]
            edges += [*(x0 + L * (bounds[1:-1] / T)).tolist(), float(starts[s - first + 1])]
            drift = a.frame + a.gravity * tick * a.tick
            velocity += ((right + left) / 2 + drift).tolist()
            strain += ((left - right) * (0.5 / a.wave_speed[s])).tolist()
            segments += [s] * (len(bounds) - 1)
        return Profile(np.array(edges), np.array(velocity), np.array(strain), np.array(segments))


def _in_steps(wave: Pieces) -> Pieces:
    """A wave as constants that follow it closely."""
    return wave if wave.size == 1 else Pieces(wave.marks, wave.at(wave.marks))
