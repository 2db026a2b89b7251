"""Style of all figures: fonts, colours on light and dark paper, sizes for print, axes.

Colours of signed values run from blue over nearly the colour of the paper, for 0, to yellow.
Colours of other values run from dark blue over grey to light yellow; their lightness increases, so
that the order of values is visible in grey prints, too. Blue and yellow differ for every common
kind of colour-blindness.
"""

import io
import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from types import SimpleNamespace
from typing import Any, NamedTuple, ParamSpec, TypeVar

import numpy as np
from matplotlib import artist, cm, collections, colorbar, colors, patches, rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..methods.signals import Floats
from ..model.arguments import of_kind, one_of, single
from ..model.frozen import refusal
from ..units import shown

FONT = "DejaVu Sans"  # comes with matplotlib and has every sign used here
INK, FAINT = "#1a1a1a", "#8a8a8a"
SERIES = ("#20409a", "#c77700", "#6b6b6b", "#117733", "#882255")
DASHES = ("-", "--", "-.", ":", (0, (6, 2, 1, 2, 1, 2)))
SMALL, NORMAL = 7.0, 9.0
INCH = 25.4  # mm
DOTS_PER_INCH = 90  # in a notebook
LETTER = 0.57  # mean width of a letter, in heights of the font
HANDLE = 6  # letters that the mark before a name in a legend takes
COMPUTED: dict[str, Any] = {
    "marker": "o",
    "markersize": 3.5,
    "markerfacecolor": "none",
    "markeredgewidth": 0.8,
    "label": "computed",
}

RISING = colors.LinearSegmentedColormap.from_list(  # in 101 steps: to the eye as smooth as 256
    "rising", ["#16256e", "#53659f", "#a0a0a0", "#d6c05f", "#ffe94a"], 101
)
ON_LIGHT = colors.LinearSegmentedColormap.from_list(
    "signed on light", ["#16256e", "#7084c4", "#f4f4f1", "#eec654", "#c48600"]
)
ON_DARK = colors.LinearSegmentedColormap.from_list(
    "signed on dark", ["#9db7ff", "#4e62a0", "#262b33", "#967a30", "#ffe94a"]
)

P = ParamSpec("P")
R = TypeVar("R")


class Colours(NamedTuple):
    """Colours of paper, lines, bodies, series of curves, and signed values."""

    paper: str
    ink: str
    faint: str
    wall: str
    mass: str
    series: tuple[str, ...]
    signed: colors.Colormap


LOOKS = {
    "light": Colours("#ffffff", INK, FAINT, "#d9d9d9", "#33302e", SERIES, ON_LIGHT),
    "dark": Colours(
        "#14161a",
        "#e8e8e8",
        "#8f939b",
        "#33373e",
        "#cfc8c0",
        ("#8ea6ff", "#f0a13c", "#b4b4b4", "#5cc588", "#e283ad"),
        ON_DARK,
    ),
}
_look: ContextVar[tuple[Colours, float | None]] = ContextVar(
    "look", default=(LOOKS["light"], None)
)


def colours() -> Colours:
    """Colours of what is being drawn."""
    return _look.get()[0]


