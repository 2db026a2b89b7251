"""When it is proved that no contact can press again: bounds of what vibration can do.

A group of bonded segments beside a contact moves with its mean velocity, and its end
deviates from that motion by no more than its energy allows. The proof is as exact as
the run: it holds on fractions, too.
"""

from typing import Any

from .. import finality_kernel as proof
from ..laws import Status
from .records import IDLE, NEVER, NONE, Segment, State

ROUNDED_UP = 1.000001  # of a wait, so that the proof succeeds when it is over


def finality_tick(state: State, now: int) -> int:
    """When the collision can be proved final: `now`, later, or IDLE.

    IDLE is not before a new contact. For rows whose ends are not driven: no bound
    holds for a body that is pushed.
    """
    segments = state.segments
    nodes = state.nodes
    lines = state.lines
    longest = 0.0
    for k in range(len(nodes)):
        node = nodes[k]
        if node.status >= Status.OPEN and longest < NEVER:
            first = segments[k].first
            last = max(k, segments[k + 1].last)
            at_rest = node.gap_rate >= 0 and nothing_under_way(lines, first, last)
            if not at_rest:
                longest = max(longest, ticks_until_apart(state, k, now))
    if longest >= NEVER // 2:
        return IDLE
    wait = 0
    if longest > 0:
        wait = int(longest * ROUNDED_UP) + 1
    return now + wait


def nothing_under_way(lines: Any, first: int, last: int) -> bool:
    """Whether no front is under way in the segments from `first` to `last`."""
    for l in range(2 * first, 2 * last + 2):  # noqa: SIM110 - kernels have no generators
        if lines[l].next_row != NONE:
            return False
    return True


def least_opening(left: Segment, right: Segment, tolerance: Any) -> Any:
    """Least velocity at which two ends can part.

    It is less than any that counts if nothing bounds it: fractions know no infinity.
    """
    if left.bounded and right.bounded:
        return right.slowest - left.fastest
    return -1 - tolerance


def ticks_until_apart(state: State, k: int, now: int) -> float:
    """Ticks until contact k may be proved not to close again, see `finality_kernel`."""
    tolerance = state.runs[0].tolerance
    left = state.segments[k]
    right = state.segments[k + 1]
    find_mean_motions(state, k, now)
    opening = right.mean_velocity - left.mean_velocity
    least = least_opening(left, right, tolerance)
    if proof.undecided(opening, least, tolerance):
        bound_deviations(state, k, now)  # else none are read
    node = state.nodes[k]
    gap = node.gap + node.gap_rate * (now - node.solved)
    mean_gap = gap - right.deviation + left.deviation
    # (p + q)^2 <= 2 (p^2 + q^2) bounds the sum of two roots without a root
    square = 2 * (left.squared_bound + right.squared_bound)
    return proof.separation_time(opening, least, mean_gap, square, tolerance)


# Mean motions -------------------------------------------------------------------------


def find_mean_motions(state: State, k: int, now: int) -> None:
    """Find mean velocities beside contact k, and bounds of the velocities of its ends.

    They are entered at the segments k and k + 1. The bounds hold as long as nothing
    touches a uniform segment that is free (its waves go round unchanged) or goes on
    for ever, a wall, or a group at rest. The mean of what is held, or goes on for ever,
    is that to which it will come.
    """
    for side in range(2):
        s = k + side
        segment = state.segments[s]
        if segment.last > 0:
            find_mean_motion(state, k, s, now)
        else:
            outside = state.lines[2 * k + 3 * side].arrived
            segment.mean_velocity = outside
            segment.slowest = outside
            segment.fastest = outside
            segment.bounded = 1


