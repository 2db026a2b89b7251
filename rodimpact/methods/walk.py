"""The one walk through a system: what stands in the row, as flat lists, and its scales.

The page has this as JavaScript, where a system is a table of tables with the same names.
"""

from typing import Any, NamedTuple

import numpy as np

from ..model.profiles import extremes
from .laws import Law
from .link import link_of, link_of_contact

ENDS = {
    "free": "none",
    "fixed": "velocity",
    "velocity": "velocity",
    "force": "force",
    "absorbing": "absorbing",
    "incoming": "absorbing",
}
"""What is outside the ends of a row, by their kind."""


class Walk(NamedTuple):
    """What stands in a row, as the attributes of `row.Row`."""

    system: Any
    segments: list[Any]
    paths: list[str]
    spans: list[tuple[int, int]]
    first: list[int]
    masses: list[Any]
    mass_velocity: list[Any]
    mass_of: list[int]
    links: list[Any]
    contact_link: list[int]
    outside: list[tuple[str, Any]]


def walk(system: Any) -> Walk:
    """Walk through a system from left to right."""
    bodies, last = system.bodies, len(system.bodies) - 1
    row = Walk(
        system, [], [""], [], [0], [], [], [], [], [], [("none", 0.0), ("none", 0.0)]
    )
    rods = [body.kind == "rod" for body in bodies]
    # rigid bodies that are bonded together are one block
    for block in parted(
        [
            law.law != "bonded" or rods[i] or rods[i + 1]
            for i, law in enumerate(system.contacts)
        ]
    ):
        i, body = block[0], bodies[block[0]]
        if i > 0:
            row.contact_link.append(len(row.links))
            link = link_of_contact(system.contacts[i - 1], system.gaps[i - 1])
            row.links.append(link)
        elif body.kind != "wall":
            add_end(row, 0, system.ends[0])
        if body.kind == "rod":
            add_rod(row, f"bodies.{i}", body)
        else:
            add_rigid(row, bodies, block)
    if bodies[last].kind != "wall":
        add_end(row, 1, system.ends[1])
    row.first.append(len(row.masses))
    for i, body in enumerate(bodies):
        if row.mass_of[i] < 0 and body.kind == "mass":  # bonded to a wall
            row.mass_of[i] = len(row.masses) + (1 if any(rods[:i]) else 0)
    return row


def parted(cuts: list[bool]) -> list[list[int]]:
    """Bodies from left to right, parted at the contacts for which that is said."""
    found = [[0]]
    for i, cut in enumerate(cuts):
        if cut:
            found.append([])
        found[-1].append(i + 1)
    return found


def add_rigid(row: Walk, bodies: Any, block: list[int]) -> None:
    """Add a block of rigid bodies: one mass, or what stands outside if there is a wall in it."""
    row.contact_link.extend([-1 for _ in block[1:]])
    row.spans.extend([(1, 0) for _ in block])
    walls = [i for i in block if bodies[i].kind == "wall"]
    row.mass_of.extend([-1 if len(walls) > 0 else len(row.masses) for _ in block])
    for i in walls:
        row.outside[0 if i == 0 else 1] = ("velocity", bodies[i].velocity)
    if len(walls) > 0:
        return
    mass, velocity = bodies[block[0]].mass, bodies[block[0]].velocity
    for i in block[1:]:
        momentum = mass * velocity + bodies[i].mass * bodies[i].velocity
        mass = mass + bodies[i].mass
        velocity = momentum / mass
    row.masses.append(mass)
    row.mass_velocity.append(velocity)


def add_rod(row: Walk, path: str, rod: Any) -> None:
    """Add the segments of a rod, bonded to each other."""
    row.mass_of.append(-1)
    row.spans.append((len(row.segments) + 1, len(row.segments) + len(rod.segments)))
    for j, segment in enumerate(rod.segments):
        if j > 0:
            row.links.append(link_of(Law.BOND))
        row.segments.append(segment)
        row.paths.append(f"{path}.segments.{j}" if len(rod.segments) > 1 else path)
        row.first.append(len(row.masses))


def add_end(row: Walk, side: int, end: Any) -> None:
    """Add the link at an end of the row."""
    kind = ENDS[end.kind]
    driven = end.kind in ("velocity", "force", "incoming")
    row.outside[side] = (kind, end.value if driven else 0.0)
    push = Law.PUSH_RIGHT if side > 0 else Law.PUSH_LEFT
    is_pushed = kind in ("none", "force")
    row.links.append(link_of(push if is_pushed else Law.BOND))


# Scales: in a family numbers are arrays, so nothing here is decided by one of them ----------------


def largest(values: Any) -> Any:
    """Largest of some numbers, for each member of a family."""
    found = values[0]
    for value in values[1:]:
        single = isinstance(value, float) and isinstance(found, float)
        found = max(found, value) if single else np.maximum(found, value)
    return found


def smallest(values: Any) -> Any:
    """Smallest of some numbers, for each member of a family."""
    return -largest([-value for value in values])


def velocities_of(row: Any) -> list[Any]:
    """Velocities of all that moves at t = 0 or is moved, m/s."""
    given = [body.velocity for body in row.system.bodies if body.kind != "mass"]
    driven = [value for kind, value in row.outside if kind == "velocity"]
    return [
        *row.mass_velocity,
        *[v for speed in [*given, *driven] for v in extremes(speed)],
    ]


def frame_of(row: Any) -> Any:
    """Velocity of the frame, m/s: that of the walls, else the middle of all velocities."""
    walls = [body.velocity for body in row.system.bodies if body.kind == "wall"]
    if len(walls) == 0:
        velocities = velocities_of(row)
        return smallest(velocities) / 2 + largest(velocities) / 2
    return sum(walls) / len(walls)


def wave_of_strain(row: Any, side: int) -> Any:
    """The wave that comes in through an end is this, m/s, times its strain."""
    return (4 * side - 2) * row.segments[side * (len(row.segments) - 1)].wave_speed


def least_impedance(row: Any) -> Any:
    """Smallest impedance, kg/s."""
    return smallest(
        [s.material.density * s.wave_speed * extremes(s.area)[0] for s in row.segments]
    )


def scale_of(row: Any) -> Any:
    """Scale of velocities of a row with rods, m/s: what is given, and what forces make of it."""
    strained, pushed, velocities = [0.0], [0.0], velocities_of(row)
    for body in row.system.bodies:
        if body.kind == "rod":
            c = largest([s.wave_speed for s in body.segments])
            strained.extend([c * abs(e) for e in extremes(body.strain)])
    for side, (kind, value) in enumerate(row.outside):
        if kind == "force":
            pushed.extend([abs(F) for F in extremes(value)])
        elif kind == "absorbing":
            strained.extend(
                [abs(e * wave_of_strain(row, side)) for e in extremes(value)]
            )
    for it in row.links:
        if it.law == Law.JOINT:
            pushed.append(abs(it.stiffness * it.stretch))
        elif it.law >= Law.SPRING:  # it may be given with an overlap
            pushed.append(it.stiffness * np.maximum(0.0 - it.gap, 0.0) ** it.exponent)
    fall = abs(row.system.gravity) * largest([s.transit_time for s in row.segments])
    spread = largest(velocities) - smallest(velocities)
    return spread + largest(strained) + largest(pushed) / least_impedance(row) + fall
