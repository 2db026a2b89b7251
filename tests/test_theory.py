"""Closed forms for rods against waves followed in exact arithmetic."""

import math
from fractions import Fraction
from itertools import product
from typing import NamedTuple

import numpy as np
import pytest
from exhaustive import few_of
from hypothesis import assume, given
from hypothesis import strategies as st

from rodimpact import theory

EPS = np.finfo(float).eps
CLOSED_FORM_TOL = 8 * EPS
"""Round-off of closed forms, beside waves that are followed in exact arithmetic."""
POSITIVE = st.floats(1e-3, 1e3)
PAIR = st.tuples(POSITIVE, POSITIVE, POSITIVE, POSITIVE)
"""Impedance and transit time of one rod, then of the other."""


class Waves(NamedTuple):
    """What waves make of a collision of two rods."""

    force: list[Fraction]  # by tick
    opening: int  # tick
    restitution: Fraction
    vibration_energy: Fraction


def follow_waves(Z1: int, T1: int, Z2: int, T2: int) -> Waves:
    """Rod 1 hits rod 2 at rest with velocity 1: signals at the contact, tick by tick.

    Z are impedances, T transit times in ticks. A wave that leaves the contact returns
    after a round trip, 2T, unchanged by the free end. An end moves with the wave that
    returns, minus or plus F/Z, and sends back a wave that is twice as far from it.
    """
    mobility = Fraction(1, Z1) + Fraction(1, Z2)
    # Waves that have left the contact into each rod, by tick: at first one round trip
    # of the state at the start.
    leaving_1 = [Fraction(1)] * (2 * T1)
    leaving_2 = [Fraction(0)] * (2 * T2)
    gap = Fraction(0)
    forces = []
    opening = None
    for tick in range(12 * max(T1, T2)):
        returning_1 = leaving_1[-2 * T1]  # left a round trip ago
        returning_2 = leaving_2[-2 * T2]
        F = Fraction(0)
        if gap == 0:  # the force that lets both ends move alike, if it pushes
            F = max(F, (returning_1 - returning_2) / mobility)
        forces.append(F)
        leaving_1.append(returning_1 - 2 * F / Z1)
        leaving_2.append(returning_2 + 2 * F / Z2)
        end_1 = returning_1 - F / Z1  # velocities of both ends
        end_2 = returning_2 + F / Z2
        opening_rate = end_2 - end_1
        if opening is None and opening_rate > 0:
            opening = tick
        gap += opening_rate
        assert gap > 0 or opening is None, "a second contact"
    last_round_trip_1 = leaving_1[-2 * T1 :]
    last_round_trip_2 = leaving_2[-2 * T2 :]
    mean_1, vibration_1 = mean_and_vibration(last_round_trip_1, Z1)
    mean_2, vibration_2 = mean_and_vibration(last_round_trip_2, Z2)
    restitution = mean_2 - mean_1
    return Waves(forces, opening, restitution, vibration_1 + vibration_2)


def mean_and_vibration(signal: list[Fraction], Z: int) -> tuple[Fraction, Fraction]:
    """Velocity of the centre of mass and energy about it, from one round trip of an end
    signal: a tick of it has the mass Z/2.
    """
    mass_of_tick = Fraction(Z, 2)
    mean = sum(signal) / len(signal)
    squared_deviations = [(value - mean) ** 2 for value in signal]
    squares = sum(squared_deviations)
    return mean, mass_of_tick / 2 * squares


WHOLE_NUMBERS = list(product([1, 2, 7], [1, 2, 5], [1, 2, 3], [1, 3, 5]))
by_whole_numbers = pytest.mark.parametrize(
    "numbers", few_of(WHOLE_NUMBERS, WHOLE_NUMBERS[::4])
)
"""Impedances and transit times whose waves can be followed tick by tick."""


