"""Waves between fronts in plain lists, and the polygons of constant state that they cut.

For figures and, as JavaScript, for the page. A wave is a table of lists: `tick` of its fronts,
`value` from each of them on, and `passed`, its integral from its first front to each of them.

With p and q the ticks at which the waves seen at (x, t) left the left and the right end, a region
is a rectangle in (p, q), cut by the ends of the segment, |q - p| <= T, and of the interval of time.
"""

from bisect import bisect_left, bisect_right
from typing import Any, NamedTuple

Corner = tuple[int, int]
"""Ticks p and q."""


class Lattice(NamedTuple):
    """Rectangles in (p, q) into which the fronts of both waves cut a segment."""

    # fronts that leave the left end, ticks, and the bounds of the interval
    p: list[int]
    # those that leave the right end
    q: list[int]
    # by rectangle along p: the first one along q that makes a region with it
    first: list[int]
    # the one after the last
    stop: list[int]


def wave_of(ticks: list[int], values: list[float]) -> Any:
    """A wave, from its fronts."""
    passed = [0.0]
    for i in range(len(ticks) - 1):
        passed.append(passed[i] + values[i] * (ticks[i + 1] - ticks[i]))
    return {"tick": ticks, "value": values, "passed": passed}


def front_before(wave: Any, tick: int) -> int:
    """Index of the last front of a wave up to a tick; the first one before it."""
    return max(0, bisect_right(wave["tick"], tick) - 1)


def value_from(wave: Any, tick: int) -> Any:
    """Value of a wave from a tick on."""
    return wave["value"][front_before(wave, tick)]


def integral_to(wave: Any, tick: int) -> Any:
    """Integral of a wave from its first front to a tick, velocity times ticks."""
    i = front_before(wave, tick)
    return wave["passed"][i] + wave["value"][i] * (tick - wave["tick"][i])


def edges_of(wave: Any, start: int, stop: int) -> list[int]:
    """Ticks of the fronts of a wave between two ticks, and these."""
    return [start, *[tick for tick in wave["tick"] if start < tick < stop], stop]


def lengthening_of(piece: Any) -> Any:
    """How much longer a segment is at t = 0 than without strain, velocity times ticks."""
    a = piece["rightward"]
    b = piece["leftward"]
    T = piece["ticks"]
    from_right = integral_to(b, 0) - integral_to(b, -T)
    return (from_right - integral_to(a, 0) + integral_to(a, -T)) / 2


def lattice_of(piece: Any, start: int, stop: int) -> Lattice:
    """Rectangles of a segment between the ticks `start` and `stop`."""
    T = piece["ticks"]
    ps = edges_of(piece["rightward"], start - T, stop)
    qs = edges_of(piece["leftward"], start - T, stop)
    firsts = []
    stops = []
    for i in range(len(ps) - 1):
        low = max(ps[i] - T, start - T + (start - ps[i + 1]))
        high = min(ps[i + 1] + T, stop - T + (stop - ps[i]))
        firsts.append(bisect_right(qs, low, 1) - 1)
        stops.append(bisect_left(qs, high, 0, len(qs) - 1))
    return Lattice(ps, qs, firsts, stops)


def region(
    p_range: tuple[int, int], q_range: tuple[int, int], T: int, start: int, stop: int
) -> list[Corner]:
    """Corners (p, q) of the part of a rectangle that lies in the segment and the interval.

    That is where |q - p| <= T and 2 start <= p + q + T <= 2 stop.
    """
    p0, p1 = p_range
    q0, q1 = q_range
    corners = [(p0, q0), (p1, q0), (p1, q1), (p0, q1)]
    corners = clip(corners, -1, 1, T)
    corners = clip(corners, 1, -1, T)
    corners = clip(corners, 1, 1, 2 * stop - T)
    return clip(corners, -1, -1, T - 2 * start)


