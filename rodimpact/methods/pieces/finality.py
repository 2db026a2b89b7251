"""What groups of bonded bodies do at an instant, for the proof that none of them meets again.

A wall holds a group: its velocity is the mean, and the mass fraction beyond every x is 1.
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
"""Velocity over the velocity scale, below which a body is at rest: round-off of a long run."""
TRUNCATION_SHARE = 1e-3
"""Velocity over the tolerance of pieces, below which it may be their truncation error."""


def check_finality(state: State, tick: int) -> None:
    """Decide at a tick that every node has reached whether the run is over, or when to look again.

    `run.proved_tick` is set with the proof; `run.next_proof_tick` is the tick of the next look.
    """
    run = state.runs[0]
    parts = state.parts
    if run.proved_tick == NONE or run.has_bonds:  # joined bodies go on changing
        for l in range(len(state.lines)):
            if state.lines[l].read_piece != NONE:
                if run.stop_reason == Stop.CAP:
                    lines.rewind(state.lines, state.log, l)
                lines.advance_to(state.lines, state.log, l, tick)
        update_groups(state, tick)
        if run.last_proof_tick == NONE:
            for i in range(len(parts)):
                parts[i].initial_velocity = parts[i].group_velocity
        elif (
            run.next_proof_tick < NEVER
            and run.stop_reason == Stop.NONE
            and tick < run.end_tick
        ):
            time = time_until_over(run, state.links, parts)
            ticks = int(min(time / run.tick_duration, 0.5 * NEVER)) + 1
            run.next_proof_tick = tick + max(run.proof_interval, ticks)
            if time == 0:
                run.proved_tick = tick
                run.next_proof_tick = NEVER
                run.end_tick = min(run.end_tick, tick + run.ticks_after_proof)
        run.last_proof_tick = tick
    if tick >= run.end_tick:
        run.stop_reason = Stop.DONE.value


def time_until_over(run: Run, links: Links, parts: Parts) -> float:
    """Return the time until it may be proved that the run is over, s, as bodies move now.

    It is 0 if no contact can close again, or nothing changes any more.
    """
    slow = REST_RTOL * run.velocity_scale + TRUNCATION_SHARE * run.tolerance
    over = True
    quiet = True
    longest = 0.0
    for i in range(len(links)):
        link = links[i]
        if link.left_group == NONE:
            continue
        left = parts[link.left_group]
        right = parts[link.right_group]
        quiet = quiet and is_quiet(link, left, slow) and is_quiet(link, right, slow)
        time = time_until_apart(link, left, right, slow)
        pressed = link.status != Status.OPEN and (
            link.law > Law.IMPACT
            or link.force[N] * link.effective_mobility > run.graze_velocity
        )
        over = over and time == 0 and not pressed
        if link.status == Status.OPEN and time < math.inf:
            longest = max(longest, time)
    if over or quiet:
        return 0.0
    return max(longest, run.tick_duration)


def time_until_apart(
    link: Link, left: GroupPart, right: GroupPart, slow: float
) -> float:
    """Return the time until a contact between two groups may be proved not to close again, s."""
    least = -math.inf
    if left.ends_follow_waves and right.ends_follow_waves:
        least = right.min_wave - left.max_wave
    apart = left.end_deviations[1] - right.end_deviations[0] - link.overlap
    reach = max_deviation(left, left.compliance_integrals[1]) + max_deviation(
        right, right.compliance_integrals[0]
    )
    return proof.separation_time(
        right.reference_velocity - left.reference_velocity,
        least,
        apart,
        reach * reach,
        slow,
    )


def is_quiet(link: Link, group: GroupPart, slow: float) -> bool:
    """Return whether a group moves evenly, and the overlap of a contact with it is constant."""
    rate = link.closing[N] - link.mobility * link.force[N]
    return bool(group.max_wave - group.min_wave <= slow and abs(rate) <= slow)


def max_deviation(group: GroupPart, compliance: float) -> float:
    """Return the largest deviation of an end of a group from the mean motion at any time, m."""
    return math.sqrt(2 * group.reference_energy * compliance)


def update_groups(state: State, tick: int) -> None:
    """Set the motion of all groups at a tick that every node has reached."""
    parts = state.parts
    for first in range(len(parts)):
        group = parts[first]
        last = first + group.part_count
        if group.part_count == 0:
            continue
        momentum = 0.0
        total = 0.0
        for k in range(first, last):
            update_part(state, parts[k], 0.0, tick)
            momentum += parts[k].mass * parts[k].mean_velocity
            total += parts[k].mass
        if total > 0:
            group.group_velocity = momentum / total
        group.reference_velocity = group.group_velocity
        if group.anchor_line != NONE:
            # The group comes to the velocity that the line from outside carries.
            piece = state.log[state.lines[group.anchor_line].read_piece]
            y = 2 * (tick - piece.start) / (piece.end - piece.start) - 1
            group.reference_velocity = lines.at(piece, y)
        off = group.group_velocity - group.reference_velocity
        group.reference_energy = total * (off * off) / 2
        group.min_wave = group.reference_velocity
        group.max_wave = group.reference_velocity
        for k in range(first, last):
            update_part(state, parts[k], group.group_velocity, tick)
            group.reference_energy += parts[k].vibration_energy
        for side in range(2):
            set_end(state, first, last, total, side)
        bound_end_velocities(state, first, last)


def update_part(state: State, part: GroupPart, speed: float, tick: int) -> None:
    """Set the mean velocity of a part, its energy about a velocity, and moments of its waves."""
    part.vibration_energy = 0.0
    if part.kind == Part.MASS:
        part.mean_velocity = state.masses[part.index].velocity[0]
        part.vibration_energy = (
            part.mass
            * ((part.mean_velocity - speed) * (part.mean_velocity - speed))
            / 2
        )
    elif part.kind == Part.SEGMENT:
        transit = state.lines[2 * part.index].delay
        squares = 0.0
        for way in range(2):
            head = state.lines[2 * part.index + way].read_piece
            whole, tilt, _, square = lines.moments(
                state.log, head, tick - transit, transit, speed
            )
            part.wave_integrals[way] = whole
            part.wave_moments[way] = tilt
            squares += square
        part.mean_velocity = (
            speed + (part.wave_integrals[0] + part.wave_integrals[1]) / 4
        )
        part.vibration_energy = part.mass * squares / 8
    elif part.kind == Part.JOINT:
        joint = state.links[part.index]
        part.vibration_energy = joint.stiffness * (joint.overlap * joint.overlap) / 2


def set_end(state: State, first: int, last: int, total: float, side: int) -> None:
    """Set the displacement of an end of a group, and the factor that bounds it later.

    With E the energy about the reference motion, elastic parts move the end by sqrt(2 E s) at most,
    s = integral of g^2 dx/(E A), g the mass fraction beyond x as seen from the end. At the left and
    at the right of a part it is g and w.

    A dashpot c transmits the change of the momentum of either side. A momentum of the mass m is
    sqrt(2 E m) at most, so its change is at most twice that, and the stretch 2 sqrt(2 E m)/c. Both
    bounds add: the end moves by sqrt(2 E) (sqrt(s) + sum of 2 g sqrt(m)/c) at most.
    """
    group = state.parts[first]
    is_anchored = group.anchor_line != NONE
    sign = 2 * side - 1
    passed = 0.0
    deviation = 0.0
    compliance = 0.0
    stretch = 0.0  # of dashpots, over sqrt(2 E)
    for k in range(first, last):
        part = state.parts[k]
        before = passed
        passed += part.mass
        g = 1.0
        w = 1.0
        if not is_anchored:
            g = before / total
            w = passed / total
        if not is_anchored and side == 0:
            g = 1 - g
            w = 1 - w
        if part.kind == Part.SEGMENT:
            transit = state.runs[0].tick_duration * state.lines[2 * part.index].delay
            deviation += sign * strain_integral(part, g, w) * transit
            compliance += part.compliance * (g * g + g * w + w * w) / 3
        elif part.kind == Part.JOINT:
            joint = state.links[part.index]
            if part.compliance > 0:
                deviation -= sign * joint.overlap * g
                compliance += part.compliance * (g * g)
            else:
                mass = max(passed, total - passed)
                stretch += 2 * g * math.sqrt(mass) / joint.damping
        elif part.kind == Part.ENDLESS:
            compliance = part.compliance
    if stretch > 0:
        reach = math.sqrt(compliance) + stretch
        compliance = reach * reach
    group.end_deviations[side] = deviation
    group.compliance_integrals[side] = compliance


def bound_end_velocities(state: State, first: int, last: int) -> None:
    """Set the bounds of the velocities of the ends of a group that is one segment.

    Its end can only take velocities of the waves in it, of their reflections, and of its anchor.
    """
    group = state.parts[first]
    segments = 0
    other_parts = 0
    for k in range(first, last):
        part = state.parts[k]
        if part.kind == Part.SEGMENT:
            segments += 1
            for side in range(2):
                low, high = wave_bounds(
                    state.lines,
                    state.log,
                    2 * part.index + side,
                    group.min_wave,
                    group.max_wave,
                )
                group.min_wave = low
                group.max_wave = high
        elif part.kind < Part.WALL:
            other_parts += 1  # masses and joints
    for k in range(first, last):
        if state.parts[k].kind == Part.WALL:
            # A wall reflects waves about its velocity.
            reflected_min = 2 * group.reference_velocity - group.max_wave
            reflected_max = 2 * group.reference_velocity - group.min_wave
            group.min_wave = min(group.min_wave, reflected_min)
            group.max_wave = max(group.max_wave, reflected_max)
    is_segment = segments <= 1 and other_parts == 0
    group.ends_follow_waves = is_segment or last - first == 1


def strain_integral(part: GroupPart, g: float, w: float) -> float:
    """Return the integral of strain g dx over the transit time, with g linear from g to w.

    As dx is c dt, strain dx is (b - a)/2 dt. The wave that a sent last is at the left end now, the
    wave that b sent last at the right end.
    """
    mean = part.wave_integrals[1] - part.wave_integrals[0]
    slope = part.wave_moments[1] + part.wave_moments[0]
    return float((g + w) * mean + (w - g) * slope) / 8


def wave_bounds(
    all_lines: Lines, log: Log, l: int, low: float, high: float
) -> tuple[float, float]:
    """Return bounds of the waves under way in a line, and of two velocities."""
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
