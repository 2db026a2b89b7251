"""What all members of a family share, as the kernels take it; the page has this as JavaScript."""

from typing import Any, NamedTuple

from ...model import Steps
from ..compiling import blank
from ..laws import Beyond, Law, Status
from ..walk import frame_of, scale_of
from . import events
from .records import LINE, NODE, NONE, PART, PIECE, ROW, RUN, SEGMENT

BEYOND = {
    "velocity": Beyond.MOVED.value, "force": Beyond.PUSHED.value, "absorbing": Beyond.ENDLESS.value,
}
STATUS = {
    Law.PUSH_LEFT: Status.PUSH.value, Law.PUSH_RIGHT: Status.PUSH.value,
    Law.BOND: Status.BOND.value, Law.RIGID: Status.TOUCH.value,
}


class Plan(NamedTuple):
    """What all members of a family share.

    Attributes
    ----------
    row : Row
    profiles : list of (int, int, int, int, int)
        Segments, and the first four fields of their `SEGMENT`.
    kinds : list of int
        Of each node.
    numbers : list of float or array
        In which members differ, see `layout`.
    contacts : list of int
        Node of each contact.
    pieces, fronts : int
        How many durations and fronts at t = 0 a member has.
    """

    row: Any
    profiles: list[Any]
    kinds: list[int]
    numbers: list[Any]
    contacts: list[int]
    pieces: int
    fronts: int


def plan_of(row: Any) -> Plan:
    """The plan of a row that fronts can carry."""
    system, segments = row.system, row.segments
    numbers = [
        *[s.wave_speed for s in segments], *[s.impedance for s in segments],
        *[s.length for s in segments], frame_of(row), scale_of(row), *system.gaps,
    ]
    profiles: list[Any] = []
    for i, (body, (first, last)) in enumerate(zip(system.bodies, row.spans, strict=True)):
        s = first if last > 0 else 0 if i == 0 else len(segments) + 1
        strain = body.strain if body.kind == "rod" else 0.0
        profiles.append(enter(numbers, s, (body.velocity, strain), Beyond.STEADY.value))
    kinds = [STATUS[it.law] for it in row.links]
    for side, (kind, value) in enumerate(row.outside):
        end = system.ends[side].kind
        if kind == "none":
            kinds[side * (len(kinds) - 1)] = Status.FREE.value
        if end != "free":
            beyond = Beyond.STEADY.value if end == "fixed" else BEYOND[kind]
            end = side * (len(segments) + 1)
            profiles.append(enter(numbers, end, (value, 0.0), beyond))
    pieces = len(segments) + sum(v + e - 2 for _s, _place, v, e, _o in profiles)  # cut at jumps
    contacts = [last for _, last in row.spans[: len(system.gaps)]]
    return Plan(row, profiles, kinds, numbers, contacts, pieces, 2 * pieces + 2)


def enter(numbers: list[Any], segment: int, values: Any, outside: int) -> Any:
    """What a body, or what is outside, adds to the numbers: velocities and strains."""
    place, counts = len(numbers), []
    for profile in values:
        if isinstance(profile, Steps):
            numbers.extend(profile.values)
            numbers.extend(profile.at)
            counts.append(len(profile.values))
        else:
            numbers.append(profile)
            counts.append(1)
    return segment, place, counts[0], counts[1], outside


def blank_records(plan: Plan, rows: int) -> dict[str, Any]:
    """Records for runs of a plan as the kernels take them, and others that differ in numbers only.

    The log has room for so many `rows` beside those at t = 0.
    """
    n, run = len(plan.kinds) - 1, blank(1, RUN)[0]
    node = blank(n + 1, NODE)
    for k in range(n + 1):
        node[k].kind, node[k].contact = plan.kinds[k], NONE
    for i, k in enumerate(plan.contacts):
        node[k].contact = i
    segment = blank(n + 2, SEGMENT)
    for s, place, velocities, strains, outside in plan.profiles:
        it = segment[s]
        it.profile, it.velocities, it.strains, it.outside = place, velocities, strains, outside
    endless = any(it.outside == Beyond.ENDLESS for it in segment)
    bonded = any(plan.kinds[k] == Status.BOND for k in plan.contacts)
    run.lasting = 1 if endless or bonded else 0
    return {
        "run": run, "piece": blank(plan.pieces, PIECE), "segment": segment, "node": node,
        "line": blank(2 * n + 4, LINE), "part": blank(n + 1, PART),
        "log": blank(plan.fronts + rows, ROW),
        "tree": [0 for _ in range(events.size_of_tree(n + 1))],
    }
