"""From the log to signals: waves by line, contacts, and what acts from outside."""

from itertools import pairwise
from typing import Any

import numpy as np

from ...model import Fixed, Free, Wall
from ..clock import Clock
from ..row import Array
from ..run import (
    INWARD,
    BoundaryAction,
    ContactSignal,
    Episode,
    Signals,
    Waves,
    episodes_of,
)
from ..signals import Pieces, each_once
from ..states import Status
from .records import CHANGE
from .run import FrontRun

Lines = list[Pieces | None]
"""Waves by line, as they leave their ends; None where there are none."""


def signals_of(finished: FrontRun) -> Signals:
    """All signals of a finished run, from its log.

    They are waves by line, force, gap and closing of each contact, and what acts on
    both ends, None for a free or fixed one.
    """
    lines = waves_by_line(finished)
    is_change = finished.log["line"] == CHANGE  # rows of the log that are no fronts
    changes = finished.log[is_change]  # changes of status
    contacts = []
    for contact in range(len(finished.layout.contacts)):
        contacts.append(contact_signal(finished, lines, changes, contact))
    left = outside_signal(finished, lines, contacts, 0)
    right = outside_signal(finished, lines, contacts, 1)
    return Signals(Waves(lines), tuple(contacts), (left, right))


def waves_by_line(finished: FrontRun) -> Lines:
    """Waves that leave the ends of the segments, as signals by line, m/s in the frame.

    Lines are counted as in `records`: 2 s and 2 s + 1 belong to segment s. The first
    two, which lie outside on the left, are None; those outside on the right are left
    out.
    """
    n = len(finished.segments) - 2
    count = 2 * n + 2  # lines without those outside on the right
    log = finished.log
    # Lines 0 and 1 lie outside on the left; a change of status has a line below 0.
    inside = (log["line"] > 1) & (log["line"] < count)
    unsorted = log[inside]
    # Line by line; a stable sort leaves those of a line in order of time.
    fronts = unsorted[np.argsort(unsorted["line"], kind="stable")]
    # Where the fronts of each line begin, and where the last ones end
    bounds = np.searchsorted(fronts["line"], np.arange(count + 1))
    lines: Lines = []
    for start, stop in pairwise(bounds):
        wave = None
        if stop > start:
            wave = Pieces(fronts["tick"][start:stop], fronts["value"][start:stop])
        lines.append(wave)
    return lines


def contact_signal(
    finished: FrontRun, lines: Lines, changes: Any, contact: int
) -> ContactSignal:
    """Force, gap and closing velocity of a contact, in SI units, and its episodes.

    `lines` are the waves by line, `changes` the rows of the log in which contacts
    change their status. The signals follow from the waves that arrive and the changes
    of status: F = (a - b)/(Y1 + Y2) while the contact presses, and the gap is the
    integral of b - a while it is open. Force and closing are constant pieces, the gap
    is straight lines, all from tick 0 to the end of the run. A bonded contact always
    presses, and has no episodes.
    """
    clock = finished.clock
    end_tick = finished.run.now
    k = finished.layout.contacts[contact]
    closed_status = finished.nodes[k].closed_status
    first_gap = float(clock.system.gaps[contact]) / clock.tick
    # In a row of a change `next_row` is the node.
    own_changes = changes[changes["next_row"] == k]
    first_status = Status.OPEN if first_gap > 0 else closed_status
    # The first status begins at tick -1, so that a change at tick 0 comes later.
    statuses = Pieces([-1, *own_changes["tick"]], [first_status, *own_changes["value"]])

    # a and b, and the status, at all ticks at which one of them changes
    from_left = arrivals(finished, lines, k, 0)
    from_right = arrivals(finished, lines, k, 1)
    all_ticks = each_once([0], from_left.ticks, from_right.ticks, statuses.ticks)
    ticks = all_ticks[(all_ticks >= 0) & (all_ticks <= end_tick)]
    closing = from_left.at(ticks) - from_right.at(ticks)
    status = statuses.at(ticks)

    if closed_status == Status.BOND:
        is_pressing = np.full(ticks.shape, True)
    else:
        is_pressing = status == Status.PRESS
    force = np.where(is_pressing, closing / mobility_at(clock, k), 0.0)

    is_open = status == Status.OPEN
    gap_rate = np.where(is_open, -closing, 0.0)
    # The kernel takes such rates for round-off as well.
    gap_rate[np.abs(gap_rate) <= finished.run.velocity_tolerance] = 0.0
    # Without the status from tick -1 on, which is no change
    change_ticks = statuses.ticks[1:]
    gap_if_open = gaps_at_starts(ticks, gap_rate, change_ticks, first_gap)
    # Gap at both ends of each piece, in velocity times ticks
    gap_at_start = np.where(is_open, gap_if_open, 0.0)
    gap_at_stop = gap_at_start + gap_rate * np.diff(ticks, append=end_tick)

    episodes: tuple[Episode, ...] = ()
    if closed_status != Status.BOND:
        episodes = episodes_of(change_ticks, statuses.values[1:], clock.tick)
    return ContactSignal(
        force=Pieces(ticks, force),
        gap=Pieces.lines(
            ticks, gap_at_start * clock.tick, gap_at_stop * clock.tick, end_tick
        ),
        closing=Pieces(ticks, -gap_rate),
        episodes=episodes,
    )


