"""The method "fronts": every wave front from end to end, exact, for what fronts can carry."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from typing import Any

import numpy as np

from ...model import Absorbing, Bonded, Fixed, Free
from ...model.numbering import contact_names
from ...units import format_si
from .. import abilities as physics
from ..duration import Forecast, Progress
from ..family import STOPPED_BY, FamilyRun
from ..groups import body_velocities, groups, heads
from ..laws import Status, Stop
from ..row import Array, Row
from ..run import MAX_EVENTS, MEASURES, VELOCITY, ContactTally, Run, Totals
from ..status import (
    ROUNDED,
    acting_and_held,
    ending,
    last_contact,
    proof_sentence,
    rounding,
    strain_warning,
)
from . import driver
from .plan import plan_of
from .records import NONE
from .run import FrontRun
from .signals import signals_of

LACKS = (
    physics.MASSES, physics.COMPLIANCE, physics.JOINTS, physics.GRAVITY, physics.SMOOTH_STATES,
    physics.SMOOTH_DRIVES, physics.DAMPING, physics.LATERAL, physics.TAPER, physics.OWN_LAWS,
)
ROUND_OFF = 2.0**-40  # of the peak force: a contact that presses less has come to rest
LESS = "an earlier end (until), or a lower cap (max_events),"
EXACT = 2.0**-48  # relative change of a transit time that is round-off
MORE = 4  # times the events of a run that another may take, beside rounded transit times
NO_ROUNDING: Mapping[str, float] = {}
MOST_MEMBERS, MOST_BYTES = 16384, 1 << 24  # of one call of `solve_family`, for memory's sake


def solve(
    row: Row, until: float | None, max_events: int, progress: Progress | None = None,
    announce: Callable[[str], None] | None = None,
) -> Run:
    """Run a single collision to `until`, s, or to its proof of finality and one round trip more."""
    run = track(row, until, max_events, Forecast(announce, LESS, progress))
    return hand_over(run, until, effect_of_rounding(run))


def track(
    row: Row, until: float | None = None, max_events: int = MAX_EVENTS,
    forecast: Forecast | None = None,
) -> FrontRun:
    """Follow every front of a collision."""
    return FrontRun(driver.solve_one(plan_of(row), until, max_events, forecast))

# What a run came to -------------------------------------------------------------------------------


def hand_over(
    run: FrontRun, until: float | None, accuracy: Mapping[str, float] = NO_ROUNDING
) -> Run:
    """What every method hands back, of a run to `until`."""
    a, now, tallies = run.clock, run.run.now, tallies_of(run)
    proved, t_final = run.finality_time != NONE, math.nan
    if proved:
        ends = ends_of_contacts(run.node, run.plan.contacts, a.tick)
        t_final = last_contact(ends, now * a.tick, 2 * a.longest * a.tick)
    return Run(
        method="fronts", until=until, clock=a, end=now,
        t_end=until if until is not None and run.stopped_by == "until" else now * a.tick,
        t_final=t_final, t_proved=run.finality_time * a.tick if proved else math.nan,
        stopped_by=run.stopped_by, status=_status(run) + _told(accuracy),
        events=run.run.events, accuracy=accuracy,
        contacts=tallies, totals=totals_of(run, tallies), make_signals=lambda: signals_of(run),
    )


def _status(run: FrontRun) -> str:
    """Why the run ended, and what to do if that is not enough."""
    a = run.clock
    acting, held = acting_and_held(a.system)
    text = status_of(run.run, run.node, run.plan.contacts, {
        "proved": run.finality_time != NONE, "round_trip": 2 * a.longest * a.tick,
        "acting": acting, "held": held, "names": contact_names(a.system.kinds),
    })
    return (
        text + rounding(a.transit_error, a.worst)
        + strain_warning(run.run.fastest / min(a.wave_speed[1:-1]))
    )


def status_of(it: Any, node: Sequence[Any], contacts: Sequence[int], known: Any) -> str:
    """Why a run ended, from its records; the page has this as JavaScript.

    Parameters
    ----------
    it : RUN
    node : list of NODE
    contacts : list of int
        Node of each contact.
    known : dict
        Whether the end is ``proved``; ``round_trip`` of the longest body, s; what is ``acting`` on
        the row, and whether walls have it ``held``, as of `ending`; ``names`` of the contacts.
    """
    stopped_by, final, end = "until", "", format_si(it.now * it.tick, "s")
    if it.stop == Stop.FINAL:
        stopped_by = "final"
    elif it.stop == Stop.CAP:
        stopped_by = "max_events"
    elif it.stop == Stop.CLOCK:
        stopped_by = "clock"
    if known["proved"]:
        final = pressing(node, contacts, known["names"])
        if final == "":
            ends = ends_of_contacts(node, contacts, it.tick)
            latest = last_contact(ends, it.now * it.tick, known["round_trip"])
            final = proof_sentence(any(at.episodes > 0 for at in node), latest)
    sentence = cut_short(stopped_by, final, it.events, end)
    if sentence != "":
        return sentence
    return ending(stopped_by, final, end, f"{it.events} events", known["acting"], known["held"])


def _told(accuracy: Mapping[str, float]) -> str:
    """What is told of the effect of rounded transit times."""
    if not accuracy:
        return ""
    if math.inf in accuracy.values():
        return " The error that this makes is not known."
    return f" Stated relative error: {max(accuracy.values()):.1g}."


def effect_of_rounding(run: FrontRun) -> Mapping[str, float]:
    """Error of each measure of the outcome by transit times that the clock has rounded.

    They lie between those in use and the next tick on the other side. The outcome is compared with
    that of a second run there, and differs more from it than from the true one.
    """
    if run.clock.transit_error <= ROUNDED or run.stopped_by == "max_events":
        return NO_ROUNDING
    other = beside(run)
    if other.stopped_by != run.stopped_by:
        return dict.fromkeys(MEASURES, math.inf)
    found = {}
    for name, here, there in zip(MEASURES, _measured(run), _measured(other), strict=True):
        change = max((abs(x - y) for x, y in zip(here, there, strict=True)), default=0.0)
        scale = max(map(abs, here), default=0.0)
        if name == VELOCITY:
            scale = run.run.scale
        found[name] = change / scale if change > 0 else 0.0
    return found


def _measured(run: FrontRun) -> list[list[float]]:
    """What `MEASURES` names, by body or by contact."""
    tallies, tick = tallies_of(run), run.clock.tick
    return [
        list(totals_of(run, tallies).velocities[1]), [t.impulse for t in tallies],
        [t.peak_force for t in tallies], [t.duration for t in tallies],
        [getattr(run.node[k], name) * tick for name in ("first", "last", "opened")
         for k in run.plan.contacts],
    ]


def beside(run: FrontRun) -> FrontRun:
    """The same row with rounded transit times a tick longer or shorter: beyond the true ones."""
    a = run.clock
    ticks = list(a.ticks)
    for s in range(1, len(ticks) - 1):
        off = ticks[s] * a.tick / (a.length[s] / a.wave_speed[s]) - 1
        if abs(off) > EXACT:
            ticks[s] += -1 if off > 0 and ticks[s] > 1 else 1
    return FrontRun(driver.run_on(run.members.with_ticks(ticks, MORE * run.run.events + MORE)))


def cut_short(stopped_by: str, final: str, events: int, end: str) -> str:
    """What ended a run that the cap or the clock cut short; "" for others."""
    if stopped_by == "max_events" and final == "":
        return (
            f"Stopped by the cap of {events} events at {end}; fronts multiply where transit "
            "times have no common measure. Raise max_events, or make lengths commensurate."
        )
    if stopped_by == "clock":
        return (
            f"Stopped by the clock after {end}: the next contact may come later than the clock can "
            "count, or never. Give until= to set another end."
        )
    return ""


def ends_of_contacts(
    node: Sequence[Any], contacts: Sequence[int], tick: float
) -> list[list[float]]:
    """When the force and the touch of each contact that pressed ended, as `last_contact` asks."""
    pressed = [node[k] for k in contacts if node[k].status >= Status.OPEN and node[k].episodes > 0]
    return [
        [math.nan if at.status == Status.PRESS else at.last * tick,
         math.nan if at.status >= Status.GRAZE else at.opened * tick]
        for at in pressed
    ]


def pressing(node: Sequence[Any], contacts: Sequence[int], names: Sequence[str]) -> str:
    """What is said where contacts go on pressing for ever."""
    found = ", ".join([
        names[i] for i, k in enumerate(contacts)
        if node[k].status == Status.PRESS and node[k].force > ROUND_OFF * node[k].peak
    ])
    if found == "":
        return ""
    return f"Nothing changes any more; contact {found} goes on pressing."


def tallies_of(run: FrontRun) -> tuple[ContactTally, ...]:
    """Totals of every contact in SI units."""
    return tuple(tally_of(run.node[k], run.clock.tick) for k in run.plan.contacts)


def tally_of(at: Any, tick: float) -> ContactTally:
    """Totals of the contact at a node, in SI units; the page has this as JavaScript."""
    return ContactTally(
        at.impulse * tick, at.peak, at.pressed * tick,
        at.first * tick if at.first != NONE else math.nan,
        at.last * tick if at.last != NONE else math.nan, at.episodes)


def totals_of(run: FrontRun, tallies: Sequence[ContactTally]) -> Totals:
    """Read the totals off a finished run."""
    a, scale = run.clock, run.run.scale
    system, count, first = a.system, len(a.spans), heads(a.system, a.spans)
    masses = [a.mass(i) for i in range(count)]
    velocity, momentum, vibration = (
        [[getattr(s, name) for s in run.segment] for name in names] for names in (
            ("initial", "velocity"), ("initial_momentum", "momentum"),
            ("initial_vibration", "vibration")))
    before, after = (
        [float(v) for v in body_velocities(system, [stock[s] + a.frame for s in first])]
        for stock in velocity
    )
    vibration_before, vibration_after = (
        [math.fsum(stock[s : e + 1]) * a.tick for s, e in a.spans] for stock in vibration
    )
    kinetic_before, kinetic_after = (
        sum(m * (stock[s] + a.frame) ** 2 / 2
            for m, (s, e) in zip(masses, a.spans, strict=True) if e) for stock in velocity
    )
    absolute, outside_impulse, wall_work, lent = run.run.absolute, 0.0, 0.0, 0.0
    for i, k, sign in ((0, 0, 1), (count - 1, count - 2, -1)):
        if masses[i] == math.inf:
            impulse = sign * tallies[k].impulse
            outside_impulse += impulse
            wall_work += impulse * after[i]
            absolute += abs(impulse)
            if isinstance(system.contacts[k], Bonded):  # the wall lends energy and takes it back
                group = next(g for g in groups(system) if i in g)
                swinging = sum(masses[j] for j in group if masses[j] < math.inf)
                lent += swinging * abs(after[i]) * scale
    drive_work = radiated = 0.0
    for end, node, sign in zip(system.ends, (0, -1), (1, -1), strict=True):
        if isinstance(end, Free):
            continue
        impulse = run.node[node].impulse * a.tick
        work = sign * (run.node[node].work * a.tick + a.frame * impulse)
        outside_impulse += sign * impulse
        absolute += abs(impulse)
        if isinstance(end, Absorbing):
            radiated -= work
        elif not isinstance(end, Fixed):
            drive_work += work
        if not isinstance(end, Fixed):  # what goes in and out again is no more exact than this
            mass = sum(m for m in masses if m < math.inf)
            absolute += mass * scale
            lent += mass * scale**2 / 2
    gained = math.fsum(momentum[1]) - math.fsum(momentum[0])
    missing = gained * a.tick - outside_impulse
    energy_before = kinetic_before + sum(vibration_before)
    energy_gained = kinetic_after + sum(vibration_after) - energy_before
    turnover = energy_before + abs(wall_work) + lent + abs(drive_work) + abs(radiated)
    return Totals(
        masses=masses, velocities=(before, after), kinetic=(kinetic_before, kinetic_after),
        vibration=(vibration_before, vibration_after),
        momentum=(missing, absolute),
        energy=(energy_gained - wall_work - drive_work + radiated, turnover),
        works={"wall_work": wall_work, "drive_work": drive_work, "radiated": radiated},
    )


# Families -----------------------------------------------------------------------------------------


def together(row: Row) -> int:
    """How many members to run in one call."""
    n, numbers = len(row.segments), len(plan_of(row).numbers)
    return int(max(1, min(MOST_MEMBERS, MOST_BYTES // (8 * (numbers + 6 * (n + 2))))))


def solve_family(
    row: Row, until: float | None, max_events: int, stop: Callable[[], bool] = lambda: False,
    more: int = 0, also: Sequence[str] = (),
) -> FamilyRun:
    """Totals of every member, and what is wanted of `READ`; arguments as of `solve_many`."""
    plan, system, shape = plan_of(row), row.system, row.system.shape
    reads = not {"displacement", "largest_stress"}.isdisjoint(also)
    run = driver.solve_many(plan, until, max_events, stop, more, reads)
    final, refused = run["final"] & (not physics.driven(system)), run["stop"] >= Stop.OVERFLOW
    unknown = np.where(refused, math.nan, 0.0)
    stocks = ([x.reshape(shape) for x in run[name].T] for name in ("before", "after"))
    before, after = (
        [unknown + np.broadcast_to(v, shape).ravel() for v in body_velocities(system, own)]
        for own in ([stock[s] for s in heads(system, row.spans)] for stock in stocks)
    )
    contacts = {"episodes": [run["episodes"][:, k] for k in plan.contacts]}
    for name in ("impulse", "peak_force", "duration"):
        contacts[name] = [unknown + run[name][:, k] for k in plan.contacts]
    capped = (run["stop"] == Stop.CAP) & (~final | (until is not None))
    reasons = [capped, run["stop"] == Stop.CLOCK, refused, final & (until is None)]
    places = [STOPPED_BY.index(name) for name in ("max_events", "clock", "refused", "final")]
    return FamilyRun(
        before, after, unknown + run["vibration"], contacts, final,
        np.select(reasons, places, STOPPED_BY.index("until")),
        {"dissipated": unknown, **(_read(row, run, unknown) if reads else {})},
    )


def _read(row: Row, run: Mapping[str, Array], unknown: Array) -> dict[str, Array]:
    """Columns of what was read of the waves. Where bodies are walls nothing is: they move on."""
    columns, shape = dict[str, Array](), row.system.shape
    for i, (body, (first, last)) in enumerate(zip(row.system.bodies, row.spans, strict=True)):
        if not last:
            speed: Any = np.broadcast_to(np.asarray(body.velocity), shape).ravel()
            columns[f"displacement.{i}"] = unknown + speed * run["time"]
            continue
        inside = range(first, last + 1)
        pieces = [row.segments[s - 1] for s in inside]
        masses = [np.broadcast_to(piece.mass, shape).ravel() for piece in pieces]
        paths = [m * run["moved"][:, s] for m, s in zip(masses, inside, strict=True)]
        columns[f"displacement.{i}"] = unknown + sum(paths) / sum(masses)
        stresses = [
            np.broadcast_to(piece.material.youngs_modulus / (2 * piece.wave_speed), shape).ravel()
            * run["parted"][:, s] for piece, s in zip(pieces, inside, strict=True)
        ]
        columns[f"largest_stress.{i}"] = unknown + reduce(np.maximum, stresses)
    return columns
