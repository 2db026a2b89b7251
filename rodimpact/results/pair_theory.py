"""The closed form of `rodimpact.theory` that holds for a collision, or a family of them.

There is one for two bodies that meet rigidly, two uniform rods or one and a wall or a rigid mass,
which do not vibrate before and on which nothing else acts.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..methods.signals import Floats
from ..model import Body, Rigid, Rod, System
from ..theory import PairCollision, mass_on_rod, rod_on_wall, saint_venant


class PairTheory(NamedTuple):
    """A family of two bodies, the left and the right one, whose collision has a closed form.

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
        """Where the closed form comes from."""
        if np.isfinite(self.impedance).all():
            return "Saint-Venant 1867"
        return "textbook, box 10.4" if np.isinf(self.mass).any() else "Boussinesq"

    def each(self, change: Callable[[Floats], Floats]) -> PairTheory:
        """The family with every array changed."""
        return PairTheory(
            *(np.stack([change(left), change(right)]) for left, right in self)
        )

    def along(self, known: Floats, wanted: Floats) -> PairTheory:
        """A family with one axis, given at `known`, at `wanted` values of its parameter.

        With logarithms as parameter this is exact: impedances, transit times and masses are powers
        of lengths, areas, densities and moduli.
        """

        def between(values: Floats) -> Floats:
            if (values <= 0).any() or np.isinf(values).any():
                return np.interp(wanted, known, values)
            return np.exp(np.interp(wanted, known, np.log(values)))

        return self.each(between)

    def collision(self) -> PairCollision:
        """What theory says; at a closing speed of 1 m/s where the bodies do not approach."""
        (Z1, Z2), (T1, T2), (m1, m2), (v1, v2) = self
        V = np.where(v1 > v2, v1 - v2, 1.0)
        if np.isfinite(self.impedance).all():
            return saint_venant(Z1, T1, Z2, T2, V)
        Z, T, mass = (Z2, T2, m1) if np.isinf(Z1).any() else (Z1, T1, m2)
        return (
            rod_on_wall(Z, T, V) if np.isinf(mass).any() else mass_on_rod(mass, Z, T, V)
        )

    def column(self, name: str) -> Floats:
        """Results of one of `COLUMNS`, nan where the bodies do not approach each other."""
        return np.where(
            np.greater(*self.velocity), COLUMNS[name](self, self.collision()), np.nan
        )


COLUMNS: dict[str, Callable[[PairTheory, PairCollision], Any]] = {
    "restitution": lambda _, pair: pair.restitution,
    "velocity_after.0": lambda family, pair: (
        family.velocity[0] - pair.impulse / family.mass[0]
    ),
    "velocity_after.1": lambda family, pair: (
        family.velocity[1] + pair.impulse / family.mass[1]
    ),
    "impulse.0": lambda _, pair: pair.impulse,
    "peak_force.0": lambda _, pair: pair.peak_force,
    "duration.0": lambda _, pair: pair.duration,
    "vibration": lambda _, pair: pair.vibration_energy,
}
"""Columns of a sweep that have a closed form."""


def pair_theory(system: System) -> PairTheory | None:
    """The closed form that holds for a family; None if there is none or no members collide."""
    numbers = [_numbers(body) for body in system.bodies]
    rigid = len(numbers) == 2 and all(numbers) and isinstance(system.contacts[0], Rigid)
    if not rigid or system != System(system.bodies, system.gaps, system.contacts):
        return None  # more acts on the row
    family = PairTheory(
        *(
            np.stack([np.broadcast_to(x, system.shape) for x in pair])
            for pair in zip(*numbers, strict=True)
        )
    )
    return family if np.greater(*family.velocity).any() else None


def _numbers(body: Body) -> tuple[Any, ...]:
    """Impedance, transit time, mass and velocity; none of a rod that has more to it."""
    if isinstance(body, Rod):
        segment, even = body.segments[0], isinstance(body.velocity, float | np.ndarray)
        if (
            len(body.segments) > 1
            or not segment.ideal
            or not even
            or np.any(body.strain != 0)
        ):
            return ()
        return segment.impedance, segment.transit_time, segment.mass, body.velocity
    return np.inf, 0.0, getattr(body, "mass", np.inf), body.velocity
