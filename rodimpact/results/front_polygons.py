"""Waves between fronts in plain lists, and the polygons of constant state between them.

For figures and, as JavaScript, for the page. A wave is a table of lists: `tick` of its
fronts, `value` from each of them on, m/s in a frame, and `passed`, its integral from
its first front to each of them, m/s ticks. A piece is a segment of a rod as a table,
see `polygons_of`.

With p and q the ticks at which the waves seen at (x, t) left the left and the right end
of a segment of transit time T, t = (p + q + T)/2. A region of constant state is a
rectangle in (p, q), cut by the ends of the segment, abs(q - p) <= T, and of the
interval of time.
"""

from bisect import bisect_left, bisect_right
from typing import Any, NamedTuple

Corner = tuple[int, int]
"""Ticks p and q."""


class Lattice(NamedTuple):
    """Rectangles in (p, q) into which the fronts of both waves cut a segment.

    Rectangle (k, j) lies between p[k] and p[k + 1], q[j] and q[j + 1]. It has a part in
    the segment and the interval of time if first[k] <= j < stop[k].
    """

    p: list[int]  # ticks of fronts that leave the left end, and the bounds of p
    q: list[int]  # ticks of fronts that leave the right end, and the bounds of q
    first: list[int]
    stop: list[int]


class SegmentStart(NamedTuple):
    """A segment of a rod, and its left end."""

    body: int  # index of the rod in the row
    number: int  # index of the segment in the rod
    x: float  # m from the left end of the rod
    displacement: float  # m, at t = 0


class FrameClock(NamedTuple):
    """How times and velocities of waves are given."""

    tick: float  # s
    frame: float  # velocity of the frame, m/s


def wave_of(ticks: list[int], values: list[float]) -> Any:
    """A wave as a table of three lists, each with an entry for each of its fronts.

    ``tick`` and ``value`` are the arguments themselves: the fronts in order, and the
    value from each of them on, m/s. ``passed`` is the integral from the first front to
    each of them, m/s ticks, so that it begins with 0.
    """
    passed = [0.0]
    for i in range(len(ticks) - 1):
        duration = ticks[i + 1] - ticks[i]
        passed.append(passed[i] + values[i] * duration)
    return {"tick": ticks, "value": values, "passed": passed}


def front_before(wave: Any, tick: int) -> int:
    """Index of the last front of a wave up to a tick; 0 before the first front."""
    return max(0, bisect_right(wave["tick"], tick) - 1)


def value_from(wave: Any, tick: int) -> Any:
    """Value of a wave from a tick on, m/s."""
    return wave["value"][front_before(wave, tick)]


def integral_to(wave: Any, tick: int) -> Any:
    """Integral of a wave from its first front to a tick, m/s ticks."""
    i = front_before(wave, tick)
    since_front = tick - wave["tick"][i]
    return wave["passed"][i] + wave["value"][i] * since_front


def edges_of(wave: Any, start: int, stop: int) -> list[int]:
    """The tick `start`, the fronts of a wave between `start` and `stop`, and `stop`."""
    inside = [tick for tick in wave["tick"] if start < tick < stop]
    return [start, *inside, stop]


def initial_elongation(piece: Any) -> Any:
    """Elongation of a segment at t = 0: integral of (b - a)/2 from -T to 0, m/s ticks.

    Its waves a and b leave the left and the right end, see `polygons_of`, and T is its
    transit time in ticks.
    """
    a = piece["rightward"]
    b = piece["leftward"]
    T = piece["ticks"]
    integral_of_b = integral_to(b, 0) - integral_to(b, -T)
    twice = integral_of_b - integral_to(a, 0) + integral_to(a, -T)
    return twice / 2


