"""Coloured regions of a space-time diagram: exact polygons of constant state, with values.

A solution that changes smoothly has flat cells instead.
"""

from __future__ import annotations

import math
from itertools import compress
from typing import Any

import numpy as np
from matplotlib import collections, colors
from matplotlib.axes import Axes
from matplotlib.text import Text

from ..methods.signals import Floats, Ints
from ..model import Rod
from ..model.frozen import refusal
from ..results.regions import readable_until, regions_of
from ..results.solution import Solution
from .placing import Placing
from .plane import Plane
from .sampling import averaged, is_stepped, mean_areas, pieces
from .scales import ROUND_OFF, digits
from .style import SMALL, colours, extent, ink_on

SPARSE = 12.0  # least mean distance between the lines of fronts, points
FAINTEST = 0.1  # least darkness of a line, which is the square root of the jump
ALONG = 0.65  # length of a front that bears a word, in heights of its letters for each letter
CLEAR = 2.4  # least distance of a front with a word from the number in its region, in heights
NAMED = 16  # fronts, at most, in a picture that says what they are
REGIONS = 20_000  # more cannot be read
ROWS = 400  # cells one above the other


class Polygons:
    """The regions between the fronts of a solution, in an interval of time, s.

    Raises
    ------
    ValueError
        If the interval is empty or outside the solution, or has more than 100 000 regions.
    """

    def __init__(self, solution: Solution, start: float, stop: float | None) -> None:
        self.system, self.regions = solution.system, regions_of(solution, start, stop)
        self._body = self.regions.body_of_vertices()

    def values(self, field: str, frame: float) -> Floats:
        """Values of a field in each region; displacements, in a frame, at its corners; SI."""
        r = self.regions
        if field == "displacement":
            return r.displacement - frame * r.t
        if field == "energy":
            rods = [getattr(body, "segments", ()) for body in self.system.bodies]
            mass, c = np.array([(float(part.mass / part.length), float(part.wave_speed))
                                for i, j in zip(r.body.tolist(), r.segment.tolist(), strict=True)
                                for part in [rods[i][j]]]).T
            return np.asarray(mass * ((r.velocity - frame) ** 2 + (c * r.strain) ** 2) / 2)
        return np.asarray(getattr(r, field))

    def bends(self, body: int, x: float) -> Floats:
        """Times at which the path of a rod's end at x, m, may bend, with first and last."""
        return np.unique(self.regions.t[(self._body == body) & (self.regions.x == x)])

    def draw(
        self, ax: Axes, plan: Placing, plane: Plane, numbers: Floats, norm: colors.Normalize
    ) -> collections.PolyCollection | collections.TriMesh:
        """Draw the regions with these numbers: one each, or one for each corner."""
        r, places = self.regions, np.empty(self.regions.x.shape)
        for i in np.unique(self._body):
            here = self._body == i
            places[here] = plan.place(int(i), r.x[here], r.t[here], r.displacement[here])
        corners, self._across = plane.points(places, r.t), plane.across
        self._corners, self._norm, self._moving = corners, norm, plan.magnification > 0
        if numbers.size == len(r):
            polygons = collections.PolyCollection(
                np.split(corners, r.start[1:-1]), array=numbers, cmap=colours().signed, norm=norm,
                zorder=2, edgecolors="face", linewidths=0.4)
            ax.add_collection(polygons)
            self._drawn: collections.PolyCollection | collections.TriMesh = polygons
            return polygons
        self._drawn = ax.tripcolor(
            corners[:, 0], corners[:, 1], numbers, triangles=_fans(r.start), shading="gouraud",
            cmap=colours().signed, norm=norm, zorder=1.9, rasterized=True)
        return self._drawn

    def finish(self, ax: Axes) -> list[Text]:
        """Once limits are set: lines of fronts, and words and numbers where there is room."""
        sides, owners = self._fronts()
        jumps = np.abs(np.diff(self.regions.velocity[owners]))[:, 0]
        steps = np.ptp(self.regions.x[sides], axis=1) == 0  # of area or material
        strength = np.where(steps, 1.0, np.sqrt(jumps / (jumps.max(initial=0.0) or 1.0)))
        lengths = np.hypot(*np.diff(_points(ax, self._corners[sides]), axis=1)[:, 0].T)
        strongest = np.argsort(-strength, kind="stable")
        crowded = np.cumsum(lengths[strongest]) > math.prod(extent(ax)) / SPARSE
        seen = strength > strength[strongest[crowded]].max(initial=FAINTEST) * (1 + ROUND_OFF)
        if seen.any():
            ax.add_collection(collections.LineCollection(
                list(self._corners[sides[seen]]), colors=colours().ink, alpha=strength[seen],
                linewidths=0.5, zorder=2.2, label="fronts"))
        if np.asarray(self._drawn.get_array()).size != len(self.regions):
            return []
        polygons = np.split(self._corners, self.regions.start[1:-1])
        if seen.sum() <= NAMED:
            self._name(ax, sides[seen & ~steps], owners[seen & ~steps], polygons)
        corners, first = _points(ax, self._corners), self.regions.start[:-1]
        size = np.maximum.reduceat(corners, first) - np.minimum.reduceat(corners, first)
        roomy = np.asarray((size > SMALL).all(axis=1))
        numbers = np.asarray(self._drawn.get_array())
        return _labels(ax, list(compress(polygons, roomy)), numbers[roomy], self._norm,
                       self._moving)

    def _fronts(self) -> tuple[Ints, Ints]:
        """[n, 2] ends of the sides that two regions share, and these regions, the earlier first."""
        r, after = self.regions, np.arange(1, self.regions.x.size + 1)
        after[r.start[1:] - 1] = r.start[:-1]
        places = np.column_stack((self._body, r.t, r.x))
        corner = np.unique(places, axis=0, return_inverse=True)[1]  # a shared one has one number
        ends = np.sort(np.column_stack((corner, corner[after])), axis=1)
        order = np.lexsort(ends.T)
        first = np.flatnonzero((np.diff(ends[order], axis=0) == 0).all(axis=1))
        sides = np.sort(np.column_stack((order[first], order[first + 1])), axis=1)
        sides = sides[sides[:, 0].argsort()]  # in the order of the regions
        middle = np.add.reduceat(r.t, r.start[:-1]) / np.diff(r.start)
        owners = np.repeat(np.arange(len(r)), np.diff(r.start))[sides]
        earlier = np.argsort(middle[owners], axis=1, kind="stable")
        return (np.column_stack((sides[:, 0], after[sides[:, 0]])),
                np.take_along_axis(owners, earlier, axis=1))

    def _name(self, ax: Axes, sides: Ints, owners: Ints, polygons: list[Floats]) -> None:
        """Write along each front, on its later side, whether it compresses or stretches the rod."""
        stress, numbers = self.regions.stress, np.asarray(self._drawn.get_array())
        for side, (before, after) in zip(self._corners[sides], owners, strict=True):
            word = "compression" if stress[after] < stress[before] else "tension"
            (along, up), (x, y) = np.diff(_points(ax, side), axis=0)[0], side.mean(axis=0)
            length = math.hypot(along, up)
            away = _points(ax, _centre(polygons[after])) - _points(ax, side[0])
            clear = abs(along * away[1] - up * away[0]) / length  # of the number in the region
            if length < ALONG * SMALL * len(word) or clear < CLEAR * SMALL:
                continue
            dx, dy = np.diff(side[side[:, 0].argsort()], axis=0)[0]
            ax.text(x, y, word, rotation=math.degrees(math.atan2(dy, dx)), rotation_mode="anchor",
                    transform_rotates_text=True, ha="center", zorder=6, fontsize=SMALL,
                    va="top" if self._across and dy > 0 else "bottom",
                    color=ink_on(self._norm, float(numbers[after])))


