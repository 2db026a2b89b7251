"""A family of collisions: a curve over one axis, a map over two, and theory if it exists.

Results can jump: the force duration where the impedances are equal, velocities where the number of
contacts changes. Curves and contour lines are interrupted at a jump: there neighbouring values
differ far more than around it. On a map each collision is a cell of one colour, without
interpolation. Each count has its own colour; counts have no contour lines.
"""

from typing import Any, NamedTuple

import numpy as np
from matplotlib import artist, colors, contour, patches, patheffects, ticker
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.lines import Line2D
from matplotlib.text import Text
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import median_filter

from ..methods.signals import Floats
from ..model.arguments import array, of_kind
from ..model.frozen import nearest, refusal
from ..results.labels import outcome, parameter
from ..results.pair_theory import COLUMNS, PairTheory, pair_theory
from ..running.columns import STATUS
from ..running.sweep_result import SweepResult
from ..units import format_factor
from ..units import shown as shown_text
from . import style
from .scales import MINUS, ROUND_OFF, Scale, scale_of, signed

FEW = 40  # points of a curve that are marked
SMOOTH = 400  # points of a curve of theory, at least
AROUND = 7  # differences about one, itself among them, whose median is the usual difference there
LEAP = 8.0  # usual differences that a jump surpasses
SEEN = 0.02  # of a quantity's range: a smaller jump is not seen
PLATEAU = 3  # rows of points on which values equal: no line follows such a plateau
WIDE = 3.0  # last over first value from which an axis may be logarithmic
EQUALITIES: dict[str, tuple[Any, str]] = {
    "equal transit times: e = 1": ("-", "transit_time"),
    "equal impedances": ("--", "impedance"),
}
"""Lines of a map on which a number of both rods is equal: dashes, and the number."""


class Side(NamedTuple):
    """An axis of the family: the order in which its values increase, and these values."""

    order: NDArray[np.intp]
    values: Floats
    scale: Scale
    label: str  # with what varies along with it

    @property
    def numbers(self) -> Floats:
        """Numbers on the axis."""
        return self.values * self.scale.factor

    @property
    def is_log(self) -> bool:
        """Whether the values have a wide range and are spread more evenly by their logarithms."""
        first, last = self.values[[0, -1]]
        if self.values.size < 3 or first <= 0 or last < WIDE * first:
            return False
        steps, ratios = np.diff(self.values), np.diff(np.log(self.values))
        return bool(
            np.std(ratios) / np.mean(ratios) < np.std(steps) / np.mean(steps) / 2
        )

    @property
    def edges(self) -> Floats:
        """Borders half-way between the numbers and as far beyond the outer ones, not beyond 0."""
        x = np.log(self.numbers) if self.is_log else self.numbers
        middle = (x[:-1] + x[1:]) / 2
        edges = np.concatenate(
            ([2 * x[0] - middle[0]], middle, [2 * x[-1] - middle[-1]])
        )
        edges = np.exp(edges) if self.is_log else edges
        return np.maximum(edges, 0.0) if self.values[0] >= 0 else edges


class Shown(NamedTuple):
    """What is drawn, in the unit of the scale."""

    quantity: str
    values: Floats
    scale: Scale
    is_count: bool

    @property
    def words(self) -> tuple[str, ...]:
        """What the counts 0, 1, ... stand for, if they are no numbers."""
        return {"final": ("not proved", "proved"), "status": STATUS}.get(
            self.quantity, ()
        )


