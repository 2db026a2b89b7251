"""The three solved samples of the textbook's section on collisions in one dimension.

- 10.19: a block of 2 kg at 0.5 m/s runs into one of 10 kg at 0.2 m/s, without loss: the first
  stops, the second goes on at 0.3 m/s.
- 10.20: a ball of 0.5 kg meets a wall at 10 m/s and leaves it at 9 m/s; if the force is a raised
  cosine that lasts 0.1 s or 1 ms, it has a peak of 190 N or 19 kN.
- 10.21: a tennis ball dropped on top of a basketball ten times as heavy rises to 3.11 times the
  height of the drop, and for a very heavy basketball to (e1 + e2 + e1 e2)^2 times that height.

Source: textbook section 10.5, "Collisions in 1D", samples 10.19 to 10.21.
"""

import math
from fractions import Fraction

import numpy as np
from scipy.integrate import quad

from rodimpact import rigid

from .table import Case, Rows


def run() -> Rows:
    """Blocks without loss, peak forces, two balls dropped together."""
    return blocks_without_loss(), peak_force(), tennis_ball_on_basketball()


def blocks_without_loss() -> Rows:
    """Sample 10.19."""
    case = Case("two blocks without loss", "textbook, sample 10.19")
    after = rigid.collide(2.0, 0.5, 10.0, 0.2, restitution=1.0)
    yield case.row(
        "velocity of the first block after, m/s", 0.0, after.velocity_1, 1e-15
    )
    yield case.row(
        "velocity of the second block after, m/s", 0.3, after.velocity_2, 1e-15
    )
    yield case.row("kinetic energy before, J", 0.45, after.energy_before, 1e-15)
    yield case.row(
        "kinetic energy after, J", 0.45, after.energy_after, 1e-15, ": the same"
    )


def peak_force() -> Rows:
    """Sample 10.20."""
    case = Case("ball on a stationary surface", "textbook, sample 10.20")
    e = rigid.restitution_from_velocities(10.0, 0.0, -9.0, 0.0)
    impulse = float(rigid.collide(0.5, 10.0, math.inf, 0.0, e).impulse)
    yield case.row("e", 0.9, e, 1e-15, ": 9/10")
    yield case.row("impulse, N s", 9.5, impulse, 1e-14, ": 0.5 kg times 19 m/s")
    for T, peak in ((0.1, 190.0), (0.001, 19000.0)):
        lasting = f"contact of {T:g} s"
        yield case.row(f"peak force, {lasting}, N", peak, 2 * impulse / T, 1e-15 * peak)
        integral, _ = quad(
            lambda t, T=T, F=peak: F / 2 * (1 + math.cos(2 * math.pi * t / T)),
            -T / 2,
            T / 2,
        )
        yield case.row(
            f"integral of the raised cosine of that peak, {lasting}, N s",
            9.5,
            integral,
            1e-13,
        )


def tennis_ball_on_basketball() -> Rows:
    """Sample 10.21."""
    case = Case("tennis ball on a basketball", "textbook, sample 10.21")
    height = 1.5
    rise = rigid.stack_drop([0.6, 0.06], [0.9, 0.6], height).top_height / height
    exact = Fraction(97, 55) ** 2  # (10 (0.6 + 0.9 + 0.54) - 1)/11, squared
    e1, e2 = np.meshgrid(np.linspace(0, 1, 11), np.linspace(0, 1, 11))
    heavy = rigid.stack_drop(
        [1.0, 1e-12], np.stack([e2, e1], axis=-1), height
    ).top_height
    limit = (e1 + e2 + e1 * e2) ** 2
    yield case.row(
        f"height of the flight over that of the drop, {float(exact):.6f}",
        3.11,
        rise,
        0.005,
        ": 3.11",
    )
    yield case.row("the same exactly", exact, rise, 1e-14, ": (19.4/11)^2")
    yield case.zero(
        "the same for a mass ratio of 1e12, e1 and e2 from 0 to 1, largest difference",
        heavy / height - limit,
        1e-10,
        ": (e1 + e2 + e1 e2)^2",
    )
