"""Displacement of a body's centre of mass over a run, from the forces on the body."""

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

    For a rod it follows from Newton's law integrated twice:
    m u = p0 t + (integral of J from 0 to t) + m g t^2/2. Here p0 is the momentum at
    t = 0, and J the impulse of the forces on the two faces, and of soil or drag along
    the shaft, up to a time. The displacement of a wall or a rigid mass is that of any
    of its points, from `fields`.
    """
    clock = fields.clock
    last_tick = fields.end
    time = last_tick * clock.tick
    is_rod = body in fields.rods
    if not is_rod:
        return float(fields.displacement(body, 0.0, time))  # of its only point
    impulse_integral = 0.0  # N s^2
    # `INWARD`: a push acts to the right on the left face (1), and to the left on the
    # right face (-1).
    for push, sign in zip(pushes_on(run, body), INWARD, strict=True):
        if push is not None:
            twice_integrated = float(push.integrated_twice(last_tick))  # N ticks^2
            impulse_integral += sign * twice_integrated * clock.tick * clock.tick
    shaft_action = fields.signals.shafts.get(body)
    if shaft_action is not None:  # its push is positive to the right
        twice_integrated = float(shaft_action.push.integrated_twice(last_tick))
        impulse_integral += twice_integrated * clock.tick * clock.tick
    mass = clock.mass(body)
    start_velocity = float(fields.momentum(body, 0.0) / mass)  # at t = 0
    by_gravity = float(clock.system.gravity) * time * time / 2
    return start_velocity * time + impulse_integral / mass + by_gravity


def pushes_on(run: Run, body: int) -> FacePushes:
    """Forces on the left and the right face of a body, N, positive in compression.

    A contact exerts the force, or at an end of the row a wall, a drive or an absorbing
    end. The force is None at a free end of the row.
    """
    signals = run.signals
    left_action, right_action = signals.boundary_actions  # None at a free end
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