@contextmanager
def look(name: str = "light", width: float | None = None) -> Iterator[None]:
    """Draw figures on light or dark paper, and with a chosen width.

    Parameters
    ----------
    name : "light" or "dark"
    width : float, optional
        Width of new figures, mm; the size of letters does not change. A column of a journal is
        about 85 mm wide, a page about 175 mm. By default each figure has its own width.

    Raises
    ------
    ValueError
        For an unknown name, or a width that is not between 50 and 1000 mm.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> solution = ri.solve(ri.System([rod, ri.Wall()]))
    >>> with ri.plot.look("dark", width=85):
    ...     picture = ri.plot.energy(solution)
    >>> float(round(25.4 * picture.ax.figure.get_figwidth(), 3))
    85.0
    """
    one_of("name", name, LOOKS)
    if width is not None:
        width = single("width", width, "mm")
        if not 50 <= width <= 1000:
            raise refusal("width", f"must be 50 to 1000 mm, got {width!r}")
    before = _look.set((LOOKS[name], width))
    try:
        yield
    finally:
        _look.reset(before)


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Decorator: what a function draws has the style, whatever the user's settings."""

    @wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> R:
        paper, ink, faint, *_ = colours()
        with (
            np.errstate(under="ignore"),
            rc_context(
                {
                    "font.family": [FONT],
                    "font.size": NORMAL,
                    "axes.titlesize": NORMAL,
                    "axes.labelsize": NORMAL,
                    "text.color": ink,
                    "axes.labelcolor": ink,
                    "text.usetex": False,
                    "figure.facecolor": paper,
                    "axes.facecolor": paper,
                    "axes.edgecolor": faint,
                    "axes.unicode_minus": True,
                    "axes.formatter.useoffset": False,
                }
            ),
        ):
            return draw(*args, **kwargs)

    return drawn


def centred(values: Any, rest: float = 0.0) -> colors.Normalize:
    """Colour limits symmetric about the value of rest."""
    reach = max((abs(float(v) - rest) for v in values), default=0.0) or 1.0
    return colors.Normalize(rest - reach, rest + reach)


def ink_on(
    norm: colors.Normalize, value: float, palette: colors.Colormap | None = None
) -> str:
    """Colour of text that can be read on the colour of `value`, by default a signed one."""
    red, green, blue, _ = (palette or colours().signed)(norm(value))
    return "white" if 0.3 * red + 0.59 * green + 0.11 * blue < 0.45 else INK


class Sheet(Figure):
    """A figure that a notebook shows, without any command before."""

    def _repr_png_(self) -> bytes:
        memory = io.BytesIO()
        self.savefig(
            memory, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None}
        )
        return memory.getvalue()


class Picture(SimpleNamespace):
    """The Axes `ax` and the artists that a function has drawn, by name.

    A notebook shows its figure.
    """

    ax: Axes

    def _repr_png_(self) -> bytes:
        return Sheet._repr_png_(figure_of(self))


def figure_of(drawn: Any) -> Any:
    """The figure of a picture, Axes or figure.

    Raises
    ------
    ValueError
        If it has none.
    """
    axes = getattr(drawn, "ax", drawn)
    figure = getattr(axes, "figure", axes)
    if not isinstance(figure, Figure):
        raise refusal(
            "picture", f"must be a figure, axes or a picture of them, got {drawn!r}"
        )
    return figure


def wanted_width(usual: float) -> float:
    """Width asked for by `look`, inches, or the usual one."""
    return (_look.get()[1] or usual * INCH) / INCH


def new_figure(width: float, height: float) -> Sheet:
    """Figure of a size in inches, or of the width asked for, that pyplot does not keep."""
    scale = wanted_width(width) / width
    tall = height * (
        scale if scale > 1 else math.sqrt(scale)
    )  # labels take room as before
    return Sheet(figsize=(width * scale, tall), layout="constrained")


def axes(ax: Axes | None, width: float, height: float) -> Axes:
    """The Axes given, or that of a new figure."""
    if ax is None:
        return new_figure(width, height).add_subplot()
    of_kind("ax", ax, Axes, "plt.gca()")
    return ax


def two_axes(
    ax: Any, what: str, height: float, ratios: Sequence[float]
) -> tuple[Axes, Axes]:
    """The pair of Axes given, or those of a new figure; ValueError for anything else."""
    if ax is None:
        ax = new_figure(5.6, height).subplots(2, sharex=True, height_ratios=ratios)
    pair = list(ax) if isinstance(ax, Sequence | np.ndarray) else []
    if len(pair) != 2 or not all(isinstance(each, Axes) for each in pair):
        raise refusal("ax", f"needs a pair of Axes, for {what}, got {shown(ax)}")
    upper, lower = pair
    return upper, lower


