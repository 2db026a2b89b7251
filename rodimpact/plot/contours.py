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
NEAR_LEVEL = 0.002  # part of the range: values nearer to a level count as equal to it
EDGE_LEVELS = 10  # levels keep this many times NEAR_LEVEL from the ends of the range
PLATEAU_ROWS = 3  # rows of values equal to a level that make a plateau
LABEL_GAP = 2.0  # points between a label and other labels, lines, and the frame
STUB = 8.0  # points of a line between its label and the frame: less looks like a dot
LETTERS = SMALL + 1  # height, points
POINTS_OF_LINE = 400  # points at which the distance of a label from a line is measured


def draw_contours(
    ax: Axes,
    grid: tuple[Floats, Floats],
    values: Floats,
    palette: colors.Colormap,
    norm: colors.Normalize,
) -> contour.QuadContourSet | None:
    """Draw contour lines at round values of a map [x, y]; they do not cross jumps.

    None is returned if there is no round value well inside the range, or if every value
    is beside a jump or not finite.
    """
    levels = _levels(values)
    is_smooth = away_from_jumps(values)
    if not levels or not is_smooth.any():
        return None
    x, y = grid
    return ax.contour(
        x,
        y,
        np.ma.array(values, mask=~is_smooth).T,  # matplotlib takes [y, x]
        levels=levels,
        linestyles="-",
        linewidths=0.8,
        zorder=3,
        colors=[ink_on(norm, level, palette) for level in levels],
    )


def _levels(values: Floats) -> list[float]:
    """Round values well inside the range of a map, but not the values of plateaus.

    A plateau has values equal to the level, as many as `PLATEAU_ROWS` rows: a line
    along it would be noise.
    """
    low = float(np.nanmin(values))
    high = float(np.nanmax(values))
    near = NEAR_LEVEL * (high - low)  # values this near to a level count as equal to it
    margin = EDGE_LEVELS * near
    locator = ticker.MaxNLocator(MAX_LEVELS, steps=[1, 2, 2.5, 5, 10])
    levels = []
    for level in locator.tick_values(low, high):
        is_inside = low + margin < level < high - margin
        if not is_inside:
            continue
        equal_values = np.sum(np.abs(values - level) < near)
        if equal_values < PLATEAU_ROWS * max(values.shape):
            levels.append(float(level))
    return levels


def label_contours(
    ax: Axes,
    contours: contour.QuadContourSet,
    borders: Sequence[contour.QuadContourSet],
) -> list[Text]:
    """Write the value of each line into it, clear of other labels, lines and the frame.

    A label is written where matplotlib puts it, or else at the nearest clear point of
    its line. Points farther than `STUB` from the frame come first. A line without a
    clear point has no label.

    Parameters
    ----------
    ax : Axes
    contours : QuadContourSet
        Lines to be labelled.
    borders : sequence of QuadContourSet
        Other lines of the map, of one level each, which labels must not touch.
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
    # Half width of each obstacle; that of a line is half the height of a letter.
    half_widths = np.full(len(obstacles), LETTERS / 2)
    chosen = []
    for text in trial:
        half_width = text_width(text.get_text(), LETTERS) / 2 + LABEL_GAP
        candidates = []
        for point in _candidates(ax, contours, text):
            distances = np.hypot(*(obstacles - point).T)
            if not (distances < half_width + half_widths).any():
                candidates.append(point)
        # First the points that leave room for a visible part of the line
        margin = half_width + STUB
        inside = [point for point in candidates if _is_inside(ax, point, margin)]
        inside += [point for point in candidates if _is_inside(ax, point, half_width)]
        if inside:
            best = inside[0]
            to_map = ax.transData.inverted()
            chosen.append(to_map.transform(best * _pixels(ax)))
            obstacles = np.vstack([obstacles, best])
            half_widths = np.append(half_widths, half_width)
        text.remove()
    labels = ax.clabel(
        contours, fmt=value, inline_spacing=3, fontsize=LETTERS, manual=chosen
    )
    return list(labels)[len(trial) :]  # matplotlib's list still has the trial


def _pixels(ax: Axes) -> float:
    """Pixels in a point, which is 1/72 inch on paper."""
    return float(ax.figure.dpi) / 72


def _in_points(ax: Axes, positions: Floats) -> Floats:
    """Positions [..., 2] on the axes of a map as positions on paper, points."""
    return np.asarray(ax.transData.transform(positions) / _pixels(ax))


def _points_of(ax: Axes, line: Floats) -> Floats:
    """`POINTS_OF_LINE` points [n, 2] on paper along a line [corner, 2] of the map.

    Each interval between neighbouring corners of the line has about as many points.
    """
    corners = _in_points(ax, line)
    # Index of a corner, with fractions for points between corners
    fine_index = np.linspace(0, len(corners) - 1, POINTS_OF_LINE)
    index = np.arange(len(corners))
    x = np.interp(fine_index, index, corners[:, 0])
    y = np.interp(fine_index, index, corners[:, 1])
    return np.column_stack([x, y])


def _candidates(
    ax: Axes, contours: contour.QuadContourSet, text: Text
) -> Iterator[Floats]:
    """Yield points [2] on paper for a label, the nearest to its present position first.

    The first is the present position itself; the others are those of the line nearest
    to it.
    """
    start = _in_points(ax, np.array(text.get_position()))
    yield start
    nearest: Floats | None = None  # points of the nearest line
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


def _is_inside(ax: Axes, point: Floats, margin: float) -> bool:
    """Whether a point on paper is inside the Axes, beyond a margin from its frame.

    All lengths are in points.
    """
    box = ax.get_window_extent()
    lower_left = box.p0 / _pixels(ax)
    upper_right = box.p1 / _pixels(ax)
    is_inside = (point - margin > lower_left) & (point + margin < upper_right)
    return bool(is_inside.all())
