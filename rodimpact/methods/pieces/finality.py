"""What groups of bonded bodies do at an instant.

The proof that none of them meets again needs it. A group is a stretch of the list of
parts: its first part has their number in `part_count`, and the motion of the group.
Sides are 0, its left end, and 1, its right end.

A wall holds a group: its velocity is the mean, and the mass fraction beyond every x is
1.
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
    Part,
    Parts,
    Run,
    State,
)
from .series import N

REST_RTOL = 2.0**-40
"""Velocity over the velocity scale, below which a body is at rest.

It is the round-off of a long run.
"""
TRUNCATION_SHARE = 1e-3
"""Velocity over the tolerance of pieces that may be their truncation error."""


def check_finality(state: State, tick: int) -> None:
    """Decide at a tick whether the run is over, or when to look again.

    Every node has reached this tick; `last_proof_tick` becomes it. If a proof of
    finality succeeds, `proved_tick` and `end_tick` of the run are set, else
    `next_proof_tick`, the tick of the next look. `stop_reason` becomes DONE at the end
    of the run. The motion of all groups is set, unless there was a proof before and no
    bodies are joined: then it no longer changes. The first check tries no proof; it
    notes the velocities at t = 0.
    """
    run = state.runs[0]
    parts = state.parts
    if run.proved_tick == NONE or run.has_bonds:  # joined bodies go on changing
        read_lines_at(state, tick)
        update_groups(state, tick)
        # The cap on steps has ended the run, or this is its last tick.
        has_ended = run.stop_reason != Stop.NONE or tick >= run.end_tick
        wants_proof = run.next_proof_tick < NEVER and not has_ended
        if run.last_proof_tick == NONE:  # the first check
            for i in range(len(parts)):
                parts[i].initial_velocity = parts[i].group_velocity
        elif wants_proof:
            wait = time_until_over(run, state.links, parts)
            if wait == 0:  # it is proved
                run.proved_tick = tick
                run.next_proof_tick = NEVER
                run.end_tick = min(run.end_tick, tick + run.ticks_after_proof)
            else:
                # However long the wait is, the tick of the next look is below NEVER.
                ticks = int(min(wait / run.tick_duration, 0.5 * NEVER)) + 1
                run.next_proof_tick = tick + max(run.proof_interval, ticks)
        run.last_proof_tick = tick
    if tick >= run.end_tick:
        run.stop_reason = Stop.DONE.value


def read_lines_at(state: State, tick: int) -> None:
    """Move the read pieces of all lines that have pieces to a tick.

    A run that the cap on steps ends has read some lines beyond that tick: there they
    are read from the first piece on.
    """
    run = state.runs[0]
    for l in range(len(state.lines)):
        if state.lines[l].read_piece != NONE:
            if run.stop_reason == Stop.CAP:
                lines.rewind(state.lines, state.log, l)
            lines.advance_to(state.lines, state.log, l, tick)


def time_until_over(run: Run, links: Links, parts: Parts) -> float:
    """Return the time until it may be proved that the run is over, s.

    It is 0 if no contact presses and none can close again, or if nothing changes any
    more. Else it is a tick or more: the longest of the finite times in which open
    contacts get far enough apart if bodies go on as they move now. Velocities below
    REST_RTOL of the scale, and a share of the tolerance, count as 0.
    """
    # Velocities below this one count as 0, m/s.
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
        # A compliant contact counts as pressed until
        # it opens; a rigid one while it has a force.
        has_force = link.force[N] * link.effective_mobility > run.graze_velocity
        is_compliant = link.law > Law.IMPACT  # a spring, or a law after it
        is_pressed = link.status != Status.OPEN and (is_compliant or has_force)
        is_over = is_over and wait == 0 and not is_pressed
        if link.status == Status.OPEN and wait < math.inf:
            longest = max(longest, wait)
    if is_over or is_all_quiet:
        return 0.0
    return max(longest, run.tick_duration)


def time_until_apart(
    link: Link, left: GroupPart, right: GroupPart, tolerance: float
) -> float:
    """Return the time until a contact may be proved not to close again, s.

    The contact is between the groups `left` and `right`, which are given by their first
    parts. The time is 0 if it may be proved now, and infinite if the mean motions do
    not part, see `finality_kernel.separation_time`. Velocities up to `tolerance`, m/s,
    count as 0.
    """
    opening = right.reference_velocity - left.reference_velocity
    # Least velocity with which the two faces can part, known if both have no velocities
    # but those of the waves
    if left.ends_follow_waves and right.ends_follow_waves:
        least_opening = right.min_wave - left.max_wave
    else:
        least_opening = -math.inf
    # Gap between the mean motions: the faces are beside these by their deviations. The
    # right end (1) of the left group faces the left end (0) of the right one.
    mean_gap = left.end_deviations[1] - right.end_deviations[0] - link.overlap
    left_reach = max_deviation(left, left.compliance_integrals[1])
    right_reach = max_deviation(right, right.compliance_integrals[0])
    reach = left_reach + right_reach
    return proof.separation_time(
        opening, least_opening, mean_gap, reach * reach, tolerance
    )


def is_quiet(link: Link, group: GroupPart, tolerance: float) -> bool:
    """Return whether a group moves evenly, and a contact keeps its overlap.

    The contact is one of the group. Velocities within `tolerance`, m/s, are the same.
    Index N is the end of the last piece.
    """
    rate = link.closing[N] - link.mobility * link.force[N]
    return bool(group.max_wave - group.min_wave <= tolerance and abs(rate) <= tolerance)


def max_deviation(group: GroupPart, compliance: float) -> float:
    """Return the largest deviation of an end of a group at any time, m.

    The deviation is that from the mean motion. It is sqrt(2 E s), E the energy of the
    group about that motion and s the `compliance_integrals` of the end.
    """
    return math.sqrt(2 * group.reference_energy * compliance)


def update_groups(state: State, tick: int) -> None:
    """Set the motion of all groups at a tick that every node has reached.

    The lines have been read up to this tick. The first part of each group gets its
    velocity, its reference velocity and energy, the bounds of its waves, and the
    deviations of its ends. All parts get mean velocity, energy and moments.
    """
    parts = state.parts
    for first in range(len(parts)):
        group = parts[first]
        if group.part_count == 0:  # a part that is not the first of its group
            continue
        stop = first + group.part_count
        momentum = 0.0
        mass = 0.0
        for k in range(first, stop):
            # Only the mean velocity counts here. Energies and moments follow below,
            # when the velocity of the group is known.
            update_part(state, parts[k], 0.0, tick)
            momentum += parts[k].mass * parts[k].mean_velocity
            mass += parts[k].mass
        if mass > 0:  # it is 0 for a lone wall
            group.group_velocity = momentum / mass
        group.reference_velocity = group.group_velocity
        if group.anchor_line != NONE:
            # The group comes to the velocity that the line from outside carries: a line
            # without delay, so that its piece is read at this tick.
            piece = state.log[state.lines[group.anchor_line].read_piece]
            y = 2 * (tick - piece.start) / (piece.end - piece.start) - 1
            group.reference_velocity = lines.at(piece, y)
        # The energy about the reference motion is m (v - v_ref)^2/2, v the velocity of
        # the group, plus the vibration energy of the parts about v, added below.
        excess = group.group_velocity - group.reference_velocity
        group.reference_energy = mass * (excess * excess) / 2
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

    The energy, and the integrals and moments of the waves of a segment, are those of
    velocities less `speed`, m/s. In a segment v = (a + b)/2 and c strain = (b - a)/2.
    So over y from -1 to 1 the mean velocity is (integral of a + integral of b)/4, and
    the energy m (integral of a^2 + integral of b^2)/8. A mass has m (v - speed)^2/2,
    the spring of a joint k d^2/2. Anchors have no energy; neither they nor joints get a
    mean velocity.
    """
    part.vibration_energy = 0.0
    if part.kind == Part.MASS:
        part.mean_velocity = state.masses[part.index].velocity[0]
        excess = part.mean_velocity - speed
        part.vibration_energy = part.mass * (excess * excess) / 2
    elif part.kind == Part.SEGMENT:
        # Segment s has the lines 2 s, to the right, and 2 s + 1, to the left.
        transit = state.lines[2 * part.index].delay
        squares = 0.0
        for way in range(2):  # a and b
            # What is under way at the tick was sent in the transit time before it.
            head = state.lines[2 * part.index + way].read_piece
            wave = lines.moments(state.log, head, tick - transit, transit, speed)
            part.wave_integrals[way] = wave.whole
            part.wave_moments[way] = wave.tilt
            squares += wave.square
        integral = part.wave_integrals[0] + part.wave_integrals[1]
        part.mean_velocity = speed + integral / 4
        part.vibration_energy = part.mass * squares / 8
    elif part.kind == Part.JOINT:
        joint = state.links[part.index]
        part.vibration_energy = joint.stiffness * (joint.overlap * joint.overlap) / 2


