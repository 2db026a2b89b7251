"""The method "characteristics": rods are pure delays, contacts small equations between them.

Waves are lists of polynomial pieces; a node, the chain of links and masses between two rods, is
integrated by itself as far as its inputs are known. There is no time step: every piece is as long
as what happens in it is smooth. A second run at a coarser tolerance tells how wrong the first is.
A single collision is a family of one that keeps its pieces.
"""

import math
from collections.abc import Callable, Sequence
from functools import cache, partial
from itertools import pairwise
from typing import Any

import numpy as np

from ...model.frozen import InvalidModel
from ...progress import Report, no_report
from .. import abilities as physics
from .. import record_lists
from .. import run as runs
from ..clock import clock_of
from ..family import Columns, family_columns, status_column
from ..groups import groups, movable, velocities_in_group
from ..link import Law
from ..outcome import Motion
from ..row import Row
from ..run import ContactTally, Run
from ..scales import beyond_scales, check_scales
from ..states import Stop
from ..status import rounding, strain_warning
from . import totals
from .accuracy import (
    COARSER,
    COARSEST,
    SHOWN,
    compare,
    differences,
    left_open,
    stated,
)
from .driver import Members
from .layout import Asked
from .records import Part
from .rows import is_even, own_laws
from .signals import signals_of

LACKS = (physics.DAMPING, physics.LATERAL, physics.TAPER)
RTOL = 1e-8
LOOSEST, FINEST = (
    1e-6,
    1e-13,
)  # of tolerances: errors fall evenly below, and round-off comes
TOGETHER = 1024  # members of one chunk


def solve(
    row: Row,
    until: float | None,
    max_events: int,
    rtol: float | None = None,
    report: Report = no_report,
) -> Run:
    """Run a single collision to `until`, s, or to its proof of finality and one round trip more."""
    if row.segments:
        check_scales(row)
    fine = Members(row, Asked(until, tolerance_of(rtol), max_events, keep=True))
    fine.go(report=report)
    if fine.run_of(0).stop == Stop.STUCK:
        nodes = record_lists.as_objects(fine.node[0])
        stuck = min(nodes, key=lambda node: node.now)
        seconds = float(fine.clock.tick * stuck.now)
        raise InvalidModel([totals.why_stuck(row, stuck, seconds)])
    (errors,) = stated_errors(fine, np.array([0]), COARSEST, report=report).tolist()
    accuracy = dict(zip(runs.MEASURES, errors, strict=True))
    return _hand_over(fine, accuracy, RTOL if rtol is None else rtol)


def members_per_call(row: Row) -> int:
    """How many members to run in one call; 0 where each is to be run alone.

    The force of a bond between rigid bodies follows from signals, which a family does not keep.
    """
    if not is_even(row) or any(i < 0 for i in row.contact_link) or own_laws(row):
        return 0
    return TOGETHER


def solve_family(
    row: Row,
    until: float | None,
    max_events: int,
    rtol: float | None,
    should_stop: Callable[[], bool] = lambda: False,
    later_members: int = 0,  # noqa: ARG001 - an argument of every method's family
    also: Sequence[str] = (),
) -> Columns:
    """Columns of every member.

    Parameters
    ----------
    row : Row
    until, max_events, rtol
        As for a single run.
    should_stop : callable
        Asked now and then whether to give up.
    later_members : int
        Members that other calls will run in this process.
    also : sequence of str
        "accuracy" if it is wanted.

    Raises
    ------
    Stopped
        If `should_stop` said so.
    """
    refused = np.zeros(row.system.shape, bool)
    if row.segments:
        for is_beyond, _, _ in beyond_scales(row):
            refused |= is_beyond
    tolerance, members = tolerance_of(rtol), np.flatnonzero(~refused)
    fine = Members(row, Asked(until, tolerance, max_events, keep=False))
    fine.run_all(members, should_stop)
    is_stuck = fine.run["stop"][:, 0] == Stop.STUCK
    columns = _columns_of(fine, refused.ravel() | is_stuck)
    if "accuracy" in also:
        errors = stated_errors(fine, members, COARSER * tolerance, should_stop)
        columns["accuracy"] = errors[:, :SHOWN].max(axis=1)
    return columns


