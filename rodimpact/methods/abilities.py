"""Physics that not every method has: where a system has it, by path and name.

No method can prove a collision final where something acts on and on from outside.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..model import (
    Bonded,
    Free,
    Moved,
    Pushed,
    Rigid,
    RigidMass,
    Rod,
    Samples,
    Segment,
    System,
    Wall,
)
from ..model.frozen import InvalidModel

Places = Iterator[tuple[str, str]]
Feature = Callable[[System], Places]

TAPERS = "tapered rods"


def masses(system: System) -> Places:
    """Rigid masses."""
    for i, body in enumerate(system.bodies):
        if isinstance(body, RigidMass):
            yield f"bodies.{i}", "rigid masses"


def compliance(system: System) -> Places:
    """Contacts that give way."""
    for i, law in enumerate(system.contacts):
        if not isinstance(law, Rigid | Bonded):
            yield f"contacts.{i}.law", "compliant contacts"


def gravity(system: System) -> Places:
    """Gravity."""
    if np.any(system.gravity):
        yield "gravity", "gravity"


def smooth_states(system: System) -> Places:
    """Initial states that are no steps."""
    for i, body in enumerate(system.bodies):
        if isinstance(body, Rod):
            for name in ("velocity", "strain"):
                if isinstance(getattr(body, name), Samples):
                    yield f"bodies.{i}.{name}", "profiles other than steps"


def smooth_drives(system: System) -> Places:
    """Drives that are no steps in time."""
    for side, end in zip(("left", "right"), system.ends, strict=True):
        if isinstance(end, Pushed | Moved) and isinstance(end.value, Samples):
            yield f"ends.{side}.value", "drives other than steps"


def _segments(system: System) -> Iterator[tuple[str, Segment]]:
    for i, body in enumerate(system.bodies):
        segments = body.segments if isinstance(body, Rod) else ()
        for j, segment in enumerate(segments):
            place = f".segments.{j}" if len(segments) > 1 else ""
            yield f"bodies.{i}{place}", segment


def damping(system: System) -> Places:
    """Viscous material."""
    for path, segment in _segments(system):
        if np.any(segment.material.viscosity):
            yield f"{path}.material.viscosity", "damping"


def lateral(system: System) -> Places:
    """Lateral inertia."""
    for path, segment in _segments(system):
        if segment.polar_moment is not None:
            yield f"{path}.polar_moment", "lateral inertia"


def taper(system: System) -> Places:
    """Areas that change along a segment."""
    for path, segment in _segments(system):
        if segment.tapered:
            yield f"{path}.area", TAPERS


def driven(system: System) -> bool:
    """Whether forces from outside act: no bound says when the last contact is over."""
    if any(isinstance(end, Pushed | Moved) for end in system.ends):
        return True
    held = isinstance(system.bodies[0], Wall) or isinstance(system.bodies[-1], Wall) or any(
        not isinstance(end, Free) for end in system.ends
    )
    return held and bool(np.any(system.gravity))


def require_end(system: System, until: float | None) -> None:
    """Raise InvalidModel where a run has no time to be reached, and no proof to run to."""
    if until is None and driven(system):
        message = "must be given: where gravity or drives act, there is no last contact to wait for"
        raise InvalidModel([("until", message)])
