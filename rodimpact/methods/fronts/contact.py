"""What happens at a node: its contact law, its force, and the effects of the force.

In a uniform segment the velocity is v = (a + b)/2, with the wave a travelling to the
right and b to the left. At a node a arrives from the left and b from the right; Y1 and
Y2 are the mobilities 1/Z of the two segments. A force F that presses them apart sends
out the waves a' = b + 2 F Y2 to the right and b' = a - 2 F Y1 to the left.
"""

import math

from ..states import Status
from .records import CHANGE, IDLE, NEVER, NONE, Amplitude, Front, Node, Run

FAINT_TOLERANCES = 1 << 24
"""Velocity tolerances in the closing velocity of a faint force.

A force that decays as r^n falls below the tolerance from less than tolerance/r. So
every decay with r > 2^-24 passes through faint forces, and with the tolerance of 2^-48
also every smaller r that is no round-off. Other forces end as waves cancel, and do not
pass through faint ones.
"""


def reset_node(node: Node, zero: Amplitude) -> None:
    """Set a node to t = 0: no force, no motion, all totals 0.

    `closed_status` and `gap` are set before, and stay: a node with a gap becomes OPEN,
    any other gets its closed status. `zero` is 0 of the kind of number that is used.
    """
    node.status = Status.OPEN.value if node.gap > 0 else node.closed_status
    node.solved_tick = 0
    node.gap_rate = zero
    node.force = zero
    node.face_velocity = zero
    node.impulse = zero
    node.impulse_moment = zero
    node.work = zero
    node.peak_force = zero
    node.first_force_tick = NONE
    node.last_force_tick = NONE
    node.last_opening_tick = NONE
    node.force_ticks = 0
    node.is_faint = 0
    node.faint_ticks = 0
    node.episodes = 0


def resolve_contact(
    node: Node, closing: Amplitude, dt: int, tolerance: Amplitude, window: int
) -> int:
    """Return the status that a contact has after arrivals.

    Gap and gap rate of the node become those of now; its status and force do not change
    yet. Signorini: gap >= 0, force >= 0, and one of them is 0. So a closed contact
    presses if its faces would close without a force, and opens if they part; if they do
    neither, one that pressed grazes. A gap that closes counts as TOUCH before that. As
    long as the contact is closed, its gap rate is exactly 0.

    Parameters
    ----------
    node : Node
    closing : float
        a - b, the velocity at which the gap would close without a force.
    dt : int
        Ticks since the node was solved last.
    tolerance : float
        A velocity that is not larger counts as 0, m/s.
    window : int
        A gap that would close within so many ticks closes now.
    """
    gap = node.gap + node.gap_rate * dt
    status: int = node.status
    # It closes now if it would do so within the window,
    # at the speed before or after the arrivals.
    if status == Status.OPEN and gap <= max(-node.gap_rate, closing) * window:
        gap = 0 * gap  # 0 of the same kind of number: a float, or a fraction
        status = Status.TOUCH.value
    if status != Status.OPEN:
        if closing > tolerance:
            status = Status.PRESS.value
        elif closing < -tolerance:
            status = Status.OPEN.value
        elif status == Status.PRESS:  # no force is left
            status = Status.GRAZE.value
    node.gap = gap
    node.gap_rate = 0 * closing  # a gap that does not change has exactly this rate
    if status == Status.OPEN and abs(closing) > tolerance:
        node.gap_rate = -closing
    return status


