"""A family of collisions: a curve over one axis, a map over two; theory if it exists.

Results can jump: the force duration where the impedances are equal, velocities where
the number of contacts changes. Curves and contour lines are interrupted at a jump:
there neighbouring values differ far more than around it. On a map each collision is a
cell of one colour, without interpolation. Each count has its own colour; counts have no
contour lines.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib import artist, colors, contour, patches, patheffects, ticker
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from ..hints import nearest
from ..methods.signals import Floats
from ..model.arguments import array, check_kind, check_text
from ..model.frozen import invalid_argument
from ..results.labels import quantity_of_column
from ..results.pair_theory import COLUMNS, PairTheory, pair_theory
from ..running.columns import STATUS
from ..running.sweep_result import SweepResult
from ..storage.grids import Varied
from ..units import shown as in_few_words
from .contours import draw_contours, label_contours
from .family_axes import FamilyAxis, check_varied, family_axis, format_family_axis
from .jumps import broken_at_jumps
from .panels import (
    Draft,
    Picture,
    add_colour_bar,
    add_grid,
    axes_or_new,
    draw_cells,
    finish,
    format_axes,
)
from .scales import MINUS, NEGLIGIBLE_RTOL, Scale, engineering, scale_of
from .style import COMPUTED, RISING, SMALL, centred, colours, styled

MAX_TICKED_NUMBERS = 5  # numbers along a map up to which each has a tick
MAX_MARKED_POINTS = 40  # points of a curve up to which each has a mark
CLOSED_FORM = "closed form"
"""Name of the curve of a closed form in a legend."""
MIN_THEORY_POINTS = 400  # points of a closed form's curve
HISTOGRAM_WIDTH = 0.22  # width of a histogram, in widths of the Axes
EQUAL_RTOL_DIGITS = 12  # decimals of the logarithm of a ratio


class Equality(NamedTuple):
    """A line of a map on which a number of both rods is equal."""

    name: str
    number: str  # name of a field of `PairTheory`
    dashes: Any


EQUALITIES = (
    Equality("equal transit times: e = 1", "transit_time", "-"),
    Equality("equal impedances", "impedance", "--"),
)


class ShownQuantity(NamedTuple):
    """What is drawn, in the unit of the scale."""

    name: str  # name of the column
    values: Floats
    scale: Scale
    is_count: bool

    @property
    def words(self) -> tuple[str, ...]:
        """Meanings of the values 0, 1, ... of a column of codes; () for other columns.

        The columns of codes are "final" and "status".
        """
        if self.name == "final":
            return ("not proved", "proved")
        if self.name == "status":
            return STATUS
        return ()

    @property
    def low(self) -> float:
        """Least value."""
        return float(np.nanmin(self.values))

    @property
    def high(self) -> float:
        """Largest value."""
        return float(np.nanmax(self.values))


@styled
def sweep(
    result: SweepResult,
    ax: Axes | None = None,
    quantity: str = "restitution",
    varied: Sequence[Varied] | None = None,
    *,
    label: str | None = None,
) -> Picture:
    """Draw a quantity of a family of collisions: a curve over one axis, a map over two.

    An axis is logarithmic if its values are closer to a geometric than to an arithmetic
    sequence. Collisions without a value leave gaps. The closed form for two uniform
    bodies without initial vibration is drawn under the curve. Members in no order,
    such as samples of several uncertain numbers, are drawn as points, beside a
    histogram of their values. On a map of two such rods a full line marks equal transit
    times, where e = 1; a dashed line marks equal impedances, where the force duration
    jumps.

    Parameters
    ----------
    result : SweepResult
    ax : Axes, optional
        By default the Axes of a new figure.
    quantity : str
        A name of ``result.columns``, such as ``"restitution"``, ``"duration.0"`` of
        contact 0 or ``"velocity_after.1"`` of body 1.
    varied : sequence of Varied, optional
        What the user varied along each axis, as the `varied` of a case from
        `read_case`: it names the axes. By default they bear the names of the numbers in
        which the systems differ.
    label : str, optional
        Name of a curve in the legend. Several curves on the same `ax` have colours of
        their own, and are all named; by default "computed", "family 2", ...

    Returns
    -------
    Picture
        Over one axis with the curve `values` and the closed form `theory` or None; of
        members in no order with the points `values` and the `histogram`; over two axes
        with `cells`, `contours` or None, their `labels`, the lines `theory` and
        `colour_bar`.

    Raises
    ------
    ValueError
        If the quantity is unknown or has no value in this family, if the family does
        not have one or two axes (axes with a single value do not count), or if it has
        two and the members along one of them are in no order.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod([0.2, 0.4, 0.8], area=1e-4, material=steel, velocity=1.0)
    >>> family = ri.sweep(ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)]))
    >>> ri.plot.sweep(family, quantity="velocity_after.1").ax.get_xlabel()
    'length of rod 1 (m)'
    """
    # What is measured.
    column = _column(result, quantity)
    if label is not None:
        check_text("label", label, "rounded ends")
    names = check_varied(result, varied)
    varied_axes = [i for i, count in enumerate(result.shape) if count > 1]
    if not 1 <= len(varied_axes) <= 2:
        raise invalid_argument(
            "result",
            f"has shape {result.shape}, but a curve has one axis and a map two; give "
            "an array for one or two numbers of the system, such as "
            "length=np.linspace(0.1, 1, 50), or draw part of the family, such as "
            "sweep(system[0])",
        )
    axes = [family_axis(result, i, names) for i in varied_axes]
    shape = [axis.order.size for axis in axes]  # without the axes of one value
    index_of_sorted = np.ix_(*(axis.order for axis in axes))

    def arranged(table: NDArray[Any]) -> NDArray[Any]:
        """Numbers of the members, in the order in which the values of axes increase."""
        return table.reshape(shape)[index_of_sorted]

    values = arranged(column).astype(float)
    largest = float(np.nanmax(np.abs(values)))
    described = quantity_of_column(result.system, quantity)
    scale = scale_of(described, largest)
    if described.unit == "m":  # a set or a displacement, in mm as in tables
        scale = engineering(described.name, largest, "m")
    is_count = column.dtype.kind in "iub"  # integers and booleans
    shown = ShownQuantity(quantity, values * scale.factor, scale, is_count)
    theory = None
    if quantity in COLUMNS:
        closed_form = pair_theory(result.system)
        if closed_form is not None:
            theory = closed_form.mapped(arranged)

    # What is drawn.
    if len(axes) == 2:
        for axis, dimension in zip(axes, varied_axes, strict=True):
            if not axis.is_ordered:
                raise invalid_argument("result", _why_no_map(result, dimension))
        return _draw_map(axes_or_new(ax, width=6.0, height=4.6), axes, shown, theory)
    if not axes[0].is_ordered:
        return _draw_scatter(axes_or_new(ax, width=5.6, height=3.6), axes[0], shown)
    ax = axes_or_new(ax, width=5.6, height=3.6)
    return _draw_curve(ax, axes[0], shown, theory, label)


def _column(result: SweepResult, quantity: str) -> NDArray[Any]:
    """The column of a quantity, as it is in `result.columns`.

    InvalidModel is raised if `result` is no SweepResult, no column has this name, or
    all values of the column are NaN or infinite.
    """
    check_kind("result", result, SweepResult, "rodimpact.sweep(family)")
    if not isinstance(quantity, str) or quantity not in result.columns:
        raise invalid_argument(
            "quantity",
            f"no result is called {in_few_words(quantity)}; "
            f"{nearest(quantity, result.columns)}",
        )
    column: NDArray[Any] = result.columns[quantity]
    if not np.isfinite(column).any():
        raise invalid_argument(
            "quantity",
            f"{quantity!r} has no value anywhere in this family; "
            "result.explain(index) says why",
        )
    return column


def _why_no_map(result: SweepResult, dimension: int) -> str:
    """Error message for a map if members along a dimension are in no order.

    The remedy is a picture of part of the family, such as ``system[0, :]``.
    """
    index = ["0"] * len(result.shape)
    index[dimension] = ":"
    return (
        f"has members in no order along axis {dimension}, where several numbers vary "
        "independently, and a map would be noise; draw them as points with a "
        f"histogram, such as plot.sweep(rodimpact.sweep(system[{', '.join(index)}]))"
    )


# Over one axis ------------------------------------------------------------------------


def _draw_curve(
    ax: Axes,
    axis: FamilyAxis,
    shown: ShownQuantity,
    theory: PairTheory | None,
    label: str | None,
) -> Picture:
    """Draw values over one axis as a curve, counts as steps; return the Picture.

    The closed form is drawn under the curve, as a wide line. Up to `MAX_MARKED_POINTS`
    values have marks, which no line joins if there is a closed form. The vertical axis
    includes 0. If the Axes has curves already, the new one has another colour, both
    axes still include the earlier curves, and a legend names all of them.
    """
    earlier_curves = [each for each in _named(ax) if each.get_label() != CLOSED_FORM]
    colour = colours().ink
    name = "computed"
    if earlier_curves:
        first, _, *others = colours().series  # the second is that of closed forms
        cycle = [first, *others]
        colour = cycle[(len(earlier_curves) - 1) % len(cycle)]
        name = f"family {len(earlier_curves) + 1}"
    if label is not None:
        name = label
    low_before, high_before = ax.get_xlim()
    format_family_axis(ax.xaxis, axis)  # sets the limits to those of this family
    if earlier_curves:
        low, high = ax.get_xlim()
        ax.set_xlim(min(low_before, low), max(high_before, high))
    closed_form = None
    if theory is not None:
        closed_form = _draw_closed_form(ax, axis, shown, theory)
    drawn: Line2D | patches.StepPatch
    if shown.is_count:
        drawn = ax.stairs(
            shown.values,
            axis.edges,
            baseline=None,
            color=colour,
            linewidth=1.4,
            label=name,
        )
        _set_count_ticks(ax.yaxis, shown)
    else:
        broken = broken_at_jumps(axis.numbers, shown.values)
        style = COMPUTED | {"label": name}
        linestyle = "-"
        if axis.values.size > MAX_MARKED_POINTS:
            # Marks are moved to whole pixels, so that many of them make a line jagged.
            # Only values through which no line goes have one.
            style.update(marker=".", markersize=0.8, markevery=_alone(broken.y))
        elif closed_form is not None:
            linestyle = ""  # marks only
        (drawn,) = ax.plot(
            broken.x,
            broken.y,
            color=colour,
            linewidth=1.2,
            linestyle=linestyle,
            **style,
        )
    named: list[artist.Artist] = []
    if closed_form is not None or label is not None or earlier_curves:
        named = _named(ax)
    if earlier_curves:
        ax.autoscale(axis="y")  # the limits were fixed when the first curve was drawn
    low, high = ax.get_ylim()
    add_grid(ax)
    format_axes(
        ax, named, ylabel=shown.scale.label, ylim=(min(0.0, low), max(0.0, high))
    )
    return Picture(ax=ax, values=drawn, theory=closed_form)


def _alone(values: Floats) -> list[int]:
    """Indices of finite values whose neighbours are NaN: no line goes through them."""
    # A NaN is added at both ends, so that each value has two neighbours.
    is_value = np.isfinite(np.pad(values, 1, constant_values=math.nan))
    has_neighbour = is_value[:-2] | is_value[2:]
    return np.flatnonzero(is_value[1:-1] & ~has_neighbour).tolist()


def _named(ax: Axes) -> list[artist.Artist]:
    """Artists of an Axes that have names; only the first of several closed forms."""
    artists, names = ax.get_legend_handles_labels()
    named: list[artist.Artist] = []
    for each, name in zip(artists, names, strict=True):
        names_so_far = [other.get_label() for other in named]
        is_again = name == CLOSED_FORM and name in names_so_far
        if not is_again:
            named.append(each)
    return named


def _draw_closed_form(
    ax: Axes, axis: FamilyAxis, shown: ShownQuantity, theory: PairTheory
) -> Line2D:
    """Draw the closed form as a wide line, also between the values of the family.

    Each interval between two members is divided into equal steps of the value, or of
    its logarithm if all values are positive, with at least `MIN_THEORY_POINTS` steps in
    all. The line is interrupted where it jumps.
    """
    is_positive = axis.values[0] > 0  # the first value is the least
    intervals = axis.values.size - 1
    members = axis.values
    if is_positive:
        members = np.log(members)
    parts = math.ceil(MIN_THEORY_POINTS / intervals)  # steps of each interval
    # Index of each point among the members: 0, 1/parts, 2/parts, ..., intervals
    fine_index = np.arange(intervals * parts + 1) / parts
    wanted = np.interp(fine_index, np.arange(intervals + 1), members)
    family = theory.interpolated(members, wanted)
    values = family.column(shown.name) * shown.scale.factor
    x = wanted
    if is_positive:
        x = np.exp(wanted)
    broken = broken_at_jumps(x * axis.scale.factor, values)
    (closed_form,) = ax.plot(
        broken.x,
        broken.y,
        color=colours().series[1],
        alpha=0.45,
        linewidth=5.0,
        solid_capstyle="butt",
        label=CLOSED_FORM,
    )
    return closed_form


def _draw_scatter(ax: Axes, axis: FamilyAxis, shown: ShownQuantity) -> Picture:
    """Draw members in no order as points, and to their right a histogram of the values.

    The histogram has horizontal bars on an Axes of its own, which shares the axis of
    values. Counts have one bar each.
    """
    format_family_axis(ax.xaxis, axis)
    (points,) = ax.plot(
        axis.numbers,
        shown.values,
        linestyle="",
        marker=".",
        markersize=3.0,
        color=colours().ink,
        alpha=0.6,
    )
    add_grid(ax)
    format_axes(ax, ylabel=shown.scale.label)
    # left, bottom, width and height of the histogram, in widths and heights of `ax`
    bars = ax.inset_axes((1.04, 0.0, HISTOGRAM_WIDTH, 1.0), sharey=ax)
    values = shown.values[np.isfinite(shown.values)]
    bins: Any = "auto"
    if shown.is_count:
        # borders from half a count below the least to half a count above the largest
        bins = np.arange(shown.low - 0.5, shown.high + 1.0)
        _set_count_ticks(ax.yaxis, shown)
    _, _, histogram = bars.hist(  # the numbers and borders of the bins are not needed
        values, bins, orientation="horizontal", color=colours().series[0], alpha=0.6
    )
    format_axes(bars, xlabel="members")
    bars.xaxis.set_major_locator(ticker.MaxNLocator(2, integer=True))
    bars.tick_params(labelleft=False)
    return Picture(ax=ax, values=points, theory=None, histogram=histogram)


# Over two axes ------------------------------------------------------------------------


def _draw_map(
    ax: Axes, axes: list[FamilyAxis], shown: ShownQuantity, theory: PairTheory | None
) -> Picture:
    """Draw values over two axes as coloured cells, the first axis to the right.

    Values that differ have contour lines, unless they are counts. The map of two rods
    with a closed form has the lines of `EQUALITIES` that cross it. A colour bar stands
    beside the map, and a legend above it names the lines and the cells without a value.
    """
    palette, norm = _map_colours(shown)
    cells = draw_cells(ax, [axis.edges for axis in axes], shown.values, palette, norm)
    for axis, family in zip((ax.xaxis, ax.yaxis), axes, strict=True):
        format_family_axis(axis, family)
        _set_ticks_at_few_numbers(axis, family)
    contours = None
    span = shown.high - shown.low
    largest_absolute = max(-shown.low, shown.high)
    varies = span > NEGLIGIBLE_RTOL * largest_absolute
    if not shown.is_count and varies:
        grid = (axes[0].numbers, axes[1].numbers)
        contours = draw_contours(ax, grid, shown.values, palette, norm)
    lines: list[contour.QuadContourSet] = []
    named: list[artist.Artist | None] = []
    # A wall or a rigid mass has an infinite impedance: both bodies must be rods.
    if theory is not None and np.isfinite(theory.impedance).all():
        for equality in EQUALITIES:
            line = _draw_equality(ax, axes, shown, theory, equality)
            if line is not None:
                lines.append(line)
                named.append(_equality_line(equality))
    bar = add_colour_bar(ax, cells.mesh, shown.scale.label)
    if shown.is_count:
        _set_count_ticks(bar.ax.yaxis, shown)
    named.append(cells.missing)  # None if all cells have values
    format_axes(ax, named)
    picture = Picture(
        ax=ax,
        cells=cells.mesh,
        contours=contours,
        labels=[],
        theory=lines,
        colour_bar=bar,
    )

    def write_words() -> None:
        """Write values into the contour lines, clear of the lines of `EQUALITIES`."""
        if contours is not None:
            picture.labels = label_contours(ax, contours, lines)

    return finish(Draft(picture, write_words))


def _set_ticks_at_few_numbers(axis: Axis, family: FamilyAxis) -> None:
    """Put the ticks of a map at its numbers if they are few and lie far apart.

    Few are up to `MAX_TICKED_NUMBERS`; their cells are so wide that matplotlib's ticks
    would lie between the numbers. A logarithmic axis keeps its ticks.
    """
    numbers = family.numbers
    if family.is_log or numbers.size > MAX_TICKED_NUMBERS:
        return
    spacings = np.abs(np.diff(numbers))
    # Labels have room if each spacing is at least the range over MAX_TICKED_NUMBERS.
    if np.all(spacings * MAX_TICKED_NUMBERS >= np.ptp(numbers)):
        axis.set_major_locator(ticker.FixedLocator(numbers.tolist()))


class _MapColours(NamedTuple):
    """Colours of a map and their limits."""

    palette: colors.Colormap
    norm: colors.Normalize


def _map_colours(shown: ShownQuantity) -> _MapColours:
    """Colours and limits of a map.

    Counts and codes have one colour each; codes that do not occur have one, too. Values
    of both signs have limits symmetric about 0. Values of one sign have limits from the
    least to the largest; if all are equal, one of the limits is 0. If all values are 0,
    the limits are 0 and 1.
    """
    low = shown.low
    high = shown.high
    if shown.words:  # all codes have a colour, also those that do not occur
        low = 0.0
        high = len(shown.words) - 1.0
    if shown.is_count:  # also codes
        # From half a count below the least to half a count above the largest.
        borders = np.arange(low - 0.5, high + 1.0)
        count = borders.size - 1
        return _MapColours(RISING.resampled(count), colors.BoundaryNorm(borders, count))
    largest_absolute = max(-low, high)
    negligible = NEGLIGIBLE_RTOL * largest_absolute
    has_both_signs = low < -negligible and high > negligible
    if has_both_signs:
        return _MapColours(colours().signed, centred((low, high)))
    if high - low <= negligible:  # one value: its colour shows how far it is from 0
        low = min(low, 0.0)
        high = max(high, 0.0)
    if high <= low:  # all are 0
        high = low + 1.0
    return _MapColours(RISING, colors.Normalize(low, high))


def _draw_equality(
    ax: Axes,
    axes: list[FamilyAxis],
    shown: ShownQuantity,
    theory: PairTheory,
    equality: Equality,
) -> contour.QuadContourSet | None:
    """Draw the line on which a number of both rods is equal, if it crosses the map.

    The line is the contour 0 of the logarithm of the ratio of the two numbers. None is
    returned if this logarithm has one sign everywhere. Where the map has no value, the
    line is left out.
    """
    of_left, of_right = getattr(theory, equality.number)
    # Rounded, so that round-off of equal numbers has no sign.
    log_ratio = np.round(np.log(np.divide(of_left, of_right)), EQUAL_RTOL_DIGITS)
    log_ratio = np.where(np.isfinite(shown.values), log_ratio, np.nan)
    has_both_signs = (log_ratio < 0).any() and (log_ratio > 0).any()
    if not has_both_signs:
        return None
    line = ax.contour(
        axes[0].numbers,
        axes[1].numbers,
        np.ma.masked_invalid(log_ratio.T),  # matplotlib takes [y, x]
        levels=[0.0],
        colors=colours().ink,
        linewidths=1.4,
        linestyles=equality.dashes,
        zorder=4,
    )
    # A border in the colour of the paper makes the line visible on dark cells.
    casing = patheffects.withStroke(linewidth=2.6, foreground=colours().paper)
    line.set_path_effects([casing])
    return line


def _equality_line(equality: Equality) -> Line2D:
    """Legend entry of an equality: a line without points, with its dashes and name."""
    return Line2D(
        [],
        [],
        color=colours().ink,
        linewidth=1.4,
        linestyle=equality.dashes,
        label=equality.name,
    )


def _set_count_ticks(axis: Axis, shown: ShownQuantity) -> None:
    """Set ticks at whole numbers; ticks of codes bear their meanings in words.

    The words are those of `words`, with a tick for each code. Other counts have up to
    12 ticks.
    """
    if shown.words:
        axis.set_ticks(range(len(shown.words)), shown.words)
    else:
        axis.set_major_locator(ticker.MaxNLocator(12, integer=True))
        axis.set_minor_locator(ticker.NullLocator())


# Against the law ----------------------------------------------------------------------


@styled
def restitution(
    ratios: ArrayLike, values: ArrayLike, ax: Axes | None = None
) -> Picture:
    """Draw computed e against the law e = l1/l2, and note the largest residual.

    The law holds for two rods of one material and cross-section, the second at rest
    inside and longer than the first.

    Parameters
    ----------
    ratios : array_like
        Shorter length divided by longer length, l1/l2.
    values : array_like, same shape
        Computed e; NaN, for a collision without one, is left out.
    ax : Axes, optional
        By default the Axes of a new figure.

    Returns
    -------
    Picture
        With `law`, `points` and the text `residual`.

    Raises
    ------
    ValueError
        If the shapes differ, or no value is a number.

    Examples
    --------
    >>> import rodimpact as ri
    >>> picture = ri.plot.restitution([0.2, 0.5], [0.2, 0.5])
    >>> picture.points.get_ydata().tolist()
    [0.2, 0.5]
    """
    x = array("ratios", ratios, "")
    e = array("values", values, "")
    if x.shape != e.shape:
        raise invalid_argument(
            "values", f"must have the shape {x.shape} of ratios, got {e.shape}"
        )
    is_known = np.isfinite(x) & np.isfinite(e)  # the others are left out
    if not is_known.any():
        raise invalid_argument(
            "values", "needs at least one finite coefficient of restitution, got none"
        )
    x = x[is_known]
    e = e[is_known]
    x_limit = max(1.0, float(x.max()))
    e_limit = max(x_limit, 1.05 * float(e.max()))
    largest_residual = np.abs(e - x).max()  # the law is e = x

    ax = axes_or_new(ax, width=4.2, height=4.0)
    (law,) = ax.plot(
        [0, x_limit],
        [0, x_limit],
        color=colours().series[1],
        linewidth=1.2,
        label="e = ℓ₁/ℓ₂",
    )
    (points,) = ax.plot(
        x,
        e,
        linestyle="",
        color=colours().ink,
        clip_on=False,  # marks on the frame are whole
        zorder=3,
        **COMPUTED,
    )
    residual = ax.text(
        0.98,
        0.04,
        f"largest |e {MINUS} ℓ₁/ℓ₂| = {largest_residual:.1e}\nin {e.size} collisions",
        transform=ax.transAxes,
        ha="right",
        va="bottom",
        fontsize=SMALL + 1,
    )
    add_grid(ax)
    ax.legend(loc="upper left", frameon=False, fontsize=SMALL + 1)
    format_axes(
        ax,
        xlim=(0, x_limit),
        ylim=(0, e_limit),
        aspect="equal",
        xlabel="ratio of lengths ℓ₁/ℓ₂",
        ylabel="coefficient of restitution e",
    )
    return Picture(ax=ax, law=law, points=points, residual=residual)
