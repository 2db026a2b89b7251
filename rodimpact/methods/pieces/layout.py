"""From the numbers of a row to the records that the kernels of this method work on.

The web page has these functions as JavaScript. In Python a number may be an array with
one entry for each member of a family: so no `if` depends on such a number here, but
`np.where` is used.
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
    PartKind,
)
from .series import POINTS, N

SPACINGS_PER_TRANSIT = 128
"""Number of `min_break_spacing` in the shortest transit time, without breaks at t = 0.
"""
SPACINGS_PER_BREAK = 4
"""Number of further `min_break_spacing` for each hard break at t = 0 in this time."""
MIN_BREAK_SPACING = 64
"""Smallest `min_break_spacing`, ticks: the points of shorter pieces are rounded."""
PIECES_PER_TRANSIT = 8
"""Number of pieces in the shortest transit time at first, before any error is known."""
MIN_FIRST_PIECE = 16
"""Smallest duration of this first piece, ticks."""
EVENT_WINDOW = 2.0**-40
"""Time within which an event and an arrival coincide, over the longest transit time."""
DIFFERENCE_STEP = 1e-7
"""Step of difference quotients of a law of the user, over the velocity scale."""
PROOFS_PER_TRANSIT = 8
"""Largest number of checks of finality in the longest transit time.

Each check reads all waves.
"""
TRANSITS_AFTER_PROOF = 2
"""Time for which a run goes on after a proof, in transits of the longest body."""
GRAZE_VELOCITY = 2.0**-40
"""Velocity that a force must make to count, over the velocity scale."""
UNHELD_COMPLIANCE = 1e300
"""Compliance of an endless rod, m/N: no force restores its end."""


class RunRequest(NamedTuple):
    """What a run is to do."""

    until: Any  # end of the run, s; None: it ends with its proof of finality
    tolerance: Any  # truncation error of pieces, relative to the velocity scale
    max_steps: int  # largest number of steps
    keeps_history: bool  # whether histories of forces, overlaps and velocities are kept


class InitialLine(NamedTuple):
    """Numbers of the pieces of a line at t = 0."""

    piece_count: int
    hard_breaks: int  # number of hard breaks between these pieces
    ticks: int  # duration of all pieces


# Waves at t = 0, and from outside -----------------------------------------------------


def piece_of(start: Any, stop: Any, values: Any) -> Any:
    """A piece from tick `start` to tick `stop`.

    `values` are the first coefficients of its Chebyshev series; the others are 0. Its
    degree is 0 if there is only one value, otherwise N. The order of its break is
    SMOOTH, `next` is NONE, and `line` is 0, to be set by the caller.
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
    """Pieces of the two waves in a segment at t = 0: to the right, and to the left.

    They are the constants a = v - c strain and b = v + c strain, m/s. `velocity` is v
    in the frame, m/s, and `c_strain` is c times the strain, m/s. The pieces last from
    -T to 0, with the transit time T, ticks: the waves in the segment at t = 0 have been
    sent in this time.
    """
    return [
        piece_of(-T, 0, [velocity - c_strain]),
        piece_of(-T, 0, [velocity + c_strain]),
    ]


def constant_wave(value: Any) -> Any:
    """The piece of a signal from outside that has this value for ever."""
    return piece_of(0, NEVER, [value])


# Records ------------------------------------------------------------------------------


def lay_out(
    row: Any,
    clock: Clock,
    request: RunRequest,
    initial_lines: list[InitialLine],
    outside: Any,
) -> list[list[Any]]:
    """Records of a row at t = 0: lists of runs, nodes, links, masses, lines and parts.

    There is one run. Fields of records are numbers, or arrays by member. If the request
    keeps the history, its lines follow the initial lines. If the request gives no end
    (`until`), the run goes on for a while after its proof if bodies are bonded, or the
    history is kept; otherwise it stops at the proof.

    Parameters
    ----------
    row : Row
    clock : Clock
    request : RunRequest
    initial_lines : list of InitialLine
        Two lines for each segment, to the right and to the left, then the lines from
        outside.
    outside : list of int
        Numbers of the lines from outside to the left end and to the right end; NONE at
        the free end of a rod.
    """
    shortest = shortest_transit(clock)
    nodes = make_nodes(row, outside, shortest)
    links = make_links(row, clock, nodes, shortest * clock.tick)
    masses = make_masses(row, clock)
    parts = make_parts(row, nodes, links, outside)
    line_count = len(initial_lines)
    if request.keeps_history:
        line_count = number_history_lines(links, masses, line_count)
    lines = make_lines(clock, initial_lines, line_count)
    run = make_run(row, clock, request, shortest, initial_lines)
    for part in parts:
        is_anchor = part.kind >= PartKind.WALL
        is_alone = part.part_count == 1
        if is_anchor and not is_alone:  # a body is bonded to the wall or endless rod
            run.has_bonds = 1
    goes_on_after_proof = run.has_bonds or request.keeps_history
    if request.until is None and goes_on_after_proof:
        longest = longest_body_time(row, clock, shortest)
        run.ticks_after_proof = TRANSITS_AFTER_PROOF * longest
    return [[run], nodes, links, masses, lines, parts]


