"""Fields from the signals that leave the ends of rods.

Let A and B be the waves, m/s, that leave the left and the right end of a segment with
the transit time T. The parts of them that left at p and q meet at the time
t = (p + q + T)/2, at the distance c (q - p + T)/2 from the left end. There, in the
frame of the clock,

    v = (A(p) + B(q))/2        and        strain = (B(q) - A(p))/(2 c).

So a field is a look-up in two signals, and displacement, momentum and energy are
integrals of them. Times are rounded to the nearest tick, so that one-sided limits are
defined.
"""

import math
from collections.abc import Callable, Iterator
from functools import cached_property, partial
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..methods.signals import Floats, Ints, Pieces, Side, each_once, quadrature
from .extreme_stress import ExtremeStress, StressPeak, strongest
from .fields import Fields, PassingWaves, Profile, RodEnergy
from .wave_extremes import Meeting, extreme_differences

BEFORE_ALL_FRONTS = -(1 << 61)  # tick


class SegmentWaves(NamedTuple):
    """A segment and its two waves, m/s in the frame of the clock."""

    segment: int  # place in the row, counted from 1
    transit: int  # transit time T, ticks
    rightward: Pieces  # A, which leaves the left end
    leftward: Pieces  # B, which leaves the right end


class Places(NamedTuple):
    """Places in a rod, by segment; arrays of one shape."""

    segment: Ints
    offset: Ints  # distance from the left end of the segment, ticks


