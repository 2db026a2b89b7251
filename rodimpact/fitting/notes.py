"""Notes of a fit: on numbers that are not determined, and on records with misfits."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ..model.quantities import Floats
from ..records.signal import Signal
from ..units import format_si
from .measured import Measured
from .parameters import share_of_range
from .result import Descent, Fitted, correlation_of

UNDETERMINED_ERROR = 0.5
"""A number whose standard error is a larger part of its range is not determined."""
AT_BOUND = 1e-3
"""Distance from a bound at which a number is at the bound, as a share of its range."""
HIGH_CORRELATION = 0.98
"""Correlation above which two numbers are hardly distinguishable."""
SAME_MISFIT_RTOL = 1e-3
SAME_MISFIT_ATOL = 1e-9
"""Misfits that differ by less, relative or absolute, count as equal."""
SAME_VALUE_ERRORS = 0.3
"""Values that differ by less, in standard errors, count as equal."""
MISFIT_OVER_NOISE = 4.0
"""A misfit above this multiple of the noise before the pulse is due to the model."""
LEAST_MISFIT = 0.005
"""A misfit below this part of the level is not worth a note."""
PULSE_BEGINS = 0.01
"""Part of the largest predicted value at which the pulse begins."""
FEWEST_NOISE_SAMPLES = 8
"""Smallest number of samples before the pulse from which noise is estimated."""


def notes_on_numbers(
    fitted: Sequence[Fitted], relative: Floats, descents: Sequence[Descent]
) -> list[str]:
    """Notes on numbers that are not determined, at a bound, or depend on the start.

    Pairs of numbers whose errors are highly correlated are noted too, if both numbers
    are determined.

    Parameters
    ----------
    fitted : sequence of Fitted
    relative : [number, number] array
        Covariance of the numbers, each over its range.
    descents : sequence of Descent
        Ends of the searches, the best first.
    """
    is_undetermined = np.sqrt(np.diag(relative)) > UNDETERMINED_ERROR
    notes = []
    for number, number_is_undetermined in zip(fitted, is_undetermined, strict=True):
        if number_is_undetermined:
            notes.append(
                f"{number.name} is not determined: its standard error is as large as "
                "its range. Fix this parameter, or add a record that depends on it."
            )
        notes += _notes_on_bounds(number)
    correlation = correlation_of(relative)
    # Above the diagonal, k=1, each pair of numbers comes once.
    high = np.triu(np.abs(correlation) > HIGH_CORRELATION, k=1)
    for i, j in np.argwhere(high):
        if not (is_undetermined[i] or is_undetermined[j]):
            notes.append(
                f"{fitted[i].name} and {fitted[j].name} are hardly distinguishable: "
                f"the correlation of their errors is {correlation[i, j]:.3f}. "
                "Fix one of them."
            )
    return [*notes, *_notes_on_searches(fitted, descents)]


def _notes_on_bounds(number: Fitted) -> Iterator[str]:
    """Notes on a number that lies at one of its bounds, if it has both.

    A number lies at a bound if it is nearer to it than the share `AT_BOUND` of its
    range, see `share_of_range`.
    """
    if np.isinf(number.high - number.low):
        return
    share = share_of_range(number.value, number.low, number.high)
    if share <= AT_BOUND:
        yield _bound_sentence(number, number.low, remedy="lower")
    if 1.0 - share <= AT_BOUND:
        yield _bound_sentence(number, number.high, remedy="raise")


def _bound_sentence(number: Fitted, bound: float, remedy: str) -> str:
    """Note on a number at a bound; the remedy, "lower" or "raise", moves the bound."""
    return (
        f"{number.name} is at its bound, {format_si(bound, number.unit)}, so its "
        f"standard error is not reliable: {remedy} the bound, or fix the parameter."
    )


def _notes_on_searches(
    fitted: Sequence[Fitted], descents: Sequence[Descent]
) -> Iterator[str]:
    """Notes on the searches, of which `descents` has the ends, the best first.

    They say whether the best was stopped, how many ended at larger misfits, and which
    numbers differ between searches with the same misfit as the best.
    """
    best = descents[0]
    if not best.complete:
        yield "The best search was stopped before it reached a minimum."
    same_misfit = (1 + SAME_MISFIT_RTOL) * best.misfit
    worse = []
    for descent in descents[1:]:
        if descent.misfit > same_misfit + SAME_MISFIT_ATOL:
            worse.append(descent.misfit)
    if worse:
        yield (
            f"{len(worse)} of {len(descents)} searches ended at larger misfits, "
            f"{100 * min(worse):.3g} % and more: there are several minima. "
            "Use more starts or narrower bounds to test whether this minimum is the "
            "best."
        )
    for number in fitted:
        values = []
        for descent in descents:
            if descent.misfit <= same_misfit:
                values.append(descent.values[number.name])
        if np.ptp(values) > SAME_VALUE_ERRORS * number.standard_error:
            low = format_si(min(values), number.unit)
            high = format_si(max(values), number.unit)
            yield (
                "Searches with the same misfit ended at different values of "
                f"{number.name}: {low} to {high}."
            )


def notes_on_records(
    measured: Sequence[Measured],
    predicted: Sequence[Signal],
    misfits: Sequence[float],
) -> Iterator[str]:
    """Notes on records that the model does not describe to within their noise.

    There is one for a misfit that is both above `MISFIT_OVER_NOISE` times the noise
    before the pulse and above `LEAST_MISFIT`. Without a measured noise there is none.
    """
    for record, prediction, misfit in zip(measured, predicted, misfits, strict=True):
        noise = noise_before_pulse(record, prediction)
        # An unknown noise makes the limit nan, which no misfit exceeds.
        limit = max(MISFIT_OVER_NOISE * noise, LEAST_MISFIT)
        if misfit > limit:
            yield (
                f"{record.title}: the misfit, {100 * misfit:.2g} %, is far above the "
                f"noise before the pulse, {100 * noise:.2g} %. The model does not "
                "describe this record: try another contact law or theory, vary more "
                "numbers, or free the blur."
            )


def noise_before_pulse(record: Measured, prediction: Signal) -> float:
    """Standard deviation of a record before its pulse, over its level.

    The prediction says where the pulse begins. The second half of the samples before it
    is left out, since the measured pulse may begin a little earlier. The result is nan
    if fewer than `FEWEST_NOISE_SAMPLES` remain.
    """
    values = np.abs(prediction.values)
    begin = int(np.argmax(values > PULSE_BEGINS * values.max()))
    before = record.signal.values[: begin // 2]
    if len(before) < FEWEST_NOISE_SAMPLES:
        return math.nan
    return float(np.std(before)) / record.size
