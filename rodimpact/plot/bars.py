"""Bodies of a row at instants: rods as bars, walls, masses, and marks at the ends.

A rod is cut into uniform pieces. `Bars.move_to` measures them at the times wanted, and
the other methods draw them, one row of the picture for each time. Snapshots draw all
rows once; a film moves one row from time to time.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from matplotlib import collections, colors, patches
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from ..methods.signals import Floats
from ..model import Absorbing, Rigid, RigidMass, Rod
from ..model.profiles import extremes
from ..results.fields import Profile
from ..results.gauges import Gauge
from .borders import (
    DRIVE_NAMES,
    WALL_DEPTH,
    drive_style,
    mass_style,
    open_end_style,
    wall_style,
)
from .layout import PictureLayout
from .sampling import is_smooth, middles, properties, rods_of, state_at
from .scales import Scale, largest_of
from .style import SMALL, colours

LEGEND = "thick: compressed, thin: stretched, thick line: pressing"
THICKNESS = 0.5  # thickness of the thickest bar, in distances between rows
SWELLING = 0.25  # relative thickening at the largest strain
MIN_THICKNESS = 0.35  # thickness of the thinnest bar, over that of the thickest
HALF_HEIGHT = 0.32  # half height of walls and marks at ends, in distances between rows
MARK_HEIGHT = 0.4  # height of the triangle at a front above the middle of a bar
MAX_PIECES = 16  # pieces of a rod up to which neighbours of like velocity stay apart
DRAWN_SPREAD = 0.1  # largest spread in a joined piece, over the velocity range of a rod
ONE_WAY_RTOL = 0.1  # relative difference of abs(dv) and abs(c d(strain)) at a front
MIN_PIECE = 1e-9  # shortest piece, over the rod's length: shorter ones are round-off
SPRING_TURNS = 8
_ZIGZAG = 0.12 * np.resize([1.0, -1.0], SPRING_TURNS)  # distances between rows
# Heights of the corners of a spring: a zigzag between two straight ends
SPRING_HEIGHT = np.concatenate([[0.0, 0.0], _ZIGZAG, [0.0, 0.0]])
SPRING_SHARES = np.concatenate(
    [[0.0], np.linspace(0.12, 0.88, SPRING_TURNS + 2), [1.0]]
)
"""Distances of the corners of a spring from its start, in lengths of the spring."""


STATE = ("half_height", "velocity", "strain", "stress", "speed")
"""Fields of `PIECE` of which a joined piece has the mean."""
PIECE = np.dtype(
    [
        ("row", int),
        ("body", int),
        ("segment", int),
        ("left", float),
        ("right", float),
        ("half_height", float),
        ("velocity", float),
        ("strain", float),
        ("stress", float),
        ("speed", float),
    ]
)
"""Uniform piece of a rod in one row of the picture.

