"""From the numbers of a row to the records that the kernels of this method work on.

The page has this as JavaScript. In Python a number is an array, with one number for
each member of a family: so nothing here is decided by a number but through `np.where`.
"""

from typing import Any, NamedTuple

import numpy as np

from ..abilities import has_external_drive
from ..clock import Clock
from ..link import FIELDS, Law, initial_gap
from ..record_lists import blank
from ..scales import largest
from ..states import Status
from .records import (
    GROUP_PART,
    LINE,
    LINK,
    MASS,
    NEVER,
    NODE,
    NONE,
    PIECE,
    RUN,
    SMOOTH,
    Part,
)
from .series import POINTS, N

FLOORS_PER_TRANSIT = 128
"""Number of pieces of the least duration, the floor, in the shortest transit time."""
FLOORS_PER_BREAK = 4
"""Number of them between two hard breaks that are given at t = 0, at least."""
MIN_FLOOR = 64
"""Bound of that least duration, ticks: shorter pieces have rounded points."""
PIECES_PER_TRANSIT = 8
"""Number of pieces in the shortest transit time at first, before any error is known."""
MIN_FIRST_PIECE = 16
"""Bound of the duration of that first piece, ticks."""
EVENT_WINDOW = 2.0**-40
"""Time within which events and arrivals are one, over the longest transit time."""
DIFFERENCE_STEP = 1e-7
"""Step of the slopes of a law of the user, over the velocity scale."""
PROOFS_PER_TRANSIT = 8
"""Largest number of proofs in the longest transit time: each reads all waves."""
TRANSITS_AFTER_PROOF = 2
"""Time to go on after a proof, where needed, over that through the longest body."""
GRAZE_VELOCITY = 2.0**-40
"""Velocity, over the velocity scale: a force that makes less counts as none."""
UNHELD_COMPLIANCE = 1e300
"""Compliance of an endless rod, m/N: no force holds its end."""


class RunRequest(NamedTuple):
    """Request of a run."""

    until: Any  # end of the run, s; None: it ends with its proof of finality
    tolerance: Any  # of pieces, relative to the velocity scale
    limit: int  # largest number of steps
    keep: bool  # whether forces, overlaps and velocities of masses are kept


class InitialLine(NamedTuple):
    """What a line holds at t = 0."""

    piece_count: int
    hard_breaks: int  # between its pieces
    ticks: int  # duration of its pieces


# Waves at t = 0, and from outside -----------------------------------------------------


def piece_of(start: Any, stop: Any, values: Any) -> Any:
    """A piece from tick `start` to `stop`, with these first coefficients of its series.

    The others are 0. Its degree is 0 if there is one value, else N. Its break is
    SMOOTH; its `line` is still to be set, and no piece follows it.
    """
    piece = blank(1, PIECE)[0]
    piece.start = start
    piece.end = stop
    piece.break_order = SMOOTH
    piece.next = NONE
    if len(values) > 1:
        piece.degree = N
    else:
        piece.degree = 0
    zeros = [0.0] * (POINTS - len(values))
    piece.coefficients = [*values, *zeros]
    return piece


def initial_waves(velocity: Any, c_strain: Any, T: Any) -> list[Any]:
    """Pieces of both waves in a segment at t = 0: to the right, and to the left, m/s.

    They are the constants a = v - c strain and b = v + c strain. v is the velocity in
    the frame, `c_strain` is c times the strain, m/s, and T the transit time, ticks:
    what is under way now has been sent since -T.
    """
    return [
        piece_of(-T, 0, [velocity - c_strain]),
        piece_of(-T, 0, [velocity + c_strain]),
    ]


def constant_wave(value: Any) -> Any:
    """The piece of a wave from outside that is constant for ever."""
    return piece_of(0, NEVER, [value])


# Records ------------------------------------------------------------------------------


def lay_out(
    row: Any,
    clock: Clock,
    request: RunRequest,
    initial_lines: list[InitialLine],
    outside: Any,
) -> list[list[Any]]:
    """Records of a row at t = 0: lists [run], nodes, links, masses, lines, parts.

    Their fields are numbers, or arrays by member. Lines of the history follow the
    initial ones, if the request keeps them. Without a given end, the run goes on after
    its proof if bodies are joined to others or the history is kept.

    Parameters
    ----------
    row : Row
    clock : Clock
    request : RunRequest
    initial_lines : list of InitialLine
        Two lines a segment, to the right and to the left, then those that come from
        outside.
    outside : list of int
        Lines that come from outside to the left and the right end; NONE at the free end
        of a rod.
    """
    shortest = shortest_transit(clock)
    nodes = make_nodes(row, outside, shortest)
    links = make_links(row, clock, nodes, shortest * clock.tick)
    masses = make_masses(row, clock)
    parts = make_parts(row, nodes, links, outside)
    line_count = len(initial_lines)
    if request.keep:  # lines that keep forces, overlaps and velocities come behind
        line_count = number_history_lines(links, masses, line_count)
    lines = make_lines(clock, initial_lines, line_count)
    run = make_run(row, clock, request, shortest, initial_lines)
    for part in parts:
        is_anchor = part.kind >= Part.WALL
        is_alone = part.part_count == 1
        # Something is joined to this wall or endless rod.
        if is_anchor and not is_alone:
            run.has_bonds = 1
    goes_on_after_proof = run.has_bonds or request.keep
    if request.until is None and goes_on_after_proof:
        longest = longest_body_time(row, clock, shortest)
        run.ticks_after_proof = TRANSITS_AFTER_PROOF * longest
    return [[run], nodes, links, masses, lines, parts]


