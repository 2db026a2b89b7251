"""What happens between pieces: contacts close, open, yield, and rigid bodies strike each other."""

from .. import contact_laws
from ..compiling import borrowed
from ..link import Law
from ..states import Status
from . import lines, series
from .records import NONE, SMOOTH, ContactLog, Link, Links, Masses, Node, Run, State
from .series import N, X

MAX_SWEEPS = 1000
"""Gauss-Seidel sweeps over the impacts of one instant."""
IMPACT_RTOL = 1e-15
"""Change of velocities over the velocity scale, below which the impacts are solved: round-off."""
PEAK_RTOL = 0.9
"""Largest force at the points over the peak so far, below which the piece has no new peak.

A smooth force rises by less than a tenth between two points.
"""
TRANSIT_PER_SMOOTH_START = 16
"""Shortest transit over the longest start of a contact that may still be smooth."""
RESTING_RTOL = 1e-8
"""Velocity over the velocity scale, below which rigid bodies part so slowly that they rest."""


def apply_transition(state: State, node: Node, tick: int, i: int, status: int) -> None:
    """Change the status of link i, and set the order of the break that this makes."""
    run = state.runs[0]
    links = borrowed(state.links)
    masses = borrowed(state.masses)
    turns = borrowed(state.contact_log)
    link = links[i]
    old = link.status
    link.status = status
    link.break_order = 1
    link.overlap_acceleration = 0.0
    if status == Status.OPEN or old == Status.OPEN:
        link.overlap = 0.0
    # The event is rounded to a tick: forces at which a law changes are exact all the same.
    if old == Status.PLASTIC:
        if status == Status.PLASTIC:
            link.overlap = link.knots[link.next_knot] / link.stiffness
        link.yield_force = link.stiffness * link.overlap
        if status == Status.PLASTIC:
            link.hardening_share = link.shares[link.next_knot]
            link.next_knot += 1
    elif status == Status.PLASTIC:
        link.overlap = link.yield_force / link.stiffness
    if old == Status.OPEN:
        if contact_laws.force_jumps(link):
            link.break_order = 0
        elif link.law == Law.IMPACT:
            resolve_impacts(run, links, masses, turns, node, tick, i)
    elif old == Status.REST:
        link.break_order = 0


def closing_of(masses: Masses, node: Node, q: int) -> float:
    """Return the closing velocity of rigid bodies at the start of the next piece."""
    if q == 0:
        before = node.incoming[0][0]
    else:
        before = masses[node.first_mass + q - 1].velocity[0]
    if q == node.link_count - 1:
        behind = node.incoming[1][0]
    else:
        behind = masses[node.first_mass + q].velocity[0]
    return float(before - behind)


def inverse_mass(masses: Masses, node: Node, q: int) -> float:
    """Return 1/m of the body behind link q; 0 for a wall."""
    if q < 0 or q == node.link_count - 1:
        return 0.0
    return 1 / float(masses[node.first_mass + q].mass)


def apply_impulse(masses: Masses, node: Node, q: int, impulse: float) -> None:
    """Change the velocities of both bodies beside link q by an impulse in it."""
    if q > 0:
        before = inverse_mass(masses, node, q - 1)
        masses[node.first_mass + q - 1].velocity[0] -= impulse * before
    if q < node.link_count - 1:
        behind = inverse_mass(masses, node, q)
        masses[node.first_mass + q].velocity[0] += impulse * behind


