"""What happens between pieces.

Contacts close, open and yield, and rigid bodies strike each other.
"""

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
"""Change of velocities, over the velocity scale, below which impacts are solved."""
PEAK_RTOL = 0.9
"""Largest force at the points over the peak so far, below which it is no new peak.

A smooth force rises by less than a tenth between two points.
"""
TRANSIT_PER_SMOOTH_START = 16
"""Shortest transit over the longest start of a contact that may still be smooth."""
RESTING_RTOL = 1e-8
"""Velocity, over the velocity scale, below which parting rigid bodies rest."""


def apply_transition(state: State, node: Node, tick: int, i: int, status: int) -> None:
    """Change the status of link i of a node at a tick, and its state with it.

    A contact that opens or closes gets the overlap 0. Rigid bodies that close strike,
    which decides their status anew. A contact that begins to yield, or comes to a knot
    of its table, gets exactly the overlap of that force; at a knot also its yield force
    and hardening. One that stops to yield gets the yield force that it has reached.
    `break_order` is 0 if the force may jump, else 1; `overlap_acceleration` is 0.
    """
    run = state.runs[0]
    # Machine code counts no references to borrowed arrays.
    links = borrowed(state.links)
    masses = borrowed(state.masses)
    contact_log = borrowed(state.contact_log)
    link = links[i]
    old = link.status
    link.status = status
    link.break_order = 1  # the force kinks, if it does not jump
    link.overlap_acceleration = 0.0
    if status == Status.OPEN or old == Status.OPEN:
        link.overlap = 0.0
    # The event is rounded to a tick, but the overlap at which a law changes is exact.
    if old == Status.PLASTIC and status == Status.PLASTIC:  # a knot of the table
        link.overlap = link.knots[link.next_knot] / link.stiffness
        link.yield_force = link.stiffness * link.overlap
        link.hardening_share = link.shares[link.next_knot]
        link.next_knot += 1
    elif old == Status.PLASTIC:  # it no longer closes
        link.yield_force = link.stiffness * link.overlap
    elif status == Status.PLASTIC:  # it begins to yield
        link.overlap = link.yield_force / link.stiffness
    if old == Status.OPEN:  # it closes
        if contact_laws.force_jumps(link):
            link.break_order = 0
        elif link.law == Law.IMPACT:
            resolve_impacts(run, links, masses, contact_log, node, tick, i)
    elif old == Status.REST:
        link.break_order = 0


def closing_of(masses: Masses, node: Node, q: int) -> float:
    """Return the closing velocity of link q between rigid bodies, m/s.

    It is that at the start of the next piece. In front of the first link and behind the
    last one is a wall, whose velocity is the wave from outside. Between pieces the
    value of index 0 is the present one.
    """
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
    """Return 1/m of the body behind link q, 1/kg; 0 for a wall.

    q = -1 is the body before the first link.
    """
    if q < 0 or q == node.link_count - 1:  # outside the chain is a wall
        return 0.0
    return 1 / float(masses[node.first_mass + q].mass)


def apply_impulse(masses: Masses, node: Node, q: int, impulse: float) -> None:
    """Change the velocities of both masses beside link q by an impulse J in it, N s.

    It drives them apart: -J/m on the left, J/m on the right. Velocities of index 0 are
    changed, the present ones. A wall keeps its velocity.
    """
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
    contact_log: ContactLog,
    node: Node,
    tick: int,
    i: int,
) -> None:
    """Let link i of a node strike, together with all other impact contacts that touch.

    Each takes the least impulse J >= 0 that leaves it a closing of at most -e times the
    one before (Moreau, in CISM 302, 1988), by Gauss-Seidel sweeps, MAX_SWEEPS at most.
    Bodies that would part too slowly to matter come to rest. Velocities of masses are
    changed; `finish_impact` sets the status and totals of the links, and logs them.

    Meanwhile `force[0]` of a striking link is its impulse, N s, `closing[0]` the
    closing velocity before and `closing_after` the largest that is allowed afterwards;
    `unknown_index` is NONE at the other links.
    """
    # Which links strike, and what closing they are to have afterwards
    for q in range(node.link_count):
        link = links[node.first_link + q]
        is_touching = node.first_link + q == i or link.overlap >= 0
        link.unknown_index = NONE
        if link.law == Law.IMPACT and is_touching:
            link.unknown_index = q
            closing = closing_of(masses, node, q)
            # Velocity of parting afterwards; 0 where bodies part already
            parting = 0.0
            if closing > 0:
                parting = link.restitution * closing
            if parting <= RESTING_RTOL * run.velocity_scale:  # too slow to matter
                run.resting_velocity = max(run.resting_velocity, parting)
                link.closing_after = 0.0
            else:
                link.closing_after = -parting
            link.force[0] = 0.0  # its impulse so far
            link.closing[0] = closing
    # Sweeps: each impulse in turn is changed until no closing is too large
    for _ in range(MAX_SWEEPS):
        largest = 0.0  # largest change of a closing in this sweep, m/s
        for q in range(node.link_count):
            link = links[node.first_link + q]
            if link.unknown_index != NONE:
                # Closing that a unit impulse takes away, 1/kg: 1/m + 1/m of both bodies
                velocity_by_impulse = inverse_mass(masses, node, q - 1)
                velocity_by_impulse += inverse_mass(masses, node, q)
                excess = closing_of(masses, node, q) - link.closing_after
                # Change of the impulse `force[0]`, which stays at 0 or above, N s
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
            finish_impact(run, contact_log, link, node.first_link + q, tick, closing)


