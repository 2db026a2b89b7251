"""Changes of state between pieces, and totals of each piece.

Contacts close, open and yield, and rigid bodies strike each other. Each finished piece
is added to the totals, the log of contacts, and the history.
"""

from .. import contact_laws
from ..compiling import borrowed
from ..link import Law
from ..states import Status
from . import lines, series
from .records import NONE, SMOOTH, ContactLog, Link, Links, Masses, Node, Run, State
from .series import N, X

MAX_SWEEPS = 1000
"""Largest number of Gauss-Seidel sweeps over the impacts of one instant."""
IMPACT_RTOL = 1e-15
"""Largest change of a velocity in the last sweep, relative to the velocity scale."""
PEAK_RTOL = 0.9
"""Ratio of a force at the points to the peak so far, above which a new peak is sought.

A smooth force rises by less than a tenth between two points.
"""
TRANSIT_PER_SMOOTH_START = 16
"""Shortest transit over the longest time for which a starting force may be faint."""
RESTING_RTOL = 1e-8
"""Opening velocity, over the velocity scale, up to which rigid bodies come to rest."""


def apply_transition(state: State, node: Node, tick: int, i: int, status: int) -> None:
    """Change the status of link i of a node at a tick, and the state of the link.

    A contact that opens or closes gets the overlap 0. If rigid bodies close (an impact
    contact), they strike, which decides the status again. A contact that begins to
    yield, or reaches a knot of its table, gets exactly the overlap at which it does; at
    a knot also the yield force and the hardening of the next line. A contact that stops
    yielding gets the yield force that it has reached. `break_order` becomes 0 if the
    force may jump, else 1, and `overlap_acceleration` becomes 0.
    """
    run = state.runs[0]
    # For speed: machine code does not count references to borrowed arrays.
    links = borrowed(state.links)
    masses = borrowed(state.masses)
    contact_log = borrowed(state.contact_log)
    link = links[i]
    old_status = link.status
    link.status = status
    link.break_order = 1  # the slope of the force jumps, if not the force (below)
    link.overlap_acceleration = 0.0
    if status == Status.OPEN or old_status == Status.OPEN:
        link.overlap = 0.0
    # The time of the event is rounded to a tick, so that the overlap is not exactly the
    # one at which the law changes: it is set to it.
    if old_status == Status.PLASTIC and status == Status.PLASTIC:  # a knot
        link.overlap = link.knots[link.next_knot] / link.stiffness  # elastic overlap
        link.yield_force = link.stiffness * link.overlap
        link.hardening_share = link.shares[link.next_knot]
        link.next_knot += 1
    elif old_status == Status.PLASTIC:  # it no longer closes, and stops yielding
        link.yield_force = link.stiffness * link.overlap
    elif status == Status.PLASTIC:  # it begins to yield
        link.overlap = link.yield_force / link.stiffness
    if old_status == Status.OPEN:  # it closes
        if contact_laws.force_jumps(link):
            link.break_order = 0
        elif link.law == Law.IMPACT:
            resolve_impacts(run, links, masses, contact_log, node, tick, i)
    elif old_status == Status.REST:  # its force may jump to 0
        link.break_order = 0


def closing_of(masses: Masses, node: Node, q: int) -> float:
    """Return the present closing velocity of link q between rigid bodies, m/s.

    It is the velocity on the left minus that on the right. On the left of the first
    link and on the right of the last one is a wall, with the velocity of the signal
    from outside, `incoming`. The present values, between two pieces, have the index 0:
    the start of the next piece.
    """
    if q == 0:
        left = node.incoming[0][0]
    else:
        left = masses[node.first_mass + q - 1].velocity[0]
    if q == node.link_count - 1:
        right = node.incoming[1][0]
    else:
        right = masses[node.first_mass + q].velocity[0]
    return float(left - right)


def inverse_mass(masses: Masses, node: Node, q: int) -> float:
    """Return 1/m of the body on the right of link q, 1/kg; 0 for a wall.

    q = -1 stands for the body on the left of the first link, which is a wall, as is the
    body on the right of the last link.
    """
    if q < 0 or q == node.link_count - 1:
        return 0.0
    return 1 / float(masses[node.first_mass + q].mass)


