"""A family of collisions with two axes: a map with contour lines and the lines theory knows.

Each collision is a cell of one colour, and contour lines end at jumps, so that nothing is smeared.
Counts have a colour each and no contour lines.
"""

from __future__ import annotations

from typing import Literal, NamedTuple, TypeAlias

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colorbar import Colorbar
from matplotlib.colors import BoundaryNorm, Colormap, Normalize
from matplotlib.contour import QuadContourSet
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.path import Path
from matplotlib.patheffects import withStroke
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator

from ..methods.signals import Floats
from ..results.pair_theory import PairTheory
from .curves import jumps
from .sampling import evenly
from .scales import ROUND_OFF, signed
from .sides import Shown, Side, count_ticks, dress_side
from .style import RISING, SMALL, centred, colour_bar, colours, dress, ink_on, legend_above, picture

LINES = 150  # points a side, at most, from which lines are drawn
CRUMB = 8  # points of a piece of a line, at least, unless the map itself is coarse
PLATEAU = 3  # rows of points on which values equal: no line follows such a plateau
COLOURS = 24  # counts that have a colour each, at most


Plane: TypeAlias = tuple[Floats, Floats]  # numbers on the axes from which lines are drawn


@picture
class Map(NamedTuple):
    """Artists of a family with two axes; `theory` holds lines of equal times and impedances."""

    ax: Axes
    cells: QuadMesh
    contours: QuadContourSet | None
    labels: list[Text]
    theory: list[QuadContourSet]
    colour_bar: Colorbar


def draw_map(ax: Axes, across: Side, up: Side, shown: Shown, theory: PairTheory | None) -> Map:
    """Draw values over two axes, the first one to the right."""
    palette, norm = _colours(shown)
    cells = ax.pcolormesh(across.edges, up.edges, np.ma.masked_invalid(shown.values.T),
                          cmap=palette, norm=norm, shading="flat", rasterized=True, zorder=1)
    dress_side(ax, "x", across)
    dress_side(ax, "y", up)
    i, j = (evenly(side.values.size, LINES) for side in (across, up))
    plane = across.numbers[i], up.numbers[j]
    contours, labels = (None, []) if shown.is_count else _contours(
        ax, plane, shown.values[np.ix_(i, j)], palette, norm)
    paper, ink, faint, *_ = colours()
    handles: list[Artist] = []
    lines: list[QuadContourSet] = []
    for name, dash, excess in _equalities(theory, across.is_log or up.is_log):
        where_met = np.where(np.isfinite(shown.values), np.round(excess, 12), np.nan)[np.ix_(i, j)]
        if (where_met < 0).any() and (where_met > 0).any():
            lines.append(_zero(ax, plane, where_met, dash))
            handles.append(Line2D([], [], color=ink, linewidth=1.4, linestyle=dash, label=name))
    if np.isnan(shown.values).any():
        handles.append(Patch(facecolor=paper, edgecolor=faint, label="no value"))
    bar = colour_bar(ax, cells, shown.scale.label)
    if shown.is_count:
        count_ticks(bar.ax.yaxis, shown)
    legend_above(ax, handles)
    dress(ax)
    return Map(ax, cells, contours, labels, lines, bar)


def _colours(shown: Shown) -> tuple[Colormap, Normalize]:
    """Colours and limits: one colour a count, symmetric about 0 where signs differ."""
    low, high = float(np.nanmin(shown.values)), float(np.nanmax(shown.values))
    if shown.words:
        low, high = 0.0, len(shown.words) - 1.0
    count = int(high - low) + 1
    if shown.is_count and count <= COLOURS:
        return RISING.resampled(count), BoundaryNorm(low - 0.5 + np.arange(count + 1), count)
    largest = max(-low, high)
    if low < -ROUND_OFF * largest and high > ROUND_OFF * largest:
        return colours().signed, centred((low, high))
    if high - low <= ROUND_OFF * largest:
        low, high = min(low, 0.0), max(high, 0.0)
    return RISING, Normalize(low, high if high > low else low + 1.0)


def _contours(
    ax: Axes, plane: Plane, values: Floats, palette: Colormap, norm: Normalize
) -> tuple[QuadContourSet | None, list[Text]]:
    """Draw lines at round values, each with its value, up to the jumps and not across them."""
    known = values[np.isfinite(values)]
    low, high = float(known.min(initial=np.inf)), float(known.max(initial=-np.inf))
    if high - low <= ROUND_OFF * max(-low, high):
        return None, []
    near = 0.002 * (high - low)
    levels = [
        x for x in MaxNLocator(8, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
        if low + 10 * near < x < high - 10 * near
        and np.sum(np.abs(known - x) < near) < PLATEAU * max(values.shape)
    ]
    smooth = np.isfinite(values)
    for axis in (0, 1):
        i, j = np.nonzero(jumps(values) if axis == 0 else jumps(values.T).T)
        smooth[i, j] = smooth[i + 1 - axis, j + axis] = False
    if not levels or not smooth.any():
        return None, []
    lines = ax.contour(
        *plane, np.ma.array(values, mask=~smooth).T, levels=levels, linestyles="-", linewidths=0.8,
        colors=[ink_on(norm, x, palette) for x in levels], zorder=3)
    least = min(CRUMB, min(values.shape) // 5)
    lines.set_paths([_without_crumbs(path, least) for path in lines.get_paths()])
    return lines, list(ax.clabel(lines, fmt=lambda x: signed(f"{x:g}"), fontsize=SMALL + 1,
                                 inline_spacing=3))


def _without_crumbs(path: Path, least: int) -> Path:
    """A line without its pieces of fewer than `least` points."""
    if path.codes is None:
        return path
    codes, vertices = np.asarray(path.codes), np.asarray(path.vertices)
    counts = np.diff(np.append(np.flatnonzero(codes == Path.MOVETO), codes.size))
    kept = np.repeat(counts >= least, counts)
    return Path(vertices[kept], codes[kept])


def _equalities(
    theory: PairTheory | None, is_log: bool
) -> list[tuple[str, Literal["-", "--"], Floats]]:
    """Lines that theory knows: name, dashes, and how much the left rod has more than the right."""
    if theory is None or np.isinf(theory.impedance).any():
        return []

    def excess(left: Floats, right: Floats) -> Floats:
        return np.log(left / right) if is_log else (left - right) / np.max(left)

    return [("equal transit times: e = 1", "-", excess(*theory.transit_time)),
            ("equal impedances", "--", excess(*theory.impedance))]


def _zero(ax: Axes, plane: Plane, values: Floats, dash: str) -> QuadContourSet:
    """Draw where values are 0."""
    lines = ax.contour(*plane, np.ma.masked_invalid(values.T), levels=[0.0],
                       colors=colours().ink, linewidths=1.4, linestyles=dash, zorder=4)
    lines.set_path_effects([withStroke(linewidth=2.6, foreground=colours().paper)])
    return lines