def lattice_of(piece: Any, start: int, stop: int) -> Lattice:
    """Rectangles of a segment that have a part between the ticks `start` and `stop`.

    Fronts between the bounds start - T and stop divide p into ranges, and q likewise.
    For each range of p the lattice has the first range of q with such a part, and the
    one after the last.
    """
    T = piece["ticks"]
    p = edges_of(piece["rightward"], start - T, stop)
    q = edges_of(piece["leftward"], start - T, stop)
    last = len(q) - 1
    first = []
    after_last = []
    for k in range(len(p) - 1):
        # In the interval 2 start <= p + q + T <= 2 stop. For p from p[k] to p[k + 1]
        # this bounds q by the largest p from below, by the smallest p from above.
        earliest = start - T + (start - p[k + 1])
        latest = stop - T + (stop - p[k])
        # In the segment abs(q - p) <= T.
        low = max(p[k] - T, earliest)
        high = min(p[k + 1] + T, latest)
        # Range j lasts from q[j] to q[j + 1]. The first one contains `low`; it is range
        # 0 if `low` lies before q[0].
        first.append(bisect_right(q, low, 1) - 1)
        # The ranges before this index begin before `high`. There are `last` ranges.
        after_last.append(bisect_left(q, high, 0, last))
    return Lattice(p, q, first, after_last)


def region(
    p_range: tuple[int, int], q_range: tuple[int, int], T: int, start: int, stop: int
) -> list[Corner]:
    """Corners (p, q) of the part of a rectangle in the segment and the interval.

    The rectangle has the ranges of p and q. Its part is where abs(q - p) <= T and
    2 start <= p + q + T <= 2 stop; no corners if that has no area.
    """
    p0, p1 = p_range
    q0, q1 = q_range
    corners = [(p0, q0), (p1, q0), (p1, q1), (p0, q1)]
    corners = clip(corners, -1, 1, T)  # q - p <= T
    corners = clip(corners, 1, -1, T)  # p - q <= T
    corners = clip(corners, 1, 1, 2 * stop - T)  # p + q <= 2 stop - T
    return clip(corners, -1, -1, T - 2 * start)  # -p - q <= T - 2 start


def clip(corners: list[Corner], n0: int, n1: int, bound: int) -> list[Corner]:
    """Part of a polygon in which n0 p + n1 q <= bound; no corners if that has no area.

    The depth of a corner is bound - n0 p - n1 q: positive inside, 0 on the edge.
    Corners inside and on the edge are kept. A side between corners whose depths have
    different signs is cut where the depth is 0. Sides run along p, along q or
    diagonally, so that they are cut at whole ticks.
    """
    inside: list[Corner] = []
    depth = [bound - n0 * p - n1 * q for p, q in corners]
    if not any(d > 0 for d in depth):
        return inside
    for i in range(len(corners)):
        j = (i + 1) % len(corners)  # the other corner of the side
        here = depth[i]
        there = depth[j]
        if here >= 0:
            inside.append(corners[i])
        crosses_edge = (here < 0 and there > 0) or (here > 0 and there < 0)
        if crosses_edge:
            p, q = corners[i]
            next_p, next_q = corners[j]
            p_cut = crossing(p, next_p, here, there)
            q_cut = crossing(q, next_q, here, there)
            inside.append((p_cut, q_cut))
    return inside


def crossing(start: int, stop: int, here: int, there: int) -> int:
    """Tick at which a linear depth is 0, between the ticks `start` and `stop`.

    The depth is `here` at `start`, and `there` at `stop`; if both ticks are equal, the
    result is that tick. Both divisions are exact, since the cut lies at a whole tick,
    see `clip`. Dividing first avoids products above 2^53, beyond which JavaScript does
    not represent every whole number.
    """
    if start == stop:  # only the other coordinate changes along this side
        return start
    fall_per_tick = (here - there) // (stop - start)
    return start + here // fall_per_tick


def count_of_regions(rods: Any, start: int, stop: int, limit: float) -> int:
    """Number of regions of constant state in rods between two ticks.

    For the rods see `polygons_of`. Counting stops after the segment with which it
    exceeds `limit`: then the count is above `limit`, but not the full number.
    """
    count = 0
    for rod in rods:
        for piece in rod["pieces"]:
            if count <= limit:
                lattice = lattice_of(piece, start, stop)
                for k in range(len(lattice.first)):
                    count += lattice.stop[k] - lattice.first[k]
    return count


