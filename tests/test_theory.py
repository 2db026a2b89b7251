"""Closed forms for rods against waves followed in exact arithmetic."""

import math
from fractions import Fraction
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rodimpact import theory

EPS = np.finfo(float).eps
ROUND_OFF = 8 * EPS
POSITIVE = st.floats(1e-3, 1e3)
PAIR = st.tuples(POSITIVE, POSITIVE, POSITIVE, POSITIVE)


class Waves(NamedTuple):
    force: list[Fraction]
    opening: int
    restitution: Fraction
    vibration_energy: Fraction


def follow_waves(Z1: int, T1: int, Z2: int, T2: int) -> Waves:
    """Rod 1 hits rod 2 at rest with velocity 1: signals at the contact, tick by tick.

    A wave that leaves the contact returns after a round trip, 2T, unchanged by the free end.
    """
    leaving_1 = [Fraction(1)] * (2 * T1)
    leaving_2 = [Fraction(0)] * (2 * T2)
    gap = Fraction(0)
    force = []
    opening = None
    for tick in range(12 * max(T1, T2)):
        a = leaving_1[-2 * T1]
        b = leaving_2[-2 * T2]
        F = (
            max(Fraction(0), (a - b) / (Fraction(1, Z1) + Fraction(1, Z2)))
            if gap == 0
            else 0
        )
        force.append(F)
        leaving_1.append(a - 2 * F / Z1)
        leaving_2.append(b + 2 * F / Z2)
        opening_rate = (b + F / Z2) - (a - F / Z1)
        if opening is None and opening_rate > 0:
            opening = tick
        gap += opening_rate
        assert gap > 0 or opening is None, "a second contact"
    mean_1, vibration_1 = mean_and_vibration(leaving_1[-2 * T1 :], Z1)
    mean_2, vibration_2 = mean_and_vibration(leaving_2[-2 * T2 :], Z2)
    return Waves(force, opening, mean_2 - mean_1, vibration_1 + vibration_2)


def mean_and_vibration(signal: list[Fraction], Z: int) -> tuple[Fraction, Fraction]:
    """Velocity of the centre of mass and energy about it, from one round trip of an end signal."""
    mean = sum(signal) / len(signal)
    return mean, Fraction(Z, 4) * sum((s - mean) ** 2 for s in signal)


@pytest.mark.parametrize("T1", [1, 2, 5])
@pytest.mark.parametrize("Z1", [1, 2, 7])
@pytest.mark.parametrize("T2", [1, 3, 5])
@pytest.mark.parametrize("Z2", [1, 2, 3])
def test_agrees_with_waves(Z1, T1, Z2, T2):
    waves = follow_waves(Z1, T1, Z2, T2)
    pair = theory.saint_venant(Z1, T1, Z2, T2)
    assert pair.restitution == pytest.approx(float(waves.restitution), abs=ROUND_OFF)
    assert pair.impulse == pytest.approx(float(sum(waves.force)), rel=ROUND_OFF, abs=0)
    assert pair.peak_force == pytest.approx(
        float(max(waves.force)), rel=ROUND_OFF, abs=0
    )
    assert pair.duration == max(n for n, F in enumerate(waves.force) if F > 0) + 1
    assert pair.opening == waves.opening
    all_energy = Z1 * T1 * Z2 * T2 / (Z1 * T1 + Z2 * T2) / 2
    vibration = pytest.approx(float(waves.vibration_energy), abs=ROUND_OFF * all_energy)
    assert pair.vibration_energy == vibration
    start = np.arange(len(waves.force), dtype=float)
    expected = [float(F) for F in waves.force]
    just_before = np.nextafter(start[1:], -1)
    force = theory.saint_venant_force(start, Z1, T1, Z2, T2)
    assert force == pytest.approx(expected, abs=ROUND_OFF)
    force = theory.saint_venant_force(just_before, Z1, T1, Z2, T2)
    assert force == pytest.approx(expected[:-1], abs=ROUND_OFF)
    assert theory.saint_venant_force(-1e-9, Z1, T1, Z2, T2) == 0.0


def exact_restitution(Z1: float, T1: float, Z2: float, T2: float) -> Fraction:
    """e = J (1/m1 + 1/m2) - 1 with the impulse summed trip by trip, in exact arithmetic."""
    (Ts, Zs), (Tl, Zl) = sorted(
        [(Fraction(T1), Fraction(Z1)), (Fraction(T2), Fraction(Z2))]
    )
    F0 = Zs * Zl / (Zs + Zl)
    q = max(Fraction(0), (Zs - Zl) / (Zs + Zl))
    K = math.floor(Tl / Ts)
    J = F0 * (2 * Ts * (1 - q**K) / (1 - q) + 2 * q**K * (Tl - K * Ts))
    return J * (1 / (Zs * Ts) + 1 / (Zl * Tl)) - 1


