"""Rows of more than two rods.

- Newton's cradle of five equal rods: if one rod arrives, one rod leaves, as in
  textbooks for balls. If two rods arrive, two rods leave. All other rods are at rest,
  without vibration.
- Three rods of one impedance, each longer than the rod before: the pulse of the first
  rod passes through the second into the third rod. The third rod takes all the
  momentum, so its velocity is l1/l3 times the initial velocity.
- Eight rods of different lengths and areas: momentum and energy balance. At every
  contact the left part of the row loses the momentum that the right part gains.

Source: balances of momentum and energy; waves of equal impedance pass through a closed
contact unchanged.
"""

import numpy as np
from numpy.random import default_rng

import rodimpact as ri

from .table import Case, Rows, largest_magnitude

STEEL = ri.materials.steel
AREA = 1e-4  # m^2
RODS = 5  # rods of a cradle


def run() -> Rows:
    """Compare cradles, a relay of three, a chain of eight."""
    yield from cradle(moving=1)
    yield from cradle(moving=2)
    yield from relay()
    yield from chain()


def rod(length: float, velocity: float) -> ri.Rod:
    """A steel rod of the common area."""
    return ri.Rod(length, area=AREA, material=STEEL, velocity=velocity)


def cradle(moving: int) -> Rows:
    """Velocities and vibration of five equal rods, the first `moving` at 1 m/s.

    As many rods must leave at 1 m/s on the other side, and nothing may vibrate.
    """
    resting = RODS - moving
    velocities = [1.0] * moving + [0.0] * resting
    expected = [0.0] * resting + [1.0] * moving
    rods = [rod(0.1, velocity) for velocity in velocities]
    outcome = ri.solve(ri.System(rods)).outcome
    vibration = sum(outcome.vibration_after)
    case = Case(f"Newton's cradle, {moving} of {RODS}", "as many go as came")
    for i, velocity in enumerate(outcome.velocities_after):
        quantity = f"velocity of rod {i + 1} after, m/s"
        yield case.row(quantity, expected[i], velocity, 1e-13)
    yield case.row("vibration energy after, J", 0.0, vibration, 1e-14, source="none")


def relay() -> Rows:
    """Velocities after of rods of 0.2 m, 0.3 m and 1 m, the first at 1 m/s.

    The pulse passes through: only the third rod moves, at 0.2 m/s.
    """
    first = rod(0.2, 1.0)
    second = rod(0.3, 0.0)
    third = rod(1.0, 0.0)
    system = ri.System([first, second, third])
    expected = (0.0, 0.0, 0.2)
    outcome = ri.solve(system).outcome
    case = Case("three rods 0.2 : 0.3 : 1", "the pulse passes through")
    for i, velocity in enumerate(outcome.velocities_after):
        quantity = f"velocity of rod {i + 1} after, m/s"
        yield case.row(quantity, expected[i], velocity, 1e-13)


def closing_row() -> ri.System:
    """Eight rods of many lengths and areas, each faster than the one to its right.

    Between them are gaps of 0 to 0.3 mm. The numbers are random, but the same in each
    call.
    """
    rng = default_rng(1)
    rods = []
    for i in range(8):
        length = float(rng.integers(1, 10)) / 20
        area = float(rng.uniform(0.2, 2.0)) * 1e-4
        velocity = 0.1 * (8 - i)
        rods.append(ri.Rod(length, area=area, material=STEEL, velocity=velocity))
    gaps = 1e-4 * rng.integers(0, 4, 7)
    return ri.System(rods, gaps=gaps.tolist())


def chain() -> Rows:
    """Balances of momentum and energy, and impulses of contacts, of eight rods.

    Errors are relative to the sum of the magnitudes of all momenta, or to the energy,
    before. Whether the outcome is proved final is checked, too.
    """
    solution = ri.solve(closing_row())
    outcome = solution.outcome
    masses = np.array(outcome.masses)
    before = np.array(outcome.velocities_before)
    after = np.array(outcome.velocities_after)
    gained = masses * (after - before)
    momentum = float(np.abs(masses * before).sum())
    momentum_error = gained.sum() / momentum

    energy = outcome.kinetic_before
    energy_after = outcome.kinetic_after + sum(outcome.vibration_after)
    energy_error = (energy_after - energy) / energy
    waves = solution.energy(solution.t_end)
    wave_error = waves.total / energy - 1

    # Momentum that all bodies to the right of each contact have gained together: the
    # sum from each body on, without the first body, which is on no right side.
    from_right = np.cumsum(gained[::-1])
    gained_to_the_right = from_right[::-1][1:]
    impulses = np.array([contact.impulse for contact in solution.contacts])
    impulse_error = largest_magnitude(impulses - gained_to_the_right) / momentum

    final = outcome.final
    case = Case("eight different rods", "conserved")
    yield case.row(
        "proved final (1 is yes)",
        1.0,
        final,
        0.0,
        source="a row without walls flies apart",
    )
    yield case.row("momentum after - before, relative", 0.0, momentum_error, 1e-13)
    yield case.row(
        "motion and vibration after - before, relative", 0.0, energy_error, 1e-12
    )
    yield case.row(
        "energy of the waves after - before, relative", 0.0, wave_error, 1e-12
    )
    yield case.row(
        "impulse - momentum gained to its right, largest, relative",
        0.0,
        impulse_error,
        1e-12,
    )
