"""Driven ends by characteristics: closed forms of rods that are moved, pushed or sent a
wave.
"""

import math
from itertools import product

import numpy as np
import pytest
from exhaustive import few_of
from networks import unit_rod
from numpy.random import default_rng

import rodimpact as ri

UNTIL = 3.4  # s, in which waves pass a rod three times
STEPS = ri.Steps([0.0, 1.0, -0.5, 0.2], at=[0.3, 0.71, 1.9])
SAMPLES = ri.Samples([0.0, 1.0, -0.5, 0.2, 0.3], step=0.7)


def value_of(profile, t):
    """Values of a profile, of any kind, at times t; 0 before the start."""
    if isinstance(profile, ri.Steps):
        step = np.searchsorted(profile.at, t, "right")
        values_of_steps = np.array(profile.values)
        values = values_of_steps[step]
    elif isinstance(profile, ri.Samples):
        sample = np.arange(len(profile.values))
        times = profile.step * sample
        values = np.interp(t, times, profile.values)
    elif callable(profile):
        values = profile(t)
    else:
        values = profile
    return np.where(t >= 0, values, 0.0)


def driven_by(kind, profile):
    """An end of a kind; functions of time need to be told how long."""
    if callable(profile):
        return kind(profile, duration=UNTIL)
    return kind(profile)


ECHO = {ri.Free: 1, ri.Fixed: -1, ri.Absorbing: 0}
"""Velocity that the far end sends back, over that which arrives."""


def gravity_of(far):
    """Gravity, m/s^2: rods fall if their far end sends back no echo."""
    if far is ri.Absorbing:
        return 0.3
    return 0.0


def wave_sent(kind, far, profile, t, Z):
    """The wave a that leaves the driven left end at t, as seen in free fall.

    With the drive f and the wave b that arrives it is 2 f - b at a moved end, b + 2 f/Z
    at a pushed one, and -2 c f, c = 1, of an incoming wave. An end that is moved stays
    behind in free fall.
    """
    amplitudes = {ri.Moved: 2.0, ri.Pushed: 2 / Z, ri.Incoming: -2.0}
    echoes = {ri.Moved: -1, ri.Pushed: 1, ri.Incoming: 0}  # of the driven end
    sent = amplitudes[kind]
    echo = ECHO[far] * echoes[kind]
    acceleration_behind = 0.0
    if kind is ri.Moved:
        acceleration_behind = gravity_of(far)
    wave = 0.0
    for n in range(3):  # round trips, of 2 s each
        earlier = t - 2 * n
        behind = acceleration_behind * np.maximum(earlier, 0)
        drive = value_of(profile, earlier) - behind
        wave = wave + sent * echo**n * drive
    return wave


def sine(frequency):
    """A function of time that is no sum of even steps; `frequency` in Hz."""
    w = 2 * math.pi * frequency
    return lambda t: 0.3 + np.sin(w * t + 0.4)


PROFILES = {
    "number": 0.7,
    "steps": STEPS,
    "samples": SAMPLES,
    "slow": sine(0.05),
    "even": sine(1.0),
    "quick": sine(10.0),
}
DRIVES = [ri.Moved, ri.Pushed, ri.Incoming]
CASES = list(product(PROFILES, DRIVES, [ri.Free, ri.Fixed]))
CASES += product(PROFILES, [ri.Moved, ri.Pushed], [ri.Absorbing])
USUAL = [case for case in CASES if case[0] == "steps" and case[2] is not ri.Free]
USUAL += [case for case in CASES if case[0] == "even" and case[2] is ri.Absorbing]


