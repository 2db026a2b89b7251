"""The method "characteristics".

Rods are pure delays, contacts small equations between them. Waves are lists of
polynomial pieces; a node, the chain of links and masses between two rods, is integrated
by itself as far as its inputs are known. There is no time step: every piece is as long
as what happens in it is smooth. A second run in other pieces tells how wrong the first
is. A single collision is a family of one that keeps its pieces.
"""

import math
from collections.abc import Callable, Sequence
from functools import cache, partial
from itertools import pairwise
from typing import Any

import numpy as np

from ...model.frozen import InvalidModel
from ...progress import ProgressReport, no_report
from .. import abilities as physics
from .. import record_lists
from .. import run as runs
from ..clock import Clock, clock_of
from ..family import Columns, family_columns, status_column
from ..groups import groups, movable, velocities_in_group
from ..link import Law
from ..outcome import Motion
from ..row import Row
from ..run import ContactTally, Run
from ..scales import beyond_scales, check_scales
from ..signals import Pieces
from ..states import Stop
from ..status import rounding, strain_warning, with_advice
from . import totals
from .accuracy import (
    COARSER,
    UNTIMED_MEASURES,
    errors_of_two_runs,
    hidden_errors,
    prepare_second_run,
)
from .clock_setup import has_profiles, own_laws
from .driver import Members
from .layout import RunRequest
from .records import Part
from .signals import signals_of

LACKS = (physics.DAMPING, physics.LATERAL, physics.TAPER, physics.SOIL, physics.DRAG)
RTOL = 1e-8
"""Default of the relative error that is aimed at."""
MAX_TOLERANCE = 1e-6
"""Largest tolerance of pieces: below it, errors fall evenly with the tolerance."""
MIN_TOLERANCE = 1e-13
"""Smallest tolerance of pieces: below it, round-off decides."""
MAX_MEMBERS_PER_CALL = 1024
"""Number of members of one call: records of more would leave the cache."""


def solve(
    row: Row,
    until: float | None,
    max_events: int,
    rtol: float | None = None,
    report: ProgressReport = no_report,
) -> Run:
    """Run a single collision to `until`, s, or to its proof of finality.

    After a proof waves go once more through the longest body and back. The run has a
    tolerance that follows from `rtol` (RTOL for None), and `max_events` steps of nodes
    at most. A second, coarser run then tells the errors. They are stated; a result that
    misses `rtol` is not refined.

    Raises
    ------
    InvalidModel
        If numbers are beyond the scales, or no forces satisfy the laws: walls squeeze a
        rigid mass, say.
    """
    if row.segments:
        check_scales(row)
    request = RunRequest(until, tolerance_of(rtol), max_events, keep=True)
    members = Members(row, request)  # a family of one
    members.run_member(report=report)
    if members.runs["stop_reason"][0, 0] == Stop.STUCK:
        nodes = record_lists.as_objects(members.nodes[0])
        stuck = min(nodes, key=lambda node: node.now)
        seconds = float(members.clock.tick * stuck.now)
        raise InvalidModel([totals.why_stuck(row, stuck, seconds)])
    errors = stated_errors(members, np.array([0]), report=report)[0].tolist()
    accuracy = dict(zip(runs.MEASURES, errors, strict=True))
    if rtol is None:
        goal = RTOL
    else:
        goal = rtol
    return _result_of(members, accuracy, goal)


def members_per_call(row: Row) -> int:
    """How many members to run in one call; 0 where each is to be run alone.

    Each runs alone where profiles or drives vary, with laws of the user, and with bonds
    between rigid bodies: their force follows from signals, which a family does not
    keep.
    """
    has_rigid_bond = any(i < 0 for i in row.contact_link)  # such a bond is no link
    if has_profiles(row) or has_rigid_bond or own_laws(row):
        return 0
    return MAX_MEMBERS_PER_CALL


