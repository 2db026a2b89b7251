"""Displacement of a body's centre of mass over a run, from the forces on its faces."""

from typing import NamedTuple

from ..methods.run import INWARD, Run
from ..methods.signals import Pieces
from .fields import Fields


class FacePushes(NamedTuple):
    """Forces on the two faces of a body, N; None at a free end.

    Compression is positive.
    """

    left: Pieces | None
    right: Pieces | None


def final_displacement(run: Run, fields: Fields, body: int) -> float:
    """Displacement of the centre of mass of a body at the end of the run, m.

    Newton's law integrated twice: m u = p0 t + integral(J) dt + m g t^2/2, p0 the
    momentum at t = 0 and J the impulse of the forces on the two faces. A wall or a
    rigid mass moves as one point, so that its displacement is that of any point.
    """
    clock = fields.clock
    last_tick = fields.end
    time = last_tick * clock.tick
    if body not in fields.rods:
        return float(fields.displacement(body, 0.0, time))
    impulse_integral = 0.0  # N s^2
    # A push acts to the right on the left face (1), to the left on the right (-1).
    for push, sign in zip(pushes_on(run, body), INWARD, strict=True):
        if push is not None:
            in_ticks = float(push.integrated_twice(last_tick))  # N ticks^2
            impulse_integral += sign * in_ticks * clock.tick * clock.tick
    mass = clock.mass(body)
    start_velocity = float(fields.momentum(body, 0.0) / mass)
    by_gravity = float(clock.system.gravity) * time * time / 2
    return start_velocity * time + impulse_integral / mass + by_gravity


def pushes_on(run: Run, body: int) -> FacePushes:
    """Forces on the left and the right face of a body.

    Each is the force of a contact, or of an end of the row.
    """
    signals = run.signals
    # What acts on the ends of the row: a wall, a drive or an absorbing end, or None.
    left_action, right_action = signals.boundary_actions
    left = None
    right = None
    # Contact k lies between the bodies k and k + 1.
    if body > 0:
        left = signals.contacts[body - 1].force
    elif left_action is not None:
        left = left_action.push
    if body < len(signals.contacts):
        right = signals.contacts[body].force
    elif right_action is not None:
        right = right_action.push
    return FacePushes(left, right)