@by_whole_numbers
def test_the_closed_form_of_two_rods_agrees_with_waves(numbers):
    """All entries of `saint_venant` are those of `follow_waves`, to round-off."""
    Z1, T1, Z2, T2 = numbers
    waves = follow_waves(Z1, T1, Z2, T2)
    impulse = float(sum(waves.force))
    peak_force = float(max(waves.force))
    pressed_ticks = [tick for tick, F in enumerate(waves.force) if F > 0]
    m1 = Z1 * T1
    m2 = Z2 * T2
    energy_to_share = m1 * m2 / (m1 + m2) / 2  # of the relative motion
    energy_round_off = CLOSED_FORM_TOL * energy_to_share
    vibration_energy = float(waves.vibration_energy)
    restitution = float(waves.restitution)

    pair = theory.saint_venant(Z1, T1, Z2, T2)

    assert pair.restitution == pytest.approx(restitution, abs=CLOSED_FORM_TOL)
    assert pair.impulse == pytest.approx(impulse, rel=CLOSED_FORM_TOL, abs=0)
    assert pair.peak_force == pytest.approx(peak_force, rel=CLOSED_FORM_TOL, abs=0)
    last_pressed = pressed_ticks[-1]
    assert pair.duration == last_pressed + 1  # it lasts to the end of the tick
    assert pair.opening == waves.opening
    near = pytest.approx(vibration_energy, abs=energy_round_off)
    assert pair.vibration_energy == near


@by_whole_numbers
def test_the_force_of_two_rods_agrees_with_waves_also_just_before_a_jump(numbers):
    """`saint_venant_force` at each tick, and one float before it, is that of
    `follow_waves`.
    """
    Z1, T1, Z2, T2 = numbers
    waves = follow_waves(Z1, T1, Z2, T2)
    expected = [float(F) for F in waves.force]
    ticks = np.arange(len(expected), dtype=float)
    just_before = np.nextafter(ticks[1:], -1)

    def force(t):
        return theory.saint_venant_force(t, Z1, T1, Z2, T2)

    values_before = force(just_before)
    expected_before = expected[:-1]
    assert force(ticks) == pytest.approx(expected, abs=CLOSED_FORM_TOL)
    assert values_before == pytest.approx(expected_before, abs=CLOSED_FORM_TOL)
    assert force(-1e-9) == 0.0


def exact_restitution(Z1: float, T1: float, Z2: float, T2: float) -> Fraction:
    """e = J (1/m1 + 1/m2) - 1 with the impulse J summed over round trips of the short
    rod, in exact arithmetic.

    Over each, of 2 Ts, the force is q times that of the one before; the last may be cut
    short by the wave in the long rod, after 2 Tl. (s: short, l: long.)
    """
    rod_1 = (Fraction(T1), Fraction(Z1))
    rod_2 = (Fraction(T2), Fraction(Z2))
    short, long = sorted([rod_1, rod_2])
    Ts, Zs = short
    Tl, Zl = long
    F0 = Zs * Zl / (Zs + Zl)
    reflected = (Zs - Zl) / (Zs + Zl)
    q = max(Fraction(0), reflected)
    K = math.floor(Tl / Ts)  # whole round trips
    whole_trips = 2 * Ts * (1 - q**K) / (1 - q)  # a geometric series
    time_left = 2 * (Tl - K * Ts)
    last_trip = q**K * time_left
    J = F0 * (whole_trips + last_trip)
    inverse_masses = 1 / (Zs * Ts) + 1 / (Zl * Tl)
    return J * inverse_masses - 1


@pytest.mark.parametrize("ratio", [1 + 2**-40, 1.5, 1e3, 1e8, 1e15])
@pytest.mark.parametrize("long_time", [1.0, 1.75, 3.0, math.nextafter(3.0, 0), 257.3])
def test_restitution_keeps_its_digits_at_any_ratio_of_impedances(ratio, long_time):
    for Z_short, Z_long in [(ratio, 1.0), (1.0, ratio)]:
        exact = float(exact_restitution(Z_short, 1.0, Z_long, long_time))
        pair = theory.saint_venant(Z_short, 1.0, Z_long, long_time)
        assert pair.restitution == pytest.approx(exact, rel=4e-15)