def shortest_transit(clock: Clock) -> Any:
    """Shortest transit time of a segment, ticks; without rods, the reference time."""
    # The reference time is the longest transit time, or replaces it without rods.
    shortest = np.rint(clock.reference / clock.tick)
    for transit in clock.transits:
        shortest = np.minimum(shortest, transit)
    return shortest


def longest_body_time(row: Any, clock: Clock, shortest: Any) -> Any:
    """Longest time in which a wave travels through a body once, ticks.

    The time of a rod is the sum of the transit times of its segments. In a row without
    rods the result is `shortest`.
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
    """The record of a run before its first step.

    It has the settings of the request, the clock, tolerances, the state of the proof,
    and the number of the pieces of all `initial_lines`. The more hard breaks one of
    these lines has in the shortest transit, `shortest`, ticks, the shorter is
    `min_break_spacing`. `ticks_after_proof` is 0 if the request gives no end, otherwise
    NEVER.
    """
    run = blank(1, RUN)[0]
    # Mean number of hard breaks in the shortest transit, on the line with the most
    breaks_per_transit: Any = 0
    for line in initial_lines:
        run.piece_count += line.piece_count
        if line.hard_breaks > 0:
            # The breaks count as evenly spread over the ticks of the line.
            in_transit = np.floor(line.hard_breaks * (shortest / line.ticks))
            breaks_per_transit = np.maximum(breaks_per_transit, in_transit)
    # The longest transit time, or its replacement in a row without rods, ticks
    reference = clock.reference / clock.tick
    run.tick_duration = clock.tick
    run.velocity_scale = clock.scale
    run.tolerance = request.tolerance * clock.scale
    # Number of `min_break_spacing` in the shortest transit
    spacings = SPACINGS_PER_TRANSIT + SPACINGS_PER_BREAK * breaks_per_transit
    run.min_break_spacing = np.maximum(shortest // spacings, MIN_BREAK_SPACING)
    run.shortest_transit = shortest
    run.graze_velocity = GRAZE_VELOCITY * clock.scale
    # EVENT_WINDOW is a fraction of the reference time; 1 tick is the least window.
    run.event_window = np.maximum(np.rint(reference * EVENT_WINDOW), 1)
    run.end_tick = clock.last_tick
    run.max_steps = request.max_steps
    if request.keeps_history:
        run.keeps_history = 1
    else:
        run.keeps_history = 0
    run.first_averaged_tick = NONE
    set_proof(run, row, shortest, np.rint(reference))
    if request.until is None:
        run.ticks_after_proof = 0
    else:
        run.ticks_after_proof = NEVER  # a proof does not end a run to a given end
    return run


def set_proof(run: Any, row: Any, shortest: Any, longest: Any) -> None:
    """Set the fields of a run for its proof of finality, and `has_bonds`.

    `shortest` and `longest` are transit times, ticks. The first proof is tried after
    `proof_interval`, which is the least time between two tries. A run with an external
    drive never tries one. `has_bonds` is 1 if some contact of the row cannot open.
    """
    run.proved_tick = NONE
    run.last_check_tick = NONE
    run.proof_interval = np.maximum(shortest, longest // PROOFS_PER_TRANSIT)
    run.next_proof_tick = run.proof_interval
    if has_external_drive(row.system):
        run.next_proof_tick = NEVER
    run.has_bonds = 1
    if all(law.opens for law in row.system.contacts):
        run.has_bonds = 0


def make_nodes(row: Any, outside: Any, shortest: Any) -> list[Any]:
    """Nodes from left to right, one more than there are segments.

    Segment k, from 0 on, lies between nodes k and k + 1. Its line 2 k leads to the
    right, its line 2 k + 1 to the left. `shortest` is the shortest transit, ticks.
    `outside` are the numbers of the lines from outside to the left and the right end;
    NONE makes the end free. No wave goes out at the ends of the row.
    """
    n = len(row.segments)
    nodes = blank(n + 1, NODE)
    for k, node in enumerate(nodes):
        # Each node has one link more than it has masses.
        node.first_mass = row.first_mass[k]
        node.first_link = k + node.first_mass
        mass_count = row.first_mass[k + 1] - row.first_mass[k]
        node.link_count = mass_count + 1
        # Lines of segment k - 1 on the left, and of segment k on the right. At the ends
        # of the row they are replaced below.
        node.incoming_lines = [2 * (k - 1), 2 * k + 1]
        node.outgoing_lines = [2 * (k - 1) + 1, 2 * k]
        for side in range(2):
            s = k - 1 + side  # segment on this side; outside 0 to n - 1: none
            if 0 <= s < n:
                node.mobility[side] = 1 / row.segments[s].impedance
        node.next_ticks = np.maximum(shortest // PIECES_PER_TRANSIT, MIN_FIRST_PIECE)
    for side in range(2):
        end = nodes[side * n]  # the first node or the last one
        end.incoming_lines[side] = outside[side]
        end.outgoing_lines[side] = NONE
        if outside[side] == NONE:
            end.is_free_end = 1
        if row.boundaries[side][0] == "absorbing":
            # An endless rod continues the outermost segment, with the same impedance.
            inner_side = 1 - side
            end.mobility[side] = end.mobility[inner_side]
    return nodes


def make_links(row: Any, clock: Clock, nodes: list[Any], time: Any) -> list[Any]:
    """Links of all nodes, node by node, as they are at t = 0.

    Each has its law, status and mobilities. Impact contacts also have the scale of
    their resting force, laws of the user the steps of their difference quotients.
    `time` is the shortest transit, s.
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
                # The force that makes the velocity scale within the shortest transit
                link.resting_force = clock.scale / link.effective_mobility
            elif link.law == Law.OWN:
                link.overlap_step = DIFFERENCE_STEP * clock.scale * time
                link.rate_step = DIFFERENCE_STEP * clock.scale
    return links