Formula: TypeAlias = Callable[[SegmentWaves, Ints, Ints], Floats]
"""A field of a segment: its value where parts of its two waves meet that left the left
and the right end at the ticks p and q."""


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

    def waves(self, segment: int) -> SegmentWaves:
        """The waves of a segment, counted from 1."""
        rightward = self.motion.lines[2 * segment]
        leftward = self.motion.lines[2 * segment + 1]
        return SegmentWaves(segment, self.clock.ticks[segment], rightward, leftward)

    def waves_along(self, body: int) -> Iterator[SegmentWaves]:
        """The waves of the segments of a rod, from left to right."""
        first, last = self.clock.spans[body]
        for segment in range(first, last + 1):
            yield self.waves(segment)

    @cached_property
    def constant_between_fronts(self) -> bool:
        return all(wave is None or wave.size == 1 for wave in self.motion.lines)

    # Fields where two waves meet --------------------------------------------------------

    def _velocity(self, waves: SegmentWaves, p: Ints, q: Ints, side: Side) -> Floats:
        """v = (A(p) + B(q))/2 + frame, m/s."""
        A = waves.rightward
        B = waves.leftward
        return (A.at(p, side) + B.at(q, side)) * 0.5 + self.clock.frame

    def _strain(self, waves: SegmentWaves, p: Ints, q: Ints, side: Side) -> Floats:
        """(B(q) - A(p))/(2 c)."""
        A = waves.rightward
        B = waves.leftward
        per_wave = 0.5 / self.clock.wave_speed[waves.segment]
        return (B.at(q, side) - A.at(p, side)) * per_wave + 0.0  # no -0.0

    def _displacement(self, waves: SegmentWaves, p: Ints, q: Ints) -> Floats:
        """u0 + (integral of A from 0 to p + integral of B from -T to q)/2 + frame t, m.

        u0 is the displacement of the left end at t = 0.
        """
        A = waves.rightward
        B = waves.leftward
        T = waves.transit
        frame = self.clock.frame
        twice = A.integral(0, p) + B.integral(-T, q) + frame * (p + q + T)
        u0 = self._start_displacements[waves.segment]
        return np.asarray(twice / 2 * self.clock.tick + u0)

    def _strain_integral(self, waves: SegmentWaves, p: Ints, q: Ints) -> Floats:
        """(integral of B from 0 to q - integral of A from 0 to p)/(2 c), ticks.

        At one place this grows by the integral of the strain over time.
        """
        A = waves.rightward
        B = waves.leftward
        per_wave = 0.5 / self.clock.wave_speed[waves.segment]
        return (B.integral(0, q) - A.integral(0, p)) * per_wave

    @cached_property
    def _start_displacements(self) -> list[float]:
        """Displacement of the left end of each segment at t = 0, m.

        They are by segment with the outside on the left.
        """
        displacements = [0.0]
        for body in range(len(self.clock.spans)):
            displacement = 0.0
            for waves in self.waves_along(body):
                displacements.append(displacement)
                displacement += self._start_lengthening(waves)
        return displacements

    def _start_lengthening(self, waves: SegmentWaves) -> float:
        """How much longer a segment is at t = 0 than without strain, m."""
        A = waves.rightward
        B = waves.leftward
        T = waves.transit
        twice = float(A.integral(0, -T) + B.integral(-T, 0))
        return twice / 2 * self.clock.tick

    # Fields at places and times ---------------------------------------------------------

    def rod_velocity(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:
        formula = partial(self._velocity, side=side)
        return self._one_sided_values(body, x, ticks, side, formula)

    def rod_strain(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:
        formula = partial(self._strain, side=side)
        return self._one_sided_values(body, x, ticks, side, formula)

    def rod_displacement(self, body: int, x: Floats, ticks: Ints) -> Floats:
        return self._values(body, x, ticks, self._displacement)

    def strain_integral(self, body: int, x: Floats, ticks: Ints) -> Floats:
        return self._values(body, x[:, None], ticks, self._strain_integral)

    def _places(self, body: int, x: ArrayLike) -> Places:
        """Places x in a body, m from its left end, in ticks."""
        segment, distance = self.locate(body, x)
        length = np.array(self.clock.length)[segment]
        transit = np.array(self.clock.ticks)[segment]
        offset = np.rint(distance / length * transit).astype(np.int64)
        return Places(segment, np.clip(offset, 0, transit))

    def _one_sided_values(
        self, body: int, x: Floats, ticks: Ints, side: Side, formula: Formula
    ) -> Floats:
        """Limits of a field from one side; places and ticks broadcast."""
        holds_from_front_on = side == "right" and self.constant_between_fronts
        if holds_from_front_on and _is_grid(x, ticks):
            return self._grid_values(body, x, ticks, formula)
        return self._values(body, x, ticks, formula)

    def _values(self, body: int, x: Floats, ticks: Ints, formula: Formula) -> Floats:
        """Values of a field; places and ticks broadcast."""
        places = self._places(body, x)
        values = np.empty(self._broadcast_shape(places.offset, ticks))
        segment, offset, ticks = np.broadcast_arrays(*places, ticks)
        for index in np.unique(places.segment).tolist():
            waves = self.waves(index)
            here = segment == index
            p = ticks[here] - offset[here]
            q = p + 2 * offset[here] - waves.transit
            values[here] = formula(waves, p, q)
        return values

    def _grid_values(
        self, body: int, x: Floats, ticks: Ints, formula: Formula
    ) -> Floats:
        """Values on a grid, see `_is_grid`, of a field that is constant between fronts.

        Each value is found once, at the front from which it holds, and repeated until
        the next one.
        """
        places = self._places(body, x)
        values = []
        repeats = []
        segment_edges = np.diff(places.segment, axis=0, prepend=0, append=0)
        for start, stop in pairwise(np.flatnonzero(segment_edges)):
            waves = self.waves(int(places.segment[start, 0]))
            A = waves.rightward
            B = waves.leftward
            T = waves.transit
            offset = places.offset[start:stop]
            from_left = A.ticks[1:] + offset
            from_right = B.ticks[1:] + T - offset
            fronts = np.concatenate((from_left, from_right), axis=1)
            first_after = np.sort(ticks.searchsorted(fronts.T), axis=0).T
            repeats.append(np.diff(first_after, prepend=0, append=len(ticks)).ravel())
            begins = np.sort(np.append(fronts, offset + BEFORE_ALL_FRONTS, axis=1))
            p = begins - offset
            q = begins + offset - T
            values.append(formula(waves, p, q).ravel())
        on_grid = np.repeat(np.concatenate(values), np.concatenate(repeats))
        return on_grid.reshape(len(places.offset), len(ticks))

    def point_history(self, body: int, x: float) -> PassingWaves:
        places = self._places(body, x)
        offset = int(places.offset)
        waves = self.waves(int(places.segment))
        rightward = waves.rightward.later(offset)
        leftward = waves.leftward.later(waves.transit - offset)
        breaks = each_once([0], rightward.breaks, leftward.breaks)
        breaks = breaks[(breaks >= 0) & (breaks <= self.end)]
        rightward = rightward.cut(breaks, self.end)
        leftward = leftward.cut(breaks, self.end)
        wave_speed = self.clock.wave_speed[waves.segment]
        return PassingWaves(rightward, leftward, leftward - rightward, wave_speed)

    # Integrals over bodies --------------------------------------------------------------

    def momentum(self, body: int, t: ArrayLike) -> Floats:
        """Sum over segments of Z (integral of v over their transit time), kg m/s.

        In the frame this is Z/2 times the integral of A + B from t - T to t.
        """
        clock = self.clock
        ticks = self.to_ticks(t)
        momentum: Any = 0.0
        for waves in self.waves_along(body):
            A = waves.rightward
            B = waves.leftward
            T = waves.transit
            twice = A.integral(ticks - T, ticks) + B.integral(ticks - T, ticks)
            velocity_integral = twice / 2 + clock.frame * T
            Z = clock.impedance[waves.segment]
            momentum = momentum + Z * velocity_integral * clock.tick
        return np.asarray(momentum + clock.mass(body) * self._fall_velocity(ticks))

    def energy(self, body: int, tick: int, velocity: float) -> RodEnergy:
        """Sums over segments of Z/8 times the integrals of (A + B)^2 and of (A - B)^2.

        A and B are the waves in the segment at `tick`, less the velocity.
        """
        clock = self.clock
        in_frame = velocity - clock.frame - clock.gravity * tick * clock.tick
        kinetic = 0.0
        strain = 0.0
        for waves in self.waves_along(body):
            start = tick - waves.transit
            rightward = waves.rightward.within(start, tick)
            leftward = waves.leftward.within(start, tick).time_reversed(start + tick)
            from_left = rightward.breaks_in(start, tick)
            from_right = leftward.breaks_in(start, tick)
            edges = each_once([start], from_left, from_right, [tick])
            shares, weights = quadrature(max(rightward.size, leftward.size))
            A = rightward.inside(edges[:-1], edges[1:], shares) - in_frame
            B = leftward.inside(edges[:-1], edges[1:], shares) - in_frame
            total = A + B
            difference = A - B
            widths = np.diff(edges)
            factor = clock.impedance[waves.segment] * clock.tick / 8
            kinetic += float((total * total) @ weights @ widths * factor)
            strain += float((difference * difference) @ weights @ widths * factor)
        return RodEnergy(kinetic, strain)

    def extreme_stress(self, body: int) -> ExtremeStress:
        tensions = []
        compressions = []
        segments = self.rods[body].segments
        for segment, waves in zip(segments, self.waves_along(body), strict=True):
            modulus = float(segment.material.youngs_modulus)
            per_wave = modulus / (2 * self.clock.wave_speed[waves.segment])
            highest, lowest = extreme_differences(
                waves.rightward, waves.leftward, waves.transit, self.end
            )
            if highest is not None:
                tensions.append(self._peak(body, waves.segment, highest, per_wave))
            if lowest is not None:
                compressions.append(self._peak(body, waves.segment, lowest, per_wave))
        return ExtremeStress(strongest(tensions), strongest(compressions))

    def _peak(
        self, body: int, segment: int, meeting: Meeting, per_wave: float
    ) -> StressPeak:
        """The stress, place and time at which two waves meet in a segment of the row.

        `per_wave` is the stress for a unit difference of the waves, Pa s/m.
        """
        first, last = self.clock.spans[body]  # segments of the body
        T = self.clock.ticks[segment]
        left = float(self.edges(body)[segment - first])
        # On whole ticks, so that a field asked for there sees the same waves: halves go up.
        offset = min((meeting.q - meeting.p + T + 1) // 2, T)
        tick = (meeting.p + meeting.q + T + 1) // 2
        x = left + self.clock.length[segment] * (offset / T)
        if offset == T and segment < last:
            x = math.nextafter(x, left)  # a border belongs to the segment on its right
        return StressPeak(per_wave * meeting.difference, x, tick * self.clock.tick)

    def profile(self, body: int, tick: int) -> Profile:
        clock = self.clock
        frame = clock.frame + clock.gravity * tick * clock.tick
        edges = [np.zeros(1)]
        velocities = []
        strains = []
        ends = pairwise(self.edges(body))
        for waves, (left, right) in zip(self.waves_along(body), ends, strict=True):
            T = waves.transit
            bounds = _piece_bounds(waves, tick)
            rightward = waves.rightward.means(tick - bounds[1:], tick - bounds[:-1])
            start = tick - T
            leftward = waves.leftward.means(start + bounds[:-1], start + bounds[1:])
            inner = left + clock.length[waves.segment] * (bounds[1:-1] / T)
            edges.append(np.append(inner, right))
            velocities.append((rightward + leftward) / 2 + frame)
            per_wave = 0.5 / clock.wave_speed[waves.segment]
            strains.append((leftward - rightward) * per_wave)
        return Profile(
            np.concatenate(edges), np.concatenate(velocities), np.concatenate(strains)
        )


def _is_grid(x: Floats, ticks: Ints) -> bool:
    """Whether places are a column [place, 1], and ticks a row in order."""
    if ticks.ndim != 1 or np.shape(x) != (np.size(x) or 1, 1):
        return False
    return bool(np.all(ticks[1:] >= ticks[:-1]))


def _piece_bounds(waves: SegmentWaves, tick: int) -> Ints:
    """Bounds of constant pieces of a state, ticks from the left end of a segment."""
    T = waves.transit
    start = tick - T
    from_left = tick - waves.rightward.within(start, tick).marks
    from_right = waves.leftward.within(start, tick).marks - tick + T
    cuts = each_once(from_left, from_right)
    # The tick comes from a time, a float. What left within its round-off has just left.
    round_off = tick >> 51
    inside = cuts[(cuts > round_off) & (cuts < T - round_off)]
    return np.concatenate(([0], inside, [T]))
