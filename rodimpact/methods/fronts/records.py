"""The records on which the kernels of this method work.

A row of n segments::

    outside |  segment 1  |  segment 2  | ... |  segment n  | outside
          node 0        node 1        node 2             node n

Node k joins the segments k and k + 1. The segments 0 and n + 1 stand for the outside of
the row: nothing, a wall (a segment of mobility 0), or a semi-infinite bar. Line 2s
carries the waves that travel to the right through segment s, line 2s + 1 those that
travel to the left. So at node k the lines 2k (through segment k) and 2k + 3 (through
segment k + 1) arrive, and the lines 2k + 1 and 2k + 2 leave. From outside the lines 0
and 2n + 3 come.

A side is 0 (left) or 1 (right). On this side of node k, segment k + side is the
neighbour, line 2k + 3 side arrives, and line 2k + 1 + side leaves.

Waves are velocities, m/s, in a frame chosen by the caller. Times are whole ticks.
Derived quantities stay in these units: lengths are velocity times ticks, impulses and
energies are velocity and its square times ticks over mobility.

In machine code a list of records is a structured array, in plain Python a list of
objects with the same fields, see `compiling`.
"""

from collections.abc import MutableSequence, Sequence
from typing import Annotated, Any, NamedTuple, TypeAlias

from ..record_lists import dtype_of
from ..tick_rule import CLOCK_BITS, Duration

NEVER = 1 << CLOCK_BITS  # tick at which the clock ends
IDLE = (1 << 63) - 1  # tick of a node at which nothing is due
NONE = -1  # no row, no node, no tick
CHANGE = -1  # `Front.line` of a row in which a contact changes its status


Amplitude: TypeAlias = Annotated[Any, "f8"]
"""A float; in exact arithmetic, a fraction, which may record how it was computed."""
Tick: TypeAlias = Annotated[Any, "i8"]
"""A time in ticks: a whole number; in exact arithmetic, a fraction."""
Int32: TypeAlias = Annotated[int, "i4"]
Int8: TypeAlias = Annotated[int, "i1"]


class Segment:
    """A uniform piece of a rod; the first and the last one stand for the outside."""

    # Initial state of the body that begins with this segment. A segment outside the row
    # holds a wall, or the values over time of the drive of its end.
    profile_offset: int  # index of the first velocity among the values of a member
    velocity_count: int  # number of velocities; 0: no body begins here. For a drive it
    # is the number of its values: velocities, forces or strains
    strain_count: int  # number of strains
    boundary_kind: int  # `states.BoundaryKind`, for a segment outside the row

    transit: Tick  # transit time, ticks
    mobility: Amplitude  # 1/Z, s/kg
    # First and last segment of its bonded group; 1 and 0, an empty range, outside the
    # row
    group_first: int
    group_last: int
    first_piece: int  # index of its first `InitialPiece`

    # Motion at t = 0, and at the last measurement
    initial_group_velocity: Amplitude  # velocity of its bonded group
    initial_momentum: Amplitude
    initial_vibration_energy: Amplitude
    group_velocity: Amplitude
    momentum: Amplitude
    vibration_energy: Amplitude  # energy about `group_velocity`
    max_wave_difference: Amplitude  # max abs(a - b): the stress is E/(2 c) times it

    # Motion of its group in the proof for a contact beside it
    mean_velocity: Amplitude
    min_end_velocity: Amplitude  # bounds of the velocity of the group's end
    max_end_velocity: Amplitude
    is_end_velocity_bounded: int  # 1: these bounds hold
    end_deviation: Amplitude  # displacement of the end from the mean motion, positive
    # to the right; velocity times ticks
    deviation_bound_squared: Amplitude  # square of the largest deviation that the
    # vibration of the group allows
    compliance_integral: Amplitude  # integral(g^2 dx/(E A)), see `finality`


class Node:
    """A contact, a joint of two segments, or an end of the row."""

    closed_status: int  # `states.Status` of the closed node before anything is solved
    contact: int  # index of the contact; NONE for a joint or an end
    status: int  # `states.Status`
    solved_tick: Tick  # tick at which the node was solved last
    gap: Amplitude  # gap at `solved_tick`; velocity times ticks
    gap_rate: Amplitude  # m/s
    force: Amplitude  # N, on the right segment; its negative acts on the left one
    face_velocity: Amplitude  # velocity of the right end of the left segment

    # Effects of the force so far
    impulse: Amplitude
    work: Amplitude  # energy transferred from left to right
    impulse_moment: Amplitude  # integral(F t dt)
    peak_force: Amplitude  # largest force that lasted over `Run.round_off_window`
    first_force_tick: Tick  # or NONE
    last_force_tick: Tick  # or NONE
    last_opening_tick: Tick  # last opening of the gap after a force, or NONE
    force_ticks: Tick  # force duration
    is_faint: int  # 1: the contact grazes, and its last force was faint, see `contact`
    faint_ticks: Tick  # ticks of grazing after a faint force
    episodes: int  # number of times a closed contact began to press


