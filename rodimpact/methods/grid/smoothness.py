"""Whether waves jump: a mesh finds a jump more slowly than what is smooth.

Waves jump where flat ends meet, where something that is given jumps, and at t = 0 where
two bodies that are joined move with different velocities or press with different
forces.
"""

from itertools import pairwise
from typing import Any, NamedTuple

from ...model import (
    Bonded,
    Fixed,
    Free,
    Incoming,
    Joint,
    Moved,
    Polynomials,
    Pushed,
    Rod,
    Samples,
    Steps,
)
from ...model.profiles import extremes, jumps_inside
from ..row import Row

SMALL_JUMP_RTOL = 1e-6
"""A jump of less, relative to the scale of velocities, is none."""


class Face(NamedTuple):
    """State of one end of a body at t = 0."""

    velocity: float  # m/s
    force: float | None  # tension, N; None in a rigid body, which takes any force


def order_of(row: Row) -> float:
    """Power of the step with which errors fall at least.

    It is 1/2 where waves jump and stay steep, else 1. Jumps become smooth where all
    segments are viscous.
    """
    if all(float(segment.material.viscosity) > 0 for segment in row.segments):
        return 1.0
    if waves_jump(row):
        return 0.5
    return 1.0


def waves_jump(row: Row) -> bool:
    """Whether any wave may jump, from t = 0 on or later on.

    A wave may jump if velocity or strain of a body is given by steps or by polynomials,
    if what is given at an end jumps in time, if the force of a contact jumps as it
    closes, as between flat ends, or if neighbours do not fit at t = 0.
    """
    system = row.system
    for body in system.bodies:
        for name in ("velocity", "strain"):
            profile = getattr(body, name, 0.0)  # 0 where a body has none
            # Polynomials along a rod are a state of an earlier run, which may jump.
            if isinstance(profile, Steps | Polynomials):
                return True
    for end in system.ends:
        if jumps_inside(getattr(end, "value", 0.0)):  # in time
            return True
    for law in system.contacts:
        if law.opens and not law.begins_from_zero:  # its force jumps as it closes
            return True
    return _jumps_between_bodies(row) or _jumps_at_ends(row) or _jumps_at_steps(row)


def _jumps_between_bodies(row: Row) -> bool:
    """Whether waves jump at t = 0 between two neighbours.

    They do where bonded bodies differ in velocity or in force, and where the force of a
    face is not that of the joint or contact there, which is 0 without overlap. A
    contact with an overlap always makes a jump, as it presses at once. A rigid body
    takes any force.
    """
    system = row.system
    for k, (left_body, right_body) in enumerate(pairwise(system.bodies)):
        law = system.contacts[k]
        left = _face(left_body, -1)  # the right end of the left body
        right = _face(right_body, 0)
        if isinstance(law, Bonded):
            if _differ(row, left.velocity, right.velocity):
                return True
            # None is a rigid body on the left. `_forces_differ` asks for one on the
            # right.
            if left.force is not None and _forces_differ(row, right, left.force):
                return True
        elif isinstance(law, Joint):
            rate = right.velocity - left.velocity
            # Its tension, as forces of faces are tensions
            force = float(law.stiffness * law.stretch + law.damping * rate)
            if _forces_differ(row, left, force) or _forces_differ(row, right, force):
                return True
        else:  # a contact
            has_overlap = float(system.gaps[k]) < 0
            if has_overlap:
                return True
            if _forces_differ(row, left, 0.0) or _forces_differ(row, right, 0.0):
                return True
    return False


def _jumps_at_ends(row: Row) -> bool:
    """Whether what is outside an end of the row differs at t = 0 from the body there.

    It may move or press differently. A free end has no force, a fixed one no velocity,
    a moved or pushed one what is given first; a wave that comes in must begin with 0.
    Any other end, as an absorbing one without a wave, never differs.
    """
    bodies = row.system.bodies
    left = _face(bodies[0], 0)
    right = _face(bodies[-1], -1)
    for face, end in zip((left, right), row.system.ends, strict=True):
        if isinstance(end, Free):
            differs = _forces_differ(row, face, 0.0)
        elif isinstance(end, Fixed):
            differs = _differ(row, face.velocity, 0.0)
        elif isinstance(end, Moved):
            differs = _differ(row, face.velocity, _value(end.value, 0))
        elif isinstance(end, Pushed):
            # A push is a pressure, and the force of a face a tension.
            differs = _forces_differ(row, face, -_value(end.value, 0))
        elif isinstance(end, Incoming):
            differs = _value(end.value, 0) != 0
        else:
            differs = False
        if differs:
            return True
    return False


def _jumps_at_steps(row: Row) -> bool:
    """Whether a rod of several segments is strained at t = 0.

    Its stiffness jumps between segments, so that the force of a strain does.
    """
    for body in row.system.bodies:
        if not isinstance(body, Rod) or len(body.segments) == 1:
            continue
        smallest, largest = extremes(body.strain)
        if smallest != 0 or largest != 0:
            return True
    return False


def _face(body: Any, index: int) -> Face:
    """State of the left (`index` 0) or right (-1) end of a body at t = 0.

    The force E A strain is None for a rigid body or a wall.
    """
    velocity = _value(body.velocity, index)
    if not isinstance(body, Rod):
        return Face(velocity, None)
    segment = body.segments[index]
    modulus = float(segment.material.youngs_modulus)
    # E A strain
    force = modulus * _value(segment.area, index) * _value(body.strain, index)
    return Face(velocity, force)


def _value(profile: Any, index: int) -> float:
    """First (`index` 0) or last (-1) value of samples or polynomials, or a number."""
    if isinstance(profile, Samples | Polynomials):
        return float(profile.values[index])
    return float(profile)


def _differ(row: Row, left: float, right: float) -> bool:
    """Whether two velocities, m/s, differ by more than round-off."""
    return abs(left - right) > SMALL_JUMP_RTOL * float(row.scale)


def _forces_differ(row: Row, face: Face, force: float) -> bool:
    """Whether a force, N, differs from that in a face by more than round-off.

    Both are tensions. False at a rigid body, which takes any force. Round-off is a
    small part of the force that the largest impedance of the row makes of the scale of
    velocities.
    """
    if face.force is None:
        return False
    impedances = []  # kg/s
    for segment in row.segments:
        impedances.append(float(segment.mass / segment.transit_time))
    round_off = SMALL_JUMP_RTOL * max(impedances) * float(row.scale)
    return abs(face.force - force) > round_off
