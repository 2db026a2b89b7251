"""Wanted and reached pulse of a design over time, below the silhouette of the striker."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..design.pulses import PulseDesign
from ..model.arguments import of_kind
from .scales import engineering, place_scale, time_scale
from .style import (
    SMALL,
    Picture,
    axes,
    colours,
    dress,
    new_figure,
    styled,
)

HARDLY = 1e-4  # a misfit that is not to be seen


@styled
def design(found: PulseDesign, ax: Axes | None = None) -> Picture:
    """Draw the wanted pulse of a design and the pulse that its system reaches, over time.

    Their misfit is the root mean square of the difference divided by the peak. A new figure also
    shows the silhouette of a stepped body, drawn as round.

    Parameters
    ----------
    found : PulseDesign
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
    >>> bar = ri.Rod(2.0, area=1e-4, material=steel)
    >>> half_sine = ri.Signal(6.5e3 * np.sin(np.pi * np.linspace(0, 1, 101)), dt=1e-6, unit="N")
    >>> found = ri.design.striker(half_sine, bar, velocity=10.0, duration=1e-4, segments=4)
    >>> picture = ri.plot.design(found)
    >>> type(picture).__name__
    'Picture'
    """
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
