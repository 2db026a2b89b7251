"""The space-time diagram: exact polygons of constant state, place to the right and time upward."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Normalize
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke
from matplotlib.text import Text
from numpy.typing import NDArray

from ..model import Bonded, Wall
from ..regions import Regions, regions_of
from ..signals import Floats
from ..solution import Solution
from .placing import Placing, placing
from .scales import FIELDS, Scale, axis_scales, digits, field_scale
from .style import DIVERGING, FAINT, INK, SMALL, WALL, centred, dress, ink_on, new_axes, styled

CROWDED = 3.0  # typical thickness of a region, points, below which lines would hide the colours


class SpaceTime(NamedTuple):
    """Artists of a space-time diagram; `ends` are the ends of the rods."""

    ax: Axes
    regions: PolyCollection
    ends: LineCollection
    pressing: LineCollection
    touching: LineCollection
    walls: list[Polygon]
    labels: list[Text]
    colour_bar: Colorbar


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
    between them are wave fronts. Bodies are drawn where they are in the laboratory, with
    displacements and gaps magnified by the factor named under the picture; where the whole row
    drifts much farther than it deforms, as seen at the speed named there. A thick line marks a
    contact that presses, a thin one a contact that touches without force.

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
    regions = regions_of(solution, start, stop)
    stop = solution.t_end if stop is None else stop
    plan = placing(solution, start, stop, magnification)
    values = getattr(regions, field)
    rest = plan.frame if field == "velocity" else 0.0
    scale = field_scale(solution, field, dimensionless, float(np.abs(values).max()))
    time, place = axis_scales(solution, dimensionless, stop, plan.row)
    ax = ax or new_axes(5.6, 5.2)

    corners = np.column_stack((_places(plan, regions) * place.factor, regions.t * time.factor))
    polygons = np.split(corners, regions.start[1:-1])
    norm = centred(values * scale.factor, rest * scale.factor)
    drawn = PolyCollection(
        polygons, array=values * scale.factor, cmap=DIVERGING, norm=norm, zorder=2,
        edgecolors=INK, linewidths=0.35,
    )
    ax.add_collection(drawn)
    walls = _walls(plan, ax, time, place, start, stop)
    ends = LineCollection(_ends(plan, regions, time, place), colors=INK, linewidths=0.8, zorder=3)
    pressing, touching = _contacts(plan, time, place, start, stop)
    for lines in (ends, touching, pressing):
        ax.add_collection(lines)

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
    shown = [(lines, name) for lines, name in ((pressing, "pressing"), (touching, "touching"))
             if lines.get_segments()]
    if shown:
        ax.legend(*zip(*shown, strict=True), loc="lower left", bbox_to_anchor=(0, 1),
                  borderaxespad=0.1, ncols=2, frameon=False, fontsize=SMALL + 1)
    labels: list[Text] = []
    if _thickness(ax, polygons) < CROWDED:
        drawn.set(edgecolor="face", linewidth=0.1)
    else:
        labels = _labels(ax, polygons, values * scale.factor, norm)
    return SpaceTime(ax, drawn, ends, pressing, touching, walls, labels, bar)


def _places(plan: Placing, regions: Regions) -> Floats:
    """Place of every corner in the picture."""
    body = np.repeat(regions.body, np.diff(regions.start))
    out = np.empty(regions.x.shape)
    for i in np.unique(body):
        here = body == i
        out[here] = plan.place(
            int(i), regions.x[here], regions.t[here], regions.displacement[here])
    return out


def _track(
    plan: Placing, body: int, right: bool, times: Floats, time: Scale, place: Scale
) -> Floats:
    """Path of an end of a body, straight between `times`, as [n, 2] points of the picture."""
    return np.column_stack((plan.end(body, right, times) * place.factor, times * time.factor))


def _ends(plan: Placing, regions: Regions, time: Scale, place: Scale) -> list[Floats]:
    """Paths of the ends of all rods; they bend where a corner of a region lies on them."""
    body = np.repeat(regions.body, np.diff(regions.start))
    paths = []
    for i in np.unique(body):
        for right, x in ((False, 0.0), (True, plan.solution.fields.edges(int(i))[-1])):
            times = np.unique(regions.t[(body == i) & (regions.x == x)])
            paths.append(_track(plan, int(i), right, times, time, place))
    return paths


def _contacts(
    plan: Placing, time: Scale, place: Scale, start: float, stop: float
) -> tuple[LineCollection, LineCollection]:
    """Where bodies press, and where they touch without force."""
    pressing, touching = [], []
    for contact in plan.solution.contacts:
        if isinstance(contact.law, Bonded):
            continue
        breaks = contact.breakpoints()[0]
        inside = breaks[(breaks > start) & (breaks < stop)]
        times = np.concatenate(([start], inside, [stop]))
        track = _track(plan, contact.index, True, times, time, place)
        between = (times[:-1] + times[1:]) / 2
        gap, force = contact.gap(between), contact.force(between)
        pressing += _stretches(track, force > 0)
        touching += _stretches(track, (force <= 0) & (gap == 0))
    casing = [withStroke(linewidth=4.5, foreground="white")]
    return (LineCollection(pressing, colors=INK, linewidths=3.0, zorder=5, capstyle="butt",
                           path_effects=casing),
            LineCollection(touching, colors=INK, linewidths=1.2, zorder=4, capstyle="butt"))


def _stretches(track: Floats, inside: NDArray[np.bool_]) -> list[Floats]:
    """Unbroken parts of a track; inside[i] says whether track[i] to track[i + 1] belongs to one."""
    turns = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False]))))
    return [track[i : j + 1] for i, j in turns.reshape(-1, 2)]


def _walls(
    plan: Placing, ax: Axes, time: Scale, place: Scale, start: float, stop: float
) -> list[Polygon]:
    """Hatched bands beyond the faces of the walls."""
    bodies = plan.solution.system.bodies
    depth = 0.04 * plan.row * place.factor
    bands = []
    for i, body in enumerate(bodies):
        if isinstance(body, Wall):
            face = _track(plan, i, False, np.array([start, stop]), time, place)
            back = face[::-1] + np.array([-depth if i == 0 else depth, 0.0])
            bands.append(Polygon(
                np.concatenate((face, back)), facecolor=WALL, edgecolor=FAINT, hatch="////",
                linewidth=0.0, zorder=1,
            ))
            ax.add_patch(bands[-1])
            ax.plot(*face.T, color=INK, linewidth=1.5, zorder=3.5)
    return bands


def _labels(ax: Axes, polygons: list[Floats], values: Floats, norm: Normalize) -> list[Text]:
    """Write each value where its polygon has room for it."""
    reach = float(np.ptp(norm.inverse(np.array([0.0, 1.0])))) / 2
    count = 3 + max(0, math.ceil(math.log10(float(np.abs(values).max()) / reach or 1.0)))
    written = []
    for polygon, value in zip(polygons, values, strict=True):
        text = digits(value, reach, count)
        corners = _points(ax, polygon)
        half = np.array([0.35 * SMALL * len(text), 0.6 * SMALL]) + 1.0
        if np.any(np.ptp(corners, axis=0) < 2 * half):
            continue
        box = _centre(corners) + np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
        if _inside(box, corners):
            x, y = _centre(polygon)
            written.append(ax.text(
                x, y, text, ha="center", va="center", fontsize=SMALL, zorder=6,
                color=ink_on(norm, value),
            ))
    return written


def _points(ax: Axes, corners: Floats) -> Floats:
    """Corners in printer's points."""
    points: Floats = ax.transData.transform(corners) * (72.0 / ax.figure.dpi)
    return points


def _thickness(ax: Axes, polygons: list[Floats]) -> float:
    """Typical thickness of polygons in points, four areas by the circumference; of a sample."""
    found = []
    for polygon in polygons[:: 1 + len(polygons) // 300]:
        corners = _points(ax, polygon)
        around = np.roll(corners, -1, axis=0) - corners
        area = np.abs((corners[:, 0] * around[:, 1] - corners[:, 1] * around[:, 0]).sum()) / 2
        found.append(4 * area / max(np.hypot(*around.T).sum(), 1e-9))
    return float(np.median(found))


def _centre(corners: Floats) -> Floats:
    """Centre of area of a convex polygon, [n, 2]."""
    first, a, b = corners[0], corners[1:-1] - corners[0], corners[2:] - corners[0]
    areas = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    centre: Floats = first + (areas[:, None] * (a + b)).sum(axis=0) / (3 * areas.sum())
    return centre


def _inside(points: Floats, corners: Floats) -> bool:
    """Whether all points lie in a convex polygon."""
    side = np.roll(corners, -1, axis=0) - corners
    away = points[:, None] - corners
    turns = side[:, 0] * away[..., 1] - side[:, 1] * away[..., 0]
    return bool((turns > 0).all() or (turns < 0).all())
