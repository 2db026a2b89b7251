"""Proof that a collision is final, from bounds of the motion of ends by vibration.

A collision is final when no contact will close again, and each contact that still
presses does so with a constant force. A group of bonded segments beside a contact moves
with its mean velocity, and its end deviates from that motion by no more than the
vibration energy of the group allows. The proof is as exact as the run: it holds on
fractions, too.

The mobility of a segment is Y = 1/Z, its transit time T, and its waves are a, to the
right, and b, to the left.
"""

from collections.abc import Sequence

from .. import finality_kernel as proof
from ..states import Status
from .records import IDLE, NEVER, NONE, Amplitude, Line, Segment, State

WAIT_MARGIN = 1.000001  # lengthens a wait, so that the proof succeeds after it


def finality_tick(state: State, now: int) -> int:
    """Tick at which the collision can be proved final: `now`, a later one, or IDLE.

    `now` means that it is proved. A later tick means that no proof is possible before
    that tick, unless a contact changes; IDLE means that none is possible until a
    contact changes. For a row with driven ends the result is meaningless, since no
    bound holds; `FrontRun` and `solve_family` discard it.

    `ticks_until_apart` writes the motions of the groups beside a contact to the two
    segments beside it. It is called for contacts in order, until the wait exceeds the
    clock; contacts whose gap can no longer shrink are left out.
    """
    segments = state.segments
    nodes = state.nodes
    lines = state.lines
    longest_wait = 0.0  # ticks until the last of the contacts is proved to stay open
    for k in range(len(nodes)):
        node = nodes[k]
        is_contact = node.status >= Status.OPEN  # not a bond, and not an end
        # Once a wait exceeds the clock, or is inf, the other contacts do not matter.
        if is_contact and longest_wait < NEVER:
            # First and last segment of the two groups beside the contact. Beside a
            # wall the range is that of the group inside the row: at a left wall,
            # outside the row, `group_first` is 1, the first segment of the row; at a
            # right wall `group_last` is 0, so that the maximum is k, the last one.
            first = segments[k].group_first
            last = max(k, segments[k + 1].group_last)
            # If no front is in flight, the gap rate stays as it is for ever.
            is_steady = node.gap_rate >= 0 and no_front_in_flight(lines, first, last)
            if not is_steady:
                longest_wait = max(longest_wait, ticks_until_apart(state, k, now))
    if longest_wait >= NEVER // 2:  # now + wait could exceed the clock; or inf
        return IDLE
    wait = 0
    if longest_wait > 0:
        wait = int(longest_wait * WAIT_MARGIN) + 1  # rounded up
    return now + wait


def no_front_in_flight(lines: Sequence[Line], first: int, last: int) -> bool:
    """Whether no front is in flight on either line of the segments `first` to `last`.

    It is True if `last` is below `first`.
    """
    # Kernels have no generators, hence a loop. Segment s has the lines 2 s and 2 s + 1.
    for l in range(2 * first, 2 * last + 2):  # noqa: SIM110
        if lines[l].next_row != NONE:
            return False
    return True


def least_opening_velocity(
    left: Segment, right: Segment, tolerance: Amplitude
) -> Amplitude:
    """Lower bound of the opening velocity of two ends, m/s; < 0 if they may approach.

    It follows from the bounds of the velocities of both ends, which `find_mean_motions`
    has set. If one end has no bounds, -1 - `tolerance` is returned in place of minus
    infinity, which fractions lack: any value below -`tolerance` proves nothing.
    """
    if left.is_end_velocity_bounded and right.is_end_velocity_bounded:
        return right.min_end_velocity - left.max_end_velocity
    return -1 - tolerance


def ticks_until_apart(state: State, k: int, now: int) -> float:
    """Ticks until contact k can be proved not to close again, see `finality_kernel`.

    The result is 0 if that is proved at the tick `now`, and inf if the mean motions do
    not open the gap. Segments k and k + 1, beside the contact, get the motions of their
    groups: mean velocities with bounds and, if these prove nothing, deviations.
    """
    tolerance = state.runs[0].velocity_tolerance
    left = state.segments[k]
    right = state.segments[k + 1]
    find_mean_motions(state, k, now)
    opening = right.mean_velocity - left.mean_velocity
    least_opening = least_opening_velocity(left, right, tolerance)
    if proof.undecided(opening, least_opening, tolerance):
        # Velocities alone prove nothing. `separation_time` uses deviations and their
        # bounds only in this case; in other cases they may be out of date.
        set_deviations(state, k, now)
    node = state.nodes[k]
    gap = node.gap + node.gap_rate * (now - node.solved_tick)
    mean_gap = gap - right.end_deviation + left.end_deviation
    # Square of the sum of both bounds, (b1 + b2)^2 <= 2 (b1^2 + b2^2), without the
    # square roots that fractions lack
    bounds_squared = 2 * (left.deviation_bound_squared + right.deviation_bound_squared)
    return proof.separation_time(
        opening, least_opening, mean_gap, bounds_squared, tolerance
    )


