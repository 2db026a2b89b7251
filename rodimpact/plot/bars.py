"""The bodies of a row at chosen instants: rods as bars, walls, masses, and marks at the ends."""

from collections.abc import Mapping
from itertools import groupby, pairwise
from typing import Any, NamedTuple

import numpy as np
from matplotlib import collections, colors, patches
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..methods.signals import Floats
from ..model import Absorbing, RigidMass, Rod
from ..model.profiles import extremes
from ..results.gauges import Gauge
from .borders import DRIVEN, WALL, mark
from .placing import Placing, is_compliant
from .sampling import is_stepped, properties, state_at
from .scales import Scale
from .style import SMALL, colours

THICKNESS = 0.5  # of the thickest bar, in distances between rows
SWELLING = 0.25  # relative thickening at the largest strain
THINNEST = 0.35  # thinnest bar beside the thickest
TOLD = "thick: compressed, thin: stretched, thick line: pressing"
TALL = 0.32  # half height of walls, and of what is drawn across the end of a bar
MANY = 16  # pieces of a rod from which those alike are drawn as one
ALIKE = 0.1  # of the range of a rod's velocities: how much they differ at most
ONE_WAY = 0.1  # how much velocity and stretch may differ across a front that has a direction
NARROWEST = 1e-9  # part of a rod that is drawn: fronts leave an end at no exact floating-point time
TURNS = 8  # of a spring
UP = np.concatenate([[0.0, 0.0], 0.12 * np.resize([1.0, -1.0], TURNS), [0.0, 0.0]])
ALONG = np.concatenate([[0.0], np.linspace(0.12, 0.88, TURNS + 2), [1.0]])
"""A spring from 0 to 1: a zigzag between two straight ends."""


