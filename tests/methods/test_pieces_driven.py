"""Driven ends by characteristics: closed forms of rods that are moved, pushed or sent a
wave.
"""

import math
from itertools import product

import numpy as np
import pytest
from exhaustive import few_of
from networks import unit_rod

import rodimpact as ri

UNTIL = 3.4
STEPS = ri.Steps([0.0, 1.0, -0.5, 0.2], [0.3, 0.71, 1.9])
SAMPLES = ri.Samples([0.0, 1.0, -0.5, 0.2, 0.3], step=0.7)


def value(profile, t):
    """What a profile is at times; 0 before the start."""
    if isinstance(profile, ri.Steps):
        step = np.searchsorted(profile.at, t, "right")
        f = np.array(profile.values)[step]
    elif isinstance(profile, ri.Samples):
        times = profile.step * np.arange(len(profile.values))
        f = np.interp(t, times, profile.values)
    elif callable(profile):
        f = profile(t)
    else:
        f = profile
    return np.where(t >= 0, f, 0.0)


def driven_by(kind, profile):
    """An end of a kind; functions of time need to be told how long."""
    if callable(profile):
        return kind(profile, duration=UNTIL)
    return kind(profile)


ECHO = {ri.Free: 1, ri.Fixed: -1, ri.Absorbing: 0}


def gravity_of(far):
    """A rod falls where that brings no echo."""
    return 0.3 * (far is ri.Absorbing)


def leaving(kind, far, profile, t, Z):
    """The wave that leaves the driven left end: a = 2 f - b, b + 2 F/Z or 2 c e, b the
    echo.

    As seen in free fall, where an end that is moved stays behind.
    """
    behind = gravity_of(far) * (kind is ri.Moved)
    sent = {ri.Moved: 2.0, ri.Pushed: 2 / Z, ri.Incoming: -2.0}[kind]
    at_driven_end = {ri.Moved: -1, ri.Pushed: 1, ri.Incoming: 0}[kind]
    echo = ECHO[far] * at_driven_end
    wave = 0.0
    for n in range(3):  # times that it has run to and fro
        earlier = t - 2 * n
        drive = value(profile, earlier) - behind * np.maximum(earlier, 0)
        wave = wave + sent * echo**n * drive
    return wave


def sine(periods):
    return lambda t: 0.3 + np.sin(2 * math.pi * periods * t + 0.4)


PROFILES = {
    "number": 0.7,
    "steps": STEPS,
    "samples": SAMPLES,
    "slow": sine(0.05),
    "even": sine(1.0),
    "quick": sine(10.0),
}


CASES = list(product(PROFILES, [ri.Moved, ri.Pushed, ri.Incoming], [ri.Free, ri.Fixed]))
CASES += product(PROFILES, [ri.Moved, ri.Pushed], [ri.Absorbing])
USUAL = [case for case in CASES if case[0] != "quick"]
USUAL += [("quick", ri.Moved, ri.Free)]


@pytest.mark.parametrize("case", few_of(CASES, USUAL))
def test_a_driven_rod_moves_as_dalembert_says(case):
    name, kind, far = case
    profile = PROFILES[name]
    Z = 2.0
    ends = [driven_by(kind, profile), far()]
    system = ri.System([unit_rod(1.0, Z)], gravity=gravity_of(far), ends=ends)

    solution = ri.solve(system, UNTIL, "characteristics")

    rng = np.random.default_rng(1)
    x = rng.uniform(0, 1, 200)
    t = rng.uniform(0, UNTIL, 200)
    away = leaving(kind, far, profile, t - x, Z)
    back = leaving(kind, far, profile, t + x - 2, Z) * ECHO[far]
    times = np.linspace(0, UNTIL, 999)
    size = np.abs(leaving(kind, far, profile, times, Z)).max()
    stated = solution.accuracy["velocity"]
    near = (stated + 1e-12) * size
    velocity = (away + back) / 2 + gravity_of(far) * t
    strain = (back - away) / 2
    assert stated <= 1e-7
    assert solution.velocity(0, x, t) == pytest.approx(velocity, abs=near)
    assert solution.strain(0, x, t) == pytest.approx(strain, abs=near)
    assert abs(solution.outcome.momentum_residual) <= 1e-9 * size
    assert abs(solution.energy(UNTIL).residual) <= 1e-8 * size**2


@pytest.mark.parametrize("name", few_of(list(PROFILES), ["steps", "even"]))
def test_a_driven_rod_presses_a_spring(name):
    """What arrives, u = 2 f, drives d' = u - F/Z - F/Z of two endless bars: F is u
    low-passed.
    """
    profile = PROFILES[name]
    k = 5.0
    Z = 2.0
    ends = [driven_by(ri.Incoming, profile), ri.Absorbing()]
    bars = [unit_rod(1.0, Z), unit_rod(1.0, Z)]
    system = ri.System(bars, contacts=[ri.Joint(k)], ends=ends)

    (joint,) = ri.solve(system, UNTIL).contacts

    n = 400_000
    t = np.linspace(0, UNTIL - 1, n + 1)
    dt = t[1] - t[0]
    middle = (t[1:] + t[:-1]) / 2
    arriving = -2 * value(profile, middle)
    remaining = np.exp(2 * k / Z * (middle - t[-1]))  # at the end, of what arrives
    compression = np.sum(arriving * remaining) * dt
    path = np.sum(arriving) * dt
    impulse = (path - compression) * Z / 2
    assert float(joint.force(UNTIL)) == pytest.approx(k * compression, abs=2e-5)
    assert joint.impulse == pytest.approx(impulse, abs=2e-5)
