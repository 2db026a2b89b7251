"""Proof that a collision is final, from bounds of what vibration can do.

It is final when no contact closes again, and each contact that still presses does so
with a constant force.
A group of bonded segments beside a contact moves with its mean velocity, and its end
deviates from that motion by no more than the group's energy allows. The proof is as
exact as the run: it holds on fractions, too.
"""

from collections.abc import Sequence

from .. import finality_kernel as proof
from ..states import Status
from .records import IDLE, NEVER, NONE, Amplitude, Line, Segment, State

WAIT_MARGIN = 1.000001  # lengthens a wait, so that the proof succeeds after it


def finality_tick(state: State, now: int) -> int:
    """Tick at which the collision can be proved final: `now`, a later one, or IDLE.

    `now` means that it is proved. With a later tick, or with IDLE, which stands for
    never, no proof is possible before that or before a contact changes. For a row with
    driven ends the answer means nothing, since no bound holds, and `FrontRun` and
    `solve_family` discard it. Motions of groups are written to the segments.
    """
    segments = state.segments
    nodes = state.nodes
    lines = state.lines
    longest_wait = 0.0  # ticks until the last of the contacts is proved to stay open
    for k in range(len(nodes)):
        node = nodes[k]
        is_contact = node.status >= Status.OPEN  # one that can open
        # A wait as long as the clock, or inf, decides: the others need no look.
        if is_contact and longest_wait < NEVER:
            # First and last segment of the two groups beside the contact
            first = segments[k].group_first
            last = max(k, segments[k + 1].group_last)  # outside, `group_last` is 0
            # Nothing changes any more, and the gap does not close.
            is_steady = node.gap_rate >= 0 and no_front_in_flight(lines, first, last)
            if not is_steady:
                longest_wait = max(longest_wait, ticks_until_apart(state, k, now))
    if longest_wait >= NEVER // 2:  # beyond what the clock counts, or infinite
        return IDLE
    wait = 0
    if longest_wait > 0:
        wait = int(longest_wait * WAIT_MARGIN) + 1
    return now + wait


def no_front_in_flight(lines: Sequence[Line], first: int, last: int) -> bool:
    """Whether no front is in flight in the segments from `first` to `last`.

    Both their lines count. Without such segments (`last` below `first`) it is True.
    """
    # Kernels have no generators.
    for l in range(2 * first, 2 * last + 2):  # noqa: SIM110
        if lines[l].next_row != NONE:
            return False
    return True


def least_opening_velocity(
    left: Segment, right: Segment, tolerance: Amplitude
) -> Amplitude:
    """Least velocity at which two ends can part, m/s; negative if they can approach.

    It follows from the bounds that `find_mean_motions` has set. If one of the ends has
    none, -1 - `tolerance` is returned, which decides nothing, as it is below
    -`tolerance`: fractions have no infinity.
    """
    if left.is_end_velocity_bounded and right.is_end_velocity_bounded:
        return right.min_end_velocity - left.max_end_velocity
    return -1 - tolerance


def ticks_until_apart(state: State, k: int, now: int) -> float:
    """Ticks until contact k may be proved not to close again, see `finality_kernel`.

    It is 0 if it may be proved `now`, inf if its mean gap never opens. Segments k and
    k + 1, beside the contact, get the motions of their groups.
    """
    tolerance = state.runs[0].velocity_tolerance
    left = state.segments[k]
    right = state.segments[k + 1]
    find_mean_motions(state, k, now)
    opening = right.mean_velocity - left.mean_velocity
    least_opening = least_opening_velocity(left, right, tolerance)
    if proof.undecided(opening, least_opening, tolerance):
        # The velocities alone decide nothing: deviations and their bounds count, which
        # `separation_time` reads in this case only.
        bound_deviations(state, k, now)
    node = state.nodes[k]
    gap = node.gap + node.gap_rate * (now - node.solved_tick)
    mean_gap = gap - right.end_deviation + left.end_deviation
    # (b1 + b2)^2 <= 2 (b1^2 + b2^2): no square root, so that it works on fractions
    bounds_squared = 2 * (left.deviation_bound_squared + right.deviation_bound_squared)
    return proof.separation_time(
        opening, least_opening, mean_gap, bounds_squared, tolerance
    )