@style.styled
def sweep(
    result: SweepResult, ax: Axes | None = None, quantity: str = "restitution"
) -> style.Picture:
    """Draw one quantity of a family of collisions: a curve over one axis, a map over two.

    An axis is logarithmic if its values are closer to a geometric than to an arithmetic sequence.
    Collisions without a value leave gaps. For two uniform bodies without initial vibration the
    closed form is drawn under the curve. On a map of two such rods a full line marks equal transit
    times, where e = 1; a dashed line marks equal impedances, where the force duration jumps.

    Parameters
    ----------
    result : SweepResult
    ax : Axes, optional
        By default the Axes of a new figure.
    quantity : str
        A name of ``result.columns``, such as ``"restitution"``, ``"duration.0"`` of contact 0 or
        ``"velocity_after.1"`` of body 1.

    Returns
    -------
    Picture
        Over one axis with the curve `values` and the closed form `theory` or None; over two with
        `cells`, `contours` or None, their `labels`, the lines `theory` and `colour_bar`.

    Raises
    ------
    ValueError
        If the quantity is unknown or has no value in this family, or if the family does not have
        one or two axes; axes with a single value do not count.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod([0.2, 0.4, 0.8], area=1e-4, material=steel, velocity=1.0)
    >>> family = ri.sweep(ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)]))
    >>> ri.plot.sweep(family, quantity="velocity_after.1").ax.get_xlabel()
    'length of rod 1 (m)'
    """
    of_kind("result", result, SweepResult, "rodimpact.sweep(family)")
    if not isinstance(quantity, str) or quantity not in result.columns:
        raise refusal(
            "quantity",
            f"no result is called {shown_text(quantity)}; "
            f"{nearest(quantity, result.columns)}",
        )
    column: NDArray[Any] = result.columns[quantity]
    if not np.isfinite(column).any():
        raise refusal(
            "quantity",
            f"{quantity!r} has no value anywhere in this family; "
            "result.explain(index) says why",
        )
    wide = [i for i, count in enumerate(result.shape) if count > 1]
    if not 1 <= len(wide) <= 2:
        raise refusal(
            "result",
            f"has shape {result.shape}, but a curve has one axis and a map two; give an "
            "array for one or two numbers of the system, such as length=np.linspace(0.1, 1, 50), "
            "or draw part of the family, such as sweep(system[0])",
        )
    sides = [side_of(result, i) for i in wide]
    order = np.ix_(*(side.order for side in sides))

    def arranged(table: NDArray[Any]) -> NDArray[Any]:
        return table.reshape([side.order.size for side in sides])[order]

    values = arranged(column).astype(float)
    largest = float(np.nanmax(np.abs(values)))
    scale = scale_of(outcome(result.system, quantity), largest)
    family = pair_theory(result.system) if quantity in COLUMNS else None
    theory = None if family is None else family.each(arranged)
    shown = Shown(quantity, values * scale.factor, scale, column.dtype.kind in "iub")
    if len(sides) == 1:
        return _curve(style.axes(ax, 5.6, 3.6), sides[0], shown, theory)
    return _map(style.axes(ax, 6.0, 4.6), sides, shown, theory)