def log_contact_change(
    run: Run,
    node: Node,
    change: Front,
    k: int,
    tick: int,
    status: int,
    mobility: Amplitude,
) -> None:
    """Change the status of the contact at node k, and log the change.

    Of the node, episodes, the ticks of first and last force and of the last opening are
    brought up to date. So is `is_faint`: 1 if it grazes now, and the velocity that its
    last force took away was near round-off. The force is still that before the change.
    Of the run, `next_proof_tick` is set: a proof of finality may be tried from now on,
    or, if the contact presses, only after the next change.

    Parameters
    ----------
    run : Run
    node : Node
    change : Front
        The next free row of the log, which gets the change.
    k, tick : int
        Number of the node, and tick of the change.
    status : int
        The new one; a change from OPEN to OPEN is a touch without a force.
    mobility : float
        Y1 + Y2, s/kg.
    """
    before = node.status
    node.status = status
    node.is_faint = 0
    if before == Status.PRESS and status == Status.GRAZE:
        # The closing velocity that its last force took away
        last_closing = node.force * mobility
        if last_closing <= run.velocity_tolerance * FAINT_TOLERANCES:
            node.is_faint = 1
    if status == Status.PRESS:
        if before != Status.GRAZE:  # grazing belongs to the episode before
            node.episodes += 1
        if node.first_force_tick == NONE:
            node.first_force_tick = tick
        # A proof while a contact presses succeeds only with no front left in flight:
        # `run_to_end` tries that when there are no more events.
        run.next_proof_tick = IDLE
    else:
        run.next_proof_tick = min(run.next_proof_tick, tick)
        if before == Status.PRESS:
            node.last_force_tick = tick
        # Since it closed, see the order of `Status`
        has_pressed = before >= Status.GRAZE
        if status == Status.OPEN and has_pressed:
            node.last_opening_tick = tick
    change.tick = tick
    change.line = CHANGE
    change.next_row = k  # a change has no next row: the field holds its node
    change.value = status


def solve_force(
    node: Node,
    a: Amplitude,
    b: Amplitude,
    left_mobility: Amplitude,
    right_mobility: Amplitude,
    is_left_end: bool,
) -> Amplitude:
    """Set the force of a node and `face_velocity`, the velocity of its left face.

    Where the node presses or is bonded, both faces move alike: F = (a - b)/(Y1 + Y2).
    At an end under a given force, F Y arrives from outside as a wave. Elsewhere there
    is no force.

    Returns
    -------
    float
        a, the velocity of the left face without the force, m/s. At a pushed left end,
        which has no left segment, a + b, the velocity of the end.
    """
    force = 0 * a  # 0 of the same kind of number
    force_free_velocity = a
    if node.status == Status.PRESS or node.status == Status.BOND:
        force = (a - b) / (left_mobility + right_mobility)
    elif node.status == Status.PUSH:
        if is_left_end:
            # The wave from outside is a = F Y2, and the end has the velocity b + F Y2.
            force = a / right_mobility
            force_free_velocity = a + b
        else:
            force = b / left_mobility
    node.force = force
    node.face_velocity = force_free_velocity - force * left_mobility
    return force_free_velocity


def accumulate_contact_totals(node: Node, dt: int, window: int) -> None:
    """Add the effects of the force in the `dt` ticks since the node was solved last.

    These are impulse, its moment integral(F t dt), work, peak force, the ticks with
    status PRESS, and those of grazing after a faint force. A force that lasts no more
    than `window` ticks is left out of the peak. `solved_tick` stays as it is.
    """
    if node.force != 0:
        impulse = node.force * dt
        node.impulse += impulse
        node.impulse_moment += impulse * (node.solved_tick + dt / 2)  # mean time
        node.work += node.force * node.face_velocity * dt
        # A shorter force comes from waves that
        # meet at one tick, but for their rounding.
        if dt > window:
            node.peak_force = max(node.peak_force, node.force)
    if node.status == Status.PRESS:
        node.force_ticks += dt
    elif node.status == Status.GRAZE and node.is_faint:
        node.faint_ticks += dt


def find_closing_tick(node: Node, tick: int, arrival_tick: int, window: int) -> int:
    """Tick at which an open contact is solved next: its gap closes, or a wave arrives.

    The gap goes on at its present rate; nothing is changed.

    Parameters
    ----------
    node : Node
    tick : int
        Now.
    arrival_tick : int
        Tick of the next arrival.
    window : int
        A gap that closes at most so many ticks before an arrival waits for it.
    """
    if node.gap < -node.gap_rate * (NEVER - tick):  # it closes before the clock ends
        # gap/speed + 1/2, with the speed -gap_rate; the 1/2 makes `trunc` round
        ticks = (2 * node.gap - node.gap_rate) / (-2 * node.gap_rate)
        closing_tick: int = tick + math.trunc(ticks)
        if closing_tick + window < arrival_tick:
            return closing_tick
    return arrival_tick
