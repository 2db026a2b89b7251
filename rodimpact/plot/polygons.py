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
MIN_DARKNESS = 0.1  # least darkness of a line that is drawn, see `Polygons._fronts`
WORD_TO_NUMBER = 2.4  # least distance of a named front from a number, letter heights
WORD_TO_END = 3.0  # least distance of a word from the ends of its front, points
ON_FRONT = 0.5  # how far a word may reach over a side of its region, points
FEW_FRONTS = 16  # fronts up to which all are drawn, and named if words have room
READABLE_REGIONS = 20_000  # largest number of regions that a picture shows by default


class Fronts(NamedTuple):
    """Sides that two regions share: wave fronts, and steps of area or material."""

    sides: Ints  # [n, 2] indices of the two corners of each side
    owners: Ints  # [n, 2] indices of the two regions, the earlier one first
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
        """Find the regions from `start` to `stop`, s, by default to the end.

        The region, body, first and next corner of each corner are kept.
        """
        self.system = solution.system
        self.regions = regions_of(solution, start, stop)
        starts = self.regions.start  # first corner of each region, and the end of all
        # For each corner: its region and body, the first corner of its region, and the
        # next corner.
        self._region = np.repeat(np.arange(len(self.regions)), np.diff(starts))
        self._body = self.regions.body[self._region]
        self._first = starts[self._region]
        self._next = np.arange(1, self._body.size + 1)
        last_corners = starts[1:] - 1
        self._next[last_corners] = starts[:-1]  # the first corner follows the last

    # What is measured -----------------------------------------------------------------

    def values(self, field: str, frame: float) -> Floats:
        """Values [region] of a field, SI; of displacements the values [corner].

        Displacements and energies are those seen from a frame that moves at `frame`,
        m/s; other fields are not changed by it.
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
        """Times, s, between which the path of a rod's end at x, m, is straight.

        They are the times of all corners of regions at this end, in order; the first
        and the last time of the picture are among them.
        """
        is_at_end = (self._body == body) & (self.regions.x == x)
        return np.unique(self.regions.t[is_at_end])

    def _fronts(self) -> Fronts:
        """Sides that two regions share, also steps, with their darkness in the picture.

        The darkness of a front is the square root of its jump of velocity over the
        largest jump; that of a step of area or material is 1. The earlier one of the
        two regions beside a side is that whose corners have the earlier mean time.
        """
        regions = self.regions
        begins = self._shared_sides()  # [n, 2] corner where each region begins the side
        starts = regions.start[:-1]
        time_sums = np.add.reduceat(regions.t, starts)
        mean_time = time_sums / np.diff(regions.start)
        owners = self._region[begins]
        order = np.argsort(mean_time[owners], axis=1, kind="stable")
        owners = np.take_along_axis(owners, order, axis=1)
        first_corners = begins[:, 0]
        sides = np.column_stack((first_corners, self._next[first_corners]))

        # The velocities beside the sides are [n, 2], their differences [n, 1].
        jumps = np.abs(np.diff(regions.velocity[owners]))[:, 0]
        largest = jumps.max(initial=0.0)
        if largest == 0:
            largest = 1.0
        is_step = np.ptp(regions.x[sides], axis=1) == 0  # the side stays at one x
        darkness = np.where(is_step, 1.0, np.sqrt(jumps / largest))
        return Fronts(sides, owners, is_step, darkness)

    def _shared_sides(self) -> Ints:
        """Sides that two regions share: for each, where both regions begin it, [n, 2].

        The two numbers are the indices of the corners at which the side begins in the
        one and in the other region. The corners of all regions are in the same sense of
        rotation, so that two regions run along a shared side in opposite directions.
        """
        body = self._body.tolist()
        time = self.regions.t.tolist()
        x = self.regions.x.tolist()
        points = list(zip(body, time, x, strict=True))  # [corner]
        # Corner at which a side begins, by its two points in order
        begin_of: dict[Any, int] = {}
        for i, j in enumerate(self._next.tolist()):
            begin_of[points[i], points[j]] = i
        shared = []
        for side, i in begin_of.items():
            start, stop = side
            # The first condition counts each pair once.
            if start < stop and (stop, start) in begin_of:
                shared.append((i, begin_of[stop, start]))
        return np.array(shared, dtype=np.int64).reshape(-1, 2)  # [0, 2] if none

    # What is drawn --------------------------------------------------------------------

    def draw(
        self, plane: Plane, numbers: Floats, norm: colors.Normalize
    ) -> cm.ScalarMappable:
        """Draw the regions, coloured by `numbers`: one a region, or one a corner.

        Numbers at corners are shaded between them. The collection of regions is
        returned; plane, corners, numbers and colours are kept for `write`.
        """
        regions = self.regions
        x = plane.layout.position(
            self._body, regions.x, regions.t, regions.displacement
        )
        self._corners = plane.points(x, regions.t)
        self._numbers = numbers
        self._norm = norm
        self._plane = plane
        # whether the numbers belong to regions, not to corners
        self._is_by_region = numbers.size == len(regions)
        if not self._is_by_region:
            return self._draw_shaded()
        drawn = collections.PolyCollection(
            np.split(self._corners, regions.start[1:-1]),  # the corners of each region
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
        """Draw the numbers at the corners, linear in triangles between them.

        The triangles of a region are a fan about its first corner: one for each side
        that does not touch this corner.
        """
        corner = np.arange(self._first.size)  # side i runs from corner i to `_next[i]`
        touches_first = (corner == self._first) | (self._next == self._first)
        outer_sides = np.flatnonzero(~touches_first)
        fan = (self._first[outer_sides], outer_sides, self._next[outer_sides])
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

        The limits and the size of the Axes must be final. Fronts have words only if
        there are at most `FEW_FRONTS`. Where values belong to corners, only the lines
        are drawn, and [] is returned.
        """
        ax = self._plane.ax
        fronts = self._fronts()
        seen = self._draw_fronts(ax, fronts)
        if not self._is_by_region:
            return []
        if seen.sum() <= FEW_FRONTS:
            named = seen & ~fronts.is_step
            self._name_fronts(ax, fronts.sides[named], fronts.owners[named])
        return self._write_numbers(ax)

    def _draw_fronts(self, ax: Axes, fronts: Fronts) -> Any:
        """Draw the darkest fronts that are not crowded; return whether each is drawn.

        Lines of the total length L have the mean distance area/L, which must be
        `FRONT_SPACING` at least. The `FEW_FRONTS` darkest are never too many. Fronts of
        equal darkness are all drawn or all left out; very light ones are left out.
        """
        side_ends = _in_points(ax, self._corners[fronts.sides])  # [side, end, 2]
        lengths = np.hypot(*(side_ends[:, 1] - side_ends[:, 0]).T)
        darkest = np.argsort(-fronts.darkness, kind="stable")
        area = math.prod(size_in_points(ax))
        room = area / FRONT_SPACING  # sum of the lengths that have room, points
        crowded = np.cumsum(lengths[darkest]) > room
        crowded[:FEW_FRONTS] = False
        # Darkness of the darkest front that is left out
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
        """Write "compression" or "tension" along each front, on its later side.

        The word is "compression" if the front lowers the stress, which is positive in
        tension. It is left out if it would come near the number of the later region, or
        does not fit into this region.

        Parameters
        ----------
        sides, owners : [n, 2] arrays of int
            As in `Fronts`.
        """
        stress = self.regions.stress
        centres = _in_points(ax, self._centres(self._corners))
        corners = _in_points(ax, self._corners)
        for side, regions in zip(sides, owners, strict=True):
            first, last = side  # corners
            before, after = regions  # the earlier and the later region
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
            # The later side is above the front, or to the right of it if time runs
            # across: to the right of a front that rises is below it.
            rises = right[1] > left[1]
            is_below = self._plane.across and rises
            box = _word_box(left, right, word, is_below)
            if not self._contains(corners, after, box):
                continue
            # Direction of the front in units of the axes, from left to right
            dx, dy = np.diff(self._corners[[first, last]], axis=0)[0]
            if dx < 0:
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
        """Whether all `points` are inside a convex region or hardly outside of it.

        `corners` are those of all regions, and both are on paper, points. A point is
        inside if its inward distance from each side is -`ON_FRONT` at least. The region
        must have an area.
        """
        first = self.regions.start[region]
        end = self.regions.start[region + 1]
        outline = corners[first:end]
        sides = np.roll(outline, -1, axis=0) - outline
        lengths = np.hypot(*sides.T)
        has_length = lengths > 0  # corners that coincide have no side between them
        sides = sides[has_length]
        outline = outline[has_length]
        lengths = lengths[has_length]
        centre = outline.mean(axis=0)
        # Sign of the cross product for points on the inner side
        inward = np.sign(_cross(sides, centre - outline))
        for point in points:
            distance = inward * _cross(sides, point - outline) / lengths
            if (distance < -ON_FRONT).any():
                return False
        return True

    def _write_numbers(self, ax: Axes) -> list[Text]:
        """Write the number of each region into its centre, if there is room for it.

        If bodies move in the picture, the number has a box in the colour of its region,
        so that paths which cross it do not hide it. The texts are returned.
        """
        low, high = self._norm.inverse(np.array([0.0, 1.0])).tolist()  # colour limits
        reach = (high - low) / 2
        largest = max(-low, high)
        # Differences have three digits: the numbers have more if all are far from 0.
        digits = 3 + max(0, math.ceil(math.log10(largest / reach)))
        texts = [number_text(value, reach, digits) for value in self._numbers.tolist()]
        half_sizes = []
        for text in texts:
            # half of a width of 0.7 heights a digit, and a margin of a point
            half_width = 0.35 * SMALL * len(text) + 1.0
            half_height = 0.6 * SMALL + 1.0
            half_sizes.append((half_width, half_height))
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
        """Whether a box about the centre of each region is inside all its sides.

        With the side (sx, sy) of length s, the centre is abs(cross)/s from the side,
        and a box of half sizes (w, h) reaches (abs(sy) w + abs(sx) h)/s towards it.
        Both are compared times s.
        """
        corners = _in_points(ax, self._corners)
        sides = corners[self._next] - corners
        to_centre = _in_points(ax, centres)[self._region] - corners
        distance = np.abs(_cross(sides, to_centre))  # times s
        # [:, ::-1] pairs sy with w and sx with h
        reach = (np.abs(sides[:, ::-1]) * half_sizes[self._region]).sum(axis=1)
        starts = self.regions.start[:-1]
        return np.logical_and.reduceat(distance > reach, starts)

    def _centres(self, corners: Floats) -> Floats:
        """Centre of area of each region, [n, 2]; NaN where the area is 0.

        A region is divided into triangles with the first corner o and the two corners p
        and q of a side. Twice the area of a triangle is a = (p - o) x (q - o), and the
        centre of the region is o + sum(a ((p - o) + (q - o)))/(3 sum(a)).
        """
        origin = corners[self._first]
        starts = self.regions.start[:-1]
        to_corner = corners - origin  # p - o
        to_next = corners[self._next] - origin  # q - o
        twice_area = _cross(to_corner, to_next)[:, None]  # a, of each triangle
        sums = np.add.reduceat(twice_area, starts)
        sums[sums == 0] = np.nan
        moments = np.add.reduceat(twice_area * (to_corner + to_next), starts)
        from_origin: Floats = moments / (3 * sums)
        return origin[starts] + from_origin


