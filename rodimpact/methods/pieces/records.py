"""The records that the kernels of this method work on.

Conventions. Compression is positive: F > 0 presses two neighbours apart, `overlap` > 0
is their overlap (below 0: the gap), `closing` the rate at which a link would close
without its own force, `mobility` the sum of 1/Z of the rod ends that it joins. Times
are ticks, velocities m/s in the frame of the run, forces N.
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
"""A number for the left and one for the right side, end or wave."""
SideLines: TypeAlias = Annotated[MutableSequence[int], ("i8", (2,))]
"""Numbers of the lines on the left and on the right."""
SideSeries: TypeAlias = Annotated[Sequence[MutableSequence[float]], ("f8", (2, POINTS))]
"""Values at the points of a piece, for the left and for the right side."""


class Part(IntEnum):
    """What a group of bonded bodies is made of.

    The order counts: >= WALL anchors the group, < WALL is part of its bodies.
    """

    SEGMENT = 0
    MASS = 1
    JOINT = 2
    WALL = 3
    ENDLESS = 4


SMOOTH = 99  # order of a break where no derivative jumps
MAX_HARD_ORDER = 2  # a break ends a piece if a derivative up to this one jumps
NONE = -1  # no piece, no line, no link, no tick
NEVER = 1 << 61  # tick that is never reached


class Piece:
    """A polynomial in time that a line carries: a row of the log."""

    start: Tick
    end: Tick
    break_order: int  # lowest derivative that jumps at the start; SMOOTH if none does
    degree: int  # 0 or N
    line: int  # line that carries it
    next: int  # row of the next piece of the same line, NONE at the last one
    coefficients: Series  # Chebyshev series from the start to the end, m/s or N or m


class Line:
    """What leaves one end of a segment and arrives at the other.

    What comes from outside is a line, too.
    """

    delay: Tick  # transit time
    first_piece: int  # row in the log
    read_piece: int  # row of the piece that arrives now
    last_piece: int  # row of the last piece so far
    unread_breaks: int  # hard breaks that were sent and have not arrived


class Node:
    """The chain of links and masses between two rods.

    It is solved up to its own time `now`.
    """

    now: Tick
    next_ticks: Tick  # wanted duration of the next piece
    first_link: int
    link_count: int
    first_mass: int  # there is one mass less than there are links
    is_free_end: int  # 1: it reflects waves as they are
    is_averaging: int  # 1: hard breaks come too densely to be followed one by one
    halved_until: Tick  # end of the last stretch that a comparison takes in halves
    incoming_lines: SideLines
    outgoing_lines: SideLines
    mobility: Sides  # 1/Z of the rods, s/kg; 0 where there is none

    # Over the piece that is being solved, at its points
    incoming: SideSeries  # waves that arrive, m/s
    outgoing: Series  # a wave that leaves, m/s
    scratch_values: Series  # derivatives, or values of an event function
    scratch_series: Series  # coefficients


class Link(link.Link):
    """What acts between two neighbours of a chain: a bond, a joint, or a contact."""

    status: int  # `Status`
    break_order: int  # order of the break that its last event makes
    function: int  # number of the law of the user
    overlap_step: float  # step of the difference quotient of that law by the overlap, m
    rate_step: float  # the same by the rate of the overlap, m/s
    resting_force: float  # scale of forces between bodies that rest, N
    mobility: float  # sum of 1/Z of the rod ends beside it, s/kg
    # Number of the next force at which a yielding contact changes its hardening
    next_knot: int

    # State at the end of the last piece
    overlap: float  # d, m
    overlap_rate: float  # d', m/s
    overlap_acceleration: float  # d'', m/s^2
    effective_mobility: float  # velocity by 1 N in the shortest transit, s/kg
    closing_after: float  # closing velocity that an impact leaves, m/s
    history_line: int  # line of its force; those of its overlap and its closing follow
    left_group: int  # first part of the group on the left; NONE if the link cannot open
    right_group: int  # first part of the group on the right
    logged_status: int  # `Status` that was logged last: OPEN, GRAZE or PRESS
    unknown_index: int  # place of its force among the unknown ones, or NONE

    # Totals
    impulse: float  # N s
    peak_force: float  # N
    peak_force_bound: float  # largest that the errors of the pieces allow, N
    first_force_tick: Tick  # NONE before the first force
    last_force_tick: Tick  # end of the last force
    last_opening_tick: Tick
    starts_episode: int  # 1: the next force begins another episode
    force_ticks: Tick  # total time with force
    # Time since it closed, without a force that counts; NONE if this has lasted for so
    # long that its force is round-off
    faint_ticks: Tick
    fading_ticks: Tick  # its last piece with force, if its end is faint
    cut_ticks: Tick  # time in which a force became faint, or acted and counts as none
    episodes: int
    event_error: float  # largest error of the time of an event in its piece, s
    event_lag: float  # largest change of such a time by velocities of the scale, s

    # Over the piece that is being solved,
    # at its points: F = base + by_overlap d + by_closing c
    overlaps: Series  # d, m
    closing: Series  # c, closing velocity without its own force, m/s
    force: Series  # F, N
    by_overlap: Series  # dF/dd, N/m
    by_closing: Series  # dF/dc, N s/m
    base: Series  # N


class Mass:
    """A rigid mass between two links of a node."""

    mass: float  # kg
    velocity: Series  # over the piece, m/s; its first value is the state
    history_line: int  # line that keeps its velocity


class ContactEvent:
    """A row of the log of contacts.

    One is touched, presses or opens, or bodies strike.
    """

    tick: Tick
    link: int
    status: int  # `Status`: OPEN, GRAZE or PRESS
    impulse: float  # impulse of an impact, N s; 0 for other contacts
    mean_closing: float  # mean closing velocity of an impact, m/s; 0 for others


class GroupPart:
    """A part of a group of bonded bodies.

    The group is between two contacts that can open.
    """

    kind: int  # `Part`
    index: int  # number of the segment, mass or link
    part_count: int  # parts of the group, at its first one; 0 at the others
    anchor_line: int  # line of the wall, or of the endless rod, that anchors the group
    mass: float  # kg
    compliance: float  # change of length by a force, m/N
    mean_velocity: float  # m/s
    vibration_energy: float  # energy about the velocity of the group, J
    wave_integrals: Sides  # of both waves of a segment over y from -1 to 1, m/s
    wave_moments: Sides  # of both waves times y, m/s

    # Motion of the group, at its first part
    initial_velocity: float  # velocity of the centre of mass at t = 0, m/s
    group_velocity: float  # velocity of the centre of mass now, m/s
    reference_velocity: float  # `group_velocity`, or the velocity of the anchor, m/s
    min_wave: float  # bounds of the waves under way, m/s
    max_wave: float
    ends_follow_waves: int  # 1: its ends move with no velocities but those of the waves
    reference_energy: float  # energy about `reference_velocity`, J
    end_deviations: Sides  # displacement of the ends from the reference motion, m
    compliance_integrals: Sides  # bound of (end deviation)^2/(2 energy), m/N


class Run:
    """What a run is asked for, and what it has come to."""

    tick_duration: float  # s
    velocity_scale: float  # m/s
    tolerance: float  # largest truncation error of a piece, m/s
    min_break_spacing: Tick  # duration of pieces where hard breaks come too densely
    event_window: Tick  # an event so close to an arrival is taken with it
    shortest_transit: Tick
    end_tick: Tick
    max_steps: int
    keeps_history: int  # 1: forces, overlaps and velocities of masses are kept
    halves_pieces: int  # 1: a comparison, which halves the pieces that breaks limit
    proved_tick: Tick  # instant of the proof of finality, NONE before
    has_bonds: int  # 1: bodies are joined to others, a wall or an endless rod
    last_proof_tick: Tick  # NONE before the first attempt of a proof
    next_proof_tick: Tick  # NEVER where nothing is to be proved
    proof_interval: Tick  # least time between two attempts
    ticks_after_proof: Tick  # time to go on after the proof

    # Progress
    piece_count: int  # rows of the log of pieces
    contact_event_count: int  # rows of the log of contacts
    steps: int
    averaged_steps: int  # steps in which breaks were too dense
    first_averaged_tick: Tick  # start of the first of them, NONE before
    max_truncation_error: float  # largest one that was accepted, m/s
    shared_error: float  # largest error of a piece that no tolerance limits, m/s
    resting_impacts: int  # impacts after which bodies rest on each other
    resting_velocity: float  # largest velocity of parting that counts as rest, m/s
    stop_reason: int  # `Stop`
    graze_velocity: float  # smallest velocity that a force must make, m/s


Nodes: TypeAlias = Sequence[Node]
Links: TypeAlias = Sequence[Link]
Masses: TypeAlias = Sequence[Mass]
Lines: TypeAlias = Sequence[Line]
Parts: TypeAlias = Sequence[GroupPart]
Log: TypeAlias = Sequence[Piece]
ContactLog: TypeAlias = Sequence[ContactEvent]


class State(NamedTuple):
    """All that the kernels read and change."""

    runs: Sequence[Run]  # one Run; a sequence, since machine code changes arrays only
    nodes: Nodes  # from left to right
    links: Links  # node by node
    masses: Masses
    lines: Lines  # two a segment, those from outside, then those that keep the history
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
