"""How a step is divided from level to level, and how wrong the last level may be."""

from __future__ import annotations

import math
from typing import Any

LOOK_BACK = 3  # coarser levels with which the finest is compared
FEWEST = 4  # levels
SURE = 1.5  # by what powers of the step between 3/2 and 2 differ


def factor_of(level: int) -> int:
    """By how much the step is divided on level 0, 1, ...: 1, 2, 3, 4, 6, 8, 12, 16, 24, ...

    Not by powers of two only: an error that depends on where in a step something happens may be the
    same on all of those.
    """
    if level == 0:
        return 1
    return 2 << level // 2 if level % 2 == 1 else 3 << (level // 2 - 1)


def error_of(
    values: Any, width: int, steps: Any, count: int, low: int, high: int, smooth: bool
) -> float:
    """Estimated error of a measure on the last level, relative to its largest value.

    An error that falls in proportion to the step h is |q(g) - q(h)| h/(g - h), q(g) the result of a
    coarser step g; one of higher order is less. The largest over the last coarser levels is the
    estimate: errors that differ from level to level are not all equal by accident.

    Where nothing depends on places inside steps, errors are a series in h. If it has begun to fall
    with its square, |q(g) - q(h)| h^2/(g^2 - h^2) is nearly the same for all coarser levels, and
    the error; were the power 3/2 only, it would be 1.44 times that, and differ 1.49-fold.

    Parameters
    ----------
    values : [count * width]
        What was measured, level after level.
    steps : [count]
    low, high : int
        Places of the measure on a level.
    smooth : bool
        Whether nothing depends on places inside steps.

    Returns
    -------
    float
        Infinite where there are too few levels.
    """
    if count < FEWEST:
        return math.inf
    last, h, scale = (count - 1) * width, steps[count - 1], 0.0
    for i in range(low, high):
        scale = max(scale, abs(values[last + i]))
    if scale == 0:
        scale = 1.0
    error, least, most = 0.0, math.inf, 0.0
    for back in range(1, LOOK_BACK + 1):
        g, row, change = steps[count - 1 - back], last - back * width, 0.0
        for i in range(low, high):
            off = abs(values[row + i] - values[last + i])
            if off != off:
                return math.inf
            change = max(change, off / scale)
        error = max(error, change * h / (g - h))
        square = change * h * h / (g * g - h * h)
        least, most = min(least, square), max(most, square)
    return SURE * most if smooth and most <= SURE * least else error