def drawn_until(solution: Solution) -> float:
    """Latest of t_end, t_end/2, t_end/4, ..., s, with at most `READABLE_REGIONS`.

    It is t_end for a smooth solution, which has no regions.
    """
    if is_smooth(solution):
        return solution.t_end
    return readable_until(solution, READABLE_REGIONS)


def _word_box(start: Floats, stop: Floats, word: str, is_below: bool) -> Floats:
    """Corners [4, 2] of the box of a word along a front from `start` to `stop`, points.

    The box is at the middle of the front, above or below it, and includes margins at
    both ends of the word.
    """
    along = (stop - start) / math.hypot(*(stop - start))  # unit vector
    across = np.array([-along[1], along[0]])  # a quarter turn to the left: above
    if is_below:
        across = -across
    middle = (start + stop) / 2
    half_length = LETTER * SMALL * len(word) / 2 + WORD_TO_END
    on_front = [middle - half_length * along, middle + half_length * along]
    away = [point + SMALL * across for point in on_front]
    return np.array([*on_front, *away])


def _in_points(ax: Axes, corners: Floats) -> Floats:
    """Positions on paper, points, of corners [..., 2] in units of the axes."""
    pixels = ax.transData.transform(corners.reshape(-1, 2)).reshape(corners.shape)
    return np.asarray(pixels * (72.0 / ax.figure.dpi))


def _cross(a: Floats, b: Floats) -> Any:
    """Cross product of vectors [..., 2]: positive if b is to the left of a."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
