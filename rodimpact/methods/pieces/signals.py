"""From the log of a run to signals: waves, contacts, masses, and what acts from outside."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebder

from ...model import Joint, Plastic, Wall
from ..clock import Clock
from ..groups import fill_bonds
from ..row import Row
from ..run import ContactSignal, Outside, Signals, Waves, episodes_of
from ..signals import Pieces, difference

NOTHING = Pieces([0], [0.0])


def signals_of(row: Row, clock: Clock, end: int, records: dict[str, Any]) -> Signals:
    """All that a run knows of the motion.

    Parameters
    ----------
    row : Row
    clock : Clock
    end : int
        Last tick.
    records : dict of str to array
        Those of the run.
    """
    lines = _lines(records["log"][: records["run"][0]["pieces"]], len(records["line"]))
    link, mass, turn = records["link"], records["mass"], records["turn"]
    turn = turn[: records["run"][0]["turns"]]
    struck = bool(np.any((turn["impulse"] > 0) & (turn["tick"] == 0)))
    masses = {
        body: _before_blow(lines[mass[m]["line"]], row, m) if struck else lines[mass[m]["line"]]
        for body, m in enumerate(row.mass_of) if 0 <= m < len(row.masses)
    }
    ground = {
        body: difference(Pieces.through([0, end], np.full(2, float(row.outside[side][1]))),
                         _frame(clock, end))
        for body, m in enumerate(row.mass_of) if (side := m - len(row.masses)) >= 0
    }
    contacts = [
        _contact(row, clock, k, i, lines, link, turn) if i >= 0 else None
        for k, i in enumerate(row.contact_link)
    ]
    outside = [_outside(row, clock, side, end, lines, records) for side in (0, 1)]
    for side, contact in ((0, contacts[0]), (1, contacts[-1])) if contacts else ():
        acting = outside[side]
        if isinstance(row.system.bodies[-side], Wall) and contact and acting:
            outside[side] = acting._replace(push=contact.force)  # with its blows
    whole = _joined(row, clock, contacts, outside, {**masses, **ground})
    waves = Waves([None, None, *lines[: 2 * len(row.segments)]])
    return Signals(waves, tuple(whole), (outside[0], outside[1]), None, {**masses, **ground})


def _lines(log: Any, count: int) -> list[Pieces]:
    """One signal a line."""
    order = np.argsort(log["line"], kind="stable")
    counts = np.bincount(log["line"], minlength=count)
    stops = np.cumsum(counts)
    lines = []
    for n, stop in zip(counts.tolist(), stops.tolist(), strict=True):
        own = log[order[stop - n : stop]]
        if not n:
            lines.append(NOTHING)
            continue
        coefficients = own["coefficient"] if own["degree"].any() else own["coefficient"][:, :1]
        lines.append(Pieces(own["start"], coefficients, own["stop"][-1]))
    return lines


def _frame(clock: Clock, end: int) -> Pieces:
    """Velocity of the falling frame, m/s."""
    return Pieces.through(
        [0, end], clock.frame + clock.gravity * clock.tick * np.array([0.0, end]))


def _contact(
    row: Row, clock: Clock, contact: int, i: int, lines: list[Pieces], link: Any, turn: Any
) -> ContactSignal:
    it, law = link[i], row.system.contacts[contact]
    force = lines[it["force_line"]]
    if it["overlap_line"] < 0:
        return ContactSignal(force, NOTHING, NOTHING, ())
    gap = lines[it["overlap_line"]].times(-1.0)
    if isinstance(law, Plastic):
        closing = lines[it["closing_line"]]
    else:
        closing = _rate(gap, -1.0 / clock.tick)
    own = turn[turn["link"] == i]
    struck = own[own["impulse"] > 0]
    at = np.maximum(struck["tick"] - 1, 0)
    for tick in np.unique(at):  # a blow takes no time: one tick before it here
        blows = struck[at == tick]
        impulse, work = blows["impulse"].sum(), (blows["impulse"] * blows["closing"]).sum()
        force = _at_once(force, int(tick), float(impulse) / clock.tick)
        closing = _at_once(closing, int(tick), float(work / impulse))
    episodes = () if isinstance(law, Joint) else episodes_of(own["tick"], own["touch"], clock.tick)
    return ContactSignal(force, gap, closing, episodes)


def _before_blow(speed: Pieces, row: Row, m: int) -> Pieces:
    """Velocity of a mass that is struck at t = 0: as it was before, for the tick of the blow."""
    return _at_once(speed, 0, float(row.mass_velocity[m]) - float(row.frame))


def _rate(signal: Pieces, factor: float) -> Pieces:
    """Derivative by ticks times a factor."""
    if signal.size == 1:
        return NOTHING
    slopes = chebder(signal.coefficients, axis=1) * (2 * factor / signal.widths)[:, None]
    return Pieces(signal.ticks, slopes, signal.end)


def _at_once(signal: Pieces, tick: int, value: float) -> Pieces:
    """The signal with another value for one tick."""
    ticks = np.unique(np.concatenate((signal.ticks, [tick, tick + 1])))
    ticks = ticks[ticks >= min(signal.ticks[0], tick)]
    cut = signal.cut(ticks, max(signal.end, tick + 2))
    here = np.searchsorted(ticks, tick)
    cut.coefficients[here] = 0.0
    cut.coefficients[here, 0] = value
    return cut


def _outside(
    row: Row, clock: Clock, side: int, end: int, lines: list[Pieces], records: dict[str, Any]
) -> Outside | None:
    """What acts on the left or right end of the row."""
    kind, value = row.outside[side]
    if kind == "none":
        return None
    it, at = records["link"][-side], records["node"][-side]
    name = row.outside_name(side)
    push = lines[it["force_line"]]
    frame = _frame(clock, end)
    if kind == "velocity" and isinstance(value, float):
        return Outside(name, push, Pieces([0], [value]))
    if kind == "velocity":
        given = lines[at["in_right" if side else "in_left"]]
        return Outside(name, push, difference(given, frame.times(-1.0)))
    if kind == "force" and at["links"] > 1:
        own = lines[records["mass"][-1 if side else 0]["line"]]
        return Outside(name, push, difference(own, frame.times(-1.0)))
    n = len(row.segments)
    out, back = (lines[2 * n - 1], lines[2 * n - 2]) if side else (lines[0], lines[1])
    arriving = back.later(int(clock.ticks[n if side else 1]))
    speed = difference(out.times(0.5), arriving.times(-0.5))
    return Outside(name, push, difference(speed, frame.times(-1.0)))


def _joined(
    row: Row, clock: Clock, contacts: list[ContactSignal | None],
    outside: list[Outside | None], masses: dict[int, Pieces],
) -> list[ContactSignal]:
    """Fill in the forces between bonded rigid bodies."""
    bodies: Any = row.system.bodies
    forces = fill_bonds(
        row.system, [c.force if c else None for c in contacts],
        lambda body: _rate(masses[body], float(bodies[body].mass) / clock.tick),
        outside[0].push if outside[0] else NOTHING)
    return [contact or ContactSignal(force, NOTHING, NOTHING, ())
            for contact, force in zip(contacts, forces, strict=True)]
