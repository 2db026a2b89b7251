"""How fronts cut the strip of a segment into regions, in whole ticks and plain lists.

With p and q the ticks at which the waves seen at (x, t) left the left and the right end, a region
is a rectangle in (p, q), cut by the ends of the segment, |q - p| <= T, and of the interval of time.
It is the same for figures and, as JavaScript, for the page.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right

Corner = tuple[int, int]


def spans(ps: list[int], qs: list[int], T: int, start: int, stop: int) -> list[tuple[int, int]]:
    """For each interval of ps the first interval of qs that makes a region with it, and the end.

    Parameters
    ----------
    ps, qs : list of int
        Ticks at which fronts left the left and the right end, increasing, from start - T to stop.
    T, start, stop : int
        Transit time of the segment, and the interval of time.
    """
    found = []
    for i in range(len(ps) - 1):
        low = max(ps[i] - T, start - T + (start - ps[i + 1]))
        high = min(ps[i + 1] + T, stop - T + (stop - ps[i]))
        found.append((bisect_right(qs, low, 1) - 1, bisect_left(qs, high, 0, len(qs) - 1)))
    return found


def region(
    p0: int, p1: int, q0: int, q1: int, T: int, start: int, stop: int
) -> list[Corner]:
    """Corners (p, q) of the part of a rectangle that lies in the segment and the interval."""
    corners = [(p0, q0), (p1, q0), (p1, q1), (p0, q1)]
    for n0, n1, bound in (
        (-1, 1, T), (1, -1, T), (1, 1, 2 * stop - T), (-1, -1, T - 2 * start)
    ):
        corners = clip(corners, n0, n1, bound)
    return corners


def clip(corners: list[Corner], n0: int, n1: int, bound: int) -> list[Corner]:
    """Part of a polygon in which n0 p + n1 q <= bound; nothing if that has no area.

    Sides run along p, along q or diagonally, so that they are cut at whole ticks.
    """
    inside: list[Corner] = []
    depth = [bound - n0 * p - n1 * q for p, q in corners]
    deepest = 0
    for d in depth:
        deepest = max(deepest, d)
    if deepest == 0:
        return inside
    for i, (p, q) in enumerate(corners):
        j = (i + 1) % len(corners)
        here, there = depth[i], depth[j]
        if here >= 0:
            inside.append((p, q))
        if (here < 0 and there > 0) or (here > 0 and there < 0):
            pj, qj = corners[j]
            inside.append((along(p, pj, here, there), along(q, qj, here, there)))
    return inside


def along(start: int, stop: int, here: int, there: int) -> int:
    """Where a depth that falls from `here` to `there` is 0; in parts, as products are too large."""
    if start == stop:
        return start
    return start + here // ((here - there) // (stop - start))
