"""From the kernel's log to signals: waves by line, contacts, and what acts from outside."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...model import Absorbing, Bonded, Fixed, Free, Wall
from ..run import INWARD, ContactSignal, Episode, Outside, Signals, Waves
from ..signals import Pieces, each_once
from .assembly import Assembly
from .front_kernel import OPEN, PRESS, Log
from .tracking import FrontRun


def signals_of(run: FrontRun) -> Signals:
    """All that a run knows of the motion."""
    a = run.assembly
    lines = _waves(len(a.ticks), run.log)
    changes = _changes(a, run.log)
    contacts = tuple(
        _contact(a, lines, changes[node], node, run.end, isinstance(law, Bonded))
        for node, law in zip(a.nodes, a.system.contacts, strict=True)
    )
    left, right = (_outside(a, lines, contacts, place, run.end) for place in (0, -1))
    return Signals(Waves(lines), contacts, (left, right))


def _waves(segments: int, log: Log) -> list[Pieces | None]:
    """One signal a line of a segment."""
    line = np.asarray(log.line, dtype=np.int32)
    order = np.argsort(line, kind="stable")
    counts = np.bincount(line, minlength=2 * segments)
    order, counts = order[counts[0] : len(order) - counts[-1]], counts[:-2]
    counts[0] = 0
    ticks = np.asarray(log.tick, dtype=np.int64)[order]
    values = np.asarray(log.value, dtype=np.float64)[order]
    stops = np.cumsum(counts)
    return [
        Pieces(ticks[stop - n : stop], values[stop - n : stop]) if n else None
        for n, stop in zip(counts.tolist(), stops.tolist(), strict=True)
    ]


def _changes(a: Assembly, log: Log) -> dict[int, Pieces]:
    """Status of each contact, by node; that before any change holds from tick -1 on."""
    columns: Any = [np.asarray(column).tolist() for column in
                    (log.change_tick, log.change_node, log.change_status)]
    by_node: dict[int, tuple[list[int], list[int]]] = {
        node: ([-1], [a.status[node]]) for node in a.nodes
    }
    for tick, node, status in zip(*columns, strict=True):
        by_node[node][0].append(tick)
        by_node[node][1].append(status)
    return {node: Pieces(*columns) for node, columns in by_node.items()}


def _contact(
    a: Assembly, lines: Sequence[Pieces | None], changes: Pieces, node: int, end: int,
    bonded: bool,
) -> ContactSignal:
    """Force and gap, from the waves that arrive at a contact and its changes of status."""
    left, right = (_arrivals(a, lines, node, side) for side in (0, 1))
    ticks = each_once([0], left.ticks, right.ticks, changes.ticks)
    ticks = ticks[(ticks >= 0) & (ticks <= end)]
    closing = left.at(ticks) - right.at(ticks)
    yielding = sum(1 / a.impedance[s] for s in (node, node + 1) if a.impedance[s])
    status = changes.at(ticks)
    pressing = np.full(ticks.shape, True) if bonded else status == PRESS
    force = np.where(pressing, closing / yielding, 0.0)
    opening = np.where(status == OPEN, -closing, 0.0)
    opening[np.abs(opening) <= a.tolerance] = 0.0
    travelled = np.concatenate(([0.0], np.cumsum(opening[:-1] * np.diff(ticks))))
    # every change of status but the initial one leaves the gap at 0
    change = np.searchsorted(ticks, changes.ticks[1:])
    last = np.searchsorted(changes.ticks[1:], ticks, "right") - 1
    zero = np.append(travelled[change], -a.gaps[node])[last]
    gap = np.where(status == OPEN, travelled - zero, 0.0)
    until = gap + opening * np.diff(ticks, append=end)
    return ContactSignal(
        Pieces(ticks, force), Pieces.lines(ticks, gap * a.tick, until * a.tick, end),
        Pieces(ticks, -opening), () if bonded else _episodes(changes, a.tick),
    )


def _arrivals(a: Assembly, lines: Sequence[Pieces | None], node: int, right: int) -> Pieces:
    segment = node + right
    wave = lines[2 * segment + right] if a.impedance[segment] else None
    if wave is None:
        return Pieces([0], [a.outside[right]])
    return wave.later(a.ticks[segment])


def _episodes(changes: Pieces, tick: float) -> tuple[Episode, ...]:
    episodes: list[Episode] = []
    start = force_end = np.nan
    touching = False
    for when, status in zip(changes.ticks[1:], changes.values[1:], strict=True):
        t = float(when) * tick
        if status == PRESS:
            start, force_end = (start, np.nan) if touching else (t, np.nan)
            touching = True
        elif touching:
            force_end = t if np.isnan(force_end) else force_end
            if status == OPEN:
                episodes.append(Episode(start, force_end, t))
                touching = False
    if touching:
        episodes.append(Episode(start, force_end, np.nan))
    return tuple(episodes)


def _outside(
    a: Assembly, lines: Sequence[Pieces | None], contacts: Sequence[ContactSignal],
    place: int, end: int,
) -> Outside | None:
    """What acts on the first (0) or the last (-1) end of the row."""
    wall, kind, sign = a.system.bodies[place], a.system.ends[place], INWARD[place]
    if isinstance(wall, Wall):
        return Outside("wall", contacts[place].force, Pieces([0], [float(wall.velocity)]))
    if isinstance(kind, Free | Fixed):
        return None
    s = range(len(a.ticks))[1:-1][place]
    inward, outward = lines[2 * s : 2 * s + 2][::sign]
    assert inward is not None
    assert outward is not None
    T = a.ticks[s]
    ticks = each_once([0], inward.ticks, outward.ticks + T)
    ticks = ticks[(ticks >= 0) & (ticks <= end)]
    new, old = inward.at(ticks), outward.at(ticks - T)
    force = sign * a.impedance[s] * (new - old) / 2
    speed = (new + old) / 2 + a.frame
    return Outside(
        "absorbing" if isinstance(kind, Absorbing) else "drive", Pieces(ticks, force),
        Pieces(ticks, speed),
    )