class Line:
    """The waves that travel in one direction through a segment."""

    incoming_wave: Amplitude  # wave at the end where it arrives
    first_row: int  # row of the log: the front sent first
    next_row: int  # row of the front that arrives next, or NONE
    arrival_tick: Tick  # tick at which that front arrives, or IDLE
    last_row: int  # row of the front sent last; NONE on a line that leads out of the
    # row: its waves are not stored


class Front:
    """A row of the log: a front, or a change of the status of a contact.

    In a change, `line` is CHANGE, `next_row` is the node and `value` its new status.
    """

    tick: Tick  # tick at which the front left its end
    value: Amplitude  # wave behind the front
    next_row: Int32  # next front of its line, or NONE
    line: Int32


class CachedDuration(Duration):
    """A time that the clock counts in ticks, and its value in the previous member.

    In `State.durations`, the transit times of the segments come first, then the times
    that waves take from the left end of a segment to the jumps of its initial state,
    then unused entries, and last the times at which drives jump.
    """

    cached_time: float  # `time` of the previous member, s


class InitialPiece:
    """A piece of a segment with one velocity and one strain at t = 0."""

    velocity: float  # m/s
    strain: float


class NodeResult:
    """Results of a member of a family at one node, in SI units."""

    # Results of the segment left of the node; velocities are of its bonded group
    velocity_before: float  # m/s
    velocity_after: float
    initial_momentum: float  # momentum in the frame, kg m/s
    max_wave_difference: float  # m/s
    # Results of the node
    impulse: float  # N s
    impulse_time_integral: float  # integral(J dt), J the impulse so far, N s^2
    peak_force: float  # N
    duration: float  # force duration, s
    episodes: Int32
    # Results of the run, at the first node
    stop_reason: Int8  # `states.Stop`
    is_proved: Int8  # 1: the collision is final, see `finality`
    vibration_energy: float  # energy left at the end, J
    end_time: float  # s
    frame_velocity: float  # m/s


class Run:
    """The request for a run, its clock, and its progress."""

    # Request
    until: float  # given end, s. A negative value means that no end is given; then
    # -until is the share of the `tick_rule.HORIZON` longest transits that the clock
    # counts: 1, or less on the web page
    max_events: int
    record_max_stress: int  # 1: `Segment.max_wave_difference` is found
    run_past_proof: int  # 1: run one round trip past the proof, and find the energies
    # at t = 0 and the largest wave
    perturb_rounding: int  # 1: transit times are rounded the other way

    settles_after_proof: int  # 1: there is a bond or a semi-infinite bar, so that
    # velocities may change for a round trip after the proof
    member: int  # index of the member that runs

    # Clock
    longest_transit_time: float  # s
    longest_bits: int  # base-2 logarithm of `longest_ticks`, approximately
    longest_ticks: int  # the longest transit time in ticks
    shortest_segment: int  # segment with the shortest transit time
    drive_jump_count: int  # number of jumps of both drives
    tick_duration: Amplitude  # s
    horizon: float  # s
    frame_velocity: Amplitude  # m/s
    velocity_scale: float  # m/s
    velocity_tolerance: Amplitude  # smallest change of a wave that is a front, m/s
    round_off_window: int  # ticks. A wave or force that lasts no longer is round-off. A
    # gap that closes so shortly before an arrival closes at the arrival
    end_tick: Tick  # tick to run to; NONE: to the proof
    ticks_after_proof: Tick  # ticks to run on after the proof

    # Progress
    now: Tick  # tick reached
    log_rows: int  # rows of the log in use
    initial_rows: int  # rows that fill the segments at t = 0
    events: int
    # A proof is tried after this tick, and only from this number of events on.
    next_proof_tick: Tick
    next_proof_event: int
    proved_tick: Tick  # tick of the proof, or NONE
    stop_reason: int  # `states.Stop`

    max_wave: float  # largest absolute wave, m/s


Log: TypeAlias = Sequence[Front]
Queue: TypeAlias = MutableSequence[Tick]
Values: TypeAlias = Sequence[Amplitude]
"""Values of a member, in the order that `initial_state` says."""


class State(NamedTuple):
    """All that the kernels read and change; the members of a family use it in turn."""

    runs: Sequence[Run]  # a single Run: machine code can change entries of arrays only
    values: Sequence[Values]  # [member, value]
    durations: Sequence[CachedDuration]
    initial_pieces: Sequence[InitialPiece]
    segments: Sequence[Segment]  # [n + 2]
    nodes: Sequence[Node]  # [n + 1]
    lines: Sequence[Line]  # [2 n + 4]
    log: Log
    queue: Queue  # next tick of each node, see `event_queue`
    results: Sequence[Sequence[NodeResult]]  # [member, node]


SEGMENT = dtype_of(Segment)
NODE = dtype_of(Node)
LINE = dtype_of(Line)
FRONT = dtype_of(Front)
CACHED_DURATION = dtype_of(CachedDuration)
INITIAL_PIECE = dtype_of(InitialPiece)
NODE_RESULT = dtype_of(NodeResult)
RUN = dtype_of(Run)
