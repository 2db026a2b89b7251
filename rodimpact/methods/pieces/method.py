"""The method "characteristics": results of single collisions and of families.

A rod only delays waves; contacts are small equations between rods. Waves are lists of
polynomial pieces. A node, the chain of links and masses between two rods, is integrated
by itself, as far as its incoming waves are known. There is no common time step: the
duration of a piece follows from its truncation error and from events. A second run with
other pieces gives the stated error of the first one. A single collision is a family
with one member that keeps its history.
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
from ..status import rounding_sentence, strain_warning, with_advice
from . import totals
from .accuracy import (
    COARSER,
    UNTIMED_COUNT,
    errors_of_two_runs,
    hidden_errors,
    prepare_second_run,
)
from .clock_setup import has_profiles, own_laws
from .driver import Members
from .layout import RunRequest
from .records import PartKind
from .signals import signals_of

LACKS = (physics.DAMPING, physics.LATERAL, physics.TAPER, physics.SOIL, physics.DRAG)
RTOL = 1e-8
"""Default of the relative error that is aimed at."""
MAX_TOLERANCE = 1e-6
"""Largest tolerance of pieces: below it, errors fall evenly with the tolerance."""
MIN_TOLERANCE = 1e-13
"""Smallest tolerance of pieces: below it, round-off prevails."""
MAX_MEMBERS_PER_CALL = 1024
"""Largest number of members in one call: records of more do not fit into the cache."""


def solve(
    row: Row,
    until: float | None,
    max_events: int,
    rtol: float | None = None,
    report: ProgressReport = no_report,
) -> Run:
    """Run a single collision to `until`, s, or to its proof of finality if it is None.

    After a proof the run goes on while a wave travels through the longest body and
    back. The run has at most `max_events` steps of nodes, and a tolerance that follows
    from `rtol` (RTOL for None). A second run with a coarser tolerance then gives the
    stated errors. A result whose error is above `rtol` is not refined.

    Raises
    ------
    InvalidModel
        If numbers are out of range, the clock cannot count the run, or no forces
        satisfy the laws, for instance because walls squeeze a rigid mass.
    TooLong
        If one of the two runs takes too much memory.
    """
    if row.segments:
        check_scales(row)
    request = RunRequest(until, tolerance_of(rtol), max_events, keeps_history=True)
    members = Members(row, request)  # a family with one member
    members.run_member(report=report)
    # [0, 0] is the only run of the only member.
    if members.runs["stop_reason"][0, 0] == Stop.STUCK:
        nodes = record_lists.as_objects(members.nodes[0])
        # The earliest node was the one to go next.
        stuck = min(nodes, key=lambda node: node.now)
        seconds = float(members.clock.tick * stuck.now)
        raise InvalidModel([totals.why_stuck(row, stuck, seconds)])
    only_member = np.array([0])
    errors = stated_errors(members, only_member, report=report)[0].tolist()
    accuracy = dict(zip(runs.MEASURES, errors, strict=True))
    if rtol is None:
        goal = RTOL
    else:
        goal = rtol
    return _result_of(members, accuracy, goal)


def members_per_call(row: Row) -> int:
    """Number of members to run in one call; 0 if each must run alone, with `solve`.

    Members run alone if a profile or drive varies, if there is a law of the user, or if
    rigid bodies are bonded: the force of such a bond follows from signals, which a
    family does not keep.
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
    """Columns of results of all members of a family, see `family.family_columns`.

    A member is refused, with nan as results, if its numbers are out of range, or if it
    has no solution. The column "accuracy" is the largest stated error of velocities,
    impulses and peak forces.

    Parameters
    ----------
    row : Row
    until, max_events, rtol
        As for a single run.
    should_stop : callable
        It is called now and then, and returns whether to give up.
    later_members : int
        Number of members that later calls will run in this process; not used.
    also : sequence of str
        "accuracy" if this column is wanted.

    Raises
    ------
    Stopped
        If `should_stop` returns True.
    InvalidModel
        If the clock cannot count the run of some member.
    TooLong
        If a run takes too much memory.
    """
    refused = np.zeros(row.system.shape, bool)
    if row.segments:
        for is_beyond, _path, _sentence in beyond_scales(row):
            refused |= is_beyond
    tolerance = tolerance_of(rtol)
    members = np.flatnonzero(~refused)
    fine = Members(row, RunRequest(until, tolerance, max_events, keeps_history=False))
    fine.run_all(members, should_stop)
    is_stuck = fine.runs["stop_reason"][:, 0] == Stop.STUCK
    columns = _columns_of(fine, refused.ravel() | is_stuck)
    if "accuracy" in also:
        errors = stated_errors(fine, members, should_stop)
        columns["accuracy"] = errors[:, :UNTIMED_COUNT].max(axis=1)
    return columns


