"""A system as a row of segments, rigid masses and links, in flat lists.

Every method starts from a `Row`. Segments are counted 1 to n from left to right; 0 and n + 1 are
what lies outside. Node k joins the segments k and k + 1: rigid masses may stand there, and links
join what stands beside each other. Numbers are those of the system, in SI: floats, or for a family
arrays.
"""

from __future__ import annotations

import math
import sys
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from ..model import InvalidModel, System, Wall
from ..model.arguments import plain
from ..model.profiles import extremes
from .laws import Law
from .walk import Walk, frame_of, least_impedance, scale_of, walk
from .walk import largest as largest

SMALLEST, LARGEST = sys.float_info.min, sys.float_info.max
ROOM = 2.0**60  # for sums over steps and cells
STIFFEST = 2.0**80  # of a contact, times transit time over impedance
Array = np.ndarray[Any, np.dtype[Any]]


class Row(Walk):
    """A system, or a family of them, as a row of links, masses and segments.

    Attributes
    ----------
    system : System
    segments : list of Segment
    paths : list of str
        By segment, what the user calls it; "" for 0.
    spans : list of (int, int)
        First and last segment of each body; (1, 0) for a wall or a rigid mass.
    first : list of int
        Masses left of each node; the links of node k begin at k + first[k].
    masses, mass_velocity : list of float
        Bodies bonded together are one mass.
    mass_of : list of int
        Mass of each body; len(masses) + 0 or 1 if bonded to the left or right wall, -1 for a rod or
        a wall.
    links : list of link.Link
    contact_link : list of int
        Link of each contact, -1 where it joins rigid bodies for good.
    outside : list of (str, value)
        Left and right: ``"none"``, ``"velocity"``, ``"force"`` or ``"absorbing"``; the value of
        the last is the strain of the wave that comes in.
    """

    def __new__(cls, system: System) -> Row:
        """Walk through a system."""
        return super().__new__(cls, *walk(system))

    def outside_name(self, side: int) -> str:
        """What acts on the left or right end, as an `Outside` names it."""
        if isinstance(self.system.bodies[-side], Wall):
            return "wall"
        return "absorbing" if self.outside[side][0] == "absorbing" else "drive"

    @cached_property
    def members(self) -> int:
        """How many rows the family has; 1 where it is none."""
        return math.prod(self.system.shape)

    def of(self, value: Any) -> Array:
        """A number for each member, [member] in C order."""
        return np.array(np.broadcast_to(value, self.system.shape), dtype=float).ravel()

    @cached_property
    def beside(self) -> list[tuple[tuple[str, int], tuple[str, int]]]:
        """By link, what stands on its left and on its right.

        ("outside", side), ("mass", m) or ("segment", s).
        """
        stands = [("outside", 0)]
        for k, (start, stop) in enumerate(pairwise(self.first)):
            stands += [("mass", m) for m in range(start, stop)]
            stands.append(
                ("segment", k + 1) if k < len(self.segments) else ("outside", 1)
            )
        return list(pairwise(stands))

    @cached_property
    def by_law(self) -> dict[int, int]:
        """Links of the contacts whose force follows from a law, all but the bonded, by contact."""
        links = enumerate(self.contact_link)
        return {k: i for k, i in links if i >= 0 and self.links[i].law > Law.BOND}

    @cached_property
    def opening(self) -> dict[int, int]:
        """Links of the contacts that can open, by contact."""
        return {k: i for k, i in self.by_law.items() if self.links[i].law >= Law.RIGID}

    # Scales ---------------------------------------------------------------------------------------

    @cached_property
    def frame(self) -> Any:
        """Velocity of the frame in which methods other than fronts count velocities, m/s."""
        return plain(np.asarray(frame_of(self)))

    @cached_property
    def scale(self) -> Any:
        """Scale of velocities, m/s."""
        return plain(np.asarray(scale_of(self)))

    def beyond_scales(self) -> list[tuple[Any, str, str]]:
        """Where steps overflow, vanish, or lose an indentation in round-off.

        Returns
        -------
        list of (bool or array, str, str)
            Whether that is so, path and sentence.
        """
        speed: Any = self.scale
        heaviest: Any = largest([*self.masses, *(s.mass for s in self.segments)])
        T: Any = largest([s.transit_time for s in self.segments])
        with np.errstate(over="ignore", invalid="ignore", under="ignore"):
            force = speed * largest(
                [
                    s.material.density * s.wave_speed * extremes(s.area)[1]
                    for s in self.segments
                ]
            )
            squares = speed * speed * heaviest, force * force
            good = np.less(SMALLEST * ROOM, np.minimum(*squares)) & np.less(
                np.maximum(*squares), LARGEST / ROOM
            )
            message = (
                f"velocities and strains of {np.max(speed):.6g} m/s make energies or forces "
                "that overflow or vanish; use smaller or larger ones"
            )
            beyond = [(np.not_equal(speed, 0) & ~good, "bodies", message)]
            for i, link in self.by_law.items():
                it = self.links[link]
                stiff = (
                    it.stiffness
                    * (T / least_impedance(self))
                    * np.power(speed * T, np.asarray(it.exponent) - 1)
                )
                message = (
                    f"is as good as rigid beside these rods, got {it.stiffness!r}; use "
                    f"{'Bonded' if it.law == Law.JOINT else 'Rigid'}()"
                )
                beyond.append(
                    (
                        ~np.less_equal(stiff, STIFFEST),
                        f"contacts.{i}.stiffness",
                        message,
                    )
                )
        return beyond

    def check_scales(self) -> None:
        """Raise InvalidModel where steps overflow, vanish, or lose an indentation in round-off."""
        problems = [
            (path, message) for bad, path, message in self.beyond_scales() if bad
        ]
        if problems:
            raise InvalidModel(problems[:1] if problems[0][0] == "bodies" else problems)


def squeezed(seconds: float) -> InvalidModel:
    """What to raise where a rigid mass cannot move."""
    message = (
        f"two walls squeeze a rigid mass at {seconds:.6g} s; give one of its contacts a compliant "
        "law"
    )
    return InvalidModel([("contacts", message)])
