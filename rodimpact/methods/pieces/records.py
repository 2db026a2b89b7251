"""The records that the kernels of this method work on.

Conventions. Compression is positive: F > 0 presses two neighbours apart, `overlap` > 0 is their
overlap (below 0: the gap), `closing` the rate at which a link would close without its own force,
`mobility` the sum of 1/Z of the rod ends that it joins. Times are ticks, velocities m/s in the
frame of the run, forces N.
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
    """What a group of bonded bodies is made of."""

    SEGMENT = 0
    MASS = 1
    JOINT = 2
    WALL = 3  # from here on what holds the group
    ENDLESS = 4


SMOOTH = 99  # order of a break where no derivative jumps
HARD = 2  # order up to which a break ends a piece: that of the derivative that jumps
NONE = -1  # no piece, no line, no link, no tick
NEVER = 1 << 61  # tick that is never reached


class Piece:
    """A polynomial in time that a line carries: a row of the log."""

    start: Tick
    stop: Tick
    order: int  # lowest derivative that jumps at the start; SMOOTH if none does
    degree: int  # 0 or N
    line: int  # its line
    after: int  # next piece of the same line in the log, NONE behind the last one
    coefficient: Series  # Chebyshev series from the start to the stop, m/s or N or m


class Line:
    """What leaves one end of a segment and arrives at the other, or what comes from outside."""

    delay: Tick  # transit time
    first: int  # first piece in the log
    head: int  # piece that arrives now
    tail: int  # last piece so far
    hard: int  # hard breaks that were sent and have not arrived


class Node:
    """The chain of links and masses between two rods, solved up to its own time `now`."""

    now: Tick  # all before is solved
    length: Tick  # wanted duration of the next piece
    first: int  # its first link
    links: int  # number of its links
    mass: int  # its first mass
    mirror: int  # 1: a free end, which reflects waves as they are
    rough: int  # 1: hard breaks come too densely to be followed one by one
    source: SideLines  # lines that arrive
    target: SideLines  # lines that leave
    mobility: Sides  # 1/Z of the rods, s/kg; 0 where there is none

    # Over the piece that is being solved, at its points
    incoming: SideSeries  # waves that arrive, m/s
    leaving: Series  # a wave that leaves, m/s
    rate: Series  # scratch: derivatives, or values of a guard
    series: Series  # scratch: coefficients


class Link(link.Link):
    """What acts between two neighbours of a chain: a bond, a joint, or a contact."""

    status: int  # `Status`
    order: int  # order of the break that its own event makes
    function: int  # number of the law of the user
    near: float  # step of the derivative of that law by the overlap, m
    near_rate: float  # and by its rate, m/s
    resting_force: float  # scale of forces between bodies that rest, N
    mobility: float  # sum of 1/Z of the rod ends beside it, s/kg
    knot: int  # number of the next force at which a yielding contact changes its hardening

    # State at the end of the last piece
    overlap: float  # m
    rate: float  # its derivative, m/s
    bend: float  # its second derivative, m/s^2
    ease: (
        float  # velocity that a force of 1 N makes in about the shortest transit, s/kg
    )
    rate_after: float  # closing velocity that an impact leaves, m/s
    kept: int  # first of the lines that keep force, overlap and closing velocity
    left_group: (
        int  # first part of the group on the left; NONE for a link that cannot open
    )
    right_group: int  # and on the right
    touch: int  # `Status` that was logged last: OPEN, GRAZE or PRESS
    unknown: int  # number of its force among the unknown ones, NONE if it is given

    # Totals
    impulse: float  # N s
    peak: float  # largest force, N
    peak_error: float  # its estimated error, N
    first: Tick  # first contact, NONE before
    last: Tick  # end of the last force
    apart: Tick  # last opening
    opened: int  # 1: the next force begins another episode
    pressed: Tick  # total time with force
    faint: Tick  # time since it closed, with a force that is none yet
    episodes: int

    # Over the piece that is being solved, at its points
    overlaps: Series  # m
    closing: Series  # closing velocity without its own force, m/s
    force: Series  # N
    by_overlap: Series  # derivative of the force by the overlap, N/m
    by_closing: Series  # and by `closing`, N s/m
    base: Series  # force less both derivatives times their variables, N


class Mass:
    """A rigid mass between two links of a node."""

    mass: float  # kg
    speed: Series  # velocity over the piece, m/s; its first value is the state
    line: int  # line that keeps its velocity


class Turn:
    """A row of the log of contacts: one is touched, presses or opens, or bodies strike."""

    tick: Tick
    link: int
    touch: int  # `Status`: OPEN, GRAZE or PRESS
    impulse: float  # impulse of an impact, N s; 0 for other contacts
    closing: float  # mean of the closing velocities before and after it, m/s


class GroupPart:
    """A part of a group: of bodies that are bonded, between two contacts that can open."""

    kind: int  # `Part`
    index: int  # number of the segment, mass or link
    parts: int  # parts of the group, at its first one; 0 at the others
    held: int  # line of the wall, or of the endless rod, that holds the group
    mass: float  # kg
    compliance: float  # change of length by a force, m/N
    own: float  # mean velocity, m/s
    energy: float  # energy about the mean velocity of the group, J
    wave: Sides  # integrals of both waves of a segment over y from -1 to 1, m/s
    tilt: Sides  # the same, times y

    # Motion of the group, at its first part
    initial: float  # velocity of the centre of mass at t = 0, m/s
    mean: float  # and now
    speed: float  # velocity about which the group swings: `mean`, or that of what holds it, m/s
    low: float  # bounds of the waves under way, m/s
    high: float
    plain: int  # 1: its ends move with no velocities but those of the waves
    bound: float  # energy about `speed`, J
    deviation: Sides  # displacement of the ends from that motion, m
    slack: Sides  # squared displacement of the ends over twice the energy, at most, m/N


class Run:
    """What a run is asked for, and what it has come to."""

    tick: float  # s
    scale: float  # scale of velocities, m/s
    tolerance: float  # largest tail of a series, m/s
    floor: Tick  # duration of pieces where hard breaks come too densely
    window: Tick  # an event so close to an arrival is taken with it
    shortest: Tick  # shortest transit time
    end: Tick
    limit: int  # largest number of steps
    keep: int  # 1: forces, overlaps and velocities of masses are kept
    proved: Tick  # instant of the proof of finality, NONE before
    held: int  # 1: bodies are joined to others, a wall or an endless rod
    surveyed: Tick  # last look for a proof, NONE before the first
    check: Tick  # next look, NEVER where nothing is to be proved
    proof_interval: Tick  # least time between two looks
    extra: Tick  # time to go on after the proof

    # Progress
    pieces: int  # rows of the log of pieces
    turns: int  # rows of the log of contacts
    steps: int
    rough: int  # steps in which breaks were too dense
    first_rough: Tick  # start of the first of them, NONE before
    roughest: float  # largest tail of a series that was accepted, m/s
    shared: float  # largest error of a piece that is as long at any tolerance, m/s
    rested: int  # impacts after which bodies rest on each other
    stop: int  # `Stop`
    graze: (
        float  # velocity, m/s: a force that makes less in the shortest transit is none
    )


Nodes: TypeAlias = Sequence[Node]
Links: TypeAlias = Sequence[Link]
Masses: TypeAlias = Sequence[Mass]
Lines: TypeAlias = Sequence[Line]
Parts: TypeAlias = Sequence[GroupPart]
Log: TypeAlias = Sequence[Piece]
Turns: TypeAlias = Sequence[Turn]


class State(NamedTuple):
    """All that the kernels read and change."""

    runs: Sequence[Run]  # one Run; a sequence, since machine code changes arrays only
    nodes: Nodes  # from left to right
    links: Links  # node by node
    masses: Masses
    lines: Lines  # two a segment, those from outside, then those that keep what happens
    parts: Parts  # group by group
    log: Log  # pieces of all lines
    turns: Turns
    matrix: Matrix  # scratch: equations of a Newton step


PIECE = dtype_of(Piece)
LINE = dtype_of(Line)
NODE = dtype_of(Node)
LINK = dtype_of(Link)
MASS = dtype_of(Mass)
TURN = dtype_of(Turn)
PART = dtype_of(GroupPart)
RUN = dtype_of(Run)
