"""The bodies of a row at chosen instants: bars of rods, walls, masses and what is at the ends."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from ..methods.signals import Floats
from ..model import Absorbing, RigidMass, Rod
from ..model.profiles import extremes
from ..results.placing import Placing
from .borders import DRIVEN, OPEN_END, WALL
from .sampling import is_stepped, mean_areas, sampled
from .scales import Scale
from .style import DIVERGING, colours

THICKNESS = 0.5  # of the thickest bar, in distances between rows
SWELLING = 0.25  # relative thickening at the largest strain
THINNEST = 0.35  # thinnest bar beside the thickest
NARROWEST = 1e-9  # part of a rod that is drawn: fronts leave an end at no exact floating-point time


class Piece(NamedTuple):
    """A uniform piece of rod in a row of the picture: its ends, half thickness and state."""

    row: int
    body: int
    left: float
    right: float
    half: float
    velocity: float
    strain: float
    stress: float


class Bars:
    """Draws the bodies at times, s, one row below the other.

    Attributes
    ----------
    pieces : list of Piece
        Of all rods, row by row.
    fronts : list of (x, y, whether it runs right)
        Wave fronts inside the rods.
    largest : float
        The strain at which a bar swells most.
    """

    def __init__(self, plan: Placing, times: Floats, place: Scale) -> None:
        self.plan, self.place, self.colours = plan, place, colours()
        self.system = plan.solution.system
        self.stepped = is_stepped(plan.solution)
        self.largest = 0.0
        self.at(times)

    def at(self, times: Floats) -> None:
        """Go to other times; the bars swell as before."""
        self.times = times
        solution, fields = self.plan.solution, self.plan.solution.fields
        rods = [(i, body) for i, body in enumerate(self.system.bodies) if isinstance(body, Rod)]
        widest = max(extremes(s.area)[1] for _, rod in rods for s in rod.segments)
        states = [(row, i, rod, t, sampled(solution, i, t) if self.stepped
                   else fields.profile(i, int(fields.to_ticks(t))))
                  for row, t in enumerate(self.times.tolist()) for i, rod in rods]
        self.largest = self.largest or max(
            float(np.abs(profile.strain).max()) for *_, profile in states) or 1.0
        self.pieces: list[Piece] = []
        self.fronts: list[tuple[float, float, bool]] = []
        for row, i, rod, t, profile in states:
            displaced = solution.displacement(i, profile.edges, t)
            edges = (self.plan.place(i, profile.edges, t, displaced) * self.place.factor).tolist()
            first = profile.segment[0]
            areas = mean_areas(rod, profile.edges, profile.segment - first)
            wide = np.diff(profile.edges) > NARROWEST * profile.edges[-1]
            for j, which in enumerate(profile.segment.tolist()):
                if not wide[j]:
                    continue
                segment = rod.segments[which - first]
                v, strain = float(profile.velocity[j]), float(profile.strain[j])
                thickness = max(THINNEST, float(areas[j] / widest) ** 0.5) * THICKNESS
                half = thickness / 2 * (1 - SWELLING * strain / self.largest)
                stress = strain * float(segment.material.youngs_modulus)
                self.pieces.append(Piece(row, i, edges[j], edges[j + 1], half, v, strain, stress))
                if not self.stepped and j and wide[j - 1] and which == profile.segment[j - 1]:
                    jump = v - float(profile.velocity[j - 1])
                    stretch = float(segment.wave_speed) * (strain - float(profile.strain[j - 1]))
                    if np.isclose(abs(jump), abs(stretch), rtol=1e-6, atol=0.0):
                        self.fronts.append((edges[j], -row + 0.4, jump * stretch < 0))

    def rods(self, ax: Axes, numbers: Floats, norm: Normalize) -> PolyCollection:
        """A polygon for each piece, with these numbers; outlined each where pieces are few."""
        bars = PolyCollection(
            [[(p.left, -p.row - p.half), (p.right, -p.row - p.half),
              (p.right, -p.row + p.half), (p.left, -p.row + p.half)] for p in self.pieces],
            array=numbers, cmap=DIVERGING, norm=norm, zorder=2, rasterized=self.stepped,
            **({"linewidths": 0.0, "antialiased": False} if self.stepped
               else {"linewidths": 0.6, "edgecolors": self.colours.ink}),
        )
        ax.add_collection(bars)
        return bars

    def outlines(self, ax: Axes) -> LineCollection | None:
        """Lines round the rods where pieces are many."""
        if not self.stepped:
            return None
        lines, start = [], 0
        for i, piece in enumerate(self.pieces, 1):
            if i < len(self.pieces) and self.pieces[i][:2] == piece[:2]:
                continue
            upper = [point for p in self.pieces[start:i]
                     for point in ((p.left, -p.row + p.half), (p.right, -p.row + p.half))]
            lower = [(x, -2.0 * piece.row - y) for x, y in reversed(upper)]
            lines.append([*upper, *lower, upper[0]])
            start = i
        drawn = LineCollection(lines, colors=self.colours.ink, linewidths=0.6, zorder=2.5)
        ax.add_collection(drawn)
        return drawn

    def walls(self, ax: Axes) -> tuple[list[Rectangle], list[Line2D]]:
        """A hatched block beyond the face of each wall and fixed end, and the faces."""
        _, ink, faint, wall, *_ = self.colours
        depth = WALL * self.plan.row * self.place.factor
        blocks, faces = [], []
        for i, right in self.plan.walls():
            for row, face in enumerate(self._end(i, right)):
                corner = (face if right else face - depth, -row - 0.45)
                blocks.append(Rectangle(corner, depth, 0.9, facecolor=wall, edgecolor=faint,
                                        hatch="////", linewidth=0.0))
                ax.add_patch(blocks[-1])
                faces += ax.plot([face, face], [-row - 0.45, -row + 0.45], color=ink, linewidth=1.5)
        return blocks, faces

    def masses(self, ax: Axes) -> list[Rectangle]:
        """A block for each rigid mass."""
        blocks = []
        for i, body in enumerate(self.system.bodies):
            if not isinstance(body, RigidMass):
                continue
            for row, left in enumerate(self._end(i, False)):
                blocks.append(Rectangle(
                    (left, -row - THICKNESS / 2), self.plan.block * self.place.factor, THICKNESS,
                    facecolor=self.colours.mass, edgecolor=self.colours.ink, linewidth=0.6,
                    zorder=3,
                ))
                ax.add_patch(blocks[-1])
        return blocks

    def ends(self, ax: Axes) -> list[Line2D]:
        """Dashes at absorbing ends, and arrow heads at driven ones."""
        paper, ink, *_ = self.colours
        last, drawn = len(self.system.bodies) - 1, []
        for side, end in enumerate(self.system.ends):
            places, rows = self._end(side * last, bool(side)), -np.arange(self.times.size)
            if isinstance(end, Absorbing):
                for x, y in zip(places, rows, strict=True):
                    drawn += ax.plot([x, x], [y - 0.4, y + 0.4], color=ink, linewidth=1.6,
                                     linestyle=OPEN_END)
            elif type(end) in DRIVEN:
                drawn += ax.plot(places, rows, linestyle="", marker="<" if side else ">",
                                 markersize=6.0, color=ink, markerfacecolor=paper, zorder=4)
        return drawn

    def _end(self, body: int, right: bool) -> Floats:
        """Places of an end of a body, in the unit of the picture."""
        return self.plan.end(body, right, self.times) * self.place.factor
