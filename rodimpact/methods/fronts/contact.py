"""The contact law of a node, its force, and the totals of the force.

In a uniform segment the velocity is v = (a + b)/2, with the wave a travelling to the
right and b to the left. At a node a arrives from the left and b from the right; Y1 and
Y2 are the mobilities 1/Z of the two segments. A force F that presses them apart sends
out the waves a' = b + 2 F Y2 to the right and b' = a - 2 F Y1 to the left.
"""

import math

from ..states import Status
from .records import CHANGE, IDLE, NEVER, NONE, Amplitude, Front, Node, Run

FAINT_TOLERANCES = 1 << 24
"""A force is faint if the closing velocity that it stops is below 2^24 tolerances.

A force that decays as r^n falls below the tolerance from a value of less than
tolerance/r. So every decay with r > 2^-24 passes through faint forces. With a smaller r
the force is faint after one step, since the tolerance is 2^-48 of the velocity scale.
Other forces end because waves cancel, and are never faint.
"""


def reset_node(node: Node, zero: Amplitude) -> None:
    """Set a node to t = 0: no force, no motion, all totals 0.

    `closed_status` and `gap` must be set, and do not change: a node with a gap > 0
    becomes OPEN, any other gets its closed status. `zero` is 0 of the kind of number
    that the run uses.
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

    Gap and gap rate of the node are brought up to date; its status and force are not
    changed here. Signorini: gap >= 0, force >= 0, and one of them is 0. So a closed
    contact becomes PRESS if its faces would approach without a force, and OPEN if they
    part. If they do neither, PRESS becomes GRAZE, and any other status is kept. A gap
    that closes now is TOUCH first, and is then judged as closed. The gap rate is
    exactly 0 for a closed contact, and for an open one whose closing velocity is at
    most `tolerance`.

    Parameters
    ----------
    node : Node
    closing : float
        a - b, the velocity at which the gap would close without a force.
    dt : int
        Ticks since the node was solved last.
    tolerance : float
        Velocities up to this one count as 0, m/s.
    window : int
        A gap that would close within this number of ticks closes now.
    """
    gap = node.gap + node.gap_rate * dt
    status: int = node.status
    if status == Status.OPEN:
        # The gap closes now if it would close within the window, at its closing speed
        # before the arrivals or at that after them.
        closing_speed = max(-node.gap_rate, closing)
        if gap <= closing_speed * window:
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
    node.gap_rate = 0 * closing  # 0, if the gap does not change
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

    These fields of the node are brought up to date: the number of episodes, the ticks
    of the first and last force and of the last opening, and `is_faint`: 1 if the status
    changes from PRESS to GRAZE and the last force was faint, see `FAINT_TOLERANCES`.
    The field `force` of the node must still be the force before the change. The run
    gets a new `next_proof_tick`: if the contact presses now, no proof is due until the
    next change of a contact; otherwise a proof may be tried from now on.

    Parameters
    ----------
    run : Run
    node : Node
    change : Front
        The next free row of the log; the change is written into it.
    k, tick : int
        Number of the node, and tick of the change.
    status : int
        The new status; a change from OPEN to OPEN is a touch without a force.
    mobility : float
        Y1 + Y2, s/kg.
    """
    before = node.status
    node.status = status
    node.is_faint = 0
    if before == Status.PRESS and status == Status.GRAZE:
        # The closing velocity a - b that the last force stopped: F = (a - b)/(Y1 + Y2)
        last_closing = node.force * mobility
        if last_closing <= run.velocity_tolerance * FAINT_TOLERANCES:
            node.is_faint = 1
    if status == Status.PRESS:
        if before != Status.GRAZE:  # after grazing the same episode goes on
            node.episodes += 1
        if node.first_force_tick == NONE:
            node.first_force_tick = tick
        # While a contact presses, a proof succeeds only if no front is in flight. Then
        # there are no more events, and `run_to_end` tries a proof anyway.
        run.next_proof_tick = IDLE
    else:
        run.next_proof_tick = min(run.next_proof_tick, tick)
        if before == Status.PRESS:
            node.last_force_tick = tick
        # From GRAZE on, a contact has pressed since it closed.
        has_pressed = before >= Status.GRAZE
        if status == Status.OPEN and has_pressed:
            node.last_opening_tick = tick
    change.tick = tick
    change.line = CHANGE
    # A change has no next row: the field holds the number of its node instead.
    change.next_row = k
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

    If the node presses or is bonded, both faces have the same velocity, so that
    F = (a - b)/(Y1 + Y2). At an end under a given force (PUSH), F Y arrives as a wave
    from outside. For any other status the force is 0. The status must be the new one. a
    and b are the waves that arrive, Y1 = `left_mobility` and Y2 = `right_mobility`;
    `is_left_end` says whether the node is the left end of the row.

    Returns
    -------
    float
        a, the velocity of the left face without the force, m/s. At a left end under a
        given force, which has no left segment, a + b, the velocity of the end.
    """
    force = 0 * a  # 0 of the same kind of number
    force_free_velocity = a
    if node.status == Status.PRESS or node.status == Status.BOND:
        force = (a - b) / (left_mobility + right_mobility)
    elif node.status == Status.PUSH:
        if is_left_end:
            # The wave from outside is a = F Y2, and the end has the velocity b + F Y2.
            # `force_free_velocity` includes the force in this case. Y1 is 0 at this
            # end, so it is also `face_velocity`.
            force = a / right_mobility
            force_free_velocity = a + b
        else:  # the right end, where the wave from outside is b = F Y1
            force = b / left_mobility
    node.force = force
    # At a left end Y1 is 0, unless a semi-infinite bar lies beyond.
    node.face_velocity = force_free_velocity - force * left_mobility
    return force_free_velocity


