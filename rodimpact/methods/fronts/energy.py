"""Momentum and energy of the segments, the velocities of bonded groups, and stress.

With the waves a and b and the impedance Z, the momentum of a segment is
(Z/2) integral(a + b) over a transit time. The energy of its vibration about a motion
of velocity V is (Z/4) integral((a - V)^2 + (b - V)^2).
"""

from collections.abc import Sequence

from ..states import Status
from .records import NONE, Amplitude, Log, Segment, State


def update_motion(state: State) -> None:
    """Set the present velocities of groups, and momenta and energies of segments.

    The energies are vibration energies about the velocities of the groups. Before the
    first event they are set only if `run_past_proof` of the run is 1; otherwise they
    have no meaning yet.
    """
    run = state.runs[0]
    nodes = state.nodes
    last_node = nodes[len(nodes) - 1]
    is_anchored = nodes[0].status == Status.BOND or last_node.status == Status.BOND
    # At t = 0, and if an end of the row is bonded, the group velocities follow from the
    # momenta of the segments; otherwise from the impulses.
    if is_anchored or run.events == 0:
        measure_segments(state)
    set_group_velocities(state)
    # Vibration energies need the group velocities, which are known only now.
    if run.run_past_proof or run.events > 0:
        measure_segments(state)


def measure_segments(state: State) -> None:
    """Set momentum, and vibration energy about `group_velocity`, of each segment.

    Both are sums over the two waves in the segment, which were sent from its ends
    within the last transit time. Their units are N s and J, divided by the duration of
    a tick.
    """
    now = state.runs[0].now
    log = state.log
    for s in range(1, len(state.segments) - 1):
        segment = state.segments[s]
        impedance = 1 / segment.mobility
        mean = segment.group_velocity
        wave_integral = 0 * mean  # integral(a + b) over a transit time
        square_integral = 0 * mean  # integral((a - V)^2 + (b - V)^2)
        for l in range(2 * s, 2 * s + 2):  # both lines of the segment
            line = state.lines[l]
            # The waves are visited from the end where they arrive to the other end.
            r = line.next_row
            wave = line.incoming_wave
            # Number of ticks ago at which this wave began to be sent, at most a transit
            first_sent_ago = segment.transit
            while r != NONE:
                front = log[r]  # the front behind this wave, sent at `front.tick`
                # Ticks during which the wave was sent: it ended now - front.tick ago.
                width = first_sent_ago - now + front.tick
                wave_integral += wave * width
                square_integral += (wave - mean) * (wave - mean) * width
                # The next wave is the one behind the front.
                first_sent_ago = now - front.tick
                wave = front.value
                r = front.next_row
            # The last wave is still being sent: its width is all of `first_sent_ago`.
            wave_integral += wave * first_sent_ago
            square_integral += (wave - mean) * (wave - mean) * first_sent_ago
        # A segment has the mass Z per tick of its transit, the velocity (a + b)/2, and
        # the energy Z ((a - V)^2 + (b - V)^2)/4 per tick about the mean V.
        segment.momentum = impedance * wave_integral / 2
        segment.vibration_energy = impedance * square_integral / 4


def set_group_velocities(state: State) -> None:
    """Set `group_velocity` of all segments: V of their bonded group, of mass m.

    Before the first event, V = p/m, with p the sum of the momenta of its segments.
    Afterwards, V = V(0) + (impulse at the left end - impulse at the right end)/m:
    impulses are more exact than the momenta of waves, and independent of them. But a
    group that is bonded to the outside always has V = p/m. Where p is used, the momenta
    must have been measured.
    """
    run = state.runs[0]
    segments = state.segments
    nodes = state.nodes
    first = 1  # first segment of a group
    while first < len(nodes):
        last = segments[first].group_last
        mass = 0 * segments[first].mobility  # 0 of the same kind of number
        momentum = mass  # 0, too
        for s in range(first, last + 1):
            # The mass of a segment is Z T, over the duration of a tick.
            mass += segments[s].transit / segments[s].mobility
            momentum += segments[s].momentum
        velocity = momentum / mass
        left = nodes[first - 1]
        right = nodes[last]
        # A bond at an end of a group is a bond to the outside.
        is_anchored = left.status == Status.BOND or right.status == Status.BOND
        if run.events > 0 and not is_anchored:
            change = (left.impulse - right.impulse) / mass
            velocity = segments[first].initial_group_velocity + change
        for s in range(first, last + 1):
            segments[s].group_velocity = velocity
        first = last + 1


