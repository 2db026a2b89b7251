"""One look for all figures: fonts, colours, the diverging colour map, dressed axes.

The colour map runs from dark blue over grey to light yellow. Blue and yellow differ for every
common kind of colour-blindness, and the lightness rises all the way, so that a print in grey still
tells push from pull; paper stays white, so that a gap differs from a rod at rest.
"""

from __future__ import annotations

from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure

FONT = "DejaVu Sans"  # comes with matplotlib and has every sign used here
INK, FAINT = "#1a1a1a", "#8a8a8a"
WALL, MASS = "#d9d9d9", "#33302e"
SERIES = ("#20409a", "#c77700", "#6b6b6b", "#117733", "#882255")
DASHES = ("-", "--", "-.", ":", (0, (6, 2, 1, 2, 1, 2)))
SMALL, NORMAL = 7.0, 9.0

styled = rc_context({"font.family": [FONT], "font.size": NORMAL, "axes.titlesize": NORMAL,
                     "axes.labelsize": NORMAL, "text.color": INK, "axes.labelcolor": INK,
                     "text.usetex": False, "figure.facecolor": "white",
                     "axes.facecolor": "white", "axes.edgecolor": FAINT,
                     "axes.unicode_minus": True,
                     "axes.formatter.useoffset": False})
"""Decorator: what a function draws has the style, whatever the user's settings."""

DIVERGING = LinearSegmentedColormap.from_list(
    "rodimpact", ["#16256e", "#53659f", "#a0a0a0", "#d6c05f", "#ffe94a"]
)


def centred(values: Any, rest: float = 0.0) -> Normalize:
    """Colour limits symmetric about the value of rest."""
    reach = max((abs(float(v) - rest) for v in values), default=0.0) or 1.0
    return Normalize(rest - reach, rest + reach)


def ink_on(norm: Normalize, value: float) -> str:
    """Colour of text that can be read on the colour of `value`."""
    red, green, blue, _ = DIVERGING(norm(value))
    return "white" if 0.3 * red + 0.59 * green + 0.11 * blue < 0.45 else INK


def new_figure(width: float, height: float) -> Figure:
    """Figure of a size in inches that pyplot does not keep."""
    return Figure(figsize=(width, height), layout="constrained")


def new_axes(width: float, height: float) -> Axes:
    """Axes of a new figure."""
    return new_figure(width, height).add_subplot()


def dress(ax: Axes) -> None:
    """Ticks and frame of an Axes."""
    ax.tick_params(labelsize=NORMAL - 1, labelfontfamily=FONT, labelcolor=INK, color=FAINT,
                   length=3)
    for side, spine in ax.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(FAINT)
