"""The records on which the kernels of this method work.

A row of n segments::

    outside |  segment 1  |  segment 2  | ... |  segment n  | outside
          node 0        node 1        node 2             node n

Node k joins the segments k and k + 1; the segments 0 and n + 1 stand for what lies
outside: nothing, a wall (a segment of mobility 0), or an endless bar. Line 2s carries
the waves that travel to the right through segment s, line 2s + 1 those that travel to
the left.

Waves are velocities, m/s, in a frame chosen by the caller; times are whole ticks.
Derived quantities are left in these units: lengths are velocity times ticks, impulses
and energies velocity and its square times ticks over mobility.

In machine code a list of records is a structured array, in plain Python a list of
objects with the same fields, see `compiling`.
"""

from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple, TypeAlias

from ..compiling import dtype_of

NEVER = 1 << 62  # tick at which the clock ends
IDLE = (1 << 63) - 1  # tick of a node at which nothing is due
NONE = -1  # no row, no node, no time
CHANGE = -1  # `Front.line` of a row that says that a contact changed its status


Amplitude: TypeAlias = Annotated[Any, "f8"]
"""A float; in proofs and derivatives, a fraction or a number that carries more."""
Int32: TypeAlias = Annotated[int, "i4"]
Int8: TypeAlias = Annotated[int, "i1"]


class Segment:
    """A uniform piece of a rod, or what lies outside an end of the row."""

    # Initial state of the body that begins here, or values over time of what drives
    # this end: they stand among the numbers of a member from `profile` on.
    profile: int
    velocity_count: int  # 0: no body begins here
    strain_count: int
    outside: int  # `laws.Beyond`

    transit: int  # ticks
    mobility: Amplitude  # 1/Z, s/kg
    first: int  # first and last of the segments bonded to it and to each other;
    last: int  # 1 and 0 of what lies outside
    first_piece: int  # of its `Piece`s of constant initial state

    # Motion at t = 0, and when it was last looked at
    initial_velocity: Amplitude  # of the bonded group
    initial_momentum: Amplitude
    initial_vibration: Amplitude
    velocity: Amplitude
    momentum: Amplitude
    vibration: Amplitude  # energy about `velocity`
    wave_difference: Amplitude  # largest difference of its two waves, up to the end

    # The bonded group whose end at a contact this is
    mean_velocity: Amplitude
    slowest: Amplitude  # bounds of the velocity of its end
    fastest: Amplitude
    bounded: int  # 1: these bounds hold
    deviation: Amplitude  # of its end from the mean motion, positive to the right
    squared_bound: Amplitude  # of the largest deviation that its vibration allows
    compliance: Amplitude  # that over twice the energy of vibration


class Node:
    """A contact, a joint of two segments, or an end of the row."""

    kind: int  # `laws.Status` of a closed gap before anything is solved
    contact: int  # index of the contact; NONE for a joint or an end
    status: int  # `laws.Status`
    solved: int  # tick at which it was solved last
    gap: Amplitude
    gap_rate: Amplitude
    force: Amplitude  # on the right segment, and minus that on the left one
    face_velocity: Amplitude  # of the right end of the left segment

    # What the force has done so far
    impulse: Amplitude
    work: Amplitude  # energy handed from left to right
    moment: Amplitude  # integral of the force times the tick at which it acts
    peak_force: Amplitude  # of those that lasted longer than `Run.window`
    force_began: int  # first, or NONE
    force_ended: int  # last, or NONE
    opened: int  # when the gap opened last after a force, or NONE
    pressed: int  # ticks under force
    episodes: int  # how often a closed contact began to press


class Line:
    """The waves that travel in one direction through a segment."""

    arrived: Amplitude  # wave at the end where it arrives
    first_row: int  # of the log: the front sent first
    next_row: int  # the front that arrives next, or NONE
    due: int  # tick at which that arrives, or IDLE
    last_row: int  # the front sent last; NONE on a line from outside


class Front:
    """A row of the log: a front, or a contact that changes its status.

    Of a change, `line` is CHANGE, `next_row` is the node and `value` its new status.
    """

    tick: int  # when it left its end
    value: Amplitude  # wave behind it
    next_row: Int32  # next front of its line, or NONE
    line: Int32


class Piece:
    """A piece of constant initial state, and a duration to be counted in ticks.

    There are more durations than pieces: transit times, times from the left end of a
    segment to its jumps, and times at which drives jump.
    """

    time: float  # s; these five are the fields of `tick_rule.SPAN`
    ticks: int
    place: int
    p: int
    q: int
    known: float  # `time` of the member before
    velocity: float  # m/s
    strain: float


class Totals:
    """What a member of a family comes to, by node, in SI units."""

    # Of the segment left of the node
    velocity_before: float  # m/s
    velocity_after: float
    momentum: float  # at t = 0 in the frame, kg m/s
    wave_difference: float  # largest difference of its two waves, m/s
    # Of the node
    impulse: float  # N s
    carried: float  # impulse integrated over time, N s^2
    peak_force: float  # N
    duration: float  # s
    episodes: Int32
    # Of the run, at the first node
    stop: Int8  # `laws.Stop`
    proved: Int8  # 1: nothing meets again
    vibration: float  # energy left, J
    time: float  # when it ended, s
    frame: float  # m/s


class Run:
    """What a run is asked for, its clock, and how far it is."""

    # Asked for
    until: float  # s; without an end minus the share of `tick_rule.HORIZON`
    event_limit: int
    reads_waves: int  # 1: `Segment.wave_difference` is found
    goes_on: int  # 1: for a round trip after the proof; balances are prepared, too
    other_side: int  # 1: transit times are rounded the other way

    momenta_change: int  # 1: also after the proof, by bonds and endless bars
    member: int  # which one runs

    # Clock
    longest_time: float  # transit time, s
    longest_bits: int  # of `longest_ticks`, about
    longest_ticks: int
    shortest: int  # segment with the shortest transit time
    drive_jumps: int  # how often what drives the ends jumps
    tick: Amplitude  # s
    horizon: float  # s
    frame: Amplitude  # m/s
    scale: float  # of velocities, m/s
    tolerance: Amplitude  # smallest change of a wave that is a front, m/s
    window: int  # ticks by which a closing may move to an arrival
    target: int  # tick to run to; if negative, ticks to run on after the proof

    # Progress
    now: int
    rows: int  # of the log
    initial_rows: int  # that fill the segments at t = 0
    events: int
    proof_tick: int  # a proof is tried after this tick
    proof_events: int  # and not before so many events
    proved: int  # tick of the proof, or NONE
    stop: int  # `laws.Stop`

    # Of all waves
    absolute_momentum: float  # sum of their absolute momenta at t = 0, kg m/s
    fastest_wave: float  # largest absolute wave, m/s


class State(NamedTuple):
    """All that the kernels read and change; a member of a family goes after another."""

    runs: Sequence[Run]  # a single one, for machine code
    numbers: Any  # [member, number], see `initial_state`
    pieces: Sequence[Piece]
    segments: Sequence[Segment]  # [n + 2]
    nodes: Sequence[Node]  # [n + 1]
    lines: Sequence[Line]  # [2 n + 4]
    log: Any  # [row] Front
    queue: Any  # next tick of each node, see `event_queue`
    totals: Any  # [member, node] Totals


SEGMENT = dtype_of(Segment)
NODE = dtype_of(Node)
LINE = dtype_of(Line)
FRONT = dtype_of(Front)
PIECE = dtype_of(Piece)
TOTALS = dtype_of(Totals)
RUN = dtype_of(Run)
