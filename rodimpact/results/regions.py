"""The exact picture of a solution: polygons of constant state in the (x, t) plane.

The two families of fronts cut each segment's strip of the plane into regions in which velocity and
strain are constant. With p and q the ticks at which the waves seen at (x, t) left the left and the
right end, a region is a rectangle in (p, q), cut by the ends of the segment and of the interval;
all its corners have whole p and q. Plots, page and animation draw these polygons.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..methods.signals import Floats, Ints
from ..model import Rod
from ..model.arguments import single
from .solution import Solution, check_solution
from .wave_fields import WaveFields


@dataclass(frozen=True)
class Regions:
    """Polygons of constant state, ordered by body and segment.

    Attributes
    ----------
    body, segment : [n] int
        Body (walls counted) and segment within it.
    velocity, strain, stress : [n]
        m/s, 1, Pa.
    start : [n + 1] int
        Polygon i has the vertices start[i] to start[i + 1].
    x, t, displacement : [vertices]
        m from the left end of the body, s, and m.
    """

    body: Ints
    segment: Ints
    velocity: Floats
    strain: Floats
    stress: Floats
    start: Ints
    x: Floats
    t: Floats
    displacement: Floats

    def __len__(self) -> int:
        return len(self.body)

    def body_of_vertices(self) -> Ints:
        """Body that each vertex belongs to."""
        return np.repeat(self.body, np.diff(self.start))


def regions_of(
    solution: Solution, start: float = 0.0, stop: float | None = None, limit: int = 100_000
) -> Regions:
    """Cut the (x, t) plane of every rod into regions of constant state.

    Parameters
    ----------
    solution : Solution
    start, stop : float
        Interval of time, s; by default the whole solution.
    limit : int
        Largest number of regions wanted.

    Raises
    ------
    ValueError
        If there are more regions than `limit`, the interval is empty or outside the solution, or
        the method has no fronts.
    """
    check_solution(solution)
    fields, first_tick, last_tick = _interval(solution, start, stop)
    limit = int(single("limit", limit, ""))
    if _count(fields, first_tick, last_tick, limit) > limit:
        raise ValueError(f"limit: more than {limit} regions; choose a shorter interval")
    bodies: list[int] = []
    segments: list[int] = []
    counts: list[int] = []
    states: list[tuple[float, float, float]] = []
    xs, ts, us = (list[Floats]([np.empty(0)]) for _ in range(3))
    a = fields.clock
    for body, rod in enumerate(solution.system.bodies):
        if not isinstance(rod, Rod):
            continue
        edges = fields.edges(body)
        for j, piece in enumerate(rod.segments):
            s = a.spans[body][0] + j
            polygons, waves = _polygons(fields, s, first_tick, last_tick)
            corners = np.array([c for polygon in polygons for c in polygon], dtype=np.int64)
            counts += [len(polygon) for polygon in polygons]
            p, q = corners.reshape(-1, 2).T
            xs.append(edges[j] + (q - p + a.ticks[s]) / 2 / a.ticks[s] * a.length[s])
            ts.append((p + q + a.ticks[s]) / 2 * a.tick)
            us.append(fields.displacement_of_waves(s, p, q))
            modulus = float(piece.material.youngs_modulus)
            for right, left in waves:
                eps = (left - right) * (0.5 / a.wave_speed[s])
                states.append(((right + left) / 2 + a.frame, eps, modulus * eps))
            bodies += [body] * len(polygons)
            segments += [j] * len(polygons)
    velocity, strain, stress = np.array(states).reshape(-1, 3).T
    return Regions(
        np.array(bodies), np.array(segments), velocity, strain, stress,
        np.concatenate(([0], np.cumsum(counts))).astype(np.int64),
        np.concatenate(xs), np.concatenate(ts), np.concatenate(us),
    )


def nothing_to_draw(solution: Solution) -> str:
    """Why there is no picture of a solution, with the remedy; "" if there is one."""
    if solution.fields.end > 0:
        return ""
    return f"lasts no time to show, {solution.t_end:.3g} s. {solution.status}"


def readable_until(solution: Solution, limit: int) -> float:
    """Latest of the times t_end, t_end/2, t_end/4, ..., s, up to which there are so few regions.

    Raises
    ------
    ValueError
        If there are more at all times, the solution lasts no time, or the method has no fronts.
    """
    fields, _, last_tick = _interval(solution, 0.0, None)
    stop = solution.t_end
    while last_tick and _count(fields, 0, last_tick, limit) > limit:
        stop /= 2
        last_tick = int(fields.to_ticks(stop))
    if not last_tick:
        raise ValueError(f"solution: has more than {limit} regions of constant state from its "
                         "first instant on, too many for a picture; describe the row in fewer "
                         "pieces")
    return stop


def _interval(solution: Solution, start: float, stop: float | None) -> tuple[WaveFields, int, int]:
    """Fields between whose fronts there are regions, and first and last tick of an interval."""
    fields, stop = solution.fields, solution.t_end if stop is None else stop
    if not isinstance(fields, WaveFields):
        raise ValueError(f'solution: method "{solution.method}" has no fronts to draw between')
    first_tick, last_tick = (int(fields.to_ticks(single(name, t, "s")))
                             for name, t in (("start", start), ("stop", stop)))
    if last_tick <= first_tick:
        raise ValueError(f"stop: must be later than start = {start!r} s, got {stop!r}")
    return fields, first_tick, last_tick


def _count(fields: WaveFields, start: int, stop: int, limit: int) -> int:
    """Number of regions; of more than `limit` not all are counted."""
    segments, count = range(1, len(fields.clock.ticks) - 1), 0
    if len(segments) > limit:  # each has at least one
        return len(segments)
    for s in segments:
        *_, low, high = _rectangles(fields, s, start, stop)
        count += int((high - low).sum())
        if count > limit:
            break
    return count


def _rectangles(fields: WaveFields, s: int, start: int, stop: int) -> tuple[Ints, Ints, Ints, Ints]:
    """Edges p and q of rectangles; those from low[i] to high[i] in q are regions beside p[i]."""
    A, B = fields.waves(s)
    T = fields.clock.ticks[s]
    p, q = (np.concatenate(([start - T], wave.jumps_in(start - T, stop), [stop]))
            for wave in (A, B))
    low = np.searchsorted(q[1:], np.maximum(p[:-1] - T, start - T + (start - p[1:])), "right")
    high = np.searchsorted(q[:-1], np.minimum(p[1:] + T, stop - T + (stop - p[:-1])), "left")
    return p, q, low, high


Corner = tuple[int, int]


def _polygons(
    fields: WaveFields, s: int, start: int, stop: int
) -> tuple[list[list[Corner]], list[tuple[float, float]]]:
    """Regions of one segment as corners (p, q), and the two waves in each."""
    A, B = fields.waves(s)
    T = fields.clock.ticks[s]
    edges_p, edges_q, low, high = _rectangles(fields, s, start, stop)
    right, left = A.at(edges_p[:-1]).tolist(), B.at(edges_q[:-1]).tolist()
    ps, qs = edges_p.tolist(), edges_q.tolist()
    polygons, waves = [], []
    for i, (first, last) in enumerate(zip(low.tolist(), high.tolist(), strict=True)):
        p0, p1 = ps[i : i + 2]
        for j in range(first, last):
            q0, q1 = qs[j : j + 2]
            corners: list[Corner] = [(p0, q0), (p1, q0), (p1, q1), (p0, q1)]
            for normal, bound in (
                ((-1, 1), T), ((1, -1), T), ((1, 1), 2 * stop - T), ((-1, -1), T - 2 * start)
            ):
                corners = _clip(corners, normal, bound)
            polygons.append(corners)
            waves.append((right[i], left[j]))
    return polygons, waves


def _clip(corners: list[Corner], normal: Corner, bound: int) -> list[Corner]:
    """Part of a polygon in which normal . corner <= bound; nothing if that has no area."""
    inside: list[Corner] = []
    n0, n1 = normal
    depth = [bound - n0 * p - n1 * q for p, q in corners]
    if max(depth, default=0) <= 0:
        return []
    for i, (p, q) in enumerate(corners):
        if depth[i] >= 0:
            inside.append((p, q))
        j = (i + 1) % len(corners)
        if depth[i] * depth[j] < 0:
            (pj, qj), change = corners[j], depth[i] - depth[j]
            inside.append((p + (pj - p) * depth[i] // change, q + (qj - q) * depth[i] // change))
    return inside