def set_end(state: State, first: int, stop: int, mass: float, side: int) -> None:
    """Set `end_deviations` and `compliance_integrals` of a group for one of its ends.

    The group has the parts from `first` to before `stop`, and a `mass`, kg; `side` is 0
    for its left end, 1 for its right one. The deviation is the displacement of the end
    from the reference motion now, m: the integral of g strain dx over the group, with a
    minus at the left end, which stretching moves to the left. g is the mass fraction
    beyond x as seen from the end; it is 1 if a wall or an endless rod anchors the group
    (then the numbers of the anchored end itself mean nothing).

    Later the end deviates by sqrt(2 E s) at most, with the energy E about the reference
    motion and the compliance integral s, m/N. Segments give s the integral of
    g^2 dx/(E A), joints with a spring k give g^2/k. The most that dashpots alone
    stretch is added to the deviation. An endless rod makes s very large.
    """
    group = state.parts[first]
    is_anchored = group.anchor_line != NONE
    # Stretching moves the left end to the left, the right one to the right
    sign = 2 * side - 1
    passed = 0.0  # mass of the parts so far, kg
    deviation = 0.0
    compliance = 0.0  # s without dashpots
    dashpot_reach = 0.0  # largest stretch of all dashpots, over sqrt(2 E)
    for k in range(first, stop):
        part = state.parts[k]
        before = passed
        passed += part.mass
        # g0 at the left end of the part, g1 at its right end
        if is_anchored:
            g0 = 1.0
            g1 = 1.0
        elif side == 0:  # as seen from the left end, beyond is to the right
            g0 = 1 - before / mass
            g1 = 1 - passed / mass
        else:
            g0 = before / mass
            g1 = passed / mass
        if part.kind == Part.SEGMENT:
            transit = state.runs[0].tick_duration * state.lines[2 * part.index].delay
            # The integral of g strain dx is over the transit time, m/s.
            deviation += sign * strain_integral(part, g0, g1) * transit
            # The mean of g^2 where g is linear is (g0^2 + g0 g1 + g1^2)/3.
            compliance += part.compliance * (g0 * g0 + g0 * g1 + g1 * g1) / 3
        elif part.kind == Part.JOINT:  # it has no mass: g0 and g1 are equal
            joint = state.links[part.index]
            if part.compliance > 0:  # it has a spring, which stretches by -overlap
                deviation -= sign * joint.overlap * g0
                compliance += part.compliance * (g0 * g0)
            else:
                # A dashpot c alone transmits the change of the momentum of either side.
                # A momentum of the mass m is sqrt(2 E m) at most, its change is twice
                # that, and the stretch 2 sqrt(2 E m)/c.
                heavier_side = max(passed, mass - passed)
                dashpot_reach += 2 * g0 * math.sqrt(heavier_side) / joint.damping
        elif part.kind == Part.ENDLESS:
            # It replaces what the parts before gave: nothing counts beside it.
            compliance = part.compliance
    if dashpot_reach > 0:  # both bounds add: the end moves by sqrt(2 E) reach at most
        reach = math.sqrt(compliance) + dashpot_reach
        compliance = reach * reach
    group.end_deviations[side] = deviation
    group.compliance_integrals[side] = compliance


