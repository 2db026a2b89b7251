"""Forms of energy, as bands stacked over time."""

from contextlib import suppress
from itertools import pairwise

import numpy as np
from matplotlib import artist
from matplotlib.axes import Axes
from matplotlib.text import Text

from ..methods.groups import movable
from ..methods.signals import Floats
from ..model import Rod
from ..results.regions import regions_of
from ..results.solution import Solution, check_solution
from ..storage.report import ENERGIES
from .moments import contact_turns
from .placing import placing
from .sampling import is_stepped
from .scales import ROUND_OFF, engineering, listed, time_scale, written
from .style import INK, SMALL, Picture, axes, dress, extent, legend_above, styled

SAMPLES = 61  # energies bend like parabolas where a force acts
OF_MASSES = 401  # the same where no rod vibrates, and contacts are short
TURNS = 6  # of contacts that are sampled too
CORNERS_UP_TO = 500
BANDS = {
    "kinetic": "#53659f",
    "vibrational_kinetic": "#f0dc78",
    "strain": "#b9b9b9",
    "contact": "#7aa6a1",
    "dissipated": "#d9b3a6",
    "radiated": "#e3e3e3",
    "damped": "#e0c39a",
    "numerical": "#c7a3c4",
}
"""Entries of the ledger that are stacked, and their colours."""
ALWAYS = ("kinetic", "vibrational_kinetic", "strain")
WORKS = {
    "wall_work": "the walls",
    "drive_work": "the driven ends",
    "gravity_work": "gravity",
}


@styled
def energy(solution: Solution, ax: Axes | None = None) -> Picture:
    """Draw the energy of all bodies against time: moving as a whole, vibration, and strain.

    Further bands show the energy stored in compliant contacts, lost in contacts and in damped
    material, radiated through absorbing ends, and lost by a grid, if any. If the whole row drifts,
    the energy is computed in the frame in which `spacetime` draws the row; the energy of the drift
    would hide the rest. If walls move, ends are driven or gravity acts, a dashed line shows the
    initial energy plus their work; the bands add up to this line.

    Parameters
    ----------
    solution : Solution
    ax : Axes, optional
        By default the Axes of a new figure.

    Returns
    -------
    Picture
        With the stacked `bands`, their `labels`, and the line `work` of what works add, or None.

    Raises
    ------
    ValueError
        If the duration of the solution is 0.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> solution = ri.solve(ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)]))
    >>> picture = ri.plot.energy(solution)
    >>> picture.ax.get_xlabel()
    'time t (µs)'
    """
    check_solution(solution)
    ax = axes(ax, 5.6, 3.2)
    times = _times(solution)
    frame = placing(solution, 0.0, solution.t_end).frame
    ledger, masses, free = (
        solution.energy(times),
        solution.outcome.masses,
        movable(solution.system),
    )
    momentum = sum(masses[i] * solution.mean_velocity(i, times) for i in free)
    drift = frame * (momentum - frame / 2 * sum(masses[i] for i in free))
    entries = {entry: getattr(ledger, entry) for entry in BANDS}
    entries["kinetic"] = ledger.kinetic - drift
    works = {name: getattr(ledger, entry) for entry, name in WORKS.items()}
    works["waves that enter through absorbing ends"] = np.maximum(
        -entries["radiated"], 0.0
    )
    supplied = ledger.total[0] - drift + sum(works.values())
    parts = {entry: np.maximum(part, 0.0) for entry, part in entries.items()}
    total = float(sum(parts.values()).max())
    parts = {
        entry: part
        for entry, part in parts.items()
        if entry in ALWAYS or part.max() > ROUND_OFF * total
    }
    workers = [name for name, work in works.items() if np.ptp(work) > ROUND_OFF * total]

    time, scale = time_scale(solution.t_end), engineering("energy", total, "J")
    x, heights = times * time.factor, list(parts.values())
    bands = ax.stackplot(
        x,
        np.stack(heights) * scale.factor,
        linewidth=0.0,
        colors=[BANDS[entry] for entry in parts],
        labels=[ENERGIES[entry] for entry in parts],
    )
    seen = f" in a frame moving at {written(frame, 'm/s')}" if frame else ""
    dress(
        ax,
        xlim=(0, solution.t_end * time.factor),
        xlabel=time.label,
        ylim=(0, 1.08 * max(total, float(supplied.max())) * scale.factor or 1.0),
        ylabel=f"{scale.name}{seen} ({scale.unit})",
    )
    work = None
    if workers:
        (work,) = ax.plot(
            x,
            supplied * scale.factor,
            color=INK,
            linewidth=1.2,
            linestyle="--",
            label=f"initial energy and work of {listed(workers)}",
        )
    labels: list[Text] = []
    missing: list[artist.Artist | None] = [work]
    borders = np.cumsum([np.zeros(x.size), *heights], axis=0) * scale.factor
    for band, (low, high) in zip(bands, pairwise(borders), strict=True):
        name = str(band.get_label())
        spot = _widest(ax, x, low, high, name)
        if spot:
            labels.append(
                ax.text(
                    *spot,
                    name,
                    color="white" if band is bands[0] else INK,
                    ha="center",
                    va="center",
                    fontsize=SMALL + 1,
                )
            )
        elif (high - low).max() > ROUND_OFF * borders.max():
            missing.append(band)
    legend_above(ax, missing)
    return Picture(ax=ax, bands=bands, labels=labels, work=work)


def _times(solution: Solution) -> Floats:
    """Even instants, and those at which waves meet or are reflected, unless they are too many."""
    waves = any(isinstance(body, Rod) for body in solution.system.bodies)
    known: Floats = np.array(contact_turns(solution)[:TURNS])
    if not is_stepped(solution):
        with suppress(ValueError):  # too many regions
            known = np.unique(regions_of(solution, limit=CORNERS_UP_TO).t)
    even = np.linspace(0.0, solution.t_end, SAMPLES if waves else OF_MASSES)
    return np.union1d(even, np.minimum(known, solution.t_end))


def _widest(
    ax: Axes, x: Floats, low: Floats, high: Floats, text: str
) -> tuple[float, float] | None:
    """Centre of the roomiest box for a text between two curves; none if there is no room."""
    point = np.ptp([ax.get_xlim(), ax.get_ylim()], axis=1) / extent(ax)
    width, height = 0.6 * SMALL * (len(text) + 1) * point[0], 1.5 * SMALL * point[1]
    centres = np.linspace(width / 2, float(x[-1]) - width / 2, 60)
    under = np.abs(x - centres[:, None]) <= width / 2
    floor = np.where(under, low, -np.inf).max(axis=1)
    ceiling = np.where(under, high, np.inf).min(axis=1)
    best = int(np.argmax(ceiling - floor))
    if ceiling[best] - floor[best] <= height:
        return None
    return float(centres[best]), float(floor[best] + ceiling[best]) / 2
