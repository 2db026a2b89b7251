"""Closed form of `rodimpact.theory` for a collision, or for a family of collisions.

There is a closed form for two uniform rods, and for a uniform rod and a wall or a rigid
mass. The contact must be rigid, the bodies must not vibrate before, and no other force
may act.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..methods.signals import Floats
from ..model import Body, Rigid, Rod, System
from ..theory import PairCollision, mass_on_rod, rod_on_wall, saint_venant


class PairTheory(NamedTuple):
    """A family of two bodies, left and right, whose collision has a closed form.

    Attributes
    ----------
    impedance, transit_time : [2, ...] array, by the shape of the family
        kg/s and s; infinite and 0 for a wall or a rigid mass.
    mass, velocity : [2, ...] array
        kg and m/s.
    """

    impedance: Floats
    transit_time: Floats
    mass: Floats
    velocity: Floats

    @property
    def source(self) -> str:
        """Source of the closed form, as a label in figures.

        "Saint-Venant 1867" for two rods, "textbook, box 10.4" for a rod and a wall, and
        "Boussinesq" for a rod and a rigid mass.
        """
        both_are_rods = np.isfinite(self.impedance).all()
        if both_are_rods:
            return "Saint-Venant 1867"
        has_wall = np.isinf(self.mass).any()  # rods and rigid masses are finite
        if has_wall:
            return "textbook, box 10.4"
        return "Boussinesq"

    def mapped(self, change: Callable[[Floats], Floats]) -> PairTheory:
        """A new family with `change(array)` in place of each array of each body."""
        changed = []
        # Each field of this tuple holds an array of the left and of the right body.
        for left, right in self:
            changed.append(np.stack([change(left), change(right)]))
        return PairTheory(*changed)

    def interpolated(self, members: Floats, wanted: Floats) -> PairTheory:
        """The family at other values of the parameter of its only axis.

        The logarithms of each array are interpolated linearly over `members` as given.
        An array with a number that is 0, negative or infinite is itself interpolated.
        If the caller passes logarithms of a length, an area, a density or a modulus,
        the result is exact: impedances, transit times and masses are powers of these.

        Parameters
        ----------
        members, wanted : array
            Values of the parameter, or their logarithms: those of the members,
            increasing, and those at which the family is wanted.
        """

        def between(values: Floats) -> Floats:
            """Values of the members, interpolated at the wanted parameters."""
            lacks_logarithms = (values <= 0).any() or np.isinf(values).any()
            if lacks_logarithms:
                return np.interp(wanted, members, values)
            logarithms = np.interp(wanted, members, np.log(values))
            return np.exp(logarithms)

        return self.mapped(between)

    def collision(self) -> PairCollision:
        """Collision of each member by its closed form, at its closing speed.

        Members whose bodies do not approach each other get a closing speed of 1 m/s: a
        reader of the result must leave them out, as `column` does.
        """
        # Index 0 is the left body, 1 the right one. A wall and a rigid mass have an
        # infinite impedance. All members have the same kinds of bodies.
        Z = self.impedance
        T = self.transit_time
        left_velocity, right_velocity = self.velocity
        closing_speed = left_velocity - right_velocity
        V = np.where(self.approaches, closing_speed, 1.0)
        both_are_rods = np.isfinite(Z).all()
        if both_are_rods:
            return saint_venant(Z[0], T[0], Z[1], T[1], V)
        rod = 0
        if np.isinf(Z[0]).any():
            rod = 1
        rigid_mass = self.mass[1 - rod]
        is_wall = np.isinf(rigid_mass).any()
        if is_wall:
            return rod_on_wall(Z[rod], T[rod], V)
        return mass_on_rod(rigid_mass, Z[rod], T[rod], V)

    def column(self, name: str) -> Floats:
        """The result `name`, a key of `COLUMNS`, of each member, in SI units.

        It is nan for members whose bodies do not approach each other.
        """
        values = COLUMNS[name](self, self.collision())
        return np.where(self.approaches, values, np.nan)

    @property
    def approaches(self) -> NDArray[np.bool_]:
        """Whether the two bodies of each member approach each other."""
        left_velocity, right_velocity = self.velocity
        return np.asarray(left_velocity > right_velocity)


def _velocity_after(family: PairTheory, pair: PairCollision, body: int) -> Floats:
    """Velocity of the left body (0) or the right one (1) after the impulse J, m/s.

    It is v - J/m for the left body, and v + J/m for the right one. A wall has infinite
    mass and keeps its velocity.
    """
    change = pair.impulse / family.mass[body]
    if body == 0:
        change = -change
    return np.asarray(family.velocity[body] + change)


COLUMNS: dict[str, Callable[[PairTheory, PairCollision], Any]] = {
    "restitution": lambda _, pair: pair.restitution,
    "velocity_after.0": lambda family, pair: _velocity_after(family, pair, 0),
    "velocity_after.1": lambda family, pair: _velocity_after(family, pair, 1),
    "impulse.0": lambda _, pair: pair.impulse,
    "peak_force.0": lambda _, pair: pair.peak_force,
    "duration.0": lambda _, pair: pair.duration,
    "vibration": lambda _, pair: pair.vibration_energy,
}
"""Columns of a sweep that have a closed form."""


def pair_theory(system: System) -> PairTheory | None:
    """The numbers of a family whose collision has a closed form, else None.

    There is a closed form if all of this holds: the row has two bodies, at least one of
    them a rod; the contact is `Rigid`; neither gravity nor an end acts on them; both
    have `_closed_form_inputs`; the bodies of at least one member approach each other.
    """
    is_pair = len(system.bodies) == 2
    if not is_pair or not isinstance(system.contacts[0], Rigid):
        return None
    if "rod" not in system.kinds:  # a restitution is given, and no wave runs
        return None
    # If gravity or an end acts on the row, it differs from this system without them.
    without_loads = System(system.bodies, system.gaps, system.contacts)
    if system != without_loads:
        return None
    left = _closed_form_inputs(system.bodies[0])
    right = _closed_form_inputs(system.bodies[1])
    if left is None or right is None:
        return None
    arrays = []
    # Both impedances, then both transit times, masses and velocities.
    for of_left, of_right in zip(left, right, strict=True):
        left_array = np.broadcast_to(of_left, system.shape)
        right_array = np.broadcast_to(of_right, system.shape)
        arrays.append(np.stack([left_array, right_array]))
    family = PairTheory(*arrays)  # its fields are those of `_ClosedFormInputs`
    if not family.approaches.any():
        return None
    return family


class _ClosedFormInputs(NamedTuple):
    """Numbers of one body, as `PairTheory` has them of both.

    Each is a float or an array.
    """

    impedance: Any  # kg/s; infinite for a wall or a rigid mass
    transit_time: Any  # s; 0 for a wall or a rigid mass
    mass: Any  # kg
    velocity: Any  # m/s


def _closed_form_inputs(body: Body) -> _ClosedFormInputs | None:
    """Numbers of a body for the closed forms; the mass of a wall is infinite.

    None for a rod that is not uniform, has damping, lateral inertia or initial strain,
    or has a velocity that is a profile along it.
    """
    if not isinstance(body, Rod):
        mass = getattr(body, "mass", np.inf)  # a wall has no such number
        return _ClosedFormInputs(
            impedance=np.inf, transit_time=0.0, mass=mass, velocity=body.velocity
        )
    segment = body.segments[0]
    # An ideal segment has one area, no damping and no lateral inertia.
    is_ideal = len(body.segments) == 1 and segment.ideal
    moves_as_one = isinstance(body.velocity, float | np.ndarray)  # else it is a profile
    is_strained = np.any(body.strain != 0)  # True for any profile
    if not is_ideal or not moves_as_one or is_strained:
        return None
    return _ClosedFormInputs(
        impedance=segment.impedance,
        transit_time=segment.transit_time,
        mass=segment.mass,
        velocity=body.velocity,
    )
