"""From the log of a run to signals: waves, contacts, masses, and what acts from outside."""

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebder

from ...model import Wall
from ..clock import Clock
from ..groups import fill_bonds
from ..link import Law
from ..row import Row
from ..run import ContactSignal, Outside, Signals, Waves, episodes_of
from ..signals import Pieces

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
    run, link, turn, bodies = (
        records["run"][0],
        records["link"],
        records["turn"],
        row.system.bodies,
    )
    lines = _lines(records["log"][: run["pieces"]], len(records["line"]))
    frame = Pieces.through(
        [0, end], clock.frame + clock.gravity * clock.tick * np.array([0.0, end])
    )
    turn = turn[: run["turns"]]
    struck = bool(np.any((turn["impulse"] > 0) & (turn["tick"] == 0)))
    masses = {}
    for body, m in enumerate(row.mass_of):
        if m >= len(row.masses):  # bonded to a wall
            value = float(row.outside[m - len(row.masses)][1])
            masses[body] = Pieces.through([0, end], np.full(2, value)) - frame
        elif m >= 0:
            masses[body] = lines[records["mass"]["line"][m]]
            if (
                struck or end == 0
            ):  # as it was before, for the tick of the blow, or where none ran
                before = float(row.mass_velocity[m]) - float(row.frame)
                masses[body] = _at_once(masses[body], 0, before)
    contacts = [
        _contact(link[i], turn[turn["link"] == i], lines, clock.tick)
        if i >= 0
        else None
        for i in row.contact_link
    ]
    outside = [_outside(row, side, lines, frame, records) for side in (0, 1)]
    for side, inwards in enumerate((contacts, contacts[::-1])):
        acting, contact = (
            outside[side],
            next(filter(None, inwards), None),
        )  # not bonds to a wall
        if isinstance(bodies[-side], Wall) and contact and acting:
            outside[side] = acting._replace(push=contact.force)  # with its blows

    def spent(body: int) -> Pieces:
        return _rate(masses[body], float(bodies[body].mass) / clock.tick)

    forces = fill_bonds(
        row.system,
        [c.force if c else None for c in contacts],
        spent,
        outside[0].push if outside[0] else NOTHING,
    )
    whole = tuple(
        contact or ContactSignal(force, NOTHING, NOTHING, ())
        for contact, force in zip(contacts, forces, strict=True)
    )
    waves = Waves([None, None, *lines[: 2 * len(row.segments)]])
    return Signals(waves, whole, (outside[0], outside[1]), None, masses)


def _lines(log: Any, count: int) -> list[Pieces]:
    """One signal a line."""
    log = log[np.argsort(log["line"], kind="stable")]
    bounds = np.searchsorted(log["line"], np.arange(count + 1))
    lines = []
    for own in (log[i:j] for i, j in pairwise(bounds)):
        size = own["coefficient"].shape[1] if own["degree"].any() else 1
        lines.append(
            Pieces(own["start"], own["coefficient"][:, :size], own["stop"][-1])
            if len(own)
            else NOTHING
        )
    return lines


def _contact(it: Any, turns: Any, lines: list[Pieces], tick: float) -> ContactSignal:
    """What passed in a link, in which contacts took these turns."""
    kept = it["kept"]
    force = lines[kept]
    if it["law"] < Law.JOINT:
        return ContactSignal(force, NOTHING, NOTHING, ())
    gap = lines[kept + 1].times(-1.0)
    closing = lines[kept + 2] if it["law"] == Law.YIELD else _rate(gap, -1.0 / tick)
    struck = turns[turns["impulse"] > 0]
    at = np.maximum(struck["tick"] - 1, 0)
    for when in np.unique(at):  # a blow takes no time: one tick before it here
        blows = struck[at == when]
        impulse, work = (
            blows["impulse"].sum(),
            (blows["impulse"] * blows["closing"]).sum(),
        )
        force = _at_once(force, int(when), float(impulse) / tick)
        closing = _at_once(closing, int(when), float(work / impulse))
    opens = it["law"] >= Law.RIGID
    episodes = episodes_of(turns["tick"], turns["touch"], tick) if opens else ()
    return ContactSignal(force, gap, closing, episodes)


def _rate(signal: Pieces, factor: float) -> Pieces:
    """Derivative by ticks times a factor."""
    if signal.size == 1:
        return NOTHING
    slopes = (
        chebder(signal.coefficients, axis=1) * (2 * factor / signal.widths)[:, None]
    )
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
    row: Row, side: int, lines: list[Pieces], frame: Pieces, records: dict[str, Any]
) -> Outside | None:
    """What acts on the left or right end of the row."""
    kind, value = row.outside[side]
    if kind == "none":
        return None
    at, inner = records["node"][-side], 1 - side
    if kind == "velocity" and isinstance(value, float):
        speed = Pieces([0], [value])
    elif kind == "velocity":
        speed = lines[at["source"][side]] + frame
    elif kind == "force" and at["links"] > 1:
        speed = lines[records["mass"]["line"][-side]] + frame
    else:
        back = at["source"][inner]
        arriving = lines[back].later(int(records["line"]["delay"][back]))
        speed = lines[at["target"][inner]].times(0.5) + arriving.times(0.5) + frame
    return Outside(row.outside_name(side), lines[records["link"]["kept"][-side]], speed)
