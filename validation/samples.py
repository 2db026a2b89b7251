"""The three solved samples of the textbook's section on collisions in one dimension.

- 10.19: a block of 2 kg at 0.5 m/s runs into one of 10 kg at 0.2 m/s, without loss: the first
  stops, the second goes on at 0.3 m/s.
- 10.20: a ball of 0.5 kg meets a wall at 10 m/s and leaves it at 9 m/s; if the force is a raised
  cosine that lasts 0.1 s or 1 ms, it has a peak of 190 N or 19 kN.
- 10.21: a tennis ball dropped on top of a basketball ten times as heavy rises to 3.11 times the
  height of the drop, and for a very heavy basketball to (e1 + e2 + e1 e2)^2 times that height.

Source: textbook section 10.5, "Collisions in 1D", samples 10.19 to 10.21.
"""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from rodimpact import rigid

from . import exercises
from .table import Row


def run() -> list[Row]:
    """Blocks without loss, peak forces, two balls dropped together."""
    return blocks_without_loss() + peak_force() + tennis_ball_on_basketball()


def blocks_without_loss() -> list[Row]:
    """Sample 10.19."""
    case, source = "two blocks without loss", "textbook, sample 10.19"
    after = rigid.collide(2.0, 0.5, 10.0, 0.2, restitution=1.0)
    return [
        Row(case, "velocity of the first block after, m/s", source, 0.0, after.velocity_1, 1e-15),
        Row(case, "velocity of the second block after, m/s", source, 0.3, after.velocity_2, 1e-15),
        Row(case, "kinetic energy before, J", source, 0.45, after.energy_before, 1e-15),
        Row(case, "kinetic energy after, J", source + ": the same", 0.45, after.energy_after,
            1e-15),
    ]


def peak_force() -> list[Row]:
    """Sample 10.20."""
    case, source = "ball on a stationary surface", "textbook, sample 10.20"
    e = rigid.restitution_from_velocities(10.0, 0.0, -9.0, 0.0)
    impulse = float(rigid.collide(0.5, 10.0, math.inf, 0.0, e).impulse)
    rows = [
        Row(case, "e", source + ": 9/10", 0.9, e, 1e-15),
        Row(case, "impulse, N s", source + ": 0.5 kg times 19 m/s", 9.5, impulse, 1e-14),
    ]
    for duration, peak in ((0.1, 190.0), (0.001, 19000.0)):

        def force(t: float, duration: float = duration, peak: float = peak) -> float:
            return float(exercises.raised_cosine_force(t, peak, duration))

        lasting = f"contact of {duration:g} s"
        rows += [
            Row(case, f"peak force, {lasting}, N", source, peak,
                exercises.peak_force(impulse, duration), 1e-15 * peak),
            Row(case, f"integral of the raised cosine of that peak, {lasting}, N s", source, 9.5,
                exercises.pulse_impulse(force, duration), 1e-13),
        ]
    return rows


def tennis_ball_on_basketball() -> list[Row]:
    """Sample 10.21."""
    case, source = "tennis ball on a basketball", "textbook, sample 10.21"
    height = 1.5
    rise = rigid.stack_drop([0.6, 0.06], [0.9, 0.6], height).top_height / height
    exact = Fraction(97, 55) ** 2  # (10 (0.6 + 0.9 + 0.54) - 1)/11, squared
    e1, e2 = np.meshgrid(np.linspace(0, 1, 11), np.linspace(0, 1, 11))
    heavy = rigid.stack_drop([1.0, 1e-12], np.stack([e2, e1], axis=-1), height).top_height
    limit = (e1 + e2 + e1 * e2) ** 2
    return [
        Row(case, f"height of the flight over that of the drop, {float(exact):.6f}",
            source + ": 3.11", 3.11, rise, 0.005),
        Row(case, "the same exactly", source + ": (19.4/11)^2", exact, rise, 1e-14),
        Row(case, "the same for a mass ratio of 1e12, e1 and e2 from 0 to 1, largest difference",
            source + ": (e1 + e2 + e1 e2)^2", 0.0, float(np.abs(heavy / height - limit).max()),
            1e-10),
    ]
