"""A system as a row of segments, rigid masses and links, in flat lists.

Every method starts from a `Row`, which `row_builder.build_row` makes. Segments are
counted 1 to n from left to right; 0 and n + 1 stand for the outside. Node k joins the
segments k and k + 1. Rigid masses may stand at a node, between its two segments, and a
link joins each pair of neighbours. Numbers are those of the system, in SI units:
floats, or for a family arrays.
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
        On the web page a table with the same names.
    segments : list of Segment
        Segment s is entry s - 1.
    paths : list of str
        Path of each segment in the user's model; entry 0 is "".
    spans : list of (int, int)
        First and last segment of each body, counted from 1; (1, 0), without segments,
        for a wall or a rigid mass.
    first_mass : list of int
        Index of the first mass of each node, which is the number of masses left of the
        node; the last entry is the number of all masses. The links of node k begin at
        k + first_mass[k].
    masses, mass_velocity : list of float
        Masses, kg, and their velocities, m/s. Rigid bodies bonded together are one
        mass.
    mass_of : list of int
        Index of the mass of each body; -1 for a rod or a wall. For a body bonded to the
        left wall it is len(masses), to the right wall len(masses) + 1.
    links : list of link.Link
    contact_link : list of int
        Index of the link of each contact; -1 for a bond of two rigid bodies.
    boundaries : list of (str, value)
        Kind and value of the left and the right boundary. Kinds are ``"none"``,
        ``"velocity"``, ``"force"`` and ``"absorbing"``; the value of the last is the
        strain of the incoming wave.
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
        """Number of members of the family; 1 for a single system."""
        return math.prod(self.system.shape)

    def by_member(self, value: Any) -> Array:
        """`value`, a number or an array of the family, for each member, [member].

        The members are in C order. The result is a new array of floats.
        """
        return np.array(np.broadcast_to(value, self.system.shape), dtype=float).ravel()

    @cached_property
    def frame(self) -> Any:
        """Velocity of the frame of methods other than fronts, m/s; see `frame_of`."""
        return float_or_array(np.asarray(frame_of(self)))

    @cached_property
    def scale(self) -> Any:
        """Scale of velocities, m/s; see `scale_of`."""
        return float_or_array(np.asarray(scale_of(self)))

    # Neighbours -----------------------------------------------------------------------

    @cached_property
    def neighbours(self) -> list[tuple[tuple[str, int], tuple[str, int]]]:
        """The left and the right neighbour of each link, [link].

        Each is ("outside", side) with side 0 or 1, ("mass", m) with m counted from 0,
        or ("segment", s) with s counted from 1.
        """
        parts = [("outside", 0)]  # all masses and segments from left to right
        # Node k has the masses from `start` to `stop` - 1; segment k + 1 follows it.
        for k, (start, stop) in enumerate(pairwise(self.first_mass)):
            for m in range(start, stop):
                parts.append(("mass", m))
            if k < len(self.segments):
                parts.append(("segment", k + 1))
            else:
                parts.append(("outside", 1))
        return list(pairwise(parts))  # a link joins each pair of neighbours

    @cached_property
    def unbonded_links(self) -> dict[int, int]:
        """Index of the link of each contact that is not bonded, by contact.

        The force of such a contact follows from a law.
        """
        links = {k: i for k, i in enumerate(self.contact_link) if i >= 0}
        # BOND is the first entry of `Law`.
        return {k: i for k, i in links.items() if self.links[i].law > Law.BOND}

    @cached_property
    def unilateral_links(self) -> dict[int, int]:
        """Index of the link of each contact that can open, by contact."""
        # In `Law`, joints precede RIGID, and all other contacts follow it.
        links = self.unbonded_links
        return {k: i for k, i in links.items() if self.links[i].law >= Law.RIGID}

    def boundary_name(self, side: int) -> str:
        """Name of the action on the left (0) or right (1) end.

        It is ``"wall"``, ``"absorbing"`` or ``"drive"``, and becomes the `kind` of a
        `BoundaryAction`. For a free end, on which nothing acts, it is a meaningless
        ``"drive"``.
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
    """Make the error for a rigid mass that two walls squeeze at the time `seconds`.

    Its path is "contacts". The caller raises it.
    """
    message = (
        f"two walls squeeze a rigid mass at {seconds:.6g} s; give one of its contacts "
        "a compliant law"
    )
    return InvalidModel([("contacts", message)])
