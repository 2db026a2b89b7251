"""The method "fronts": every wave front from end to end, exact, for what fronts can carry."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...units import format_si
from .. import abilities as physics
from ..duration import Forecast, Progress
from ..row import Row
from ..run import MEASURES, VELOCITY, Run
from ..status import (
    ROUNDED,
    end_sentence,
    last_contact,
    proof_sentence,
    rounding,
    strain_warning,
)
from .assembly import Assembly, assemble
from .front_kernel import GRAZE, OPEN, PRESS, State, Tally
from .layout_kernel import TOLERANCE
from .signals import signals_of
from .totals import tallies_of, totals_of
from .tracking import FrontRun, track

LACKS = (
    physics.MASSES, physics.COMPLIANCE, physics.JOINTS, physics.GRAVITY, physics.SMOOTH_STATES,
    physics.SMOOTH_DRIVES, physics.DAMPING, physics.LATERAL, physics.TAPER, physics.OWN_LAWS,
)
ROUND_OFF = 2.0**-40  # of the peak force: a contact that presses less has come to rest
LESS = "an earlier end (until), or a lower cap (max_events),"
EXACT = 2.0**-48  # relative change of a transit time that is round-off
MORE = 4  # times the events of a run that another may take, beside rounded transit times
NO_ROUNDING: Mapping[str, float] = {}


def solve(
    row: Row, until: float | None, max_events: int, progress: Progress | None = None,
    announce: Callable[[str], None] | None = None,
) -> Run:
    """Run a single collision to `until`, s, or to its proof of finality and one round trip more."""
    forecast = Forecast(announce, LESS, progress)
    run = track(assemble(row, until), until, max_events, forecast)
    return hand_over(run, until, effect_of_rounding(run, until))


def hand_over(
    run: FrontRun, until: float | None, accuracy: Mapping[str, float] = NO_ROUNDING
) -> Run:
    """What every method hands back, of a run to `until`."""
    a, tallies = run.assembly, tallies_of(run)
    proved, t_final = run.finality_time >= 0, math.nan
    if proved:
        ends = ends_of_contacts(run.state, run.tally, a.nodes, a.tick)
        t_final = last_contact(ends, run.end * a.tick, 2 * a.longest * a.tick)
    return Run(
        method="fronts", until=until, clock=a, end=run.end,
        t_end=until if until is not None and run.stopped_by == "until" else run.end * a.tick,
        t_final=t_final, t_proved=run.finality_time * a.tick if proved else math.nan,
        stopped_by=run.stopped_by, status=_status(run, t_final) + _told(accuracy),
        events=run.events, accuracy=accuracy,
        contacts=tallies, totals=totals_of(run, tallies), make_signals=lambda: signals_of(run),
    )


def _status(run: FrontRun, t_final: float) -> str:
    """Why the run ended, and what to do if that is not enough."""
    a, values = run.assembly, run.log.value
    final = "" if run.finality_time < 0 else pressing(
        run.state, run.tally, a.nodes) or proof_sentence(any(run.tally.episodes), t_final)
    end = format_si(run.end * a.tick, "s")
    sentence = cut_short(run.stopped_by, final, run.events, end) or end_sentence(
        a.system, run.stopped_by, final, end, f"{run.events} events")
    fastest = max(map(abs, values)) if isinstance(values, list) else float(np.abs(values).max())
    return (
        sentence + rounding(a.transit_error, a.worst)
        + strain_warning(fastest / min(a.wave_speed[1:-1]))
    )


def _told(accuracy: Mapping[str, float]) -> str:
    """What is told of the effect of rounded transit times."""
    if not accuracy:
        return ""
    if math.inf in accuracy.values():
        return " The error that this makes is not known."
    return f" Stated relative error: {max(accuracy.values()):.1g}."


def effect_of_rounding(run: FrontRun, until: float | None) -> Mapping[str, float]:
    """Error of each measure of the outcome by transit times that the clock has rounded.

    They lie between those in use and the next tick on the other side. The outcome is compared with
    that of a second run there, and differs more from it than from the true one.
    """
    a = run.assembly
    if a.transit_error <= ROUNDED or run.stopped_by == "max_events":
        return NO_ROUNDING
    other = track(beside(a), until, MORE * run.events + MORE)
    if other.stopped_by != run.stopped_by:
        return dict.fromkeys(MEASURES, math.inf)
    found = {}
    for name, here, there in zip(MEASURES, _measured(run), _measured(other), strict=True):
        change = max((abs(x - y) for x, y in zip(here, there, strict=True)), default=0.0)
        scale = max(map(abs, here), default=0.0)
        if name == VELOCITY:
            scale = a.tolerance / TOLERANCE
        found[name] = change / scale if change > 0 else 0.0
    return found


def _measured(run: FrontRun) -> list[list[float]]:
    """What `MEASURES` names, by body or by contact."""
    tallies, tick, t = tallies_of(run), run.assembly.tick, run.tally
    return [
        list(totals_of(run, tallies).velocities[1]), [t.impulse for t in tallies],
        [t.peak_force for t in tallies], [t.duration for t in tallies],
        [at[k] * tick for at in (t.first, t.last, t.opened) for k in run.assembly.nodes],
    ]


def beside(a: Assembly) -> Assembly:
    """The same row with rounded transit times a tick longer or shorter: beyond the true ones."""
    ticks, waves = list(a.ticks), [list(fronts) for fronts in a.waves]
    for s in range(1, len(ticks) - 1):
        off = ticks[s] * a.tick / (a.length[s] / a.wave_speed[s]) - 1
        if abs(off) > EXACT:
            ticks[s] += -1 if off > 0 and ticks[s] > 1 else 1
        for line in (2 * s, 2 * s + 1):
            waves[line][0] = -ticks[s], waves[line][0][1]
    return replace(a, ticks=ticks, waves=waves)


def cut_short(stopped_by: str, final: str, events: int, end: str) -> str:
    """What ended a run that the cap or the clock cut short; "" for others."""
    if stopped_by == "max_events" and final == "":
        return (
            f"Stopped by the cap of {events} events at {end}; fronts multiply where transit "
            "times have no common measure. Raise max_events, or make lengths commensurate."
        )
    if stopped_by == "clock":
        return (
            f"Stopped by the clock after {end}: a contact may close later than it can count, if "
            "ever. Give until= to set another end."
        )
    return ""


def ends_of_contacts(
    state: State, tally: Tally, nodes: Sequence[int], tick: float
) -> list[list[float]]:
    """When the force and the touch of each contact that pressed ended, as `last_contact` asks."""
    return [
        [
            math.nan if state.status[node] == PRESS else tally.last[node] * tick,
            math.nan if state.status[node] >= GRAZE else tally.opened[node] * tick,
        ]
        for node in nodes if state.status[node] >= OPEN and tally.episodes[node] > 0
    ]


def pressing(state: State, tally: Tally, nodes: Sequence[int]) -> str:
    """What is said where contacts go on pressing for ever."""
    found = ", ".join([
        f"{i}" for i, node in enumerate(nodes)
        if state.status[node] == PRESS and state.force[node] > ROUND_OFF * tally.peak[node]
    ])
    if found == "":
        return ""
    return f"Nothing changes any more; contact {found} goes on pressing."