# Mean motions -------------------------------------------------------------------------


def find_mean_motions(state: State, k: int, now: int) -> None:
    """Set the mean velocities of both sides of contact k, and bounds of their ends.

    They are stored in the segments k and k + 1: `mean_velocity`, `min_end_velocity`,
    `max_end_velocity`, and `is_end_velocity_bounded`, which is 1 if the bounds hold as
    long as nothing touches the group. That is so for a uniform free segment (its waves
    go round unchanged), a semi-infinite bar, a wall, and a group with steady waves. The
    mean velocity of a group bonded to a wall or to a semi-infinite bar is its final
    velocity.
    """
    for side in range(2):
        s = k + side
        segment = state.segments[s]
        if segment.group_last > 0:  # inside the row
            find_group_motion(state, k, s, now)
        else:
            # Line 2 k + 3 side arrives at node k from this side. From a wall it brings
            # the velocity of the wall.
            wall_velocity = state.lines[2 * k + 3 * side].incoming_wave
            segment.mean_velocity = wall_velocity
            segment.min_end_velocity = wall_velocity
            segment.max_end_velocity = wall_velocity
            segment.is_end_velocity_bounded = 1


def find_group_motion(state: State, k: int, s: int, now: int) -> None:
    """Set mean velocity and velocity bounds of the group of segment s, in segment s.

    The group, inside the row, is on one side of contact k. Mean velocity and bounds
    follow from its waves, see `measure_waves`: the bounds hold for a single segment,
    not for a group of several. There are two exceptions. The mean velocity of a group
    that is bonded to the outside is the wave that arrives from there; if that is a
    wall, there are no bounds. If the waves in the group are steady, both bounds are the
    mean velocity, unless the contact presses a group that is bonded to a semi-infinite
    bar.
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
    # A bond at an end of the group is a bond to the outside of the row. There is one at
    # most, since the contact is at the other end.
    is_semi_infinite = False  # whether the group is bonded to a semi-infinite bar
    for side in range(2):
        if side == 0:
            end_node = first - 1
        else:
            end_node = last
        # The wave that arrives at this node from beyond the group: on line 2 k from the
        # left of node k, on line 2 k + 3 from its right
        outside_line = 2 * end_node + 3 * side
        outside_wave = lines[outside_line].incoming_wave
        outside_mobility = segments[end_node + side].mobility
        if nodes[end_node].status == Status.BOND:
            group.mean_velocity = outside_wave
            is_semi_infinite = outside_mobility > 0
            if not is_semi_infinite:  # a wall of velocity V turns a wave w into 2 V - w
                group.is_end_velocity_bounded = 0
    # If the waves are steady, the ends have the mean velocity. But a group at a
    # semi-infinite bar moves on while it is pressed.
    if is_steady and not (is_semi_infinite and is_pressing):
        group.min_end_velocity = group.mean_velocity
        group.max_end_velocity = group.mean_velocity
        group.is_end_velocity_bounded = 1


def measure_waves(state: State, s: int, now: int) -> None:
    """Set mean velocity and velocity bounds of the group of segment s, in segment s.

    The velocity is (a + b)/2. So the mean velocity, momentum over mass, is the sum of
    (1/Y) integral(a + b) dt over the segments, divided by the sum of 2 T/Y, with the
    mobility Y and the transit time T. The bounds are the smallest and the largest wave,
    as a free end has the velocity of the wave that arrives there. For a single segment
    they hold for all times, and `is_end_velocity_bounded` becomes 1; for more segments
    it becomes 0.
    """
    segments = state.segments
    lines = state.lines
    log = state.log
    group = segments[s]
    first = group.group_first
    last = group.group_last
    # Sums over both waves, a and b, give twice the momentum, and so are divided by
    # twice the mass.
    twice_mass = 0 * lines[2 * first].incoming_wave  # 0 of the same kind of number
    twice_momentum = twice_mass  # 0, too
    lowest = lines[2 * first].incoming_wave
    highest = lowest
    for i in range(first, last + 1):
        impedance = 1 / segments[i].mobility
        transit = segments[i].transit
        twice_mass += 2 * impedance * transit
        for l in range(2 * i, 2 * i + 2):
            # The waves are visited from the end where they arrive to the other end.
            r = lines[l].next_row
            wave = lines[l].incoming_wave
            # This wave was sent from `first_sent_ago` ticks ago, at most a transit, to
            # `last_sent_ago` ticks ago, when the front behind it was sent.
            first_sent_ago = transit
            lowest = min(lowest, wave)
            highest = max(highest, wave)
            while r != NONE:
                front = log[r]
                last_sent_ago = now - front.tick
                twice_momentum += impedance * wave * (first_sent_ago - last_sent_ago)
                # The next wave is the one behind the front.
                first_sent_ago = last_sent_ago
                wave = front.value
                lowest = min(lowest, wave)
                highest = max(highest, wave)
                r = front.next_row
            # The last wave is still being sent: it was last sent 0 ticks ago.
            twice_momentum += impedance * wave * first_sent_ago
    group.mean_velocity = twice_momentum / twice_mass
    group.min_end_velocity = lowest
    group.max_end_velocity = highest
    group.is_end_velocity_bounded = 0
    if first == last:  # a uniform segment: its waves go round unchanged
        group.is_end_velocity_bounded = 1


# Deviations ---------------------------------------------------------------------------


def set_deviations(state: State, k: int, now: int) -> None:
    """Set the deviations of both ends at contact k at tick `now`, and their bounds.

    The end of a free body deviates from the motion of its centre of mass by
    d = integral(strain * g dx), where g is the fraction of the mass that lies beyond x
    as seen from that end. So abs(d) <= sqrt(2 U integral(g^2 dx/(E A))), with the
    vibration energy U.

    For a group whose far end is bonded to a wall, g = 1. A semi-infinite bar of
    mobility Y at the far end yields by Y p, with p the momentum that it has taken up.
    As p <= sqrt(2 m U), m Y^2 is then added to the integral.

    Segments k and k + 1 get the results: `end_deviation`, `deviation_bound_squared` and
    `compliance_integral`, all 0 for a segment outside the row. `find_mean_motions` must
    have set their mean velocities.
    """
    for s in range(k, k + 2):
        segment = state.segments[s]
        zero = 0 * segment.mean_velocity  # 0 of the same kind of number
        segment.end_deviation = zero
        segment.deviation_bound_squared = zero
        segment.compliance_integral = zero
        if segment.group_last > 0:  # inside the row
            # This evaluates the equations above.
            set_deviation_of_end(state, k, s, now)


def set_deviation_of_end(state: State, k: int, s: int, now: int) -> None:
    """Set deviation and bound of the end at contact k of the group of segment s.

    `set_deviations` gives the equations, defines g, and sets the results to 0 before.
    They are stored in segment s. The deviation is in m/s times ticks, positive to the
    right. The bound and `compliance_integral` stay 0 if no front is in flight in the
    group, as the deviation is then constant, unless the contact presses a group that is
    bonded to a semi-infinite bar.
    """
    segments = state.segments
    log = state.log
    group = segments[s]
    first = group.group_first
    last = group.group_last
    is_right = s > k  # the group is right of the contact
    zero = 0 * group.mean_velocity
    mass = group_mass(segments, first, last, zero)
    # A bond at an end of a group is a bond to the outside of the row.
    has_left_bond = state.nodes[first - 1].status == Status.BOND
    has_right_bond = state.nodes[last].status == Status.BOND
    is_anchored = has_left_bond or has_right_bond
    far_mobility = zero  # Y of the bar that holds the far end; 0 for a wall
    g1 = zero  # g at the near end of the segments so far; 0 at a free far end
    if is_anchored:
        far_mobility += far_outside(segments, is_right).mobility
        g1 = 1 + zero  # g = 1 all over

    stretching = zero  # integral(strain g dx)
    energy = zero  # vibration energy U
    momentum = zero  # momentum p of the waves, relative to the mean motion
    # integral(g^2 dx/(E A)), plus m Y^2 for a semi-infinite bar
    compliance = mass * far_mobility * far_mobility
    for steps in range(last - first + 1):  # from the far end to the contact
        i = from_far_end(first, last, steps, is_right)  # index of the segment
        transit = segments[i].transit
        mobility = segments[i].mobility
        g0 = g1  # g at the far end of this segment
        if not is_anchored:
            # g grows by the mass of the segment, T/Y, over that of the group.
            g1 = g0 + transit / (mobility * mass)
        # Integral over the segment, where dx/(E A) = Y dt. For a linear g the mean of
        # g^2 is (g0^2 + g0 g1 + g1^2)/3.
        compliance += mobility * transit * (g0 * g0 + g0 * g1 + g1 * g1) / 3
        for l in range(2 * i, 2 * i + 2):
            is_leftward = l % 2 == 1  # the line carries b, not a
            sign = 1 if is_leftward else -1  # sign of the wave in (b - a)/(2 c)
            # b travels to a contact on the left of the group, a to one on the right.
            runs_to_contact = is_leftward == is_right
            line = state.lines[l]
            # The waves are visited from the end where they arrive to the other end.
            r = line.next_row
            wave = line.incoming_wave - group.mean_velocity
            # This wave was sent from `first_sent_ago` ticks ago, at most a transit, to
            # `last_sent_ago` ticks ago, when the front behind it was sent.
            first_sent_ago = transit
            is_last = False  # whether this wave is still being sent
            while not is_last:
                is_last = r == NONE
                last_sent_ago = 0
                if not is_last:
                    last_sent_ago = now - log[r].tick
                width = first_sent_ago - last_sent_ago
                # A wave w has the energy w^2 width/(4 Y) and the momentum
                # w width/(2 Y). It adds +/- w width g/2 to integral(strain g dx), with
                # g at its middle.
                energy += wave * wave * width / (4 * mobility)
                momentum += wave * width / (2 * mobility)
                # Fraction of the segment that the middle of this wave has covered:
                # (first_sent_ago + last_sent_ago)/2 ticks of the transit
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
    # Until the momentum p is used up, a semi-infinite bar yields by Y p: the end has
    # this distance still to go.
    group.end_deviation = deviation - far_mobility * momentum
    is_steady = no_front_in_flight(state.lines, first, last)
    is_pressing = state.nodes[k].status == Status.PRESS
    # While it is pressed, a group at a semi-infinite bar (Y > 0) goes on yielding.
    if not is_steady or (far_mobility > 0 and is_pressing):
        group.deviation_bound_squared = 2 * energy * compliance
        group.compliance_integral = compliance


def group_mass(
    segments: Sequence[Segment], first: int, last: int, zero: Amplitude
) -> Amplitude:
    """Mass of the segments `first` to `last`, kg divided by the duration of a tick.

    Each segment adds its transit time T, in ticks, over its mobility Y. `zero` is 0 of
    the kind of number that the run uses.
    """
    mass = zero
    for s in range(first, last + 1):
        mass += segments[s].transit / segments[s].mobility
    return mass


def from_far_end(first: int, last: int, i: int, is_right: bool) -> int:
    """Index of the segment that is `i` segments from the end far from a contact.

    The group has the segments `first` to `last`. If `is_right`, it is right of the
    contact, and the far end is its right end; otherwise the far end is its left end.
    """
    if is_right:
        return last - i
    return first + i


def fraction_at(
    covered: Amplitude, g0: Amplitude, g1: Amplitude, runs_to_contact: bool
) -> Amplitude:
    """Mass fraction g at the point that a wave has reached in a segment.

    The wave has covered the fraction `covered`, from 0 to 1, of the segment, towards
    the contact or away from it. g is linear in the segment: g0 at the end far from the
    contact, g1 at the near end.
    """
    if runs_to_contact:
        return g0 + (g1 - g0) * covered
    return g0 + (g1 - g0) * (1 - covered)


def far_outside(segments: Sequence[Segment], is_right: bool) -> Segment:
    """The segment outside the row at the end that is far from a contact.

    If the group is right of the contact (`is_right`), this is the last one of
    `segments`; otherwise it is the first.
    """
    far = 0
    if is_right:
        far = len(segments) - 1
    return segments[far]
