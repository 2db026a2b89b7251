"""The records that the kernels of this method work on.

Conventions. Compression is positive: a force F > 0 presses two neighbours apart, and
`overlap` > 0 is their overlap; minus the overlap is the gap. `closing` is the velocity
with which a link would close without its own force, `mobility` the sum of 1/Z of the
rod ends that it joins. Times are in ticks, velocities in m/s in the frame of the run,
forces in N.
"""

from collections.abc import MutableSequence, Sequence
from enum import IntEnum
from typing import Annotated, NamedTuple, TypeAlias

from .. import link
from ..record_lists import dtype_of
from .series import POINTS, Matrix

Series: TypeAlias = Annotated[MutableSequence[float], ("f8", (POINTS,))]
"""Values at the points of a piece, or coefficients of a Chebyshev series."""
Tick: TypeAlias = Annotated[int, "i8"]
"""A time in ticks."""
Sides: TypeAlias = Annotated[MutableSequence[float], ("f8", (2,))]
"""Two numbers: for the left and the right side, end, or wave to the right and left."""
SideLines: TypeAlias = Annotated[MutableSequence[int], ("i8", (2,))]
"""Numbers of the lines on the left and on the right."""
SideSeries: TypeAlias = Annotated[Sequence[MutableSequence[float]], ("f8", (2, POINTS))]
"""Values at the points of a piece, for the left and for the right side."""


class PartKind(IntEnum):
    """Kind of a part of a group of bonded bodies.

    The order counts: kinds >= WALL anchor the group, kinds < WALL are its bodies and
    joints.
    """

    SEGMENT = 0
    MASS = 1
    JOINT = 2
    WALL = 3
    ENDLESS = 4  # endless rod


# Order of a break: the lowest derivative that jumps, 0 for the value itself
SMOOTH = 99  # no derivative jumps
MAX_HARD_ORDER = 2  # up to this order a break is hard: it ends a piece
NONE = -1  # no piece, no line, no link, no tick
NEVER = 1 << 61  # tick that is never reached


class Piece:
    """A polynomial in time that a line carries: a row of the log."""

    start: Tick
    end: Tick
    break_order: int  # order of the break at the start
    degree: int  # 0 or N
    line: int  # line that carries it
    next: int  # row of the next piece of the same line; NONE for the last one
    coefficients: Series  # Chebyshev series from the start to the end, m/s or N or m


class Line:
    """A wave that leaves one end of a segment and arrives at the other.

    A signal from outside is a line, too, as is each quantity whose history is kept.
    """

    delay: Tick  # transit time of a segment, otherwise 0
    first_piece: int  # row in the log
    read_piece: int  # row of the piece that arrives now
    last_piece: int  # row of the last piece so far
    unread_breaks: int  # hard breaks that were sent and have not arrived yet


class Node:
    """The chain of links and masses between two rods, or at an end of the row."""

    now: Tick  # time up to which the node is solved
    next_ticks: Tick  # wanted duration of the next piece
    first_link: int  # number of its first link
    link_count: int
    first_mass: int  # number of its first mass; it has `link_count` - 1 masses
    is_free_end: int  # 1: free end of a rod, which reflects waves as they are
    # 1: hard breaks are too dense to end a piece at each one; the node takes means
    is_averaging: int
    halved_until: Tick  # end of the last piece that a run for comparison has halved
    incoming_lines: SideLines
    outgoing_lines: SideLines  # NONE at an end of the row
    mobility: Sides  # 1/Z of the rods, s/kg; 0 where there is none

    # Values at the points of the piece that is being solved
    incoming: SideSeries  # waves that arrive, m/s, or forces from outside, N
    outgoing: Series  # wave that leaves on one side, m/s
    scratch_values: Series  # derivatives, or values of a guard
    scratch_series: Series  # coefficients


class Link(link.Link):
    """A bond, a joint, a contact, or the push on an end, in the chain of a node."""

    status: int  # `Status`
    break_order: int  # order of the break of its force at its last event
    function: int  # number of the law of the user
    overlap_step: float  # step of the difference quotient of that law by the overlap, m
    rate_step: float  # step of its difference quotient by the rate of the overlap, m/s
    resting_force: float  # scale of the force of an impact contact at rest, N
    mobility: float  # sum of 1/Z of the rod ends beside it, s/kg
    next_knot: int  # number of the next knot in the table of a yielding contact

    # State at the end of the last piece
    overlap: float  # d, m
    overlap_rate: float  # d', m/s
    overlap_acceleration: float  # d'', m/s^2
    # Closing velocity that 1 N makes within the shortest transit, s/kg (constant)
    effective_mobility: float
    closing_after: float  # largest closing velocity that is allowed after an impact
    history_line: int  # line of its force; the lines of overlap and closing follow it
    left_group: int  # first part of the group on the left; NONE if the link cannot open
    right_group: int  # first part of the group on the right
    logged_status: int  # `Status` that was logged last: OPEN, GRAZE or PRESS
    unknown_index: int  # number of its force among the unknown ones; NONE if known

    # Totals
    impulse: float  # N s
    peak_force: float  # N
    peak_force_bound: float  # peak force plus its error, N
    first_force_tick: Tick  # NONE before the first force
    last_force_tick: Tick  # end of the last force; NONE before
    last_opening_tick: Tick  # NONE before
    starts_episode: int  # 1: the next force begins another episode
    force_ticks: Tick  # total time with force
    # Time for which a closed compliant contact has had only a faint force; NONE if this
    # is so long that the force is round-off
    faint_ticks: Tick
    fading_ticks: Tick  # duration of its last piece with force, if it ended faintly
    uncertain_ticks: Tick  # uncertainty of the ends of forces that become faint, summed
    episodes: int
    event_error: float  # largest error of the time of an event within its piece, s
    # Largest change of the time of an event if velocities are wrong by their scale, s
    event_lag: float

    # Values at the points of the piece that is being solved, and the tangent law
    # F = base + by_overlap d + by_closing c
    overlaps: Series  # d, m
    closing: Series  # c, closing velocity without its own force, m/s
    force: Series  # F, N
    by_overlap: Series  # dF/dd, N/m
    by_closing: Series  # dF/dc, N s/m
    base: Series  # N


