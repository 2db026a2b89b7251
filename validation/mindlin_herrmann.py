"""Lateral inertia by Mindlin and Herrmann: phase velocities, energy, and fronts far from the cause.

- Standing waves sin(k x) of a held round bar of nu = 0.29, 25 cells a radius: both frequencies are
  read off the velocity at a belly, for which v(t + 2 dt) + v(t - 2 dt) + p (v(t + dt) + v(t - dt))
  + r v(t) = 0. Both stand beside the theory's closed form, and the slower one beside the exact
  first mode of Pochhammer and Chree, from which the theory is up to 0.01 c away. From six cells a
  radius to 25 the errors of both fall with the square of the cells, at the shortest wave, too.
- The energy ledger of bars that meet, part and are bonded, of three radii and both theories.
- A steel bar of 19 mm, whose end is brought to speed 1 evenly, within 7.5 us: velocities 1 m away
  against the sum over modes of a held bar of 2.2 m, and the time from 10 to 90 % after 1 and 4 m
  against exact dispersion. Here Rayleigh and Love's theory is the better one: 2 and 1 % off,
  Mindlin and Herrmann's 8 and 9 %.
- The pulse of a striker with rounded ends in a steel bar of 16 mm, carried 30 to 500 diameters by
  the waves of either theory and by the exact first mode: root of the mean square of the difference,
  while the pulse lasts, over its peak. Up to some 60 diameters Mindlin and Herrmann's theory is the
  better one.
- A step that `Signal.propagated` carries 50 000 diameters: its front is Skalak's, an integral of
  Airy's function, with values that do not depend on the bar.

Modes of a bar of length D with the end x = 0 moved and the other one held, V(w) the spectrum of the
acceleration, a raised cosine of the duration T, and both branches w of k = n pi/D::

    v = 1 - x/D - sum over k and w of 2 sin(k x) share(w) V(w) cos(w (t - T/2))/(k D)
    share(slow) = (fast^2 - c1^2 k^2)/(fast^2 - slow^2), share(fast) = 1 - share(slow)

Source: R. D. Mindlin and G. Herrmann, Proc. 1st US National Congress of Applied Mechanics (1951)
187; R. Skalak, Journal of Applied Mechanics 24 (1957) 59; the closed forms by hand.
"""

import math
from collections.abc import Callable

import numpy as np

import rodimpact as ri

from .lateral_inertia import METHOD, RADIUS, STEEL, passage
from .table import Case, Row, Rows

Branches = Callable[[np.ndarray], list[tuple[np.ndarray, np.ndarray]]]
THEORY = "mindlin-herrmann"
NU, PER_RADIUS = 0.29, 25
RISE = 4 * RADIUS / float(STEEL.wave_speed)


def run() -> Rows:
    """Phase velocities, the energy of a row, fronts, pulses, and a front far away."""
    return phase_velocities(), energy(), fronts(), distances(), far_front()


def frequencies(v: np.ndarray, dt: float) -> list[float]:
    """Angular frequencies of two oscillations from values at equal times of their sum."""
    next_ones, outer = v[3:-1] + v[1:-3], v[4:] + v[:-4]
    p, r = np.linalg.lstsq(np.stack([next_ones, v[2:-2]], 1), -outer, rcond=None)[0]
    return sorted(float(x) for x in np.arccos(np.roots([4, 2 * p, r - 2]).real) / dt)


def phase_velocities() -> Rows:
    """Both branches, at six lengths of waves, and how their errors fall with the cells."""
    case = "round bar, nu = 0.29"
    for tenths in range(1, 7):
        name, short = f"over c at a/wavelength {tenths / 10}", tenths / 10
        slow, fast = standing(tenths, PER_RADIUS)
        both = [float(x) for x in ri.waves.mindlin_herrmann(short, NU)]
        yield Row(
            case, f"phase velocity {name}", "Mindlin-Herrmann", both[0], slow, 5e-4
        )
        yield Row(
            case,
            f"phase velocity {name}",
            "Pochhammer-Chree",
            float(ri.waves.first_mode(short, NU)),
            slow,
            0.01,
        )
        yield Row(
            case, f"fast phase velocity {name}", "Mindlin-Herrmann", both[1], fast, 1e-3
        )
        if tenths in (1, 3, 6):
            rougher = standing(tenths, PER_RADIUS / 4)
            for branch, fine, rough, exact in zip(
                ("slow", "fast"), (slow, fast), rougher, both, strict=True
            ):
                order = math.log(abs(rough - exact) / abs(fine - exact), 4)
                yield Row(
                    case,
                    f"order of the {branch} branch at a/wavelength {short}",
                    "cells",
                    2.0,
                    order,
                    0.35,
                )


