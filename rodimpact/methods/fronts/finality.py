"""When it is proved that no contact can press again: bounds of what vibration can do.

A group of bonded segments beside a contact moves with its mean velocity, and its end deviates from
that motion by no more than its energy allows. The proof is kept as exact as the run: it holds on
fractions, too.
"""

from typing import Any

from .. import finality_kernel as proof
from ..laws import Status
from .records import IDLE, NEVER, NONE


def quiet(line: Any, first: int, last: int) -> bool:
    """Whether no front is under way in these segments."""
    for l in range(2 * first, 2 * last + 2):  # noqa: SIM110
        if line[l].head != NONE:
            return False
    return True


def survey(segment: Any, node: Any, line: Any, log: Any, k: int, t: int) -> None:
    """Find the mean velocities beside contact k, and bounds of the velocities of its two ends.

    They are entered at the segments k and k + 1. The bounds hold as long as nothing touches
    a uniform segment that is free (its waves go round unchanged) or goes on for ever, a wall, or a
    group at rest. The mean of what is held, or goes on for ever, is that to which it will come.
    """
    for s in range(k, k + 2):
        it = segment[s]
        if it.last > 0:
            survey_group(segment, node, line, log, k, s, t)
        else:
            it.mean = it.low = it.high = line[2 * k + 3 if s > k else 2 * k].arrived
            it.bounded = 1


def survey_group(segment: Any, node: Any, line: Any, log: Any, k: int, s: int, t: int) -> None:
    """Survey the group on one side of contact k, that of segment s."""
    it, first, last = segment[s], segment[s].first, segment[s].last
    silent, pressed = quiet(line, first, last), node[k].status == Status.PRESS
    mass, endless = 0 * line[2 * first].arrived, False
    momentum, low, high = mass, line[2 * first].arrived, line[2 * first].arrived
    for i in range(first, last + 1):
        Z = 1 / segment[i].mobility
        mass += 2 * Z * segment[i].transit
        for l in range(2 * i, 2 * i + 2):
            r, wave, edge = line[l].head, line[l].arrived, segment[i].transit
            low, high = min(low, wave), max(high, wave)
            while r != NONE:
                momentum += Z * wave * (edge - t + log[r].tick)
                edge, wave = t - log[r].tick, log[r].value
                low, high = min(low, wave), max(high, wave)
                r = log[r].after
            momentum += Z * wave * edge
    it.mean, it.low, it.high = momentum / mass, low, high
    it.bounded = 1 if first == last else 0
    for end in (first - 1, last):
        if node[end].status == Status.BOND:
            outer = end if end < first else last + 1
            it.mean = line[0 if end < first else 2 * last + 3].arrived
            endless = segment[outer].mobility > 0
            it.bounded = 1 if it.bounded and endless else 0
    if silent and not (endless and pressed):
        it.low, it.high, it.bounded = it.mean, it.mean, 1


def bound_deviations(segment: Any, node: Any, line: Any, log: Any, k: int, t: int) -> None:
    """Find how far the two ends at contact k are from their mean motions, and can ever get.

    The end of a free body deviates from the motion of the centre of mass by
    d = integral(strain * g dx), g the mass fraction beyond x as seen from that end, hence by at
    most sqrt(2 E integral(g^2 dx/(E A))), E the energy of vibration. A wall at the far end has all
    the mass. A far endless bar of mobility Y gives way by Y p, p the momentum that it has taken; as
    p <= sqrt(2 m E), m Y^2 adds to the integral. Entered at the segments k and k + 1 are
    the deviation now, positive to the right, the integral, and the square of the bound.
    """
    for s in range(k, k + 2):
        it = segment[s]
        it.deviation = it.bound = it.slack = 0 * it.mean
        if it.last > 0:
            bound_group(segment, node, line, log, k, s, t)


def bound_group(segment: Any, node: Any, line: Any, log: Any, k: int, s: int, t: int) -> None:
    """Find this for the group on one side of contact k, that of segment s."""
    it, right = segment[s], s > k
    first, last, mass, zero = it.first, it.last, 0 * it.mean, 0 * it.mean
    for i in range(first, last + 1):
        mass += segment[i].transit / segment[i].mobility
    held = node[first - 1].status == Status.BOND or node[last].status == Status.BOND
    silent, pressed, give = quiet(line, first, last), node[k].status == Status.PRESS, zero
    if held:
        give += segment[len(segment) - 1 if right else 0].mobility
    beyond, d, energy, taken, slack = zero, zero, zero, zero, mass * give * give
    for i in range(last - first + 1):
        inner = last - i if right else first + i
        T, Y = segment[inner].transit, segment[inner].mobility
        g0, beyond = beyond, beyond + T / (Y * mass)
        g1 = beyond
        if held:
            g0 = g1 = 1 + zero
        slack += Y * T * (g0 * g0 + g0 * g1 + g1 * g1) / 3
        for l in range(2 * inner, 2 * inner + 2):
            outward = (l % 2 == 1) == right  # runs towards the end at the contact
            sign = 1 if l % 2 else -1
            r, wave, edge, more = line[l].head, line[l].arrived - it.mean, T, True
            while more:
                more = r != NONE
                low = t - log[r].tick if more else 0
                width = edge - low
                energy += wave * wave * width / (4 * Y)
                taken += wave * width / (2 * Y)
                place = (edge + low) / (2 * T) if outward else 1 - (edge + low) / (2 * T)
                d += sign * wave * width * (g0 + (g1 - g0) * place) / 2
                if more:
                    edge, wave, r = low, log[r].value - it.mean, log[r].after
    it.deviation = (-d if right else d) - give * taken
    if not silent or (give > 0 and pressed):
        it.bound, it.slack = 2 * energy * slack, slack


def least_opening(left: Any, right: Any, tol: Any) -> Any:
    """Least velocity at which two ends can part, less than any that counts if nothing bounds it."""
    if left.bounded and right.bounded:
        return right.low - left.high
    return -1 - tol  # fractions know no infinity


def time_until_apart(at: Any, left: Any, right: Any, t: int, tol: Any) -> float:
    """Ticks until a contact may be proved not to close again, see `finality_kernel`."""
    opening, least = right.mean - left.mean, least_opening(left, right, tol)
    apart = at.gap + at.rate * (t - at.since) - right.deviation + left.deviation
    square = 2 * (left.bound + right.bound)  # of a sum of roots at most, without roots
    return proof.separation_time(opening, least, apart, square, tol)


def finality_time(segment: Any, node: Any, line: Any, log: Any, t: int, tol: Any) -> int:
    """When the collision can be proved final: t if now, IDLE if not before a new contact.

    For rows whose ends are not driven: no bound holds for a body that is pushed.
    """
    longest = 0.0
    for k in range(len(node)):
        at, left, right = node[k], segment[k], segment[k + 1]
        if at.status >= Status.OPEN and longest < NEVER and not (
            at.rate >= 0 and quiet(line, left.first, max(k, right.last))  # nothing moves there
        ):
            survey(segment, node, line, log, k, t)
            if proof.undecided(right.mean - left.mean, least_opening(left, right, tol), tol):
                bound_deviations(segment, node, line, log, k, t)  # of others none are read
            longest = max(longest, time_until_apart(at, left, right, t, tol))
    if longest >= NEVER // 2:
        return IDLE
    return t + (int(longest * 1.000001) + 1 if longest > 0 else 0)
