"""The first mode of Pochhammer and Chree against its equation in complex numbers and
its limits.
"""

import math

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.special import jv

import rodimpact as ri
from rodimpact import waves

STEEL = ri.materials.steel.replace(poisson_ratio=0.29)
RATIOS = [0.0, 0.1, 0.25, 0.29, 0.345, 0.45, 0.5]
TABLE = {  # c/c0 by nu and radius/wavelength; that of 0.29 is Bancroft's bar of 1941
    0.25: {
        0.05: 0.998428,
        0.1: 0.993330,
        0.2: 0.965585,
        0.3: 0.886809,
        0.5: 0.693445,
        0.6: 0.647116,
        0.8: 0.604799,
        1.0: 0.589328,
    },
    0.29: {
        0.05: 0.99789,
        0.1: 0.99113,
        0.15: 0.97826,
        0.2: 0.95645,
        0.25: 0.92175,
        0.3: 0.87299,
        0.4: 0.76558,
        0.5: 0.68927,
        0.6: 0.64404,
        0.8: 0.60188,
        1.0: 0.58607,
    },
    0.345: {
        0.05: 0.997026,
        0.1: 0.987661,
        0.2: 0.943386,
        0.3: 0.854995,
        0.5: 0.682675,
        0.6: 0.639166,
        0.8: 0.597548,
        1.0: 0.581443,
    },
}


def pochhammer_chree(x, G, nu):
    """Left-hand side of the equation of Pochhammer and Chree, over its largest term.

    It is taken at the phase velocity x c0, as it stands in books; G = 2 pi a/wavelength
    is the wave number for the radius a = 1. It is 0 where a wave can run. A and B are
    the radial wave numbers of dilatation and shear, imaginary for slow waves.
    """
    dilatation = (1 + nu) * (1 - 2 * nu) / (1 - nu)  # (c0/c1)^2
    shear = 2 * (1 + nu)  # (c0/c2)^2
    A_squared = G**2 * (x**2 * dilatation - 1)
    B_squared = G**2 * (x**2 * shear - 1)
    A = np.sqrt(A_squared + 0j)  # 0j: roots of negative numbers
    B = np.sqrt(B_squared + 0j)
    first = 2 * A * (B**2 + G**2) * jv(1, A) * jv(1, B)
    second = -((B**2 - G**2) ** 2) * jv(0, A) * jv(1, B)
    third = -4 * G**2 * A * B * jv(1, A) * jv(0, B)
    terms = np.array([first, second, third])
    largest = np.abs(terms).max()
    if largest == 0:
        return 0.0
    return abs(terms.sum()) / largest


RADII = np.array([0.03, 0.17, 0.3, 0.42, 0.58, 0.77, 1.0, 1.9])
"""Radii over the wavelength."""


@pytest.mark.parametrize("nu", RATIOS)
def test_the_first_mode_solves_its_equation_and_nothing_slower_does(nu):
    """The equation is `pochhammer_chree`, at 50 speeds between that of surface waves
    and the first mode.
    """
    slowest = 0.9 * waves.rayleigh_speed(nu)
    speeds = waves.first_mode(RADII, nu)  # over c0
    for radius, speed in zip(RADII, speeds, strict=True):
        G = 2 * math.pi * radius
        slower_speeds = np.linspace(slowest, speed - 1e-3, 50)
        residuals = [pochhammer_chree(slower, G, nu) for slower in slower_speeds]
        assert pochhammer_chree(speed, G, nu) < 1e-9
        assert min(residuals) > 1e-5


@pytest.mark.parametrize(("nu", "table"), TABLE.items())
def test_the_first_mode_has_the_phase_velocities_of_the_tables(nu, table):
    radii = list(table)  # over the wavelength
    tabulated_speeds = list(table.values())  # over c0
    speeds = waves.first_mode(radii, nu)
    # All tables are good to about one in the fifth decimal place.
    np.testing.assert_allclose(speeds, tabulated_speeds, rtol=0, atol=1.5e-5)


@pytest.mark.parametrize("nu", RATIOS[1:])
def test_long_waves_of_the_first_mode_are_slower_than_c0_as_rayleigh_says(nu):
    """The phase velocity is less than c0 by nu^2 G^2/4 of it, G the wave number times
    the radius.
    """
    G = 1e-3
    radius_over_wavelength = G / (2 * math.pi)
    speed = waves.first_mode(radius_over_wavelength, nu)
    slowness = nu**2 * G**2 / 4
    assert 1 - speed == pytest.approx(slowness, rel=1e-5)
    assert waves.first_mode(0.0, nu) == 1


@pytest.mark.parametrize("nu", RATIOS[1:])
def test_short_waves_of_the_first_mode_are_those_on_a_surface(nu):
    speed = waves.first_mode(500.0, nu)  # a radius of 500 wavelengths
    surface_speed = waves.rayleigh_speed(nu)
    assert speed == pytest.approx(surface_speed, rel=2e-4)


BAR_SPEED = 5000.0  # m/s


