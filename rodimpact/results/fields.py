"""The state of every point of the row at every time, whatever method solved it.

`WaveFields` computes it from the waves that leave the ends of rods, `GridFields` from
states on a grid.
"""

from functools import cached_property
from itertools import accumulate
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..methods.clock import Clock
from ..methods.run import Signals
from ..methods.signals import Floats, Ints, Pieces, Side
from ..model import Rod, Steps
from ..model.arguments import Array, array, check_choice, demand
from ..model.frozen import invalid_argument
from .extreme_stress import ExtremeStress

END_RTOL = 1e-12
"""A point or a time may lie beyond the end by this fraction, its round-off."""


class Profile(NamedTuple):
    """State of a rod at one time: n pieces from left to right, each constant."""

    edges: Floats  # [n + 1], m from the left end; ends of segments are among them
    velocity: Floats  # [n], m/s
    strain: Floats  # [n]


class PassingWaves(NamedTuple):
    """Waves that pass a place in a rod from t = 0 to the end, in the clock's frame.

    With velocity v, strain eps and wave speed c:
    """

    rightward: Pieces  # A = v - c eps, m/s
    leftward: Pieces  # B = v + c eps, m/s
    difference: Pieces  # B - A = 2 c eps, m/s
    wave_speed: float  # c, m/s


class RodEnergy(NamedTuple):
    """Energy of a rod at one time."""

    kinetic: float  # of the motion relative to a given velocity, J
    strain: float  # J


class MeanState(NamedTuple):
    """Means over intervals of time, [point, interval]."""

    velocity: Floats  # m/s
    strain: Floats


class Location(NamedTuple):
    """Positions of points of a rod by segment; arrays of one shape."""

    segment: Ints  # number of the segment in the row, counted from 1
    distance: Floats  # m from the left end of the segment


def to_side(ticks: Ints, side: Side) -> Ints:
    """Ticks moved to just after ("right") or just before ("left") a jump at each tick.

    The ticks were rounded from times, and beyond 2^51 a float does not resolve single
    ticks. So each tick moves by tick/2^51, rounded down: below 2^51 it does not move.
    InvalidModel for any other side.
    """
    check_choice("side", side, ("right", "left"))
    round_off = ticks >> 51  # ticks/2^51, rounded down
    if side == "right":
        return ticks + round_off
    return ticks - round_off


