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
LABEL_OVERHANG = 1.6  # largest width of a label below its Axes, in widths of the Axes
POINTS_PER_INCH = 72


class Sheet(Figure):
    """A figure that a notebook shows if it is the value of a cell."""

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
        """The figure as PNG, for a notebook."""
        # Its Axes may be in a figure of the user's, which is no `Sheet`.
        return Sheet._repr_png_(figure_of(self))


class Draft(NamedTuple):
    """A picture without its words, and the function that writes them."""

    picture: Picture
    write_words: Callable[[], None]


def finish(draft: Draft) -> Picture:
    """Lay out the figure of a draft, write its words, and return its picture."""
    lay_out(figure_of(draft.picture))
    draft.write_words()
    return draft.picture


def figure_of(drawn: Any) -> Any:
    """The whole figure to which a picture or Axes belongs; a figure is returned itself.

    Raises
    ------
    ValueError
        If it belongs to no figure.
    """
    axes = getattr(drawn, "ax", drawn)  # the Axes of a picture
    figure = getattr(axes, "figure", axes)
    # A subfigure has the figure that contains it, a figure has itself.
    figure = getattr(figure, "figure", figure)
    if not isinstance(figure, Figure):
        raise invalid_argument(
            "picture",
            "must be a figure, axes or a picture of them, such as "
            f"plot.overview(solution), got {shown(drawn)}",
        )
    return figure


def new_figure(width: float, height: float, least_height: float = 0.0) -> Sheet:
    """New figure of the width that `look` asks for, by default of this size, inches.

    A wider figure is higher in proportion. A narrower one is lower by the square root
    of the ratio only, because its labels stay as large, but not below `least_height`.
    pyplot does not know the figure.
    """
    ratio = wanted_width(width) / width
    if ratio < 1:
        height *= math.sqrt(ratio)
    else:
        height *= ratio
    height = max(height, least_height)
    return Sheet(figsize=(width * ratio, height), layout="constrained")


def axes_or_new(
    ax: Axes | None, width: float, height: float, least_height: float = 0.0
) -> Axes:
    """The Axes given, or that of a new figure of this size, inches.

    InvalidModel is raised for an `ax` that is neither an Axes nor None.
    """
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
    return np.asarray(ax.get_window_extent().size) * POINTS_PER_INCH / ax.figure.dpi


def room_below(ax: Axes) -> float:
    """Largest width of a label that is centred below an Axes, points.

    It is `LABEL_OVERHANG` widths of the Axes, or less if the label would leave the
    figure.
    """
    box = ax.get_window_extent()  # pixels
    figure = figure_of(ax)
    middle = (box.x0 + box.x1) / 2
    to_edge = min(middle, figure.bbox.width - middle)  # the nearer edge of the figure
    pixels = min(LABEL_OVERHANG * box.width, 2 * to_edge)
    return float(pixels * POINTS_PER_INCH / figure.dpi)


def units_per_point(ax: Axes) -> Floats:
    """Lengths in x and y, in the units of the axes, of one point on paper, [2]."""
    limits = [ax.get_xlim(), ax.get_ylim()]
    ranges = np.ptp(limits, axis=1)
    return np.asarray(ranges / size_in_points(ax))


def format_axes(
    ax: Axes, named: Sequence[artist.Artist | None] = (), **settings: Any
) -> None:
    """Give an Axes its settings, the look of ticks and frame, and a legend above it.

    Parameters
    ----------
    ax : Axes
    named : sequence of artists
        Entries of the legend; None is left out. Without entries there is no legend.
    **settings
        Properties for `Axes.set`, such as ``xlim`` and ``ylabel``.
    """
    ax.set(**settings)
    legend_above(ax, named)
    # A user's Axes may have been made with other settings than the style sheet's.
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
    """Draw values [x, y] as coloured cells between the edges [x] and [y].

    Cells whose value is not finite are left empty. If a value is NaN, the legend entry
    with the text `missing` for such cells is returned too.
    """
    x_edges, y_edges = edges
    mesh = ax.pcolormesh(
        x_edges,
        y_edges,
        np.ma.masked_invalid(values.T),  # matplotlib takes [y, x]
        cmap=palette,
        norm=norm,
        shading="flat",
        rasterized=True,
        zorder=1,
    )
    if not np.isnan(values).any():
        return Cells(mesh, missing=None)
    entry = patches.Patch(
        facecolor=colours().paper, edgecolor=colours().faint, label=missing
    )
    return Cells(mesh, missing=entry)


def add_colour_bar(
    ax: Axes,
    mapped: cm.ScalarMappable,
    label: str,
    reference: float | None = None,
    **settings: Any,
) -> colorbar.Colorbar:
    """Add a colour bar beside an Axes.

    Parameters
    ----------
    ax : Axes
    mapped : ScalarMappable
        Artist whose colours the bar explains.
    label : str
    reference : float, optional
        Value about which the colours are symmetric: the bar is then cut to the range of
        the values and the reference. By default it shows all colours.
    **settings
        Of `Figure.colorbar`; they replace the package's own.
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