def shortest_transit(clock: Clock) -> Any:
    """The shortest transit time, or the reference time of a row without rods, ticks."""
    # The reference is the longest transit, or what stands for it without rods.
    shortest = np.rint(clock.reference / clock.tick)
    for transit in clock.transits:
        shortest = np.minimum(shortest, transit)
    return shortest


def longest_body_time(row: Any, clock: Clock, shortest: Any) -> Any:
    """Longest time in which a wave goes through a body once, ticks.

    It is the sum of the transit times of a rod. In a row without rods it is `shortest`.
    """
    if len(clock.transits) > 0:
        times = [0]
    else:
        times = [shortest]
    for first, last in row.spans:  # first and last segment of a body, counted from 1
        # A mass or a wall has the span 1, 0: no segments, and the time 0.
        times.append(sum(clock.transits[first - 1 : last]))
    return largest(times)


def make_run(
    row: Any,
    clock: Clock,
    request: RunRequest,
    shortest: Any,
    initial_lines: list[InitialLine],
) -> Any:
    """The record of a run before its first step: request, clock, tolerances and proof.

    `shortest` is the shortest transit, ticks. The log has the pieces of
    `initial_lines`. The more hard breaks one of these has in a transit, the shorter is
    `min_break_spacing`. A run without a given end ends with its proof.
    """
    run = blank(1, RUN)[0]
    # Mean number of hard breaks in the shortest transit, on the line with the most
    breaks_per_transit: Any = 0
    for line in initial_lines:
        run.piece_count += line.piece_count
        if line.hard_breaks > 0:
            in_transit = np.floor(line.hard_breaks * (shortest / line.ticks))
            breaks_per_transit = np.maximum(breaks_per_transit, in_transit)
    reference = clock.reference / clock.tick  # ticks
    run.tick_duration = clock.tick
    run.velocity_scale = clock.scale
    run.tolerance = request.tolerance * clock.scale
    # `min_break_spacing`, the floor, is the shortest transit over this number.
    floors = FLOORS_PER_TRANSIT + FLOORS_PER_BREAK * breaks_per_transit
    run.min_break_spacing = np.maximum(shortest // floors, MIN_FLOOR)
    run.shortest_transit = shortest
    run.graze_velocity = GRAZE_VELOCITY * clock.scale
    run.event_window = np.maximum(np.rint(reference * EVENT_WINDOW), 1)
    run.end_tick = clock.last_tick
    run.max_steps = request.limit
    if request.keep:
        run.keeps_history = 1
    else:
        run.keeps_history = 0
    run.first_averaged_tick = NONE
    set_proof(run, row, shortest, np.rint(reference))
    if request.until is None:
        run.ticks_after_proof = 0
    else:
        run.ticks_after_proof = NEVER  # a proof does not end a run to a given time
    return run


def set_proof(run: Any, row: Any, shortest: Any, longest: Any) -> None:
    """Set when a run looks for its proof of finality, and `has_bonds`.

    Times are ticks; `shortest` and `longest` are transit times. The first look is after
    `proof_interval`, the least time between two looks. A run with an external drive
    never looks. `has_bonds` is 1 if some contact cannot open.
    """
    run.proved_tick = NONE
    run.last_proof_tick = NONE
    run.proof_interval = np.maximum(shortest, longest // PROOFS_PER_TRANSIT)
    run.next_proof_tick = run.proof_interval
    if has_external_drive(row.system):
        run.next_proof_tick = NEVER
    run.has_bonds = 1
    if all(law.opens for law in row.system.contacts):
        run.has_bonds = 0


def make_nodes(row: Any, outside: Any, shortest: Any) -> list[Any]:
    """Nodes from left to right, one more than there are segments.

    `shortest` is a transit, ticks. Segment k, from 0 on, lies between the nodes k and k
    + 1. Its line 2 k leads to the right, its line 2 k + 1 to the left. `outside` are
    the lines from outside to the left and the right end; NONE makes this a free end. No
    wave goes out at the ends of the row.
    """
    n = len(row.segments)
    nodes = blank(n + 1, NODE)
    for k, node in enumerate(nodes):
        # Each node has a link more than masses.
        node.first_mass = row.first_mass[k]
        node.first_link = k + node.first_mass
        node.link_count = row.first_mass[k + 1] - row.first_mass[k] + 1
        # Lines of the segment k - 1 on the left, and of the segment k on the right; for
        # the ends of the row they are replaced below.
        node.incoming_lines = [2 * (k - 1), 2 * k + 1]
        node.outgoing_lines = [2 * (k - 1) + 1, 2 * k]
        for side in range(2):
            s = k - 1 + side  # segment on this side, if there is one
            if 0 <= s < n:
                node.mobility[side] = 1 / row.segments[s].impedance
        node.next_ticks = np.maximum(shortest // PIECES_PER_TRANSIT, MIN_FIRST_PIECE)
    for side in range(2):
        first_or_last = side * n
        end = nodes[first_or_last]
        end.incoming_lines[side] = outside[side]
        end.outgoing_lines[side] = NONE
        if outside[side] == NONE:
            end.is_free_end = 1
        if row.boundaries[side][0] == "absorbing":
            # An endless rod, which goes on with the last segment, has its impedance.
            inner_side = 1 - side
            end.mobility[side] = end.mobility[inner_side]
    return nodes


def make_links(row: Any, clock: Clock, nodes: list[Any], time: Any) -> list[Any]:
    """Links of all nodes, node by node, as they are at t = 0.

    `time` is the shortest transit, s. Each has its law, status and mobilities; impacts
    have a scale of resting forces, laws of the user the steps of their difference
    quotients.
    """
    links = blank(len(row.links), LINK)
    for node in nodes:
        for q in range(node.link_count):
            i = node.first_link + q
            link = links[i]
            set_law(link, row.links[i], i)
            set_mobility(link, node, q)
            set_effective_mobility(link, node, q, row.masses, time)
            if link.law == Law.IMPACT:
                # The force that makes the velocity scale in the shortest transit
                link.resting_force = clock.scale / link.effective_mobility
            elif link.law == Law.OWN:
                link.overlap_step = DIFFERENCE_STEP * clock.scale * time
                link.rate_step = DIFFERENCE_STEP * clock.scale
    return links


def set_law(link: Any, row_link: Any, i: int) -> None:
    """Set the law, the numbers and the status of link i at t = 0.

    They come from the link of the row; `i` is also the number of its function, if its
    law is one of the user. Nothing has happened to it yet. An impact is open (OPEN),
    also if its bodies touch. Another contact that can open presses (PRESS) without a
    gap, and is open with one. All else is a bond (BOND). The status may be an array by
    member.
    """
    link.left_group = NONE
    link.right_group = NONE
    link.first_force_tick = NONE
    link.last_force_tick = NONE
    link.last_opening_tick = NONE
    link.break_order = SMOOTH
    link.starts_episode = 1
    link.function = i
    link.logged_status = Status.OPEN.value
    for name in FIELDS:  # the law, its numbers and the gap
        setattr(link, name, getattr(row_link, name))
    link.overlap = -initial_gap(row_link)
    if link.law == Law.IMPACT:  # the first step strikes bodies that touch
        link.status = Status.OPEN.value
    elif link.law >= Law.RIGID:  # another contact that can open
        is_open = row_link.gap > 0
        link.status = np.where(is_open, Status.OPEN.value, Status.PRESS.value)
    else:
        link.status = Status.BOND.value


def set_mobility(link: Any, node: Any, q: int) -> None:
    """Set `mobility`, the sum of 1/Z of the rod ends beside link q of a node, s/kg.

    A rod end is only beside the first and the last link of the node.
    """
    left = 0.0
    if q == 0:
        left = node.mobility[0]
    right = 0.0
    if q == node.link_count - 1:
        right = node.mobility[1]
    link.mobility = left + right


def set_effective_mobility(
    link: Any, node: Any, q: int, masses: list[Any], time: Any
) -> None:
    """Set `effective_mobility`, the closing velocity by 1 N in a link in a time, s/kg.

    It is link q of a node, whose `mobility` is set; the time is in s. A rod end takes
    1/Z, a mass m takes time/m. `masses` are those of the row, kg.
    """
    # Link q lies between the masses q - 1 and q of the node, as far as there are any.
    first = max(q - 1, 0)
    stop = q + 1
    if q == node.link_count - 1:
        stop = q
    mobility = link.mobility
    for m in range(first, stop):
        mobility = mobility + time / masses[node.first_mass + m]
    link.effective_mobility = mobility


def make_masses(row: Any, clock: Clock) -> list[Any]:
    """Rigid masses, with their velocities in the frame, m/s, at all points."""
    masses = blank(len(row.masses), MASS)
    for m, mass in enumerate(masses):
        mass.mass = row.masses[m]
        mass.velocity = [row.mass_velocity[m] - clock.frame] * POINTS
    return masses


def number_history_lines(links: list[Any], masses: list[Any], first: int) -> int:
    """Set `history_line` of links and masses; return the number of all lines.

    These lines begin with number `first`, and follow those that are there already. A
    link keeps its force; a joint or a contact also its overlap, which is minus the gap;
    a contact that yields also its closing velocity. A mass keeps its velocity.
    """
    l = first
    for link in links:
        link.history_line = l
        l += 1
        if link.law >= Law.JOINT:  # a joint or a contact: its overlap follows
            l += 1
        if link.law == Law.YIELD:  # its closing velocity follows
            l += 1
    for mass in masses:
        mass.history_line = l
        l += 1
    return l


def make_lines(clock: Clock, initial_lines: list[InitialLine], count: int) -> list[Any]:
    """All lines, `count` of them.

    Those of `initial_lines` come first, the others have no pieces (NONE). Pieces at t =
    0 stand at the beginning of the log, line by line; each line reads its first one,
    and its hard breaks (jumps up to the second derivative) are unread. The lines of a
    segment have its transit time as delay, ticks, others none.
    """
    lines = blank(count, LINE)
    for history_line in lines[len(initial_lines) :]:
        history_line.first_piece = NONE
        history_line.read_piece = NONE
        history_line.last_piece = NONE
    first = 0
    for l, initial in enumerate(initial_lines):
        line = lines[l]
        line.first_piece = first
        line.read_piece = first
        first += initial.piece_count
        line.last_piece = first - 1
        line.unread_breaks = initial.hard_breaks  # none of them has arrived
    # Segment s, from 0 on, has the lines 2 s and 2 s + 1.
    for l in range(2 * len(clock.transits)):
        lines[l].delay = clock.transits[l // 2]
    return lines


def make_parts(row: Any, nodes: list[Any], links: list[Any], outside: Any) -> list[Any]:
    """Parts of all groups of bodies between contacts that open, from left to right.

    Parts are segments, masses, joints, walls and endless rods. Each link that opens
    gets its `left_group` and `right_group`. `outside` are the lines from outside.
    """
    parts: list[Any] = []
    head = 0  # first part of the group, which stands for the group
    # This adds a wall or an endless rod, and nothing at other ends.
    add_ground(parts, head, row.boundaries[0][0], outside[0])
    for k, node in enumerate(nodes):
        for q in range(node.link_count):
            i = node.first_link + q
            link = links[i]
            if link.law >= Law.RIGID:  # it can open: another group begins behind it
                link.left_group = head
                head = len(parts)
                link.right_group = head
            elif link.law == Law.JOINT:
                compliance = joint_compliance(link.stiffness)
                # A joint has no mass, and a mass no compliance.
                add_part(parts, head, Part.JOINT.value, i, 0.0, compliance)
            if q < node.link_count - 1:
                m = node.first_mass + q
                add_part(parts, head, Part.MASS.value, m, row.masses[m], 0.0)
        if k < len(row.segments):
            segment = row.segments[k]
            compliance = segment.transit_time / segment.impedance  # L/(E A)
            add_part(parts, head, Part.SEGMENT.value, k, segment.mass, compliance)
    add_ground(parts, head, row.boundaries[1][0], outside[1])
    return parts


def joint_compliance(stiffness: Any) -> Any:
    """Compliance of a joint, m/N: 1/k; 0 for one without stiffness."""
    is_stiff = stiffness > 0
    divisor = np.where(is_stiff, stiffness, 1.0)
    return np.where(is_stiff, 1 / divisor, 0.0)


def add_part(
    parts: list[Any], head: int, kind: int, index: int, mass: Any, compliance: Any
) -> None:
    """Append a part to `parts`, and count it in its group.

    The group begins with part `head`, which may be the new one.
    """
    part = blank(1, GROUP_PART)[0]
    part.kind = kind
    part.index = index
    part.mass = mass
    part.compliance = compliance
    part.anchor_line = NONE
    parts.append(part)
    parts[head].part_count += 1


def add_ground(parts: list[Any], head: int, kind: str, line: int) -> None:
    """Append what holds an end of the row to the group of part `head`; `line` moves it.

    It is a wall (a boundary of kind "velocity") or an endless rod ("absorbing"), else
    nothing.
    """
    if kind == "velocity":
        add_part(parts, head, Part.WALL.value, NONE, 0.0, 0.0)
        parts[head].anchor_line = line
    elif kind == "absorbing":
        add_part(parts, head, Part.ENDLESS.value, NONE, 0.0, UNHELD_COMPLIANCE)
        parts[head].anchor_line = line
