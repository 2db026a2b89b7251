"""Physics that not every method has, and the entries of a system that need it.

It also finds systems on which forces act from outside all the time: no method can prove
their collisions final.
"""

from typing import Any

from .. import model
from ..model.frozen import vanishes

# Names of physics, as messages say them.
MASSES = "rigid masses"
COMPLIANCE = "compliant contacts"
GRAVITY = "gravity"
JOINTS = "joints"
OWN_LAWS = "laws given as a Python function"
SMOOTH_STATES = "profiles other than steps"
SMOOTH_DRIVES = "drives other than steps"
DAMPING = "damping"
LATERAL = "lateral inertia"
TAPER = "tapered rods"
SOIL = "soil along a shaft"
DRAG = "drag along a shaft"
RODLESS = "rows without a rod"

PHYSICS_OF_LAWS = {"joint": JOINTS, "own": OWN_LAWS}
"""Physics of joints and of laws of the user, by the name of the contact law.

Other laws that are neither rigid nor bonded are COMPLIANCE.
"""
SINGLE = (GRAVITY, DAMPING, LATERAL)
"""Physics that is switched on by a single entry of a rod or of the system."""

Needs = list[tuple[str, str]]
"""Path and name of physics that a system has."""


def needs(system: model.System) -> Needs:
    """List all physics of a system that not every method has: path and name of each.

    These are gravity, a row without a rod, rigid masses, the physics of rods that
    `_needs_of_rod` lists, contact laws other than rigid and bonded, and drives of ends
    that are not in steps. A path is, for example, ``"contacts.0.law"``. The list may be
    empty.
    """
    physics: Needs = []
    if not vanishes(system.gravity):
        physics.append(("gravity", GRAVITY))
    kinds = [body.kind for body in system.bodies]
    if "rod" not in kinds:
        physics.append(("bodies", RODLESS))
    for i, body in enumerate(system.bodies):
        if isinstance(body, model.RigidMass):
            physics.append((f"bodies.{i}", MASSES))
        elif isinstance(body, model.Rod):
            physics += _needs_of_rod(body, f"bodies.{i}")
    for k, law in enumerate(system.contacts):
        if law.law not in ("rigid", "bonded"):
            # The table has joints and laws of the user; other laws are compliant.
            name = PHYSICS_OF_LAWS.get(law.law, COMPLIANCE)
            physics.append((f"contacts.{k}.law", name))
    for side, end in zip(model.SIDES, system.ends, strict=True):
        value = getattr(end, "value", None)  # None for an end without a drive
        if isinstance(value, model.Samples | model.Polynomials):
            name = "value"
            # A moved end may be given by its position; `value` is computed from it.
            if getattr(end, "position", None) is not None:
                name = "position"
            physics.append((f"ends.{side}.{name}", SMOOTH_DRIVES))
    return physics


def _needs_of_rod(rod: model.Rod, path: str) -> Needs:
    """List all physics of a rod that not every method has: path and name of each.

    These are soil or drag along the rod, initial states that are not in steps,
    viscosity, lateral inertia and taper. All paths begin with `path`, the path of the
    rod. Physics of a segment has the path of the segment, or the path of the rod if it
    has a single segment.
    """
    physics: Needs = []
    if rod.shaft is not None:
        if isinstance(rod.shaft, model.Drag):
            along = DRAG
        else:
            along = SOIL
        physics.append((f"{path}.shaft", along))
    for name, profile in (("velocity", rod.velocity), ("strain", rod.strain)):
        if isinstance(profile, model.Samples | model.Polynomials):
            physics.append((f"{path}.{name}", SMOOTH_STATES))
    for j, segment in enumerate(rod.segments):
        segment_path = path
        if len(rod.segments) > 1:
            segment_path = f"{path}.segments.{j}"
        if not vanishes(segment.material.viscosity):
            physics.append((f"{segment_path}.material.viscosity", DAMPING))
        if segment.lateral_inertia is not None:
            physics.append((f"{segment_path}.lateral_inertia", LATERAL))
        if segment.tapered:
            physics.append((f"{segment_path}.area", TAPER))
    return physics


def has_external_drive(system: Any) -> bool:
    """Whether forces act from outside, so that no contact can be proved the last.

    Such forces are drives of ends, soil or drag along a rod, and gravity on a row that
    is held by a wall, a fixed end or a semi-infinite bar. In free fall gravity does not
    affect contacts. The web page has this function as JavaScript.
    """
    is_held = False  # by a wall, a fixed end or a semi-infinite bar
    is_pushed = False  # an end is driven
    for part in (*system.bodies, *system.ends):
        if part.kind in ("wall", "fixed", "absorbing"):
            is_held = True
        elif part.kind in ("pushed", "moved", "incoming"):
            is_pushed = True
    is_pulled = is_held and not vanishes(system.gravity)
    return is_pushed or is_pulled or system.has_shaft
