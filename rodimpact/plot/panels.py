"""Panels: figures, their Axes, what every Axes has, and how they are laid out.

Words are written where there is room for them, and how much room there is shows only
when labels, legends and colour bars have taken theirs. A figure with words is therefore
a `Draft` first: everything but the words is drawn, then `finish` lays the figure out
and writes them.
"""

import io
import math
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from matplotlib import artist, cm, collections, colorbar, colors, patches, rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..hints import explain_missing
from ..methods.signals import Floats
from ..model.arguments import check_kind
from ..model.frozen import invalid_argument
from ..units import shown
from .labels import legend_above
from .style import FONT, colours, wanted_width

DOTS_PER_INCH = 90  # resolution in a notebook
LABEL_OVERHANG = 1.6  # width of a label below its Axes, in widths of the Axes, at most


class Sheet(Figure):
    """A figure that a notebook shows, without any command before."""

    def _repr_png_(self) -> bytes:
        """The figure as PNG, for a notebook."""
        memory = io.BytesIO()
        self.savefig(
            memory, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None}
        )
        return memory.getvalue()


@explain_missing()
class Picture(SimpleNamespace):
    """The Axes `ax` and the artists that a function has drawn, by name.

    A notebook shows its figure.
    """

    ax: Axes

    def _repr_png_(self) -> bytes:
        """The figure as PNG, also if it is none of this package's."""
        return Sheet._repr_png_(figure_of(self))


class Draft(NamedTuple):
    """A picture without its words, and the function that writes them."""

    picture: Picture
    write_words: Callable[[], None]


def finish(draft: Draft) -> Picture:
    """Lay out the figure of a draft and write its words."""
    lay_out(figure_of(draft.picture))
    draft.write_words()
    return draft.picture


def figure_of(drawn: Any) -> Any:
    """The figure of a picture, Axes or figure.

    Raises
    ------
    ValueError
        If it has none.
    """
    axes = getattr(drawn, "ax", drawn)
    figure = getattr(axes, "figure", axes)
    figure = getattr(figure, "figure", figure)  # a part of a figure has a figure
    if not isinstance(figure, Figure):
        raise invalid_argument(
            "picture",
            "must be a figure, axes or a picture of them, such as "
            f"plot.overview(solution), got {shown(drawn)}",
        )
    return figure


def new_figure(width: float, height: float, least_height: float = 0.0) -> Sheet:
    """Figure that pyplot does not keep, of the wanted width, or this size, inches.

    A narrow figure is lower too, but not in proportion, for its labels take room as
    before.
    """
    scale = wanted_width(width) / width
    if scale < 1:
        height *= math.sqrt(scale)
    else:
        height *= scale
    height = max(height, least_height)
    return Sheet(figsize=(width * scale, height), layout="constrained")


def axes_or_new(
    ax: Axes | None, width: float, height: float, least_height: float = 0.0
) -> Axes:
    """The Axes given, or that of a new figure of this size, inches."""
    if ax is None:
        return new_figure(width, height, least_height).add_subplot()
    check_kind("ax", ax, Axes, "plt.gca()")
    return ax


def two_axes_or_new(
    ax: Any, contents: str, height: float, ratios: Sequence[float]
) -> tuple[Axes, Axes]:
    """The pair of Axes given, or one above the other of a new figure.

    Parameters
    ----------
    ax : two Axes, or None
    contents : str
        What both show, for the error.
    height : float
        Height of a new figure, inches.
    ratios : sequence of float
        Ratio of the heights of new Axes, upper to lower.

    Raises
    ------
    ValueError
        If `ax` is neither a pair of Axes nor None.
    """
    if ax is None:
        figure = new_figure(width=5.6, height=height)
        upper, lower = figure.subplots(2, sharex=True, height_ratios=ratios)
        return upper, lower
    pair = []
    is_flat = getattr(ax, "ndim", 1) == 1  # a list or tuple has no `ndim`
    if isinstance(ax, Sequence | np.ndarray) and is_flat:
        pair = list(ax)
    if len(pair) != 2 or not all(isinstance(each, Axes) for each in pair):
        raise invalid_argument(
            "ax", f"needs a pair of Axes, for {contents}, got {shown(ax)}"
        )
    upper, lower = pair
    return upper, lower


