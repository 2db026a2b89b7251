"""Whether waves jump: with jumps, errors fall more slowly as the mesh is refined.

Waves jump where flat ends meet, where a given profile or drive jumps, and at t = 0
where two joined bodies have different velocities or different forces.
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

JUMP_ORDER = 0.5
"""Power of the step with which errors fall if waves jump and stay steep."""
SMALL_JUMP_RTOL = 1e-6
"""Jumps smaller than this, relative to the scale of velocities, are ignored."""


class Face(NamedTuple):
    """State of one end of a body at t = 0."""

    velocity: float  # m/s
    force: float | None  # tension, N; None in a rigid body, which takes any force


def order_of(row: Row) -> float:
    """Power of the step with which errors fall at least.

    It is `JUMP_ORDER` if waves jump and stay steep, else 1. Jumps become smooth if all
    segments are viscous.
    """
    if all(float(segment.material.viscosity) > 0 for segment in row.segments):
        return 1.0
    if waves_jump(row):
        return JUMP_ORDER
    return 1.0


def waves_jump(row: Row) -> bool:
    """Whether any wave may jump, at t = 0 or later.

    A wave may jump if the velocity or strain of a body is given by steps or by
    polynomials, if the value given at an end jumps in time, if the force of a contact
    jumps as it closes (as between flat ends), if velocities or forces of neighbours
    differ at t = 0, or if a rod of several segments is strained at t = 0.
    """
    system = row.system
    for body in system.bodies:
        for name in ("velocity", "strain"):
            profile = getattr(body, name, 0.0)  # 0 where a body has none
            # Polynomials along a rod come from the state of an earlier run, which may
            # have jumps.
            if isinstance(profile, Steps | Polynomials):
                return True
    for end in system.ends:
        if jumps_inside(getattr(end, "value", 0.0)):  # in time; 0 for an end without
            return True
    for law in system.contacts:
        if law.opens and not law.begins_from_zero:  # its force jumps as it closes
            return True
    return (
        _jumps_between_bodies(row)
        or _jumps_at_ends(row)
        or _strain_jumps_between_segments(row)
    )


def _jumps_between_bodies(row: Row) -> bool:
    """Whether waves jump at t = 0 between two neighbouring bodies.

    They do if bonded bodies differ in velocity or force, or if the force in a face
    differs from the force of the joint or contact there. The force of a contact without
    overlap is 0; a contact with an overlap always makes a jump, as it presses at once.
    A rigid body takes any force, so it never differs in force.
    """
    system = row.system
    for k, (left_body, right_body) in enumerate(pairwise(system.bodies)):
        law = system.contacts[k]
        left = _face(left_body, index=-1)  # the right end of the left body
        right = _face(right_body, index=0)  # the left end of the right body
        if isinstance(law, Bonded):
            if _differ(row, left.velocity, right.velocity):
                return True
            # The force is None in a rigid body on the left; `_forces_differ` checks for
            # a rigid body on the right.
            if left.force is not None and _forces_differ(row, right, left.force):
                return True
        elif isinstance(law, Joint):
            rate = right.velocity - left.velocity
            # Tension in the joint, N: forces of faces are tensions, too.
            force = float(law.stiffness * law.stretch + law.damping * rate)
            left_differs = _forces_differ(row, left, force)
            right_differs = _forces_differ(row, right, force)
            if left_differs or right_differs:
                return True
        else:  # a contact
            has_overlap = float(system.gaps[k]) < 0
            if has_overlap:
                return True
            left_is_loaded = _forces_differ(row, left, force=0.0)
            right_is_loaded = _forces_differ(row, right, force=0.0)
            if left_is_loaded or right_is_loaded:
                return True
    return False


def _jumps_at_ends(row: Row) -> bool:
    """Whether the condition at an end of the row differs at t = 0 from the body there.

    A free end demands the force 0, a fixed end the velocity 0, a moved or pushed end
    the first given velocity or force. An incoming wave jumps if it does not begin with
    0. Any other end, as an absorbing one without a wave, never differs.
    """
    bodies = row.system.bodies
    left = _face(bodies[0], index=0)
    right = _face(bodies[-1], index=-1)
    faces = (left, right)  # of the outer bodies, at the ends of the row
    for face, end in zip(faces, row.system.ends, strict=True):
        if isinstance(end, Free):
            differs = _forces_differ(row, face, force=0.0)
        elif isinstance(end, Fixed):
            differs = _differ(row, face.velocity, 0.0)
        elif isinstance(end, Moved):
            first_velocity = _value(end.value, index=0)
            differs = _differ(row, face.velocity, first_velocity)
        elif isinstance(end, Pushed):
            # A push > 0 compresses, and the force of a face is a tension.
            first_push = _value(end.value, index=0)
            differs = _forces_differ(row, face, -first_push)
        elif isinstance(end, Incoming):
            first_strain = _value(end.value, index=0)
            differs = first_strain != 0
        else:
            differs = False
        if differs:
            return True
    return False


def _strain_jumps_between_segments(row: Row) -> bool:
    """Whether any rod of several segments has a strain at t = 0.

    The stiffness jumps between segments, and so does the force of a strain. Rods of one
    segment are not checked.
    """
    for body in row.system.bodies:
        if not isinstance(body, Rod) or len(body.segments) == 1:
            continue
        smallest, largest = extremes(body.strain)
        is_strained = smallest != 0 or largest != 0
        if is_strained:
            return True
    return False


def _face(body: Any, index: int) -> Face:
    """State of the left (`index` 0) or right (-1) end of a body at t = 0.

    The force is E A strain; it is None for a rigid body or a wall.
    """
    velocity = _value(body.velocity, index)
    if not isinstance(body, Rod):
        return Face(velocity, force=None)
    segment = body.segments[index]
    modulus = float(segment.material.youngs_modulus)
    # E A strain
    force = modulus * _value(segment.area, index) * _value(body.strain, index)
    return Face(velocity, force)


def _value(profile: Any, index: int) -> float:
    """First (`index` 0) or last (-1) value of samples or polynomials.

    A number is returned as it is.
    """
    if isinstance(profile, Samples | Polynomials):
        return float(profile.values[index])
    return float(profile)


def _differ(row: Row, left: float, right: float) -> bool:
    """Whether two velocities, m/s, differ by more than a negligible jump.

    That is `SMALL_JUMP_RTOL` times the scale of velocities of the row.
    """
    return abs(left - right) > SMALL_JUMP_RTOL * float(row.scale)


def _forces_differ(row: Row, face: Face, force: float) -> bool:
    """Whether a force, N, differs from the force in a face by more than a small jump.

    Both are tensions. The result is False for a rigid body, which takes any force. The
    negligible jump is `SMALL_JUMP_RTOL` times the largest impedance of the row times
    its scale of velocities. A row on a grid has at least one segment.
    """
    if face.force is None:
        return False
    impedances = []  # of the segments, kg/s
    for segment in row.segments:
        impedances.append(float(segment.mass / segment.transit_time))
    negligible = SMALL_JUMP_RTOL * max(impedances) * float(row.scale)
    return abs(face.force - force) > negligible
