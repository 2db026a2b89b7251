"""Forms of energy, as bands stacked over time."""

from contextlib import suppress
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from matplotlib import artist
from matplotlib.axes import Axes
from matplotlib.text import Text

from ..methods.groups import movable
from ..methods.signals import Floats
from ..results.energy import EnergyLedger
from ..results.regions import regions_of
from ..results.solution import Solution, check_solution
from ..storage.report import ENERGY_LABELS
from .labels import legend_above
from .layout import choose_layout
from .moments import contact_event_times
from .panels import Draft, Picture, axes_or_new, finish, format_axes, units_per_point
from .sampling import is_smooth, rods_of
from .scales import (
    NEGLIGIBLE_RTOL,
    engineering,
    joined_by_and,
    quantity_text,
    time_scale,
)
from .style import INK, SMALL, styled

TIMES_WITH_RODS = 301  # many, because energies are curved where a force acts
TIMES_OF_PANEL = 61  # in the low panel of an overview, which does not show this
TIMES_OF_MASSES = 401  # without rods, whose contacts are short
MAX_EVENTS = 6  # events of contacts that are sampled too
MAX_REGIONS = 500  # regions whose corners are sampled too
NAME_POSITIONS = 60  # positions tried for the name of a band
BANDS = {
    "kinetic": "#53659f",
    "vibrational_kinetic": "#f0dc78",
    "strain": "#b9b9b9",
    "contact": "#7aa6a1",
    "dissipated": "#d9b3a6",
    "radiated": "#e3e3e3",
    "damped": "#e0c39a",
    "soil_work": "#a9977f",
    "drag_work": "#8fb0c9",
    "numerical": "#c7a3c4",
}
"""Entries of the ledger that are stacked, and their colours."""
ALWAYS_SHOWN = ("kinetic", "vibrational_kinetic", "strain")
WORKS = {
    "wall_work": "the walls",
    "drive_work": "the driven ends",
    "gravity_work": "gravity",
}
ENTERING_WAVES = "waves that enter through absorbing ends"


class _Energies(NamedTuple):
    """Energies over time, J, in the frame of the picture."""

    times: Floats  # s
    frame: float  # velocity of the frame, m/s
    bands: dict[str, Floats]  # visible entries of the ledger [time], by name
    workers: list[str]  # what does work on the row, in words
    supplied: Floats  # initial energy plus all work until each time
    total: float  # largest sum of the bands


