"""The method "fronts": every wave front is followed from end to end, exactly."""

import math
from collections.abc import Mapping

from ...progress import ProgressReport, no_report
from .. import abilities as physics
from .. import run as runs
from ..row import Row
from ..run import Run
from ..status import rounding_sentence, strain_warning, with_advice
from . import driver
from .accuracy import (
    NO_ERRORS,
    accuracy_sentence,
    effect_of_rounding,
    with_faint_forces,
)
from .batch import RunRequest
from .family_layout import lay_out_family
from .run import FrontRun
from .signals import signals_of
from .status import end_of_run, faint_sentence
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
    physics.SOIL,
    physics.DRAG,
    physics.OWN_LAWS,
)


def solve(
    row: Row,
    until: float | None,
    max_events: int,
    report: ProgressReport = no_report,
) -> Run:
    """Run a single collision by fronts; return the `Run` that all methods return.

    It runs to `until`, s, or, if that is None, to one round trip of the longest body
    after its proof of finality, but for at most `max_events` events. `report` is called
    with the progress of a long run. If transit times were rounded, a second run finds
    the errors.

    Raises
    ------
    InvalidModel
        If no clock can count the run, or energies overflow.
    TooLong
        If the run takes too much memory.
    """
    finished = run_fronts(row, until, max_events, report)
    return make_run(finished, until, effect_of_rounding(finished))


def run_fronts(
    row: Row,
    until: float | None = None,
    max_events: int = runs.MAX_EVENTS,
    report: ProgressReport = no_report,
) -> FrontRun:
    """Run a single collision, and return the run with its records.

    The arguments, and the errors raised, are those of `solve`. There is no second run.
    """
    request = RunRequest(until, max_events)
    return FrontRun(driver.solve_one(lay_out_family(row), request, report))


def make_run(
    finished: FrontRun,
    until: float | None,
    rounding_errors: Mapping[str, float] = NO_ERRORS,
) -> Run:
    """Make the `Run` that all methods return from a finished run to `until`, s.

    The `Run` has the time of the proof, `t_proved`, and the end of the last contact,
    `t_final`, both nan without a proof. With a proof, `t_final` may be inf or nan, see
    `last_contact_end`. It also has the status in sentences, totals of the contacts and
    of the row, and a function that makes the signals. `rounding_errors` are those of
    `effect_of_rounding`, by measure; errors from faint forces are added.
    """
    clock = finished.clock
    now = finished.run.now
    t_end = now * clock.tick
    if until is not None and finished.stopped_by == "until":
        t_end = until  # not rounded to ticks
    t_final = math.nan
    t_proved = math.nan
    if finished.is_proved:
        # Bodies that still touch may part within a round trip of the longest rod.
        # `longest_rod` is the ticks of a wave through it.
        round_trip = 2 * clock.longest_rod * clock.tick  # s
        t_final = last_contact_end(finished.run, finished.contacts, round_trip)
        t_proved = finished.proved_tick * clock.tick
    return Run(
        method="fronts",
        until=until,
        clock=clock,
        end=now,
        t_end=t_end,
        t_final=t_final,
        t_proved=t_proved,
        stopped_by=finished.stopped_by,
        status=status_of(finished, t_final, rounding_errors),
        events=finished.run.events,
        contacts=tuple(tally_of(node, clock.tick) for node in finished.contacts),
        totals=totals_of(finished),
        accuracy=with_faint_forces(finished, rounding_errors),
        make_signals=lambda: signals_of(finished),
    )


def status_of(
    finished: FrontRun, t_final: float, rounding_errors: Mapping[str, float]
) -> str:
    """Sentences on the end of a run, rounding, large strains and faint forces.

    The first sentence, why the run ended, is always there, the others only where they
    apply. `t_final` is the end of the last contact, s; `rounding_errors` are relative
    errors by measure, as in `make_run`.
    """
    clock = finished.clock
    run_end = end_of_run(
        finished.run, finished.contacts, clock.system, finished.is_proved, t_final
    )
    # Entries 0 and -1 belong to the outside, and have no wave speed.
    slowest = min(clock.wave_speed[1:-1])
    # abs(b - a)/(2 c) is at most the largest wave over c.
    max_strain = finished.run.max_wave / slowest
    status = with_advice(run_end)
    status += rounding_sentence(clock.transit_error, clock.worst_path)
    status += strain_warning(max_strain)
    status += accuracy_sentence(rounding_errors)
    return status + faint_sentence(finished.run, finished.contacts, clock.system)