def apply_impulse(masses: Masses, node: Node, q: int, impulse: float) -> None:
    """Change the velocities of the masses on both sides of link q by an impulse, N s.

    An impulse J in the link drives the masses apart: it adds -J/m on the left and J/m
    on the right to their present velocities, `velocity[0]`. A wall keeps its velocity.
    """
    if q > 0:
        inverse_left = inverse_mass(masses, node, q - 1)
        masses[node.first_mass + q - 1].velocity[0] -= impulse * inverse_left
    if q < node.link_count - 1:
        inverse_right = inverse_mass(masses, node, q)
        masses[node.first_mass + q].velocity[0] += impulse * inverse_right


def resolve_impacts(
    run: Run,
    links: Links,
    masses: Masses,
    contact_log: ContactLog,
    node: Node,
    tick: int,
    i: int,
) -> None:
    """Resolve the impact of link i of a node and all other impact contacts that touch.

    Each contact takes the smallest impulse J >= 0 after which its closing velocity is
    at most -e times that before, with the restitution e (Moreau, in CISM 302, 1988).
    The impulses are found by Gauss-Seidel sweeps, at most MAX_SWEEPS. e counts as 0
    where the bodies would part too slowly to matter; the largest opening velocity
    neglected in this way is kept as `resting_velocity` of the run, m/s. Velocities of
    masses are changed; `finish_impact` then sets the status and totals of these links,
    and logs the impacts.

    In this function the fields of an impacting link have other meanings: `force[0]` is
    its impulse, N s, `closing[0]` its closing velocity before the impact, and
    `closing_after` the largest closing velocity that is allowed afterwards.
    `unknown_index` is NONE at all other links.
    """
    # Find the links that impact, and their allowed closing velocities
    for q in range(node.link_count):
        link = links[node.first_link + q]
        is_closing = node.first_link + q == i  # the link whose event this is
        is_touching = is_closing or link.overlap >= 0
        link.unknown_index = NONE
        if link.law == Law.IMPACT and is_touching:
            link.unknown_index = q  # any number but NONE marks an impacting link
            closing = closing_of(masses, node, q)
            # Opening velocity afterwards; 0 if the bodies do not close before
            opening = 0.0
            if closing > 0:
                opening = link.restitution * closing
            if opening <= RESTING_RTOL * run.velocity_scale:  # too slow to matter
                run.resting_velocity = max(run.resting_velocity, opening)
                link.closing_after = 0.0
            else:
                link.closing_after = -opening
            link.force[0] = 0.0  # the impulse so far
            link.closing[0] = closing
    # In each sweep the impulses are corrected one after another.
    for _ in range(MAX_SWEEPS):
        largest = 0.0  # largest change of a closing velocity in this sweep, m/s
        for q in range(node.link_count):
            link = links[node.first_link + q]
            if link.unknown_index != NONE:
                # Closing velocity that a unit impulse takes away, 1/kg:
                # 1/m_left + 1/m_right. The body on the right of link q has the number
                # q, so the body on its left has the number q - 1.
                velocity_by_impulse = inverse_mass(masses, node, q - 1)
                velocity_by_impulse += inverse_mass(masses, node, q)
                excess = closing_of(masses, node, q) - link.closing_after
                # Change of the impulse, N s, after which the impulse, `force[0]`, is 0
                # or more
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
    """Set the status of link i after an impact, log the impact, and count it.

    `closing` is the closing velocity after the impact, m/s. The link comes to rest
    (REST) if the bodies do not part, or too slowly to matter; otherwise it is open
    (OPEN). Its overlap and break order become 0. If it got an impulse (`force[0]` > 0,
    N s), the impact is logged, and counted in the totals of the link and the run. A
    contact without an impulse is not logged: it only touched.
    """
    struck = link.force[0] > 0
    link.overlap = 0.0
    link.break_order = 0
    if closing >= -RESTING_RTOL * run.velocity_scale:  # the bodies do not part
        link.status = Status.REST.value
        run.resting_impacts += struck  # one more if it is true
        run.resting_velocity = max(run.resting_velocity, -closing)
    else:
        link.status = Status.OPEN.value
    if struck:
        link.impulse += link.force[0]
        log_contact_change(run, contact_log, link, i, tick, Status.PRESS.value)
        impact = contact_log[run.contact_event_count - 1]  # the row just logged
        impact.impulse = link.force[0]
        impact.mean_closing = 0.5 * (link.closing[0] + closing)  # before and after
        link.last_force_tick = tick
        if link.status == Status.OPEN:
            link.starts_episode = 1
            link.last_opening_tick = tick


