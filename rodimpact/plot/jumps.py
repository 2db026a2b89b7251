"""Jumps of a family's results, at which curves and contour lines are interrupted."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from ..methods.signals import Floats
from .scales import NEGLIGIBLE_RTOL

JUMP_NEIGHBOURS = 7  # neighbouring differences whose median is the usual difference
JUMP_FACTOR = 8.0  # least size of a jump, in usual differences
MIN_JUMP = 0.02  # part of a quantity's range: a smaller jump is not seen


class Curve(NamedTuple):
    """Points of a curve."""

    x: Floats
    y: Floats


def broken_at_jumps(x: Floats, y: Floats) -> Curve:
    """A curve with a point inserted in each jump, which interrupts the line there.

    Its x is half-way between the neighbours, its y is NaN.
    """
    after = np.flatnonzero(jumps(y)) + 1  # index of the first point after each jump
    between = (x[after - 1] + x[after]) / 2
    return Curve(np.insert(x, after, between), np.insert(y, after, np.nan))


def jumps(values: Floats) -> NDArray[np.bool_]:
    """Whether each difference of neighbours along the first axis is a jump.

    A jump is larger than `JUMP_FACTOR` times the median of `JUMP_NEIGHBOURS`
    differences around it, than `MIN_JUMP` of the range of all values, and than
    round-off. The result is one shorter than `values`, of one or two axes. A difference
    from NaN is no jump.
    """
    steps = np.abs(np.diff(values, axis=0))
    # Medians along the first axis only: each column of a map has its own. A curve has
    # one axis, and takes the first number alone.
    window = (JUMP_NEIGHBOURS, 1)[: values.ndim]
    usual = median_filter(np.nan_to_num(steps), window)
    least = MIN_JUMP * (np.nanmax(values) - np.nanmin(values))
    round_off = NEGLIGIBLE_RTOL * np.nanmax(np.abs(values))
    least = max(least, round_off)
    return np.asarray(steps > np.maximum(JUMP_FACTOR * usual, least))


def away_from_jumps(values: Floats) -> NDArray[np.bool_]:
    """Whether each value [i, j] of a map is finite and not beside a jump.

    Jumps along both axes count.
    """
    is_smooth = np.isfinite(values)
    # A jump i lies between the values i and i + 1: neither is smooth.
    i, j = np.nonzero(jumps(values))
    is_smooth[i, j] = False
    is_smooth[i + 1, j] = False
    j, i = np.nonzero(jumps(values.T))
    is_smooth[i, j] = False
    is_smooth[i, j + 1] = False
    return is_smooth
