"""How a step is divided from level to level, and how wrong the last level may be."""

from __future__ import annotations

import math
from typing import Any

LOOK_BACK = 3  # coarser levels with which the finest is compared
FEWEST = 4  # levels
SURE = 1.5  # by what powers of the step between 3/2 and 2 differ; margin of an estimate


def factor_of(level: int) -> int:
    """By how much the step is divided on level 0, 1, ...: 1, 2, 3, 4, 6, 8, 12, 16, 24, ...

    Not by powers of two only: an error that depends on where in a step something happens may be the
    same on all of those.
    """
    if level == 0:
        return 1
    return 2 << level // 2 if level % 2 == 1 else 3 << (level // 2 - 1)


def error_of(
    values: Any, width: int, steps: Any, count: int, low: int, high: int, smooth: bool,
    scale: float,
) -> float:
    """Estimated error of a measure on the last level, relative to a scale.

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
    scale : float
        0 for the largest value of the measure.

    Returns
    -------
    float
        Infinite where there are too few levels.
    """
    if count < FEWEST:
        return math.inf
    h, error, least, most = steps[count - 1], 0.0, math.inf, 0.0
    for back in range(1, LOOK_BACK + 1):
        g = steps[count - 1 - back]
        change = largest_change(values, width, count, back, low, high, scale)
        error = max(error, change * h / (g - h))
        square = change * h * h / (g * g - h * h)
        least, most = min(least, square), max(most, square)
    return most if smooth and most <= SURE * least else error


def largest_change(
    values: Any, width: int, count: int, back: int, low: int, high: int, scale: float
) -> float:
    """Largest change of a measure since some levels before, relative to a scale.

    That is its largest value where it is given as 0.
    """
    last, largest, change = (count - 1) * width, scale, 0.0
    for i in range(low, high):
        if scale == 0:
            largest = max(largest, abs(values[last + i]))
        off = abs(values[last - back * width + i] - values[last + i])
        if off != off:
            return math.inf
        change = max(change, off)
    return change / largest if largest > 0 else change


def carried_on(values: Any, width: int, steps: Any, count: int, back: int, i: int) -> float:
    """What a number comes to at step 0, of two values whose errors fall with its square."""
    last, h, g = (count - 1) * width + i, steps[count - 1], steps[count - 1 - back]
    value: float = values[last] + (values[last] - values[last - back * width]) * (
        h * h / (g * g - h * h))
    return value


def carried_error(values: Any, width: int, steps: Any, count: int, low: int, high: int) -> float:
    """Estimated error of a measure that is carried on, relative to its largest value.

    By how much it differs if it is carried on from another level before, and twice that: for an
    error of order 3/2 the error would be 1.35 times as much. At least 2/3 of what carrying on
    changes: between the last level and step 0 the square may count less, as where a largest value
    lies beside a kink. Infinite where errors do not fall with the square of the step.
    """
    if count < FEWEST:
        return math.inf
    h, least, most = steps[count - 1], math.inf, 0.0
    for back in range(1, LOOK_BACK + 1):
        g = steps[count - 1 - back]
        square = largest_change(values, width, count, back, low, high, 0.0) / (g * g - h * h)
        least, most = min(least, square), max(most, square)
    if not most <= SURE * least:
        return math.inf
    last, scale, error = (count - 1) * width, 0.0, 0.0
    for i in range(low, high):
        nearest = carried_on(values, width, steps, count, 1, i)
        scale = max(scale, abs(nearest))
        error = max(error, abs(nearest - values[last + i]) / SURE)
        for back in range(2, LOOK_BACK + 1):
            error = max(error, 2 * abs(carried_on(values, width, steps, count, back, i) - nearest))
    return error / scale if scale > 0 else error
