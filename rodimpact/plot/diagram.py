"""The space-time diagram: place to the right and time upward, coloured by the state of the rods."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection, QuadMesh
from matplotlib.colorbar import Colorbar
from matplotlib.patches import Polygon
from matplotlib.text import Text

from ..model import Absorbing
from ..solution import Solution
from .borders import Borders, Cut, absorbing_end
from .placing import placing
from .polygons import Polygons
from .raster import Raster
from .sampling import is_stepped
from .scales import FIELDS, axis_scales, field_scale
from .style import SMALL, centred, dress, new_axes, styled


class SpaceTime(NamedTuple):
    """Artists of a space-time diagram; `ends` are the ends of the rods.

    `regions` are polygons of constant state, or the flat cells [times, places] of a solution on a
    time step, masked between the rods; `walls` are fixed ends too.
    """

    ax: Axes
    regions: PolyCollection | QuadMesh
    ends: LineCollection
    pressing: LineCollection
    touching: LineCollection
    walls: list[Polygon]
    labels: list[Text]
    colour_bar: Colorbar
    masses: list[Polygon]


@styled
def spacetime(
    solution: Solution,
    ax: Axes | None = None,
    field: str = "velocity",
    dimensionless: bool = False,
    start: float = 0.0,
    stop: float | None = None,
    magnification: float | None = None,
) -> SpaceTime:
    """Draw where every piece of rod is at every time, coloured by its state.

    Each polygon is a region of constant velocity and strain with its exact corners; the thin lines
    between them are wave fronts. A solution on a time step has flat cells instead, each with the
    average over its time; they stay pixels in SVG and PDF.

    Bodies are drawn where they are in the laboratory, with displacements and gaps magnified by the
    factor named under the picture; where the whole row drifts much farther than it deforms, as seen
    at the speed named there. A thick line marks a
    contact that presses, a thin one a rigid contact that touches without force. Rigid masses are
    dark strips of the width named under the picture, fixed ends are hatched as walls, absorbing
    ends dashed, driven ends marked by arrow heads.

    Parameters
    ----------
    solution : Solution
    ax : Axes, optional
        By default the Axes of a new figure.
    field : str
        ``"velocity"``, ``"stress"`` or ``"strain"``, the latter two positive in tension.
    dimensionless : bool
        Scale times by l1/c and places by l1, the transit time and length of the first rod;
        velocities by the closing speed v0, stresses by rho c v0, strains by v0/c.
    start, stop : float
        Interval of time, s; by default the whole solution.
    magnification : float, optional
        Of displacements and gaps; by default 1, 2 or 5 times a power of ten that shows them well.

    Returns
    -------
    SpaceTime

    Raises
    ------
    ValueError
        For an unknown field, an empty interval, more than 100 000 regions, a magnification that is
        not positive, or a dimensionless picture of a row in which nothing approaches.
    """
    if field not in FIELDS:
        known = ", ".join(f'"{name}"' for name in FIELDS)
        raise ValueError(f"field: must be one of {known}, got {field!r}")
    cut: Cut = (Raster if is_stepped(solution) else Polygons)(solution, start, stop)
    stop = solution.t_end if stop is None else stop
    plan = placing(solution, start, stop, magnification)
    values = cut.values(field)
    rest = plan.frame if field == "velocity" else 0.0
    reach = [float(np.nanmin(values)), float(np.nanmax(values))]
    scale = field_scale(solution, field, dimensionless, max(map(abs, reach)))
    time, place = axis_scales(solution, dimensionless, stop, plan.row)
    ax = ax or new_axes(5.6, 5.2)

    norm = centred([v * scale.factor for v in reach], rest * scale.factor)
    drawn = cut.draw(ax, plan, values * scale.factor, norm, time, place)
    borders = Borders(plan, cut, (start, stop), time, place)
    walls = borders.walls(ax)
    ends = borders.ends()
    pressing, touching = borders.contacts()
    for lines in (ends, touching, pressing):
        ax.add_collection(lines)
    masses, drives = borders.masses(ax), borders.drives(ax)

    ax.autoscale_view()
    ax.margins(x=0.02, y=0)
    ax.set_ylim(start * time.factor, stop * time.factor)
    ax.set_xlabel(plan.label(place))
    ax.set_ylabel(time.label)
    dress(ax)
    bar = ax.figure.colorbar(drawn, ax=ax, label=scale.label, fraction=0.06, pad=0.02, aspect=30)
    dress(bar.ax)
    bar.outline.set_visible(False)
    if bar.solids is not None:
        bar.solids.set(rasterized=False, edgecolor="face")
    shown: list[tuple[Artist, str]] = [
        (lines, name) for lines, name in ((pressing, "pressing"), (touching, "touching"))
        if lines.get_segments()]
    marks: list[Artist] = [*masses[:1], *drives]
    if any(isinstance(end, Absorbing) for end in solution.system.ends):
        marks.append(absorbing_end())
    shown += [(mark, str(mark.get_label())) for mark in marks]
    if shown:
        ax.legend(*zip(*shown, strict=True), loc="lower left", bbox_to_anchor=(0, 1),
                  borderaxespad=0.1, ncols=2 if len(shown) < 3 else 3, frameon=False,
                  fontsize=SMALL + 1)
    return SpaceTime(ax, drawn, ends, pressing, touching, walls, cut.finish(), bar, masses)
