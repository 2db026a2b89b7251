"""What is known of waves in advance: initial states and drives as pieces."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from ...model import Samples, Steps
from ..signals import ROUND_OFF, Ints, Pieces, each_once
from .lines import EXACT
from .records import PIECE, SMOOTH
from .series import POINTS, N

INSIDE = 6  # values in an interval: what runs there is of degree 5 at most
SHARES = (1 - np.cos(np.pi * np.arange(INSIDE) / (INSIDE - 1))) / 2


def signal_of(profile: Any, length: float, ticks_of: Callable[[Any], Ints]) -> Pieces:
    """A profile along a rod of this length, or over time, on whole ticks; its last value holds on.

    `ticks_of` makes ticks of places, m, or of times, s.
    """
    if isinstance(profile, Steps):
        at = np.array([0.0, *map(float, profile.at)])
        return Pieces(ticks_of(at), [*map(float, profile.values)])
    if not isinstance(profile, Samples):
        return Pieces([0], [float(profile)])
    y = np.asarray(profile.values, dtype=float)
    step = length / (len(y) - 1) if profile.step is None else float(profile.step)
    edges = step * np.arange(len(y))
    ticks = ticks_of(edges)
    if not profile.smooth:
        return Pieces.through(ticks, y)
    from scipy.interpolate import make_interp_spline

    values = make_interp_spline(edges, y, 5)(edges[:-1, None] + step * SHARES)
    values[:, 0], values[:, -1] = y[:-1], y[1:]
    series = np.linalg.inv(chebyshev.chebvander(2 * SHARES - 1, INSIDE - 1))
    return Pieces(ticks[:-1], values @ series.T, ticks[-1])


def in_pieces(signal: Pieces, start: int, stop: int, tolerance: float) -> Any:
    """A signal between two ticks in its own pieces, [n] PIECE.

    A kink is one if it changes values by more than the tolerance until the next break: straight
    lines between close samples of a smooth curve have none.
    """
    edges = each_once([start], signal.breaks_in(start, stop), [stop])
    ends, widths = edges[1:], np.diff(edges) * 1.0
    own = signal.cut(edges[:-1], stop).coefficients
    least = ROUND_OFF * np.abs(signal.coefficients).max()
    own[np.abs(own[:, 1:]).sum(axis=1) <= least, 1:] = 0.0  # a constant stays one
    jumps = np.abs(signal.at(ends, "left") - signal.at(ends)) > EXACT * tolerance + least
    k = np.arange(own.shape[1])
    right, left = own @ k**2 * 2 / widths, own @ (k**2 * (-1.0) ** (k + 1)) * 2 / widths
    bends = np.abs(left[1:] - right[:-1]) * np.minimum(widths[1:], widths[:-1]) / 8
    made = np.zeros(len(own), PIECE)
    made["start"], made["stop"], made["order"] = edges[:-1], ends, SMOOTH
    made["order"][1:] = np.where(
        jumps[:-1], 0, np.where(bends > tolerance + least, 1, SMOOTH))
    made["degree"] = np.where(own[:, 1:].any(axis=1), N, 0)
    made["coefficient"][:, k] = own
    return made


def backwards(pieces: Any) -> Any:
    """The same with time reversed."""
    back = pieces[::-1].copy()
    back["start"], back["stop"] = -pieces["stop"][::-1], -pieces["start"][::-1]
    back["order"] = [SMOOTH, *pieces["order"][:0:-1]]
    back["coefficient"] *= (-1.0) ** np.arange(POINTS)
    return back
