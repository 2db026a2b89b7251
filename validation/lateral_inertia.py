"""Lateral inertia: phase velocities, and the width of the front of a step.

- Standing waves cos(k x) of a free round bar of nu = 0.29: the frequency omega follows
  from the velocity of its end at equally spaced times, for which v(t + dt) + v(t - dt)
  = 2 cos(omega dt) v(t). With the radius of gyration kappa, it is compared with omega/k
  = c/(1 + nu^2 kappa^2 k^2)^(1/2) (Rayleigh-Love) up to k r = 1. A free end includes
  the force of the lateral inertia; without this force cos(k x) is not a mode.
- The end of a steel bar is moved at a given speed. The bar has a diameter of 19 mm, E =
  200 GPa, rho = 7850 kg/m^3 and nu = 0.29. The rise time from 10 to 90 % of the speed
  is compared at 1, 2, 4 and 8 m. Two other computations, the contour integral of
  `rise_by_contour` and the sum over the modes of a bar of 10 m, agree to seven digits:
  7.70, 9.69, 12.19 and 15.35 us. Rounded values for the same bar, 7.9, 9.7, 12.4 and
  15.2 us, agree with these to 2.6 %. The rise time is proportional to distance^(1/3).

The modes are those of a bar of length D whose end x = 0 is moved at speed 1 and whose
other end is held. With l = nu kappa, the impulse at the end sets the bar in motion at
once with the velocity exp(-x/l), and

    v = 1 - x/D - sum over k = n pi/D of 2 sin(k x) cos(omega t)/(D k (1 + k^2 l^2)).

Source: A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed.,
1927, art. 278; the sum by hand.
"""

import math

import numpy as np
from scipy.optimize import brentq

import rodimpact as ri

from .table import Case, Rows

METHOD = "finite-difference"
NU = 0.29  # Poisson's ratio
STEEL = ri.Material("steel", youngs_modulus=200e9, density=7850.0, poisson_ratio=NU)
C = float(STEEL.wave_speed)  # m/s
RADIUS = 9.5e-3  # m
GYRATION = RADIUS / math.sqrt(2)  # kappa, m
BAR_LENGTH = 8.2  # m
CELLS_PER_METRE = 400
RISE_AT_DISTANCE = {1: 7.9, 2: 9.7, 4: 12.4, 8: 15.2}  # distance, m: rounded time, us
LOW = 0.1  # part of the step at which a rise begins
HIGH = 0.9  # part of the step at which a rise ends
UNIT_RADIUS = 0.1 / math.pi  # radius of the bar of length 1 with standing waves
UNIT_CELLS = 200


def run() -> Rows:
    """Compare phase velocities, then rises."""
    for half_waves in (2, 4, 6, 8, 10):
        yield from phase_velocity(half_waves)
    yield from rises()


def angular_frequency(v: np.ndarray, dt: float) -> float:
    """Angular frequency of an oscillation from its values at equal times.

    v(t + dt) + v(t - dt) = 2 cos(omega dt) v(t), by least squares.
    """
    neighbours = v[2:] + v[:-2]
    middle = v[1:-1]
    cosine = neighbours @ middle / (2 * middle @ middle)
    return math.acos(float(cosine)) / dt


def phase_velocity(half_waves: int) -> Rows:
    """Phase velocity of a standing wave of some half waves in a free unit bar.

    It follows from the frequency of the end's velocity on a grid, and is compared with
    Rayleigh and Love's formula.
    """
    k = half_waves * math.pi
    material = ri.Material("unit", youngs_modulus=1.0, density=1.0, poisson_ratio=NU)
    x = np.linspace(0.0, 1.0, 8001)
    velocity = ri.Samples(np.cos(k * x))
    bar = ri.Rod(
        1.0,
        diameter=2 * UNIT_RADIUS,
        material=material,
        lateral_inertia="rayleigh-love",
        velocity=velocity,
    )
    dt = 0.999 / UNIT_CELLS
    times = 5 * dt * np.arange(200)
    solution = ri.solve(
        ri.System([bar]),
        method=METHOD,
        dt=dt,
        until=float(times[-1]),
        snapshots=times,
    )
    v = solution.velocity(0, 0.0, times)
    computed = angular_frequency(v, 5 * dt) / k  # omega/k, where c = 1
    gyration = UNIT_RADIUS / math.sqrt(2)
    exact = float(ri.theory.rayleigh_love_speed(1.0, NU, gyration, k))
    case = Case(f"round bar, nu = {NU}", "Rayleigh-Love")
    quantity = f"phase velocity over c at k r = {k * UNIT_RADIUS:.1f}"
    yield case.row(quantity, exact, computed, 1e-5)


def velocity_by_modes(x: float, t: float) -> float:
    """Velocity at x of a steel bar of 10 m whose end starts to move at speed 1.

    It is the sum over modes in the docstring of this file.
    """
    D = 10.0
    l = NU * GYRATION  # length in the dispersion of Rayleigh and Love, m
    k = np.arange(1, 60_000) * math.pi / D
    inertia = 1 + (k * l) ** 2
    omega = C * k / np.sqrt(inertia)
    waves = np.sin(k * x) * np.cos(omega * t) / (k * inertia)
    mean = 1 - x / D
    return float(mean - 2 / D * waves.sum())