def finish_impact(
    run: Run, contact_log: ContactLog, link: Link, i: int, tick: int, closing: float
) -> None:
    """Set the status of link i after an impact; log its impulse.

    The impact left the velocity `closing`, m/s. The contact is at rest (REST) if the
    bodies do not part, or so slowly that it does not matter; else it is open (OPEN).
    Its overlap and break order become 0. A strike is logged, and counted in the totals
    of the link and the run. A contact that got no impulse (`force[0]`, N s) did not
    strike: it is not logged.
    """
    struck = link.force[0] > 0
    link.overlap = 0.0
    link.break_order = 0
    if closing >= -RESTING_RTOL * run.velocity_scale:  # the bodies do not part
        link.status = Status.REST.value
        run.resting_impacts += struck  # one more if it struck
        run.resting_velocity = max(run.resting_velocity, -closing)
    else:
        link.status = Status.OPEN.value
    if struck:
        link.impulse += link.force[0]
        log_contact_change(run, contact_log, link, i, tick, Status.PRESS.value)
        change = contact_log[run.contact_event_count - 1]  # the row just logged
        change.impulse = link.force[0]
        change.mean_closing = 0.5 * (link.closing[0] + closing)
        link.last_force_tick = tick
        if link.status == Status.OPEN:
            link.starts_episode = 1
            link.last_opening_tick = tick