# Mean motions -------------------------------------------------------------------------


def find_mean_motions(state: State, k: int, now: int) -> None:
    """Set mean velocities beside contact k, and bounds of the velocities of its ends.

    They are stored in the segments k and k + 1, `is_end_velocity_bounded` 1 or 0 with
    them. The bounds hold as long as nothing touches the group, if it is a uniform free
    segment (its waves go round unchanged), a semi-infinite bar, a wall, or a group at
    rest. The mean velocity of a group bonded to a wall or to a semi-infinite bar is the
    velocity that it finally takes.
    """
    for side in range(2):
        s = k + side
        segment = state.segments[s]
        if segment.group_last > 0:  # inside the row
            find_mean_motion(state, k, s, now)
        else:
            # The line that arrives at node k from this side: the wave of a wall
            wall_velocity = state.lines[2 * k + 3 * side].incoming_wave
            segment.mean_velocity = wall_velocity
            segment.min_end_velocity = wall_velocity
            segment.max_end_velocity = wall_velocity
            segment.is_end_velocity_bounded = 1


def find_mean_motion(state: State, k: int, s: int, now: int) -> None:
    """Set mean velocity and velocity bounds of the group of segment s, in segment s.

    The group is on one side of contact k. Its waves give both, see `measure_waves`. But
    the mean velocity of a group bonded to the outside is the wave that arrives from
    there; with a wall there is then no bound. If the waves are steady, both bounds are
    the mean velocity, unless a semi-infinite bar holds a group that is pressed.
    """
    segments = state.segments
    nodes = state.nodes
    lines = state.lines
    measure_waves(state, s, now)
    group = segments[s]
    first = group.group_first
    last = group.group_last
    is_steady = no_front_in_flight(lines, first, last)
    is_pressing = nodes[k].status == Status.PRESS
    # What the group is bonded to outside:
    # on one side at most, as the contact is on the other
    is_semi_infinite = False
    for side in range(2):
        if side == 0:
            end_node = first - 1
        else:
            end_node = last
        # The line that arrives at this node from outside of the group
        outside_wave = lines[2 * end_node + 3 * side].incoming_wave
        outside_mobility = segments[end_node + side].mobility
        if nodes[end_node].status == Status.BOND:
            group.mean_velocity = outside_wave
            is_semi_infinite = outside_mobility > 0
            if not is_semi_infinite:  # a wall, which turns waves round
                group.is_end_velocity_bounded = 0
    # Steady waves are all the mean velocity;
    # but a semi-infinite bar gives way while it is pressed.
    if is_steady and not (is_semi_infinite and is_pressing):
        group.min_end_velocity = group.mean_velocity
        group.max_end_velocity = group.mean_velocity
        group.is_end_velocity_bounded = 1