`left` and `right` are its ends in the picture's unit, `half_height` half its thickness
in distances between rows, `speed` its bar speed, m/s.
"""


class _RodState(NamedTuple):
    """State of a rod in one row of the picture."""

    row: int
    body: int
    profile: Profile


class Bars:
    """Draws the bodies at times, s, one row below the other.

    Attributes
    ----------
    times : array
        s, one for each row.
    pieces : array of `PIECE`
        Pieces of all rods, row by row.
    row_heights : array
        Heights of the rows in the picture; row k of the pieces is at -k.
    largest_strain : float
        The strain at which a bar is drawn thickest.
    """

    def __init__(
        self, ax: Axes, layout: PictureLayout, times: Floats, x: Scale
    ) -> None:
        """Measure the bodies at the times, without drawing; `x` scales positions."""
        self.ax = ax
        self.layout = layout
        self.solution = layout.solution
        self.system = layout.solution.system
        self.x_scale = x
        # A smooth solution has no fronts; its rods are cut into many equal pieces.
        self.is_smooth = is_smooth(layout.solution)
        self.largest_strain: float | None = None  # until bodies are measured
        self.move_to(times)

    # What is measured -----------------------------------------------------------------

    def move_to(self, times: Floats) -> None:
        """Measure the bodies at other times: set `times`, `row_heights` and `pieces`.

        The first call sets `largest_strain` too; later calls use the same value, so
        that equal strains are drawn equally thick at all times. If fronts divide a rod
        into more than `MAX_PIECES` pieces, neighbours of nearly equal velocity are
        joined.
        """
        self.times = times
        self.row_heights = -np.arange(float(times.size))
        # Before 0, where a film begins, rods have the state that they have at 0.
        times_of_state = np.maximum(times, 0.0).tolist()
        states: list[_RodState] = []
        for row, t in enumerate(times_of_state):
            for i in rods_of(self.system):
                profile = state_at(self.solution, i, t)
                states.append(_RodState(row, i, profile))
        if self.largest_strain is None:
            self.largest_strain = _largest_strain([state.profile for state in states])

        parts = []
        for row, i, profile in states:
            pieces = self._pieces_of(row, i, profile)
            if len(pieces) > MAX_PIECES and not self.is_smooth:
                spread = DRAWN_SPREAD * float(np.ptp(profile.velocity))
                pieces = merged(pieces, spread)
            parts.append(pieces)
        self.pieces: Any = np.concatenate(parts).view(np.recarray)

    def _pieces_of(self, row: int, body: int, profile: Profile) -> Any:
        """Records `PIECE` of a rod in a row of the picture, one for each of its pieces.

        Pieces too short to be seen are left out. The ends of a piece are in the
        picture's unit. Its height grows with the root of its area and with compression;
        very thin rods have a least height.
        """
        edges = profile.edges
        x = middles(edges)
        ends = self.layout.point(body, edges, self.times[row]) * self.x_scale.factor
        segment, _ = self.solution.fields.locate(body, x)
        area, modulus, density = properties(self.solution, body, x)
        # The diameter of a round rod is proportional to the square root of its area.
        relative_thickness = np.sqrt(area / self._widest_area())
        relative_thickness = np.maximum(MIN_THICKNESS, relative_thickness)
        assert self.largest_strain is not None  # `move_to` has set it
        # Compression is negative strain: a compressed piece is thicker.
        swelling = 1 - SWELLING * profile.strain / self.largest_strain
        pieces: Any = np.recarray(x.size, PIECE)
        pieces.row = row
        pieces.body = body
        pieces.segment = segment
        pieces.left = ends[:-1]
        pieces.right = ends[1:]
        pieces.half_height = THICKNESS * relative_thickness / 2 * swelling
        pieces.velocity = profile.velocity
        pieces.strain = profile.strain
        pieces.stress = modulus * profile.strain
        pieces.speed = np.sqrt(modulus / density)
        length = edges[-1]
        return pieces[np.diff(edges) > MIN_PIECE * length]

    def _widest_area(self) -> float:
        """Largest cross-sectional area of the rods, m^2.

        For a tapered segment it is the area at its widest point.
        """
        largest = 0.0
        for body in self.system.bodies:
            if isinstance(body, Rod):
                for segment in body.segments:
                    _, largest_of_segment = extremes(segment.area)
                    largest = max(largest, largest_of_segment)
        return largest

    def end(self, body: int, is_right: bool) -> Floats:
        """Positions [row] of an end of a body at the times, in the picture's unit."""
        X = self.layout.end(body, is_right, self.times)
        return X * self.x_scale.factor

    # What is drawn --------------------------------------------------------------------

    def draw_rods(
        self, numbers: Floats, norm: colors.Normalize
    ) -> collections.PolyCollection:
        """Draw a rectangle for each piece, coloured by its number in `numbers`.

        Pieces between fronts have outlines; the many pieces of a smooth solution have
        none, see `draw_outlines`. The rectangles are returned as one collection.
        """
        outline: dict[str, Any] = {"linewidths": 0.6, "edgecolors": colours().ink}
        if self.is_smooth:
            # Without antialiasing there are no pale gaps between the pieces.
            outline = {"linewidths": 0.0, "antialiased": False}
        pieces = self.pieces
        # Corners [4, piece] round each piece from its lower left one; row k is at -k.
        x = np.array([pieces.left, pieces.right, pieces.right, pieces.left])
        y = np.multiply.outer([-1, -1, 1, 1], pieces.half_height) - pieces.row
        corners: Any = np.array([x, y])  # [2, 4, piece]; matplotlib takes [piece, 4, 2]
        bars = collections.PolyCollection(
            corners.T,
            array=numbers,
            cmap=colours().signed,
            norm=norm,
            zorder=2,
            rasterized=self.is_smooth,
            **outline,
        )
        self.ax.add_collection(bars)
        return bars

    def draw_fronts(self) -> list[Line2D]:
        """Draw a triangle above each front, which points in its direction.

        Across a front that runs to the right with bar speed c, the jumps of velocity
        and strain are dv = -c d(strain); across one to the left, dv = c d(strain). A
        border of two pieces with neither is no front. A smooth solution has no fronts:
        [] is returned.
        """
        if self.is_smooth:
            return []
        pieces = self.pieces
        # Jumps from each piece to the next, dv and c d(strain), m/s
        velocity_jump = np.diff(pieces.velocity)
        strain_jump = pieces.speed[1:] * np.diff(pieces.strain)
        is_equal = np.isclose(
            abs(velocity_jump), abs(strain_jump), rtol=ONE_WAY_RTOL, atol=0.0
        )
        is_front = is_equal & (velocity_jump != 0)
        triangles: list[Line2D] = []
        # Only jumps inside one segment count, not those between rods or rows.
        for i in np.flatnonzero(is_front & _continues_segment(pieces)):
            marker = "<"
            if velocity_jump[i] * strain_jump[i] < 0:  # opposite signs: to the right
                marker = ">"
            triangles += self.ax.plot(
                pieces.right[i],
                MARK_HEIGHT - pieces.row[i],  # row k is at -k
                color=colours().ink,
                markersize=3.5,
                marker=marker,
                zorder=4,
            )
        return triangles

    def draw_outlines(self) -> collections.LineCollection | None:
        """Draw a line round each rod of a smooth solution, whose pieces have no lines.

        If the solution has fronts, nothing is drawn, and None is returned.
        """
        if not self.is_smooth:
            return None
        pieces = self.pieces
        # A rod ends where the next piece is in another row or of another body.
        is_other_rod = np.diff(pieces.row) | np.diff(pieces.body)
        starts = np.flatnonzero(is_other_rod) + 1  # first pieces of all rods but one
        outlines = []
        for part in np.split(pieces, starts):
            rod = part.view(np.recarray)
            # left and right end of each piece in turn, and the height at both
            x = np.array([rod.left, rod.right]).T.ravel()
            y = np.repeat(rod.half_height, 2)
            # Along the upper side from left to right, back along the lower side, and
            # once more to the first corner
            around_x = np.concatenate([x, x[::-1], x[:1]])
            around_y = np.concatenate([y, -y[::-1], y[:1]])
            around_y = around_y - rod.row[0]  # row k is at -k
            outlines.append(np.column_stack([around_x, around_y]))
        lines = collections.LineCollection(
            outlines, colors=colours().ink, linewidths=0.6, zorder=2.5
        )
        self.ax.add_collection(lines)
        return lines

    def draw_walls(self) -> list[patches.Rectangle]:
        """Draw a hatched block beyond the face of each wall and fixed end, in each row.

        The face is an upright line. The blocks are returned.
        """
        depth = WALL_DEPTH * self.layout.row_length * self.x_scale.factor
        blocks: list[patches.Rectangle] = []
        for body, is_right in self.layout.walls():
            faces = self.end(body, is_right)
            left = faces  # a wall at the right end of the row begins at its face
            if not is_right:
                left = faces - depth
            blocks += self.ax.barh(
                self.row_heights,
                width=depth,
                height=2 * HALF_HEIGHT,
                left=left,
                **wall_style(),
            )
            self._draw_upright(faces, linewidth=1.5)
        return blocks

    def draw_masses(self) -> list[patches.Rectangle]:
        """Draw a block for each rigid mass in each row, and return the blocks.

        A block is as wide as `mass_width` of the layout, and as high as a thick rod.
        """
        # Widths and positions in the picture's unit
        width = self.layout.mass_width * self.x_scale.factor
        blocks: list[patches.Rectangle] = []
        for i, body in enumerate(self.system.bodies):
            if isinstance(body, RigidMass):
                left = self.end(i, is_right=False)
                blocks += self.ax.barh(
                    self.row_heights,
                    width=width,
                    height=THICKNESS,
                    left=left,
                    zorder=3,
                    **mass_style(),
                )
        return blocks

    def draw_marks(self) -> None:
        """Draw absorbing and driven ends, springs, and lines at contacts that press.

        Only rigid contacts have such a line, in the rows in which their force is
        positive.
        """
        self._mark_ends()
        for _, start, stop in self.layout.springs(self.times):
            # Corners [corner, row] of the spring, m; matplotlib draws a line a column.
            x = start + np.outer(SPRING_SHARES, stop - start)
            self.ax.plot(
                x * self.x_scale.factor,
                np.add.outer(SPRING_HEIGHT, self.row_heights),
                zorder=3,
                color=colours().ink,
                linewidth=0.9,
            )
        for contact in self.solution.contacts:
            if isinstance(contact.law, Rigid):
                # A film has times before 0, at which no contact presses.
                force = contact.force(np.maximum(self.times, 0.0))
                presses = (force > 0) & (self.times >= 0)
                faces = self.end(contact.index, is_right=True)
                self._draw_upright(
                    np.where(presses, faces, np.nan), linewidth=2.6, zorder=4
                )

    def _mark_ends(self) -> None:
        """Draw a dashed line at each absorbing end, an arrow head at each driven end.

        The arrow heads point into the row. Other ends have no mark here.
        """
        arrows = (">", "<")  # at the left and at the right end
        for arrow, outer, end in zip(
            arrows, self.layout.outer_ends(), self.system.ends, strict=True
        ):
            positions = self.end(outer.body, outer.is_right)  # [row]
            if isinstance(end, Absorbing):
                self._draw_upright(positions, **open_end_style())
            elif type(end) in DRIVE_NAMES:
                self.ax.plot(
                    positions,
                    self.row_heights,
                    marker=arrow,
                    markersize=6.0,
                    zorder=4,
                    **drive_style(),
                )

    def draw_gauges(self, gauges: Mapping[str, Gauge]) -> None:
        """Draw a square at each strain gauge in each row; write its name in the first.

        The squares are on the lower side of the bars.
        """
        y = self.row_heights - THICKNESS / 2
        for name, gauge in gauges.items():
            positions = self.layout.point(gauge.body, gauge.x, self.times)  # [row], m
            x = positions * self.x_scale.factor  # in the unit of the axis
            self.ax.plot(
                x,
                y,
                linestyle="",
                marker="s",
                markersize=4.5,
                zorder=5,
                color=colours().series[4],
                label=name,
            )
            self.ax.annotate(
                name,
                xy=(x[0], y[0]),
                xytext=(0, -4),
                textcoords="offset points",
                ha="center",
                va="top",
                fontsize=SMALL + 1,
                color=colours().ink,
                parse_math=False,
            )

    def _draw_upright(self, x: Floats, **style: Any) -> None:
        """Draw an upright line at x [row] in each row; none in rows in which x is NaN.

        `style` are matplotlib's settings of the lines; the default colour is ink.
        """
        style.setdefault("color", colours().ink)
        is_finite = np.isfinite(x)
        y = self.row_heights[is_finite]
        self.ax.vlines(x[is_finite], y - HALF_HEIGHT, y + HALF_HEIGHT, **style)