def store_initial_motion(segments: Sequence[Segment]) -> None:
    """Copy the present motion of all segments to their fields for t = 0."""
    for segment in segments:
        segment.initial_group_velocity = segment.group_velocity
        segment.initial_momentum = segment.momentum
        segment.initial_vibration_energy = segment.vibration_energy


def find_wave_differences(state: State) -> None:
    """Set `max_wave_difference` of each segment, m/s, over the whole run up to now.

    It is the largest absolute difference of the two waves of the segment at any point
    and any time at which they meet, see `largest_difference`.
    """
    run = state.runs[0]
    for s in range(1, len(state.segments) - 1):
        rightward = state.lines[2 * s].first_row
        leftward = state.lines[2 * s + 1].first_row
        transit = state.segments[s].transit
        state.segments[s].max_wave_difference = largest_difference(
            state.log, rightward, leftward, transit, run.now, run.round_off_window
        )


def largest_difference(
    log: Log, row_a: int, row_b: int, transit: int, end_tick: int, window: int
) -> Amplitude:
    """Largest absolute difference of the two waves of a segment where they meet, m/s.

    Meetings between tick 0 and `end_tick` count. Waves that leave the two ends of a
    segment at p and q meet at (p + q + T)/2 if abs(p - q) < T, the transit time. The
    result is 0 if no meeting counts.

    Parameters
    ----------
    log : list of Front
    row_a, row_b : int
        Rows of the first fronts of the two lines.
    transit, end_tick : int
        Transit time of the segment, and end of the run.
    window : int
        A wave that lasts at most this number of ticks is round-off, and does not count.
    """
    largest = abs(0 * log[row_a].value)  # 0 of the same kind of number
    while row_a != NONE:
        front_a = log[row_a]
        # The wave behind this front was sent from a0 to a1, when the next front was.
        a0 = front_a.tick
        a1 = end_tick
        if front_a.next_row != NONE:
            a1 = min(log[front_a.next_row].tick, end_tick)
        # Skip the waves b that ended a transit or more before a0: they meet neither
        # this wave nor any later one, so that `row_b` never goes back.
        next_b = log[row_b].next_row
        while next_b != NONE and log[next_b].tick <= a0 - transit:
            row_b = next_b
            next_b = log[row_b].next_row
        # Waves b that began a transit after a1, or later, do not meet this wave either:
        # the loop ends before them.
        r = row_b
        lasts_a = a1 - a0 > window  # otherwise this wave is round-off
        while lasts_a and r != NONE and log[r].tick < a1 + transit:
            front_b = log[r]
            # The wave behind this front was sent from b0 to b1.
            b0 = front_b.tick
            b1 = end_tick
            if front_b.next_row != NONE:
                b1 = min(log[front_b.next_row].tick, end_tick)
            lasts_b = b1 - b0 > window
            # The part of a sent from first_a to last_a meets the part of b sent from
            # first_b to last_b.
            first_a = max(a0, b0 - transit)
            first_b = max(b0, a0 - transit)
            last_a = min(a1, b1 + transit)
            last_b = min(b1, a1 + transit)
            meet = first_a < last_a and first_b < last_b
            # These parts meet from (first_a + first_b + T)/2 to (last_a + last_b +
            # T)/2. The comparisons with 0 and with the end are rearranged, since a sum
            # of two ticks could overflow.
            # The last meeting is after tick 0: (last_a + last_b + T)/2 > 0.
            after_start = last_a > -transit - last_b
            # The first one is before the end: (first_a + first_b + T)/2 < end_tick.
            before_end = first_a - end_tick < end_tick - transit - first_b
            if meet and after_start and before_end and lasts_b:
                largest = max(largest, abs(front_b.value - front_a.value))
            r = front_b.next_row
        row_a = front_a.next_row
    return largest