@pytest.mark.parametrize("Z_long", [1.0, 1 + 1e-12, 1 - 1e-12])
def test_a_small_restitution_keeps_its_digits(Z_long):
    """The restitution is the ratio of the lengths, and half of the relative excess of
    the impedance of the long rod, if there is one.
    """
    T_long = 1e12
    ratio_of_lengths = 1 / T_long
    excess = max(Z_long - 1, 0)
    pair = theory.saint_venant(1.0, 1.0, Z_long, T_long)
    expected = ratio_of_lengths + excess / 2
    assert pair.restitution == pytest.approx(expected, rel=1e-11, abs=0)


@given(PAIR, POSITIVE)
def test_impulse_energy_and_durations_of_a_pair_fit_together(rods, V):
    """The impulse is (1 + e) m V with the reduced mass m; energy and durations lie
    within their limits.
    """
    Z1, T1, Z2, T2 = rods
    m1 = Z1 * T1
    m2 = Z2 * T2
    reduced_mass = m1 * m2 / (m1 + m2)

    pair = theory.saint_venant(Z1, T1, Z2, T2, V)

    impulse = (1 + pair.restitution) * reduced_mass * V
    energy_to_share = reduced_mass * V * V / 2
    assert 0 < pair.restitution <= 1
    assert pair.impulse == pytest.approx(impulse, rel=CLOSED_FORM_TOL, abs=0)
    assert 0 <= pair.vibration_energy <= energy_to_share
    assert pair.duration <= pair.opening
    short_round_trip = 2 * min(T1, T2)
    long_round_trip = 2 * max(T1, T2)
    assert short_round_trip <= pair.duration <= long_round_trip


@given(PAIR, POSITIVE)
def test_the_impulse_of_a_pair_is_the_integral_of_its_force(rods, V):
    """The force of a pair, constant in each round trip of the short rod, is summed over
    all round trips: the sum is the impulse.
    """
    Z1, T1, Z2, T2 = rods
    pair = theory.saint_venant(Z1, T1, Z2, T2, V)
    round_trip = 2 * min(T1, T2)  # of the short rod; over each the force is constant
    trips = math.ceil(pair.duration / round_trip)
    assume(trips <= 10**5)  # each is summed
    # The last round trip may be cut short.
    ends_of_trips = round_trip * np.arange(trips + 1)
    edges = np.minimum(ends_of_trips, pair.duration)
    middles = (edges[1:] + edges[:-1]) / 2

    force = theory.saint_venant_force(middles, Z1, T1, Z2, T2, V)

    impulse = force @ np.diff(edges)
    assert impulse == pytest.approx(pair.impulse, rel=1e-9)


@given(PAIR, POSITIVE)
def test_it_does_not_matter_which_rod_is_on_the_left(rods, V):
    """`saint_venant` has the same result if the two rods are exchanged."""
    Z1, T1, Z2, T2 = rods
    pair = theory.saint_venant(Z1, T1, Z2, T2, V)
    exchanged = theory.saint_venant(Z2, T2, Z1, T1, V)
    expected = tuple(exchanged)
    assert tuple(pair) == pytest.approx(expected, rel=CLOSED_FORM_TOL, abs=0)


@pytest.mark.parametrize("Z", [0.1 + 0.2, math.nextafter(0.3, 0)])
def test_impedances_that_are_equal_but_for_round_off_count_as_equal(Z):
    """The force then ends after the round trip in the short rod, and the rods part
    after that in the long one.
    """
    T1 = 1.0
    T2 = 2.0
    exact = theory.saint_venant(0.3, T1, 0.3, T2)
    rounded = theory.saint_venant(Z, T1, 0.3, T2)
    for pair in (exact, rounded):
        assert pair.duration == 2 * T1
        assert pair.opening == 2 * T2
    assert rounded.restitution == exact.restitution
    force_after_trip = theory.saint_venant_force(2 * T1, Z, T1, 0.3, T2)
    assert force_after_trip == 0.0