def times_around_front(x: int) -> np.ndarray:
    """200 times, s, from before until after the front of the step passes x, m."""
    front_width = 3e-6 * x ** (1 / 3)  # about its duration, s
    return x / C + front_width * np.linspace(-4.0, 2.6, 200)


def solve_step() -> ri.Solution:
    """Solve a steel bar of 19 mm whose left end moves at speed 1 from t = 0.

    The states are stored while the front passes each distance in `RISE_AT_DISTANCE`.
    """
    bar = ri.Rod(
        BAR_LENGTH,
        diameter=2 * RADIUS,
        material=STEEL,
        lateral_inertia="rayleigh-love",
    )
    ends = (ri.Moved(1.0), ri.Absorbing())
    system = ri.System([bar], ends=ends)
    windows = [times_around_front(x) for x in RISE_AT_DISTANCE]
    times = np.concatenate(windows)
    return ri.solve(
        system,
        method=METHOD,
        cells=round(BAR_LENGTH * CELLS_PER_METRE),
        until=float(times.max()),
        snapshots=times,
    )


def passage_by_modes(x: int, level: float) -> float:
    """Time at which the sum over modes first passes a level at x, s."""
    t = times_around_front(x)[::10]
    v = np.array([velocity_by_modes(x, time) for time in t.tolist()])
    after = int(np.argmax(v > level))

    def excess(time: float) -> float:
        """Velocity at x above the level."""
        return velocity_by_modes(x, time) - level

    return float(brentq(excess, t[after - 1], t[after], xtol=1e-15))


def rises() -> Rows:
    """Rises of the velocity from 10 to 90 % of the step, us.

    At each distance the sum over modes is compared with a contour integral and with a
    grid, and the grid with a rounded value.
    """
    solution = solve_step()
    case = Case("step of velocity in a steel bar of 19 mm", "sum over modes")
    for x, round_value in RISE_AT_DISTANCE.items():
        t = times_around_front(x)
        v = solution.velocity(0, float(x), t)
        on_grid = 1e6 * rise_time(t, v)
        early = passage_by_modes(x, LOW)
        late = passage_by_modes(x, HIGH)
        by_modes = 1e6 * (late - early)
        by_contour = 1e6 * rise_by_contour(x, C, NU * GYRATION)
        exact = round(by_modes, 6)
        quantity = f"rise after {x} m, us"
        yield case.row(f"{quantity}, by contour integral", exact, by_contour, 1e-5)
        yield case.row(quantity, exact, on_grid, 0.03)
        yield case.row(
            f"{quantity}, beside a round value",
            round_value,
            on_grid,
            0.25,
            source="round values",
        )


def rise_by_contour(distance: float, wave_speed: float, size: float) -> float:
    """Time in which velocity rises from 10 to 90 % of a step, far from its origin.

    With lengths in units of size = nu kappa and times in nu kappa/c, the Laplace
    transform of the velocity at x of a semi-infinite rod, after a unit step of velocity
    at its end, is ``exp(-x s/(1 + s^2)^(1/2))/s``. On waves of real frequency the
    inverse is::

        v = 1/(2 pi i) integral exp(i (omega t - k x))/(k (1 + k^2)) dk,
            omega = k/(1 + k^2)^(1/2), along a line below the pole at k = 0

    What is left out, waves that die out along the rod, is smaller than exp(-x). Far
    away v becomes the integral of Airy's function up to (t - x)/(3 x/2)^(1/3), and the
    rise becomes 2.168 (3 x/2)^(1/3).
    """
    x = distance / size
    spread = float(np.cbrt(1.5 * x))
    late = scaled_passage(x, spread, HIGH)
    early = scaled_passage(x, spread, LOW)
    return float(late - early) * spread * size / wave_speed


def scaled_passage(x: float, spread: float, level: float) -> float:
    """Value of (t - x)/(3 x/2)^(1/3) at which the front passes a level."""

    def excess(z: float) -> float:
        """Velocity above the level at the time x + z spread."""
        return front(x, x + z * spread) - level

    return brentq(excess, -4.0, 2.2, xtol=1e-13)  # the first crest is at 2.34


def front(x: float, t: float) -> float:
    """Velocity at x > 0 and t by the integral of `rise_by_contour`, to about 12 digits.

    The rule is the trapezoidal one, on the line k = (u - i) x^(-1/3) with steps of 1/6
    of u from -8 to 8.
    """
    depth = 1 / float(np.cbrt(x))  # depth of the line below the real axis, its scale
    k = depth * (np.arange(-48, 49) / 6 - 1j)
    omega = k / np.sqrt(1 + k * k)
    waves = np.exp(1j * (omega * t - k * x)) / (k * (1 + k * k))
    integral = waves.sum() * depth / 6 / (2j * np.pi)
    return float(integral.real)


def first_passage(t: np.ndarray, v: np.ndarray, level: float) -> float:
    """Time at which v first passes a level, by linear interpolation, s.

    It lies between the first value above the level and the value before it.
    """
    i = int(np.argmax(v > level))
    interval = t[i] - t[i - 1]
    before = v[i - 1]
    after = v[i]
    return t[i - 1] + interval * (level - before) / (after - before)


def rise_time(t: np.ndarray, v: np.ndarray) -> float:
    """Time between the first passages of 0.1 and 0.9, s."""
    early = first_passage(t, v, LOW)
    late = first_passage(t, v, HIGH)
    return float(late - early)
