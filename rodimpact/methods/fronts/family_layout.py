"""The records that all members of a family share, and the order of their values.

The web page has this module as JavaScript.
"""

from typing import Any, NamedTuple

from ...model import Steps
from ..link import Law
from ..record_lists import blank
from ..scales import frame_of, scale_of
from ..states import BoundaryKind, Status
from . import event_queue
from .records import (
    CACHED_DURATION,
    FRONT,
    INITIAL_PIECE,
    LINE,
    NODE,
    NODE_RESULT,
    NONE,
    RUN,
    SEGMENT,
    State,
)

BOUNDARY_KINDS = {
    "velocity": BoundaryKind.MOVED.value,
    "force": BoundaryKind.PUSHED.value,
    "absorbing": BoundaryKind.ENDLESS.value,
}
"""Kind of a driven or absorbing end, by the kind in its pair of `Row.boundaries`."""

CLOSED_STATUS = {
    Law.PUSH_LEFT: Status.PUSH.value,
    Law.PUSH_RIGHT: Status.PUSH.value,
    Law.BOND: Status.BOND.value,
    Law.RIGID: Status.TOUCH.value,
}
"""Status of a closed node before anything is solved, by the law of its link."""


class Profile(NamedTuple):
    """Location of the initial state of a body, or of a drive, among the values.

    All but `segment` become fields of a `Segment`.
    """

    segment: int  # first segment of the body, or the segment outside the end
    offset: int  # index of the first velocity among the values of a member
    velocity_count: int  # number of velocities; for a drive, of its values of any kind
    strain_count: int  # number of strains
    boundary_kind: int  # `states.BoundaryKind`


class FamilyLayout(NamedTuple):
    """Layout of the records and values that all members of a family share.

    Attributes
    ----------
    row : Row
    profiles : list of Profile
    closed_status : list of int
        Status at t = 0 of each node whose gap is closed, [node].
    values : list of float or array
        Values of the members, in the order that `initial_state` states. A value that
        differs between members is an array.
    contacts : list of int
        Node of each contact.
    initial_piece_count : int
        Largest number of `InitialPiece` pieces of a member.
    duration_count : int
        Largest number of durations of a member.
    initial_front_count : int
        Largest number of fronts of a member at t = 0.
    """

    row: Any
    profiles: list[Profile]
    closed_status: list[int]
    values: list[Any]
    contacts: list[int]
    initial_piece_count: int
    duration_count: int
    initial_front_count: int


def lay_out_family(row: Any) -> FamilyLayout:
    """Make the layout of a row, all of whose physics this method must support.

    The numbers of initial pieces, durations and fronts at t = 0 are the largest that a
    member can have. Each segment is one piece and has one duration. Each jump of an
    initial state adds a piece and a duration, each jump of a drive a duration only.
    Fronts are twice the durations, plus one for each of two drives.
    """
    values = values_of(row)
    profiles = append_profiles(row, values)
    initial_pieces = len(row.segments)
    durations = len(row.segments)
    for profile in profiles:
        # n values have n - 1 jumps between them.
        jumps = profile.velocity_count - 1 + profile.strain_count - 1
        durations += jumps
        if profile.boundary_kind == BoundaryKind.STEADY:  # a body, not a drive
            initial_pieces += jumps
    contacts: list[int] = []  # node of each contact
    for i in range(len(row.system.gaps)):
        # Last segment of the body on the left of the contact; 0 for a wall
        last_segment = row.spans[i][1]
        contacts.append(last_segment)  # node k is on the right of segment k
    # Each initial piece has a duration, and makes a front on two lines. A drive has one
    # front more than durations; there are at most two drives.
    initial_fronts = 2 * durations + 2
    return FamilyLayout(
        row,
        profiles,
        closed_status_of(row),
        values,
        contacts,
        initial_pieces,
        durations,
        initial_fronts,
    )


def values_of(row: Any) -> list[Any]:
    """The values of a row in the order of `initial_state`, without its profiles.

    They are, in SI units: all wave speeds, all impedances and all lengths of the
    segments, the velocity of the frame, the velocity scale, and all gaps. In a family a
    value may be an array. `append_profiles` appends the profiles.
    """
    values: list[Any] = []
    for segment in row.segments:
        values.append(segment.wave_speed)
    for segment in row.segments:
        values.append(segment.impedance)
    for segment in row.segments:
        values.append(segment.length)
    values.append(frame_of(row))
    values.append(scale_of(row))
    values.extend(row.system.gaps)
    return values


