"""Coloured regions of a space-time diagram: exact polygons of constant state.

Between the fronts of a solution each region is a polygon with one velocity and one
strain. The thin lines between them are the fronts. A front bears a word, and a region
its value, where there is room. Solutions that change smoothly are drawn by `raster`
instead.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from matplotlib import cm, collections, colors
from matplotlib.axes import Axes
from matplotlib.text import Text

from ..methods.signals import Floats, Ints
from ..results.regions import readable_until, regions_of
from ..results.solution import Solution
from .labels import LETTER
from .panels import size_in_points
from .plane import Plane
from .sampling import is_smooth
from .scales import NEGLIGIBLE_RTOL, number_text
from .style import SMALL, colours, ink_on

FRONT_SPACING = 12.0  # least mean distance between the lines of fronts, points
MIN_DARKNESS = 0.1  # darkness of a front's line, the square root of its jump
WORD_TO_NUMBER = 2.4  # least distance of a front with a word from a number, in heights
WORD_TO_END = 3.0  # least distance of a word from the ends of its front, points
ON_FRONT = 0.5  # how far a word may reach over a side of its region, points
FEW_FRONTS = 16  # are all drawn and named, if they have room for a word
READABLE_REGIONS = 20_000


class Fronts(NamedTuple):
    """Sides that two regions share."""

    sides: Ints  # [n, 2] corners
    owners: Ints  # [n, 2] regions, the earlier one first
    is_step: Any  # [n] whether it is a step of area or material, not a front
    darkness: Floats  # [n] of its line, from 0 to 1


class Polygons:
    """The regions between the fronts of a solution, in an interval of time, s.

    Raises
    ------
    ValueError
        If the interval is empty or outside the solution, or has more than 100 000
        regions.
    """

    def __init__(self, solution: Solution, start: float, stop: float | None) -> None:
        """Find the regions, and for each corner its region, body and next corner."""
        self.system = solution.system
        self.regions = regions_of(solution, start, stop)
        starts = self.regions.start
        # For each corner: its region and body, the first corner of its region, and the
        # next corner.
        self._region = np.repeat(np.arange(len(self.regions)), np.diff(starts))
        self._body = self.regions.body[self._region]
        self._first = starts[self._region]
        # the last corner of a region is followed by its first
        self._next = np.arange(1, self._body.size + 1)
        self._next[starts[1:] - 1] = starts[:-1]

    # What is measured -----------------------------------------------------------------

    def values(self, field: str, frame: float) -> Floats:
        """Values of a field in each region; displacements at its corners instead; SI.

        Displacements and energies are those seen from a frame that moves at `frame`,
        m/s.
        """
        regions = self.regions
        if field == "displacement":
            return regions.displacement - frame * regions.t
        if field == "energy":
            return self._energy_per_length(frame)
        return np.asarray(getattr(regions, field))

    def _energy_per_length(self, frame: float) -> Floats:
        """Energy per length in each region, J/m: m' (v^2 + (c s)^2)/2.

        m' is the mass per length, v the velocity in a frame that moves at `frame`, c
        the bar speed and s the strain.
        """
        bodies: Any = self.system.bodies
        mass_per_length = np.empty(len(self.regions))
        wave_speed = np.empty(len(self.regions))
        for k in range(len(self.regions)):
            body = bodies[self.regions.body[k]]
            segment = body.segments[self.regions.segment[k]]
            mass_per_length[k] = float(segment.mass / segment.length)
            wave_speed[k] = float(segment.wave_speed)
        velocity = self.regions.velocity - frame
        squares = velocity**2 + (wave_speed * self.regions.strain) ** 2
        return np.asarray(mass_per_length * squares / 2)

    def bends(self, body: int, x: float) -> Floats:
        """Times at which the path of a rod's end at x, m, may bend, first and last too.

        They are those of the corners of regions at the end.
        """
        is_at_end = (self._body == body) & (self.regions.x == x)
        return np.unique(self.regions.t[is_at_end])

    def _fronts(self) -> Fronts:
        """Sides that two regions share, also steps, with their darkness in the picture.

        Darkness is the root of the jump of velocity over the largest jump, 1 for a step
        of area or material. The region with the earlier mean time is the earlier one.
        """
        regions = self.regions
        sides = self._shared_sides()  # [n, 2] where the side begins in its two regions
        starts = regions.start[:-1]
        time_sums = np.add.reduceat(regions.t, starts)
        mean_time = time_sums / np.diff(regions.start)
        owners = self._region[sides]
        earlier = np.argsort(mean_time[owners], axis=1, kind="stable")
        owners = np.take_along_axis(owners, earlier, axis=1)
        ends = np.column_stack((sides[:, 0], self._next[sides[:, 0]]))

        jumps = np.abs(np.diff(regions.velocity[owners]))[:, 0]
        largest = jumps.max(initial=0.0)
        if largest == 0:
            largest = 1.0
        is_step = np.ptp(regions.x[ends], axis=1) == 0  # the side stays at one x
        darkness = np.where(is_step, 1.0, np.sqrt(jumps / largest))
        return Fronts(ends, owners, is_step, darkness)

    def _shared_sides(self) -> Ints:
        """Corners [n, 2] at which the two regions beside a side begin to run along it.

        All regions are run round in one direction, so that the two run along a shared
        side in opposite directions.
        """
        body = self._body.tolist()
        time = self.regions.t.tolist()
        x = self.regions.x.tolist()
        corners = list(zip(body, time, x, strict=True))
        side_of: dict[Any, int] = {}
        for i, j in enumerate(self._next.tolist()):
            side_of[corners[i], corners[j]] = i
        shared = []
        for ends, i in side_of.items():
            start, stop = ends
            # The first condition counts each pair once.
            if start < stop and (stop, start) in side_of:
                shared.append((i, side_of[stop, start]))
        return np.array(shared, dtype=np.int64).reshape(-1, 2)

    # What is drawn --------------------------------------------------------------------

    def draw(
        self, plane: Plane, numbers: Floats, norm: colors.Normalize
    ) -> cm.ScalarMappable:
        """Draw the regions with these numbers: one each, or one for each corner.

        Plane, corners, numbers and colours are kept for `write`.
        """
        regions = self.regions
        x = plane.layout.position(
            self._body, regions.x, regions.t, regions.displacement
        )
        self._corners = plane.points(x, regions.t)
        self._numbers = numbers
        self._norm = norm
        self._plane = plane
        self._has_one_each = numbers.size == len(regions)
        if not self._has_one_each:
            return self._draw_shaded()
        drawn = collections.PolyCollection(
            np.split(self._corners, regions.start[1:-1]),
            array=numbers,
            cmap=colours().signed,
            norm=norm,
            zorder=2,
            edgecolors="face",
            linewidths=0.4,
        )
        plane.ax.add_collection(drawn)
        return drawn

    def _draw_shaded(self) -> cm.ScalarMappable:
        """Draw numbers at the corners, linear in triangles between them.

        The triangles of a region are a fan about its first corner: one for each side
        that does not touch this corner.
        """
        corner = np.arange(self._first.size)  # each begins the side to its `_next`
        touches_first = (corner == self._first) | (self._next == self._first)
        inner = np.flatnonzero(~touches_first)
        fan = (self._first[inner], inner, self._next[inner])
        return self._plane.ax.tripcolor(
            self._corners[:, 0],
            self._corners[:, 1],
            self._numbers,
            shading="gouraud",
            cmap=colours().signed,
            norm=self._norm,
            zorder=1.9,
            rasterized=True,
            triangles=np.column_stack(fan),
        )

    def write(self) -> list[Text]:
        """Draw lines of fronts, words and numbers that have room; return the numbers.

        Limits and sizes of the Axes are final by then. Values at corners have no
        numbers.
        """
        ax = self._plane.ax
        fronts = self._fronts()
        seen = self._draw_fronts(ax, fronts)
        if not self._has_one_each:
            return []
        if seen.sum() <= FEW_FRONTS:
            named = seen & ~fronts.is_step
            self._name_fronts(ax, fronts.sides[named], fronts.owners[named])
        return self._write_numbers(ax)

    def _draw_fronts(self, ax: Axes, fronts: Fronts) -> Any:
        """Draw the darkest fronts, no more than stay apart; return which were drawn.

        Lines of the total length L stand area/L apart on average.
        """
        start, stop = np.moveaxis(_in_points(ax, self._corners[fronts.sides]), 1, 0)
        lengths = np.hypot(*(stop - start).T)
        darkest = np.argsort(-fronts.darkness, kind="stable")
        # Sum of the lengths that have room, points
        room = math.prod(size_in_points(ax)) / FRONT_SPACING
        crowded = np.cumsum(lengths[darkest]) > room
        crowded[:FEW_FRONTS] = False
        too_light = fronts.darkness[darkest[crowded]].max(initial=MIN_DARKNESS)
        seen = fronts.darkness > too_light * (1 + NEGLIGIBLE_RTOL)
        if seen.any():
            lines = collections.LineCollection(
                list(self._corners[fronts.sides[seen]]),
                colors=colours().ink,
                alpha=fronts.darkness[seen],
                linewidths=0.5,
                zorder=2.2,
                label="fronts",
            )
            ax.add_collection(lines)
        return seen

    def _name_fronts(self, ax: Axes, sides: Ints, owners: Ints) -> None:
        """Write along each front, on its later side, if it compresses or stretches.

        A word is left out if it would come near the number of the later region, or does
        not fit into this region.

        Parameters
        ----------
        sides, owners : [n, 2] arrays of int
            As in `Fronts`.
        """
        stress = self.regions.stress
        centres = _in_points(ax, self._centres(self._corners))
        corners = _in_points(ax, self._corners)
        for side, regions in zip(sides, owners, strict=True):
            first, last = side
            before, after = regions
            word = "tension"
            if stress[after] < stress[before]:
                word = "compression"
            # The word is read from left to right.
            left, right = sorted(
                (corners[first], corners[last]), key=lambda point: point[0]
            )
            length = math.hypot(*(right - left))
            # distance of the number from the front: cross product over length
            to_number = abs(_cross(right - left, centres[after] - left)) / length
            if to_number <= WORD_TO_NUMBER * SMALL:
                continue
            rises = right[1] > left[1]
            is_below = self._plane.across and rises  # the later side, to the right
            box = _word_box(left, right, word, is_below)
            if not self._contains(corners, after, box):
                continue
            dx, dy = np.diff(self._corners[[first, last]], axis=0)[0]
            if dx < 0:  # turned from left to right
                dx = -dx
                dy = -dy
            x, y = self._corners[[first, last]].mean(axis=0)
            ax.text(
                x,
                y,
                word,
                rotation=math.degrees(math.atan2(dy, dx)),
                rotation_mode="anchor",
                transform_rotates_text=True,
                ha="center",
                zorder=6,
                fontsize=SMALL,
                va="top" if is_below else "bottom",
                color=ink_on(self._norm, self._numbers[after]),
            )

    def _contains(self, corners: Floats, region: int, points: Floats) -> bool:
        """Whether points lie inside a convex region or on its sides, points on paper.

        A point is inside if its distance from each side, inward, is not negative.
        """
        first = self.regions.start[region]
        end = self.regions.start[region + 1]
        outline = corners[first:end]
        sides = np.roll(outline, -1, axis=0) - outline
        lengths = np.hypot(*sides.T)
        sides = sides[lengths > 0]
        outline = outline[lengths > 0]
        lengths = lengths[lengths > 0]
        centre = outline.mean(axis=0)
        inward = np.sign(_cross(sides, centre - outline))  # sign on the inner side
        for point in points:
            distance = inward * _cross(sides, point - outline) / lengths
            if (distance < -ON_FRONT).any():
                return False
        return True

    def _write_numbers(self, ax: Axes) -> list[Text]:
        """Write the number of each region into its centre, where there is room for it.

        In the laboratory it has a box in the colour of its region, over paths that
        cross.
        """
        low, high = self._norm.inverse(np.array([0.0, 1.0])).tolist()
        reach = (high - low) / 2
        # Three digits of differences: more where all values lie far from 0.
        count = 3 + max(0, math.ceil(math.log10(max(-low, high) / reach)))
        texts = [number_text(value, reach, count) for value in self._numbers.tolist()]
        half_sizes = []
        for text in texts:
            half_sizes.append((0.35 * SMALL * len(text) + 1.0, 0.6 * SMALL + 1.0))
        centres = self._centres(self._corners)
        fits = self._has_room(ax, centres, np.array(half_sizes))

        written = []
        for i in np.flatnonzero(fits).tolist():
            box = None
            if self._plane.layout.magnification:
                background = colours().signed(self._norm(self._numbers[i]))
                box = {"edgecolor": "none", "pad": 1.0, "facecolor": background}
            x, y = centres[i]
            number = ax.text(
                x,
                y,
                texts[i],
                ha="center",
                va="center",
                zorder=6,
                fontsize=SMALL,
                color=ink_on(self._norm, self._numbers[i]),
                bbox=box,
            )
            written.append(number)
        return written

    def _has_room(self, ax: Axes, centres: Floats, half_sizes: Floats) -> Any:
        """Whether a box about the centre of each region lies inside of every side.

        With the side (sx, sy) of length s, the centre is cross/s from the side, and a
        box of half sizes (w, h) reaches (abs(sy) w + abs(sx) h)/s towards it.
        """
        corners = _in_points(ax, self._corners)
        sides = corners[self._next] - corners
        to_centre = _in_points(ax, centres)[self._region] - corners
        room = np.abs(_cross(sides, to_centre))
        needed = (np.abs(sides[:, ::-1]) * half_sizes[self._region]).sum(axis=1)
        starts = self.regions.start[:-1]
        return np.logical_and.reduceat(room > needed, starts)

    def _centres(self, corners: Floats) -> Floats:
        """Centre of area of each region, [n, 2]; NaN where the area is 0.

        A fan of triangles about the first corner o has twice the areas a = (p - o) x (q
        - o), with the corners p and q of a side; the centre is o + sum(a ((p - o) + (q
        - o)))/(3 sum(a)).
        """
        origin = corners[self._first]
        starts = self.regions.start[:-1]
        here = corners - origin
        after = corners[self._next] - origin
        turn = _cross(here, after)[:, None]
        areas = np.add.reduceat(turn, starts)
        areas[areas == 0] = np.nan
        away: Floats = np.add.reduceat(turn * (here + after), starts) / (3 * areas)
        return origin[starts] + away


def drawn_until(solution: Solution) -> float:
    """Latest of t_end, t_end/2, t_end/4, ..., s, up to which regions can be read."""
    if is_smooth(solution):
        return solution.t_end
    return readable_until(solution, READABLE_REGIONS)


def _word_box(start: Floats, stop: Floats, word: str, is_below: bool) -> Floats:
    """Corners [4, 2] of a word at the middle of a front, with its margins, points."""
    along = (stop - start) / math.hypot(*(stop - start))
    across = np.array([-along[1], along[0]])  # a quarter turn to the left: above
    if is_below:
        across = -across
    middle = (start + stop) / 2
    half = LETTER * SMALL * len(word) / 2 + WORD_TO_END
    near = [middle - half * along, middle + half * along]
    far = [point + SMALL * across for point in near]
    return np.array([*near, *far])


def _in_points(ax: Axes, corners: Floats) -> Floats:
    """Corners [..., 2] of the picture on paper, in points."""
    pixels = ax.transData.transform(corners.reshape(-1, 2)).reshape(corners.shape)
    return np.asarray(pixels * (72.0 / ax.figure.dpi))


def _cross(a: Floats, b: Floats) -> Any:
    """Cross product of vectors [..., 2]: positive if b is to the left of a."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
