"""Families of collisions by fronts: columns of the results of their members."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from typing import NamedTuple

import numpy as np

from ..abilities import has_external_drive
from ..family import CONTACT_COLUMNS, Columns, family_columns, status_column
from ..groups import body_velocities, first_segments_of_groups
from ..row import Array, Row
from ..states import Stop
from . import driver
from .batch import RunRequest
from .family_layout import FamilyLayout, lay_out_family

MAX_MEMBERS_PER_CALL = 16384
MAX_BYTES_PER_CALL = 1 << 24  # values and results of the members of a call
WAVE_COLUMNS = {"displacement", "largest_stress"}  # columns that need all waves


class ResultColumns(NamedTuple):
    """Results of all members, and which members have none."""

    fields: Mapping[tuple[str, int], Array]
    """Columns by field of `records.NodeResult` and node, [member]."""
    is_refused: Array
    """Whether a member has no clock, so that its results are meaningless, [member]."""

    def of(self, name: str, node: int) -> Array:
        """Results of this name at a node, [member]; nan where a member was refused."""
        return self.masked(self.fields[name, node])

    def masked(self, column: Array) -> Array:
        """The column with nan where a member was refused, [member].

        If no member was refused, it is `column` itself, not a copy.
        """
        if not self.is_refused.any():
            return column
        return np.where(self.is_refused, math.nan, column)


def members_per_call(row: Row) -> int:
    """Number of members to run in one call, from 1 to `MAX_MEMBERS_PER_CALL`.

    Their values and results take at most `MAX_BYTES_PER_CALL`, unless a single member
    already takes more.
    """
    # Numbers a member: its values, and about six results a node, of which there are
    # about two more than segments
    numbers = len(lay_out_family(row).values) + 6 * (len(row.segments) + 2)
    fitting = MAX_BYTES_PER_CALL // (8 * numbers)  # 8 bytes a number
    return int(max(1, min(MAX_MEMBERS_PER_CALL, fitting)))


def solve_family(
    row: Row,
    until: float | None,
    max_events: int,
    should_stop: Callable[[], bool] = lambda: False,
    later_members: int = 0,
    also: Sequence[str] = (),
) -> Columns:
    """Run all members of a family; return columns of their results, [member], by name.

    The columns are those of `family.family_columns`, and "dissipated", the energy lost
    in contacts, which is 0. If `also` names "displacement" or "largest_stress", which
    need the waves of each member, the columns of both are added, see `wave_columns`.
    Other names in `also` change nothing. A member without a clock is refused: it has
    nan. The other arguments, and the errors raised, are those of `driver.solve_many`.
    """
    layout = lay_out_family(row)
    group_segments = first_segments_of_groups(row.system, row.spans)
    needs_waves = not WAVE_COLUMNS.isdisjoint(also)
    fields = result_fields(layout, group_segments)
    if needs_waves:
        fields += wave_fields(len(row.segments))
    request = RunRequest(until, max_events, record_max_stress=needs_waves)
    columns = driver.solve_many(layout, request, fields, should_stop, later_members)

    # Columns are named by field and node; results of the whole run are at node 0.
    stop_reason = columns["stop_reason", 0]
    is_refused = stop_reason >= Stop.OVERFLOW  # members without a clock
    is_capped = stop_reason == Stop.CAP
    # No proof holds if an end is driven, which is so in all members or in none.
    is_proved = columns["is_proved", 0] > 0
    is_final: Array = is_proved & (not has_external_drive(row.system))
    results = ResultColumns(columns, is_refused)
    family = family_columns(
        row.system,
        before=body_columns(row, results, "velocity_before", group_segments),
        after=body_columns(row, results, "velocity_after", group_segments),
        vibration=results.of("vibration_energy", 0),
        contacts=contact_columns(results, layout.contacts),
        final=is_final,
        status=status_column(is_refused, is_final, is_capped, until),
    )
    # Rigid contacts dissipate nothing.
    family["dissipated"] = results.masked(np.zeros(row.members))
    if needs_waves:
        family |= wave_columns(row, results)
    return family


def result_fields(
    layout: FamilyLayout, group_segments: list[int]
) -> list[tuple[str, int]]:
    """Fields of `records.NodeResult` that every family needs, each with its node.

    They are three results of the run, at node 0, the velocities before and after of
    each bonded group, and `CONTACT_COLUMNS` at the nodes of the contacts.
    `group_segments` are the first segments of the groups; results of segment s are at
    node s.
    """
    fields = [("stop_reason", 0), ("is_proved", 0), ("vibration_energy", 0)]
    for s in group_segments:
        fields.append(("velocity_before", s))
        fields.append(("velocity_after", s))
    for k in layout.contacts:
        fields.extend((name, k) for name in CONTACT_COLUMNS)
    return fields


def contact_columns(results: ResultColumns, nodes: list[int]) -> dict[str, list[Array]]:
    """Totals of the contacts at these nodes, by each name of `CONTACT_COLUMNS`.

    Each is a list of [member] arrays, one a contact. A refused member has nan, except
    for its number of episodes, which is 0.
    """
    columns: dict[str, list[Array]] = {}
    for name in CONTACT_COLUMNS:
        if name == "episodes":  # whole numbers, for which there is no nan
            columns[name] = [results.fields[name, k] for k in nodes]
        else:
            columns[name] = [results.of(name, k) for k in nodes]
    return columns


def body_columns(
    row: Row, results: ResultColumns, name: str, group_segments: list[int]
) -> list[Array]:
    """Velocities of the bodies, m/s, from those of their groups.

    The result is a list of [member] arrays, one a body; a wall has its own velocity.
    `name` is the field of the results that holds the velocities; `group_segments` are
    the first segments of the groups. A refused member has nan.
    """
    # `body_velocities` combines them with velocities of walls, which have the shape of
    # the family.
    shape = row.system.shape
    group_velocities = [results.fields[name, s].reshape(shape) for s in group_segments]
    columns = []
    for velocity in body_velocities(row.system, group_velocities):
        column = np.broadcast_to(velocity, shape).ravel()
        columns.append(results.masked(column))
    return columns


# Waves --------------------------------------------------------------------------------


def wave_fields(segments: int) -> list[tuple[str, int]]:
    """Fields of `records.NodeResult` for stress and displacement, each with its node.

    `segments` is the number of segments of the row. Fields of the run are at node 0,
    fields of segment s at node s. Impulse integrals are those of all nodes, from 0 to
    `segments`.
    """
    fields = [("end_time", 0), ("frame_velocity", 0)]
    for k in range(segments + 1):
        fields.append(("impulse_time_integral", k))
    for s in range(1, segments + 1):
        fields.append(("initial_momentum", s))
        fields.append(("max_wave_difference", s))
    return fields


def wave_columns(row: Row, results: ResultColumns) -> dict[str, Array]:
    """Displacement of each body, m, and largest stress in each rod, Pa, [member].

    Their names are "displacement.0", "largest_stress.0" and so on, with the number of
    the body. The displacement is that at the end of the run, the stress the largest
    during the run. A wall has a displacement, but no column of stress. A refused member
    has nan.
    """
    columns: dict[str, Array] = {}
    for i, body in enumerate(row.system.bodies):
        first, last = row.spans[i]
        if last == 0:  # a wall keeps its velocity
            wall_velocity = row.by_member(body.velocity)
            columns[f"displacement.{i}"] = wall_velocity * results.of("end_time", 0)
        else:
            columns[f"displacement.{i}"] = rod_displacement(row, results, first, last)
            columns[f"largest_stress.{i}"] = largest_stress(row, results, first, last)
    return columns


def rod_displacement(row: Row, results: ResultColumns, first: int, last: int) -> Array:
    """Displacement of the centre of mass of a rod in the run, m, [member].

    The rod has the segments `first` to `last`, counted from 1. Newton's law is
    integrated twice: m u = p0 t + integral(J1 - J2) dt in the frame, with p0 the
    momentum at t = 0, and J1 and J2 the impulses at the left and at the right end. The
    displacement of the frame is added. A refused member has nan.
    """
    mass: Array | float = 0.0
    momentum: Array | float = 0.0
    for s in range(first, last + 1):
        mass = mass + row.by_member(row.segments[s - 1].mass)
        momentum = momentum + results.of("initial_momentum", s)
    time = results.of("end_time", 0)
    # Segment s lies between the nodes s - 1 and s.
    from_left = results.of("impulse_time_integral", first - 1)
    from_right = results.of("impulse_time_integral", last)
    gained = from_left - from_right  # integral of the momentum gained, N s^2
    displacement: Array = (
        results.of("frame_velocity", 0) * time + (momentum * time + gained) / mass
    )
    return displacement


def largest_stress(row: Row, results: ResultColumns, first: int, last: int) -> Array:
    """Largest absolute stress in a rod during the run, Pa, [member].

    In a segment it is E/(2 c) times the largest difference of the two waves. The rod
    has the segments `first` to `last`, counted from 1. A refused member has nan.
    """
    stresses = []
    for s in range(first, last + 1):
        segment = row.segments[s - 1]
        stress_per_wave = segment.material.youngs_modulus / (2 * segment.wave_speed)
        wave_difference = results.of("max_wave_difference", s)
        stresses.append(row.by_member(stress_per_wave) * wave_difference)
    return reduce(np.maximum, stresses)
