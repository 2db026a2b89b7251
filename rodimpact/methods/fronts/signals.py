"""From the kernel's log to signals: waves by line, contacts, and what acts from outside."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ...model import Fixed, Free, Wall
from ..laws import Status
from ..run import INWARD, ContactSignal, Outside, Signals, Waves, episodes_of
from ..signals import Pieces, each_once
from .records import CHANGE
from .run import FrontRun


def signals_of(run: FrontRun) -> Signals:
    """All that a run knows of the motion."""
    lines = _waves(len(run.segment), run.log)
    changes = run.log[run.log["line"] == CHANGE]
    contacts = tuple(_contact(run, lines, changes, k) for k in range(len(run.plan.contacts)))
    left, right = (_outside(run, lines, contacts, side) for side in (0, 1))
    return Signals(Waves(lines), contacts, (left, right))


def _waves(segments: int, log: Any) -> list[Pieces | None]:
    """One signal a line of a segment; None for what comes in from the left."""
    log = log[(log["line"] > 1) & (log["line"] < 2 * segments - 2)]
    log = log[np.argsort(log["line"], kind="stable")]
    bounds = np.searchsorted(log["line"], np.arange(2 * segments - 1))
    return [Pieces(log["tick"][i:j], log["value"][i:j]) if j > i else None
            for i, j in pairwise(bounds)]


def _contact(
    run: FrontRun, lines: Sequence[Pieces | None], changed: Any, contact: int
) -> ContactSignal:
    """Force and gap, from the waves that arrive at a contact and its changes of status.

    The status before any change holds from tick -1 on.
    """
    a, node, end = run.clock, run.plan.contacts[contact], run.run.now
    first, bonded = float(a.system.gaps[contact]) / a.tick, run.node[node].kind == Status.BOND
    own = changed[changed["after"] == node]
    before = Status.OPEN if first > 0 else run.node[node].kind
    changes = Pieces([-1, *own["tick"]], [before, *own["value"]])
    left, right = (_arrivals(run, lines, node, side) for side in (0, 1))
    ticks = each_once([0], left.ticks, right.ticks, changes.ticks)
    ticks = ticks[(ticks >= 0) & (ticks <= end)]
    closing = left.at(ticks) - right.at(ticks)
    yielding = sum(1 / a.impedance[s] for s in (node, node + 1) if a.impedance[s])
    status = changes.at(ticks)
    pressing = np.full(ticks.shape, True) if bonded else status == Status.PRESS
    force = np.where(pressing, closing / yielding, 0.0)
    opening = np.where(status == Status.OPEN, -closing, 0.0)
    opening[np.abs(opening) <= run.run.tolerance] = 0.0
    travelled = np.concatenate(([0.0], np.cumsum(opening[:-1] * np.diff(ticks))))
    # every change of status but the initial one leaves the gap at 0
    change = np.searchsorted(ticks, changes.ticks[1:])
    last = np.searchsorted(changes.ticks[1:], ticks, "right") - 1
    zero = np.append(travelled[change], -first)[last]
    gap = np.where(status == Status.OPEN, travelled - zero, 0.0)
    until = gap + opening * np.diff(ticks, append=end)
    episodes = () if bonded else episodes_of(changes.ticks[1:], changes.values[1:], a.tick)
    return ContactSignal(
        Pieces(ticks, force), Pieces.lines(ticks, gap * a.tick, until * a.tick, end),
        Pieces(ticks, -opening), episodes,
    )


def _arrivals(
    run: FrontRun, lines: Sequence[Pieces | None], node: int, right: int
) -> Pieces:
    segment = node + right
    wave = lines[2 * segment + right] if run.clock.impedance[segment] else None
    if wave is None:  # of a wall
        return Pieces([0], [run.line[-right].arrived])
    return wave.later(run.clock.ticks[segment])


def _outside(
    run: FrontRun, lines: Sequence[Pieces | None], contacts: Sequence[ContactSignal], side: int
) -> Outside | None:
    """What acts on the left (0) or the right (1) end of the row."""
    a, end, wall = run.clock, run.run.now, run.clock.system.bodies[-side]
    if isinstance(wall, Wall):
        return Outside("wall", contacts[-side].force, Pieces([0], [float(wall.velocity)]))
    if isinstance(a.system.ends[side], Free | Fixed):
        return None
    s = range(len(a.ticks))[1:-1][-side]
    inward, outward = lines[2 * s + side], lines[2 * s + 1 - side]
    assert inward is not None
    assert outward is not None
    old = outward.later(a.ticks[s])
    push = (inward - old).times(INWARD[side] * a.impedance[s] / 2)
    speed = (inward + old).times(0.5).plus(a.frame)
    return Outside(run.plan.row.outside_name(side), push.within(0, end), speed.within(0, end))