class Mass:
    """A rigid mass between two links of a node."""

    mass: float  # kg
    velocity: Series  # at the points of the piece, m/s; value 0 is the present velocity
    history_line: int  # line that keeps its velocity


class ContactEvent:
    """A row of the log of contacts: a change of status, or an impact."""

    tick: Tick
    link: int  # number of the link
    status: int  # `Status` from then on: OPEN, GRAZE or PRESS
    impulse: float  # impulse of an impact, N s; 0 for other changes
    mean_closing: float  # mean closing velocity of an impact, m/s; 0 for other changes


class GroupPart:
    """A part of a group of bonded bodies, between two contacts that can open."""

    kind: int  # `PartKind`
    index: int  # number of the segment, mass or joint (a link); NONE for anchors
    part_count: int  # number of parts of the group, at its first part; 0 at the others
    # At the first part: line of the wall or endless rod that anchors the group, or NONE
    anchor_line: int
    mass: float  # kg
    compliance: float  # change of length by a force, m/N
    mean_velocity: float  # m/s
    vibration_energy: float  # energy about the velocity of the group, J
    wave_integrals: Sides  # integrals of both waves of a segment, over y, m/s
    wave_moments: Sides  # integrals of both waves times y, over y, m/s

    # Motion of the group, at its first part
    initial_velocity: float  # velocity of the centre of mass at t = 0, m/s
    group_velocity: float  # velocity of the centre of mass now, m/s
    reference_velocity: float  # `group_velocity`, or the velocity of the anchor, m/s
    min_wave: float  # lower bound of the waves in the group, m/s
    max_wave: float  # upper bound of these waves, m/s
    ends_follow_waves: int  # 1: the velocities of its ends are within these bounds
    reference_energy: float  # energy about `reference_velocity`, J
    end_deviations: Sides  # displacement of the ends from the reference motion, m
    compliance_integrals: Sides  # bound of (end deviation)^2/(2 energy), m/N


class Run:
    """Settings of a run, and its progress."""

    tick_duration: float  # s
    velocity_scale: float  # m/s
    tolerance: float  # largest truncation error of a piece, m/s
    # Duration of averaging pieces; more than two hard breaks in it are too dense
    min_break_spacing: Tick
    event_window: Tick  # a contact that closes so close to an arrival closes with it
    shortest_transit: Tick
    end_tick: Tick
    max_steps: int
    keeps_history: int  # 1: forces, overlaps and velocities of masses are kept
    halves_pieces: int  # 1: a run for comparison, see `march.piece_end`
    proved_tick: Tick  # tick of the proof of finality, NONE before
    has_bonds: int  # 1: bodies are joined to others, a wall or an endless rod
    last_check_tick: Tick  # tick of the last check of finality, NONE before
    next_proof_tick: Tick  # tick of the next check; NEVER if no proof is wanted
    proof_interval: Tick  # least time between two checks
    ticks_after_proof: Tick  # time to go on after the proof; NEVER: to `end_tick`

    # Progress
    piece_count: int  # used rows of the log of pieces
    contact_event_count: int  # used rows of the log of contacts
    steps: int
    averaged_steps: int  # steps of averaging nodes
    first_averaged_tick: Tick  # start of the first of these steps, NONE before
    max_truncation_error: float  # largest truncation error that was accepted, m/s
    shared_error: float  # largest error of a piece that no tolerance limits, m/s
    resting_impacts: int  # number of impacts after which bodies rest on each other
    resting_velocity: float  # largest opening velocity that was set to 0, m/s
    stop_reason: int  # `Stop`
    graze_velocity: float  # a force that makes less velocity does not count, m/s


Nodes: TypeAlias = Sequence[Node]
Links: TypeAlias = Sequence[Link]
Masses: TypeAlias = Sequence[Mass]
Lines: TypeAlias = Sequence[Line]
Parts: TypeAlias = Sequence[GroupPart]
Log: TypeAlias = Sequence[Piece]
ContactLog: TypeAlias = Sequence[ContactEvent]


class State(NamedTuple):
    """All records that the kernels read and change."""

    runs: Sequence[Run]  # one Run; a sequence, since machine code changes arrays only
    nodes: Nodes  # from left to right
    links: Links  # node by node
    masses: Masses  # node by node
    lines: Lines  # two for each segment, lines from outside, lines of the history
    parts: Parts  # group by group
    log: Log  # pieces of all lines
    contact_log: ContactLog
    matrix: Matrix  # scratch: equations of a Newton iteration


PIECE = dtype_of(Piece)
LINE = dtype_of(Line)
NODE = dtype_of(Node)
LINK = dtype_of(Link)
MASS = dtype_of(Mass)
CONTACT_EVENT = dtype_of(ContactEvent)
GROUP_PART = dtype_of(GroupPart)
RUN = dtype_of(Run)
