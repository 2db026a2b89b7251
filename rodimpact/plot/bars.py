"""The bodies of a row at chosen instants: bars of rods, walls, masses and what is at the ends."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from ..methods.signals import Floats
from ..model import Absorbing, RigidMass, Rod
from ..model.profiles import extremes
from ..results.fields import Profile
from ..results.gauges import Gauge
from .borders import (
    DRIVEN,
    WALL,
    drive_style,
    mass_style,
    open_style,
    wall_style,
)
from .placing import Placing
from .sampling import is_stepped, mean_areas, sampled
from .scales import Scale
from .springs import draw_springs, is_compliant
from .style import SMALL, colours

THICKNESS = 0.5  # of the thickest bar, in distances between rows
SWELLING = 0.25  # relative thickening at the largest strain
THINNEST = 0.35  # thinnest bar beside the thickest
THICKNESS_TOLD = "thicker: compressed, thinner: stretched"
PRESSING = 0.36  # half height of the line of a contact that presses
MANY = 16  # pieces of a rod from which those alike are drawn as one
ALIKE = 0.1  # of the range of a rod's velocities: how much they differ at most
ONE_WAY = 0.1  # how much velocity and stretch may differ across a front that has a direction
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
        states = [(row, i, rod, t, sampled(solution, i, max(t, 0.0)) if self.stepped
                   else _thinned(fields.profile(i, int(fields.to_ticks(max(t, 0.0))))))
                  for row, t in enumerate(self.times.tolist()) for i, rod in rods]
        self.largest = self.largest or max(
            float(np.abs(profile.strain).max()) for *_, profile in states) or 1.0
        self.pieces: list[Piece] = []
        self.fronts: list[tuple[float, float, bool]] = []
        for row, i, rod, t, profile in states:
            displaced = self.plan.moved(i, profile.edges, t)
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
                    if np.isclose(abs(jump), abs(stretch), rtol=ONE_WAY, atol=0.0):
                        self.fronts.append((edges[j], -row + 0.4, jump * stretch < 0))

    def rods(self, ax: Axes, numbers: Floats, norm: Normalize) -> PolyCollection:
        """A polygon for each piece, with these numbers; outlined each where pieces are few."""
        lines: Any = ({"linewidths": 0.0, "antialiased": False} if self.stepped
                      else {"linewidths": 0.6, "edgecolors": self.colours.ink})
        bars = PolyCollection(
            [[(p.left, -p.row - p.half), (p.right, -p.row - p.half),
              (p.right, -p.row + p.half), (p.left, -p.row + p.half)] for p in self.pieces],
            array=numbers, cmap=self.colours.signed, norm=norm, zorder=2,
            rasterized=self.stepped, **lines)
        ax.add_collection(bars)
        return bars

    def outlines(self, ax: Axes) -> LineCollection | None:
        """Lines round the rods where pieces are many."""
        if not self.stepped:
            return None
        lines = []
        for (row, _), rod in groupby(self.pieces, lambda piece: piece[:2]):
            upper = [point for p in rod
                     for point in ((p.left, -p.row + p.half), (p.right, -p.row + p.half))]
            lower = [(x, -2.0 * row - y) for x, y in reversed(upper)]
            lines.append([*upper, *lower, upper[0]])
        drawn = LineCollection(lines, colors=self.colours.ink, linewidths=0.6, zorder=2.5)
        ax.add_collection(drawn)
        return drawn

    def walls(self, ax: Axes) -> tuple[list[Rectangle], list[Line2D]]:
        """A hatched block beyond the face of each wall and fixed end, and the faces."""
        depth = WALL * self.plan.row * self.place.factor
        blocks, faces = [], []
        for i, right in self.plan.walls():
            for row, face in enumerate(self._end(i, right)):
                corner = (face if right else face - depth, -row - 0.45)
                blocks.append(Rectangle(corner, depth, 0.9, **wall_style()))
                ax.add_patch(blocks[-1])
                faces += ax.plot([face, face], [-row - 0.45, -row + 0.45],
                                 color=self.colours.ink, linewidth=1.5)
        return blocks, faces

    def masses(self, ax: Axes) -> list[Rectangle]:
        """A block for each rigid mass."""
        width = self.plan.block * self.place.factor
        blocks = [
            Rectangle((left, -row - THICKNESS / 2), width, THICKNESS, zorder=3, **mass_style())
            for i, body in enumerate(self.system.bodies) if isinstance(body, RigidMass)
            for row, left in enumerate(self._end(i, False))
        ]
        for block in blocks:
            ax.add_patch(block)
        return blocks

    def ends(self, ax: Axes) -> list[Line2D]:
        """Dashes at absorbing ends, and arrow heads at driven ones."""
        drawn, rows = [], -np.arange(self.times.size)
        for side, end in enumerate(self.system.ends):
            places = self._end(side * (len(self.system.bodies) - 1), bool(side))
            if isinstance(end, Absorbing):
                drawn += ax.plot([places, places], [rows - 0.4, rows + 0.4], **open_style())
            elif type(end) in DRIVEN:
                drawn += ax.plot(places, rows, marker="<" if side else ">", markersize=6.0,
                                 zorder=4, **drive_style())
        return drawn

    def springs(self, ax: Axes) -> list[Line2D]:
        """Zigzags at compliant contacts."""
        return draw_springs(ax, self.plan, self.times, self.place.factor)

    def contacts(self, ax: Axes) -> list[Line2D]:
        """A thick line where bodies press."""
        drawn: list[Line2D] = []
        for history in self.plan.solution.contacts:
            if is_compliant(history) or not history.law.opens:
                continue
            x = self._end(history.index, True)
            pressing = history.force(np.maximum(self.times, 0.0)) > 0
            for row in np.flatnonzero(pressing & (self.times >= 0)).tolist():
                drawn += ax.plot([x[row], x[row]], [-row - PRESSING, -row + PRESSING],
                                 color=self.colours.ink, linewidth=2.6, zorder=4)
        return drawn

    def gauges(self, ax: Axes, records: Mapping[str, Gauge]) -> list[Line2D]:
        """Squares where strain gauges are, with their names at the first time."""
        drawn: list[Line2D] = []
        rows = -np.arange(self.times.size) - THICKNESS / 2
        for name, record in records.items():
            moved = self.plan.moved(record.body, record.x, self.times)
            places = self.plan.place(record.body, record.x, self.times, moved) * self.place.factor
            drawn += ax.plot(places, rows, linestyle="", marker="s", markersize=4.5, zorder=5,
                             color=self.colours.series[4], label=name)
            ax.annotate(name, (places[0], rows[0]), (0, -4), textcoords="offset points",
                        ha="center", va="top", fontsize=SMALL + 1, color=self.colours.ink,
                        parse_math=False)
        return drawn

    def _end(self, body: int, right: bool) -> Floats:
        """Places of an end of a body, in the unit of the picture."""
        return self.plan.end(body, right, self.times) * self.place.factor


def _thinned(profile: Profile) -> Profile:
    """A state with neighbours that are alike joined to pieces with their mean, if it has many."""
    edges, velocity, strain, segment = profile
    if velocity.size <= MANY:
        return profile
    room, starts = ALIKE * float(np.ptp(velocity)), [0]
    for j in range(1, velocity.size):
        group = velocity[starts[-1] : j + 1]
        if segment[j] != segment[starts[-1]] or np.ptp(group) > room:
            starts.append(j)
    widths = np.diff(edges)
    total = np.add.reduceat(widths, starts)
    return Profile(np.append(edges[starts], edges[-1]),
                   np.add.reduceat(velocity * widths, starts) / total,
                   np.add.reduceat(strain * widths, starts) / total, segment[starts])