@pytest.mark.parametrize("case", few_of(CASES, USUAL))
def test_a_driven_rod_moves_as_dalembert_says(case):
    """Velocities and strains at 200 random places and times are those of `wave_sent`
    and its echo. `case` holds the names of a profile, of the driven end and of the far
    end.
    """
    name, kind, far = case
    profile = PROFILES[name]
    Z = 2.0
    rod = unit_rod(1.0, area=Z)
    ends = [driven_by(kind, profile), far()]
    gravity = gravity_of(far)
    system = ri.System([rod], gravity=gravity, ends=ends)

    solution = ri.solve(system, until=UNTIL, method="characteristics")

    rng = default_rng(1)
    x = rng.uniform(0, 1, 200)
    t = rng.uniform(0, UNTIL, 200)
    away = wave_sent(kind, far, profile, t - x, Z)
    # What comes back from the far end, at 1 m, has run 2 - x since it was sent.
    arriving = wave_sent(kind, far, profile, t + x - 2, Z)
    back = ECHO[far] * arriving
    velocity = (away + back) / 2 + gravity * t
    strain = (back - away) / 2
    times = np.linspace(0, UNTIL, 999)
    waves = wave_sent(kind, far, profile, times, Z)
    size = np.abs(waves).max()  # m/s
    stated = solution.accuracy["velocity"]
    bound = (stated + 1e-12) * size  # with round-off
    assert stated <= 1e-7
    velocity_found = solution.velocity(0, x, t)
    strain_found = solution.strain(0, x, t)
    assert velocity_found == pytest.approx(velocity, abs=bound)
    assert strain_found == pytest.approx(strain, abs=bound)
    missing_momentum = solution.outcome.momentum_residual
    assert abs(missing_momentum) <= 1e-9 * size
    missing_energy = solution.energy(UNTIL).residual
    assert abs(missing_energy) <= 1e-8 * size**2


@pytest.mark.parametrize("name", few_of(list(PROFILES), ["steps", "even"]))
def test_an_incoming_wave_presses_a_spring_as_a_low_pass_says(name):
    """Between two endless bars the compression d obeys d' = u - 2 F/Z, F = k d, with
    the velocity u = -2 c f of a free end on which the wave f, a strain, arrives.
    """
    profile = PROFILES[name]
    k = 5.0
    Z = 2.0
    driven_end = driven_by(ri.Incoming, profile)
    ends = [driven_end, ri.Absorbing()]
    bars = [unit_rod(1.0, area=Z), unit_rod(1.0, area=Z)]
    spring = ri.Joint(k)
    system = ri.System(bars, contacts=[spring], ends=ends)

    (joint,) = ri.solve(system, until=UNTIL).contacts

    # Sums over many short steps of time, from the arrival of the wave, after 1 s, on
    t = np.linspace(0, UNTIL - 1, 400_001)
    dt = t[1] - t[0]
    middle = (t[1:] + t[:-1]) / 2
    velocity = -2 * value_of(profile, middle)
    time_left = t[-1] - middle
    remaining = np.exp(-2 * k / Z * time_left)  # share of its path at the end
    compression = np.sum(velocity * remaining) * dt
    path = np.sum(velocity) * dt
    loss = path - compression  # path of the ends of both bars
    impulse = loss * Z / 2
    force = float(joint.force(UNTIL))
    error_of_sums = 2e-5
    expected_force = k * compression
    assert force == pytest.approx(expected_force, abs=error_of_sums)
    assert joint.impulse == pytest.approx(impulse, abs=error_of_sums)


@pytest.mark.parametrize("impedance", [1e-3, 1e4])
def test_a_pushed_row_is_as_exact_whatever_its_impedance(impedance):
    """A rod that a smooth force pushes into a second one: velocities and their stated
    error do not depend on the impedance of the rods if all forces are in proportion.
    """

    def pushed_row(impedance):
        """Solution of the row; the areas, forces and stiffnesses are in proportion."""
        force = ri.Pushed(lambda t: impedance * np.sin(1.3 * t) ** 2, duration=6.0)
        system = ri.System(
            [unit_rod(1.0, area=impedance), unit_rod(0.7, area=impedance)],
            contacts=[ri.Hertz(3.0 * impedance)],
            ends=(force, ri.Free()),
        )
        return ri.solve(system, until=6.0, method="characteristics")

    of_unit_impedance = pushed_row(1.0)

    solution = pushed_row(impedance)

    velocities = solution.outcome.velocities_after
    expected = of_unit_impedance.outcome.velocities_after
    assert velocities == pytest.approx(expected, rel=1e-9)
    # The errors are those of other pieces, whose ends are rounded in another way.
    ratio = solution.accuracy["velocity"] / of_unit_impedance.accuracy["velocity"]
    assert 0.3 < ratio < 3.0
    assert solution.accuracy["velocity"] < 1e-8  # the default rtol