def _curve(
    ax: Axes, side: Side, shown: Shown, theory: PairTheory | None
) -> style.Picture:
    """Draw values over one axis."""
    _dress_side(ax.xaxis, side)
    ink = style.colours().ink
    law = None
    if theory is not None:  # a wide line, also between the values of the family
        rises, count = side.values[0] > 0, side.values.size - 1
        known = np.log(side.values) if rises else side.values
        parts = -(-SMOOTH // count)
        wanted = np.interp(
            np.arange(count * parts + 1) / parts, np.arange(count + 1), known
        )
        values = theory.along(known, wanted).column(shown.quantity) * shown.scale.factor
        x = (np.exp(wanted) if rises else wanted) * side.scale.factor
        (law,) = ax.plot(
            *_broken(x, values),
            color=style.colours().series[1],
            alpha=0.45,
            linewidth=5.0,
            solid_capstyle="butt",
            label="closed form",
        )
    drawn: Line2D | patches.StepPatch
    if shown.is_count:
        drawn = ax.stairs(
            shown.values, side.edges, baseline=None, color=ink, linewidth=1.4
        )
        _count_ticks(ax.yaxis, shown)
    else:
        few = side.values.size <= FEW
        marks: dict[str, Any] = {} if few else {"marker": ".", "markersize": 0.8}
        (drawn,) = ax.plot(
            *_broken(side.numbers, shown.values),
            color=ink,
            linewidth=1.2,
            linestyle="" if few and law else "-",
            **style.COMPUTED | marks,
        )
    low, high = ax.get_ylim()
    style.grid(ax)
    style.dress(
        ax,
        () if law is None else (law, drawn),
        ylabel=shown.scale.label,
        ylim=(min(0.0, low), max(0.0, high)),
    )
    return style.Picture(ax=ax, values=drawn, theory=law)


def _broken(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """A curve with NaN inserted where it jumps."""
    after = np.flatnonzero(_jumps(y)) + 1
    return np.insert(x, after, (x[after - 1] + x[after]) / 2), np.insert(
        y, after, np.nan
    )


def _jumps(values: Floats) -> NDArray[np.bool_]:
    """Whether each difference along the first axis is a jump: far larger than those around it."""
    steps = np.abs(np.diff(values, axis=0))
    usual = median_filter(np.nan_to_num(steps), (AROUND, 1)[: values.ndim])
    least = max(
        SEEN * (np.nanmax(values) - np.nanmin(values)),
        ROUND_OFF * np.nanmax(np.abs(values)),
    )
    return np.asarray(steps > np.maximum(LEAP * usual, least))


def _map(
    ax: Axes, sides: list[Side], shown: Shown, theory: PairTheory | None
) -> style.Picture:
    """Draw values over two axes, the first one to the right."""
    palette, norm = _colours(shown)
    edges = [side.edges for side in sides]
    cells, without = style.cells(ax, edges, shown.values, palette, norm)
    _dress_side(ax.xaxis, sides[0])
    _dress_side(ax.yaxis, sides[1])
    plane = [side.numbers for side in sides]
    contours, labels = None, list[Text]()
    low, high = float(np.nanmin(shown.values)), float(np.nanmax(shown.values))
    if not shown.is_count and high - low > ROUND_OFF * max(-low, high):
        # lines at round values, each with its value, up to the jumps and not across them
        near = 0.002 * (high - low)
        levels = [
            x
            for x in ticker.MaxNLocator(8, steps=[1, 2, 2.5, 5, 10]).tick_values(
                low, high
            )
            if low + 10 * near < x < high - 10 * near
            and np.sum(np.abs(shown.values - x) < near)
            < PLATEAU * max(shown.values.shape)
        ]
        smooth = np.isfinite(shown.values)
        for axis in (0, 1):
            i, j = np.nonzero(
                _jumps(shown.values) if axis == 0 else _jumps(shown.values.T).T
            )
            smooth[i, j] = smooth[i + 1 - axis, j + axis] = False
        if levels and smooth.any():
            contours = ax.contour(
                *plane,
                np.ma.array(shown.values, mask=~smooth).T,
                levels=levels,
                linestyles="-",
                linewidths=0.8,
                zorder=3,
                colors=[style.ink_on(norm, x, palette) for x in levels],
            )
            labels = list(
                ax.clabel(
                    contours,
                    fmt=lambda x: signed(f"{x:g}"),
                    inline_spacing=3,
                    fontsize=style.SMALL + 1,
                )
            )
    lines: list[contour.QuadContourSet] = []
    handles: list[artist.Artist] = []
    paper, ink, *_ = style.colours()
    rods = theory is not None and np.isfinite(theory.impedance).all()
    for name, (dash, number) in EQUALITIES.items() if rods else ():
        excess = np.log(np.divide(*getattr(theory, number)))
        excess = np.where(np.isfinite(shown.values), np.round(excess, 12), np.nan)
        if (excess < 0).any() and (excess > 0).any():
            lines.append(
                ax.contour(
                    *plane,
                    np.ma.masked_invalid(excess.T),
                    levels=[0.0],
                    colors=ink,
                    linewidths=1.4,
                    linestyles=dash,
                    zorder=4,
                )
            )
            lines[-1].set_path_effects(
                [patheffects.withStroke(linewidth=2.6, foreground=paper)]
            )
            handles.append(
                Line2D([], [], color=ink, linewidth=1.4, linestyle=dash, label=name)
            )
    bar = style.colour_bar(ax, cells, shown.scale.label)
    if shown.is_count:
        _count_ticks(bar.ax.yaxis, shown)
    style.dress(ax, [*handles, *without])
    return style.Picture(
        ax=ax,
        cells=cells,
        contours=contours,
        labels=labels,
        theory=lines,
        colour_bar=bar,
    )


def _colours(shown: Shown) -> tuple[colors.Colormap, colors.Normalize]:
    """Colours and limits: one colour a count, symmetric about 0 where signs differ."""
    low, high = float(np.nanmin(shown.values)), float(np.nanmax(shown.values))
    if shown.words:
        low, high = 0.0, len(shown.words) - 1.0
    if shown.is_count:
        borders = np.arange(low - 0.5, high + 1.0)
        count = borders.size - 1
        return style.RISING.resampled(count), colors.BoundaryNorm(borders, count)
    largest = max(-low, high)
    if low < -ROUND_OFF * largest and high > ROUND_OFF * largest:
        return style.colours().signed, style.centred((low, high))
    if high - low <= ROUND_OFF * largest:
        low, high = min(low, 0.0), max(high, 0.0)
    return style.RISING, colors.Normalize(low, high if high > low else low + 1.0)


def side_of(result: SweepResult, dimension: int) -> Side:
    """What lies along a dimension of the family; members are counted if that is all the same."""
    name, values = result.axes[dimension]
    values = np.asarray(values, dtype=float)
    if values.min() == values.max():
        name, values = f"axis {dimension}", np.arange(values.size, dtype=float)
    order = np.argsort(values, kind="stable")
    scale = scale_of(parameter(result.system, name), float(np.abs(values).max()))
    from_end = len(result.shape) - dimension
    beside = [
        parameter(result.system, path).name
        for path, numbers in result.parameters.items()
        if path != name and numbers.ndim >= from_end and numbers.shape[-from_end] > 1
    ]
    more = f" and {len(beside) - 1} more" if len(beside) > 1 else ""
    label = f"{scale.label}\nwith {beside[0]}{more}" if beside else scale.label
    return Side(order, values[order], scale, label)


def _dress_side(axis: Any, side: Side) -> None:
    """Limits, label and ticks of an axis of the family."""
    first, last = side.edges[[0, -1]]
    axis.set_label_text(side.label)
    axis.axes.set(
        **{
            f"{axis.axis_name}scale": "log" if side.is_log else "linear",
            f"{axis.axis_name}lim": (first, last),
        }
    )
    if side.is_log:
        subs = (1.0, 2.0, 5.0) if last < 2e3 * first else (1.0,)
        axis.set_major_locator(ticker.LogLocator(subs=subs, numticks=15))
        axis.set_major_formatter(
            ticker.FuncFormatter(lambda value, _: format_factor(value))
        )
        axis.set_minor_formatter(ticker.NullFormatter())


def _count_ticks(axis: Axis, shown: Shown) -> None:
    """Ticks at whole numbers, or what they stand for."""
    if shown.words:
        axis.set_ticks(range(len(shown.words)), shown.words)
    else:
        axis.set_major_locator(ticker.MaxNLocator(12, integer=True))
        axis.set_minor_locator(ticker.NullLocator())


@style.styled
def restitution(
    ratios: ArrayLike, values: ArrayLike, ax: Axes | None = None
) -> style.Picture:
    """Draw computed coefficients of restitution against the law e = l1/l2, and note the residual.

    The law holds for two rods of one material and cross-section, the second at rest inside and
    longer than the first.

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
    x, e = array("ratios", ratios, ""), array("values", values, "")
    if x.shape != e.shape:
        raise refusal(
            "values", f"must have the shape {x.shape} of ratios, got {e.shape}"
        )
    known = np.isfinite(x) & np.isfinite(e)
    if not known.any():
        raise refusal(
            "values", "needs at least one finite coefficient of restitution, got none"
        )
    x, e = x[known], e[known]
    ax = style.axes(ax, 4.2, 4.0)
    reach = max(1.0, float(x.max()))
    (law,) = ax.plot(
        [0, reach],
        [0, reach],
        color=style.colours().series[1],
        linewidth=1.2,
        label="e = ℓ₁/ℓ₂",
    )
    (points,) = ax.plot(x, e, linestyle="", color=style.colours().ink, **style.COMPUTED)
    note = (
        f"largest |e {MINUS} ℓ₁/ℓ₂| = {np.abs(e - x).max():.1e}\nin {e.size} collisions"
    )
    residual = ax.text(
        0.98,
        0.04,
        note,
        transform=ax.transAxes,
        ha="right",
        va="bottom",
        fontsize=style.SMALL + 1,
    )
    style.grid(ax)
    ax.legend(loc="upper left", frameon=False, fontsize=style.SMALL + 1)
    style.dress(
        ax,
        xlim=(0, reach),
        ylim=(0, max(reach, 1.05 * float(e.max()))),
        aspect="equal",
        xlabel="ratio of lengths ℓ₁/ℓ₂",
        ylabel="coefficient of restitution e",
    )
    return style.Picture(ax=ax, law=law, points=points, residual=residual)
