"""Jumps of a family's results, at which curves and contour lines are interrupted."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from ..methods.signals import Floats
from .scales import NEGLIGIBLE_RTOL

JUMP_NEIGHBOURS = 7  # differences about one, whose median is the usual difference there
JUMP_FACTOR = 8.0  # usual differences that a jump surpasses
MIN_JUMP = 0.02  # part of a quantity's range: a smaller jump is not seen


class Curve(NamedTuple):
    """Points of a curve."""

    x: Floats
    y: Floats


def broken_at_jumps(x: Floats, y: Floats) -> Curve:
    """A curve with NaN inserted where it jumps."""
    after = np.flatnonzero(jumps(y)) + 1
    between = (x[after - 1] + x[after]) / 2
    return Curve(np.insert(x, after, between), np.insert(y, after, np.nan))


def jumps(values: Floats) -> NDArray[np.bool_]:
    """Whether each difference along the first axis is a jump, far larger than its like.

    It is more than `JUMP_FACTOR` times their median, `MIN_JUMP` of the range, and more
    than round-off.
    """
    steps = np.abs(np.diff(values, axis=0))
    # The second axis of a map is not mixed.
    neighbours = (JUMP_NEIGHBOURS, 1)[: values.ndim]
    usual = median_filter(np.nan_to_num(steps), neighbours)
    least = MIN_JUMP * (np.nanmax(values) - np.nanmin(values))
    least = max(least, NEGLIGIBLE_RTOL * np.nanmax(np.abs(values)))
    return np.asarray(steps > np.maximum(JUMP_FACTOR * usual, least))


def away_from_jumps(values: Floats) -> NDArray[np.bool_]:
    """Whether each value of a map is finite and not beside a jump along either axis."""
    is_smooth = np.isfinite(values)
    # A jump i lies between the values i and i + 1.
    i, j = np.nonzero(jumps(values))
    is_smooth[i, j] = False
    is_smooth[i + 1, j] = False
    j, i = np.nonzero(jumps(values.T))
    is_smooth[i, j] = False
    is_smooth[i, j + 1] = False
    return is_smooth