@pytest.mark.parametrize(
    ("ratio", "e"), [(0.25, 0.249581), (1.0, 0.729329), (4.0, 0.967347)]
)
def test_the_closed_form_of_a_mass_on_a_free_rod_keeps_its_balances(ratio, e):
    """`ratio` is the mass over that of the rod; the values of e are derived
    independently.
    """
    Z = 3.0
    T = 0.2
    V = 1.7
    m = Z * T
    M = ratio * m

    collision = theory.mass_on_rod(M, Z, T, V)

    v1 = V - collision.impulse / M
    v2 = collision.impulse / m
    kinetic_1 = M * v1**2 / 2
    kinetic_2 = m * v2**2 / 2
    kinetic_energy = kinetic_1 + kinetic_2
    energy = kinetic_energy + collision.vibration_energy
    times = np.linspace(0, 2 * T, 20001)
    decay = np.exp(-Z * times / M)  # until the wave returns from the free end
    force = Z * V * decay
    integral = np.trapezoid(force, times)
    assert collision.restitution == pytest.approx(e, abs=5e-7)  # six decimal places
    parting = v2 - v1
    energy_before = M * V * V / 2
    assert parting == pytest.approx(collision.restitution * V, rel=1e-13)
    assert energy == pytest.approx(energy_before, rel=1e-13)
    assert integral == pytest.approx(collision.impulse, rel=1e-7)


def test_a_mass_of_0_is_refused():
    with pytest.raises(ValueError, match="mass"):
        theory.mass_on_rod(0.0, 3.0, 0.2, 1.7)


# Tapers, damping, lateral inertia
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("first", "last"), [(4.0, 1.0), (1.0, 9.0)])
def test_a_jump_keeps_its_power_from_the_first_to_the_last_area_of_a_horn(first, last):
    """The power of a wave is rho c A v^2."""
    gain = theory.horn_amplification(first, last)
    power_at_end = last * gain**2
    assert power_at_end == pytest.approx(first, rel=1e-15)


def test_horns_make_families():
    gains = theory.horn_amplification([1.0, 4.0], 1.0)
    assert gains.tolist() == [1.0, 2.0]


def slope(function, x, step=1e-3):
    """Derivative at x, to fourth order in the step."""
    near = function(x + step) - function(x - step)
    far = function(x + 2 * step) - function(x - 2 * step)
    return (8 * near - far) / (12 * step)


def test_a_wave_of_the_horn_frequency_obeys_the_equation_of_the_horn():
    """u = exp(-beta x) cos(k x - omega t) obeys (A u_x)_x = A u_tt/c^2."""
    c = 1.5
    k = 2.0
    beta = 0.6
    omega = theory.horn_frequency(c, k, beta)

    def area(x):
        return math.exp(2 * beta * x)

    def u(x, t):
        amplitude = math.exp(-beta * x)
        return amplitude * math.cos(k * x - omega * t)

    def force(x, t):
        strain = slope(lambda place: u(place, t), x)
        return area(x) * strain

    def velocity(x, t):
        return slope(lambda time: u(x, time), t)

    x = 0.3  # any place and time
    t = 0.2
    force_slope = slope(lambda place: force(place, t), x)
    acceleration = slope(lambda time: velocity(x, time), t)
    inertia = area(x) * acceleration / c**2
    assert force_slope == pytest.approx(inertia, rel=1e-8)
    assert theory.horn_frequency(c, 0.0, beta) == c * beta


@pytest.mark.parametrize("ratio", [0.01, 0.3, 0.9])
def test_the_decay_of_a_damped_mode_is_that_of_the_roots(ratio):
    """The roots are those of p^2 + (eta/E) omega^2 p + omega^2; `ratio` is decay over
    omega.
    """
    E = 3.0
    omega = 7.0
    eta = 2 * E * ratio / omega
    coefficients = [1.0, eta / E * omega**2, omega**2]
    root, _ = np.roots(coefficients)  # a conjugate pair

    decay = theory.kelvin_voigt_decay(E, eta, omega)

    assert decay == pytest.approx(-root.real, rel=1e-12)
    assert decay == pytest.approx(ratio * omega, rel=1e-12)


