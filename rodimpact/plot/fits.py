"""A fit: the record over what is predicted with the best numbers."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes

from ..fitting.result import Fit
from ..model.arguments import of_kind
from ..model.frozen import refusal
from ..units import shown
from .residuals import Comparison, comparison


def fit(found: Fit, ax: Sequence[Axes] | None = None, record: int = 0) -> Comparison:
    """Draw a record over its prediction with a band of two standard errors, the residual below.

    The band tells how well the numbers that were fitted are known; model error is not in it.

    Parameters
    ----------
    found : Fit
    ax : two Axes, optional
        For signals and residual; by default those of a new figure, one above the other.
    record : int
        Which of the records.

    Returns
    -------
    Comparison

    Raises
    ------
    ValueError
        If there is no such record, or the `ax` is no pair.
    """
    of_kind("found", found, Fit, "fit(system, measured, vary, until)")
    if type(record) is not int or not 0 <= record < len(found.measured):
        have = len(found.measured) - 1
        raise refusal("record", f"must be a whole number from 0 to {have}, got {shown(record)}")
    predicted = found.predicted[record]
    return comparison(
        found.measured[record].signal, predicted, ax, shift=0.0, scale=1.0,
        band=predicted.replace(values=2 * found.bands[record]),
    )
