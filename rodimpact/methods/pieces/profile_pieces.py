"""Initial states and drives as pieces.

A profile becomes a signal in ticks, and the signal is fitted by pieces that are as long
as possible.
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
"""Largest n of pieces over 2^n intervals of a signal."""
VALUES_PER_INTERVAL = 6
"""Number of points of an interval at which a spline is sampled, and a fit checked."""
SHARES = (
    1 - np.cos(np.pi * np.arange(VALUES_PER_INTERVAL) / (VALUES_PER_INTERVAL - 1))
) / 2
"""Chebyshev points of an interval, as shares of its width, from 0 to 1."""
_SERIES = np.array(SERIES)
_X = np.array(X)


class Fit(NamedTuple):
    """Pieces that fit a signal, each over one or more of its intervals."""

    first: Ints  # number of the first interval of each piece, [piece]
    series: Floats  # Chebyshev series, [piece, coefficient]
    miss: float  # largest difference from the signal


def signal_of(profile: Any, length: float, ticks_of: Callable[[Any], Ints]) -> Pieces:
    """A profile along a rod, or over time, as a signal in ticks.

    A number becomes a constant signal. After its end a signal keeps its last value.
    `length` is the length of the rod, m, or the duration, s, over which polynomials,
    and samples without a step of their own, extend. `ticks_of` converts positions, m,
    or times, s, to ticks.
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
    """Signal through samples: straight lines, or a spline of degree 5 if `smooth`.

    Samples without a step of their own are spread evenly over `length`, m or s.
    `ticks_of` converts positions or times to ticks.
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
    # Values at `SHARES` of each interval between two samples, [interval, share]
    values = spline(edges[:-1, None] + step * SHARES)
    # The spline differs from the samples by round-off, which would make small jumps
    # between intervals: the values at both ends are set exactly.
    values[:, 0] = samples[:-1]
    values[:, -1] = samples[1:]
    degree = VALUES_PER_INTERVAL - 1
    # Shares run from 0 to 1, y from -1 to 1: y = 2 share - 1.
    values_to_series = np.linalg.inv(chebyshev.chebvander(2 * SHARES - 1, degree))
    return Pieces(ticks[:-1], values @ values_to_series.T, ticks[-1])


def _from_polynomials(
    profile: Polynomials, length: float, ticks_of: Callable[[Any], Ints]
) -> Pieces:
    """Signal of polynomials that extend over `length`, m or s.

    `ticks_of` converts positions or times to ticks. Polynomials that begin and end at
    the same tick, or begin after `length`, are left out.
    """
    ticks = ticks_of(np.array([0.0, *profile.inner, length]))
    # Borders of polynomials in time may be after the end of the run, `length`.
    ticks = np.minimum(ticks, ticks[-1])
    has_duration = np.diff(ticks) > 0
    starts = ticks[:-1][has_duration]
    return Pieces(starts, profile.coefficients()[has_duration], int(ticks[-1]))


def in_pieces(
    signal: Pieces, start: int, stop: int, break_size: float, largest_miss: float
) -> tuple[Any, float]:
    """Fit a signal between two ticks by pieces that are as long as possible.

    No piece extends across a jump, or into a constant part at the start or the end of
    the signal, since nothing may move before a wave arrives. A piece may extend across
    kinks if it fits. A piece that varies only by round-off is made constant.

    The break between two pieces has order 0 at a jump, 1 at a kink, and MAX_HARD_ORDER
    at the border of a constant part without jump or kink; else it is SMOOTH. A kink
    counts if straight lines with this kink would miss a smooth curve by more than
    `break_size`, see `_kink_sizes`: lines through close samples of a smooth curve have
    none.

    Parameters
    ----------
    signal : Pieces
    start, stop : int
    break_size : float
        Smallest size of a kink; a share of it, CONTINUITY_RTOL, is the smallest jump.
    largest_miss : float
        Largest difference from the signal of a piece over several of its intervals.

    Returns
    -------
    pieces : [n] PIECE
        In order of time; `line` and `next` are not set.
    miss : float
        Largest difference from the signal.
    """
    # Edge k is the start of interval k of the signal.
    edges = each_once([start], signal.breaks_in(start, stop), [stop])
    round_off = min(ROUND_OFF, largest_miss) * np.abs(signal.coefficients).max()
    # Differences of the values before and after each edge; the first edge is left out
    changes = np.abs(signal.at(edges[1:], "left") - signal.at(edges[1:]))
    jumps = changes > CONTINUITY_RTOL * break_size + round_off
    borders = _borders_of_rest(signal, edges, round_off)  # [edge]
    # `jumps` and `barriers` begin with the second edge: index k is edge k + 1.
    barriers = jumps | borders[1:]
    fitted = _fit_longest(signal, edges, barriers, largest_miss)
    first = fitted.first  # first interval of each piece, and the edge at its start
    series = fitted.series
    is_constant = np.abs(series[:, 1:]).sum(axis=1) <= round_off
    series[is_constant, 1:] = 0.0
    inner = first[1:]  # edges between two pieces
    starts = edges[first]
    stops = edges[np.append(inner, -1)]  # the last piece ends at the last edge
    kink_sizes = _kink_sizes(series, stops - starts, edges, inner)
    # Order of a break: 0 where the value jumps, 1 where the slope jumps
    kink_order = np.where(kink_sizes > break_size + round_off, 1, SMOOTH)
    signal_order = np.where(jumps[inner - 1], 0, kink_order)  # edge k is jumps[k - 1]
    # The border of a constant part is always a hard break, one of low order.
    hard_order = np.minimum(signal_order, MAX_HARD_ORDER)
    order = np.where(borders[inner], hard_order, signal_order)
    pieces = np.zeros(len(series), PIECE)
    pieces["start"] = starts
    pieces["end"] = stops
    pieces["break_order"] = SMOOTH  # of the first piece
    pieces["break_order"][1:] = order
    pieces["degree"] = np.where(series[:, 1:].any(axis=1), N, 0)
    pieces["coefficients"] = series
    return pieces, fitted.miss


def _kink_sizes(series: Floats, widths: Ints, edges: Ints, inner: Ints) -> Floats:
    """Size of the kink between each piece and the next one, [piece - 1].

    It is the amount k w/8 by which straight lines between samples at a distance w miss
    a smooth curve, if their slope changes by k at a sample. w is the smaller width of
    the two intervals of the signal that meet at the kink.

    `series` and `widths`, ticks, are the Chebyshev series and the durations of the
    pieces. Piece i + 1 begins at the edge `inner[i]`; `edges` are ticks.
    """
    slope_jumps = _slope_jumps(series, widths * 1.0)  # as floats
    width_before = edges[inner] - edges[inner - 1]
    width_after = edges[inner + 1] - edges[inner]
    return np.asarray(slope_jumps * np.minimum(width_before, width_after) / 8)


def _slope_jumps(series: Floats, widths: Floats) -> Floats:
    """Absolute jump of the slope between each piece and the next one, per tick.

    The result is [piece - 1]. `series` are the Chebyshev series of the pieces, [piece,
    coefficient], `widths` their durations, ticks. The Chebyshev polynomial T_m has the
    derivative m^2 at y = 1, and (-1)^(m+1) m^2 at y = -1.
    """
    m = np.arange(POINTS)
    slopes_at_stop = m**2  # of each T_m, by y
    slopes_at_start = m**2 * (-1.0) ** (m + 1)
    # Slopes of each piece, per tick: y runs through 2 in the width
    at_stop = series @ slopes_at_stop * 2 / widths
    at_start = series @ slopes_at_start * 2 / widths
    return np.abs(at_start[1:] - at_stop[:-1])  # each next piece minus this one


def _borders_of_rest(signal: Pieces, edges: Ints, round_off: float) -> Any:
    """Whether an edge borders a constant part at the start or end of a signal, [edge].

    `edges` are the ticks of the borders between intervals of the signal. A constant
    part at the start lasts up to the first interval in which the signal changes, a part
    at the end begins after the last such interval. Changes up to `round_off` do not
    count, nor do jumps at edges. The first edge is never a border; the last edge is one
    if the last interval changes. If no interval changes, there is no border.
    """
    series = signal.cut(edges[:-1], int(edges[-1])).coefficients
    # Numbers of the intervals in which the signal changes
    changing = np.flatnonzero(np.abs(series[:, 1:]).sum(axis=1) > round_off)
    borders = np.zeros(len(edges), bool)
    if len(changing):
        first = changing[0]
        last = changing[-1]
        borders[first] = first > 0  # edge 0 has no constant part before it
        borders[last + 1] = True  # edge at the end of the interval
    return borders


def _fit_longest(signal: Pieces, edges: Ints, barriers: Any, tolerance: float) -> Fit:
    """Fit a signal by pieces, each over 2^n of its intervals, in order of time.

    Interval k lies between edges[k] and edges[k + 1], ticks. `barriers` says for each
    edge after the first whether pieces may not extend across it. First a piece over all
    intervals is tried, or several over 2^MAX_LEVELS intervals each if there are more. A
    piece is halved, again and again, if it misses the signal by more than `tolerance`,
    extends across a barrier, or beyond the last interval. A single interval keeps the
    series of the signal.
    """
    # Number of barriers up to the start of each interval
    barriers_before = np.cumsum(np.append(0, barriers[:-1]))
    n = len(edges) - 1
    # Number of intervals of a piece: at first the smallest power of 2 that is >= n, but
    # at most 2^MAX_LEVELS
    width = 1 << min(MAX_LEVELS, max(n - 1, 0).bit_length())
    tried = np.arange(0, n, width)  # first interval of each piece that is tried
    firsts = list[Ints]()  # first intervals of pieces that fit
    all_series = list[Floats]()
    worst = 0.0
    while width > 1:
        stop = np.minimum(tried + width, n)  # interval after the last one of each piece
        is_whole = tried + width == stop  # it does not extend beyond the last interval
        # Its first and last interval have the same number of barriers before them.
        has_no_barrier = barriers_before[stop - 1] == barriers_before[tried]
        may_fit = is_whole & has_no_barrier  # [piece that is tried]
        series, misses = _through(signal, edges, tried[may_fit], width)
        fits = misses <= tolerance  # [piece that may fit]
        is_accepted = may_fit.copy()  # [piece that is tried]
        is_accepted[may_fit] = fits
        worst = max(worst, misses[fits].max(initial=0.0))
        firsts.append(tried[is_accepted])
        all_series.append(series[fits])
        width //= 2
        halved = tried[~is_accepted]
        tried = np.concatenate((halved, halved + width))  # both halves are tried next
        tried = tried[tried < n]  # a second half may begin after the last interval
    # The pieces that are left have a single interval each: they keep its series, which
    # may have a lower degree than a piece: its other coefficients are 0.
    own_series = signal.cut(edges[:-1], int(edges[-1])).coefficients[tried]
    single = np.zeros((len(tried), POINTS))
    single[:, : own_series.shape[1]] = own_series
    firsts.append(tried)
    all_series.append(single)
    first = np.concatenate(firsts)
    order = np.argsort(first)
    return Fit(first[order], np.concatenate(all_series)[order], float(worst))


def _through(
    signal: Pieces, edges: Ints, first: Ints, width: int
) -> tuple[Floats, Floats]:
    """Interpolate a signal by pieces over `width` intervals each; return two arrays.

    The first array has the series, [piece, coefficient], the second one the misses,
    [piece]. `first` are the numbers of the first intervals of the pieces; interval k
    lies between edges[k] and edges[k + 1], ticks. The miss of a piece is its largest
    difference from the signal, at `SHARES` of each interval.
    """
    low = edges[first]
    high = edges[first + width]
    durations = (high - low)[:, None]
    values = signal.at(low[:, None] + durations * (_X + 1) / 2)  # [piece, point]
    # If the signal jumps at the end of a piece, the value before the jump is taken.
    values[:, -1] = signal.at(high, "left")
    series = values @ _SERIES.T
    intervals = first[:, None] + np.arange(width)  # [piece, interval of the piece]
    starts = edges[intervals]
    stops = edges[intervals + 1]
    # Ticks at which pieces are compared with the signal, [piece, interval, share]
    ticks = starts[..., None] + (stops - starts)[..., None] * SHARES
    shape = (len(first), width * VALUES_PER_INTERVAL)  # [piece, tick]
    y = 2 * (ticks.reshape(shape) - low[:, None]) / durations - 1
    # A constant signal has only one value in an interval: it is repeated.
    signal_values = signal.inside(starts.ravel(), stops.ravel(), SHARES)
    exact = signal_values * np.ones(VALUES_PER_INTERVAL)
    # `chebval` wants the pieces as the last axis, of y and of the coefficients.
    fitted = chebyshev.chebval(y.T, series.T, tensor=False).T
    misses = np.abs(fitted - exact.reshape(shape))
    return series, misses.max(axis=1, initial=0.0)


def backwards(pieces: Any) -> Any:
    """Pieces with time reversed: tick t becomes -t, and the last piece the first.

    The start of a piece becomes its end, and so the start of the piece that follows it
    now: this piece gets its break. The first piece has none (SMOOTH). The series follow
    from T_m(-y) = (-1)^m T_m(y). `pieces` itself is not changed.
    """
    back = pieces[::-1].copy()
    back["start"] = -pieces["end"][::-1]
    back["end"] = -pieces["start"][::-1]
    # The new start of a piece is its old end, where the piece after it had its break.
    # So piece k gets the old order of piece k + 1: the orders are reversed without the
    # first one, and the last piece, now the first, gets SMOOTH.
    orders_without_first = pieces["break_order"][1:]
    back["break_order"] = [SMOOTH, *orders_without_first[::-1]]
    back["coefficients"] *= (-1.0) ** np.arange(POINTS)
    return back
