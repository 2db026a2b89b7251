"""Families of collisions by fronts: the columns of what their members come to."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce

import numpy as np

from .. import run as runs
from ..abilities import driven
from ..groups import body_velocities, heads
from ..laws import Stop
from ..row import Array, Row
from . import driver
from .plan import plan_of

MOST_MEMBERS = 16384  # of one call of `solve_family`, for memory's sake
MOST_BYTES = 1 << 24  # of their numbers
TALLY = ("impulse", "peak_force", "duration", "episodes")
WAVE_COLUMNS = {"displacement", "largest_stress"}  # for which waves are read

Found = Mapping[tuple[str, int], Array]
"""Columns by field of `records.Totals` and node, [member]."""


def together(row: Row) -> int:
    """How many members to run in one call."""
    numbers = len(plan_of(row).numbers) + 6 * (len(row.segments) + 2)
    fitting = MOST_BYTES // (8 * numbers)
    return int(max(1, min(MOST_MEMBERS, fitting)))


def solve_family(
    row: Row,
    until: float | None,
    max_events: int,
    stop: Callable[[], bool] = lambda: False,
    more: int = 0,
    also: Sequence[str] = (),
) -> runs.FamilyRun:
    """Totals of every member, and what is wanted of `runs.READ`.

    The other arguments are those of `driver.solve_many`.
    """
    plan = plan_of(row)
    group_heads = heads(row.system, row.spans)
    reads_waves = not WAVE_COLUMNS.isdisjoint(also)

    wanted = [("stop", 0), ("proved", 0), ("vibration", 0)]
    for s in group_heads:
        wanted.append(("velocity_before", s))
        wanted.append(("velocity_after", s))
    for k in plan.contacts:
        wanted.extend((name, k) for name in TALLY)
    if reads_waves:
        wanted += wave_fields(len(row.segments))
    found = driver.solve_many(plan, until, max_events, wanted, stop, more)

    refused = found["stop", 0] >= Stop.OVERFLOW
    final: Array = (found["proved", 0] > 0) & (not driven(row.system))
    capped = found["stop", 0] == Stop.CAP
    further = {"dissipated": np.zeros(row.members)}
    if reads_waves:
        further |= wave_columns(row, found)
    contacts: dict[str, list[Array]] = {}
    for name in TALLY:
        columns = [found[name, k] for k in plan.contacts]
        if name != "episodes":
            columns = [known(column, refused) for column in columns]
        contacts[name] = columns
    return runs.FamilyRun(
        before=velocities(row, found, "velocity_before", group_heads, refused),
        after=velocities(row, found, "velocity_after", group_heads, refused),
        vibration=known(found["vibration", 0], refused),
        contacts=contacts,
        final=final,
        stopped_by=runs.stopped_by(refused, final, capped, until),
        further={name: known(column, refused) for name, column in further.items()},
    )


def known(column: Array, refused: Array) -> Array:
    """A column without the numbers of members that were refused."""
    if not refused.any():
        return column
    return np.where(refused, math.nan, column)


def velocities(
    row: Row, found: Found, name: str, group_heads: list[int], refused: Array
) -> list[Array]:
    """Velocities of the bodies, m/s, [body][member]."""
    shape = row.system.shape
    own = [found[name, s].reshape(shape) for s in group_heads]
    columns = []
    for velocity in body_velocities(row.system, own):
        column = np.broadcast_to(velocity, shape).ravel()
        columns.append(known(column, refused))
    return columns


# Waves --------------------------------------------------------------------------------


def wave_fields(segments: int) -> list[tuple[str, int]]:
    """What stress and displacement follow from."""
    wanted = [("time", 0), ("frame", 0)]
    for k in range(segments + 1):
        wanted.append(("carried", k))
    for s in range(1, segments + 1):
        wanted.append(("momentum", s))
        wanted.append(("wave_difference", s))
    return wanted


def wave_columns(row: Row, found: Found) -> dict[str, Array]:
    """Displacement of each body, m, and the largest stress in each rod, Pa."""
    columns: dict[str, Array] = {}
    for i, body in enumerate(row.system.bodies):
        first, last = row.spans[i]
        if last == 0:  # a wall, which moves on
            columns[f"displacement.{i}"] = row.of(body.velocity) * found["time", 0]
        else:
            columns[f"displacement.{i}"] = displacement(row, found, first, last)
            columns[f"largest_stress.{i}"] = largest_stress(row, found, first, last)
    return columns


def displacement(row: Row, found: Found, first: int, last: int) -> Array:
    """How far the centre of a rod has moved, m: Newton's law, integrated twice."""
    mass: Array | float = 0.0
    momentum: Array | float = 0.0
    for s in range(first, last + 1):
        mass = mass + row.of(row.segments[s - 1].mass)
        momentum = momentum + found["momentum", s]
    time = found["time", 0]
    pushed = found["carried", first - 1] - found["carried", last]
    moved: Array = found["frame", 0] * time + (momentum * time + pushed) / mass
    return moved


def largest_stress(row: Row, found: Found, first: int, last: int) -> Array:
    """Largest absolute stress in a rod, Pa: E/(2 c) times the wave difference."""
    stresses = []
    for s in range(first, last + 1):
        segment = row.segments[s - 1]
        per_wave = segment.material.youngs_modulus / (2 * segment.wave_speed)
        stresses.append(row.of(per_wave) * found["wave_difference", s])
    return reduce(np.maximum, stresses)
