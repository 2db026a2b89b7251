"""Horns: tapered rods on a grid against closed forms, fronts of waves, stepped rods.

- Cone, A ~ s^2 with the distance s from the apex: s u obeys the wave equation. If the
  smaller end has a given speed V, the velocity behind the front is v = V s0/s, and 0
  before it, until the wave is back. If a pressure P is given, s u = (P s0^2/E) (1 -
  exp(-(c t - x)/s0)) and v = (P c s0/(E s)) exp(-(c t - x)/s0).
- In a cone and in an exponential horn the front arrives after L/c, multiplied by the
  factor (A0/A1)^(1/2). The velocity doubles at the free end. The time of arrival is the
  time at which half of the front has passed.
- Exponential horn, A = A0 exp(2 beta x): omega^2 = c^2 (k^2 + beta^2), k = n pi/L.
  Between free ends u = exp(-beta x) (cos k x + (beta/k) sin k x), between fixed ends u
  = exp(-beta x) sin k x. No wave runs below the cut-off frequency c beta. With beta L =
  4 the frequency of the lowest mode is well above the cut-off; without the taper it
  would be below. Frequencies are measured as in `lateral_inertia`.
- A rod strikes a horn. The grid is compared with a rod of 200 steps, solved by
  "fronts". If the horn widens, the force falls to zero slowly, and e agrees to 1e-5
  (the bound is 5e-5). If the horn narrows, the force ends in a jump. The difference of
  e is then 9e-4 (the bound is 2e-3), and is proportional to the cell length.

Source: Lord Rayleigh, The Theory of Sound, chapter XIV; A. G. Webster, Acoustical
impedance, and the theory of horns and of the phonograph, Proc. Natl. Acad. Sci. USA 5
(1919) 275-282; the modes by hand.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import rodimpact as ri

from .lateral_inertia import angular_frequency
from .table import Case, Rows, largest_magnitude
from .unit import UNIT, rod

METHOD = "finite-difference"
CELLS = 400
LONGEST_STEP = 0.999 / CELLS  # L/c; waves disperse least with it
SAMPLES = np.linspace(0.0, 1.0, 8001)  # places at which areas and velocities are given
APEX = 0.5  # distance of the apex of a cone from its smaller end, s0/L
BETA = 4.0  # taper of the exponential horn whose modes are compared, 1/L
MODES = (1, 2, 3)

Area = Callable[[np.ndarray], np.ndarray]


def run() -> Rows:
    """Compare driven cones, fronts, modes, and horns that are struck by rods."""
    yield from driven_cone()
    for name, area in horns_with_fronts().items():
        yield from front(name, area)
    for n in MODES:
        yield from free_mode(n)
    for n in MODES:
        yield from fixed_mode(n)
    yield from struck_horns()


def horn(area: Area, velocity: ri.Samples | float = 0.0) -> ri.Rod:
    """A horn of length 1."""
    areas = ri.Samples(area(SAMPLES))
    segment = ri.Segment(1.0, areas, UNIT)
    return ri.Rod(segments=[segment], velocity=velocity)


def conical(x: np.ndarray) -> np.ndarray:
    """Area of a cone, 1 at its smaller end."""
    return (1 + x / APEX) ** 2


def exponential(beta: float) -> Area:
    """Area of an exponential horn, 1 at x = 0."""
    return lambda x: np.exp(2 * beta * x)


def driven_cone() -> Rows:
    """Errors of the velocity in a cone with a given speed, or pressure, at one end.

    This is the smaller end. The mean is taken over all points, the largest error only
    where the front has passed by more than 0.1.
    """
    t = np.array([0.3, 0.6, 0.9])
    middles = (np.arange(2000) + 0.5) / 2000
    x = middles[:, None]
    behind_front = x < t - 0.1

    solution = solve_driven_cone(ri.Moved(1.0), t)
    moved = solution.velocity(0, x, t)
    behind = APEX / (APEX + x)  # the velocity falls as 1/s, s from the apex of the cone
    exact = np.where(x < t, behind, 0.0)
    error = np.abs(moved - exact)
    mean_error = error.mean()
    largest_error = largest_magnitude(error[behind_front])
    quantity = "velocity 0.1 behind the front, largest difference"
    case = Case("cone, A1/A0 = 9", "s u obeys d'Alembert")
    yield case.row("given speed: velocity, mean difference", 0.0, mean_error, 2e-3)
    yield case.row(f"given speed: {quantity}", 0.0, largest_error, 1e-3)

    solution = solve_driven_cone(ri.Pushed(1.0), t)
    pushed = solution.velocity(0, x, t)
    exact = velocity_under_pressure(t, x)
    error = np.abs(pushed - exact)
    mean_error = error.mean()
    largest_error = largest_magnitude(error[behind_front])
    yield case.row("given pressure: velocity, mean difference", 0.0, mean_error, 2e-3)
    yield case.row(f"given pressure: {quantity}", 0.0, largest_error, 1e-3)


def velocity_under_pressure(t: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Velocity in a cone whose smaller end a pressure of 1 pushes from t = 0.

    Behind the front, v = (P c s0/(E s)) exp(-(c t - x)/s0) with s = s0 + x.
    """
    behind = np.maximum(t - x, 0.0)
    v = APEX / (APEX + x) * np.exp(-behind / APEX)
    return np.where(x < t, v, 0.0)


