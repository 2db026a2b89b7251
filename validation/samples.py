"""The three solved samples of the textbook's section on collisions in one dimension.

- 10.19: a block of 2 kg at 0.5 m/s hits a block of 10 kg at 0.2 m/s without loss. The
  first block stops, and the second block moves at 0.3 m/s.
- 10.20: a ball of 0.5 kg hits a wall at 10 m/s and leaves at 9 m/s. If the force is a
  raised cosine that lasts 0.1 s or 1 ms, its peak is 190 N or 19 kN.
- 10.21: a tennis ball is dropped on top of a basketball that is ten times as heavy. The
  tennis ball rises to 3.11 times the height of the drop. With a very heavy basketball
  the tennis ball rises to (e1 + e2 + e1 e2)^2 times this height.

Source: textbook section 10.5, "Collisions in 1D", samples 10.19 to 10.21.
"""

import math
from fractions import Fraction

import numpy as np
from scipy.integrate import quad

from rodimpact import rigid

from .table import Case, Rows

BALL_MASS = 0.5  # kg
PEAK_FORCES = {0.1: 190.0, 0.001: 19000.0}  # contact time, s: N
HEIGHT = 1.5  # m, of the drop of tennis ball and basketball


def run() -> Rows:
    """Compare blocks without loss, peak forces, and two balls dropped together."""
    yield from blocks_without_loss()
    yield from peak_forces()
    yield from tennis_ball_on_basketball()


def blocks_without_loss() -> Rows:
    """Velocities and energies of sample 10.19: 2 kg at 0.5 m/s on 10 kg at 0.2 m/s.

    The collision is that of rigid bodies with e = 1.
    """
    m1 = 2.0
    v1 = 0.5
    m2 = 10.0
    v2 = 0.2
    after = rigid.collide(m1, v1, m2, v2, restitution=1.0)
    first = after.velocity_1
    second = after.velocity_2
    energy_before = after.energy_before
    energy_after = after.energy_after
    case = Case("two blocks without loss", "textbook, sample 10.19")
    yield case.row("velocity of the first block after, m/s", 0.0, first, 1e-15)
    yield case.row("velocity of the second block after, m/s", 0.3, second, 1e-15)
    yield case.row("kinetic energy before, J", 0.45, energy_before, 1e-15)
    yield case.row(
        "kinetic energy after, J", 0.45, energy_after, 1e-15, detail="the same"
    )


def raised_cosine_impulse(peak: float, T: float) -> float:
    """Integral of F(t) = peak (1 + cos(2 pi t/T))/2 over the contact time T, N s."""

    def force(t: float) -> float:
        """Force at a time from the middle of the contact, N."""
        phase = 2 * math.pi * t / T
        return peak / 2 * (1 + math.cos(phase))

    impulse, _ = quad(force, -T / 2, T / 2)
    return impulse


def peak_forces() -> Rows:
    """e, impulse and peak forces of sample 10.20.

    A ball of 0.5 kg meets a wall at 10 m/s and leaves it at 9 m/s.
    """
    e = rigid.restitution_from_velocities(
        v1_before=10.0, v2_before=0.0, v1_after=-9.0, v2_after=0.0
    )
    outcome = rigid.collide(BALL_MASS, 10.0, m2=math.inf, v2=0.0, restitution=e)
    impulse = float(outcome.impulse)
    case = Case("ball on a stationary surface", "textbook, sample 10.20")
    yield case.row("e", 0.9, e, 1e-15, detail="9/10")
    yield case.row("impulse, N s", 9.5, impulse, 1e-14, detail="0.5 kg times 19 m/s")
    for T, peak in PEAK_FORCES.items():
        contact = f"contact of {T:g} s"
        computed_peak = 2 * impulse / T  # a raised cosine has half its peak as mean
        round_off = 1e-15 * peak
        yield case.row(f"peak force, {contact}, N", peak, computed_peak, round_off)
        integral = raised_cosine_impulse(peak, T)
        quantity = f"integral of the raised cosine of that peak, {contact}, N s"
        yield case.row(quantity, 9.5, integral, 1e-13)


def heavy_basketball_error() -> np.ndarray:
    """Errors of a tennis ball's height over that of the drop, on a heavy basketball.

    The basketball is 1e12 times as heavy. The limit is (e1 + e2 + e1 e2)^2, for e1 and
    e2 from 0 to 1, [e2, e1].
    """
    from_0_to_1 = np.linspace(0, 1, 11)
    e1, e2 = np.meshgrid(from_0_to_1, from_0_to_1)
    restitutions = np.stack([e2, e1], axis=-1)
    drop = rigid.stack_drop([1.0, 1e-12], restitutions, HEIGHT)
    limit = (e1 + e2 + e1 * e2) ** 2
    return drop.top_height / HEIGHT - limit


def tennis_ball_on_basketball() -> Rows:
    """Height of the tennis ball of sample 10.21, over that of the drop.

    The basketball is ten times as heavy; e is 0.9 at the ground and 0.6 between them.
    """
    masses = [0.6, 0.06]  # kg
    restitutions = [0.9, 0.6]
    drop = rigid.stack_drop(masses, restitutions, HEIGHT)
    rise = drop.top_height / HEIGHT
    exact = Fraction(97, 55) ** 2  # (10 (0.6 + 0.9 + 0.54) - 1)/11, squared
    quantity = f"height of the flight over that of the drop, {float(exact):.6f}"
    case = Case("tennis ball on a basketball", "textbook, sample 10.21")
    yield case.row(quantity, 3.11, rise, 0.005, detail="3.11")
    yield case.row("the same exactly", exact, rise, 1e-14, detail="(19.4/11)^2")
    yield case.zero(
        "the same for a mass ratio of 1e12, e1 and e2 from 0 to 1, largest difference",
        heavy_basketball_error(),
        1e-10,
        detail="(e1 + e2 + e1 e2)^2",
    )