def _largest_strain(profiles: list[Profile]) -> float:
    """Largest absolute strain of profiles; 1, by which one can divide, if all are 0."""
    largest = 0.0
    for profile in profiles:
        largest = max(largest, largest_of(profile.strain))
    if largest == 0:
        return 1.0
    return largest


def merged(pieces: Any, spread: float) -> Any:
    """New pieces: runs of neighbours of nearly equal velocity are joined into one.

    The velocities in a run differ by `spread` at most, and all its pieces are in one
    segment and one row. A joined piece has the mean state of its parts, weighted by
    their widths. `pieces` is not changed.
    """
    # continues[i - 1] says that piece i is in the same segment as piece i - 1
    continues = _continues_segment(pieces)
    velocity = pieces.velocity
    starts = [0]  # index of the first part of each joined piece
    for i in range(1, len(pieces)):
        spread_with_i = np.ptp(velocity[starts[-1] : i + 1])
        if not continues[i - 1] or spread_with_i > spread:
            starts.append(i)
    # The last part of a joined piece is just before the first part of the next.
    last = np.append(starts, len(pieces))[1:] - 1
    width = pieces.right - pieces.left
    total_width = np.add.reduceat(width, starts)
    joined = pieces[starts]  # a copy of the first parts
    joined.right = pieces.right[last]
    for name in STATE:
        sums = np.add.reduceat(width * pieces[name], starts)
        joined[name] = sums / total_width
    return joined


def _continues_segment(pieces: Any) -> NDArray[np.bool_]:
    """Whether each piece is in the same row, body and segment as the piece before it.

    The first piece has none before it: entry i - 1 is that of piece i.
    """
    owner = np.array([pieces.row, pieces.body, pieces.segment])
    differs = np.diff(owner).any(axis=0)
    return np.asarray(~differs)