def find_mean_motion(state: State, k: int, s: int, now: int) -> None:
    """Find the mean motion of the group of segment s, on one side of contact k."""
    segments = state.segments
    nodes = state.nodes
    lines = state.lines
    log = state.log
    group = segments[s]
    first = group.first
    last = group.last
    at_rest = nothing_under_way(lines, first, last)
    pressed = nodes[k].status == Status.PRESS
    mass = 0 * lines[2 * first].arrived  # of both waves: twice that of the group
    momentum = mass
    low = lines[2 * first].arrived
    high = low
    for i in range(first, last + 1):
        impedance = 1 / segments[i].mobility
        transit = segments[i].transit
        mass += 2 * impedance * transit
        for l in range(2 * i, 2 * i + 2):
            r = lines[l].next_row
            wave = lines[l].arrived
            edge = transit
            low = min(low, wave)
            high = max(high, wave)
            while r != NONE:
                front = log[r]
                momentum += impedance * wave * (edge - now + front.tick)
                edge = now - front.tick
                wave = front.value
                low = min(low, wave)
                high = max(high, wave)
                r = front.next_row
            momentum += impedance * wave * edge
    group.mean_velocity = momentum / mass
    group.slowest = low
    group.fastest = high
    group.bounded = 1 if first == last else 0

    endless = False
    for side in range(2):  # what holds the group from outside
        end = last if side else first - 1
        outside = lines[2 * end + 3 * side].arrived
        mobility = segments[end + side].mobility
        if nodes[end].status == Status.BOND:
            group.mean_velocity = outside
            endless = mobility > 0
            if not endless:
                group.bounded = 0
    if at_rest and not (endless and pressed):
        group.slowest = group.mean_velocity
        group.fastest = group.mean_velocity
        group.bounded = 1


# Deviations ---------------------------------------------------------------------------


def bound_deviations(state: State, k: int, now: int) -> None:
    """Find how far the two ends at contact k are from their mean motions, and can get.

    The end of a free body deviates from the motion of its centre of mass by
    d = integral(strain * g dx), g the mass fraction beyond x as seen from that end,
    hence by at most sqrt(2 E integral(g^2 dx/(E A))), E the energy of vibration.
    A wall at the far end has all the mass. A far endless bar of mobility Y gives way by
    Y p, p the momentum that it has taken; as p <= sqrt(2 m E), m Y^2 adds to the
    integral, which is the `compliance`. All is entered at the segments k and k + 1.
    """
    for s in range(k, k + 2):
        segment = state.segments[s]
        zero = 0 * segment.mean_velocity
        segment.deviation = zero
        segment.squared_bound = zero
        segment.compliance = zero
        if segment.last > 0:
            bound_deviation(state, k, s, now)


def bound_deviation(state: State, k: int, s: int, now: int) -> None:
    """Bound the deviation of the group of segment s, on one side of contact k."""
    segments = state.segments
    log = state.log
    group = segments[s]
    first = group.first
    last = group.last
    on_right = s > k
    zero = 0 * group.mean_velocity
    mass = zero
    for i in range(first, last + 1):
        mass += segments[i].transit / segments[i].mobility
    left_bond = state.nodes[first - 1].status == Status.BOND
    held = left_bond or state.nodes[last].status == Status.BOND
    give = zero  # mobility of what holds the far end
    if held:
        far = len(segments) - 1 if on_right else 0
        give += segments[far].mobility

    beyond = zero  # mass fraction beyond the segments so far
    deviation = zero
    energy = zero
    taken = zero
    compliance = mass * give * give
    for i in range(last - first + 1):
        inner = last - i if on_right else first + i  # from the far end to the contact
        transit = segments[inner].transit
        mobility = segments[inner].mobility
        g0 = beyond
        beyond = beyond + transit / (mobility * mass)
        g1 = beyond
        if held:
            g0 = 1 + zero
            g1 = g0
        compliance += mobility * transit * (g0 * g0 + g0 * g1 + g1 * g1) / 3
        for l in range(2 * inner, 2 * inner + 2):
            leftward = l % 2 == 1
            sign = 1 if leftward else -1
            outward = leftward == on_right  # runs towards the end at the contact
            line = state.lines[l]
            r = line.next_row
            wave = line.arrived - group.mean_velocity
            edge = transit
            more = True
            while more:
                more = r != NONE
                low = now - log[r].tick if more else 0
                width = edge - low
                energy += wave * wave * width / (4 * mobility)
                taken += wave * width / (2 * mobility)
                middle = (edge + low) / (2 * transit)
                place = middle if outward else 1 - middle
                deviation += sign * wave * width * (g0 + (g1 - g0) * place) / 2
                if more:
                    edge = low
                    wave = log[r].value - group.mean_velocity
                    r = log[r].next_row
    group.deviation = (-deviation if on_right else deviation) - give * taken
    at_rest = nothing_under_way(state.lines, first, last)
    pressed = state.nodes[k].status == Status.PRESS
    if not at_rest or (give > 0 and pressed):
        group.squared_bound = 2 * energy * compliance
        group.compliance = compliance
