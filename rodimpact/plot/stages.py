"""Snapshots: the row at chosen instants, one below the other, as in a textbook figure."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import compress
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from ..methods.signals import Floats
from ..model import RigidMass
from ..model.arguments import array
from ..model.frozen import refusal
from ..results.gauges import Gauge, check_gauges
from ..results.solution import Solution, check_waves
from .bars import THICKNESS_TOLD, Bars, Piece
from .moments import happening, moments
from .placing import Placing, placing
from .sampling import is_stepped
from .scales import Scale, Speeds, digits, engineering, first_rod, place_label, place_scale, written
from .showing import picture
from .springs import with_springs
from .style import SMALL, axes, broken, centred, colour_bar, colours, dress, ink_on, styled

ALIKE = 0.02  # velocities of a stretch that bears one label, in parts of the largest


@picture
class Snapshots(NamedTuple):
    """Artists of snapshots; `bars` holds a polygon for each uniform piece, row by row.

    Without fronts, each rod consists of many pieces with an outline, and there is a colour bar;
    `walls` are fixed ends too.
    """

    ax: Axes
    times: Floats
    bars: PolyCollection
    labels: list[Text]
    fronts: list[Line2D]
    walls: list[Rectangle]
    masses: list[Rectangle]
    outlines: LineCollection | None
    colour_bar: Colorbar | None


@styled
def snapshots(
    solution: Solution, ax: Axes | None = None, times: Sequence[float] | Floats | None = None,
    magnification: float | None = None, gauges: Mapping[str, Gauge] | None = None,
) -> Snapshots:
    """Draw the row at chosen times, one below the other, coloured by velocity.

    Every uniform piece bears its velocity, in the frame of the picture, as a multiple of the
    closing speed v, or, if nothing approaches, in the unit named under the picture. Displacements
    and gaps are magnified as in `spacetime`; compressed pieces are drawn shorter and thicker,
    stretched ones longer and thinner; a thick line marks a contact that presses. Small triangles
    above a bar show which way a front runs. Without fronts a colour bar tells velocities,
    and stretches in which they hardly differ bear the mean, to two digits. Rigid masses are dark
    blocks of the width named under the picture, with their velocity below; fixed ends are hatched
    as walls, absorbing ends dashed, driven ends marked by arrow heads.

    Parameters
    ----------
    solution : Solution
    ax : Axes, optional
        By default the Axes of a new figure.
    times : sequence of float, optional
        s; by default the instructive instants: start, waves half-way, reflections, what happens at
        the contacts, and the end.
    magnification : float, optional
        Of displacements and gaps; by default chosen as in `spacetime`.
    gauges : mapping of str to Gauge, optional
        Strain gauges to be marked, by name, as for `gauges_to_csv`.

    Returns
    -------
    Snapshots

    Raises
    ------
    ValueError
        For a time outside the solution, no times, or a magnification that is not positive.
    """
    check_waves(solution)
    when = moments(solution) if times is None else array("times", times, "s").ravel()
    if when.size == 0:
        raise refusal("times", "needs at least one time, got none")
    solution.fields.to_ticks(when)  # refuses times outside the solution
    last = float(when.max())
    plan = with_springs(placing(solution, 0.0, last, magnification), np.linspace(0.0, last, 301))
    place = place_scale(plan.row)
    ax = axes(ax, 9.6, 0.9 + 0.72 * when.size)

    stepped, (_, ink, faint, *_) = is_stepped(solution), colours()
    drawn = Bars(plan, when, place)
    pieces = drawn.pieces
    velocities = np.array([piece.velocity for piece in pieces])
    speeds = Speeds.of(solution, plan.frame, float(np.abs(velocities).max()))
    norm = centred(velocities, plan.frame)
    bars, outlines = drawn.rods(ax, velocities, norm), drawn.outlines(ax)
    (walls, _), masses = drawn.walls(ax), drawn.masses(ax)
    drawn.ends(ax)
    drawn.springs(ax)
    lines = drawn.contacts(ax), drawn.gauges(ax, {} if gauges is None else check_gauges(gauges))
    ax.autoscale_view()
    ax.margins(x=0.03)
    ax.set_ylim(0.45 - when.size, 0.6)
    for body in range(len(solution.system.bodies) - 1):
        x = plan.end(body, True, when[0]) * place.factor
        ax.axvline(float(x), color=faint, linewidth=0.6, linestyle=(0, (4, 4)), zorder=1)
    arrows = [
        ax.plot(x, y, marker=">" if rightward else "<", color=ink, markersize=3.5, zorder=4)[0]
        for x, y, rightward in drawn.fronts
    ]

    time = engineering("time", solution.t_end, "s")
    transit = float(first_rod(solution).transit_time)
    count = next((n for n in range(3, 9) if _differ(when * time.factor, n)), 3)
    ax.set_yticks(-np.arange(when.size), [
        f"{t * time.factor:.{count}g} {time.unit}\n{t / transit:.{count}g} ℓ₁/c"
        for t in when.tolist()])
    width = ax.get_window_extent().width
    for row, t in enumerate(when.tolist()):
        words = [broken(line, width / 3) for line in happening(solution, t).splitlines()]
        ax.text(1.01, -row, "\n".join(words), transform=ax.get_yaxis_transform(), va="center",
                fontsize=SMALL + 1)
    told = (f"velocities in parts of the closing speed, v = {written(speeds.closing, 'm/s')}"
            if speeds.closing else f"velocities ({speeds.scale.unit})")
    marks = [THICKNESS_TOLD, "thick line: pressing", "square: strain gauge"]
    seen = [any(piece.strain for piece in pieces), *map(bool, lines)]
    ax.set_xlabel("\n".join(broken(label, width) for label in (
        place_label(plan, place), told, ", ".join(compress(marks, seen))) if label))
    dress(ax)
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    bar = None
    if stepped:
        labels = _labels(ax, _alike(pieces, norm), norm, speeds.rounded)
        labels += _mass_labels(plan, ax, when, place, speeds)
        bar = colour_bar(
            ax, bars, speeds.scale.label, location="bottom", fraction=0.03, aspect=50, shrink=0.6,
            format=lambda value, _: digits(value * speeds.scale.factor, 0.0))
    else:
        labels = _labels(ax, pieces, norm, speeds.exact, beside=True)
    return Snapshots(ax, when, bars, labels, arrows, walls, masses, outlines, bar)


def _differ(values: Floats, count: int) -> bool:
    """Whether values differ when written to so many digits."""
    different = np.unique(values)
    return len({f"{value:.{count}g}" for value in different.tolist()}) == different.size


def _alike(pieces: list[Piece], norm: Normalize) -> list[Piece]:
    """Stretches of neighbouring pieces whose velocities hardly differ, with their mean."""
    room = ALIKE * float(np.ptp(norm.inverse(np.array([0.0, 1.0])))) / 2
    stretches: list[list[Piece]] = [[]]
    for piece in pieces:
        last = stretches[-1]
        speeds = [p.velocity for p in (*last, piece)]
        if last and (last[-1][:2] != piece[:2] or max(speeds) - min(speeds) > room):
            stretches.append([piece])
        else:
            last.append(piece)
    return [s[0]._replace(right=s[-1].right, velocity=sum(p.velocity for p in s) / len(s))
            for s in stretches]


def _mass_labels(
    plan: Placing, ax: Axes, times: Floats, place: Scale, speeds: Speeds
) -> list[Text]:
    """Velocity of each mass, below it; of every second of neighbours above it."""
    labels = []
    above = True
    for i, body in enumerate(plan.solution.system.bodies):
        above = not (above and isinstance(body, RigidMass))
        if isinstance(body, RigidMass):
            middle = (plan.end(i, False, times) + plan.end(i, True, times)) / 2 * place.factor
            velocities = plan.solution.velocity(i, 0.0, times).tolist()
            for row, (x, velocity) in enumerate(zip(middle, velocities, strict=True)):
                labels.append(_label(
                    ax, x, -row + (0.33 if above else -0.33),
                    speeds.rounded(velocity, max(map(abs, velocities))), colours().ink,
                    "bottom" if above else "top"))
    return labels


def _label(ax: Axes, x: float, y: float, text: str, colour: str, va: str) -> Text:
    """Write a velocity."""
    return ax.text(x, y, text, color=colour, ha="center", va=va, fontsize=SMALL + 1, zorder=5)


def _labels(
    ax: Axes, pieces: list[Piece], norm: Normalize, write: Callable[[float, float], str],
    beside: bool = False,
) -> list[Text]:
    """Write the velocity into each piece, or below it, `beside`, where it is too narrow."""
    per_unit = abs(float(np.diff(ax.transData.transform([(0, 0), (1, 0)])[:, 0])[0]))
    per_unit *= 72.0 / ax.figure.dpi
    labels: list[Text] = []
    row, taken = -1, -math.inf
    largest = max(abs(piece.velocity) for piece in pieces)
    for piece in pieces:
        text = write(piece.velocity, largest)
        width = (0.65 if beside else 1.0) * (SMALL + 1) * len(text)
        x = (piece.left + piece.right) / 2
        if (piece.right - piece.left) * per_unit > width:
            labels.append(_label(ax, x, float(-piece.row), text, ink_on(norm, piece.velocity),
                                 "center_baseline"))
        elif beside and (row != piece.row or x * per_unit - width / 2 > taken):
            labels.append(_label(ax, x, -piece.row - 0.33, text, colours().ink, "top"))
            row, taken = piece.row, x * per_unit + width / 2
    return labels
