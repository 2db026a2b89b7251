"""What is known of waves in advance: initial states and drives as pieces."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...model import Samples, Steps
from ..signals import Floats, Ints
from .lines import EXACT
from .records import SMOOTH
from .series import POINTS, SERIES, X

LEVELS = 12  # pieces of at most 2^12 intervals
INSIDE = 6  # values in an interval: what runs there is of degree 5 at most
SHARES = (1 - np.cos(np.pi * np.arange(INSIDE) / (INSIDE - 1))) / 2
_SERIES, _X = np.array(SERIES), np.array(X)
_POWERS = np.linalg.inv(np.vander(SHARES, INSIDE, increasing=True))  # values to coefficients


class Curve(NamedTuple):
    """Polynomials one after the other: edges [n + 1], values [n, 6] at `SHARES` of intervals."""

    edges: Any
    values: Any
    smooth: bool = False  # whether it has no kinks

    def at(self, places: Any, i: Any) -> Floats:
        """Values of the polynomials i at places."""
        share = (places - self.edges[i]) / (self.edges[i + 1] - self.edges[i])
        c = self.values[i] @ _POWERS.T
        value: Floats = np.zeros(np.shape(share))
        for m in range(INSIDE - 1, -1, -1):
            value = value * share + c[..., m]
        return value

    def interval(self, places: Any) -> Ints:
        """Interval in which places lie."""
        i = np.searchsorted(self.edges, places, "right") - 1
        return np.clip(i, 0, len(self.values) - 1)

    def on(self, edges: Any) -> Curve:
        """The same over other intervals, each of which lies in one of these."""
        edges = np.asarray(edges, dtype=float)
        i = self.interval((edges[1:] + edges[:-1]) / 2)
        places = edges[:-1, None] + np.diff(edges)[:, None] * SHARES
        values = np.stack([self.at(column, i) for column in places.T], axis=1)
        even = np.all(self.values == self.values[:, :1], axis=1)[i]
        values[even] = self.values[i[even], :1]  # what is constant stays so to the last digit
        return Curve(edges, values, self.smooth)


def curve_of(profile: Any, length: float) -> Curve:
    """A profile from 0 to `length`; the last value of samples in time holds on."""
    if isinstance(profile, Steps):
        at = [float(x) for x in profile.at if float(x) < length]
        steps = np.array([float(v) for v in profile.values[: len(at) + 1]])
        return Curve(np.array([0.0, *at, length]), np.repeat(steps[:, None], INSIDE, axis=1))
    if not isinstance(profile, Samples):
        return Curve(np.array([0.0, length]), np.full((1, INSIDE), float(profile)), True)
    y = np.asarray(profile.values, dtype=float)
    if profile.step is None:
        edges: Any = np.linspace(0.0, length, len(y))
    else:
        edges = float(profile.step) * np.arange(len(y))
    if profile.smooth:
        from scipy.interpolate import make_interp_spline

        places = edges[:-1, None] + np.diff(edges)[:, None] * SHARES
        values: Any = make_interp_spline(edges, y, 5)(places)
        values[:, 0], values[:, -1] = y[:-1], y[1:]
    else:
        values = y[:-1, None] + (y[1:] - y[:-1])[:, None] * SHARES
        values[:, -1] = y[1:]
    held = edges[-1] < length  # the last value holds on, which is a kink
    if held:
        edges, values = np.append(edges, length), np.vstack((values, np.full(INSIDE, y[-1])))
    whole = Curve(edges, values, profile.smooth and not held)
    return whole if edges[-1] == length else part_of(whole, 0.0, length)


def part_of(curve: Curve, start: float, stop: float) -> Curve:
    """The curve between two places."""
    inside = curve.edges[(curve.edges > start) & (curve.edges < stop)]
    return curve.on(np.concatenate(([start], inside, [stop])))


def sum_of(first: Curve, second: Curve, factor: float) -> Curve:
    """The first plus `factor` times the second, over the same length."""
    edges = np.unique(np.concatenate((first.edges, second.edges)))
    values = first.on(edges).values + factor * second.on(edges).values
    return Curve(edges, values, first.smooth and second.smooth)


class Fitted(NamedTuple):
    """Pieces: ticks [n + 1], coefficients [n, 9], order of the break at the start of each."""

    ticks: Ints
    coefficients: Floats
    order: Ints
    error: float  # by how much they miss the curve at most


def fitted(curve: Curve, tolerance: float) -> Fitted:
    """A curve over whole ticks as pieces that are as long as they fit to a tolerance.

    Parameters
    ----------
    curve : Curve
        Edges in ticks.
    tolerance : float
    """
    keep = np.diff(curve.edges) > 0
    edges = np.append(curve.edges[:-1][keep], curve.edges[-1]).astype(np.int64)
    curve = Curve(edges.astype(float), curve.values[keep], curve.smooth)
    begin, end, n = curve.values[:, 0], curve.values[:, -1], len(curve.values)
    jumps = np.append(np.abs(end[:-1] - begin[1:]) > EXACT * tolerance, True)  # behind each
    even = np.all(curve.values == begin[:, None], axis=1)
    coefficients, width_of = np.zeros((n, POINTS)), np.zeros(n, int)  # of pieces that start there
    taken, worst = np.zeros(n, bool), 0.0
    for level in range(min(LEVELS, max(n - 1, 0).bit_length()), -1, -1):
        width = 1 << level
        blocks = (n // width, width)
        inner = jumps[: n - n % width].reshape(blocks)[:, :-1].any(axis=1)
        free = ~taken[: n - n % width].reshape(blocks).any(axis=1) & ~inner
        first = width * np.flatnonzero(free)
        if not len(first):
            continue
        c, miss = _pieces(curve, first, width)
        good = miss <= tolerance if level else miss >= 0  # a single interval is one piece
        first, worst = first[good], max(worst, miss[good].max(initial=0.0))
        coefficients[first], width_of[first] = c[good], width
        taken[first[:, None] + np.arange(width)] = True
    alone = even & (width_of == 1)  # what is constant stays so to the last digit
    coefficients[alone] = 0.0
    coefficients[alone, 0] = begin[alone]
    first = np.flatnonzero(width_of)
    coefficients = coefficients[first]
    order = _orders(edges, first, coefficients, jumps, not curve.smooth, tolerance)
    return Fitted(np.append(edges[first], edges[-1]), coefficients, order, float(worst))


def _pieces(curve: Curve, first: Ints, width: int) -> tuple[Floats, Floats]:
    """Series through so many intervals from each `first` on, and by how much they miss them."""
    low, high = curve.edges[first, None], curve.edges[first + width, None]
    places = low + (high - low) * (_X + 1) / 2
    own = np.clip(curve.interval(places), first[:, None], first[:, None] + width - 1)
    c = curve.at(places, own) @ _SERIES.T
    at = first[:, None] + np.arange(width)
    tested = curve.edges[at, None] + np.diff(curve.edges)[at, None] * SHARES
    y = 2 * (tested.reshape(len(first), -1) - low) / (high - low) - 1
    found = np.polynomial.chebyshev.chebval(y.T, c.T, tensor=False).T
    return c, np.abs(found - curve.values[at].reshape(y.shape)).max(axis=1)


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
