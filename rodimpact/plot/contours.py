"""Contour lines of a map: at round values, up to jumps, with labels that have room."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib import colors, contour, ticker
from matplotlib.axes import Axes
from matplotlib.text import Text

from ..methods.signals import Floats
from .jumps import away_from_jumps
from .labels import text_width
from .scales import with_minus_signs
from .style import SMALL, ink_on

MAX_LEVELS = 8
NEAR_LEVEL = 0.002  # part of the range: values as near to a level count as the level
PLATEAU_ROWS = 3  # rows of equal values: no line follows such a plateau
LABEL_GAP = 2.0  # points between a label and other labels, lines, and the frame
STUB = 8.0  # points of a line between its label and the frame, rather than a dot
LETTERS = SMALL + 1  # height, points
POINTS_OF_LINE = 400  # points at which the distance of a label from a line is measured


def draw_contours(
    ax: Axes,
    grid: tuple[Floats, Floats],
    values: Floats,
    palette: colors.Colormap,
    norm: colors.Normalize,
) -> contour.QuadContourSet | None:
    """Draw lines at round values of a map [x, y], up to the jumps and not across them.

    None where there is no such value, or where every value is beside a jump.
    """
    levels = _levels(values)
    is_smooth = away_from_jumps(values)
    if not levels or not is_smooth.any():
        return None
    x, y = grid
    return ax.contour(
        x,
        y,
        np.ma.array(values, mask=~is_smooth).T,
        levels=levels,
        linestyles="-",
        linewidths=0.8,
        zorder=3,
        colors=[ink_on(norm, level, palette) for level in levels],
    )


def _levels(values: Floats) -> list[float]:
    """Round values well inside the range of a map, but not those of a plateau."""
    low = float(np.nanmin(values))
    high = float(np.nanmax(values))
    near = NEAR_LEVEL * (high - low)
    locator = ticker.MaxNLocator(MAX_LEVELS, steps=[1, 2, 2.5, 5, 10])
    levels = []
    for level in locator.tick_values(low, high):
        is_inside = low + 10 * near < level < high - 10 * near
        if not is_inside:
            continue
        members = np.sum(np.abs(values - level) < near)
        if members < PLATEAU_ROWS * max(values.shape):
            levels.append(float(level))
    return levels


def label_contours(
    ax: Axes,
    contours: contour.QuadContourSet,
    borders: Sequence[contour.QuadContourSet],
) -> list[Text]:
    """Write the value of each line into it, clear of other labels, lines and the frame.

    A label stands where matplotlib puts it, or else at the nearest clear point of its
    line; a line without such a point has none.
    """

    def value(level: float) -> str:
        """Text of a level."""
        return with_minus_signs(f"{level:g}")

    # Matplotlib places labels on trial. Then each is moved along its line until it is
    # clear of the obstacles: points of other lines, and labels that have their place.
    trial = list(ax.clabel(contours, fmt=value, inline=False, fontsize=LETTERS))
    obstacles = np.empty((0, 2))  # [n, 2], points on paper
    for border in borders:
        for line in border.allsegs[0]:
            obstacles = np.vstack([obstacles, _points_of(ax, line)])
    clear = np.full(len(obstacles), LETTERS / 2)  # distance to keep from each obstacle
    chosen = []
    for text in trial:
        half = text_width(text.get_text(), LETTERS) / 2 + LABEL_GAP
        candidates = []
        for point in _candidates(ax, contours, text):
            distances = np.hypot(*(obstacles - point).T)
            if not (distances < half + clear).any():
                candidates.append(point)
        inside = [point for point in candidates if _is_inside(ax, point, half + STUB)]
        inside += [point for point in candidates if _is_inside(ax, point, half)]
        if inside:
            to_map = ax.transData.inverted()
            chosen.append(to_map.transform(inside[0] * _pixels(ax)))
            obstacles = np.vstack([obstacles, inside[0]])
            clear = np.append(clear, half)
        text.remove()
    labels = ax.clabel(
        contours, fmt=value, inline_spacing=3, fontsize=LETTERS, manual=chosen
    )
    return list(labels)[len(trial) :]  # matplotlib's list still has the trial


def _pixels(ax: Axes) -> float:
    """Pixels that a point, 1/72 inch on paper, takes."""
    return float(ax.figure.dpi) / 72


def _in_points(ax: Axes, places: Floats) -> Floats:
    """Places of a map on paper, points."""
    return np.asarray(ax.transData.transform(places) / _pixels(ax))


def _points_of(ax: Axes, line: Floats) -> Floats:
    """`POINTS_OF_LINE` points [n, 2] along a line of the map, on paper.

    There are as many of them between any two corners of the line.
    """
    corners = _in_points(ax, line)
    index = np.linspace(0, len(corners) - 1, POINTS_OF_LINE)
    corner = np.arange(len(corners))
    x = np.interp(index, corner, corners[:, 0])
    y = np.interp(index, corner, corners[:, 1])
    return np.column_stack([x, y])


def _candidates(
    ax: Axes, contours: contour.QuadContourSet, text: Text
) -> Iterator[Floats]:
    """Points for a label: where it stands, then those of its line, nearest first."""
    start = _in_points(ax, np.array(text.get_position()))
    yield start
    nearest: Floats | None = None
    least = np.inf
    for lines in contours.allsegs:
        for line in lines:
            if len(line) == 0:  # a level that the map does not reach
                continue
            points = _points_of(ax, line)
            distances = np.hypot(*(points - start).T)
            distance = float(distances.min())
            if distance < least:
                least = distance
                nearest = points
    if nearest is None:
        return
    order = np.argsort(np.hypot(*(nearest - start).T), kind="stable")
    yield from nearest[order]


def _is_inside(ax: Axes, point: Floats, half: float) -> bool:
    """Whether a label at a point stays `half` its width, points, from the frame."""
    box = ax.get_window_extent()
    low = box.p0 / _pixels(ax)
    high = box.p1 / _pixels(ax)
    is_inside = (point - half > low) & (point + half < high)
    return bool(is_inside.all())
