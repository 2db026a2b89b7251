"""Which physics each method has: what keeps one from solving a system, and which one can.

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
from ..model.frozen import InvalidModel, Problems

Found = Iterator[tuple[str, str]]

TAPERS = "tapered rods"


def _masses(system: System) -> Found:
    for i, body in enumerate(system.bodies):
        if isinstance(body, RigidMass):
            yield f"bodies.{i}", "rigid masses"


def _compliance(system: System) -> Found:
    for i, law in enumerate(system.contacts):
        if not isinstance(law, Rigid | Bonded):
            yield f"contacts.{i}.law", "compliant contacts"


def _gravity(system: System) -> Found:
    if np.any(system.gravity):
        yield "gravity", "gravity"


def _smooth_states(system: System) -> Found:
    for i, body in enumerate(system.bodies):
        if isinstance(body, Rod):
            for name in ("velocity", "strain"):
                if isinstance(getattr(body, name), Samples):
                    yield f"bodies.{i}.{name}", "profiles other than steps"


def _smooth_drives(system: System) -> Found:
    for side, end in zip(("left", "right"), system.ends, strict=True):
        if isinstance(end, Pushed | Moved) and isinstance(end.value, Samples):
            yield f"ends.{side}.value", "drives other than steps"


def _segments(system: System) -> Iterator[tuple[str, Segment]]:
    for i, body in enumerate(system.bodies):
        segments = body.segments if isinstance(body, Rod) else ()
        for j, segment in enumerate(segments):
            place = f".segments.{j}" if len(segments) > 1 else ""
            yield f"bodies.{i}{place}", segment


def _damping(system: System) -> Found:
    for path, segment in _segments(system):
        if np.any(segment.material.viscosity):
            yield f"{path}.material.viscosity", "damping"


def _lateral(system: System) -> Found:
    for path, segment in _segments(system):
        if segment.polar_moment is not None:
            yield f"{path}.polar_moment", "lateral inertia"


def _taper(system: System) -> Found:
    for path, segment in _segments(system):
        if segment.tapered:
            yield f"{path}.area", TAPERS


LACKS: dict[str, tuple[Callable[[System], Found], ...]] = {
    "fronts": (
        _masses, _compliance, _gravity, _smooth_states, _smooth_drives, _damping, _lateral, _taper,
    ),
    "characteristics": (_damping, _lateral, _taper),
    "finite-difference": (),
}
"""Methods in the order in which ``"auto"`` tries them, with the physics that each lacks."""


def lacking(method: str, system: System) -> list[tuple[str, str]]:
    """Path and name of everything in the system that the method cannot do."""
    return [found for feature in LACKS[method] for found in feature(system)]


def refuse(method: str, system: System) -> None:
    """Raise InvalidModel where the method lacks something, and name a method that has it."""
    missing = lacking(method, system)
    if missing:
        remedy = f'method "{choose(system)}" has'
        if all(what == TAPERS for _, what in missing):
            remedy += ", or give rod.in_steps(n)"
        problems: Problems = [
            (path, f'method "{method}" has no {what}; {remedy}') for path, what in missing
        ]
        raise InvalidModel(problems)


def choose(system: System, first: int = 0) -> str:
    """First method that can do the job, from the one at place `first` on; the last can do any."""
    return next(method for method in list(LACKS)[first:] if not lacking(method, system))


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