@pytest.mark.parametrize("ratio", [1 + 2**-40, 1.5, 1e3, 1e8, 1e15])
@pytest.mark.parametrize("long_time", [1.0, 1.75, 3.0, math.nextafter(3.0, 0), 257.3])
def test_keeps_its_digits_at_any_ratio_of_impedances(ratio, long_time):
    for Z_short, Z_long in [(ratio, 1.0), (1.0, ratio)]:
        e = theory.saint_venant(Z_short, 1.0, Z_long, long_time).restitution
        assert e == pytest.approx(
            float(exact_restitution(Z_short, 1.0, Z_long, long_time)), rel=4e-15
        )


@pytest.mark.parametrize("Z_long", [1.0, 1 + 1e-12, 1 - 1e-12])
def test_keeps_its_digits_when_restitution_is_small(Z_long):
    e = theory.saint_venant(1.0, 1.0, Z_long, 1e12).restitution
    expected = (
        1e-12 + max(Z_long - 1, 0) / 2
    )  # x + |q|, the latter if the long rod is stiffer
    assert e == pytest.approx(expected, rel=1e-11, abs=0)


@given(PAIR, POSITIVE)
def test_integral_energy_and_bounds(rods, V):
    Z1, T1, Z2, T2 = rods
    pair = theory.saint_venant(Z1, T1, Z2, T2, V)
    trips = math.ceil(pair.duration / (2 * min(T1, T2)))
    assume(trips <= 10**5)  # of the short rod, each of which is summed
    m = Z1 * T1 * Z2 * T2 / (Z1 * T1 + Z2 * T2)
    assert 0 < pair.restitution <= 1
    assert pair.impulse == pytest.approx(
        (1 + pair.restitution) * m * V, rel=ROUND_OFF, abs=0
    )
    assert 0 <= pair.vibration_energy <= m * V * V / 2
    assert pair.duration <= pair.opening
    assert 2 * min(T1, T2) <= pair.duration <= 2 * max(T1, T2)
    # The force is constant over each round trip of the short rod; the last one may be cut short.
    edges = np.minimum(2 * min(T1, T2) * np.arange(trips + 1), pair.duration)
    middle = (edges[1:] + edges[:-1]) / 2
    force = theory.saint_venant_force(middle, Z1, T1, Z2, T2, V)
    assert force @ np.diff(edges) == pytest.approx(pair.impulse, rel=1e-9)


@given(PAIR, POSITIVE)
def test_it_does_not_matter_which_rod_is_on_the_left(rods, V):
    Z1, T1, Z2, T2 = rods
    one = theory.saint_venant(Z1, T1, Z2, T2, V)
    other = theory.saint_venant(Z2, T2, Z1, T1, V)
    assert tuple(one) == pytest.approx(tuple(other), rel=ROUND_OFF, abs=0)


def test_equal_up_to_round_off_is_equal():
    exact = theory.saint_venant(0.3, 1.0, 0.3, 2.0)
    for Z in (0.1 + 0.2, math.nextafter(0.3, 0)):
        rounded = theory.saint_venant(Z, 1.0, 0.3, 2.0)
        assert (
            (rounded.duration, rounded.opening)
            == (exact.duration, exact.opening)
            == (2.0, 4.0)
        )
        assert rounded.restitution == exact.restitution
        assert theory.saint_venant_force(2.0, Z, 1.0, 0.3, 2.0) == 0.0


@pytest.mark.parametrize(
    ("ratio", "e"), [(0.25, 0.249581), (1.0, 0.729329), (4.0, 0.967347)]
)
def test_a_mass_on_a_free_rod(ratio, e):
    """Values derived independently; momentum and energy balance."""
    Z = 3.0
    T = 0.2
    V = 1.7
    M = ratio * Z * T
    m = Z * T
    c = theory.mass_on_rod(M, Z, T, V)
    assert c.restitution == pytest.approx(e, abs=5e-7)
    after = V - c.impulse / M, c.impulse / m
    assert after[1] - after[0] == pytest.approx(c.restitution * V, rel=1e-13)
    kinetic = M * after[0] ** 2 / 2 + m * after[1] ** 2 / 2
    assert kinetic + c.vibration_energy == pytest.approx(M * V * V / 2, rel=1e-13)
    times = np.linspace(0, 2 * T, 20001)
    force = Z * V * np.exp(-Z * times / M)
    assert np.trapezoid(force, times) == pytest.approx(c.impulse, rel=1e-7)
    with pytest.raises(ValueError, match="mass"):
        theory.mass_on_rod(0.0, Z, T, V)


# Tapers, damping, lateral inertia ----------------------------------------------------------------


