"""From the ends of the searches to the result of a fit."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..model.quantities import Floats
from ..records.signal import Signal
from .measured import Measured
from .notes import notes_on_numbers, notes_on_records
from .objective import Objective
from .parameters import Parameter
from .result import Descent, Fit, Fitted
from .uncertainty import covariance


def summarise(objective: Objective, ends: Sequence[Any], sizes: Floats) -> Fit:
    """Fit at the best end: numbers with errors, predictions with bands, and notes.

    Parameters
    ----------
    objective : Objective
    ends : sequence of scipy.optimize.OptimizeResult
        Ends of the searches, the best first.
    sizes : [number] array
        Size of each number, by which the variables of a search are divided.
    """
    best = ends[0]
    records = objective.measured
    is_free = objective.is_free
    # Range of each number: between its bounds, or its size if that is less.
    ranges = np.minimum(objective.high - objective.low, sizes)[is_free]
    # The variables of a search are numbers over their sizes; from here on derivatives
    # and covariance are those of the numbers over their ranges.
    jacobian = best.jac * (ranges / sizes[is_free])
    relative = covariance(jacobian, best.fun, objective.sample_counts)
    relative_errors = np.sqrt(np.diag(relative))

    varied = [objective.numbers[i] for i in np.flatnonzero(is_free)]
    scaled_values = best.x[is_free].tolist()
    descents = []
    for end in ends:
        descents.append(_descent(end, varied, is_free))
    slopes = []
    for number, scaled_value in zip(varied, scaled_values, strict=True):
        slopes.append(number.slope(scaled_value))
    own_ranges = ranges * slopes  # ranges in the unit of each number
    fitted = _fitted(varied, descents[0], relative_errors * own_ranges)

    # Records are separated at the ends of all but the last one.
    ends_of_records = np.cumsum(objective.sample_counts)[:-1]
    residuals = np.split(best.fun, ends_of_records)
    # Standard error of each prediction over its level: the diagonal of J C J'
    spread = np.sqrt(np.einsum("ij,jk,ik->i", jacobian, relative, jacobian))
    spreads = np.split(spread, ends_of_records)
    predicted = []
    bands = []
    misfits = []
    for record, residual, record_spread in zip(
        records, residuals, spreads, strict=True
    ):
        predicted.append(_prediction(record, residual))
        bands.append(record.size * record_spread)
        misfits.append(math.sqrt(float(np.mean(residual**2))))
    notes = [
        *notes_on_records(records, predicted, misfits),
        *notes_on_numbers(fitted, relative, descents),
    ]
    return Fit(
        system=objective.system_at(best.x),
        measured=tuple(records),
        fitted=fitted,
        covariance=relative * np.outer(own_ranges, own_ranges),
        predicted=tuple(predicted),
        bands=tuple(bands),
        misfits=tuple(misfits),
        descents=tuple(descents),
        notes=tuple(notes),
    )


def _descent(end: Any, varied: Sequence[Parameter], is_free: Any) -> Descent:
    """End of a search: misfit, values of the numbers that varied, and whether complete.

    `end` is SciPy's result; a positive status means that the search was complete.
    """
    values = {}
    for number, scaled_value in zip(varied, end.x[is_free].tolist(), strict=True):
        values[number.path] = number.value(scaled_value)
    misfit = math.sqrt(2 * end.cost / len(end.fun))  # cost: half the sum of squares
    return Descent(misfit, values, complete=end.status > 0)


def _fitted(
    varied: Sequence[Parameter], best: Descent, errors: Floats
) -> tuple[Fitted, ...]:
    """The numbers that varied, with their standard errors and bounds.

    Values are those of `best`; `errors` are in the units of the numbers.
    """
    fitted = []
    for number, error in zip(varied, errors.tolist(), strict=True):
        low, high = number.scaled_bounds
        fitted.append(
            Fitted(
                name=number.path,
                unit=number.unit,
                value=best.values[number.path],
                standard_error=error,
                low=number.value(low),
                high=number.value(high),
            )
        )
    return tuple(fitted)


def _prediction(record: Measured, residual: Floats) -> Signal:
    """Prediction of a record from its residual, which is relative to the level."""
    values = record.signal.values + record.size * residual
    return record.signal.replace(values=values)
