"""Motion of groups of bonded bodies at an instant, and the proof of finality.

The proof shows that no two groups meet again. A group is a run of consecutive parts in
the list of parts. Its first part has their number in `part_count`, and the motion of
the group. Side 0 is the left end of a group, side 1 its right end.

The reference motion of a group is that of its centre of mass. For a group that a wall
or an endless rod anchors, it is the motion of this anchor.
"""

import math

from .. import finality_kernel as proof
from ..link import Law
from ..states import Status, Stop
from . import lines
from .records import (
    NEVER,
    NONE,
    GroupPart,
    Lines,
    Link,
    Links,
    Log,
    PartKind,
    Parts,
    Run,
    State,
)
from .series import N

REST_RTOL = 2.0**-40
"""Velocity, over the velocity scale, up to which a body is at rest.

It is the round-off of a long run.
"""
TRUNCATION_SHARE = 1e-3
"""Velocity, over the tolerance of pieces, that may be a truncation error."""


def check_finality(state: State, tick: int) -> None:
    """Check whether the run is over, at a tick that every node has reached.

    The motion of all groups is set, and a proof of finality is tried. If it succeeds,
    `proved_tick` and `end_tick` of the run are set, otherwise `next_proof_tick`. The
    first check of a run tries no proof, but records the velocities at t = 0; a check at
    the end of the run, or at the cap on steps, tries none either. `last_check_tick`
    becomes the tick of the check. None of this is done after a proof, unless bodies are
    bonded, since the motion of groups no longer changes.

    In any case `stop_reason` becomes DONE if the tick is the end of the run.
    """
    run = state.runs[0]
    parts = state.parts
    if run.proved_tick == NONE or run.has_bonds:  # parts of bonded bodies still vibrate
        read_lines_at(state, tick)
        update_groups(state, tick)
        # The run has ended at the cap on steps, or ends at this tick.
        has_ended = run.stop_reason != Stop.NONE or tick >= run.end_tick
        wants_proof = run.next_proof_tick < NEVER and not has_ended
        if run.last_check_tick == NONE:  # the first check
            # A group has its fields in its first part; those of the others are unused.
            for i in range(len(parts)):
                parts[i].initial_velocity = parts[i].group_velocity
        elif wants_proof:
            wait = time_until_over(run, state.links, parts)
            if wait == 0:  # the run is proved to be over
                run.proved_tick = tick
                run.next_proof_tick = NEVER
                run.end_tick = min(run.end_tick, tick + run.ticks_after_proof)
            else:
                # Rounded up; the bound keeps the tick of the next proof below NEVER.
                ticks = int(min(wait / run.tick_duration, 0.5 * NEVER)) + 1
                run.next_proof_tick = tick + max(run.proof_interval, ticks)
        run.last_check_tick = tick
    if tick >= run.end_tick:
        run.stop_reason = Stop.DONE.value


def read_lines_at(state: State, tick: int) -> None:
    """Set the read piece of each line to the piece that arrives at a tick.

    Lines without pieces are left out. If the run stops at the cap on steps, some nodes
    have read their lines beyond this tick: then all lines are read again from the
    start.
    """
    run = state.runs[0]
    for l in range(len(state.lines)):
        if state.lines[l].read_piece != NONE:
            if run.stop_reason == Stop.CAP:
                lines.rewind(state.lines, state.log, l)
            lines.advance_to(state.lines, state.log, l, tick)


def time_until_over(run: Run, links: Links, parts: Parts) -> float:
    """Return the time until the run may be proved to be over, s; 0 if it is proved now.

    It is proved if no contact presses and none can close again, or if nothing changes
    any more; always if no contact can open. Otherwise the result is the longest of the
    finite times after which open contacts may be proved to stay open, see
    `time_until_apart`, but at least a tick. Velocities up to REST_RTOL times the
    velocity scale plus TRUNCATION_SHARE times the tolerance of pieces count as 0.
    """
    # Velocities up to this one count as 0, m/s.
    tolerance = REST_RTOL * run.velocity_scale + TRUNCATION_SHARE * run.tolerance
    is_over = True
    is_all_quiet = True
    longest = 0.0
    for i in range(len(links)):
        link = links[i]
        if link.left_group == NONE:  # it cannot open
            continue
        left = parts[link.left_group]
        right = parts[link.right_group]
        is_left_quiet = is_quiet(link, left, tolerance)
        is_right_quiet = is_quiet(link, right, tolerance)
        is_all_quiet = is_all_quiet and is_left_quiet and is_right_quiet
        wait = time_until_apart(link, left, right, tolerance)
        # A closed compliant contact always counts as pressing, a rigid one if the
        # velocity that its force makes is not negligible.
        has_force = link.force[N] * link.effective_mobility > run.graze_velocity
        is_compliant = link.law >= Law.SPRING
        is_pressing = link.status != Status.OPEN and (is_compliant or has_force)
        is_over = is_over and wait == 0 and not is_pressing
        if link.status == Status.OPEN and wait < math.inf:
            longest = max(longest, wait)
    if is_over or is_all_quiet:
        return 0.0
    return max(longest, run.tick_duration)


