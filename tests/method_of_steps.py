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
GRADING = 4.0 ** np.arange(-7, 1)  # parts of the stretch between two breaks
NEAREST = 1e-8  # of a transit: intervals are graded towards an opening, too
TAIL = 1e-14  # beside impulses of about 1
CLOSED = 1e-14  # an overlap, beside 1, at which a contact opens
MOST_TRANSITS = 6  # breaks that have crossed more rods are smooth


def _matrices():
    """Integrals from 0 to the points and to 1, of the polynomial through values
    there.
    """
    to_coefficients = np.linalg.inv(chebyshev.chebvander(2 * POINTS - 1, NODES - 1))
    integrals = np.zeros((NODES + 1, NODES))
    for n in range(NODES):
        whole = chebyshev.chebint(np.eye(NODES)[n], lbnd=-1)
        integrals[:, n] = chebyshev.chebval(2 * np.append(POINTS, 1.0) - 1, whole) / 2
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
    """Impulses at the end, and their derivatives where the row changes by `slope`.

    Parameters
    ----------
    row, slope : Row
    until : float
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
        while True:
            solved = [
                _contact(
                    row,
                    slope,
                    k,
                    terms[k],
                    begin,
                    end - begin,
                    P[k],
                    Q[k],
                    edges,
                    history,
                )
                for k in contacts
            ]
            change = min(s.change for s in solved)
            if change < 1 - 1e-13:
                wait = change * (end - begin)  # until a contact opens or closes
                changed = wait <= NEAREST * min(row.T)
                end = begin + (wait if changed else 0.5 * wait)
            elif max(s.tail for s in solved) > TAIL and end - begin > NEAREST:
                end = begin + 0.5 * (end - begin)
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
    """Times at which what happens at `start` may arrive anywhere."""
    times_of_arrival = {start}
    newest = {start}
    for _ in range(MOST_TRANSITS):
        newest = {t + transit for t in newest for transit in T if t + transit < until}
        times_of_arrival |= newest
    times = np.array(sorted(times_of_arrival))
    return times[np.append(True, np.diff(times) > 1e-12)]


def _next_edge(begin, breaks, T, until):
    """End of the interval: the stretch to the next break is graded, small intervals
    first.
    """
    last = breaks[np.searchsorted(breaks, begin + 1e-13) - 1]
    after = breaks[breaks > begin + 1e-13]
    stop = min(after[0] if len(after) else until, until)
    graded = last + (stop - last) * GRADING
    graded = graded[graded > begin + 1e-13]
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
    """The waves that come to contact k, by the contacts that sent them.

    After an odd number of transits of a rod beside it arrives a wave of the contact at
    the other end of this rod, after an even number one of its own. A free end sends
    none.
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


class _Solved(NamedTuple):
    """One contact over one interval, at the points and at the end."""

    P: np.ndarray  # impulse
    force: np.ndarray
    Q: np.ndarray  # derivative of the impulse
    P_end: float
    Q_end: float
    change: float  # share of the interval after which it opens or closes; else 1
    tail: float  # last coefficients of the force, or of its derivative


def _contact(row, slope, k, terms, begin, h, P0, Q0, edges, history):
    """Collocation of one contact over one interval."""
    times = begin + h * SHARES
    free = (row.v[k] - row.v[k + 1]) * times - row.gap[k]
    by_number = (slope.v[k] - slope.v[k + 1]) * times - slope.gap[k]
    # `free` becomes the overlap without the impulse of this contact, `by_number` its
    # derivative.
    for sender, delay, w, delay_slope, w_slope in terms:
        sent_at = times - delay
        earlier_P, earlier_F, earlier_Q = _earlier(sent_at, sender, edges, history)
        free += w * earlier_P
        by_number += w_slope * earlier_P + w * (earlier_Q - earlier_F * delay_slope)
    c = 1 / row.Z[k] + 1 / row.Z[k + 1]
    c_slope = -slope.Z[k] / row.Z[k] ** 2 - slope.Z[k + 1] / row.Z[k + 1] ** 2
    K = row.K[k]
    p = row.p[k]
    inner = INTEGRAL[:-1] * h
    force = np.zeros(NODES)
    for _ in range(60):
        d = free[1:-1] - c * (P0 + inner @ force)
        stiffness = K * p * np.maximum(d, 0.0) ** (p - 1) * (d > 0)
        off = force - K * np.maximum(d, 0.0) ** p
        step = np.linalg.solve(np.eye(NODES) + (c * stiffness)[:, None] * inner, off)
        force -= step
        if np.abs(step).max() <= 1e-15 * (1 + np.abs(force).max()):
            break
    P = P0 + inner @ force
    P_end = P0 + h * INTEGRAL[-1] @ force
    overlap = free - c * np.concatenate([[P0], P, [P_end]])
    inside = overlap[1:-1]
    slope_of_known = by_number[1:-1] - c_slope * P - c * Q0
    with np.errstate(divide="ignore", invalid="ignore"):
        by_exponent = np.where(inside > 0, np.log(inside), 0.0)
    pushed = np.maximum(inside, 0.0) ** p
    source = stiffness * slope_of_known + pushed * (
        slope.K[k] + K * by_exponent * slope.p[k]
    )
    rate = np.linalg.solve(np.eye(NODES) + (c * stiffness)[:, None] * inner, source)
    Q = Q0 + inner @ rate
    Q_end = Q0 + h * INTEGRAL[-1] @ rate
    tail = h * np.abs(TO_COEFFICIENTS[-2:] @ np.array([force, rate]).T).max()
    return _Solved(P, force, Q, P_end, Q_end, _crossing(overlap), tail)


def _earlier(times, j, edges, history):
    """P, force and Q of contact j at earlier times; 0 before the start."""
    values = np.zeros((3, len(times)))
    interval = np.clip(
        np.searchsorted(edges, times, side="right") - 1, -1, len(history) - 1
    )
    for i in np.unique(interval[times > 0]):
        here = (interval == i) & (times > 0)
        x = 2 * (times[here] - edges[i]) / (edges[i + 1] - edges[i]) - 1
        values[:, here] = chebyshev.chebval(x, (history[i][j] @ TO_COEFFICIENTS.T).T)
    return values


def _crossing(overlap):
    """Share of the interval at which the overlap changes its sign first; 1 if it does
    not.
    """
    sign = np.where(np.abs(overlap) <= CLOSED, 0, np.sign(overlap))
    seen = np.flatnonzero(sign)
    opposite = seen[sign[seen] != sign[seen[:1]]]
    if len(opposite) == 0:
        return 1.0
    after = opposite[0]
    before = after - 1
    part = overlap[before] / (overlap[before] - overlap[after])
    return float(SHARES[before] + (SHARES[after] - SHARES[before]) * part)
