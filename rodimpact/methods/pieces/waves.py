"""What is known of waves in advance: initial states and drives as pieces."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from ...model import Polynomials, Samples, Steps
from ..signals import ROUND_OFF, Floats, Ints, Pieces, each_once
from .lines import EXACT
from .records import HARD, PIECE, SMOOTH
from .series import POINTS, SERIES, N, X

LEVELS = 12  # pieces of at most 2^12 intervals
INSIDE = 6  # values in an interval: what runs there is of degree 5 at most
_SERIES, _X = np.array(SERIES), np.array(X)
SHARES = (1 - np.cos(np.pi * np.arange(INSIDE) / (INSIDE - 1))) / 2


def signal_of(profile: Any, length: float, ticks_of: Callable[[Any], Ints]) -> Pieces:
    """A profile along a rod of this length, or over time, on whole ticks; its last value holds on.

    `ticks_of` makes ticks of places, m, or of times, s.
    """
    if isinstance(profile, Steps):
        at = np.array([0.0, *map(float, profile.at)])
        return Pieces(ticks_of(at), [*map(float, profile.values)])
    if isinstance(profile, Polynomials):
        return _from_polynomials(profile, length, ticks_of)
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


def _from_polynomials(
    profile: Polynomials, length: float, ticks_of: Callable[[Any], Ints]
) -> Pieces:
    ticks = ticks_of(np.array([0.0, *profile.inner, length]))
    lasting = np.diff(ticks) > 0
    starts = ticks[:-1][lasting]
    return Pieces(starts, profile.coefficients()[lasting], int(ticks[-1]))


def in_pieces(
    signal: Pieces, start: int, stop: int, tolerance: float, fit: float
) -> tuple[Any, float]:
    """A signal between two ticks as pieces that are as long as they fit.

    Pieces begin at breaks of the signal. A kink is one if it changes values by more than the
    tolerance until the next break: straight lines between close samples of a smooth curve have
    none. So does what is constant at first or at last: no piece reaches into it, as nothing may
    move before a wave arrives.

    Parameters
    ----------
    signal : Pieces
    start, stop : int
    tolerance : float
        Smallest change of values that makes a break.
    fit : float
        Largest miss of a piece in place of several.

    Returns
    -------
    made : [n] PIECE
    missed : float
        By how much they miss the signal at most.
    """
    edges = each_once([start], signal.breaks_in(start, stop), [stop])
    least = min(ROUND_OFF, fit) * np.abs(signal.coefficients).max()
    jumps = (
        np.abs(signal.at(edges[1:], "left") - signal.at(edges[1:]))
        > EXACT * tolerance + least
    )
    borders = _borders_of_rest(signal, edges, least)
    first, own, missed = _merged(signal, edges, jumps | borders[1:], fit)
    own[np.abs(own[:, 1:]).sum(axis=1) <= least, 1:] = 0.0  # a constant stays one
    ends, inner = edges[np.append(first[1:], -1)], first[1:]
    widths, k = (ends - edges[first]) * 1.0, np.arange(POINTS)
    right, left = own @ k**2 * 2 / widths, own @ (k**2 * (-1.0) ** (k + 1)) * 2 / widths
    near = np.minimum(edges[inner] - edges[inner - 1], edges[inner + 1] - edges[inner])
    bends = np.abs(left[1:] - right[:-1]) * near / 8
    made = np.zeros(len(own), PIECE)
    made["start"], made["stop"], made["order"] = edges[first], ends, SMOOTH
    made["order"][1:] = np.where(
        jumps[inner - 1], 0, np.where(bends > tolerance + least, 1, SMOOTH)
    )
    starting = borders[first[1:]]
    made["order"][1:] = np.where(
        starting, np.minimum(made["order"][1:], HARD), made["order"][1:]
    )
    made["degree"] = np.where(own[:, 1:].any(axis=1), N, 0)
    made["coefficient"] = own
    return made, missed


def _borders_of_rest(signal: Pieces, edges: Ints, least: float) -> Any:
    """Whether an edge borders the constant stretch at the start or at the end, [edge]."""
    held = signal.cut(edges[:-1], int(edges[-1])).coefficients
    changing = np.flatnonzero(np.abs(held[:, 1:]).sum(axis=1) > least)
    borders = np.zeros(len(edges), bool)
    if len(changing):
        borders[changing[0]] = changing[0] > 0
        borders[changing[-1] + 1] = True
    return borders


def _merged(
    signal: Pieces, edges: Ints, jumps: Any, tolerance: float
) -> tuple[Ints, Floats, float]:
    """First intervals of pieces, their series, and by how much they miss the signal at most."""
    passed = np.cumsum(np.append(0, jumps[:-1]))  # jumps before each interval
    n = len(edges) - 1
    width = 1 << min(LEVELS, max(n - 1, 0).bit_length())
    first, found, worst = np.arange(0, n, width), list[tuple[Ints, Floats]](), 0.0
    while width > 1:  # what does not fit is halved
        last = np.minimum(first + width, n)
        good = (first + width == last) & (passed[last - 1] == passed[first])
        series, missed = _through(signal, edges, first[good], width)
        good[good] = fits = missed <= tolerance
        worst = max(worst, missed[fits].max(initial=0.0))
        found.append((first[good], series[fits]))
        width //= 2
        first = np.concatenate((first[~good], first[~good] + width))
        first = first[first < n]
    given = signal.cut(edges[:-1], int(edges[-1])).coefficients[first]
    single = np.zeros((len(first), POINTS))
    single[:, : given.shape[1]] = given
    begin, own = (np.concatenate(x) for x in zip(*found, (first, single), strict=True))
    order = np.argsort(begin)
    return begin[order], own[order], float(worst)


def _through(
    signal: Pieces, edges: Ints, first: Ints, width: int
) -> tuple[Floats, Floats]:
    """Series through so many intervals from each `first` on, and by how much they miss them."""
    low, high = edges[first], edges[first + width]
    values = signal.at(low[:, None] + (high - low)[:, None] * (_X + 1) / 2)
    values[:, -1] = signal.at(high, "left")
    series = values @ _SERIES.T
    at = first[:, None] + np.arange(width)
    starts, stops = edges[at], edges[at + 1]
    inside = starts[..., None] + (stops - starts)[..., None] * SHARES
    shape = len(first), width * INSIDE
    y = 2 * (inside.reshape(shape) - low[:, None]) / (high - low)[:, None] - 1
    given = signal.inside(starts.ravel(), stops.ravel(), SHARES) * np.ones(INSIDE)
    missed = chebyshev.chebval(y.T, series.T, tensor=False).T - given.reshape(shape)
    return series, np.abs(missed).max(axis=1, initial=0.0)


def backwards(pieces: Any) -> Any:
    """The same with time reversed."""
    back = pieces[::-1].copy()
    back["start"], back["stop"] = -pieces["stop"][::-1], -pieces["start"][::-1]
    back["order"] = [SMOOTH, *pieces["order"][:0:-1]]
    back["coefficient"] *= (-1.0) ** np.arange(POINTS)
    return back