def resolve_impacts(
    run: Run,
    links: Links,
    masses: Masses,
    turns: ContactLog,
    node: Node,
    tick: int,
    i: int,
) -> None:
    """Let rigid bodies strike, all together that touch.

    Each contact takes the least impulse that leaves it a closing of at most -e times the one before
    (Moreau, in CISM 302, 1988). Bodies that would part too slowly to matter come to rest.
    """
    for q in range(node.link_count):
        link = links[node.first_link + q]
        touching = link.law == Law.IMPACT and (
            node.first_link + q == i or link.overlap >= 0
        )
        link.unknown_index = NONE
        if touching:
            link.unknown_index = q
            closing = closing_of(masses, node, q)
            link.closing_after = 0.0
            if closing > 0:
                link.closing_after = -link.restitution * closing
            if -link.closing_after <= RESTING_RTOL * run.velocity_scale:
                run.resting_velocity = max(run.resting_velocity, -link.closing_after)
                link.closing_after = 0.0
            link.force[0] = 0.0
            link.closing[0] = closing
    for _ in range(MAX_SWEEPS):
        largest = 0.0
        for q in range(node.link_count):
            link = links[node.first_link + q]
            if link.unknown_index != NONE:
                velocity_by_impulse = inverse_mass(masses, node, q - 1)
                velocity_by_impulse += inverse_mass(masses, node, q)
                excess = closing_of(masses, node, q) - link.closing_after
                step = max(excess / velocity_by_impulse, -link.force[0])
                link.force[0] += step
                apply_impulse(masses, node, q, step)
                largest = max(largest, abs(step) * velocity_by_impulse)
        if largest <= IMPACT_RTOL * run.velocity_scale:
            break
    for q in range(node.link_count):
        link = links[node.first_link + q]
        if link.unknown_index != NONE:
            closing = closing_of(masses, node, q)
            finish_impact(run, turns, link, node.first_link + q, tick, closing)


def finish_impact(
    run: Run, turns: ContactLog, link: Link, i: int, tick: int, closing: float
) -> None:
    """Log the impulse of an impact; bodies that do not part rest, as long as they are pressed."""
    struck = link.force[0] > 0
    link.overlap = 0.0
    link.break_order = 0
    link.status = Status.OPEN.value
    if closing >= -RESTING_RTOL * run.velocity_scale:
        link.status = Status.REST.value
        run.resting_impacts += struck
        run.resting_velocity = max(run.resting_velocity, -closing)
    if struck:
        link.impulse += link.force[0]
        log_contact_change(run, turns, link, i, tick, Status.PRESS.value)
        turn = turns[run.contact_event_count - 1]
        turn.impulse = link.force[0]
        turn.mean_closing = 0.5 * (link.closing[0] + closing)
        link.last_force_tick = tick
        if link.status == Status.OPEN:
            link.starts_episode = 1
            link.last_opening_tick = tick


def record_piece(state: State, node: Node, ticks: int) -> None:
    """Enter the effects of a piece on the links and masses of a node: states, totals, logs."""
    run = state.runs[0]
    h = ticks * run.tick_duration
    for q in range(node.link_count):
        link = state.links[node.first_link + q]
        if run.keeps_history:
            keep_history(state, node, link, ticks)
        link.break_order = SMOOTH
        link.overlap = link.overlaps[N]
        link.overlap_rate = link.closing[N] - link.mobility * link.force[N]
        before = link.closing[N - 1] - link.mobility * link.force[N - 1]
        link.overlap_acceleration = (
            2 * (link.overlap_rate - before) / (h * (X[N] - X[N - 1]))
        )
        touch = Status.GRAZE.value
        if link.status == Status.OPEN:
            touch = Status.OPEN.value
        start = node.now
        if link.status != Status.OPEN and link.status != Status.GRAZE:
            link.impulse += 0.5 * h * series.integral(link.force)
            largest = series.largest(link.force)
            # A piece within the window lies where two breaks nearly meet: its peak is round-off.
            if ticks > run.event_window and largest > PEAK_RTOL * link.peak_force:
                peak = series.maximum(link.force, node.scratch_series, link.peak_force)
                error = series.remainder(link.force, False)
                if peak > largest:  # it was searched for between the points
                    rise = peak - series.smallest(link.force)
                    error += series.EXTREMUM_RTOL * rise
                link.peak_force = max(link.peak_force, peak)
                link.peak_force_bound = max(link.peak_force_bound, peak + error)
            overlap = series.largest(link.overlaps)
            if link.status >= Status.PRESS and presses(run, link, largest, overlap):
                touch = Status.PRESS.value
                link.fading_ticks = 0
                if not presses(run, link, link.force[N], link.overlaps[N]):
                    link.fading_ticks = ticks
                start -= max(link.faint_ticks, 0)
                link.force_ticks += node.now + ticks - start
        if link.law >= Law.RIGID and touch != link.logged_status:
            log_contact_change(
                run, state.contact_log, link, node.first_link + q, start, touch
            )
        link.faint_ticks = count_faint_ticks(run, link, touch, ticks)
    for i in range(node.link_count - 1):
        body = state.masses[node.first_mass + i]
        if run.keeps_history:
            lines.append_values(
                run,
                state.lines,
                state.log,
                body.history_line,
                node.now,
                ticks,
                body.velocity,
                node.scratch_series,
            )
        body.velocity[0] = body.velocity[N]