def record_piece(state: State, node: Node, ticks: int) -> None:
    """Record the solved piece of a node, of `ticks` from now.

    The state of each link and mass becomes that at the end of the piece. The impulse,
    peak force and times of force of each link are updated. If a contact changes between
    pressing, touching and open, this is logged at the start of the piece; if its force
    was too faint to count until now, at the start of the faint force. Forces, overlaps
    and velocities are appended to the lines of the history, if the run keeps it. `now`
    of the node is not changed.
    """
    run = state.runs[0]
    h = ticks * run.tick_duration
    for q in range(node.link_count):
        link = state.links[node.first_link + q]
        if run.keeps_history:
            keep_history(state, node, link, ticks)
        set_end_state(link, h)
        # Status of the contact as it is logged, and the tick since which it has this
        # status. It is open or touches, unless it is found to press (below).
        if link.status == Status.OPEN:
            logged = Status.OPEN.value
        else:
            logged = Status.GRAZE.value
        logged_since = node.now
        has_force = link.status != Status.OPEN and link.status != Status.GRAZE
        if has_force:
            # The integral is over y, which runs through 2 in the time h.
            link.impulse += 0.5 * h * series.integral(link.force)
            largest = series.largest(link.force)
            # A piece as short as `event_window` lies between two breaks that nearly
            # coincide: its peak is round-off.
            is_long = ticks > run.event_window
            may_raise_peak = largest > PEAK_RTOL * link.peak_force
            if is_long and may_raise_peak:
                raise_peak(link, node)
            overlap = series.largest(link.overlaps)
            is_contact = link.status >= Status.PRESS  # not a bond, joint or push
            if is_contact and presses(run, link, largest, overlap):
                logged = Status.PRESS.value
                # If the force was faint until now, it began `faint_ticks` ago. NONE,
                # which is negative, means that this time does not count.
                logged_since -= max(link.faint_ticks, 0)
                # The force lasts from `logged_since` to the end of the piece.
                link.force_ticks += node.now + ticks - logged_since
                # [N] is the value at the end of the piece.
                if presses(run, link, link.force[N], link.overlaps[N]):
                    link.fading_ticks = 0
                else:  # the force becomes faint somewhere in this piece
                    link.fading_ticks = ticks
        can_open = link.law >= Law.RIGID  # not a bond, push or joint
        if can_open and logged != link.logged_status:
            i = node.first_link + q
            log_contact_change(run, state.contact_log, link, i, logged_since, logged)
        link.faint_ticks = count_faint_ticks(run, link, logged, ticks)
    for m in range(node.link_count - 1):
        body = state.masses[node.first_mass + m]
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
        body.velocity[0] = body.velocity[N]  # the start of the next piece


def set_end_state(link: Link, h: float) -> None:
    """Set the overlap d of a link, d' and d'' to their values at the end of a piece.

    The piece has the duration h, s. The rate is d' = closing - Y F, and d'' is its
    difference quotient between the last two points. `break_order` becomes SMOOTH: an
    event may set it afterwards.
    """
    link.break_order = SMOOTH
    link.overlap = link.overlaps[N]
    link.overlap_rate = link.closing[N] - link.mobility * link.force[N]
    rate_before = link.closing[N - 1] - link.mobility * link.force[N - 1]
    rise = link.overlap_rate - rate_before
    # The points are h (X[N] - X[N - 1])/2 apart in time.
    link.overlap_acceleration = 2 * rise / (h * (X[N] - X[N - 1]))


def raise_peak(link: Link, node: Node) -> None:
    """Raise the peak force of a link to the largest force of a piece, if larger.

    `link.force` has the forces at the points of the piece, N. `peak_force_bound` is
    raised, too, to the largest force of the piece plus its error. `node.scratch_series`
    is overwritten.
    """
    # No maximum below the last argument is searched for.
    peak = series.maximum(link.force, node.scratch_series, link.peak_force)
    # Error of the polynomial, and of the search for its maximum
    error = series.error_at(link.force, peak.position) + peak.miss
    link.peak_force = max(link.peak_force, peak.value)
    link.peak_force_bound = max(link.peak_force_bound, peak.value + error)


