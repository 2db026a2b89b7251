"""Two identical bars meet head on.

With E = rho = 1, L = 10, A = 4 and the velocities 0.1 and -0.1, the contact lasts 2 L/c
= 20 with the force 0.1 Z = 0.4, and the bars exchange their velocities.

Source: F. Cirak, M. West, Decomposition contact response (DCR) for explicit finite
element dynamics, International Journal for Numerical Methods in Engineering 64 (2005).
"""

import rodimpact as ri

from .table import Case, Rows
from .unit import rod

LENGTH = 10.0
AREA = 4.0
SPEED = 0.1


def run() -> Rows:
    """Contact time, force, e and velocities of two equal bars, which touch at t = 0.

    They run at each other at equal speeds. The values are compared with those by hand.
    """
    left = rod(LENGTH, AREA, velocity=SPEED)
    right = rod(LENGTH, AREA, velocity=-SPEED)
    outcome = ri.collide(left, right)
    left_after, right_after = outcome.velocities_after
    duration = outcome.duration
    peak_force = outcome.peak_force
    e = outcome.restitution
    case = Case("Cirak and West, two bars", "Cirak and West 2005, by hand")
    yield case.row("contact time", 20.0, duration, 1e-12)
    yield case.row("force", 0.4, peak_force, 1e-14)
    yield case.row("e", 1.0, e, 1e-13)
    yield case.row("velocity left after", -SPEED, left_after, 1e-14)
    yield case.row("velocity right after", SPEED, right_after, 1e-14)
