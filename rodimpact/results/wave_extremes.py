"""Exact extremes of the stress in a segment: where its two waves differ most.

The waves A and B leave the left and the right end of a segment of transit time T. A
part of A that left at p meets a part of B that left at q if abs(q - p) <= T: at the
time (p + q + T)/2, at the distance c (q - p + T)/2 from the left end. The stress there
is E/(2 c) times

    d(p, q) = B(q) - A(p).

A run from t = 0 to `end` covers the convex domain with abs(q - p) <= T and
0 <= p + q + T <= 2 end. A and B are polynomials between breaks, and d is the difference
of two functions of one variable each. So d is largest either on one of the four sides
of the domain, where it is a polynomial of one variable between breaks, or inside, at
turning points or breaks of both waves. All times are in ticks.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from ..methods.signals import Floats, Ints, Pieces
from .extreme_stress import EQUAL_STRESS_RTOL
from .segment_waves import SegmentWaves

SLIVER_TICKS = 64
"""Longest duration, ticks, of pieces that only come from rounded transit times.

Such pieces are left out.
"""
INSIDE_TICKS = 16
"""Distance from the end of a piece of the tick to which its last value is assigned."""
NEGLIGIBLE_COEFFICIENT = 2.0**-33
"""Last coefficients of a derivative up to this fraction of the largest are left out.

