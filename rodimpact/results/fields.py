"""The state of every point of the row at every time: what solutions ask of any method.

A method that finds end signals has `WaveFields`, one that finds states on a grid `GridFields`.
"""

from functools import cached_property
from itertools import accumulate
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..methods.clock import Clock
from ..methods.run import Signals
from ..methods.signals import Floats, Ints, Pieces, Side
from ..model import Rod
from ..model.arguments import Array, array, demand, one_of
from ..model.frozen import invalid_argument
from .extreme_stress import ExtremeStress


class Profile(NamedTuple):
    """State of one body at one time: n pieces from left to right, each constant."""

    edges: Floats  # [n + 1], m from the left end; ends of segments are among them
    velocity: Floats  # [n], m/s
    strain: Floats  # [n]


class PassingWaves(NamedTuple):
    """Waves that pass a place in a rod from t = 0 to the end, in the clock's frame.

    With velocity v, strain eps and wave speed c:
    """

    rightward: Pieces  # v - c eps, m/s
    leftward: Pieces  # v + c eps, m/s
    difference: Pieces  # 2 c eps, m/s
    wave_speed: float  # c, m/s


class RodEnergy(NamedTuple):
    """Energy of a rod at one time, J."""

    kinetic: float
    strain: float


class MeanState(NamedTuple):
    """Means over intervals of time, [place, interval]."""

    velocity: Floats  # m/s
    strain: Floats


def to_side(ticks: Ints, side: Side) -> Ints:
    """Ticks that were rounded from times, moved to a side by as much as is uncertain.

    A float cannot name a single tick beyond 2^51 of them. ValueError for what is no side of a jump.
    """
    one_of("side", side, ("right", "left"))
    round_off = ticks >> 51
    if side == "right":
        return ticks + round_off
    return ticks - round_off