def test_a_jump_keeps_its_energy_in_a_horn():
    """Power of a wave is rho c A v^2."""
    for wide, narrow in ((4.0, 1.0), (1.0, 9.0)):
        gain = theory.horn_amplification(wide, narrow)
        assert narrow * gain**2 == pytest.approx(wide, rel=1e-15)
    assert theory.horn_amplification([1.0, 4.0], 1.0).tolist() == [1.0, 2.0]


def slope(function, x, step):
    """Derivative, to fourth order."""
    far, near = (function(x + k * step) - function(x - k * step) for k in (2, 1))
    return (8 * near - far) / (12 * step)


def test_an_exponential_horn():
    """u = exp(-beta x) cos(k x - omega t) obeys (A u_x)_x = A u_tt/c^2."""
    c = 1.5
    k = 2.0
    beta = 0.6
    omega = theory.horn_frequency(c, k, beta)
    x = 0.3
    t = 0.2

    def u(x, t):
        return math.exp(-beta * x) * math.cos(k * x - omega * t)

    def force(x):
        return math.exp(2 * beta * x) * slope(lambda y: u(y, t), x, 1e-3)

    inertia = math.exp(2 * beta * x) * slope(
        lambda s: slope(lambda r: u(x, r), s, 1e-3), t, 1e-3
    )
    assert slope(force, x, 1e-3) == pytest.approx(inertia / c**2, rel=1e-8)
    assert theory.horn_frequency(c, 0.0, beta) == c * beta


@pytest.mark.parametrize("ratio", [0.01, 0.3, 0.9])
def test_decay_of_a_damped_mode(ratio):
    """The roots of p^2 + (eta/E) omega^2 p + omega^2."""
    E = 3.0
    omega = 7.0
    eta = 2 * E * ratio / omega
    roots = np.roots([1.0, eta / E * omega**2, omega**2])
    decay = theory.kelvin_voigt_decay(E, eta, omega)
    assert decay == pytest.approx(-roots[0].real, rel=1e-12)
    assert decay == pytest.approx(ratio * omega, rel=1e-12)


def test_phase_velocity_with_lateral_inertia():
    """u = cos(k x - omega t) obeys u_tt - nu^2 kappa^2 u_xxtt = c^2 u_xx."""
    c = 5000.0
    nu = 0.29
    kappa = 7e-3
    k = np.array([0.0, 10.0, 300.0])
    omega = k * theory.rayleigh_love_speed(c, nu, kappa, k)
    assert omega**2 * (1 + (nu * kappa * k) ** 2) == pytest.approx(
        c**2 * k**2, rel=1e-14
    )
    assert theory.rayleigh_love_speed(c, 0.0, kappa, 300.0) == c
    assert theory.rayleigh_love_speed(
        c, -nu, kappa, 300.0
    ) == theory.rayleigh_love_speed(c, nu, kappa, 300.0)


# Arrays and refusals ------------------------------------------------------------------------------

FORMS = [
    (
        theory.saint_venant,
        [
            "impedance_1",
            "transit_time_1",
            "impedance_2",
            "transit_time_2",
            "closing_speed",
        ],
        {},
    ),
    (
        theory.saint_venant_force,
        ["impedance_1", "transit_time_1", "impedance_2", "transit_time_2"],
        {"time": 0.5},
    ),
    (theory.rod_on_wall, ["impedance", "transit_time", "speed"], {}),
    (theory.mass_on_rod, ["mass", "impedance", "transit_time", "speed"], {}),
    (theory.horn_amplification, ["area_0", "area_1"], {}),
    (theory.horn_frequency, ["wave_speed"], {"wave_number": 1.0, "taper": 1.0}),
    (
        theory.kelvin_voigt_decay,
        ["youngs_modulus", "viscosity", "angular_frequency"],
        {},
    ),
    (
        theory.rayleigh_love_speed,
        ["wave_speed", "gyration_radius"],
        {"poisson_ratio": 0.3, "wave_number": 1.0},
    ),
]


def values_of(found):
    return found if isinstance(found, tuple) else (found,)


@pytest.mark.parametrize(("function", "sizes", "others"), FORMS)
def test_forms_take_arrays_and_refuse_what_is_no_number(function, sizes, others):
    good = dict.fromkeys(sizes, 1.0) | others
    numbers = values_of(function(**good))
    assert {type(value) for value in numbers} == {float}
    first, second, *_ = good
    shapes = {first: np.full((2, 1), good[first]), second: [good[second]] * 3}
    for value, shaped in zip(
        numbers, values_of(function(**(good | shapes))), strict=True
    ):
        assert np.array_equal(shaped, np.full((2, 3), value))
    for name in good:
        for bad in (math.nan, math.inf, *((0.0, -2.0) if name in sizes else ())):
            with pytest.raises(ValueError, match=rf"^{name}: .*, got {bad}"):
                function(**(good | {name: bad}))
            with pytest.raises(ValueError, match=rf"^{name}\[1\]: .*, got {bad}"):
                function(**(good | {name: [good[name], bad]}))
