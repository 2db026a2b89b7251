"""Where a point is drawn: its place in the laboratory with its displacement magnified.

Rods a metre long move by a tenth of a millimetre while they collide. Figures, films and the page
therefore magnify displacements and gaps, all by the same factor, so that bodies that touch touch in
the picture too:
X = place in the row of unstrained rods without gaps + factor * (gaps to the left + displacement).
A row that drifts much farther than its bodies move against each other is drawn in a moving frame.
A rigid mass has no length; in pictures it is a block.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..methods.signals import Floats, Ints
from ..model import Fixed, Moved, RigidMass, Rod, Wall
from ..model.arguments import single
from ..results.magnification import BLOCK, drifts, magnified, round_down
from ..results.solution import Solution
from ..units import TIMES, format_factor


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
        Left end of each body in the row of unstrained rods without gaps, m.
    apart : array
        How much farther to the right each body begins: gaps, and strain at t = 0, m.
    block : float
        Width of a rigid mass in the picture, m; 0 if there is none.
    """

    solution: Solution
    magnification: float
    frame: float
    left: Floats
    apart: Floats
    block: float

    @property
    def row(self) -> float:
        """Length of all rods and blocks together, m."""
        return float(self.left[-1]) + self.width(len(self.left) - 1)

    @property
    def scale(self) -> str:
        """How displacements are drawn, in words."""
        if self.magnification == 1:
            return "true to scale"
        return f"displacements {TIMES} {format_factor(self.magnification)}"

    def width(self, body: int) -> float:
        """Width of a body in the picture before it moves, m."""
        if isinstance(self.solution.system.bodies[body], RigidMass):
            return self.block
        return _length(self.solution, body)

    def place(self, body: int | Ints, x: ArrayLike, t: ArrayLike, displacement: Any) -> Floats:
        """Place X in the picture, m, of points x (m) of bodies at t (s), displaced (m)."""
        moved = self.apart[body] + displacement - self.frame * np.asarray(t)
        place: Floats = self.left[body] + np.asarray(x) + self.magnification * moved
        return place

    def walls(self) -> list[tuple[int, bool]]:
        """Bodies that are walls or have a fixed end, and whether that is their right end."""
        bodies, ends = self.solution.system.bodies, self.solution.system.ends
        return [
            *((i, i > 0) for i, body in enumerate(bodies) if isinstance(body, Wall)),
            *((side * (len(bodies) - 1), bool(side)) for side, end in enumerate(ends)
              if isinstance(end, Fixed)),
        ]

    def moved(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        """Displacement, m; before t = 0 bodies come as they are then, with their velocity."""
        before = np.minimum(t, 0.0) * self.solution.outcome.velocities_before[body]
        return np.asarray(self.solution.displacement(body, x, np.maximum(t, 0.0)) + before)

    def end(self, body: int, right: bool, t: ArrayLike) -> Floats:
        """Place X of the left or right end of a body at t."""
        x = self.width(body) if right else 0.0
        return self.place(body, x, t, self.moved(body, x, t))

    def between(self, contact: int, t: ArrayLike) -> Floats:
        """Place X of a contact at t: half-way between the faces."""
        return (self.end(contact, True, t) + self.end(contact + 1, False, t)) / 2


def placing(
    solution: Solution, start: float, stop: float, magnification: float | None = None
) -> Placing:
    """Choose frame and magnification (1, 2 or 5 times a power of ten) for an interval of time.

    Parameters
    ----------
    solution : Solution
    start, stop : float
        s.
    magnification : float, optional
        To be used instead of the automatic one.

    Raises
    ------
    ValueError
        If the magnification is not a positive number.
    """
    if magnification is not None:
        magnification = single("magnification", magnification, "", "positive")
    bodies = range(len(solution.system.bodies))
    lengths = [_length(solution, body) for body in bodies]
    begin = np.cumsum([0.0, *lengths[:-1]])
    apart = np.array(solution.fields.positions) - begin
    times = np.linspace(start, stop, 101)
    moved = np.array([
        apart[body] + solution.displacement(body, x, times)
        for body in bodies for x in (0.0, lengths[body])
    ])
    slowest = _slowest(solution)
    relative = float(np.ptp(moved - slowest * times))
    reach = float(np.ptp(moved))
    row = sum(lengths) or reach or 1.0  # the scale of masses alone is how far they move
    masses = np.array([isinstance(body, RigidMass) for body in solution.system.bodies])
    block = round_down(BLOCK * row) if masses.any() else 0.0
    left = begin + block * (np.cumsum(masses) - masses)
    if magnification is None:
        strain = 0.0
        for body in bodies:
            if lengths[body]:
                x, t = np.broadcast_arrays(np.linspace(0, lengths[body], 33)[:, None], times)
                strain = max(strain, float(np.abs(solution.strain(body, x, t)).max()))
        magnification = magnified(row, reach, relative, strain)
    frame = slowest if drifts(reach, relative) else 0.0
    return Placing(solution, magnification, frame, left, apart, block)


def _length(solution: Solution, body: int) -> float:
    """Length of a body, m; 0 for a wall or a mass."""
    rod = solution.system.bodies[body]
    return float(rod.length) if isinstance(rod, Rod) else 0.0


def _slowest(solution: Solution) -> float:
    """Velocity of a wall, 0 if an end is held, else the least of the bodies' velocities."""
    held = [float(b.velocity) for b in solution.system.bodies if isinstance(b, Wall)]
    held += [0.0 for end in solution.system.ends if isinstance(end, Fixed | Moved)]
    return min(held or solution.outcome.velocities_before, key=abs)
