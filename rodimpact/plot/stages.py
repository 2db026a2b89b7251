"""Snapshots: the row at chosen instants, one below the other, as in a textbook figure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from ..model import Rod, Wall
from ..signals import Floats
from ..solution import Solution
from .moments import happening, moments
from .placing import Placing, placing
from .scales import (
    Scale,
    closing_speed,
    digits,
    engineering,
    first_rod,
    multiple,
    place_scale,
    written,
)
from .style import DIVERGING, FAINT, INK, SMALL, WALL, centred, dress, ink_on, new_axes, styled

THICKNESS = 0.5  # of the thickest bar, in distances between rows
SWELLING = 0.25  # relative thickening at the largest strain
THINNEST = 0.35  # thinnest bar beside the thickest
NARROWEST = 1e-9  # part of a rod that is drawn: fronts leave an end at no exact floating-point time


class Snapshots(NamedTuple):
    """Artists of snapshots; `bars` holds a polygon for each uniform piece, row by row."""

    ax: Axes
    times: Floats
    bars: PolyCollection
    labels: list[Text]
    fronts: list[Line2D]
    walls: list[Rectangle]


class _Piece(NamedTuple):
    """A uniform piece of rod in a row of the picture: its ends, half thickness and state."""

    row: int
    left: float
    right: float
    half: float
    velocity: float


@styled
def snapshots(
    solution: Solution,
    times: Sequence[float] | Floats | None = None,
    ax: Axes | None = None,
    magnification: float | None = None,
) -> Snapshots:
    """Draw the row at chosen times, one below the other, coloured by velocity.

    Every uniform piece bears its velocity, in the frame of the picture, as a multiple of the
    closing speed v, or, if nothing approaches, in the unit named under the picture. Displacements
    and gaps are magnified as in `spacetime`; compressed pieces are drawn shorter and thicker,
    stretched ones longer and thinner. Small triangles above a bar show which way a front runs.

    Parameters
    ----------
    solution : Solution
    times : sequence of float, optional
        s; by default the instructive instants: start, waves half-way, reflections, what happens at
        the contacts, and the end.
    ax : Axes, optional
        By default the Axes of a new figure.
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

    pieces, fronts = _rows(plan, when, place)
    velocities = np.array([piece.velocity for piece in pieces])
    norm = centred(velocities, plan.frame)
    bars = PolyCollection(
        [[(p.left, -p.row - p.half), (p.right, -p.row - p.half),
          (p.right, -p.row + p.half), (p.left, -p.row + p.half)] for p in pieces],
        array=velocities, cmap=DIVERGING, norm=norm, edgecolors=INK, linewidths=0.6, zorder=2,
    )
    ax.add_collection(bars)
    walls = _walls(plan, ax, when, place)
    ax.autoscale_view()
    ax.margins(x=0.03)
    ax.set_ylim(0.45 - when.size, 0.6)
    for body in range(len(solution.system.bodies) - 1):
        x = plan.end(body, True, when[0]) * place.factor
        ax.axvline(float(x), color=FAINT, linewidth=0.6, linestyle=(0, (4, 4)), zorder=1)
    arrows = [
        ax.plot(x, y, marker=">" if rightward else "<", color=INK, markersize=3.5, zorder=4)[0]
        for x, y, rightward in fronts
    ]

    time = engineering("time", solution.t_end, "s")
    transit = float(first_rod(solution).transit_time)
    ax.set_yticks(-np.arange(when.size), [
        f"{time.write(t)}\n{t / transit:.3g} ℓ₁/c" for t in when.tolist()])
    for row, t in enumerate(when.tolist()):
        ax.text(1.01, -row, happening(solution, t), transform=ax.get_yaxis_transform(),
                va="center", fontsize=SMALL + 1)
    v = closing_speed(solution)
    speed = engineering("velocities", float(np.abs(velocities).max()), "m/s")
    ax.set_xlabel(f"{plan.label(place)}\n" + (
        f"velocities in parts of the closing speed v = {written(v, 'm/s')}" if v else speed.label
    ))
    dress(ax)
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    labels = _labels(ax, pieces, norm, plan.frame, v, speed)
    return Snapshots(ax, when, bars, labels, arrows, walls)