class Piece(NamedTuple):
    """A uniform piece of rod in a row of the picture: its ends, half thickness and state."""

    row: int
    body: int
    segment: int
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
    rows : array
        Heights of the rows in the picture.
    largest : float
        The strain at which a bar is drawn thickest.
    """

    def __init__(self, ax: Axes, plan: Placing, times: Floats, place: Scale) -> None:
        self.ax, self.plan, self.place, self.colours = ax, plan, place, colours()
        self.system = plan.solution.system
        self.stepped = is_stepped(plan.solution)
        self.largest = 0.0
        self.at(times)

    def at(self, times: Floats) -> None:
        """Draw other times, with the same thickening of the bars."""
        self.times, self.rows = times, -np.arange(float(times.size))
        rods = [(i, body) for i, body in enumerate(self.system.bodies) if isinstance(body, Rod)]
        states = [(row, i, rod, state_at(self.plan.solution, i, t))
                  for row, t in enumerate(np.maximum(times, 0.0).tolist()) for i, rod in rods]
        self.largest = self.largest or max(
            float(np.abs(profile.strain).max()) for *_, profile in states) or 1.0
        widest = max(extremes(s.area)[1] for _, rod in rods for s in rod.segments)
        self.pieces: list[Piece] = []
        for row, i, rod, profile in states:
            x, segment = profile.edges, profile.segment - profile.segment[0]
            places = self.plan.point(i, x, times[row]) * self.place.factor
            area, modulus, _ = properties(rod, x, segment)
            thick = THICKNESS * np.maximum(THINNEST, np.sqrt(area / widest))
            half = thick / 2 * (1 - SWELLING * profile.strain / self.largest)
            columns = (segment, places[:-1], places[1:], half, profile.velocity, profile.strain,
                       modulus * profile.strain)
            wide = np.diff(x) > NARROWEST * x[-1]
            found = [Piece(row, i, *each) for each in zip(*(c[wide] for c in columns), strict=True)]
            crowd = not self.stepped and len(found) > MANY
            room = ALIKE * float(np.ptp(profile.velocity))
            self.pieces += joined(found, room) if crowd else found

    def fronts(self) -> list[Line2D]:
        """Triangles above the fronts that show their direction."""
        marks = []
        for one, other in pairwise(() if self.stepped else self.pieces):
            if one[:3] == other[:3]:
                rod: Any = self.system.bodies[one.body]
                jump = other.velocity - one.velocity
                stretch = float(rod.segments[one.segment].wave_speed) * (other.strain - one.strain)
                if np.isclose(abs(jump), abs(stretch), rtol=ONE_WAY, atol=0.0):
                    marks += self.ax.plot(
                        other.left, 0.4 - other.row, marker=">" if jump * stretch < 0 else "<",
                        color=self.colours.ink, markersize=3.5, zorder=4)
        return marks

    def rods(self, numbers: Floats, norm: colors.Normalize) -> collections.PolyCollection:
        """A polygon for each piece, with these numbers; outlined each where pieces are few."""
        lines: Any = ({"linewidths": 0.0, "antialiased": False} if self.stepped
                      else {"linewidths": 0.6, "edgecolors": self.colours.ink})
        bars = collections.PolyCollection(
            [[(p.left, -p.row - p.half), (p.right, -p.row - p.half),
              (p.right, -p.row + p.half), (p.left, -p.row + p.half)] for p in self.pieces],
            array=numbers, cmap=self.colours.signed, norm=norm, zorder=2,
            rasterized=self.stepped, **lines)
        self.ax.add_collection(bars)
        return bars

    def outlines(self) -> collections.LineCollection | None:
        """Lines round the rods where pieces are many."""
        if not self.stepped:
            return None
        lines = []
        for (row, _), rod in groupby(self.pieces, lambda piece: piece[:2]):
            upper = [(x, p.half - row) for p in rod for x in (p.left, p.right)]
            lower = [(x, -2.0 * row - y) for x, y in reversed(upper)]
            lines.append([*upper, *lower, upper[0]])
        drawn = collections.LineCollection(
            lines, colors=self.colours.ink, linewidths=0.6, zorder=2.5)
        self.ax.add_collection(drawn)
        return drawn

    def walls(self) -> list[patches.Rectangle]:
        """A hatched block beyond the face of each wall and fixed end."""
        depth = WALL * self.plan.row * self.place.factor
        blocks: list[patches.Rectangle] = []
        for i, right in self.plan.walls():
            faces = self._end(i, right)
            blocks += self.ax.barh(self.rows, depth, 2 * TALL, faces if right else faces - depth,
                                   **mark("wall"))
            self._upright(faces, linewidth=1.5)
        return blocks

    def masses(self) -> list[patches.Rectangle]:
        """A block for each rigid mass."""
        width = self.plan.block * self.place.factor
        return [block for i, body in enumerate(self.system.bodies) if isinstance(body, RigidMass)
                for block in self.ax.barh(self.rows, width, THICKNESS, self._end(i, False),
                                          zorder=3, **mark("mass"))]

    def marks(self) -> None:
        """Dashes at absorbing ends, arrow heads at driven ones, springs, lines that press."""
        for side, end in enumerate(self.system.ends):
            places = self._end(side * (len(self.system.bodies) - 1), bool(side))
            if isinstance(end, Absorbing):
                self._upright(places, **mark("open"))
            elif type(end) in DRIVEN:
                self.ax.plot(places, self.rows, marker="<" if side else ">", markersize=6.0,
                             zorder=4, **mark("drive"))
        for _, start, stop in self.plan.springs(self.times):
            x = start + np.outer(ALONG, stop - start)
            self.ax.plot(x * self.place.factor, np.add.outer(UP, self.rows), zorder=3,
                         color=self.colours.ink, linewidth=0.9)
        for history in self.plan.solution.contacts:
            if history.law.opens and not is_compliant(history):
                presses = (history.force(np.maximum(self.times, 0.0)) > 0) & (self.times >= 0)
                self._upright(np.where(presses, self._end(history.index, True), np.nan),
                              linewidth=2.6, zorder=4)

    def gauges(self, records: Mapping[str, Gauge]) -> None:
        """Squares where strain gauges are, with their names at the first time."""
        rows = self.rows - THICKNESS / 2
        for name, record in records.items():
            places = self.plan.point(record.body, record.x, self.times) * self.place.factor
            self.ax.plot(places, rows, linestyle="", marker="s", markersize=4.5, zorder=5,
                         color=self.colours.series[4], label=name)
            self.ax.annotate(name, (places[0], rows[0]), (0, -4), textcoords="offset points",
                             ha="center", va="top", fontsize=SMALL + 1, color=self.colours.ink,
                             parse_math=False)

    def _end(self, body: int, right: bool) -> Floats:
        """Places of an end of a body, in the unit of the picture."""
        return self.plan.end(body, right, self.times) * self.place.factor

    def _upright(self, x: Floats, **how: Any) -> None:
        """An upright line in each row in which x is known, by default of the colour of ink."""
        rows = self.rows[np.isfinite(x)]
        self.ax.vlines(x[np.isfinite(x)], rows - TALL, rows + TALL,
                       **{"color": self.colours.ink, **how})


def joined(pieces: list[Piece], room: float) -> list[Piece]:
    """Neighbours in a segment whose velocities differ by `room` at most, as one with their mean."""
    groups: list[list[Piece]] = []
    for piece in pieces:
        group = groups[-1] if groups else []
        speeds = [p.velocity for p in (*group, piece)]
        if group and group[0][:3] == piece[:3] and max(speeds) - min(speeds) <= room:
            group.append(piece)
        else:
            groups.append([piece])
    means = [np.average([p[5:] for p in group], axis=0, weights=[p.right - p.left for p in group])
             for group in groups]
    return [Piece(*group[0][:4], group[-1].right, *mean.tolist())
            for group, mean in zip(groups, means, strict=True)]