@styled
def energy(solution: Solution, ax: Axes | None = None) -> Picture:
    """Draw the energy of all bodies against time: as a whole, vibration, and strain.

    Further bands show the energy stored in compliant contacts, lost in contacts and in
    damped material, radiated through absorbing ends, and lost by a grid, if any. If the
    whole row drifts, the energy is computed in the frame in which `spacetime` draws the
    row; the energy of the drift would hide the rest. If walls move, ends are driven or
    gravity acts, a dashed line shows the initial energy plus their work; the bands add
    up to this line.

    Parameters
    ----------
    solution : Solution
    ax : Axes, optional
        By default the Axes of a new figure.

    Returns
    -------
    Picture
        With the stacked `bands`, their `labels`, and the line `work` of what works add,
        or None.

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
    return finish(draft_energy(solution, ax, TIMES_WITH_RODS))


def draft_energy(solution: Solution, ax: Axes | None, count: int) -> Draft:
    """Draft of `energy`: the bands and the line of work, without names in the bands.

    Energies are measured at `count` even times, or `TIMES_OF_MASSES` if the row has no
    rods, and at events. The line is drawn only if walls, drives, gravity or entering
    waves do work. The vertical axis begins at 0; its label names the frame if the row
    drifts.
    """
    check_solution(solution)
    ax = axes_or_new(ax, width=5.6, height=3.2)
    time = time_scale(solution.t_end)

    # What is measured.
    energies = _energies(solution, count)
    scale = engineering("energy", energies.total, "J")
    x = energies.times * time.factor
    heights = np.stack(list(energies.bands.values()))
    supplied = energies.supplied * scale.factor

    # What is drawn.
    bands = ax.stackplot(
        x,
        heights * scale.factor,
        linewidth=0.0,
        colors=[BANDS[entry] for entry in energies.bands],
        labels=[ENERGY_LABELS[entry] for entry in energies.bands],
    )
    frame = ""
    if energies.frame:
        frame = f" in a frame moving at {quantity_text(energies.frame, 'm/s')}"
    top = 1.08 * max(energies.total, float(energies.supplied.max())) * scale.factor
    if top <= 0:  # there is no energy at all
        top = 1.0
    format_axes(
        ax,
        xlim=(0, solution.t_end * time.factor),
        xlabel=time.label,
        ylim=(0, top),
        ylabel=f"{scale.name}{frame} ({scale.unit})",
    )
    work = None
    if energies.workers:
        (work,) = ax.plot(
            x,
            supplied,
            color=INK,
            linewidth=1.2,
            linestyle="--",
            label=f"initial energy and work of {joined_by_and(energies.workers)}",
        )
    picture = Picture(ax=ax, bands=bands, labels=[], work=work)
    zero = np.zeros((1, x.size))
    # [band + 1, time]: band k lies between the borders k and k + 1
    borders = np.cumsum(np.concatenate([zero, heights]), axis=0) * scale.factor

    def write_words() -> None:
        """Write names into the bands; bands without room for it go to the legend.

        A band that is too thin to be seen has no name at all.
        """
        in_legend: list[artist.Artist | None] = [work]
        for band, curves in zip(bands, pairwise(borders), strict=True):
            color = INK
            if band is bands[0]:  # this band is dark
                color = "white"
            label = str(band.get_label())
            name = _name_band(ax, label, x, curves, color)
            low, high = curves
            is_visible = (high - low).max() > NEGLIGIBLE_RTOL * borders.max()
            if name is not None:
                picture.labels.append(name)
            elif is_visible:
                in_legend.append(band)
        legend_above(ax, in_legend)

    return Draft(picture, write_words)


def _energies(solution: Solution, count: int) -> _Energies:
    """Energies of a solution, in the frame in which `spacetime` draws the row.

    They are measured at `count` even times, and at events. Bands that are visible
    nowhere are left out, except those of `ALWAYS_SHOWN`; `workers` leaves out works
    that do not change.
    """
    times = _times(solution, count)
    frame = choose_layout(solution, start=0.0, stop=solution.t_end).frame
    ledger = solution.energy(times)
    drift = _energy_of_drift(solution, frame, times)
    entries = {entry: getattr(ledger, entry) for entry in BANDS}
    entries["kinetic"] = ledger.kinetic - drift  # seen from the frame
    works = _works(ledger)
    all_work = np.sum(list(works.values()), axis=0)
    supplied: Floats = np.asarray(ledger.total[0] - drift + all_work)

    # Bands are stacked, which negative parts do not allow.
    parts = {entry: np.maximum(part, 0.0) for entry, part in entries.items()}
    total = float(sum(parts.values()).max())
    bands = {
        entry: part
        for entry, part in parts.items()
        if entry in ALWAYS_SHOWN or part.max() > NEGLIGIBLE_RTOL * total
    }
    workers = []
    for name, work in works.items():
        if np.ptp(work) > NEGLIGIBLE_RTOL * total:
            workers.append(name)
    return _Energies(times, frame, bands, workers, supplied, total)


def _energy_of_drift(solution: Solution, frame: float, times: Floats) -> Floats:
    """Kinetic energy at rest minus kinetic energy in a moving frame, J, over time.

    It is v (P - M v/2), with the velocity v of the frame, the momentum P and the mass M
    of all bodies that can move.
    """
    bodies = movable(solution.system)
    masses = solution.outcome.masses
    momentum = np.zeros_like(times)
    mass = 0.0
    for i in bodies:
        momentum += masses[i] * solution.mean_velocity(i, times)
        mass += masses[i]
    return np.asarray(frame * (momentum - frame / 2 * mass))


def _works(ledger: EnergyLedger) -> dict[str, Floats]:
    """Work done on the row until each time, J, by the name of what does the work.

    The names are the words of `WORKS`, and `ENTERING_WAVES`; works of 0 are included.
    """
    works = {name: getattr(ledger, entry) for entry, name in WORKS.items()}
    # Radiated energy is negative if waves bring in more energy than has left.
    works[ENTERING_WAVES] = np.maximum(-ledger.radiated, 0.0)
    return works


def _times(solution: Solution, count: int) -> Floats:
    """Times, s, at which energies are measured: even times and events, in order.

    There are `count` even times, or `TIMES_OF_MASSES` if there are no rods. The events
    are all times at which waves meet or are reflected. If the solution is smooth or has
    more than `MAX_REGIONS` regions, they are the first `MAX_EVENTS` events at contacts.
    """
    events: Floats = np.array(contact_event_times(solution)[:MAX_EVENTS])
    if not is_smooth(solution):
        with suppress(ValueError):  # too many regions
            events = np.unique(regions_of(solution, limit=MAX_REGIONS).t)
    if not rods_of(solution.system):
        count = TIMES_OF_MASSES
    even = np.linspace(0.0, solution.t_end, count)
    return np.union1d(even, np.minimum(events, solution.t_end))


def _name_band(
    ax: Axes, name: str, x: Floats, band: tuple[Floats, Floats], color: str
) -> Text | None:
    """Write a name into the band between its two curves, where it is highest.

    `x` are the times and `band` the lower and the upper curve, in units of the axes.
    The name is tried at `NAME_POSITIONS` positions along the band. If the band is
    nowhere high enough for it, nothing is written, and None is returned.
    """
    low, high = band
    per_point = units_per_point(ax)
    # Size of the name with its margins, in units of the axes
    width = 0.6 * SMALL * (len(name) + 1) * per_point[0]
    height = 1.5 * SMALL * per_point[1]
    centres = np.linspace(width / 2, float(x[-1]) - width / 2, NAME_POSITIONS)
    # [position, time]: whether the name covers a time. Over these times the band is
    # free between the highest point of its lower curve and the lowest of its upper one.
    is_under = np.abs(x - centres[:, None]) <= width / 2
    floor = np.where(is_under, low, -np.inf).max(axis=1)
    ceiling = np.where(is_under, high, np.inf).min(axis=1)
    best = int(np.argmax(ceiling - floor))
    if ceiling[best] - floor[best] <= height:
        return None
    return ax.text(
        float(centres[best]),
        float(floor[best] + ceiling[best]) / 2,
        name,
        color=color,
        ha="center",
        va="center",
        fontsize=SMALL + 1,
    )