def _rows(
    plan: Placing, times: Floats, place: Scale
) -> tuple[list[_Piece], list[tuple[float, float, bool]]]:
    """Pieces of all rods at all times, and fronts inside them as (x, y, whether it runs right)."""
    solution, fields = plan.solution, plan.solution.fields
    rods = [(i, body) for i, body in enumerate(solution.system.bodies) if isinstance(body, Rod)]
    widest = max(float(s.area) for _, rod in rods for s in rod.segments)
    states = [(row, i, rod, t, fields.profile(i, int(fields.to_ticks(t))))
              for row, t in enumerate(times.tolist()) for i, rod in rods]
    largest = max(float(np.abs(profile.strain).max()) for *_, profile in states) or 1.0
    pieces, fronts = [], []
    for row, i, rod, t, profile in states:
        displaced = solution.displacement(i, profile.edges, t)
        edges = (plan.place(i, profile.edges, t, displaced) * place.factor).tolist()
        first = fields.assembly.spans[i][0]
        wide = np.diff(profile.edges) > NARROWEST * profile.edges[-1]
        for j, which in enumerate(profile.segment.tolist()):
            if not wide[j]:
                continue
            segment = rod.segments[which - first]
            v, strain = float(profile.velocity[j]), float(profile.strain[j])
            thickness = max(THINNEST, (float(segment.area) / widest) ** 0.5) * THICKNESS
            half = thickness / 2 * (1 - SWELLING * strain / largest)
            pieces.append(_Piece(row, edges[j], edges[j + 1], half, v))
            if j and wide[j - 1] and which == profile.segment[j - 1]:
                jump = v - float(profile.velocity[j - 1])
                stretch = float(segment.wave_speed) * (strain - float(profile.strain[j - 1]))
                if np.isclose(abs(jump), abs(stretch), rtol=1e-6, atol=0.0):
                    fronts.append((edges[j], -row + 0.4, jump * stretch < 0))
    return pieces, fronts


def _walls(plan: Placing, ax: Axes, times: Floats, place: Scale) -> list[Rectangle]:
    """A hatched block beyond the face of each wall, at each time."""
    depth = 0.04 * plan.row * place.factor
    blocks = []
    for i, body in enumerate(plan.solution.system.bodies):
        if not isinstance(body, Wall):
            continue
        for row, face in enumerate(plan.end(i, False, times) * place.factor):
            corner = (face - depth if i == 0 else face, -row - 0.45)
            blocks.append(Rectangle(
                corner, depth, 0.9, facecolor=WALL, edgecolor=FAINT, hatch="////", linewidth=0.0,
            ))
            ax.add_patch(blocks[-1])
            ax.plot([face, face], [-row - 0.45, -row + 0.45], color=INK, linewidth=1.5)
    return blocks


def _labels(
    ax: Axes, pieces: list[_Piece], norm: Normalize, rest: float, v: float, speed: Scale
) -> list[Text]:
    """Write the velocity into each piece, below it where it is too narrow."""
    per_unit = abs(float(np.diff(ax.transData.transform([(0, 0), (1, 0)])[:, 0])[0]))
    per_unit *= 72.0 / ax.figure.dpi
    labels: list[Text] = []
    row, taken = -1, -math.inf
    largest = max(abs(piece.velocity) for piece in pieces) * speed.factor
    for piece in pieces:
        text = multiple((piece.velocity - rest) / v, "v") if v else digits(
            piece.velocity * speed.factor, largest)
        width = 0.65 * (SMALL + 1) * len(text)
        x = (piece.left + piece.right) / 2
        if (piece.right - piece.left) * per_unit > width:
            y, colour, va = float(-piece.row), ink_on(norm, piece.velocity), "center_baseline"
        elif row != piece.row or x * per_unit - width / 2 > taken:
            y, colour, va = -piece.row - 0.33, INK, "top"
            row, taken = piece.row, x * per_unit + width / 2
        else:
            continue
        labels.append(ax.text(x, y, text, color=colour, ha="center", va=va, fontsize=SMALL + 1,
                              zorder=5))
    return labels
