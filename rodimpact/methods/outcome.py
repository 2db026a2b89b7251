"""The totals from which an outcome is made: motions, works and residuals.

A method returns these records, or they are computed from its fields;
`results.outcome` makes the `Outcome` from them. The web page uses `Motion` in
JavaScript.
"""

from collections.abc import Sequence
from typing import NamedTuple


class Motion(NamedTuple):
    """Motion of all bodies at one time.

    Attributes
    ----------
    velocities : [body] sequence of float
        Velocities of the centres of mass, m/s; a body that is bonded to others has the
        velocity of its group.
    vibration : [body] sequence of float
        Kinetic energy relative to these velocities, plus strain energy, J.
    kinetic : float
        Kinetic energy of all bodies at these velocities, J, without walls.
    """

    velocities: Sequence[float]
    vibration: Sequence[float]
    kinetic: float


class Works(NamedTuple):
    """Works and losses over a run, and energies stored in contacts, J.

    `Outcome` has the same names, and explains them.
    """

    wall_work: float = 0.0
    drive_work: float = 0.0
    gravity_work: float = 0.0
    radiated: float = 0.0
    soil_work: float = 0.0
    drag_work: float = 0.0
    dissipated: float = 0.0
    damped: float = 0.0
    numerical: float = 0.0
    contact_energy: float = 0.0
    contact_energy_before: float = 0.0


class Totals(NamedTuple):
    """All numbers from which an outcome is made.

    Attributes
    ----------
    masses : [body] sequence of float
        kg; infinite for a wall.
    before, after : Motion
    works : Works
    momentum_residual, energy_residual : float
        Errors of the balances of momentum and energy over the run, relative to the
        amounts in them.
    """

    masses: Sequence[float]
    before: Motion
    after: Motion
    works: Works
    momentum_residual: float
    energy_residual: float


def relative_residual(missing: float, scale: float) -> float:
    """Error of a balance, `missing`, divided by its scale; 0 if the scale is 0."""
    if scale > 0:
        return missing / scale
    return 0.0
