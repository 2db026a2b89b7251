"""What the closed forms of `rodimpact.theory` say about a family of two uniform bodies."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from ..model import Body, Rigid, Rod, System, Wall
from ..signals import Floats
from ..theory import rod_on_wall, saint_venant

Two: TypeAlias = tuple[Floats, Floats]
COLUMNS = (
    "restitution", "velocity_after.0", "velocity_after.1", "impulse.0", "peak_force.0",
    "duration.0", "vibration",
)
"""Columns of a sweep that have a closed form."""


class Pairs(NamedTuple):
    """A family of two uniform bodies that do not vibrate before they collide.

    Attributes
    ----------
    impedance, transit_time : two arrays of the shape of the family
        kg/s and s; infinite for a wall.
    velocity : two arrays of the shape of the family
        m/s.
    """

    impedance: Two
    transit_time: Two
    velocity: Two

    def each(self, change: Callable[[Floats], Floats]) -> Pairs:
        """The family with every array changed."""
        return Pairs(*((change(left), change(right)) for left, right in self))

    def along(self, known: Floats, wanted: Floats) -> Pairs:
        """A family with one axis, given at `known`, at `wanted` values of its parameter.

        With logarithms as parameter this is exact: impedances and transit times are powers of
        lengths, areas, densities and moduli.
        """

        def between(values: Floats) -> Floats:
            if (values <= 0).any() or np.isinf(values).any():
                return np.interp(wanted, known, values)
            return np.exp(np.interp(wanted, known, np.log(values)))

        return self.each(between)

    def column(self, name: str) -> Floats:
        """Results of one of `COLUMNS`, NaN where the bodies do not approach each other."""
        (Z1, Z2), (T1, T2), (v1, v2) = self
        meet = v1 > v2
        V = np.where(meet, v1 - v2, 1.0)
        if np.isinf(Z1).any():
            found = rod_on_wall(Z2, T2, V)
        elif np.isinf(Z2).any():
            found = rod_on_wall(Z1, T1, V)
        else:
            found = saint_venant(Z1, T1, Z2, T2, V)
        value = {
            "restitution": found.restitution,
            "velocity_after.0": v1 - found.impulse / (Z1 * T1),
            "velocity_after.1": v2 + found.impulse / (Z2 * T2),
            "impulse.0": found.impulse,
            "peak_force.0": found.peak_force,
            "duration.0": found.duration,
            "vibration": found.vibration_energy,
        }[name]
        return np.where(meet, value, np.nan)


def pairs(system: System) -> Pairs | None:
    """The family as pairs, or None if it has no closed form or none of them meet."""
    if len(system.bodies) != 2 or not isinstance(system.contacts[0], Rigid):
        return None
    if system != System(system.bodies, system.gaps, system.contacts):  # more acts on the row
        return None
    left, right = (_uniform(body) for body in system.bodies)
    if left is None or right is None:
        return None
    both = Pairs(*zip(left, right, strict=True)).each(lambda x: np.broadcast_to(x, system.shape))
    v1, v2 = both.velocity
    return both if (v1 > v2).any() else None


def _uniform(body: Body) -> tuple[Floats, Floats, Floats] | None:
    """Impedance, transit time and velocity of a wall or a uniform rod without strain."""
    if isinstance(body, Wall):
        return np.asarray(np.inf), np.asarray(np.inf), np.asarray(body.velocity)
    if not isinstance(body, Rod) or len(body.segments) > 1:
        return None
    if not isinstance(body.velocity, float | np.ndarray) or np.any(body.strain != 0):
        return None
    segment = body.segments[0]
    if not segment.ideal:
        return None
    return (np.asarray(segment.impedance), np.asarray(segment.transit_time),
            np.asarray(body.velocity))
