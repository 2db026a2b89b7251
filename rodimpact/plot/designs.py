"""Wanted and reached result of a design: pulses over time, or e over the varied number."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..design.pulses import PulseDesign
from ..design.rebound import RestitutionDesign
from ..model.arguments import of_kind
from .families import side_of, sweep
from .scales import engineering, place_scale, time_scale
from .style import (
    SMALL,
    Picture,
    axes,
    colours,
    dress,
    legend_above,
    new_figure,
    styled,
)

HARDLY = 1e-4  # a misfit that is not to be seen


@styled
def design(found: PulseDesign | RestitutionDesign, ax: Axes | None = None) -> Picture:
    """Draw the wanted result of a design and the result that its system reaches.

    For a pulse, both forces are drawn over time. Their misfit is the root mean square of the
    difference divided by the peak. A new figure also shows the silhouette of a stepped body, drawn
    as round. For a restitution, e is drawn along the family, with a mark at the system of the
    design.

    Parameters
    ----------
    found : PulseDesign or RestitutionDesign
        From `rodimpact.design`.
    ax : Axes, optional
        By default the Axes of a new figure.

    Returns
    -------
    Picture
        With the lines `wanted` and `reached`, and the silhouette `outline` of a stepped body or
        None.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(np.linspace(0.1, 0.9, 9), area=1e-4, material=steel, velocity=1.0)
    >>> family = ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)])
    >>> picture = ri.plot.design(ri.design.restitution(0.5, family))
    >>> type(picture).__name__
    'Picture'
    """
    if isinstance(found, RestitutionDesign):
        return _restitution(found, ax)
    of_kind("found", found, PulseDesign, "design.striker(...)")
    rod: Any = found.system.bodies[found.body]
    outline = None
    if ax is None and len(rod.segments) > 1:
        above, ax = new_figure(5.6, 4.6).subplots(2, 1, height_ratios=[1, 2.5]).tolist()
        edges = np.cumsum([0.0, *(float(piece.length) for piece in rod.segments)])
        radii = np.sqrt(np.array([float(piece.area) for piece in rod.segments]) / np.pi)
        place = place_scale(float(edges[-1]))
        thickness = engineering("diameter", 2 * float(radii.max()), "m")
        x, radii = edges * place.factor, radii * thickness.factor
        outline = above.stairs(
            radii,
            x,
            fill=True,
            baseline=-radii,
            facecolor=colours().wall,
            edgecolor=colours().ink,
            linewidth=0.8,
        )
        reach = 1.1 * float(radii.max())
        dress(
            above,
            xlim=(0, 1.02 * x[-1]),
            ylim=(-reach, reach),
            xlabel=place.label,
            ylabel=f"from axis\n({thickness.unit})",
        )
        above.annotate(
            "striking end",
            (x[-1], 0.0),
            (-4, 0),
            textcoords="offset points",
            ha="right",
            va="center",
            fontsize=SMALL,
        )
    ax = axes(ax, 5.6, 3.4)
    end, largest = (
        found.wanted.end,
        max(float(np.abs(each.values).max()) for each in (found.wanted, found.reached)),
    )
    time, force = time_scale(end), engineering(found.reached.name, largest, "N")

    def line(signal: Any, **how: Any) -> Line2D:
        (drawn,) = ax.plot(
            signal.times * time.factor, signal.values * force.factor, **how
        )
        return drawn

    wanted = line(
        found.wanted,
        color=colours().series[1],
        alpha=0.6,
        linewidth=3.5,
        label="wanted",
    )
    label = f"reached, misfit {found.percent}" if found.misfit >= HARDLY else "reached"
    if found.bounded:
        label += f", {len(found.bounded)} of {len(rod.segments)} areas at a limit"
    reached = line(found.reached, color=colours().ink, linewidth=1.2, label=label)
    ax.axhline(0.0, color=colours().faint, linewidth=0.6, zorder=0)
    dress(
        ax,
        [wanted, reached],
        xlim=(0, end * time.factor),
        xlabel=time.label,
        ylabel=force.label,
    )
    return Picture(ax=ax, wanted=wanted, reached=reached, outline=outline)


def _restitution(found: RestitutionDesign, ax: Axes | None) -> Picture:
    """Draw e along the family, the wanted one, and where the system lies."""
    curve = sweep(found.family, axes(ax, 5.6, 3.6))
    side = side_of(found.family, 0)
    values = np.asarray(found.family.axes[0][1], dtype=float)
    x = (
        float(np.interp(found.place, np.arange(values.size), values))
        * side.scale.factor
    )
    colour = colours().series[3]
    wanted = curve.ax.axhline(
        found.wanted,
        color=colour,
        linestyle="--",
        linewidth=1.2,
        label=f"wanted e = {found.wanted:.4g}",
    )
    label = f"reached at {x:.4g} {side.scale.unit}".rstrip()
    (reached,) = curve.ax.plot(
        x,
        found.reached,
        color=colour,
        marker="o",
        markersize=7.0,
        linestyle="",
        zorder=4,
        label=label,
    )
    legend_above(curve.ax, [curve.theory, curve.values, wanted, reached])
    return Picture(ax=curve.ax, wanted=wanted, reached=reached, outline=None)
