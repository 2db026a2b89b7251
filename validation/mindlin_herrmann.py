"""Lateral inertia by Mindlin and Herrmann: phase velocities, energy, distant fronts.

- Standing waves sin(k x) of a fixed round bar with nu = 0.29 and 25 cells per radius.
  Both frequencies follow from the velocity v at an antinode, for which v(t + 2 dt) +
  v(t - 2 dt) + p (v(t + dt) + v(t - dt)) + r v(t) = 0. Both frequencies are compared
  with the closed form of the theory. The lower frequency is also compared with the
  exact first mode of Pochhammer and Chree, from which the theory differs by up to 0.01
  c. From 6 to 25 cells per radius the errors of both frequencies fall with the square
  of the cell length, also for the shortest wave.
- The energy balance of bars that collide, separate and are bonded, with three radii and
  both theories.
- The end of a steel bar of diameter 19 mm is accelerated smoothly to the speed 1 within
  7.5 us. Velocities at 1 m are compared with the sum over the modes of a fixed bar of
  2.2 m. The rise time from 10 to 90 % after 1 and 4 m is compared with exact
  dispersion. Here the theory of Rayleigh and Love is more accurate: its errors are 2
  and 1 %, those of Mindlin and Herrmann 8 and 9 %.
- The pulse of a striker with rounded ends in a steel bar of diameter 16 mm is
  propagated over 30 to 500 diameters, by the waves of both theories and by the exact
  first mode. The difference is the root mean square during the pulse, divided by the
  peak. Up to about 60 diameters the theory of Mindlin and Herrmann is more accurate.
- `Signal.propagated` propagates a step over 50 000 diameters. Its front must be that of
  Skalak, an integral of the Airy function, with values that do not depend on the bar.

The modes belong to a bar of length D, whose end x = 0 is moved and whose other end is
fixed. V(w) is the spectrum of the acceleration, a raised cosine of the duration T. For
both branches w of k = n pi/D::

    v = 1 - x/D - sum over k and w of 2 sin(k x) share(w) V(w) cos(w (t - T/2))/(k D)
    share(slow) = (fast^2 - c1^2 k^2)/(fast^2 - slow^2), share(fast) = 1 - share(slow)

Source: R. D. Mindlin and G. Herrmann, Proc. 1st US National Congress of Applied
Mechanics (1951) 187; R. Skalak, Journal of Applied Mechanics 24 (1957) 59; the closed
forms by hand.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import rodimpact as ri

from .lateral_inertia import METHOD, NU, RADIUS, STEEL, C, rise_time
from .table import Case, Rows, largest_magnitude

MINDLIN_HERRMANN = "mindlin-herrmann"
RAYLEIGH_LOVE = "rayleigh-love"
CELLS_PER_RADIUS = 25
CELLS_PER_METRE = 960  # cells of the bars that are brought to speed
UNIT_RADIUS = 0.05  # radius of the bar of length 1 with standing waves
RISE = 4 * RADIUS / C  # duration in which an end is brought to speed, s
PULSE_RADIUS = 8e-3  # radius of the bar through which pulses and steps run, m
RADII_OVER_WAVELENGTH = np.linspace(0.0, 0.6, 2001)


def run() -> Rows:
    """Compare phase velocities, the energy of a row, fronts, pulses, a far front."""
    for tenths in range(1, 7):
        yield from phase_velocities(tenths)
    yield from energy()
    yield from front(1, mindlin_herrmann_bound=0.8, rayleigh_love_bound=0.2)
    yield from front(4, mindlin_herrmann_bound=1.3, rayleigh_love_bound=0.15)
    yield from distances()
    yield from far_front()


# Phase velocities


class PhaseVelocities(NamedTuple):
    """Phase velocities over c of both branches."""

    slow: float
    fast: float


def two_frequencies(v: np.ndarray, dt: float) -> list[float]:
    """Angular frequencies of two oscillations from values at equal times of their sum.

    v(t + 2 dt) + v(t - 2 dt) + p (v(t + dt) + v(t - dt)) + r v(t) = 0, by least
    squares. With v = cos(w t), x = cos(w dt) and cos(2 w dt) = 2 x^2 - 1 this is 4 x^2
    + 2 p x + r - 2 = 0.
    """
    inner = v[3:-1] + v[1:-3]
    outer = v[4:] + v[:-4]
    columns = np.stack([inner, v[2:-2]], 1)
    p, r = np.linalg.lstsq(columns, -outer, rcond=None)[0]
    cosines = np.roots([4, 2 * p, r - 2]).real
    angular = np.arccos(cosines) / dt
    return sorted(angular.tolist())


def standing_wave(tenths: int, cells_per_radius: float) -> PhaseVelocities:
    """Phase velocities of waves of 10/tenths radii in a bar of length 1.

    The bar, 20 radii long, has fixed ends and starts as a standing wave. Both
    velocities, slow and fast, follow from the two frequencies at a belly; they are over
    c = 1.
    """
    half_waves = 4 * tenths  # the bar is 20 radii long
    k = half_waves * math.pi
    material = ri.Material("unit", youngs_modulus=1.0, density=1.0, poisson_ratio=NU)
    x = np.linspace(0.0, 1.0, 8001)
    velocity = ri.Samples(np.sin(k * x))
    bar = ri.Rod(
        1.0,
        diameter=2 * UNIT_RADIUS,
        material=material,
        lateral_inertia=MINDLIN_HERRMANN,
        velocity=velocity,
    )
    ends = (ri.Fixed(), ri.Fixed())
    system = ri.System([bar], ends=ends)
    dt = 0.8 * UNIT_RADIUS / cells_per_radius
    times = dt * np.arange(round(32 * cells_per_radius))
    until = float(times[-1])
    solution = ri.solve(system, until, METHOD, dt=dt, snapshots=times)
    belly = 0.5 / half_waves
    v = solution.velocity(0, belly, times)
    slow, fast = two_frequencies(v, dt)
    return PhaseVelocities(slow / k, fast / k)


def phase_velocities(tenths: int) -> Rows:
    """Both branches at one wavelength, and how their errors fall with the cells.

    The wavelength is 10/tenths radii. The errors are those of 4 times as large cells
    and of the usual ones, at three of the wavelengths.
    """
    ratio = tenths / 10
    computed = standing_wave(tenths, CELLS_PER_RADIUS)
    slow, fast = ri.waves.mindlin_herrmann(ratio, NU)
    exact = PhaseVelocities(float(slow), float(fast))
    first_mode = float(ri.waves.first_mode(ratio, NU))
    theory = "Mindlin-Herrmann"
    quantity = f"phase velocity over c at a/wavelength {ratio}"
    case = Case(f"round bar, nu = {NU}", theory)
    yield case.row(quantity, exact.slow, computed.slow, 5e-4)
    yield case.row(quantity, first_mode, computed.slow, 0.01, source="Pochhammer-Chree")
    yield case.row(f"fast {quantity}", exact.fast, computed.fast, 1e-3)
    if tenths in (1, 3, 6):
        coarse = standing_wave(tenths, CELLS_PER_RADIUS / 4)
        slow_order = order(exact.slow, computed.slow, coarse.slow)
        fast_order = order(exact.fast, computed.fast, coarse.fast)
        wavelength = f"at a/wavelength {ratio}"
        case = Case(f"round bar, nu = {NU}", "cells")
        yield case.row(f"order of the slow branch {wavelength}", 2.0, slow_order, 0.35)
        yield case.row(f"order of the fast branch {wavelength}", 2.0, fast_order, 0.35)


def order(exact: float, fine: float, coarse: float) -> float:
    """Order of an error in the size of the cells, of which fine ones are a quarter."""
    coarse_error = abs(coarse - exact)
    fine_error = abs(fine - exact)
    cell_ratio = 4
    return math.log(coarse_error / fine_error, cell_ratio)


# Energy


def segment(length: float, radius: float, theory: str) -> ri.Segment:
    """A round steel segment with a theory of lateral inertia."""
    return ri.Segment(
        length, material=STEEL, diameter=2 * radius, lateral_inertia=theory
    )


def energy() -> Rows:
    """Largest residual of the energy balance of a row of four bodies, over the energy.

    They are a stepped rod, a bar with segments of two theories, a rigid mass bonded to
    it, and a second such bar.
    """
    thin = segment(0.1, 0.01, MINDLIN_HERRMANN)
    thick = segment(0.1, 0.015, MINDLIN_HERRMANN)
    long = segment(0.2, 0.01, MINDLIN_HERRMANN)
    other_theory = segment(0.1, 0.01, RAYLEIGH_LOVE)
    striker = ri.Rod(segments=[thin, thick], velocity=1.0)
    bar = ri.Rod(segments=[long, other_theory])
    mass = ri.RigidMass(0.2)
    gaps = [0.0, 0.0, 1e-6]
    contacts = [ri.Rigid(), ri.Bonded(), ri.Rigid()]
    ends = (ri.Free(), ri.Absorbing())
    system = ri.System([striker, bar, mass, bar], gaps, contacts, ends=ends)
    solution = ri.solve(system, 4e-4, METHOD, cells=200)
    t = np.linspace(0.0, 4e-4, 200)
    balance = solution.energy(t)
    residual = largest_magnitude(balance.residual) / balance.total[0]
    case = Case("row of four bodies, three radii", "balance")
    yield case.row("residual of the energy", 0.0, residual, 1e-12)


# Fronts


class Branch(NamedTuple):
    """A branch of the waves in a bar."""

    phase_velocity: np.ndarray  # over c, [wave number]
    share: np.ndarray  # share of the motion, [wave number]


Branches = Callable[[np.ndarray], list[Branch]]


def theory_branches(ka: np.ndarray) -> list[Branch]:
    """Both branches of Mindlin and Herrmann's theory, by wave number times radius.

    Their shares are those of the sum over modes in the docstring of this file.
    """
    ratio = ka / (2 * math.pi)
    slow, fast = ri.waves.mindlin_herrmann(ratio, NU)
    stiffness = (1 - NU) / ((1 + NU) * (1 - 2 * NU))  # (c1/c)^2
    # share(slow), with frequencies divided by c k
    slow_share = (fast**2 - stiffness) / (fast**2 - slow**2)
    return [Branch(slow, slow_share), Branch(fast, 1 - slow_share)]


def exact_branches(ka: np.ndarray) -> list[Branch]:
    """The exact first mode, as if it were all the motion."""
    ratio = ka / (2 * math.pi)
    first_mode = ri.waves.first_mode(ratio, NU)
    return [Branch(first_mode, np.ones(len(ka)))]


def velocity_by_modes(x: float, t: np.ndarray, branches: Branches) -> np.ndarray:
    """Velocity at x and at times t of the steel bar whose end is brought to speed 1.

    It is the sum over modes and branches in the docstring of this file. With y = w T/2
    the spectrum of the raised cosine is sin(y)/(y (1 - (y/pi)^2)).
    """
    D = 2.2 * x
    count = int(15 / RADIUS * D / math.pi)  # modes with k a up to 15
    k = np.arange(1, count) * math.pi / D
    v = np.full(len(t), 1 - x / D)
    for branch in branches(k * RADIUS):
        omega = C * k * branch.phase_velocity
        y = omega * RISE / 2
        numerator = 2 * np.sin(k * x) / (k * D) * branch.share * np.sin(y)
        amplitude = numerator / (y * (1 - (y / math.pi) ** 2))
        since_middle = t[:, None] - RISE / 2
        v -= np.cos(omega * since_middle) @ amplitude
    return v


def solve_ramp(x: int, t: np.ndarray, theory: str) -> np.ndarray:
    """Velocity at x and times t of a steel bar whose end smoothly reaches speed 1.

    It is computed on a grid, by the theory of lateral inertia of this name.
    """
    s = np.linspace(0.0, 1.0, 401)  # time over that of the rise
    # v(s) = s - sin(2 pi s)/(2 pi), which starts and ends without acceleration
    velocity = s - np.sin(2 * math.pi * s) / (2 * math.pi)
    ramp = ri.Samples(velocity, step=RISE / 400)
    bar = ri.Rod(1.2 * x, diameter=2 * RADIUS, material=STEEL, lateral_inertia=theory)
    ends = (ri.Moved(ramp), ri.Absorbing())
    system = ri.System([bar], ends=ends)
    until = float(t[-1])
    cells = CELLS_PER_METRE * x
    solution = ri.solve(system, until, METHOD, cells=cells, snapshots=t)
    return solution.velocity(0, x, t)


def front(x: int, mindlin_herrmann_bound: float, rayleigh_love_bound: float) -> Rows:
    """Rise of the velocity x metres away by two theories on a grid, us.

    The reference is the exact sum over modes. For Mindlin and Herrmann's theory the
    velocities are also compared with the sum over its own modes.
    """
    # Times around the arrival of the middle of the rise, over four widths of the front
    t = x / C + RISE / 2 + 4e-6 * x ** (1 / 3) * np.linspace(-4, 4, 300)
    exact_v = velocity_by_modes(x, t, exact_branches)
    exact_rise = 1e6 * rise_time(t, exact_v)
    name = "steel bar of 19 mm brought to speed"
    case = Case(name, "Pochhammer-Chree")

    v = solve_ramp(x, t, MINDLIN_HERRMANN)
    v_by_modes = velocity_by_modes(x, t, theory_branches)
    error = largest_magnitude(v - v_by_modes)
    rise = 1e6 * rise_time(t, v)
    quantity = f"rise after {x} m, us, by {MINDLIN_HERRMANN}"
    yield case.row(quantity, exact_rise, rise, mindlin_herrmann_bound)
    by_modes = Case(name, "sum over modes")
    yield by_modes.row(f"error of the velocity at {x} m", 0.0, error, 5e-3)

    v = solve_ramp(x, t, RAYLEIGH_LOVE)
    rise = 1e6 * rise_time(t, v)
    quantity = f"rise after {x} m, us, by {RAYLEIGH_LOVE}"
    yield case.row(quantity, exact_rise, rise, rayleigh_love_bound)


# Pulses


def striker_pulse() -> ri.Signal:
    """Strain near the struck end of a bar that a striker with rounded ends hits.

    It is sampled every 0.1 us, and extended by 1 ms at both ends.
    """
    diameter = 2 * PULSE_RADIUS
    striker = ri.Rod(0.25, diameter=diameter, material=STEEL, velocity=10.0)
    bar = ri.Rod(1.0, diameter=diameter, material=STEEL)
    contact = ri.Hertz(5e11)
    system = ri.System([striker, bar], contacts=[contact])
    solution = ri.solve(system, until=2e-4)
    gauge = solution.gauge(1, 0.02)
    return gauge.signal(1e-7).extended(before=1e-3, after=1e-3)


def rayleigh_love_speeds() -> np.ndarray:
    """Phase velocities over c by Rayleigh and Love: (1 + nu^2 k^2 a^2/2)^(-1/2)."""
    return 1 / np.sqrt(1 + (NU * 2 * math.pi * RADII_OVER_WAVELENGTH) ** 2 / 2)


def carried(pulse: ri.Signal, speeds: np.ndarray, distance: float) -> np.ndarray:
    """The pulse after a distance, in a frame that moves with c.

    `speeds` are phase velocities over c at RADII_OVER_WAVELENGTH.
    """
    spectrum = np.fft.rfft(pulse.values)
    w = 2 * math.pi * np.fft.rfftfreq(len(pulse), pulse.dt)
    k = 2 * math.pi * RADII_OVER_WAVELENGTH / PULSE_RADIUS
    wave_number = np.interp(w, k * C * speeds, k)
    # At these wavelengths Rayleigh and Love's theory has no higher frequencies.
    limit = C * k[-1] * rayleigh_love_speeds()[-1]
    is_inside = w < limit
    delay = np.where(is_inside, wave_number - w / C, 0.0)
    phase = np.exp(-1j * delay * distance)
    carried_spectrum = np.where(is_inside, spectrum * phase, 0.0)
    return np.fft.irfft(carried_spectrum, len(pulse))


def misfit(values: np.ndarray, exact: np.ndarray) -> float:
    """Root mean square of the difference while the pulse lasts, % of its peak.

    The pulse lasts while `exact` is above 1 % of its peak.
    """
    peak = np.abs(exact).max()
    lasting = np.flatnonzero(np.abs(exact) > 0.01 * peak)
    start = lasting[0]
    end = lasting[-1] + 1
    difference = (values - exact)[start:end]
    return 100 * math.sqrt(np.mean(difference**2)) / peak


PULSE_BOUNDS = {  # diameters: bounds, %, by Rayleigh and Love, by Mindlin and Herrmann
    30: (2.2, 1.8),
    60: (2.0, 2.1),
    120: (1.8, 2.3),
    500: (2.7, 4.1),
}


def distances() -> Rows:
    """Misfit of a pulse carried by either theory to that carried by the exact mode.

    The misfit is in % of the peak, at some distances in diameters.
    """
    pulse = striker_pulse()
    first_mode = ri.waves.first_mode(RADII_OVER_WAVELENGTH, NU)
    mindlin_herrmann = ri.waves.mindlin_herrmann(RADII_OVER_WAVELENGTH, NU)[0]
    speeds = {
        RAYLEIGH_LOVE: rayleigh_love_speeds(),
        MINDLIN_HERRMANN: mindlin_herrmann,
    }
    case = Case(f"steel bar of 16 mm, nu = {NU}", "Pochhammer and Chree")
    for diameters, bounds in PULSE_BOUNDS.items():
        distance = 2 * PULSE_RADIUS * diameters
        exact = carried(pulse, first_mode, distance)
        for theory, bound in zip(speeds, bounds, strict=True):
            by_theory = carried(pulse, speeds[theory], distance)
            quantity = f"{theory} after {diameters} diameters, %"
            percent = misfit(by_theory, exact)
            yield case.row(quantity, 0.0, percent, bound)


def far_front() -> Rows:
    """Overshoot, arrival and first peak of a step after 50 000 diameters.

    The unit of time is (3 nu^2 a^2 x/4)^(1/3)/c.
    """
    bar = ri.waves.Bar(wave_speed=5000.0, poisson_ratio=NU, radius=PULSE_RADIUS)
    x = 50_000 * 2 * bar.radius
    unit = (3 * (NU * bar.radius) ** 2 * x / 4) ** (1 / 3) / bar.wave_speed
    interval = unit / 40
    values = np.repeat([0.0, 1.0], 8000)
    step = ri.Signal(values, dt=interval, start=-8000 * unit / 40)
    far = step.propagated(x, bar)
    step_time = -unit / 80  # the step is half-way between the samples around t = 0
    since_long_waves = (far.times - step_time - x / bar.wave_speed) / unit
    peak = int(far.values.argmax())
    overshoot = far.values[peak]
    arrival = np.interp(0.0, since_long_waves, far.values)
    case = Case("step in a bar of 16 mm, 50 000 diameters away", "Skalak 1957")
    yield case.row("overshoot", 1.274352, overshoot, 5e-4)
    yield case.row("value when long waves would come", 1 / 3, arrival, 5e-4)
    yield case.row(
        "first peak, in units of its width", 2.338107, since_long_waves[peak], 0.02
    )