def lay_out(figure: Figure) -> None:
    """Give labels, legends and colour bars room, so that sizes of Axes are known."""
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)


def size_in_points(ax: Axes) -> Floats:
    """Width and height of an Axes, in points."""
    return np.asarray(ax.get_window_extent().size) * 72 / ax.figure.dpi


def room_below(ax: Axes) -> float:
    """Room for a line of a label below an Axes, points.

    The label is centred. It may be wider than the Axes but stays inside the figure.
    """
    box = ax.get_window_extent()
    figure = figure_of(ax)
    middle = (box.x0 + box.x1) / 2
    to_edge = min(middle, figure.bbox.width - middle)
    pixels = min(LABEL_OVERHANG * box.width, 2 * to_edge)
    return float(pixels * 72 / figure.dpi)


def units_per_point(ax: Axes) -> Floats:
    """Units of the axes of x and y that one point on paper takes, [2]."""
    limits = [ax.get_xlim(), ax.get_ylim()]
    return np.asarray(np.ptp(limits, axis=1) / size_in_points(ax))


def format_axes(
    ax: Axes, named: Sequence[artist.Artist | None] = (), **settings: Any
) -> None:
    """Give an Axes its settings, ticks and frame, and the names of artists above it.

    Axes of a user may have been made with other settings than those of the style sheet.
    """
    ax.set(**settings)
    legend_above(ax, named)
    ax.tick_params(
        which="both",
        labelsize=rcParams["xtick.labelsize"],
        labelfontfamily=FONT,
        labelcolor=colours().ink,
        color=colours().faint,
        length=rcParams["xtick.major.size"],
    )
    ax.spines[:].set_color(colours().faint)
    ax.spines[["top", "right"]].set_visible(False)


def add_grid(ax: Axes) -> None:
    """Draw faint lines behind curves."""
    ax.grid(color=colours().faint, alpha=0.3, linewidth=0.5)


def draw_zero(ax: Axes) -> None:
    """Draw a faint line at the value 0."""
    ax.axhline(0.0, color=colours().faint, linewidth=0.6, zorder=0)


class Cells(NamedTuple):
    """Cells of one colour each; legend entry of cells without value, or None."""

    mesh: collections.QuadMesh
    missing: artist.Artist | None


def draw_cells(
    ax: Axes,
    edges: Sequence[Floats],
    values: Floats,
    palette: colors.Colormap,
    norm: colors.Normalize,
    missing: str = "no value",
) -> Cells:
    """Draw values [x, y] as cells between edges; `missing` says why one has no value.

    The legend entry of cells without a value is returned only if a value is NaN.
    """
    x, y = edges
    mesh = ax.pcolormesh(
        x,
        y,
        np.ma.masked_invalid(values.T),
        cmap=palette,
        norm=norm,
        shading="flat",
        rasterized=True,
        zorder=1,
    )
    if not np.isnan(values).any():
        return Cells(mesh, missing=None)
    name = patches.Patch(
        facecolor=colours().paper, edgecolor=colours().faint, label=missing
    )
    return Cells(mesh, missing=name)


def add_colour_bar(
    ax: Axes,
    mapped: cm.ScalarMappable,
    label: str,
    reference: float | None = None,
    **settings: Any,
) -> colorbar.Colorbar:
    """Add a colour bar beside an Axes, or as matplotlib's settings for it say.

    Of colours that are symmetric about a reference value it shows those in use.
    """
    settings.setdefault("fraction", 0.06)
    settings.setdefault("pad", 0.02)
    settings.setdefault("aspect", 30)
    bar = ax.figure.colorbar(mapped, ax=ax, label=label, **settings)
    format_axes(bar.ax)
    bar.outline.set_visible(False)
    values: Any = np.ma.masked_invalid(np.ma.asarray(mapped.get_array()))
    if reference is not None and (values != reference).any():
        low = min(reference, float(values.min()))
        high = max(reference, float(values.max()))
        if bar.orientation == "horizontal":
            bar.ax.set_xlim(low, high)
        else:
            bar.ax.set_ylim(low, high)
    return bar
