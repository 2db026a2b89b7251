"""Snapshots: the row at chosen instants, one below the other, as in a textbook figure."""

from __future__ import annotations

import math
from collections.abc import Sequence
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
from ..results.placing import Placing, placing
from ..results.solution import Solution
from .bars import Bars, Piece
from .moments import happening, moments
from .sampling import is_stepped
from .scales import (
    MINUS,
    Scale,
    closing_speed,
    digits,
    engineering,
    first_rod,
    multiple,
    place_label,
    place_scale,
    written,
)
from .style import SMALL, broken, centred, colours, dress, ink_on, new_axes, styled

ALIKE = 0.02  # velocities of a stretch that bears one label, in parts of the largest


class Snapshots(NamedTuple):
    """Artists of snapshots; `bars` holds a polygon for each uniform piece, row by row.

    With a time step, each rod consists of many pieces with an outline, and there is a colour bar;
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
    solution: Solution,
    ax: Axes | None = None,
    times: Sequence[float] | Floats | None = None,
    magnification: float | None = None,
) -> Snapshots:
    """Draw the row at chosen times, one below the other, coloured by velocity.

    Every uniform piece bears its velocity, in the frame of the picture, as a multiple of the
    closing speed v, or, if nothing approaches, in the unit named under the picture. Displacements
    and gaps are magnified as in `spacetime`; compressed pieces are drawn shorter and thicker,
    stretched ones longer and thinner. Small triangles above a bar show which way a front runs. With
    a time step there are no fronts; a colour bar tells velocities, and stretches in which they
    hardly differ bear the mean, to two digits. Rigid masses are dark blocks of the width named
    under the picture, with their velocity below; fixed ends are hatched as walls, absorbing ends
    dashed, driven ends marked by arrow heads.

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

    Returns
    -------
    Snapshots

    Raises
    ------
    ValueError
        For a time outside the solution, no times, or a magnification that is not positive.
    """
    when = moments(solution) if times is None else np.asarray(times, dtype=float).ravel()
    if when.size == 0:
        raise ValueError("times: needs at least one time, got none")
    solution.fields.to_ticks(when)  # refuses times outside the solution
    plan = placing(solution, 0.0, float(when.max()), magnification)
    place = place_scale(plan.row)
    ax = ax or new_axes(6.6, 0.9 + 0.72 * when.size)

    stepped, (_, ink, faint, *_) = is_stepped(solution), colours()
    drawn = Bars(plan, when, place)
    pieces = drawn.pieces
    velocities = np.array([piece.velocity for piece in pieces])
    v = closing_speed(solution)
    speed = engineering("velocity", float(np.abs(velocities).max()), "m/s")
    norm = centred(velocities, plan.frame)
    bars, outlines = drawn.rods(ax, velocities, norm), drawn.outlines(ax)
    (walls, _), masses = drawn.walls(ax), drawn.masses(ax)
    drawn.ends(ax)
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
    ax.set_xlabel(broken(place_label(plan, place), width) + "\n" + broken(
        f"velocities in parts of the closing speed, v = {written(v, 'm/s')}" if v
        else f"velocities ({speed.unit})", width))
    dress(ax)
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    named = _alike(pieces, norm) if stepped else pieces
    labels = _labels(ax, named, norm, plan.frame, v, speed, not stepped)
    bar = None
    if stepped:
        labels += _mass_labels(plan, ax, when, place, v, speed)
        bar = ax.figure.colorbar(
            bars, ax=ax, location="bottom", label=speed.label, fraction=0.03, pad=0.02, aspect=50,
            shrink=0.6, format=lambda value, _: digits(value * speed.factor, 0.0))
        dress(bar.ax)
        bar.outline.set_visible(False)
    return Snapshots(ax, when, bars, labels, arrows, walls, masses, outlines, bar)


def _differ(values: Floats, count: int) -> bool:
    """Whether values differ when written to so many digits."""
    different = np.unique(values)
    return len({f"{value:.{count}g}" for value in different.tolist()}) == different.size


def _alike(pieces: list[Piece], norm: Normalize) -> list[Piece]:
    """Stretches of neighbouring pieces whose velocities hardly differ, with their mean."""
    room = ALIKE * float(np.ptp(norm.inverse(np.array([0.0, 1.0])))) / 2
    found: list[list[Piece]] = []
    for piece in pieces:
        last = found[-1] if found else []
        speeds = [p.velocity for p in (*last, piece)]
        if last and last[-1][:2] == piece[:2] and max(speeds) - min(speeds) <= room:
            last.append(piece)
        else:
            found.append([piece])
    return [
        group[0]._replace(right=group[-1].right,
                          velocity=sum(p.velocity for p in group) / len(group))
        for group in found
    ]


def _said(velocity: float, rest: float, v: float, speed: Scale, largest: float) -> str:
    """A velocity to two digits: in parts of the closing speed, or in the unit of the scale."""
    if v:
        said = digits(float(f"{round((velocity - rest) / v, 2):.2g}"), 0.0)
        return {"0": "0", "1": "v", f"{MINUS}1": f"{MINUS}v"}.get(said, f"{said}v")
    return digits(float(f"{velocity * speed.factor:.2g}"), largest * speed.factor / 100)


def _mass_labels(
    plan: Placing, ax: Axes, times: Floats, place: Scale, v: float, speed: Scale
) -> list[Text]:
    """Velocity of each mass, below it; of every second of neighbours above it."""
    labels = []
    solution = plan.solution
    above = True
    for i, body in enumerate(solution.system.bodies):
        above = not above if isinstance(body, RigidMass) else True
        if isinstance(body, RigidMass):
            middle = (plan.end(i, False, times) + plan.end(i, True, times)) / 2 * place.factor
            velocities = solution.velocity(i, 0.0, times).tolist()
            for row, (x, velocity) in enumerate(zip(middle, velocities, strict=True)):
                said = _said(velocity, plan.frame, v, speed, max(map(abs, velocities)))
                labels.append(ax.text(
                    x, -row + (0.33 if above else -0.33), said, color=colours().ink, ha="center",
                    va="bottom" if above else "top", fontsize=SMALL + 1, zorder=5))
    return labels


def _labels(
    ax: Axes, pieces: list[Piece], norm: Normalize, rest: float, v: float, speed: Scale,
    exact: bool,
) -> list[Text]:
    """Write the velocity into each piece, if it is exact below it where it is too narrow."""
    per_unit = abs(float(np.diff(ax.transData.transform([(0, 0), (1, 0)])[:, 0])[0]))
    per_unit *= 72.0 / ax.figure.dpi
    labels: list[Text] = []
    row, taken = -1, -math.inf
    largest = max(abs(piece.velocity) for piece in pieces)
    for piece in pieces:
        if not exact:
            text = _said(piece.velocity, rest, v, speed, largest)
        elif v:
            text = multiple((piece.velocity - rest) / v, "v")
        else:
            text = digits(piece.velocity * speed.factor, largest * speed.factor)
        width = (0.65 if exact else 1.0) * (SMALL + 1) * len(text)
        x = (piece.left + piece.right) / 2
        if (piece.right - piece.left) * per_unit > width:
            y, colour, va = float(-piece.row), ink_on(norm, piece.velocity), "center_baseline"
        elif exact and (row != piece.row or x * per_unit - width / 2 > taken):
            y, colour, va = -piece.row - 0.33, colours().ink, "top"
            row, taken = piece.row, x * per_unit + width / 2
        else:
            continue
        labels.append(ax.text(x, y, text, color=colour, ha="center", va=va, fontsize=SMALL + 1,
                              zorder=5))
    return labels
