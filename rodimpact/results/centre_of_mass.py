"""Displacement of a body's centre of mass over a whole run, from the forces on its faces."""

from typing import Any

from ..methods.run import INWARD, Run
from .fields import Fields


def final_displacement(run: Run, fields: Fields, body: int) -> float:
    """Displacement of the centre of mass of a body at the end of the run, m.

    Newton's law integrated twice: m u = p0 t + integral(J) dt + m g t^2/2, p0 the momentum at
    t = 0 and J the impulse of the forces on the two faces. A wall, and a mass, move as one point.
    """
    clock = fields.clock
    time = fields.end * clock.tick
    if body not in fields.rods:
        return float(fields.displacement(body, 0.0, time))
    impulse_integral = 0.0
    for push, sign in zip(pushes_on(run, body), INWARD, strict=True):
        if push is not None:
            integral = float(push.integrated_twice(fields.end))
            impulse_integral += sign * integral * clock.tick * clock.tick
    mass = clock.mass(body)
    start_velocity = float(fields.momentum(body, 0.0) / mass)
    fallen = float(clock.system.gravity) * time * time / 2
    return start_velocity * time + impulse_integral / mass + fallen


def pushes_on(run: Run, body: int) -> tuple[Any, Any]:
    """Forces on the left and the right face of a body, N: `Pieces`, or None at a free end."""
    signals = run.signals
    pushes: list[Any] = [None]
    pushes += [contact.force for contact in signals.contacts]
    pushes.append(None)
    for side, outside in enumerate(signals.boundary_actions):
        if outside is not None:
            pushes[-side] = outside.push
    return pushes[body], pushes[body + 1]
