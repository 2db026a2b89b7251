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

    It is 1/2 where waves jump and stay steep, else 1. Damping makes jumps smooth.
    """
    if all(float(segment.material.viscosity) > 0 for segment in row.segments):
        return 1.0
    if waves_jump(row):
        return 0.5
    return 1.0


def waves_jump(row: Row) -> bool:
    """Whether any wave jumps, from t = 0 on or later on.

    A wave jumps if a profile has steps, if flat ends may meet, or if neighbours do not
    fit at t = 0.
    """
    system = row.system
    for part in (*system.bodies, *system.ends):
        for name in ("velocity", "strain", "value"):
            profile = getattr(part, name, 0.0)  # 0 where a part has none
            if name == "value" and jumps_inside(profile):
                return True
            # Polynomials along a rod are a state of an earlier run, which may jump.
            if name != "value" and isinstance(profile, Steps | Polynomials):
                return True
    for law in system.contacts:
        if law.opens and not law.begins_from_zero:  # its force jumps as it closes
            return True
    return any((_jumps_between_bodies(row), _jumps_at_ends(row), _jumps_at_steps(row)))


def _jumps_between_bodies(row: Row) -> bool:
    """Whether waves jump at t = 0 between two neighbours.

    Bonded bodies must have one velocity and one force. At a joint or a contact
    velocities may differ: each face must have the force of the joint, or none at a
    contact. A contact with an overlap always jumps, as it presses at once.
    """
    system = row.system
    for k, (left_body, right_body) in enumerate(pairwise(system.bodies)):
        law = system.contacts[k]
        left = _face(left_body, -1)  # the right end of the left body
        right = _face(right_body, 0)
        if isinstance(law, Bonded):
            if _differ(row, left.velocity, right.velocity):
                return True
            # A rigid body on the left takes any force;
            # `_forces_differ` asks for one on the right.
            if left.force is not None and _forces_differ(row, right, left.force):
                return True
        else:
            # Tension, as that of a face; a contact without overlap has none
            force = 0.0
            if isinstance(law, Joint):
                rate = right.velocity - left.velocity
                force = float(law.stiffness * law.stretch + law.damping * rate)
            elif float(system.gaps[k]) < 0:
                return True  # it presses from the start
            if _forces_differ(row, left, force) or _forces_differ(row, right, force):
                return True
    return False


def _jumps_at_ends(row: Row) -> bool:
    """Whether what is outside an end differs at t = 0 from the body there.

    It may move or press differently. A free end has no force, a fixed one no velocity,
    a moved or pushed one what is given; a wave that comes in must begin with 0.
    """
    bodies = row.system.bodies
    faces = _face(bodies[0], 0), _face(bodies[-1], -1)
    for face, end in zip(faces, row.system.ends, strict=True):
        if isinstance(end, Free) and _forces_differ(row, face, 0.0):
            return True
        if isinstance(end, Fixed) and _differ(row, face.velocity, 0.0):
            return True
        if isinstance(end, Moved) and _differ(row, face.velocity, _value(end.value, 0)):
            return True
        # A push is a pressure, and the force of a face a tension.
        if isinstance(end, Pushed) and _forces_differ(row, face, -_value(end.value, 0)):
            return True
        if isinstance(end, Incoming) and _value(end.value, 0) != 0:
            return True
    return False


def _jumps_at_steps(row: Row) -> bool:
    """Whether a rod is strained where its stiffness jumps."""
    for body in row.system.bodies:
        if not isinstance(body, Rod) or len(body.segments) == 1:
            continue
        # Rods of several segments are those whose stiffness jumps.
        smallest, largest = extremes(body.strain)
        if smallest != 0 or largest != 0:
            return True
    return False


def _face(body: Any, last: int) -> Face:
    """State of the left or right end of a body at t = 0.

    `last` is 0 for the left end, -1 for the right one.
    """
    velocity = _value(body.velocity, last)
    if not isinstance(body, Rod):
        return Face(velocity, None)
    segment = body.segments[last]
    modulus = float(segment.material.youngs_modulus)
    # E A strain
    force = modulus * _value(segment.area, last) * _value(body.strain, last)
    return Face(velocity, force)


def _value(profile: Any, last: int) -> float:
    """First or last value of a number or of samples.

    `last` is 0 for the first one, -1 for the last one.
    """
    if isinstance(profile, Samples | Polynomials):
        return float(profile.values[last])
    return float(profile)


def _differ(row: Row, left: float, right: float) -> bool:
    """Whether two velocities, m/s, differ by more than round-off."""
    return abs(left - right) > SMALL_JUMP_RTOL * float(row.scale)


def _forces_differ(row: Row, face: Face, force: float) -> bool:
    """Whether a force, N, differs from that in a face by more than round-off.

    A rigid body takes any force.
    """
    if face.force is None:
        return False
    # Impedance, which is mass over transit time, makes a force of a velocity.
    impedance = max(
        float(segment.mass / segment.transit_time) for segment in row.segments
    )
    return abs(face.force - force) > SMALL_JUMP_RTOL * impedance * float(row.scale)