def measure_waves(state: State, s: int, now: int) -> None:
    """Set mean velocity and velocity bounds of the group of segment s, in segment s.

    The velocity is (a + b)/2. So the mean velocity, momentum over mass, is the sum of
    (1/Y) integral(a + b) over the sum of 2 T/Y. The bounds are those of all its waves:
    a free end has the velocity of the wave that arrives there. They hold, and
    `is_end_velocity_bounded` becomes 1, if the group is a single segment; else 0.
    """
    segments = state.segments
    lines = state.lines
    log = state.log
    group = segments[s]
    first = group.group_first
    last = group.group_last
    # Both are summed over either wave, a and b: that is twice mass and momentum.
    twice_mass = 0 * lines[2 * first].incoming_wave  # 0 of the same kind of number
    twice_momentum = twice_mass  # 0, too
    lowest = lines[2 * first].incoming_wave
    highest = lowest
    for i in range(first, last + 1):
        impedance = 1 / segments[i].mobility
        transit = segments[i].transit
        twice_mass += 2 * impedance * transit
        for l in range(2 * i, 2 * i + 2):
            # From the end where the waves arrive, back to the end where they are sent
            r = lines[l].next_row
            wave = lines[l].incoming_wave
            # Ticks since this wave was first sent: those of a transit count.
            first_sent_ago = transit
            lowest = min(lowest, wave)
            highest = max(highest, wave)
            while r != NONE:
                front = log[r]
                last_sent_ago = now - front.tick  # up to the front behind it
                twice_momentum += impedance * wave * (first_sent_ago - last_sent_ago)
                # The next wave is the one behind the front.
                first_sent_ago = last_sent_ago
                wave = front.value
                lowest = min(lowest, wave)
                highest = max(highest, wave)
                r = front.next_row
            # The last wave is still sent.
            twice_momentum += impedance * wave * first_sent_ago
    group.mean_velocity = twice_momentum / twice_mass
    group.min_end_velocity = lowest
    group.max_end_velocity = highest
    group.is_end_velocity_bounded = 0
    if first == last:  # a uniform segment: its waves go round unchanged
        group.is_end_velocity_bounded = 1


# Deviations ---------------------------------------------------------------------------


def bound_deviations(state: State, k: int, now: int) -> None:
    """Set the deviations of the two ends at contact k, and their bounds.

    The end of a free body deviates from the motion of its centre of mass by
    d = integral(strain * g dx), g the mass fraction beyond x as seen from that end,
    hence by at most sqrt(2 U integral(g^2 dx/(E A))), U the vibration energy.
    A group bonded to a wall at its far end has g = 1. A semi-infinite bar of mobility Y
    at the far end gives way by Y p, p the momentum that it has taken; as
    p <= sqrt(2 m U), m Y^2 is added to the integral, the `compliance_integral`. The
    results are stored in the segments k and k + 1, where `find_mean_motions` has stored
    the mean velocities. A side outside the row has 0.
    """
    for s in range(k, k + 2):
        segment = state.segments[s]
        zero = 0 * segment.mean_velocity  # 0 of the same kind of number
        segment.end_deviation = zero
        segment.deviation_bound_squared = zero
        segment.compliance_integral = zero
        if segment.group_last > 0:  # inside the row
            bound_deviation(state, k, s, now)


