"""Rows of rods with power-law contacts, and their derivatives, by the method of steps.

Nothing here comes from the package. With P_k(t) the impulse of contact k so far, waves
in rods are delays of these impulses, and its overlap is

    d_k(t) = (v_k - v_(k+1)) t - gap_k - c_k P_k(t) + sum of w P_j(t - tau),
    P_k' = K d_k^p,

c_k = 1/Z_k + 1/Z_(k+1), with w = +-2/Z and tau a number of transits of a rod. On
intervals that are shorter than the shortest transit the sum is known, and each contact
is a scalar equation. It is solved by collocation at Chebyshev points. The derivative
Q_k of P_k by a number obeys the linearised equation on the same points.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

NODES = 16
POINTS = (1 - np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)) / 2  # in [0, 1]
SHARES = np.concatenate([[0.0], POINTS, [1.0]])
"""Start, points and end of an interval, as shares of it."""
GRADING = 4.0 ** np.arange(-7, 1)
"""Ends of intervals, as parts of the stretch between two breaks."""
NEAREST = 1e-8
"""Share of a transit at which intervals are no longer graded towards an opening."""
TAIL = 1e-14
"""Largest last coefficients of an interval, beside impulses of about 1."""
CLOSED = 1e-14
"""Overlap, beside 1, at which a contact opens."""
MOST_TRANSITS = 6
"""Transits after which what was a break is smooth."""


def _matrices():
    """Matrices from values at the points to Chebyshev coefficients [order, point], and
    to integrals from 0 to the points and to 1 [point or end, point].
    """
    to_coefficients = np.linalg.inv(chebyshev.chebvander(2 * POINTS - 1, NODES - 1))
    upper_ends = 2 * np.append(POINTS, 1.0) - 1
    integrals = np.zeros((NODES + 1, NODES))
    for n in range(NODES):
        primitive = chebyshev.chebint(np.eye(NODES)[n], lbnd=-1)
        integrals[:, n] = chebyshev.chebval(upper_ends, primitive) / 2
    return to_coefficients, integrals @ to_coefficients


TO_COEFFICIENTS, INTEGRAL = _matrices()


class Row(NamedTuple):
    """Rods (transit time, impedance, velocity) and contacts (gap, stiffness, exponent).

    The derivative of a row by a number is a `Row` as well.
    """

    T: np.ndarray
    Z: np.ndarray
    v: np.ndarray
    gap: np.ndarray
    K: np.ndarray
    p: np.ndarray


def impulses(row, slope, until):
    """Impulses at `until`, and their derivatives where the row changes by `slope`.

    Both are [contact]; `row` and `slope` are a `Row` each.
    """
    contacts = range(len(row.gap))
    edges = [0.0]
    history = []  # of each interval: [contact, (P, force, Q), node]
    P = np.zeros(len(row.gap))
    Q = np.zeros(len(row.gap))
    breaks = _arrivals(0.0, row.T, until)
    terms = [_terms(row, slope, k, until) for k in contacts]
    while edges[-1] < until - 1e-14:
        begin = edges[-1]
        end = _next_edge(begin, breaks, row.T, until)
        changed = False
        while True:  # with a shorter interval each time, until it is resolved
            h = end - begin
            solved = []
            for k in contacts:
                past = _Past(P[k], Q[k], edges, history)
                solved.append(_contact(row, slope, k, terms[k], begin, h, past))
            change = min(s.change for s in solved)
            tail = max(s.tail for s in solved)
            if change < 1 - 1e-13:
                # Intervals become shorter towards the change; the last one ends at it.
                wait = change * h
                changed = wait <= NEAREST * min(row.T)
                end = begin + (wait if changed else 0.5 * wait)
            elif tail > TAIL and h > NEAREST:
                end = begin + 0.5 * h
            else:
                break
        if changed:
            breaks = np.union1d(breaks, _arrivals(end, row.T, until))
        history.append(np.array([[s.P, s.force, s.Q] for s in solved]))
        edges.append(end)
        P = np.array([s.P_end for s in solved])
        Q = np.array([s.Q_end for s in solved])
    return P, Q


def _arrivals(start, T, until):
    """Times before `until` at which what happens at `start` may arrive anywhere.

    They are sums of `start` and up to `MOST_TRANSITS` transit times, in order; of those
    that are equal but for round-off one is kept.
    """
    times_of_arrival = {start}
    newest = {start}
    for _ in range(MOST_TRANSITS):
        later = {t + transit for t in newest for transit in T}
        newest = {t for t in later if t < until}
        times_of_arrival |= newest
    times = np.array(sorted(times_of_arrival))
    is_apart = np.diff(times) > 1e-12
    return times[np.append(True, is_apart)]


def _next_edge(begin, breaks, T, until):
    """End of the interval from `begin` on: the stretch between two breaks is graded,
    small intervals first. It is shorter than half the shortest transit.
    """
    just_after = begin + 1e-13
    last = breaks[np.searchsorted(breaks, just_after) - 1]
    later_breaks = breaks[breaks > just_after]
    stop = until
    if len(later_breaks):
        stop = min(later_breaks[0], until)
    graded = last + (stop - last) * GRADING
    graded = graded[graded > just_after]
    return min(graded[0], begin + 0.9 * min(T) / 2, stop)


class _Term(NamedTuple):
    """A delayed impulse in the overlap of a contact, weight P(t - delay), and
    derivatives.
    """

    contact: int  # that sent the wave
    delay: float
    weight: float
    delay_slope: float
    weight_slope: float


def _terms(row, slope, k, until):
    """Waves that reach contact k until `until`, a `_Term` each. After an odd number of
    transits of a rod beside it, a wave comes from the contact at the other end of this
    rod; after an even number, from contact k itself. A free end sends none.
    """
    terms = []
    for rod, far_contact in ((k, k - 1), (k + 1, k + 1)):
        T = row.T[rod]
        Z = row.Z[rod]
        for n in range(1, int(until / T) + 1):
            sender = k
            weight = -2 / Z
            if n % 2 == 1:
                sender = far_contact
                weight = 2 / Z
            is_contact = 0 <= sender < len(row.gap)
            if is_contact:
                term = _Term(
                    contact=sender,
                    delay=n * T,
                    weight=weight,
                    delay_slope=n * slope.T[rod],
                    weight_slope=-weight / Z * slope.Z[rod],
                )
                terms.append(term)
    return terms


class _Past(NamedTuple):
    """What is known of a contact and of all contacts before an interval."""

    P: float  # impulse at its start
    Q: float  # derivative of this impulse
    edges: list  # of the earlier intervals
    history: list  # of each interval: [contact, (P, force, Q), node]


class _Solved(NamedTuple):
    """One contact over one interval, at the points and at the end."""

    P: np.ndarray  # impulse
    force: np.ndarray
    Q: np.ndarray  # derivative of the impulse
    P_end: float
    Q_end: float
    change: float  # share of the interval after which it opens or closes; else 1
    tail: float  # last coefficients of the force, or of its derivative


def _contact(row, slope, k, terms, begin, h, past):
    """Collocation of contact k over the interval of length h from `begin` on:
    `_Solved`.
    """
    times = begin + h * SHARES
    closing = row.v[k] - row.v[k + 1]  # without forces
    closing_slope = slope.v[k] - slope.v[k + 1]
    free = closing * times - row.gap[k]
    free_slope = closing_slope * times - slope.gap[k]
    # `free` becomes the overlap without the impulse of this contact, `free_slope` its
    # derivative.
    for sender, delay, w, delay_slope, w_slope in terms:
        earlier_P, earlier_F, earlier_Q = _earlier(times - delay, sender, past)
        total_slope = earlier_Q - earlier_F * delay_slope  # of the impulse that arrives
        free += w * earlier_P
        free_slope += w_slope * earlier_P + w * total_slope
    c = 1 / row.Z[k] + 1 / row.Z[k + 1]
    c_slope_left = -slope.Z[k] / row.Z[k] ** 2  # of 1/Z
    c_slope = c_slope_left - slope.Z[k + 1] / row.Z[k + 1] ** 2
    K = row.K[k]
    p = row.p[k]
    inner = INTEGRAL[:-1] * h

    # Newton's method for F = K d^p at the points, where d = free - c P.
    force = np.zeros(NODES)
    for _ in range(60):
        d = free[1:-1] - c * (past.P + inner @ force)
        compression = np.maximum(d, 0.0)
        stiffness = K * p * compression ** (p - 1) * (d > 0)
        off = force - K * compression**p
        jacobian = np.eye(NODES) + (c * stiffness)[:, None] * inner
        step = np.linalg.solve(jacobian, off)
        force -= step
        scale = 1 + np.abs(force).max()
        if np.abs(step).max() <= 1e-15 * scale:
            break
    P = past.P + inner @ force
    to_end = h * INTEGRAL[-1]  # weights of the integral over the whole interval
    P_end = past.P + to_end @ force
    impulse = np.concatenate([[past.P], P, [P_end]])
    overlap = free - c * impulse

    # The same equation, differentiated: Q' = stiffness d_slope + d^p (K_slope + ...).
    inside = overlap[1:-1]
    slope_of_known = free_slope[1:-1] - c_slope * P - c * past.Q
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithm = np.where(inside > 0, np.log(inside), 0.0)
    pushed = np.maximum(inside, 0.0) ** p
    factor_slope = slope.K[k] + K * logarithm * slope.p[k]
    law_slope = pushed * factor_slope
    source = stiffness * slope_of_known + law_slope
    jacobian = np.eye(NODES) + (c * stiffness)[:, None] * inner
    rate = np.linalg.solve(jacobian, source)
    Q = past.Q + inner @ rate
    Q_end = past.Q + to_end @ rate
    force_and_rate = np.array([force, rate])
    last_coefficients = TO_COEFFICIENTS[-2:] @ force_and_rate.T
    tail = h * np.abs(last_coefficients).max()
    change = _crossing(overlap)
    return _Solved(P, force, Q, P_end, Q_end, change, tail)


def _earlier(times, j, past):
    """P, force and Q of contact j at earlier times [3, time]; 0 before the start."""
    edges = past.edges
    values = np.zeros((3, len(times)))
    interval = np.searchsorted(edges, times, side="right") - 1
    interval = np.clip(interval, -1, len(past.history) - 1)
    has_begun = times > 0
    for i in np.unique(interval[has_begun]):
        here = (interval == i) & has_begun
        start = edges[i]
        duration = edges[i + 1] - start
        x = 2 * (times[here] - start) / duration - 1  # from -1 to 1 in the interval
        coefficients = past.history[i][j] @ TO_COEFFICIENTS.T
        values[:, here] = chebyshev.chebval(x, coefficients.T)
    return values


def _crossing(overlap):
    """Share of the interval at which the overlap changes its sign first; 1 if it does
    not.
    """
    sign = np.where(np.abs(overlap) <= CLOSED, 0, np.sign(overlap))
    decided = np.flatnonzero(sign)
    first = decided[:1]
    opposite = decided[sign[decided] != sign[first]]
    if len(opposite) == 0:
        return 1.0
    after = opposite[0]
    before = after - 1
    # The overlap is taken as straight between both points.
    fall = overlap[before] - overlap[after]
    part = overlap[before] / fall
    width = SHARES[after] - SHARES[before]
    return float(SHARES[before] + width * part)