class Fields(Protocol):
    """State of a row, as a solution asks for it: at any place and time, and of bodies.

    Parameters
    ----------
    clock : Clock
    end : int
        Last tick.
    signals : Signals
        Its motion, and the velocities of rigid masses, by body, m/s, in the frame
        `clock.frame`, which falls with `clock.gravity`.

    Notes
    -----
    Points x are in m from the left end of a body; ticks and times t are those of the
    run. Points and times broadcast, and values have their broadcast shape.
    """

    clock: Clock
    end: int  # last tick
    signals: Signals
    motion: Any  # Waves or GridMotion
    resolution: int = 1  # ticks of the shortest time that is resolved: a step of a grid
    step: float  # the same time, s
    rods: dict[int, Rod]  # by body

    def __init__(self, clock: Clock, end: int, signals: Signals) -> None:
        """Store the arguments, the motion of the signals, and the rods of the row.

        `end` is the last tick. The time step, s, is the class's `resolution` in ticks.
        """
        self.clock = clock
        self.end = end
        self.signals = signals
        self.motion = signals.motion
        self.step = clock.tick * self.resolution
        self.rods = {}  # by index of the body
        for i, body in enumerate(clock.system.bodies):
            if isinstance(body, Rod):
                self.rods[i] = body

    @property
    def constant_between_fronts(self) -> bool:
        """Whether velocity and strain are constant in each region between fronts."""
        return False

    def rod_velocity(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:
        """Velocity in a rod, m/s, without the velocity g t of the falling frame."""

    def rod_strain(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:
        """Strain in a rod, positive in tension."""

    def rod_strain_rate(self, body: int, x: Floats, ticks: Ints) -> Floats:
        """Strain rate in a rod, 1/s.

        It is 0 except on a grid: no other method has viscous material.
        """
        return 0.0 * self.rod_strain(body, x, ticks, "right")

    def rod_displacement(self, body: int, x: Floats, ticks: Ints) -> Floats:
        """Displacement in a rod, m, without the displacement of the falling frame.

        It is relative to the unstrained rod whose left end is where it is at t = 0.
        """

    def averaged(self, body: int, x: Floats, t: Floats) -> MeanState:
        """Mean velocity and strain at points x, m [point], between times t, s.

        For each interval between neighbouring times, they are the changes of the
        displacement and of the integral of the strain, divided by the duration of the
        interval: [point, interval]. The n times must increase, also when they are
        rounded to ticks.
        """
        ticks = self.to_ticks(t)
        displacement = self.displacement(body, x[:, None], t)  # [point, time]
        strain_integral = self.strain_integral(body, x, ticks)  # ticks, [point, time]
        durations = np.diff(ticks)  # ticks, [interval]
        velocity = np.diff(displacement) / (durations * self.clock.tick)
        strain = np.diff(strain_integral) / durations
        return MeanState(velocity, strain)

    def strain_integral(self, body: int, x: Floats, ticks: Ints) -> Floats:
        """Integral of the strain over time up to each tick, [point, tick], in ticks.

        x, m, is [point], and `ticks` is [tick]. The tick at which the integral starts
        may differ from point to point.
        """

    def point_history(self, body: int, x: float) -> PassingWaves:
        """The waves that pass the point x, m, of a rod, from t = 0 to the end.

        ValueError for a body that is no rod, and for a point outside of it.
        """

    def momentum(self, body: int, t: ArrayLike) -> Floats:
        """Momentum of a rod at times t in s, kg m/s."""

    def energy(self, body: int, tick: int, velocity: float) -> RodEnergy:
        """Energy of a rod at a tick.

        The kinetic energy is relative to `velocity`, m/s.
        """

    def extreme_stress(self, body: int) -> ExtremeStress:
        """Largest tension and compression in a rod, with place and time."""

    def profile(self, body: int, tick: int) -> Profile:
        """State just after `tick`, in pieces of constant velocity and strain."""

    def nearest_energy_ticks(self, ticks: Ints) -> Ints:
        """The nearest ticks at which energies are known.

        On a grid these are the ticks of its states.
        """
        return ticks

    def mobilised(self, body: int, tick: int) -> Steps | float:  # noqa: ARG002
        """Share of the resistance of soil that is mobilised along a rod.

        Only grids have soil.
        """
        return 0.0

    def viscous_loss(self, ticks: Ints) -> Floats:
        """Energy lost in damped material from t = 0 to each tick, J."""
        return np.zeros(np.shape(ticks))

    # Where and when -----------------------------------------------------------------

    def to_ticks(self, t: ArrayLike) -> Ints:
        """Nearest ticks of times in s, of their shape; the last tick at most.

        ValueError for times outside the solution. A time beyond the end by no more than
        round-off, `END_RTOL` and a tick, gets the last tick.
        """
        t = array("t", t, "s")
        end = self.end * self.clock.tick
        latest = end * (1 + END_RTOL) + self.clock.tick
        inside = (t >= 0) & (t <= latest)
        if not inside.all():
            # `demand` puts the first value outside in place of {0!r}.
            message = f"must lie in the solution, 0 to {end:.9g} s, got {{0!r}}"
            demand(inside, "t", message, t)
        nearest = np.rint(t / self.clock.tick).astype(np.int64)
        ticks: Ints = np.minimum(nearest, self.end)
        return ticks

    def to_ticks_beside(self, t: ArrayLike, side: Side) -> Ints:
        """Ticks of times in s, just after ("right") or before a jump at that time."""
        return to_side(self.to_ticks(t), side)

    def edges(self, body: int) -> Floats:
        """Ends of the n segments of a rod, m from its left end, [n + 1]."""
        first, last = self.clock.spans[body]  # segments in the row, counted from 1
        lengths = self.clock.length[first : last + 1]  # by this number, from entry 1
        return np.array([0.0, *accumulate(lengths)])

    def locate(self, body: int, x: ArrayLike) -> Location:
        """Segments in which points x, m, of a rod lie, and the distances in them.

        Segments have their number in the row, counted from 1. A distance is that from
        the left end of the segment, m. A point between two segments lies in the right
        one. ValueError for a body that is no rod, and for points outside of the rod by
        more than round-off.
        """
        self._check_rod(body)
        first, last = self.clock.spans[body]  # segments in the row, counted from 1
        x = array("x", x, "m")
        edges = self.edges(body)
        length = edges[-1]
        inside = (x >= 0) & (x <= length * (1 + END_RTOL))
        if not inside.all():
            # `demand` puts the first value outside in place of {0!r}.
            message = f"must lie in body {body}, 0 to {length:.9g} m, got {{0!r}}"
            demand(inside, "x", message, x)
        index_in_rod = np.searchsorted(edges, x, side="right") - 1  # counted from 0
        # The right end of the rod lies in its last segment.
        index_in_rod = np.clip(index_in_rod, 0, last - first)
        segment = np.asarray(index_in_rod + first)
        distance = np.asarray(x - edges[index_in_rod])
        return Location(segment, distance)

    def _broadcast_shape(self, x: Any, t: Any) -> tuple[int, ...]:
        """Shape to which points and times broadcast; ValueError where they do not."""
        try:
            return np.broadcast_shapes(np.shape(x), np.shape(t))
        except ValueError:
            shapes = f"shape {np.shape(x)} does not broadcast with shape {np.shape(t)}"
            message = f"{shapes} of t; for a grid ask for x[:, None] and t"
            raise invalid_argument("x", message) from None

    # Velocity of the frame ----------------------------------------------------------

    def frame_velocity(self, tick: int) -> float:
        """Velocity of the clock's frame at a tick, m/s.

        It is the velocity at t = 0 plus g t.
        """
        clock = self.clock
        return clock.frame + clock.gravity * tick * clock.tick

    def _fall_velocity(self, ticks: Ints) -> Floats:
        """g t: velocity that the frame has gained by gravity, m/s."""
        return np.asarray(self.clock.gravity * ticks * self.clock.tick)

    # Kinds of bodies ----------------------------------------------------------------

    def _is_rod(self, body: int) -> bool:
        """Whether a body has segments: walls and rigid masses have none."""
        _, last_segment = self.clock.spans[body]  # counted from 1; 0 without segments
        return last_segment > 0

    def _is_wall(self, body: int) -> bool:
        """Whether a body keeps its velocity under any force.

        It is no rod, and no rigid mass that can move.
        """
        return not self._is_rod(body) and body not in self.signals.masses

    def _wall_velocity(self, body: int) -> float:
        """Velocity of a wall, m/s."""
        wall: Any = self.clock.system.bodies[body]
        return float(wall.velocity)

    def _check_rod(self, body: int) -> None:
        """Raise InvalidModel unless a body is a rod: others have no inside."""
        if self._is_rod(body):
            return
        kind = "a rigid mass"
        if self._is_wall(body):
            kind = "a wall"
        raise invalid_argument(
            "body", f"{body} is {kind} and has no inside; ask for a rod"
        )

    def _rigid_ticks(self, body: int, x: Array, ticks: Ints) -> Ints:
        """Ticks broadcast with the points x of a rigid mass or a wall.

        InvalidModel unless all points are 0, as the body has no length.
        """
        # `demand` puts the first other value in place of {0!r}.
        message = f"must be 0 in body {body}, which has no length, got {{0!r}}"
        demand(x == 0, "x", message, x)
        return np.broadcast_to(ticks, self._broadcast_shape(x, ticks))

    # Fields of rods, masses and walls, as users ask for them ------------------------

    def velocity(
        self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right"
    ) -> Floats:
        """Velocity in the laboratory, m/s; x in m and t in s broadcast.

        For a rod and a mass it is the velocity in the clock's frame, plus the velocity
        of the frame at t = 0, plus g t. For a wall it is the wall's velocity. `side`
        decides at jumps. ValueError for points outside of a rod, x other than 0 in a
        mass or a wall, and times outside the solution.
        """
        ticks = self.to_ticks_beside(t, side)
        points = array("x", x, "m")
        if self._is_rod(body):
            # It includes the velocity of the frame at t = 0.
            velocity = self.rod_velocity(body, points, ticks, side)
        else:
            ticks = self._rigid_ticks(body, points, ticks)
            if self._is_wall(body):
                wall_velocity = self._wall_velocity(body) + 0.0  # no -0.0
                return np.full(ticks.shape, wall_velocity)  # gravity does not move it
            in_frame = self.signals.masses[body].at(ticks, side)  # of the rigid mass
            velocity = in_frame + self.clock.frame
        if self.clock.gravity:
            # g t has no jumps, so it needs no side.
            return velocity + self._fall_velocity(self.to_ticks(t))
        return velocity

    def displacement(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        """Displacement in the laboratory, m; x in m and t in s broadcast.

        It is relative to the position at t = 0, in a rod to the unstrained rod, see
        `rod_displacement`. For a rod and a mass it is the displacement in the clock's
        frame, plus that of the frame, plus g t^2/2. For a wall it is velocity times
        time. ValueError as for `velocity`.
        """
        clock = self.clock
        ticks = self.to_ticks(t)
        points = array("x", x, "m")
        if self._is_rod(body):
            # It includes the displacement of the frame without gravity.
            displacement = self.rod_displacement(body, points, ticks)
        else:
            ticks = self._rigid_ticks(body, points, ticks)  # refuses an x other than 0
            if self._is_wall(body):
                return np.asarray(self._wall_velocity(body) * ticks * clock.tick)
            of_frame = clock.frame * (ticks * clock.tick)
            mass_velocity = self.signals.masses[body]  # in the frame, m/s
            in_frame = mass_velocity.integral(0, ticks) * clock.tick
            displacement = in_frame + of_frame
        time = ticks * clock.tick
        return displacement + clock.gravity * time * time / 2

    def strain(
        self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right"
    ) -> Floats:
        """Strain in a rod, positive in tension; x in m and t in s broadcast.

        `side` decides at jumps. ValueError for a body that is no rod, points outside of
        it, and times outside the solution.
        """
        ticks = self.to_ticks_beside(t, side)
        self._check_rod(body)
        points = array("x", x, "m")
        return self.rod_strain(body, points, ticks, side)

    def strain_rate(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        """Strain rate in a rod, 1/s; x in m and t in s broadcast.

        It is 0 except on a grid. ValueError for a body that is no rod, points outside
        of it, and times outside the solution.
        """
        ticks = self.to_ticks(t)
        self._check_rod(body)
        points = array("x", x, "m")
        return self.rod_strain_rate(body, points, ticks)

    @cached_property
    def positions(self) -> list[float]:
        """Positions of the left ends of all bodies at t = 0, m, by body.

        The first is 0. The distance from one left end to the next is the length of the
        body, the initial elongation of a rod, the gap, and the stretch of a joint. A
        point x of a body is at position + x + displacement. The position of a wall is
        that of its face.
        """
        clock = self.clock
        system = clock.system
        positions = []
        right_end = 0.0  # right end of the body before, m
        for body in range(len(clock.spans)):
            left_end = right_end
            if body > 0:  # contact body - 1 is that on its left
                stretch = getattr(system.contacts[body - 1], "stretch", 0.0)
                left_end += float(system.gaps[body - 1]) + float(stretch)
            positions.append(left_end)
            right_end = left_end
            if self._is_rod(body):
                first, last = clock.spans[body]  # segments, counted from 1
                right_end += sum(clock.length[first : last + 1])
                # The initial strain displaces the right end, the last of `edges`.
                length = self.edges(body)[-1]
                right_end += float(self.displacement(body, length, 0.0))  # at t = 0
        return positions
