"""Place of a point in the picture: laboratory place with magnified displacement.

Rods a metre long move by a tenth of a millimetre while they collide. Figures, films and the page
therefore magnify displacements and gaps, all by the same factor, so that bodies that touch touch in
the picture too:
X = place in the row of unstrained rods without gaps + factor * (gaps to the left + displacement).
A row that drifts much farther than its bodies move against each other is drawn in a moving frame.
A rigid mass has no length; in pictures it is a block. A compliant contact is a spring, drawn so
long that magnified faces stay apart.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..methods.signals import Floats, Ints
from ..model import Bonded, Fixed, Moved, Rigid, RigidMass, Rod, Wall
from ..model.arguments import single
from ..results.contacts import ContactHistory
from ..results.magnification import BLOCK, drifts, magnified, round_down
from ..results.solution import Solution
from ..units import TIMES, format_factor
from .sampling import pieces, properties

ROOM = 0.04  # of a spring at its shortest, in lengths of the row


@dataclass(frozen=True)
class Placing:
    """How a row is laid out in a picture.

    Attributes
    ----------
    solution : Solution
    magnification : float
        Of displacements and gaps; 0 draws every body at its place in the undeformed row.
    frame : float
        Velocity of the frame of the picture, m/s.
    left : array
        Left end of each body in the row of unstrained rods without gaps, m; the left end of the
        first rod is at 0.
    widths : array
        Of each body in the picture before it moves, m.
    apart : array
        Additional place of the left end of each body from gaps and strain at t = 0, m.
    block : float
        Width of a rigid mass in the picture, m; 0 if there is none.
    free : array
        Length of the spring at each contact before it is pressed, m; 0 without one.
    """

    solution: Solution
    magnification: float
    frame: float
    left: Floats
    widths: Floats
    apart: Floats
    block: float
    free: Floats

    @property
    def row(self) -> float:
        """Length of all rods and blocks together, m."""
        return float(self.left[-1] + self.widths[-1] - self.left[0])

    @property
    def scale(self) -> str:
        """How displacements are drawn, in words."""
        if self.magnification == 1:
            return "true to scale"
        return f"displacements {TIMES} {format_factor(self.magnification)}"

    def place(
        self, body: int | Ints, x: ArrayLike, t: ArrayLike, displacement: Any
    ) -> Floats:
        """Place X in the picture, m, of points x (m) of bodies at t (s), displaced (m)."""
        moved = self.apart[body] + displacement - self.frame * np.asarray(t)
        place: Floats = self.left[body] + np.asarray(x) + self.magnification * moved
        return place

    def material(self, body: int) -> tuple[float, float]:
        """Material coordinates x of the ends of a body, m; masses have no length."""
        bodies = self.solution.system.bodies
        ends = [0.0, 0.0]
        for each in bodies[: body + 1]:
            length = float(each.length) if isinstance(each, Rod) else 0.0
            ends = [ends[1], ends[1] + length]
        return ends[0], ends[1]

    def walls(self) -> list[tuple[int, bool]]:
        """Bodies that are walls or have a fixed end, and whether that is their right end."""
        bodies, ends = self.solution.system.bodies, self.solution.system.ends
        return [
            *((i, i > 0) for i, body in enumerate(bodies) if isinstance(body, Wall)),
            *(
                (side * (len(bodies) - 1), bool(side))
                for side, end in enumerate(ends)
                if isinstance(end, Fixed)
            ),
        ]

    def point(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        """Place X of points of a body, x m from its left end, at t.

        Before t = 0 bodies come as they are then, with their velocity.
        """
        before = np.minimum(t, 0.0) * self.solution.outcome.velocities_before[body]
        displacement = self.solution.displacement(body, x, np.maximum(t, 0.0)) + before
        return self.place(body, x, t, displacement)

    def end(self, body: int, right: bool, t: ArrayLike) -> Floats:
        """Place X of the left or right end of a body at t."""
        return self.point(body, self.widths[body] if right else 0.0, t)

    def middle(self, body: int, t: ArrayLike) -> Floats:
        """Place X half-way between the ends of a body at t."""
        return (self.end(body, False, t) + self.end(body, True, t)) / 2

    def centre(self, body: int, t: Floats) -> Floats:
        """Place X of the centre of mass of a rod at t [n]."""
        edges = pieces(self.solution, body)
        middle = (edges[:-1] + edges[1:]) / 2
        area, _, density = properties(self.solution, body, middle)
        mass = density * area * np.diff(edges)
        part: Floats = mass / mass.sum()
        return part @ self.point(body, middle[:, None], t)

    def springs(self, times: Floats) -> list[tuple[ContactHistory, Floats, Floats]]:
        """Contacts with a spring, and its ends at times; in an open contact it is not stretched."""
        found = []
        for i, history in enumerate(self.solution.contacts):
            if self.free[i]:
                left, right = self.end(i, True, times), self.end(i + 1, False, times)
                longest = left + self.free[i] if history.law.opens else np.inf
                found.append((history, left, np.minimum(right, longest)))
        return found


def placing(
    solution: Solution,
    start: float,
    stop: float,
    magnification: float | None = None,
    still: bool = False,
) -> Placing:
    """Choose frame and magnification (1, 2 or 5 times a power of ten) for an interval of time.

    Parameters
    ----------
    solution : Solution
    start, stop : float
        s.
    magnification : float, optional
        To be used instead of the automatic one.
    still : bool
        Whether bodies stay in the undeformed row.

    Raises
    ------
    ValueError
        If the magnification is not a positive number.
    """
    if magnification is not None:
        magnification = single("magnification", magnification, "", "positive")
    bodies = solution.system.bodies
    lengths = [float(body.length) if isinstance(body, Rod) else 0.0 for body in bodies]
    begin = np.cumsum([0.0, *lengths[:-1]])
    apart = np.array(solution.fields.positions) - begin
    times = np.linspace(start, stop, 101)
    moved = np.array(
        [
            apart[body] + solution.displacement(body, x, times)
            for body, length in enumerate(lengths)
            for x in (0.0, length)
        ]
    )
    # velocity of a wall, 0 if an end is held, else the least of the bodies' velocities
    held = [float(body.velocity) for body in bodies if isinstance(body, Wall)]
    held += [0.0 for end in solution.system.ends if isinstance(end, Fixed | Moved)]
    slowest = min(held or solution.outcome.velocities_before, key=abs)
    relative = float(np.ptp(moved - slowest * times))
    reach = float(np.ptp(moved))
    row = sum(lengths) or reach or 1.0  # the scale of masses alone is how far they move
    masses = np.array([isinstance(body, RigidMass) for body in bodies])
    block = round_down(BLOCK * row) if masses.any() else 0.0
    left = begin + block * (np.cumsum(masses) - masses)
    widths = np.where(masses, block, lengths)
    if still:
        magnification = 0.0
    elif magnification is None:
        strain = max(
            (
                np.abs(
                    solution.strain(body, np.linspace(0, length, 33)[:, None], times)
                ).max()
                for body, length in enumerate(lengths)
                if length
            ),
            default=0.0,
        )
        magnification = magnified(row, reach, relative, float(strain))
    frame = slowest if drifts(reach, relative) else 0.0
    free, often = np.zeros(len(solution.contacts)), np.linspace(start, stop, 301)
    for history in (
        solution.contacts if magnification > 1 else ()
    ):  # true to scale none is drawn
        if not isinstance(history.law, Rigid | Bonded):
            deepest = max(0.0, -float(np.min(history.gap(often))))
            free[history.index] = (
                ROOM * (left[-1] + widths[-1]) + magnification * deepest
            )
    left = left + np.cumsum([0.0, *free])
    rods = [i for i, body in enumerate(bodies) if isinstance(body, Rod)]
    if rods:  # masses and springs before the first rod lie at x < 0
        left = left - left[rods[0]]
    return Placing(
        solution,
        magnification,
        frame,
        left,
        widths,
        apart,
        block,
        free,
    )
