"""The bearing graph of a pile: blow count and largest stresses over the resistance."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from ..methods.signals import Floats
from ..model.arguments import check_kind
from ..model.frozen import invalid_argument
from ..piles.bearing import BearingGraph
from .panels import Picture, add_grid, format_axes, two_axes_or_new
from .scales import Scale, engineering, largest_of
from .style import DASHES, colours, styled

POINTS: dict[str, Any] = {"marker": "o", "markersize": 3.5, "linewidth": 1.5}
"""Marks of the points of a graph on its line."""
HEADROOM = 1.08
"""Upper limit of an axis over the largest value."""


@styled
def bearing(graph: BearingGraph, ax: Sequence[Axes] | None = None) -> Picture:
    """Draw a bearing graph: blow count above, largest compression and tension below.

    Both stand against the ultimate resistance of shaft and toe. Open marks are points
    whose blow did not come to its end. Points without set have no blow count, and leave
    a gap.

    Parameters
    ----------
    graph : BearingGraph
        From `rodimpact.bearing_graph`.
    ax : two Axes, optional
        Axes of blow count and stress; by default those of a new figure, one above the
        other.

    Returns
    -------
    Picture
        With `blow_ax` and `stress_ax`, the lines `blow_count`, `compression` and
        `tension`, and the marks `unfinished` or None.

    Raises
    ------
    ValueError
        If no resistance has a blow count.

    Examples
    --------
    >>> import rodimpact as ri
    >>> pile = ri.Rod(15.0, area=9.4e-3, material=ri.materials.steel)
    >>> toe = ri.SmithToe(resistance=1.0, quake=2.5e-3, damping=0.5)
    >>> ram = ri.RigidMass(4536.0, velocity=3.466)
    >>> system = ri.System([ram, pile, ri.Wall()], contacts=[ri.Spring(5e8), toe])
    >>> picture = ri.plot.bearing(ri.bearing_graph(system, [400e3, 800e3], cells=20))
    >>> picture.ax.get_ylabel()
    'blow count (1/m)'
    """
    check_kind("graph", graph, BearingGraph, "rodimpact.bearing_graph(...)")
    blow_ax, stress_ax = two_axes_or_new(
        ax, "blow count and stress", height=4.4, ratios=(1, 1)
    )

    # What is measured.
    order = np.argsort(graph["resistance"])
    resistance = graph["resistance"][order]
    blow_count = graph["blow_count"][order]
    # It is not finite without set; NaN leaves a gap in the line.
    blow_count = np.where(np.isfinite(blow_count), blow_count, np.nan)
    if np.isnan(blow_count).all():
        message = "has no blow count: no blow has moved the toe for good"
        raise invalid_argument("graph", message)
    is_over = np.array([point.is_over for point in graph.points])[order]
    compression = graph["compression"][order]
    tension = graph["tension"][order]
    force = engineering("ultimate resistance", largest_of(resistance), "N")
    largest_stress = max(largest_of(compression), largest_of(tension))
    stress = engineering("largest stress", largest_stress, "Pa")

    # What is drawn.
    x = resistance * force.factor
    colour = colours().series[0]
    (counts,) = blow_ax.plot(x, blow_count, color=colour, **POINTS)
    unfinished = _draw_unfinished(blow_ax, x, blow_count, is_over)
    curves = [
        _draw_stress(stress_ax, x, compression, stress, index=0, name="compression"),
        _draw_stress(stress_ax, x, tension, stress, index=1, name="tension"),
    ]
    largest_count = float(np.nanmax(blow_count))
    format_axes(
        blow_ax,
        [unfinished],
        ylim=(0, HEADROOM * largest_count),
        ylabel="blow count (1/m)",
    )
    format_axes(
        stress_ax,
        curves,
        xlim=(0, HEADROOM * float(x.max())),
        xlabel=force.label,
        ylim=(0, HEADROOM * largest_stress * stress.factor),
        ylabel=stress.label,
    )
    for each in (blow_ax, stress_ax):
        add_grid(each)
    return Picture(
        ax=blow_ax,
        blow_ax=blow_ax,
        stress_ax=stress_ax,
        blow_count=counts,
        compression=curves[0],
        tension=curves[1],
        unfinished=unfinished,
    )


def _draw_stress(
    ax: Axes, x: Floats, values: Floats, scale: Scale, index: int, name: str
) -> Line2D:
    """Draw the largest stress of one sign, Pa, against `x`, the scaled resistance.

    `index` chooses the colour and the dashes, `name` is the entry of the legend.
    """
    (line,) = ax.plot(
        x,
        values * scale.factor,
        color=colours().series[index],
        linestyle=DASHES[index],
        label=name,
        **POINTS,
    )
    return line


def _draw_unfinished(
    ax: Axes, x: Floats, values: Floats, is_over: NDArray[np.bool_]
) -> Line2D | None:
    """Draw open marks on points whose blow did not come to its end.

    None is returned, and nothing drawn, if all blows came to their ends.
    """
    if is_over.all():
        return None
    (marks,) = ax.plot(
        x[~is_over],
        values[~is_over],
        linestyle="none",
        color=colours().ink,
        marker="o",
        markersize=7,
        markerfacecolor="none",
        label="blow not over",
    )
    return marks
