"""A bar hits an identical bar whose far end is fixed: test SDNL111 of code_aster.

Bars of 1 m, E = 200 GPa, rho = 7800 kg/m^3. The wave runs through the second bar to the fixed end
and back through both: contact for 4 L/c, then the striker leaves with the velocity it came with,
reversed, and the second bar is at rest.

Source: code_aster, validation manual, test SDNL111.
"""

import rodimpact as ri

from .table import Case, Rows

SPEED = 1.0


def run() -> Rows:
    """Striker, target, wall bonded to the target."""
    steel = ri.Material("steel", youngs_modulus=2e11, density=7800.0)
    striker = ri.Rod(1.0, area=1e-4, material=steel, velocity=SPEED)
    target = ri.Rod(1.0, area=1e-4, material=steel)
    solution = ri.solve(
        ri.System([striker, target, ri.Wall()], contacts=[ri.Rigid(), ri.Bonded()])
    )
    o = solution.outcome
    case = Case("code_aster, bar on fixed bar", "code_aster SDNL111")
    yield case.row("contact time, us", 789.9, o.contacts[0].duration * 1e6, 0.05)
    yield case.row(
        "velocity of the striker after, m/s", -SPEED, o.velocities_after[0], 1e-13
    )
    yield case.row(
        "vibration energy of the striker after, J", 0.0, o.vibration_after[0], 1e-14
    )
    yield case.row("energy in the target after, J", 0.0, o.vibration_after[1], 1e-14)
