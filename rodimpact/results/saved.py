"""A saved solution is its case and its outcome.

The outcome is compared when the case is solved again. Two runs of one case agree to the
sum of their stated errors. Velocities, impulses, peak forces, force durations and times
of contacts have stated errors. Energies have none: since they are quadratic in
velocities, they are compared to twice the error of velocities and impulses.
"""

import math
from typing import Any

from ..methods.registry import Options
from ..methods.run import DURATION, IMPULSE, MEASURES, VELOCITY
from ..model.frozen import defaults_of
from ..storage.case import Case
from ..storage.saved_result import (
    COUNT,
    ENERGY,
    MEASURE_OF,
    OUTCOME_ENERGIES,
    SavedResult,
)
from ..version import __version__

ROUND_OFF_PER_ARRIVAL = 2.0**-48
"""Relative round-off of a wave for each end that it has passed."""
MAX_LISTED_DIFFERENCES = 5  # differences that a message lists


class OutcomeDiffers(UserWarning):
    """A saved case, solved again, has another outcome than the stored outcome.

    The difference exceeds the stated errors of both runs. Either the file was changed,
    or another version of rodimpact solved the case and one of the two stated errors is
    too small.

    Examples
    --------
    A program that shall stop instead:

    >>> import tempfile, warnings, rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
    ...     warnings.simplefilter("error", ri.OutcomeDiffers)
    ...     ri.solve(ri.System([rod, ri.Wall()])).save(f"{folder}/run.toml")
    ...     solution = ri.load(f"{folder}/run.toml")
    """


def case_of(solution: Any) -> Case:
    """The case of a solution: its system, the options that were given, and its outcome.

    Options with their default values are left out.
    """
    options = solution.options.to_dict()
    for name, default in defaults_of(Options).items():
        if options.get(name) == default:
            options.pop(name, None)
    return Case(solution.system, options, result=result_of(solution))


def result_of(solution: Any) -> SavedResult:
    """The part of the outcome that the file of a solution stores, with stated errors.

    It includes the version of rodimpact, the method, why the run stopped, and whether
    the collision is final. Names of numbers of bodies and contacts end in their index,
    such as ``impulse.0``.
    """
    outcome = solution.outcome
    numbers = {}
    for name in OUTCOME_ENERGIES:
        numbers[name] = float(getattr(outcome, name))
    for i, velocity in enumerate(outcome.velocities_after):
        numbers[f"velocity_after.{i}"] = velocity
        numbers[f"vibration_after.{i}"] = outcome.vibration_after[i]
    for k, tally in enumerate(outcome.contacts):
        for name, value in tally._asdict().items():
            numbers[f"{name}.{k}"] = value
    return SavedResult(
        version=__version__,
        method=solution.method,
        stopped_by=solution.stopped_by,
        status=outcome.status,
        final=outcome.final,
        numbers=numbers,
        accuracy=solution.accuracy,
    )


def difference(saved: SavedResult, solution: Any) -> str:
    """Compare the outcome of a solution with the stored one; return the differences.

    Parameters
    ----------
    saved : SavedResult
    solution : Solution
        Solution of the same case.

    Returns
    -------
    str
        Sentence on the entries that differ, "" if there are none. Numbers may differ by
        the stated errors; ``method``, ``stopped_by`` and ``final`` may not differ. The
        first `MAX_LISTED_DIFFERENCES` entries are listed, the others counted.
    """
    now = result_of(solution)
    reasons = []
    for name in ("method", "stopped_by", "final"):
        value = getattr(now, name)
        stored = getattr(saved, name)
        if value != stored:
            reasons.append(f"{name} is {value!r}, stored is {stored!r}")
    allowed = _allowed_differences(saved, now, solution)
    for name, number in now.numbers.items():
        stored = saved.numbers[name]
        kind, _, _ = name.partition(".")
        largest = allowed[kind]
        if not _agree(number, stored, largest):
            both = f"{name} is {number!r}, stored is {stored!r}"
            reasons.append(
                f"{both}, and stated errors allow a difference of {largest:.1g}"
            )
    if not reasons:
        return ""
    listed = "; ".join(reasons[:MAX_LISTED_DIFFERENCES])
    if len(reasons) > MAX_LISTED_DIFFERENCES:
        listed += f"; and {len(reasons) - MAX_LISTED_DIFFERENCES} entries more"
    head = "the outcome differs from the stored one by more than the stated errors"
    return f"{head} (saved by rodimpact {saved.version}): {listed}"


def _allowed_differences(
    saved: SavedResult, now: SavedResult, solution: Any
) -> dict[str, float]:
    """Largest differences that the stated errors of both runs allow, by kind of number.

    A kind is a name without an index, such as ``impulse``. Each kind has a measure, see
    `MEASURE_OF`, with a stated relative error, 0 if none is stated. The difference is
    the sum of the errors of both runs and of round-off, times the scale of the measure,
    which is its largest number in either run. It is inf if the error is inf.
    """
    outcome = solution.outcome
    errors = {}  # relative, by measure
    for measure in MEASURES:
        stored_error = saved.accuracy.get(measure, 0.0)
        errors[measure] = stored_error + now.accuracy.get(measure, 0.0)
    # An energy is a square of velocities or impulses: its relative error doubles.
    errors[ENERGY] = 2 * max(errors[VELOCITY], errors[IMPULSE])
    # Where durations are unknown, weak forces may make further episodes.
    errors[COUNT] = 0.0
    if errors[DURATION] == math.inf:
        errors[COUNT] = math.inf
    # The largest numbers by measure, in SI units. Velocities and energies are at least
    # those before the collision.
    scales = dict.fromkeys(errors, 0.0)
    scales[VELOCITY] = solution.run.clock.scale
    scales[ENERGY] = outcome.kinetic_before + sum(outcome.vibration_before)
    for numbers in (saved.numbers, now.numbers):
        for name, number in numbers.items():
            kind, _, _ = name.partition(".")
            measure = MEASURE_OF[kind]
            if math.isfinite(number):
                scales[measure] = max(scales[measure], abs(number))
    round_off = ROUND_OFF_PER_ARRIVAL * (1 + solution.events)
    allowed = {}
    for kind, measure in MEASURE_OF.items():
        error = errors[measure] + round_off
        if error < math.inf:
            allowed[kind] = error * scales[measure]
        else:
            allowed[kind] = math.inf  # inf times a scale of 0 would be nan
    return allowed


def _agree(value: float, stored: float, allowed: float) -> bool:
    """Whether two numbers differ by no more than `allowed`.

    If `allowed` is inf, the result is always True. Else nan only agrees with nan, and
    an infinite number only with the same infinite number.
    """
    if allowed == math.inf or value == stored:
        return True
    if math.isnan(value):
        return math.isnan(stored)
    return abs(value - stored) <= allowed
