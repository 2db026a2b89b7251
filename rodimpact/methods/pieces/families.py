"""The method "characteristics" for many collisions of one make, in one compiled call a chunk."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .. import kernels
from ..compiling import as_objects, lengthened
from ..family import STOPPED_BY, FamilyRun, Stopped
from ..groups import groups, movable, velocities_in_group
from ..laws import Law, Stop
from ..row import Row
from . import driver, march
from .accuracy import COARSER, SHOWN, Ended, apart, compare, left_open
from .method import tolerance_of, vibration_of
from .records import PIECE, TURN
from .rows import Layout, is_even, lay_out, own_laws

TOGETHER = 1024  # members of one chunk
CALL = 64  # members between two looks whether to stop
MEMBER_TIME = 0.2  # s, about what one takes in plain Python
ROOM = 4096  # pieces of the log that they share, at first


def together(row: Row) -> int:
    """How many members to run in one call; 0 where each is to be run alone.

    The force of a bond between rigid bodies follows from signals, which a family does not keep.
    """
    seconds = math.prod(row.system.shape) * MEMBER_TIME
    alone = any(i < 0 for i in row.contact_link) or own_laws(row)
    pays = is_even(row) and not alone and kernels.worth_compiling(seconds, march.follow)
    return TOGETHER if pays else 0


def solve_family(
    row: Row, until: float | None, max_events: int, rtol: float | None,
    stop: Callable[[], bool] = lambda: False, more: int = 0,  # noqa: ARG001 - of every family
    also: Sequence[str] = (),
) -> FamilyRun:
    """Totals of every member.

    Parameters
    ----------
    row : Row
        Of a family whose rows are even.
    until, max_events, rtol
        As for a single run.
    stop : callable
        Asked now and then whether to give up.
    more : int
        Members that other calls will run in this process.
    also : sequence of str
        "accuracy" if it is wanted.

    Raises
    ------
    Stopped
        If `stop` said so.
    """
    tolerance, refused = tolerance_of(rtol), beyond(row)
    layout = lay_out(row, until, tolerance, max_events, keep=False)
    members = np.flatnonzero(~refused)
    run_members(layout, members, stop)
    found = totals(layout, refused | (layout.run["stop"] == Stop.STUCK), until)
    if "accuracy" not in also:
        return found
    coarse = lay_out(row, until, COARSER * tolerance, max_events, keep=False)
    compare(layout.run.view(np.recarray), coarse.run.view(np.recarray))
    run_members(coarse, members, stop)
    return found._replace(further={"accuracy": _errors(layout, coarse, members)})


def _errors(fine: Layout, coarse: Layout, members: Any) -> Any:
    """Stated error of each member, nan of others."""
    errors = np.full(len(fine.run), math.nan)
    for m in members:
        one, other = (Ended(as_objects(x.run[m : m + 1])[0], as_objects(x.link[m]),
                            as_objects(x.part[m])) for x in (fine, coarse))
        errors[m] = max(apart(one, other)[:SHOWN]) + left_open(one.run, fine.fit)
    return errors


def beyond(row: Row) -> Any:
    """Members whose numbers overflow, [member]."""
    shape = row.system.shape
    refused = np.zeros(math.prod(shape), bool)
    for bad, _, _ in row.beyond_scales() if row.segments else ():
        refused |= np.broadcast_to(bad, shape).ravel()
    return refused


def run_members(layout: Layout, wanted: Any, stop: Callable[[], bool]) -> None:
    """Run members one after the other, on their records and one log."""
    follow, known = kernels.compiled(march.follow), layout.first.shape[1]
    matrix = driver.matrix_of(layout.node[0])
    log, turn = np.zeros(ROOM, PIECE), np.zeros(ROOM, TURN)
    own = layout.node, layout.link, layout.mass, layout.line
    for count, m in enumerate(wanted.tolist()):
        if count % CALL == 0 and stop():
            raise Stopped
        log[:known] = layout.first[m]
        layout.run["pieces"][m] = known
        node, link, mass, line = (records[m] for records in own)
        run, part = layout.run[m : m + 1], layout.part[m]
        while follow(run, node, link, mass, line, log, turn, part, matrix) == Stop.FULL:
            log, turn = lengthened(log, PIECE), lengthened(turn, TURN)


def totals(layout: Layout, refused: Any, until: float | None) -> FamilyRun:
    """What the members came to."""
    row, run, link, part = layout.row, layout.run, layout.link, layout.part
    system = row.system
    unknown = np.where(refused, math.nan, 0.0)
    heads = np.flatnonzero(part["parts"][0] > 0)
    before: list[Any] = []
    after: list[Any] = []
    free, frame = movable(system), row.frame
    surveyed = (run["surveyed"].reshape(system.shape), run["tick"].reshape(system.shape))
    fall = row.gravity * surveyed[0] * surveyed[1]
    for group, head in zip(groups(system), heads.tolist(), strict=True):
        inside = [i for i in group if i in free]
        for found, name, fallen in ((before, "initial", 0.0), (after, "mean", fall)):
            shared = part[name][:, head].reshape(system.shape) + (frame + fallen)
            found += [unknown + np.broadcast_to(v, system.shape).ravel()
                      for v in velocities_in_group(system, group, inside, shared)]
    opens = [law.opens for law in system.contacts]
    contacts: dict[str, list[Any]] = {name: [] for name in (
        "impulse", "peak_force", "duration", "episodes")}
    for k, i in enumerate(row.contact_link):
        it = link[:, i]
        contacts["impulse"].append(unknown + it["impulse"])
        contacts["peak_force"].append(unknown + np.where(
            it["law"] == Law.IMPACT, math.nan, it["peak"]))
        contacts["duration"].append(unknown + (it["pressed"] * run["tick"] if opens[k] else 0.0))
        contacts["episodes"].append(it["episodes"] if opens[k] else np.zeros(len(run), int))
    final = (run["proved"] >= 0) & ~refused
    reason = np.full(len(run), STOPPED_BY.index("clock" if until is None else "until"))
    reason[final & (until is None)] = STOPPED_BY.index("final")
    reason[run["stop"] == Stop.CAP] = STOPPED_BY.index("max_events")
    reason[refused] = STOPPED_BY.index("refused")
    vibration = unknown.copy()
    for energy in vibration_of(row, part):
        vibration = vibration + energy
    return FamilyRun(before, after, vibration, contacts, final, reason)