def bound_end_velocities(state: State, first: int, stop: int) -> None:
    """Set `min_wave`, `max_wave` and `ends_follow_waves` of a group.

    The group has the parts from `first` to before `stop`. The first two bound its
    reference velocity, the waves under way in it, and their reflections at walls, m/s;
    they are the reference velocity before. `ends_follow_waves` says whether its ends
    can take no other velocities. That is so for one segment, free or between walls, and
    for a group that is a single part, such as a mass.
    """
    group = state.parts[first]
    segments = 0
    other_parts = 0
    for k in range(first, stop):
        part = state.parts[k]
        if part.kind == Part.SEGMENT:
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
        elif part.kind < Part.WALL:  # a mass or a joint
            other_parts += 1
    for k in range(first, stop):
        if state.parts[k].kind == Part.WALL:
            # A wall of velocity V reflects a wave w as 2 V - w. The wall is the anchor
            # of the group, so that V is the reference velocity.
            reflected_min = 2 * group.reference_velocity - group.max_wave
            reflected_max = 2 * group.reference_velocity - group.min_wave
            group.min_wave = min(group.min_wave, reflected_min)
            group.max_wave = max(group.max_wave, reflected_max)
    # A segment alone or between walls and endless rods. A group without a segment may
    # be a wall only.
    has_at_most_a_segment = segments <= 1 and other_parts == 0
    group.ends_follow_waves = has_at_most_a_segment or stop - first == 1


def strain_integral(part: GroupPart, g0: float, g1: float) -> float:
    """Return the integral of g strain dx over a segment, over its transit time, m/s.

    g is linear, from g0 at the left end to g1 at the right one. As dx is c dt, strain
    dx is (b - a)/2 dt. The part of a that was sent last is at the left end now, that of
    b at the right end: y of b runs with x, that of a against it, so that their moments
    add.
    """
    mean = part.wave_integrals[1] - part.wave_integrals[0]  # integral of b - a over y
    slope = part.wave_moments[1] + part.wave_moments[0]  # integral of (b - a) y
    # Here y is the place, g is (g0 + g1)/2 + (g1 - g0)/2 y, and strain dx over the
    # transit time is (b - a)/2 dy/2: the three halves make 1/8.
    return float((g0 + g1) * mean + (g1 - g0) * slope) / 8


def wave_bounds(
    all_lines: Lines, log: Log, l: int, low: float, high: float
) -> tuple[float, float]:
    """Return bounds of `low`, `high` and the waves under way in line l, m/s.

    Under way is what lies from the read piece of the line on, to its last one. The
    values of a series are within c[0] -/+ (abs(c[1]) + abs(c[2]) + ...).
    """
    i = all_lines[l].read_piece
    while i != NONE:
        piece = log[i]
        swing = 0.0
        if piece.degree > 0:
            for m in range(1, N + 1):
                swing += abs(piece.coefficients[m])
        low = min(low, piece.coefficients[0] - swing)
        high = max(high, piece.coefficients[0] + swing)
        i = piece.next
    return low, high