def accumulate_contact_totals(node: Node, dt: int, window: int) -> None:
    """Bring the totals of a node up to `dt` ticks after it was solved last.

    They are impulse, its moment integral(F t dt), work, peak force, the ticks with
    status PRESS, and the ticks of grazing after a faint force. Force and status have
    been constant in these ticks. A force that lasts no more than `window` ticks does
    not count for the peak. `solved_tick` does not change.
    """
    if node.force != 0:
        impulse = node.force * dt
        node.impulse += impulse
        node.impulse_moment += impulse * (node.solved_tick + dt / 2)  # mean time
        node.work += node.force * node.face_velocity * dt
        # A shorter force is an artefact of rounding: without it, the waves that begin
        # and end the force would arrive at the same tick.
        if dt > window:
            node.peak_force = max(node.peak_force, node.force)
    if node.status == Status.PRESS:
        node.force_ticks += dt
    elif node.status == Status.GRAZE and node.is_faint:
        node.faint_ticks += dt


def find_closing_tick(node: Node, tick: int, arrival_tick: int, window: int) -> int:
    """Tick of the next event of an open contact: its gap closes, or a wave arrives.

    Until then the gap changes at its present rate. The tick at which it closes is
    rounded to a whole one. Nothing is changed.

    Parameters
    ----------
    node : Node
    tick : int
        Tick of now.
    arrival_tick : int
        Tick of the next arrival.
    window : int
        If the gap closes at most this number of ticks before the arrival, or later, the
        tick of the arrival is returned.
    """
    # True if the gap closes before the clock ends, so never if it does not shrink. A
    # product is compared, since the gap rate may be 0.
    if node.gap < -node.gap_rate * (NEVER - tick):
        # gap/speed + 1/2, with the speed -gap_rate; `trunc` of it is the nearest tick.
        # One quotient is exact on fractions, where a sum with 0.5 would be a float.
        ticks = (2 * node.gap - node.gap_rate) / (-2 * node.gap_rate)
        closing_tick: int = tick + math.trunc(ticks)
        if closing_tick + window < arrival_tick:
            return closing_tick
    return arrival_tick
