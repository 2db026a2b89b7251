"""Which additions to a fit earn their place: cross-validation by alternating blocks.

The records are divided into blocks that last a little longer than their pulses rise. A
fit of every other block predicts the blocks that it has left out. Each sample is left
out once in each of four divisions, whose blocks begin at different times. No collision
is solved for that: near the fit of all blocks, predictions are linear in the numbers,
and the derivatives are known. An addition earns its place if the squares of the
residuals in the blocks left out fall by more than the standard error of their fall.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ..model.quantities import Floats
from .measured import Measured
from .objective import Objective
from .result import Addition, Fit

BLOCK_OVER_RISE = 1.2
"""Duration of a block over the rise time of the pulse."""
MIN_BLOCKS = 8
"""Smallest number of blocks of a record."""
DIVISIONS = 4
"""Divisions into blocks; each begins a half block later than the one before."""
MIN_INFORMATION = 1e-6
"""Relative derivative below which linear fits change nothing in a direction."""


class Trial(NamedTuple):
    """A fit with or without an addition."""

    name: str  # "" without one
    fit: Fit
    objective: Objective
    end: Any  # end of the best search, a scipy.optimize.OptimizeResult


def with_additions(base: Trial, trials: Sequence[Trial]) -> Fit:
    """Copy of the fit of `base`, with the fits of the trials as its `additions`.

    The field `misfit_left_out` of all fits is set, and `earns_its_place` of each
    addition: whether the squares left out fall by more than the standard error of this
    fall, which follows from the falls of the blocks.
    """
    blocks = _blocks(base.objective.measured, division=0)
    base_squares = _squares_left_out(base)
    additions = []
    for trial in trials:
        squares = _squares_left_out(trial)
        fall = base_squares - squares
        fall_of_block = np.bincount(blocks, weights=fall)
        # The variance of a sum of independent terms is the sum of their squares.
        standard_error = math.sqrt(float(fall_of_block @ fall_of_block))
        fit = replace(trial.fit, misfit_left_out=_root_of_mean(squares))
        earns_its_place = bool(fall_of_block.sum() > standard_error)
        additions.append(Addition(trial.name, fit, earns_its_place))
    return replace(
        base.fit,
        misfit_left_out=_root_of_mean(base_squares),
        additions=tuple(additions),
    )


def _root_of_mean(squares: Floats) -> float:
    """Square root of the mean of squares."""
    return math.sqrt(float(squares.mean()))


def _squares_left_out(trial: Trial) -> Floats:
    """Mean square of each residual when its block is left out, [sample].

    The mean is taken over the divisions. Each division leaves out every second block,
    then the other blocks instead. A linear fit of the remaining blocks predicts the
    residuals in the blocks left out. In this fit, numbers at their bounds stay there.
    """
    objective = trial.objective
    free = objective.is_free
    # Numbers at their bounds stay there; `jac` has columns of the free numbers only.
    is_inside = (trial.end.x > objective.low) & (trial.end.x < objective.high)
    jacobian = trial.end.jac[:, is_inside[free]]
    # Columns of length 1, so that `MIN_INFORMATION` does not depend on units.
    lengths = np.linalg.norm(jacobian, axis=0)
    jacobian = jacobian / np.where(lengths > 0, lengths, 1.0)
    squares = np.zeros(len(trial.end.fun))
    for division in range(DIVISIONS):
        is_odd = _blocks(objective.measured, division) % 2 == 1
        for is_left_out in (is_odd, ~is_odd):
            residuals = predicted_residuals(jacobian, trial.end.fun, is_left_out)
            squares[is_left_out] += residuals**2 / DIVISIONS
    return squares


def predicted_residuals(
    jacobian: Floats, residuals: Floats, is_left_out: Any
) -> Floats:
    """Residuals of the samples left out, after a linear fit of all other samples.

    Parameters
    ----------
    jacobian : [sample, number] array
        Derivatives of the residuals.
    residuals : [sample] array
        They are those of the fit of all samples.
    is_left_out : [sample] array of bool
    """
    is_fitted = ~is_left_out
    change = np.linalg.lstsq(
        jacobian[is_fitted], -residuals[is_fitted], rcond=MIN_INFORMATION
    )[0]
    predicted: Floats = residuals[is_left_out] + jacobian[is_left_out] @ change
    return predicted


def _blocks(records: Sequence[Measured], division: int) -> Any:
    """Number of the block of each sample of all records.

    All blocks of a record last equally long, see `_block_duration`. The numbers of the
    blocks of each record continue those of the record before it. `division`, from 0 to
    DIVISIONS - 1, makes all borders of blocks earlier by 2 division/DIVISIONS blocks.
    """
    blocks = []
    first = 0
    for record in records:
        times = record.signal.times
        from_start = (times - times[0]) / _block_duration(record)
        # A block of every second one repeats after 2 blocks: DIVISIONS shifts up to 2.
        shift = 2 * division / DIVISIONS
        of_record = first + (from_start + shift).astype(int)
        first = of_record[-1] + 1
        blocks.append(of_record)
    return np.concatenate(blocks)


def _block_duration(record: Measured) -> float:
    """Duration of the blocks of a record, s.

    It is `BLOCK_OVER_RISE` times the rise time of the pulse, but at most 1/MIN_BLOCKS
    of the record. It is this part of a record that cuts the pulse off.
    """
    longest = (record.signal.end - record.signal.start) / MIN_BLOCKS
    try:
        rise = record.signal.pulse().rise
    except ValueError:  # the record cuts the pulse off
        return longest
    return min(BLOCK_OVER_RISE * rise, longest)