def set_law(link: Any, row_link: Any, i: int) -> None:
    """Set the law, the numbers and the status of link i at t = 0.

    Law and numbers are copied from `row_link`, the link of the row. `i` is also the
    number of its function if the law is one of the user. Times and totals are set as
    before any force. An impact contact is open (OPEN), even if its bodies touch. Any
    other contact that can open is open if it has a gap, and presses (PRESS) otherwise.
    Every other link has the status BOND. The status may be an array by member.
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
    if link.law == Law.IMPACT:  # bodies that touch strike in the first step
        link.status = Status.OPEN.value
    elif link.law >= Law.RIGID:  # another contact that can open
        is_open = row_link.gap > 0
        link.status = np.where(is_open, Status.OPEN.value, Status.PRESS.value)
    else:
        link.status = Status.BOND.value


def set_mobility(link: Any, node: Any, q: int) -> None:
    """Set `mobility` of link q of a node: the sum of 1/Z of rod ends beside it, s/kg.

    Only the first and the last link of a node have a rod end beside them. The mobility
    of a side of the node is 0 if no rod begins there.
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
    """Set `effective_mobility` of link q of a node, s/kg.

    It is the closing velocity that a force of 1 N in the link makes within `time`, s: a
    rod end beside the link adds 1/Z (its `mobility` must be set before), a mass m adds
    time/m. `masses` are the masses of the row, kg.
    """
    # Link q lies between the masses q - 1 and q of the node. There is no mass on the
    # left of the first link, and none on the right of the last link.
    first = max(q - 1, 0)
    stop = q + 1
    if q == node.link_count - 1:
        stop = q
    mobility = link.mobility
    for m in range(first, stop):
        mobility = mobility + time / masses[node.first_mass + m]
    link.effective_mobility = mobility


def make_masses(row: Any, clock: Clock) -> list[Any]:
    """Rigid masses of a row, with their velocities in the frame at t = 0, m/s.

    A velocity is set at all points of a piece.
    """
    masses = blank(len(row.masses), MASS)
    for m, mass in enumerate(masses):
        mass.mass = row.masses[m]
        mass.velocity = [row.mass_velocity[m] - clock.frame] * POINTS
    return masses