def stated_errors(
    fine: Members,
    members: Any,
    should_stop: Callable[[], bool] = lambda: False,
    report: ProgressReport = no_report,
) -> Any:
    """Stated relative error of each of the `MEASURES`, [member, measure].

    `members` are the numbers of the members whose errors are wanted; they must have
    run. They run again with a coarser tolerance and other pieces, and the results are
    compared. Other members get nan. `should_stop` and `report` are used as in
    `Members.run_all`, which may raise Stopped or TooLong.
    """
    coarser = fine.request._replace(
        tolerance=COARSER * fine.request.tolerance, keeps_history=False
    )
    coarse = Members(fine.row, coarser)
    # A recarray has its fields as attributes, like the record of a single run.
    prepare_second_run(fine.runs.view(np.recarray), coarse.runs.view(np.recarray))
    coarse.run_all(members, should_stop, report)
    errors = np.full((len(fine.runs), len(runs.MEASURES)), math.nan)
    for m in members:
        ended = fine.ended(m)
        errors[m] = errors_of_two_runs(ended, coarse.ended(m))
        errors[m] += hidden_errors(ended, fine.fit_error)
        errors[m] += fine.carried_error
    return errors


def tolerance_of(rtol: float | None) -> float:
    """Tolerance of pieces, relative to the velocity scale: `rtol` within bounds.

    The bounds are MIN_TOLERANCE and MAX_TOLERANCE. None stands for RTOL.
    """
    if rtol is None:
        rtol = RTOL
    return max(MIN_TOLERANCE, min(rtol, MAX_TOLERANCE))


def _result_of(members: Members, accuracy: dict[str, float], goal: float) -> Run:
    """The `Run` of a single collision, from a family with one member that has run.

    It has the times of the proof and of the last contact, both nan without a proof, the
    status in sentences, the totals of contacts, the motion before (velocities only) and
    after (without kinetic energy), and a function that makes the signals. Its end is
    the given `until` if the run reached that, otherwise the tick that all nodes have
    reached. `accuracy` are the stated errors by measure, and `goal` is the relative
    error that was aimed at.
    """
    row = members.row
    until = members.request.until
    state = members.state()
    ended = members.ended(0)
    run = ended.run
    # A clock with plain numbers: the clock of the family has arrays by member.
    transits = [int(transit) for transit in members.clock.transits]
    clock = clock_of(row, transits, run.tick_duration, scale=float(members.clock.scale))
    tick = clock.tick
    # A run that stopped at the cap has nodes at different times: the earliest counts.
    end_tick = min(int(state.nodes["now"].min()), run.end_tick)
    stopped_by = totals.why_stopped(run, until is not None)
    if until is not None and stopped_by == "until":
        t_end = until  # exactly as given, while `end_tick` is rounded
    else:
        t_end = end_tick * tick
    round_trip = 2 * clock.longest_rod * tick  # of a wave in the longest rod, s
    t_final = totals.last_of(run, ended.links, t_end, round_trip)
    if run.proved_tick >= 0:  # it is NONE, which is negative, without a proof
        t_proved = run.proved_tick * tick
    else:
        t_proved = math.nan
    # The status: why the run ended, the accuracy, and what is in doubt
    why = totals.end_of_run(run, ended.links, row.system, stopped_by, t_end, t_final)
    status = with_advice(why)
    status += totals.accuracy_sentence(runs.largest_error(accuracy), goal)
    status += _doubts(clock, run, state.log[: run.piece_count], end_tick)
    # The first call of this function makes the signals, later calls return the same.
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
        # `results.energy` fills in the energies that are missing here.
        motion=(
            Motion(velocities=_floats(before), vibration=[], kinetic=math.nan),
            Motion(velocities=_floats(after), vibration=vibration, kinetic=math.nan),
        ),
        accuracy=accuracy,
        make_signals=make_signals,
    )


def _doubts(clock: Clock, run: Any, log: Any, end_tick: int) -> str:
    """Sentences of the status on simplifications, rounding and large strains.

    The text is empty if there is nothing to say. `log` has the pieces of the run, which
    ended at `end_tick`.
    """
    text = totals.simplifications_text(run)
    text += _struck_together(clock.row)
    text += rounding_sentence(clock.transit_error, clock.worst_path)
    return text + strain_warning(_largest_strain(clock, log, end_tick))