def bound_deviation(state: State, k: int, s: int, now: int) -> None:
    """Set deviation and bound of the end at contact k of the group of segment s.

    They are stored in segment s, and are 0 before: see `bound_deviations` for their
    equations and g. The deviation is in m/s times ticks, positive to the right. Where
    no front is in flight it does not change, and the bound stays 0, unless a
    semi-infinite bar holds a group that is pressed.
    """
    segments = state.segments
    log = state.log
    group = segments[s]
    first = group.group_first
    last = group.group_last
    is_right = s > k  # the group is right of the contact
    zero = 0 * group.mean_velocity
    mass = group_mass(segments, first, last, zero)
    has_left_bond = state.nodes[first - 1].status == Status.BOND
    is_anchored = has_left_bond or state.nodes[last].status == Status.BOND
    far_mobility = zero  # Y of what holds the far end; 0 of a wall
    g1 = zero  # g at the near end of the segments so far
    if is_anchored:
        far_mobility += far_outside(segments, is_right).mobility
        g1 = 1 + zero  # g = 1 all over

    stretching = zero  # integral(strain g dx)
    energy = zero  # of vibration, U
    momentum = zero  # p of the waves, about the mean motion
    # integral(g^2 dx/(E A)), with m Y^2 of a semi-infinite bar
    compliance = mass * far_mobility * far_mobility
    for place in range(last - first + 1):  # from the far end to the contact
        i = from_far_end(first, last, place, is_right)  # segment
        transit = segments[i].transit
        mobility = segments[i].mobility
        g0 = g1  # g at the far end of this segment
        if not is_anchored:
            g1 = g0 + transit / (mobility * mass)
        # Part of the segment in the integral of g^2, with dx/(E A) = Y dt
        compliance += mobility * transit * (g0 * g0 + g0 * g1 + g1 * g1) / 3
        for l in range(2 * i, 2 * i + 2):
            is_leftward = l % 2 == 1  # it carries b, not a
            sign = 1 if is_leftward else -1  # of the strain (b - a)/(2 c)
            # b runs to a contact on the left of the group, a to one on the right.
            runs_to_contact = is_leftward == is_right
            line = state.lines[l]
            # From the end where the waves arrive, back to the end where they are sent
            r = line.next_row
            wave = line.incoming_wave - group.mean_velocity
            # Ticks since this wave was first sent: those of a transit count.
            first_sent_ago = transit
            is_last = False  # whether this wave is the one that is sent now
            while not is_last:
                is_last = r == NONE
                last_sent_ago = 0
                if not is_last:  # up to the front behind it
                    last_sent_ago = now - log[r].tick
                width = first_sent_ago - last_sent_ago
                # A wave w has the energy w^2 width/(4 Y), the momentum w width/(2 Y),
                # and the part +/- w width g/2 in integral(strain g dx).
                energy += wave * wave * width / (4 * mobility)
                momentum += wave * width / (2 * mobility)
                # Part of the segment that the middle of this wave has covered
                covered = (first_sent_ago + last_sent_ago) / (2 * transit)
                g = fraction_at(covered, g0, g1, runs_to_contact)
                stretching += sign * wave * width * g / 2
                if not is_last:  # the next wave is the one behind the front
                    first_sent_ago = last_sent_ago
                    wave = log[r].value - group.mean_velocity
                    r = log[r].next_row
    # Stretching moves the right end of a group to the right, its left end to the left.
    deviation = stretching
    if is_right:  # its left end is at the contact
        deviation = -stretching
    # A semi-infinite bar gives way by Y p.
    group.end_deviation = deviation - far_mobility * momentum
    is_steady = no_front_in_flight(state.lines, first, last)
    is_pressing = state.nodes[k].status == Status.PRESS
    if not is_steady or (far_mobility > 0 and is_pressing):
        group.deviation_bound_squared = 2 * energy * compliance
        group.compliance_integral = compliance


def group_mass(
    segments: Sequence[Segment], first: int, last: int, zero: Amplitude
) -> Amplitude:
    """Mass of the segments from `first` to `last`, kg over the duration of a tick.

    Each segment adds T/Y, transit time over mobility, to `zero`, which is 0 of the kind
    of number that is used.
    """
    mass = zero
    for s in range(first, last + 1):
        mass += segments[s].transit / segments[s].mobility
    return mass


def from_far_end(first: int, last: int, i: int, is_right: bool) -> int:
    """Segment i of a group, counted from the end that is far from a contact.

    `is_right` says whether the group is right of the contact.
    """
    if is_right:
        return last - i
    return first + i


def fraction_at(
    covered: Amplitude, g0: Amplitude, g1: Amplitude, runs_to_contact: bool
) -> Amplitude:
    """Mass fraction g at the place that a wave has reached in a segment.

    The wave has covered the part `covered`, from 0 to 1, of the segment, to the contact
    or away from it. g goes linearly from g0 at the end of the segment that is far from
    the contact to g1 at the other.
    """
    if runs_to_contact:
        return g0 + (g1 - g0) * covered
    return g0 + (g1 - g0) * (1 - covered)


def far_outside(segments: Sequence[Segment], is_right: bool) -> Segment:
    """Segment that stands for what lies outside one end of the row.

    `is_right` says whether it is the right end, as it is for a group right of its
    contact: the end that is far from the contact.
    """
    far = 0
    if is_right:
        far = len(segments) - 1
    return segments[far]
