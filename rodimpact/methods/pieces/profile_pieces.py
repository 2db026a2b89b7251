"""Initial states and drives as pieces.

They are as long as they fit, between the breaks of a profile.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from ...model import Polynomials, Samples, Steps
from ..signals import ROUND_OFF, Floats, Ints, Pieces, each_once
from .lines import CONTINUITY_RTOL
from .records import MAX_HARD_ORDER, PIECE, SMOOTH
from .series import POINTS, SERIES, N, X

MAX_LEVELS = 12
"""Binary logarithm of the number of intervals of the longest piece."""
VALUES_PER_INTERVAL = 6
"""Values in an interval of a signal, whose series has degree 5 at most."""
SHARES = (
    1 - np.cos(np.pi * np.arange(VALUES_PER_INTERVAL) / (VALUES_PER_INTERVAL - 1))
) / 2
"""Chebyshev points, as shares of the width of an interval from 0 to 1."""
_SERIES = np.array(SERIES)
_X = np.array(X)


class Fit(NamedTuple):
    """Pieces that fit a signal, each over one or more of its intervals."""

    first: Ints  # first interval [piece]
    series: Floats  # Chebyshev series [piece, coefficient]
    miss: float  # largest difference from the signal


def signal_of(profile: Any, length: float, ticks_of: Callable[[Any], Ints]) -> Pieces:
    """A profile along a rod, or over time, as a signal in ticks.

    A number makes a constant. The last value holds on. `length` is that of the rod, m,
    or the time, s, over which samples without a step are spread. `ticks_of` makes ticks
    of places, m, or of times, s.
    """
    if isinstance(profile, Steps):
        starts = np.array([0.0, *map(float, profile.at)])
        values = [*map(float, profile.values)]
        return Pieces(ticks_of(starts), values)
    if isinstance(profile, Polynomials):
        return _from_polynomials(profile, length, ticks_of)
    if not isinstance(profile, Samples):
        return Pieces([0], [float(profile)])
    return _from_samples(profile, length, ticks_of)


def _from_samples(
    profile: Samples, length: float, ticks_of: Callable[[Any], Ints]
) -> Pieces:
    """Signal through samples.

    It has straight lines, or is a spline of degree 5 if they are smooth. Samples
    without a step of their own are spread evenly over `length`, m or s. `ticks_of`
    makes ticks of places or times.
    """
    samples = np.asarray(profile.values, dtype=float)
    if profile.step is None:
        step = length / (len(samples) - 1)
    else:
        step = float(profile.step)
    edges = step * np.arange(len(samples))
    ticks = ticks_of(edges)
    if not profile.smooth:
        return Pieces.through(ticks, samples)
    from scipy.interpolate import make_interp_spline

    spline = make_interp_spline(edges, samples, 5)
    # Values in each interval between two samples, [interval, place]
    values = spline(edges[:-1, None] + step * SHARES)
    # The spline passes through the samples but for round-off,
    # which would be a jump of the signal.
    values[:, 0] = samples[:-1]
    values[:, -1] = samples[1:]
    degree = VALUES_PER_INTERVAL - 1
    # Shares run from 0 to 1, y from -1 to 1.
    values_to_series = np.linalg.inv(chebyshev.chebvander(2 * SHARES - 1, degree))
    return Pieces(ticks[:-1], values @ values_to_series.T, ticks[-1])


def _from_polynomials(
    profile: Polynomials, length: float, ticks_of: Callable[[Any], Ints]
) -> Pieces:
    """Signal of polynomials along `length`, m, or over such a time, s.

    `ticks_of` makes ticks of places or times. Polynomials that are shorter than a tick
    are left out.
    """
    ticks = ticks_of(np.array([0.0, *profile.inner, length]))
    ticks = np.minimum(ticks, ticks[-1])  # polynomials in time may go beyond the run
    lasting = np.diff(ticks) > 0
    starts = ticks[:-1][lasting]
    return Pieces(starts, profile.coefficients()[lasting], int(ticks[-1]))


def in_pieces(
    signal: Pieces, start: int, stop: int, break_size: float, largest_miss: float
) -> tuple[Any, float]:
    """A signal between two ticks as pieces that are as long as they fit.

    No piece reaches across a jump, nor into a stretch at the start or end in which the
    signal is constant: nothing may move before a wave arrives. Across kinks a piece may
    reach if it fits. Where pieces meet the order of the break is 0 at a jump, 1 at a
    kink, else SMOOTH. A kink counts if it changes values by more than `break_size`
    until the next break: straight lines between close samples of a smooth curve have
    none. A piece that changes by round-off only is made constant.

    Parameters
    ----------
    signal : Pieces
    start, stop : int
    break_size : float
        Smallest change of values that makes a break.
    largest_miss : float
        Largest miss of a piece in place of several.

    Returns
    -------
    pieces : [n] PIECE
        In order of time, with order and degree set; neither `line` nor `next` is.
    miss : float
        Largest difference from the signal.
    """
    edges = each_once([start], signal.breaks_in(start, stop), [stop])
    round_off = min(ROUND_OFF, largest_miss) * np.abs(signal.coefficients).max()
    # Differences of the values before and after each edge but the first
    changes = np.abs(signal.at(edges[1:], "left") - signal.at(edges[1:]))
    jumps = changes > CONTINUITY_RTOL * break_size + round_off
    borders = _borders_of_rest(signal, edges, round_off)  # [edge]
    # `jumps` and `barriers` leave out the first edge: their place k is edge k + 1.
    barriers = jumps | borders[1:]
    fitted = _fit_longest(signal, edges, barriers, largest_miss)
    first = fitted.first  # interval with which each piece begins, that is its edge
    series = fitted.series
    is_constant = np.abs(series[:, 1:]).sum(axis=1) <= round_off
    series[is_constant, 1:] = 0.0
    inner = first[1:]  # edge between a piece and the next one
    starts = edges[first]
    stops = edges[np.append(inner, -1)]  # the last piece ends at the last edge
    bends = _bends(series, stops - starts, edges, inner)
    # The order of a break is 0 where the value jumps, 1 where the slope does.
    kink_order = np.where(bends > break_size + round_off, 1, SMOOTH)
    signal_order = np.where(jumps[inner - 1], 0, kink_order)
    # The border of a constant stretch is a hard break in any case.
    hard_order = np.minimum(signal_order, MAX_HARD_ORDER)
    order = np.where(borders[inner], hard_order, signal_order)
    pieces = np.zeros(len(series), PIECE)
    pieces["start"] = starts
    pieces["end"] = stops
    pieces["break_order"] = SMOOTH
    pieces["break_order"][1:] = order
    pieces["degree"] = np.where(series[:, 1:].any(axis=1), N, 0)
    pieces["coefficients"] = series
    return pieces, fitted.miss


def _bends(series: Floats, widths: Ints, edges: Ints, inner: Ints) -> Floats:
    """By how much straight lines may miss a smooth curve where two pieces meet.

    Lines between samples w apart of a smooth curve, whose slope changes by k, miss it
    by k w/8. There is one number from each piece to the next, [piece - 1]. The pieces
    last `widths`, ticks; the edges between them have the numbers `inner` among `edges`,
    which are ticks.
    """
    kinks = _kinks(series, widths * 1.0)
    before = edges[inner] - edges[inner - 1]  # width of the interval before the edge
    after = edges[inner + 1] - edges[inner]
    return np.asarray(kinks * np.minimum(before, after) / 8)


def _kinks(series: Floats, widths: Floats) -> Floats:
    """Absolute jumps of the slope between the pieces of `series`, per tick.

    There is one from each piece to the next, [piece - 1]. `widths` are the durations of
    the pieces, ticks. The Chebyshev polynomial T_k has the slope k^2 at 1, and
    (-1)^(k + 1) k^2 at -1; y runs through 2 in a piece.
    """
    k = np.arange(POINTS)
    slopes_at_stop = k**2  # of each T_k, by y
    slopes_at_start = k**2 * (-1.0) ** (k + 1)
    # Slopes of each piece, per tick
    at_stop = series @ slopes_at_stop * 2 / widths
    at_start = series @ slopes_at_start * 2 / widths
    return np.abs(at_start[1:] - at_stop[:-1])


def _borders_of_rest(signal: Pieces, edges: Ints, round_off: float) -> Any:
    """Whether an edge borders the constant stretch at the start or at the end, [edge].

    `edges` are the ticks between the intervals of the signal. Only changes inside of
    intervals count, and none up to `round_off`: jumps at edges are left to the caller.
    Without such a change there is no border. The first edge is never one, the last one
    is if the last interval changes.
    """
    series = signal.cut(edges[:-1], int(edges[-1])).coefficients
    changing = np.flatnonzero(np.abs(series[:, 1:]).sum(axis=1) > round_off)
    borders = np.zeros(len(edges), bool)
    if len(changing):
        first = changing[0]  # interval, whose edges are `first` and `first` + 1
        last = changing[-1]
        borders[first] = first > 0  # there is no stretch before the first edge
        borders[last + 1] = True
    return borders


def _fit_longest(signal: Pieces, edges: Ints, jumps: Any, tolerance: float) -> Fit:
    """Fit pieces of 2^n intervals without a jump inside, in order of time.

    Intervals lie between `edges`, ticks. `jumps` says for each edge after the first
    whether no piece may reach across it. A piece is tried first on all intervals, then
    halved as long as it misses the signal by more than `tolerance`, reaches across a
    jump, or beyond the last interval. An interval by itself keeps the series of the
    signal.
    """
    # Number of jumps up to the start of each interval
    jumps_before = np.cumsum(np.append(0, jumps[:-1]))
    n = len(edges) - 1
    # Number of intervals of a piece: first the least power of 2 that is not below n
    width = 1 << min(MAX_LEVELS, max(n - 1, 0).bit_length())
    tried = np.arange(0, n, width)  # first interval of each piece that is tried
    firsts = list[Ints]()  # first intervals of pieces that fit
    all_series = list[Floats]()
    worst = 0.0
    while width > 1:
        stop = np.minimum(tried + width, n)  # behind the last interval of each piece
        is_whole = tried + width == stop  # it does not go beyond the last interval
        # As many jumps come before its last interval as before its first one.
        has_no_jump = jumps_before[stop - 1] == jumps_before[tried]
        may_fit = is_whole & has_no_jump
        series, misses = _through(signal, edges, tried[may_fit], width)
        fits = misses <= tolerance  # of those that may fit
        is_accepted = may_fit.copy()  # of all that are tried
        is_accepted[may_fit] = fits
        worst = max(worst, misses[fits].max(initial=0.0))
        firsts.append(tried[is_accepted])
        all_series.append(series[fits])
        width //= 2
        halved = tried[~is_accepted]
        tried = np.concatenate((halved, halved + width))  # both halves are tried next
        tried = tried[tried < n]
    # What is left are single intervals.
    own_series = signal.cut(edges[:-1], int(edges[-1])).coefficients[tried]
    single = np.zeros((len(tried), POINTS))
    single[:, : own_series.shape[1]] = own_series
    firsts.append(tried)
    all_series.append(single)
    begin = np.concatenate(firsts)
    order = np.argsort(begin)
    return Fit(begin[order], np.concatenate(all_series)[order], float(worst))


def _through(
    signal: Pieces, edges: Ints, first: Ints, width: int
) -> tuple[Floats, Floats]:
    """Series through `width` intervals from each `first` on, and their misses.

    Series are [piece, coefficient], misses are [piece]. `first` are numbers of
    intervals between `edges`, ticks. The miss of a piece is its largest difference from
    the signal, at `SHARES` of each interval.
    """
    low = edges[first]
    high = edges[first + width]
    durations = (high - low)[:, None]
    values = signal.at(low[:, None] + durations * (_X + 1) / 2)  # [piece, point]
    values[:, -1] = signal.at(high, "left")  # the signal may jump at the end of a piece
    series = values @ _SERIES.T
    intervals = first[:, None] + np.arange(width)  # [piece, interval of the piece]
    starts = edges[intervals]
    stops = edges[intervals + 1]
    # Ticks at which pieces are compared with the signal, [piece, interval, share]
    inside = starts[..., None] + (stops - starts)[..., None] * SHARES
    shape = (len(first), width * VALUES_PER_INTERVAL)
    y = 2 * (inside.reshape(shape) - low[:, None]) / durations - 1
    given = signal.inside(starts.ravel(), stops.ravel(), SHARES)
    exact = given * np.ones(VALUES_PER_INTERVAL)  # a constant signal has one value only
    fitted = chebyshev.chebval(y.T, series.T, tensor=False).T
    misses = np.abs(fitted - exact.reshape(shape))
    return series, misses.max(axis=1, initial=0.0)


def backwards(pieces: Any) -> Any:
    """Pieces with time reversed: from the last to the first, at negative ticks.

    T_m(-y) = (-1)^m T_m(y). The break at the start of a piece is at its end then, and
    so at the start of the next one; the first one has none (SMOOTH). `pieces` is not
    changed.
    """
    back = pieces[::-1].copy()
    back["start"] = -pieces["end"][::-1]
    back["end"] = -pieces["start"][::-1]
    orders_without_first = pieces["break_order"][1:]
    back["break_order"] = [SMOOTH, *orders_without_first[::-1]]
    back["coefficients"] *= (-1.0) ** np.arange(POINTS)
    return back
