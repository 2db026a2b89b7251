"""The numbers of which an outcome is made.

They are motion before and after, works, and what is missing.

Each method hands over these records, or they are read off its fields; `results.outcome`
makes the `Outcome` of them. The page uses `Motion` in JavaScript.
"""

from collections.abc import Sequence
from typing import NamedTuple


class Motion(NamedTuple):
    """Motion of all bodies at one time.

    Attributes
    ----------
    velocities : [body] sequence of float
        Velocities of the centres of mass, m/s; that of its group for a body bonded to
        others.
    vibration : [body] sequence of float
        Energy of the motion relative to these velocities, and of strain, J.
    kinetic : float
        Energy of the motion of the centres of mass, J; walls not counted.
    """

    velocities: Sequence[float]
    vibration: Sequence[float]
    kinetic: float


class Works(NamedTuple):
    """Works and losses over a run, and what contacts store, J.

    `Outcome` has the same names.
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
    """All that an outcome is made of.

    Attributes
    ----------
    masses : [body] sequence of float
        kg; infinite for a wall.
    before, after : Motion
    works : Works
    momentum_residual, energy_residual : float
        What is missing in the balances at the end, relative to what took part in them.
    """

    masses: Sequence[float]
    before: Motion
    after: Motion
    works: Works
    momentum_residual: float
    energy_residual: float


def relative_residual(missing: float, scale: float) -> float:
    """What is missing in a balance over what took part in it, `scale`.

    It is 0 where nothing did.
    """
    if scale > 0:
        return missing / scale
    return 0.0
