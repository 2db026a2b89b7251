"""What all members of a family share, as the kernels take it.

The page has this as JavaScript.
"""

from typing import Any, NamedTuple

from ...model import Steps
from ..compiling import blank
from ..laws import Beyond, Law, Status
from ..walk import frame_of, scale_of
from . import event_queue
from .records import (
    FRONT,
    LINE,
    NODE,
    NONE,
    PIECE,
    RUN,
    SEGMENT,
    TOTALS,
    State,
)

BEYOND = {
    "velocity": Beyond.MOVED.value,
    "force": Beyond.PUSHED.value,
    "absorbing": Beyond.ENDLESS.value,
}
"""What acts on an end, by the name of `Row.outside`."""

STATUS = {
    Law.PUSH_LEFT: Status.PUSH.value,
    Law.PUSH_RIGHT: Status.PUSH.value,
    Law.BOND: Status.BOND.value,
    Law.RIGID: Status.TOUCH.value,
}
"""Status of a closed node before anything is solved, by the law of its link."""


class Profile(NamedTuple):
    """Where the initial state of a body, or a drive, stands: fields of `Segment`."""

    segment: int  # first of the body, or what lies outside the end
    place: int  # among the numbers of a member
    velocity_count: int
    strain_count: int
    outside: int  # `laws.Beyond`


class Plan(NamedTuple):
    """What all members of a family share.

    Attributes
    ----------
    row : Row
    profiles : list of Profile
    kinds : list of int
        Status of each node while its gap is closed, before anything is solved.
    numbers : list of float or array
        In which members differ, in the order that `initial_state` says.
    contacts : list of int
        Node of each contact.
    pieces : int
        How many durations a member has.
    fronts : int
        How many fronts it may have at t = 0.
    """

    row: Any
    profiles: list[Profile]
    kinds: list[int]
    numbers: list[Any]
    contacts: list[int]
    pieces: int
    fronts: int


def plan_of(row: Any) -> Plan:
    """The plan of a row that fronts can carry."""
    numbers = numbers_of(row)
    profiles = profiles_of(row, numbers)
    durations = len(row.segments)
    for profile in profiles:
        jumps = profile.velocity_count - 1 + profile.strain_count - 1
        durations += jumps
    contacts: list[int] = []
    for i in range(len(row.system.gaps)):
        last_segment = row.spans[i][1]
        contacts.append(last_segment)
    fronts = 2 * durations + 2
    return Plan(row, profiles, kinds_of(row), numbers, contacts, durations, fronts)


def numbers_of(row: Any) -> list[Any]:
    """The numbers of a row but its profiles."""
    numbers: list[Any] = []
    for segment in row.segments:
        numbers.append(segment.wave_speed)
    for segment in row.segments:
        numbers.append(segment.impedance)
    for segment in row.segments:
        numbers.append(segment.length)
    numbers.append(frame_of(row))
    numbers.append(scale_of(row))
    numbers.extend(row.system.gaps)
    return numbers


def profiles_of(row: Any, numbers: list[Any]) -> list[Profile]:
    """Add the profiles of bodies and drives to the numbers; return where they stand."""
    system = row.system
    outside = len(row.segments) + 1
    profiles: list[Profile] = []
    for i, body in enumerate(system.bodies):
        first, last = row.spans[i]
        strain = 0.0
        if body.kind == "rod":
            strain = body.strain
        elif last == 0:
            first = 0 if i == 0 else outside
        profile = add_profile(
            numbers, first, body.velocity, strain, Beyond.STEADY.value
        )
        profiles.append(profile)
    for side in range(2):
        kind, value = row.outside[side]
        end = system.ends[side].kind
        if end == "free":
            continue
        beyond = Beyond.STEADY.value if end == "fixed" else BEYOND[kind]
        profiles.append(add_profile(numbers, side * outside, value, 0.0, beyond))
    return profiles


def add_profile(
    numbers: list[Any], segment: int, velocity: Any, strain: Any, outside: int
) -> Profile:
    """Add a velocity and a strain, each constant or in steps, to the numbers."""
    place = len(numbers)
    velocities = add_steps(numbers, velocity)
    strains = add_steps(numbers, strain)
    return Profile(segment, place, velocities, strains, outside)


def add_steps(numbers: list[Any], value: Any) -> int:
    """Add values, and where they jump, to the numbers; return how many values."""
    if isinstance(value, Steps):
        numbers.extend(value.values)
        numbers.extend(value.at)
        return len(value.values)
    numbers.append(value)
    return 1


def kinds_of(row: Any) -> list[int]:
    """Status of each node while its gap is closed, before anything is solved."""
    kinds: list[int] = []
    for link in row.links:
        kinds.append(STATUS[link.law])
    for side in range(2):
        kind, _ = row.outside[side]
        if kind == "none":
            kinds[side * (len(kinds) - 1)] = Status.FREE.value
    return kinds


def make_state(plan: Plan, rows: int, numbers: list[Any]) -> State:
    """Records for runs of a plan.

    Parameters
    ----------
    plan : Plan
    rows : int
        How many fronts the log has room for, beside those at t = 0.
    numbers : list
        Of the members.
    """
    n = len(plan.kinds) - 1
    run = blank(1, RUN)[0]
    segments = blank(n + 2, SEGMENT)
    for profile in plan.profiles:
        segment = segments[profile.segment]
        segment.profile = profile.place
        segment.velocity_count = profile.velocity_count
        segment.strain_count = profile.strain_count
        segment.outside = profile.outside
        if profile.outside == Beyond.ENDLESS:
            run.momenta_change = 1
    nodes = blank(n + 1, NODE)
    for k, node in enumerate(nodes):
        node.kind = plan.kinds[k]
        node.contact = NONE
    for i, k in enumerate(plan.contacts):
        nodes[k].contact = i
        if plan.kinds[k] == Status.BOND:
            run.momenta_change = 1
    queue = [0 for _ in range(event_queue.size_for(n + 1))]
    return State(
        [run],
        numbers,
        blank(plan.pieces, PIECE),
        segments,
        nodes,
        blank(2 * n + 4, LINE),
        blank(plan.fronts + rows, FRONT),
        queue,
        [blank(n + 1, TOTALS) for _ in numbers],
    )