def test_a_wave_of_the_rayleigh_love_speed_obeys_its_equation():
    """u = cos(k x - omega t) obeys u_tt - nu^2 kappa^2 u_xxtt = c^2 u_xx."""
    c = 5000.0
    nu = 0.29
    kappa = 7e-3  # radius of gyration
    k = np.array([0.0, 10.0, 300.0])

    omega = k * theory.rayleigh_love_speed(c, nu, kappa, k)

    lateral_inertia = (nu * kappa * k) ** 2
    inertia = omega**2 * (1 + lateral_inertia)  # of u_tt - nu^2 kappa^2 u_xxtt
    stiffness = c**2 * k**2
    assert inertia == pytest.approx(stiffness, rel=1e-14)


def test_the_rayleigh_love_speed_depends_on_the_square_of_poissons_ratio():
    """It is the bar speed for a ratio of 0, and the same for 0.29 and -0.29."""
    c = 5000.0
    kappa = 7e-3
    k = 300.0
    speed = theory.rayleigh_love_speed(c, 0.29, kappa, k)
    without_contraction = theory.rayleigh_love_speed(c, 0.0, kappa, k)
    of_negative_ratio = theory.rayleigh_love_speed(c, -0.29, kappa, k)
    assert without_contraction == c
    assert of_negative_ratio == speed


# Arrays and refusals
# --------------------------------------------------------------------------------------


class Form(NamedTuple):
    """A closed form: its arguments that must be positive, and values of the others."""

    function: object
    positive: str  # names, separated by blanks
    others: dict = {}  # noqa: RUF012 - it is not changed


FORMS = [
    Form(
        theory.saint_venant,
        "impedance_1 transit_time_1 impedance_2 transit_time_2 closing_speed",
    ),
    Form(
        theory.saint_venant_force,
        "impedance_1 transit_time_1 impedance_2 transit_time_2",
        {"time": 0.5},
    ),
    Form(theory.rod_on_wall, "impedance transit_time speed"),
    Form(theory.mass_on_rod, "mass impedance transit_time speed"),
    Form(theory.horn_amplification, "area_0 area_1"),
    Form(theory.horn_frequency, "wave_speed", {"wave_number": 1.0, "taper": 1.0}),
    Form(theory.kelvin_voigt_decay, "youngs_modulus viscosity angular_frequency"),
    Form(
        theory.rayleigh_love_speed,
        "wave_speed gyration_radius",
        {"poisson_ratio": 0.3, "wave_number": 1.0},
    ),
]


def values_of(result):
    """A tuple of the values that a form returns, also of a single one."""
    if isinstance(result, tuple):
        return result
    return (result,)


def good_arguments(form):
    """Arguments by name, the positive ones 1."""
    positive_names = form.positive.split()
    return dict.fromkeys(positive_names, 1.0) | form.others


by_form = pytest.mark.parametrize(
    "form", FORMS, ids=lambda form: form.function.__name__
)


@by_form
def test_forms_take_arrays(form):
    """A column for one argument and a row for another one give the single number at
    each place.
    """
    good = good_arguments(form)
    first, second, *_ = good  # names of arguments
    with_arrays = dict(good)
    column = np.full((2, 1), good[first])
    with_arrays[first] = column
    with_arrays[second] = [good[second]] * 3  # a row

    numbers = values_of(form.function(**good))
    families = values_of(form.function(**with_arrays))

    for number, family in zip(numbers, families, strict=True):
        assert type(number) is float
        expected = np.full((2, 3), number)
        assert np.array_equal(family, expected)


@by_form
def test_forms_refuse_what_is_no_number(form):
    """Each argument of a closed form is given as nan, inf or, where it must be
    positive, 0 or -2: ValueError names it and, in a list, the index.
    """
    good = good_arguments(form)
    for name, value in good.items():
        bad_values = [math.nan, math.inf]
        if name in form.positive.split():
            bad_values += [0.0, -2.0]
        for bad in bad_values:
            with_bad = good | {name: bad}
            with_bad_second = good | {name: [value, bad]}
            with pytest.raises(ValueError, match=rf"^{name}: .*, got {bad}"):
                form.function(**with_bad)
            with pytest.raises(ValueError, match=rf"^{name}\[1\]: .*, got {bad}"):
                form.function(**with_bad_second)
