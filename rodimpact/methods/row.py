"""A system as a row of segments, rigid masses and links, in flat lists.

Every method starts from a `Row`, which `row_builder.build_row` makes. Segments are
counted 1 to n from left to right; 0 and n + 1 are what lies outside. Node k joins the
segments k and k + 1: rigid masses may stand there, and links join what stands beside
each other. Numbers are those of the system, in SI: floats, or for a family arrays.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from ..model import InvalidModel, Wall
from ..model.arguments import float_or_array
from .link import Law
from .scales import frame_of, scale_of

Array = np.ndarray[Any, np.dtype[Any]]


@dataclass(eq=False)
class Row:
    """A system, or a family of them, as a row of links, masses and segments.

    Attributes
    ----------
    system : System
        On the page a table with the same names.
    segments : list of Segment
    paths : list of str
        By segment, what the user calls it; "" for 0.
    spans : list of (int, int)
        First and last segment of each body, counted from 1; (1, 0), without segments,
        for a wall or a rigid mass.
    first_mass : list of int
        First mass of each node, which is the number of masses left of it; the links of
        node k begin at k + first_mass[k].
    masses, mass_velocity : list of float
        Bodies bonded together are one mass, kg and m/s.
    mass_of : list of int
        Mass of each body; len(masses) + 0 or 1 if bonded to the left or right wall, -1
        for a rod or a wall.
    links : list of link.Link
    contact_link : list of int
        Link of each contact, -1 where it joins rigid bodies for good.
    boundaries : list of (str, value)
        Left and right: ``"none"``, ``"velocity"``, ``"force"`` or ``"absorbing"``; the
        value of the last is the strain of the wave that comes in.
    """

    system: Any
    segments: list[Any]
    paths: list[str]
    spans: list[tuple[int, int]]
    first_mass: list[int]
    masses: list[Any]
    mass_velocity: list[Any]
    mass_of: list[int]
    links: list[Any]
    contact_link: list[int]
    boundaries: list[tuple[str, Any]]

    @cached_property
    def members(self) -> int:
        """How many rows the family has; 1 where it is none."""
        return math.prod(self.system.shape)

    def of(self, value: Any) -> Array:
        """`value` as a number for each member, [member] in C order.

        It is a number or an array.
        """
        return np.array(np.broadcast_to(value, self.system.shape), dtype=float).ravel()

    @cached_property
    def frame(self) -> Any:
        """Velocity of the frame in which methods other than fronts count, m/s."""
        return float_or_array(np.asarray(frame_of(self)))

    @cached_property
    def scale(self) -> Any:
        """Scale of velocities, m/s."""
        return float_or_array(np.asarray(scale_of(self)))

    # Neighbours -----------------------------------------------------------------------

    @cached_property
    def neighbours(self) -> list[tuple[tuple[str, int], tuple[str, int]]]:
        """By link, the pair of what stands on its left and on its right.

        Each is ("outside", side) with side 0 or 1, ("mass", m), counted from 0, or
        ("segment", s), counted from 1.
        """
        stands = [("outside", 0)]  # all that stands in the row, from left to right
        # Node k has the masses from `start` to `stop` - 1; segment k + 1 follows it.
        for k, (start, stop) in enumerate(pairwise(self.first_mass)):
            for m in range(start, stop):
                stands.append(("mass", m))
            if k < len(self.segments):
                stands.append(("segment", k + 1))
            else:
                stands.append(("outside", 1))
        return list(pairwise(stands))

    @cached_property
    def by_law(self) -> dict[int, int]:
        """Link of each contact that is not bonded, by contact.

        Its force follows from a law.
        """
        links = {k: i for k, i in enumerate(self.contact_link) if i >= 0}
        # Bonds come first among the laws.
        return {k: i for k, i in links.items() if self.links[i].law > Law.BOND}

    @cached_property
    def unilateral_links(self) -> dict[int, int]:
        """Link of each contact that can open, by contact."""
        # Joints come before rigid contacts, all other contacts behind.
        return {k: i for k, i in self.by_law.items() if self.links[i].law >= Law.RIGID}

    def boundary_name(self, side: int) -> str:
        """Name of what acts on the left (0) or right (1) end.

        It is ``"wall"``, ``"absorbing"`` or ``"drive"``, and becomes the `kind` of a
        `BoundaryAction`. Nothing acts on a free end; its name, "drive", means nothing.
        """
        if side == 0:
            body = self.system.bodies[0]
        else:
            body = self.system.bodies[-1]
        if isinstance(body, Wall):
            return "wall"
        if self.boundaries[side][0] == "absorbing":
            return "absorbing"
        return "drive"


def squeezed(seconds: float) -> InvalidModel:
    """The error to raise where walls squeeze a rigid mass at this time, s.

    Its path is "contacts"; nothing is raised here.
    """
    message = (
        f"two walls squeeze a rigid mass at {seconds:.6g} s; give one of its contacts "
        "a compliant law"
    )
    return InvalidModel([("contacts", message)])