def solve_driven_cone(end: ri.Moved | ri.Pushed, times: np.ndarray) -> ri.Solution:
    """Solve the cone, driven at its smaller end; the run ends after a whole step."""
    cone = horn(conical)
    system = ri.System([cone], ends=(end, ri.Free()))
    steps = math.ceil(times[-1] / LONGEST_STEP)
    until = LONGEST_STEP * steps
    return ri.solve(system, method=METHOD, cells=CELLS, until=until, snapshots=times)


def horns_with_fronts() -> dict[str, Area]:
    """Areas of two horns through which a front runs."""
    return {
        "cone, A1/A0 = 9": conical,
        "exponential horn, beta L = 1": exponential(1.0),
    }


def front(name: str, area: Area) -> Rows:
    """Arrival of a front at the free end of a horn, and its velocity doubled there.

    The other end starts to move at speed 1. The front grows as (A0/A1)^(1/2), and the
    free end doubles it.
    """
    t = np.linspace(0.98, 1.05, 701)
    ends = (ri.Moved(1.0), ri.Free())
    system = ri.System([horn(area)], ends=ends)
    solution = ri.solve(system, method=METHOD, cells=CELLS, until=1.05, snapshots=t)
    v = solution.velocity(0, 1.0, t)
    end = np.array(1.0)
    end_area = float(area(end))
    # A free end doubles the velocity of the front.
    growth = 2 * ri.theory.horn_amplification(1.0, end_area)
    half = growth / 2
    arrival = t[np.argmax(v > half)]
    behind_front = np.interp(1.01, t, v)  # shortly after its arrival at 1
    case = Case(name, "L/c")
    yield case.row("front arrives, L/c", 1.0, arrival, 5e-3)
    two_percent = 0.02 * growth
    yield case.row(
        "velocity of the free end behind the front",
        growth,
        behind_front,
        two_percent,
        source="2 (A0/A1)^(1/2)",
    )


class Mode(NamedTuple):
    """A mode of the exponential horn that is started alone."""

    number: int
    ends: str
    conditions: tuple[ri.Free, ri.Free] | tuple[ri.Fixed, ri.Fixed]
    shape: np.ndarray  # velocity over exp(-beta x)
    x: float  # place where the velocity is read, a belly of the mode


def free_mode(n: int) -> Rows:
    """Frequency of mode n between free ends, started alone.

    u = exp(-beta x) (cos k x + (beta/k) sin k x), with k = n pi.
    """
    k = n * math.pi
    shape = np.cos(k * SAMPLES) + BETA / k * np.sin(k * SAMPLES)
    ends = (ri.Free(), ri.Free())
    mode = Mode(n, "free", ends, shape, x=0.0)
    yield from frequency_of(mode)


def fixed_mode(n: int) -> Rows:
    """Frequency of mode n between fixed ends: u = exp(-beta x) sin k x."""
    k = n * math.pi
    shape = np.sin(k * SAMPLES)
    ends = (ri.Fixed(), ri.Fixed())
    first_belly = 0.5 / n
    mode = Mode(n, "fixed", ends, shape, x=first_belly)
    yield from frequency_of(mode)


def frequency_of(mode: Mode) -> Rows:
    """Angular frequency of a mode of an exponential horn, on a grid.

    The mode is started alone. Expected is omega = c (k^2 + beta^2)^(1/2), k = n pi/L.
    """
    velocity = ri.Samples(np.exp(-BETA * SAMPLES) * mode.shape)
    rod = horn(exponential(BETA), velocity)
    system = ri.System([rod], ends=mode.conditions)
    interval = 10 * LONGEST_STEP
    times = interval * np.arange(300)
    solution = ri.solve(
        system,
        method=METHOD,
        dt=LONGEST_STEP,
        until=float(times[-1]),
        snapshots=times,
    )
    v = solution.velocity(0, mode.x, times)
    computed = angular_frequency(v, interval)
    k = mode.number * math.pi
    exact = float(ri.theory.horn_frequency(1.0, k, BETA))
    name = f"exponential horn, beta L = {BETA:g}, {mode.ends} ends"
    case = Case(name, "c (k^2 + beta^2)^(1/2)")
    quantity = f"angular frequency of mode {mode.number}"
    bound = 1e-4 * exact
    yield case.row(quantity, exact, computed, bound)


def struck_horns() -> Rows:
    """e and impulse of a rod that strikes the smaller, or the larger end of a horn.

    Solutions on a grid are compared with 200 steps by fronts. The bound is wider where
    the horn narrows, since the force ends in a jump there.
    """
    widening = exponential(1.0)
    narrowing = exponential(-1.0)
    strikes_horn = "rod strikes an exponential horn"
    yield from struck("rod strikes a cone, A1/A0 = 9", conical, bound=5e-5)
    yield from struck(f"{strikes_horn}, beta L = 1", widening, bound=5e-5)
    yield from struck(f"{strikes_horn}, beta L = -1", narrowing, bound=2e-3)


def struck(name: str, area: Area, bound: float) -> Rows:
    """e and impulse of a rod that strikes a horn, on a grid.

    The reference is a horn of 200 steps, solved by fronts.
    """
    striker = rod(0.3, velocity=1.0)
    tapered = horn(area)
    steps = tapered.in_steps(200)
    stepped = ri.System([striker, steps])
    exact = ri.solve(stepped, method="fronts").outcome
    system = ri.System([striker, tapered])
    outcome = ri.solve(system, method=METHOD, cells=CELLS).outcome
    e = outcome.restitution
    impulse = outcome.impulse
    case = Case(name, "200 steps by fronts")
    yield case.row("e", exact.restitution, e, bound)
    yield case.row("impulse", exact.impulse, impulse, bound)
