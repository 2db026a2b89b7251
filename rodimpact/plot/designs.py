"""Wanted and reached pulse of a design, below the silhouette of the striker."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import StepPatch

from ..design.pulses import PulseDesign
from ..model.arguments import check_kind
from ..records.signal import Signal
from .panels import Picture, axes_or_new, draw_zero, format_axes, new_figure
from .scales import engineering, largest_of, time_scale, x_scale
from .style import SMALL, colours, styled

MIN_MISFIT = 1e-4  # a smaller misfit cannot be seen, and is not written


@styled
def design(result: PulseDesign, ax: Axes | None = None) -> Picture:
    """Draw the wanted pulse of a design and the pulse that its system reaches.

    Their misfit is the root mean square of the difference divided by the peak. A new
    figure also shows the silhouette of a stepped body, drawn as round.

    Parameters
    ----------
    result : PulseDesign
        From `rodimpact.design`.
    ax : Axes, optional
        By default the Axes of a new figure.

    Returns
    -------
    Picture
        With the lines `wanted` and `reached`, and the silhouette `outline` of a stepped
        body or None.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> steel = ri.materials.steel
    >>> bar = ri.Rod(2.0, area=1e-4, material=steel)
    >>> phase = np.pi * np.linspace(0, 1, 101)
    >>> half_sine = ri.Signal(6.5e3 * np.sin(phase), dt=1e-6, unit="N")
    >>> found = ri.design.striker(
    ...     half_sine, bar, velocity=10.0, duration=1e-4, segments=4)
    >>> picture = ri.plot.design(found)
    >>> type(picture).__name__
    'Picture'
    """
    check_kind("result", result, PulseDesign, "design.striker(...)")
    rod: Any = result.system.bodies[result.body]

    # What is measured.
    largest = 0.0
    for signal in (result.wanted, result.reached):
        largest = max(largest, largest_of(signal.values))
    time = time_scale(result.wanted.end)
    force = engineering(result.reached.name, largest, "N")

    # What is drawn.
    outline = None
    if ax is None and len(rod.segments) > 1:
        figure = new_figure(width=5.6, height=4.6)
        silhouette_ax, ax = figure.subplots(2, 1, height_ratios=[1, 2.5]).tolist()
        outline = _draw_silhouette(silhouette_ax, rod)
    ax = axes_or_new(ax, width=5.6, height=3.4)

    def draw(signal: Signal, **style: Any) -> Line2D:
        """Draw a force over time, both in the units of the axes."""
        times = signal.times * time.factor
        (line,) = ax.plot(times, signal.values * force.factor, **style)
        return line

    wanted = draw(
        result.wanted,
        color=colours().series[1],
        alpha=0.6,
        linewidth=3.5,
        label="wanted",
    )
    reached = draw(
        result.reached,
        color=colours().ink,
        linewidth=1.2,
        label=_reached(result, len(rod.segments)),
    )
    draw_zero(ax)
    format_axes(
        ax,
        [wanted, reached],
        xlim=(0, result.wanted.end * time.factor),
        xlabel=time.label,
        ylabel=force.label,
    )
    return Picture(ax=ax, wanted=wanted, reached=reached, outline=outline)


def _reached(result: PulseDesign, segments: int) -> str:
    """Name of the reached pulse: "reached", its misfit, and areas at a limit.

    A misfit too small to be seen is left out, and so are areas if none is at a limit.
    `segments` is the number of areas.
    """
    name = "reached"
    if result.misfit >= MIN_MISFIT:
        name += f", misfit {result.percent}"
    if result.bounded:
        name += f", {len(result.bounded)} of {segments} areas at a limit"
    return name


def _draw_silhouette(ax: Axes, rod: Any) -> StepPatch:
    """Draw the outline of a stepped rod as if it were round, of radius sqrt(A/pi).

    The axis of thickness has the unit of the largest diameter. The right end is named
    as the striking end.
    """
    lengths = [float(segment.length) for segment in rod.segments]
    areas = [float(segment.area) for segment in rod.segments]
    edges = np.cumsum([0.0, *lengths])
    radii = np.sqrt(np.array(areas) / np.pi)
    along = x_scale(float(edges[-1]))
    thickness = engineering("diameter", 2 * float(radii.max()), "m")
    x = edges * along.factor
    radii = radii * thickness.factor
    outline = ax.stairs(
        radii,
        x,
        fill=True,
        baseline=-radii,  # the lower side
        facecolor=colours().wall,
        edgecolor=colours().ink,
        linewidth=0.8,
    )
    y_limit = 1.1 * float(radii.max())
    format_axes(
        ax,
        xlim=(0, 1.02 * x[-1]),
        ylim=(-y_limit, y_limit),
        xlabel=along.label,
        ylabel=f"from axis\n({thickness.unit})",
    )
    ax.annotate(
        "striking end",
        xy=(x[-1], 0.0),
        xytext=(-4, 0),
        textcoords="offset points",
        ha="right",
        va="center",
        fontsize=SMALL,
    )
    return outline