class Raster:
    """Averages over cells of a solution, in an interval of time, s.

    Raises
    ------
    ValueError
        If the interval is empty or outside the solution.
    """

    def __init__(self, solution: Solution, start: float, stop: float | None) -> None:
        stop = solution.t_end if stop is None else stop
        ticks = int(np.diff(solution.fields.to_ticks([start, stop]))[0])
        if ticks <= 0:
            raise refusal("stop", f"must be later than start = {start!r} s, got {stop!r}")
        self.solution = solution
        self.times = np.linspace(start, stop, min(ROWS, ticks) + 1)
        self._rods = [i for i, b in enumerate(solution.system.bodies) if isinstance(b, Rod)]

    def values(self, field: str, frame: float) -> Floats:
        """Values of a field in each cell [times, places], SI; nan between rods.

        Displacements, in a frame, are those in the middle; the energy is that of the mean motion.
        """
        between = np.full((1, self.times.size - 1), np.nan)
        columns = [part for i in self._rods for part in (self._of_rod(i, field, frame), between)]
        return np.concatenate(columns[:-1]).T

    def _of_rod(self, body: int, field: str, frame: float) -> Floats:
        """Values [places, times] in a rod."""
        edges, segment = pieces(self.solution, body)
        if field == "displacement":
            middle, t = (edges[:-1] + edges[1:]) / 2, (self.times[:-1] + self.times[1:]) / 2
            return self.solution.displacement(body, middle[:, None], t) - frame * t
        velocity, strain = averaged(self.solution, body, self.times)
        rod: Any = self.solution.system.bodies[body]
        which = segment - segment[0]
        materials = [rod.segments[i].material for i in which.tolist()]
        modulus = np.array([[float(m.youngs_modulus)] for m in materials])
        density = np.array([[float(m.density)] for m in materials])
        area, stress = mean_areas(rod, edges, which)[:, None], modulus * strain
        energy = area * (density * (velocity - frame) ** 2 + stress * strain) / 2
        values: dict[str, Floats] = {
            "velocity": velocity, "strain": strain, "stress": stress, "energy": energy}
        return values[field]

    def bends(self, body: int, x: float) -> Floats:  # noqa: ARG002  (as in `Polygons`)
        """Times between which the path of a rod's end is drawn straight."""
        return self.times

    def draw(
        self, ax: Axes, plan: Placing, plane: Plane, numbers: Floats, norm: colors.Normalize
    ) -> collections.QuadMesh:
        """Draw the cells with these numbers, as pixels in vector files too."""
        when = self.times[:, None]
        across = np.concatenate([plan.point(body, pieces(self.solution, body)[0], when)
                                 for body in self._rods], axis=1)
        return ax.pcolormesh(
            *np.moveaxis(plane.points(across, when), -1, 0), np.ma.masked_invalid(numbers),
            cmap=colours().signed, norm=norm, zorder=2, shading="flat", rasterized=True,
            antialiased=False, edgecolors="none", linewidth=0)

    def finish(self, ax: Axes) -> list[Text]:  # noqa: ARG002  (as in `Polygons`)
        """Cells bear no numbers."""
        return []