def polygons_of(
    rods: Any, tick: float, frame: float, first_tick: int, last_tick: int
) -> Any:
    """Polygons of constant state between two ticks: lists by the names of `Regions`.

    The polygons of all rods are in the same lists, rod by rod and piece by piece. Lists
    have an entry for each polygon, and ``x``, ``t`` and ``displacement`` an entry for
    each vertex. ``start`` has one entry more, the end of the last polygon. In each rod
    x and the initial displacement are measured from its left end.

    Parameters
    ----------
    rods : list of dict
        Each with its ``body`` and its ``pieces``: ``ticks``, ``length``, ``wave_speed``
        and ``youngs_modulus`` of a segment, and the waves ``rightward`` and
        ``leftward`` that leave its ends, velocities in a frame.
    tick : float
        Duration of a tick, s.
    frame : float
        Velocity of the frame in which the waves are given, m/s.
    first_tick, last_tick : int
    """
    polygons: Any = {
        "body": [],
        "segment": [],
        "start": [0],  # index of the first vertex of each polygon, and of the next one
        "x": [],
        "t": [],
        "displacement": [],
        "velocity": [],
        "strain": [],
        "stress": [],
    }
    clock = FrameClock(tick, frame)
    for rod in rods:
        x = 0.0
        displacement = 0.0
        pieces = rod["pieces"]
        for s in range(len(pieces)):
            left = SegmentStart(rod["body"], s, x, displacement)
            add_segment(polygons, pieces[s], left, clock, first_tick, last_tick)
            x += pieces[s]["length"]
            elongation_in_ticks = initial_elongation(pieces[s])  # m/s ticks
            displacement += elongation_in_ticks * tick
    return polygons


def add_segment(
    polygons: Any,
    piece: Any,
    left: SegmentStart,
    clock: FrameClock,
    start: int,
    stop: int,
) -> None:
    """Add the polygons of a segment to the lists of `polygons`, see `polygons_of`.

    Where the wave a that left at p meets the wave b that left at q, the velocity is
    (a + b)/2 + frame and the strain (b - a)/(2 c), at x = (q - p + T)/(2 T) length and
    t = (p + q + T)/2. The displacement is the integral of the velocity, as in
    `SegmentWaves.displacement`.
    """
    a = piece["rightward"]
    b = piece["leftward"]
    T = piece["ticks"]
    length = piece["length"]
    tick = clock.tick
    frame = clock.frame
    per_difference = 0.5 / piece["wave_speed"]  # strain over b - a, s/m
    lattice = lattice_of(piece, start, stop)
    p_edges = lattice.p
    q_edges = lattice.q
    # The displacement at the left end is relative to t = 0, where p = 0 and q = -T.
    a_passed_at_start = integral_to(a, 0)
    b_passed_at_start = integral_to(b, -T)
    for k in range(len(lattice.first)):
        p_range = (p_edges[k], p_edges[k + 1])
        a_value = value_from(a, p_edges[k])
        for j in range(lattice.first[k], lattice.stop[k]):
            q_range = (q_edges[j], q_edges[j + 1])
            b_value = value_from(b, q_edges[j])
            strain = (b_value - a_value) * per_difference
            polygons["body"].append(left.body)
            polygons["segment"].append(left.number)
            polygons["velocity"].append((a_value + b_value) / 2 + frame)
            polygons["strain"].append(strain)
            polygons["stress"].append(strain * piece["youngs_modulus"])
            for p, q in region(p_range, q_range, T, start, stop):
                # Twice the displacement, m/s ticks. p + q + T is twice the tick.
                a_passed = integral_to(a, p) - a_passed_at_start
                twice_in_frame = a_passed + integral_to(b, q) - b_passed_at_start
                twice = twice_in_frame + frame * (p + q + T)
                displacement = twice / 2 * tick + left.displacement
                x = left.x + (q - p + T) / 2 / T * length
                polygons["x"].append(x)
                polygons["t"].append((p + q + T) / 2 * tick)
                polygons["displacement"].append(displacement)
            polygons["start"].append(len(polygons["x"]))