def mobility_at(clock: Clock, k: int) -> float:
    """Mobility of both sides of node k together, Y1 + Y2 = 1/Z1 + 1/Z2, s/kg.

    The part of a wall is 0.
    """
    mobility = 0.0
    for s in (k, k + 1):  # the segments beside the node
        if clock.impedance[s] > 0:  # no wall, for which the clock has 0
            mobility += 1 / clock.impedance[s]
    return mobility


def gaps_at_starts(
    ticks: Array, gap_rate: Array, changes: Array, first_gap: float
) -> Array:
    """Gap at each of `ticks` as if the contact were open, in velocity times ticks.

    `gap_rate` is that from each tick to the next, m/s. At each of `changes`, which are
    some of the ticks, the gap is 0; at the first tick, unless this is a change, it is
    `first_gap`. So it grows by what the faces travel after the last change, or after
    the first tick.
    """
    steps = gap_rate[:-1] * np.diff(ticks)
    travelled = np.concatenate(([0.0], np.cumsum(steps)))  # since the first tick
    at_changes = travelled[np.searchsorted(ticks, changes)]
    # [i]: value of `travelled` where the gap was 0 last, after i changes; without a
    # change that which leaves `first_gap` at the first tick
    travelled_at_zero = np.concatenate(([-first_gap], at_changes))
    changes_so_far = np.searchsorted(changes, ticks, "right")
    return np.asarray(travelled - travelled_at_zero[changes_so_far])


def arrivals(finished: FrontRun, lines: Lines, k: int, side: int) -> Pieces:
    """Signal of the wave that arrives at node k from the left (0) or right (1), m/s.

    It is the wave that left the other end of the segment on that side a transit before,
    or the constant wave of a wall. `lines` are the signals of the whole run;
    `finished.lines` are the records of the kernel, of which those from outside, the
    first and the last, hold the constant wave of a wall.
    """
    segment = k + side
    wave = None
    if finished.clock.impedance[segment] > 0:
        wave = lines[2 * segment + side]
    if wave is None:  # the wave of a wall is constant
        if side == 0:
            outside = finished.lines[0]
        else:
            outside = finished.lines[-1]
        return Pieces([0], [outside.incoming_wave])
    return wave.later(finished.clock.ticks[segment])


def outside_signal(
    finished: FrontRun, lines: Lines, contacts: list[ContactSignal], side: int
) -> BoundaryAction | None:
    """What acts on the left (0) or right (1) end of the row: its push and velocity.

    It is None at a free or fixed end. Of a wall the push is the force of its contact,
    and the velocity is constant. A driven or absorbing end sends the wave w in, where u
    arrives: v = (w + u)/2, and the push into the row is Z (w - u)/2 at the left end, Z
    (u - w)/2 at the right end.
    """
    clock = finished.clock
    end_tick = finished.run.now
    if side == 0:
        outermost = 0  # first body and contact
        s = 1  # first segment
    else:
        outermost = -1  # last ones
        s = len(clock.ticks) - 2  # last segment; `ticks` has both outsides
    body = clock.system.bodies[outermost]
    if isinstance(body, Wall):
        velocity = Pieces([0], [float(body.velocity)])
        return BoundaryAction("wall", contacts[outermost].force, velocity)
    if isinstance(clock.system.ends[side], Free | Fixed):
        return None
    # On the left the line 2 s leads inward, on the right the line 2 s + 1.
    inward = lines[2 * s + side]
    outward = lines[2 * s + 1 - side]
    assert inward is not None
    assert outward is not None
    arriving = outward.later(clock.ticks[s])
    # `INWARD` is the sign of a push into the row.
    push = (inward - arriving).times(INWARD[side] * clock.impedance[s] / 2)
    speed = (inward + arriving).times(0.5).plus(clock.frame)
    name = finished.layout.row.boundary_name(side)
    return BoundaryAction(name, push.within(0, end_tick), speed.within(0, end_tick))
