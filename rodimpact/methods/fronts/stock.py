"""What a run has come to: momenta, velocities of bonded groups, vibration; and what waves did.

Momentum of a segment is (Z/2) integral(a + b), the energy of its vibration about a motion of
velocity V is (Z/4) integral((a - V)^2 + (b - V)^2).
"""

from typing import Any

from ..laws import Status
from .records import NONE


def take(run: Any, segment: Any, line: Any, log: Any) -> None:
    """Take stock now: momentum, and energy of vibration about `velocity`, by segment."""
    t = run.now
    for s in range(1, len(segment) - 1):
        it = segment[s]
        Z, V = 1 / it.mobility, it.velocity
        total, square = 0 * V, 0 * V
        for l in range(2 * s, 2 * s + 2):
            r, wave, edge = line[l].head, line[l].arrived, it.transit
            while r != NONE:
                width = edge - t + log[r].tick
                total += wave * width
                square += (wave - V) * (wave - V) * width
                edge, wave, r = t - log[r].tick, log[r].value, log[r].after
            total += wave * edge
            square += (wave - V) * (wave - V) * edge
        it.momentum, it.vibration = Z * total / 2, Z * square / 4


def share(run: Any, segment: Any, node: Any) -> None:
    """Set the velocities of bonded groups: at t = 0 from their momenta, then from their impulses.

    The impulses are more exact than the momenta of waves, and independent of them; only groups
    bonded to what is outside have no other velocity than that of their momenta.
    """
    first = 1
    while first < len(node):
        last = segment[first].last
        mass = momentum = 0 * segment[first].mobility
        for s in range(first, last + 1):
            mass += segment[s].transit / segment[s].mobility
            momentum += segment[s].momentum
        own = momentum / mass
        held = node[first - 1].status == Status.BOND or node[last].status == Status.BOND
        if run.events > 0 and not held:
            own = segment[first].initial + (node[first - 1].impulse - node[last].impulse) / mass
        for s in range(first, last + 1):
            segment[s].velocity = own
        first = last + 1


def remember(segment: Any) -> None:
    """Keep what stock has been taken of at t = 0."""
    for s in range(len(segment)):
        it = segment[s]
        it.initial, it.initial_momentum = it.velocity, it.momentum
        it.initial_vibration = it.vibration


def settle(run: Any, segment: Any, node: Any, line: Any, log: Any) -> None:
    """Find the velocities of groups, and the momenta and vibration of segments about them.

    The vibration at t = 0 is asked of what runs further only.
    """
    held = node[0].status == Status.BOND or node[len(node) - 1].status == Status.BOND
    if held or run.events == 0:
        take(run, segment, line, log)
    share(run, segment, node)
    if run.further or run.events > 0:
        take(run, segment, line, log)


def largest_difference(log: Any, a: int, b: int, T: int, end: int, window: int) -> Any:
    """Largest absolute difference of two waves where they meet in a segment, between 0 and `end`.

    Waves that leave the two ends at p and q meet at (p + q + T)/2 if abs(p - q) < T.

    Parameters
    ----------
    log : ROW
    a, b : int
        First rows of the two lines.
    T, end : int
        Transit time of the segment, end of the run.
    window : int
        Waves that last no longer come of round-off, and do not count.
    """
    largest = abs(0 * log[a].value)
    while a != NONE:
        one = log[a]
        a0, a1 = one.tick, end
        if one.after != NONE:
            a1 = min(log[one.after].tick, end)
        # what has left the other end before this wave sets out is past
        while log[b].after != NONE and log[log[b].after].tick <= a0 - T:
            b = log[b].after
        r = b
        while r != NONE and log[r].tick < a1 + T and a1 - a0 > window:
            other = log[r]
            b0, b1 = other.tick, end
            if other.after != NONE:
                b1 = min(log[other.after].tick, end)
            # the parts of both waves that meet at all, and whether that is not before 0 or after
            # the end; sums of two ticks could overflow
            low_a, low_b = max(a0, b0 - T), max(b0, a0 - T)
            high_a, high_b = min(a1, b1 + T), min(b1, a1 + T)
            meet = low_a < high_a and low_b < high_b and high_a > -T - high_b
            if meet and b1 - b0 > window and low_a - end < end - T - low_b:
                largest = max(largest, abs(other.value - one.value))
            r = other.after
        a = one.after
    return largest


def read(run: Any, segment: Any, line: Any, log: Any) -> None:
    """Read the largest difference of waves in each segment."""
    for s in range(1, len(segment) - 1):
        segment[s].parted = largest_difference(
            log, line[2 * s].first, line[2 * s + 1].first, segment[s].transit, run.now, run.window)