def drawn_until(solution: Solution) -> float:
    """Latest of the times t_end, t_end/2, t_end/4, ..., s, up to which the regions can be read."""
    return solution.t_end if is_stepped(solution) else readable_until(solution, REGIONS)


def _fans(start: Ints) -> Ints:
    """[n, 3] corners of triangles that polygons, start[i] to start[i + 1], are made of."""
    counts = np.diff(start) - 2
    first = np.repeat(start[:-1], counts)
    turn = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    second = first + 1 + turn
    return np.column_stack((first, second, second + 1))


def _labels(
    ax: Axes, polygons: list[Floats], values: Floats, norm: colors.Normalize, boxed: bool
) -> list[Text]:
    """Write each value where its polygon has room for it; boxed, over paths that cross it."""
    low, high = norm.inverse(np.array([0.0, 1.0])).tolist()
    reach = (high - low) / 2
    count = 3 + max(0, math.ceil(math.log10(max(-low, high) / reach)))
    written = []
    for polygon, value in zip(polygons, values, strict=True):
        text, corners = digits(value, reach, count), _points(ax, polygon)
        across, up = 0.35 * SMALL * len(text) + 1.0, 0.6 * SMALL + 1.0  # half the text and more
        side, away = np.roll(corners, -1, axis=0) - corners, _centre(corners) - corners
        room = np.abs(side[:, 0] * away[:, 1] - side[:, 1] * away[:, 0])
        if (room > np.abs(side[:, 1]) * across + np.abs(side[:, 0]) * up).all():
            x, y = _centre(polygon)
            ground = {"facecolor": colours().signed(norm(value)), "edgecolor": "none", "pad": 1.0}
            written.append(ax.text(x, y, text, ha="center", va="center", zorder=6, fontsize=SMALL,
                                   color=ink_on(norm, value), bbox=ground if boxed else None))
    return written


def _points(ax: Axes, corners: Floats) -> Floats:
    """Corners in printer's points."""
    pixels = ax.transData.transform(corners.reshape(-1, 2)).reshape(corners.shape)
    return np.asarray(pixels * (72.0 / ax.figure.dpi))


def _centre(corners: Floats) -> Floats:
    """Centre of area of a convex polygon, [n, 2]."""
    first, a, b = corners[0], corners[1:-1] - corners[0], corners[2:] - corners[0]
    areas = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.asarray(first + (areas[:, None] * (a + b)).sum(axis=0) / (3 * areas.sum()))
