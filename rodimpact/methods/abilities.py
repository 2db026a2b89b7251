"""Physics that not every method has: where a system has it, by path and name.

No method can prove a collision final where something acts on and on from outside.
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
"""Physics of the contact laws that are no compliant contacts of the package's own."""
SINGLE = (GRAVITY, DAMPING, LATERAL)
"""Physics that one entry of a rod or of the system switches on."""

Needs = list[tuple[str, str]]
"""Path and name of physics that a system has."""


def needs(system: model.System) -> Needs:
    """List all physics of a system that not every method has: path and name of each.

    These are gravity, a row without a rod, rigid masses, what `_needs_of_rod` lists,
    the laws of contacts that are neither rigid nor bonded, and drives of ends that are
    no steps. A path is such as ``"contacts.0.law"``. The list may be empty.
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
            # Joints and laws of the user have a name there; others are compliant.
            name = PHYSICS_OF_LAWS.get(law.law, COMPLIANCE)
            physics.append((f"contacts.{k}.law", name))
    for side, end in zip(model.SIDES, system.ends, strict=True):
        value = getattr(end, "value", None)  # None where an end has none
        if isinstance(value, model.Samples | model.Polynomials):
            name = "value"
            # A moved end may be given by its position, from which the value follows.
            if getattr(end, "position", None) is not None:
                name = "position"
            physics.append((f"ends.{side}.{name}", SMOOTH_DRIVES))
    return physics


def _needs_of_rod(rod: model.Rod, path: str) -> Needs:
    """List all physics of a rod that not every method has: path and name of each.

    These are soil or drag along it, initial states that are no steps, viscosity,
    lateral inertia and taper. `path` is that of the rod, with which all paths begin.
    Physics of a segment have the path of the segment, or that of the rod if the segment
    is the only one.
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
    """Whether forces from outside act: no bound says when the last contact is over.

    These are drives of ends, soil or drag along a rod, and gravity on a row that a
    wall, a fixed end or a semi-infinite bar holds; in free fall gravity changes no
    contact. The page of `explorer` has this function as JavaScript.
    """
    is_held = False  # a wall, a fixed end or a semi-infinite bar holds the row
    is_pushed = False  # an end is driven
    for each in (*system.bodies, *system.ends):
        if each.kind in ("wall", "fixed", "absorbing"):
            is_held = True
        elif each.kind in ("pushed", "moved", "incoming"):
            is_pushed = True
    is_pulled = is_held and not vanishes(system.gravity)
    return is_pushed or is_pulled or system.has_shaft
