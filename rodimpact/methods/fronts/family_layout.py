"""What all members of a family share: their records, and the order of their values.

The page has this as JavaScript.
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
"""What acts on an end, by the name of `Row.boundaries`."""

CLOSED_STATUS = {
    Law.PUSH_LEFT: Status.PUSH.value,
    Law.PUSH_RIGHT: Status.PUSH.value,
    Law.BOND: Status.BOND.value,
    Law.RIGID: Status.TOUCH.value,
}
"""Status of a closed node before anything is solved, by the law of its link."""


class Profile(NamedTuple):
    """Where the initial state of a body, or a drive, stands: fields of `Segment`."""

    segment: int  # first segment of the body, or what lies outside the end
    offset: int  # index of the first value among the values of a member
    velocity_count: int
    strain_count: int
    boundary_kind: int  # `states.BoundaryKind`


class FamilyLayout(NamedTuple):
    """What all members of a family share.

    Attributes
    ----------
    row : Row
    profiles : list of Profile
    closed_status : list of int
        Status of each node while its gap is closed, before anything is solved.
    values : list of float or array
        Values of the members, in the order that `initial_state` says; those that
        differ between members are arrays.
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
    """The layout of a row, of which the method must lack no physics.

    The numbers of initial pieces, durations and fronts at t = 0 are the largest that a
    member can have: each segment adds to them, each jump of a profile or a drive to the
    durations and fronts, and that of a profile to the pieces, too.
    """
    values = values_of(row)
    profiles = append_profiles(row, values)
    initial_pieces = len(row.segments)
    durations = len(row.segments)
    for profile in profiles:
        # n values in a row have n - 1 jumps between them.
        jumps = profile.velocity_count - 1 + profile.strain_count - 1
        durations += jumps
        if profile.boundary_kind == BoundaryKind.STEADY:  # it is a body's, no drive
            initial_pieces += jumps
    contacts: list[int] = []
    for i in range(len(row.system.gaps)):
        last_segment = row.spans[i][1]  # last one of the body on the left; 0: a wall
        contacts.append(last_segment)  # node k is on the right of segment k
    # Each piece of the initial state fills two lines. A drive has a front more than
    # durations, one for its first value; there are two drives at most.
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
    """The values of a row in the order of `initial_state`, up to the gaps.

    These are all wave speeds, all impedances and all lengths of the segments, the
    velocity of the frame, the velocity scale and all gaps, in SI units. In a family a
    value may be an array. Profiles are still to be appended.
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
    """Append the profiles of bodies and ends to `values`; return where they stand.

    Those of all bodies come first, from left to right, then those of the ends that are
    not free. A wall and a fixed end are STEADY, as bodies are, and belong to what lies
    outside on their side.
    """
    system = row.system
    outside = len(row.segments) + 1
    profiles: list[Profile] = []
    for i, body in enumerate(system.bodies):
        first = row.spans[i][0]  # first segment of the body, if it is a rod
        strain = 0.0
        if body.kind == "rod":
            strain = body.strain
        elif i == 0:  # a wall on the left, which is what lies outside there
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
        profiles.append(append_profile(values, segment, value, 0.0, boundary_kind))
    return profiles


def append_profile(
    values: list[Any], segment: int, velocity: Any, strain: Any, boundary_kind: int
) -> Profile:
    """Append a velocity and a strain to `values`; return where they stand.

    Each is constant or in steps, see `append_steps`. They belong to the body that
    begins with `segment`, or to what lies outside an end, whose kind is
    `boundary_kind`. Of a drive, `velocity` is what it gives, which may be a force or a
    strain.
    """
    offset = len(values)
    velocity_count = append_steps(values, velocity)
    strain_count = append_steps(values, strain)
    return Profile(segment, offset, velocity_count, strain_count, boundary_kind)


def append_steps(values: list[Any], value: Any) -> int:
    """Append a constant, or steps and then the places of their jumps, to `values`.

    Return the number of steps, 1 for a constant; there is one jump less than steps.
    """
    if isinstance(value, Steps):
        values.extend(value.values)
        values.extend(value.at)
        return len(value.values)
    values.append(value)
    return 1


def closed_status_of(row: Any) -> list[int]:
    """Status of each node, [node], while its gap is closed, before anything is solved.

    It follows from the law of the link, see `CLOSED_STATUS`: PUSH, BOND or TOUCH. A
    free end is FREE.
    """
    statuses: list[int] = []
    # There are no rigid masses, so that each node has one link.
    for link in row.links:
        statuses.append(CLOSED_STATUS[link.law])
    for side in range(2):
        kind, _ = row.boundaries[side]
        if kind == "none":  # its link is a push of 0
            first_or_last = side * (len(statuses) - 1)  # 0 or the last one
            statuses[first_or_last] = Status.FREE.value
    return statuses


def make_state(layout: FamilyLayout, log_rows: int, values: list[Any]) -> State:
    """Records for runs of a layout: all that its members share is set, the rest is 0.

    They are lists of objects, with results for as many members as there are `values`.
    Set are where profiles stand, closed statuses and contacts of the nodes, and
    `settles_after_proof` of the run if there is a bond or an endless bar.

    Parameters
    ----------
    layout : FamilyLayout
    log_rows : int
        Rows of the log, in addition to those of the fronts at t = 0.
    values : [member, value]
        Kept as they are; may be empty.
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
    for i, k in enumerate(layout.contacts):
        nodes[k].contact = i
        if layout.closed_status[k] == Status.BOND:
            run.settles_after_proof = 1
    queue = [0 for _ in range(event_queue.size_for(n + 1))]
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
