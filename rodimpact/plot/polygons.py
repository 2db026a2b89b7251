"""Exact polygons of constant state in space and time, with their values written into them."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.text import Text

from ..contacts import ContactHistory
from ..regions import regions_of
from ..signals import Floats
from ..solution import Solution
from .placing import Placing
from .scales import Scale, digits
from .style import DIVERGING, INK, SMALL, ink_on

CROWDED = 3.0  # typical thickness of a region, points, below which lines would hide the colours


class Polygons:
    """The regions between the fronts of a solution, in an interval of time, s.

    Raises
    ------
    ValueError
        If the interval is empty or outside the solution, or has more than 100 000 regions.
    """

    def __init__(self, solution: Solution, start: float, stop: float | None) -> None:
        self.regions = regions_of(solution, start, stop)
        self._body = np.repeat(self.regions.body, np.diff(self.regions.start))

    def values(self, field: str) -> Floats:
        """Velocity, strain or stress of each region; SI."""
        found: Floats = getattr(self.regions, field)
        return found

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
        self, ax: Axes, plan: Placing, numbers: Floats, norm: Normalize, time: Scale, place: Scale
    ) -> PolyCollection:
        """Draw the regions with these numbers."""
        r, places = self.regions, np.empty(self.regions.x.shape)
        for i in np.unique(self._body):
            here = self._body == i
            places[here] = plan.place(int(i), r.x[here], r.t[here], r.displacement[here])
        corners = np.column_stack((places * place.factor, r.t * time.factor))
        self._polygons = np.split(corners, r.start[1:-1])
        self._norm = norm
        self._drawn = PolyCollection(
            self._polygons, array=numbers, cmap=DIVERGING, norm=norm, zorder=2,
            edgecolors=INK, linewidths=0.35,
        )
        ax.add_collection(self._drawn)
        return self._drawn

    def finish(self) -> list[Text]:
        """Once limits are set: write each number where it has room; no lines in a crowd."""
        ax, numbers = self._drawn.axes, self._drawn.get_array()
        assert isinstance(ax, Axes)
        assert numbers is not None
        if _thickness(ax, self._polygons) < CROWDED:
            self._drawn.set(edgecolor="face", linewidth=0.1)
            return []
        return _labels(ax, self._polygons, numbers, self._norm)


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
            written.append(ax.text(
                x, y, text, ha="center", va="center", fontsize=SMALL, zorder=6,
                color=ink_on(norm, value),
            ))
    return written


def _points(ax: Axes, corners: Floats) -> Floats:
    """Corners in printer's points."""
    points: Floats = ax.transData.transform(corners) * (72.0 / ax.figure.dpi)
    return points


def _thickness(ax: Axes, polygons: list[Floats]) -> float:
    """Typical thickness of polygons in points, four areas by the circumference; of a sample."""
    found = []
    for polygon in polygons[:: 1 + len(polygons) // 300]:
        corners = _points(ax, polygon)
        around = np.roll(corners, -1, axis=0) - corners
        area = np.abs((corners[:, 0] * around[:, 1] - corners[:, 1] * around[:, 0]).sum()) / 2
        found.append(4 * area / max(np.hypot(*around.T).sum(), 1e-9))
    return float(np.median(found))


def _centre(corners: Floats) -> Floats:
    """Centre of area of a convex polygon, [n, 2]."""
    first, a, b = corners[0], corners[1:-1] - corners[0], corners[2:] - corners[0]
    areas = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    centre: Floats = first + (areas[:, None] * (a + b)).sum(axis=0) / (3 * areas.sum())
    return centre


def _inside(points: Floats, corners: Floats) -> bool:
    """Whether all points lie in a convex polygon."""
    side = np.roll(corners, -1, axis=0) - corners
    away = points[:, None] - corners
    turns = side[:, 0] * away[..., 1] - side[:, 1] * away[..., 0]
    return bool((turns > 0).all() or (turns < 0).all())