def standing(tenths: int, per_radius: float) -> list[float]:
    """Phase velocities over c of waves of 10/tenths radii in a bar of length 1 and radius 1/20."""
    radius, half_waves = 0.05, 4 * tenths
    k = half_waves * math.pi
    material = ri.Material("unit", youngs_modulus=1.0, density=1.0, poisson_ratio=NU)
    wave = ri.Samples(np.sin(k * np.linspace(0.0, 1.0, 8001)))
    bar = ri.Rod(
        1.0,
        diameter=2 * radius,
        material=material,
        lateral_inertia=THEORY,
        velocity=wave,
    )
    held = ri.System([bar], ends=(ri.Fixed(), ri.Fixed()))
    dt = 0.8 * radius / per_radius
    times = dt * np.arange(round(32 * per_radius))
    solution = ri.solve(held, float(times[-1]), METHOD, dt=dt, snapshots=times)
    return [
        w / k for w in frequencies(solution.velocity(0, 0.5 / half_waves, times), dt)
    ]


def energy() -> Rows:
    """Largest residual of the ledger over the energy."""

    def piece(length: float, radius: float, theory: str) -> ri.Segment:
        return ri.Segment(
            length, None, STEEL, diameter=2 * radius, lateral_inertia=theory
        )

    striker = ri.Rod(
        segments=[piece(0.1, 0.01, THEORY), piece(0.1, 0.015, THEORY)], velocity=1.0
    )
    bar = ri.Rod(segments=[piece(0.2, 0.01, THEORY), piece(0.1, 0.01, "rayleigh-love")])
    row = ri.System(
        [striker, bar, ri.RigidMass(0.2), bar],
        [0.0, 0.0, 1e-6],
        [ri.Rigid(), ri.Bonded(), ri.Rigid()],
        ends=(ri.Free(), ri.Absorbing()),
    )
    ledger = ri.solve(row, 4e-4, METHOD, cells=200).energy(np.linspace(0.0, 4e-4, 200))
    worst = float(np.abs(ledger.residual).max() / ledger.total[0])
    yield Row(
        "row of four bodies, three radii",
        "residual of the energy",
        "balance",
        0.0,
        worst,
        1e-12,
    )


def fronts() -> Rows:
    """Velocities of one theory, and rises by both."""
    case, c = "steel bar of 19 mm brought to speed", float(STEEL.wave_speed)
    s = np.linspace(0.0, 1.0, 401)
    ramp = ri.Samples(s - np.sin(2 * math.pi * s) / (2 * math.pi), step=RISE / 400)
    for x, bounds in (1, (0.8, 0.2)), (4, (1.3, 0.15)):
        t = x / c + RISE / 2 + 4e-6 * x ** (1 / 3) * np.linspace(-4, 4, 300)
        exact = 1e6 * passage(t, by_modes(x, t, exactly))
        for theory, near in zip((THEORY, "rayleigh-love"), bounds, strict=True):
            bar = ri.Rod(
                1.2 * x, diameter=2 * RADIUS, material=STEEL, lateral_inertia=theory
            )
            driven = ri.System([bar], ends=(ri.Moved(ramp), ri.Absorbing()))
            v = ri.solve(
                driven, float(t[-1]), METHOD, cells=960 * x, snapshots=t
            ).velocity(0, x, t)
            yield Row(
                case,
                f"rise after {x} m, us, by {theory}",
                "Pochhammer-Chree",
                exact,
                1e6 * passage(t, v),
                near,
            )
            if theory == THEORY:
                apart = float(np.abs(v - by_modes(x, t, by_theory)).max())
                yield Row(
                    case,
                    f"error of the velocity at {x} m",
                    "sum over modes",
                    0.0,
                    apart,
                    5e-3,
                )


def by_modes(x: float, t: np.ndarray, branches: Branches) -> np.ndarray:
    """Velocity at x and at times t of the steel bar whose end is brought to speed 1."""
    D = 2.2 * x
    k = np.arange(1, int(15 / RADIUS * D / math.pi)) * math.pi / D
    v = np.full(len(t), 1 - x / D)
    for ratio, share in branches(k * RADIUS):
        omega = float(STEEL.wave_speed) * k * ratio
        y = omega * RISE / 2
        height = (
            2
            * np.sin(k * x)
            / (k * D)
            * share
            * np.sin(y)
            / (y * (1 - (y / math.pi) ** 2))
        )
        v -= np.cos(omega * (t[:, None] - RISE / 2)) @ height
    return v


