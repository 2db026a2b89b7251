"""Delays on the clock of a time step: whole steps, or means of two, and what these lose."""

from __future__ import annotations

import numpy as np

from ..clock import STEP_TICKS
from ..row import Array


def edges_of_parts(places: Array, first: int, last: int) -> Array:
    """Ticks at which the parts from `first` on begin, up to `last`, of periods cut at `places`."""
    j, parts = np.arange(first, last + 1), len(places) - 1
    return np.asarray(j // parts * places[-1] + places[j % parts])


def shares(transit: int, lasts: Array) -> Array:
    """Share of the earlier of the two averages that arrive in steps of so many ticks."""
    return np.asarray(np.minimum(1.0, transit % STEP_TICKS / lasts))


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
    earlier: Array = wave[: len(lasts)]
    if transit % STEP_TICKS == 0:
        return earlier
    change = wave[1 : len(lasts) + 1] - earlier
    return np.asarray(earlier + (1 - shares(transit, lasts)) * change)


def lost_to_means(wave: Array, transit: int, lasts: Array) -> Array:
    """Energy that a mean of two averages has less than they: their variance, by step.

    Per impedance; arguments as of `arriving`.
    """
    if transit % STEP_TICKS == 0:
        return np.zeros(len(lasts))
    w, change = shares(transit, lasts), np.diff(wave)[: len(lasts)]
    return np.asarray(w * (1 - w) * change * change * lasts / 4)