def record_piece(state: State, node: Node, ticks: int) -> None:
    """Take the piece of a node that was solved, of `ticks` from now, as done.

    The state of each link and mass becomes that at its end. Of the links, impulse, peak
    force, `force_ticks`, `faint_ticks` and `fading_ticks` are continued. A change of a
    contact between pressing, touching and open is logged; a force that was faint until
    now counts from when it began. Forces, overlaps and velocities are appended to the
    lines of the history, if the run keeps it. `now` of the node stays.
    """
    run = state.runs[0]
    h = ticks * run.tick_duration
    for q in range(node.link_count):
        link = state.links[node.first_link + q]
        if run.keeps_history:
            keep_history(state, node, link, ticks)
        set_end_state(link, h)
        # What the contact did in this piece, as it is logged, and since which tick: it
        # was open or only touched, unless it presses (below).
        if link.status == Status.OPEN:
            touch = Status.OPEN.value
        else:
            touch = Status.GRAZE.value
        touch_start = node.now
        if link.status != Status.OPEN and link.status != Status.GRAZE:  # a force acts
            # The integral is over y, which runs through 2 in the time h.
            link.impulse += 0.5 * h * series.integral(link.force)
            largest = series.largest(link.force)
            # A piece within the window lies where two breaks nearly meet:
            # its peak is round-off.
            if ticks > run.event_window and largest > PEAK_RTOL * link.peak_force:
                raise_peak(link, node)
            overlap = series.largest(link.overlaps)
            is_contact = link.status >= Status.PRESS  # no bond, joint or push
            if is_contact and presses(run, link, largest, overlap):
                touch = Status.PRESS.value
                # A force that was faint until now has begun when the contact closed.
                # `faint_ticks` is NONE, below 0, if that does not count.
                touch_start -= max(link.faint_ticks, 0)
                link.force_ticks += node.now + ticks - touch_start
                if presses(run, link, link.force[N], link.overlaps[N]):
                    link.fading_ticks = 0
                else:  # the force has become faint by the end of the piece
                    link.fading_ticks = ticks
        can_open = link.law >= Law.RIGID  # no bond, push or joint
        if can_open and touch != link.logged_status:
            log_contact_change(
                run, state.contact_log, link, node.first_link + q, touch_start, touch
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


def set_end_state(link: Link, h: float) -> None:
    """Set overlap, rate and acceleration of a link to those at the end of a piece.

    The piece has the duration h, s. d' = closing - Y F, and d'' is the difference
    quotient between the last two points. `break_order` becomes SMOOTH, until an event
    sets it.
    """
    link.break_order = SMOOTH
    link.overlap = link.overlaps[N]
    link.overlap_rate = link.closing[N] - link.mobility * link.force[N]
    rate_before = link.closing[N - 1] - link.mobility * link.force[N - 1]
    rise = link.overlap_rate - rate_before
    # The points are h (X[N] - X[N - 1])/2 apart in time.
    link.overlap_acceleration = 2 * rise / (h * (X[N] - X[N - 1]))


def raise_peak(link: Link, node: Node) -> None:
    """Raise the peak force of a link, and its bound, by the forces of a piece.

    The forces are `link.force`, N, at the points. The bound is raised to the largest
    force of the piece plus what its polynomial and the search for the maximum may miss.
    `node.scratch_series` is overwritten.
    """
    # A maximum below the peak so far, the last argument, is not looked for.
    peak = series.maximum(link.force, node.scratch_series, link.peak_force)
    # Error of the polynomial, and of the search
    error = series.error_at(link.force, peak.position) + peak.miss
    link.peak_force = max(link.peak_force, peak.value)
    link.peak_force_bound = max(link.peak_force_bound, peak.value + error)


def presses(run: Run, link: Link, force: float, overlap: float) -> bool:
    """Return whether a closed contact presses with a force that counts.

    The force is in N, the overlap in m. A compliant contact presses if the force is
    positive and the overlap is more than `graze_velocity` makes in the shortest
    transit. Another one presses if its force makes more than that velocity.
    """
    if link.law >= Law.SPRING:  # its force follows from its overlap
        transit = run.shortest_transit * run.tick_duration
        return force > 0 and overlap > run.graze_velocity * transit
    return force * link.effective_mobility > run.graze_velocity


def count_faint_ticks(run: Run, link: Link, touch: int, ticks: int) -> int:
    """Return for how many ticks a compliant contact has been closed with a faint force.

    The time ends with the last piece, of `ticks`; `touch` is what the contact did in
    it. Such a piece without any positive force is not counted. A force that starts
    smoothly is faint at first; once it presses, it has begun when the contact closed. A
    force that stays faint for long is round-off: then NONE is returned until the
    contact opens or presses. The count is 0 if the contact presses, is open, or is not
    compliant.
    """
    faint = link.faint_ticks
    # The laws from SPRING on are those of an overlap, the states from PRESS on those
    # with a force.
    is_compliant = link.law >= Law.SPRING
    is_closed = is_compliant and link.status >= Status.PRESS
    if touch == Status.PRESS or not is_closed:
        faint = 0
    elif faint != NONE and series.largest(link.force) > 0:
        faint += ticks
        if faint > run.shortest_transit // TRANSIT_PER_SMOOTH_START:
            faint = NONE
    return int(faint)


def log_contact_change(
    run: Run, contact_log: ContactLog, link: Link, i: int, tick: int, touch: int
) -> None:
    """Log that link i presses, only touches or is open from a tick on.

    `touch` is the status: PRESS, GRAZE or OPEN. A row is appended to the log, with
    impulse 0. The link gets `logged_status`; its first and last force, episodes and
    last opening are continued. Where a force ends faintly, `cut_ticks` grows by the
    time for which its end is uncertain.
    """
    if touch == Status.PRESS:
        if link.first_force_tick == NONE:
            link.first_force_tick = tick
        link.episodes += link.starts_episode  # 1 if it has opened since the last one
        link.starts_episode = 0
    elif link.logged_status == Status.PRESS:
        link.last_force_tick = tick
        if link.status >= Status.PRESS:  # the force has become faint
            # It did so somewhere in the last piece, of `fading_ticks`.
            link.cut_ticks += link.fading_ticks
    if touch == Status.OPEN:
        # It pressed in this episode, but only touched in the end.
        was_faint = link.logged_status == Status.GRAZE and link.starts_episode == 0
        if was_faint and link.law >= Law.SPRING and link.damping == 0:
            # A compliant contact without damping presses until it opens: its last force
            # was logged too early by the time since then. This time takes the place of
            # `fading_ticks`, which were cut when it was logged.
            link.cut_ticks += tick - link.last_force_tick - link.fading_ticks
        link.starts_episode = 1
        link.last_opening_tick = tick
    link.logged_status = touch
    change = contact_log[run.contact_event_count]
    change.tick = tick
    change.link = i
    change.status = touch
    change.impulse = 0.0  # those of an impact are set where bodies strike
    change.mean_closing = 0.0
    run.contact_event_count += 1


def keep_history(state: State, node: Node, link: Link, ticks: int) -> None:
    """Append what a link did in a piece of `ticks` to the lines of its history.

    The piece begins at `now` of the node. The lines follow each other from
    `link.history_line` on: the force; of joints and contacts the overlap d; of contacts
    that yield the closing velocity closing - Y F. The last one is kept as it is not the
    rate of d, which is the elastic overlap alone there. The scratch arrays of the node
    are overwritten.
    """
    run = state.runs[0]
    all_lines = state.lines
    log = state.log
    now = node.now
    l = link.history_line
    lines.append_values(
        run, all_lines, log, l, now, ticks, link.force, node.scratch_series
    )
    if link.law >= Law.JOINT:  # its neighbours can move against each other
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