@pytest.fixture(scope="module")
def bar():
    """A bar with a radius of 10 mm."""
    return waves.Bar(BAR_SPEED, poisson_ratio=0.29, radius=0.01)


@pytest.fixture(scope="module")
def frequencies(bar):
    """Frequencies from 0 to twice the cut-off frequency of the bar, Hz."""
    return np.linspace(0.0, 2 * bar.cut_off, 151)


def test_wave_numbers_and_phase_velocities_of_a_bar_are_those_of_the_first_mode(
    bar, frequencies
):
    """k c is the angular frequency, and c that of the first mode; at frequency 0, k is
    0 and c the bar speed. A single frequency gives a float.
    """
    k = bar.wavenumber(frequencies)
    c = bar.phase_velocity(frequencies)
    radius_over_wavelength = k * bar.radius / (2 * math.pi)
    first_mode = waves.first_mode(radius_over_wavelength, bar.poisson_ratio)
    omega = 2 * math.pi * frequencies
    np.testing.assert_allclose(k * c, omega, rtol=1e-13)
    np.testing.assert_allclose(first_mode, c / BAR_SPEED, rtol=1e-11)
    assert k[0] == 0.0
    assert c[0] == BAR_SPEED
    assert isinstance(bar.phase_velocity(1e3), float)


def test_the_group_velocity_is_the_slope_of_the_frequency(bar, frequencies):
    """It is compared with central differences of omega over the wave number."""
    k = bar.wavenumber(frequencies)
    omega = 2 * math.pi * frequencies
    omega_differences = omega[2:] - omega[:-2]  # over two intervals
    central_slope = omega_differences / (k[2:] - k[:-2])

    group = bar.group_velocity(frequencies)

    # The error of the differences is in proportion to the square of the interval: 6e-4.
    inner = group[1:-1]
    np.testing.assert_allclose(inner, central_slope, rtol=1e-3)
    assert group[0] == BAR_SPEED


def test_delays_of_a_bar_are_those_of_its_phase_velocity(bar, frequencies):
    """Up to the cut-off frequency, the delay of a bar, a time per metre, is 1/phase
    velocity minus 1/bar speed.
    """
    below = frequencies[frequencies <= bar.cut_off]
    time_per_metre = 1 / BAR_SPEED
    exact = 1 / bar.phase_velocity(below) - time_per_metre
    delays = bar.delays(below)
    error_bound = 1e-8 * time_per_metre
    np.testing.assert_allclose(delays, exact, rtol=0, atol=error_bound)


def test_a_bar_takes_its_numbers_from_a_round_rod_or_segment_or_a_given_radius():
    """Radius, wave speed and Poisson's ratio are those of the rod, or the radius is the
    given one.
    """
    rod = ri.Rod(1.0, diameter=0.02, material=STEEL)
    square = ri.Rod(1.0, area=1e-4, material=STEEL)

    round_bar = waves.Bar.of(rod)
    square_bar = waves.Bar.of(square, radius=6e-3)

    assert round_bar.radius == pytest.approx(0.01, rel=1e-14)
    assert round_bar.wave_speed == STEEL.wave_speed
    assert round_bar.poisson_ratio == STEEL.poisson_ratio
    bar_of_segment = waves.Bar.of(rod.segments[0])
    assert bar_of_segment == round_bar
    assert square_bar.radius == 6e-3


SHEAR_FACTOR = 0.81
RADIAL_INERTIA_FACTOR = 2 * 0.81
"""The factors of the theory of Mindlin and Herrmann as the package has them."""


def lame_constants(nu):
    """Lame's lambda and mu for E = 1."""
    lame = nu / ((1 + nu) * (1 - 2 * nu))
    mu = 1 / (2 + 2 * nu)
    return lame, mu


def mindlin_herrmann_matrices(k, nu):
    """Stiffness and mass matrix of waves u = exp(i k x) and q = i exp(i k x) in a rod
    with a = E = rho = 1: u is the axial displacement, q the radial one.
    """
    lame, mu = lame_constants(nu)
    coupling = 2 * lame * k
    axial = (lame + 2 * mu) * k * k
    shear = SHEAR_FACTOR * mu * k * k / 2
    radial = 4 * (lame + mu) + shear
    stiffness = [[axial, coupling], [coupling, radial]]
    mass = np.diag([1, RADIAL_INERTIA_FACTOR / 2])
    return stiffness, mass


@pytest.mark.parametrize("nu", [-0.3, 0.0, 0.29, 0.45])
def test_both_speeds_of_mindlin_and_herrmann_are_roots_of_their_determinant(nu):
    """The determinant is that of K - omega^2 M, stiffness and mass; the speeds are
    omega/k.
    """
    radii = np.array([1e-3, 0.05, 0.3, 2.0])  # over the wavelength
    slow, fast = waves.mindlin_herrmann(radii, nu)  # over c0
    wave_numbers = 2 * np.pi * radii
    for i, k in enumerate(wave_numbers):
        stiffness, mass = mindlin_herrmann_matrices(k, nu)
        omega_squared, _ = eigh(stiffness, mass)  # the lower one first
        expected = np.sqrt(omega_squared) / k
        speeds = [slow[i], fast[i]]
        assert speeds == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("nu", [-0.3, 0.0, 0.29, 0.45])
