"""What happens at a node: its contact law, its force, and what the force has done.

In a uniform segment the velocity is v = (a + b)/2, with the wave a travelling to the
right and b to the left. At a node a arrives from the left and b from the right; Y1 and
Y2 are the mobilities 1/Z of the two segments. A force F that presses them apart sends
out the waves a' = b + 2 F Y2 to the right and b' = a - 2 F Y1 to the left.
"""

import math
from typing import Any

from ..laws import Status
from .records import CHANGE, IDLE, NEVER, NONE, Front, Node, Run


def reset(node: Node, zero: Any) -> None:
    """Set a node to t = 0; its kind and its gap are given."""
    node.status = Status.OPEN.value if node.gap > 0 else node.kind
    node.solved = 0
    node.gap_rate = zero
    node.force = zero
    node.face_velocity = zero
    node.impulse = zero
    node.moment = zero
    node.work = zero
    node.peak_force = zero
    node.force_began = NONE
    node.force_ended = NONE
    node.opened = NONE
    node.pressed = 0
    node.episodes = 0


def resolve_contact(
    node: Node, closing: Any, dt: int, tolerance: Any, window: int
) -> int:
    """Decide a contact after arrivals; return its new status.

    Signorini: gap >= 0, force >= 0, and one of them is 0. The closed contact carries
    F = max(0, (a - b)/(Y1 + Y2)), and its gap rate is exactly 0. Its gap and gap rate
    are brought up to date.

    Parameters
    ----------
    node : Node
    closing : float
        a - b, the velocity at which the gap would close without a force.
    dt : int
        Ticks since the node was solved last.
    tolerance : float
        Velocity that counts as none.
    window : int
        A gap that would close within so many ticks closes now.
    """
    gap = node.gap + node.gap_rate * dt
    status: int = node.status
    if status == Status.OPEN and gap <= max(-node.gap_rate, closing) * window:
        gap = 0 * gap
        status = Status.TOUCH.value
    if status != Status.OPEN:
        if closing > tolerance:
            status = Status.PRESS.value
        elif closing < -tolerance:
            status = Status.OPEN.value
        elif status == Status.PRESS:
            status = Status.GRAZE.value
    node.gap = gap
    node.gap_rate = 0 * closing
    if status == Status.OPEN and abs(closing) > tolerance:
        node.gap_rate = -closing
    return status


def record_change(
    run: Run, node: Node, row: Front, k: int, tick: int, status: int
) -> None:
    """Change the status of contact k, and enter that in a row of the log.

    From OPEN to OPEN it touches without a force.
    """
    before = node.status
    node.status = status
    if status == Status.PRESS:
        if before != Status.GRAZE:
            node.episodes += 1
        if node.force_began == NONE:
            node.force_began = tick
        run.proof_tick = IDLE  # nothing is proved before the force ends
    else:
        run.proof_tick = min(run.proof_tick, tick)
        if before == Status.PRESS:
            node.force_ended = tick
        if status == Status.OPEN and before >= Status.GRAZE:
            node.opened = tick
    row.tick = tick
    row.line = CHANGE
    row.next_row = k
    row.value = status


def accumulate(node: Node, dt: int, window: int) -> None:
    """Add what the force did in the `dt` ticks since the node was solved last."""
    if node.force != 0:
        impulse = node.force * dt
        node.impulse += impulse
        node.moment += impulse * (node.solved + dt / 2)
        node.work += node.force * node.face_velocity * dt
        if dt > window:
            node.peak_force = max(node.peak_force, node.force)
    if node.status == Status.PRESS:
        node.pressed += dt


def closing_tick(node: Node, tick: int, due: int, window: int) -> int:
    """Tick at which an open contact is solved next: its gap closes, or a wave arrives.

    Parameters
    ----------
    node : Node
    tick : int
        Now.
    due : int
        When a wave arrives.
    window : int
        A gap that closes so shortly before an arrival waits for it.
    """
    if node.gap < -node.gap_rate * (NEVER - tick):
        ticks = (2 * node.gap - node.gap_rate) / (-2 * node.gap_rate)  # gap/speed + 1/2
        closes: int = tick + math.trunc(ticks)
        if closes + window < due:
            return closes
    return due
