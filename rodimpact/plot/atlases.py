"""The plane of two numbers of a case: e by formula, and the exact borders between the formulas."""

from contextlib import suppress
from textwrap import wrap

import numpy as np
from matplotlib import collections, colors
from matplotlib.axes import Axes

from ..algebra.atlas import Atlas
from ..model import System
from ..model.arguments import of_kind
from ..results.labels import parameter
from . import style
from .scales import Scale, engineering, scale_of

MESH = 160  # places a side at which the formulas are evaluated for colours
NAMED, SHORT = (
    3,
    64,
)  # regions whose formulas stand in the picture, and characters of them
WHOLE = 1e-9  # of e: as good as 1
DERIVED = {"transit_time": ("transit time", "s"), "impedance": ("impedance", "kg/s")}


@style.styled
def atlas(found: Atlas, ax: Axes | None = None) -> style.Picture:
    """Draw the regions of a plane: e from their formulas, and the changes at their borders.

    The largest regions are numbered, and their formulas are written below (extra ``sympy``).

    Parameters
    ----------
    found : Atlas
        From `rodimpact.atlas`, for a system with one contact that can open.
    ax : Axes, optional
        By default the Axes of a new figure.

    Returns
    -------
    Picture
        With the `cells` of e, the `borders` by the kind of change, and `colour_bar`.

    Examples
    --------
    >>> import rodimpact as ri
    >>> left = ri.Rod(1.0, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(2.0, area=1e-4, material=ri.materials.steel)
    >>> plane = ri.atlas(ri.System([left, right]),
    ...                  ("bodies.0.length", 0.5, 1.5), ("bodies.1.length", 1.6, 3.0))
    >>> picture = ri.plot.atlas(plane)
    >>> [float(x) for x in picture.ax.get_xlim()]
    [0.5, 1.5]
    """
    of_kind("found", found, Atlas, "rodimpact.atlas(...)")
    ax = style.axes(ax, 5.6, 4.2)
    scales = [_scale(found.system, *axis) for axis in (found.x, found.y)]
    edges = [np.linspace(low, high, MESH + 1) for _, low, high in (found.x, found.y)]
    middles = np.meshgrid(*((edge[1:] + edge[:-1]) / 2 for edge in edges))
    e = found.restitution(*middles)
    x, y = (edge * scale.factor for edge, scale in zip(edges, scales, strict=True))
    low = float(np.nanmin(e)) if np.isfinite(e).any() else 0.0
    cells, without = style.cells(
        ax,
        (x, y),
        e.T,
        style.RISING,
        colors.Normalize(low, max(1.0, low + 1e-3)),
        "no value, or unresolved",
    )
    lines = found.lines * [scale.factor for scale in scales]
    # what changes at the places of the borders: 0 the formula alone, 1 contacts, 2 at e = 1
    contacts = dict(enumerate(found.contacts))
    pairs = [(contacts.get(a), contacts.get(b)) for a, b in found.between.tolist()]
    kinds = np.array(
        [None not in pair and pair[0] != pair[1] for pair in pairs], dtype=int
    )
    for region, i in {region: i for i, region in enumerate(found.region)}.items():
        here = np.flatnonzero((found.between == region).any(axis=1))
        kinds[
            here[np.abs(found.cells[i].restitution(*found.borders[here].T) - 1) < WHOLE]
        ] = 2
    drawn, ink = [], style.colours().ink
    for kind, (what, width, colour) in enumerate(
        (
            ("another formula", 0.8, ink),
            ("other contacts", 2.0, ink),
            ("e = 1", 2.0, style.colours().series[4]),
        )
    ):
        here = lines[kinds[found.of_line] == kind]
        if len(here):
            drawn.append(
                collections.LineCollection(
                    here, colors=colour, label=what, zorder=3 + kind, linewidths=width
                )
            )
            ax.add_collection(drawn[-1])
    with suppress(ImportError):  # formulas need sympy
        _name_largest(ax, found, scales)
    bar = style.colour_bar(ax, cells, "coefficient of restitution e")
    style.dress(
        ax,
        [*drawn, *without],
        xlim=x[[0, -1]],
        ylim=y[[0, -1]],
        xlabel=scales[0].label,
        ylabel=scales[1].label,
    )
    return style.Picture(ax=ax, cells=cells, borders=drawn, colour_bar=bar)


def _name_largest(ax: Axes, found: Atlas, scales: list[Scale]) -> None:
    """Number the largest regions, and write their formulas below."""
    paper, ink, *_ = style.colours()
    lines, letters = [], int(0.95 * style.extent(ax)[0] / (style.LETTER * style.SMALL))
    for number, region in enumerate(found.largest(NAMED), 1):
        x, y = (v * scale.factor for v, scale in zip(region.place, scales, strict=True))
        ax.text(
            x,
            y,
            str(number),
            ha="center",
            va="center",
            color=ink,
            zorder=6,
            bbox={"boxstyle": "circle", "facecolor": paper, "edgecolor": "none"},
        )
        text = region.formula
        text = text if len(text) <= SHORT else text[:SHORT].rsplit(" ", 1)[0] + " ..."
        lines += wrap(f"{number}: {text}", letters)
    ax.annotate(
        "\n".join(lines),
        (0, 0),
        (0, -34),
        "axes fraction",
        "offset points",
        va="top",
        fontsize=style.SMALL,
    )


def _scale(system: System, path: str, low: float, high: float) -> Scale:
    """Name and unit of an axis."""
    head, _, word = path.rpartition(".")
    largest = max(abs(low), abs(high))
    if word in DERIVED:
        name, unit = DERIVED[word]
        return engineering(f"{name} of {head}", largest, unit)
    return scale_of(parameter(system, path), largest)
