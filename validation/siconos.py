"""A bar falls on a rigid floor: the ImpactingBar example of Siconos.

The bar has E = 210 GPa, rho = 7800 kg/m^3, A = 3.14e-4 m^2 and L = 1 m. It moves at 0.1
m/s towards the floor, 50 um away, without gravity. The impact begins after gap/speed.
The contact lasts 2 L/c with the force Z v, and the bar rebounds with e = 1.

Source: Siconos tutorials, mechanics, ImpactingBar
(https://github.com/siconos/siconos-tutorials).
"""

import rodimpact as ri

from .table import Case, Rows

MATERIAL = ri.Material("bar", youngs_modulus=210e9, density=7800.0)
LENGTH = 1.0  # m
AREA = 3.14e-4  # m^2
SPEED = 0.1  # m/s
GAP = 5e-5  # m


def run() -> Rows:
    """Impact, contact time, force and e of a bar that strikes a floor on its right.

    There is a gap between them at first.
    """
    bar = ri.Rod(LENGTH, area=AREA, material=MATERIAL, velocity=SPEED)
    outcome = ri.collide(bar, ri.Wall(), gap=GAP)
    impact = outcome.contacts[0].first
    duration = 1e3 * outcome.duration  # ms
    peak_force = outcome.peak_force
    e = outcome.restitution
    case = Case("Siconos, bar on floor", "Siconos ImpactingBar, by hand")
    yield case.row("impact at, s", 0.5e-3, impact, 1e-17)
    yield case.row("contact time, ms", 0.38545, duration, 5e-6)
    yield case.row("force, N", 1270.8, peak_force, 0.05)
    yield case.row("e", 1.0, e, 1e-13)
