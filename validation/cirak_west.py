"""Two identical bars meet head on.

E = rho = 1, L = 10, area 4, velocities 0.1 and -0.1: the contact lasts 2 L/c = 20 with the force
0.1 Z = 0.4, and the bars exchange velocities.

Source: F. Cirak, M. West, Decomposition contact response (DCR) for explicit finite element
dynamics, International Journal for Numerical Methods in Engineering 64 (2005).
"""

from __future__ import annotations

import rodimpact as ri

from .table import Row


def run() -> list[Row]:
    """The two bars, touching at t = 0."""
    unit = ri.Material("unit", youngs_modulus=1.0, density=1.0)
    left, right = (ri.Rod(10.0, area=4.0, material=unit, velocity=v) for v in (0.1, -0.1))
    o = ri.collide(left, right)
    case, source = "Cirak and West, two bars", "Cirak and West 2005, by hand"
    return [
        Row(case, "contact time", source, 20.0, o.duration, 1e-12),
        Row(case, "force", source, 0.4, o.peak_force, 1e-14),
        Row(case, "e", source, 1.0, o.restitution, 1e-13),
        Row(case, "velocity left after", source, -0.1, o.velocities_after[0], 1e-14),
        Row(case, "velocity right after", source, 0.1, o.velocities_after[1], 1e-14),
    ]
