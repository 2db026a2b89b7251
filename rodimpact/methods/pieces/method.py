"""The method "characteristics": rods are pure delays, contacts small equations between them.

Waves are lists of polynomial pieces; a node, the chain of links and masses between two rods, is
integrated by itself as far as its inputs are known. There is no time step: every piece is as long
as what happens in it is smooth. A second run at a coarser tolerance tells how wrong the first is.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache, partial
from itertools import pairwise
from typing import Any

import numpy as np

from .. import abilities as physics
from ..clock import clock_of
from ..duration import Forecast, Progress
from ..groups import groups
from ..laws import Law, Stop
from ..row import Row, squeezed
from ..run import MEASURES, ContactTally, GroupTotals, Run, Signals, largest_error
from ..status import acting_and_held, last_contact, rounding, strain_warning
from .accuracy import COARSER, COARSEST, apart, compare, left_open
from .driver import Machine
from .records import Part
from .rows import Layout, lay_out
from .signals import signals_of
from .totals import (
    ends_of_contacts,
    stated,
    status_of,
    tally_of,
    told_of,
    why_stopped,
)

LACKS = (physics.DAMPING, physics.LATERAL, physics.TAPER)
RTOL = 1e-8
LOOSEST, FINEST = 1e-6, 1e-13  # of tolerances: errors fall evenly below, and round-off comes
LESS = "a larger rtol or an earlier end (until)"


def solve(
    row: Row, until: float | None, max_events: int, rtol: float | None = None,
    progress: Progress | None = None, announce: Callable[[str], None] | None = None,
) -> Run:
    """Run a single collision to `until`, s, or to its proof of finality and one round trip more."""
    if row.segments:
        row.check_scales()
    goal = RTOL if rtol is None else rtol
    tolerance = tolerance_of(rtol)
    layout = lay_out(row, until, tolerance, max_events, keep=True)
    fine = Machine(layout)
    forecast = Forecast(announce, LESS, progress)
    stop = fine.go(forecast)
    if stop == Stop.STUCK:
        raise squeezed(float(fine.run["tick"] * min(fine.records["node"]["now"])))
    coarser, accuracy = COARSER * tolerance, dict[str, float]()
    while not any(accuracy.values()) and coarser <= COARSEST:  # the same steps tell nothing
        coarse = Machine(lay_out(row, until, coarser, max_events, keep=False))
        compare(fine.run, coarse.run)
        coarse.go(forecast)
        accuracy = dict(zip(MEASURES, apart(fine.ended, coarse.ended), strict=True))
        coarser *= COARSER
    return _hand_over(layout, fine, accuracy, until, goal)


def tolerance_of(rtol: float | None) -> float:
    """Tolerance of pieces, relative to the velocity scale."""
    return max(FINEST, min(RTOL if rtol is None else rtol, LOOSEST))


def _hand_over(
    layout: Layout, machine: Machine, accuracy: dict[str, float], until: float | None,
    goal: float,
) -> Run:
    row, r = layout.row, machine.records
    ended = machine.ended
    run = ended.run
    clock = clock_of(
        row, [int(T) for T in layout.clock.transits], float(layout.clock.tick),
        scale=float(layout.clock.scale))
    accuracy = {name: error + left_open(run, layout.fit) for name, error in accuracy.items()}
    end, tick = _end(r), clock.tick
    stopped_by = why_stopped(run, until is not None)
    t_end = until if until is not None and stopped_by == "until" else end * tick
    proved, t_final, trip = run.proved >= 0, math.nan, 2 * clock.longest * tick
    if proved:
        t_final = last_contact(ends_of_contacts(ended.link, tick), t_end, trip)
    acting, held = acting_and_held(row.system)
    status = status_of(run, ended.link, {
        "stopped_by": stopped_by, "end": t_end, "round_trip": trip, "acting": acting, "held": held})
    fastest = max((_fastest(r["log"][: run.pieces], s) / float(row.segments[s].wave_speed)
                   for s in range(len(row.segments))), default=0.0)
    status += stated(largest_error(accuracy), goal) + told_of(run) + _struck_together(row)
    status += rounding(clock.transit_error, clock.worst) + strain_warning(fastest)
    signals = cache(partial(signals_of, row, clock, end, r))
    return Run(
        method="characteristics", until=until, clock=clock, end=end, t_end=t_end, t_final=t_final,
        t_proved=run.proved * tick if proved else math.nan, stopped_by=stopped_by,
        status=status, events=run.steps,
        contacts=_tallies(row, ended.link, tick, end, signals), groups=_groups(row, r),
        accuracy=accuracy,
        make_signals=signals,
    )


def _end(r: dict[str, Any]) -> int:
    """Tick that every node has reached."""
    return min(int(r["node"]["now"].min()), int(r["run"][0]["end"]))


def _struck_together(row: Row) -> str:
    """What is told of rigid bodies that touch at t = 0."""
    touching = [i for i, (law, gap) in enumerate(zip(row.laws, row.gap, strict=True))
                if law == Law.IMPACT and float(gap) == 0]
    if any(j == i + 1 for i, j in pairwise(touching)):
        return " Rigid bodies that touch are struck together; with gaps the outcome differs."
    return ""


def _fastest(log: Any, s: int) -> float:
    own = log[(log["line"] == 2 * s) | (log["line"] == 2 * s + 1)]
    return float(np.abs(own["coefficient"]).sum(axis=1).max(initial=0.0))


def _tallies(
    row: Row, link: list[Any], tick: float, now: int, signals: Callable[[], Signals]
) -> tuple[ContactTally, ...]:
    """Totals of every contact in SI units."""
    tallies = []
    for k, i in enumerate(row.contact_link):
        if i >= 0:
            tallies.append(tally_of(link[i], tick, now))
            continue
        force = signals().contacts[k].force  # a bond of rigid bodies: from what acts beside it
        tallies.append(ContactTally(
            float(force.integral(0, now)) * tick, max(0.0, float(force.at(force.marks).max())),
            0.0, math.nan, math.nan, 0))
    return tuple(tallies)


def _groups(row: Row, r: dict[str, Any]) -> GroupTotals:
    """Velocities of groups and vibration of bodies, as the kernel surveyed them."""
    part, frame = r["part"], float(row.frame)
    heads = np.flatnonzero(part["parts"] > 0)
    assert len(heads) == len(groups(row.system))
    vibration = [float(energy[0]) for energy in vibration_of(row, part[None])]
    tick = float(r["run"][0]["tick"])
    fallen = frame + float(row.gravity) * float(r["run"][0]["surveyed"]) * tick
    return GroupTotals(
        part["initial"][heads] + frame, part["mean"][heads] + fallen, np.array(vibration))


def vibration_of(row: Row, part: Any) -> list[Any]:
    """Energy of each body about the velocity of its group, J, [member] by body."""
    kind, index = part["kind"][0], part["index"][0]
    by_segment = {int(i): part["energy"][:, p] for p, i in enumerate(index)
                  if kind[p] == Part.SEGMENT}
    by_mass = {int(i): part["energy"][:, p] for p, i in enumerate(index) if kind[p] == Part.MASS}
    found = []
    for body, (first, last), m in zip(row.system.bodies, row.spans, row.mass_of, strict=True):
        energy = np.zeros(len(part))
        for s in range(first, last + 1):
            energy = energy + by_segment[s - 1]
        if 0 <= m < len(row.masses):
            share: Any = np.asarray(body.mass) / np.asarray(row.masses[m])  # type: ignore[union-attr]
            energy = by_mass[m] * np.broadcast_to(share, row.system.shape).ravel()
        found.append(energy)
    return found
