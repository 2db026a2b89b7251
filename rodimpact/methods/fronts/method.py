"""The method "fronts": every wave front from end to end, exact, for what fronts can carry."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from typing import Any

import numpy as np

from ...model import Absorbing, Bonded, Fixed, Free
from ...model.numbering import contact_names
from ...units import format_si
from .. import abilities as physics
from .. import run as runs
from ..duration import Forecast, Progress
from ..groups import body_velocities, heads
from ..laws import Status, Stop
from ..row import Array, Row
from ..run import ContactTally, Run
from ..status import ROUNDED, ending, last_contact, proof_sentence, rounding, strain_warning
from . import driver
from .plan import plan_of
from .records import NONE
from .run import REASONS, FrontRun
from .signals import signals_of

LACKS = (
    physics.MASSES, physics.COMPLIANCE, physics.JOINTS, physics.GRAVITY, physics.SMOOTH_STATES,
    physics.SMOOTH_DRIVES, physics.DAMPING, physics.LATERAL, physics.TAPER, physics.OWN_LAWS,
)
ROUND_OFF = 2.0**-40  # of the peak force: a contact that presses less has come to rest
LESS = "an earlier end (until), or a lower cap (max_events),"
MORE = 4  # times the events of a run that another may take, beside rounded transit times
NO_ROUNDING: Mapping[str, float] = {}
TALLY = "impulse", "peak_force", "duration", "episodes"
MOST_MEMBERS, MOST_BYTES = 16384, 1 << 24  # of one call of `solve_family`, for memory's sake


def solve(
    row: Row, until: float | None, max_events: int, progress: Progress | None = None,
    announce: Callable[[str], None] | None = None,
) -> Run:
    """Run a single collision to `until`, s, or to its proof of finality and one round trip more."""
    run = track(row, until, max_events, Forecast(announce, LESS, progress))
    return hand_over(run, until, effect_of_rounding(run))


def track(
    row: Row, until: float | None = None, max_events: int = runs.MAX_EVENTS,
    forecast: Forecast | None = None,
) -> FrontRun:
    """Follow every front of a collision."""
    return FrontRun(driver.solve_one(plan_of(row), until, max_events, forecast))

# What a run came to -------------------------------------------------------------------------------


def hand_over(
    run: FrontRun, until: float | None, accuracy: Mapping[str, float] = NO_ROUNDING
) -> Run:
    """What every method hands back, of a run to `until`."""
    a, now, proved = run.clock, run.run.now, run.finality_time != NONE
    contacts = run.plan.contacts
    t_final = last_of(run.run, run.node, contacts, 2 * a.longest * a.tick) if proved else math.nan
    status = status_of(run.run, run.node, contacts, a.system, proved, t_final)
    tallies = tuple(tally_of(run.node[k], a.tick) for k in contacts)
    return Run(
        method="fronts", until=until, clock=a, end=now,
        t_end=until if until is not None and run.stopped_by == "until" else now * a.tick,
        t_final=t_final, t_proved=run.finality_time * a.tick if proved else math.nan,
        stopped_by=run.stopped_by, events=run.run.events, accuracy=accuracy,
        status=status + rounding(a.transit_error, a.worst)
        + strain_warning(run.run.fastest / min(a.wave_speed[1:-1])) + _told(accuracy),
        contacts=tallies, totals=totals_of(run), make_signals=lambda: signals_of(run),
    )


def status_of(
    it: Any, node: Sequence[Any], contacts: Sequence[int], system: Any, proved: bool, t_final: float
) -> str:
    """Why a run ended, from its records; the page has this as JavaScript.

    Parameters
    ----------
    it : RUN
    node : list of NODE
    contacts : list of int
        Node of each contact.
    system : System
    proved : bool
        Whether nothing meets again.
    t_final : float
        As of `last_of`, s.
    """
    stopped_by, final = REASONS[it.stop], ""
    pressing = [
        i for i, k in enumerate(contacts)
        if node[k].status == Status.PRESS and node[k].force > ROUND_OFF * node[k].peak
    ]
    if proved and len(pressing) > 0:
        names = contact_names([body.kind for body in system.bodies])
        those = ", ".join([names[i] for i in pressing])
        final = f"Nothing changes any more; contact {those} goes on pressing."
    elif proved:
        final = proof_sentence(any(at.episodes > 0 for at in node), t_final)
    if stopped_by == "final":
        return final
    end = format_si(it.now * it.tick, "s")
    if stopped_by == "max_events" and final == "":
        return (
            f"Stopped by the cap of {it.events} events at {end}; fronts multiply where transit "
            "times have no common measure. Raise max_events, or make lengths commensurate."
        )
    if stopped_by == "clock":
        return (
            f"Stopped by the clock after {end}: the next contact may come later than the clock can "
            "count, or never. Give until= to set another end."
        )
    return ending(stopped_by, final, end, f"{it.events} events", system)


def last_of(it: Any, node: Sequence[Any], contacts: Sequence[int], round_trip: float) -> float:
    """When the last contact ended in a proved run, s, as `last_contact` says."""
    pressed = [node[k] for k in contacts if node[k].status >= Status.OPEN and node[k].episodes > 0]
    ends = [
        [math.nan if at.status == Status.PRESS else at.last * it.tick,
         math.nan if at.status >= Status.GRAZE else at.opened * it.tick]
        for at in pressed
    ]
    return last_contact(ends, it.now * it.tick, round_trip)


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
    other = FrontRun(driver.solve_one(
        run.plan, None if run.run.until < 0 else run.run.until,
        MORE * run.run.events + MORE, beside=True))
    if other.stopped_by != run.stopped_by:
        return dict.fromkeys(runs.MEASURES, math.inf)
    found = {}
    for name, here, there in zip(runs.MEASURES, _measured(run), _measured(other), strict=True):
        scale = run.run.scale if name == runs.VELOCITY else np.abs(here).max(initial=0.0)
        change = float(np.abs(here - there).max(initial=0.0))
        found[name] = change / scale if change > 0 else 0.0
    return found


def _measured(run: FrontRun) -> list[Array]:
    """What `MEASURES` names, by body or by contact."""
    tick, nodes = run.clock.tick, [run.node[k] for k in run.plan.contacts]
    tallies = [tally_of(at, tick) for at in nodes]
    return list(map(np.array, (
        totals_of(run).velocities[1], [t.impulse for t in tallies],
        [t.peak_force for t in tallies], [t.duration for t in tallies],
        [getattr(at, name) * tick for name in ("first", "last", "opened") for at in nodes],
    )))


def tally_of(at: Any, tick: float) -> ContactTally:
    """Totals of the contact at a node, in SI units; the page has this as JavaScript."""
    return ContactTally(
        at.impulse * tick, at.peak, at.pressed * tick,
        at.first * tick if at.first != NONE else math.nan,
        at.last * tick if at.last != NONE else math.nan, at.episodes)


def totals_of(run: FrontRun) -> runs.Totals:
    """Read the totals off a finished run."""
    a, scale, system = run.clock, run.run.scale, run.clock.system
    masses = [a.mass(i) for i in range(len(a.spans))]
    moving = sum(m for m in masses if m < math.inf)
    beside = heads(system, a.spans)
    velocities, kinetic, vibration, momentum = [], [], [], []
    for names in (("initial", "initial_vibration", "initial_momentum"),
                  ("velocity", "vibration", "momentum")):
        own, energy, impulse = ([getattr(s, name) for s in run.segment] for name in names)
        means = body_velocities(system, [own[s] + a.frame for s in beside])
        velocities.append(list(map(float, means)))
        kinetic.append(sum(m * (own[s] + a.frame) ** 2 / 2
                           for m, (s, e) in zip(masses, a.spans, strict=True) if e))
        vibration.append([math.fsum(energy[s : e + 1]) * a.tick for s, e in a.spans])
        momentum.append(math.fsum(impulse))
    works = {"wall_work": 0.0, "drive_work": 0.0, "radiated": 0.0}
    absolute, pushed, lent = run.run.absolute, 0.0, 0.0
    for side, sign in ((0, 1), (-1, -1)):
        end, at = system.ends[side], run.node[side]
        impulse = sign * at.impulse * a.tick
        pushed += impulse
        absolute += abs(impulse)
        if masses[side] == math.inf:
            speed = velocities[1][side]
            works["wall_work"] += impulse * speed
            if isinstance(system.contacts[side], Bonded):  # it lends energy, and takes it back
                lent += moving * abs(speed) * scale
        elif not isinstance(end, Free | Fixed):
            work = sign * at.work * a.tick + a.frame * impulse
            absorbing = isinstance(end, Absorbing)
            works["radiated" if absorbing else "drive_work"] += -work if absorbing else work
            absolute += moving * scale  # what goes in and out again is no more exact than this
            lent += moving * scale**2 / 2
    before, after = (k + sum(v) for k, v in zip(kinetic, vibration, strict=True))
    missing = after - before - works["wall_work"] - works["drive_work"] + works["radiated"]
    return runs.Totals(
        masses=masses, velocities=(velocities[0], velocities[1]), kinetic=(kinetic[0], kinetic[1]),
        vibration=(vibration[0], vibration[1]),
        momentum=((momentum[1] - momentum[0]) * a.tick - pushed, absolute),
        energy=(missing, before + lent + sum(map(abs, works.values()))), works=works,
    )


# Families -----------------------------------------------------------------------------------------


def together(row: Row) -> int:
    """How many members to run in one call."""
    n, numbers = len(row.segments), len(plan_of(row).numbers)
    return int(max(1, min(MOST_MEMBERS, MOST_BYTES // (8 * (numbers + 6 * (n + 2))))))


def solve_family(
    row: Row, until: float | None, max_events: int, stop: Callable[[], bool] = lambda: False,
    more: int = 0, also: Sequence[str] = (),
) -> runs.FamilyRun:
    """Totals of every member, and what is wanted of `READ`; arguments as of `solve_many`."""
    plan, system, shape = plan_of(row), row.system, row.system.shape
    beside, nodes = heads(system, row.spans), range(len(plan.kinds))
    wanted = [(name, 0) for name in ("stop", "proved", "vibration")]
    wanted += [(name, s) for name in ("before", "after") for s in beside]
    wanted += [(name, k) for name in TALLY for k in plan.contacts]
    reads = not {"displacement", "largest_stress"}.isdisjoint(also)
    if reads:
        wanted += [("time", 0), ("frame", 0), *(("carried", k) for k in nodes)]
        wanted += [(name, s) for name in ("momentum", "parted") for s in nodes[1:]]
    told = driver.solve_many(plan, until, max_events, wanted, stop, more)
    refused = told["stop", 0] >= Stop.OVERFLOW

    def known(values: Array) -> Array:
        return np.where(refused, math.nan, values) if refused.any() else values

    further = {"dissipated": np.zeros(row.members), **(_read(row, told) if reads else {})}
    final = (told["proved", 0] > 0) & (not physics.driven(system))
    before, after = (
        [known(np.broadcast_to(v, shape).ravel())
         for v in body_velocities(system, [told[name, s].reshape(shape) for s in beside])]
        for name in ("before", "after"))
    return runs.FamilyRun(
        before, after, known(told["vibration", 0]),
        {name: [told[name, k] if name == "episodes" else known(told[name, k])
                for k in plan.contacts] for name in TALLY},
        final, runs.stopped_by(refused, final, told["stop", 0] == Stop.CAP, until),
        {name: known(column) for name, column in further.items()},
    )


def _read(row: Row, told: Mapping[Any, Array]) -> dict[str, Array]:
    """Columns of what was read of the waves. Where bodies are walls nothing is: they move on."""
    columns, shape, time = dict[str, Array](), row.system.shape, told["time", 0]
    for i, (body, (first, last)) in enumerate(zip(row.system.bodies, row.spans, strict=True)):
        if not last:
            speed: Any = np.broadcast_to(np.asarray(body.velocity), shape).ravel()
            columns[f"displacement.{i}"] = speed * time
            continue
        inside = range(first, last + 1)
        pieces = [row.segments[s - 1] for s in inside]
        mass = sum(np.broadcast_to(piece.mass, shape).ravel() for piece in pieces)
        brought = sum(told["momentum", s] for s in inside) * time
        pushed = told["carried", first - 1] - told["carried", last]
        columns[f"displacement.{i}"] = told["frame", 0] * time + (brought + pushed) / mass
        stresses = [
            np.broadcast_to(piece.material.youngs_modulus / (2 * piece.wave_speed), shape).ravel()
            * told["parted", s] for piece, s in zip(pieces, inside, strict=True)
        ]
        columns[f"largest_stress.{i}"] = reduce(np.maximum, stresses)
    return columns