def number_history_lines(links: list[Any], masses: list[Any], first: int) -> int:
    """Set `history_line` of links and masses; return the new number of lines.

    There are `first` lines already; the lines of the history are numbered from `first`
    on. A link has a line for its force; a joint or a contact has another one for its
    overlap, and a contact that yields a third one for its closing velocity. A mass has
    a line for its velocity.
    """
    line = first
    for link in links:
        link.history_line = line  # force
        line += 1
        if link.law >= Law.JOINT:  # a joint or a contact: overlap
            line += 1
        if link.law == Law.YIELD:  # closing velocity
            line += 1
    for mass in masses:
        mass.history_line = line
        line += 1
    return line


def make_lines(clock: Clock, initial_lines: list[InitialLine], count: int) -> list[Any]:
    """Records of all `count` lines at t = 0.

    The lines of `initial_lines` come first. Their pieces are the first rows of the log,
    line by line. The read piece of a line is its first piece, and all its hard breaks
    are unread. The other lines, of the history, have no pieces (NONE). The delay of the
    two lines of a segment is its transit time, ticks; that of other lines is 0.
    """
    lines = blank(count, LINE)
    for history_line in lines[len(initial_lines) :]:
        history_line.first_piece = NONE
        history_line.read_piece = NONE
        history_line.last_piece = NONE
    row_of_log = 0
    for l, initial in enumerate(initial_lines):
        line = lines[l]
        line.first_piece = row_of_log
        line.read_piece = row_of_log
        row_of_log += initial.piece_count
        line.last_piece = row_of_log - 1
        line.unread_breaks = initial.hard_breaks  # none of them has arrived
    # Segment s, from 0 on, has the lines 2 s and 2 s + 1.
    for l in range(2 * len(clock.transits)):
        lines[l].delay = clock.transits[l // 2]
    return lines


def make_parts(row: Any, nodes: list[Any], links: list[Any], outside: Any) -> list[Any]:
    """Parts of all groups of bodies between contacts that can open, from left to right.

    Parts are segments, masses, joints, walls and endless rods. Each link that can open
    gets its `left_group` and `right_group`. `outside` are the lines from outside to the
    left and right end.
    """
    parts: list[Any] = []
    head = 0  # number of the first part of the present group
    # This adds a wall or an endless rod; other ends add nothing.
    add_ground(parts, head, row.boundaries[0][0], outside[0])
    for k, node in enumerate(nodes):
        for q in range(node.link_count):
            i = node.first_link + q
            link = links[i]
            if link.law >= Law.RIGID:  # it can open: the next group begins
                link.left_group = head
                head = len(parts)
                link.right_group = head
            elif link.law == Law.JOINT:
                compliance = joint_compliance(link.stiffness)
                no_mass = 0.0
                add_part(parts, head, PartKind.JOINT.value, i, no_mass, compliance)
            if q < node.link_count - 1:  # a mass follows the link
                m = node.first_mass + q
                rigid = 0.0  # compliance
                add_part(parts, head, PartKind.MASS.value, m, row.masses[m], rigid)
        if k < len(row.segments):
            segment = row.segments[k]
            compliance = segment.transit_time / segment.impedance  # L/(E A)
            add_part(parts, head, PartKind.SEGMENT.value, k, segment.mass, compliance)
    add_ground(parts, head, row.boundaries[1][0], outside[1])
    return parts


def joint_compliance(stiffness: Any) -> Any:
    """Compliance of a joint, m/N: 1/stiffness, or 0 for a dashpot without a spring."""
    has_spring = stiffness > 0
    divisor = np.where(has_spring, stiffness, 1.0)  # never 0
    return np.where(has_spring, 1 / divisor, 0.0)


def add_part(
    parts: list[Any], head: int, kind: int, index: int, mass: Any, compliance: Any
) -> None:
    """Append a part to `parts`, and count it in its group.

    The group begins with part `head`, which may be the new part. The part has the kind
    `kind` (a `PartKind`), the number `index` among parts of its kind, a mass, kg, and a
    compliance, m/N.
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
    """Append the wall or endless rod at an end of the row to the group of part `head`.

    `kind` is the kind of the boundary: "velocity" for a wall, "absorbing" for an
    endless rod; nothing is added for other kinds. `line`, the line from outside,
    becomes the `anchor_line` of the group.
    """
    no_mass = 0.0
    rigid = 0.0  # compliance
    if kind == "velocity":
        add_part(parts, head, PartKind.WALL.value, NONE, no_mass, rigid)
        parts[head].anchor_line = line
    elif kind == "absorbing":
        add_part(parts, head, PartKind.ENDLESS.value, NONE, no_mass, UNHELD_COMPLIANCE)
        parts[head].anchor_line = line
