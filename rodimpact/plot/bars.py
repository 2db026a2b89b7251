"""The bodies of a row at chosen instants: rods as bars, walls, masses, and marks at the ends."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib import collections, colors, patches
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from ..methods.signals import Floats
from ..model import Absorbing, Rigid, RigidMass, Rod
from ..model.profiles import extremes
from ..results.gauges import Gauge
from .borders import DRIVEN, WALL, mark
from .placing import Placing
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
ONE_WAY = (
    0.1  # how much velocity and stretch may differ across a front that has a direction
)
NARROWEST = 1e-9  # part of a rod that is drawn: fronts leave an end at no exact floating-point time
TURNS = 8  # of a spring
UP = np.concatenate([[0.0, 0.0], 0.12 * np.resize([1.0, -1.0], TURNS), [0.0, 0.0]])
ALONG = np.concatenate([[0.0], np.linspace(0.12, 0.88, TURNS + 2), [1.0]])
"""A spring from 0 to 1: a zigzag between two straight ends."""


STATE = ("half", "velocity", "strain", "stress", "speed")
PIECE = np.dtype(
    [
        *((name, int) for name in ("row", "body", "segment")),
        *((name, float) for name in ("left", "right", *STATE)),
    ]
)
"""A uniform piece of rod in a row of the picture: its ends, half thickness, state and bar speed."""


class Bars:
    """Draws the bodies at times, s, one row below the other.

    Attributes
    ----------
    pieces : array of `PIECE`
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
        rods = [
            (i, body)
            for i, body in enumerate(self.system.bodies)
            if isinstance(body, Rod)
        ]
        states = [
            (row, i, state_at(self.plan.solution, i, t))
            for row, t in enumerate(np.maximum(times, 0.0).tolist())
            for i, _ in rods
        ]
        self.largest = (
            self.largest
            or max(float(np.abs(profile.strain).max()) for *_, profile in states)
            or 1.0
        )
        widest = max(extremes(s.area)[1] for _, rod in rods for s in rod.segments)
        parts = []
        for row, i, profile in states:
            x, strain = profile.edges, profile.strain
            places = self.plan.point(i, x, times[row]) * self.place.factor
            middle = (x[:-1] + x[1:]) / 2
            segment, _ = self.plan.solution.fields.locate(i, middle)
            area, modulus, density = properties(self.plan.solution, i, middle)
            thick = THICKNESS * np.maximum(THINNEST, np.sqrt(area / widest))
            half = thick / 2 * (1 - SWELLING * strain / self.largest)
            found: Any = np.rec.fromarrays(
                np.broadcast_arrays(
                    row,
                    i,
                    segment,
                    places[:-1],
                    places[1:],
                    half,
                    profile.velocity,
                    strain,
                    modulus * strain,
                    np.sqrt(modulus / density),
                ),
                dtype=PIECE,
            )
            found = found[np.diff(x) > NARROWEST * x[-1]]
            crowd = not self.stepped and len(found) > MANY
            parts.append(
                joined(found, ALIKE * np.ptp(profile.velocity)) if crowd else found
            )
        self.pieces: Any = np.concatenate(parts).view(np.recarray)

    def fronts(self) -> list[Line2D]:
        """Triangles above the fronts that show their direction."""
        pieces, marks = self.pieces, []
        jump, stretch = (
            np.diff(pieces.velocity),
            pieces.speed[1:] * np.diff(pieces.strain),
        )
        one_way = np.isclose(abs(jump), abs(stretch), rtol=ONE_WAY, atol=0.0)
        one_way &= _follow(pieces) & (not self.stepped)
        for i in np.flatnonzero(one_way):
            marks += self.ax.plot(
                pieces.right[i],
                0.4 - pieces.row[i],
                color=self.colours.ink,
                markersize=3.5,
                marker=">" if jump[i] * stretch[i] < 0 else "<",
                zorder=4,
            )
        return marks

    def rods(
        self, numbers: Floats, norm: colors.Normalize
    ) -> collections.PolyCollection:
        """A polygon for each piece, with these numbers; outlined each where pieces are few."""
        lines: Any = (
            {"linewidths": 0.0, "antialiased": False}
            if self.stepped
            else {"linewidths": 0.6, "edgecolors": self.colours.ink}
        )
        p = self.pieces
        corners: Any = np.array(
            [
                [p.left, p.right, p.right, p.left],
                np.multiply.outer([-1, -1, 1, 1], p.half) - p.row,
            ]
        )
        bars = collections.PolyCollection(
            corners.T,
            array=numbers,
            cmap=self.colours.signed,
            norm=norm,
            zorder=2,
            rasterized=self.stepped,
            **lines,
        )
        self.ax.add_collection(bars)
        return bars

    def outlines(self) -> collections.LineCollection | None:
        """Lines round the rods where pieces are many."""
        if not self.stepped:
            return None
        pieces, lines = self.pieces, []
        starts = np.flatnonzero(np.diff(pieces.row) | np.diff(pieces.body)) + 1
        for p in map(np.rec.array, np.split(pieces, starts)):
            x, half = np.array([p.left, p.right]).T.ravel(), np.repeat(p.half, 2)
            y = np.concatenate([half, -half[::-1], half[:1]]) - p.row[0]
            lines.append(np.column_stack([np.concatenate([x, x[::-1], x[:1]]), y]))
        drawn = collections.LineCollection(
            lines, colors=self.colours.ink, linewidths=0.6, zorder=2.5
        )
        self.ax.add_collection(drawn)
        return drawn

    def walls(self) -> list[patches.Rectangle]:
        """A hatched block beyond the face of each wall and fixed end."""
        depth = WALL * self.plan.row * self.place.factor
        blocks: list[patches.Rectangle] = []
        for i, right in self.plan.walls():
            faces = self.end(i, right)
            blocks += self.ax.barh(
                self.rows,
                depth,
                2 * TALL,
                faces if right else faces - depth,
                **mark("wall"),
            )
            self._upright(faces, linewidth=1.5)
        return blocks

    def masses(self) -> list[patches.Rectangle]:
        """A block for each rigid mass."""
        width = self.plan.block * self.place.factor
        return [
            block
            for i, body in enumerate(self.system.bodies)
            if isinstance(body, RigidMass)
            for block in self.ax.barh(
                self.rows,
                width,
                THICKNESS,
                self.end(i, False),
                zorder=3,
                **mark("mass"),
            )
        ]

    def marks(self) -> None:
        """Dashes at absorbing ends, arrow heads at driven ones, springs, lines that press."""
        for side, end in enumerate(self.system.ends):
            places = self.end(side * (len(self.system.bodies) - 1), bool(side))
            if isinstance(end, Absorbing):
                self._upright(places, **mark("open"))
            elif type(end) in DRIVEN:
                self.ax.plot(
                    places,
                    self.rows,
                    marker="<" if side else ">",
                    markersize=6.0,
                    zorder=4,
                    **mark("drive"),
                )
        for _, start, stop in self.plan.springs(self.times):
            x = start + np.outer(ALONG, stop - start)
            self.ax.plot(
                x * self.place.factor,
                np.add.outer(UP, self.rows),
                zorder=3,
                color=self.colours.ink,
                linewidth=0.9,
            )
        for history in self.plan.solution.contacts:
            if isinstance(history.law, Rigid):
                presses = (history.force(np.maximum(self.times, 0.0)) > 0) & (
                    self.times >= 0
                )
                self._upright(
                    np.where(presses, self.end(history.index, True), np.nan),
                    linewidth=2.6,
                    zorder=4,
                )

    def gauges(self, records: Mapping[str, Gauge]) -> None:
        """Squares where strain gauges are, with their names at the first time."""
        rows = self.rows - THICKNESS / 2
        for name, record in records.items():
            places = (
                self.plan.point(record.body, record.x, self.times) * self.place.factor
            )
            self.ax.plot(
                places,
                rows,
                linestyle="",
                marker="s",
                markersize=4.5,
                zorder=5,
                color=self.colours.series[4],
                label=name,
            )
            self.ax.annotate(
                name,
                (places[0], rows[0]),
                (0, -4),
                textcoords="offset points",
                ha="center",
                va="top",
                fontsize=SMALL + 1,
                color=self.colours.ink,
                parse_math=False,
            )

    def end(self, body: int, right: bool) -> Floats:
        """Places of an end of a body, in the unit of the picture."""
        return self.plan.end(body, right, self.times) * self.place.factor

    def _upright(self, x: Floats, **how: Any) -> None:
        """An upright line in each row in which x is known, by default of the colour of ink."""
        rows = self.rows[np.isfinite(x)]
        self.ax.vlines(
            x[np.isfinite(x)],
            rows - TALL,
            rows + TALL,
            **{"color": self.colours.ink, **how},
        )


def joined(pieces: Any, room: Any) -> Any:
    """Neighbours in a segment whose velocities differ by `room` at most, as one with their mean."""
    follow, velocity, starts = _follow(pieces), pieces.velocity, [0]
    for i in range(1, len(pieces)):
        if not follow[i - 1] or np.ptp(velocity[starts[-1] : i + 1]) > room:
            starts.append(i)
    whole, width = pieces[starts], pieces.right - pieces.left
    whole.right = pieces.right[np.append(starts, len(pieces))[1:] - 1]
    for name in STATE:
        whole[name] = np.add.reduceat(width * pieces[name], starts) / np.add.reduceat(
            width, starts
        )
    return whole


def _follow(pieces: Any) -> NDArray[np.bool_]:
    """Whether each piece but the first is in the row and segment of the piece before it."""
    return np.asarray(~np.diff([pieces.row, pieces.body, pieces.segment]).any(axis=0))
