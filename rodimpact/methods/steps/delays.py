"""Transit times on the clock of a time step: whole steps, or means of two, and what these lose."""

from __future__ import annotations

import numpy as np

from ..clock import PARTS
from ..row import Array, Row

WHOLE = 4  # ticks by which a transit may miss a whole number of steps: round-off


def transit_ticks(row: Row, step: float) -> list[int]:
    """Transit times of the segments in ticks; whole steps where they are that but for round-off."""
    found = []
    for s in row.segments:
        ticks = max(PARTS, round(float(s.transit_time) / step * PARTS))
        near = round(ticks / PARTS) * PARTS
        found.append(near if abs(ticks - near) <= WHOLE + (ticks >> 50) else ticks)
    return found


def edges_of_parts(places: Array, first: int, last: int) -> Array:
    """Ticks at which the parts from `first` on begin, up to `last`, of steps cut at `places`."""
    j, parts = np.arange(first, last + 1), len(places) - 1
    found: Array = j // parts * PARTS + places[j % parts]
    return found


def shares(transit: int, lasts: Array) -> Array:
    """Share of the earlier of the two averages that arrive in steps of so many ticks."""
    found: Array = np.minimum(1.0, transit % PARTS / lasts)
    return found


def arriving(wave: Array, transit: int, lasts: Array) -> Array:
    """What arrives in each step, of what left a transit before.

    Parameters
    ----------
    wave : array
        Averages that left, by step; with those of a transit, and of a begun step, before t = 0.
    transit : int
        Ticks.
    lasts : [steps] array of int
        Ticks that the steps last.

    Returns
    -------
    [steps] array
    """
    found: Array = wave[: len(lasts)]
    if transit % PARTS:
        found = found + (1 - shares(transit, lasts)) * (wave[1 : len(lasts) + 1] - found)
    return found


def lost_to_means(wave: Array, transit: int, lasts: Array) -> Array:
    """Energy that a mean of two averages has less than they: their variance, by step.

    Per impedance; arguments as of `arriving`.
    """
    if transit % PARTS == 0:
        return np.zeros(len(lasts))
    w, change = shares(transit, lasts), np.diff(wave)[: len(lasts)]
    found: Array = w * (1 - w) * change * change * lasts / 4
    return found