Without them the zeros of the derivative move so little that the value there changes by
no more than round-off.
"""

Mask = NDArray[np.bool_]


class Meeting(NamedTuple):
    """Two parts of waves that meet."""

    difference: float  # d, m/s
    p: int  # tick at which the part of A left the left end
    q: int  # tick at which the part of B left the right end


class ExtremeMeetings(NamedTuple):
    """The meetings with the highest and the lowest d, the earliest of equal ones."""

    highest: Meeting | None  # None if d is positive nowhere
    lowest: Meeting | None  # None if d is negative nowhere


class Domain(NamedTuple):
    """Two waves from -T to the end of a run, whose parts meet in one segment."""

    A: Pieces  # m/s
    B: Pieces  # m/s
    T: int  # transit time, ticks
    end: int  # last tick of the run


class Side(NamedTuple):
    """The difference d along one side of the domain, over the time of the side.

    p = p_rate time + p_start and q = q_rate time + q_start.
    """

    difference: Pieces  # d, m/s
    p_rate: int  # 1
    p_start: int  # ticks
    q_rate: int  # 1 or -1
    q_start: int  # ticks


class Samples(NamedTuple):
    """Values of a signal where it may be extreme, [sample]."""

    ticks: Ints
    values: Floats  # m/s


class Bounds(NamedTuple):
    """Bounds of a signal in each of its pieces, m/s, [piece]."""

    lower: Floats
    upper: Floats


class Ranges(NamedTuple):
    """Indices of the samples of B that meet each sample of A: first to stop - 1."""

    first: Ints
    stop: Ints


class Zeros(NamedTuple):
    """Zeros of several series, [zero]."""

    series: Ints  # index of the series
    y: Floats  # place of the zero, between -1 and 1


def extreme_differences(waves: SegmentWaves, end: int) -> ExtremeMeetings:
    """Meetings of two waves with the highest and the lowest d = B - A, up to `end`.

    A and B leave the left and the right end of the segment, m/s; `end` is the last tick
    of the run. Each is the earliest such meeting: the highest is None if d is positive
    nowhere, the lowest if it is negative nowhere. The lowest d is found as the highest
    of -d, from -A and -B.
    """
    T = waves.transit
    A = _between(waves.rightward, -T, end)
    B = _between(waves.leftward, -T, end)
    domain = Domain(A, B, T, end)
    sides = _sides(domain)
    highest = _largest_difference(domain, sides)
    opposite = domain._replace(A=A.times(-1.0), B=B.times(-1.0))
    opposite_sides = []
    for side in sides:
        difference = side.difference.times(-1.0)
        opposite_sides.append(side._replace(difference=difference))
    lowest = _largest_difference(opposite, opposite_sides)
    if lowest is not None:
        lowest = lowest._replace(difference=-lowest.difference)
    return ExtremeMeetings(highest, lowest)


def _largest_difference(domain: Domain, sides: list[Side]) -> Meeting | None:
    """The earliest meeting with the largest d; None if d is positive nowhere.

    Meetings on the four sides of the domain and inside it are compared. Values of d
    that differ by no more than round-off, `EQUAL_STRESS_RTOL`, count as equal.
    """
    meetings = []
    largest = 0.0  # m/s; a negative d does not count
    for side in sides:
        meeting = _largest_on_side(side)
        if meeting is not None:
            meetings.append(meeting)
            largest = max(largest, meeting.difference)
    # A meeting inside counts if it is as large as the best one on the sides.
    meeting = _largest_inside(domain, largest * (1 - EQUAL_STRESS_RTOL))
    if meeting is not None:
        meetings.append(meeting)
        largest = max(largest, meeting.difference)
    if largest == 0:
        return None
    equal = []
    for meeting in meetings:
        if meeting.difference >= largest * (1 - EQUAL_STRESS_RTOL):
            equal.append(meeting)
    # The tick of a meeting is (p + q + T)/2, so the earliest has the least p + q.
    return min(equal, key=lambda meeting: meeting.p + meeting.q)


# The sides of the domain --------------------------------------------------------------


def _sides(domain: Domain) -> list[Side]:
    """The four sides: both ends of the segment, and the states at t = 0 and at the end.

    On each side d = B(q) - A(p) is a function of one time. At the left end this is the
    tick t, with p = t and q = t - T; at the right end p = t - T and q = t. For the
    state at the tick t it is the tick p at which A left, with q = 2 t - T - p.
    """
    A = domain.A
    B = domain.B
    T = domain.T
    at_left = _between(B.delayed(T) - A, 0, domain.end)  # B(t - T) - A(t)
    at_right = _between(B - A.delayed(T), 0, domain.end)  # B(t) - A(t - T)
    left_end = Side(at_left, p_rate=1, p_start=0, q_rate=1, q_start=-T)
    right_end = Side(at_right, p_rate=1, p_start=-T, q_rate=1, q_start=0)
    sides = [left_end, right_end]
    for t in (0, domain.end):
        p_plus_q = 2 * t - T
        # B(p_plus_q - p) - A(p)
        state = _between(B.time_reversed(p_plus_q) - A, t - T, t)
        # B may have a break where a piece of the state begins. So p is shifted a little
        # to later ticks, and q by as much to earlier ones.
        q_start = p_plus_q - INSIDE_TICKS
        side = Side(state, p_rate=1, p_start=INSIDE_TICKS, q_rate=-1, q_start=q_start)
        sides.append(side)
    return sides


def _largest_on_side(side: Side) -> Meeting | None:
    """The first meeting with the largest d on a side; None if all pieces are slivers.

    d is evaluated at the edges of its pieces and at turning points. The largest d may
    be negative. Among values that are equal up to round-off the earliest is taken.
    """
    signal = side.difference
    is_long = _exceeds_sliver(signal)
    edges = _edges(signal, is_long)
    if len(edges.values) == 0:
        return None
    # Only pieces that may exceed the largest edge are searched for turning points.
    largest_at_edges = float(edges.values.max())
    may_exceed = _bounds(signal).upper > largest_at_edges
    turning = _turning_points(signal, is_long & may_exceed)
    samples = _joined(edges, turning)
    largest = float(samples.values.max())
    least_equal = largest - abs(largest) * EQUAL_STRESS_RTOL
    equal = np.flatnonzero(samples.values >= least_equal)  # up to round-off
    first = equal[np.argmin(samples.ticks[equal])]  # index of the earliest one
    time = int(samples.ticks[first])
    return Meeting(
        difference=float(samples.values[first]),
        p=side.p_rate * time + side.p_start,
        q=side.q_rate * time + side.q_start,
    )


# Inside the domain --------------------------------------------------------------------


def _largest_inside(domain: Domain, least: float) -> Meeting | None:
    """Earliest meeting with the largest d, at breaks and turning points of both waves.

    None if d is nowhere as large as `least`, m/s. Among values that are equal up to
    round-off the earliest is taken.
    """
    # d = B(q) - A(p) is large where A is low and B is high. A piece is left out if even
    # the best piece of the other wave does not make d as large as `least`.
    lower_A = _bounds(domain.A).lower
    upper_B = _bounds(domain.B).upper
    low = _candidates(domain.A, lower_A <= upper_B.max() - least)
    high = _candidates(domain.B, upper_B >= lower_A.min() + least)
    if len(low.ticks) == 0 or len(high.ticks) == 0:
        return None
    partners = _partners(domain, low.ticks, high.ticks)
    meets = np.flatnonzero(partners.first < partners.stop)  # samples with partners
    if len(meets) == 0:
        return None
    # The largest d of each of these samples of A
    differences = _range_maxima(high.values, partners, meets) - low.values[meets]
    largest = float(differences.max())
    if largest < least:
        return None
    least_equal = largest - abs(largest) * EQUAL_STRESS_RTOL
    best = meets[differences >= least_equal]
    return _earliest(low, high, partners, chosen=best, least=least_equal, T=domain.T)


def _partners(domain: Domain, p: Ints, q: Ints) -> Ranges:
    """For each tick p the range of indices of the ticks q that meet it in the domain.

    The ticks q are in order. In the domain abs(q - p) <= T and 0 <= p + q + T < 2 end.
    A range without any tick has first >= stop.
    """
    T = domain.T
    # p + q + T is twice the tick of a meeting: 0 at t = 0, and less than 2 end, since
    # meetings at the last tick itself belong to a side of the domain.
    earliest_q = np.maximum(p - T, -T - p)
    latest_q = np.minimum(p + T, 2 * domain.end - T - p - 1)
    first = q.searchsorted(earliest_q, side="left")
    stop = q.searchsorted(latest_q, side="right")
    return Ranges(first, stop)


def _range_maxima(values: Floats, ranges: Ranges, chosen: Ints) -> Floats:
    """Maximum of the values in each of the chosen ranges, none of which is empty."""
    bounds = np.stack((ranges.first[chosen], ranges.stop[chosen]), axis=1)
    padded = np.append(values, -np.inf)  # a range may stop after the last value
    # `reduceat` gives in turn the maximum of a range, and that of the values between it
    # and the next range. [::2] keeps the ranges alone.
    return np.asarray(np.maximum.reduceat(padded, bounds.ravel())[::2])


def _earliest(
    low: Samples, high: Samples, partners: Ranges, chosen: Ints, least: float, T: int
) -> Meeting | None:
    """Earliest meeting of the chosen samples of A with d >= `least`; None without any.

    `low` has the samples of A and `high` those of B, both in order of time, and d is
    B(q) - A(p), m/s. `chosen` are indices in `low`, in order. Each must have such a
    meeting among its partners. The tick of a meeting is (p + q + T)/2, so that the
    earliest one has the least p + q.
    """
    earliest: Meeting | None = None
    for k in chosen:
        p = int(low.ticks[k])
        # A part of A that left at p only meets parts of B with q >= p - T, so that
        # p + q >= 2 p - T. Samples are in order of p: later ones have a larger bound.
        least_p_plus_q = 2 * p - T
        if earliest is not None and least_p_plus_q >= earliest.p + earliest.q:
            break
        first = int(partners.first[k])
        stop = int(partners.stop[k])
        differences = high.values[first:stop] - low.values[k]
        j = int(np.argmax(differences >= least))  # the first True: there is one
        q = int(high.ticks[first + j])
        if earliest is None or p + q < earliest.p + earliest.q:
            earliest = Meeting(float(differences[j]), p, q)
    return earliest


# Signals ------------------------------------------------------------------------------


def _between(signal: Pieces, first: int, last: int) -> Pieces:
    """The signal between two ticks, with its breaks there."""
    breaks = signal.breaks
    inside = breaks[(breaks > first) & (breaks < last)]
    return signal.cut(np.append(first, inside), last)


def _bounds(signal: Pieces) -> Bounds:
    """A lower and an upper bound of each piece.

    No Chebyshev polynomial exceeds 1 in a piece.
    """
    middle = signal.coefficients[:, 0]  # that of the constant polynomial
    swing = _sum_of_sizes(signal.coefficients[:, 1:])
    return Bounds(middle - swing, middle + swing)


def _sum_of_sizes(coefficients: Floats) -> Floats:
    """Sum of the absolute coefficients of each series, [series]."""
    return np.asarray(np.abs(coefficients).sum(axis=1))


def _exceeds_sliver(signal: Pieces) -> Mask:
    """Whether each piece lasts longer than a sliver, [piece]."""
    durations = np.diff(signal.ticks, append=signal.end)
    return np.asarray(durations > SLIVER_TICKS)


def _candidates(signal: Pieces, chosen: Mask) -> Samples:
    """Edges and turning points of the chosen pieces, in order of time.

    Slivers, pieces up to `SLIVER_TICKS` that rounding has made, are left out.
    """
    chosen = chosen & _exceeds_sliver(signal)
    edges = _edges(signal, chosen)
    turning = _turning_points(signal, chosen)
    samples = _joined(edges, turning)
    order = np.argsort(samples.ticks, kind="stable")
    return Samples(samples.ticks[order], samples.values[order])


def _joined(first: Samples, second: Samples) -> Samples:
    """The samples of both, one after the other."""
    ticks = np.concatenate((first.ticks, second.ticks))
    values = np.concatenate((first.values, second.values))
    return Samples(ticks, values)


def _edges(signal: Pieces, chosen: Mask) -> Samples:
    """First values of the chosen pieces, then their last values.

    The tick of a last value is `INSIDE_TICKS` before the stop of its piece. If all
    pieces are constant, there are only first values.
    """
    starts = signal.ticks[chosen]
    first_values = Samples(starts, signal.values[chosen])
    if signal.coefficient_count == 1:
        return first_values
    all_stops = np.append(signal.ticks[1:], signal.end)
    stops = all_stops[chosen] - INSIDE_TICKS
    # Every Chebyshev polynomial is 1 at the stop of its piece.
    at_stops = signal.coefficients[chosen].sum(axis=1)
    return _joined(first_values, Samples(stops, at_stops))


def _turning_points(signal: Pieces, chosen: Mask) -> Samples:
    """Values inside the chosen pieces where the derivative is 0; none in straight ones.

    The variable y of a piece runs from -1 at its start to 1 at its stop. The tick of a
    zero at y is (y + 1)/2 of the way through the piece, shortened by `INSIDE_TICKS` at
    both ends.
    """
    # Pieces of fewer than three coefficients are straight.
    if signal.coefficient_count < 3 or not chosen.any():
        return Samples(np.zeros(0, np.int64), np.zeros(0))
    slopes = chebyshev.chebder(signal.coefficients, axis=1)
    # A slope changes its sign only if its other terms can outweigh the constant one.
    swing = _sum_of_sizes(slopes[:, 1:])
    may_change_sign = (swing > 0) & (swing >= np.abs(slopes[:, 0]))
    zeros = _zeros(slopes, np.flatnonzero(chosen & may_change_sign))
    pieces = zeros.series
    values = signal.at_own_time(pieces, zeros.y)
    inner_width = signal.widths[pieces] - 2 * INSIDE_TICKS
    from_inner_start = np.rint((zeros.y + 1) / 2 * inner_width).astype(np.int64)
    ticks = signal.ticks[pieces] + INSIDE_TICKS + from_inner_start
    return Samples(ticks, values)


def _zeros(series: Floats, chosen: Ints) -> Zeros:
    """Zeros between -1 and 1 of the chosen Chebyshev series [series, coefficient].

    `chosen` are indices of series. Zeros are eigenvalues, found together for all series
    of one degree; a constant has none. Real parts of complex zeros are included, which
    does no harm: the signal is only evaluated there.
    """
    degrees = _degrees(series)
    owners: list[Ints] = [np.zeros(0, np.int64)]  # series of each zero
    zeros: list[Floats] = [np.zeros(0)]
    for degree in range(1, series.shape[1]):
        of_degree = chosen[degrees[chosen] == degree]
        if len(of_degree) == 0:
            continue
        # Coefficients above this degree are negligible.
        matrices = _colleague_matrices(series[of_degree, : degree + 1])
        eigenvalues = np.linalg.eigvals(matrices).real
        owners.append(np.repeat(of_degree, degree))
        zeros.append(eigenvalues.ravel())
    owner = np.concatenate(owners)
    y = np.concatenate(zeros)
    inside = np.abs(y) < 1
    return Zeros(owner[inside], y[inside])


def _degrees(series: Floats) -> Ints:
    """Degree of each series without its negligible last coefficients, [series].

    See `NEGLIGIBLE_COEFFICIENT`. A series whose coefficients are all 0 gets the full
    degree.
    """
    sizes = np.abs(series)
    largest = sizes.max(axis=1, keepdims=True)
    is_counted = sizes > largest * NEGLIGIBLE_COEFFICIENT
    # Number of negligible coefficients at the end: index of the first True, counted
    # from the end
    negligible = np.argmax(is_counted[:, ::-1], axis=1)
    return np.asarray(series.shape[1] - 1 - negligible)


def _colleague_matrices(series: Floats) -> Floats:
    """Matrices [series, n, n] whose eigenvalues are the zeros of series of degree n.

    `series` is [series, n + 1]: the coefficients from degree 0 to n, the last of which
    is not 0. At a zero y of a series, its matrix times the vector
    (T_0(y), ..., T_(n - 1)(y)) of Chebyshev polynomials is y times this vector, since
    y T_0 = T_1 and y T_k = (T_(k - 1) + T_(k + 1))/2. Here T_n follows from the series,
    which is 0 (Good, Q. J. Math. 12, 1961).
    """
    count = series.shape[0]
    degree = series.shape[1] - 1
    matrices = np.zeros((count, degree, degree))
    for k in range(degree - 1):
        matrices[:, k, k + 1] = 0.5
        matrices[:, k + 1, k] = 0.5
    # Row 0 is y T_0 = T_1, without the factor 1/2 of the other rows.
    share_of_last = 0.5  # the factor of T_n in the last row
    if degree > 1:
        matrices[:, 0, 1] = 1.0
    else:  # row 0 is the last row
        share_of_last = 1.0
    # Where a series is 0, -T_n is the sum of these times T_0, ..., T_(n - 1).
    minus_last = series[:, :degree] / series[:, degree, None]
    matrices[:, degree - 1, :] -= share_of_last * minus_last
    return matrices
