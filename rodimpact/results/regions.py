"""The exact picture of a solution: polygons of constant state in the (x, t) plane.

The two families of fronts cut each segment's strip of the plane into regions in which velocity and
strain are constant. Plots, page and animation draw these polygons.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..methods.signals import Floats, Ints
from ..model import Rod
from ..model.arguments import single
from ..model.frozen import refusal
from .clipping import Corner, region, spans
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
    solution: Solution, start: float = 0.0, stop: float | None = None, limit: float = 100_000
) -> Regions:
    """Cut the (x, t) plane of every rod into regions of constant state.

    Parameters
    ----------
    solution : Solution
    start, stop : float
        Interval of time, s; by default the whole solution.
    limit : float
        Largest number of regions wanted; ``math.inf`` for all.

    Returns
    -------
    Regions

    Raises
    ------
    ValueError
        If there are more regions than `limit`, the interval is empty or outside the solution, or
        the method has no fronts.
    """
    check_solution(solution)
    fields, first_tick, last_tick = _interval(solution, start, stop)
    limit = single("limit", limit, "", "")
    if not limit >= 1:
        raise refusal("limit", f"must be 1 or more, got {limit:g}")
    if _count(fields, first_tick, last_tick, limit) > limit:
        raise refusal("limit", f"more than {limit:.15g} regions; choose a shorter interval")
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
    return f"there is nothing to draw, the run ended at {solution.t_end:.3g} s. {solution.status}"


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
        raise refusal("solution", f"has more than {limit} regions of constant state from its "
                         "first instant on, too many for a picture; describe the row in fewer "
                         "pieces")
    return stop


def _interval(solution: Solution, start: float, stop: float | None) -> tuple[WaveFields, int, int]:
    """Fields between whose fronts there are regions, and first and last tick of an interval."""
    fields, stop = solution.fields, solution.t_end if stop is None else stop
    if not isinstance(fields, WaveFields) or not fields.constant_between_fronts:
        raise refusal("solution", f'method "{solution.method}" has no fronts to draw between')
    first_tick, last_tick = (int(fields.to_ticks(single(name, t, "s", "")))
                             for name, t in (("start", start), ("stop", stop)))
    if last_tick <= first_tick:
        raise refusal("stop", f"must be later than start = {start!r} s, got {stop!r}")
    return fields, first_tick, last_tick


def _count(fields: WaveFields, start: int, stop: int, limit: float) -> int:
    """Number of regions; of more than `limit` not all are counted."""
    segments, count = range(1, len(fields.clock.ticks) - 1), 0
    if len(segments) > limit:  # each has at least one
        return len(segments)
    for s in segments:
        rows = spans(*_edges(fields, s, start, stop), fields.clock.ticks[s], start, stop)
        count += sum(end - first for first, end in rows)
        if count > limit:
            break
    return count


def _edges(fields: WaveFields, s: int, start: int, stop: int) -> tuple[list[int], list[int]]:
    """Ticks between which waves leave the left and the right end of a segment."""
    first = start - fields.clock.ticks[s]
    left, right = (
        [first, *wave.breaks_in(first, stop).tolist(), stop] for wave in fields.waves(s)
    )
    return left, right


def _polygons(
    fields: WaveFields, s: int, start: int, stop: int
) -> tuple[list[list[Corner]], list[tuple[float, float]]]:
    """Regions of one segment as corners (p, q), and the two waves in each."""
    (A, B), (ps, qs), T = fields.waves(s), _edges(fields, s, start, stop), fields.clock.ticks[s]
    right, left = A.at(ps[:-1]).tolist(), B.at(qs[:-1]).tolist()
    polygons, waves = [], []
    for i, (first, end) in enumerate(spans(ps, qs, T, start, stop)):
        for j in range(first, end):
            polygons.append(region(ps[i], ps[i + 1], qs[j], qs[j + 1], T, start, stop))
            waves.append((right[i], left[j]))
    return polygons, waves
