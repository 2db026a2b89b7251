"""Fields from the signals that leave the ends of rods, by formulae of `segment_waves`.

Times are rounded to the nearest tick, so that one-sided limits are defined.
"""

import math
from collections.abc import Callable, Iterator
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..methods.signals import Floats, Ints, Side, each_once
from .extreme_stress import ExtremeStress, StressPeak, strongest
from .fields import Fields, PassingWaves, Profile, RodEnergy
from .segment_waves import SegmentWaves
from .wave_extremes import Meeting, extreme_differences

BEFORE_ALL_FRONTS = -(1 << 61)  # tick

Formula: TypeAlias = Callable[[SegmentWaves, Ints, Ints], Floats]
"""A field of a segment: its values where parts of its two waves meet that left the left
and the right end at the ticks p and q."""


class Points(NamedTuple):
    """Points of a rod, by segment; arrays of one shape."""

    segment: Ints  # number in the row, counted from 1
    offset: Ints  # time of travel from the left end of the segment, ticks


class ConstantRuns(NamedTuple):
    """A field at some points, constant between fronts; [point, n] arrays."""

    values: Floats  # from each front on
    repeats: Ints  # number of the given ticks for which each value holds


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
        """The waves of the segment of that number in the row, counted from 1.

        They come with its transit time in ticks, length, wave speed and impedance.
        """
        # The lists of the clock have an entry for each segment; entry 0 is the outside
        # on the left of the row. `clock.ticks` are transit times. Line 2 s leaves the
        # left end of segment s, and line 2 s + 1 its right end.
        clock = self.clock
        return SegmentWaves(
            segment=segment,
            transit=clock.ticks[segment],
            length=clock.length[segment],
            wave_speed=clock.wave_speed[segment],
            impedance=clock.impedance[segment],
            rightward=self.motion.lines[2 * segment],
            leftward=self.motion.lines[2 * segment + 1],
        )

    def waves_along(self, body: int) -> Iterator[SegmentWaves]:
        """The waves of the segments of a rod, from left to right."""
        first, last = self.clock.spans[body]  # segments in the row, counted from 1
        for segment in range(first, last + 1):
            yield self.waves(segment)

    @cached_property
    def constant_between_fronts(self) -> bool:
        """Whether all waves are constant between fronts, as velocity and strain are."""
        # There is no wave where a line is None; a constant wave has one coefficient.
        return all(
            wave is None or wave.coefficient_count == 1 for wave in self.motion.lines
        )

    # Fields at points and times -----------------------------------------------------

    def rod_velocity(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:
        """Velocity in a rod, m/s: half the sum of its two waves plus the frame's own.

        The velocity of the frame is that at t = 0; its gain g t by gravity is left out.
        x, m, and ticks broadcast, and the result has their shape. `side` decides at
        jumps.
        """
        frame_velocity = self.clock.frame

        def velocity(waves: SegmentWaves, p: Ints, q: Ints) -> Floats:
            """v where waves meet that left the left and right end at the ticks p, q."""
            return waves.velocity(p, q, side) + frame_velocity

        # `velocity` already takes the values of this side. `side` is passed as well
        # because a faster way exists for values just after fronts ("right").
        return self._one_sided_values(body, x, ticks, side, velocity)

    def rod_strain(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:
        """Strain in a rod: the difference of its two waves, over 2 c.

        x, m, and ticks broadcast, and the result has their shape.
        """

        def strain(waves: SegmentWaves, p: Ints, q: Ints) -> Floats:
            """Strain where two parts of the waves meet."""
            return waves.strain(p, q, side)

        return self._one_sided_values(body, x, ticks, side, strain)

    def rod_displacement(self, body: int, x: Floats, ticks: Ints) -> Floats:
        """Displacement, m, without the displacement g t^2/2 of the falling frame.

        x, m, and ticks broadcast. It is the displacement of the segment's left end at
        t = 0, plus `SegmentWaves.displacement` at the point, which includes the motion
        of the frame at its initial velocity.
        """
        frame_velocity = self.clock.frame
        tick = self.clock.tick

        def displacement(waves: SegmentWaves, p: Ints, q: Ints) -> Floats:
            """Displacement where two parts of the waves meet, m."""
            of_left_end = self._initial_displacements[waves.segment]
            return waves.displacement(p, q, frame_velocity) * tick + of_left_end

        return self._values(body, x, ticks, displacement)

    def strain_integral(self, body: int, x: Floats, ticks: Ints) -> Floats:
        """Integral of the strain over time up to each tick, [point, tick], in ticks.

        x, m, is [point]. The integral starts at a different tick at each point.
        """
        return self._values(body, x[:, None], ticks, SegmentWaves.strain_integral)

    @cached_property
    def _initial_displacements(self) -> list[float]:
        """Initial displacement of the left end of each segment, m.

        It is the sum of the elongations of the rod's segments on its left at t = 0, so
        0 at the left end of each rod. The index is the number of the segment in the
        row, counted from 1: entry 0 is not used.
        """
        displacements = [0.0]
        # Segments are numbered from left to right; walls and masses have none.
        for body in range(len(self.clock.spans)):
            displacement = 0.0
            for waves in self.waves_along(body):
                displacements.append(displacement)
                # The factor s per tick makes m of m/s ticks.
                displacement += waves.initial_elongation() * self.clock.tick
        return displacements

    def _points(self, body: int, x: ArrayLike) -> Points:
        """Segments of points x of a rod, m, and their times of travel in whole ticks.

        A time of travel is that from the left end of the segment, rounded to ticks.
        ValueError as for `locate`.
        """
        segment, distance = self.locate(body, x)
        length = np.array(self.clock.length)[segment]
        transit = np.array(self.clock.ticks)[segment]
        offset = np.rint(distance / length * transit).astype(np.int64)
        return Points(segment, np.clip(offset, 0, transit))

    def _one_sided_values(
        self, body: int, x: Floats, ticks: Ints, side: Side, formula: Formula
    ) -> Floats:
        """Values of a field by its formula, just after ("right") or before `ticks`.

        x in m and ticks broadcast. The caller's `formula` must take the values of this
        side; here `side` only decides whether a faster way is possible, which computes
        one value for each front. That way is possible for the side "right" if waves are
        constant between fronts, x is a column, and `ticks` is a row that never falls.
        """
        # The value just after a front holds for all ticks before the next front.
        holds_from_fronts = side == "right" and self.constant_between_fronts
        if holds_from_fronts and _is_grid(x, ticks):
            return self._grid_values(body, x, ticks, formula)
        return self._values(body, x, ticks, formula)

    def _values(self, body: int, x: Floats, ticks: Ints, formula: Formula) -> Floats:
        """Values of a field by its formula, segment by segment.

        x in m and ticks broadcast; ValueError if they do not, or as for `locate`.
        """
        points = self._points(body, x)
        values = np.empty(self._broadcast_shape(points.offset, ticks))
        # Segment, offset and tick of each value, all of one shape
        segments, offsets, all_ticks = np.broadcast_arrays(*points, ticks)
        for segment in np.unique(points.segment).tolist():
            waves = self.waves(segment)
            here = segments == segment
            offset = offsets[here]  # time of travel from the left end, ticks
            # The waves that are here at a tick left the ends at p = tick - offset and
            # at q = tick - (T - offset), which is p + 2 offset - T.
            p = all_ticks[here] - offset
            q = p + 2 * offset - waves.transit
            values[here] = formula(waves, p, q)
        return values

    def _grid_values(
        self, body: int, x: Floats, ticks: Ints, formula: Formula
    ) -> Floats:
        """Values [point, tick] of a field that is constant between fronts.

        x is a column [point, 1], m, and ticks a row [tick] in order. The formula gives
        one value for each front, which is repeated for the ticks up to the next.
        """
        points = self._points(body, x)
        values = []
        repeats = []
        # Neighbouring points of one segment are treated together. Their indices run
        # from `start` to `stop` - 1, as the segment changes at `start` and at `stop`.
        # Segments are counted from 1, so the 0 before the first point and after the
        # last one makes changes there, too.
        changes = np.diff(points.segment, axis=0, prepend=0, append=0)
        for start, stop in pairwise(np.flatnonzero(changes)):
            waves = self.waves(int(points.segment[start, 0]))
            offsets = points.offset[start:stop]
            runs = _constant_runs(waves, offsets, ticks, formula)
            values.append(runs.values.ravel())
            repeats.append(runs.repeats.ravel())
        on_grid = np.repeat(np.concatenate(values), np.concatenate(repeats))
        return on_grid.reshape(len(points.offset), len(ticks))

    def point_history(self, body: int, x: float) -> PassingWaves:
        """The waves that pass the point x, m, from t = 0 to the end of the run.

        They are in m/s, in the frame of the clock. Each wave is delayed by its time of
        travel from the end of the segment that it left: the left end for the rightward
        wave, the right end for the leftward one. Both are cut at the breaks of either.
        ValueError as for `locate`.
        """
        point = self._points(body, x)
        offset = int(point.offset)
        waves = self.waves(int(point.segment))
        rightward = waves.rightward.delayed(offset)
        leftward = waves.leftward.delayed(waves.transit - offset)
        # A break of a wave is a tick at which its next polynomial begins.
        breaks = each_once([0], rightward.breaks, leftward.breaks)
        breaks = breaks[(breaks >= 0) & (breaks <= self.end)]
        rightward = rightward.cut(breaks, self.end)
        leftward = leftward.cut(breaks, self.end)
        return PassingWaves(
            rightward=rightward,
            leftward=leftward,
            difference=leftward - rightward,
            wave_speed=waves.wave_speed,
        )

    # Integrals over bodies ----------------------------------------------------------

    def momentum(self, body: int, t: ArrayLike) -> Floats:
        """Momentum of a rod at times t in s, kg m/s, in the laboratory.

        It is the sum over its segments of Z times the integral of v over the time of
        travel through them. The velocities of the frame, at t = 0 and by gravity, are
        added.
        """
        clock = self.clock
        ticks = self.to_ticks(t)
        momentum: Any = 0.0
        for waves in self.waves_along(body):
            # Both are integrals over the time of travel, m/s ticks.
            of_frame = clock.frame * waves.transit
            velocity_integral = waves.velocity_integral(ticks) + of_frame
            momentum = momentum + waves.impedance * velocity_integral * clock.tick
        by_gravity = clock.mass(body) * self._fall_velocity(ticks)
        return np.asarray(momentum + by_gravity)

    def energy(self, body: int, tick: int, velocity: float) -> RodEnergy:
        """Kinetic and strain energy of a rod at `tick`, J.

        The kinetic energy is relative to `velocity`, m/s in the laboratory, which is
        subtracted from both waves A and B. The kinetic and the strain energy are sums
        over the segments of Z/8 times the integrals of (A + B)^2 and of (A - B)^2 over
        the time of travel.
        """
        clock = self.clock
        # The same velocity in the frame, to which the waves refer
        in_frame = velocity - clock.frame - clock.gravity * tick * clock.tick
        kinetic = 0.0
        strain = 0.0
        for waves in self.waves_along(body):
            squared = waves.squared_integrals(tick, in_frame)
            factor = waves.impedance * clock.tick / 8
            kinetic += squared.of_sum * factor
            strain += squared.of_difference * factor
        return RodEnergy(kinetic, strain)

    def extreme_stress(self, body: int) -> ExtremeStress:
        """Largest tension and compression in a rod at any time of the run.

        They are the largest of all its segments: E/(2 c) times the highest and the
        lowest B - A, with the leftward wave B and the rightward wave A. Each has its
        stress, place and time, and is `NO_STRESS` where the rod never has such stress.
        """
        tensions = []
        compressions = []
        segments = self.rods[body].segments
        for segment, waves in zip(segments, self.waves_along(body), strict=True):
            modulus = float(segment.material.youngs_modulus)
            per_difference = modulus / (2 * waves.wave_speed)
            extremes = extreme_differences(waves, self.end)
            if extremes.highest is not None:
                peak = self._peak(body, waves, extremes.highest, per_difference)
                tensions.append(peak)
            if extremes.lowest is not None:
                peak = self._peak(body, waves, extremes.lowest, per_difference)
                compressions.append(peak)
        return ExtremeStress(strongest(tensions), strongest(compressions))

    def _peak(
        self, body: int, waves: SegmentWaves, meeting: Meeting, per_difference: float
    ) -> StressPeak:
        """Stress, place and time where parts of the two waves of a segment meet.

        `per_difference` is E/(2 c), Pa s/m: stress over the difference of the waves.
        Place and time are rounded to ticks of travel, so that the stress field there
        has this value. At the right end of a segment the place is just left of the
        border.
        """
        first, last = self.clock.spans[body]  # segments in the row, counted from 1
        segment = waves.segment
        T = waves.transit
        left = float(self.edges(body)[segment - first])
        # x = c (q - p + T)/2 and t = (p + q + T)/2, in whole ticks with halves rounded
        # up (+ 1): fields at this place and time take the same parts of the waves.
        offset = min((meeting.q - meeting.p + T + 1) // 2, T)
        tick = (meeting.p + meeting.q + T + 1) // 2
        x = left + waves.length * (offset / T)
        is_at_border = offset == T and segment < last
        if is_at_border:
            # A border belongs to the segment on its right: take the next smaller x.
            x = math.nextafter(x, left)
        stress = per_difference * meeting.difference
        return StressPeak(stress, x, tick * self.clock.tick)

    def profile(self, body: int, tick: int) -> Profile:
        """State of a rod just after `tick`: means of velocity and strain over pieces.

        Pieces lie between fronts and ends of segments; smooth waves are cut further,
        see `SegmentWaves.piece_bounds`. With the wave A that left the left end of a
        segment and B that left its right end, strain = (B - A)/(2 c), and v, m/s, is
        (A + B)/2 plus the velocity of the frame, gravity included.
        """
        frame = self.frame_velocity(tick)
        edges = [np.zeros(1)]
        velocities = []
        strains = []
        ends = self.edges(body)
        for i, waves in enumerate(self.waves_along(body)):
            T = waves.transit
            bounds = waves.piece_bounds(tick)
            near_time = bounds[:-1]  # of travel from the left end, ticks
            far_time = bounds[1:]
            # A there has travelled for n ticks and left the left end at tick - n. B has
            # travelled for T - n ticks and left the right end at tick - T + n.
            A = waves.rightward.means(tick - far_time, tick - near_time)
            B = waves.leftward.means(tick - T + near_time, tick - T + far_time)
            velocities.append((A + B) / 2 + frame)
            strains.append((B - A) * waves.strain_per_difference)
            # In place of the bounds 0 and T the exact ends of the segment
            inner = ends[i] + waves.length * (bounds[1:-1] / T)
            edges.append(np.append(inner, ends[i + 1]))
        return Profile(
            edges=np.concatenate(edges),
            velocity=np.concatenate(velocities),
            strain=np.concatenate(strains),
        )


def _is_grid(x: Floats, ticks: Ints) -> bool:
    """Whether points x are a column [point, 1] and ticks a row [tick] that never falls.

    Each point is then combined with each tick. False if there is no point.
    """
    is_column = np.ndim(x) == 2 and np.size(x) > 0 and np.shape(x)[1] == 1
    if not is_column or ticks.ndim != 1:
        return False
    return bool(np.all(ticks[1:] >= ticks[:-1]))


def _constant_runs(
    waves: SegmentWaves, offsets: Ints, ticks: Ints, formula: Formula
) -> ConstantRuns:
    """A field of a segment that is constant between fronts, at increasing ticks.

    `offsets` are the points [point, 1], as ticks of travel from the left end. Each
    value is computed once, at the front from which it holds; `repeats` is the number of
    the given ticks for which it holds. Both are [point, front + 1], in order of time.
    """
    T = waves.transit
    # Ticks at which the fronts of A and B pass each point, [point, front]
    fronts_of_A = waves.rightward.ticks[1:] + offsets
    fronts_of_B = waves.leftward.ticks[1:] + T - offsets
    fronts = np.concatenate((fronts_of_A, fronts_of_B), axis=1)
    # Index of the first given tick at or after each front, in order of the fronts that
    # pass a point
    first_held = np.sort(ticks.searchsorted(fronts), axis=1)
    # A value holds from its own first tick to that of the next value. The value before
    # all fronts begins at the index 0.
    repeats = np.diff(first_held, prepend=0, append=len(ticks))
    # The value before all fronts is computed at a tick long before them.
    starts = np.sort(np.append(fronts, offsets + BEFORE_ALL_FRONTS, axis=1))
    p = starts - offsets
    q = starts + offsets - T
    values = formula(waves, p, q)
    return ConstantRuns(values, repeats)
