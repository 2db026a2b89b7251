"""A bar hits an identical bar whose far end is fixed: test SDNL111 of code_aster.

The bars are 1 m long, with E = 200 GPa and rho = 7800 kg/m^3. The wave runs through the
second bar to the fixed end, and back through both bars. The contact lasts 4 L/c. Then
the striker leaves with its reversed initial velocity, and the second bar is at rest.

Source: code_aster, validation manual, test SDNL111.
"""

import rodimpact as ri

from .table import Case, Rows

STEEL = ri.Material("steel", youngs_modulus=2e11, density=7800.0)
LENGTH = 1.0  # m
AREA = 1e-4  # m^2
SPEED = 1.0  # m/s


def run() -> Rows:
    """Contact time, velocity and energies after, of a striker and a bonded target.

    The target is bonded to a wall. The striker must leave as fast as it came.
    """
    striker = ri.Rod(LENGTH, area=AREA, material=STEEL, velocity=SPEED)
    target = ri.Rod(LENGTH, area=AREA, material=STEEL)
    contacts = [ri.Rigid(), ri.Bonded()]
    bodies = [striker, target, ri.Wall()]
    system = ri.System(bodies, contacts=contacts)
    outcome = ri.solve(system).outcome
    duration = 1e6 * outcome.contacts[0].duration  # us
    striker_velocity = outcome.velocities_after[0]
    striker_vibration = outcome.vibration_after[0]
    target_vibration = outcome.vibration_after[1]
    case = Case("code_aster, bar on fixed bar", "code_aster SDNL111")
    yield case.row("contact time, us", 789.9, duration, 0.05)
    yield case.row(
        "velocity of the striker after, m/s", -SPEED, striker_velocity, 1e-13
    )
    yield case.row(
        "vibration energy of the striker after, J", 0.0, striker_vibration, 1e-14
    )
    yield case.row("energy in the target after, J", 0.0, target_vibration, 1e-14)
