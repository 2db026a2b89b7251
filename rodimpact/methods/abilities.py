"""Physics that not every method has: where a system has it, by path and name.

No method can prove a collision final where something acts on and on from outside.
"""

from __future__ import annotations

from ..model import (
    Bonded,
    Free,
    Incoming,
    Joint,
    Law,
    Moved,
    Pushed,
    Rigid,
    RigidMass,
    Rod,
    Samples,
    System,
    Wall,
)
from ..model.frozen import InvalidModel, vanishes

MASSES, COMPLIANCE, GRAVITY = "rigid masses", "compliant contacts", "gravity"
JOINTS, OWN_LAWS = "joints", "laws given as a Python function"
SMOOTH_STATES, SMOOTH_DRIVES = "profiles other than steps", "drives other than steps"
DAMPING, LATERAL, TAPER = "damping", "lateral inertia", "tapered rods"
RODLESS = "rows without a rod"
SINGLE = (GRAVITY, DAMPING, LATERAL)  # which one entry of a rod or of the system switches on
_DRIVEN = (Pushed, Moved, Incoming)


def needs(system: System) -> list[tuple[str, str]]:
    """Path and name of all the physics of a system that not every method has."""
    found = [] if vanishes(system.gravity) else [("gravity", GRAVITY)]
    if not any(isinstance(body, Rod) for body in system.bodies):
        found.append(("bodies", RODLESS))
    for i, body in enumerate(system.bodies):
        if isinstance(body, RigidMass):
            found.append((f"bodies.{i}", MASSES))
        elif isinstance(body, Rod):
            found += [(f"bodies.{i}.{where}", what) for where, what in _of_rod(body)]
    for i, law in enumerate(system.contacts):
        if not isinstance(law, (Rigid, Bonded)):
            what = JOINTS if isinstance(law, Joint) else COMPLIANCE
            what = OWN_LAWS if isinstance(law, Law) else what
            found.append((f"contacts.{i}.law", what))
    for side, end in zip(("left", "right"), system.ends, strict=True):
        if isinstance(end, _DRIVEN) and isinstance(end.value, Samples):
            found.append((f"ends.{side}.value", SMOOTH_DRIVES))
    return found


def _of_rod(rod: Rod) -> list[tuple[str, str]]:
    states = {"velocity": rod.velocity, "strain": rod.strain}
    found = [(name, SMOOTH_STATES) for name, v in states.items() if isinstance(v, Samples)]
    for j, segment in enumerate(rod.segments):
        place = f"segments.{j}." if len(rod.segments) > 1 else ""
        if not vanishes(segment.material.viscosity):
            found.append((f"{place}material.viscosity", DAMPING))
        if segment.lateral_inertia is not None:
            found.append((f"{place}lateral_inertia", LATERAL))
        if segment.tapered:
            found.append((f"{place}area", TAPER))
    return found


def driven(system: System) -> bool:
    """Whether forces from outside act: no bound says when the last contact is over."""
    left, right = system.ends
    if isinstance(left, _DRIVEN) or isinstance(right, _DRIVEN):
        return True
    if vanishes(system.gravity):
        return False
    walls = isinstance(system.bodies[0], Wall) or isinstance(system.bodies[-1], Wall)
    return walls or not (isinstance(left, Free) and isinstance(right, Free))


def require_end(system: System, until: float | None) -> None:
    """Raise InvalidModel where a run has no time to be reached, and no proof to run to."""
    if until is None and driven(system):
        message = "must be given: where gravity or drives act, there is no last contact to wait for"
        raise InvalidModel([("until", message)])