def test_short_waves_of_mindlin_and_herrmann_have_the_speeds_of_their_own_terms(nu):
    """For large k the terms with k^2 decide, and axial and radial waves are apart."""
    lame, mu = lame_constants(nu)
    axial_speed = np.sqrt(lame + 2 * mu)
    radial_speed = np.sqrt(mu * SHEAR_FACTOR / RADIAL_INERTIA_FACTOR)
    speeds = waves.mindlin_herrmann(1e150, nu)
    expected = sorted([axial_speed, radial_speed])
    assert list(speeds) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("nu", [-0.3, 0.0, 0.29, 0.45])
def test_long_waves_of_mindlin_and_herrmann_have_their_first_term_of_dispersion(
    nu,
):
    """At a radius of 1e-3 of the wavelength, the slow speed over c0 is 1 minus a term
    with the square of the radius. For endless waves the slow speed is c0, and the fast
    one infinite.
    """
    radius_over_wavelength = 1e-3
    _, mu = lame_constants(nu)
    dispersion = RADIAL_INERTIA_FACTOR - SHEAR_FACTOR * mu
    contraction = nu * np.pi * radius_over_wavelength
    expected = 1 - dispersion * contraction**2

    slow, _ = waves.mindlin_herrmann(radius_over_wavelength, nu)

    # The next term of the series is of the order of the fourth power.
    assert slow == pytest.approx(expected, abs=1e-9)
    of_endless_waves = waves.mindlin_herrmann(0.0, nu)
    assert of_endless_waves == (1.0, np.inf)


def test_slow_waves_of_mindlin_and_herrmann_are_within_a_percent_of_the_first_mode():
    radii = np.linspace(0.01, 0.6, 30)[:, None]  # over the wavelength
    nu = np.array([0.25, 0.29, 0.33, 0.345])
    slow, _ = waves.mindlin_herrmann(radii, nu)
    first_mode = waves.first_mode(radii, nu)
    largest = np.abs(slow - first_mode).max()
    assert 0.009 < largest <= 0.01  # as `rodimpact.model.lateral_inertia` states it


NOT_UNIFORM = "bar: must be a uniform Rod"
UNKNOWN = ri.Material("x", youngs_modulus=1e9, density=1e3)


@pytest.mark.parametrize(
    ("bar", "message"),
    [
        pytest.param(
            ri.Rod(1.0, area=1e-4, material=STEEL),
            "bar.section: is not said to be round; .*radius=, the equivalent radius",
            id="not round",
        ),
        pytest.param(
            ri.Rod(1.0, area=1e-4, material=UNKNOWN),
            "bar.material.poisson_ratio: is missing in 'x'",
            id="no Poisson ratio",
        ),
        pytest.param(
            ri.Rod(1.0, area=ri.Steps([1e-4, 2e-4], [0.5]), material=STEEL),
            NOT_UNIFORM,
            id="stepped",
        ),
        pytest.param(
            ri.Rod(1.0, area=ri.Samples([1e-4, 2e-4]), material=STEEL),
            NOT_UNIFORM,
            id="tapered",
        ),
        pytest.param(
            3, NOT_UNIFORM + " or Segment, or a waves.Bar, got 3", id="number"
        ),
    ],
)
def test_what_is_no_bar_is_refused(bar, message):
    with pytest.raises(ValueError, match=message):
        waves.Bar.of(bar)


@pytest.mark.parametrize(
    ("function", "arguments", "message"),
    [
        (
            waves.mindlin_herrmann,
            (1.0, 0.5),
            r"poisson_ratio: must lie in \(-1, 0.5\), got 0",
        ),
        (
            waves.first_mode,
            (-1.0, 0.3),
            "radius_over_wavelength: must be a finite non-neg",
        ),
        (
            waves.first_mode,
            (1.0, 0.6),
            r"poisson_ratio: must lie in \[0, 0.5\], got 0.6",
        ),
        (waves.first_mode, ([1, 2], [0.1, 0.2, 0.3]), "do not broadcast"),
        (
            waves.rayleigh_speed,
            (-0.1,),
            r"poisson_ratio: must lie in \[0, 0.5\], got -0.1",
        ),
        (
            waves.Bar(5000.0, 0.3, 0.01).wavenumber,
            (-1.0,),
            "frequency: must be .*, got -1.0",
        ),
        (
            waves.Bar,
            (5000.0, 0.7, 0.01),
            r"poisson_ratio: must lie in \[0, 0.5\], got 0.7",
        ),
        (
            waves.Bar,
            (5000.0, 0.3, [0.01, 0.02]),
            "radius: must be a single number",
        ),
    ],
)
def test_wrong_arguments_of_waves_are_refused(function, arguments, message):
    with pytest.raises(ValueError, match=message):
        function(*arguments)
