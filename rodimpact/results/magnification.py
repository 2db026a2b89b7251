"""How much displacements are magnified, in figures and on the page alike.

Plain Python, which the page has as JavaScript.
"""

import math

PICTURED_MOVEMENT = 0.35  # in the picture, in lengths of the row
MAX_PICTURED_STRAIN = 0.3
MAX_DRIFT_RATIO = 3.0  # of a drift that is drawn, over the movement within the row
INNER_MOVEMENT_RTOL = 1e-9  # less movement within the row, over its drift, is round-off
LEADING_DIGIT_RTOL = (
    1e-9  # by which a number may lie below 1, 2, 5 times a power of ten
)
BLOCK = 0.05  # largest width of a mass in the picture, in lengths of all rods


def drifts(reach: float, relative: float) -> bool:
    """Whether a row drifts much farther, `reach`, than its bodies move against each other."""
    return INNER_MOVEMENT_RTOL * reach < relative < reach / MAX_DRIFT_RATIO


def magnified(length: float, reach: float, relative: float, strain: float) -> float:
    """Magnification for rods of that length that move so far, m, and with that largest strain."""
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
    """Largest of 1, 2, 5 times a power of ten that is no larger."""
    base = 10.0 ** math.floor(math.log10(number) + LEADING_DIGIT_RTOL)
    for digit in (5, 2):
        if digit * base <= number * (1 + LEADING_DIGIT_RTOL):
            return digit * base
    return base
