"""How much displacements are magnified, in figures and on the page alike.

Plain Python, which the page has as JavaScript.
"""

import math

REACH = 0.35  # movement in the picture, in lengths of the row
SQUEEZE = 0.3  # largest strain in the picture
DRIFT = 3.0  # how much farther than its inner movement a row may drift
ROUND_OFF = 1e-9  # of its drift: inner movement that is none
BLOCK = 0.05  # largest width of a mass in the picture, in lengths of all rods


def drifts(reach: float, relative: float) -> bool:
    """Whether a row drifts much farther, `reach`, than its bodies move against each other."""
    return ROUND_OFF * reach < relative < reach / DRIFT


def magnified(length: float, reach: float, relative: float, strain: float) -> float:
    """Magnification for rods of that length that move so far, m, and with that largest strain."""
    moved = relative if drifts(reach, relative) else reach
    wanted = REACH * length / moved if moved > 0 else 1.0
    if strain > 0:
        wanted = min(wanted, SQUEEZE / strain)
    return max(1.0, round_down(wanted))


def round_down(number: float) -> float:
    """Largest of 1, 2, 5 times a power of ten that is no larger."""
    base = 10.0 ** math.floor(math.log10(number) + 1e-9)
    for lead in (5, 2):
        if lead * base <= number * (1 + 1e-9):
            return lead * base
    return base
