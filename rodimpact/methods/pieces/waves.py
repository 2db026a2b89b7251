"""What is known of waves in advance: initial states and drives as pieces."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from ...model import Samples, Steps
from ..signals import ROUND_OFF, Floats, Ints, Pieces, each_once
from .lines import EXACT
from .records import SMOOTH
from .series import POINTS, SERIES, X

LEVELS = 12  # pieces of at most 2^12 intervals
INSIDE = 6  # values in an interval: what runs there is of degree 5 at most
SHARES = (1 - np.cos(np.pi * np.arange(INSIDE) / (INSIDE - 1))) / 2
_SERIES, _X = np.array(SERIES), np.array(X)


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


class Fitted(NamedTuple):
    """Pieces: ticks [n + 1], coefficients [n, 9], order of the break at the start of each."""

    ticks: Ints
    coefficients: Floats
    order: Ints
    error: float  # by how much they miss the signal at most

    def backwards(self) -> Fitted:
        """The same with time reversed."""
        signs = np.where(np.arange(POINTS) % 2, -1.0, 1.0)
        order = np.append(SMOOTH, self.order[:0:-1])
        return Fitted(-self.ticks[::-1], self.coefficients[::-1] * signs, order, self.error)


def fitted(signal: Pieces, stop: int, kinked: bool, tolerance: float) -> Fitted:
    """A signal from tick 0 to `stop` as pieces that are as long as they fit to a tolerance.

    Pieces begin at breaks of the signal, of which those of a smooth curve are no kinks.
    """
    edges = each_once([0], signal.breaks_in(0, stop), [stop])
    least = EXACT * tolerance + ROUND_OFF * np.abs(signal.coefficients).max()
    jumps = np.abs(signal.at(edges[1:], "left") - signal.at(edges[1:])) > least
    passed = np.cumsum(np.append(0, jumps[:-1]))  # jumps before each interval
    n = len(edges) - 1
    width = 1 << min(LEVELS, max(n - 1, 0).bit_length())
    first, found, worst = np.arange(0, n, width), list[tuple[Ints, Floats]](), 0.0
    while width:  # what does not fit is halved; a single interval is one piece
        last = np.minimum(first + width, n)
        good = (first + width == last) & (passed[last - 1] == passed[first])
        c, miss = _pieces(signal, edges, first[good], width)
        fits = (miss <= tolerance) | (width == 1)
        worst = max(worst, miss[fits].max(initial=0.0))
        good[good] = fits
        found.append((first[good], c[fits]))
        width //= 2
        first = np.concatenate((first[~good], first[~good] + width))
        first = first[first < n]
    begin, coefficients = (np.concatenate(x) for x in zip(*found, strict=True))
    order = np.argsort(begin)
    begin, coefficients = begin[order], coefficients[order]
    order = _orders(edges, begin, coefficients, jumps, kinked, tolerance)
    return Fitted(np.append(edges[begin], stop), coefficients, order, float(worst))


def _pieces(signal: Pieces, edges: Ints, first: Ints, width: int) -> tuple[Floats, Floats]:
    """Series through so many intervals from each `first` on, and by how much they miss them."""
    low, high = edges[first], edges[first + width]
    values = signal.at(low[:, None] + (high - low)[:, None] * (_X + 1) / 2)
    values[:, -1] = signal.at(high, "left")
    c = values @ _SERIES.T
    flat = np.all(values == values[:, :1], axis=1)
    c[flat] = np.eye(POINTS)[0] * values[flat, :1]  # what is constant stays so to the last digit
    at = first[:, None] + np.arange(width)
    starts, stops = edges[at], edges[at + 1]
    inside = starts[..., None] + (stops - starts)[..., None] * SHARES
    shape = len(first), width * INSIDE
    y = 2 * (inside.reshape(shape) - low[:, None]) / (high - low)[:, None] - 1
    given = signal.inside(starts.ravel(), stops.ravel(), SHARES) * np.ones(INSIDE)
    missed = chebyshev.chebval(y.T, c.T, tensor=False).T - given.reshape(shape)
    return c, np.abs(missed).max(axis=1)


def _orders(
    edges: Ints, first: Ints, coefficients: Floats, jumps: Any, kinked: bool, tolerance: float
) -> Ints:
    """Orders of the breaks at which pieces start.

    A kink is one if it changes values by more than the tolerance until the next edge: straight
    lines between close samples of a smooth curve have none.
    """
    order = np.full(len(first), SMOOTH)
    widths = np.diff(np.append(edges[first], edges[-1])).astype(float)
    k = np.arange(POINTS) ** 2
    right = coefficients @ k * 2 / widths
    left = coefficients @ (k * np.where(np.arange(POINTS) % 2, 1.0, -1.0)) * 2 / widths
    at = first[1:]
    near = np.minimum(edges[at] - edges[at - 1], edges[at + 1] - edges[at])
    bends = np.abs(left[1:] - right[:-1]) * near / 8 > tolerance
    order[1:] = np.where(jumps[first[1:] - 1], 0, np.where(bends & kinked, 1, SMOOTH))
    return order