def clip(corners: list[Corner], n0: int, n1: int, bound: int) -> list[Corner]:
    """Part of a polygon in which n0 p + n1 q <= bound; nothing if that has no area.

    Sides run along p, along q or diagonally, so that they are cut at whole ticks.
    """
    inside: list[Corner] = []
    depth = [bound - n0 * p - n1 * q for p, q in corners]
    if not any(d > 0 for d in depth):
        return inside
    for i, (p, q) in enumerate(corners):
        j = (i + 1) % len(corners)
        here = depth[i]
        there = depth[j]
        if here >= 0:
            inside.append((p, q))
        if (here < 0 and there > 0) or (here > 0 and there < 0):
            next_p, next_q = corners[j]
            p_cut = crossing(p, next_p, here, there)
            q_cut = crossing(q, next_q, here, there)
            inside.append((p_cut, q_cut))
    return inside


def crossing(start: int, stop: int, here: int, there: int) -> int:
    """Tick at which a depth is 0 that is `here` at `start` and `there` at `stop`.

    The quotient comes first, since products are too large.
    """
    if start == stop:
        return start
    return start + here // ((here - there) // (stop - start))


def count_of(rods: Any, start: int, stop: int, limit: float) -> int:
    """Number of regions; of more than `limit` not all are counted."""
    count = 0
    for rod in rods:
        for piece in rod["pieces"]:
            if count <= limit:
                lattice = lattice_of(piece, start, stop)
                for k in range(len(lattice.first)):
                    count += lattice.stop[k] - lattice.first[k]
    return count


def polygons_of(rods: Any, tick: float, frame: float, start: int, stop: int) -> Any:
    """Polygons of constant state between two ticks, as `Regions` has them.

    Parameters
    ----------
    rods : list of dict
        Each with its ``body`` and its ``pieces``: ``ticks``, ``length``, ``wave_speed`` and
        ``youngs_modulus`` of a segment, and the waves ``rightward`` and ``leftward`` that leave
        its ends, velocities in a frame.
    tick : float
        s.
    frame : float
        Its velocity, m/s.
    start, stop : int
    """
    polygons: Any = {
        "body": [],
        "segment": [],
        "start": [0],
        "x": [],
        "t": [],
        "displacement": [],
        "velocity": [],
        "strain": [],
        "stress": [],
    }
    for rod in rods:
        left = 0.0  # m, of a segment from the left end of the rod
        left_displacement = 0.0  # m, at t = 0
        for s, piece in enumerate(rod["pieces"]):
            a = piece["rightward"]
            b = piece["leftward"]
            T = piece["ticks"]
            length = piece["length"]
            lattice = lattice_of(piece, start, stop)
            ps = lattice.p
            qs = lattice.q
            a_at_start = integral_to(a, 0)
            b_at_start = integral_to(b, -T)
            for k in range(len(lattice.first)):
                a_value = value_from(a, ps[k])
                for j in range(lattice.first[k], lattice.stop[k]):
                    b_value = value_from(b, qs[j])
                    strain = (b_value - a_value) * (0.5 / piece["wave_speed"])
                    polygons["body"].append(rod["body"])
                    polygons["segment"].append(s)
                    polygons["velocity"].append((a_value + b_value) / 2 + frame)
                    polygons["strain"].append(strain)
                    polygons["stress"].append(strain * piece["youngs_modulus"])
                    p_range = (ps[k], ps[k + 1])
                    q_range = (qs[j], qs[j + 1])
                    corners = region(p_range, q_range, T, start, stop)
                    for p, q in corners:
                        twice = (
                            integral_to(a, p)
                            - a_at_start
                            + integral_to(b, q)
                            - b_at_start
                            + frame * (p + q + T)
                        )
                        polygons["x"].append(left + (q - p + T) / 2 / T * length)
                        polygons["t"].append((p + q + T) / 2 * tick)
                        polygons["displacement"].append(
                            twice / 2 * tick + left_displacement
                        )
                    polygons["start"].append(len(polygons["x"]))
            left += length
            left_displacement += lengthening_of(piece) * tick
    return polygons
