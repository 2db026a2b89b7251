"""The method "fronts": every wave front is followed from end to end, exactly."""

import math
from collections.abc import Callable, Mapping

import numpy as np

from .. import abilities as physics
from .. import run as runs
from ..duration import Forecast, Progress
from ..row import Array, Row
from ..run import Run
from ..status import ROUNDED, rounding, strain_warning
from . import driver
from .batch import RunRequest
from .family_layout import lay_out_family
from .run import FrontRun
from .signals import signals_of
from .status import status_of
from .totals import last_contact_end, tally_of, totals_of

LACKS = (
    physics.MASSES,
    physics.COMPLIANCE,
    physics.JOINTS,
    physics.GRAVITY,
    physics.SMOOTH_STATES,
    physics.SMOOTH_DRIVES,
    physics.DAMPING,
    physics.LATERAL,
    physics.TAPER,
    physics.OWN_LAWS,
)
REMEDY = "an earlier end (until), or a lower cap (max_events),"
RERUN_EVENT_FACTOR = 4  # cap on events of a run with perturbed transit times
NO_ROUNDING: Mapping[str, float] = {}


def solve(
    row: Row,
    until: float | None,
    max_events: int,
    progress: Progress | None = None,
    announce: Callable[[str], None] | None = None,
) -> Run:
    """Run a single collision.

    It runs to `until`, s, or to its proof of finality and one round trip more.
    """
    run = run_fronts(row, until, max_events, Forecast(announce, REMEDY, progress))
    return make_run(run, until, effect_of_rounding(run))


def run_fronts(
    row: Row,
    until: float | None = None,
    max_events: int = runs.MAX_EVENTS,
    forecast: Forecast | None = None,
) -> FrontRun:
    """Follow every front of a collision."""
    request = RunRequest(until, max_events)
    return FrontRun(driver.solve_one(lay_out_family(row), request, forecast))


def make_run(
    run: FrontRun, until: float | None, accuracy: Mapping[str, float] = NO_ROUNDING
) -> Run:
    """The form of a finished run that all methods return."""
    clock = run.clock
    now = run.run.now
    t_end = now * clock.tick
    if until is not None and run.stopped_by == "until":
        t_end = until
    t_final = math.nan
    t_proved = math.nan
    if run.is_proved:
        t_final = last_contact_end(
            run.run, run.contacts, 2 * clock.longest * clock.tick
        )
        t_proved = run.proved_tick * clock.tick
    strain = run.run.max_wave / min(clock.wave_speed[1:-1])
    status = status_of(run.run, run.contacts, clock.system, run.is_proved, t_final)
    status += rounding(clock.transit_error, clock.worst)
    status += strain_warning(strain)
    status += accuracy_sentence(accuracy)
    return Run(
        method="fronts",
        until=until,
        clock=clock,
        end=now,
        t_end=t_end,
        t_final=t_final,
        t_proved=t_proved,
        stopped_by=run.stopped_by,
        status=status,
        events=run.run.events,
        contacts=tuple(tally_of(node, clock.tick) for node in run.contacts),
        totals=totals_of(run),
        accuracy=accuracy,
        make_signals=lambda: signals_of(run),
    )


# Rounded transit times ----------------------------------------------------------------


def effect_of_rounding(run: FrontRun) -> Mapping[str, float]:
    """Relative error of each measure of the outcome that rounded transit times make.

    The exact transit time lies between the rounded one and the next tick on its other
    side. A second run uses that tick. The difference between both outcomes exceeds the
    error.
    """
    if run.clock.transit_error <= ROUNDED or run.stopped_by == "max_events":
        return NO_ROUNDING
    request = RunRequest(
        until=run.until,
        max_events=RERUN_EVENT_FACTOR * (run.run.events + 1),
        perturb_rounding=True,
    )
    other = FrontRun(driver.solve_one(run.layout, request))
    if other.stopped_by != run.stopped_by:
        return dict.fromkeys(runs.MEASURES, math.inf)
    errors: dict[str, float] = {}
    other_measures = measures_of(other)
    for name, values in measures_of(run).items():
        largest_change = float(np.abs(values - other_measures[name]).max(initial=0.0))
        scale = np.abs(values).max(initial=0.0)
        if name == runs.VELOCITY:
            scale = run.run.velocity_scale
        errors[name] = 0.0
        if largest_change > 0:
            errors[name] = largest_change / scale
    return errors


def measures_of(run: FrontRun) -> dict[str, Array]:
    """Values of each of `runs.MEASURES`, by body or by contact."""
    tick = run.clock.tick
    tallies = [tally_of(node, tick) for node in run.contacts]
    times: list[float] = []
    for node in run.contacts:
        times.append(node.first_force_tick * tick)
        times.append(node.last_force_tick * tick)
        times.append(node.last_opening_tick * tick)
    return {
        runs.VELOCITY: np.array(totals_of(run).velocities[1]),
        runs.IMPULSE: np.array([tally.impulse for tally in tallies]),
        runs.PEAK_FORCE: np.array([tally.peak_force for tally in tallies]),
        runs.DURATION: np.array([tally.duration for tally in tallies]),
        runs.TIME: np.array(times),
    }


def accuracy_sentence(accuracy: Mapping[str, float]) -> str:
    """Sentence that states the error by rounded transit times."""
    if not accuracy:
        return ""
    largest = max(accuracy.values())
    if largest == math.inf:
        return " The error that this makes is not known."
    return f" Stated relative error: {largest:.1g}."