def append_profiles(row: Any, values: list[Any]) -> list[Profile]:
    """Append the profiles of bodies and ends to `values`; return their locations.

    The profiles of all bodies come first, from left to right, then those of the ends
    that are not free, first the left one. Bodies, walls and fixed ends have the
    boundary kind STEADY. A wall or an end belongs to the segment outside on its side.
    """
    system = row.system
    outside = len(row.segments) + 1  # segment outside on the right; 0 on the left
    profiles: list[Profile] = []
    for i, body in enumerate(system.bodies):
        first = row.spans[i][0]  # first segment of the body, if it is a rod
        strain = 0.0
        if body.kind == "rod":
            strain = body.strain
        elif i == 0:  # a wall on the left
            first = 0
        else:  # a wall on the right
            first = outside
        profile = append_profile(
            values, first, body.velocity, strain, BoundaryKind.STEADY.value
        )
        profiles.append(profile)
    for side in range(2):
        kind, value = row.boundaries[side]
        end_kind = system.ends[side].kind
        if end_kind == "free":
            continue
        boundary_kind = BoundaryKind.STEADY.value
        if end_kind != "fixed":
            boundary_kind = BOUNDARY_KINDS[kind]
        segment = side * outside  # 0 on the left
        strain = 0.0  # an end has none
        profiles.append(append_profile(values, segment, value, strain, boundary_kind))
    return profiles


def append_profile(
    values: list[Any], segment: int, velocity: Any, strain: Any, boundary_kind: int
) -> Profile:
    """Append a velocity and a strain to `values`; return their location.

    Each is constant or in steps, see `append_steps`. They belong to the body that
    begins with `segment`, or to the end beside `segment`, outside the row. For a drive,
    `velocity` is the driven quantity, which may also be a force or a strain: it is
    appended as it is. `segment` and `boundary_kind` are only stored in the result.
    """
    offset = len(values)
    velocity_count = append_steps(values, velocity)
    strain_count = append_steps(values, strain)
    return Profile(segment, offset, velocity_count, strain_count, boundary_kind)


def append_steps(values: list[Any], value: Any) -> int:
    """Append a constant, or steps and then the positions of their jumps, to `values`.

    Return the number of steps, 1 for a constant. There is one jump less than steps. For
    a drive the positions are times.
    """
    if isinstance(value, Steps):
        values.extend(value.values)
        values.extend(value.at)
        return len(value.values)
    values.append(value)
    return 1


def closed_status_of(row: Any) -> list[int]:
    """Status at t = 0 of each node whose gap is closed, [node].

    It follows from the law of the link of the node, see `CLOSED_STATUS`: PUSH, BOND or
    TOUCH. A free end is FREE.
    """
    statuses: list[int] = []
    # The method has no rigid masses, so that there is one link a node.
    for link in row.links:
        statuses.append(CLOSED_STATUS[link.law])
    for side in range(2):
        kind, _ = row.boundaries[side]
        if kind == "none":  # a free end: its link is a push of 0
            end_node = side * (len(statuses) - 1)  # first or last node
            statuses[end_node] = Status.FREE.value
    return statuses


def make_state(layout: FamilyLayout, log_rows: int, values: list[Any]) -> State:
    """Make the records for runs of a layout; fields that members do not share are 0.

    The records are lists of objects, with results for as many members as there are
    `values`. These fields are set: the locations of the profiles in the segments, the
    closed statuses and contacts of the nodes, and `settles_after_proof` of the run,
    which is 1 if there is a bond or a semi-infinite bar.

    Parameters
    ----------
    layout : FamilyLayout
    log_rows : int
        Rows of the log, in addition to those of the fronts at t = 0.
    values : [member, value]
        Values of the members; not copied; may be empty.
    """
    n = len(layout.closed_status) - 1  # number of segments
    run = blank(1, RUN)[0]
    segments = blank(n + 2, SEGMENT)
    for profile in layout.profiles:
        segment = segments[profile.segment]
        segment.profile_offset = profile.offset
        segment.velocity_count = profile.velocity_count
        segment.strain_count = profile.strain_count
        segment.boundary_kind = profile.boundary_kind
        if profile.boundary_kind == BoundaryKind.ENDLESS:
            run.settles_after_proof = 1
    nodes = blank(n + 1, NODE)
    for k, node in enumerate(nodes):
        node.closed_status = layout.closed_status[k]
        node.contact = NONE
    for i, k in enumerate(layout.contacts):  # contact i is at node k
        nodes[k].contact = i
        if layout.closed_status[k] == Status.BOND:
            run.settles_after_proof = 1
    queue = [0 for _ in range(event_queue.size_for(n + 1))]
    # Arguments go by position, as this is translated to JavaScript, without keywords.
    return State(
        [run],
        values,
        blank(layout.duration_count, CACHED_DURATION),
        blank(layout.initial_piece_count, INITIAL_PIECE),
        segments,
        nodes,
        blank(2 * n + 4, LINE),
        blank(layout.initial_front_count + log_rows, FRONT),
        queue,
        [blank(n + 1, NODE_RESULT) for _ in values],
    )