def presses(run: Run, link: Link, force: float, overlap: float) -> bool:
    """Return whether a closed contact presses with a force that is not too faint.

    `force` is in N, `overlap` in m. A compliant contact presses if the force is
    positive, and the overlap larger than `graze_velocity` times the shortest transit. A
    rigid contact presses if its force makes a velocity above `graze_velocity`.
    """
    if link.law >= Law.SPRING:  # its force follows from its overlap
        transit = run.shortest_transit * run.tick_duration
        return force > 0 and overlap > run.graze_velocity * transit
    return force * link.effective_mobility > run.graze_velocity


def count_faint_ticks(run: Run, link: Link, logged: int, ticks: int) -> int:
    """Return how long a compliant contact has had only a faint force, in ticks.

    The result is the new `faint_ticks` of the link after a piece of `ticks`, in which
    the contact was `logged` as PRESS, GRAZE or OPEN. A force that starts smoothly is
    faint at first; once it presses, this time counts as part of its duration. Pieces
    without any positive force add nothing. A force that stays faint for long is
    round-off: then NONE is returned until the next result 0. The result is 0 if PRESS
    is logged, if the contact is open or closed without force, or if it is not
    compliant. GRAZE is logged for each closed contact that is not found to press, also
    if `link.status` is PRESS and the force is faint.
    """
    faint = link.faint_ticks
    is_compliant = link.law >= Law.SPRING
    # From PRESS on a contact has a force, which may be too faint to be logged as PRESS.
    has_force = is_compliant and link.status >= Status.PRESS
    if logged == Status.PRESS or not has_force:
        faint = 0
    elif faint != NONE and series.largest(link.force) > 0:
        faint += ticks
        if faint > run.shortest_transit // TRANSIT_PER_SMOOTH_START:
            faint = NONE
    return int(faint)


def log_contact_change(
    run: Run, contact_log: ContactLog, link: Link, i: int, tick: int, logged: int
) -> None:
    """Log that link i presses, touches without a force, or is open from a tick on.

    `logged` is its status from then on: PRESS, GRAZE or OPEN. A row is appended to the
    log, with the impulse 0; `logged_status` of the link and its totals are updated:
    ticks of the first and last force and of the last opening, and the number of
    episodes. If a force ends faintly, so that the tick of its end is uncertain,
    `uncertain_ticks` is raised by this uncertainty.
    """
    if logged == Status.PRESS:
        if link.first_force_tick == NONE:
            link.first_force_tick = tick
        link.episodes += link.starts_episode  # 1 if it has been open since the last one
        link.starts_episode = 0
    elif link.logged_status == Status.PRESS:  # the force ends
        link.last_force_tick = tick
        if link.status >= Status.PRESS:  # it has only become faint
            # This happened somewhere in the last piece, which has `fading_ticks`.
            link.uncertain_ticks += link.fading_ticks
    if logged == Status.OPEN:
        # It pressed in this episode, but its force was logged as ended before now.
        ended_faintly = link.logged_status == Status.GRAZE and link.starts_episode == 0
        # A compliant contact without damping presses until it opens.
        presses_to_end = link.law >= Law.SPRING and link.damping == 0
        if ended_faintly and presses_to_end:
            # The end of its force was logged too early by the time since then. This
            # time replaces `fading_ticks`, which were added when the end was logged.
            link.uncertain_ticks += tick - link.last_force_tick - link.fading_ticks
        link.starts_episode = 1
        link.last_opening_tick = tick
    link.logged_status = logged
    change = contact_log[run.contact_event_count]
    change.tick = tick
    change.link = i
    change.status = logged
    change.impulse = 0.0  # `finish_impact` sets both numbers of an impact
    change.mean_closing = 0.0
    run.contact_event_count += 1


def keep_history(state: State, node: Node, link: Link, ticks: int) -> None:
    """Append a piece of a link, of `ticks` from now, to the lines of its history.

    Line `history_line` of the link keeps its force. For a joint or a contact, the next
    line keeps the overlap d. For a contact that yields, a third line keeps the closing
    velocity closing - Y F: it is not the rate of d, which is only the elastic part of
    the overlap. The scratch arrays of the node are overwritten.
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
