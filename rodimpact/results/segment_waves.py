"""The two waves of a segment, and the formulae of the fields that they make.

Let A and B be the waves, m/s, that leave the left and the right end of a segment with
the transit time T. The parts of them that left at p and q meet at the time
t = (p + q + T)/2, at the distance c (q - p + T)/2 from the left end. There, in the
frame of the clock,

    v = (A(p) + B(q))/2        and        strain = (B(q) - A(p))/(2 c).

So a field is a look-up in two signals, and displacement, momentum and energy are
integrals of them. All times are in ticks.
"""

from typing import NamedTuple

import numpy as np

from ..methods.signals import Floats, Ints, Pieces, Side, each_once, quadrature


class SquaredWaves(NamedTuple):
    """Integrals over the transit time of a segment, (m/s)^2 ticks."""

    of_sum: float  # of (A + B)^2: kinetic energy is Z/8 times this
    of_difference: float  # of (A - B)^2: strain energy is Z/8 times this


class SegmentWaves(NamedTuple):
    """A segment and its two waves.

    Parts of the waves left its ends at the ticks p and q.
    """

    segment: int  # number in the row, counted from 1
    transit: int  # transit time T, ticks
    length: float  # m
    wave_speed: float  # c, m/s
    impedance: float  # Z, kg/s
    rightward: Pieces  # A, leaves the left end, m/s in the frame of the clock
    leftward: Pieces  # B, leaves the right end, m/s in the frame of the clock

    @property
    def strain_per_difference(self) -> float:
        """1/(2 c): strain over the difference B - A, s/m."""
        return 0.5 / self.wave_speed

    # Where parts of the waves meet --------------------------------------------------

    def velocity(self, p: Ints, q: Ints, side: Side) -> Floats:
        """Velocity where the parts that left at p and q meet, (A(p) + B(q))/2.

        It is in m/s, in the frame of the clock. `side` decides at jumps of the waves:
        the value after ("right") or before.
        """
        A = self.rightward
        B = self.leftward
        return (A.at(p, side) + B.at(q, side)) * 0.5

    def strain(self, p: Ints, q: Ints, side: Side) -> Floats:
        """Strain where the parts that left at p and q meet, (B(q) - A(p))/(2 c).

        `side` decides at jumps of the waves: the value after ("right") or before.
        """
        A = self.rightward
        B = self.leftward
        per_difference = self.strain_per_difference
        return (B.at(q, side) - A.at(p, side)) * per_difference + 0.0  # no -0.0

    def displacement(self, p: Ints, q: Ints, frame: float) -> Floats:
        """Displacement where the parts that left at p and q meet, m/s ticks.

        It is (integral of A from 0 to p + integral of B from -T to q)/2 + frame t, with
        the velocity `frame` of the clock's frame, m/s, and the tick t of the meeting,
        2 t = p + q + T. It is relative to the displacement of the left end at t = 0.
        """
        A = self.rightward
        B = self.leftward
        T = self.transit
        return (A.integral(0, p) + B.integral(-T, q) + frame * (p + q + T)) / 2

    def strain_integral(self, p: Ints, q: Ints) -> Floats:
        """Integral of the strain over time at one place, ticks, up to a constant.

        The constant differs from place to place. The integral over time is
        (integral of B from 0 to q - integral of A from 0 to p)/(2 c).
        """
        A = self.rightward
        B = self.leftward
        return (B.integral(0, q) - A.integral(0, p)) * self.strain_per_difference

    # Integrals over the segment -----------------------------------------------------

    def initial_elongation(self) -> float:
        """Elongation of the segment at t = 0: half the integral of B - A from -T to 0.

        It is in m/s ticks.
        """
        A = self.rightward
        B = self.leftward
        T = self.transit
        # From 0 back to -T: minus the integral of A from -T to 0
        minus_integral_of_A = A.integral(0, -T)
        twice_the_elongation = minus_integral_of_A + B.integral(-T, 0)
        return float(twice_the_elongation) / 2

    def velocity_integral(self, ticks: Ints) -> Floats:
        """Integral of v over the segment at `ticks`, m/s ticks, of their shape.

        The variable of the integral is the time of travel. All parts of the waves in
        the segment at the tick t left its ends from t - T to t. So the integral is half
        that of A + B from t - T to t, in the frame of the clock. Multiplied by the
        impedance and by the duration of a tick it is the momentum.
        """
        A = self.rightward
        B = self.leftward
        starts = ticks - self.transit
        twice = A.integral(starts, ticks) + B.integral(starts, ticks)
        return twice / 2

    def squared_integrals(self, tick: int, velocity: float) -> SquaredWaves:
        """Integrals of (A + B)^2 and (A - B)^2 over the segment at `tick`.

        The variable of the integrals is the time of travel, ticks. `velocity`, m/s in
        the clock's frame, is first subtracted from both waves A and B: the kinetic
        energy is relative to it.
        """
        # All parts in the segment left its ends from start = tick - T to tick. The part
        # of A that left at `time` meets the part of B that left at start + tick - time.
        # So B is taken backwards, and both are functions of `time`.
        start = tick - self.transit
        rightward = self.rightward.within(start, tick)
        leftward = self.leftward.within(start, tick).time_reversed(start + tick)
        breaks_of_A = rightward.breaks_in(start, tick)
        breaks_of_B = leftward.breaks_in(start, tick)
        edges = each_once([start], breaks_of_A, breaks_of_B, [tick])
        # Gauss's rule with as many points as coefficients is exact for the squares.
        point_count = max(rightward.coefficient_count, leftward.coefficient_count)
        shares, weights = quadrature(point_count)  # points from 0 to 1, in an interval
        # Waves minus the velocity, [interval, point]
        A = rightward.inside(edges[:-1], edges[1:], shares) - velocity
        B = leftward.inside(edges[:-1], edges[1:], shares) - velocity
        total = A + B
        difference = A - B
        widths = np.diff(edges)
        # The weights of points give means over intervals, the widths their integrals.
        return SquaredWaves(
            of_sum=float((total * total) @ weights @ widths),
            of_difference=float((difference * difference) @ weights @ widths),
        )

    # The state at one time ----------------------------------------------------------

    def piece_bounds(self, tick: int) -> Ints:
        """Bounds of n pieces in which the state just after `tick` is constant, [n + 1].

        They are times of travel from the left end, ticks, from 0 to T. Smooth waves are
        cut where straight lines between the bounds follow them closely. A front within
        round-off of an end of the segment makes no piece.
        """
        T = self.transit
        start = tick - T
        # A front of A that left at `time` is tick - time away from the left end. A
        # front of B that left at `time` is tick - time away from the right end, so it
        # is T - (tick - time) = time - start away from the left end.
        fronts_of_A = tick - self.rightward.within(start, tick).marks
        fronts_of_B = self.leftward.within(start, tick).marks - start
        bounds = each_once(fronts_of_A, fronts_of_B)
        # The tick was rounded from a time in s, a float: a wave within its round-off of
        # an end has just left it.
        round_off = tick >> 51  # tick/2^51, rounded down: a float has 53 binary digits
        is_inside = (bounds > round_off) & (bounds < T - round_off)
        return np.concatenate(([0], bounds[is_inside], [T]))

    def smooth_bounds(self, tick: int) -> Ints:
        """Bounds of n parts in which both waves at `tick` are polynomials, [n + 1].

        They are times of travel from the left end, ticks, from 0 to T. In a part each
        wave is a single polynomial.
        """
        T = self.transit
        start = tick - T
        # Times of travel from the left end, as in `piece_bounds`
        breaks_of_A = tick - self.rightward.breaks_in(start, tick)
        breaks_of_B = self.leftward.breaks_in(start, tick) - start
        return each_once([0], breaks_of_A, breaks_of_B, [T])
