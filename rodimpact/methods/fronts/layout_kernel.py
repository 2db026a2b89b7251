"""From the numbers of a collision to its clock: durations in whole ticks, and the waves at t = 0.

The initial state is the history of the waves over one transit before t = 0. A profile jumps at
places that follow the tick rule too, and so do the times at which what drives an end jumps.

Kernels: plain Python on lists for one collision, compiled on arrays for a family. The numbers of a
member stand in one row of `given`: wave speed, impedance and length of each segment, the gaps, and
for each body its velocity values, where they jump, strain values, and where those jump. What holds
or drives an end stands there as a body without segments, with values over time.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..tick_rule_kernel import CLOCK_BITS, COARSEST, HORIZON, assign_ticks, clock_bits

TOLERANCE = 2.0**-48
"""Smallest change of a wave that counts as a front, in units of the velocity scale (the spread of
the velocities plus wave speed times strain); the same margin decides whether contacts press or
graze. The error of a wave is at most this, times the number of ends it has passed."""

WINDOW = 40  # a gap that closes within 2^-40 longest transits of an arrival closes with it
LAID, OVERFLOW, LONG, SHORT = range(4)  # what became of a member, see `lay_out`
STEADY, MOVED, PUSHED, ENDLESS = range(4)  # what is outside, see `Make`


class Make(NamedTuple):
    """What all members of a family share."""

    first: Any  # [body] first segment; 1 for a wall
    last: Any  # [body] last segment; 0 for a wall
    node: Any  # [contact]
    profile: Any  # [body] place in a row of `given` of its first velocity value
    jumps: Any  # [2 * body] jumps of its velocity, of its strain
    outside: Any  # [2] STEADY: nothing or a wall; MOVED, PUSHED: velocity or force; ENDLESS: a bar
    size: Any  # [3] segments, numbers in a row of `given`, most fronts at t = 0
    joined: Any  # [2] whether every contact is bonded, and whether any is


class Layout(NamedTuple):
    """Members on their clocks; n segments, so n + 1 nodes; in rows, one a member."""

    transit: Any  # [member * (n + 2)] ticks
    mobility: Any  # [member * (n + 2)] 1/Z, 0 outside but for an endless bar
    gap: Any  # [member * (n + 1)] velocity times ticks
    outside: Any  # [member * 2] waves of the walls
    count: Any  # [member] number of fronts
    tick: Any  # [member * fronts] when a front left its end
    line: Any  # [member * fronts]
    value: Any  # [member * fronts] wave behind it
    tolerance: Any  # [member] velocity
    window: Any  # [member] ticks by which a closing may move to an arrival
    target: Any  # [member] tick to run to, or if negative ticks to run on after the proof
    frame: Any  # [member] velocity of the frame of the waves
    scale: Any  # [member] of velocities
    horizon: Any  # [member] time for which the clock has room
    tick_seconds: Any  # [member] duration of a tick
    short: Any  # [member] segment with the shortest transit


class Work(NamedTuple):
    """Space for one member: m = n + jumps of all profiles; pieces of constant state by segment."""

    duration: Any  # [m] transit times, times from the left end of a segment to its jumps, of drives
    order: Any  # [m]
    p: Any  # [m]
    q: Any  # [m]
    ticks: Any  # [m]
    piece: Any  # [n + 2] first piece of each segment
    velocity: Any  # [m] by piece
    strain: Any  # [m] by piece
    known: Any  # [m] durations of the member before
    memory: Any  # [2] its bits, and the ticks of its longest duration


def inward_sum(values: Any, first: int, count: int) -> float:
    """Sum from both ends to the middle, so that a mirrored row has the same sum, bit for bit."""
    total = 0.0
    for i in range(count // 2):
        total += values[first + i] + values[first + count - 1 - i]
    if count % 2:
        total += values[first + count // 2]
    return total


def cut(make: Make, given: Any, row: int, work: Work) -> int:
    """Cut the segments where a profile jumps; return the number of durations.

    Fills durations, pieces with their velocity and strain, and where each segment's begin; the
    duration of the jump that begins piece i of segment s is at n + i - s.
    """
    n = make.size[0]
    pieces = 0
    for body in range(len(make.first)):
        v, jumps_v, jumps_e = make.profile[body], make.jumps[2 * body], make.jumps[2 * body + 1]
        v += row
        e = v + 2 * jumps_v + 1
        at_v, at_e = v + jumps_v + 1, e + jumps_e + 1
        i, j, left = 0, 0, 0.0
        for s in range(make.first[body], make.last[body] + 1):
            c, L = given[row + s - 1], given[row + 2 * n + s - 1]
            right, x, more = left + L, left, True
            work.duration[s - 1], work.piece[s] = L / c, pieces
            while more:
                while i < jumps_v and given[at_v + i] <= x:
                    i += 1
                while j < jumps_e and given[at_e + j] <= x:
                    j += 1
                work.velocity[pieces], work.strain[pieces] = given[v + i], given[e + j]
                if x > left:
                    work.duration[n + pieces - s] = (x - left) / L * work.duration[s - 1]
                pieces += 1
                x = right
                if i < jumps_v:
                    x = min(x, given[at_v + i])
                if j < jumps_e:
                    x = min(x, given[at_e + j])
                more = x < right
            left = right
    work.piece[n + 1] = pieces
    return pieces


def survey(make: Make, given: Any, row: int, work: Work) -> tuple[float, float]:
    """Frame (that of the walls, else the middle of all velocities) and scale of velocities."""
    n, bodies = make.size[0], len(make.first)
    low, high = math.inf, -math.inf
    strained, walls, fixed, pushed = 0.0, 0, 0.0, 0.0
    for i in range(2):
        body, kind = i * (bodies - 1), make.outside[i]
        for j in range(make.jumps[2 * body] + 1 if make.last[body] == 0 else 0):
            v = given[row + make.profile[body] + j]
            if kind == PUSHED:
                pushed = max(pushed, abs(v))
            elif kind == ENDLESS:
                strained = max(strained, 2 * given[row + i * (n - 1)] * abs(v))
            else:
                low, high = min(low, v), max(high, v)
            if kind == STEADY:
                walls, fixed = walls + 1, fixed + v
    weakest = math.inf
    for s in range(1, n + 1):
        weakest = min(weakest, given[row + n + s - 1])
        for i in range(work.piece[s], work.piece[s + 1]):
            low, high = min(low, work.velocity[i]), max(high, work.velocity[i])
            strained = max(strained, given[row + s - 1] * abs(work.strain[i]))
    frame = low / 2 + high / 2
    if walls > 0:
        frame = fixed / walls
    return frame, high - low + strained + pushed / weakest


def room(
    given: Any, row: int, n: int, gaps: int, longest: float, scale: float, share: float, work: Work
) -> float:
    """Time for which a clock without a given end has room: for this share of `HORIZON` at least."""
    flight = 0.0
    if scale > 0:
        flight = 4 * inward_sum(given, row + 3 * n, gaps) / scale
    horizon = max(share * HORIZON * longest, 16 * inward_sum(work.duration, 0, n), flight)
    return min(horizon, longest * 2.0 ** (CLOCK_BITS - 1 - COARSEST))


def jumps_outside(make: Make, i: int) -> int:
    """How often what drives an end jumps; i is 0 for the left end, 1 for the right one."""
    if make.outside[i] != STEADY:
        return int(make.jumps[2 * i * (len(make.first) - 1)])
    return 0


def drive_times(make: Make, given: Any, row: int, until: float, spare: float, work: Work) -> int:
    """Put the times at which drives jump at the end of the durations; return how many there are.

    `spare` stands for a time that is not reached.
    """
    late = jumps_outside(make, 0) + jumps_outside(make, 1)
    place = len(work.duration) - late
    for i in range(2):
        jumps = jumps_outside(make, i)
        for j in range(jumps):
            at = given[row + make.profile[i * (len(make.first) - 1)] + jumps + 1 + j]
            work.duration[place] = at if at <= until else spare
            place += 1
    return late


def drive(
    make: Make, given: Any, m: int, i: int, until: float, place: int, layout: Layout, work: Work,
    r: int,
) -> int:
    """Write the fronts, from row r on, of what drives end i of the row; return the next.

    They are velocities in the frame, or those that a force gives to the end; or what comes in
    through an endless bar: what left that end last, and the wave of which the strain is given.
    Times of jumps are the durations from `place` on.
    """
    n, sent, jumps, tol = make.size[0], r, jumps_outside(make, i), layout.tolerance[m]
    row = m * make.size[1]
    first = row + make.profile[i * (len(make.first) - 1)]
    at, x1, more, j = first + jumps + 1, 0, True, 0
    came = 0.0
    for f in range(m * make.size[2], r):
        if layout.line[f] == 2 + i * (2 * n - 1):
            came = layout.value[f]
    while more:
        value, x0 = given[first + j], x1
        if make.outside[i] == PUSHED:
            value *= layout.mobility[m * (n + 2) + 1 + i * (n - 1)]
        elif make.outside[i] == ENDLESS:
            value = (4 * i - 2) * given[row + i * (n - 1)] * value + came
        else:
            value -= layout.frame[m]
        more = j < jumps and given[at + j] <= until
        x1 = max(x0, work.ticks[place + j]) if more else x0 + 1
        if x1 > x0 and (r == sent or abs(value - layout.value[r - 1]) > tol):
            layout.tick[r], layout.line[r], layout.value[r] = x0, i * (2 * n + 3), value
            r += 1
        j += 1
    return r


def momentum_varies(make: Make, m: int, layout: Layout) -> bool:
    """Whether what bodies have for momentum after a run depends on when that ends.

    So it is for what radiates, and for what walls or fixed ends of different velocity hold.
    """
    last = len(make.last) - 1
    endless = make.outside[0] == ENDLESS or make.outside[1] == ENDLESS
    held = make.joined[0] == 1 and make.last[0] == 0 and make.last[last] == 0
    return bool(endless or (held and layout.outside[2 * m] != layout.outside[2 * m + 1]))


def round_trip(make: Make, m: int, layout: Layout) -> int:
    """Ticks in which a wave goes through the longest body and back."""
    longest, cell = 0, m * (make.size[0] + 2)
    for body in range(len(make.first)):
        span = 0
        for s in range(make.first[body], make.last[body] + 1):
            span += layout.transit[cell + s]
        longest = max(longest, span)
    return 2 * longest


def fill(c: float, T: int, s: int, n: int, work: Work, frame: float, tol: float, layout: Layout,
         r: int) -> int:
    """Write the fronts, from row r on, that fill segment s with its initial state; return the next.

    Waves a = v - c eps and b = v + c eps in the frame; a piece from x0 to x1 ticks left T - x0 ago
    at the right end and x1 ago at the left one.
    """
    first, end = work.piece[s], work.piece[s + 1]
    for b in range(2):
        sent, sign = r, 2 * b - 1
        for k in range(end - first):
            i = first + k if b else end - 1 - k
            x0 = min(work.ticks[n + i - s], T) if i > first else 0
            x1 = min(work.ticks[n + i + 1 - s], T) if i < end - 1 else T
            wave = work.velocity[i] - frame + sign * c * work.strain[i]
            if x1 > x0 and (r == sent or abs(wave - layout.value[r - 1]) > tol):
                layout.tick[r] = x0 - T if b else -x1
                layout.line[r], layout.value[r] = 2 * s + b, wave
                r += 1
    return r


def lay_out(make: Make, given: Any, m: int, until: float, layout: Layout, work: Work) -> int:
    """Lay out member m on its clock.

    Parameters
    ----------
    make, given, layout, work
        See the head of the file; row m of `layout` is the result.
    m : int
    until : float
        Time to be reached, s; if there is none, minus the share of `HORIZON` for which the clock
        has room, so -1.

    Returns
    -------
    int
        LAID; OVERFLOW: the energy of such velocities and strains is no float; LONG: the run takes
        more ticks than the clock has; SHORT: the transit time of segment `short` is too few ticks.
    """
    n, width, fronts = make.size[0], make.size[1], make.size[2]
    row, cell, node = m * width, m * (n + 2), m * (n + 1)
    durations = cut(make, given, row, work)
    frame, scale = survey(make, given, row, work)
    layout.count[m], layout.frame[m], layout.scale[m] = 0, frame, scale
    largest = 0.0
    longest = 0.0
    for s in range(1, n + 1):
        largest = max(largest, given[row + n + s - 1])
        longest = max(longest, work.duration[s - 1])
    if not scale * scale * largest * 2.0**CLOCK_BITS < math.inf:
        return OVERFLOW
    gaps = len(make.node)
    horizon = until
    if until < 0:
        horizon = room(given, row, n, gaps, longest, scale, -until, work)
    layout.horizon[m] = horizon
    bits = clock_bits(horizon / longest)
    if bits < COARSEST:
        return LONG
    late = drive_times(make, given, row, until, longest, work)
    for i in range(durations, len(work.duration) - late):
        work.duration[i] = longest  # fewer jumps inside than there might be
    known = work.memory[0] == bits  # neighbours in a family often share their lengths
    for i in range(len(work.duration)):
        known = known and work.known[i] == work.duration[i]
    if not known:
        total = assign_ticks(work.duration, bits, work.order, work.p, work.q, work.ticks, late)
        work.memory[0], work.memory[1] = bits, total
        for i in range(len(work.duration)):
            work.known[i] = work.duration[i]
    total = work.memory[1]
    tick_seconds, window, short = longest / total, max(1, total >> WINDOW), 1
    for s in range(1, n + 1):
        T = work.ticks[s - 1]
        if work.ticks[short - 1] > T:
            short = s
        layout.transit[cell + s] = T
        layout.mobility[cell + s] = 1 / given[row + n + s - 1]
    layout.short[m] = short
    if work.ticks[short - 1] <= 4 * window:
        return SHORT
    tol = TOLERANCE * scale
    layout.tick_seconds[m], layout.window[m], layout.tolerance[m] = tick_seconds, window, tol
    for i in range(gaps):
        layout.gap[node + make.node[i]] = given[row + 3 * n + i] / tick_seconds
    for i in range(2):
        body = i * (len(make.first) - 1)
        if make.last[body] == 0 and make.outside[i] == STEADY:
            layout.outside[2 * m + i] = given[row + make.profile[body]] - frame
    layout.target[m] = -1
    if until >= 0:
        layout.target[m] = round(until / tick_seconds)
    elif make.joined[1] == 1 or momentum_varies(make, m, layout):  # bonds never cease to push
        layout.target[m] = -round_trip(make, m, layout)
    r = m * fronts
    for s in range(1, n + 1):
        r = fill(given[row + s - 1], layout.transit[cell + s], s, n, work, frame, tol, layout, r)
    place = len(work.duration) - late
    for i in range(2):
        if make.outside[i] == ENDLESS:
            layout.mobility[cell + i * (n + 1)] = layout.mobility[cell + 1 + i * (n - 1)]
        if make.outside[i] != STEADY:
            r = drive(make, given, m, i, until, place, layout, work, r)
            place += jumps_outside(make, i)
    layout.count[m] = r - m * fronts
    return LAID


def lay_out_all(
    make: Make, given: Any, until: float, layout: Layout, work: Work, fates: Any
) -> None:
    """Lay out every member of a family; `fates` [member] gets what `lay_out` returns."""
    for m in range(len(fates)):
        fates[m] = lay_out(make, given, m, until, layout, work)
