"""Waves between fronts in plain lists, and the polygons of constant state that they cut.

For figures and, as JavaScript, for the page. A wave is a table of lists: `tick` of its fronts,
`value` from each of them on, and `passed`, its integral from its first front to each of them.

With p and q the ticks at which the waves seen at (x, t) left the left and the right end, a region
is a rectangle in (p, q), cut by the ends of the segment, |q - p| <= T, and of the interval of time.
"""

from bisect import bisect_left, bisect_right
from typing import Any

Corner = tuple[int, int]


def wave_of(ticks: list[int], values: list[float]) -> Any:
    """A wave, from its fronts."""
    passed = [0.0]
    for i in range(len(ticks) - 1):
        passed.append(passed[i] + values[i] * (ticks[i + 1] - ticks[i]))
    return {"tick": ticks, "value": values, "passed": passed}


def at(wave: Any, tick: int) -> Any:
    """Value of a wave from a tick on."""
    return wave["value"][max(0, bisect_right(wave["tick"], tick) - 1)]


def passed_by(wave: Any, tick: int) -> Any:
    """Integral of a wave from its first front to a tick, velocity times ticks."""
    i = max(0, bisect_right(wave["tick"], tick) - 1)
    return wave["passed"][i] + wave["value"][i] * (tick - wave["tick"][i])


def edges_of(wave: Any, start: int, stop: int) -> list[int]:
    """Ticks of the fronts of a wave between two ticks, and these."""
    return [start, *[tick for tick in wave["tick"] if start < tick < stop], stop]


def stretch_of(piece: Any) -> Any:
    """How much longer a segment is at t = 0 than without strain, velocity times ticks."""
    a, b, T = piece["rightward"], piece["leftward"], piece["ticks"]
    return (passed_by(b, 0) - passed_by(b, -T) - passed_by(a, 0) + passed_by(a, -T)) / 2


def regions_in(piece: Any, start: int, stop: int) -> Any:
    """Ticks at which fronts leave the left and the right end of a segment, and what they cut.

    For each interval of the first ones this is the first interval of the others that makes a region
    with it between `start` and `stop`, and the end.
    """
    T, found = piece["ticks"], []
    ps = edges_of(piece["rightward"], start - T, stop)
    qs = edges_of(piece["leftward"], start - T, stop)
    for i in range(len(ps) - 1):
        low = max(ps[i] - T, start - T + (start - ps[i + 1]))
        high = min(ps[i + 1] + T, stop - T + (stop - ps[i]))
        found.append(
            (bisect_right(qs, low, 1) - 1, bisect_left(qs, high, 0, len(qs) - 1))
        )
    return ps, qs, found


def region(
    p0: int, p1: int, q0: int, q1: int, T: int, start: int, stop: int
) -> list[Corner]:
    """Corners (p, q) of the part of a rectangle that lies in the segment and the interval."""
    corners = [(p0, q0), (p1, q0), (p1, q1), (p0, q1)]
    for n0, n1, bound in (
        (-1, 1, T),
        (1, -1, T),
        (1, 1, 2 * stop - T),
        (-1, -1, T - 2 * start),
    ):
        corners = clip(corners, n0, n1, bound)
    return corners


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


def count_of(rods: Any, start: int, stop: int, limit: float) -> int:
    """Number of regions; of more than `limit` not all are counted."""
    count = 0
    for rod in rods:
        for piece in rod["pieces"]:
            if count <= limit:
                _, _, spans = regions_in(piece, start, stop)
                count += sum(high - low for low, high in spans)
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
    found: Any = {
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
        left, moved = 0.0, 0.0
        for s, piece in enumerate(rod["pieces"]):
            a, b, T, length = (
                piece["rightward"],
                piece["leftward"],
                piece["ticks"],
                piece["length"],
            )
            ps, qs, spans = regions_in(piece, start, stop)
            begun, ready = passed_by(a, 0), passed_by(b, -T)
            for k, (low, high) in enumerate(spans):
                right = at(a, ps[k])
                for j in range(low, high):
                    back = at(b, qs[j])
                    strain = (back - right) * (0.5 / piece["wave_speed"])
                    found["body"].append(rod["body"])
                    found["segment"].append(s)
                    found["velocity"].append((right + back) / 2 + frame)
                    found["strain"].append(strain)
                    found["stress"].append(strain * piece["youngs_modulus"])
                    for p, q in region(
                        ps[k], ps[k + 1], qs[j], qs[j + 1], T, start, stop
                    ):
                        u = (
                            passed_by(a, p)
                            - begun
                            + passed_by(b, q)
                            - ready
                            + frame * (p + q + T)
                        )
                        found["x"].append(left + (q - p + T) / 2 / T * length)
                        found["t"].append((p + q + T) / 2 * tick)
                        found["displacement"].append(u / 2 * tick + moved)
                    found["start"].append(len(found["x"]))
            left += length
            moved += stretch_of(piece) * tick
    return found