class Fields(Protocol):
    """What a solution asks of the state of a row: at any place and time, and of whole bodies.

    Parameters
    ----------
    clock : Clock
    end : int
        Last tick.
    signals : Signals
        Its motion, and the velocities of rigid masses, by body, m/s, in the frame `clock.frame`,
        which falls with `clock.gravity`.
    """

    clock: Clock
    end: int
    signals: Signals
    motion: Any
    step: float
    rods: dict[int, Rod]

    def __init__(self, clock: Clock, end: int, signals: Signals) -> None:
        self.clock = clock
        self.end = end
        self.signals = signals
        self.motion = signals.motion
        self.step = clock.tick * self.resolution
        self.rods = {}
        for i, body in enumerate(clock.system.bodies):
            if isinstance(body, Rod):
                self.rods[i] = body

    resolution: int = 1
    """Ticks in which nothing is resolved, of a grid those of its step; `step` is the same in s."""

    @property
    def constant_between_fronts(self) -> bool:
        """Whether velocity and strain are constant in the regions between fronts."""
        return False

    def rod_velocity(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:
        """Velocity in a rod, m/s, less the part that gravity gives; x and ticks broadcast."""

    def rod_strain(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:
        """Strain in a rod, positive in tension; x and ticks broadcast."""

    def rod_strain_rate(self, body: int, x: Floats, ticks: Ints) -> Floats:
        """Strain rate in a rod, 1/s.

        It is used where material is viscous, which only a grid takes.
        """
        return 0.0 * self.rod_strain(body, x, ticks, "right")

    def rod_displacement(self, body: int, x: Floats, ticks: Ints) -> Floats:
        """Displacement in a rod, m, less the part that gravity gives; x and ticks broadcast.

        It counts from the unstrained rod whose left end is at its place at t = 0.
        """

    def averaged(self, body: int, x: Floats, t: Floats) -> MeanState:
        """Mean velocity and strain at places x between increasing times t."""
        ticks = self.to_ticks(t)
        displacement = self.displacement(body, x[:, None], t)
        strain_integral = self.strain_integral(body, x, ticks)
        durations = np.diff(ticks)
        velocity = np.diff(displacement) / (durations * self.clock.tick)
        return MeanState(velocity, np.diff(strain_integral) / durations)

    def strain_integral(self, body: int, x: Floats, ticks: Ints) -> Floats:
        """Integral over time of the strain at places x, [place, tick], in ticks.

        Its values at one place differ by what they should; where it is 0 is left open.
        """

    def point_history(self, body: int, x: float) -> PassingWaves:
        """The waves that pass a place in a rod."""

    def momentum(self, body: int, t: ArrayLike) -> Floats:
        """Momentum of a rod, kg m/s."""

    def energy(self, body: int, tick: int, velocity: float) -> RodEnergy:
        """Energy of a rod; the kinetic energy is that relative to `velocity`, m/s."""

    def extreme_stress(self, body: int) -> ExtremeStress:
        """Largest tension and compression in a rod, with place and time."""

    def profile(self, body: int, tick: int) -> Profile:
        """State just after `tick`, in pieces of constant velocity and strain."""

    def nearest_known(self, ticks: Ints) -> Ints:
        """The nearest ticks at which energies are known."""
        return ticks

    def damped(self, ticks: Ints) -> Floats:
        """Energy lost in damped material since t = 0, J, at whole ticks."""
        return np.zeros(np.shape(ticks))

    # Where and when ---------------------------------------------------------------------------

    def to_ticks(self, t: ArrayLike) -> Ints:
        """Nearest ticks of times in s; raise ValueError outside the solution."""
        t = array("t", t, "s")
        end = self.end * self.clock.tick
        inside = (t >= 0) & (t <= end * (1 + 1e-12) + self.clock.tick)
        if not inside.all():
            message = f"must lie in the solution, 0 to {end:.9g} s, got {{0!r}}"
            demand(inside, "t", message, t)
        nearest = np.rint(t / self.clock.tick).astype(np.int64)
        ticks: Ints = np.minimum(nearest, self.end)
        return ticks

    def to_ticks_beside(self, t: ArrayLike, side: Side) -> Ints:
        """Ticks of times in s, before or after a jump at that time, as in `to_side`."""
        return to_side(self.to_ticks(t), side)

    def edges(self, body: int) -> Floats:
        """Ends of the body's segments, m from its left end."""
        first, last = self.clock.spans[body]
        return np.array([0.0, *accumulate(self.clock.length[first : last + 1])])

    def locate(self, body: int, x: ArrayLike) -> tuple[Ints, Floats]:
        """Segment of the row in which places lie, and distance from its left end, m.

        Places are in m from the left end of a rod; ValueError outside.
        """
        self._check_rod(body)
        first, last = self.clock.spans[body]
        x = array("x", x, "m")
        edges = self.edges(body)
        inside = (x >= 0) & (x <= edges[-1] * (1 + 1e-12))
        if not inside.all():
            message = f"must lie in body {body}, 0 to {edges[-1]:.9g} m, got {{0!r}}"
            demand(inside, "x", message, x)
        piece = np.clip(np.searchsorted(edges, x, "right") - 1, 0, last - first)
        return np.asarray(piece + first), np.asarray(x - edges[piece])

    def _broadcast_shape(self, x: Any, t: Any) -> tuple[int, ...]:
        """Shape that places and times broadcast to; raise ValueError where they do not."""
        try:
            return np.broadcast_shapes(np.shape(x), np.shape(t))
        except ValueError:
            shapes = f"shape {np.shape(x)} does not broadcast with shape {np.shape(t)}"
            message = f"{shapes} of t; for a grid ask for x[:, None] and t"
            raise invalid_argument("x", message) from None

    # Rods, masses and walls at places and times as users give them ------------------------------

    def _fall_velocity(self, ticks: Ints) -> Floats:
        """Velocity that the frame has gained by gravity, m/s."""
        return np.asarray(self.clock.gravity * ticks * self.clock.tick)

    def _is_rod(self, body: int) -> bool:
        """Whether a body has an inside."""
        return self.clock.spans[body][1] > 0

    def _check_rod(self, body: int) -> None:
        """Raise InvalidModel for a body that has no inside."""
        if self._is_rod(body):
            return
        kind = "a wall"
        if body in self.signals.masses:
            kind = "a rigid mass"
        raise invalid_argument(
            "body", f"{body} is {kind} and has no inside; ask for a rod"
        )

    def _at_rigid_body(self, body: int, x: Array, ticks: Ints) -> Ints:
        """Ticks broadcast with places in a rigid mass or in a wall, all of which are 0 m."""
        message = f"must be 0 in body {body}, which has no length, got {{0!r}}"
        demand(x == 0, "x", message, x)
        return np.broadcast_to(ticks, self._broadcast_shape(x, ticks))

    def velocity(
        self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right"
    ) -> Floats:
        """Velocity, m/s; x and t broadcast, and x is 0 in a mass or a wall."""
        ticks = self.to_ticks_beside(t, side)
        places = array("x", x, "m")
        if self._is_rod(body):
            velocity = self.rod_velocity(body, places, ticks, side)
        else:
            ticks = self._at_rigid_body(body, places, ticks)
            mass = self.signals.masses.get(body)
            if mass is None:
                wall: Any = self.clock.system.bodies[body]
                return np.asarray(wall.velocity + 0.0 * ticks)
            velocity = mass.at(ticks, side) + self.clock.frame
        if self.clock.gravity:
            return velocity + self._fall_velocity(self.to_ticks(t))
        return velocity

    def displacement(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        """Displacement from the place at t = 0, m; arguments as for the velocity."""
        ticks = self.to_ticks(t)
        places = array("x", x, "m")
        if self._is_rod(body):
            displacement = self.rod_displacement(body, places, ticks)
        else:
            ticks = self._at_rigid_body(body, places, ticks)
            mass = self.signals.masses.get(body)
            if mass is None:
                wall: Any = self.clock.system.bodies[body]
                return np.asarray(wall.velocity * ticks * self.clock.tick)
            of_frame = self.clock.frame * (ticks * self.clock.tick)
            in_frame = mass.integral(0, ticks) * self.clock.tick
            displacement = in_frame + of_frame
        time = ticks * self.clock.tick
        return displacement + self.clock.gravity * time * time / 2

    def strain(
        self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right"
    ) -> Floats:
        """Strain in a rod, positive in tension; x and t broadcast."""
        ticks = self.to_ticks_beside(t, side)
        self._check_rod(body)
        return self.rod_strain(body, array("x", x, "m"), ticks, side)

    def strain_rate(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        """Strain rate in a rod, 1/s; x and t broadcast."""
        ticks = self.to_ticks(t)
        self._check_rod(body)
        return self.rod_strain_rate(body, array("x", x, "m"), ticks)

    @cached_property
    def positions(self) -> list[float]:
        """Where each body's left end would lie unstrained at t = 0, m; the first at 0.

        The place of a point is position + x + displacement; a wall's is its face.
        """
        clock = self.clock
        system = clock.system
        positions = []
        x = 0.0
        for body, (first, last) in enumerate(clock.spans):
            if body > 0:
                stretch = getattr(system.contacts[body - 1], "stretch", 0.0)
                x += float(system.gaps[body - 1]) + float(stretch)
            positions.append(x)
            if self._is_rod(body):
                x += sum(clock.length[first : last + 1])
                x += float(self.displacement(body, self.edges(body)[-1], 0.0))
        return positions