def _largest_strain(clock: Clock, log: Any, end_tick: int) -> float:
    """Upper bound of the absolute strain in all segments, up to tick `end_tick`.

    `log` has the pieces of all lines. The strain in a segment with the wave speed c is
    (b - a)/(2 c) with its waves a and b. It is at most v/c if both waves are at most v.
    This v is the sum of the absolute coefficients of the Chebyshev series of a piece;
    the largest v/c of all pieces is the bound. Under gravity there is a second bound in
    the frame of the ground, and the smaller one is returned. Without segments the bound
    is 0.
    """
    row = clock.row
    # The lines of the segments, two for each, come first.
    waves = log[log["line"] < 2 * len(row.segments)]
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
    # The frame of the run falls. If the row is held, its waves relative to this frame
    # grow by g t without any strain. Relative to the ground the waves are a + u(t) and
    # b + u(t), with the velocity u(t) of the frame. Values of a and b that meet have
    # left the ends of the segment at times that differ by its transit time T at most,
    # so that the values of u differ by g T at most: the bound is v/c + g T/(2 c).
    # A constant piece may extend beyond the end of the run.
    is_constant = waves["degree"] == 0
    ends = np.where(is_constant, np.minimum(waves["end"], end_tick), waves["end"])
    middle = (waves["start"] + ends) / 2 * clock.tick  # time, s
    half_duration = (ends - waves["start"]) / 2 * clock.tick  # s
    # u(t) = frame + g t has the Chebyshev series u(middle) + g half_duration y.
    relative_to_ground = waves["coefficients"].copy()
    relative_to_ground[:, 0] += clock.frame + gravity * middle
    relative_to_ground[:, 1] += gravity * half_duration
    v_on_ground = np.abs(relative_to_ground).sum(axis=1)
    v_on_ground += abs(gravity) * transit_times[segments] / 2
    bound_on_ground = float((v_on_ground / speeds).max(initial=0.0))
    return min(bound_in_frame, bound_on_ground)


def _struck_together(row: Row) -> str:
    """Sentence of the status on three or more rigid bodies that touch at t = 0.

    It is empty unless two neighbouring impact contacts have no gap at t = 0.
    """
    touching = []  # numbers of links
    for i, link in enumerate(row.links):
        if link.law == Law.IMPACT and float(link.gap) == 0:
            touching.append(i)
    # Neighbouring links have a rigid body in common.
    if any(right == left + 1 for left, right in pairwise(touching)):
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
    """Totals of all contacts, in SI units, in a run up to tick `now`.

    `links` are the links of the run, and `tick` is the duration of a tick, s.
    `make_signals` is called only for bonds between rigid bodies, whose force follows
    from the signals; it keeps its result, so that further calls cost nothing.
    """
    tallies = []
    for k, i in enumerate(row.contact_link):  # contact k is link i
        if i >= 0:
            tally = totals.tally_of(links[i], tick, now)
        else:  # a bond between rigid bodies, which is not a link
            tally = _bond_tally(make_signals().contacts[k].force, tick, now)
        tallies.append(tally)
    return tuple(tallies)


def _bond_tally(force: Pieces, tick: float, now: int) -> ContactTally:
    """Totals of a bond between rigid bodies, from its force up to tick `now`.

    `force` is in N over ticks, `tick` is the duration of a tick, s. Only impulse and
    peak force are computed; `duration` and `episodes` are 0, `first` and `last` nan.
    """
    impulse = float(force.integral(0, now)) * tick
    # The signal is straight between its marks: its largest value is at one of them.
    peak = max(0.0, float(force.at(force.marks).max()))
    return ContactTally(
        impulse,
        peak,
        duration=0.0,
        first=math.nan,
        last=math.nan,
        episodes=0,
    )


def _floats(columns: list[Any]) -> list[float]:
    """Numbers of the only member, from arrays by member."""
    return [float(column[0]) for column in columns]


def _body_velocities(family: Members) -> tuple[list[Any], list[Any]]:
    """Velocities of all bodies before and after, m/s: two lists, [body], of arrays.

    The arrays are [member]. The velocity of a body is that of the group of bonded
    bodies to which it belongs; walls are bodies, too.
    """
    groups_before, groups_after = _group_velocities(family)
    before = _assign_to_bodies(family.row, groups_before)
    after = _assign_to_bodies(family.row, groups_after)
    return before, after