def stated_errors(
    fine: Members,
    members: Any,
    coarsest: float,
    stop: Callable[[], bool] = lambda: False,
    report: Report = no_report,
) -> Any:
    """Relative error of each of the `MEASURES`, [member, measure], of members that have run.

    Other runs tell, at tolerances up to the coarsest: those that took the same steps tell nothing.
    """
    count = len(fine.run)
    apart = np.zeros((count, len(runs.MEASURES)))
    alike = members
    tolerance = COARSER * fine.asked.tolerance
    while len(alike) and tolerance <= coarsest:
        coarse = Members(fine.row, fine.asked._replace(tolerance=tolerance, keep=False))
        compare(fine.run.view(np.recarray), coarse.run.view(np.recarray))
        coarse.run_all(alike, stop, report)
        for m in alike:
            apart[m] = differences(fine.ended(m), coarse.ended(m))
        alike = alike[~apart[alike].any(axis=1)]
        tolerance *= COARSER
    errors = np.full_like(apart, math.nan)
    for m in members:
        ended = fine.ended(m)
        errors[m] = stated(ended, apart[m].tolist())
        errors[m] += left_open(ended, fine.fit)
        errors[m] += fine.carried
    return errors


def tolerance_of(rtol: float | None) -> float:
    """Tolerance of pieces, relative to the velocity scale."""
    return max(FINEST, min(RTOL if rtol is None else rtol, LOOSEST))