def dress(
    ax: Axes, named: Sequence[artist.Artist | None] = (), **settings: Any
) -> None:
    """Settings, ticks and frame of an Axes, and the names of artists above it."""
    ax.set(**settings)
    legend_above(ax, named)
    _, ink, faint, *_ = colours()
    ax.tick_params(
        which="both",
        labelsize=NORMAL - 1,
        labelfontfamily=FONT,
        labelcolor=ink,
        color=faint,
        length=3,
    )
    ax.spines[:].set_color(faint)
    ax.spines[["top", "right"]].set_visible(False)


def grid(ax: Axes) -> None:
    """Faint lines behind curves."""
    ax.grid(color=colours().faint, alpha=0.3, linewidth=0.5)


def extent(ax: Axes) -> Floats:
    """Width and height of an Axes, in points."""
    return np.asarray(ax.get_window_extent().size) * 72 / ax.figure.dpi


def broken(label: str, room: float) -> str:
    """A label broken after commas and before units, in lines of so many points if possible."""
    first, *parts = re.split(r"(?<=,) | (?=\()", label)
    lines = [first]
    for part in parts:
        if len(lines[-1]) + 1 + len(part) > room / (LETTER * NORMAL):
            lines.append(part)
        else:
            lines[-1] += f" {part}"
    return "\n".join(lines)


def legend_above(
    ax: Axes, artists: Sequence[artist.Artist | None], title: str | None = None
) -> None:
    """Name artists, if any, above an Axes, in as many columns as it has room for."""
    shown = [each for each in artists if each is not None]
    if not shown:
        return
    letters = [len(str(each.get_label())) for each in shown]
    room = 1.1 * float(extent(ax)[0]) / LETTER / SMALL  # and a little beyond the Axes
    columns = next(
        (
            n
            for n in range(len(shown), 1, -1)
            if room > sum(max(column) + HANDLE for column in np.array_split(letters, n))
        ),
        1,
    )
    ax.legend(
        handles=shown,
        loc="lower left",
        bbox_to_anchor=(0, 1),
        borderaxespad=0.1,
        ncols=columns,
        frameon=False,
        fontsize=SMALL,
        title=title,
        title_fontsize=SMALL,
        alignment="left",
        columnspacing=1.2,
        handlelength=1.6,
    )


def cells(
    ax: Axes,
    edges: Sequence[Floats],
    values: Floats,
    palette: colors.Colormap,
    norm: colors.Normalize,
    missing: str = "no value",
) -> tuple[collections.QuadMesh, list[artist.Artist]]:
    """Draw values [x, y] as cells of one colour each; cells without value, if any, have a name."""
    paper, _, faint, *_ = colours()
    drawn = ax.pcolormesh(
        *edges,
        np.ma.masked_invalid(values.T),
        cmap=palette,
        norm=norm,
        shading="flat",
        rasterized=True,
        zorder=1,
    )
    name = patches.Patch(facecolor=paper, edgecolor=faint, label=missing)
    return drawn, [name] if np.isnan(values).any() else []


def colour_bar(
    ax: Axes,
    drawn: cm.ScalarMappable,
    label: str,
    rest: float | None = None,
    **how: Any,
) -> colorbar.Colorbar:
    """Colour bar beside an Axes, or where and as matplotlib's words for it say.

    Of colours that are symmetric about a value of rest it shows those in use.
    """
    bar = ax.figure.colorbar(
        drawn,
        ax=ax,
        label=label,
        **{"fraction": 0.06, "pad": 0.02, "aspect": 30, **how},
    )
    dress(bar.ax)
    bar.outline.set_visible(False)
    used: Any = np.ma.masked_invalid(np.ma.asarray(drawn.get_array()))
    if rest is not None and (used != rest).any():
        limits = min(rest, float(used.min())), max(rest, float(used.max()))
        (bar.ax.set_xlim if bar.orientation == "horizontal" else bar.ax.set_ylim)(
            limits
        )
    return bar
