"""What is known of waves in advance: initial states and drives as pieces."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...model import Samples, Steps
from ..signals import Floats, Ints
from .records import SMOOTH
from .series import POINTS, SERIES, X

LEVELS = 12  # pieces of at most 2^12 straight lines
_SERIES, _X = np.array(SERIES), np.array(X)


class Lines(NamedTuple):
    """Straight lines one after the other: edges [n + 1], values [n] as each begins and as it ends."""

    edges: Any
    begin: Any
    end: Any

    def mapped(self, edges: Any, scale: float, shift: Any) -> Lines:
        """The same over other edges, times `scale` plus what is added at the edges."""
        return Lines(edges, self.begin * scale + shift[:-1], self.end * scale + shift[1:])


def straight(profile: Any, length: float) -> Lines:
    """A profile from 0 to `length` as straight lines; the last value of samples in time holds on."""
    if isinstance(profile, Steps):
        at = [float(x) for x in profile.at if float(x) < length]
        values = np.array([float(v) for v in profile.values[: len(at) + 1]])
        return Lines(np.array([0.0, *at, length]), values, values)
    if isinstance(profile, Samples):
        values = np.asarray(profile.values, dtype=float)
        if profile.step is None:
            edges = np.linspace(0.0, length, len(values))
        else:
            edges = float(profile.step) * np.arange(len(values))
            inside = int(np.searchsorted(edges, length))
            last = float(np.interp(length, edges, values))
            edges, values = np.append(edges[:inside], length), np.append(values[:inside], last)
        return Lines(edges, values[:-1], values[1:])
    return Lines(np.array([0.0, length]), *np.full((2, 1), float(profile)))


def part_of(lines: Lines, start: float, stop: float) -> Lines:
    """The lines between two places."""
    e, b, f = lines
    first = max(int(np.searchsorted(e, start, "right")) - 1, 0)
    last = max(int(np.searchsorted(e, stop, "left")), first + 1)
    edges, begin, end = e[first : last + 1].copy(), b[first:last].copy(), f[first:last].copy()
    slope = (end - begin) / np.diff(edges)
    begin[0] += slope[0] * (start - edges[0])
    end[-1] += slope[-1] * (stop - edges[-1])
    edges[0], edges[-1] = start, stop
    return Lines(edges, begin, end)


def together(first: Lines, second: Lines, factor: float) -> Lines:
    """The first plus `factor` times the second, over the same length."""
    edges = np.unique(np.concatenate((first.edges, second.edges)))
    middles = (edges[1:] + edges[:-1]) / 2
    begin, end = np.zeros((2, len(middles)))
    for lines, scale in ((first, 1.0), (second, factor)):
        i = np.clip(np.searchsorted(lines.edges, middles) - 1, 0, len(lines.begin) - 1)
        slope = (lines.end[i] - lines.begin[i]) / (lines.edges[i + 1] - lines.edges[i])
        begin += scale * (lines.begin[i] + slope * (edges[:-1] - lines.edges[i]))
        end += scale * (lines.begin[i] + slope * (edges[1:] - lines.edges[i]))
    return Lines(edges, begin, end)


class Fitted(NamedTuple):
    """Pieces: ticks [n + 1], coefficients [n, 9], order of the break at the start of each."""

    ticks: Ints
    coefficients: Floats
    order: Ints
    error: float  # by how much they miss the straight lines at most


def fitted(lines: Lines, tolerance: float, window: float) -> Fitted:
    """Straight lines over whole ticks as polynomial pieces, as long as they fit to a tolerance.

    Parameters
    ----------
    lines : Lines
        Edges in ticks.
    tolerance : float
    window : float
        Ticks over which the jump of a slope is measured.
    """
    keep = np.diff(lines.edges) > 0
    edges = np.append(lines.edges[:-1][keep], lines.edges[-1]).astype(np.int64)
    begin, end = lines.begin[keep], lines.end[keep]
    n = len(begin)
    smooth = np.append(np.abs(end[:-1] - begin[1:]) <= 0.0, False)  # nothing jumps behind line i
    taken = np.zeros(n, bool)
    found: list[tuple[int, int, Floats]] = []
    worst = 0.0
    for level in range(min(LEVELS, max(n - 1, 0).bit_length()), 0, -1):
        width = 1 << level
        for i in range(0, n - width + 1, width):
            stop = i + width
            if taken[i] or not smooth[i : stop - 1].all():
                continue
            at, values = edges[i : stop + 1].astype(float), np.append(begin[i:stop], end[stop - 1])
            places = at[0] + (at[-1] - at[0]) * (_X + 1) / 2
            c = _SERIES @ np.interp(places, at, values)
            tested = np.concatenate((at, (at[1:] + at[:-1]) / 2))
            y = 2 * (tested - at[0]) / (at[-1] - at[0]) - 1
            off = np.polynomial.chebyshev.chebval(y, c) - np.interp(tested, at, values)
            miss = float(np.abs(off).max())
            if miss <= tolerance:
                found.append((i, stop, c))
                taken[i:stop] = True
                worst = max(worst, miss)
    for i in np.flatnonzero(~taken).tolist():
        c = np.zeros(POINTS)
        c[0], c[1] = (begin[i] + end[i]) / 2, (end[i] - begin[i]) / 2
        found.append((i, i + 1, c))
    found.sort(key=lambda piece: piece[0])
    first = np.array([i for i, _, _ in found])
    ticks = np.append(edges[first], edges[-1])
    order = np.full(len(found), SMOOTH)
    slope = (end - begin) / np.diff(edges)
    for p, i in enumerate(first.tolist()[1:], 1):
        if end[i - 1] != begin[i]:
            order[p] = 0
        elif abs(slope[i] - slope[i - 1]) * window / 2 > 4 * tolerance:
            order[p] = 1
    return Fitted(ticks, np.array([c for _, _, c in found]), order, worst)
