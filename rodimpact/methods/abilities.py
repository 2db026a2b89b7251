"""Physics that not every method has: where a system has it, by path and name.

No method can prove a collision final where something acts on and on from outside.
"""

from typing import Any

from .. import model
from ..model.frozen import vanishes

MASSES, COMPLIANCE, GRAVITY = "rigid masses", "compliant contacts", "gravity"
JOINTS, OWN_LAWS = "joints", "laws given as a Python function"
SMOOTH_STATES, SMOOTH_DRIVES = "profiles other than steps", "drives other than steps"
DAMPING, LATERAL, TAPER = "damping", "lateral inertia", "tapered rods"
RODLESS = "rows without a rod"
OF_LAWS = {
    "joint": JOINTS,
    "own": OWN_LAWS,
}  # that are no compliant contacts of the package's own
SINGLE = (
    GRAVITY,
    DAMPING,
    LATERAL,
)  # which one entry of a rod or of the system switches on


def needs(system: model.System) -> list[tuple[str, str]]:
    """Path and name of all the physics of a system that not every method has."""
    found = [] if vanishes(system.gravity) else [("gravity", GRAVITY)]
    if not any(isinstance(body, model.Rod) for body in system.bodies):
        found.append(("bodies", RODLESS))
    for i, body in enumerate(system.bodies):
        if isinstance(body, model.RigidMass):
            found.append((f"bodies.{i}", MASSES))
        elif isinstance(body, model.Rod):
            found += [(f"bodies.{i}.{where}", what) for where, what in _of_rod(body)]
    found += [
        (f"contacts.{i}.law", OF_LAWS.get(law.law, COMPLIANCE))
        for i, law in enumerate(system.contacts)
        if law.law not in ("rigid", "bonded")
    ]
    found += [
        (f"ends.{side}.value", SMOOTH_DRIVES)
        for side, end in zip(model.SIDES, system.ends, strict=True)
        if isinstance(getattr(end, "value", None), model.Samples)
    ]
    return found


def _of_rod(rod: model.Rod) -> list[tuple[str, str]]:
    states = {"velocity": rod.velocity, "strain": rod.strain}
    found = [
        (name, SMOOTH_STATES)
        for name, v in states.items()
        if isinstance(v, model.Samples | model.Polynomials)
    ]
    for j, segment in enumerate(rod.segments):
        place = f"segments.{j}." if len(rod.segments) > 1 else ""
        if not vanishes(segment.material.viscosity):
            found.append((f"{place}material.viscosity", DAMPING))
        if segment.lateral_inertia is not None:
            found.append((f"{place}lateral_inertia", LATERAL))
        if segment.tapered:
            found.append((f"{place}area", TAPER))
    return found


def driven(system: Any) -> bool:
    """Whether forces from outside act: no bound says when the last contact is over.

    The page has this as JavaScript.
    """
    kinds = [each.kind for each in (*system.bodies, *system.ends)]
    held = any(kind in ("wall", "fixed", "absorbing") for kind in kinds)
    pushed = any(kind in ("force", "velocity", "incoming") for kind in kinds)
    return pushed or (held and not vanishes(system.gravity))
