"""Exact polygons of constant state in space and time, with their values written into them."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection, TriMesh
from matplotlib.colors import Normalize
from matplotlib.text import Text

from ..methods.signals import Floats, Ints
from ..results.contacts import ContactHistory
from ..results.regions import readable_until, regions_of
from ..results.solution import Solution
from .placing import Placing
from .plane import Plane
from .sampling import energy_density, is_stepped
from .scales import ROUND_OFF, digits
from .style import SMALL, colours, ink_on

CROWDED = 3.0  # typical thickness of a region, points, below which lines would hide the colours
SPARSE = 12.0  # distance between fronts where they are a crowd, points
SEEN = 0.05  # of the range of values: smaller jumps have no line in a crowd
REGIONS = 20_000  # more cannot be read


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
            return energy_density(self.system, r.body, r.segment, r.velocity - frame, r.strain)
        return np.asarray(getattr(r, field))

    def bends(self, body: int, x: float) -> Floats:
        """Times at which the path of a rod's end at x, m, may bend, with first and last."""
        return np.unique(self.regions.t[(self._body == body) & (self.regions.x == x)])

    def cuts(self, history: ContactHistory) -> Floats:
        """Times between which a contact presses, touches or is open."""
        return history.breakpoints()[0]

    def pressing(self, history: ContactHistory, times: Floats) -> tuple[Floats, Floats]:
        """Force and gap between times."""
        between = (times[:-1] + times[1:]) / 2
        return history.force(between), history.gap(between)

    def draw(
        self, ax: Axes, plan: Placing, plane: Plane, numbers: Floats, norm: Normalize
    ) -> PolyCollection | TriMesh:
        """Draw the regions with these numbers: one each, or one for each corner."""
        r, places = self.regions, np.empty(self.regions.x.shape)
        for i in np.unique(self._body):
            here = self._body == i
            places[here] = plan.place(int(i), r.x[here], r.t[here], r.displacement[here])
        corners = plane.points(places, r.t)
        self._polygons = np.split(corners, r.start[1:-1])
        self._norm = norm
        self._drawn = PolyCollection(self._polygons, cmap=colours().signed, norm=norm, zorder=2,
                                     edgecolors=colours().ink, linewidths=0.35)
        ax.add_collection(self._drawn)
        if numbers.size == len(r):
            self._drawn.set_array(numbers)
            return self._drawn
        self._drawn.set_facecolor("none")
        return ax.tripcolor(
            corners[:, 0], corners[:, 1], numbers, triangles=_fans(r.start), shading="gouraud",
            cmap=colours().signed, norm=norm, zorder=1.9, rasterized=True)

    def finish(self) -> list[Text]:
        """Once limits are set: write each number where it has room; no lines in a crowd."""
        ax, numbers = self._drawn.axes, self._drawn.get_array()
        assert isinstance(ax, Axes)
        if _thickness(ax, self._polygons) < CROWDED:
            self._drawn.set(edgecolor="none" if numbers is None else "face", linewidth=0.4)
            if numbers is not None:
                ax.add_collection(LineCollection(
                    self._strongest(np.asarray(numbers)), colors=colours().ink, linewidths=0.35,
                    zorder=2.2))
            return []
        return [] if numbers is None else _labels(ax, self._polygons, numbers, self._norm)

    def _strongest(self, numbers: Floats) -> list[Floats]:
        """The fronts across which numbers jump most, as many as leave `SPARSE` points between."""
        r, after = self.regions, np.arange(1, self.regions.x.size + 1)
        after[r.start[1:] - 1] = r.start[:-1]
        here = np.column_stack((self._body, r.x, r.t))
        ends = np.stack((here, here[after]), axis=1)
        order = np.lexsort((ends[..., 1], ends[..., 2]), axis=1)
        keys = np.take_along_axis(ends, order[..., None], axis=1).reshape(-1, 6)
        by_key = np.lexsort(keys.T)
        same = (keys[by_key[1:]] == keys[by_key[:-1]]).all(axis=1)
        first, second = by_key[:-1][same], by_key[1:][same]
        owner = np.repeat(np.arange(len(r)), np.diff(r.start))
        jump = np.abs(numbers[owner[first]] - numbers[owner[second]])
        corners = np.concatenate(self._polygons)
        ax = self._drawn.axes
        assert isinstance(ax, Axes)
        lengths = np.hypot(*(_points(ax, corners[first]) - _points(ax, corners[after[first]])).T)
        room = math.prod(ax.get_window_extent().size) * (72 / ax.figure.dpi) ** 2 / SPARSE
        strongest = np.argsort(-jump, kind="stable")
        fits = np.cumsum(lengths[strongest]) < room
        least = jump[strongest[~fits]].max(initial=SEEN * float(np.ptp(numbers)))
        kept = first[jump > least * (1 + ROUND_OFF)]
        return list(np.stack((corners[kept], corners[after[kept]]), axis=1))


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


def _labels(ax: Axes, polygons: list[Floats], values: Floats, norm: Normalize) -> list[Text]:
    """Write each value where its polygon has room for it."""
    reach = float(np.ptp(norm.inverse(np.array([0.0, 1.0])))) / 2
    count = 3 + max(0, math.ceil(math.log10(float(np.abs(values).max()) / reach or 1.0)))
    written = []
    for polygon, value in zip(polygons, values, strict=True):
        text = digits(value, reach, count)
        corners = _points(ax, polygon)
        half = np.array([0.35 * SMALL * len(text), 0.6 * SMALL]) + 1.0
        if np.any(np.ptp(corners, axis=0) < 2 * half):
            continue
        box = _centre(corners) + np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
        if _inside(box, corners):
            x, y = _centre(polygon)
            ground = {"facecolor": colours().signed(norm(value)), "edgecolor": "none", "pad": 1.0}
            written.append(ax.text(x, y, text, ha="center", va="center", zorder=6, fontsize=SMALL,
                                   color=ink_on(norm, value), bbox=ground))
    return written


def _points(ax: Axes, corners: Floats) -> Floats:
    """Corners in printer's points."""
    return np.asarray(ax.transData.transform(corners) * (72.0 / ax.figure.dpi))


def _thickness(ax: Axes, polygons: list[Floats]) -> float:
    """Typical thickness of polygons in points, four areas by the circumference; of a sample."""
    thicknesses = []
    for polygon in polygons[:: 1 + len(polygons) // 300]:
        corners = _points(ax, polygon)
        around = np.roll(corners, -1, axis=0) - corners
        area = np.abs((corners[:, 0] * around[:, 1] - corners[:, 1] * around[:, 0]).sum()) / 2
        thicknesses.append(4 * area / max(np.hypot(*around.T).sum(), 1e-9))
    return float(np.median(thicknesses))


def _centre(corners: Floats) -> Floats:
    """Centre of area of a convex polygon, [n, 2]."""
    first, a, b = corners[0], corners[1:-1] - corners[0], corners[2:] - corners[0]
    areas = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.asarray(first + (areas[:, None] * (a + b)).sum(axis=0) / (3 * areas.sum()))


def _inside(points: Floats, corners: Floats) -> bool:
    """Whether all points lie in a convex polygon."""
    side = np.roll(corners, -1, axis=0) - corners
    away = points[:, None] - corners
    turns = side[:, 0] * away[..., 1] - side[:, 1] * away[..., 0]
    return bool((turns > 0).all() or (turns < 0).all())