def by_theory(ka: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Phase velocities over c of both branches, and their shares."""
    slow, fast = ri.waves.mindlin_herrmann(ka / (2 * math.pi), NU)
    stiff = (1 - NU) / ((1 + NU) * (1 - 2 * NU))
    share = (fast**2 - stiff) / (fast**2 - slow**2)
    return [(slow, share), (fast, 1 - share)]


def exactly(ka: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """The exact first mode, as if it were all."""
    return [(ri.waves.first_mode(ka / (2 * math.pi), NU), np.ones(len(ka)))]


def distances() -> Rows:
    """How far a pulse by either theory is from that by the exact mode, after some diameters."""
    c, a, short = float(STEEL.wave_speed), 8e-3, np.linspace(0.0, 0.6, 2001)
    rods = [
        ri.Rod(L, diameter=2 * a, material=STEEL, velocity=v)
        for L, v in ((0.25, 10.0), (1.0, 0.0))
    ]
    struck = ri.solve(ri.System(rods, contacts=[ri.Hertz(5e11)]), until=2e-4)
    pulse = struck.gauge(1, 0.02).signal(1e-7).extended(1e-3, 1e-3)
    spectrum, w = (
        np.fft.rfft(pulse.values),
        2 * math.pi * np.fft.rfftfreq(len(pulse), pulse.dt),
    )
    love = 1 / np.sqrt(1 + (NU * 2 * math.pi * short) ** 2 / 2)
    speeds = {
        "the exact mode": ri.waves.first_mode(short, NU),
        "rayleigh-love": love,
        THEORY: ri.waves.mindlin_herrmann(short, NU)[0],
    }

    def after(speed: np.ndarray, distance: float) -> np.ndarray:
        """The pulse, in a frame that moves with c."""
        k = 2 * math.pi * short / a
        wave_number = np.interp(w, k * c * speed, k)
        inside = (
            w < c * k[-1] * love[-1]
        )  # of shorter waves there are none in one of the theories
        late = np.exp(-1j * np.where(inside, wave_number - w / c, 0.0) * distance)
        return np.fft.irfft(np.where(inside, spectrum * late, 0.0), len(pulse))

    bounds = {30: (2.2, 1.8), 60: (2.0, 2.1), 120: (1.8, 2.3), 500: (2.7, 4.1)}
    for diameters, limits in bounds.items():
        exact, *others = (after(speed, 2 * a * diameters) for speed in speeds.values())
        for theory, found, bound in zip(
            ("rayleigh-love", THEORY), others, limits, strict=True
        ):
            peak = np.abs(exact).max()
            lasting = np.flatnonzero(np.abs(exact) > 0.01 * peak)
            apart = (found - exact)[lasting[0] : lasting[-1] + 1]
            yield Row(
                "steel bar of 16 mm, nu = 0.29",
                f"{theory} after {diameters} diameters, %",
                "Pochhammer and Chree",
                0.0,
                100 * math.sqrt(np.mean(apart**2)) / peak,
                bound,
            )


def far_front() -> Rows:
    """A step after 50 000 diameters, in times (3 nu^2 a^2 x/4)^(1/3)/c since long waves came."""
    bar = ri.waves.Bar(wave_speed=5000.0, poisson_ratio=NU, radius=8e-3)
    x = 50_000 * 2 * bar.radius
    unit = (3 * (NU * bar.radius) ** 2 * x / 4) ** (1 / 3) / bar.wave_speed
    step = ri.Signal(np.repeat([0.0, 1.0], 8000), dt=unit / 40, start=-8000 * unit / 40)
    far = step.propagated(x, bar)
    since = (
        far.times + unit / 80 - x / bar.wave_speed
    ) / unit  # the step is between two samples
    case = Case("step in a bar of 16 mm, 50 000 diameters away", "Skalak 1957")
    peak = int(far.values.argmax())
    yield case.row("overshoot", 1.274352, far.values[peak], 5e-4)
    yield case.row(
        "value when long waves would come",
        1 / 3,
        np.interp(0.0, since, far.values),
        5e-4,
    )
    yield case.row("first peak, in units of its width", 2.338107, since[peak], 0.02)
