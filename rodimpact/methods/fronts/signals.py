"""Signals from the log: waves by line, contacts, and actions from outside."""

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
"""The wave that leaves on each line, over time; None for the two lines outside."""


def signals_of(finished: FrontRun) -> Signals:
    """All signals of a finished run, from its log.

    They are the waves by line, the force, gap and closing velocity of each contact, and
    the action on each end, which is None for a free or fixed end.
    """
    lines = waves_by_line(finished)
    is_change = finished.log["line"] == CHANGE
    changes = finished.log[is_change]  # rows with changes of status; others are fronts
    contacts = []
    for contact in range(len(finished.layout.contacts)):
        contacts.append(contact_signal(finished, lines, changes, contact))
    left = outside_signal(finished, lines, contacts, side=0)
    right = outside_signal(finished, lines, contacts, side=1)
    return Signals(Waves(lines), tuple(contacts), (left, right))


def waves_by_line(finished: FrontRun) -> Lines:
    """Waves that leave the ends of the segments, as signals by line, m/s in the frame.

    Lines are counted as in `records`: 2 s and 2 s + 1 belong to segment s. Entries 0
    and 1, the lines outside on the left, are None; there are no entries for the lines
    outside on the right. A signal begins one transit before t = 0.
    """
    n = len(finished.segments) - 2
    count = 2 * n + 2  # number of lines without those outside on the right
    log = finished.log
    # This excludes lines 0 and 1, outside on the left, and changes of status, whose
    # line is CHANGE, -1.
    is_inside = (log["line"] > 1) & (log["line"] < count)
    unsorted = log[is_inside]
    # Sort by line. A stable sort keeps the fronts of a line in order of time.
    fronts = unsorted[np.argsort(unsorted["line"], kind="stable")]
    # [i]: index of the first front of line i; the last entry is the number of fronts
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
    change their status, and `contact` is the index of the contact. While the contact
    presses, F = (a - b)/(Y1 + Y2), with the waves a and b that arrive; while it is
    open, the gap is the integral of b - a. Otherwise force and gap are 0. Force and
    closing velocity are piecewise constant, the gap is piecewise linear, all from tick
    0 to the end of the run. A bonded contact always has its force, and no episodes.
    """
    clock = finished.clock
    end_tick = finished.run.now
    k = finished.layout.contacts[contact]
    closed_status = finished.nodes[k].closed_status
    first_gap = float(clock.system.gaps[contact]) / clock.tick  # velocity times ticks
    # In the row of a change, the field `next_row` is the node.
    own_changes = changes[changes["next_row"] == k]
    first_status = Status.OPEN if first_gap > 0 else closed_status
    # The first status begins at tick -1, before a possible change at tick 0.
    statuses = Pieces([-1, *own_changes["tick"]], [first_status, *own_changes["value"]])

    # a - b and the status, at tick 0 and at all ticks where a, b or the status changes
    from_left = arrivals(finished, lines, k, side=0)
    from_right = arrivals(finished, lines, k, side=1)
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
    # Rates within the tolerance are round-off: 0, as in the kernel.
    gap_rate[np.abs(gap_rate) <= finished.run.velocity_tolerance] = 0.0
    # Entry 0 is the status at tick -1, which is no change.
    change_ticks = statuses.ticks[1:]
    gap_if_open = gaps_at_starts(ticks, gap_rate, change_ticks, first_gap)
    # Gap at the start and at the stop of each piece, in velocity times ticks
    gap_at_start = np.where(is_open, gap_if_open, 0.0)
    gap_at_stop = gap_at_start + gap_rate * np.diff(ticks, append=end_tick)

    episodes: tuple[Episode, ...] = ()
    if closed_status != Status.BOND:  # a bond has none
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

    A wall, whose impedance is infinite but 0 in the clock, adds 0.
    """
    mobility = 0.0
    for s in (k, k + 1):  # the segments beside the node
        if clock.impedance[s] > 0:  # it is not a wall
            mobility += 1 / clock.impedance[s]
    return mobility


def gaps_at_starts(
    ticks: Array, gap_rate: Array, changes: Array, first_gap: float
) -> Array:
    """Gap at each of `ticks` if the contact is open there, in velocity times ticks.

    `gap_rate` is the rate from each tick to the next, m/s, [tick]. `changes` are ticks
    of changes of status, each of them one of `ticks`: there the gap is 0. At the first
    tick it is `first_gap`, unless there is a change at this tick. In between, the gap
    is the integral of its rate since the last change, or since the first tick.
    """
    changes_of_gap = gap_rate[:-1] * np.diff(ticks)  # from each tick to the next
    # Integral of the rate from the first tick to each tick
    travelled = np.concatenate(([0.0], np.cumsum(changes_of_gap)))
    travelled_at_changes = travelled[np.searchsorted(ticks, changes)]
    # [i]: value of `travelled` at which the gap is 0, after i changes. Before any
    # change, the gap is `first_gap` where `travelled` is 0.
    travelled_at_zero = np.concatenate(([-first_gap], travelled_at_changes))
    # Number of changes up to each tick, with a change at the tick itself ("right")
    changes_so_far = np.searchsorted(changes, ticks, "right")
    return np.asarray(travelled - travelled_at_zero[changes_so_far])


def arrivals(finished: FrontRun, lines: Lines, k: int, side: int) -> Pieces:
    """Signal of the wave that arrives at node k from the left (0) or right (1), m/s.

    It is the wave that left the other end of the segment on this side one transit
    before. From a wall it is a constant wave, from tick 0 on. `lines` are the waves by
    line of the run, and node k is a contact.
    """
    segment = k + side
    if finished.clock.impedance[segment] == 0:  # a wall
        # The first and the last record of the kernel's lines hold the wave of a wall.
        if side == 0:
            outside = finished.lines[0]
        else:
            outside = finished.lines[-1]
        return Pieces([0], [outside.incoming_wave])
    # Line 2 s runs to the right, to a node on the right (side 0) of segment s, and line
    # 2 s + 1 to the left (side 1).
    wave = lines[2 * segment + side]
    assert wave is not None
    return wave.delayed(finished.clock.ticks[segment])


def outside_signal(
    finished: FrontRun, lines: Lines, contacts: list[ContactSignal], side: int
) -> BoundaryAction | None:
    """Action on the left (0) or right (1) end of the row: push, N, and velocity, m/s.

    It is None at a free or fixed end. For a wall, the push is the force of its contact,
    one of `contacts`, and the velocity is constant. For a driven or absorbing end, w is
    the wave that leaves inward and u the wave that arrives from inside. The velocity is
    (w + u)/2, plus that of the frame. A positive push compresses the row: the push is
    Z (w - u)/2 at the left end, Z (u - w)/2 at the right end. `lines` are the waves by
    line.
    """
    clock = finished.clock
    end_tick = finished.run.now
    if side == 0:
        outermost = 0  # index of the first body and contact
        s = 1  # first segment
    else:
        outermost = -1  # index of the last body and contact
        s = len(clock.ticks) - 2  # last segment, before the one outside
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
    arriving = outward.delayed(clock.ticks[s])
    # `INWARD` is 1 at the left end and -1 at the right end.
    push = (inward - arriving).times(INWARD[side] * clock.impedance[s] / 2)
    speed = (inward + arriving).times(0.5).plus(clock.frame)
    name = finished.layout.row.boundary_name(side)
    return BoundaryAction(name, push.within(0, end_tick), speed.within(0, end_tick))
