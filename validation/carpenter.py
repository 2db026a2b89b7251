"""Two identical bars meet head on, in inches and pounds.

With E = 30e6 psi, rho = 0.73e-3 lb s^2/in^4, L = 10 in, A = 1 in^2 and a closing speed
of 202.2 in/s, the force is 14,961 lb for 98.66 us.

Source: N. J. Carpenter, R. L. Taylor, M. G. Katona, Lagrange constraints for transient
finite element surface contact, International Journal for Numerical Methods in
Engineering 32 (1991).
"""

import rodimpact as ri

from .table import Case, Rows

STEEL = ri.Material("steel in inches", youngs_modulus=30e6, density=0.73e-3)
LENGTH = 10.0  # in
AREA = 1.0  # in^2
SPEED = 101.1  # in/s, half the closing speed


def run() -> Rows:
    """Force, contact time and e of two bars, each at half the closing speed.

    They are compared with published values, in lb and us.
    """
    left = ri.Rod(LENGTH, area=AREA, material=STEEL, velocity=SPEED)
    right = ri.Rod(LENGTH, area=AREA, material=STEEL, velocity=-SPEED)
    outcome = ri.collide(left, right)
    duration = 1e6 * outcome.duration  # us
    peak_force = outcome.peak_force
    e = outcome.restitution
    case = Case("Carpenter et al., two bars", "Carpenter, Taylor and Katona 1991")
    yield case.row("force, lb", 14961.0, peak_force, 0.5)
    yield case.row("contact time, us", 98.66, duration, 0.005)
    yield case.row("e", 1.0, e, 1e-13)
