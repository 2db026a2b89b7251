"""Where the two waves in a segment differ most: the exact extreme of the stress.

The waves A and B leave the left and the right end of a segment of transit time T. A part of A that
left at p meets a part of B that left at q if |q - p| <= T: at the time (p + q + T)/2, at the
distance c (q - p + T)/2 from the left end. The stress there is E/(2 c) times

    d(p, q) = B(q) - A(p).

A run from t = 0 to `end` sees the convex domain |q - p| <= T, 0 <= p + q + T <= 2 end. A and B are
polynomials between breaks, and d is the difference of two functions of one variable each. So d is
largest either on one of the four sides of the domain, where it is a polynomial of one variable
between breaks, or inside, at turning points or breaks of both waves.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from ..methods.signals import Floats, Ints, Pieces
from .extreme_stress import EQUAL_STRESS_RTOL

SLIVER_TICKS = 64
"""Pieces that last no longer come of the rounding of transit times, and do not count."""
INSIDE_TICKS = 16
"""Distance from the end of a piece at which its last value is taken to be."""
NEGLIGIBLE_COEFFICIENT = 2.0**-33
"""Coefficients of a derivative below this share of the largest one do not move its zeros by more
than round-off moves the value there."""


class Samples(NamedTuple):
    """Values of a signal at the ticks where it may be extreme."""

    ticks: Ints
    values: Floats


class Meeting(NamedTuple):
    """Two parts of waves that meet: their difference d, and when they left the two ends."""

    difference: float
    p: int
    q: int


class Side(NamedTuple):
    """The difference d along one side of the domain, over the time of the side.

    p = p_rate time + p_start and q = q_rate time + q_start.
    """

    difference: Pieces
    p_rate: int
    p_start: int
    q_rate: int
    q_start: int


def extreme_differences(
    rightward: Pieces, leftward: Pieces, transit: int, end: int
) -> tuple[Meeting | None, Meeting | None]:
    """The meetings with the highest and with the lowest d, the earliest of equal ones.

    Parameters
    ----------
    rightward, leftward : Pieces
        The waves A and B, from -T on.
    transit, end : int
        T and the end of the run, ticks.

    Returns
    -------
    highest, lowest : Meeting or None
        None if d is positive nowhere, or negative nowhere.
    """
    A = _between(rightward, -transit, end)
    B = _between(leftward, -transit, end)
    sides = _sides(A, B, transit, end)
    highest = _largest_difference(A, B, sides, transit, end)
    for i, side in enumerate(sides):
        sides[i] = side._replace(difference=side.difference.times(-1.0))
    lowest = _largest_difference(A.times(-1.0), B.times(-1.0), sides, transit, end)
    if lowest is not None:
        lowest = lowest._replace(difference=-lowest.difference)
    return highest, lowest


def _largest_difference(
    A: Pieces, B: Pieces, sides: list[Side], T: int, end: int
) -> Meeting | None:
    """The meeting with the largest d, the earliest one where several are equal."""
    meetings = []
    largest = 0.0
    for side in sides:
        for d, time in _highest(side.difference):
            p = side.p_rate * time + side.p_start
            q = side.q_rate * time + side.q_start
            meetings.append(Meeting(d, p, q))
            largest = max(largest, d)
    for meeting in _inside(A, B, T, end, largest * (1 - EQUAL_STRESS_RTOL)):
        meetings.append(meeting)
        largest = max(largest, meeting.difference)
    if largest == 0:
        return None
    equal = []
    for meeting in meetings:
        if meeting.difference >= largest * (1 - EQUAL_STRESS_RTOL):
            equal.append(meeting)
    return min(equal, key=lambda meeting: meeting.p + meeting.q)


# The sides of the domain --------------------------------------------------------------


def _sides(A: Pieces, B: Pieces, T: int, end: int) -> list[Side]:
    """The two ends of the segment, the state at t = 0, and that at the end of the run."""
    at_left = _between(B.later(T) - A, 0, end)
    at_right = _between(B - A.later(T), 0, end)
    sides = [Side(at_left, 1, 0, 1, -T), Side(at_right, 1, -T, 1, 0)]
    for t in (0, end):
        total = 2 * t - T  # p + q
        state = _between(B.time_reversed(total) - A, t - T, t)
        # A little inside: where a piece of the state begins, B may have a break.
        sides.append(Side(state, 1, INSIDE_TICKS, -1, total - INSIDE_TICKS))
    return sides


def _highest(signal: Pieces) -> list[tuple[float, int]]:
    """The highest value of a signal and its first tick; none if all pieces are slivers."""
    is_long = _exceeds_sliver(signal)
    edges = _edges(signal, is_long)
    if len(edges.values) == 0:
        return []
    floor = float(edges.values.max())
    _, upper = _bounds(signal)
    turning = _turning_points(signal, is_long & (upper > floor))
    ticks = np.concatenate((edges.ticks, turning.ticks))
    values = np.concatenate((edges.values, turning.values))
    largest = float(values.max())
    equal = np.flatnonzero(values >= largest - abs(largest) * EQUAL_STRESS_RTOL)
    first = equal[np.argmin(ticks[equal])]
    return [(float(values[first]), int(ticks[first]))]


# Inside the domain --------------------------------------------------------------------


def _inside(A: Pieces, B: Pieces, T: int, end: int, floor: float) -> list[Meeting]:
    """The first of the best candidates at breaks and turning points of both waves.

    One meeting, or none: only candidates with a difference of at least `floor` count.
    """
    # d = B(q) - A(p) is large where A is low and B is high.
    lowest, _ = _bounds(A)
    _, highest = _bounds(B)
    low = _candidates(A, lowest <= highest.max() - floor)
    high = _candidates(B, highest >= lowest.min() + floor)
    if len(low.ticks) == 0 or len(high.ticks) == 0:
        return []
    p = low.ticks
    q = high.ticks
    # The last tick is outside: nothing has come of a wave that leaves at the end.
    # Candidate k of A meets those of B from first[k] to last[k] - 1.
    first = q.searchsorted(np.maximum(p - T, -T - p), "left")
    last = q.searchsorted(np.minimum(p + T, 2 * end - T - p - 1), "right")
    meets = np.flatnonzero(first < last)
    if len(meets) == 0:
        return []
    # `reduceat` takes the maximum of each range, and of what lies between two of them.
    ranges = np.stack((first[meets], last[meets]), axis=1).ravel()
    padded = np.append(high.values, -np.inf)
    differences = np.maximum.reduceat(padded, ranges)[::2] - low.values[meets]
    largest = float(differences.max())
    if largest < floor:
        return []
    target = largest - abs(largest) * EQUAL_STRESS_RTOL
    best: list[Meeting] = []
    for k in meets[differences >= target]:
        # Parts that leave an end at p meet nothing before p: q >= p - T.
        if best and 2 * p[k] - T >= best[0].p + best[0].q:
            break
        window = high.values[first[k] : last[k]] - low.values[k]
        j = int(np.argmax(window >= target))
        meeting = Meeting(float(window[j]), int(p[k]), int(q[first[k] + j]))
        if not best or meeting.p + meeting.q < best[0].p + best[0].q:
            best = [meeting]
    return best


# Signals ------------------------------------------------------------------------------


def _between(signal: Pieces, first: int, last: int) -> Pieces:
    """The signal between two ticks."""
    breaks = signal.breaks
    inside = breaks[(breaks > first) & (breaks < last)]
    return signal.cut(np.append(first, inside), last)


def _bounds(signal: Pieces) -> tuple[Floats, Floats]:
    """A lower and an upper bound of each piece: no Chebyshev polynomial exceeds 1."""
    middle = signal.coefficients[:, 0]
    swing = np.abs(signal.coefficients[:, 1:]).sum(axis=1)
    return middle - swing, middle + swing


def _exceeds_sliver(signal: Pieces) -> NDArray[np.bool_]:
    """Whether each piece lasts longer than a sliver."""
    return np.asarray(np.diff(signal.ticks, append=signal.end) > SLIVER_TICKS)


def _candidates(signal: Pieces, chosen: NDArray[np.bool_]) -> Samples:
    """Edges and turning points of some pieces, in order of time."""
    chosen = chosen & _exceeds_sliver(signal)
    edges = _edges(signal, chosen)
    turning = _turning_points(signal, chosen)
    ticks = np.concatenate((edges.ticks, turning.ticks))
    values = np.concatenate((edges.values, turning.values))
    order = np.argsort(ticks, kind="stable")
    return Samples(ticks[order], values[order])


def _edges(signal: Pieces, chosen: NDArray[np.bool_]) -> Samples:
    """The first and the last value of some pieces."""
    starts = signal.ticks[chosen]
    if signal.size == 1:
        return Samples(starts, signal.values[chosen])
    stops = np.append(signal.ticks[1:], signal.end)[chosen] - INSIDE_TICKS
    values = signal.values[chosen], signal.coefficients[chosen].sum(axis=1)
    return Samples(np.concatenate((starts, stops)), np.concatenate(values))


def _turning_points(signal: Pieces, chosen: NDArray[np.bool_]) -> Samples:
    """Ticks inside the chosen pieces at which the derivative vanishes, and values there."""
    # Pieces of fewer than three coefficients are straight.
    if signal.size < 3 or not chosen.any():
        return Samples(np.zeros(0, np.int64), np.zeros(0))
    slopes = chebyshev.chebder(signal.coefficients, axis=1)
    swing = np.abs(slopes[:, 1:]).sum(axis=1)
    # The constant term of a slope keeps its sign where the others cannot outweigh it.
    may_turn = chosen & (swing > 0) & (swing >= np.abs(slopes[:, 0]))
    pieces, y = _zeros(slopes, np.flatnonzero(may_turn))
    values = signal.at_own_time(pieces, y)
    width = signal.widths[pieces] - 2 * INSIDE_TICKS
    ticks_inside = np.rint((y + 1) / 2 * width).astype(np.int64)
    return Samples(signal.ticks[pieces] + INSIDE_TICKS + ticks_inside, values)


def _zeros(series: Floats, chosen: Ints) -> tuple[Ints, Floats]:
    """Zeros between -1 and 1 of some Chebyshev series, with the series that each belongs to.

    The zeros are eigenvalues of the colleague matrix (Good, Q. J. Math. 12, 1961). The real parts
    of complex ones are among them.
    """
    magnitudes = np.abs(series)
    largest = magnitudes.max(axis=1, keepdims=True)
    counts = magnitudes > largest * NEGLIGIBLE_COEFFICIENT
    degrees = series.shape[1] - 1 - np.argmax(counts[:, ::-1], axis=1)
    owners: list[Ints] = [np.zeros(0, np.int64)]
    zeros: list[Floats] = [np.zeros(0)]
    for degree in range(1, series.shape[1]):
        same = chosen[degrees[chosen] == degree]
        if len(same) == 0:
            continue
        colleague = np.zeros((len(same), degree, degree))
        for k in range(degree - 1):
            colleague[:, k, k + 1] = 0.5
            colleague[:, k + 1, k] = 0.5
        if degree > 1:
            colleague[:, 0, 1] = 1.0
        last = series[same, :degree] / series[same, degree, None]
        # y times T_(degree - 1), with T_degree from the series; y T_0 = T_1 has no half.
        share = 1.0 if degree == 1 else 0.5
        colleague[:, degree - 1, :] -= share * last
        roots = np.linalg.eigvals(colleague).real
        owners.append(np.repeat(same, degree))
        zeros.append(roots.ravel())
    owner = np.concatenate(owners)
    y = np.concatenate(zeros)
    inside = np.abs(y) < 1
    return owner[inside], y[inside]
