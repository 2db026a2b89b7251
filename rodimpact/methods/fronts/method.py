"""The method "fronts": every wave front from end to end, exact, for what fronts can carry."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ...units import format_si
from .. import abilities as physics
from ..duration import Forecast, Progress
from ..row import Row
from ..run import Run
from ..status import end_sentence, proof_sentence, strain_warning
from .assembly import assemble
from .front_kernel import PRESS, State, Tally
from .signals import signals_of
from .totals import tallies_of, totals_of
from .tracking import FrontRun, track

LACKS = (
    physics.MASSES, physics.COMPLIANCE, physics.JOINTS, physics.GRAVITY, physics.SMOOTH_STATES,
    physics.SMOOTH_DRIVES, physics.DAMPING, physics.LATERAL, physics.TAPER,
)
ROUND_OFF = 2.0**-40  # of the peak force: a contact that presses less has come to rest
LESS = "an earlier end (until), or a lower cap (max_events),"
ROUNDED = 2.0**-36  # relative change of a transit time that is told


def solve(
    row: Row, until: float | None, max_events: int, progress: Progress | None = None,
    announce: Callable[[str], None] | None = None,
) -> Run:
    """Run a single collision to `until`, s, or to its proof of finality and one round trip more."""
    forecast = Forecast(announce, LESS, progress)
    return hand_over(track(assemble(row, until), until, max_events, forecast), until)


def hand_over(run: FrontRun, until: float | None) -> Run:
    """What every method hands back, of a run to `until`."""
    a, tallies = run.assembly, tallies_of(run)
    return Run(
        method="fronts", until=until, clock=a, end=run.end,
        t_end=until if until is not None and run.stopped_by == "until" else run.end * a.tick,
        t_final=run.finality_time * a.tick if run.finality_time >= 0 else math.nan,
        stopped_by=run.stopped_by, status=_status(run), events=run.events,
        contacts=tallies, totals=totals_of(run, tallies), make_signals=lambda: signals_of(run),
    )


def _status(run: FrontRun) -> str:
    """Why the run ended, and what to do if that is not enough."""
    a, values = run.assembly, run.log.value
    final = "" if run.finality_time < 0 else pressing(
        run.state, run.tally, a.nodes) or proof_sentence(
        any(run.tally.episodes), run.stopped_by == "until" and run.finality_time >= run.end,
        run.finality_time * a.tick,
    )
    end = format_si(run.end * a.tick, "s")
    sentence = cut_short(run.stopped_by, final, run.events, end) or end_sentence(
        a.system, run.stopped_by, final, end, f"{run.events} events")
    fastest = max(map(abs, values)) if isinstance(values, list) else float(np.abs(values).max())
    return (
        sentence + rounding(a.transit_error, a.worst)
        + strain_warning(fastest / min(a.wave_speed[1:-1]))
    )


def rounding(error: float, path: str) -> str:
    """What is told of transit times that the clock has changed by so much of themselves."""
    if error <= ROUNDED:
        return ""
    return f" The transit time of {path} was rounded by {error:.2g} of itself to fit the clock."


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


def pressing(state: State, tally: Tally, nodes: Sequence[int]) -> str:
    """What is said where contacts go on pressing for ever."""
    found = ", ".join([
        f"{i}" for i, node in enumerate(nodes)
        if state.status[node] == PRESS and state.force[node] > ROUND_OFF * tally.peak[node]
    ])
    if found == "":
        return ""
    return f"Nothing changes any more; contact {found} goes on pressing."