def time_until_apart(
    link: Link, left: GroupPart, right: GroupPart, tolerance: float
) -> float:
    """Return the time until a contact may be proved never to close again, s.

    `left` and `right` are the first parts of the groups on both sides of the contact.
    The time is 0 if the proof succeeds now, and infinite if the reference motions of
    the groups do not separate, see `finality_kernel.separation_time`. Velocities up to
    `tolerance`, m/s, count as 0.
    """
    opening = right.reference_velocity - left.reference_velocity
    # Smallest velocity with which the gap can grow. It is known if both faces have no
    # other velocities than those of the waves.
    if left.ends_follow_waves and right.ends_follow_waves:
        least_opening = right.min_wave - left.max_wave
    else:
        least_opening = -math.inf
    # The right end (1) of the left group faces the left end (0) of the right group. The
    # gap between the reference motions is the gap, -overlap, without the deviations of
    # both ends from these motions.
    mean_gap = left.end_deviations[1] - right.end_deviations[0] - link.overlap
    left_bound = max_deviation(left, left.compliance_integrals[1])
    right_bound = max_deviation(right, right.compliance_integrals[0])
    bound = left_bound + right_bound
    bound_squared = bound * bound
    return proof.separation_time(
        opening, least_opening, mean_gap, bound_squared, tolerance
    )


def is_quiet(link: Link, group: GroupPart, tolerance: float) -> bool:
    """Return whether a group does not vibrate, and its contact keeps its overlap.

    All waves in the group must be equal within `tolerance`, m/s, and the rate of the
    overlap of the contact `link` at most `tolerance`.
    """
    rate = link.closing[N] - link.mobility * link.force[N]  # at the end of the piece
    wave_range = group.max_wave - group.min_wave
    return bool(wave_range <= tolerance and abs(rate) <= tolerance)


def max_deviation(group: GroupPart, compliance: float) -> float:
    """Return a bound of the deviation of an end of a group at any later time, m.

    The deviation is the displacement of the end from the reference motion. The bound is
    sqrt(2 W s), with the energy W of the group about this motion, and the `compliance`
    s, m/N, the entry of `compliance_integrals` for this end.
    """
    return math.sqrt(2 * group.reference_energy * compliance)


def update_groups(state: State, tick: int) -> None:
    """Set the motion of all groups and of all their parts at a tick.

    Every node has reached this tick, and `read_lines_at` has been called. The first
    part of each group gets the velocity, the reference velocity and energy of the
    group, the bounds of its waves, and the deviations of its ends. Each part gets its
    mean velocity and vibration energy, and the integrals of its waves.
    """
    parts = state.parts
    for first in range(len(parts)):
        group = parts[first]
        if group.part_count == 0:  # a part that is not the first of its group
            continue
        stop = first + group.part_count
        momentum = 0.0
        mass = 0.0
        # Only the mean velocities of this first pass are used. Energies and moments are
        # set in a second pass, when the velocity of the group is known.
        zero_speed = 0.0
        for k in range(first, stop):
            update_part(state, parts[k], zero_speed, tick)
            momentum += parts[k].mass * parts[k].mean_velocity
            mass += parts[k].mass
        if mass > 0:  # it is 0 for a wall alone, whose group velocity stays 0
            group.group_velocity = momentum / mass
        group.reference_velocity = group.group_velocity
        if group.anchor_line != NONE:
            # The velocity of the anchor is the value of the line from outside, which
            # has no delay, at this tick. y runs from -1 to 1 over the piece.
            piece = state.log[state.lines[group.anchor_line].read_piece]
            y = 2 * (tick - piece.start) / (piece.end - piece.start) - 1
            group.reference_velocity = lines.at(piece, y)
        # The energy about the reference motion is m (v - v_ref)^2/2, with the velocity
        # v of the group, plus the vibration energies of the parts about v, below.
        excess = group.group_velocity - group.reference_velocity
        group.reference_energy = mass * (excess * excess) / 2
        # `bound_end_velocities` widens these bounds.
        group.min_wave = group.reference_velocity
        group.max_wave = group.reference_velocity
        for k in range(first, stop):
            update_part(state, parts[k], group.group_velocity, tick)
            group.reference_energy += parts[k].vibration_energy
        for side in range(2):
            set_end(state, first, stop, mass, side)
        bound_end_velocities(state, first, stop)