def presses(run: Run, link: Link, force: float, overlap: float) -> bool:
    """Return whether a touching contact presses with a force, N, at an overlap, m.

    A contact with a contact law must have an overlap too; others are decided by their force.
    """
    if link.law >= Law.SPRING:
        transit = run.shortest_transit * run.tick_duration
        return force > 0 and overlap > run.graze_velocity * transit
    return force * link.effective_mobility > run.graze_velocity


def count_faint_ticks(run: Run, link: Link, touch: int, ticks: int) -> int:
    """Return for how many ticks a compliant contact has been closed with a faint force.

    A force that starts smoothly is faint at first; once it presses, it has begun when the contact
    closed. A force that stays faint for long is round-off: then NONE is returned until the contact
    opens.
    """
    faint = link.faint_ticks
    closed = link.law >= Law.SPRING and link.status >= Status.PRESS
    if touch == Status.PRESS or not closed:
        faint = 0
    elif faint != NONE and series.largest(link.force) > 0:
        faint += ticks
        if faint > run.shortest_transit // TRANSIT_PER_SMOOTH_START:
            faint = NONE
    return int(faint)


def log_contact_change(
    run: Run, turns: ContactLog, link: Link, i: int, tick: int, touch: int
) -> None:
    """Log that a contact is touched, presses or is left."""
    if touch == Status.PRESS:
        if link.first_force_tick == NONE:
            link.first_force_tick = tick
        link.episodes += link.starts_episode
        link.starts_episode = 0
    elif link.logged_status == Status.PRESS:
        link.last_force_tick = tick
        if link.status >= Status.PRESS:  # the force has become faint
            link.cut_ticks += link.fading_ticks
    if touch == Status.OPEN:
        is_faint = link.logged_status == Status.GRAZE and link.starts_episode == 0
        if is_faint and link.law >= Law.SPRING and link.damping == 0:
            # a spring presses until it opens: by so much its last force comes too early
            link.cut_ticks += tick - link.last_force_tick - link.fading_ticks
        link.starts_episode = 1
        link.last_opening_tick = tick
    link.logged_status = touch
    turn = turns[run.contact_event_count]
    turn.tick = tick
    turn.link = i
    turn.status = touch
    turn.impulse = 0.0
    turn.mean_closing = 0.0
    run.contact_event_count += 1


def keep_history(state: State, node: Node, link: Link, ticks: int) -> None:
    """Keep the force of a link over a piece, its overlap, and the closing rate of one that yields.

    The lines that keep them follow each other from `link.history_line` on.
    """
    run = state.runs[0]
    all_lines = state.lines
    log = state.log
    now = node.now
    l = link.history_line
    lines.append_values(
        run, all_lines, log, l, now, ticks, link.force, node.scratch_series
    )
    if link.law >= Law.JOINT:
        lines.append_values(
            run, all_lines, log, l + 1, now, ticks, link.overlaps, node.scratch_series
        )
    if link.law == Law.YIELD:
        for j in range(series.POINTS):
            node.scratch_values[j] = link.closing[j] - link.mobility * link.force[j]
        lines.append_values(
            run,
            all_lines,
            log,
            l + 2,
            now,
            ticks,
            node.scratch_values,
            node.scratch_series,
        )