def solve_family(
    row: Row,
    until: float | None,
    max_events: int,
    rtol: float | None,
    *,
    should_stop: Callable[[], bool] = lambda: False,
    later_members: int = 0,  # noqa: ARG001 - an argument of every method's family
    also: Sequence[str] = (),
) -> Columns:
    """Columns of every member, as `family.family_columns` makes them.

    A member whose numbers are beyond the scales, or whose walls squeeze a mass, is
    refused: its numbers are nan. The column "accuracy" is the largest stated error of
    velocities, impulses and peak forces.

    Parameters
    ----------
    row : Row
    until, max_events, rtol
        As for a single run.
    should_stop : callable
        Asked now and then whether to give up.
    later_members : int
        Members that other calls will run in this process; not used.
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
    tolerance = tolerance_of(rtol)
    members = np.flatnonzero(~refused)
    fine = Members(row, RunRequest(until, tolerance, max_events, keep=False))
    fine.run_all(members, should_stop)
    is_stuck = fine.runs["stop_reason"][:, 0] == Stop.STUCK
    columns = _columns_of(fine, refused.ravel() | is_stuck)
    if "accuracy" in also:
        errors = stated_errors(fine, members, should_stop)
        columns["accuracy"] = errors[:, :UNTIMED_MEASURES].max(axis=1)
    return columns


def stated_errors(
    fine: Members,
    members: Any,
    should_stop: Callable[[], bool] = lambda: False,
    report: ProgressReport = no_report,
) -> Any:
    """Relative error of each of the `MEASURES`, [member, measure].

    `members` are the numbers of those that are wanted; all of them have run. They run
    again in other steps, at a coarser tolerance, and the results are compared. The
    others have nan. `should_stop` and `report` are handed to `Members.run_all`.
    """
    coarser = fine.request._replace(
        tolerance=COARSER * fine.request.tolerance, keep=False
    )
    coarse = Members(fine.row, coarser)
    # Record arrays have their fields as attributes, like a single run.
    prepare_second_run(fine.runs.view(np.recarray), coarse.runs.view(np.recarray))
    coarse.run_all(members, should_stop, report)
    errors = np.full((len(fine.runs), len(runs.MEASURES)), math.nan)
    for m in members:
        ended = fine.ended(m)
        errors[m] = errors_of_two_runs(ended, coarse.ended(m))
        errors[m] += hidden_errors(ended, fine.fit)
        errors[m] += fine.carried
    return errors


def tolerance_of(rtol: float | None) -> float:
    """Tolerance of pieces, relative to the velocity scale."""
    if rtol is None:
        rtol = RTOL
    return max(MIN_TOLERANCE, min(rtol, MAX_TOLERANCE))


def _result_of(members: Members, accuracy: dict[str, float], goal: float) -> Run:
    """The `Run` of a single collision, a family of one that has run.

    It has the times of the proof and of the last contact, the status in sentences,
    totals of contacts, motion before and after, and a function that makes the signals.
    `accuracy` are the stated errors by measure, `goal` is the relative error that was
    aimed at.
    """
    row = members.row
    until = members.request.until
    state = members.state()
    ended = members.ended(0)
    run = ended.run
    # The clock of the run itself, in single numbers:
    # that of the family has arrays by member.
    transits = [int(transit) for transit in members.clock.transits]
    clock = clock_of(row, transits, run.tick_duration, scale=float(members.clock.scale))
    tick = clock.tick
    end_tick = min(int(state.nodes["now"].min()), run.end_tick)
    stopped_by = totals.why_stopped(run, until is not None)
    if until is not None and stopped_by == "until":
        t_end = until  # as it was given: `end_tick` is rounded
    else:
        t_end = end_tick * tick
    round_trip = 2 * clock.longest_rod * tick
    t_final = totals.last_of(run, ended.links, t_end, round_trip)
    if run.proved_tick >= 0:
        t_proved = run.proved_tick * tick
    else:
        t_proved = math.nan
    # The status: why the run ended, the accuracy, and what is in doubt
    why = totals.end_of_run(run, ended.links, row.system, stopped_by, t_end, t_final)
    status = with_advice(why)
    status += totals.accuracy_sentence(runs.largest_error(accuracy), goal)
    status += _doubts(clock, run, state.log[: run.piece_count], end_tick)
    # A function that makes the signals when it is first called, and keeps them
    make_signals = cache(partial(signals_of, row, clock, end_tick, state))
    before, after = _body_velocities(members)
    vibration = _floats(vibration_of(members))
    return Run(
        method="characteristics",
        until=until,
        clock=clock,
        end=end_tick,
        t_end=t_end,
        t_final=t_final,
        t_proved=t_proved,
        stopped_by=stopped_by,
        status=status,
        events=run.steps,
        contacts=_tallies(row, ended.links, tick, end_tick, make_signals),
        motion=(
            Motion(velocities=_floats(before), vibration=[], kinetic=math.nan),
            Motion(velocities=_floats(after), vibration=vibration, kinetic=math.nan),
        ),
        accuracy=accuracy,
        make_signals=make_signals,
    )


def _doubts(clock: Clock, run: Any, log: Any, end_tick: int) -> str:
    """Sentences of the status on simplifications, rounding and large strains.

    It is empty if there are none. The `log` has the pieces of the run, which ended at
    `end_tick`.
    """
    text = totals.simplifications_text(run)
    text += _struck_together(clock.row)
    text += rounding(clock.transit_error, clock.worst_path)
    return text + strain_warning(_largest_strain(clock, log, end_tick))


def _largest_strain(clock: Clock, log: Any, end_tick: int) -> float:
    """Bound of the absolute strain in all segments up to a tick, without dimension.

    `log` has the pieces of all lines. The strain is (b - a)/(2 c) by the waves a and b
    of a segment of wave speed c. With abs(a) and abs(b) up to v it is at most v/c. v is
    the sum of the absolute coefficients of the Chebyshev series of a piece. Under
    gravity there is a second bound in the frame of the ground, and the smaller one is
    returned. Without segments the bound is 0.
    """
    row = clock.row
    waves = log[log["line"] < 2 * len(row.segments)]  # two lines a segment come first
    wave_speeds = np.zeros(len(row.segments))
    transit_times = np.zeros(len(row.segments))
    for s, segment in enumerate(row.segments):
        wave_speeds[s] = float(segment.wave_speed)
        transit_times[s] = float(segment.transit_time)
    segments = waves["line"] // 2  # number of the segment, [piece]
    speeds = wave_speeds[segments]
    # v of each piece, m/s, in the frame of the run
    v_in_frame = np.abs(waves["coefficients"]).sum(axis=1)
    bound_in_frame = float((v_in_frame / speeds).max(initial=0.0))
    gravity = float(row.system.gravity)
    if gravity == 0:
        return bound_in_frame
    # In the frame of the run, which falls, waves of a row that is held grow by g t
    # without any strain. In the frame of the ground they are a + u(t) and b + u(t) with
    # the velocity u(t) of the frame. Values that meet have left the ends of the segment
    # at times that differ by its transit time T at most: the bound is v/c + g T/(2 c).
    # A constant wave may last beyond the run.
    is_constant = waves["degree"] == 0
    ends = np.where(is_constant, np.minimum(waves["end"], end_tick), waves["end"])
    middle = (waves["start"] + ends) / 2 * clock.tick  # time, s
    half_duration = (ends - waves["start"]) / 2 * clock.tick  # s
    # u(t) = frame + g t is the series u(middle) + g half_duration y.
    above_ground = waves["coefficients"].copy()
    above_ground[:, 0] += clock.frame + gravity * middle
    above_ground[:, 1] += gravity * half_duration
    v_above_ground = np.abs(above_ground).sum(axis=1)
    v_above_ground += abs(gravity) * transit_times[segments] / 2
    bound_on_ground = float((v_above_ground / speeds).max(initial=0.0))
    return min(bound_in_frame, bound_on_ground)


def _struck_together(row: Row) -> str:
    """Sentence of the status on rigid bodies that touch at t = 0.

    It is empty if no two neighbouring contacts do.
    """
    touching = []
    for i, link in enumerate(row.links):
        if link.law == Law.IMPACT and float(link.gap) == 0:
            touching.append(i)
    if any(j == i + 1 for i, j in pairwise(touching)):
        return (
            " Rigid bodies that touch are struck together; "
            "with gaps the outcome differs."
        )
    return ""


def _tallies(
    row: Row,
    links: list[Any],
    tick: float,
    now: int,
    make_signals: Callable[[], runs.Signals],
) -> tuple[ContactTally, ...]:
    """Totals of every contact, in SI units, of a run up to tick `now`; `tick` in s.

    `links` are those of the run. Only where rigid bodies are bonded to each other
    `make_signals` is called, as the force of such a bond follows from the signals.
    """
    tallies = []
    for k, i in enumerate(row.contact_link):
        if i >= 0:
            tally = totals.tally_of(links[i], tick, now)
        else:
            # A bond of rigid bodies is no link: its force follows from those beside it.
            tally = _bond_tally(make_signals().contacts[k].force, tick, now)
        tallies.append(tally)
    return tuple(tallies)


def _bond_tally(force: Pieces, tick: float, now: int) -> ContactTally:
    """Totals of a bond between rigid bodies from its force, N by tick."""
    impulse = float(force.integral(0, now)) * tick
    peak = max(0.0, float(force.at(force.marks).max()))
    # A bond has no duration, no first and last force, and no episodes.
    return ContactTally(impulse, peak, 0.0, math.nan, math.nan, 0)


def _floats(columns: list[Any]) -> list[float]:
    """Numbers of the only member."""
    return [float(column[0]) for column in columns]


def _body_velocities(family: Members) -> tuple[list[Any], list[Any]]:
    """Velocities of the bodies before and after, m/s: two lists, an array a body.

    The arrays are [member]. The velocity of a body is that of its group; walls are
    bodies, too.
    """
    groups_before, groups_after = _group_velocities(family)
    before = _velocities_by_body(family.row, groups_before)
    after = _velocities_by_body(family.row, groups_after)
    return before, after


def _velocities_by_body(row: Row, group_velocities: list[Any]) -> list[Any]:
    """Velocities of the bodies, m/s, [body] by member, from those of their groups.

    `group_velocities` has one for each group of the system, from left to right. What a
    wall holds has the velocity of the wall, see `groups.velocities_in_group`.
    """
    free = movable(row.system)
    columns = []
    for group, speed in zip(groups(row.system), group_velocities, strict=True):
        inside = [i for i in group if i in free]  # no walls, and nothing bonded to one
        for velocity in velocities_in_group(row.system, group, inside, speed):
            columns.append(row.of(velocity))
    return columns


def _group_velocities(family: Members) -> tuple[list[Any], list[Any]]:
    """Velocities of groups before and after, m/s, [group] by the shape of the family.

    Each is that of the centre of mass, seen from the ground. The records hold
    velocities in the frame, whose own velocity, frame + g t, is added. "After" is the
    last check of finality.
    """
    row = family.row
    parts = family.parts
    shape = row.system.shape
    run = family.runs[:, 0].reshape(shape)
    frame_after = (
        row.frame + row.system.gravity * run["last_proof_tick"] * run["tick_duration"]
    )
    before = []
    after = []
    # The first part of a group, its head, has the number of its parts and the motion of
    # the group; other parts have 0. All members have the same groups as the first one.
    for head in np.flatnonzero(parts["part_count"][0] > 0):
        group = parts[:, head].reshape(shape)
        before.append(group["initial_velocity"] + row.frame)
        after.append(group["group_velocity"] + frame_after)
    return before, after


def vibration_of(family: Members) -> list[Any]:
    """Vibration energy of each body, J, [body] by member.

    It is that about the velocity of its group. That of a rod is the sum of its
    segments; a mass that is bonded to others has its share, by mass, of the energy of
    the mass that they make together. A wall, and a mass that is bonded to one, has 0.
    """
    row = family.row
    parts = family.parts
    kinds = parts["kind"][0].tolist()
    indices = parts["index"][0].tolist()
    part_energies = {}  # J by member, by kind and index of the part
    for p, key in enumerate(zip(kinds, indices, strict=True)):
        part_energies[key] = parts["vibration_energy"][:, p]
    energies = list[Any]()
    for body, span, m in zip(row.system.bodies, row.spans, row.mass_of, strict=True):
        first, last = span
        energy = np.zeros(len(parts))
        for s in range(first, last + 1):
            # Spans count segments from 1, parts from 0.
            energy = energy + part_energies[Part.SEGMENT, s - 1]
        if 0 <= m < len(row.masses):  # a rigid mass that is not bonded to a wall
            share: Any = np.asarray(body.mass) / np.asarray(row.masses[m])
            energy = part_energies[Part.MASS, m] * row.of(share)
        energies.append(energy)
    return energies


def _columns_of(family: Members, refused: Any) -> Columns:
    """Columns of a family whose members have run.

    They are as `family.family_columns` makes them. Numbers are nan, and the proof does
    not count, where a member is `refused`, [member].
    """
    row = family.row
    run = family.runs[:, 0]
    zero_or_nan = np.where(refused, math.nan, 0.0)
    before, after = _body_velocities(family)
    final = (run["proved_tick"] >= 0) & ~refused
    is_capped = run["stop_reason"] == Stop.CAP
    vibration = zero_or_nan
    for energy in vibration_of(family):
        vibration = vibration + energy
    return family_columns(
        row.system,
        before=[zero_or_nan + velocity for velocity in before],
        after=[zero_or_nan + velocity for velocity in after],
        vibration=vibration,
        contacts=_contact_columns(family, zero_or_nan),
        final=final,
        status=status_column(refused, final, is_capped, family.request.until),
    )


def _contact_columns(family: Members, zero_or_nan: Any) -> dict[str, list[Any]]:
    """Totals of every contact in SI units, by name of `CONTACT_COLUMNS`.

    Each is a list, [contact], of arrays by member. `zero_or_nan` is nan where a member
    is refused, else 0; it is not added to `episodes`, which are counts. Impacts have no
    peak force: nan.
    """
    tick = family.runs[:, 0]["tick_duration"]
    contacts: dict[str, list[Any]] = {
        "impulse": [],
        "peak_force": [],
        "duration": [],
        "episodes": [],
    }
    for i in family.row.contact_link:  # a link each: see `members_per_call`
        link = family.links[:, i]
        peak = np.where(link["law"] == Law.IMPACT, math.nan, link["peak_force"])
        contacts["impulse"].append(zero_or_nan + link["impulse"])
        contacts["peak_force"].append(zero_or_nan + peak)
        contacts["duration"].append(zero_or_nan + link["force_ticks"] * tick)
        contacts["episodes"].append(link["episodes"].copy())
    return contacts