def update_part(state: State, part: GroupPart, speed: float, tick: int) -> None:
    """Set the mean velocity of a part, its vibration energy, and moments of its waves.

    The energy of a part, and the integrals and moments of the waves of a segment, are
    computed from velocities relative to `speed`, m/s. A segment has v = (a + b)/2 and
    c strain = (b - a)/2. With integrals over y from -1 to 1, its mean velocity is
    (integral of a + integral of b)/4, and its energy m (integral of a^2 + integral of
    b^2)/8. The energy of a mass is m (v - speed)^2/2, that of the spring of a joint
    k d^2/2. Walls and endless rods have the energy 0. Walls, endless rods and joints
    have no mean velocity: the field stays 0.
    """
    part.vibration_energy = 0.0
    if part.kind == PartKind.MASS:
        part.mean_velocity = state.masses[part.index].velocity[0]
        excess = part.mean_velocity - speed
        part.vibration_energy = part.mass * (excess * excess) / 2
    elif part.kind == PartKind.SEGMENT:
        # Segment s has the lines 2 s, to the right, and 2 s + 1, to the left.
        transit = state.lines[2 * part.index].delay
        squares = 0.0
        for way in range(2):  # the waves a and b
            # The waves that are in the segment at this tick were sent within the last
            # transit time.
            first_piece = state.lines[2 * part.index + way].read_piece
            sent_since = tick - transit
            wave = lines.moments(state.log, first_piece, sent_since, transit, speed)
            part.wave_integrals[way] = wave.whole
            part.wave_moments[way] = wave.tilt
            squares += wave.square
        integral = part.wave_integrals[0] + part.wave_integrals[1]
        part.mean_velocity = speed + integral / 4
        part.vibration_energy = part.mass * squares / 8
    elif part.kind == PartKind.JOINT:
        joint = state.links[part.index]
        part.vibration_energy = joint.stiffness * (joint.overlap * joint.overlap) / 2


def set_end(state: State, first: int, stop: int, mass: float, side: int) -> None:
    """Set `end_deviations` and `compliance_integrals` of a group for one of its ends.

    The group consists of the parts from `first` to `stop` - 1, and has the mass `mass`,
    kg. `side` is 0 for its left end, 1 for its right end.

    The deviation is the present displacement of the end from the reference motion, m.
    It is the integral of g strain dx over the group, negative at the left end. g is the
    fraction of the mass that lies beyond x as seen from the end. In an anchored group g
    is 1 (there, the numbers for the anchored end itself have no meaning).

    The compliance integral s, m/N, bounds later deviations by sqrt(2 W s), with the
    energy W about the reference motion. s is the sum of the integrals of g^2 dx/(E A)
    over the segments, and of g^2/k of the joints with a spring k. It is raised so that
    the bound of the deviation grows by the largest stretch of joints that are only
    dashpots. An endless rod makes s very large.
    """
    group = state.parts[first]
    is_anchored = group.anchor_line != NONE
    # Stretching moves the left end (-1) to the left, the right end (+1) to the right.
    sign = 2 * side - 1
    passed = 0.0  # mass of the parts so far, kg
    deviation = 0.0
    compliance = 0.0  # s without dashpots
    dashpot_stretch = 0.0  # largest stretch of all dashpots, over sqrt(2 W)
    for k in range(first, stop):
        part = state.parts[k]
        passed_before = passed
        passed += part.mass
        # g0 is g at the left end of the part, g1 at its right end.
        if is_anchored:
            g0 = 1.0
            g1 = 1.0
        elif side == 0:  # the mass to the right, seen from the left end
            g0 = 1 - passed_before / mass
            g1 = 1 - passed / mass
        else:  # the mass to the left, seen from the right end
            g0 = passed_before / mass
            g1 = passed / mass
        if part.kind == PartKind.SEGMENT:
            transit = state.runs[0].tick_duration * state.lines[2 * part.index].delay
            # `strain_integral` is an integral divided by the transit time.
            deviation += sign * strain_integral(part, g0, g1) * transit
            # The mean of g^2 where g is linear is (g0^2 + g0 g1 + g1^2)/3.
            compliance += part.compliance * (g0 * g0 + g0 * g1 + g1 * g1) / 3
        elif part.kind == PartKind.JOINT:  # it has no mass: g0 and g1 are equal
            joint = state.links[part.index]
            if part.compliance > 0:  # it has a spring, which stretches by -overlap
                deviation -= sign * joint.overlap * g0
                compliance += part.compliance * (g0 * g0)
            else:
                # The stretch of a dashpot c is its impulse over c. The impulse is the
                # change of the momentum of one side. The momentum of a mass m is at
                # most sqrt(2 W m), its change at most twice that: the stretch is at
                # most 2 sqrt(2 W m)/c.
                heavier_side = max(passed, mass - passed)
                dashpot_stretch += 2 * g0 * math.sqrt(heavier_side) / joint.damping
        elif part.kind == PartKind.ENDLESS:
            # This is so large that the sum of the other parts is negligible.
            compliance = part.compliance
    if dashpot_stretch > 0:  # the end deviates by at most sqrt(2 W) total
        total = math.sqrt(compliance) + dashpot_stretch
        compliance = total * total
    group.end_deviations[side] = deviation
    group.compliance_integrals[side] = compliance


