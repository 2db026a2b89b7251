"""The plane of two numbers of a case: e by formula, and borders between formulas."""

from collections.abc import Sequence
from contextlib import suppress

import numpy as np
from matplotlib import artist, collections, colors
from matplotlib.axes import Axes
from numpy.typing import NDArray

from ..algebra.atlas import Atlas
from ..model import System
from ..model.arguments import check_kind
from ..results.labels import quantity_of_parameter
from .labels import wrap_words
from .panels import (
    Picture,
    add_colour_bar,
    axes_or_new,
    draw_cells,
    format_axes,
    size_in_points,
)
from .sampling import middles
from .scales import Scale, engineering, scale_of
from .style import RISING, SMALL, colours, styled

CELLS_PER_SIDE = 160  # cells of e in the picture, along x and y
MAX_FORMULAS = 3  # formulas that are written below the picture
MAX_LETTERS = 64  # length at which a formula is cut off
FORMULA_WIDTH = 0.95  # width of a line of formulas, in widths of the Axes
ONE_ATOL = 1e-9  # difference of e from 1 that counts as none
DERIVED_UNITS = {"transit_time": "s", "impedance": "kg/s"}

# Kinds of border points
OTHER_FORMULA = 0  # only the formula of e changes there
OTHER_CONTACTS = 1  # the contacts that happen change too
E_IS_ONE = 2  # e = 1 there
BORDER_NAMES = ("another formula", "other contacts", "e = 1")


@styled
def atlas(plane: Atlas, ax: Axes | None = None) -> Picture:
    """Draw the regions of a plane: e from formulas, and the changes at their borders.

    The largest regions are numbered, and their formulas are written below; both are
    left out without the extra ``sympy``.

    Parameters
    ----------
    plane : Atlas
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
    check_kind("plane", plane, Atlas, "rodimpact.atlas(...)")

    # What is measured.
    scales = []
    edges = []
    for path, low, high in (plane.x, plane.y):
        scales.append(_scale(plane.system, path, max(abs(low), abs(high))))
        edges.append(np.linspace(low, high, CELLS_PER_SIDE + 1))
    cell_x, cell_y = np.meshgrid(middles(edges[0]), middles(edges[1]))
    e = plane.restitution(cell_x, cell_y)  # [y, x]
    least = 0.0
    if np.isfinite(e).any():
        least = float(np.nanmin(e))
    kinds = _border_kinds(plane)

    # What is drawn.
    ax = axes_or_new(ax, width=5.6, height=4.2)
    x = edges[0] * scales[0].factor
    y = edges[1] * scales[1].factor
    top = max(1.0, least + 1e-3)  # colours need a range above 0
    norm = colors.Normalize(least, top)
    missing = "no value, or unresolved"
    cells = draw_cells(ax, (x, y), e.T, RISING, norm, missing)
    borders = _draw_borders(ax, plane, scales, kinds)
    with suppress(ImportError):  # formulas need sympy
        _write_formulas(ax, plane, scales)
    bar = add_colour_bar(ax, cells.mesh, "coefficient of restitution e")
    named: list[artist.Artist | None] = [*borders, cells.missing]
    format_axes(
        ax,
        named,
        xlim=x[[0, -1]],
        ylim=y[[0, -1]],
        xlabel=scales[0].label,
        ylabel=scales[1].label,
    )
    return Picture(ax=ax, cells=cells.mesh, borders=borders, colour_bar=bar)


def _border_kinds(plane: Atlas) -> NDArray[np.int_]:
    """Kind of each border point: OTHER_FORMULA, OTHER_CONTACTS or E_IS_ONE.

    It is E_IS_ONE where the formula of a region beside the point gives e = 1 there.
    Otherwise it is OTHER_CONTACTS if the regions on both sides are resolved and differ
    in their contacts.
    """
    contacts = dict(enumerate(plane.contacts))  # by region; an unresolved one is -1
    kinds = np.full(len(plane.between), OTHER_FORMULA)
    # The two regions on both sides of each border point
    for border, regions in enumerate(plane.between.tolist()):
        one_side = contacts.get(regions[0])
        other_side = contacts.get(regions[1])
        are_resolved = one_side is not None and other_side is not None
        if are_resolved and one_side != other_side:
            kinds[border] = OTHER_CONTACTS
    # All cells of a region have one formula: the last one stands for the others.
    cell_of_region = {region: i for i, region in enumerate(plane.region)}
    for region, i in cell_of_region.items():
        is_beside = (plane.between == region).any(axis=1)
        its_borders = np.flatnonzero(is_beside)
        cell = plane.cells[i]
        e = cell.restitution(*plane.borders[its_borders].T)
        is_one = np.abs(e - 1) < ONE_ATOL
        kinds[its_borders[is_one]] = E_IS_ONE
    return kinds


def _draw_borders(
    ax: Axes, plane: Atlas, scales: Sequence[Scale], kinds: NDArray[np.int_]
) -> list[collections.LineCollection]:
    """Draw the borders, one collection of lines for each kind of border that occurs.

    `kinds` are those of the border points. Lines are thin where only the formula
    changes, thick for other kinds, and have another colour where e = 1.
    """
    factors = [scale.factor for scale in scales]
    lines = plane.lines * factors
    styles = {  # width, points, and colour
        OTHER_FORMULA: (0.8, colours().ink),
        OTHER_CONTACTS: (2.0, colours().ink),
        E_IS_ONE: (2.0, colours().series[4]),
    }
    kind_of_line = kinds[plane.of_line]  # kind of a border point on each line
    drawn = []
    for kind, style in styles.items():
        width, colour = style
        segments = lines[kind_of_line == kind]
        if len(segments):
            border = collections.LineCollection(
                segments,
                colors=colour,
                label=BORDER_NAMES[kind],
                zorder=3 + kind,
                linewidths=width,
            )
            ax.add_collection(border)
            drawn.append(border)
    return drawn


def _write_formulas(ax: Axes, plane: Atlas, scales: Sequence[Scale]) -> None:
    """Number the `MAX_FORMULAS` largest regions, and write their formulas below.

    A formula longer than `MAX_LETTERS` is cut at a space. ImportError is raised if
    there is no sympy.
    """
    room = FORMULA_WIDTH * size_in_points(ax)[0]
    formulas = []
    for number, region in enumerate(plane.largest(MAX_FORMULAS), 1):
        x, y = region.place
        ax.text(
            x * scales[0].factor,
            y * scales[1].factor,
            str(number),
            ha="center",
            va="center",
            color=colours().ink,
            zorder=6,
            bbox={
                "boxstyle": "circle",
                "facecolor": colours().paper,
                "edgecolor": "none",
            },
        )
        formula = region.formula
        if len(formula) > MAX_LETTERS:
            whole_words, _, _ = formula[:MAX_LETTERS].rpartition(" ")
            formula = whole_words + " ..."
        formulas.append(wrap_words(f"{number}: {formula}", room, SMALL))
    ax.annotate(
        "\n".join(formulas),
        xy=(0, 0),
        xytext=(0, -34),  # below the label of the axis
        xycoords="axes fraction",
        textcoords="offset points",
        va="top",
        fontsize=SMALL,
    )


def _scale(system: System, path: str, largest: float) -> Scale:
    """Scale of the axis of the number at a path, for values up to `largest`.

    A path may end in a number that follows from others, a key of `DERIVED_UNITS`.
    """
    body, _, number = path.rpartition(".")
    if number in DERIVED_UNITS:
        name = number.replace("_", " ")
        return engineering(f"{name} of {body}", largest, DERIVED_UNITS[number])
    return scale_of(quantity_of_parameter(system, path), largest)