def _hand_over(one: Members, accuracy: dict[str, float], goal: float) -> Run:
    """What every method hands back, of a family of one that has run."""
    r, ended, row, until = one.records(), one.ended(0), one.row, one.asked.until
    run = ended.run
    clock = clock_of(
        row,
        [int(T) for T in one.clock.transits],
        run.tick,
        scale=float(one.clock.scale),
    )
    end, tick = min(int(r["node"]["now"].min()), run.end), clock.tick
    stopped_by = totals.why_stopped(run, until is not None)
    t_end = until if until is not None and stopped_by == "until" else end * tick
    t_final = totals.last_of(run, ended.link, t_end, 2 * clock.longest * tick)
    status = totals.status_of(run, ended.link, row.system, stopped_by, t_end, t_final)
    log = r["log"][: run.pieces]
    waves = log[log["line"] < 2 * len(row.segments)]
    c = np.array([0.0, *(float(segment.wave_speed) for segment in row.segments)])
    strains = np.abs(waves["coefficient"]).sum(axis=1) / c[waves["line"] // 2 + 1]
    status += totals.stated(runs.largest_error(accuracy), goal) + totals.told_of(run)
    status += _struck_together(row) + rounding(clock.transit_error, clock.worst)
    status += strain_warning(float(strains.max(initial=0.0)))
    signals = cache(partial(signals_of, row, clock, end, r))
    velocities_before, velocities_after = _body_velocities(one)
    return Run(
        method="characteristics",
        until=until,
        clock=clock,
        end=end,
        t_end=t_end,
        t_final=t_final,
        t_proved=run.proved * tick if run.proved >= 0 else math.nan,
        stopped_by=stopped_by,
        status=status,
        events=run.steps,
        contacts=_tallies(row, ended.link, tick, end, signals),
        motion=(
            Motion(_floats(velocities_before), [], math.nan),
            Motion(_floats(velocities_after), _floats(vibration_of(one)), math.nan),
        ),
        accuracy=accuracy,
        make_signals=signals,
    )


def _struck_together(row: Row) -> str:
    """What is told of rigid bodies that touch at t = 0."""
    touching = [
        i
        for i, it in enumerate(row.links)
        if it.law == Law.IMPACT and float(it.gap) == 0
    ]
    if any(j == i + 1 for i, j in pairwise(touching)):
        return " Rigid bodies that touch are struck together; with gaps the outcome differs."
    return ""


def _tallies(
    row: Row,
    link: list[Any],
    tick: float,
    now: int,
    signals: Callable[[], runs.Signals],
) -> tuple[ContactTally, ...]:
    """Totals of every contact in SI units."""
    tallies = []
    for k, i in enumerate(row.contact_link):
        if i >= 0:
            tallies.append(totals.tally_of(link[i], tick, now))
            continue
        force = (
            signals().contacts[k].force
        )  # a bond of rigid bodies: from what acts beside it
        tallies.append(
            ContactTally(
                float(force.integral(0, now)) * tick,
                max(0.0, float(force.at(force.marks).max())),
                0.0,
                math.nan,
                math.nan,
                0,
            )
        )
    return tuple(tallies)


def _floats(columns: list[Any]) -> list[float]:
    """Numbers of the only member."""
    return [float(column[0]) for column in columns]


def _body_velocities(family: Members) -> tuple[list[Any], list[Any]]:
    """Velocities of the bodies before and after, m/s, [body] by member."""
    row = family.row
    free = movable(row.system)
    by_body = []
    for group_velocities in _group_velocities(family):
        columns = []
        for group, own in zip(groups(row.system), group_velocities, strict=True):
            inside = [i for i in group if i in free]
            for velocity in velocities_in_group(row.system, group, inside, own):
                columns.append(row.of(velocity))
        by_body.append(columns)
    return by_body[0], by_body[1]


def _group_velocities(family: Members) -> tuple[list[Any], list[Any]]:
    """Velocities of groups before and after, m/s, [group] by the shape of the family."""
    row, part, shape = family.row, family.part, family.row.system.shape
    run = family.run[:, 0].reshape(shape)
    fallen = row.frame + row.system.gravity * run["surveyed"] * run["tick"]
    own = [
        part[:, head].reshape(shape) for head in np.flatnonzero(part["parts"][0] > 0)
    ]
    return [it["initial"] + row.frame for it in own], [
        it["mean"] + fallen for it in own
    ]


def vibration_of(family: Members) -> list[Any]:
    """Energy of each body about the velocity of its group, J, [body] by member."""
    row, part, found = family.row, family.part, list[Any]()
    energies = {
        (kind, index): part["energy"][:, p]
        for p, (kind, index) in enumerate(
            zip(part["kind"][0].tolist(), part["index"][0].tolist(), strict=True)
        )
    }
    for body, (first, last), m in zip(
        row.system.bodies, row.spans, row.mass_of, strict=True
    ):
        energy = np.zeros(len(part))
        for s in range(first, last + 1):
            energy = energy + energies[Part.SEGMENT, s - 1]
        if 0 <= m < len(row.masses):
            share: Any = np.asarray(body.mass) / np.asarray(row.masses[m])
            energy = energies[Part.MASS, m] * row.of(share)
        found.append(energy)
    return found


def _columns_of(family: Members, refused: Any) -> Columns:
    """Columns of members that have run."""
    row, run, link = family.row, family.run[:, 0], family.link
    system, until, unknown = (
        row.system,
        family.asked.until,
        np.where(refused, math.nan, 0.0),
    )
    before, after = _body_velocities(family)
    links = [link[:, i] for i in row.contact_link]
    contacts = {
        "impulse": [unknown + it["impulse"] for it in links],
        "peak_force": [
            unknown + np.where(it["law"] == Law.IMPACT, math.nan, it["peak"])
            for it in links
        ],
        "duration": [unknown + it["pressed"] * run["tick"] for it in links],
        "episodes": [it["episodes"].copy() for it in links],
    }
    final = (run["proved"] >= 0) & ~refused
    return family_columns(
        system,
        before=[unknown + velocity for velocity in before],
        after=[unknown + velocity for velocity in after],
        vibration=sum(vibration_of(family), unknown),
        contacts=contacts,
        final=final,
        status=status_column(refused, final, run["stop"] == Stop.CAP, until),
    )