def bound_end_velocities(state: State, first: int, stop: int) -> None:
    """Set `min_wave`, `max_wave` and `ends_follow_waves` of a group.

    The group consists of the parts from `first` to `stop` - 1. `min_wave` and
    `max_wave`, m/s, which are the reference velocity so far, are widened to include the
    waves in its segments, and their reflections at walls. `ends_follow_waves` becomes 1
    if the ends of the group have no velocities outside these bounds: for one segment,
    alone or beside walls and endless rods, and for a group of a single part, such as a
    mass.
    """
    group = state.parts[first]  # the fields of a group are those of its first part
    segments = 0
    other_parts = 0
    for k in range(first, stop):
        part = state.parts[k]
        if part.kind == PartKind.SEGMENT:
            segments += 1
            for way in range(2):  # the lines to the right and to the left
                low, high = wave_bounds(
                    state.lines,
                    state.log,
                    2 * part.index + way,
                    group.min_wave,
                    group.max_wave,
                )
                group.min_wave = low
                group.max_wave = high
        elif part.kind < PartKind.WALL:  # a mass or a joint
            other_parts += 1
    for k in range(first, stop):
        if state.parts[k].kind == PartKind.WALL:
            # A wall with the velocity V, which is the reference velocity of the group,
            # reflects a wave w as 2 V - w: the largest wave as the smallest.
            reflected_min = 2 * group.reference_velocity - group.max_wave
            reflected_max = 2 * group.reference_velocity - group.min_wave
            group.min_wave = min(group.min_wave, reflected_min)
            group.max_wave = max(group.max_wave, reflected_max)
    # At most one segment, and beside it only walls and endless rods
    is_one_segment = segments <= 1 and other_parts == 0
    is_single_part = stop - first == 1
    group.ends_follow_waves = is_one_segment or is_single_part


def strain_integral(part: GroupPart, g0: float, g1: float) -> float:
    """Return the integral of g strain dx over a segment, divided by its transit T, m/s.

    g is linear in x, from g0 at the left end to g1 at the right end. `update_part` has
    set the integrals of the waves a (index 0) and b (index 1) over y. With dx = c dt
    and c strain = (b - a)/2, strain dx is (b - a)/2 dt.
    """
    # Let y be the position in the segment, from -1 to 1. The part of b that was sent
    # last is at its right end, so that time in b runs along y. The part of a that was
    # sent last is at its left end: time in a runs against y, and the moment of a
    # changes its sign.
    whole = part.wave_integrals[1] - part.wave_integrals[0]  # integral of b - a
    moment = part.wave_moments[1] + part.wave_moments[0]  # integral of (b - a) y
    # g is (g0 + g1)/2 + (g1 - g0)/2 y, and dt/T is dy/2. With the 1/2 of the strain
    # these are three factors 1/2.
    return float((g0 + g1) * whole + (g1 - g0) * moment) / 8


def wave_bounds(
    all_lines: Lines, log: Log, l: int, low: float, high: float
) -> tuple[float, float]:
    """Widen the bounds `low` and `high`, m/s, to include the waves in line l.

    The waves in the line are its read piece and all later ones. The values of a series
    are within c[0] -/+ (abs(c[1]) + abs(c[2]) + ...). The new bounds are returned.
    """
    i = all_lines[l].read_piece
    while i != NONE:
        piece = log[i]
        amplitude = 0.0  # bound of the difference from c[0]
        if piece.degree > 0:
            for m in range(1, N + 1):
                amplitude += abs(piece.coefficients[m])
        low = min(low, piece.coefficients[0] - amplitude)
        high = max(high, piece.coefficients[0] + amplitude)
        i = piece.next
    return low, high