def _assign_to_bodies(row: Row, group_velocities: list[Any]) -> list[Any]:
    """Velocities of all bodies, m/s, [body] of arrays by member.

    `group_velocities` has the velocity of each group of the system, from left to right.
    Bodies have the velocity of their group. If a wall holds the group, they have the
    velocity of the wall, see `groups.velocities_in_group`.
    """
    free = movable(row.system)
    columns = []
    for group, speed in zip(groups(row.system), group_velocities, strict=True):
        # All but walls, and masses bonded to walls
        inside = [i for i in group if i in free]
        for velocity in velocities_in_group(row.system, group, inside, speed):
            columns.append(row.by_member(velocity))  # a number for each member
    return columns


def _group_velocities(family: Members) -> tuple[list[Any], list[Any]]:
    """Velocities of all groups before and after, m/s: two lists, [group], of arrays.

    The arrays have the shape of the family. "Before" is t = 0, "after" is the last
    check of finality. Each velocity is that of the centre of mass relative to the
    ground: the velocity of the frame, frame + g t, is added to that in the records.
    """
    row = family.row
    parts = family.parts
    shape = row.system.shape
    run = family.runs[:, 0].reshape(shape)
    frame_after = (
        row.frame + row.system.gravity * run["last_check_tick"] * run["tick_duration"]
    )
    before = []
    after = []
    # The first part of a group has the motion of the group, and a `part_count` above 0.
    # All members have the same groups as member 0.
    for first in np.flatnonzero(parts["part_count"][0] > 0):
        group = parts[:, first].reshape(shape)
        before.append(group["initial_velocity"] + row.frame)
        after.append(group["group_velocity"] + frame_after)
    return before, after


def vibration_of(family: Members) -> list[Any]:
    """Vibration energy of each body, J, [body] of arrays by member.

    It is the energy of the motion relative to the velocity of the group of the body. A
    rod has the sum of its segments. Masses that are bonded together share the energy of
    their common mass in proportion to their masses. A wall, and a mass that is bonded
    to a wall, have 0.
    """
    row = family.row
    parts = family.parts
    # All members have the same parts as member 0.
    kinds = parts["kind"][0].tolist()
    indices = parts["index"][0].tolist()
    part_energies = {}  # arrays by member, J, for each kind and index of a part
    for p, kind_and_index in enumerate(zip(kinds, indices, strict=True)):
        part_energies[kind_and_index] = parts["vibration_energy"][:, p]
    energies = list[Any]()
    for body, span, m in zip(row.system.bodies, row.spans, row.mass_of, strict=True):
        first, last = span  # first and last segment; 1, 0 for a body without segments
        energy = np.zeros(len(parts))
        for s in range(first, last + 1):
            # Spans count segments from 1, parts from 0.
            energy = energy + part_energies[PartKind.SEGMENT, s - 1]
        if 0 <= m < len(row.masses):  # a rigid mass that is not bonded to a wall
            # Mass m is the common mass of bonded bodies. The share of this body is a
            # number, or an array of the family if masses differ between members.
            share: Any = np.asarray(body.mass) / np.asarray(row.masses[m])
            energy = part_energies[PartKind.MASS, m] * row.by_member(share)
        energies.append(energy)
    return energies


def _columns_of(family: Members, refused: Any) -> Columns:
    """Columns of results of a family whose members have run.

    See `family.family_columns`. If a member is `refused`, [member], its results are
    nan, and it counts as not final.
    """
    row = family.row
    run = family.runs[:, 0]
    zero_or_nan = np.where(refused, math.nan, 0.0)  # added to results
    before, after = _body_velocities(family)
    # Without a proof `proved_tick` is NONE, which is negative.
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
    """Totals of all contacts in SI units, by name of `CONTACT_COLUMNS`.

    Each is a list, [contact], of arrays by member. `zero_or_nan`, nan for refused
    members and 0 for others, is added to all but the episodes, which are whole numbers.
    The peak force of impact contacts is nan.
    """
    tick = family.runs[:, 0]["tick_duration"]
    contacts: dict[str, list[Any]] = {
        "impulse": [],
        "peak_force": [],
        "duration": [],
        "episodes": [],
    }
    # Each contact is a link: members with other contacts run alone, see
    # `members_per_call`.
    for i in family.row.contact_link:
        link = family.links[:, i]
        peak = np.where(link["law"] == Law.IMPACT, math.nan, link["peak_force"])
        contacts["impulse"].append(zero_or_nan + link["impulse"])
        contacts["peak_force"].append(zero_or_nan + peak)
        contacts["duration"].append(zero_or_nan + link["force_ticks"] * tick)
        contacts["episodes"].append(link["episodes"].copy())
    return contacts
