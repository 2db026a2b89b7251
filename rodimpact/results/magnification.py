"""Magnification of displacements, the same in figures and on the page.

The page has these functions as JavaScript.
"""

import math

PICTURED_MOVEMENT = 0.35  # largest movement in the picture, in lengths of the row
MAX_PICTURED_STRAIN = 0.3
MAX_DRIFT_RATIO = (
    3.0  # a drift that is drawn, over the movement within the row, at most
)
INNER_MOVEMENT_RTOL = 1e-9  # less movement within the row, over its drift, is round-off
LEADING_DIGIT_RTOL = 1e-9  # a number this close below 1, 2, 5 times 10^n counts as it
BLOCK = 0.05  # largest width of a mass in the picture, in lengths of all rods


def drifts(reach: float, relative: float) -> bool:
    """Whether a row moves much farther than its bodies do against each other.

    False if the bodies do not move against each other. `reach` is the farthest movement
    of all, and `relative` that within the row, m.
    """
    return INNER_MOVEMENT_RTOL * reach < relative < reach / MAX_DRIFT_RATIO


def magnified(length: float, reach: float, relative: float, strain: float) -> float:
    """Magnification of displacements in a picture: 1, 2, 5, 10, 20 ..., 1 at least.

    With the exact factor the movement becomes `PICTURED_MOVEMENT` times the `length` of
    the row, m, or less, if the largest `strain` would exceed `MAX_PICTURED_STRAIN`. The
    factor is rounded down. The movement is `reach`, m, the farthest one; in a row that
    drifts (`drifts`) it is `relative`, m, the movement within the row, which the drift
    would hide. Without movement the magnification is 1.
    """
    movement = reach
    if drifts(reach, relative):
        movement = relative
    factor = 1.0
    if movement > 0:
        factor = PICTURED_MOVEMENT * length / movement
    if strain > 0:
        factor = min(factor, MAX_PICTURED_STRAIN / strain)
    return max(1.0, round_down(factor))


def round_down(number: float) -> float:
    """Largest of 1, 2, 5 times a power of ten that is no larger than a positive number.

    It may exceed the number by the fraction `LEADING_DIGIT_RTOL`, for round-off.
    """
    # The power of ten of the leading digit
    base = 10.0 ** math.floor(math.log10(number) + LEADING_DIGIT_RTOL)
    for digit in (5, 2):
        if digit * base <= number * (1 + LEADING_DIGIT_RTOL):
            return digit * base
    return base
