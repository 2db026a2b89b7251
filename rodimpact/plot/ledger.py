"""Where the energy is, as bands stacked over time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.text import Text

from ..model import Wall
from ..regions import regions_of
from ..signals import Floats
from ..solution import Solution
from .placing import placing
from .scales import ROUND_OFF, engineering, time_scale, written
from .style import INK, SMALL, dress, new_axes, styled

SAMPLES = 201  # energies bend like parabolas where a force acts
CORNERS_UP_TO = 500
BANDS = (
    ("motion of the centres of mass", "#53659f", "white"),
    ("vibration, kinetic", "#f0dc78", INK),
    ("vibration, strain", "#a0a0a0", INK),
)


class Energy(NamedTuple):
    """Artists of an energy ledger; `work` is the line of what moving walls add, if any."""

    ax: Axes
    bands: list[PolyCollection]
    labels: list[Text]
    work: Line2D | None


@styled
def energy(solution: Solution, ax: Axes | None = None) -> Energy:
    """Draw the energy of all bodies against time, split into motion, vibration and strain.

    If the whole row drifts, the energy is that seen from the frame in which `spacetime` draws it,
    since the drift would hide all else. Where walls move, a dashed line shows the initial energy
    and the work of the walls; the bands reach exactly up to it.

    Parameters
    ----------
    solution : Solution
    ax : Axes, optional
        By default the Axes of a new figure.

    Returns
    -------
    Energy

    Raises
    ------
    ValueError
        If the solution lasts no time.
    """
    ax = ax or new_axes(5.6, 3.2)
    times = _times(solution)
    frame = placing(solution, 0.0, solution.t_end).frame
    parts, supplied = _seen_from(solution, frame, times)
    total = parts.sum(axis=0)
    time = time_scale(solution.t_end)
    scale = engineering("energy", float(total.max()), "J")
    bands = ax.stackplot(
        times * time.factor, parts * scale.factor, colors=[colour for _, colour, _ in BANDS],
        labels=[name for name, *_ in BANDS], linewidth=0.0,
    )
    ax.set_xlim(0, solution.t_end * time.factor)
    ax.set_ylim(0, 1.08 * float(max(total.max(), supplied.max())) * scale.factor or 1.0)
    work = None
    if np.ptp(supplied) > ROUND_OFF * total.max():
        (work,) = ax.plot(times * time.factor, supplied * scale.factor, color=INK, linewidth=1.2,
                          linestyle="--", label="initial energy and work of the walls")
    seen = f" in a frame moving at {written(frame, 'm/s')}" if frame else ""
    ax.set_xlabel(time.label)
    ax.set_ylabel(f"{scale.name}{seen} ({scale.unit})")
    dress(ax)
    labels: list[Text] = []
    missing: list[Artist] = [] if work is None else [work]
    stacked = np.cumsum(parts, axis=0)
    for band, upper, part, (name, _, colour) in zip(bands, stacked, parts, BANDS, strict=True):
        spot = _widest(ax, times * time.factor, (upper - part) * scale.factor,
                       upper * scale.factor, name)
        if spot:
            labels.append(ax.text(*spot, name, color=colour, ha="center", va="center",
                                  fontsize=SMALL + 1))
        elif part.max() > ROUND_OFF * total.max():
            missing.append(band)
    if missing:
        ax.legend(handles=missing, loc="lower left", bbox_to_anchor=(0, 1), borderaxespad=0.1,
                  ncols=2, frameon=False, fontsize=SMALL + 1)
    return Energy(ax, bands, labels, work)


def _times(solution: Solution) -> Floats:
    """Instants at which waves meet or are reflected, unless too many, and others between."""
    even = np.linspace(0.0, solution.t_end, SAMPLES)
    try:
        corners = np.unique(regions_of(solution, limit=CORNERS_UP_TO).t)
    except ValueError:
        return even
    return np.union1d(even, np.minimum(corners, solution.t_end))


def _seen_from(solution: Solution, frame: float, times: Floats) -> tuple[Floats, Floats]:
    """Three kinds of energy [3, n], and initial energy plus work of the walls [n], in a frame."""
    ledger = solution.energy(times)
    rods = [i for i, body in enumerate(solution.system.bodies) if not isinstance(body, Wall)]
    masses = solution.outcome.masses
    momentum = sum(masses[i] * solution.mean_velocity(i, times) for i in rods)
    less = frame * (momentum - frame / 2 * sum(masses[i] for i in rods))
    parts = np.stack((ledger.kinetic - less, ledger.vibration, ledger.strain))
    supplied = ledger.total[0] + ledger.wall_work - less
    return np.maximum(parts, 0.0), supplied


def _widest(
    ax: Axes, x: Floats, low: Floats, high: Floats, text: str
) -> tuple[float, float] | None:
    """Centre of the roomiest box for a text between two curves; none if there is no room."""
    points = ax.get_window_extent().width * 72 / ax.figure.dpi, (
        ax.get_window_extent().height * 72 / ax.figure.dpi)
    width = 0.6 * SMALL * (len(text) + 1) / points[0] * float(np.ptp(ax.get_xlim()))
    height = 1.5 * SMALL / points[1] * float(np.ptp(ax.get_ylim()))
    best, spot = height, None
    for centre in np.linspace(width / 2, float(x[-1]) - width / 2, 60):
        under = (x >= centre - width / 2) & (x <= centre + width / 2)
        floor, ceiling = float(low[under].max()), float(high[under].min())
        if ceiling - floor > best:
            best, spot = ceiling - floor, (float(centre), (floor + ceiling) / 2)
    return spot
